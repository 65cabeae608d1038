/* SPDX-License-Identifier: MIT
 * Response surfaces: polynomials of second order through a metric by least squares. What leaving out a run would change
 * is known without another fit: its residual then is r/(1 - h), h being the run's place on the diagonal of the matrix
 * that makes fitted values of values. */
#include "host/gsl_errors.h"
#include "sweep/report.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_multifit.h>

/* Singular values below this part of the largest one, and 1 - h below this, are 0 but for rounding: shares lie from -1
 * to 1, and a design that is that near to a singular one determines no surface to any use. */
static const double singular = 1e-8;
/* A metric that varies by less than this part of itself does so by rounding. */
static const double rounding = 1e-12;

int surface_terms(int varied)
{
    return (varied + 1) * (varied + 2) / 2;
}

void surface_terms_at(const Surface *s, const double *x, double *term)
{
    double u[SURFACE_VARIED_MOST];
    *term++ = 1;
    for (int i = 0; i < s->varied; ++i)
        *term++ = u[i] = (x[i] - s->middle[i]) / s->half[i];
    for (int i = 0; i < s->varied; ++i)
        for (int j = i; j < s->varied; ++j)
            *term++ = u[i] * u[j];
}

double surface_at(const Surface *s, const double *x)
{
    double term[(SURFACE_VARIED_MOST + 1) * (SURFACE_VARIED_MOST + 2) / 2], value = 0;
    surface_terms_at(s, x, term);
    for (int k = 0; k < s->terms; ++k)
        value += s->factor[k] * term[k];
    return value;
}

/* Different values of a number among some runs, counted up to 3. */
static int values_of(int varied, int v, int64_t runs, const int64_t *run, const double *point)
{
    double seen[3];
    int count = 0;
    for (int64_t i = 0; i < runs && count < 3; ++i) {
        const double x = point[run[i] * varied + v];
        int k = 0;
        while (k < count && seen[k] != x)
            ++k;
        if (k == count)
            seen[count++] = x;
    }
    return count;
}

/* Ranges of shares; why there is no surface, as far as that can be told without fitting one. */
static void look_at_design(Pool *pool, const char *const *name, const int64_t *run, const double *point,
                           const double *value, Surface *s)
{
    double low = INFINITY, high = -INFINITY;
    for (int v = 0; v < s->varied; ++v) {
        double from = INFINITY, to = -INFINITY;
        for (int64_t i = 0; i < s->runs; ++i) {
            from = fmin(from, point[run[i] * s->varied + v]);
            to = fmax(to, point[run[i] * s->varied + v]);
        }
        s->middle[v] = from / 2 + to / 2;
        s->half[v] = to / 2 - from / 2;
    }
    if (s->runs <= s->terms) {
        s->why = pool_print(pool, "%lld runs have this number; %d factors and their error need at least %d",
                            (long long)s->runs, s->terms, s->terms + 1);
        return;
    }
    for (int v = 0; v < s->varied && !s->why; ++v) {
        const int values = values_of(s->varied, v, s->runs, run, point);
        if (values < 3)
            s->why = pool_print(pool, "%s has %d %s in the runs that have this number; second order needs 3 or more",
                                name[v], values, values == 1 ? "value" : "values");
    }
    for (int64_t i = 0; i < s->runs; ++i) {
        low = fmin(low, value[run[i]]);
        high = fmax(high, value[run[i]]);
    }
    if (!s->why && high - low <= rounding * fmax(fabs(low), fabs(high)))
        s->why = "it does not vary";
}

/* Residuals of the fit to what differs from the mean. U: from the decomposition, whose rows' squares are h. Returns the
 * run without which the others determine no surface, or -1. */
static int64_t measure(const int64_t *run, const double *point, const double *value, double mean, const gsl_matrix *U,
                       Surface *s)
{
    double all = 0, rest = 0, left = 0;
    for (int64_t i = 0; i < s->runs; ++i) {
        const double y = value[run[i]] - mean, r = y - surface_at(s, point + run[i] * s->varied);
        double h = 0;
        for (int k = 0; k < s->terms; ++k)
            h += gsl_matrix_get(U, (size_t)i, (size_t)k) * gsl_matrix_get(U, (size_t)i, (size_t)k);
        if (1 - h < singular)
            return run[i];
        const double without = r / (1 - h);
        if (fabs(without) > fabs(s->worst) || i == 0) {
            s->worst = without;
            s->worst_run = run[i];
        }
        all += y * y;
        rest += r * r;
        left += without * without;
    }
    s->r2 = 1 - rest / all;
    s->left_r2 = 1 - left / all;
    s->residual = sqrt(rest / (double)s->runs);
    s->left = sqrt(left / (double)s->runs);
    return -1;
}

static void solve(Pool *pool, const int64_t *run, const double *point, const double *value, Surface *s)
{
    const size_t n = (size_t)s->runs, p = (size_t)s->terms;
    double mean = 0, size, rest;
    int64_t alone = -1;
    s->factor = pool_alloc(pool, p * sizeof *s->factor);
    gsl_matrix_view X = gsl_matrix_view_array(pool_alloc(pool, n * p * sizeof(double)), n, p);
    gsl_vector_view y = gsl_vector_view_array(pool_alloc(pool, n * sizeof(double)), n);
    gsl_vector_view c = gsl_vector_view_array(s->factor, p);
    for (size_t i = 0; i < n; ++i)
        mean += value[run[i]] / (double)n;
    for (size_t i = 0; i < n; ++i) {
        surface_terms_at(s, point + run[i] * s->varied, gsl_matrix_ptr(&X.matrix, i, 0));
        gsl_vector_set(&y.vector, i, value[run[i]] - mean); /* roundings of a large constant stay out of the errors */
    }
    gsl_errors_return();
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, p); /* no other memory until it is freed */
    if (gsl_multifit_linear_svd(&X.matrix, work) || gsl_multifit_linear_rank(singular, work) < p ||
        gsl_multifit_linear_solve(0, &X.matrix, &y.vector, &c.vector, &rest, &size, work))
        s->why = "the runs lie such that terms of second order cannot be told apart";
    else
        alone = measure(run, point, value, mean, work->A, s);
    gsl_multifit_linear_free(work);
    s->factor[0] += mean;
    if (alone >= 0)
        s->why = pool_print(pool, "without run %lld the others do not determine it, so that its error is unknown",
                            (long long)alone);
}

Surface surface_fit(Pool *pool, const char *const *name, int varied, int64_t runs, const double *point,
                    const double *value)
{
    Surface s = {.varied = varied, .terms = surface_terms(varied)};
    int64_t *run = pool_alloc(pool, sizeof *run * (size_t)(runs + 1));
    for (int64_t r = 0; r < runs; ++r)
        if (isfinite(value[r]))
            run[s.runs++] = r;
    look_at_design(pool, name, run, point, value, &s);
    if (!s.why)
        solve(pool, run, point, value, &s);
    return s;
}
