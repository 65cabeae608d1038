/* SPDX-License-Identifier: MIT
 * The engine gic: globally independent coordinates interpreted, Serban and Haug 2000. Dependent coordinates are
 * recovered subset by subset in the computational sequence, each by Newton on its 7 equations a body; velocities with
 * the same factors; accelerations from equation 16. */
#include "base/message.h"
#include "base/vec3.h"
#include "compare/compare.h"
#include "compare/interpreted.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "world/dense.h"
#include "world/world.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Bounds of one recovery: corrections with old factors, with new ones, the relative size of a correction that may lead
 * astray, and pieces in which a change of the coordinates is followed. They are this engine's own on purpose, like its
 * formulas: those of generated code and of the tape stand in templates/bounds.c.in and are others. */
enum { CHORDS = 6, PASSES = 10, PIECES = 20000 };
/* Near a singular configuration bodies move more than coordinates let expect: a way that fails is gone again in pieces
 * that are a quarter as long, and once more. */
enum { TRIES = 3, FINER = 4 };

static const double leap = 0.1;
/* A determinant this small relative to that at the design, or of the other sign: coordinates cease to be independent
 * (Serban and Haug 2000, equation 6). No rigid motion changes it. */
static const double singular = 8e-3;
/* a correction below this that no longer shrinks is rounding, near a singular configuration a larger one */
static const double rounding = 1e-9;
/* rad or relative to a subset's size: how far a body may move in one piece */
static const double swing_piece = 0.05;

/* A subset with what the loops need. */
typedef struct Part {
    int n, bodies, ties;
    const int *body;
    int *tie, (*end)[2]; /* [ties] which of its bodies either end is, -1: solved before */
    int factors;         /* place in a start: matrix [n][n], then n row exchanges as integers */
    double size;         /* m */
    double design;       /* reciprocal of the determinant there; 0 before it is known */
} Part;

/* A start is what the next recovery begins from: x [coordinates], q [bodies][7], factors. */
typedef struct Gic {
    int parts, start_size;
    Part *part;     /* [subsets], n = 0 for the base's */
    double *piece;  /* [coordinates] change that is followed in one piece */
    double *b;      /* [largest n] */
    double *design; /* a start at the design */
    bool geared;    /* whole turns of angles move something */
} Gic;

static double *start_q(const World *world, double *start)
{
    return start + world->model->coordinates;
}

static int *part_swap(const Part *part, double *start)
{
    return (int *)(void *)(start + part->factors + part->n * part->n);
}

/* ---- one subset ------------------------------------------------------------------------------------------ */

/* Right-hand side of a correction; the normalizations hold at all times. */
static void residuals(World *world, const Part *part, double *b)
{
    for (int t = 0; t < part->ties; ++t) {
        const Tie *tie = &world->tie[part->tie[t]];
        for (int r = 0; r < tie->rows; ++r)
            *b++ = -world->value[tie->first + r];
    }
    for (int i = 0; i < part->bodies; ++i)
        *b++ = 0;
}

/* Matrix of a subset from J of its ties, and the normalizations p^T p' = 0. */
static void matrix(const World *world, const Part *part, double *A)
{
    memset(A, 0, sizeof *A * (size_t)(part->n * part->n));
    for (int t = 0; t < part->ties; ++t) {
        const Tie *tie = &world->tie[part->tie[t]];
        const double *J = world->J + ROW_J * tie->first;
        for (int end = 0; end < 2; ++end, J += BODY_Q * tie->rows) {
            const int local = part->end[t][end];
            for (int r = 0; local >= 0 && r < tie->rows; ++r)
                memcpy(A + part->n * r + BODY_Q * local, J + BODY_Q * r, BODY_Q * sizeof *J);
        }
        A += part->n * tie->rows;
    }
    for (int i = 0; i < part->bodies; ++i, A += part->n)
        memcpy(A + BODY_Q * i + 3, world->q[part->body[i]] + 3, 4 * sizeof *A);
}

