/* SPDX-License-Identifier: MIT
 *
 * The frequency weightings of ISO 2631-1 for accelerations that people feel, as analogue filters. */
#ifndef RUN_RIDE_FILTER_H
#define RUN_RIDE_FILTER_H

/* Vertical accelerations, and horizontal ones. */
typedef enum RideWeight { RIDE_K, RIDE_D } RideWeight;

/* The size of a filter's transfer function at a frequency in Hz. */
double ride_weight(RideWeight weight, double frequency);

enum { RIDE_SECTIONS = 4, RIDE_STATES = 2 * RIDE_SECTIONS };

/* A filter at work. */
typedef struct RideFilter {
    RideWeight weight;
    int states;
    double first, input, state[RIDE_STATES]; /* input: beside the first one */
    /* from one sample to the next, `step` seconds later, with an input that changes linearly */
    double step, turn[RIDE_STATES][RIDE_STATES], kept[RIDE_STATES], change[RIDE_STATES];
} RideFilter;

/* As if the input had always been this. The output is 0. */
RideFilter ride_filter_begin(RideWeight weight, double input);
/* The output `step` > 0 seconds later, to which the input changes linearly: exact but for rounding. */
double ride_filter_step(RideFilter *filter, double step, double input);

#endif
