/* SPDX-License-Identifier: MIT
 *
 * gic_lanes: as many numbers side by side as GIC_LANES says, and elementary functions of them. C99 with the vector
 * extensions of gcc and clang; freestanding but for <math.h>, and for any processor: where its vectors are shorter the
 * compiler takes several.
 *
 *     #define GIC_LANES 4
 *     #include "gic_lanes.h"
 *
 * declares gic_lane, gic_mask (all bits of a lane set where something holds) and LANE_SIN and its like. With another
 * GIC_LANES, a power of 2, it may be included again, and with the same one too; the names then mean whatever GIC_LANES
 * is where they stand.
 *
 * Errors in units of the last place (of the result, rounded; tests/data/lanes measures them), of gic_real double and
 * float:
 *
 *     LANE_SIN, LANE_COS    3 and 3 within |x| <= 2^20 and |x| <= 4096
 *     LANE_TAN              4 and 4 the same
 *     LANE_ASIN, LANE_ACOS  4 and 4 everywhere
 *     LANE_ATAN             3 and 3 everywhere
 *     LANE_EXP              2 and 2 within |x| <= 708 and |x| <= 87
 *     LANE_LOG              4 and 4 of normal numbers > 0
 *     LANE_TANH             4 and 4 everywhere
 *     LANE_SQRT             0.5 and 0.5 everywhere
 *     LANE_ATAN2            4 and 4 within 2^-900 to 2^900 and 2^-90 to 2^90 of the larger argument
 *
 * Tires by short polynomials (models/TIRES.md section 11) have functions of their own, of which only a few digits are
 * right, with either number type. Absolute errors, for any x where no range is stated:
 *
 *     LANE_SHORT_ATAN           1.2e-9
 *     LANE_SHORT_SIN, _COS      3e-11 within |x| <= 2^20
 *     LANE_SHORT_TAN            3e-10 max(1, tan^2 x) within |x| <= 2^20
 *     LANE_SHORT_SINE(c, x)     2.4e-9, of sin(c atan x), |c| <= 2
 *     LANE_SHORT_COSINE(c, x)   2.4e-9, of cos(c atan x), |c| <= 2
 *
 * In lanes outside, and for LANE_POW, libm's functions are called one by one. Infinities, zeros and their signs, and
 * NaN are as in C99; no lane raises a floating-point exception that its own argument does not ask for, but inexact and
 * underflow. A lane's result depends on its own argument alone. */
#if !defined(__GNUC__) || defined(__TINYC__)
#error "lanes need the vector extensions of gcc or clang; without --lanes, gicgen writes C99 for every compiler"
#endif
#ifndef GIC_LANES
#error "how many lanes? define GIC_LANES before gic_lanes.h"
#endif

#ifndef GIC_LANES_H
#define GIC_LANES_H

#include "gic_runtime.h"

#include <math.h>
#include <string.h>

/* Vectors are passed between functions in memory, except to inline ones. */
#pragma GCC diagnostic ignored "-Wpsabi"
/* The functions rely on the order of sums, so -ffast-math is switched off for them; a root of a negative number need
 * not set errno. */
#ifdef __clang__
#pragma clang fp reassociate(off)
#else
#pragma GCC optimize("no-associative-math,no-math-errno")
#endif

#define GIC_LANES_PASTE(name, lanes) name##lanes
#define GIC_LANES_NAME(name, lanes) GIC_LANES_PASTE(name, lanes)
#define gic_lane GIC_LANES_NAME(gic_lane, GIC_LANES)
#define gic_mask GIC_LANES_NAME(gic_mask, GIC_LANES)
#define gic_bits GIC_LANES_NAME(gic_bits, GIC_LANES)
#define LANE_FUNCTION static inline __attribute__((always_inline, unused))
#define FOR_LANES(l) for (l = 0; l < GIC_LANES; ++l)

/* The bits of a number: masks of its magnitude and exponent; shifts of its exponent and sign. */
#ifdef GIC_FLOAT
#define GIC_MATH(name) name##f
#define GIC_MAGNITUDE INT32_C(0x7fffffff)
#define GIC_EXPONENT INT32_C(0x7f800000)
#define GIC_EXPONENT_PLACE 23
#define GIC_SIGN_PLACE 31
#else
#define GIC_MATH(name) name
#define GIC_MAGNITUDE INT64_C(0x7fffffffffffffff)
#define GIC_EXPONENT INT64_C(0x7ff0000000000000)
#define GIC_EXPONENT_PLACE 52
#define GIC_SIGN_PLACE 63
#endif

