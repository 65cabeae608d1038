/* SPDX-License-Identifier: MIT
 * Is a run unstable within bounds? Two things have to come together, for either alone has other reasons.
 *
 * The first is seen while the run goes on, from the numbers of two successive steps alone: the trapezoidal rule on the
 * rates that the steps began with does not lead to where the steps did. Of a motion with z = step * eigenvalue it is
 * off by z^2 / 12 of the way where z is small, by 2 and more where a method loses its stability. Rough roads and
 * impacts do that too. The run is cut into windows; where most samples of a window are such, its last state is kept.
 *
 * The second is theory, after the run, when nothing can be lost any more: of the equations linearized about that state,
 * is there a motion that dies out by itself, and grows with this method and step? One window may be a moment in a stop;
 * two in a row are a finding. Implicit and exponential steps that have an older Jacobian or explicit states, or fast
 * states in steps of their own, may keep a state moving about which theory finds nothing: for them a stretch is made
 * again in small steps instead. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/engines.h"
#include "run/linearize.h"
#include "run/run.h"
#include "run/stability_watch.h"
#include "run/step_growth.h"
#include "run/step_replay.h"
#include "scene/scene.h"
#include "scene/sleep.h"

#include <math.h>
#include <string.h>

enum {
    WINDOWS = 20,  /* of a run */
    SHORTEST = 25, /* steps of a window */
    SAMPLES = 8,   /* samples of a window, at least */
    SPREAD = 8,    /* steps between samples, at most */
    FEW = 5,       /* runs with so few windows are judged by both states of each, for want of more windows */
};

static const double off = 0.1;           /* relative to the way: far above z^2 / 12 of resolved motions */
static const double visible = 0.01;      /* relative to the longest way so far: smaller moves do not show in results */
static const double rounding = 1e-6;     /* relative to 1 and to a number of the state */
static const double mostly = 0.5;        /* share of a window's samples */
static const double longer = 1.25;       /* relative to the step: at which a limit counts as near */
static const double growth_least = 1.01; /* per step; eigenvalues about a moving state are no more accurate */

/* A state to be judged after the run. */
typedef struct Moment {
    int window;
    gic_head *self;                    /* of implicit steps: the instance */
    bool still;                        /* of those: steps keep still what should move */
    double time, *last, *mean, *input; /* state at the window's end, and the mean of its samples (NULL: not known) */
    int32_t *discrete;
    bool judged, near; /* near: it would grow with slightly longer steps */
    double growth;     /* per step, of the motion that grows most */
    double shorten;    /* factor for the step with which no motion grows */
    bool fast;         /* true if that motion is one of fast states */
    const char *moves; /* the quantity with the largest share in it */
    double real, imaginary;
} Moment;

struct StepTheory {
    Pool *pool;
    const Model *model;
    const Engine *tape; /* NULL: not opened yet */
    const Linear *linear;
    gic_head *moving;
    double *f, *A;
};

struct StepWatch {
    Pool *pool;
    StepTheory *theory;
    const Scene *scene;
    const Engine *engine;
    int64_t window, spread, steps; /* steps of a window, between samples, so far */
    int part;                      /* of a sample: 0 before it, 1 and 2 after its first and second step */
    double *before, *after, *rate; /* states around the first step, and the rate that it began with */
    double *longest;               /* largest way of each state in a sampled step */
    double *sum;                   /* of this window's states before and after those steps */
    int samples, rough;            /* of this window */
    int moments;
    Moment moment[WINDOWS];
};

static double *numbers(Pool *pool, int count)
{
    return pool_alloc(pool, sizeof(double) * (size_t)(count + 1));
}

StepTheory *step_theory_new(Pool *pool, const Model *model)
{
    StepTheory *theory = pool_alloc(pool, sizeof *theory);
    *theory = (StepTheory){.pool = pool, .model = model};
    return theory;
}

