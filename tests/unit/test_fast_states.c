/* SPDX-License-Identifier: MIT
 * Fast states in scenes and in evaluating states, with a hand-made engine: that numbers get to the names they belong
 * to, whatever the engine's own state looks like. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <math.h>

#include "base/file.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/run.h"
#include "scene/scene.h"
#include "sequence/sequence.h"

static const char model_text[] =
    "gicgen: 1\n"
    "model: cart\n"
    "base: hull\n"
    "bodies:\n"
    "  hull: {mass: 10, com: [0, 0, 1], inertia: [1, 1, 1]}\n"
    "  slide: {mass: 1, com: [1, 0, 1], inertia: [3, 3, 3]}\n"
    "joints:\n"
    "  up: {type: prismatic, bodies: [hull, slide], axis: [0, 0, 1]}\n"
    "coordinates:\n"
    "  lift: {type: translation, bodies: [hull, slide], axis: [0, 0, 1], design: 0.02}\n"
    "tires:\n"
    "  all: {type: tmeasy, radius: 0.5, stiffness: 1e5, damping: 1e3, load: 5e3, dfx0: [2e4, 4e4], fxm: [5e3, 1e4],\n"
    "        fxs: [4e3, 8e3], dfy0: [2e4, 4e4], fym: [5e3, 1e4], fys: [4e3, 8e3], sxm: [0.5, 0.5], sxs: [1, 1],\n"
    "        sym: [0.5, 0.5], sys: [1, 1], trail: [0.1, 0.1], sq0: [0.5, 0.5], sqe: [1, 1]}\n"
    "wheels:\n"
    "  left: {body: slide, center: [1, 0.5, 0.5], tire: all, spin_inertia: 1, brake: 100}\n"
    "  plain: {body: slide, center: [1, 0, 0.5], radius: 0.5, stiffness: 1e5, damping: 0}\n"
    "  right: {body: slide, center: [1, -0.5, 0.5], tire: all, spin_inertia: 1}\n";

enum { SLOW = 15, FAST = 7, EXTRA = 4, MOST = SLOW + FAST + EXTRA };

static const char *const fast_name[FAST] = {"left.spin",  "left.slip_x",  "left.slip_y", "left.brake",
                                            "right.spin", "right.slip_x", "right.slip_y"};

/* ---- an engine whose rates are its state doubled, and whose poses and outputs are nothing ---------------- */

typedef struct Fake {
    Instance instance; /* context: the descriptor */
    double state[MOST], rate[MOST], history[2 * MOST], scratch[GIC_SCRATCH(MOST, 0)], output[32], none[1];
    int calls[2]; /* right-hand sides, evaluations of fast rates */
} Fake;

static int slow_count(const Fake *fake)
{
    return ((const gic_model *)fake->instance.context)->slow_count;
}

static int fake_setup_with(void *self, const double *parameter)
{
    Fake *fake = self;
    (void)parameter;
    memset(fake->state, 0, sizeof fake->state);
    fake->state[3] = 1;
    return GIC_OK;
}

static int fake_setup(void *self)
{
    return fake_setup_with(self, NULL);
}

static int fake_rhs(void *self, double time, const double *state, double *rate)
{
    Fake *fake = self;
    (void)time;
    ++fake->calls[0];
    for (int i = 0; i < slow_count(fake) + FAST; ++i)
        rate[i] = 2 * state[i];
    return GIC_OK;
}

static int fake_settle(void *self, double *state)
{
    (void)self;
    (void)state;
    return GIC_OK;
}

static int fake_outputs(void *self)
{
    (void)self;
    return GIC_OK;
}

static int fake_poses(void *self, double *pose)
{
    (void)self;
    memset(pose, 0, 2 * 7 * sizeof *pose);
    return GIC_OK;
}

static int fake_self_test(void *self, gic_self_test *result)
{
    (void)self;
    memset(result, 0, sizeof *result);
    return GIC_OK;
}

static int fake_link(void *self, double time, const double *slow, double *link)
{
    (void)self;
    (void)time;
    (void)slow;
    (void)link;
    return GIC_OK;
}

static int fake_fast(void *self, double time, const double *link, const double *fast, double *rate)
{
    (void)time;
    (void)link;
    ++((Fake *)self)->calls[1];
    for (int i = 0; i < FAST; ++i)
        rate[i] = 2 * fast[i];
    return GIC_OK;
}

