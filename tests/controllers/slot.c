/* SPDX-License-Identifier: MIT
 * A controller in C in place of formulas: `slot` is `loop` (loop.veh.in) whose rule `force` has no formula. Both have
 * the same bits; an instance copied in the middle goes on with the same bits, a value that is no number ends in a
 * status and leaves everything as it was, and after gic_restart the next sample is the first one that is not before the
 * time. */
#include "loop.h"
#include "slot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("slot.c:%d: %s\n", __LINE__, #condition); \
            return 1; \
        } \
    } while (0)

typedef struct Servo {
    int samples;
    double last; /* time of the latest sample */
    int broken;  /* return what is no number */
} Servo;

static void servo(void *user, int32_t lane, int32_t controller, gic_real time, const gic_real *output, gic_real *rule)
{
    Servo *own = (Servo *)user;
    (void)lane;
    if (controller != 0) /* the first one of the file */
        return;
    const double error = 1 - output[SLOT_OUTPUT_X_VALUE];
    rule[0] = 8 * error - 6 * output[SLOT_OUTPUT_X_RATE] + output[SLOT_OUTPUT_SERVO_SUM_NEXT] -
              0.25 * output[SLOT_OUTPUT_X_ACCELERATION] + 0.125 * output[SLOT_OUTPUT_MEAN];
    ++own->samples;
    own->last = time;
    if (own->broken)
        rule[0] = NAN;
}

static int same(const loop *a, const slot *b)
{
    return fabs(a->state[LOOP_STATE_X] - b->state[SLOT_STATE_X]) < 1e-13 &&
           fabs(a->state[LOOP_STATE_SERVO_FORCE] - b->state[SLOT_STATE_SERVO_FORCE]) < 1e-12;
}

int main(void)
{
    static loop formulas;
    static slot vehicle, copy, before;
    Servo own = {0};
    CHECK(loop_setup(&formulas) == GIC_OK && slot_setup(&vehicle) == GIC_OK);
    vehicle.head.controller_function = servo;
    vehicle.head.user = &own;
    for (int i = 0; i < 200; ++i) {
        CHECK(loop_step(&formulas, 0.009, GIC_AB3) == GIC_OK && slot_step(&vehicle, 0.009, GIC_AB3) == GIC_OK);
        CHECK(same(&formulas, &vehicle));
        if (i == 100)
            slot_snapshot(&vehicle, &copy);
        if (i > 100) {
            CHECK(slot_step(&copy, 0.009, GIC_AB3) == GIC_OK);
            CHECK(!memcmp(copy.state, vehicle.state, sizeof copy.state));
            CHECK(!memcmp(copy.rate, vehicle.rate, sizeof copy.rate));
        }
    }
    /* 1.8 s of samples every 0.07 s from 0 on, and those of the copy since 0.909 s */
    CHECK(own.samples == 26 + 26 - 13);

    /* a broken controller: the step that has a sample fails, and changes nothing */
    own.broken = 1;
    int failed = 0;
    for (int i = 0; i < 20 && !failed; ++i) {
        slot_snapshot(&vehicle, &before);
        failed = slot_step(&vehicle, 0.009, GIC_AB3) != GIC_OK;
    }
    CHECK(failed && !memcmp(before.state, vehicle.state, sizeof before.state));
    CHECK(slot_time(&before) == slot_time(&vehicle) && before.head.history == vehicle.head.history);
    CHECK(slot_status_state(&vehicle) && !strcmp(slot_status_state(&vehicle), "servo.force"));
    own.broken = 0;
    CHECK(slot_step(&vehicle, 0.009, GIC_AB3) == GIC_OK && slot_step(&before, 0.009, GIC_AB3) == GIC_OK);
    CHECK(!memcmp(before.state, vehicle.state, sizeof before.state));

    /* the time moves: on to 100.02 s, whose next sample is 1429 * 0.07 = 100.03, and back to 0.01 */
    gic_restart(&vehicle, 100.02);
    for (int i = 0; i < 2; ++i)
        CHECK(slot_step(&vehicle, 0.009, GIC_RK4) == GIC_OK);
    CHECK(fabs(own.last - 100.03) < 1e-9);
    gic_restart(&vehicle, 0.01);
    for (int i = 0; i < 7; ++i)
        CHECK(slot_step(&vehicle, 0.009, GIC_RK4) == GIC_OK);
    CHECK(fabs(own.last - 0.07) < 1e-12);

    /* an integrator of one's own: samples by gic_sample, whose next time is told */
    gic_real next;
    gic_restart(&vehicle, 0.07 * 30);
    CHECK(gic_sample(&slot_model, &vehicle, &next) == GIC_OK);
    CHECK(fabs(own.last - 2.1) < 1e-12 && next > 2.1 && next <= 2.17 + 1e-12);
    puts("ok");
    return 0;
}
