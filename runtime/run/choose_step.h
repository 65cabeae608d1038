/* SPDX-License-Identifier: MIT
 *
 * `integrator: auto`: the integrator and step of a run by the eigenvalues along its start. */
#ifndef RUN_CHOOSE_STEP_H
#define RUN_CHOOSE_STEP_H

#include "base/pool.h"
#include "model/model.h"
#include "scene/scene.h"
#include "subset/subset.h"

/* The scene with the integrator and step that take least work of those that are stable along its start, at most the
 * scene's own step; and a note that says which, and why, unless `quiet`. A scene that does not ask for it is returned.
 * implicit: the engine has implicit steps. After equilibrium_start(). Ends in diag_fail where the run can't start. */
const Scene *scene_choose_step(Pool *pool, const Model *model, const Scene *scene, Solve solve, bool implicit,
                               bool quiet);
/* The scene with what was chosen for the same one with another start. */
const Scene *scene_with_choice(Pool *pool, const Scene *scene, const Scene *chosen);

#endif
