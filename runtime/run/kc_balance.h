/* SPDX-License-Identifier: MIT
 *
 * kc_balance: an axle whose contacts are held at their heights settles where its force elements, bushings among them,
 * balance, and what a unit of a load changes there. For compliance and for what joints carry (models/KC.md, section
 * 5). */
#ifndef RUN_KC_BALANCE_H
#define RUN_KC_BALANCE_H

#include "run/kc.h"

enum { KC_BALANCE = KC_COLUMNS + KC_WHEELS };

typedef struct KcBalance {
    const Kc *kc;
    const KcAxle *axle;
    KcLook *look;                      /* its columns are the coordinates that move; at the place where it settled */
    double *w;                         /* [coordinates] that place */
    int m, n;                          /* coordinates that move, wheels */
    double force[KC_WHEELS];           /* of the pads, N, up */
    double z[KC_WHEELS];               /* heights of the contacts, m, held */
    double A[KC_BALANCE * KC_BALANCE]; /* rows and columns: coordinates, then forces */
    double missing[KC_BALANCE];
    KcPose pose[KC_WHEELS], by[KC_COLUMNS][KC_WHEELS]; /* poses of the wheels; their rates by each coordinate */
    double *second;                                    /* work */
} KcBalance;

/* What moves: the coordinates of travel, and with `others` all that are free and move a wheel of the axle, but for
 * coordinate `held` (-1: none). */
KcBalance *kc_balance_new(const Kc *kc, const KcAxle *axle, bool others, int held);
/* Settle from coordinates w [coordinates], with the contacts at the heights that they have there. Returns NULL, or why
 * there is no balance. */
const char *kc_balance_at(KcBalance *balance, const double *w);
/* By a unit of a load, N or N m, on each wheel (opposed: the other way on the right), where the axle has settled:
 * change [m + n] of the coordinates that move and of the pads' forces. floats: forces of pads are given in place of
 * heights; they grow by a vertical load. Returns NULL, or why there is none. */
const char *kc_balance_give(const KcBalance *balance, KcLoad load, bool opposed, bool floats, double *change);

#endif
