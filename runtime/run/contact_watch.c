/* SPDX-License-Identifier: MIT
 * The number of a contact is above 0 where there is a load. A step in which no evaluation has seen another sign than
 * at its start is one of a smooth problem. (None is asked so soon that every number would have to move four times as
 * far as it seems to.) Between evaluations the number may still reach 0 and come back; where its
 * slope says so it is compared with both tangents, which meet beyond all of a curve that bends one way. That it bends
 * no other way its value in the middle of the step must show. */
#include "run/contact_watch.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EVALUATIONS = 32 };

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

/* Could contact i reach 0 between both ends of the step and come back? */
static bool may_turn(const ContactWatch *watch, int i, double length)
{
    const double side = watch->side[i], d0 = side * watch->here[i], d1 = side * watch->there[i];
    const double s0 = side * watch->slope[i], s1 = side * watch->slope_there[i];
    if (!(s0 < 0 && s1 > 0))
        return false;
    const double meet = (d1 - d0 - s1 * length) / (s0 - s1);
    const bool within = meet > 0 && meet < length;
    const double least = within ? d0 + s0 * meet : fmin(d0 + s0 * length, d1 - s1 * length);
    return least < 0 && sign_of(watch, i, side * least);
}

/* Is the number of contact i, `half` in the middle of the step, other than values and slopes at its ends say? */
static bool is_bent(const ContactWatch *watch, int i, double length, double half)
{
    const double here = watch->here[i], there = watch->there[i], part = 1.0 / 8;
    const double due = (here + there) / 2 + length / 8 * (watch->slope[i] - watch->slope_there[i]);
    return fabs(half - due) > part * fmax(fabs(here), fabs(there)) && sign_of(watch, i, half - due);
}

/* Numbers in the middle of the step, on the cubic through states and rates at its ends. */
static int numbers_between(const gic_model *model, gic_head *self, const ContactStep *step, double *press)
{
    const int n = model->slow_count + model->fast_count;
    const double *to = array_of(self, model->state_offset);
    double half[n];
    for (int i = 0; i < n; ++i)
        half[i] = (step->from[i] + to[i]) / 2 + step->length / 8 * (step->rate[i] - step->rate_there[i]);
    return numbers_at(model, self, gic_time(self) - step->length / 2, half, press);
}

static ContactFinding judge(ContactWatch *watch, int i, const Signs *seen, const double *half, double length)
{
    const int sign = sign_of(watch, i, watch->there[i]), side = watch->side[i];
    const int middle = half ? sign_of(watch, i, half[i]) : 0;
    const bool above = seen->above >> i & 1 || sign > 0 || middle > 0;
    const bool below = seen->below >> i & 1 || sign < 0 || middle < 0;
    if ((above && side < 0) || (below && side > 0) || (above && below))
        return CONTACTS_CHANGE;
    if (side && half && (may_turn(watch, i, length) || is_bent(watch, i, length, half[i])))
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
    double half[GIC_CONTACTS];
    int status = numbers_at(model, self, time, array_of(self, model->state_offset), watch->there);
    if (status == GIC_OK)
        status = slopes_at(model, self, step->rate_there, watch->there, -span, watch->slope_there);
    const bool far = status == GIC_OK && is_far(watch, time) && is_far_there(watch, length);
    if (status == GIC_OK && !far)
        status = numbers_between(model, self, step, half);
    inputs_back(model, self);
    if (status != GIC_OK)
        return status;
    const Signs seen = seen_until(watch, time);
    *finding = CONTACTS_KEPT;
    for (int i = 0; i < watch->count; ++i) {
        const ContactFinding now = judge(watch, i, &seen, far ? NULL : half, length);
        if (now > *finding)
            watch->changed = i;
        *finding = now > *finding ? now : *finding;
    }
    return GIC_OK;
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
