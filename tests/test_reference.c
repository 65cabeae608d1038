/* SPDX-License-Identifier: MIT
 * The reference against what is known without it: analytic accelerations of small mechanisms, and for a suspension
 * FORMAT.md's own joint equations, finite differences of solved positions, balance of momentum and of power. */
#include "reference/check.h"

#include <string.h>

/* Texts that dumps are put together from; the keys not given are null as in a real dump. */
#define HEAD(base) \
    "{\"gicgen_dump\": 1, \"model\": \"m\", \"gravity\": [0, 0, -9.81], \"base\": \"" base "\", \"bodies\": ["
#define BODY(name, mass, com, inertia, position, euler) \
    "{\"name\": \"" name "\", \"mass\": " mass ", \"com\": " com ", \"inertia\": " inertia ", \"position\": " position \
    ", \"euler\": " euler "}"
#define GROUND_BODY BODY("ground", "0", "[0,0,0]", "[0,0,0,0,0,0]", "[0,0,0]", "[1,0,0,0]")
#define JOINT(type, a, b, point_a, point_b, axis_a, axis_b, length, offset) \
    "{\"name\": \"j\", \"type\": \"" type "\", \"a\": " a ", \"b\": " b ", \"point_a\": " point_a \
    ", \"point_b\": " point_b ", \"axis_a\": " axis_a ", \"axis_b\": " axis_b \
    ", \"length\": " length ", \"offset\": " offset "}"
#define COORDINATE(name, type, a, b, point_a, point_b, axis, ref_a, ref_b, design, offset, driven) \
    "{\"name\": \"" name "\", \"type\": \"" type "\", \"a\": " a ", \"b\": " b ", \"point_a\": " point_a \
    ", \"point_b\": " point_b ", \"axis_a\": " axis ", \"reference_a\": " ref_a ", \"reference_b\": " ref_b \
    ", \"design\": " design ", \"offset\": " offset ", \"range\": [0, 1], \"driven\": " driven "}"
#define ALONG(coordinate, stiffness, damping, free) \
    "{\"name\": \"f\", \"type\": \"coordinate\", \"coordinate\": " coordinate ", \"a\": null, \"b\": null, " \
    "\"point_a\": null, \"point_b\": null, \"stiffness\": " stiffness ", \"damping\": " damping ", \"free\": " free "}"
#define BETWEEN(a, b, point_a, point_b, stiffness, damping, free) \
    "{\"name\": \"f\", \"type\": \"points\", \"coordinate\": -1, \"a\": " a ", \"b\": " b ", \"point_a\": " point_a \
    ", \"point_b\": " point_b ", \"stiffness\": " stiffness ", \"damping\": " damping ", \"free\": " free "}"
#define WHEEL(body, center, radius, stiffness, damping) \
    "{\"name\": \"t\", \"body\": " body ", \"center\": " center ", \"radius\": " radius ", \"stiffness\": " stiffness \
    ", \"damping\": " damping ", \"fade\": 0.01}"
#define JOINTS "], \"joints\": ["
#define COORDINATES "], \"coordinates\": ["
#define FORCES "], \"forces\": ["
#define WHEELS "], \"wheels\": ["
#define SEQUENCE "], \"inputs\": [], \"outputs\": [], \"sequence\": ["
#define TAIL "]}"

/* A body of mass 2 on a hinge at the origin about y, centre of mass (0.5, 0.1, -0.3) at design. */
#define BOB BODY("bob", "2", "[0,0,0]", "[0.3,0.4,0.35,0.01,0.02,-0.03]", "[0.5,0.1,-0.3]", "[1,0,0,0]")
#define HINGE JOINT("revolute", "0", "1", "[0,0,0]", "[-0.5,-0.1,0.3]", "[0,1,0]", "[0,1,0]", "null", "null")

typedef struct Swing {
    real x, z, inertia; /* of the centre of mass when the bob has turned by theta */
} Swing;

