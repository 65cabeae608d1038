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

typedef struct OneInstance {
    Pool *pool;
    Start start;
    gic_head *self, *copy; /* copy: for outputs */
} OneInstance;

typedef struct Making {
    OpenModel *model;
    const char *scene;
    OneInstance *one;
} Making;

static void make(void *context)
{
    Making *making = context;
    Pool *pool = pool_new();
    OneInstance *one = pool_alloc(pool, sizeof *one);
    const Engine *engine = making->model->engine;
    one->pool = pool;
    one->start = start_read(pool, making->model, making->scene);
    one->self = instance_new(pool, engine);
    one->copy = instance_new(pool, engine);
    making->one = one;
}

void instance_free(void *instance)
{
    OneInstance *one = instance;
    model_let(one->start.model);
    pool_free(one->pool);
}

int gicl_instance_new(gicl_library *library, gicl_handle handle, const char *scene, gicl_handle *instance,
                      gicl_messages *said)
{
    Use use;
    if (instance)
        *instance = 0;
    int status = use_begin(&use, library, handle, THING_MODEL, said);
    if (status != GICL_OK)
        return status;
    Making making = {use.thing, scene, NULL};
    if (!instance)
        return use_end(&use, call_wrong(said, NULL, "the place for the handle must not be NULL"));
    status = model_engine(library, making.model, said);
    if (status == GICL_OK)
        status = call_work(library, said, make, &making);
    if (status != GICL_OK)
        return use_end(&use, status);
    OneInstance *one = making.one;
    model_keep(making.model);
    model_enter(making.model);
    status = start_go(&one->start, one->self, NULL);
    call_status(said, making.model->engine->code, one->self, status, "set-up");
    model_leave(making.model);
    if (status == GICL_OK && !(*instance = handle_new(library, THING_INSTANCE, one)))
        status = call_wrong(said, NULL, "no memory for another handle");
    if (status != GICL_OK)
        instance_free(one);
    return use_end(&use, status);
}

/* Begin a call about an instance. */
static int one_begin(Use *use, gicl_library *library, gicl_handle instance, OneInstance **one, const gic_model **code,
                     gicl_messages *said)
{
    const int status = use_begin(use, library, instance, THING_INSTANCE, said);
    if (status != GICL_OK)
        return status;
    *one = use->thing;
    *code = (*one)->start.model->engine->code;
    return GICL_OK;
}

int gicl_set_up(gicl_library *library, gicl_handle instance, const double *parameter, int count, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    if (count != (parameter ? code->parameter_count : 0))
        return use_end(&use, call_wrong(said, "give all of them, or NULL and 0", "%d parameters where the model has %d",
                                        count, code->parameter_count));
    OpenModel *model = one->start.model;
    model_enter(model);
    /* on the copy, so that a failure changes nothing */
    memcpy(one->copy, one->self, code->size);
    status = call_status(said, code, one->copy, start_go(&one->start, one->copy, parameter), "set-up");
    if (status == GIC_OK)
        memcpy(one->self, one->copy, code->size);
    model_leave(model);
    return use_end(&use, status);
}

int gicl_view(gicl_library *library, gicl_handle instance, int kind, double **data, int *count, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    const int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    size_t offset;
    int found;
    if (!data || !count)
        return use_end(&use, call_wrong(said, NULL, "the places for the array and its length must not be NULL"));
    if (!model_signals(code, kind, &found, &offset))
        return use_end(&use, call_wrong(said, "kinds are GICL_STATE to GICL_PORT", "there is no kind %d", kind));
    *data = instance_array(one->self, offset);
    *count = found;
    return use_end(&use, GICL_OK);
}

int gicl_restart(gicl_library *library, gicl_handle instance, double time, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    const int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    if (!isfinite(time))
        return use_end(&use, call_wrong(said, NULL, "the time is not a finite number"));
    gic_restart(one->self, time);
    return use_end(&use, GICL_OK);
}

int gicl_time(gicl_library *library, gicl_handle instance, double *time, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    const int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    if (!time)
        return use_end(&use, call_wrong(said, NULL, "the place for the time must not be NULL"));
    *time = gic_time(one->self);
    return use_end(&use, GICL_OK);
}

