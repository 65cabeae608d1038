/* SPDX-License-Identifier: MIT
 * What connections measure: dual coordinates, and formulas of them, of gears and couplers. A formula is its subset's
 * own: the class of such a subset has one member. */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

static Ex coupling_number(void *context, Ex formula, double value)
{
    return subset_number(context, &value, &formula);
}

void subset_measures(Work *w)
{
    const int coordinates = w->model->coordinates, deps = w->first->deps;
    Ex x[coordinates + 1], rate[coordinates + 1];
    for (int j = 0; j < deps; ++j) {
        x[w->first->dep[j]] = w->x[j];
        rate[w->first->dep[j]] = w->rate[j];
    }
    for (int i = 0; i < w->connections; ++i) {
        Connection *tie = &w->connection[i];
        if (tie->is_coordinate) {
            tie->x = w->x[tie->dep];
            tie->rate = w->rate[tie->dep];
        } else if (tie->measure >= 0) {
            Ex *slope = pool_alloc(w->pool, ((size_t)deps + 1) * sizeof *slope);
            const Coupling f =
                coupling_make(w->dag, w->model, w->model->joint[tie->index].value, x, rate, coupling_number, w);
            tie->x = f.x;
            tie->rate = f.rate;
            tie->second = f.second;
            for (int j = 0; j < deps; ++j)
                slope[j] = f.slope[w->first->dep[j]];
            tie->slope = slope;
        }
    }
}

Ex subset_dual(const Work *w, const Connection *tie, const Row *row, int j)
{
    if (tie->is_coordinate)
        return tie->dep == j ? row->dual : 0;
    return tie->slope ? ex_mul(w->dag, row->dual, tie->slope[j]) : 0;
}

double subset_dual_value(const Work *w, const Connection *tie, int r, int j, int s)
{
    const double dual = tie->measure < 0 ? 0 : ex_value(w->dag, w->row[r].dual, s);
    if (tie->is_coordinate)
        return tie->dep == j ? dual : 0;
    return tie->slope ? dual * ex_value(w->dag, tie->slope[j], s) : 0;
}
