/* SPDX-License-Identifier: MIT
 * The matrices of a linear model, column by column, and the directions in which nothing happens. */
#include "run/linear_model.h"
#include "base/message.h"
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "model/model.h"
#include "run/linearize.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

static double *numbers(Pool *pool, int count)
{
    return pool_alloc(pool, ((size_t)count + 1) * sizeof(double));
}

static gic_signal *signals(Pool *pool, int count)
{
    return pool_alloc(pool, ((size_t)count + 1) * sizeof(gic_signal));
}

/* ---- names ---------------------------------------------------------------------------------------------- */

/* The unit of a rate of change. */
static const char *per_second(Pool *pool, const char *unit)
{
    if (!strcmp(unit, "1"))
        return "1/s";
    if (!strcmp(unit, "s"))
        return "1";
    const char *slash = strstr(unit, "/s");
    if (slash && !slash[2])
        return pool_print(pool, "%s^2", unit);
    return pool_print(pool, "%s/s", unit);
}

static const char *state_unit(const Linear *linear, int i)
{
    const gic_model *code = &linear->engine->code;
    const int base = code->free_base ? 6 : 0;
    if (i >= 2 * linear->places)
        return code->state[code->slow_count + i - 2 * linear->places].unit;
    const int place = i % linear->places;
    if (place < base)
        return place < 3 ? "m" : "rad";
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] == place + code->free_base)
            return code->coordinate[c].unit;
    return "1";
}

const char *linear_unit(Pool *pool, const Linear *linear, int i)
{
    const bool is_rate = i >= linear->places && i < 2 * linear->places;
    return is_rate ? per_second(pool, state_unit(linear, i)) : state_unit(linear, i);
}

static void name_states(Pool *pool, LinearModel *m, const Linear *linear)
{
    for (int i = 0; i < m->states; ++i) {
        const bool is_rate = i >= linear->places && i < 2 * linear->places;
        m->state[i] = (gic_signal){is_rate ? pool_print(pool, "%s.rate", linear->name[i]) : linear->name[i],
                                   linear_unit(pool, linear, i)};
        m->rate[i] = (gic_signal){m->state[i].name, per_second(pool, m->state[i].unit)};
    }
}

/* True if an input, or a port among the inputs before it, has the name. */
static bool is_input(const LinearModel *m, int count, const char *name)
{
    for (int i = 0; i < count; ++i)
        if (!strcmp(m->input[i].name, name))
            return true;
    return false;
}

static void name_inputs(Pool *pool, LinearModel *m, const gic_model *code)
{
    memcpy(m->input, code->input, (size_t)code->input_count * sizeof *m->input);
    for (int i = 0; i < code->port_count; ++i) {
        const gic_signal *port = &code->port[i];
        const char *name =
            is_input(m, code->input_count, port->name) ? pool_print(pool, "port/%s", port->name) : port->name;
        m->input[code->input_count + i] = (gic_signal){name, port->unit};
    }
}

/* ---- where it is ---------------------------------------------------------------------------------------- */

static void take_point(LinearModel *m, const Linear *linear, Instance *self)
{
    const gic_model *code = &linear->engine->code;
    const double *y = tape_array(self, code->state_offset);
    const int base = code->free_base ? 6 : 0, places = linear->places;
    m->time = gic_time(self);
    m->free_base = code->free_base;
    if (m->free_base)
        memcpy(m->base, y, sizeof m->base);
    for (int i = base; i < places; ++i)
        m->z0[i] = y[i + code->free_base];
    memcpy(m->z0 + places, m->f, (size_t)places * sizeof *m->z0); /* velocities are the rates of places */
    memcpy(m->z0 + 2 * places, y + code->slow_count, (size_t)(m->states - 2 * places) * sizeof *m->z0);
    memcpy(m->u0, tape_array(self, code->input_offset), (size_t)code->input_count * sizeof *m->u0);
    memcpy(m->u0 + code->input_count, tape_array(self, code->port_offset), (size_t)code->port_count * sizeof *m->u0);
    memcpy(m->p0, tape_array(self, code->parameter_offset), (size_t)m->parameters * sizeof *m->p0);
    memcpy(m->y0, tape_array(self, code->output_offset), (size_t)m->outputs * sizeof *m->y0);
    const int32_t *discrete = (const int32_t *)(void *)tape_array(self, code->discrete_offset) + code->free_base;
    for (int i = 0; i < m->held; ++i) {
        const int gear = i - linear->clocks;
        m->held_value[i] = gear < 0 ? y[code->slow_count + code->fast_count + gear] : discrete[gear];
        m->held_name[i] =
            gear < 0 ? code->state[code->slow_count + code->fast_count + gear] : code->discrete[code->free_base + gear];
    }
}

