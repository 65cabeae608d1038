/* SPDX-License-Identifier: MIT
 * Coordinates outside their ranges: `range` states what the model is made for, and a run that has gone wrong, as by
 * steps that are too long for a stop, shows there first. */
#include "run/range_watch.h"
#include "engine/engine.h"

#include <math.h>

/* Of a coordinate. */
typedef struct Beyond {
    double since;     /* s; NAN: it has not been outside */
    double low, high; /* m or rad, over the run */
} Beyond;

struct RangeWatch {
    const Model *model;
    Beyond *of; /* [coordinates] */
};

RangeWatch *range_watch_new(Pool *pool, const Model *model)
{
    RangeWatch *watch = pool_alloc(pool, sizeof *watch);
    *watch = (RangeWatch){model, pool_alloc(pool, sizeof(Beyond) * ((size_t)model->coordinates + 1))};
    for (int c = 0; c < model->coordinates; ++c)
        watch->of[c] = (Beyond){NAN, INFINITY, -INFINITY};
    return watch;
}

void range_watch_look(RangeWatch *watch, const gic_model *code, const gic_head *at)
{
    const double *state = instance_array((gic_head *)at, code->state_offset), rounding = 1e-9;
    for (int c = 0; c < watch->model->coordinates; ++c) {
        const double *range = watch->model->coordinate[c].range, width = range[1] - range[0];
        Beyond *of = &watch->of[c];
        if (code->coordinate_state[c] < 0) /* the scene's, which is told when it is read */
            continue;
        const double value = state[code->coordinate_state[c]];
        of->low = fmin(of->low, value);
        of->high = fmax(of->high, value);
        if (isnan(of->since) && (value < range[0] - rounding * width || value > range[1] + rounding * width))
            of->since = gic_time(at);
    }
}

void range_watch_print(const RangeWatch *watch, Text *out)
{
    for (int c = 0; c < watch->model->coordinates; ++c) {
        const Coordinate *coordinate = &watch->model->coordinate[c];
        const Beyond *of = &watch->of[c];
        if (!isnan(of->since))
            text_print(out, "  %-20s '%s' is beyond [%g, %g] from t = %.6g s on: %.4g to %.4g %s in all\n", "range",
                       coordinate->name, coordinate->range[0], coordinate->range[1], of->since, of->low, of->high,
                       coordinate->type == COORDINATE_ANGLE ? "rad" : "m");
    }
}
