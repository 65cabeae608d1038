/* SPDX-License-Identifier: MIT
 * Operating points of linear models: the static equilibrium, or a state of a run, which the engine `tape` computes,
 * because it is the one that knows derivatives. Implicit steps, which it lacks, are those of the engine `tcc`, and an
 * instance of the tape goes along, so that positions follow each other in it, too. */
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
#include <string.h>

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
    const Engine *tape; /* the same engine, or that of an instance that goes along */
    gic_head *beside;   /* the same instance, or that one */
    Variable *variable;
    SceneEvents *events;
    bool ended; /* by `until` */
} Way;

static Way way_open(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    const EngineOptions options = {.solve = solve, .quiet = true};
    Way way = {.pool = pool, .scene = scene, .tape = engine_open(pool, "tape", model, &options)};
    way.engine = scene_implicit(scene) ? engine_open_run(pool, "tcc", model, scene, NULL, false, &options) : way.tape;
    if (scene_implicit(scene) && !way.engine->code->implicit)
        scene_no_implicit(scene, "this system, where code can't be compiled into memory,");
    way.self = instance_new(pool, way.engine);
    way.beside = way.engine == way.tape ? way.self : instance_new(pool, way.tape);
    return way;
}

/* Bring the instance that goes along to the present state. Returns a status. */
static int follow(const Way *way)
{
    const gic_model *code = way->tape->code, *from = way->engine->code;
    const size_t states = (size_t)(code->slow_count + code->fast_count);
    if (way->beside == way->self)
        return GIC_OK;
    double *state = instance_array(way->beside, code->state_offset), rate[states + 1];
    memcpy(state, instance_array(way->self, from->state_offset), states * sizeof *state);
    memcpy((char *)way->beside + code->discrete_offset, (const char *)way->self + from->discrete_offset,
           (size_t)code->discrete_count * sizeof(int32_t));
    gic_restart(way->beside, gic_time(way->self));
    return code->rhs(way->beside, gic_time(way->beside), state, rate);
}

/* Returns a status. */
static int start(Way *way)
{
    int status = way->beside == way->self ? GIC_OK : scene_start(way->tape, way->scene, way->beside);
    if (status == GIC_OK)
        status = scene_start(way->engine, way->scene, way->self);
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
    const int status =
        way->events ? scene_events_step(way->events, way->engine->code, way->variable, way->self, end, &way->ended)
                    : scene_step(way->engine, way->engine->code, way->scene, way->variable, way->self, end);
    return status == GIC_OK ? follow(way) : status;
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
    scene_no_auto(scene, "the run to an operating point");
    scene = equilibrium_start(pool, model, scene, solve);
    Way way = way_open(pool, model, scene, solve);
    const gic_model *code = way.engine->code;
    int status = start(&way);
    if (status != GIC_OK)
        diag_fail(at, "is the initial state one that the mechanism can reach from its design?",
                  "the run can't start: %s", instance_status(pool, code, way.self, status));
    status = go(&way, time);
    if (status == GIC_OK && !way.ended)
        status = hold_inputs(way.tape->code, (Instance *)(void *)way.beside);
    if (status != GIC_OK)
        diag_fail(at, "run the scene without --linearize: the message at its end says more",
                  "the run ends at t = %.6g s, before the operating point at %.9g s: %s", gic_time(way.self), time,
                  instance_status(pool, code, way.self, status));
    if (way.ended)
        diag_fail(at, "ask for a time before that with --at",
                  "`until` ends the run at t = %.9g s, before the operating "
                  "point at %.9g s",
                  gic_time(way.self), time);
    variable_close(way.variable);
    return (OperatingPoint){.linear = linear_open(pool, way.tape),
                            .self = (Instance *)(void *)way.beside,
                            .source = scene->source,
                            .text = pool_print(pool, "about the state of the run at t = %.9g s", gic_time(way.self))};
}

OperatingPoint operating_point(Pool *pool, const Model *model, const Scene *scene, Solve solve, double time)
{
    return isnan(time) ? operating_point_rest(pool, model, scene, solve)
                       : operating_point_run(pool, model, scene, solve, time);
}