static Swing swing(real theta)
{
    Swing s = {.x = 0.5L * cosl(theta) + (real)-0.3 * sinl(theta),
               .z = -0.5L * sinl(theta) + (real)-0.3 * cosl(theta),
               .inertia = (real)0.4 + 2 * (0.25L + (real)0.3 * (real)0.3)};
    return s;
}

static void test_pendulum_on_length(void **unused)
{
    (void)unused;
    /* a spring along the length from (0.75, 0, 0.5) on ground to (0.25, 0.5, -0.75) on the bob */
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BOB JOINTS HINGE COORDINATES COORDINATE(
            "w", "length", "0", "1", "[0.75,0,0.5]", "[-0.25,0.4,-0.45]", "null", "null", "null",
            "1.4361406616345072", "null", "false") FORCES ALONG("0", "300", "20", "1.5") WHEELS SEQUENCE TAIL,
        "pendulum");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    for (int i = 0; i < 5; ++i) {
        real theta = -0.3L + 0.2L * i, rate = 1.5L - i;
        Swing s = swing(theta);
        real c = cosl(theta), n = sinl(theta), qx = 0.25L, qy = (real)0.1 + (real)0.4, qz = (real)-0.3 + (real)-0.45;
        real d[3] = {qx * c + qz * n - 0.75L, qy, -qx * n + qz * c - 0.5L};
        real turn_x = qz * c - qx * n, turn_z = -qx * c - qz * n; /* d(qx), d(qz) / d(theta) */
        real w = sqrtl(inner(d, d)), slope = (d[0] * turn_x + d[2] * turn_z) / w, w_rate = slope * rate;
        real spring = -300 * (w - 1.5L) - 20 * w_rate;
        real theta_second = (2 * (real)9.81 * s.x + spring * slope) / s.inertia;
        real d_second_x = theta_second * turn_x - rate * rate * (qx * c + qz * n);
        real d_second_z = theta_second * turn_z - rate * rate * (-qx * n + qz * c);
        real d_rate_squared = rate * rate * (turn_x * turn_x + turn_z * turn_z);
        real expected = (d_rate_squared + d[0] * d_second_x + d[2] * d_second_z - w_rate * w_rate) / w;
        state->w[0] = w;
        state->w_rate[0] = w_rate;
        solve(solver, state, &flat);
        near_to(solver->w_second[0], expected, 100);
        near_to(solver->configuration->q[1][0], s.x, 1);
        near_to(solver->configuration->q[1][2], s.z, 1);
    }
    /* longer than the linkage can become */
    state->w[0] = 3;
    assert_false(solve_positions(solver, state));
    state_free(state);
    solver_free(solver);
    model_free(model);
}

