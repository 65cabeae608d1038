/* SPDX-License-Identifier: MIT
 * Wheels with tires of interpreted engines: contact against geometry, tires against what their data mean, brakes
 * against the torque balance, power against the forces, links against the right-hand side. What the formulas say number
 * by number is checked elsewhere, against the reference.
 *
 * Tolerance where nothing else is said: 1e-12, relative to the sizes at hand: some hundred roundings. */
#include "base/pool.h"
#include "base/random.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "read/read.h"
#include "run/engines.h"
#include "world/tire.h"
#include "world/wheel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static const double rounding = 1e-12;
static const char *const models[] = {"models/hmmwv_tires.veh", "models/hmmwv_tmeasy.veh"};
enum { MODELS = sizeof models / sizeof *models };

/* First wheel of a model, which is on the left, as its tire is. */
typedef struct Corner {
    Pool *pool;
    Wheel wheel;
    const Tire *tire;
} Corner;

static Corner corner_of(const char *path)
{
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    return (Corner){.pool = pool, .wheel = model->wheel[0], .tire = &model->tire[model->wheel[0].tire]};
}

static void close_to(double a, double b, double most)
{
    if (!(fabs(a - b) <= most))
        fail_msg("%.17g is not %.17g to %g", a, b, most);
}

static void near(double a, double b, double size)
{
    close_to(a, b, rounding * size);
}

static void near3(const double a[3], const double b[3], double size)
{
    for (int i = 0; i < 3; ++i)
        near(a[i], b[i], size);
}

/* z = slope x, of friction 0.7 */
typedef struct Slope {
    gic_road head;
    double slope;
} Slope;

static void plane_height(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    const Slope *plane = (const Slope *)(const void *)road;
    (void)lane, (void)time, (void)y;
    out[0] = plane->slope * x;
    out[1] = plane->slope;
    out[2] = 0;
}

static double low_friction(const gic_road *road, int32_t lane, double time, double x, double y)
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    return 0.7;
}

/* A wheel `depth` in the road at camber gamma, that moves at `velocity`. */
static WheelMotion motion_of(const Tire *tire, double depth, double gamma, const double velocity[3])
{
    WheelMotion motion = {.axis = {0, cos(gamma), sin(gamma)}};
    motion.center[2] = (tire->radius - depth) * cos(gamma);
    copy3(velocity, motion.velocity);
    return motion;
}

static WheelMotion random_motion(const Tire *tire, Random *random)
{
    const double velocity[3] = {random_uniform(random, -20, 20), random_uniform(random, -3, 3),
                                random_uniform(random, -0.5, 0.5)};
    WheelMotion motion =
        motion_of(tire, random_uniform(random, -0.01, 0.05), random_uniform(random, -0.2, 0.2), velocity);
    for (int i = 0; i < 3; ++i)
        motion.omega[i] = random_uniform(random, -2, 2);
    motion.drive_turn = random_uniform(random, -1, 1);
    return motion;
}

static void random_fast(Random *random, double fast[FAST_MOST])
{
    fast[FAST_SPIN] = random_uniform(random, -40, 40);
    fast[FAST_SLIP_X] = random_uniform(random, -0.5, 0.5);
    fast[FAST_SLIP_Y] = random_uniform(random, -0.5, 0.5);
    fast[FAST_BRAKE] = random_uniform(random, -1, 1);
}

/* On a flat road contact is trigonometry. */
static void test_contact(void **unused)
{
    const Corner corner = corner_of(models[0]);
    const double gamma = 0.1, depth = 0.02, R = corner.tire->radius, v[3] = {10, 0.5, -0.3};
    const WheelMotion motion = motion_of(corner.tire, depth, gamma, v);
    Rolling out;
    (void)unused;
    assert_int_equal(wheel_touch(&corner.wheel, corner.tire, &(Ground){0}, &motion, &out), GIC_OK);
    near(out.deflection, depth, 1);
    near(out.camber, gamma, 1);
    near(out.deflection_rate, 0.3 / cos(gamma), 1);
    near3(out.point, (const double[3]){0, (R - depth) * sin(gamma), 0}, 1);
    near3(out.forward, (const double[3]){1, 0, 0}, 1);
    near3(out.left, (const double[3]){0, 1, 0}, 1);
    near(out.fz, corner.tire->stiffness * depth + corner.tire->damping * 0.3 / cos(gamma), 1e4);
    near(out.friction, 1, 1);
    pool_free(corner.pool);
}