#define LANE(x) GIC_LANES_NAME(lane_of_, GIC_LANES)(x)
#define LANE_ANY(m) GIC_LANES_NAME(lane_any_, GIC_LANES)(m)
#define LANE_SELECT(m, yes, no) GIC_LANES_NAME(lane_select_, GIC_LANES)(m, yes, no)
/* x in some lanes, 0 in the others */
#define LANE_WHERE(m, x) ((gic_lane)((m) & (gic_mask)(x)))
#define LANE_FABS(x) ((gic_lane)(GIC_MAGNITUDE & (gic_mask)(x)))
#define LANE_SIGN(x) ((gic_mask)(x) & ~GIC_MAGNITUDE)
/* Mask of the lanes in which x is finite, from its bits. */
#define LANE_FINITE(x) ((gic_mask)((GIC_EXPONENT & (gic_mask)(x)) != GIC_EXPONENT))
#define LANE_POSITIVE(x, yes, no) LANE_SELECT((gic_mask)((x) > GIC_R(0.0)), yes, no)
#define LANE_MIN(x, y) GIC_LANES_NAME(lane_min_, GIC_LANES)(x, y)
#define LANE_MAX(x, y) GIC_LANES_NAME(lane_max_, GIC_LANES)(x, y)
#define LANE_SQRT(x) GIC_LANES_NAME(lane_sqrt_, GIC_LANES)(x)
#define LANE_SIN(x) GIC_LANES_NAME(lane_sin_, GIC_LANES)(x)
#define LANE_COS(x) GIC_LANES_NAME(lane_cos_, GIC_LANES)(x)
#define LANE_TAN(x) GIC_LANES_NAME(lane_tan_, GIC_LANES)(x)
#define LANE_ASIN(x) GIC_LANES_NAME(lane_asin_, GIC_LANES)(x)
#define LANE_ACOS(x) GIC_LANES_NAME(lane_acos_, GIC_LANES)(x)
#define LANE_ATAN(x) GIC_LANES_NAME(lane_atan_, GIC_LANES)(x)
#define LANE_ATAN2(y, x) GIC_LANES_NAME(lane_atan2_, GIC_LANES)(y, x)
#define LANE_EXP(x) GIC_LANES_NAME(lane_exp_, GIC_LANES)(x)
#define LANE_LOG(x) GIC_LANES_NAME(lane_log_, GIC_LANES)(x)
#define LANE_TANH(x) GIC_LANES_NAME(lane_tanh_, GIC_LANES)(x)
#define LANE_POW(x, y) GIC_LANES_NAME(lane_pow_, GIC_LANES)(x, y)
#define LANE_SHORT_ATAN(x) GIC_LANES_NAME(lane_short_atan_, GIC_LANES)(x)
#define LANE_SHORT_SIN(x) GIC_LANES_NAME(lane_short_sin_, GIC_LANES)(x)
#define LANE_SHORT_COS(x) GIC_LANES_NAME(lane_short_cos_, GIC_LANES)(x)
#define LANE_SHORT_TAN(x) GIC_LANES_NAME(lane_short_tan_, GIC_LANES)(x)
#define LANE_SHORT_SINE(c, x) GIC_LANES_NAME(lane_short_sine_, GIC_LANES)(c, x)
#define LANE_SHORT_COSINE(c, x) GIC_LANES_NAME(lane_short_cosine_, GIC_LANES)(c, x)

/* Helpers of the functions below. */
#define LANE_MEND(outside, f, x, y) GIC_LANES_NAME(lane_mend_, GIC_LANES)(outside, f, x, y)
#define LANE_MEND_TWO(outside, f, a, b, y) GIC_LANES_NAME(lane_mend_two_, GIC_LANES)(outside, f, a, b, y)
#define LANE_REDUCE(x, turns) GIC_LANES_NAME(lane_reduce_, GIC_LANES)(x, turns)
#define LANE_HALF_WAVE(r) GIC_LANES_NAME(lane_half_wave_, GIC_LANES)(r)
#define LANE_ARC(y, x) GIC_LANES_NAME(lane_arc_, GIC_LANES)(y, x)
#define LANE_SMALL_ARC(t, eighths) GIC_LANES_NAME(lane_small_arc_, GIC_LANES)(t, eighths)
#define LANE_SMALL_ASIN(x, z) GIC_LANES_NAME(lane_small_asin_, GIC_LANES)(x, z)
#define LANE_SHORT_ARC(a) GIC_LANES_NAME(lane_short_arc_, GIC_LANES)(a)
#define LANE_SHORT_WAVE(r) GIC_LANES_NAME(lane_short_wave_, GIC_LANES)(r)
#define LANE_SHORT_REDUCE(x, turns) GIC_LANES_NAME(lane_short_reduce_, GIC_LANES)(x, turns)
#define LANE_GROWTH(x, scale) GIC_LANES_NAME(lane_growth_, GIC_LANES)(x, scale)

/* What compilers make of the loops over signs and roots only if they are told to: of the 32 bytes of AVX, and of the 64
 * of AVX-512. */
#ifdef GIC_FLOAT
#define GIC_REAL_BYTES 4
#define GIC_SIGNS_32(x) __builtin_ia32_movmskps256(x)
#define GIC_ROOTS_32(x) __builtin_ia32_sqrtps256(x)
#define GIC_LEAST_32(x, y) __builtin_ia32_minps256(x, y)
#define GIC_MOST_32(x, y) __builtin_ia32_maxps256(x, y)
#define GIC_SIGNS_64(x) __builtin_ia32_cvtd2mask512(x)
#ifdef __clang__
#define GIC_ROOTS_64(x) __builtin_ia32_sqrtps512(x, 4)
#define GIC_LEAST_64(x, y) __builtin_ia32_minps512(x, y, 4)
#define GIC_MOST_64(x, y) __builtin_ia32_maxps512(x, y, 4)
#else
#define GIC_ROOTS_64(x) __builtin_ia32_sqrtps512_mask(x, x, -1, 4)
#define GIC_LEAST_64(x, y) __builtin_ia32_minps512_mask(x, y, x, -1, 4)
#define GIC_MOST_64(x, y) __builtin_ia32_maxps512_mask(x, y, x, -1, 4)
#endif
#else
#define GIC_REAL_BYTES 8
#define GIC_SIGNS_32(x) __builtin_ia32_movmskpd256(x)
#define GIC_ROOTS_32(x) __builtin_ia32_sqrtpd256(x)
#define GIC_LEAST_32(x, y) __builtin_ia32_minpd256(x, y)
#define GIC_MOST_32(x, y) __builtin_ia32_maxpd256(x, y)
#define GIC_SIGNS_64(x) __builtin_ia32_cvtq2mask512(x)
#ifdef __clang__
#define GIC_ROOTS_64(x) __builtin_ia32_sqrtpd512(x, 4)
#define GIC_LEAST_64(x, y) __builtin_ia32_minpd512(x, y, 4)
#define GIC_MOST_64(x, y) __builtin_ia32_maxpd512(x, y, 4)
#else
#define GIC_ROOTS_64(x) __builtin_ia32_sqrtpd512_mask(x, x, -1, 4)
#define GIC_LEAST_64(x, y) __builtin_ia32_minpd512_mask(x, y, x, 255, 4)
#define GIC_MOST_64(x, y) __builtin_ia32_maxpd512_mask(x, y, x, 255, 4)
#endif
#endif
#ifdef GIC_FLOAT
typedef int32_t gic_whole_of_lane;
#else
typedef long long gic_whole_of_lane;
#endif

