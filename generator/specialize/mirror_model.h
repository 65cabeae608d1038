/* SPDX-License-Identifier: MIT
 *
 * Mirror symmetry of a model in the plane y = 0 of its base: which side is whose image. */
#ifndef SPECIALIZE_MIRROR_MODEL_H
#define SPECIALIZE_MIRROR_MODEL_H

#include "model/model.h"

/* Pairs by their names, `*_l` and `*_r`; what has no such name is in the middle, its own image. */
typedef struct Mirror {
    const int *body, *coordinate, *wheel; /* [bodies] ... the image */
    const double *sign;                   /* [coordinates] image's value = sign times the value; -1: it is odd */
} Mirror;

/* NULL: the bodies, joints, coordinates or wheels are not symmetric, and *why says what; forces are not looked at. */
const Mirror *mirror_find(Pool *pool, const Model *model, const char **why);

/* Sign of component i of vectors (such as positions), of axes of rotation, of a matrix, of (xx yy zz xy xz yz). */
double mirror_vector(int i);
double mirror_turn(int i);
double mirror_matrix(int i);
double mirror_inertia(int i);

#endif
