/* SPDX-License-Identifier: MIT
 * Contacts that are located within steps, in a run with derivatives. The runtime core finds them (gic_runtime.c), by
 * steps of both without derivatives; which pieces it has made in the end is seen from the times at which it evaluates
 * rates. Then the step is made again in these pieces, whose ends are clocks where the number of a contact is 0.
 * Pieces that end elsewhere, as where a contact comes near, or parts of loads that bend, stay where they are.
 *
 * A contact that begins or ends just at the end of a step, as numbers that people write let it, needs no piece, but
 * there an evaluation of the rates may be on either side of it, and its derivatives lack a stiffness, or have one too
 * many: a sixth of the change in such a step, with a stiff contact more than all else. So the part of the step next to
 * it is made by itself, a millionth of the step.
 *
 * One that is grazed, as by a wheel that just touches where a step begins and is let go, so that its rate comes from
 * next to nothing, has a time whose derivative is without bound, while what it does to the state is not: forces are
 * continuous there, so that the time may as well stay. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/tangent_private.h"
#include "tape/engine_tape.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Made by RK4 in `parts` parts, of `start` to `end`, s. */
typedef struct Piece {
    double start, end;
    int parts;
    bool stays; /* its end is that of no contact */
} Piece;

static const double next_to = 1e-6;       /* of a step: what is made by itself next to a contact at its end */
static const double grazing = 1e-3;       /* of a step: a contact as near to its start may be grazed */
static const double beyond = 1e-4;        /* of a step: past a contact that is grazed */
static const double least_change = 1e-12; /* of a contact's number within a step, m or more: below it is noise */

typedef struct Watch {
    Saved *before, *after, *here;
    bool looking, kept_plain; /* the core looks at contacts, after the step itself */
    double *time;             /* of evaluations since then or since the last look */
    int times;
    Piece *piece;
    int pieces;
} Watch;

/* The piece that the last evaluations are of, which ends at `end`; returns its parts, 0: they are of none. */
static int piece_of(const Watch *watch, double end, Piece *piece)
{
    int parts = 0;
    double at = end;
    for (int i = watch->times - 4; i >= 0; i -= 4, ++parts) {
        const double *t = watch->time + i, near = 1e-6 * (t[3] - t[0]) + 8 * DBL_EPSILON * fabs(end);
        if (!(t[3] > t[0]) || fabs(t[3] - at) > near || fabs(t[1] - t[2]) > near || fabs(2 * t[1] - t[0] - t[3]) > near)
            break;
        at = t[0];
    }
    *piece = (Piece){.start = at, .end = end, .parts = parts};
    return parts;
}

void tangent_contacts_see(const TangentRun *run, double time)
{
    Watch *watch = run->happened.watch;
    if (watch && watch->looking)
        *POOL_PUSH(run->pool, watch->time, watch->times) = time;
}

/* Numbers of the contacts of both: those of the vehicle. The first look after a step ends what counts of the step. */
static int press_of_both(void *self, double time, const double *state, double *press)
{
    TangentRun *run = (TangentRun *)(uintptr_t)((Both *)self)->run;
    Watch *watch = run->happened.watch;
    double *own = tape_array(run->self, run->code->state_offset);
    Piece piece;
    if (watch->looking && piece_of(watch, time, &piece))
        *POOL_PUSH(run->pool, watch->piece, watch->pieces) = piece;
    watch->times = 0;
    watch->looking = run->plain = true;
    tangent_inputs_of(run, time);
    tangent_take(run, state, 0, own);
    return run->code->contacts->press(run->self, time, own, press);
}

void tangent_contacts_make(TangentRun *run, gic_model *descriptor, size_t *at)
{
    const gic_model *code = run->code;
    if (!run->scene->locate || !code->contacts)
        return;
    gic_contacts *contacts = pool_alloc(run->pool, sizeof *contacts);
    *contacts = (gic_contacts){.name = code->contacts->name, .past_offset = *at, .press = press_of_both};
    *at += 2 * (size_t)code->contact_count * sizeof(double);
    descriptor->contact_count = code->contact_count;
    descriptor->contacts = contacts;
    run->happened.watch = pool_alloc(run->pool, sizeof *run->happened.watch);
    *run->happened.watch = (Watch){.before = NULL};
}

