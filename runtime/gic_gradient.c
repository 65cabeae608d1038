/* SPDX-License-Identifier: MIT
 * Derivatives of whole runs; see gic_gradient.h. */
#include "gic_gradient.h"

#include <string.h>

enum { STAGES = 4 };

/* What a run has in the caller's memory. */
typedef struct Work {
    gic_gradient *run;
    const gic_derivatives *code;
    const gic_model *model;
    void *along;
    int32_t n, discretes;
    char *self;        /* the instance that makes the steps */
    char *look;        /* a copy of it for what looks at a state, so that steps have the bits that they have alone */
    gic_real *state;   /* derivatives by or of the state */
    gic_real *rate[3]; /* AB3: of the rates at the present step and the two before; backwards, by them */
    gic_real *stage;   /* [4][n] states of RK4 */
    gic_real *slope, *sum; /* [n] */
    gic_real *by_state, *by_output;
    int32_t *discrete;
    /* backwards */
    char *before;                                  /* the instance before the last step */
    gic_real *jacobian, *input, *parameter, *port; /* the last three: sums of the results */
    char *kept;                                    /* [checkpoints] instances */
    int64_t *number;                               /* [checkpoints] steps made before them */
    gic_real settled[4];                           /* Euler parameters after the step that comes next backwards */
    int32_t dependent;                             /* which of them follows from the others */
} Work;

/* ---- memory ------------------------------------------------------------------------------------------------- */

static size_t round_up(size_t size)
{
    return (size + 63) / 64 * 64;
}

/* The next `count` things of `size` bytes. Without memory it only counts; *needed stays at the largest number there is
 * where there are too many. */
static void *take(char *memory, size_t *needed, size_t count, size_t size)
{
    const size_t each = size > sizeof(int64_t) ? round_up(size) : size, from = *needed, most = ~(size_t)0;
    if (each > 0 && count > (most - 64) / each) {
        *needed = most;
        return NULL;
    }
    const size_t bytes = round_up(count * each);
    *needed = from > most - bytes ? most : from + bytes;
    return memory && *needed < most ? memory + from : NULL;
}

/* Give each array its place; returns the bytes that all need. */
static size_t lay_out(Work *w, char *memory, int backwards)
{
    const gic_model *model = w->model;
    const size_t n = (size_t)w->n, outputs = (size_t)model->output_count, real = sizeof(gic_real);
    const size_t rows = n + (w->run->looks ? outputs : 0);
    size_t needed = 0;
    int i;
    w->self = (char *)take(memory, &needed, 1, model->size);
    w->look = (char *)take(memory, &needed, 1, model->size);
    w->state = (gic_real *)take(memory, &needed, n, real);
    for (i = 0; i < 3; ++i)
        w->rate[i] = (gic_real *)take(memory, &needed, n, real);
    w->stage = (gic_real *)take(memory, &needed, STAGES * n, real);
    w->slope = (gic_real *)take(memory, &needed, n, real);
    w->sum = (gic_real *)take(memory, &needed, n, real);
    w->by_state = (gic_real *)take(memory, &needed, n, real);
    w->by_output = (gic_real *)take(memory, &needed, outputs, real);
    w->discrete = (int32_t *)take(memory, &needed, (size_t)w->discretes, sizeof(int32_t));
    w->input = (gic_real *)take(memory, &needed, (size_t)model->input_count, real);
    if (!backwards)
        return needed;
    w->parameter = (gic_real *)take(memory, &needed, (size_t)model->parameter_count, real);
    w->before = (char *)take(memory, &needed, 1, model->size);
    w->port = (gic_real *)take(memory, &needed, (size_t)model->port_count, real);
    w->jacobian = (gic_real *)take(memory, &needed, rows * (size_t)w->code->columns + 1, real);
    w->kept = (char *)take(memory, &needed, (size_t)w->run->checkpoints, model->size);
    w->number = (int64_t *)take(memory, &needed, (size_t)w->run->checkpoints, sizeof *w->number);
    return needed;
}

