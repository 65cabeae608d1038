/* SPDX-License-Identifier: MIT
 * Kinematics of a mechanism in the world frame: poses, and the equations of joints and dual coordinates (FORMAT.md
 * sections 4 and 5) with their derivatives, in loops over their parts. */
#include "world.h"

#include "small.h"

#include <math.h>
#include <string.h>

/* What ties are made of; rows in this order. */
enum {
    PART_POINT = 1,    /* x_a = x_b: 3 rows */
    PART_PARALLEL = 2, /* u_a parallel to u_b: 2 */
    PART_LOCK = 4,     /* no turn about the common axis: 1 */
    PART_LINE = 8,     /* x_b - x_a parallel to u_a: 2 */
    PART_LENGTH = 16,  /* norm(x_b - x_a): 1 */
    PART_ALONG = 32,   /* u_a . (x_b - x_a): 1 */
    PART_CROSS = 64,   /* u_a perpendicular to u_b: 1 */
    PART_TURN = 128    /* angle of f_1 about u_a: 1 */
};

static const int parts_of_joint[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = PART_POINT | PART_PARALLEL,
    [JOINT_SPHERICAL] = PART_POINT,
    [JOINT_PRISMATIC] = PART_PARALLEL | PART_LOCK | PART_LINE,
    [JOINT_CYLINDRICAL] = PART_PARALLEL | PART_LINE,
    [JOINT_UNIVERSAL] = PART_POINT | PART_CROSS,
    [JOINT_FIXED] = PART_POINT | PART_PARALLEL | PART_LOCK,
    [JOINT_DISTANCE] = PART_LENGTH,
    [JOINT_REVOLUTE_SPHERICAL] = PART_LENGTH | PART_ALONG,
    [JOINT_POINT_ON_LINE] = PART_LINE,
    [JOINT_POINT_IN_PLANE] = PART_ALONG,
    [JOINT_PARALLEL] = PART_PARALLEL,
    [JOINT_PERPENDICULAR] = PART_CROSS,
};

static const int parts_of_coordinate[COORDINATE_TYPES] = {
    [COORDINATE_LENGTH] = PART_LENGTH, [COORDINATE_TRANSLATION] = PART_ALONG, [COORDINATE_ANGLE] = PART_TURN};

/* ---- what is known before the first evaluation -------------------------------------------------------------------- */

static void set_arms(const Model *model, Tie *tie, const double point[2][3])
{
    for (int end = 0; end < 2; ++end)
        sub3(point[end], model->body[tie->body[end]].com, tie->arm[end]);
}

static Tie tie_of_joint(const Model *model, int index)
{
    const Joint *joint = &model->joint[index];
    Tie tie = {.body = {joint->body[0], joint->body[1]},
               .joint = index,
               .coordinate = -1,
               .rows = joint_equations[joint->type],
               .parts = parts_of_joint[joint->type],
               .constraint = true,
               .length = joint->length,
               .offset = joint->offset};
    if (tie.parts & (PART_POINT | PART_LINE | PART_LENGTH | PART_ALONG))
        set_arms(model, &tie, joint->point);
    memcpy(tie.axis, joint->axis, sizeof tie.axis);
    copy3(joint->side[0], tie.side[0]);
    cross3(joint->axis[0], joint->side[0], tie.side[1]);
    cross3(joint->axis[1], joint->side[1], tie.other);
    return tie;
}

static Tie tie_of_coordinate(const Model *model, int index)
{
    const Coordinate *coordinate = &model->coordinate[index];
    const bool translation = coordinate->type == COORDINATE_TRANSLATION;
    Tie tie = {.body = {coordinate->body[0], coordinate->body[1]},
               .joint = -1,
               .coordinate = index,
               .rows = 1,
               .parts = parts_of_coordinate[coordinate->type],
               .constraint = coordinate->driven,
               .offset = coordinate->design - (translation ? coordinate->offset : 0)};
    if (tie.parts != PART_TURN)
        set_arms(model, &tie, coordinate->point);
    copy3(coordinate->axis, tie.axis[0]);
    copy3(coordinate->reference[0], tie.side[0]);
    cross3(coordinate->axis, coordinate->reference[0], tie.side[1]);
    copy3(coordinate->reference[1], tie.other);
    return tie;
}

static void set_design(World *world)
{
    for (int b = 0; b < world->bodies; ++b) {
        const Body *body = &world->model->body[b];
        double A[9], *q = world->q_design + BODY_Q * b;
        mat_from_euler(body->euler, A);
        apply3(A, body->com, q);
        add3(q, body->position, q);
        memcpy(q + 3, body->euler, sizeof body->euler);
        pose_set(&world->pose[b], q);
    }
}

