/* SPDX-License-Identifier: MIT
 *
 * identify: parameters of a model, or of the start of a scene, from measurements (gicrun --identify), by the
 * definitions of models/SCENE.md section 8. */
#ifndef RUN_IDENTIFY_H
#define RUN_IDENTIFY_H

#include "base/pool.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/scene.h"

/* --identify: a table of what was found, and with -o as CSV, or as a page where the name ends in .html. Ends in
 * diag_fail. */
void identify_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);

#endif
