/* SPDX-License-Identifier: MIT
 * Knots of a scene's inputs within constant steps. */
#include "run/knot.h"

#include "run/knot_cross.h"
#include "scene/scene.h"

int knots_cross(const gic_model *model, const Scene *scene, gic_head *self, double start, int history)
{
    const double now = gic_time(self);
    int status = GIC_OK;
    if (scene->method == GIC_EXP3 && scene_next_knot(scene, start) <= now)
        self->history = 0;     /* a bend is no part of a parabola */
    if (scene_implicit(scene)) /* their stages see the inputs' change within the step */
        return GIC_OK;
    /* the rates that AB3 has of a start, or after a change of gear, are summed otherwise, as are parts of a step */
    if (!knot_counts(self, history))
        return GIC_OK;
    for (double knot = scene_next_knot(scene, start); knot <= now && status == GIC_OK;
         knot = scene_next_knot(scene, knot))
        status = knot_cross(model, self, start, knot);
    return status;
}
