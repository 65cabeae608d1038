/* SPDX-License-Identifier: MIT
 *
 * Quad precision: numbers of 113 bits, long double where that has them (aarch64) and the compiler's __float128
 * elsewhere, whose sums, products and quotients are in every gcc's and clang's own library. Functions are correct to
 * 1e-31 of the larger of 1 and their value, for arguments up to 1000. */
#ifndef BASE_QUAD_H
#define BASE_QUAD_H

#include <float.h>
#include <stdbool.h>

#if LDBL_MANT_DIG >= 113
typedef long double Quad;
#define QUAD_BITS LDBL_MANT_DIG
#elif defined __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
#define QUAD_BITS 113
#else
typedef long double Quad; /* too few: whoever needs them looks at QUAD_BITS */
#define QUAD_BITS LDBL_MANT_DIG
#endif

#define QUAD_EPSILON ((Quad)0x1p-112) /* twice what sums, products and quotients round by at most */

static inline Quad quad_abs(Quad a)
{
    return a < 0 ? -a : a;
}

static inline Quad quad_max(Quad a, Quad b)
{
    return a > b ? a : b;
}

static inline bool quad_is_finite(Quad a)
{
    return a - a == 0;
}

Quad quad_pi(void);
Quad quad_sqrt(Quad a);
void quad_sincos(Quad a, Quad *sine, Quad *cosine);
Quad quad_atan2(Quad y, Quad x);
Quad quad_exp(Quad a);
Quad quad_log(Quad a);

#endif
