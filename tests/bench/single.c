/* SPDX-License-Identifier: MIT
 * single.sh compiles it: 30 s of one complete vehicle, 5000 steps of 6 ms with 6 fast ones in each. Prints CPU time, s.
 */
#include "hmmwv_vehicle.h"
#include <stdio.h>
#include <stdlib.h>

enum { VEHICLES = 1, STEPS = 5000 };

#include "full_run.h"

static hmmwv_vehicle car;

int main(void)
{
    double begin;
    int k;
    if (hmmwv_vehicle_setup(&car))
        return 1;
    car.head.input_function = drive;
    begin = seconds();
    for (k = 0; k < STEPS; ++k)
        if (gic_step_dual(&hmmwv_vehicle_model, &car, (gic_real)0.006, 6))
            return 1;
    printf("%.9f %.17g\n", seconds() - begin, (double)car.state[0]);
    return 0;
}
