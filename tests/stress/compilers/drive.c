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

#include "draw.h"

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
    uint64_t seed = 7;
    int bad = 0;
    if (!self || !spoiled || model->setup(self) != GIC_OK)
        return 2;
#ifdef TRAP
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
#endif
    for (int row = 0; row < 20; ++row) {
        draw(model, self, &seed);
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
    /* in steps that resolve the quickest of our models, a crank of 1,500 rad/s: where it turned by a radian a step,
     * rounding in single precision became 1e6 times larger */
    for (int k = 0; k < 300; ++k) {
        const int status = k < 200 ? gic_step_dual(model, self, GIC_R(0.00025), model->fast_count ? 6 : 1)
                                   : gic_step(model, self, GIC_R(0.000125), GIC_RK4);
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
