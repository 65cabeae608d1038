/* SPDX-License-Identifier: MIT
 *
 * What gicbench does: speed and error of engines and integrators. Its parts, file by file, in the order of their use;
 * conventions as in vehicle/vehicle.h. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/engines.h"
#include "scene/scene.h"

/* ---- what is asked for ------------------------------------------------------------------------------- */

/* How long a benchmark takes. */
typedef struct Progress {
    double begun;    /* by the monotonic clock, s */
    double expected; /* s in all; 0: not known yet */
} Progress;

typedef struct Bench {
    Pool *pool;
    const char *model_path, *scene_path, *spin_path;
    const char *folder; /* NULL with rhs and drive: none */
    EngineOptions options;
    bool rhs;   /* right-hand sides only, printed on standard output */
    bool drive; /* the scene with its own settings, printed on standard output */
    const Model *model;
    const Scene *scene, *spin; /* scene: NULL with rhs: none; spin: a scene that makes coordinate partitions change;
                                * NULL: none */
    int engines, repetitions;
    const Engine **engine;       /* the first is the one that others are compared with */
    const char *const *starting; /* names of the engines whose start is measured, ended by NULL */
    gic_head **instance;         /* [engines] */
    bool quick;
    int vehicles;            /* of --batch; 0: another benchmark */
    bool precision;          /* run time against error of complete vehicles, printed on standard output */
    int files;               /* number of files of --scenes, models and scenes alternating, and of --precision, models
                              * each with its scenes; 0: another benchmark */
    const char *const *file; /* [files] */
    const char *engine_name; /* the engine of --scenes and --precision */
    const char *rows;        /* the CSV file of --precision; NULL: none */
    const char *picture;     /* its picture; NULL: none */
    struct Report *report;
    Progress *progress;
} Bench;

/* ---- run.c: one engine, one integrator, one run ----------------------------------------------------- */

/* s between samples of a trajectory; every run stops there, so that it is a multiple of all constant steps */
static const double bench_sample = 0.04;

/* The integrator's setting: constant steps, or variable ones within a tolerance. */
typedef struct Setting {
    int32_t method;
    double value; /* step, s, or tolerance */
} Setting;

/* World poses of all bodies at 0, bench_sample, ..: [samples][7 bodies]. */
typedef struct Trajectory {
    int samples, numbers;
    double *pose;
} Trajectory;

/* The results of an engine with a setting. */
typedef struct Trial {
    const Engine *engine;
    Setting setting;
    double *second; /* [repetitions] CPU time of the run; engines alternate within each repetition */
    double error;   /* of the trajectory, see trajectory_error */
    int status;     /* status that ended it */
    double end;     /* s, where it ended */
    bool unstable;  /* it failed, or its error exceeds bench_unstable */
    int64_t steps, evaluations;
} Trial;

static const double bench_unstable = 0.1;

bool setting_constant(Setting setting);
/* "5 ms" or "1e-06" */
const char *setting_text(Pool *pool, Setting setting);
int bench_samples(const Scene *scene);
/* Scene with another integrator. */
Scene bench_scene(const Scene *scene, Setting setting);
/* Run trials side by side, one for each engine: once for the error, then `repetitions` times for time. */
void trials_run(const Bench *bench, const Scene *scene, Setting setting, const Trajectory *reference, Trial *trial);
/* The trajectory that all are compared with, and its distance from one computed in another way. */
Trajectory reference_run(const Bench *bench, const Scene *scene, double *uncertainty);
/* Largest distance of two trajectories over samples and bodies: of a body frame's origin in m, or of its orientation
 * in rad, whichever is larger (a lever of 1 m). INFINITY where one is not a number. */
double trajectory_error(const Trajectory *a, const Trajectory *b);

/* Median and extremes of some numbers. */
typedef struct Spread {
    double median, low, high;
} Spread;

void sort_ascending(double *value, int count);
Spread spread_of(Pool *pool, const double *value, int count);
/* Of the ratios over / under, repetition by repetition. */
Spread spread_of_ratio(Pool *pool, const double *over, const double *under, int count);
/* Median of the seconds between two successive looks at the clock. */
double bench_look(Pool *pool);
/* Seconds of a step of AB3 from a state at the instance's time, with its inputs, and of a right-hand side at states
 * where such steps begin: [2], the shortest of some turns each; the instance stays as it is. Status of the one that
 * fails. */
int step_parts(Pool *pool, const gic_model *code, gic_head *self, const double *state, double length, double *seconds);
/* Right-hand sides of a run with the first engine. */
int64_t trial_evaluations(const Bench *bench, const Scene *scene, Setting setting);

