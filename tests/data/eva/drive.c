/* SPDX-License-Identifier: MIT
 * Calls every function of a generated model: read by Frama-C, not run. MODEL: its name; MODEL_HEADER: its header. */
#include MODEL_HEADER

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define CALL(name) JOIN(MODEL, name)

int main(void)
{
    static MODEL car, kept;
    gic_real rate[64], pose[7 * 16];
    gic_self_test test;
    int i, status = CALL(_setup)(&car);
    if (status == GIC_OK)
        status = CALL(_rhs)(&car, 0, car.state, rate);
    for (i = 0; i < 4 && status == GIC_OK; ++i) /* AB3 with its start by RK4, then RK4 */
        status = CALL(_step)(&car, 0.001, i < 3 ? GIC_AB3 : GIC_RK4);
    if (status == GIC_OK)
        status = CALL(_outputs)(&car);
    if (status == GIC_OK)
        status = CALL(_poses)(&car, pose);
    if (status == GIC_OK)
        status = CALL(_self_test)(&car, &test);
    CALL(_snapshot)(&car, &kept);
    CALL(_restore)(&car, &kept);
#ifdef PLANTED
    (void)rate[63]; /* nobody has written it */
#endif
    return status;
}
