/* SPDX-License-Identifier: MIT
 * Interpreted engines' numbers that follow geometric parameters (FORMAT.md section 6): the Model keeps the formulas
 * beside the numbers; here they are evaluated and written back, and the design configuration is found anew. */
#include "compare/interpreted.h"
#include "engine/engine.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/tunable.h"
#include "world/world.h"

#include <string.h>

/* Lengths other than the drawing's are reached from it in this many pieces. */
enum { PIECES = 64 };

typedef struct Geometry {
    Tuning *tuning;
    int parameters;
    Ex *input, rest;   /* [parameters] */
    bool *geometric;   /* [parameters] */
    double *parameter; /* [parameters] that the World's numbers are for */
    bool adopted;      /* false after a failure: for none */
} Geometry;

Geometry *geometry_new(Pool *pool, const Model *model)
{
    if (!model->tuning)
        return NULL;
    Geometry *geometry = pool_alloc(pool, sizeof *geometry);
    const size_t count = (size_t)model->tunables + 1;
    *geometry = (Geometry){.tuning = model->tuning,
                           .parameters = model->tunables,
                           .input = pool_alloc(pool, count * sizeof *geometry->input),
                           .geometric = pool_alloc(pool, count * sizeof *geometry->geometric),
                           .parameter = pool_alloc(pool, count * sizeof *geometry->parameter),
                           .adopted = true};
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *parameter = &model->parameter[i];
        if (!parameter->tunable)
            continue;
        geometry->input[parameter->index] =
            ex_input(model->tuning->dag, element_at(ARRAY_p, parameter->index), &parameter->value);
        geometry->geometric[parameter->index] = parameter->geometric;
        geometry->parameter[parameter->index] = parameter->value;
    }
    geometry->rest = ex_input(model->tuning->dag, element_at(ARRAY_rest, 0), &(const double){0});
    return geometry;
}

bool geometry_adopted(const Interpreted *context, const double *parameter)
{
    const Geometry *geometry = context->geometry;
    for (int i = 0; i < geometry->parameters; ++i)
        if (geometry->geometric[i] && geometry->parameter[i] != parameter[i])
            return false;
    return geometry->adopted;
}

/* Index of a condition that doesn't hold, -1: none. */
static int broken_condition(const Tuning *tuning)
{
    for (int i = 0; i < tuning->conditions; ++i) {
        const double value = ex_value(tuning->dag, tuning->condition[i].value, 0);
        if (!(tuning->condition[i].zero ? value >= 0 : value > 0))
            return i;
    }
    return -1;
}

/* Numbers into the Model, which is this engine's own. */
static bool write_numbers(const Tuning *tuning)
{
    for (int i = 0; i < tuning->numbers; ++i) {
        const double value = ex_value(tuning->dag, tuning->number[i].formula, 0);
        if (!gic_finite(&value, 1))
            return false;
        *(double *)tuning->number[i].at = value;
    }
    return true;
}

int geometry_adopt(const Interpreted *context, Instance *self, const double *parameter)
{
    Geometry *geometry = context->geometry;
    World *world = context->world;
    Dag *dag = geometry->tuning->dag;
    const int pieces = geometry->tuning->assembles ? PIECES : 1;
    double q[world->bodies][BODY_Q];
    int status = GIC_OK;
    if (!context->design)
        return GIC_ERROR_TUNED;
    geometry->adopted = false;
    for (int i = 0; i < geometry->parameters; ++i) {
        geometry->parameter[i] = parameter[i];
        ex_set_sample(dag, geometry->input[i], 0, parameter[i]);
    }
    for (int piece = 1; piece <= pieces && status == GIC_OK; ++piece) {
        ex_set_sample(dag, geometry->rest, 0, (double)(pieces - piece) / pieces);
        dag_evaluate(dag, 0, 1);
        self->head.condition = broken_condition(geometry->tuning);
        if (self->head.condition >= 0 || !write_numbers(geometry->tuning))
            return GIC_ERROR_GEOMETRY;
        world_adopt(world);
        if (piece > 1)
            memcpy(world->q_design, q, sizeof q);
        status = context->design(context, self);
        memcpy(q, world->q, sizeof q);
    }
    if (status != GIC_OK)
        return status;
    memcpy(world->q_design, q, sizeof q);
    geometry->adopted = true;
    return GIC_OK;
}
