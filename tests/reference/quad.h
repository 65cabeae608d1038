/* SPDX-License-Identifier: MIT
 * Quadruple precision: vectors, Euler parameters, dense linear equations. */
#ifndef REFERENCE_QUAD_H
#define REFERENCE_QUAD_H

#include <stdbool.h>

#include <quadmath.h>

/* With -DREFERENCE_LONG in extended precision of 64 bits, which is enough to judge double precision by where nothing is
 * near singular, and twenty times as fast. ROUGHLY: a number that is rounding, with some digits to spare. CLOSE: so
 * small a correction that the next one may be rounding, also where a small ratio of a thread divides it. */
#ifdef REFERENCE_LONG
#include <math.h>
typedef long double quad;
#define ROUGHLY 1e-17
#define CLOSE 1e-14
#define acosq acosl
#define asinq asinl
#define atan2q atan2l
#define atanq atanl
#define copysignq copysignl
#define cosq cosl
#define expq expl
#define fabsq fabsl
#define fmaxq fmaxl
#define fminq fminl
#define hypotq hypotl
#define logq logl
#define powq powl
#define rintq rintl
#define sinq sinl
#define sqrtq sqrtl
#define tanhq tanhl
#define tanq tanl
#else
typedef __float128 quad;
#define ROUGHLY 1e-28
#define CLOSE 1e-16
#endif

quad quad_dot(const quad *a, const quad *b, int size);
void quad_cross(const quad a[3], const quad b[3], quad out[3]); /* out may not alias */
/* product of the rotations p and q (first q, then p), as Euler parameters; out may not alias */
void euler_product(const quad p[4], const quad q[4], quad out[4]);
/* A(p) s, and A(p)^T s; out may not alias */
void rotate(const quad p[4], const quad s[3], quad out[3]);
void rotate_back(const quad p[4], const quad s[3], quad out[3]);
/* B(p, s) = d(A(p) s)/dp, with A as the homogeneous quadratic form (e0^2 - e.e) I + 2 (e e^T + e0 [e]x), which is
 * FORMAT.md's on unit parameters. B is linear in p: d(A s)/dt = B(p, s) p', and B(p, s) p'' + B(p', s) p' a second
 * time. */
void rotation_slope(const quad p[4], const quad s[3], quad B[3][4]);
/* G(p): angular velocity in the body frame = 2 G p'; p' = G^T omega / 2. */
void euler_rate_matrix(const quad p[4], quad G[3][4]);

/* Factors of a square matrix with row exchanges. */
typedef struct Factors {
    int size, sign; /* sign of the determinant */
    quad *a;        /* row-major; the caller fills it, quad_factor replaces it */
    int *row, *used;
    double *coarse; /* of coarse_factor() */
} Factors;

Factors *factors_new(int size);
void factors_free(Factors *factors);
void factors_clear(Factors *factors);
/* Gaussian elimination, pivots of largest magnitude after scaling rows to one; false when a pivot is zero. */
bool quad_factor(Factors *factors);
/* x = A^-1 x */
void quad_solve(const Factors *factors, quad *x);
/* The same in double precision, some thirty times as fast; `a` stays. */
bool coarse_factor(Factors *factors);
void coarse_solve(const Factors *factors, quad *x);

#endif
