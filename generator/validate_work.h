/* SPDX-License-Identifier: MIT
 *
 * What the files of the validation share. */
#ifndef VALIDATE_WORK_H
#define VALIDATE_WORK_H

#include "validate_run.h"

struct World;

typedef struct Validator {
    Pool *pool;
    const Model *model;
    Run *run;
    struct World *world;
} Validator;

/* validate_states.c: state `index` of those that are looked at, from 0, into column k of the run. Number 0 is the design
 * at rest. */
void state_place(const Validator *v, int index, int k);

#endif
