/* SPDX-License-Identifier: MIT
 * Derivatives of the rates by all states, inputs, parameters and numbers of ports at once. Accelerations are not
 * differentiated as they are solved for: M dz = db - d(M z) at accelerations z that stand still. One factorization of M
 * serves all columns, and a column is 0 but for the bodies and forces that it moves. */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/columns.h"
#include "vehicle/dynamics.h"
#include "vehicle/vehicle.h"

/* Where a column's input stands. */
typedef struct Origin {
    Array array;
    int index;
} Origin;

/* What is being differentiated by one column. */
typedef struct Differentiation {
    const RateColumns *all;
    const Plan *plan;
    Origin from;
    bool *moved;             /* rows of part[] that it moves */
    const Ex *accelerations; /* [unknowns] their derivatives; NULL: they stand still */
} Differentiation;

static Origin origin_of(const Plan *plan, int column)
{
    const Model *model = plan->model;
    const int kinds[] = {plan->states + model->fast_states, model->inputs, model->tunables};
    const Array array[] = {ARRAY_y, ARRAY_u, ARRAY_p};
    for (int k = 0; k < 3; ++k) {
        if (column < kinds[k])
            return (Origin){array[k], column};
        column -= kinds[k];
    }
    return (Origin){ARRAY_port, column};
}

/* The coordinate that a column moves, or whose rate it changes; -1: it does neither. */
static int coordinate_of(const Plan *plan, Origin from, bool rate)
{
    const Model *model = plan->model;
    for (int w = 0; w < model->coordinates; ++w) {
        const Coordinate *c = &model->coordinate[w];
        const int state = rate ? plan->coordinate_rate[w] : plan->coordinate_state[w];
        if (c->driven ? from.array == ARRAY_u && from.index == c->input + rate
                      : from.array == ARRAY_y && from.index == state)
            return w;
    }
    return -1;
}

/* The derivative of a number of the motions. */
static Ex motion_slope(const Differentiation *d, Dag *dag, int index)
{
    const Plan *plan = d->plan;
    const Sequence *sequence = plan->sequence;
    const int moved = coordinate_of(plan, d->from, false), sped = coordinate_of(plan, d->from, true);
    if (moved < 0 && sped < 0)
        return 0;
    for (int b = 1; b < plan->model->bodies; ++b) {
        const int s = sequence->body_subset[b];
        const Subset *subset = &sequence->subset[s];
        const Formula *formula = plan->formula[subset->class];
        const int number = index - plan->motion_offset[b];
        if (number < 0 || number >= formula->layout.motion_size)
            continue;
        const MotionColumns *m = d->all->motion[subset->class];
        const int column = subset_column(subset, moved < 0 ? sped : moved, moved < 0);
        if (column < 0)
            return 0;
        const int at = m->numbers * column + formula->layout.motion_size * subset_place(subset, b) + number;
        const Ex e = m->slope[at];
        if (m->place[at] >= 0)
            return ex_input(dag, element_at(ARRAY_column, d->all->offset[s] + m->place[at]), NULL);
        if (formula->dag->node[e].op == OP_INPUT) {
            const int own = formula->dag->node[e].element->index % formula->layout.motion_size;
            return ex_input(dag, element_at(ARRAY_m, plan->motion_offset[b] + own), NULL);
        }
        return ex_literal(dag, formula_value(formula, e, class_place(&sequence->class[subset->class], s)));
    }
    return 0;
}

static Ex seed(const void *context, Dag *dag, Element element)
{
    const Differentiation *d = context;
    switch (element.array) {
    case ARRAY_y:
    case ARRAY_u:
    case ARRAY_p:
    case ARRAY_port: return ex_literal(dag, element.array == d->from.array && element.index == d->from.index);
    case ARRAY_e: return ex_literal(dag, d->from.array == ARRAY_y && d->from.index == 3 + element.index);
    case ARRAY_x: return ex_literal(dag, coordinate_of(d->plan, d->from, false) == element.index);
    case ARRAY_xd: return ex_literal(dag, coordinate_of(d->plan, d->from, true) == element.index);
    case ARRAY_m: return motion_slope(d, dag, element.index);
    case ARRAY_acc: return d->accelerations ? d->accelerations[element.index] : 0;
    default: return 0;
    }
}

