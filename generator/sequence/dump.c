/* SPDX-License-Identifier: MIT
 * The resolved model as JSON, for programs that check gicgen (FORMAT.md section 11). */
#include "base/table.h"
#include "base/text.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "read/read.h"
#include "sequence/sequence.h"

#include <string.h>

static void add(Text *out, const char *s)
{
    text_add(out, s, strlen(s));
}

static void string(Text *out, const char *s)
{
    add(out, "\"");
    for (; *s; ++s)
        if (*s == '"' || *s == '\\')
            text_print(out, "\\%c", *s);
        else if ((unsigned char)*s < 0x20)
            text_print(out, "\\u%04x", (unsigned)*s);
        else
            text_add(out, s, 1);
    add(out, "\"");
}

/* `, "key": ` after the first pair of an object. */
static void key(Text *out, const char *name)
{
    text_print(out, ", \"%s\": ", name);
}

static void text_pair(Text *out, const char *name, const char *s)
{
    key(out, name);
    string(out, s);
}

static void integer_pair(Text *out, const char *name, int value)
{
    key(out, name);
    text_print(out, "%d", value);
}

static void vector(Text *out, const double *x, int size)
{
    add(out, "[");
    for (int i = 0; i < size; ++i)
        text_print(out, "%s%.17g", i ? ", " : "", x[i]);
    add(out, "]");
}

/* A vector of `size` numbers, a plain number if size is 0, null if the type has none. */
static void number_pair(Text *out, const char *name, const double *x, int size, bool applies)
{
    key(out, name);
    if (!applies)
        add(out, "null");
    else if (size)
        vector(out, x, size);
    else
        text_print(out, "%.17g", *x);
}

static void index_pair(Text *out, const char *name, int index, bool applies)
{
    if (applies)
        integer_pair(out, name, index);
    else
        number_pair(out, name, NULL, 0, false);
}

/* The start of entry i of a list, up to its name. */
static void begin(Text *out, int i, const char *name)
{
    add(out, i ? ",\n    {\"name\": " : "\n    {\"name\": ");
    string(out, name);
}

/* null: from mass and inertia */
static void shape_pair(Text *out, const BodyShape *shape)
{
    const bool box = shape->type == SHAPE_BOX, cylinder = shape->type == SHAPE_CYLINDER;
    text_print(out, ", \"shape\": {\"type\": ");
    string(out, shape_type_name[shape->type]);
    number_pair(out, "size", shape->size, 3, box && shape->size[0] > 0);
    number_pair(out, "radius", &shape->radius, 0, cylinder && shape->radius > 0);
    number_pair(out, "length", &shape->length, 0, cylinder && shape->length > 0);
    number_pair(out, "axis", shape->axis, 3, shape->along);
    number_pair(out, "center", shape->center, 3, shape->placed);
    integer_pair(out, "corners", shape->corners);
    integer_pair(out, "triangles", shape->triangles);
    add(out, "}");
}

static void bodies(Text *out, const Model *model)
{
    for (int i = 0; i < model->bodies; ++i) {
        const Body *body = model->body + i;
        begin(out, i, body->name);
        number_pair(out, "mass", &body->mass, 0, true);
        number_pair(out, "com", body->com, 3, true);
        number_pair(out, "inertia", body->inertia, 6, true);
        number_pair(out, "position", body->position, 3, true);
        number_pair(out, "euler", body->euler, 4, true);
        if (body->shape)
            shape_pair(out, body->shape);
        add(out, "}");
    }
}

/* Members of joints by their type, FORMAT.md section 4. */
static bool has_points(JointType type)
{
    return type != JOINT_PARALLEL && type != JOINT_PERPENDICULAR;
}

/* Members of joints that measure a turn. */
static bool has_sides(JointType type)
{
    return joint_is_geared(type) || joint_is_coupled(type);
}

static bool has_axis_b(JointType type)
{
    return type == JOINT_REVOLUTE || type == JOINT_PRISMATIC || type == JOINT_CYLINDRICAL || type == JOINT_UNIVERSAL ||
           type == JOINT_PARALLEL || type == JOINT_PERPENDICULAR || has_sides(type);
}

