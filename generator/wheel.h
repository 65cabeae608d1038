/* SPDX-License-Identifier: MIT
 *
 * What wheels ask of tires: models/TIRES.md sections 5 and 6, in expressions. */
#ifndef WHEEL_H
#define WHEEL_H

#include "gicgen.h"
#include "tire.h"

/* Arrays within a wheel's function. hub: what the contact hands on to the tire and to the balance of the wheel; world
 * components, contact axes e_x, e_y, n as in TIRES.md section 3. */
enum {
    HUB_LOAD, /* Fz */
    HUB_KAPPA,
    HUB_TANGENT, /* tan alpha */
    HUB_CAMBER,
    HUB_FRICTION,
    HUB_SPEED, /* V_x */
    HUB_DEFLECTION,
    HUB_RADIUS, /* loaded */
    HUB_X,      /* e_x */
    HUB_Y = HUB_X + 3,
    HUB_N = HUB_Y + 3,
    HUB_ARM = HUB_N + 3, /* P - c */
    HUB_NUMBERS = HUB_ARM + 3
};

/* What a tire computes its forces from, as seen on its own side: Fz > 0, kappa, tan alpha, gamma, mu_r, V_x, Omega, rho
 * and the loaded radius. */
typedef struct Rolling {
    Ex load, kappa, tangent, camber, friction, speed, spin, deflection, radius;
} Rolling;

/* force: forces, N, and moments about the contact point, N m, along the axes of the contact. */
enum { TIRE_FX, TIRE_FY, TIRE_MX, TIRE_MY, TIRE_MZ, TIRE_FORCES };

void pac2002_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES]);
/* Relaxation lengths along x and y as they follow from the load and the camber, m. */
void pac2002_relaxation(Dag *dag, const Tire *tire, Ex load, Ex camber, Ex length[2]);
/* Effective rolling radius, m. */
Ex pac2002_radius(Dag *dag, const Tire *tire, Ex deflection);

void tmeasy_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES]);
Ex tmeasy_radius(Dag *dag, const Tire *tire, Ex loaded);

/* ---- wheel.c: what the powertrain shares ---- */

/* Formulas at fast steps: free coordinates that they read come with the link. */
typedef struct Linking {
    Whole *whole;    /* of the link */
    Whole *formulas; /* of the formulas */
    Wheels *wheels;
    int *place[2]; /* [coordinates] of values and of rates in the link, 0: not there, for a wheel's centre is */
} Linking;

Ex fast_law(Linking *l, const Law *law, const Ex *local);
Ex positive_part(Dag *dag, Ex x);
/* S(s): 0 for s <= 0, 1 for s >= 1. */
Ex smooth_step(Dag *dag, Ex s);

/* powertrain.c: the blocks of the model's powertrain. */
void powertrain_formulate(Pool *pool, Linking *l);

#endif
