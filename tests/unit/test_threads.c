/* SPDX-License-Identifier: MIT
 * Generated code is reentrant: eight threads that step eight vehicles at once end with the bits of one thread that
 * steps them one after another. */
#include "hmmwv.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { THREADS = 8, STEPS = 4000 };

/* Waves that each lane meets at its own place. */
static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_real s = x - 2 - lane;
    (void)road, (void)time, (void)y;
    out[0] = s > 0 && s < 1 ? s * s * (1 - s) * (1 - s) : 0;
    out[1] = out[2] = 0;
}

static const gic_road road = {height, NULL, NULL, NULL, GIC_ROAD_OWN};

static void *drive(void *vehicle)
{
    hmmwv *car = vehicle;
    const int32_t lane = car->head.lane;
    int status = hmmwv_setup(car);
    car->head.lane = lane;
    car->head.road = &road;
    car->state[HMMWV_STATE_V_X] = 5 + lane;
    car->state[HMMWV_STATE_OMEGA_Z] = 0.1 * lane;
    for (int step = 0; status == GIC_OK && step < STEPS; ++step)
        status = hmmwv_step(car, 0.005, lane % 2 ? GIC_RK4 : GIC_AB3);
    return status == GIC_OK ? car : NULL;
}

static void test_eight_at_once(void **state)
{
    static hmmwv alone[THREADS], together[THREADS];
    pthread_t thread[THREADS];
    (void)state;
    for (int i = 0; i < THREADS; ++i) {
        alone[i].head.lane = together[i].head.lane = i;
        assert_non_null(drive(&alone[i]));
    }
    for (int i = 0; i < THREADS; ++i)
        assert_int_equal(pthread_create(&thread[i], NULL, drive, &together[i]), 0);
    for (int i = 0; i < THREADS; ++i) {
        void *result;
        assert_int_equal(pthread_join(thread[i], &result), 0);
        assert_non_null(result);
    }
    for (int i = 0; i < THREADS; ++i) {
        assert_memory_equal(&alone[i], &together[i], sizeof alone[i]);
        if (i)
            assert_memory_not_equal(alone[i].state, alone[i - 1].state, sizeof alone[i].state);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_eight_at_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
