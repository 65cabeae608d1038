/* SPDX-License-Identifier: MIT
 * The functions of gic_lanes.h for functions.c, which knows no vectors. */
#include "lanes_functions.h"

#define GIC_LANES LANES
#include "gic_lanes.h"

#define DEFINE_ONE(name, NAME) \
    void name##_lanes(const gic_real *x, gic_real *y) \
    { \
        gic_lane all; \
        memcpy(&all, x, sizeof all); \
        all = LANE_##NAME(all); \
        memcpy(y, &all, sizeof all); \
    }
#define DEFINE_TWO(name, NAME) \
    void name##_lanes(const gic_real *a, const gic_real *b, gic_real *y) \
    { \
        gic_lane first, second; \
        memcpy(&first, a, sizeof first); \
        memcpy(&second, b, sizeof second); \
        first = LANE_##NAME(first, second); \
        memcpy(y, &first, sizeof first); \
    }
OF_ONE(DEFINE_ONE)
OF_TWO(DEFINE_TWO)
