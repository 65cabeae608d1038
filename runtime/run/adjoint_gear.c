/* SPDX-License-Identifier: MIT
 * Backwards through changes of gear: see tangent_gear.c. */
#include "gic_runtime.h"
#include "run/adjoint_private.h"
#include "tape/engine_tape.h"

#include <string.h>

/* Back through the share of the step at which the gear changed, with the derivative by it: what it followed from.
 * number: of the event. */
static int guard_back(Back *back, const TrailEvent *change, double by_share)
{
    const TangentRun *run = back->run;
    const Linear *linear = run->linear;
    const gic_model *code = run->code;
    const int choices = linear->choices, states = run->states;
    const double *weight = change->number + 2 * states, of_age = weight[choices], slope = weight[choices + 1];
    double *own = tape_array(run->self, code->state_offset);
    if (!(slope > 0))
        return GIC_OK;
    const double by = -by_share / slope;
    memcpy(own, change->number, (size_t)states * sizeof *own);
    memcpy(tape_array(run->self, code->input_offset), weight + choices + 2, (size_t)run->inputs * sizeof *own);
    run->self->head.start_time = change->time;
    run->self->head.steps = 0;
    tangent_go(run, change);
    tape_gather(run->self, own);
    int status = tape_engage(run->self);
    for (int i = 0; i < choices; ++i)
        linear->choice[1][i] = by * weight[i];
    if (status == GIC_OK)
        status = linear_pull(linear, run->self, LINEAR_SHIFT, 0);
    if (status != GIC_OK)
        return status;
    adjoint_add(states, 1, linear->along.y, back->state);
    *tangent_age(run, back->state) += by * of_age;
    adjoint_add(code->parameter_count, 1, linear->along.p, back->parameter);
    inputs_back(back, change->time, linear->along.u, NULL);
    return GIC_OK;
}

int gear_back(Back *back, const TrailStep *step)
{
    const TangentRun *run = back->run;
    const int parts = tangent_parts(run, step->dual), states = run->states, there = step->gear;
    const TrailEvent *settled = trail_event(run->trail, there + 1), *change = trail_event(run->trail, there + 2);
    const double h = step->length, *bend = change->number + states;
    double by_share = 0, by_late = 0;
    back->rest = (Rest){.going = true, .start = change->time, .end = step->start + h, .by_late = &by_late};
    clear_moments(back);
    int status = parts_back(back, there + 3, parts, (back->rest.end - back->rest.start) / parts, 0);
    back->rest.going = false;
    if (status != GIC_OK)
        return status;
    *tangent_age(run, back->state) = 0;
    for (int i = 0; i < states; ++i)
        by_share += bend[i] * back->state[i];
    status = guard_back(back, change, by_share + h * by_late);
    settle_back(back, settled);
    const Cubic by = tangent_between(step->share, h);
    adjoint_set(states, by.from, back->state, back->from);
    adjoint_set(states, by.rate, back->state, back->start_rate);
    adjoint_set(states, by.rate_there, back->state, back->sum);
    adjoint_set(states, by.to, back->state, back->state);
    if (status == GIC_OK)
        status = rate_back(back, trail_event(run->trail, there), back->sum, 0, NULL);
    adjoint_add(states, 1, run->linear->along.y, back->state);
    return status;
}
