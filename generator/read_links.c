/* SPDX-License-Identifier: MIT
 * Joints and dual coordinates (FORMAT.md sections 4 and 5): points and axes from the design configuration into the
 * frames of their bodies, distances and offsets at design. */
#include "read.h"

#include <math.h>
#include <string.h>

const char *const joint_type_name[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = "revolute",
    [JOINT_SPHERICAL] = "spherical",
    [JOINT_PRISMATIC] = "prismatic",
    [JOINT_DISTANCE] = "distance",
    [JOINT_REVOLUTE_SPHERICAL] = "revolute_spherical",
};

const int joint_equations[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = 5,
    [JOINT_SPHERICAL] = 3,
    [JOINT_PRISMATIC] = 5,
    [JOINT_DISTANCE] = 1,
    [JOINT_REVOLUTE_SPHERICAL] = 2,
};

const char *const coordinate_type_name[COORDINATE_TYPES] = {
    [COORDINATE_LENGTH] = "length",
    [COORDINATE_TRANSLATION] = "translation",
    [COORDINATE_ANGLE] = "angle",
};

/* Joints with two points, and so a distance between them; joints with an axis. */
#define JOINT_LINKS (FORM(JOINT_DISTANCE) | FORM(JOINT_REVOLUTE_SPHERICAL))
#define JOINT_AXES (FORM(JOINT_REVOLUTE) | FORM(JOINT_PRISMATIC) | FORM(JOINT_REVOLUTE_SPHERICAL))
#define JOINT_POINT (FORM(JOINT_REVOLUTE) | FORM(JOINT_SPHERICAL))

enum { LINK_TYPE, LINK_BODIES, LINK_POINT, LINK_POINTS, LINK_AXIS, LINK_KEYS };

