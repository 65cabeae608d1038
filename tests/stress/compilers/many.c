/* SPDX-License-Identifier: MIT
 * For attacks on compilers, built with a model's code and that of its lanes: -DMODEL=hmmwv -DMANY=hmmwv_batch
 * -DHEADER='"hmmwv_batch.h"'. Vehicles in random states take steps in lanes and one after another; prints the largest
 * difference of their states, relative to 1 and the number's own size. Each must end with the same status. */
#define _ISOC11_SOURCE
#include HEADER

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draw.h"

enum { STEPS = 40 };

int main(void)
{
    const gic_model *model = &DESCRIPTOR(MODEL);
    const gic_batch_model *many = &DESCRIPTOR(MANY);
    const int32_t states = model->slow_count + model->fast_count;
    const gic_real step = GIC_R(0.0005);
    void *batch = aligned_alloc(many->alignment, many->size), *one = malloc(model->size), *stored = malloc(model->size);
    void **vehicle = calloc((size_t)many->vehicles, sizeof *vehicle);
    uint64_t seed = 7;
    double most = 0;
    int32_t bad = 0;
    if (!batch || !one || !stored || !vehicle || model->setup(one) != GIC_OK || many->setup(batch) != GIC_OK)
        return 2;
    memcpy(stored, one, model->size);
    for (int32_t i = 0; i < many->vehicles; ++i) {
        vehicle[i] = malloc(model->size);
        if (!vehicle[i])
            return 2;
        memcpy(vehicle[i], one, model->size);
        draw(model, vehicle[i], &seed);
        many->load(batch, i, vehicle[i]);
    }
    (void)many->step(batch, step, GIC_AB3, STEPS);
    for (int32_t i = 0; i < many->vehicles; ++i) {
        int status = GIC_OK;
        for (int k = 0; k < STEPS && status == GIC_OK; ++k)
            status = gic_step(model, vehicle[i], step, GIC_AB3);
        bad += status != GIC_OK || many->status(batch, i) != status;
        many->store(batch, i, stored);
        const gic_real *a = array(stored, model->state_offset), *b = array(vehicle[i], model->state_offset);
        for (int32_t k = 0; k < states; ++k) {
            const double x = (double)a[k], y = (double)b[k], size = 1 + (y < 0 ? -y : y);
            const double off = (x > y ? x - y : y - x) / size;
            if (!(off <= most))
                most = off;
        }
        free(vehicle[i]);
    }
    if (bad)
        fprintf(stderr, "%d vehicles end with another status, or none that is good\n", (int)bad);
    printf("%.1e\n", most);
    free(vehicle);
    free(batch);
    free(one);
    free(stored);
    return bad != 0;
}