/* Subtract the derivatives of what the bodies of a subset lack, by a column of it. */
static void subtract_residuals(const Differentiation *d, Dag *dag, int s, int column, Ex *right)
{
    const Plan *plan = d->plan;
    const Subset *subset = &plan->sequence->subset[s];
    const MotionColumns *m = d->all->motion[subset->class];
    for (int i = 0; i < m->rows; ++i) {
        const int place = motion_columns_residual(m, column, i);
        const int row = i >= 6 ? plan->coordinate_unknown[subset->dep[i - 6]] : plan->model->free_base ? i : -1;
        if (place >= 0 && row >= 0)
            right[row] =
                ex_sub(dag, right[row], ex_input(dag, element_at(ARRAY_column, d->all->offset[s] + place), NULL));
    }
}

/* Right-hand sides of one column, in right[]. b: applied forces less what follows accelerations that are inputs. True
 * where any is not 0. */
static bool push(const Differentiation *d, Dag *dag, const Ex *b, int lane, Block *out)
{
    const Seeds seeds = {.seed = seed, .context = d};
    const Plan *plan = d->plan;
    const int n = plan->unknowns, before = out->stores, twist = plan->free_coordinates + 10;
    const int moved = coordinate_of(plan, d->from, false), sped = coordinate_of(plan, d->from, true);
    const bool turns =
        plan->model->free_base && d->from.array == ARRAY_y && d->from.index >= twist && d->from.index < twist + 3;
    const Ex *slope = dag_slopes(dag, NULL, b, n, &seeds);
    Ex right[n + 1];
    for (int i = 0; i < n; ++i)
        right[i] = slope[b[i]];
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        if (subset->class < 0 || (moved < 0 && sped < 0 && !turns))
            continue;
        const int column = turns ? 2 * subset->deps + d->from.index - twist
                                 : subset_column(subset, moved < 0 ? sped : moved, moved < 0);
        if (column >= 0)
            subtract_residuals(d, dag, s, column, right);
    }
    for (int i = 0; i < n; ++i)
        if (!ex_is(dag, right[i], 0))
            block_store(out, right[i], element_of(ARRAY_right, lane, i));
    return out->stores > before;
}

/* What moves wheels, along one column. True where anything does. */
static bool push_wheels(const Differentiation *d, WheelColumns *w, int lane)
{
    const Seeds seeds = {.seed = seed, .context = d};
    const Block *link = &w->wheels->link;
    const int slow = d->plan->states, before = w->link.stores;
    Ex root[link->stores + 1];
    for (int i = 0; i < link->stores; ++i)
        root[i] = link->store[i].value;
    const Ex *slope = dag_slopes(link->dag, NULL, root, link->stores, &seeds);
    for (int i = 0; i < w->moving; ++i) {
        Element e = w->part[i];
        if (e.array == ARRAY_fast)
            e = element_at(ARRAY_y, slow + e.index);
        const Ex moved = e.array == ARRAY_link ? slope[root[e.index]] : seed(d, link->dag, e);
        d->moved[i] = !ex_is(link->dag, moved, 0);
        if (d->moved[i])
            block_store(&w->link, moved, element_of(ARRAY_part, lane, i));
    }
    return w->link.stores > before;
}

/* The derivatives of the rates by one column, with those of the accelerations in right[] and of fast rates in part[];
 * lane -1: these are 0. */
static Ex *pull(Differentiation *d, Dag *dag, const Block *rates, int lane)
{
    const Seeds seeds = {.seed = seed, .context = d};
    const int slow = d->plan->states, fast = d->plan->model->fast_states;
    Ex dz[d->plan->unknowns + 1], root[rates->stores + 1];
    Ex *out = pool_alloc(dag->pool, (size_t)(slow + fast + 1) * sizeof *out);
    for (int i = 0; i < fast && lane >= 0; ++i) {
        const Element e = element_at(ARRAY_rate, i);
        if (wheel_columns_moves(d->all->wheels, e, d->moved))
            out[slow + i] = ex_input(dag, element_of(ARRAY_part, lane, wheel_columns_part(d->all->wheels, e)), NULL);
    }
    for (int i = 0; i < d->plan->unknowns; ++i)
        dz[i] = lane < 0 ? 0 : ex_input(dag, element_of(ARRAY_right, lane, i), NULL);
    d->accelerations = dz;
    for (int i = 0; i < rates->stores; ++i)
        root[i] = rates->store[i].value;
    const Ex *slope = dag_slopes(dag, NULL, root, rates->stores, &seeds);
    for (int i = 0; i < rates->stores; ++i)
        out[rates->store[i].target.index] = slope[root[i]];
    return out;
}

