/* SPDX-License-Identifier: MIT
 * The driver of a scene (models/SCENE.md section 5): a controller that looks at the vehicle every `period` and moves
 * pedals and steering by polynomials in time, so that what it commands is three times continuously differentiable and
 * the same for every engine and integrator. Pages of gicrun --drive compile this file too. */
#include "driver.h"

#include <math.h>
#include <string.h>

const double driver_coast = 0.2;
static const double standing = 0.3;   /* m/s; below it a vehicle that is to stand is held ... */
static const double holding = 0.3;    /* ... with this share of the brake */
static const double search_back = 2;  /* m before the last nearest point of the path */
static const double search_ahead = 8; /* m ahead of where the vehicle should be */
static const double slowest = 1;      /* m/s; below it the curvature of the vehicle's own path is not measured */

/* ---- path -------------------------------------------------------------------------------------------------- */

void path_point(const Path *path, double along, double out[2], int *piece)
{
    const double length = path->step * (path->count - 1);
    if (path->closed)
        along -= length * floor(along / length);
    const double place = fmin(fmax(along / path->step, 0), path->count - 1.000001);
    const int i = (int)place;
    const double share = along / path->step - i, *a = path->point[i], *b = path->point[i + 1];
    for (int k = 0; k < 2; ++k)
        out[k] = a[k] + share * (b[k] - a[k]);
    *piece = i;
}

static double distance_at(const Path *path, double along, const double at[3])
{
    double p[2];
    int piece;
    path_point(path, along, p, &piece);
    return hypot(p[0] - at[0], p[1] - at[1]);
}

/* The distance along the path, between two bounds, of the point nearest to `at`. */
static double path_nearest(const Path *path, double from, double to, const double at[3])
{
    double best = from, least = INFINITY;
    for (double along = from; along <= to; along += path->step) {
        const double d = distance_at(path, along, at);
        if (d < least) {
            least = d;
            best = along;
        }
    }
    /* the distance has one minimum within a step on either side */
    for (double width = path->step / 2; width > 1e-6; width /= 2)
        for (int side = -1; side <= 1; side += 2)
            if (distance_at(path, best + side * width, at) < distance_at(path, best, at))
                best += side * width;
    return best;
}

/* ---- control ----------------------------------------------------------------------------------------------- */

