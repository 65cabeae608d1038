/* SPDX-License-Identifier: MIT
 * A step of AB3 beside its right-hand side: what the integrator takes. */
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"

#include <math.h>
#include <string.h>

enum {
    START = 3,  /* AB3 has its history after two steps of RK4 */
    STEPS = 16, /* timed together */
    TURNS = 5
};

int step_parts(Pool *pool, const gic_model *code, gic_head *self, const double *state, double length, double *seconds)
{
    const size_t states = (size_t)(code->slow_count + code->fast_count);
    double *before = pool_alloc(pool, sizeof *before * (STEPS + 1) * (states + 1)), *rate = before + STEPS * states;
    double time[STEPS], *present = instance_array(self, code->state_offset);
    void *kept = pool_alloc(pool, code->size), *begin = pool_alloc(pool, code->size);
    int status = GIC_OK;
    memcpy(kept, self, code->size);
    self->input_function = NULL;
    memcpy(present, state, sizeof *state * states);
    gic_restart(self, gic_time(self));
    for (int i = 0; i < START && status == GIC_OK; ++i)
        status = gic_step(code, self, length, GIC_AB3);
    memcpy(begin, self, code->size);
    for (int i = 0; i < STEPS && status == GIC_OK; ++i) {
        time[i] = gic_time(self);
        memcpy(before + (size_t)i * states, present, sizeof *present * states);
        status = gic_step(code, self, length, GIC_AB3);
    }
    seconds[0] = seconds[1] = INFINITY;
    for (int turn = 0; turn < TURNS && status == GIC_OK; ++turn) {
        memcpy(self, begin, code->size);
        double from = clock_seconds(CLOCK_MONOTONIC);
        for (int i = 0; i < STEPS && status == GIC_OK; ++i)
            status = gic_step(code, self, length, GIC_AB3);
        seconds[0] = fmin(seconds[0], (clock_seconds(CLOCK_MONOTONIC) - from) / (int)STEPS);
        memcpy(self, begin, code->size);
        from = clock_seconds(CLOCK_MONOTONIC);
        for (int i = 0; i < STEPS && status == GIC_OK; ++i)
            status = code->rhs(self, time[i], before + (size_t)i * states, rate);
        seconds[1] = fmin(seconds[1], (clock_seconds(CLOCK_MONOTONIC) - from) / (int)STEPS);
    }
    memcpy(self, kept, code->size);
    return status;
}