/* Adding it to a number that is not large leaves the nearest whole number in the last bits. */
#ifdef GIC_FLOAT
#define GIC_ROUNDER GIC_R(12582912.0)
#define GIC_TURNING GIC_R(4096.0)
#define GIC_EXP_MOST GIC_R(87.0)
#else
#define GIC_ROUNDER GIC_R(6755399441055744.0)
#define GIC_TURNING GIC_R(1048576.0)
#define GIC_EXP_MOST GIC_R(708.0)
#endif
#define GIC_HALF_PI GIC_R(1.5707963267948966)
#define GIC_TAN_PI_8 GIC_R(0.41421356237309503)

#endif

/* Each number of lanes is declared once, since several models may be in one translation unit. */
#if GIC_LANES == 2 && !defined(GIC_LANES_2)
#define GIC_LANES_2
#define GIC_LANES_NEW
#elif GIC_LANES == 4 && !defined(GIC_LANES_4)
#define GIC_LANES_4
#define GIC_LANES_NEW
#elif GIC_LANES == 8 && !defined(GIC_LANES_8)
#define GIC_LANES_8
#define GIC_LANES_NEW
#elif GIC_LANES == 16 && !defined(GIC_LANES_16)
#define GIC_LANES_16
#define GIC_LANES_NEW
#elif GIC_LANES > 16 || GIC_LANES == 1
#define GIC_LANES_NEW
#endif
#ifdef GIC_LANES_NEW

typedef gic_real gic_lane __attribute__((vector_size(GIC_LANES * sizeof(gic_real))));
#ifdef GIC_FLOAT
typedef int32_t gic_mask __attribute__((vector_size(GIC_LANES * sizeof(gic_real))));
typedef uint32_t gic_bits __attribute__((vector_size(GIC_LANES * sizeof(gic_real))));
#else
typedef int64_t gic_mask __attribute__((vector_size(GIC_LANES * sizeof(gic_real))));
typedef uint64_t gic_bits __attribute__((vector_size(GIC_LANES * sizeof(gic_real))));
#endif

/* ---- arithmetic ------------------------------------------------------------------------------------------------- */

/* The same number in all lanes. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_of_, GIC_LANES)(gic_real x)
{
    const gic_lane zero = {GIC_R(0.0)};
    return x - zero;
}

LANE_FUNCTION int GIC_LANES_NAME(lane_any_, GIC_LANES)(gic_mask m)
{
    int l = 0, any = 0;
#ifdef __AVX512DQ__
    for (; (l + 64 / GIC_REAL_BYTES) <= GIC_LANES; l += 64 / GIC_REAL_BYTES) {
        gic_whole_of_lane part __attribute__((vector_size(64)));
        memcpy(&part, (const char *)&m + l * GIC_REAL_BYTES, sizeof part);
        any |= GIC_SIGNS_64(part) != 0;
    }
#endif
#ifdef __AVX__
    for (; l + 32 / GIC_REAL_BYTES <= GIC_LANES; l += 32 / GIC_REAL_BYTES) {
        gic_real part __attribute__((vector_size(32)));
        memcpy(&part, (const char *)&m + l * GIC_REAL_BYTES, sizeof part);
        any |= GIC_SIGNS_32(part) != 0;
    }
#endif
    for (; l < GIC_LANES; ++l)
        any |= m[l] != 0;
    return any;
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_select_, GIC_LANES)(gic_mask m, gic_lane yes, gic_lane no)
{
    return (gic_lane)((m & (gic_mask)yes) | (~m & (gic_mask)no));
}

/* x = the smaller or larger one of x and y by the processor's instruction, `bytes` at a time from lane l on, where
 * compilers would take four for a comparison and a selection: x where x < y (x > y), else y, which is what it does with
 * NaN and zeros of both signs, too. */
