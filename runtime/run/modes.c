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
#include <gsl/gsl_complex_math.h>
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

/* Eigenvalues and right eigenvectors of A. */
typedef struct Spectrum {
    gsl_vector_complex *value;
    gsl_matrix_complex *vector; /* by columns */
} Spectrum;

/* False: they could not be found. */
static bool spectrum_find(const gsl_matrix *A, Spectrum *s)
{
    const size_t n = A->size1;
    *s = (Spectrum){gsl_vector_complex_alloc(n), gsl_matrix_complex_alloc(n, n)};
    gsl_matrix *copy = gsl_matrix_alloc(n, n);
    gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(n);
    gsl_eigen_nonsymmv_params(1, work);
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

/* Left eigenvectors by columns, in the order of the right ones: the rows of the inverse of their matrix, so that those
 * of equal eigenvalues, which are any of a subspace, belong to each other too. NULL: there is no inverse, for right
 * ones are dependent but for rounding, as of a critically damped motion. */
static gsl_matrix_complex *left_find(const Spectrum *right)
{
    static const double dependent = 1e-6; /* the least pivot of unit vectors; rounding of double eigenvalues: 1e-8 */
    const size_t n = right->vector->size1;
    gsl_matrix_complex *lu = gsl_matrix_complex_alloc(n, n), *left = NULL;
    gsl_permutation *order = gsl_permutation_alloc(n);
    int sign;
    double least = INFINITY;
    gsl_matrix_complex_memcpy(lu, right->vector);
    gsl_linalg_complex_LU_decomp(lu, order, &sign);
    for (size_t i = 0; i < n; ++i)
        least = fmin(least, gsl_complex_abs(gsl_matrix_complex_get(lu, i, i)));
    if (least > dependent) {
        left = gsl_matrix_complex_alloc(n, n);
        gsl_linalg_complex_LU_invert(lu, order, left);
        gsl_matrix_complex_transpose(left);
    }
    gsl_permutation_free(order);
    gsl_matrix_complex_free(lu);
    return left;
}

/* X becomes an orthonormal basis of its columns, by Gram and Schmidt, twice. */
static void make_orthonormal(gsl_matrix_complex *X)
{
    for (size_t k = 0; k < X->size2; ++k) {
        gsl_vector_complex_view x = gsl_matrix_complex_column(X, k);
        for (size_t i = 0; i < 2 * k; ++i) {
            gsl_complex along;
            const gsl_vector_complex_view y = gsl_matrix_complex_column(X, i % k);
            gsl_blas_zdotc(&y.vector, &x.vector, &along);
            gsl_blas_zaxpy(gsl_complex_negative(along), &y.vector, &x.vector);
        }
        gsl_blas_zdscal(1 / gsl_blas_dznrm2(&x.vector), &x.vector);
    }
}

/* A basis, by columns, of what A (or its transpose) maps into itself with the `size` eigenvalues nearest to
 * `centre`: by inverse iteration about a number beside them. */
static gsl_matrix_complex *invariant_subspace(const gsl_matrix *A, bool transposed, gsl_complex centre, size_t size)
{
    enum { ITERATIONS = 40 }; /* the others shrink by 3 or more in each, but where they are as near */
    const double beside = 0.01;
    const size_t n = A->size1;
    const gsl_complex shift = gsl_complex_mul(centre, gsl_complex_rect(1 + beside, beside / 3));
    gsl_matrix_complex *lu = gsl_matrix_complex_alloc(n, n), *X = gsl_matrix_complex_alloc(n, size);
    gsl_permutation *order = gsl_permutation_alloc(n);
    int sign;
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j) {
            const gsl_complex a = gsl_complex_rect(transposed ? gsl_matrix_get(A, j, i) : gsl_matrix_get(A, i, j), 0);
            gsl_matrix_complex_set(lu, i, j, i == j ? gsl_complex_sub(a, shift) : a);
        }
    gsl_linalg_complex_LU_decomp(lu, order, &sign);
    for (size_t i = 0; i < n; ++i)
        for (size_t k = 0; k < size; ++k) /* any start that has something of each */
            gsl_matrix_complex_set(X, i, k,
                                   gsl_complex_rect(cos(1 + (double)(i * size + k)), sin(2 + (double)(i + k * n))));
    for (int iteration = 0; iteration < ITERATIONS; ++iteration) {
        make_orthonormal(X);
        for (size_t k = 0; k < size; ++k) {
            gsl_vector_complex_view x = gsl_matrix_complex_column(X, k);
            gsl_linalg_complex_LU_svx(lu, order, &x.vector);
        }
    }
    make_orthonormal(X);
    gsl_permutation_free(order);
    gsl_matrix_complex_free(lu);
    return X;
}

