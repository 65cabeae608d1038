/* SPDX-License-Identifier: MIT
 * Instances of one engine that take turns: a change of gear goes by the state of the instance that is asked, not by
 * that which the engine has looked at last. The selector and the limits of the gears follow coordinates here, so that
 * what must come out is read off the model. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* A slide between two places, 1 m to the front and to the back; turbine and wheels stand still. %s: selector, limits.
 */
static const char model_text[] =
    "gicgen: 1\n"
    "model: cart\n"
    "base: hull\n"
    "bodies:\n"
    "  hull: {mass: 100, com: [0, 0, 1], inertia: [30, 30, 30]}\n"
    "  slide: {mass: 1, com: [1, 0, 1], inertia: [3, 3, 3]}\n"
    "joints:\n"
    "  along: {type: prismatic, bodies: [hull, slide], axis: [1, 0, 0]}\n"
    "coordinates:\n"
    "  place: {type: translation, bodies: [hull, slide], axis: [1, 0, 0], range: [-2, 2]}\n"
    "tires:\n"
    "  all: {type: tmeasy, radius: 0.5, stiffness: 1e5, damping: 1e3, load: 5e3, dfx0: [2e4, 4e4], fxm: [5e3, 1e4],\n"
    "        fxs: [4e3, 8e3], dfy0: [2e4, 4e4], fym: [5e3, 1e4], fys: [4e3, 8e3], sxm: [0.5, 0.5], sxs: [1, 1],\n"
    "        sym: [0.5, 0.5], sys: [1, 1], trail: [0.1, 0.1], sq0: [0.5, 0.5], sqe: [1, 1]}\n"
    "wheels:\n"
    "  left: {body: hull, center: [1, 0.5, 0.5], tire: all, spin_inertia: 1}\n"
    "  right: {body: hull, center: [1, -0.5, 0.5], tire: all, spin_inertia: 1}\n"
    "tables:\n"
    "  capacity: {x: [0, 1], y: [9, 30]}\n"
    "  multiplication: {x: [0, 1], y: [2, 1]}\n"
    "powertrain:\n"
    "  engine: {inertia: 0.2, throttle: 0, torque: 0}\n"
    "  converter: {capacity: capacity, torque: multiplication}\n"
    "  transmission: {forward: [3, 1], reverse: [-3], %s}\n"
    "  differentials:\n"
    "    axle: {outputs: [left, right], ratio: 2}\n";

/* Selector or limits, and the gear at both places: 1 m in front and at the back. */
typedef struct Case {
    const char *text;
    int gear[2];
} Case;

static const Case cases[] = {
    {"selector: place, up: [100], down: [-100]", {1, -1}},
    {"up: [-10 * place], down: [-100]", {2, 1}},
};

static const Model *read_text(Pool *pool, const char *text)
{
    char path[] = "/tmp/test_turns_XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text) && !close(file));
    const Model *model = model_read(pool, path);
    unlink(path);
    return model;
}

static gic_head *stand(Pool *pool, const Engine *engine, double place)
{
    gic_head *self = instance_new(pool, engine);
    double standard[engine->standard_count];
    memset(standard, 0, sizeof standard);
    standard[3] = 1;
    for (int i = 0; i < engine->standard_count; ++i)
        if (!strcmp(engine->standard[i].name, "place"))
            standard[i] = place;
        else if (!strcmp(engine->standard[i].name, "transmission.age"))
            standard[i] = 100;
    assert_int_equal(engine->code->setup(self), GIC_OK);
    assert_int_equal(engine_enter(engine, self, standard), GIC_OK);
    return self;
}

static int gear_of(const gic_model *code, const gic_head *self)
{
    const int32_t *discrete = (const int32_t *)(const void *)((const char *)self + code->discrete_offset);
    int i = 0;
    while (strcmp(code->discrete[i].name, "transmission.gear"))
        assert_true(++i < code->discrete_count);
    return discrete[i];
}

/* Each is asked after the other has been looked at. */
static void take_turns(const char *name, const Case *wanted)
{
    Pool *pool = pool_new();
    const Model *model = read_text(pool, pool_print(pool, model_text, wanted->text));
    const EngineOptions options = {.solve = SOLVE_REDUCED, .quiet = true};
    const Engine *engine = engine_open(pool, name, model, &options);
    const gic_model *code = engine->code;
    gic_head *self[2] = {stand(pool, engine, 1), stand(pool, engine, -1)};
    for (int asked = 0; asked < 2; ++asked) {
        gic_head *other = self[!asked];
        assert_int_equal(code->outputs(other), GIC_OK);
        code->shift(self[asked]);
        const int gear = gear_of(code, self[asked]);
        if (gear != wanted->gear[asked])
            fail_msg("%s, %s: gear %d at place %d", name, wanted->text, gear, asked ? -1 : 1);
    }
    engine_close(engine);
    pool_free(pool);
}

static void test_turns(void **unused)
{
    (void)unused;
    static const char *const engine[] = {"tcc", "tape", "gic", "gcp1"};
    for (size_t e = 0; e < sizeof engine / sizeof *engine; ++e)
        for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c)
            take_turns(engine[e], &cases[c]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_turns)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