static void test_pendulum_on_angle(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BOB JOINTS HINGE COORDINATES COORDINATE(
            "phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]", "[1,0,0]", "0.25", "null",
            "false") FORCES ALONG("0", "3", "2", "1") WHEELS SEQUENCE TAIL, "pendulum");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    for (int i = 0; i < 5; ++i) {
        real theta = -14 + 7.3L * i, rate = 2 * i - 3; /* two turns either way */
        Swing s = swing(theta);
        state->w[0] = (quad)theta + 0.25L;
        state->w_rate[0] = rate;
        solve(solver, state, &flat);
        near_to(solver->w_second[0], (2 * (real)9.81 * s.x - 3 * (theta + 0.25L - 1) - 2 * rate) / s.inertia, 100);
        near_to(solver->configuration->q[1][0], s.x, 1);
        near_to(solver->configuration->q[1][2], s.z, 1);
    }
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* The bob hinged on a slide of mass 3 that is driven along x. */
static void test_driven_slide(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("slide", "3", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0]",
                                           "[1,0,0,0]") "," BOB JOINTS
            JOINT("prismatic", "0", "1", "[0,0,0]", "[0,0,0]", "[1,0,0]", "[1,0,0]", "null", "null") ","
            JOINT("revolute", "1", "2", "[0,0,0]", "[-0.5,-0.1,0.3]", "[0,1,0]", "[0,1,0]", "null", "null") COORDINATES
            COORDINATE("s", "translation", "0", "1", "[0,0,0]", "[0,0,0]", "[1,0,0]", "null", "null", "0", "0", "true")
            "," COORDINATE("phi", "angle", "1", "2", "null", "null", "[0,1,0]", "[0,0,1]", "[0,0,1]", "0", "null",
                           "false") FORCES ALONG("0", "40", "5", "0.125") WHEELS SEQUENCE TAIL, "slide");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    real theta = 0.7L, rate = -2.5L, push = 4, slide = 0.5L, slide_rate = 1.5L;
    Swing s = swing(theta);
    real expected = 2 * ((real)9.81 * s.x - push * s.z) / s.inertia;
    real drive = 5 * push + 2 * (expected * s.z - rate * rate * s.x) + 40 * (slide - 0.125L) + 5 * slide_rate;
    state->w[0] = slide;
    state->w_rate[0] = slide_rate;
    state->w_second[0] = push;
    state->w[1] = theta;
    state->w_rate[1] = rate;
    solve(solver, state, &flat);
    near_to(solver->w_second[1], expected, 100);
    near_to(solver->drive_force[0], drive, 100);
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* A parallelogram: crank and rocker of length 1, both upright at design, on pivots 2 apart. Where they lie flat it
 * could go on as a parallelogram or crossed, so that nothing beyond is reached. */
static void test_change_point(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("crank", "1", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0]", "[1,0,0,0]") "," BODY(
            "rocker", "1", "[0,0,0]", "[1,1,1,0,0,0]", "[2,0,0]", "[1,0,0,0]") JOINTS
            JOINT("revolute", "0", "1", "[0,0,0]", "[0,0,0]", "[0,1,0]", "[0,1,0]", "null", "null") ","
            JOINT("revolute", "0", "2", "[2,0,0]", "[0,0,0]", "[0,1,0]", "[0,1,0]", "null", "null") ","
            JOINT("distance", "1", "2", "[0,0,1]", "[0,0,1]", "null", "null", "2", "null") COORDINATES
            COORDINATE("phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]", "[1,0,0]", "0", "null", "false")
            FORCES WHEELS SEQUENCE TAIL,
        "parallelogram");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    state->w[0] = 1.25;
    assert_true(solve_positions(solver, state));
    near_to(solver->configuration->q[2][5], sinl(0.625L), 1);
    state->w[0] = 2;
    assert_false(solve_positions(solver, state));
    state->w[0] = -1.25;
    assert_true(solve_positions(solver, state));
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* A free body, frame away from the centre of mass and turned against the model's, alone or with a spring to the ground
 * and a wheel on a sine road, against the equations of Newton and Euler. */