/* Bases, by columns, of what A maps into itself with eigenvalue k of the spectrum and all that are as good as equal to
 * it, and of the same of its transpose. */
static void group_find(const gsl_matrix *A, const Spectrum *spectrum, size_t k, gsl_matrix_complex *basis[2])
{
    const double as_good_as_equal = 1e-3; /* rounding scatters eigenvalues of multiplicity 5 by so much */
    const gsl_complex value = gsl_vector_complex_get(spectrum->value, k);
    size_t size = 0;
    gsl_complex sum = gsl_complex_rect(0, 0);
    for (size_t i = 0; i < spectrum->value->size; ++i) {
        const gsl_complex other = gsl_vector_complex_get(spectrum->value, i);
        if (gsl_complex_abs(gsl_complex_sub(other, value)) <= as_good_as_equal * gsl_complex_abs(value)) {
            ++size;
            sum = gsl_complex_add(sum, other);
        }
    }
    const gsl_complex centre = gsl_complex_div_real(sum, (double)size);
    basis[0] = invariant_subspace(A, false, centre, size);
    basis[1] = invariant_subspace(A, true, centre, size);
}

/* Vectors of the deflated system, by columns, in all numbers: [count][columns]. Those of the transposed matrix have no
 * components along neutral directions; those of the matrix follow from A, one Jordan layer at a time. */
static gsl_matrix_complex *expand(const gsl_matrix *A, const Deflation *d, const gsl_matrix_complex *vectors,
                                  bool transposed)
{
    gsl_matrix_complex *all = gsl_matrix_complex_alloc(A->size1, vectors->size2);
    gsl_vector *small = gsl_vector_alloc(vectors->size1), *x = gsl_vector_alloc(A->size1),
               *moved = gsl_vector_alloc(A->size1);
    for (size_t k = 0; k < vectors->size2; ++k)
        for (int p = 0; p < 2; ++p) {
            gsl_vector_complex_const_view from = gsl_matrix_complex_const_column(vectors, k);
            gsl_vector_complex_view to = gsl_matrix_complex_column(all, k);
            gsl_vector_const_view part =
                p ? gsl_vector_complex_const_imag(&from.vector) : gsl_vector_complex_const_real(&from.vector);
            gsl_vector_view into = p ? gsl_vector_complex_imag(&to.vector) : gsl_vector_complex_real(&to.vector);
            gsl_vector_memcpy(small, &part.vector);
            gsl_blas_dgemv(CblasNoTrans, 1, d->basis, small, 0, x);
            for (int layer = 0; layer < d->layers && !transposed; ++layer) {
                gsl_blas_dgemv(CblasNoTrans, 1, A, x, 0, moved);
                gsl_vector_memcpy(x, moved);
            }
            gsl_vector_memcpy(&into.vector, x);
        }
    gsl_vector_free(moved);
    gsl_vector_free(x);
    gsl_vector_free(small);
    return all;
}

/* Participation of every number in what right vectors R and left ones L span, columns each: the diagonal of the
 * projection R (L^T R)^-1 L^T, which knows no units and does not depend on the bases, summed over places and their
 * rates, relative to the sum. */
