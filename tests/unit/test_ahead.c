/* SPDX-License-Identifier: MIT
 * How far a step goes ahead belongs to what a recovery was for: where a subset would reach a singular configuration
 * within a step, the step is refused, whether or not outputs of the same state, which look no step ahead, were asked
 * for before. Generated code and tapes; models in which subsets are kept one by one (hmmwv) and all at once (tires). */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "read/read.h"
#include "run/engines.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const double step = 0.005; /* s */

/* An instance with a past of AB3, so that its next step is one right-hand side, whose spring is long and
 * becomes longer. */
static void *begin(Pool *pool, const Engine *engine, double place)
{
    const gic_model *code = engine->code;
    gic_head *self = instance_new(pool, engine);
    assert_int_equal(code->setup(self), GIC_OK);
    for (int i = 0; i < 5; ++i)
        assert_int_equal(gic_step(code, self, step, GIC_AB3), GIC_OK);
    double *state = instance_array(self, code->state_offset);
    for (int i = 0; i < code->slow_count; ++i)
        if (!strcmp(code->state[i].name, "spring_f_l"))
            state[i] = place;
        else if (!strcmp(code->state[i].name, "spring_f_l.rate"))
            state[i] = 1; /* m/s */
    return self;
}

static void compare(const char *name, const char *model)
{
    Pool *pool = pool_new();
    const Engine *engine = engine_open(pool, name, model_read(pool, model), &(EngineOptions){.quiet = true});
    int good = 0, refused = 0;
    for (double place = 0.33; place < 0.35; place += 0.0002) {
        void *plain = begin(pool, engine, place), *looked = begin(pool, engine, place);
        const int status = engine->code->outputs(looked);
        const int wanted = gic_step(engine->code, plain, step, GIC_AB3);
        assert_true((gic_step(engine->code, looked, step, GIC_AB3) == GIC_OK) == (wanted == GIC_OK));
        good += wanted == GIC_OK;
        refused += status == GIC_OK && wanted != GIC_OK;
    }
    assert_true(good > 0 && refused > 0); /* the bound was crossed, by a step from a state that is good itself */
    engine_close(engine);
    pool_free(pool);
}

static void test_ahead(void **unused)
{
    (void)unused;
    static const char *const engines[] = {"tcc", "tape"}, *const models[] = {"models/hmmwv.veh",
                                                                             "models/hmmwv_tires.veh"};
    for (int e = 0; e < 2; ++e)
        for (int m = 0; m < 2; ++m)
            compare(engines[e], models[m]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ahead)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
