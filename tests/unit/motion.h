/* SPDX-License-Identifier: MIT
 * What tests of generated code share: instances of any model by its descriptor, admissible states, outputs by name. */
#ifndef MOTION_H
#define MOTION_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "gic_runtime.h"

/* An instance of some model. */
typedef struct Vehicle {
    const gic_model *model;
    gic_head *head; /* the instance itself, which begins with it */
    double *state, *input, *output, *rate;
    int states;
} Vehicle;

static inline double *vehicle_array(const Vehicle *vehicle, size_t offset)
{
    return (double *)(void *)((char *)vehicle->head + offset);
}

/* Set up at the design configuration; the caller frees `head`. */
static inline Vehicle vehicle_new(const gic_model *model)
{
    Vehicle vehicle = {.model = model, .head = malloc(model->size), .states = model->slow_count};
    assert_non_null(vehicle.head);
    assert_int_equal(model->setup(vehicle.head), GIC_OK);
    vehicle.state = vehicle_array(&vehicle, model->state_offset);
    vehicle.input = vehicle_array(&vehicle, model->input_offset);
    vehicle.output = vehicle_array(&vehicle, model->output_offset);
    vehicle.rate = vehicle_array(&vehicle, model->rate_offset);
    return vehicle;
}

static inline void vehicle_steps(Vehicle *vehicle, double step, int32_t method, int steps)
{
    for (int i = 0; i < steps; ++i) {
        const int status = gic_step(vehicle->model, vehicle->head, step, method);
        if (status != GIC_OK)
            fail_msg("%s at %g s: %s (subset %d)", vehicle->model->name, gic_time(vehicle->head),
                     gic_status_text(status), (int)vehicle->head->subset);
    }
}

static inline int signal_index(const gic_signal *signal, int32_t count, const char *name)
{
    for (int i = 0; i < count; ++i)
        if (!strcmp(signal[i].name, name))
            return i;
    fail_msg("no signal '%s'", name);
    return -1;
}

static inline double *state_named(const Vehicle *vehicle, const char *name)
{
    return &vehicle->state[signal_index(vehicle->model->state, vehicle->states, name)];
}

/* An output as of the last call of outputs(). */
static inline double output_named(const Vehicle *vehicle, const char *name)
{
    return vehicle->output[signal_index(vehicle->model->output, vehicle->model->output_count, name)];
}

/* Evenly in [-1, 1), the same on every machine (a 64-bit congruence; its upper bits). */
static inline double random_even(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

/* A state with coordinates in the middle of their ranges, any orientation, and speeds of driving. */
static inline void random_state(const Vehicle *vehicle, uint64_t *seed)
{
    const gic_model *model = vehicle->model;
    double *state = vehicle->state;
    const int base = model->free_base ? 7 : 0, free_count = (vehicle->states - (model->free_base ? 13 : 0)) / 2;
    const int twist = base + free_count; /* where v, omega and the coordinates' rates begin */
    if (model->free_base) {
        double norm = 0;
        for (int i = 0; i < 7; ++i)
            state[i] = random_even(seed);
        for (int i = 3; i < 7; ++i)
            norm += state[i] * state[i];
        for (int i = 3; i < 7; ++i)
            state[i] /= sqrt(norm);
    }
    for (int i = twist; i < vehicle->states; ++i)
        state[i] = random_even(seed);
    for (int i = 0; i < model->coordinate_count; ++i) {
        const double low = model->coordinate_low[i], high = model->coordinate_high[i];
        const double value = 0.5 * (low + high) + 0.4 * (high - low) * random_even(seed);
        if (model->coordinate_state[i] >= 0) {
            state[model->coordinate_state[i]] = value;
        } else {
            double *input = &vehicle->input[model->coordinate_input[i]];
            input[0] = value;
            input[1] = random_even(seed);
            input[2] = random_even(seed);
        }
    }
}

#endif
