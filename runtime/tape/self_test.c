/* SPDX-License-Identifier: MIT
 * The self-test of the template model.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "tape/engine_tape.h"

#include "../../templates/bounds.c.in"

#include <math.h>
#include <string.h>

/* Residual of the equations of motion at accelerations acc, at the present state. */
static int inverse(Instance *self, const double *e, double *acc, double *tau)
{
    const TapeEngine *engine = tape_of(self);
    return tape_whole(self, engine->inverse, gic_time(self), tape_array(self, engine->code.state_offset), e, NULL, acc,
                      tau);
}

/* The mass matrix column by column: what a unit acceleration adds to the residual. */
static int mass_matrix(Instance *self, const double *e, int n)
{
    const TapeEngine *engine = tape_of(self);
    for (int j = 0; j < n; ++j) {
        engine->unit[j] = 1;
        int status = inverse(self, e, engine->unit, engine->tau);
        if (status != GIC_OK)
            return status;
        engine->unit[j] = 0;
        for (int i = 0; i < n; ++i)
            engine->mass[n * i + j] = engine->tau[i] - engine->tau0[i];
    }
    return GIC_OK;
}

static void compare(const TapeEngine *engine, int n, gic_self_test *result)
{
    const double *M = engine->mass, *tau0 = engine->tau0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) {
            double scale = sqrt(fabs(M[n * i + i] * M[n * j + j])) + fabs(tau0[i]) + fabs(tau0[j]);
            if (scale > 0)
                result->symmetry = fmax(result->symmetry, fabs(M[n * i + j] - M[n * j + i]) / scale);
        }
    for (int i = 0; i < n; ++i) {
        double scale = fabs(tau0[i]);
        for (int j = 0; j < n; ++j)
            scale += fabs(M[n * i + j] * engine->acc[j]);
        if (scale > 0)
            result->balance = fmax(result->balance, fabs(engine->tau[i]) / scale);
    }
}

/* Elimination of a symmetric matrix: pivots relative to the diagonal. */
static void eliminate(const TapeEngine *engine, int n, gic_self_test *result)
{
    double *M = engine->mass, *diagonal = engine->unit;
    for (int i = 0; i < n; ++i)
        diagonal[i] = M[n * i + i];
    for (int l = 0; l < n; ++l) {
        for (int i = l + 1; i < n; ++i)
            for (int j = l + 1; j < n; ++j)
                M[n * i + j] -= M[n * i + l] / M[n * l + l] * M[n * l + j];
        result->smallest_pivot = fmin(result->smallest_pivot, M[n * l + l] / diagonal[l]);
    }
}

int tape_self_test(void *instance, gic_self_test *result)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    const int n = engine->formulation->plan->unknowns;
    double e[4], energy[3];
    self->head.unchecked = 0;
    int status = tape_refresh(self, e);
    *result = (gic_self_test){.smallest_pivot = 1};
    if (status == GIC_OK || status == GIC_ERROR_RESIDUAL) {
        double residual[2];
        tape_residual(self, residual);
        result->constraint = residual[0];
        result->motion = residual[1];
    }
    memset(engine->unit, 0, (size_t)n * sizeof *engine->unit);
    if (status == GIC_OK)
        status = tape_whole(self, engine->energy, gic_time(self), tape_array(self, code->state_offset), e,
                            tape_array(self, code->rate_offset), engine->acc, energy);
    if (status == GIC_OK)
        status = inverse(self, e, engine->unit, engine->tau0);
    if (status == GIC_OK)
        status = mass_matrix(self, e, n);
    if (status == GIC_OK)
        status = inverse(self, e, engine->acc, engine->tau);
    if (status != GIC_OK)
        return self->head.status = status;
    result->energy = fabs(energy[0] - energy[1]) / (energy[2] > 0 ? energy[2] : 1);
    compare(engine, n, result);
    eliminate(engine, n, result);
    return self->head.status = GIC_OK;
}
