/* SPDX-License-Identifier: MIT
 * States and roads as the test programs are given them. */
#include "row.h"

#include "support.h"

#include <string.h>

Road road_parse(const char *text)
{
    Road road = {0};
    char end;
    if (strcmp(text, "flat") && sscanf(text, "sine:%lf,%lf,%lf,%lf%c", &road.amplitude, &road.wavelength, &road.x0,
                                       &road.phase_per_y, &end) != 4)
        fail("--road '%s': 'flat' or 'sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y' is wanted", text);
    if (road.amplitude != 0 && !(road.wavelength > 0))
        fail("--road '%s': the wavelength must be greater than zero", text);
    return road;
}

static void vector_cells(const Table *table, int row, const char *const *name, int size, quad *out)
{
    for (int i = 0; i < size; ++i)
        out[i] = table_number(table, row, table_want(table, name[i]));
}

static quad coordinate_cell(const Table *table, int row, const char *coordinate, const char *suffix)
{
    char name[128];
    snprintf(name, sizeof name, "%s%s", coordinate, suffix);
    return table_number(table, row, table_want(table, name));
}

void state_read(const Model *model, const Table *table, int row, State *state)
{
    static const char *const r[] = {"r.x", "r.y", "r.z"}, *const e[] = {"e0", "e1", "e2", "e3"},
                             *const v[] = {"v.x", "v.y", "v.z"}, *const omega[] = {"omega.x", "omega.y", "omega.z"};
    if (model->free_base) {
        vector_cells(table, row, r, 3, state->r);
        vector_cells(table, row, e, 4, state->e);
        vector_cells(table, row, v, 3, state->v);
        vector_cells(table, row, omega, 3, state->omega);
    }
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *coordinate = &model->coordinate[c];
        state->w[c] = coordinate_cell(table, row, coordinate->name, "");
        state->w_rate[c] = coordinate_cell(table, row, coordinate->name, ".rate");
        if (coordinate->driven)
            state->w_second[c] = coordinate_cell(table, row, coordinate->name, ".acceleration");
    }
}
