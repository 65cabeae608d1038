/* SPDX-License-Identifier: MIT
 * Models without the mass of their light bodies, and what that takes from the equations of motion. */
#include "base/text.h"
#include "base/vec3.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"

#include <math.h>
#include <string.h>

static bool is_light(const Model *model, int body, double below)
{
    return (model->free_base || body != BODY_BASE) && model->body[body].mass < below;
}

const Model *model_lighten(Pool *pool, const Model *model, const Model *numbers, double below, const char **names)
{
    Model *light = pool_alloc(pool, sizeof *light);
    const size_t size = sizeof *model->body * (size_t)model->bodies;
    Text list = {.pool = pool};
    *light = *model;
    light->body = pool_grow(pool, model->body, size, size);
    tuning_copy_all(model, light->body, model->body, size);
    for (int b = 0; b < model->bodies; ++b) {
        Body *body = &light->body[b];
        if (!is_light(numbers, b, below))
            continue;
        body->mass = 0;
        memset(body->inertia, 0, sizeof body->inertia);
        if (model->tuning) { /* whatever the mass would be */
            tuning_drop(model->tuning, &body->mass, 1);
            tuning_drop(model->tuning, body->inertia, 6);
        }
        text_print(&list, "%s%s", list.size ? ", " : "", body->name);
    }
    *names = list.size ? list.s : NULL;
    return light;
}

/* ---- what is lost ------------------------------------------------------------------------------------------------ */

/* How the bodies of a model move with its free coordinates, base and driven coordinates held. */
typedef struct Moves {
    const Model *model;
    const Sequence *sequence;
    const Sampling *sampling;
    const double (*origin)[3];
    int *place, free; /* [coordinates] among the free ones, -1: driven */
} Moves;

/* Angular velocity, and velocity of the centre of mass, of a unit rate of the subset's coordinate j; body axes. */
static void unit_velocities(const Moves *m, int configuration, int body, int deps, int j, double omega[3], double v[3])
{
    const double *A = sampling_pose(m->sampling, m->sampling->steps, configuration, body) + 3;
    const double *S = m->sampling->S[body] + 6 * (configuration * deps + j);
    double arm[3], swing[3];
    apply3_transposed(A, S, omega);
    apply3_transposed(A, S + 3, v);
    for (int i = 0; i < 3; ++i)
        arm[i] = m->model->body[body].com[i] - m->origin[body][i];
    cross3(omega, arm, swing);
    for (int i = 0; i < 3; ++i)
        v[i] += swing[i];
}

/* Add what a body has in the mass matrix M [free][free]. */
static void add_body(const Moves *m, int configuration, int b, double *M)
{
    static const int entry[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    const Subset *subset = &m->sequence->subset[m->sequence->body_subset[b]];
    const Body *body = &m->model->body[b];
    double omega[subset->deps + 1][3], v[subset->deps + 1][3];
    for (int j = 0; j < subset->deps; ++j)
        unit_velocities(m, configuration, b, subset->deps, j, omega[j], v[j]);
    for (int j = 0; j < subset->deps; ++j)
        for (int k = 0; k < subset->deps; ++k) {
            const int row = m->place[subset->dep[j]], column = m->place[subset->dep[k]];
            double sum = body->mass * dot3(v[j], v[k]);
            for (int i = 0; i < 9; ++i)
                sum += omega[j][i / 3] * body->inertia[entry[i / 3][i % 3]] * omega[k][i % 3];
            if (row >= 0 && column >= 0)
                M[m->free * row + column] += sum;
        }
}

/* Is light - kept all positive definite? By its pivots. */
static bool keeps(int n, const double *light, const double *all, double kept)
{
    double A[n * n + 1];
    for (int i = 0; i < n * n; ++i)
        A[i] = light[i] - kept * all[i];
    for (int k = 0; k < n; ++k) {
        if (!(A[n * k + k] > 0))
            return false;
        for (int i = k + 1; i < n; ++i)
            for (int j = k + 1; j < n; ++j)
                A[n * i + j] -= A[n * i + k] * A[n * k + j] / A[n * k + k];
    }
    return true;
}

/* Part of its kinetic energy that a motion loses at most at a configuration. */
static double lost_at(const Moves *m, int configuration, double below)
{
    const double least = 1e-9; /* of the inertia: what is left below that is rounding */
    const int n = m->free;
    double all[n * n + 1], light[n * n + 1], low = least, high = 1;
    memset(all, 0, sizeof all);
    memset(light, 0, sizeof light);
    for (int b = 1; b < m->model->bodies; ++b) {
        add_body(m, configuration, b, all);
        if (!is_light(m->model, b, below))
            add_body(m, configuration, b, light);
    }
    if (!keeps(n, light, all, low))
        return 1;
    for (int i = 0; i < 40; ++i) {
        const double kept = (low + high) / 2;
        *(keeps(n, light, all, kept) ? &low : &high) = kept;
    }
    return 1 - low;
}

static bool usable(const Sampling *sampling, int configuration)
{
    for (int b = 0; b < sampling->bodies; ++b)
        if (!sampling->usable[b * sampling->configurations + configuration])
            return false;
    return true;
}

double model_lost(Pool *pool, const Model *model, double below)
{
    Moves m = {.sequence = sequence_find(pool, model),
               .place = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof *m.place)};
    m.model = model_assemble(pool, model, m.sequence);
    m.origin = (const double(*)[3])reference_points(pool, m.model, m.sequence);
    Sampling *sampling = sampling_new(pool, m.model, m.sequence, m.origin);
    subsets_formulate(pool, m.model, &m.sequence, m.origin, sampling, SOLVE_REDUCED, RECOVERY_NEWTON);
    m.sampling = sampling;
    for (int w = 0; w < model->coordinates; ++w)
        m.place[w] = model->coordinate[w].driven ? -1 : m.free++;
    double lost = 0;
    for (int c = 0; m.free && c < sampling->configurations; ++c)
        if (usable(sampling, c))
            lost = fmax(lost, lost_at(&m, c, below));
    return lost;
}
