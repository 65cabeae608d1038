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
    bool *pushed;            /* [unknowns] right-hand sides that it changes, but by what wheels do */
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
    for (int i = 0; i < n; ++i) {
        d->pushed[i] = !ex_is(dag, right[i], 0);
        if (d->pushed[i])
            block_store(out, right[i], element_of(ARRAY_right, lane, i));
    }
    return out->stores > before;
}

/* ---- weighed columns: forces, each along its line ------------------------------------------------------------- */

typedef struct Weights {
    Whole *whole;
    int n, parts;      /* unknowns; rows of part[] */
    const Ex *M;       /* [n][n] upper triangle */
    const bool *reads; /* [n][parts] what of part[] right-hand sides follow */
    const Ex *lever;   /* [parts of loads][n] what right-hand sides have of a part of the loads */
    const bool *kept;  /* [states] rows that are wanted; NULL: all */
} Weights;

/* The state that is the rate of an unknown. Of the base's origin it is in world axes, the unknown in the base's. */
static int velocity_of(const Whole *whole, int unknown)
{
    const Plan *plan = whole->plan;
    if (whole->model->free_base && unknown < 6)
        return 7 + plan->free_coordinates + (unknown + 3) % 6;
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_unknown[w] == unknown)
            return plan->coordinate_rate[w];
    return -1;
}

static bool is_kept(const Weights *w, int state)
{
    return !w->kept || w->kept[state];
}

static Ex unit_seed(const void *context, Dag *dag, Element element)
{
    return ex_literal(dag, element_same(element, *(const Element *)context));
}

static const Ex *slopes_by(Dag *dag, const Ex *b, int n, Element by)
{
    const Seeds seeds = {.seed = unit_seed, .context = &by};
    return dag_slopes(dag, NULL, b, n, &seeds);
}

static const Ex *levers(const Whole *whole, const Ex *b, int n)
{
    Ex *lever = pool_alloc(whole->dag->pool, (size_t)(whole->loads->parts * n + 1) * sizeof *lever);
    for (int k = 0; k < whole->loads->parts; ++k) {
        const bool internal = whole->model->free_base && whole->loads->part[k].internal;
        const Ex *slope = slopes_by(whole->dag, b, n, element_at(ARRAY_cut, k));
        for (int i = internal ? 6 : 0; i < n; ++i)
            lever[n * k + i] = slope[b[i]];
    }
    return lever;
}

/* As push(), with lines of action that stand still: lever is the derivative of a right-hand side by a part of the
 * loads, as it is of that part's line by the unknown. */
static bool push_parts(const Differentiation *d, const Weights *w, const Ex *b, int lane, Block *out)
{
    const Seeds seeds = {.seed = seed, .context = d};
    const Loads *loads = w->whole->loads;
    Dag *dag = w->whole->dag;
    const int before = out->stores;
    Ex value[loads->parts + 1], right[w->n + 1];
    const Ex *by_input = slopes_by(dag, b, w->n, element_at(d->from.array, d->from.index));
    for (int i = 0; i < w->n; ++i)
        right[i] = d->from.array == ARRAY_u ? by_input[b[i]] : 0; /* accelerations that are inputs */
    for (int k = 0; k < loads->parts; ++k)
        value[k] = loads->part[k].value;
    const Ex *slope = dag_slopes(dag, NULL, value, loads->parts, &seeds);
    for (int k = 0; k < loads->parts; ++k)
        for (int i = 0; i < w->n; ++i)
            right[i] = ex_add(dag, right[i], ex_mul(dag, slope[value[k]], w->lever[w->n * k + i]));
    for (int i = 0; i < w->n; ++i) {
        if (!is_kept(w, velocity_of(w->whole, i)))
            right[i] = 0;
        d->pushed[i] = !ex_is(dag, right[i], 0);
        if (d->pushed[i])
            block_store(out, right[i], element_of(ARRAY_right, lane, i));
    }
    return out->stores > before;
}

/* ---- through wheels, and what accelerations do to rates ------------------------------------------------------- */

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

/* The derivatives of the rates by one column, with those of fast rates in part[], lane -1: these are 0; and with those
 * of the accelerations dz [unknowns]. */
