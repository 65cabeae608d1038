/* SPDX-License-Identifier: MIT
 * Eigenvalues of small motions, and the participation of each number. */
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "host/host.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

static const double pi = 3.141592653589793;

/* At critical damping rounding splits a double real eigenvalue into two real ones or a pair with imaginary parts of
 * about 1e-8 of it: pairs below this ratio count as two real ones. */
static const double critical = 1e-6;

/* ---- what is neutral ------------------------------------------------------------------------------------ */

/* A direction in which nothing happens makes a multiple eigenvalue 0, of a place and of its rate, that rounding would
 * scatter widely. Such directions are taken out, one layer after the other: with N the null vectors of A and Q the rest
 * of an orthonormal basis, [N Q]^T A [N Q] = [0 *; 0 Q^T A Q], and so on with Q^T A Q. */
typedef struct Deflation {
    gsl_matrix *A;     /* [rest][rest] */
    gsl_matrix *basis; /* [count][rest] */
    size_t rest;       /* 0: all directions are neutral */
    int layers;
} Deflation;

/* A becomes Q^T A Q and basis becomes basis Q, where Q is the first `rest` columns of V. */
static void project(Deflation *d, const gsl_matrix *V, size_t rest)
{
    const size_t n = V->size1, count = d->basis->size1;
    const gsl_matrix_const_view Q = gsl_matrix_const_submatrix(V, 0, 0, n, rest);
    gsl_matrix *AQ = gsl_matrix_alloc(n, rest), *A = gsl_matrix_alloc(rest, rest),
               *basis = gsl_matrix_alloc(count, rest);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, d->A, &Q.matrix, 0, AQ);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, &Q.matrix, AQ, 0, A);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, d->basis, &Q.matrix, 0, basis);
    gsl_matrix_free(AQ);
    gsl_matrix_free(d->A);
    gsl_matrix_free(d->basis);
    d->A = A;
    d->basis = basis;
    ++d->layers;
}

static Deflation deflate(const gsl_matrix *A)
{
    const double rank_limit = 1e-10; /* of singular values relative to the largest; rounding leaves about 1e-15 */
    const size_t count = A->size1;
    Deflation d = {gsl_matrix_alloc(count, count), gsl_matrix_alloc(count, count), count, 0};
    gsl_matrix_memcpy(d.A, A);
    gsl_matrix_set_identity(d.basis);
    double largest = 0;
    for (size_t rank = 0; d.rest > 0; rank = 0) {
        gsl_matrix *U = gsl_matrix_alloc(d.rest, d.rest), *V = gsl_matrix_alloc(d.rest, d.rest);
        gsl_vector *S = gsl_vector_alloc(d.rest);
        gsl_matrix_memcpy(U, d.A);
        gsl_linalg_SV_decomp_jacobi(U, V, S);
        largest = fmax(largest, gsl_vector_get(S, 0));
        while (rank < d.rest && gsl_vector_get(S, rank) > rank_limit * largest)
            ++rank;
        const bool deflated = rank < d.rest;
        if (deflated && rank > 0)
            project(&d, V, rank);
        if (deflated)
            d.rest = rank;
        gsl_vector_free(S);
        gsl_matrix_free(V);
        gsl_matrix_free(U);
        if (!deflated)
            break;
    }
    if (d.rest == 0)
        gsl_matrix_set_zero(d.basis);
    return d;
}

/* ---- eigenvalues ---------------------------------------------------------------------------------------- */

/* Eigenvalues and right eigenvectors of A, or of its transpose. */
typedef struct Spectrum {
    gsl_vector_complex *value;
    gsl_matrix_complex *vector; /* by columns */
} Spectrum;

/* False: they could not be found. */
static bool spectrum_find(const gsl_matrix *A, bool transposed, Spectrum *s)
{
    const size_t n = A->size1;
    *s = (Spectrum){gsl_vector_complex_alloc(n), gsl_matrix_complex_alloc(n, n)};
    gsl_matrix *copy = gsl_matrix_alloc(n, n);
    gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(n);
    gsl_eigen_nonsymmv_params(1, work);
    if (transposed)
        gsl_matrix_transpose_memcpy(copy, A);
    else
        gsl_matrix_memcpy(copy, A);
    const bool found = gsl_eigen_nonsymmv(copy, s->value, s->vector, work) == GSL_SUCCESS;
    gsl_eigen_nonsymmv_free(work);
    gsl_matrix_free(copy);
    return found;
}

