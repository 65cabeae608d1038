/* SPDX-License-Identifier: MIT
 *
 * gic_runtime: fixed-step integrators with what happens within steps (gears, contacts, samples of controllers),
 * orientation, tables and inputs for generated models. The same source is compiled for either number type, so constants
 * go through GIC_R and functions of <math.h> through MATH. It is one file, longer than others here, so that people who
 * embed a model copy and compile one file beside the generated one.
 */
#include "gic_runtime.h"

#include <float.h>

#include <math.h>

#ifdef GIC_FLOAT
#define MATH(name) name##f
#else
#define MATH(name) name
#endif

const char *gic_status_text(int status)
{
    switch (status) {
#define STATUS_CASE(name, code, text) \
    case code: return text;
        GIC_STATUS_LIST(STATUS_CASE)
#undef STATUS_CASE
    default: return "unknown status";
    }
}

int gic_finite(const gic_real *x, int32_t count)
{
    return gic_below(x, count, GIC_BITS_OF_EXPONENT);
}

int gic_bounded(const gic_real *x, int32_t count)
{
    return gic_below(x, count, GIC_BITS_OF_BOUND);
}

gic_real gic_unwound(gic_real change)
{
    const gic_real turn = GIC_R(6.283185307179586), half = GIC_R(0.5) * turn, mean = GIC_R(0.5) * change;
    if ((change <= half && change >= -half) || !gic_bounded(&mean, 1))
        return change;
    const int32_t turns = (int32_t)(change / turn + (change < GIC_R(0.0) ? GIC_R(-0.5) : GIC_R(0.5)));
    return change - (gic_real)turns * turn;
}

/* ---- integrators ---------------------------------------------------------------------------------------- */

static gic_real *array_at(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

/* Four numbers at a time, all read before one is written: compilers then use vectors, since no overlap matters. */
static void copy(gic_real *to, const gic_real *from, int32_t count)
{
    int32_t i = 0;
    for (; i + 4 <= count; i += 4) {
        const gic_real a = from[i], b = from[i + 1], c = from[i + 2], d = from[i + 3];
        to[i] = a;
        to[i + 1] = b;
        to[i + 2] = c;
        to[i + 3] = d;
    }
    for (; i < count; ++i)
        to[i] = from[i];
}

gic_real gic_time(const void *self)
{
    const gic_head *head = (const gic_head *)self;
    return head->start_time + (gic_real)head->steps * head->step;
}

void gic_restart(void *self, gic_real time)
{
    gic_head *head = (gic_head *)self;
    head->start_time = time;
    head->steps = 0;
    head->history = head->touched = 0;
}

static void set_inputs(const gic_model *model, void *self, gic_real time)
{
    gic_head *head = (gic_head *)self;
    if (head->input_function)
        head->input_function(head->user, head->lane, time, array_at(self, model->input_offset));
}

/* Evaluate the right-hand side with the inputs of its time. */
static int evaluate(const gic_model *model, void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    set_inputs(model, self, time);
    return model->rhs(self, time, state, rate);
}

/* AB3 for `count` numbers: one step from `from` to `next`, which may be the same, with the rates at its start and at
 * the two steps before. */
static void adams_bashforth(int32_t count, gic_real step, const gic_real *from, const gic_real *rate,
                            const gic_real *past, const gic_real *older, gic_real *next)
{
    const gic_real weight = step / GIC_R(12.0);
    int32_t i = 0;
    for (; i + 4 <= count; i += 4) { /* by four, as above */
        const gic_real *r = rate + i, *p = past + i, *o = older + i, *f = from + i;
        const gic_real a = GIC_ADAMS_BASHFORTH(f[0], weight, r[0], p[0], o[0]);
        const gic_real b = GIC_ADAMS_BASHFORTH(f[1], weight, r[1], p[1], o[1]);
        const gic_real c = GIC_ADAMS_BASHFORTH(f[2], weight, r[2], p[2], o[2]);
        const gic_real d = GIC_ADAMS_BASHFORTH(f[3], weight, r[3], p[3], o[3]);
        next[i] = a;
        next[i + 1] = b;
        next[i + 2] = c;
        next[i + 3] = d;
    }
    for (; i < count; ++i)
        next[i] = GIC_ADAMS_BASHFORTH(from[i], weight, rate[i], past[i], older[i]);
}

/* Record which number of a state is out of bounds; GIC_ERROR_RESULT if none is. */
static int out_of_bounds(void *self, const gic_real *state, int32_t first, int32_t behind)
{
    gic_head *head = (gic_head *)self;
    for (int32_t i = first; i < behind; ++i)
        if (!gic_bounded(&state[i - first], 1)) {
            head->grown = i;
            return GIC_ERROR_UNSTABLE;
        }
    return GIC_ERROR_RESULT;
}

/* RK4 for the whole state, with its rate at `from`; `work` has room for two states. */
static int runge_kutta(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from,
                       const gic_real *rate, gic_real *next, gic_real *work)
{
    const int32_t n = model->slow_count + model->fast_count;
    /* `next` sums the weighted slopes, so that the state is added only once */
    gic_real *stage = work, *slope = work + n;
    copy(next, rate, n);
    copy(slope, rate, n);
    for (int k = 1; k <= 3; ++k) {
        const gic_real reach = k < 3 ? GIC_R(0.5) * step : step;
        const gic_real weight = k < 3 ? GIC_R(2.0) : GIC_R(1.0);
        for (int32_t i = 0; i < n; ++i)
            stage[i] = from[i] + reach * slope[i];
        const int status = evaluate(model, self, time + reach, stage, slope);
        /* the stage left all bounds: record which number did; give_up() reports it unless a coordinate is to blame */
        if (status == GIC_ERROR_INPUT)
            (void)out_of_bounds(self, stage, 0, n);
        if (status != GIC_OK)
            return status;
        for (int32_t i = 0; i < n; ++i)
            next[i] += weight * slope[i];
    }
    for (int32_t i = 0; i < n; ++i)
        next[i] = from[i] + step / GIC_R(6.0) * next[i];
    return GIC_OK;
}

/* Turn an integrated vector into a valid state. The model's function checks bounds itself; without one they are checked
 * here. */
static int settle(const gic_model *model, void *self, gic_real *next)
{
    const int32_t n = model->slow_count + model->fast_count;
    ((gic_head *)self)->subset = -1; /* from here on the status is about the whole state */
    const int status = model->settle(self, next);
    return status == GIC_ERROR_INPUT && !gic_bounded(next, n) ? out_of_bounds(self, next, 0, n) : status;
}

static gic_real absolute(gic_real x)
{
    return x < GIC_R(0.0) ? -x : x;
}

int gic_blame(const gic_model *model, gic_real step, const gic_real *rate, int status, int32_t *grown)
{
    const int32_t half = (model->slow_count - model->free_base) / 2; /* distance from a coordinate to its rate */
    gic_real farthest = GIC_R(1.0);
    int32_t coordinates = 0;
    if (status != GIC_ERROR_INPUT && status != GIC_ERROR_ORIENTATION && status != GIC_ERROR_REACH &&
        status != GIC_ERROR_NEWTON && status != GIC_ERROR_SINGULAR && status != GIC_ERROR_MASS &&
        status != GIC_ERROR_RESULT)
        return status;
    for (int32_t c = 0; c < model->coordinate_count; ++c)
        coordinates += model->coordinate_state[c] >= 0;
    if (model->slow_count != 2 * coordinates + (model->free_base ? 13 : 0))
        return status; /* an engine of a host with another state */
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const int32_t at = model->coordinate_state[c];
        if (at < 0)
            continue;
        const gic_real part = GIC_R(0.25) * (model->coordinate_high[c] - model->coordinate_low[c]);
        const int wide = model->coordinate[c].unit[0] == 'r' && part > GIC_R(0.5); /* rad */
        const gic_real allowed = wide ? GIC_R(0.5) : part;
        const gic_real moved = step * (absolute(rate[at]) + step * absolute(rate[at + half])) / allowed;
        if (moved > farthest) {
            farthest = moved;
            *grown = at;
        }
    }
    /* Euler parameters move at half the angular velocity; the message names the latter */
    for (int32_t i = 0; model->free_base && i < 3; ++i) {
        const gic_real moved = GIC_R(2.0) * step * absolute(rate[4 + i]);
        if (moved > farthest) {
            farthest = moved;
            *grown = 10 + coordinates + i;
        }
    }
    return farthest > GIC_R(1.0) ? GIC_ERROR_UNSTABLE : status;
}

/* ---- implicit steps: models/STIFF.md ---------------------------------------------------------------------- */

enum { MOST_STAGES = 4 };

/* A Rosenbrock method whose order does not depend on the matrix A (a W-method). With h the step and A and B near the
 * derivatives of the rates f by states and inputs, which change by du within the step, its stages are
 *
 *     Y_i = y + sum_j place_ij u_j,   (1 - gamma h A) u_i = gamma h (f(t + at_i h, Y_i) + drift_i B du) + sum_j less_ij
 * u_j
 *
 * over j < i, and y + sum_i end_i u_i is the state after it. tests/unit/test_rosenbrock.c has the conditions of order.
 */
typedef struct Rosenbrock {
    int32_t stages;
    gic_real gamma, at[MOST_STAGES], drift[MOST_STAGES], end[MOST_STAGES];
    gic_real place[MOST_STAGES][MOST_STAGES], less[MOST_STAGES][MOST_STAGES];
} Rosenbrock;

/* ROS2 of Verwer, Spee, Blom and Hundsdorfer 1999 with gamma = 1 - 1 / sqrt(2). */
static const Rosenbrock ros2 = {
    2,
    GIC_R(0.29289321881345248),
    {GIC_R(0.0), GIC_R(1.0)},
    {GIC_R(0.29289321881345248), GIC_R(-0.29289321881345248)},
    {GIC_R(5.1213203435596426), GIC_R(1.7071067811865475)},
    {{GIC_R(0.0)}, {GIC_R(3.4142135623730950)}},
    {{GIC_R(0.0)}, {GIC_R(-2.0)}},
};

/* ROS34PW2 of Rang and Angermann 2005. */
static const Rosenbrock ros3 = {
    4,
    GIC_R(0.43586652150845900),
    {GIC_R(0.0), GIC_R(0.87173304301691801), GIC_R(0.73157995778885238), GIC_R(1.0)},
    {GIC_R(0.43586652150845900), GIC_R(-0.43586652150845900), GIC_R(-0.41333337623388649), GIC_R(0.0)},
    {GIC_R(4.1847604823191601), GIC_R(-0.28519201735549587), GIC_R(2.2942803602790414), GIC_R(1.0)},
    {{GIC_R(0.0)},
     {GIC_R(2.0)},
     {GIC_R(1.4192173174557647), GIC_R(-0.25923221167296971)},
     {GIC_R(4.1847604823191607), GIC_R(-0.28519201735549591), GIC_R(2.2942803602790417)}},
    {{GIC_R(0.0)},
     {GIC_R(-2.0)},
     {GIC_R(-1.8239969947745137), GIC_R(0.12430565256672007)},
     {GIC_R(-2.7756761163024681), GIC_R(-2.9619836625547887), GIC_R(1.2509798950560604)}},
};

/* Its numbers in an instance. */
typedef struct Implicit {
    const gic_implicit *how;
    gic_implicit_head *head;
    int32_t n, m; /* states, unknowns */
    int32_t *pivot;
    gic_real *jacobian;             /* [n][columns] */
    gic_real *mass;                 /* [mass_count] */
    gic_real *factor;               /* [m][m] */
    gic_real *increment;            /* [MOST_STAGES][n] u_i */
    gic_real *stage, *b, *drift;    /* [n] */
    gic_real *change;               /* [columns] of inputs */
    gic_real *other, *other_factor; /* Jacobian and factors that are being made in shares; NULL: the model has none */
} Implicit;

static Implicit implicit_of(const gic_model *model, void *self)
{
    const gic_implicit *how = model->implicit;
    Implicit w;
    w.how = how;
    w.head = (gic_implicit_head *)(void *)((char *)self + how->head_offset);
    w.n = model->slow_count + model->fast_count;
    w.m = how->unknown_count;
    w.pivot = (int32_t *)(void *)((char *)self + how->pivot_offset);
    w.jacobian = array_at(self, how->number_offset);
    w.mass = w.jacobian + w.n * how->columns;
    w.factor = w.mass + how->mass_count;
    w.increment = w.factor + w.n * w.n;
    w.stage = w.increment + MOST_STAGES * w.n;
    w.b = w.stage + w.n;
    w.drift = w.b + w.n;
    w.change = w.drift + w.n;
    w.other = w.other_factor = NULL;
    if (how->share_count > 0) {
        w.other = w.change + how->columns;
        w.other_factor = w.other + w.n * how->columns + how->mass_count;
    }
    if (how->share_count > 0 && w.head->second) {
        gic_real *const first = w.jacobian, *const first_factor = w.factor;
        w.jacobian = w.other;
        w.mass = w.jacobian + w.n * how->columns;
        w.factor = w.other_factor;
        w.other = first;
        w.other_factor = first_factor;
    }
    return w;
}

/* True for a method that this model can take. */
static int is_method(const gic_model *model, int32_t method)
{
    if (method == GIC_EXP3)
        return model->implicit && model->implicit->exponential_offset > 0;
    return method == GIC_AB3 || method == GIC_RK4 || (model->implicit && method >= GIC_ROS2 && method <= GIC_IMEX);
}

/* The unknown that is this state. */
static int32_t unknown_of(const Implicit *w, int32_t state)
{
    int32_t i = 0;
    while (w->how->unknown[i] != state)
        ++i;
    return i;
}

/* b = W b; stage[] is lost. The mass matrix is symmetric, so that its rows may be taken for columns: sums that follow
 * one another are of different numbers then, and do not wait for one another. */
static void implicit_weigh(const Implicit *w)
{
    const int32_t *const row = w->how->mass_row, *const column = w->how->mass_column;
    if (w->how->mass_count == 0)
        return;
    for (int32_t i = 0; i < w->n; ++i)
        w->stage[i] = GIC_R(0.0);
    for (int32_t k = 0; k < w->how->mass_count; ++k)
        w->stage[column[k]] += w->mass[k] * w->b[row[k]];
    for (int32_t k = 0; k < w->how->mass_count; ++k)
        if (row[k] == column[k])
            w->b[row[k]] = w->stage[row[k]];
}

/* The matrix W - reach A of the unknowns, in factor[]. The number x whose rate is the unknown v has the row
 * u_x = b_x + reach u_v, which is put into the others. */
static void implicit_matrix(const Implicit *w, gic_real reach)
{
    for (int32_t i = 0; i < w->m; ++i) {
        const gic_real *row = w->jacobian + w->how->columns * w->how->unknown[i];
        for (int32_t k = 0; k < w->m; ++k) {
            const int32_t position = w->how->position[k];
            const gic_real far = position < 0 ? GIC_R(0.0) : reach * row[position];
            w->factor[w->m * i + k] = (i == k ? GIC_R(1.0) : GIC_R(0.0)) - reach * (row[w->how->unknown[k]] + far);
        }
    }
    for (int32_t k = 0; k < w->how->mass_count; ++k) {
        const int32_t row = unknown_of(w, w->how->mass_row[k]), column = unknown_of(w, w->how->mass_column[k]);
        w->factor[w->m * row + column] += w->mass[k] - (row == column ? GIC_R(1.0) : GIC_R(0.0));
    }
}