/* A road turned about y, with the wheel: everything turns with it. */
static void test_slope(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        const Corner corner = corner_of(models[m]);
        const double angle = 0.3, c = cos(angle), s = sin(angle), up[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
        const Slope flat = {{plane_height, low_friction, NULL, NULL, GIC_ROAD_OWN}, 0},
                    hill = {{plane_height, low_friction, NULL, NULL, GIC_ROAD_OWN}, s / c};
        Random random = {.state = 3};
        for (int n = 0; n < 50; ++n) {
            const WheelMotion level = random_motion(corner.tire, &random);
            WheelMotion turned = level;
            double fast[FAST_MOST], rate[2][FAST_MOST], wanted[3];
            Rolling out[2];
            random_fast(&random, fast);
            apply3(up, level.center, turned.center);
            apply3(up, level.velocity, turned.velocity);
            apply3(up, level.axis, turned.axis);
            apply3(up, level.omega, turned.omega);
            assert_int_equal(wheel_touch(&corner.wheel, corner.tire, &(Ground){.road = &flat.head}, &level, &out[0]),
                             GIC_OK);
            assert_int_equal(wheel_touch(&corner.wheel, corner.tire, &(Ground){.road = &hill.head}, &turned, &out[1]),
                             GIC_OK);
            wheel_turn(&corner.wheel, corner.tire, &level, 100, 200, fast, rate[0], &out[0]);
            wheel_turn(&corner.wheel, corner.tire, &turned, 100, 200, fast, rate[1], &out[1]);
            near(out[1].friction, 0.7, 1);
            apply3(up, out[0].force, wanted);
            near3(out[1].force, wanted, 1e6);
            apply3(up, out[0].torque, wanted);
            near3(out[1].torque, wanted, 1e6);
            apply3(up, out[0].point, wanted);
            near3(out[1].point, wanted, 1);
            for (int i = 0; i < FAST_MOST; ++i)
                near(rate[1][i], rate[0][i], 1e5);
        }
        pool_free(corner.pool);
    }
}

/* Seen in the mirror y -> -y: vectors lose the sign of y, moments and rotations of x and z. */
static void mirror(const double sign[3], const double a[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = sign[i] * a[i];
}

static void test_mirror(void **unused)
{
    static const double vector[3] = {1, -1, 1}, moment[3] = {-1, 1, -1};
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        const Corner corner = corner_of(models[m]);
        Wheel right = corner.wheel;
        Random random = {.state = 4};
        right.mirrored = corner.tire->side != SIDE_SYMMETRIC;
        for (int n = 0; n < 50; ++n) {
            const WheelMotion one = random_motion(corner.tire, &random);
            WheelMotion other = one;
            double fast[FAST_MOST], seen[FAST_MOST], rate[2][FAST_MOST], wanted[3];
            Rolling out[2];
            random_fast(&random, fast);
            memcpy(seen, fast, sizeof fast);
            seen[FAST_SLIP_Y] = -fast[FAST_SLIP_Y];
            mirror(vector, one.center, other.center);
            mirror(vector, one.velocity, other.velocity);
            mirror(moment, one.axis, other.axis);
            mirror(moment, one.omega, other.omega);
            wheel_touch(&corner.wheel, corner.tire, &(Ground){0}, &one, &out[0]);
            wheel_touch(&right, corner.tire, &(Ground){0}, &other, &out[1]);
            wheel_turn(&corner.wheel, corner.tire, &one, 100, 200, fast, rate[0], &out[0]);
            wheel_turn(&right, corner.tire, &other, 100, 200, seen, rate[1], &out[1]);
            mirror(vector, out[0].force, wanted);
            near3(out[1].force, wanted, 1e6);
            mirror(moment, out[0].torque, wanted);
            near3(out[1].torque, wanted, 1e6);
            near(rate[1][FAST_SPIN], rate[0][FAST_SPIN], 1e5);
            near(rate[1][FAST_SLIP_X], rate[0][FAST_SLIP_X], 1e5);
            near(rate[1][FAST_SLIP_Y], -rate[0][FAST_SLIP_Y], 1e5);
            near(rate[1][FAST_BRAKE], rate[0][FAST_BRAKE], 1e5);
        }
        pool_free(corner.pool);
    }
}

