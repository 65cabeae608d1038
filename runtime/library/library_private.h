/* SPDX-License-Identifier: MIT
 *
 * What the files of the library share: things behind handles, and calls into code that ends in failures. */
#ifndef LIBRARY_LIBRARY_PRIVATE_H
#define LIBRARY_LIBRARY_PRIVATE_H

#include "base/catch.h"
#include "base/pool.h"
#include "engine/engine.h"
#include "host/gic.h"
#include "model/model.h"
#include "scene/scene.h"
#include "subset/method.h"

#include <pthread.h>
#include <stdatomic.h>

struct gicl_messages {
    Messages list;
};

typedef enum ThingKind { THING_MODEL, THING_INSTANCE, THING_BATCH, THING_RESULT, THING_KINDS } ThingKind;

/* ---- library.c: handles */

/* A thing of a library while a call uses it. */
typedef struct Use {
    gicl_library *library;
    gicl_handle handle;
    void *thing;
    int status; /* GICL_OK, or there is none: the call returns this */
} Use;

/* Begin a call without a thing: empties `said`, and lets who listens hear it. */
void call_begin(const gicl_library *library, gicl_messages *said);
/* Begin a call: the same, and finds the thing. Calls that use a model may overlap, others not. The status is GICL_OK,
 * or GICL_WRONG with a message. */
Use use_begin(gicl_library *library, gicl_handle handle, ThingKind kind, gicl_messages *said);
/* End it; returns `status`. */
int use_end(const Use *use, int status);
/* A handle for a new thing, which its kind's free function frees; 0: no memory. */
gicl_handle handle_new(gicl_library *library, ThingKind kind, void *thing);
/* Run work(context) where numbers are read and written as in C; a failure adds its messages: GICL_FAILED, or
 * GICL_WRONG for one of the call. */
int call_work(const gicl_library *library, gicl_messages *said, void (*work)(void *context), void *context);
/* A mistake of the caller: GICL_WRONG with a message. */
int call_wrong(gicl_messages *said, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The message of a status of generated code, which it returns; what: "step", with the time. */
int call_status(gicl_messages *said, const gic_model *code, const gic_head *self, int status, const char *what);

/* ---- model.c */

typedef struct OpenModel {
    Pool *pool;
    const Model *model;
    const char *name; /* in messages: the path */
    EngineOptions options;
    const char *engine_name, *integrator; /* one of engine_name[]; NULL: the scene's */
    double tolerance;
    bool general;
    pthread_mutex_t lock; /* of what follows, and of calls of interpreted engines, whose instances share scratch */
    const Engine *engine; /* NULL: not needed yet */
    Pool *engine_pool;
    const char *c, *h; /* NULL: not yet generated */
    Pool *code_pool;
    atomic_int users;  /* the handle, instances and batches */
    atomic_flag taken; /* model_once() gave the model away */
} OpenModel;

/* The model for a call that analyses it or reads a scene in `pool`, inside of call_work(). */
const Model *model_for(const OpenModel *open, Pool *pool);
/* The same for a call that leaves nothing behind: for the first one the model as it was read, which saves time. */
const Model *model_once(OpenModel *open, Pool *pool);
/* True if its `integrator` has implicit steps: code of instances and batches has them then. */
bool model_implicit(const OpenModel *model);
/* Code for one vehicle in any scene; if it has implicit steps, as `wanted` has them, NULL: all states implicit,
 * Jacobians at once. Ends in diag_fail. */
const Engine *model_code(const OpenModel *model, Pool *pool, const Scene *wanted);
/* The model's code for any scene, compiled by the first call. */
int model_engine(const gicl_library *library, OpenModel *model, gicl_messages *said);
void model_keep(OpenModel *model);
void model_let(void *model);
/* Around calls of an engine's functions. */
void model_enter(OpenModel *model);
void model_leave(OpenModel *model);
/* Names of a kind, and where the array is in an instance. NULL: no such kind. */
const gic_signal *model_signals(const gic_model *code, int kind, int *count, size_t *offset);

/* ---- vehicles.c: what instances and batches are */

typedef struct Vehicles {
    Pool *pool;
    OpenModel *model;
    const Engine *engine; /* the model's, or one of its own, for lanes */
    const gic_model *code;
    const gic_batch_model *many; /* NULL: one after another */
    const Scene *scene;          /* where they begin; NULL: the model at design */
    int count, lanes;
    size_t stride; /* bytes from one to the next, or from one block of lanes to the next */
    char *first;
    gic_head *copy, *origin, *seen; /* copy: for trials; origin: as the start left the first; seen: one out of lanes */
} Vehicles;

/* gicl_instance_new() and gicl_batch_new(); kind: of the handle. */
int vehicles_new(gicl_library *library, gicl_handle model, const char *scene, int count, int lanes, ThingKind kind,
                 gicl_handle *made, gicl_messages *said);
void vehicles_free(void *vehicles);
/* Its head; not of lanes: the instance. */
gic_head *vehicle_of(const Vehicles *vehicles, int v);
/* An instance with its numbers: itself, or `seen`. */
gic_head *vehicle_look(const Vehicles *vehicles, int v);
/* gicl_view() of the first; false: there is no such kind, said says so. */
bool vehicles_view(const Vehicles *vehicles, int kind, double **data, int *count, gicl_messages *said);
/* Bring a vehicle to the start, or leave it as it is. parameter: NULL: those of scene or model. `copy` then has what
 * happened. Returns a status. */
int vehicle_start(const Vehicles *vehicles, int v, const double *parameter);
/* GICL_WRONG, with a message, if the method has implicit steps and the code has none, or none with this ratio in lanes;
 * else GICL_OK. */
int vehicles_lack(const Vehicles *vehicles, int method, int ratio, gicl_messages *said);
/* Steps by gic_step() or gic_step_dual(), up to the first that fails. Returns a status. */
int vehicle_step(const Vehicles *vehicles, int v, double step, int method, int ratio, int64_t steps);
/* Outputs of the present state, by `copy`, which then has what happened. Returns a status. */
int vehicle_outputs(const Vehicles *vehicles, int v);
/* The same of all in lanes, which go on after a failure too: vehicle_status() takes what happened. */
void lanes_step(const Vehicles *vehicles, double step, int method, int ratio, int64_t steps);
void lanes_outputs(const Vehicles *vehicles);
int vehicle_status(const Vehicles *vehicles, int v);

/* ---- result.c */

void result_free(void *result);

#endif
