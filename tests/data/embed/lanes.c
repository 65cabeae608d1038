/* SPDX-License-Identifier: MIT
 * Vehicles of any model (BATCH: its descriptor) with parameters and initial states of their own, in lanes and one by
 * one, at one rate and, where there are fast states, at two: prints for how many state, outputs and status are the same
 * to the last bit, and how many there are. SCENE: code for one scene, whose parameters do not change; three vehicles do
 * what it takes for granted that they do not, and end with the same status about the same assumption. */
#include "gic_batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 100, DUAL = 20, RATIO = 4, MOST = 100 };

#ifndef STEP
#define STEP 0.001 /* s */
#endif

extern const gic_batch_model BATCH;

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

#ifdef SCENE
/* Higher to the left, and slippery there. */
static void bank(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x;
    out[0] = GIC_R(0.01) * y;
    out[1] = 0;
    out[2] = GIC_R(0.01);
}

static const gic_road banked = {bank, NULL, NULL, NULL, GIC_ROAD_OWN};

/* Another road, motion to the side, an input. */
static void break_away(const gic_model *model, gic_head *car, int i)
{
    if (i == 5)
        car->road = &banked;
    else if (i == 6)
        array(car, model->state_offset)[model->slow_count / 2 + 2] += GIC_R(0.5);
    else if (i == 7)
        array(car, model->input_offset)[0] += GIC_R(0.125);
}
#endif

/* The i-th: parameters greater by i thousandths, a vehicle faster by i m/s, other coordinates moved by i mm or mrad. */
static int begin(const gic_model *model, void *car, int i)
{
    gic_real parameter[MOST];
    int status = model->setup(car);
    gic_real *const state = array(car, model->state_offset);
#ifndef SCENE
    for (int k = 0; k < model->parameter_count; ++k)
        parameter[k] = array(car, model->parameter_offset)[k] * (1 + GIC_R(0.001) * (gic_real)i);
    if (model->parameter_count && status == GIC_OK)
        status = model->setup_with(car, parameter);
#else
    (void)parameter;
    break_away(model, car, i);
#endif
    if (model->free_base)
        state[model->slow_count / 2 + 1] += (gic_real)(3 + i);
    for (int k = 0; k < model->slow_count / 2 && !model->free_base; ++k)
        state[k] += GIC_R(0.001) * (gic_real)i;
    return status;
}

int main(void)
{
    const gic_model *const model = BATCH.model;
    const size_t numbers = sizeof(gic_real) * (size_t)(model->slow_count + model->fast_count);
    void *const batch = aligned_alloc(BATCH.alignment, BATCH.size), *const copy = calloc(1, model->size);
    char *const car = calloc((size_t)BATCH.vehicles, model->size);
    int states = 0, outputs = 0, statuses = 0;
    if (!batch || !copy || !car || model->parameter_count > MOST || BATCH.setup(batch) != GIC_OK)
        return 1;
    for (int i = 0; i < BATCH.vehicles; ++i) {
        if (begin(model, car + (size_t)i * model->size, i) != GIC_OK)
            return 1;
        BATCH.load(batch, i, car + (size_t)i * model->size);
    }
    BATCH.step(batch, GIC_R(STEP), GIC_AB3, STEPS);
    if (BATCH.step_dual)
        BATCH.step_dual(batch, GIC_R(STEP), RATIO, GIC_R(0.0), DUAL);
    for (int i = 0; i < BATCH.vehicles; ++i) {
        void *const one = car + (size_t)i * model->size;
        int status = GIC_OK;
        for (int k = 0; k < STEPS && status == GIC_OK; ++k)
            status = gic_step(model, one, GIC_R(STEP), GIC_AB3);
        for (int k = 0; k < DUAL && status == GIC_OK && BATCH.step_dual; ++k)
            status = gic_step_dual(model, one, GIC_R(STEP), RATIO);
        BATCH.store(batch, i, copy);
        states += !memcmp(array(one, model->state_offset), array(copy, model->state_offset), numbers);
        statuses += BATCH.status(batch, i) == status &&
                    (status != GIC_ERROR_ASSUMPTION || ((gic_head *)copy)->condition == ((gic_head *)one)->condition);
    }
    BATCH.outputs(batch);
    for (int i = 0; i < BATCH.vehicles; ++i) {
        void *const one = car + (size_t)i * model->size;
        int same = model->outputs(one) == GIC_OK;
        for (int k = 0; k < model->output_count; ++k)
            same = same && array(one, model->output_offset)[k] == BATCH.output(batch, i, k);
        outputs += same;
    }
    printf("%d %d %d of %d\n", states, outputs, statuses, BATCH.vehicles);
    free(batch), free(copy), free(car);
    return 0;
}
