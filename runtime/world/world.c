/* SPDX-License-Identifier: MIT
 * Kinematics of a mechanism in the world frame: poses, and the equations of joints and dual coordinates (FORMAT.md
 * sections 4 and 5) with their derivatives, in loops over their parts. */
#include "base/message.h"
#include "base/vec3.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "world/equations.h"
#include "world/world.h"

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
    PART_TURN = 128,   /* angle of f_1 about u_a: 1 */
    PART_SCREW = 256,  /* the same, with the angle a share of u_a . (x_b - x_a) */
    PART_RACK = 512    /* or of the first side . (x_b - x_a) */
};

static const int parts_geared = PART_SCREW | PART_RACK,
                 parts_with_points = PART_POINT | PART_LINE | PART_LENGTH | PART_ALONG | PART_SCREW | PART_RACK;

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
    [JOINT_SCREW] = PART_SCREW,
    [JOINT_RACK_AND_PINION] = PART_RACK,
    [JOINT_GEAR] = PART_TURN,
    [JOINT_COUPLER] = PART_ALONG,
};

static const int parts_of_coordinate[COORDINATE_TYPES] = {
    [COORDINATE_LENGTH] = PART_LENGTH, [COORDINATE_TRANSLATION] = PART_ALONG, [COORDINATE_ANGLE] = PART_TURN};

/* ---- what is known before the first evaluation ----------------------------------------------------------- */

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
               .law = joint->value,
               .length = joint->length,
               .offset = joint->offset};
    if (tie.parts & parts_with_points)
        set_arms(model, &tie, joint->point);
    memcpy(tie.axis, joint->axis, sizeof tie.axis);
    copy3(joint->side[0], tie.side[0]);
    cross3(joint->axis[0], joint->side[0], tie.side[1]);
    cross3(joint->axis[1], joint->side[1], tie.other);
    if (tie.parts & (parts_geared | PART_TURN))
        copy3(joint->side[1], tie.other);
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
               .offset = coordinate->design - (translation ? coordinate->offset : 0)};
    if (tie.parts != PART_TURN)
        set_arms(model, &tie, coordinate->point);
    copy3(coordinate->axis, tie.axis[0]);
    copy3(coordinate->reference[0], tie.side[0]);
    cross3(coordinate->axis, coordinate->reference[0], tie.side[1]);
    copy3(coordinate->reference[1], tie.other);
    return tie;
}

/* Bodies where they stand in `body`. */
static void set_design(World *world, const Body *body)
{
    for (int b = 0; b < world->bodies; ++b) {
        double A[9], *q = world->q_design[b];
        mat_from_euler(body[b].euler, A);
        apply3(A, body[b].com, q);
        add3(q, body[b].position, q);
        memcpy(q + 3, body[b].euler, sizeof body[b].euler);
        world_set_q(world, b, q);
    }
}

static void set_size(World *world)
{
    const double least = 0.01;
    world->size = least;
    for (int t = 0; t < world->ties; ++t)
        for (int end = 0; end < 2; ++end)
            if (world->tie[t].body[end] >= world->first)
                world->size = fmax(world->size, norm3(world->tie[t].arm[end]));
    /* bodies on rails through their mass centres have no arms: then how far they go is the measure */
    for (int c = 0; c < world->model->coordinates && world->size <= least; ++c) {
        const Coordinate *w = &world->model->coordinate[c];
        if (w->type != COORDINATE_ANGLE)
            world->size = fmax(world->size, w->range[1] - w->range[0]);
    }
}

void world_adopt(World *world)
{
    for (int t = 0; t < world->ties; ++t) {
        Tie *tie = &world->tie[t];
        const int first = tie->first;
        *tie =
            tie->joint >= 0 ? tie_of_joint(world->model, tie->joint) : tie_of_coordinate(world->model, tie->coordinate);
        tie->first = first;
    }
    set_size(world);
    for (int b = world->first; b < world->bodies && world->equations; ++b)
        equations_mass(world->equations, b, world->model->body[b].mass, world->model->body[b].inertia);
    set_design(world, world->model->drawn);
}