/* ---- derivatives ---------------------------------------------------------------------------------------- */

/* What is differentiated by: where its columns stand. */
typedef struct Columns {
    LinearKind kind;
    const gic_signal *signal;
    int first, count, width; /* columns `first` to first + count of matrices `width` wide */
    double *rates, *outputs;
} Columns;

/* End with a message if a derivative is not finite. */
static void check_column(Pool *pool, const LinearModel *m, const OperatingPoint *point, const double *df,
                         const double *dout, const char *by)
{
    for (int i = 0; i < m->states + m->outputs; ++i) {
        const bool output = i >= m->states;
        if (!isfinite(output ? dout[i - m->states] : df[i]))
            diag_fail((Place){point->source, 0, 0},
                      "take another operating point, or make the formula smooth there: sqrt(x^2 + 1e-6) instead of "
                      "sqrt(x^2), no root or power of 0",
                      "the derivative of %s by %s does not exist at the operating point",
                      output ? pool_print(pool, "the output %s", m->output[i - m->states].name)
                             : pool_print(pool, "the rate of %s", m->state[i].name),
                      by);
    }
}

static void find_columns(Pool *pool, const LinearModel *m, const OperatingPoint *point, const Columns *c, bool *warn)
{
    double df[m->states + 1], dout[m->outputs + 1];
    for (int j = 0; j < c->count; ++j) {
        bool jump;
        const int status = linear_column(point->linear, point->self, c->kind, j, df, m->outputs, dout, &jump);
        if (status != GIC_OK)
            diag_fail((Place){point->source, 0, 0}, "take another operating point", "no derivatives by %s: %s",
                      c->signal[j].name,
                      instance_status(pool, &point->linear->engine->code, &point->self->head, status));
        check_column(pool, m, point, df, dout, c->signal[j].name);
        for (int i = 0; i < m->states; ++i)
            c->rates[i * c->width + c->first + j] = df[i] + 0.0; /* no -0 */
        for (int i = 0; i < m->outputs; ++i)
            c->outputs[i * c->width + c->first + j] = dout[i] + 0.0;
        if (jump && *warn)
            diag_warn((Place){point->source, 0, 0},
                      "make the formula that jumps there continuous: tanh instead of a sign",
                      "a rate or an output jumps where %s passes the value that it has there; derivatives are the mean "
                      "of both sides",
                      c->signal[j].name);
        *warn = *warn && !jump;
    }
}

/* ---- what is neutral ------------------------------------------------------------------------------------ */

/* Number of a place or fast state among the states. */
static int state_of(const Linear *linear, int column)
{
    return column < linear->places ? column : column + linear->places;
}

/* Right singular vectors, columns of V, of the matrix of accelerations and fast states' rates by places and fast
 * states, in units of the reach; returns how many singular values are zero to rounding. Their vectors are the last
 * ones. */
static size_t find_null(const LinearModel *m, const Linear *linear, gsl_matrix *V)
{
    const double rank_limit = 1e-10; /* relative to the largest singular value; rounding leaves about 1e-15 */
    const size_t n = V->size1;
    gsl_matrix *U = gsl_matrix_alloc(n, n);
    gsl_vector *S = gsl_vector_alloc(n);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j) {
            const int row = linear->places + (int)i, column = state_of(linear, (int)j);
            gsl_matrix_set(U, i, j, m->A[row * m->states + column] * linear->reach[column] / linear->reach[row]);
        }
    gsl_linalg_SV_decomp_jacobi(U, V, S);
    size_t null = 0;
    while (null < n && !(gsl_vector_get(S, n - 1 - null) > rank_limit * gsl_vector_get(S, 0)))
        ++null;
    gsl_vector_free(S);
    gsl_matrix_free(U);
    return null;
}

/* Combine the last `null` columns of V so that each is 1 in a row where the others are 0: Gauss-Jordan elimination with
 * the largest number that is left as the pivot. pivot: [null] rows. */
static void reduce(gsl_matrix *V, size_t null, size_t *pivot)
{
    const size_t n = V->size1, first = n - null;
    for (size_t k = first; k < n; ++k) {
        size_t row = 0, column = k;
        for (size_t i = 0; i < n; ++i)
            for (size_t j = k; j < n; ++j)
                if (fabs(gsl_matrix_get(V, i, j)) > fabs(gsl_matrix_get(V, row, column))) {
                    row = i;
                    column = j;
                }
        gsl_matrix_swap_columns(V, k, column);
        const double value = gsl_matrix_get(V, row, k);
        for (size_t i = 0; i < n; ++i)
            gsl_matrix_set(V, i, k, i == row ? 1 : gsl_matrix_get(V, i, k) / value);
        for (size_t j = first; j < n; ++j) {
            const double share = gsl_matrix_get(V, row, j);
            for (size_t i = 0; i < n && j != k; ++i)
                gsl_matrix_set(V, i, j, i == row ? 0 : gsl_matrix_get(V, i, j) - share * gsl_matrix_get(V, i, k));
        }
        pivot[k - first] = row;
    }
}

