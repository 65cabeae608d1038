/* SPDX-License-Identifier: MIT
 *
 * What inputs do over time: profiles of scenes (models/SCENE.md section 4), and movements of drivers (section 5). It
 * needs the runtime core alone, so that pages of gicrun --drive compile it too. */
#ifndef SCENE_PROFILE_FORM_H
#define SCENE_PROFILE_FORM_H

#include <stdbool.h>

typedef struct Law Law;     /* model/model.h */
typedef struct Model Model; /* the same */

typedef enum ProfileForm {
    PROFILE_KNOTS, /* quintics from rest to rest at each knot; one knot: constant */
    PROFILE_SINE,
    PROFILE_CURVE, /* pieces through values, rates and accelerations */
    PROFILE_CHIRP,
    PROFILE_FORMULA
} ProfileForm;

typedef struct Profile {
    int input;    /* index in input[] */
    double begin; /* s: all its times count from here */
    bool driven;  /* rate and acceleration follow */
    bool post;    /* its rate follows: the height of a post */
    const char *unit;
    ProfileForm form;
    int count; /* of knots, and of points of a curve */
    double *time, *value;
    /* curve: rates and accelerations at its points, quintic between them; acceleration NULL: cubic */
    double *rate, *acceleration;
    bool sampled; /* curve: its points are samples, at which variable steps need not end */
    double amplitude, frequency, offset, start;
    double end, last; /* chirp: when it ends, s; its frequency then, Hz */
    double until;     /* end of the scene, s; 0: not known */
    bool logarithmic; /* chirp: the frequency grows by the same factor in equal times */
    const Law *law;   /* formula, of time (local 0) */
    const Model *model;
} Profile;

/* Value, rate and acceleration. */
void profile_at(const Profile *profile, double time, double out[3]);
/* The same of every form but a formula, which is left as it is. */
void profile_form_at(const Profile *profile, double time, double out[3]);
/* The interval between points k and k + 1 that `time` is in, from 0 to count - 2; count >= 2. At a point: the one
 * before. */
int profile_interval(const Profile *profile, double time);

/* A polynomial of degree 7 in time that starts at `start` and ends at rest after `duration`, s; before it at c[0],
 * after it at `end`. */
typedef struct Movement {
    double start, duration, end, c[8];
} Movement;

/* Value, rate, acceleration and jerk. */
void movement_at(const Movement *m, double time, double out[4]);
/* From the value, rate, acceleration and jerk at `time` to rest at `end` after `duration`. */
void movement_turn(Movement *m, double time, double end, double duration);
/* The same from given ones. */
void movement_from(Movement *m, double time, const double now[4], double end, double duration);
/* At rest at a value. */
Movement movement_rest(double value);

#endif
