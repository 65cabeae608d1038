/* SPDX-License-Identifier: MIT
 *
 * libgic: models, instances, scenes and what gicrun finds out about them, for programs. Link with -lgic (pkg-config
 * gic). It is a C interface of its own: no other header is needed, and structures that may grow begin with their size.
 *
 * Everything belongs to a library object, which is no global: a program may have several. Things in it are named by
 * handles. A handle is never given twice, so that a call with one that is closed ends in GICL_WRONG and a message. All
 * functions may be called from any thread at once; two calls that use one instance, batch or result at the same time
 * are a mistake, which the second one reports.
 *
 * Every function with `said` returns a status and writes nothing to the terminal. What gicrun prints is in `said`
 * (NULL: nobody wants it), which each call empties first; gicl_listen() brings it while the call is at work. Units are
 * SI unless a name says otherwise. gicrun, gicsweep and gicbench are command lines over these functions.
 *
 *     gicl_library *lib = gicl_open();
 *     gicl_messages *said = gicl_messages_new();
 *     gicl_handle model, car;
 *     if (gicl_model_open(lib, "car.veh", NULL, &model, said) || gicl_instance_new(lib, model, NULL, &car, said))
 *         ... gicl_message_get(said, 0, &message)
 *     gicl_step(lib, car, 0.005, GICL_AB3, 1, 100, said);
 *     gicl_close(lib);
 */
#ifndef GIC_H
#define GIC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined __GNUC__
#define GICL_API __attribute__((visibility("default")))
#else
#define GICL_API
#endif

/* Increased when a program must be compiled anew; that of the library itself, and gicgen's version as text. */
#define GICL_VERSION 3
GICL_API int gicl_version(void);
GICL_API const char *gicl_release(void);

/* Statuses. Negative ones are those of generated code (gic_runtime.h): the call changed nothing. */
enum {
    GICL_OK = 0,
    GICL_FAILED = 1, /* a file, a model or a run has a mistake */
    GICL_WRONG = 2   /* the call has one: a closed handle, another kind of thing, a wrong size or name */
};

typedef struct gicl_library gicl_library;
typedef uint64_t gicl_handle; /* 0 is none */

/* ---- messages ----------------------------------------------------------------------------------------------- */

typedef struct gicl_messages gicl_messages;

enum {
    GICL_ERROR = 0,
    GICL_WARNING = 1,
    GICL_NOTE = 2,
    GICL_TEXT = 3,    /* a table that gicrun prints on standard output */
    GICL_PROGRESS = 4 /* how far the work is, at most ten times a second, "": it is over; heard, not in lists */
};

typedef struct gicl_message {
    int kind;
    const char *file;          /* as it was named; NULL: the message is about none */
    int line, column;          /* from 1; 0: the file as a whole */
    const char *text, *remedy; /* remedy: NULL: none */
    const char *printed;       /* all of it, lines as gicrun prints them */
} gicl_message;

/* A list for one thread at a time; NULL: no memory. */
GICL_API gicl_messages *gicl_messages_new(void);
GICL_API void gicl_messages_free(gicl_messages *said);
/* How many there are; and one of them, from 0: 1, or 0 if there is no such message. Texts stay until the next call. */
GICL_API int gicl_message_count(const gicl_messages *said);
GICL_API int gicl_message_get(const gicl_messages *said, int index, gicl_message *message);

/* ---- the library -------------------------------------------------------------------------------------------- */

/* NULL: no memory. */
GICL_API gicl_library *gicl_open(void);
/* Frees everything in it; no other call may be at work. GICL_WRONG: NULL. */
GICL_API int gicl_close(gicl_library *library);
/* Who hears messages when they come. */
typedef struct gicl_listener {
    size_t size;         /* sizeof(gicl_listener) */
    const char *program; /* the name at the head of messages about no file; NULL: "gicrun" */
    /* Called in the thread of the call that it is about; calls nothing of the library. */
    void (*hear)(void *context, const gicl_message *message);
    void *context;
    int signals; /* 1: signals that end a program by default are the library's: they wait while files are written, end
                  * a run early with the rows up to there, and then end the program. For the only thread of a program */
} gicl_listener;