/* Its triangular factors, rows exchanged by their largest numbers relative to their rows. Returns the index in state[]
 * of an unknown that the rows do not determine; -1: there is none. */
static int32_t implicit_factorize(const Implicit *w)
{
    const gic_real least = sizeof(gic_real) < sizeof(double) ? GIC_R(1e-6) : GIC_R(1e-13);
    const int32_t m = w->m;
    gic_real *const f = w->factor, *const size = w->stage;
    for (int32_t i = 0; i < m; ++i) {
        size[i] = GIC_R(0.0);
        for (int32_t k = 0; k < m; ++k)
            size[i] = absolute(f[m * i + k]) > size[i] ? absolute(f[m * i + k]) : size[i];
    }
    for (int32_t k = 0; k < m; ++k) {
        int32_t best = k;
        for (int32_t i = k + 1; i < m; ++i)
            if (absolute(f[m * i + k]) * size[best] > absolute(f[m * best + k]) * size[i])
                best = i;
        if (!(absolute(f[m * best + k]) > least * size[best]))
            return w->how->unknown[k];
        w->pivot[k] = best;
        for (int32_t j = 0; j < m && best != k; ++j) {
            const gic_real upper = f[m * k + j];
            f[m * k + j] = f[m * best + j];
            f[m * best + j] = upper;
        }
        size[best] = size[k];
        f[m * k + k] = GIC_R(1.0) / f[m * k + k];
        for (int32_t i = k + 1; i < m; ++i) {
            const gic_real multiplier = f[m * i + k] *= f[m * k + k];
            for (int32_t j = k + 1; j < m && (multiplier > GIC_R(0.0) || multiplier < GIC_R(0.0)); ++j)
                f[m * i + j] -= multiplier * f[m * k + j];
        }
    }
    return -1;
}

/* (W - reach A) u = b; b and stage[] are lost. */
static void implicit_solve(const Implicit *w, gic_real reach, gic_real *u)
{
    const int32_t m = w->m;
    const gic_real *const f = w->factor, *const b = w->b;
    if (!w->head->exchanged) {
        w->how->solve(w->jacobian, reach, f, b, u);
        return;
    }
    gic_real *const x = w->stage;
    copy(u, b, w->n); /* states that are explicit go on so */
    for (int32_t i = 0; i < m; ++i) {
        const gic_real *row = w->jacobian + w->how->columns * w->how->unknown[i];
        x[i] = b[w->how->unknown[i]];
        for (int32_t k = 0; k < m; ++k)
            if (w->how->position[k] >= 0)
                x[i] += reach * row[w->how->position[k]] * b[w->how->position[k]];
    }
    for (int32_t k = 0; k < m; ++k) {
        const gic_real upper = x[w->pivot[k]];
        x[w->pivot[k]] = x[k];
        x[k] = upper;
    }
    for (int32_t i = 1; i < m; ++i)
        for (int32_t j = 0; j < i; ++j)
            x[i] -= f[m * i + j] * x[j];
    for (int32_t i = m - 1; i >= 0; --i) {
        for (int32_t j = i + 1; j < m; ++j)
            x[i] -= f[m * i + j] * x[j];
        x[i] *= f[m * i + i];
        u[w->how->unknown[i]] = x[i];
        if (w->how->position[i] >= 0)
            u[w->how->position[i]] = b[w->how->position[i]] + reach * x[i];
    }
}

/* Factors where the order that is known beforehand does not do: GIC_OK or GIC_ERROR_PIVOT. */
static int implicit_exchange(const Implicit *w, void *self, gic_real reach)
{
    implicit_matrix(w, reach);
    const int32_t lost = implicit_factorize(w);
    if (lost >= 0)
        ((gic_head *)self)->grown = lost;
    return lost >= 0 ? GIC_ERROR_PIVOT : GIC_OK;
}

/* True while each step makes a share of the next Jacobian. */
static int is_spread(const Implicit *w)
{
    return w->other && w->head->spread > 0 && w->head->keep > 1;
}

/* Rounds of this many steps have one to spare. */
enum { SPARE_FROM = 8 };

/* The share of this step, one of those that the present Jacobian still serves, of what is left to do. A step with an
 * evaluation that checks itself, which takes long already, makes none where one of the round is to spare. */
static int implicit_share(const Implicit *w, void *self, gic_real time, const gic_real *from, gic_real reach,
                          int checks)
{
    const gic_implicit *how = w->how;
    const int32_t spare = w->head->keep < SPARE_FROM ? 0 : 1;
    const int32_t first = w->head->shared, left = w->head->keep - w->head->used + 1 - spare;
    const int32_t before = first > 0 ? how->share_work[first - 1] : 0;
    const int32_t work = how->share_work[how->share_count - 1] - before;
    int32_t end = first;
    for (int32_t done = before; end < how->share_count; ++end) { /* to the nearest piece */
        const int32_t then = how->share_work[end];
        if (left > 1 && (done - before) + (then - done) / 2 > work / left)
            break;
        done = then;
    }
    if (first == end || w->head->lost || (checks && spare && left > 0))
        return GIC_OK;
    w->head->shared = end;
    const int status = how->share(self, time, from, first, end, reach, w->other, w->other_factor);
    w->head->lost = status == GIC_SHARE_LOST;
    return w->head->lost ? GIC_OK : status;
}

/* The Jacobian that steps have made takes the place of the present one. */
static int implicit_change(Implicit *w, const gic_model *model, void *self, gic_real reach)
{
    w->head->second = !w->head->second;
    w->head->exchanged = w->head->lost;
    w->head->shared = w->head->lost = 0;
    w->head->used = 1;
    ++w->head->jacobian_count;
    *w = implicit_of(model, self);
    return w->head->exchanged ? implicit_exchange(w, self, reach) : GIC_OK;
}

/* The whole Jacobian at once, with its factors. */
static int implicit_begin(const Implicit *w, void *self, gic_real time, const gic_real *from, gic_real reach)
{
    w->head->used = w->head->shared = w->head->lost = 0;
    ++w->head->jacobian_count;
    int status = w->how->jacobian(self, time, from, w->jacobian);
    if (status != GIC_OK)
        return status;
    w->head->exchanged = !w->how->factorize || !w->how->factorize(w->jacobian, reach, w->factor);
    if (w->head->exchanged)
        status = implicit_exchange(w, self, reach);
    if (status != GIC_OK)
        return status;
    for (int32_t i = 0; is_spread(w) && i < w->n * w->how->columns; ++i) /* pieces set what is not 0 */
        w->other[i] = GIC_R(0.0);
    w->head->reach = reach;
    w->head->used = 1;
    return GIC_OK;
}

/* Jacobian and factors for a step from this state, those that are kept or new ones. checks: does an evaluation of this
 * step check itself? */
static int implicit_prepare(Implicit *w, const gic_model *model, void *self, gic_real time, int32_t method,
                            const gic_real *from, gic_real reach, int checks)
{
    const gic_head *head = (const gic_head *)self;
    const int on = w->head->used > 0 && w->head->reach == reach && head->method == method && head->steps > 0;
    int status = GIC_OK;
    if (on && w->head->used < w->head->keep)
        ++w->head->used;
    else if (on && is_spread(w) && (w->head->lost || w->head->shared == w->how->share_count))
        status = implicit_change(w, model, self, reach);
    else
        return implicit_begin(w, self, time, from, reach);
    return status == GIC_OK && is_spread(w) ? implicit_share(w, self, time, from, reach, checks) : status;
}

/* What the inputs change within a step, in drift[]: B du, or W B du. Inputs are those of `time` afterwards. */
static void implicit_drift(const gic_model *model, void *self, const Implicit *w, gic_real time, gic_real step)
{
    const gic_head *head = (const gic_head *)self;
    const gic_real *input = array_at(self, model->input_offset);
    for (int32_t i = 0; i < w->n; ++i)
        w->drift[i] = GIC_R(0.0);
    if (!head->input_function)
        return;
    set_inputs(model, self, time + step);
    copy(w->change, input, model->input_count);
    set_inputs(model, self, time);
    for (int32_t i = 0; i < w->n; ++i)
        for (int32_t k = 0; k < model->input_count; ++k)
            w->drift[i] += w->jacobian[w->how->columns * i + w->n + k] * (w->change[k] - input[k]);
}

/* Evaluate the rates at a stage of an implicit or exponential step. Where it is beyond all bounds, record which
 * number is. */
static int stage_rates(const gic_model *model, void *self, gic_real time, const gic_real *stage, gic_real *rate)
{
    const int status = evaluate(model, self, time, stage, rate);
    if (status == GIC_ERROR_INPUT)
        (void)out_of_bounds(self, stage, 0, model->slow_count + model->fast_count);
    return status;
}

/* ROS3 (also for steps of EXP3 of another length), or ROS2 (also for steps of IMEX without history), for the whole
 * state, with its rate at `from`; checked: that was checked. */
static int rosenbrock(const gic_model *model, void *self, gic_real time, gic_real step, int32_t method,
                      const gic_real *from, const gic_real *rate, int checked, gic_real *next)
{
    const Rosenbrock *r = method == GIC_ROS3 || method == GIC_EXP3 ? &ros3 : &ros2;
    Implicit w = implicit_of(model, self);
    const gic_real reach = r->gamma * step;
    const int checks = checked || ((const gic_head *)self)->unchecked < r->stages - 1;
    int status = implicit_prepare(&w, model, self, time, method, from, reach, checks);
    if (status != GIC_OK)
        return status;
    implicit_drift(model, self, &w, time, step);
    copy(w.b, rate, w.n);
    for (int32_t k = 0; k < r->stages; ++k) {
        if (k > 0) {
            for (int32_t i = 0; i < w.n; ++i) {
                w.stage[i] = from[i];
                for (int32_t j = 0; j < k; ++j)
                    w.stage[i] += r->place[k][j] * w.increment[w.n * j + i];
            }
            status = stage_rates(model, self, time + r->at[k] * step, w.stage, w.b);
            if (status != GIC_OK)
                return status;
        }
        for (int32_t i = 0; i < w.n; ++i) {
            w.b[i] *= reach;
            for (int32_t j = 0; j < k; ++j)
                w.b[i] += r->less[k][j] * w.increment[w.n * j + i];
        }
        implicit_weigh(&w);
        for (int32_t i = 0; i < w.n; ++i)
            w.b[i] += reach * r->drift[k] * w.drift[i];
        implicit_solve(&w, reach, w.increment + w.n * k);
    }
    for (int32_t i = 0; i < w.n; ++i) {
        next[i] = from[i];
        for (int32_t k = 0; k < r->stages; ++k)
            next[i] += r->end[k] * w.increment[w.n * k + i];
    }
    return GIC_OK;
}

/* What the state changed by in the step before, of IMEX with history: a row that ROS2, which begins, leaves alone. */
static gic_real *last_change(const Implicit *w)
{
    return w->increment + 2 * w->n;
}

/* IMEX with history: the second-order backward differentiation formula, implicit in A y alone. What the rate f has
 * beside it goes on in a straight line from the last two steps. With the straight line through the last two states, y0
 * and y1, it is the solution d of
 *
 *     (1 - 2/3 h A) d = -2/3 (y0 - y1) + 2/3 h (2 f0 - f1)
 *
 * by which the next state differs from 2 y0 - y1: no product with A is needed, and A may change from step to step.
 * past: f1; checked: f0 was checked. */
static int imex(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from,
                const gic_real *rate, const gic_real *past, int checked, gic_real *next)
{
    Implicit w = implicit_of(model, self);
    const gic_real part = GIC_R(0.66666666666666663), reach = part * step, *const last = last_change(&w);
    const int status = implicit_prepare(&w, model, self, time, GIC_IMEX, from, reach, checked);
    if (status != GIC_OK)
        return status;
    for (int32_t i = 0; i < w.n; ++i)
        w.b[i] = reach * (rate[i] + (rate[i] - past[i])) - part * last[i];
    implicit_weigh(&w);
    implicit_solve(&w, reach, w.increment);
    for (int32_t i = 0; i < w.n; ++i)
        next[i] = from[i] + (last[i] + w.increment[i]);
    return GIC_OK;
}

/* ---- exponential steps: models/STIFF.md --------------------------------------------------------------------- */

/* With a matrix A near the derivatives of the rates f by states, the motion of y' = A y is exp(t A) y, and of
 * y' = A y + g with g = c_0 + c_1 t + ... + c_k t^k / k! over a step h it ends at
 *
 *     y + h phi_1(h A) (A y + c_0) + h^2 phi_2(h A) c_1 + ... ,   phi_0(z) = exp z, phi_k(z) = z phi_k+1(z) + 1 / k!
 *
 * EXP3 takes for g(t) = f(t, y(t)) - A y(t), what A does not tell of the rates, the parabola through the start of the
 * step before, its own start and `node` of it; the order is 3 for any A, since the parabola's integral over a step is
 * exact for cubics but for 1/36 of them, and the state at the node, by a straight line, is right to h^3. A step without
 * history has the straight line through its start and the node in place of the parabola, which for this node is exact
 * for parabolas, too. Functions at the node are floats: what A tells of the rates is right for any state there, so that
 * their roundings only meet what it lacks. A itself is not needed: z phi_k+1(z) = phi_k(z) - 1 / k!. (Exponential Adams
 * methods: Norsett 1969; Hochbruck and Ostermann, Acta Numerica 2010.) */
static const gic_real node = GIC_R(0.66666666666666663);

enum { FUNCTIONS = 4, SERIES = 13, HALVINGS = 60, SWEEPS = 20 };

/* Numbers of functions at the node, in the place of matrices of gic_real. */
#ifdef __GNUC__
typedef float gic_brief __attribute__((may_alias));
#else
typedef float gic_brief;
#endif

/* Its numbers in an instance. Matrices have panels of GIC_PANEL rows, each column by column. */
typedef struct Exponential {
    int32_t n, size;       /* states; numbers of a matrix */
    gic_brief *at_node[2]; /* phi_1, phi_2 of node h A */
    gic_real *at_end[3];   /* phi_1, phi_2, phi_3 of h A */
    gic_real *work[3];
    gic_real *change; /* what the state changed by in the step before */
} Exponential;

static Exponential exponential_of(const gic_model *model, void *self)
{
    Exponential e;
    gic_real *at = array_at(self, model->implicit->exponential_offset);
    e.n = model->slow_count + model->fast_count;
    e.size = (e.n + GIC_PANEL - 1) / GIC_PANEL * GIC_PANEL * e.n;
    for (int32_t i = 0; i < 2; ++i, at += e.size)
        e.at_node[i] = (gic_brief *)(void *)at;
    for (int32_t i = 0; i < 3; ++i, at += e.size)
        e.at_end[i] = at;
    for (int32_t i = 0; i < 3; ++i, at += e.size)
        e.work[i] = at;
    e.change = at;
    return e;
}

/* Where row i of a column stands behind the column's first number. */
static int32_t panel_row(int32_t n, int32_t i)
{
    return i / GIC_PANEL * GIC_PANEL * n + i % GIC_PANEL;
}

/* Rows that are added up at once: those of one vector of the processor, since compilers keep the sums of a loop over
 * all rows of a panel in memory. Single numbers where there are no vectors, in C++, where sums have more digits than
 * numbers (x87), and for Frama-C, which reads no vectors. */
