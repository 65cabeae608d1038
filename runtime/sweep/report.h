/* SPDX-License-Identifier: MIT
 *
 * report: what the runs of a sweep say together, as a page: Pareto fronts and response surfaces of metrics. */
#ifndef SWEEP_REPORT_H
#define SWEEP_REPORT_H

#include "base/text.h"
#include "model/model.h"
#include "sweep/sweep.h"

/* ---- front.c --------------------------------------------------------------------------------------------- */

/* Metrics of which each is to be small or large. */
typedef struct Front {
    int numbers;
    int *metric; /* [numbers] indices */
    bool *large; /* [numbers] */
} Front;

/* min:NAME,max:NAME,... of two metrics of the form or more; mistakes end in diag_fail_call(). */
Front front_read(Pool *pool, const char *word, const SweepForm *form);
/* The runs that no other one beats: none is as small in all numbers and smaller in one. value[runs][numbers]; a run
 * with a number that is not finite is left out; equal runs are on the front together. on[runs]: the front, by the first
 * number, then the next ones, then the run. Returns how many there are. */
int64_t front_find(Pool *pool, int64_t runs, int numbers, const double *value, int64_t *on);

/* ---- surface.c ------------------------------------------------------------------------------------------- */

enum { SURFACE_VARIED_MOST = 8 };

/* A polynomial of second order of shares u = (x - middle)/half of what varies: factors of 1, of u_0, u_1, ..., of
 * u_0 u_0, u_0 u_1, ..., u_1 u_1, ... Errors in the metric's unit. */
typedef struct Surface {
    const char *why; /* there is no surface; NULL: there is one */
    int varied, terms;
    int64_t runs; /* that have the number */
    double middle[SURFACE_VARIED_MOST], half[SURFACE_VARIED_MOST];
    double *factor;       /* [terms] */
    double r2, residual;  /* root of the mean square */
    double left_r2, left; /* the same where each run is left out of the surface that predicts it, */
    double worst;         /* and the largest of these residuals, */
    int64_t worst_run;    /* of this run */
} Surface;

int surface_terms(int varied);
/* Values of all terms. */
void surface_terms_at(const Surface *surface, const double *x, double *term);
double surface_at(const Surface *surface, const double *x);
/* Least squares over the runs with a finite value. point[runs][varied]. */
Surface surface_fit(Pool *pool, const char *const *name, int varied, int64_t runs, const double *point,
                    const double *value);

/* ---- picture.c ------------------------------------------------------------------------------------------- */

/* A diagram as SVG, with a place for a scale beside it. */
typedef struct Picture {
    Text *out;
    double x[2], y[2]; /* ranges */
} Picture;

/* Begin a figure; ranges that are empty are widened. */
void picture_begin(Picture *picture, const char *title, const char *below, const char *beside);
void picture_point(const Picture *picture, const char *class, double x, double y);
void picture_line(const Picture *picture, const char *class, int points, const double *x, const double *y);
/* Shades of a function, with their scale; points come after it. */
void picture_shades(const Picture *picture, double (*value)(const void *context, double x, double y),
                    const void *context);
void picture_end(const Picture *picture);

/* ---- report_page.c --------------------------------------------------------------------------------------- */

enum { REPORT_RUNS_MOST = 100000 };

typedef struct SweepReport {
    const char *path;
    int fronts;
    const Front *front;
} SweepReport;

/* Look at what is asked for before the runs, or before they are read, so that mistakes are found in seconds: ends in
 * diag_fail() or diag_fail_call(). others: files that the page is not to be, of which the last one is NULL. */
SweepReport sweep_report_open(Pool *pool, const ReportRequest *request, const SweepForm *form, int64_t runs,
                              const char *const *others);
/* Write the page; row[runs] as in Journal. Returns lines about what can't be drawn, or does not fit; "": nothing. */
const char *sweep_report_page(Pool *pool, const SweepForm *form, int64_t runs, const char *const *row,
                              const SweepReport *report);
/* The same, and tell these lines. */
void sweep_report_write(Pool *pool, const SweepForm *form, int64_t runs, const char *const *row,
                        const SweepReport *report, bool quiet);

#endif
