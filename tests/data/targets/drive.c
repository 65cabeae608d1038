/* SPDX-License-Identifier: MIT
 * Runs the HMMWV and prints the bits of its state, with nothing but the emitted code, the runtime core and the roads:
 * the same source for the machine the tests run on, for Linux on other processors and for a bare microcontroller. The
 * vehicle falls onto its wheels, rolls and yaws over a random road, so that every part of the code works; the road's
 * making needs no function of libm but sqrt, as others may differ in the last digit between libraries. */
#include "gic_road.h"
#include "hmmwv.h"
#include "target.h"

enum { STEPS = 400, BETWEEN = 50, POINTS = 161 };

static hmmwv car;

int main(void)
{
    static gic_real height[2 * POINTS];
    static const gic_iso8608 profile = {'D', 3, GIC_R(2.0), GIC_R(16.0), GIC_R(1.5), GIC_R(2.0)};
    static const gic_friction_patch ice = {GIC_R(4.0), GIC_R(8.0), GIC_R(-1.0), GIC_R(1.0), GIC_R(0.1), GIC_R(2.0)};
    static gic_road_grid rough;
    static gic_road_patched road = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &rough.head,
        GIC_R(0.9),
        &ice,
        1};
    int i, step, status = gic_road_iso8608_setup(&rough, &profile, height, POINTS);
    if (status == GIC_OK)
        status = hmmwv_setup(&car);
    car.head.road = &road.head;
    car.state[HMMWV_STATE_V_X] = GIC_R(5.0);
    car.state[HMMWV_STATE_OMEGA_Z] = GIC_R(0.3);
    for (step = 0; status == GIC_OK && step < STEPS; ++step) {
        status = hmmwv_step(&car, GIC_R(0.005), step < STEPS / 2 ? GIC_AB3 : GIC_RK4);
        if ((step + 1) % BETWEEN)
            continue;
        print_bits(road.head.friction(&road.head, 0, GIC_R(0.0), car.state[0], car.state[1]));
        for (i = 0; i < HMMWV_STATES; ++i)
            print_bits(car.state[i]);
    }
    target_print(gic_status_text(status));
    target_print("\n");
    target_end(status != GIC_OK);
    return status != GIC_OK;
}
