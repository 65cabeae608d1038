/* SPDX-License-Identifier: MIT
 * The reference against what is known without it: analytic motion and accelerations of small mechanisms. */
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
    ", \"point_b\": " point_b ", \"axis_a\": " axis_a ", \"axis_b\": " axis_b ", \"length\": " length \
    ", \"offset\": " offset "}"
#define COORDINATE(name, type, a, b, point_a, point_b, axis, ref_a, ref_b, design, offset, driven) \
    "{\"name\": \"" name "\", \"type\": \"" type "\", \"a\": " a ", \"b\": " b ", \"point_a\": " point_a \
    ", \"point_b\": " point_b ", \"axis_a\": " axis ", \"reference_a\": " ref_a ", \"reference_b\": " ref_b \
    ", \"design\": " design ", \"offset\": " offset ", \"range\": [0, 1], \"driven\": " driven "}"
/* what neither an axis nor a stop nor a table is there for */
#define PLAIN \
    "\"axis_a\": null, \"reference_a\": null, \"reference_b\": null, \"low\": null, \"high\": null, " \
    "\"fade\": null, \"table\": null, \"law\": []}"
#define ALONG(coordinate, stiffness, damping, free) \
    "{\"name\": \"f\", \"type\": \"coordinate\", \"coordinate\": " coordinate ", \"a\": null, \"b\": null, " \
    "\"point_a\": null, \"point_b\": null, \"stiffness\": " stiffness ", \"damping\": " damping ", \"free\": " free \
    ", " PLAIN
#define BETWEEN(a, b, point_a, point_b, stiffness, damping, free) \
    "{\"name\": \"f\", \"type\": \"points\", \"coordinate\": -1, \"a\": " a ", \"b\": " b ", \"point_a\": " point_a \
    ", \"point_b\": " point_b ", \"stiffness\": " stiffness ", \"damping\": " damping ", \"free\": " free ", " PLAIN
#define WHEEL(body, center, radius, stiffness, damping) \
    "{\"name\": \"t\", \"body\": " body ", \"center\": " center ", \"radius\": " radius ", \"stiffness\": " stiffness \
    ", \"damping\": " damping ", \"fade\": 0.01, \"tire\": null}"