/* ---- arrays --------------------------------------------------------------------------------------------------- */

static gic_real *array_in(void *structure, size_t offset)
{
    return (gic_real *)(void *)((char *)structure + offset);
}

static gic_real *state_of(const Work *w, char *self)
{
    return array_in(self, w->model->state_offset);
}

static const int32_t *discrete_in(const Work *w, const char *self)
{
    return (const int32_t *)(const void *)(self + w->model->discrete_offset);
}

static void copy_to(gic_real *to, const gic_real *from, int32_t count)
{
    if (count > 0)
        memcpy(to, from, (size_t)count * sizeof *to);
}

static void clear(gic_real *x, int32_t count)
{
    int32_t i;
    for (i = 0; i < count; ++i)
        x[i] = GIC_R(0.0);
}

static void add(int32_t count, gic_real factor, const gic_real *from, gic_real *to)
{
    int32_t i;
    for (i = 0; i < count; ++i)
        to[i] += factor * from[i];
}

static gic_real dot(int32_t count, const gic_real *a, const gic_real *b)
{
    gic_real sum = GIC_R(0.0);
    int32_t i;
    for (i = 0; i < count; ++i)
        sum += a[i] * b[i];
    return sum;
}

/* ---- steps ---------------------------------------------------------------------------------------------------- */

static void set_inputs(const Work *w, char *self, gic_real time)
{
    const gic_head *head = (const gic_head *)(const void *)self;
    if (head->input_function)
        head->input_function(head->user, head->lane, time, array_in(self, w->model->input_offset));
}

/* A step; a change of gear in it has no derivative here. */
static int make_step(Work *w)
{
    const int32_t from = w->model->free_base ? 1 : 0;
    int32_t i;
    const int32_t *now = discrete_in(w, w->self);
    for (i = 0; i < w->discretes; ++i)
        w->discrete[i] = now[i];
    const int status = gic_step(w->model, w->self, w->run->step, w->run->method);
    w->run->made += 1;
    for (i = from; status == GIC_OK && i < w->discretes; ++i)
        if (now[i] != w->discrete[i])
            return GIC_ERROR_EVENTS;
    return status;
}

/* True if step `number` is one of RK4: those of AB3 begin with two. */
static int is_single(const Work *w, int64_t number)
{
    return w->run->method == GIC_RK4 || number < 2;
}

/* The states of RK4's stages, in stage[]. */
static int find_stages(Work *w)
{
    const gic_real reach[STAGES] = {GIC_R(0.0), GIC_R(0.5) * w->run->step, GIC_R(0.5) * w->run->step, w->run->step};
    const gic_real time = gic_time(w->self), *from = state_of(w, w->self);
    int k, status = GIC_OK;
    copy_to(w->stage, from, w->n);
    for (k = 1; k < STAGES && status == GIC_OK; ++k) {
        set_inputs(w, w->look, time + reach[k - 1]);
        status = w->model->rhs(w->look, time + reach[k - 1], w->stage + (k - 1) * w->n, w->slope);
        copy_to(w->stage + k * w->n, from, w->n);
        add(w->n, reach[k], w->slope, w->stage + k * w->n);
    }
    return status;
}

/* At a state of the run: its part of the scalar, with derivatives in by_state[] and by_output[]. */
static int weigh(Work *w, int64_t number)
{
    const gic_gradient *run = w->run;
    int status = GIC_OK;
    memcpy(w->look, w->self, w->model->size);
    set_inputs(w, w->look, gic_time(w->look));
    if (run->looks)
        status = w->model->outputs(w->look);
    clear(w->by_state, w->n);
    clear(w->by_output, w->model->output_count);
    if (status == GIC_OK)
        w->run->value += run->weigh(run->user, number, w->look, w->by_state, run->looks ? w->by_output : NULL);
    if (status == GIC_OK && (!gic_finite(w->by_state, w->n) || !gic_finite(w->by_output, w->model->output_count)))
        status = GIC_ERROR_INPUT;
    return status;
}

