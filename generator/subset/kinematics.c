/* SPDX-License-Identifier: MIT
 * Rigid-body kinematics relative to the base, in expressions. */
#include "base/plant.h"
#include "expression/expression.h"
#include "subset/subset.h"

#include <string.h>

void motion_base(Dag *dag, Motion *motion)
{
    *motion = (Motion){.S = NULL};
    for (int i = 0; i < 3; ++i)
        motion->A[4 * i] = ex_literal(dag, 1);
}

/* Consecutive numbers of a Motion. */
typedef struct Reading {
    Dag *dag;
    Array array;
    int which, offset, stride;
} Reading;

static void read_numbers(const Reading *from, int first, int count, Ex *out)
{
    for (int i = 0; i < count; ++i) {
        int index = from->offset + from->stride * (first + i);
        out[i] = ex_input(from->dag, element_of(from->array, from->which, index), NULL);
    }
}

static void read_pose(const Reading *from, Motion *motion)
{
    read_numbers(from, MOTION_C, 3, motion->c);
    read_numbers(from, MOTION_A, 9, motion->A);
}

void motion_input_pose(Dag *dag, Motion *motion, Array array, int offset)
{
    read_pose(&(Reading){dag, array, 0, offset, 1}, motion);
}

void motion_input(Dag *dag, Motion *motion, Array array, int which, int offset, int stride, int deps)
{
    const Reading from = {dag, array, which, offset, stride};
    read_pose(&from, motion);
    read_numbers(&from, MOTION_OMEGA, 3, motion->omega);
    read_numbers(&from, MOTION_VELOCITY, 3, motion->velocity);
    read_numbers(&from, MOTION_ALPHA, 3, motion->alpha);
    read_numbers(&from, MOTION_ACCELERATION, 3, motion->acceleration);
    motion->deps = deps;
    motion->S = pool_alloc(dag->pool, (size_t)(6 * deps) * sizeof *motion->S);
    read_numbers(&from, MOTION_S, 6 * deps, motion->S);
}

Ex *motion_number(Motion *motion, int place)
{
    Ex *const part[] = {motion->c, motion->A, motion->omega, motion->velocity, motion->alpha, motion->acceleration};
    static const int first[] = {MOTION_C, MOTION_A, MOTION_OMEGA, MOTION_VELOCITY, MOTION_ALPHA, MOTION_ACCELERATION};
    int i = sizeof first / sizeof *first - 1;
    if (place >= MOTION_S)
        return motion->S + (place - MOTION_S);
    while (first[i] > place)
        --i;
    return part[i] + (place - first[i]);
}

const char *motion_number_name(int place)
{
    static const char *const name[MOTION_S] = {
        "C_X",     "C_Y",     "C_Z",     "A_XX",           "A_XY",           "A_XZ",
        "A_YX",    "A_YY",    "A_YZ",    "A_ZX",           "A_ZY",           "A_ZZ",
        "OMEGA_X", "OMEGA_Y", "OMEGA_Z", "VELOCITY_X",     "VELOCITY_Y",     "VELOCITY_Z",
        "ALPHA_X", "ALPHA_Y", "ALPHA_Z", "ACCELERATION_X", "ACCELERATION_Y", "ACCELERATION_Z"};
    return name[place];
}

/* Rate and bias of a vector fixed in the body: omega x arm, alpha x arm + omega x (omega x arm). */
static void turn(Dag *dag, const Motion *motion, Vector *vector)
{
    Ex angular[3];
    ex_cross(dag, motion->omega, vector->arm, vector->rate);
    ex_cross(dag, motion->omega, vector->rate, vector->bias);
    ex_cross(dag, motion->alpha, vector->arm, angular);
    ex_add3(dag, vector->bias, angular, vector->bias);
}

void motion_image(Dag *dag, Motion *motion, const Ex s[3], const Ex v[3])
{
    Image *image = POOL_PUSH(dag->pool, motion->image, motion->images);
    memcpy(image->s, s, sizeof image->s);
    memcpy(image->v, v, sizeof image->v);
    image->side = false;
}

void motion_side(Dag *dag, Motion *motion, const Ex s[3], const Ex v[3])
{
    motion_image(dag, motion, s, v);
    motion->image[motion->images - 1].side = true;
}

/* A u, or the known image of u. */
static void rotate(Dag *dag, const Motion *motion, const Ex u[3], bool point, Ex out[3])
{
    Ex opposite[3], minus = ex_literal(dag, -1);
    ex_scale3(dag, minus, u, opposite);
    for (int i = 0; i < motion->images; ++i) {
        const Image *image = &motion->image[i];
        if (image->side && point && !planted("image"))
            continue;
        if (!memcmp(image->s, u, sizeof image->s)) {
            memcpy(out, image->v, sizeof image->v);
            return;
        }
        if (!memcmp(image->s, opposite, sizeof image->s)) {
            ex_scale3(dag, minus, image->v, out);
            return;
        }
    }
    ex_apply(dag, motion->A, u, out);
}

static Vector vector_of(Dag *dag, const Motion *motion, const Ex u[3], bool point)
{
    Vector vector = {.point = point};
    rotate(dag, motion, u, point, vector.arm);
    for (int i = 0; i < 3; ++i)
        vector.v[i] = vector.arm[i];
    turn(dag, motion, &vector);
    return vector;
}

Vector vector_axis(Dag *dag, const Motion *motion, const Ex u[3])
{
    return vector_of(dag, motion, u, false);
}

Vector vector_point(Dag *dag, const Motion *motion, const Ex s[3])
{
    Vector vector = vector_of(dag, motion, s, true);
    ex_add3(dag, motion->c, vector.arm, vector.v);
    ex_add3(dag, motion->velocity, vector.rate, vector.rate);
    ex_add3(dag, motion->acceleration, vector.bias, vector.bias);
    return vector;
}