StepWatch *step_watch_new(Pool *pool, StepTheory *theory, const Scene *scene, const Engine *engine, bool seldom)
{
    const int64_t steps = scene->outputs * scene->per_output;
    const gic_model *code = engine->code;
    const bool dual = scene->ratio > 1 && code->fast_count > 0;
    const bool damped = scene_implicit(scene) && !dual && scene->keep < 2 && !scene->stiff && scene->method != GIC_EXP3;
    if (scene->method >= METHOD_ADAMS || damped || steps < 2 * SHORTEST)
        return NULL;
    const int states = code->slow_count + code->fast_count;
    StepWatch *watch = pool_alloc(pool, sizeof *watch);
    *watch = (StepWatch){.pool = pool, .theory = theory, .scene = scene, .engine = engine};
    /* rounded up, so that there are not more of them than there is room for */
    watch->window = (steps + WINDOWS - 1) / WINDOWS;
    watch->window = watch->window < SHORTEST ? SHORTEST : watch->window;
    watch->spread = watch->window / SAMPLES < SPREAD || seldom ? watch->window / SAMPLES : SPREAD;
    watch->before = numbers(pool, states);
    watch->after = numbers(pool, states);
    watch->rate = numbers(pool, states);
    watch->longest = numbers(pool, states);
    watch->sum = numbers(pool, states);
    return watch;
}

/* ---- while the run goes on -------------------------------------------------------------------------------------- */

/* Is the way of state i over a step, of the sample's first one, off by more than what is resolved is? */
static bool is_rough(const StepWatch *watch, int i, double defect, double way)
{
    return defect > off * way && defect > visible * watch->longest[i] &&
           defect > rounding * (1 + fabs(watch->after[i]));
}

/* After the second step. With dual rate the rates of fast states are known at the last two fast steps of a step; a
 * motion that reverses between these two is not resolved. */
static bool sample_is_rough(StepWatch *watch, const gic_model *code, gic_head *self)
{
    const double step = watch->scene->step, *rate = instance_array(self, code->rate_offset);
    const bool dual = self->ratio > 1 && code->fast_count > 0;
    const int slow = code->slow_count, states = slow + code->fast_count;
    bool rough = false;
    for (int i = 0; i < states; ++i) {
        const double way = watch->after[i] - watch->before[i], r = watch->rate[i];
        watch->longest[i] = fmax(watch->longest[i], fabs(way));
        watch->sum[i] += watch->before[i] + watch->after[i];
        if (i < slow || !dual)
            rough |= is_rough(watch, i, fabs(way - step / 2 * (r + rate[i])), step * fmax(fabs(r), fabs(rate[i])));
    }
    const double *newest = instance_array(self, code->history_offset) + slow, *past = newest + states;
    for (int i = 0; dual && self->history == 2 && i < code->fast_count; ++i)
        if (newest[i] * past[i] < 0) {
            const double fast = step / self->ratio, a = fabs(newest[i]), b = fabs(past[i]);
            rough |= is_rough(watch, slow + i, fast * fmin(a, b), fast * fmax(a, b));
        }
    return rough;
}

/* The state of FORMAT.md section 10; engines with one of their own need a right-hand side for it. NULL: there is none.
 */
static double *standard_state(const StepWatch *watch, gic_head *copy)
{
    double *state = numbers(watch->pool, watch->engine->standard_count);
    return engine_look(watch->engine, copy, state, NULL) == GIC_OK ? state : NULL;
}

/* Keep the window's last state. A motion that tires or stops limit circles around the state at which it would die
 * out, so the mean of the samples is often nearer to that state; for engines whose numbers must satisfy constraints
 * the mean is not a valid state. */
static void keep(StepWatch *watch, const gic_model *code, gic_head *self, gic_head *copy)
{
    Pool *pool = watch->pool;
    const size_t discrete = sizeof(int32_t) * (size_t)code->discrete_count;
    Moment *moment = &watch->moment[watch->moments];
    *moment = (Moment){.window = (int)(watch->steps / watch->window), .time = gic_time(self)};
    memcpy(copy, self, code->size);
    if (scene_implicit(watch->scene)) {
        moment->self = instance_new(pool, watch->engine);
        memcpy(moment->self, self, code->size);
    }
    moment->last = standard_state(watch, copy);
    double *state = instance_array(copy, code->state_offset);
    for (int i = 0; i < code->slow_count + code->fast_count; ++i)
        state[i] = watch->sum[i] / (2 * watch->samples);
    if (!watch->engine->leave)
        moment->mean = standard_state(watch, copy);
    moment->input = memcpy(numbers(pool, code->input_count), instance_array(self, code->input_offset),
                           sizeof(double) * (size_t)code->input_count);
    moment->discrete = memcpy(pool_alloc(pool, discrete + 1), (char *)self + code->discrete_offset, discrete);
    ++watch->moments;
}

