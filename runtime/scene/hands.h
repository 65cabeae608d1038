/* SPDX-License-Identifier: MIT
 *
 * Hands on the inputs: someone who drives by moving them to targets, from time to time, as a scene's driver does
 * (models/SCENE.md sections 5 and 14). Pages of gicrun --drive compile it; gicrun --replay moves the same hands. */
#ifndef SCENE_HANDS_H
#define SCENE_HANDS_H

#include "driver.h"

/* s that a movement takes. */
#define HANDS_REACH 0.1
/* s; times at which targets are looked at are the least multiple of the step that is not shorter. */
#define HANDS_PERIOD 0.02

typedef struct Hand {
    int input;   /* index in input[] */
    bool driven; /* a driven coordinate: rate and acceleration follow */
    Movement move;
} Hand;

/* The number of steps from one look at targets to the next; step: s. */
int hands_steps(double step);
/* Take the inputs over at `time`, moving as input[] does. */
void hands_take(Hand *hand, int count, double time, const double *input);
/* Move to targets, [count]. */
void hands_turn(Hand *hand, int count, double time, const double *target);
/* Write their values into input[]. */
void hands_inputs(const Hand *hand, int count, double time, double *input);
/* Give the inputs that a driver moves back to it; it looks for its path again. */
void hands_release(const Hand *hand, int count, Driver *driver);

#endif
