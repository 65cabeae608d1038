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
/* For models with fast states: functions of these; members of a block; their numbers, lane by lane between a vehicle of
 * its own, `one`, and the block. */
void write_batch_fast(Generation *g, Text *out);
void write_batch_fast_members(void *context, Text *out, int indent);
void write_batch_fast_exchange(const Generation *g, Text *out, int indent, bool load);

#endif
