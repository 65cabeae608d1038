/* SPDX-License-Identifier: MIT
 *
 * Limits of numbers that follow tunable parameters. */
#ifndef MODEL_LIMITS_H
#define MODEL_LIMITS_H

#include "expression/expression.h"
#include "model/model.h"

/* A number of a force element, law - less (NULL: 0), that must be greater than 0 (`zero`: at least 0); or a matrix that
 * must be positive semidefinite. */
typedef struct Limit {
    const Law *law, *less;
    bool zero;
    const char *text;         /* "fade of force 'stop' must be greater than zero" */
    const Law *const *matrix; /* [BUSHING_NUMBERS], as a Bushing has them; NULL: a number */
} Limit;

/* What values of parameters break: a Limit, or a Condition of the model's Tuning, whose formula it is then. */
typedef struct BrokenLimit {
    const char *text;
    const Limit *limit;
    Ex formula;
    double number;
} BrokenLimit;

/* Add a limit, unless it follows no tunable parameter. */
void limit_add(Pool *pool, Model *model, const Limit *limit);

/* Is the symmetric matrix a, a lower triangle row by row, positive semidefinite but for the digits of a file? */
bool limit_semidefinite(const double a[BUSHING_NUMBERS]);

/* Do these values (model->tunables of them) break a limit, with the geometry's of set-up at the given lengths? */
bool limit_broken(const Model *model, const double *value, BrokenLimit *broken);
/* Does what is broken follow the tunable parameter with this index? */
bool limit_follows(const Model *model, const BrokenLimit *broken, int index);

#endif
