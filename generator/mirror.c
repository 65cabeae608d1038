/* SPDX-License-Identifier: MIT
 * Is a model its own mirror image? By its numbers, whoever wrote them: those of each side are compared with the image
 * of the other's. */
#include "mirror.h"

#include "read.h"

#include <math.h>
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

typedef struct Search {
    Pool *pool;
    const Model *model;
    int *body, *coordinate, *wheel;
    double *sign;
    const char **why;
} Search;

static bool near(double a, double b)
{
    const double rounding = 1e-12;
    return fabs(a - b) <= rounding * (1 + fabs(a));
}

/* Is b the image of a, or times `sign`? */
static bool is_image(const double a[3], const double b[3], double (*parity)(int), double sign)
{
    return near(b[0], sign * parity(0) * a[0]) && near(b[1], sign * parity(1) * a[1]) &&
           near(b[2], sign * parity(2) * a[2]);
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

static bool body_fits(const Search *s, const Body *a, const Body *b)
{
    const Body *base = &s->model->body[BODY_BASE];
    double from[3], to[3], turned = 0;
    for (int i = 0; i < 3; ++i) {
        from[i] = a->position[i] - base->position[i];
        to[i] = b->position[i] - base->position[i];
    }
    for (int i = 0; i < 4; ++i)
        turned += a->euler[i] * b->euler[i] * (i % 2 ? -1 : 1);
    bool fits = near(a->mass, b->mass) && is_image(a->com, b->com, mirror_vector, 1) &&
                is_image(from, to, mirror_vector, 1) && near(fabs(turned), 1);
    for (int i = 0; i < 6; ++i)
        fits = fits && near(b->inertia[i], mirror_inertia(i) * a->inertia[i]);
    return fits;
}

static bool bodies_fit(Search *s)
{
    const Model *model = s->model;
    s->body = pair_names(s, model->body, model->bodies, sizeof *model->body);
    for (int b = 0; b < model->bodies; ++b)
        if (!body_fits(s, &model->body[b], &model->body[s->body[b]]))
            return refuse(s, "body", model->body[b].name);
    return true;
}

static int body_image(const Search *s, int body)
{
    return body == BODY_GROUND ? BODY_GROUND : s->body[body];
}

/* Points that a joint may shift along its axis without a change. */
static bool point_fits(const Joint *joint, int end, const double a[3], const double b[3])
{
    const bool slides = joint->type == JOINT_REVOLUTE || joint->type == JOINT_PRISMATIC ||
                        joint->type == JOINT_CYLINDRICAL || joint->type == JOINT_POINT_ON_LINE;
    double shift[3], across[3];
    if (is_image(a, b, mirror_vector, 1))
        return true;
    for (int i = 0; i < 3; ++i)
        shift[i] = b[i] - mirror_vector(i) * a[i];
    vec_cross(shift, joint->axis[end], across);
    return slides && near(vec_norm(across), 0);
}

/* swapped: the ends have changed places. */
static bool joint_fits(const Search *s, const Joint *a, const Joint *b, bool swapped)
{
    double sign = 0;
    bool fits = a->type == b->type && near(a->length, b->length);
    for (int end = 0; end < 2 && fits; ++end) {
        const int other = swapped ? 1 - end : end;
        fits = b->body[other] == body_image(s, a->body[end]) && point_fits(b, other, a->point[end], b->point[other]);
        const double own = direction_sign(a->axis[end], b->axis[other], mirror_vector);
        fits = fits && own != 0 && (own == sign || !end || vec_norm(a->axis[end]) == 0);
        sign = end ? sign : own;
    }
    return fits && near(b->offset, sign * a->offset);
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

/* How the image's value goes with the value: 1, -1, 0: not at all. */
static double coordinate_sign(const Search *s, const Coordinate *a, const Coordinate *b)
{
    double sign = 1;
    bool fits = a->type == b->type && a->driven == b->driven;
    for (int end = 0; end < 2; ++end)
        fits = fits && b->body[end] == body_image(s, a->body[end]);
    if (a->type != COORDINATE_LENGTH)
        sign = direction_sign(a->axis, b->axis, a->type == COORDINATE_ANGLE ? mirror_turn : mirror_vector);
    else
        fits = fits && is_image(a->point[0], b->point[0], mirror_vector, 1) &&
               is_image(a->point[1], b->point[1], mirror_vector, 1);
    return fits && near(b->design, sign * a->design) ? sign : 0;
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
                near(a->radius, b->radius) && near(a->stiffness, b->stiffness) && near(a->damping, b->damping) &&
                near(a->fade, b->fade) && a->tire == b->tire;
    if (a->tire < 0)
        return fits;
    return fits && is_image(a->axis, b->axis, mirror_turn, 1) && near(a->spin_inertia, b->spin_inertia) &&
           near(a->windup, b->windup) && wheel_fast_states(a) == wheel_fast_states(b) &&
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
    if (!near(model->gravity[1], 0) || !near(base->euler[1], 0) || !near(base->euler[3], 0)) {
        *why = "the base or gravity leans to one side";
        return NULL;
    }
    if (!bodies_fit(&s) || !joints_fit(&s) || !coordinates_fit(&s) || !wheels_fit(&s))
        return NULL;
    Mirror *mirror = pool_alloc(pool, sizeof *mirror);
    *mirror = (Mirror){.body = s.body, .coordinate = s.coordinate, .wheel = s.wheel, .sign = s.sign};
    return mirror;
}
