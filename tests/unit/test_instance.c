/* SPDX-License-Identifier: MIT
 * What generated code promises to programs that embed it: snapshots, independence of instances and of the Newton start,
 * failures that change nothing and say why, and the emitted self-test. */
#include "motion.h"

#include <float.h>

#include "gic_road.h"
#include "gic_runtime.h"
#include "hmmwv.h"
#include "pendulum.h"
#include "quarter_car.h"
#include "steered.h"

static const gic_model *const models[] = {&hmmwv_model, &quarter_car_model, &pendulum_model, &steered_model};
enum { MODELS = sizeof models / sizeof *models };

static const gic_road_sine wavy = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.02, 6, 0, 0.4};

/* The HMMWV at 5 m/s on the wavy road, turning and swaying. */
static void start_ride(hmmwv *car)
{
    assert_int_equal(hmmwv_setup(car), GIC_OK);
    car->head.road = &wavy.head;
    car->state[HMMWV_STATE_V_X] = 5;
    car->state[HMMWV_STATE_OMEGA_Z] = 0.3;
    car->state[HMMWV_STATE_RACK_RATE] = 0.1;
}

static void ride(hmmwv *car, gic_method method, int steps)
{
    for (int i = 0; i < steps; ++i)
        assert_int_equal(hmmwv_step(car, 0.005, method), GIC_OK);
}

/* Same bits in everything that a caller sees. */
static void assert_same(hmmwv *a, hmmwv *b)
{
    assert_int_equal(hmmwv_outputs(a), GIC_OK);
    assert_int_equal(hmmwv_outputs(b), GIC_OK);
    assert_memory_equal(a->state, b->state, sizeof a->state);
    assert_memory_equal(a->output, b->output, sizeof a->output);
    assert_memory_equal(a->rate, b->rate, sizeof a->rate);
    assert_true(hmmwv_time(a) == hmmwv_time(b));
}

/* ---- snapshots and instances ------------------------------------------------------------------------------- */

/* From the first steps of AB3, whose history is still short, and from later ones. */
static void test_snapshot(void **unused)
{
    (void)unused;
    static const int before[] = {0, 1, 2, 3, 57};
    for (int method = GIC_AB3; method <= GIC_RK4; ++method)
        for (size_t i = 0; i < sizeof before / sizeof *before; ++i) {
            static hmmwv car, kept, whole;
            start_ride(&car);
            start_ride(&whole);
            ride(&car, (gic_method)method, before[i]);
            hmmwv_snapshot(&car, &kept);
            ride(&car, (gic_method)method, 40);
            hmmwv_restore(&car, &kept);
            ride(&car, (gic_method)method, 30);
            ride(&whole, (gic_method)method, before[i] + 30);
            assert_same(&car, &whole);
            /* looking at it between steps changes nothing either */
            hmmwv_restore(&car, &kept);
            for (int k = 0; k < 30; ++k) {
                assert_int_equal(hmmwv_outputs(&car), GIC_OK);
                ride(&car, (gic_method)method, 1);
            }
            for (int k = 0; k < HMMWV_STATES; ++k)
                assert_true(fabs(car.state[k] - whole.state[k]) < 1e-12 * (1 + fabs(whole.state[k])));
        }
}

/* Two different instances, step by step in turn, go as each does alone. */
static void test_interleaved(void **unused)
{
    (void)unused;
    static hmmwv first, second, first_alone, second_alone;
    start_ride(&first);
    start_ride(&second);
    second.state[HMMWV_STATE_V_X] = 9;
    hmmwv_snapshot(&first, &first_alone);
    hmmwv_snapshot(&second, &second_alone);
    for (int i = 0; i < 100; ++i) {
        ride(&first, GIC_AB3, 1);
        ride(&second, GIC_RK4, 1);
    }
    ride(&first_alone, GIC_AB3, 100);
    ride(&second_alone, GIC_RK4, 100);
    assert_same(&first, &first_alone);
    assert_same(&second, &second_alone);
    assert_true(first.state[HMMWV_STATE_R_X] < second.state[HMMWV_STATE_R_X]);
}