/* A wheel that rolls has nothing to change: kappa' and t' stay. */
static void test_roll(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        const Corner corner = corner_of(models[m]);
        const double v[3] = {-7, 0.4, 0};
        const WheelMotion motion = motion_of(corner.tire, 0.03, 0, v);
        double fast[FAST_MOST], rate[FAST_MOST];
        Rolling out;
        wheel_touch(&corner.wheel, corner.tire, &(Ground){0}, &motion, &out);
        wheel_roll(&corner.wheel, corner.tire, &out, fast);
        wheel_turn(&corner.wheel, corner.tire, &motion, 0, 0, fast, rate, &out);
        near(rate[FAST_SLIP_X], 0, 10);
        near(rate[FAST_SLIP_Y], 0, 10);
        near(out.kappa, 0, 1);
        near(tan(out.alpha), 0.4 / 7, 1);
        assert_true(out.tire.fy < -100 && fast[FAST_SPIN] < -7 / corner.tire->radius);
        pool_free(corner.pool);
    }
}

/* What the wheel takes and the carriers take is the power that is told. */
static void test_power(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        const Corner corner = corner_of(models[m]);
        Random random = {.state = 5};
        for (int n = 0; n < 50; ++n) {
            const WheelMotion motion = random_motion(corner.tire, &random);
            double fast[FAST_MOST], rate[FAST_MOST];
            Rolling out;
            random_fast(&random, fast);
            wheel_touch(&corner.wheel, corner.tire, &(Ground){0}, &motion, &out);
            wheel_turn(&corner.wheel, corner.tire, &motion, 300, 2000, fast, rate, &out);
            const double taken = dot3(out.force, motion.velocity) + dot3(out.torque, motion.omega) +
                                 dot3(out.reaction, motion.axis) * motion.drive_turn +
                                 corner.wheel.spin_inertia * fast[FAST_SPIN] * rate[FAST_SPIN];
            near(out.power, taken, 1e6);
        }
        pool_free(corner.pool);
    }
}

/* Numbers of TMeasy: initial slopes, maxima where they are said to be, sliding forces; twice at twice the load. */
static void test_tmeasy(void **unused)
{
    const Corner corner = corner_of(models[1]);
    const Tire *tire = corner.tire;
    const double *number = tire->number;
    (void)unused;
    assert_int_equal(tire->type, TIRE_TMEASY);
    for (int twice = 0; twice < 2; ++twice) {
        const double fz = (1 + twice) * number[TMEASY_load], small = 1e-4;
        const double *at = number + twice, q = number[TMEASY_friction];
        TireMotion slip = {.fz = fz, .friction = q, .deflection = 0.02};
        /* slips that are a hair off zero count (1e-12 under the root): a part in 1e9 of the forces at these */
        slip.kappa = at[TMEASY_sxm];
        close_to(tire_forces(tire, &slip).fx, at[TMEASY_fxm], 1e-8 * fz);
        slip.kappa = -1.01 * at[TMEASY_sxs];
        close_to(tire_forces(tire, &slip).fx, -at[TMEASY_fxs], 1e-8 * fz);
        slip.kappa = small;
        close_to(tire_forces(tire, &slip).fx / small, at[TMEASY_dfx0], 0.02 * at[TMEASY_dfx0]);
        slip.kappa = 0;
        slip.alpha = -atan(at[TMEASY_sym]);
        close_to(tire_forces(tire, &slip).fy, at[TMEASY_fym], 1e-8 * fz);
        slip.alpha = atan(1.01 * at[TMEASY_sys]);
        close_to(tire_forces(tire, &slip).fy, -at[TMEASY_fys], 1e-8 * fz);
        slip.alpha = atan(small);
        const TireForces little = tire_forces(tire, &slip);
        close_to(-little.fy / small, at[TMEASY_dfy0], 0.02 * at[TMEASY_dfy0]);
        /* aligning: against the slip, with the trail of zero slip */
        close_to(-little.mz / little.fy, at[TMEASY_trail] * sqrt(8 * tire->radius * 0.02), 1e-3);
        slip.friction = 0.5 * q;
        slip.alpha = 0;
        slip.kappa = 2 * at[TMEASY_sxs];
        close_to(tire_forces(tire, &slip).fx, 0.5 * at[TMEASY_fxs], 1e-8 * fz);
    }
    pool_free(corner.pool);
}

