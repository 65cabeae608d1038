/* SPDX-License-Identifier: MIT
 * From JSON to the structures of the dumped model. */
#include "dump.h"

#include "json.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const int joint_rows[JOINT_TYPES] = {5, 3, 5, 4, 4, 6, 1, 2, 2, 1, 2, 1, 1, 1, 1, 1};

static const char *const joint_name[JOINT_TYPES] = {
    "revolute", "spherical",          "prismatic",     "cylindrical",    "universal", "fixed",
    "distance", "revolute_spherical", "point_on_line", "point_in_plane", "parallel",  "perpendicular",
    "screw",    "rack_and_pinion",    "gear",          "coupler"};
static const char *const coordinate_name[COORDINATE_TYPES] = {"length", "translation", "angle"};

static int type_of(const Json *json, const char *const *name, int count)
{
    const char *type = json_text(json, "type");
    for (int i = 0; i < count; ++i)
        if (!strcmp(type, name[i]))
            return i;
    fail("type '%s' is unknown", type);
}

static int index_of(const Json *json, const char *key, int low, int count)
{
    double number = json_number(json, key);
    if (!(number >= low && number < count && number == floor(number)))
        fail("'%s' is not an index", key);
    return (int)number;
}

static const Json *list_of(const Json *json, const char *key, int *count)
{
    const Json *list = json_get(json, key);
    if (list->kind != JSON_LIST)
        fail("'%s' is not a list", key);
    *count = list->count;
    return list;
}

static void read_body(Body *body, const Json *json)
{
    body->name = strcpy(grab(strlen(json_text(json, "name")) + 1, 1), json_text(json, "name"));
    body->mass = json_number(json, "mass");
    json_numbers(json, "com", body->com, 3);
    json_numbers(json, "inertia", body->inertia, 6);
    json_numbers(json, "position", body->position, 3);
    json_numbers(json, "euler", body->euler, 4);
}

static void read_joint(Joint *joint, const Json *json, int bodies)
{
    joint->name = strcpy(grab(strlen(json_text(json, "name")) + 1, 1), json_text(json, "name"));
    joint->type = (JointType)type_of(json, joint_name, JOINT_TYPES);
    joint->body[0] = index_of(json, "a", 0, bodies);
    joint->body[1] = index_of(json, "b", 0, bodies);
    json_numbers(json, "point_a", joint->point[0], 3);
    json_numbers(json, "point_b", joint->point[1], 3);
    json_numbers(json, "axis_a", joint->axis[0], 3);
    json_numbers(json, "axis_b", joint->axis[1], 3);
    joint->length = json_number(json, "length");
    joint->offset = json_number(json, "offset");
    if (joint->type >= SCREW && joint->type <= COUPLED) {
        json_numbers(json, "side_a", joint->side[0], 3);
        json_numbers(json, "side_b", joint->side[1], 3);
    }
    if (joint->type == GEARED || joint->type == COUPLED)
        joint->value = formula_read(json_get(json, "value"));
}

static void read_coordinate(Coordinate *coordinate, const Json *json, int bodies)
{
    coordinate->name = strcpy(grab(strlen(json_text(json, "name")) + 1, 1), json_text(json, "name"));
    coordinate->type = (CoordinateType)type_of(json, coordinate_name, COORDINATE_TYPES);
    coordinate->body[0] = index_of(json, "a", 0, bodies);
    coordinate->body[1] = index_of(json, "b", 0, bodies);
    json_numbers(json, "point_a", coordinate->point[0], 3);
    json_numbers(json, "point_b", coordinate->point[1], 3);
    json_numbers(json, "axis_a", coordinate->axis, 3);
    json_numbers(json, "reference_a", coordinate->reference[0], 3);
    json_numbers(json, "reference_b", coordinate->reference[1], 3);
    coordinate->design = json_number(json, "design");
    coordinate->offset = json_number(json, "offset");
    json_numbers(json, "range", coordinate->range, 2);
    coordinate->driven = json_number(json, "driven") != 0;
}

