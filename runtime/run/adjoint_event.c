/* SPDX-License-Identifier: MIT
 * Backwards through what conditions and contacts do: see tangent_event.c. */
#include "gic_runtime.h"
#include "run/adjoint_private.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <string.h>

void begun_inputs_back(Back *back, double time, const double *by)
{
    const TangentRun *run = back->run;
    for (int i = 0; i < run->scene->profiles && run->happened.happenings; ++i) {
        const Profile *profile = &run->scene->profile[i];
        const Begun *begun = &run->happened.begun[i];
        double rate[3], unit[3] = {0};
        if (!begun->has)
            continue;
        tangent_profile_rates(profile, time, rate);
        if (begun->unit)
            profile_at(begun->unit, time, unit);
        for (int j = 0; j < profile_orders(profile); ++j) {
            back->present[i] += unit[j] * by[profile->input + j];
            if (begun->clock >= 0)
                back->clock[begun->clock] -= rate[j] * by[profile->input + j];
        }
    }
}

void happenings_back(Back *back, const TrailStep *step)
{
    TangentRun *run = back->run;
    for (int i = step->happened - 1; i >= step->happens; --i) {
        const Happening *happening = &run->happened.happening[i];
        const int at = happening->profile, input = happening->before.input;
        double by[run->inputs + 1], rate[3];
        memset(by, 0, sizeof by);
        by[input] = back->present[at];
        back->present[at] = 0;
        run->scene->profile[at] = happening->before;
        run->happened.begun[at] = happening->begun;
        tangent_profile_rates(&happening->before, happening->time, rate);
        if (happening->clock >= 0)
            back->clock[happening->clock] += by[input] * rate[0];
        inputs_back(back, happening->time, by, NULL);
    }
}

/* By the condition or contact that ends a piece, times `weight`, to the state there and the time. */
static int condition_back(Back *back, const TrailStep *last, double weight)
{
    const TangentRun *run = back->run;
    const TrailEvent *guard = trail_event(run->trail, last->guard);
    double by_output[run->code->output_count + 1];
    memset(by_output, 0, sizeof by_output);
    const int contact = last->condition - run->happened.conditions;
    if (contact < 0)
        by_output[tangent_guard_output(run, last->condition)] = weight;
    const int status = contact < 0 ? outputs_back(back, guard, by_output) : press_back(back, guard, contact, weight);
    if (status != GIC_OK)
        return status;
    memcpy(back->state, run->linear->along.y, (size_t)run->states * sizeof *back->state);
    back->clock[last->later] = 0;
    clock_back(back, last->later, guard->time);
    return GIC_OK;
}

static int piece_back(Back *back, int64_t first, int64_t last, double weight)
{
    int status = GIC_OK;
    for (int64_t i = last; i >= first && status == GIC_OK; --i)
        status = part_back(back, trail_step(back->run->trail, i), i == first ? weight : 0);
    return status;
}

int located_back(Back *back, int64_t at, double weight)
{
    const TangentRun *run = back->run;
    const TrailStep *last = trail_step(run->trail, at);
    const size_t size = (size_t)run->states * sizeof(double);
    const DriveSlope drive = back->drive;
    /* At 0 the number of a contact has two slopes, of the load and of the distance: on whose side it is, rounding
     * tells, and so it has to be evaluated from the same guess both times. */
    Instance *guess = run->happened.inner->self;
    double state[run->states + 1], sums[back->all_sums + 1];
    memcpy(guess, run->self, run->code->size);
    memcpy(state, back->state, size);
    memcpy(sums, back->sums, (size_t)back->all_sums * sizeof *sums);
    /* by how much the condition grows where the piece is longer */
    int status = condition_back(back, last, 1);
    if (status == GIC_OK)
        status = piece_back(back, last->piece, at, 0);
    const double slope = back->clock[last->later];
    memcpy(back->state, state, size);
    memcpy(back->sums, sums, (size_t)back->all_sums * sizeof *sums);
    back->drive = drive;
    /* what the number follows from with the time as it is, and the time */
    if (status == GIC_OK)
        status = piece_back(back, last->piece, at, weight);
    const double by_time = back->clock[last->later];
    memcpy(state, back->state, size);
    memcpy(run->self, guess, run->code->size);
    if (status == GIC_OK)
        status = condition_back(back, last, -by_time / slope);
    if (status == GIC_OK)
        status = piece_back(back, last->piece, at, 0);
    adjoint_add(run->states, 1, state, back->state);
    return status;
}
