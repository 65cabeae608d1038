/* SPDX-License-Identifier: MIT
 *
 * gic_runtime: fixed-step integrators, orientation, tables and inputs for generated models. The same source is
 * compiled for either number type, so constants go through GIC_R and functions of <math.h> through MATH. */
#include "gic_runtime.h"

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

/* By four numbers, all read before one is written: compilers take vectors, for nothing can overlap within them. */
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
    head->history = 0;
}

static void set_inputs(const gic_model *model, void *self, gic_real time)
{
    gic_head *head = (gic_head *)self;
    if (head->input_function)
        head->input_function(head->user, head->lane, time, array_at(self, model->input_offset));
}

/* The right-hand side with the inputs of its own time. */
static int evaluate(const gic_model *model, void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    set_inputs(model, self, time);
    return model->rhs(self, time, state, rate);
}

/* AB3 for `count` numbers: one step on from `from`, which `next` may be, with the rates there and at the two steps
 * before. */
static void adams_bashforth(int32_t count, gic_real step, const gic_real *from, const gic_real *rate,
                            const gic_real *past, const gic_real *older, gic_real *next)
{
    const gic_real weight = step / GIC_R(12.0);
    int32_t i = 0;
    for (; i + 4 <= count; i += 4) { /* by four, as above */
        const gic_real *r = rate + i, *p = past + i, *o = older + i, *f = from + i;
        const gic_real a = f[0] + weight * (GIC_R(23.0) * r[0] - GIC_R(16.0) * p[0] + GIC_R(5.0) * o[0]);
        const gic_real b = f[1] + weight * (GIC_R(23.0) * r[1] - GIC_R(16.0) * p[1] + GIC_R(5.0) * o[1]);
        const gic_real c = f[2] + weight * (GIC_R(23.0) * r[2] - GIC_R(16.0) * p[2] + GIC_R(5.0) * o[2]);
        const gic_real d = f[3] + weight * (GIC_R(23.0) * r[3] - GIC_R(16.0) * p[3] + GIC_R(5.0) * o[3]);
        next[i] = a;
        next[i + 1] = b;
        next[i + 2] = c;
        next[i + 3] = d;
    }
    for (; i < count; ++i)
        next[i] = from[i] + weight * (GIC_R(23.0) * rate[i] - GIC_R(16.0) * past[i] + GIC_R(5.0) * older[i]);
}

