/* SPDX-License-Identifier: MIT
 * Where a contact begins or ends is found by integration alone: of a piece in which some evaluation saw another set of
 * contacts than there was at its start the first half is tried, and so on, until what is left is too short for a force
 * that begins or ends in it to count. No time is interpolated; so nothing is taken for granted but that evaluations
 * tell. A contact that is made and lost between two of them shows in the cubic through depths and their rates at the
 * ends of the piece, or in three more evaluations, on the cubic through states and rates there: a piece in which their
 * numbers turn so near to 0 that what is between might be beyond is halved, too. */
#include "compare/contact_pieces.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Below which a depth (m, rad) is 0, or a force relative to its two terms. */
static const double rounding = 1e-12;

enum { QUARTERS = 4 };

struct ContactPieces {
    Pool *pool;
    const World *world;
    size_t size;         /* of an instance, bytes; 0: not known yet */
    double least;        /* m or rad: a depth that is 0 but for rounding */
    bool *above, *below; /* [touches] what evaluations have seen since the piece began */
    int *side;           /* [touches] at its start: 1 pushes, -1 does not, 0: rounding decides */
    int *last;           /* [touches] the last one that was not 0 */
    Touch *from, *to;    /* [touches] at both ends of the piece, and rates of the states there */
    double *from_rate, *to_rate;
    Touch *within[QUARTERS + 1]; /* [touches] at quarters of the piece */
    bool looked;                 /* `to` is of the instance `seen` */
    void *seen, *before, *start; /* instances: the last one looked at; at the start of the step, and of the piece */
};

ContactPieces *contact_pieces_new(Pool *pool, const World *world)
{
    const size_t touches = (size_t)world->touches + 1;
    ContactPieces *pieces = pool_alloc(pool, sizeof *pieces);
    *pieces = (ContactPieces){.pool = pool, .world = world, .least = rounding};
    pieces->above = pool_alloc(pool, touches * sizeof *pieces->above);
    pieces->below = pool_alloc(pool, touches * sizeof *pieces->below);
    pieces->side = pool_alloc(pool, touches * sizeof *pieces->side);
    pieces->last = pool_alloc(pool, touches * sizeof *pieces->last);
    pieces->from = pool_alloc(pool, touches * sizeof *pieces->from);
    pieces->to = pool_alloc(pool, touches * sizeof *pieces->to);
    for (int i = 0; i <= QUARTERS; ++i)
        pieces->within[i] = pool_alloc(pool, touches * sizeof *pieces->within[i]);
    return pieces;
}

/* Room for instances, whose size an engine may change after it was opened. */
static void make_room(ContactPieces *pieces, const gic_model *code)
{
    void **const instance[] = {&pieces->seen, &pieces->before, &pieces->start};
    const size_t states = (size_t)(code->slow_count + code->fast_count) + 1;
    if (pieces->size == code->size)
        return;
    for (int i = 0; i < 3; ++i)
        *instance[i] = pool_alloc(pieces->pool, code->size);
    pieces->from_rate = pool_alloc(pieces->pool, states * sizeof(double));
    pieces->to_rate = pool_alloc(pieces->pool, states * sizeof(double));
    pieces->size = code->size;
}

/* 1 where a contact pushes, -1 where it does not, be it that parts are apart or that a damper would pull; 0 where
 * rounding decides. */
static int side_of(const ContactPieces *pieces, const Touch *touch)
{
    const double push = touch->elastic + touch->damping;
    const double size = fabs(touch->elastic) + fabs(touch->damping);
    if (touch->depth <= pieces->least)
        return touch->depth < -pieces->least ? -1 : 0;
    return fabs(push) <= rounding * size ? 0 : push > 0 ? 1 : -1;
}

void contact_pieces_note(ContactPieces *pieces, bool wheels_alone)
{
    const int count = wheels_alone ? pieces->world->model->wheels : pieces->world->touches;
    for (int i = 0; i < count; ++i) {
        const int side = side_of(pieces, &pieces->world->touch[i]);
        pieces->above[i] = pieces->above[i] || side > 0;
        pieces->below[i] = pieces->below[i] || side < 0;
    }
}

