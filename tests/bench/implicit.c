/* SPDX-License-Identifier: MIT
 * implicit.sh: explicit and implicit steps of one model by turns, with its code and with its code in lanes, time
 * against error: the inputs at rest but for one, from the start of set-up; and the longest step, each the least of all
 * rounds, so that interruptions are left out, without the first ones, which make whole Jacobians, and once more without
 * those in which an evaluation checks itself. With -DSPLIT the second code is one of which some states are explicit
 * (split.sh). -DMODEL: the model's name; -DLANES: that of the same model in lanes;
 * -DINPUT: the index of an input, -DVALUE: its value. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)
#include TEXT(LANES.h)

enum { ROUNDS = 7, LONG = 1000, FIRST = 40, STATES = sizeof((MODEL *)0)->state / sizeof(gic_real) };

static const double duration = 1;
static const struct Way {
    const char *name;
    gic_method method;
    double step;
    int keep, spread, lanes;
} way[] = {
#ifdef SPLIT
    {"imex", GIC_IMEX, 0.001, 1, 0, 0},
    {"imex, split", GIC_IMEX, 0.001, 1, 0, 1},
    {"imex, one in 4", GIC_IMEX, 0.001, 4, 0, 0},
    {"imex, one in 4, split", GIC_IMEX, 0.001, 4, 0, 1},
    {"imex, one in 16", GIC_IMEX, 0.001, 16, 0, 0},
    {"imex, one in 16, split", GIC_IMEX, 0.001, 16, 0, 1},
    {"imex, shares", GIC_IMEX, 0.001, 16, 1, 0},
    {"imex, shares, split", GIC_IMEX, 0.001, 16, 1, 1},
    {"ros2, one in 16", GIC_ROS2, 0.001, 16, 0, 0},
    {"ros2, one in 16, split", GIC_ROS2, 0.001, 16, 0, 1},
    {"ros3", GIC_ROS3, 0.001, 1, 0, 0},
    {"ros3, split", GIC_ROS3, 0.001, 1, 0, 1},
#else
    {"ab3", GIC_AB3, 0.00025, 0, 0, 0},
    {"ab3, lanes", GIC_AB3, 0.00025, 0, 0, 1},
    {"rk4", GIC_RK4, 0.001, 0, 0, 0},
    {"rk4, lanes", GIC_RK4, 0.001, 0, 0, 1},
    {"ros2", GIC_ROS2, 0.001, 1, 0, 0},
    {"ros2, one Jacobian in 4", GIC_ROS2, 0.001, 4, 0, 0},
    {"ros2, one in 16", GIC_ROS2, 0.001, 16, 0, 0},
    {"ros2, one in 16, lanes", GIC_ROS2, 0.001, 16, 0, 1},
    {"ros2, shares", GIC_ROS2, 0.001, 16, 1, 0},
    {"ros2, shares, lanes", GIC_ROS2, 0.001, 16, 1, 1},
    {"ros2, shares of 32", GIC_ROS2, 0.001, 32, 1, 0},
    {"ros2, shares of 32, lanes", GIC_ROS2, 0.001, 32, 1, 1},
    {"ros2", GIC_ROS2, 0.002, 1, 0, 0},
    {"ros3", GIC_ROS3, 0.001, 1, 0, 0},
    {"ros3", GIC_ROS3, 0.005, 1, 0, 0},
    {"ros3, lanes", GIC_ROS3, 0.005, 1, 0, 1},
    {"imex, one in 4", GIC_IMEX, 0.001, 4, 0, 0},
    {"imex, one in 16", GIC_IMEX, 0.001, 16, 0, 0},
    {"imex, one in 16, lanes", GIC_IMEX, 0.001, 16, 0, 1},
    {"imex, one in 16", GIC_IMEX, 0.002, 16, 0, 0},
    {"exp3", GIC_EXP3, 0.001, 0, 0, 0},
    {"exp3, lanes", GIC_EXP3, 0.001, 0, 0, 1},
    {"exp3", GIC_EXP3, 0.002, 0, 0, 0},
    {"imex, shares", GIC_IMEX, 0.001, 16, 1, 0},
    {"imex, shares, lanes", GIC_IMEX, 0.001, 16, 1, 1}
#endif
};
enum { WAYS = sizeof way / sizeof *way };

static MODEL car;
static LANES beside;                /* its parts side by side */
static double least_of[WAYS][LONG]; /* us */
static char checked[WAYS][LONG];

