/* SPDX-License-Identifier: MIT
 * The states that implicit steps need to treat implicitly. Small motions dz/dt = A z about some states of the model
 * have eigenvalues lambda. A motion is stiff where the explicit part of imex would not do for it: the second-order
 * backward formula with extrapolated rates,
 *
 *     r^2 - 4/3 (1 + z) r + (1 + 2 z) / 3 = 0,   z = lambda step.
 *
 * It is stable down to z = -4/3 on the real axis, where r = -1. On the imaginary axis it grows by 3/4 |z|^4 in a step,
 * so that a vibration needs damping, of |z| = 1/2 a tenth of the critical one. Eigenvalues log r / step are off by 0.18
 * to 0.34 of |lambda| there, wherefore motions from there on count as stiff (tests/bench/tried.md has errors of runs).
 *
 * States that have a share in stiff motions are implicit. That this is enough for stability is then checked by the
 * eigenvalues of two steps of imex in matrices, with A where it is exact and with what is left of A in the implicit
 * part; where they grow, the states that move most in what grows are implicit, too. So it is where a slow motion is
 * wrong: a heavy body on a stiff spring has next to no share in what the light one does at its other end, but the whole
 * of what the spring does in a step is wrong for it. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "run/engines.h"
#include "run/linearize.h"
#include "run/stiff_states.h"
#include "tape/engine_tape.h"
#include "vehicle/columns.h"

#include <complex.h>
#include <math.h>
#include <string.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

static const double resolved = 0.5;  /* |z| up to which a motion may be explicit */
static const double least = 0.05;    /* share in stiff motions from which a state is implicit */
static const double alike = 0.01;    /* relative: numbers as near are on one side of a limit, so that rounding does not
                                      * tell left from right */
static const double harmless = 1e-6; /* growth in a step that a motion without damping may have */
static const double motionless = 1e-3; /* |r - 1| of motions too slow to matter, among them neutral ones, whose double
                                        * eigenvalue 1 rounding scatters */
static const double accurate = 0.002;  /* relative error of the eigenvalue of a slow motion that steps may make, */
static const double as_explicit = 4;   /* or so many times that of explicit steps */
static const double slowest = 1e-4;    /* |z| of a motion that is looked at for that: others hardly move in a run */
static const double part = 2 / 3.0;    /* of a step, the reach of imex */

/* A state about which the model moves. */
typedef struct Point {
    double *A, *M; /* [count][count] in small motions; M: masses of rates, 1 of all other numbers */
    const Modes *modes;
    struct Point *next;
} Point;

typedef struct Splitter {
    Pool *pool;
    const Model *model;
    const Engine *engine;
    const Linear *linear; /* of this engine */
    Solve solve;
    double step;
    int groups;
    int *group;    /* [count] of a small motion: numbers of a group are implicit together */
    double *share; /* [groups] in stiff motions, largest over the points */
    bool *chosen;  /* [groups] */
    bool weighed;
    Point *points;
    Mode slowest, fastest; /* of the stiff motions */
    Mode left;             /* the fastest of the others */
    int stiff, others;     /* how many there are */
} Splitter;

/* ---- motions ---------------------------------------------------------------------------------------------- */

/* The root of r^2 - p r + q = 0 that is nearer to another number. */
static double complex nearer_root(double complex p, double complex q, double complex to)
{
    const double complex s = csqrt(p * p / 4 - q), a = p / 2 + s, b = p / 2 - s;
    return cabs(a - to) < cabs(b - to) ? a : b;
}

/* The larger root of r^2 - p r + q = 0. */
static double larger_root(double complex p, double complex q)
{
    const double complex s = csqrt(p * p / 4 - q);
    return fmax(cabs(p / 2 + s), cabs(p / 2 - s));
}

/* By how much a motion is multiplied in a step: all of it explicit, or implicit. */
static double explicit_factor(double complex z)
{
    return larger_root(4 / 3.0 * (1 + z), (1 + 2 * z) / 3);
}

static double implicit_factor(double complex z)
{
    return larger_root(4 / (3 - 2 * z), 1 / (3 - 2 * z));
}

