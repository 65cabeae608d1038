/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of gicrun --drive. */
#ifndef RUN_DRIVE_H
#define RUN_DRIVE_H

#include "base/text.h"
#include "engine/engine.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/scene.h"

/* ---- drive_scene.c: the scene as tables of C --------------------------------------------------------------------- */

/* Road, initial state, profiles, driver and hands, as templates/drive.c.in includes them. Fails if the page can not
 * have the scene: variable steps, a road of too many numbers. */
void drive_scene(Text *out, const Model *model, const Scene *scene);

/* ---- drive_code.c: the vehicle as WebAssembly -------------------------------------------------------------------- */

/* The module's bytes; NULL: no compiler makes it here, *why says why, and *remedy what to do. */
const char *drive_code(Pool *pool, const Model *model, const Scene *scene, const Request *request, size_t *size,
                       const char **why, const char **remedy);

/* ---- drive_roles.c: which input does what ------------------------------------------------------------------------ */

/* Of the inputs that are driven; -1: none. left: the value of steering at the left end, right: at the right one. */
typedef struct Roles {
    int accelerator, brake, steering, selector;
    double left, right;
} Roles;

/* Steering is the input that turns wheels about the vertical, by poses at the scene's initial state. */
Roles drive_roles(Pool *pool, const Model *model, const Scene *scene, const Engine *engine);

#endif
