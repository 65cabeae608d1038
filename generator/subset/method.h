/* SPDX-License-Identifier: MIT
 *
 * Choices between methods that users make. */
#ifndef SUBSET_METHOD_H
#define SUBSET_METHOD_H

/* The form of the equations of motion: reduced (Proposition 2.1 of Serban and Haug 2000); articulated, the same
 * equations eliminated along chains of bodies from their tips; augmented (their eq. 16). Auto: reduced or articulated,
 * whichever has fewer operations. A Plan never has auto. */
typedef enum Solve { SOLVE_AUTO, SOLVE_REDUCED, SOLVE_ARTICULATED, SOLVE_AUGMENTED, SOLVES } Solve;

/* The way to find a subset's poses: the one with fewer operations; Newton's iteration everywhere; a closed form
 * wherever there is one; as auto, with polynomials in place of Newton's iteration within the ranges of coordinates. */
typedef enum Recovery { RECOVERY_AUTO, RECOVERY_NEWTON, RECOVERY_CLOSED, RECOVERY_POLYNOMIAL, RECOVERIES } Recovery;

#endif
