/* SPDX-License-Identifier: MIT
 *
 * Equations of gears and couplers as functions of q alone: the free coordinates that they follow are explicit functions
 * of q, so that their derivatives by q concern the bodies of these, too. */
#ifndef COMPARE_COUPLED_H
#define COMPARE_COUPLED_H

#include "world/world.h"

/* The equation of one of them. */
typedef struct CoupledRow {
    int tie, bodies, *body;
    double (*J)[BODY_Q]; /* [bodies] derivatives by q */
} CoupledRow;

typedef struct CoupledRows {
    int rows;
    CoupledRow *row;
} CoupledRows;

CoupledRows coupled_rows_new(Pool *pool, const World *world);
/* Values and rates of the free coordinates that they follow, from q and q'; angles are the ones nearest to `near`. */
void coupled_rows_place(const CoupledRows *rows, World *world, const double *near);
/* J of all of them, after their ties' rows and coupled_rows_place(). */
void coupled_rows_differentiate(const CoupledRows *rows, const World *world);

#endif