static void take_sample(StepWatch *watch, const gic_model *code, gic_head *self)
{
    const size_t size = sizeof(double) * (size_t)(code->slow_count + code->fast_count);
    const double *state = instance_array(self, code->state_offset);
    if (watch->part == 2) {
        watch->rough += sample_is_rough(watch, code, self);
        ++watch->samples;
    } else if (watch->part == 1) {
        memcpy(watch->after, state, size);
        memcpy(watch->rate, instance_array(self, code->rate_offset), size);
    } else {
        memcpy(watch->before, state, size);
    }
    watch->part = (watch->part + 1) % 3;
}

void step_watch_step(StepWatch *watch, const gic_model *code, gic_head *self, gic_head *copy)
{
    const bool asleep = watch->scene->rest && watch->scene->rest->asleep;
    ++watch->steps;
    if (asleep)
        watch->part = 0;
    else if (watch->part > 0 || watch->steps % watch->spread == 0)
        take_sample(watch, code, self);
    if (watch->steps % watch->window != 0)
        return;
    if (!asleep && watch->samples > 0 && watch->rough >= mostly * watch->samples && watch->moments < WINDOWS)
        keep(watch, code, self, copy);
    watch->samples = watch->rough = 0;
    memset(watch->sum, 0, sizeof *watch->sum * (size_t)(code->slow_count + code->fast_count));
}

static int64_t next_multiple(int64_t of, int64_t after)
{
    return (after / of + 1) * of;
}

int64_t step_watch_idle(const StepWatch *watch)
{
    const int64_t sample = watch->part > 0 ? watch->steps + 1 : next_multiple(watch->spread, watch->steps);
    const int64_t end = next_multiple(watch->window, watch->steps);
    return (sample < end ? sample : end) - watch->steps - 1;
}

void step_watch_pass(StepWatch *watch, int64_t steps)
{
    watch->steps += steps;
}

/* ---- after the run ---------------------------------------------------------------------------------------------- */

static void open_linear(StepTheory *theory)
{
    Pool *pool = theory->pool;
    theory->tape = engine_open(pool, "tape", theory->model, &(EngineOptions){.quiet = true});
    theory->linear = linear_open(pool, theory->tape);
    theory->moving = instance_new(pool, theory->tape);
    theory->f = numbers(pool, theory->linear->count);
    theory->A = numbers(pool, theory->linear->count * theory->linear->count);
}

/* The equations linearized about a state of a moment, into theory->A. */
static bool linearize_moment(StepTheory *theory, const Scene *scene, const Engine *engine, const Moment *moment,
                             const double *state)
{
    if (!theory->tape)
        open_linear(theory);
    const gic_model *tape = theory->tape->code;
    gic_head *moving = theory->moving;
    if (theory->tape->standard_count != engine->standard_count || tape->setup_with(moving, scene->parameter) != GIC_OK)
        return false;
    moving->road = scene->road;
    memcpy(instance_array(moving, tape->input_offset), moment->input, sizeof(double) * (size_t)tape->input_count);
    for (int i = tape->free_base; i < tape->discrete_count; ++i)
        ((int32_t *)(void *)((char *)moving + tape->discrete_offset))[i] = moment->discrete[i];
    gic_restart(moving, moment->time);
    return engine_enter(theory->tape, moving, state) == GIC_OK &&
           linearize(theory->linear, (Instance *)(void *)moving, theory->f, theory->A) == GIC_OK;
}

double step_theory_stiffness(StepTheory *theory, const Scene *scene, const Engine *engine, double time,
                             const double *state, const double *input, const int32_t *discrete)
{
    const Moment moment = {.time = time, .input = (double *)input, .discrete = (int32_t *)discrete}; /* only read */
    if (!linearize_moment(theory, scene, engine, &moment, state))
        return NAN;
    const int places = theory->linear->places, count = theory->linear->count;
    double sum = 0;
    for (int i = 0; i < places; ++i)
        for (int j = 0; j < places; ++j)
            sum -= theory->A[i * count + places + j] * theory->A[(places + j) * count + i];
    return sum;
}

