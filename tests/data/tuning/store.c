/* SPDX-License-Identifier: MIT
 * A vehicle with other geometry is stored from a batch into an instance that was used: outputs must be those of one
 * that was not. The reference is a fresh instance; bit for bit, for both do the same. */
#include "car_batch.h"

#include <stdio.h>
#include <string.h>

int main(void)
{
    static car used, fresh, other;
    static car_batch batch __attribute__((aligned(64)));
    double parameter[CAR_PARAMETERS];
    if (car_setup(&used) != GIC_OK || car_outputs(&used) != GIC_OK || car_batch_setup(&batch) != GIC_OK)
        return 1;
    memcpy(parameter, used.parameter, sizeof parameter);
    parameter[CAR_PARAMETER_BALL_L] = 0.78;
    if (car_setup_with(&other, parameter) != GIC_OK)
        return 2;
    memcpy(other.state, used.state, sizeof other.state); /* the same coordinates, other geometry */
    car_batch_load(&batch, 0, &other);
    car_batch_store(&batch, 0, &used);
    memset(&fresh, 0, sizeof fresh);
    car_batch_store(&batch, 0, &fresh);
    if (car_outputs(&used) != GIC_OK || car_outputs(&fresh) != GIC_OK)
        return 3;
    for (int i = 0; i < CAR_OUTPUTS; ++i)
        if (memcmp(&used.output[i], &fresh.output[i], sizeof *used.output)) {
            printf("output %d: %.17g %.17g\n", i, used.output[i], fresh.output[i]);
            return 4;
        }
    return 0;
}