static int fake_roll(void *self)
{
    Fake *fake = self;
    for (int i = 0; i < FAST; ++i)
        fake->state[slow_count(fake) + i] = 100 + i;
    return GIC_OK;
}

/* An own slow state: the standard one backwards behind EXTRA numbers. */
static int fake_enter(gic_head *self, const double *standard)
{
    double *state = ((Fake *)(void *)self)->state;
    for (int i = 0; i < SLOW; ++i)
        state[EXTRA + SLOW - 1 - i] = standard[i];
    return GIC_OK;
}

static void fake_leave(const gic_head *self, double *standard, double *rate)
{
    const double *state = ((const Fake *)(const void *)self)->state;
    for (int i = 0; i < SLOW; ++i) {
        standard[i] = state[EXTRA + SLOW - 1 - i];
        rate[i] = 2 * standard[i];
    }
}

/* What a test works with. */
typedef struct Bench {
    Pool *pool;
    const Model *model;
    gic_model code;
    Engine engine;
    Fake *fake;
    double *fast; /* of the instance */
} Bench;

static char *write_temporary(Pool *pool, const char *text)
{
    char *path = pool_print(pool, "%s/test-fast-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    return path;
}

/* own: does the engine have a slow state of its own? */
static void bench_open(Bench *bench, bool own)
{
    memset(bench, 0, sizeof *bench);
    bench->pool = pool_new();
    char *path = write_temporary(bench->pool, model_text);
    bench->model = model_read(bench->pool, path);
    unlink(path);
    bench->code = descriptor_new(bench->pool, bench->model, &(Sequence){.subsets = 0});
    gic_model *code = &bench->code;
    assert_int_equal(code->slow_count, SLOW);
    assert_int_equal(code->fast_count, FAST);
    for (int i = 0; i < FAST; ++i)
        assert_string_equal(code->state[SLOW + i].name, fast_name[i]);
    bench->engine =
        (Engine){.name = "fake", .code = code, .context = code, .standard = code->state, .standard_count = SLOW + FAST};
    if (own) {
        bench->engine.enter = fake_enter;
        bench->engine.leave = fake_leave;
        code->slow_count = SLOW + EXTRA;
    }
    code->size = sizeof(Fake);
    code->state_offset = offsetof(Fake, state);
    code->rate_offset = offsetof(Fake, rate);
    code->input_offset = code->parameter_offset = code->port_offset = code->link_offset = offsetof(Fake, none);
    code->output_offset = offsetof(Fake, output);
    code->history_offset = offsetof(Fake, history);
    code->scratch_offset = offsetof(Fake, scratch);
    code->setup = fake_setup;
    code->setup_with = fake_setup_with;
    code->rhs = fake_rhs;
    code->settle = fake_settle;
    code->outputs = fake_outputs;
    code->poses = fake_poses;
    code->self_test = fake_self_test;
    code->link = fake_link;
    code->fast = fake_fast;
    code->roll = fake_roll;
    bench->fake = (Fake *)(void *)instance_new(bench->pool, &bench->engine);
    bench->fast = bench->fake->state + code->slow_count;
}

static const Scene *scene_of(const Bench *bench, const char *text)
{
    char *path =
        write_temporary(bench->pool, pool_print(bench->pool, "gicscene: 1\nduration: 1\nstep: 0.01\n%s", text));
    const Scene *scene = scene_read(bench->pool, path, bench->model, NULL, 0);
    unlink(path);
    return scene;
}

/* ---- tests -------------------------------------------------------------------------------------------------- */

static void test_names(void **unused)
{
    (void)unused;
    Bench bench;
    bench_open(&bench, false);
    const gic_signal *signal = descriptor_fast_states(bench.pool, bench.model);
    const char *const unit[FAST] = {"rad/s", "1", "1", "1", "rad/s", "1", "1"};
    assert_int_equal(bench.model->fast_states, FAST);
    for (int i = 0; i < FAST; ++i) {
        assert_string_equal(signal[i].name, fast_name[i]);
        assert_string_equal(signal[i].unit, unit[i]);
    }
    pool_free(bench.pool);
}

/* Wheels roll but for what the scene says, and slow states are not mistaken for fast ones. */
static void test_start(void **unused)
{
    (void)unused;
    for (int own = 0; own < 2; ++own) {
        Bench bench;
        bench_open(&bench, own);
        const Scene *scene = scene_of(&bench, "initial:\n  position: [7, 8, 9]\n  velocity: [1, 2, 3]\n"
                                              "  coordinates: {lift: 0.03}\n  rates: {lift: 4}\n"
                                              "  states: {right.spin: -12.5, left.brake: 0}\n");
        assert_int_equal(scene_start(&bench.engine, scene, &bench.fake->instance.head), GIC_OK);
        double state[SLOW + FAST], rate[SLOW + FAST];
        assert_int_equal(engine_look(&bench.engine, &bench.fake->instance.head, state, rate), GIC_OK);
        const double expected[SLOW + FAST] = {7, 8, 9, 1, 0,   0,   0,   0.03, 1,     2,   3,
                                              0, 0, 0, 4, 100, 101, 102, 0,    -12.5, 105, 106};
        for (int i = 0; i < SLOW + FAST; ++i) {
            assert_true(state[i] == expected[i]);
            assert_true(rate[i] == 2 * expected[i]);
        }
        assert_memory_equal(bench.fast, expected + SLOW, FAST * sizeof *bench.fast);
        pool_free(bench.pool);
    }
}

/* From the third step on one right-hand side and ratio - 1 evaluations of fast rates. */
static void test_ratio(void **unused)
{
    (void)unused;
    Bench bench;
    bench_open(&bench, false);
    const Scene *scene = scene_of(&bench, "ratio: 7\n");
    assert_int_equal(scene->ratio, 7);
    assert_int_equal(scene_start(&bench.engine, scene, &bench.fake->instance.head), GIC_OK);
    for (int k = 0; k < 3; ++k) {
        memset(bench.fake->calls, 0, sizeof bench.fake->calls);
        assert_int_equal(scene_step(&bench.engine, &bench.code, scene, NULL, &bench.fake->instance.head, 0), GIC_OK);
    }
    assert_int_equal(bench.fake->calls[0], 1);
    assert_int_equal(bench.fake->calls[1], 6);
    assert_int_equal(bench.fake->instance.head.fast_count, 6);
    assert_int_equal(bench.fake->instance.head.ratio, 7);

    assert_int_equal(scene_of(&bench, "")->ratio, 1);
    /* a scene that is run with another integrator */
    Scene other = *scene;
    other.method = GIC_RK4;
    assert_int_equal(scene_step(&bench.engine, &bench.code, &other, NULL, &bench.fake->instance.head, 0), GIC_OK);
    assert_int_equal(bench.fake->instance.head.ratio, 1);
    pool_free(bench.pool);
}

/* The number below a column's name. */
static double cell(const char *results, const char *column)
{
    const char *line = strchr(results, '\n') + 1, *name = results;
    while (strncmp(name, column, strlen(column))) {
        name = strpbrk(name, ",\n");
        line = strpbrk(line, ",\n");
        if (!name || *name == '\n' || !line)
            fail_msg("no column '%s' in %s", column, results);
        ++name;
        ++line;
    }
    return strtod(line, NULL);
}

static void test_evaluate(void **unused)
{
    (void)unused;
    for (int own = 0; own < 2; ++own) {
        Bench bench;
        bench_open(&bench, own);
        /* columns of fast states may be missing, and what was in the row before is no default */
        const char *states = write_temporary(
            bench.pool, "right.spin [rad/s],lift,left.slip_y,r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,"
                        "omega.z,lift.rate\n8,0.01,0.25,0,0,0,1,0,0,0,5,6,7,0,0,0,9\n");
        const char *path = write_temporary(bench.pool, "");
        evaluate(bench.pool, &bench.engine, NULL, &(Request){.states = states, .results = path});
        size_t size;
        const char *results = file_read(bench.pool, path, TEXT_MOST, &size);
        assert_true(cell(results, "a.x [m/s^2]") == 10);
        assert_true(cell(results, "lift.acceleration [m/s^2]") == 18);
        assert_true(cell(results, "left.spin.rate [rad/s^2]") == 0);
        assert_true(cell(results, "left.slip_y.rate [1/s]") == 0.5);
        assert_true(cell(results, "right.spin.rate [rad/s^2]") == 16);
        assert_true(cell(results, "right.slip_y.rate [1/s]") == 0);
        assert_true(cell(results, "status") == 0);
        unlink(states);
        unlink(path);
        pool_free(bench.pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_start),
        cmocka_unit_test(test_ratio),
        cmocka_unit_test(test_evaluate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