/* ---- progress.c: the person who waits ---------------------------------------------------------------------- */

/* Print a line of progress with the elapsed and the expected time. */
void bench_progress(const Bench *bench, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Set the expected remaining time, s; the first call prints it. */
void bench_expect(const Bench *bench, double seconds);
/* The same from the number of pieces that are done, if all take about as long. */
void bench_extrapolate(const Bench *bench, int done, int all);
/* Elapsed seconds of a step, over the first ones of a scene; *evaluation (may be NULL): of one right-hand side. */
double bench_step_seconds(const Engine *engine, gic_head *self, const Scene *scene, double *evaluation);

/* ---- report.c, chart.c: the folder --------------------------------------------------------------- */

typedef struct Sheet {
    const char *name, *title, *note; /* name: of its CSV file */
    int columns, cells;
    const char **cell; /* row by row, the first row holds the names of the columns */
} Sheet;

typedef struct Series {
    const char *name;
    int group, points; /* series of a group have the same colour */
    double *x, *y;
} Series;

typedef struct Chart {
    const char *name, *title, *x, *y, *note; /* name: of its picture; both axes are logarithmic */
    int count;
    Series *series;
    bool under; /* the names of the series stand under the axes, not beside them */
} Chart;

/* A page while it is built: paragraphs, tables and charts in order. */
typedef struct Piece {
    const char *heading, *text;
    Sheet *table;
    Chart *chart;
} Piece;

typedef struct Report {
    Pool *pool;
    int pieces, headlines;
    Piece *piece;
    const char **headline; /* results in one sentence each, at the top */
} Report;

void report_heading(Report *report, const char *text);
void report_headline(Report *report, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_text(Report *report, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* columns: names separated by | */
Sheet *report_table(Report *report, const char *name, const char *title, const char *columns);
void table_cell(Pool *pool, Sheet *table, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Cells for the three, times `scale`. */
void spread_cells(Pool *pool, Sheet *table, Spread spread, double scale);
Chart *report_chart(Report *report, const char *name, const char *title, const char *x, const char *y);
/* Numbers that a logarithmic axis can't show are left out. */
void chart_point(Pool *pool, Chart *chart, const char *series, int group, double x, double y);
/* Picture as SVG by gnuplot. */
void chart_write(Pool *pool, const Chart *chart, const char *path);
/* Several with points side by side, SVG or PNG by the ending of `path`. */
void charts_write(Pool *pool, const Chart *const *chart, int count, const char *path);
/* All but pictures, as text. */
void report_tell(const Report *report);
/* index.html, bench.txt, a CSV file a table, a picture a chart. */
void report_write(const Report *report, const char *folder);

/* ---- the experiments -------------------------------------------------------------------------------------- */

/* machine.c: the machine and the programs used. */
void bench_machine(const Bench *bench);
/* sweep.c: time against error; Tables 1 and 2, Figs. 6 to 9 of Serban and Haug 2000. */
void bench_sweep(const Bench *bench);
/* Right-hand sides of all its runs, each once with one engine. */
double sweep_evaluations(const Bench *bench);
/* profile.c: the shares of a step's time; Table 3. */
void bench_profile(const Bench *bench);
/* repartition.c: the cost of changes of the coordinate partition. */
void bench_spin(const Bench *bench);
/* longest_step.c: the longest step. */
void bench_worst(const Bench *bench);
/* first_step.c: compilation and the first step; the number of steps from which on compiling takes less time. */
void bench_start(const Bench *bench);
/* batch.c: many vehicles in lanes against one after another. */
void bench_batch(const Bench *bench);

/* peak.c: multiply-adds in a second, each one a multiplication and an addition of double numbers. */
typedef struct Limit {
    double scalar, vector; /* one number at a time; as many as fit in a register */
    int lanes;             /* numbers in a register */
} Limit;

Limit limit_measure(void);
/* full_scene.c: the scene with its own step and ratio; shares of multibody system, tires and powertrain. */
void bench_drive(const Bench *bench);
/* scenes.c: scenes with code for any scene and with code for one. */
void bench_scenes(const Bench *bench);
/* precision.c: run time against error of models with their scenes. */
void bench_precision(const Bench *bench);
/* rhs.c: one right-hand side of every variant of the code, against the limit. scene: NULL for none. */
void bench_rhs(const Bench *bench);
/* measure.c: the benchmark that `asked` is, with these engines, ended by NULL; NULL: all that are here. The members
 * after `picture`, the model, scenes, engines and repetitions are its own. */
void bench_all(const Bench *asked, const char *const *name);
/* True if this compiler can be started. */
bool bench_installed(Pool *pool, const char *compiler);

#endif