static bool is_stiff(const Splitter *s, const Mode *mode)
{
    const double complex z = s->step * (mode->real + mode->imaginary * I);
    return cabs(z) > resolved || (mode->real <= 0 && explicit_factor(z) > 1 + harmless);
}

static bool near(const Mode *a, const Mode *b)
{
    return hypot(a->real - b->real, a->imaginary - b->imaginary) <= alike * hypot(b->real, b->imaginary);
}

static double size_of(const Mode *mode)
{
    return hypot(mode->real, mode->imaginary);
}

/* Shares of groups in a motion: the larger one of participation, which tells by how much a state makes the motion what
 * it is, and, of places, of kinetic energy, which tells by how much the motion moves it: what is explicit is thrown
 * about by forces that are not resolved. */
static void find_shares(const Splitter *s, const Point *point, const Mode *mode, double *share)
{
    const int places = s->linear->places, count = s->linear->count;
    double energy[s->groups + 1], all = 0, of_places = 0;
    memset(energy, 0, sizeof energy);
    memset(share, 0, (size_t)s->groups * sizeof *share);
    for (int i = 0; i < count - places; ++i)
        share[s->group[i < places ? i : i + places]] += mode->share[i];
    for (int i = 0; i < places; ++i) {
        of_places += mode->share[i];
        for (int j = 0; j < places; ++j)
            if (s->group[j] == s->group[i])
                energy[s->group[i]] +=
                    point->M[count * (places + i) + places + j] * s->linear->reach[i] * s->linear->reach[j] *
                    (mode->shape[i] * mode->shape[j] + mode->shape[places + i] * mode->shape[places + j]);
    }
    for (int g = 0; g < s->groups; ++g)
        all += energy[g];
    for (int g = 0; g < s->groups && all > 0; ++g)
        share[g] = fmax(share[g], of_places * energy[g] / all);
}

/* Add up the shares in the stiff motions of a point. */
static void count_shares(Splitter *s, const Point *point)
{
    double share[s->groups + 1], sum[s->groups + 1];
    memset(sum, 0, sizeof sum);
    for (int k = 0; k < point->modes->count; ++k) {
        const Mode *mode = &point->modes->mode[k];
        bool stiff = is_stiff(s, mode);
        for (int j = 0; j < point->modes->count && !stiff; ++j)
            stiff = is_stiff(s, &point->modes->mode[j]) && near(mode, &point->modes->mode[j]);
        if (stiff)
            find_shares(s, point, mode, share);
        for (int g = 0; g < s->groups && stiff; ++g)
            sum[g] += share[g];
        if (!stiff && (!s->others++ || size_of(mode) > size_of(&s->left)))
            s->left = *mode;
        if (stiff && (!s->stiff || size_of(mode) < size_of(&s->slowest)))
            s->slowest = *mode;
        if (stiff && (!s->stiff++ || size_of(mode) > size_of(&s->fastest)))
            s->fastest = *mode;
    }
    for (int g = 0; g < s->groups; ++g)
        s->share[g] = fmax(s->share[g], sum[g]);
}

/* Choose groups by a measure: those at `limit` or above, and those as good as there. */
static void choose(Splitter *s, const double *measure, double limit)
{
    double lowest = INFINITY;
    for (int g = 0; g < s->groups; ++g)
        if (measure[g] >= limit)
            lowest = fmin(lowest, measure[g]);
    for (int g = 0; g < s->groups; ++g)
        s->chosen[g] = s->chosen[g] || measure[g] >= (1 - alike) * lowest;
}

/* ---- steps ------------------------------------------------------------------------------------------------ */

static double *square(const Splitter *s)
{
    const size_t count = (size_t)s->linear->count;
    return pool_alloc(s->pool, (count * count + 1) * sizeof(double));
}

/* What implicit steps have of A: the solution of M_SS X = (M A)_SS for the numbers S that are chosen, A_SS where rows
 * are not weighed; all other entries are 0. */
