/* SPDX-License-Identifier: MIT
 * Constraint equations and forces of the whole mechanism in world-frame Cartesian coordinates with Euler parameters
 * (FORMAT.md sections 4, 5, 7, 8). q of a body is (centre of mass, e0..e3), 7 numbers. */
#ifndef REFERENCE_MECHANISM_H
#define REFERENCE_MECHANISM_H

#include "dump.h"
#include "quad.h"

enum { BODY_COORDINATES = 7 };

/* q[body][7] with its rate, w[coordinate] with its rate; the bodies' order is the dump's. */
typedef struct Configuration {
    quad (*q)[BODY_COORDINATES], (*rate)[BODY_COORDINATES];
    quad *w, *w_rate;
} Configuration;

Configuration *configuration_new(const Model *model);
void configuration_free(Configuration *configuration);
void configuration_copy(const Model *model, Configuration *to, const Configuration *from);

/* One scalar equation c(q, w) = 0 of a joint or dual coordinate. */
typedef struct Row {
    int body[2];
    quad slope[2][BODY_COORDINATES]; /* dc/dq of the two bodies */
    int coordinate;                  /* whose definition it is, or -1 */
    quad w_slope;                    /* dc/dw, of a gear or coupler by what its formula gives */
    const Formula *follows;          /* that formula, or NULL */
    quad value;                      /* c */
    quad rate;                       /* dc/dt with the configuration's rates */
    quad bias;                       /* d2c/dt2 where all second derivatives of q and w are zero */
} Row;

/* Number of rows: the joints' first, then one a coordinate. */
int row_count(const Model *model);
/* First row of a joint; joint = model->joints: of coordinate 0. */
int joint_row(const Model *model, int joint);
void rows_evaluate(const Model *model, const Configuration *configuration, Row *rows);

/* A road z = amplitude sin(2 pi (x - x0) / wavelength + phase_per_y y); amplitude 0: flat. Its friction is 1 but for
 * one patch of it (SCENE.md section 3.4); fade 0: none. */
typedef struct Road {
    double amplitude, wavelength, x0, phase_per_y;
    double x[2], y[2], friction, fade;
} Road;

/* A point given in the frame of a body (FORMAT.md), relative to its centre of mass. */
void from_com(const Model *model, int body, const double point[3], quad out[3]);
/* Add to Q[body][7] the generalized force of a force F (world) at a point of the body (relative to its com). */
void add_force(const Configuration *configuration, int body, const quad point[3], const quad F[3],
               quad (*Q)[BODY_COORDINATES]);
/* The same of a torque (world) on the body. */
void add_torque(const Configuration *configuration, int body, const quad torque[3], quad (*Q)[BODY_COORDINATES]);
/* Derivative of a formula of coordinates by one of them. */
quad law_slope(const Model *model, const Configuration *configuration, const Formula *law, int coordinate);
/* A formula at a configuration; NULL: 0. */
quad law_value(const Model *model, const Configuration *configuration, const Formula *law, Locals local);
/* The sum of magnitudes of its terms. */
quad law_size(const Model *model, const Configuration *configuration, const Formula *law, Locals local);
/* Place and velocity of a point of a body, or of a point of the ground. */
void point_motion(const Model *model, const Configuration *configuration, int body, const double point[3], quad x[3],
                  quad v[3]);
/* Displacements and rotations of a bushing in its axes, and their rates. */
void bushing_strain(const Model *model, const Configuration *configuration, int force, quad x[6], quad rate[6]);
/* Cosine of its rotation. */
quad bushing_cosine(const Configuration *configuration, const Force *force);
/* Q or T of an element that is no load (FORMAT.md section 7). */
quad element_value(const Model *model, const Configuration *configuration, int force);
/* Length, angle or coordinate along which a force element acts, and its rate. Not for loads. */
void element_extension(const Model *model, const Configuration *configuration, int force, quad *value, quad *rate);
/* Add the generalized force of one force element. `rows` are those of the same configuration. */
void add_force_element(const Model *model, const Configuration *configuration, const Row *rows, int force,
                       quad (*Q)[BODY_COORDINATES]);

#endif
