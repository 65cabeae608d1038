/* SPDX-License-Identifier: MIT
 *
 * Cubic splines, twice continuously differentiable. */
#ifndef SCENE_SPLINE_H
#define SCENE_SPLINE_H

#include "base/pool.h"

#include <stdbool.h>

/* Second derivatives [count] at rising s of the spline through y: 0 at both ends, or periodic where y ends as it
 * begins. With two points, 0: a straight line. */
const double *spline_bend(Pool *pool, const double *s, const double *y, int count, bool periodic);
/* Its value at s[0] <= at <= s[count - 1]; *place: where it was looked up last, 0 at first. */
double spline_value(const double *s, const double *y, const double *bend, int count, double at, int *place);

#endif