/* Move the bodies by a correction; its relative size. */
static double correct(World *world, const Part *part, const double *b)
{
    double linear = 0, angular = 0;
    for (int i = 0; i < part->bodies; ++i, b += BODY_Q) {
        for (int k = 0; k < 3; ++k)
            linear = fmax(linear, fabs(b[k]));
        for (int k = 3; k < BODY_Q; ++k)
            angular = fmax(angular, fabs(b[k]));
        world_move(world, part->body[i], b);
    }
    return fmax(linear / part->size, angular);
}

/* Corrections with the old factors until a further one would be below `enough`. turn: how far these factors' directions
 * are from the present ones. */
static int follow(const Interpreted *context, Instance *self, const Part *part, double *old, double turn, double enough)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    double *b = ((Gic *)context->engine)->b, before = 0, ratio = turn;
    for (int i = 0; i < CHORDS; ++i) {
        const double begun = profile_clock(profile);
        for (int t = 0; t < part->ties; ++t)
            world_values(world, part->tie[t]);
        residuals(world, part, b);
        const double ready = profile_clock(profile);
        dense_solve(part->n, old + part->factors, part_swap(part, old), b);
        const double solved = profile_clock(profile);
        const double step = correct(world, part, b);
        ++self->head.correction_count;
        profile->recovery_solver += solved - ready;
        profile->recovery_functions += ready - begun + (profile_clock(profile) - solved);
        if (!(step < leap))
            return GIC_ERROR_NEWTON;
        ratio = i ? fmax(step / before, DBL_EPSILON) : fmax(2 * ratio, 2 * step);
        if (step * ratio <= enough || ratio > 0.25)
            return GIC_OK;
        before = step;
    }
    return GIC_OK;
}

/* Newton until the last correction is below `enough`; leaves factors in `start`, J and vectors. */
static int converge(const Interpreted *context, Instance *self, const Part *part, double *start, double enough)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    double *b = ((Gic *)context->engine)->b, *A = start + part->factors, before = 1;
    for (int i = 0; i < PASSES; ++i) {
        const double begun = profile_clock(profile);
        bool right = true;
        for (int t = 0; t < part->ties; ++t)
            right = world_rows(world, part->tie[t]) && right;
        if (!right)
            return GIC_ERROR_NEWTON;
        residuals(world, part, b);
        matrix(world, part, A);
        const double ready = profile_clock(profile);
        if (!dense_factor(part->n, A, part_swap(part, start)))
            return GIC_ERROR_SINGULAR;
        dense_solve(part->n, A, part_swap(part, start), b);
        const double solved = profile_clock(profile);
        const double step = correct(world, part, b);
        ++self->head.correction_count;
        ++profile->factorizations;
        ++profile->newton;
        profile->recovery_solver += solved - ready;
        profile->recovery_functions += ready - begun + (profile_clock(profile) - solved);
        /* where corrections do not shrink fast, the solution that they lead to may be another one */
        if (!(step < leap) || (i && step > rounding && step > before / 4))
            return GIC_ERROR_NEWTON;
        if (step <= enough || (step <= rounding && step > before / 4)) {
            ++self->head.newton_count;
            self->head.largest_step = fmax(self->head.largest_step, step);
            return dense_determinant(part->n, A, part_swap(part, start)) * part->design > singular || part->design == 0
                       ? GIC_OK
                       : GIC_ERROR_SINGULAR;
        }
        before = step;
    }
    return GIC_ERROR_NEWTON;
}

/* q' of a subset's bodies from those solved before and the rates of the coordinates. */
static void velocities(const Interpreted *context, const Part *part, double *start)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    double *b = ((Gic *)context->engine)->b, *next = b;
    const double begun = profile_clock(profile);
    for (int t = 0; t < part->ties; ++t) {
        const Tie *tie = &world->tie[part->tie[t]];
        const double *J = world->J + ROW_J * tie->first;
        for (int r = 0; r < tie->rows; ++r)
            next[r] = 0;
        next[0] -= world_dual(world, part->tie[t], world->xd);
        for (int end = 0; end < 2; ++end, J += BODY_Q * tie->rows) {
            const double *qd = world->qd[tie->body[end]];
            for (int r = 0; part->end[t][end] < 0 && r < tie->rows; ++r)
                for (int k = 0; k < BODY_Q; ++k)
                    next[r] -= J[BODY_Q * r + k] * qd[k];
        }
        next += tie->rows;
    }
    for (int i = 0; i < part->bodies; ++i)
        next[i] = 0;
    const double ready = profile_clock(profile);
    dense_solve(part->n, start + part->factors, part_swap(part, start), b);
    const double solved = profile_clock(profile);
    for (int i = 0; i < part->bodies; ++i)
        world_set_rate(world, part->body[i], b + BODY_Q * i);
    profile->recovery_solver += solved - ready;
    profile->recovery_functions += ready - begun + (profile_clock(profile) - solved);
}

