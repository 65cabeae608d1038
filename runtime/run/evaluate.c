/* SPDX-License-Identifier: MIT
 * Rows of states to accelerations, poses and outputs (--eval), for comparison with other programs. */
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/run.h"
#include "scene/scene.h"

#include <string.h>

/* The column of the table for each number of the instance: states, inputs, parameters, gears; -1: the default stays. */
typedef struct Columns {
    int states, inputs, parameters, gears;
    int *column; /* [states + inputs + parameters + gears] */
} Columns;

static const char *number_name(const Engine *engine, int i)
{
    const gic_model *model = engine->code;
    int input = i - engine->standard_count, parameter = input - model->input_count;
    int gear = parameter - model->parameter_count;
    return input < 0       ? engine->standard[i].name
           : parameter < 0 ? model->input[input].name
           : gear < 0      ? model->parameter[parameter].name
                           : model->discrete[model->free_base + gear].name;
}

static const char *number_unit(const Engine *engine, int i)
{
    const gic_model *model = engine->code;
    int input = i - engine->standard_count, parameter = input - model->input_count;
    int gear = parameter - model->parameter_count;
    return input < 0       ? engine->standard[i].unit
           : parameter < 0 ? model->input[input].unit
           : gear < 0      ? model->parameter[parameter].unit
                           : model->discrete[model->free_base + gear].unit;
}

/* The name with its kind, `parameter/name`, if several things have the name; NULL: of a gear. */
static const char *full_name(Pool *pool, const Engine *engine, int i)
{
    const gic_model *model = engine->code;
    const int inputs = i - engine->standard_count, parameters = inputs - model->input_count;
    if (parameters >= model->parameter_count)
        return NULL;
    return pool_print(pool, "%s/%s",
                      inputs < 0       ? "state"
                      : parameters < 0 ? "input"
                                       : "parameter",
                      number_name(engine, i));
}

/* True for a column that the table must have: slow states, inputs of driven coordinates. */
static bool is_needed(const Engine *engine, int i)
{
    const gic_model *model = engine->code;
    if (i < engine->standard_count)
        return i < engine->standard_count - model->fast_count;
    i -= engine->standard_count;
    for (int k = 0; k < model->coordinate_count; ++k) {
        int first = model->coordinate_input[k];
        if (first >= 0 && i >= first && i < first + 3)
            return true;
    }
    return false;
}

static Columns find_columns(Pool *pool, const Engine *engine, const CsvTable *table)
{
    const gic_model *model = engine->code;
    Columns columns = {.states = engine->standard_count,
                       .inputs = model->input_count,
                       .parameters = model->parameter_count,
                       .gears = model->discrete_count - model->free_base};
    const int numbers = columns.states + columns.inputs + columns.parameters + columns.gears;
    const char **name = pool_alloc(pool, sizeof *name * (size_t)(numbers + 1));
    const char **full = pool_alloc(pool, sizeof *full * (size_t)(numbers + 1));
    columns.column = pool_alloc(pool, sizeof *columns.column * (size_t)(numbers + 1));
    for (int i = 0; i < numbers; ++i) {
        name[i] = number_name(engine, i);
        full[i] = full_name(pool, engine, i);
        columns.column[i] = -1;
    }
    for (int k = 0; k < table->columns; ++k) {
        int i = 0;
        while (i < numbers && ((strcmp(name[i], table->name[k]) && (!full[i] || strcmp(full[i], table->name[k]))) ||
                               columns.column[i] >= 0))
            ++i;
        const char *nearest = diag_nearest(table->name[k], name, numbers);
        if (i == numbers)
            diag_fail(csv_name_place(table, k),
                      nearest ? pool_print(pool, "did you mean '%s'?", nearest) : "remove the column",
                      "the model has no state, input or tunable parameter '%s'", table->name[k]);
        csv_check_unit(pool, table, k, number_unit(engine, i));
        columns.column[i] = k;
    }
    Text missing = {.pool = pool};
    for (int i = 0; i < numbers; ++i)
        if (columns.column[i] < 0 && is_needed(engine, i))
            text_print(&missing, "%s%s", missing.size ? ", " : "add ", name[i]);
    if (missing.size)
        diag_fail(csv_name_place(table, 0), missing.s, "columns are missing");
    return columns;
}

