/* SPDX-License-Identifier: MIT
 * An instance is `size` bytes wherever its owner puts it: engines write nothing behind it, not even where a coordinate
 * goes so far in a part of a step that bodies follow it piece by piece. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { GUARD = 1 << 16, MARK = 0xa5 };

static void march(const char *name, const char *path, double rate, gic_method method)
{
    Pool *pool = pool_new();
    const Engine *engine = engine_open(pool, name, model_read(pool, path), &(EngineOptions){.quiet = true});
    const gic_model *code = engine->code;
    gic_head *made = instance_new(pool, engine);
    assert_int_equal(code->setup(made), GIC_OK);
    unsigned char *own = NULL;
    assert_int_equal(posix_memalign((void **)&own, 64, code->size + GUARD), 0);
    memcpy(own, made, code->size);
    memset(own + code->size, MARK, GUARD);
    gic_head *self = (gic_head *)(void *)own;
    double *state = instance_array(self, code->state_offset);
    state[code->slow_count / 2] = rate;
    int good = 0;
    for (int i = 0; i < 60; ++i)
        good += gic_step(code, self, 0.01, method) == GIC_OK && code->outputs(self) == GIC_OK;
    assert_int_equal(good, 60);
    for (int i = 0; i < GUARD; ++i)
        assert_int_equal(own[code->size + (size_t)i], MARK);
    free(own);
    engine_close(engine);
    pool_free(pool);
}

static void test_room(void **unused)
{
    (void)unused;
    static const char *const engine[] = {"tcc", "tape", "gic", "gcp1"};
    static const double rate[] = {0, 10, 100, 250}; /* rad/s: up to a turn in half a step */
    for (size_t e = 0; e < sizeof engine / sizeof *engine; ++e)
        for (size_t r = 0; r < sizeof rate / sizeof *rate; ++r) {
            march(engine[e], "models/pendulum.veh", rate[r], GIC_RK4);
            march(engine[e], "models/pendulum.veh", rate[r], GIC_AB3);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_room)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
