/* SPDX-License-Identifier: MIT
 * Where an axle balances: the heights of the contacts are held, as by the pads of a rig, with forces F_i; coordinates
 * w_a that are free and move the wheels take their places. With the generalized forces Q_e and values x_e of elements,
 * heights z_i and loads L of places p sum_e Q_e dx_e/dw_a + sum_i F_i dz_i/dw_a + L dp/dw_a = 0    for all a,    z_i
 * held. Newton's method finds the place without loads, and the derivative by L follows from the same matrix (implicit
 * function theorem), which has the exact second derivatives of x_e and z_i in it. */
#include "run/kc_balance.h"

#include "base/vec3.h"
#include "gic_runtime.h"

#include <math.h>
#include <string.h>

enum { NEWTON_MOST = 30 };

static const char *const nothing_holds = "nothing holds a coordinate that moves its wheels";

/* The coordinates of the look: travel, then all others that are free and move a wheel, but for `held`. */
static KcLook *columns_of(const Kc *kc, const KcAxle *axle, bool others, int held)
{
    KcAxle all = {.steer = -1};
    KcLook *look = kc_look_new(kc, &all);
    for (int i = 0; i < axle->wheels; ++i)
        look->column[look->columns++] = axle->travel[i];
    for (int c = 0; c < kc->model->coordinates && look->columns < KC_COLUMNS && others; ++c) {
        bool moves = false, is_there = kc->model->coordinate[c].driven || c == held;
        for (int i = 0; i < axle->wheels; ++i)
            is_there = is_there || axle->travel[i] == c;
        if (is_there)
            continue;
        KcLook *one = kc_look_new(kc, &(KcAxle){.steer = c});
        if (kc_look(kc, kc->initial, one) != GIC_OK)
            continue;
        for (int i = 0; i < axle->wheels; ++i)
            moves =
                moves || norm3(one->slope + axle->wheel[i].velocity) + norm3(one->slope + axle->wheel[i].turn) > 1e-9;
        if (moves)
            look->column[look->columns++] = c;
    }
    look->slope = pool_alloc(kc->pool, ((size_t)kc->outputs * (size_t)look->columns + 1) * sizeof(double));
    return look;
}

/* Residual and matrix at the rig's place. Returns a status. */
static int evaluate_rig(KcBalance *rig)
{
    const Kc *kc = rig->kc;
    const int m = rig->m, n = rig->n, all = m + n;
    int status = kc_look(kc, rig->w, rig->look);
    memset(rig->A, 0, sizeof rig->A);
    memset(rig->missing, 0, sizeof rig->missing);
    for (int i = 0; i < n && status == GIC_OK; ++i) {
        kc_pose(&rig->axle->wheel[i], rig->look, &rig->pose[i]);
        rig->missing[m + i] = rig->z[i] - rig->pose[i].contact[2];
    }
    for (int a = 0; a < m && status == GIC_OK; ++a) {
        double unit[KC_COLUMNS] = {0};
        unit[a] = 1;
        for (int i = 0; i < n; ++i) {
            kc_rate(&rig->axle->wheel[i], rig->look, &rig->pose[i], unit, &rig->by[a][i]);
            rig->A[a * all + m + i] = rig->A[(m + i) * all + a] = rig->by[a][i].contact[2];
            rig->missing[a] -= rig->force[i] * rig->by[a][i].contact[2];
        }
        for (int e = 0; e < kc->elements; ++e)
            rig->missing[a] -= kc->element[e].sign * rig->look->value[kc->element[e].force] *
                               kc_element_slope(&kc->element[e], rig->look, a);
        rig->missing[a] -= kc_rubber_force(kc, rig->look, a);
    }
    double *second = rig->second;
    for (int b = 0; b < m && status == GIC_OK; ++b) {
        double unit[KC_COLUMNS] = {0};
        unit[b] = 1;
        status = kc_look_second(kc, rig->w, rig->look, unit, second);
        for (int a = 0; a < m && status == GIC_OK; ++a) {
            const double *by_a = second + a * kc->outputs;
            for (int e = 0; e < kc->elements; ++e) {
                const KcElement *element = &kc->element[e];
                rig->A[a * all + b] +=
                    element->sign *
                    (rig->look->slope[b * kc->outputs + element->force] * kc_element_slope(element, rig->look, a) +
                     rig->look->value[element->force] * (element->coordinate >= 0 ? 0 : by_a[element->rate]));
            }
            rig->A[a * all + b] += kc_rubber_slope(kc, rig->look, a, b, by_a);
            for (int i = 0; i < n; ++i)
                rig->A[a * all + b] +=
                    rig->force[i] * kc_contact_bend(&rig->axle->wheel[i], &rig->pose[i], &rig->by[b][i], &rig->by[a][i],
                                                    by_a + rig->axle->wheel[i].velocity,
                                                    by_a + rig->axle->wheel[i].turn);
        }
    }
    return status;
}

