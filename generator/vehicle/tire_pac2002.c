/* SPDX-License-Identifier: MIT
 * The Magic Formula of PAC2002 and MF5.2 (models/TIRES.md section 5). Coefficients are literals, so that terms of
 * coefficients that are 0 vanish. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "vehicle/wheel.h"

#include <math.h>

#define NUMBER(name) (tire->number[PAC_##name])
#define LITERAL(name) ex_literal(dag, NUMBER(name))

/* Values that the formulas share. */
typedef struct Magic {
    Dag *dag;
    const Tire *tire;
    Ex F, d;                         /* load of the formulas; its relative excess over the nominal one */
    Ex kappa, alpha, tangent, gamma; /* limited; tangent of alpha */
    Ex mux, muy;                     /* LMUX and LMUY with the friction of the road */
    Ex Fx, Fy, Fyk;                  /* Fyk: Fy without the part induced by kappa */
    Ex Kx, Ky, By, Cy, shift;        /* shift: SHf */
} Magic;

/* ---- pieces ------------------------------------------------------------------------------------------------ */

static Ex square(Dag *dag, Ex x)
{
    return ex_mul(dag, x, x);
}

/* a + b x */
static Ex line(Dag *dag, double a, double b, Ex x)
{
    return ex_add(dag, ex_literal(dag, a), ex_mul(dag, ex_literal(dag, b), x));
}

/* a + b x + c x^2 */
static Ex parabola(Dag *dag, double a, double b, double c, Ex x)
{
    return ex_add(dag, line(dag, a, b, x), ex_mul(dag, ex_literal(dag, c), square(dag, x)));
}

static Ex sign(Dag *dag, Ex x)
{
    Ex negative = ex_op(dag, OP_POSITIVE, ex_neg(dag, x), ex_literal(dag, -1), 0);
    return ex_op(dag, OP_POSITIVE, x, ex_literal(dag, 1), negative);
}

static Ex atan_of(Dag *dag, Ex x)
{
    return ex_op(dag, OP_ATAN, x, 0, 0);
}

/* sqrt(1 + x^2) = 1 / cos(atan(x)). */
static Ex secant(Dag *dag, Ex x)
{
    return ex_sqrt(dag, ex_add(dag, ex_literal(dag, 1), square(dag, x)));
}

/* sin(2 atan(x)) */
static Ex sine_of_twice(Dag *dag, Ex x)
{
    return ex_div(dag, ex_add(dag, x, x), ex_add(dag, ex_literal(dag, 1), square(dag, x)));
}

static Ex at_most_one(Dag *dag, Ex x)
{
    return ex_op(dag, OP_MIN, ex_literal(dag, 1), x, 0);
}

/* m(B, C, E, x) = C atan(B x - E (B x - atan(B x))) */
static Ex magic(Dag *dag, Ex B, Ex C, Ex E, Ex x)
{
    Ex Bx = ex_mul(dag, B, x);
    if (!ex_is(dag, E, 0))
        Bx = ex_sub(dag, Bx, ex_mul(dag, E, ex_sub(dag, Bx, atan_of(dag, Bx))));
    return ex_mul(dag, C, atan_of(dag, Bx));
}

/* cos m(x) / cos m(shift): the weight of combined slip. */
static Ex weight(Dag *dag, Ex B, Ex C, Ex E, Ex x, Ex shift)
{
    Ex above = ex_op(dag, OP_COS, magic(dag, B, C, E, x), 0, 0);
    return ex_div(dag, above, ex_op(dag, OP_COS, magic(dag, B, C, E, shift), 0, 0));
}

/* x limited to [low, high], if these are limits. */
static Ex limit(Dag *dag, Ex x, double low, double high)
{
    if (low > -PAC_UNLIMITED)
        x = ex_op(dag, OP_MAX, x, ex_literal(dag, low), 0);
    return high < PAC_UNLIMITED ? ex_op(dag, OP_MIN, x, ex_literal(dag, high), 0) : x;
}

/* The tangent of a limit of alpha; an unlimited value for angles that alpha never reaches. */
static double tangent_of_limit(double angle)
{
    double sine, cosine;
    if (fabs(angle) >= 1.57)
        return angle < 0 ? -PAC_UNLIMITED : PAC_UNLIMITED;
    portable_sincos(angle, &sine, &cosine);
    return sine / cosine;
}

static double nominal_load(const Tire *tire)
{
    return NUMBER(LFZO) * NUMBER(FNOMIN);
}

