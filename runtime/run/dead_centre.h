/* SPDX-License-Identifier: MIT
 *
 * Explains why the coordinates of a subset no longer determine its bodies: which coordinate, at which value, and
 * which other coordinate would continue there. */
#ifndef RUN_DEAD_CENTRE_H
#define RUN_DEAD_CENTRE_H

#include "gic_runtime.h"
#include "model/model.h"

typedef struct DeadCentre {
    const char *finding, *remedy; /* texts of a message; finding NULL: there is no dead centre nearby */
} DeadCentre;

/* Look for a dead centre ahead of the last good state. model: as the engine has it; last: an instance with outputs
 * computed at that state; subset: the one that was lost, -1: not known. */
DeadCentre dead_centre_find(Pool *pool, const Model *model, const gic_model *code, gic_head *last, int subset);

#endif
