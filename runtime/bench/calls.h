/* SPDX-License-Identifier: MIT
 * Calls of a model's functions one after another, as a loop that can be timed: calls.c, which exists once for each
 * number type of generated code. All numbers go in as double, so that the caller need not know the type. */
#ifndef BENCH_CALLS_H
#define BENCH_CALLS_H

#include <stddef.h>
#include <stdint.h>

/* A road of double numbers, as functions of gic_road have it. friction: NULL where the road has none. */
typedef struct CallsRoad {
    void (*height)(const void *road, int32_t lane, double time, double x, double y, double out[3]);
    double (*friction)(const void *road, int32_t lane, double time, double x, double y);
    const void *road;
} CallsRoad;

/* All that a right-hand side depends on. state: the engine's own, slow and fast. */
typedef struct CallsMoment {
    double time;
    const double *state, *input, *discrete;
} CallsMoment;

/* Numbers of working space for a model's functions, by the counts of its descriptor. */
#define CALLS_ROOM(code) \
    ((size_t)(3 * ((code)->slow_count + (code)->fast_count) + (code)->parameter_count + (code)->link_count))

/* The functions of one number type. `code` is a gic_model of that type, `self` its instance, `room` space for
 * CALLS_ROOM numbers. They return a status. */
typedef struct CallsType {
    size_t adapter; /* bytes that begin() needs for the road, as long as the instance lives */
    /* Set up with parameters, on a road; NULL: flat. */
    int (*begin)(const void *code, void *self, const double *parameter, const CallsRoad *road, void *adapter,
                 void *room);
    /* Time, inputs and discrete states of a moment. */
    void (*put)(const void *code, void *self, const CallsMoment *moment);
    /* `count` right-hand sides, back and forth between two moments, from the second on. *seconds: what they took. */
    int (*rhs)(const void *code, void *self, const CallsMoment moment[2], void *room, int count, double *seconds);
    /* The same of the rates of the fast states alone, at the links of the first moment. */
    int (*fast)(const void *code, void *self, const CallsMoment moment[2], void *room, int count, double *seconds);
    /* Solutions of subsets so far, and the corrections that they took. */
    void (*counts)(const void *self, int64_t counts[2]);
} CallsType;

extern const CallsType calls_double, calls_float;

#endif
