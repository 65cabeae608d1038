/* SPDX-License-Identifier: MIT
 * TMeasy (models/TIRES.md section 6). */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "vehicle/wheel.h"

/* m; less than the rounding of any wheel's place */
static const double least_deflection = 1e-16;

#define NUMBER(name) (tire->number[TMEASY_##name])
/* A force at p times the nominal load; a slip or length there. */
#define FORCE(name) force_at(dag, p, NUMBER(name), NUMBER(name##_TWICE))
#define SLIP(name) slip_at(dag, p, NUMBER(name), NUMBER(name##_TWICE))

static Ex literal(Dag *dag, double value)
{
    return ex_literal(dag, value);
}

static Ex square(Dag *dag, Ex x)
{
    return ex_mul(dag, x, x);
}

static Ex one_minus(Dag *dag, Ex x)
{
    return ex_sub(dag, literal(dag, 1), x);
}

/* sqrt((x a)^2 + (y b)^2) */
static Ex blend(Dag *dag, Ex x, Ex a, Ex y, Ex b)
{
    return ex_sqrt(dag, ex_add(dag, square(dag, ex_mul(dag, x, a)), square(dag, ex_mul(dag, y, b))));
}

static Ex force_at(Dag *dag, Ex p, double once, double twice)
{
    double bend = once - 0.5 * twice;
    return ex_mul(dag, p, ex_sub(dag, literal(dag, once + bend), ex_mul(dag, literal(dag, bend), p)));
}

static Ex slip_at(Dag *dag, Ex p, double once, double twice)
{
    return ex_add(dag, literal(dag, once), ex_mul(dag, literal(dag, twice - once), ex_sub(dag, p, literal(dag, 1))));
}

/* The force of one resultant slip s: initial slope D, maximum Fm at sm, sliding force Fs from ss on. */
static Ex resultant(Dag *dag, Ex s, Ex D, Ex Fm, Ex Fs, Ex sm, Ex ss)
{
    /* at least the slope with which the maximum is at sm */
    Ex two = literal(dag, 2), start = ex_op(dag, OP_MAX, ex_mul(dag, D, sm), ex_add(dag, Fm, Fm), 0); /* D sm */
    Ex steep = ex_sub(dag, ex_div(dag, start, Fm), two), r = ex_div(dag, s, sm);
    Ex below = ex_add(dag, literal(dag, 1), ex_mul(dag, r, ex_add(dag, r, steep)));
    Ex rising = ex_div(dag, ex_mul(dag, start, r), below);
    Ex drop = ex_sub(dag, Fm, Fs), a = ex_div(dag, square(dag, ex_div(dag, Fm, sm)), start);
    Ex width = ex_sub(dag, ss, sm), past = ex_sub(dag, s, sm), rest = ex_sub(dag, ss, s);
    Ex turn = ex_div(dag, drop, ex_mul(dag, a, width)), b = ex_add(dag, sm, turn); /* turn = b - sm */
    Ex after = ex_sub(dag, ss, b);
    Ex arch = ex_sub(dag, Fm, ex_mul(dag, a, square(dag, past)));
    Ex tail = ex_add(dag, Fs, ex_mul(dag, ex_div(dag, ex_mul(dag, a, turn), after), square(dag, rest)));
    Ex w = ex_div(dag, past, width);
    Ex smooth = ex_mul(dag, square(dag, w), ex_sub(dag, literal(dag, 3), ex_add(dag, w, w)));
    Ex slope = ex_sub(dag, Fm, ex_mul(dag, drop, smooth));
    Ex parabolas = ex_op(dag, OP_POSITIVE, ex_sub(dag, s, b), tail, arch);
    Ex falling = ex_op(dag, OP_POSITIVE, ex_sub(dag, b, ss), slope, parabolas);
    Ex sliding = ex_op(dag, OP_POSITIVE, rest, falling, Fs);
    return ex_op(dag, OP_POSITIVE, past, sliding, rising);
}

/* A force by its normalized slip: H of the resultant slip, or where slip vanishes, w = 1, the initial slope of its own
 * direction, which is at least the one with which its maximum is at `most`. */
static Ex by_slip(Dag *dag, Ex H, Ex w, Ex slope, Ex force, Ex most, Ex hat)
{
    Ex least = ex_div(dag, ex_add(dag, force, force), most);
    Ex start = ex_mul(dag, hat, ex_op(dag, OP_MAX, slope, least, 0));
    return ex_add(dag, ex_mul(dag, one_minus(dag, w), H), ex_mul(dag, w, start));
}

/* n/L at the slip y >= 0. */
static Ex relative_trail(Dag *dag, Ex y, Ex most, Ex sq0, Ex sqe)
{
    Ex w = ex_div(dag, sq0, sqe), r = ex_div(dag, y, sq0), three = literal(dag, 3);
    Ex cubic = one_minus(dag, ex_mul(dag, ex_sub(dag, three, ex_add(dag, r, r)), square(dag, r)));
    Ex near = ex_mul(dag, most, ex_add(dag, ex_mul(dag, one_minus(dag, w), one_minus(dag, r)), ex_mul(dag, w, cubic)));
    Ex past = ex_sub(dag, y, sq0), rest = ex_sub(dag, sqe, y);
    Ex far = square(dag, ex_div(dag, rest, ex_sub(dag, sqe, sq0)));
    far = ex_neg(dag, ex_mul(dag, ex_mul(dag, most, one_minus(dag, w)), ex_mul(dag, ex_div(dag, past, sq0), far)));
    Ex beyond = ex_op(dag, OP_POSITIVE, rest, far, 0);
    return ex_op(dag, OP_POSITIVE, past, beyond, near);
}

