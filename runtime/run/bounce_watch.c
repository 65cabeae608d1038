/* SPDX-License-Identifier: MIT
 * Does a contact give back more than it may? A wheel or a stop is passive: after a bounce a body goes away as fast as
 * the element's law says, without damping as fast as it came. A step that is too long for the element's stiffness goes
 * over the beginning and the end of the bounce, and may add energy each time.
 *
 * Numbers of contacts (gic_contacts.press) are looked at in steps that may bring one to 0; without a load such a number
 * is the gap, negative, and its slope the speed of approach. A short bounce is judged when the body is free again: the
 * same time is integrated once more in small steps, from the state before the bounce, on an instance of the watch's
 * own. Gap and speed of both, as energy per mass v^2 / 2 - a gap with the acceleration a of the free motion, give the
 * factor by which the run's body bounces too high. Nothing is judged but this factor, so the law of the element, the
 * mass behind it and what else acts need not be known. */
#include "run/bounce_watch.h"

#include "engine/engine.h"
#include "gic_runtime.h"
#include "scene/scene.h"
#include "scene/sleep.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    LONGEST = 32,  /* steps of a bounce that is judged; methods resolve longer ones */
    SHORT = 6,     /* steps of a bounce that is judged even if it gives back less than it got */
    LAG_AB3 = 4,   /* looks at a free body until AB3 has no place in its past that has a speed from the contact */
    LAG_IMEX = 6,  /* and until imex has 0.1 % of its past left */
    FREE = 3,      /* looks at a free body from which its speed and acceleration follow */
    LAGGING = 20,  /* steps in which AB3 and imex resolve a bounce to 1 percent, */
    RESOLVED = 12, /* and other methods */
    FINE = 64,     /* small steps in a bounce, at least: RK4 leaves less than 1e-3 of the energy */
    CLEAR = 8,     /* small steps with a load, at least, else a bounce is made again in steps of a CLEARER-th; */
    CLEARER = 8,
    CLEARING = 3000000,     /* right-hand sides that this may take in a run, by the number of states */
    MORE = 3,               /* steps after which a body is free in small steps too, or bounces otherwise */
    SUSPECTS = 4,           /* that are explained */
    REST = 64,              /* steps without a look, at most */
    LOOKS = 4000,           /* that are always allowed, */
    LOOKS_SHARE = 20,       /* and one in so many right-hand sides, of which a look costs a fifth */
    BURST = 64,             /* looks that must be allowed before they go on */
    REPLAYS = 4000,         /* right-hand sides of small steps that are always allowed, */
    REPLAYS_SMALL = 200000, /* more by the number of states, */
    REPLAYS_SHARE = 100,    /* and one in so many of the run's */
};

static const double safety = 4;         /* numbers move so many times as far as they seem to, at most */
static const double too_much = 1.04;    /* the height of a bounce against the right one, all bounces so far */
static const double gain_least = 1.002; /* in one bounce: less is what speeds are known to */
static const double explains = 1;       /* angular frequency of an element times how long it has a load: pi without
                                         * dampers, 1.25 with strong ones, less where a load ends for other reasons */
/* Angular frequency times step: below it AB3 bounces lower than it should, and others err by a tenth of its square. */
static const double resolved = 0.5;
/* So many times as fast as it came a body goes away only where a method runs away: steps that resolve a contact leave
 * less until their past has no force of it. As energy in judge_bounce(). */
static const double runaway = 4;
static const double rebound_least = 0.01; /* relative to the energy before: less is no bounce */

/* What a state consists of. */
typedef struct Snapshot {
    double time, *state, *input;
    int32_t *discrete;
} Snapshot;

/* A bounce in progress. */
typedef struct Bounce {
    int contact;       /* -1: none */
    int steps;         /* since the last free look */
    int loaded;        /* looks with a load */
    int free;          /* the last looks, all without one */
    double gap, speed; /* before it: mean gap of two looks, negative, and speed of approach */
    double last[FREE]; /* gaps, newest first */
} Bounce;

