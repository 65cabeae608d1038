/* SPDX-License-Identifier: MIT
 * Sensitivity of metrics to what varies: Sobol' indices of first order and total ones. The runs are those of Saltelli:
 * for each base point a run at the point A, one at another point B, and for each varied number one at A with B's value
 * of it. */
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_sort.h>

enum { RESAMPLED = 1000, LEAST = 16 /* base points that say something */ };

struct Sobol {
    Pool *pool;
    const SweepForm *form;
    int varied, metrics;
    int64_t row;
    double *value;      /* [metrics][bases][varied + 2] */
    SobolIndices found; /* after the last row */
};

const char *const sobol_name[SOBOL_NUMBERS] = {"first", "first.low", "first.high", "total", "total.low", "total.high"};

static int columns_of(const SweepForm *form, const char *group)
{
    int count = 0;
    for (int c = 0; c < form->columns; ++c)
        count += !strcmp(form->column[c].group, group);
    return count;
}

/* The k-th column of a group. */
static const SweepColumn *column_of(const SweepForm *form, const char *group, int k)
{
    const SweepColumn *column = form->column;
    for (int left = k;; ++column)
        if (!strcmp(column->group, group) && left-- == 0)
            return column;
}

Sobol *sobol_open(Pool *pool, const SweepForm *form)
{
    Sobol *s = pool_alloc(pool, sizeof *s);
    *s = (Sobol){
        .pool = pool, .form = form, .varied = columns_of(form, "parameters"), .metrics = columns_of(form, "metrics")};
    s->value = pool_alloc(pool, sizeof *s->value * (size_t)(s->metrics * form->bases * (s->varied + 2) + 1));
    return s;
}

void sobol_row(Sobol *s, const char *row)
{
    char *end;
    for (int c = 0, m = 0; c < s->form->columns; ++c, row = *end ? end + 1 : end) {
        const double value = strtod(row, &end);
        if (!strcmp(s->form->column[c].group, "metrics"))
            s->value[m++ * s->form->bases * (s->varied + 2) + s->row] = value;
    }
    ++s->row;
}

/* Of `count` base points, pick[] or all in order: the estimates of Saltelli (2010) and of Jansen (1999), [varied] each.
 */
static void estimate(int varied, int64_t count, const double *value, const int64_t *pick, double *first, double *total)
{
    const int each = varied + 2;
    double mean = 0, variance = 0, least = INFINITY, most = -INFINITY;
    for (int64_t j = 0; j < count; ++j) {
        const double *f = value + (pick ? pick[j] : j) * each;
        mean += (f[0] + f[1]) / (double)(2 * count);
        least = fmin(least, fmin(f[0], f[1]));
        most = fmax(most, fmax(f[0], f[1]));
    }
    for (int i = 0; i < varied; ++i)
        first[i] = total[i] = 0;
    for (int64_t j = 0; j < count; ++j) {
        const double *f = value + (pick ? pick[j] : j) * each;
        const double a = f[0] - mean, b = f[1] - mean;
        variance += (a * a + b * b) / (double)(2 * count);
        for (int i = 0; i < varied; ++i) {
            const double way = f[2 + i] - f[0];
            first[i] += b * way / (double)count;
            total[i] += way * way / (double)(2 * count);
        }
    }
    for (int i = 0; i < varied; ++i) { /* of equal numbers rounding leaves a variance, too */
        first[i] = most > least ? first[i] / variance : (double)NAN;
        total[i] = most > least ? total[i] / variance : (double)NAN;
    }
}

/* From `low` to `high` of sorted numbers lie 95 percent of them. */
static void interval(double *sample, double *low, double *high)
{
    gsl_sort(sample, 1, RESAMPLED);
    *low = sample[RESAMPLED * 25 / 1000];
    *high = sample[RESAMPLED - 1 - RESAMPLED * 25 / 1000];
}

