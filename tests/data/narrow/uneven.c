/* SPDX-License-Identifier: MIT
 * Code for tests/data/narrow/bumps.scene, where both sides are alike: what is not alike is refused. */
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

/* Level across, one side higher by a little, and falling to one side. */
static void even(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)y;
    out[0] = GIC_R(0.001) * x, out[1] = GIC_R(0.001), out[2] = 0;
}

static void stepped(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    even(road, lane, time, x, y, out);
    out[0] += y > 3 ? GIC_R(1e-6) : GIC_R(0.0);
}

static void tilted(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    even(road, lane, time, x, y, out);
    out[0] += GIC_R(0.01) * y, out[2] = GIC_R(0.01);
}

static const gic_road even_road = {even, NULL, NULL, NULL, GIC_ROAD_OWN},
                      stepped_road = {stepped, NULL, NULL, NULL, GIC_ROAD_OWN},
                      tilted_road = {tilted, NULL, NULL, NULL, GIC_ROAD_OWN};

static void refuses(hmmwv *vehicle, const hmmwv *good, const char *named)
{
    const hmmwv before = *vehicle;
    gic_real rate[HMMWV_STATES];
    const char *text;
    check(hmmwv_rhs(vehicle, 0, vehicle->state, rate) == GIC_ERROR_ASSUMPTION, named);
    text = hmmwv_status_condition(vehicle);
    check(text && strstr(text, named), named);
    check(gic_step(&hmmwv_model, vehicle, GIC_R(0.001), GIC_AB3) == GIC_ERROR_ASSUMPTION, named);
    check(hmmwv_outputs(vehicle) == GIC_ERROR_ASSUMPTION, named);
    check(!memcmp(vehicle->state, before.state, sizeof before.state), "state untouched");
    *vehicle = *good;
    check(gic_step(&hmmwv_model, vehicle, GIC_R(0.001), GIC_AB3) == GIC_OK, "goes on");
    *vehicle = *good;
}

int main(void)
{
    static hmmwv vehicle, good;
    static const struct {
        int state;
        const char *named;
    } odd[] = {{HMMWV_STATE_E1, "e1"},
               {HMMWV_STATE_E3, "e3"},
               {HMMWV_STATE_V_Y, "v.y"},
               {HMMWV_STATE_OMEGA_X, "omega.x"},
               {HMMWV_STATE_OMEGA_Z, "omega.z"},
               {HMMWV_STATE_RACK, "rack"},
               {HMMWV_STATE_RACK_RATE, "rack"},
               {HMMWV_STATE_SPRING_F_R, "spring_f_r"},
               {HMMWV_STATE_SPRING_R_L_RATE, "spring_r_r"}};
    check(hmmwv_setup(&vehicle) == GIC_OK, "set-up");
    vehicle.state[HMMWV_STATE_R_Y] = 3;
    vehicle.state[HMMWV_STATE_V_X] = 10;
    good = vehicle;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; ++i) {
        vehicle.state[odd[i].state] += GIC_R(1e-9);
        refuses(&vehicle, &good, odd[i].named);
    }
    vehicle.head.road = &stepped_road;
    refuses(&vehicle, &good, "road");
    vehicle.head.road = &tilted_road;
    refuses(&vehicle, &good, "road");
    vehicle.head.road = &even_road;
    for (int i = 0; i < 100; ++i)
        check(gic_step(&hmmwv_model, &vehicle, GIC_R(0.005), GIC_AB3) == GIC_OK, "stays symmetric, bit by bit");
    check(vehicle.state[HMMWV_STATE_SPRING_F_L] != good.state[HMMWV_STATE_SPRING_F_L], "and moves");
    printf("%d passed, %d failed\n", passed, failed);
    return failed != 0;
}
