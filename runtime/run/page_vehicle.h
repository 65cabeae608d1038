/* SPDX-License-Identifier: MIT
 *
 * The vehicle of a page of gicrun --drive, computed here by the page's own code: WebAssembly, which has the same
 * numbers everywhere. So runs have the page's digits, models/SCENE.md section 14. */
#ifndef RUN_PAGE_VEHICLE_H
#define RUN_PAGE_VEHICLE_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/scene.h"

/* The page's vehicle in a scene as --drive takes it, before a recording changes it. NULL: no compiler makes it here;
 * *why and *remedy say why, and what to do. */
PageVehicle *page_vehicle_new(Pool *pool, const Model *model, const Scene *scene, const Request *request,
                              const char **why, const char **remedy);
/* Has a recording targets for all inputs that the page moves, as those of pages have? */
bool page_vehicle_takes(const PageVehicle *page, const Scene *scene);
/* To time 0 with the scene's parameters, and a step, in which a recording drives if the scene has one. The instance,
 * of a general engine, follows: time, state, inputs. They return a status. */
int page_vehicle_start(const Scene *scene, const gic_model *model, gic_head *self);
int page_vehicle_step(const Scene *scene, const gic_model *model, gic_head *self);
/* The page's outputs at the present time in a copy of that instance. Returns a status. */
int page_vehicle_outputs(const Scene *scene, const gic_model *model, const gic_head *self, gic_head *copy);

#endif
