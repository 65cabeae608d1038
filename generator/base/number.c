/* SPDX-License-Identifier: MIT
 * Numbers as C source. */
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The shortest text of 15 to 17 digits that reads back bit-exactly, with `before` and `after` around it. */
const char *emit_number_within(Pool *pool, const char *before, double value, const char *after)
{
    char digits[32];
    int precision = 15;
    do
        snprintf(digits, sizeof digits, "%.*g", precision++, value);
    while (strtod(digits, NULL) != value && precision <= 17);
    return pool_print(pool, "%s%s%s%s", before, digits, strpbrk(digits, ".e") ? "" : ".0", after);
}

const char *emit_number(Pool *pool, double value)
{
    return emit_number_within(pool, "R(", value, ")");
}
