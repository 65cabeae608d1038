/* SPDX-License-Identifier: MIT
 * For attacks on compilers, built with a model's code: -DMODEL=hmmwv -DHEADER='"hmmwv.h"'. Prints rates and outputs at
 * random states and after a run, and says whether statuses still see what is no number. With -DTRAP invalid operations,
 * divisions by zero and overflows end the program. */
#ifdef TRAP
#define _GNU_SOURCE
#include <fenv.h>
#endif
#include HEADER

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PASTE(a, b) a##b
#define DESCRIPTOR(name) PASTE(name, _model)

static uint64_t seed = 7;

/* Evenly in [-1, 1), by integers up to the last step: the same number whatever the compiler does, in either precision.
 */
static gic_real even(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (gic_real)((int32_t)(seed >> 44) - (1 << 19)) / (gic_real)(1 << 19);
}

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

/* Bits, so that no arithmetic of ours comes between. */
static gic_real from_bits(uint64_t bits64, uint32_t bits32)
{
    gic_real x;
    memcpy(&x, sizeof x == 8 ? (const void *)&bits64 : (const void *)&bits32, sizeof x);
    return x;
}

static void print(const gic_real *x, int32_t count)
{
    for (int32_t i = 0; i < count; ++i)
        printf("%.17g\n", (double)x[i]);
}

/* Coordinates in the middle half of their ranges, speeds of driving. */
static void draw(const gic_model *model, void *self)
{
    gic_real *state = array(self, model->state_offset), *input = array(self, model->input_offset);
    const int32_t base = model->free_base ? 7 : 0, half = (model->slow_count - (model->free_base ? 13 : 0)) / 2;
    for (int32_t i = base + half; i < model->slow_count; ++i)
        state[i] = even();
    if (model->free_base) {
        /* Euler parameters of rational numbers: (1 - t^2, 2 t) / (1 + t^2) about the vertical */
        const gic_real t = even(), s = GIC_R(1.0) + t * t;
        state[3] = (GIC_R(1.0) - t * t) / s;
        state[4] = state[5] = 0;
        state[6] = GIC_R(2.0) * t / s;
    }
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const gic_real low = model->coordinate_low[c], high = model->coordinate_high[c];
        const gic_real value = GIC_R(0.5) * (low + high) + GIC_R(0.25) * (high - low) * even();
        if (model->coordinate_state[c] >= 0)
            state[model->coordinate_state[c]] = value;
        else
            input[model->coordinate_input[c]] = value;
    }
}

static int refuses(const gic_model *model, void *self, void *spoiled, size_t offset, gic_real number, int status)
{
    memcpy(spoiled, self, model->size);
    array(spoiled, offset)[0] = number;
    return gic_step(model, spoiled, GIC_R(0.001), GIC_RK4) == status && model->outputs(spoiled) == status;
}

int main(void)
{
    const gic_model *model = &DESCRIPTOR(MODEL);
    void *self = malloc(model->size), *spoiled = malloc(model->size);
    const int32_t states = model->slow_count + model->fast_count;
    int bad = 0;
    if (!self || !spoiled || model->setup(self) != GIC_OK)
        return 2;
#ifdef TRAP
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
#endif
    for (int row = 0; row < 20; ++row) {
        draw(model, self);
        const int status = model->outputs(self);
        if (status != GIC_OK) {
            fprintf(stderr, "row %d: %s\n", row, gic_status_text(status));
            return 1;
        }
        print(array(self, model->rate_offset), states);
        print(array(self, model->output_offset), model->output_count);
    }
    if (model->setup(self) != GIC_OK)
        return 2;
    for (int k = 0; k < 300; ++k) {
        const int status = k < 200 ? gic_step_dual(model, self, GIC_R(0.001), model->fast_count ? 6 : 1)
                                   : gic_step(model, self, GIC_R(0.0005), GIC_RK4);
        if (status != GIC_OK) {
            fprintf(stderr, "step %d: %s\n", k, gic_status_text(status));
            return 1;
        }
    }
    print(array(self, model->state_offset), model->slow_count);
#ifndef TRAP
    const gic_real numbers[] = {from_bits(UINT64_C(0x7ff8000000000000), UINT32_C(0x7fc00000)),
                                from_bits(UINT64_C(0x7ff0000000000000), UINT32_C(0x7f800000)),
                                from_bits(UINT64_C(0xfff0000000000000), UINT32_C(0xff800000)),
                                from_bits(UINT64_C(0x7fe0000000000000), UINT32_C(0x7f000000))};
    for (int i = 0; i < 4; ++i) {
        bad += !refuses(model, self, spoiled, model->state_offset, numbers[i], GIC_ERROR_INPUT);
        if (model->input_count && i < 3)
            bad += !refuses(model, self, spoiled, model->input_offset, numbers[i], GIC_ERROR_INPUT);
    }
#endif
    if (bad)
        fprintf(stderr, "%d numbers that are none were not refused\n", bad);
    free(self);
    free(spoiled);
    return bad != 0;
}
