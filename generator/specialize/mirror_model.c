/* SPDX-License-Identifier: MIT
 * Decides if a model equals its own mirror image. The numbers of each side are compared with the image of the other
 * side's, bit for bit. Nearly equal is not enough: a wheel that is 1e-15 heavier steers the vehicle. */
#include "base/vec3.h"
#include "model/model.h"
#include "read/reader.h"
#include "specialize/mirror_model.h"

#include <string.h>

double mirror_vector(int i)
{
    return i == 1 ? -1 : 1;
}

double mirror_turn(int i)
{
    return i == 1 ? 1 : -1;
}

double mirror_matrix(int i)
{
    return (i / 3 == 1) != (i % 3 == 1) ? -1 : 1;
}

double mirror_inertia(int i)
{
    return i == 3 || i == 5 ? -1 : 1;
}

static double plain(int i)
{
    (void)i;
    return 1;
}

typedef struct Search {
    Pool *pool;
    const Model *model;
    int *body, *coordinate, *wheel;
    double *sign;
    const char **why;
} Search;

/* Is b the image of a, or times `sign`? */
static bool is_image(const double a[3], const double b[3], double (*parity)(int), double sign)
{
    return b[0] == sign * parity(0) * a[0] && b[1] == sign * parity(1) * a[1] && b[2] == sign * parity(2) * a[2];
}

/* 1 or -1: b is the image of a times that; 0: it is not. */
static double direction_sign(const double a[3], const double b[3], double (*parity)(int))
{
    return is_image(a, b, parity, 1) ? 1 : is_image(a, b, parity, -1) ? -1 : 0;
}

static bool refuse(Search *s, const char *what, const char *name)
{
    *s->why = pool_print(s->pool, "%s '%s' has no mirror image", what, name);
    return false;
}

/* Places of images in an array of structures that begin with a name. */
static int *pair_names(Search *s, const void *array, int count, size_t size)
{
    int *image = pool_alloc(s->pool, ((size_t)count + 1) * sizeof *image);
    for (int i = 0; i < count; ++i) {
        const char *name = *(const char *const *)((const char *)array + (size_t)i * size);
        const char *other = name_mirrored(s->pool, name);
        image[i] = i;
        for (int k = 0; k < count && other; ++k)
            if (!strcmp(*(const char *const *)((const char *)array + (size_t)k * size), other))
                image[i] = k;
    }
    return image;
}

/* Euler parameters and their opposites are one rotation. */
static bool turns_fit(const double a[4], const double b[4])
{
    bool same = true, opposite = true;
    for (int i = 0; i < 4; ++i) {
        const double image = (i % 2 ? -1 : 1) * a[i];
        same = same && b[i] == image;
        opposite = opposite && b[i] == -image;
    }
    return same || opposite;
}

/* a, b: places among the bodies. Where the joints put bodies that are drawn elsewhere follows from the joints. */
static bool body_fits(const Search *s, int a, int b)
{
    const Body *own = &s->model->body[a], *other = &s->model->body[b], *base = &s->model->drawn[BODY_BASE];
    const Body *drawn = &s->model->drawn[a], *image = &s->model->drawn[b];
    double from[3], to[3];
    for (int i = 0; i < 3; ++i) {
        from[i] = drawn->position[i] - base->position[i];
        to[i] = image->position[i] - base->position[i];
    }
    bool fits = own->mass == other->mass && is_image(own->com, other->com, mirror_vector, 1) &&
                is_image(from, to, mirror_vector, 1) && turns_fit(drawn->euler, image->euler);
    for (int i = 0; i < 6; ++i)
        fits = fits && other->inertia[i] == mirror_inertia(i) * own->inertia[i];
    return fits;
}

static bool bodies_fit(Search *s)
{
    const Model *model = s->model;
    s->body = pair_names(s, model->body, model->bodies, sizeof *model->body);
    for (int b = 0; b < model->bodies; ++b)
        if (!body_fits(s, b, s->body[b]))
            return refuse(s, "body", model->body[b].name);
    return true;
}

static int body_image(const Search *s, int body)
{
    return body == BODY_GROUND ? BODY_GROUND : s->body[body];
}

/* The component in which a direction along an axis of its frame points, -1: it has no such direction. */
static int along(const double axis[3])
{
    int k = -1, others = 0;
    for (int i = 0; i < 3; ++i) {
        others += axis[i] != 0 && k >= 0;
        k = axis[i] != 0 && k < 0 ? i : k;
    }
    return others ? -1 : k;
}

/* True if end `end` of joint b matches that of a. Where b slides along an axis of that end's frame, its point may
 * lie anywhere along the axis: a shift along it is exact and changes no other component. */
static bool point_fits(const Joint *a, int end, const Joint *b, int other)
{
    const bool slides =
        b->type == JOINT_PRISMATIC || b->type == JOINT_CYLINDRICAL || (b->type == JOINT_POINT_ON_LINE && other == 0);
    const int k = along(b->axis[other]);
    double point[3];
    for (int i = 0; i < 3; ++i)
        point[i] = mirror_vector(i) * a->point[end][i];
    /* a hinge in the middle: both ends, which are one point, shift by as much */
    const bool hinge = a == b && b->type == JOINT_REVOLUTE && k == 1 && a->point[0][1] == a->point[1][1];
    if (k >= 0 && (slides || hinge))
        point[k] = b->point[other][k];
    return is_image(point, b->point[other], plain, 1);
}

/* May the ends of a joint change places? A plane, a line or a link's axis is fixed in the first body. */
static bool has_equal_ends(const Joint *joint)
{
    return joint->type != JOINT_POINT_ON_LINE && joint->type != JOINT_POINT_IN_PLANE &&
           joint->type != JOINT_REVOLUTE_SPHERICAL;
}

