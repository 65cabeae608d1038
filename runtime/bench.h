/* SPDX-License-Identifier: MIT
 *
 * gicbench: how fast the engines and integrators are, at which error. Its parts, file by file, in the order in which
 * they are used; conventions as in gicgen.h. */
#ifndef BENCH_H
#define BENCH_H

#include "engine.h"
#include "gicrun.h"

/* ---- gicbench.c: the command line ----------------------------------------------------------------------- */

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
    bool rhs;   /* right-hand sides alone, told on standard output */
    bool drive; /* the scene as it stands, told on standard output */
    const Model *model;
    const Scene *scene, *spin; /* scene: NULL with rhs: none; spin: makes coordinate partitions change; NULL: none */
    int engines, repetitions;
    const Engine **engine;       /* the first is what the others are compared with */
    const char *const *starting; /* names of the engines whose start is measured, ended by NULL */
    gic_head **instance;         /* [engines] */
    bool quick;
    int vehicles;            /* of --batch; 0: another benchmark */
    int files;               /* of --scenes: models and scenes by turns; 0: another benchmark */
    char *const *file;       /* [files] */
    const char *engine_name; /* that runs them */
    struct Report *report;
    Progress *progress;
} Bench;

/* ---- bench_run.c: one engine, one integrator, one run ----------------------------------------------------- */

/* s between samples of a trajectory; every run stops there, so that it is a multiple of all constant steps */
static const double bench_sample = 0.04;

/* How to integrate: with constant steps, or variable ones within a tolerance. */
typedef struct Setting {
    int32_t method;
    double value; /* step, s, or tolerance */
} Setting;

/* World poses of all bodies at 0, bench_sample, ..: [samples][7 bodies]. */
typedef struct Trajectory {
    int samples, numbers;
    double *pose;
} Trajectory;

/* What is known of an engine with a setting. */
typedef struct Trial {
    const Engine *engine;
    Setting setting;
    double *second; /* [repetitions] CPU time of the whole run; ascending repetition, engines alternating in each */
    double error;   /* of the trajectory, see trajectory_error */
    int status;     /* that ended it */
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
/* The trajectory that all are compared with, and the distance to a second one made in another way. */
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
/* Median of the seconds between two looks at the clock at once. */
double bench_look(Pool *pool);
/* Seconds of a step of AB3 from a state at the instance's time, with its inputs, and of a right-hand side at states
 * where such steps begin: [2], the shortest of some turns each; the instance stays as it is. Status of the one that
 * fails. */
int step_parts(Pool *pool, const gic_model *code, gic_head *self, const double *state, double length, double *seconds);
/* Right-hand sides of a run with the first engine. */
int64_t trial_evaluations(const Bench *bench, const Scene *scene, Setting setting);

/* ---- bench_progress.c: the person who waits ---------------------------------------------------------------------- */

/* A line of progress, with the time so far and the expected one. */
void bench_progress(const Bench *bench, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* From now on the benchmark will take so many seconds; the first time that is known it is said. */
void bench_expect(const Bench *bench, double seconds);
/* The same where nothing is known but that so many of alike pieces are done. */
void bench_extrapolate(const Bench *bench, int done, int all);
/* Elapsed seconds of a step, over the first ones of a scene; *evaluation (may be NULL): of one right-hand side. */
double bench_step_seconds(const Engine *engine, gic_head *self, const Scene *scene, double *evaluation);

/* ---- bench_report.c, bench_chart.c: the folder --------------------------------------------------------------- */

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
} Chart;

/* A page in the making: paragraphs, tables and charts in their order. */
typedef struct Piece {
    const char *heading, *text;
    Sheet *table;
    Chart *chart;
} Piece;

typedef struct Report {
    Pool *pool;
    int pieces, headlines;
    Piece *piece;
    const char **headline; /* results in a sentence each, which stand first */
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
/* Numbers that are no points of a logarithmic axis are left out. */
void chart_point(Pool *pool, Chart *chart, const char *series, int group, double x, double y);
/* Picture as SVG by gnuplot. */
void chart_write(Pool *pool, const Chart *chart, const char *path);
/* All but pictures as text. */
void report_tell(const Report *report, FILE *file);
/* index.html, bench.txt, a CSV file a table, a picture a chart. */
void report_write(const Report *report, const char *folder);

/* ---- the experiments -------------------------------------------------------------------------------------- */

/* bench_machine.c: what all this was measured with. */
void bench_machine(const Bench *bench);
/* bench_sweep.c: time against error; Tables 1 and 2, Figs. 6 to 9 of Serban and Haug 2000. */
void bench_sweep(const Bench *bench);
/* Right-hand sides of all its runs, each once with one engine. */
double sweep_evaluations(const Bench *bench);
/* bench_profile.c: where the time of a step goes; Table 3. */
void bench_profile(const Bench *bench);
/* bench_spin.c: what changes of the coordinate partition cost. */
void bench_spin(const Bench *bench);
/* bench_worst.c: the longest step. */
void bench_worst(const Bench *bench);
/* bench_start.c: compilation and the first step; from how many steps on it is worth it. */
void bench_start(const Bench *bench);
/* bench_batch.c: many vehicles in lanes against one after another. */
void bench_batch(const Bench *bench);

/* bench_limit.c: multiply-adds in a second, each one a multiplication and an addition of double numbers. */
typedef struct Limit {
    double scalar, vector; /* one number at a time; as many as fit in a register */
    int lanes;             /* how many that are */
} Limit;

Limit limit_measure(void);
/* bench_drive.c: the scene with its own step and ratio; shares of multibody system, tires and powertrain. */
void bench_drive(const Bench *bench);
/* bench_scenes.c: scenes with code for any and code for each. */
void bench_scenes(const Bench *bench);
/* bench_rhs.c: one right-hand side of every variant of the code, against the limit. scene: NULL for none. */
void bench_rhs(const Bench *bench);
/* Can this compiler be started? */
bool bench_installed(Pool *pool, const char *compiler);

#endif