static Ex *pull(Differentiation *d, Dag *dag, const Block *rates, const Ex *dz, int lane)
{
    const Seeds seeds = {.seed = seed, .context = d};
    const int slow = d->plan->states, fast = d->plan->model->fast_states;
    Ex root[rates->stores + 1];
    Ex *out = pool_alloc(dag->pool, (size_t)(slow + fast + 1) * sizeof *out);
    for (int i = 0; i < fast && lane >= 0; ++i) {
        const Element e = element_at(ARRAY_rate, i);
        if (wheel_columns_moves(d->all->wheels, e, d->moved))
            out[slow + i] = ex_input(dag, element_of(ARRAY_part, lane, wheel_columns_part(d->all->wheels, e)), NULL);
    }
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

/* The solution of column c, in its place, of b [n] where there are wheels; f NULL: with what wheels add, not solved.
 * What is the same for all columns is read from factor[], where `residuals` stores it. Returns the number of these. */
static int solve_column(Dag *dag, const Factors *f, const Ex *b, int n, const WheelColumns *w, Block *residuals,
                        Block *solution)
{
    Ex z[n + 1], right[n + 1], *from = NULL, *to = NULL;
    int count = 0;
    *solution = (Block){.dag = dag};
    for (int i = 0; i < n; ++i)
        z[i] = right[i] = ex_input(dag, element_of(ARRAY_right, -1, i), NULL);
    if (w)
        add_wheels(w, dag, b, n, z, solution);
    if (f)
        linear_solve(dag, f, z, z);
    for (int i = 0; i < n; ++i)
        if (f || z[i] != right[i])
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

/* ---- the mass matrix ------------------------------------------------------------------------------------------ */

/* Components of a vector along the base, at z[3], become those in world axes. */
static void turn_to_world(const Whole *whole, Ex *z)
{
    Ex turned[3];
    if (!whole->model->free_base)
        return;
    ex_apply(whole->dag, whole->R, z + 3, turned);
    for (int i = 0; i < 3; ++i)
        z[3 + i] = turned[i];
}

static bool *wheels_read(Dag *dag, const WheelColumns *w, const Ex *b, int n)
{
    const Seeds seeds = {.seed = wheel_seed, .context = w};
    const Ex *slope = dag_slopes(dag, NULL, b, n, &seeds);
    bool *reads = pool_alloc(dag->pool, (size_t)(n * w->parts) + 1);
    for (int i = 0; i < n; ++i) {
        const bool *needed = dag_needed(dag, &slope[b[i]], 1);
        for (int e = 0; e < dag->nodes; ++e)
            if (needed[e] && dag->node[e].op == OP_INPUT && dag->node[e].element->array == ARRAY_part)
                reads[w->parts * i + dag->node[e].element->index] = true;
    }
    return reads;
}

/* M with velocities as unknowns, rows in the order of the unknowns: T M T^T, T turning the base's. */
static Ex *turned_masses(const Weights *w)
{
    Dag *dag = w->whole->dag;
    const int n = w->n;
    Ex *G = pool_alloc(dag->pool, ((size_t)(n * n) + 1) * sizeof *G);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j)
            G[n * i + j] = w->M[i < j ? n * i + j : n * j + i];
        turn_to_world(w->whole, G + n * i);
    }
    for (int j = 0; j < n; ++j) {
        Ex column[n + 1];
        for (int i = 0; i < n; ++i)
            column[i] = G[n * i + j];
        turn_to_world(w->whole, column);
        for (int i = 0; i < n; ++i)
            G[n * i + j] = column[i];
    }
    return G;
}

/* In a column of rates, put forces in the place of accelerations: what right[] has, in world axes. */
static void weigh(const Weights *w, const Differentiation *d, int lane, Ex *column)
{
    Ex force[w->n + 1];
    for (int i = 0; i < w->n; ++i) {
        bool any = lane >= 0 && d->pushed[i];
        for (int k = 0; k < w->parts && lane >= 0; ++k)
            any = any || (w->reads[w->parts * i + k] && d->moved[k]);
        force[i] = any ? ex_input(w->whole->dag, element_of(ARRAY_right, lane, i), NULL) : 0;
    }
    turn_to_world(w->whole, force);
    for (int i = 0; i < w->n; ++i)
        column[velocity_of(w->whole, i)] = force[i];
}