#if defined __GNUC__ && !defined __TINYC__ && !defined __cplusplus && !defined __FRAMAC__ && \
    (FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 16)
#if defined __AVX512F__
#define GIC_VECTOR 64
#elif defined __AVX__
#define GIC_VECTOR 32
#else
#define GIC_VECTOR 16
#endif
#define ROWS_OF(number) \
    __attribute__((vector_size(GIC_VECTOR < GIC_PANEL * sizeof(number) ? GIC_VECTOR : GIC_PANEL * sizeof(number)), \
                   aligned(sizeof(number)), may_alias))
#else
#define ROWS_OF(number)
#endif
typedef gic_real gic_rows ROWS_OF(gic_real);
typedef float gic_brief_rows ROWS_OF(float);

/* Fetch what is needed soon: right-hand sides drive matrices from the first caches. */
#ifdef __GNUC__
#define SOON(place) __builtin_prefetch(place)
#else
#define SOON(place) (void)0
#endif

/* Of matrices of one kind of number: KIND_times(), sum[GIC_PANEL] = the rows of a panel, times x[n], and KIND_add(),
 * y += matrix x. Every fourth column is added up by itself, since sums wait for one another; the bits don't depend on
 * the length of vectors. */
#define PANELS(kind, number, rows) \
    static void kind##_times(int32_t n, const number *panel, const number *x, number *sum) \
    { \
        for (uint32_t row = 0; row < GIC_PANEL; row += sizeof(rows) / sizeof(number)) { \
            const number *at = panel + row; \
            rows part = {0}, second = part, third = part, fourth = part; \
            int32_t k = 0; \
            for (; k + 3 < n; k += 4, at += 4 * GIC_PANEL) { \
                for (uint32_t i = 0; i < 4 * GIC_PANEL && row == 0; i += 64 / sizeof(number)) \
                    SOON(at + GIC_AHEAD + i); \
                part += *(const rows *)(const void *)at * x[k]; \
                second += *(const rows *)(const void *)(at + GIC_PANEL) * x[k + 1]; \
                third += *(const rows *)(const void *)(at + 2 * GIC_PANEL) * x[k + 2]; \
                fourth += *(const rows *)(const void *)(at + 3 * GIC_PANEL) * x[k + 3]; \
            } \
            for (; k < n; ++k, at += GIC_PANEL) \
                part += *(const rows *)(const void *)at * x[k]; \
            *(rows *)(void *)(sum + row) = (part + third) + (second + fourth); \
        } \
    } \
    static void kind##_add(int32_t n, const number *matrix, const number *x, gic_real *y) \
    { \
        number sum[GIC_PANEL]; \
        for (int32_t first = 0; first < n; first += GIC_PANEL) { \
            kind##_times(n, matrix + first * n, x, sum); \
            for (int32_t l = 0; l < GIC_PANEL && first + l < n; ++l) \
                y[first + l] += (gic_real)sum[l]; \
        } \
    }
PANELS(panels, gic_real, gic_rows)
PANELS(brief, gic_brief, gic_brief_rows)

/* to = a b; column: work space for n numbers */
static void panels_product(int32_t n, const gic_real *a, const gic_real *b, gic_real *column, gic_real *to)
{
    for (int32_t j = 0; j < n; ++j) {
        for (int32_t k = 0; k < n; ++k)
            column[k] = b[GIC_PANEL * j + panel_row(n, k)];
        for (int32_t first = 0; first < n; first += GIC_PANEL)
            panels_times(n, a + first * n, column, to + first * n + GIC_PANEL * j);
    }
}

/* matrix += number times the unit matrix */
static void panels_unit(int32_t n, gic_real number, gic_real *matrix)
{
    for (int32_t i = 0; i < n; ++i)
        matrix[GIC_PANEL * i + panel_row(n, i)] += number;
}

/* The matrix A: rows of velocities are accelerations, for which W is solved; rows of positions are velocities. */
static int exponential_slopes(const Implicit *w, void *self, const Exponential *e, gic_real *a)
{
    const gic_implicit *how = w->how;
    const int32_t n = w->n;
    for (int32_t i = 0; i < e->size; ++i)
        a[i] = GIC_R(0.0);
    for (int32_t k = 0; k < w->m; ++k) {
        const int32_t i = how->unknown[k], position = how->position[k];
        for (int32_t j = 0; j < n; ++j)
            a[GIC_PANEL * j + panel_row(n, i)] = w->jacobian[how->columns * i + j];
        if (position >= 0)
            a[GIC_PANEL * i + panel_row(n, position)] = GIC_R(1.0);
    }
    if (how->mass_count == 0)
        return GIC_OK;
    const int status = implicit_exchange(w, self, GIC_R(0.0)); /* factors of W */
    w->head->exchanged = 1;                                    /* implicit_solve() takes these factors */
    for (int32_t j = 0; j < n && status == GIC_OK; ++j) {
        gic_real *const column = a + GIC_PANEL * j;
        for (int32_t i = 0; i < n; ++i)
            w->b[i] = column[panel_row(n, i)];
        implicit_solve(w, GIC_R(0.0), w->increment);
        for (int32_t k = 0; k < w->m; ++k)
            column[panel_row(n, how->unknown[k])] = w->increment[how->unknown[k]];
    }
    return status;
}

/* Scale coordinates by powers of 2, unit[], so that rows and columns of A are about as large: a' = a unit_j / unit_i
 * (Parlett and Reinsch 1969). Returns the largest sum of a row. */
static gic_real exponential_balance(const Exponential *e, gic_real *a, gic_real *unit)
{
    const int32_t n = e->n;
    int32_t changed = 1;
    for (int32_t i = 0; i < n; ++i)
        unit[i] = GIC_R(1.0);
    for (int32_t sweep = 0; sweep < SWEEPS && changed; ++sweep) {
        changed = 0;
        for (int32_t i = 0; i < n; ++i) {
            gic_real column = GIC_R(0.0), row = GIC_R(0.0), by = GIC_R(1.0);
            for (int32_t j = 0; j < n; ++j)
                if (j != i) {
                    column += absolute(a[GIC_PANEL * i + panel_row(n, j)]);
                    row += absolute(a[GIC_PANEL * j + panel_row(n, i)]);
                }
            if (!(column > GIC_R(0.0)) || !(row > GIC_R(0.0)))
                continue;
            const gic_real before = column + row;
            for (int32_t k = 0; k < HALVINGS && column < GIC_R(0.5) * row; ++k, column *= GIC_R(4.0))
                by *= GIC_R(2.0);
            for (int32_t k = 0; k < HALVINGS && column >= GIC_R(2.0) * row; ++k, column *= GIC_R(0.25))
                by *= GIC_R(0.5);
            if (!((column + row) / by < GIC_R(0.95) * before))
                continue;
            changed = 1;
            unit[i] *= by;
            for (int32_t j = 0; j < n; ++j) {
                a[GIC_PANEL * i + panel_row(n, j)] *= by;
                a[GIC_PANEL * j + panel_row(n, i)] *= GIC_R(1.0) / by; /* a power of 2 */
            }
        }
    }
    gic_real largest = GIC_R(0.0);
    for (int32_t i = 0; i < n; ++i) {
        gic_real row = GIC_R(0.0);
        for (int32_t j = 0; j < n; ++j)
            row += absolute(a[GIC_PANEL * j + panel_row(n, i)]);
        largest = row > largest ? row : largest;
    }
    return largest;
}

/* phi[0] to phi[top] of reach A, |reach A| at most `norm`: by a series of what is left when it is halved often enough,
 * and doubled again. phi_k(2 z) = 2^-k (phi_0(z) phi_k(z) + sum_j phi_j(z) / (k - j)!), j from 1 to k. z, spare:
 * matrices of work space; column: n numbers. 0: it would have to be halved too often. */
static int exponential_functions(const Exponential *e, const gic_real *a, gic_real reach, gic_real norm, int32_t top,
                                 gic_real *const *phi, gic_real *z, gic_real *spare, gic_real *column)
{
    const gic_real share[FUNCTIONS] = {GIC_R(1.0), GIC_R(1.0), GIC_R(0.5), GIC_R(0.16666666666666667)}; /* 1 / k! */
    int32_t halvings = 0;
    for (; norm > GIC_R(0.5) && halvings <= HALVINGS; ++halvings) {
        norm *= GIC_R(0.5);
        reach *= GIC_R(0.5);
    }
    if (halvings > HALVINGS)
        return 0;
    gic_real term = share[top];
    for (int32_t i = 1; i <= SERIES; ++i)
        term *= GIC_R(1.0) / (gic_real)(top + i);
    for (int32_t i = 0; i < e->size; ++i) {
        z[i] = reach * a[i];
        phi[top][i] = GIC_R(0.0);
    }
    panels_unit(e->n, term, phi[top]);
    for (int32_t i = SERIES; i > 0; --i) {
        panels_product(e->n, z, phi[top], column, spare);
        term *= (gic_real)(top + i);
        panels_unit(e->n, term, spare);
        copy(phi[top], spare, e->size);
    }
    for (int32_t k = top - 1; k >= 0; --k) {
        panels_product(e->n, z, phi[k + 1], column, phi[k]);
        panels_unit(e->n, share[k], phi[k]);
    }
    for (; halvings > 0; --halvings)
        for (int32_t k = top; k >= 0; --k) {
            gic_real less = GIC_R(1.0);
            panels_product(e->n, phi[0], phi[k], column, spare);
            for (int32_t j = 1; j <= k; ++j, less *= GIC_R(0.5))
                for (int32_t i = 0; i < e->size; ++i)
                    spare[i] += share[k - j] * phi[j][i];
            for (int32_t i = 0; i < e->size; ++i)
                phi[k][i] = less * spare[i];
        }
    return 1;
}

/* Keep a function at the node as floats. What is below 1e-30 is nothing beside the state, and slow as a float. Returns
 * a number of it that is not below 1e30, as the index of its row in state[]; -1: there is none. */
static int32_t brief_keep(const Exponential *e, const gic_real *matrix, gic_brief *brief)
{
    int32_t lost = -1;
    for (int32_t i = 0; i < e->size; ++i) {
        const gic_real number = matrix[i], size = absolute(number);
        const int fits = size < GIC_R(1e30);
        brief[i] = (gic_brief)(fits && size > GIC_R(1e-30) ? number : GIC_R(0.0));
        if (!fits)
            lost = i / (GIC_PANEL * e->n) * GIC_PANEL + i % GIC_PANEL;
    }
    return lost;
}

/* A number of a matrix that is not finite, by the index of its row in the same way. */
static int32_t panels_lost(int32_t n, const gic_real *matrix)
{
    for (int32_t i = 0; i < n; ++i)
        for (int32_t j = 0; j < n; ++j)
            if (!gic_finite(matrix + GIC_PANEL * j + panel_row(n, i), 1))
                return i;
    return -1;
}

/* The functions of A, of this state, for steps of this length. */
static int exponential_begin(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from)
{
    const Implicit w = implicit_of(model, self);
    const Exponential e = exponential_of(model, self);
    gic_real *const a = e.work[2], *const unit = w.drift, *const column = w.change;
    w.head->span = GIC_R(0.0);
    w.head->used = w.head->shared = w.head->lost = 0; /* the Jacobian takes the place of one that is kept */
    ++w.head->jacobian_count;
    int status = w.how->jacobian(self, time, from, w.jacobian);
    if (status == GIC_OK)
        status = exponential_slopes(&w, self, &e, a);
    if (status != GIC_OK)
        return status;
    const gic_real norm = exponential_balance(&e, a, unit), short_step = node * step;
    gic_real *const kept[] = {(gic_real *)(void *)e.at_node[0], (gic_real *)(void *)e.at_node[1], e.at_end[0],
                              e.at_end[1], e.at_end[2]};
    gic_real *const to_node[] = {e.work[0], kept[0], kept[1]};
    gic_real *const to_end[] = {e.work[0], kept[2], kept[3], kept[4]};
    int32_t lost = -1;
    int made =
        exponential_functions(&e, a, short_step, short_step * norm, 2, to_node, e.at_end[0], e.work[1], column) &&
        exponential_functions(&e, a, step, step * norm, 3, to_end, a, e.work[1], column);
    for (int32_t k = 0; k < 5 && made; ++k) {
        gic_real *const matrix = kept[k];
        for (int32_t j = 0; j < e.n; ++j)
            for (int32_t i = 0; i < e.n; ++i)
                matrix[GIC_PANEL * j + panel_row(e.n, i)] *= unit[i] / unit[j];
        lost = k < 2 ? brief_keep(&e, matrix, e.at_node[k]) : panels_lost(e.n, matrix);
        made = lost < 0;
    }
    if (!made) {
        ((gic_head *)self)->grown = lost;
        return GIC_ERROR_PIVOT;
    }
    w.head->span = step;
    w.head->spent = 0;
    return GIC_OK;
}

/* EXP3 with the exponentials that there are. past: the rate at the start of the step before; NULL: no history. */
static int exp3(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from,
                const gic_real *rate, const gic_real *past, gic_real *next)
{
    const Implicit w = implicit_of(model, self);
    const Exponential e = exponential_of(model, self);
    const gic_real part = node * step;
    gic_real *const x = w.increment, *const y = x + e.n, *const z = y + e.n, *const stage = w.stage, *const there = w.b;
    gic_brief *const near_x = (gic_brief *)(void *)x, *const near_y = near_x + e.n;
    for (int32_t i = 0; i < e.n; ++i) {
        const gic_real moved = past ? node * e.change[i] : GIC_R(0.0);
        stage[i] = from[i] + moved;
        near_x[i] = (gic_brief)(part * rate[i] - moved);
        near_y[i] = (gic_brief)(past ? node * part * (rate[i] - past[i]) : GIC_R(0.0));
    }
    brief_add(e.n, e.at_node[0], near_x, stage);
    if (past)
        brief_add(e.n, e.at_node[1], near_y, stage);
    int status = stage_rates(model, self, time + part, stage, there);
    if (!past && status == GIC_OK) { /* once more, now with a straight line */
        for (int32_t i = 0; i < e.n; ++i) {
            const gic_real back = from[i] - stage[i];
            near_x[i] = (gic_brief)back;
            near_y[i] = (gic_brief)(part * (there[i] - rate[i]));
            stage[i] -= back;
        }
        brief_add(e.n, e.at_node[0], near_x, stage);
        brief_add(e.n, e.at_node[1], near_y, stage);
        status = stage_rates(model, self, time + part, stage, there);
    }
    if (status != GIC_OK)
        return status;
    const gic_real line = GIC_R(1.0) / node, curve = line / (node + GIC_R(1.0));
    for (int32_t i = 0; i < e.n; ++i) {
        const gic_real moved = stage[i] - from[i], grown = there[i] - rate[i];
        gic_real slope, rise, bend = GIC_R(0.0), turn = GIC_R(0.0);
        if (past) { /* parabolas through what is before, 0, and at the node: bend t^2 + slope t, and of rates */
            bend = curve * (moved - node * e.change[i]);
            turn = curve * (grown + node * (past[i] - rate[i]));
            slope = bend + e.change[i];
            rise = turn - (past[i] - rate[i]);
        } else {
            slope = line * moved;
            rise = line * grown;
        }
        next[i] = from[i] + slope + bend;
        x[i] = step * rate[i] - slope;
        y[i] = step * rise - GIC_R(2.0) * bend;
        z[i] = GIC_R(2.0) * step * turn;
    }
    panels_add(e.n, e.at_end[0], x, next);
    panels_add(e.n, e.at_end[1], y, next);
    if (past)
        panels_add(e.n, e.at_end[2], z, next);
    return GIC_OK;
}

