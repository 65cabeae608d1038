/* SPDX-License-Identifier: MIT
 * The driver of a scene (models/SCENE.md section 5): a controller that looks at the vehicle every `period` and moves
 * pedals and steering by quintics in time, so that what it commands is twice continuously differentiable and the same
 * for every engine and integrator. */
#include "driver.h"

#include <math.h>
#include <string.h>

static const double coast = 0.2;      /* m/s^2 of deceleration asked for that are left to rolling resistance */
static const double standing = 0.3;   /* m/s below which a vehicle that shall stand is held ... */
static const double holding = 0.3;    /* ... with so much of the brake */
static const double search_back = 2;  /* m behind the last nearest point of the path */
static const double search_ahead = 8; /* m ahead of where the vehicle should be */
static const double slowest = 1;      /* m/s; curvature of the path driven is not measured below */

/* ---- movements --------------------------------------------------------------------------------------------- */

static void movement_at(const Movement *m, double time, double out[3])
{
    const double s = fmax(0, time - m->start), *c = m->c;
    if (s >= m->duration) {
        out[0] = m->end;
        out[1] = out[2] = 0;
        return;
    }
    out[0] = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
    out[1] = c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * 5 * c[5])));
    out[2] = 2 * c[2] + s * (6 * c[3] + s * (12 * c[4] + s * 20 * c[5]));
}

/* From wherever it is at `time`, with its rate and acceleration, to rest at `end` after `duration`. */
static void movement_turn(Movement *m, double time, double end, double duration)
{
    double now[3];
    movement_at(m, time, now);
    const double T = duration, way = end - now[0], v = now[1] * T, a = now[2] * T * T;
    m->start = time;
    m->duration = T;
    m->end = end;
    m->c[0] = now[0];
    m->c[1] = now[1];
    m->c[2] = now[2] / 2;
    m->c[3] = (10 * way - 6 * v - 1.5 * a) / (T * T * T);
    m->c[4] = (-15 * way + 8 * v + 1.5 * a) / (T * T * T * T);
    m->c[5] = (6 * way - 3 * v - 0.5 * a) / (T * T * T * T * T);
}

static Movement movement_rest(double value)
{
    return (Movement){.end = value, .c = {value}};
}

/* ---- path -------------------------------------------------------------------------------------------------- */

/* The point at a distance along the path, which goes on straight beyond its ends and round and round where closed. */
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

/* Where on the path between two distances along it the nearest point to `at` is. */
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
    /* no integration where a pedal is at its end */
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
    /* of the circle along the vehicle's axis through that point */
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
    double out[3];
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