#define GIC_CHOOSE(bytes, instruction, x, y, l) \
    for (; l + bytes / GIC_REAL_BYTES <= GIC_LANES; l += bytes / GIC_REAL_BYTES) { \
        gic_real a __attribute__((vector_size(bytes))), b __attribute__((vector_size(bytes))); \
        memcpy(&a, (const char *)&x + l * GIC_REAL_BYTES, sizeof a); \
        memcpy(&b, (const char *)&y + l * GIC_REAL_BYTES, sizeof b); \
        a = instruction(a, b); \
        memcpy((char *)&x + l * GIC_REAL_BYTES, &a, sizeof a); \
    }

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_min_, GIC_LANES)(gic_lane x, gic_lane y)
{
    int l = 0;
#ifdef __AVX512F__
    GIC_CHOOSE(64, GIC_LEAST_64, x, y, l)
#endif
#ifdef __AVX__
    GIC_CHOOSE(32, GIC_LEAST_32, x, y, l)
#endif
    return l < GIC_LANES ? LANE_SELECT((gic_mask)(x < y), x, y) : x;
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_max_, GIC_LANES)(gic_lane x, gic_lane y)
{
    int l = 0;
#ifdef __AVX512F__
    GIC_CHOOSE(64, GIC_MOST_64, x, y, l)
#endif
#ifdef __AVX__
    GIC_CHOOSE(32, GIC_MOST_32, x, y, l)
#endif
    return l < GIC_LANES ? LANE_SELECT((gic_mask)(x > y), x, y) : x;
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_sqrt_, GIC_LANES)(gic_lane x)
{
    int l = 0;
#ifdef __AVX512F__
    for (; l + 64 / GIC_REAL_BYTES <= GIC_LANES; l += 64 / GIC_REAL_BYTES) {
        gic_real part __attribute__((vector_size(64)));
        memcpy(&part, (const char *)&x + l * GIC_REAL_BYTES, sizeof part);
        part = GIC_ROOTS_64(part);
        memcpy((char *)&x + l * GIC_REAL_BYTES, &part, sizeof part);
    }
#endif
#ifdef __AVX__
    for (; l + 32 / GIC_REAL_BYTES <= GIC_LANES; l += 32 / GIC_REAL_BYTES) {
        gic_real part __attribute__((vector_size(32)));
        memcpy(&part, (const char *)&x + l * GIC_REAL_BYTES, sizeof part);
        part = GIC_ROOTS_32(part);
        memcpy((char *)&x + l * GIC_REAL_BYTES, &part, sizeof part);
    }
#endif
    for (; l < GIC_LANES; ++l)
        x[l] = GIC_MATH(sqrt)(x[l]);
    return x;
}

/* y, but f(x) for single lanes; rare, so kept out of the way of the common case. */
static __attribute__((noinline, cold, unused)) void
GIC_LANES_NAME(lane_call_, GIC_LANES)(const gic_mask *where, gic_real (*f)(gic_real), const gic_lane *x, gic_lane *y)
{
    int l;
    FOR_LANES(l)
    if ((*where)[l])
        (*y)[l] = f((*x)[l]);
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_mend_, GIC_LANES)(gic_mask outside, gic_real (*f)(gic_real), gic_lane x,
                                                             gic_lane y)
{
    if (LANE_ANY(outside)) {
        const gic_mask where = outside;
        const gic_lane given = x;
        gic_lane mended = y;
        GIC_LANES_NAME(lane_call_, GIC_LANES)(&where, f, &given, &mended);
        return mended;
    }
    return y;
}

/* y, but f(a, b) for single lanes. */
static __attribute__((noinline, cold, unused)) void
GIC_LANES_NAME(lane_call_two_, GIC_LANES)(const gic_mask *where, gic_real (*f)(gic_real, gic_real), const gic_lane *a,
                                          const gic_lane *b, gic_lane *y)
{
    int l;
    FOR_LANES(l)
    if ((*where)[l])
        (*y)[l] = f((*a)[l], (*b)[l]);
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_mend_two_, GIC_LANES)(gic_mask outside, gic_real (*f)(gic_real, gic_real),
                                                                 gic_lane a, gic_lane b, gic_lane y)
{
    if (LANE_ANY(outside)) {
        const gic_mask where = outside;
        const gic_lane first = a, second = b;
        gic_lane mended = y;
        GIC_LANES_NAME(lane_call_two_, GIC_LANES)(&where, f, &first, &second, &mended);
        return mended;
    }
    return y;
}

/* ---- sin, cos, tan ---------------------------------------------------------------------------------------------- */

/* Polynomials, here and below, are those of least largest error relative to the function. */

/* x - turns pi/2, to the last place even near 0: the first three of four parts of pi/2 are so short that their products
 * with whole numbers within GIC_TURNING are exact. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_reduce_, GIC_LANES)(gic_lane x, gic_lane turns)
{
#ifdef GIC_FLOAT
    const gic_real part[4] = {GIC_R(1.5703125), GIC_R(0.000483751297), GIC_R(7.54953362e-08), GIC_R(2.56334407e-12)};
#else
    const gic_real part[4] = {GIC_R(1.5707963267341256), GIC_R(6.077100506303966e-11), GIC_R(2.0222662487111665e-21),
                              GIC_R(8.4784276603688996e-32)};
#endif
    const gic_lane most = x - turns * part[0], second = turns * part[1], third = turns * part[2];
    const gic_lane less = most - second, least = less - third;
    const gic_lane lost = (second - (most - less)) + (third - (less - least));
    return least - (lost + turns * part[3]);
}

/* sin of |r| <= pi/2 */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_half_wave_, GIC_LANES)(gic_lane r)
{
    const gic_lane z = r * r;
#ifdef GIC_FLOAT
    const gic_lane share = GIC_R(-0.1666666663) +
                           z * (GIC_R(8.333331107e-3) + z * (GIC_R(-1.984086798e-4) +
                                                             z * (GIC_R(2.752537198e-6) + z * GIC_R(-2.388868149e-8))));
#else
    const gic_lane z2 = z * z, z4 = z2 * z2;
    const gic_lane low = (GIC_R(-0.16666666666666666) + z * GIC_R(8.333333333333194e-3)) +
                         z2 * (GIC_R(-1.984126984120914e-4) + z * GIC_R(2.7557319211123613e-6));
    const gic_lane high = (GIC_R(-2.5052106871530787e-8) + z * GIC_R(1.6058939640885172e-10)) +
                          z2 * (GIC_R(-7.642989768030986e-13) + z * GIC_R(2.7211565258672974e-15));
    const gic_lane share = low + z4 * high;
#endif
    return r + r * (z * share);
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_sin_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane a = LANE_WHERE(inside, LANE_FABS(x)), t = a * GIC_R(0.3183098861837907) + GIC_ROUNDER;
    const gic_lane n = t - GIC_ROUNDER, y = LANE_HALF_WAVE(LANE_REDUCE(a, n + n));
    const gic_mask turned = (gic_mask)((gic_bits)t << GIC_SIGN_PLACE);
    return LANE_MEND(~inside, GIC_MATH(sin), x, (gic_lane)((gic_mask)y ^ turned ^ LANE_SIGN(x)));
}

