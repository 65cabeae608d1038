/* SPDX-License-Identifier: MIT
 *
 * What tangent_run.c, forwards, and adjoint_run.c, backwards, share. */
#ifndef RUN_TANGENT_PRIVATE_H
#define RUN_TANGENT_PRIVATE_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/tangent_run.h"
#include "run/trail.h"

/* The instance of both: a head, then the arrays of the descriptor. */
typedef struct Both {
    gic_head head;
    const TangentRun *run;
} Both;

/* The rest of a step after a change of gear: where the change comes later by 1 s, all in it is later by the share of
 * `length` that is left, and rates act for 1 s less in `length`. */
typedef struct Rest {
    bool going;
    double end, length; /* s */
    double *late;       /* [carried] derivatives of the time of the change */
} Rest;

struct TangentRun {
    Pool *pool;
    const Model *model; /* of the vehicle */
    Solve solve;
    const Engine *engine; /* tape */
    const Scene *scene;
    const Linear *linear;
    const gic_model *code; /* of the vehicle */
    Instance *self, *copy; /* the vehicle at the state and time that were evaluated last; for looks */
    gic_model descriptor;  /* of both */
    Both *both;
    int variables, carried; /* carried: whose derivatives are in the state: all of them, or backwards none */
    RunVariable *variable;
    bool shifted; /* the run ended where a gear changes in a way that has no derivative */
    double *from; /* state of both where the step began */
    Rest rest;
    int states, inputs, outputs; /* of the vehicle */
    Trail *trail;                /* NULL: forwards */
};

/* How the inputs change by a variable at a time: up to three numbers from the input on; returns how many. */
int tangent_input(const RunVariable *variable, double time, double change[3]);
/* How the inputs change with time: rate[inputs], 0 where no profile sets them. */
void tangent_input_rates(const TangentRun *run, double time, double *rate);
/* The parts of the state of both: number k, 0: of the vehicle, to own[states] and back. */
void tangent_take(const TangentRun *run, const double *both, int k, double *own);
void tangent_put(const TangentRun *run, const double *own, int k, double *both);
/* linear->along by variable k with what the inputs of both are, but for the state. */
void tangent_point(const TangentRun *run, int k);
double *tangent_array(const TangentRun *run, size_t offset);
/* An event of the trail, if there is one: `first` and `second`, and behind them the inputs, but not of what is settled.
 */
void tangent_note(const TangentRun *run, TrailKind kind, double time, const double *first, int firsts,
                  const double *second, int seconds);
/* State and inputs of the vehicle now: own[states + inputs]. */
void tangent_state(const TangentRun *run, double *own);
/* Dependent Euler parameter and gears of an event, as the vehicle has them. */
void tangent_discrete(const TangentRun *run, TrailEvent *event);
/* The vehicle gets those of an event. */
void tangent_go(const TangentRun *run, const TrailEvent *event);
/* Time since the last change of gear, in a state or its derivatives. */
double *tangent_age(const TangentRun *run, double *state);
/* True if fast states take steps of their own. */
bool tangent_dual(const TangentRun *run);
/* Parts in which the rest of a step is made after a change of gear. */
int tangent_parts(const TangentRun *run);

/* tangent_gear.c: after a step that began at `start` (s): if a gear changes within it, go on from there. step: of the
 * trail, or NULL. Returns a status, GIC_ERROR_EVENTS with run->shifted where that has no derivative. */
int tangent_shift(TangentRun *run, double start, TrailStep *step);
/* Weights of the ends of a step in the state between them, a cubic, and how they change with the share. */
typedef struct Cubic {
    double from, to, rate, rate_there;
} Cubic;
Cubic tangent_between(double share, double step);
Cubic tangent_between_slope(double share, double step);

#endif
