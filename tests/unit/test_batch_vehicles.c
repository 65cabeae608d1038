/* SPDX-License-Identifier: MIT
 * Complete vehicles in lanes, with tires, brakes and powertrain, have the bits of the code for one vehicle where both
 * call libm (GIC_BATCH_LIBM), whatever the neighbours do: on their own roads, with their own inputs, gears and
 * parameters. */
#include "hmmwv_vehicle_batch.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = HMMWV_VEHICLE_VEHICLES };

/* Waves and slippery patches, of each lane its own; from `end` on there is no road. */
typedef struct Waves {
    gic_road head;
    gic_real end;
} Waves;

static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_real k = 0.3 + 0.1 * lane, size = 0.01 * lane;
    (void)time, (void)y;
    out[0] = x > ((const Waves *)road)->end ? NAN : size * sin(k * x);
    out[1] = size * k * cos(k * x);
    out[2] = 0;
}

static gic_real friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    (void)road, (void)time, (void)x;
    return y > 0 ? 1 : 1 - 0.1 * lane;
}

static const Waves whole = {{height, friction, NULL, NULL, GIC_ROAD_OWN}, INFINITY},
                   broken = {{height, NULL, NULL, NULL, GIC_ROAD_OWN}, 4};

/* Pull away, steer, brake until the wheels lock: each lane in its own way. Lane 0 stands still: all numbers are nice.
 */
static void drive(void *user, int32_t lane, gic_real time, gic_real *input)
{
    const gic_real hard = 0.25 * (lane % 4);
    (void)user;
    input[HMMWV_VEHICLE_INPUT_ACCELERATOR] = time < 1.5 ? hard : 0;
    input[HMMWV_VEHICLE_INPUT_BRAKE] = time < 1.5 ? 0 : hard;
    input[HMMWV_VEHICLE_INPUT_SELECTOR] = lane == 0 ? 0 : lane == 5 ? -1 : 1;
    gic_quintic(time, 0.2, 0.8, 0, 0.005 * (lane - 3), input + HMMWV_VEHICLE_INPUT_RACK);
}

static void begin(hmmwv_vehicle *car, int32_t lane)
{
    assert_int_equal(hmmwv_vehicle_setup(car), GIC_OK);
    car->head.lane = lane;
    car->head.road = lane % 3 ? &whole.head : NULL;
    car->head.input_function = drive;
    drive(NULL, lane, 0, car->input);
    car->state[HMMWV_VEHICLE_STATE_V_X] = lane == 0 ? 0 : lane == 5 ? -2 : 4 * lane;
    assert_int_equal(hmmwv_vehicle_model.roll(car), GIC_OK);
}

/* All that a caller sees of a vehicle. */
static void assert_same(const hmmwv_vehicle_batch *batch, int32_t vehicle, const hmmwv_vehicle *car)
{
    static hmmwv_vehicle copy;
    hmmwv_vehicle_batch_store(batch, vehicle, &copy);
    for (int i = 0; i < HMMWV_VEHICLE_STATES; ++i)
        if (memcmp(&copy.state[i], &car->state[i], sizeof *copy.state))
            fail_msg("vehicle %d at %g s: %s is %.17g, alone %.17g", vehicle, gic_time(car),
                     hmmwv_vehicle_model.state[i].name, copy.state[i], car->state[i]);
    assert_memory_equal(copy.rate, car->rate, sizeof car->rate);
    assert_memory_equal(copy.input, car->input, sizeof car->input);
    assert_memory_equal(copy.discrete, car->discrete, sizeof car->discrete);
    assert_memory_equal(copy.start[0], car->start[car->head.flip], sizeof copy.start[0]);
    assert_true(gic_time(&copy) == gic_time(car));
    assert_int_equal(copy.head.status, car->head.status);
    assert_int_equal(copy.head.subset, car->head.subset);
    assert_int_equal(copy.head.grown, car->head.grown);
    assert_int_equal(copy.head.history, car->head.history);
    assert_int_equal(copy.head.rhs_count, car->head.rhs_count);
    assert_int_equal(copy.head.fast_count, car->head.fast_count);
    assert_int_equal(copy.head.steady_count, car->head.steady_count);
    assert_int_equal(copy.head.switch_count, car->head.switch_count);
}

/* A way to make steps; ratio 0: gic_step. */
typedef struct Way {
    gic_real step;
    int32_t method, ratio;
    gic_real steady;
} Way;

