/* SPDX-License-Identifier: MIT
 *
 * What interpreted engines share: a mechanism in the world frame with Euler parameters, Serban and Haug 2000, section 2.
 * Generalized coordinates of a body are q = (r, p), 7 numbers: its centre of mass in the world and its Euler parameters;
 * generalized velocities q' = (r', p'). Vectors are world components unless said otherwise. No formula here comes from
 * the generator.
 *
 * A twist and an acceleration of a body are 6 numbers, r' and omega (r'' and omega'): with omega = 2 E(p) p' and
 * omega' = 2 E(p) p'', p^T p = 1, a row of derivatives by a twist becomes one by q' through world_columns(). gamma is the
 * same for both.
 *
 * Everything that an evaluation writes belongs to the World and is free between calls; what an instance must remember
 * belongs to the instance (interpreted.h). */
#ifndef WORLD_H
#define WORLD_H

#include "engine.h"

enum { BODY_Q = 7, ROW_J = 12, TIE_ROWS = 6 };

typedef struct Pose {
    double r[3], p[4], A[9];
} Pose;

typedef struct Twist {
    double v[3], omega[3];
} Twist;

/* A joint, or the definition of a dual coordinate Psi(w, q) = 0: rows of equations between two bodies. */
typedef struct Tie {
    int body[2], joint, coordinate; /* index in the model, or -1 */
    int rows, first;                /* equations, and the place of the first one among all */
    int parts;                      /* what it consists of; world.c */
    bool constraint;                /* a joint or a driven coordinate: has multipliers */
    double arm[2][3];               /* points from the centres of mass, body frames */
    double axis[2][3], side[2][3];  /* u_a, u_b; two directions perpendicular to u_a, in body a */
    double other[3];                /* second side, in body b; of an angle f_1 */
    double length, offset;
} Tie;

/* World components of a tie's vectors at the last evaluation: what gamma needs again. */
typedef struct TieVectors {
    double arm[2][3], d[3] /* from the first point to the second */, axis[2][3], side[2][3], other[3];
} TieVectors;

typedef struct World {
    const Model *model; /* assembled */
    const Sequence *sequence;
    int bodies, first;  /* first: 0 where the base moves, 1 where it is ground */
    int ties, rows;     /* joints in the order of the file, then coordinates; rows in the same order */
    const Tie *tie;     /* coordinate c is tie joints + c */
    double size;        /* largest distance of a tie's point from its body's centre of mass, at least 0.01 m */
    double *q_design;   /* [bodies][7] at the assembled design */

    /* what an evaluation starts from: world_load() */
    double time;
    const double *input, *parameter, *port;
    const gic_road *road;
    int32_t lane;

    /* configuration: engines fill it, body by body and coordinate by coordinate */
    Pose *pose;   /* [bodies] */
    Twist *twist; /* [bodies] */
    double *x, *xd, *xdd; /* [coordinates] */

    /* equations: world_rows(), world_gamma() */
    double *value;      /* [rows] Phi, Psi; m or 1 */
    double (*J)[ROW_J]; /* [rows] derivatives by the twists of both bodies: r', omega of the first, of the second */
    double *dual;       /* [coordinates] Psi_w */
    double *gamma;      /* [rows] J (accelerations) + Psi_w w'' = gamma */
    TieVectors *vectors; /* [ties] */

    /* applied forces: world_forces() */
    double (*wrench)[6];  /* [bodies] force at the centre of mass and torque about it */
    double *along;        /* [coordinates] generalized force on w */
    double *element;      /* [forces] Q or T of FORMAT.md section 7 */
    double (*wheel)[4];   /* [wheels] fz, deflection, deflection rate, road height */
    double potential, power; /* J of springs; W of springs, dampers, tires, loads and ports */

    /* solution: world_accelerate() */
    double (*acceleration)[6]; /* [bodies] */
    double *multiplier;        /* [rows] of constraints, else 0: M a + J^T multiplier = wrench */
    struct Accelerator *accelerator;
} World;

/* ---- world.c: kinematics ---------------------------------------------------------------------------------------- */

/* Everything that can be known before the first evaluation. model: assembled. */
World *world_new(Pool *pool, const Model *model, const Sequence *sequence);
/* Pose from q; p is taken as it is and must have unit length. */
void pose_set(Pose *pose, const double q[BODY_Q]);
void pose_get(const Pose *pose, double q[BODY_Q]);
/* Twist from q' = (r', p') and p; p' from omega. */
void twist_set(Twist *twist, const double p[4], const double qd[BODY_Q]);
void twist_get(const Twist *twist, const double p[4], double qd[BODY_Q]);
/* q += dq, p brought back to unit length. */
void pose_move(Pose *pose, const double dq[BODY_Q]);
/* 7 derivatives by q' of a row from its 6 by the twist: omega = 2 E p'. Multiples of p^T, which the normalization's row
 * has, are left out. */
void world_columns(const double J[6], const double p[4], double out[BODY_Q]);
/* Base from the state of FORMAT.md section 10 (e: of unit length): pose and twist of its centre of mass. */
void world_place_base(World *world, const double r[3], const double e[4], const double v[3],
                      const double omega_body[3]);

/* value of a tie's rows at the poses of its bodies and world->x; leaves its vectors. */
void world_values(World *world, int tie);
/* The same with J and dual. False on the wrong branch: half a turn from where the equations are meant to hold. */
bool world_rows(World *world, int tie);
/* gamma from the vectors of the last call of the above, twists and world->xd. */
void world_gamma(World *world, int tie);
/* J a of a row, a: [bodies][6] twists or accelerations. */
double world_product(const World *world, int tie, int row, const double (*a)[6]);
/* A dual coordinate as the explicit function of poses and twists: out = w, w'. An angle is the one nearest to `near`. */
void world_coordinate(World *world, int coordinate, double near, double out[2]);
/* Largest constraint residual at the present configuration, relative to world->size. */
double world_residual(World *world);

/* ---- applied.c: forces -------------------------------------------------------------------------------------------- */

/* wrench, along, element, wheel at the present configuration (poses, twists, x, xd); gravity is among the wrenches, and
 * so is -omega x J omega. Forces along coordinates are not: world_spread(). GIC_ERROR_ROAD where the road has no finite
 * height. */
int world_forces(World *world);
/* Forces along coordinates as wrenches on the bodies; needs J and dual of the coordinates' ties. */
void world_spread(World *world);
/* Inertia about the centre of mass in world axes, 9 numbers. */
void world_inertia(const World *world, int body, double out[9]);

/* ---- accelerate.c: equations of motion ---------------------------------------------------------------------------- */

/* Symbolic work, once. */
void world_open_accelerator(Pool *pool, World *world);
/* [M J^T; J 0] (a, multiplier) = (wrench, gamma), rows of joints and driven coordinates, then w'' of the free ones (Serban
 * and Haug 2000, equation 16). Needs J, dual and gamma of all ties, and xdd of driven coordinates. Returns
 * GIC_ERROR_SINGULAR where the constraints are dependent. */
int world_accelerate(World *world);

/* ---- interpreted_outputs.c ------------------------------------------------------------------------------------------ */

/* All components of all outputs at the present configuration and its accelerations. */
void world_outputs(World *world, double *out);
/* World poses of the body frames, 7 numbers a body; signs as FORMAT.md section 9 has them. */
void world_poses(const World *world, double *pose);
/* The largest constraint residual, balance of the equations of motion, and of energy: constraints do no work. symmetry
 * is 0 and smallest_pivot 1, for nothing here builds a mass matrix. */
void world_self_test(World *world, gic_self_test *result);

#endif