static void read_force(Force *force, const Json *json, const Model *model)
{
    enum { COORDINATE, POINTS, AXIS, LOAD, AERO, BUSHING };
    static const struct {
        const char *name;
        int place, laws;
        bool stop;
    } known[] = {{"coordinate", COORDINATE, 0, false},
                 {"points", POINTS, 0, false},
                 {"axis", AXIS, 0, false},
                 {"coordinate_law", COORDINATE, 1, false},
                 {"points_law", POINTS, 1, false},
                 {"axis_law", AXIS, 1, false},
                 {"coordinate_stop", COORDINATE, 0, true},
                 {"points_stop", POINTS, 0, true},
                 {"axis_stop", AXIS, 0, true},
                 {"load", LOAD, 6, false},
                 {"aero", AERO, 11, false},
                 {"bushing", BUSHING, 6, false}};
    enum { TYPES = sizeof known / sizeof *known };
    const char *name[TYPES];
    for (int i = 0; i < TYPES; ++i)
        name[i] = known[i].name;
    int type = type_of(json, name, TYPES), place = known[type].place, laws;
    force->coordinate = place == COORDINATE ? index_of(json, "coordinate", 0, model->coordinates) : -1;
    force->aero = place == AERO;
    force->load = place == LOAD || force->aero;
    force->about = place == AXIS;
    force->bushing = place == BUSHING;
    force->stop = known[type].stop;
    if (place != COORDINATE) {
        force->body[0] = index_of(json, "a", GROUND, model->bodies);
        force->body[1] = index_of(json, "b", GROUND, model->bodies);
        json_numbers(json, "point_a", force->point[0], 3);
        json_numbers(json, "point_b", force->point[1], 3);
        json_numbers(json, "axis_a", force->axis, 3);
        json_numbers(json, "reference_a", force->reference[0], 3);
        json_numbers(json, "reference_b", force->reference[1], 3);
    }
    force->low = json_get(json, "low")->kind == JSON_NULL ? -HUGE_VAL : json_number(json, "low");
    force->high = json_get(json, "high")->kind == JSON_NULL ? HUGE_VAL : json_number(json, "high");
    force->fade = json_number(json, "fade");
    if (json_get(json, "table")->kind != JSON_NULL)
        force->table = &model->table[index_of(json, "table", 0, model->tables)];
    force->stiffness = json_number(json, "stiffness");
    force->damping = json_number(json, "damping");
    force->free = json_number(json, "free");
    if (force->aero) {
        force->area = json_number(json, "area");
        force->reference_length = json_number(json, "reference_length");
    }
    if (force->bushing) {
        json_numbers(json, "frame_a", force->frame[0], 9);
        json_numbers(json, "frame_b", force->frame[1], 9);
        json_numbers(json, "stiffness_matrix", force->stiffness_matrix, 36);
        json_numbers(json, "damping_matrix", force->damping_matrix, 36);
    }
    const Json *law = list_of(json, "law", &laws);
    if (laws != known[type].laws)
        fail("a force has %d formulas", laws);
    for (int i = 0; i < laws; ++i)
        force->law[i] = formula_read(law->item[i]);
}

static void add_number(Tire *tire, const char *name, const char *suffix, const Json *number)
{
    if (number->kind != JSON_NUMBER)
        fail("'%s' of a tire is no number", name);
    snprintf(tire->name[tire->count], sizeof *tire->name, "%s%s", name, suffix);
    tire->value[tire->count++] = number->number;
}

static void read_tire(Tire *tire, const Json *json)
{
    static const char *const type[] = {"pac2002", "tmeasy"};
    tire->tmeasy = type_of(json, type, 2) == 1;
    tire->mode = (int)json_number(json, "mode");
    tire->radius = json_number(json, "radius");
    tire->stiffness = json_number(json, "stiffness");
    tire->damping = json_number(json, "damping");
    tire->bottom_stiffness = json_number(json, "bottom_stiffness");
    tire->bottom = json_number(json, "bottom");
    tire->low_speed = json_number(json, "low_speed");
    json_numbers(json, "relaxation", tire->relaxation, 2);
    const Json *data = json_get(json, "data");
    tire->name = grab((size_t)data->count * 2, sizeof *tire->name);
    tire->value = grab((size_t)data->count * 2, sizeof *tire->value);
    for (int i = 0; i < data->count; ++i) {
        const Json *value = data->item[i];
        add_number(tire, data->key[i], "", value->kind == JSON_LIST ? value->item[0] : value);
        if (value->kind == JSON_LIST)
            add_number(tire, data->key[i], ".2", value->item[1]);
    }
}

double tire_number(const Tire *tire, const char *name)
{
    for (int i = 0; i < tire->count; ++i)
        if (!strcmp(tire->name[i], name))
            return tire->value[i];
    fail("a tire has no '%s'", name);
}

static Formula *optional_formula(const Json *json, const char *key)
{
    return json_get(json, key)->kind == JSON_NULL ? NULL : formula_read(json_get(json, key));
}