/* A step of EXP3. Exponentials for its length are made if there are none, if those there are have served long enough,
 * or if the last step had this length too. A single step of another length is made by ROS3, which costs less. */
static int exponential(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from,
                       const gic_real *rate, const gic_real *past, int checked, gic_real *next)
{
    const gic_implicit_head *const implicit = implicit_of(model, self).head;
    const gic_head *head = (const gic_head *)self;
    const int again = step == head->step && head->method == GIC_EXP3, none = !(implicit->span > GIC_R(0.0));
    const int fits = implicit->span == step, old = implicit->keep > 1 && implicit->spent >= implicit->keep;
    if (!fits && !none && !again)
        return rosenbrock(model, self, time, step, GIC_EXP3, from, rate, checked, next);
    const int status = fits && !old ? GIC_OK : exponential_begin(model, self, time, step, from);
    return status == GIC_OK ? exp3(model, self, time, step, from, rate, past, next) : status;
}

/* ---- a step ------------------------------------------------------------------------------------------------ */

/* One step from `from` to `next`; the rate at the start goes to `rate`, and *newest points to it as soon as it is
 * known. `past` points to the two rates before the step, of IMEX and EXP3 to one; NULL: RK4, or an implicit `method`
 * without history. */
static int advance(const gic_model *model, void *self, gic_real time, gic_real step, int32_t method,
                   const gic_real *from, const gic_real *const *past, gic_real *rate, gic_real *next, gic_real *work,
                   const gic_real **newest)
{
    const int32_t n = model->slow_count + model->fast_count, unchecked = ((const gic_head *)self)->unchecked;
    int status = evaluate(model, self, time, from, rate);
    if (status != GIC_OK)
        return status;
    *newest = rate;
    const int checked = ((const gic_head *)self)->unchecked > unchecked;
    if (past && method == GIC_IMEX)
        status = imex(model, self, time, step, from, rate, past[0], checked, next);
    else if (method == GIC_EXP3)
        status = exponential(model, self, time, step, from, rate, past ? past[0] : NULL, checked, next);
    else if (past)
        adams_bashforth(n, step, from, rate, past[0], past[1], next);
    else if (method > GIC_RK4)
        status = rosenbrock(model, self, time, step, method, from, rate, checked, next);
    else
        status = runge_kutta(model, self, time, step, from, rate, next, work);
    return status == GIC_OK ? settle(model, self, next) : status;
}

/* Check that a step of this length may be tried; `part` is the smallest amount by which time must advance. */
static int check_step(const gic_model *model, void *self, gic_real step, gic_real part)
{
    if (model->abi_version != GIC_ABI_VERSION || model->real_size != sizeof(gic_real))
        return GIC_ERROR_ABI;
    gic_head *head = (gic_head *)self;
    const gic_real time = gic_time(self);
    head->subset = head->grown = -1;
    head->event = 0;
    head->begun_count = head->rhs_count + head->look_count;
    if (!gic_finite(&step, 1) || !gic_finite(&time, 1) || time + part <= time)
        return head->status = GIC_ERROR_ARGUMENT;
    head->ahead = step;
    return GIC_OK;
}

/* True if head.locate is known, and head.most allows steps without events. */
static int takes_options(const gic_head *head, int32_t ratio)
{
    return head->locate >= 0 && head->locate <= 2 && (head->most == 0 || head->most >= GIC_LEAST_MOST(ratio));
}

/* True if the step continues the one before it, so that its history is valid. */
static int goes_on(const gic_head *head, gic_real step, int32_t method, int32_t ratio)
{
    return step == head->step && method == head->method && ratio == head->ratio;
}

/* End a step that failed with `status`: the instance, its Newton start included, becomes as before. newest: the latest
 * known rate. */
static int give_up(const gic_model *model, void *self, gic_real step, int status, const gic_real *newest,
                   const gic_real *input_before)
{
    gic_head *head = (gic_head *)self;
    const gic_real *state = array_at(self, model->state_offset);
    const int32_t n = model->slow_count + model->fast_count, half = (model->slow_count - model->free_base) / 2;
    gic_real *rate = array_at(self, model->scratch_offset);
    if (newest != rate)
        copy(rate, newest, n);
    if (model->implicit)
        implicit_of(model, self).head->used = 0;
    /* coordinates are reset too: they follow from the state */
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const int32_t at = model->coordinate_state[c];
        if (at >= 0 && at + half < n && absolute(state[at + half]) > absolute(rate[at]))
            rate[at] = state[at + half];
    }
    head->flip = head->hold;
    head->hold = -1;
    copy(array_at(self, model->input_offset), input_before, model->input_count);
    /* a state that was invalid before was not made by a step */
    if (gic_bounded(state, n))
        status = gic_blame(model, step, rate, status, &head->grown);
    return head->status = status == GIC_ERROR_INPUT && head->grown >= 0 ? GIC_ERROR_UNSTABLE : status;
}

/* Between the ends of a step: the cubic through states and rates. */
static void between(int32_t n, gic_real share, gic_real step, const gic_real *from, const gic_real *rate,
                    const gic_real *to, const gic_real *rate_there, gic_real *state)
{
    const gic_real rest = GIC_R(1.0) - share, blend = share * share * (GIC_R(3.0) - GIC_R(2.0) * share);
    for (int32_t i = 0; i < n; ++i)
        state[i] = from[i] + blend * (to[i] - from[i]) + step * share * rest * (rest * rate[i] - share * rate_there[i]);
}

enum { MOST_DISCRETE = 8 };

static int32_t *discrete_of(const gic_model *model, void *self)
{
    return (int32_t *)(void *)((char *)self + model->discrete_offset);
}

static void copy_discrete(const gic_model *model, int32_t *to, const int32_t *from)
{
    for (int32_t i = 0; i < model->discrete_count; ++i)
        to[i] = from[i];
}

/* What is left of a step: states and rates where it begins and where it ends. */
typedef struct Rest {
    gic_real end, length; /* s */
    const gic_real *from, *rate, *to, *rate_there;
    int64_t behind; /* evaluations that the step needs after `end` */
    int32_t discrete[MOST_DISCRETE];
} Rest;

/* Looks at one contact or gear: at least, where head.most leaves no room for more, and at most. */
enum { LEAST_LOOKS = 8, MOST_LOOKS = 60 };

/* Evaluations that head.most leaves for what is left of a step. */
static int64_t work_left(const gic_head *head, const Rest *rest)
{
    const int64_t done = head->rhs_count + head->look_count - head->begun_count;
    return head->most > 0 ? head->most - done - rest->behind : INT64_MAX / 2;
}

/* Put the instance at a share of the rest and look at its gears there: 1 if they change, 0 if not, or a status. */
static int changes_at(const gic_model *model, void *self, const Rest *rest, gic_real share)
{
    gic_head *head = (gic_head *)self;
    gic_real *state = array_at(self, model->state_offset);
    const int64_t switches = head->switch_count;
    copy_discrete(model, discrete_of(model, self), rest->discrete);
    between(model->slow_count + model->fast_count, share, rest->length, rest->from, rest->rate, rest->to,
            rest->rate_there, state);
    head->start_time = rest->end - (GIC_R(1.0) - share) * rest->length;
    head->steps = 0;
    set_inputs(model, self, head->start_time);
    ++head->look_count;
    const int status = settle(model, self, state);
    head->switch_count = switches;
    return status == GIC_OK ? model->shift(self) : status;
}

/* The least work of a change of gear within a step: the rate at its end, looks, and the rest of the step. */
static int64_t least_gear_work(const gic_head *head)
{
    return 1 + LEAST_LOOKS + 4 * (int64_t)head->ratio;
}

/* Find the first change of gear in the rest and leave the instance right after it. *share: where it is. */
static int locate_change(const gic_model *model, void *self, const Rest *rest, gic_real *share)
{
    const gic_head *head = (const gic_head *)self;
    const int halvings = sizeof(gic_real) < sizeof(double) ? 20 : 45;
    gic_real low = GIC_R(0.0), high = GIC_R(1.0);
    int found = changes_at(model, self, rest, low);
    if (found == 1)
        high = low;
    for (int i = 0; i < halvings && found >= 0 && low < high && work_left(head, rest) > 4 * (int64_t)head->ratio + 1;
         ++i) {
        const gic_real middle = GIC_R(0.5) * (low + high);
        found = changes_at(model, self, rest, middle);
        if (found == 1)
            high = middle;
        else
            low = middle;
    }
    *share = high;
    if (found >= 0)
        found = changes_at(model, self, rest, high);
    return found == 1 ? GIC_OK : found == 0 ? GIC_ERROR_EVENTS : found;
}

/* A part of a step, of `method`, which is AB3, RK4 or implicit. AB3 begins with two parts of RK4; past: rates of the
 * two parts before, which it keeps. The rate at the start goes to `rate`. */
static int advance_part(const gic_model *model, void *self, gic_real time, gic_real step, int32_t method,
                        const gic_real *from, int32_t part, const gic_real *past[2], gic_real *rate, gic_real *next,
                        gic_real *work, const gic_real **newest)
{
    const int bashforth = method == GIC_AB3;
    const int status = advance(model, self, time, step, bashforth ? GIC_RK4 : method, from,
                               bashforth && part > 1 ? past : NULL, rate, next, work, newest);
    past[1] = past[0];
    past[0] = rate;
    return status;
}

/* The rest of a step in `parts` parts by `method`. The rate at its start goes to `first`; work: 4 rows of a state. */
static int finish_step(const gic_model *model, void *self, const Rest *rest, int32_t parts, int32_t method,
                       gic_real *first, gic_real *work)
{
    const int32_t n = model->slow_count + model->fast_count;
    const gic_real part = rest->length / (gic_real)parts, *newest, *past[2] = {NULL, NULL};
    gic_real *const state = array_at(self, model->state_offset), *const spare[] = {work, work + 2 * n, work + 3 * n};
    int status = GIC_OK;
    for (int32_t k = 0; k < parts && status == GIC_OK; ++k) {
        const gic_real time = rest->end - (gic_real)(parts - k) * part;
        status = advance_part(model, self, time, part, method, state, k, past, k == 0 ? first : spare[(k - 1) % 3],
                              work + n, work + 2 * n, &newest);
        if (status == GIC_OK)
            copy(state, work + n, n);
    }
    return status;
}

/* The same where contacts change, by a method without history. */
static int finish_piece(const gic_model *model, void *self, const Rest *rest, int32_t parts)
{
    const int32_t method = ((const gic_head *)self)->method;
    gic_real *const scratch = array_at(self, model->scratch_offset);
    return finish_step(model, self, rest, parts, method == GIC_AB3 ? GIC_RK4 : method, scratch,
                       scratch + 3 * (model->slow_count + model->fast_count));
}

/* What gic_head.event says of the discrete state that is not as in before[]. */
static int32_t changed_gear(const gic_model *model, void *self, const int32_t *before)
{
    const int32_t *now = discrete_of(model, self);
    int32_t i = 0;
    while (i < model->discrete_count - 1 && now[i] == before[i])
        ++i;
    return 1 + model->contact_count + i;
}

/* Gears at the end of a step, whose state at the start is in row 1 of the scratch array. Each change is located, and
 * the step goes on from there. On a failure the instance is left at some time within the step. */
static int change_gears(const gic_model *model, void *self)
{
    const int32_t n = model->slow_count + model->fast_count;
    gic_head *head = (gic_head *)self;
    gic_real *scratch = array_at(self, model->scratch_offset), *state = array_at(self, model->state_offset);
    gic_real *from = scratch + n, *to = scratch + 3 * n, *rate_there = scratch + 4 * n, *end_state = scratch + 9 * n,
             share = GIC_R(0.0);
    Rest rest = {gic_time(self), head->step, from, array_at(self, model->rate_offset), to, rate_there, 0, {0}};
    for (int32_t changes = 0; share < GIC_R(1.0); ++changes) {
        copy_discrete(model, rest.discrete, discrete_of(model, self));
        copy(end_state, state, n); /* to a row of its own: without a change the others keep what the step has there */
        if (!model->shift(self))
            return GIC_OK;
        copy(to, end_state, n);
        head->event = changed_gear(model, self, rest.discrete);
        if (changes == GIC_CHANGES)
            return GIC_ERROR_EVENTS;
        head->history = 0;
        if (work_left(head, &rest) < least_gear_work(head)) { /* then it changes at the end of the step */
            head->event = 0;
            ++head->passed_count;
            return GIC_OK;
        }
        copy_discrete(model, discrete_of(model, self), rest.discrete);
        int status = evaluate(model, self, rest.end, to, rate_there);
        if (status == GIC_OK)
            status = locate_change(model, self, &rest, &share);
        if (status == GIC_OK && share < GIC_R(1.0)) {
            rest.length *= GIC_R(1.0) - share;
            copy(scratch + 2 * n, state, n);
            status = finish_step(model, self, &rest, head->ratio, head->method, scratch, to);
            rest.from = scratch + 2 * n;
            rest.rate = scratch;
        }
        if (status != GIC_OK)
            return status;
        head->event = 0;
        head->start_time = rest.end;
        set_inputs(model, self, rest.end);
    }
    return GIC_OK;
}

/* ---- contacts: the same for what head.locate asks for. Rows of the scratch array: 1 the state where the step begins,
 * 9 and 11 state and rate at its end, others keep what the step has there; when it is made again, 0 the rate where a
 * piece begins, 2 the state there, 3 to 6 work. */

/* How near to them contacts are; above: those with a load, a bit each. */
typedef struct Touch {
    gic_real press[GIC_CONTACTS];
    uint64_t above;
} Touch;

static int touch_at(const gic_model *model, void *self, gic_real time, const gic_real *state, Touch *touch)
{
    set_inputs(model, self, time);
    ++((gic_head *)self)->look_count;
    const int status = model->contacts->press(self, time, state, touch->press);
    touch->above = 0;
    for (int32_t i = 0; i < model->contact_count && status == GIC_OK; ++i)
        touch->above |= (uint64_t)(touch->press[i] > GIC_R(0.0)) << i;
    return status;
}

/* The same at a share of the rest, where the instance's state is, but not settled yet. */
static int touch_within(const gic_model *model, void *self, const Rest *rest, gic_real share, Touch *touch)
{
    gic_head *head = (gic_head *)self;
    gic_real *state = array_at(self, model->state_offset);
    const int64_t switches = head->switch_count;
    const int status = settle(model, self, state);
    head->switch_count = switches;
    return status == GIC_OK ? touch_at(model, self, rest->end - (GIC_R(1.0) - share) * rest->length, state, touch)
                            : status;
}

/* The same on the cubic through both ends; the instance's state is there afterwards. */
static int touch_between(const gic_model *model, void *self, const Rest *rest, gic_real share, Touch *touch)
{
    between(model->slow_count + model->fast_count, share, rest->length, rest->from, rest->rate, rest->to,
            rest->rate_there, array_at(self, model->state_offset));
    return touch_within(model, self, rest, share, touch);
}

/* Shares of a step that are the same time: what a force that begins or ends loses in it is 1e-12 of a step's error. */
#define SAME_TIME GIC_R(1e-6)

