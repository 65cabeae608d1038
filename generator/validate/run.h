/* SPDX-License-Identifier: MIT
 *
 * Calls the blocks of a formulation in the order of the templates, at several states side by side. */
#ifndef VALIDATE_RUN_H
#define VALIDATE_RUN_H

#include "gic_runtime.h"
#include "model/model.h"
#include "validate/play.h"
#include "vehicle/vehicle.h"

typedef struct Run {
    Pool *pool;
    const Formulation *formulation;
    const Plan *plan;
    const Model *model;
    const bool *reacts; /* [subsets] whose multipliers outputs need; NULL: none */

    /* Inputs, by rows: states followed by fast states, inputs, parameters, ports, gears, time; values and rates of all
     * coordinates. */
    Values *y, *u, *p, *port, *gear, *x, *xd;
    Values time;

    /* Results; Plan has the places; rate is ordered as y. */
    Values *e, *m, *n, *start, *lambda, *link, *grip, *watch, *torque, *rate, *out, *pose, *tau, *derived, *choice,
        *acc, *energy;
    double *settled;             /* [numbers of m] value of constant ones, NAN: in memory */
    Values residual;             /* largest residual of all subsets */
    const char *refused[STATES]; /* status; NULL: no check failed */
    const char *where[STATES];   /* the block that refused the state */
    struct RunPrograms *programs;
    Scenery scenery;
    Values *frame;
} Run;

/* The value of refused[] if corrections find no pose. */
extern const char run_lost[];
/* A run with all blocks translated. */
Run *run_new(Pool *pool, const Formulation *formulation, const gic_road *road);
/* Compute all results from y, u, p, port, gear and time. */
void run_evaluate(Run *run);
/* tau[] for accelerations acc [unknowns], after run_evaluate(). */
void run_inverse(Run *run, Values *acc);
/* After run_evaluate(): prediction and corrections with old factors, as code takes them, from the evaluated
 * configuration to one nearby (coordinates that are held [coordinates] stay). Calls `found` for every subset with an
 * iteration, with the squared sizes of the move and of two corrections. Call run_evaluate() again afterwards. */
void run_follow(Run *run, const bool *held, void (*found)(void *context, int subset, Values size[3]), void *context);
/* A number of a body's motion: MOTION_C and so on, of a state. */
double run_motion(const Run *run, int body, int number, int state);

#endif
