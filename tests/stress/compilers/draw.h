/* SPDX-License-Identifier: MIT
 * For attacks on compilers: random states of a model, the same ones whatever the compiler does, in either precision. */
#ifndef DRAW_H
#define DRAW_H

#define PASTE(a, b) a##b
#define DESCRIPTOR(name) PASTE(name, _model)

/* Evenly in [-1, 1), by integers up to the last step: the same number whatever the compiler does, in either precision.
 */
static gic_real even(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (gic_real)((int32_t)(*seed >> 44) - (1 << 19)) / (gic_real)(1 << 19);
}

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

/* Coordinates in the middle half of their ranges, speeds of driving. */
static void draw(const gic_model *model, void *self, uint64_t *seed)
{
    gic_real *state = array(self, model->state_offset), *input = array(self, model->input_offset);
    const int32_t base = model->free_base ? 7 : 0, half = (model->slow_count - (model->free_base ? 13 : 0)) / 2;
    for (int32_t i = base + half; i < model->slow_count; ++i)
        state[i] = even(seed);
    if (model->free_base) {
        /* Euler parameters of rational numbers: (1 - t^2, 2 t) / (1 + t^2) about the vertical */
        const gic_real t = even(seed), s = GIC_R(1.0) + t * t;
        state[3] = (GIC_R(1.0) - t * t) / s;
        state[4] = state[5] = 0;
        state[6] = GIC_R(2.0) * t / s;
    }
    for (int32_t c = 0; c < model->coordinate_count; ++c) {
        const gic_real low = model->coordinate_low[c], high = model->coordinate_high[c];
        const gic_real value = GIC_R(0.5) * (low + high) + GIC_R(0.25) * (high - low) * even(seed);
        if (model->coordinate_state[c] >= 0)
            state[model->coordinate_state[c]] = value;
        else
            input[model->coordinate_input[c]] = value;
    }
}

#endif
