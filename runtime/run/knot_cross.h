/* SPDX-License-Identifier: MIT
 *
 * knot_cross: what a constant step misses at a knot of the inputs. It needs the runtime core alone. */
#ifndef RUN_KNOT_CROSS_H
#define RUN_KNOT_CROSS_H

#include "gic_runtime.h"

/* By what a step of 1 s of a method is too short per jump of the rate's derivative at a knot at that share of it. */
double knot_missing(int32_t method, double share);
/* True if the last step, which began with `history` past rates, is one whose sum misses something at knots. */
int knot_counts(const gic_head *self, int history);
/* Add to the state what the last step, which began at `start`, missed at a knot in it. Two right-hand sides. Returns a
 * status; on another one than GIC_OK the state is as it was. */
int knot_cross(const gic_model *model, gic_head *self, double start, double knot);

#endif
