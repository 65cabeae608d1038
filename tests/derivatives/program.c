/* SPDX-License-Identifier: MIT
 * Derivatives of rates and outputs of generated code, for comparison. It includes the code and the runtime:
 *
 *     gcc -DMODEL=car '-DCODE="car.c"' program.c -lm            by car_tangent_outputs()
 *     g++ -x c++ -DDUAL -DMODEL=car '-DCODE="car.c"' program.c  by numbers of the type Differential in place of doubles
 *
 * For the latter, gic_runtime.h must say `typedef Differential gic_real;`. `program names` prints the numbers of a row,
 * a line each: kind (state, input, parameter, port, discrete, output) and name; `program start` their values at set-up.
 * Else, for each row of these numbers on
 * standard input but for outputs, it prints the status, rates and outputs, then those of their derivatives by each
 * state, input, parameter and number of a port: a line each. Arguments AMPLITUDE WAVELENGTH: a wavy road; and
 * `columns`: derivatives of rates by car_jacobian() instead. */
#ifdef DUAL
#include "dual_real.hpp"
#endif
#include "gic_runtime.c"
#include "gic_road.c"
#include CODE

#include <stdio.h>
#include <stdlib.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(name) JOIN(MODEL, name)
typedef MODEL Vehicle;

#ifdef DUAL
#define VALUE(x) ((x).v)
#define SLOPE(x) ((x).d)
#else
#define VALUE(x) (x)
#endif

static void print(int count, const double *x)
{
    int i;
    for (i = 0; i < count; ++i)
        printf("%.17g%s", x[i], i + 1 < count ? " " : "");
    printf("\n");
}

static void names(const char *kind, int count, const gic_signal *signal)
{
    int i;
    for (i = 0; i < count; ++i)
        printf("%s %s\n", kind, signal[i].name);
}

static int take(int count, gic_real *out)
{
    int i;
    double x;
    for (i = 0; i < count; ++i) {
        if (scanf("%lf", &x) != 1)
            return 0;
        out[i] = x;
    }
    return 1;
}

#ifdef DUAL
/* Seeds are in the numbers themselves. Geometric parameters change derived numbers. */
static int evaluate(Vehicle *self)
{
#ifdef TUNED
    const int status = OF(_derive)(self, 0.0);
    if (status != GIC_OK)
        return status;
#endif
    self->recovered = 0;
    return OF(_outputs)(self);
}
#endif

#ifndef DUAL
/* May the derivative be other than 0? */
static int is_listed(int row, int column)
{
    int k;
    for (k = OF(_jacobian_start)[column]; k < OF(_jacobian_start)[column + 1]; ++k)
        if (OF(_jacobian_row)[k] == row)
            return 1;
    return 0;
}

/* The largest magnitude in a row. */
static double largest(const double *row, int columns)
{
    double most = 0;
    int c;
    for (c = 0; c < columns; ++c)
        most = fabs(row[c]) > most ? fabs(row[c]) : most;
    return most;
}

/* Equal, but for roundings of the row's largest, and that Newton's iteration from elsewhere ends in others. */
static int is_near(double a, double b, double most)
{
    return fabs(a - b) <= 1e-9 * (1 + most);
}

/* All columns at once must be the tangents, which must be 0 but for roundings where they are not listed. 0: they are;
 * else 1 + a row, or a status. */
static int check_jacobian(const Vehicle *at)
{
    const gic_model *code = &OF(_model);
    const int states = code->slow_count + code->fast_count, results = states + code->output_count;
    const int columns = states + code->input_count + code->parameter_count + code->port_count;
    static Vehicle self;
    static OF(_direction) along;
    double *all = (double *)calloc((size_t)(results * columns) + 1, sizeof *all);
    double *rates = (double *)calloc((size_t)(states * columns) + 1, sizeof *rates);
    int c, k, r, status;
    self = *at;
    status = OF(_jacobian_outputs)(&self, &along, all);
    self = *at;
    if (status == GIC_OK)
        status = OF(_jacobian)(&self, gic_time(&at->head), at->state, &along, rates);
    for (k = 0; k < states * columns && status == GIC_OK; ++k)
        status = is_near(all[k], rates[k], largest(all + k / columns * columns, columns)) ? 0 : 1 + k / columns;
    for (c = 0; c < columns && status == GIC_OK; ++c) {
        memset(&along, 0, sizeof along);
        *OF(_tangent_number)(&along, c) = 1;
        self = *at;
        status = OF(_tangent_outputs)(&self, &along);
        for (r = 0; r < results && status == GIC_OK; ++r) {
            const double one = r < states ? along.rate[r] : along.output[r - states];
            const double most = largest(all + r * columns, columns);
            /* of what cancels body by body a tangent may leave roundings */
            if (is_listed(r, c) ? !is_near(all[r * columns + c], one, most)
                                : fabs(one) > 1e-14 * (1 + most) || all[r * columns + c] != 0)
                status = 1 + r;
        }
    }
    free(all);
    free(rates);
    return status;
}
#endif