/* cos x = sin(x + pi/2): x is an odd number of quarter turns plus r. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_cos_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane a = LANE_WHERE(inside, LANE_FABS(x));
    const gic_lane t = (a * GIC_R(0.3183098861837907) - GIC_R(0.5)) + GIC_ROUNDER;
    const gic_lane n = t - GIC_ROUNDER, y = LANE_HALF_WAVE(LANE_REDUCE(a, n + n + GIC_R(1.0)));
    const gic_mask turned = (gic_mask)(~(gic_bits)t << GIC_SIGN_PLACE);
    return LANE_MEND(~inside, GIC_MATH(cos), x, (gic_lane)((gic_mask)y ^ turned));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_tan_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane a = LANE_WHERE(inside, LANE_FABS(x)), t = a * GIC_R(0.6366197723675814) + GIC_ROUNDER;
    const gic_lane r = LANE_REDUCE(a, t - GIC_ROUNDER), z = r * r;
#ifdef GIC_FLOAT
    const gic_lane share = GIC_R(-0.1666665454) + z * (GIC_R(8.332156079e-3) + z * GIC_R(-1.951463351e-4));
    const gic_lane more = GIC_R(0.04166664555) + z * (GIC_R(-1.388730988e-3) + z * GIC_R(2.443241511e-5));
#else
    const gic_lane z2 = z * z, z4 = z2 * z2;
    const gic_lane share = ((GIC_R(-0.1666666666666663) + z * GIC_R(8.333333333322005e-3)) +
                            z2 * (GIC_R(-1.984126982949558e-4) + z * GIC_R(2.755731358763148e-6))) +
                           z4 * (GIC_R(-2.505074230783073e-8) + z * GIC_R(1.589590465406632e-10));
    const gic_lane more = ((GIC_R(0.041666666666666595) + z * GIC_R(-1.3888888888872895e-3)) +
                           z2 * (GIC_R(2.4801587288748844e-5) + z * GIC_R(-2.755731414879098e-7))) +
                          z4 * (GIC_R(2.0875696592426733e-9) + z * GIC_R(-1.1358311375200887e-11));
#endif
    const gic_lane sine = r + r * (z * share), cosine = GIC_R(1.0) - (z * GIC_R(0.5) - z * z * more);
    /* an odd number of quarters: -1 / tan r */
    const gic_mask odd = -(gic_mask)((gic_bits)t & 1);
    const gic_lane y = LANE_SELECT(odd, -cosine, sine) / LANE_SELECT(odd, sine, cosine);
    return LANE_MEND(~inside, GIC_MATH(tan), x, (gic_lane)((gic_mask)y ^ LANE_SIGN(x)));
}

/* ---- their inverses --------------------------------------------------------------------------------------------- */

/* eighths pi/4 + atan t of |t| <= tan(pi/8) */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_small_arc_, GIC_LANES)(gic_lane t, gic_lane eighths)
{
    const gic_lane z = t * t;
#ifdef GIC_FLOAT
    const gic_real eighth = GIC_R(0.785398185), rest = GIC_R(-2.18556941e-8);
    const gic_lane share =
        GIC_R(-0.3333331518) +
        z * (GIC_R(0.1999847082) + z * (GIC_R(-0.1424352017) + z * (GIC_R(0.1059371511) + z * GIC_R(-0.06077966351))));
#else
    const gic_real eighth = GIC_R(0.7853981633974483), rest = GIC_R(3.061616997868383e-17);
    const gic_lane z2 = z * z, z4 = z2 * z2;
    const gic_lane low = (GIC_R(-0.333333333333332) + z * GIC_R(0.19999999999953202)) +
                         z2 * (GIC_R(-0.14285714280161824) + z * GIC_R(0.11111110781911625));
    const gic_lane middle = (GIC_R(-0.09090897718056758) + z * GIC_R(0.07692059586035722)) +
                            z2 * (GIC_R(-0.06663097673438213) + z * GIC_R(0.058478478867107574));
    const gic_lane high =
        (GIC_R(-0.05039138054047605) + z * GIC_R(0.03806078373909883)) + z2 * GIC_R(-0.01790352784851203);
    const gic_lane share = low + z4 * (middle + z4 * high);
#endif
    return eighths * eighth + (t + (t * (z * share) + eighths * rest));
}