static Ex formula_load(Dag *dag, const Tire *tire, Ex load)
{
    double least = nominal_load(tire) / 1000;
    return limit(dag, load, least, fmax(NUMBER(FZMAX), least));
}

static Ex above_nominal(Dag *dag, const Tire *tire, Ex F)
{
    double nominal = nominal_load(tire);
    return ex_div(dag, ex_sub(dag, F, ex_literal(dag, nominal)), ex_literal(dag, nominal));
}

/* sin(2 atan(F / (scale F_z0'))), the growth of stiffness and relaxation with the load; scale is PKY2 or PTY2. */
static Ex degression(Dag *dag, const Tire *tire, Ex F, double scale)
{
    return sine_of_twice(dag, ex_mul(dag, ex_literal(dag, 1 / (scale * nominal_load(tire))), F));
}

static Ex camber_loss(Dag *dag, const Tire *tire, Ex gamma)
{
    Ex gy = ex_mul(dag, gamma, LITERAL(LGAY));
    return ex_sub(dag, ex_literal(dag, 1), ex_mul(dag, LITERAL(PKY3), ex_op(dag, OP_ABS, gy, 0, 0)));
}

/* ---- one component after the other --------------------------------------------------------------------------- */

static void longitudinal(Magic *m)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    Ex gx = ex_mul(dag, m->gamma, LITERAL(LGAX));
    Ex SHx = ex_mul(dag, LITERAL(LHX), line(dag, NUMBER(PHX1), NUMBER(PHX2), m->d));
    Ex SVx = ex_mul(dag, LITERAL(LVX), line(dag, NUMBER(PVX1), NUMBER(PVX2), m->d));
    SVx = ex_mul(dag, m->F, ex_mul(dag, SVx, m->mux));
    Ex kx = ex_add(dag, m->kappa, SHx);
    Ex camber = ex_sub(dag, ex_literal(dag, 1), ex_mul(dag, LITERAL(PDX3), square(dag, gx)));
    Ex mu = ex_mul(dag, ex_mul(dag, line(dag, NUMBER(PDX1), NUMBER(PDX2), m->d), camber), m->mux);
    Ex C = ex_mul(dag, LITERAL(PCX1), LITERAL(LCX)), D = ex_mul(dag, mu, m->F);
    Ex bend = parabola(dag, NUMBER(PEX1), NUMBER(PEX2), NUMBER(PEX3), m->d);
    Ex lean = ex_sub(dag, ex_literal(dag, 1), ex_mul(dag, LITERAL(PEX4), sign(dag, kx)));
    Ex E = at_most_one(dag, ex_mul(dag, LITERAL(LEX), ex_mul(dag, bend, lean)));
    Ex growth = ex_op(dag, OP_EXP, ex_mul(dag, LITERAL(PKX3), m->d), 0, 0);
    m->Kx = ex_mul(dag, LITERAL(LKX), ex_mul(dag, m->F, line(dag, NUMBER(PKX1), NUMBER(PKX2), m->d)));
    m->Kx = ex_mul(dag, m->Kx, growth);
    Ex B = ex_div(dag, m->Kx, ex_mul(dag, C, D));
    m->Fx = ex_add(dag, ex_mul(dag, D, ex_op(dag, OP_SIN, magic(dag, B, C, E, kx), 0, 0)), SVx);
}

