/* SPDX-License-Identifier: MIT
 *
 * Forces and moments of tires (models/TIRES.md sections 5 and 6) in plain numbers, for interpreted engines. No formula
 * here comes from the generator. */
#ifndef WORLD_TIRE_H
#define WORLD_TIRE_H

#include "model/model.h"

/* What a tire is exposed to; alpha and camber as its own side has them. */
typedef struct TireMotion {
    double fz, kappa, alpha, camber; /* N, 1, rad, rad */
    double friction;                 /* of the road */
    double deflection, speed, spin;  /* m; V_x, m/s; Omega, rad/s */
} TireMotion;

/* N and N m about the contact point, along e_x, e_y, n. */
typedef struct TireForces {
    double fx, fy, mx, my, mz;
} TireForces;

/* R_e, m, at a deflection (m, negative in the air). */
double tire_rolling_radius(const Tire *tire, double deflection);
/* sigma_x and sigma_y, m, at a load (N) and camber (rad, as the tire's own side has it). */
void tire_relaxation(const Tire *tire, double fz, double camber, double sigma[2]);
TireForces tire_forces(const Tire *tire, const TireMotion *motion);

#endif
