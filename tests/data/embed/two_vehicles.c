/* SPDX-License-Identifier: MIT
 * A program of somebody who has read hmmwv.h, gic_runtime.h and gic_road.h: two vehicles over bumps beside a pendulum,
 * in one process, a step that fails and what is done about it. C and C++, double or float. Prints where the vehicles
 * are. */
#include "gic_road.h"
#include "hmmwv.h"
#include "pendulum.h"

#include <stdio.h>

/* left and right tracks differ; at y = -20 there is nothing */
static const gic_bump bumps[] = {{GIC_R(2.0), GIC_R(2.0), GIC_R(0.05), GIC_R(0.0), GIC_R(2.0)},
                                 {GIC_R(4.0), GIC_R(1.5), GIC_R(0.03), GIC_R(-2.0), GIC_R(0.0)}};

typedef struct Fleet {
    gic_road_bumps road;
    hmmwv car[2];
    pendulum clock;
} Fleet;

static int report(const char *what, const char *subset, int status)
{
    fprintf(stderr, "%s: %s%s%s\n", what, hmmwv_status_text(status), subset ? ": " : "", subset ? subset : "");
    return 1;
}

static int start(Fleet *fleet)
{
    int i;
    fleet->road.head.height = gic_bumps_height;
    fleet->road.bump = bumps;
    fleet->road.count = 2;
    if (gic_road_bumps_setup(&fleet->road) != GIC_OK)
        return 1;
    for (i = 0; i < 2; ++i) {
        hmmwv *car = &fleet->car[i];
        const int status = hmmwv_setup(car);
        if (status != GIC_OK)
            return report("set up", hmmwv_status_subset(car), status);
        car->head.road = &fleet->road.head;
        car->head.lane = i;
        car->state[HMMWV_STATE_V_X] = GIC_R(5.0);
        car->state[HMMWV_STATE_R_Y] = i ? GIC_R(-20.0) : GIC_R(0.0);
    }
    return pendulum_setup(&fleet->clock) == GIC_OK ? 0 : 1;
}

int main(void)
{
    static Fleet fleet;
    static hmmwv kept;
    int step, i, status;
    if (start(&fleet))
        return 1;
    for (step = 0; step < 400; ++step) {
        for (i = 0; i < 2; ++i) {
            hmmwv *car = &fleet.car[i];
            status = hmmwv_step(car, GIC_R(0.005), GIC_AB3);
            if (status != GIC_OK)
                return report("step", hmmwv_status_subset(car), status);
        }
        if (pendulum_step(&fleet.clock, GIC_R(0.005), GIC_RK4) != GIC_OK)
            return 1;
    }

    /* a mistake of the program does no harm: the vehicle stays as it was, and says what is wrong */
    hmmwv_snapshot(&fleet.car[0], &kept);
    fleet.car[0].state[HMMWV_STATE_SPRING_R_L] = GIC_R(3.0);
    status = hmmwv_step(&fleet.car[0], GIC_R(0.005), GIC_AB3);
    if (status == GIC_OK || !hmmwv_status_subset(&fleet.car[0]))
        return report("a spring of 3 m", NULL, status);
    hmmwv_restore(&fleet.car[0], &kept);

    for (i = 0; i < 2; ++i) {
        hmmwv *car = &fleet.car[i];
        gic_real pose[7 * HMMWV_BODIES];
        gic_self_test test;
        status = hmmwv_outputs(car);
        if (status == GIC_OK)
            status = hmmwv_poses(car, pose);
        if (status == GIC_OK)
            status = hmmwv_self_test(car, &test);
        if (status != GIC_OK)
            return report("outputs", hmmwv_status_subset(car), status);
        if (pose[2] != car->output[HMMWV_OUTPUT_CHASSIS_Z])
            return report("chassis is the first body", NULL, GIC_OK);
        printf("%.9g %.9g %.9g %.9g\n", (double)hmmwv_time(car), (double)pose[0], (double)pose[2],
               (double)car->output[HMMWV_OUTPUT_WHEEL_F_L_Z]);
    }
    if (pendulum_outputs(&fleet.clock) != GIC_OK)
        return 1;
    printf("%.9g %.9g %.9g %.9g\n", (double)pendulum_time(&fleet.clock),
           (double)fleet.clock.output[PENDULUM_OUTPUT_BOB_X], (double)fleet.clock.output[PENDULUM_OUTPUT_BOB_Z],
           (double)fleet.clock.output[PENDULUM_OUTPUT_ANGLE_VALUE]);
    return 0;
}
