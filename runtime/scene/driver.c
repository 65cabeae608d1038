/* SPDX-License-Identifier: MIT
 * The driver of a scene (models/SCENE.md section 5): a controller that looks at the vehicle every `period` and moves
 * pedals and steering by polynomials in time, so that what it commands is three times continuously differentiable and
 * the same for every engine and integrator. */
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

static const double coast = 0.2;      /* m/s^2 of deceleration that rolling resistance provides */
static const double standing = 0.3;   /* m/s; below it a vehicle that is to stand is held ... */
static const double holding = 0.3;    /* ... with this share of the brake */
static const double search_back = 2;  /* m before the last nearest point of the path */
static const double search_ahead = 8; /* m ahead of where the vehicle should be */
static const double slowest = 1;      /* m/s; below it the curvature of the vehicle's own path is not measured */

/* ---- movements --------------------------------------------------------------------------------------------- */

/* Value, rate, acceleration and jerk. */
static void movement_at(const Movement *m, double time, double out[4])
{
    const double s = fmax(0, time - m->start);
    memset(out, 0, 4 * sizeof *out);
    if (s >= m->duration) {
        out[0] = m->end;
        return;
    }
    /* Horner's rule for the polynomial and its derivatives over their factorials */
    for (int k = 7; k >= 0; --k) {
        for (int d = 3; d > 0; --d)
            out[d] = out[d] * s + out[d - 1];
        out[0] = out[0] * s + m->c[k];
    }
    out[2] *= 2;
    out[3] *= 6;
}

/* From the value, rate, acceleration and jerk at `time` to rest at `end` after `duration`. */
static void movement_turn(Movement *m, double time, double end, double duration)
{
    double now[4], T = 1;
    movement_at(m, time, now);
    const double way = end - now[0], v = now[1] * duration, a = now[2] * duration * duration / 2;
    const double j = now[3] * duration * duration * duration / 6;
    const double c[8] = {now[0],
                         v,
                         a,
                         j,
                         35 * way - 20 * v - 10 * a - 4 * j,
                         -84 * way + 45 * v + 20 * a + 6 * j,
                         70 * way - 36 * v - 15 * a - 4 * j,
                         -20 * way + 10 * v + 4 * a + j};
    m->start = time;
    m->duration = duration;
    m->end = end;
    for (int k = 0; k < 8; ++k, T *= duration)
        m->c[k] = c[k] / T;
}

static Movement movement_rest(double value)
{
    return (Movement){.end = value, .c = {value}};
}

/* ---- path -------------------------------------------------------------------------------------------------- */

/* The point at a distance along the path; the path continues straight beyond its ends, a closed one repeats. */
static void path_point(const Path *path, double along, double out[2])
{
    const double length = path->step * (path->count - 1);
    if (path->closed)
        along -= length * floor(along / length);
    const double place = fmin(fmax(along / path->step, 0), path->count - 1.000001);
    const int i = (int)place;
    const double share = along / path->step - i, *a = path->point[i], *b = path->point[i + 1];
    for (int k = 0; k < 2; ++k)
        out[k] = a[k] + share * (b[k] - a[k]);
}

static double distance_at(const Path *path, double along, const double at[3])
{
    double p[2];
    path_point(path, along, p);
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
    double brake = limited(-(demand + coast) / driver->full[1], 0, 1);
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
    path_point(path, driver->along + ahead, p);
    const double dx = p[0] - sight->position[0], dy = p[1] - sight->position[1];
    const double across = -sin(sight->yaw) * dx + cos(sight->yaw) * dy;
    /* curvature of the circle through that point, tangent to the vehicle's axis */
    const double curvature = 2 * across / fmax(dx * dx + dy * dy, 1);
    const double angle = atan(driver->wheelbase * curvature) + driver->wheelbase * driver->curvature_sum;
    const double wanted = driver->per_angle * angle, steering = limited(wanted, -driver->limit, driver->limit);
    if (speed > slowest && steering == wanted)
        driver->curvature_sum += driver->adapt * (curvature - sight->yaw_rate / speed) * driver->period;
    movement_turn(&driver->wheel, time, steering, driver->reach);
}

void driver_start(Driver *driver)
{
    driver->next = 0;
    driver->looks = 0;
    driver->speed_sum = driver->curvature_sum = driver->along = 0;
    driver->seen = false;
    driver->pedal[0] = driver->pedal[1] = movement_rest(0);
    driver->wheel = movement_rest(driver->straight);
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
