/* SPDX-License-Identifier: MIT
 * PAC2002 and TMeasy, equation by equation as models/TIRES.md has them, in its notation. */
#include "model/model.h"
#include "model/tire_numbers.h"
#include "world/tire.h"

#include <math.h>

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* ---- PAC2002 --------------------------------------------------------------------------------------------- */

enum { MODE_LONGITUDINAL = 1, MODE_LATERAL, MODE_BOTH, MODE_COMBINED };

#define P(name) (p[PAC_##name])

/* The load of the formulas, and what follows from it. */
typedef struct Load {
    double nominal; /* F_z0' */
    double F, d;
} Load;

static Load load_of(const double *p, double fz)
{
    Load load = {.nominal = P(LFZO) * P(FNOMIN)};
    const double least = load.nominal / 1000;
    load.F = clamp(fz, least, fmax(P(FZMAX), least));
    load.d = (load.F - load.nominal) / load.nominal;
    return load;
}

static double sign(double x)
{
    return (x > 0) - (x < 0);
}

/* m(B, C, E, x), the argument of sine and cosine in the Magic Formula. */
static double magic(double B, double C, double E, double x)
{
    return C * atan(B * x - E * (B * x - atan(B * x)));
}

/* What the parts of the tire have in common. */
typedef struct Magic {
    const double *p;
    double R, F, d;
    double kappa, alpha, gamma, mux, muy; /* limited to their ranges; scaling of friction, the road's included */
    double Kx, Ky, By, Cy, muyF, SHy, SVy;
} Magic;

static double longitudinal(Magic *t)
{
    const double *p = t->p, F = t->F, d = t->d, gx = t->gamma * P(LGAX);
    const double kx = t->kappa + (P(PHX1) + P(PHX2) * d) * P(LHX);
    const double SVx = F * (P(PVX1) + P(PVX2) * d) * P(LVX) * t->mux;
    const double mu = (P(PDX1) + P(PDX2) * d) * (1 - P(PDX3) * gx * gx) * t->mux;
    const double C = P(PCX1) * P(LCX), D = mu * F;
    const double E = fmin(1, (P(PEX1) + P(PEX2) * d + P(PEX3) * d * d) * (1 - P(PEX4) * sign(kx)) * P(LEX));
    t->Kx = F * (P(PKX1) + P(PKX2) * d) * exp(P(PKX3) * d) * P(LKX);
    return D * sin(magic(t->Kx / (C * D), C, E, kx)) + SVx;
}

static double lateral(Magic *t)
{
    const double *p = t->p, F = t->F, d = t->d, gy = t->gamma * P(LGAY);
    t->SHy = (P(PHY1) + P(PHY2) * d) * P(LHY) + P(PHY3) * gy * P(LKG);
    t->SVy = F * ((P(PVY1) + P(PVY2) * d) * P(LVY) + (P(PVY3) + P(PVY4) * d) * gy * P(LKG)) * t->muy;
    t->muyF = (P(PDY1) + P(PDY2) * d) * (1 - P(PDY3) * gy * gy) * t->muy * F;
    t->Cy = P(PCY1) * P(LCY);
    const double ay = t->alpha + t->SHy;
    const double E = fmin(1, (P(PEY1) + P(PEY2) * d) * (1 - (P(PEY3) + P(PEY4) * gy) * sign(ay)) * P(LEY));
    t->Ky = P(PKY1) * P(FNOMIN) * sin(2 * atan(F / (P(PKY2) * P(LFZO) * P(FNOMIN)))) * (1 - P(PKY3) * fabs(gy)) *
            P(LFZO) * P(LKY);
    t->By = t->Ky / (t->Cy * t->muyF);
    return t->muyF * sin(magic(t->By, t->Cy, E, ay)) + t->SVy;
}

/* What side slip leaves of the longitudinal force. */
static double longitudinal_share(const Magic *t)
{
    const double *p = t->p, shift = P(RHX1), B = P(RBX1) * cos(atan(P(RBX2) * t->kappa)) * P(LXAL);
    const double C = P(RCX1), E = fmin(1, P(REX1) + P(REX2) * t->d);
    return cos(magic(B, C, E, t->alpha + shift)) / cos(magic(B, C, E, shift));
}

