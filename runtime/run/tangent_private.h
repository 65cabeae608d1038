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
    bool shifted;                /* the run ended where a gear changes */
    int states, inputs, outputs; /* of the vehicle */
    Trail *trail;                /* NULL: forwards */
};

/* How the inputs change by a variable at a time: up to three numbers from the input on; returns how many. */
int tangent_input(const RunVariable *variable, double time, double change[3]);
/* State and inputs of the vehicle now: own[states + inputs]. */
void tangent_state(const TangentRun *run, double *own);
/* True if fast states take steps of their own. */
bool tangent_dual(const TangentRun *run);

#endif