static void free_body(const char *dump, const Road *road, const real spring_point[3], const real wheel_center[3])
{
    Model *model = model_parse(dump, "free body");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    static const real r[3] = {3, -2, 0.25L}, v[3] = {11, -7, 2}, omega[3] = {1.5L, -0.75L, 2},
                      com[3] = {0.25L, -0.125L, 0.5L};
    real J[3][3] = {{6, 0.5L, -0.25L}, {0.5L, 7, 0.75L}, {-0.25L, 0.75L, 8}};
    real e[4] = {0.3L, -0.5L, 0.4L, 0}, A[3][3];
    real force[3] = {0, 0, 0}, moment[3] = {0, 0, 0}; /* body frame, about com */
    e[3] = sqrtl(1 - e[0] * e[0] - e[1] * e[1] - e[2] * e[2]);
    for (int i = 0; i < 3; ++i) {
        state->r[i] = r[i];
        state->v[i] = v[i];
        state->omega[i] = omega[i];
        state->e[1 + i] = e[1 + i];
    }
    state->e[0] = e[0];
    rotation(e, A);
    const real *point[2] = {spring_point, wheel_center};
    for (int k = 0; k < 2 && spring_point; ++k) {
        real arm[3], x[3], x_rate[3], turned[3], F[3] = {0, 0, 0}, F_body[3], turn[3];
        apply(A, point[k], x);
        cross(omega, point[k], turned);
        apply(A, turned, x_rate);
        for (int i = 0; i < 3; ++i) {
            x[i] += r[i];
            x_rate[i] += v[i];
            arm[i] = point[k][i] - com[i];
        }
        if (k == 0) {
            static const Force spring = {-1, {GROUND, 0}, {{0}}, 70, 9, 2};
            real end[2][3] = {{1, 2, 3}, {x[0], x[1], x[2]}},
                 end_rate[2][3] = {{0}, {x_rate[0], x_rate[1], x_rate[2]}};
            spring_force(&spring, end, end_rate, F);
        } else {
            static const Wheel wheel = {0, {0}, 0.75, 500, 30, 0.01};
            tire_force(&wheel, road, x, x_rate, F);
        }
        apply_back(A, F, F_body);
        cross(arm, F_body, turn);
        for (int i = 0; i < 3; ++i) {
            force[i] += F_body[i];
            moment[i] += turn[i];
        }
    }
    solve(solver, state, road);
    /* J alpha + omega x J omega = moment, with the alpha that was found */
    real alpha[3], spin[3], gyro[3], push[3];
    for (int i = 0; i < 3; ++i)
        alpha[i] = (real)solver->alpha[i];
    apply(J, omega, spin);
    cross(omega, spin, gyro);
    apply(J, alpha, push);
    for (int i = 0; i < 3; ++i)
        near_to(push[i], moment[i] - gyro[i], 100);
    /* acceleration of the origin = g + F/m - alpha x com - omega x (omega x com) */
    real once[3], twice[3], by_alpha[3], rest[3], a[3];
    cross(omega, com, once);
    cross(omega, once, twice);
    cross(alpha, com, by_alpha);
    for (int i = 0; i < 3; ++i)
        rest[i] = force[i] / 4 - by_alpha[i] - twice[i];
    apply(A, rest, a);
    for (int i = 0; i < 3; ++i)
        near_to(solver->a[i], a[i] - (i == 2 ? (real)9.81 : 0), 100);
    state_free(state);
    solver_free(solver);
    model_free(model);
}

#define LUMP BODY("lump", "4", "[0.25,-0.125,0.5]", "[6,7,8,0.5,-0.25,0.75]", "[1,1,1]", "[0.5,0.5,-0.5,0.5]")

static void test_free_body(void **unused)
{
    (void)unused;
    free_body(HEAD("free") LUMP JOINTS COORDINATES FORCES WHEELS SEQUENCE TAIL, &flat, NULL, NULL);
}

static void test_forces_on_free_body(void **unused)
{
    (void)unused;
    static const Road sine = {.amplitude = 0.125, .wavelength = 2.5, .x0 = 0.5, .phase_per_y = 0.75};
    static const real spring_point[3] = {0.5L, 1, -0.25L}, center[3] = {0.75L, -0.5L, 0.25L};
    free_body(HEAD("free") LUMP JOINTS COORDINATES FORCES BETWEEN("-1", "0", "[1,2,3]", "[0.5,1,-0.25]", "70", "9",
                                                                   "2") WHEELS
                  WHEEL("0", "[0.75,-0.5,0.25]", "0.75", "500", "30") SEQUENCE TAIL,
              &sine, spring_point, center);
}

