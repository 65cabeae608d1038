/* SPDX-License-Identifier: MIT
 * Joints and dual coordinates (FORMAT.md sections 4 and 5): points and axes from the design configuration into the
 * frames of their bodies, lengths and offsets, where coordinates start. */
#include "base/vec3.h"
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

/* Sets of joints: with two points and their distance; with one direction; with one direction in each body; with one
 * point that both bodies share; with such a point that may be left out. */
#define LINKS (FORM(JOINT_DISTANCE) | FORM(JOINT_REVOLUTE_SPHERICAL))
#define ONE_AXIS \
    (FORM(JOINT_REVOLUTE) | FORM(JOINT_PRISMATIC) | FORM(JOINT_CYLINDRICAL) | FORM(JOINT_REVOLUTE_SPHERICAL) | \
     FORM(JOINT_POINT_ON_LINE) | FORM(JOINT_POINT_IN_PLANE) | FORM(JOINT_PARALLEL) | FORM(JOINT_SCREW) | COUPLED)
#define TWO_AXES (FORM(JOINT_UNIVERSAL) | FORM(JOINT_PERPENDICULAR) | FORM(JOINT_RACK_AND_PINION))
#define GEARED (FORM(JOINT_SCREW) | FORM(JOINT_RACK_AND_PINION))
#define ONE_POINT \
    (FORM(JOINT_REVOLUTE) | FORM(JOINT_SPHERICAL) | FORM(JOINT_CYLINDRICAL) | FORM(JOINT_UNIVERSAL) | \
     FORM(JOINT_POINT_ON_LINE) | FORM(JOINT_POINT_IN_PLANE) | GEARED)
#define COUPLED (FORM(JOINT_GEAR) | FORM(JOINT_COUPLER))
#define MAYBE_POINT (FORM(JOINT_PRISMATIC) | FORM(JOINT_FIXED) | COUPLED)

enum {
    LINK_TYPE,
    LINK_BODIES,
    LINK_POINT,
    LINK_POINTS,
    LINK_AXIS,
    LINK_AXES,
    LINK_LENGTH,
    LINK_OFFSET,
    LINK_RATIO,
    LINK_VALUE,
    LINK_KEYS
};