/* Where a number of a state is out of bounds, or GIC_ERROR_RESULT where none is. */
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
    /* `next` gathers the weighted slopes, so that the state is added only once */
    gic_real *stage = work, *slope = work + n;
    copy(next, rate, n);
    copy(slope, rate, n);
    for (int k = 1; k <= 3; ++k) {
        const gic_real reach = k < 3 ? GIC_R(0.5) * step : step;
        const gic_real weight = k < 3 ? GIC_R(2.0) : GIC_R(1.0);
        for (int32_t i = 0; i < n; ++i)
            stage[i] = from[i] + reach * slope[i];
        const int status = evaluate(model, self, time + reach, stage, slope);
        /* what the step made of it is no state: give_up() says so, unless it knows of a coordinate that went too far */
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

/* What makes the numbers that an integrator found a state; it looks at bounds itself, and bounded ones stay so. */
static int settle(const gic_model *model, void *self, gic_real *next)
{
    const int32_t n = model->slow_count + model->fast_count;
    ((gic_head *)self)->subset = -1; /* what follows is about the whole state */
    const int status = model->settle(self, next);
    return status == GIC_ERROR_INPUT && !gic_bounded(next, n) ? out_of_bounds(self, next, 0, n) : status;
}

static gic_real absolute(gic_real x)
{
    return x < GIC_R(0.0) ? -x : x;
}

int gic_blame(const gic_model *model, gic_real step, const gic_real *rate, int status, int32_t *grown)
{
    const int32_t half = (model->slow_count - model->free_base) / 2; /* from a coordinate to its rate */
    gic_real farthest = GIC_R(1.0);
    int32_t coordinates = 0;
    if (status != GIC_ERROR_INPUT && status != GIC_ERROR_ORIENTATION && status != GIC_ERROR_REACH &&
        status != GIC_ERROR_NEWTON && status != GIC_ERROR_SINGULAR && status != GIC_ERROR_MASS &&
        status != GIC_ERROR_RESULT)
        return status;
    for (int32_t c = 0; c < model->coordinate_count; ++c)
        coordinates += model->coordinate_state[c] >= 0;
    if (model->slow_count != 2 * coordinates + (model->free_base ? 13 : 0))
        return status; /* a host's engine that integrates something else */
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
    /* Euler parameters move at half the angular velocity, which is named, for it is what grows */
    for (int32_t i = 0; model->free_base && i < 3; ++i) {
        const gic_real moved = GIC_R(2.0) * step * absolute(rate[4 + i]);
        if (moved > farthest) {
            farthest = moved;
            *grown = 10 + coordinates + i;
        }
    }
    return farthest > GIC_R(1.0) ? GIC_ERROR_UNSTABLE : status;
}

/* The state one step on from `from`, into `next`, and the rate at the step's start, into `rate`, which *newest becomes
 * once it is there. `past` holds the two rates before the step, or is NULL: then RK4. */
static int advance(const gic_model *model, void *self, gic_real time, gic_real step, const gic_real *from,
                   const gic_real *past, gic_real *rate, gic_real *next, gic_real *work, const gic_real **newest)
{
    const int32_t n = model->slow_count + model->fast_count;
    int status = evaluate(model, self, time, from, rate);
    if (status != GIC_OK)
        return status;
    *newest = rate;
    if (past)
        adams_bashforth(n, step, from, rate, past, past + n, next);
    else
        status = runge_kutta(model, self, time, step, from, rate, next, work);
    return status == GIC_OK ? settle(model, self, next) : status;
}

/* Can a step of this length be tried? `part` is the smallest that time has to move by. */
static int check_step(const gic_model *model, void *self, gic_real step, gic_real part)
{
    if (model->abi_version != GIC_ABI_VERSION || model->real_size != sizeof(gic_real))
        return GIC_ERROR_ABI;
    gic_head *head = (gic_head *)self;
    const gic_real time = gic_time(self);
    head->subset = head->grown = -1;
    if (!gic_finite(&step, 1) || !gic_finite(&time, 1) || time + part <= time)
        return head->status = GIC_ERROR_ARGUMENT;
    head->ahead = step;
    return GIC_OK;
}

/* Does a step go on from the one before? Then its history counts. */
static int goes_on(const gic_head *head, gic_real step, int32_t method, int32_t ratio)
{
    return step == head->step && method == head->method && ratio == head->ratio;
}

/* A step fails with `status`: the instance is as before, that Newton's method starts from among it. newest: rate known
 * last. */
static int give_up(const gic_model *model, void *self, gic_real step, int status, const gic_real *newest,
                   const gic_real *input_before)
{
    gic_head *head = (gic_head *)self;
    const gic_real *state = array_at(self, model->state_offset);
    const int32_t n = model->slow_count + model->fast_count, half = (model->slow_count - model->free_base) / 2;
    gic_real *rate = array_at(self, model->scratch_offset);
    if (newest != rate)
        copy(rate, newest, n);
    /* of coordinates, the state knows theirs */
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const int32_t at = model->coordinate_state[c];
        if (at >= 0 && at + half < n && absolute(state[at + half]) > absolute(rate[at]))
            rate[at] = state[at + half];
    }
    head->flip = head->hold;
    head->hold = -1;
    copy(array_at(self, model->input_offset), input_before, model->input_count);
    /* a state that is none was not made by a step */
    if (gic_bounded(state, n))
        status = gic_blame(model, step, rate, status, &head->grown);
    return head->status = status == GIC_ERROR_INPUT && head->grown >= 0 ? GIC_ERROR_UNSTABLE : status;
}

/* At the end of a step, with its state there. */
static void arrive(const gic_model *model, void *self)
{
    gic_head *head = (gic_head *)self;
    ++head->steps;
    head->hold = -1;
    set_inputs(model, self, gic_time(self));
    if (model->shift)
        (void)model->shift(self);
}

