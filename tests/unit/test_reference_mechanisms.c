/* SPDX-License-Identifier: MIT
 * The reference on two mechanisms that have every type of joint between them: FORMAT.md's own joint equations, finite
 * differences of solved positions, balance of momentum and of power. */
#include "reference/check.h"

#include <string.h>

enum { BODIES = 6, JOINTS_MOST = 11, COORDINATES_MOST = 5, FORCES_MOST = 5, WHEELS_MOST = 2 };

typedef struct Mechanism {
    Model model;
    Body body[BODIES];
    Joint joint[JOINTS_MOST];
    Coordinate coordinate[COORDINATES_MOST];
    Force force[FORCES_MOST];
    Wheel wheel[WHEELS_MOST];
} Mechanism;

/* A direction, or a point, of the model frame in the frame of a body at design. */
static void local(const Mechanism *mechanism, int body, bool point, const double x[3], double out[3])
{
    real p[4], A[3][3], d[3], back[3];
    for (int i = 0; i < 4; ++i)
        p[i] = mechanism->body[body].euler[i];
    for (int i = 0; i < 3; ++i)
        d[i] = (real)x[i] - (point ? mechanism->body[body].position[i] : 0);
    rotation(p, A);
    apply_back(A, d, back);
    for (int i = 0; i < 3; ++i)
        out[i] = (double)back[i];
}

static void add_joint(Mechanism *mechanism, JointType type, int a, int b, const double x_a[3], const double x_b[3],
                      const double u_a[3], const double u_b[3])
{
    Joint *joint = &mechanism->joint[mechanism->model.joints++];
    joint->type = type;
    joint->body[0] = a;
    joint->body[1] = b;
    local(mechanism, a, true, x_a, joint->point[0]);
    local(mechanism, b, true, x_b, joint->point[1]);
    local(mechanism, a, false, u_a, joint->axis[0]);
    local(mechanism, b, false, u_b, joint->axis[1]);
    double d[3] = {x_b[0] - x_a[0], x_b[1] - x_a[1], x_b[2] - x_a[2]};
    joint->length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    joint->offset = u_a[0] * d[0] + u_a[1] * d[1] + u_a[2] * d[2];
}