static void add_tie(World *world, Tie tie)
{
    tie.first = world->rows;
    world->rows += tie.rows;
    if (tie.coordinate >= 0)
        world->coordinate_tie[tie.coordinate] = world->ties;
    world->tie[world->ties++] = tie;
}

/* Joints, driven coordinates, free ones. */
static void make_ties(Pool *pool, World *world)
{
    const Model *model = world->model;
    world->tie = pool_alloc(pool, (size_t)(model->joints + model->coordinates + 1) * sizeof *world->tie);
    for (int i = 0; i < model->joints; ++i)
        add_tie(world, tie_of_joint(model, i));
    for (int driven = 1; driven >= 0; --driven) {
        for (int i = 0; i < model->coordinates; ++i)
            if (model->coordinate[i].driven == driven)
                add_tie(world, tie_of_coordinate(model, i));
        if (driven) {
            world->constraints = world->ties;
            world->constraint_rows = world->rows;
        }
    }
    set_size(world);
}

World *world_unsolved(Pool *pool, const Model *model, const Sequence *sequence)
{
    World *world = pool_alloc(pool, sizeof *world);
    const size_t bodies = (size_t)model->bodies, coordinates = (size_t)model->coordinates + 1, number = sizeof(double);
    *world = (World){.model = model,
                     .sequence = sequence,
                     .bodies = model->bodies,
                     .first = model->free_base ? 0 : 1,
                     .coordinate_tie = pool_alloc(pool, coordinates * sizeof *world->coordinate_tie)};
    make_ties(pool, world);
    const size_t rows = (size_t)world->rows + 1;
    world->q_design = pool_alloc(pool, bodies * sizeof *world->q_design);
    world->q = pool_alloc(pool, bodies * sizeof *world->q);
    world->A = pool_alloc(pool, bodies * sizeof *world->A);
    world->qd = pool_alloc(pool, bodies * sizeof *world->qd);
    world->omega = pool_alloc(pool, bodies * sizeof *world->omega);
    world->x = pool_alloc(pool, coordinates * number);
    world->xd = pool_alloc(pool, coordinates * number);
    world->xdd = pool_alloc(pool, coordinates * number);
    world->value = pool_alloc(pool, rows * number);
    world->J = pool_alloc(pool, rows * ROW_J * number);
    world->dual = pool_alloc(pool, coordinates * number);
    world->tie_dual = pool_alloc(pool, ((size_t)world->ties + 1) * number);
    world->gamma = pool_alloc(pool, rows * number);
    world->vectors = pool_alloc(pool, ((size_t)world->ties + 1) * sizeof *world->vectors);
    world->wrench = pool_alloc(pool, bodies * sizeof *world->wrench);
    world->along = pool_alloc(pool, coordinates * number);
    world->element = pool_alloc(pool, ((size_t)model->forces + 1) * number);
    world->extent = pool_alloc(pool, ((size_t)model->forces + 1) * number);
    world->order = pool_alloc(pool, ((size_t)model->forces + 1) * sizeof *world->order);
    world_order(world);
    world->wheel = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *world->wheel);
    world->motion = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *world->motion);
    world->rolling = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *world->rolling);
    world->touches = model->wheels + 2 * model->forces;
    world->touch = pool_alloc(pool, ((size_t)world->touches + 1) * sizeof *world->touch);
    world->fast_rate = pool_alloc(pool, ((size_t)model->fast_states + 1) * number);
    world->qdd = pool_alloc(pool, bodies * sizeof *world->qdd);
    world->alpha = pool_alloc(pool, bodies * sizeof *world->alpha);
    world->multiplier = pool_alloc(pool, rows * number);
    set_design(world, model->body);
    return world;
}

World *world_new(Pool *pool, const Model *model, const Sequence *sequence)
{
    if (model_massless(model))
        diag_fail((Place){model->source, 0, 0}, "use --engine tape, tcc or cc",
                  "an engine with the coordinates of bodies needs the mass of '%s'", model_massless(model));
    World *world = world_unsolved(pool, model, sequence);
    world_set_solver(pool, world, &topology_solver);
    return world;
}

