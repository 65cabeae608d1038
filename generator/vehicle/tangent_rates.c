/* SPDX-License-Identifier: MIT
 * Derivatives of the rates along one direction, with no derivative of the mass matrix. */
#include "vehicle/tangent_rates.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"

static const DagSystem *solved_system(const Plan *plan, const Block *dynamics)
{
    const Dag *dag = dynamics->dag;
    const DagSystem *all = NULL;
    for (int s = 0; s < dag->systems; ++s)
        if (dag->system[s].factors->n == plan->unknowns)
            all = &dag->system[s];
    for (int i = 0; all && i < plan->unknowns; ++i)
        if (!all->found[i])
            return NULL;
    return all;
}

bool rates_are_solved(const Plan *plan, const Block *dynamics)
{
    return plan->unknowns > 0 && solved_system(plan, dynamics);
}

/* db less what the bodies lack [unknowns]. */
static Ex *right_hand_sides(const Plan *plan, const Block *dynamics, const Ex *b, const Seeds *seeds, const bool *lacks)
{
    Dag *dag = dynamics->dag;
    const int n = plan->unknowns;
    Ex *right = pool_alloc(dag->pool, (size_t)n * sizeof *right);
    Ex *lack = pool_alloc(dag->pool, (size_t)n * sizeof *lack);
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        for (int i = 0; subset->class >= 0 && i < 6 + subset->deps; ++i) {
            const int row = i >= 6 ? plan->coordinate_unknown[subset->dep[i - 6]] : plan->model->free_base ? i : -1;
            const int place = plan->inertia_offset[s] + i;
            if (row >= 0 && lacks[place])
                lack[row] = ex_add(dag, lack[row], ex_input(dag, element_at(ARRAY_lack, place), NULL));
        }
    }
    const Ex *slope = dag_slopes(dag, dynamics, b, n, seeds);
    for (int i = 0; i < n; ++i)
        right[i] = ex_sub(dag, slope[b[i]], lack[i]);
    return right;
}

/* [nodes] those that depend on lack[]. */
static const bool *follow_lack(const Dag *dag)
{
    bool *follows = pool_alloc(dag->pool, (size_t)dag->nodes);
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        follows[e] = node->op == OP_INPUT && node->element->array == ARRAY_lack;
        for (int i = 0; node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i)
            follows[e] = follows[e] || follows[node->arg[i]];
    }
    return follows;
}

/* Let the second block read from factor[] what the first can compute. */
static void part(TangentRates *rates, const bool *follows)
{
    Dag *dag = rates->second.dag;
    const int stores = rates->second.stores;
    Ex *root = pool_alloc(dag->pool, ((size_t)stores + 1) * sizeof *root), *from = NULL, *to = NULL;
    int count = 0;
    for (int i = 0; i < stores; ++i)
        root[i] = rates->second.store[i].value;
    const bool *needed = dag_needed(dag, root, stores);
    bool *read = pool_alloc(dag->pool, (size_t)dag->nodes);
    for (int e = 0; e < dag->nodes; ++e)
        for (int i = 0; needed[e] && follows[e] && i < ex_arity((Op)dag->node[e].op); ++i)
            read[dag->node[e].arg[i]] = true;
    for (Ex e = 0, nodes = (Ex)dag->nodes; e < nodes; ++e)
        if (read[e] && !follows[e] && dag->node[e].level == LEVEL_VARIABLE && dag->node[e].op != OP_INPUT) {
            *POOL_PUSH(dag->pool, from, count) = e;
            *POOL_PUSH(dag->pool, to, rates->factors) = ex_input(dag, element_at(ARRAY_factor, count - 1), NULL);
            block_store(&rates->first, e, element_at(ARRAY_factor, count - 1));
        }
    const Ex *image = dag_replace(dag, root, stores, from, to, count);
    for (int i = 0; i < stores; ++i)
        rates->second.store[i].value = image[root[i]];
}

const TangentRates *tangent_rates(const Plan *plan, const Block *dynamics, const Seeds *seeds, const bool *lacks)
{
    Dag *dag = dynamics->dag;
    const DagSystem system = *solved_system(plan, dynamics);
    const int n = plan->unknowns;
    dag->own = dag->own ? dag->own : dag->nodes;
    TangentRates *rates = pool_alloc(dag->pool, sizeof *rates);
    Seeds solved = *seeds;
    dag_section(dag, "derivatives of the accelerations");
    Ex *dz = right_hand_sides(plan, dynamics, system.b, seeds, lacks);
    linear_solve(dag, system.factors, dz, dz);
    solved.givens = n;
    solved.given = system.x;
    solved.slope = dz;
    const Block *both = block_tangent(dynamics, &solved, true, NULL);
    const bool *follows = follow_lack(dag);
    rates->first = (Block){.dag = dag, .model = both->model, .checks = both->checks, .check = both->check};
    rates->second = (Block){.dag = dag, .model = both->model};
    for (int i = 0; i < both->stores; ++i) {
        const Store *store = &both->store[i];
        block_store(follows[store->value] ? &rates->second : &rates->first, store->value, store->target);
    }
    for (int i = 0; i < n; ++i)
        block_store(&rates->first, system.x[i], element_at(ARRAY_acc, i));
    part(rates, follows);
    return rates;
}
