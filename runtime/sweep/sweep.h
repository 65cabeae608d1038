/* SPDX-License-Identifier: MIT
 *
 * What gicsweep does: one scene with many values of parameters, inputs and initial states. Its parts, file by file, in
 * the order in which they are used; conventions as in vehicle/vehicle.h. */
#ifndef SWEEP_SWEEP_H
#define SWEEP_SWEEP_H

#include "engine/engine.h"
#include "gic_batch.h"
#include "model/model.h"
#include "run/ride_filter.h"
#include "scene/scene.h"

/* ---- plan.c: which runs there are ------------------------------------------------------------------ */

typedef enum VaryKind { VARY_PARAMETER, VARY_INPUT, VARY_STATE, VARY_SPEED } VaryKind;

/* A number that differs from run to run. */
typedef struct Vary {
    const char *name;
    VaryKind kind;
    int index; /* index among tunable parameters, inputs or numbers of the state */
    double low, high;
    int64_t count; /* values of a grid from low to high; 0: only a range is given */
} Vary;

/* Larger tables are refused. */
enum { SWEEP_RUNS_MOST = 10000000 };

typedef struct SweepPlan {
    int varied;
    Vary *vary;
    int64_t runs;
    int64_t latin; /* 0: a grid, the last number varies fastest */
    uint64_t seed;
    int64_t bases;        /* of Saltelli's runs, `varied` + 2 for each base point; 0: there are none */
    double *point;        /* [bases of this part][2 varied] from 0 to 1: A and B of sobol.c */
    int32_t *place;       /* [varied][count] which of `latin` equal parts of the range */
    double *share;        /* [varied][count] where within it */
    int part, parts;      /* part 1 to `parts` of the sweep, 0: all of it; parts 0: it is not planned in parts */
    int64_t first, count; /* its runs */
} SweepPlan;

/* name=low:high or name=low:high:count; the name is looked up later. Mistakes end in diag_fail_call(). */
void vary_read(Pool *pool, SweepPlan *plan, const char *word);
/* Look names up, count the runs. */
void plan_close(Pool *pool, SweepPlan *plan, const Model *model, const Engine *engine);
/* The first run of part 1 to `parts`; with part = parts + 1: the number of runs. */
int64_t part_first(int64_t runs, int part, int parts);
/* A number of the generator splitmix64, from 0 to below 1: the same ones on every machine. */
double random_share(uint64_t *state);
/* The value of a varied number in a run of this part. */
double plan_value(const SweepPlan *plan, int varied, int64_t run);

/* ---- metric.c: numbers of a run by formula --------------------------------------------------------------- */

typedef enum MetricKind {
    METRIC_END,
    METRIC_MIN,
    METRIC_MAX,
    METRIC_MEAN,
    METRIC_RMS,
    METRIC_INTEGRAL,
    METRIC_TIME_OF_MIN,
    METRIC_TIME_OF_MAX,
    METRIC_CROSSING,
    METRIC_OVERSHOOT,
    METRIC_RMS_WK, /* weighted by frequency after ISO 2631-1 */
    METRIC_RMS_WD,
    METRIC_KINDS
} MetricKind;

/* By the definitions of models/SCENE.md section 6, over output times. */
typedef struct Metric {
    const char *name, *unit; /* unit: NULL: not known */
    const char *word;        /* as the user wrote it */
    MetricKind kind;
    int signal, other; /* of the formula; of the weight of METRIC_RMS or the level of METRIC_CROSSING, -1: none */
} Metric;

/* What a metric knows of a run so far. */
typedef struct MetricState {
    int samples;
    double time, value, other; /* of the last sample, */
    double begin, first;       /* and time and value of the first */
    double least, greatest, time_of_least, time_of_greatest;
    double integral, weight; /* of the value, of its square times the weight, or of the weight */
    double crossing;         /* NAN: none yet */
    RideFilter filter;       /* of METRIC_RMS_WK and _WD, */
    double filtered;         /* and what came out last */
} MetricState;

/* Read NAME=FUNCTION(FORMULA) or NAME [UNIT]=..., and add its formulas to the outputs of the model. Ends in diag_fail.
 */
const Model *metric_read(Pool *pool, const Model *model, const char *word, Metric *metric);
/* The next sample of a run, from its start on. */
void metric_see(const Metric *metric, MetricState *state, double time, double value, double other);
/* NAN: the run has no such number. */
double metric_value(const Metric *metric, const MetricState *state);

/* ---- share.c: runs shared out among processes ----------------------------------------------------------- */

/* The result of a run. */
typedef struct RunResult {
    int64_t run;
    int status;
    const char *row, *reason; /* its row of the results; the reason of a failure, NULL: none or unknown */
} RunResult;

/* Runs to be made, one after the other, and where their results go. */
typedef struct Supply {
    int64_t (*next)(void *context); /* -1: there are no more */
    void (*done)(void *context, const RunResult *result);
    void *context;
} Supply;

