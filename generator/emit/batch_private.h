/* SPDX-License-Identifier: MIT
 *
 * What the files share that write code for many vehicles at once. */
#ifndef EMIT_BATCH_PRIVATE_H
#define EMIT_BATCH_PRIVATE_H

#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"

/* batch_fast.c: insertion points of its templates. */
extern const Insertions batch_fast_points, batch_wheel_points, batch_drive_points;
/* For models with fast states: functions of these. */
void write_batch_fast(Generation *g, Text *out);
/* batch_members.c: members of a block that few models have or that only the code for one vehicle needs; all numbers of
 * a vehicle, from a vehicle of its own, `one`, to lane l of the block (load), or back. */
void write_batch_members(const Generation *g, Text *out, int indent);
void write_batch_exchange(const Generation *g, Text *out, int indent, bool load);

#endif
