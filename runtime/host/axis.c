/* SPDX-License-Identifier: MIT */
#include "host/axis.h"

#include <math.h>

const char *axis_ink(int curve)
{
    static const char *const ink[AXIS_INKS] = {"#0072b2", "#d55e00", "#0e7f4c", "#835274",
                                               "#703303", "#32a1bd", "#2c342b"};
    return ink[curve % AXIS_INKS];
}

double axis_step(double x)
{
    const double ten = pow(10, floor(log10(x))), over = x / ten, rounding = 1e-9;
    return ten * (over <= 1 + rounding ? 1 : over <= 2 + rounding ? 2 : over <= 5 + rounding ? 5 : 10);
}

int axis_digits(double low, double high)
{
    const double most = fmax(fabs(low), fabs(high)), step = (high - low) / 20;
    const double digits = step > 0 && most > 0 ? floor(log10(most)) - floor(log10(step)) + 1 : 0;
    return (int)fmin(fmax(digits, 6), 15);
}