/* Which direction keeps both bodies from turning about the axis. */
static bool sides_fit(const Joint *a, const Joint *b, bool swapped)
{
    const double sign = direction_sign(a->side[0], b->side[swapped], mirror_vector);
    return (a->type != JOINT_PRISMATIC && a->type != JOINT_FIXED) ||
           (sign != 0 && is_image(a->side[1], b->side[!swapped], mirror_vector, sign));
}

/* swapped: the ends have changed places. */
static bool joint_fits(const Search *s, const Joint *a, const Joint *b, bool swapped)
{
    double sign = 0;
    /* a way and a turn: their signs in the mirror are not looked into */
    bool fits = a->type == b->type && !joint_is_geared(a->type) && !joint_is_coupled(a->type) &&
                a->length == b->length && (!swapped || has_equal_ends(a));
    for (int end = 0; end < 2 && fits; ++end) {
        const int other = swapped ? 1 - end : end;
        fits = b->body[other] == body_image(s, a->body[end]) && point_fits(a, end, b, other);
        const double own = direction_sign(a->axis[end], b->axis[other], mirror_vector);
        fits = fits && own != 0 && (own == sign || !end || norm3(a->axis[end]) == 0);
        sign = end ? sign : own;
    }
    return fits && b->offset == sign * a->offset && sides_fit(a, b, swapped);
}

static bool joints_fit(Search *s)
{
    const Model *model = s->model;
    const int *image = pair_names(s, model->joint, model->joints, sizeof *model->joint);
    for (int j = 0; j < model->joints; ++j) {
        const Joint *a = &model->joint[j], *b = &model->joint[image[j]];
        if (!joint_fits(s, a, b, false) && !joint_fits(s, a, b, true))
            return refuse(s, "joint", a->name);
    }
    return true;
}

/* Angles are measured between directions in both bodies. */
static bool references_fit(const Coordinate *a, const Coordinate *b)
{
    const double sign = direction_sign(a->reference[0], b->reference[0], mirror_vector);
    return sign != 0 && is_image(a->reference[1], b->reference[1], mirror_vector, sign);
}

/* How the image's value goes with the value: 1, -1, 0: not at all. */
static double coordinate_sign(const Search *s, const Coordinate *a, const Coordinate *b)
{
    double sign = 1;
    bool fits = a->type == b->type && a->driven == b->driven;
    for (int end = 0; end < 2; ++end)
        fits = fits && b->body[end] == body_image(s, a->body[end]);
    if (a->type != COORDINATE_LENGTH)
        sign = direction_sign(a->axis, b->axis, a->type == COORDINATE_ANGLE ? mirror_turn : mirror_vector);
    for (int end = 0; end < 2 && fits && a->type != COORDINATE_ANGLE; ++end)
        fits = is_image(a->point[end], b->point[end], mirror_vector, 1);
    if (a->type == COORDINATE_ANGLE)
        fits = fits && references_fit(a, b);
    return fits && b->design == sign * a->design && b->offset == sign * a->offset ? sign : 0;
}

static bool coordinates_fit(Search *s)
{
    const Model *model = s->model;
    s->coordinate = pair_names(s, model->coordinate, model->coordinates, sizeof *model->coordinate);
    s->sign = pool_alloc(s->pool, ((size_t)model->coordinates + 1) * sizeof *s->sign);
    for (int w = 0; w < model->coordinates; ++w) {
        s->sign[w] = coordinate_sign(s, &model->coordinate[w], &model->coordinate[s->coordinate[w]]);
        if (s->sign[w] == 0)
            return refuse(s, "coordinate", model->coordinate[w].name);
    }
    return true;
}

static bool wheel_fits(const Search *s, const Wheel *a, const Wheel *b)
{
    bool fits = b->body == body_image(s, a->body) && is_image(a->center, b->center, mirror_vector, 1) &&
                a->radius == b->radius && a->stiffness == b->stiffness && a->damping == b->damping &&
                a->fade == b->fade && a->tire == b->tire;
    if (a->tire < 0)
        return fits;
    return fits && is_image(a->axis, b->axis, mirror_turn, 1) && a->spin_inertia == b->spin_inertia &&
           a->windup == b->windup && wheel_fast_states(a) == wheel_fast_states(b) &&
           (a->mirrored != b->mirrored || s->model->tire[a->tire].side == SIDE_SYMMETRIC);
}

static bool wheels_fit(Search *s)
{
    const Model *model = s->model;
    s->wheel = pair_names(s, model->wheel, model->wheels, sizeof *model->wheel);
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *a = &model->wheel[i];
        if (!wheel_fits(s, a, &model->wheel[s->wheel[i]]) || (a->tire >= 0 && s->wheel[i] == i))
            return refuse(s, "wheel", a->name);
    }
    return true;
}

const Mirror *mirror_find(Pool *pool, const Model *model, const char **why)
{
    Search s = {.pool = pool, .model = model, .why = why};
    const Body *base = &model->body[BODY_BASE];
    if (model->gravity[1] != 0 || base->euler[1] != 0 || base->euler[3] != 0) {
        *why = "the base or gravity leans to one side";
        return NULL;
    }
    if (!bodies_fit(&s) || !joints_fit(&s) || !coordinates_fit(&s) || !wheels_fit(&s))
        return NULL;
    Mirror *mirror = pool_alloc(pool, sizeof *mirror);
    *mirror = (Mirror){.body = s.body, .coordinate = s.coordinate, .wheel = s.wheel, .sign = s.sign};
    return mirror;
}