/* Before other calls; texts stay the caller's and must outlive the library. NULL: nobody listens any more. */
GICL_API int gicl_listen(gicl_library *library, const gicl_listener *listener, gicl_messages *said);
/* Close one thing of any kind. Instances and batches of a closed model go on. */
GICL_API int gicl_free(gicl_library *library, gicl_handle handle, gicl_messages *said);

/* ---- models ------------------------------------------------------------------------------------------------- */

/* How a model is computed; words are those of gicrun's options. NULL and 0 are the defaults. */
typedef struct gicl_options {
    size_t size;          /* sizeof(gicl_options) */
    const char *engine;   /* "tcc" (default): generated code, compiled in this process; "cc": by the C compiler, kept in
                           * gicrun's cache; "tape": interpreted; "auto": "tcc", which goes over to "cc" in long runs.
                           * All give the same bits, runs of scenes with `general`. "gic", "gcp1", "gcp2": of runs and
                           * studies alone; "page": of runs in gicl_write(), the digits of a page of --drive */
    const char *solve;    /* "auto", "reduced", "articulated", "augmented" */
    const char *recovery; /* "auto", "newton", "closed" */
    const char *compiler; /* of "cc": a command */
    const char *flags;    /* more options for it */
    /* instead of the scenes': "ab3", "rk4", "ros2", "ros3", "imex", "exp3", "adams", "rkck", "bdf", "auto". With
     * "ros2", "ros3", "imex" or "exp3" code of instances and batches has implicit steps */
    const char *integrator;
    double tolerance; /* of variable steps, instead of the scenes' */
    int general;      /* 1: gicl_run() uses code as for any scene, as gicrun --general does */
    int lanes;        /* of "cc" in runs and studies: alike parts in vectors of 2, 4, 8 or 16 numbers; 0: none */
} gicl_options;

/* Words that a member of gicl_options may be, such as "engine", "solve", "recovery", "integrator", from 0, the default
 * of gicrun first; NULL: no more. */
GICL_API const char *gicl_word(const char *member, int index);
/* Read and check a model. name: that of the text in messages; files that it includes are sought from the folder in it.
 */
GICL_API int gicl_model_open(gicl_library *library, const char *path, const gicl_options *options, gicl_handle *model,
                             gicl_messages *said);
GICL_API int gicl_model_text(gicl_library *library, const char *name, const char *text, size_t size,
                             const gicl_options *options, gicl_handle *model, gicl_messages *said);
/* The C that gicgen writes for it, and its header `<model>.h`; they stay until the model is closed. */
GICL_API int gicl_generate(gicl_library *library, gicl_handle model, const char **c, const char **h,
                           gicl_messages *said);

/* What has names. Arrays of an instance have these orders. */
enum {
    GICL_STATE,     /* FORMAT.md section 10 */
    GICL_RATE,      /* of the state, at the start of the last step */
    GICL_INPUT,     /* FORMAT.md section 8 */
    GICL_OUTPUT,    /* as gicl_outputs() left them */
    GICL_PARAMETER, /* tunable ones; geometric ones act at gicl_set_up() only */
    GICL_PORT,      /* forces and torques from outside */
    GICL_KINDS
};

/* How many there are of a kind; and name and unit of one, from 0. The first of these calls compiles the model. */
GICL_API int gicl_count(gicl_library *library, gicl_handle model, int kind, int *count, gicl_messages *said);
GICL_API int gicl_signal(gicl_library *library, gicl_handle model, int kind, int index, const char **name,
                         const char **unit, gicl_messages *said);
/* The index of a name. GICL_WRONG: there is none; the message has the nearest one. */
GICL_API int gicl_find(gicl_library *library, gicl_handle model, int kind, const char *name, int *index,
                       gicl_messages *said);

/* ---- instances ---------------------------------------------------------------------------------------------- */

enum { GICL_AB3 = 0, GICL_RK4 = 1 };

/* One vehicle, set up. scene: a path, whose road, parameters and initial state it gets, and whose inputs at time 0;
 * they then are the caller's. NULL: the model at design, on a flat road. */
GICL_API int gicl_instance_new(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *instance,
                               gicl_messages *said);
/* Back to that start, at time 0. parameter: [count], all of the model's; NULL with 0: those of scene or model. */
GICL_API int gicl_set_up(gicl_library *library, gicl_handle instance, const double *parameter, int count,
                         gicl_messages *said);
/* An array of the instance itself, [count] numbers, which stays until it is closed. After changing a state call
 * gicl_restart(). */
