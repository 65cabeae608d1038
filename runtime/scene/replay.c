/* SPDX-License-Identifier: MIT
 * Replay of what someone did on a page of gicrun --drive: its table has a row for each look at the targets. Recordings
 * of gicrun --live are hold.c's. */
#include "scene/replay.h"

#include "host/host.h"
#include "model/model.h"
#include "scene/hold.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

static const char header[] = "time [s],hands,target.accelerator,target.brake";

static const char *after(const char *name, const char *before)
{
    const size_t length = strlen(before);
    return strncmp(name, before, length) ? NULL : name + length;
}

/* ---- the table -------------------------------------------------------------------------------------------------- */

static int column_of(const CsvTable *table, const char *name)
{
    for (int i = 0; i < table->columns; ++i)
        if (!strcmp(table->name[i], name))
            return i;
    diag_fail((Place){table->source, 1, 1}, "give it a file that a page of gicrun --drive saved",
              "the recording has no column '%s'", name);
}

static double cell(const CsvTable *table, int row, int column)
{
    return table->value[row * table->columns + column];
}

/* Looks are at ends of steps of the scene. */
static const double *read_times(Pool *pool, const CsvTable *table, const Scene *scene)
{
    double *time = pool_alloc(pool, sizeof *time * ((size_t)table->rows + 1));
    const int column = column_of(table, "time"), steps = hands_steps(scene->step);
    for (int i = 0; i < table->rows; ++i) {
        time[i] = cell(table, i, column);
        if (fabs(time[i] - (double)i * steps * scene->step) > 1e-9 * scene->step * (i + 1))
            diag_fail(csv_place(table, i), "replay it with the scene of the page, whose step it has",
                      "the time must be %.15g s, not %.15g s", (double)i * steps * scene->step, time[i]);
    }
    if (table->rows < 2)
        diag_fail((Place){table->source, 0, 0}, "drive for a moment before it is saved",
                  "the recording has fewer than two rows");
    return time;
}

static void read_hand(Pool *pool, const CsvTable *table, int column, const char *name, const Model *model, Replay *r)
{
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(model->input[i].name, name)) {
            csv_check_unit(pool, table, column, model->input[i].unit);
            *POOL_PUSH(pool, r->hand, r->count) = (Hand){.input = i, .driven = scene_driven_by(model, i)};
            return;
        }
    diag_fail(csv_name_place(table, column), "replay it with the model of the page", "the model has no input '%s'",
              name);
}

/* A parameter, which is the same in all rows. */
static void read_parameter(Pool *pool, const CsvTable *table, int column, const char *name, const Model *model,
                           double *parameter)
{
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable && !strcmp(model->parameter[i].name, name)) {
            csv_check_unit(pool, table, column, model->parameter[i].unit);
            parameter[model->parameter[i].index] = cell(table, 0, column);
            return;
        }
    diag_fail(csv_name_place(table, column), "replay it with the model of the page",
              "the model has no tunable parameter '%s'", name);
}

static void read_columns(Pool *pool, const CsvTable *table, const Model *model, Replay *r, double *parameter)
{
    const int holds = column_of(table, "hands");
    bool *on = pool_alloc(pool, (size_t)table->rows + 1);
    for (int row = 0; row < table->rows; ++row)
        on[row] = cell(table, row, holds) != 0;
    r->holds = on;
    for (int i = 0; i < table->columns; ++i) {
        const char *input = after(table->name[i], "target."), *tuned = after(table->name[i], "parameter.");
        if (input)
            read_hand(pool, table, i, input, model, r);
        if (tuned)
            read_parameter(pool, table, i, tuned, model, parameter);
    }
    double *value = pool_alloc(pool, sizeof *value * ((size_t)table->rows * (size_t)r->count + 1));
    r->value = value;
    for (int row = 0; row < table->rows; ++row)
        for (int i = 0; i < table->columns; ++i)
            if (after(table->name[i], "target."))
                *value++ = cell(table, row, i);
}

bool replay_is_of_page(Pool *pool, const char *path)
{
    return !hold_is(csv_read(pool, path, header, NULL));
}

const Scene *scene_replay(Pool *pool, const Model *model, const Scene *scene, const char *path)
{
    Scene *out = pool_alloc(pool, sizeof *out);
    Replay *r = pool_alloc(pool, sizeof *r);
    *out = *scene;
    if (scene->method >= METHOD_ADAMS)
        diag_fail((Place){scene->source, 0, 0}, "write `integrator: ab3` and a step", "only constant steps replay");
    const CsvTable *table = csv_read(pool, path, header, NULL);
    out->parameter = pool_alloc(pool, sizeof(double) * (size_t)(model->tunables + 1));
    memcpy(out->parameter, scene->parameter, sizeof(double) * (size_t)model->tunables);
    if (hold_is(table)) {
        out->hold = hold_recorded(pool, model, scene, table);
        out->duration = out->hold->time[table->rows - 1];
    } else {
        r->rows = table->rows;
        r->time = read_times(pool, table, scene);
        read_columns(pool, table, model, r, out->parameter);
        out->replay = r;
        out->duration = r->time[r->rows - 1];
    }
    out->actions = NULL;
    out->rest = NULL;
    out->outputs = (int64_t)floor(out->duration / scene->output_step + 1e-9);
    return out;
}

/* ---- the run ---------------------------------------------------------------------------------------------------- */

void replay_start(Replay *replay)
{
    replay->next = 0;
    replay->holding = false;
}

void replay_look(const Scene *scene, double time, double *input)
{
    Replay *r = scene->replay;
    if (r->next == r->rows || time < r->time[r->next] - 1e-9 * scene->step)
        return;
    const int row = r->next++;
    if (r->holds[row] && !r->holding) {
        scene_inputs((void *)scene, 0, time, input);
        hands_take(r->hand, r->count, time, input);
    }
    if (!r->holds[row] && r->holding && scene->driver)
        hands_release(r->hand, r->count, scene->driver);
    r->holding = r->holds[row];
    if (r->holding)
        hands_turn(r->hand, r->count, time, r->value + row * r->count);
}

void replay_inputs(const Replay *replay, double time, double *input)
{
    if (replay->holding)
        hands_inputs(replay->hand, replay->count, time, input);
}
