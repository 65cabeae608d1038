/* SPDX-License-Identifier: MIT
 *
 * number_place: a scene whose numbers are looked for: those by which runs are differentiated (tangent_run.h). */
#ifndef RUN_NUMBER_PLACE_H
#define RUN_NUMBER_PLACE_H

#include "base/pool.h"
#include "model/model.h"
#include "run/tangent_run.h"
#include "scene/scene.h"

/* A copy whose numbers may change without those of the scene. */
Scene *scene_with_numbers(Pool *pool, const Model *model, const Scene *scene);
/* Before each run of it: a copy with its profiles, which conditions replace (`when`). running: another copy, for all
 * runs. */
const Scene *scene_renewed(const Scene *copy, Scene *running);
/* The place of a variable in such a copy, with its value; NULL: the scene has none for it. */
double *number_place(const Model *model, const Scene *copy, const RunVariable *variable);
/* End with a message, in which `option` does not find it, unless each variable has a place. */
void number_places_check(const Model *model, const Scene *copy, const RunVariable *variable, int variables,
                         const char *option);

#endif
