/* SPDX-License-Identifier: MIT
 *
 * tangent_run: a run of a scene in constant steps, with the derivatives of its state and outputs by its initial state,
 * tunable parameters and inputs. */
#ifndef RUN_TANGENT_RUN_H
#define RUN_TANGENT_RUN_H

#include "base/pool.h"
#include "model/model.h"
#include "run/linearize.h"
#include "scene/scene.h"

/* A number by which is differentiated: one of the small motions (linearize.h) at time 0, a parameter, a number of an
 * input's profile. */
typedef enum VariableKind { BY_INITIAL, BY_PARAMETER, BY_INPUT } VariableKind;

typedef struct RunVariable {
    const char *name, *unit; /* "parameter/k" */
    VariableKind kind;
    int index, number;      /* small motion, parameter, input; number: of the input's profile */
    const Profile *profile; /* of an input: what it changes by for a unit of the number; NULL: by 1 at all times */
    double value;           /* in the scene */
} RunVariable;

typedef struct TangentRun TangentRun;

/* model: with condition_outputs() of the scene, after which those that controllers read may come; else conditions are
 * refused. wanted, count: names of variables, or `initial`, `parameter`, `input` for all of a kind; 0: all. The scene
 * starts as it says, not in equilibrium: tangent_rests(). Ends in diag_fail for scenes that can not be differentiated,
 * or in diag_fail_call for names that are none. */
TangentRun *tangent_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const char *const *wanted,
                         int count);
/* The same for the way back: steps have no derivatives, and leave a trail for adjoint_run.h. */
TangentRun *tangent_open_backwards(Pool *pool, const Model *model, const Scene *scene, Solve solve,
                                   const char *const *wanted, int count);
int tangent_variables(const TangentRun *run, const RunVariable **variable);
/* The scene starts in this equilibrium, which follows parameters and inputs. NULL: where it says. */
void tangent_rests(TangentRun *run, const Equilibrium *found);
/* Time 0 of the scene that it was opened for, which may have other initial values and parameters now. */
int tangent_begin(TangentRun *run, const Scene *scene);
/* A step of it, or less where a condition ends the run. All of these return a status. */
int tangent_step(TangentRun *run);
/* The model's outputs now, and their derivatives [outputs][variables], none of those on the way back. */
int tangent_look(TangentRun *run, double *value, double *slope);
/* True if a condition has ended the run, for which no more steps are made. *late: derivatives of its time by all
 * variables, none of those on the way back; NULL: it stays. */
bool tangent_ended(const TangentRun *run, const double **late);
double tangent_time(const TangentRun *run);
/* End with the message of a status. */
_Noreturn void tangent_fail(const TangentRun *run, int status);

#endif