static bool has_axis_a(JointType type)
{
    return has_axis_b(type) || type == JOINT_REVOLUTE_SPHERICAL || type == JOINT_POINT_ON_LINE ||
           type == JOINT_POINT_IN_PLANE;
}

static void formula(Text *out, const Law *law, const Model *model);
static void formula_pair(Text *out, const char *name, const Law *law, const Model *model);

static void joints(Text *out, const Model *model)
{
    for (int i = 0; i < model->joints; ++i) {
        const Joint *joint = model->joint + i;
        bool hinged = joint->type == JOINT_REVOLUTE_SPHERICAL;
        begin(out, i, joint->name);
        text_pair(out, "type", joint_type_name[joint->type]);
        integer_pair(out, "a", joint->body[0]);
        integer_pair(out, "b", joint->body[1]);
        number_pair(out, "point_a", joint->point[0], 3, has_points(joint->type));
        number_pair(out, "point_b", joint->point[1], 3, has_points(joint->type));
        number_pair(out, "axis_a", joint->axis[0], 3, has_axis_a(joint->type));
        number_pair(out, "axis_b", joint->axis[1], 3, has_axis_b(joint->type));
        number_pair(out, "length", &joint->length, 0, hinged || joint->type == JOINT_DISTANCE);
        number_pair(out, "offset", &joint->offset, 0, hinged || has_sides(joint->type));
        for (int k = 0; k < 2 && has_sides(joint->type); ++k)
            number_pair(out, k ? "side_b" : "side_a", joint->side[k], 3, true);
        if (joint->value)
            formula_pair(out, "value", joint->value, model);
        add(out, "}");
    }
}

static void coordinates(Text *out, const Model *model)
{
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *coordinate = model->coordinate + i;
        bool angle = coordinate->type == COORDINATE_ANGLE, length = coordinate->type == COORDINATE_LENGTH;
        begin(out, i, coordinate->name);
        text_pair(out, "type", coordinate_type_name[coordinate->type]);
        integer_pair(out, "a", coordinate->body[0]);
        integer_pair(out, "b", coordinate->body[1]);
        number_pair(out, "point_a", coordinate->point[0], 3, !angle);
        number_pair(out, "point_b", coordinate->point[1], 3, !angle);
        number_pair(out, "axis_a", coordinate->axis, 3, !length);
        number_pair(out, "reference_a", coordinate->reference[0], 3, angle);
        number_pair(out, "reference_b", coordinate->reference[1], 3, angle);
        number_pair(out, "design", &coordinate->design, 0, true);
        number_pair(out, "initial", &coordinate->initial, 0, true);
        number_pair(out, "offset", &coordinate->offset, 0, !angle && !length);
        number_pair(out, "range", coordinate->range, 2, true);
        key(out, "driven");
        add(out, coordinate->driven ? "true}" : "false}");
    }
}

/* A signal by its formula; a component of an output by all that it follows. */
static void signal_read(Text *out, const Law *law, const Model *model)
{
    const Signal *signal = &model->signal[law->index];
    const Output *output = &signal->output;
    if (law->number < 0)
        add(out, "[\"-\", ");
    if (signal->law)
        formula(out, signal->law, model);
    else
        text_print(out, "[\"signal\", \"%s\", %d, %d, %d, %d, %.17g, %.17g, %.17g]", output_type_name[output->type],
                   signal->component, output->body, output->in, output->index, output->point[0], output->point[1],
                   output->point[2]);
    if (law->number < 0)
        add(out, "]");
}

