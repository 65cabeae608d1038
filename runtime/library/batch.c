/* SPDX-License-Identifier: MIT
 * Many instances of one model, side by side in memory. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "library/library_private.h"

#include <stdio.h>
#include <string.h>

int gicl_batch_new(gicl_library *library, gicl_handle model, const char *scene, int vehicles, int lanes,
                   gicl_handle *batch, gicl_messages *said)
{
    return vehicles_new(library, model, scene, vehicles, lanes, THING_BATCH, batch, said);
}

int gicl_batch_view(gicl_library *library, gicl_handle batch, int kind, double **data, int *count, size_t *stride,
                    gicl_messages *said)
{
    const Use use = use_begin(library, batch, THING_BATCH, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *many = use.thing;
    if (!data || !count || !stride)
        return use_end(&use, call_wrong(said, NULL, "the places for the array and its sizes must not be NULL"));
    if (!vehicles_view(many, kind, data, count, said))
        return use_end(&use, GICL_WRONG);
    *stride = many->stride / sizeof(double);
    return use_end(&use, GICL_OK);
}

/* Note the status of vehicle v; *first becomes the first that is not GIC_OK. trial: NULL: the vehicle itself has what
 * happened. */
static void note(const Vehicles *many, int v, const gic_head *trial, int status, int32_t *each, int *first,
                 gicl_messages *said)
{
    char what[40];
    if (each)
        each[v] = status;
    if (status == GIC_OK || *first != GIC_OK)
        return;
    *first = status;
    snprintf(what, sizeof what, "vehicle %d", v);
    call_status(said, many->code, trial ? trial : vehicle_look(many, v), status, what);
}

int gicl_batch_step(gicl_library *library, gicl_handle batch, double step, int method, int ratio, int64_t steps,
                    int32_t *each, gicl_messages *said)
{
    const Use use = use_begin(library, batch, THING_BATCH, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *many = use.thing;
    if (steps < 0)
        return use_end(&use, call_wrong(said, NULL, "the number of steps is negative"));
    const int lacking = vehicles_lack(many, method, ratio, said);
    if (lacking != GICL_OK)
        return use_end(&use, lacking);
    int first = GIC_OK;
    model_enter(many->model);
    if (many->many)
        lanes_step(many, step, method, ratio, steps);
    for (int v = 0; v < many->count; ++v) {
        const int status = many->many ? vehicle_status(many, v) : vehicle_step(many, v, step, method, ratio, steps);
        note(many, v, NULL, status, each, &first, said);
    }
    model_leave(many->model);
    return use_end(&use, first);
}

int gicl_batch_outputs(gicl_library *library, gicl_handle batch, int32_t *each, gicl_messages *said)
{
    const Use use = use_begin(library, batch, THING_BATCH, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *many = use.thing;
    int first = GIC_OK;
    model_enter(many->model);
    if (many->many)
        lanes_outputs(many);
    for (int v = 0; v < many->count; ++v) {
        const int status = many->many ? vehicle_status(many, v) : vehicle_outputs(many, v);
        note(many, v, many->many ? NULL : many->copy, status, each, &first, said);
    }
    model_leave(many->model);
    return use_end(&use, first);
}

int gicl_batch_reset(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said)
{
    const Use use = use_begin(library, batch, THING_BATCH, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *many = use.thing;
    const size_t place = many->code->parameter_offset, bytes = sizeof(double) * (size_t)many->code->parameter_count;
    int first = GIC_OK;
    model_enter(many->model);
    for (int v = 0; v < many->count; ++v) {
        if (which && !which[v])
            continue;
        const double *own = instance_array(vehicle_look(many, v), place);
        const bool changed = memcmp(own, instance_array(many->origin, place), bytes) != 0;
        note(many, v, many->copy, vehicle_start(many, v, changed ? own : NULL), NULL, &first, said);
    }
    model_leave(many->model);
    return use_end(&use, first);
}

int gicl_batch_restart(gicl_library *library, gicl_handle batch, const uint8_t *which, gicl_messages *said)
{
    const Use use = use_begin(library, batch, THING_BATCH, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *many = use.thing;
    for (int v = 0; v < many->count; ++v)
        if (!which || which[v])
            gic_restart(vehicle_of(many, v), gic_time(vehicle_of(many, v)));
    return use_end(&use, GICL_OK);
}
