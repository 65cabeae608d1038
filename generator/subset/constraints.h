/* SPDX-License-Identifier: MIT
 * The parts of joints: shared by the files that make equations of them and that solve these equations in closed
 * form. */
#ifndef SUBSET_CONSTRAINTS_H
#define SUBSET_CONSTRAINTS_H

#include "model/model.h"

/* The parts of a joint; a and b are its first and second body. */
enum {
    PART_POINT = 1,    /* x_a = x_b: 3 equations */
    PART_PARALLEL = 2, /* u_a parallel to u_b: 2 */
    PART_LOCK = 4,     /* no turn about the common axis: 1 */
    PART_LINE = 8,     /* x_b - x_a parallel to u_a: 2 */
    PART_LENGTH = 16,  /* norm(x_b - x_a): 1 */
    PART_ALONG = 32,   /* u_a . (x_b - x_a): 1 */
    PART_CROSS = 64,   /* u_a perpendicular to u_b: 1 */
    PART_GEAR = 128,   /* a turn about u_a goes with u_a . (x_b - x_a), or with a side of it: 1 */
    PART_HELD = 256    /* as for a dual coordinate, at the value of a formula: 1 */
};

extern const int joint_parts[JOINT_TYPES];

#endif
