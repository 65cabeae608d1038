/* SPDX-License-Identifier: MIT
 * Many instances of one model, side by side in memory. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "library/library_private.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { BATCH_MOST = 1 << 24, LINE = 64 /* bytes, at whose multiples vectors are quickest from */ };

typedef struct ManyInstances {
    Pool *pool;
    Start start;
    int vehicles;
    size_t stride; /* bytes */
    char *first;
    gic_head *copy, *origin; /* origin: as the start left it */
} ManyInstances;

typedef struct Making {
    OpenModel *model;
    const char *scene;
    int vehicles;
    ManyInstances *many;
} Making;

static void make(void *context)
{
    Making *making = context;
    Pool *pool = pool_new();
    ManyInstances *many = pool_alloc(pool, sizeof *many);
    const Engine *engine = making->model->engine;
    many->pool = pool;
    many->start = start_read(pool, making->model, making->scene);
    many->vehicles = making->vehicles;
    many->stride = (engine->code->size + LINE - 1) / LINE * LINE;
    char *room = pool_alloc(pool, many->stride * (size_t)many->vehicles + LINE);
    many->first = room + (LINE - (uintptr_t)room % LINE);
    many->copy = instance_new(pool, engine);
    many->origin = instance_new(pool, engine);
    making->many = many;
}

static gic_head *vehicle(const ManyInstances *many, int v)
{
    return (gic_head *)(void *)(many->first + many->stride * (size_t)v);
}

void batch_free(void *batch)
{
    ManyInstances *many = batch;
    model_let(many->start.model);
    pool_free(many->pool);
}

int gicl_batch_new(gicl_library *library, gicl_handle handle, const char *scene, int vehicles, gicl_handle *batch,
                   gicl_messages *said)
{
    Use use;
    if (batch)
        *batch = 0;
    int status = use_begin(&use, library, handle, THING_MODEL, said);
    if (status != GICL_OK)
        return status;
    if (!batch || vehicles < 1 || vehicles > BATCH_MOST)
        return use_end(&use, call_wrong(said, NULL, "a batch has 1 to %d vehicles, not %d", BATCH_MOST, vehicles));
    Making making = {use.thing, scene, vehicles, NULL};
    status = model_engine(library, making.model, said);
    if (status == GICL_OK)
        status = call_work(library, said, make, &making);
    if (status != GICL_OK)
        return use_end(&use, status);
    ManyInstances *many = making.many;
    const gic_model *code = making.model->engine->code;
    model_keep(making.model);
    model_enter(making.model);
    status = call_status(said, code, many->origin, start_go(&many->start, many->origin, NULL), "set-up");
    model_leave(making.model);
    for (int v = 0; v < vehicles && status == GIC_OK; ++v) {
        memcpy(vehicle(many, v), many->origin, code->size);
        vehicle(many, v)->lane = v;
    }
    if (status == GICL_OK && !(*batch = handle_new(library, THING_BATCH, many)))
        status = call_wrong(said, NULL, "no memory for another handle");
    if (status != GICL_OK)
        batch_free(many);
    return use_end(&use, status);
}

int gicl_batch_view(gicl_library *library, gicl_handle batch, int kind, double **data, int *count, size_t *stride,
                    gicl_messages *said)
{
    Use use;
    const int status = use_begin(&use, library, batch, THING_BATCH, said);
    if (status != GICL_OK)
        return status;
    const ManyInstances *many = use.thing;
    size_t offset;
    int found;
    if (!data || !count || !stride)
        return use_end(&use, call_wrong(said, NULL, "the places for the array and its sizes must not be NULL"));
    if (!model_signals(many->start.model->engine->code, kind, &found, &offset))
        return use_end(&use, call_wrong(said, "kinds are GICL_STATE to GICL_PORT", "there is no kind %d", kind));
    *data = instance_array(vehicle(many, 0), offset);
    *count = found;
    *stride = many->stride / sizeof(double);
    return use_end(&use, GICL_OK);
}

