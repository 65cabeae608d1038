/* SPDX-License-Identifier: MIT
 * Derivatives of a driver's look: driver.c line by line, each number with its derivatives. */
#include "scene/driver.h"

#include <math.h>
#include <string.h>

enum { X, Y, VX, VY, YAW, YAW_RATE, SIGHTS }; /* of a Sight, what a look uses */
enum { ACCELERATOR, BRAKE, STEERING, SPEED_SUM, CURVATURE_SUM };
enum { NUMBERS = SIGHTS + DRIVE_SUMS };

/* A number and its derivatives by the sight and the sums. */
typedef struct Dual {
    double value, by[NUMBERS];
} Dual;

static Dual constant(double value)
{
    return (Dual){.value = value};
}

static Dual number(double value, int i)
{
    Dual x = {.value = value};
    x.by[i] = 1;
    return x;
}

/* f(a, b) with its value and its derivatives by both. */
static Dual of(double value, double by_a, const Dual *a, double by_b, const Dual *b)
{
    Dual x = {.value = value};
    for (int i = 0; i < NUMBERS; ++i)
        x.by[i] = by_a * a->by[i] + by_b * b->by[i];
    return x;
}

static Dual plus(Dual a, double factor, Dual b)
{
    return of(a.value + factor * b.value, 1, &a, factor, &b);
}

static Dual times(Dual a, Dual b)
{
    return of(a.value * b.value, b.value, &a, a.value, &b);
}

static Dual over(Dual a, Dual b)
{
    return of(a.value / b.value, 1 / b.value, &a, -a.value / (b.value * b.value), &b);
}

static Dual limited(Dual x, double low, double high)
{
    return x.value > low && x.value < high ? x : constant(fmin(fmax(x.value, low), high));
}

static Dual cosine(Dual x)
{
    return of(cos(x.value), -sin(x.value), &x, 0, &x);
}

static Dual sine(Dual x)
{
    return of(sin(x.value), cos(x.value), &x, 0, &x);
}

/* ---- the path ---------------------------------------------------------------------------------------------- */

/* A piece of the path per m along it. */
static void piece_of(const Path *path, int piece, double along[2])
{
    for (int k = 0; k < 2; ++k)
        along[k] = (path->point[piece + 1][k] - path->point[piece][k]) / path->step;
}

/* The place nearest to (x, y), which was found at `along`: its foot on a piece; at a corner it stays. */
static Dual nearest(const Path *path, double along, Dual x, Dual y)
{
    const double close = 1e-5; /* m: it was found to 1e-6 */
    const int pieces = path->count - 1;
    const double length = path->step * pieces, round = path->closed ? length * floor(along / length) : 0;
    for (int side = -1; side <= 1; ++side) {
        double point[2], way[2];
        int piece;
        path_point(path, along + side * close, point, &piece);
        piece_of(path, piece, way);
        const double *a = path->point[piece], square = way[0] * way[0] + way[1] * way[1];
        const double foot = ((x.value - a[0]) * way[0] + (y.value - a[1]) * way[1]) / square;
        if (fabs(piece * path->step + foot + round - along) < 2 * close && foot >= 0 && foot <= path->step)
            return of(along, way[0] / square, &x, way[1] / square, &y);
    }
    return constant(along);
}

static void path_at(const Path *path, Dual along, Dual out[2])
{
    double point[2], way[2];
    int piece;
    path_point(path, along.value, point, &piece);
    piece_of(path, piece, way);
    for (int k = 0; k < 2; ++k)
        out[k] = of(point[k], way[k], &along, 0, &along);
}

/* ---- a look ------------------------------------------------------------------------------------------------ */

static void look_at_speed(const Driver *driver, const Driver *after, double time, Dual speed, Dual *result)
{
    double wanted[3];
    profile_at(&driver->speed, time, wanted);
    const Dual sum = number(driver->speed_sum, SIGHTS), error = plus(constant(wanted[0]), -1, speed);
    const Dual demand = plus(plus(constant(wanted[1]), driver->gain, error), 1, sum), zero = constant(0);
    result[ACCELERATOR] = limited(plus(zero, 1 / driver->full[0], demand), 0, 1);
    result[BRAKE] = limited(plus(zero, -1 / driver->full[1], plus(demand, 1, constant(driver_coast))), 0, 1);
    result[SPEED_SUM] =
        after->speed_sum != driver->speed_sum ? plus(sum, driver->integral * driver->period, error) : sum;
    if (after->pedal[1].end > result[BRAKE].value) /* a vehicle that stands is held */
        result[BRAKE] = constant(after->pedal[1].end);
}

