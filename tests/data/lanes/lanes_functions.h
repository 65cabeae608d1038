/* SPDX-License-Identifier: MIT
 *
 * The functions of gic_lanes.h on arrays of LANES numbers, which any compiler may make of wrappers.c. */
#ifndef LANES_FUNCTIONS_H
#define LANES_FUNCTIONS_H

#include "gic_runtime.h"

/* X(name, NAME) of one argument, and of two */
#define OF_ONE(X) \
    X(sin, SIN) \
    X(cos, COS) \
    X(tan, TAN) X(asin, ASIN) X(acos, ACOS) X(atan, ATAN) X(exp, EXP) X(log, LOG) X(tanh, TANH) X(sqrt, SQRT)
#define OF_TWO(X) X(atan2, ATAN2) X(pow, POW)

#ifdef __cplusplus
extern "C" {
#endif
#define DECLARE_ONE(name, NAME) void name##_lanes(const gic_real *x, gic_real *y);
#define DECLARE_TWO(name, NAME) void name##_lanes(const gic_real *a, const gic_real *b, gic_real *y);
OF_ONE(DECLARE_ONE)
OF_TWO(DECLARE_TWO)
#ifdef __cplusplus
}
#endif

#endif