/* The part of the step with which a motion just does not grow; with all of it it does. */
static double shorten(int32_t method, double real, double imaginary)
{
    double low = 0, high = 1;
    while (high - low > 1e-3 * high) {
        const double middle = (low + high) / 2;
        *(step_grows(method, middle * real, middle * imaginary, 1) ? &high : &low) = middle;
    }
    return low;
}

/* What the method makes of a mode; fast states are taken to have their own steps, for coupling moves limits little
 * (FORMAT.md section 14). */
static void judge_mode(const StepWatch *watch, const Mode *mode, Moment *moment)
{
    const Linear *linear = watch->theory->linear;
    const int32_t method = watch->scene->method;
    const int places = linear->places;
    const bool fast = mode_is_fast(linear, mode);
    int most = 0;
    for (int i = 0; i < linear->count - places; ++i)
        most = mode->share[i] > mode->share[most] ? i : most;
    const double step = watch->scene->step / (fast ? fmax(1, watch->scene->ratio) : 1);
    const double real = step * mode->real, imaginary = step * mode->imaginary;
    if (mode->real >= 0 || !step_grows(method, longer * real, longer * imaginary, growth_least))
        return;
    moment->near = true;
    if (!step_grows(method, real, imaginary, growth_least))
        return;
    moment->shorten = fmin(moment->shorten, shorten(method, real, imaginary));
    const double growth = step_growth(method, real, imaginary);
    if (growth <= moment->growth)
        return;
    moment->growth = growth;
    moment->fast = fast;
    moment->moves = linear->name[most < places ? most : most + places];
    moment->real = mode->real;
    moment->imaginary = mode->imaginary;
}

/* Implicit steps: does the run keep something moving that small steps don't? */
static void judge_implicit(StepWatch *watch, Moment *moment)
{
    enum { MOST = 64 };
    const Modes *modes = linearize_moment(watch->theory, watch->scene, watch->engine, moment, moment->last)
                             ? modes_try(watch->pool, watch->theory->linear, watch->theory->A)
                             : NULL;
    double fastest = 0;
    for (int k = 0; modes && k < modes->count; ++k)
        fastest = fmax(fastest, hypot(modes->mode[k].real, modes->mode[k].imaginary));
    const double parts = ceil(fastest * watch->scene->step);
    if (!modes || !(parts <= MOST))
        return;
    const Replay found =
        step_replay(watch->pool, watch->engine, watch->scene, moment->self, (int)fmax(parts, 4), watch->longest);
    const int number = found.moves >= 0 ? found.moves : found.stays;
    moment->growth = number >= 0;
    moment->still = found.moves < 0;
    moment->moves = number >= 0 ? watch->engine->code->state[number].name : NULL;
}

static void judge_state(StepWatch *watch, Moment *moment, const double *state)
{
    const Modes *modes = linearize_moment(watch->theory, watch->scene, watch->engine, moment, state)
                             ? modes_try(watch->pool, watch->theory->linear, watch->theory->A)
                             : NULL;
    for (int k = 0; modes && k < modes->count; ++k)
        judge_mode(watch, &modes->mode[k], moment);
}

/* True if at that moment a motion grows with this step that would decay by itself. The last state is used if the
 * mean state is far from it or missing. */
static bool grows(StepWatch *watch, Moment *moment)
{
    if (!moment->judged) {
        moment->judged = true;
        moment->shorten = 1;
        if (scene_implicit(watch->scene)) {
            if (moment->last)
                judge_implicit(watch, moment);
            return moment->growth > 0;
        }
        if (moment->mean)
            judge_state(watch, moment, moment->mean);
        if (moment->last && (moment->near || !moment->mean || watch->moments <= FEW) && moment->growth == 0)
            judge_state(watch, moment, moment->last);
    }
    return moment->growth > 0;
}

/* True if moments i and i + 1 end successive windows and a motion grows at both. */
static bool both_grow(StepWatch *watch, int i)
{
    Moment *moment = watch->moment;
    return i >= 0 && i + 1 < watch->moments && moment[i + 1].window == moment[i].window + 1 &&
           grows(watch, &moment[i]) && grows(watch, &moment[i + 1]);
}

