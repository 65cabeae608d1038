/* SPDX-License-Identifier: MIT
 * The shape of a body on the page: the one in the model, or one chosen by its mass, inertia and points. */
#include "base/text.h"
#include "base/vec3.h"
#include "model/model.h"
#include "run/animate.h"

#include <math.h>
#include <string.h>

const char *const look_name[LOOKS] = {
    [LOOK_FRAME] = "frame", [LOOK_POINTS] = "points",     [LOOK_HULL] = "hull", [LOOK_GLASS] = "glass",
    [LOOK_BOX] = "box",     [LOOK_CYLINDER] = "cylinder", [LOOK_MESH] = "mesh",
};

/* ---- what the model names ------------------------------------------------------------------------------------ */

/* The axis of the body frame about which the other two moments are most alike. */
static int round_axis(const double box[3])
{
    int best = 0;
    for (int k = 1; k < 3; ++k)
        if (fabs(box[(k + 1) % 3] - box[(k + 2) % 3]) < fabs(box[(best + 1) % 3] - box[(best + 2) % 3]))
            best = k;
    return best;
}

/* Radius and length of a solid cylinder with the moments of inertia of a box with these edges: about its axis m r^2 / 2
 * = m (a^2 + b^2) / 12, across m l^2 / 12 + m r^2 / 4. Its axis need not be one of the box. */
static void cylinder_size(const BodyShape *named, const double box[3], Shape *shape)
{
    double square[3], about = 0, sum = 0;
    for (int i = 0; i < 3; ++i)
        sum += square[i] = box[i] * box[i];
    for (int i = 0; i < 3; ++i)
        about += shape->axis[i] * shape->axis[i] * (sum - square[i]); /* 12 I / m */
    const double across = (2 * sum - about) / 2, radius = sqrt(about / 6);
    const double length = sqrt(fmax(across - 3 * radius * radius, 0.01 * radius * radius));
    shape->size[0] = named->radius > 0 ? named->radius : radius;
    shape->size[1] = named->length > 0 ? named->length : length;
}

static void take_named(Pool *pool, const BodyShape *named, Shape *shape)
{
    static const Look look[SHAPE_TYPES] = {
        [SHAPE_BOX] = LOOK_BOX, [SHAPE_CYLINDER] = LOOK_CYLINDER, [SHAPE_MESH] = LOOK_MESH};
    shape->look = look[named->type];
    shape->mesh = named;
    memcpy(shape->middle, named->placed ? named->center : shape->com, sizeof shape->middle);
    if (named->type == SHAPE_BOX)
        memcpy(shape->size, named->size[0] > 0 ? named->size : shape->box, sizeof shape->size);
    if (named->type == SHAPE_CYLINDER) {
        shape->axis[round_axis(shape->box)] = 1;
        if (named->along)
            memcpy(shape->axis, named->axis, sizeof shape->axis);
        cylinder_size(named, shape->box, shape);
    }
    /* the extent that the camera has to show */
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int c = 0; c < named->corners; ++c)
        for (int i = 0; i < 3; ++i) {
            low[i] = fmin(low[i], named->corner[c][i]);
            high[i] = fmax(high[i], named->corner[c][i]);
        }
    for (int i = 0; i < 3 && !named->corners; ++i) {
        const double half = named->type == SHAPE_BOX
                                ? shape->size[i] / 2
                                : fabs(shape->axis[i]) * shape->size[1] / 2 +
                                      sqrt(1 - fmin(shape->axis[i] * shape->axis[i], 1)) * shape->size[0];
        low[i] = shape->middle[i] - half;
        high[i] = shape->middle[i] + half;
    }
    for (int k = 0; k < 8; ++k) {
        Point *corner = POOL_PUSH(pool, shape->point, shape->points);
        for (int i = 0; i < 3; ++i)
            corner->x[i] = k >> i & 1 ? high[i] : low[i];
    }
}

/* ---- what is suggested --------------------------------------------------------------------------------------- */

/* True for a heavy body, such as a car body or a trailer: its points are attachments and do not show its size. */
static bool is_heavy(const Model *model, int body)
{
    double all = 0;
    for (int b = 0; b < model->bodies; ++b)
        all += model->body[b].mass;
    return model->wheels && model->body[body].mass > 0.15 * all;
}

/* True if all points coincide. */
static bool is_one_point(const Shape *shape)
{
    const double edge = norm3(shape->box);
    for (int i = 0; i < shape->points; ++i)
        for (int k = 0; k < 3; ++k)
            if (fabs(shape->point[i].x[k] - shape->point[0].x[k]) > 0.01 * edge)
                return false;
    return true;
}

/* The box of the inertia; above wheels that the body itself carries it begins at the height of their centres. */
static void glass_box(const Model *model, const Shapes *shapes, int body, Shape *shape)
{
    memcpy(shape->middle, shape->com, sizeof shape->middle);
    memcpy(shape->size, shape->box, sizeof shape->size);
    for (int w = 0; w < model->wheels; ++w) {
        const double *center = shapes->center[w], top = shape->middle[2] + shape->size[2] / 2;
        const double low = shape->middle[2] - shape->size[2] / 2;
        if (model->wheel[w].body != body || low >= center[2] || top - center[2] < 0.3 * shape->size[2])
            continue;
        shape->middle[2] = (top + center[2]) / 2;
        shape->size[2] = top - center[2];
    }
}

void looks_choose(Pool *pool, const Model *model, Shapes *shapes)
{
    for (int b = 0; b < model->bodies; ++b) {
        Shape *shape = &shapes->body[b];
        if (model->body[b].shape)
            take_named(pool, model->body[b].shape, shape);
        else if (b == BODY_BASE)
            shape->look = model->free_base ? LOOK_FRAME : LOOK_POINTS;
        else if (is_heavy(model, b) || is_one_point(shape))
            shape->look = LOOK_GLASS;
        else
            shape->look = LOOK_HULL;
        if (shape->look == LOOK_GLASS || shape->look == LOOK_FRAME)
            glass_box(model, shapes, b, shape);
    }
}

/* ---- JSON ---------------------------------------------------------------------------------------------------- */

static void json_numbers(Text *out, const char *key, const double x[3])
{
    text_print(out, ",\"%s\":[%.6g,%.6g,%.6g]", key, x[0], x[1], x[2]);
}

void json_look(Text *out, const Shape *shape)
{
    text_print(out, "\"look\":\"%s\"", look_name[shape->look]);
    if (shape->look == LOOK_MESH) {
        text_print(out, ",\"corners\":[");
        for (int i = 0; i < shape->mesh->corners; ++i)
            for (int k = 0; k < 3; ++k)
                text_print(out, "%s%.6g", i || k ? "," : "", shape->mesh->corner[i][k]);
        text_print(out, "],\"triangles\":[");
        for (int i = 0; i < shape->mesh->triangles; ++i)
            for (int k = 0; k < 3; ++k)
                text_print(out, "%s%d", i || k ? "," : "", shape->mesh->triangle[i][k]);
        text_print(out, "]");
    } else if (shape->look != LOOK_HULL && shape->look != LOOK_POINTS) {
        json_numbers(out, "middle", shape->middle);
        json_numbers(out, "axis", shape->axis);
        json_numbers(out, "size", shape->size);
    }
}
