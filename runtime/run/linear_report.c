/* SPDX-License-Identifier: MIT
 * A linear model for people, and as a file: CSV, NumPy's .npz, MATLAB's .mat. */
#include "base/file.h"
#include "base/pool.h"
#include "gic_runtime.h"
#include "host/arrays.h"
#include "host/host.h"
#include "model/model.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/run.h"

#include <math.h>
#include <string.h>

static const char *const base_name[][2] = {{"r.x", "m"}, {"r.y", "m"}, {"r.z", "m"}, {"e0", "1"},
                                           {"e1", "1"},  {"e2", "1"},  {"e3", "1"}};

bool linear_file_known(const char *path)
{
    return !strcmp(path, "-") || path_ends(path, ".csv") || path_ends(path, ".npz") || path_ends(path, ".mat");
}

/* ---- CSV ------------------------------------------------------------------------------------------------ */

static void write_names(Pool *pool, Csv *csv, const char *kind, const gic_signal *signal, int count)
{
    for (int i = 0; i < count; ++i)
        csv_name(csv, pool_print(pool, "%s/%s", kind, signal[i].name), signal[i].unit);
}

/* A row of numbers `step` apart; NULL: empty cells. */
static void write_numbers(Csv *csv, const double *number, int count, int step)
{
    for (int i = 0; i < count; ++i)
        if (number)
            csv_number(csv, number[i * step]);
        else
            csv_text(csv, NULL);
}

static void begin_row(Pool *pool, Csv *csv, const char *kind, const char *name, const char *unit)
{
    csv_name(csv, name ? pool_print(pool, "%s/%s", kind, name) : kind, NULL);
    if (unit)
        csv_name(csv, unit, NULL);
    else
        csv_text(csv, NULL);
}

/* One number and no derivatives. */
static void write_value(Pool *pool, Csv *csv, const LinearModel *m, const char *kind, const char *name,
                        const char *unit, double value)
{
    begin_row(pool, csv, kind, name, unit);
    csv_number(csv, value);
    write_numbers(csv, NULL, m->states + m->inputs + m->parameters, 1);
    csv_end_row(csv);
}

static void write_rows(Pool *pool, Csv *csv, const LinearModel *m, const char *kind, const gic_signal *signal,
                       int count, const double *value, const double *const matrix[3])
{
    for (int i = 0; i < count; ++i) {
        begin_row(pool, csv, kind, signal[i].name, signal[i].unit);
        csv_number(csv, value[i]);
        write_numbers(csv, matrix[0] + i * m->states, m->states, 1);
        write_numbers(csv, matrix[1] + i * m->inputs, m->inputs, 1);
        write_numbers(csv, matrix[2] + i * m->parameters, m->parameters, 1);
        csv_end_row(csv);
    }
}

