/* SPDX-License-Identifier: MIT
 *
 * Motions of subsets of one coordinate, enclosed over intervals of it: proofs, by Taylor models. */
#ifndef SUBSET_ENCLOSURE_H
#define SUBSET_ENCLOSURE_H

#include "subset/exact_motion.h"
#include "subset/taylor_model.h"

typedef struct Enclosure Enclosure;

/* Of the same subsets; solutions of `exact` are where enclosures are looked for. */
Enclosure *enclosure_new(Exact *exact);
/* Begin again at the design. */
void enclosure_reset(Enclosure *enclosure);
/* Enclose a subset's motion, and those of the subsets that it refers to, at unit rate and with the base at rest, while
 * its coordinate is between two values, of which `from` is the design or `to` of the last accepted interval. True if it
 * is proved that for each value there is one pose within the enclosure in which all equations of joints and coordinates
 * hold, that it is the one that is reached from the design without a leap, and that the checks of `solve` hold in it.
 * False: nothing is known; a nearer `to` may do. */
bool enclosure_extend(Enclosure *enclosure, int subset, Quad from, Quad to);
/* Go on from the end of that interval. */
void enclosure_accept(Enclosure *enclosure, int subset);
/* The motion of the last time, in the order of `motion[]` of generated code, by t from -1 at the lower value to 1 at
 * the upper one. */
const TaylorModel *enclosure_motion(const Enclosure *enclosure, int subset);
/* The coordinate of the last time. */
const TaylorModel *enclosure_coordinate(const Enclosure *enclosure);

/* What an input of a graph is. */
typedef TaylorModel EnclosureInput(const void *context, Element element);
/* Evaluate the nodes that are needed [nodes], at constants of one sample. unit: each operation may be off by that share
 * of its result, for code that rounds. */
void enclosure_evaluate(const Dag *dag, int sample, const bool *needed, EnclosureInput *input, const void *context,
                        Quad unit, TaylorModel *node);

#endif