/* A steered front corner and a trailing rear one. */
static Mechanism *corners(void)
{
    enum { CHASSIS, RACK, ARM, KNUCKLE, TRAILING, PARTS };
    static const Body body[PARTS] = {
        {"chassis", 1500, {0.05, 0.01, 0.2}, {500, 1500, 1800, 10, -20, 5}, {0.1, 0, 0.5}, {0.96, 0, 0.28, 0}},
        {"rack", 9, {0.01, 0, 0}, {1, 0.5, 1, 0, 0.1, 0}, {1.4, 0, 0.6}, {0.8, 0, 0.6, 0}},
        {"arm", 16, {0, -0.2, 0}, {0.5, 0.25, 0.7, 0.01, 0, 0}, {1.7, 0.8, 0.4}, {0, 0.6, 0.8, 0}},
        {"knuckle", 110, {0.01, 0.02, -0.01}, {7, 8, 9, 0.1, 0.2, 0.3}, {1.65, 0.9, 0.5}, {0.6, 0, 0, 0.8}},
        {"trailing", 30, {0, 0, 0}, {1, 2, 2, 0, 0.1, 0}, {-1.5, 0.7, 0.45}, {0.5, 0.5, -0.5, 0.5}},
    };
    static const double rack[3] = {1.4, 0, 0.6}, rack_axis[3] = {0, 1, 0}, hinge[3] = {1.7, 0.3, 0.45},
                        hinge_axis[3] = {0.96, 0, 0.28}, ball[3] = {1.68, 0.8, 0.38}, top_in[3] = {1.6, 0.45, 0.72},
                        top[3] = {1.62, 0.74, 0.74}, top_axis[3] = {0.96, 0, -0.28}, tie_in[3] = {1.4, 0.45, 0.6},
                        tie[3] = {1.5, 0.82, 0.55}, rear[3] = {-1, 0.6, 0.5}, rear_axis[3] = {0, 0.8, 0.6},
                        swing_axis[3] = {0, 0.96, 0.28}, shock[3] = {1.7, 0.5, 0.8}, shock_foot[3] = {1.72, 0.55, 0.4},
                        none[3] = {0};
    Mechanism *mechanism = test_calloc(1, sizeof *mechanism);
    Model *model = &mechanism->model;
    memcpy(mechanism->body, body, sizeof body);
    *model = (Model){.gravity = {0.5, -0.25, -9.81},
                     .free_base = true,
                     .bodies = PARTS,
                     .coordinates = 3,
                     .forces = 5,
                     .wheels = 2,
                     .body = mechanism->body,
                     .joint = mechanism->joint,
                     .coordinate = mechanism->coordinate,
                     .force = mechanism->force,
                     .wheel = mechanism->wheel,
                     .length = 4};
    add_joint(mechanism, PRISMATIC, CHASSIS, RACK, rack, rack, rack_axis, rack_axis);
    add_joint(mechanism, REVOLUTE, CHASSIS, ARM, hinge, hinge, hinge_axis, hinge_axis);
    add_joint(mechanism, SPHERICAL, ARM, KNUCKLE, ball, ball, none, none);
    add_joint(mechanism, REVOLUTE_SPHERICAL, CHASSIS, KNUCKLE, top_in, top, top_axis, top_axis);
    add_joint(mechanism, DISTANCE, RACK, KNUCKLE, tie_in, tie, none, none);
    add_joint(mechanism, REVOLUTE, CHASSIS, TRAILING, rear, rear, rear_axis, rear_axis);
    Coordinate *c = mechanism->coordinate;
    c[0] = (Coordinate){.type = TRANSLATION, .body = {CHASSIS, RACK}, .design = 0.02, .driven = true};
    local(mechanism, CHASSIS, true, rack, c[0].point[0]);
    local(mechanism, RACK, true, rack, c[0].point[1]);
    local(mechanism, CHASSIS, false, rack_axis, c[0].axis);
    c[1] = (Coordinate){.type = LENGTH, .body = {CHASSIS, ARM}};
    local(mechanism, CHASSIS, true, shock, c[1].point[0]);
    local(mechanism, ARM, true, shock_foot, c[1].point[1]);
    c[1].design = sqrt(0.0004 + 0.0025 + 0.16); /* shock_foot - shock = (0.02, 0.05, -0.4) */
    c[2] = (Coordinate){.type = ANGLE, .body = {CHASSIS, TRAILING}, .design = 0.1};
    /* deliberately not the hinge's axis: the projections of section 5 change their length as it turns */
    local(mechanism, CHASSIS, false, swing_axis, c[2].axis);
    local(mechanism, CHASSIS, false, (const double[3]){1, 0, 0}, c[2].reference[0]);
    local(mechanism, TRAILING, false, (const double[3]){1, 0, 0}, c[2].reference[1]);
    static const Force force[] = {
        {.coordinate = 1, .stiffness = 90000, .damping = 6000, .free = 0.5},
        {.coordinate = 2, .stiffness = 4000, .damping = 300},
        {.coordinate = 0, .stiffness = 5000, .damping = 100},
        {.coordinate = -1,
         .body = {CHASSIS, KNUCKLE},
         .point = {{1.5, 0.4, 0.3}, {0.1, 0.1, 0.1}},
         .stiffness = 2000,
         .damping = 150,
         .free = 0.4},
        {.coordinate = -1,
         .body = {GROUND, CHASSIS},
         .point = {{1, 2, 3}, {0.5, 0, 0.25}},
         .stiffness = 700,
         .damping = 90,
         .free = 2},
    };
    static const Wheel wheel[] = {
        {.body = KNUCKLE, .center = {0.02, 0.01, 0}, .radius = 0.47, .stiffness = 300000, .damping = 500, .fade = 0.01},
        {.body = TRAILING, .center = {-0.1, 0.1, 0}, .radius = 0.45, .stiffness = 250000, .damping = 500, .fade = 0.01},
    };
    memcpy(mechanism->force, force, sizeof force);
    memcpy(mechanism->wheel, wheel, sizeof wheel);
    return mechanism;
}

