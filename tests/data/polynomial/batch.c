/* SPDX-License-Identifier: MIT
 * Vehicles of models/five_link.veh with polynomials, as model `fitted`, in a batch and one by one, from places inside
 * the range, at its ends and beyond, at rest and moving. Prints how many numbers of their states differ in any bit, how
 * many vehicles went into the range or out of it, and how many there are. */
#include "fitted_batch.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 13, STEPS = 150 };

static fitted one[COUNT], back;
static fitted_batch batch[(COUNT + 3) / 4];

static int is_within(const double *state)
{
    return state[FITTED_STATE_SPRING_R_L] >= 0.32 && state[FITTED_STATE_SPRING_R_L] <= 0.42;
}

int main(void)
{
    static const double place[COUNT] = {0.37, 0.32, 0.42, 0.31,     0.43,     0.325, 0.415,
                                        0.37, 0.33, 0.41, 0.319999, 0.420001, 0.35};
    int different = 0, crossed = 0;
    for (int v = 0; v < COUNT; ++v) {
        if (v % 4 == 0 && fitted_batch_setup(&batch[v / 4]))
            return 1;
        if (fitted_setup(&one[v]))
            return 1;
        one[v].state[FITTED_STATE_SPRING_R_L] = place[v];
        one[v].state[FITTED_STATE_SPRING_R_R] = v % 3 ? 0.37 : 0.74 - place[v];
        one[v].state[FITTED_STATE_SPRING_R_L_RATE] = 0.4 * (v % 5 - 2);
        one[v].state[FITTED_STATE_OMEGA_X] = 0.1 * (v % 2);
        fitted_batch_load(&batch[v / 4], v % 4, &one[v]);
    }
    for (int n = 0; n < STEPS; ++n) {
        const gic_method method = n < STEPS / 2 ? GIC_AB3 : GIC_RK4;
        for (int b = 0; b < (COUNT + 3) / 4; ++b)
            fitted_batch_step(&batch[b], 1e-3, method, 1);
        for (int v = 0; v < COUNT; ++v) {
            const int before = is_within(one[v].state);
            if (fitted_step(&one[v], 1e-3, method)) {
                printf("vehicle %d, step %d: status %d\n", v, n, one[v].head.status);
                return 1;
            }
            crossed += before != is_within(one[v].state);
            fitted_batch_store(&batch[v / 4], v % 4, &back);
            for (int i = 0; i < FITTED_STATES; ++i)
                different += memcmp(&back.state[i], &one[v].state[i], sizeof back.state[i]) != 0;
        }
    }
    printf("%d %d %d\n", different, crossed, COUNT);
    return 0;
}
