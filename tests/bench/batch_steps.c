/* SPDX-License-Identifier: MIT
 * python_batch.sh makes a shared object of it and calls it: steps of a batch in C, in the same process and memory.
 * Returns a status. */
#include "host/gic.h"

int batch_steps(gicl_library *library, gicl_handle batch, double step, int steps);

__attribute__((visibility("default"))) int batch_steps(gicl_library *library, gicl_handle batch, double step, int steps)
{
    int status = GICL_OK;
    for (int i = 0; i < steps && status == GICL_OK; ++i)
        status = gicl_batch_step(library, batch, step, GICL_AB3, 1, 1, NULL, NULL);
    return status;
}
