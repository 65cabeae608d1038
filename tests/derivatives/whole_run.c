/* SPDX-License-Identifier: MIT
 * Derivatives of a scalar of a whole run (gic_gradient.h). MODEL and CODE as in program.c.
 *
 *     program STEPS STEP TOLERANCE     tangents against adjoints, for both methods, with and without outputs; numbers
 * of checkpoints, memory that is too small, arguments. Prints a slope a line with -DQUAD: program STEPS STEP
 * [REACH SLOPES]  the same slopes by differences of fourth order, over REACH (1e-7), of runs in quad precision; and,
 * with a file of what the former printed, remainders of those slopes: (value(h) - value(0) - slope h) / h for h = REACH
 * and half of that
 *
 * All directions and weights come from a generator of numbers, the same in both. */
#ifdef QUAD
#include "quad_real.h"
#endif
#include "gic_gradient.h"
#include CODE

#include <stdio.h>
#include <stdlib.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(name) JOIN(MODEL, name)

static MODEL start;
static const gic_model *const code = &OF(_model);
static int32_t n;
static gic_real *nominal; /* inputs without their waves */

enum { MOST = 4096, DIRECTIONS = 2 };

/* How a run changes: everything that it has derivatives by. */
typedef struct Change {
    double state[MOST], input[MOST], parameter[MOST], port[MOST], wave;
} Change;

