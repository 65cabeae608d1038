/* SPDX-License-Identifier: MIT
 * The states at which generated code is validated (generator/validate/states.c): the design, both ends of each range
 * and what is between them, and nothing beyond; for a scene what its inputs are at the time of the state. */
#include "base/pool.h"
#include "model/model.h"
#include "read/read.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "validate/run.h"
#include "validate/validate_private.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>
#include <cmocka.h>

enum { LOOKS = 40 };

static const char text[] = "gicgen: 1\n"
                           "model: arms\n"
                           "base: ground\n"
                           "bodies:\n"
                           "  arm: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}\n"
                           "  lift: {mass: 1, com: [1, 1, 0], inertia: [1, 1, 1]}\n"
                           "  wheel: {mass: 1, com: [0, 2, 0], inertia: [1, 1, 1]}\n"
                           "joints:\n"
                           "  arm: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}\n"
                           "  lift: {type: prismatic, bodies: [ground, lift], axis: [0, 0, 1]}\n"
                           "  wheel: {type: revolute, bodies: [ground, wheel], point: [0, 2, 0], axis: [0, 1, 0]}\n"
                           "inputs: {push: {}, pull: {}}\n"
                           "coordinates:\n"
                           "  arm: {type: angle, bodies: [ground, arm], axis: [0, 1, 0], range: [-0.4, 0.7]}\n"
                           "  lift: {type: translation, bodies: [ground, lift], axis: [0, 0, 1], range: [-0.2, 0.5]}\n"
                           "  wheel: {type: angle, bodies: [ground, wheel], axis: [0, 1, 0], range: [-40, 60]}\n"
                           "forces:\n"
                           "  push: {type: force, coordinate: arm, value: push + 2 * pull}\n";

static const double range[3][2] = {{-0.4, 0.7}, {-0.2, 0.5}, {-4.7123889803846899, 4.7123889803846899}};

static Validator open_arms(Pool *pool)
{
    char path[] = "/tmp/test_states_XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, sizeof text - 1), sizeof text - 1);
    close(file);
    const Model *model = model_read(pool, path);
    unlink(path);
    const Sequence *sequence = sequence_find(pool, model);
    model = model_assemble(pool, model, sequence);
    const Formulation *f = formulate(pool, model, sequence, SOLVE_REDUCED, RECOVERY_AUTO);
    Validator v = {.pool = pool, .model = f->model, .run = run_new(pool, f, NULL)};
    kinks_find(&v);
    return v;
}

/* The ends of each range are looked at, by a coordinate alone and by all; nothing is beyond them. An angle that goes
 * around goes three quarters of a turn to each side. */
static void test_ranges(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    Validator v = open_arms(pool);
    int at_end[3][2] = {{0}}, between[3] = {0}, positive[3] = {0}, negative[3] = {0};
    for (int i = 0; i < LOOKS; ++i) {
        state_place(&v, i, 0);
        for (int c = 0; c < 3; ++c) {
            const double x = v.run->y[v.run->plan->coordinate_state[c]][0];
            assert_true(x >= range[c][0] && x <= range[c][1]);
            assert_true(i || x == 0);
            at_end[c][0] += x == range[c][0];
            at_end[c][1] += x == range[c][1];
            between[c] += x > range[c][0] && x < range[c][1] && x != 0;
            positive[c] += x > 0;
            negative[c] += x < 0;
        }
    }
    for (int c = 0; c < 3; ++c) {
        assert_true(at_end[c][0] > 1 && at_end[c][1] > 1);
        assert_true(between[c] > LOOKS / 8 && positive[c] > LOOKS / 8 && negative[c] > LOOKS / 8);
    }
    pool_free(pool);
}

static void scene_inputs(void *context, int32_t unused, double time, double *input)
{
    (void)context;
    (void)unused;
    input[0] = 3 * time + 1;
    input[1] = 7;
}

/* An input that follows from time has what it has then; one that is free has other values, too. */
static void test_inputs(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    Validator v = open_arms(pool);
    const bool fixed[2] = {false, false}, any[2] = {false, true};
    const double input[2] = {0};
    const Validation scene = {.inputs = scene_inputs, .duration = 5, .free = any};
    const Facts facts = {.fixed = fixed, .input = input};
    v.scene = &scene;
    v.facts = &facts;
    int late = 0, other = 0;
    for (int i = 0; i < LOOKS; ++i) {
        state_place(&v, i, 0);
        const double time = v.run->time[0];
        assert_true(time >= 0 && time <= 5 && (i || time == 0));
        assert_true(fabs(v.run->u[0][0] - (3 * time + 1)) < 1e-14);
        late += time > 2.5;
        other += v.run->u[1][0] != 7;
    }
    assert_true(late > LOOKS / 8 && other > LOOKS / 8);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ranges), cmocka_unit_test(test_inputs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
