/* SPDX-License-Identifier: MIT
 *
 * knot: constant steps with a knot of the inputs in them. */
#ifndef RUN_KNOT_H
#define RUN_KNOT_H

#include "gic_runtime.h"

typedef struct Scene Scene; /* scene/scene.h */

/* After a step of constant length that began at `start` (s) with `history` past rates (head.history): add to the state
 * what the step missed at knots of driven coordinates, models/SCENE.md section 4. Two right-hand sides a knot, nothing
 * without one. Returns a status; on another one than GIC_OK the state is as it was. */
int knots_cross(const gic_model *model, const Scene *scene, gic_head *self, double start, int history);

#endif
