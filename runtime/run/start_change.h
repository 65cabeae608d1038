/* SPDX-License-Identifier: MIT */
#ifndef RUN_START_CHANGE_H
#define RUN_START_CHANGE_H

#include "run/tangent_run.h"

/* After the state at time 0 of run->scene has been set: change[variables][states] becomes the derivatives of that
 * state, but for the dependent Euler parameter, by all variables: small motions themselves; by parameters and inputs
 * those of the equilibrium that the run starts in, and of what rolls from there. Returns a status. */
int start_changes(TangentRun *run, double *change);

#endif