static void lateral(Magic *m)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    Ex gy = ex_mul(dag, m->gamma, LITERAL(LGAY)), tilt = ex_mul(dag, gy, LITERAL(LKG));
    Ex SHy = ex_mul(dag, LITERAL(LHY), line(dag, NUMBER(PHY1), NUMBER(PHY2), m->d));
    SHy = ex_add(dag, SHy, ex_mul(dag, LITERAL(PHY3), tilt));
    Ex SVy = ex_mul(dag, LITERAL(LVY), line(dag, NUMBER(PVY1), NUMBER(PVY2), m->d));
    SVy = ex_add(dag, SVy, ex_mul(dag, line(dag, NUMBER(PVY3), NUMBER(PVY4), m->d), tilt));
    SVy = ex_mul(dag, m->F, ex_mul(dag, SVy, m->muy));
    Ex ay = ex_add(dag, m->alpha, SHy);
    Ex camber = ex_sub(dag, ex_literal(dag, 1), ex_mul(dag, LITERAL(PDY3), square(dag, gy)));
    Ex mu = ex_mul(dag, ex_mul(dag, line(dag, NUMBER(PDY1), NUMBER(PDY2), m->d), camber), m->muy);
    Ex D = ex_mul(dag, mu, m->F);
    Ex lean = ex_mul(dag, line(dag, NUMBER(PEY3), NUMBER(PEY4), gy), sign(dag, ay));
    Ex E = ex_mul(dag, LITERAL(LEY), ex_sub(dag, ex_literal(dag, 1), lean));
    E = at_most_one(dag, ex_mul(dag, line(dag, NUMBER(PEY1), NUMBER(PEY2), m->d), E));
    double stiffness = NUMBER(PKY1) * NUMBER(FNOMIN) * NUMBER(LFZO) * NUMBER(LKY);
    m->Ky = ex_mul(dag, ex_literal(dag, stiffness), degression(dag, tire, m->F, NUMBER(PKY2)));
    m->Ky = ex_mul(dag, m->Ky, camber_loss(dag, tire, m->gamma));
    m->Cy = ex_mul(dag, LITERAL(PCY1), LITERAL(LCY));
    m->By = ex_div(dag, m->Ky, ex_mul(dag, m->Cy, D));
    m->shift = ex_add(dag, SHy, ex_div(dag, SVy, m->Ky));
    m->Fyk = ex_add(dag, ex_mul(dag, D, ex_op(dag, OP_SIN, magic(dag, m->By, m->Cy, E, ay), 0, 0)), SVy);
    m->Fy = m->Fyk;
    if (tire->mode != 4)
        return;
    /* combined slip: weight by kappa, and the part induced by kappa */
    Ex shift = line(dag, NUMBER(RHY1), NUMBER(RHY2), m->d);
    Ex steer = ex_mul(dag, LITERAL(RBY2), ex_sub(dag, m->alpha, LITERAL(RBY3)));
    Ex B = ex_div(dag, ex_mul(dag, LITERAL(RBY1), LITERAL(LYKA)), secant(dag, steer));
    Ex Eyk = at_most_one(dag, line(dag, NUMBER(REY1), NUMBER(REY2), m->d));
    m->Fyk = ex_mul(dag, m->Fyk, weight(dag, B, LITERAL(RCY1), Eyk, ex_add(dag, m->kappa, shift), shift));
    Ex induced = ex_add(dag, line(dag, NUMBER(RVY1), NUMBER(RVY2), m->d), ex_mul(dag, LITERAL(RVY3), m->gamma));
    induced = ex_mul(dag, ex_mul(dag, LITERAL(LVYKA), induced), D);
    induced = ex_div(dag, induced, secant(dag, ex_mul(dag, LITERAL(RVY4), m->alpha)));
    Ex angle = ex_mul(dag, LITERAL(RVY5), atan_of(dag, ex_mul(dag, LITERAL(RVY6), m->kappa)));
    m->Fy = ex_add(dag, m->Fyk, ex_mul(dag, induced, ex_op(dag, OP_SIN, angle, 0, 0)));
}

/* Weight Fx by alpha. */
static void combine_longitudinal(Magic *m)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    Ex shift = LITERAL(RHX1), steep = ex_mul(dag, LITERAL(RBX2), m->kappa);
    Ex B = ex_div(dag, ex_mul(dag, LITERAL(RBX1), LITERAL(LXAL)), secant(dag, steep));
    Ex E = at_most_one(dag, line(dag, NUMBER(REX1), NUMBER(REX2), m->d));
    m->Fx = ex_mul(dag, m->Fx, weight(dag, B, LITERAL(RCX1), E, ex_add(dag, m->alpha, shift), shift));
}