/* ---- all subsets ----------------------------------------------------------------------------------------- */

/* A rigid motion that takes the base from its old pose to the present one. */
typedef struct Carry {
    double p[4], A[9], from[3], to[3];
    double turn; /* magnitude of its vector part: half the angle for small ones */
} Carry;

static Carry carry_from(const World *world, const double old[BODY_Q])
{
    const double *now = world->q[BODY_BASE], back[4] = {old[3], -old[4], -old[5], -old[6]};
    Carry carry;
    euler_product(now + 3, back, carry.p);
    mat_from_euler(carry.p, carry.A);
    copy3(old, carry.from);
    copy3(now, carry.to);
    carry.turn = norm3(carry.p + 1);
    return carry;
}

/* A body where it was, seen from the base. */
static void carry_body(World *world, int body, const Carry *carry, const double old[BODY_Q])
{
    double q[BODY_Q], arm[3];
    sub3(old, carry->from, arm);
    apply3(carry->A, arm, q);
    add3(q, carry->to, q);
    euler_product(carry->p, old + 3, q + 3);
    world_set_q(world, body, q);
}

/* All bodies at world->x, from the start `old`; leaves the start `next`. cold: `old` has no factors. */
static int recover_piece(const Interpreted *context, Instance *self, double *old, double *next, bool cold)
{
    const Gic *gic = context->engine;
    World *world = context->world;
    double *q = start_q(world, old);
    const Carry carry = carry_from(world, q);
    const double far = norm3(world->q[BODY_BASE]);
    for (int s = 0; s < gic->parts; ++s) {
        const Part *part = &gic->part[s];
        if (!part->n)
            continue;
        /* rounding of places that far away; velocities are as far off as the pose that the factors belong to */
        const double enough = 4 * DBL_EPSILON * (1 + far / part->size);
        for (int i = 0; i < part->bodies; ++i)
            carry_body(world, part->body[i], &carry, q + BODY_Q * part->body[i]);
        int status = cold || carry.turn > 0.1 ? GIC_OK : follow(context, self, part, old, carry.turn, enough);
        if (status == GIC_OK)
            status = converge(context, self, part, next, enough);
        if (status != GIC_OK) {
            self->head.subset = s;
            return status;
        }
        velocities(context, part, next);
    }
    memcpy(next, world->x, sizeof *next * (size_t)world->model->coordinates);
    memcpy(start_q(world, next), world->q, sizeof *world->q * (size_t)world->bodies);
    return GIC_OK;
}

static double *start_of(const Interpreted *context, const Instance *self, int flip)
{
    return instance_own(self) + flip * ((const Gic *)context->engine)->start_size;
}

/* All bodies by `way` [coordinates] from the last good configuration to `last`. */
static int recover_pieces(const Interpreted *context, Instance *self, const double *way, const double *last, int pieces,
                          bool cold)
{
    World *world = context->world;
    const int32_t first = self->head.flip, hold = self->head.hold;
    const double *const from = start_of(context, self, first);
    int32_t now = first;
    for (int piece = 1; piece <= pieces; ++piece) {
        int32_t next = 0;
        while (next == first || next == now || next == hold)
            ++next;
        for (int c = 0; c < world->model->coordinates; ++c)
            world->x[c] = piece == pieces ? last[c] : from[c] + way[c] * piece / pieces;
        const int status =
            recover_piece(context, self, start_of(context, self, now), start_of(context, self, next), cold);
        if (status != GIC_OK)
            return status;
        now = next;
    }
    self->head.flip = now;
    return GIC_OK;
}

