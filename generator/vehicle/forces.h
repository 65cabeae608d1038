/* SPDX-License-Identifier: MIT
 *
 * forces: what forces.c asks of the files that hold single laws. */
#ifndef VEHICLE_FORCES_H
#define VEHICLE_FORCES_H

#include "expression/expression.h"
#include "subset/subset.h"

typedef struct Force Force;
typedef struct Whole Whole;

/* forces.c: a direction fixed in a body, or in the ground, in the base frame. */
void force_direction(Whole *whole, int body, const Ex local[3], Ex out[3]);

/* A number that goes into the loads, or with Whole.parted what stands for it there; internal: see LoadPart. Do the two
 * bodies of an element push each other? */
Ex load_part(Whole *whole, Ex value, bool internal);
bool load_is_internal(const Force *force);

/* aero.c: force, N, at the point of an element FORCE_AERO and moment, N m, in the axes of its body; size: magnitudes of
 * the terms of either. */
void aero_wrench(Whole *whole, const Force *force, Ex value[6], Ex size[2]);

/* What a bushing exerts on its second body, base frame: force, N, at that body's point, and torque, N m. */
typedef struct BushingLoad {
    Vector end[2]; /* the points of both bodies */
    Ex arm[3];     /* from the first to the second */
    Ex force[3], torque[3];
    Ex potential, potential_rate, power; /* of its stiffness, J, W; of all else, W */
    Ex size[2];                          /* magnitudes of the terms of force and torque */
} BushingLoad;

/* bushing.c */
BushingLoad bushing_load(Whole *whole, const Force *force);

#endif
