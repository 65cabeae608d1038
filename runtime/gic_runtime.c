/* SPDX-License-Identifier: MIT
 *
 * gic_runtime: fixed-step integrators, orientation, roads and inputs for generated models. The same source is
 * compiled for either number type, so constants go through GIC_R and functions of <math.h> through MATH. */
#include "gic_runtime.h"

#include <math.h>

#ifdef GIC_FLOAT
#define MATH(name) name##f
#else
#define MATH(name) name
#endif

#define TWO_PI GIC_R(6.283185307179586476925286766559)

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

/* Numbers by their bits: a comparison with itself or with infinity would be optimized away under -ffast-math. */
int gic_finite(const gic_real *x, int32_t count)
{
#ifdef GIC_FLOAT
    typedef uint32_t bits_type;
    const bits_type exponent = UINT32_C(0x7f800000);
#else
    typedef uint64_t bits_type;
    const bits_type exponent = UINT64_C(0x7ff0000000000000);
#endif
    for (int32_t i = 0; i < count; ++i) {
        bits_type bits = 0;
        const unsigned char *from = (const unsigned char *)&x[i];
        unsigned char *to = (unsigned char *)&bits;
        for (size_t k = 0; k < sizeof bits; ++k)
            to[k] = from[k];
        if ((bits & exponent) == exponent)
            return 0;
    }
    return 1;
}

/* ---- integrators ---------------------------------------------------------------------------------------- */

static gic_real *array_at(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

static void copy(gic_real *to, const gic_real *from, int32_t count)
{
    for (int32_t i = 0; i < count; ++i)
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
    head->history = 0;
}

/* The right-hand side with the inputs of its own time. */
static int evaluate(const gic_model *model, void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    gic_head *head = (gic_head *)self;
    if (head->input_function)
        head->input_function(head->user, head->lane, time, array_at(self, model->input_offset));
    return model->rhs(self, time, state, rate);
}

/* The state one step on, into `next`, and the rate at the step's start, into `first`. `work` has room for two states;
 * `past` holds the two rates before the step, or is NULL: then RK4. */
static int advance(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *past,
                   gic_real *first, gic_real *next, gic_real *work)
{
    const int32_t n = model->slow_count + model->fast_count;
    const gic_real *state = array_at(self, model->state_offset);
    int status = evaluate(model, self, time, state, first);
    if (status != GIC_OK)
        return status;

    if (past) {
        const gic_real weight = step / GIC_R(12.0);
        for (int32_t i = 0; i < n; ++i)
            next[i] = state[i] + weight * (GIC_R(23.0) * first[i] - GIC_R(16.0) * past[i] + GIC_R(5.0) * past[n + i]);
    } else {
        /* `next` gathers the weighted slopes, so that the state is added only once */
        gic_real *stage = work, *slope = work + n;
        copy(next, first, n);
        copy(slope, first, n);
        for (int k = 1; k <= 3; ++k) {
            const gic_real reach = k < 3 ? GIC_R(0.5) * step : step;
            const gic_real weight = k < 3 ? GIC_R(2.0) : GIC_R(1.0);
            for (int32_t i = 0; i < n; ++i)
                stage[i] = state[i] + reach * slope[i];
            status = evaluate(model, self, time + reach, stage, slope);
            if (status != GIC_OK)
                return status;
            for (int32_t i = 0; i < n; ++i)
                next[i] += weight * slope[i];
        }
        for (int32_t i = 0; i < n; ++i)
            next[i] = state[i] + step / GIC_R(6.0) * next[i];
    }

    ((gic_head *)self)->subset = -1; /* what follows is about the whole state */
    if (!gic_finite(next, n))
        return GIC_ERROR_RESULT;
    status = model->settle(self, next);
    if (status != GIC_OK)
        return status;
    return gic_finite(next, n) ? GIC_OK : GIC_ERROR_RESULT;
}

int gic_step(const gic_model *model, void *self, gic_real step, int32_t method)
{
    if (model->abi_version != GIC_ABI_VERSION || model->real_size != sizeof(gic_real))
        return GIC_ERROR_ABI;
    gic_head *head = (gic_head *)self;
    const gic_real time = gic_time(self);
    head->subset = -1;
    if (!gic_finite(&step, 1) || !gic_finite(&time, 1) || time + step <= time ||
        (method != GIC_AB3 && method != GIC_RK4))
        return head->status = GIC_ERROR_ARGUMENT;

    const int32_t n = model->slow_count + model->fast_count;
    const int same = step == head->step && method == head->method;
    const int32_t known = same && method == GIC_AB3 ? head->history : 0;
    gic_real *history = array_at(self, model->history_offset);
    gic_real *input = array_at(self, model->input_offset);
    gic_real *first = array_at(self, model->scratch_offset), *next = first + n, *work = next + n;
    gic_real *input_before = work + 2 * n;
    copy(input_before, input, model->input_count);

    const int status = advance(model, self, time, step, known == 2 ? history : NULL, first, next, work);
    head->status = status;
    if (status != GIC_OK) {
        copy(input, input_before, model->input_count);
        return status;
    }
    if (!same) {
        head->start_time = time;
        head->steps = 0;
        head->step = step;
        head->method = method;
    }
    ++head->steps;
    copy(array_at(self, model->state_offset), next, n);
    copy(array_at(self, model->rate_offset), first, n);
    head->history = 0;
    if (method == GIC_AB3) {
        copy(history + n, history, n);
        copy(history, first, n);
        head->history = known < 2 ? known + 1 : 2;
    }
    if (head->input_function)
        head->input_function(head->user, head->lane, gic_time(self), input);
    return GIC_OK;
}

/* ---- orientation ---------------------------------------------------------------------------------------- */

int gic_orientation(const gic_real given[4], int32_t *dependent, int64_t *switches, gic_real e[4])
{
    /* a stage of an integrator leaves unit length by (step * angular velocity / 2)^2, which must pass; what a
     * caller forgot to normalize must not */
    const gic_real tolerance = GIC_R(0.01);
    const gic_real excess = given[0] * given[0] + given[1] * given[1] + given[2] * given[2] + given[3] * given[3] -
                            GIC_R(1.0);
    if (!gic_finite(given, 4) || excess > tolerance || excess < -tolerance)
        return GIC_ERROR_ORIENTATION;

    int32_t largest = 0;
    for (int32_t i = 1; i < 4; ++i)
        if (given[i] * given[i] > given[largest] * given[largest])
            largest = i;
    const int32_t now = *dependent;
    if (now < 0 || now > 3) {
        *dependent = largest;
    } else if (given[largest] * given[largest] > GIC_R(1.21) * given[now] * given[now]) {
        *dependent = largest;
        ++*switches;
    }

    /* the dependent one is at least 1/2.2 in magnitude, so the root is far from zero and keeps its sign */
    gic_real rest = GIC_R(1.0);
    for (int32_t i = 0; i < 4; ++i) {
        e[i] = given[i];
        if (i != *dependent)
            rest -= given[i] * given[i];
    }
    const gic_real root = MATH(sqrt)(rest);
    e[*dependent] = given[*dependent] < GIC_R(0.0) ? -root : root;
    return GIC_OK;
}

/* ---- roads ---------------------------------------------------------------------------------------------- */

void gic_plane_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_plane *plane = (const gic_road_plane *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = plane->z0 + plane->sx * x + plane->sy * y;
    out[1] = plane->sx;
    out[2] = plane->sy;
}

void gic_bumps_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_bumps *bumps = (const gic_road_bumps *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    for (int32_t i = 0; i < bumps->count; ++i) {
        const gic_bump *bump = &bumps->bump[i];
        const gic_real along = x - bump->x;
        if (along <= GIC_R(0.0) || along >= bump->length || y < bump->y_low || y > bump->y_high)
            continue;
        const gic_real wave = TWO_PI / bump->length;
        out[0] += GIC_R(0.5) * bump->height * (GIC_R(1.0) - MATH(cos)(wave * along));
        out[1] += GIC_R(0.5) * bump->height * wave * MATH(sin)(wave * along);
    }
}

void gic_sine_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_sine *sine = (const gic_road_sine *)(const void *)road;
    (void)lane;
    (void)time;
    const gic_real wave = TWO_PI / sine->wavelength;
    const gic_real phase = wave * (x - sine->x0) + sine->phase_per_y * y;
    const gic_real slope = sine->amplitude * MATH(cos)(phase);
    out[0] = sine->amplitude * MATH(sin)(phase);
    out[1] = slope * wave;
    out[2] = slope * sine->phase_per_y;
}

