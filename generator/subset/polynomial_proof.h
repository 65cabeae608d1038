/* SPDX-License-Identifier: MIT
 *
 * polynomial_proof.c: that polynomials are within their bound everywhere. */
#ifndef SUBSET_POLYNOMIAL_PROOF_H
#define SUBSET_POLYNOMIAL_PROOF_H

#include "subset/exact_motion.h"

/* Kinds of numbers, which have a scale in common: angular and linear parts of S, of alpha and acceleration. */
enum { KIND_PLACE = 0, KIND_ROTATION, KIND_TURN, KIND_GLIDE, KIND_ALPHA, KIND_ACCELERATION, KINDS };

/* Prove that motions of polynomials are within their bound of the exact ones over the range of each member, relative to
 * these scales [KINDS]; sets `most` and `intervals`. NULL, or why that can't be proved. */
const char *polynomial_prove(const Work *w, const Formula *formula, Polynomial *polynomial, Exact *exact,
                             const double *scale);

#endif
