/* SPDX-License-Identifier: MIT
 * Hands on the inputs. Pages of gicrun --drive compile this file too. */
#include "hands.h"

#include <math.h>
#include <string.h>

int hands_steps(double step)
{
    return (int)fmax(ceil(HANDS_PERIOD / step - 1e-9), 1);
}

void hands_take(Hand *hand, int count, double time, const double *input)
{
    for (int i = 0; i < count; ++i) {
        const double *value = input + hand[i].input;
        const double now[4] = {value[0], hand[i].driven ? value[1] : 0, hand[i].driven ? value[2] : 0, 0};
        movement_from(&hand[i].move, time, now, value[0], HANDS_REACH);
    }
}

void hands_turn(Hand *hand, int count, double time, const double *target)
{
    for (int i = 0; i < count; ++i)
        movement_turn(&hand[i].move, time, target[i], HANDS_REACH);
}

void hands_inputs(const Hand *hand, int count, double time, double *input)
{
    for (int i = 0; i < count; ++i) {
        double out[4];
        movement_at(&hand[i].move, time, out);
        memcpy(input + hand[i].input, out, (hand[i].driven ? 3 : 1) * sizeof *out);
    }
}

void hands_release(const Hand *hand, int count, Driver *driver)
{
    driver->speed_sum = driver->curvature_sum = 0;
    driver->seen = false;
    for (int i = 0; i < count; ++i) {
        if (hand[i].input == driver->accelerator)
            driver->pedal[0] = hand[i].move;
        if (hand[i].input == driver->brake)
            driver->pedal[1] = hand[i].move;
        if (hand[i].input == driver->steering)
            driver->wheel = hand[i].move;
    }
}