static void find_shares(const Linear *linear, const gsl_matrix_complex *R, const gsl_matrix_complex *L, Mode *mode)
{
    const size_t count = (size_t)linear->count, places = (size_t)linear->places, size = R->size2;
    const gsl_complex one = gsl_complex_rect(1, 0), none = gsl_complex_rect(0, 0);
    gsl_matrix_complex *lu = gsl_matrix_complex_alloc(size, size), *inverse = gsl_matrix_complex_alloc(size, size),
                       *left = gsl_matrix_complex_alloc(size, count);
    gsl_permutation *order = gsl_permutation_alloc(size);
    int sign;
    double sum = 0;
    gsl_blas_zgemm(CblasTrans, CblasNoTrans, one, L, R, none, lu);
    gsl_linalg_complex_LU_decomp(lu, order, &sign);
    gsl_linalg_complex_LU_invert(lu, order, inverse);
    gsl_blas_zgemm(CblasNoTrans, CblasTrans, one, inverse, L, none, left);
    for (size_t i = 0; i < count; ++i) {
        gsl_complex diagonal = none;
        for (size_t k = 0; k < size; ++k)
            diagonal = gsl_complex_add(
                diagonal, gsl_complex_mul(gsl_matrix_complex_get(R, i, k), gsl_matrix_complex_get(left, k, i)));
        mode->share[i < places ? i : i - places] += gsl_complex_abs(diagonal);
        sum += gsl_complex_abs(diagonal);
    }
    for (size_t i = 0; i < count - places && sum > 0; ++i)
        mode->share[i] /= sum;
    gsl_permutation_free(order);
    gsl_matrix_complex_free(left);
    gsl_matrix_complex_free(inverse);
    gsl_matrix_complex_free(lu);
}

static gsl_matrix_complex *column_of(const gsl_matrix_complex *vectors, size_t k)
{
    gsl_matrix_complex *column = gsl_matrix_complex_alloc(vectors->size1, 1);
    const gsl_matrix_complex_const_view view = gsl_matrix_complex_const_submatrix(vectors, 0, k, vectors->size1, 1);
    gsl_matrix_complex_memcpy(column, &view.matrix);
    return column;
}

/* Shares and shape of the mode of eigenvalue k; left: NULL where eigenvectors are dependent. */
static void describe(const Linear *linear, const gsl_matrix *A, const Deflation *d, const Spectrum *right,
                     const gsl_matrix_complex *left, size_t k, Mode *mode)
{
    const size_t places = (size_t)linear->places;
    gsl_matrix_complex *vector = column_of(right->vector, k), *shape = expand(A, d, vector, false);
    gsl_matrix_complex *group[2] = {vector};
    if (left)
        group[1] = column_of(left, k);
    else
        group_find(d->A, right, k, group);
    gsl_matrix_complex *R = expand(A, d, group[0], false), *L = expand(A, d, group[1], true);
    find_shares(linear, R, L, mode);
    for (size_t i = 0; i < places; ++i) {
        mode->shape[i] = GSL_REAL(gsl_matrix_complex_get(shape, i, 0));
        mode->shape[places + i] = GSL_IMAG(gsl_matrix_complex_get(shape, i, 0));
    }
    double largest[2] = {0};
    for (size_t i = 0; i < shape->size1; ++i) {
        const double size = gsl_complex_abs(gsl_matrix_complex_get(shape, i, 0)) / linear->reach[i];
        largest[0] = fmax(largest[0], size);
        largest[1] = i < places ? fmax(largest[1], size) : largest[1];
    }
    mode->moves = largest[0] > 0 ? largest[1] / largest[0] : 0;
    gsl_matrix_complex_free(L);
    gsl_matrix_complex_free(R);
    gsl_matrix_complex_free(group[1]);
    if (group[0] != vector)
        gsl_matrix_complex_free(group[0]);
    gsl_matrix_complex_free(shape);
    gsl_matrix_complex_free(vector);
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
    const bool found = spectrum_find(d->A, &right);
    gsl_matrix_complex *left = found ? left_find(&right) : NULL;
    for (size_t k = 0; found && k < d->rest; ++k) {
        const gsl_complex value = gsl_vector_complex_get(right.value, k);
        const bool is_real = fabs(GSL_IMAG(value)) <= critical * fabs(GSL_REAL(value));
        if (GSL_IMAG(value) < 0 && !is_real)
            continue;
        Mode *mode = POOL_PUSH(pool, modes->mode, modes->count);
        *mode = (Mode){GSL_REAL(value), is_real ? 0 : GSL_IMAG(value), pool_alloc(pool, A->size1 * sizeof(double)),
                       pool_alloc(pool, 2 * A->size1 * sizeof(double)), 0};
        describe(linear, A, d, &right, left, k, mode);
    }
    qsort(modes->mode, (size_t)modes->count, sizeof *modes->mode, by_size);
    if (left)
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
    modes_print_steps(&table, linear, modes, scene);
    diag_text(table.s);
}
