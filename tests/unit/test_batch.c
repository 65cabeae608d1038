/* SPDX-License-Identifier: MIT
 * Vehicles in lanes have the bits of the code for one vehicle, which quad precision has checked: the same operations
 * in the same order, whatever the neighbours do. */
#include "hmmwv_batch.h"
#include "quarter_car_batch.h"
#include "steered_batch.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

/* Bumps at places of each lane's own; from `end` on there is no road. */
typedef struct Bumps {
    gic_road head;
    gic_real end;
} Bumps;

static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_real s = x - 2 - lane;
    (void)time, (void)y;
    out[0] = x > ((const Bumps *)road)->end ? NAN : s > 0 && s < 1 ? s * s * (1 - s) * (1 - s) : 0;
    out[1] = out[2] = 0;
}

static const Bumps whole = {{height, NULL, NULL, NULL, GIC_ROAD_OWN}, INFINITY},
                   broken = {{height, NULL, NULL, NULL, GIC_ROAD_OWN}, 6};

static void begin(hmmwv *car, int32_t lane)
{
    assert_int_equal(hmmwv_setup(car), GIC_OK);
    car->head.lane = lane;
    car->head.road = &whole.head;
    car->state[HMMWV_STATE_V_X] = 5 + lane;
    car->state[HMMWV_STATE_OMEGA_Z] = 0.1 * lane;
}

/* All that a caller sees of a vehicle. */
static void assert_same(const hmmwv_batch *batch, int32_t vehicle, const hmmwv *car)
{
    static hmmwv copy;
    hmmwv_batch_store(batch, vehicle, &copy);
    assert_memory_equal(copy.state, car->state, sizeof car->state);
    assert_memory_equal(copy.rate, car->rate, sizeof car->rate);
    assert_memory_equal(copy.start[0], car->start[car->head.flip], sizeof copy.start[0]);
    assert_true(gic_time(&copy) == gic_time(car));
    assert_int_equal(copy.head.status, car->head.status);
    assert_int_equal(copy.head.subset, car->head.subset);
    assert_int_equal(copy.head.rhs_count, car->head.rhs_count);
    assert_int_equal(copy.head.switch_count, car->head.switch_count);
    assert_int_equal(copy.discrete[0], car->discrete[0]);
}

static void steps(hmmwv *car, int count, gic_method method)
{
    for (int k = 0; k < count && car->head.status == GIC_OK; ++k)
        (void)hmmwv_step(car, 0.005, method);
}

/* Vehicles of different speeds, roads and pasts, with both methods, one of which begins with the other's history. */
static void test_bits(void **state)
{
    static hmmwv car[HMMWV_VEHICLES], copy;
    static hmmwv_batch batch;
    (void)state;
    assert_int_equal(hmmwv_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
        begin(&car[i], i);
        steps(&car[i], i % 4, GIC_AB3);
        hmmwv_batch_load(&batch, i, &car[i]);
    }
    for (int round = 0; round < 6; ++round) {
        const gic_method method = round == 3 ? GIC_RK4 : GIC_AB3;
        assert_int_equal(hmmwv_batch_step(&batch, 0.005, method, 100), HMMWV_VEHICLES);
        assert_int_equal(hmmwv_batch_outputs(&batch), HMMWV_VEHICLES);
        for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
            steps(&car[i], 100, method);
            copy = car[i];
            assert_int_equal(hmmwv_outputs(&copy), GIC_OK);
            for (int32_t o = 0; o < HMMWV_OUTPUTS; ++o)
                assert_true(hmmwv_batch_output(&batch, i, o) == copy.output[o]);
            /* looking leaves no other trace in the batch */
            ++car[i].head.rhs_count;
            memcpy(car[i].rate, copy.rate, sizeof copy.rate);
            assert_same(&batch, i, &car[i]);
        }
    }
}

