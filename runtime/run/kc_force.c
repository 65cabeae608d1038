/* SPDX-License-Identifier: MIT
 * Forces of the ground that hold the force elements of an axle, by virtual work. With the heights z_i of the contacts
 * and the values x_e of the elements as functions of the travel coordinates w_a, and Q_e the elements' generalized
 * forces, sum_i F_i dz_i/dw_a + sum_e Q_e dx_e/dw_a = 0    for all a, and along a motion ' , with the second
 * derivatives of both, sum_i F_i' dz_i/dw_a = -sum_e (Q_e' dx_e/dw_a + Q_e (dx_e/dw_a)') - sum_i F_i (dz_i/dw_a)'. */
#include "gic_runtime.h"
#include "run/kc.h"

#include <string.h>

/* F and dz/dw [wheels][wheels], by columns first. Returns a status. */
static int hold(const Kc *kc, const KcAxle *axle, const KcLook *look, double *J, double *force)
{
    const int n = axle->wheels;
    double A[KC_WHEELS * KC_WHEELS];
    memset(force, 0, (size_t)n * sizeof *force);
    for (int a = 0; a < n; ++a) {
        double unit[KC_WHEELS + 1] = {0};
        unit[a] = 1;
        for (int i = 0; i < n; ++i) {
            KcPose pose, by;
            kc_pose(&axle->wheel[i], look, &pose);
            kc_rate(&axle->wheel[i], look, &pose, unit, &by);
            J[a * n + i] = by.contact[2];
        }
        for (int e = 0; e < kc->elements; ++e)
            force[a] -=
                kc->element[e].sign * look->value[kc->element[e].force] * kc_element_slope(&kc->element[e], look, a);
    }
    memcpy(A, J, (size_t)n * (size_t)n * sizeof *A);
    return kc_solve(n, A, force) ? GIC_OK : GIC_ERROR_SINGULAR;
}

int kc_forces(const Kc *kc, const KcAxle *axle, const double *w, KcLook *look, const double *along, double *force,
              double *rate)
{
    const int n = axle->wheels;
    double J[KC_WHEELS * KC_WHEELS], *second;
    KcPose pose[KC_WHEELS], moved[KC_WHEELS], by;
    int status = hold(kc, axle, look, J, force);
    if (status != GIC_OK)
        return status;
    second = pool_alloc(kc->pool, ((size_t)look->columns * (size_t)kc->outputs + 1) * sizeof *second);
    status = kc_look_second(kc, w, look, along, second);
    if (status != GIC_OK)
        return status;
    for (int i = 0; i < n; ++i) {
        kc_pose(&axle->wheel[i], look, &pose[i]);
        kc_rate(&axle->wheel[i], look, &pose[i], along, &moved[i]);
    }
    memset(rate, 0, (size_t)n * sizeof *rate);
    for (int a = 0; a < n; ++a) {
        double unit[KC_WHEELS + 1] = {0};
        unit[a] = 1;
        for (int e = 0; e < kc->elements; ++e) {
            const KcElement *element = &kc->element[e];
            const double bend = kc_element_bend(element, look, second, a);
            double change = 0;
            for (int k = 0; k < look->columns; ++k)
                change += along[k] * look->slope[k * kc->outputs + element->force];
            rate[a] -=
                element->sign * (change * kc_element_slope(element, look, a) + look->value[element->force] * bend);
        }
        for (int i = 0; i < n; ++i) {
            const double *by_a = second + a * kc->outputs;
            kc_rate(&axle->wheel[i], look, &pose[i], unit, &by);
            rate[a] -= force[i] * kc_contact_bend(&axle->wheel[i], &pose[i], &moved[i], &by,
                                                  by_a + axle->wheel[i].velocity, by_a + axle->wheel[i].turn);
        }
    }
    return kc_solve(n, J, rate) ? GIC_OK : GIC_ERROR_SINGULAR;
}
