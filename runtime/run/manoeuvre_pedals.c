/* SPDX-License-Identifier: MIT
 * The gains of a driver who keeps a speed, from the linear model at the speed that is kept, one for each pedal. He
 * looks each `driver_period` and moves a pedal by a polynomial (models/SCENE.md section 5), so the map of small motions
 * from one look to the next is linear. Gain and integral: the largest integral with which the sensitivity of both loops
 * stays within a bound at all frequencies. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "run/manoeuvre.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

#include <math.h>
#include <string.h>

static const double robust = 1.7;                    /* largest sensitivity */
static const double lowest = 0.01;                   /* Hz, the lowest frequency at which it is looked at */
static const double least_gain = 0.05, factor = 400; /* 1/s; gains up to `factor` times that are tried */
static const double slightest = 0.01;                /* m/s^2 by a whole pedal: less does not move the vehicle */
static const double about = 0.02;                    /* pedal about which the model is taken at least: 0 is a kink */
static const double same = 1e-6; /* an eigenvalue that the driver moves by no more is not one of his */
enum { FREQUENCIES = 160, GAINS = 60, HALVINGS = 60, REFINED = 40, RETREATS = 8 };
enum { X = 0, Y = 1, YAW = 5 };
static const double pi = 3.141592653589793;

const PedalDriver pedal_driver_first = {.gain = 3, .integral = 1, .full = {3, 8}};

/* Small motions from look to look of the vehicle [n] and of a pedal and its derivatives [DRIVER_KEPT]. */
typedef struct PedalLoop {
    size_t size;                     /* n + DRIVER_KEPT */
    gsl_matrix *map;                 /* [size][size] */
    gsl_vector *by, *speed;          /* what the pedal that he wants adds; the weights of the speed along the road */
    double full;                     /* m/s^2 by a whole pedal, forwards positive */
    gsl_complex answer[FREQUENCIES]; /* speed by wanted acceleration, m/s by m/s^2 */
} PedalLoop;

/* Frequency k, rad from look to look: up to half of a turn. */
static double turn_of(int k)
{
    const double low = 2 * pi * lowest * driver_period;
    return low * pow(pi / low, (double)k / (FREQUENCIES - 1));
}

/* ---- the loop of a pedal ----------------------------------------------------------------------------------- */

/* The instance at the state in which the speed was kept, with the pedals given. Returns a status. */
static int take_state(const TestCar *car, Instance *self, double accelerator, double brake)
{
    const Engine *engine = car->sheet.found->engine;
    const gic_model *code = engine->code;
    memcpy(self, car->sheet.found->self, code->size);
    if (car->model->powertrain) {
        int32_t *discrete = (int32_t *)(void *)((char *)self + code->discrete_offset);
        discrete[code->free_base + POWERTRAIN_GEAR] = discrete[code->free_base + POWERTRAIN_BEFORE] =
            car->settling->gear;
    }
    double *input = tape_array(self, code->input_offset);
    input[car->accelerator] = accelerator;
    input[car->brake] = brake;
    return engine_enter(engine, &self->head, car->settling->state);
}

static void loop_close(PedalLoop *loop)
{
    gsl_matrix_free(loop->map);
    gsl_vector_free(loop->by);
    gsl_vector_free(loop->speed);
}

/* The map: the flow over a period, [n + DRIVER_MOVE], after what a look makes of a movement. */
static void set_map(PedalLoop *loop, const gsl_matrix *flow)
{
    const size_t n = loop->size - DRIVER_KEPT;
    double out[DRIVER_MOVE];
    gsl_matrix *look = gsl_matrix_calloc(n + DRIVER_MOVE, loop->size + 1);
    gsl_matrix *whole = gsl_matrix_alloc(loop->size, loop->size + 1);
    for (size_t i = 0; i < n; ++i)
        gsl_matrix_set(look, i, i, 1);
    for (size_t k = 0; k <= DRIVER_KEPT; ++k) {
        double now[DRIVER_KEPT + 1] = {0};
        now[k] = 1;
        driver_movement(now, now[DRIVER_KEPT], out);
        for (size_t i = 0; i < DRIVER_MOVE; ++i)
            gsl_matrix_set(look, n + i, n + k, out[i]);
    }
    const gsl_matrix_const_view kept = gsl_matrix_const_submatrix(flow, 0, 0, loop->size, n + DRIVER_MOVE);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, &kept.matrix, look, 0, whole);
    const gsl_matrix_view map = gsl_matrix_submatrix(whole, 0, 0, loop->size, loop->size);
    gsl_matrix_memcpy(loop->map, &map.matrix);
    gsl_matrix_get_col(loop->by, whole, loop->size);
    gsl_matrix_free(look);
    gsl_matrix_free(whole);
}

