/* SPDX-License-Identifier: MIT
 * The filters of ISO 2631-1: products of sections of second order. */
#include "run/ride_filter.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

/* (b0 + b1 s/w + b2 (s/w)^2) / (1 + s/(Q w) + (s/w)^2), w the corner's angular frequency */
typedef struct Section {
    double corner /* Hz */, Q, b[3];
} Section;

static const double pi = 3.141592653589793;

/* High-pass and low-pass of the band, the transition from acceleration to velocity, a step upwards. */
static int sections_of(RideWeight weight, Section section[RIDE_SECTIONS])
{
    const double half = 0.70710678118654752, turn = weight == RIDE_K ? 12.5 : 2;
    const double from = 2.37, to = 3.35, Q = 0.91, ratio = from / to;
    section[0] = (Section){0.4, half, {0, 0, 1}};
    section[1] = (Section){100, half, {1, 0, 0}};
    section[2] = (Section){turn, 0.63, {1, 1, 0}};
    section[3] = (Section){to, Q, {ratio * ratio, ratio / Q, 1}};
    return weight == RIDE_K ? 4 : 3;
}

double ride_weight(RideWeight weight, double f)
{
    Section section[RIDE_SECTIONS];
    const int sections = sections_of(weight, section);
    double w = 1;
    for (int i = 0; i < sections; ++i) {
        const double r = f / section[i].corner, *b = section[i].b;
        w *= hypot(b[0] - b[2] * r * r, b[1] * r) / hypot(1 - r * r, r / section[i].Q);
    }
    return w;
}

/* What goes into section `to`, or out of the last one: sum of output[i] state[i], and `direct` times the input. A
 * section has the states z and z'/w, of which z is its input over its denominator. rate: NULL, or [states][states + 1],
 * gets the derivatives of the states by states and input. */
static void connect(RideWeight weight, double output[RIDE_STATES], double *direct,
                    double rate[RIDE_STATES][RIDE_STATES + 1])
{
    Section section[RIDE_SECTIONS];
    const int sections = sections_of(weight, section);
    memset(output, 0, RIDE_STATES * sizeof *output);
    *direct = 1;
    for (int i = 0; i < sections; ++i) {
        const double w = 2 * pi * section[i].corner, *b = section[i].b;
        double in[RIDE_STATES];
        memcpy(in, output, sizeof in);
        in[2 * i] -= 1;
        in[2 * i + 1] -= 1 / section[i].Q; /* now (s/w)^2 z */
        for (int k = 0; rate && k < RIDE_STATES; ++k) {
            rate[2 * i][k] = k == 2 * i + 1 ? w : 0;
            rate[2 * i + 1][k] = w * in[k];
        }
        if (rate) {
            rate[2 * i][RIDE_STATES] = 0;
            rate[2 * i + 1][RIDE_STATES] = w * *direct;
        }
        for (int k = 0; k < RIDE_STATES; ++k)
            output[k] = b[2] * in[k];
        output[2 * i] += b[0];
        output[2 * i + 1] += b[1];
        *direct *= b[2];
    }
}

RideFilter ride_filter_begin(RideWeight weight, double input)
{
    Section section[RIDE_SECTIONS];
    return (RideFilter){.weight = weight, .states = 2 * sections_of(weight, section), .first = input};
}

/* Matrices for a step: the exponential of (rates, input, input's change) times the step. */
static void prepare(RideFilter *f, double step)
{
    enum { ALL = RIDE_STATES + 2 };
    double output[RIDE_STATES], direct, rate[RIDE_STATES][RIDE_STATES + 1], given[ALL * ALL] = {0}, made[ALL * ALL];
    const int n = f->states, all = n + 2;
    connect(f->weight, output, &direct, rate);
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k)
            given[i * all + k] = rate[i][k] * step;
        given[i * all + n] = rate[i][RIDE_STATES] * step;
    }
    given[n * all + n + 1] = 1; /* the input's change in a step */
    gsl_matrix_view from = gsl_matrix_view_array(given, (size_t)all, (size_t)all);
    gsl_matrix_view to = gsl_matrix_view_array(made, (size_t)all, (size_t)all);
    gsl_linalg_exponential_ss(&from.matrix, &to.matrix, GSL_PREC_DOUBLE);
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k)
            f->turn[i][k] = made[i * all + k];
        f->kept[i] = made[i * all + n];
        f->change[i] = made[i * all + n + 1];
    }
    f->step = step;
}

double ride_filter_step(RideFilter *f, double step, double input)
{
    double next[RIDE_STATES] = {0}, output[RIDE_STATES], direct, y;
    input -= f->first;                      /* of which nothing passes */
    if (fabs(step - f->step) > 1e-9 * step) /* output times are products, so that differences have rounding */
        prepare(f, step);
    for (int i = 0; i < f->states; ++i) {
        next[i] = f->kept[i] * f->input + f->change[i] * (input - f->input);
        for (int k = 0; k < f->states; ++k)
            next[i] += f->turn[i][k] * f->state[k];
    }
    memcpy(f->state, next, sizeof next);
    f->input = input;
    connect(f->weight, output, &direct, NULL);
    y = direct * input;
    for (int k = 0; k < f->states; ++k)
        y += output[k] * f->state[k];
    return y;
}