/* A formula as nested lists, operator first; parameters as their values. */
static void formula(Text *out, const Law *law, const Model *model)
{
    static const char *const word[] = {[LAW_INPUT] = "input",
                                       [LAW_STATE] = "state",
                                       [LAW_VALUE] = "value",
                                       [LAW_RATE] = "rate",
                                       [LAW_TABLE] = "table"};
    switch (law->op) {
    case LAW_SIGNAL: signal_read(out, law, model); return;
    case LAW_NUMBER:
    case LAW_PARAMETER: text_print(out, "%.17g", law_number(law, model)); return;
    case LAW_TIME:
    case LAW_LOCAL: text_print(out, "[\"%s\"]", law->name); return;
    case LAW_CALL: text_print(out, "[\"%s\"", law->name); break;
    default: text_print(out, "[\"%s\", %d", word[law->op], law->index);
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i) {
        add(out, ", ");
        formula(out, law->arg[i], model);
    }
    add(out, "]");
}

/* A law of numbers and parameters as its value; NULL: does not apply. */
static void law_pair(Text *out, const char *name, const Law *law, const Model *model)
{
    double number = law ? law_number(law, model) : 0;
    number_pair(out, name, &number, 0, law);
}

/* A symmetric matrix, row by row. */
static void matrix_pair(Text *out, const char *name, const Law *const law[BUSHING_NUMBERS], const Model *model)
{
    double number[BUSHING_AXES * BUSHING_AXES];
    for (int i = 0; i < BUSHING_AXES * BUSHING_AXES; ++i) {
        const Law *of = law[bushing_place(i / BUSHING_AXES, i % BUSHING_AXES)];
        number[i] = of ? law_number(of, model) : 0;
    }
    number_pair(out, name, number, BUSHING_AXES * BUSHING_AXES, true);
}

static void bushing_pairs(Text *out, const Bushing *bushing, const Model *model)
{
    number_pair(out, "frame_a", bushing->frame[0], 9, true);
    number_pair(out, "frame_b", bushing->frame[1], 9, true);
    matrix_pair(out, "stiffness_matrix", bushing->stiffness, model);
    matrix_pair(out, "damping_matrix", bushing->damping, model);
}

static void forces(Text *out, const Model *model)
{
    static const char *const type[FORCE_TYPES] = {[FORCE_COORDINATE] = "coordinate",
                                                  [FORCE_POINTS] = "points",
                                                  [FORCE_AXIS] = "axis",
                                                  [FORCE_COORDINATE_LAW] = "coordinate_law",
                                                  [FORCE_POINTS_LAW] = "points_law",
                                                  [FORCE_AXIS_LAW] = "axis_law",
                                                  [FORCE_COORDINATE_STOP] = "coordinate_stop",
                                                  [FORCE_POINTS_STOP] = "points_stop",
                                                  [FORCE_AXIS_STOP] = "axis_stop",
                                                  [FORCE_LOAD] = "load",
                                                  [FORCE_AERO] = "aero",
                                                  [FORCE_BUSHING] = "bushing"};
    for (int i = 0; i < model->forces; ++i) {
        const Force *force = model->force + i;
        bool along = force->coordinate >= 0, about = force_is_torque(force), wrench = force_is_wrench(force);
        begin(out, i, force->name);
        text_pair(out, "type", type[force->type]);
        integer_pair(out, "coordinate", force->coordinate);
        for (int k = 0; k < 2; ++k)
            index_pair(out, k ? "b" : "a", force->body[k], !along);
        number_pair(out, "point_a", force->point[0], 3, !along && !about);
        number_pair(out, "point_b", force->point[1], 3, !along && !about && (!wrench || force->bushing));
        number_pair(out, "axis_a", force->axis, 3, about);
        number_pair(out, "reference_a", force->reference[0], 3, about);
        number_pair(out, "reference_b", force->reference[1], 3, about);
        law_pair(out, "stiffness", force->table < 0 ? force->stiffness : NULL, model);
        law_pair(out, "damping", force->damping, model);
        law_pair(out, "free", force->free, model);
        law_pair(out, "low", force->low, model);
        law_pair(out, "high", force->high, model);
        law_pair(out, "fade", force->fade, model);
        if (force->type == FORCE_AERO) {
            law_pair(out, "area", force->area, model);
            law_pair(out, "reference_length", force->length, model);
        }
        if (force->bushing)
            bushing_pairs(out, force->bushing, model);
        index_pair(out, "table", force->table, force->table >= 0);
        key(out, "law");
        add(out, "[");
        for (int k = 0; k < force_laws(force); ++k) {
            add(out, k ? ", " : "");
            if (force->law[k])
                formula(out, force->law[k], model);
            else
                add(out, "0");
        }
        add(out, "]}");
    }
}

