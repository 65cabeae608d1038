/* SPDX-License-Identifier: MIT
 *
 * Functions of one number as tables, for tires by table. */
#ifndef EXPRESSION_CURVE_H
#define EXPRESSION_CURVE_H

#include "base/pool.h"
#include "expression/expression.h"

typedef enum CurveKind {
    CURVE_ATAN,   /* atan(x) */
    CURVE_TAN,    /* tan(x) */
    CURVE_SINE,   /* sin(factor atan(x)) */
    CURVE_COSINE, /* cos(factor atan(x)) */
} CurveKind;

enum { CURVE_NUMBERS = 8 }; /* of a cell: coefficients of degree 0 to 6 about the place that follows them */

typedef struct Curve {
    CurveKind kind;
    double factor;
    int cells;                     /* from 0 on; |x| beyond the last: the function itself */
    double (*cell)[CURVE_NUMBERS]; /* [cells] */
    double error;                  /* largest one that was found, 64 looks a cell */
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
/* The block with arc tangents, tangents, and sines and cosines of a number times an arc tangent as OP_CURVE, in the
 * same graph; new curves are added. The graph remembers `curves`, and evaluates them. Checks stay as they are. */
Block block_with_curves(const Block *block, Curves *curves);

#endif
