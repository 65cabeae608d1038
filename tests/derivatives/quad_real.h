/* SPDX-License-Identifier: MIT
 * Generated code and runtime in quad precision: gic_runtime.h must say `typedef __float128 gic_real;`, and look at the
 * bits of a number as of a double. */
#ifndef QUAD_REAL_H
#define QUAD_REAL_H

#include <math.h>
#include <quadmath.h>

#define sqrt sqrtq
#define fabs fabsq
#define sin sinq
#define cos cosq
#define tan tanq
#define asin asinq
#define acos acosq
#define atan atanq
#define atan2 atan2q
#define exp expq
#define log logq
#define tanh tanhq
#define pow powq
#define floor floorq
#define ceil ceilq
#define round roundq

#endif
