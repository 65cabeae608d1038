/* SPDX-License-Identifier: MIT
 *
 * Errors that tests plant to see that validation (validate/validate.h) finds them. Compiled with GICGEN_PLANT only,
 * as in build/check/gicgen_planted. The environment variable GICGEN_PLANT names the error: a word for which some
 * formula calls planted(), or FORM:BLOCK:TARGET for a stored number, which becomes too large by a thousandth of
 * itself plus a thousandth of its unit: `all:dynamics:rate[9]`. FORM is `all`, `lanes` or `scene`. `list` plants
 * nothing and prints all names. */
#ifndef BASE_PLANT_H
#define BASE_PLANT_H

#include <stdbool.h>

#ifdef GICGEN_PLANT
const char *what_is_planted(void); /* the error named by the environment; "": none */
bool planted(const char *name);
#else
#define planted(name) false
#endif

#endif