/* Are there weights of outputs? */
static int weighs_outputs(const Work *w)
{
    int32_t i;
    for (i = 0; i < w->model->output_count; ++i)
        if (w->by_output[i] < GIC_R(0.0) || w->by_output[i] > GIC_R(0.0))
            return 1;
    return 0;
}

/* Everything that both directions need. */
static int begin(Work *w, gic_gradient *run, void *along, int backwards)
{
    const gic_derivatives *code = run->code;
    const gic_model *model = code->model;
    const gic_head *head = (const gic_head *)run->start;
    *w = (Work){.run = run, .code = code, .model = model, .along = along};
    w->n = model->slow_count + model->fast_count;
    w->discretes = model->discrete_count;
    run->made = 0;
    run->value = GIC_R(0.0);
    run->needed = 0;
    if (model->abi_version != GIC_ABI_VERSION || model->real_size != sizeof(gic_real))
        return GIC_ERROR_ABI;
    if (backwards && run->steps > 0 && run->checkpoints > run->steps)
        run->checkpoints = run->steps;
    if (backwards && run->checkpoints < 1)
        return GIC_ERROR_ARGUMENT;
    run->needed = lay_out(w, NULL, backwards);
    if (run->steps < 1 || (run->method != GIC_AB3 && run->method != GIC_RK4) || head->locate ||
        model->controller_count > 0 || !run->memory || run->size < run->needed)
        return GIC_ERROR_ARGUMENT;
    (void)lay_out(w, (char *)run->memory, backwards);
    memcpy(w->self, run->start, model->size);
    gic_restart(w->self, gic_time(w->self));
    ((gic_head *)(void *)w->self)->ahead = run->step;
    return model->settle(w->self, state_of(w, w->self));
}

/* ---- forwards ------------------------------------------------------------------------------------------------- */

/* The dependent Euler parameter follows from the others. */
static void follow_others(const Work *w, gic_real *dstate)
{
    const gic_real *e = state_of(w, w->self) + 3;
    const int32_t dependent = w->model->free_base ? discrete_in(w, w->self)[0] : 0;
    gic_real *de = dstate + 3, sum = GIC_R(0.0);
    int i;
    if (!w->model->free_base)
        return;
    for (i = 0; i < 4; ++i)
        sum += i == dependent ? GIC_R(0.0) : e[i] * de[i];
    de[dependent] = -sum / e[dependent];
}

/* The derivative of the rates at a state that changes by dstate[], in drate[]. */
static int rate_along(Work *w, gic_real time, const gic_real *state, const gic_real *dstate, gic_real *drate)
{
    const gic_gradient *run = w->run;
    gic_real *dinput = array_in(w->along, w->code->input_offset);
    copy_to(dinput, w->input, w->model->input_count);
    if (run->follow)
        run->follow(run->user, time, dinput);
    copy_to(array_in(w->along, w->code->state_offset), dstate, w->n);
    set_inputs(w, w->look, time);
    const int status = w->code->tangent(w->look, time, state, w->along);
    copy_to(drate, array_in(w->along, w->code->rate_offset), w->n);
    return status;
}

/* RK4: rate[0] has the derivative of the rate at the start. */
static int single_along(Work *w)
{
    const gic_real h = w->run->step, time = gic_time(w->self), half = GIC_R(0.5) * h;
    const gic_real reach[STAGES] = {GIC_R(0.0), half, half, h}, sixth = h / GIC_R(6.0), third = h / GIC_R(3.0);
    const gic_real part[STAGES] = {sixth, third, third, sixth};
    int k, status = find_stages(w);
    copy_to(w->slope, w->rate[0], w->n);
    clear(w->sum, w->n);
    add(w->n, part[0], w->slope, w->sum);
    for (k = 1; k < STAGES && status == GIC_OK; ++k) {
        gic_real *moved = w->by_state; /* free here */
        copy_to(moved, w->state, w->n);
        add(w->n, reach[k], w->slope, moved);
        status = rate_along(w, time + reach[k], w->stage + k * w->n, moved, w->slope);
        add(w->n, part[k], w->slope, w->sum);
    }
    add(w->n, GIC_R(1.0), w->sum, w->state);
    return status;
}

