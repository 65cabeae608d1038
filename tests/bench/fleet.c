/* SPDX-License-Identifier: MIT
 * fleet.sh compiles it: complete vehicles in a batch against the same vehicles one by one, by turns in one process. The
 * inputs are those of models/scenes/full_run.scene, with a pedal of its own for each vehicle. */
#include "hmmwv_vehicle_batch.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { VEHICLES = HMMWV_VEHICLE_VEHICLES, ROUNDS = 50, STEPS = 100 }; /* 50 times 100 steps of 6 ms: 30 s */

#include "full_run.h"

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