/* The first of two moments at which a motion grows, with windows between them at whose moments one would grow with
 * slightly longer steps; -1: none. For runs of few windows, whose states are of a wild motion. */
static int find_apart(StepWatch *watch)
{
    const Moment *moment = watch->moment;
    int first = -1;
    for (int i = 0; i < watch->moments; ++i) {
        const bool goes_on = first >= 0 && moment[i].window == moment[i - 1].window + 1;
        if (grows(watch, &watch->moment[i]) && goes_on)
            return first;
        first = moment[i].growth > 0 ? i : goes_on && moment[i].near ? first : -1;
    }
    return -1;
}

/* A moment and the next one at which a motion grows, -1: none. Looks cost some milliseconds each, and rough roads make
 * many moments: the 2nd, 4th, 8th and 16th and the last are looked at, then the neighbours of those where one grows. */
static int find_pair(StepWatch *watch)
{
    const int count = watch->moments;
    for (int i = 1; count > 1 && i < count; i = i == count - 1 ? count : 2 * i + 1 < count ? 2 * i + 1 : count - 1) {
        if (both_grow(watch, i - 1))
            return i - 1;
        if (both_grow(watch, i))
            return i;
    }
    return -1;
}

/* What is wrong with implicit steps, from a time on. */
static const char *tell_implicit(const StepWatch *watch, double from, const Moment *worst, const char **remedy)
{
    const Scene *scene = watch->scene;
    const char *dual = scene->ratio > 1 ? pool_print(watch->pool, ", %d fast steps in each", scene->ratio) : "";
    const char *instead = scene->stiff                ? "every state into the implicit part (`implicit: all`)"
                          : scene->ratio > 1          ? "more fast steps in each, one rate (`ratio: 1`)"
                          : scene->method == GIC_EXP3 ? "new exponentials more often (`keep_jacobian: 10`)"
                                                      : "new Jacobians more often (`keep_jacobian`)";
    *remedy = pool_print(
        watch->pool, "take %s, or shorter steps; what is wrong shows where results with half the step are different",
        instead);
    return pool_print(watch->pool,
                      "from t = %.4g s on the run is wrong, though it stays within bounds: steps of %.6g s (%s%s) keep "
                      "'%s' %s, which small ones of rk4 %s",
                      from, scene->step, integrator_name(scene->method), dual, worst->moves,
                      worst->still ? "still" : "moving", worst->still ? "move" : "do not");
}

const char *step_watch_judge(StepWatch *watch, const char **remedy)
{
    int first = find_pair(watch);
    if (first < 0 && watch->moments <= FEW)
        first = find_apart(watch);
    if (first < 0)
        return NULL;
    Pool *pool = watch->pool;
    const Scene *scene = watch->scene;
    while (both_grow(watch, first - 1))
        --first;
    const Moment *worst = &watch->moment[first];
    double least = 1;
    for (int i = first; i < watch->moments; ++i) {
        const Moment *moment = &watch->moment[i];
        least = moment->judged ? fmin(least, moment->shorten) : least;
        worst = moment->judged && moment->growth > worst->growth ? moment : worst;
    }
    const double from = (double)((watch->moment[first].window - 1) * watch->window) * scene->step;
    if (scene_implicit(scene))
        return tell_implicit(watch, from, worst, remedy);
    const char *ratio = scene->ratio > 1 ? pool_print(pool, ", %d fast steps in each", scene->ratio) : "";
    const char *imaginary =
        worst->imaginary > 1e-6 * fabs(worst->real) ? pool_print(pool, " +- %.3gi", worst->imaginary) : "";
    *remedy = pool_print(pool,
                         "take steps of at most about %.2g s%s, or variable ones (--integrator adams); what is wrong "
                         "shows where results with half the step are different",
                         0.95 * least * scene->step,
                         worst->fast && scene->method == GIC_AB3 ? ", or more fast steps in each (`ratio`)" : "");
    return pool_print(pool,
                      "from t = %.4g s on the run is unstable, though tires or stops keep it within bounds: steps of "
                      "%.6g s (%s%s) make a motion grow that dies out by itself: '%s', eigenvalue %.3g%s 1/s, by %.3g "
                      "a step",
                      from, scene->step, integrator_name(scene->method), ratio, worst->moves, worst->real, imaginary,
                      worst->growth);
}