/* A mass on a vertical slide with a tire: the force law of FORMAT.md section 8 in each of its regions. */
static void test_quarter_car(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("car", "8", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0.5]", "[1,0,0,0]")
            JOINTS JOINT("prismatic", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "[0,0,1]", "null", "null")
            COORDINATES COORDINATE("z", "translation", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "null", "null", "0",
                       "0", "false") FORCES WHEELS WHEEL("1", "[0,0,0]", "0.5", "2000", "100") SEQUENCE TAIL,
        "quarter car");
    static const struct {
        double z, rate, force;
    } cases[] = {
        {0.25, 1, 0},                          /* in the air */
        {-0.25, 0, 500},                       /* standing */
        {-0.25, -2, 700},                      /* on the way down */
        {-0.125, 3, 0},                        /* damping would pull */
        {-0.0078125, 0, 15.625},               /* within the fade, at rest */
        {-0.0078125, -0.125, 15.625 + 12.5 * 0.87738037109375}, /* s = 0.78125: s^2 (3 - 2 s) */
    };
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        state->w[0] = cases[i].z;
        state->w_rate[0] = cases[i].rate;
        solve(solver, state, &flat);
        near_to(solver->w_second[0], (real)cases[i].force / 8 - (real)9.81, 100);
    }
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* Slide along z guided at a point half a metre above the centre of mass. With L = 0.5 the rows are three rotations, v_z
 * and two of the form (1, 1)/sqrt 2 in (L omega, v): singular values squared 1 and 1 +- 1/sqrt 2. */
static void test_condition(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("car", "8", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0.5]", "[1,0,0,0]")
            JOINTS JOINT("prismatic", "0", "1", "[0,0,1]", "[0,0,0.5]", "[0,0,1]", "[0,0,1]", "null", "null")
            COORDINATES COORDINATE("z", "translation", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "null", "null", "0",
                       "0", "false") FORCES WHEELS SEQUENCE
        "{\"stage\": 1, \"class\": 0, \"bodies\": [1], \"joints\": [0], \"coordinates\": [0]}" TAIL,
        "slide");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    solve(solver, state, &flat);
    assert_true(fabs(worst_condition(solver) - (1 + sqrt(2))) < 1e-12);
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* ---- a steered front corner with all joint types, a trailing rear one -------------------------------------------- */

enum { CHASSIS, RACK, ARM, KNUCKLE, TRAILING, BODIES };
enum { JOINTS_HERE = 6, COORDINATES_HERE = 3, FORCES_HERE = 5, WHEELS_HERE = 2 };

typedef struct Corners {
    Model model;
    Body body[BODIES];
    Joint joint[JOINTS_HERE];
    Coordinate coordinate[COORDINATES_HERE];
    Force force[FORCES_HERE];
    Wheel wheel[WHEELS_HERE];
} Corners;

/* A direction, or a point, of the model frame in the frame of a body at design. */
static void local(const Corners *corners, int body, bool point, const double x[3], double out[3])
{
    real p[4], A[3][3], d[3], back[3];
    for (int i = 0; i < 4; ++i)
        p[i] = corners->body[body].euler[i];
    for (int i = 0; i < 3; ++i)
        d[i] = (real)x[i] - (point ? corners->body[body].position[i] : 0);
    rotation(p, A);
    apply_back(A, d, back);
    for (int i = 0; i < 3; ++i)
        out[i] = (double)back[i];
}

static void add_joint(Corners *corners, JointType type, int a, int b, const double x_a[3], const double x_b[3],
                      const double axis[3])
{
    Joint *joint = &corners->joint[corners->model.joints++];
    joint->type = type;
    joint->body[0] = a;
    joint->body[1] = b;
    local(corners, a, true, x_a, joint->point[0]);
    local(corners, b, true, x_b, joint->point[1]);
    local(corners, a, false, axis, joint->axis[0]);
    local(corners, b, false, axis, joint->axis[1]);
    double d[3] = {x_b[0] - x_a[0], x_b[1] - x_a[1], x_b[2] - x_a[2]};
    joint->length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    joint->offset = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2];
}