/* The same of the lateral one, to which kappa adds *added. */
static double lateral_share(const Magic *t, double *added)
{
    const double *p = t->p, shift = P(RHY1) + P(RHY2) * t->d;
    const double B = P(RBY1) * cos(atan(P(RBY2) * (t->alpha - P(RBY3)))) * P(LYKA);
    const double C = P(RCY1), E = fmin(1, P(REY1) + P(REY2) * t->d);
    *added = t->muyF * (P(RVY1) + P(RVY2) * t->d + P(RVY3) * t->gamma) * cos(atan(P(RVY4) * t->alpha)) *
             sin(P(RVY5) * atan(P(RVY6) * t->kappa)) * P(LVYKA);
    return cos(magic(B, C, E, t->kappa + shift)) / cos(magic(B, C, E, shift));
}

/* A slip angle with the share q of longitudinal slip. */
static double joint_angle(double angle, double q)
{
    const double slope = tan(angle);
    return atan(sqrt(slope * slope + q * q)) * sign(angle);
}

/* Mz of trail and residual moment; fy: what the trail is the arm of. */
static double aligning(const Magic *t, bool combined, double fy)
{
    const double *p = t->p, F = t->F, d = t->d, gz = t->gamma * P(LGAZ), two_over_pi = 0.636619772367581343;
    const double B =
        (P(QBZ1) + P(QBZ2) * d + P(QBZ3) * d * d) * (1 + P(QBZ4) * gz + P(QBZ5) * fabs(gz)) * P(LKY) / t->muy;
    const double C = P(QCZ1);
    const double D = F * (P(QDZ1) + P(QDZ2) * d) * (1 + P(QDZ3) * gz + P(QDZ4) * gz * gz) * t->R / P(FNOMIN) * P(LTR);
    const double Br = P(QBZ9) * P(LKY) / t->muy + P(QBZ10) * t->By * t->Cy;
    const double Dr = F * ((P(QDZ6) + P(QDZ7) * d) * P(LRES) + (P(QDZ8) + P(QDZ9) * d) * gz) * t->R * t->muy;
    double at = t->alpha + P(QHZ1) + P(QHZ2) * d + (P(QHZ3) + P(QHZ4) * d) * gz;
    double ar = t->alpha + t->SHy + t->SVy / t->Ky;
    const double E = fmin(1, (P(QEZ1) + P(QEZ2) * d + P(QEZ3) * d * d) *
                                 (1 + (P(QEZ4) + P(QEZ5) * gz) * two_over_pi * atan(B * C * at)));
    if (combined) {
        const double q = t->Kx / t->Ky * t->kappa;
        at = joint_angle(at, q);
        ar = joint_angle(ar, q);
    }
    const double trail = D * cos(magic(B, C, E, at)) * cos(t->alpha);
    return -trail * fy + Dr * cos(atan(Br * ar)) * cos(t->alpha);
}

static double rolling_moment(const Magic *t, const TireMotion *motion, double fx)
{
    /* files in which nothing depends on the speed may lack the speed that it is relative to */
    const double *p = t->p, v = P(QSY3) != 0 || P(QSY4) != 0 ? motion->speed / P(LONGVL) : 0;
    return -t->R * t->F * (P(QSY1) + P(QSY2) * fx / P(FNOMIN) + P(QSY3) * fabs(v) + P(QSY4) * v * v * v * v) * P(LMY) *
           tanh(motion->spin);
}

