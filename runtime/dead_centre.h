/* SPDX-License-Identifier: MIT
 *
 * Why the coordinates of a subset stopped determining its bodies: which coordinate, at which value, and which one
 * would go on there. */
#ifndef DEAD_CENTRE_H
#define DEAD_CENTRE_H

#include "engine.h"

typedef struct DeadCentre {
    const char *finding, *remedy; /* for a message; finding NULL: no dead centre near by */
} DeadCentre;

/* Look for a dead centre ahead of the last good state. model: as the engine has it; last: an instance whose outputs are
 * computed at that state; subset: the one that was lost, -1: not known. */
DeadCentre dead_centre_find(Pool *pool, const Model *model, const gic_model *code, gic_head *last, int subset);

#endif
