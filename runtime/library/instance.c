/* SPDX-License-Identifier: MIT
 * Instances of the library: one vehicle each. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "library/library_private.h"

#include <math.h>
#include <string.h>

int gicl_instance_new(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *instance,
                      gicl_messages *said)
{
    return vehicles_new(library, model, scene, 1, 1, THING_INSTANCE, instance, said);
}

int gicl_set_up(gicl_library *library, gicl_handle instance, const double *parameter, int count, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    const int parameters = one->code->parameter_count;
    if (count != (parameter ? parameters : 0))
        return use_end(&use, call_wrong(said, "give all of them, or NULL and 0", "%d parameters where the model has %d",
                                        count, parameters));
    model_enter(one->model);
    const int status = call_status(said, one->code, one->copy, vehicle_start(one, 0, parameter), "set-up");
    model_leave(one->model);
    return use_end(&use, status);
}

int gicl_view(gicl_library *library, gicl_handle instance, int kind, double **data, int *count, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    if (!data || !count)
        return use_end(&use, call_wrong(said, NULL, "the places for the array and its length must not be NULL"));
    return use_end(&use, vehicles_view(one, kind, data, count, said) ? GICL_OK : GICL_WRONG);
}

int gicl_restart(gicl_library *library, gicl_handle instance, double time, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    if (!isfinite(time))
        return use_end(&use, call_wrong(said, NULL, "the time is not a finite number"));
    gic_restart(vehicle_of(one, 0), time);
    return use_end(&use, GICL_OK);
}

int gicl_time(gicl_library *library, gicl_handle instance, double *time, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    if (!time)
        return use_end(&use, call_wrong(said, NULL, "the place for the time must not be NULL"));
    *time = gic_time(vehicle_of(one, 0));
    return use_end(&use, GICL_OK);
}

int gicl_step(gicl_library *library, gicl_handle instance, double step, int method, int ratio, int64_t steps,
              gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    if (steps < 0)
        return use_end(&use, call_wrong(said, NULL, "the number of steps is negative"));
    const int lacking = vehicles_lack(one, method, ratio, said);
    if (lacking != GICL_OK)
        return use_end(&use, lacking);
    model_enter(one->model);
    const int status =
        call_status(said, one->code, vehicle_of(one, 0), vehicle_step(one, 0, step, method, ratio, steps), "step");
    model_leave(one->model);
    return use_end(&use, status);
}

int gicl_rhs(gicl_library *library, gicl_handle instance, double time, const double *state, double *rate, int count,
             gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    const int n = one->code->slow_count + one->code->fast_count;
    if (!state || !rate || count != n)
        return use_end(
            &use, call_wrong(said, NULL, "state and rate must have %d numbers, not %d", n, state && rate ? count : 0));
    gic_head *self = vehicle_of(one, 0);
    model_enter(one->model);
    const int status = call_status(said, one->code, self, one->code->rhs(self, time, state, rate), "right-hand side");
    model_leave(one->model);
    return use_end(&use, status);
}

int gicl_outputs(gicl_library *library, gicl_handle instance, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    model_enter(one->model);
    const int status = call_status(said, one->code, one->copy, vehicle_outputs(one, 0), "outputs");
    model_leave(one->model);
    return use_end(&use, status);
}

/* ---- snapshots ---------------------------------------------------------------------------------------------- */

/* Begin of a snapshot; the instance follows. */
typedef struct SnapshotHead {
    char mark[8];
    uint64_t code;  /* a hash of what the instance's numbers mean */
    uint64_t bytes; /* a hash of the instance */
} SnapshotHead;

static const char snapshot_mark[8] = "gicsnap";

static uint64_t code_hash(const OpenModel *model)
{
    const gic_model *code = model->engine->code;
    uint64_t hash = text_hash(code->hash ? code->hash : "", code->hash ? strlen(code->hash) : 0);
    hash = hash * 31 + text_hash(code->generator ? code->generator : "", code->generator ? strlen(code->generator) : 0);
    hash = hash * 31 + text_hash(model->engine_name, strlen(model->engine_name));
    return ((hash * 31 + code->size) * 31 + model->options.solve) * 31 + model->options.recovery;
}

int gicl_snapshot_size(gicl_library *library, gicl_handle instance, size_t *size, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    if (!size)
        return use_end(&use, call_wrong(said, NULL, "the place for the size must not be NULL"));
    *size = sizeof(SnapshotHead) + one->code->size;
    return use_end(&use, GICL_OK);
}

/* GICL_WRONG if it is not the size of a snapshot. */
static int check_size(const gic_model *code, const void *bytes, size_t size, gicl_messages *said)
{
    const size_t wanted = sizeof(SnapshotHead) + code->size;
    return bytes && size == wanted
               ? GICL_OK
               : call_wrong(said, NULL, "a snapshot of this model has %zu bytes, not %zu", wanted, bytes ? size : 0);
}

/* An instance without what points elsewhere. */
static void strip(const Vehicles *one)
{
    memcpy(one->copy, vehicle_of(one, 0), one->code->size);
    one->copy->road = NULL;
    one->copy->input_function = NULL;
    one->copy->user = NULL;
    if (one->model->engine->context)
        ((Instance *)(void *)one->copy)->context = NULL;
}

int gicl_snapshot(gicl_library *library, gicl_handle instance, void *bytes, size_t size, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    const gic_model *code = one->code;
    const int status = check_size(code, bytes, size, said);
    if (status != GICL_OK)
        return use_end(&use, status);
    strip(one);
    SnapshotHead head = {.code = code_hash(one->model), .bytes = text_hash((const char *)one->copy, code->size)};
    memcpy(head.mark, snapshot_mark, sizeof head.mark);
    memcpy(bytes, &head, sizeof head);
    memcpy((char *)bytes + sizeof head, one->copy, code->size);
    return use_end(&use, GICL_OK);
}

int gicl_restore(gicl_library *library, gicl_handle instance, const void *bytes, size_t size, gicl_messages *said)
{
    const Use use = use_begin(library, instance, THING_INSTANCE, said);
    if (use.status != GICL_OK)
        return use.status;
    const Vehicles *one = use.thing;
    const gic_model *code = one->code;
    const int status = check_size(code, bytes, size, said);
    if (status != GICL_OK)
        return use_end(&use, status);
    SnapshotHead head;
    memcpy(&head, bytes, sizeof head);
    const char *body = (const char *)bytes + sizeof head;
    if (memcmp(head.mark, snapshot_mark, sizeof head.mark) != 0 || head.code != code_hash(one->model) ||
        head.bytes != text_hash(body, code->size))
        return use_end(&use, call_wrong(said, "restore what gicl_snapshot() wrote, with the same model and options",
                                        "these bytes are no snapshot of this model, or have been changed"));
    gic_head *self = vehicle_of(one, 0);
    const gic_road *road = self->road;
    const Engine *engine = one->model->engine;
    memcpy(self, body, code->size);
    self->road = road;
    if (engine->context)
        ((Instance *)(void *)self)->context = engine->context;
    return use_end(&use, GICL_OK);
}