static double limited(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

static void control_speed(Driver *driver, double time, double speed)
{
    double wanted[3];
    profile_at(&driver->speed, time, wanted);
    const double error = wanted[0] - speed, demand = wanted[1] + driver->gain * error + driver->speed_sum;
    const double accelerator = limited(demand / driver->full[0], 0, 1);
    double brake = limited(-(demand + driver_coast) / driver->full[1], 0, 1);
    /* no integration while a pedal is at its end */
    if ((accelerator < 1 || error < 0) && (brake < 1 || error > 0))
        driver->speed_sum += driver->integral * error * driver->period;
    if (fabs(wanted[0]) < 1e-9 && fabs(speed) < standing)
        brake = fmax(brake, holding);
    movement_turn(&driver->pedal[0], time, accelerator, driver->reach);
    movement_turn(&driver->pedal[1], time, brake, driver->reach);
}

static void control_path(Driver *driver, double time, const Sight *sight, double speed)
{
    const Path *path = &driver->path;
    const double way = fmax(speed, 0) * driver->period, ahead = fmax(driver->preview * speed, driver->shortest);
    const double from = driver->seen ? driver->along - search_back : 0;
    const double to = driver->seen ? driver->along + way + search_ahead : path->step * (path->count - 1);
    driver->along = path_nearest(path, path->closed ? from : fmax(from, 0), to, sight->position);
    driver->seen = true;
    double p[2];
    int piece;
    path_point(path, driver->along + ahead, p, &piece);
    const double dx = p[0] - sight->position[0], dy = p[1] - sight->position[1];
    const double across = -sin(sight->yaw) * dx + cos(sight->yaw) * dy;
    /* curvature of the circle through that point, tangent to the vehicle's axis */
    const double curvature = 2 * across / fmax(dx * dx + dy * dy, 1);
    const double angle = atan(driver->wheelbase * curvature) + driver->wheelbase * driver->curvature_sum;
    const double wanted = driver->per_angle * angle, steering = limited(wanted, -driver->limit, driver->limit);
    if (speed > slowest) {
        driver->square += driver->steered * driver->steered;
        driver->product += driver->steered * sight->yaw_rate / speed;
    }
    driver->steered = steering / driver->per_angle / driver->wheelbase;
    if (speed > slowest && steering == wanted)
        driver->curvature_sum += driver->adapt * (curvature - sight->yaw_rate / speed) * driver->period;
    movement_turn(&driver->wheel, time, driver->middle + steering, driver->reach);
}

Sight sight_of(const double *state, int half)
{
    const double *e = state + 3, *turn = state + half + 4;
    const double norm = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    const double p[4] = {e[0] / norm, e[1] / norm, e[2] / norm, e[3] / norm};
    Sight sight = {.yaw = atan2(2 * (p[1] * p[2] + p[0] * p[3]), 2 * p[1] * p[1] + (2 * p[0] * p[0] - 1))};
    memcpy(sight.position, state, sizeof sight.position);
    memcpy(sight.velocity, state + half + 1, sizeof sight.velocity);
    /* about the vertical */
    sight.yaw_rate = 2 * (p[1] * p[3] - p[0] * p[2]) * turn[0] + 2 * (p[2] * p[3] + p[0] * p[1]) * turn[1] +
                     (2 * p[3] * p[3] + (2 * p[0] * p[0] - 1)) * turn[2];
    return sight;
}

void driver_start(Driver *driver)
{
    driver->next = 0;
    driver->looks = 0;
    driver->speed_sum = driver->curvature_sum = driver->along = 0;
    driver->steered = driver->square = driver->product = 0;
    driver->seen = false;
    driver->pedal[0] = driver->pedal[1] = movement_rest(0);
    driver->wheel = movement_rest(driver->straight);
}

bool driver_is_crossed(const Driver *driver)
{
    static const double slight = 1e-3; /* 1/m, of all looks: circles of 1 km say nothing */
    return driver->square > slight * slight * (double)driver->looks && driver->product < -0.2 * driver->square;
}

bool driver_is_due(const Driver *driver, double time)
{
    return time >= driver->next - 1e-9 * driver->period;
}

double driver_next_kink(const Driver *driver, double time)
{
    const double end = driver->looks ? driver->next - driver->period + driver->reach : driver->next;
    return end > time ? fmin(end, driver->next) : driver->next;
}

void driver_look(Driver *driver, double time, const Sight *sight)
{
    const double speed = cos(sight->yaw) * sight->velocity[0] + sin(sight->yaw) * sight->velocity[1];
    if (driver->accelerator >= 0)
        control_speed(driver, time, speed);
    if (driver->steering >= 0)
        control_path(driver, time, sight, speed);
    driver->next = (double)++driver->looks * driver->period;
}

void driver_moves(const Driver *driver, bool *fixed)
{
    if (driver->accelerator >= 0)
        fixed[driver->accelerator] = fixed[driver->brake] = false;
    for (int k = 0; driver->steering >= 0 && k < (driver->driven ? 3 : 1); ++k)
        fixed[driver->steering + k] = false;
}

void driver_inputs(const Driver *driver, double time, double *input)
{
    double out[4];
    if (driver->accelerator >= 0) {
        movement_at(&driver->pedal[0], time, out);
        input[driver->accelerator] = out[0];
        movement_at(&driver->pedal[1], time, out);
        input[driver->brake] = out[0];
    }
    if (driver->steering >= 0) {
        movement_at(&driver->wheel, time, out);
        memcpy(input + driver->steering, out, (driver->driven ? 3 : 1) * sizeof *out);
    }
}