/* Fast steps, and parts of one, in a piece of the step. */
static int32_t parts_of(const gic_head *head, gic_real length)
{
    return 1 + (int32_t)(GIC_R(0.999) * (gic_real)head->ratio * length / head->step);
}

/* What the rest of a step takes if `count` contacts change within it: the rate at its end, looks, both parts of it with
 * a look after each, and one ahead from where they change. */
static int64_t least_work(const gic_head *head, gic_real length, int count)
{
    return 1 + (int64_t)count * LEAST_LOOKS + 4 * ((int64_t)parts_of(head, length) + 1) + 3;
}

/* Contacts in a set. */
static int number_of(uint64_t set)
{
    int count = 0;
    for (; set; set &= set - 1)
        ++count;
    return count;
}

/* What gic_head.event says of the first contact in a set that is not empty. */
static int32_t first_contact(uint64_t set)
{
    int32_t i = 0;
    while (!(set >> i & 1))
        ++i;
    return 1 + i;
}

/* ---- contacts that are the same at both ends of a step, but not within it */

/* Nearer to the ends of a piece (a share of it) nothing turns that is not seen there. */
#define INNER GIC_R(1e-3)

/* Of a contact as far from its change as `start` and `end` at both ends of the rest, which moves by `slope` at first:
 * where it comes nearest, as a share of the rest, by the parabola through them; 0: not so near that as much again could
 * make it change. */
static gic_real nearest(gic_real start, gic_real slope, gic_real end)
{
    const gic_real bend = end - start - slope, share = GIC_R(-0.5) * slope / bend;
    if (!(bend > GIC_R(1e-3) * GIC_LIMIT_ROUNDING) || !(share > GIC_R(-0.5)) || !(share < GIC_R(1.5)) ||
        !(start + GIC_R(0.5) * slope * share < GIC_R(4.0) * bend))
        return GIC_R(0.0);
    return share < INNER ? INNER : share > GIC_R(1.0) - INNER ? GIC_R(1.0) - INNER : share;
}

static gic_real side_of(const Touch *touch, int32_t i)
{
    return touch->above >> i & 1 ? GIC_R(1.0) : GIC_R(-1.0);
}

/* The same by what the last two steps have left: may one have changed and changed back? */
static int may_have_turned(const gic_model *model, void *self, const Touch *b)
{
    const gic_real *start = array_at(self, model->contacts->past_offset), *before = start + model->contact_count;
    for (int32_t i = 0; i < model->contact_count; ++i) {
        const gic_real side = side_of(b, i), end = side * b->press[i];
        if (nearest(side * start[i], GIC_R(0.5) * (end - side * before[i]), end) > GIC_R(0.0))
            return 1;
    }
    return 0;
}

/* Where a contact comes nearest to a change within the rest, or has changed. */
typedef struct Turn {
    gic_real share, press; /* 0 and 0: it has not */
} Turn;

/* From distances at both ends and a guess: parabolas through the three points about the least one. */
static int find_turn(const gic_model *model, void *self, const Rest *rest, int32_t i, gic_real side, gic_real start,
                     gic_real guess, gic_real end, Turn *turn)
{
    gic_real at[3] = {GIC_R(0.0), guess, GIC_R(1.0)}, distance[3] = {start, GIC_R(0.0), end};
    turn->share = turn->press = GIC_R(0.0);
    for (int k = 0; k < LEAST_LOOKS; ++k) {
        Touch now;
        const int status = touch_between(model, self, rest, guess, &now);
        if (status != GIC_OK)
            return status;
        if (side_of(&now, i) != side) {
            turn->share = guess;
            turn->press = now.press[i];
            return GIC_OK;
        }
        const gic_real found = side * now.press[i];
        const int worse = k > 0 && found >= distance[1], before = guess < at[1];
        if (k > 0) { /* the end of the three that is left behind */
            const int end_of = worse ? (before ? 0 : 2) : (before ? 2 : 0);
            at[end_of] = worse ? guess : at[1];
            distance[end_of] = worse ? found : distance[1];
        }
        if (!worse) {
            at[1] = guess;
            distance[1] = found;
        }
        const gic_real left = at[1] - at[0], right = at[2] - at[1];
        const gic_real fall = left * (distance[2] - distance[1]), rise = right * (distance[0] - distance[1]);
        guess = at[1] + GIC_R(0.5) * (right * rise - left * fall) / (fall + rise);
        if (!(absolute(guess - at[1]) > GIC_R(1e-4)) || !(guess > at[0]) || !(guess < at[2]))
            return GIC_OK;
    }
    return GIC_OK;
}

/* What may happen between the ends of a piece. */
typedef struct Between {
    Turn turn[GIC_CONTACTS]; /* of those in `found`: where each is on the other side */
    uint64_t found;          /* contacts that change and change back */
    gic_real near;           /* share at which one comes near and does not change; 0: none does */
    int rated;               /* is the rate at the end known? */
} Between;

/* Contacts of `which` that are the same at both ends of a piece and not within it. The instance's state is that at the
 * end, rest->to, before and after. */
static int find_turns(const gic_model *model, void *self, const Rest *rest, const Touch *a, const Touch *b,
                      uint64_t which, gic_real *rate_there, Between *found)
{
    gic_head *head = (gic_head *)self;
    const int32_t n = model->slow_count + model->fast_count;
    const gic_real ahead = GIC_R(0.015625);
    gic_real *state = array_at(self, model->state_offset);
    Touch soon;
    for (int32_t k = 0; k < n; ++k)
        state[k] = rest->from[k] + ahead * rest->length * rest->rate[k];
    int status = touch_within(model, self, rest, ahead, &soon);
    for (int32_t i = 0; i < model->contact_count && status == GIC_OK; ++i) {
        if (!(which >> i & 1))
            continue;
        const gic_real side = side_of(a, i), start = side * a->press[i], end = side * b->press[i];
        const gic_real share = nearest(start, (side * soon.press[i] - start) / ahead, end);
        if (!(share > GIC_R(0.0)))
            continue;
        if (work_left(head, rest) < LEAST_LOOKS + least_work(head, rest->length, 1))
            break;
        if (!found->rated)
            status = evaluate(model, self, rest->end, rest->to, rate_there);
        found->rated = 1;
        if (status == GIC_OK)
            status = find_turn(model, self, rest, i, side, start, share, end, &found->turn[i]);
        if (status == GIC_OK && found->turn[i].share > GIC_R(0.0))
            found->found |= (uint64_t)1 << i;
        else if (share > GIC_R(0.05) && share < GIC_R(0.95))
            found->near = share;
    }
    copy(state, rest->to, n);
    return status;
}

/* ---- where contacts change */

/* The share of the rest at which contact i changes, which is on another side at share `high`, where its number is
 * at_high, than at its start. *slope: of its number over the share there. Every third look halves what is left. */
static int locate_contact(const gic_model *model, void *self, const Rest *rest, int32_t i, const Touch *a,
                          gic_real high, gic_real at_high, int64_t looks, gic_real *share, gic_real *slope)
{
    const uint64_t bit = (uint64_t)1 << i, after = ~a->above & bit;
    gic_real low = GIC_R(0.0), at_low = a->press[i];
    int status = GIC_OK;
    if ((at_low > GIC_R(0.0)) == (after != 0)) {
        /* it has just changed, and rounding has put it where it was: between both it may be where it should */
        Turn turn;
        const gic_real side = after ? GIC_R(1.0) : GIC_R(-1.0);
        status = find_turn(model, self, rest, i, side, side * at_low, GIC_R(0.5) * high, side * at_high, &turn);
        low = turn.share;
        at_low = turn.press;
        high = low > GIC_R(0.0) ? high : GIC_R(0.0);
        looks -= LEAST_LOOKS;
    }
    for (int k = 0; k < looks && high - low > GIC_R(0.1) * SAME_TIME && status == GIC_OK; ++k) {
        Touch now;
        const gic_real way = at_low - at_high, part = at_low / way;
        const int useful = k % 3 < 2 && gic_finite(&part, 1) && part > GIC_R(0.01) && part < GIC_R(0.99);
        const gic_real middle = low + (useful ? part : GIC_R(0.5)) * (high - low);
        status = touch_between(model, self, rest, middle, &now);
        if (status == GIC_OK && (now.above & bit) == after) {
            high = middle;
            at_high = now.press[i];
        } else if (status == GIC_OK) {
            low = middle;
            at_low = now.press[i];
        }
    }
    *share = high;
    *slope = (at_high - at_low) / (high - low);
    return status;
}

/* Move the instance to the first change of one of the contacts `changed` in the rest, at whose start is *touch: to
 * *share of it, where *touch has what is above, the contacts that change included. last: where each is on the other
 * side for sure. */
static int go_to_contact(const gic_model *model, void *self, const Rest *rest, uint64_t changed, const Turn *last,
                         gic_real *share, Touch *touch)
{
    gic_head *head = (gic_head *)self;
    gic_real at[GIC_CONTACTS], slope[GIC_CONTACTS];
    gic_real *const state = array_at(self, model->state_offset);
    const int32_t n = model->slow_count + model->fast_count;
    const uint64_t before = touch->above;
    const int count = number_of(changed);
    int64_t spare = work_left(head, rest) - least_work(head, rest->length, 0) - (int64_t)count * LEAST_LOOKS;
    int32_t soonest = -1;
    int status = GIC_OK;
    for (int32_t i = 0; i < model->contact_count && status == GIC_OK; ++i) {
        at[i] = GIC_R(2.0);
        if (changed >> i & 1) {
            const int64_t looks = LEAST_LOOKS + (spare > 0 ? spare : 0) / count, whole = head->look_count;
            status = locate_contact(model, self, rest, i, touch, last[i].share, last[i].press,
                                    looks < MOST_LOOKS ? looks : (int64_t)MOST_LOOKS, &at[i], &slope[i]);
            spare -= head->look_count - whole > LEAST_LOOKS ? head->look_count - whole - LEAST_LOOKS : 0;
            if (soonest < 0 || at[i] < at[soonest])
                soonest = i;
        }
    }
    if (status != GIC_OK)
        return status;
    *share = at[soonest];
    /* the step did not know of the contact: its interpolant shows about when it is, and a step to there shows when */
    for (int tries = 0;; ++tries) {
        Rest piece = *rest;
        piece.length = *share * rest->length;
        piece.end = rest->end - (rest->length - piece.length);
        const int32_t parts = parts_of(head, piece.length);
        copy(state, rest->from, n);
        status = finish_piece(model, self, &piece, parts);
        if (status == GIC_OK)
            status = touch_at(model, self, piece.end, state, touch);
        if (status != GIC_OK)
            return status;
        const gic_real off = -touch->press[soonest] / slope[soonest], next = *share + off;
        if (tries == 4 || !gic_finite(&off, 1) || absolute(off) < SAME_TIME || !(next > SAME_TIME) ||
            !(next < GIC_R(1.0)) ||
            work_left(head, rest) < 4 * ((int64_t)parts_of(head, next * rest->length) +
                                         parts_of(head, (GIC_R(1.0) - next) * rest->length)) +
                                        3)
            break;
        *share = next;
    }
    for (int32_t i = 0; i < model->contact_count; ++i)
        if (at[i] <= at[soonest] + SAME_TIME) {
            const uint64_t bit = (uint64_t)1 << i;
            touch->above = (touch->above & ~bit) | (~before & bit);
            ++head->contact_count;
        }
    return status;
}

/* What the next step needs to know of this one. broken: its ends show two kinds of motion. */
static void note_contacts(const gic_model *model, void *self, const Touch *b, int broken)
{
    gic_head *head = (gic_head *)self;
    gic_real *past = array_at(self, model->contacts->past_offset);
    copy(past + model->contact_count, past, model->contact_count);
    copy(past, b->press, model->contact_count);
    head->touched = head->touched < 1 ? 1 : broken ? 3 : 2;
    head->touching = b->above;
}

/* ---- loads that bend (head.locate is 2) */

/* The number of a contact may bend by this share of itself in a part of a step. What is less than LEAST_PRESS, m or
 * rad, is a load that does not matter. */
#define MOST_BEND GIC_R(0.015625)
#define LEAST_PRESS GIC_R(1e-4)

/* Parts of a step, and what each takes: RK4, and looks at its end and near its beginning. */
enum { MOST_PARTS = 32, PART_WORK = 6 };

/* The parts in which a step has to be made again, 1: it is good enough. made: parts that it has. The second difference
 * of a number at the last three ends of steps, b the last, falls with the square of the parts. */
static int32_t parts_wanted(const gic_model *model, void *self, const Touch *b, int32_t made)
{
    const gic_head *head = (const gic_head *)self;
    const gic_real *start = array_at(self, model->contacts->past_offset), *before = start + model->contact_count;
    int32_t parts = 1;
    if (head->locate != 2 || head->touched < 2)
        return 1;
    for (int32_t i = 0; i < model->contact_count; ++i) {
        const gic_real number[] = {b->press[i], start[i], before[i]};
        gic_real size = LEAST_PRESS;
        for (int k = 0; k < 3; ++k)
            size = absolute(number[k]) > size ? absolute(number[k]) : size;
        const gic_real bend = absolute(number[0] - GIC_R(2.0) * number[1] + number[2]);
        while (parts < MOST_PARTS && bend > MOST_BEND * size * (gic_real)(parts * parts))
            ++parts;
    }
    if (parts <= made)
        return 1;
    const Rest whole = {GIC_R(0.0), GIC_R(0.0), NULL, NULL, NULL, NULL, 1, {0}};
    const int64_t room = work_left(head, &whole) / PART_WORK;
    parts = parts < head->ratio ? head->ratio : parts;
    parts = parts > room ? (int32_t)room : parts;
    return parts < head->ratio || parts <= made ? 1 : parts;
}

/* Pieces of a step that end where a contact comes near. */
enum { MOST_SPLITS = 8 };

/* Make a piece of the step from the instance's state on, which is what is looked at next: from its start, in `rest`, to
 * its end, b. */
static int make_piece(const gic_model *model, void *self, gic_real end, Rest *rest, Touch *b)
{
    gic_head *head = (gic_head *)self;
    const int32_t n = model->slow_count + model->fast_count;
    gic_real *scratch = array_at(self, model->scratch_offset), *state = array_at(self, model->state_offset);
    copy(scratch + 2 * n, state, n);
    rest->from = scratch + 2 * n;
    rest->rate = scratch;
    rest->end = end;
    const int status = finish_piece(model, self, rest, parts_of(head, rest->length));
    return status == GIC_OK ? touch_at(model, self, end, state, b) : status;
}

/* A step that is made again, from where it begins. */
static int remake_piece(const gic_model *model, void *self, gic_real share, Rest *rest, Touch *b)
{
    copy(array_at(self, model->state_offset), rest->from, model->slow_count + model->fast_count);
    const gic_real start = rest->end - rest->length;
    rest->length *= share;
    return make_piece(model, self, start + rest->length, rest, b);
}

/* Contacts at the end of a step whose state at the start is in row 1 of the scratch array. Where they have changed,
 * also if they have changed back, the step is made again in pieces that end at the changes; and where their loads bend
 * too much, in parts. staged: RK4 made the step, whose stages may have met a contact that the motion only comes near;
 * then a piece ends there. */