/* Find the place without loads. NULL: it is there, else why not. */
static const char *settle(KcBalance *rig)
{
    const int all = rig->m + rig->n;
    double before = INFINITY;
    for (int step = 0; step < NEWTON_MOST; ++step) {
        double most = 0, A[KC_BALANCE * KC_BALANCE];
        const int status = evaluate_rig(rig);
        if (status != GIC_OK)
            return kc_status(rig->kc, status);
        double change[KC_BALANCE];
        memcpy(A, rig->A, sizeof A);
        memcpy(change, rig->missing, sizeof change);
        if (!kc_solve(all, A, change))
            return nothing_holds;
        for (int a = 0; a < rig->m; ++a) {
            const Coordinate *c = &rig->kc->model->coordinate[rig->look->column[a]];
            most = fmax(most, fabs(change[a]) / (c->range[1] - c->range[0]));
        }
        if (step > 0 && (most < 1e-14 || (most < 1e-11 && most >= before))) /* forces are there after the first step */
            return NULL;
        before = most;
        for (int a = 0; a < rig->m; ++a)
            rig->w[rig->look->column[a]] += change[a];
        for (int i = 0; i < rig->n; ++i)
            rig->force[i] += change[rig->m + i];
    }
    return "its springs and the forces of the road do not balance near where it is set up";
}

/* The power of a unit load on wheel i while coordinate a moves with the rate 1. */
static double power(const KcBalance *rig, KcLoad load, int i, int a)
{
    const KcPose *by = &rig->by[a][i];
    switch (load) {
    case KC_LATERAL: return by->locked[1];
    case KC_LONGITUDINAL: return by->locked[0];
    case KC_ALIGNING: return by->turn[2];
    case KC_VERTICAL: return by->contact[2];
    case KC_HUB_LATERAL: return by->centre[1];
    case KC_HUB_VERTICAL: return by->centre[2];
    default: return by->centre[0];
    }
}

KcBalance *kc_balance_new(const Kc *kc, const KcAxle *axle, bool others, int held)
{
    KcBalance *rig = pool_alloc(kc->pool, sizeof *rig);
    *rig = (KcBalance){.kc = kc, .axle = axle, .look = columns_of(kc, axle, others, held), .n = axle->wheels};
    rig->m = rig->look->columns;
    rig->w = pool_alloc(kc->pool, ((size_t)kc->model->coordinates + 1) * sizeof *rig->w);
    rig->second = pool_alloc(kc->pool, ((size_t)rig->m * (size_t)kc->outputs + 1) * sizeof *rig->second);
    return rig;
}

const char *kc_balance_at(KcBalance *rig, const double *w)
{
    memcpy(rig->w, w, (size_t)rig->kc->model->coordinates * sizeof *rig->w);
    memset(rig->force, 0, sizeof rig->force);
    const int status = kc_look(rig->kc, rig->w, rig->look);
    if (status != GIC_OK)
        return kc_status(rig->kc, status);
    for (int i = 0; i < rig->n; ++i) {
        kc_pose(&rig->axle->wheel[i], rig->look, &rig->pose[i]);
        rig->z[i] = rig->pose[i].contact[2];
    }
    return settle(rig);
}

const char *kc_balance_give(const KcBalance *rig, KcLoad load, bool opposed, bool floats, double *change)
{
    const int m = rig->m, n = rig->n, all = m + n;
    double A[KC_BALANCE * KC_BALANCE];
    memcpy(A, rig->A, (size_t)all * (size_t)all * sizeof *A);
    memset(change, 0, (size_t)all * sizeof *change);
    for (int a = 0; a < m; ++a)
        for (int i = 0; i < n; ++i) {
            change[a] -= (opposed ? rig->axle->wheel[i].side : 1) * power(rig, load, i, a);
            if (floats)
                A[a * all + m + i] = 0;
        }
    for (int i = 0; i < n && floats; ++i) {
        double *row = A + (m + i) * all;
        memset(row, 0, (size_t)m * sizeof *row);
        row[m + i] = 1;
        change[m + i] = load != KC_VERTICAL ? 0 : opposed ? rig->axle->wheel[i].side : 1;
    }
    return kc_solve(all, A, change) && gic_finite(change, all) ? NULL : nothing_holds;
}