/* atan(y / x) of x, y >= 0, not both 0 or infinite: of (y - x) / (y + x) and pi/4, or of -x / y and pi/2, where that is
 * nearer to 0. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_arc_, GIC_LANES)(gic_lane y, gic_lane x)
{
    const gic_mask above = (gic_mask)(y > GIC_TAN_PI_8 * x), far = (gic_mask)(x < GIC_TAN_PI_8 * y);
    const gic_lane over = LANE_SELECT(far, -x, LANE_SELECT(above, y - x, y));
    const gic_lane under = LANE_SELECT(far, y, LANE_SELECT(above, y + x, x));
    const gic_lane eighths = LANE_WHERE(above, LANE(GIC_R(1.0))) + LANE_WHERE(far, LANE(GIC_R(1.0)));
    return LANE_SMALL_ARC(over / under, eighths);
}

/* Where no lane asks for it, the quotient is left out: by 1 it changes nothing. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_atan_, GIC_LANES)(gic_lane x)
{
    const gic_lane a = LANE_FABS(x), zero = {GIC_R(0.0)};
    gic_lane arc;
    if (LANE_ANY((gic_mask)(a > GIC_TAN_PI_8)))
        arc = LANE_ARC(a, LANE(GIC_R(1.0)));
    else
        arc = LANE_SMALL_ARC(a, zero);
    return (gic_lane)((gic_mask)arc ^ LANE_SIGN(x));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_atan2_, GIC_LANES)(gic_lane y, gic_lane x)
{
#ifdef GIC_FLOAT
    const gic_real least = GIC_R(8.077935669463161e-28), most = GIC_R(1.2379400392853803e27);
    const gic_real pi = GIC_R(3.14159274), rest = GIC_R(-8.74227766e-8);
#else
    const gic_real least = GIC_R(1.1830521861667747e-271), most = GIC_R(8.45271249817064e270);
    const gic_real pi = GIC_R(3.141592653589793), rest = GIC_R(1.2246467991473532e-16);
#endif
    const gic_lane larger = LANE_MAX(LANE_FABS(x), LANE_FABS(y));
    /* comparisons with NaN are false: a NaN of x is in `larger`, one of y is caught there */
    const gic_mask inside = (gic_mask)(larger >= least) & (gic_mask)(larger <= most) & LANE_FINITE(y) & LANE_FINITE(x);
    const gic_lane arc =
        LANE_ARC(LANE_WHERE(inside, LANE_FABS(y)), LANE_SELECT(inside, LANE_FABS(x), LANE(GIC_R(1.0))));
    const gic_mask back = (gic_mask)(x < GIC_R(0.0));
    const gic_lane whole = LANE_SELECT(back, pi - (arc - rest), arc);
    return LANE_MEND_TWO(~inside, GIC_MATH(atan2), y, x, (gic_lane)((gic_mask)whole ^ LANE_SIGN(y)));
}

/* asin x of |x| <= 1/2, z = x^2 */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_small_asin_, GIC_LANES)(gic_lane x, gic_lane z)
{
#ifdef GIC_FLOAT
    const gic_lane share =
        GIC_R(0.1666675248) +
        z * (GIC_R(0.07495297654) + z * (GIC_R(0.04547037737) + z * (GIC_R(0.02417950127) + z * GIC_R(0.04216633892))));
#else
    const gic_lane z2 = z * z, z4 = z2 * z2;
    const gic_lane low = (GIC_R(0.1666666666666676) + z * GIC_R(0.07499999999970801)) +
                         z2 * (GIC_R(0.04464285717461033) + z * GIC_R(0.030381942707864852));
    const gic_lane middle = (GIC_R(0.022372214985214536) + z * GIC_R(0.017351612059318868)) +
                            z2 * (GIC_R(0.013980819982439061) + z * GIC_R(0.011398916930426663));
    const gic_lane high = (GIC_R(0.010780226262882888) + z * GIC_R(0.003706508763813122)) +
                          z2 * (GIC_R(0.021707204842444545) + z * GIC_R(-0.020998721527936953)) +
                          z4 * GIC_R(0.032628411631113886);
    const gic_lane share = low + z4 * (middle + z4 * high);
#endif
    return x + x * (z * share);
}

/* Beyond 1/2 by the half-angle formula; where no lane is, its root is left out. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_asin_, GIC_LANES)(gic_lane x)
{
    const gic_lane a = LANE_FABS(x);
    const gic_mask beyond = (gic_mask)(a > GIC_R(0.5));
    gic_lane z = a * a, root = a;
    if (LANE_ANY(beyond)) {
        z = LANE_SELECT(beyond, (GIC_R(1.0) - a) * GIC_R(0.5), z);
        root = LANE_SELECT(beyond, LANE_SQRT(z), a);
    }
    const gic_lane p = LANE_SMALL_ASIN(root, z);
    const gic_lane y = LANE_SELECT(beyond, GIC_HALF_PI - (p + p), p);
    return (gic_lane)((gic_mask)y ^ LANE_SIGN(x));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_acos_, GIC_LANES)(gic_lane x)
{
#ifdef GIC_FLOAT
    const gic_real rest = GIC_R(-4.37113883e-8);
#else
    const gic_real rest = GIC_R(6.123233995736766e-17);
#endif
    const gic_lane a = LANE_FABS(x);
    const gic_mask beyond = (gic_mask)(a > GIC_R(0.5)), back = (gic_mask)(x < GIC_R(0.0));
    const gic_lane z = LANE_SELECT(beyond, (GIC_R(1.0) - a) * GIC_R(0.5), a * a);
    const gic_lane p = LANE_SMALL_ASIN(LANE_SELECT(beyond, LANE_SQRT(z), a), z);
    const gic_lane twice = p + p, straight = GIC_HALF_PI + GIC_HALF_PI - (twice - (rest + rest));
    return LANE_SELECT(beyond, LANE_SELECT(back, straight, twice),
                       GIC_HALF_PI - ((gic_lane)((gic_mask)p ^ LANE_SIGN(x)) - rest));
}

/* ---- few digits ------------------------------------------------------------------------------------------------- */

/* Polynomials of least largest absolute error, with the exact slope at 0; generator/expression/curve.c computes the
 * same ones in double precision, to measure what forces are off by. */

