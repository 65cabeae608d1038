/* SPDX-License-Identifier: MIT
 *
 * condition_output: the conditions of a scene as outputs of the model, so that they have derivatives. */
#ifndef RUN_CONDITION_OUTPUT_H
#define RUN_CONDITION_OUTPUT_H

#include "base/pool.h"
#include "model/model.h"
#include "scene/scene.h"

/* The model with one more output, hidden, for each condition of `until` and `when`, in their order; the model itself
 * where the scene has none. */
Model *condition_outputs(Pool *pool, Model *from, const Scene *scene);
/* How many of the scene there are, 0: the scene is NULL or has none. */
int condition_count(const Scene *scene);
/* How many outputs of the model are such ones. */
int condition_has(const Model *model);

#endif