GICL_API int gicl_view(gicl_library *library, gicl_handle instance, int kind, double **data, int *count,
                       gicl_messages *said);
/* Forget the integrator's history; the time becomes `time`, s. */
GICL_API int gicl_restart(gicl_library *library, gicl_handle instance, double time, gicl_messages *said);
GICL_API int gicl_time(gicl_library *library, gicl_handle instance, double *time, gicl_messages *said);
/* `steps` steps of `step` seconds with constant inputs; ratio: fast steps of wheels and powertrain in a step, with RK4
 * 1. Ends at the first that fails. */
GICL_API int gicl_step(gicl_library *library, gicl_handle instance, double step, int method, int ratio, int64_t steps,
                       gicl_messages *said);
/* The rate of a state at a time, with the instance's inputs; both [count], the number of states. The instance's own
 * state stays; where Newton's iteration begins moves, so that later digits may differ by rounding. */
GICL_API int gicl_rhs(gicl_library *library, gicl_handle instance, double time, const double *state, double *rate,
                      int count, gicl_messages *said);
/* Compute the outputs of the present state, on a copy: they leave no trace in later steps. */
GICL_API int gicl_outputs(gicl_library *library, gicl_handle instance, gicl_messages *said);

/* A snapshot: [size] bytes, for instances of the same model, options and gicgen alone; others, and bytes that were
 * changed, are refused. The road stays that of the instance. */
GICL_API int gicl_snapshot_size(gicl_library *library, gicl_handle instance, size_t *size, gicl_messages *said);
GICL_API int gicl_snapshot(gicl_library *library, gicl_handle instance, void *bytes, size_t size, gicl_messages *said);
GICL_API int gicl_restore(gicl_library *library, gicl_handle instance, const void *bytes, size_t size,
                          gicl_messages *said);

/* ---- batches ------------------------------------------------------------------------------------------------ */

/* `vehicles` instances side by side, each with the bits that it has alone. Scene as above. lanes: 1: they make their
 * steps one after another; 2, 4, 8 or 16: so many at once, in the lanes of the processor's vectors, by code that the C
 * compiler makes, whatever the model's engine, and keeps in gicrun's cache; models with outputs of reactions have none
 * yet: GICL_FAILED. */
GICL_API int gicl_batch_new(gicl_library *library, gicl_handle model, const char *scene, int vehicles, int lanes,
                            gicl_handle *batch, gicl_messages *said);
/* An array of all of them: number i of vehicle v is at data[v / lanes * stride + i * lanes + v % lanes]; i below
 * `count`, lanes as above. */
GICL_API int gicl_batch_view(gicl_library *library, gicl_handle batch, int kind, double **data, int *count,
                             size_t *stride, gicl_messages *said);
/* Steps of all; status: [vehicles], written; NULL: not wanted. One that fails keeps its last state, and disturbs no
 * other; the call then returns the status of the first that did. */
GICL_API int gicl_batch_step(gicl_library *library, gicl_handle batch, double step, int method, int ratio,
                             int64_t steps, int32_t *status, gicl_messages *said);
/* Outputs of all, as gicl_outputs(); in lanes GICL_RATE becomes the rate of the present state. */
GICL_API int gicl_batch_outputs(gicl_library *library, gicl_handle batch, int32_t *status, gicl_messages *said);
/* Back to the start, at time 0, where which[v] is not 0; NULL: all. Parameters are those in the batch's array. */
GICL_API int gicl_batch_reset(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said);
/* After changing states: forget the history of these vehicles. Times stay. */
GICL_API int gicl_batch_restart(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said);

/* ---- what gicrun finds out ---------------------------------------------------------------------------------- */

/* A scene run from begin to end: array "columns", with the bits of gicrun's results. Where the run ends early the
 * status is GICL_FAILED and *result, if it is not 0, has the rows up to there. */
GICL_API int gicl_run(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result,
                      gicl_messages *said);
/* Static equilibrium near the initial state of a scene (NULL: the model's), as gicrun --equilibrium: arrays "state",
 * "input", "output", a row each. */
GICL_API int gicl_equilibrium(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result,
                              gicl_messages *said);
/* Small motions about it: array "modes" with columns real, imaginary, frequency, damping, time_constant and shares;
 * numbers that do not apply are NaN. */