static void find_implicit(const Splitter *s, const Point *point, gsl_matrix *kept)
{
    const int count = s->linear->count;
    int own[count + 1], n = 0;
    gsl_matrix_set_zero(kept);
    for (int i = 0; i < count; ++i)
        if (s->chosen[s->group[i]])
            own[n++] = i;
    if (!n)
        return;
    gsl_matrix *lu = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_vector *x = gsl_vector_alloc((size_t)n);
    gsl_permutation *order = gsl_permutation_alloc((size_t)n);
    int sign;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            gsl_matrix_set(lu, (size_t)i, (size_t)j, s->weighed ? point->M[own[i] * count + own[j]] : i == j);
    gsl_linalg_LU_decomp(lu, order, &sign);
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            double sum = s->weighed ? 0 : point->A[own[i] * count + own[j]];
            for (int k = 0; k < count && s->weighed; ++k)
                sum += point->M[own[i] * count + k] * point->A[k * count + own[j]];
            gsl_vector_set(x, (size_t)i, sum);
        }
        gsl_linalg_LU_svx(lu, order, x);
        for (int i = 0; i < n; ++i)
            gsl_matrix_set(kept, (size_t)own[i], (size_t)own[j], gsl_vector_get(x, (size_t)i));
    }
    gsl_permutation_free(order);
    gsl_vector_free(x);
    gsl_matrix_free(lu);
}

/* Two steps of imex: (y1, y0) becomes (y2, y1) by G [2 count][2 count], numbers in units of linear->reach. */
static gsl_matrix *steps_matrix(const Splitter *s, const Point *point)
{
    const size_t count = (size_t)s->linear->count;
    const double reach = part * s->step, *unit = s->linear->reach;
    gsl_matrix *G = gsl_matrix_calloc(2 * count, 2 * count), *lu = gsl_matrix_alloc(count, count);
    gsl_vector *d = gsl_vector_alloc(count);
    gsl_permutation *order = gsl_permutation_alloc(count);
    int sign;
    find_implicit(s, point, lu);
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < count; ++j)
            gsl_matrix_set(lu, i, j, (i == j) - reach * gsl_matrix_get(lu, i, j) * unit[j] / unit[i]);
    gsl_linalg_LU_decomp(lu, order, &sign);
    for (size_t j = 0; j < 2 * count; ++j) {
        const size_t column = j % count;
        const double rates = j < count ? 2 : -1, change = j < count ? -part : part;
        for (size_t i = 0; i < count; ++i)
            gsl_vector_set(
                d, i, (i == column) * change + reach * rates * point->A[i * count + column] * unit[column] / unit[i]);
        gsl_linalg_LU_svx(lu, order, d);
        for (size_t i = 0; i < count; ++i)
            gsl_matrix_set(G, i, j, gsl_vector_get(d, i) + (i == column) * (j < count ? 2 : -1));
        if (j < count)
            gsl_matrix_set(G, count + j, j, 1);
    }
    gsl_permutation_free(order);
    gsl_vector_free(d);
    gsl_matrix_free(lu);
    return G;
}

/* Factors r of motions in a step, and where `vector` is not NULL their eigenvectors. False: they could not be found. */
static bool find_factors(const Splitter *s, const Point *point, gsl_vector_complex *value, gsl_matrix_complex *vector)
{
    gsl_matrix *G = steps_matrix(s, point);
    bool found;
    if (vector) {
        gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(G->size1);
        gsl_eigen_nonsymmv_params(1, work);
        found = gsl_eigen_nonsymmv(G, value, vector, work) == GSL_SUCCESS;
        gsl_eigen_nonsymmv_free(work);
    } else {
        gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(G->size1);
        gsl_eigen_nonsymm_params(0, 1, work);
        found = gsl_eigen_nonsymm(G, value, work) == GSL_SUCCESS;
        gsl_eigen_nonsymm_free(work);
    }
    gsl_matrix_free(G);
    return found;
}

/* |r| - 1 of factor k; -1 of a motion that is too slow to matter. */
static double growth_of(const gsl_vector_complex *value, size_t k)
{
    const gsl_complex r = gsl_vector_complex_get(value, k);
    return gsl_complex_abs(gsl_complex_sub_real(r, 1)) <= motionless ? -1 : gsl_complex_abs(r) - 1;
}