#define JOINTS "], \"joints\": ["
#define COORDINATES "], \"coordinates\": ["
#define FORCES "], \"forces\": ["
#define WHEELS "], \"wheels\": ["
#define SEQUENCE "], \"tires\": [], \"inputs\": [], \"tables\": [], \"outputs\": [], \"sequence\": ["
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
    Model *model = model_parse(HEAD("fixed") GROUND_BODY "," BOB JOINTS HINGE COORDINATES COORDINATE(
                                   "w", "length", "0", "1", "[0.75,0,0.5]", "[-0.25,0.4,-0.45]", "null", "null", "null",
                                   "1.4361406616345072", "null", "false") FORCES ALONG("0", "300", "20", "1.5")
                                   WHEELS SEQUENCE TAIL,
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
    Model *model = model_parse(HEAD("fixed") GROUND_BODY "," BOB JOINTS HINGE COORDINATES COORDINATE(
                                   "phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]", "[1,0,0]", "0.25",
                                   "null", "false") FORCES ALONG("0", "3", "2", "1") WHEELS SEQUENCE TAIL,
                               "pendulum");
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
        HEAD("fixed") GROUND_BODY
        "," BODY("slide", "3", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0]", "[1,0,0,0]") "," BOB JOINTS JOINT(
            "prismatic", "0", "1", "[0,0,0]", "[0,0,0]", "[1,0,0]", "[1,0,0]", "null",
            "null") "," JOINT("revolute", "1", "2", "[0,0,0]", "[-0.5,-0.1,0.3]", "[0,1,0]", "[0,1,0]", "null", "null")
            COORDINATES COORDINATE("s", "translation", "0", "1", "[0,0,0]", "[0,0,0]", "[1,0,0]", "null", "null", "0",
                                   "0", "true") "," COORDINATE("phi", "angle", "1", "2", "null", "null", "[0,1,0]",
                                                               "[0,0,1]", "[0,0,1]", "0", "null", "false")
                FORCES ALONG("0", "40", "5", "0.125") WHEELS SEQUENCE TAIL,
        "slide");
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
            "rocker", "1", "[0,0,0]", "[1,1,1,0,0,0]", "[2,0,0]", "[1,0,0,0]")
            JOINTS JOINT("revolute", "0", "1", "[0,0,0]", "[0,0,0]", "[0,1,0]", "[0,1,0]", "null", "null") "," JOINT(
                "revolute", "0", "2", "[2,0,0]", "[0,0,0]", "[0,1,0]", "[0,1,0]", "null",
                "null") "," JOINT("distance", "1", "2", "[0,0,1]", "[0,0,1]", "null", "null", "2", "null")
                COORDINATES COORDINATE("phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]", "[1,0,0]", "0",
                                       "null", "false") FORCES WHEELS SEQUENCE TAIL,
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
    /* the other one, crossed, where only its own poses lead: half of what the angles differ by has the tangent below */
    const real a = 1.25L, b = a + 2 * atanl(2 * cosl(a) / (2 * sinl(a) - 1));
    quad pose[3][BODY_COORDINATES] = {{0}, {0, 0, 0, cosl(a / 2), 0, sinl(a / 2), 0}, {2, 0, 0, 0, 0, 0, 0}};
    const struct {
        real turned, off;
    } start[] = {{a, 0}, {a, 1e-3L}, {b, 0}, {b, -1e-3L}};
    state->w[0] = (quad)a;
    for (int i = 0; i < 4; ++i) {
        pose[2][3] = cosl((start[i].turned + start[i].off) / 2);
        pose[2][5] = sinl((start[i].turned + start[i].off) / 2);
        assert_true(solve_near(solver, state, pose));
        near_to(solver->configuration->q[2][3], cosl(start[i].turned / 2), 1);
        near_to(solver->configuration->q[2][5], sinl(start[i].turned / 2), 1);
    }
    pose[2][5] += 0.1;
    assert_false(solve_near(solver, state, pose));
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
            static const Force spring = {
                .coordinate = -1, .body = {GROUND, 0}, .point = {{0}}, .stiffness = 70, .damping = 9, .free = 2};
            real end[2][3] = {{1, 2, 3}, {x[0], x[1], x[2]}}, end_rate[2][3] = {{0}, {x_rate[0], x_rate[1], x_rate[2]}};
            spring_force(&spring, end, end_rate, F);
        } else {
            static const Wheel wheel = {.radius = 0.75, .stiffness = 500, .damping = 30, .fade = 0.01};
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
    free_body(HEAD("free") LUMP JOINTS COORDINATES FORCES BETWEEN("-1", "0", "[1,2,3]", "[0.5,1,-0.25]", "70", "9", "2")
                  WHEELS WHEEL("0", "[0.75,-0.5,0.25]", "0.75", "500", "30") SEQUENCE TAIL,
              &sine, spring_point, center);
}