/* Inputs that move with time, kept small, and what they were asked for. */
typedef struct Demand {
    const gic_model *model;
    const double *initial;
    double last;
    int calls;
} Demand;

static void demand_inputs(void *user, int32_t lane, gic_real time, gic_real *input)
{
    Demand *demand = user;
    (void)lane;
    for (int i = 0; i < demand->model->input_count; ++i)
        input[i] = demand->initial[i] + 1e-3 * sin(3 * time + i);
    demand->last = time;
    ++demand->calls;
}

/* A model's own function for steps of AB3 against the runtime's general ones, which a descriptor without it takes: the
 * same bits in everything, inputs asked for at the same times, steps of other methods and lengths between. */
static void test_march(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        gic_model general = *models[m];
        assert_non_null(general.march);
        general.march = NULL;
        uint64_t seed = 3;
        Vehicle vehicle[] = {vehicle_new(models[m]), vehicle_new(&general)};
        const size_t states = (size_t)vehicle[0].states * sizeof(double);
        for (int i = (vehicle[0].states + general.free_base) / 2; i < vehicle[0].states; ++i) /* speeds */
            vehicle[0].state[i] += 0.2 * random_even(&seed);
        memcpy(vehicle[1].state, vehicle[0].state, states);
        double *initial = calloc((size_t)general.input_count + 1, sizeof *initial);
        assert_non_null(initial);
        memcpy(initial, vehicle[0].input, (size_t)general.input_count * sizeof *initial);
        Demand demand[2];
        for (int v = 0; v < 2; ++v) {
            demand[v] = (Demand){&general, initial, -1, 0};
            vehicle[v].head->road = &wavy.head;
            vehicle[v].head->input_function = demand_inputs;
            vehicle[v].head->user = &demand[v];
        }
        for (int i = 0; i < 120; ++i) {
            for (int v = 0; v < 2; ++v)
                vehicle_steps(&vehicle[v], i < 60 ? 1e-3 : 5e-4, i % 40 == 30 ? GIC_RK4 : GIC_AB3, 1);
            if (i % 7 == 0) /* whose rate is another one then */
                for (int v = 0; v < 2; ++v)
                    assert_int_equal(vehicle[v].model->outputs(vehicle[v].head), GIC_OK);
            assert_memory_equal(vehicle[0].state, vehicle[1].state, states);
            assert_memory_equal(vehicle[0].rate, vehicle[1].rate, states);
            assert_memory_equal(vehicle_array(&vehicle[0], general.history_offset),
                                vehicle_array(&vehicle[1], general.history_offset), 2 * states);
            assert_memory_equal(vehicle[0].input, vehicle[1].input, (size_t)general.input_count * sizeof *initial);
            assert_true(gic_time(vehicle[0].head) == gic_time(vehicle[1].head));
            assert_int_equal(vehicle[0].head->history, vehicle[1].head->history);
            assert_int_equal(vehicle[0].head->rhs_count, vehicle[1].head->rhs_count);
            assert_true(demand[0].last == demand[1].last && demand[0].calls == demand[1].calls);
        }
        free(initial);
        free(vehicle[0].head);
        free(vehicle[1].head);
    }
}

/* ---- independence of the way ---------------------------------------------------------------------------------- */

/* The same state reached from the design and by way of other states: rates agree to rounding. The accelerations are
 * sums of terms of the size that accelerations have over random states, and that size is the scale. */