/* Of the Magic Formula: slope Kx and Ky at no force, the largest force D, less of it with slip in both directions, and
 * the moment of the trail. Coefficients of this tire that shift the curves are small but not zero. */
static void test_pac2002(void **unused)
{
    const Corner corner = corner_of(models[0]);
    const Tire *tire = corner.tire;
    const double *p = tire->number, fz = p[PAC_LFZO] * p[PAC_FNOMIN], h = 1e-6;
    TireMotion a = {.fz = fz, .friction = 1, .deflection = 0.05, .speed = 20, .spin = 40}, b = a;
    (void)unused;
    assert_int_equal(tire->type, TIRE_PAC2002);
    a.kappa = -h;
    b.kappa = h;
    close_to((tire_forces(tire, &b).fx - tire_forces(tire, &a).fx) / (2 * h), p[PAC_PKX1] * p[PAC_LKX] * fz,
             0.02 * fabs(p[PAC_PKX1]) * fz);
    double most[2] = {0, 0};
    for (int i = -1000; i <= 1000; ++i) {
        a.kappa = 0.001 * i;
        a.alpha = 0;
        most[0] = fmax(most[0], tire_forces(tire, &a).fx);
        a.kappa = 0;
        a.alpha = 0.001 * i;
        most[1] = fmax(most[1], tire_forces(tire, &a).fy);
    }
    close_to(most[0], p[PAC_PDX1] * p[PAC_LMUX] * fz, 0.05 * fz);
    close_to(most[1], p[PAC_PDY1] * p[PAC_LMUY] * fz, 0.05 * fz);
    a.kappa = 0.1;
    a.alpha = 0.1;
    b.kappa = 0.1;
    const TireForces both = tire_forces(tire, &a), alone = tire_forces(tire, &b);
    assert_true(both.fx < alone.fx && both.fx > 0 && both.fy < 0);
    assert_true(both.my < 0);
    a.kappa = 0;
    a.alpha = 0.03;
    const TireForces side = tire_forces(tire, &a);
    assert_true(side.fy < 0 && side.mz > 0);
    /* beyond the ranges nothing changes */
    a.alpha = p[PAC_ALPMAX];
    b = a;
    b.alpha += 0.5;
    const TireForces last = tire_forces(tire, &a), beyond = tire_forces(tire, &b);
    assert_memory_equal(&last, &beyond, sizeof last);
    pool_free(corner.pool);
}