void tangent_contacts_begin(TangentRun *run)
{
    Watch *watch = run->happened.watch;
    run->remade = false;
    if (!watch)
        return;
    if (!watch->before) {
        watch->before = tangent_saved_new(run);
        watch->after = tangent_saved_new(run);
        watch->here = tangent_saved_new(run);
    }
    watch->looking = false;
    run->both->head.locate = run->scene->locate;
    run->both->head.most = run->scene->most_work;
}

void tangent_contacts_before(TangentRun *run, const TrailStep *next)
{
    Watch *watch = run->happened.watch;
    run->remade = false;
    if (!watch || !run->both->head.locate)
        return;
    watch->kept_plain = run->plain;
    watch->looking = false;
    watch->pieces = watch->times = 0;
    tangent_save(run, watch->before, next);
    if (run->trail && !run->plain) /* the step that is being made is the last one of the trail */
        --watch->before->mark.steps;
}

/* How far the state is from where the number of a contact is 0, s, by its rate; guard: of the contact, -1: the one
 * that is nearest, which it becomes. Without derivatives. */
static int find_off(TangentRun *run, int *guard, double *off, double *guard_rate)
{
    const int conditions = run->happened.conditions, n = run->descriptor.slow_count + run->descriptor.fast_count;
    const int first = *guard < 0 ? conditions : *guard;
    const int last = *guard < 0 ? conditions + run->code->contact_count - 1 : *guard;
    double rate[n + 1], own[run->states + 1];
    *off = INFINITY;
    int status =
        run->descriptor.rhs(run->both, gic_time(run->both), tangent_array(run, run->descriptor.state_offset), rate);
    tangent_take(run, rate, 0, own);
    for (int i = first; i <= last && status == GIC_OK; ++i) {
        double value = 0, slope = 0;
        status = tangent_guard(run, i, &value);
        if (status == GIC_OK)
            status = tangent_guard_slope(run, i, own, 1, -1, &slope);
        if (!(fabs(value / slope) < fabs(*off)))
            continue;
        *off = value / slope;
        *guard_rate = slope;
        *guard = i;
    }
    return status;
}

/* The contact that ends a piece, if one does and its time has a derivative, and when: the core comes near it, to some
 * 1e-4 of a step; here its number has to be 0, as the derivative of its time is that of this zero. start: of the
 * step. */
static int refine(TangentRun *run, const Piece *piece, double start, double step, TrailStep *next, double *time,
                  int *guard)
{
    const double near = 0.01 * step, close = 1e-12 * step + 8 * DBL_EPSILON * fabs(piece->end);
    double at = piece->end, off = 0, rate = 0;
    int status = GIC_OK, later;
    *guard = -1;
    *time = piece->end;
    tangent_save(run, run->happened.watch->here, next);
    run->plain = true;
    for (int i = 0; i < 20 && status == GIC_OK; ++i) {
        status = tangent_piece(run, at, piece->parts, -1, -1, next, &later);
        if (status == GIC_OK)
            status = find_off(run, guard, &off, &rate);
        tangent_restore(run, run->happened.watch->here, next);
        if (!(fabs(off) > close) || !(fabs(at - off - piece->end) < near) || !(at - off > piece->start))
            break;
        at -= off;
    }
    run->plain = false;
    if (status == GIC_OK && fabs(off) <= close)
        *time = at;
    else
        *guard = -1;
    if (*guard >= 0 && *time - start <= grazing * step) {
        double at_start = 0; /* stays so where the number is 0 and stands */
        int same = *guard;
        run->plain = true;
        status = find_off(run, &same, &off, &at_start);
        run->plain = false;
        if (fabs(rate - at_start) > 0.1 * fabs(rate)) {
            *guard = -1;
            *time = piece->end + beyond * step; /* so that the next piece is on one side */
        }
    }
    return status;
}

/* The last pieces of those that were made which follow each other from `start` to `end`: chain[pieces], returns how
 * many, 0: they do not. */
static int find_chain(const Watch *watch, double start, double end, Piece *chain)
{
    const double same = 1e-9 * (end - start) + 8 * DBL_EPSILON * fabs(end);
    int count = 0;
    double at = end;
    for (int i = watch->pieces - 1; i >= 0 && at - start > same; --i)
        if (fabs(watch->piece[i].end - at) <= same) {
            chain[count++] = watch->piece[i];
            at = watch->piece[i].start;
        }
    for (int i = 0; i < count / 2; ++i) {
        const Piece other = chain[i];
        chain[i] = chain[count - 1 - i];
        chain[count - 1 - i] = other;
    }
    return fabs(at - start) <= same ? count : 0;
}