int gicl_step(gicl_library *library, gicl_handle instance, double step, int method, int ratio, int64_t steps,
              gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    if (steps < 0)
        return use_end(&use, call_wrong(said, NULL, "the number of steps is negative"));
    model_enter(one->start.model);
    for (int64_t i = 0; i < steps && status == GIC_OK; ++i)
        status = start_step(code, one->self, step, method, ratio);
    call_status(said, code, one->self, status, "step");
    model_leave(one->start.model);
    return use_end(&use, status);
}

int gicl_rhs(gicl_library *library, gicl_handle instance, double time, const double *state, double *rate, int count,
             gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    const int n = code->slow_count + code->fast_count;
    if (!state || !rate || count != n)
        return use_end(
            &use, call_wrong(said, NULL, "state and rate must have %d numbers, not %d", n, state && rate ? count : 0));
    model_enter(one->start.model);
    status = code->rhs(one->self, time, state, rate);
    call_status(said, code, one->self, status, "right-hand side");
    model_leave(one->start.model);
    return use_end(&use, status);
}

int gicl_outputs(gicl_library *library, gicl_handle instance, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    model_enter(one->start.model);
    memcpy(one->copy, one->self, code->size);
    one->copy->unchecked = 0; /* check results that are shown */
    status = call_status(said, code, one->copy, code->outputs(one->copy), "outputs");
    if (status == GIC_OK)
        memcpy(instance_array(one->self, code->output_offset), instance_array(one->copy, code->output_offset),
               sizeof(double) * (size_t)code->output_count);
    model_leave(one->start.model);
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
    Use use;
    OneInstance *one;
    const gic_model *code;
    const int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    if (!size)
        return use_end(&use, call_wrong(said, NULL, "the place for the size must not be NULL"));
    *size = sizeof(SnapshotHead) + code->size;
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
static void strip(const OneInstance *one, const gic_model *code)
{
    memcpy(one->copy, one->self, code->size);
    one->copy->road = NULL;
    one->copy->input_function = NULL;
    one->copy->user = NULL;
    if (one->start.model->engine->context)
        ((Instance *)(void *)one->copy)->context = NULL;
}

int gicl_snapshot(gicl_library *library, gicl_handle instance, void *bytes, size_t size, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    status = check_size(code, bytes, size, said);
    if (status != GICL_OK)
        return use_end(&use, status);
    strip(one, code);
    SnapshotHead head = {.code = code_hash(one->start.model), .bytes = text_hash((const char *)one->copy, code->size)};
    memcpy(head.mark, snapshot_mark, sizeof head.mark);
    memcpy(bytes, &head, sizeof head);
    memcpy((char *)bytes + sizeof head, one->copy, code->size);
    return use_end(&use, GICL_OK);
}

int gicl_restore(gicl_library *library, gicl_handle instance, const void *bytes, size_t size, gicl_messages *said)
{
    Use use;
    OneInstance *one;
    const gic_model *code;
    int status = one_begin(&use, library, instance, &one, &code, said);
    if (status != GICL_OK)
        return status;
    status = check_size(code, bytes, size, said);
    if (status != GICL_OK)
        return use_end(&use, status);
    SnapshotHead head;
    memcpy(&head, bytes, sizeof head);
    const char *body = (const char *)bytes + sizeof head;
    if (memcmp(head.mark, snapshot_mark, sizeof head.mark) != 0 || head.code != code_hash(one->start.model) ||
        head.bytes != text_hash(body, code->size))
        return use_end(&use, call_wrong(said, "restore what gicl_snapshot() wrote, with the same model and options",
                                        "these bytes are no snapshot of this model, or have been changed"));
    const gic_road *road = one->self->road;
    const Engine *engine = one->start.model->engine;
    memcpy(one->self, body, code->size);
    one->self->road = road;
    if (engine->context)
        ((Instance *)(void *)one->self)->context = engine->context;
    return use_end(&use, GICL_OK);
}
