/* SPDX-License-Identifier: MIT
 *
 * What the files of the validation share. */
#ifndef VALIDATE_WORK_H
#define VALIDATE_WORK_H

#include "mirror.h"
#include "validate_run.h"

typedef struct Validator {
    Pool *pool;
    const Model *model;
    Run *run;
    const Validation *scene; /* with facts: states that a scene can have */
    const Facts *facts;
    const Mirror *mirror; /* NULL: both sides are computed */
    struct Kinks *kinks;
    const double *geometry; /* [tunables] values of geometric parameters, NULL: those of the file */
} Validator;

/* Where formulas may bend: numbers that stand in one with a time, a coordinate, its rate, an input or a spin. */
void kinks_find(Validator *v);

/* validate_states.c: state `index` of those that are looked at, from 0, into column k of the run. Number 0 is the
 * design at rest. */
void state_place(const Validator *v, int index, int k);

#endif