/* What changes right-hand sides through wheels. */
static Ex wheel_seed(const void *context, Dag *dag, Element element)
{
    const WheelColumns *w = context;
    switch (element.array) {
    case ARRAY_self_grip: return wheel_columns_change(w, dag, element_at(ARRAY_grip, element.index));
    case ARRAY_self_watch: return wheel_columns_change(w, dag, element_at(ARRAY_watch, element.index));
    default: return 0;
    }
}

/* Add what wheels do to the right-hand sides z [n] of column c, and store the rates of fast states. */
static void add_wheels(const WheelColumns *w, Dag *dag, const Ex *b, int n, Ex *z, Block *solution)
{
    const Seeds seeds = {.seed = wheel_seed, .context = w};
    const Ex *slope = dag_slopes(dag, NULL, b, n, &seeds);
    for (int i = 0; i < n; ++i)
        z[i] = ex_add(dag, z[i], slope[b[i]]);
    for (int i = w->moving; i < w->parts; ++i)
        block_store(solution, wheel_columns_change(w, dag, w->part[i]), element_of(ARRAY_part, -1, i));
}

/* [nodes] those that depend on right[] or part[]. */
static const bool *follow_right(const Dag *dag)
{
    bool *follows = pool_alloc(dag->pool, (size_t)dag->nodes);
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        follows[e] =
            node->op == OP_INPUT && (node->element->array == ARRAY_right || node->element->array == ARRAY_part);
        for (int i = 0; node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i)
            follows[e] = follows[e] || follows[node->arg[i]];
    }
    return follows;
}

/* Does the loop over columns read it as it is? */
static bool is_local(const Dag *dag, Ex e)
{
    return dag->node[e].op == OP_INPUT && dag->node[e].element->array == ARRAY_local;
}

/* The solution of column c, in its place, of b [n] where there are wheels. What is the same for all columns is read
 * from factor[], where `residuals` stores it. Returns the number of these. */
static int solve_column(Dag *dag, const Factors *f, const Ex *b, const WheelColumns *w, Block *residuals,
                        Block *solution)
{
    const int n = f->n;
    Ex z[n + 1], *from = NULL, *to = NULL;
    int count = 0;
    *solution = (Block){.dag = dag};
    for (int i = 0; i < n; ++i)
        z[i] = ex_input(dag, element_of(ARRAY_right, -1, i), NULL);
    if (w)
        add_wheels(w, dag, b, n, z, solution);
    linear_solve(dag, f, z, z);
    for (int i = 0; i < n; ++i)
        block_store(solution, z[i], element_of(ARRAY_right, -1, i));
    Ex root[solution->stores + 1];
    for (int i = 0; i < solution->stores; ++i)
        root[i] = solution->store[i].value;
    const bool *follows = follow_right(dag), *needed = dag_needed(dag, root, solution->stores);
    bool *read = pool_alloc(dag->pool, (size_t)dag->nodes);
    for (int e = 0; e < dag->nodes; ++e)
        for (int i = 0; needed[e] && follows[e] && i < ex_arity((Op)dag->node[e].op); ++i)
            read[dag->node[e].arg[i]] = true;
    for (Ex e = 0; e < (Ex)dag->nodes; ++e)
        if (read[e] && !follows[e] && dag->node[e].level == LEVEL_VARIABLE && !is_local(dag, e)) {
            *POOL_PUSH(dag->pool, from, count) = e;
            block_store(residuals, e, element_at(ARRAY_factor, count - 1));
        }
    to = pool_alloc(dag->pool, ((size_t)count + 1) * sizeof *to);
    for (int i = 0; i < count; ++i)
        to[i] = ex_input(dag, element_at(ARRAY_factor, i), NULL);
    const Ex *image = dag_replace(dag, root, solution->stores, from, to, count);
    for (int i = 0; i < solution->stores; ++i)
        solution->store[i].value = image[root[i]];
    return count;
}

/* Columns of Euler parameters change the dependent one as well, so that their squares have the sum 1: share[i] is its
 * change less 1 where i is not the dependent one. That one's own column is 0. */