/* m/s^2 that a whole pedal makes from 0.5 to 1 s after it was first wanted. */
static double full_of(const PedalLoop *loop)
{
    const int looks = (int)round(1 / driver_period);
    gsl_vector *z = gsl_vector_calloc(loop->size), *next = gsl_vector_alloc(loop->size);
    double speed[2] = {0};
    for (int k = 1; k <= looks; ++k) {
        gsl_vector_memcpy(next, loop->by);
        gsl_blas_dgemv(CblasNoTrans, 1, loop->map, z, 1, next);
        gsl_vector_memcpy(z, next);
        if (k == looks / 2 || k == looks)
            gsl_blas_ddot(loop->speed, z, &speed[k == looks]);
    }
    gsl_vector_free(z);
    gsl_vector_free(next);
    return (speed[1] - speed[0]) / ((looks - looks / 2) * driver_period);
}

/* speed' (e^(i turn) - map)^-1 by. */
static gsl_complex answer_at(const PedalLoop *loop, double turn)
{
    const size_t n = loop->size;
    gsl_matrix_complex *M = gsl_matrix_complex_alloc(n, n);
    gsl_vector_complex *x = gsl_vector_complex_alloc(n);
    gsl_permutation *order = gsl_permutation_alloc(n);
    gsl_complex sum = gsl_complex_rect(0, 0);
    int sign;
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < n; ++j)
            gsl_matrix_complex_set(
                M, i, j,
                gsl_complex_rect((i == j ? cos(turn) : 0) - gsl_matrix_get(loop->map, i, j), i == j ? sin(turn) : 0));
        gsl_vector_complex_set(x, i, gsl_complex_rect(gsl_vector_get(loop->by, i), 0));
    }
    gsl_linalg_complex_LU_decomp(M, order, &sign);
    const bool solved = gsl_linalg_complex_LU_svx(M, order, x) == GSL_SUCCESS;
    for (size_t i = 0; i < n; ++i)
        sum = gsl_complex_add(sum, gsl_complex_mul_real(gsl_vector_complex_get(x, i), gsl_vector_get(loop->speed, i)));
    gsl_matrix_complex_free(M);
    gsl_vector_complex_free(x);
    gsl_permutation_free(order);
    return solved ? sum : gsl_complex_rect(NAN, NAN);
}

/* Of the pedal `input`, at the state with these pedals; false: there is no linear model, or the pedal does not move the
 * vehicle the way of `sign`. */
static bool loop_open(const TestCar *car, int input, double accelerator, double brake, double sign, PedalLoop *loop)
{
    const Linear *linear = car->sheet.found->linear;
    const gic_model *code = car->sheet.found->engine->code;
    const int all = linear->count;
    Pool *pool = car->pool;
    Instance *self = (Instance *)(void *)instance_new(pool, car->sheet.found->engine);
    double *f = pool_alloc(pool, (size_t)all * sizeof *f), *b = pool_alloc(pool, (size_t)all * sizeof *b);
    double *A = pool_alloc(pool, (size_t)all * (size_t)all * sizeof *A), turned[9];
    int *kept = pool_alloc(pool, (size_t)all * sizeof *kept);
    size_t n = 0;
    bool jump;
    *loop = (PedalLoop){0};
    int status = take_state(car, self, accelerator, brake);
    if (status == GIC_OK)
        status = linearize(linear, self, f, A);
    if (status == GIC_OK)
        status = linear_column(linear, self, LINEAR_INPUT, input, b, 0, NULL, &jump);
    if (status != GIC_OK || !gic_finite(A, all * all) || !gic_finite(b, all))
        return false;
    mat_from_euler(tape_array(self, code->state_offset) + 3, turned);
    const double level = hypot(turned[0], turned[3]);
    for (int i = 0; i < all; ++i)
        if (i != X && i != Y && i != YAW)
            kept[n++] = i;
    gsl_matrix *whole = gsl_matrix_calloc(n + DRIVER_MOVE, n + DRIVER_MOVE);
    gsl_matrix *flow = gsl_matrix_alloc(n + DRIVER_MOVE, n + DRIVER_MOVE);
    *loop = (PedalLoop){.size = n + DRIVER_KEPT,
                        .map = gsl_matrix_alloc(n + DRIVER_KEPT, n + DRIVER_KEPT),
                        .by = gsl_vector_alloc(n + DRIVER_KEPT),
                        .speed = gsl_vector_calloc(n + DRIVER_KEPT)};
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < n; ++j)
            gsl_matrix_set(whole, i, j, driver_period * A[kept[i] * all + kept[j]]);
        gsl_matrix_set(whole, i, n, driver_period * b[kept[i]]);
        for (int k = 0; k < 3; ++k) /* of the base's axes, in which velocities are, along the heading */
            if (kept[i] == linear->places + k)
                gsl_vector_set(loop->speed, i, (turned[0] * turned[k] + turned[3] * turned[3 + k]) / level);
    }
    for (size_t k = 0; k + 1 < DRIVER_MOVE; ++k)
        gsl_matrix_set(whole, n + k, n + k + 1, driver_period);
    gsl_linalg_exponential_ss(whole, flow, GSL_PREC_DOUBLE);
    set_map(loop, flow);
    gsl_matrix_free(whole);
    gsl_matrix_free(flow);
    loop->full = full_of(loop);
    if (!(sign * loop->full > slightest)) {
        loop_close(loop);
        return false;
    }
    for (int k = 0; k < FREQUENCIES; ++k)
        loop->answer[k] = gsl_complex_mul_real(answer_at(loop, turn_of(k)), 1 / loop->full);
    return true;
}

