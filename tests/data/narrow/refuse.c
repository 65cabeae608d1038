/* SPDX-License-Identifier: MIT
 * Every assumption of code for tests/data/narrow/coast.scene, broken: a status that names it, and nothing touched. */
#include "narrow.h"

#include <stdio.h>
#include <string.h>

static int failed, passed;

static void check(int good, const char *what)
{
    passed += good;
    failed += !good;
    if (!good)
        printf("FAILED: %s\n", what);
}

static void some_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = out[2] = 0;
}

static const gic_road other_road = {some_height, NULL, NULL, NULL, GIC_ROAD_OWN};

/* All calls end with the status, named so, and leave state, outputs and time as they were; then it goes on. */
static void refuses(hmmwv_vehicle *vehicle, const hmmwv_vehicle *good, const char *named)
{
    const gic_model *model = &hmmwv_vehicle_model;
    const hmmwv_vehicle before = *vehicle;
    gic_real rate[HMMWV_VEHICLE_STATES], pose[7 * HMMWV_VEHICLE_BODIES], fast[HMMWV_VEHICLE_STATES];
    gic_self_test test;
    int status[6];
    const char *text;
    status[0] = hmmwv_vehicle_rhs(vehicle, 0, vehicle->state, rate);
    text = hmmwv_vehicle_status_condition(vehicle);
    check(text && strstr(text, named), named);
    status[1] = gic_step(model, vehicle, GIC_R(0.001), GIC_RK4);
    status[2] = gic_step_dual(model, vehicle, GIC_R(0.001), 4);
    status[3] = hmmwv_vehicle_outputs(vehicle);
    status[4] = hmmwv_vehicle_poses(vehicle, pose);
    status[5] = hmmwv_vehicle_self_test(vehicle, &test);
    for (int i = 0; i < 6; ++i)
        check(status[i] == GIC_ERROR_ASSUMPTION, named);
    check(model->fast(vehicle, 0, vehicle->link, vehicle->state + HMMWV_VEHICLE_SLOW, fast) == GIC_ERROR_ASSUMPTION,
          named);
    check(!memcmp(vehicle->state, before.state, sizeof before.state), "state untouched");
    check(!memcmp(vehicle->output, before.output, sizeof before.output), "outputs untouched");
    check(gic_time(vehicle) == gic_time(&before), "time untouched");
    *vehicle = *good;
    check(gic_step(model, vehicle, GIC_R(0.001), GIC_RK4) == GIC_OK, "goes on");
    *vehicle = *good;
}

int main(void)
{
    static hmmwv_vehicle vehicle, good;
    gic_real parameter[HMMWV_VEHICLE_PARAMETER_ROOM] = {0};
    check(hmmwv_vehicle_setup(&vehicle) == GIC_OK, "set-up satisfies its own assumptions");
    check(hmmwv_vehicle_outputs(&vehicle) == GIC_OK, "outputs");
    good = vehicle;
    for (int i = 0; i < HMMWV_VEHICLE_INPUTS; ++i) {
        vehicle.input[i] += GIC_R(1e-9);
        refuses(&vehicle, &good, hmmwv_vehicle_model.input[i].name);
    }
    for (int i = 0; i < HMMWV_VEHICLE_PORTS; ++i) {
        vehicle.port[i] = 1;
        refuses(&vehicle, &good, "port");
    }
    for (int i = 0; i < HMMWV_VEHICLE_PARAMETERS; ++i) {
        memcpy(parameter, good.parameter, sizeof good.parameter);
        vehicle.parameter[i] *= GIC_R(1.5);
        parameter[i] *= GIC_R(1.5);
        refuses(&vehicle, &good, hmmwv_vehicle_model.parameter[i].name);
        check(hmmwv_vehicle_setup_with(&vehicle, parameter) == GIC_ERROR_ASSUMPTION, "set-up with another parameter");
        vehicle = good;
    }
    vehicle.head.road = &other_road;
    refuses(&vehicle, &good, "road");
    vehicle.discrete[HMMWV_VEHICLE_GEAR] = 1;
    refuses(&vehicle, &good, "neutral");
    printf("%d passed, %d failed\n", passed, failed);
    return failed != 0;
}
