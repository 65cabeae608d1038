/* SPDX-License-Identifier: MIT
 *
 * forces: what forces.c asks of the files that hold single laws. */
#ifndef VEHICLE_FORCES_H
#define VEHICLE_FORCES_H

#include "expression/expression.h"

typedef struct Force Force;
typedef struct Whole Whole;

/* aero.c: force, N, at the point of an element FORCE_AERO and moment, N m, in the axes of its body; size: magnitudes of
 * the terms of either. */
void aero_wrench(Whole *whole, const Force *force, Ex value[6], Ex size[2]);

#endif