static int step_along(Work *w, int64_t number)
{
    const gic_real weight = w->run->step / GIC_R(12.0);
    gic_real *oldest = w->rate[2];
    w->rate[2] = w->rate[1];
    w->rate[1] = w->rate[0];
    w->rate[0] = oldest;
    memcpy(w->look, w->self, w->model->size);
    int status = rate_along(w, gic_time(w->self), state_of(w, w->self), w->state, w->rate[0]);
    if (status == GIC_OK && is_single(w, number)) {
        status = single_along(w);
    } else if (status == GIC_OK) {
        add(w->n, GIC_R(23.0) * weight, w->rate[0], w->state);
        add(w->n, GIC_R(-16.0) * weight, w->rate[1], w->state);
        add(w->n, GIC_R(5.0) * weight, w->rate[2], w->state);
    }
    if (status == GIC_OK)
        status = make_step(w);
    if (status == GIC_OK)
        follow_others(w, w->state);
    return status;
}

/* What the scalar gets of its derivative at a state. */
static int weigh_along(Work *w, int64_t number, gic_real *slope)
{
    gic_real *dinput = array_in(w->along, w->code->input_offset);
    int status = weigh(w, number);
    if (status != GIC_OK)
        return status;
    *slope += dot(w->n, w->by_state, w->state);
    if (!w->run->looks || !weighs_outputs(w))
        return GIC_OK;
    copy_to(dinput, w->input, w->model->input_count);
    if (w->run->follow)
        w->run->follow(w->run->user, gic_time(w->look), dinput);
    copy_to(array_in(w->along, w->code->state_offset), w->state, w->n);
    status = w->code->tangent_outputs(w->look, w->along);
    *slope += dot(w->model->output_count, w->by_output, array_in(w->along, w->code->output_offset));
    return status;
}

int gic_run_tangent(gic_gradient *run, void *along, gic_real *slope)
{
    Work w;
    int64_t k;
    gic_real sum = GIC_R(0.0);
    int status = begin(&w, run, along, 0);
    if (status != GIC_OK)
        return status;
    copy_to(w.state, array_in(along, run->code->state_offset), w.n);
    copy_to(w.input, array_in(along, run->code->input_offset), w.model->input_count);
    follow_others(&w, w.state);
    for (k = 0; k <= run->steps && status == GIC_OK; ++k) {
        status = weigh_along(&w, k, &sum);
        if (status == GIC_OK && k < run->steps)
            status = step_along(&w, k);
    }
    if (status == GIC_OK && (!gic_finite(&sum, 1) || !gic_finite(&run->value, 1) || !gic_finite(w.state, w.n)))
        status = GIC_ERROR_RESULT;
    copy_to(array_in(along, run->code->state_offset), w.state, w.n);
    copy_to(array_in(along, run->code->input_offset), w.input, w.model->input_count);
    if (status == GIC_OK)
        *slope = sum;
    return status;
}

/* ---- backwards ------------------------------------------------------------------------------------------------ */

/* Derivatives by a dependent Euler parameter go to those that it follows from. */
static void settle_back(const Work *w)
{
    gic_real *by = w->state + 3;
    int i;
    if (!w->model->free_base)
        return;
    for (i = 0; i < 4; ++i)
        if (i != w->dependent)
            by[i] -= w->settled[i] / w->settled[w->dependent] * by[w->dependent];
    by[w->dependent] = GIC_R(0.0);
}

static void note_settled(Work *w)
{
    if (!w->model->free_base)
        return;
    copy_to(w->settled, state_of(w, w->self) + 3, 4);
    w->dependent = discrete_in(w, w->self)[0];
}

