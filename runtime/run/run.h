/* SPDX-License-Identifier: MIT
 *
 * run: what gicrun does: engines by name, scenes step by step, equilibrium, pages. */
#ifndef RUN_RUN_H
#define RUN_RUN_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/variable_step.h"
#include "scene/scene.h"

/* The rows of a run in memory: what the results file would have. */
typedef struct RunColumns {
    Pool *pool;
    int columns;
    int64_t rows;
    gic_signal *signal; /* [columns] */
    double *value;      /* [rows][columns] */
    int64_t room;       /* rows that fit */
} RunColumns;

/* What is asked for. */
typedef struct Request {
    const char *scene;     /* path; NULL: none */
    const char *states;    /* the file of evaluate() */
    bool loads, joints;    /* of kc_report(): compliance; what joints carry */
    const char *axle;      /* of kc_report(); NULL: all */
    double travel;         /* the same, m; 0: as usual */
    const char *report;    /* of kc_report() and manoeuvre_report(): a page; NULL: none */
    const char *compare;   /* of them and sheet_report(): the file of another model; NULL: none */
    const char *manoeuvre; /* its name */
    const char *trace;     /* of manoeuvre_report(): a file of all trials; NULL: none */
    const char *formula;   /* of gradient_report() */
    const char *measured;  /* of identify_report(): a file */
    int keys;              /* words key=value of manoeuvres and steady driving; names of the two before */
    const char *const *key;
    int varied; /* words name=low:high:count of study_sweep() */
    const char *const *vary;
    const char *results;          /* "-": standard output; NULL: none */
    RunColumns *columns;          /* of simulate(): the same in memory; NULL: not wanted */
    const char *picture;          /* the same: a picture, or NULL */
    const char *with;             /* the same: results of another run, or NULL */
    const struct CsvTable *other; /* what is in it */
    const char *page;             /* the same: a page that moves, or NULL */
    const char *driven;           /* of drive_write(): its page */
    const char *record;           /* of live(): inputs as they were held; NULL: not wanted */
    const char *inputs;           /* the same: names of those that packets give, between commas; NULL: all */
    const char *joystick, *axes;  /* the same: a device that drives, and what it moves; NULL: packets alone do */
    int port;                     /* the same: of UDP, 0: one that is free */
    double seconds;               /* the same: of the run; 0: until it is interrupted */
    const char *engine;           /* of manoeuvres: one of engine_name */
    Solve solve;
    Recovery recovery;
    const char *compiler; /* command, perhaps with options */
    const char *flags;    /* more options of the compiler */
    bool quiet;
} Request;

/* ---- animate.c: a page of HTML in which the model moves */

typedef struct Animation Animation;

/* Before a run of a scene, whose name the page shows; other: results of another run, which it shows too as curves and
 * as a second vehicle, and their name; NULL: none. */
Animation *animation_new(Pool *pool, const Model *model, const Engine *engine, const Scene *scene,
                         const char *scene_path, const struct CsvTable *other, const char *other_name);
/* At each output time, after outputs are computed: record a frame if one is due. Returns a status. */
int animation_frame(Animation *animation, const gic_model *code, gic_head *self);
/* The page; exits with a message when it can't be written. */
void animation_write(Animation *animation, const char *path);

/* ---- drive.c: a page of HTML in which someone drives the model through the scene */

/* The page request->driven, in which the vehicle is compiled to WebAssembly. engine: any, for poses and names. Exits
 * with a message when no compiler for it is there, or the page can't be written. */
void drive_write(Pool *pool, const Model *model, const Scene *scene, const Engine *engine, const Request *request);

/* ---- live.c: a scene as fast as time passes, with inputs and outputs by packets; models/LIVE.md */

typedef struct LivePort LivePort;

/* The scene with the inputs request->inputs from outside. Fails where steps are not constant, or there are no such
 * inputs. */
const Scene *live_scene(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* Run it at an open port (live_port_open()), which is closed then. A failure on the way keeps what was recorded, and
 * ends in diag_fail. */
void live(Pool *pool, const Engine *engine, const Model *model, const Scene *scene, LivePort *port,
          const Request *request);
/* A port of the loopback interface, 0: one that is free. Fails if it is taken, or if the names of inputs and outputs do
 * not fit into a packet. */
LivePort *live_port_open(Pool *pool, int port, const Model *model, const Scene *scene);

/* ---- simulate.c, evaluate.c */

/* Bring an instance to a scene's initial state, on its road and with its inputs. Returns the status of setup. */
int scene_start(const Engine *engine, const Scene *scene, gic_head *self);
/* The present value of signal[i] of a scene, of an instance whose outputs are computed. */
double scene_value(const gic_model *code, gic_head *self, int i);
/* The part of it for fast states: wheels roll, except fast states that the scene (NULL: none) gives. Returns a status.
 */
int scene_set_fast(const gic_model *model, const Scene *scene, gic_head *self);
/* The driver of a scene, if it has one, looks where it is time for that; engines with another state than the standard
 * one need a right-hand side for it. Returns a status. */
int scene_look(const Engine *engine, const Scene *scene, gic_head *self);
/* One step of a scene, by the engine's code or faster one: a constant one, or where `variable` is given one towards
 * `end` that stops at kinks of inputs. Before it the driver looks, where it is time for that. */
int scene_step(const Engine *engine, const gic_model *model, const Scene *scene, Variable *variable, gic_head *self,
               double end);
/* The step itself, without driver and sleep. */
int scene_step_awake(const Engine *engine, const gic_model *model, const Scene *scene, Variable *variable,
                     gic_head *self, double end);
/* Outputs at the present time, computed on a copy of the instance, so that how often someone looks leaves no trace in
 * the results; those of a vehicle that sleeps stay. *slumber: 0 at first, and the same number from call to call. */
int scene_outputs(const gic_model *model, const Scene *scene, const gic_head *self, gic_head *copy, int64_t *slumber);
/* equilibrium.c: the scene, or if it asks for it a scene that starts in static equilibrium. Ends in diag_fail if there
 * is none. */
const Scene *equilibrium_start(Pool *pool, const Model *model, const Scene *scene, Solve solve);
/* Run a scene: results, picture, page (animation: NULL where none is asked for), summary. mechanism: what the engine
 * was made for. A failure on the way keeps what was computed, with the last good state, and ends in diag_fail. */
void simulate(Pool *pool, const Engine *engine, const Model *mechanism, const Scene *scene, Animation *animation,
              const Request *request);
/* Evaluate rows of states (--eval). scene may be NULL; only its road is used. */
void evaluate(Pool *pool, const Engine *engine, const Scene *scene, const Request *request);

#endif
