/* SPDX-License-Identifier: MIT */
#include "wheel.h"

#include "tire.h"

#include <quadmath.h>
#include <string.h>

const char *const fast_name[FAST_STATES] = {"spin", "slip_x", "slip_y", "brake"};

bool wheel_has(const Wheel *wheel, int state)
{
    return wheel->tire && (state < 3 || wheel->brake);
}

const WheelColumn wheel_column[WHEEL_COLUMNS] = {{"_load.fz", FZ, false},
                                                 {"_load.deflection", RHO, false},
                                                 {"_load.deflection_rate", RHO_RATE, false},
                                                 {"_load.height", HEIGHT, false},
                                                 {"_tire.fx", FX, false},
                                                 {"_tire.fy", FY, false},
                                                 {"_tire.mx", MX, false},
                                                 {"_tire.my", MY, false},
                                                 {"_tire.mz", MZ, false},
                                                 {"_tire.kappa", KAPPA, false},
                                                 {"_tire.alpha", ALPHA, false},
                                                 {"_tire.camber", CAMBER, false},
                                                 {"_tire.spin", SPIN, false},
                                                 {"_tire.spin_rate", SPIN_RATE, false},
                                                 {"_tire.drive", DRIVE, false},
                                                 {"_tire.brake", BRAKE, false},
                                                 {"_contact.x", CONTACT, false},
                                                 {"_contact.y", CONTACT_Y, false},
                                                 {"_contact.z", CONTACT_Z, false},
                                                 {".spin.rate", SPIN_RATE, true},
                                                 {".slip_x.rate", SLIP_X_RATE, true},
                                                 {".slip_y.rate", SLIP_Y_RATE, true},
                                                 {".brake.rate", WINDUP_RATE, true}};

bool wheel_shows(const Wheel *wheel, int column)
{
    int result = wheel_column[column].result;
    return result <= HEIGHT || (wheel->tire && (result != WINDUP_RATE || wheel->brake));
}

static quad smooth(quad s)
{
    return s <= 0 ? 0 : s >= 1 ? 1 : s * s * (3 - 2 * s);
}

/* h, dh/dx, dh/dy */
static void road_at(const Road *road, quad x, quad y, quad h[3])
{
    memset(h, 0, 3 * sizeof *h);
    if (road->amplitude == 0)
        return;
    quad k = 2 * acosq(-1) / road->wavelength, phase = k * (x - road->x0) + road->phase_per_y * y;
    h[0] = road->amplitude * sinq(phase);
    h[1] = road->amplitude * k * cosq(phase);
    h[2] = road->amplitude * road->phase_per_y * cosq(phase);
}

static quad friction_at(const Road *road, quad x, quad y)
{
    quad p = 1, half = 0.5;
    if (road->fade == 0)
        return 1;
    p *= smooth((x - road->x[0]) / road->fade + half) * smooth((road->x[1] - x) / road->fade + half);
    p *= smooth((y - road->y[0]) / road->fade + half) * smooth((road->y[1] - y) / road->fade + half);
    return 1 + p * (road->friction - 1);
}

/* All that a wheel's results follow from, but for formulas, in one row so that each can be varied. */
enum { CENTER, VELOCITY = 3, OMEGA = 6, AXIS = 9, FAST = 12, STRAIN = FAST + FAST_STATES, WHEEL_INPUTS };

/* The wheel between road and carrier while its equations are gone through. */
typedef struct Rolling {
    const Model *model;
    const Configuration *configuration;
    const Road *road;
    const Wheel *wheel;
} Rolling;

static quad norm(const quad a[3])
{
    return sqrtq(quad_dot(a, a, 3));
}

/* a x b and its length; 1e-6 where that is less */
static quad cross_unit(const quad a[3], const quad b[3], quad out[3])
{
    quad_cross(a, b, out);
    quad length = fmaxq(norm(out), 1e-6);
    for (int i = 0; i < 3; ++i)
        out[i] /= length;
    return length;
}

