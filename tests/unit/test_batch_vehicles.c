/* SPDX-License-Identifier: MIT
 * Complete vehicles in lanes, with tires, brakes and powertrain, have the bits of the code for one vehicle where both call
 * libm (GIC_BATCH_LIBM), whatever the neighbours do: on their own roads, with their own inputs, gears and parameters. */
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

static const Waves whole = {{height, friction}, INFINITY}, broken = {{height, NULL}, 4};

/* Pull away, steer, brake until the wheels lock: each lane in its own way. Lane 0 stands still: all numbers are nice. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