typedef struct Share {
    int64_t count;
    const int64_t *run; /* [count] runs to be made */
    int lock;           /* a file descriptor that processes made by share_runs() close */
    /* Called in each of the processes: make runs until the supply ends. False: a request to stop came. */
    bool (*make)(void *context, const Supply *supply);
    /* Called in the caller's process with the results that came, perhaps 0, at least ten times a second. False:
     * stop. */
    bool (*take)(void *context, const RunResult *result, int results);
    void *context;
} Share;

enum { SHARE_PROCESSES_MOST = 256 };

/* Processes to run at once: $OMP_NUM_THREADS, or one for each processor. */
int share_processes(void);
/* Make all runs in at most `processes` processes; texts of results belong to the pool. False: take() asked to stop. A
 * process that fails ends the program with a message. */
bool share_runs(Pool *pool, const Share *share, size_t processes);

/* ---- sobol.c: sensitivity ------------------------------------------------------------------------------------ */

typedef struct SweepForm SweepForm;
typedef struct Sobol Sobol;

enum { SOBOL_MOST = 20 /* varied numbers: the sequence has 40 */ };

Sobol *sobol_open(Pool *pool, const SweepForm *form);
/* The next run's row. */
void sobol_row(Sobol *sobol, const char *row);

/* Of each metric and each number that varies: the index of first order, from where to where 95 percent of those lie
 * that resampled base points give, and the same of the total index. */
enum { SOBOL_NUMBERS = 6 };
extern const char *const sobol_name[SOBOL_NUMBERS];
typedef struct SobolIndices {
    int metrics, varied;
    double *number; /* [metrics][varied][SOBOL_NUMBERS] */
    double *points; /* [metrics] base points whose runs all have a finite number; the others are left out */
} SobolIndices;

/* After the last row. NAN: fewer than 16 points are left, or the metric does not vary. */
const SobolIndices *sobol_indices(Sobol *sobol);
/* As CSV. */
const char *sobol_text(Sobol *sobol);

/* ---- table.c: results as a file ---------------------------------------------------------------------------- */

/* A column of results. group: in HDF5; descriptions have no line ends and no tabs. */
typedef struct SweepColumn {
    const char *group, *name, *unit, *description; /* unit: NULL: none is known */
} SweepColumn;

/* What results come from, in HDF5. */
typedef struct SweepFact {
    const char *name, *value;
} SweepFact;

/* What results look like: a row for each run, and, if asked for, values of `series` outputs at output times. */
struct SweepForm {
    int columns, series;
    SweepColumn *column; /* [columns + series] */
    int64_t bases;       /* base points of Saltelli's runs, 0: they are others */
    int64_t samples;     /* of each series, 0: there are none */
    double apart;        /* s between them */
    int facts;
    SweepFact *fact;
};

/* A file of results that is being written: beside `path`, renamed when it is closed. */
typedef struct Table Table;

/* Is the file one of HDF5, by the ending of its name? */
bool table_is_hdf5(const char *path);
/* Call before the runs: ends in diag_fail if no file of this kind can be written here. */
void table_check(Pool *pool, const char *path, const SweepForm *form);
Table *table_open(Pool *pool, const char *path, const SweepForm *form, int64_t runs);
/* The next run: its row, numbers separated by commas; series[form->series][form->samples], NULL: there are none. */
void table_row(Table *table, const char *row, const double *series);
/* Tells the Sobol' indices, too. */
void table_close(Table *table);
void table_abandon(Table *table);

/* ---- series.c: outputs over time of finished runs ------------------------------------------------------------ */

/* A file with a place for each run, in which processes write side by side. What is in it counts where its checksum is
 * right and the journal has the run. */
typedef struct Series {
    const char *path;
    int file, *held; /* as in Journal */
    int64_t first;
    size_t numbers; /* of a run */
} Series;

/* The file beside a journal. */
const char *series_path(Pool *pool, const char *journal);
/* NULL: the form has no series. */
Series *series_open(Pool *pool, const char *path, const SweepForm *form, int64_t first);
/* Only read it; a file that is missing has no run. */
Series *series_read(Pool *pool, const char *path, const SweepForm *form, int64_t first);
void series_put(const Series *series, int64_t run, const double *value);
/* value[numbers]; false: the run is not there, or damaged. */
bool series_get(const Series *series, int64_t run, double *value);
/* Onto the disk. */
void series_sync(const Series *series);
void series_close(const Series *series);
void series_remove(const Series *series);

/* ---- journal.c: what is finished --------------------------------------------------------------------- */

/* Rows of finished runs, each written to the file before the next batch begins, so that a kill loses no finished
 * run; and onto the disk once a second, so that a machine that loses its power loses little more. */
typedef struct Journal {
    Pool *pool;
    const char *path;
    int file, *held;                       /* held: the same, closed where a failure ends a call */
    const Series *series;                  /* NULL: none */
    double *room;                          /* for those of a run */
    double synced;                         /* when the file was written onto the disk, s */
    bool behind;                           /* there is something that was not */
    int64_t first, runs, finished, failed; /* of runs from `first` on */
    const char **row;                      /* [runs] text of each row; NULL: not finished */
    int first_status;                      /* of the failed run with the lowest number; GIC_OK: none failed */
    int64_t first_failed;
    const char *first_reason; /* NULL: an earlier gicsweep recorded the failure */
} Journal;

