/* SPDX-License-Identifier: MIT
 * Forces of the tires of TIRES.md, sections 5 and 6. */
#ifndef REFERENCE_TIRE_H
#define REFERENCE_TIRE_H

#include "dump.h"
#include "quad.h"

/* What a tire feels. load: N; deflection: of which only PAC2002's radii and TMeasy's contact length make use, m;
 * friction: of the road; forward: speed of the contact point along e_x, m/s; spin: rad/s. strain: by how much of
 * itself PAC2002's df_z is off, else 0. */
typedef struct TireInput {
    quad load, deflection, kappa, alpha, camber, friction, forward, spin, strain;
} TireInput;

/* N and N m about the contact point, along e_x, e_y and the normal. */
typedef struct TireForces {
    quad fx, fy, mx, my, mz;
} TireForces;

TireForces tire_forces(const Tire *tire, const TireInput *in);
/* Effective rolling radius, m. */
quad rolling_radius(const Tire *tire, quad deflection);
/* Lengths along e_x and e_y, m. */
void relaxation_lengths(const Tire *tire, const TireInput *in, quad length[2]);

#endif