/* Between -0.5 and 0.5. */
static double chance(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

/* The weight of a state, or of an output, in the scalar. */
static double weight_of(int64_t number, int32_t i)
{
    uint64_t seed = (uint64_t)number * 7919 + (uint64_t)i * 104729 + 11;
    chance(&seed);
    return chance(&seed);
}

/* Inputs swing by this much: one number that all of them follow from. */
static gic_real wave = 0;

static gic_real swing(int32_t i, gic_real time)
{
    const gic_real t = 9 * time + i;
    return GIC_SIN(t);
}

static void give_inputs(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user, (void)lane;
    for (int32_t i = 0; i < code->input_count; ++i)
        input[i] = nominal[i] + wave * swing(i, time);
}

/* ---- the run ---------------------------------------------------------------------------------------------------- */

static gic_real *in(MODEL *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

static void set_up(void)
{
    int bad = OF(_setup)(&start);
    uint64_t seed = 5;
    n = code->slow_count + code->fast_count;
    if (code->free_base)
        start.state[7 + (code->slow_count - 13) / 2] = 8; /* v.x, m/s */
    for (int32_t i = code->free_base ? 7 : 0; i < code->slow_count; ++i)
        start.state[i] += (gic_real)(2e-3 * chance(&seed));
    if (code->roll)
        bad |= code->roll(&start);
    nominal = (gic_real *)calloc((size_t)code->input_count + 1, sizeof *nominal);
    memcpy(nominal, in(&start, code->input_offset), (size_t)code->input_count * sizeof *nominal);
    start.head.input_function = give_inputs;
    wave = GIC_R(1e-3);
    for (int i = 0; i < 3; ++i) /* a gear is chosen */
        bad |= OF(_step)(&start, GIC_R(1e-3), GIC_RK4);
    if (bad) {
        printf("set-up has a status\n");
        exit(1);
    }
}

static void choose(Change *change, int direction)
{
    uint64_t seed = 1000 + (uint64_t)direction;
    for (int32_t i = 0; i < n; ++i)
        change->state[i] = chance(&seed);
    for (int32_t i = 0; i < code->input_count; ++i)
        change->input[i] = chance(&seed);
    for (int32_t i = 0; i < code->parameter_count; ++i) {
        const double by = chance(&seed), size = fabs((double)in(&start, code->parameter_offset)[i]);
        change->parameter[i] = by * (size > 0 ? size : 1);
    }
    for (int32_t i = 0; i < code->port_count; ++i)
        change->port[i] = chance(&seed);
    change->wave = chance(&seed);
}

#ifdef QUAD
/* The vehicle with other parameters, geometric ones among them, where it was. */
static int rebuild(MODEL *self, const gic_real *parameter)
{
    const int status = code->setup_with(self, parameter);
    memcpy(self->state, start.state, sizeof self->state);
    memcpy(self->discrete, start.discrete, sizeof self->discrete);
    memcpy(in(self, code->port_offset), in(&start, code->port_offset), (size_t)code->port_count * sizeof(gic_real));
    self->head.input_function = give_inputs;
    gic_restart(self, gic_time(&start));
    return status;
}

/* The scalar of a run that begins elsewhere. */
static gic_real scalar(const Change *change, gic_real reach, int method, int looks, int64_t steps, gic_real step)
{
    static MODEL self;
    gic_real sum = 0, *const kept = nominal, *moved = (gic_real *)calloc((size_t)code->input_count + 1, sizeof *moved);
    const gic_real calm = wave;
    gic_real *parameter = (gic_real *)calloc((size_t)code->parameter_count + 1, sizeof *parameter);
    for (int32_t i = 0; i < code->parameter_count; ++i)
        parameter[i] = in(&start, code->parameter_offset)[i] + reach * change->parameter[i];
    int status = rebuild(&self, parameter);
    for (int32_t i = 0; i < n; ++i)
        self.state[i] += reach * change->state[i];
    for (int32_t i = 0; i < code->input_count; ++i)
        moved[i] = nominal[i] + reach * change->input[i];
    for (int32_t i = 0; i < code->port_count; ++i)
        in(&self, code->port_offset)[i] += reach * change->port[i];
    nominal = moved;
    wave = calm + reach * change->wave;
    status = status == GIC_OK ? code->settle(&self, self.state) : status;
    for (int64_t k = 0; k <= steps && status == GIC_OK; ++k) {
        MODEL look = self;
        give_inputs(NULL, 0, gic_time(&look), in(&look, code->input_offset));
        for (int32_t i = 0; i < n; ++i)
            sum += weight_of(k, i) * look.state[i];
        if (looks && (k % 8 == 0 || k == steps)) {
            status = code->outputs(&look);
            for (int32_t i = 0; i < code->output_count; ++i)
                sum += weight_of(k, n + i) * in(&look, code->output_offset)[i];
        }
        if (status == GIC_OK && k < steps)
            status = gic_step(code, &self, step, method);
    }
    nominal = kept;
    wave = calm;
    free(moved);
    free(parameter);
    if (status != GIC_OK) {
        printf("status %d\n", status);
        exit(1);
    }
    return sum;
}

int main(int argc, char **argv)
{
    const int64_t steps = argc > 1 ? atoll(argv[1]) : 40;
    const gic_real step = argc > 2 ? atof(argv[2]) : 0.001, reach = argc > 3 ? atof(argv[3]) : 1e-7Q;
    FILE *const slopes = argc > 4 ? fopen(argv[4], "r") : NULL;
    static Change change;
    set_up();
    for (int method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int looks = 0; looks < 2; ++looks)
            for (int d = 0; d < DIRECTIONS; ++d) {
                gic_real s[4];
                double slope, size;
                choose(&change, d);
                for (int i = 0; i < 4; ++i)
                    s[i] = scalar(&change, reach * (i < 2 ? i - 2 : i - 1), method, looks, steps, step);
                printf("%.17g", (double)((s[0] - s[3] + 8 * (s[2] - s[1])) / (12 * reach)));
                if (slopes && fscanf(slopes, "%lf %lf", &slope, &size) == 2) {
                    const gic_real still = scalar(&change, 0, method, looks, steps, step);
                    const gic_real half = scalar(&change, reach / 2, method, looks, steps, step);
                    printf(" %.17g %.17g", (double)((s[2] - still) / reach - slope),
                           (double)((half - still) / (reach / 2) - slope));
                }
                printf("\n");
            }
    return 0;
}
#else
static double by_wave; /* backwards: derivative by `wave` */
static double d_wave;  /* forwards: its change */
static int backwards;

static void follow(void *user, gic_real time, gic_real *input)
{
    (void)user;
    for (int32_t i = 0; i < code->input_count; ++i) {
        if (backwards)
            by_wave += (double)(input[i] * swing(i, time));
        else
            input[i] += (gic_real)d_wave * swing(i, time);
    }
}

static gic_real weigh(void *user, int64_t number, const void *self, gic_real *by_state, gic_real *by_output)
{
    const MODEL *const look = (const MODEL *)self;
    const int64_t steps = *(const int64_t *)user;
    gic_real sum = GIC_R(0.0);
    for (int32_t i = 0; i < n; ++i) {
        by_state[i] += (gic_real)weight_of(number, i);
        sum += (gic_real)weight_of(number, i) * look->state[i];
    }
    for (int32_t i = 0; by_output && i < code->output_count && (number % 8 == 0 || number == steps); ++i) {
        by_output[i] += (gic_real)weight_of(number, n + i);
        sum += (gic_real)weight_of(number, n + i) * look->output[i];
    }
    return sum;
}

/* The fewest steps before each of `left` comes last once, from `kept` instances: of all ways, tried one by one. */
static int64_t fewest(int left, int kept)
{
    static int64_t known[128][16];
    int64_t *least = &known[left][kept];
    if (left == 1)
        return 0;
    if (kept == 1)
        return (int64_t)left * (left - 1) / 2;
    if (*least)
        return *least;
    for (int ahead = 1; ahead < left; ++ahead) {
        const int64_t count = ahead + fewest(left - ahead, kept - 1) + fewest(ahead, kept);
        *least = *least == 0 || count < *least ? count : *least;
    }
    return *least;
}

static int bad;

static void expect(int good, const char *what)
{
    if (good)
        return;
    printf("not so: %s\n", what);
    ++bad;
}

static void *memory_of(gic_gradient *run, OF(_direction) * along, int back)
{
    gic_real slope;
    run->memory = NULL;
    run->size = 0;
    expect((back ? gic_run_adjoint(run, along) : gic_run_tangent(run, along, &slope)) == GIC_ERROR_ARGUMENT,
           "no memory is too little");
    run->size = run->needed;
    run->memory = calloc(run->needed + 8, 1);
    memset((char *)run->memory + run->needed, 0x5a, 8);
    return run->memory;
}

static void check_end(const gic_gradient *run)
{
    for (int i = 0; i < 8; ++i)
        expect(((const char *)run->memory)[run->needed + (size_t)i] == 0x5a, "nothing is written behind the memory");
}

static OF(_direction) by, again, along;

/* Backwards with all instances, then with fewer: the same bits, with the fewest steps. */
static gic_real run_back(gic_gradient *run)
{
    static const int64_t few[] = {9, 4, 2, 1};
    backwards = 1;
    by_wave = 0;
    run->checkpoints = run->steps + 100;
    memory_of(run, &by, 1);
    expect(run->checkpoints == run->steps, "no more checkpoints than steps");
    expect(gic_run_adjoint(run, &by) == GIC_OK, "an adjoint");
    expect(run->made == run->steps, "no step is repeated");
    check_end(run);
    free(run->memory);
    const double wave_then = by_wave;
    const gic_real value = run->value;
    for (int i = 0; i < 4; ++i) {
        by_wave = 0;
        run->checkpoints = few[i];
        memory_of(run, &again, 1);
        expect(gic_run_adjoint(run, &again) == GIC_OK, "an adjoint with few checkpoints");
        expect(!memcmp(&again.state, &by.state, sizeof by.state) && !memcmp(&again.input, &by.input, sizeof by.input) &&
                   !memcmp(&again.parameter, &by.parameter, sizeof by.parameter) &&
                   !memcmp(&again.port, &by.port, sizeof by.port) && by_wave == wave_then && run->value == value,
               "the same bits with few checkpoints");
        expect(run->made == fewest((int)run->steps, (int)(few[i] < run->steps ? few[i] : run->steps)) + 1,
               "the fewest steps are repeated");
        check_end(run);
        run->size -= 1;
        expect(gic_run_adjoint(run, &again) == GIC_ERROR_ARGUMENT && run->needed == run->size + 1,
               "memory is too small by a byte");
        free(run->memory);
    }
    by_wave = wave_then;
    return value;
}

/* The scalar's change along a direction by its derivatives, and the sum of magnitudes. */
static double combine(const Change *c, double *size)
{
    double sum = c->wave * by_wave;
    *size = fabs(sum);
#define COMBINE(array, count) \
    for (int32_t i = 0; i < (count); ++i) { \
        const double term = c->array[i] * (double)by.array[i]; \
        sum += term; \
        *size += fabs(term); \
    }
    COMBINE(state, n)
    COMBINE(input, code->input_count)
    COMBINE(parameter, code->parameter_count)
    COMBINE(port, code->port_count)
    return sum;
}

static void check_arguments(gic_gradient run)
{
    static MODEL other;
    run.checkpoints = 1;
    memory_of(&run, &by, 1);
    gic_gradient wrong = run;
    wrong.method = GIC_ROS2;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_ARGUMENT, "no implicit method");
    wrong = run;
    wrong.steps = 0;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_ARGUMENT, "no steps");
    wrong = run;
    wrong.checkpoints = 0;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_ARGUMENT, "no checkpoints");
    wrong.checkpoints = INT64_MAX;
    wrong.steps = INT64_MAX;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_ARGUMENT && wrong.needed > wrong.size, "more than any memory");
    other = start;
    other.head.locate = 1;
    wrong = run;
    wrong.start = &other;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_ARGUMENT, "no contacts that are located");
    other = start;
    other.state[n - 1] = (gic_real)NAN;
    expect(gic_run_adjoint(&wrong, &by) == GIC_ERROR_INPUT, "a state that is no number");
    free(run.memory);
    for (int64_t left = 2; left < 128; ++left)
        for (int64_t spare = 1; spare < 15; ++spare) {
            const int64_t ahead = gic_next_checkpoint(left, spare);
            expect(ahead + fewest((int)(left - ahead), (int)spare) + fewest((int)ahead, (int)spare + 1) ==
                       fewest((int)left, (int)spare + 1),
                   "the next checkpoint is the best");
        }
    for (int64_t left = 1000000, i = 0; i < 40; ++i, left = left / 2 + 2)
        expect(gic_next_checkpoint(left, 1 + i) >= 1 && gic_next_checkpoint(left, 1 + i) < left, "one of the steps");
}

