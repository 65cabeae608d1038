/* SPDX-License-Identifier: MIT
 * The number of a contact is above 0 where there is a load. A step in which no evaluation has seen another sign than
 * at its start is one of a smooth problem. (None is asked so soon that every number would have to move four times as
 * far as it seems to.) Between evaluations the number may still reach 0 and come back; where its
 * slope says so it is compared with both tangents, which meet beyond all of a curve that bends one way. Whether it
 * bends another way is asked on the cubic through states and rates at the step's ends: where value and slope in the
 * middle are not what those at both ends say, halves are looked at alike, and so on. So a damped stop is seen that
 * lets go far outside, takes hold again for 0.1 ms just before its end, and is left for a flight that needs but one
 * step. */
#include "run/contact_watch.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EVALUATIONS = 32, LOOKS = 1024, FINER = 10 };

static const double difference = 1e-6; /* s, at most, for slopes */

/* Signs that an evaluation has seen, a bit a contact. */
typedef struct Signs {
    double time;
    uint64_t above, below;
} Signs;

struct ContactWatch {
    int count, evaluations;
    double start;                                          /* s, of the step */
    bool known;                                            /* bend[] is */
    int side[GIC_CONTACTS];                                /* 1: with a load, -1: without, 0: at 0 and to stay there */
    int last[GIC_CONTACTS];                                /* the last one that was not 0; 0: none yet */
    double here[GIC_CONTACTS], slope[GIC_CONTACTS];        /* at the start of the step */
    double there[GIC_CONTACTS], slope_there[GIC_CONTACTS]; /* at its end */
    double bend[GIC_CONTACTS];                             /* change of the slope over time in the step before */
    double most[2][GIC_CONTACTS];                          /* the largest number so far: without a load, with one */
    int changed;                                           /* the last contact that was met; -1: none */
    double rounding;                                       /* of numbers, by the size of the state */
    double low, high;                                      /* s from the start: the change that was met is between */
    Signs seen[EVALUATIONS];
};

ContactWatch *contact_watch_new(void)
{
    ContactWatch *watch = calloc(1, sizeof *watch);
    if (watch)
        watch->changed = -1;
    return watch;
}

void contact_watch_free(ContactWatch *watch)
{
    free(watch);
}

