/* SPDX-License-Identifier: MIT
 * The self-test of `cart` at many states: what all its elements do to the energy is what their powers and the change of
 * their springs' potential say. */
#include <math.h>
#include <stdio.h>

#include "cart.h"

int main(void)
{
    static cart car;
    gic_self_test test;
    double worst = 0;
    for (int row = 0; row < 200; ++row) {
        if (cart_setup(&car) != GIC_OK)
            return 1;
        for (int i = 0; i < CART_STATES; ++i)
            car.state[i] += (i < CART_TWIST ? 0.04 : 1) * sin(1 + 5.0 * i + 0.7 * row);
        /* yaw and roll, so that the ground is seen from all sides */
        car.state[3] = cos(0.3 * row) * cos(0.1 * row);
        car.state[4] = cos(0.3 * row) * sin(0.1 * row);
        car.state[5] = sin(0.3 * row) * sin(0.1 * row);
        car.state[6] = sin(0.3 * row) * cos(0.1 * row);
        const int status = cart_self_test(&car, &test);
        if (status != GIC_OK) {
            printf("state %d: %s\n", row, gic_status_text(status));
            return 1;
        }
        worst = fmax(worst, test.energy);
    }
    printf("%.3g\n", worst);
    /* rounding of a sum of some 30 terms, relative to the sum of their magnitudes */
    return !(worst < 1e-13);
}
