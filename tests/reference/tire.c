/* SPDX-License-Identifier: MIT */
#include "tire.h"

#include <quadmath.h>

static quad n(const Tire *tire, const char *name)
{
    return tire_number(tire, name);
}

static quad sgn(quad x)
{
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

static quad limit(quad x, quad low, quad high)
{
    return fminq(fmaxq(x, low), high);
}

/* a + b x */
static quad line(const Tire *tire, const char *a, const char *b, quad x)
{
    return n(tire, a) + n(tire, b) * x;
}

/* ---- PAC2002 ------------------------------------------------------------------------------------------------ */

static quad magic(quad B, quad C, quad E, quad x)
{
    quad y = B * x;
    return C * atanq(y - E * (y - atanq(y)));
}

/* cos m(B, C, E, x + shift) / cos m(B, C, E, shift) */
static quad weight(quad B, quad C, quad E, quad x, quad shift)
{
    return cosq(magic(B, C, E, x + shift)) / cosq(magic(B, C, E, shift));
}

/* What the equations for both directions and for moments share. */
typedef struct Pacejka {
    const Tire *tire;
    quad nominal, scaled, load, share, d; /* F_z0, F_z0', F, Fz / F */
    quad kappa, alpha, camber, lmux, lmuy;
    quad kx, fx; /* Kx, Fx */
    quad shy, svy, muy, ky, bycy;
    quad fyk, fy; /* Fyk, Fy */
} Pacejka;

static Pacejka pacejka(const Tire *t, const TireInput *in)
{
    Pacejka p = {.tire = t, .nominal = n(t, "FNOMIN")};
    p.scaled = n(t, "LFZO") * p.nominal;
    quad least = p.scaled / 1000;
    p.load = limit(in->load, least, fmaxq(n(t, "FZMAX"), least));
    p.share = in->load / p.load;
    p.d = (1 + in->strain) * (p.load - p.scaled) / p.scaled;
    p.kappa = limit(in->kappa, n(t, "KPUMIN"), n(t, "KPUMAX"));
    p.alpha = limit(in->alpha, n(t, "ALPMIN"), n(t, "ALPMAX"));
    p.camber = limit(in->camber, n(t, "CAMMIN"), n(t, "CAMMAX"));
    p.lmux = n(t, "LMUX") * in->friction;
    p.lmuy = n(t, "LMUY") * in->friction;
    return p;
}

static void along(Pacejka *p)
{
    const Tire *t = p->tire;
    quad d = p->d, g = p->camber * n(t, "LGAX");
    quad k = p->kappa + line(t, "PHX1", "PHX2", d) * n(t, "LHX");
    quad C = n(t, "PCX1") * n(t, "LCX");
    quad D = line(t, "PDX1", "PDX2", d) * (1 - n(t, "PDX3") * g * g) * p->lmux * p->load;
    quad E = line(t, "PEX1", "PEX2", d) + n(t, "PEX3") * d * d;
    E = fminq(1, E * (1 - n(t, "PEX4") * sgn(k)) * n(t, "LEX"));
    p->kx = p->load * line(t, "PKX1", "PKX2", d) * expq(n(t, "PKX3") * d) * n(t, "LKX");
    p->fx = D * sinq(magic(p->kx / (C * D), C, E, k)) + p->load * line(t, "PVX1", "PVX2", d) * n(t, "LVX") * p->lmux;
    if (t->mode == 4) {
        quad B = n(t, "RBX1") * cosq(atanq(n(t, "RBX2") * p->kappa)) * n(t, "LXAL");
        p->fx *= weight(B, n(t, "RCX1"), fminq(1, line(t, "REX1", "REX2", d)), p->alpha, n(t, "RHX1"));
    }
}

static void across(Pacejka *p)
{
    const Tire *t = p->tire;
    quad d = p->d, g = p->camber * n(t, "LGAY");
    p->shy = line(t, "PHY1", "PHY2", d) * n(t, "LHY") + n(t, "PHY3") * g * n(t, "LKG");
    p->svy =
        p->load * p->lmuy * (line(t, "PVY1", "PVY2", d) * n(t, "LVY") + line(t, "PVY3", "PVY4", d) * g * n(t, "LKG"));
    p->muy = line(t, "PDY1", "PDY2", d) * (1 - n(t, "PDY3") * g * g) * p->lmuy;
    p->ky = n(t, "PKY1") * p->nominal * sinq(2 * atanq(p->load / (n(t, "PKY2") * p->scaled))) *
            (1 - n(t, "PKY3") * fabsq(g)) * n(t, "LFZO") * n(t, "LKY");
    quad a = p->alpha + p->shy, C = n(t, "PCY1") * n(t, "LCY"), D = p->muy * p->load, B = p->ky / (C * D);
    quad E = line(t, "PEY1", "PEY2", d) * (1 - line(t, "PEY3", "PEY4", g) * sgn(a)) * n(t, "LEY");
    p->bycy = B * C;
    p->fyk = p->fy = D * sinq(magic(B, C, fminq(1, E), a)) + p->svy;
    if (t->mode == 4) {
        quad Bk = n(t, "RBY1") * cosq(atanq(n(t, "RBY2") * (p->alpha - n(t, "RBY3")))) * n(t, "LYKA");
        p->fyk *= weight(Bk, n(t, "RCY1"), fminq(1, line(t, "REY1", "REY2", d)), p->kappa, line(t, "RHY1", "RHY2", d));
        quad S = p->muy * p->load * (line(t, "RVY1", "RVY2", d) + n(t, "RVY3") * p->camber);
        S *= cosq(atanq(n(t, "RVY4") * p->alpha)) * sinq(n(t, "RVY5") * atanq(n(t, "RVY6") * p->kappa));
        p->fy = p->fyk + S * n(t, "LVYKA");
    }
}

static quad aligning(const Pacejka *p)
{
    const Tire *t = p->tire;
    quad d = p->d, g = p->camber * n(t, "LGAZ"), R = t->radius, d2 = d * d, C = n(t, "QCZ1");
    quad at = p->alpha + line(t, "QHZ1", "QHZ2", d) + line(t, "QHZ3", "QHZ4", d) * g;
    quad ar = p->alpha + p->shy + p->svy / p->ky;
    quad B = (line(t, "QBZ1", "QBZ2", d) + n(t, "QBZ3") * d2) * (1 + n(t, "QBZ4") * g + n(t, "QBZ5") * fabsq(g)) *
             n(t, "LKY") / p->lmuy;
    quad D = p->load * line(t, "QDZ1", "QDZ2", d) * (1 + n(t, "QDZ3") * g + n(t, "QDZ4") * g * g) * R / p->nominal;
    quad E = (line(t, "QEZ1", "QEZ2", d) + n(t, "QEZ3") * d2) *
             (1 + line(t, "QEZ4", "QEZ5", g) * 2 / acosq(-1) * atanq(B * C * at));
    quad Br = n(t, "QBZ9") * n(t, "LKY") / p->lmuy + n(t, "QBZ10") * p->bycy;
    quad Dr = p->load * R * p->lmuy * (line(t, "QDZ6", "QDZ7", d) * n(t, "LRES") + line(t, "QDZ8", "QDZ9", d) * g);
    if (t->mode == 4) {
        quad q = p->kx / p->ky * p->kappa;
        at = atanq(hypotq(tanq(at), q)) * sgn(at);
        ar = atanq(hypotq(tanq(ar), q)) * sgn(ar);
    }
    quad trail = D * n(t, "LTR") * cosq(magic(B, C, fminq(1, E), at)) * cosq(p->alpha);
    quad moment = -trail * p->fyk + Dr * cosq(atanq(Br * ar)) * cosq(p->alpha);
    if (t->mode == 4)
        moment += p->fx * R * n(t, "LS") *
                  (line(t, "SSZ1", "SSZ2", p->fy / p->nominal) + line(t, "SSZ3", "SSZ4", d) * p->camber);
    return moment;
}

static TireForces pacejka_forces(const Tire *t, const TireInput *in)
{
    Pacejka p = pacejka(t, in);
    bool has_x = t->mode == 1 || t->mode >= 3, has_y = t->mode >= 2;
    TireForces out = {0};
    along(&p);
    across(&p);
    if (!has_x)
        p.fx = 0;
    if (has_y) {
        out.mx =
            t->radius * p.load *
            (n(t, "QSX1") * n(t, "LVMX") + (n(t, "QSX3") * p.fy / p.nominal - n(t, "QSX2") * p.camber) * n(t, "LMX"));
        out.mz = aligning(&p);
        out.fy = p.fy;
    }
    if (t->mode != 2) {
        quad v = n(t, "LONGVL") != 0 ? in->forward / n(t, "LONGVL") : 0;
        out.my = -t->radius * p.load * n(t, "LMY") * tanhq(in->spin) *
                 (line(t, "QSY1", "QSY2", p.fx / p.nominal) + n(t, "QSY3") * fabsq(v) + n(t, "QSY4") * powq(v, 4));
    }
    out.fx = p.fx;
    quad *each[] = {&out.fx, &out.fy, &out.mx, &out.my, &out.mz};
    for (int i = 0; i < 5; ++i)
        *each[i] *= p.share;
    return out;
}

/* ---- TMeasy ------------------------------------------------------------------------------------------------- */

/* A number of a pair, at p times the nominal load. */
static quad force_at(const Tire *tire, const char *name, const char *twice, quad p)
{
    quad y1 = n(tire, name), y2 = n(tire, twice);
    return p * (2 * y1 - y2 / 2 - (y1 - y2 / 2) * p);
}

static quad slip_at(const Tire *tire, const char *name, const char *twice, quad p)
{
    return n(tire, name) + (n(tire, twice) - n(tire, name)) * (p - 1);
}

/* H(s) */
static quad characteristic(quad s, quad D, quad Fm, quad sm, quad Fs, quad ss)
{
    D = fmaxq(D, 2 * Fm / sm);
    if (s <= sm)
        return D * s / (1 + s / sm * (s / sm + D * sm / Fm - 2));
    if (s >= ss)
        return Fs;
    quad a = Fm * Fm / (sm * sm * sm * D), b = sm + (Fm - Fs) / (a * (ss - sm)), w = (s - sm) / (ss - sm);
    if (b > ss)
        return Fm - (Fm - Fs) * w * w * (3 - 2 * w);
    return s <= b ? Fm - a * (s - sm) * (s - sm) : Fs + a * (b - sm) / (ss - b) * (ss - s) * (ss - s);
}

/* n/L over y = abs(tan(alpha)) */
static quad relative_trail(const Tire *t, quad y, quad p)
{
    quad N = slip_at(t, "trail", "trail.2", p), q0 = slip_at(t, "sq0", "sq0.2", p), qe = slip_at(t, "sqe", "sqe.2", p);
    quad w = q0 / qe, u = y / q0, v = (qe - y) / (qe - q0);
    if (y <= q0)
        return N * ((1 - w) * (1 - u) + w * (1 - (3 - 2 * u) * u * u));
    return y < qe ? -N * (1 - w) * (u - 1) * v * v : 0;
}

static TireForces tmeasy_forces(const Tire *t, const TireInput *in)
{
    quad pn = n(t, "load"), p = limit(in->load / pn, 0.001, 3.5), q = in->friction / n(t, "friction");
    quad dx = force_at(t, "dfx0", "dfx0.2", p), dy = force_at(t, "dfy0", "dfy0.2", p);
    quad fxm = q * force_at(t, "fxm", "fxm.2", p), fym = q * force_at(t, "fym", "fym.2", p);
    quad fxs = q * force_at(t, "fxs", "fxs.2", p), fys = q * force_at(t, "fys", "fys.2", p);
    quad sxm = q * slip_at(t, "sxm", "sxm.2", p), sym = q * slip_at(t, "sym", "sym.2", p);
    quad sxs = q * slip_at(t, "sxs", "sxs.2", p), sys = q * slip_at(t, "sys", "sys.2", p);
    quad whole = fxm / dx + fym / dy;
    quad x = sxm / (sxm + sym) + fxm / dx / whole, y = sym / (sxm + sym) + fym / dy / whole;
    quad sx = in->kappa / x, sy = -tanq(in->alpha) / y, s = sqrtq(sx * sx + sy * sy + 1e-12);
    quad c = sqrtq(sx * sx + 5e-13) / s, d = sqrtq(sy * sy + 5e-13) / s;
    quad H =
        characteristic(s, hypotq(dx * x * c, dy * y * d), hypotq(fxm * c, fym * d), hypotq(sxm / x * c, sym / y * d),
                       hypotq(fxs * c, fys * d), hypotq(sxs / x * c, sys / y * d));
    TireForces out = {0};
    quad share = in->load / (p * pn), none = 1e-12 / (s * s);
    out.fx = share * ((1 - none) * H / s + none * x * fmaxq(dx, 2 * fxm / sxm)) * sx;
    out.fy = share * ((1 - none) * H / s + none * y * fmaxq(dy, 2 * fym / sym)) * sy;
    out.my = -n(t, "rolling_resistance") * t->radius * in->load * tanhq(in->spin);
    out.mz = -relative_trail(t, fabsq(tanq(in->alpha)), p) * sqrtq(8 * t->radius * fmaxq(in->deflection, 0)) * out.fy;
    return out;
}

/* ---- both --------------------------------------------------------------------------------------------------- */

TireForces tire_forces(const Tire *tire, const TireInput *in)
{
    return tire->tmeasy ? tmeasy_forces(tire, in) : pacejka_forces(tire, in);
}

quad rolling_radius(const Tire *tire, quad deflection)
{
    quad rho = fmaxq(deflection, 0);
    if (tire->tmeasy)
        return tire->radius - rho / 3;
    quad r = n(tire, "LFZO") * n(tire, "FNOMIN") / tire->stiffness;
    return tire->radius - r * (n(tire, "DREFF") * atanq(n(tire, "BREFF") * rho / r) + n(tire, "FREFF") * rho / r);
}

void relaxation_lengths(const Tire *t, const TireInput *in, quad length[2])
{
    quad R = t->radius;
    if (t->relaxation[0] > 0 || t->tmeasy) {
        length[0] = t->relaxation[0];
        length[1] = t->relaxation[1];
        return;
    }
    Pacejka p = pacejka(t, in);
    length[0] = R / 2;
    length[1] = R;
    if (n(t, "PTX1") != 0)
        length[0] = p.load * line(t, "PTX1", "PTX2", p.d) * expq(-n(t, "PTX3") * p.d) * R / p.nominal * n(t, "LSGKP");
    if (n(t, "PTY1") != 0)
        length[1] = n(t, "PTY1") * sinq(2 * atanq(p.load / (n(t, "PTY2") * p.scaled))) * R * n(t, "LFZO") *
                    n(t, "LSGAL") * (1 - n(t, "PKY3") * fabsq(p.camber * n(t, "LGAY")));
    length[0] = fmaxq(length[0], R / 5);
    length[1] = fmaxq(length[1], R / 5);
}