/* Aligning torque from residual torque and trail, with equivalent angles for combined slip. */
static Ex aligning(const Magic *m)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    const double two_over_pi = 0.63661977236758134308;
    const bool combined = tire->mode == 4;
    Ex gz = ex_mul(dag, m->gamma, LITERAL(LGAZ)), one = ex_literal(dag, 1), R0 = ex_literal(dag, tire->radius);
    Ex SHt = line(dag, NUMBER(QHZ1), NUMBER(QHZ2), m->d);
    SHt = ex_add(dag, SHt, ex_mul(dag, line(dag, NUMBER(QHZ3), NUMBER(QHZ4), m->d), gz));
    Ex at = ex_add(dag, m->alpha, SHt), ar = ex_add(dag, m->alpha, m->shift);
    Ex stiff = ex_div(dag, LITERAL(LKY), m->muy);
    Ex Bt = ex_add(dag, line(dag, 1, NUMBER(QBZ4), gz), ex_mul(dag, LITERAL(QBZ5), ex_op(dag, OP_ABS, gz, 0, 0)));
    Bt = ex_mul(dag, ex_mul(dag, parabola(dag, NUMBER(QBZ1), NUMBER(QBZ2), NUMBER(QBZ3), m->d), Bt), stiff);
    Ex Ct = LITERAL(QCZ1), scale = ex_literal(dag, tire->radius / NUMBER(FNOMIN) * NUMBER(LTR));
    Ex Dt = ex_mul(dag, line(dag, NUMBER(QDZ1), NUMBER(QDZ2), m->d), parabola(dag, 1, NUMBER(QDZ3), NUMBER(QDZ4), gz));
    Dt = ex_mul(dag, scale, ex_mul(dag, m->F, Dt));
    Ex lean = ex_mul(dag, line(dag, NUMBER(QEZ4), NUMBER(QEZ5), gz), ex_literal(dag, two_over_pi));
    lean = ex_mul(dag, lean, atan_of(dag, ex_mul(dag, ex_mul(dag, Bt, Ct), at)));
    Ex Et = ex_mul(dag, parabola(dag, NUMBER(QEZ1), NUMBER(QEZ2), NUMBER(QEZ3), m->d), ex_add(dag, one, lean));
    Et = at_most_one(dag, Et);
    Ex Br = ex_add(dag, ex_mul(dag, LITERAL(QBZ9), stiff), ex_mul(dag, LITERAL(QBZ10), ex_mul(dag, m->By, m->Cy)));
    Ex Dr = ex_mul(dag, LITERAL(LRES), line(dag, NUMBER(QDZ6), NUMBER(QDZ7), m->d));
    Dr = ex_add(dag, Dr, ex_mul(dag, line(dag, NUMBER(QDZ8), NUMBER(QDZ9), m->d), gz));
    Dr = ex_mul(dag, ex_mul(dag, R0, m->F), ex_mul(dag, Dr, m->muy));
    if (combined) {
        Ex q = square(dag, ex_mul(dag, ex_div(dag, m->Kx, m->Ky), m->kappa));
        Ex *const angle[2] = {&at, &ar};
        for (int i = 0; i < 2; ++i) {
            Ex tangent = ex_op(dag, OP_TAN, *angle[i], 0, 0);
            Ex whole = atan_of(dag, ex_sqrt(dag, ex_add(dag, square(dag, tangent), q)));
            *angle[i] = ex_mul(dag, whole, sign(dag, *angle[i]));
        }
    }
    Ex trail = ex_mul(dag, Dt, ex_op(dag, OP_COS, magic(dag, Bt, Ct, Et, at), 0, 0));
    Ex residual = ex_div(dag, Dr, secant(dag, ex_mul(dag, Br, ar)));
    Ex Mz = ex_div(dag, ex_sub(dag, residual, ex_mul(dag, trail, m->Fyk)), secant(dag, m->tangent));
    if (!combined)
        return Mz;
    Ex arm = ex_add(dag, LITERAL(SSZ1), ex_mul(dag, ex_literal(dag, NUMBER(SSZ2) / NUMBER(FNOMIN)), m->Fy));
    arm = ex_add(dag, arm, ex_mul(dag, line(dag, NUMBER(SSZ3), NUMBER(SSZ4), m->d), m->gamma));
    return ex_add(dag, Mz, ex_mul(dag, ex_mul(dag, ex_literal(dag, tire->radius * NUMBER(LS)), arm), m->Fx));
}

static Ex overturning(const Magic *m)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    Ex side = ex_mul(dag, ex_literal(dag, NUMBER(QSX3) / NUMBER(FNOMIN)), m->Fy);
    side = ex_mul(dag, LITERAL(LMX), ex_sub(dag, side, ex_mul(dag, LITERAL(QSX2), m->gamma)));
    Ex sum = ex_add(dag, ex_literal(dag, NUMBER(QSX1) * NUMBER(LVMX)), side);
    return ex_mul(dag, ex_mul(dag, ex_literal(dag, tire->radius), m->F), sum);
}

