/* SPDX-License-Identifier: MIT
 *
 * adjoint_run: the derivatives of one number of a run by all variables at once, backwards through its steps. */
#ifndef RUN_ADJOINT_RUN_H
#define RUN_ADJOINT_RUN_H

#include "run/tangent_run.h"

/* The run's number: the sum over all ends of steps, the start included, of a weight times the model's first output. */
typedef double AdjointWeight(const void *context, int64_t step);

/* True if the trail of a run of that many steps is small enough for it: adjoint_most bytes. */
extern const double adjoint_most;
bool adjoint_fits(const Model *model, const Scene *scene);
/* After tangent_open_backwards(), tangent_begin() and all steps of the scene: the number, and its derivatives
 * [variables]. by_end: of the number by the time at which a condition ends the run, besides what the output has of it.
 * Returns a status. */
int adjoint_find(TangentRun *run, AdjointWeight *weight, const void *context, double by_end, double *value,
                 double *derivative);

#endif
