/* SPDX-License-Identifier: MIT
 * The least mean of powers of an order p of what is left, r, within bounds: p = 2 is least squares, a large p comes
 * near the least largest magnitude. Newton's step without second derivatives of r solves
 *
 *     sum |r|^(p - 2) ((p - 1) (r' . d) r' + r r') = 0,
 *
 * least squares with weights |r|^(p - 2), towards r / (p - 1). It is damped as Levenberg and Marquardt do, with the
 * variables that stand at a bound and would leave it held, and cut off at the bounds. */
#include "gic_runtime.h"
#include "model/limits.h"
#include "run/optimize.h"
#include "run/number_place.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

static const double less = 0.2, more = 6; /* damping after two steps that were good, and after one that was not */
static const double most_damping = 1e12, first_damping = 1e-3;
static const double small = 1e-8, little = 1e-7; /* a step, of the bounds' distance; what it gains, of the mean */

static double width(const Search *s, int k)
{
    return s->high[k] - s->low[k];
}

int optimize_run(Search *s, const double *x, double *rest, double *jacobian)
{
    const size_t rows = (size_t)s->formulas, row = (size_t)(s->formulas * s->variables);
    for (int k = 0; k < s->variables; ++k)
        *number_place(s->model, s->scene, &s->variable[k]) = x[k];
    ++s->runs;
    BrokenLimit broken;
    if (limit_broken(s->model, s->scene->parameter, &broken))
        return s->status = GIC_ERROR_GEOMETRY;
    int status = tangent_begin(s->run, scene_renewed(s->scene, s->running));
    for (int t = 0; t < s->times && status == GIC_OK; ++t) {
        for (int64_t i = 0; t > 0 && i < s->scene->per_output && status == GIC_OK; ++i)
            status = tangent_step(s->run);
        if (status == GIC_OK)
            status = tangent_look(s->run, rest + rows * (size_t)t, jacobian + row * (size_t)t);
        s->time[t] = tangent_time(s->run);
    }
    return s->status = status;
}

/* The largest magnitude. */
static double largest_of(const double *rest, int count)
{
    double largest = 0;
    for (int i = 0; i < count; ++i)
        largest = fmax(largest, fabs(rest[i]));
    return largest;
}

/* The mean of powers, with a root: a number of the size of what is left. */
static double mean_of(const double *rest, int count, double order)
{
    const double largest = largest_of(rest, count);
    double sum = 0;
    for (int i = 0; i < count && largest > 0; ++i)
        sum += pow(fabs(rest[i]) / largest, order);
    return largest > 0 ? largest * pow(sum / count, 1 / order) : 0;
}

/* What steps are made of, at search->x. */
typedef struct Slope {
    int count, *free; /* variables that may move */
    double *size;     /* [variables] root of the sum of squares of weighted columns, in widths */
    double *weight;   /* [rows] */
} Slope;

static void find_slope(const Search *s, double order, Slope *slope)
{
    const int rows = s->times * s->formulas;
    const double largest = largest_of(s->rest, rows);
    slope->count = 0;
    for (int i = 0; i < rows; ++i)
        slope->weight[i] = largest > 0 ? pow(fabs(s->rest[i]) / largest, order / 2 - 1) : 1;
    for (int k = 0; k < s->variables; ++k) {
        double down = 0, square = 0;
        for (int i = 0; i < rows; ++i) {
            const double part = s->jacobian[i * s->variables + k] * slope->weight[i] * width(s, k);
            down -= part * s->rest[i] * slope->weight[i];
            square += part * part;
        }
        slope->size[k] = sqrt(square);
        if (square > 0 && !(s->x[k] <= s->low[k] && down < 0) && !(s->x[k] >= s->high[k] && down > 0))
            slope->free[slope->count++] = k;
    }
}

/* A damped step from search->x, cut off at the bounds, to x. */
static void find_step(const Search *s, const Slope *slope, double order, double damping, double *x)
{
    const size_t n = (size_t)slope->count, rows = (size_t)(s->times * s->formulas);
    gsl_matrix *A = gsl_matrix_calloc(rows + n, n);
    gsl_vector *b = gsl_vector_calloc(rows + n), *step = gsl_vector_alloc(n), *tau = gsl_vector_alloc(n),
               *left = gsl_vector_alloc(rows + n);
    for (size_t i = 0; i < rows; ++i) {
        gsl_vector_set(b, i, -slope->weight[i] * s->rest[i] / (order - 1));
        for (size_t j = 0; j < n; ++j) {
            const int k = slope->free[j];
            gsl_matrix_set(A, i, j, s->jacobian[(int)i * s->variables + k] * slope->weight[i] * width(s, k));
        }
    }
    for (size_t j = 0; j < n; ++j)
        gsl_matrix_set(A, rows + j, j, sqrt(damping) * slope->size[slope->free[j]]);
    gsl_linalg_QR_decomp(A, tau);
    gsl_linalg_QR_lssolve(A, tau, b, step, left);
    memcpy(x, s->x, (size_t)s->variables * sizeof *x);
    for (size_t j = 0; j < n; ++j) {
        const int k = slope->free[j];
        x[k] = fmin(fmax(x[k] + gsl_vector_get(step, j) * width(s, k), s->low[k]), s->high[k]);
    }
    gsl_vector_free(left);
    gsl_vector_free(tau);
    gsl_vector_free(step);
    gsl_vector_free(b);
    gsl_matrix_free(A);
}

/* True where a step moves nothing. */
static bool stands(const Search *s, const double *x)
{
    double most = 0;
    for (int k = 0; k < s->variables; ++k)
        most = fmax(most, fabs(x[k] - s->x[k]) / width(s, k));
    return most <= small;
}

bool optimize_least(Search *s, double order, int most)
{
    const int count = s->times * s->formulas;
    const size_t rows = (size_t)count, n = (size_t)s->variables;
    double *x = pool_alloc(s->pool, n * sizeof *x), *rest = pool_alloc(s->pool, rows * sizeof *rest);
    double *jacobian = pool_alloc(s->pool, rows * n * sizeof *jacobian);
    Slope slope = {.free = pool_alloc(s->pool, n * sizeof *slope.free),
                   .size = pool_alloc(s->pool, n * sizeof *slope.size),
                   .weight = pool_alloc(s->pool, rows * sizeof *slope.weight)};
    double mean = mean_of(s->rest, count, order), damping = first_damping;
    bool good = true; /* the last step */
    find_slope(s, order, &slope);
    for (int run = 0; run < most; ++run) {
        if (mean == 0 || slope.count == 0 || damping > most_damping)
            return true;
        find_step(s, &slope, order, damping, x);
        if (stands(s, x))
            return true;
        const bool runs = optimize_run(s, x, rest, jacobian) == GIC_OK;
        const double there = runs ? mean_of(rest, count, order) : INFINITY;
        damping *= !(there < mean) ? more : good ? less : 1;
        good = there < mean;
        if (!good)
            continue;
        const bool done = mean - there <= little * mean;
        mean = there;
        memcpy(s->x, x, n * sizeof *x);
        memcpy(s->rest, rest, rows * sizeof *rest);
        memcpy(s->jacobian, jacobian, rows * n * sizeof *jacobian);
        if (done)
            return true;
        find_slope(s, order, &slope);
    }
    return false;
}
