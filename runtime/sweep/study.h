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

/* STUDY_LOADS and STUDY_JOINTS: compliance of axles, and what joints carry. */
typedef enum StudyKind { STUDY_KC, STUDY_LOADS, STUDY_JOINTS, STUDY_SHEET, STUDY_MANOEUVRE } StudyKind;

/* A curve of one vehicle of a run, in the units that are shown. Those of the same group, key and unit belong together;
 * wheels of two vehicles may have other names in titles. */
typedef struct StudyCurve {
    const char *group, *key, *title, *unit, *below;
    int who; /* 0: of the model, 1: of the one beside it */
    int rows;
    double *x, *y;
} StudyCurve;

typedef struct StudyRun {
    const char *reason[2]; /* why the model, and the one beside it, has no results; NULL: it has, or is not there */
    int rows, curves;
    SheetRow *row; /* `section`: of each; `other`: of the vehicle beside */
    StudyCurve *curve;
} StudyRun;

/* What is to be known of numbers of so many runs, the first of which is `first`. */
typedef struct StudyNote {
    const char *text;
    int who;
    int64_t runs, first, last;
} StudyNote;

/* All runs. */
typedef struct StudySweep {
    Pool *pool;
    const Model *model;
    StudyKind kind;
    const Request *request;
    SweepPlan plan;
    const char **unit;        /* [varied] */
    const Model *beside;      /* --compare: the other vehicle; NULL: there is none */
    const char *scene_beside; /* or a scene, which sets parameters of the same model beside; NULL: there is none */
    const char *name[2];      /* of the model and of the one beside it */
    SheetShapes *shapes;      /* of the modes of both, by which they have their numbers in all runs */
    bool *moves;              /* [varied] the one beside has this number, too */
    StudyRun *run;            /* [plan.runs] */
    const char *first;        /* what the first failure prints; NULL: nothing failed */
    int columns, notes;
    StudyNote *note;
    SheetRow *column; /* the numbers of all runs: those of the first that has them */
    double *value[2]; /* [runs][columns] of the model, and of the one beside; NAN: it has no such number */
} StudySweep;

enum { STUDY_RUNS_MOST = 100000 };

/* study.c: make all runs, which the words request->vary say, of the model and of the one of request->compare beside
 * it, and write what was asked for. Runs that fail have no numbers and are told, and then it ends in diag_fail; if all
 * do, nothing is written. */
void study_sweep(Pool *pool, const Model *model, StudyKind kind, const Request *request);
/* True: a number of either vehicle differs from run to run, by more than rounding; with fewer than two runs that have
 * results, of any number. */
bool study_changes(const StudySweep *sweep, int column);
/* True: in a run, a number of both vehicles is not the same, by more than rounding. */
bool study_differs(const StudySweep *sweep, int column, int64_t run);
/* "upper.z = 0.7, speed = 20" */
const char *study_label(const StudySweep *sweep, int64_t run);
/* A number as tables show it. */
const char *study_shown(const StudySweep *sweep, int who, int column, int64_t run);
/* The next vehicle of a run without results, from the k-th on; -1: none. Run and vehicle are k / 2 and k % 2. */
int64_t study_next_failed(const StudySweep *sweep, int64_t k);
/* "with upper.z = 0.7: it tips over"; of a comparison with the name of the vehicle. k: of study_next_failed(). */
const char *study_failure(const StudySweep *sweep, int64_t k);
/* A note for people, with the runs that it is of. */
const char *study_note(const StudySweep *sweep, const StudyNote *note);

/* study_run.c: make a run. A mistake of the call ends in diag_fail_call. */
void study_make(StudySweep *sweep, int64_t number);

/* study_curves.c: the curves of a vehicle of a run, copied into the pool. */
void study_curves_kc(Pool *pool, const KcStudy *study, int who, StudyRun *run);
struct KcCarrying;
void study_curves_joints(Pool *pool, const KcStudy *study, const struct KcCarrying *carrying, int who, StudyRun *run);
struct Manoeuvre;
void study_curves_manoeuvre(Pool *pool, const struct Manoeuvre *manoeuvre, int who, StudyRun *run);

/* study_page.c */
void study_page(const StudySweep *sweep, const char *path);

#endif
