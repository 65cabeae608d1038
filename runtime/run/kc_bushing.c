/* SPDX-License-Identifier: MIT
 * A bushing (FORMAT.md 7.5) as statics sees it: its displacements and rotation vector q, with first and second
 * derivatives by coordinates; the generalized forces of all, sum_i (p_i - (K q)_i) q_i,a with the preload p, and their
 * derivatives. */
#include "base/vec3.h"
#include "run/kc.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

static bool is_number(const Law *law)
{
    return law && (law->op == LAW_NUMBER || law->op == LAW_PARAMETER);
}

const char *kc_rubber_formula(const Kc *kc)
{
    for (int r = 0; r < kc->rubbers; ++r)
        for (int i = 0; i < BUSHING_AXES; ++i)
            if (kc->rubber[r].force->law[i] && !is_number(kc->rubber[r].force->law[i]))
                return kc->rubber[r].force->name;
    return NULL;
}

void kc_stiffness(Kc *kc)
{
    Model model = *kc->model;
    const gic_real *tuned = tape_array(kc->self, kc->engine->code->parameter_offset);
    model.parameter = pool_alloc(kc->pool, ((size_t)model.parameters + 1) * sizeof *model.parameter);
    for (int i = 0; i < model.parameters; ++i) {
        model.parameter[i] = kc->model->parameter[i];
        if (model.parameter[i].tunable)
            model.parameter[i].value = tuned[model.parameter[i].index];
    }
    for (int r = 0; r < kc->rubbers; ++r)
        for (int k = 0; k < BUSHING_AXES * BUSHING_AXES; ++k) {
            const Law *law = kc->rubber[r].force->bushing->stiffness[bushing_place(k / BUSHING_AXES, k % BUSHING_AXES)];
            kc->rubber[r].stiffness[k] = law ? law_number(law, &model) : 0;
        }
    for (int r = 0; r < kc->rubbers; ++r)
        for (int i = 0; i < BUSHING_AXES; ++i)
            if (is_number(kc->rubber[r].force->law[i]))
                kc->rubber[r].preload[i] = law_number(kc->rubber[r].force->law[i], &model);
}

static void multiply(const double A[9], const double B[9], double out[9])
{
    for (int i = 0; i < 9; ++i) {
        out[i] = 0;
        for (int k = 0; k < 3; ++k)
            out[i] += A[3 * (i / 3) + k] * B[3 * k + i % 3];
    }
}

