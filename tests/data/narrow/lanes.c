/* SPDX-License-Identifier: MIT
 * Prints every state, and at the end every output, of code for one scene (MODEL: its descriptor), as the bits that they
 * have: on a road that is the same on both sides, where ROAD is defined; DUAL fast steps
 * a step, where there are any. */
#include "gic_runtime.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

extern const gic_model MODEL;

enum { STEPS = 60 };

#ifndef DUAL
#define DUAL 1
#endif

static const gic_real *array(const void *self, size_t offset)
{
    return (const gic_real *)(const void *)((const char *)self + offset);
}

#ifdef ROAD
static void waves(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)y;
    out[0] = GIC_R(0.02) * (gic_real)sin(x);
    out[1] = GIC_R(0.02) * (gic_real)cos(x);
    out[2] = 0;
}
#endif

int main(void)
{
    void *const car = calloc(1, MODEL.size);
    int status = car ? MODEL.setup(car) : GIC_ERROR_INPUT;
    if (!car)
        return 1;
#ifdef ROAD
    static const gic_road road = {waves, NULL, NULL, NULL, GIC_ROAD_OWN};
    ((gic_head *)car)->road = &road;
#endif
    gic_real *const state = (gic_real *)(void *)((char *)car + MODEL.state_offset);
    if (MODEL.free_base)
        state[MODEL.slow_count / 2 + 1] += GIC_R(10.0);
    for (int step = 0; step < STEPS && status == GIC_OK; ++step) {
        status = MODEL.fast_count ? gic_step_dual(&MODEL, car, GIC_R(0.005), DUAL)
                                  : gic_step(&MODEL, car, GIC_R(0.005), GIC_AB3);
        for (int i = 0; i < MODEL.slow_count + MODEL.fast_count; ++i)
            printf("%a\n", (double)array(car, MODEL.state_offset)[i]);
    }
    if (status == GIC_OK)
        status = MODEL.outputs(car);
    for (int i = 0; i < MODEL.output_count; ++i)
        printf("%a\n", (double)array(car, MODEL.output_offset)[i]);
    printf("%s\n", gic_status_text(status));
    free(car);
    return status != GIC_OK;
}
