/* SPDX-License-Identifier: MIT
 * Constant steps that a vehicle's small motions allow: where explicit methods are stable, and where all methods keep
 * frequency and damping. */
#include "gic_runtime.h"
#include "run/linearize.h"
#include "run/step_growth.h"
#include "scene/scene.h"

#include <math.h>

const double mode_accuracy = 0.01;

bool mode_is_fast(const Linear *linear, const Mode *mode)
{
    double fast = 0;
    for (int i = linear->places; i < linear->count - linear->places; ++i)
        fast += mode->share[i];
    return fast > 0.5;
}

StepLimit modes_step(const Linear *linear, const Modes *modes, int32_t method, int32_t ratio)
{
    StepLimit limit = {.stable = INFINITY, .accurate = INFINITY};
    for (int k = 0; k < modes->count; ++k) {
        const Mode *mode = &modes->mode[k];
        const bool fast = ratio > 1 && mode_is_fast(linear, mode);
        const double parts = fast ? ratio : 1;
        const int32_t by = fast ? GIC_AB3 : method;
        const double stable = parts * step_stable(by, mode->real, mode->imaginary);
        const double accurate = parts * step_accurate(by, mode->real, mode->imaginary, mode_accuracy);
        if (stable < limit.stable) {
            limit.stable = stable;
            limit.limits = mode;
        }
        limit.accurate = fmin(limit.accurate, accurate);
    }
    return limit;
}

/* ---- for people and programs ------------------------------------------------------------------------------------ */

static const struct {
    const char *name;
    int32_t method;
    bool accurate;
} column[] = {
    {"stable.ab3", GIC_AB3, false},    {"stable.rk4", GIC_RK4, false},    {"accurate.ab3", GIC_AB3, true},
    {"accurate.rk4", GIC_RK4, true},   {"accurate.ros2", GIC_ROS2, true}, {"accurate.ros3", GIC_ROS3, true},
    {"accurate.imex", GIC_IMEX, true},
};

const char *mode_steps_column(int k)
{
    return k < (int)(sizeof column / sizeof *column) ? column[k].name : NULL;
}

double mode_steps_value(const Mode *mode, int k)
{
    const double step = column[k].accurate ? step_accurate(column[k].method, mode->real, mode->imaginary, mode_accuracy)
                                           : step_stable(column[k].method, mode->real, mode->imaginary);
    return isfinite(step) ? step : (double)NAN;
}

static void print_step(Text *out, double step)
{
    if (isfinite(step))
        text_print(out, "  %12.4g s", step);
    else
        text_print(out, "  %14s", "any");
}

void modes_print_steps(Text *out, const Linear *linear, const Modes *modes, const Scene *scene)
{
    text_print(out, "\n%-16s  %14s  %14s  %s\n", "constant steps", "stable up to", "1 % up to",
               "stability is limited by");
    for (int32_t method = GIC_AB3; method <= GIC_IMEX; ++method) {
        const bool dual = scene && (method == GIC_AB3 || (method > GIC_RK4 && scene_implicit(scene)));
        const int32_t parts = dual ? scene->ratio : 1;
        const StepLimit limit = modes_step(linear, modes, method, parts);
        Text name = {.pool = out->pool};
        text_print(&name, parts > 1 ? "%s, ratio %d" : "%s", integrator_name(method), parts);
        text_print(out, "%-16s", name.s);
        print_step(out, limit.stable);
        print_step(out, limit.accurate);
        const Mode *mode = limit.limits;
        if (mode && mode->imaginary > 0)
            text_print(out, "  %.4g +- %.4gi: ", mode->real + 0.0, mode->imaginary); /* no -0 */
        else if (mode)
            text_print(out, "  %.4g: ", mode->real);
        if (mode)
            modes_print_shares(out, linear, mode);
        else
            text_print(out, "\n");
    }
    text_print(out,
               "\nstable: no motion grows that dies out by itself; 1 %%: each eigenvalue as the steps have it is "
               "right to 1 %% of "
               "its size.\nros2, ros3, imex: implicit steps, which damp what they do not resolve: models/STIFF.md\n");
}
