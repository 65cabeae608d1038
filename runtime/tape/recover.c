/* SPDX-License-Identifier: MIT
 * Recovery of the dependent coordinates: the template recovery_loop.c.in and the first half of model.c.in, over tapes.
 */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "tape/engine_tape.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

#include "../../templates/bounds.c.in"

#include <math.h>
#include <string.h>

void tape_link(Instance *self, TapeLinks *links, const Subset *subset)
{
    double **array = links->array;
    const Plan *plan = tape_of(self)->formulation->plan;
    double *motion = tape_array(self, tape_of(self)->motion_offset);
    array[CLASS_x] = links->x;
    array[CLASS_rate] = links->rate;
    array[CLASS_change] = links->change;
    array[CLASS_turn] = links->turn;
    array[CLASS_ahead] = links->ahead;
    array[CLASS_d] =
        tape_array(self, tape_of(self)->derived_offset) + plan->derived_offset[subset - plan->sequence->subset];
    for (int i = 0; i < subset->knowns; ++i)
        array[CLASS_KNOWN + i] = motion + plan->motion_offset[subset->known[i]];
}

/* One subset. old, start: its parts of the Newton starts. */
static int solve_subset(Instance *self, TapeLinks *links, int s, double *old, double *start)
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const Subset *subset = &plan->sequence->subset[s];
    const TapeClass *class = &engine->class[subset->class];
    const TapeWorld none = {.table = NULL};
    const size_t pose = 7 * (size_t)subset->bodies * sizeof(double);
    const int member = engine->member[s];
    double *q = engine->q, *frame = engine->frame, **array = links->array;
    double *const motion = tape_array(self, engine->motion_offset) + plan->motion_offset[subset->body[0]];
    const double enough = class->enough;
    double step = 0, reach = 0, before = 1;
    int i;
    tape_link(self, links, subset);
    array[CLASS_q] = q;
    array[CLASS_s] = old + class->layout->start_S;
    array[CLASS_f] = old + class->layout->start_factors;
    array[CLASS_start] = start;
    array[CLASS_motion] = motion;
    array[CLASS_inertia] = tape_array(self, engine->inertia_offset) + plan->inertia_offset[s];
    array[CLASS_step] = &step;
    array[CLASS_reach] = &reach;
    if (class->closed) {
        const int status = tape_play(class->solve, member, array, &none, frame);
#ifdef GIC_PLANT_MOTION /* an error that tests plant */
        motion[GIC_PLANT_MOTION] += GIC_PLANT_BY;
#endif
        ++engine->profile->factorizations;
        self->head.newton_count += status == GIC_OK;
        return status;
    }
    memcpy(q, old, pose);
    /* what stands at the insertion points of the template */
#define INSERT_predict tape_play(class->predict, member, array, &none, frame);
#define INSERT_chord \
    tape_play(class->chord, member, array, &none, frame); \
    ++engine->profile->newton;
#define INSERT_solve \
    const int status = tape_play(class->solve, member, array, &none, frame); \
    ++engine->profile->newton; \
    ++engine->profile->factorizations; \
    if (status != GIC_OK) \
        return status;
#define INSERT_keep memcpy(start, q, pose);
#include "templates/recovery_loop.c"
}

/* True if the last solution of a subset was for the same numbers. */
static bool is_kept(const TapeEngine *engine, const TapeLinks *links, int s)
{
    const Sequence *sequence = engine->formulation->plan->sequence;
    bool same = links->again && engine->keeps[s];
    for (;;) { /* and of all that carries it */
        const Subset *subset = &sequence->subset[s];
        for (int j = 0; j < subset->deps && same; ++j)
            same = links->same[subset->dep[j]];
        if (!same || subset->carrier == BODY_BASE)
            return same;
        s = sequence->body_subset[subset->carrier];
    }
}

/* start[] from old[], both with the coordinates in front. */
static int recover_piece(Instance *self, TapeLinks *links, double *old, double *start)
{
    const Plan *plan = tape_of(self)->formulation->plan;
    const double *xd = tape_array(self, tape_of(self)->xd_offset);
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        if (subset->class < 0)
            continue;
        if (is_kept(tape_of(self), links, s)) {
            const Layout *layout = tape_of(self)->class[subset->class].layout;
            memcpy(start + plan->start_offset[s], old + plan->start_offset[s],
                   (size_t)layout->start_size * sizeof *start);
            ++self->head.kept_count;
            continue;
        }
        for (int j = 0; j < subset->deps; ++j) {
            const int w = subset->dep[j];
            links->x[j] = start[w];
            links->rate[j] = xd[w];
            links->change[j] = start[w] - old[w];
            if (coordinate_unwinds(tape_of(self)->formulation, w))
                links->change[j] = gic_unwound(links->change[j]);
        }
        int status = solve_subset(self, links, s, old + plan->start_offset[s], start + plan->start_offset[s]);
        if (status != GIC_OK) {
            self->head.subset = s;
            return status;
        }
    }
    return GIC_OK;
}

