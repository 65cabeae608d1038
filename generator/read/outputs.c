/* SPDX-License-Identifier: MIT
 * Outputs (FORMAT.md section 9): what each refers to, and the names and units of its components. */
#include "base/yaml.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/read.h"
#include "read/reader.h"

#include <string.h>

enum {
    WATCH_TYPE,
    WATCH_BODY,
    WATCH_POINT,
    WATCH_IN,
    WATCH_COORDINATE,
    WATCH_ELEMENT,
    WATCH_JOINT,
    WATCH_WHEEL,
    WATCH_SIGNAL,
    WATCH_KEYS
};

#define FRAMED_POINTS (FORM(OUTPUT_VELOCITY) | FORM(OUTPUT_ACCELERATION))
#define FRAMED (FRAMED_POINTS | FORM(OUTPUT_ANGULAR_VELOCITY) | FORM(OUTPUT_REACTION))
#define POINTS (FRAMED_POINTS | FORM(OUTPUT_POSITION))
#define ROTATIONS (FORM(OUTPUT_ORIENTATION) | FORM(OUTPUT_ROLL_PITCH_YAW) | FORM(OUTPUT_ANGULAR_VELOCITY))
#define OF_COORDINATES (FORM(OUTPUT_COORDINATE) | FORM(OUTPUT_DRIVE_FORCE))

#define WATCH_WHEELS (FORM(OUTPUT_WHEEL) | FORM(OUTPUT_TIRE) | FORM(OUTPUT_CONTACT))