World *world_new(Pool *pool, const Model *model, const Sequence *sequence)
{
    World *world = pool_alloc(pool, sizeof *world);
    const size_t bodies = (size_t)model->bodies, ties = (size_t)(model->joints + model->coordinates),
                 coordinates = (size_t)model->coordinates + 1;
    Tie *tie = pool_alloc(pool, (ties + 1) * sizeof *tie);
    *world = (World){.model = model,
                     .sequence = sequence,
                     .bodies = model->bodies,
                     .first = model->free_base ? 0 : 1,
                     .ties = (int)ties,
                     .tie = tie,
                     .size = 0.01};
    for (int i = 0; i < world->ties; ++i) {
        tie[i] = i < model->joints ? tie_of_joint(model, i) : tie_of_coordinate(model, i - model->joints);
        tie[i].first = world->rows;
        world->rows += tie[i].rows;
        for (int end = 0; end < 2; ++end)
            if (tie[i].body[end] >= world->first)
                world->size = fmax(world->size, sqrt(dot3(tie[i].arm[end], tie[i].arm[end])));
    }
    const size_t rows = (size_t)world->rows + 1;
    world->q_design = pool_alloc(pool, bodies * BODY_Q * sizeof(double));
    world->pose = pool_alloc(pool, bodies * sizeof *world->pose);
    world->twist = pool_alloc(pool, bodies * sizeof *world->twist);
    world->x = pool_alloc(pool, coordinates * sizeof(double));
    world->xd = pool_alloc(pool, coordinates * sizeof(double));
    world->xdd = pool_alloc(pool, coordinates * sizeof(double));
    world->value = pool_alloc(pool, rows * sizeof(double));
    world->J = pool_alloc(pool, rows * sizeof *world->J);
    world->dual = pool_alloc(pool, coordinates * sizeof(double));
    world->gamma = pool_alloc(pool, rows * sizeof(double));
    world->vectors = pool_alloc(pool, (ties + 1) * sizeof *world->vectors);
    world->wrench = pool_alloc(pool, bodies * sizeof *world->wrench);
    world->along = pool_alloc(pool, coordinates * sizeof(double));
    world->element = pool_alloc(pool, ((size_t)model->forces + 1) * sizeof(double));
    world->wheel = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *world->wheel);
    world->acceleration = pool_alloc(pool, bodies * sizeof *world->acceleration);
    world->multiplier = pool_alloc(pool, rows * sizeof(double));
    set_design(world);
    world_open_accelerator(pool, world);
    return world;
}

/* ---- bodies ------------------------------------------------------------------------------------------------------- */

static void pose_turn(Pose *pose)
{
    const double *p = pose->p;
    double *A = pose->A;
    const double x = 2 * p[1], y = 2 * p[2], z = 2 * p[3];
    const double wx = p[0] * x, wy = p[0] * y, wz = p[0] * z, xx = p[1] * x, yy = p[2] * y, zz = p[3] * z;
    const double xy = p[1] * y, xz = p[1] * z, yz = p[2] * z;
    A[0] = 1 - (yy + zz);
    A[1] = xy - wz;
    A[2] = xz + wy;
    A[3] = xy + wz;
    A[4] = 1 - (xx + zz);
    A[5] = yz - wx;
    A[6] = xz - wy;
    A[7] = yz + wx;
    A[8] = 1 - (xx + yy);
}

void pose_set(Pose *pose, const double q[BODY_Q])
{
    memcpy(pose->r, q, sizeof pose->r);
    memcpy(pose->p, q + 3, sizeof pose->p);
    pose_turn(pose);
}

void pose_get(const Pose *pose, double q[BODY_Q])
{
    memcpy(q, pose->r, sizeof pose->r);
    memcpy(q + 3, pose->p, sizeof pose->p);
}

void pose_move(Pose *pose, const double dq[BODY_Q])
{
    double *p = pose->p, square = 0;
    add3(pose->r, dq, pose->r);
    for (int i = 0; i < 4; ++i) {
        p[i] += dq[3 + i];
        square += p[i] * p[i];
    }
    const double scale = 1 / sqrt(square);
    for (int i = 0; i < 4; ++i)
        p[i] *= scale;
    pose_turn(pose);
}

void twist_set(Twist *twist, const double p[4], const double qd[BODY_Q])
{
    copy3(qd, twist->v);
    euler_turn(p, qd + 3, twist->omega);
    for (int i = 0; i < 3; ++i)
        twist->omega[i] *= 2;
}

