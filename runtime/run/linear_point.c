/* SPDX-License-Identifier: MIT
 * Operating points of linear models: the static equilibrium, or a state of a run, which the engine `tape` computes,
 * because it is the one that knows derivatives. */
#include "base/message.h"
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/engines.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/run.h"
#include "run/scene_events.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>

/* Set the inputs of the instance's present time, by its outputs, and keep them. Returns a status. */
static int hold_inputs(const gic_model *code, Instance *self)
{
    const int status = code->outputs(self);
    self->head.input_function = NULL;
    return status;
}

OperatingPoint operating_point_rest(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    const Equilibrium *found = equilibrium_find(pool, model, scene, solve);
    const Source *source = scene ? scene->source : model->source;
    const bool moves = scene && equilibrium_set_in_motion(pool, scene, found);
    const int status = hold_inputs(found->engine->code, found->self);
    if (status != GIC_OK)
        diag_fail((Place){source, 0, 0}, "check the velocities of `initial`", "no outputs at the operating point: %s",
                  instance_status(pool, found->engine->code, &found->self->head, status));
    return (OperatingPoint){.linear = found->linear,
                            .self = found->self,
                            .source = source,
                            .text = moves ? "about the places of the static equilibrium, in motion as the scene's "
                                            "initial state"
                                          : "about the static equilibrium"};
}

/* A run on its way to the operating point. */
typedef struct Way {
    Pool *pool;
    const Engine *engine;
    const Scene *scene;
    gic_head *self;
    Variable *variable;
    SceneEvents *events;
    bool ended; /* by `until` */
} Way;

/* Returns a status. */
static int start(Way *way)
{
    int status = scene_start(way->engine, way->scene, way->self);
    if (status != GIC_OK)
        return status;
    if (way->scene->method >= METHOD_ADAMS &&
        !(way->variable = variable_open(way->engine->code, way->scene->method, way->scene->tolerance)))
        diag_fail(program_place(), NULL, "no memory for the integrator");
    way->events = scene_events_new(way->pool, way->engine, way->scene, way->self, &status);
    return status;
}

static int step(Way *way, double end)
{
    return way->events ? scene_events_step(way->events, way->engine->code, way->variable, way->self, end, &way->ended)
                       : scene_step(way->engine, way->engine->code, way->scene, way->variable, way->self, end);
}

/* Steps up to a time. Returns the status of the last one. */
static int go(Way *way, double time)
{
    /* as many constant steps as fit, where 0.3 / 0.1 is 3 */
    int64_t left = way->variable ? 0 : (int64_t)floor(time / way->scene->step * (1 + 4e-16));
    int status = GIC_OK;
    while (status == GIC_OK && !way->ended && (way->variable ? gic_time(way->self) < time : left-- > 0))
        status = step(way, time);
    return status;
}

OperatingPoint operating_point_run(Pool *pool, const Model *model, const Scene *scene, Solve solve, double time)
{
    const Place at = {scene->source, 0, 0};
    if (!(time <= scene->duration))
        diag_fail(at, pool_print(pool, "--at takes a time from 0 to %.9g", scene->duration),
                  "the run ends at t = %.9g s, before the operating point at %.9g s", scene->duration, time);
    scene_no_implicit(scene, "the run to an operating point");
    scene = equilibrium_start(pool, model, scene, solve);
    const Engine *engine = engine_open(pool, "tape", model, &(EngineOptions){.solve = solve, .quiet = true});
    Way way = {.pool = pool, .engine = engine, .scene = scene, .self = instance_new(pool, engine)};
    int status = start(&way);
    if (status != GIC_OK)
        diag_fail(at, "is the initial state one that the mechanism can reach from its design?",
                  "the run can't start: %s", instance_status(pool, engine->code, way.self, status));
    status = go(&way, time);
    if (status == GIC_OK && !way.ended)
        status = hold_inputs(engine->code, (Instance *)(void *)way.self);
    if (status != GIC_OK)
        diag_fail(at, "run the scene without --linearize: the message at its end says more",
                  "the run ends at t = %.6g s, before the operating point at %.9g s: %s", gic_time(way.self), time,
                  instance_status(pool, engine->code, way.self, status));
    if (way.ended)
        diag_fail(at, "ask for a time before that with --at",
                  "`until` ends the run at t = %.9g s, before the operating "
                  "point at %.9g s",
                  gic_time(way.self), time);
    variable_close(way.variable);
    return (OperatingPoint){.linear = linear_open(pool, engine),
                            .self = (Instance *)(void *)way.self,
                            .source = scene->source,
                            .text = pool_print(pool, "about the state of the run at t = %.9g s", gic_time(way.self))};
}

OperatingPoint operating_point(Pool *pool, const Model *model, const Scene *scene, Solve solve, double time)
{
    return isnan(time) ? operating_point_rest(pool, model, scene, solve)
                       : operating_point_run(pool, model, scene, solve, time);
}
