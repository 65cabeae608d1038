/* SPDX-License-Identifier: MIT
 * implicit.sh: explicit and implicit steps of one model by turns, time against error: the inputs at rest but for one,
 * from the start of set-up; and the longest step, each the least of all rounds, so that interruptions are left out,
 * without the first ones, which make whole Jacobians. -DMODEL: the model's name; -DINPUT: the index of an input,
 * -DVALUE: its value. */
#include <math.h>
#include <stdio.h>
#include <time.h>

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)

enum { ROUNDS = 7, WAYS = 13, LONG = 1000, FIRST = 40, STATES = sizeof((MODEL *)0)->state / sizeof(gic_real) };

static const double duration = 1;
static const struct {
    const char *name;
    gic_method method;
    double step;
    int keep, spread;
} way[WAYS] = {{"ab3", GIC_AB3, 0.00025, 0, 0},
               {"ros2", GIC_ROS2, 0.001, 1, 0},
               {"ros2, one Jacobian in 4", GIC_ROS2, 0.001, 4, 0},
               {"ros2, one Jacobian in 16", GIC_ROS2, 0.001, 16, 0},
               {"ros3", GIC_ROS3, 0.001, 1, 0},
               {"ros2", GIC_ROS2, 0.002, 1, 0},
               {"ros3", GIC_ROS3, 0.005, 1, 0},
               {"rk4", GIC_RK4, 0.001, 0, 0},
               {"imex, one Jacobian in 4", GIC_IMEX, 0.001, 4, 0},
               {"imex, one Jacobian in 16", GIC_IMEX, 0.001, 16, 0},
               {"imex, one Jacobian in 16", GIC_IMEX, 0.002, 16, 0},
               {"ros2, one in 16, shares", GIC_ROS2, 0.001, 16, 1},
               {"imex, one in 16, shares", GIC_IMEX, 0.001, 16, 1}};

static MODEL car;
static double least_of[WAYS][LONG]; /* us */

static double between(const struct timespec *from, const struct timespec *to)
{
    return 1e6 * (double)(to->tv_sec - from->tv_sec) + 1e-3 * (double)(to->tv_nsec - from->tv_nsec);
}

/* Run; CPU time of a step in us, -1 on failure. */
static double run(gic_method method, double step, int keep, int spread)
{
    struct timespec from, to;
    const int steps = (int)(duration / step + 0.5);
    int i, status = JOIN(MODEL, _setup)(&car);
    car.implicit.keep = keep;
    car.implicit.spread = spread;
    car.input[INPUT] = VALUE;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (i = 0; i < steps && status == GIC_OK; ++i)
        status = JOIN(MODEL, _step)(&car, step, method);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    return status == GIC_OK ? between(&from, &to) / steps : -1;
}

/* The same, step by step; rounds start at other times, so that what interrupts a program regularly meets other steps.
 */
static void run_steps(int w, int round)
{
    const struct timespec wait = {0, 370000 * round};
    struct timespec from, to;
    int i;
    nanosleep(&wait, NULL);
    (void)JOIN(MODEL, _setup)(&car);
    car.implicit.keep = way[w].keep;
    car.implicit.spread = way[w].spread;
    car.input[INPUT] = VALUE;
    for (i = 0; i < LONG && i < (int)(duration / way[w].step + 0.5); ++i) {
        clock_gettime(CLOCK_MONOTONIC, &from);
        (void)JOIN(MODEL, _step)(&car, way[w].step, way[w].method);
        clock_gettime(CLOCK_MONOTONIC, &to);
        least_of[w][i] = least_of[w][i] > 0 ? fmin(least_of[w][i], between(&from, &to)) : between(&from, &to);
    }
}

int main(void)
{
    static double right[STATES], time[WAYS][ROUNDS], error[WAYS];
    int w, r, i;
    if (run(GIC_RK4, 0.00003125, 0, 0) < 0)
        return printf("the reference fails\n");
    for (i = 0; i < STATES; ++i)
        right[i] = car.state[i];
    for (r = 0; r < ROUNDS; ++r)
        for (w = 0; w < WAYS; ++w) {
            time[w][r] = run(way[w].method, way[w].step, way[w].keep, way[w].spread);
            error[w] = time[w][r] < 0 ? NAN : 0;
            for (i = 0; i < 3; ++i)
                error[w] = fmax(error[w], fabs(car.state[i] - right[i]));
            run_steps(w, r);
        }
    printf("%-26s %10s %22s %22s %14s %16s\n", "", "step, ms", "a step, us", "a ms of motion, us", "place, m",
           "longest step, us");
    for (w = 0; w < WAYS; ++w) {
        double least = time[w][0], most = least, longest = 0;
        for (i = FIRST; i < LONG; ++i)
            longest = fmax(longest, least_of[w][i]);
        for (r = 1; r < ROUNDS; ++r) {
            least = fmin(least, time[w][r]);
            most = fmax(most, time[w][r]);
        }
        printf("%-26s %10g %10.3g to %8.3g %10.3g to %8.3g %14.2g %16.3g\n", way[w].name, 1e3 * way[w].step, least,
               most, 1e-3 * least / way[w].step, 1e-3 * most / way[w].step, error[w], longest);
    }
    return 0;
}
