/* SPDX-License-Identifier: MIT
 * Solutions of subsets that are kept because nothing they follow from has changed: how many, and that every digit is
 * the same as without. An instance that has forgotten its last recovery keeps nothing. */
#include "gic_runtime.h"

#include "motion.h"

#include "hmmwv.h"
#include "hmmwv_tires.h"
#include "quarter_car.h"

enum { RACK = 1, ARMS = 4, WHEELS = 4, ALL = RACK + ARMS + WHEELS };

/* A state of the HMMWV in which everything moves. */
static void stir(hmmwv *car)
{
    assert_int_equal(hmmwv_setup(car), GIC_OK);
    for (int i = 0; i < HMMWV_COORDINATES; ++i)
        car->state[hmmwv_model.coordinate_state[i]] += 0.002 * (i + 1);
    for (int i = HMMWV_TWIST; i < HMMWV_STATES; ++i)
        car->state[i] = 0.1 * (1 + i % 3);
}

/* Right-hand sides of two instances, of which one has forgotten; returns how many solutions the other one kept. */
static int64_t compare(hmmwv *car)
{
    static hmmwv other;
    double rate[HMMWV_STATES], again[HMMWV_STATES];
    const int64_t before = car->head.kept_count, solved = car->head.newton_count;
    other = *car;
    other.recovered = 0;
    assert_int_equal(hmmwv_rhs(car, 0, car->state, rate), GIC_OK);
    assert_int_equal(hmmwv_rhs(&other, 0, car->state, again), GIC_OK);
    assert_memory_equal(rate, again, sizeof rate);
    assert_memory_equal(car->motion, other.motion, sizeof car->motion);
    assert_memory_equal(car->inertia, other.inertia, sizeof car->inertia);
    assert_memory_equal(car->start[car->head.flip], other.start[other.head.flip], sizeof car->start[0]);
    assert_true(other.head.kept_count == before);
    assert_true(car->head.kept_count - before + car->head.newton_count - solved >= ALL); /* more on the way back */
    return car->head.kept_count - before;
}

/* A change of one coordinate, or of its rate, is one of its arm and its wheel; the rack moves both front wheels; where
 * the base's turning changes nothing stays; where it moves along, everything does. */
static void test_corners(void **unused)
{
    (void)unused;
    static hmmwv car;
    double rate[HMMWV_STATES];
    stir(&car);
    assert_int_equal(hmmwv_rhs(&car, 0, car.state, rate), GIC_OK);
    assert_int_equal(compare(&car), ALL);
    car.state[HMMWV_STATE_SPRING_F_L] += 1e-9;
    assert_int_equal(compare(&car), ALL - 2);
    car.state[HMMWV_STATE_SPRING_R_R_RATE] += 1e-9;
    assert_int_equal(compare(&car), ALL - 2);
    car.state[HMMWV_STATE_RACK] += 1e-9;
    assert_int_equal(compare(&car), ALL - 3);
    car.state[HMMWV_STATE_OMEGA_Y] += 1e-9;
    assert_int_equal(compare(&car), 0);
    car.state[HMMWV_STATE_V_X] += 1;
    car.state[HMMWV_STATE_R_Z] += 0.1;
    assert_int_equal(compare(&car), ALL);
    /* zeros of either sign are not the same */
    car.state[HMMWV_STATE_SPRING_F_L_RATE] = 0;
    compare(&car);
    car.state[HMMWV_STATE_SPRING_F_L_RATE] = -0.0;
    assert_int_equal(compare(&car), ALL - 2);
}

/* What failed half-way is not kept, nor what was set up anew. */
static void test_failure(void **unused)
{
    (void)unused;
    static hmmwv car;
    double rate[HMMWV_STATES], state[HMMWV_STATES];
    stir(&car);
    assert_int_equal(hmmwv_rhs(&car, 0, car.state, rate), GIC_OK);
    memcpy(state, car.state, sizeof state);
    state[HMMWV_STATE_SPRING_R_R] = 3; /* the last arm has no place for it */
    assert_true(hmmwv_rhs(&car, 0, state, rate) < GIC_OK);
    assert_int_equal(compare(&car), 0);
    assert_int_equal(hmmwv_setup(&car), GIC_OK);
    assert_true(car.head.kept_count <= ALL);
}

/* A road that may have a hole everywhere. */
static int hole;

