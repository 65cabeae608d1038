/* SPDX-License-Identifier: MIT
 *
 * Taylor models (Makino and Berz 2003): a function of t in [-1, 1] as a polynomial of t and a bound of what that is off
 * by anywhere in [-1, 1]. What is left out of products, quotients, roots, sines and cosines, and all rounding, is part
 * of the bound: sums, products and quotients of quad precision are within half of QUAD_EPSILON of the exact result,
 * sines and cosines within 1e-30. Where an operation can't be bounded `off` is NaN, and so it is in all that follows.
 */
#ifndef SUBSET_TAYLOR_MODEL_H
#define SUBSET_TAYLOR_MODEL_H

#include "base/quad.h"

enum { TAYLOR_ORDER = 14 };

typedef struct TaylorModel {
    int degree; /* coefficients above it are 0 */
    Quad c[TAYLOR_ORDER + 1];
    Quad off;
} TaylorModel;

TaylorModel taylor_constant(Quad value);
/* middle + half t. */
TaylorModel taylor_line(Quad middle, Quad half);
/* What |a| is at most, infinite if it isn't bounded. */
Quad taylor_most(const TaylorModel *a);
/* The least and the largest value that it can have. */
void taylor_range(const TaylorModel *a, Quad *least, Quad *most);
/* The value of the polynomial at -1 or 1. */
Quad taylor_end(const TaylorModel *a, int end);

void taylor_negative(const TaylorModel *a, TaylorModel *out);
/* a + sign b, sign 1 or -1. */
void taylor_sum(const TaylorModel *a, const TaylorModel *b, int sign, TaylorModel *out);
void taylor_product(const TaylorModel *a, const TaylorModel *b, TaylorModel *out);
void taylor_quotient(const TaylorModel *a, const TaylorModel *b, TaylorModel *out);
void taylor_root(const TaylorModel *a, TaylorModel *out);
void taylor_sine(const TaylorModel *a, bool cosine, TaylorModel *out);
/* `positive` where a > 0, else `other`; a bound of both, without a polynomial, where a may have either sign. */
void taylor_choice(const TaylorModel *a, const TaylorModel *positive, const TaylorModel *other, TaylorModel *out);

#endif
