/* SPDX-License-Identifier: MIT
 * Forces of the ground that hold the force elements of an axle, by virtual work. With the heights z_i of the contacts
 * and the values x_e of the elements as functions of the travel coordinates w_a, and Q_e the elements' generalized
 * forces, sum_i F_i dz_i/dw_a + sum_e Q_e dx_e/dw_a = 0    for all a, and along a motion ' , with the second
 * derivatives of both, sum_i F_i' dz_i/dw_a = -sum_e (Q_e' dx_e/dw_a + Q_e (dx_e/dw_a)') - sum_i F_i (dz_i/dw_a)'. */
#include "gic_runtime.h"
#include "run/kc.h"

#include <string.h>

/* dx/dw of a column. */
static double element_slope(const KcElement *element, const KcLook *look, int column)
{
    if (element->coordinate >= 0)
        return element->coordinate == look->column[column];
    return look->slope[column * look->outputs + element->rate];
}

int kc_forces(const Kc *kc, const KcAxle *axle, const double *w, const KcLook *look, const double *along, double *force,
              double *rate)
{
    const int n = axle->wheels;
    double J[KC_WHEELS * KC_WHEELS] = {0}, A[KC_WHEELS * KC_WHEELS], *second;
    KcPose pose[KC_WHEELS], moved[KC_WHEELS], by[KC_WHEELS];
    second = pool_alloc(kc->pool, ((size_t)look->columns * (size_t)kc->outputs + 1) * sizeof *second);
    const int status = kc_look_second(kc, w, look, along, second);
    if (status != GIC_OK)
        return status;
    for (int i = 0; i < n; ++i) {
        kc_pose(&axle->wheel[i], look, &pose[i]);
        kc_rate(&axle->wheel[i], look, &pose[i], along, &moved[i]);
    }
    memset(force, 0, (size_t)n * sizeof *force);
    memset(rate, 0, (size_t)n * sizeof *rate);
    for (int a = 0; a < n; ++a) {
        double unit[KC_WHEELS + 1] = {0};
        unit[a] = 1;
        for (int i = 0; i < n; ++i) {
            kc_rate(&axle->wheel[i], look, &pose[i], unit, &by[i]);
            J[a * n + i] = by[i].contact[2];
        }
        for (int e = 0; e < kc->elements; ++e)
            force[a] -=
                kc->element[e].sign * look->value[kc->element[e].force] * element_slope(&kc->element[e], look, a);
    }
    memcpy(A, J, sizeof A);
    if (!kc_solve(n, A, force))
        return GIC_ERROR_SINGULAR;
    for (int a = 0; a < n; ++a) {
        double unit[KC_WHEELS + 1] = {0};
        unit[a] = 1;
        for (int e = 0; e < kc->elements; ++e) {
            const KcElement *element = &kc->element[e];
            const double bend = element->coordinate >= 0 ? 0 : second[a * kc->outputs + element->rate];
            double change = 0;
            for (int k = 0; k < look->columns; ++k)
                change += along[k] * look->slope[k * kc->outputs + element->force];
            rate[a] -= element->sign * (change * element_slope(element, look, a) + look->value[element->force] * bend);
        }
        for (int i = 0; i < n; ++i) {
            const double *by_a = second + a * kc->outputs;
            kc_rate(&axle->wheel[i], look, &pose[i], unit, &by[i]);
            rate[a] -= force[i] * kc_contact_bend(&axle->wheel[i], &pose[i], &moved[i], &by[i],
                                                  by_a + axle->wheel[i].velocity, by_a + axle->wheel[i].turn);
        }
    }
    memcpy(A, J, sizeof A);
    return kc_solve(n, A, rate) ? GIC_OK : GIC_ERROR_SINGULAR;
}