static size_t most_grown(const gsl_vector_complex *value)
{
    size_t worst = 0;
    for (size_t k = 1; k < value->size; ++k)
        worst = growth_of(value, k) > growth_of(value, worst) ? k : worst;
    return worst;
}

/* Add to the choice what moves most in eigenvector k; all, where that is nothing new. */
static void add_movers(Splitter *s, const gsl_matrix_complex *vectors, size_t k)
{
    double moved[s->groups + 1], most = 0, all = 0;
    memset(moved, 0, sizeof moved);
    for (int i = 0; i < s->linear->count; ++i) {
        const double size = gsl_complex_abs(gsl_matrix_complex_get(vectors, (size_t)i, k));
        double *group = &moved[s->group[i]];
        all = fmax(all, size);
        *group = fmax(*group, s->chosen[s->group[i]] ? 0 : size);
    }
    for (int g = 0; g < s->groups; ++g)
        most = fmax(most, moved[g]);
    choose(s, moved, most > motionless * all ? most : 0);
}

/* The factor that is nearest to r. */
static size_t nearest(const gsl_vector_complex *value, double complex r)
{
    size_t best = 0;
    double least_distance = INFINITY;
    for (size_t k = 0; k < value->size; ++k) {
        const gsl_complex own = gsl_vector_complex_get(value, k);
        const double distance = cabs(GSL_REAL(own) + GSL_IMAG(own) * I - r);
        if (distance < least_distance) {
            least_distance = distance;
            best = k;
        }
    }
    return best;
}

/* exp z of the slow motion of which steps miss more than they may, and most; 0: there is none. */
static double complex wrong_motion(const Splitter *s, const Point *point, const gsl_vector_complex *value)
{
    double complex wrong = 0;
    double most = 1;
    for (int k = 0; k < point->modes->count; ++k) {
        const Mode *mode = &point->modes->mode[k];
        const double complex z = s->step * (mode->real + mode->imaginary * I), right = cexp(z);
        if (cabs(z) > resolved || cabs(z) < slowest)
            continue;
        const gsl_complex own = gsl_vector_complex_get(value, nearest(value, right));
        const double complex alone = nearer_root(4 / 3.0 * (1 + z), (1 + 2 * z) / 3, right);
        const double off = cabs(clog(GSL_REAL(own) + GSL_IMAG(own) * I) - z);
        const double allowed = fmax(accurate * cabs(z), as_explicit * cabs(clog(alone) - z));
        if (off > most * allowed) {
            most = off / allowed;
            wrong = right;
        }
    }
    return wrong;
}

/* Add what moves most in the motion that grows most, or with the factor nearest to r, where r is not 0; all, where that
 * can't be told. */
static void grow(Splitter *s, const Point *point, double complex r)
{
    const size_t size = 2 * (size_t)s->linear->count;
    gsl_vector_complex *value = gsl_vector_complex_alloc(size);
    gsl_matrix_complex *vector = gsl_matrix_complex_alloc(size, size);
    if (find_factors(s, point, value, vector))
        add_movers(s, vector, r == 0 ? most_grown(value) : nearest(value, r));
    else
        memset(s->chosen, true, (size_t)s->groups);
    gsl_matrix_complex_free(vector);
    gsl_vector_complex_free(value);
}

/* True if steps with the choice are as stable about this point as with all numbers implicit, and slow motions right;
 * else the choice grows. */
static bool will_do(Splitter *s, const Point *point)
{
    double most = harmless;
    int outside = 0;
    for (int k = 0; k < point->modes->count; ++k) {
        const Mode *mode = &point->modes->mode[k];
        const double growth = implicit_factor(s->step * (mode->real + mode->imaginary * I)) - 1;
        outside += growth > harmless ? 1 + (mode->imaginary > 0) : 0;
        most = fmax(most, 1.1 * growth); /* of a slow motion that grows by itself, which each way has a little else */
    }
    gsl_vector_complex *value = gsl_vector_complex_alloc(2 * (size_t)s->linear->count);
    const bool found = find_factors(s, point, value, NULL);
    const size_t worst = found ? most_grown(value) : 0;
    for (size_t k = 0; k < value->size && found; ++k)
        outside -= growth_of(value, k) > harmless;
    const bool stable = found && growth_of(value, worst) <= most && outside >= 0;
    const double complex wrong = stable ? wrong_motion(s, point, value) : 0;
    gsl_vector_complex_free(value);
    if (!stable || wrong != 0)
        grow(s, point, wrong);
    return stable && wrong == 0;
}

