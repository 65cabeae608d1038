/* SPDX-License-Identifier: MIT
 * Wheels with tires in generated code: links and fast rates against the right-hand side, rolling, wheels in the air,
 * recovery that is done once, the energy balance along a run, and what is refused. What tires do is compared with
 * independent evaluations elsewhere. */
#include "motion.h"

#include <float.h>

#include "gic_road.h"
#include "gic_runtime.h"
#include "hmmwv_tires.h"

enum { SLOW = HMMWV_TIRES_SLOW, FAST = HMMWV_TIRES_STATES - HMMWV_TIRES_SLOW, WHEELS = HMMWV_TIRES_ROLLING };

static const gic_road_sine wavy = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.02, 6, 0, 0.4};

/* Rolling at 12 m/s on a wavy road, turning; steered, driven and braked a little. */
static void start(hmmwv_tires *car)
{
    assert_int_equal(hmmwv_tires_setup(car), GIC_OK);
    car->head.road = &wavy.head;
    car->state[HMMWV_TIRES_STATE_V_X] = 12;
    car->state[HMMWV_TIRES_STATE_OMEGA_Z] = 0.2;
    car->input[HMMWV_TIRES_INPUT_RACK] = 0.01;
    car->input[HMMWV_TIRES_INPUT_DRIVE_TORQUE] = 600;
    car->input[HMMWV_TIRES_INPUT_BRAKE] = 0.02;
    assert_int_equal(hmmwv_tires_model.roll(car), GIC_OK);
}

static void ride(hmmwv_tires *car, double step, int steps)
{
    for (int i = 0; i < steps; ++i)
        assert_int_equal(hmmwv_tires_step(car, step, GIC_RK4), GIC_OK);
}

/* The fast rates at links of a state are those of the right-hand side, bit for bit. */
static void test_fast_rates(void **unused)
{
    (void)unused;
    static hmmwv_tires car, other;
    double rate[HMMWV_TIRES_STATES], link[HMMWV_TIRES_LINKS], fast[FAST];
    start(&car);
    for (int i = 0; i < 20; ++i) {
        ride(&car, 0.001, 20);
        const double time = hmmwv_tires_time(&car);
        other = car;
        assert_int_equal(hmmwv_tires_rhs(&car, time, car.state, rate), GIC_OK);
        assert_int_equal(hmmwv_tires_model.link(&other, time, other.state, link), GIC_OK);
        assert_int_equal(hmmwv_tires_model.fast(&other, time, link, other.state + SLOW, fast), GIC_OK);
        assert_memory_equal(fast, rate + SLOW, sizeof fast);
    }
}

/* A drive torque from one time to another, otherwise 600 N m. */
typedef struct Push {
    double from, to, torque;
} Push;

static void push_on(void *user, int32_t lane, gic_real time, gic_real *input)
{
    const Push *push = user;
    (void)lane;
    input[HMMWV_TIRES_INPUT_DRIVE_TORQUE] = time > push->from && time < push->to ? push->torque : 600;
}

/* The generated fast step makes the bits of the runtime's own loops around fast rates, and ends in the same status
 * where an input or a result within a step is no good, with an instance as before. */
static void test_fast_step(void **unused)
{
    (void)unused;
    enum { RATIO = 6 };
    const double step = 0.006, torque[] = {600, -900, NAN, 2000, 1e300, 1.7e308};
    static hmmwv_tires car, other, before;
    static Push push; /* as long as what points to it */
    gic_model plain = hmmwv_tires_model;
    assert_non_null(plain.fast_step);
    plain.fast_step = NULL;
    start(&car);
    car.head.input_function = push_on;
    car.head.user = &push;
    other = car;
    for (int k = 0; k < 120; ++k) {
        const double now = hmmwv_tires_time(&car);
        before = car;
        push = (Push){now + 2.5 * step / RATIO, now + 4.5 * step / RATIO, torque[k % 20 == 19 ? k / 20 : 0]};
        const int good = fabs(push.torque) < 1e4;
        const int status = gic_step_dual(&hmmwv_tires_model, &car, step, RATIO);
        assert_int_equal(gic_step_dual(&plain, &other, step, RATIO), status);
        assert_int_equal(status == GIC_OK, good);
        assert_int_equal(car.head.grown, other.head.grown);
        assert_true(car.head.fast_count == other.head.fast_count);
        assert_memory_equal(car.state, other.state, sizeof car.state);
        assert_memory_equal(car.rate, other.rate, sizeof car.rate);
        assert_memory_equal(car.history, other.history, sizeof car.history);
        assert_memory_equal(car.link, other.link, 3 * HMMWV_TIRES_LINKS * sizeof *car.link);
        if (good)
            continue;
        assert_memory_equal(car.state, before.state, sizeof car.state);
        assert_memory_equal(car.history, before.history, sizeof car.history);
        assert_true(hmmwv_tires_time(&car) == now);
        car.head.status = other.head.status = GIC_OK;
    }
}

