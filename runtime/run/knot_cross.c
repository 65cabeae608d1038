/* SPDX-License-Identifier: MIT
 * Knots of inputs within constant steps.
 *
 * Where the first derivative of the rates f jumps by J, at a share s of a step of h seconds, the sum that AB3 makes
 * from there on is too small by J h^2 B(s) / 2, B(s) = s^2 - s + 1/6: the interior weights of AB3's sum are all 1, and
 * Euler's and Maclaurin's sum with a kink in it has that term. RK4 weighs the rates of a step like Simpson, whose sum
 * is too small by J h^2 (s^2 / 2 - s / 6), s the share to the nearer end. So that is added once, and what is left of
 * the knot is of order 3. J comes from the inputs: f changes by h J when they change by h times the jump of their
 * derivative. Pages of gicrun --drive compile this file too. */
#include "knot_cross.h"

#include <math.h>
#include <string.h>

double knot_missing(int32_t method, double s)
{
    const double end = fmin(s, 1 - s);
    return method == GIC_AB3 ? (s * s - s + 1.0 / 6) / 2 : end * end / 2 - end / 6;
}

/* Change the inputs by h times the jump of their derivatives at `knot`. */
static void bend(const gic_model *model, const gic_head *self, double knot, double h, double *input)
{
    const double near = h / 16;
    double at[3][model->input_count];
    for (int i = 0; i < 3; ++i) {
        memcpy(at[i], input, sizeof at[i]);
        self->input_function(self->user, self->lane, knot + (i - 1) * near, at[i]);
    }
    for (int i = 0; i < model->input_count; ++i)
        input[i] += h / near * (at[0][i] - 2 * at[1][i] + at[2][i]);
}

int knot_cross(const gic_model *model, gic_head *self, double start, double knot)
{
    const int slow = model->slow_count, count = slow + model->fast_count, ratio = self->ratio;
    const double now = gic_time(self), h = now - start, share = (knot - start) / h, whole = floor(share * ratio);
    const double of_slow = knot_missing(self->method, share);
    const double of_fast = knot_missing(self->method, share * ratio - whole) / (ratio * ratio);
    double *input = (double *)(void *)((char *)self + model->input_offset);
    double *state = (double *)(void *)((char *)self + model->state_offset);
    double kept[model->input_count], next[count], straight[count], bent[count];
    memcpy(kept, input, sizeof kept);
    int status = model->rhs(self, now, state, straight);
    bend(model, self, knot, h, input);
    if (status == GIC_OK)
        status = model->rhs(self, now, state, bent);
    memcpy(input, kept, sizeof kept);
    for (int i = 0; i < count && status == GIC_OK; ++i)
        next[i] = state[i] + h * (i < slow ? of_slow : of_fast) * (bent[i] - straight[i]);
    if (status == GIC_OK)
        status = model->settle(self, next);
    if (status == GIC_OK)
        memcpy(state, next, sizeof next);
    return status;
}

int knot_counts(const gic_head *self, int history)
{
    return !self->parted && (self->method != GIC_AB3 || (history >= 2 && self->history >= 2));
}