static void spectrum_free(Spectrum *s)
{
    gsl_vector_complex_free(s->value);
    gsl_matrix_complex_free(s->vector);
}

/* Index of the eigenvalue nearest to `value`. */
static size_t spectrum_nearest(const Spectrum *s, gsl_complex value)
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < s->value->size; ++i) {
        const gsl_complex other = gsl_vector_complex_get(s->value, i);
        const double away = hypot(GSL_REAL(other) - GSL_REAL(value), GSL_IMAG(other) - GSL_IMAG(value));
        if (away < least) {
            least = away;
            best = i;
        }
    }
    return best;
}

/* Left eigenvectors by columns, in the order of the right ones: the rows of the inverse of their matrix, so that those
 * of equal eigenvalues, which are any of a subspace, belong to each other too. Where right ones are dependent but for
 * rounding, as of a critically damped motion, there is no inverse: those of the transposed matrix, by nearest values.
 * False: they could not be found. */
static bool left_find(const gsl_matrix *A, const Spectrum *right, gsl_matrix_complex *left)
{
    static const double dependent = 1e-10; /* the least pivot of unit vectors */
    const size_t n = A->size1;
    gsl_matrix_complex *lu = gsl_matrix_complex_alloc(n, n);
    gsl_permutation *order = gsl_permutation_alloc(n);
    int sign;
    double least = INFINITY;
    gsl_matrix_complex_memcpy(lu, right->vector);
    gsl_linalg_complex_LU_decomp(lu, order, &sign);
    for (size_t i = 0; i < n; ++i) {
        const gsl_complex pivot = gsl_matrix_complex_get(lu, i, i);
        least = fmin(least, hypot(GSL_REAL(pivot), GSL_IMAG(pivot)));
    }
    bool found;
    if (least > dependent) {
        found = gsl_linalg_complex_LU_invert(lu, order, left) == GSL_SUCCESS;
        gsl_matrix_complex_transpose(left);
    } else {
        Spectrum other;
        found = spectrum_find(A, true, &other);
        for (size_t k = 0; k < n; ++k) {
            const size_t near = spectrum_nearest(&other, gsl_vector_complex_get(right->value, k));
            for (size_t i = 0; i < n; ++i)
                gsl_matrix_complex_set(left, i, k, gsl_matrix_complex_get(other.vector, i, near));
        }
        spectrum_free(&other);
    }
    gsl_permutation_free(order);
    gsl_matrix_complex_free(lu);
    return found;
}

/* A vector of the deflated system in all numbers: real and imaginary parts [count]. */
static void expand(const Deflation *d, const gsl_matrix_complex *vectors, size_t k, gsl_vector *part[2])
{
    for (int p = 0; p < 2; ++p) {
        gsl_vector *small = gsl_vector_alloc(d->A->size1);
        for (size_t i = 0; i < small->size; ++i) {
            const gsl_complex z = gsl_matrix_complex_get(vectors, i, k);
            gsl_vector_set(small, i, p ? GSL_IMAG(z) : GSL_REAL(z));
        }
        gsl_blas_dgemv(CblasNoTrans, 1, d->basis, small, 0, part[p]);
        gsl_vector_free(small);
    }
}

/* Participation of every number in a mode: |left_i right_i|, which knows no units, summed over places and their rates,
 * relative to the sum. Left eigenvectors have no components along neutral directions; those of a right eigenvector
 * follow from A, one Jordan layer at a time. */
