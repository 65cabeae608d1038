/* SPDX-License-Identifier: MIT
 * Calls of a model's functions in a loop. calls_float.c makes the same of the other number type. */
#include "bench/calls.h"
#include "gic_runtime.h"

#include <time.h>

/* A road for code of this number type. */
typedef struct Adapter {
    gic_road head;
    const CallsRoad *road;
} Adapter;

static double now(void)
{
    struct timespec clock;
    clock_gettime(CLOCK_MONOTONIC, &clock);
    return (double)clock.tv_sec + 1e-9 * (double)clock.tv_nsec;
}

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

static void copy(gic_real *to, const double *from, int32_t count)
{
    for (int32_t i = 0; i < count; ++i)
        to[i] = GIC_R(from[i]);
}

static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const CallsRoad *real = ((const Adapter *)(const void *)road)->road;
    double number[3];
    real->height(real->road, lane, time, x, y, number);
    copy(out, number, 3);
}

static gic_real friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    const CallsRoad *real = ((const Adapter *)(const void *)road)->road;
    return GIC_R(real->friction(real->road, lane, time, x, y));
}

static int begin(const void *model, void *self, const double *parameter, const CallsRoad *road, void *adapter,
                 void *room)
{
    const gic_model *code = model;
    copy(room, parameter, code->parameter_count);
    const int status = code->setup_with(self, room);
    if (road) {
        *(Adapter *)adapter = (Adapter){{height, road->friction ? friction : NULL, NULL, NULL, GIC_ROAD_OWN}, road};
        ((gic_head *)self)->road = adapter;
    }
    return status;
}

static void put(const void *model, void *self, const CallsMoment *moment)
{
    const gic_model *code = model;
    gic_head *head = self;
    head->start_time = GIC_R(moment->time);
    head->steps = 0;
    copy(array(self, code->input_offset), moment->input, code->input_count);
    copy(array(self, code->discrete_offset), moment->discrete, code->discrete_count);
}

static int rhs(const void *model, void *self, const CallsMoment moment[2], void *room, int count, double *seconds)
{
    const gic_model *code = model;
    const int32_t states = code->slow_count + code->fast_count;
    gic_real *state[2] = {room, (gic_real *)room + states}, *rate = state[1] + states;
    const gic_real time[2] = {GIC_R(moment[0].time), GIC_R(moment[1].time)};
    int status = GIC_OK;
    for (int i = 0; i < 2; ++i)
        copy(state[i], moment[i].state, states);
    const double before = now();
    for (int i = 1; i <= count && status == GIC_OK; ++i)
        status = code->rhs(self, time[i % 2], state[i % 2], rate);
    *seconds = now() - before;
    return status;
}

static int fast(const void *model, void *self, const CallsMoment moment[2], void *room, int count, double *seconds)
{
    const gic_model *code = model;
    const int32_t slow = code->slow_count, spins = code->fast_count;
    gic_real *state[2] = {room, (gic_real *)room + spins}, *rate = state[1] + spins;
    gic_real *link = (gic_real *)room + 3 * (slow + spins);
    const gic_real time = GIC_R(moment[0].time);
    double once;
    int status = rhs(model, self, moment, room, 2, &once); /* recover the motion of the first moment */
    if (status == GIC_OK)
        status = code->link(self, time, room, link);
    for (int i = 0; i < 2; ++i)
        copy(state[i], moment[i].state + slow, spins);
    const double before = now();
    for (int i = 1; i <= count && status == GIC_OK; ++i)
        status = code->fast(self, time, link, state[i % 2], rate);
    *seconds = now() - before;
    return status;
}

static void counts(const void *self, int64_t out[2])
{
    const gic_head *head = self;
    out[0] = head->newton_count;
    out[1] = head->correction_count;
}

#ifdef GIC_FLOAT
const CallsType calls_float = {sizeof(Adapter), begin, put, rhs, fast, counts};
#else
const CallsType calls_double = {sizeof(Adapter), begin, put, rhs, fast, counts};
#endif
