/* SPDX-License-Identifier: MIT
 *
 * optimize: numbers of a scene, between bounds, with which formulas are nearest to 0 in a run (gicrun --optimize), by
 * the definitions of models/OPTIMIZE.md. */
#ifndef RUN_OPTIMIZE_H
#define RUN_OPTIMIZE_H

#include "base/pool.h"
#include "model/model.h"
#include "run/run.h"
#include "run/tangent_run.h"
#include "scene/scene.h"

/* A search under way, and what it found. */
typedef struct Search {
    Pool *pool;
    const Model *model;         /* whose only outputs are the formulas */
    const char *text;           /* all formulas */
    const char *const *formula; /* [formulas] */
    Scene *scene, *running;     /* with the numbers that are tried; as a run has it, whose conditions change inputs */
    TangentRun *run;
    const RunVariable *variable;
    bool peak; /* the largest magnitude is to be least, else the mean of squares */
    int variables, formulas, times, runs;
    double *low, *high, *x;  /* [variables]; x: the best so far */
    double *time;            /* [times] s */
    double *rest, *jacobian; /* [times][formulas] with x, and by the variables, [variables] each */
    double *start;           /* [times][formulas] of the scene as it is */
    int status;              /* of the last run */
} Search;

/* ---- optimize.c */

/* The root of the mean of squares, or the largest magnitude, of [times][formulas] numbers. */
double optimize_size(const Search *search, const double *rest);
/* --optimize: a table, and a file: a page where its name ends in .html, else CSV. Ends in diag_fail. */
void optimize_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);

/* ---- optimize_step.c */

/* From search->x, at which search->rest and search->jacobian are, to the least mean of powers of `order` within the
 * bounds: those of the best. most: runs. False: it was still moving then. */
bool optimize_least(Search *search, double order, int most);
/* A run with the numbers x, into rest and jacobian of that shape. Returns a status. */
int optimize_run(Search *search, const double *x, double *rest, double *jacobian);

#endif
