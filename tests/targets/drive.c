/* SPDX-License-Identifier: MIT
 * Runs the HMMWV and prints the bits of its state, with nothing but the emitted code and the runtime core: the same
 * source for the machine the tests run on, for Linux on other processors and for a bare microcontroller. The vehicle
 * falls onto its wheels, rolls and yaws over a sine road, so that every part of the code works. */
#include "hmmwv.h"
#include "target.h"

enum { STEPS = 400, BETWEEN = 50 };

static hmmwv car;

/* Sign, exponent and fraction as hexadecimal digits, most significant first. */
static void print_bits(gic_real value)
{
    static const char digit[] = "0123456789abcdef";
    unsigned char bytes[sizeof value];
    char text[2 * sizeof value + 2];
    unsigned i;
    for (i = 0; i < sizeof value; ++i)
        bytes[i] = ((const unsigned char *)&value)[sizeof value - 1 - i]; /* all targets are little-endian */
    for (i = 0; i < sizeof value; ++i) {
        text[2 * i] = digit[bytes[i] >> 4];
        text[2 * i + 1] = digit[bytes[i] & 15];
    }
    text[2 * i] = '\n';
    text[2 * i + 1] = 0;
    target_print(text);
}

/* A road without functions of libm, which may differ in the last digit between libraries: a parabolic hump. */
static void hump(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_real s = x - GIC_R(2.0);
    (void)road, (void)lane, (void)time, (void)y;
    out[0] = s > GIC_R(0.0) && s < GIC_R(1.0) ? GIC_R(0.2) * s * s * (GIC_R(1.0) - s) * (GIC_R(1.0) - s) : GIC_R(0.0);
    out[1] = GIC_R(0.0);
    out[2] = GIC_R(0.0);
}

int main(void)
{
    static const gic_road road = {hump};
    int i, step, status = hmmwv_setup(&car);
    car.head.road = &road;
    car.state[HMMWV_STATE_V_X] = GIC_R(5.0);
    car.state[HMMWV_STATE_OMEGA_Z] = GIC_R(0.3);
    for (step = 0; status == GIC_OK && step < STEPS; ++step) {
        status = hmmwv_step(&car, GIC_R(0.005), step < STEPS / 2 ? GIC_AB3 : GIC_RK4);
        for (i = 0; (step + 1) % BETWEEN == 0 && i < HMMWV_STATES; ++i)
            print_bits(car.state[i]);
    }
    target_print(gic_status_text(status));
    target_print("\n");
    target_end(status != GIC_OK);
    return status != GIC_OK;
}