/* A contact that bounces too high, to be explained after the run. */
typedef struct Suspect {
    int contact;
    double time, total, factor, lasts; /* s; all bounces so far; the last one; s of load in it */
    double worst;                      /* logarithm, of one bounce, either way */
    bool stays;                        /* in small steps it comes to rest; `factor` is against how it came */
    Snapshot free, deep;               /* before it, and where the element has most load in small steps */
} Suspect;

struct BounceWatch {
    Pool *pool;
    StepTheory *theory;
    const Engine *engine;
    const Scene *scene;
    gic_head *eye;  /* the instance for looks and small steps */
    gic_head *home; /* as it was at the first look */
    int count, states;
    int lag, lag_least;           /* looks at a free body before gaps, and speeds, are those of free motion */
    int64_t replays_free;         /* right-hand sides of small steps that are always allowed */
    int64_t clearing;             /* that are left for bounces much shorter than small steps */
    int64_t wait, looks, replays; /* steps before the next look; looks so far; right-hand sides of small steps so far */
    int64_t work;                 /* right-hand sides of the run so far */
    int known;                    /* looks that `press` has */
    double at[FREE], *press[FREE]; /* times and numbers of the last looks, newest first */
    Snapshot now, spare, start;    /* at the last look; the one before, or unused; before the bounce */
    Snapshot deep, risen;          /* in small steps: where it has most load, and where it was free last */
    const char *const *name;       /* of contacts */
    Bounce bounce;
    double *sum,
        *worst; /* of each contact: logarithm of the factor by which it bounces too high; the largest of one bounce */
    int suspects;
    Suspect suspect[SUSPECTS];
};

static double *numbers(Pool *pool, int count)
{
    return pool_alloc(pool, sizeof(double) * (size_t)(count + 1));
}

static Snapshot snapshot_new(Pool *pool, const gic_model *code)
{
    return (Snapshot){.state = numbers(pool, code->slow_count + code->fast_count),
                      .input = numbers(pool, code->input_count),
                      .discrete = pool_alloc(pool, sizeof(int32_t) * (size_t)(code->discrete_count + 1))};
}

