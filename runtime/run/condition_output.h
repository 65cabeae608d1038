/* SPDX-License-Identifier: MIT
 *
 * condition_output: the conditions of a scene as outputs of the model, so that they have derivatives. */
#ifndef RUN_CONDITION_OUTPUT_H
#define RUN_CONDITION_OUTPUT_H

#include "base/pool.h"
#include "model/model.h"
#include "scene/scene.h"

/* The model with outputs, hidden, for the conditions of `until` and `when`, in their order: first of each its value,
 * which is above 0 where it is true, then of each its guard, which is above 0 there too, but on the border at most, and
 * goes through 0 where comparisons are joined by `and`, `or`, `not`, `>=` and `if`, whose values jump. They come before
 * outputs at the end that controllers read. The model itself where the scene has none. */
Model *condition_outputs(Pool *pool, Model *from, const Scene *scene);
/* Ends in diag_fail if a condition ends the run (`until`): for studies that compare all its times. option:
 * "--identify". */
void condition_no_end(const Scene *scene, const char *option);
/* How many of the scene there are, 0: the scene is NULL or has none. */
int condition_count(const Scene *scene);
/* How many conditions have their outputs in the model. */
int condition_has(const Model *model);
/* True if the guard of condition c may jump where a state or an input passes a bound: `if` is left in it. */
bool condition_jumps(const Model *model, int c);

#endif
