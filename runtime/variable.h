/* SPDX-License-Identifier: MIT
 *
 * variable: variable-step integration of any model, with the GNU Scientific Library (GPL). Host programs only. */
#ifndef VARIABLE_H
#define VARIABLE_H

#include "gic_runtime.h"

/* Beside the methods of gic_runtime.h (gic_method), which have constant steps. */
enum {
    METHOD_ADAMS = 100, /* Adams-Moulton, variable step and order 1 to 12: the stand-in for the paper's DDABM */
    METHOD_RKCK         /* Runge-Kutta after Cash and Karp, order 5: cheaper than Adams down to errors of 1e-8 */
};

/* An integration in progress of one instance, whose history is kept here and not in the instance. */
typedef struct Variable Variable;

/* `tolerance` bounds the estimated local error of each number of the state: tolerance (1 + its magnitude). NULL: no
 * memory; where GSL gets none, the program ends with a message (gsl_errors.h). */
Variable *variable_open(const gic_model *model, int32_t method, double tolerance);
void variable_close(Variable *variable);

/* One step, as long as the tolerance and the detail of the road allow (resolve.h), that ends at `end` exactly where it would pass it; end > time of `self`.
 * On GIC_OK state, time and input[] have moved; otherwise they are untouched, and the status is that of the last
 * evaluation that failed, or GIC_ERROR_ARGUMENT where rounding alone exceeds the tolerance. */
int variable_step(Variable *variable, void *self, double end);

/* From here on by other code for the same model, which gives the same bits from the same instances. */
void variable_change(Variable *variable, const gic_model *model);

/* Forget the history, because state, inputs or their derivatives jump here. */
void variable_restart(Variable *variable);

#endif
