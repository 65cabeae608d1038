/* SPDX-License-Identifier: MIT
 * The last state of a run that has outputs: what they depend on, before each of the last two steps. */
#include "run/last_good.h"

#include "gic_runtime.h"

#include <string.h>

enum { KEPT = 2 };

typedef struct Kept {
    double time, *state, *input;
    int32_t *discrete;
} Kept;

struct LastGood {
    size_t states, inputs, discretes;
    Kept kept[KEPT];
    int count, newest;
};

LastGood *last_good_new(Pool *pool, const Engine *engine)
{
    const gic_model *code = engine->code;
    LastGood *good = pool_alloc(pool, sizeof *good);
    *good = (LastGood){.states = (size_t)(code->slow_count + code->fast_count),
                       .inputs = (size_t)code->input_count,
                       .discretes = (size_t)code->discrete_count};
    for (int k = 0; k < KEPT; ++k) {
        good->kept[k].state = pool_alloc(pool, sizeof(double) * (good->states + 1));
        good->kept[k].input = pool_alloc(pool, sizeof(double) * (good->inputs + 1));
        good->kept[k].discrete = pool_alloc(pool, sizeof(int32_t) * (good->discretes + 1));
    }
    return good;
}

void last_good_forget(LastGood *good)
{
    good->count = 0;
}

static int32_t *discrete_of(const gic_model *model, gic_head *self)
{
    return (int32_t *)(void *)((char *)self + model->discrete_offset);
}

void last_good_keep(LastGood *good, const gic_model *model, const gic_head *self)
{
    gic_head *from = (gic_head *)self; /* only read */
    good->newest = (good->newest + 1) % KEPT;
    good->count += good->count < KEPT;
    Kept *kept = &good->kept[good->newest];
    kept->time = gic_time(self);
    memcpy(kept->state, instance_array(from, model->state_offset), sizeof(double) * good->states);
    memcpy(kept->input, instance_array(from, model->input_offset), sizeof(double) * good->inputs);
    memcpy(kept->discrete, discrete_of(model, from), sizeof(int32_t) * good->discretes);
}

bool last_good_outputs(const LastGood *good, const gic_model *model, const gic_head *self, const gic_head *failed,
                       gic_head *copy)
{
    const gic_head about = *failed;
    for (int k = 0; k < good->count; ++k) {
        const Kept *kept = &good->kept[(good->newest + KEPT - k) % KEPT];
        memcpy(copy, self, model->size);
        gic_restart(copy, kept->time);
        memcpy(instance_array(copy, model->state_offset), kept->state, sizeof(double) * good->states);
        memcpy(instance_array(copy, model->input_offset), kept->input, sizeof(double) * good->inputs);
        memcpy(discrete_of(model, copy), kept->discrete, sizeof(int32_t) * good->discretes);
        copy->grown = -1;
        copy->unchecked = 0;
        copy->input_function = NULL; /* inputs as they were; a driver may have looked since then */
        const bool found = model->outputs(copy) == GIC_OK;
        copy->input_function = self->input_function;
        if (!found)
            continue;
        copy->grown = about.grown;
        copy->subset = about.subset;
        copy->condition = about.condition;
        copy->event = about.event;
        return true;
    }
    return false;
}
