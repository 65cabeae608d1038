/* SPDX-License-Identifier: MIT
 * functions.c: the elementary functions of gic_lanes.h against quad precision. Prints a line for each: its name,
 * largest error in units of the last place, the argument there, how many arguments; exit status 1 where one is above
 * its bound, or where a special argument gives another result than C99 says. */
#include "lanes_functions.h"

#include <fenv.h>
#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef GIC_FLOAT
#define DIGITS FLT_MANT_DIG
#define LEAST FLT_MIN_EXP
#define SELECT(double_value, float_value) (float_value)
#define MATH(name) name##f
typedef uint32_t Word;
#else
#define DIGITS DBL_MANT_DIG
#define LEAST DBL_MIN_EXP
#define SELECT(double_value, float_value) (double_value)
#define MATH(name) name
typedef uint64_t Word;
#endif

/* A function of one argument in lanes, the same by libm, and in quad precision; |x| or x from low to high, for which
 * the bound holds; multiples of `period` are where it may be worst. */
typedef struct Function {
    const char *name;
    void (*lanes)(const gic_real *x, gic_real *y);
    gic_real (*libm)(gic_real);
    __float128 (*quad)(__float128);
    double bound, low, high, period;
} Function;

#define TURNING SELECT(0x1p20, 0x1p12)
#define LARGEST SELECT(DBL_MAX, FLT_MAX)
static const Function function[] = {
    {"sin", sin_lanes, MATH(sin), sinq, 3, -TURNING, TURNING, M_PI / 2},
    {"cos", cos_lanes, MATH(cos), cosq, 3, -TURNING, TURNING, M_PI / 2},
    {"tan", tan_lanes, MATH(tan), tanq, 4, -TURNING, TURNING, M_PI / 4},
    {"asin", asin_lanes, MATH(asin), asinq, 4, -1, 1, 0.5},
    {"acos", acos_lanes, MATH(acos), acosq, 4, -1, 1, 0.5},
    {"atan", atan_lanes, MATH(atan), atanq, 3, -LARGEST, LARGEST, 0.41421356237309503},
    {"exp", exp_lanes, MATH(exp), expq, 2, -SELECT(708.0, 87.0), SELECT(708.0, 87.0), 0.34657359027997264},
    {"log", log_lanes, MATH(log), logq, 4, SELECT(DBL_MIN, FLT_MIN), LARGEST, 0.70710678118654752},
    {"tanh", tanh_lanes, MATH(tanh), tanhq, 4, -LARGEST, LARGEST, 0.17328679513998632},
    {"sqrt", sqrt_lanes, MATH(sqrt), sqrtq, 0.5, 0, LARGEST, 1},
};

enum { PERIODIC = 3 }; /* so many of them, the first ones */

static uint64_t seed = 20061109;