static TireForces pac2002(const Tire *tire, const TireMotion *motion)
{
    const double *p = tire->number;
    const Load load = load_of(p, motion->fz);
    const bool combined = tire->mode == MODE_COMBINED, both = combined || tire->mode == MODE_BOTH;
    Magic t = {.p = p,
               .R = tire->radius,
               .F = load.F,
               .d = load.d,
               .kappa = clamp(motion->kappa, P(KPUMIN), P(KPUMAX)),
               .alpha = clamp(motion->alpha, P(ALPMIN), P(ALPMAX)),
               .gamma = clamp(motion->camber, P(CAMMIN), P(CAMMAX)),
               .mux = P(LMUX) * motion->friction,
               .muy = P(LMUY) * motion->friction};
    TireForces out = {0};
    if (both || tire->mode == MODE_LONGITUDINAL)
        out.fx = longitudinal(&t);
    if (both || tire->mode == MODE_LATERAL) {
        double reduced = out.fy = lateral(&t);
        if (combined) {
            double added;
            out.fx *= longitudinal_share(&t);
            reduced *= lateral_share(&t, &added);
            out.fy = reduced + added;
        }
        out.mx = t.R * t.F * (P(QSX1) * P(LVMX) + (-P(QSX2) * t.gamma + P(QSX3) * out.fy / P(FNOMIN)) * P(LMX));
        out.mz = aligning(&t, combined, reduced);
        if (combined)
            out.mz +=
                t.R * (P(SSZ1) + P(SSZ2) * out.fy / P(FNOMIN) + (P(SSZ3) + P(SSZ4) * t.d) * t.gamma) * P(LS) * out.fx;
    }
    if (tire->mode != MODE_LATERAL)
        out.my = rolling_moment(&t, motion, out.fx);
    const double scale = motion->fz / load.F;
    return (TireForces){scale * out.fx, scale * out.fy, scale * out.mx, scale * out.my, scale * out.mz};
}

static double pac2002_radius(const Tire *tire, double deflection)
{
    const double *p = tire->number, r = P(LFZO) * P(FNOMIN) / tire->stiffness, s = fmax(deflection, 0) / r;
    return tire->radius - r * (P(DREFF) * atan(P(BREFF) * s) + P(FREFF) * s);
}

static void pac2002_relaxation(const Tire *tire, double fz, double camber, double sigma[2])
{
    const double *p = tire->number, R = tire->radius, least = 0.2 * R;
    const Load load = load_of(p, fz);
    const double gy = clamp(camber, P(CAMMIN), P(CAMMAX)) * P(LGAY);
    sigma[0] = load.F * (P(PTX1) + P(PTX2) * load.d) * exp(-P(PTX3) * load.d) * R / P(FNOMIN) * P(LSGKP);
    sigma[1] =
        P(PTY1) * sin(2 * atan(load.F / (P(PTY2) * load.nominal))) * (1 - P(PKY3) * fabs(gy)) * R * P(LFZO) * P(LSGAL);
    for (int i = 0; i < 2; ++i)
        sigma[i] = fmax(sigma[i], least);
}

#undef P

/* ---- TMeasy ---------------------------------------------------------------------------------------------- */

/* Of the load p, relative to the nominal one: forces, and slips. */
static double tmeasy_force(const double *two, double p)
{
    return p * (2 * two[0] - 0.5 * two[1] - (two[0] - 0.5 * two[1]) * p);
}

static double tmeasy_slip(const double *two, double p)
{
    return two[0] + (two[1] - two[0]) * (p - 1);
}

/* A curve of force over slip: initial slope D, maximum Fm at sm, sliding force Fs from ss on. */
typedef struct Curve {
    double D, Fm, Fs, sm, ss;
} Curve;

static double curve_at(const Curve *c, double s)
{
    if (s <= c->sm) {
        const double x = s / c->sm, steep = fmax(c->D * c->sm / c->Fm, 2);
        return steep * c->Fm * x / (1 + x * (x + steep - 2));
    }
    if (s >= c->ss)
        return c->Fs;
    const double fall = c->Fm - c->Fs, steep = fmax(c->D * c->sm / c->Fm, 2) * c->Fm / c->sm;
    const double a = c->Fm / c->sm * (c->Fm / c->sm) / (steep * c->sm), b = c->sm + fall / (a * (c->ss - c->sm));
    if (b > c->ss) {
        const double w = (s - c->sm) / (c->ss - c->sm);
        return c->Fm - fall * w * w * (3 - 2 * w);
    }
    if (s <= b)
        return c->Fm - a * (s - c->sm) * (s - c->sm);
    return c->Fs + a * (b - c->sm) / (c->ss - b) * (c->ss - s) * (c->ss - s);
}

