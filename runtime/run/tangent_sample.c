/* SPDX-License-Identifier: MIT
 * Controllers in a run with derivatives: at its times a controller maps the state to one with other held values. The
 * runtime core makes it (gic_sample()); what it did is seen by the numbers of samples and effects, and differentiated
 * here: first values whose delay ends take effect, then rules are evaluated in that state.
 *
 * Where a value stays the same, AB3 goes on; but if the value's formula changes with anything, it would not stay so,
 * and AB3 begins anew in this run, as it would then. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/tangent_private.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

static int rules_of(const gic_model *code)
{
    int rules = 0;
    for (int c = 0; c < code->controller_count; ++c)
        rules += code->controller[c].rule_count;
    return rules;
}

/* What each rule does, by states before and after. Returns true if one does something. */
static bool find_doing(const gic_model *code, const double *before, const double *after, double *doing)
{
    bool any = false;
    for (int c = 0, r = 0; c < code->controller_count; ++c) {
        const gic_controller *controller = &code->controller[c];
        const bool sampled = after[controller->samples] > before[controller->samples];
        for (int i = 0; i < controller->rule_count; ++i, ++r) {
            const gic_rule *rule = &controller->rule[i];
            const bool effect =
                rule->effects < 0 ? sampled && rule->waiting > 0 : after[rule->effects] > before[rule->effects];
            doing[r] = (effect ? SAMPLE_EFFECT : 0) + (sampled ? SAMPLE_NEW : 0);
            any = any || doing[r] > 0;
        }
        any = any || sampled;
    }
    return any;
}

/* True if the rule's formula changes with a number of the state, an input or a parameter. *status: of it. */
static bool moves(const TangentRun *run, const gic_rule *rule, int *status)
{
    const Linear *linear = run->linear;
    const gic_model *code = run->code;
    if (*status != GIC_OK)
        return false;
    memset(linear->drate, 0, (size_t)(run->states + code->output_count) * sizeof *linear->drate);
    linear->drate[run->states + rule->output] = 1;
    *status = linear_pull(linear, run->self, LINEAR_RATE, code->output_count);
    bool found = false;
    for (int i = 0; i < run->states; ++i)
        found = found || linear->along.y[i] != 0;
    for (int i = 0; i < code->input_count; ++i)
        found = found || linear->along.u[i] != 0;
    for (int i = 0; i < code->parameter_count; ++i)
        found = found || linear->along.p[i] != 0;
    return found;
}

/* Held values whose delay is over take effect: in a state, or in how one changes. */
static void take_effects(const gic_model *code, const double *doing, double *state)
{
    for (int c = 0, r = 0; c < code->controller_count; ++c)
        for (int i = 0; i < code->controller[c].rule_count; ++i, ++r) {
            const gic_rule *rule = &code->controller[c].rule[i];
            if ((int)doing[r] & SAMPLE_EFFECT)
                state[rule->state] = state[rule->state + rule->waiting];
        }
}

/* Which held values are live, before `after` is reached from `middle`. Returns true if AB3 has to begin anew for one
 * that takes effect. */
static bool follow_live(TangentRun *run, const double *before, const double *middle, const double *after,
                        const double *doing, int *status)
{
    const gic_model *code = run->code;
    bool *live = run->live, anew = false;
    for (int c = 0, r = 0; c < code->controller_count; ++c)
        for (int i = 0; i < code->controller[c].rule_count; ++i, ++r) {
            const gic_rule *rule = &code->controller[c].rule[i];
            const int held = rule->state, newest = held + (rule->waiting > 0);
            if ((int)doing[r] & SAMPLE_EFFECT) {
                live[held] = live[held + rule->waiting];
                anew = anew || (live[held] && middle[held] == before[held]);
            }
            if (!((int)doing[r] & SAMPLE_NEW))
                continue;
            const bool same = after[newest] == middle[newest];
            const bool fresh = rule->output < 0    ? live[held]
                               : rule->quantum > 0 ? false
                                                   : !same || moves(run, rule, status);
            for (int k = rule->waiting; k > 1; --k)
                live[held + k] = live[held + k - 1];
            live[newest] = fresh;
            anew = anew || (rule->waiting == 0 && fresh && same);
        }
    return anew;
}

/* The changes of the state by variable k. */
static int sample_part(TangentRun *run, int k, const double *doing)
{
    const gic_model *code = run->code;
    const Linear *linear = run->linear;
    double *both = tangent_array(run, run->descriptor.state_offset), change[run->states + 1];
    tangent_take(run, both, 1 + k, change);
    take_effects(code, doing, change);
    tangent_point(run, k);
    memcpy(linear->along.y, change, (size_t)run->states * sizeof *change);
    const int status = linear_slope(linear, run->self, LINEAR_RATE, code->output_count);
    if (status != GIC_OK)
        return status;
    for (int c = 0, r = 0; c < code->controller_count; ++c)
        for (int i = 0; i < code->controller[c].rule_count; ++i, ++r) {
            const gic_rule *rule = &code->controller[c].rule[i];
            double *held = change + rule->state;
            if (!((int)doing[r] & SAMPLE_NEW))
                continue;
            const double fresh = rule->quantum > 0  ? 0
                                 : rule->output < 0 ? held[0]
                                                    : linear->drate[run->states + rule->output];
            for (int d = rule->waiting; d > 1; --d)
                held[d] = held[d - 1];
            held[rule->waiting > 0] = fresh;
        }
    tangent_put(run, change, 1 + k, both);
    return gic_finite(change, run->states) ? GIC_OK : GIC_ERROR_RESULT;
}

int tangent_sample(TangentRun *run, int *event, double *next)
{
    const gic_model *code = run->code;
    const double time = gic_time(run->both);
    const size_t size = (size_t)run->states * sizeof(double);
    const int rules = rules_of(code);
    double *both = tangent_array(run, run->descriptor.state_offset), *own = tape_array(run->self, code->state_offset);
    double before[run->states + 1], middle[run->states + 1], after[run->states + 1], doing[rules + 1];
    *event = -1;
    tangent_inputs_of(run, time);
    tangent_take(run, both, 0, before);
    memcpy(own, before, size);
    run->self->head.history = 2;
    int status = gic_sample(code, run->self, next);
    if (status != GIC_OK)
        return status;
    memcpy(after, own, size);
    if (!find_doing(code, before, after, doing))
        return GIC_OK;
    bool anew = run->self->head.history == 0;
    memcpy(middle, before, size);
    take_effects(code, doing, middle);
    memcpy(own, middle, size);
    status = code->outputs(run->self); /* which the derivatives need */
    *event = run->trail ? trail_events(run->trail) : -1;
    tangent_note(run, TRAIL_RATE, time, before, run->states, before, 0);
    tangent_note(run, TRAIL_SAMPLE, time, middle, run->states, doing, rules);
    for (int k = 0; k < run->carried && status == GIC_OK; ++k)
        status = sample_part(run, k, doing);
    anew = follow_live(run, before, middle, after, doing, &status) || anew;
    tangent_put(run, after, 0, both);
    if (anew)
        run->both->head.history = 0;
    return status;
}