static void store_masses(const Weights *w, const Ex *G, int first, RateColumns *all)
{
    const int n = w->n;
    all->mass_row = pool_alloc(w->whole->dag->pool, ((size_t)(n * n) + 1) * sizeof(int));
    all->mass_column = pool_alloc(w->whole->dag->pool, ((size_t)(n * n) + 1) * sizeof(int));
    for (int i = 0; i < n * n; ++i) {
        if (ex_is(w->whole->dag, G[i], 0) || !is_kept(w, velocity_of(w->whole, i / n)) ||
            !is_kept(w, velocity_of(w->whole, i % n)))
            continue;
        all->mass_row[all->masses] = velocity_of(w->whole, i / n);
        all->mass_column[all->masses] = velocity_of(w->whole, i % n);
        block_store(&all->block, G[i], element_at(ARRAY_jacobian, first + all->masses++));
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

bool rate_columns_weigh(Pool *pool, const Formulation *f)
{
    return f->plan->solve == SOLVE_REDUCED && !f->plan->reduction &&
           subsets_columns(pool, f->sequence, f->plan->formula, f->model->free_base, true);
}

const RateColumns *rate_columns(Pool *pool, const Formulation *f, const bool *apart, int columns, bool weighed,
                                const bool *kept)
{
    const Plan *plan = f->plan;
    const Sequence *sequence = f->sequence;
    RateColumns *all = pool_alloc(pool, sizeof *all);
    if (plan->solve != SOLVE_REDUCED || plan->reduction)
        return NULL;
    *all = (RateColumns){.motion = subsets_columns(pool, sequence, plan->formula, f->model->free_base, weighed),
                         .offset = pool_alloc(pool, (size_t)sequence->subsets * sizeof(int))};
    if (!all->motion)
        return NULL;
    for (int s = 0; s < sequence->subsets; ++s) {
        all->offset[s] = all->size;
        all->size += sequence->subset[s].class < 0 ? 0 : all->motion[sequence->subset[s].class]->size;
    }
    Whole *whole = whole_new(pool, plan);
    Dag *dag = whole->dag;
    whole->parted = weighed;
    const int n = plan->unknowns, rows = plan->states + f->model->fast_states;
    Block rates = {.dag = dag};
    Ex b[n + 1], acc[n + 1], **column = pool_alloc(pool, ((size_t)columns + 1) * sizeof *column);
    const Ex *M = dynamics_system(whole, b);
    const Factors *factors = weighed ? NULL : dynamics_factors(whole, M);
    for (int i = 0; i < n; ++i)
        acc[i] = ex_input(dag, element_at(ARRAY_acc, i), NULL);
    whole_store_rates(whole, &rates, acc);
    all->wheels = f->wheels ? wheel_columns_new(pool, f, dag, b, n) : NULL;
    bool *moved = pool_alloc(pool, all->wheels ? (size_t)all->wheels->parts + 1 : 1);
    Weights weights = {.whole = whole, .n = n, .M = M, .lever = weighed ? levers(whole, b, n) : NULL, .kept = kept};
    if (weighed && all->wheels) {
        weights.parts = all->wheels->parts;
        weights.reads = wheels_read(dag, all->wheels, b, n);
    }
    bool *pushed = pool_alloc(pool, (size_t)n + 1);
    dag_section(dag, "derivatives");
    all->residuals = all->block = (Block){.dag = dag, .eager = true};
    for (int c = 0; c < columns; ++c)
        if (!apart[c]) {
            Differentiation d = {
                .all = all, .plan = plan, .from = origin_of(plan, c), .moved = moved, .pushed = pushed};
            const bool rolls = all->wheels && push_wheels(&d, all->wheels, all->lanes);
            const bool pushes = weighed ? push_parts(&d, &weights, b, all->lanes, &all->residuals)
                                        : push(&d, dag, b, all->lanes, &all->residuals);
            const int lane = pushes || rolls ? all->lanes++ : -1;
            Ex dz[n + 1];
            for (int i = 0; i < n; ++i)
                dz[i] = weighed || lane < 0 ? 0 : ex_input(dag, element_of(ARRAY_right, lane, i), NULL);
            column[c] = pull(&d, dag, &rates, dz, lane);
            if (weighed)
                weigh(&weights, &d, lane, column[c]);
        }
    all->factors = solve_column(dag, factors, b, n, all->wheels, &all->residuals, &all->solution);
    if (f->model->free_base && column[3]) /* all four Euler parameters have columns, or none */
        constrain(whole, column);
    for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rows && column[c]; ++r)
            if (!ex_is(dag, column[c][r], 0) && is_kept(&weights, r))
                block_store(&all->block, column[c][r], element_at(ARRAY_jacobian, columns * r + c));
    if (weighed) {
        store_masses(&weights, turned_masses(&weights), columns * rows, all);
        return all;
    }
    const Ex *z = solved(whole);
    set_accelerations(&all->block, acc, z, n);
    all->accelerations = (Block){.dag = dag};
    for (int i = 0; i < n; ++i)
        block_store(&all->accelerations, z[i], element_at(ARRAY_acc, i));
    return all;
}