static Corners *corners_new(void)
{
    static const Body body[BODIES] = {
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
                        swing_axis[3] = {0, 0.96, 0.28},
                        shock[3] = {1.7, 0.5, 0.8}, shock_foot[3] = {1.72, 0.55, 0.4}, none[3] = {0};
    Corners *corners = test_calloc(1, sizeof *corners);
    Model *model = &corners->model;
    memcpy(corners->body, body, sizeof body);
    *model = (Model){.gravity = {0.5, -0.25, -9.81}, .free_base = true, .bodies = BODIES,
                     .coordinates = COORDINATES_HERE, .forces = FORCES_HERE, .wheels = WHEELS_HERE,
                     .body = corners->body, .joint = corners->joint,
                     .coordinate = corners->coordinate, .force = corners->force, .wheel = corners->wheel, .length = 4};
    add_joint(corners, PRISMATIC, CHASSIS, RACK, rack, rack, rack_axis);
    add_joint(corners, REVOLUTE, CHASSIS, ARM, hinge, hinge, hinge_axis);
    add_joint(corners, SPHERICAL, ARM, KNUCKLE, ball, ball, none);
    add_joint(corners, REVOLUTE_SPHERICAL, CHASSIS, KNUCKLE, top_in, top, top_axis);
    add_joint(corners, DISTANCE, RACK, KNUCKLE, tie_in, tie, none);
    add_joint(corners, REVOLUTE, CHASSIS, TRAILING, rear, rear, rear_axis);
    Coordinate *c = corners->coordinate;
    c[0] = (Coordinate){.type = TRANSLATION, .body = {CHASSIS, RACK}, .design = 0.02, .driven = true};
    local(corners, CHASSIS, true, rack, c[0].point[0]);
    local(corners, RACK, true, rack, c[0].point[1]);
    local(corners, CHASSIS, false, rack_axis, c[0].axis);
    c[1] = (Coordinate){.type = LENGTH, .body = {CHASSIS, ARM}};
    local(corners, CHASSIS, true, shock, c[1].point[0]);
    local(corners, ARM, true, shock_foot, c[1].point[1]);
    c[1].design = sqrt(0.0004 + 0.0025 + 0.16); /* shock_foot - shock = (0.02, 0.05, -0.4) */
    c[2] = (Coordinate){.type = ANGLE, .body = {CHASSIS, TRAILING}, .design = 0.1};
    /* deliberately not the hinge's axis: the projections of section 5 change their length as it turns */
    local(corners, CHASSIS, false, swing_axis, c[2].axis);
    local(corners, CHASSIS, false, (const double[3]){1, 0, 0}, c[2].reference[0]);
    local(corners, TRAILING, false, (const double[3]){1, 0, 0}, c[2].reference[1]);
    static const Force force[FORCES_HERE] = {
        {.coordinate = 1, .stiffness = 90000, .damping = 6000, .free = 0.5},
        {.coordinate = 2, .stiffness = 4000, .damping = 300},
        {.coordinate = 0, .stiffness = 5000, .damping = 100},
        {-1, {CHASSIS, KNUCKLE}, {{1.5, 0.4, 0.3}, {0.1, 0.1, 0.1}}, 2000, 150, 0.4},
        {-1, {GROUND, CHASSIS}, {{1, 2, 3}, {0.5, 0, 0.25}}, 700, 90, 2},
    };
    static const Wheel wheel[WHEELS_HERE] = {
        {KNUCKLE, {0.02, 0.01, 0}, 0.47, 300000, 500, 0.01},
        {TRAILING, {-0.1, 0.1, 0}, 0.45, 250000, 500, 0.01},
    };
    memcpy(corners->force, force, sizeof force);
    memcpy(corners->wheel, wheel, sizeof wheel);
    return corners;
}

static const Road corner_road = {.amplitude = 0.05, .wavelength = 3, .x0 = 0.5, .phase_per_y = 0.75};

/* A state far from design in every respect, with both tires on the road. */
static void corner_state(State *state)
{
    static const double r[3] = {30, -20, 0.42}, e[4] = {0.25, -0.29, 0.04, 0.92}, v[3] = {11, -7, 2},
                        omega[3] = {1.5, -0.75, 2}, w[3] = {0.05, 0.38, -0.15}, w_rate[3] = {0.75, -0.5, 1};
    for (int i = 0; i < 3; ++i) {
        state->r[i] = r[i];
        state->v[i] = v[i];
        state->omega[i] = omega[i];
        state->e[i + 1] = e[i + 1];
        state->w[i] = w[i];
        state->w_rate[i] = w_rate[i];
    }
    state->e[0] = e[0];
    state->w_second[0] = 4;
}

/* Motion of one body in the terms of FORMAT.md section 1, from q, q' and q''. */
typedef struct Motion {
    real r[3], A[3][3];                 /* body frame */
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

/* The equations of FORMAT.md sections 4 and 5 hold at the solved pose, in the form in which they stand there. */
static void test_corner_constraints(void **unused)
{
    (void)unused;
    Corners *corners = corners_new();
    Solver *solver = solver_new(&corners->model);
    State *state = state_new(&corners->model);
    corner_state(state);
    solve(solver, state, &corner_road);
    for (int i = 0; i < JOINTS_HERE; ++i) {
        const Joint *joint = &corners->joint[i];
        real x_a[3], x_b[3], u_a[3], u_b[3], ignored[3], d[3], off[3];
        place(solver, joint->body[0], joint->point[0], x_a, ignored);
        place(solver, joint->body[1], joint->point[1], x_b, ignored);
        direction(solver, joint->body[0], joint->axis[0], u_a);
        direction(solver, joint->body[1], joint->axis[1], u_b);
        for (int k = 0; k < 3; ++k)
            d[k] = x_b[k] - x_a[k];
        if (joint->type == REVOLUTE || joint->type == SPHERICAL)
            near_zero(d);
        if (joint->type == REVOLUTE || joint->type == PRISMATIC) {
            cross(u_a, u_b, off);
            near_zero(off);
            assert_true(inner(u_a, u_b) > 0);
        }
        if (joint->type == PRISMATIC) {
            cross(d, u_a, off);
            near_zero(off);
            /* another direction that is the same in both at design */
            static const double x[3] = {1, 0, 0};
            double x_in[3];
            for (int k = 0; k < 2; ++k) {
                local(corners, joint->body[k], false, x, x_in);
                direction(solver, joint->body[k], x_in, k ? u_b : u_a);
            }
            cross(u_a, u_b, off);
            near_zero(off);
            assert_true(inner(u_a, u_b) > 0);
        }
        if (joint->type == DISTANCE || joint->type == REVOLUTE_SPHERICAL)
            near_to((quad)sqrtl(inner(d, d)), joint->length, 1);
        if (joint->type == REVOLUTE_SPHERICAL)
            near_to((quad)inner(u_a, d), joint->offset, 1);
    }
    const Coordinate *c = corners->coordinate;
    real x[2][3], d[3], rate[2][3], u[3], e_2[3], e_1[3], f_1[3];
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 2; ++k)
            place(solver, c[i].body[k], c[i].point[k], x[k], rate[k]);
        for (int k = 0; k < 3; ++k)
            d[k] = x[1][k] - x[0][k];
        if (i == 0)
            direction(solver, c[i].body[0], c[i].axis, u);
        near_to(state->w[i], i == 0 ? inner(u, d) + (real)c[0].design : sqrtl(inner(d, d)), 1);
    }
    direction(solver, c[2].body[0], c[2].axis, u);
    direction(solver, c[2].body[0], c[2].reference[0], e_1);
    direction(solver, c[2].body[1], c[2].reference[1], f_1);
    cross(u, e_1, e_2);
    near_to(state->w[2], atan2l(inner(e_2, f_1), inner(e_1, f_1)) + (real)c[2].design, 1);
    state_free(state);
    solver_free(solver);
    test_free(corners);
}