/* ---- gains ------------------------------------------------------------------------------------------------- */

/* The largest sensitivity |1 / (1 + P C)| of some loops. */
static double sensitivity(int loops, const PedalLoop *loop, double gain, double integral)
{
    double least = INFINITY;
    for (int k = 0; k < FREQUENCIES; ++k) {
        const double turn = turn_of(k);
        const gsl_complex on = gsl_complex_rect(cos(turn) - 1, sin(turn)); /* the sum grows after each look */
        const gsl_complex by =
            gsl_complex_add_real(gsl_complex_mul_real(gsl_complex_inverse(on), integral * driver_period), gain);
        for (int i = 0; i < loops; ++i) {
            const double back = gsl_complex_abs(gsl_complex_add_real(gsl_complex_mul(loop[i].answer[k], by), 1));
            if (isnan(back))
                return INFINITY;
            least = fmin(least, back);
        }
    }
    return 1 / least;
}

/* The largest integral with a gain; 0: there is none. */
static double integral_of(int loops, const PedalLoop *loop, double gain)
{
    double low = 0, high = gain * gain;
    if (!(sensitivity(loops, loop, gain, 0) <= robust))
        return 0;
    for (int k = 0; k < HALVINGS; ++k) {
        const double middle = (low + high) / 2;
        *(sensitivity(loops, loop, gain, middle) <= robust ? &low : &high) = middle;
    }
    return low;
}

static double tried(double k)
{
    return least_gain * pow(factor, k / (GAINS - 1));
}

/* The gain whose integral is the largest: of those tried, then by golden sections. False: there is none. */
static bool find_gains(int loops, const PedalLoop *loop, PedalDriver *driver)
{
    const double golden = (sqrt(5) - 1) / 2;
    double largest = 0;
    int best = 0;
    for (int k = 0; k < GAINS; ++k) {
        const double integral = integral_of(loops, loop, tried(k));
        if (integral > largest) {
            largest = integral;
            best = k;
        }
    }
    double low = fmax(best - 1, 0), high = fmin(best + 1, GAINS - 1);
    for (int k = 0; k < REFINED; ++k) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (integral_of(loops, loop, tried(a)) > integral_of(loops, loop, tried(b)))
            high = b;
        else
            low = a;
    }
    driver->gain = tried((low + high) / 2);
    driver->integral = integral_of(loops, loop, driver->gain);
    return largest > 0 && driver->integral > 0;
}

static bool eigenvalues_of(gsl_matrix *M, gsl_vector_complex *value)
{
    gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(M->size1);
    gsl_eigen_nonsymm_params(0, 1, work);
    const bool found = gsl_eigen_nonsymm(M, value, work) == GSL_SUCCESS;
    gsl_eigen_nonsymm_free(work);
    return found;
}