static void steps(hmmwv_vehicle *car, const Way *way, int count)
{
    for (int k = 0; k < count && car->head.status == GIC_OK; ++k) {
        if (way->ratio)
            (void)gic_step_steady(&hmmwv_vehicle_model, car, way->step, way->ratio, way->steady);
        else
            (void)gic_step(&hmmwv_vehicle_model, car, way->step, way->method);
    }
}

static int32_t batch_steps(hmmwv_vehicle_batch *batch, const Way *way, int32_t count)
{
    return way->ratio ? hmmwv_vehicle_batch_step_dual(batch, way->step, way->ratio, way->steady, count)
                      : hmmwv_vehicle_batch_step(batch, way->step, (gic_method)way->method, count);
}

/* At one rate and at two, skipping steady steps or not, one way after another; vehicles with pasts of their own. */
static void test_bits(void **state)
{
    static const Way way[] = {{0.006, GIC_AB3, 6, 0}, {0.001, GIC_AB3, 0, 0}, {0.006, GIC_AB3, 6, 1e-3},
                              {0.002, GIC_RK4, 0, 0}, {0.004, GIC_AB3, 2, 0}, {0.006, GIC_AB3, 6, 0}};
    static hmmwv_vehicle car[N], copy;
    static hmmwv_vehicle_batch batch;
    int shifts = 0;
    (void)state;
    assert_int_equal(hmmwv_vehicle_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < N; ++i) {
        begin(&car[i], i);
        steps(&car[i], &way[0], i % 4);
        hmmwv_vehicle_batch_load(&batch, i, &car[i]);
    }
    for (size_t w = 0; w < sizeof way / sizeof *way; ++w) {
        assert_int_equal(batch_steps(&batch, &way[w], 100), N);
        for (int32_t i = 0; i < N; ++i) {
            const int32_t gear = car[i].discrete[HMMWV_VEHICLE_GEAR];
            steps(&car[i], &way[w], 100);
            shifts += gear != car[i].discrete[HMMWV_VEHICLE_GEAR];
            assert_same(&batch, i, &car[i]);
        }
        assert_int_equal(hmmwv_vehicle_batch_outputs(&batch), N);
        for (int32_t i = 0; i < N; ++i) {
            copy = car[i];
            assert_int_equal(hmmwv_vehicle_outputs(&copy), GIC_OK);
            for (int32_t o = 0; o < HMMWV_VEHICLE_OUTPUTS; ++o)
                assert_true(hmmwv_vehicle_batch_output(&batch, i, o) == copy.output[o]);
            ++car[i].head.rhs_count; /* looking leaves no other trace in the batch */
            memcpy(car[i].rate, copy.rate, sizeof copy.rate);
            assert_same(&batch, i, &car[i]);
        }
    }
    assert_true(shifts > 2);
}

/* Lanes that fail in different ways, at once or on the way, have the status of one vehicle and disturb no other. */
static void test_failures(void **state)
{
    static const Way dual = {0.006, GIC_AB3, 6, 0};
    static hmmwv_vehicle car[N];
    static hmmwv_vehicle_batch batch;
    (void)state;
    assert_int_equal(hmmwv_vehicle_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < N; ++i) {
        begin(&car[i], i);
        steps(&car[i], &dual, 5);
    }
    car[1].state[HMMWV_VEHICLE_STATE_V_Y] = NAN;
    car[2].state[HMMWV_VEHICLE_STATE_SPRING_F_L] += 0.5;
    car[3].head.road = &broken.head;
    car[4].discrete[HMMWV_VEHICLE_GEAR] = 99;
    car[5].state[HMMWV_VEHICLE_STATE_E0] = 2;
    car[6].state[HMMWV_VEHICLE_SLOW + HMMWV_VEHICLE_ENGINE] = 2e9;
    for (int32_t i = 0; i < N; ++i)
        hmmwv_vehicle_batch_load(&batch, i, &car[i]);
    assert_int_equal(batch_steps(&batch, &dual, 300), 2);
    for (int32_t i = 0; i < N; ++i) {
        steps(&car[i], &dual, 300);
        assert_same(&batch, i, &car[i]);
        assert_int_equal(hmmwv_vehicle_batch_status(&batch, i), car[i].head.status);
    }
    assert_int_equal(car[1].head.status, GIC_ERROR_INPUT);
    assert_true(car[2].head.status < 0);
    assert_int_equal(car[3].head.status, GIC_ERROR_ROAD);
    assert_true(gic_time(&car[3]) > 0.1);
    assert_int_equal(car[4].head.status, GIC_ERROR_INPUT);
    assert_int_equal(car[5].head.status, GIC_ERROR_ORIENTATION);
    assert_int_equal(car[6].head.status, GIC_ERROR_INPUT);
}