static bool all_chosen(const Splitter *s)
{
    bool all = true;
    for (int g = 0; g < s->groups; ++g)
        all = all && s->chosen[g];
    return all;
}

/* ---- states about which the model moves ------------------------------------------------------------------- */

/* The mass matrix in the order of small motions' rates, 1 for other numbers. A status. */
static int find_masses(const Linear *linear, Instance *self, double *M)
{
    const TapeEngine *engine = linear->engine;
    const Plan *plan = engine->formulation->plan;
    const int count = linear->count, n = plan->unknowns, base = engine->code.free_base ? 6 : 0;
    double e[4], acc[n + 1], tau[2][n + 1];
    int number[n + 1]; /* of the unknown's rate among small motions */
    memset(M, 0, (size_t)(count * count) * sizeof *M);
    for (int i = 0; i < count; ++i)
        M[count * i + i] = 1;
    for (int i = 0; i < n; ++i)
        number[i] = linear->places + (i + 3) % 6; /* the tape's order is rotation, displacement */
    for (int w = 0, place = base; w < plan->model->coordinates; ++w)
        if (!plan->model->coordinate[w].driven)
            number[plan->coordinate_unknown[w]] = linear->places + place++;
    const double *y = tape_array(self, engine->code.state_offset);
    int status = tape_refresh(self, e);
    memset(acc, 0, sizeof acc);
    if (status == GIC_OK)
        status = tape_whole(self, engine->inverse, 0, y, e, NULL, acc, tau[0]);
    for (int j = 0; j < n && status == GIC_OK; ++j) {
        acc[j] = 1;
        status = tape_whole(self, engine->inverse, 0, y, e, NULL, acc, tau[1]);
        acc[j] = 0;
        for (int i = 0; i < n; ++i)
            M[count * number[i] + number[j]] = tau[1][i] - tau[0][i];
    }
    return status;
}

/* Take the motions about the present state of an instance of `linear` into account. Where there are
 * no derivatives it is passed over. */
static void add_point(Splitter *s, const Linear *linear, Instance *self)
{
    Point *point = pool_alloc(s->pool, sizeof *point);
    double f[linear->count + 1];
    point->A = square(s);
    point->M = square(s);
    if (linearize(linear, self, f, point->A) != GIC_OK || find_masses(linear, self, point->M) != GIC_OK)
        return;
    point->modes = modes_try(s->pool, linear, point->A);
    if (!point->modes)
        return;
    point->next = s->points;
    s->points = point;
}

/* The static equilibrium, where there is one. */
static void add_equilibrium(void *context)
{
    Splitter *s = context;
    Pool *pool = pool_new();
    const Equilibrium *found = equilibrium_find(pool, s->model, NULL, s->solve);
    add_point(s, found->linear, found->self);
    pool_free(pool);
}

/* z [places]: how the places of a point give way to forces along the gradient of a contact. A little of the masses is
 * added to stiffness, for there are directions without any. */
static void give_way(const Splitter *s, const Point *point, const double *gradient, double *z)
{
    static const double softest = 1; /* 1/s^2 */
    const int places = s->linear->places, count = s->linear->count;
    const size_t n = (size_t)places;
    gsl_matrix *stiffness = gsl_matrix_alloc(n, n);
    gsl_vector_view x = gsl_vector_view_array(z, n);
    gsl_permutation *order = gsl_permutation_alloc(n);
    int sign;
    for (int i = 0; i < places; ++i)
        for (int j = 0; j < places; ++j) {
            const double *row = point->M + count * (places + i);
            double sum = softest * row[places + j];
            for (int k = places; k < 2 * places; ++k)
                sum -= row[k] * point->A[count * k + j];
            gsl_matrix_set(stiffness, (size_t)i, (size_t)j, sum);
        }
    memcpy(z, gradient, n * sizeof *z);
    gsl_linalg_LU_decomp(stiffness, order, &sign);
    gsl_linalg_LU_svx(stiffness, order, &x.vector);
    gsl_permutation_free(order);
    gsl_matrix_free(stiffness);
}

