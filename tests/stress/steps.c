/* SPDX-License-Identifier: MIT
 * steps SCRATCH_FILE [MODEL...]: the longest stable steps of AB3 and RK4 about the static equilibrium of each model,
 * measured with generated code by bisection, against theory: the eigenvalues of the linearized model and the roots of
 * the methods' characteristic polynomials. A run beyond the limit must end in GIC_ERROR_UNSTABLE or stay bounded by
 * what the model does when it is large. Without a model: one spring, one damper, over nine decades of stiffness; and
 * dual rate, on a linear system whose fast state is as fast as is wanted. Prints rows of the table of attacks. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/linearize.h"
#include "scene/scene.h"
#include "subset/subset.h"

#include <complex.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- theory --------------------------------------------------------------------------------------------------------
 */

/* The largest root of r^3 - (1 + 23 z / 12) r^2 + 16 z / 12 r - 5 z / 12, by Durand and Kerner's iteration. */
static double ab3_growth(double complex z)
{
    const double complex a = -(1 + 23 * z / 12), b = 16 * z / 12, c = -5 * z / 12;
    double complex r[3] = {1, 0.4 + 0.9 * I, -0.65 + 0.72 * I};
    for (int k = 0; k < 500; ++k)
        for (int i = 0; i < 3; ++i) {
            const double complex x = r[i], others = (x - r[(i + 1) % 3]) * (x - r[(i + 2) % 3]);
            r[i] -= (((x + a) * x + b) * x + c) / others;
        }
    return fmax(cabs(r[0]), fmax(cabs(r[1]), cabs(r[2])));
}

static double rk4_growth(double complex z)
{
    return cabs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))));
}

/* The longest step with which no eigenvalue's motion grows. Those that are (nearly) zero or grow by themselves do not
 * count. */
static double longest(int32_t method, const double complex *lambda, int count)
{
    double shortest = INFINITY;
    for (int i = 0; i < count; ++i) {
        const double size = cabs(lambda[i]);
        if (size < 1e-3 || creal(lambda[i]) > 1e-9 * size)
            continue;
        double low = 0.1, high = 4; /* of step times |lambda| */
        while (high - low > 1e-9) {
            const double middle = (low + high) / 2;
            const double complex z = middle * lambda[i] / size;
            /* a motion without damping is damped a little by AB3's error, or grows by RK4's, to the sixth order */
            *((method == GIC_AB3 ? ab3_growth(z) : rk4_growth(z)) > 1 + 1e-9 ? &high : &low) = middle;
        }
        shortest = fmin(shortest, low / size);
    }
    return shortest;
}

/* ---- measurement
 * ----------------------------------------------------------------------------------------------------- */

/* Does a small displacement from rest grow over many steps? */
typedef struct Rest {
    const gic_model *code;
    gic_head *self, *rest;
    double nudge;
} Rest;

enum { SETTLING = 400, STEPS = 6000 };

static double distance(const Rest *rest)
{
    const double *now = instance_array(rest->self, rest->code->state_offset);
    const double *then = instance_array(rest->rest, rest->code->state_offset);
    double sum = 0;
    for (int c = 0; c < rest->code->coordinate_count; ++c) {
        const int at = rest->code->coordinate_state[c];
        if (at >= 0)
            sum += (now[at] - then[at]) * (now[at] - then[at]);
    }
    return sqrt(sum);
}

static bool grows(const Rest *rest, double step, int32_t method)
{
    double early = 0, late = 0;
    memcpy(rest->self, rest->rest, rest->code->size);
    double *state = instance_array(rest->self, rest->code->state_offset);
    for (int c = 0; c < rest->code->coordinate_count; ++c)
        if (rest->code->coordinate_state[c] >= 0)
            state[rest->code->coordinate_state[c]] += rest->nudge * (1 + 0.37 * c);
    for (int i = 0; i < STEPS; ++i) {
        if (gic_step(rest->code, rest->self, step, method) != GIC_OK)
            return true;
        const double now = distance(rest);
        if (i < SETTLING)
            early = fmax(early, now);
        else if (i >= STEPS - SETTLING)
            late = fmax(late, now);
        if (now > 1e3 * rest->nudge)
            return true;
    }
    return late > early;
}