void tmeasy_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES])
{
    const double heaviest = 3.5, lightest = 0.001; /* relative to the nominal load */
    const double tiny = 1e-12;                     /* keeps the formulas smooth at slip zero */
    double pn = NUMBER(load);
    Ex p = ex_op(dag, OP_MIN, ex_mul(dag, literal(dag, 1 / pn), rolling->load), literal(dag, heaviest), 0);
    p = ex_op(dag, OP_MAX, p, literal(dag, lightest), 0);
    Ex share = ex_div(dag, rolling->load, ex_mul(dag, literal(dag, pn), p));
    Ex q = ex_mul(dag, literal(dag, 1 / NUMBER(friction)), rolling->friction);
    Ex dfx0 = FORCE(dfx0), dfy0 = FORCE(dfy0);
    Ex fxm = ex_mul(dag, q, FORCE(fxm)), fxs = ex_mul(dag, q, FORCE(fxs));
    Ex fym = ex_mul(dag, q, FORCE(fym)), fys = ex_mul(dag, q, FORCE(fys));
    Ex sxm = ex_mul(dag, q, SLIP(sxm)), sxs = ex_mul(dag, q, SLIP(sxs));
    Ex sym = ex_mul(dag, q, SLIP(sym)), sys = ex_mul(dag, q, SLIP(sys));
    /* slips normalized so that both directions are alike */
    Ex startx = ex_div(dag, fxm, dfx0), starty = ex_div(dag, fym, dfy0);
    Ex slips = ex_add(dag, sxm, sym), starts = ex_add(dag, startx, starty);
    Ex hatx = ex_add(dag, ex_div(dag, sxm, slips), ex_div(dag, startx, starts));
    Ex haty = ex_add(dag, ex_div(dag, sym, slips), ex_div(dag, starty, starts));
    Ex sx = ex_div(dag, rolling->kappa, hatx), sy = ex_neg(dag, ex_div(dag, rolling->tangent, haty));
    Ex x2 = ex_add(dag, square(dag, sx), literal(dag, tiny / 2)),
       y2 = ex_add(dag, square(dag, sy), literal(dag, tiny / 2));
    Ex s2 = ex_add(dag, x2, y2), s = ex_sqrt(dag, s2);
    Ex c = ex_sqrt(dag, ex_div(dag, x2, s2)), n = ex_sqrt(dag, ex_div(dag, y2, s2));
    Ex D = blend(dag, ex_mul(dag, dfx0, hatx), c, ex_mul(dag, dfy0, haty), n);
    Ex Fm = blend(dag, fxm, c, fym, n), Fs = blend(dag, fxs, c, fys, n);
    Ex sm = blend(dag, ex_div(dag, sxm, hatx), c, ex_div(dag, sym, haty), n);
    Ex ss = blend(dag, ex_div(dag, sxs, hatx), c, ex_div(dag, sys, haty), n);
    Ex H = ex_div(dag, resultant(dag, s, D, Fm, Fs, sm, ss), s), w = ex_div(dag, literal(dag, tiny), s2);
    force[TIRE_FX] = ex_mul(dag, ex_mul(dag, share, by_slip(dag, H, w, dfx0, fxm, sxm, hatx)), sx);
    force[TIRE_FY] = ex_mul(dag, ex_mul(dag, share, by_slip(dag, H, w, dfy0, fym, sym, haty)), sy);
    force[TIRE_MX] = 0;
    /* of a wheel that just touches, the length alone has no derivative; with the force it has: 0 */
    Ex contact = ex_op(dag, OP_MAX, rolling->deflection, literal(dag, least_deflection), 0);
    Ex length = ex_sqrt(dag, ex_mul(dag, literal(dag, 8 * tire->radius), contact));
    Ex trail = relative_trail(dag, ex_op(dag, OP_ABS, rolling->tangent, 0, 0), SLIP(trail), SLIP(sq0), SLIP(sqe));
    force[TIRE_MZ] = ex_neg(dag, ex_mul(dag, ex_mul(dag, trail, length), force[TIRE_FY]));
    Ex resistance = ex_mul(dag, literal(dag, -NUMBER(rolling_resistance) * tire->radius), rolling->load);
    force[TIRE_MY] = ex_mul(dag, resistance, ex_op(dag, OP_TANH, rolling->spin, 0, 0));
}

Ex tmeasy_radius(Dag *dag, const Tire *tire, Ex loaded)
{
    Ex R = literal(dag, tire->radius), two = literal(dag, 2);
    Ex sum = ex_add(dag, ex_mul(dag, two, R), ex_op(dag, OP_MIN, loaded, R, 0));
    return ex_div(dag, sum, literal(dag, 3));
}
