/* SPDX-License-Identifier: MIT
 *
 * Instants of controllers that lie within constant steps, which are then made in parts. */
#ifndef RUN_SAMPLING_H
#define RUN_SAMPLING_H

#include "base/pool.h"
#include "gic_runtime.h"

/* Which controller samples, or has values that take effect, within steps of `step` seconds, and which step would do,
 * that divides `output_step`, too (0: any may); NULL: all instants are ends of steps. */
const char *sampling_note(Pool *pool, const gic_model *model, double step, double output_step);

#endif
