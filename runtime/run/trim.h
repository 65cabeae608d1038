/* SPDX-License-Identifier: MIT
 *
 * trim: steady driving, straight ahead or in a circle: the state and the inputs with which a vehicle keeps it
 * (gicrun --trim), by the definitions of models/SCENE.md section 8. */
#ifndef RUN_TRIM_H
#define RUN_TRIM_H

#include "base/pool.h"
#include "model/model.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"

/* What is wanted. */
typedef struct TrimGoal {
    double speed;     /* m/s, > 0, of the origin of the base in the plane */
    double curvature; /* of its way, 1/m; to the left > 0 */
    int gear;         /* TRIM_ANY_GEAR: the highest forward one in which it can be kept and that is not left */
    int steer, drive; /* inputs that are found; -1: none */
    int brake;        /* input that is found instead of `drive` where that would be below 0; -1: none */
    bool pedal;       /* `drive` is a pedal, from 0 to 1 */
} TrimGoal;

enum { TRIM_ANY_GEAR = 1000 };

typedef struct Trim {
    TrimGoal goal;
    const Equilibrium *found; /* whose instance is in this motion, with the inputs that it takes; neutral: NULL */
    bool held;                /* nothing drives: the speed is held, and changes by `slowing`, m/s^2, if it is not */
    double slowing;
    bool shifts; /* the transmission would leave the gear */
    int gear;
    int steps; /* of Newton's method, in all */
} Trim;

/* trim.c: ends in diag_fail where there is no such motion. `model` and scene (NULL: none) as scene_rig() leaves them.
 */
const Trim *trim_find(Pool *pool, const Model *model, const Scene *scene, Solve solve, const TrimGoal *goal);

/* trim_report.c: the goal of the words key=value of the command line; ends in diag_fail_call. */
TrimGoal trim_goal(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* The motion in words: "steady cornering at 10 m/s, ...". */
const char *trim_text(Pool *pool, const TrimGoal *goal);
/* The operating point of --linearize --trim. */
OperatingPoint operating_point_trim(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* The endings of files that are known; --trim: tables and the start of a scene; the file, a row that --eval reads or a
 * scene. */
bool trim_file_known(const char *path);
void trim_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);

#endif