static void read_wheel(Wheel *wheel, const Json *json, const Model *model)
{
    wheel->name = strcpy(grab(strlen(json_text(json, "name")) + 1, 1), json_text(json, "name"));
    wheel->body = index_of(json, "body", 0, model->bodies);
    json_numbers(json, "center", wheel->center, 3);
    wheel->radius = json_number(json, "radius");
    wheel->stiffness = json_number(json, "stiffness");
    wheel->damping = json_number(json, "damping");
    wheel->fade = json_number(json, "fade");
    if (json_get(json, "tire")->kind == JSON_NULL)
        return;
    wheel->tire = &model->tire[index_of(json, "tire", 0, model->tires)];
    json_numbers(json, "axis", wheel->axis, 3);
    wheel->spin_inertia = json_number(json, "spin_inertia");
    wheel->mirrored = json_number(json, "mirrored") != 0;
    wheel->drive_body = index_of(json, "drive_body", GROUND, model->bodies);
    wheel->drive = optional_formula(json, "drive");
    wheel->brake = optional_formula(json, "brake");
    if (wheel->brake) {
        wheel->windup = json_number(json, "windup");
    }
}

static void read_differential(Differential *differential, const Json *json, int wheels, int before)
{
    const Json *wheel = list_of(json, "wheels", &differential->outputs);
    const Json *other = list_of(json, "differentials", &differential->outputs);
    if (wheel->count != other->count || wheel->count < 1 || wheel->count > 2)
        fail("a differential has one or two outputs");
    for (int i = 0; i < wheel->count; ++i) {
        int w = (int)wheel->item[i]->number, d = (int)other->item[i]->number;
        if (w >= wheels || d >= before || (w < 0) == (d < 0))
            fail("a differential has a wrong output");
        differential->wheel[i] = w;
        differential->differential[i] = d;
    }
    differential->ratio = json_number(json, "ratio");
    differential->split = json_number(json, "split");
    differential->inertia = json_number(json, "inertia");
    differential->lock = optional_formula(json, "lock");
}

static Powertrain *read_powertrain(const Json *json, const Model *model)
{
    Powertrain *p = grab(1, sizeof *p);
    p->inertia = json_number(json, "inertia");
    p->idle = json_number(json, "idle");
    p->limit = json_number(json, "limit");
    p->throttle = formula_read(json_get(json, "throttle"));
    p->torque = formula_read(json_get(json, "torque"));
    p->capacity = index_of(json, "capacity", 0, model->tables);
    p->multiplication = index_of(json, "multiplication", 0, model->tables);
    list_of(json, "gears", &p->gears);
    p->reverse = index_of(json, "reverse", 0, p->gears - 1);
    p->gear = grab((size_t)p->gears, sizeof *p->gear);
    json_numbers(json, "gears", p->gear, p->gears);
    p->start_gear = (int)json_number(json, "start_gear");
    p->latency = json_number(json, "latency");
    p->duration = json_number(json, "duration");
    p->turbine = json_number(json, "turbine");
    const Json *differentials = list_of(json, "differentials", &p->differentials);
    p->differential = grab((size_t)p->differentials, sizeof *p->differential);
    for (int i = 0; i < p->differentials; ++i)
        read_differential(&p->differential[i], differentials->item[i], model->wheels, i);
    return p;
}

static void free_powertrain(Powertrain *p)
{
    if (!p)
        return;
    for (int i = 0; i < p->differentials; ++i)
        formula_free(p->differential[i].lock);
    formula_free(p->throttle);
    formula_free(p->torque);
    free(p->gear);
    free(p->differential);
    free(p);
}

static int *read_indices(const Json *json, const char *key, int limit, int *count)
{
    const Json *list = list_of(json, key, count);
    int *index = grab((size_t)*count, sizeof *index);
    for (int i = 0; i < *count; ++i) {
        double number = list->item[i]->number;
        if (list->item[i]->kind != JSON_NUMBER || !(number >= 0 && number < limit))
            fail("'%s' of a subset has a wrong index", key);
        index[i] = (int)number;
    }
    return index;
}

void design_point(const Model *model, int body, const double point[3], double out[3])
{
    if (body == GROUND) {
        memcpy(out, point, 3 * sizeof *out);
        return;
    }
    const Body *b = &model->body[body];
    const double *e = b->euler;
    /* x + 2 e0 (e x x) + 2 e x (e x x): the rotation of a unit quaternion */
    double c[3], d[3];
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = e[1 + j] * point[k] - e[1 + k] * point[j];
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        d[i] = e[1 + j] * c[k] - e[1 + k] * c[j];
        out[i] = b->position[i] + point[i] + 2 * (e[0] * c[i] + d[i]);
    }
}

/* Points of the model frame as they are collected. */
typedef struct Cloud {
    int count;
    double (*point)[3];
} Cloud;