/* Open a journal: take what an earlier gicsweep with the same key finished, or begin one. form: a run with series
 * counts where these are there, too. */
Journal journal_open(Pool *pool, const char *path, const char *key, const SweepForm *form, int64_t first, int64_t runs);
/* Only read it, perhaps while another process writes it; no file: no run is finished. */
Journal journal_read(Pool *pool, const char *path, const char *key, const SweepForm *form, int64_t first, int64_t runs);
/* Rows of runs, into the file; texts stay in use. */
void journal_add(Journal *journal, const RunResult *result, int results);
/* Keep it for later, on the disk. */
void journal_close(Journal *journal);
/* Remove the journal after the results are written. */
void journal_remove(Journal *journal);

/* ---- run.c: the runs ------------------------------------------------------------------------------------ */

typedef struct Sweep {
    Pool *pool;
    const Model *model;
    const Scene *drawn; /* as the file has it: */
    const Scene *scene; /* begins in equilibrium, if that is asked for */
    bool chosen;        /* with the integrator that was chosen for its own values, in all runs */
    Solve solve;
    SweepPlan *plan;
    const Engine *engine;
    const gic_batch_model *many; /* NULL: no lanes */
    int metrics;
    const Metric *metric;
    const SweepForm *form;
    int processes; /* most processes */
    Journal *journal;
    bool quiet;
} Sweep;

/* All runs of this part that are not finished. False: someone asked to stop. */
bool sweep_run(const Sweep *sweep);
/* lanes.c: why the runs of a scene can't be made side by side in lanes; NULL: they can. */
const char *lanes_unfit(const Scene *scene, const Model *model);
/* Seconds that one process takes for a run, measured with some that are spread over the sweep. Below 0: someone asked
 * to stop. */
double sweep_seconds(const Sweep *sweep);

/* A page about the metrics, report.h. */
typedef struct ReportRequest {
    const char *path;         /* NULL: none */
    const char *const *front; /* [fronts] words for front_read() */
    int fronts;
} ReportRequest;

/* ---- folder.c: a sweep in parts ----------------------------------------------------------------------------
 *
 * A folder holds the file `plan`, and of each part its journal, part_I.journal. Parts know nothing of each other;
 * whoever starts them, on whatever machine and how often, a part goes on where its journal ends. */

enum { SWEEP_PARTS_MOST = 10000 };

/* What the file `plan` says. */
typedef struct FolderPlan {
    const char *key; /* of all that determines the results */
    int64_t runs;
    int parts;
    SweepForm form;
} FolderPlan;

/* Write the plan into a folder, which is made; where there is a plan it must be the same. */
void folder_plan_write(Pool *pool, const char *folder, const FolderPlan *plan);
FolderPlan folder_plan_read(Pool *pool, const char *folder);
/* The journal of a part, and its key. */
const char *folder_journal(Pool *pool, const char *folder, int part);
const char *folder_key(Pool *pool, const FolderPlan *plan, int part);
/* Make one table of what the parts made, and a page. Fails if a run is missing, and says in which part. */
void folder_merge(Pool *pool, const char *folder, const char *results, const ReportRequest *page, bool quiet);

/* ---- job.c ------------------------------------------------------------------------------------------------- */

/* Write folder/job.sh, an array of Slurm jobs, one for each part; command: what makes the runs but for --shard and -o.
 * seconds: what a part may take. */
void job_write(Pool *pool, const char *folder, const char *const *command, int words, int parts, double seconds);

/* ---- sweep.c: all of it ---------------------------------------------------------------------------------- */

typedef struct SweepRequest {
    const char *results; /* a file, beside which the journal is; of a sweep in parts a folder */
    const char *engine;  /* each run by itself; NULL: lanes where they can be had */
    EngineOptions code;
    const char *const *vary; /* [varied] words for vary_read() */
    int varied;
    int metrics;
    const Metric *metric; /* read before the scene: the model has their formulas */
    int64_t latin;        /* 0: a grid, */
    int64_t sobol;        /* if this is 0, too: base points of Saltelli's runs */
    uint64_t seed;
    bool series; /* keep outputs over time; results are HDF5 then */
    ReportRequest page;
    int part, parts; /* only part 1 to `parts`; 0: all of it, or for sweep_plan() as many as fit */
    bool quiet;
} SweepRequest;

/* What became of it. */
typedef struct SweepTable {
    const Engine *engine; /* for the caller to close; NULL: not opened */
    SweepForm form;
    int64_t runs;
    const char **row; /* [runs] numbers separated by commas */
} SweepTable;

/* Make the runs and write the results. Ends in diag_fail where that can't be. */
void sweep_all(Pool *pool, const Model *model, const Scene *scene, const SweepRequest *request, SweepTable *table);
/* Plan it into the folder request->results, in request->parts parts, or in such as take one process about `seconds`.
 * command: for job_write(). */
void sweep_plan(Pool *pool, const Model *model, const Scene *scene, const SweepRequest *request, double seconds,
                const char *const *command, int words, SweepTable *table);

#endif
