/* SPDX-License-Identifier: MIT
 * Vehicles of instances and batches, side by side in memory: where they begin, a scene's road, parameters, initial
 * state and inputs or the model's design, and how they go on. */
#include "base/message.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "library/library_private.h"
#include "run/engines.h"
#include "run/stiff_states.h"
#include "run/run.h"
#include "scene/scene.h"

#include <dlfcn.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 1 << 24, LANES_MOST = 16, LINE = 64 /* bytes, at whose multiples vectors are quickest from */ };

typedef struct Making {
    OpenModel *model;
    const char *scene; /* path */
    int count, lanes;
    Vehicles *made;
} Making;

static const Scene *read_scene(Pool *pool, const OpenModel *open, const char *path)
{
    if (!path)
        return NULL;
    const Model *model = model_for(open, pool);
    const Scene *scene = scene_read(pool, pool_print(pool, "%s", path), model, open->integrator, open->tolerance);
    if (scene->automatic)
        scene_no_implicit(scene, "a batch");
    scene_no_rig(scene);
    return equilibrium_start(pool, model, scene, open->options.solve);
}

/* Code for all of them at once. */
static const Engine *open_lanes(Pool *pool, const Making *making, const Scene *wanted, const gic_batch_model **many)
{
    const OpenModel *model = making->model;
    const Batch batch = {making->count, making->lanes};
    const char *why;
    EngineOptions options = model->options;
    options.implicit = model_implicit(model);
    options.spread = wanted && wanted->spread;
    if (model->integrator && integrator_method(model->integrator) == GIC_EXP3)
        diag_fail((Place){model->model->source, 0, 0}, "let them make their steps one after another: lanes 1",
                  "code for many vehicles at once has no exponential steps");
    const Model *own = model_for(model, pool);
    if (wanted)
        options.splitting = scene_splitting(pool, own, wanted, options.solve, options.recovery);
    const Engine *engine = engine_batch(pool, own, &options, &batch, IN_LANES_AS_ALONE, many, &why);
    if (!engine)
        diag_fail((Place){model->model->source, 0, 0}, "let them make their steps one after another: lanes 1",
                  "no code for many vehicles at once: %s", why);
    return engine;
}

static void make(void *context)
{
    Making *making = context;
    Pool *pool = pool_new();
    Vehicles *vehicles = pool_alloc(pool, sizeof *vehicles);
    const Scene *scene = read_scene(pool, making->model, making->scene);
    const gic_batch_model *many = NULL;
    const bool spread = scene && scene->spread && model_implicit(making->model);
    const Scene *wanted = scene && (scene->spread || scene->stiff) && model_implicit(making->model) ? scene : NULL;
    const Engine *engine = making->lanes > 1 ? open_lanes(pool, making, wanted, &many)
                           : wanted          ? model_code(making->model, pool, wanted)
                                             : making->model->engine;
    if (spread)
        engine_check_shares(engine, scene);
    const size_t stride = many ? many->block_size : (engine->code->size + LINE - 1) / LINE * LINE;
    const size_t line = many && many->alignment > LINE ? many->alignment : LINE;
    *vehicles = (Vehicles){.pool = pool,
                           .model = making->model,
                           .engine = engine,
                           .code = engine->code,
                           .many = many,
                           .scene = scene,
                           .count = making->count,
                           .lanes = making->lanes,
                           .stride = stride,
                           .copy = instance_new(pool, engine),
                           .origin = instance_new(pool, engine),
                           .seen = instance_new(pool, engine)};
    char *room = pool_alloc(pool, (many ? many->size : stride * (size_t)making->count) + line);
    vehicles->first = room + (line - (uintptr_t)room % line);
    making->made = vehicles;
}

void vehicles_free(void *freed)
{
    const Vehicles *vehicles = freed;
    if (vehicles->engine != vehicles->model->engine) {
        engine_close(vehicles->engine);
        if (vehicles->engine->library)
            dlclose(vehicles->engine->library);
    }
    model_let(vehicles->model);
    pool_free(vehicles->pool);
}

/* Bring an instance to the start. */
static int start(const Vehicles *vehicles, gic_head *self, const double *parameter)
{
    int status;
    if (vehicles->scene) {
        Scene scene = *vehicles->scene;
        if (parameter)
            scene.parameter = (double *)parameter; /* only read */
        scene.driver = NULL;
        scene.rest = NULL;
        scene.replay = NULL;
        status = scene_start(vehicles->engine, &scene, self);
    } else
        status = parameter ? vehicles->code->setup_with(self, parameter) : vehicles->code->setup(self);
    /* inputs are the caller's from here on */
    self->input_function = NULL;
    self->user = NULL;
    return status;
}

int vehicles_new(gicl_library *library, gicl_handle model, const char *scene, int count, int lanes, ThingKind kind,
                 gicl_handle *made, gicl_messages *said)
{
    if (made)
        *made = 0;
    const Use use = use_begin(library, model, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!made)
        return use_end(&use, call_wrong(said, NULL, "the place for the handle must not be NULL"));
    if (count < 1 || count > MOST)
        return use_end(&use, call_wrong(said, NULL, "a batch has 1 to %d vehicles, not %d", MOST, count));
    if (lanes < 1 || lanes > LANES_MOST || (lanes & (lanes - 1)))
        return use_end(&use, call_wrong(said, NULL, "lanes are 1, 2, 4, 8 or 16, not %d", lanes));
    Making making = {use.thing, scene, count, lanes, NULL};
    int status = model_engine(library, making.model, said);
    if (status == GICL_OK)
        status = call_work(library, said, make, &making);
    if (status != GICL_OK)
        return use_end(&use, status);
    const Vehicles *vehicles = making.made;
    model_keep(making.model);
    model_enter(making.model);
    status = call_status(said, vehicles->code, vehicles->origin, start(vehicles, vehicles->origin, NULL), "set-up");
    if (vehicles->many && status == GIC_OK)
        status = call_status(said, vehicles->code, vehicles->origin, vehicles->many->setup(vehicles->first), "set-up");
    for (int v = 0; v < count && status == GIC_OK; ++v)
        status = vehicle_start(vehicles, v, NULL);
    model_leave(making.model);
    if (status == GIC_OK && !(*made = handle_new(library, kind, making.made)))
        status = call_wrong(said, NULL, "no memory for another handle");
    if (status != GICL_OK)
        vehicles_free(making.made);
    return use_end(&use, status);
}