static void normal_at(const Road *road, quad x, quad y, quad n[3], quad *height)
{
    quad h[3];
    road_at(road, x, y, h);
    n[0] = -h[1];
    n[1] = -h[2];
    n[2] = 1;
    quad length = norm(n);
    for (int i = 0; i < 3; ++i)
        n[i] /= length;
    *height = h[0];
}

/* Where the wheel touches and how deep: TIRES.md section 3. */
typedef struct Contact {
    quad n[3], e_x[3], e_y[3], arm[3], gamma, r_l, v[3], fade;
} Contact;

static Contact contact_of(const Rolling *of, const quad *in, quad *out)
{
    const Tire *tire = of->wheel->tire;
    const quad *c = in + CENTER, *s = in + AXIS, *omega = in + OMEGA;
    quad R = tire->radius, n0[3], e0[3], down[3], height, d[3], turn[3], across[3];
    Contact to;
    normal_at(of->road, c[0], c[1], n0, &height);
    cross_unit(s, n0, e0);
    quad_cross(s, e0, down);
    quad p[2] = {c[0] + R * down[0], c[1] + R * down[1]};
    normal_at(of->road, p[0], p[1], to.n, &height);
    cross_unit(s, to.n, to.e_x);
    quad_cross(to.n, to.e_x, to.e_y);
    quad_cross(s, to.e_x, d);
    quad lean = quad_dot(s, to.n, 3), cosine = fmaxq(-quad_dot(d, to.n, 3), 0.05);
    to.gamma = asinq(fminq(1, fmaxq(-1, lean)));
    const quad above[3] = {c[0] - p[0], c[1] - p[1], c[2] - height};
    to.r_l = quad_dot(above, to.n, 3) / cosine;
    quad along = quad_dot(omega, s, 3);
    for (int i = 0; i < 3; ++i) {
        to.arm[i] = to.r_l * d[i];
        turn[i] = omega[i] - along * s[i];
        out[CONTACT + i] = c[i] + to.arm[i];
    }
    quad_cross(turn, to.arm, across);
    for (int i = 0; i < 3; ++i)
        to.v[i] = in[VELOCITY + i] + across[i];
    quad rho = R - to.r_l, rho_rate = -quad_dot(to.v, to.n, 3) / cosine;
    quad elastic = tire->stiffness * fmaxq(rho, 0) + tire->bottom_stiffness * fmaxq(rho - tire->bottom, 0);
    to.fade = smooth(rho / of->wheel->fade);
    out[FZ] = rho > 0 ? fmaxq(0, elastic + tire->damping * to.fade * rho_rate) : 0;
    out[RHO] = rho;
    out[RHO_RATE] = rho_rate;
    out[HEIGHT] = height;
    out[CAMBER] = to.gamma;
    return to;
}

/* Slip, its rates and the tire's forces: section 4. */
static void slip_and_forces(const Rolling *of, const quad *in, const Contact *at, quad *out)
{
    const Tire *tire = of->wheel->tire;
    quad spin = in[FAST], kappa = in[FAST + 1], tangent = in[FAST + 2], tau = 0.01, kappa_0 = 0.3;
    quad side = of->wheel->mirrored ? -1 : 1;
    quad vx = quad_dot(at->e_x, at->v, 3), vy = quad_dot(at->e_y, at->v, 3);
    quad vsx = vx - spin * rolling_radius(tire, out[RHO]), low = 1 - smooth(fabsq(vx) / tire->low_speed), sigma[2];
    TireInput input = {.load = out[FZ],
                       .deflection = out[RHO],
                       .camber = side * at->gamma,
                       .forward = vx,
                       .spin = spin,
                       .strain = in[STRAIN],
                       .friction = friction_at(of->road, out[CONTACT], out[CONTACT + 1])};
    relaxation_lengths(tire, &input, sigma);
    out[SLIP_X_RATE] = (-at->fade * vsx - (fabsq(vx) + low * fabsq(vsx) / kappa_0) * kappa) / sigma[0];
    out[SLIP_Y_RATE] = (at->fade * vy - (fabsq(vx) + low * fabsq(vy) / kappa_0) * tangent) / sigma[1];
    out[KAPPA] = input.kappa = kappa + tau * low * out[SLIP_X_RATE];
    out[ALPHA] = atanq(tangent + tau * low * out[SLIP_Y_RATE]);
    input.alpha = side * out[ALPHA];
    TireForces forces = tire_forces(tire, &input);
    out[FX] = forces.fx;
    out[FY] = side * forces.fy;
    out[MX] = side * forces.mx;
    out[MY] = forces.my;
    out[MZ] = side * forces.mz;
}

