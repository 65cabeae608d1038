/* SPDX-License-Identifier: MIT
 * Labels of axes: the quantity that a unit belongs to. */
#include "base/file.h"
#include "host/host.h"

#include <string.h>

const char *unit_quantity(const char *unit)
{
    static const char *const known[][2] = {
        {"1", "no unit"},
        {"m", "length"},
        {"rad", "angle"},
        {"m/s", "velocity"},
        {"rad/s", "angular velocity"},
        {"m/s^2", "acceleration"},
        {"rad/s^2", "angular acceleration"},
        {"N", "force"},
        {"N m", "torque"},
        {"J", "energy"},
        {"W", "power"},
        {"kg", "mass"},
        {"s", "time"},
        {"Hz", "frequency"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (!strcmp(unit, known[i][0]))
            return known[i][1];
    return "value";
}

const char *quantity_text(Pool *pool, const char *unit, const char *shown)
{
    const size_t length = strlen(shown);
    if (!strcmp(unit, "1"))
        return unit_quantity(unit);
    if (path_ends(shown, "^2"))
        return pool_print(pool, "%s [%.*s\xc2\xb2]", unit_quantity(unit), (int)length - 2, shown);
    return pool_print(pool, "%s [%s]", unit_quantity(unit), shown);
}