/* Centre and axis of a link change as its velocity and angular velocity say. */
static void test_link(void **unused)
{
    (void)unused;
    const double h = 1e-4;
    static hmmwv_tires car;
    double link[3][HMMWV_TIRES_LINKS];
    start(&car);
    ride(&car, 0.001, 300);
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(hmmwv_tires_model.link(&car, hmmwv_tires_time(&car), car.state, link[i]), GIC_OK);
        ride(&car, h, 1);
    }
    for (int wheel = 0; wheel < WHEELS; ++wheel)
        for (int i = 0; i < 3; ++i) {
            const int at = 12 * wheel, j = (i + 1) % 3, k = (i + 2) % 3;
            const double *now = link[1] + at, *s = now + 6, *omega = now + 9;
            const double moved = (link[2][at + i] - link[0][at + i]) / (2 * h);
            const double turned = (link[2][at + 6 + i] - link[0][at + 6 + i]) / (2 * h);
            /* central differences: h^2 / 6 times third derivatives of up to about 1e5, and 1e-15 / h of rounding */
            assert_true(fabs(moved - now[3 + i]) < 5e-4);
            assert_true(fabs(turned - (omega[j] * s[k] - omega[k] * s[j])) < 5e-4);
        }
}

/* No wheel slips that rolls. */
static void test_roll(void **unused)
{
    (void)unused;
    static hmmwv_tires car;
    double rate[HMMWV_TIRES_STATES];
    start(&car);
    car.input[HMMWV_TIRES_INPUT_RACK] = 0;
    car.state[HMMWV_TIRES_STATE_V_Y] = 0.3;
    car.state[HMMWV_TIRES_STATE_TIRE_F_L_SLIP_X] = 0.4;
    car.state[HMMWV_TIRES_STATE_TIRE_R_R_BRAKE] = 0.4;
    assert_int_equal(hmmwv_tires_model.roll(&car), GIC_OK);
    assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_OK);
    for (int wheel = 0; wheel < WHEELS; ++wheel) {
        const double *own = car.state + SLOW + 4 * wheel, *change = rate + SLOW + 4 * wheel;
        assert_true(own[0] > 20 && own[1] == 0 && own[3] == 0);
        /* slips stay: those of wheels that touch, up to rounding of speeds of 12 m/s over lengths of decimetres */
        assert_true(fabs(change[1]) < 1e-12);
        if (car.grip[HMMWV_TIRES_GRIP * wheel + 9] > 0.01)
            assert_true(fabs(change[2]) < 1e-12);
    }
}

/* Rates from before are forgotten: AB3 goes on from there as a vehicle does that starts in that state. */
static void test_roll_history(void **unused)
{
    (void)unused;
    static hmmwv_tires car, fresh;
    start(&car);
    car.input[HMMWV_TIRES_INPUT_BRAKE] = 0.5;
    for (int i = 0; i < 20; ++i)
        assert_int_equal(hmmwv_tires_step(&car, 0.001, GIC_AB3), GIC_OK);
    assert_int_equal(hmmwv_tires_model.roll(&car), GIC_OK);
    start(&fresh);
    fresh.input[HMMWV_TIRES_INPUT_BRAKE] = 0.5;
    memcpy(fresh.state, car.state, sizeof car.state);
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(hmmwv_tires_step(&car, 0.001, GIC_AB3), GIC_OK);
        assert_int_equal(hmmwv_tires_step(&fresh, 0.001, GIC_AB3), GIC_OK);
    }
    for (int i = 0; i < HMMWV_TIRES_STATES; ++i) /* the road does not depend on time; recoveries differ by rounding */
        assert_true(fabs(car.state[i] - fresh.state[i]) < 1e-9 * (1 + fabs(fresh.state[i])));
}

/* High above the road nothing but the brake acts, and no tire has a force: exactly. */
static void test_air(void **unused)
{
    (void)unused;
    static hmmwv_tires car;
    start(&car);
    car.state[HMMWV_TIRES_STATE_R_Z] += 2;
    assert_int_equal(hmmwv_tires_outputs(&car), GIC_OK);
    for (int wheel = 0; wheel < WHEELS; ++wheel) {
        const double *grip = car.grip + HMMWV_TIRES_GRIP * wheel;
        for (int i = 0; i < 3; ++i)
            assert_true(grip[i] == 0);
        for (int i = 12; i < 17; ++i)
            assert_true(grip[i] == 0);
        assert_true(grip[6] == 150 && grip[8] == 0);
        assert_true(fabs(7.38782 * car.rate[SLOW + 4 * wheel] - (grip[6] - grip[7])) < 1e-10);
    }
}

/* What was recovered for a state is not recovered again, and gives the same as an instance that starts from elsewhere.
 */
