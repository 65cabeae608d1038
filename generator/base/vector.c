/* SPDX-License-Identifier: MIT
 * Rotation matrices and Euler parameters. */
#include "base/vec3.h"

void mat_from_euler(const double p[4], double A[9])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            A[3 * i + j] = 2 * p[1 + i] * p[1 + j] + (i == j ? 2 * p[0] * p[0] - 1 : 0);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        A[3 * j + k] -= 2 * p[0] * p[1 + i];
        A[3 * k + j] += 2 * p[0] * p[1 + i];
    }
}

void euler_relative(const double p0[4], const double p[4], double out[4])
{
    double cross[3];
    cross3(p0 + 1, p + 1, cross);
    out[0] = p0[0] * p[0] + dot3(p0 + 1, p + 1);
    for (int i = 0; i < 3; ++i)
        out[1 + i] = p0[0] * p[1 + i] - p[0] * p0[1 + i] - cross[i];
}
