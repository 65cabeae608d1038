/* SPDX-License-Identifier: MIT
 *
 * Wheels with tires: contact with the road, slip, brake and the wheel's own equation (models/TIRES.md sections 3 and
 * 4), for interpreted engines. Vectors are world components; no formula here comes from the generator. */
#ifndef WORLD_WHEEL_H
#define WORLD_WHEEL_H

#include "gic_runtime.h"
#include "model/model.h"
#include "world/tire.h"

/* All that the multibody system moves a wheel by. Numbers alone: it is a row of what dual rate interpolates. */
typedef struct WheelMotion {
    double center[3], velocity[3], axis[3], omega[3]; /* c, v of that point of the carrier, s, its angular velocity */
    double drive_turn;                                /* s . omega of the body that takes the drive's reaction */
} WheelMotion;

enum { MOTION_NUMBERS = sizeof(WheelMotion) / sizeof(double) };

/* Where the wheel is: a road (NULL: flat), and the instance's lane and time that it is asked with. */
typedef struct Ground {
    const gic_road *road;
    int32_t lane;
    double time;
} Ground;

/* The wheel at one moment. */
typedef struct Rolling {
    /* contact */
    double point[3], height;               /* P; h at g */
    double forward[3], left[3], normal[3]; /* e_x, e_y, n */
    double camber, deflection, deflection_rate, fade, fz, friction;
    double elastic, damping; /* N, F_e and c f rho', whose sum fz is where it pushes */
    /* slip; rolling_radius: R_e */
    double speed[2], rolling_radius, kappa, alpha;
    /* forces on the wheel at the contact point, torques on it about its axis */
    TireForces tire;
    double about, drive, brake; /* s . M, torque of the drive, T_b */
    /* on the carrier: force at c, torque; on drive_body: torque */
    double force[3], torque[3], reaction[3];
    double power; /* W, of tire, brake and drive */
} Rolling;

/* Contact alone: what depends on the motion of the carrier. GIC_ERROR_ROAD where the road has no finite height or
 * friction. */
int wheel_touch(const Wheel *wheel, const Tire *tire, const Ground *ground, const WheelMotion *motion, Rolling *out);
/* Slip, forces and the rates of the wheel's fast states, after wheel_touch(). drive and brake: values of the wheel's
 * formulas, N m. */
void wheel_turn(const Wheel *wheel, const Tire *tire, const WheelMotion *motion, double drive, double brake,
                const double *fast, double *rate, Rolling *out);
/* Another torque of the drive than wheel_turn() was called with; the rate of `spin` is the caller's then. */
void wheel_drive(const WheelMotion *motion, double spin, double drive, Rolling *out);
/* The fast states of a wheel that rolls, after wheel_touch(). */
void wheel_roll(const Wheel *wheel, const Tire *tire, const Rolling *rolling, double *fast);

#endif