/* Lanes that fail in different ways, at once or on the way, have the status of one vehicle and disturb no other. */
static void test_failures(void **state)
{
    static hmmwv car[HMMWV_VEHICLES];
    static hmmwv_batch batch;
    (void)state;
    assert_int_equal(hmmwv_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i)
        begin(&car[i], i);
    car[1].state[HMMWV_STATE_V_Y] = NAN;
    car[2].state[HMMWV_STATE_SPRING_F_L] += 0.5;
    car[3].head.road = &broken.head;
    car[5].state[HMMWV_STATE_E0] = 2;
    car[6].state[HMMWV_STATE_SPRING_R_R] += 0.06; /* followed in several pieces, and well */
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i)
        hmmwv_batch_load(&batch, i, &car[i]);
    assert_int_equal(hmmwv_batch_step(&batch, 0.005, GIC_AB3, 300), HMMWV_VEHICLES - 4);
    const int expected[HMMWV_VEHICLES] = {
        [1] = GIC_ERROR_INPUT, [2] = GIC_ERROR_NEWTON, [3] = GIC_ERROR_ROAD, [5] = GIC_ERROR_ORIENTATION};
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
        steps(&car[i], 300, GIC_AB3);
        if (expected[i] == GIC_ERROR_NEWTON)
            assert_true(car[i].head.status < 0); /* which one, the mechanism decides */
        else
            assert_int_equal(car[i].head.status, expected[i]);
        assert_int_equal(hmmwv_batch_status(&batch, i), car[i].head.status);
        assert_same(&batch, i, &car[i]);
    }
    assert_true(gic_time(&car[3]) > 0.1);
    assert_true(car[2].head.subset >= 0);
}

/* A stage of a step that leaves all bounds: an unstable step, and the same number is named. */
static void test_growth(void **state)
{
    static hmmwv car[HMMWV_VEHICLES];
    static hmmwv_batch batch;
    (void)state;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method) {
        assert_int_equal(hmmwv_batch_setup(&batch), GIC_OK);
        for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
            begin(&car[i], i);
            if (i % 2) { /* 2^30 is out of bounds */
                car[i].state[HMMWV_STATE_R_X + i % 3] = 1073741000;
                car[i].state[HMMWV_STATE_V_X] = car[i].state[HMMWV_STATE_V_Y] = car[i].state[HMMWV_STATE_V_Z] = 1e9;
            }
            hmmwv_batch_load(&batch, i, &car[i]);
        }
        assert_int_equal(hmmwv_batch_step(&batch, 0.005, (gic_method)method, 1), HMMWV_VEHICLES / 2);
        for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
            static hmmwv stored;
            steps(&car[i], 1, (gic_method)method);
            assert_int_equal(car[i].head.status, i % 2 ? GIC_ERROR_UNSTABLE : GIC_OK);
            assert_int_equal(hmmwv_batch_status(&batch, i), car[i].head.status);
            assert_int_equal(hmmwv_setup(&stored), GIC_OK);
            hmmwv_batch_store(&batch, i, &stored);
            assert_int_equal(stored.head.grown, car[i].head.grown);
        }
    }
}

static void test_places(void **state)
{
    static hmmwv_batch room[2];
    static hmmwv car;
    (void)state;
    assert_int_equal(hmmwv_batch_setup((hmmwv_batch *)(void *)((char *)room + 8)), GIC_ERROR_ARGUMENT);
    assert_int_equal(hmmwv_batch_setup(room), GIC_OK);
    assert_int_equal(hmmwv_batch_status(room, 3), GIC_BATCH_EMPTY);
    assert_int_equal(hmmwv_batch_step(room, 0.005, GIC_AB3, 1), 0);
    begin(&car, 3);
    hmmwv_batch_load(room, 3, &car);
    assert_int_equal(hmmwv_batch_outputs(room), 1);
    assert_int_equal(hmmwv_batch_step(room, -1, GIC_AB3, 1), 0);
    assert_int_equal(hmmwv_batch_status(room, 3), GIC_ERROR_ARGUMENT);
    assert_int_equal(hmmwv_batch_model.vehicles, HMMWV_VEHICLES);
    assert_true(hmmwv_batch_model.model == &hmmwv_model);
}

/* Steer each vehicle to an angle of its own. */
static void steer(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user;
    gic_quintic(time, 0.2, 0.8, 0, 0.01 * lane - 0.035, input + STEERED_INPUT_RACK);
}

static void test_inputs(void **state)
{
    static steered car[STEERED_VEHICLES], copy;
    static steered_batch batch;
    (void)state;
    assert_int_equal(steered_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < STEERED_VEHICLES; ++i) {
        assert_int_equal(steered_setup(&car[i]), GIC_OK);
        car[i].head.lane = i;
        car[i].head.input_function = i == 2 ? NULL : steer;
        car[i].state[STEERED_STATE_V_X] = 10;
        steered_batch_load(&batch, i, &car[i]);
    }
    assert_int_equal(steered_batch_step(&batch, 0.005, GIC_AB3, 200), STEERED_VEHICLES);
    for (int32_t i = 0; i < STEERED_VEHICLES; ++i) {
        for (int k = 0; k < 200; ++k)
            assert_int_equal(steered_step(&car[i], 0.005, GIC_AB3), GIC_OK);
        steered_batch_store(&batch, i, &copy);
        assert_memory_equal(copy.state, car[i].state, sizeof copy.state);
        assert_memory_equal(copy.input, car[i].input, sizeof copy.input);
        if (i)
            assert_memory_not_equal(car[i].state, car[i - 1].state, sizeof copy.state);
    }
}