int main(int argc, char **argv)
{
    const gic_model *code = &OF(_model);
    static Vehicle self, at;
    const int states = code->slow_count + code->fast_count, results = states + code->output_count;
    const int kinds[4] = {states, code->input_count, code->parameter_count, code->port_count};
    double *line = (double *)calloc((size_t)results + 1, sizeof *line);
    gic_road_sine wave = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.0, 1.0, 0.0, 0.0};
    if (argc == 2) {
        int i;
        if (strcmp(argv[1], "start") == 0) {
            OF(_setup)(&at);
            for (i = 0; i < states; ++i)
                printf("%.17g ", VALUE(at.state[i]));
            for (i = 0; i < code->input_count; ++i)
                printf("%.17g ", VALUE(at.input[i]));
            for (i = 0; i < code->parameter_count; ++i)
                printf("%.17g ", VALUE(at.parameter[i]));
            for (i = 0; i < code->port_count; ++i)
                printf("0 ");
            for (i = 0; i < code->discrete_count; ++i)
                printf("%d ", (int)at.discrete[i]);
            printf("\n");
            return 0;
        }
        names("state", states, code->state);
        names("input", code->input_count, code->input);
        names("parameter", code->parameter_count, code->parameter);
        names("port", code->port_count, code->port);
        names("discrete", code->discrete_count, code->discrete);
        names("output", code->output_count, code->output);
        return 0;
    }
    if (argc > 2) {
        wave.amplitude = atof(argv[1]);
        wave.wavelength = atof(argv[2]);
    }
    for (;;) {
        gic_real parameter[4096], other[4096];
        int i, k, j, status;
#ifndef DUAL
        int column;
#endif
        OF(_setup)(&at);
        if (!take(states, other) || !take(code->input_count, other + states) || !take(code->parameter_count, parameter))
            return 0;
        status = OF(_setup_with)(&at, parameter);
        at.head.road = argc > 2 ? &wave.head : NULL;
        for (i = 0; i < states; ++i)
            at.state[i] = other[i];
        for (i = 0; i < code->input_count; ++i)
            at.input[i] = other[states + i];
        take(code->port_count, at.port);
        for (i = 0; i < code->discrete_count; ++i) {
            gic_real x;
            take(1, &x);
            at.discrete[i] = (int)VALUE(x);
        }
        if (status == GIC_OK)
            status = OF(_outputs)(&at);
        printf("%d\n", status);
        if (status != GIC_OK)
            continue;
        for (i = 0; i < results; ++i)
            line[i] = VALUE(i < states ? at.rate[i] : at.output[i - states]);
        print(results, line);
#ifndef DUAL
        status = check_jacobian(&at);
        if (status) {
            fprintf(stderr, "jacobian: row or status %d\n", status);
            return 1;
        }
#endif
#ifndef DUAL
        column = 0;
#endif
        for (k = 0; k < 4; ++k)
            for (j = 0; j < kinds[k]; ++j) {
#ifdef DUAL
                self = at;
                SLOPE((k == 0 ? self.state : k == 1 ? self.input : k == 2 ? self.parameter : self.port)[j]) = 1;
                status = GIC_OK;
                for (i = 0; i < 3 && status == GIC_OK; ++i) /* slopes of what is iterated settle */
                    status = evaluate(&self);
                for (i = 0; i < results; ++i)
                    line[i] = SLOPE(i < states ? self.rate[i] : self.output[i - states]);
#else
                static OF(_direction) along;
                static gic_real jacobian[1 << 18];
                memset(&along, 0, sizeof along);
                (k == 0 ? along.state : k == 1 ? along.input : k == 2 ? along.parameter : along.port)[j] = 1;
                self = at;
                status = OF(_tangent_outputs)(&self, &along);
                for (i = 0; i < results; ++i)
                    line[i] = i < states ? along.rate[i] : along.output[i - states];
                if (argc > 3) {
                    const int columns = kinds[0] + kinds[1] + kinds[2] + kinds[3];
                    self = at;
                    status = status ? status : OF(_jacobian)(&self, gic_time(&at.head), at.state, &along, jacobian);
                    for (i = 0; i < states; ++i)
                        line[i] = jacobian[columns * i + column];
                    ++column;
                }
#endif
                if (status != GIC_OK)
                    for (i = 0; i < results; ++i)
                        line[i] = status;
                print(results, line);
            }
    }
}
