/* SPDX-License-Identifier: MIT
 *
 * linear_model: a vehicle about an operating point as the linear system dz/dt = f + A z + B u + E p,
 * y = y0 + C z + D u + F p, where u, p and y - y0 are changes of inputs, parameters and outputs: gicrun --linearize. */
#ifndef RUN_LINEAR_MODEL_H
#define RUN_LINEAR_MODEL_H

#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"
#include "subset/subset.h"

/* Where a linear model is taken. */
typedef struct OperatingPoint {
    const Linear *linear;
    Instance *self;       /* with the inputs of its time; the rest as linear_start() wants it */
    const Source *source; /* whose initial state or inputs it follows, for messages */
    const char *text;     /* "about the static equilibrium" */
} OperatingPoint;

/* linear_point.c: the static equilibrium as --modes has it, with the velocities of the scene, NULL: none. And: the
 * state of a run of the scene at a time, s; with constant steps that of the last step that does not pass it. `model`
 * and scene as scene_rig() leaves them. Both end in diag_fail where there is no such state. */
OperatingPoint operating_point_rest(Pool *pool, const Model *model, const Scene *scene, Solve solve);
OperatingPoint operating_point_run(Pool *pool, const Model *model, const Scene *scene, Solve solve, double time);
/* One of them; time: NaN: that at rest. */
OperatingPoint operating_point(Pool *pool, const Model *model, const Scene *scene, Solve solve, double time);

/* linear_model.c: matrices by rows; columns are those of the names. */
typedef struct LinearModel {
    int states, inputs, outputs, parameters, neutral;
    gic_signal *state, *rate, *input, *output, *parameter; /* names and units; inputs: with ports */
    double time, base[7];                                  /* base: place and Euler parameters, of a free base */
    bool free_base;
    /* at the operating point; z0: places of a free base are 0, since they count from there */
    double *f, *z0, *u0, *y0, *p0;
    double *A, *B, *C, *D, *E, *F;
    /* what is held as it is: the time since a shift, values of controllers, the gears */
    int held;
    gic_signal *held_name;
    double *held_value;
    /* Directions of places and fast states in which nothing happens but that: no acceleration and no rate of a fast
     * state changes. N: [states][neutral], with a 1 for the state that names the direction and 0 for those that name
     * others. */
    double *N;
    const char **neutral_name;
} LinearModel;

/* Ends in diag_fail where the state has no derivatives; warns where rates or outputs jump unless `quiet`. */
const LinearModel *linear_model(Pool *pool, const OperatingPoint *point, int outputs, bool quiet);

/* linear_report.c: the endings of files that are known; --linearize: what was found for people on standard output, and
 * the file. */
bool linear_file_known(const char *path);
void linear_report(Pool *pool, const Model *model, const OperatingPoint *point, const Request *request);

#endif