static void test_newton_start(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        uint64_t seed = 11;
        Vehicle direct = vehicle_new(models[m]), wandered = vehicle_new(models[m]);
        double scale = 0, worst = 0;
        double *a = calloc((size_t)direct.states, sizeof *a), *b = calloc((size_t)direct.states, sizeof *b);
        assert_true(a && b);
        for (int row = 0; row < 20; ++row) {
            random_state(&wandered, &seed);
            assert_int_equal(direct.model->setup(direct.head), GIC_OK);
            memcpy(direct.state, wandered.state, (size_t)direct.states * sizeof *a);
            memcpy(direct.input, wandered.input, (size_t)direct.model->input_count * sizeof *a);
            direct.head->road = wandered.head->road = &wavy.head;
            assert_int_equal(direct.model->rhs(direct.head, 0, direct.state, a), GIC_OK);
            assert_int_equal(wandered.model->rhs(wandered.head, 0, wandered.state, b), GIC_OK);
            for (int i = 0; i < direct.states; ++i) {
                scale = fmax(scale, fabs(a[i]));
                worst = fmax(worst, fabs(a[i] - b[i]));
            }
        }
        if (worst > 1e-12 * scale)
            fail_msg("%s: rates differ by %g of %g", direct.model->name, worst, scale);
        free(a);
        free(b);
        free(direct.head);
        free(wandered.head);
    }
}

/* ---- self-test --------------------------------------------------------------------------------------------------- */

static void test_self_test(void **unused)
{
    (void)unused;
    for (int m = 0; m < MODELS; ++m) {
        uint64_t seed = 5;
        Vehicle vehicle = vehicle_new(models[m]);
        for (int row = 0; row < 20; ++row) {
            gic_self_test test;
            memset(&test, 0xff, sizeof test);
            random_state(&vehicle, &seed);
            vehicle.head->road = &wavy.head;
            assert_int_equal(vehicle.model->self_test(vehicle.head, &test), GIC_OK);
            if (!(test.constraint >= 0 && test.constraint < 1e-12 && test.symmetry >= 0 && test.symmetry < 1e-12 &&
                  test.balance >= 0 && test.balance < 1e-12 && test.energy >= 0 && test.energy < 1e-12 &&
                  test.smallest_pivot > 0 && test.smallest_pivot <= 1))
                fail_msg("%s, state %d: constraint %g, symmetry %g, balance %g, energy %g, pivot %g",
                         vehicle.model->name, row, test.constraint, test.symmetry, test.balance, test.energy,
                         test.smallest_pivot);
        }
        free(vehicle.head);
    }
}

/* ---- failures ------------------------------------------------------------------------------------------------------
 */

/* A car that has already gone some way, and a spoiled copy of it. */
typedef struct Failure {
    hmmwv good, bad;
} Failure;

static Failure *failure_new(void)
{
    static Failure failure;
    start_ride(&failure.good);
    ride(&failure.good, GIC_AB3, 20);
    hmmwv_snapshot(&failure.good, &failure.bad);
    return &failure;
}

/* A step of `bad` fails with `status` about `subset` (NULL: about none) and changes neither state nor time; so does a
 * request for outputs, unless the step's length was at fault. With its state repaired `bad` goes on as `good` does. */
static void assert_refused(Failure *failure, double step, int status, const char *subset)
{
    hmmwv *bad = &failure->bad, *good = &failure->good;
    static hmmwv before;
    hmmwv_snapshot(bad, &before);
    for (int method = GIC_AB3; method <= GIC_RK4; ++method) {
        assert_int_equal(hmmwv_step(bad, step, (gic_method)method), status);
        assert_int_equal(bad->head.status, status);
        assert_true(strlen(hmmwv_status_text(status)) > 5);
        if (subset)
            assert_string_equal(hmmwv_status_subset(bad), subset);
        else
            assert_null(hmmwv_status_subset(bad));
        assert_memory_equal(bad->state, before.state, sizeof bad->state);
        assert_memory_equal(bad->history, before.history, sizeof bad->history);
        assert_true(bad->head.steps == before.head.steps && bad->head.start_time == before.head.start_time);
    }
    if (status != GIC_ERROR_ARGUMENT) {
        assert_int_equal(hmmwv_outputs(bad), status);
        assert_memory_equal(bad->output, before.output, sizeof bad->output);
        gic_real rate[HMMWV_STATES] = {77};
        assert_int_equal(hmmwv_rhs(bad, 0, bad->state, rate), status);
        assert_true(rate[0] == 77 && rate[1] == 0);
    }
    memcpy(bad->state, good->state, sizeof bad->state);
    bad->head.road = good->head.road;
    ride(bad, GIC_AB3, 10);
    ride(good, GIC_AB3, 10);
    for (int i = 0; i < HMMWV_STATES; ++i)
        assert_true(fabs(bad->state[i] - good->state[i]) < 1e-11 * (1 + fabs(good->state[i])));
    assert_true(hmmwv_time(bad) == hmmwv_time(good));
}