/* atan a, a >= 0: of the smaller one of a and 1 / a. Where no lane asks for it the quotient is left out: by 1 it
 * changes nothing. Comparisons are such that NaN stays. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_arc_, GIC_LANES)(gic_lane a)
{
    const gic_lane one = LANE(GIC_R(1.0));
    const gic_mask above = (gic_mask)(a > one);
    gic_lane t = a;
    if (LANE_ANY(above))
        t = LANE_MIN(one, a) / LANE_MAX(one, a);
    const gic_lane z = t * t, z2 = z * z, z4 = z2 * z2;
    const gic_lane low = (GIC_R(-0.3333326286812764) + z * GIC_R(0.1999762004215144)) +
                         z2 * (GIC_R(-0.14255463124234446) + z * GIC_R(0.10910278877053915));
    const gic_lane high = (GIC_R(-0.08289760808605352) + z * GIC_R(0.056127366846161505)) +
                          z2 * (GIC_R(-0.029446536674692622) + z * GIC_R(0.010025646984568505));
    const gic_lane arc = t + t * (z * (low + z4 * (high + z4 * GIC_R(-0.0016024360576211084))));
    return LANE_SELECT(above, GIC_HALF_PI - arc, arc);
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_atan_, GIC_LANES)(gic_lane x)
{
    return (gic_lane)((gic_mask)LANE_SHORT_ARC(LANE_FABS(x)) ^ LANE_SIGN(x));
}

/* sin of |r| <= pi/2 */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_wave_, GIC_LANES)(gic_lane r)
{
    const gic_lane z = r * r, z2 = z * z;
    const gic_lane share = (GIC_R(-0.1666666660646488) + z * GIC_R(0.008333330495615816)) +
                           z2 * ((GIC_R(-0.00019840804033975252) + z * GIC_R(2.7522618643037596e-06)) +
                                 z2 * GIC_R(-2.3846690894032753e-08));
    return r + r * (z * share);
}

/* x - turns pi/2: products with the first part are exact within GIC_TURNING. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_reduce_, GIC_LANES)(gic_lane x, gic_lane turns)
{
#ifdef GIC_FLOAT
    const gic_real first = GIC_R(1.5703125), second = GIC_R(0.00048382679);
#else
    const gic_real first = GIC_R(1.5707963267341256), second = GIC_R(6.077100506506192e-11);
#endif
    return (x - turns * first) - turns * second;
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_sin_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane t = LANE_FABS(x) * GIC_R(0.3183098861837907) + GIC_ROUNDER, n = t - GIC_ROUNDER;
    const gic_lane y = LANE_SHORT_WAVE(LANE_SHORT_REDUCE(LANE_FABS(x), n + n));
    const gic_mask turned = (gic_mask)((gic_bits)t << GIC_SIGN_PLACE);
    return LANE_MEND(~inside, GIC_MATH(sin), x, (gic_lane)((gic_mask)y ^ turned ^ LANE_SIGN(x)));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_cos_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane t = (LANE_FABS(x) * GIC_R(0.3183098861837907) - GIC_R(0.5)) + GIC_ROUNDER, n = t - GIC_ROUNDER;
    const gic_lane y = LANE_SHORT_WAVE(LANE_SHORT_REDUCE(LANE_FABS(x), n + n + GIC_R(1.0)));
    const gic_mask turned = (gic_mask)(~(gic_bits)t << GIC_SIGN_PLACE);
    return LANE_MEND(~inside, GIC_MATH(cos), x, (gic_lane)((gic_mask)y ^ turned));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_tan_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_TURNING);
    const gic_lane t = LANE_FABS(x) * GIC_R(0.6366197723675814) + GIC_ROUNDER;
    const gic_lane r = LANE_SHORT_REDUCE(LANE_FABS(x), t - GIC_ROUNDER), z = r * r;
    const gic_lane share = (GIC_R(-0.1666666662799899) + z * GIC_R(0.00833332823871198)) +
                           z * z * (GIC_R(-0.00019839043769993145) + z * GIC_R(2.7160140145580568e-06));
    const gic_lane more =
        (GIC_R(0.041666646866526133) + z * GIC_R(-0.0013887367519608252)) + z * z * GIC_R(2.4438451991605413e-05);
    const gic_lane sine = r + r * (z * share), cosine = GIC_R(1.0) - (z * GIC_R(0.5) - z * z * more);
    /* an odd number of quarters: -1 / tan r */
    const gic_mask odd = -(gic_mask)((gic_bits)t & 1);
    const gic_lane y = LANE_SELECT(odd, -cosine, sine) / LANE_SELECT(odd, sine, cosine);
    return LANE_MEND(~inside, GIC_MATH(tan), x, (gic_lane)((gic_mask)y ^ LANE_SIGN(x)));
}

/* sin(c atan x), |c| <= 2: of an angle a up to pi, or of pi - a. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_sine_, GIC_LANES)(gic_real c, gic_lane x)
{
    const gic_lane a = GIC_MATH(fabs)(c) * LANE_SHORT_ARC(LANE_FABS(x)), other = GIC_HALF_PI + GIC_HALF_PI - a;
    const gic_lane y = LANE_SHORT_WAVE(LANE_SELECT((gic_mask)(a > GIC_HALF_PI), other, a));
    return (gic_lane)((gic_mask)(c < GIC_R(0.0) ? -y : y) ^ LANE_SIGN(x));
}

/* cos(c atan x), |c| <= 2 */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_short_cosine_, GIC_LANES)(gic_real c, gic_lane x)
{
    return LANE_SHORT_WAVE(GIC_HALF_PI - GIC_MATH(fabs)(c) * LANE_SHORT_ARC(LANE_FABS(x)));
}

/* ---- exp, tanh, log --------------------------------------------------------------------------------------------- */