/* All bodies at world->x, followed from the last good configuration, which stays that where a piece fails. */
static int recover(const Interpreted *context, Instance *self, bool cold)
{
    const Gic *gic = context->engine;
    World *world = context->world;
    const int count = world->model->coordinates;
    const double begun = profile_clock(context->profile);
    const double *const from = start_of(context, self, self->head.flip);
    double last[count + 1], way[count + 1];
    int pieces = 1, status = GIC_ERROR_NEWTON;
    for (int c = 0; c < count; ++c) {
        last[c] = world->x[c];
        way[c] = last[c] - from[c];
        /* whole turns out of an angle that is out of reach with them */
        if (world->model->coordinate[c].type == COORDINATE_ANGLE && !gic->geared &&
            !(fabs(way[c]) < (int)PIECES * gic->piece[c]))
            way[c] = gic_unwound(way[c]);
        const double parts = fabs(way[c]) / gic->piece[c];
        if (!(parts < (int)PIECES))
            return GIC_ERROR_REACH;
        pieces = (int)parts + 1 > pieces ? (int)parts + 1 : pieces;
    }
    for (int i = 0; i < TRIES && status == GIC_ERROR_NEWTON && pieces <= PIECES; ++i, pieces *= FINER)
        status = recover_pieces(context, self, way, last, pieces, cold);
    context->profile->recovery += profile_clock(context->profile) - begun;
    return status;
}

static int place(const Interpreted *context, Instance *self, const double *state)
{
    double e[4];
    const int status = interpreted_orient(self, state, e);
    if (status != GIC_OK)
        return status;
    interpreted_gather(context, state);
    interpreted_place_base(context, state, e);
    return recover(context, self, false);
}

static int evaluate(const Interpreted *context, Instance *self, const double *state, double *rate)
{
    const int status = place(context, self, state);
    return status == GIC_OK ? interpreted_accelerate(context, self, state, rate) : status;
}

/* From the design poses alone, then on to the initial values of the coordinates. */
static int start(const Interpreted *context, Instance *self)
{
    const Gic *gic = context->engine;
    memcpy(start_of(context, self, 0), gic->design, sizeof *gic->design * (size_t)gic->start_size);
    self->head.flip = 0;
    return place(context, self, instance_array(&self->head, context->code.state_offset));
}

/* ---- opening --------------------------------------------------------------------------------------------- */

static int local_of(const Subset *subset, int body)
{
    for (int i = 0; i < subset->bodies; ++i)
        if (subset->body[i] == body)
            return i;
    return -1;
}

static void add_tie(const World *world, const Subset *subset, Part *part, int index)
{
    const Tie *tie = &world->tie[index];
    for (int end = 0; end < 2; ++end)
        part->end[part->ties][end] = local_of(subset, tie->body[end]);
    part->tie[part->ties++] = index;
}

static Part part_of(Pool *pool, const World *world, const Subset *subset)
{
    const size_t most = (size_t)(subset->joints + subset->coordinates + 1);
    Part part = {.n = BODY_Q * subset->bodies,
                 .bodies = subset->bodies,
                 .body = subset->body,
                 .tie = pool_alloc(pool, most * sizeof *part.tie),
                 .end = pool_alloc(pool, most * sizeof *part.end)};
    for (int i = 0; i < subset->joints; ++i)
        add_tie(world, subset, &part, subset->joint[i]);
    for (int i = 0; i < subset->coordinates; ++i)
        add_tie(world, subset, &part, world->coordinate_tie[subset->coordinate[i]]);
    return part;
}

/* Numbers of a part's factors in a start. */
static int factors_size(int n)
{
    return n * n + (n + 1) / 2;
}

static _Noreturn void design_fail(const Model *model, const Subset *subset, int status)
{
    diag_fail(model->body[subset->body[0]].at, "move the design away from there, or use another coordinate",
              "the mechanism can't be moved from its design configuration: %s: body '%s'", gic_status_text(status),
              model->body[subset->body[0]].name);
}