static void constrain(Whole *whole, Ex **column)
{
    Dag *dag = whole->dag;
    for (int r = 0; r < whole->plan->states + whole->model->fast_states; ++r) {
        Ex dependent = 0;
        for (int i = 0; i < 4; ++i)
            dependent =
                ex_add(dag, dependent, ex_mul(dag, ex_input(dag, element_at(ARRAY_which, i), NULL), column[3 + i][r]));
        for (int i = 0; i < 4; ++i) {
            const Ex share = ex_input(dag, element_at(ARRAY_share, i), NULL);
            column[3 + i][r] = ex_sub(dag, column[3 + i][r], ex_mul(dag, share, dependent));
        }
    }
}

/* acc[] from rate[]. */
static Ex *solved(Whole *whole)
{
    const Plan *plan = whole->plan;
    Ex alpha[3], a[3], *w2, *z = pool_alloc(whole->dag->pool, (size_t)(plan->unknowns + 1) * sizeof *z);
    whole_accelerations(whole, alpha, a, &w2);
    for (int i = 0; whole->model->free_base && i < 3; ++i) {
        z[i] = alpha[i];
        z[3 + i] = a[i];
    }
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_unknown[w] >= 0)
            z[plan->coordinate_unknown[w]] = w2[w];
    return z;
}

/* Put accelerations in the place of acc[] in what a block stores. */
static void set_accelerations(Block *block, const Ex *acc, const Ex *z, int n)
{
    Ex *root = pool_alloc(block->dag->pool, ((size_t)block->stores + 1) * sizeof *root);
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    const Ex *image = dag_replace(block->dag, root, block->stores, acc, z, n);
    for (int i = 0; i < block->stores; ++i)
        block->store[i].value = image[root[i]];
}

const RateColumns *rate_columns(Pool *pool, const Formulation *f, const bool *apart, int columns)
{
    const Plan *plan = f->plan;
    const Sequence *sequence = f->sequence;
    RateColumns *all = pool_alloc(pool, sizeof *all);
    if (plan->solve != SOLVE_REDUCED || plan->reduction)
        return NULL;
    *all = (RateColumns){.motion = subsets_columns(pool, sequence, plan->formula, f->model->free_base),
                         .offset = pool_alloc(pool, (size_t)sequence->subsets * sizeof(int))};
    if (!all->motion)
        return NULL;
    for (int s = 0; s < sequence->subsets; ++s) {
        all->offset[s] = all->size;
        all->size += sequence->subset[s].class < 0 ? 0 : all->motion[sequence->subset[s].class]->size;
    }
    Whole *whole = whole_new(pool, plan);
    Dag *dag = whole->dag;
    const int n = plan->unknowns, rows = plan->states + f->model->fast_states;
    Block rates = {.dag = dag};
    Ex b[n + 1], acc[n + 1], **column = pool_alloc(pool, ((size_t)columns + 1) * sizeof *column);
    const Factors *factors = dynamics_factors(whole, b);
    for (int i = 0; i < n; ++i)
        acc[i] = ex_input(dag, element_at(ARRAY_acc, i), NULL);
    whole_store_rates(whole, &rates, acc);
    all->wheels = f->wheels ? wheel_columns_new(pool, f, dag, b, n) : NULL;
    bool *moved = pool_alloc(pool, all->wheels ? (size_t)all->wheels->parts + 1 : 1);
    dag_section(dag, "derivatives");
    all->residuals = all->block = (Block){.dag = dag, .eager = true};
    for (int c = 0; c < columns; ++c)
        if (!apart[c]) {
            Differentiation d = {.all = all, .plan = plan, .from = origin_of(plan, c), .moved = moved};
            const bool rolls = all->wheels && push_wheels(&d, all->wheels, all->lanes);
            const int lane = push(&d, dag, b, all->lanes, &all->residuals) || rolls ? all->lanes++ : -1;
            column[c] = pull(&d, dag, &rates, lane);
        }
    all->factors = solve_column(dag, factors, b, all->wheels, &all->residuals, &all->solution);
    if (f->model->free_base)
        constrain(whole, column);
    for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rows && column[c]; ++r)
            if (!ex_is(dag, column[c][r], 0))
                block_store(&all->block, column[c][r], element_at(ARRAY_jacobian, columns * r + c));
    const Ex *z = solved(whole);
    set_accelerations(&all->block, acc, z, n);
    all->accelerations = (Block){.dag = dag};
    for (int i = 0; i < n; ++i)
        block_store(&all->accelerations, z[i], element_at(ARRAY_acc, i));
    return all;
}
