/* SPDX-License-Identifier: MIT
 *
 * What adjoint_run.c and adjoint_dual.c share: derivatives of a run's number on the way back. */
#ifndef RUN_ADJOINT_PRIVATE_H
#define RUN_ADJOINT_PRIVATE_H

#include "run/tangent_private.h"

enum { RK4_STAGES = 4 };

/* All numbers are derivatives of the run's number, but for its value. */
typedef struct Back {
    TangentRun *run;
    double *state;   /* [states] by the state where it has come to */
    double *rate[3]; /* [states] by the rates at the starts of this step and the two before it; of dual rate those
                        of the fast states are at fast steps */
    double *link[4]; /* [links] of dual rate: at the start of this step and the two before it, and at its end */
    double *sum, *stage[3]; /* [states] work */
    Rest rest;              /* of a piece whose ends move */
    double *from;           /* [states] by the state at the start of the step */
    double *start_rate;     /* [states] by the rate at the start of the step, besides those that steps sum */
    double *moment;         /* [fast steps and 2 before][states] work of dual rate */
    double *sums;           /* [all_sums] the four below */
    int all_sums;
    double *derivative; /* [variables] of inputs */
    double *parameter;  /* [parameters] */
    double *clock;      /* [clocks] by the times that move */
    double *present;    /* [profiles] by the value from which a profile has begun */
    DriveSlope drive;   /* by what the driver keeps */
    double value;       /* the number itself */
} Back;

/* A knot of the inputs within a step. */
typedef struct Knot {
    double time, step;
} Knot;

/* Back through what was evaluated, whose derivatives are in linear->drate or, of links, in linear->link[1]: adds those
 * by parameters and inputs to their sums, and leaves those by the state in linear->along.y, and of fast rates those by
 * the links in linear->link[1]. weight: of the output, of a rate. knot: inputs were bent there; NULL: they were not.
 * Returns a status. */
int event_back(Back *back, const TrailEvent *event, double weight, const Knot *knot);
/* The dependent Euler parameter followed from the others. */
void settle_back(Back *back, const TrailEvent *settled);
/* Back through a right-hand side with derivatives by its rate; those by the state are in linear->along.y. */
int rate_back(Back *back, const TrailEvent *call, const double *by_rate, double weight, const Knot *knot);
/* The same of the state that a sample sees, by all outputs of the model [output_count]. */
int outputs_back(Back *back, const TrailEvent *event, const double *by_output);
/* The same by the number of a contact. */
int press_back(Back *back, const TrailEvent *event, int contact, double weight);
/* adjoint_sample.c: back through samples of controllers, the first of two events; weight: of the output before them.
 * Returns a status. */
int sample_back(Back *back, int event, double weight);
/* Add derivatives by the inputs at a time to those by the driver's movements; back through a look, to the driver before
 * it. */
void drive_inputs_back(Back *back, double time, const double *by, const Knot *knot);
void drive_look_back(Back *back, const TrailEvent *look);
/* Add derivatives by the inputs at a time to those by the numbers of profiles. */
void inputs_back(Back *back, double time, const double *by, const Knot *knot);
/* Back through a step, or a part of one, but for what was before it. weight: of the output at its start. */
int part_back(Back *back, const TrailStep *step, double weight);
/* adjoint_event.c: the same through the piece whose last part is step `last` of the trail, and which ends where a
 * condition becomes true. */
int located_back(Back *back, int64_t last, double weight);
/* Back through the changes of inputs at the start of a step. */
void happenings_back(Back *back, const TrailStep *step);
/* By the inputs at a time, as profiles have begun there. */
void begun_inputs_back(Back *back, double time, const double *by);
/* By a clock, as inputs and the time of what has just been pulled follow it. */
void clock_back(Back *back, int clock, double time);
/* Back through a step of RK4 of h seconds, whose right-hand sides are four events from `event` on, and then its state.
 * by_rate: by the rate at its start; weight: of the output there. */
int rk4_back(Back *back, int event, double h, const double *by_rate, double weight);
/* to += factor * from; to = factor * from */
void adjoint_add(int count, double factor, const double *from, double *to);
void adjoint_set(int count, double factor, const double *from, double *to);

/* adjoint_gear.c: back through the change of gear within a step and the rest of the step after it, to the state at its
 * end without it; back->from and back->start_rate are set. Returns a status. */
int gear_back(Back *back, const TrailStep *step);
/* adjoint_dual.c: back through a step of dual rate. weight: of the output at its start. Returns a status. */
int dual_back(Back *back, const TrailStep *step, double weight);
/* Back through `parts` parts of h seconds, two by RK4 and others by AB3, whose events begin at `first`: right-hand
 * sides and the settled state of each. Derivatives by the rates at their starts are in back->moment, see fast_moment().
 */
int parts_back(Back *back, int first, int parts, double h, double weight);
/* Derivatives [states] by the rates at fast step k, from -2. */
double *fast_moment(const Back *back, int k);
/* None by any of them. */
void clear_moments(Back *back);

#endif
