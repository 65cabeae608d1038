/* SPDX-License-Identifier: MIT
 *
 * Run time against error of complete vehicles: precision_run.c, ways to integrate a scene and the reference solution;
 * precision.c, the experiment. */
#ifndef BENCH_PRECISION_H
#define BENCH_PRECISION_H

#include "bench/bench.h"

/* When the gear changes. */
typedef enum GearChange {
    GEAR_BY_RUNTIME, /* as the step functions do it */
    GEAR_AT_END,     /* at the end of the step in which the change is due */
    GEAR_BISECTED /* variable steps: the step before a change is repeated by bisection, here and not in the runtime */
} GearChange;

/* A way to integrate a scene. */
typedef struct Ride {
    Setting setting;
    int32_t ratio; /* AB3: fast steps in a step */
    GearChange change;
    bool locate;  /* constant steps are made in parts at contacts */
    int32_t keep; /* implicit steps with one Jacobian */
} Ride;

/* Positions at output times: of the base, or of all bodies where the base is fixed. */
typedef struct Track {
    int rows, bodies;
    double *point; /* [rows][bodies][3] m, world; NAN from where a run has ended */
} Track;

/* How a run ended. */
typedef struct RideEnd {
    int status;
    double time;       /* s */
    double second;     /* CPU time, s */
    int64_t rhs, fast; /* right-hand sides; evaluations of the fast rates alone */
    int changes;       /* of gear, 0 with GEAR_BY_RUNTIME */
    int64_t contacts;  /* made or lost, that were looked for */
} RideEnd;

/* A solution that others are compared with, and two by other methods. */
typedef struct Reference {
    Track track;
    const char *name, *check[2]; /* how they are computed */
    double distance[2];          /* m, of check[] from the reference; INFINITY: that run ends early */
    bool shifts, touches;        /* the gear changes on the way; contacts do */
    double uncertainty;          /* m, the smaller one: the nearest solution by another method */
} Reference;

Track track_new(Pool *pool, const Scene *scene, const gic_model *code);
/* Largest distance (m) of two bodies at the same time; INFINITY where one of the tracks ends early. */
double track_distance(const Track *a, const Track *b);
/* A run of a scene; track: NULL, or filled. */
RideEnd ride_run(const Engine *engine, gic_head *self, const Scene *scene, const Ride *ride, Track *track);
/* Ends in diag_fail where the scene does not run to its end. */
Reference precision_reference(const Bench *bench, const Engine *engine, gic_head *self, const Scene *scene);

/* ---- equal_error.c ----------------------------------------------------------------------------------------------- */

/* The rows of one way whose errors are known, in the order of their accuracy. */
typedef struct WayRows {
    const char *way;
    int rows;
    const double *error;         /* [rows] m */
    const double *const *second; /* [rows][repetitions] CPU time */
} WayRows;

/* CPU time within an error: of the first row that keeps it, or between that and the one before, along a straight line
 * in logarithms. NAN: no row keeps it. */
double equal_error_second(const WayRows *rows, double error, int repetition);
/* A table of times within errors of whole powers of ten, over that of the first way: median, lowest and highest ratio
 * of all repetitions. model, scene: names. */
void equal_error_tell(Report *report, const char *name, const char *model, const char *scene, const WayRows *way,
                      int ways, int repetitions);

#endif
