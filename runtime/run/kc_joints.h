/* SPDX-License-Identifier: MIT
 *
 * kc_joints: what joints of an axle carry, and what holds its steering, over travel and steering (gicrun --kc
 * --joints), by the definitions of models/KC.md. */
#ifndef RUN_KC_JOINTS_H
#define RUN_KC_JOINTS_H

#include "run/kc_balance.h"

/* What makes the forces: springs, stops and formulas with the pads that hold them, N; then loads of kc_load_name in
 * phase and opposed, by a unit of the load on each wheel. */
enum { KC_BY_SPRINGS, KC_BY_LOADS, KC_CASES = 1 + 2 * KC_LOADS };
/* Its load, and whether the right side has the other sign, of one that is not KC_BY_SPRINGS. */
KcLoad kc_case_load(int by);
bool kc_case_opposed(int by);

/* On the second body of a joint or bushing: force in the axes of the world, torque about its point. along: the tension
 * of a rod between two points; of the coordinate that steers, in place of the rest, what holds it, along itself. NAN:
 * it has no such number. */
typedef struct KcCarried {
    double force[3], torque[3], along;
} KcCarried;

typedef struct KcJoints {
    const Kc *kc;
    const Model *model;   /* held at its base, all coordinates driven; inputs for elements, ports for wheels */
    const Engine *engine; /* its outputs: reactions, ends of rods, forces that drive coordinates */
    const Linear *linear;
    Instance *self;
    int element, drive, port; /* the first input of elements, output of drives, port of wheels */
    int *mount;               /* [bushings][2] port of what a bushing exerts on a body; -1: that is the ground */
    int *rod;                 /* [joints] place among outputs of both ends of a rod; -1: it is none */
    const char **name;        /* [joints] */
    int joints, reactions;    /* joints of the model, which come first, and bushings; joints alone */
    KcBalance **balance;      /* [axles] NULL: the axle can not be moved */
    double *value;            /* [outputs] at the place */
    double *f, *df, *out, *by_element, *by_wheel, *by_mount, *by_place, *acting; /* work */
} KcJoints;

KcJoints *kc_joints_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const Kc *kc);
/* Why nothing is known of the joints of an axle that can be moved; NULL: it is. */
const char *kc_joints_refusal(const KcJoints *joints, const KcAxle *axle);
/* What joints and the steering of an axle carry at coordinates w, from which an axle on rubber settles: carried
 * [KC_CASES][joints + 1], the last one the steering. Cases without a value are NAN. Returns NULL, or why nothing is
 * known there. */
const char *kc_joints_at(const KcJoints *joints, const KcAxle *axle, const double *w, KcCarried *carried);
/* Does a load reach joint j at a position? */
bool kc_joint_seen(const KcJoints *joints, const KcCarried *carried, int j);
/* The name of joint j, or of the axle's steering. */
const char *kc_joint_name(const KcJoints *joints, const KcAxle *axle, int j);
/* kc_joints_report.c: of all axles, in the positions of a study; those at set-up alone unless request->report or
 * request->results asks for more. Ends in diag_fail where nothing is known of any axle. */
typedef struct KcCarrying KcCarrying;
const KcCarrying *kc_carrying(Pool *pool, const Model *model, const Scene *scene, const Request *request,
                              const KcStudy *study);
/* At set-up, as numbers with names. */
struct Sheet kc_carrying_sheet(const KcCarrying *carrying, const Model *model);
/* What joint j carries in all rows of a motion, y [rows], N or N m, by the case `drawn` of those that pages draw; NAN
 * where no load reaches it. Returns its name, with the case's title and the unit; NULL: there is no such joint or
 * motion. */
enum { KC_CASES_DRAWN = 6 };
const char *kc_carrying_curve(const KcCarrying *carrying, int axle, KcMotion motion, int drawn, int j, double *y,
                              const char **title, const char **unit);
/* --kc --joints: a table at set-up, CSV of all positions, a page of curves; or two models beside each other at set-up.
 */
void kc_joints_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);

#endif