/* 1 + the start that the last recovery left; 0: it was not good. */
static double *recovered_from(Instance *self)
{
    const TapeEngine *engine = tape_of(self);
    return tape_array(self, engine->recovered_offset) + 2 * engine->code.coordinate_count + 4;
}

void tape_forget(Instance *self)
{
    *recovered_from(self) = 0;
}

/* Follow a change of the coordinates in several pieces; one that fails is halved. *last: the last piece's start. */
static int recover_way(Instance *self, TapeLinks *links, const double *way, int pieces, int32_t *last)
{
    const TapeEngine *engine = tape_of(self);
    const int coordinates = engine->code.coordinate_count, usual = pieces;
    const int32_t first = self->head.flip, hold = self->head.hold;
    const double *from = tape_start(self), *x = tape_array(self, engine->x_offset);
    int32_t now = first;
    for (int piece = 1;;) {
        int32_t next = 0;
        while (next == first || next == now || next == hold)
            ++next;
        double *start = tape_array(self, engine->start_offset[next]);
        const double share = (double)piece / (double)pieces;
        for (int i = 0; i < coordinates; ++i)
            start[i] = piece == pieces ? x[i] : from[i] + share * way[i];
        const int status = recover_piece(self, links, tape_array(self, engine->start_offset[now]), start);
        if (status == GIC_OK) {
            now = *last = next;
            if (piece == pieces)
                return GIC_OK;
            GIC_NEXT_PIECE(piece, pieces, usual);
        } else {
            if (!engine->follows || pieces >= GIC_SPLIT * usual)
                return status;
            GIC_HALVE_PIECE(piece, pieces);
            self->head.subset = -1;
        }
    }
}

int tape_recover(Instance *self, const double turn[3], bool cold)
{
    const TapeEngine *engine = tape_of(self);
    const int coordinates = engine->code.coordinate_count;
    const double *from = tape_start(self), *x = tape_array(self, engine->x_offset);
    const int32_t first = self->head.flip;
    int32_t now = first;
    TapeLinks links = engine->links;
    int pieces = 1;
    double *at = tape_array(self, engine->recovered_offset), *at_rate = at + coordinates,
           *at_turn = at_rate + coordinates;
    double *recovered = recovered_from(self), way[coordinates + 1];
    const double *xd = tape_array(self, engine->xd_offset);
    links.cold = cold;
    links.again =
        *recovered == 1 + first && !memcmp(at_turn, turn, sizeof links.turn) && self->head.ahead <= at_turn[3];
    *recovered = 0;
    for (int i = 0; i < coordinates; ++i)
        links.same[i] = !memcmp(&at[i], &x[i], sizeof *x) && !memcmp(&at_rate[i], &xd[i], sizeof *xd);
    memcpy(links.turn, turn, sizeof links.turn);
    links.ahead[0] = self->head.ahead;
    for (int i = 0; i < coordinates; ++i) {
        way[i] = x[i] - from[i];
        if (coordinate_unwinds(engine->formulation, i) && !(fabs(way[i]) < GIC_PIECES * engine->piece[i]))
            way[i] = gic_unwound(way[i]);
        const double parts = fabs(way[i]) / engine->piece[i];
        if (!(parts < GIC_PIECES))
            return GIC_ERROR_REACH;
        pieces = GIC_MAX(pieces, (int)parts + 1);
        if (!(fabs(way[i]) < engine->piece[i]))
            self->head.unchecked = 0; /* a jump: no state that was checked is near */
    }
    const int status = recover_way(self, &links, way, pieces, &now);
    if (status != GIC_OK)
        return status;
    memcpy(at, x, (size_t)coordinates * sizeof *at);
    memcpy(at_rate, xd, (size_t)coordinates * sizeof *at);
    memcpy(at_turn, turn, sizeof links.turn);
    at_turn[3] = self->head.ahead;
    *recovered = 1 + now;
    self->head.flip = now;
    return GIC_OK;
}

int tape_residual(Instance *self, double largest[2])
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const TapeWorld none = {.table = NULL};
    const double *x = tape_array(self, engine->x_offset), *xd = tape_array(self, engine->xd_offset);
    double one[2];
    TapeLinks links = engine->links;
    int bad = -1;
    largest[0] = largest[1] = 0;
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        if (subset->class < 0)
            continue;
        for (int j = 0; j < subset->deps; ++j) {
            links.x[j] = x[subset->dep[j]];
            links.rate[j] = xd[subset->dep[j]];
        }
        tape_link(self, &links, subset);
        links.array[CLASS_motion] = tape_array(self, engine->motion_offset) + plan->motion_offset[subset->body[0]];
        links.array[CLASS_worst] = one;
        tape_play(engine->class[subset->class].residual, engine->member[s], links.array, &none, engine->frame);
        if (bad < 0 &&
            !(one[0] <= GIC_POSE_RESIDUAL(plan->formula[subset->class]->distance) && one[1] <= GIC_MOTION_RESIDUAL))
            bad = s;
        largest[0] = GIC_MAX(largest[0], one[0]);
        largest[1] = GIC_MAX(largest[1], one[1]);
    }
    return bad;
}
