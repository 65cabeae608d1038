/* SPDX-License-Identifier: MIT
 * How an equilibrium follows parameters and inputs: f(z, p) = 0 there, so A dz = -df/dp (implicit function theorem).
 *
 * Places follow first, as in the search, on whose way down tires have no stretch; what they can not follow alone, on a
 * slope that brakes hold, is left to the tires. Both changes are those of least norm, so that along directions in which
 * nothing changes all stays. */
#include "run/equilibrium_private.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

/* Columns of the equations, and what is left of them to solve. */
typedef struct Columns {
    const Equilibrium *found;
    int equations;
    gsl_matrix *U, *V;
    gsl_vector *S;
    double least; /* singular values below count as zero */
} Columns;

/* Take from r [equations] what the columns can make of it: all but what is normal to them. */
static void columns_remove(const Columns *c, double *r)
{
    for (size_t k = 0; k < c->S->size; ++k) {
        double part = 0;
        for (int i = 0; i < c->equations && gsl_vector_get(c->S, k) > c->least; ++i)
            part += gsl_matrix_get(c->U, (size_t)i, k) * r[i];
        for (int i = 0; i < c->equations; ++i)
            r[i] -= part * gsl_matrix_get(c->U, (size_t)i, k);
    }
}

/* The columns of `unknown` [count] in units of the reach, without what `before`, if given, can make, decomposed. */
static Columns columns_of(const Equilibrium *found, const int *unknown, int count, const Columns *before)
{
    const Linear *linear = found->linear;
    const int n = linear->count - linear->places;
    Columns c = {found,
                 n,
                 gsl_matrix_alloc((size_t)n, (size_t)count),
                 gsl_matrix_alloc((size_t)count, (size_t)count),
                 gsl_vector_alloc((size_t)count),
                 0};
    double column[n];
    for (int j = 0; j < count; ++j) {
        const int at = equilibrium_column(linear, unknown[j]);
        for (int i = 0; i < n; ++i)
            column[i] = found->A[(linear->places + i) * linear->count + at] * linear->reach[at];
        if (before)
            columns_remove(before, column);
        for (int i = 0; i < n; ++i)
            gsl_matrix_set(c.U, (size_t)i, (size_t)j, column[i]);
    }
    gsl_linalg_SV_decomp_jacobi(c.U, c.V, c.S);
    c.least = fmax(equilibrium_rank * gsl_vector_get(c.S, 0), before ? before->least : 0);
    return c;
}

/* z: the change of least norm of the unknowns by which the columns make -r. */
static void columns_solve(const Columns *c, const int *unknown, const double *r, double *z)
{
    const Linear *linear = c->found->linear;
    for (size_t k = 0; k < c->S->size; ++k) {
        double part = 0;
        for (int i = 0; i < c->equations && gsl_vector_get(c->S, k) > c->least; ++i)
            part -= gsl_matrix_get(c->U, (size_t)i, k) * r[i] / gsl_vector_get(c->S, k);
        for (size_t j = 0; j < c->S->size; ++j) {
            const int at = equilibrium_column(linear, unknown[j]);
            z[at] += part * gsl_matrix_get(c->V, j, k) * linear->reach[at];
        }
    }
}

static void columns_free(const Columns *c)
{
    gsl_matrix_free(c->U);
    gsl_matrix_free(c->V);
    gsl_vector_free(c->S);
}

int equilibrium_change(const Equilibrium *found, LinearKind kind, int j, double *z)
{
    const Linear *linear = found->linear;
    const int n = linear->count - linear->places, count[2] = {n - linear->of_wheels, linear->of_wheels};
    double f[linear->count + 1], df[linear->count + 1], *r = df + linear->places, left[n];
    int unknown[2][n], filled[2] = {0}; /* the second ones: fast states of wheels */
    int32_t gears[POWERTRAIN_DISCRETE] = {0};
    bool jump;
    if (found->locked)
        equilibrium_exchange_gears(found, gears);
    int status = linear_start(linear, found->self, f);
    if (status == GIC_OK)
        status = linear_column(linear, found->self, kind, j, df, 0, NULL, &jump);
    if (found->locked)
        equilibrium_exchange_gears(found, gears);
    memset(z, 0, (size_t)linear->count * sizeof *z);
    memset(unknown, 0, sizeof unknown);
    if (status != GIC_OK)
        return status;
    for (int i = 0; i < n; ++i) {
        const bool of_wheel = i >= linear->places && i < linear->places + linear->of_wheels;
        unknown[of_wheel][filled[of_wheel]++] = i;
        r[i] = i >= linear->places && found->locked && equilibrium_is_held(found, linear->places + i) ? 0 : r[i];
    }
    const Columns places = columns_of(found, unknown[0], count[0], NULL);
    if (count[1]) { /* tires stretch by what places can not follow alone */
        const Columns rest = columns_of(found, unknown[1], count[1], &places);
        memcpy(left, r, sizeof left);
        columns_remove(&places, left);
        columns_solve(&rest, unknown[1], left, z);
        columns_free(&rest);
    }
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < count[1]; ++k) {
            const int at = equilibrium_column(linear, unknown[1][k]);
            r[i] += found->A[(linear->places + i) * linear->count + at] * z[at];
        }
    columns_solve(&places, unknown[0], r, z);
    columns_free(&places);
    return GIC_OK;
}
