/* SPDX-License-Identifier: MIT
 *
 * subset: derivatives of a class of subsets along a direction. */
#ifndef SUBSET_TANGENT_H
#define SUBSET_TANGENT_H

#include "subset/subset.h"

/* What a class is differentiated along. */
typedef struct Along {
    bool steady; /* the base does not turn */
    bool tuned;  /* derived numbers change */
    bool still;  /* no coordinate does, nor these */
    bool alone;  /* coordinates alone move the bodies, which move by S dx */
} Along;

/* What a block of derivatives stores. */
typedef enum TangentStores {
    TANGENT_AFTER,  /* derivatives of motion and inertia that `solve` stores, at the poses q that it found, and of the
                     * factors if reactions are asked for; it reads what `solve` stored */
    TANGENT_WITH,   /* these and what `solve` of a closed form stores itself, with its checks */
    TANGENT_MOTIONS /* the same without derivatives of inertia; what subset_kept() lists, in kept[] */
} TangentStores;

const Block *subset_tangent(const Formula *formula, const Along *along, TangentStores stores);

/* lack.c: numbers of `solve`, [*count], that the following block reads from kept[]. */
const Ex *subset_kept(const Formula *formula, const Along *along, int deps, int *count);
/* The block that stores in lack[] the derivatives of what the bodies lack in the equations of motion at
 * accelerations acc[] that stand still: moment and force on the whole vehicle, forces along the deps. acc: of the base,
 * alpha and a, then of the deps. It reads kept[], motion and inertia and the derivatives of motion. Of a closed form
 * whose bodies move by S dx. */
const Block *subset_lack(const Formula *formula, const Along *along, int deps);
/* [6 + deps] what they lack. */
void subset_residuals(const Formula *formula, bool free_base, int deps, Ex *tau);

/* Nodes whose derivatives are known. */
typedef struct GivenSlopes {
    int count;
    Ex *node, *slope;
} GivenSlopes;

/* Give those of a body that moves by a small twist, angular and linear of its reference point: pose, centre of mass,
 * and inertia in base axes need no derivatives of what they are computed from. */
void give_twist(const Formula *f, int body, const Ex twist[6], GivenSlopes *g);
/* The same with what bodies add computed from what `solve` computes, parts of its balanced sums too: else poses would
 * be computed, and differentiated, a second time. */
const Formula *formula_from_parts(const Formula *formula);
/* Where derivatives of what `solve` computes begin; `along` is kept. */
Seeds subset_seeds(const Formula *formula, const Along *along);
/* [nodes] images of roots in which numbers that `solve` of a closed form has stored are read. */
const Ex *subset_read_stored(const Formula *formula, const Ex *root, int roots);
/* The derivatives of nodes of `solve`, at the same poses. */
const Ex *subset_slopes(const Formula *formula, const Seeds *seeds, const Ex *root, int roots);

#endif
