/* SPDX-License-Identifier: MIT
 * A `.veh` file into a Model, as models/FORMAT.md defines it. Sections are read in the order of their references,
 * not in the order of the file. */
#include "base/yaml.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/read.h"
#include "read/reader.h"

#include <string.h>

enum {
    FILE_GICGEN,
    FILE_INCLUDE,
    FILE_ARGUMENTS,
    FILE_MODEL,
    FILE_DESCRIPTION,
    FILE_GRAVITY,
    FILE_BASE,
    FILE_POINTS,
    FILE_BODIES,
    FILE_JOINTS,
    FILE_COORDINATES,
    FILE_INPUTS,
    FILE_PARAMETERS,
    FILE_TABLES,
    FILE_PORTS,
    FILE_STATES,
    FILE_SIGNALS,
    FILE_CONTROLLERS,
    FILE_FORCES,
    FILE_TIRES,
    FILE_WHEELS,
    FILE_POWERTRAIN,
    FILE_OUTPUTS,
    FILE_KEYS
};

static const Key file_key[FILE_KEYS] = {
    [FILE_GICGEN] = {"gicgen", KEY_NUMBER, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [FILE_INCLUDE] = {"include", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_ARGUMENTS] = {"arguments", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_MODEL] = {"model", KEY_NAME, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [FILE_DESCRIPTION] = {"description", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_GRAVITY] = {"gravity", KEY_VECTOR, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_BASE] = {"base", KEY_NAME, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [FILE_POINTS] = {"points", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_BODIES] = {"bodies", KEY_ITEM, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [FILE_JOINTS] = {"joints", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_COORDINATES] = {"coordinates", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_INPUTS] = {"inputs", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_PARAMETERS] = {"parameters", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_TABLES] = {"tables", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_PORTS] = {"ports", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_STATES] = {"states", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_SIGNALS] = {"signals", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_CONTROLLERS] = {"controllers", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_FORCES] = {"forces", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_TIRES] = {"tires", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_WHEELS] = {"wheels", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_POWERTRAIN] = {"powertrain", KEY_POWERTRAIN, ALL_FORMS, 0, BOUND_NONE, 0},
    [FILE_OUTPUTS] = {"outputs", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const file_about[FILE_KEYS] = {
    [FILE_GICGEN] = "version of the format: 1",
    [FILE_INCLUDE] = "other files whose contents belong to this one: paths or maps",
    [FILE_ARGUMENTS] = "numbers, points and bodies that a file which includes this one gives: a type each",
    [FILE_MODEL] = "name of the model, a C identifier: prefix of all generated names",
    [FILE_DESCRIPTION] = "one line of text for the header of the generated code",
    [FILE_GRAVITY] = "acceleration of gravity, m/s^2, world frame; default [0, 0, -9.81]",
    [FILE_BASE] = "the body that is the free base (a chassis), or `ground` for a fixed base",
    [FILE_POINTS] = "named points, m, model frame at design",
    [FILE_BODIES] = "the rigid bodies",
    [FILE_JOINTS] = "what ties bodies together",
    [FILE_COORDINATES] = "dual coordinates: what springs and actuators act along",
    [FILE_INPUTS] = "numbers that a scene or the calling program changes over time",
    [FILE_PARAMETERS] = "named numbers, worked into the code or tunable at run time",
    [FILE_TABLES] = "functions of one number, for formulas",
    [FILE_PORTS] = "external forces and torques that the calling program supplies",
    [FILE_STATES] = "numbers that change at rates by formulas: filters, actuators, controllers",
    [FILE_SIGNALS] = "formulas with names, which other formulas and outputs read",
    [FILE_CONTROLLERS] = "formulas that are evaluated at sampling times, and whose values are held",
    [FILE_FORCES] = "force elements: springs, dampers, force laws, loads",
    [FILE_TIRES] = "tires of wheels that roll, from .tir files or with their data",
    [FILE_WHEELS] = "contacts of bodies with the road of the scene",
    [FILE_POWERTRAIN] = "engine, converter, transmission and differentials that drive wheels with tires",
    [FILE_OUTPUTS] = "results and their names; default: pose and velocity of a free base, coordinates, and signals",
};

const Section file_section = {file_key, FILE_KEYS, NULL, 0, NULL, NULL, file_about};

static void points_read(Reader *reader, const Item *map)
{
    Entry *entry = section_entries(reader, map, "point", &reader->points);
    reader->point = pool_alloc(reader->pool, sizeof *reader->point * (size_t)(reader->points + 1));
    for (int i = 0; i < reader->points; ++i) {
        reader->point[i].name = entry[i].name;
        vector_read(reader, entry[i].item, entry[i].what, reader->point[i].x, 3, reader->point[i].tuned);
        point_check(entry[i].item, entry[i].what, reader->point[i].x);
    }
}

static Model *read_model(Pool *pool, const Item *whole)
{
    Model *model = pool_alloc(pool, sizeof *model);
    Reader reader = {.pool = pool, .model = model};
    const Item *file = file_mirrored(pool, whole);
    Value value[FILE_KEYS];
    *model =
        (Model){.source = file->at.source, .gravity = pool_alloc(pool, 3 * sizeof(double)), .tuning = tuning_new(pool)};
    model->gravity[0] = model->gravity[1] = 0;
    /* read first: any number may be a formula of parameters */
    parameters_read(&reader, doc_find(file, file_key[FILE_PARAMETERS].name));
    tables_read(&reader, doc_find(file, file_key[FILE_TABLES].name));
    section_read(&reader, &file_section, 0, &(Entry){"", "the model", file->at, file}, value);
    model->name = value[FILE_MODEL].text;
    model->description = value[FILE_DESCRIPTION].item ? value[FILE_DESCRIPTION].text : "";
    model_name_check(model->name, value[FILE_MODEL].item->at);
    model->gravity[2] = -9.81;
    if (value[FILE_GRAVITY].item) {
        memcpy(model->gravity, value[FILE_GRAVITY].number, 3 * sizeof *model->gravity);
        tuning_set(model->tuning, model->gravity, value[FILE_GRAVITY].tuned, 3);
    }
    points_read(&reader, value[FILE_POINTS].item);
    bodies_read(&reader, value[FILE_BASE].item, value[FILE_BODIES].item);
    joints_read(&reader, value[FILE_JOINTS].item);
    coordinates_read(&reader, value[FILE_COORDINATES].item);
    inputs_read(&reader, value[FILE_INPUTS].item);
    ports_read(&reader, value[FILE_PORTS].item);
    states_declare(&reader, value[FILE_STATES].item);
    controllers_declare(&reader, value[FILE_CONTROLLERS].item);
    couplers_read(&reader, value[FILE_JOINTS].item);
    signals_read(&reader, value[FILE_SIGNALS].item);
    forces_read(&reader, value[FILE_FORCES].item);
    tires_read(&reader, value[FILE_TIRES].item);
    wheels_read(&reader, value[FILE_WHEELS].item);
    states_read(&reader, value[FILE_STATES].item);
    powertrain_read(&reader, value[FILE_POWERTRAIN].item);
    controllers_place(&reader);
    own_states_check(&reader);
    wheels_driven_check(&reader, value[FILE_WHEELS].item);
    outputs_read(&reader, value[FILE_OUTPUTS].item);
    controllers_read(&reader, value[FILE_CONTROLLERS].item);
    signals_close(&reader);
    unread_tell(&reader);
    model->drawn = model->body;
    tuning_close(model);
    return model;
}

const Model *model_read(Pool *pool, const char *path)
{
    return read_model(pool, file_included(pool, path));
}

const Model *model_read_text(Pool *pool, const char *path, const char *text, size_t size)
{
    return read_model(pool, text_included(pool, path, text, size));
}

const Model *model_read_again(Pool *pool, const Model *earlier)
{
    return read_model(pool, known_included(pool, earlier->source));
}

const Model *model_read_set(Pool *pool, const Model *earlier, const FileNumber *setting, int count)
{
    return read_model(pool, settings_put(pool, known_included(pool, earlier->source), setting, count));
}

bool model_has_number(Pool *pool, const Model *model, const char *name)
{
    return setting_known(pool, known_included(pool, model->source), name);
}

const Model *model_read_fixed(Pool *pool, const Model *earlier, const FileNumber *setting, int count,
                              const double *parameter)
{
    const Item *file = settings_put(pool, known_included(pool, earlier->source), setting, count);
    Model *model = read_model(pool, parameters_put(pool, file, earlier, parameter));
    model->tuning = NULL;
    for (int i = 0; i < model->parameters; ++i)
        model->parameter[i].geometric = false;
    return model;
}