static void tables(Text *out, const Model *model)
{
    for (int i = 0; i < model->tables; ++i) {
        const Table *table = model->table + i;
        begin(out, i, table->name);
        key(out, "x");
        vector(out, table->x, table->count);
        key(out, "y");
        vector(out, table->y, table->count);
        text_pair(out, "interpolation", table->cubic ? "cubic" : "linear");
        text_pair(out, "beyond", table->onward ? "linear" : "constant");
        add(out, "}");
    }
}

static void parameters(Text *out, const Model *model)
{
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *parameter = model->parameter + i;
        begin(out, i, parameter->name);
        text_pair(out, "unit", parameter->unit);
        number_pair(out, "value", &parameter->value, 0, true);
        key(out, "tunable");
        add(out, parameter->tunable ? "true}" : "false}");
    }
}

static void states(Text *out, const Model *model)
{
    for (int i = 0; i < model->states; ++i) {
        const State *state = model->state + i;
        begin(out, i, state->name);
        text_pair(out, "unit", state->unit);
        number_pair(out, "initial", &state->initial, 0, true);
        integer_pair(out, "fast", state->fast);
        key(out, "rate");
        if (state->rate)
            formula(out, state->rate, model);
        else
            add(out, "0");
        add(out, "}");
    }
}

static void rules(Text *out, const Controller *controller, const Model *model)
{
    add(out, ", \"rules\": [");
    for (int i = 0; i < controller->rules; ++i) {
        const ControlRule *rule = &controller->rule[i];
        begin(out, i, rule->name);
        integer_pair(out, "state", rule->state);
        formula_pair(out, "value", rule->signal >= 0 ? model->signal[rule->signal].law : NULL, model);
        integer_pair(out, "waiting", rule->waiting);
        number_pair(out, "late", &rule->late, 0, true);
        integer_pair(out, "effects", rule->effects);
        number_pair(out, "quantum", &rule->quantum, 0, true);
        add(out, "}");
    }
    add(out, "]");
}

static void controllers(Text *out, const Model *model)
{
    for (int i = 0; i < model->controllers; ++i) {
        const Controller *controller = &model->controller[i];
        begin(out, i, controller->name);
        number_pair(out, "period", &controller->period, 0, true);
        number_pair(out, "offset", &controller->offset, 0, true);
        integer_pair(out, "samples", controller->samples);
        rules(out, controller, model);
        add(out, "}");
    }
}

static void ports(Text *out, const Model *model)
{
    for (int i = 0; i < model->ports; ++i) {
        const Port *port = model->port + i;
        begin(out, i, port->name);
        integer_pair(out, "body", port->body);
        number_pair(out, "point", port->point, 3, true);
        integer_pair(out, "in", port->in);
        add(out, "}");
    }
}

/* One number, or two if size is 2; returns the place of the next ones. */
static const double *data_pair(Text *out, const char *name, const double *number, int size, bool first)
{
    text_print(out, "%s\"%s\": ", first ? "" : ", ", name);
    if (size == 1)
        text_print(out, "%.17g", *number);
    else
        vector(out, number, size);
    return number + size;
}

/* Numbers by their names in the lists of model/tire_numbers.h. */
static void tire_data(Text *out, const Tire *tire)
{
    const double *number = tire->number;
    key(out, "data");
    add(out, "{");
#define ONE(name) number = data_pair(out, #name, number, 1, number == tire->number);
#define TWO(name) number = data_pair(out, #name, number, 2, false);
    if (tire->type == TIRE_TMEASY) {
        TMEASY_LIST(ONE, TWO)
    } else {
        PAC_LIST(ONE)
    }
#undef TWO
#undef ONE
    add(out, "}");
}