/* The longest stable step, which is sought from half of `least` to twice `most`. */
static double measured(const Rest *rest, int32_t method, double least, double most)
{
    double low = 0.5 * least, high = 2 * most;
    while (high / low > 1.0005) {
        const double middle = sqrt(low * high);
        *(grows(rest, middle, method) ? &high : &low) = middle;
    }
    return low;
}

/* A run with half as much again as the limit, with a displacement that is felt: the status that ends it. (A model whose
 * dampers have a kink at rest, such as hmmwv_full, has no small motions to compare with.) */
static int ending(const Rest *rest, int32_t method, double limit, double push)
{
    memcpy(rest->self, rest->rest, rest->code->size);
    double *state = instance_array(rest->self, rest->code->state_offset);
    for (int c = 0; c < rest->code->coordinate_count; ++c)
        if (rest->code->coordinate_state[c] >= 0)
            state[rest->code->coordinate_state[c]] += push;
    for (int i = 0; i < STEPS; ++i) {
        const int status = gic_step(rest->code, rest->self, 1.5 * limit, method);
        if (status != GIC_OK)
            return status;
        if (!gic_finite(state, rest->code->slow_count))
            return 1;
    }
    return GIC_OK;
}

static int eigenvalues(const double *A, int n, double complex *lambda)
{
    gsl_matrix_const_view view = gsl_matrix_const_view_array(A, (size_t)n, (size_t)n);
    gsl_matrix *copy = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_vector_complex *value = gsl_vector_complex_alloc((size_t)n);
    gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc((size_t)n);
    gsl_matrix_memcpy(copy, &view.matrix);
    const int status = gsl_eigen_nonsymm(copy, value, work);
    for (int i = 0; i < n; ++i) {
        const gsl_complex v = gsl_vector_complex_get(value, (size_t)i);
        lambda[i] = GSL_REAL(v) + I * GSL_IMAG(v);
    }
    gsl_eigen_nonsymm_free(work);
    gsl_vector_complex_free(value);
    gsl_matrix_free(copy);
    return status;
}

/* The longest steps of theory with both methods, about the equilibrium of a model. */
static bool find_longest(const Equilibrium *equilibrium, double limit[GIC_RK4 + 1])
{
    const int n = equilibrium->linear->count;
    double complex lambda[n];
    if (eigenvalues(equilibrium->A, n, lambda) != 0)
        return false;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        limit[method] = longest(method, lambda, n);
    return true;
}

/* What a model's theory is: itself, or of one with dampers that work otherwise in compression than in rebound, models
 * whose dampers work in both ways as in one of them. Motions of such a model are not those of a linear one, however
 * small: only that its limit lies between theirs can be said. */
typedef struct Theory {
    double least[GIC_RK4 + 1], most[GIC_RK4 + 1];
    bool kinked;
} Theory;

/* sides: two paths, or NULL. */
static bool find_theory(Pool *pool, const Equilibrium *equilibrium, const char *const *sides, Theory *theory)
{
    bool good = find_longest(equilibrium, theory->least);
    memcpy(theory->most, theory->least, sizeof theory->most);
    theory->kinked = sides != NULL;
    for (int i = 0; i < 2 && good && sides; ++i) {
        double limit[GIC_RK4 + 1];
        good = find_longest(equilibrium_find(pool, model_read(pool, sides[i]), NULL, SOLVE_REDUCED), limit);
        for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method) {
            theory->least[method] = i ? fmin(theory->least[method], limit[method]) : limit[method];
            theory->most[method] = i ? fmax(theory->most[method], limit[method]) : limit[method];
        }
    }
    return good;
}