static int cross_contacts(const gic_model *model, void *self, int staged)
{
    const int32_t n = model->slow_count + model->fast_count;
    gic_head *head = (gic_head *)self;
    gic_real *scratch = array_at(self, model->scratch_offset), *state = array_at(self, model->state_offset);
    gic_real *to = scratch + 9 * n, *rate_there = scratch + 11 * n;
    const gic_real end = gic_time(self);
    Rest rest = {end, head->step, scratch + n, array_at(self, model->rate_offset), to, rate_there, 0, {0}};
    uint64_t crossed = 0;
    Touch a, b;
    int status = touch_at(model, self, end, state, &b), broken = 0, splits = 0;
    const int32_t parts = status == GIC_OK ? parts_wanted(model, self, &b, staged ? head->ratio : 1) : 1;
    int32_t part = 1; /* the present one, which ends at part_end */
    gic_real part_end = end;
    if (status == GIC_OK && parts == 1 && b.above == head->touching && head->touched == 2 &&
        !may_have_turned(model, self, &b)) {
        note_contacts(model, self, &b, 0);
        return GIC_OK;
    }
    if (status == GIC_OK)
        status = touch_at(model, self, end - rest.length, rest.from, &a);
    if (status == GIC_OK && parts > 1) {
        head->history = 0;
        staged = 1;
        status = remake_piece(model, self, GIC_R(1.0) / (gic_real)parts, &rest, &b);
        part_end = rest.end;
    }
    for (int32_t changes = 0; status == GIC_OK;) {
        Between within;
        gic_real share = GIC_R(1.0);
        const uint64_t before = a.above;
        uint64_t changed = before ^ b.above;
        rest.behind = (int64_t)(parts - part) * PART_WORK;
        copy(to, state, n);
        within.found = 0;
        within.near = GIC_R(0.0);
        within.rated = 0;
        if (rest.length >
            GIC_R(0.0)) /* else a contact has changed at the very end: nothing is left, and `from` is old */
            status = find_turns(model, self, &rest, &a, &b, ~(changed | crossed), rate_there, &within);
        for (int32_t i = 0; i < model->contact_count; ++i)
            if (changed >> i & 1) {
                within.turn[i].share = GIC_R(1.0);
                within.turn[i].press = b.press[i];
            }
        changed |= within.found;
        if (status != GIC_OK)
            break;
        const int64_t work = least_work(head, rest.length, number_of(changed));
        if (changed && changes == GIC_CHANGES) {
            head->event = first_contact(changed);
            return GIC_ERROR_EVENTS;
        }
        if (changed && work_left(head, &rest) < work) {
            head->passed_count += number_of(changed);
            changed = within.found = 0;
        }
        if (staged && within.near > GIC_R(0.0) && splits < MOST_SPLITS && head->most == 0) {
            ++splits;
            broken = 1;
            status = remake_piece(model, self, within.near, &rest, &b);
        } else if (changed) {
            ++changes;
            broken = 1;
            if (!within.rated)
                status = evaluate(model, self, rest.end, to, rate_there);
            if (status == GIC_OK)
                status = go_to_contact(model, self, &rest, changed, within.turn, &share, &a);
            crossed |= before ^ a.above;
            b = a;
            rest.length *= GIC_R(1.0) - share;
            if (status == GIC_OK && share < GIC_R(1.0))
                status = make_piece(model, self, rest.end, &rest, &b);
        } else if (rest.end < end) {
            if (rest.end >= part_end) {
                ++part;
                part_end = part < parts ? end - (gic_real)(parts - part) / (gic_real)parts * head->step : end;
                crossed = 0;
            }
            a = b;
            rest.length = part_end - rest.end;
            status = make_piece(model, self, part_end, &rest, &b);
        } else
            break;
        staged = 1;
        head->history = 0;
    }
    note_contacts(model, self, &b, broken);
    set_inputs(model, self, end);
    return status;
}

/* Are there changes to look for within steps? */
static int looks_within(const gic_model *model, const gic_head *head)
{
    return model->shift || (model->contacts && head->locate);
}

/* What a step changes of an instance before its gears are known: rows 7 and 8 of the scratch array have the rate at the
 * start of the step before, and for march() the older row of the history. */
typedef struct Kept {
    gic_real start_time, step;
    int64_t steps;
    int32_t method, ratio, history;
} Kept;

static gic_real *kept_rows(const gic_model *model, void *self)
{
    return array_at(self, model->scratch_offset) + 7 * (model->slow_count + model->fast_count);
}

static Kept keep(const gic_model *model, void *self)
{
    const gic_head *head = (const gic_head *)self;
    if (looks_within(model, head))
        copy(kept_rows(model, self), array_at(self, model->rate_offset), model->slow_count + model->fast_count);
    /* no compound literal: this file compiles as C++, too */
    const Kept kept = {head->start_time, head->step, head->steps, head->method, head->ratio, head->history};
    return kept;
}

static void take_back(const gic_model *model, void *self, const Kept *kept)
{
    gic_head *head = (gic_head *)self;
    copy(array_at(self, model->rate_offset), kept_rows(model, self), model->slow_count + model->fast_count);
    head->start_time = kept->start_time;
    head->step = kept->step;
    head->steps = kept->steps;
    head->method = kept->method;
    head->ratio = kept->ratio;
    head->history = kept->history;
}

/* After a step that began at `from`, a row of the scratch array, and was one of RK4 if `staged`: contacts and gears
 * change. If that fails, state and gears are those
 * at the start again. */
static int arrive(const gic_model *model, void *self, const gic_real *from, int staged)
{
    gic_head *head = (gic_head *)self;
    int32_t discrete[MOST_DISCRETE];
    ++head->steps;
    set_inputs(model, self, gic_time(self));
    if (looks_within(model, head)) {
        const gic_real start_time = head->start_time;
        const int64_t steps = head->steps, contact_count = head->contact_count, passed_count = head->passed_count;
        const int32_t n = model->slow_count + model->fast_count;
        gic_real *start = array_at(self, model->scratch_offset) + n;
        if (from != start)
            copy(start, from, n);
        copy_discrete(model, discrete, discrete_of(model, self));
        int status = model->discrete_count <= MOST_DISCRETE ? GIC_OK : GIC_ERROR_ABI;
        if (status == GIC_OK && model->contacts && head->locate)
            status = cross_contacts(model, self, staged);
        if (status == GIC_OK && model->shift)
            status = change_gears(model, self);
        head->start_time = start_time;
        head->steps = steps;
        if (status != GIC_OK) {
            copy(array_at(self, model->state_offset), start, n);
            copy_discrete(model, discrete_of(model, self), discrete);
            head->contact_count = contact_count;
            head->passed_count = passed_count;
            head->touched = 0;
            return status;
        }
    }
    head->hold = -1;
    return GIC_OK;
}

/* Finish a step, of RK4 if `staged`: the instance advances, with `history` rates to keep, or none if its gears change.
 * If that fails it is as before. */
static int move_on(const gic_model *model, void *self, gic_real step, int32_t method, int32_t ratio, int32_t history,
                   gic_real *next, const gic_real *rate, int staged)
{
    gic_head *head = (gic_head *)self;
    const int32_t n = model->slow_count + model->fast_count;
    gic_real *state = array_at(self, model->state_offset);
    const Kept kept = keep(model, self);
    if (!goes_on(head, step, method, ratio)) {
        if (step != head->step && head->touched > 1)
            head->touched = 1; /* numbers a step of another length apart */
        head->start_time = gic_time(self);
        head->steps = 0;
        head->step = step;
        head->method = method;
        head->ratio = ratio;
    }
    head->history = history;
    for (int32_t i = 0; i < n; ++i) { /* the state at the start stays in `next` */
        const gic_real start = state[i];
        state[i] = next[i];
        next[i] = start;
    }
    copy(array_at(self, model->rate_offset), rate, n);
    const int status = arrive(model, self, next, staged);
    if (status != GIC_OK)
        take_back(model, self, &kept);
    return status;
}

/* A step of AB3 with history by the model's own function: 1 if it was made. A failed one leaves the instance unchanged
 * except for counts, and is repeated by the functions above, which find the cause. */
static int march(const gic_model *model, void *self, gic_real step)
{
    gic_head *head = (gic_head *)self;
    const gic_real time = gic_time(self);
    gic_real *input = array_at(self, model->input_offset);
    gic_real *input_before =
        array_at(self, model->scratch_offset) + GIC_SCRATCH(model->slow_count + model->fast_count, 0);
    if (!model->march || !takes_options(head, 1) || model->abi_version != GIC_ABI_VERSION ||
        model->real_size != sizeof(gic_real) || !(time + step > time))
        return 0;
    const int64_t rhs_count = head->rhs_count, newton_count = head->newton_count, late_count = head->late_count,
                  correction_count = head->correction_count, kept_count = head->kept_count, air_count = head->air_count;
    head->grown = -1;
    head->event = 0;
    head->begun_count = head->rhs_count + head->look_count;
    head->ahead = step;
    head->hold = head->flip;
    if (head->input_function) {
        copy(input_before, input, model->input_count);
        set_inputs(model, self, time);
    }
    const int32_t n = model->slow_count + model->fast_count;
    gic_real *from = array_at(self, model->scratch_offset) + n, *history = array_at(self, model->history_offset);
    gic_real *older = kept_rows(model, self) + n;
    const Kept kept = keep(model, self);
    if (looks_within(model, head)) {
        copy(from, array_at(self, model->state_offset), n);
        copy(older, history + n, n);
    }
    if (model->march(self, time) == GIC_OK) {
        if (arrive(model, self, from, 0) == GIC_OK)
            return 1;
        copy(history, history + n, n);
        copy(history + n, older, n);
        take_back(model, self, &kept);
    }
    head->flip = head->hold;
    head->hold = -1;
    head->rhs_count = rhs_count;
    head->newton_count = newton_count;
    head->correction_count = correction_count;
    head->late_count = late_count;
    head->kept_count = kept_count;
    head->air_count = air_count;
    if (head->input_function)
        copy(input, input_before, model->input_count);
    return 0;
}

/* After a step: what IMEX or EXP3 keep of it beside rates. from: the state at its start. */
static void keep_change(const gic_model *model, void *self, int32_t method, gic_real step, const gic_real *from)
{
    if (method < GIC_IMEX)
        return;
    const Implicit w = implicit_of(model, self);
    const gic_real *const state = array_at(self, model->state_offset);
    gic_real *const last = method == GIC_EXP3 ? exponential_of(model, self).change : last_change(&w);
    for (int32_t i = 0; i < w.n; ++i)
        last[i] = state[i] - from[i];
    if (method == GIC_EXP3 && step == w.head->span)
        ++w.head->spent;
}

static int plain_step(const gic_model *model, void *self, gic_real step, int32_t method)
{
    gic_head *head = (gic_head *)self;
    if (method == GIC_AB3 && goes_on(head, step, method, 1) && head->history == 2 && march(model, self, step))
        return GIC_OK;
    int status = check_step(model, self, step, step);
    if (status != GIC_OK)
        return status;
    if (!is_method(model, method) || !takes_options(head, 1))
        return head->status = GIC_ERROR_ARGUMENT;

    const int32_t n = model->slow_count + model->fast_count;
    const int32_t most = method == GIC_AB3 ? 2 : method >= GIC_IMEX ? 1 : 0; /* rates to keep */
    const int32_t known = goes_on(head, step, method, 1) && most > 0 ? head->history : 0;
    gic_real *history = array_at(self, model->history_offset);
    gic_real *rate = array_at(self, model->scratch_offset), *next = rate + n, *work = next + n;
    gic_real *input_before = rate + GIC_SCRATCH(n, 0);
    const gic_real *newest = array_at(self, model->rate_offset);
    copy(input_before, array_at(self, model->input_offset), model->input_count);
    head->hold = head->flip;
    const gic_real *const past[] = {history, history + n};
    status = head->status = advance(model, self, gic_time(self), step, method, array_at(self, model->state_offset),
                                    known > 0 && known == most ? past : NULL, rate, next, work, &newest);
    if (status != GIC_OK)
        return give_up(model, self, step, status, newest, input_before);
    status = move_on(model, self, step, method, 1, known < most ? known + 1 : most, next, rate, known < 2);
    if (status != GIC_OK)
        return give_up(model, self, step, status, rate, input_before);
    if (head->history > 0) {
        copy(history + n, history, n);
        copy(history, rate, n);
    }
    keep_change(model, self, method, step, next); /* the state at the start is in `next` */
    return GIC_OK;
}

/* ---- dual rate -------------------------------------------------------------------------------------------- */

/* A step of gic_step_dual under way. */
typedef struct Dual {
    const gic_model *model;
    void *self;
    gic_real start, step; /* time is start + steps * step, independent of the head's present count */
    int64_t steps;
    int32_t ratio, method;
    gic_real steady;   /* of gic_step_steady */
    gic_real *scratch; /* rows of a state: 0 the rate at the start, 1 and 2 states, 3 to 6 for the method */
    gic_real *link;    /* rows 0 to 2: at this slow step and the two before; 3 at the next; 4 at a fast step */
    gic_real *next;
    const gic_real *fast[2]; /* results: the state; rates of the fast states at the last two fast steps */
    const gic_real *newest;  /* the latest known rate of all states */
} Dual;

static gic_real *row(const Dual *dual, int32_t i)
{
    return dual->scratch + i * (dual->model->slow_count + dual->model->fast_count);
}

/* Start of fast step k, 0 to `ratio`: from integers, so that no error accumulates. */
static gic_real moment(const Dual *dual, int32_t k)
{
    const gic_real whole = (gic_real)(dual->steps + k / dual->ratio);
    return dual->start + (whole + (gic_real)(k % dual->ratio) / (gic_real)dual->ratio) * dual->step;
}

/* The links at a slow state at the beginning of fast step k. */
static int link_at(const Dual *dual, int32_t k, const gic_real *slow, gic_real *link)
{
    const gic_real time = moment(dual, k);
    set_inputs(dual->model, dual->self, time);
    const int status = dual->model->link(dual->self, time, slow, link);
    if (status != GIC_OK)
        return status;
    return gic_finite(link, dual->model->link_count) ? GIC_OK : GIC_ERROR_RESULT;
}

/* The links at the beginning of fast step k, the cubic through four rows: weights of what the next row, the one before
 * and the older one differ from the present one. Differences are weighted, so that equal rows give the same number to
 * the last bit. */
static void weigh_rows(const Dual *dual, int32_t k, gic_real by[3])
{
    const gic_real s = (gic_real)k / (gic_real)dual->ratio, half = GIC_R(0.5) * s, sixth = s / GIC_R(6.0);
    by[0] = sixth * (s + GIC_R(1.0)) * (s + GIC_R(2.0));
    by[1] = half * (s - GIC_R(1.0)) * (s + GIC_R(2.0));
    by[2] = sixth * (GIC_R(1.0) - s) * (s + GIC_R(1.0));
}

static void interpolate(const Dual *dual, const gic_real by[3], gic_real *link)
{
    const int32_t count = dual->model->link_count;
    const gic_real *now = dual->link, *before = now + count, *older = before + count, *next = older + count;
    for (int32_t i = 0; i < count; ++i)
        link[i] = now[i] + by[0] * (next[i] - now[i]) + by[1] * (before[i] - now[i]) + by[2] * (older[i] - now[i]);
}