static bool is_ground(const gic_model *model, int body)
{
    return body == 0 && !model->free_base;
}

static void write_header(const Engine *engine, Csv *csv)
{
    const gic_model *model = engine->code;
    static const char *const base[][2] = {{"a.x", "m/s^2"},       {"a.y", "m/s^2"},       {"a.z", "m/s^2"},
                                          {"alpha.x", "rad/s^2"}, {"alpha.y", "rad/s^2"}, {"alpha.z", "rad/s^2"}};
    static const char *const pose[][2] = {{"x", "m"},   {"y", "m"},   {"z", "m"},  {"e0", NULL},
                                          {"e1", NULL}, {"e2", NULL}, {"e3", NULL}};
    char name[128], unit[64];
    for (int i = 0; i < 6 && model->free_base; ++i)
        csv_name(csv, base[i][0], base[i][1]);
    for (int i = 0; i < model->coordinate_count; ++i)
        if (model->coordinate_state[i] >= 0) {
            snprintf(name, sizeof name, "%s.acceleration", model->coordinate[i].name);
            snprintf(unit, sizeof unit, "%s/s^2", model->coordinate[i].unit);
            csv_name(csv, name, unit);
        }
    for (int i = engine->standard_count - model->fast_count; i < engine->standard_count; ++i) {
        const gic_signal *state = &engine->standard[i];
        snprintf(name, sizeof name, "%s.rate", state->name);
        snprintf(unit, sizeof unit, "%s/s", state->unit);
        csv_name(csv, name, !strcmp(state->unit, "rad/s") ? "rad/s^2" : strcmp(state->unit, "s") ? unit : "1");
    }
    for (int i = 0; i < model->body_count; ++i)
        for (int k = 0; k < 7 && !is_ground(model, i); ++k) {
            const char *body = model->body_name[i];
            const bool taken = model->free_base && (!strcmp(body, "a") || !strcmp(body, "alpha"));
            snprintf(name, sizeof name, "%s%s.%s", taken ? "body/" : "", body, pose[k][0]);
            csv_name(csv, name, pose[k][1]);
        }
    for (int i = 0; i < model->output_count; ++i) {
        /* a body may have the name of an output */
        snprintf(name, sizeof name, "output.%s", model->output[i].name);
        csv_name(csv, name, model->output[i].unit);
    }
    csv_name(csv, "constraint", NULL);
    csv_name(csv, "status", NULL);
    csv_name(csv, "message", NULL);
    csv_end_row(csv);
}

/* A cell, empty if the row has no result. */
static void result(Csv *csv, int status, double value)
{
    if (status == GIC_OK)
        csv_number(csv, value);
    else
        csv_text(csv, NULL);
}

static void write_row(Pool *pool, const Engine *engine, Csv *csv, const gic_head *self, int status, const double *rate,
                      const double *pose, const double *output, double constraint)
{
    const gic_model *model = engine->code;
    const int slow = engine->standard_count - model->fast_count;
    const int half = slow / 2; /* distance from a coordinate to its rate, after 7 and 6 numbers of the base */
    for (int i = 0; i < 6 && model->free_base; ++i)
        result(csv, status, rate[half + 1 + i]);
    for (int i = 0; i < model->coordinate_count; ++i)
        if (model->coordinate_state[i] >= 0)
            result(csv, status, rate[model->coordinate_state[i] + half]);
    for (int i = slow; i < engine->standard_count; ++i)
        result(csv, status, rate[i]);
    for (int i = 0; i < model->body_count; ++i)
        for (int k = 0; k < 7 && !is_ground(model, i); ++k)
            result(csv, status, pose[7 * i + k]);
    for (int i = 0; i < model->output_count; ++i)
        result(csv, status, output[i]);
    result(csv, status, constraint);
    csv_number(csv, status);
    csv_text(csv, instance_status(pool, model, self, status));
    csv_end_row(csv);
}