static void tires(Text *out, const Model *model)
{
    static const char *const type[TIRE_TYPES] = {[TIRE_PAC2002] = "pac2002", [TIRE_TMEASY] = "tmeasy"};
    static const char *const side[] = {[SIDE_LEFT] = "left", [SIDE_RIGHT] = "right", [SIDE_SYMMETRIC] = "symmetric"};
    for (int i = 0; i < model->tires; ++i) {
        const Tire *tire = model->tire + i;
        begin(out, i, tire->name);
        text_pair(out, "type", type[tire->type]);
        text_pair(out, "side", side[tire->side]);
        index_pair(out, "mode", tire->mode, tire->type == TIRE_PAC2002);
        number_pair(out, "radius", &tire->radius, 0, true);
        number_pair(out, "stiffness", &tire->stiffness, 0, true);
        number_pair(out, "damping", &tire->damping, 0, true);
        number_pair(out, "bottom_stiffness", &tire->bottom_stiffness, 0, true);
        number_pair(out, "bottom", &tire->bottom, 0, true);
        number_pair(out, "low_speed", &tire->low_speed, 0, true);
        number_pair(out, "relaxation", tire->relaxation, 2, true);
        tire_data(out, tire);
        add(out, "}");
    }
}

static void formula_pair(Text *out, const char *name, const Law *law, const Model *model)
{
    key(out, name);
    if (law)
        formula(out, law, model);
    else
        add(out, "null");
}

/* Members of wheels with a tire. */
static void wheel_rolls(Text *out, const Model *model, const Wheel *wheel)
{
    bool rolls = wheel->tire >= 0;
    index_pair(out, "tire", wheel->tire, rolls);
    number_pair(out, "axis", wheel->axis, 3, rolls);
    number_pair(out, "spin_inertia", &wheel->spin_inertia, 0, rolls);
    key(out, "mirrored");
    add(out, !rolls ? "null" : wheel->mirrored ? "true" : "false");
    formula_pair(out, "drive", wheel->drive, model);
    index_pair(out, "drive_body", wheel->drive_body, rolls);
    formula_pair(out, "brake", wheel->brake, model);
    number_pair(out, "windup", &wheel->windup, 0, rolls && wheel->brake);
    index_pair(out, "fast", wheel->fast, rolls);
}

static void wheels(Text *out, const Model *model)
{
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *wheel = model->wheel + i;
        begin(out, i, wheel->name);
        integer_pair(out, "body", wheel->body);
        number_pair(out, "center", wheel->center, 3, true);
        number_pair(out, "radius", &wheel->radius, 0, true);
        number_pair(out, "stiffness", &wheel->stiffness, 0, true);
        number_pair(out, "damping", &wheel->damping, 0, true);
        number_pair(out, "fade", &wheel->fade, 0, true);
        wheel_rolls(out, model, wheel);
        add(out, "}");
    }
}

static void formulas(Text *out, const char *name, const Law *const *law, int count, const Model *model)
{
    key(out, name);
    add(out, "[");
    for (int i = 0; i < count; ++i) {
        add(out, i ? ", " : "");
        formula(out, law[i], model);
    }
    add(out, "]");
}

static void indices(Text *out, const char *name, const int *index, int count)
{
    key(out, name);
    add(out, "[");
    for (int i = 0; i < count; ++i)
        text_print(out, "%s%d", i ? ", " : "", index[i]);
    add(out, "]");
}

