/* SPDX-License-Identifier: MIT
 * Explicit and implicit steps of one model: bits of its state on the way, and instructions of a step of STEP seconds
 * where the machine tells them. The vehicle falls onto its wheels from where it is drawn, with one input. -DMODEL: its
 * name; -DINPUT: the index of an input, -DVALUE: its value. */
#include "target.h"

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)

enum { STEPS = 240, FIRST = 40 /* the first ones make whole Jacobians */, BETWEEN = 60 };
enum { STATES = sizeof((MODEL *)0)->state / sizeof(gic_real) };

#define STEP GIC_R(0.001)

static const struct Way {
    const char *name;
    gic_method method;
    int parts, keep, spread; /* steps that make STEP */
} way[] = {{"ab3, 4 steps", GIC_AB3, 4, 0, 0},
           {"ros2, a Jacobian each", GIC_ROS2, 1, 1, 0},
           {"ros2, keep 16", GIC_ROS2, 1, 16, 0},
           {"ros2, keep 16, shares", GIC_ROS2, 1, 16, 1},
           {"ros2, keep 32, shares", GIC_ROS2, 1, 32, 1},
           {"imex, keep 16", GIC_IMEX, 1, 16, 0},
           {"imex, keep 16, shares", GIC_IMEX, 1, 16, 1}};

static MODEL car;

/* Mean of the steps from FIRST on; the longest of them, and of those in which no evaluation checks itself. */
static void print_counts(const struct Way *w, uint32_t mean, uint32_t longest, uint32_t plain)
{
    const uint32_t count[] = {mean, longest, plain};
    int i;
    target_print("count ");
    for (i = 0; i < 3; ++i) {
        print_whole(count[i]);
        target_print(" ");
    }
    target_print(w->name);
    target_print("\n");
}

static int run(const struct Way *w)
{
    uint64_t sum = 0;
    uint32_t longest = 0, plain = 0;
    int step, part, i, status = JOIN(MODEL, _setup)(&car);
    car.implicit.keep = w->keep;
    car.implicit.spread = w->spread;
    car.input[INPUT] = VALUE;
    for (step = 0; status == GIC_OK && step < STEPS; ++step) {
        const int32_t unchecked = car.head.unchecked;
        const uint32_t from = target_instructions();
        uint32_t took;
        for (part = 0; status == GIC_OK && part < w->parts; ++part)
            status = JOIN(MODEL, _step)(&car, STEP / (gic_real)w->parts, w->method);
        took = target_instructions() - from;
        if (step >= FIRST) {
            sum += took;
            longest = took > longest ? took : longest;
            plain = took > plain && car.head.unchecked <= unchecked ? took : plain;
        }
        if ((step + 1) % BETWEEN == 0)
            for (i = 0; i < STATES; ++i)
                print_bits(car.state[i]);
    }
    print_counts(w, (uint32_t)(sum / (STEPS - FIRST)), longest, plain);
    return status;
}

int main(void)
{
    const struct Way loop = {"loop", GIC_AB3, 0, 0, 0};
    unsigned i;
    int status = GIC_OK;
    const uint32_t from = target_instructions();
    target_loop();
    const uint32_t took = target_instructions() - from;
    print_counts(&loop, took, took, took);
    for (i = 0; status == GIC_OK && i < sizeof way / sizeof *way; ++i)
        status = run(&way[i]);
    target_print(gic_status_text(status));
    target_print("\n");
    target_end(status != GIC_OK);
    return status != GIC_OK;
}