BounceWatch *bounce_watch_new(Pool *pool, StepTheory *theory, const Scene *scene, const Engine *engine)
{
    const gic_model *code = engine->code;
    if (scene->method >= METHOD_ADAMS || !code->contacts || code->contact_count == 0 || engine->leave)
        return NULL;
    BounceWatch *watch = pool_alloc(pool, sizeof *watch);
    *watch = (BounceWatch){.pool = pool,
                           .theory = theory,
                           .engine = engine,
                           .scene = scene,
                           .count = code->contact_count,
                           .lag = scene->method == GIC_AB3    ? LAG_AB3
                                  : scene->method == GIC_IMEX ? LAG_IMEX
                                                              : 0,
                           .lag_least = scene->method == GIC_AB3    ? LAG_AB3 / 2
                                        : scene->method == GIC_IMEX ? LAG_IMEX
                                                                    : 0,
                           .replays_free = REPLAYS + REPLAYS_SMALL / (code->slow_count + code->fast_count + 1),
                           .clearing = CLEARING / (code->slow_count + code->fast_count + 1),
                           .states = code->slow_count + code->fast_count,
                           .now = snapshot_new(pool, code),
                           .spare = snapshot_new(pool, code),
                           .start = snapshot_new(pool, code),
                           .deep = snapshot_new(pool, code),
                           .risen = snapshot_new(pool, code),
                           .name = code->contacts->name,
                           .bounce = {.contact = -1}};
    watch->eye = instance_new(pool, engine);
    watch->home = instance_new(pool, engine);
    for (int k = 0; k < FREE; ++k)
        watch->press[k] = numbers(pool, watch->count);
    watch->sum = numbers(pool, watch->count);
    watch->worst = numbers(pool, watch->count);
    memset(watch->sum, 0, sizeof(double) * (size_t)watch->count);
    memset(watch->worst, 0, sizeof(double) * (size_t)watch->count);
    return watch;
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

static int32_t *discrete_of(const gic_model *code, gic_head *self)
{
    return (int32_t *)(void *)((char *)self + code->discrete_offset);
}

static void take(const BounceWatch *watch, const gic_model *code, const gic_head *self, Snapshot *to)
{
    gic_head *from = (gic_head *)self; /* only read */
    to->time = gic_time(self);
    memcpy(to->state, instance_array(from, code->state_offset), sizeof(double) * (size_t)watch->states);
    memcpy(to->input, instance_array(from, code->input_offset), sizeof(double) * (size_t)code->input_count);
    memcpy(to->discrete, discrete_of(code, from), sizeof(int32_t) * (size_t)code->discrete_count);
}

/* Put the watch's instance there. What it knows of poses is from its last look, which solutions start from. */
static void put(const BounceWatch *watch, const gic_model *code, const Snapshot *from)
{
    gic_head *eye = watch->eye;
    gic_restart(eye, from->time);
    memcpy(instance_array(eye, code->state_offset), from->state, sizeof(double) * (size_t)watch->states);
    memcpy(instance_array(eye, code->input_offset), from->input, sizeof(double) * (size_t)code->input_count);
    memcpy(discrete_of(code, eye), from->discrete, sizeof(int32_t) * (size_t)code->discrete_count);
}

static int eye_press(const BounceWatch *watch, const gic_model *code, double *press)
{
    gic_head *eye = watch->eye;
    return code->contacts->press(eye, gic_time(eye), instance_array(eye, code->state_offset), press);
}

/* ---- a bounce once more, in small steps -------------------------------------------------------------------------- */

/* How a free body moves at a time: its gap, negative, and the gap's first two derivatives. */
typedef struct Flight {
    double gap, speed, acceleration;
} Flight;

/* A state after `span` s at its present rates; *slope: of the number of a contact until then; *free: it has none of its
 * load then. */
static int move_on(const BounceWatch *watch, const gic_model *code, int contact, double span, double time,
                   double *state, double *slope, bool *free)
{
    double rate[watch->states], press[watch->count], later[watch->count];
    int status = code->rhs(watch->eye, time, state, rate);
    if (status == GIC_OK)
        status = code->contacts->press(watch->eye, time, state, press);
    for (int i = 0; i < watch->states; ++i)
        state[i] += span * rate[i];
    if (status == GIC_OK)
        status = code->contacts->press(watch->eye, time + span, state, later);
    *slope = status == GIC_OK ? (later[contact] - press[contact]) / span : 0;
    *free = status == GIC_OK && later[contact] <= 0;
    return status;
}

/* Of the bounce's contact at the state of the watch's instance; *free: false where the body is so near that it has a
 * load again at once. */
static int eye_flight(const BounceWatch *watch, const gic_model *code, Flight *flight, bool *free)
{
    const double longest = 1e-5, shortest = 1e-8; /* s; a speed is off by half of it times the acceleration */
    const int contact = watch->bounce.contact;
    const double time = gic_time(watch->eye);
    double state[watch->states], press[watch->count], speed, next;
    int status = eye_press(watch, code, press);
    *free = false;
    for (double span = longest; status == GIC_OK && !*free && span >= shortest; span /= 10) {
        memcpy(state, instance_array(watch->eye, code->state_offset), sizeof state);
        status = move_on(watch, code, contact, span, time, state, &speed, free);
        if (status == GIC_OK && *free)
            status = move_on(watch, code, contact, span, time + span, state, &next, free);
        if (status == GIC_OK && *free)
            *flight = (Flight){press[contact], speed, (next - speed) / span};
    }
    return status;
}

/* Twice the energy per mass of a body that moves freely with acceleration a. */
static double energy_of(const Flight *flight, double a)
{
    return flight->speed * flight->speed - 2 * a * flight->gap;
}

/* One small step, and the number of the bounce's contact after it. */
static int small_step(const BounceWatch *watch, const gic_model *code, double step, double *number)
{
    double press[watch->count];
    int status = gic_step(code, watch->eye, step, scene_implicit(watch->scene) ? GIC_ROS3 : GIC_RK4);
    if (status == GIC_OK)
        status = eye_press(watch, code, press);
    *number = status == GIC_OK ? press[watch->bounce.contact] : 0;
    return status;
}

/* How a bounce ends in small steps. */
typedef enum Ending {
    ENDS_UNKNOWN, /* a step fails */
    ENDS_FREE,
    ENDS_LOADED, /* the body is never free after the contact: it has come to rest there */
} Ending;

/* From the start of the bounce over `steps` of the run's, in `parts` parts each, and on until the body is free; where
 * it bounces again before, back to where it was free last. *flight: there; *lasts: s with a load. */
static Ending replay_in(BounceWatch *watch, const gic_model *code, int steps, int parts, Flight *flight, double *lasts)
{
    const int last = steps * parts;
    const double step = watch->scene->step / parts;
    double most = 0, number = 1;
    bool free = false;
    put(watch, code, &watch->start);
    *lasts = 0;
    double press[watch->count];
    if (eye_press(watch, code, press) != GIC_OK) { /* what it knows of poses is too far from here */
        memcpy(watch->eye, watch->home, code->size);
        put(watch, code, &watch->start);
    }
    for (int k = 0; k < last || (number > 0 && k < last + MORE * parts); ++k) {
        if (small_step(watch, code, step, &number) != GIC_OK)
            return ENDS_UNKNOWN;
        if (number > 0 && k < last)
            *lasts += step;
        if (number > most) {
            most = number;
            take(watch, code, watch->eye, &watch->deep);
        }
        if (number <= 0 && *lasts > 0) {
            free = true;
            take(watch, code, watch->eye, &watch->risen);
        }
    }
    if (number > 0 && free)
        put(watch, code, &watch->risen);
    if (number > 0 && !free)
        return ENDS_LOADED;
    const int status = eye_flight(watch, code, flight, &free);
    return status != GIC_OK ? ENDS_UNKNOWN : free ? ENDS_FREE : ENDS_LOADED;
}

/* Is a bounce in small steps what it is in steps of a CLEARER-th, up to a tenth of its energy, and long enough for
 * them?
 */
static bool is_clear(const Flight *coarse, const Flight *fine, double loaded)
{
    const double a = energy_of(coarse, coarse->acceleration), b = energy_of(fine, fine->acceleration);
    return loaded >= CLEAR && fabs(a - b) <= 0.1 * fabs(b);
}

/* The same in small steps; where the run's body has more energy than it came with, `gained`, in smaller and smaller
 * ones until that changes nothing. */
static Ending replay(BounceWatch *watch, const gic_model *code, int steps, bool gained, Flight *flight, double *lasts)
{
    const Scene *scene = watch->scene;
    const int least = (FINE + watch->bounce.loaded) / (watch->bounce.loaded + 1);
    int parts = least > scene->ratio ? least : scene->ratio;
    int64_t before = watch->eye->rhs_count;
    Ending ending = replay_in(watch, code, steps, parts, flight, lasts);
    bool clear = !gained;
    watch->replays += watch->eye->rhs_count - before;
    while (!clear && (int64_t)(steps + MORE) * parts * CLEARER * 4 <= watch->clearing) {
        const Flight coarse = *flight;
        const Ending before_that = ending;
        parts *= CLEARER;
        before = watch->eye->rhs_count;
        ending = replay_in(watch, code, steps, parts, flight, lasts);
        watch->clearing -= watch->eye->rhs_count - before;
        clear =
            before_that == ending &&
            (ending == ENDS_LOADED || (ending == ENDS_FREE && is_clear(&coarse, flight, *lasts / scene->step * parts)));
    }
    return clear || ending == ENDS_FREE ? ending : ENDS_UNKNOWN;
}

/* The bounce makes its contact bounce too high. */
static void suspect(BounceWatch *watch, const gic_model *code, double factor, double lasts, bool stays)
{
    double *sum = &watch->sum[watch->bounce.contact];
    Suspect *now = &watch->suspect[watch->suspects++];
    *now = (Suspect){.contact = watch->bounce.contact,
                     .time = watch->now.time,
                     .total = exp(*sum),
                     .factor = factor,
                     .worst = watch->worst[watch->bounce.contact],
                     .lasts = lasts,
                     .stays = stays,
                     .free = watch->start,
                     .deep = watch->deep};
    watch->start = snapshot_new(watch->pool, code);
    watch->deep = snapshot_new(watch->pool, code);
    *sum = 0;
}

/* Did a bounce of many steps give back less than it got? Then it need not be made again: dampers of an element, or
 * methods that lose energy, only lower what comes of it. */
static bool gives_back_less(BounceWatch *watch)
{
    const Bounce *bounce = &watch->bounce;
    const double step = watch->scene->step, *gap = bounce->last;
    if (bounce->loaded <= SHORT || bounce->free < watch->lag + FREE || isnan(bounce->speed))
        return false;
    const double a = (gap[0] - 2 * gap[1] + gap[2]) / (step * step);
    const double after = energy_of(&(Flight){gap[1], (gap[0] - gap[2]) / (2 * step), a}, a);
    const double before = energy_of(&(Flight){bounce->gap, bounce->speed, a}, a);
    if (!(before > 0 && after < gain_least * before))
        return false;
    if (after > 0)
        watch->sum[bounce->contact] += fmin(0, log(after / before));
    return true;
}

/* The run's body is free again, at `at`, so many steps after the start. least_factor: smaller ones say nothing yet. */
static void judge_bounce(BounceWatch *watch, const gic_model *code, const Snapshot *at, int steps, double least_factor)
{
    const Bounce *bounce = &watch->bounce;
    if (gives_back_less(watch) || watch->replays > watch->replays_free + watch->work / REPLAYS_SHARE)
        return;
    Flight now, right;
    double lasts;
    bool stays = false;
    put(watch, code, at);
    bool free = false;
    const bool known = eye_flight(watch, code, &now, &free) == GIC_OK && free;
    const Flight came = {bounce->gap, bounce->speed, 0};
    const bool gained = known && energy_of(&now, now.acceleration) > runaway * energy_of(&came, now.acceleration);
    const Ending ending = known ? replay(watch, code, steps, gained, &right, &lasts) : ENDS_UNKNOWN;
    if (ending == ENDS_LOADED && gained) { /* it should have come to rest: nothing to compare with but how it came */
        right = came;
        stays = true;
    } else if (ending != ENDS_FREE) {
        return;
    }
    const double least = isnan(bounce->speed) ? 0 : rebound_least * bounce->speed * bounce->speed;
    const double a = now.gap < right.gap ? now.acceleration : right.acceleration; /* the other may be at its end */
    const double after = energy_of(&now, a), low = fmax(energy_of(&right, a), least);
    if (!(after > 0) || !(low > 0))
        return;
    const double factor = after / low;
    if (factor < least_factor)
        return;
    watch->sum[bounce->contact] += log(factor);
    watch->worst[bounce->contact] = fmax(watch->worst[bounce->contact], fabs(log(factor)));
    if (watch->sum[bounce->contact] > log(too_much) && lasts > 0)
        suspect(watch, code, factor, lasts, stays);
}

/* ---- while the run goes on --------------------------------------------------------------------------------------- */

static int look(BounceWatch *watch, const gic_model *code)
{
    double *oldest = watch->press[FREE - 1];
    memmove(watch->press + 1, watch->press, sizeof *watch->press * (FREE - 1));
    memmove(watch->at + 1, watch->at, sizeof *watch->at * (FREE - 1));
    watch->press[0] = oldest;
    watch->at[0] = watch->now.time;
    watch->known += watch->known < FREE;
    ++watch->looks;
    put(watch, code, &watch->now);
    return eye_press(watch, code, oldest);
}

/* Does the gap of a contact close within the step before the last look, though both its ends are free? Stages may have
 * met the element between them; so they may where a body that was near has turned round. */
static bool may_have_touched(const BounceWatch *watch, int i)
{
    const double now = watch->press[0][i], before = watch->press[1][i], first = watch->press[2][i];
    const double speed = (before - first) / (watch->at[1] - watch->at[2]);
    const double ahead = speed * watch->scene->step * (now < before ? safety : 1);
    return watch->known == FREE && now <= 0 && before <= 0 && first < before && before + ahead > 0;
}

/* A contact that the last look sees first begins a bounce; so does one that has a load at the first look of all. */
static void begin_bounce(BounceWatch *watch)
{
    const double step = watch->scene->step, *now = watch->press[0], *before = watch->press[1], *first = watch->press[2];
    const bool first_look = watch->looks == 1;
    if (!first_look && (watch->known < 2 || watch->at[0] - watch->at[1] > 1.5 * step))
        return;
    for (int i = 0; i < watch->count; ++i) {
        const bool loaded = now[i] > 0, from_free = !first_look && before[i] <= 0;
        if (!(loaded && (from_free || first_look)) && !(from_free && may_have_touched(watch, i)))
            continue;
        watch->bounce = (Bounce){.contact = i, .steps = !first_look, .loaded = loaded, .free = !loaded, .speed = NAN};
        watch->bounce.last[0] = now[i];
        if (from_free && watch->known == FREE && first[i] <= 0) {
            watch->bounce.gap = (before[i] + first[i]) / 2;
            watch->bounce.speed = (before[i] - first[i]) / (watch->at[1] - watch->at[2]);
        }
        return;
    }
}

/* Has the body gone away too far since it became free? It may come back before it has been free for long. */
static bool runs_away(const BounceWatch *watch)
{
    const Bounce *bounce = &watch->bounce;
    const double farthest = runaway * bounce->speed * watch->scene->step * (bounce->free + 1);
    return bounce->free > 0 && bounce->loaded > 0 && -bounce->last[0] > farthest; /* false where no speed is known */
}

/* One look more at the bounce, which is judged when the body has been free for a while, or just before the next one.
 * before: the look before. */
static void follow_bounce(BounceWatch *watch, const gic_model *code, const Snapshot *before)
{
    Bounce *bounce = &watch->bounce;
    const double now = watch->press[0][bounce->contact];
    if (now > 0 && bounce->free > watch->lag_least) {
        judge_bounce(watch, code, before, bounce->steps, 0);
        bounce->contact = -1;
        return;
    }
    ++bounce->steps;
    memmove(bounce->last + 1, bounce->last, sizeof *bounce->last * (FREE - 1));
    bounce->last[0] = now;
    bounce->loaded += now > 0;
    bounce->free = now > 0 ? 0 : bounce->free + 1;
    const bool away = runs_away(watch), ends = bounce->free >= watch->lag + FREE;
    if (away || ends)
        judge_bounce(watch, code, &watch->now, bounce->steps, ends ? 0 : runaway);
    if (away || ends || bounce->loaded > LONGEST)
        bounce->contact = -1;
}

/* Steps in which no number comes to 0, unless it moves `safety` times as far as it seems to. */
static int64_t steps_to_rest(const BounceWatch *watch)
{
    if (watch->known < FREE || watch->bounce.contact >= 0)
        return 0;
    const double step = watch->scene->step, late = watch->at[0] - watch->at[1], early = watch->at[1] - watch->at[2];
    double least = REST;
    for (int i = 0; i < watch->count; ++i) {
        const double number = watch->press[0][i], speed = (number - watch->press[1][i]) / late;
        const double past = (watch->press[1][i] - watch->press[2][i]) / early, a = 2 * (speed - past) / (late + early);
        const double far = fabs(number) / safety;
        least = fmin(least, fmin(far / (fabs(speed) + DBL_MIN), sqrt(far / (fabs(a) + DBL_MIN))) / step);
    }
    return least >= 3 ? (int64_t)least - 3 : 0; /* three looks in a row come before a bounce */
}

void bounce_watch_step(BounceWatch *watch, const gic_model *code, const gic_head *self)
{
    const Scene *scene = watch->scene;
    if (watch->suspects == SUSPECTS || watch->wait-- > 0)
        return;
    watch->work = self->rhs_count;
    if (scene->rest && scene->rest->asleep) {
        watch->known = 0;
        watch->bounce.contact = -1;
        watch->wait = REST;
        return;
    }
    const int64_t allowed = LOOKS + watch->work / LOOKS_SHARE;
    if (watch->looks >= allowed && watch->bounce.contact < 0) {
        watch->wait = BURST * LOOKS_SHARE;
        watch->known = 0;
        return;
    }
    if (watch->looks == 0) {
        memcpy(watch->eye, self, code->size);
        watch->eye->locate = 0;
        watch->eye->most = 0;
        memcpy(watch->home, watch->eye, code->size);
    }
    const Snapshot before = watch->now;
    watch->now = watch->spare;
    watch->spare = before;
    take(watch, code, self, &watch->now);
    if (look(watch, code) != GIC_OK) {
        watch->known = 0;
        watch->bounce.contact = -1;
        return;
    }
    if (watch->bounce.contact >= 0)
        follow_bounce(watch, code, &watch->spare);
    if (watch->bounce.contact < 0) {
        begin_bounce(watch);
        if (watch->bounce.contact >= 0) { /* the state at the look before is where it starts from */
            watch->spare = watch->start;
            watch->start = before;
            if (watch->looks == 1) { /* or the only one */
                watch->start = watch->now;
                watch->now = watch->spare;
                watch->spare = before;
            }
        }
    }
    watch->wait = steps_to_rest(watch);
}

int64_t bounce_watch_idle(const BounceWatch *watch)
{
    return watch->suspects == SUSPECTS ? INT64_MAX : watch->wait > 0 ? watch->wait : 0;
}

void bounce_watch_pass(BounceWatch *watch, int64_t steps)
{
    watch->wait -= steps;
}

/* ---- after the run ----------------------------------------------------------------------------------------------- */

/* The angular frequency that the element of a suspect adds; 0: none. */
static double frequency_of(const BounceWatch *watch, const Suspect *suspect)
{
    const Snapshot *const at[2] = {&suspect->free, &suspect->deep};
    double sum[2];
    for (int k = 0; k < 2; ++k)
        sum[k] = step_theory_stiffness(watch->theory, watch->scene, watch->engine, at[k]->time, at[k]->state,
                                       at[k]->input, at[k]->discrete);
    return sqrt(fmax(sum[1] - sum[0], 0));
}

/* Do steps that are too long for the element explain what a suspect does? Not where it has a load for a shorter time
 * than its stiffness makes it have one, nor where steps that resolve the element go wrong by more than it makes them,
 * as of wheels that pass over an edge or a rough road. */
static bool is_explained(const BounceWatch *watch, const Suspect *suspect)
{
    const double frequency = frequency_of(watch, suspect), turn = frequency * watch->scene->step;
    const bool small = watch->scene->method != GIC_AB3 && suspect->worst <= 0.2 * turn * turn;
    return frequency * suspect->lasts >= explains && (turn >= resolved || small);
}

const char *bounce_watch_judge(const BounceWatch *watch, const char **remedy)
{
    const Suspect *found = NULL;
    for (int k = 0; k < watch->suspects && !found; ++k)
        found = is_explained(watch, &watch->suspect[k]) ? &watch->suspect[k] : NULL;
    if (!found)
        return NULL;
    Pool *pool = watch->pool;
    const Scene *scene = watch->scene;
    const bool lags = scene->method == GIC_AB3 || scene->method == GIC_IMEX;
    const double pi = 3.141592653589793;
    const double shortest = fmin(found->lasts, pi / frequency_of(watch, found));
    const double bounce = found->stays ? shortest : found->lasts;
    /* steps that end where contacts begin do not help where a contact is over within one */
    const bool helps = !scene->locate && !found->stays && shortest > scene->step;
    *remedy = pool_print(pool, "take steps of at most about %.2g s%s, or variable ones (--integrator adams)",
                         bounce / (lags ? LAGGING : RESOLVED),
                         helps ? ", or `locate: true`, which ends steps where contacts begin and end" : "");
    const char *times = pool_print(pool, "it is in contact for %.3g s, %.2g steps of %.6g s (%s)", found->lasts,
                                   found->lasts / scene->step, scene->step, integrator_name(scene->method));
    if (found->stays)
        return pool_print(pool,
                          "%s gives back more than it may: at t = %.4g s a body goes away with %.3g times the energy "
                          "that it came with, and in small steps comes to rest there; %s",
                          watch->name[found->contact], found->time, found->factor, times);
    return pool_print(pool,
                      "%s gives back more than it may: at t = %.4g s a body bounces %.3g times as high as in small "
                      "steps%s; %s",
                      watch->name[found->contact], found->time, found->factor,
                      found->total > 1.001 * found->factor
                          ? pool_print(pool, ", with bounces before it %.3g times", found->total)
                          : "",
                      times);
}
