/* SPDX-License-Identifier: MIT
 * The engines by name, and instances of any of them. */
#include "engine/engine.h"
#include "gic_runtime.h"

#include <string.h>
#include <sys/resource.h>

double clock_seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double cpu_seconds(void)
{
    struct rusage children;
    getrusage(RUSAGE_CHILDREN, &children);
    return clock_seconds(CLOCK_PROCESS_CPUTIME_ID) + (double)(children.ru_utime.tv_sec + children.ru_stime.tv_sec) +
           1e-6 * (double)(children.ru_utime.tv_usec + children.ru_stime.tv_usec);
}

double profile_clock(EngineProfile *profile)
{
    return profile->on ? clock_seconds(CLOCK_MONOTONIC) - (double)profile->looks++ * profile->look : 0;
}

gic_head *instance_new(Pool *pool, const Engine *engine)
{
    /* at a multiple of 64 bytes, which vectors in it are quickest from */
    char *room = pool_alloc(pool, engine->code->size + 64);
    gic_head *self = (gic_head *)(void *)(room + (64 - (uintptr_t)room % 64));
    if (engine->context)
        ((Instance *)(void *)self)->context = engine->context;
    return self;
}

double *instance_array(gic_head *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

int engine_enter(const Engine *engine, gic_head *self, const double *standard)
{
    const gic_model *code = engine->code;
    const int slow = engine->standard_count - code->fast_count;
    double *state = instance_array(self, code->state_offset);
    memcpy(state + code->slow_count, standard + slow, sizeof *standard * (size_t)code->fast_count);
    if (engine->enter)
        return engine->enter(self, standard);
    memcpy(state, standard, sizeof *standard * (size_t)slow);
    return GIC_OK;
}

int engine_look(const Engine *engine, gic_head *self, double *standard, double *rate)
{
    const gic_model *code = engine->code;
    const double *state = instance_array(self, code->state_offset);
    const int slow = engine->standard_count - code->fast_count;
    double own[code->slow_count + code->fast_count + 1], other[slow + 1];
    int status = GIC_OK;
    if (rate || engine->leave)
        status = code->rhs(self, gic_time(self), state, own);
    if (status != GIC_OK)
        return status;
    memcpy(standard + slow, state + code->slow_count, sizeof *state * (size_t)code->fast_count);
    if (rate)
        memcpy(rate + slow, own + code->slow_count, sizeof *own * (size_t)code->fast_count);
    if (engine->leave) {
        engine->leave(self, standard, rate ? rate : other);
        return GIC_OK;
    }
    memcpy(standard, state, sizeof *state * (size_t)slow);
    if (rate)
        memcpy(rate, own, sizeof *own * (size_t)slow);
    return GIC_OK;
}

void engine_close(const Engine *engine)
{
    if (engine->close)
        engine->close(engine);
}

const char *instance_status(Pool *pool, const gic_model *model, const gic_head *self, int status)
{
    if ((status == GIC_ERROR_GEOMETRY || status == GIC_ERROR_ASSUMPTION) && self->condition >= 0 &&
        self->condition < model->condition_count)
        return pool_print(pool, "%s: %s", gic_status_text(status), model->condition_text[self->condition]);
    if (status == GIC_ERROR_UNSTABLE && self->grown >= 0 && self->grown < model->slow_count + model->fast_count) {
        const gic_signal *signal = &model->state[self->grown];
        const double value = instance_array((gic_head *)self, model->state_offset)[self->grown];
        const double rate = instance_array((gic_head *)self, model->rate_offset)[self->grown];
        /* 0: the first step has no rate yet, or the rates of its stages carry the state away */
        return rate != 0 ? pool_print(pool, "%s: '%s' is at %.4g %s and changes by %.3g a second",
                                      gic_status_text(status), signal->name, value, signal->unit, rate)
                         : pool_print(pool, "%s: '%s' is at %.4g %s before the step", gic_status_text(status),
                                      signal->name, value, signal->unit);
    }
    if (status == GIC_ERROR_MASS && self->grown >= 0 && self->grown < model->slow_count)
        return pool_print(pool, "%s: '%s' of %s '%s'", gic_status_text(status), model->state[self->grown].name,
                          self->subset < 0 ? "body" : "subset",
                          self->subset < 0 ? model->body_name[0] : model->subset_name[self->subset]);
    if (status == GIC_ERROR_EVENTS && gic_event_name(model, self))
        return pool_print(pool, "%s: %s", gic_status_text(status), gic_event_name(model, self));
    if (self->subset < 0 || self->subset >= model->subset_count)
        return gic_status_text(status);
    return pool_print(pool, "%s: subset '%s'", gic_status_text(status), model->subset_name[self->subset]);
}
