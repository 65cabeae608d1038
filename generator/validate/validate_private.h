/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of generator/validate. */
#ifndef VALIDATE_VALIDATE_PRIVATE_H
#define VALIDATE_VALIDATE_PRIVATE_H

#include "model/model.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "validate/run.h"
#include "vehicle/vehicle.h"

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

/* Find the numbers at which formulas may have kinks: those that stand in one formula with a time, a coordinate, its
 * rate, an input or a spin. */
void kinks_find(Validator *v);

/* states.c: put state `index` (0: the design at rest) into column k of the run. */
void state_place(const Validator *v, int index, int k);

#endif