static void test_recovery(void **unused)
{
    (void)unused;
    static hmmwv_tires car, fresh;
    double rate[HMMWV_TIRES_STATES], again[HMMWV_TIRES_STATES], link[HMMWV_TIRES_LINKS];
    start(&car);
    fresh = car;
    ride(&car, 0.001, 200);
    memcpy(fresh.state, car.state, sizeof car.state);
    const double time = hmmwv_tires_time(&car);
    assert_int_equal(hmmwv_tires_model.link(&car, time, car.state, link), GIC_OK);
    const int64_t solved = car.head.newton_count;
    assert_int_equal(hmmwv_tires_rhs(&car, time, car.state, rate), GIC_OK);
    assert_int_equal(hmmwv_tires_rhs(&car, time, car.state, again), GIC_OK);
    assert_true(car.head.newton_count == solved);
    assert_memory_equal(rate, again, sizeof rate);
    assert_int_equal(hmmwv_tires_rhs(&fresh, time, fresh.state, again), GIC_OK);
    for (int i = 0; i < HMMWV_TIRES_STATES; ++i) /* accelerations of stiff tires: 1e-10 of their size is rounding */
        assert_true(fabs(rate[i] - again[i]) < 1e-10 * (1 + fabs(rate[i])));
    /* a coordinate, a rate, the turning of the base, the rack: each asks for a new one */
    static const int place[] = {HMMWV_TIRES_STATE_SPRING_F_L, HMMWV_TIRES_STATE_SPRING_F_L_RATE,
                                HMMWV_TIRES_STATE_OMEGA_X};
    for (int i = 0; i < 4; ++i) {
        const int64_t before = car.head.newton_count;
        if (i < 3)
            car.state[place[i]] += 1e-9;
        else
            car.input[HMMWV_TIRES_INPUT_RACK] += 1e-9;
        assert_int_equal(hmmwv_tires_rhs(&car, time, car.state, rate), GIC_OK);
        assert_true(car.head.newton_count > before);
    }
}

/* Kinetic and potential energy change by what `power` says, in the air, on the road, braking: Simpson's rule. */
static void test_power(void **unused)
{
    (void)unused;
    const double h = 2e-4;
    static hmmwv_tires car;
    start(&car);
    ride(&car, 0.001, 200);
    car.input[HMMWV_TIRES_INPUT_BRAKE] = 0.6;
    for (int round = 0; round < 50; ++round) {
        double energy[3], power[3];
        ride(&car, 0.001, 20);
        for (int i = 0; i < 3; ++i) {
            assert_int_equal(hmmwv_tires_outputs(&car), GIC_OK);
            energy[i] = car.output[HMMWV_TIRES_OUTPUT_ENERGY_KINETIC] + car.output[HMMWV_TIRES_OUTPUT_ENERGY_POTENTIAL];
            power[i] = car.output[HMMWV_TIRES_OUTPUT_ENERGY_POWER];
            ride(&car, h, 1);
        }
        const double done = h / 3 * (power[0] + 4 * power[1] + power[2]);
        /* the power changes within milliseconds by its own size: h^5 / 90 of its fourth derivative is below 1e-5 of it;
         * 1e-9 of 200 kJ is rounding */
        assert_true(fabs(energy[2] - energy[0] - done) < 2e-4 * fabs(done) + 1e-3);
        gic_self_test balance;
        assert_int_equal(hmmwv_tires_self_test(&car, &balance), GIC_OK);
        assert_true(balance.energy < 1e-12);
    }
    assert_true(car.state[HMMWV_TIRES_STATE_V_X] < 10);
}

static double slippery;

static double friction_of_test(const gic_road *road, int32_t lane, double time, double x, double y)
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    return slippery;
}

/* Friction scales what a sliding tire can do; none, or what is no number, is refused. */
static void test_friction(void **unused)
{
    (void)unused;
    static hmmwv_tires car;
    gic_road_plane road = {{gic_plane_height, friction_of_test, gic_plane_bend, NULL, GIC_ROAD_PLANE}, 0, 0, 0};
    double force[2], rate[HMMWV_TIRES_STATES];
    for (int i = 0; i < 2; ++i) {
        slippery = i ? 0.5 : 1;
        start(&car);
        car.head.road = &road.head;
        car.state[HMMWV_TIRES_STATE_TIRE_F_L_SPIN] = 0;
        car.state[HMMWV_TIRES_STATE_TIRE_F_L_SLIP_X] = -1;
        assert_int_equal(hmmwv_tires_outputs(&car), GIC_OK);
        force[i] = car.output[HMMWV_TIRES_OUTPUT_SLIP_F_L_FX];
    }
    assert_true(force[0] < -1000 && force[1] > 0.6 * force[0] && force[1] < 0.4 * force[0]);
    static const double bad[] = {0, -1, NAN};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        slippery = bad[i];
        assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_ERROR_ROAD);
    }
    slippery = 1;
    assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_OK);
    car.state[HMMWV_TIRES_STATE_TIRE_R_L_SLIP_Y] = NAN;
    assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_ERROR_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fast_rates),   cmocka_unit_test(test_link),     cmocka_unit_test(test_roll),
        cmocka_unit_test(test_roll_history), cmocka_unit_test(test_air),      cmocka_unit_test(test_recovery),
        cmocka_unit_test(test_power),        cmocka_unit_test(test_friction), cmocka_unit_test(test_fast_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