/* Sums of the results; by states in along->state. */
static void gather(const Work *w, gic_real time)
{
    gic_real *by_input = array_in(w->along, w->code->input_offset);
    add(w->model->input_count, GIC_R(1.0), by_input, w->input);
    add(w->model->parameter_count, GIC_R(1.0), array_in(w->along, w->code->parameter_offset), w->parameter);
    add(w->model->port_count, GIC_R(1.0), array_in(w->along, w->code->port_offset), w->port);
    if (w->run->follow)
        w->run->follow(w->run->user, time, by_input);
}

/* Back through the rates at a state, with derivatives by them; along->state has those by the state. */
static int rate_back(Work *w, gic_real time, const gic_real *state, const gic_real *by_rate)
{
    copy_to(array_in(w->along, w->code->rate_offset), by_rate, w->n);
    set_inputs(w, w->look, time);
    const int status = w->code->adjoint(w->look, time, state, w->along, w->jacobian);
    if (status == GIC_OK)
        gather(w, time);
    return status;
}

/* y' = y + h / 6 (k1 + 2 k2 + 2 k3 + k4), each k at y + a share of the one before; rate[0]: by k1 of later steps. */
static int single_back(Work *w)
{
    const gic_real h = w->run->step, time = gic_time(w->self), half = GIC_R(0.5) * h;
    const gic_real reach[STAGES] = {GIC_R(0.0), half, half, h}, sixth = h / GIC_R(6.0), third = h / GIC_R(3.0);
    const gic_real part[STAGES] = {sixth, third, third, sixth};
    const gic_real *by = array_in(w->along, w->code->state_offset);
    int k, status = find_stages(w);
    clear(w->sum, w->n);
    for (k = STAGES - 1; k >= 0 && status == GIC_OK; --k) {
        clear(w->slope, w->n);
        add(w->n, part[k], w->state, w->slope);
        if (k < STAGES - 1)
            add(w->n, reach[k + 1], by, w->slope);
        if (k == 0)
            add(w->n, GIC_R(1.0), w->rate[0], w->slope);
        status = rate_back(w, time + reach[k], w->stage + k * w->n, w->slope);
        add(w->n, GIC_R(1.0), by, w->sum);
    }
    add(w->n, GIC_R(1.0), w->sum, w->state);
    return status;
}

/* Back through the scalar's part at a state, of which self is the instance. */
static int weigh_back(Work *w, int64_t number)
{
    int status = weigh(w, number);
    if (status != GIC_OK)
        return status;
    add(w->n, GIC_R(1.0), w->by_state, w->state);
    if (!w->run->looks || !weighs_outputs(w))
        return GIC_OK;
    clear(array_in(w->along, w->code->rate_offset), w->n);
    copy_to(array_in(w->along, w->code->output_offset), w->by_output, w->model->output_count);
    status = w->code->adjoint_outputs(w->look, w->along, w->jacobian);
    if (status != GIC_OK)
        return status;
    add(w->n, GIC_R(1.0), array_in(w->along, w->code->state_offset), w->state);
    gather(w, gic_time(w->look));
    return GIC_OK;
}

/* Back through a step, before which self is. */
static int step_back(Work *w, int64_t number)
{
    const gic_real weight = w->run->step / GIC_R(12.0);
    gic_real *done = w->rate[0];
    int status;
    settle_back(w);
    memcpy(w->look, w->self, w->model->size);
    if (is_single(w, number)) {
        status = single_back(w);
    } else {
        add(w->n, GIC_R(23.0) * weight, w->state, w->rate[0]);
        add(w->n, GIC_R(-16.0) * weight, w->state, w->rate[1]);
        add(w->n, GIC_R(5.0) * weight, w->state, w->rate[2]);
        status = rate_back(w, gic_time(w->self), state_of(w, w->self), w->rate[0]);
        add(w->n, GIC_R(1.0), array_in(w->along, w->code->state_offset), w->state);
    }
    w->rate[0] = w->rate[1];
    w->rate[1] = w->rate[2];
    w->rate[2] = done;
    clear(done, w->n);
    note_settled(w);
    return status == GIC_OK ? weigh_back(w, number) : status;
}