static void brake_of(const Rolling *of, const quad *in, quad *out)
{
    const Wheel *wheel = of->wheel;
    out[BRAKE] = out[WINDUP_RATE] = 0;
    if (!wheel->brake)
        return;
    quad zeta = in[FAST + 3], z = wheel->windup, u = in[FAST] - quad_dot(in + AXIS, in + OMEGA, 3);
    quad eased = u / hypotq(1, u / (100 * z)), a = zeta * u > 0 ? smooth((fabsq(zeta) - 0.7) / 0.3) : 0;
    out[WINDUP_RATE] = (eased - a * zeta * fabsq(eased)) / z;
    quad most = fmaxq(0, law_value(of->model, of->configuration, wheel->brake, (Locals){.spin = in[FAST]}));
    out[BRAKE] = most * fminq(1, fmaxq(-1, zeta + 0.01 * out[WINDUP_RATE]));
}

static void roll(const Rolling *of, const quad *in, quad *out)
{
    const Wheel *wheel = of->wheel;
    const quad *s = in + AXIS, *omega = in + OMEGA;
    quad I = wheel->spin_inertia, moment[3], spun[3];
    Contact at = contact_of(of, in, out);
    slip_and_forces(of, in, &at, out);
    brake_of(of, in, out);
    out[SPIN] = in[FAST];
    out[DRIVE] = law_value(of->model, of->configuration, wheel->drive, (Locals){.spin = in[FAST]});
    for (int i = 0; i < 3; ++i)
        out[FORCE + i] = out[FX] * at.e_x[i] + out[FY] * at.e_y[i] + out[FZ] * at.n[i];
    quad_cross(at.arm, out + FORCE, moment);
    for (int i = 0; i < 3; ++i)
        moment[i] += out[MX] * at.e_x[i] + out[MY] * at.e_y[i] + out[MZ] * at.n[i];
    quad about = quad_dot(s, moment, 3);
    out[SPIN_RATE] = (about + out[DRIVE] - out[BRAKE]) / I;
    quad_cross(omega, s, spun);
    for (int i = 0; i < 3; ++i) {
        out[TORQUE + i] = moment[i] - (about - out[BRAKE]) * s[i] - I * in[FAST] * spun[i];
        out[REACTION + i] = -out[DRIVE] * s[i];
    }
}

/* FORMAT.md section 8 */
static void press(const Rolling *of, const quad *in, quad *out)
{
    const Wheel *wheel = of->wheel;
    const quad *c = in + CENTER, *v = in + VELOCITY;
    quad h[3];
    road_at(of->road, c[0], c[1], h);
    quad d = wheel->radius + h[0] - c[2], d_rate = h[1] * v[0] + h[2] * v[1] - v[2];
    out[HEIGHT] = h[0];
    out[RHO] = d;
    out[RHO_RATE] = d_rate;
    out[FZ] = out[FORCE + 2] =
        d > 0 ? fmaxq(0, wheel->stiffness * d + wheel->damping * smooth(d / wheel->fade) * d_rate) : 0;
}

static void widen(const double *from, quad *to)
{
    for (int i = 0; i < 3; ++i)
        to[i] = from[i];
}

/* Angular velocity of a body, world. */
static void turning(const Configuration *configuration, int body, quad omega[3])
{
    quad G[3][4], own[3];
    euler_rate_matrix(configuration->q[body] + 3, G);
    for (int i = 0; i < 3; ++i)
        own[i] = 2 * quad_dot(G[i], configuration->rate[body] + 3, 4);
    rotate(configuration->q[body] + 3, own, omega);
}

