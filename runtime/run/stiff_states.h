/* SPDX-License-Identifier: MIT
 *
 * Which states implicit steps of a length need to treat implicitly, by eigenvalues. */
#ifndef RUN_STIFF_STATES_H
#define RUN_STIFF_STATES_H

#include "emit/emit.h"
#include "model/model.h"
#include "scene/scene.h"
#include "subset/method.h"

/* For steps of `step` s with code that solves and recovers in these ways: the states that have a share in stiff motions
 * about the state at set-up, about states in which stops press, and about the static equilibrium where wheels hang in
 * the air at set-up, and those without which imex would not be stable there. It follows from the model and the step
 * alone. Ends in diag_fail where the model can't be set up. */
const Splitting *stiff_states(Pool *pool, const Model *model, Solve solve, Recovery recovery, double step);
/* The same for the steps of a scene of which it asks that; NULL: all states are implicit, or none. */
const Splitting *scene_splitting(Pool *pool, const Model *model, const Scene *scene, Solve solve, Recovery recovery);

#endif
