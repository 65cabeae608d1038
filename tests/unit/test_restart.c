/* SPDX-License-Identifier: MIT
 * variable_restart() forgets everything about the motion before it: at a constant speed that jumps there, each step is
 * exact but for rounding, also the first one after the jump. */
#include "gic_runtime.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A point on a line, m. */
typedef struct Point {
    gic_head head;
    double state[1], rate[1], history[GIC_HISTORY(1, 0)], scratch[GIC_SCRATCH(1, 0)];
    double speed; /* m/s */
} Point;

static int point_rhs(void *self, double time, const double *state, double *rate)
{
    (void)time;
    (void)state;
    rate[0] = ((const Point *)self)->speed;
    return GIC_OK;
}

static int point_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 1) ? GIC_OK : GIC_ERROR_INPUT;
}

static const gic_model point_model = {.abi_version = GIC_ABI_VERSION,
                                      .real_size = sizeof(gic_real),
                                      .size = sizeof(Point),
                                      .slow_count = 1,
                                      .state_offset = offsetof(Point, state),
                                      .rate_offset = offsetof(Point, rate),
                                      .history_offset = offsetof(Point, history),
                                      .scratch_offset = offsetof(Point, scratch),
                                      .rhs = point_rhs,
                                      .settle = point_settle};

static void test_speed_jumps(void **state)
{
    static const int32_t method[] = {METHOD_ADAMS, METHOD_RKCK};
    static const double speed[] = {1, -3, 0, 0.25};
    const double rounding = 1e-15; /* of places below 2 m */
    (void)state;
    for (int m = 0; m < 2; ++m) {
        Point point = {.speed = 0};
        Variable *variable = variable_open(&point_model, method[m], 1e-6);
        assert_non_null(variable);
        for (int i = 0; i < 4; ++i) {
            point.speed = speed[i];
            variable_restart(variable);
            while (gic_time(&point) < 0.5 * (i + 1)) {
                const double time = gic_time(&point), place = point.state[0];
                assert_int_equal(variable_step(variable, &point, 0.5 * (i + 1)), GIC_OK);
                assert_true(fabs(point.state[0] - place - speed[i] * (gic_time(&point) - time)) <= rounding);
            }
        }
        variable_close(variable);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_speed_jumps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