static Ex rolling_resistance(const Magic *m, Ex speed, Ex spin)
{
    Dag *dag = m->dag;
    const Tire *tire = m->tire;
    Ex v = ex_op(dag, OP_ABS, ex_mul(dag, ex_literal(dag, 1 / NUMBER(LONGVL)), speed), 0, 0);
    Ex sum = ex_add(dag, LITERAL(QSY1), ex_mul(dag, ex_literal(dag, NUMBER(QSY2) / NUMBER(FNOMIN)), m->Fx));
    sum = ex_add(dag, sum, ex_mul(dag, LITERAL(QSY3), v));
    sum = ex_add(dag, sum, ex_mul(dag, LITERAL(QSY4), square(dag, square(dag, v))));
    sum = ex_mul(dag, sum, ex_mul(dag, ex_literal(dag, -tire->radius * NUMBER(LMY)), m->F));
    return ex_mul(dag, sum, ex_op(dag, OP_TANH, spin, 0, 0));
}

/* ---- for wheels ---------------------------------------------------------------------------------------------- */

void pac2002_forces(Dag *dag, const Tire *tire, const Rolling *rolling, Ex force[TIRE_FORCES])
{
    Ex F = formula_load(dag, tire, rolling->load), share = ex_div(dag, rolling->load, F);
    Magic m = {.dag = dag,
               .tire = tire,
               .F = F,
               .d = above_nominal(dag, tire, F),
               .kappa = limit(dag, rolling->kappa, NUMBER(KPUMIN), NUMBER(KPUMAX)),
               .tangent =
                   limit(dag, rolling->tangent, tangent_of_limit(NUMBER(ALPMIN)), tangent_of_limit(NUMBER(ALPMAX))),
               .gamma = limit(dag, rolling->camber, NUMBER(CAMMIN), NUMBER(CAMMAX)),
               .mux = ex_mul(dag, LITERAL(LMUX), rolling->friction),
               .muy = ex_mul(dag, LITERAL(LMUY), rolling->friction)};
    const bool along = tire->mode != 0 && tire->mode != 2, across = tire->mode >= 2;
    m.alpha = atan_of(dag, m.tangent);
    if (along)
        longitudinal(&m);
    if (across)
        lateral(&m);
    if (tire->mode == 4)
        combine_longitudinal(&m);
    force[TIRE_FX] = m.Fx;
    force[TIRE_FY] = m.Fy;
    force[TIRE_MX] = across ? overturning(&m) : 0;
    force[TIRE_MY] = tire->mode != 2 ? rolling_resistance(&m, rolling->speed, rolling->spin) : 0;
    force[TIRE_MZ] = across ? aligning(&m) : 0;
    for (int i = 0; i < TIRE_FORCES; ++i)
        force[i] = ex_mul(dag, share, force[i]);
}

void pac2002_relaxation(Dag *dag, const Tire *tire, Ex load, Ex camber, Ex length[2])
{
    const double least = 0.2; /* relative to the radius */
    Ex F = formula_load(dag, tire, load), d = above_nominal(dag, tire, F);
    Ex gamma = limit(dag, camber, NUMBER(CAMMIN), NUMBER(CAMMAX));
    double along = tire->radius / NUMBER(FNOMIN) * NUMBER(LSGKP);
    double across = NUMBER(PTY1) * tire->radius * NUMBER(LFZO) * NUMBER(LSGAL);
    Ex growth = ex_op(dag, OP_EXP, ex_mul(dag, ex_literal(dag, -NUMBER(PTX3)), d), 0, 0);
    length[0] = ex_mul(dag, ex_mul(dag, F, line(dag, NUMBER(PTX1), NUMBER(PTX2), d)), growth);
    length[0] = ex_mul(dag, ex_literal(dag, along), length[0]);
    length[1] = ex_mul(dag, degression(dag, tire, F, NUMBER(PTY2)), camber_loss(dag, tire, gamma));
    length[1] = ex_mul(dag, ex_literal(dag, across), length[1]);
    for (int i = 0; i < 2; ++i)
        length[i] = ex_op(dag, OP_MAX, length[i], ex_literal(dag, least * tire->radius), 0);
}

Ex pac2002_radius(Dag *dag, const Tire *tire, Ex deflection)
{
    double nominal = nominal_load(tire) / tire->stiffness; /* deflection at the nominal load */
    Ex share = ex_mul(dag, ex_literal(dag, 1 / nominal), ex_op(dag, OP_MAX, deflection, 0, 0));
    Ex bend = ex_mul(dag, LITERAL(DREFF), atan_of(dag, ex_mul(dag, LITERAL(BREFF), share)));
    bend = ex_add(dag, bend, ex_mul(dag, LITERAL(FREFF), share));
    return ex_sub(dag, ex_literal(dag, tire->radius), ex_mul(dag, ex_literal(dag, nominal), bend));
}