static void look_at_path(const Driver *driver, const Driver *after, const Dual *seen, Dual speed, Dual *result)
{
    const Dual sum = number(driver->curvature_sum, SIGHTS + 1);
    Dual ahead = plus(constant(0), driver->preview, speed), p[2];
    if (ahead.value < driver->shortest)
        ahead = constant(driver->shortest);
    path_at(&driver->path, plus(nearest(&driver->path, after->along, seen[X], seen[Y]), 1, ahead), p);
    const Dual dx = plus(p[0], -1, seen[X]), dy = plus(p[1], -1, seen[Y]);
    const Dual across = plus(times(cosine(seen[YAW]), dy), -1, times(sine(seen[YAW]), dx));
    const Dual square = plus(times(dx, dx), 1, times(dy, dy));
    const Dual curvature = over(plus(across, 1, across), square.value > 1 ? square : constant(1));
    const double bent = driver->wheelbase * curvature.value;
    const Dual angle = of(atan(bent), driver->wheelbase / (1 + bent * bent), &curvature, 0, &curvature);
    const Dual wanted = plus(constant(0), driver->per_angle, plus(angle, driver->wheelbase, sum));
    result[STEERING] = plus(constant(driver->middle), 1, limited(wanted, -driver->limit, driver->limit));
    const bool adapts = after->curvature_sum != driver->curvature_sum;
    result[CURVATURE_SUM] =
        adapts ? plus(sum, driver->adapt * driver->period, plus(curvature, -1, over(seen[YAW_RATE], speed))) : sum;
}

/* Derivatives of the sight by the state. */
static void sight_slope(const double *state, int half, double by[SIGHTS][DRIVE_SEEN])
{
    const double *p = state + 3, *w = state + half + 4;
    const double up[3] = {2 * (p[1] * p[3] - p[0] * p[2]), 2 * (p[2] * p[3] + p[0] * p[1]),
                          2 * p[3] * p[3] + (2 * p[0] * p[0] - 1)};
    const double n = 2 * (p[1] * p[2] + p[0] * p[3]), d = 2 * p[1] * p[1] + (2 * p[0] * p[0] - 1);
    const double of_n = d / (n * n + d * d), of_d = -n / (n * n + d * d);
    const double yaw[4] = {2 * p[3] * of_n + 4 * p[0] * of_d, 2 * p[2] * of_n + 4 * p[1] * of_d, 2 * p[1] * of_n,
                           2 * p[0] * of_n};
    const double rate[4] = {-2 * p[2] * w[0] + 2 * p[1] * w[1] + 4 * p[0] * w[2], 2 * p[3] * w[0] + 2 * p[0] * w[1],
                            -2 * p[0] * w[0] + 2 * p[3] * w[1], 2 * p[1] * w[0] + 2 * p[2] * w[1] + 4 * p[3] * w[2]};
    double along_yaw = 0, along_rate = 0; /* of the norm, which is 1 */
    memset(by, 0, SIGHTS * sizeof *by);
    by[X][0] = by[Y][1] = by[VX][7] = by[VY][8] = 1;
    for (int i = 0; i < 4; ++i) {
        along_yaw += p[i] * yaw[i];
        along_rate += p[i] * rate[i];
    }
    for (int i = 0; i < 4; ++i) {
        by[YAW][3 + i] = yaw[i] - along_yaw * p[i];
        by[YAW_RATE][3 + i] = rate[i] - along_rate * p[i];
    }
    memcpy(&by[YAW_RATE][10], up, sizeof up);
}

void driver_look_slope(const Driver *before, const Driver *after, double time, const double *state, int half,
                       double slope[DRIVE_RESULTS][DRIVE_SEEN + DRIVE_SUMS])
{
    const Sight sight = sight_of(state, half);
    const double value[SIGHTS] = {sight.position[0], sight.position[1], sight.velocity[0],
                                  sight.velocity[1], sight.yaw,         sight.yaw_rate};
    Dual seen[SIGHTS], result[DRIVE_RESULTS] = {{0}};
    double by[SIGHTS][DRIVE_SEEN];
    for (int i = 0; i < SIGHTS; ++i)
        seen[i] = number(value[i], i);
    const Dual speed = plus(times(cosine(seen[YAW]), seen[VX]), 1, times(sine(seen[YAW]), seen[VY]));
    if (before->accelerator >= 0)
        look_at_speed(before, after, time, speed, result);
    if (before->steering >= 0)
        look_at_path(before, after, seen, speed, result);
    sight_slope(state, half, by);
    for (int r = 0; r < DRIVE_RESULTS; ++r) {
        for (int i = 0; i < DRIVE_SEEN; ++i) {
            slope[r][i] = 0;
            for (int s = 0; s < SIGHTS; ++s)
                slope[r][i] += result[r].by[s] * by[s][i];
        }
        memcpy(&slope[r][DRIVE_SEEN], &result[r].by[SIGHTS], DRIVE_SUMS * sizeof(double));
    }
}
