/* SPDX-License-Identifier: MIT
 * A command line that is none. */
#include "gicrun.h"

#include <stdlib.h>

void usage_fail(const char *program, const char *message, const char *word)
{
    fprintf(stderr, "%s: error: %s%s%s%s\n  remedy: `%s -h` shows how\n", program, message, word ? " '" : "",
            word ? word : "", word ? "'" : "", program);
    exit(2);
}