static void holed(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = hole ? NAN : 0;
    out[1] = out[2] = 0;
}

/* A step that fails after its recovery goes back to the start before that: what it recovered is no longer kept. */
static void test_failed_step(void **unused)
{
    (void)unused;
    static const gic_road road = {holed, NULL, NULL, NULL, GIC_ROAD_OWN};
    static hmmwv_tires car, other;
    gic_self_test test[2];
    assert_int_equal(hmmwv_tires_setup(&car), GIC_OK);
    car.head.road = &road;
    car.state[HMMWV_TIRES_STATE_V_Z] = -0.5;
    for (int i = 0; i < 20; ++i)
        assert_int_equal(hmmwv_tires_step(&car, 0.002, GIC_AB3), GIC_OK);
    hole = 1;
    assert_int_equal(hmmwv_tires_step(&car, 0.002, GIC_AB3), GIC_ERROR_ROAD);
    hole = 0;
    other = car;
    other.recovered = 0;
    assert_int_equal(hmmwv_tires_outputs(&car), GIC_OK);
    assert_int_equal(hmmwv_tires_outputs(&other), GIC_OK);
    assert_memory_equal(car.output, other.output, sizeof car.output);
    assert_memory_equal(car.start[car.head.flip], other.start[other.head.flip], sizeof car.start[0]);
    assert_int_equal(hmmwv_tires_self_test(&car, &test[0]), GIC_OK);
    assert_int_equal(hmmwv_tires_self_test(&other, &test[1]), GIC_OK);
    assert_true(test[0].constraint == test[1].constraint && test[0].constraint < 1e-12);
}

/* Runs in which one instance keeps what it can and the other one nothing. The rig stands still but for its spring. */
static void test_runs(void **unused)
{
    (void)unused;
    static hmmwv_tires car[2];
    static quarter_car rig[2];
    for (int k = 0; k < 2; ++k) {
        assert_int_equal(hmmwv_tires_setup(&car[k]), GIC_OK);
        assert_int_equal(quarter_car_setup(&rig[k]), GIC_OK);
        car[k].state[HMMWV_TIRES_STATE_V_X] = 8;
        car[k].input[HMMWV_TIRES_INPUT_RACK] = 0.01;
    }
    for (int i = 0; i < 400; ++i)
        for (int k = 0; k < 2; ++k) {
            if (k)
                car[k].recovered = rig[k].recovered = 0;
            assert_int_equal(gic_step_dual(&hmmwv_tires_model, &car[k], 0.002, 4), GIC_OK);
            assert_int_equal(quarter_car_step(&rig[k], 0.002, i % 2 ? GIC_RK4 : GIC_AB3), GIC_OK);
            if (k)
                car[k].recovered = rig[k].recovered = 0;
            assert_int_equal(hmmwv_tires_outputs(&car[k]), GIC_OK);
            assert_int_equal(quarter_car_outputs(&rig[k]), GIC_OK);
            if (!k)
                continue;
            assert_memory_equal(car[0].state, car[1].state, sizeof car[0].state);
            assert_memory_equal(car[0].output, car[1].output, sizeof car[0].output);
            assert_memory_equal(rig[0].state, rig[1].state, sizeof rig[0].state);
            assert_memory_equal(rig[0].output, rig[1].output, sizeof rig[0].output);
        }
    assert_true(car[0].head.kept_count > car[1].head.kept_count);
    assert_true(rig[0].head.kept_count > 0);
}

/* Tires of wheels in the air are counted: all four of a vehicle high above the road, at every evaluation. */
static void test_air(void **unused)
{
    (void)unused;
    static hmmwv_tires car;
    double rate[HMMWV_TIRES_STATES];
    assert_int_equal(hmmwv_tires_setup(&car), GIC_OK);
    const int64_t before = car.head.air_count;
    assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_OK);
    assert_true(car.head.air_count == before);
    car.state[HMMWV_TIRES_STATE_R_Z] += 2;
    for (int i = 1; i <= 5; ++i) {
        assert_int_equal(hmmwv_tires_rhs(&car, 0, car.state, rate), GIC_OK);
        assert_true(car.head.air_count == before + 4 * i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_corners), cmocka_unit_test(test_failure), cmocka_unit_test(test_failed_step),
        cmocka_unit_test(test_runs),    cmocka_unit_test(test_air),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
