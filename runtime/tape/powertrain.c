/* SPDX-License-Identifier: MIT
 * A powertrain: the templates powertrain.c.in and shift.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "tape/engine_tape.h"
#include "tape/record.h"

#include <math.h>
#include <string.h>

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
    int32_t *gears = gears_of(self);
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
    if (!gic_reached(*age, powertrain->duration) || tape_engage(self) != GIC_OK)
        return 0;
    tape_gather(self, state);
    tape_play(engine->shift, 0, array, &world, engine->frame);
    const int32_t next = gic_next_gear(gears[0], powertrain->forward, powertrain->reverse, choice,
                                       gic_reached(*age, powertrain->latency));
    if (next == gears[0])
        return 0;
    gears[1] = gears[0];
    gears[0] = next;
    *age = 0;
    return 1;
}

int tape_choose_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                     double *const choice[2], double *slope_frame)
{
    double *own[2][WHOLE_COUNT];
    for (int side = 0; side < 2; ++side) {
        memcpy(own[side], side ? slope : array, sizeof own[side]);
        own[side][WHOLE_fast] = own[side][WHOLE_y] + engine->code.slow_count;
        own[side][WHOLE_choice] = choice[side];
    }
    return tape_play_dual(engine->shift, 0, own[0], own[1], world, engine->frame, slope_frame);
}

void tape_start_gears(Instance *self)
{
    const Powertrain *powertrain = tape_of(self)->formulation->model->powertrain;
    for (int i = 0; powertrain && i < POWERTRAIN_DISCRETE; ++i)
        gears_of(self)[i] = powertrain->start_gear;
}