static double *array_of(gic_head *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

/* The contacts at the present state, into `to`. */
static int look(ContactPieces *pieces, const gic_model *code, gic_head *self)
{
    const int count = code->slow_count + code->fast_count;
    double state[count + 1], largest = 1; /* a copy: engines do more where a step begins */
    if (pieces->looked && !memcmp(pieces->seen, self, pieces->size))
        return GIC_OK;
    memcpy(state, array_of(self, code->state_offset), sizeof *state * (size_t)count);
    for (int i = 0; i < count; ++i)
        largest = fmax(largest, fabs(state[i]));
    pieces->least = fmax(rounding, 16 * DBL_EPSILON * largest);
    const int status = code->rhs(self, gic_time(self), state, pieces->to_rate);
    pieces->looked = status == GIC_OK;
    if (status != GIC_OK)
        return status;
    memcpy(pieces->to, pieces->world->touch, sizeof *pieces->to * (size_t)pieces->world->touches);
    memcpy(pieces->seen, self, pieces->size);
    return GIC_OK;
}

/* What was looked at becomes what the piece begins from, or the other way round. */
static void copy_look(const ContactPieces *pieces, const gic_model *code, bool back)
{
    const size_t touches = sizeof(Touch) * (size_t)pieces->world->touches;
    const size_t states = sizeof(double) * (size_t)(code->slow_count + code->fast_count);
    memcpy(back ? pieces->to : pieces->from, back ? pieces->from : pieces->to, touches);
    memcpy(back ? pieces->to_rate : pieces->from_rate, back ? pieces->from_rate : pieces->to_rate, states);
}

/* A piece begins at `self`, where the last look was. */
static void begin(ContactPieces *pieces, const gic_model *code, const gic_head *self)
{
    memcpy(pieces->start, self, pieces->size);
    copy_look(pieces, code, false);
    for (int i = 0; i < pieces->world->touches; ++i) {
        pieces->side[i] = side_of(pieces, &pieces->from[i]);
        pieces->above[i] = pieces->below[i] = false;
    }
}

/* Do parts come apart, or together? Where a damper has let go before, a stop or a tire may take hold again on the last
 * bit of the way: a piece must not lead from one to the other, so that some piece ends on that bit. */
static bool parts(const ContactPieces *pieces, const Touch *from, const Touch *to)
{
    return fmin(from->depth, to->depth) < -pieces->least && fmax(from->depth, to->depth) > pieces->least;
}

/* Does the cubic through depths and rates at the ends of a piece of `length` s, which are on one side of 0, reach the
 * other one? */
static bool turns(const ContactPieces *pieces, const Touch *from, const Touch *to, double length)
{
    const double change = to->depth - from->depth, a = length * from->rate, b = length * to->rate;
    const double square = 3 * change - 2 * a - b, cube = a + b - 2 * change;
    if (!(from->depth * to->depth > 0))
        return false;
    /* a + 2 square s + 3 cube s^2 = 0 */
    const double inner = square * square - 3 * a * cube, q = -square - copysign(sqrt(fmax(inner, 0)), square);
    const double extreme[2] = {q / (3 * cube), a / q};
    for (int i = 0; i < 2 && inner > 0; ++i) {
        const double s = extreme[i], depth = from->depth + s * (a + s * (square + s * cube));
        if (s > 0 && s < 1 && fabs(depth) > pieces->least && (depth > 0) != (from->depth > 0))
            return true;
    }
    return false;
}

/* A number (m, rad) that is above 0 where a contact pushes, and continuous. */
static double number_of(const Touch *touch)
{
    return touch->depth > 0 && touch->elastic > 0 ? touch->depth * (1 + touch->damping / touch->elastic) : touch->depth;
}

/* Would the number of a contact have to move four times as far as it seems to, to be 0 within the piece? */
static bool is_far(const Touch *from, const Touch *to, double length)
{
    const double a = number_of(from), b = number_of(to);
    const double moved = fabs(b - a) + length * (fabs(from->rate) + fabs(to->rate));
    return fmin(fabs(a), fabs(b)) > 4 * moved;
}

/* Evaluate at the quarters between the ends of the piece that led to `self`. Returns a status. */
static int look_within(const ContactPieces *pieces, const gic_model *code, gic_head *self, double length)
{
    const int count = code->slow_count + code->fast_count;
    const size_t size = sizeof(Touch) * (size_t)pieces->world->touches;
    const double *a = array_of(pieces->start, code->state_offset), *b = array_of(self, code->state_offset);
    double state[count + 1], rate[count + 1], kept[code->input_count + 1], *input = array_of(self, code->input_offset);
    int status = GIC_OK;
    memcpy(kept, input, sizeof *kept * (size_t)code->input_count);
    for (int k = 1; k < QUARTERS && status == GIC_OK; ++k) {
        const double s = (double)k / QUARTERS, r = 1 - s, time = gic_time(self) - r * length;
        for (int i = 0; i < count; ++i)
            state[i] = a[i] + s * s * (3 - 2 * s) * (b[i] - a[i]) +
                       length * s * r * (r * pieces->from_rate[i] - s * pieces->to_rate[i]);
        if (self->input_function)
            self->input_function(self->user, self->lane, time, input);
        status = code->rhs(self, time, state, rate);
        memcpy(pieces->within[k], pieces->world->touch, size);
    }
    memcpy(input, kept, sizeof *kept * (size_t)code->input_count);
    memcpy(pieces->within[0], pieces->from, size);
    memcpy(pieces->within[QUARTERS], pieces->to, size);
    return status;
}

/* Do numbers at quarters turn towards 0, so near to it that what is between them might be beyond? What every other one
 * lets expect of the others says how well they show what is between. */
static bool might_turn(const ContactPieces *pieces, int contact)
{
    double n[QUARTERS + 1], bend = 0;
    for (int k = 0; k <= QUARTERS; ++k)
        n[k] = pieces->side[contact] * number_of(&pieces->within[k][contact]);
    const double off =
        fmax(fabs(n[1] - (3 * n[0] + 6 * n[2] - n[4]) / 8), fabs(n[3] - (3 * n[4] + 6 * n[2] - n[0]) / 8));
    for (int k = 1; k < QUARTERS; ++k)
        bend = fmax(bend, fabs(n[k - 1] - 2 * n[k] + n[k + 1]) / 8);
    for (int k = 1; k < QUARTERS; ++k)
        if (n[k] <= n[k - 1] && n[k] <= n[k + 1] && n[k] < bend + 2 * off)
            return true;
    return false;
}

/* Did the piece of `length` s that has led to `self`, where the last look was, meet the beginning or the end of a
 * contact? */
static bool meets(ContactPieces *pieces, const gic_model *code, gic_head *self, double length)
{
    bool far = true;
    for (int i = 0; i < pieces->world->touches && far; ++i)
        far = !pieces->side[i] || is_far(&pieces->from[i], &pieces->to[i], length);
    if (!far) {
        far = look_within(pieces, code, self, length) != GIC_OK; /* then what follows will fail, too */
        memcpy(pieces->seen, self, pieces->size);                /* its state is still the one of the look */
    }
    for (int i = 0; i < pieces->world->touches; ++i) {
        const int side = pieces->side[i], there = side_of(pieces, &pieces->to[i]);
        const bool above = pieces->above[i] || there > 0, below = pieces->below[i] || there < 0;
        if ((above && below) || (above && side < 0) || (below && side > 0) ||
            parts(pieces, &pieces->from[i], &pieces->to[i]) ||
            turns(pieces, &pieces->from[i], &pieces->to[i], length) || (!far && side && might_turn(pieces, i)))
            return true;
    }
    return false;
}

/* The instance as it was, but for what it has counted. */
static void put_back(gic_head *self, const void *kept, size_t size)
{
    const gic_head now = *self;
    memcpy(self, kept, size);
    self->rhs_count = now.rhs_count;
    self->fast_count = now.fast_count;
    self->newton_count = now.newton_count;
    self->correction_count = now.correction_count;
}

/* The contacts made or lost where the last look was. */
static int changes(ContactPieces *pieces)
{
    int count = 0;
    for (int i = 0; i < pieces->world->touches; ++i) {
        const int side = side_of(pieces, &pieces->to[i]);
        count += pieces->last[i] * side < 0;
        pieces->last[i] = side ? side : pieces->last[i];
    }
    return count;
}

/* Has rounding come to decide on a contact? It is at its beginning or end then. */
static bool reaches(const ContactPieces *pieces)
{
    for (int i = 0; i < pieces->world->touches; ++i)
        if (pieces->side[i] && !side_of(pieces, &pieces->to[i]))
            return true;
    return false;
}

/* From the start of the step, where `self` is and `from` was looked at, to `end`. */
static int in_pieces(ContactPieces *pieces, const gic_model *code, gic_head *self, const ContactWays *ways, double end)
{
    const double least = fmax(1e-12, 16 * DBL_EPSILON * fabs(end));
    double hunted = end; /* a piece up to there has met a contact */
    bool hunts = true;
    int status = GIC_OK, crossed = 0;
    while (status == GIC_OK && gic_time(self) < end) {
        const double now = gic_time(self), goal = hunts ? hunted : end;
        const double until = hunts && goal - now > least ? now + 0.5 * (goal - now) : goal;
        begin(pieces, code, self);
        status = ways->piece(ways->caller, self, until);
        if (status == GIC_OK)
            status = look(pieces, code, self);
        if (status != GIC_OK)
            break;
        const bool met = meets(pieces, code, self, until - now);
        if (met || reaches(pieces))
            ways->restart(ways->caller);
        if (met && until - now > least) {
            hunts = true;
            hunted = until;
            put_back(self, pieces->start, pieces->size);
            copy_look(pieces, code, true);
            continue;
        }
        self->contact_count += changes(pieces);
        hunts = hunts && until < hunted;
        crossed += met;
        if (crossed > GIC_CHANGES * pieces->world->touches)
            status = GIC_ERROR_EVENTS;
    }
    return status;
}

int contact_pieces_step(ContactPieces *pieces, const gic_model *code, gic_head *self, const ContactWays *ways)
{
    make_room(pieces, code);
    const bool goes_on = pieces->looked && !memcmp(pieces->seen, self, pieces->size);
    if (look(pieces, code, self) != GIC_OK) /* the step will say why */
        return ways->whole(ways->caller, self);
    const double start = gic_time(self);
    memcpy(pieces->before, self, pieces->size);
    begin(pieces, code, self);
    if (!goes_on)
        memcpy(pieces->last, pieces->side, sizeof *pieces->last * (size_t)pieces->world->touches);
    int status = ways->whole(ways->caller, self);
    if (status != GIC_OK || look(pieces, code, self) != GIC_OK)
        return status;
    if (!meets(pieces, code, self, gic_time(self) - start)) {
        self->contact_count += changes(pieces);
        if (reaches(pieces)) {
            ways->restart(ways->caller);
            self->history = 0;
        }
        memcpy(pieces->seen, self, pieces->size);
        return GIC_OK;
    }
    const gic_head whole = *self;
    put_back(self, pieces->before, pieces->size);
    copy_look(pieces, code, true);
    ways->restart(ways->caller);
    status = in_pieces(pieces, code, self, ways, gic_time(&whole));
    if (status != GIC_OK) {
        put_back(self, pieces->before, pieces->size);
        ways->restart(ways->caller);
        return self->status = status;
    }
    /* its time as the caller counts it; nothing is known of what was before */
    self->start_time = whole.start_time;
    self->step = whole.step;
    self->steps = whole.steps;
    self->method = whole.method;
    self->ratio = whole.ratio;
    self->history = 0;
    memcpy(pieces->seen, self, pieces->size);
    return GIC_OK;
}
