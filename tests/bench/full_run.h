/* SPDX-License-Identifier: MIT
 * What fleet.c and single.c share: inputs of models/scenes/full_run.scene, with VEHICLES pedals; and time. Behind a
 * header of the model. */
#ifndef FULL_RUN_H
#define FULL_RUN_H

#include <time.h>

static gic_real between_knots(gic_real t, const gic_real *time, const gic_real *value, int count)
{
    int i;
    if (t <= time[0])
        return value[0];
    for (i = 1; i < count; ++i)
        if (t <= time[i])
            return value[i - 1] + (value[i] - value[i - 1]) * (t - time[i - 1]) / (time[i] - time[i - 1]);
    return value[count - 1];
}

static void drive(void *user, int32_t lane, gic_real time, gic_real *input)
{
    static const gic_real brake_time[] = {0.2, 0.6}, brake[] = {0.3, 0};
    static const gic_real pedal_time[] = {0.5, 2, 12, 13, 15.5, 17, 26, 27.5};
    static const gic_real pedal[] = {0, 0.9, 0.9, 0, 0, 0.8, 0.8, 0.3};
    static const gic_real rack_time[] = {3, 4.5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 23.5, 26, 28};
    static const gic_real rack[] = {0,      -0.012, -0.012, 0.011, 0.011, 0,      -0.024,
                                    -0.024, 0,      0,      0.01,  0.01,  -0.008, -0.008};
    const gic_real ahead = (gic_real)1e-3;
    (void)user;
    input[HMMWV_VEHICLE_INPUT_BRAKE] = between_knots(time, brake_time, brake, 2);
    input[HMMWV_VEHICLE_INPUT_ACCELERATOR] =
        (1 - (gic_real)lane / (10 * VEHICLES)) * between_knots(time, pedal_time, pedal, 8);
    input[HMMWV_VEHICLE_INPUT_SELECTOR] = 1;
    input[HMMWV_VEHICLE_INPUT_RACK] = between_knots(time, rack_time, rack, 14);
    input[HMMWV_VEHICLE_INPUT_RACK + 1] =
        (between_knots(time + ahead, rack_time, rack, 14) - input[HMMWV_VEHICLE_INPUT_RACK]) / ahead;
    input[HMMWV_VEHICLE_INPUT_RACK + 2] = 0;
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int rising(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
