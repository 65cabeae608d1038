/* SPDX-License-Identifier: MIT
 * One wheel with a tire, as models/TIRES.md has it, in its notation. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/tire.h"
#include "world/wheel.h"

#include <math.h>
#include <string.h>

static const double tau = 0.01;           /* s */
static const double standing_slip = 0.3;  /* kappa_0 */
static const double least_product = 1e-6; /* norm(s x n) of a wheel that lies flat */
static const double least_cosine = 0.05;  /* of camber */

/* S(s) */
static double smooth(double s)
{
    s = fmin(fmax(s, 0), 1);
    return s * s * (3 - 2 * s);
}

/* ---- contact --------------------------------------------------------------------------------------------- */

/* Height and normal of the road. */
static int road_at(const Ground *ground, double x, double y, double *height, double normal[3])
{
    double h[3] = {0, 0, 0};
    if (ground->road)
        ground->road->height(ground->road, ground->lane, ground->time, x, y, h);
    if (!gic_finite(h, 3))
        return GIC_ERROR_ROAD;
    const double norm = sqrt(h[1] * h[1] + h[2] * h[2] + 1);
    *height = h[0];
    normal[0] = -h[1] / norm;
    normal[1] = -h[2] / norm;
    normal[2] = 1 / norm;
    return GIC_OK;
}

static int friction_at(const Ground *ground, const double point[3], double *friction)
{
    *friction = 1;
    if (ground->road && ground->road->friction)
        *friction = ground->road->friction(ground->road, ground->lane, ground->time, point[0], point[1]);
    return gic_finite(friction, 1) && *friction > 0 ? GIC_OK : GIC_ERROR_ROAD;
}

/* Along s x n. */
static void rolling_direction(const double s[3], const double n[3], double out[3])
{
    cross3(s, n, out);
    const double norm = fmax(norm3(out), least_product);
    for (int i = 0; i < 3; ++i)
        out[i] /= norm;
}

/* Angular velocity of the carrier across the axis. */
static void across_axis(const WheelMotion *motion, double out[3])
{
    copy3(motion->omega, out);
    add_scaled3(-dot3(motion->omega, motion->axis), motion->axis, out);
}

int wheel_touch(const Wheel *wheel, const Tire *tire, const Ground *ground, const WheelMotion *motion, Rolling *out)
{
    const double *c = motion->center, *s = motion->axis;
    double height, under[3], first[3], down[3], place[3], up[3], arm[3], turn[3], velocity[3], swing[3];
    int status = road_at(ground, c[0], c[1], &height, under);
    if (status != GIC_OK)
        return status;
    rolling_direction(s, under, first);
    cross3(s, first, down);
    copy3(c, place);
    add_scaled3(tire->radius, down, place);
    status = road_at(ground, place[0], place[1], &out->height, out->normal);
    if (status != GIC_OK)
        return status;
    place[2] = out->height;

    const double *n = out->normal;
    rolling_direction(s, n, out->forward);
    cross3(n, out->forward, out->left);
    cross3(s, out->forward, down);
    const double cosine = fmax(-dot3(down, n), least_cosine);
    sub3(c, place, up);
    const double loaded = dot3(up, n) / cosine;
    out->camber = asin(fmin(fmax(dot3(s, n), -1), 1));
    out->deflection = tire->radius - loaded;
    copy3(c, out->point);
    add_scaled3(loaded, down, out->point);
    status = friction_at(ground, out->point, &out->friction);

    sub3(out->point, c, arm);
    across_axis(motion, turn);
    cross3(turn, arm, swing);
    add3(motion->velocity, swing, velocity);
    out->deflection_rate = -dot3(velocity, n) / cosine;
    out->speed[0] = dot3(out->forward, velocity);
    out->speed[1] = dot3(out->left, velocity);
    out->rolling_radius = tire_rolling_radius(tire, out->deflection);
    out->fade = smooth(out->deflection / wheel->fade);
    out->elastic =
        tire->stiffness * fmax(out->deflection, 0) + tire->bottom_stiffness * fmax(out->deflection - tire->bottom, 0);
    out->damping = tire->damping * out->fade * out->deflection_rate;
    out->fz = out->deflection > 0 ? fmax(0, out->elastic + out->damping) : 0;
    return status;
}

/* ---- slip ------------------------------------------------------------------------------------------------ */