/* One model, named `name` in the table; the runs with both methods. Returns the number of findings. */
static int attack_model(const char *path, const char *name, const char *const *sides, double tolerance)
{
    static const char *const method_name[] = {[GIC_AB3] = "ab3", [GIC_RK4] = "rk4"};
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    const Equilibrium *equilibrium = equilibrium_find(pool, model, NULL, SOLVE_REDUCED);
    const EngineOptions options = {.quiet = true, .flags = "", .compiler = compiler_default()};
    const Engine *engine = engine_open(pool, "tcc", model, &options);
    const gic_model *code = engine->code;
    Theory theory;
    Rest rest = {code, instance_new(pool, engine), instance_new(pool, engine), 1e-7};
    int found = !find_theory(pool, equilibrium, sides, &theory) || code->setup(rest.rest) != GIC_OK;
    double state[engine->standard_count];
    found += engine_look(equilibrium->engine, &equilibrium->self->head, state, NULL) != GIC_OK;
    found += engine_enter(engine, rest.rest, state) != GIC_OK;
    memcpy(instance_array(rest.rest, code->input_offset),
           instance_array(&equilibrium->self->head, equilibrium->engine->code->input_offset),
           sizeof(double) * (size_t)code->input_count);
    for (int32_t method = GIC_AB3; method <= GIC_RK4 && !found; ++method) {
        const double least = theory.least[method], most = theory.most[method];
        const double limit = measured(&rest, method, least, most);
        const double off = fmax(least / limit, limit / most) - 1; /* below 0: between the two */
        const int end = ending(&rest, method, limit, 2e-3);
        const bool reported = end == GIC_OK || end == GIC_ERROR_UNSTABLE;
        const bool good = off < tolerance && reported;
        const int grown = rest.self->grown;
        printf("steps | %s, %s | 2 | %d | %d | longest stable step %.4g ms, ", name, method_name[method],
               1 + (end == GIC_OK), end != GIC_OK, 1e3 * limit);
        if (theory.kinked)
            printf("theory of either side of the dampers %.4g and %.4g ms", 1e3 * least, 1e3 * most);
        else
            printf("theory %+.2g %%", 100 * (least / limit - 1));
        printf(" | %s%s%s%s\n",
               !reported          ? gic_status_text(end)
               : off >= tolerance ? "not the step of theory"
                                  : "ok: ",
               good && theory.kinked ? "no theory but that it lies between; beyond it, "
               : good                ? "beyond it, "
                                     : "",
               !good           ? ""
               : end == GIC_OK ? "bounded"
                               : "unstable: ",
               good && end != GIC_OK ? code->state[grown].name : "");
        found += !good;
    }
    engine_close(engine);
    pool_free(pool);
    return found;
}

/* ---- one mass on a guide
 * ------------------------------------------------------------------------------------------------ */

/* Written to `path`: eigenvalues of 1 kg with these. */
static void write_mass(const char *path, double stiffness, double damping)
{
    FILE *file = fopen(path, "w");
    if (!file)
        exit(2);
    fprintf(file,
            "gicgen: 1\nmodel: mass\nbase: ground\ngravity: [0, 0, 0]\n"
            "bodies: {mass: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\n"
            "joints: {guide: {type: prismatic, bodies: [ground, mass], axis: [0, 0, 1]}}\n"
            "coordinates: {z: {type: translation, bodies: [ground, mass], axis: [0, 0, 1]}}\n"
            "forces: {s: {type: spring_damper, coordinate: z, stiffness: %.17g, damping: %.17g}}\n",
            stiffness, damping);
    if (fclose(file))
        exit(2);
}

static int attack_masses(const char *path)
{
    int found = 0;
    for (int decade = 1; decade <= 9; decade += 4) {
        const double stiffness = pow(10, decade), critical = 2 * sqrt(stiffness);
        static const double share[] = {0, 0.3, 20};
        for (int i = 0; i < 3; ++i) {
            char name[80];
            write_mass(path, stiffness, share[i] * critical);
            snprintf(name, sizeof name, "1 kg on 1e%d N/m damping %g", decade, share[i]);
            found += attack_model(path, name, NULL, 5e-3);
        }
    }
    return found;
}

/* ---- dual rate
 * ---------------------------------------------------------------------------------------------------------- */

/* x' = slow x + weak y, y' = fast y + weak link, link = x: with `weak` = 0 each has its own method, AB3 at the step and
 * at the step over the ratio. */
typedef struct Pair {
    gic_head head;
    double state[2], rate[2], history[4], scratch[GIC_SCRATCH(2, 0)], link[5];
    double slow, fast, weak;
} Pair;

static int pair_rhs(void *self, double time, const double *state, double *rate)
{
    const Pair *p = self;
    (void)time;
    rate[0] = p->slow * state[0] + p->weak * state[1];
    rate[1] = p->fast * state[1] + p->weak * state[0];
    return GIC_OK;
}

static int pair_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 2) ? GIC_OK : GIC_ERROR_INPUT;
}

static int pair_link(void *self, double time, const double *slow, double *link)
{
    (void)self, (void)time;
    link[0] = slow[0];
    return GIC_OK;
}