/* Largest arm of a part's bodies, but not much less than that of all. */
static double part_size(const World *world, const Part *part)
{
    double size = 0.1 * world->size;
    for (int t = 0; t < part->ties; ++t)
        for (int end = 0; end < 2; ++end) {
            const double *arm = world->tie[part->tie[t]].arm[end];
            if (part->end[t][end] >= 0)
                size = fmax(size, norm3(arm));
        }
    return size;
}

/* A start at the design, its determinants, and how far unit rates of the coordinates swing the bodies there. */
static int find_design(const Interpreted *context, Instance *self)
{
    Gic *gic = context->engine;
    World *world = context->world;
    const Model *model = world->model;
    double *start = gic->design;
    for (int s = 0; s < gic->parts; ++s) {
        gic->part[s].size = part_size(world, &gic->part[s]);
        gic->part[s].design = 0;
    }
    for (int c = 0; c < model->coordinates; ++c)
        start[c] = world->x[c] = model->coordinate[c].design;
    memcpy(start_q(world, start), world->q_design, sizeof *world->q * (size_t)world->bodies);
    world_set_q(world, BODY_BASE, world->q_design[BODY_BASE]);
    const int status = recover_piece(context, self, start, start, true);
    if (status != GIC_OK)
        return status;
    for (int s = 0; s < gic->parts; ++s) {
        Part *part = &gic->part[s];
        if (part->n)
            part->design = 1 / dense_determinant(part->n, start + part->factors, part_swap(part, start));
    }
    for (int c = 0; c < model->coordinates; ++c) {
        double most = 0;
        memset(world->xd, 0, sizeof *world->xd * (size_t)model->coordinates);
        world->xd[c] = 1;
        for (int s = 0; s < gic->parts; ++s) {
            const Part *part = &gic->part[s];
            if (!part->n)
                continue;
            velocities(context, part, start);
            for (int i = 0; i < part->bodies; ++i) {
                const double *v = world->qd[part->body[i]], *omega = world->omega[part->body[i]];
                most = fmax(most, fmax(norm3(omega), norm3(v) / part->size));
            }
        }
        const double whole = model->coordinate[c].range[1] - model->coordinate[c].range[0];
        gic->piece[c] = most > 0 ? swing_piece / most : whole;
    }
    return GIC_OK;
}

const Engine *engine_gic(Pool *pool, const Model *drawn, const EngineOptions *options)
{
    (void)options;
    const Sequence *sequence = sequence_find(pool, drawn);
    const Model *model = model_assemble(pool, drawn, sequence);
    Gic *gic = pool_alloc(pool, sizeof *gic);
    int most = 0;
    gic->parts = sequence->subsets;
    gic->start_size = model->coordinates + BODY_Q * model->bodies;
    for (int s = 0; s < sequence->subsets; ++s)
        if (sequence->subset[s].class >= 0) {
            const int n = BODY_Q * sequence->subset[s].bodies;
            gic->start_size += factors_size(n);
            most = n > most ? n : most;
        }
    Interpreted *context = interpreted_new(pool, model, sequence, GIC_STARTS * (size_t)gic->start_size);
    gic->part = pool_alloc(pool, (size_t)sequence->subsets * sizeof *gic->part);
    for (int s = 0, at = model->coordinates + BODY_Q * model->bodies; s < sequence->subsets; ++s)
        if (sequence->subset[s].class >= 0) {
            gic->part[s] = part_of(pool, context->world, &sequence->subset[s]);
            gic->part[s].factors = at;
            at += factors_size(gic->part[s].n);
        }
    gic->piece = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof(double));
    gic->geared = model_counts_turns(model);
    gic->b = pool_alloc(pool, ((size_t)most + 1) * sizeof(double));
    gic->design = pool_alloc(pool, (size_t)gic->start_size * sizeof(double));
    context->engine = gic;
    context->start = start;
    context->design = find_design;
    context->place = place;
    context->evaluate = evaluate;
    const Engine *engine = interpreted_engine(pool, "gic", context);
    Instance *self = (Instance *)(void *)instance_new(pool, engine);
    const int status = find_design(context, self);
    if (status != GIC_OK)
        design_fail(model, &sequence->subset[self->head.subset], status);
    return engine;
}