static void add_length(Mechanism *mechanism, int a, int b, const double x_a[3], const double x_b[3])
{
    Coordinate *coordinate = &mechanism->coordinate[mechanism->model.coordinates++];
    *coordinate = (Coordinate){.type = LENGTH, .body = {a, b}};
    local(mechanism, a, true, x_a, coordinate->point[0]);
    local(mechanism, b, true, x_b, coordinate->point[1]);
    double d[3] = {x_b[0] - x_a[0], x_b[1] - x_a[1], x_b[2] - x_a[2]};
    coordinate->design = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* The joints that the corners don't have, one after the other and back to the hull. */
static Mechanism *train(void)
{
    static Formula steady = {.number = 25};
    enum { HULL, DRUM, SHAFT, CAP, SLIDER, LEVER, PARTS };
    static const Body body[PARTS] = {
        {"hull", 900, {0.05, 0.01, 0.2}, {300, 800, 900, 10, -20, 5}, {0.1, 0, 0.5}, {0.96, 0, 0.28, 0}},
        {"drum", 20, {0.1, 0.2, 0}, {1, 0.75, 1, 0, 0.1, 0}, {1, 0.1, 0.6}, {0.8, 0, 0.6, 0}},
        {"shaft", 16, {0, -0.2, 0}, {0.5, 0.25, 0.7, 0.01, 0, 0}, {1.5, 0.5, 0.8}, {0, 0.6, 0.8, 0}},
        {"cap", 11, {0.01, 0.02, -0.01}, {0.7, 0.8, 0.9, 0.1, 0.2, 0.3}, {1.9, 1, 0.9}, {0.6, 0, 0, 0.8}},
        {"slider", 30, {0, 0, 0.1}, {1, 2, 2, 0, 0.1, 0}, {2.3, 1.2, 0.8}, {0.5, 0.5, -0.5, 0.5}},
        {"lever", 12, {0.1, 0, 0}, {1, 2, 2, 0, 0.1, 0}, {3, 1.3, 0.9}, {0.28, 0.96, 0, 0}},
    };
    static const double none[3] = {0}, drum[3] = {1, 0, 0.5}, drum_axis[3] = {0.6, 0, 0.8},
                        cross_at[3] = {1.2, 0.3, 0.7}, fork_in[3] = {0, 1, 0}, fork_out[3] = {0.8, 0, -0.6},
                        stay_in[3] = {2, 0.5, 0.2}, stay[3] = {1.8, 0.9, 0.8}, weld[3] = {1.8, 0.9, 0.9},
                        line[3] = {2.2, 1.1, 0.9}, line_axis[3] = {0, 0.6, 0.8}, plane[3] = {2, 1.4, 0.6},
                        plane_axis[3] = {0.28, 0.96, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1},
                        ball[3] = {2.6, 1.3, 0.9}, rod_in[3] = {3.1, 1.2, 1.4}, rod[3] = {3.1, 1.2, 0.6};
    Mechanism *mechanism = test_calloc(1, sizeof *mechanism);
    Model *model = &mechanism->model;
    memcpy(mechanism->body, body, sizeof body);
    *model = (Model){.gravity = {0.5, -0.25, -9.81},
                     .free_base = true,
                     .bodies = PARTS,
                     .forces = 4,
                     .wheels = 2,
                     .body = mechanism->body,
                     .joint = mechanism->joint,
                     .coordinate = mechanism->coordinate,
                     .force = mechanism->force,
                     .wheel = mechanism->wheel,
                     .length = 4};
    add_joint(mechanism, CYLINDRICAL, HULL, DRUM, drum, drum, drum_axis, drum_axis);
    add_joint(mechanism, UNIVERSAL, DRUM, SHAFT, cross_at, cross_at, fork_in, fork_out);
    add_joint(mechanism, DISTANCE, HULL, SHAFT, stay_in, stay, none, none);
    add_joint(mechanism, FIXED, SHAFT, CAP, weld, weld, none, none);
    add_joint(mechanism, POINT_ON_LINE, CAP, SLIDER, line, line, line_axis, none);
    add_joint(mechanism, POINT_IN_PLANE, HULL, SLIDER, plane, plane, plane_axis, none);
    add_joint(mechanism, PARALLEL, HULL, SLIDER, none, none, x, x);
    add_joint(mechanism, SPHERICAL, SLIDER, LEVER, ball, ball, none, none);
    add_joint(mechanism, PERPENDICULAR, HULL, LEVER, none, none, z, y);
    add_joint(mechanism, DISTANCE, HULL, LEVER, rod_in, rod, none, none);
    Coordinate *c = mechanism->coordinate;
    c[0] = (Coordinate){.type = TRANSLATION, .body = {HULL, DRUM}, .design = 0.02, .driven = true};
    local(mechanism, HULL, true, drum, c[0].point[0]);
    local(mechanism, DRUM, true, drum, c[0].point[1]);
    local(mechanism, HULL, false, drum_axis, c[0].axis);
    c[1] = (Coordinate){.type = ANGLE, .body = {HULL, DRUM}, .design = 0.1};
    local(mechanism, HULL, false, drum_axis, c[1].axis);
    local(mechanism, HULL, false, y, c[1].reference[0]);
    local(mechanism, DRUM, false, y, c[1].reference[1]);
    model->coordinates = 2;
    add_length(mechanism, HULL, SHAFT, (const double[3]){1, 1.5, 0.4}, (const double[3]){1.5, 0.9, 1});
    add_length(mechanism, HULL, SLIDER, (const double[3]){2.3, 2.4, 0.7}, (const double[3]){2.3, 1.6, 1.3});
    add_length(mechanism, DRUM, LEVER, (const double[3]){1.4, 0.2, 1.2}, (const double[3]){3, 1, 1.1});
    static const Force force[] = {
        {.coordinate = 1, .stiffness = 400, .damping = 30, .law = {&steady}},
        {.coordinate = 2, .stiffness = 9000, .damping = 600, .free = 0.5},
        {.coordinate = -1,
         .body = {HULL, LEVER},
         .point = {{1.5, 0.4, 0.3}, {0.1, 0.1, 0.1}},
         .stiffness = 2000,
         .damping = 150,
         .free = 0.4},
        {.coordinate = -1,
         .body = {GROUND, SLIDER},
         .point = {{1, 2, 3}, {0.5, 0, 0.25}},
         .stiffness = 700,
         .damping = 90,
         .free = 2},
    };
    static const Wheel wheel[] = {
        {.body = SLIDER, .center = {0.02, 0.01, 0}, .radius = 2, .stiffness = 3000, .damping = 50, .fade = 0.01},
        {.body = HULL, .center = {-0.1, 0.1, 0}, .radius = 1.5, .stiffness = 2500, .damping = 50, .fade = 0.01},
    };
    memcpy(mechanism->force, force, sizeof force);
    memcpy(mechanism->wheel, wheel, sizeof wheel);
    return mechanism;
}

static const Road rough = {.amplitude = 0.05, .wavelength = 3, .x0 = 0.5, .phase_per_y = 0.75};

/* A state far from design in every respect, with all tires on the road. */
static void far_state(const Mechanism *mechanism, State *state)
{
    static const double r[3] = {30, -20, 0.42}, e[4] = {0.25, -0.29, 0.04, 0.92}, v[3] = {11, -7, 2},
                        omega[3] = {1.5, -0.75, 2}, move[] = {0.02, -0.03, -0.025, 0.02, 0.015},
                        w_rate[] = {0.75, -0.5, 1, 0.5, -0.25};
    for (int i = 0; i < 3; ++i) {
        state->r[i] = r[i];
        state->v[i] = v[i];
        state->omega[i] = omega[i];
        state->e[i + 1] = e[i + 1];
    }
    state->e[0] = e[0];
    for (int c = 0; c < mechanism->model.coordinates; ++c) {
        state->w[c] = mechanism->coordinate[c].design + move[c] * (mechanism->coordinate[c].type == ANGLE ? 4 : 1);
        state->w_rate[c] = w_rate[c];
    }
    state->w_second[0] = 4; /* the driven one */
}

/* Motion of one body in the terms of FORMAT.md section 1, from q, q' and q''. */
typedef struct Motion {
    real r[3], A[3][3]; /* body frame */
    real com[3], com_rate[3], com_second[3];
    real omega[3], alpha[3], spin_second[3]; /* body frame; J alpha + omega x J omega */
} Motion;

/* 2 (p conjugate times q), vector part: with q = p' the angular velocity in the body frame, with p'' its rate */
static void twice_quotient(const real p[4], const real q[4], real out[3])
{
    cross(q + 1, p + 1, out);
    for (int i = 0; i < 3; ++i)
        out[i] = 2 * (out[i] + p[0] * q[1 + i] - q[0] * p[1 + i]);
}

static Motion motion_of(const Solver *solver, int body)
{
    Motion m;
    const Body *data = &solver->model->body[body];
    const double *I = data->inertia;
    real J[3][3] = {{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}};
    real p[3][4], origin[3], s[3], arm[3], spin[3], push[3];
    quad(*const q[3])[BODY_COORDINATES] = {solver->configuration->q, solver->configuration->rate, solver->second};
    real *const com[3] = {m.com, m.com_rate, m.com_second};
    for (int order = 0; order < 3; ++order) {
        for (int i = 0; i < 3; ++i)
            com[order][i] = (real)q[order][body][i];
        for (int i = 0; i < 4; ++i)
            p[order][i] = (real)q[order][body][3 + i];
    }
    rotation(p[0], m.A);
    twice_quotient(p[0], p[1], m.omega);
    twice_quotient(p[0], p[2], m.alpha);
    for (int i = 0; i < 3; ++i)
        s[i] = data->com[i];
    apply(m.A, s, arm);
    for (int i = 0; i < 3; ++i)
        origin[i] = m.com[i] - arm[i];
    memcpy(m.r, origin, sizeof origin);
    apply(J, m.omega, spin);
    cross(m.omega, spin, m.spin_second);
    apply(J, m.alpha, push);
    for (int i = 0; i < 3; ++i)
        m.spin_second[i] += push[i];
    return m;
}

/* Place, and velocity where x_rate is given, of a point in the frame of a body. */
static void place(const Solver *solver, int body, const double point[3], real x[3], real x_rate[3])
{
    if (body == GROUND) {
        for (int i = 0; i < 3; ++i) {
            x[i] = point[i];
            x_rate[i] = 0;
        }
        return;
    }
    Motion m = motion_of(solver, body);
    real s[3], turned[3], arm[3];
    for (int i = 0; i < 3; ++i)
        s[i] = point[i];
    apply(m.A, s, arm);
    for (int i = 0; i < 3; ++i) {
        x[i] = m.r[i] + arm[i];
        s[i] -= solver->model->body[body].com[i];
    }
    cross(m.omega, s, turned);
    apply(m.A, turned, x_rate);
    for (int i = 0; i < 3; ++i)
        x_rate[i] += m.com_rate[i];
}

static void direction(const Solver *solver, int body, const double axis[3], real out[3])
{
    Motion m = motion_of(solver, body);
    const real u[3] = {axis[0], axis[1], axis[2]};
    apply(m.A, u, out);
}

static void near_zero(const real x[3])
{
    for (int i = 0; i < 3; ++i)
        near_to(0, x[i], 1);
}

/* A direction of the model frame that was the same in both bodies at design. */
static void carried(const Solver *solver, const Mechanism *mechanism, const Joint *joint, const double u[3],
                    real u_a[3], real u_b[3])
{
    double inside[3];
    for (int k = 0; k < 2; ++k) {
        local(mechanism, joint->body[k], false, u, inside);
        direction(solver, joint->body[k], inside, k ? u_b : u_a);
    }
}

static void same_direction(const real a[3], const real b[3])
{
    real off[3];
    cross(a, b, off);
    near_zero(off);
    assert_true(inner(a, b) > 0);
}

/* The equations of FORMAT.md section 4, in the form in which they stand there. */
static void joint_holds(const Solver *solver, const Mechanism *mechanism, const Joint *joint)
{
    static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    real x_a[3], x_b[3], u_a[3], u_b[3], ignored[3], d[3], off[3], v_a[3], v_b[3];
    JointType type = joint->type;
    place(solver, joint->body[0], joint->point[0], x_a, ignored);
    place(solver, joint->body[1], joint->point[1], x_b, ignored);
    direction(solver, joint->body[0], joint->axis[0], u_a);
    direction(solver, joint->body[1], joint->axis[1], u_b);
    for (int k = 0; k < 3; ++k)
        d[k] = x_b[k] - x_a[k];
    if (type == REVOLUTE || type == SPHERICAL || type == UNIVERSAL || type == FIXED)
        near_zero(d);
    if (type == REVOLUTE || type == PRISMATIC || type == CYLINDRICAL || type == PARALLEL)
        same_direction(u_a, u_b);
    if (type == PRISMATIC || type == CYLINDRICAL || type == POINT_ON_LINE) {
        cross(d, u_a, off);
        near_zero(off);
    }
    if (type == PRISMATIC || type == FIXED) {
        carried(solver, mechanism, joint, x, v_a, v_b);
        same_direction(v_a, v_b);
        carried(solver, mechanism, joint, y, v_a, v_b);
        same_direction(v_a, v_b);
    }
    if (type == DISTANCE || type == REVOLUTE_SPHERICAL)
        near_to((quad)sqrtl(inner(d, d)), joint->length, 1);
    if (type == REVOLUTE_SPHERICAL || type == POINT_IN_PLANE)
        near_to((quad)inner(u_a, d), joint->offset, 1);
    if (type == UNIVERSAL || type == PERPENDICULAR)
        near_to((quad)inner(u_a, u_b), 0, 1);
}

/* The definition of section 5 gives the value of the state. */
static void coordinate_holds(const Solver *solver, const Coordinate *coordinate, quad value)
{
    real x[2][3], d[3], ignored[3], u[3], e_1[3], e_2[3], f_1[3];
    direction(solver, coordinate->body[0], coordinate->axis, u);
    for (int k = 0; k < 2; ++k)
        place(solver, coordinate->body[k], coordinate->point[k], x[k], ignored);
    for (int k = 0; k < 3; ++k)
        d[k] = x[1][k] - x[0][k];
    switch (coordinate->type) {
    case LENGTH: near_to(value, sqrtl(inner(d, d)), 1); break;
    case TRANSLATION: /* offset 0 in both mechanisms */
        near_to(value, inner(u, d) + (real)coordinate->design, 1);
        break;
    case ANGLE:
        direction(solver, coordinate->body[0], coordinate->reference[0], e_1);
        direction(solver, coordinate->body[1], coordinate->reference[1], f_1);
        cross(u, e_1, e_2);
        near_to(value, atan2l(inner(e_2, f_1), inner(e_1, f_1)) + (real)coordinate->design, 1);
        break;
    case COORDINATE_TYPES: break;
    }
}

typedef struct Case {
    Mechanism *(*make)(void);
} Case;

static void test_constraints(void **state_of_test)
{
    Mechanism *mechanism = ((const Case *)*state_of_test)->make();
    Solver *solver = solver_new(&mechanism->model);
    State *state = state_new(&mechanism->model);
    far_state(mechanism, state);
    solve(solver, state, &rough);
    for (int i = 0; i < mechanism->model.joints; ++i)
        joint_holds(solver, mechanism, &mechanism->joint[i]);
    for (int i = 0; i < mechanism->model.coordinates; ++i)
        coordinate_holds(solver, &mechanism->coordinate[i], state->w[i]);
    state_free(state);
    solver_free(solver);
    test_free(mechanism);
}

/* Rates and second derivatives of all bodies against central differences of solved positions, along a motion of base
 * and coordinates that has the solved accelerations. */
static void test_differences(void **state_of_test)
{
    Mechanism *mechanism = ((const Case *)*state_of_test)->make();
    Solver *solver = solver_new(&mechanism->model), *aside = solver_new(&mechanism->model);
    State *state = state_new(&mechanism->model), *moved = state_new(&mechanism->model);
    const quad h = 1e-8;
    far_state(mechanism, state);
    solve(solver, state, &rough);
    quad q[3][BODIES][BODY_COORDINATES];
    for (int side = -1; side <= 1; ++side) {
        quad t = side * h;
        for (int i = 0; i < 3; ++i) {
            moved->r[i] = state->r[i] + t * state->v[i] + t * t / 2 * solver->a[i];
        }
        for (int c = 0; c < mechanism->model.coordinates; ++c)
            moved->w[c] = state->w[c] + t * state->w_rate[c] + t * t / 2 * solver->w_second[c];
        /* odd terms beyond the second order cancel in both differences */
        for (int i = 0; i < 4; ++i)
            moved->e[i] = solver->configuration->q[0][3 + i] + t * solver->configuration->rate[0][3 + i] +
                          t * t / 2 * solver->second[0][3 + i];
        assert_true(recover_largest(moved->e));
        assert_true(solve_positions(aside, moved));
        memcpy(q[1 + side], aside->configuration->q, (size_t)mechanism->model.bodies * sizeof *q[1 + side]);
    }
    for (int k = 0; k < mechanism->model.bodies; ++k)
        for (int i = 0; i < BODY_COORDINATES; ++i) {
            real rate = (real)((q[2][k][i] - q[0][k][i]) / (2 * h));
            real second = (real)((q[2][k][i] - 2 * q[1][k][i] + q[0][k][i]) / (h * h));
            near_to((quad)(1e-3L * (rate - (real)solver->configuration->rate[k][i])), 0, 1);
            near_to((quad)(1e-6L * (second - (real)solver->second[k][i])), 0, 1);
        }
    state_free(state);
    state_free(moved);
    solver_free(solver);
    solver_free(aside);
    test_free(mechanism);
}

/* Momentum, moment of momentum about the world's origin and kinetic energy change as forces from outside and the power
 * of all forces demand. */
static void test_balances(void **state_of_test)
{
    Mechanism *mechanism = ((const Case *)*state_of_test)->make();
    Solver *solver = solver_new(&mechanism->model);
    State *state = state_new(&mechanism->model);
    far_state(mechanism, state);
    solve(solver, state, &rough);
    real force[3] = {0}, moment[3] = {0}, power = 0, force_scale = 0, power_scale = 0;
    for (int k = 0; k < mechanism->model.bodies; ++k) {
        Motion m = motion_of(solver, k);
        real mass = mechanism->body[k].mass, missing[3], about[3], spin[3];
        for (int i = 0; i < 3; ++i)
            missing[i] = mass * (m.com_second[i] - (real)mechanism->model.gravity[i]);
        cross(m.com, missing, about);
        apply(m.A, m.spin_second, spin);
        for (int i = 0; i < 3; ++i) {
            force[i] += missing[i];
            moment[i] += about[i] + spin[i];
        }
        power += inner(missing, m.com_rate) + inner(m.omega, m.spin_second);
        force_scale += mass * 10;
        power_scale += fabsl(inner(missing, m.com_rate)) + fabsl(inner(m.omega, m.spin_second));
    }
    for (int i = 0; i < mechanism->model.wheels; ++i) {
        real x[3], x_rate[3], F[3], about[3];
        place(solver, mechanism->wheel[i].body, mechanism->wheel[i].center, x, x_rate);
        tire_force(&mechanism->wheel[i], &rough, x, x_rate, F);
        cross(x, F, about);
        for (int k = 0; k < 3; ++k) {
            force[k] -= F[k];
            moment[k] -= about[k];
        }
        power -= inner(F, x_rate);
    }
    for (int i = 0; i < mechanism->model.forces; ++i) {
        const Force *element = &mechanism->force[i];
        int c = element->coordinate;
        if (c >= 0) {
            real w = (real)state->w[c], rate = (real)state->w_rate[c];
            power -= ((element->law[0] ? element->law[0]->number : 0) - element->stiffness * (w - element->free) -
                      element->damping * rate) *
                     rate;
            continue;
        }
        real x[2][3], x_rate[2][3], pull[3], about[3];
        for (int k = 0; k < 2; ++k)
            place(solver, element->body[k], element->point[k], x[k], x_rate[k]);
        spring_force(element, x, x_rate, pull); /* on the second end */
        cross(x[1], pull, about);
        for (int k = 0; k < 3; ++k) {
            power -= pull[k] * (x_rate[1][k] - x_rate[0][k]);
            force[k] -= element->body[0] == GROUND ? pull[k] : 0;
            moment[k] -= element->body[0] == GROUND ? about[k] : 0;
        }
    }
    power -= (real)(solver->drive_force[0] * state->w_rate[0]);
    for (int i = 0; i < 3; ++i) {
        near_to((quad)force[i], 0, force_scale);
        near_to((quad)moment[i], 0, 36 * force_scale); /* 36 m from the origin */
    }
    near_to((quad)power, 0, power_scale);
    state_free(state);
    solver_free(solver);
    test_free(mechanism);
}

int main(void)
{
    Case front = {corners}, row = {train};
    const struct CMUnitTest tests[] = {
        {"corners: constraints", test_constraints, NULL, NULL, &front},
        {"corners: differences", test_differences, NULL, NULL, &front},
        {"corners: balances", test_balances, NULL, NULL, &front},
        {"train: constraints", test_constraints, NULL, NULL, &row},
        {"train: differences", test_differences, NULL, NULL, &row},
        {"train: balances", test_balances, NULL, NULL, &row},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