/* Fast step k, which makes rate[], the fast states' rates at its start, if k is not 0. */
static int step_fast(const Dual *dual, int32_t k, gic_real *fast, gic_real *rate)
{
    const gic_model *model = dual->model;
    const gic_real step = dual->step / (gic_real)dual->ratio;
    int status = GIC_OK;
    if (k > 0) {
        const gic_real time = moment(dual, k);
        gic_real by[3], *link = dual->link + 4 * model->link_count;
        set_inputs(model, dual->self, time);
        weigh_rows(dual, k, by);
        ++((gic_head *)dual->self)->fast_count;
        if (model->fast_step)
            return model->fast_step(dual->self, time, by, step, dual->fast[0], dual->fast[1], rate, fast);
        interpolate(dual, by, link);
        status = model->fast(dual->self, time, link, fast, rate);
    }
    if (status != GIC_OK)
        return status;
    adams_bashforth(model->fast_count, step, fast, rate, dual->fast[0], dual->fast[1], fast);
    return gic_bounded(fast, model->fast_count) ? GIC_OK : GIC_ERROR_UNSTABLE;
}

/* The method without history that makes parts of a step. */
static int32_t part_method(int32_t method)
{
    return method == GIC_AB3 ? GIC_RK4 : method == GIC_IMEX ? GIC_ROS2 : method == GIC_EXP3 ? GIC_ROS3 : method;
}

/* The rate at the start of the step before, of all states, which IMEX and EXP3 need: a row of an instance that these
 * two leave alone. */
static gic_real *last_rate(const Dual *dual)
{
    const Implicit w = implicit_of(dual->model, dual->self);
    return w.increment + (MOST_STAGES - 1) * w.n;
}

/* A step without history: fast steps of everything, by AB3 after two of RK4 where the method is AB3. After the second
 * one row 3 has the rate at its end. */
static int start_dual(Dual *dual, int32_t known)
{
    const gic_model *model = dual->model;
    const int32_t method = dual->method == GIC_AB3 ? GIC_AB3 : part_method(dual->method);
    const gic_real *past[2] = {NULL, NULL}, *from = array_at(dual->self, model->state_offset);
    gic_real *const link = dual->link;
    int status = known == 0 ? link_at(dual, 0, from, link + 4 * model->link_count) : GIC_OK;
    for (int32_t k = 0; k < dual->ratio && status == GIC_OK; ++k) {
        gic_real *const rate = row(dual, k == 0 ? 0 : 4 + k % 3);
        dual->next = row(dual, 1 + k % 2);
        status = advance_part(model, dual->self, moment(dual, k), dual->step / (gic_real)dual->ratio, method, from, k,
                              past, rate, dual->next, row(dual, 3), &dual->newest);
        dual->fast[1] = dual->fast[0];
        dual->fast[0] = rate + model->slow_count;
        from = dual->next;
    }
    if (status == GIC_OK && known == 1)
        status = evaluate(model, dual->self, moment(dual, dual->ratio), from, row(dual, 3));
    if (status == GIC_OK && known == 1 && !gic_finite(row(dual, 3), model->slow_count))
        status = GIC_ERROR_RESULT;
    return status == GIC_OK ? link_at(dual, dual->ratio, from, link + 3 * model->link_count) : status;
}

/* After the second of these steps: the older past rate of the slow states for the first step of AB3. What acts between
 * slow and fast states is summed with long steps on one side and short ones on the other. Of a motion that dies out
 * soon after the start AB3's sum leaves 3/8 step^3 f'' at its beginning, which the short steps don't, and a lasting
 * difference of momentum would come of it. So instead of f(-2) the first step has the number with which the sum is the
 * integral, by Euler and Maclaurin, for which f' at the beginning is known from the short steps:
 *
 *     integral / step = f(0)/2 + f(1) + f(2) + ... + step f'(0) / 12 + O(step^3 f''')
 *     sum of AB3      = 5/12 f(-2) - 11/12 f(-1) + f(0) + f(1) + f(2) + ... */
static void balance_start(const Dual *dual, const gic_real *past, gic_real *older)
{
    const int32_t slow = dual->model->slow_count;
    const gic_real *now = row(dual, 3), *last = dual->fast[0] - slow, *before = dual->fast[1] - slow;
    for (int32_t i = 0; i < slow; ++i) {
        const gic_real change = GIC_R(1.5) * now[i] - GIC_R(2.0) * last[i] + GIC_R(0.5) * before[i];
        older[i] = (GIC_R(11.0) * past[i] - GIC_R(6.0) * now[i] + (gic_real)dual->ratio * change) / GIC_R(5.0);
    }
}

/* Running means of the fast states' rates. */
static gic_real *course(const Dual *dual)
{
    const gic_model *model = dual->model;
    return array_at(dual->self, model->history_offset) + 2 * (model->slow_count + model->fast_count);
}

/* True if the fast states' rates are near their means. rate: theirs at the start of this step. */
static int keeps_course(const Dual *dual, const gic_real *fast, const gic_real *rate)
{
    const gic_real *mean = course(dual);
    for (int32_t i = 0; i < dual->model->fast_count; ++i) {
        const gic_real change = (rate[i] - mean[i]) * dual->step, size = fast[i] < GIC_R(0.0) ? -fast[i] : fast[i];
        const gic_real most = dual->steady * (GIC_R(1.0) + size);
        if (!(change <= most && change >= -most))
            return 0;
    }
    return dual->steady > GIC_R(0.0);
}

/* Advance all fast states at their mean rates. The deviation of the present rates acts for one fast step only, which is
 * short enough for stability; rates: room for the resulting rates. */
static int stay_on_course(Dual *dual, gic_real *fast, const gic_real *rate, gic_real *rates)
{
    const gic_real *mean = course(dual);
    for (int32_t i = 0; i < dual->model->fast_count; ++i) {
        rates[i] = mean[i] + (rate[i] - mean[i]) / (gic_real)dual->ratio;
        fast[i] += dual->step * rates[i];
    }
    dual->fast[0] = dual->fast[1] = rates;
    ((gic_head *)dual->self)->steady_count += dual->ratio - 1;
    return gic_finite(fast, dual->model->fast_count) ? GIC_OK : GIC_ERROR_RESULT;
}

/* A step of the slow states, and where it is settled the links at its end. Of implicit and exponential methods it is
 * one of all states, whose fast ones nobody uses but the slow ones within it. */
static int step_slow(Dual *dual, gic_real *rate, gic_real *next)
{
    const gic_model *model = dual->model;
    const int32_t slow = model->slow_count, n = slow + model->fast_count;
    const gic_real *state = array_at(dual->self, model->state_offset);
    const gic_real *history = array_at(dual->self, model->history_offset);
    int status = GIC_OK;
    if (dual->method == GIC_AB3) {
        status = evaluate(model, dual->self, moment(dual, 0), state, rate);
        if (status != GIC_OK)
            return status;
        dual->newest = rate;
        adams_bashforth(slow, dual->step, state, rate, history, history + n, next);
        copy(next + slow, state + slow, model->fast_count);
        status = settle(model, dual->self, next);
    } else {
        const gic_real *const past = dual->method >= GIC_IMEX ? last_rate(dual) : NULL;
        status = advance(model, dual->self, moment(dual, 0), dual->step, dual->method, state, past ? &past : NULL, rate,
                         next, row(dual, 3), &dual->newest);
        copy(next + slow, state + slow, model->fast_count);
    }
    return status == GIC_OK ? link_at(dual, dual->ratio, next, dual->link + 3 * model->link_count) : status;
}

/* A step with history: one of the slow states, then `ratio` of AB3 for the fast ones. */
static int march_dual(Dual *dual)
{
    const gic_model *model = dual->model;
    const int32_t slow = model->slow_count, n = slow + model->fast_count;
    const gic_real *history = array_at(dual->self, model->history_offset);
    gic_real *rate = row(dual, 0), *next = row(dual, 1), *fast = next + slow;
    int status = step_slow(dual, rate, next);
    if (status != GIC_OK)
        return status;

    dual->next = next;
    dual->fast[0] = history + slow;
    dual->fast[1] = history + n + slow;
    if (keeps_course(dual, fast, rate + slow))
        return stay_on_course(dual, fast, rate + slow, row(dual, 3));
    for (int32_t k = 0; k < dual->ratio; ++k) {
        gic_real *now = k == 0 ? rate + slow : row(dual, 3 + k % 3);
        status = step_fast(dual, k, fast, now);
        if (status != GIC_OK)
            return status == GIC_ERROR_UNSTABLE ? out_of_bounds(dual->self, fast, slow, n) : status;
        dual->fast[1] = dual->fast[0];
        dual->fast[0] = now;
    }
    return GIC_OK;
}

/* After a step of the fast states from `before` to `after`: update the running means, over some `ratio` steps. */
static void follow_course(const Dual *dual, int32_t known, const gic_real *before, const gic_real *after)
{
    gic_real *mean = course(dual);
    for (int32_t i = 0; i < dual->model->fast_count; ++i) {
        const gic_real rate = (after[i] - before[i]) / dual->step;
        mean[i] = known < 2 ? rate : mean[i] + (rate - mean[i]) / (gic_real)dual->ratio;
    }
}

/* Rates and links of this step become those of the past. */
static void keep_dual(const Dual *dual, int32_t known)
{
    const gic_model *model = dual->model;
    const int32_t slow = model->slow_count, fast = model->fast_count, n = slow + fast, links = model->link_count;
    gic_real *history = array_at(dual->self, model->history_offset), *link = dual->link;
    copy(history + n, history, slow);
    copy(history, row(dual, 0), slow);
    if (known == 1 && dual->method == GIC_AB3)
        balance_start(dual, history, history + n);
    copy(history + n + slow, dual->fast[1], fast);
    copy(history + slow, dual->fast[0], fast);
    if (dual->steady > GIC_R(0.0))
        follow_course(dual, known, dual->next + slow, array_at(dual->self, model->state_offset) + slow);
    if (known == 0)
        copy(link, link + 4 * links, links);
    copy(link + 2 * links, link + links, links);
    copy(link + links, link, links);
    copy(link, link + 3 * links, links);
}

static int plain_dual(const gic_model *model, void *self, gic_real step, int32_t method, int32_t ratio, gic_real steady)
{
    if (ratio == 1 || (ratio > 1 && model->fast_count == 0))
        return plain_step(model, self, step, method);
    /* without a valid ratio there is no fast step to check */
    const int usable = ratio > 0 && ratio <= GIC_RATIOS;
    int status = check_step(model, self, step, usable ? step / (gic_real)ratio : GIC_R(0.0));
    if (status != GIC_OK)
        return status;
    gic_head *head = (gic_head *)self;
    if (!is_method(model, method) || method == GIC_RK4 || !gic_finite(&steady, 1) || steady < GIC_R(0.0) ||
        !takes_options(head, ratio))
        return head->status = GIC_ERROR_ARGUMENT;

    const int same = goes_on(head, step, method, ratio);
    const int32_t known = same ? head->history : 0;
    gic_real *scratch = array_at(self, model->scratch_offset);
    gic_real *input_before = scratch + GIC_SCRATCH(model->slow_count + model->fast_count, 0);
    Dual dual = {model,
                 self,
                 same ? head->start_time : gic_time(self),
                 step,
                 same ? head->steps : 0,
                 ratio,
                 method,
                 steady,
                 scratch,
                 array_at(self, model->link_offset),
                 NULL,
                 {NULL, NULL},
                 array_at(self, model->rate_offset)};
    copy(input_before, array_at(self, model->input_offset), model->input_count);
    head->hold = head->flip;
    status = head->status = known == 2 ? march_dual(&dual) : start_dual(&dual, known);
    if (status != GIC_OK)
        return give_up(model, self, step, status, dual.newest, input_before);
    status = move_on(model, self, step, method, ratio, known < 2 ? known + 1 : 2, dual.next, row(&dual, 0), known < 2);
    if (status != GIC_OK)
        return give_up(model, self, step, status, row(&dual, 0), input_before);
    if (head->history > 0) {
        keep_dual(&dual, known);
        keep_change(model, self, method, step, dual.next);
        if (method >= GIC_IMEX)
            copy(last_rate(&dual), row(&dual, 0), model->slow_count + model->fast_count);
    }
    return GIC_OK;
}

/* ---- controllers: FORMAT.md section 7.4 ------------------------------------------------------------------- */

/* Times that differ by less are the same: relative to the period, and what rounding makes of a time. */
static gic_real same_time(const gic_controller *controller, gic_real time)
{
    const gic_real rounding = sizeof(gic_real) < sizeof(double) ? GIC_R(5e-7) : GIC_R(1e-15);
    return GIC_LIMIT_ROUNDING * controller->period + rounding * absolute(time);
}

/* Sample `number`, or the effect `late` after it. */
static gic_real instant(const gic_controller *controller, gic_real late, gic_real number)
{
    return controller->offset + late + number * controller->period;
}

/* True if the next instant has come. A number that does not belong to the time, since a program has moved it or begins
 * later than at 0, becomes that of the first instant that is not before the time. No step goes over an instant, so one
 * that is past was never due; only the first one may be further away than a period. */
static int has_come(const gic_controller *controller, gic_real late, gic_real time, gic_real *number)
{
    const gic_real same = same_time(controller, time), wait = instant(controller, late, *number) - time;
    if (wait < -same || (wait > controller->period + same && *number > GIC_R(0.0))) {
        const gic_real first = MATH(ceil)((time - same - controller->offset - late) / controller->period);
        *number = first > GIC_R(0.0) ? first : GIC_R(0.0);
    }
    return instant(controller, late, *number) <= time + same;
}

/* The first instant before `end`; `end`: there is none. */
static gic_real next_instant(const gic_model *model, const gic_real *state, gic_real end)
{
    gic_real next = end;
    for (int32_t c = 0; c < model->controller_count; ++c) {
        const gic_controller *controller = &model->controller[c];
        for (int32_t i = -1; i < controller->rule_count; ++i) {
            const gic_rule *rule = i < 0 ? NULL : &controller->rule[i];
            if (rule && rule->effects < 0)
                continue;
            const gic_real at = rule ? instant(controller, rule->late, state[rule->effects])
                                     : instant(controller, GIC_R(0.0), state[controller->samples]);
            if (at < next && at + same_time(controller, at) < end)
                next = at;
        }
    }
    return next;
}

static void take_effect(gic_head *head, gic_real *held, gic_real value)
{
    if (gic_alike(held, &value, 1))
        return;
    *held = value;
    ++head->held_count;
    head->history = 0;
}

/* Values whose delay ends now. Returns the number of controllers to sample. */
static int32_t effects_now(const gic_model *model, void *self, gic_real time)
{
    gic_real *state = array_at(self, model->state_offset);
    int32_t due = 0;
    for (int32_t c = 0; c < model->controller_count; ++c) {
        const gic_controller *controller = &model->controller[c];
        const int sampled = has_come(controller, GIC_R(0.0), time, &state[controller->samples]);
        for (int32_t i = 0; i < controller->rule_count; ++i) {
            const gic_rule *rule = &controller->rule[i];
            gic_real *number = rule->effects < 0 ? NULL : &state[rule->effects];
            if (number ? has_come(controller, rule->late, time, number) : sampled && rule->waiting > 0) {
                take_effect((gic_head *)self, &state[rule->state], state[rule->state + rule->waiting]);
                if (number)
                    *number += GIC_R(1.0);
            }
        }
        due += sampled;
    }
    return due;
}

/* A multiple of the quantum, halves away from zero. */
static gic_real quantized(gic_real value, gic_real quantum)
{
    return quantum > GIC_R(0.0) ? quantum * MATH(round)(value / quantum) : value;
}

