/* SPDX-License-Identifier: MIT
 * short.c: the short polynomials of gic_lanes.h against quad precision, in LANES lanes: absolute errors at random
 * arguments of all magnitudes, next to multiples of an eighth of a turn, and to 1, where atan changes its formula;
 * special arguments; LANE_MIN and LANE_MAX to the bit; a lane's result depends on its own argument alone. Exit status 1
 * where a bound is exceeded. */
#define GIC_LANES LANES
#include "gic_lanes.h"

#include <quadmath.h>
#include <stdbool.h>
#include <stdio.h>

enum { COUNT = 200000 };

#ifdef GIC_FLOAT
#define SELECT(double_value, float_value) (float_value)
#else
#define SELECT(double_value, float_value) (double_value)
#endif

typedef struct Function {
    const char *name;
    void (*lanes)(gic_real c, const gic_lane *x, gic_lane *y);
    __float128 (*quad)(gic_real c, __float128 x);
    double bound, most; /* absolute error for |x| <= most; 0: any x */
} Function;

#define ONE(NAME, expression) \
    static void NAME##_lanes(gic_real c, const gic_lane *x, gic_lane *y) \
    { \
        (void)c; \
        *y = LANE_SHORT_##NAME(*x); \
    } \
    static __float128 NAME##_quad(gic_real c, __float128 x) \
    { \
        (void)c; \
        return expression; \
    }
#define TWO(NAME, expression) \
    static void NAME##_lanes(gic_real c, const gic_lane *x, gic_lane *y) \
    { \
        *y = LANE_SHORT_##NAME(c, *x); \
    } \
    static __float128 NAME##_quad(gic_real c, __float128 x) \
    { \
        return expression; \
    }
ONE(ATAN, atanq(x))
ONE(SIN, sinq(x))
ONE(COS, cosq(x))
ONE(TAN, tanq(x))
TWO(SINE, sinq(c *atanq(x)))
TWO(COSINE, cosq(c *atanq(x)))

/* bounds of gic_lanes.h, and of numbers of type float some rounding */
static const Function function[] = {
    {"atan", ATAN_lanes, ATAN_quad, SELECT(1.2e-9, 3e-7), 0},
    {"sin", SIN_lanes, SIN_quad, SELECT(3e-11, 3e-7), SELECT(0x1p20, 0x1p12)},
    {"cos", COS_lanes, COS_quad, SELECT(3e-11, 3e-7), SELECT(0x1p20, 0x1p12)},
    {"tan", TAN_lanes, TAN_quad, SELECT(3e-10, 6e-7), SELECT(0x1p20, 0x1p12)},
    {"sine", SINE_lanes, SINE_quad, SELECT(2.4e-9, 8e-7), 0},
    {"cosine", COSINE_lanes, COSINE_quad, SELECT(2.4e-9, 8e-7), 0},
};

static uint64_t seed = 20061109;

static double random_share(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) * 0x1p-53;
}

static double argument(const Function *f, long i)
{
    const double sign = random_share() < 0.5 ? -1 : 1, share = random_share();
    const double most = f->most > 0 ? f->most : SELECT(1e300, 1e30);
    switch (i % 4) {
    case 0: return sign * most * share;
    case 1: return sign * pow(most, 2 * share - 1);
    case 2: return sign * (f->most > 0 ? floor(1000 * random_share()) * M_PI_4 : 1) * (1 + 1e-6 * (share - 0.5));
    default: return sign * 4 * share;
    }
}

static bool errors_of(const Function *f, gic_real c)
{
    double worst = 0, where = 0;
    for (long i = 0; i < COUNT; i += LANES) {
        gic_lane x, y;
        for (int l = 0; l < LANES; ++l)
            x[l] = (gic_real)argument(f, i + l);
        f->lanes(c, &x, &y);
        for (int l = 0; l < LANES; ++l) {
            const __float128 exact = f->quad(c, x[l]), error = fabsq((__float128)y[l] - exact);
            const double share = (double)(f->lanes == TAN_lanes ? error / fmaxq(1, exact * exact) : error);
            if (!(share <= worst))
                worst = share, where = (double)x[l];
        }
    }
    printf("%s, %g: %.3g of %g at %.17g\n", f->name, (double)c, worst, f->bound, where);
    return worst <= f->bound;
}

/* In each lane, between others that must not feel it: 0 and its sign, infinities, NaN, and what is beyond the range. */
static bool specials_of(const Function *f, gic_real c)
{
    const gic_real zero = 0, huge = SELECT(1e300, 1e30f);
    const gic_real special[] = {zero, -zero, huge, -huge, 1 / zero, -1 / zero, zero / zero, 1, -1};
    bool good = true;
    for (size_t i = 0; i < sizeof special / sizeof *special; ++i)
        for (int l = 0; l < LANES; ++l) {
            gic_lane x, y, plain;
            for (int k = 0; k < LANES; ++k)
                x[k] = GIC_R(0.05) * (gic_real)(k + 1);
            f->lanes(c, &x, &plain);
            x[l] = special[i];
            f->lanes(c, &x, &y);
            for (int k = 0; k < LANES; ++k) {
                const double right = (double)f->quad(c, x[k]), got = (double)y[k];
                if (k != l ? got == (double)plain[k]
                           : (isnan(right) && isnan(got)) || fabs(got - right) <= f->bound ||
                                 (f->lanes == TAN_lanes && fabs(got - right) <= f->bound * fmax(1, right * right)))
                    if (!(k == l && right == 0 && (got != 0 || signbit(got) != signbit(right))))
                        continue;
                printf("%s(%g, %.17g) is %.17g, not %.17g\n", f->name, (double)c, (double)x[k], got, right);
                good = false;
            }
        }
    return good;
}

/* Is the smaller and the larger one of two what a comparison says, to the bit? */
static bool of_two(void)
{
    const gic_real zero = 0;
    const gic_real number[] = {zero, -zero, 1, -1, GIC_R(1.5), 1 / zero, -1 / zero, zero / zero};
    enum { NUMBERS = sizeof number / sizeof *number };
    bool good = true;
    for (int i = 0; i < NUMBERS * NUMBERS; ++i)
        for (int l = 0; l < LANES; ++l) {
            gic_lane x, y;
            for (int k = 0; k < LANES; ++k)
                x[k] = (gic_real)k, y[k] = 2;
            x[l] = number[i / NUMBERS], y[l] = number[i % NUMBERS];
            const gic_lane least = LANE_MIN(x, y), most = LANE_MAX(x, y);
            for (int k = 0; k < LANES; ++k) {
                const gic_real a = x[k] < y[k] ? x[k] : y[k], b = x[k] > y[k] ? x[k] : y[k];
                const gic_real got = least[k], other = most[k];
                good = good && !memcmp(&a, &got, sizeof a) && !memcmp(&b, &other, sizeof b);
            }
        }
    printf("minimum and maximum %s\n", good ? "right" : "wrong");
    return good;
}

int main(void)
{
    const gic_real factor[] = {1, 0, 2, -2, GIC_R(0.97505), GIC_R(1.7204), GIC_R(-1.3)};
    bool good = of_two();
    for (size_t i = 0; i < sizeof function / sizeof *function; ++i)
        for (size_t k = 0; k < (i < 4 ? 1 : sizeof factor / sizeof *factor); ++k)
            good = errors_of(&function[i], factor[k]) && specials_of(&function[i], factor[k]) && good;
    return !good;
}