static void cloud_add(Cloud *cloud, const Model *model, int body, const double point[3])
{
    design_point(model, body, point, cloud->point[cloud->count++]);
}

static void cloud_joint(Cloud *cloud, const Model *model, const Joint *joint)
{
    bool has_points = joint->type != PARALLEL && joint->type != PERPENDICULAR;
    for (int k = 0; k < 2 && has_points; ++k)
        cloud_add(cloud, model, joint->body[k], joint->point[k]);
}

static void cloud_coordinate(Cloud *cloud, const Model *model, const Coordinate *coordinate)
{
    for (int k = 0; k < 2 && coordinate->type != ANGLE; ++k)
        cloud_add(cloud, model, coordinate->body[k], coordinate->point[k]);
}

/* `otherwise` where all points coincide but for rounding */
static double cloud_size(Cloud *cloud, double otherwise)
{
    double size = 0;
    for (int i = 0; i < cloud->count; ++i)
        for (int j = 0; j < i; ++j) {
            const double *a = cloud->point[i], *b = cloud->point[j];
            size = fmax(size, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
        }
    free(cloud->point);
    return size > 1e-9 * otherwise ? size : otherwise;
}

double subset_length(const Model *model, const Subset *subset)
{
    int room = subset->bodies + 2 * (subset->joints + subset->coordinates);
    Cloud cloud = {.point = grab((size_t)room, sizeof *cloud.point)};
    for (int i = 0; i < subset->bodies; ++i)
        cloud_add(&cloud, model, subset->body[i], model->body[subset->body[i]].com);
    for (int i = 0; i < subset->joints; ++i)
        cloud_joint(&cloud, model, &model->joint[subset->joint[i]]);
    for (int i = 0; i < subset->coordinates; ++i)
        cloud_coordinate(&cloud, model, &model->coordinate[subset->coordinate[i]]);
    return cloud_size(&cloud, model->length);
}

static double model_length(const Model *model)
{
    static const double origin[3] = {0};
    int room = 2 * (model->bodies + model->joints + model->coordinates + model->forces) + model->wheels;
    Cloud cloud = {.point = grab((size_t)room, sizeof *cloud.point)};
    for (int i = 0; i < model->bodies; ++i) {
        cloud_add(&cloud, model, i, origin);
        cloud_add(&cloud, model, i, model->body[i].com);
    }
    for (int i = 0; i < model->joints; ++i)
        cloud_joint(&cloud, model, &model->joint[i]);
    for (int i = 0; i < model->coordinates; ++i)
        cloud_coordinate(&cloud, model, &model->coordinate[i]);
    for (int i = 0; i < model->forces; ++i)
        for (int k = 0; k < 2 - model->force[i].load && model->force[i].coordinate < 0 && !model->force[i].about; ++k)
            cloud_add(&cloud, model, model->force[i].body[k], model->force[i].point[k]);
    for (int i = 0; i < model->wheels; ++i)
        cloud_add(&cloud, model, model->wheel[i].body, model->wheel[i].center);
    return cloud_size(&cloud, 1);
}

static void read_states(Model *model, const Json *json)
{
    const Json *states = list_of(json, "states", &model->states);
    const size_t count = (size_t)model->states;
    model->state = grab(count, sizeof *model->state);
    model->state_name = grab(count, sizeof *model->state_name);
    model->state_rate = grab(count, sizeof *model->state_rate);
    for (int i = 0; i < model->states; ++i) {
        const char *name = json_text(states->item[i], "name");
        model->state_name[i] = strcpy(grab(strlen(name) + 1, 1), name);
        model->state[i] = json_number(states->item[i], "initial");
        model->state_rate[i] = formula_read(json_get(states->item[i], "rate"));
    }
}

Model *model_parse(const char *text, const char *name)
{
    Json *json = json_parse(text, name);
    Model *model = grab(1, sizeof *model);
    if (json_number(json, "gicgen_dump") != 1)
        fail("%s: not a dump of version 1", name);
    json_numbers(json, "gravity", model->gravity, 3);
    model->free_base = !strcmp(json_text(json, "base"), "free");
    const Json *bodies = list_of(json, "bodies", &model->bodies), *joints = list_of(json, "joints", &model->joints),
               *coordinates = list_of(json, "coordinates", &model->coordinates),
               *forces = list_of(json, "forces", &model->forces), *wheels = list_of(json, "wheels", &model->wheels),
               *tires = list_of(json, "tires", &model->tires), *subsets = list_of(json, "sequence", &model->subsets),
               *inputs = list_of(json, "inputs", &model->inputs), *tables = list_of(json, "tables", &model->tables);
    model->input = grab((size_t)model->inputs, sizeof *model->input);
    model->table = grab((size_t)model->tables, sizeof *model->table);
    model->input_name = grab((size_t)model->inputs, sizeof *model->input_name);
    for (int i = 0; i < model->inputs; ++i) {
        const char *input = json_text(inputs->item[i], "name");
        model->input_name[i] = strcpy(grab(strlen(input) + 1, 1), input);
        model->input[i] = json_number(inputs->item[i], "default");
    }
    for (int i = 0; i < model->tables; ++i)
        lookup_read(&model->table[i], tables->item[i]);
    model->body = grab((size_t)model->bodies, sizeof *model->body);
    model->joint = grab((size_t)model->joints, sizeof *model->joint);
    model->coordinate = grab((size_t)model->coordinates, sizeof *model->coordinate);
    model->force = grab((size_t)model->forces, sizeof *model->force);
    model->tire = grab((size_t)model->tires, sizeof *model->tire);
    model->wheel = grab((size_t)model->wheels, sizeof *model->wheel);
    model->spin = grab((size_t)model->wheels, sizeof *model->spin);
    model->subset = grab((size_t)model->subsets, sizeof *model->subset);
    for (int i = 0; i < model->bodies; ++i)
        read_body(&model->body[i], bodies->item[i]);
    for (int i = 0; i < model->joints; ++i)
        read_joint(&model->joint[i], joints->item[i], model->bodies);
    for (int i = 0; i < model->coordinates; ++i)
        read_coordinate(&model->coordinate[i], coordinates->item[i], model->bodies);
    for (int i = 0; i < model->coordinates; ++i)
        model->driven_inputs += 3 * model->coordinate[i].driven;
    for (int i = 0; i < model->forces; ++i)
        read_force(&model->force[i], forces->item[i], model);
    for (int i = 0; i < model->tires; ++i)
        read_tire(&model->tire[i], tires->item[i]);
    for (int i = 0; i < model->wheels; ++i)
        read_wheel(&model->wheel[i], wheels->item[i], model);
    for (int i = 0; i < json->count; ++i)
        if (!strcmp(json->key[i], "states"))
            read_states(model, json);
    for (int i = 0; i < json->count; ++i)
        if (!strcmp(json->key[i], "powertrain") && json->item[i]->kind != JSON_NULL)
            model->powertrain = read_powertrain(json->item[i], model);
    for (int i = 0; i < model->subsets; ++i) {
        Subset *subset = &model->subset[i];
        subset->body = read_indices(subsets->item[i], "bodies", model->bodies, &subset->bodies);
        subset->joint = read_indices(subsets->item[i], "joints", model->joints, &subset->joints);
        subset->coordinate = read_indices(subsets->item[i], "coordinates", model->coordinates, &subset->coordinates);
    }
    json_free(json);
    model->length = model_length(model);
    return model;
}

Model *model_read(const char *path)
{
    char *text = slurp(path);
    Model *model = model_parse(text, path);
    free(text);
    return model;
}

void model_free(Model *model)
{
    for (int i = 0; i < model->bodies; ++i)
        free(model->body[i].name);
    for (int i = 0; i < model->joints; ++i) {
        free(model->joint[i].name);
        formula_free(model->joint[i].value);
    }
    for (int i = 0; i < model->coordinates; ++i)
        free(model->coordinate[i].name);
    for (int i = 0; i < model->subsets; ++i) {
        free(model->subset[i].body);
        free(model->subset[i].joint);
        free(model->subset[i].coordinate);
    }
    for (int i = 0; i < model->forces; ++i)
        for (int k = 0; k < 11; ++k)
            formula_free(model->force[i].law[k]);
    for (int i = 0; i < model->tables; ++i)
        lookup_free(&model->table[i]);
    for (int i = 0; i < model->tires; ++i) {
        free(model->tire[i].name);
        free(model->tire[i].value);
    }
    for (int i = 0; i < model->wheels; ++i) {
        free(model->wheel[i].name);
        formula_free(model->wheel[i].drive);
        formula_free(model->wheel[i].brake);
    }
    for (int i = 0; i < model->inputs; ++i)
        free(model->input_name[i]);
    free(model->input_name);
    for (int i = 0; i < model->states; ++i) {
        free(model->state_name[i]);
        formula_free(model->state_rate[i]);
    }
    free(model->state);
    free(model->spin);
    free(model->state_name);
    free(model->state_rate);
    free(model->input);
    free(model->table);
    free(model->body);
    free(model->joint);
    free(model->coordinate);
    free(model->force);
    free(model->tire);
    free_powertrain(model->powertrain);
    free(model->wheel);
    free(model->subset);
    free(model);
}
