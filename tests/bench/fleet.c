/* SPDX-License-Identifier: MIT
 * fleet.sh compiles it: complete vehicles in a batch against the same vehicles one by one, by turns in one process. The
 * inputs are those of models/scenes/full_run.scene, with a pedal of its own for each vehicle. */
#include "hmmwv_vehicle_batch.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { VEHICLES = HMMWV_VEHICLE_VEHICLES, ROUNDS = 50, STEPS = 100 }; /* 50 times 100 steps of 6 ms: 30 s */

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

static hmmwv_vehicle car[VEHICLES], copy;

int main(void)
{
    hmmwv_vehicle_batch *batch = aligned_alloc(hmmwv_vehicle_batch_model.alignment, hmmwv_vehicle_batch_model.size);
    const gic_real step = (gic_real)0.006;
    double ratio[ROUNDS], alone = 0, together = 0, worst[2] = {0, 0};
    int i, k, r, s, good = 0;
    if (!batch)
        return 1;
    hmmwv_vehicle_batch_setup(batch);
    for (i = 0; i < VEHICLES; ++i) {
        if (hmmwv_vehicle_setup(&car[i]))
            return 1;
        car[i].head.lane = i;
        car[i].head.input_function = drive;
        hmmwv_vehicle_batch_load(batch, i, &car[i]);
    }
    for (r = 0; r < ROUNDS; ++r) {
        const double begin = seconds();
        double middle, end;
        for (i = 0; i < VEHICLES; ++i)
            for (k = 0; k < STEPS; ++k)
                (void)gic_step_dual(&hmmwv_vehicle_model, &car[i], step, 6);
        middle = seconds();
        good = hmmwv_vehicle_batch_step_dual(batch, step, 6, 0, STEPS);
        end = seconds();
        alone += middle - begin;
        together += end - middle;
        ratio[r] = (middle - begin) / (end - middle);
        for (i = 0; i < VEHICLES && (r == 4 || r == ROUNDS - 1); ++i) {
            hmmwv_vehicle_batch_store(batch, i, &copy);
            for (s = 0; s < HMMWV_VEHICLE_STATES; ++s)
                worst[r > 4] = fmax(worst[r > 4], fabs((double)(copy.state[s] - car[i].state[s])) /
                                                      (1 + fabs((double)car[i].state[s])));
        }
    }
    qsort(ratio, ROUNDS, sizeof *ratio, rising);
    printf("%d lanes, %d vehicles of %d bytes, %d good: one by one %.2f us a step, batch %.2f us, throughput %.2f "
           "(%.2f to %.2f), "
           "states apart by %.0e after 3 s, %.0e after 30 s\n",
           HMMWV_VEHICLE_LANES, VEHICLES, (int)(sizeof *batch / VEHICLES), (int)good,
           1e6 * alone / VEHICLES / STEPS / ROUNDS, 1e6 * together / VEHICLES / STEPS / ROUNDS, alone / together,
           ratio[ROUNDS / 10], ratio[ROUNDS - 1 - ROUNDS / 10], worst[0], worst[1]);
    free(batch);
    return 0;
}
