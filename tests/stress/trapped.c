/* SPDX-License-Identifier: MIT
 * trapped MODEL SCENE SECONDS: the beginning of a scene by generated code, with outputs, poses and self-tests every ten
 * steps, while invalid operations, divisions by zero and overflows end the program. */
#define _GNU_SOURCE
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "run/variable_step.h"
#include "scene/scene.h"
#include "subset/subset.h"

#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    if (argc != 4) {
        fputs("usage: trapped MODEL SCENE SECONDS\n", stderr);
        return 2;
    }
    const double end = atof(argv[3]);
    Pool *pool = pool_new();
    const Model *model = model_read(pool, argv[1]);
    const Scene *scene = equilibrium_start(pool, model, scene_read(pool, argv[2], model, NULL, 0), SOLVE_REDUCED);
    const EngineOptions options = {.compiler = compiler_default(), .flags = "", .quiet = true};
    const Engine *engine = engine_open(pool, "tcc", model, &options);
    const gic_model *code = engine->code;
    gic_head *self = instance_new(pool, engine), *copy = instance_new(pool, engine);
    double *pose = pool_alloc(pool, 7 * (size_t)code->body_count * sizeof *pose);
    Variable *variable = scene->method >= METHOD_ADAMS ? variable_open(code, scene->method, scene->tolerance) : NULL;
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    int status = scene_start(engine, scene, self);
    for (int i = 0; status == GIC_OK && gic_time(self) < end && gic_time(self) < scene->duration; ++i) {
        gic_self_test test;
        status = scene_step(engine, code, scene, variable, self, end);
        if (status != GIC_OK || i % 10)
            continue;
        memcpy(copy, self, code->size);
        status = code->outputs(copy);
        if (status == GIC_OK)
            status = code->poses(copy, pose);
        if (status == GIC_OK)
            status = code->self_test(copy, &test);
    }
    fedisableexcept(FE_ALL_EXCEPT);
    if (status != GIC_OK)
        fprintf(stderr, "%s at %g s: %s\n", argv[2], gic_time(self), instance_status(pool, code, self, status));
    variable_close(variable);
    engine_close(engine);
    pool_free(pool);
    return status != GIC_OK;
}
