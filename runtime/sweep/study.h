/* SPDX-License-Identifier: MIT
 *
 * study: kinematics, sheets and manoeuvres for many values of what is varied (gicrun --vary): a row of numbers a run,
 * curves of all runs in one diagram. */
#ifndef SWEEP_STUDY_H
#define SWEEP_STUDY_H

#include "base/pool.h"
#include "model/model.h"
#include "run/run.h"
#include "run/sheet.h"
#include "sweep/sweep.h"

typedef enum StudyKind { STUDY_KC, STUDY_SHEET, STUDY_MANOEUVRE } StudyKind;

/* A curve of one run, in the units that are shown. Those of the same group and title belong together. */
typedef struct StudyCurve {
    const char *group, *title, *unit, *below;
    int rows;
    double *x, *y;
} StudyCurve;

typedef struct StudyRun {
    const char *reason; /* why it has no results; NULL: it has */
    int rows, curves;
    SheetRow *row;
    StudyCurve *curve;
} StudyRun;

/* All runs. */
typedef struct StudySweep {
    Pool *pool;
    const Model *model;
    StudyKind kind;
    const Request *request;
    SweepPlan plan;
    const char **unit; /* [varied] */
    StudyRun *run;     /* [plan.runs] */
    int columns;
    SheetRow *column; /* the numbers of all runs: those of the first that has them */
    double *value;    /* [runs][columns]; NAN: the run has no such number */
} StudySweep;

enum { STUDY_RUNS_MOST = 100000 };

/* study.c: make all runs, which the words request->vary say, and write what was asked for. Runs that fail have no
 * numbers and are told; ends in diag_fail where all do. */
void study_sweep(Pool *pool, const Model *model, StudyKind kind, const Request *request);
/* True: a number differs from run to run, by more than rounding. */
bool study_changes(const StudySweep *sweep, int column);
/* "upper.z = 0.7, speed = 20" */
const char *study_label(const StudySweep *sweep, int64_t run);

/* study_curves.c: the curves of a run, copied into the pool. */
void study_curves_kc(Pool *pool, const KcStudy *study, StudyRun *run);
struct Manoeuvre;
void study_curves_manoeuvre(Pool *pool, const struct Manoeuvre *manoeuvre, StudyRun *run);

/* study_page.c */
void study_page(const StudySweep *sweep, const char *path);

#endif