/* A mass on a vertical slide with a tire: the force law of FORMAT.md section 8 in each of its regions. */
static void test_quarter_car(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("car", "8", "[0,0,0]", "[1,1,1,0,0,0]", "[0,0,0.5]", "[1,0,0,0]")
            JOINTS JOINT("prismatic", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "[0,0,1]", "null", "null")
                COORDINATES COORDINATE("z", "translation", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "null", "null",
                                       "0", "0", "false") FORCES WHEELS WHEEL("1", "[0,0,0]", "0.5", "2000", "100")
                    SEQUENCE TAIL,
        "quarter car");
    static const struct {
        double z, rate, force;
    } cases[] = {
        {0.25, 1, 0},                                           /* in the air */
        {-0.25, 0, 500},                                        /* standing */
        {-0.25, -2, 700},                                       /* on the way down */
        {-0.125, 3, 0},                                         /* damping would pull */
        {-0.0078125, 0, 15.625},                                /* within the fade, at rest */
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
                COORDINATES COORDINATE("z", "translation", "0", "1", "[0,0,0.5]", "[0,0,0]", "[0,0,1]", "null", "null",
                                       "0", "0", "false") FORCES WHEELS SEQUENCE
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

/* Two angles but for full turns. */
static void same_angle(real a, real b)
{
    near_to((quad)sinl((a - b) / 2), 0, 1);
}

/* The bob on a cylindrical joint, free to slide along the hinge: turning and sliding don't know of each other. */
static void test_cylindrical(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BOB JOINTS JOINT("cylindrical", "0", "1", "[0,0,0]", "[-0.5,-0.1,0.3]", "[0,1,0]",
                                                       "[0,1,0]", "null", "null")
            COORDINATES COORDINATE("phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]", "[1,0,0]", "0",
                                   "null", "false") "," COORDINATE("s", "translation", "0", "1", "[0,0,0]",
                                                                   "[-0.5,-0.1,0.3]", "[0,1,0]", "null", "null", "0",
                                                                   "0", "false") FORCES ALONG("1", "40", "5", "0.125")
                WHEELS SEQUENCE TAIL,
        "sleeve");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    /* the products of inertia turn with the bob, but the sleeve takes what they do */
    real theta = 0.7L, slide = 0.5L, slide_rate = 1.5L;
    Swing s = swing(theta);
    state->w[0] = theta;
    state->w_rate[0] = -2.5L;
    state->w[1] = slide;
    state->w_rate[1] = slide_rate;
    solve(solver, state, &flat);
    near_to(solver->w_second[0], 2 * (real)9.81 * s.x / s.inertia, 100);
    near_to(solver->w_second[1], (-40 * (slide - 0.125L) - 5 * slide_rate) / 2, 100);
    near_to(solver->configuration->q[1][1], slide + (real)0.1, 1);
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* The bob with a weight of mass 1 fixed to it: one pendulum of both. */
static void test_fixed(void **unused)
{
    (void)unused;
    Model *model =
        model_parse(HEAD("fixed") GROUND_BODY "," BOB "," BODY("weight", "1", "[0,0,0]", "[0.1,0.2,0.15,0,0.02,0]",
                                                               "[1,0,-0.5]", "[0.8,0,0.6,0]") JOINTS HINGE
                    "," JOINT("fixed", "1", "2", "[0.25,0,0]", "[-0.262,0.1,-0.184]", "null", "null", "null", "null")
                        COORDINATES COORDINATE("phi", "angle", "0", "1", "null", "null", "[0,1,0]", "[1,0,0]",
                                               "[1,0,0]", "0", "null", "false") FORCES WHEELS SEQUENCE TAIL,
                    "two weights");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    for (int i = 0; i < 3; ++i) {
        real theta = 2 * i - 1.5L, x = cosl(theta) - 0.5L * sinl(theta);
        Swing s = swing(theta);
        state->w[0] = theta;
        state->w_rate[0] = 1.5L;
        solve(solver, state, &flat);
        near_to(solver->w_second[0], (real)9.81 * (2 * s.x + x) / (s.inertia + (real)0.2 + 1.25L), 100);
        near_to(solver->configuration->q[2][0], x, 1);
    }
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* A universal joint: input shaft along x, output shaft inclined by atan(3/4) towards y, the two axes of its cross
 * perpendicular. Any number of turns. */
static void test_universal_shafts(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("in", "1", "[0,0,0]", "[2,3,3,0,0,0]", "[0,0,0]", "[1,0,0,0]") "," BODY(
            "out", "1", "[0,0,0]", "[4,4,4,0,0,0]", "[1,0,0]", "[1,0,0,0]")
            JOINTS JOINT("revolute", "0", "1", "[0,0,0]", "[0,0,0]", "[1,0,0]", "[1,0,0]", "null", "null") "," JOINT(
                "revolute", "0", "2", "[1,0,0]", "[0,0,0]", "[0.8,0.6,0]", "[0.8,0.6,0]", "null",
                "null") "," JOINT("perpendicular", "1", "2", "null", "null", "[0,0,1]", "[-0.6,0.8,0]", "null", "null")
                COORDINATES COORDINATE("theta", "angle", "0", "1", "null", "null", "[1,0,0]", "[0,1,0]", "[0,1,0]", "0",
                                       "null", "false") FORCES ALONG("0", "3", "2", "1") WHEELS SEQUENCE TAIL,
        "shafts");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    const real u[3] = {0.8L, 0.6L, 0}, incline = 0.8L;
    for (int i = 0; i < 5; ++i) {
        real theta = 3.7L * i - 7, rate = 1.5L - i, c = cosl(theta), n = sinl(theta);
        /* the axes (0, -sin, cos)(theta) and cos(phi) (-0.6, 0.8, 0) + sin(phi) (0, 0, 1): tan phi = 0.8 tan theta */
        real phi = atan2l(incline * n, c), bottom = c * c + incline * incline * n * n;
        real ratio = incline / bottom, ratio_slope = incline * 2 * n * c * (1 - incline * incline) / (bottom * bottom);
        state->w[0] = theta;
        state->w_rate[0] = rate;
        solve(solver, state, &flat);
        real half = (real)solver->configuration->q[2][3], axial = 0;
        for (int k = 0; k < 3; ++k)
            axial += u[k] * (real)solver->configuration->q[2][4 + k];
        same_angle(2 * atan2l(axial, half), phi);
        /* (2 + 4 ratio^2) theta'' + 4 ratio ratio' theta'^2 = torque */
        real torque = -3 * (theta - 1) - 2 * rate;
        near_to(solver->w_second[0], (torque - 4 * ratio * ratio_slope * rate * rate) / (2 + 4 * ratio * ratio), 100);
    }
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* A bob on a universal joint, placed by two lengths. */
static void test_universal(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY "," BODY("bob", "3", "[0,0,0]", "[0.5,0.5,0.25,0,0,0]", "[0,0,-2]", "[1,0,0,0]")
            JOINTS JOINT("universal", "0", "1", "[0,0,0]", "[0,0,2]", "[1,0,0]", "[0,1,0]", "null", "null")
                COORDINATES COORDINATE("swing", "length", "0", "1", "[0,-2,0]", "[0,0,0]", "null", "null", "null",
                                       "2.8284271247461901", "null",
                                       "false") "," COORDINATE("nod", "length", "0", "1", "[2,0,0]", "[0,0,0]", "null",
                                                               "null", "null", "2.8284271247461901", "null", "false")
                    FORCES WHEELS SEQUENCE TAIL,
        "universal");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    /* turned by theta about x, then by phi about its own y: the bob's place is as follows */
    real theta = 0.4L, phi = 0.3L;
    real x = -2 * sinl(phi), y = 2 * sinl(theta) * cosl(phi), z = -2 * cosl(theta) * cosl(phi);
    state->w[0] = sqrtl(8 + 4 * y);
    state->w[1] = sqrtl(8 - 4 * x);
    assert_true(solve_positions(solver, state));
    near_to(solver->configuration->q[1][0], x, 1);
    near_to(solver->configuration->q[1][1], y, 1);
    near_to(solver->configuration->q[1][2], z, 1);
    near_to(solver->configuration->q[1][4], sinl(theta / 2) * cosl(phi / 2), 1);
    near_to(solver->configuration->q[1][5], cosl(theta / 2) * sinl(phi / 2), 1);
    near_to(solver->configuration->q[1][6], sinl(theta / 2) * sinl(phi / 2), 1);
    state_free(state);
    solver_free(solver);
    model_free(model);
}

/* ---- the planar four-bar linkage, three revolutes and a point on a line ------------------------------------------ */

/* out[0] p + out[1] q = r in the plane, by Cramer's rule */
static void solve_planar(const real p[2], const real q[2], const real r[2], real out[2])
{
    real determinant = p[0] * q[1] - p[1] * q[0];
    out[0] = (r[0] * q[1] - r[1] * q[0]) / determinant;
    out[1] = (p[0] * r[1] - p[1] * r[0]) / determinant;
}

/* Pivots (0, 0) and (4, 0) in the plane x-z, crank 1, upright at design with the coupler's far end at (3.5, 2). */
static void test_four_bar(void **unused)
{
    (void)unused;
    Model *model = model_parse(
        HEAD("fixed") GROUND_BODY
        "," BODY("crank", "2", "[0,0,0]", "[1,0.25,1,0,0,0]", "[0,0,0.5]", "[1,0,0,0]") "," BODY(
            "coupler", "3", "[0,0,0]", "[2,1.5,1,0,0,0]", "[1.75,0,1.5]",
            "[1,0,0,0]") "," BODY("rocker", "4", "[0,0,0]", "[1,0.75,1,0,0,0]", "[3.75,0,1]", "[1,0,0,0]")
            JOINTS JOINT(
                "revolute", "0", "1", "[0,0,0]", "[0,0,-0.5]", "[0,-1,0]", "[0,-1,0]", "null",
                "null") "," JOINT("revolute", "1", "2", "[0,0,0.5]", "[-1.75,0,-0.5]", "[0,-1,0]", "[0,-1,0]", "null",
                                  "null") "," JOINT("revolute", "0", "3", "[4,0,0]", "[0.25,0,-1]", "[0,-1,0]",
                                                    "[0,-1,0]", "null",
                                                    "null") "," JOINT("point_on_line", "2", "3", "[1.75,0,0.5]",
                                                                      "[-0.25,0,1]", "[0,-1,0]", "null", "null", "null")
                COORDINATES COORDINATE("theta", "angle", "0", "1", "null", "null", "[0,-1,0]", "[1,0,0]", "[1,0,0]",
                                       "0", "null", "false") FORCES ALONG("0", "3", "2", "1") WHEELS SEQUENCE TAIL,
        "four-bar");
    Solver *solver = solver_new(model);
    State *state = state_new(model);
    const real b = sqrtl(3.5L * 3.5L + 1), c = sqrtl(4.25L), mass[3] = {2, 3, 4}, J[3] = {0.25L, 1.5L, 0.75L};
    for (int i = 0; i < 6; ++i) {
        real turned = 2.9L * i - 8, rate = 1.5L - i, angle[3], slope[3] = {1}, bend[3] = {0};
        angle[0] = turned + acosl(0);
        /* the rocker: law of cosines on the diagonal from the crank pin to its pivot; the coupler: what is left */
        real pin[2] = {cosl(angle[0]), sinl(angle[0])}, dx = pin[0] - 4, dz = pin[1], diagonal = hypotl(dx, dz);
        angle[2] = atan2l(dz, dx) - acosl((c * c + diagonal * diagonal - b * b) / (2 * c * diagonal));
        real end[2] = {4 + c * cosl(angle[2]), c * sinl(angle[2])};
        angle[1] = atan2l(end[1] - pin[1], end[0] - pin[0]);
        /* e(angle0) + b e(angle1) - c e(angle2) = const, differentiated once and twice with respect to angle0 */
        real along_b[2] = {-b * sinl(angle[1]), b * cosl(angle[1])},
             along_c[2] = {c * sinl(angle[2]), -c * cosl(angle[2])};
        real once[2] = {pin[1], -pin[0]}, twice[2], s[2];
        solve_planar(along_b, along_c, once, s);
        slope[1] = s[0];
        slope[2] = s[1];
        twice[0] = pin[0] + b * cosl(angle[1]) * s[0] * s[0] - c * cosl(angle[2]) * s[1] * s[1];
        twice[1] = pin[1] + b * sinl(angle[1]) * s[0] * s[0] - c * sinl(angle[2]) * s[1] * s[1];
        solve_planar(along_b, along_c, twice, s);
        bend[1] = s[0];
        bend[2] = s[1];
        state->w[0] = turned;
        state->w_rate[0] = rate;
        solve(solver, state, &flat);
        const real design[3] = {acosl(0), atan2l(1, 3.5L), atan2l(2, -0.5L)};
        real inertia = 0, inertia_slope = 0, torque = -3 * (turned - 1) - 2 * rate;
        for (int k = 0; k < 3; ++k) {
            /* centre of mass half-way: of the crank and the rocker on their own radius */
            real radius[3] = {0.5L, b / 2, c / 2}, base[3] = {0, 1, 0}, g[2], h[2];
            g[0] = -base[k] * pin[1] - radius[k] * sinl(angle[k]) * slope[k];
            g[1] = base[k] * pin[0] + radius[k] * cosl(angle[k]) * slope[k];
            h[0] = -base[k] * pin[0] - radius[k] * (cosl(angle[k]) * slope[k] * slope[k] + sinl(angle[k]) * bend[k]);
            h[1] = -base[k] * pin[1] + radius[k] * (-sinl(angle[k]) * slope[k] * slope[k] + cosl(angle[k]) * bend[k]);
            inertia += mass[k] * (g[0] * g[0] + g[1] * g[1]) + J[k] * slope[k] * slope[k];
            inertia_slope += 2 * mass[k] * (g[0] * h[0] + g[1] * h[1]) + 2 * J[k] * slope[k] * bend[k];
            torque -= mass[k] * (real)9.81 * g[1];
            const quad *q = solver->configuration->q[1 + k];
            same_angle(2 * atan2l((real)-q[5], (real)q[3]), angle[k] - design[k]);
            near_to(q[0], (k == 2 ? 4 : 0) + base[k] * pin[0] + radius[k] * cosl(angle[k]), 1);
            near_to(q[2], base[k] * pin[1] + radius[k] * sinl(angle[k]), 1);
            near_to(q[1], 0, 1);
        }
        near_to(solver->w_second[0], (torque - inertia_slope * rate * rate / 2) / inertia, 100);
    }
    state_free(state);
    solver_free(solver);
    model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum_on_length), cmocka_unit_test(test_pendulum_on_angle),
        cmocka_unit_test(test_driven_slide),       cmocka_unit_test(test_change_point),
        cmocka_unit_test(test_free_body),          cmocka_unit_test(test_forces_on_free_body),
        cmocka_unit_test(test_quarter_car),        cmocka_unit_test(test_condition),
        cmocka_unit_test(test_cylindrical),        cmocka_unit_test(test_fixed),
        cmocka_unit_test(test_universal_shafts),   cmocka_unit_test(test_universal),
        cmocka_unit_test(test_four_bar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
