/* SPDX-License-Identifier: MIT
 * Limits variable steps by the detail of the road: the estimate of the error does not include what lies between the
 * places where the road was evaluated. */
#include "gic_road.h"
#include "gic_runtime.h"
#include "run/road_resolution.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static const double pi = 3.141592653589793;

/* ---- roads -------------------------------------------------------------------------------------------------- */

/* Half the distance from x to the part between low and high, at least `detail`. */
static double clear_of(double x, double low, double high, double detail)
{
    return fmax(0.5 * fmax(low - x, x - high), detail);
}

static double bumps_clear(const gic_road_bumps *road, double x)
{
    double clear = INFINITY;
    for (int32_t i = 0; i < road->count; ++i) {
        const gic_bump *bump = &road->bump[i];
        clear = fmin(clear, clear_of(x, bump->x, bump->x + bump->length, bump->length / 8));
    }
    return clear;
}

/* Is the piece of a track from point i to the next one a straight line? */
static bool is_straight(const double *x, const double *y, const double *slope, int32_t i)
{
    const double chord = (y[i + 1] - y[i]) / (x[i + 1] - x[i]), least = 1e-9;
    return fabs(slope[i] - chord) <= least && fabs(slope[i + 1] - chord) <= least;
}

static double piece_clear(const gic_road_table *road, double x, int32_t i)
{
    const bool straight = is_straight(road->x, road->left, road->slope_left, i) &&
                          is_straight(road->x, road->right, road->slope_right, i);
    return straight ? INFINITY : clear_of(x, road->x[i], road->x[i + 1], (road->x[i + 1] - road->x[i]) / 2);
}

/* Look at pieces on both sides until they are too far away to matter. */
static double table_clear(const gic_road_table *road, double x)
{
    double clear = INFINITY;
    int32_t low = 0, high = road->count - 1;
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        *(road->x[middle] <= x ? &low : &high) = middle;
    }
    for (int32_t i = low; i >= 0 && 0.5 * (x - road->x[i + 1]) < clear; --i)
        clear = fmin(clear, piece_clear(road, x, i));
    for (int32_t i = low + 1; i + 1 < road->count && 0.5 * (road->x[i] - x) < clear; ++i)
        clear = fmin(clear, piece_clear(road, x, i));
    return clear;
}

static double grid_clear(const gic_road_grid *road, double x, double y)
{
    return fmin(clear_of(x, road->x0, road->x0 + (road->nx - 1) * road->dx, road->dx / 2),
                clear_of(y, road->y0, road->y0 + (road->ny - 1) * road->dy, road->dy / 2));
}

static double patched_clear(const gic_road_patched *road, double x, double y)
{
    double clear = road_clear(road->under, x, y);
    for (int32_t i = 0; i < road->count; ++i) {
        const gic_friction_patch *patch = &road->patch[i];
        const double outside =
            fmax(fmax(patch->x_low - x, x - patch->x_high), fmax(patch->y_low - y, y - patch->y_high));
        /* outside as inside: half the way to the nearest edge */
        clear = fmin(clear, fmax(0.5 * fabs(outside), patch->fade / 2));
    }
    return clear;
}

double road_clear(const gic_road *road, double x, double y)
{
    const void *const any = road;
    if (!road)
        return INFINITY;
    if (road->height == gic_bumps_height)
        return bumps_clear(any, x);
    if (road->height == gic_table_height)
        return table_clear(any, x);
    if (road->height == gic_grid_height)
        return grid_clear(any, x, y);
    if (road->height == gic_patched_height)
        return patched_clear(any, x, y);
    double clear = INFINITY;
    if (road->height == gic_sine_height) {
        const gic_road_sine *sine = any;
        if (sine->amplitude != 0)
            clear = fmin(sine->wavelength, 2 * pi / fabs(sine->phase_per_y)) / 8;
    } else if (road->height == gic_sum_height) {
        const gic_road_sum *sum = any;
        for (int32_t i = 0; i < sum->count; ++i)
            clear = fmin(clear, road_clear(sum->part[i], x, y));
    }
    return clear;
}

/* ---- points on them ------------------------------------------------------------------------------------------ */

typedef struct Point {
    double x, y;
} Point;

/* The places at which one right-hand side asked for heights. */
typedef struct Seen {
    double time;
    int count, room;
    Point *point;
} Seen;