/* kappa, alpha and the rates of kappa' and t'. */
static void find_slip(const Wheel *wheel, const Tire *tire, const double *fast, double *rate, Rolling *out)
{
    const double sliding[2] = {out->speed[0] - fast[FAST_SPIN] * out->rolling_radius, out->speed[1]};
    const double speed = fabs(out->speed[0]), low = 1 - smooth(speed / tire->low_speed);
    const double source[2] = {-sliding[0], sliding[1]};
    double sigma[2], slip[2];
    tire_relaxation(tire, out->fz, wheel->mirrored ? -out->camber : out->camber, sigma);
    for (int i = 0; i < 2; ++i) {
        const double now = fast[FAST_SLIP_X + i];
        rate[FAST_SLIP_X + i] =
            (out->fade * source[i] - (speed + low * fabs(sliding[i]) / standing_slip) * now) / sigma[i];
        slip[i] = now + tau * low * rate[FAST_SLIP_X + i];
    }
    out->kappa = slip[0];
    out->alpha = atan(slip[1]);
}

static void find_tire_forces(const Wheel *wheel, const Tire *tire, double spin, Rolling *out)
{
    const double side = wheel->mirrored ? -1 : 1;
    const TireMotion motion = {.fz = out->fz,
                               .kappa = out->kappa,
                               .alpha = side * out->alpha,
                               .camber = side * out->camber,
                               .friction = out->friction,
                               .deflection = out->deflection,
                               .speed = out->speed[0],
                               .spin = spin};
    out->tire = (TireForces){0};
    if (out->fz > 0)
        out->tire = tire_forces(tire, &motion);
    out->tire.fy *= side;
    out->tire.mx *= side;
    out->tire.mz *= side;
}

/* ---- brake, wheel, carrier ------------------------------------------------------------------------------- */

/* T_b and the rate of zeta; u: Omega relative to the carrier. */
static double brake_torque(const Wheel *wheel, double most, double u, double zeta, double *rate)
{
    const double over = u / (100 * wheel->windup), soft = u / sqrt(1 + over * over);
    const double slipping = zeta * u > 0 ? smooth((fabs(zeta) - 0.7) / 0.3) : 0;
    *rate = soft / wheel->windup - slipping * zeta * fabs(soft) / wheel->windup;
    return fmax(0, most) * fmin(1, fmax(-1, zeta + tau * *rate));
}

void wheel_drive(const WheelMotion *motion, double spin, double drive, Rolling *out)
{
    out->power += (drive - out->drive) * (spin - motion->drive_turn);
    out->drive = drive;
    for (int i = 0; i < 3; ++i)
        out->reaction[i] = -drive * motion->axis[i];
}

void wheel_turn(const Wheel *wheel, const Tire *tire, const WheelMotion *motion, double drive, double brake,
                const double *fast, double *rate, Rolling *out)
{
    const double *s = motion->axis, spin = fast[FAST_SPIN], u = spin - dot3(s, motion->omega);
    double arm[3], moment[3], momentum[3], gyro[3], turn[3];
    find_slip(wheel, tire, fast, rate, out);
    find_tire_forces(wheel, tire, spin, out);
    out->drive = 0;
    out->brake = wheel->brake ? brake_torque(wheel, brake, u, fast[FAST_BRAKE], &rate[FAST_BRAKE]) : 0;

    for (int i = 0; i < 3; ++i)
        out->force[i] = out->tire.fx * out->forward[i] + out->tire.fy * out->left[i] + out->fz * out->normal[i];
    sub3(out->point, motion->center, arm);
    cross3(arm, out->force, moment);
    add_scaled3(out->tire.mx, out->forward, moment);
    add_scaled3(out->tire.my, out->left, moment);
    add_scaled3(out->tire.mz, out->normal, moment);
    out->about = dot3(s, moment);
    rate[FAST_SPIN] = (out->about + drive - out->brake) / wheel->spin_inertia;

    for (int i = 0; i < 3; ++i)
        momentum[i] = wheel->spin_inertia * spin * s[i];
    cross3(motion->omega, momentum, gyro);
    sub3(moment, gyro, out->torque);
    add_scaled3(out->brake - out->about, s, out->torque);
    across_axis(motion, turn);
    out->power = dot3(out->force, motion->velocity) + dot3(moment, turn) + out->about * spin - out->brake * u;
    wheel_drive(motion, spin, drive, out);
}

void wheel_roll(const Wheel *wheel, const Tire *tire, const Rolling *rolling, double *fast)
{
    const double *speed = rolling->speed;
    memset(fast, 0, sizeof *fast * (size_t)wheel_fast_states(wheel));
    fast[FAST_SPIN] = speed[0] / rolling->rolling_radius;
    if (speed[0] != 0)
        fast[FAST_SLIP_Y] = smooth(fabs(speed[0]) / tire->low_speed) * speed[1] / fabs(speed[0]);
}
