/* SPDX-License-Identifier: MIT
 * entry_batch MODEL: hostile numbers into one of four vehicles in lanes. It must end with the status, the state, the
 * time and the start of Newton's method that code for one vehicle leaves, its neighbours must go on with the bits that
 * they have without it, and loaded anew it must go on as if nothing had been. Prints a row of the table of attacks. */
#include "base/pool.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double poison[] = {NAN,  INFINITY, -INFINITY, 5e-324, 0.0,   -1,      1e3,
                                -1e6, 1e9,      1e12,      1e100,  1e300, -DBL_MAX};
enum { POISONS = sizeof poison / sizeof *poison, VEHICLES = 4, LANES = 4, HIT = 2, WARM = 6, AFTER = 3 };

static const double step = 1e-3;

typedef struct Trial {
    const gic_model *code;
    const gic_batch_model *many;
    void *batch;
    gic_head *good, *one, *stored, *neighbour;
    int64_t tried, ok, refused, found;
    char first[200]; /* finding */
} Trial;

static double *array(gic_head *self, size_t offset)
{
    return instance_array(self, offset);
}

static void find(Trial *t, const char *text, const char *what, double value)
{
    if (!t->found++)
        snprintf(t->first, sizeof t->first, "%s: %s = %g", text, what, value);
}

static bool same_state(const Trial *t, gic_head *a, gic_head *b)
{
    const size_t bytes = sizeof(double) * (size_t)(t->code->slow_count + t->code->fast_count);
    return !memcmp(array(a, t->code->state_offset), array(b, t->code->state_offset), bytes) &&
           gic_time(a) == gic_time(b);
}

/* Vehicle HIT becomes t->one, the others t->good; both ways take a step. */
static void attack(Trial *t, double length, int32_t method, const char *what, double value)
{
    ++t->tried;
    if (t->many->setup(t->batch) != GIC_OK)
        find(t, "no set-up", what, value);
    for (int i = 0; i < VEHICLES; ++i)
        t->many->load(t->batch, i, i == HIT ? t->one : t->good);
    (void)t->many->step(t->batch, length, method, 1);
    const int status = gic_step(t->code, t->one, length, method),
              other = gic_step(t->code, t->neighbour, length, method);
    *(status == GIC_OK ? &t->ok : &t->refused) += 1;
    if (t->many->status(t->batch, HIT) != status)
        find(t, "another status than that of one vehicle", what, value);
    t->many->store(t->batch, HIT, t->stored);
    if (!same_state(t, t->stored, t->one) || (status == GIC_ERROR_UNSTABLE && t->stored->grown != t->one->grown))
        find(t, "another state than that of one vehicle", what, value);
    for (int i = 0; i < VEHICLES; ++i) {
        if (i == HIT)
            continue;
        t->many->store(t->batch, i, t->stored);
        if (t->many->status(t->batch, i) != other || !same_state(t, t->stored, t->neighbour))
            find(t, "a neighbour is disturbed", what, value);
    }
    t->many->load(t->batch, HIT, t->good);
    (void)t->many->step(t->batch, step, GIC_AB3, AFTER);
    memcpy(t->neighbour, t->good, t->code->size);
    for (int i = 0; i < AFTER; ++i)
        if (gic_step(t->code, t->neighbour, step, GIC_AB3) != GIC_OK)
            find(t, "no steps", what, value);
    t->many->store(t->batch, HIT, t->stored);
    if (t->many->status(t->batch, HIT) != GIC_OK || !same_state(t, t->stored, t->neighbour))
        find(t, "it does not go on", what, value);
}

static void begin(Trial *t)
{
    memcpy(t->one, t->good, t->code->size);
    memcpy(t->neighbour, t->good, t->code->size);
}

static void attack_array(Trial *t, size_t offset, int32_t count, const gic_signal *signal)
{
    for (int32_t i = 0; i < count; ++i)
        for (int k = 0; k < POISONS; ++k)
            for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method) {
                begin(t);
                array(t->one, offset)[i] = poison[k];
                attack(t, step, method, signal[i].name, poison[k]);
            }
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: entry_batch MODEL\n", stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const Model *model = model_read(pool, argv[1]);
    const EngineOptions options = {.compiler = compiler_default(), .flags = "", .quiet = true};
    const Batch batch = {VEHICLES, LANES};
    const char *why = NULL;
    Trial t = {.tried = 0};
    const Engine *engine = engine_batch(pool, model, &options, &batch, "-O1", &t.many, &why);
    if (!engine) {
        fprintf(stderr, "%s: %s\n", argv[1], why);
        return 1;
    }
    t.code = engine->code;
    t.batch = aligned_alloc(t.many->alignment, t.many->size);
    t.good = instance_new(pool, engine);
    t.one = instance_new(pool, engine);
    t.stored = instance_new(pool, engine);
    t.neighbour = instance_new(pool, engine);
    int status = t.batch ? t.code->setup(t.good) : 1;
    memcpy(t.stored, t.good, t.code->size);
    for (int i = 0; i < WARM && status == GIC_OK; ++i)
        status = gic_step(t.code, t.good, step, GIC_AB3);
    if (status != GIC_OK) {
        fprintf(stderr, "%s: no steps\n", argv[1]);
        return 1;
    }
    attack_array(&t, t.code->state_offset, t.code->slow_count + t.code->fast_count, t.code->state);
    attack_array(&t, t.code->input_offset, t.code->input_count, t.code->input);
    attack_array(&t, t.code->parameter_offset, t.code->parameter_count, t.code->parameter);
    attack_array(&t, t.code->port_offset, t.code->port_count, t.code->port);
    for (int k = 0; k < POISONS; ++k) {
        begin(&t);
        attack(&t, poison[k], GIC_AB3, "step", poison[k]);
        begin(&t);
        attack(&t, step, (int32_t)(k * 1000 - 3), "method", k * 1000 - 3);
    }
    printf("entry points | %s, in lanes | %lld | %lld | %lld | %lld | %s\n", t.code->name, (long long)t.tried,
           (long long)t.ok, (long long)t.refused, (long long)t.found, t.found ? t.first : "ok");
    free(t.batch);
    engine_close(engine);
    pool_free(pool);
    return t.found != 0;
}