/* The new values of a controller, from the outputs of this time. */
static int sample_rules(const gic_model *model, void *self, gic_real time, int32_t c)
{
    gic_head *head = (gic_head *)self;
    const gic_controller *controller = &model->controller[c];
    const gic_real *output = array_at(self, model->output_offset);
    gic_real *state = array_at(self, model->state_offset), *value = array_at(self, model->scratch_offset);
    for (int32_t i = 0; i < controller->rule_count; ++i) {
        const gic_rule *rule = &controller->rule[i];
        value[i] = rule->output < 0 ? state[rule->state] : output[rule->output];
    }
    if (head->controller_function)
        head->controller_function(head->user, head->lane, c, time, output, value);
    for (int32_t i = 0; i < controller->rule_count; ++i) {
        const gic_rule *rule = &controller->rule[i];
        gic_real *held = &state[rule->state], now = quantized(value[i], rule->quantum);
        if (!gic_bounded(&now, 1)) {
            head->grown = rule->state;
            return GIC_ERROR_UNSTABLE;
        }
        for (int32_t k = rule->waiting; k > 1; --k)
            held[k] = held[k - 1];
        if (rule->waiting > 0)
            held[1] = now;
        else
            take_effect(head, held, now);
    }
    state[controller->samples] += GIC_R(1.0);
    return GIC_OK;
}

/* Everything that happens at the present time. On a failure values may have changed. */
static int sample_now(const gic_model *model, void *self)
{
    const gic_real time = gic_time(self), *state = array_at(self, model->state_offset);
    int32_t due = effects_now(model, self, time);
    int status = due ? model->outputs(self) : GIC_OK;
    for (int32_t c = 0; c < model->controller_count && status == GIC_OK && due; ++c) {
        const gic_controller *controller = &model->controller[c];
        const gic_real at = instant(controller, GIC_R(0.0), state[controller->samples]);
        if (at <= time + same_time(controller, time)) {
            status = sample_rules(model, self, time, c);
            --due;
        }
    }
    return status;
}

/* What a step in parts changes of an instance, beside its state and its counts. */
typedef struct Whole {
    Kept kept;
    uint64_t touching;
    int32_t discrete[MOST_DISCRETE];
} Whole;

/* Behind what steps use of the scratch array: state, rate, inputs and outputs meanwhile. */
static void whole_exchange(const gic_model *model, void *self, int back)
{
    const int32_t n = model->slow_count + model->fast_count;
    const struct {
        size_t offset;
        int32_t count;
    } array[] = {{model->state_offset, n},
                 {model->rate_offset, n},
                 {model->input_offset, model->input_count},
                 {model->output_offset, model->output_count}};
    gic_real *kept = array_at(self, model->scratch_offset) + GIC_SCRATCH(n, model->input_count);
    for (size_t i = 0; i < sizeof array / sizeof *array; kept += array[i++].count) {
        gic_real *own = array_at(self, array[i].offset);
        copy(back ? own : kept, back ? kept : own, array[i].count);
    }
}

static Whole whole_begin(const gic_model *model, void *self)
{
    const gic_head *head = (const gic_head *)self;
    Whole whole = {
        {head->start_time, head->step, head->steps, head->method, head->ratio, head->history}, head->touching, {0}};
    whole_exchange(model, self, 0);
    copy_discrete(model, whole.discrete, discrete_of(model, self));
    return whole;
}

static void whole_back(const gic_model *model, void *self, const Whole *whole)
{
    gic_head *head = (gic_head *)self;
    whole_exchange(model, self, 1);
    copy_discrete(model, discrete_of(model, self), whole->discrete);
    head->start_time = whole->kept.start_time;
    head->step = whole->kept.step;
    head->steps = whole->kept.steps;
    head->method = whole->kept.method;
    head->ratio = whole->kept.ratio;
    head->history = whole->kept.history;
    head->touching = whole->touching;
}

int gic_sample(const gic_model *model, void *self, gic_real *next)
{
    gic_head *head = (gic_head *)self;
    int status = model->discrete_count <= MOST_DISCRETE ? GIC_OK : GIC_ERROR_ABI;
    if (status == GIC_OK && model->controller_count > 0) {
        const Whole whole = whole_begin(model, self);
        status = sample_now(model, self);
        if (status != GIC_OK)
            whole_back(model, self, &whole);
    }
    *next = next_instant(model, array_at(self, model->state_offset), GIC_R(1e30));
    return head->status = status;
}

/* To `end` by RK4, ROS2 or ROS3, in parts about as long as fast steps. */
static int part_to(const gic_model *model, void *self, gic_real end, gic_real fast_step, int32_t method)
{
    const gic_real length = end - gic_time(self);
    const int32_t parts = 1 + (int32_t)(GIC_R(0.999) * length / fast_step);
    int status = GIC_OK;
    for (int32_t i = 0; i < parts && status == GIC_OK; ++i)
        status = plain_step(model, self, length / (gic_real)parts, part_method(method));
    if (status == GIC_OK) {
        gic_restart(self, end); /* the time as a product, not as a sum */
        set_inputs(model, self, end);
    }
    return status;
}

/* A step of a model with controllers, ratio 1 or more: in parts by RK4 where instants lie within it. On a failure the
 * instance is as before. */
static int sampled_step(const gic_model *model, void *self, gic_real step, int32_t method, int32_t ratio,
                        gic_real steady)
{
    gic_head *head = (gic_head *)self;
    const int usable = ratio > 0 && ratio <= GIC_RATIOS;
    int status = check_step(model, self, step, usable ? step / (gic_real)ratio : GIC_R(0.0));
    if (status == GIC_OK && (!usable || !is_method(model, method) || !(steady >= GIC_R(0.0))))
        status = head->status = GIC_ERROR_ARGUMENT;
    if (status == GIC_OK && model->discrete_count > MOST_DISCRETE)
        status = head->status = GIC_ERROR_ABI;
    if (status != GIC_OK)
        return status;
    const int same = goes_on(head, step, method, ratio);
    const gic_real start = same ? head->start_time : gic_time(self), *state = array_at(self, model->state_offset);
    const int64_t steps = same ? head->steps : 0;
    const gic_real end = start + (gic_real)(steps + 1) * step;
    const Whole whole = whole_begin(model, self);
    head->parted = 0;
    status = sample_now(model, self);
    int32_t samples = 0;
    for (gic_real next; status == GIC_OK && (next = next_instant(model, state, end)) < end;) {
        head->parted = 1;
        status =
            samples++ < GIC_SAMPLES ? part_to(model, self, next, step / (gic_real)ratio, method) : GIC_ERROR_EVENTS;
        if (status == GIC_OK)
            status = sample_now(model, self);
    }
    if (status == GIC_OK && head->parted) {
        status = part_to(model, self, end, step / (gic_real)ratio, method);
        head->start_time = start;
        head->steps = steps + 1;
        head->step = step;
        head->method = method;
        head->ratio = ratio;
    } else if (status == GIC_OK) {
        status = plain_dual(model, self, step, method, ratio, steady);
    }
    if (status != GIC_OK)
        whole_back(model, self, &whole);
    return head->status = status;
}

int gic_step(const gic_model *model, void *self, gic_real step, int32_t method)
{
    return model->controller_count > 0 ? sampled_step(model, self, step, method, 1, GIC_R(0.0))
                                       : plain_step(model, self, step, method);
}

int gic_step_dual(const gic_model *model, void *self, gic_real step, int32_t ratio)
{
    return gic_step_steady(model, self, step, ratio, GIC_R(0.0));
}

int gic_step_steady(const gic_model *model, void *self, gic_real step, int32_t ratio, gic_real steady)
{
    return gic_step_dual_by(model, self, step, GIC_AB3, ratio, steady);
}

int gic_step_dual_by(const gic_model *model, void *self, gic_real step, int32_t method, int32_t ratio, gic_real steady)
{
    return model->controller_count > 0 ? sampled_step(model, self, step, method, ratio, steady)
                                       : plain_dual(model, self, step, method, ratio, steady);
}

const char *gic_event_name(const gic_model *model, const void *self)
{
    const int32_t event = ((const gic_head *)self)->event - 1, gear = event - model->contact_count;
    if (event < 0)
        return NULL;
    return gear < 0 ? model->contacts->name[event] : gear < model->discrete_count ? model->discrete[gear].name : NULL;
}

/* ---- orientation ---------------------------------------------------------------------------------------- */

int gic_orientation(const gic_real given[4], int32_t *dependent, int64_t *switches, gic_real e[4])
{
    /* a stage of an integrator changes the length by (step * angular velocity / 2)^2, which must be accepted; a
     * caller's unnormalized parameters must not */
    const gic_real tolerance = GIC_R(0.01);
    const gic_real excess =
        given[0] * given[0] + given[1] * given[1] + given[2] * given[2] + given[3] * given[3] - GIC_R(1.0);
    if (!GIC_FINITE(given, 4) || excess > tolerance || excess < -tolerance)
        return GIC_ERROR_ORIENTATION;

    /* above 1.01 / 2.21 no other can be a tenth larger, which is the usual case */
    int32_t now = *dependent;
    if (now < 0 || now > 3 || !(given[now] * given[now] > GIC_R(0.46))) {
        int32_t largest = 0;
        for (int32_t i = 1; i < 4; ++i)
            if (given[i] * given[i] > given[largest] * given[largest])
                largest = i;
        if (now < 0 || now > 3) {
            *dependent = now = largest;
        } else if (given[largest] * given[largest] > GIC_R(1.21) * given[now] * given[now]) {
            *dependent = now = largest;
            ++*switches;
        }
    }

    /* the dependent one is at least 1/2.2 in magnitude, so the root is far from zero and keeps its sign */
    gic_real rest = GIC_R(1.0);
    for (int32_t i = 0; i < 4; ++i)
        rest -= i == now ? GIC_R(0.0) : given[i] * given[i];
    const gic_real root = MATH(sqrt)(rest), signed_root = given[now] < GIC_R(0.0) ? -root : root;
    /* not indexed by a number that is known late: readers would wait for the store */
    for (int32_t i = 0; i < 4; ++i)
        e[i] = i == now ? signed_root : given[i];
    return GIC_OK;
}

int gic_rates_match(const gic_model *model, const gic_real *state, const gic_real e[4], const gic_real *rate)
{
#ifdef GIC_FLOAT
    const gic_real rounding = GIC_R(1e-5);
#else
    const gic_real rounding = GIC_R(1e-13);
#endif
    const int32_t half = (model->slow_count - model->free_base) / 2; /* from a coordinate to its rate */
    gic_real wrong = GIC_R(0.0), size = GIC_R(0.0);
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const int32_t at = model->coordinate_state[c];
        if (at >= 0 && rate[at] != state[at + half])
            return 0;
    }
    if (!model->free_base)
        return 1;
    const gic_real *velocity = state + half + 1, *w = velocity + 3;
    /* p' = 1/2 p (0, omega), a product of quaternions, omega in the base frame */
    const gic_real turn[4] = {-e[1] * w[0] - e[2] * w[1] - e[3] * w[2], e[0] * w[0] + e[2] * w[2] - e[3] * w[1],
                              e[0] * w[1] + e[3] * w[0] - e[1] * w[2], e[0] * w[2] + e[1] * w[1] - e[2] * w[0]};
    for (int32_t i = 0; i < 3; ++i) {
        if (rate[i] != velocity[i])
            return 0;
        size += absolute(w[i]);
    }
    for (int32_t i = 0; i < 4; ++i)
        wrong += absolute(rate[3 + i] - GIC_R(0.5) * turn[i]);
    return wrong <= rounding * size;
}

/* ---- roads ---------------------------------------------------------------------------------------------- */

#ifdef GIC_FLOAT
#define ROAD_REACH GIC_R(1e-2)
#else
#define ROAD_REACH GIC_R(1e-3)
#endif

/* From a number at -2, -1, 1 and 2 reaches. */
static gic_real central(const gic_real side[4])
{
    return (side[0] - side[3] + GIC_R(8.0) * (side[2] - side[1])) / (GIC_R(12.0) * ROAD_REACH);
}

static gic_real reach_of(int32_t i)
{
    return (gic_real)(i < 2 ? i - 2 : i - 1) * ROAD_REACH;
}

void gic_road_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    out[0] = out[1] = out[2] = GIC_R(0.0);
    if (road && road->bend) {
        road->bend(road, lane, time, x, y, out);
    } else if (road) {
        gic_real along[2][4], across[4];
        for (int32_t i = 0; i < 4; ++i) {
            gic_real beside[3];
            road->height(road, lane, time, x + reach_of(i), y, beside);
            along[0][i] = beside[1];
            along[1][i] = beside[2];
            road->height(road, lane, time, x, y + reach_of(i), beside);
            across[i] = beside[2];
        }
        out[0] = central(along[0]);
        out[1] = central(along[1]);
        out[2] = central(across);
    }
}

void gic_road_friction_slope(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[2])
{
    out[0] = out[1] = GIC_R(0.0);
    if (road && road->friction && road->friction_slope) {
        road->friction_slope(road, lane, time, x, y, out);
    } else if (road && road->friction) {
        gic_real along[4], across[4];
        for (int32_t i = 0; i < 4; ++i) {
            along[i] = road->friction(road, lane, time, x + reach_of(i), y);
            across[i] = road->friction(road, lane, time, x, y + reach_of(i));
        }
        out[0] = central(along);
        out[1] = central(across);
    }
}

/* ---- tables and inputs ---------------------------------------------------------------------------------- */

gic_real gic_table_value(const gic_table *table, gic_real x)
{
    int32_t low = 0, high = table->count - 1;
    if (x <= table->x[0])
        return table->y[0] + (table->onward ? (x - table->x[0]) * table->slope[0] : GIC_R(0.0));
    if (x >= table->x[high])
        return table->y[high] + (table->onward ? (x - table->x[high]) * table->slope[high] : GIC_R(0.0));
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (x < table->x[middle])
            high = middle;
        else
            low = middle;
    }
    {
        const gic_real h = table->x[high] - table->x[low], t = (x - table->x[low]) / h, u = GIC_R(1.0) - t;
        if (!table->cubic)
            return table->y[low] + t * (table->y[high] - table->y[low]);
        return (GIC_R(1.0) + GIC_R(2.0) * t) * u * u * table->y[low] + t * u * u * h * table->slope[low] +
               t * t * (GIC_R(3.0) - GIC_R(2.0) * t) * table->y[high] - t * t * u * h * table->slope[high];
    }
}

void gic_quintic(gic_real time, gic_real t0, gic_real t1, gic_real y0, gic_real y1, gic_real out[3])
{
    out[1] = out[2] = GIC_R(0.0);
    if (time <= t0 || time >= t1) {
        out[0] = time <= t0 ? y0 : y1;
        return;
    }
    /* s^3 (10 - 15 s + 6 s^2) and its derivatives 30 s^2 (1 - s)^2, 60 s (1 - s) (1 - 2 s) */
    const gic_real width = t1 - t0, s = (time - t0) / width, back = GIC_R(1.0) - s, move = y1 - y0;
    out[0] = y0 + move * s * s * s * (GIC_R(10.0) + s * (GIC_R(6.0) * s - GIC_R(15.0)));
    out[1] = move * GIC_R(30.0) * s * s * back * back / width;
    out[2] = move * GIC_R(60.0) * s * back * (back - s) / (width * width);
}