/* Push an instance, which is at the point, until contact k has a load, by a little more than `depth`. False: it can't
 * be pushed so far. */
static bool touch(const Splitter *s, const Point *point, Instance *self, int k, double depth)
{
    enum { MOVES = 8 };
    const Linear *linear = s->linear;
    const gic_model *code = &linear->engine->code;
    double f[linear->count + 1], press[code->contact_count + 1], z[linear->count + 1], gradient[linear->places + 1];
    for (int move = 0; move < MOVES && linear_start(linear, self, f) == GIC_OK; ++move) {
        double change = 0;
        if (code->contacts->press(self, 0, tape_array(self, code->state_offset), press) != GIC_OK)
            return false;
        if (press[k] > 0)
            return true;
        for (int j = 0; j < linear->places; ++j) {
            linear_direction(linear, self, LINEAR_MOTION, j);
            if (linear_slope(linear, self, LINEAR_PRESS, 0) != GIC_OK)
                return false;
            gradient[j] = linear->drate[code->slow_count + code->fast_count + k];
        }
        memset(z, 0, sizeof z);
        give_way(s, point, gradient, z);
        for (int j = 0; j < linear->places; ++j)
            change += gradient[j] * z[j];
        for (int j = 0; j < linear->places; ++j)
            z[j] *= change > 0 ? (depth - press[k]) / change : 0;
        linear_move(linear, self, z);
    }
    return false;
}

/* States in which stops press that don't as the model is set up, one after the other; and the static equilibrium where
 * wheels hang in the air then, for nothing is known of their tires without a load. */
static void add_contacts(Splitter *s, const Instance *drawn)
{
    static const double beyond = 1e-6; /* m or rad */
    const gic_model *code = &s->linear->engine->code;
    Instance *self = (Instance *)(void *)instance_new(s->pool, s->engine);
    double press[code->contact_count + 1];
    bool hangs = false;
    memcpy(self, drawn, code->size);
    if (!code->contacts || code->contacts->press(self, 0, tape_array(self, code->state_offset), press) != GIC_OK)
        return;
    ContactSite site;
    const Point *point = s->points; /* the one at set-up */
    for (int k = 0; k < code->contact_count && model_contact(s->model, k, &site); ++k) {
        if (press[k] > 0)
            continue;
        hangs = hangs || site.wheel;
        memcpy(self, drawn, code->size);
        if (site.stop &&
            touch(s, point, self, k, beyond + (site.stop->fade ? law_number(site.stop->fade, s->model) : 0)))
            add_point(s, s->linear, self);
    }
    Messages unheard = {0};
    if (hangs)
        (void)caught(&unheard, add_equilibrium, s);
    messages_clear(&unheard);
}

/* ---- groups ----------------------------------------------------------------------------------------------- */

/* The base's places and its angles each with their rates: a vehicle that turns exchanges x and y. A coordinate with its
 * rate, a fast state alone. */
static void find_groups(Splitter *s)
{
    const Linear *linear = s->linear;
    const int base = linear->engine->code.free_base ? 6 : 0;
    s->group = pool_alloc(s->pool, ((size_t)linear->count + 1) * sizeof *s->group);
    for (int i = 0; i < linear->places; ++i) {
        s->group[i] = i < base ? i / 3 : s->groups;
        s->group[linear->places + i] = s->group[i];
        s->groups = s->group[i] + 1;
    }
    for (int i = 2 * linear->places; i < linear->count; ++i)
        s->group[i] = s->groups++;
    s->share = pool_alloc(s->pool, ((size_t)s->groups + 1) * sizeof *s->share);
    s->chosen = pool_alloc(s->pool, (size_t)s->groups + 1);
}