/* *scale (1 + y) = exp x, y between -0.3 and 0.42, *scale a power of 2; |x| <= GIC_EXP_MOST. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_growth_, GIC_LANES)(gic_lane x, gic_lane *scale)
{
#ifdef GIC_FLOAT
    const gic_real first = GIC_R(0.693115234), second = GIC_R(3.19461833e-5), one = GIC_R(1.0);
#else
    const gic_real first = GIC_R(0.6931471805592082), second = GIC_R(7.371002565167799e-13), one = GIC_R(1.0);
#endif
    const gic_lane t = x * GIC_R(1.4426950408889634) + GIC_ROUNDER, n = t - GIC_ROUNDER;
    const gic_lane r = (x - n * first) - n * second, z = r * r;
#ifdef GIC_FLOAT
    const gic_lane share =
        GIC_R(0.4999999814) +
        r * (GIC_R(0.1666654317) + r * (GIC_R(0.0416672022) + r * (GIC_R(8.366581299e-3) + r * GIC_R(1.388248098e-3))));
#else
    const gic_lane z2 = z * z;
    const gic_lane low = (GIC_R(0.5) + r * GIC_R(0.16666666666666677)) +
                         z * (GIC_R(0.041666666666666505) + r * GIC_R(8.333333333321606e-3));
    const gic_lane middle = (GIC_R(1.3888888888962882e-3) + r * GIC_R(1.9841269886208715e-4)) +
                            z * (GIC_R(2.480158717185614e-5) + r * GIC_R(2.755724410339673e-6));
    const gic_lane high =
        (GIC_R(2.755740293928787e-7) + r * GIC_R(2.5109081680772707e-8)) + z * GIC_R(2.0875327170794187e-9);
    const gic_lane share = low + z2 * (middle + z2 * high);
#endif
    *scale = (gic_lane)(((gic_bits)t << GIC_EXPONENT_PLACE) + (gic_bits)LANE(one));
    return r + z * share;
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_exp_, GIC_LANES)(gic_lane x)
{
    const gic_mask inside = (gic_mask)(LANE_FABS(x) <= GIC_EXP_MOST);
    gic_lane scale;
    const gic_lane y = LANE_GROWTH(LANE_WHERE(inside, x), &scale);
    return LANE_MEND(~inside, GIC_MATH(exp), x, scale + scale * y);
}

/* e / (e + 2), e = exp(2 |x|) - 1; 1 from 20 on, NaN for NaN. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_tanh_, GIC_LANES)(gic_lane x)
{
    const gic_mask beyond = (gic_mask)(LANE_FABS(x) > GIC_R(20.0));
    const gic_lane a = LANE_SELECT(beyond, LANE(GIC_R(20.0)), LANE_FABS(x));
    gic_lane scale;
    if (!LANE_ANY(~beyond))
        return (gic_lane)((gic_mask)LANE(GIC_R(1.0)) ^ LANE_SIGN(x));
    const gic_lane y = LANE_GROWTH(a + a, &scale), e = scale * y + (scale - GIC_R(1.0));
    return (gic_lane)((gic_mask)(e / (e + GIC_R(2.0))) ^ LANE_SIGN(x));
}

/* x = 2^n (1 + f), the second factor between the roots of 1/2 and 2; s = f / (2 + f). */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_log_, GIC_LANES)(gic_lane x)
{
#ifdef GIC_FLOAT
    const gic_real least = GIC_R(1.1754943508222875e-38), most = GIC_R(3.4028234663852886e38), root = GIC_R(0.70710678);
    const gic_real whole = GIC_R(8388608.0), bias = GIC_R(8388735.0);
    const gic_real first = GIC_R(0.693115234), second = GIC_R(3.19461833e-5);
#else
    const gic_real least = GIC_R(2.2250738585072014e-308), most = GIC_R(1.7976931348623157e308);
    const gic_real root = GIC_R(0.7071067811865476), whole = GIC_R(4503599627370496.0);
    const gic_real bias = GIC_R(4503599627371519.0);
    const gic_real first = GIC_R(0.6931471805592082), second = GIC_R(7.371002565167799e-13);
#endif
    const gic_mask inside = (gic_mask)(x >= least) & (gic_mask)(x <= most);
    const gic_bits given = (gic_bits)LANE_SELECT(inside, x, LANE(GIC_R(1.0)));
    const gic_bits biased = (given + ((gic_bits)LANE(GIC_R(1.0)) - (gic_bits)LANE(root))) >> GIC_EXPONENT_PLACE;
    const gic_lane n = (gic_lane)(biased | (gic_bits)LANE(whole)) - bias;
    const gic_lane f = (gic_lane)(given - ((biased << GIC_EXPONENT_PLACE) - (gic_bits)LANE(GIC_R(1.0)))) - GIC_R(1.0);
    const gic_lane s = f / (GIC_R(2.0) + f), z = s * s;
#ifdef GIC_FLOAT
    const gic_lane share =
        GIC_R(0.6666666565) + z * (GIC_R(0.4000033451) + z * (GIC_R(0.2853734827) + z * GIC_R(0.2358144784)));
#else
    const gic_lane z2 = z * z, z4 = z2 * z2;
    const gic_lane share = ((GIC_R(0.6666666666666666) + z * GIC_R(0.40000000000006225)) +
                            z2 * (GIC_R(0.2857142856909297) + z * GIC_R(0.22222222645793288))) +
                           z4 * ((GIC_R(0.1818177574150862) + z * GIC_R(0.15387087594889326)) +
                                 z2 * (GIC_R(0.13250186322438637) + z * GIC_R(0.13250733815905688)));
#endif
    return LANE_MEND(~inside, GIC_MATH(log), x, n * first + (s + s + (s * (z * share) + n * second)));
}

LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_pow_, GIC_LANES)(gic_lane x, gic_lane y)
{
    const gic_lane zero = {GIC_R(0.0)};
    return LANE_MEND_TWO((gic_mask)(zero <= zero), GIC_MATH(pow), x, y, zero);
}

#undef GIC_LANES_NEW
#endif