static const Key output_key[WATCH_KEYS] = {
    [WATCH_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [WATCH_BODY] = {"body", KEY_BODY, POINTS | ROTATIONS, POINTS | ROTATIONS, BOUND_NONE, 0},
    [WATCH_POINT] = {"point", KEY_POINT, POINTS, 0, BOUND_NONE, 0},
    [WATCH_IN] = {"in", KEY_FRAME, FRAMED, 0, BOUND_NONE, 0},
    [WATCH_COORDINATE] = {"coordinate", KEY_COORDINATE, OF_COORDINATES, OF_COORDINATES, BOUND_NONE, 0},
    [WATCH_ELEMENT] = {"element", KEY_FORCE, FORM(OUTPUT_FORCE), FORM(OUTPUT_FORCE), BOUND_NONE, 0},
    [WATCH_JOINT] = {"joint", KEY_JOINT, FORM(OUTPUT_REACTION), FORM(OUTPUT_REACTION), BOUND_NONE, 0},
    [WATCH_WHEEL] = {"wheel", KEY_WHEEL, WATCH_WHEELS, WATCH_WHEELS, BOUND_NONE, 0},
    [WATCH_SIGNAL] = {"signal", KEY_SIGNAL, FORM(OUTPUT_SIGNAL), FORM(OUTPUT_SIGNAL), BOUND_NONE, 0},
};

/* Components and units of each type; a single component "" has no suffix. angle_unit: units for coordinates that are
 * angles. */
typedef struct OutputKind {
    int count;
    const char *component[OUTPUT_MAX_COMPONENTS], *unit[OUTPUT_MAX_COMPONENTS], *angle_unit[OUTPUT_MAX_COMPONENTS];
} OutputKind;

static const OutputKind output_kind[OUTPUT_TYPES] = {
    [OUTPUT_POSITION] = {3, {"x", "y", "z"}, {"m", "m", "m"}, {0}},
    [OUTPUT_VELOCITY] = {3, {"x", "y", "z"}, {"m/s", "m/s", "m/s"}, {0}},
    [OUTPUT_ACCELERATION] = {3, {"x", "y", "z"}, {"m/s^2", "m/s^2", "m/s^2"}, {0}},
    [OUTPUT_ORIENTATION] = {4, {"e0", "e1", "e2", "e3"}, {"1", "1", "1", "1"}, {0}},
    [OUTPUT_ROLL_PITCH_YAW] = {3, {"roll", "pitch", "yaw"}, {"rad", "rad", "rad"}, {0}},
    [OUTPUT_ANGULAR_VELOCITY] = {3, {"x", "y", "z"}, {"rad/s", "rad/s", "rad/s"}, {0}},
    [OUTPUT_COORDINATE] = {3, {"value", "rate", "acceleration"}, {"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}},
    [OUTPUT_FORCE] = {1, {""}, {"N"}, {"N m"}},
    [OUTPUT_DRIVE_FORCE] = {1, {""}, {"N"}, {"N m"}},
    [OUTPUT_REACTION] = {6,
                         {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"},
                         {"N", "N", "N", "N m", "N m", "N m"},
                         {0}},
    [OUTPUT_WHEEL] = {4, {"fz", "deflection", "deflection_rate", "height"}, {"N", "m", "m/s", "m"}, {0}},
    [OUTPUT_TIRE] = {12,
                     {"fx", "fy", "mx", "my", "mz", "kappa", "alpha", "camber", "spin", "spin_rate", "drive", "brake"},
                     {"N", "N", "N m", "N m", "N m", "1", "rad", "rad", "rad/s", "rad/s^2", "N m", "N m"},
                     {0}},
    [OUTPUT_CONTACT] = {3, {"x", "y", "z"}, {"m", "m", "m"}, {0}},
    [OUTPUT_POWERTRAIN] = {8,
                           {"engine_speed", "engine_torque", "throttle", "gear", "ratio", "turbine_speed",
                            "turbine_torque", "pump_torque"},
                           {"rad/s", "N m", "1", "1", "1", "rad/s", "N m", "N m"},
                           {0}},
    [OUTPUT_ENERGY] = {3, {"kinetic", "potential", "power"}, {"J", "J", "W"}, {0}},
    [OUTPUT_SIGNAL] = {1, {""}, {"1"}, {0}}, /* its unit is the signal's */
};

#define BIT(component) (1u << (component))

bool output_is_odd(OutputType type, int component)
{
    /* y of points and forces; x and z of what turns; the angles and slips of tires that change the side */
    static const unsigned odd[OUTPUT_TYPES] = {
        [OUTPUT_POSITION] = BIT(1),
        [OUTPUT_VELOCITY] = BIT(1),
        [OUTPUT_ACCELERATION] = BIT(1),
        [OUTPUT_ORIENTATION] = BIT(1) | BIT(3),
        [OUTPUT_ROLL_PITCH_YAW] = BIT(0) | BIT(2),
        [OUTPUT_ANGULAR_VELOCITY] = BIT(0) | BIT(2),
        [OUTPUT_REACTION] = BIT(1) | BIT(3) | BIT(5),
        [OUTPUT_TIRE] = BIT(1) | BIT(2) | BIT(4) | BIT(6) | BIT(7),
        [OUTPUT_CONTACT] = BIT(1),
    };
    return odd[type] & BIT(component);
}

bool output_follows_accelerations(OutputType type, int component)
{
    switch (type) {
    case OUTPUT_ACCELERATION:
    case OUTPUT_DRIVE_FORCE:
    case OUTPUT_REACTION:
    case OUTPUT_ENERGY: return true;
    case OUTPUT_COORDINATE: return component == 2;
    case OUTPUT_TIRE: return component == TIRE_SPIN + 1; /* spin_rate */
    default: return false;
    }
}

static const char *const output_about[WATCH_KEYS] = {
    [WATCH_TYPE] = "what is put out",
    [WATCH_BODY] = "the body that it is about",
    [WATCH_POINT] = "point of the body at design, m, model frame; default: origin of the body frame",
    [WATCH_IN] = "the body in whose frame components are given; default `world`",
    [WATCH_COORDINATE] = "the dual coordinate that it is about",
    [WATCH_ELEMENT] = "the force element whose force (N) or torque (N m) it is",
    [WATCH_JOINT] = "the joint whose force (N) and torque (N m) on its second body it is",
    [WATCH_WHEEL] = "the wheel that it is about",
    [WATCH_SIGNAL] = "the entry of signals whose value it is",
};

const Section output_section = {output_key,       WATCH_KEYS, output_type_name, OUTPUT_TYPES,
                                output_type_name, NULL,       output_about};

/* True if the output is about an angle, directly or by a force along or about it. */
static bool of_angle(const Model *model, const Output *output)
{
    int coordinate = -1;
    if (output->type == OUTPUT_FORCE && force_is_torque(&model->force[output->index]))
        return true;
    if (output->type == OUTPUT_COORDINATE || output->type == OUTPUT_DRIVE_FORCE)
        coordinate = output->index;
    else if (output->type == OUTPUT_FORCE)
        coordinate = model->force[output->index].coordinate;
    return coordinate >= 0 && model->coordinate[coordinate].type == COORDINATE_ANGLE;
}

static void components_set(Pool *pool, const Model *model, Output *output)
{
    const OutputKind *kind = output_kind + output->type;
    const char *const *unit = of_angle(model, output) ? kind->angle_unit : kind->unit;
    output->count = kind->count;
    for (int i = 0; i < kind->count; ++i) {
        const char *suffix = kind->component[i];
        output->component[i] = pool_print(pool, suffix[0] ? "%s.%s" : "%s%s", output->name, suffix);
        output->unit[i] = output->type == OUTPUT_SIGNAL ? model->signal[output->index].unit : unit[i];
    }
}

static void output_read(Reader *reader, const Entry *entry, Output *output)
{
    Value value[WATCH_KEYS];
    OutputType type = (OutputType)section_type(reader, &output_section, entry);
    section_read(reader, &output_section, (int)type, entry, value);
    *output = (Output){
        .name = entry->name, .at = entry->at, .type = type, .body = BODY_GROUND, .in = BODY_GROUND, .index = -1};
    if (value[WATCH_BODY].item)
        output->body = value[WATCH_BODY].index[0];
    if (value[WATCH_POINT].item)
        body_point(reader, output->body, value[WATCH_POINT].number, value[WATCH_POINT].tuned,
                   value[WATCH_POINT].item->at, output->point);
    if (value[WATCH_IN].item)
        output->in = value[WATCH_IN].index[0];
    for (int k = WATCH_COORDINATE; k <= WATCH_SIGNAL; ++k)
        if (value[k].item)
            output->index = value[k].index[0];
    if (type == OUTPUT_DRIVE_FORCE && !reader->model->coordinate[output->index].driven)
        diag_fail(value[WATCH_COORDINATE].item->at, "write `driven: true` there, or ask for `type: coordinate`",
                  "%s: coordinate '%s' is free, so nothing drives it", entry->what,
                  reader->model->coordinate[output->index].name);
    if (type == OUTPUT_FORCE && reader->model->force[output->index].type == FORCE_LOAD)
        diag_fail(value[WATCH_ELEMENT].item->at,
                  "name the formula of one of its components under `signals`, let the load read that name, and ask for "
                  "`type: signal`",
                  "%s: load '%s' has components of force and torque, no single force", entry->what,
                  reader->model->force[output->index].name);
    const ForceType acting = type == OUTPUT_FORCE ? reader->model->force[output->index].type : FORCE_TYPES;
    if (acting == FORCE_AERO || acting == FORCE_BUSHING)
        diag_fail(value[WATCH_ELEMENT].item->at,
                  "write its law as formulas under `signals`, which outputs of `type: signal` show",
                  "%s: force '%s' has components of force and moment, no single force", entry->what,
                  reader->model->force[output->index].name);
    if ((type == OUTPUT_TIRE || type == OUTPUT_CONTACT) && reader->model->wheel[output->index].tire < 0)
        diag_fail(value[WATCH_WHEEL].item->at, "give that wheel a tire, or ask for `type: wheel`",
                  "%s: wheel '%s' has no tire", entry->what, reader->model->wheel[output->index].name);
    if (type == OUTPUT_POWERTRAIN && !reader->model->powertrain)
        diag_fail(entry->at, "add a `powertrain`, or ask for something else", "%s: the model has no powertrain",
                  entry->what);
    components_set(reader->pool, reader->model, output);
}

/* The default outputs: pose and velocity of a free base, every coordinate, every signal. */
static void default_outputs(Reader *reader)
{
    static const struct {
        const char *suffix;
        OutputType type;
    } of_base[] = {
        {"position", OUTPUT_POSITION},
        {"orientation", OUTPUT_ORIENTATION},
        {"velocity", OUTPUT_VELOCITY},
    };
    Model *model = reader->model;
    const Body *base = model->body + BODY_BASE;
    for (int i = 0; model->free_base && i < 3; ++i)
        model->output[model->outputs++] = (Output){
            .name = pool_print(reader->pool, "%s_%s", base->name, of_base[i].suffix),
            .at = base->at,
            .type = of_base[i].type,
            .body = BODY_BASE,
            .in = BODY_GROUND,
            .index = -1,
        };
    for (int i = 0; i < model->coordinates; ++i)
        model->output[model->outputs++] = (Output){
            .name = model->coordinate[i].name,
            .at = model->coordinate[i].at,
            .type = OUTPUT_COORDINATE,
            .body = BODY_GROUND,
            .in = BODY_GROUND,
            .index = i,
        };
    for (int i = 0; i < model->signals; ++i)
        model->output[model->outputs++] = (Output){
            .name = model->signal[i].name,
            .at = model->signal[i].at,
            .type = OUTPUT_SIGNAL,
            .body = BODY_GROUND,
            .in = BODY_GROUND,
            .index = i,
        };
    for (int i = 0; i < model->outputs; ++i)
        components_set(reader->pool, model, model->output + i);
}

void outputs_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count;
    Entry *entry = section_entries(reader, map, "output", &count);
    model->output =
        pool_alloc(reader->pool, sizeof *model->output * (size_t)(count + model->coordinates + model->signals + 3));
    if (!map)
        default_outputs(reader);
    for (int i = 0; i < count; ++i)
        output_read(reader, entry + i, model->output + model->outputs++);
    for (int i = 0; i < model->outputs; ++i)
        model->output_components += model->output[i].count;
    outputs_names_check(reader);
}

void outputs_names_check(Reader *reader)
{
    const Model *model = reader->model;
    size_t room = (size_t)(OUTPUT_MAX_COMPONENTS * model->outputs + 1);
    const char **name = pool_alloc(reader->pool, sizeof *name * room);
    Place *at = pool_alloc(reader->pool, sizeof *at * room);
    int count = 0;
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k) {
            name[count] = model->output[i].component[k];
            at[count++] = model->output[i].at;
        }
    generated_names_check(reader, "output", name, at, count);
}

/* ---- outputs that a page of ours wants ----------------------------------------------------------------------- */

static bool is_watched(const Model *model, OutputType type, int wheel)
{
    for (int i = 0; i < model->outputs; ++i)
        if (model->output[i].type == type && model->output[i].index == wheel)
            return true;
    return false;
}

/* A copy of a model with room for more outputs. */
static Model *copy_with_room(Pool *pool, const Model *model, int more)
{
    Model *out = pool_alloc(pool, sizeof *out);
    *out = *model;
    out->output = pool_alloc(pool, sizeof *out->output * (size_t)(model->outputs + more + 1));
    for (int i = 0; i < model->outputs; ++i)
        output_copy(model, &out->output[i], &model->output[i]);
    return out;
}

const Model *model_watch_wheels(Pool *pool, const Model *model)
{
    static const OutputType wanted[] = {OUTPUT_WHEEL, OUTPUT_TIRE, OUTPUT_CONTACT};
    Model *out = copy_with_room(pool, model, 3 * model->wheels);
    for (int w = 0; w < model->wheels; ++w)
        for (int k = 0; k < (model->wheel[w].tire >= 0 ? 3 : 1); ++k) {
            if (is_watched(model, wanted[k], w))
                continue;
            Output *output = &out->output[out->outputs++];
            *output = (Output){.name = pool_print(pool, "_%s_%s", output_type_name[wanted[k]], model->wheel[w].name),
                               .at = model->wheel[w].at,
                               .type = wanted[k],
                               .body = BODY_GROUND,
                               .in = BODY_GROUND,
                               .index = w,
                               .hidden = true};
            components_set(pool, model, output);
            out->output_components += output->count;
        }
    return out;
}

const Model *model_watch_body(Pool *pool, const Model *model, int body, const double point[3])
{
    static const OutputType wanted[] = {OUTPUT_POSITION, OUTPUT_ACCELERATION, OUTPUT_ROLL_PITCH_YAW,
                                        OUTPUT_ANGULAR_VELOCITY};
    const int count = sizeof wanted / sizeof *wanted;
    Model *out = copy_with_room(pool, model, count);
    for (int k = 0; k < count; ++k) {
        Output *output = &out->output[out->outputs++];
        *output = (Output){.name = pool_print(pool, "_%s_%s", output_type_name[wanted[k]], model->body[body].name),
                           .at = model->body[body].at,
                           .type = wanted[k],
                           .body = body,
                           .point = {point[0], point[1], point[2]},
                           .in = BODY_GROUND,
                           .index = -1,
                           .hidden = true};
        components_set(pool, model, output);
        out->output_components += output->count;
    }
    return out;
}
