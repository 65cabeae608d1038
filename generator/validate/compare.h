/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of generator/validate that compare: validate.h. */
#ifndef VALIDATE_COMPARE_H
#define VALIDATE_COMPARE_H

#include "model/model.h"
#include "validate/play.h"
#include "validate/run.h"
#include "validate/validate_private.h"
#include "world/world.h"

/* Kinds of comparison, each with a largest difference, relative to the magnitudes of the terms. */
typedef enum Kind {
    KIND_ROTATION,
    KIND_POSE,
    KIND_VELOCITY,
    KIND_PARTIAL,
    KIND_ACCELERATION,
    KIND_MOTION,
    KIND_RATE,
    KIND_FAST,
    KIND_WHEEL,
    KIND_OUTPUT,
    KIND_POSES,
    KIND_REACTION,
    KIND_ATTITUDE,
    KIND_INVERSE,
    KIND_ENERGY,
    KIND_SHIFT,
    KIND_FOLLOW,
    KIND_SCENE,
    KIND_SCENE_OUTPUT,
    KINDS
} Kind;

/* The largest difference of a kind, as a share of the allowed one. */
typedef struct Finding {
    double share;
    Kind kind;
    const char *what;    /* the joint, coordinate or output */
    double value, scale; /* the difference, and the magnitude it is relative to */
    int state;
} Finding;

typedef struct Comparison {
    Validator v;
    World *world;
    Run *scene;  /* code for a scene at the same states; NULL: none */
    Values *acc; /* [unknowns] for the self-test's equations of motion */
    bool self_test;
    int k;     /* column */
    int index; /* of the state */
    double *input, *parameter, *port, *fast, *out, *pose;
    int32_t gear[POWERTRAIN_DISCRETE];
    const char **state_name;          /* [states] */
    double (*twist)[6];               /* [bodies] r', omega of unit rates */
    double speed, swing, push, watts; /* largest velocity, acceleration, force and sum of powers: differences below
                                       * their rounding do not count */
    Finding worst[KINDS];
    int compared, left;
    const char *refused, *where; /* the first state that was skipped: status and block */
} Comparison;

/* validate.c: record a difference if it is the largest of its kind relative to the allowed one. */
void compare(Comparison *c, Kind which, const char *what, double difference, double scale);

/* compare_motion.c: bodies in the world (m, rad, s), at column c->k. The base; another body: its pose and velocity from
 * its motion relative to the base, of the centre of mass. */
void compare_place_base(Comparison *c);
void compare_place_body(Comparison *c, int b);
/* Position and velocity of the base's origin. */
void compare_base_origin(const Comparison *c, double r[3], double v[3]);
/* Three numbers of a body's motion, in the base's frame, from `number` on (MOTION_...). */
void compare_motion3(const Comparison *c, int body, int number, double out[3]);
/* The derivative of body b's generalized coordinates from the velocity of its centre of mass and its angular velocity.
 */
void compare_set_rate(World *world, int b, const double v[3], const double omega[3], double (*rate)[BODY_Q]);
/* Add to `out` angular velocity and velocity (in the base's frame) that body b gets where the j-th coordinate of the
 * subset of body `from`, which carries b or is it, has that rate and no other. */
void compare_add_unit_motion(const Comparison *c, int b, int from, int j, double rate, double out[6]);
/* Accelerations of all bodies from those of the base's origin (world), its rotation (base's frame) and world->xdd. */
void compare_accelerate(Comparison *c, const double a[3], const double own_alpha[3]);

/* compare.c: compare column c->k of c->v.run with the World. False: only forces, which are not finite, were not
 * compared. */
bool compare_state(Comparison *c);
/* Compare an output's components at column c->k with given values; after compare_state(). */
void compare_output(Comparison *c, Kind which, const Output *output, Values *given, const double *right);
/* Name of an unknown of the equations of motion. */
const char *unknown_name(const Comparison *c, int unknown);

#endif
