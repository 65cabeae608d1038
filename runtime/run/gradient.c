/* SPDX-License-Identifier: MIT
 * The gradient of a number of a run: its end value, an integral or a maximum. */
#include "run/gradient.h"
#include "gic_runtime.h"

static void begin(Gradient *gradient)
{
    gradient->value = 0;
    for (int k = 0; k < gradient->variables; ++k)
        gradient->derivative[k] = 0;
}

/* Add a part of the present formula. */
static void add(Gradient *gradient, double weight, double value, const double *slope)
{
    gradient->value += weight * value;
    for (int k = 0; k < gradient->variables; ++k)
        gradient->derivative[k] += weight * slope[k];
}

const Gradient *gradient_find(Pool *pool, const Scalar *scalar, const Scene *scene, Solve solve,
                              const char *const *wanted, int count)
{
    TangentRun *run = tangent_open(pool, scalar->model, scene, solve, wanted, count);
    Gradient *gradient = pool_alloc(pool, sizeof *gradient);
    *gradient = (Gradient){.variables = 0};
    gradient->variables = tangent_variables(run, &gradient->variable);
    const size_t room = (size_t)(gradient->variables + 1) * sizeof(double);
    double *slope = pool_alloc(pool, room), value = 0;
    gradient->derivative = pool_alloc(pool, room);
    begin(gradient);
    const int64_t steps = scene->outputs * scene->per_output;
    int status = tangent_begin(run, scene);
    for (int64_t i = 0; i <= steps && status == GIC_OK; ++i) {
        const bool first = i == 0, last = i == steps;
        if (scalar->kind != SCALAR_END || last)
            status = tangent_look(run, &value, slope);
        if (scalar->kind == SCALAR_INTEGRAL) {
            add(gradient, (first || last ? 0.5 : 1) * scene->step, value, slope);
            gradient->time = tangent_time(run);
        } else if (scalar->kind == SCALAR_END ? last : first || value > gradient->value) {
            begin(gradient);
            add(gradient, 1, value, slope);
            gradient->time = tangent_time(run);
        }
        if (status == GIC_OK && !last)
            status = tangent_step(run);
    }
    if (status != GIC_OK)
        tangent_fail(run, status);
    return gradient;
}