static void find_shares(const Linear *linear, const gsl_matrix *A, const Deflation *d, const Spectrum *right, size_t k,
                        const gsl_matrix_complex *left, Mode *mode)
{
    const size_t count = (size_t)linear->count, places = (size_t)linear->places;
    gsl_vector *r[2] = {gsl_vector_alloc(count), gsl_vector_alloc(count)}, *moved = gsl_vector_alloc(count);
    gsl_vector *l[2] = {gsl_vector_alloc(count), gsl_vector_alloc(count)};
    double sum = 0;
    expand(d, right->vector, k, r);
    expand(d, left, k, l);
    for (int layer = 0; layer < d->layers; ++layer)
        for (int p = 0; p < 2; ++p) {
            gsl_blas_dgemv(CblasNoTrans, 1, A, r[p], 0, moved);
            gsl_vector_memcpy(r[p], moved);
        }
    for (size_t i = 0; i < count; ++i) {
        const double part = hypot(gsl_vector_get(r[0], i), gsl_vector_get(r[1], i)) *
                            hypot(gsl_vector_get(l[0], i), gsl_vector_get(l[1], i));
        mode->share[i < places ? i : i - places] += part;
        sum += part;
    }
    for (size_t i = 0; i < count - places && sum > 0; ++i)
        mode->share[i] /= sum;
    for (int p = 0; p < 2; ++p) {
        for (size_t i = 0; i < places; ++i)
            mode->shape[(size_t)p * places + i] = gsl_vector_get(r[p], i);
        gsl_vector_free(r[p]);
        gsl_vector_free(l[p]);
    }
    gsl_vector_free(moved);
}

/* Slowest first. */
static int by_size(const void *a, const void *b)
{
    const Mode *x = a, *y = b;
    const double difference = hypot(x->real, x->imaginary) - hypot(y->real, y->imaginary);
    return (difference > 0) - (difference < 0);
}

/* Names of places that are mostly neutral, by the part that the remaining basis does not span. */
static const char *name_neutral(Pool *pool, const Linear *linear, const Deflation *d)
{
    Text names = {.pool = pool};
    for (int i = 0; i < linear->count; ++i) {
        const gsl_vector_const_view row = gsl_matrix_const_row(d->basis, (size_t)i);
        const bool is_rate = i >= linear->places && i < 2 * linear->places;
        if (!is_rate && gsl_blas_dnrm2(&row.vector) < 0.7)
            text_print(&names, "%s%s", names.size ? ", " : "", linear->name[i]);
    }
    return names.s;
}

/* One of each conjugate pair. False: they could not be found. */
static bool list_modes(Pool *pool, const Linear *linear, const gsl_matrix *A, const Deflation *d, Modes *modes)
{
    Spectrum right;
    gsl_matrix_complex *left = gsl_matrix_complex_alloc(d->A->size1, d->A->size1);
    const bool found = spectrum_find(d->A, false, &right) && left_find(d->A, &right, left);
    for (size_t k = 0; found && k < d->rest; ++k) {
        const gsl_complex value = gsl_vector_complex_get(right.value, k);
        const bool is_real = fabs(GSL_IMAG(value)) <= critical * fabs(GSL_REAL(value));
        if (GSL_IMAG(value) < 0 && !is_real)
            continue;
        Mode *mode = POOL_PUSH(pool, modes->mode, modes->count);
        *mode = (Mode){GSL_REAL(value), is_real ? 0 : GSL_IMAG(value), pool_alloc(pool, A->size1 * sizeof(double)),
                       pool_alloc(pool, 2 * A->size1 * sizeof(double))};
        find_shares(linear, A, d, &right, k, left, mode);
    }
    qsort(modes->mode, (size_t)modes->count, sizeof *modes->mode, by_size);
    gsl_matrix_complex_free(left);
    spectrum_free(&right);
    return found;
}

const Modes *modes_try(Pool *pool, const Linear *linear, const double *A)
{
    const size_t count = (size_t)linear->count;
    Modes *modes = pool_alloc(pool, sizeof *modes);
    gsl_errors_return();
    gsl_matrix *scaled = gsl_matrix_alloc(count, count);
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < count; ++j)
            gsl_matrix_set(scaled, i, j, A[i * count + j] * linear->reach[j] / linear->reach[i]);
    Deflation d = deflate(scaled);
    modes->zeros = (int)(count - d.rest);
    modes->neutral = name_neutral(pool, linear, &d);
    const bool found = !d.rest || list_modes(pool, linear, scaled, &d, modes);
    gsl_matrix_free(d.basis);
    gsl_matrix_free(d.A);
    gsl_matrix_free(scaled);
    return found ? modes : NULL;
}