/* A step was made: the instance moves on, with `history` rates kept. */
static void move_on(const gic_model *model, void *self, gic_real step, int32_t method, int32_t ratio, int32_t history,
                    const gic_real *next, const gic_real *rate)
{
    gic_head *head = (gic_head *)self;
    const int32_t n = model->slow_count + model->fast_count;
    if (!goes_on(head, step, method, ratio)) {
        head->start_time = gic_time(self);
        head->steps = 0;
        head->step = step;
        head->method = method;
        head->ratio = ratio;
    }
    head->history = history;
    copy(array_at(self, model->state_offset), next, n);
    copy(array_at(self, model->rate_offset), rate, n);
    arrive(model, self);
}

/* A step of AB3 that goes on from two others, by the model's own function: 1 when it was made. One that fails leaves
 * the instance as it was, but for what counts the work, and is made again by the functions above, which find out why.
 */
static int march(const gic_model *model, void *self, gic_real step)
{
    gic_head *head = (gic_head *)self;
    const gic_real time = gic_time(self);
    gic_real *input = array_at(self, model->input_offset);
    gic_real *input_before =
        array_at(self, model->scratch_offset) + GIC_SCRATCH(model->slow_count + model->fast_count, 0);
    if (!model->march || model->abi_version != GIC_ABI_VERSION || model->real_size != sizeof(gic_real) ||
        !(time + step > time))
        return 0;
    const int64_t rhs_count = head->rhs_count, newton_count = head->newton_count, late_count = head->late_count,
                  correction_count = head->correction_count, kept_count = head->kept_count, air_count = head->air_count;
    head->grown = -1;
    head->ahead = step;
    head->hold = head->flip;
    if (head->input_function) {
        copy(input_before, input, model->input_count);
        set_inputs(model, self, time);
    }
    if (model->march(self, time) == GIC_OK) {
        arrive(model, self);
        return 1;
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

int gic_step(const gic_model *model, void *self, gic_real step, int32_t method)
{
    gic_head *head = (gic_head *)self;
    if (method == GIC_AB3 && goes_on(head, step, method, 1) && head->history == 2 && march(model, self, step))
        return GIC_OK;
    int status = check_step(model, self, step, step);
    if (status != GIC_OK)
        return status;
    if (method != GIC_AB3 && method != GIC_RK4)
        return head->status = GIC_ERROR_ARGUMENT;

    const int32_t n = model->slow_count + model->fast_count;
    const int32_t known = goes_on(head, step, method, 1) && method == GIC_AB3 ? head->history : 0;
    gic_real *history = array_at(self, model->history_offset);
    gic_real *rate = array_at(self, model->scratch_offset), *next = rate + n, *work = next + n;
    gic_real *input_before = work + 2 * n;
    const gic_real *newest = array_at(self, model->rate_offset);
    copy(input_before, array_at(self, model->input_offset), model->input_count);
    head->hold = head->flip;
    status = head->status = advance(model, self, gic_time(self), step, array_at(self, model->state_offset),
                                    known == 2 ? history : NULL, rate, next, work, &newest);
    if (status != GIC_OK)
        return give_up(model, self, step, status, newest, input_before);
    if (method == GIC_AB3) {
        copy(history + n, history, n);
        copy(history, rate, n);
    }
    move_on(model, self, step, method, 1, method == GIC_RK4 ? 0 : known < 2 ? known + 1 : 2, next, rate);
    return GIC_OK;
}

/* ---- dual rate -------------------------------------------------------------------------------------------- */

/* A step of gic_step_dual in the making. */
typedef struct Dual {
    const gic_model *model;
    void *self;
    gic_real start, step; /* time is start + steps * step, whichever way the head counts so far */
    int64_t steps;
    int32_t ratio;
    gic_real steady;   /* of gic_step_steady */
    gic_real *scratch; /* rows of a state: 0 the rate at the start, 1 and 2 states, 3 to 6 what the method needs */
    gic_real *link;    /* rows 0 to 2: at this slow step and the two before; 3 at the next; 4 at a fast step */
    const gic_real *next, *fast[2]; /* results: the state; rates of the fast states at the last two fast steps */
    const gic_real *newest;         /* rate of all states known last */
} Dual;

static gic_real *row(const Dual *dual, int32_t i)
{
    return dual->scratch + i * (dual->model->slow_count + dual->model->fast_count);
}

/* When fast step k from 0 to `ratio` begins: from integers, so that no error accumulates. */
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

/* The links at the beginning of fast step k: cubic through the four rows. Differences are weighted, so that what stays
 * the same stays the same to the last bit. */
static void interpolate(const Dual *dual, int32_t k, gic_real *link)
{
    const int32_t count = dual->model->link_count;
    const gic_real *now = dual->link, *before = now + count, *older = before + count, *next = older + count;
    const gic_real s = (gic_real)k / (gic_real)dual->ratio, half = GIC_R(0.5) * s, sixth = s / GIC_R(6.0);
    const gic_real of_next = sixth * (s + GIC_R(1.0)) * (s + GIC_R(2.0));
    const gic_real of_before = half * (s - GIC_R(1.0)) * (s + GIC_R(2.0));
    const gic_real of_older = sixth * (GIC_R(1.0) - s) * (s + GIC_R(1.0));
    for (int32_t i = 0; i < count; ++i)
        link[i] =
            now[i] + of_next * (next[i] - now[i]) + of_before * (before[i] - now[i]) + of_older * (older[i] - now[i]);
}

/* A step without history: RK4 of everything at fast steps. */
static int start_dual(Dual *dual, int32_t known)
{
    const gic_model *model = dual->model;
    const gic_real *from = array_at(dual->self, model->state_offset);
    gic_real *link = dual->link;
    int status = known == 0 ? link_at(dual, 0, from, link + 4 * model->link_count) : GIC_OK;
    for (int32_t k = 0; k < dual->ratio && status == GIC_OK; ++k) {
        gic_real *rate = row(dual, k == 0 ? 0 : 5 + k % 2), *next = row(dual, 1 + k % 2);
        status = advance(model, dual->self, moment(dual, k), dual->step / (gic_real)dual->ratio, from, NULL, rate, next,
                         row(dual, 3), &dual->newest);
        dual->fast[1] = dual->fast[0];
        dual->fast[0] = rate + model->slow_count;
        from = next;
    }
    dual->next = from;
    return status == GIC_OK ? link_at(dual, dual->ratio, from, link + 3 * model->link_count) : status;
}

/* The course of the fast states: their rates as they were on average of late. */
static gic_real *course(const Dual *dual)
{
    const gic_model *model = dual->model;
    return array_at(dual->self, model->history_offset) + 2 * (model->slow_count + model->fast_count);
}

/* Do the fast states keep their course? rate: theirs at the start of this step. */
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

/* A step on course. What rates differ from it acts for a fast step only, which is short enough for the fast states to
 * be stable; rates: room for those that this makes in all. */
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

/* A step with history: one of AB3 for the slow states, then `ratio` of AB3 for the fast ones. */
static int march_dual(Dual *dual)
{
    const gic_model *model = dual->model;
    const int32_t slow = model->slow_count, n = slow + model->fast_count;
    const gic_real *state = array_at(dual->self, model->state_offset);
    const gic_real *history = array_at(dual->self, model->history_offset);
    gic_real *rate = row(dual, 0), *next = row(dual, 1), *fast = next + slow;
    gic_real *link = dual->link + 4 * model->link_count;
    int status = evaluate(model, dual->self, moment(dual, 0), state, rate);
    if (status != GIC_OK)
        return status;
    dual->newest = rate;
    adams_bashforth(slow, dual->step, state, rate, history, history + n, next);
    copy(fast, state + slow, model->fast_count);
    status = settle(model, dual->self, next);
    if (status == GIC_OK)
        status = link_at(dual, dual->ratio, next, dual->link + 3 * model->link_count);
    if (status != GIC_OK)
        return status;

    dual->next = next;
    dual->fast[0] = history + slow;
    dual->fast[1] = history + n + slow;
    if (keeps_course(dual, fast, rate + slow))
        return stay_on_course(dual, fast, rate + slow, row(dual, 3));
    for (int32_t k = 0; k < dual->ratio; ++k) {
        gic_real *now = k == 0 ? rate + slow : row(dual, 3 + k % 3);
        if (k > 0) {
            const gic_real time = moment(dual, k);
            set_inputs(model, dual->self, time);
            interpolate(dual, k, link);
            ++((gic_head *)dual->self)->fast_count;
            status = model->fast(dual->self, time, link, fast, now);
            if (status != GIC_OK)
                return status;
        }
        adams_bashforth(model->fast_count, dual->step / (gic_real)dual->ratio, fast, now, dual->fast[0], dual->fast[1],
                        fast);
        if (!gic_bounded(fast, model->fast_count))
            return out_of_bounds(dual->self, fast, slow, n);
        dual->fast[1] = dual->fast[0];
        dual->fast[0] = now;
    }
    return GIC_OK;
}

/* After a step of the fast states from `before` to `after`: the course is a mean over some `ratio` steps. */
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
    copy(history + n + slow, dual->fast[1], fast);
    copy(history + slow, dual->fast[0], fast);
    if (dual->steady > GIC_R(0.0))
        follow_course(dual, known, array_at(dual->self, model->state_offset) + slow, dual->next + slow);
    if (known == 0)
        copy(link, link + 4 * links, links);
    copy(link + 2 * links, link + links, links);
    copy(link + links, link, links);
    copy(link, link + 3 * links, links);
}

int gic_step_dual(const gic_model *model, void *self, gic_real step, int32_t ratio)
{
    return gic_step_steady(model, self, step, ratio, GIC_R(0.0));
}

int gic_step_steady(const gic_model *model, void *self, gic_real step, int32_t ratio, gic_real steady)
{
    if (ratio == 1 || (ratio > 1 && model->fast_count == 0))
        return gic_step(model, self, step, GIC_AB3);
    /* without a ratio there is no fast step that time could move by */
    const int usable = ratio > 0 && ratio <= GIC_RATIOS;
    int status = check_step(model, self, step, usable ? step / (gic_real)ratio : GIC_R(0.0));
    if (status != GIC_OK)
        return status;
    if (!gic_finite(&steady, 1) || steady < GIC_R(0.0))
        return ((gic_head *)self)->status = GIC_ERROR_ARGUMENT;

    gic_head *head = (gic_head *)self;
    const int same = goes_on(head, step, GIC_AB3, ratio);
    const int32_t known = same ? head->history : 0;
    gic_real *scratch = array_at(self, model->scratch_offset);
    gic_real *input_before = scratch + 7 * (model->slow_count + model->fast_count);
    Dual dual = {model,
                 self,
                 same ? head->start_time : gic_time(self),
                 step,
                 same ? head->steps : 0,
                 ratio,
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
    keep_dual(&dual, known);
    move_on(model, self, step, GIC_AB3, ratio, known < 2 ? known + 1 : 2, dual.next, row(&dual, 0));
    return GIC_OK;
}

/* ---- orientation ---------------------------------------------------------------------------------------- */

int gic_orientation(const gic_real given[4], int32_t *dependent, int64_t *switches, gic_real e[4])
{
    /* a stage of an integrator leaves unit length by (step * angular velocity / 2)^2, which must pass; what a
     * caller forgot to normalize must not */
    const gic_real tolerance = GIC_R(0.01);
    const gic_real excess =
        given[0] * given[0] + given[1] * given[1] + given[2] * given[2] + given[3] * given[3] - GIC_R(1.0);
    if (!GIC_FINITE(given, 4) || excess > tolerance || excess < -tolerance)
        return GIC_ERROR_ORIENTATION;

    /* above 1.01 / 2.21 no other can be a tenth larger, and nearly always that is so */
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
    /* not by a place that is known late: readers would wait for it */
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
