/* SPDX-License-Identifier: MIT
 *
 * formula_blame: which formula of a model has no finite value or derivative at a state. */
#ifndef RUN_FORMULA_BLAME_H
#define RUN_FORMULA_BLAME_H

#include "base/message.h"
#include "model/model.h"
#include "run/linearize.h"

typedef struct Blame {
    const char *what; /* "signal 'a'", "force 'spring'" */
    Place at;         /* of the signal or force element */
    bool has_value;   /* it has one, and no derivative */
} Blame;

/* The first such formula that reads no other such one: of forces along coordinates, of the model's own states, of
 * signals that it shows. self: an instance
 * of the engine `tape` of that model, at the state, time and inputs; along: the direction, as of linear_slope(). False:
 * none is found. */
bool formula_blame(Pool *pool, const Model *model, Solve solve, const Instance *self, const Direction *along,
                   Blame *blame);

#endif