static int pair_fast(void *self, double time, const double *link, const double *fast, double *rate)
{
    const Pair *p = self;
    (void)time;
    rate[0] = p->fast * fast[0] + p->weak * link[0];
    return GIC_OK;
}

static const gic_model pair_model = {.abi_version = GIC_ABI_VERSION,
                                     .real_size = sizeof(gic_real),
                                     .size = sizeof(Pair),
                                     .slow_count = 1,
                                     .fast_count = 1,
                                     .state_offset = offsetof(Pair, state),
                                     .rate_offset = offsetof(Pair, rate),
                                     .history_offset = offsetof(Pair, history),
                                     .scratch_offset = offsetof(Pair, scratch),
                                     .link_offset = offsetof(Pair, link),
                                     .link_count = 1,
                                     .rhs = pair_rhs,
                                     .settle = pair_settle,
                                     .link = pair_link,
                                     .fast = pair_fast};

static bool pair_grows(double slow, double fast, double weak, int ratio)
{
    Pair p = {.slow = slow, .fast = fast, .weak = weak, .state = {1, 1}};
    double early = 0;
    for (int i = 0; i < 4000; ++i) {
        if (gic_step_dual(&pair_model, &p, 1, ratio) != GIC_OK)
            return true;
        const double size = fmax(fabs(p.state[0]), fabs(p.state[1]));
        if (i < 100)
            early = fmax(early, size);
        else if (size > 10 * early)
            return true;
    }
    return fmax(fabs(p.state[0]), fabs(p.state[1])) > early;
}

/* The largest -fast (or -slow, with `slower`) per step that does not grow. */
static double pair_limit(int ratio, double weak, bool slower)
{
    double low = 0.01, high = 100 * ratio;
    while (high / low > 1.0001) {
        const double middle = sqrt(low * high);
        *((slower ? pair_grows(-middle, -0.1, weak, ratio) : pair_grows(-0.1, -middle, weak, ratio)) ? &high : &low) =
            middle;
    }
    return low;
}

static int attack_pairs(void)
{
    static const int ratios[] = {1, 2, 6, 20, 100};
    const double alone = 6.0 / 11;
    int found = 0;
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios; ++i) {
        const int ratio = ratios[i];
        const double fast = pair_limit(ratio, 0, false) / ratio, slow = pair_limit(ratio, 0, true);
        const double coupled = pair_limit(ratio, 0.05, false) / ratio;
        const bool good =
            fabs(fast / alone - 1) < 1e-2 && fabs(slow / alone - 1) < 1e-2 && fabs(coupled / alone - 1) < 0.05;
        printf(
            "steps | dual rate, ratio %d | 3 | 3 | 0 | limits %.4f a fast step, %.4f a slow one, coupled %.4f | %s\n",
            ratio, fast, slow, coupled, good ? "ok: theory 0.5455" : "not the limit of theory");
        found += !good;
    }
    return found;
}

int main(int argc, char **argv)
{
    int found = 0;
    if (argc < 2) {
        fputs("usage: steps SCRATCH_FILE [MODEL...] [--sides COMPRESSION REBOUND MODEL]...\n", stderr);
        return 2;
    }
    static const struct {
        const char *name;
        double complex direction;
        double limit[2];
    } known[] = {{"real axis", -1, {6.0 / 11, 2.7852935}}, {"imaginary axis", I, {0.7236, 2.8284271}}};
    for (int i = 0; i < 2; ++i) {
        const double ab3 = longest(GIC_AB3, &known[i].direction, 1), rk4 = longest(GIC_RK4, &known[i].direction, 1);
        const bool good = fabs(ab3 - known[i].limit[0]) < 1e-4 && fabs(rk4 - known[i].limit[1]) < 1e-4;
        printf("steps | limits on the %s | 2 | 2 | 0 | AB3 %.4f RK4 %.4f | %s\n", known[i].name, ab3, rk4,
               good ? "ok" : "not those of the literature");
        found += !good;
    }
    found += attack_masses(argv[1]);
    found += attack_pairs();
    for (int i = 2; i < argc; ++i) {
        const char *const *sides = NULL;
        if (!strcmp(argv[i], "--sides") && i + 3 < argc) {
            sides = (const char *const *)&argv[i + 1];
            i += 3;
        }
        const char *slash = strrchr(argv[i], '/');
        found += attack_model(argv[i], slash ? slash + 1 : argv[i], sides, 2e-2);
    }
    return found != 0;
}