/* The row's gears, which must be whole numbers; engines check that they exist. */
static int set_gears(const gic_model *model, const Columns *columns, const double *value, gic_head *self)
{
    const int *column = columns->column + columns->states + columns->inputs + columns->parameters;
    int32_t *gear = (int32_t *)(void *)((char *)self + model->discrete_offset) + model->free_base;
    for (int i = 0; i < columns->gears; ++i) {
        const double given = column[i] < 0 ? gear[i] : value[column[i]];
        if (!(given >= -128 && given <= 127 && given == (int32_t)given))
            return GIC_ERROR_INPUT;
        gear[i] = (int32_t)given;
    }
    return GIC_OK;
}

void evaluate(Pool *pool, const Engine *engine, const Scene *scene, const Request *request)
{
    const gic_model *model = engine->code;
    const CsvTable *table = csv_read(pool, request->states, "r.x,r.y,...", NULL);
    const Columns columns = find_columns(pool, engine, table);
    gic_head *self = instance_new(pool, engine);
    double *input = instance_array(self, model->input_offset);
    const double *fast = instance_array(self, model->state_offset) + model->slow_count; /* columns that may be missing
                                                                                         */
    const double *output = instance_array(self, model->output_offset);
    double *state = pool_alloc(pool, sizeof *state * (size_t)(engine->standard_count + 1));
    double *rate = pool_alloc(pool, sizeof *rate * (size_t)(engine->standard_count + 1));
    double *pose = pool_alloc(pool, sizeof *pose * 7 * (size_t)(model->body_count + 1));
    double *standard = pool_alloc(pool, sizeof *standard * (size_t)(model->parameter_count + 1));
    double *parameter = pool_alloc(pool, sizeof *parameter * (size_t)(model->parameter_count + 1));
    int failures = 0, wrong = 0;
    model->setup(self);
    memcpy(standard, instance_array(self, model->parameter_offset), sizeof *standard * (size_t)model->parameter_count);

    interrupt_hold();
    Csv csv = csv_open(pool, request->results);
    write_header(engine, &csv);
    for (int row = 0; row < table->rows; ++row) {
        const double *value = table->value + row * table->columns;
        if (interrupt_arrived()) {
            csv_abandon(&csv);
            interrupt_release(); /* the program may end here */
            return;
        }
        gic_self_test test = {.constraint = 0};
        /* set up anew: poses are found from the design, independent of earlier rows */
        for (int i = 0; i < columns.parameters; ++i) {
            int column = columns.column[columns.states + columns.inputs + i];
            parameter[i] = column < 0 ? standard[i] : value[column];
        }
        int status = model->setup_with(self, parameter);
        self->road = scene ? scene->road : NULL;
        memcpy(state + columns.states - model->fast_count, fast, sizeof *fast * (size_t)model->fast_count);
        for (int i = 0; i < columns.states + columns.inputs; ++i)
            if (columns.column[i] >= 0)
                *(i < columns.states ? &state[i] : &input[i - columns.states]) = value[columns.column[i]];
        if (status == GIC_OK)
            status = set_gears(model, &columns, value, self);
        if (status == GIC_OK)
            status = engine_enter(engine, self, state);
        if (status == GIC_OK)
            status = engine_look(engine, self, state, rate);
        if (status == GIC_OK)
            status = model->poses(self, pose);
        if (status == GIC_OK)
            status = model->outputs(self);
        if (status == GIC_OK)
            status = model->self_test(self, &test);
        failures += status != GIC_OK;
        wrong += status == GIC_ERROR_RESIDUAL;
        write_row(pool, engine, &csv, self, status, rate, pose, output, test.constraint);
    }
    csv_close(&csv);
    interrupt_release();
    if (wrong)
        diag_fail((Place){table->source, 0, 0},
                  "--engine gic shares no formulas with this code: please report model and states",
                  "in %d of %d rows %s", wrong, table->rows, gic_status_text(GIC_ERROR_RESIDUAL));
    if (failures)
        diag_warn((Place){table->source, 0, 0}, "their status and message tell why", "%d of %d rows have no result",
                  failures, table->rows);
}