/* ---- bodies ---------------------------------------------------------------------------------------------- */

static inline void turn_body(const double p[4], double A[9])
{
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

void world_set_q(World *world, int body, const double q[BODY_Q])
{
    memcpy(world->q[body], q, sizeof world->q[body]);
    turn_body(q + 3, world->A[body]);
}

void world_set_rate(World *world, int body, const double qd[BODY_Q])
{
    memcpy(world->qd[body], qd, sizeof world->qd[body]);
    euler_turn(world->q[body] + 3, qd + 3, world->omega[body]);
    for (int i = 0; i < 3; ++i)
        world->omega[body][i] *= 2;
}

void world_move(World *world, int body, const double dq[BODY_Q])
{
    double *q = world->q[body], square = 0;
    for (int i = 0; i < BODY_Q; ++i)
        q[i] += dq[i];
    for (int i = 3; i < BODY_Q; ++i)
        square += q[i] * q[i];
    const double scale = 1 / sqrt(square);
    for (int i = 3; i < BODY_Q; ++i)
        q[i] *= scale;
    turn_body(q + 3, world->A[body]);
}

void world_set_base(World *world, const double r[3], const double e[4], const double v[3], const double omega_body[3])
{
    double q[BODY_Q], qd[BODY_Q], A[9], arm[3], omega[3];
    memcpy(q + 3, e, 4 * sizeof *e);
    turn_body(e, A);
    apply3(A, world->model->body[BODY_BASE].com, arm);
    add3(r, arm, q);
    world_set_q(world, BODY_BASE, q);
    apply3(A, omega_body, omega);
    cross3(omega, arm, qd);
    add3(v, qd, qd);
    euler_rate(e, omega, qd + 3);
    for (int i = 3; i < BODY_Q; ++i)
        qd[i] *= 0.5;
    world_set_rate(world, BODY_BASE, qd);
}

/* ---- equations ------------------------------------------------------------------------------------------- */

static inline void find_vectors(const World *world, const Tie *tie, TieVectors *v)
{
    const double *a = world->q[tie->body[0]], *b = world->q[tie->body[1]];
    const double *Aa = world->A[tie->body[0]], *Ab = world->A[tie->body[1]];
    if (tie->parts & parts_with_points) {
        apply3(Aa, tie->arm[0], v->arm[0]);
        apply3(Ab, tie->arm[1], v->arm[1]);
        for (int i = 0; i < 3; ++i)
            v->d[i] = (b[i] - a[i]) + (v->arm[1][i] - v->arm[0][i]);
    }
    if (tie->parts & (PART_PARALLEL | PART_CROSS | PART_ALONG | PART_SCREW))
        apply3(Aa, tie->axis[0], v->axis[0]);
    if (tie->parts & (PART_PARALLEL | PART_CROSS))
        apply3(Ab, tie->axis[1], v->axis[1]);
    if (tie->parts & (PART_PARALLEL | PART_LOCK | PART_LINE | PART_TURN | parts_geared))
        for (int i = 0; i < 2; ++i)
            apply3(Aa, tie->side[i], v->side[i]);
    if (tie->parts & (PART_LOCK | PART_TURN | parts_geared))
        apply3(Ab, tie->other, v->other);
}

/* Length that the row of PART_LENGTH holds, and what PART_ALONG takes away. */
static inline double wanted_length(const World *world, const Tie *tie)
{
    return tie->coordinate >= 0 ? world->x[tie->coordinate] : tie->length;
}

static inline double wanted_offset(const World *world, const Tie *tie)
{
    if (tie->law)
        return world_jet(world, tie->law, NULL).value - tie->offset;
    return tie->coordinate >= 0 ? world->x[tie->coordinate] - tie->offset : tie->offset;
}

/* Direction of the way that goes with a turn. */
static inline const double *way_of(const Tie *tie, const TieVectors *v)
{
    return tie->parts & PART_SCREW ? v->axis[0] : v->side[0];
}

/* Of PART_TURN: the direction that f_1 is meant to have, and the one a quarter turn before it has, of which the product
 * with f_1 vanishes: -sin(w) e_1 + cos(w) e_2. */
static inline void turned(const World *world, const Tie *tie, const TieVectors *v, double along[3], double across[3])
{
    const double angle =
        tie->parts & parts_geared ? dot3(way_of(tie, v), v->d) / tie->offset : wanted_offset(world, tie);
    const double c = cos(angle), s = sin(angle);
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
    if (tie->parts & (PART_TURN | parts_geared)) {
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

/* Rows are found as derivatives by the twists (r', omega) of both bodies. */
enum { TWISTS = 12 };

static inline void negated(const double a[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = -a[i];
}

/* Derivative of a . b, a fixed in the first body, b in the second: omega_a x a . b + a . omega_b x b. */
static inline void row_angle(const double a[3], const double b[3], double J[TWISTS])
{
    for (int i = 0; i < 3; ++i)
        J[i] = J[6 + i] = 0;
    cross3(a, b, J + 3);
    negated(J + 3, J + 9);
}

/* Derivative of u . d, u fixed in the first body. */
static inline void row_along(const double u[3], const TieVectors *v, double J[TWISTS])
{
    double reach[3];
    negated(u, J);
    add3(v->arm[0], v->d, reach);
    cross3(u, reach, J + 3);
    copy3(u, J + 6);
    cross3(v->arm[1], u, J + 9);
}

static inline void row_length(const TieVectors *v, double J[TWISTS])
{
    negated(v->d, J);
    cross3(v->d, v->arm[0], J + 3);
    copy3(v->d, J + 6);
    cross3(v->arm[1], v->d, J + 9);
}

static inline void rows_point(const TieVectors *v, double (*J)[TWISTS])
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

/* To derivatives by q': omega = 2 E p'. */
static inline void by_q(World *world, const Tie *tie, const double (*twist)[TWISTS])
{
    double *J = world->J + ROW_J * tie->first;
    for (int end = 0; end < 2; ++end) {
        const double *p = world->q[tie->body[end]] + 3;
        for (int r = 0; r < tie->rows; ++r, J += BODY_Q) {
            copy3(twist[r] + 6 * end, J);
            euler_rate(p, twist[r] + 6 * end + 3, J + 3);
            for (int i = 3; i < BODY_Q; ++i)
                J[i] *= 2;
        }
    }
}

bool world_rows(World *world, int index)
{
    const Tie *tie = &world->tie[index];
    TieVectors *v = &world->vectors[index];
    double twist[TIE_ROWS][TWISTS], (*J)[TWISTS] = twist;
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
    if (tie->parts & (PART_TURN | parts_geared)) {
        double along[3], across[3];
        turned(world, tie, v, along, across);
        row_angle(across, v->other, *J++);
        dual = -dot3(along, v->other);
        right = dual < 0;
    }
    if (tie->parts & parts_geared) {
        double way[TWISTS];
        row_along(way_of(tie, v), v, way);
        for (int i = 0; i < TWISTS; ++i)
            J[-1][i] += dual / tie->offset * way[i];
    }
    by_q(world, tie, (const double(*)[TWISTS])twist);
    if (tie->coordinate >= 0)
        world->dual[tie->coordinate] = dual;
    world->tie_dual[index] = dual;
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
    const double *va = world->qd[tie->body[0]], *vb = world->qd[tie->body[1]];
    const double *wa = world->omega[tie->body[0]], *wb = world->omega[tie->body[1]];
    double *gamma = world->gamma + tie->first;
    const Jet f = tie->law ? world_jet(world, tie->law, world->xd) : (Jet){0, 0, 0};
    Swing d = {{0}, {0}}, axis = d, other, side[2];
    if (tie->parts & parts_with_points) {
        const Swing a = swing(wa, v->arm[0]), b = swing(wb, v->arm[1]);
        for (int i = 0; i < 3; ++i) {
            d.rate[i] = (vb[i] - va[i]) + (b.rate[i] - a.rate[i]);
            d.bias[i] = b.bias[i] - a.bias[i];
        }
    }
    if (tie->parts & (PART_PARALLEL | PART_LOCK | PART_LINE))
        for (int i = 0; i < 2; ++i)
            side[i] = swing(wa, v->side[i]);
    if (tie->parts & PART_POINT) {
        negated(d.bias, gamma);
        gamma += 3;
    }
    if (tie->parts & PART_PARALLEL) {
        other = swing(wb, v->axis[1]);
        *gamma++ = -bias_of(v->side[0], &side[0], v->axis[1], &other);
        *gamma++ = -bias_of(v->side[1], &side[1], v->axis[1], &other);
    }
    if (tie->parts & PART_LOCK) {
        other = swing(wb, v->other);
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
        axis = swing(wa, v->axis[0]);
    if (tie->parts & PART_ALONG)
        *gamma++ = f.second - bias_of(v->axis[0], &axis, v->d, &d);
    if (tie->parts & PART_CROSS) {
        other = swing(wb, v->axis[1]);
        *gamma++ = -bias_of(v->axis[0], &axis, v->axis[1], &other);
    }
    if (tie->parts & (PART_TURN | parts_geared)) {
        double along[3], across[3];
        turned(world, tie, v, along, across);
        const Swing a = swing(wa, along), c = swing(wa, across);
        other = swing(wb, v->other);
        const double rate = dot3(a.rate, v->other) + dot3(along, other.rate);
        double turn_rate = tie->coordinate >= 0 ? world->xd[tie->coordinate] : f.rate;
        if (tie->parts & parts_geared) {
            const double *way = way_of(tie, v), share = dot3(along, v->other) / tie->offset;
            axis = swing(wa, way);
            turn_rate = (dot3(axis.rate, v->d) + dot3(way, d.rate)) / tie->offset;
            *gamma = share * bias_of(way, &axis, v->d, &d);
        } else {
            *gamma = dot3(along, v->other) * f.second;
        }
        *gamma++ += 2 * turn_rate * rate - bias_of(across, &c, v->other, &other);
    }
}

double world_dual(const World *world, int index, const double *w)
{
    const Tie *tie = &world->tie[index];
    if (tie->law)
        return world->tie_dual[index] * world_jet(world, tie->law, w).rate;
    return tie->coordinate >= 0 ? world->dual[tie->coordinate] * w[tie->coordinate] : 0;
}

double world_product(const World *world, int index, int row, const double (*x)[BODY_Q])
{
    const Tie *tie = &world->tie[index];
    const double *J = world->J + ROW_J * tie->first + BODY_Q * row;
    double sum = 0;
    for (int end = 0; end < 2; ++end, J += BODY_Q * tie->rows)
        for (int i = 0; i < BODY_Q; ++i)
            sum += J[i] * x[tie->body[end]][i];
    return sum;
}

void world_coordinate(World *world, int coordinate, double near, double out[2])
{
    const int index = world->coordinate_tie[coordinate];
    const Tie *tie = &world->tie[index];
    TieVectors *v = &world->vectors[index];
    find_vectors(world, tie, v);
    if (tie->parts & PART_LENGTH)
        out[0] = norm3(v->d);
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
    const double rate = world_product(world, index, 0, (const double(*)[BODY_Q])world->qd);
    out[1] = -rate / world->dual[coordinate];
}

double world_tie_residual(World *world, int index)
{
    const Tie *tie = &world->tie[index];
    double worst = 0;
    world_values(world, index);
    /* squares of lengths are relative to the length, all other rows are lengths or angles */
    const double length = tie->parts & PART_LENGTH ? fmax(wanted_length(world, tie), world->size) : 1;
    for (int r = 0; r < tie->rows; ++r)
        worst = fmax(worst, fabs(world->value[tie->first + r]) / (length * fmin(world->size, 1)));
    return worst;
}

double world_residual(World *world)
{
    double worst = 0;
    for (int i = 0; i < world->ties; ++i)
        worst = fmax(worst, world_tie_residual(world, i));
    return worst;
}
