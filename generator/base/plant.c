/* SPDX-License-Identifier: MIT
 * Errors planted to see that validation finds them. Only build/check/gicgen_planted and gicrun_planted contain
 * this. */
#include "base/plant.h"

#ifdef GICGEN_PLANT

#include <stdlib.h>
#include <string.h>

const char *what_is_planted(void)
{
    const char *name = getenv("GICGEN_PLANT");
    return name ? name : "";
}

bool planted(const char *name)
{
    return !strcmp(what_is_planted(), name);
}

#else
typedef int plant_is_empty;
#endif
