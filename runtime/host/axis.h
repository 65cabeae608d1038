/* SPDX-License-Identifier: MIT
 *
 * axis: colours of curves, and numbers along axes. */
#ifndef HOST_AXIS_H
#define HOST_AXIS_H

/* Colours after Okabe and Ito, dark enough for a white ground; colour-blind people tell them apart, as test_inks.sh
 * computes. The pages of --animate and --drive have the same (templates/animate_ink.js.in). */
enum { AXIS_INKS = 7 };
/* Of a curve, from 0; they repeat. */
const char *axis_ink(int curve);

/* 1, 2 or 5 times a power of ten: the smallest that is not below x > 0. */
double axis_step(double x);

/* Significant digits that tell numbers apart which are a twentieth of the range from each other: 6 to 15. */
int axis_digits(double low, double high);

#endif
