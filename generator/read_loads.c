/* SPDX-License-Identifier: MIT
 * Inputs, force elements and wheels (FORMAT.md sections 6 to 8). */
#include "read.h"

#include <string.h>

enum { INPUT_UNIT, INPUT_DEFAULT, INPUT_KEYS };

static const Key input_key[INPUT_KEYS] = {
    [INPUT_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
    [INPUT_DEFAULT] = {"default", KEY_NUMBER, ALL_FORMS, 0, BOUND_NONE, 0},
};

const Section input_section = {input_key, INPUT_KEYS, NULL, 0, NULL};

enum {
    SPRING_TYPE,
    SPRING_COORDINATE,
    SPRING_BODIES,
    SPRING_POINTS,
    SPRING_STIFFNESS,
    SPRING_DAMPING,
    SPRING_FREE,
    SPRING_VALUE,
    SPRING_KEYS
};

#define FORCE_ALONG (FORM(FORCE_COORDINATE) | FORM(FORCE_CONSTANT))
#define FORCE_SPRING (FORM(FORCE_COORDINATE) | FORM(FORCE_POINTS))

static const Key force_key[SPRING_KEYS] = {
    [SPRING_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [SPRING_COORDINATE] = {"coordinate", KEY_COORDINATE, FORCE_ALONG, FORCE_ALONG, BOUND_NONE, 0},
    [SPRING_BODIES] = {"bodies", KEY_FORCE_BODIES, FORM(FORCE_POINTS), FORM(FORCE_POINTS), BOUND_NONE, 0},
    [SPRING_POINTS] = {"points", KEY_POINTS, FORM(FORCE_POINTS), FORM(FORCE_POINTS), BOUND_NONE, 0},
    [SPRING_STIFFNESS] = {"stiffness", KEY_NUMBER, FORCE_SPRING, 0, BOUND_NOT_NEGATIVE, 0},
    [SPRING_DAMPING] = {"damping", KEY_NUMBER, FORCE_SPRING, 0, BOUND_NOT_NEGATIVE, 0},
    [SPRING_FREE] = {"free", KEY_NUMBER, FORCE_SPRING, 0, BOUND_NONE, 0},
    [SPRING_VALUE] = {"value", KEY_NUMBER, FORM(FORCE_CONSTANT), FORM(FORCE_CONSTANT), BOUND_NONE, 0},
};

static const char *const force_type_name[] = {"spring_damper", "constant"};

static const char *const force_form_name[FORCE_TYPES] = {
    [FORCE_COORDINATE] = "along a coordinate",
    [FORCE_POINTS] = "between two points",
    [FORCE_CONSTANT] = "constant",
};

const Section force_section = {force_key, SPRING_KEYS, force_type_name, 2, force_form_name};

enum { TIRE_BODY, TIRE_CENTER, TIRE_RADIUS, TIRE_STIFFNESS, TIRE_DAMPING, TIRE_FADE, TIRE_KEYS };

static const Key wheel_key[TIRE_KEYS] = {
    [TIRE_BODY] = {"body", KEY_BODY, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [TIRE_CENTER] = {"center", KEY_POINT, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [TIRE_RADIUS] = {"radius", KEY_NUMBER, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [TIRE_STIFFNESS] = {"stiffness", KEY_NUMBER, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [TIRE_DAMPING] = {"damping", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 0},
    [TIRE_FADE] = {"fade", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0.01},
};

const Section wheel_section = {wheel_key, TIRE_KEYS, NULL, 0, NULL};

/* The three inputs of a driven coordinate: value, rate, acceleration. */
static void driven_inputs(Reader *reader, Coordinate *coordinate)
{
    static const char *const suffix[3] = {"", ".rate", ".acceleration"};
    static const char *const unit[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    Model *model = reader->model;
    coordinate->input = model->inputs;
    for (int i = 0; i < 3; ++i)
        model->input[model->inputs++] = (Input){
            .name = pool_print(reader->pool, "%s%s", coordinate->name, suffix[i]),
            .unit = unit[coordinate->type == COORDINATE_ANGLE][i],
            .initial = i == 0 ? coordinate->initial : 0,
        };
}

void inputs_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count;
    Entry *entry = section_entries(reader, map, "input", &count);
    size_t room = (size_t)(count + 3 * model->coordinates + 1);
    model->input = pool_alloc(reader->pool, sizeof *model->input * room);
    const char **name = pool_alloc(reader->pool, sizeof *name * room);
    Place *at = pool_alloc(reader->pool, sizeof *at * room);
    for (int i = 0; i < model->coordinates; ++i)
        if (model->coordinate[i].driven) {
            driven_inputs(reader, model->coordinate + i);
            for (int k = model->coordinate[i].input; k < model->inputs; ++k)
                at[k] = model->coordinate[i].at;
        }
    for (int i = 0; i < count; ++i) {
        Value value[INPUT_KEYS];
        section_read(reader, &input_section, 0, entry + i, value);
        at[model->inputs] = entry[i].at;
        model->input[model->inputs++] = (Input){
            .name = entry[i].name,
            .unit = value[INPUT_UNIT].item ? value[INPUT_UNIT].text : "1",
            .initial = value[INPUT_DEFAULT].number[0],
        };
    }
    for (int i = 0; i < model->inputs; ++i)
        name[i] = model->input[i].name;
    generated_names_check(reader, "input", name, at, model->inputs);
}

static void force_read(Reader *reader, const Entry *entry, Force *force)
{
    Value value[SPRING_KEYS];
    bool constant = section_type(reader, &force_section, entry) == 1;
    bool along = doc_find(entry->item, "coordinate");
    bool between = doc_find(entry->item, "bodies") || doc_find(entry->item, "points");
    if (!along && !between && !constant)
        diag_fail(entry->at, "add `coordinate: name`, or `bodies: [a, b]` and `points: [p_a, p_b]`",
                  "%s acts nowhere: neither a coordinate nor two bodies are given", entry->what);
    ForceType type = constant ? FORCE_CONSTANT : along ? FORCE_COORDINATE : FORCE_POINTS;
    section_read(reader, &force_section, (int)type, entry, value);
    *force = (Force){
        .name = entry->name,
        .at = entry->at,
        .type = type,
        .coordinate = -1,
        .body = {BODY_GROUND, BODY_GROUND},
        .stiffness = value[SPRING_STIFFNESS].number[0],
        .damping = value[SPRING_DAMPING].number[0],
        .constant = value[SPRING_VALUE].number[0],
    };
    if (type != FORCE_POINTS) {
        force->coordinate = value[SPRING_COORDINATE].index[0];
        force->free = reader->model->coordinate[force->coordinate].design;
    } else {
        const Value *points = value + SPRING_POINTS;
        double d[3];
        force->free = points_distance(points, entry->what, d);
        for (int i = 0; i < 2; ++i) {
            force->body[i] = value[SPRING_BODIES].index[i];
            body_point(reader, force->body[i], points->number + 3 * i, points->item->value[i]->at, force->point[i]);
        }
    }
    if (value[SPRING_FREE].item)
        force->free = value[SPRING_FREE].number[0];
}

void forces_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "force", &model->forces);
    model->force = pool_alloc(reader->pool, sizeof *model->force * (size_t)(model->forces + 1));
    for (int i = 0; i < model->forces; ++i)
        force_read(reader, entry + i, model->force + i);
}

void wheels_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "wheel", &model->wheels);
    model->wheel = pool_alloc(reader->pool, sizeof *model->wheel * (size_t)(model->wheels + 1));
    for (int i = 0; i < model->wheels; ++i) {
        Value value[TIRE_KEYS];
        section_read(reader, &wheel_section, 0, entry + i, value);
        Wheel *wheel = model->wheel + i;
        *wheel = (Wheel){
            .name = entry[i].name,
            .at = entry[i].at,
            .body = value[TIRE_BODY].index[0],
            .radius = value[TIRE_RADIUS].number[0],
            .stiffness = value[TIRE_STIFFNESS].number[0],
            .damping = value[TIRE_DAMPING].number[0],
            .fade = value[TIRE_FADE].number[0],
        };
        if (!model->free_base && wheel->body == BODY_BASE)
            diag_fail(value[TIRE_BODY].item->at, "name the body that carries it", "%s: ground can't roll on the road",
                      entry[i].what);
        body_point(reader, wheel->body, value[TIRE_CENTER].number, value[TIRE_CENTER].item->at, wheel->center);
    }
}