/* Rates and second derivatives of all bodies against central differences of solved positions, along a motion of base
 * and coordinates that has the solved accelerations. */
static void test_corner_differences(void **unused)
{
    (void)unused;
    Corners *corners = corners_new();
    Solver *solver = solver_new(&corners->model), *aside = solver_new(&corners->model);
    State *state = state_new(&corners->model), *moved = state_new(&corners->model);
    const quad h = 1e-8;
    corner_state(state);
    solve(solver, state, &corner_road);
    quad q[3][BODIES][BODY_COORDINATES];
    for (int side = -1; side <= 1; ++side) {
        quad t = side * h;
        for (int i = 0; i < 3; ++i) {
            moved->r[i] = state->r[i] + t * state->v[i] + t * t / 2 * solver->a[i];
            moved->w[i] = state->w[i] + t * state->w_rate[i] + t * t / 2 * solver->w_second[i];
        }
        /* odd terms beyond the second order cancel in both differences */
        for (int i = 0; i < 4; ++i)
            moved->e[i] = solver->configuration->q[0][3 + i] + t * solver->configuration->rate[0][3 + i]
                          + t * t / 2 * solver->second[0][3 + i];
        assert_true(recover_largest(moved->e));
        assert_true(solve_positions(aside, moved));
        memcpy(q[1 + side], aside->configuration->q, sizeof q[1 + side]);
    }
    for (int k = 0; k < BODIES; ++k)
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
    test_free(corners);
}