/* The wheel in the air, RK4: spin after `time`. */
static double spun(const Corner *corner, double drive, double brake, double time, double fast[FAST_MOST])
{
    const double h = 1e-4, still[3] = {0, 0, 0};
    const WheelMotion motion = motion_of(corner->tire, -1, 0, still);
    Rolling out;
    double most = 0;
    wheel_touch(&corner->wheel, corner->tire, &(Ground){0}, &motion, &out);
    for (int n = (int)(time / h + 0.5); n > 0; --n) {
        double k[4][FAST_MOST], x[FAST_MOST];
        for (int stage = 0; stage < 4; ++stage) {
            const double reach = stage == 3 ? h : stage ? 0.5 * h : 0;
            for (int i = 0; i < FAST_MOST; ++i)
                x[i] = fast[i] + (stage ? reach * k[stage - 1][i] : 0);
            wheel_turn(&corner->wheel, corner->tire, &motion, drive, brake, x, k[stage], &out);
        }
        for (int i = 0; i < FAST_MOST; ++i)
            fast[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
        if (n * h < 0.5 * time)
            most = fmax(most, fabs(fast[FAST_SPIN]));
    }
    return most;
}

/* A brake slows the wheel down by what it is worth, stops it, holds what is below it without creep, and yields to more.
 */
static void test_brake(void **unused)
{
    const Corner corner = corner_of(models[0]);
    const double I = corner.wheel.spin_inertia, brake = 1000;
    double fast[FAST_MOST] = {20, 0, 0, 0};
    (void)unused;
    assert_non_null(corner.wheel.brake);
    /* 1000 N m take 20 rad/s away in about 0.15 s; the pads take hold within the windup, 0.1 rad */
    spun(&corner, 0, brake, 0.1, fast);
    close_to(fast[FAST_SPIN], 20 - 0.1 * brake / I, 0.01 * 20);
    /* held, the wheel swings on its pads: a spring of brake / windup with damping that decays with 6.8 / s */
    assert_true(spun(&corner, 0, brake, 4, fast) < 1e-4);
    assert_true(spun(&corner, 600, brake, 4, fast) < 1e-4);
    close_to(fast[FAST_BRAKE], 0.6, 1e-6);
    fast[FAST_SPIN] = 0;
    spun(&corner, 1500, brake, 0.5, fast);
    /* until it slips, in 0.04 s, up to 400 N m are missing */
    close_to(fast[FAST_SPIN], 0.5 * 500 / I, 0.04 * 400 / I);
    spun(&corner, 0, 0, 0.1, fast);
    const double free_spin = fast[FAST_SPIN];
    spun(&corner, 0, 0, 1, fast);
    near(fast[FAST_SPIN], free_spin, free_spin);
    pool_free(corner.pool);
}

/* ---- the engines ----------------------------------------------------------------------------------------- */

typedef struct Opened {
    Pool *pool;
    const Engine *engine;
    gic_head *self;
} Opened;

/* In motion, with steering and drive. */
static Opened opened(const char *path, const char *name)
{
    Opened o = {.pool = pool_new()};
    o.engine = engine_open(o.pool, name, model_read(o.pool, path), &(EngineOptions){.quiet = true});
    const gic_model *code = o.engine->code;
    o.self = instance_new(o.pool, o.engine);
    assert_int_equal(code->setup(o.self), GIC_OK);
    double standard[o.engine->standard_count + 1], *input = instance_array(o.self, code->input_offset);
    assert_int_equal(engine_look(o.engine, o.self, standard, NULL), GIC_OK);
    for (int i = 0; i < code->input_count; ++i)
        if (!strcmp(code->input[i].name, "drive_torque"))
            input[i] = 1500;
        else if (!strcmp(code->input[i].name, "brake"))
            input[i] = 0.1;
        else if (!strcmp(code->input[i].name, "rack"))
            input[i] = 0.02;
    for (int i = 0; i < o.engine->standard_count; ++i)
        if (!strcmp(o.engine->standard[i].name, "v.x"))
            standard[i] = 12;
        else if (!strcmp(o.engine->standard[i].name, "omega.z"))
            standard[i] = 0.2;
    assert_int_equal(engine_enter(o.engine, o.self, standard), GIC_OK);
    assert_int_equal(code->roll(o.self), GIC_OK);
    return o;
}

static void closed(Opened o)
{
    engine_close(o.engine);
    pool_free(o.pool);
}

static const char *const engines[] = {"gic", "gcp1"};
enum { ENGINES = sizeof engines / sizeof *engines };

/* What an engine tells of one state. */
typedef struct Moment {
    double time, *state, *rate, *link;
} Moment;

static Moment moment_new(Pool *pool, const gic_model *code)
{
    const size_t states = (size_t)(code->slow_count + code->fast_count);
    return (Moment){.state = pool_alloc(pool, states * sizeof(double)),
                    .rate = pool_alloc(pool, states * sizeof(double)),
                    .link = pool_alloc(pool, (size_t)code->link_count * sizeof(double))};
}

static void tell(const Opened *o, Moment *moment)
{
    const gic_model *code = o->engine->code;
    moment->time = gic_time(o->self);
    memcpy(moment->state, instance_array(o->self, code->state_offset),
           (size_t)(code->slow_count + code->fast_count) * sizeof(double));
    assert_int_equal(code->rhs(o->self, moment->time, moment->state, moment->rate), GIC_OK);
    assert_int_equal(code->link(o->self, moment->time, moment->state, moment->link), GIC_OK);
}

static void assert_linked(const Opened *o, const Moment *moment)
{
    const gic_model *code = o->engine->code;
    double fast[code->fast_count];
    assert_int_equal(code->fast(o->self, moment->time, moment->link, moment->state + code->slow_count, fast), GIC_OK);
    for (int i = 0; i < code->fast_count; ++i)
        close_to(fast[i], moment->rate[code->slow_count + i], 1e-9 * (1 + fabs(fast[i])));
}

/* Rates of fast states by way of the links are those of the right-hand side: the same operations on the same numbers
 * but for the recovery, which starts elsewhere. That is so as well for links of the step before, which have nothing to
 * do with where the engine has been since. Constraints and the power balance hold at all steps. */
static void check_links(const char *model, const char *engine, int fast_count)
{
    const Opened o = opened(model, engine);
    const gic_model *code = o.engine->code;
    assert_true(code->fast_count == fast_count && code->link_count > 0);
    Moment moment[2] = {moment_new(o.pool, code), moment_new(o.pool, code)};
    for (int n = 0; n < 200; ++n) {
        gic_self_test test;
        assert_int_equal(gic_step(code, o.self, 0.001, GIC_AB3), GIC_OK);
        tell(&o, &moment[n % 2]);
        assert_linked(&o, &moment[n % 2]);
        if (n)
            assert_linked(&o, &moment[(n + 1) % 2]);
        assert_int_equal(code->self_test(o.self, &test), GIC_OK);
        assert_true(test.balance < rounding && test.energy < rounding && test.constraint < rounding);
    }
    closed(o);
}

static void test_link(void **unused)
{
    (void)unused;
    for (int e = 0; e < ENGINES; ++e) {
        for (int m = 0; m < MODELS; ++m)
            check_links(models[m], engines[e], 16);
        check_links("tests/data/tires/pair.veh", engines[e], 6);
    }
}

/* What rolls begins anew: AB3 goes on as it does from the same state without a past. */
static void test_roll_history(void **unused)
{
    (void)unused;
    static const char *const rolling[] = {"tape", "gic", "gcp1", "tcc"};
    for (size_t e = 0; e < sizeof rolling / sizeof *rolling; ++e) {
        const Opened o = opened(models[0], rolling[e]);
        const gic_model *code = o.engine->code;
        const size_t states = (size_t)(code->slow_count + code->fast_count);
        double begin[states], wanted[states], input[code->input_count],
            *state = instance_array(o.self, code->state_offset);
        for (int n = 0; n < 20; ++n)
            assert_int_equal(gic_step(code, o.self, 0.001, GIC_AB3), GIC_OK);
        assert_int_equal(code->roll(o.self), GIC_OK);
        memcpy(begin, state, sizeof begin);
        for (int n = 0; n < 3; ++n)
            assert_int_equal(gic_step(code, o.self, 0.001, GIC_AB3), GIC_OK);
        memcpy(wanted, state, sizeof wanted);
        memcpy(input, instance_array(o.self, code->input_offset), sizeof input);
        assert_int_equal(code->setup(o.self), GIC_OK);
        memcpy(instance_array(o.self, code->input_offset), input, sizeof input);
        memcpy(state, begin, sizeof begin);
        for (int n = 0; n < 3; ++n)
            assert_int_equal(gic_step(code, o.self, 0.001, GIC_AB3), GIC_OK);
        for (size_t i = 0; i < states; ++i)
            close_to(state[i], wanted[i], 1e-9 * (1 + fabs(wanted[i])));
        closed(o);
    }
}

/* Failures change nothing. */
static void test_refused(void **unused)
{
    const Opened o = opened(models[0], "gic");
    const gic_model *code = o.engine->code;
    double *state = instance_array(o.self, code->state_offset), *link = instance_array(o.self, code->link_offset);
    double rate[code->fast_count], before[code->fast_count];
    (void)unused;
    assert_int_equal(code->link(o.self, 0, state, link), GIC_OK);
    assert_int_equal(code->fast(o.self, 0, link, state + code->slow_count, before), GIC_OK);
    memcpy(rate, before, sizeof rate);
    link[0] = NAN;
    assert_int_equal(code->fast(o.self, 0, link, state + code->slow_count, rate), GIC_ERROR_INPUT);
    link[0] = 0;
    state[code->slow_count + FAST_SLIP_Y] = INFINITY;
    assert_int_equal(code->fast(o.self, 0, link, state + code->slow_count, rate), GIC_ERROR_INPUT);
    assert_int_equal(gic_step(code, o.self, 0.001, GIC_RK4), GIC_ERROR_INPUT);
    state[0] = NAN;
    assert_int_equal(code->link(o.self, 0, state, link), GIC_ERROR_INPUT);
    assert_memory_equal(rate, before, sizeof rate);
    close_to(link[0], 0, 0);
    closed(o);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_contact), cmocka_unit_test(test_slope),        cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_roll),    cmocka_unit_test(test_power),        cmocka_unit_test(test_tmeasy),
        cmocka_unit_test(test_pac2002), cmocka_unit_test(test_brake),        cmocka_unit_test(test_link),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_roll_history),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
