/* SPDX-License-Identifier: MIT
 *
 * emit: parts of the functions for derivatives along a direction. Private to tangent*.c. */
#ifndef EMIT_TANGENT_H
#define EMIT_TANGENT_H

#include "emit/emit_private.h"
#include "expression/expression.h"
#include "subset/tangent.h"

/* A template that is being expanded, with the constants that its blocks need. */
typedef struct TangentExpansion {
    Generation *g;
    const WheelClass *wheel; /* NULL: g->class is a class of subsets */
    Constants constants;
} TangentExpansion;

/* What moves along a direction in blocks about the whole vehicle and its wheels; context: the Generation. The same
 * where no coordinate changes, nor the geometry, so that no body changes its place relative to the base. */
bool tangent_moves(const void *context, Element element);
bool tangent_moves_still(const void *context, Element element);

/* ---- tangent_subsets.c */

/* Is the recovery computed together with its derivatives? */
bool recovers_along(const Generation *g);
/* Do coordinates alone move the bodies of a class? What its blocks are differentiated along. */
bool class_moves_alone(const Generation *g, int class);
const Along *along_class(const Generation *g, int class, bool still);
/* A block of the class g->class; what a subset's functions read; its variables still and idle, zeros where it is idle.
 */
void tangent_class_block(TangentExpansion *x, const Block *block, Text *out, int indent);
void tangent_links(Generation *g, Text *out, int indent, int s, const char *links, const char *x);
bool tangent_stillness(const Generation *g, Text *out, int indent, int s);
void tangent_zeros(Text *out, int indent, const char *array, const char *place, int count);
/* Insertion points of functions of a class; context: a TangentExpansion. */
void tangent_knowns(void *context, Text *out, int indent);
void tangent_react_knowns(void *context, Text *out, int indent);
void tangent_kept_argument(void *context, Text *out, int indent);
void tangent_kept_unused(void *context, Text *out, int indent);
void tangent_solve(void *context, Text *out, int indent);
void tangent_still(void *context, Text *out, int indent);
void tangent_react_block(void *context, Text *out, int indent);
/* Of the vehicle; context: the Generation. */
void tangent_classes(void *context, Text *out, int indent);
void tangent_calls(void *context, Text *out, int indent);
void tangent_react_calls(void *context, Text *out, int indent);

/* ---- tangent_bodies.c */

/* Are changes of accelerations solved for by what bodies lack, with no derivative of M? */
bool balances_bodies(const Generation *g);
/* [count] numbers of the recovery that a class keeps for that; where a subset's begin in along->kept, of all subsets
 * how many there are; the argument of functions that keep or read them. */
const Ex *tangent_kept(const Generation *g, int class, int *count);
int tangent_kept_offset(const Generation *g, int subset);
const char *tangent_kept_text(const Generation *g, int subset);
/* Insertion points of a class, then of the vehicle, as above. */
void tangent_lack(void *context, Text *out, int indent);
void tangent_still_lack(void *context, Text *out, int indent);
void tangent_base(void *context, Text *out, int indent);
void tangent_lacks(void *context, Text *out, int indent);
void tangent_forces(void *context, Text *out, int indent);
void tangent_still_forces(void *context, Text *out, int indent);
void tangent_solution(void *context, Text *out, int indent);
void tangent_still_solution(void *context, Text *out, int indent);
void tangent_factors(void *context, Text *out, int indent);

#endif