/* Numbers of the contacts of the vehicle in an instance of both. */
static int press_in(const TangentRun *run, const Both *both, double *press)
{
    const char *at = (const char *)both;
    const double time = gic_time(both);
    double *own = tape_array(run->self, run->code->state_offset);
    tangent_inputs_of(run, time);
    memcpy(tape_array(run->self, run->code->input_offset), at + run->descriptor.input_offset,
           (size_t)run->inputs * sizeof *own);
    tangent_take(run, (const double *)(const void *)(at + run->descriptor.state_offset), 0, own);
    return run->code->contacts->press(run->self, time, own, press);
}

/* Whether a contact begins or ends at the first and at the last moment of the step: at[2]. */
static int find_touching(const TangentRun *run, bool *at)
{
    double press[2][GIC_CONTACTS];
    int status = press_in(run, run->happened.watch->before->both, press[0]);
    if (status == GIC_OK)
        status = press_in(run, run->both, press[1]);
    for (int i = 0; i < run->code->contact_count && status == GIC_OK; ++i) {
        const double change = fabs(press[1][i] - press[0][i]);
        for (int end = 0; end < 2 && change > least_change; ++end)
            at[end] = at[end] || fabs(press[end][i]) <= next_to * change;
    }
    return status;
}

/* Make of the first and last piece two where a contact is at their outer ends. Returns the number of pieces, two more
 * at most. */
static int part_ends(Piece *chain, int count, double step, const bool *at)
{
    const double part = next_to * step;
    if (at[1] && chain[count - 1].end - chain[count - 1].start > 2 * part) {
        chain[count] = (Piece){chain[count - 1].end - part, chain[count - 1].end, 1, true};
        chain[count - 1].end -= part;
        chain[count - 1].stays = true;
        ++count;
    }
    if (at[0] && chain[0].end - chain[0].start > 2 * part) {
        memmove(chain + 1, chain, (size_t)count * sizeof *chain);
        chain[0] = (Piece){chain[0].start, chain[0].start + part, 1, true};
        chain[1].start += part;
        ++count;
    }
    return count;
}

int tangent_contacts_after(TangentRun *run, bool *again)
{
    Watch *watch = run->happened.watch;
    *again = false;
    if (!watch || !run->both->head.locate)
        return GIC_OK;
    run->plain = watch->kept_plain;
    watch->looking = false;
    if (run->plain || (!watch->pieces && run->rest.going))
        return GIC_OK;
    const double start = gic_time(watch->before->both), end = gic_time(run->both);
    bool touching[2] = {false, false};
    int late = -1, status = find_touching(run, touching);
    if (status != GIC_OK || (!watch->pieces && !touching[0] && !touching[1]))
        return status;
    Piece chain[watch->pieces + 3];
    TrailStep next;
    chain[0] = (Piece){.start = start, .end = end, .parts = tangent_parts(run, tangent_dual(run))};
    int count = watch->pieces ? find_chain(watch, start, end, chain) : 1;
    if (count)
        count = part_ends(chain, count, end - start, touching);
    else
        status = GIC_ERROR_EVENTS;
    if (run->rest.going) {
        run->happened.failed = "a contact that begins or ends in the step in which a condition becomes true";
        return GIC_ERROR_EVENTS;
    }
    tangent_save(run, watch->after, &trail_part);
    tangent_restore(run, watch->before, &next);
    run->both->head.locate = 0;
    for (int i = 0; i < count && status == GIC_OK; ++i) {
        double to = end;
        int guard = -1, later;
        if (i + 1 < count)
            to = chain[i].end;
        if (i + 1 < count && !chain[i].stays) {
            chain[i].start = gic_time(run->both);
            status = refine(run, &chain[i], start, end - start, &next, &to, &guard);
            to = guard < 0 ? fmin(to, (chain[i].end + chain[i + 1].end) / 2) : to;
        }
        if (status == GIC_OK)
            status = tangent_piece(run, to, chain[i].parts, late, guard, &next, &later);
        late = later;
    }
    *again = true;
    const Both *after = watch->after->both;
    const size_t past = run->descriptor.contacts->past_offset;
    memcpy((char *)run->both + past, (const char *)after + past, 2 * (size_t)run->code->contact_count * sizeof(double));
    run->both->head = after->head;
    run->both->head.history = 0;
    tangent_set_inputs(run, end);
    return status;
}
