/* SPDX-License-Identifier: MIT
 * Messages about the time and memory that a large model takes, before and during the work. */
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/effort.h"
#include "vehicle/vehicle.h"

#include <stdio.h>

/* Numbers of motions and inertias from which a model counts as large. */
static const double large = 20000;

bool effort_tell(Pool *pool, const Model *model, const Sequence *sequence, Solve solve)
{
    /* measured with chains of 20 to 400 links in both forms; within a factor of two on a core of 3 GHz */
    const double numbers = formulation_numbers(pool, model, sequence, solve), bodies = model->bodies;
    const double seconds = 3e-5 * numbers + 4.5e-9 * numbers * numbers;
    const double memory = 0.5 * bodies + 0.0105 * numbers, code = 0.03 * bodies + 0.00018 * numbers;
    if (numbers < large)
        return false;
    diag_note(pool_print(pool,
                         "gicgen: note: model '%s' is large, with %.0f numbers of motions and inertias: it will take "
                         "about %.0f s, %.0f MB of memory and %.0f MB of C\n",
                         model->name, numbers, seconds, memory, code));
    return true;
}

void effort_step(bool told, const char *step)
{
    if (told)
        fprintf(stderr, "gicgen: note: %s\n", step);
}