/* The column of V, from `first` on, whose pivot is the next one after row `after`. */
static size_t next_pivot(const size_t *pivot, size_t null, size_t from)
{
    size_t best = null;
    for (size_t k = 0; k < null; ++k)
        if (pivot[k] >= from && (best == null || pivot[k] < pivot[best]))
            best = k;
    return best;
}

static void find_neutral(Pool *pool, LinearModel *m, const Linear *linear)
{
    const double rounding = 1e-9; /* what is left of a share of 0, in units of the reach */
    const size_t n = (size_t)(linear->count - linear->places);
    if (n == 0) /* all coordinates are driven */
        return;
    gsl_errors_return();
    gsl_matrix *V = gsl_matrix_alloc(n, n);
    const size_t null = find_null(m, linear, V);
    size_t pivot[n], from = 0;
    reduce(V, null, pivot);
    m->neutral = (int)null;
    m->N = numbers(pool, m->states * m->neutral);
    m->neutral_name = pool_alloc(pool, (null + 1) * sizeof *m->neutral_name);
    for (int k = 0; k < m->neutral; ++k) {
        const size_t at = next_pivot(pivot, null, from);
        const int named = state_of(linear, (int)pivot[at]);
        for (size_t j = 0; j < n; ++j) {
            const int state = state_of(linear, (int)j);
            const double share = gsl_matrix_get(V, j, n - null + at);
            m->N[state * m->neutral + k] =
                fabs(share) > rounding ? share * linear->reach[state] / linear->reach[named] : 0;
        }
        m->neutral_name[k] = m->state[named].name;
        from = pivot[at] + 1;
    }
    gsl_matrix_free(V);
}

const LinearModel *linear_model(Pool *pool, const OperatingPoint *point, int outputs, bool quiet)
{
    const Linear *linear = point->linear;
    const gic_model *code = &linear->engine->code;
    LinearModel *m = pool_alloc(pool, sizeof *m);
    const int n = linear->count, inputs = code->input_count + code->port_count, parameters = code->parameter_count;
    const int held = linear->clocks + code->discrete_count - code->free_base;
    *m = (LinearModel){
        .states = n,
        .inputs = inputs,
        .outputs = outputs,
        .held = held,
        .parameters = parameters,
        .state = signals(pool, n),
        .rate = signals(pool, n),
        .input = signals(pool, inputs),
        .output = (gic_signal *)code->output, /* only read */
        .parameter = (gic_signal *)code->parameter,
        .held_name = signals(pool, held),
        .held_value = numbers(pool, held),
        .f = numbers(pool, n),
        .z0 = numbers(pool, n),
        .u0 = numbers(pool, inputs),
        .y0 = numbers(pool, outputs),
        .p0 = numbers(pool, parameters),
        .A = numbers(pool, n * n),
        .B = numbers(pool, n * inputs),
        .C = numbers(pool, outputs * n),
        .D = numbers(pool, outputs * inputs),
        .E = numbers(pool, n * parameters),
        .F = numbers(pool, outputs * parameters),
    };
    name_states(pool, m, linear);
    name_inputs(pool, m, code);
    const int status = linear_start(linear, point->self, m->f);
    if (status != GIC_OK)
        diag_fail((Place){point->source, 0, 0}, "take another operating point", "no rates at the operating point: %s",
                  instance_status(pool, code, &point->self->head, status));
    take_point(m, linear, point->self);
    const Columns columns[] = {
        {LINEAR_MOTION, m->state, 0, n, n, m->A, m->C},
        {LINEAR_INPUT, m->input, 0, code->input_count, inputs, m->B, m->D},
        {LINEAR_PORT, m->input + code->input_count, code->input_count, code->port_count, inputs, m->B, m->D},
        {LINEAR_PARAMETER, m->parameter, 0, parameters, parameters, m->E, m->F},
    };
    bool warn = !quiet;
    for (size_t i = 0; i < sizeof columns / sizeof *columns; ++i)
        find_columns(pool, m, point, &columns[i], &warn);
    find_neutral(pool, m, linear);
    return m;
}