/* What gives way first on the way from the design. As the arm swings down, the upper link (0.31 m) with the upright
 * (0.34 m) must bridge up to 0.74 m between its hinge and the ball joint below the arm's hinge, before the spring could
 * reach its longest, 0.56 m. */
static void test_out_of_reach(void **unused)
{
    (void)unused;
    Failure *failure = failure_new();
    failure->bad.state[HMMWV_STATE_SPRING_R_L] = 0.9;
    assert_refused(failure, 0.005, GIC_ERROR_NEWTON, "wheel_r_l");
    failure = failure_new();
    failure->bad.state[HMMWV_STATE_SPRING_F_R] = -0.1;
    assert_refused(failure, 0.005, GIC_ERROR_NEWTON, "lca_f_r");
    /* the rack far to the left pulls at the right tie rod until that and the steering arm are in line */
    failure = failure_new();
    failure->bad.state[HMMWV_STATE_RACK] = 1.5;
    assert_refused(failure, 0.005, GIC_ERROR_NEWTON, "wheel_f_r");
    failure = failure_new();
    failure->bad.state[HMMWV_STATE_SPRING_F_L] = 1e8;
    assert_refused(failure, 0.005, GIC_ERROR_REACH, NULL);
}

static void test_not_finite(void **unused)
{
    (void)unused;
    static const double poison[] = {NAN, INFINITY, -INFINITY, 1e300, -0x1p30};
    for (size_t i = 0; i < 5; ++i)
        for (int k = 0; k < HMMWV_STATES; ++k) {
            Failure *failure = failure_new();
            failure->bad.state[k] = poison[i];
            assert_int_equal(hmmwv_step(&failure->bad, 0.005, GIC_RK4), GIC_ERROR_INPUT);
            assert_refused(failure, 0.005, GIC_ERROR_INPUT, NULL);
        }
}

static void test_step_refused(void **unused)
{
    (void)unused;
    static const double steps[] = {INFINITY, -INFINITY, NAN, 0, -0.005, 1e-300};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; ++i)
        assert_refused(failure_new(), steps[i], GIC_ERROR_ARGUMENT, NULL);
    Failure *failure = failure_new();
    assert_int_equal(hmmwv_step(&failure->bad, 0.005, (gic_method)7), GIC_ERROR_ARGUMENT);
    assert_refused(failure, 0, GIC_ERROR_ARGUMENT, NULL);
}

static void test_orientation_refused(void **unused)
{
    (void)unused;
    Failure *failure = failure_new();
    failure->bad.state[HMMWV_STATE_E0] = 1.5;
    assert_refused(failure, 0.005, GIC_ERROR_ORIENTATION, NULL);
}

static void hole(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road;
    (void)lane;
    (void)time;
    (void)x;
    (void)y;
    out[0] = NAN;
    out[1] = out[2] = 0;
}

static void test_road_refused(void **unused)
{
    (void)unused;
    static const gic_road nowhere = {hole, NULL, NULL, NULL, GIC_ROAD_OWN};
    Failure *failure = failure_new();
    failure->bad.head.road = &nowhere;
    assert_refused(failure, 0.005, GIC_ERROR_ROAD, NULL);
}

