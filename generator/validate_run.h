/* SPDX-License-Identifier: MIT
 *
 * Blocks of a formulation called in the order in which the templates call them, at several states side by side. */
#ifndef VALIDATE_RUN_H
#define VALIDATE_RUN_H

#include "validate.h"
#include "validate_play.h"

typedef struct Run {
    Pool *pool;
    const Formulation *formulation;
    const Plan *plan;
    const Model *model;
    const bool *reacts; /* [subsets] whose multipliers outputs need; NULL: none */

    /* What callers give: states with fast ones behind, inputs, parameters, ports, gears, time, by rows; and the values
     * and rates of all coordinates. */
    Values *y, *u, *p, *port, *gear, *x, *xd;
    Values time;

    /* What blocks find: Plan says where; rate as y. */
    Values *e, *m, *n, *start, *lambda, *link, *grip, *watch, *torque, *rate, *out, *pose, *tau, *derived, *choice,
        *acc, *energy;
    double *settled;             /* of m, NAN: in memory */
    Values residual;             /* largest of all subsets */
    const char *refused[STATES]; /* status, NULL: all went well */
    const char *where[STATES];   /* block that refused */
    struct RunPrograms *programs;
    Scenery scenery;
    Values *frame;
} Run;

/* In refused[] where corrections find no pose. */
extern const char run_lost[];
/* Everything recorded. */
Run *run_new(Pool *pool, const Formulation *formulation, const gic_road *road);
/* From y, u, p, port, gear and time all of the others. */
void run_evaluate(Run *run);
/* tau[] for accelerations acc [unknowns], after run_evaluate(). */
void run_inverse(Run *run, Values *acc);
/* Prediction and corrections with old factors, as code takes them from the configuration that was evaluated to one
 * nearby (coordinates that are held [coordinates] stay), after run_evaluate(), which has to be called again after it:
 * calls `found` for every subset that follows with the squares of the size of the move and of two corrections. */
void run_follow(Run *run, const bool *held, void (*found)(void *context, int subset, Values size[3]), void *context);
/* A number of a body's motion: MOTION_C and so on, of a state. */
double run_motion(const Run *run, int body, int number, int state);

#endif
