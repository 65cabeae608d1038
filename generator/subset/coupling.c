/* SPDX-License-Identifier: MIT
 * Formulas of gears and couplers (FORMAT.md section 4.1) as expressions, with the derivatives that velocities and
 * accelerations need: what a joint with a formula f(x) measures has the rate f_x x' and the acceleration f_x x'' +
 * (f_x x')_x x'. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "subset/subset.h"

typedef struct Context {
    Dag *dag;
    const Model *model;
    const Ex *x;
    CouplingNumber *number;
    void *context;
} Context;

static Ex formula(const Context *c, const Law *law)
{
    Ex arg[3] = {0};
    if (law->op == LAW_VALUE)
        return c->x[law->index];
    if (law->op == LAW_PARAMETER) {
        const Ex tuned = tuned_number(c->model, &law->number);
        return tuned ? c->number(c->context, tuned, law_number(law, c->model))
                     : ex_literal(c->dag, law_number(law, c->model));
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = formula(c, law->arg[i]);
    return law_top(c->dag, c->model, law, arg);
}

static Ex still(const void *context, Dag *dag, Element element)
{
    (void)context;
    (void)element;
    return ex_literal(dag, 0);
}

/* The derivative of e where coordinates change by `slope` [count]. */
static Ex derivative(Dag *dag, Ex e, const Ex *x, const Ex *slope, int count)
{
    const Seeds seeds = {.seed = still, .givens = count, .given = x, .slope = slope, .smooth = true};
    const int own = dag->own;
    const Ex out = dag_slopes(dag, NULL, &e, 1, &seeds)[e];
    dag->own = own; /* it is part of what blocks compute */
    return out;
}

Coupling coupling_make(Dag *dag, const Model *model, const Law *law, const Ex *x, const Ex *rate,
                       CouplingNumber *number, void *context)
{
    const Context c = {.dag = dag, .model = model, .x = x, .number = number, .context = context};
    const size_t room = (size_t)model->coordinates + 1;
    Ex read[room], along[room];
    int count = 0;
    Coupling coupling = {.x = formula(&c, law), .slope = pool_alloc(dag->pool, room * sizeof *coupling.slope)};
    for (int i = 0; i < model->coordinates; ++i) {
        if (!law_follows(law, i))
            continue;
        coupling.slope[i] = derivative(dag, coupling.x, &x[i], (Ex[]){ex_literal(dag, 1)}, 1);
        coupling.rate = ex_add(dag, coupling.rate, ex_mul(dag, coupling.slope[i], rate[i]));
        read[count] = x[i];
        along[count++] = rate[i];
    }
    coupling.second = derivative(dag, coupling.rate, read, along, count);
    return coupling;
}
