/* SPDX-License-Identifier: MIT
 * Reaction forces of joints: the templates reactions.c.in and react.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "sequence/sequence.h"
#include "tape/engine_tape.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

/* Multipliers of one subset; its wrenches on the bodies solved before are subtracted from theirs. spare: room for
 * wrenches that are not needed. */
static void react_subset(Instance *self, TapeLinks *links, int s, double *spare)
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const Subset *subset = &plan->sequence->subset[s];
    const TapeClass *class = &engine->class[subset->class];
    const TapeWorld none = {.table = NULL};
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
    links->array[CLASS_f] = start + plan->start_offset[s] + class->layout->start_factors;
    links->array[CLASS_w] = lambda + plan->multiplier_offset[subset->body[0]];
    tape_play(class->react, engine->member[s], links->array, &none, engine->frame);
}

int tape_react(Instance *self, const double e[4])
{
    const TapeEngine *engine = tape_of(self);
    const Sequence *sequence = engine->formulation->sequence;
    TapeLinks links = engine->links;
    double spare[6] = {0};
    int status = tape_whole(self, engine->wrenches, gic_time(self), tape_array(self, engine->code.state_offset), e,
                            tape_array(self, engine->code.rate_offset), NULL, NULL);
    /* in reverse computational sequence: the wrenches on a subset are known before it is solved */
    for (int s = sequence->subsets - 1; s >= 0 && status == GIC_OK; --s)
        if (sequence->subset[s].class >= 0 && engine->reacts[s])
            react_subset(self, &links, s, spare);
    return status;
}