void twist_get(const Twist *twist, const double p[4], double qd[BODY_Q])
{
    copy3(twist->v, qd);
    euler_rate(p, twist->omega, qd + 3);
    for (int i = 3; i < BODY_Q; ++i)
        qd[i] *= 0.5;
}

void world_columns(const double J[6], const double p[4], double out[BODY_Q])
{
    copy3(J, out);
    euler_rate(p, J + 3, out + 3);
    for (int i = 3; i < BODY_Q; ++i)
        out[i] *= 2;
}

void world_place_base(World *world, const double r[3], const double e[4], const double v[3],
                      const double omega_body[3])
{
    Pose *pose = &world->pose[BODY_BASE];
    Twist *twist = &world->twist[BODY_BASE];
    double arm[3], rate[3];
    memcpy(pose->p, e, sizeof pose->p);
    pose_turn(pose);
    apply3(pose->A, world->model->body[BODY_BASE].com, arm);
    add3(r, arm, pose->r);
    apply3(pose->A, omega_body, twist->omega);
    cross3(twist->omega, arm, rate);
    add3(v, rate, twist->v);
}

/* ---- equations ---------------------------------------------------------------------------------------------------- */

static inline void find_vectors(const World *world, const Tie *tie, TieVectors *v)
{
    const Pose *a = &world->pose[tie->body[0]], *b = &world->pose[tie->body[1]];
    if (tie->parts & (PART_POINT | PART_LINE | PART_LENGTH | PART_ALONG)) {
        apply3(a->A, tie->arm[0], v->arm[0]);
        apply3(b->A, tie->arm[1], v->arm[1]);
        for (int i = 0; i < 3; ++i)
            v->d[i] = (b->r[i] - a->r[i]) + (v->arm[1][i] - v->arm[0][i]);
    }
    if (tie->parts & (PART_PARALLEL | PART_CROSS | PART_ALONG))
        apply3(a->A, tie->axis[0], v->axis[0]);
    if (tie->parts & (PART_PARALLEL | PART_CROSS))
        apply3(b->A, tie->axis[1], v->axis[1]);
    if (tie->parts & (PART_PARALLEL | PART_LOCK | PART_LINE | PART_TURN))
        for (int i = 0; i < 2; ++i)
            apply3(a->A, tie->side[i], v->side[i]);
    if (tie->parts & (PART_LOCK | PART_TURN))
        apply3(b->A, tie->other, v->other);
}

/* Length that the row of PART_LENGTH holds, and what PART_ALONG takes away. */
static inline double wanted_length(const World *world, const Tie *tie)
{
    return tie->coordinate >= 0 ? world->x[tie->coordinate] : tie->length;
}

static inline double wanted_offset(const World *world, const Tie *tie)
{
    return tie->coordinate >= 0 ? world->x[tie->coordinate] - tie->offset : tie->offset;
}

/* Of PART_TURN: the direction that f_1 is meant to have, and the one a quarter turn before it has, of which the product
 * with f_1 vanishes: -sin(w) e_1 + cos(w) e_2. */
static inline void turned(const World *world, const Tie *tie, const TieVectors *v, double along[3], double across[3])
{
    const double angle = world->x[tie->coordinate] - tie->offset, c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; ++i) {
        along[i] = c * v->side[0][i] + s * v->side[1][i];
        across[i] = c * v->side[1][i] - s * v->side[0][i];
    }
}

static inline void find_values(const World *world, const Tie *tie, const TieVectors *v, double *value)
{
    if (tie->parts & PART_POINT) {
        copy3(v->d, value);
        value += 3;
    }
    if (tie->parts & PART_PARALLEL) {
        *value++ = dot3(v->side[0], v->axis[1]);
        *value++ = dot3(v->side[1], v->axis[1]);
    }
    if (tie->parts & PART_LOCK)
        *value++ = dot3(v->side[0], v->other);
    if (tie->parts & PART_LINE) {
        *value++ = dot3(v->side[0], v->d);
        *value++ = dot3(v->side[1], v->d);
    }
    if (tie->parts & PART_LENGTH) {
        const double length = wanted_length(world, tie);
        *value++ = 0.5 * (dot3(v->d, v->d) - length * length);
    }
    if (tie->parts & PART_ALONG)
        *value++ = dot3(v->axis[0], v->d) - wanted_offset(world, tie);
    if (tie->parts & PART_CROSS)
        *value++ = dot3(v->axis[0], v->axis[1]);
    if (tie->parts & PART_TURN) {
        double along[3], across[3];
        turned(world, tie, v, along, across);
        *value++ = dot3(across, v->other);
    }
}

