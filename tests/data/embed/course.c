/* SPDX-License-Identifier: MIT
 * A model (MODEL: its descriptor), pushed a little, over some steps: prints every bit of state, rate and outputs
 * (forces and torques as such), and its self-test, for comparison with other code for the same model; then what ends it
 * when a coordinate goes far out.
 */
#include "gic_runtime.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 200 };

extern const gic_model MODEL;

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

static void print(const char *what, const gic_real *number, int count)
{
    for (int i = 0; i < count; ++i)
        printf("%s %d %.17g\n", what, i, (double)number[i]);
}

int main(void)
{
    void *const self = calloc(1, MODEL.size), *const kept = calloc(1, MODEL.size);
    gic_self_test test;
    int status = self && kept ? MODEL.setup(self) : -1;
    if (status != GIC_OK)
        return 1;
    gic_real *const state = array(self, MODEL.state_offset), *const rate = array(self, MODEL.rate_offset);
    const int slow = MODEL.slow_count, states = slow + MODEL.fast_count;
    for (int i = 0; i < slow; ++i)
        if (!MODEL.free_base || i >= 7)
            state[i] += GIC_R(0.001) * (gic_real)(1 + i % 5);
    if (MODEL.free_base)
        state[slow / 2 + 1] += 5;
    for (int i = 0; i < STEPS && status == GIC_OK; ++i)
        status = gic_step(&MODEL, self, GIC_R(0.001), i < STEPS / 2 ? GIC_AB3 : GIC_RK4);
    printf("status %d\n", status);
    status = MODEL.outputs(self);
    print("state", state, states);
    print("rate", rate, states);
    for (int i = 0; i < MODEL.output_count; ++i)
        printf("%s %d %.17g\n", MODEL.output[i].unit[0] == 'N' ? "force" : "output", i,
               (double)array(self, MODEL.output_offset)[i]);
    status = status == GIC_OK ? MODEL.self_test(self, &test) : status;
    printf("self-test %d %.17g\n", status, status == GIC_OK ? (double)test.constraint : 0);
    const gic_head *const head = self;
    printf("counts %ld %ld %ld\n", (long)head->rhs_count, (long)head->newton_count, (long)head->correction_count);
    /* one coordinate after another half a metre or radian away: whose fault it is, and that nothing moved */
    for (int c = 0; c < MODEL.coordinate_count; ++c) {
        if (MODEL.coordinate_state[c] < 0)
            continue;
        for (int way = -1; way <= 1; way += 2) {
            memcpy(kept, self, MODEL.size);
            gic_real *const moved = array(kept, MODEL.state_offset);
            moved[MODEL.coordinate_state[c]] += (gic_real)way * GIC_R(0.5);
            status = gic_step(&MODEL, kept, GIC_R(0.001), GIC_AB3);
            const gic_head *const failed = kept;
            printf("away %d %d: status %d, subset %d\n", c, way, status, status == GIC_OK ? -1 : (int)failed->subset);
            print("moved", moved, slow);
        }
    }
    free(self), free(kept);
    return 0;
}
