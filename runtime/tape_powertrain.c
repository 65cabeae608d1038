/* SPDX-License-Identifier: MIT
 * A powertrain: the templates powertrain.c.in and shift.c.in, over tapes. */
#include "tape_engine.h"

#include "../generator/powertrain.h"

#include <math.h>

static int32_t *gears_of(Instance *self)
{
    const gic_model *code = &tape_of(self)->code;
    return (int32_t *)(void *)tape_array(self, code->discrete_offset) + code->free_base;
}

int tape_engage(Instance *self)
{
    const TapeEngine *engine = tape_of(self);
    const Powertrain *powertrain = engine->formulation->model->powertrain;
    const int32_t *gears = gears_of(self);
    double *gear = tape_array(self, engine->gear_offset);
    for (int i = 0; i < 2; ++i) {
        if (gears[i] < -powertrain->reverse || gears[i] > powertrain->forward)
            return GIC_ERROR_INPUT;
        gear[GEAR_RATIO + i] = powertrain->gear[powertrain->reverse + gears[i]];
        gear[GEAR_ENGAGED + i] = gears[i] ? 1 : 0;
    }
    gear[GEAR_NUMBER] = gears[0];
    return GIC_OK;
}

/* As in shift.c.in. */
static const double rounding = 1e-9;

static bool is_reached(double time, double limit)
{
    return time >= (1 - rounding) * limit;
}

static bool is_above(double x, double limit)
{
    return x - limit > rounding * (1 + fabs(limit));
}

int tape_shift(void *instance)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    const Powertrain *powertrain = engine->formulation->model->powertrain;
    const TapeWorld world = {.table = engine->table};
    double *state = tape_array(self, code->state_offset), *fast = state + code->slow_count;
    double *age = fast + powertrain->fast + POWERTRAIN_AGE, time = gic_time(self);
    double *choice = engine->choice;
    int32_t *gears = gears_of(self), next = gears[0];
    double *const array[WHOLE_COUNT] = {
        [WHOLE_time] = &time,
        [WHOLE_fast] = fast,
        [WHOLE_x] = tape_array(self, engine->x_offset),
        [WHOLE_xd] = tape_array(self, engine->xd_offset),
        [WHOLE_u] = tape_array(self, code->input_offset),
        [WHOLE_p] = tape_array(self, code->parameter_offset),
        [WHOLE_gear] = tape_array(self, engine->gear_offset),
        [WHOLE_choice] = choice,
    };
    if (!is_reached(*age, powertrain->duration) || tape_engage(self) != GIC_OK)
        return 0;
    tape_gather(self, state);
    tape_play(engine->shift, 0, array, &world, engine->frame);
    const double *up = choice + CHOICE_UP, *down = up + powertrain->forward - 1;
    const double selector = choice[CHOICE_SELECTOR];
    const int32_t wanted = is_above(selector, 0.5) ? 1 : is_above(-selector, 0.5) && powertrain->reverse ? -1 : 0;
    if (wanted != (next > 0) - (next < 0)) {
        next = wanted;
    } else if (next > 0 && is_reached(*age, powertrain->latency)) {
        if (next < powertrain->forward && is_above(choice[CHOICE_TURBINE], up[next - 1]))
            ++next;
        else if (next > 1 && is_above(-choice[CHOICE_TURBINE], -down[next - 2]))
            --next;
    }
    if (next == gears[0])
        return 0;
    gears[1] = gears[0];
    gears[0] = next;
    *age = 0;
    return 1;
}

void tape_start_gears(Instance *self)
{
    const Powertrain *powertrain = tape_of(self)->formulation->model->powertrain;
    for (int i = 0; powertrain && i < POWERTRAIN_DISCRETE; ++i)
        gears_of(self)[i] = powertrain->start_gear;
}
