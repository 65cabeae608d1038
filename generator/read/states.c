/* SPDX-License-Identifier: MIT
 * The model's own states (FORMAT.md section 7.3). */
#include "base/text.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <math.h>

enum { STATE_INITIAL, STATE_RATE, STATE_UNIT, STATE_KEYS };

static const Key state_key[STATE_KEYS] = {
    [STATE_INITIAL] = {"initial", KEY_NUMBER, ALL_FORMS, 0, BOUND_NONE, 0},
    [STATE_RATE] = {"rate", KEY_FORMULA, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [STATE_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const state_about[STATE_KEYS] = {
    [STATE_INITIAL] = "value at the start, unless a scene gives another; default 0",
    [STATE_RATE] = "formula of its rate, 1/s times its unit",
    [STATE_UNIT] = "for people; default 1",
};

const Section state_section = {state_key, STATE_KEYS, NULL, 0, NULL, NULL, state_about};

void own_states_check(Reader *reader)
{
    const Model *model = reader->model;
    const char **name = NULL;
    Place *at = NULL;
    int names = 0, places = 0;
    for (int c = 0; c < model->coordinates; ++c) {
        *POOL_PUSH(reader->pool, name, names) = model->coordinate[c].name;
        *POOL_PUSH(reader->pool, name, names) = pool_print(reader->pool, "%s.rate", model->coordinate[c].name);
        for (int i = 0; i < 2; ++i)
            *POOL_PUSH(reader->pool, at, places) = model->coordinate[c].at;
    }
    for (int i = 0; i < BASE_STATES && model->free_base && model->states; ++i) {
        *POOL_PUSH(reader->pool, name, names) = base_state_name[i];
        *POOL_PUSH(reader->pool, at, places) = model->body[BODY_BASE].at;
    }
    for (int i = 0; i < model->wheels; ++i)
        for (int k = 0; k < wheel_fast_states(&model->wheel[i]); ++k) {
            *POOL_PUSH(reader->pool, name, names) =
                pool_print(reader->pool, "%s.%s", model->wheel[i].name, wheel_fast_name[k]);
            *POOL_PUSH(reader->pool, at, places) = model->wheel[i].at;
        }
    for (int i = 0; model->powertrain && i < POWERTRAIN_FAST; ++i) {
        *POOL_PUSH(reader->pool, name, names) = powertrain_fast_name[i];
        *POOL_PUSH(reader->pool, at, places) = model->state[0].at;
    }
    for (int i = 0; i < model->states; ++i) {
        *POOL_PUSH(reader->pool, name, names) = model->state[i].name;
        *POOL_PUSH(reader->pool, at, places) = model->state[i].at;
    }
    if (model->states)
        generated_names_check(reader, "state", name, at, names);
}

void initial_check(const Item *item, const char *what, double initial)
{
    const double most = 1 << 30; /* gic_bounded() */
    if (item && !(fabs(initial) < most))
        diag_fail(item->at, "give it a unit in which it is smaller",
                  "%s: states are below 2^30 = %.0f in size (FORMAT.md section 14), not %s", what, most, item->text);
}

void states_declare(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count;
    Entry *entry = section_entries(reader, map, "state", &count);
    model->state = pool_alloc(reader->pool, sizeof *model->state * (size_t)(count + 1));
    for (int i = 0; i < count; ++i) {
        Value value[STATE_KEYS];
        section_read(reader, &state_section, 0, entry + i, value);
        formula_name_check(reader, entry + i, "state");
        initial_check(value[STATE_INITIAL].item, pool_print(reader->pool, "initial of %s", entry[i].what),
                      value[STATE_INITIAL].number[0]);
        model->state[i] = (State){
            .name = entry[i].name,
            .unit = value[STATE_UNIT].item ? value[STATE_UNIT].text : "1",
            .at = entry[i].at,
            .initial = value[STATE_INITIAL].number[0],
        };
    }
    model->states = count;
}

void states_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count;
    Entry *entry = section_entries(reader, map, "state", &count);
    const LawNames names = {.model = model, .reads = &reader->reads, .early = "states"};
    for (int i = 0; i < count; ++i) {
        const char *what = pool_print(reader->pool, "rate of %s", entry[i].what);
        const bool read = model->state[i].read; /* by others: its own rate does not count */
        model->state[i].rate =
            law_parse(reader->pool, doc_find(entry[i].item, state_key[STATE_RATE].name), what, &names);
        model->state[i].read = read;
        model->state[i].fast = model->fast_states++;
    }
}
