/* SPDX-License-Identifier: MIT
 * Ports and tunable parameters against the same numbers written into the model: `tuned` is `cart` with them. */
#include <math.h>
#include <stdio.h>

#include "cart.h"
#include "tuned.h"

int main(void)
{
    static cart a;
    static tuned b;
    static const double hook[6] = {11, -7, 30, 2, 0.5, -3};
    double first[CART_STATES], second[CART_STATES], largest = 0;
    if (cart_setup(&a) != GIC_OK || tuned_setup(&b) != GIC_OK)
        return 1;
    a.parameter[CART_PARAMETER_K] = 5000;
    a.parameter[CART_PARAMETER_LIFT] = -8;
    for (int i = 0; i < 6; ++i)
        a.port[CART_PORT_HOOK + i] = hook[i];
    for (int i = 0; i < CART_STATES; ++i)
        a.state[i] += i < 3 || i > 6 ? 0.01 * sin(3.0 * i) : 0;
    if (cart_rhs(&a, 0, a.state, first) != GIC_OK || tuned_rhs(&b, 0, a.state, second) != GIC_OK)
        return 1;
    for (int i = 0; i < CART_STATES; ++i)
        largest = fmax(largest, fabs(first[i] - second[i]) / (1 + fabs(second[i])));
    printf("%.3g\n", largest);
    /* 1e-12: two orders of the same sums; and the port must have been felt */
    a.port[CART_PORT_HOOK] = 1000;
    if (cart_rhs(&a, 0, a.state, first) != GIC_OK ||
        fabs(first[CART_STATE_STRUT_R_RATE] - second[CART_STATE_STRUT_R_RATE]) < 0.1)
        return 1;
    a.parameter[CART_PARAMETER_K] = NAN;
    return !(largest < 1e-12) || cart_rhs(&a, 0, a.state, first) != GIC_ERROR_INPUT;
}