void world_values(World *world, int index)
{
    const Tie *tie = &world->tie[index];
    TieVectors *v = &world->vectors[index];
    find_vectors(world, tie, v);
    find_values(world, tie, v, world->value + tie->first);
}

static inline void negated(const double a[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = -a[i];
}

/* Derivative of a . b, a fixed in the first body, b in the second: omega_a x a . b + a . omega_b x b. */
static inline void row_angle(const double a[3], const double b[3], double J[ROW_J])
{
    for (int i = 0; i < 3; ++i)
        J[i] = J[6 + i] = 0;
    cross3(a, b, J + 3);
    negated(J + 3, J + 9);
}

/* Derivative of u . d, u fixed in the first body. */
static inline void row_along(const double u[3], const TieVectors *v, double J[ROW_J])
{
    double reach[3];
    negated(u, J);
    add3(v->arm[0], v->d, reach);
    cross3(u, reach, J + 3);
    copy3(u, J + 6);
    cross3(v->arm[1], u, J + 9);
}

static inline void row_length(const TieVectors *v, double J[ROW_J])
{
    negated(v->d, J);
    cross3(v->d, v->arm[0], J + 3);
    copy3(v->d, J + 6);
    cross3(v->arm[1], v->d, J + 9);
}

static inline void rows_point(const TieVectors *v, double (*J)[ROW_J])
{
    const double *a = v->arm[0], *b = v->arm[1];
    memset(J, 0, 3 * sizeof *J);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        J[i][i] = -1;
        J[i][3 + j] = -a[k];
        J[i][3 + k] = a[j];
        J[i][6 + i] = 1;
        J[i][9 + j] = b[k];
        J[i][9 + k] = -b[j];
    }
}

bool world_rows(World *world, int index)
{
    const Tie *tie = &world->tie[index];
    TieVectors *v = &world->vectors[index];
    double(*J)[ROW_J] = world->J + tie->first;
    bool right = true;
    find_vectors(world, tie, v);
    find_values(world, tie, v, world->value + tie->first);
    if (tie->parts & PART_POINT) {
        rows_point(v, J);
        J += 3;
    }
    if (tie->parts & PART_PARALLEL) {
        row_angle(v->side[0], v->axis[1], *J++);
        row_angle(v->side[1], v->axis[1], *J++);
        right = dot3(v->axis[0], v->axis[1]) > 0;
    }
    if (tie->parts & PART_LOCK) {
        row_angle(v->side[0], v->other, *J++);
        right = right && dot3(v->side[1], v->other) > 0;
    }
    if (tie->parts & PART_LINE) {
        row_along(v->side[0], v, *J++);
        row_along(v->side[1], v, *J++);
    }
    if (tie->parts & PART_LENGTH)
        row_length(v, *J++);
    if (tie->parts & PART_ALONG)
        row_along(v->axis[0], v, *J++);
    if (tie->parts & PART_CROSS)
        row_angle(v->axis[0], v->axis[1], *J++);
    double dual = tie->parts & PART_LENGTH ? -wanted_length(world, tie) : -1;
    if (tie->parts & PART_TURN) {
        double along[3], across[3];
        turned(world, tie, v, along, across);
        row_angle(across, v->other, *J++);
        dual = -dot3(along, v->other);
        right = dual < 0;
    }
    if (tie->coordinate >= 0)
        world->dual[tie->coordinate] = dual;
    return right;
}

/* Rate, and acceleration without that of the body, of a vector fixed in a body. */
typedef struct Swing {
    double rate[3], bias[3];
} Swing;

static inline Swing swing(const double omega[3], const double vector[3])
{
    Swing s;
    cross3(omega, vector, s.rate);
    cross3(omega, s.rate, s.bias);
    return s;
}

/* Of (a . b)'' at unaccelerated bodies. */
static inline double bias_of(const double a[3], const Swing *sa, const double b[3], const Swing *sb)
{
    return dot3(a, sb->bias) + dot3(sa->bias, b) + 2 * dot3(sa->rate, sb->rate);
}

