/* SPDX-License-Identifier: MIT
 * Where instances begin: a scene's road, parameters, initial state and inputs, or the model's design. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "library/library_private.h"
#include "run/run.h"
#include "scene/scene.h"

Start start_read(Pool *pool, OpenModel *model, const char *scene)
{
    if (!scene)
        return (Start){model, NULL};
    const Scene *read =
        scene_read(pool, pool_print(pool, "%s", scene), model->model, model->integrator, model->tolerance);
    scene_no_rig(read);
    return (Start){model, equilibrium_start(pool, model->model, read, model->options.solve)};
}

int start_go(const Start *start, gic_head *self, const double *parameter)
{
    const Engine *engine = start->model->engine;
    int status;
    if (start->scene) {
        Scene scene = *start->scene;
        if (parameter)
            scene.parameter = (double *)parameter; /* only read */
        scene.driver = NULL;
        scene.rest = NULL;
        scene.replay = NULL;
        status = scene_start(engine, &scene, self);
    } else
        status = parameter ? engine->code->setup_with(self, parameter) : engine->code->setup(self);
    /* inputs are the caller's from here on */
    self->input_function = NULL;
    self->user = NULL;
    return status;
}

int start_step(const gic_model *code, gic_head *self, double step, int method, int ratio)
{
    if (ratio != 1 && method != GIC_AB3)
        return GIC_ERROR_ARGUMENT;
    return ratio == 1 ? gic_step(code, self, step, method) : gic_step_dual(code, self, step, ratio);
}