static uint64_t random_bits(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static double random_share(void)
{
    return (double)(random_bits() >> 11) * 0x1p-53;
}

static gic_real of_bits(Word bits)
{
    gic_real x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Error of y in units of the last place that y has when it is rounded right; where that is 0 or subnormal, of the
 * smallest number. */
static double error_of(gic_real y, __float128 exact)
{
    int exponent;
    frexpq(exact, &exponent);
    const __float128 unit = ldexpq(1, (exponent > LEAST ? exponent : LEAST) - DIGITS);
    return (double)(fabsq((__float128)y - exact) / unit);
}

/* ---- errors -------------------------------------------------------------------------------------------------- */

/* The i-th argument: evenly in the range, near 0 and near multiples of the period by few units of the last place, over
 * all magnitudes, and moderate ones. */
static gic_real argument(const Function *f, long i)
{
    const double share = random_share(), sign = f->low < 0 && random_bits() & 1 ? -1 : 1;
    const double moderate = f->high > 100 ? 100 : f->high;
    switch (i % 4) {
    case 0: return (gic_real)(f->low / 2 + share * (f->high / 2 - f->low / 2) + share * (f->high / 2 - f->low / 2));
    case 1: return (gic_real)(sign * share * moderate);
    case 2: { /* one multiple after another, so that arguments that nearly cancel are among them */
        const double most = floor(fmin(f->high / f->period, 1e6));
        gic_real x = (gic_real)(f->period * (double)(i / 4 % (long)(most + 1)));
        Word bits;
        memcpy(&bits, &x, sizeof bits);
        bits += i / 4 <= (long)most ? 0 : random_bits() % 9 - 4;
        return (gic_real)sign * of_bits(bits);
    }
    default: return of_bits((Word)random_bits());
    }
}

/* Within the range of the bound, and with `all` subnormal too; else not with such a result either. */
static bool fits(const Function *f, gic_real x, bool all)
{
    const double normal = SELECT(DBL_MIN, FLT_MIN);
    return (double)x >= f->low && (double)x <= f->high /* not NaN */ &&
           (all || (fabs((double)x) >= normal && fabs((double)f->libm(x)) >= 2 * normal));
}

static bool errors_of(const Function *f, long count, bool all)
{
    double worst = 0;
    gic_real where = 0;
    long tried = 0;
    int raised = 0; /* exceptions that no such argument asks for */
    for (long i = 0; i < count; i += LANES) {
        gic_real x[LANES], y[LANES];
        for (int l = 0; l < LANES; ++l) {
            gic_real a = argument(f, i + l);
            x[l] = fits(f, a, all) ? a : GIC_R(0.25);
        }
        feclearexcept(FE_ALL_EXCEPT);
        f->lanes(x, y);
        raised |= fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
        for (int l = 0; l < LANES; ++l) {
            const double error = error_of(y[l], f->quad(x[l]));
            ++tried;
            if (!(error <= worst)) {
                worst = error;
                where = x[l];
            }
        }
    }
    printf("%-6s %.3f of %g at %.17g, %ld arguments%s\n", f->name, worst, f->bound, (double)where, tried,
           raised ? ", with floating-point exceptions" : "");
    return worst <= f->bound && !raised;
}

/* atan2 over all quadrants, slopes and sizes. */
static bool errors_of_atan2(long count)
{
    const double bound = 4;
    double worst = 0, at[2] = {0, 0};
    for (long i = 0; i < count; i += LANES) {
        gic_real a[LANES], b[LANES], y[LANES];
        for (int l = 0; l < LANES; ++l) {
            const double size = i & 4 ? 1 : pow(SELECT(2e270, 1e26), 2 * random_share() - 1);
            const double other = i & 8 ? random_share() : pow(10, SELECT(-300, -30) * random_share());
            a[l] = (gic_real)(size * (random_bits() & 1 ? 1 : -1));
            b[l] = (gic_real)(size * other * (random_bits() & 1 ? 1 : -1));
            if (random_bits() & 1) {
                const gic_real swap = a[l];
                a[l] = b[l], b[l] = swap;
            }
        }
        atan2_lanes(a, b, y);
        for (int l = 0; l < LANES; ++l) {
            const double error = error_of(y[l], atan2q(a[l], b[l]));
            if (!(error <= worst))
                worst = error, at[0] = (double)a[l], at[1] = (double)b[l];
        }
    }
    printf("%-6s %.3f of %g at %.17g, %.17g, %ld arguments\n", "atan2", worst, bound, at[0], at[1], count);
    return worst <= bound;
}

/* ---- special arguments --------------------------------------------------------------------------------------- */

/* Both NaN, or the same number within some units, and the same sign. */
static bool alike(gic_real y, gic_real libm, double bound)
{
    if (isnan((double)libm) || isnan((double)y))
        return isnan((double)libm) && isnan((double)y);
    if (isinf((double)libm) || isinf((double)y) || libm == 0)
        return y == libm && !signbit((double)y) == !signbit((double)libm);
    return error_of(y, libm) <= bound + 1;
}

static gic_real special[] = {0,
                             1,
                             GIC_R(0.5),
                             2,
                             SELECT(DBL_MIN, FLT_MIN),
                             SELECT(DBL_MAX, FLT_MAX),
                             1e30f,
                             SELECT(0x1p20, 0x1p12),
                             SELECT(1048577.0, 4097.0f),
                             SELECT(708.0, 87.0f),
                             SELECT(709.0, 88.0f),
                             SELECT(710.0, 89.0f),
                             SELECT(745.0, 103.0f),
                             SELECT(750.0, 110.0f),
                             20,
                             21,
                             SELECT(4.9406564584124654e-324, 1.4e-45f),
                             SELECT(1e-310, 1e-40f),
                             INFINITY,
                             NAN};
enum { SPECIALS = sizeof special / sizeof *special };

/* Each of them in each lane, between others that must not feel it. */
static bool specials_of(const Function *f)
{
    bool good = true;
    for (int i = 0; i < 2 * SPECIALS; ++i)
        for (int l = 0; l < LANES; ++l) {
            gic_real x[LANES], y[LANES], plain[LANES];
            for (int k = 0; k < LANES; ++k)
                x[k] = GIC_R(0.05) * (gic_real)(k + 1);
            f->lanes(x, plain);
            x[l] = i < SPECIALS ? special[i] : -special[i - SPECIALS];
            f->lanes(x, y);
            for (int k = 0; k < LANES; ++k) {
                const gic_real right = k == l ? f->libm(x[k]) : plain[k];
                if (k == l ? alike(y[k], right, f->bound) : y[k] == right)
                    continue;
                printf("%s(%.17g) is %.17g, not %.17g\n", f->name, (double)x[k], (double)y[k], (double)right);
                good = false;
            }
        }
    return good;
}

static bool specials_of_two(const char *name, void (*lanes)(const gic_real *, const gic_real *, gic_real *),
                            gic_real (*libm)(gic_real, gic_real))
{
    bool good = true;
    for (int i = 0; i < 4 * SPECIALS * SPECIALS; ++i) {
        const int first = i / 4 / SPECIALS, second = i / 4 % SPECIALS, l = i % LANES;
        gic_real a[LANES], b[LANES], y[LANES];
        for (int k = 0; k < LANES; ++k)
            a[k] = b[k] = (gic_real)k;
        a[l] = i & 1 ? -special[first] : special[first];
        b[l] = i & 2 ? -special[second] : special[second];
        lanes(a, b, y);
        if (!alike(y[l], libm(a[l], b[l]), 4)) {
            printf("%s(%.17g, %.17g) is %.17g, not %.17g\n", name, (double)a[l], (double)b[l], (double)y[l],
                   (double)libm(a[l], b[l]));
            good = false;
        }
    }
    return good;
}

/* functions COUNT WHAT: so many arguments of each that is periodic, an eighth of the others; WHAT: all, or normal:
 * neither subnormal nor special ones. */
int main(int count, char **word)
{
    if (count != 3)
        return 2;
    const long arguments = atol(word[1]);
    const bool all = !strcmp(word[2], "all");
    bool good = errors_of_atan2(arguments / 8);
    for (size_t i = 0; i < sizeof function / sizeof *function; ++i)
        good &= errors_of(&function[i], i < PERIODIC ? arguments : arguments / 8, all);
    for (size_t i = 0; all && i < sizeof function / sizeof *function; ++i)
        good &= specials_of(&function[i]);
    if (all)
        good &= specials_of_two("atan2", atan2_lanes, MATH(atan2)) & specials_of_two("pow", pow_lanes, MATH(pow));
    return !good;
}