GICL_API int gicl_modes(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result,
                        gicl_messages *said);
/* The linear model, SCENE.md section 8: arrays A to F, N, f, z0, u0, y0, p0. at: a time of the scene's run, s; NaN:
 * about the equilibrium. */
GICL_API int gicl_linearize(gicl_library *library, gicl_handle model, const char *scene, double at, gicl_handle *result,
                            gicl_messages *said);
/* The gradient of a number of a run, as gicrun --gradient: arrays "number", "time", and by variable "variable" (values)
 * and "derivative". word: [words] NAME, or NAME=VALUE, which sets the number first; 0: all variables. */
GICL_API int gicl_gradient(gicl_library *library, gicl_handle model, const char *scene, const char *formula,
                           const char *const *word, int words, gicl_handle *result, gicl_messages *said);

/* One array of a result, row-major; it stays until the result is closed. */
typedef struct gicl_array {
    const char *name;
    int64_t rows;
    int columns;
    const double *data;
    const char *const *row_name, *const *row_unit;       /* [rows]; NULL: rows have no names */
    const char *const *column_name, *const *column_unit; /* [columns]; NULL: there are none */
} gicl_array;

GICL_API int gicl_array_count(gicl_library *library, gicl_handle result, int *count, gicl_messages *said);
/* size: sizeof(gicl_array). */
GICL_API int gicl_array_get(gicl_library *library, gicl_handle result, int index, gicl_array *array, size_t size,
                            gicl_messages *said);

/* ---- what gicrun writes ------------------------------------------------------------------------------------- */

/* Files and tables. Members are gicrun's options; NULL and 0: not given. Paths of files to be written may be "-",
 * standard output, where gicrun's may. */
typedef struct gicl_study {
    size_t size;         /* sizeof(gicl_study) */
    const char *kind;    /* "run", "drive", "eval", "equilibrium", "modes", "linearize", "kc", "sheet", "manoeuvre",
                          * "trim", "gradient", "identify", "optimize", "live" */
    const char *scene;   /* a path; "run", "drive", "live", "gradient", "identify" and "optimize" need one, "manoeuvre"
                          * has none */
    const char *results; /* -o: "eval" and "linearize" need it, "drive" writes none */
    const char *page;    /* of "run" --animate, of "drive" its page, of "kc" and "manoeuvre" --report */
    const char *plot, *with, *replay; /* of "run" */
    const char *states;               /* of "eval": the file of states */
    const double *at;                 /* of "linearize": a time, s */
    const char *axle;                 /* of "kc" */
    double travel;                    /* of "kc", m */
    int loads, joints;                /* of "kc": 1: compliance; 1: what joints carry */
    const char *compare;              /* of "kc", "sheet" and "manoeuvre" */
    const char *manoeuvre;            /* its name */
    const char *formula, *measured;   /* of "gradient" and "optimize"; of "identify": a file */
    const char *const *key; /* [keys] words key=value of "manoeuvre" and "trim"; with them "linearize" is about
                             * the motion of "trim"; names of "gradient" and "identify"; words name=low:high of
                             * "optimize" */
    int keys;
    const char *trace;           /* of "manoeuvre" */
    const char *record;          /* of "live" */
    const char *inputs;          /* the same: names of those that packets give, between commas; NULL: all */
    const char *joystick, *axes; /* the same: a device that drives, and words name=axis0:low:high, between commas */
    int port;       /* the same: of UDP on the loopback interface; 0: one that is free, which a note tells */
    double seconds; /* the same; 0: until a signal asks to stop, which a listener with `signals` must have left to it */
    const char *const *vary; /* [varied] of "kc", "sheet" and "manoeuvre": words name=low:high:count, without
                              * "trace" */
    int varied;
    int quiet; /* 1: neither progress nor notes */
} gicl_study;

/* What gicrun does. Tables for people are messages, GICL_TEXT. GICL_FAILED: a run that ends early has written its rows
 * up to there; other files are whole or not there. */
GICL_API int gicl_write(gicl_library *library, gicl_handle model, const gicl_study *study, gicl_messages *said);

/* ---- what gicsweep does -------------------------------------------------------------------------------------- */

enum { GICL_SWEEP_MOST = 10000000 }; /* runs */

/* One scene with many values. Members are gicsweep's options. Results are HDF5 where their name ends in .h5 or .hdf5,
 * else CSV. */
