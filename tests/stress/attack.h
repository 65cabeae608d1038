/* SPDX-License-Identifier: MIT
 * What attacks on generated code share: a model under two engines, random states of it, far outside its ranges too. */
#ifndef ATTACK_H
#define ATTACK_H

#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/engines.h"
#include "subset/subset.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A model as one engine computes it. */
typedef struct Subject {
    const Engine *engine;
    const gic_model *code;
    gic_head *fresh, *self; /* as it was set up; the one to work with */
} Subject;

typedef struct Chance {
    uint64_t state;
} Chance;

static inline Chance chance_new(double seed)
{
    return (Chance){((uint64_t)seed + 1) * 0x9e3779b97f4a7c15u | 1};
}

static inline double uniform(Chance *chance, double low, double high)
{
    chance->state ^= chance->state >> 12;
    chance->state ^= chance->state << 25;
    chance->state ^= chance->state >> 27;
    return low + (high - low) * ((double)(chance->state * 0x2545f4914f6cdd1du >> 11) * 0x1p-53);
}

static inline Subject subject_open(Pool *pool, const char *engine, const Model *model, Recovery recovery)
{
    Subject subject = {
        .engine = engine_open(pool, engine, model,
                              &(EngineOptions){.recovery = recovery, .compiler = "cc", .flags = "", .quiet = true})};
    subject.code = subject.engine->code;
    subject.fresh = instance_new(pool, subject.engine);
    subject.self = instance_new(pool, subject.engine);
    const int status = subject.code->setup(subject.fresh);
    if (status != GIC_OK) {
        fprintf(stderr, "%s: %s\n", engine, gic_status_text(status));
        exit(1);
    }
    memcpy(subject.self, subject.fresh, subject.code->size);
    return subject;
}

/* A value of coordinate c: inside its range, or up to `beyond` times its width outside. */
static inline double coordinate_value(Chance *chance, const gic_model *code, int c, double beyond)
{
    const double low = code->coordinate_low[c], high = code->coordinate_high[c], more = beyond * (high - low);
    return uniform(chance, low - more, high + more);
}

/* Where the value of coordinate c is to be put, in a state or in the inputs; its rate is `rate` numbers behind. */
static inline double *coordinate_place(const gic_model *code, int c, double *state, double *input, int *rate)
{
    *rate = code->coordinate_state[c] >= 0 ? code->slow_count / 2 : 1;
    return code->coordinate_state[c] >= 0 ? &state[code->coordinate_state[c]] : &input[code->coordinate_input[c]];
}

#endif