/* The steps after which a number of instances, kept at best, lets every step be made at most `again` times more:
 * (kept + again)! / (kept! again!), or `most` where it is more. */
static int64_t reach_of(int64_t kept, int64_t again, int64_t most)
{
    const int64_t small = kept < again ? kept : again, large = kept < again ? again : kept;
    int64_t product = 1, i;
    if (small < 0)
        return 0;
    for (i = 1; i <= small; ++i) { /* stays a whole number, and below most^2 */
        if (product > most)
            return most;
        if (product > INT64_MAX / (large + i))
            return most;
        product = product * (large + i) / i;
    }
    return product < most ? product : most;
}

int64_t gic_next_checkpoint(int64_t left, int64_t free)
{
    const int64_t kept = free + 1, most = left < INT64_MAX ? left + 1 : left;
    int64_t again = 0, next;
    while (reach_of(kept, again, most) < left)
        ++again;
    next = left - reach_of(kept - 1, again, most);
    if (next < reach_of(kept, again - 2, most))
        next = reach_of(kept, again - 2, most);
    return next < 1 ? 1 : next < left ? next : left - 1;
}

static void go_to(Work *w, int64_t top)
{
    memcpy(w->self, w->kept + (size_t)top * round_up(w->model->size), w->model->size);
}

static void keep(Work *w, int64_t top, int64_t number)
{
    memcpy(w->kept + (size_t)top * round_up(w->model->size), w->self, w->model->size);
    w->number[top] = number;
}

static int make_steps(Work *w, int64_t count)
{
    int status = GIC_OK;
    for (; count > 0 && status == GIC_OK; --count)
        status = make_step(w);
    return status;
}

/* The last step is made for its end, which the scalar sees. */
static int start_back(Work *w)
{
    const int status = make_step(w);
    note_settled(w);
    return status == GIC_OK ? weigh_back(w, w->run->steps) : status;
}

int gic_run_adjoint(gic_gradient *run, void *along)
{
    Work w;
    int64_t end = run->steps, top = 0;
    int status = begin(&w, run, along, 1);
    if (status != GIC_OK)
        return status;
    clear(w.state, w.n);
    for (int i = 0; i < 3; ++i)
        clear(w.rate[i], w.n);
    clear(w.input, w.model->input_count);
    clear(w.parameter, w.model->parameter_count);
    clear(w.port, w.model->port_count);
    memset(along, 0, run->code->size);
    keep(&w, 0, 0);
    while (end > 0 && status == GIC_OK) {
        const int64_t from = w.number[top], left = end - from, spare = run->checkpoints - 1 - top;
        const int64_t ahead = left == 1 ? 0 : spare > 0 ? gic_next_checkpoint(left, spare) : left - 1;
        go_to(&w, top);
        status = make_steps(&w, ahead);
        if (status == GIC_OK && left > 1 && spare > 0) {
            keep(&w, ++top, from + ahead);
            continue;
        }
        if (status == GIC_OK && end == run->steps) {
            memcpy(w.before, w.self, w.model->size);
            status = start_back(&w);
            memcpy(w.self, w.before, w.model->size);
        }
        if (status == GIC_OK)
            status = step_back(&w, --end);
        if (end == w.number[top] && top > 0)
            --top;
    }
    if (status != GIC_OK) {
        memset(along, 0, run->code->size);
        return status;
    }
    settle_back(&w);
    if (!gic_finite(&run->value, 1) || !gic_finite(w.state, w.n) || !gic_finite(w.input, w.model->input_count) ||
        !gic_finite(w.parameter, w.model->parameter_count) || !gic_finite(w.port, w.model->port_count))
        status = GIC_ERROR_RESULT;
    copy_to(array_in(along, run->code->state_offset), w.state, w.n);
    copy_to(array_in(along, run->code->input_offset), w.input, w.model->input_count);
    copy_to(array_in(along, run->code->parameter_offset), w.parameter, w.model->parameter_count);
    copy_to(array_in(along, run->code->port_offset), w.port, w.model->port_count);
    return status;
}
