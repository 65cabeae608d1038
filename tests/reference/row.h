/* SPDX-License-Identifier: MIT
 * States and roads as the test programs are given them. */
#ifndef REFERENCE_ROW_H
#define REFERENCE_ROW_H

#include "solve.h"
#include "table.h"

/* `flat` or `sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y`, and a patch `X_LOW,X_HIGH,Y_LOW,Y_HIGH,VALUE,FADE` of other
 * friction; anything else fails. */
void road_parse(const char *text, Road *road);
void friction_parse(const char *text, Road *road);
/* One row of a table with the columns of `gicrun --eval`. Inputs that are no coordinates go to the model; those, and
 * fast states, whose columns are missing keep their values, or are 0. */
void state_read(Model *model, const Table *table, int row, State *state);

#endif
