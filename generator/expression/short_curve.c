/* SPDX-License-Identifier: MIT
 * The short polynomials of gic_lanes.h (LANE_SHORT_ATAN and its like) for one number, operation by operation, so that
 * what they change in a tire's forces can be measured.
 *
 * Their coefficients are of least largest absolute error, by Remez' exchange: of atan(x) = x + x z p(z), z = x^2, 9
 * terms on 0 <= x <= 1 (1.1e-9), of the sine 5 terms up to a quarter turn (1.8e-11), and for the tangent 4 terms of the
 * sine and 3 of the cosine up to an eighth (2.4e-12, 9.6e-11). tests/data/lanes/short.py finds them again. */
#include "expression/curve.h"
#include "expression/expression.h"

#include <math.h>

static const double half_pi = 1.57079632679489661923, most = 1048576; /* beyond, libm's functions */

bool curve_is_short(const Curve *curve)
{
    return curve->kind >= CURVE_SHORT_ATAN;
}

const char *short_curve_name(const Curve *curve)
{
    static const char *const name[] = {"ATAN", "TAN", "SIN", "COS", "SINE", "COSINE"};
    return name[curve->kind - CURVE_SHORT_ATAN];
}

static double polynomial(double z, const double *c, int terms)
{
    double sum = 0;
    for (int i = terms - 1; i >= 0; --i)
        sum = c[i] + z * sum;
    return sum;
}

/* x >= 0, or no number, which stays. */
static double arc(double x)
{
    static const double c[] = {-0.3333326286812764,   0.1999762004215144,   -0.14255463124234446,
                               0.10910278877053915,   -0.08289760808605352, 0.056127366846161505,
                               -0.029446536674692622, 0.010025646984568505, -0.0016024360576211084};
    const double t = x > 1 ? 1 / x : x, z = t * t, value = t + t * (z * polynomial(z, c, 9));
    return x > 1 ? half_pi - value : value;
}

/* sin r, |r| <= pi/2 */
static double wave(double r)
{
    static const double c[] = {-0.1666666660646488, 0.008333330495615816, -0.00019840804033975252,
                               2.7522618643037596e-06, -2.3846690894032753e-08};
    const double z = r * r;
    return r + r * (z * polynomial(z, c, 5));
}

/* x - turns pi/2 */
static double reduced(double x, double turns)
{
    return (x - turns * 1.5707963267341256) - turns * 6.077100506506192e-11;
}

static double tangent(double x)
{
    static const double c[] = {-0.1666666662799899, 0.00833332823871198, -0.00019839043769993145,
                               2.7160140145580568e-06};
    static const double d[] = {0.041666646866526133, -0.0013887367519608252, 2.4438451991605413e-05};
    const double turns = nearbyint(x / half_pi), r = reduced(x, turns), z = r * r;
    const double sine = r + r * (z * polynomial(z, c, 4)), cosine = 1 - (z * 0.5 - z * z * polynomial(z, d, 3));
    return fmod(turns, 2) != 0 ? -cosine / sine : sine / cosine;
}

/* Half turns and the sine of what is left, `quarters` ahead. */
static double turned_wave(double x, double quarters)
{
    const double halves = nearbyint((x / half_pi - quarters) / 2);
    const double y = wave(reduced(x, 2 * halves + quarters));
    return (fmod(halves, 2) != 0) != (quarters > 0) ? -y : y;
}

double short_curve_value(const Curve *curve, double x)
{
    const double a = fabs(x), sign = x < 0 ? -1 : 1, angle = fabs(curve->factor) * arc(a);
    switch (curve->kind) {
    case CURVE_SHORT_TAN: return a <= most ? sign * tangent(a) : tan(x);
    case CURVE_SHORT_SIN: return a <= most ? sign * turned_wave(a, 0) : sin(x);
    case CURVE_SHORT_COS: return a <= most ? turned_wave(a, 1) : cos(x);
    case CURVE_SHORT_SINE:
        return (curve->factor < 0 ? -sign : sign) * wave(angle > half_pi ? half_pi + half_pi - angle : angle);
    case CURVE_SHORT_COSINE: return wave(half_pi - angle);
    default: return sign * arc(a);
    }
}

/* The function itself, 0 <= x. */
static double exact(const Curve *curve, double x)
{
    const double factor = curve->kind == CURVE_SHORT_SINE || curve->kind == CURVE_SHORT_COSINE ? curve->factor : 0;
    double sine, cosine;
    if (curve->kind == CURVE_SHORT_ATAN)
        return curve_arc_tangent(x);
    portable_sincos(factor != 0 ? factor * curve_arc_tangent(x) : x, &sine, &cosine);
    switch (curve->kind) {
    case CURVE_SHORT_TAN: return sine / cosine;
    case CURVE_SHORT_SIN:
    case CURVE_SHORT_SINE: return factor == 0 && curve->kind == CURVE_SHORT_SINE ? 0 : sine;
    default: return factor == 0 && curve->kind == CURVE_SHORT_COSINE ? 1 : cosine;
    }
}

void short_curve_make(Curve *curve)
{
    enum { LOOKS = 4096 }; /* evenly over angles: the error has at most 20 extrema in each quarter turn */
    curve->cells = 0;
    curve->error = 0;
    for (int i = 0; i < LOOKS; ++i) {
        const double share = (i + 0.5) / LOOKS;
        double x = 4 * half_pi * share, sine, cosine;
        if (curve->kind == CURVE_SHORT_TAN) {
            x = share;
        } else if (curve->kind != CURVE_SHORT_SIN && curve->kind != CURVE_SHORT_COS) {
            portable_sincos(half_pi * share, &sine, &cosine);
            x = sine / cosine;
        }
        curve->error = fmax(curve->error, fabs(short_curve_value(curve, x) - exact(curve, x)));
    }
}