static const Key joint_key[LINK_KEYS] = {
    [LINK_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [LINK_BODIES] = {"bodies", KEY_BODIES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [LINK_POINT] = {"point", KEY_POINT, ONE_POINT | MAYBE_POINT, ONE_POINT, BOUND_NONE, 0},
    [LINK_POINTS] = {"points", KEY_POINTS, LINKS, LINKS, BOUND_NONE, 0},
    [LINK_AXIS] = {"axis", KEY_DUAL_AXIS, ONE_AXIS, ONE_AXIS, BOUND_NONE, 0},
    [LINK_AXES] = {"axes", KEY_AXES, TWO_AXES, TWO_AXES, BOUND_NONE, 0},
    [LINK_LENGTH] = {"length", KEY_MEASURE, LINKS, 0, BOUND_POSITIVE, 0},
    [LINK_OFFSET] = {"offset", KEY_MEASURE, FORM(JOINT_REVOLUTE_SPHERICAL), 0, BOUND_NONE, 0},
    [LINK_RATIO] = {"ratio", KEY_ODD, GEARED, GEARED, BOUND_NONE, 0},
    [LINK_VALUE] = {"value", KEY_FORMULA, COUPLED, COUPLED, BOUND_NONE, 0},
};

/* Given lengths and offsets that differ from the drawing's by less than this share of the length count as equal. */
static const double drawn_tolerance = 1e-12;
/* Largest angle by which a given u_b may miss the plane perpendicular to u_a, degrees. */
static const double axes_tolerance = 10;

static const char *const joint_about[LINK_KEYS] = {
    [LINK_TYPE] = "which equations tie the two bodies",
    [LINK_BODIES] = "the bodies a and b",
    [LINK_POINT] = "the common point at design, m, model frame; default, where optional: origin of the frame of b",
    [LINK_POINTS] = "the point of a and the point of b at design, m, model frame",
    [LINK_AXIS] = "direction at design, model frame",
    [LINK_AXES] =
        "direction of a and direction of b at design, perpendicular; of a rack: about which b turns, and along "
        "which a moves",
    [LINK_LENGTH] = "distance of the points, m; default: in the drawing",
    [LINK_OFFSET] = "part of the distance along the axis, m; default: in the drawing",
    [LINK_RATIO] = "way for a turn by 1 rad, m",
    [LINK_VALUE] = "how far b turns about the axis (gear), rad, or moves along it (coupler), m: a smooth formula of "
                   "coordinates, of which the difference to its value at design counts",
};

const Section joint_section = {joint_key, LINK_KEYS, joint_type_name, JOINT_TYPES, joint_type_name, NULL, joint_about};

enum { DUAL_TYPE, DUAL_BODIES, DUAL_POINTS, DUAL_AXIS, DUAL_DESIGN, DUAL_RANGE, DUAL_INITIAL, DUAL_DRIVEN, DUAL_KEYS };

#define DUAL_AXES (FORM(COORDINATE_TRANSLATION) | FORM(COORDINATE_ANGLE))
#define DUAL_ENDS (FORM(COORDINATE_LENGTH) | FORM(COORDINATE_TRANSLATION))

static const Key coordinate_key[DUAL_KEYS] = {
    [DUAL_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [DUAL_BODIES] = {"bodies", KEY_BODIES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [DUAL_POINTS] = {"points", KEY_POINTS, DUAL_ENDS, FORM(COORDINATE_LENGTH), BOUND_NONE, 0},
    [DUAL_AXIS] = {"axis", KEY_DUAL_AXIS, DUAL_AXES, DUAL_AXES, BOUND_NONE, 0},
    [DUAL_DESIGN] = {"design", KEY_MEASURE, DUAL_AXES, 0, BOUND_NONE, 0},
    [DUAL_RANGE] = {"range", KEY_RANGE, ALL_FORMS, 0, BOUND_NONE, 0},
    [DUAL_INITIAL] = {"initial", KEY_MEASURE, ALL_FORMS, 0, BOUND_NONE, 0},
    [DUAL_DRIVEN] = {"driven", KEY_FLAG, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const coordinate_about[DUAL_KEYS] = {
    [DUAL_TYPE] = "distance of two points, translation along an axis, or angle about one",
    [DUAL_BODIES] = "the bodies a and b",
    [DUAL_POINTS] = "the point of a and the point of b at design, m; default, where optional: origin of the frame of b",
    [DUAL_AXIS] = "direction fixed in a, along which or about which b moves",
    [DUAL_DESIGN] = "value at design, m or rad; default 0",
    [DUAL_RANGE] = ("values that the mechanism is meant to reach, m or rad; default: design length -10% and +10%, "
                    "design value -0.05 m and +0.05 m, -0.5 rad and +0.5 rad"),
    [DUAL_INITIAL] = "value that set-up starts from, m or rad; default: the value at design",
    [DUAL_DRIVEN] = "true: prescribed by inputs for value, rate and acceleration",
};

const Section coordinate_section = {coordinate_key,       DUAL_KEYS, coordinate_type_name, COORDINATE_TYPES,
                                    coordinate_type_name, NULL,      coordinate_about};

double points_distance(const Reader *reader, const Value *points, const char *what, double d[3], Ex *tuned)
{
    for (int i = 0; i < 3; ++i)
        d[i] = points->number[3 + i] - points->number[i];
    double length = norm3(d);
    if (!(length > 0))
        diag_fail(points->item->value[1]->at, "give two different points",
                  "%s: its two points coincide, so the line between them has no direction", what);
    if (!isfinite(length))
        diag_fail(points->item->value[1]->at, "coordinates are in metres", "%s: its two points are too far apart",
                  what);
    *tuned = distance_tune(reader, points, what);
    return length;
}

static void perpendicular(const double axis[3], double e[3])
{
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (fabs(axis[i]) < fabs(axis[least]))
            least = i;
    for (int i = 0; i < 3; ++i)
        e[i] = (i == least) - axis[least] * axis[i];
    vector_normalize(e, 3);
}

void perpendicular_set(const Reader *reader, const double axis[3], const Ex tuned[3], const int body[2],
                       double out[2][3])
{
    double e[3];
    Ex tuned_e[3];
    perpendicular(axis, e);
    perpendicular_tune(reader, axis, tuned, tuned_e);
    for (int i = 0; i < 2; ++i)
        body_direction(reader, body[i], e, tuned_e, out[i]);
}

/* Replace the second of two given axes by its part perpendicular to the first. */
static void axes_square(const Reader *reader, Value *axes, const Entry *entry)
{
    const double degree = acos(-1.0) / 180;
    const double *a = axes->number;
    double *b = axes->number + 3, along = dot3(a, b);
    double miss = asin(fmin(fabs(along), 1)) / degree;
    if (!(miss < axes_tolerance))
        diag_fail(axes->item->value[1]->at, "turn one of them; in a universal joint they are the arms of the cross",
                  "axes of %s: the angle between them is %.4g degrees, which is not near 90", entry->what, 90 - miss);
    square_tune(reader, axes->number, axes->tuned, sin(axes_tolerance * degree),
                pool_print(reader->pool, "axes of %s", entry->what));
    for (int i = 0; i < 3; ++i)
        b[i] -= along * a[i];
    vector_normalize(b, 3);
}

/* Axes, and directions perpendicular to the first. A fixed joint has no axis: any direction serves. */
static void joint_axes_set(const Reader *reader, Value *value, const Entry *entry, Joint *joint)
{
    static const double x[3] = {1, 0, 0};
    const double *axis[2] = {x, x};
    const Ex *tuned[2] = {value[LINK_AXIS].tuned, value[LINK_AXIS].tuned};
    const bool rack = joint->type == JOINT_RACK_AND_PINION;
    if (FORM(joint->type) & TWO_AXES) {
        axes_square(reader, value + LINK_AXES, entry);
        for (int i = 0; i < 2; ++i) {
            axis[i] = value[LINK_AXES].number + (rack ? 0 : 3 * i);
            tuned[i] = value[LINK_AXES].tuned + (rack ? 0 : 3 * i);
        }
    } else if (FORM(joint->type) & ONE_AXIS)
        axis[0] = axis[1] = value[LINK_AXIS].number;
    else if (joint->type != JOINT_FIXED)
        return;
    for (int i = 0; i < 2; ++i)
        body_direction(reader, joint->body[i], axis[i], tuned[i], joint->axis[i]);
    double side[3];
    Ex tuned_side[3];
    if (rack) {
        memcpy(side, value[LINK_AXES].number + 3, sizeof side);
        memcpy(tuned_side, value[LINK_AXES].tuned + 3, sizeof tuned_side);
    } else {
        perpendicular(axis[0], side);
        side_tune(reader, axis[0], tuned[0], side, entry->what, tuned_side);
    }
    for (int i = 0; i < 2; ++i)
        body_direction(reader, joint->body[i], side, tuned_side, joint->side[i]);
}

/* A length or an offset: the given one, else the drawing's. */
static double link_number(const Value *given, double drawn, double length, Joint *joint)
{
    if (!given->item || fabs(given->number[0] - drawn) <= drawn_tolerance * length)
        return drawn;
    joint->drawn = false;
    return given->number[0];
}

/* Points of a link, its length and, for a hinged one, its offset along the axis. */
static void link_set(const Reader *reader, const Value *value, const Entry *entry, Joint *joint)
{
    const Value *points = value + LINK_POINTS;
    const Value *given_length = value + LINK_LENGTH, *given_offset = value + LINK_OFFSET;
    Ex tuned;
    double d[3], drawn = points_distance(reader, points, entry->what, d, &tuned);
    for (int i = 0; i < 2; ++i)
        body_point(reader, joint->body[i], points->number + 3 * i, points->tuned + 3 * i, points->item->value[i]->at,
                   joint->point[i]);
    joint->length = link_number(given_length, drawn, drawn, joint);
    double square = joint->length * joint->length;
    if (!(square > 0 && isfinite(square)))
        diag_fail(given_length->item->at, "lengths are in metres", "length of %s is out of all proportion",
                  entry->what);
    if (joint->type != JOINT_REVOLUTE_SPHERICAL)
        return;
    joint->offset = link_number(given_offset, dot3(value[LINK_AXIS].number, d), drawn, joint);
    if (fabs(joint->offset) < joint->length * (1 - drawn_tolerance))
        return;
    const Item *culprit = given_offset->item ? given_offset->item : given_length->item;
    if (culprit)
        diag_fail(culprit->at, "take a longer `length` or a smaller `offset`",
                  "%s: no link of length %.9g reaches %.9g along its axis and can still turn", entry->what,
                  joint->length, joint->offset);
    diag_fail(points->item->at, "choose points or an axis so that the link stands out from the axis",
              "%s: the link lies along its own axis, so turning about it moves nothing", entry->what);
}

/* The ratio of a screw, or of a rack with the other sign. */
static void ratio_set(const Reader *reader, const Value *ratio, const Entry *entry, Joint *joint)
{
    Dag *dag = reader->model->tuning->dag;
    const bool rack = joint->type == JOINT_RACK_AND_PINION;
    Ex tuned = ratio->tuned[0];
    if (ratio->number[0] == 0)
        diag_fail(ratio->item->at, "write the way for a turn by 1 rad, m, or hold it by another joint",
                  "ratio of %s is 0: nothing would move", entry->what);
    joint->offset = rack ? -ratio->number[0] : ratio->number[0];
    if (tuned)
        tuning_require(reader->model->tuning, ex_mul(dag, tuned, tuned), false,
                       pool_print(reader->pool, "ratio of %s must not be 0", entry->what));
    if (rack && tuned)
        tuned = ex_neg(dag, tuned);
    tuning_set(reader->model->tuning, &joint->offset, &tuned, 1);
}

/* The origin of a body frame as a point. */
static Value origin_value(const Reader *reader, int body)
{
    const double *position = reader->model->body[body].position;
    Value value = {.item = NULL};
    for (int i = 0; i < 3; ++i) {
        value.number[i] = position[i];
        value.tuned[i] = tuned_number(reader->model, position + i);
    }
    return value;
}

static void joint_read(Reader *reader, const Entry *entry, Joint *joint)
{
    Value value[LINK_KEYS];
    JointType type = (JointType)section_type(reader, &joint_section, entry);
    section_read(reader, &joint_section, (int)type, entry, value);
    const int *body = value[LINK_BODIES].index;
    *joint = (Joint){.name = entry->name, .at = entry->at, .type = type, .body = {body[0], body[1]}, .drawn = true};
    joint_axes_set(reader, value, entry, joint);
    if (FORM(type) & LINKS) {
        link_set(reader, value, entry, joint);
        link_tune(reader, value + LINK_POINTS, value + LINK_AXIS, value + LINK_LENGTH, value + LINK_OFFSET,
                  drawn_tolerance, entry->what, joint);
    } else if (FORM(type) & (ONE_POINT | MAYBE_POINT)) {
        const Value *point = value + LINK_POINT;
        const Value origin = origin_value(reader, body[1]), *x = point->item ? point : &origin;
        for (int i = 0; i < 2; ++i)
            body_point(reader, body[i], x->number, x->tuned, point->item ? point->item->at : entry->at,
                       joint->point[i]);
    }
    if (FORM(type) & GEARED)
        ratio_set(reader, value + LINK_RATIO, entry, joint);
}

void joints_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "joint", &model->joints);
    model->joint = pool_alloc(reader->pool, sizeof *model->joint * (size_t)(model->joints + 1));
    for (int i = 0; i < model->joints; ++i)
        joint_read(reader, entry + i, model->joint + i);
}

/* What a formula of a gear or coupler may not have; NULL: nothing. */
static const char *unfit(const Law *law)
{
    static const char *const read[] = {
        [LAW_INPUT] = "an input", [LAW_STATE] = "a state", [LAW_RATE] = "a rate", [LAW_TIME] = "time"};
    const char *found = NULL;
    switch (law->op) {
    case LAW_INPUT:
    case LAW_STATE:
    case LAW_RATE:
    case LAW_TIME: return read[law->op];
    case LAW_TABLE: return "a table, which bends at its points";
    case LAW_CALL:
        if (law->call == OP_ABS || law->call == OP_MIN || law->call == OP_MAX || law->call == OP_POSITIVE)
            return "`abs`, `min`, `max`, `if` or a condition, which bend or jump";
        break;
    default: break;
    }
    for (int i = 0; i < 3 && law->arg[i] && !found; ++i)
        found = unfit(law->arg[i]);
    return found;
}

/* The formula at the design values of the coordinates. */
static Ex at_design(const Model *model, const Law *law)
{
    Ex arg[3] = {0};
    if (law->op == LAW_VALUE)
        return tuned_or_fixed(model, &model->coordinate[law->index].design);
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = at_design(model, law->arg[i]);
    return law_top(model->tuning->dag, model, law, arg);
}

static double number_at_design(const Model *model, const Law *law)
{
    double x[3] = {0};
    if (law->op == LAW_VALUE)
        return model->coordinate[law->index].design;
    if (law->op != LAW_CALL)
        return law_number(law, model);
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        x[i] = number_at_design(model, law->arg[i]);
    return op_value((Op)law->call, x[0], x[1], x[2]);
}

/* The formula with the given coordinates [model->coordinates] and the file's values of parameters. */
static Ex of_coordinates(Dag *dag, const Model *model, const Law *law, const Ex *x)
{
    Ex arg[3] = {0};
    if (law->op == LAW_VALUE)
        return x[law->index];
    if (law->op != LAW_CALL)
        return ex_literal(dag, law_number(law, model));
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = of_coordinates(dag, model, law->arg[i], x);
    return law_top(dag, model, law, arg);
}

static Ex still(const void *context, Dag *dag, Element element)
{
    (void)context;
    (void)element;
    return ex_literal(dag, 0);
}

/* The coordinate by which the formula has no finite first or second derivative at the design; -1: none. */
static int without_derivative(Pool *pool, const Model *model, const Law *law)
{
    Dag *dag = dag_new(pool, 1, 1);
    Ex x[model->coordinates + 1];
    for (int i = 0; i < model->coordinates; ++i)
        x[i] = ex_input(dag, (Element){.array = ARRAY_x, .index = i}, &model->coordinate[i].design);
    const Ex value = of_coordinates(dag, model, law, x);
    for (int i = 0; i < model->coordinates; ++i) {
        const Ex one = ex_literal(dag, 1);
        const Seeds seeds = {.seed = still, .givens = 1, .given = &x[i], .slope = &one, .smooth = true};
        const Ex slope = dag_slopes(dag, NULL, &value, 1, &seeds)[value];
        const Ex bend = dag_slopes(dag, NULL, &slope, 1, &seeds)[slope];
        if (!isfinite(ex_value(dag, slope, 0)) || !isfinite(ex_value(dag, bend, 0)))
            return i;
    }
    return -1;
}

/* Parameters in a formula are numbers of the model, so that tunable ones act at set-up. */
static void tune_parameters(const Model *model, const Law *law)
{
    if (law->op == LAW_PARAMETER) {
        const Ex formula = law_expression(model->tuning->dag, model, law);
        tuning_set(model->tuning, &law->number, &formula, 1);
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        tune_parameters(model, law->arg[i]);
}

static void coupler_read(Reader *reader, const Entry *entry, Joint *joint)
{
    const Model *model = reader->model;
    const Item *item = doc_find(entry->item, joint_key[LINK_VALUE].name);
    const char *what = pool_print(reader->pool, "value of %s", entry->what);
    const LawNames names = {.model = model, .remedy = "write a formula of coordinates, numbers and parameters"};
    const Law *law = law_parse(reader->pool, item, what, &names);
    const char *wrong = unfit(law);
    if (wrong)
        diag_fail(item->at,
                  "write a smooth formula of coordinates, numbers and parameters; what inputs and time move is a "
                  "coordinate with `driven: true`",
                  "%s has %s", what, wrong);
    if (!law_follows(law, -1))
        diag_fail(item->at, "name a coordinate in it, or take another joint",
                  "%s follows no coordinate: nothing would move", what);
    const Ex tuned = at_design(model, law);
    joint->value = law;
    joint->offset = number_at_design(model, law);
    if (!isfinite(joint->offset))
        diag_fail(item->at, "look for a division by zero or a root of a negative number",
                  "%s is not a finite number at the design", what);
    const int coordinate = without_derivative(reader->pool, model, law);
    if (coordinate >= 0)
        diag_fail(item->at,
                  "write a formula that is smooth where the model is drawn, or give the coordinate another `design`",
                  "%s has no finite derivative by '%s' at the design, so that nothing could move there", what,
                  model->coordinate[coordinate].name);
    coupler_bends(model, law, item, what);
    tuning_set(model->tuning, &joint->offset, &tuned, 1);
    tune_parameters(model, law);
}

void couplers_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "joint", &model->joints);
    for (int i = 0; i < model->joints; ++i)
        if (joint_is_coupled(model->joint[i].type))
            coupler_read(reader, entry + i, model->joint + i);
}

/* The given range or the default one around the design value. */
static void range_set(const Value *range, const Entry *entry, Coordinate *coordinate)
{
    static const double half_width[COORDINATE_TYPES] = {
        [COORDINATE_TRANSLATION] = 0.05,
        [COORDINATE_ANGLE] = 0.5,
    };
    double design = coordinate->design;
    bool length = coordinate->type == COORDINATE_LENGTH;
    if (!range->item) {
        coordinate->range[0] = length ? 0.9 * design : design - half_width[coordinate->type];
        coordinate->range[1] = length ? 1.1 * design : design + half_width[coordinate->type];
        return;
    }
    memcpy(coordinate->range, range->number, sizeof coordinate->range);
    if (length && range->number[0] <= 0)
        diag_fail(range->item->at, "write a positive low end", "range of %s: a length is greater than zero",
                  entry->what);
    if (design < range->number[0] || design > range->number[1])
        diag_fail(range->item->at, "widen the range to hold the design value",
                  "range of %s: the design value %.9g lies outside", entry->what, design);
}

/* The given initial value, else the design value. */
static void initial_set(const Value *initial, const Entry *entry, Coordinate *coordinate)
{
    const double *range = coordinate->range;
    coordinate->initial = initial->item ? initial->number[0] : coordinate->design;
    if (coordinate->initial < range[0] || coordinate->initial > range[1])
        diag_fail(initial->item->at, "take a value inside, or write a wider `range: [low, high]`",
                  "initial of %s: %.9g is outside the range %.9g to %.9g", entry->what, coordinate->initial, range[0],
                  range[1]);
}

static void coordinate_read(Reader *reader, const Entry *entry, Coordinate *coordinate)
{
    Value value[DUAL_KEYS];
    CoordinateType type = (CoordinateType)section_type(reader, &coordinate_section, entry);
    section_read(reader, &coordinate_section, (int)type, entry, value);
    const int *body = value[DUAL_BODIES].index;
    const double *axis = value[DUAL_AXIS].number;
    Value *points = value + DUAL_POINTS;
    *coordinate = (Coordinate){.name = entry->name,
                               .at = entry->at,
                               .type = type,
                               .body = {body[0], body[1]},
                               .design = value[DUAL_DESIGN].number[0],
                               .driven = value[DUAL_DRIVEN].flag,
                               .input = -1};
    Tuning *tuning = reader->model->tuning;
    Ex tuned_design = value[DUAL_DESIGN].tuned[0];
    const Ex *tuned_axis = value[DUAL_AXIS].tuned;
    if (FORM(type) & DUAL_AXES)
        body_direction(reader, body[0], axis, tuned_axis, coordinate->axis);
    double d[3] = {0, 0, 0};
    if (type == COORDINATE_LENGTH)
        coordinate->design = points_distance(reader, points, entry->what, d, &tuned_design);
    else if (type == COORDINATE_ANGLE)
        perpendicular_set(reader, axis, tuned_axis, body, coordinate->reference);
    tuning_set(tuning, &coordinate->design, &tuned_design, 1);
    if (FORM(type) & DUAL_ENDS)
        for (int i = 0; i < 2; ++i) {
            const Value origin = origin_value(reader, body[1]);
            const double *x = points->item ? points->number + 3 * i : origin.number;
            const Ex *tuned_x = points->item ? points->tuned + 3 * i : origin.tuned;
            body_point(reader, body[i], x, tuned_x, points->item ? points->item->value[i]->at : entry->at,
                       coordinate->point[i]);
        }
    if (type == COORDINATE_TRANSLATION && points->item) {
        Ex tuned_d[3], u[3];
        for (int i = 0; i < 3; ++i)
            d[i] = points->number[3 + i] - points->number[i];
        coordinate->offset = dot3(axis, d);
        points_formula(reader, points, tuned_d);
        formulas(reader, axis, tuned_axis, 3, u);
        tuning_set(tuning, &coordinate->offset, (Ex[]){ex_dot(tuning->dag, u, tuned_d)}, 1);
    }
    range_set(value + DUAL_RANGE, entry, coordinate);
    initial_set(value + DUAL_INITIAL, entry, coordinate);
    tuning_set(tuning, &coordinate->initial, value[DUAL_INITIAL].item ? value[DUAL_INITIAL].tuned : &tuned_design, 1);
    range_tune(reader, value + DUAL_RANGE, entry->what, coordinate);
}

/* Names of coordinates and their rates must differ from those of a free base's states. */
static void states_check(Reader *reader, const Place *at)
{
    const Model *model = reader->model;
    const int base = model->free_base ? BASE_STATES : 0;
    const size_t count = (size_t)(base + 2 * model->coordinates);
    const char **name = pool_alloc(reader->pool, (count + 1) * sizeof *name);
    Place *place = pool_alloc(reader->pool, (count + 1) * sizeof *place);
    for (int i = 0; i < base; ++i)
        name[i] = base_state_name[i];
    for (int i = 0; i < model->coordinates; ++i) {
        name[base + i] = model->coordinate[i].name;
        name[base + model->coordinates + i] = pool_print(reader->pool, "%s.rate", model->coordinate[i].name);
        place[base + i] = place[base + model->coordinates + i] = at[i];
    }
    generated_names_check(reader, "state", name, place, (int)count);
}

void coordinates_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "coordinate", &model->coordinates);
    size_t room = (size_t)(model->coordinates + 1);
    model->coordinate = pool_alloc(reader->pool, sizeof *model->coordinate * room);
    const char **name = pool_alloc(reader->pool, sizeof *name * room);
    Place *at = pool_alloc(reader->pool, sizeof *at * room);
    for (int i = 0; i < model->coordinates; ++i) {
        model->coordinate[i].name = name[i] = entry[i].name; /* formulas of any of them may name any other */
        at[i] = entry[i].at;
    }
    for (int i = 0; i < model->coordinates; ++i)
        coordinate_read(reader, entry + i, model->coordinate + i);
    generated_names_check(reader, "coordinate", name, at, model->coordinates);
    states_check(reader, at);
}
