/* SPDX-License-Identifier: MIT
 * implicit.sh: explicit and implicit steps of one model by turns, time against error: the inputs at rest but for one,
 * from the start of set-up. -DMODEL: the model's name; -DINPUT: the index of an input, -DVALUE: its value. */
#include <math.h>
#include <stdio.h>
#include <time.h>

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)

enum { ROUNDS = 5, WAYS = 11, STATES = sizeof((MODEL *)0)->state / sizeof(gic_real) };

static const double duration = 1;
static const struct {
    const char *name;
    gic_method method;
    double step;
    int keep;
} way[WAYS] = {{"ab3", GIC_AB3, 0.00025, 0},
               {"ros2", GIC_ROS2, 0.001, 1},
               {"ros2, one Jacobian in 4", GIC_ROS2, 0.001, 4},
               {"ros2, one Jacobian in 16", GIC_ROS2, 0.001, 16},
               {"ros3", GIC_ROS3, 0.001, 1},
               {"ros2", GIC_ROS2, 0.002, 1},
               {"ros3", GIC_ROS3, 0.005, 1},
               {"rk4", GIC_RK4, 0.001, 0},
               {"imex, one Jacobian in 4", GIC_IMEX, 0.001, 4},
               {"imex, one Jacobian in 16", GIC_IMEX, 0.001, 16},
               {"imex, one Jacobian in 16", GIC_IMEX, 0.002, 16}};

static MODEL car;

/* Run; CPU time of a step in us, -1 on failure. */
static double run(gic_method method, double step, int keep)
{
    struct timespec from, to;
    const int steps = (int)(duration / step + 0.5);
    int i, status = JOIN(MODEL, _setup)(&car);
    car.implicit.keep = keep;
    car.input[INPUT] = VALUE;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (i = 0; i < steps && status == GIC_OK; ++i)
        status = JOIN(MODEL, _step)(&car, step, method);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    return status == GIC_OK
               ? 1e6 * ((double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec)) / steps
               : -1;
}

int main(void)
{
    static double right[STATES], time[WAYS][ROUNDS], error[WAYS];
    int w, r, i;
    if (run(GIC_RK4, 0.00003125, 0) < 0)
        return printf("the reference fails\n");
    for (i = 0; i < STATES; ++i)
        right[i] = car.state[i];
    for (r = 0; r < ROUNDS; ++r)
        for (w = 0; w < WAYS; ++w) {
            time[w][r] = run(way[w].method, way[w].step, way[w].keep);
            error[w] = time[w][r] < 0 ? NAN : 0;
            for (i = 0; i < 3; ++i)
                error[w] = fmax(error[w], fabs(car.state[i] - right[i]));
        }
    printf("%-26s %10s %22s %22s %14s\n", "", "step, ms", "a step, us", "a ms of motion, us", "place, m");
    for (w = 0; w < WAYS; ++w) {
        double least = time[w][0], most = least;
        for (r = 1; r < ROUNDS; ++r) {
            least = fmin(least, time[w][r]);
            most = fmax(most, time[w][r]);
        }
        printf("%-26s %10g %10.3g to %8.3g %10.3g to %8.3g %14.2g\n", way[w].name, 1e3 * way[w].step, least, most,
               1e-3 * least / way[w].step, 1e-3 * most / way[w].step, error[w]);
    }
    return 0;
}
