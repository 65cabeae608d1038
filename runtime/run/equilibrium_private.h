/* SPDX-License-Identifier: MIT
 *
 * What the search for an equilibrium and its derivatives share. Unknowns are the places, then the fast states but
 * clocks; equations their accelerations, then rates: equation i is row places + i of A. */
#ifndef RUN_EQUILIBRIUM_PRIVATE_H
#define RUN_EQUILIBRIUM_PRIVATE_H

#include "model/powertrain_numbers.h"
#include "run/linearize.h"

/* Singular values below this, relative to the largest, count as zero: nothing changes. */
extern const double equilibrium_rank;

/* The column of A of an unknown. */
int equilibrium_column(const Linear *linear, int unknown);
/* True of number i of the motions on locked wheels: fast states are held, but for the model's own. */
bool equilibrium_is_held(const Equilibrium *found, int i);
/* Exchanges the gears of the vehicle with those in `other`. With locked wheels the gear is neutral: drive_body would
 * take a torque that no wheel passes on to the road, for the wheels' own equations are left out. */
void equilibrium_exchange_gears(const Equilibrium *found, int32_t other[POWERTRAIN_DISCRETE]);

#endif
