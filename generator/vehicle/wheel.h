/* SPDX-License-Identifier: MIT
 *
 * The interface between wheels and tire models: models/TIRES.md sections 5 and 6, in expressions. */
#ifndef VEHICLE_WHEEL_H
#define VEHICLE_WHEEL_H

#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/vehicle.h"

/* Arrays within a wheel's function. contact[]: results of the contact block for the tire and for the balance of the
 * wheel; world components, contact axes e_x, e_y, n as in TIRES.md section 3. */
enum {
    CONTACT_LOAD, /* Fz */
    CONTACT_KAPPA,
    CONTACT_TANGENT, /* tan alpha */
    CONTACT_CAMBER,
    CONTACT_FRICTION,
    CONTACT_SPEED, /* V_x */
    CONTACT_DEFLECTION,
    CONTACT_RADIUS, /* loaded radius */
    CONTACT_X,      /* e_x */
    CONTACT_Y = CONTACT_X + 3,
    CONTACT_N = CONTACT_Y + 3,
    CONTACT_ARM = CONTACT_N + 3, /* P - c */
    CONTACT_NUMBERS = CONTACT_ARM + 3
};

/* Inputs of a tire's formulas, seen on its own side: Fz > 0, kappa, tan alpha, gamma, mu_r, V_x, Omega, rho and the
 * loaded radius. */
typedef struct Rolling {
    Ex load, kappa, tangent, camber, friction, speed, spin, deflection, radius;
} Rolling;

/* force[]: forces, N, and moments about the contact point, N m, along the contact axes. */
enum { TIRE_FX, TIRE_FY, TIRE_MX, TIRE_MY, TIRE_MZ, TIRE_FORCES };

void pac2002_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES]);
/* Relaxation lengths along x and y for load and camber, m. */
void pac2002_relaxation(Dag *dag, const Tire *tire, Ex load, Ex camber, Ex length[2]);
/* Effective rolling radius, m. */
Ex pac2002_radius(Dag *dag, const Tire *tire, Ex deflection);

void tmeasy_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES]);
Ex tmeasy_radius(Dag *dag, const Tire *tire, Ex loaded);

/* ---- wheel.c: what the powertrain shares ---- */

/* Formulas evaluated at fast steps: the free coordinates and components of outputs that they read are part of link[].
 */
typedef struct Linking {
    Whole *whole;    /* makes link[] */
    Whole *formulas; /* makes the formulas */
    Wheels *wheels;
    bool *there[2]; /* [coordinates] values, rates that are in link[] */
    Ex *linked;     /* [signals] as `formulas` reads them; 0: not there yet */
} Linking;

Ex fast_law(Linking *l, const Law *law, const Ex *local);
Ex positive_part(Dag *dag, Ex x);
/* S(s): 0 for s <= 0, 1 for s >= 1. */
Ex smooth_step(Dag *dag, Ex s);

/* powertrain.c: the blocks of the model's powertrain. */
void powertrain_formulate(Pool *pool, Linking *l);

#endif