typedef struct gicl_sweep {
    size_t size;             /* sizeof(gicl_sweep) */
    const char *scene;       /* a path */
    const char *results;     /* a file; finished runs are in `results`.journal meanwhile, and the same call goes on */
    const char *const *vary; /* [varied] NAME=LOW:HIGH:COUNT, or NAME=LOW:HIGH with `latin` */
    int varied;
    int64_t latin; /* so many runs of a Latin hypercube; 0: a grid */
    uint64_t seed; /* of its random numbers */
    int alone;     /* 1: each run by itself, by the model's engine; 0: in lanes where compiler and model allow that */
    int quiet;     /* 1: neither progress nor notes */
    /* Only part 1 to `parts` of the runs, in any order and on any machines: `results` is a folder then, in which each
     * part keeps its finished runs. 0 and 0: all runs. */
    int part, parts;
    const char *const *metric; /* [metrics] NAME=FUNCTION(FORMULA) */
    int metrics;
    int series; /* 1: the scene's outputs at output times too, in HDF5 */
    /* base points of Sobol' indices of the metrics, each `varied` + 2 runs; the table of indices is a message,
     * GICL_TEXT. 0: none */
    int64_t sobol;
    /* a page with response surfaces of the metrics, and with their fronts min:NAME,max:NAME,...; of all runs, not in
     * parts: gicl_sweep_merge_report(). NULL: none */
    const char *report;
    const char *const *front; /* [fronts] */
    int fronts;
} gicl_sweep;

/* Runs are made in $OMP_NUM_THREADS processes, by default one for each processor. *result (result NULL: not wanted):
 * array "runs" with the columns of the file. */
GICL_API int gicl_sweep_run(gicl_library *library, gicl_handle model, const gicl_sweep *sweep, gicl_handle *result,
                            gicl_messages *said);

enum { GICL_PARTS_MOST = 10000 };

/* Plan a sweep into the folder sweep->results, in sweep->parts parts, or 0: in as many that each takes one processor
 * like this one about `seconds`, 1000 at most; sweep->part is 0. Files: `plan`, which parts compare with theirs, and
 * `job.sh`, an array of Slurm jobs: each calls the `words` words of `command` with --shard and -o after them. */
GICL_API int gicl_sweep_plan(gicl_library *library, gicl_handle model, const gicl_sweep *sweep, double seconds,
                             const char *const *command, int words, gicl_messages *said);

/* One table of all parts in a folder, with the bytes of a sweep in one call. GICL_FAILED: a run is missing; the message
 * names its part. */
GICL_API int gicl_sweep_merge(gicl_library *library, const char *folder, const char *results, int quiet,
                              gicl_messages *said);

/* The same with a page as gicl_sweep.report and front: that of a sweep in one call, of one with metrics. */
GICL_API int gicl_sweep_merge_report(gicl_library *library, const char *folder, const char *results, const char *report,
                                     const char *const *front, int fronts, int quiet, gicl_messages *said);

/* ---- what gicbench does -------------------------------------------------------------------------------------- */

enum { GICL_BENCH_ENGINES = 64, GICL_BENCH_VEHICLES = 65536 }; /* the most of them */

/* Engines and integrators, measured. Members are gicbench's options; NULL and 0: not given. */
typedef struct gicl_bench {
    size_t size;             /* sizeof(gicl_bench) */
    const char *kind;        /* "compare" (gicbench without such an option), "rhs", "drive", "batch", "scenes",
                              * "precision" */
    const char *const *file; /* [files] a model and its scenes, of "scenes" and "precision" several */
    int files;
    const char *folder;         /* to be written; "compare" needs it */
    const char *rows, *picture; /* of "precision": CSV, SVG or PNG */
    const char *const *engine;  /* [engines] 0: all that are here */
    int engines;
    const char *compiler, *flags;
    int vehicles; /* of "batch" */
    int quick;    /* 1: few repetitions, few settings */
} gicl_bench;

/* The text that gicbench prints is a message, GICL_TEXT. Takes minutes, and measures well where nothing else is at
 * work. Loaded code stays until the program ends. */
GICL_API int gicl_measure(gicl_library *library, const gicl_bench *bench, gicl_messages *said);

#ifdef __cplusplus
}
#endif
#endif
