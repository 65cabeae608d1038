/* SPDX-License-Identifier: MIT
 * Inputs and force elements (FORMAT.md sections 6 and 7). */
#include "base/table.h"
#include "base/vec3.h"
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/limits.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

enum { INPUT_UNIT, INPUT_DEFAULT, INPUT_KEYS };

static const Key input_key[INPUT_KEYS] = {
    [INPUT_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
    [INPUT_DEFAULT] = {"default", KEY_NUMBER, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const input_about[INPUT_KEYS] = {
    [INPUT_UNIT] = "for people; default 1",
    [INPUT_DEFAULT] = "value until it is set; default 0",
};

const Section input_section = {input_key, INPUT_KEYS, NULL, 0, NULL, NULL, input_about};

enum {
    ELEMENT_TYPE,
    ELEMENT_COORDINATE,
    ELEMENT_BODIES,
    ELEMENT_POINTS,
    ELEMENT_AXIS,
    ELEMENT_STIFFNESS,
    ELEMENT_DAMPING,
    ELEMENT_FREE,
    ELEMENT_LOW,
    ELEMENT_HIGH,
    ELEMENT_FADE,
    ELEMENT_TABLE,
    ELEMENT_VALUE,
    ELEMENT_BODY,
    ELEMENT_POINT,
    ELEMENT_IN,
    ELEMENT_FORCE,
    ELEMENT_TORQUE,
    ELEMENT_AREA,
    ELEMENT_LENGTH,
    ELEMENT_DENSITY,
    ELEMENT_WIND,
    ELEMENT_DRAG,
    ELEMENT_MOMENT,
    ELEMENT_ORIENTATION,
    ELEMENT_KEYS
};

#define FORCE_ALONG (FORM(FORCE_COORDINATE) | FORM(FORCE_COORDINATE_LAW) | FORM(FORCE_COORDINATE_STOP))
#define FORCE_BETWEEN (FORM(FORCE_POINTS) | FORM(FORCE_POINTS_LAW) | FORM(FORCE_POINTS_STOP))
#define FORCE_ABOUT (FORM(FORCE_AXIS) | FORM(FORCE_AXIS_LAW) | FORM(FORCE_AXIS_STOP))
#define FORCE_SPRING (FORM(FORCE_COORDINATE) | FORM(FORCE_POINTS) | FORM(FORCE_AXIS))
#define FORCE_LAWS (FORM(FORCE_COORDINATE_LAW) | FORM(FORCE_POINTS_LAW) | FORM(FORCE_AXIS_LAW))
#define FORCE_STOP (FORM(FORCE_COORDINATE_STOP) | FORM(FORCE_POINTS_STOP) | FORM(FORCE_AXIS_STOP))
#define FORCE_PAIR (FORCE_BETWEEN | FORCE_ABOUT | FORM(FORCE_BUSHING))
#define FORCE_ACTED (FORM(FORCE_LOAD) | FORM(FORCE_AERO))
#define FORCE_WRENCH (FORCE_ACTED | FORM(FORCE_BUSHING))
#define FORCE_ELASTIC (FORCE_SPRING | FORCE_STOP | FORM(FORCE_BUSHING))

static const Key force_key[ELEMENT_KEYS] = {
    [ELEMENT_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ELEMENT_COORDINATE] = {"coordinate", KEY_COORDINATE, FORCE_ALONG, FORCE_ALONG, BOUND_NONE, 0},
    [ELEMENT_BODIES] = {"bodies", KEY_FORCE_BODIES, FORCE_PAIR, FORCE_PAIR, BOUND_NONE, 0},
    [ELEMENT_POINTS] = {"points", KEY_POINTS, FORCE_BETWEEN, FORCE_BETWEEN, BOUND_NONE, 0},
    [ELEMENT_AXIS] = {"axis", KEY_TURN, FORCE_ABOUT, FORCE_ABOUT, BOUND_NONE, 0},
    [ELEMENT_STIFFNESS] = {"stiffness", KEY_STIFFNESS, FORCE_ELASTIC, 0, BOUND_NOT_NEGATIVE, 0},
    [ELEMENT_DAMPING] = {"damping", KEY_STIFFNESS, FORCE_ELASTIC, 0, BOUND_NOT_NEGATIVE, 0},
    [ELEMENT_FREE] = {"free", KEY_FORMULA, FORCE_SPRING, 0, BOUND_NONE, 0},
    [ELEMENT_LOW] = {"low", KEY_FORMULA, FORCE_STOP, 0, BOUND_NONE, 0},
    [ELEMENT_HIGH] = {"high", KEY_FORMULA, FORCE_STOP, 0, BOUND_NONE, 0},
    [ELEMENT_FADE] = {"fade", KEY_FORMULA, FORCE_STOP, 0, BOUND_POSITIVE, 0.01},
    [ELEMENT_TABLE] = {"table", KEY_TABLE, FORCE_SPRING | FORCE_STOP, 0, BOUND_NONE, 0},
    [ELEMENT_VALUE] = {"value", KEY_FORMULA, FORCE_LAWS, FORCE_LAWS, BOUND_NONE, 0},
    [ELEMENT_BODY] = {"body", KEY_BODY, FORCE_ACTED, FORCE_ACTED, BOUND_NONE, 0},
    [ELEMENT_POINT] = {"point", KEY_POINT, FORCE_WRENCH, FORM(FORCE_BUSHING), BOUND_NONE, 0},
    [ELEMENT_IN] = {"in", KEY_FRAME, FORM(FORCE_LOAD), 0, BOUND_NONE, 0},
    [ELEMENT_FORCE] = {"force", KEY_FORCE_VECTOR, FORCE_WRENCH, 0, BOUND_NONE, 0},
    [ELEMENT_TORQUE] = {"torque", KEY_TORQUE_VECTOR, FORM(FORCE_LOAD) | FORM(FORCE_BUSHING), 0, BOUND_NONE, 0},
    [ELEMENT_AREA] = {"area", KEY_FORMULA, FORM(FORCE_AERO), FORM(FORCE_AERO), BOUND_POSITIVE, 0},
    [ELEMENT_LENGTH] = {"length", KEY_FORMULA, FORM(FORCE_AERO), 0, BOUND_POSITIVE, 0},
    [ELEMENT_DENSITY] = {"density", KEY_FORMULA, FORM(FORCE_AERO), 0, BOUND_NONE, 1.225},
    [ELEMENT_WIND] = {"wind", KEY_WORLD_VECTOR, FORM(FORCE_AERO), 0, BOUND_NONE, 0},
    [ELEMENT_DRAG] = {"drag", KEY_FORMULA, FORM(FORCE_AERO), 0, BOUND_NONE, 0},
    [ELEMENT_MOMENT] = {"moment", KEY_TORQUE_VECTOR, FORM(FORCE_AERO), 0, BOUND_NONE, 0},
    [ELEMENT_ORIENTATION] = {"orientation", KEY_ORIENTATION, FORM(FORCE_BUSHING), 0, BOUND_NONE, 0},
};

enum { TYPE_SPRING, TYPE_FORCE, TYPE_STOP, TYPE_LOAD, TYPE_AERO, TYPE_BUSHING, TYPES };

static const char *const force_type_name[TYPES] = {
    [TYPE_SPRING] = "spring_damper",
    [TYPE_FORCE] = "force",
    [TYPE_STOP] = "stop",
    [TYPE_LOAD] = "load",
    [TYPE_AERO] = "aero",
    [TYPE_BUSHING] = "bushing",
};

static const char *const force_form_name[FORCE_TYPES] = {
    [FORCE_COORDINATE] = "along a coordinate",
    [FORCE_POINTS] = "between two points",
    [FORCE_AXIS] = "about an axis",
    [FORCE_COORDINATE_LAW] = "along a coordinate",
    [FORCE_POINTS_LAW] = "between two points",
    [FORCE_AXIS_LAW] = "about an axis",
    [FORCE_COORDINATE_STOP] = "along a coordinate",
    [FORCE_POINTS_STOP] = "between two points",
    [FORCE_AXIS_STOP] = "about an axis",
    [FORCE_LOAD] = "load",
    [FORCE_AERO] = "aero",
    [FORCE_BUSHING] = "bushing",
};

static const char *const between_local[] = {"length", "speed"};
static const char *const about_local[] = {"angle", "speed"};
static const char *const aero_local[AERO_LOCALS] = {
    [AERO_INCIDENCE] = "incidence", [AERO_SIDESLIP] = "sideslip", [AERO_SPEED] = "airspeed"};
static const char *const bushing_local[FORCE_LOCALS] = {
    "dx", "dy", "dz", "rx", "ry", "rz", "dx_rate", "dy_rate", "dz_rate", "rx_rate", "ry_rate", "rz_rate"};
/* Bits of those that change their sign in the mirror: dy, rx, rz and their rates. */
static const unsigned bushing_odd = 0x2A | 0x2A << BUSHING_AXES;

static const unsigned force_type_forms[TYPES] = {
    [TYPE_SPRING] = FORCE_SPRING,   [TYPE_FORCE] = FORCE_LAWS,      [TYPE_STOP] = FORCE_STOP,
    [TYPE_LOAD] = FORM(FORCE_LOAD), [TYPE_AERO] = FORM(FORCE_AERO), [TYPE_BUSHING] = FORM(FORCE_BUSHING),
};

static const char *const force_about[ELEMENT_KEYS] = {
    [ELEMENT_TYPE] =
        "spring and damper, any force law, stop, force and torque on a body, air forces on a body, or six axes",
    [ELEMENT_COORDINATE] = "the dual coordinate that it acts along",
    [ELEMENT_BODIES] = "the bodies a and b that it acts between; `ground` is allowed",
    [ELEMENT_POINTS] = "the point of a and the point of b at design, m, model frame",
    [ELEMENT_AXIS] = "direction fixed in a, about which it turns b",
    [ELEMENT_STIFFNESS] =
        "N/m, or N m/rad about an axis; of numbers and parameters; default 0; of `bushing` a list or triangle",
    [ELEMENT_DAMPING] =
        "N s/m, or N m s/rad about an axis; of numbers and parameters; default 0; of `bushing` a list or triangle",
    [ELEMENT_LOW] = "value, length or angle below which there is contact, m or rad",
    [ELEMENT_HIGH] = "value, length or angle above which there is contact, m or rad",
    [ELEMENT_FADE] = "depth of contact over which damping builds up, m or rad; default 0.01",
    [ELEMENT_TABLE] = "table of force (N) over depth or excess length (m), or torque (N m) over angle (rad)",
    [ELEMENT_FREE] = "value or length without spring force, m or rad; default: the one at design",
    [ELEMENT_VALUE] =
        "force, N, or torque, N m: along the coordinate, or tension between the points, torque about the axis",
    [ELEMENT_BODY] = "the body that load or air acts on",
    [ELEMENT_POINT] =
        "where the force acts, at design, m, model frame; default, not of `bushing`: origin of the body frame",
    [ELEMENT_IN] = "the body in whose frame components are given; default `world`",
    [ELEMENT_FORCE] = "N, a formula for each component; of `aero`: coefficients, along the axes of the body; of "
                      "`bushing`: on b, in its "
                      "axes",
    [ELEMENT_TORQUE] = "N m, a formula for each component; of `bushing`: on b, in its axes",
    [ELEMENT_AREA] = "area that coefficients refer to, m^2; of numbers and parameters",
    [ELEMENT_LENGTH] = "length that coefficients of moments refer to, m; of numbers and parameters",
    [ELEMENT_DENSITY] = "of the air, kg/m^3, a formula; default 1.225",
    [ELEMENT_WIND] = "velocity of the air in the world, m/s, a formula for each component; default still",
    [ELEMENT_DRAG] = "coefficient of the force against the motion through the air, a formula",
    [ELEMENT_MOMENT] = "coefficients of the moment about the axes of the body, a formula for each component",
    [ELEMENT_ORIENTATION] = "of the axes of a bushing at design; default: the model frame's",
};

const Section force_section = {force_key,       ELEMENT_KEYS,     force_type_name, TYPES,
                               force_form_name, force_type_forms, force_about};

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
            .at = coordinate->at,
            .initial = i == 0 ? coordinate->initial : 0,
            .read = true,
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
        if (model->coordinate[i].driven)
            driven_inputs(reader, model->coordinate + i);
    for (int i = 0; i < count; ++i) {
        Value value[INPUT_KEYS];
        section_read(reader, &input_section, 0, entry + i, value);
        model->input[model->inputs++] = (Input){
            .name = entry[i].name,
            .unit = value[INPUT_UNIT].item ? value[INPUT_UNIT].text : "1",
            .at = entry[i].at,
            .initial = value[INPUT_DEFAULT].number[0],
        };
    }
    for (int i = 0; i < model->inputs; ++i) {
        name[i] = model->input[i].name;
        at[i] = model->input[i].at;
    }
    generated_names_check(reader, "input", name, at, model->inputs);
}

/* tuned: the formula of the value, 0: it follows no tunable parameter */
static const Law *literal_law(Reader *reader, double value, Ex tuned)
{
    Law *law = pool_alloc(reader->pool, sizeof *law);
    *law = (Law){.op = LAW_NUMBER, .number = value};
    tuning_set(reader->model->tuning, &law->number, &tuned, 1);
    return law;
}

/* A number of a spring or a stop: a formula of numbers and parameters only, so that the force stays the law of the
 * element. */
static const Law *constant_law(Reader *reader, const Item *item, const char *what, const Key *key)
{
    LawNames names = {
        .model = reader->model, .constant = true, .remedy = "use the element type `force` for any other law"};
    bool formula = item->quoted || mentions_parameter(reader, item);
    const Law *law =
        formula ? law_parse(reader->pool, item, what, &names) : literal_law(reader, doc_number(item, what), 0);
    double number = law_number(law, reader->model);
    if (!isfinite(number))
        diag_fail(item->at, "look for a division by zero or a root of a negative number", "%s is not a finite number",
                  what);
    bound_check(key, item, what, number);
    if (key->bound != BOUND_NONE)
        limit_add(reader->pool, reader->model,
                  &(Limit){law, NULL, key->bound == BOUND_NOT_NEGATIVE, bound_text(reader->pool, key, what), NULL});
    return law;
}

/* The same of a key, which may be absent. */
static const Law *spring_law(Reader *reader, const Entry *entry, const Value *value, int key, double fallback,
                             Ex tuned_fallback)
{
    if (!value[key].item)
        return literal_law(reader, fallback, tuned_fallback);
    const char *what = pool_print(reader->pool, "%s of %s", force_key[key].name, entry->what);
    return constant_law(reader, value[key].item, what, &force_key[key]);
}

/* Stiffness or table, and damping. */
static void read_elastic(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    const Value *table = value + ELEMENT_TABLE;
    if (table->item && value[ELEMENT_STIFFNESS].item)
        diag_fail(table->item->at, "take one of the two away", "%s has both a stiffness and a table", entry->what);
    force->table = table->item ? table->index[0] : -1;
    force->stiffness = spring_law(reader, entry, value, ELEMENT_STIFFNESS, 0, 0);
    force->damping = spring_law(reader, entry, value, ELEMENT_DAMPING, 0, 0);
}

static void read_stop(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    const Model *model = reader->model;
    const Item *low = value[ELEMENT_LOW].item, *high = value[ELEMENT_HIGH].item, *table = value[ELEMENT_TABLE].item;
    if (!low && !high)
        diag_fail(entry->at, "add `low: number`, `high: number` or both: where contact begins",
                  "%s stops nothing: it has neither a low nor a high end", entry->what);
    if (!table && !value[ELEMENT_STIFFNESS].item)
        diag_fail(entry->at, "add `stiffness: number`, or `table: name` for force over depth",
                  "%s has neither a stiffness nor a table", entry->what);
    force->low = low ? spring_law(reader, entry, value, ELEMENT_LOW, 0, 0) : NULL;
    force->high = high ? spring_law(reader, entry, value, ELEMENT_HIGH, 0, 0) : NULL;
    force->fade = spring_law(reader, entry, value, ELEMENT_FADE, force_key[ELEMENT_FADE].fallback, 0);
    if (low && high && !(law_number(force->low, model) < law_number(force->high, model)))
        diag_fail(high->at, "write the lower end as `low`", "high of %s is not above low: it would push both ways",
                  entry->what);
    if (low && high)
        limit_add(reader->pool, reader->model,
                  &(Limit){force->high, force->low, false,
                           pool_print(reader->pool, "high of %s must be above low", entry->what), NULL});
    if (table && table_value(&model->table[force->table], 0) != 0)
        diag_fail(table->at, "begin the table with 0 at 0",
                  "table of %s: '%s' is %.9g at 0, a jump where contact begins", entry->what, table->text,
                  table_value(&model->table[force->table], 0));
}

/* Body and point of an element that acts on one body. */
static void read_acted(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    force->body[0] = value[ELEMENT_BODY].index[0];
    if (!reader->model->free_base && force->body[0] == BODY_BASE)
        diag_fail(value[ELEMENT_BODY].item->at, "name a body that can move", "%s: a force on ground moves nothing",
                  entry->what);
    if (value[ELEMENT_POINT].item)
        body_point(reader, force->body[0], value[ELEMENT_POINT].number, value[ELEMENT_POINT].tuned,
                   value[ELEMENT_POINT].item->at, force->point[0]);
}

/* Formulas of the three components of a vector; NULL where the key is absent. */
static void read_components(Reader *reader, const Entry *entry, const Value *value, int key, const LawNames *names,
                            const Law *law[3])
{
    const Item *item = value[key].item;
    const char *what = pool_print(reader->pool, "%s of %s", force_key[key].name, entry->what);
    if (!item)
        return;
    if (item->kind != ITEM_LIST || item->count != 3)
        diag_fail(item->at, "write [x, y, z]; each may be a formula", "%s must be a list of 3 numbers or formulas",
                  what);
    for (int i = 0; i < 3; ++i)
        law[i] = law_parse(reader->pool, item->value[i], what, names);
}

static void read_load(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    LawNames names = {.model = reader->model, .reads = &reader->reads};
    if (!value[ELEMENT_FORCE].item && !value[ELEMENT_TORQUE].item)
        diag_fail(entry->at, "add `force: [x, y, z]` or `torque: [x, y, z]`; each may be a formula",
                  "%s has neither force nor torque", entry->what);
    read_acted(reader, entry, value, force);
    force->body[1] = value[ELEMENT_IN].item ? value[ELEMENT_IN].index[0] : BODY_GROUND;
    read_components(reader, entry, value, ELEMENT_FORCE, &names, force->law);
    read_components(reader, entry, value, ELEMENT_TORQUE, &names, force->law + 3);
}

static void read_aero(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    const Item *moment = value[ELEMENT_MOMENT].item, *drag = value[ELEMENT_DRAG].item;
    const Item *density = value[ELEMENT_DENSITY].item, *length = value[ELEMENT_LENGTH].item;
    const LawNames names = {.model = reader->model, .reads = &reader->reads};
    const LawNames own = {.model = reader->model,
                          .local = aero_local,
                          .locals = AERO_LOCALS,
                          .odd = 1u << AERO_SIDESLIP,
                          .reads = &reader->reads};
    if (!drag && !moment && !value[ELEMENT_FORCE].item)
        diag_fail(entry->at, "add `drag: number`, `force: [x, y, z]` or `moment: [x, y, z]`; each may be a formula",
                  "%s has no coefficient", entry->what);
    if (!moment != !length)
        diag_fail(moment ? moment->at : length->at,
                  moment ? "add `length: number`, m, often the wheelbase" : "take it away, or add `moment: [x, y, z]`",
                  moment ? "%s has coefficients of a moment and no length that they refer to"
                         : "%s has a length and no coefficients of a moment, which refer to it",
                  entry->what);
    read_acted(reader, entry, value, force);
    force->body[1] = force->body[0];
    force->area = spring_law(reader, entry, value, ELEMENT_AREA, 0, 0);
    force->length = length ? spring_law(reader, entry, value, ELEMENT_LENGTH, 0, 0) : NULL;
    read_components(reader, entry, value, ELEMENT_FORCE, &own, force->law);
    read_components(reader, entry, value, ELEMENT_MOMENT, &own, force->law + 3);
    read_components(reader, entry, value, ELEMENT_WIND, &names, force->law + AERO_WIND);
    if (drag)
        force->law[AERO_DRAG] =
            law_parse(reader->pool, drag, pool_print(reader->pool, "drag of %s", entry->what), &own);
    force->law[AERO_DENSITY] =
        density ? law_parse(reader->pool, density, pool_print(reader->pool, "density of %s", entry->what), &names)
                : literal_law(reader, force_key[ELEMENT_DENSITY].fallback, 0);
}

/* Refuse a matrix by which the bushing would give energy, here and for values that a scene gives. */
static void semidefinite_check(Reader *reader, const Item *item, const char *what,
                               const Law *const law[BUSHING_NUMBERS])
{
    double a[BUSHING_NUMBERS];
    for (int i = 0; i < BUSHING_NUMBERS; ++i)
        a[i] = law[i] ? law_number(law[i], reader->model) : 0;
    if (!limit_semidefinite(a))
        diag_fail(item->at, "check the signs and the order of the axes: x, y, z, then about x, y, z",
                  "%s: the matrix is not positive semidefinite: some motions would be pushed on", what);
    const Limit limit = {.matrix = law, .text = pool_print(reader->pool, "%s must be positive semidefinite", what)};
    limit_add(reader->pool, reader->model, &limit);
}

/* Six numbers, one an axis, or the lower triangle of a symmetric matrix. */
static void read_matrix(Reader *reader, const Entry *entry, const Value *value, int key,
                        const Law *law[BUSHING_NUMBERS])
{
    const Item *item = value[key].item;
    if (!item)
        return;
    const char *what = pool_print(reader->pool, "%s of %s", force_key[key].name, entry->what);
    bool fits = item->kind == ITEM_LIST && item->count == BUSHING_AXES;
    const bool triangle = fits && item->value[0]->kind == ITEM_LIST;
    for (int i = 0; i < BUSHING_AXES && fits; ++i)
        fits = triangle ? item->value[i]->kind == ITEM_LIST && item->value[i]->count == i + 1
                        : item->value[i]->kind == ITEM_SCALAR;
    if (!fits)
        diag_fail(item->at, "write [x, y, z, about x, about y, about z], or the lower triangle, rows of 1 to 6 numbers",
                  "%s must be a list of 6 numbers, or of 6 rows of 1 to 6 numbers", what);
    const Key free = {.name = force_key[key].name, .bound = BOUND_NONE};
    for (int i = 0; i < BUSHING_AXES; ++i)
        for (int j = triangle ? 0 : i; j <= i; ++j)
            law[bushing_place(i, j)] = constant_law(reader, triangle ? item->value[i]->value[j] : item->value[i], what,
                                                    i == j ? &force_key[key] : &free);
    semidefinite_check(reader, item, what, law);
}

static void read_bushing(Reader *reader, const Entry *entry, const Value *value, Force *force)
{
    Bushing *bushing = pool_alloc(reader->pool, sizeof *bushing);
    double euler[4] = {1, 0, 0, 0}, frame[9];
    const LawNames names = {.model = reader->model,
                            .local = bushing_local,
                            .locals = FORCE_LOCALS,
                            .odd = bushing_odd,
                            .reads = &reader->reads};
    if (!value[ELEMENT_STIFFNESS].item && !value[ELEMENT_DAMPING].item && !value[ELEMENT_FORCE].item &&
        !value[ELEMENT_TORQUE].item)
        diag_fail(entry->at, "add `stiffness: [x, y, z, about x, about y, about z]`, or a force law by `force`",
                  "%s does nothing: it has no stiffness, damping, force or torque", entry->what);
    *bushing = (Bushing){.stiffness = {0}};
    memcpy(force->body, value[ELEMENT_BODIES].index, sizeof force->body);
    for (int i = 0; i < 2; ++i)
        body_point(reader, force->body[i], value[ELEMENT_POINT].number, value[ELEMENT_POINT].tuned,
                   value[ELEMENT_POINT].item->at, force->point[i]);
    if (value[ELEMENT_ORIENTATION].item)
        orientation_read(reader, value[ELEMENT_ORIENTATION].item, entry, euler);
    mat_from_euler(euler, frame);
    for (int i = 0; i < 2; ++i) {
        double body[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        if (force->body[i] != BODY_GROUND)
            mat_from_euler(reader->model->body[force->body[i]].euler, body);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                bushing->frame[i][3 * row + column] =
                    body[row] * frame[column] + body[3 + row] * frame[3 + column] + body[6 + row] * frame[6 + column];
    }
    read_matrix(reader, entry, value, ELEMENT_STIFFNESS, bushing->stiffness);
    read_matrix(reader, entry, value, ELEMENT_DAMPING, bushing->damping);
    read_components(reader, entry, value, ELEMENT_FORCE, &names, force->law);
    read_components(reader, entry, value, ELEMENT_TORQUE, &names, force->law + 3);
    force->bushing = bushing;
}

static void force_read(Reader *reader, const Entry *entry, Force *force)
{
    Value value[ELEMENT_KEYS];
    int type = section_type(reader, &force_section, entry);
    bool along = doc_find(entry->item, "coordinate"), about = doc_find(entry->item, "axis");
    bool between = doc_find(entry->item, "bodies") || doc_find(entry->item, "points");
    const bool wrench = type == TYPE_LOAD || type == TYPE_AERO || type == TYPE_BUSHING;
    if (!along && !about && !between && !wrench)
        diag_fail(entry->at,
                  "add `coordinate: name`, or `bodies: [a, b]` and `points: [p_a, p_b]` or `axis: [x, y, z]`",
                  "%s acts nowhere: neither a coordinate nor two bodies are given", entry->what);
    unsigned place = along ? FORCE_ALONG : about ? FORCE_ABOUT : FORCE_BETWEEN;
    ForceType form = 0;
    while (!(FORM(form) & force_type_forms[type] & (wrench ? ALL_FORMS : place)))
        ++form;
    section_read(reader, &force_section, (int)form, entry, value);
    *force = (Force){.name = entry->name,
                     .at = entry->at,
                     .type = form,
                     .coordinate = -1,
                     .body = {BODY_GROUND, BODY_GROUND},
                     .table = -1};
    double fallback = 0;
    Ex tuned_fallback = 0;
    if (form == FORCE_LOAD) {
        read_load(reader, entry, value, force);
    } else if (form == FORCE_AERO) {
        read_aero(reader, entry, value, force);
    } else if (form == FORCE_BUSHING) {
        read_bushing(reader, entry, value, force);
    } else if (along) {
        force->coordinate = value[ELEMENT_COORDINATE].index[0];
        fallback = reader->model->coordinate[force->coordinate].design;
        tuned_fallback = tuned_number(reader->model, &reader->model->coordinate[force->coordinate].design);
    } else if (about) {
        const double *axis = value[ELEMENT_AXIS].number;
        const Ex *tuned = value[ELEMENT_AXIS].tuned;
        memcpy(force->body, value[ELEMENT_BODIES].index, sizeof force->body);
        body_direction(reader, force->body[0], axis, tuned, force->axis);
        perpendicular_set(reader, axis, tuned, force->body, force->reference);
    } else {
        const Value *points = value + ELEMENT_POINTS;
        double d[3];
        fallback = points_distance(reader, points, entry->what, d, &tuned_fallback);
        for (int i = 0; i < 2; ++i) {
            force->body[i] = value[ELEMENT_BODIES].index[i];
            body_point(reader, force->body[i], points->number + 3 * i, points->tuned + 3 * i,
                       points->item->value[i]->at, force->point[i]);
        }
    }
    if (force_is_spring(force) || force_is_stop(force))
        read_elastic(reader, entry, value, force);
    if (force_is_stop(force))
        read_stop(reader, entry, value, force);
    else if (force_is_spring(force))
        force->free = spring_law(reader, entry, value, ELEMENT_FREE, fallback, tuned_fallback);
    if (force_is_law(force)) {
        LawNames names = {.model = reader->model,
                          .local = form == FORCE_POINTS_LAW ? between_local : about_local,
                          .locals = form == FORCE_COORDINATE_LAW ? 0 : 2,
                          .reads = &reader->reads};
        force->law[0] = law_parse(reader->pool, value[ELEMENT_VALUE].item,
                                  pool_print(reader->pool, "value of %s", entry->what), &names);
    }
}

void forces_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "force", &model->forces);
    model->force = pool_alloc(reader->pool, sizeof *model->force * (size_t)(model->forces + 1));
    for (int i = 0; i < model->forces; ++i)
        force_read(reader, entry + i, model->force + i);
}
