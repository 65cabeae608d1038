/* SPDX-License-Identifier: MIT
 * A four-bar linkage, model `four`, against its closed solution: hinges along y at (0, 0, 0) and (GROUND, 0, 0), crank
 * of length CRANK, coupler COUPLER, rocker ROCKER, crank drawn upright; the angle between ends given as arguments and
 * beyond them by a tenth of the range. Prints the largest difference of places of the coupler's ends (m), of its
 * outputs' velocity by the coordinate's rate (m/s at 1 rad/s), and the number of angles. */
#include "four.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double ground = GROUND, crank = CRANK, coupler = COUPLER, rocker = ROCKER;

/* The pin between coupler and rocker: x, z; the crank turned by w about y from upright. */
static void closed(double w, double pin[2])
{
    const double a[2] = {crank * sin(w), crank * cos(w)}, d[2] = {ground - a[0], -a[1]}, r = hypot(d[0], d[1]);
    const double along = (coupler * coupler - rocker * rocker + r * r) / (2 * r);
    const double across = sqrt(coupler * coupler - along * along);
    pin[0] = a[0] + (along * d[0] - across * d[1]) / r;
    pin[1] = a[1] + (along * d[1] + across * d[0]) / r;
}

int main(int count, char **word)
{
    static four model;
    const double low = atof(word[1]), high = atof(word[2]), more = (high - low) / 10, step = 1e-5;
    double worst = 0, speed = 0, pin[2], before[2], after[2];
    int angles = 0;
    if (count != 3 || four_setup(&model))
        return 1;
    for (int round = 0; round < 2; ++round)
        for (int i = -10; i <= 110; ++i, ++angles) {
            const double w = round ? high - (high - low) / 100 * i : low + more * i / 10;
            model.state[FOUR_STATE_ANGLE] = w;
            model.state[FOUR_STATE_ANGLE_RATE] = 1;
            const int status = four_outputs(&model);
            if (status) {
                fprintf(stderr, "status %d at %g\n", status, w);
                return 1;
            }
            closed(w, pin);
            closed(w - step, before);
            closed(w + step, after);
            worst = fmax(worst, fabs(model.output[FOUR_OUTPUT_PIN_X] - pin[0]));
            worst = fmax(worst, fabs(model.output[FOUR_OUTPUT_PIN_Y]));
            worst = fmax(worst, fabs(model.output[FOUR_OUTPUT_PIN_Z] - pin[1]));
            speed = fmax(speed, fabs(model.output[FOUR_OUTPUT_SPEED_X] - (after[0] - before[0]) / (2 * step)));
            speed = fmax(speed, fabs(model.output[FOUR_OUTPUT_SPEED_Z] - (after[1] - before[1]) / (2 * step)));
        }
    printf("%.2g %.2g %d\n", worst, speed, angles);
    return 0;
}