static double between(const struct timespec *from, const struct timespec *to)
{
    return 1e6 * (double)(to->tv_sec - from->tv_sec) + 1e-3 * (double)(to->tv_nsec - from->tv_nsec);
}

static int begin(const struct Way *w)
{
    if (w->lanes) {
        const int status = JOIN(LANES, _setup)(&beside);
        beside.implicit.keep = w->keep;
        beside.implicit.spread = w->spread;
        beside.input[INPUT] = VALUE;
        return status;
    }
    const int status = JOIN(MODEL, _setup)(&car);
    car.implicit.keep = w->keep;
    car.implicit.spread = w->spread;
    car.input[INPUT] = VALUE;
    return status;
}

static int go(const struct Way *w)
{
    return w->lanes ? JOIN(LANES, _step)(&beside, w->step, w->method) : JOIN(MODEL, _step)(&car, w->step, w->method);
}

static const gic_real *state_of(const struct Way *w)
{
    return w->lanes ? beside.state : car.state;
}

/* Run; CPU time of a step in us, -1 on failure, and of the first one, which makes exponentials, in *first. */
static double run(const struct Way *w, double *first)
{
    struct timespec from, then, to;
    const int steps = (int)(duration / w->step + 0.5);
    int status = begin(w);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    status = status == GIC_OK ? go(w) : status;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &then);
    for (int i = 1; i < steps && status == GIC_OK; ++i)
        status = go(w);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    *first = between(&from, &then);
    return status == GIC_OK ? between(&then, &to) / (steps - 1) : -1;
}

/* The same, step by step; rounds start at other times, so that what interrupts a program regularly meets other steps.
 */
static void run_steps(int k, int round)
{
    const struct timespec wait = {0, 370000 * round};
    struct timespec from, to;
    const struct Way *w = &way[k];
    const gic_head *head = w->lanes ? &beside.head : &car.head;
    nanosleep(&wait, NULL);
    (void)begin(w);
    for (int i = 0; i < LONG && i < (int)(duration / w->step + 0.5); ++i) {
        const int before = head->unchecked;
        clock_gettime(CLOCK_MONOTONIC, &from);
        (void)go(w);
        clock_gettime(CLOCK_MONOTONIC, &to);
        checked[k][i] = head->unchecked > before;
        least_of[k][i] = least_of[k][i] > 0 ? fmin(least_of[k][i], between(&from, &to)) : between(&from, &to);
    }
}

int main(void)
{
    static const struct Way finest = {"", GIC_RK4, 0.00003125, 0, 0, 0};
    static double right[STATES], time[WAYS][ROUNDS], first[WAYS][ROUNDS], error[WAYS];
    if (run(&finest, &first[0][0]) < 0)
        return printf("the reference fails\n");
    memcpy(right, car.state, sizeof right);
    for (int r = 0; r < ROUNDS; ++r)
        for (int w = 0; w < WAYS; ++w) {
            time[w][r] = run(&way[w], &first[w][r]);
            error[w] = time[w][r] < 0 ? NAN : 0;
            for (int i = 0; i < 3; ++i)
                error[w] = fmax(error[w], fabs(state_of(&way[w])[i] - right[i]));
            run_steps(w, r);
        }
    printf("%-26s %8s %18s %18s %10s %10s %11s %14s\n", "", "step, ms", "a step, us", "a ms of motion", "place, m",
           "first, us", "longest, us", "without checks");
    for (int w = 0; w < WAYS; ++w) {
        double least = time[w][0], most = least, longest = 0, plain = 0, begun = first[w][0];
        for (int i = FIRST; i < LONG; ++i) {
            longest = fmax(longest, least_of[w][i]);
            plain = checked[w][i] ? plain : fmax(plain, least_of[w][i]);
        }
        for (int r = 1; r < ROUNDS; ++r) {
            least = fmin(least, time[w][r]);
            most = fmax(most, time[w][r]);
            begun = fmin(begun, first[w][r]);
        }
        printf("%-26s %8g %6.3g to %8.3g %6.3g to %8.3g %10.2g %10.3g %11.3g %14.3g\n", way[w].name, 1e3 * way[w].step,
               least, most, 1e-3 * least / way[w].step, 1e-3 * most / way[w].step, error[w], begun, longest, plain);
    }
    return 0;
}
