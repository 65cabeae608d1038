/* SPDX-License-Identifier: MIT
 *
 * variable: variable-step integration of any model, with the GNU Scientific Library (GPL). Host programs only. */
#ifndef RUN_VARIABLE_STEP_H
#define RUN_VARIABLE_STEP_H

#include "gic_runtime.h"

/* An integration of one instance under way; its history is here and not in the instance. */
typedef struct Variable Variable;

/* `tolerance` bounds the estimated local error of each number of the state: tolerance (1 + its magnitude). NULL: no
 * memory; where GSL gets none, the program ends with a message (host/gsl_errors.h). */
Variable *variable_open(const gic_model *model, int32_t method, double tolerance);
void variable_close(Variable *variable);

/* One step, as long as the tolerance and the detail of the road allow (road_resolution.h), that ends at `end` exactly
 * where it would pass it; end > time of `self`. A change of gear ends it as well, at the time at which it is due, to
 * tolerance / 100 s, and the beginning or end of a contact of gic_model.contacts (contact_watch.h); GIC_ERROR_EVENTS:
 * these come without end. On GIC_OK state, time and input[] have moved; otherwise they are
 * untouched, and the status is that of the last evaluation that failed, or GIC_ERROR_ARGUMENT where rounding alone
 * exceeds the tolerance. */
int variable_step(Variable *variable, void *self, double end);

/* Continue with other code for the same model that gives the same bits. */
void variable_change(Variable *variable, const gic_model *model);

/* Forget the history; call where state, inputs or their derivatives jump. */
void variable_restart(Variable *variable);

#endif
