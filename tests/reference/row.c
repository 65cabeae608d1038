/* SPDX-License-Identifier: MIT
 * States and roads as the test programs are given them. */
#include "row.h"

#include "support.h"

#include <string.h>

void road_parse(const char *text, Road *road)
{
    char end;
    if (strcmp(text, "flat") && sscanf(text, "sine:%lf,%lf,%lf,%lf%c", &road->amplitude, &road->wavelength, &road->x0,
                                       &road->phase_per_y, &end) != 4)
        fail("--road '%s': 'flat' or 'sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y' is wanted", text);
    if (road->amplitude != 0 && !(road->wavelength > 0))
        fail("--road '%s': the wavelength must be greater than zero", text);
}

void friction_parse(const char *text, Road *road)
{
    char end;
    if (sscanf(text, "%lf,%lf,%lf,%lf,%lf,%lf%c", &road->x[0], &road->x[1], &road->y[0], &road->y[1], &road->friction,
               &road->fade, &end) != 6 ||
        !(road->fade > 0))
        fail("--friction '%s': X_LOW,X_HIGH,Y_LOW,Y_HIGH,VALUE,FADE is wanted", text);
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

/* A cell whose column may be missing. */
static quad optional_cell(const Table *table, int row, const char *column, quad otherwise)
{
    int index = table_find(table, column);
    return index < 0 ? otherwise : table_number(table, row, index);
}

static void wheels_read(const Model *model, const Table *table, int row, State *state)
{
    char column[128];
    for (int i = 0; i < model->wheels; ++i)
        for (int k = 0; k < FAST_STATES; ++k)
            if (wheel_has(&model->wheel[i], k)) {
                snprintf(column, sizeof column, "%s.%s", model->wheel[i].name, fast_name[k]);
                state->fast[i][k] = optional_cell(table, row, column, 0);
                if (k == 0)
                    model->spin[i] = (double)state->fast[i][k];
            }
}

/* What is missing is as at set-up. */
static void line_read(const Model *model, const Table *table, int row, Line *line)
{
    line->speed = optional_cell(table, row, "engine.speed", model->powertrain->idle);
    line->age = optional_cell(table, row, "transmission.age", 100);
    line->gear[0] = (int)optional_cell(table, row, "transmission.gear", model->powertrain->start_gear);
    line->gear[1] = (int)optional_cell(table, row, "transmission.before", model->powertrain->start_gear);
    for (int i = 0; i < 2; ++i)
        if (line->gear[i] < -model->powertrain->reverse ||
            line->gear[i] + model->powertrain->reverse >= model->powertrain->gears)
            fail("%s:%d: there is no gear %d", table->path, row + 2, line->gear[i]);
}

void state_read(Model *model, const Table *table, int row, State *state)
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
    for (int i = model->driven_inputs; i < model->inputs; ++i)
        model->input[i] = (double)optional_cell(table, row, model->input_name[i], model->input[i]);
    for (int i = 0; i < model->states; ++i)
        model->state[i] = (double)optional_cell(table, row, model->state_name[i], model->state[i]);
    wheels_read(model, table, row, state);
    if (model->powertrain)
        line_read(model, table, row, &state->line);
}