static void powertrain(Text *out, const Model *model)
{
    const Powertrain *p = model->powertrain;
    text_print(out, ",\n  \"powertrain\": {\"inertia\": %.17g", p->inertia);
    number_pair(out, "idle", &p->idle, 0, p->idle > 0);
    number_pair(out, "limit", &p->limit, 0, p->limit > 0);
    formula_pair(out, "throttle", p->throttle, model);
    formula_pair(out, "torque", p->torque, model);
    integer_pair(out, "capacity", p->capacity);
    integer_pair(out, "multiplication", p->multiplication);
    integer_pair(out, "reverse", p->reverse);
    key(out, "gears");
    vector(out, p->gear, p->reverse + 1 + p->forward);
    formula_pair(out, "selector", p->selector, model);
    formulas(out, "up", p->up, p->forward - 1, model);
    formulas(out, "down", p->down, p->forward - 1, model);
    number_pair(out, "latency", &p->latency, 0, true);
    number_pair(out, "duration", &p->duration, 0, true);
    number_pair(out, "turbine", &p->turbine, 0, true);
    integer_pair(out, "fast", p->fast);
    integer_pair(out, "start_gear", p->start_gear);
    add(out, ", \"differentials\": [");
    for (int i = 0; i < p->differentials; ++i) {
        const Differential *differential = &p->differential[i];
        begin(out, i, differential->name);
        indices(out, "wheels", differential->wheel, differential->outputs);
        indices(out, "differentials", differential->differential, differential->outputs);
        number_pair(out, "ratio", &differential->ratio, 0, true);
        number_pair(out, "split", &differential->split, 0, true);
        number_pair(out, "inertia", &differential->inertia, 0, true);
        formula_pair(out, "lock", differential->lock, model);
        add(out, "}");
    }
    add(out, "]}");
}

static void inputs(Text *out, const Model *model)
{
    for (int i = 0; i < model->inputs; ++i) {
        begin(out, i, model->input[i].name);
        text_pair(out, "unit", model->input[i].unit);
        number_pair(out, "default", &model->input[i].initial, 0, true);
        add(out, "}");
    }
}

static void strings(Text *out, const char *name, const char *const *s, int count)
{
    key(out, name);
    add(out, "[");
    for (int i = 0; i < count; ++i) {
        add(out, i ? ", " : "");
        string(out, s[i]);
    }
    add(out, "]");
}

static void outputs(Text *out, const Model *model)
{
    for (int i = 0; i < model->outputs; ++i) {
        const Output *output = model->output + i;
        begin(out, i, output->name);
        text_pair(out, "type", output_type_name[output->type]);
        strings(out, "components", output->component, output->count);
        strings(out, "unit", output->unit, output->count);
        add(out, "}");
    }
}

static void subsets(Text *out, const Sequence *sequence)
{
    for (int i = 0; i < sequence->subsets; ++i) {
        const Subset *subset = sequence->subset + i;
        text_print(out, "%s\n    {\"stage\": %d", i ? "," : "", subset->stage);
        if (subset->class < 0)
            number_pair(out, "class", NULL, 0, false);
        else
            text_pair(out, "class", sequence->class[subset->class].name);
        indices(out, "bodies", subset->body, subset->bodies);
        indices(out, "joints", subset->joint, subset->joints);
        indices(out, "coordinates", subset->coordinate, subset->coordinates);
        add(out, "}");
    }
}

void model_dump(Text *out, const Model *model, const Sequence *sequence)
{
    static const struct {
        const char *name;
        void (*entries)(Text *out, const Model *model);
    } list[] = {
        {"bodies", bodies}, {"joints", joints}, {"coordinates", coordinates}, {"forces", forces},
        {"tires", tires},   {"wheels", wheels}, {"inputs", inputs},           {"parameters", parameters},
        {"tables", tables}, {"ports", ports},   {"outputs", outputs},
    };
    add(out, "{\"gicgen_dump\": 1");
    text_pair(out, "model", model->name);
    number_pair(out, "gravity", model->gravity, 3, true);
    text_pair(out, "base", model->free_base ? "free" : "fixed");
    for (size_t i = 0; i < sizeof list / sizeof *list; ++i) {
        text_print(out, ",\n  \"%s\": [", list[i].name);
        list[i].entries(out, model);
        add(out, "]");
    }
    if (model->states) {
        add(out, ",\n  \"states\": [");
        states(out, model);
        add(out, "]");
    }
    if (model->powertrain)
        powertrain(out, model);
    if (model->controllers) {
        add(out, ",\n  \"controllers\": [");
        controllers(out, model);
        add(out, "]");
    }
    add(out, ",\n  \"sequence\": [");
    if (sequence)
        subsets(out, sequence);
    add(out, "]}\n");
}
