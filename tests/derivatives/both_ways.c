/* SPDX-License-Identifier: MIT
 * Right-hand side and outputs along a direction and backwards: w . (J d) = (J^T w) . d. MODEL and CODE as in program.c.
 *
 *     program STATES TOLERANCE [conditioned]     prints the largest deviation, relative to the sum of the terms'
 * magnitudes
 *
 * conditioned: near singular configurations roundings grow. What a change of the state by its roundings does to w . (J
 * d) is measured at each state; 16 times that is allowed in addition, and where it is above 1e-6 of the sum, the state
 * does not count. */
#include CODE

#include <stdio.h>
#include <stdlib.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(name) JOIN(MODEL, name)

static const gic_model *const code = &OF(_model);
static MODEL start, self;
static OF(_direction) along, by, seed_of;
static gic_real jacobian[1 << 18];
static int conditioned;

/* Between -0.5 and 0.5. */
static double chance(void)
{
    static uint64_t seed = 17;
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0 - 0.5;
}

static void draw(int32_t count, double size, gic_real *x)
{
    for (int32_t i = 0; i < count; ++i)
        x[i] = (gic_real)(size * chance());
}

/* Another state: coordinates within a tenth of their range, velocities, inputs. */
static void move(void)
{
    gic_real *const input = (gic_real *)(void *)((char *)&self + code->input_offset);
    const int32_t half = (code->slow_count - code->free_base) / 2;
    self = start;
    for (int32_t i = 0; i < code->slow_count + code->fast_count; ++i)
        self.state[i] += (gic_real)((i < half + code->free_base ? 0.02 : i < code->slow_count ? 4 : 0.2) * chance());
    for (int32_t c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            self.state[code->coordinate_state[c]] =
                start.state[code->coordinate_state[c]] +
                (gic_real)(0.1 * chance()) * (code->coordinate_high[c] - code->coordinate_low[c]);
    if (code->free_base) {
        double e[4], length = 0;
        for (int i = 0; i < 4; ++i) {
            e[i] = (double)start.state[3 + i] + 0.6 * chance();
            length += e[i] * e[i];
        }
        for (int i = 0; i < 4; ++i)
            self.state[3 + i] = (gic_real)(e[i] / sqrt(length));
    }
    for (int32_t i = 0; i < code->input_count; ++i)
        input[i] += (gic_real)(0.02 * chance());
}

/* Sums of products, and of their magnitudes. */
static double together(int32_t count, const gic_real *a, const gic_real *b, double *size)
{
    double sum = 0;
    for (int32_t i = 0; i < count; ++i) {
        const double term = (double)a[i] * (double)b[i];
        sum += term;
        *size += fabs(term);
    }
    return sum;
}

/* w . (J d) at the present state, with the sum of its terms' magnitudes added to size; 0: it has a status. */
static int forwards(int outputs, double *sum, double *size)
{
    if ((outputs ? OF(_tangent_outputs)(&self, &along) : OF(_tangent)(&self, 0, self.state, &along)) != GIC_OK)
        return 0;
    *sum = together(code->slow_count + code->fast_count, along.rate, seed_of.rate, size);
    *sum += outputs ? together(code->output_count, along.output, seed_of.output, size) : 0;
    return 1;
}

/* By how much roundings of the state change w . (J d), at most of a few; -1: there is a status. */
static double rounding(int outputs, double sum)
{
    const MODEL kept = self;
    double most = 0, other, size = 0;
    for (int k = 0; k < 4; ++k) {
        for (int32_t i = 0; i < code->slow_count + code->fast_count; ++i)
            self.state[i] = kept.state[i] * (1 + (gic_real)(8e-16 * chance()));
        const int good = forwards(outputs, &other, &size);
        self = kept;
        if (!good)
            return -1;
        most = fabs(other - sum) > most ? fabs(other - sum) : most;
    }
    return most;
}

/* The deviation at the present state; -1: it has a status, or is too near a singular configuration. */
static double compare(int outputs)
{
    const int32_t n = code->slow_count + code->fast_count;
    double size = 0, left, right, allowed = 0;
    memset(&along, 0, sizeof along);
    memset(&by, 0, sizeof by);
    draw(n, 1, along.state);
    draw(code->input_count, 1, along.input);
    draw(code->port_count, 1, along.port);
    draw(n, 1, by.rate);
    draw(outputs ? code->output_count : 0, 1, by.output);
    for (int32_t i = 0; i < code->parameter_count; ++i)
        along.parameter[i] = (gic_real)(0.1 * chance()) * self.parameter[i];
    seed_of = by;
    if (!forwards(outputs, &left, &size))
        return -1;
    if (conditioned) {
        allowed = rounding(outputs, left);
        if (allowed < 0 || allowed > 1e-6 * size)
            return -1;
    }
    if ((outputs ? OF(_adjoint_outputs)(&self, &by, jacobian) : OF(_adjoint)(&self, 0, self.state, &by, jacobian)) !=
        GIC_OK)
        return -1;
    if (memcmp(seed_of.rate, by.rate, (size_t)n * sizeof *by.rate) != 0)
        return 1; /* weights stay */
    right = together(n, along.state, by.state, &size) + together(code->input_count, along.input, by.input, &size);
    right += together(code->parameter_count, along.parameter, by.parameter, &size);
    right += together(code->port_count, along.port, by.port, &size);
    const double off = fabs(left - right);
    return off <= 16 * allowed ? 0 : (off - 16 * allowed) / (size > 0 ? size : 1);
}

int main(int argc, char **argv)
{
    const int states = argc > 1 ? atoi(argv[1]) : 1000;
    const double tolerance = argc > 2 ? atof(argv[2]) : 1e-13;
    double worst = 0;
    int good = 0, tried;
    conditioned = argc > 3;
    if (OF(_setup)(&start) != GIC_OK)
        return 1;
    if (code->free_base)
        start.state[7 + (code->slow_count - 13) / 2] = 8; /* v.x, m/s */
    if (code->roll && code->roll(&start) != GIC_OK)
        return 1;
    for (tried = 0; good < states && tried < 2 * states; ++tried) {
        move();
        const double off = compare(tried % 16 == 0);
        good += off >= 0;
        worst = off > worst || !(off == off) ? off : worst;
    }
    printf("%d of %d states, %.1e\n", good, tried, worst);
    by.rate[0] = (gic_real)NAN;
    if (OF(_adjoint)(&self, 0, self.state, &by, jacobian) != GIC_ERROR_INPUT)
        return 1 + printf("a weight that is no number is taken\n");
    return !(good >= (conditioned ? (states + 3) / 4 : states) && worst <= tolerance);
}