/* A place that is used again, by a vehicle that another one's failure has left it. */
static void test_refill(void **state)
{
    static const Way dual = {0.006, GIC_AB3, 6, 0};
    static hmmwv_vehicle car[2];
    static hmmwv_vehicle_batch batch;
    (void)state;
    assert_int_equal(hmmwv_vehicle_batch_setup(&batch), GIC_OK);
    assert_int_equal(batch_steps(&batch, &dual, 1), 0);
    begin(&car[0], 1);
    begin(&car[1], 3);
    hmmwv_vehicle_batch_load(&batch, 0, &car[0]);
    car[1].head.road = &broken.head;
    hmmwv_vehicle_batch_load(&batch, 1, &car[1]);
    assert_int_equal(batch_steps(&batch, &dual, 200), 1);
    assert_int_equal(hmmwv_vehicle_batch_status(&batch, 1), GIC_ERROR_ROAD);
    assert_int_equal(hmmwv_vehicle_batch_status(&batch, 2), GIC_BATCH_EMPTY);
    begin(&car[1], 2);
    hmmwv_vehicle_batch_load(&batch, 1, &car[1]);
    assert_int_equal(batch_steps(&batch, &dual, 100), 2);
    steps(&car[0], &dual, 300);
    steps(&car[1], &dual, 100);
    for (int32_t i = 0; i < 2; ++i)
        assert_same(&batch, i, &car[i]);
    /* orders that can't be: each vehicle's status says so */
    assert_int_equal(hmmwv_vehicle_batch_step_dual(&batch, 0.006, 0, 0, 1), 0);
    assert_int_equal(hmmwv_vehicle_batch_status(&batch, 1), GIC_ERROR_ARGUMENT);
    assert_int_equal(hmmwv_vehicle_batch_status(&batch, 2), GIC_BATCH_EMPTY);
}

/* Where wheels lose the road within a step, that step ends there and goes on; driven coordinates that the caller moves
 * between steps. */
static void test_events(void **state)
{
    static const Way dual = {0.006, GIC_AB3, 6, 0};
    static hmmwv_vehicle car[N];
    static hmmwv_vehicle_batch batch;
    gic_real *input;
    int64_t contacts = 0;
    (void)state;
    assert_int_equal(hmmwv_vehicle_batch_setup(&batch), GIC_OK);
    for (int32_t i = 0; i < N; ++i) {
        begin(&car[i], i);
        car[i].head.locate = i % 2;
        car[i].state[HMMWV_VEHICLE_STATE_R_Z] += 0.05 * i;
        if (i > 3)
            car[i].head.input_function = NULL;
        hmmwv_vehicle_batch_load(&batch, i, &car[i]);
    }
    for (int round = 0; round < 40; ++round) {
        assert_int_equal(batch_steps(&batch, &dual, 3), N);
        for (int32_t i = 0; i < N; ++i) {
            steps(&car[i], &dual, 3);
            assert_same(&batch, i, &car[i]);
            input = car[i].input + HMMWV_VEHICLE_INPUT_RACK;
            if (i > 3 && round % 2) {
                *input += 1e-4;
                batch.block[i / HMMWV_VEHICLE_LANES].input[HMMWV_VEHICLE_INPUT_RACK][i % HMMWV_VEHICLE_LANES] = *input;
            }
        }
    }
    for (int32_t i = 0; i < N; ++i)
        contacts += car[i].head.contact_count;
    assert_true(contacts > 4);
}

/* Thousands of vehicles stay in the cache of a core, or near it: 16 kB each, work space included. */
static void test_memory(void **state)
{
    (void)state;
    assert_true(hmmwv_vehicle_batch_model.size == sizeof(hmmwv_vehicle_batch));
    assert_true(sizeof(hmmwv_vehicle_batch) <= (size_t)16384 * N);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bits), cmocka_unit_test(test_failures),
                                       cmocka_unit_test(test_refill), cmocka_unit_test(test_events),
                                       cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
