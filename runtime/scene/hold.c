/* SPDX-License-Identifier: MIT
 * Inputs from outside, held from step to step. */
#include "scene/hold.h"

#include "base/message.h"
#include "base/text.h"
#include "model/model.h"

#include <math.h>
#include <string.h>

static const char prefix[] = "held.";

/* ---- holding ----------------------------------------------------------------------------------------------------- */

static void add_hand(Pool *pool, const Model *model, int input, Hold *hold)
{
    int firsts = hold->hands;
    const bool driven = scene_driven_by(model, input);
    *POOL_PUSH(pool, hold->first, firsts) = hold->inputs;
    *POOL_PUSH(pool, hold->hand, hold->hands) = (Hand){.input = input, .driven = driven};
    for (int k = 0; k < (driven ? 3 : 1); ++k)
        *POOL_PUSH(pool, hold->input, hold->inputs) = input + k;
}

/* Is the input's name among names between commas? */
static bool named(const char *names, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = names; at; at = strchr(at, ','), at = at ? at + 1 : NULL)
        if (!strncmp(at, name, length) && (!at[length] || at[length] == ','))
            return true;
    return false;
}

/* Every name must be one of the inputs that have hands. */
static void check_names(Pool *pool, const Model *model, const char *names)
{
    const char **known = pool_alloc(pool, sizeof *known * ((size_t)model->inputs + 1));
    int count = 0;
    for (int i = 0; i < model->inputs; i += scene_driven_by(model, i) ? 3 : 1)
        known[count++] = model->input[i].name;
    char *rest;
    for (char *name = strtok_r(pool_print(pool, "%s", names), ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
        bool found = false;
        for (int i = 0; i < count; ++i)
            found = found || !strcmp(known[i], name);
        const char *nearest = found ? NULL : diag_nearest(name, known, count);
        if (!found)
            diag_fail((Place){model->source, 0, 0},
                      nearest ? pool_print(pool, "did you mean '%s'?", nearest)
                              : "name some of its inputs, with commas between them",
                      "the model has no input '%s'", name);
    }
}

Hold *hold_new(Pool *pool, const Model *model, const char *names)
{
    Hold *hold = pool_alloc(pool, sizeof *hold);
    if (names)
        check_names(pool, model, names);
    for (int i = 0; i < model->inputs; i += scene_driven_by(model, i) ? 3 : 1)
        if (!names || named(names, model->input[i].name))
            add_hand(pool, model, i, hold);
    if (!hold->hands && names)
        diag_fail((Place){model->source, 0, 0}, "name some, with commas between them", "no inputs are named");
    hold->value = pool_alloc(pool, sizeof(double) * ((size_t)hold->inputs + 1));
    return hold;
}

void hold_start(Hold *hold)
{
    hold->next = 0;
    hold->by = HOLD_SCENE;
    hold->touched = false;
}

static bool is_drivers(const Driver *driver, int input)
{
    return driver && ((driver->accelerator >= 0 && (input == driver->accelerator || input == driver->brake)) ||
                      input == driver->steering);
}

bool hold_take(const Scene *scene, double time, HoldBy by, const double *value, double *input)
{
    Hold *hold = scene->hold;
    const size_t size = sizeof *value * (size_t)hold->inputs;
    if (by == hold->by && (by == HOLD_SCENE || !memcmp(value, hold->value, size)))
        return false;
    scene_inputs((void *)scene, 0, time, input); /* movements go on from where inputs are now */
    if (hold->by == HOLD_EXACT || (by == HOLD_TARGETS && hold->by == HOLD_SCENE))
        hands_take(hold->hand, hold->hands, time, input);
    if (by != HOLD_SCENE)
        memcpy(hold->value, value, size);
    for (int i = 0; i < hold->hands; ++i) {
        Hand *hand = &hold->hand[i];
        if (!hand->driven)
            hand->move = movement_rest(hold->value[hold->first[i]]);
        else if (by == HOLD_TARGETS)
            movement_turn(&hand->move, time, value[hold->first[i]], HANDS_REACH);
    }
    if (by == HOLD_SCENE && scene->driver)
        hands_release(hold->hand, hold->hands, scene->driver);
    hold->by = by;
    hold->touched = true;
    return true;
}

void hold_look(const Scene *scene, double time, double *input)
{
    Hold *hold = scene->hold;
    if (hold->next == hold->rows || time < hold->time[hold->next] - 1e-9 * scene->step)
        return;
    const int row = hold->next++;
    hold_take(scene, time, (HoldBy)hold->kind[row], hold->row + row * hold->inputs, input);
}

void hold_inputs(const Hold *hold, const Driver *driver, double time, double *input)
{
    if (!hold->touched)
        return;
    if (hold->by == HOLD_EXACT) {
        for (int i = 0; i < hold->inputs; ++i)
            input[hold->input[i]] = hold->value[i];
        return;
    }
    for (int i = 0; i < hold->hands; ++i)
        if (hold->by == HOLD_TARGETS || !is_drivers(driver, hold->hand[i].input))
            hands_inputs(hold->hand + i, 1, time, input);
}

/* ---- recordings -------------------------------------------------------------------------------------------------- */

void hold_names(Csv *csv, const Hold *hold, const Model *model)
{
    csv_name(csv, "hands", "1");
    for (int i = 0; i < hold->inputs; ++i) {
        const Input *input = &model->input[hold->input[i]];
        csv_name(csv, pool_print(csv->pool, "%s%s", prefix, input->name), input->unit);
    }
}

bool hold_is(const CsvTable *table)
{
    for (int i = 0; i < table->columns; ++i)
        if (strcmp(table->name[i], "time") != 0 && strcmp(table->name[i], "hands") != 0 &&
            strncmp(table->name[i], prefix, sizeof prefix - 1) != 0)
            return false;
    return true;
}

static int column_of(Pool *pool, const CsvTable *table, const char *name, const char *unit)
{
    for (int i = 0; i < table->columns; ++i)
        if (!strcmp(table->name[i], name)) {
            csv_check_unit(pool, table, i, unit);
            return i;
        }
    diag_fail((Place){table->source, 1, 1}, "replay it with the model of the run", "the recording has no column '%s'",
              name);
}

/* The inputs that the table has, between commas; fails where one is none of the model's. */
static const char *held_names(Pool *pool, const CsvTable *table, const Model *model)
{
    Text names = {.pool = pool};
    for (int i = 0; i < table->columns; ++i) {
        const char *name = table->name[i] + sizeof prefix - 1;
        bool known = false;
        if (strncmp(table->name[i], prefix, sizeof prefix - 1) != 0)
            continue;
        for (int k = 0; k < model->inputs; ++k)
            known = known || !strcmp(name, model->input[k].name);
        if (!known)
            diag_fail(csv_name_place(table, i), "replay it with the model of the run", "the model has no input '%s'",
                      name);
        text_print(&names, "%s,", name);
    }
    return names.s;
}

static double cell(const CsvTable *table, int row, int column)
{
    return table->value[row * table->columns + column];
}

/* Rows are at ends of steps of the scene. */
static void check_time(const CsvTable *table, int row, double before, double time, double step)
{
    const double steps = round(time / step);
    if (!(fabs(time - steps * step) <= 1e-9 * step * (steps + 1)))
        diag_fail(csv_place(table, row), "replay it with the scene of the run, whose step it has",
                  "the time must be a multiple of the step of %.15g s, not %.15g s", step, time);
    if (!(time > before))
        diag_fail(csv_place(table, row), "give it the recording as it was written", "times must rise, unlike %.15g s",
                  time);
}

Hold *hold_recorded(Pool *pool, const Model *model, const Scene *scene, const CsvTable *table)
{
    Hold *hold = pool_alloc(pool, sizeof *hold);
    const char *names = held_names(pool, table, model);
    for (int i = 0; i < model->inputs; i += scene_driven_by(model, i) ? 3 : 1)
        if (named(names, model->input[i].name))
            add_hand(pool, model, i, hold);
    hold->value = pool_alloc(pool, sizeof(double) * ((size_t)hold->inputs + 1));
    double *time = pool_alloc(pool, sizeof *time * ((size_t)table->rows + 1));
    int *kind = pool_alloc(pool, sizeof *kind * ((size_t)table->rows + 1));
    double *row = pool_alloc(pool, sizeof *row * ((size_t)table->rows * (size_t)hold->inputs + 1));
    const int times = column_of(pool, table, "time", "s"), kinds = column_of(pool, table, "hands", "1");
    for (int i = 0; i < table->rows; ++i) {
        time[i] = cell(table, i, times);
        check_time(table, i, i ? time[i - 1] : -1, time[i], scene->step);
        const double by = cell(table, i, kinds);
        kind[i] = (int)by;
        if (by != HOLD_SCENE && by != HOLD_TARGETS && by != HOLD_EXACT)
            diag_fail(csv_place(table, i), "give it the recording as it was written",
                      "hands must be 0, 1 or 2, not %.15g", by);
    }
    for (int k = 0; k < hold->inputs; ++k) {
        const Input *input = &model->input[hold->input[k]];
        const int column = column_of(pool, table, pool_print(pool, "%s%s", prefix, input->name), input->unit);
        for (int i = 0; i < table->rows; ++i)
            row[i * hold->inputs + k] = cell(table, i, column);
    }
    if (table->rows < 2)
        diag_fail((Place){table->source, 0, 0}, "let the run go on for a step before it is ended",
                  "the recording has fewer than two rows");
    hold->rows = table->rows;
    hold->time = time;
    hold->kind = kind;
    hold->row = row;
    return hold;
}
