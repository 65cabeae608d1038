/* SPDX-License-Identifier: MIT
 * Reaction forces of joints: the templates reactions.c.in and react.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "sequence/sequence.h"
#include "tape/engine_tape.h"
#include "tape/journal.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

/* Addresses of the numbers with which the multipliers of one subset are found, in an instance or in its derivatives.
 * Its wrenches on the bodies solved before are subtracted from theirs. spare: room for wrenches that are not needed. */
static void link_reaction(Instance *self, TapeLinks *links, int s, double *spare)
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const Subset *subset = &plan->sequence->subset[s];
    double *start = tape_start(self), *lambda = tape_array(self, engine->multiplier_offset);
    double **onto = links->array + CLASS_KNOWN + engine->formulation->known_most;
    tape_link(self, links, subset);
    for (int i = 0; i < subset->knowns; ++i) {
        const int body = subset->known[i];
        onto[i] = engine->reacts[plan->sequence->body_subset[body]] ? lambda + plan->multiplier_offset[body] : spare;
    }
    for (int j = 0; j < subset->deps; ++j)
        links->x[j] = start[subset->dep[j]];
    links->array[CLASS_motion] = tape_array(self, engine->motion_offset) + plan->motion_offset[subset->body[0]];
    links->array[CLASS_f] = start + plan->start_offset[s] + engine->class[subset->class].layout->start_factors;
    links->array[CLASS_w] = lambda + plan->multiplier_offset[subset->body[0]];
}

/* True for a subset whose multipliers are found. */
static bool reacts(const TapeEngine *engine, int s)
{
    return engine->formulation->sequence->subset[s].class >= 0 && engine->reacts[s];
}

int tape_react(Instance *self, const double e[4])
{
    const TapeEngine *engine = tape_of(self);
    const Sequence *sequence = engine->formulation->sequence;
    const TapeWorld none = {.table = NULL};
    TapeLinks links = engine->links;
    double spare[6] = {0};
    int status = tape_whole(self, engine->wrenches, gic_time(self), tape_array(self, engine->code.state_offset), e,
                            tape_array(self, engine->code.rate_offset), NULL, NULL);
    /* in reverse computational sequence: the wrenches on a subset are known before it is solved */
    for (int s = sequence->subsets - 1; s >= 0 && status == GIC_OK; --s)
        if (reacts(engine, s)) {
            link_reaction(self, &links, s, spare);
            tape_play(engine->class[sequence->subset[s].class].react, engine->member[s], links.array, &none,
                      engine->frame);
        }
    return status;
}

int tape_react_dual(Instance *const self[2], TapeLinks *const links[2], const TapeWorld *world, double *const *array,
                    double *const *slope, double *slope_frame)
{
    const TapeEngine *engine = tape_of(self[0]);
    const Sequence *sequence = engine->formulation->sequence;
    double spare[2][6] = {{0}};
    double *const unused[] = {spare[0], journal_numbers(world, spare[1], 6)};
    int status = tape_play_dual(engine->wrenches, 0, array, slope, world, engine->frame, slope_frame);
    for (int s = sequence->subsets - 1; s >= 0 && status == GIC_OK; --s)
        if (reacts(engine, s)) {
            for (int side = 0; side < 2; ++side)
                link_reaction(self[side], links[side], s, unused[side]);
            for (int j = 0; world->journal && j < sequence->subset[s].deps; ++j)
                journal_copy(world->journal, tape_start(self[1]) + sequence->subset[s].dep[j], &links[1]->x[j], 1);
            status = tape_play_dual(engine->class[sequence->subset[s].class].react, engine->member[s], links[0]->array,
                                    links[1]->array, world, engine->frame, slope_frame);
        }
    return status;
}
