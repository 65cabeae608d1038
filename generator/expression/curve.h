/* SPDX-License-Identifier: MIT
 *
 * Functions of one number as tables or, in lanes, as short polynomials: for tires by table. */
#ifndef EXPRESSION_CURVE_H
#define EXPRESSION_CURVE_H

#include "base/pool.h"
#include "expression/expression.h"

typedef enum CurveKind {
    CURVE_ATAN,   /* atan(x) */
    CURVE_TAN,    /* tan(x) */
    CURVE_SINE,   /* sin(factor atan(x)) */
    CURVE_COSINE, /* cos(factor atan(x)) */
    /* in lanes, LANE_SHORT_ATAN and so on of gic_lanes.h, for any x: */
    CURVE_SHORT_ATAN,
    CURVE_SHORT_TAN,
    CURVE_SHORT_SIN,    /* sin(x) */
    CURVE_SHORT_COS,    /* cos(x) */
    CURVE_SHORT_SINE,   /* sin(factor atan(x)), |factor| <= 2 */
    CURVE_SHORT_COSINE, /* cos(factor atan(x)), |factor| <= 2 */
} CurveKind;

enum { CURVE_NUMBERS = 8 }; /* of a cell: coefficients of degree 0 to 6 about the place that follows them */

typedef struct Curve {
    CurveKind kind;
    double factor;
    int cells;                     /* from 0 on; |x| beyond the last: the function itself. 0: a short polynomial */
    double (*cell)[CURVE_NUMBERS]; /* [cells] */
    double error;                  /* largest one that was found, 64 looks a cell; of a tangent |x| <= 1 */
} Curve;

typedef struct Curves {
    int count;
    Curve *curve;
} Curves;

/* Fill `cells`, `cell` and `error` from kind and factor. */
void curve_make(Pool *pool, Curve *curve);
/* Where the table ends: 64, of a tangent 1. */
double curve_end(const Curve *curve);
/* What generated code computes for x, in double precision. */
double curve_value(const Curve *curve, double x);
/* short_curve.c: the same for kinds of short polynomials. */
bool curve_is_short(const Curve *curve);
void short_curve_make(Curve *curve);
double short_curve_value(const Curve *curve, double x);
/* What follows the prefix in the name of the function in gic_lanes.h: "ATAN" of LANE_SHORT_ATAN. */
const char *short_curve_name(const Curve *curve);
/* An angle's sine and cosine, and an arc tangent of x >= 0, with the same digits on every machine. */
double curve_arc_tangent(double x);
/* The block with arc tangents, tangents, and sines and cosines of a number times an arc tangent as OP_CURVE, in the
 * same graph; new curves are added. The graph remembers `curves`, and evaluates them. Checks stay as they are.
 * lanes: short polynomials, and all sines and cosines by them. */
Block block_with_curves(const Block *block, Curves *curves, bool lanes);

#endif