/* n/L over y = abs(tan(alpha)). */
static double tmeasy_trail(double N, double sq0, double sqe, double y)
{
    const double w = sq0 / sqe, x = y / sq0;
    if (y >= sqe)
        return 0;
    if (y <= sq0)
        return N * ((1 - w) * (1 - x) + w * (1 - (3 - 2 * x) * x * x));
    const double left = (sqe - y) / (sqe - sq0);
    return -N * (1 - w) * (x - 1) * left * left;
}

static TireForces tmeasy(const Tire *tire, const TireMotion *motion)
{
    const double *number = tire->number, nominal = number[TMEASY_load];
    const double p = fmax(fmin(motion->fz / nominal, 3.5), 0.001), scale = motion->fz / (p * nominal);
    const double q = motion->friction / number[TMEASY_friction];
    const double dfx = tmeasy_force(number + TMEASY_dfx0, p), dfy = tmeasy_force(number + TMEASY_dfy0, p);
    const double fxm = q * tmeasy_force(number + TMEASY_fxm, p), fym = q * tmeasy_force(number + TMEASY_fym, p);
    const double fxs = q * tmeasy_force(number + TMEASY_fxs, p), fys = q * tmeasy_force(number + TMEASY_fys, p);
    const double sxm = q * tmeasy_slip(number + TMEASY_sxm, p), sym = q * tmeasy_slip(number + TMEASY_sym, p);
    const double sxs = q * tmeasy_slip(number + TMEASY_sxs, p), sys = q * tmeasy_slip(number + TMEASY_sys, p);

    const double flat[2] = {fxm / dfx, fym / dfy};
    const double X = sxm / (sxm + sym) + flat[0] / (flat[0] + flat[1]);
    const double Y = sym / (sxm + sym) + flat[1] / (flat[0] + flat[1]);
    const double sx = motion->kappa / X, sy = -tan(motion->alpha) / Y;
    const double s = sqrt(sx * sx + sy * sy + 1e-12);
    const double c = sqrt(sx * sx + 5e-13) / s, n = sqrt(sy * sy + 5e-13) / s;
    const Curve curve = {.D = hypot(dfx * X * c, dfy * Y * n),
                         .Fm = hypot(fxm * c, fym * n),
                         .Fs = hypot(fxs * c, fys * n),
                         .sm = hypot(sxm / X * c, sym / Y * n),
                         .ss = hypot(sxs / X * c, sys / Y * n)};
    const double force = curve_at(&curve, s) / s, still = 1e-12 / (s * s);
    const double kx = fmax(dfx, 2 * fxm / sxm) * X, ky = fmax(dfy, 2 * fym / sym) * Y;
    const double trail = tmeasy_trail(tmeasy_slip(number + TMEASY_trail, p), tmeasy_slip(number + TMEASY_sq0, p),
                                      tmeasy_slip(number + TMEASY_sqe, p), fabs(tan(motion->alpha)));
    TireForces out = {.fx = scale * (force + still * (kx - force)) * sx,
                      .fy = scale * (force + still * (ky - force)) * sy};
    out.mz = -trail * sqrt(8 * tire->radius * fmax(motion->deflection, 0)) * out.fy;
    out.my = -number[TMEASY_rolling_resistance] * tire->radius * motion->fz * tanh(motion->spin);
    return out;
}

/* ---- either ---------------------------------------------------------------------------------------------- */

double tire_rolling_radius(const Tire *tire, double deflection)
{
    if (tire->type == TIRE_PAC2002)
        return pac2002_radius(tire, deflection);
    return (2 * tire->radius + (tire->radius - fmax(deflection, 0))) / 3;
}

void tire_relaxation(const Tire *tire, double fz, double camber, double sigma[2])
{
    if (tire->type == TIRE_PAC2002)
        pac2002_relaxation(tire, fz, camber, sigma);
    for (int i = 0; i < 2; ++i)
        if (tire->relaxation[i] > 0)
            sigma[i] = tire->relaxation[i];
}

TireForces tire_forces(const Tire *tire, const TireMotion *motion)
{
    return tire->type == TIRE_PAC2002 ? pac2002(tire, motion) : tmeasy(tire, motion);
}