/* Note the status of vehicle v; *first becomes the first that is not GIC_OK. */
static void note(const ManyInstances *many, int v, const gic_head *self, int status, int32_t *each, int *first,
                 gicl_messages *said)
{
    char what[40];
    if (each)
        each[v] = status;
    if (status == GIC_OK || *first != GIC_OK)
        return;
    *first = status;
    snprintf(what, sizeof what, "vehicle %d", v);
    call_status(said, many->start.model->engine->code, self, status, what);
}

int gicl_batch_step(gicl_library *library, gicl_handle batch, double step, int method, int ratio, int64_t steps,
                    int32_t *each, gicl_messages *said)
{
    Use use;
    int first = use_begin(&use, library, batch, THING_BATCH, said);
    if (first != GICL_OK)
        return first;
    const ManyInstances *many = use.thing;
    const gic_model *code = many->start.model->engine->code;
    if (steps < 0)
        return use_end(&use, call_wrong(said, NULL, "the number of steps is negative"));
    model_enter(many->start.model);
    for (int v = 0; v < many->vehicles; ++v) {
        gic_head *self = vehicle(many, v);
        int status = GIC_OK;
        for (int64_t i = 0; i < steps && status == GIC_OK; ++i)
            status = start_step(code, self, step, method, ratio);
        note(many, v, self, status, each, &first, said);
    }
    model_leave(many->start.model);
    return use_end(&use, first);
}

int gicl_batch_outputs(gicl_library *library, gicl_handle batch, int32_t *each, gicl_messages *said)
{
    Use use;
    int first = use_begin(&use, library, batch, THING_BATCH, said);
    if (first != GICL_OK)
        return first;
    const ManyInstances *many = use.thing;
    const gic_model *code = many->start.model->engine->code;
    model_enter(many->start.model);
    for (int v = 0; v < many->vehicles; ++v) {
        memcpy(many->copy, vehicle(many, v), code->size);
        many->copy->unchecked = 0;
        const int status = code->outputs(many->copy);
        if (status == GIC_OK)
            memcpy(instance_array(vehicle(many, v), code->output_offset),
                   instance_array(many->copy, code->output_offset), sizeof(double) * (size_t)code->output_count);
        note(many, v, many->copy, status, each, &first, said);
    }
    model_leave(many->start.model);
    return use_end(&use, first);
}

int gicl_batch_reset(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said)
{
    Use use;
    int first = use_begin(&use, library, batch, THING_BATCH, said);
    if (first != GICL_OK)
        return first;
    const ManyInstances *many = use.thing;
    const gic_model *code = many->start.model->engine->code;
    const size_t parameters = sizeof(double) * (size_t)code->parameter_count;
    const double *of_origin = instance_array(many->origin, code->parameter_offset);
    model_enter(many->start.model);
    for (int v = 0; v < many->vehicles; ++v) {
        gic_head *self = vehicle(many, v);
        if (which && !which[v])
            continue;
        const double *own = instance_array(self, code->parameter_offset);
        int status = GIC_OK;
        if (memcmp(own, of_origin, parameters) != 0) {
            memcpy(many->copy, self, code->size);
            status = start_go(&many->start, many->copy, own);
        } else
            memcpy(many->copy, many->origin, code->size);
        if (status == GIC_OK) {
            memcpy(self, many->copy, code->size);
            self->lane = v;
        }
        note(many, v, many->copy, status, NULL, &first, said);
    }
    model_leave(many->start.model);
    return use_end(&use, first);
}

int gicl_batch_restart(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said)
{
    Use use;
    const int status = use_begin(&use, library, batch, THING_BATCH, said);
    if (status != GICL_OK)
        return status;
    const ManyInstances *many = use.thing;
    for (int v = 0; v < many->vehicles; ++v)
        if (!which || which[v])
            gic_restart(vehicle(many, v), gic_time(vehicle(many, v)));
    return use_end(&use, GICL_OK);
}