/* The axes of one end in the world. */
static void axes_of(const KcRubber *rubber, const KcLook *look, int end, double out[9])
{
    double A[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (rubber->force->body[end] != BODY_GROUND)
        mat_from_euler(look->value + rubber->orientation[end], A);
    multiply(A, rubber->force->bushing->frame[end], out);
}

/* One of its ends: position, or a rate of a column. */
static void end_of(const KcRubber *rubber, const double *from, int end, int place, double out[3])
{
    if (rubber->force->body[end] == BODY_GROUND)
        memset(out, 0, 3 * sizeof *out);
    else
        copy3(from + place, out);
}

KcBent kc_bend(const KcRubber *rubber, const KcLook *look)
{
    KcBent bent;
    double other[9], C[9] = {0}, a[3], b[3];
    axes_of(rubber, look, 0, bent.axes);
    axes_of(rubber, look, 1, other);
    end_of(rubber, look->value, 0, rubber->place[0], a);
    end_of(rubber, look->value, 1, rubber->place[1], b);
    if (rubber->force->body[0] == BODY_GROUND)
        copy3(rubber->force->point[0], a);
    if (rubber->force->body[1] == BODY_GROUND)
        copy3(rubber->force->point[1], b);
    sub3(b, a, bent.lever);
    apply3_transposed(bent.axes, bent.lever, bent.q);
    for (int i = 0; i < 9; ++i)
        for (int k = 0; k < 3; ++k)
            C[i] += bent.axes[3 * k + i / 3] * other[3 * k + i % 3];
    const double s[3] = {(C[7] - C[5]) / 2, (C[2] - C[6]) / 2, (C[3] - C[1]) / 2}, size = norm3(s);
    const double angle = atan2(size, (C[0] + C[4] + C[8] - 1) / 2);
    for (int i = 0; i < 3; ++i)
        bent.q[3 + i] = size > 0 ? s[i] * (angle / size) : 0;
    return bent;
}

/* c = (1 - t/2 cot(t/2)) / t^2 and c'/t: small angles t by their series, of |B_2k| / (2k)!. */
static void turning(double t, double *c, double *slope)
{
    static const double term[] = {1.0 / 12,       1.0 / 720,          1.0 / 30240,      1.0 / 1209600,
                                  1.0 / 47900160, 691 / 1307674368e3, 1.0 / 74724249600};
    enum { TERMS = sizeof term / sizeof *term };
    const double half = t / 2;
    *c = *slope = 0;
    if (t > 0.5) {
        *c = (1 - half / tan(half)) / (t * t);
        *slope = ((half / pow(sin(half), 2) - 1 / tan(half)) / (2 * t) - 2 * *c) / (t * t);
        return;
    }
    for (int k = TERMS - 1; k >= 0; --k) {
        *c = *c * t * t + term[k];
        if (k > 0)
            *slope = *slope * t * t + 2 * k * term[k];
    }
}

/* (I - 1/2 [theta]x + c [theta]x^2) omega. */
static void to_rate(const double theta[3], const double omega[3], double out[3])
{
    double c, slope, once[3], twice[3];
    turning(norm3(theta), &c, &slope);
    cross3(theta, omega, once);
    cross3(theta, once, twice);
    for (int i = 0; i < 3; ++i)
        out[i] = omega[i] - once[i] / 2 + c * twice[i];
}

/* What the matrix there changes by while theta does, times omega: added to out. */
static void add_rate_change(const double theta[3], const double by[3], const double omega[3], double out[3])
{
    double c, slope, once[3], twice[3], part[3], mixed[2][3];
    turning(norm3(theta), &c, &slope);
    cross3(theta, omega, once);
    cross3(theta, once, twice);
    cross3(by, once, mixed[0]);
    cross3(by, omega, part);
    cross3(theta, part, mixed[1]);
    for (int i = 0; i < 3; ++i)
        out[i] += -part[i] / 2 + slope * dot3(theta, by) * twice[i] + c * (mixed[0][i] + mixed[1][i]);
}

/* Velocity of the second point as the first body sees it, and the relative angular velocity; of velocities and angular
 * velocities of both ends, at `rates`. */
static void relative(const KcRubber *rubber, const KcBent *bent, const double *rates, double v[3], double turn[3],
                     double carrier[3])
{
    double end[2][3], other[3], swept[3];
    for (int i = 0; i < 2; ++i)
        end_of(rubber, rates, i, rubber->velocity[i], end[i]);
    end_of(rubber, rates, 0, rubber->turn[0], carrier);
    end_of(rubber, rates, 1, rubber->turn[1], other);
    cross3(carrier, bent->lever, swept);
    sub3(end[1], end[0], v);
    sub3(v, swept, v);
    sub3(other, carrier, turn);
}

void kc_bend_rate(const KcRubber *rubber, const KcBent *bent, const KcLook *look, int column, double out[6])
{
    double v[3], turn[3], carrier[3], omega[3];
    relative(rubber, bent, look->slope + column * look->outputs, v, turn, carrier);
    apply3_transposed(bent->axes, v, out);
    apply3_transposed(bent->axes, turn, omega);
    to_rate(bent->q + 3, omega, out + 3);
}

/* With the first body's angular velocity o, A^T x changes by A^T (x' - o x x). */
void kc_bend_second(const KcRubber *rubber, const KcBent *bent, const KcLook *look, int a, const double *rates_b,
                    const double *second, double out[6])
{
    double v[3][3], turn[3][3], carrier[3][3], along[3], lever[3], part[3], omega[3];
    const double *theta = bent->q + 3;
    const double *rates[] = {look->slope + a * look->outputs, rates_b, second};
    for (int i = 0; i < 3; ++i)
        relative(rubber, bent, rates[i], v[i], turn[i], carrier[i]);
    cross3(carrier[0], bent->lever, lever);
    add3(lever, v[0], lever); /* its change by a */
    cross3(carrier[1], lever, part);
    sub3(v[2], part, along);
    cross3(carrier[0], v[1], part);
    sub3(along, part, along);
    apply3_transposed(bent->axes, along, out);
    cross3(carrier[0], turn[1], part);
    sub3(turn[2], part, along);
    apply3_transposed(bent->axes, along, omega);
    to_rate(theta, omega, out + 3);
    double by[3];
    apply3_transposed(bent->axes, turn[0], omega);
    to_rate(theta, omega, by); /* theta_,a */
    apply3_transposed(bent->axes, turn[1], omega);
    add_rate_change(theta, by, omega, out + 3);
}

/* p - K q, or with p NULL -K q. */
static void force_of(const KcRubber *rubber, const double *p, const double *q, double Q[BUSHING_AXES])
{
    for (int i = 0; i < BUSHING_AXES; ++i) {
        Q[i] = p ? p[i] : 0;
        for (int k = 0; k < BUSHING_AXES; ++k)
            Q[i] -= rubber->stiffness[i * BUSHING_AXES + k] * q[k];
    }
}

double kc_rubber_force(const Kc *kc, const KcLook *look, int a)
{
    double sum = 0;
    for (int r = 0; r < kc->rubbers; ++r) {
        const KcRubber *rubber = &kc->rubber[r];
        const KcBent bent = kc_bend(rubber, look);
        double Q[BUSHING_AXES], by[BUSHING_AXES];
        force_of(rubber, rubber->preload, bent.q, Q);
        kc_bend_rate(rubber, &bent, look, a, by);
        for (int i = 0; i < BUSHING_AXES; ++i)
            sum += Q[i] * by[i];
    }
    return sum;
}

double kc_rubber_slope(const Kc *kc, const KcLook *look, int a, int b, const double *second)
{
    double sum = 0;
    for (int r = 0; r < kc->rubbers; ++r) {
        const KcRubber *rubber = &kc->rubber[r];
        const KcBent bent = kc_bend(rubber, look);
        double Q[BUSHING_AXES], by[2][BUSHING_AXES], change[BUSHING_AXES], both[BUSHING_AXES];
        force_of(rubber, rubber->preload, bent.q, Q);
        kc_bend_rate(rubber, &bent, look, a, by[0]);
        kc_bend_rate(rubber, &bent, look, b, by[1]);
        force_of(rubber, NULL, by[1], change);
        kc_bend_second(rubber, &bent, look, a, look->slope + b * look->outputs, second, both);
        for (int i = 0; i < BUSHING_AXES; ++i)
            sum += change[i] * by[0][i] + Q[i] * both[i];
    }
    return sum;
}

/* A torque x against theta as one about the axes: the transposed matrix of to_rate(), which is that of -theta; and its
 * rate while theta changes by `by` and x by `change`. */
static void to_torque(const double theta[3], const double x[3], double out[3])
{
    const double back[3] = {-theta[0], -theta[1], -theta[2]};
    to_rate(back, x, out);
}

static void to_torque_rate(const double theta[3], const double by[3], const double x[3], const double change[3],
                           double out[3])
{
    const double back[3] = {-theta[0], -theta[1], -theta[2]}, back_by[3] = {-by[0], -by[1], -by[2]};
    to_rate(back, change, out);
    add_rate_change(back, back_by, x, out);
}

/* On the first body, of what acts on the second one, at a lever from its own end. */
static void react(const double lever[3], const double on[6], double out[6])
{
    double torque[3];
    cross3(lever, on, torque);
    for (int i = 0; i < 3; ++i) {
        out[i] = -on[i];
        out[3 + i] = -on[3 + i] - torque[i];
    }
}

void kc_rubber_wrench(const KcRubber *rubber, const KcLook *look, const double *along, KcWrench *wrench)
{
    const KcBent bent = kc_bend(rubber, look);
    const double *theta = bent.q + 3;
    double Q[BUSHING_AXES], change[BUSHING_AXES], by[BUSHING_AXES], part[3], v[3], turn[3], carrier[3], omega[3];
    double *on = wrench->on[1], *rate = wrench->rate[1], rates[look->outputs + 1];
    force_of(rubber, rubber->preload, bent.q, Q);
    apply3(bent.axes, Q, on);
    to_torque(theta, Q + 3, part);
    apply3(bent.axes, part, on + 3);
    react(bent.lever, on, wrench->on[0]);
    memset(rates, 0, sizeof rates);
    for (int k = 0; k < look->columns; ++k)
        for (int o = 0; o < look->outputs; ++o)
            rates[o] += along[k] * look->slope[k * look->outputs + o];
    relative(rubber, &bent, rates, v, turn, carrier);
    apply3_transposed(bent.axes, v, by);
    apply3_transposed(bent.axes, turn, omega);
    to_rate(theta, omega, by + 3);
    force_of(rubber, NULL, by, change);
    for (int half = 0; half < 2; ++half) { /* its axes turn with the first body */
        double own[3];
        if (half)
            to_torque_rate(theta, by + 3, Q + 3, change + 3, own);
        else
            copy3(change, own);
        apply3(bent.axes, own, rate + 3 * half);
        cross3(carrier, on + 3 * half, part);
        add3(rate + 3 * half, part, rate + 3 * half);
    }
    react(bent.lever, rate, wrench->rate[0]);
    cross3(carrier, bent.lever, part);
    add3(part, v, v); /* the lever's rate */
    cross3(v, on, part);
    sub3(wrench->rate[0] + 3, part, wrench->rate[0] + 3);
}
