/* SPDX-License-Identifier: MIT
 * Instants of controllers that lie within constant steps. */
#include "run/sampling.h"

#include <math.h>

/* Times that differ by less are the same: FORMAT.md section 7.4. */
static const double same = 1e-9;

/* The largest time of which both are multiples. */
static double common(double a, double b)
{
    const double least = same * fmax(a, b);
    while (b > least) {
        const double rest = fabs(a - round(a / b) * b);
        a = b;
        b = rest;
    }
    return a;
}

/* What of a controller is no multiple of the step, as text; NULL: nothing. *measure becomes the largest time of which
 * its instants are multiples, too. */
static const char *misfit(Pool *pool, const gic_controller *controller, double step, double *measure)
{
    const char *found = NULL;
    for (int i = -2; i < controller->rule_count; ++i) {
        const double time = i == -2 ? controller->period : i == -1 ? controller->offset : controller->rule[i].late;
        *measure = common(fmax(*measure, time), fmin(*measure, time));
        if (!found && fabs(time - round(time / step) * step) > same * controller->period)
            found = pool_print(pool, "the %s of controller '%s', %.9g s,",
                               i == -2   ? "period"
                               : i == -1 ? "offset"
                                         : "delay",
                               controller->name, time);
    }
    return found;
}

/* The largest share of `measure`, one part of a whole number of them, that is no longer than `step`; one of four digits
 * rather than of more, if there is one above half of it. */
static double short_share(double measure, double step)
{
    const double least = fmax(ceil(measure / step - same), 1);
    for (double parts = least; parts <= fmin(2 * least, least + 1000); ++parts) {
        const double share = measure / parts, digits = pow(10, 3 - floor(log10(share)));
        if (fabs(share * digits - round(share * digits)) < same * share * digits)
            return share;
    }
    return measure / least;
}

const char *sampling_note(Pool *pool, const gic_model *model, double step, double output_step)
{
    const char *found = NULL;
    double measure = output_step;
    for (int i = 0; i < model->controller_count; ++i) {
        const char *one = misfit(pool, &model->controller[i], step, &measure);
        found = found ? found : one;
    }
    if (!found)
        return NULL;
    const double fit = short_share(measure, step);
    if (fit < step / 20)
        return pool_print(pool, "%s is no multiple of the step, %.9g s, and no step near it fits all controllers",
                          found, step);
    return pool_print(pool, "%s is no multiple of the step, %.9g s; %.9g s fits", found, step, fit);
}
