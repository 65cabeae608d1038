/* SPDX-License-Identifier: MIT
 *
 * What the runs of a sweep have in common, side by side in lanes (lanes.c) or each by itself (run.c). */
#ifndef SWEEP_RUN_PRIVATE_H
#define SWEEP_RUN_PRIVATE_H

#include "gic_runtime.h"
#include "run/last_good.h"
#include "run/bounce_watch.h"
#include "run/stability_watch.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

enum { CHUNK = 4096 /* steps between checks for a request to stop */ };

/* End, least and greatest value of an output so far. */
typedef struct Range {
    double end, least, greatest;
} Range;

/* A run under way. */
typedef struct Slot {
    Pool *pool;  /* of this run */
    int64_t run; /* -1: none */
    Scene scene; /* its own; `user` of the instance */
    int status;
    const char *reason;   /* why it failed */
    double time;          /* of its last values */
    Range *range;         /* [columns] */
    MetricState *metric;  /* [metrics] */
    int64_t sample;       /* output times so far, */
    double *series;       /* and values at them, [series][samples]; NULL: not asked for */
    StepWatch *watch;     /* NULL: not watched */
    BounceWatch *bounces; /* the same */
    /* in lanes */
    gic_head *before; /* its vehicle at the last output time, if there was one, */
    Driver *driver;   /* and its driver; NULL: no driver */
    bool due;         /* its outputs are */
} Slot;

typedef struct Runner {
    const Sweep *sweep;
    int slots;
    Slot *slot;
    gic_head *one, *copy;
    LastGood *good; /* of a run by itself */
    StepTheory *theory;
    void *batch, *spare; /* spare: for one that fails; NULL: no lanes */
    double begun, looked;
    int64_t before; /* runs finished by others */
    bool shown, stopped;
    bool silent; /* another process prints progress */
} Runner;

/* ---- run.c */

/* Take up the next run of the supply: its first state is in r->one if its status is GIC_OK. False: there is none. */
bool run_begin(Runner *r, Slot *slot, const Supply *supply);
/* Judge what the run came to and hand the result over; the slot is free. */
void run_end(const Runner *r, Slot *slot, const Supply *supply);
/* The status of a slot, and if it is not GIC_OK what its instance knows of it. */
void run_set_status(const Runner *r, Slot *slot, int status, const gic_head *self);
/* The vehicle r->one can't go on: its last good state counts like an output time, if it is not at one. failed: an
 * instance that knows why. */
void run_end_failed(Runner *r, Slot *slot, const gic_head *failed);
/* Record the values at an output time. value: of a signal of a vehicle. */
void run_sample(const Sweep *sweep, Slot *slot, double time, double (*value)(const void *of, int signal),
                const void *of);
/* From time to time: progress, and r->stopped. */
void run_look_around(Runner *r);

/* ---- rest.c */

/* Has each run an equilibrium of its own to begin in? */
bool rest_varies(const Sweep *sweep);
/* Let a scene, with the numbers of a run, begin in its equilibrium. False: there is none, *why says so. */
bool rest_find(Pool *pool, const Sweep *sweep, Scene *scene, const char **why);

/* ---- lanes.c */

/* Make runs side by side, a lane each, until the supply ends or someone asks to stop. A run that ends leaves its lane
 * to the next one. */
void lanes_run(Runner *r, const Supply *supply);

#endif