/* Momentum, moment of momentum about the world's origin and kinetic energy change as forces from outside and the power
 * of all forces demand. */
static void test_corner_balances(void **unused)
{
    (void)unused;
    Corners *corners = corners_new();
    Solver *solver = solver_new(&corners->model);
    State *state = state_new(&corners->model);
    corner_state(state);
    solve(solver, state, &corner_road);
    real force[3] = {0}, moment[3] = {0}, power = 0, force_scale = 0, power_scale = 0;
    for (int k = 0; k < BODIES; ++k) {
        Motion m = motion_of(solver, k);
        real mass = corners->body[k].mass, missing[3], about[3], spin[3];
        for (int i = 0; i < 3; ++i)
            missing[i] = mass * (m.com_second[i] - (real)corners->model.gravity[i]);
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
    for (int i = 0; i < WHEELS_HERE; ++i) {
        real x[3], x_rate[3], F[3], about[3];
        place(solver, corners->wheel[i].body, corners->wheel[i].center, x, x_rate);
        tire_force(&corners->wheel[i], &corner_road, x, x_rate, F);
        cross(x, F, about);
        for (int k = 0; k < 3; ++k) {
            force[k] -= F[k];
            moment[k] -= about[k];
        }
        power -= inner(F, x_rate);
    }
    for (int i = 0; i < FORCES_HERE; ++i) {
        const Force *element = &corners->force[i];
        int c = element->coordinate;
        if (c >= 0) {
            real w = (real)state->w[c], rate = (real)state->w_rate[c];
            power -= (-element->stiffness * (w - element->free) - element->damping * rate) * rate;
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
    test_free(corners);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum_on_length), cmocka_unit_test(test_pendulum_on_angle),
        cmocka_unit_test(test_driven_slide),       cmocka_unit_test(test_change_point),
        cmocka_unit_test(test_free_body),          cmocka_unit_test(test_forces_on_free_body),
        cmocka_unit_test(test_quarter_car),        cmocka_unit_test(test_condition),
        cmocka_unit_test(test_corner_constraints), cmocka_unit_test(test_corner_differences),
        cmocka_unit_test(test_corner_balances),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