gic_head *vehicle_of(const Vehicles *vehicles, int v)
{
    const int lanes = vehicles->lanes;
    return (gic_head *)(void *)(vehicles->first + vehicles->stride * (size_t)(v / lanes)) + v % lanes;
}

gic_head *vehicle_look(const Vehicles *vehicles, int v)
{
    if (!vehicles->many)
        return vehicle_of(vehicles, v);
    vehicles->many->store(vehicles->first, v, vehicles->seen);
    return vehicles->seen;
}

bool vehicles_view(const Vehicles *vehicles, int kind, double **data, int *count, gicl_messages *said)
{
    size_t offset;
    if (!model_signals(vehicles->code, kind, count, &offset)) {
        call_wrong(said, "kinds are GICL_STATE to GICL_PORT", "there is no kind %d", kind);
        return false;
    }
    const gic_batch_model *many = vehicles->many;
    if (many) {
        const size_t of[GICL_KINDS] = {[GICL_STATE] = many->state_offset,         [GICL_RATE] = many->rate_offset,
                                       [GICL_INPUT] = many->input_offset,         [GICL_OUTPUT] = many->output_offset,
                                       [GICL_PARAMETER] = many->parameter_offset, [GICL_PORT] = many->port_offset};
        offset = of[kind];
    }
    *data = (double *)(void *)(vehicles->first + offset);
    return true;
}

int vehicle_start(const Vehicles *vehicles, int v, const double *parameter)
{
    gic_head *copy = vehicles->copy;
    int status = GIC_OK;
    memcpy(copy, parameter ? vehicle_look(vehicles, v) : vehicles->origin, vehicles->code->size);
    if (parameter)
        status = start(vehicles, copy, parameter);
    if (status != GIC_OK)
        return status;
    copy->lane = v;
    if (vehicles->many)
        vehicles->many->load(vehicles->first, v, copy);
    else
        memcpy(vehicle_of(vehicles, v), copy, vehicles->code->size);
    return status;
}

int vehicles_lack(const Vehicles *vehicles, int method, int ratio, gicl_messages *said)
{
    const gic_implicit *implicit = vehicles->code->implicit;
    if (vehicles->many && ratio > 1 && method_implicit(method))
        return call_wrong(said, "take a ratio of 1, or a batch without lanes",
                          "vehicles in lanes take fast steps with ab3 alone");
    if (!method_implicit(method) || (implicit && (method != GIC_EXP3 || implicit->exponential_offset > 0)))
        return GICL_OK;
    return call_wrong(said, "open the model with it as integrator, by an engine of generated code",
                      method == GIC_EXP3 ? "its code has no exponential steps" : "its code has no implicit steps");
}

int vehicle_step(const Vehicles *vehicles, int v, double step, int method, int ratio, int64_t steps)
{
    gic_head *self = vehicle_of(vehicles, v);
    int status = GIC_OK;
    for (int64_t i = 0; i < steps && status == GIC_OK; ++i)
        status = gic_step_dual_by(vehicles->code, self, step, method, ratio, 0);
    return status;
}

int vehicle_outputs(const Vehicles *vehicles, int v)
{
    const gic_model *code = vehicles->code;
    gic_head *self = vehicle_of(vehicles, v), *copy = vehicles->copy;
    memcpy(copy, self, code->size);
    copy->unchecked = 0; /* check results that are shown */
    const int status = code->outputs(copy);
    if (status == GIC_OK)
        memcpy(instance_array(self, code->output_offset), instance_array(copy, code->output_offset),
               sizeof(double) * (size_t)code->output_count);
    return status;
}

void lanes_step(const Vehicles *vehicles, double step, int method, int ratio, int64_t steps)
{
    const gic_batch_model *many = vehicles->many;
    const bool implicit = many->model->implicit && method_implicit(method) && method != GIC_EXP3;
    const bool known = ratio == 1 ? method == GIC_AB3 || method == GIC_RK4 || implicit : ratio > 1 && method == GIC_AB3;
    for (int v = 0; v < vehicles->count && !known; ++v)
        vehicle_of(vehicles, v)->status = GIC_ERROR_ARGUMENT;
    while (known && steps > 0) {
        const int32_t next = steps < INT32_MAX ? (int32_t)steps : INT32_MAX;
        const int32_t good = ratio > 1 && many->step_dual ? many->step_dual(vehicles->first, step, ratio, 0, next)
                                                          : many->step(vehicles->first, step, method, next);
        steps = good > 0 ? steps - next : 0;
    }
}

void lanes_outputs(const Vehicles *vehicles)
{
    vehicles->many->outputs(vehicles->first);
}

int vehicle_status(const Vehicles *vehicles, int v)
{
    gic_head *self = vehicle_of(vehicles, v);
    const int status = self->status;
    self->status = GIC_OK;
    return status;
}