static void write_csv(Pool *pool, const LinearModel *m, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    csv_name(&csv, "row", NULL);
    csv_name(&csv, "unit", NULL);
    csv_name(&csv, "value", NULL);
    write_names(pool, &csv, "state", m->state, m->states);
    write_names(pool, &csv, "input", m->input, m->inputs);
    write_names(pool, &csv, "parameter", m->parameter, m->parameters);
    csv_end_row(&csv);
    write_value(pool, &csv, m, "time", NULL, "s", m->time);
    for (int i = 0; m->free_base && i < 7; ++i)
        write_value(pool, &csv, m, "base", base_name[i][0], base_name[i][1], m->base[i]);
    for (int i = 0; i < m->held; ++i)
        write_value(pool, &csv, m, "held", m->held_name[i].name, m->held_name[i].unit, m->held_value[i]);
    begin_row(pool, &csv, "at", NULL, NULL);
    csv_text(&csv, NULL);
    write_numbers(&csv, m->z0, m->states, 1);
    write_numbers(&csv, m->u0, m->inputs, 1);
    write_numbers(&csv, m->p0, m->parameters, 1);
    csv_end_row(&csv);
    write_rows(pool, &csv, m, "rate", m->rate, m->states, m->f, (const double *const[]){m->A, m->B, m->E});
    write_rows(pool, &csv, m, "output", m->output, m->outputs, m->y0, (const double *const[]){m->C, m->D, m->F});
    for (int k = 0; k < m->neutral; ++k) {
        begin_row(pool, &csv, "neutral", m->neutral_name[k], NULL);
        csv_text(&csv, NULL);
        write_numbers(&csv, m->N + k, m->states, m->neutral);
        write_numbers(&csv, NULL, m->inputs + m->parameters, 1);
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

/* ---- arrays --------------------------------------------------------------------------------------------- */

static const char *const *texts(Pool *pool, const gic_signal *signal, int count, bool units)
{
    const char **text = pool_alloc(pool, ((size_t)count + 1) * sizeof *text);
    for (int i = 0; i < count; ++i)
        text[i] = units ? signal[i].unit : signal[i].name;
    return text;
}

static void write_arrays(Pool *pool, const LinearModel *m, const char *path)
{
    const int n = m->states, r = m->inputs, q = m->outputs, p = m->parameters;
    const NamedArray array[] = {
        {"A", ARRAY_MATRIX, n, n, m->A, NULL},
        {"B", ARRAY_MATRIX, n, r, m->B, NULL},
        {"C", ARRAY_MATRIX, q, n, m->C, NULL},
        {"D", ARRAY_MATRIX, q, r, m->D, NULL},
        {"E", ARRAY_MATRIX, n, p, m->E, NULL},
        {"F", ARRAY_MATRIX, q, p, m->F, NULL},
        {"N", ARRAY_MATRIX, n, m->neutral, m->N, NULL},
        {"f", ARRAY_VECTOR, n, 1, m->f, NULL},
        {"z0", ARRAY_VECTOR, n, 1, m->z0, NULL},
        {"u0", ARRAY_VECTOR, r, 1, m->u0, NULL},
        {"y0", ARRAY_VECTOR, q, 1, m->y0, NULL},
        {"p0", ARRAY_VECTOR, p, 1, m->p0, NULL},
        {"time", ARRAY_SCALAR, 1, 1, &m->time, NULL},
        {"base", ARRAY_VECTOR, m->free_base ? 7 : 0, 1, m->base, NULL},
        {"held0", ARRAY_VECTOR, m->held, 1, m->held_value, NULL},
        {"held", ARRAY_VECTOR, m->held, 1, NULL, texts(pool, m->held_name, m->held, false)},
        {"states", ARRAY_VECTOR, n, 1, NULL, texts(pool, m->state, n, false)},
        {"state_units", ARRAY_VECTOR, n, 1, NULL, texts(pool, m->state, n, true)},
        {"inputs", ARRAY_VECTOR, r, 1, NULL, texts(pool, m->input, r, false)},
        {"input_units", ARRAY_VECTOR, r, 1, NULL, texts(pool, m->input, r, true)},
        {"outputs", ARRAY_VECTOR, q, 1, NULL, texts(pool, m->output, q, false)},
        {"output_units", ARRAY_VECTOR, q, 1, NULL, texts(pool, m->output, q, true)},
        {"parameters", ARRAY_VECTOR, p, 1, NULL, texts(pool, m->parameter, p, false)},
        {"parameter_units", ARRAY_VECTOR, p, 1, NULL, texts(pool, m->parameter, p, true)},
        {"neutral", ARRAY_VECTOR, m->neutral, 1, NULL, m->neutral_name},
    };
    const int count = (int)(sizeof array / sizeof *array);
    if (path_ends(path, ".npz"))
        npz_write(pool, path, array, count);
    else
        mat_write(pool, path, array, count);
}

/* ---- for people ----------------------------------------------------------------------------------------- */

/* The acceleration that is largest: 0 in a steady state. */
static int largest_rate(const LinearModel *m, const Linear *linear)
{
    int most = linear->places;
    for (int i = linear->places; i < 2 * linear->places; ++i)
        if (fabs(m->f[i]) > fabs(m->f[most]))
            most = i;
    return most;
}

static void print_report(Pool *pool, const LinearModel *m, const Model *model, const OperatingPoint *point,
                         const char *path)
{
    Text text = {.pool = pool}, *out = &text;
    text_print(out, "%s: linear model %s\n", model->name, point->text);
    text_print(out, "  %d states, %d inputs, %d outputs, %d parameters%s%s\n", m->states, m->inputs, m->outputs,
               m->parameters, path ? " in " : "", path ? path : "");
    if (point->linear->places) {
        const int most = largest_rate(m, point->linear);
        text_print(out, "  largest acceleration: %.3g %s, of %s\n", m->f[most], m->rate[most].unit,
                   point->linear->name[most]);
    }
    text_print(out, "  neutral: ");
    for (int k = 0; k < m->neutral; ++k)
        text_print(out, "%s%s", k ? ", " : "", m->neutral_name[k]);
    text_print(out, "%s\n", m->neutral ? "" : "nothing");
    diag_text(text.s);
}

void linear_report(Pool *pool, const Model *model, const OperatingPoint *point, const Request *request)
{
    const LinearModel *m = linear_model(pool, point, model->output_components, request->quiet);
    const char *path = request->results;
    if (!strcmp(path, "-") || path_ends(path, ".csv"))
        write_csv(pool, m, path);
    else
        write_arrays(pool, m, path);
    if (strcmp(path, "-") != 0 && !request->quiet)
        print_report(pool, m, model, point, path);
}
