/* SPDX-License-Identifier: MIT
 * Skids side by side on each side of a vehicle, in code for one scene (twin.h) and for any (any.h): each meets the road
 * where it is, on one that is the same on both sides and has a step between two of one side. */
#include "any.h"
#include "twin.h"

#include <math.h>
#include <stdio.h>

static void stepped(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x;
    out[0] = fabs(y) > 1 ? 0.03 : 0;
    out[1] = out[2] = 0;
}

int main(void)
{
    static const gic_road road = {stepped, NULL, NULL, NULL, GIC_ROAD_OWN};
    static twin one;
    static any all;
    gic_real rate[TWIN_STATES], right[ANY_STATES];
    int failed = twin_setup(&one) != GIC_OK || any_setup(&all) != GIC_OK;
    one.head.road = all.head.road = &road;
    failed += twin_rhs(&one, 0, one.state, rate) != GIC_OK || any_rhs(&all, 0, all.state, right) != GIC_OK;
    for (int i = 0; i < TWIN_STATES; ++i)
        if (!(fabs(rate[i] - right[i]) <= GIC_R(1e-9) * (1 + fabs(right[i])))) {
            printf("FAILED: rate %d is %g, not %g\n", i, rate[i], right[i]);
            ++failed;
        }
    return failed != 0;
}