static const Key joint_key[LINK_KEYS] = {
    [LINK_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [LINK_BODIES] = {"bodies", KEY_BODIES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [LINK_POINT] = {"point", KEY_POINT, JOINT_POINT | FORM(JOINT_PRISMATIC), JOINT_POINT, BOUND_NONE, 0},
    [LINK_POINTS] = {"points", KEY_POINTS, JOINT_LINKS, JOINT_LINKS, BOUND_NONE, 0},
    [LINK_AXIS] = {"axis", KEY_AXIS, JOINT_AXES, JOINT_AXES, BOUND_NONE, 0},
};

static const Section joint_section = {joint_key, LINK_KEYS, joint_type_name, JOINT_TYPES, joint_type_name};

enum {
    DUAL_TYPE,
    DUAL_BODIES,
    DUAL_POINTS,
    DUAL_AXIS,
    DUAL_DESIGN,
    DUAL_RANGE,
    DUAL_DRIVEN,
    DUAL_KEYS
};

#define DUAL_AXES (FORM(COORDINATE_TRANSLATION) | FORM(COORDINATE_ANGLE))
#define DUAL_ENDS (FORM(COORDINATE_LENGTH) | FORM(COORDINATE_TRANSLATION))

static const Key coordinate_key[DUAL_KEYS] = {
    [DUAL_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [DUAL_BODIES] = {"bodies", KEY_BODIES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [DUAL_POINTS] = {"points", KEY_POINTS, DUAL_ENDS, FORM(COORDINATE_LENGTH), BOUND_NONE, 0},
    [DUAL_AXIS] = {"axis", KEY_AXIS, DUAL_AXES, DUAL_AXES, BOUND_NONE, 0},
    [DUAL_DESIGN] = {"design", KEY_NUMBER, DUAL_AXES, 0, BOUND_NONE, 0},
    [DUAL_RANGE] = {"range", KEY_RANGE, ALL_FORMS, 0, BOUND_NONE, 0},
    [DUAL_DRIVEN] = {"driven", KEY_FLAG, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const Section coordinate_section = {coordinate_key, DUAL_KEYS, coordinate_type_name, COORDINATE_TYPES,
                                           coordinate_type_name};

double points_distance(const Value *points, const char *what, double d[3])
{
    for (int i = 0; i < 3; ++i)
        d[i] = points->number[3 + i] - points->number[i];
    double length = vec_norm(d);
    if (!(length > 0))
        diag_fail(points->item->value[1]->at, "give two different points",
                  "%s: its two points coincide, so the line between them has no direction", what);
    if (!isfinite(length))
        diag_fail(points->item->value[1]->at, "coordinates are in metres", "%s: its two points are too far apart",
                  what);
    return length;
}

static void joint_read(Reader *reader, const Entry *entry, Joint *joint)
{
    Value value[LINK_KEYS];
    JointType type = (JointType)section_type(reader, &joint_section, entry);
    section_read(reader, &joint_section, (int)type, entry, value);
    const int *body = value[LINK_BODIES].index;
    const double *axis = value[LINK_AXIS].number;
    *joint = (Joint){.name = entry->name, .at = entry->at, .type = type, .body = {body[0], body[1]}};
    if (FORM(type) & JOINT_AXES)
        body_direction(reader, body[0], axis, joint->axis[0]);
    if (type == JOINT_REVOLUTE || type == JOINT_PRISMATIC)
        body_direction(reader, body[1], axis, joint->axis[1]);
    if (FORM(type) & JOINT_LINKS) {
        const Value *points = value + LINK_POINTS;
        double d[3];
        joint->length = points_distance(points, entry->what, d);
        joint->offset = type == JOINT_REVOLUTE_SPHERICAL ? vec_dot(axis, d) : 0;
        for (int i = 0; i < 2; ++i)
            body_point(reader, body[i], points->number + 3 * i, points->item->value[i]->at, joint->point[i]);
        return;
    }
    const Value *point = value + LINK_POINT;
    const double *x = point->item ? point->number : reader->model->body[body[1]].position;
    for (int i = 0; i < 2; ++i)
        body_point(reader, body[i], x, point->item ? point->item->at : entry->at, joint->point[i]);
}

void joints_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "joint", &model->joints);
    model->joint = pool_alloc(reader->pool, sizeof *model->joint * (size_t)(model->joints + 1));
    for (int i = 0; i < model->joints; ++i)
        joint_read(reader, entry + i, model->joint + i);
}

/* e_1 and f_1 of FORMAT.md section 5: perpendicular to the axis, as near as can be to the axis of the model frame
 * that the axis is least parallel to. */
static void reference_set(const Reader *reader, const double axis[3], Coordinate *coordinate)
{
    int least = 0;
    double e[3];
    for (int i = 1; i < 3; ++i)
        if (fabs(axis[i]) < fabs(axis[least]))
            least = i;
    for (int i = 0; i < 3; ++i)
        e[i] = (i == least) - axis[least] * axis[i];
    vector_normalize(e, 3);
    for (int i = 0; i < 2; ++i)
        body_direction(reader, coordinate->body[i], e, coordinate->reference[i]);
}

/* The default range, or the given one, around the design value. */
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

static void coordinate_read(Reader *reader, const Entry *entry, Coordinate *coordinate)
{
    Value value[DUAL_KEYS];
    CoordinateType type = (CoordinateType)section_type(reader, &coordinate_section, entry);
    section_read(reader, &coordinate_section, (int)type, entry, value);
    const int *body = value[DUAL_BODIES].index;
    const double *axis = value[DUAL_AXIS].number;
    Value *points = value + DUAL_POINTS;
    *coordinate = (Coordinate){.name = entry->name, .at = entry->at, .type = type, .body = {body[0], body[1]},
                               .design = value[DUAL_DESIGN].number[0], .driven = value[DUAL_DRIVEN].flag, .input = -1};
    if (FORM(type) & DUAL_AXES)
        body_direction(reader, body[0], axis, coordinate->axis);
    double d[3] = {0, 0, 0};
    if (type == COORDINATE_LENGTH)
        coordinate->design = points_distance(points, entry->what, d);
    else if (type == COORDINATE_ANGLE)
        reference_set(reader, axis, coordinate);
    if (FORM(type) & DUAL_ENDS)
        for (int i = 0; i < 2; ++i) {
            const double *x = points->item ? points->number + 3 * i : reader->model->body[body[1]].position;
            body_point(reader, body[i], x, points->item ? points->item->value[i]->at : entry->at, coordinate->point[i]);
        }
    if (type == COORDINATE_TRANSLATION && points->item) {
        for (int i = 0; i < 3; ++i)
            d[i] = points->number[3 + i] - points->number[i];
        coordinate->offset = vec_dot(axis, d);
    }
    range_set(value + DUAL_RANGE, entry, coordinate);
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
        coordinate_read(reader, entry + i, model->coordinate + i);
        name[i] = entry[i].name;
        at[i] = entry[i].at;
    }
    generated_names_check(reader, "coordinate", name, at, model->coordinates);
}
