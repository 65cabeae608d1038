/* SPDX-License-Identifier: MIT
 * States and roads as the test programs are given them. */
#ifndef REFERENCE_ROW_H
#define REFERENCE_ROW_H

#include "solve.h"
#include "table.h"

/* `flat` or `sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y`; anything else fails. */
Road road_parse(const char *text);
/* One row of a table with the columns of `gicrun --eval`. */
void state_read(const Model *model, const Table *table, int row, State *state);

#endif