/* In the state, whose Euler parameters are four. */
static bool *in_state(const Splitter *s)
{
    const gic_model *code = &s->linear->engine->code;
    const int extra = code->free_base, base = extra ? 6 : 0;
    bool *implicit = pool_alloc(s->pool, (size_t)(code->slow_count + code->fast_count) + 1);
    for (int i = 0; i < s->linear->count; ++i)
        implicit[i < base ? i : i + extra] = s->chosen[s->group[i]];
    if (extra)
        implicit[base] = s->chosen[1];
    return implicit;
}

/* ---- for people ------------------------------------------------------------------------------------------- */

static void tell_mode(Text *out, const Splitter *s, const char *what, const Mode *mode)
{
    text_print(out, "%s %.4g", what, mode->real + 0.0);
    if (mode->imaginary > 0)
        text_print(out, " +- %.4gi", mode->imaginary);
    text_print(out, " 1/s, |lambda| step = %.3g: ", s->step * size_of(mode));
    modes_print_shares(out, s->linear, mode);
}

static const char *summary(const Splitter *s, const bool *implicit)
{
    const gic_model *code = &s->linear->engine->code;
    const int count = code->slow_count + code->fast_count;
    Text text = {.pool = s->pool};
    int chosen = 0;
    for (int i = 0; i < count; ++i)
        chosen += implicit[i];
    text_print(&text, "in steps of %.6g s %d of %d states are implicit", s->step, chosen, count);
    if (s->others)
        text_print(&text, "; of motions that are not stiff the fastest has |lambda| step = %.3g",
                   s->step * size_of(&s->left));
    return text.s;
}

static const char *tell(const Splitter *s, const bool *implicit)
{
    const gic_model *code = &s->linear->engine->code;
    const int count = code->slow_count + code->fast_count;
    Text text = {.pool = s->pool}, *out = &text;
    int named = 0;
    text_print(out, "Implicit states, for steps of %.6g s:", s->step);
    for (int i = 0; i < count; ++i)
        if (implicit[i])
            text_print(out, "%s %s", named++ ? "," : "", code->state[i].name);
    text_print(out, named ? "\n" : " none\n");
    if (s->stiff)
        tell_mode(out, s, "The fastest stiff motion:", &s->fastest);
    if (s->stiff > 1)
        tell_mode(out, s, "The slowest of them:", &s->slowest);
    if (s->others)
        tell_mode(out, s, "The fastest of the others:", &s->left);
    return out->s;
}

const Splitting *stiff_states(Pool *pool, const Model *model, Solve solve, Recovery recovery, double step)
{
    const Engine *engine =
        engine_open(pool, "tape", model, &(EngineOptions){.solve = solve, .recovery = recovery, .quiet = true});
    Splitter s = {.pool = pool,
                  .model = model,
                  .engine = engine,
                  .linear = linear_open(pool, engine),
                  .solve = solve,
                  .step = step};
    Instance *self = (Instance *)(void *)instance_new(pool, engine);
    const int status = engine->code->setup(self);
    if (status != GIC_OK)
        diag_fail((Place){model->source, 0, 0}, NULL, "the model can't be set up: %s",
                  instance_status(pool, engine->code, &self->head, status));
    gsl_errors_return();
    find_groups(&s);
    s.weighed = rate_columns_weigh(pool, s.linear->engine->formulation);
    add_point(&s, s.linear, self);
    add_contacts(&s, self);
    for (const Point *point = s.points; point; point = point->next)
        count_shares(&s, point);
    choose(&s, s.share, least);
    for (const Point *point = s.points; point && !all_chosen(&s);)
        point = will_do(&s, point) ? point->next : s.points; /* a choice that has grown is another one everywhere */
    if (!s.points)
        memset(s.chosen, true, (size_t)s.groups);
    Splitting *splitting = pool_alloc(pool, sizeof *splitting);
    splitting->implicit = in_state(&s);
    splitting->told = tell(&s, splitting->implicit);
    splitting->summary = summary(&s, splitting->implicit);
    return splitting;
}

const Splitting *scene_splitting(Pool *pool, const Model *model, const Scene *scene, Solve solve, Recovery recovery)
{
    const bool splits = scene->stiff && scene_implicit(scene) && scene->method != GIC_EXP3;
    return splits ? stiff_states(pool, model, solve, recovery, scene->step) : NULL;
}