const Modes *modes_find(Pool *pool, const Linear *linear, const double *A)
{
    const Modes *modes = modes_try(pool, linear, A);
    if (!modes)
        diag_fail(program_place(), NULL, "the eigenvalues could not be found");
    return modes;
}

/* ---- for people and programs ---------------------------------------------------------------------------- */

/* The name of number i of the shares. */
static const char *share_name(const Linear *linear, int i)
{
    return linear->name[i < linear->places ? i : i + linear->places];
}

void modes_print_shares(Text *out, const Linear *linear, const Mode *mode)
{
    const int count = linear->count - linear->places;
    bool named[count + 1];
    memset(named, 0, sizeof named);
    for (int n = 0; n < 3; ++n) {
        int most = -1;
        for (int i = 0; i < count; ++i)
            if (!named[i] && mode->share[i] >= 0.1 && (most < 0 || mode->share[i] > mode->share[most]))
                most = i;
        if (most < 0)
            break;
        named[most] = true;
        text_print(out, "%s%s %.0f %%", n ? ", " : "", share_name(linear, most), 100 * mode->share[most]);
    }
    text_print(out, "\n");
}

/* To four places, for people; no -0. */
static double shown(double value)
{
    return round(value * 1e4) / 1e4 + 0.0;
}

static void print_table(Text *out, const Linear *linear, const Modes *modes)
{
    text_print(out, "\n%22s  %14s  %7s  %13s  %s\n", "eigenvalue [1/s]", "frequency [Hz]", "damping", "time constant",
               "moves");
    for (int k = 0; k < modes->count; ++k) {
        const Mode *mode = &modes->mode[k];
        const double size = hypot(mode->real, mode->imaginary);
        if (mode->imaginary > 0)
            text_print(out, "%10.4f +- %7.4fi  %14.4f  %7.4f  ", shown(mode->real), mode->imaginary, size / (2 * pi),
                       shown(-mode->real / size));
        else
            text_print(out, "%10.4f %11s  %14s  %7s  ", mode->real, "", "", "");
        if (shown(mode->real) != 0)
            text_print(out, "%11.4g s  ", 1 / fabs(mode->real));
        else
            text_print(out, "%13s  ", "");
        modes_print_shares(out, linear, mode);
    }
    if (modes->zeros)
        text_print(out, "%22s  %d eigenvalues that are zero: neutral in %s\n", "0", modes->zeros,
                   modes->neutral ? modes->neutral : "nothing of its own");
    text_print(
        out,
        "\nfrequency: |eigenvalue| / 2 pi; damping: its share of the critical one; moves: participation, of places "
        "with "
        "their\nrates; x y z, roll pitch yaw: along and about the axes of the base\n");
}

/* Columns before the shares. */
static const gic_signal column[] = {
    {"real", "1/s"}, {"imaginary", "1/s"}, {"frequency", "Hz"}, {"damping", NULL}, {"time_constant", "s"}};

enum { SHARES = sizeof column / sizeof *column };

const char *modes_column(Pool *pool, const Linear *linear, int k, const char **unit)
{
    *unit = k < SHARES ? column[k].unit : NULL;
    const int step = k - SHARES - (linear->count - linear->places);
    if (step < 0)
        return k < SHARES ? column[k].name : pool_print(pool, "share.%s", share_name(linear, k - SHARES));
    *unit = "s";
    return mode_steps_column(step);
}

double modes_value(const Linear *linear, const Modes *modes, int mode, int k)
{
    const Mode zero = {0}, *m = mode < 0 ? &zero : &modes->mode[mode];
    const double size = hypot(m->real, m->imaginary);
    switch (k) {
    case 0: return m->real;
    case 1: return m->imaginary;
    case 2: return m->imaginary > 0 ? size / (2 * pi) : NAN;
    case 3: return m->imaginary > 0 ? -m->real / size : NAN;
    case 4: return m->real != 0 ? 1 / fabs(m->real) : NAN;
    default: break;
    }
    const int shares = linear->count - linear->places;
    if (!m->share)
        return NAN;
    return k - SHARES < shares ? m->share[k - SHARES] : mode_steps_value(m, k - SHARES - shares);
}