int main(int argc, char **argv)
{
    int64_t steps = argc > 1 ? atoll(argv[1]) : 40;
    const double tolerance = argc > 3 ? atof(argv[3]) : 1e-13;
    static Change change;
    double worst = 0;
    set_up();
    gic_gradient run = {0};
    run.code = &OF(_derivatives);
    run.start = &start;
    run.step = (gic_real)(argc > 2 ? atof(argv[2]) : 0.001);
    run.steps = steps;
    run.weigh = weigh;
    run.follow = follow;
    run.user = &steps;
    for (int method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int looks = 0; looks < 2; ++looks) {
            run.method = method;
            run.looks = looks;
            const gic_real value = run_back(&run);
            for (int d = 0; d < DIRECTIONS; ++d) {
                gic_real slope = GIC_R(0.0);
                double size;
                choose(&change, d);
                memset(&along, 0, sizeof along);
                for (int32_t i = 0; i < n; ++i)
                    along.state[i] = (gic_real)change.state[i];
                for (int32_t i = 0; i < code->input_count; ++i)
                    along.input[i] = (gic_real)change.input[i];
                for (int32_t i = 0; i < code->parameter_count; ++i)
                    along.parameter[i] = (gic_real)change.parameter[i];
                for (int32_t i = 0; i < code->port_count; ++i)
                    along.port[i] = (gic_real)change.port[i];
                d_wave = change.wave;
                backwards = 0;
                memory_of(&run, &along, 0);
                expect(gic_run_tangent(&run, &along, &slope) == GIC_OK, "a tangent");
                expect(fabs((double)(run.value - value)) <= tolerance * (1 + fabs((double)value)), "the same scalar");
                check_end(&run);
                free(run.memory);
                const double other = combine(&change, &size), off = fabs(other - (double)slope) / size;
                worst = off > worst || !(off == off) ? off : worst;
                printf("%.17g %.17g\n", (double)slope, size);
            }
        }
    check_arguments(run);
    fprintf(stderr, "tangents and adjoints: %.1e\n", worst);
    expect(worst <= tolerance, "tangents are adjoints");
    return bad != 0;
}
#endif
