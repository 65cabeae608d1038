/* SPDX-License-Identifier: MIT
 *
 * Errors that are planted, to see that the validation (validate.h) is alive. Compiled with GICGEN_PLANT alone, as
 * build/check/gicgen_planted is. The environment variable GICGEN_PLANT names the error: a word that some formula asks
 * planted() for, or FORM:BLOCK:TARGET for what a block stores, too large by a thousandth and that of its unit:
 * `all:dynamics:rate[9]`. FORM is `all`, `lanes` or `scene`. `list` plants nothing and prints what can be named so. */
#ifndef PLANT_H
#define PLANT_H

#include "gicgen.h"

#ifdef GICGEN_PLANT
bool planted(const char *name);
void plant_stores(const Formulation *f, const char *form);
#else
#define planted(name) false
#define plant_stores(f, form) ((void)0)
#endif

#endif