static double *array_of(void *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

static int numbers_at(const gic_model *model, gic_head *self, double time, const double *state, double *press)
{
    if (self->input_function)
        self->input_function(self->user, self->lane, time, array_of(self, model->input_offset));
    return model->contacts->press(self, time, state, press);
}

/* The sign of a contact's number, 0 where rounding decides. */
static int sign_of(const ContactWatch *watch, int i, double press)
{
    const double size = fabs(press);
    return size <= watch->rounding + 1e-11 * watch->most[press > 0][i] ? 0 : press > 0 ? 1 : -1;
}

/* Slopes of all numbers at a state of the instance, from which they are `press`, over `span` s (backwards: < 0). */
static int slopes_at(const gic_model *model, gic_head *self, const double *rate, const double *press, double span,
                     double *slope)
{
    const int n = model->slow_count + model->fast_count;
    const double *state = array_of(self, model->state_offset), time = gic_time(self), moved = time + span - time;
    double near[n];
    for (int i = 0; i < n; ++i)
        near[i] = state[i] + moved * rate[i];
    const int status = numbers_at(model, self, time + moved, near, slope);
    for (int i = 0; i < model->contact_count && status == GIC_OK; ++i)
        slope[i] = (slope[i] - press[i]) / moved;
    return status;
}

/* Inputs as the instance has them belong to its time. */
static void inputs_back(const gic_model *model, gic_head *self)
{
    if (self->input_function)
        self->input_function(self->user, self->lane, gic_time(self), array_of(self, model->input_offset));
}

/* Contacts that are shorter (s) are none. */
static double shortest(double time)
{
    return 1e-10 + 64 * DBL_EPSILON * fabs(time);
}

static void note_sizes(ContactWatch *watch)
{
    for (int i = 0; i < watch->count; ++i) {
        double *most = &watch->most[watch->here[i] > 0][i];
        *most = fmax(*most, fabs(watch->here[i]));
    }
}

void contact_watch_forget(ContactWatch *watch)
{
    memset(watch->last, 0, sizeof watch->last);
}

int contact_watch_start(ContactWatch *watch, const gic_model *model, gic_head *self)
{
    const int n = model->slow_count + model->fast_count;
    const double time = gic_time(self), span = difference + 64 * DBL_EPSILON * fabs(time);
    double *state = array_of(self, model->state_offset), rate[n], size = 1;
    for (int i = 0; i < n; ++i)
        size = fmax(size, fabs(state[i]));
    watch->count = model->contact_count;
    watch->rounding = 16 * DBL_EPSILON * size;
    int status = numbers_at(model, self, time, state, watch->here);
    if (status == GIC_OK)
        status = model->rhs(self, time, state, rate);
    if (status == GIC_OK)
        status = slopes_at(model, self, rate, watch->here, span, watch->slope);
    inputs_back(model, self);
    memset(watch->bend, 0, sizeof watch->bend);
    watch->known = false;
    watch->start = time;
    note_sizes(watch);
    for (int i = 0; i < watch->count && status == GIC_OK; ++i) {
        const double slope = watch->slope[i];
        watch->side[i] = sign_of(watch, i, watch->here[i]);
        if (!watch->side[i] && fabs(slope) * span > 4 * watch->rounding)
            watch->side[i] = slope > 0 ? 1 : -1;
        if (watch->side[i]) {
            self->contact_count += watch->last[i] == -watch->side[i];
            watch->last[i] = watch->side[i];
        }
    }
    return status;
}

void contact_watch_try(ContactWatch *watch)
{
    watch->evaluations = 0;
}

/* Would a number have to move four times as far as it seems to, to be 0 within `passed` s? */
static bool can_not_reach(double number, double slope, double bend, double passed)
{
    const double safety = 4;
    return fabs(number) > safety * passed * (fabs(slope) + passed * fabs(bend));
}

/* Is every contact so far from a change that an evaluation so soon can't be near it? */
static bool is_far(const ContactWatch *watch, double time)
{
    bool far = watch->known;
    for (int i = 0; i < watch->count && far; ++i)
        far = watch->side[i] && can_not_reach(watch->here[i], watch->slope[i], watch->bend[i], time - watch->start);
    return far;
}

/* The same looking back from the end of the step. */
static bool is_far_there(const ContactWatch *watch, double length)
{
    bool far = true;
    for (int i = 0; i < watch->count && far; ++i)
        far = can_not_reach(watch->there[i], watch->slope_there[i], (watch->slope_there[i] - watch->slope[i]) / length,
                            length);
    return far;
}

int contact_watch_look(ContactWatch *watch, const gic_model *model, gic_head *self, double time, const double *state)
{
    double press[GIC_CONTACTS];
    const bool far = is_far(watch, time);
    const int status = far ? GIC_OK : model->contacts->press(self, time, state, press);
    Signs now = {time, 0, 0};
    for (int i = 0; i < model->contact_count && status == GIC_OK && !far; ++i) {
        const int sign = sign_of(watch, i, press[i]);
        now.above |= (uint64_t)(sign > 0) << i;
        now.below |= (uint64_t)(sign < 0) << i;
    }
    watch->seen[watch->evaluations++ % EVALUATIONS] = now;
    return status;
}

/* What the evaluations of the step that ended at `end` have seen; those before one beyond its end are of tries that
 * were given up. */
static Signs seen_until(const ContactWatch *watch, double end)
{
    Signs all = {end, 0, 0};
    for (int k = watch->evaluations - 1; k >= 0 && k > watch->evaluations - 1 - EVALUATIONS; --k) {
        const Signs *seen = &watch->seen[k % EVALUATIONS];
        if (seen->time > end + 4 * DBL_EPSILON * fabs(end))
            break;
        all.above |= seen->above;
        all.below |= seen->below;
    }
    return all;
}

/* Numbers and slopes of all contacts, `at` s after the start of a step. */
typedef struct Look {
    double at, press[GIC_CONTACTS], slope[GIC_CONTACTS];
} Look;

/* Could contact i reach 0 between two looks and come back? */
static bool may_turn(const ContactWatch *watch, int i, const Look *from, const Look *to)
{
    const double side = watch->side[i], d0 = side * from->press[i], d1 = side * to->press[i];
    const double s0 = side * from->slope[i], s1 = side * to->slope[i], length = to->at - from->at;
    if (!(s0 < 0 && s1 > 0))
        return false;
    const double meet = (d1 - d0 - s1 * length) / (s0 - s1);
    const bool within = meet > 0 && meet < length;
    const double least = within ? d0 + s0 * meet : fmin(d0 + s0 * length, d1 - s1 * length);
    return least < 0 && sign_of(watch, i, side * least);
}

/* A search along the cubic through states and rates at the ends of a step. */
typedef struct Search {
    ContactWatch *watch;
    const gic_model *model;
    gic_head *self; /* at the end of the step */
    const ContactStep *step;
    int looks; /* that are left */
} Search;

static int numbers_between(const Search *search, double at, double *press)
{
    const ContactStep *step = search->step;
    const int n = search->model->slow_count + search->model->fast_count;
    const double *to = array_of(search->self, search->model->state_offset);
    const double length = step->length, s = at / length, r = (length - at) / length;
    double state[n];
    for (int i = 0; i < n; ++i)
        state[i] = step->from[i] + s * s * (3 - 2 * s) * (to[i] - step->from[i]) +
                   length * s * r * (r * step->rate[i] - s * step->rate_there[i]);
    return numbers_at(search->model, search->self, gic_time(search->self) - (length - at), state, press);
}

/* The slopes of a look whose numbers are known, in the middle of `width` s. */
static int slopes_between(const Search *search, double width, Look *look)
{
    const double time = gic_time(search->self);
    const double span = fmin(difference, width / 1024) + 64 * DBL_EPSILON * fabs(time);
    const double moved = look->at + span - look->at;
    const int status = numbers_between(search, look->at + moved, look->slope);
    for (int i = 0; i < search->model->contact_count && status == GIC_OK; ++i)
        look->slope[i] = (look->slope[i] - look->press[i]) / moved;
    return status;
}

/* The change of contact i is between two looks: come nearer to it. */
static int narrow(const Search *search, int i, double low, double high)
{
    ContactWatch *watch = search->watch;
    int status = GIC_OK;
    for (int k = 0; k < FINER && status == GIC_OK; ++k) {
        double press[GIC_CONTACTS], middle = 0.5 * (low + high);
        status = numbers_between(search, middle, press);
        if (status == GIC_OK && sign_of(watch, i, press[i]) == watch->side[i])
            low = middle;
        else
            high = middle;
    }
    watch->low = low;
    watch->high = high;
    watch->changed = i;
    return status;
}

/* By how much contact i has another number in the middle of two looks than they say. */
static double value_off(int i, const Look *from, const Look *middle, const Look *to)
{
    const double length = to->at - from->at;
    return fabs(middle->press[i] - (from->press[i] + to->press[i]) / 2 - length / 8 * (from->slope[i] - to->slope[i]));
}

/* The same of its slope, times what that makes of a number. */
static double slope_off(int i, const Look *from, const Look *middle, const Look *to)
{
    const double length = to->at - from->at, mean = (to->press[i] - from->press[i]) / length;
    return length / 8 * fabs(middle->slope[i] - 1.5 * mean + (from->slope[i] + to->slope[i]) / 4);
}

static double nearest(int i, const Look *from, const Look *middle, const Look *to)
{
    return fmin(fabs(middle->press[i]), fmin(fabs(from->press[i]), fabs(to->press[i])));
}

/* Are all numbers in the middle so far from 0, and so much what both looks say, that no slope need be asked for? */
static bool is_plain(const ContactWatch *watch, const Look *from, const Look *middle, const Look *to)
{
    const double part = 1.0 / 1024;
    bool plain = true;
    for (int i = 0; i < watch->count && plain; ++i)
        plain = !watch->side[i] || value_off(i, from, middle, to) <= part * nearest(i, from, middle, to);
    return plain;
}

/* Might contact i do between two looks what they and the one in their middle do not tell? Not where it is far from 0 by
 * what they know, or they know it well by its own size (from 0 on it is never far). */
static bool is_unclear(const ContactWatch *watch, int i, const Look *from, const Look *middle, const Look *to)
{
    const double off = fmax(value_off(i, from, middle, to), slope_off(i, from, middle, to));
    const double far = 1.0 / 8, well = 1.0 / 8192, size = fmax(fabs(from->press[i]), fabs(to->press[i]));
    return (off > fmax(far * nearest(i, from, middle, to), well * size) && sign_of(watch, i, off)) ||
           may_turn(watch, i, from, middle) || may_turn(watch, i, middle, to);
}

/* Is any contact on the other side somewhere between two looks, at which none is? The first such place is narrowed. */
static int search_between(Search *search, const Look *from, const Look *to, bool *met)
{
    const ContactWatch *watch = search->watch;
    const double width = to->at - from->at;
    Look middle = {.at = from->at + 0.5 * width};
    int status = numbers_between(search, middle.at, middle.press);
    search->looks -= 2;
    for (int i = 0; i < watch->count && status == GIC_OK; ++i)
        if (watch->side[i] * sign_of(watch, i, middle.press[i]) < 0) {
            *met = true;
            return narrow(search, i, from->at, middle.at);
        }
    if (status != GIC_OK || is_plain(watch, from, &middle, to))
        return status;
    status = slopes_between(search, width, &middle);
    bool unclear = false;
    for (int i = 0; i < watch->count && !unclear; ++i)
        unclear = watch->side[i] && is_unclear(watch, i, from, &middle, to);
    if (status != GIC_OK || !unclear || search->looks <= 0 || width <= shortest(gic_time(search->self)))
        return status;
    status = search_between(search, from, &middle, met);
    return status == GIC_OK && !*met ? search_between(search, &middle, to, met) : status;
}

/* `from` and `to`: NULL where no contact can have been near a change. */
static ContactFinding judge(ContactWatch *watch, int i, const Signs *seen, const Look *from, const Look *to)
{
    const int sign = sign_of(watch, i, watch->there[i]), side = watch->side[i];
    const bool above = seen->above >> i & 1 || sign > 0, below = seen->below >> i & 1 || sign < 0;
    if ((above && side < 0) || (below && side > 0) || (above && below))
        return CONTACTS_CHANGE;
    if (side && from && may_turn(watch, i, from, to))
        return CONTACTS_TURN;
    if (side && !sign)
        return CONTACTS_REACHED;
    /* rounding alone had kept it at 0, and the step did not know better */
    if (!side && sign)
        watch->side[i] = sign;
    return CONTACTS_KEPT;
}

int contact_watch_end(ContactWatch *watch, const gic_model *model, gic_head *self, const ContactStep *step,
                      ContactFinding *finding)
{
    const double time = gic_time(self), length = step->length;
    const double span = fmin(difference, length / 16) + 64 * DBL_EPSILON * fabs(time);
    int status = numbers_at(model, self, time, array_of(self, model->state_offset), watch->there);
    if (status == GIC_OK)
        status = slopes_at(model, self, step->rate_there, watch->there, -span, watch->slope_there);
    const bool far = status == GIC_OK && is_far(watch, time) && is_far_there(watch, length);
    Look from = {.at = 0}, to = {.at = length};
    memcpy(from.press, watch->here, sizeof from.press);
    memcpy(from.slope, watch->slope, sizeof from.slope);
    memcpy(to.press, watch->there, sizeof to.press);
    memcpy(to.slope, watch->slope_there, sizeof to.slope);
    const Signs seen = seen_until(watch, time);
    *finding = CONTACTS_KEPT;
    watch->low = 0;
    watch->high = length;
    for (int i = 0; i < watch->count && status == GIC_OK; ++i) {
        const ContactFinding now = judge(watch, i, &seen, far ? NULL : &from, &to);
        if (now > *finding)
            watch->changed = i;
        *finding = now > *finding ? now : *finding;
    }
    if (status == GIC_OK && !far && *finding < CONTACTS_TURN) {
        Search search = {watch, model, self, step, LOOKS};
        bool met = false;
        status = search_between(&search, &from, &to, &met);
        *finding = met ? CONTACTS_CHANGE : *finding;
    }
    inputs_back(model, self);
    return status;
}

void contact_watch_place(const ContactWatch *watch, double *low, double *high)
{
    *low = watch->low;
    *high = watch->high;
}

int contact_watch_changed(const ContactWatch *watch)
{
    return watch->changed;
}

void contact_watch_keep(ContactWatch *watch, double length)
{
    watch->start += length;
    watch->known = true;
    for (int i = 0; i < watch->count; ++i) {
        watch->bend[i] = (watch->slope_there[i] - watch->slope[i]) / length;
        watch->here[i] = watch->there[i];
        watch->slope[i] = watch->slope_there[i];
    }
    note_sizes(watch);
}

/* The first time at which d + s t + b t^2 / 2 is 0, for d > 0. */
static double first_root(double d, double s, double b)
{
    const double inner = s * s - 2 * b * d;
    const double below = sqrt(inner) - s; /* 2 d over it is the root, without a difference of near numbers */
    return inner >= 0 && below > 0 ? 2 * d / below : (double)INFINITY;
}

double contact_watch_ahead(const ContactWatch *watch)
{
    double soonest = INFINITY;
    for (int i = 0; i < watch->count; ++i) {
        const double side = watch->side[i], d = side * watch->here[i];
        if (d > 0)
            soonest = fmin(soonest, first_root(d, side * watch->slope[i], side * watch->bend[i]));
    }
    return soonest;
}