/* Base points of which all runs have a finite number, moved together. Returns how many there are. */
static int64_t keep_finite(int each, int64_t bases, double *value)
{
    int64_t kept = 0;
    for (int64_t j = 0; j < bases; ++j) {
        bool finite = true;
        for (int k = 0; k < each; ++k)
            finite &= isfinite(value[j * each + k]);
        if (finite)
            memmove(value + kept++ * each, value + j * each, sizeof *value * (size_t)each);
    }
    return kept;
}

/* number[varied][SOBOL_NUMBERS] of a metric; returns the base points that they come from. */
static int64_t find_metric(const Sobol *s, Pool *pool, int metric, double *number)
{
    const int varied = s->varied, each = varied + 2;
    const int64_t bases = s->form->bases;
    double *value = s->value + metric * bases * each;
    const int64_t count = keep_finite(each, bases, value);
    double first[2][varied], total[2][varied];
    double *sample = pool_alloc(pool, sizeof *sample * RESAMPLED * 2 * (size_t)varied);
    int64_t *pick = pool_alloc(pool, sizeof *pick * (size_t)(count + 1));
    uint64_t state = 1; /* the same intervals on every machine */
    estimate(varied, count, value, NULL, first[0], total[0]);
    for (int r = 0; r < RESAMPLED && count >= LEAST; ++r) {
        for (int64_t j = 0; j < count; ++j)
            pick[j] = (int64_t)(random_share(&state) * (double)count);
        estimate(varied, count, value, pick, first[1], total[1]);
        for (int i = 0; i < varied; ++i) {
            sample[(2 * i) * RESAMPLED + r] = first[1][i];
            sample[(2 * i + 1) * RESAMPLED + r] = total[1][i];
        }
    }
    for (int i = 0; i < varied; ++i, number += SOBOL_NUMBERS) {
        for (int k = 0; k < SOBOL_NUMBERS; ++k)
            number[k] = (double)NAN;
        if (count < LEAST)
            continue;
        number[0] = first[0][i];
        number[3] = total[0][i];
        interval(sample + (2 * i) * RESAMPLED, &number[1], &number[2]);
        interval(sample + (2 * i + 1) * RESAMPLED, &number[4], &number[5]);
    }
    return count;
}

const SobolIndices *sobol_indices(Sobol *s)
{
    SobolIndices *found = &s->found;
    if (found->number)
        return found;
    *found = (SobolIndices){
        .metrics = s->metrics,
        .varied = s->varied,
        .number = pool_alloc(s->pool, sizeof(double) * (size_t)(s->metrics * s->varied * SOBOL_NUMBERS + 1)),
        .points = pool_alloc(s->pool, sizeof(double) * (size_t)(s->metrics + 1))};
    for (int m = 0; m < s->metrics; ++m) {
        Pool *pool = pool_new();
        found->points[m] = (double)find_metric(s, pool, m, found->number + m * s->varied * SOBOL_NUMBERS);
        pool_free(pool);
    }
    return found;
}

const char *sobol_text(Sobol *s)
{
    const SobolIndices *found = sobol_indices(s);
    const double *number = found->number;
    Text out = {.pool = s->pool};
    text_print(&out, "metric,number");
    for (int k = 0; k < SOBOL_NUMBERS; ++k)
        text_print(&out, ",%s", sobol_name[k]);
    text_print(&out, ",points\n");
    for (int m = 0; m < s->metrics; ++m)
        for (int i = 0; i < s->varied; ++i) {
            text_print(&out, "%s,%s", csv_quoted(s->pool, column_of(s->form, "metrics", m)->name),
                       csv_quoted(s->pool, column_of(s->form, "parameters", i)->name));
            for (int k = 0; k < SOBOL_NUMBERS; ++k, ++number)
                text_print(&out, isfinite(*number) ? ",%.6g" : ",nan", *number);
            text_print(&out, ",%lld\n", (long long)found->points[m]);
        }
    return out.s;
}