static void write_csv(Pool *pool, const Linear *linear, const Modes *modes, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    const char *unit, *name;
    int columns = 0;
    while ((name = modes_column(pool, linear, columns, &unit))) {
        csv_name(&csv, name, unit);
        ++columns;
    }
    csv_end_row(&csv);
    for (int mode = -modes->zeros; mode < modes->count; ++mode) {
        for (int k = 0; k < columns; ++k) {
            const double value = modes_value(linear, modes, mode, k);
            if (isnan(value))
                csv_text(&csv, NULL);
            else
                csv_number(&csv, value);
        }
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

/* True if rate number i is an acceleration. */
static bool is_acceleration(const Linear *linear, int i)
{
    const gic_model *code = &linear->engine->code;
    return i < 2 * linear->places || !strcmp(code->state[code->slow_count + i - 2 * linear->places].unit, "rad/s");
}

/* Print the three largest accelerations of a vehicle in motion. */
static void print_motion(Text *out, const Equilibrium *found)
{
    const Linear *linear = found->linear;
    double before = INFINITY;
    text_print(out,
               "%s: small motions about the places of the static equilibrium, in motion as the scene's initial state\n"
               "no steady state has to be there: the largest acceleration is",
               found->model->name);
    for (int n = 0; n < 3 && n < linear->count - linear->places; ++n) {
        int most = -1;
        for (int i = linear->places; i < linear->count; ++i)
            if (is_acceleration(linear, i) && fabs(found->f[i]) < before &&
                (most < 0 || fabs(found->f[i]) > fabs(found->f[most])))
                most = i;
        if (most < 0)
            break;
        before = fabs(found->f[most]);
        text_print(out, "%s %.3g%s of %s", n ? ", then" : "", found->f[most], n ? "" : " m/s^2 or rad/s^2",
                   linear->name[most]);
    }
    text_print(out, "\n");
}

void modes_warn_jumps(const Linear *linear, Place at)
{
    for (int j = 0; j < linear->count; ++j)
        if (linear->jumps[j]) {
            const bool rate = j >= linear->places && j < 2 * linear->places;
            diag_warn(at, "make the formula that jumps there continuous: tanh instead of a sign",
                      "an acceleration jumps where %s%s passes the value that it has there; small motions are the mean "
                      "of both sides",
                      rate ? "the rate of " : "", linear->name[j]);
            return;
        }
}

const Modes *modes_about(Pool *pool, const Scene *scene, bool quiet, const Equilibrium *found, bool *moves)
{
    const Linear *linear = found->linear;
    *moves = scene && equilibrium_set_in_motion(pool, scene, found);
    const int status = *moves ? linearize(linear, found->self, found->f, found->A) : GIC_OK;
    if (status != GIC_OK)
        diag_fail((Place){scene->source, 0, 0}, "check the velocities of `initial`",
                  "no small motions about the state in motion: %s",
                  instance_status(pool, found->engine->code, &found->self->head, status));
    const Modes *modes = modes_find(pool, linear, found->A);
    if (!quiet)
        modes_warn_jumps(linear, (Place){scene ? scene->source : found->model->source, 0, 0});
    return modes;
}

void modes_report(Pool *pool, const Scene *scene, const Request *request, const Equilibrium *found)
{
    const Linear *linear = found->linear;
    bool moves;
    const Modes *modes = modes_about(pool, scene, request->quiet, found, &moves);
    if (request->results && strcmp(request->results, "-")) {
        write_csv(pool, linear, modes, request->results);
    } else if (request->results) {
        write_csv(pool, linear, modes, "-");
        return;
    }
    Text table = {.pool = pool};
    if (moves)
        print_motion(&table, found);
    else
        text_print(&table, "%s: small motions about the static equilibrium\n", found->model->name);
    print_table(&table, linear, modes);
    modes_print_steps(&table, linear, modes, scene ? scene->ratio : 1);
    diag_text(table.s);
}
