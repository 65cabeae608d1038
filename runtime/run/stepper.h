/* SPDX-License-Identifier: MIT
 *
 * stepper: steps of y' = f(t, y) whose length follows from the estimated error: by the GNU Scientific Library, or by
 * the plug-in with CVODE (host/bdf.h). */
#ifndef RUN_STEPPER_H
#define RUN_STEPPER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct Stepper Stepper;

/* What is integrated; functions as in BdfSystem. */
typedef struct StepperSystem {
    size_t count; /* 1 or more */
    int (*rate)(void *user, double time, const double *state, double *rate);
    int (*jacobian)(void *user, double time, const double *state, const double *rate, double *matrix);
    void *user;
} StepperSystem;

/* Is a plug-in that the method needs there? */
bool stepper_there(int32_t method);
/* Fail unless a plug-in that the method needs is there. */
void stepper_need(int32_t method);

/* `tolerance` bounds the estimated error of each number in a step: tolerance (1 + its magnitude). first: s, a step
 * where nothing is known. `system` stays where it is. NULL: no memory; where GSL gets none, the program ends with a
 * message (host/gsl_errors.h). Fails as stepper_need() does. */
Stepper *stepper_open(int32_t method, const StepperSystem *system, double tolerance, double first);
void stepper_close(Stepper *stepper);

/* Forget the history. */
void stepper_restart(Stepper *stepper);

/* One step from *time, no further than to `end`. *step: the length that is tried where there is no history, or as the
 * last step left it; then that of the next one. Returns 0, or -1 where no step is short enough. */
int stepper_step(Stepper *stepper, double *time, double end, double *step, double *state);

/* The rate at the begin and at the end of the last step, which has just been made. NULL: the rate function failed there
 * (CVODE's steps alone). */
const double *stepper_rate(Stepper *stepper);
const double *stepper_rate_there(Stepper *stepper);

#endif