/* Speeds that overflow when they are squared, and a step that leaps: some error, and nothing changes. */
static void test_wild(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; ++i) {
        Failure *failure = failure_new();
        hmmwv *bad = &failure->bad;
        if (i == 0)
            bad->state[HMMWV_STATE_OMEGA_X] = 1e200;
        static hmmwv before;
        hmmwv_snapshot(bad, &before);
        for (int method = GIC_AB3; method <= GIC_RK4; ++method) {
            assert_true(hmmwv_step(bad, i == 0 ? 0.005 : 1e4, (gic_method)method) < 0);
            assert_memory_equal(bad->state, before.state, sizeof bad->state);
            assert_true(hmmwv_time(bad) == hmmwv_time(&before));
        }
        memcpy(bad->state, failure->good.state, sizeof bad->state);
        ride(bad, GIC_AB3, 1);
    }
}

/* The rates are good, but what a step of AB3 makes of them and of rates of the past is no state. */
static void test_bad_history(void **unused)
{
    (void)unused;
    static const double poison[] = {1e13, -1e300, NAN, INFINITY};
    for (size_t i = 0; i < 4; ++i)
        for (int k = 0; k < 2 * HMMWV_STATES; k += 9) {
            Failure *failure = failure_new();
            const double kept = failure->bad.history[k];
            failure->bad.history[k] = poison[i];
            static hmmwv before;
            hmmwv_snapshot(&failure->bad, &before);
            assert_int_equal(hmmwv_step(&failure->bad, 0.005, GIC_AB3), GIC_ERROR_UNSTABLE);
            assert_string_equal(hmmwv_status_state(&failure->bad), hmmwv_model.state[k % HMMWV_STATES].name);
            assert_memory_equal(failure->bad.state, before.state, sizeof before.state);
            assert_memory_equal(failure->bad.history, before.history, sizeof before.history);
            assert_memory_equal(failure->bad.rate, before.rate, sizeof before.rate);
            assert_true(hmmwv_time(&failure->bad) == hmmwv_time(&before));
            failure->bad.history[k] = kept;
            ride(&failure->bad, GIC_AB3, 10);
            ride(&failure->good, GIC_AB3, 10);
            assert_same(&failure->bad, &failure->good);
        }
}

/* Inputs that are not numbers; a driven coordinate out of reach. */
static void test_inputs_refused(void **unused)
{
    (void)unused;
    static steered car;
    for (int i = 0; i < STEERED_INPUTS; ++i) {
        assert_int_equal(steered_setup(&car), GIC_OK);
        car.input[i] = NAN;
        assert_int_equal(steered_step(&car, 0.005, GIC_AB3), GIC_ERROR_INPUT);
        assert_true(steered_time(&car) == 0);
        car.input[i] = 0;
        assert_int_equal(steered_step(&car, 0.005, GIC_AB3), GIC_OK);
    }
    car.input[STEERED_INPUT_RACK] = -1.5;
    assert_int_equal(steered_step(&car, 0.005, GIC_AB3), GIC_ERROR_NEWTON);
    assert_string_equal(steered_status_subset(&car), "wheel_f_l");
    car.input[STEERED_INPUT_RACK] = 0;
    assert_int_equal(steered_step(&car, 0.005, GIC_AB3), GIC_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_snapshot),       cmocka_unit_test(test_interleaved),
        cmocka_unit_test(test_newton_start),   cmocka_unit_test(test_self_test),
        cmocka_unit_test(test_out_of_reach),   cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_step_refused),   cmocka_unit_test(test_orientation_refused),
        cmocka_unit_test(test_road_refused),   cmocka_unit_test(test_wild),
        cmocka_unit_test(test_inputs_refused), cmocka_unit_test(test_march),
        cmocka_unit_test(test_bad_history),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
