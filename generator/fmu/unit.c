/* SPDX-License-Identifier: MIT
 * Units as exponents of SI base units: products of names with whole exponents, "N m", "m/s^2", "N s/m"; all after one
 * stroke divides. */
#include "fmu/fmu_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const unit_base_name[UNIT_BASES] = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};

static const struct {
    const char *name;
    double factor;
    int exponent[UNIT_BASES];
} known[] = {
    {"kg", 1, {1}},
    {"m", 1, {0, 1}},
    {"s", 1, {0, 0, 1}},
    {"A", 1, {0, 0, 0, 1}},
    {"K", 1, {0, 0, 0, 0, 1}},
    {"mol", 1, {0, 0, 0, 0, 0, 1}},
    {"cd", 1, {0, 0, 0, 0, 0, 0, 1}},
    {"rad", 1, {0, 0, 0, 0, 0, 0, 0, 1}},
    {"1", 1, {0}},
    {"N", 1, {1, 1, -2}},
    {"J", 1, {1, 2, -2}},
    {"W", 1, {1, 2, -3}},
    {"Pa", 1, {1, -1, -2}},
    {"Hz", 1, {0, 0, -1}},
    {"V", 1, {1, 2, -3, -1}},
    {"g", 1e-3, {1}},
    {"t", 1e3, {1}},
    {"mm", 1e-3, {0, 1}},
    {"cm", 1e-2, {0, 1}},
    {"km", 1e3, {0, 1}},
    {"ms", 1e-3, {0, 0, 1}},
    {"min", 60, {0, 0, 1}},
    {"h", 3600, {0, 0, 1}},
    {"kN", 1e3, {1, 1, -2}},
    {"kJ", 1e3, {1, 2, -2}},
    {"kW", 1e3, {1, 2, -3}},
    {"kPa", 1e3, {1, -1, -2}},
    {"MPa", 1e6, {1, -1, -2}},
    {"bar", 1e5, {1, -1, -2}},
    {"deg", 0.017453292519943295, {0, 0, 0, 0, 0, 0, 0, 1}},
    {"%", 1e-2, {0}},
};

/* One factor, `length` characters without its exponent. */
static bool multiply(const char *name, size_t length, int power, int exponent[UNIT_BASES], double *factor)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (strlen(known[i].name) == length && !memcmp(known[i].name, name, length)) {
            for (int b = 0; b < UNIT_BASES; ++b)
                exponent[b] += power * known[i].exponent[b];
            *factor *= pow(known[i].factor, power);
            return true;
        }
    return false;
}

bool unit_parse(const char *unit, int exponent[UNIT_BASES], double *factor)
{
    bool below = false;
    memset(exponent, 0, sizeof *exponent * UNIT_BASES);
    *factor = 1;
    for (const char *s = unit; *s;) {
        size_t length = strcspn(s, " */^().");
        long power = 1;
        if (!length) {
            if (*s == '/') {
                if (below)
                    return false;
                below = true;
            } else if (*s == '^') {
                return false;
            }
            ++s;
            continue;
        }
        const char *name = s;
        s += length;
        if (*s == '^') {
            char *end;
            power = strtol(s + 1, &end, 10);
            if (end == s + 1 || labs(power) > 9)
                return false;
            s = end;
        }
        if (!multiply(name, length, (int)(below ? -power : power), exponent, factor))
            return false;
    }
    return true;
}