void world_gamma(World *world, int index)
{
    const Tie *tie = &world->tie[index];
    const TieVectors *v = &world->vectors[index];
    const Twist *ta = &world->twist[tie->body[0]], *tb = &world->twist[tie->body[1]];
    double *gamma = world->gamma + tie->first;
    Swing d = {{0}, {0}}, axis = d, other, side[2];
    if (tie->parts & (PART_POINT | PART_LINE | PART_LENGTH | PART_ALONG)) {
        const Swing a = swing(ta->omega, v->arm[0]), b = swing(tb->omega, v->arm[1]);
        for (int i = 0; i < 3; ++i) {
            d.rate[i] = (tb->v[i] - ta->v[i]) + (b.rate[i] - a.rate[i]);
            d.bias[i] = b.bias[i] - a.bias[i];
        }
    }
    if (tie->parts & (PART_PARALLEL | PART_LOCK | PART_LINE))
        for (int i = 0; i < 2; ++i)
            side[i] = swing(ta->omega, v->side[i]);
    if (tie->parts & PART_POINT) {
        negated(d.bias, gamma);
        gamma += 3;
    }
    if (tie->parts & PART_PARALLEL) {
        other = swing(tb->omega, v->axis[1]);
        *gamma++ = -bias_of(v->side[0], &side[0], v->axis[1], &other);
        *gamma++ = -bias_of(v->side[1], &side[1], v->axis[1], &other);
    }
    if (tie->parts & PART_LOCK) {
        other = swing(tb->omega, v->other);
        *gamma++ = -bias_of(v->side[0], &side[0], v->other, &other);
    }
    if (tie->parts & PART_LINE) {
        *gamma++ = -bias_of(v->side[0], &side[0], v->d, &d);
        *gamma++ = -bias_of(v->side[1], &side[1], v->d, &d);
    }
    if (tie->parts & PART_LENGTH) {
        const double rate = tie->coordinate >= 0 ? world->xd[tie->coordinate] : 0;
        *gamma++ = rate * rate - dot3(v->d, d.bias) - dot3(d.rate, d.rate);
    }
    if (tie->parts & (PART_ALONG | PART_CROSS))
        axis = swing(ta->omega, v->axis[0]);
    if (tie->parts & PART_ALONG)
        *gamma++ = -bias_of(v->axis[0], &axis, v->d, &d);
    if (tie->parts & PART_CROSS) {
        other = swing(tb->omega, v->axis[1]);
        *gamma++ = -bias_of(v->axis[0], &axis, v->axis[1], &other);
    }
    if (tie->parts & PART_TURN) {
        double along[3], across[3];
        turned(world, tie, v, along, across);
        const Swing a = swing(ta->omega, along), c = swing(ta->omega, across);
        other = swing(tb->omega, v->other);
        const double rate = dot3(a.rate, v->other) + dot3(along, other.rate);
        *gamma++ = 2 * world->xd[tie->coordinate] * rate - bias_of(across, &c, v->other, &other);
    }
}

double world_product(const World *world, int index, int row, const double (*a)[6])
{
    const Tie *tie = &world->tie[index];
    const double *J = world->J[tie->first + row];
    double sum = 0;
    for (int end = 0; end < 2; ++end) {
        const double *x = a[tie->body[end]];
        sum += dot3(J + 6 * end, x) + dot3(J + 6 * end + 3, x + 3);
    }
    return sum;
}

void world_coordinate(World *world, int coordinate, double near, double out[2])
{
    const int index = world->model->joints + coordinate;
    const Tie *tie = &world->tie[index];
    TieVectors *v = &world->vectors[index];
    find_vectors(world, tie, v);
    if (tie->parts & PART_LENGTH)
        out[0] = sqrt(dot3(v->d, v->d));
    else if (tie->parts & PART_ALONG)
        out[0] = dot3(v->axis[0], v->d) + tie->offset;
    else {
        const double whole_turn = 6.283185307179586477;
        const double angle = atan2(dot3(v->side[1], v->other), dot3(v->side[0], v->other)) + tie->offset;
        out[0] = angle + whole_turn * nearbyint((near - angle) / whole_turn);
    }
    const double before = world->x[coordinate];
    world->x[coordinate] = out[0];
    world_rows(world, index);
    world->x[coordinate] = before;
    const double rate = world_product(world, index, 0, (const double(*)[6])world->twist);
    out[1] = -rate / world->dual[coordinate];
}

double world_residual(World *world)
{
    double worst = 0;
    for (int i = 0; i < world->ties; ++i) {
        const Tie *tie = &world->tie[i];
        world_values(world, i);
        /* squares of lengths are relative to the length, all other rows are lengths or angles */
        const double length = tie->parts & PART_LENGTH ? fmax(wanted_length(world, tie), world->size) : 1;
        for (int r = 0; r < tie->rows; ++r)
            worst = fmax(worst, fabs(world->value[tie->first + r]) / (length * fmin(world->size, 1)));
    }
    return worst;
}
