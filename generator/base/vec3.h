/* SPDX-License-Identifier: MIT
 *
 * Vectors double[3], matrices double[9], row-major, and Euler parameters (e0, e1, e2, e3). Results may not alias
 * arguments unless said otherwise. */
#ifndef BASE_VEC3_H
#define BASE_VEC3_H

#include <math.h>

static inline double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double norm3(const double a[3])
{
    return sqrt(dot3(a, a));
}

static inline void cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void copy3(const double a[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[i];
}

/* out may be a or b. */
static inline void add3(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[i] + b[i];
}

static inline void sub3(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[i] - b[i];
}

/* out += s a */
static inline void add_scaled3(double s, const double a[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] += s * a[i];
}

/* A x */
static inline void apply3(const double A[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
}

/* A^T x */
static inline void apply3_transposed(const double A[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = A[i] * x[0] + A[3 + i] * x[1] + A[6 + i] * x[2];
}

/* E(p)^T t of Euler parameters: p' = E^T omega / 2 for omega in the world. */
static inline void euler_rate(const double p[4], const double t[3], double out[4])
{
    double turned[3];
    cross3(p + 1, t, turned);
    out[0] = -dot3(p + 1, t);
    for (int i = 0; i < 3; ++i)
        out[1 + i] = p[0] * t[i] - turned[i];
}

/* E(p) x: omega = 2 E p'. */
static inline void euler_turn(const double p[4], const double x[4], double out[3])
{
    cross3(p + 1, x + 1, out);
    for (int i = 0; i < 3; ++i)
        out[i] += p[0] * x[1 + i] - x[0] * p[1 + i];
}

/* Euler parameters of A(p) A(q). */
static inline void euler_product(const double p[4], const double q[4], double out[4])
{
    cross3(p + 1, q + 1, out + 1);
    out[0] = p[0] * q[0] - dot3(p + 1, q + 1);
    for (int i = 1; i < 4; ++i)
        out[i] += p[0] * q[i] + q[0] * p[i];
}

/* ---- vector.c */

void mat_from_euler(const double p[4], double A[9]);                       /* A(p) of FORMAT.md section 1 */
void euler_relative(const double p0[4], const double p[4], double out[4]); /* Euler parameters of A(p0)^T A(p) */

#endif