/* False: a motion grows that the driver moves, by a loop with these gains. */
static bool dies_out(const PedalLoop *loop, const PedalDriver *driver)
{
    const size_t n = loop->size;
    gsl_matrix *M[2] = {gsl_matrix_calloc(n + 1, n + 1), gsl_matrix_calloc(n + 1, n + 1)};
    gsl_vector_complex *value[2] = {gsl_vector_complex_alloc(n + 1), gsl_vector_complex_alloc(n + 1)};
    bool good = true;
    for (int k = 0; k < 2; ++k) { /* without him, and with him; the last number is his sum */
        for (size_t i = 0; i < n; ++i) {
            const double by = gsl_vector_get(loop->by, i) / loop->full;
            for (size_t j = 0; j < n; ++j)
                gsl_matrix_set(M[k], i, j,
                               gsl_matrix_get(loop->map, i, j) -
                                   k * by * driver->gain * gsl_vector_get(loop->speed, j));
            gsl_matrix_set(M[k], i, n, k * by);
            gsl_matrix_set(M[k], n, i, -k * driver->integral * driver_period * gsl_vector_get(loop->speed, i));
        }
        gsl_matrix_set(M[k], n, n, k);
        good = good && eigenvalues_of(M[k], value[k]);
    }
    for (size_t i = 0; i <= n && good; ++i) {
        const gsl_complex his = gsl_vector_complex_get(value[1], i);
        bool is_his = gsl_complex_abs(his) >= 1;
        for (size_t j = 0; j <= n && is_his; ++j)
            is_his = gsl_complex_abs(gsl_complex_sub(his, gsl_vector_complex_get(value[0], j))) >= same;
        good = !is_his;
    }
    for (int k = 0; k < 2; ++k) {
        gsl_matrix_free(M[k]);
        gsl_vector_complex_free(value[k]);
    }
    return good;
}

/* The driver at the speed that is kept; false: no gains are found. */
static bool find_driver(const TestCar *car, PedalDriver *driver)
{
    const double *last = car->settling->row[car->settling->rows - 1];
    PedalLoop loop[2];
    if (!loop_open(car, car->accelerator, fmax(last[TRIAL_ACCELERATOR], about), 0, 1, loop))
        return false;
    const int loops = loop_open(car, car->brake, 0, fmax(last[TRIAL_BRAKE], about), -1, loop + 1) ? 2 : 1;
    bool good = find_gains(loops, loop, driver), steady = false;
    for (int k = 0; k < RETREATS && good && !steady; ++k) {
        steady = true;
        for (int i = 0; i < loops; ++i)
            steady = steady && dies_out(&loop[i], driver);
        driver->gain *= steady ? 1 : 0.5;
        driver->integral *= steady ? 1 : 0.25;
    }
    driver->full[0] = loop[0].full;
    if (loops > 1)
        driver->full[1] = -loop[1].full;
    for (int i = 0; i < loops; ++i)
        loop_close(&loop[i]);
    return good && steady;
}

const char *car_pedals(TestCar *car, const char *target)
{
    if (car->settling && car->pedals.speed != car->settled) {
        gsl_errors_return();
        PedalDriver driver = pedal_driver_first;
        const bool found = find_driver(car, &driver);
        car->pedals = found ? driver : pedal_driver_first;
        car->pedals.found = found;
        car->pedals.speed = car->settled;
    }
    const PedalDriver *driver = &car->pedals;
    return pool_print(car->pool, "  speed: {target: %s, gain: %.6g, integral: %.6g, full: [%.6g, %.6g]}\n", target,
                      driver->gain, driver->integral, driver->full[0], driver->full[1]);
}

void manoeuvre_pedal_rows(Manoeuvre *m)
{
    const PedalDriver *driver = &m->car->pedals;
    if (!(driver->speed > 0))
        return;
    if (!driver->found) {
        sheet_note(m->result, pool_print(m->pool,
                                         "pedals: no gains are found at %.4g m/s, where the accelerator hardly moves "
                                         "the vehicle; gain %g 1/s, integral %g 1/s^2",
                                         driver->speed, driver->gain, driver->integral));
        return;
    }
    Sheet *s = m->result;
    sheet_add(s, "Driver, pedals", "pedals.speed", "Speed at which they were found", "m/s", driver->speed);
    sheet_add(s, NULL, "pedals.gain", "Acceleration by the error of the speed", "1/s", driver->gain);
    sheet_add(s, NULL, "pedals.integral", "And by its integral", "1/s^2", driver->integral);
    sheet_add(s, NULL, "pedals.accelerator", "Acceleration by the whole accelerator", "m/s^2", driver->full[0]);
    sheet_add(s, NULL, "pedals.brake", "Deceleration by the whole brake", "m/s^2", driver->full[1]);
}