/* Inputs, and their sizes: of the centre its coordinates, of other vectors their lengths. */
static void gather(const Rolling *of, const quad fast[FAST_STATES], quad in[WHEEL_INPUTS], quad size[WHEEL_INPUTS])
{
    const Wheel *wheel = of->wheel;
    const quad *q = of->configuration->q[wheel->body], *rate = of->configuration->rate[wheel->body];
    quad arm[3], B[3][4], axis[3], world[3];
    from_com(of->model, wheel->body, wheel->center, arm);
    rotate(q + 3, arm, world);
    rotation_slope(q + 3, arm, B);
    for (int i = 0; i < 3; ++i) {
        in[CENTER + i] = q[i] + world[i];
        in[VELOCITY + i] = rate[i] + quad_dot(B[i], rate + 3, 4);
    }
    turning(of->configuration, wheel->body, in + OMEGA);
    widen(wheel->axis, axis);
    rotate(q + 3, axis, in + AXIS);
    memcpy(in + FAST, fast, FAST_STATES * sizeof *in);
    in[STRAIN] = 0; /* where the load is limited, its change does not show that terms that follow it cancel */
    size[STRAIN] = 1;
    for (int i = 0; i < STRAIN; ++i)
        size[i] = i < VELOCITY || i >= FAST ? fabsq(in[i]) : norm(in + i / 3 * 3);
}

void wheel_evaluate(const Model *model, const Configuration *configuration, const Road *road, int wheel,
                    const quad fast[FAST_STATES], WheelState *out)
{
    const Rolling of = {.model = model, .configuration = configuration, .road = road, .wheel = &model->wheel[wheel]};
    void (*evaluate)(const Rolling *, const quad *, quad *) = of.wheel->tire ? roll : press;
    const quad step = 1e-15; /* relative; within it no corner of the equations is likely to lie */
    quad in[WHEEL_INPUTS], size[WHEEL_INPUTS], moved[WHEEL_INPUTS], other[WHEEL_RESULTS] = {0};
    memset(out, 0, sizeof *out);
    gather(&of, fast, in, size);
    evaluate(&of, in, out->value);
    for (int i = 0; i < WHEEL_RESULTS; ++i)
        out->scale[i] = fabsq(out->value[i]);
    /* what is always a difference of equals has no slope: the contact point's height over a level road, the moment of
     * the load about the axis */
    for (int i = 0; i < 3; ++i)
        out->scale[CONTACT + i] += size[CENTER + i];
    if (of.wheel->tire)
        out->scale[SPIN_RATE] += of.wheel->tire->radius * norm(out->value + FORCE) / of.wheel->spin_inertia;
    for (int k = 0; k < WHEEL_INPUTS; ++k) {
        memcpy(moved, in, sizeof in);
        moved[k] += step * size[k];
        evaluate(&of, moved, other);
        for (int i = 0; i < WHEEL_RESULTS; ++i)
            out->scale[i] += fabsq(other[i] - out->value[i]) / step;
    }
}

void wheel_drive(const Model *model, const Configuration *configuration, int index, quad torque, quad scale,
                 WheelState *out)
{
    const Wheel *wheel = &model->wheel[index];
    quad axis[3], s[3];
    widen(wheel->axis, axis);
    rotate(configuration->q[wheel->body] + 3, axis, s);
    out->value[DRIVE] = torque;
    out->scale[DRIVE] = scale;
    for (int i = 0; i < 3; ++i) {
        out->value[REACTION + i] = -torque * s[i];
        out->scale[REACTION + i] = scale;
    }
}

void add_wheel(const Model *model, const Configuration *configuration, int index, const quad x[WHEEL_RESULTS],
               quad (*Q)[BODY_COORDINATES])
{
    const Wheel *wheel = &model->wheel[index];
    quad s[3];
    from_com(model, wheel->body, wheel->center, s);
    add_force(configuration, wheel->body, s, x + FORCE, Q);
    add_torque(configuration, wheel->body, x + TORQUE, Q);
    if (wheel->tire && wheel->drive_body != GROUND)
        add_torque(configuration, wheel->drive_body, x + REACTION, Q);
}