void gic_table_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_table *table = (const gic_road_table *)(const void *)road;
    const gic_real *at = table->x;
    const gic_real *height = y > GIC_R(0.0) ? table->left : table->right;
    const gic_real *slope = y > GIC_R(0.0) ? table->slope_left : table->slope_right;
    int32_t low = 0, high = table->count - 1;
    (void)lane;
    (void)time;
    out[1] = out[2] = GIC_R(0.0);
    if (x <= at[low] || x >= at[high]) {
        out[0] = height[x <= at[low] ? low : high];
        return;
    }
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (x < at[middle])
            high = middle;
        else
            low = middle;
    }
    /* cubic Hermite: h0 + s (d0 + s (c + s b)), s from 0 to 1 */
    const gic_real width = at[high] - at[low], s = (x - at[low]) / width;
    const gic_real rise = height[high] - height[low];
    const gic_real d0 = width * slope[low], d1 = width * slope[high];
    const gic_real c = GIC_R(3.0) * rise - GIC_R(2.0) * d0 - d1, b = d0 + d1 - GIC_R(2.0) * rise;
    out[0] = height[low] + s * (d0 + s * (c + s * b));
    out[1] = (d0 + s * (GIC_R(2.0) * c + s * GIC_R(3.0) * b)) / width;
}

/* Slopes that keep every piece monotone: zero at extrema and plateaus, else the weighted harmonic mean of the chords
 * (Fritsch and Butland's form of Fritsch and Carlson's condition). */
static void table_slopes(const gic_real *x, const gic_real *h, gic_real *slope, int32_t count)
{
    slope[0] = slope[count - 1] = GIC_R(0.0);
    for (int32_t i = 1; i < count - 1; ++i) {
        const gic_real before = x[i] - x[i - 1], after = x[i + 1] - x[i];
        const gic_real chord_before = (h[i] - h[i - 1]) / before, chord_after = (h[i + 1] - h[i]) / after;
        const gic_real w_before = GIC_R(2.0) * after + before, w_after = after + GIC_R(2.0) * before;
        slope[i] = chord_before * chord_after > GIC_R(0.0)
                       ? (w_before + w_after) / (w_before / chord_before + w_after / chord_after)
                       : GIC_R(0.0);
    }
}

int gic_road_table_setup(gic_road_table *road)
{
    if (road->count < 2 || !gic_finite(road->x, road->count))
        return GIC_ERROR_ARGUMENT;
    for (int32_t i = 1; i < road->count; ++i)
        if (road->x[i] <= road->x[i - 1])
            return GIC_ERROR_ARGUMENT;
    table_slopes(road->x, road->left, road->slope_left, road->count);
    table_slopes(road->x, road->right, road->slope_right, road->count);
    return GIC_OK;
}

/* ---- inputs --------------------------------------------------------------------------------------------- */

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
