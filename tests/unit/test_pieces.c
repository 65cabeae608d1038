/* SPDX-License-Identifier: MIT
 * Coordinates that jump far, up to five times their range: a recovery by Newton's iteration follows in as many pieces
 * as it needs, or says which way it failed. The tape against compiled code, status by status and digit by digit. */
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

static void compare(const char *path)
{
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    const EngineOptions options = {.solve = SOLVE_REDUCED, .recovery = RECOVERY_NEWTON, .quiet = true};
    const Engine *engine[2] = {engine_open(pool, "tcc", model, &options), engine_open(pool, "tape", model, &options)};
    const gic_model *code = engine[0]->code;
    int good = 0, bad = 0;
    for (int c = 0; c < code->coordinate_count; ++c) {
        const int at = code->coordinate_state[c];
        for (int share = -60; at >= 0 && share <= 60; ++share) {
            int status[2];
            double rate[2][code->slow_count + code->fast_count];
            for (int e = 0; e < 2; ++e) {
                gic_head *self = instance_new(pool, engine[e]);
                const gic_model *own = engine[e]->code;
                assert_int_equal(own->setup(self), GIC_OK);
                double *state = instance_array(self, own->state_offset);
                state[at] += share / 12.0 * (code->coordinate_high[c] - code->coordinate_low[c]);
                memset(rate[e], 0, sizeof rate[e]);
                status[e] = own->rhs(self, 0, state, rate[e]);
            }
            assert_int_equal(status[0], status[1]);
            if (status[0] == GIC_OK)
                assert_memory_equal(rate[0], rate[1], sizeof rate[0]);
            good += status[0] == GIC_OK;
            bad += status[0] != GIC_OK;
        }
    }
    assert_true(good > 100 && bad > 100); /* both within reach and out of it */
    engine_close(engine[0]);
    engine_close(engine[1]);
    pool_free(pool);
}

static void test_pieces(void **unused)
{
    (void)unused;
    static const char *const models[] = {"models/hmmwv.veh", "models/five_link.veh", "models/solid_axle.veh"};
    for (size_t m = 0; m < sizeof models / sizeof *models; ++m)
        compare(models[m]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pieces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
