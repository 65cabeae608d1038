/* SPDX-License-Identifier: MIT
 *
 * What the files that compare share: generator/validate.h. */
#ifndef VALIDATE_COMPARE_H
#define VALIDATE_COMPARE_H

#include "../runtime/world.h"

#include "validate_work.h"

/* What is compared, and how large a difference may be, relative to the magnitudes that went into it. */
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

/* The worst that was found, in shares of what is allowed. */
typedef struct Finding {
    double share;
    Kind kind;
    const char *what;    /* which joint, coordinate, output */
    double value, scale; /* the difference, what it is relative to */
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
    double speed, swing, push, watts; /* largest velocity, acceleration, force, sum of powers: below their rounding
                                         nothing counts */
    Finding worst[KINDS];
    int compared, left;
    const char *refused, *where; /* the first state that was left out */
} Comparison;

/* validate.c: remember a difference where it is the largest of its kind, relative to what is allowed. */
void compare(Comparison *c, Kind which, const char *what, double difference, double scale);

/* validate_compare.c: column c->k of c->v.run against the World. False: but for forces, which are no finite numbers
 * there. */
bool compare_state(Comparison *c);
/* An output's components against what is right, at column c->k, after compare_state(). */
void compare_output(Comparison *c, Kind which, const Output *output, Values *given, const double *right);
/* Name of an unknown of the equations of motion. */
const char *unknown_name(const Comparison *c, int unknown);

#endif