struct Probe {
    gic_road head;
    const gic_road *road; /* the road behind the probe */
    Seen now, last;       /* of this right-hand side; of the last one of the step before */
    int moving, room;     /* points whose speed is known; room */
    double *speed, *gain; /* m/s; m/s^2, how much faster they became */
};

/* Each point once, since checks evaluate the same points again. Without memory a point is left out. */
static void seen_add(Seen *seen, double x, double y)
{
    for (int i = 0; i < seen->count; ++i)
        if (seen->point[i].x == x && seen->point[i].y == y)
            return;
    if (seen->count == seen->room) {
        const int room = seen->room ? 2 * seen->room : 16;
        Point *point = realloc(seen->point, sizeof *point * (size_t)room);
        if (!point)
            return;
        seen->point = point;
        seen->room = room;
    }
    seen->point[seen->count++] = (Point){x, y};
}

static void probe_height(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    Probe *probe = (Probe *)(uintptr_t)road; /* its own, and never constant */
    seen_add(&probe->now, x, y);
    probe->road->height(probe->road, lane, time, x, y, out);
}

static double probe_friction(const gic_road *road, int32_t lane, double time, double x, double y)
{
    const Probe *probe = (const Probe *)(const void *)road;
    return probe->road->friction(probe->road, lane, time, x, y);
}

Probe *probe_new(void)
{
    return calloc(1, sizeof(Probe));
}

void probe_free(Probe *probe)
{
    if (!probe)
        return;
    free(probe->now.point);
    free(probe->last.point);
    free(probe->speed);
    free(probe->gain);
    free(probe);
}

const gic_road *probe_road(Probe *probe, const gic_road *road)
{
    if (!road)
        return NULL;
    probe->road = road;
    probe->head.height = probe_height;
    probe->head.friction = road->friction ? probe_friction : NULL;
    return &probe->head;
}

void probe_begin(Probe *probe, double time)
{
    probe->now.count = 0;
    probe->now.time = time;
}

static bool make_room(Probe *probe)
{
    if (probe->room >= probe->now.count)
        return true;
    const size_t size = sizeof(double) * (size_t)probe->now.count;
    double *speed = realloc(probe->speed, size);
    if (speed)
        probe->speed = speed;
    double *gain = realloc(probe->gain, size);
    if (gain)
        probe->gain = gain;
    if (speed && gain)
        probe->room = probe->now.count;
    return speed && gain;
}

void probe_end(Probe *probe)
{
    const Seen now = probe->now, last = probe->last;
    const double passed = now.time - last.time;
    if (!make_room(probe) || (last.count == now.count && !(passed > 0)))
        return;
    for (int i = 0; i < now.count && last.count == now.count; ++i) {
        const double speed = hypot(now.point[i].x - last.point[i].x, now.point[i].y - last.point[i].y) / passed;
        probe->gain[i] = i < probe->moving ? fabs(speed - probe->speed[i]) / passed : 0;
        probe->speed[i] = speed;
    }
    probe->moving = last.count == now.count ? now.count : 0;
    probe->last = now;
    probe->now = last;
}

bool probe_asked(const Probe *probe)
{
    return probe->last.count > 0;
}

/* Round to a few digits: speeds are differences of places, and engines with different rounding should take the same
 * steps. */
static double rounded_down(double x)
{
    int exponent;
    const double digits = 16, share = frexp(x, &exponent);
    return isfinite(x) ? ldexp(floor(share * digits) / digits, exponent) : x;
}

double probe_longest(const Probe *probe)
{
    const double unknown = 1e-5; /* s, while the speeds of the points are unknown: millimetres of travel */
    double longest = INFINITY;
    if (!probe->road)
        return INFINITY;
    for (int i = 0; i < probe->last.count; ++i) {
        const double clear = road_clear(probe->road, probe->last.point[i].x, probe->last.point[i].y);
        if (isinf(clear))
            continue;
        if (i >= probe->moving)
            return unknown;
        /* the gain counts twice: it may grow */
        const double speed = probe->speed[i], root = sqrt(speed * speed + 4 * probe->gain[i] * clear);
        longest = fmin(longest, 2 * clear / (speed + root + 1e-9));
    }
    return probe->last.count ? rounded_down(longest) : unknown;
}