/* Ports, a fixed base, and a vehicle that goes on alone. */
static void test_quarter_car(void **state)
{
    static quarter_car car[QUARTER_CAR_VEHICLES], copy;
    static quarter_car_batch batch;
    (void)state;
    assert_int_equal(quarter_car_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < QUARTER_CAR_VEHICLES; ++i) {
        assert_int_equal(quarter_car_setup(&car[i]), GIC_OK);
        car[i].state[0] += 0.001 * i;
        quarter_car_batch_load(&batch, i, &car[i]);
    }
    assert_int_equal(quarter_car_batch_step(&batch, 0.002, GIC_AB3, 100), QUARTER_CAR_VEHICLES);
    for (int32_t i = 0; i < QUARTER_CAR_VEHICLES; ++i) {
        quarter_car_batch_store(&batch, i, &copy);
        for (int k = 0; k < 150; ++k) {
            assert_int_equal(quarter_car_step(&car[i], 0.002, GIC_AB3), GIC_OK);
            if (k >= 100)
                assert_int_equal(quarter_car_step(&copy, 0.002, GIC_AB3), GIC_OK);
        }
        assert_memory_equal(copy.state, car[i].state, sizeof copy.state);
    }
}

/* Vehicles that look for contacts within steps, or whose work is bounded, fall beside others. */
static void test_apart(void **state)
{
    static const int32_t locate[] = {0, 1, 2, 0, 1, 0, 2, 1}, most[] = {0, 0, 0, 100, 60, -1, 0, 1};
    static hmmwv car[HMMWV_VEHICLES], copy;
    static hmmwv_batch batch;
    (void)state;
    assert_int_equal(hmmwv_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
        begin(&car[i], i);
        car[i].state[HMMWV_STATE_R_Z] += 0.25;
        car[i].head.locate = locate[i];
        car[i].head.most = most[i];
        car[i].head.road = i == 6 ? &broken.head : i % 2 ? &whole.head : NULL;
        steps(&car[i], i % 4 == 2 ? 1 : 0, GIC_AB3);
        hmmwv_batch_load(&batch, i, &car[i]);
    }
    for (int round = 0; round < 100; ++round) {
        const gic_method method = round / 20 == 1 ? GIC_RK4 : GIC_AB3;
        const int count = 1 + round % 3;
        (void)hmmwv_batch_step(&batch, 0.005, method, count);
        for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
            steps(&car[i], count, method);
            assert_same(&batch, i, &car[i]);
        }
        if (round % 10)
            continue;
        (void)hmmwv_batch_outputs(&batch);
        for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
            copy = car[i];
            if (car[i].head.status != GIC_OK)
                continue;
            assert_int_equal(hmmwv_outputs(&copy), GIC_OK);
            for (int32_t o = 0; o < HMMWV_OUTPUTS; ++o)
                assert_true(hmmwv_batch_output(&batch, i, o) == copy.output[o]);
            ++car[i].head.rhs_count; /* looking leaves no other trace in the batch */
            memcpy(car[i].rate, copy.rate, sizeof copy.rate);
            assert_same(&batch, i, &car[i]);
        }
    }
    for (int32_t i = 0; i < HMMWV_VEHICLES; ++i) {
        const int32_t status = most[i] == 1 || most[i] < 0 ? GIC_ERROR_ARGUMENT : i == 6 ? GIC_ERROR_ROAD : GIC_OK;
        assert_int_equal(hmmwv_batch_status(&batch, i), status);
        hmmwv_batch_store(&batch, i, &copy);
        assert_int_equal(copy.head.contact_count, car[i].head.contact_count);
        assert_int_equal(copy.head.passed_count, car[i].head.passed_count);
        assert_int_equal(copy.head.look_count, car[i].head.look_count);
        if (locate[i] == 0 || status == GIC_ERROR_ARGUMENT)
            assert_int_equal(copy.head.contact_count, 0);
        else
            assert_true(copy.head.contact_count + copy.head.passed_count >= 4); /* each wheel lands */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bits),   cmocka_unit_test(test_failures),
                                       cmocka_unit_test(test_growth), cmocka_unit_test(test_places),
                                       cmocka_unit_test(test_inputs), cmocka_unit_test(test_quarter_car),
                                       cmocka_unit_test(test_apart)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
