/* SPDX-License-Identifier: MIT
 *
 * Normal forms of expressions: proofs that two expressions are equal, or opposite, whatever their inputs are. */
#ifndef SPECIALIZE_NORMAL_FORM_H
#define SPECIALIZE_NORMAL_FORM_H

#include "expression/expression.h"
#include "model/model.h"

/* The number of a normal form; 0 is that of zero, and -f that of the opposite of f. Expressions with the same number
 * have the same value for all real values of their inputs for which all their operations are defined. Constants are
 * compared bit by bit and never rounded. Different numbers prove nothing. */
typedef int Form;

typedef struct Normal Normal;

/* What stands for an input of a graph. */
typedef Form NormalInput(void *context, Normal *normal, Element input);

/* even: height and friction of the road are the same at a place and at its mirror image in the plane y = middle. */
Normal *normal_new(Pool *pool, const Model *model, bool even);
Form normal_input(Normal *normal, Element input);
/* World y of a vehicle's base, y[1]. */
Form normal_middle(Normal *normal);
Form normal_sum(Normal *normal, Form a, Form b);
/* Forms of some expressions of a graph, of a member of its class. input NULL: inputs stand for themselves. */
void normal_forms(Normal *normal, const Dag *dag, int member, NormalInput *input, void *context, const Ex *root,
                  int roots, Form *out);

#endif
