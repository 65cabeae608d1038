/* SPDX-License-Identifier: MIT
 * Rates and their derivatives along a direction by what the bodies lack: M dz = db - d(M z) at accelerations z that
 * stand still on the right, in two blocks. */
#ifndef VEHICLE_TANGENT_RATES_H
#define VEHICLE_TANGENT_RATES_H

#include "vehicle/vehicle.h"

typedef struct TangentRates {
    Block first;  /* rates, accelerations acc[] [unknowns], derivatives that these do not change, and factor[] */
    Block second; /* the other derivatives, from factor[] and from lack[] */
    int factors;  /* numbers of factor[] */
} TangentRates;

/* Has the block of the equations of motion a system of all unknowns, each of which its solution alone makes? */
bool rates_are_solved(const Plan *plan, const Block *dynamics);
/* Of such a block. lack[]: from Plan.inertia_offset of each subset on moment and force on the whole vehicle, then
 * forces along the subset's deps; lacks [Plan.inertia_size]: which of these may be other than 0. seeds: of all else,
 * with inertia that stands still. */
const TangentRates *tangent_rates(const Plan *plan, const Block *dynamics, const Seeds *seeds, const bool *lacks);

#endif
