/* SPDX-License-Identifier: MIT
 * Derivatives of a class's motions along a direction. Poses with a closed form are differentiated as they are computed.
 * Others solve Phi(q, x) = 0: along dx they turn and move by the twist -J^-1 Phi_x dx (implicit function theorem), one
 * linear solve with the factors that `solve` has anyway; Newton's iterations are not looked at. */
#include "expression/expression.h"
#include "subset/subset.h"
#include "subset/tangent.h"

#include <string.h>

bool motion_is_pose(int place)
{
    return place < MOTION_OMEGA || place >= MOTION_S;
}

static bool moves(const void *context, Element element)
{
    const Along *along = context;
    switch (element.array) {
    case ARRAY_x: return !along->still;
    case ARRAY_rate: return true;
    case ARRAY_known: return !along->still || !motion_is_pose(element.index);
    case ARRAY_turn: return !along->steady;
    case ARRAY_d: return along->tuned && !along->still;
    case ARRAY_q: return false;
    default: return false; /* times and starts */
    }
}

/* dq [7] of a body that moves by a small twist: of its place, and E^T omega / 2. */
static void pose_change(Dag *dag, const Ex *p, const Ex twist[6], Ex dq[7])
{
    Ex t[3], cross[3];
    ex_scale3(dag, ex_literal(dag, 0.5), twist, t);
    ex_cross(dag, t, p + 1, cross);
    for (int i = 0; i < 3; ++i) {
        dq[i] = twist[3 + i];
        dq[4 + i] = ex_add(dag, ex_mul(dag, p[0], t[i]), cross[i]);
    }
    dq[3] = ex_neg(dag, ex_dot(dag, t, p + 1));
}

/* Nodes whose derivatives are given: poses that Newton's iteration finds. */
static void give_poses(const Formula *formula, Seeds *seeds)
{
    Dag *dag = formula->dag;
    const Implicit *implicit = formula->implicit;
    const int n = implicit->n, places = 7 * formula->layout.bodies;
    Ex twist[n];
    Ex *node = pool_alloc(dag->pool, (size_t)(2 * places) * sizeof *node);
    Ex *slope = pool_alloc(dag->pool, (size_t)(2 * places) * sizeof *slope);
    dag_section(dag, "derivatives of the poses: what their equations lack, solved for the twists");
    const Ex *lack = dag_slopes(dag, &formula->solve, implicit->value, n, seeds);
    for (int r = 0; r < n; ++r)
        twist[r] = ex_neg(dag, lack[implicit->value[r]]);
    linear_solve(dag, implicit->factors, twist, twist);
    for (int i = 0; i < places; ++i) {
        node[i] = ex_input(dag, element_at(ARRAY_q, i), NULL);
        node[places + i] = implicit->found[i];
    }
    for (int b = 0; b < formula->layout.bodies; ++b) {
        pose_change(dag, node + 7 * b + 3, twist + 6 * b, slope + 7 * b);
        pose_change(dag, node + 7 * b + 3, twist + 6 * b, slope + places + 7 * b);
    }
    seeds->givens = 2 * places;
    seeds->given = node;
    seeds->slope = slope;
}

const Formula *formula_from_parts(const Formula *formula)
{
    enum { numbers = sizeof(BodyInertia) / sizeof(Ex) };
    Pool *pool = formula->dag->pool;
    const int roots = formula->layout.bodies * numbers;
    Ex *from = NULL, *to = NULL;
    int count = 0, counted = 0;
    Formula *own = pool_alloc(pool, sizeof *own);
    if (!formula->balanced || !formula->body)
        return formula;
    for (Ex e = 0; e < (Ex)formula->unbalanced; ++e)
        if (formula->balanced[e] != e) {
            *POOL_PUSH(pool, from, count) = e;
            *POOL_PUSH(pool, to, counted) = formula->balanced[e];
        }
    const Ex *body = (const Ex *)formula->body;
    const Ex *image = dag_replace(formula->dag, body, roots, from, to, count);
    *own = *formula;
    own->body = pool_alloc(pool, ((size_t)formula->layout.bodies + 1) * sizeof *own->body);
    for (int i = 0; i < roots; ++i)
        ((Ex *)own->body)[i] = image[body[i]];
    return own;
}

static void give(Dag *dag, GivenSlopes *g, const Ex *node, const Ex *slope, int count)
{
    int slopes = g->count;
    for (int i = 0; i < count; ++i)
        if (dag->node[node[i]].level == LEVEL_VARIABLE && dag->node[node[i]].op != OP_INPUT) {
            *POOL_PUSH(dag->pool, g->node, g->count) = node[i];
            *POOL_PUSH(dag->pool, g->slope, slopes) = slope[i];
        }
}

/* w x J - J w x, the change of J in base axes as its body turns. */
static void turn_inertia(Dag *dag, const Ex w[3], const Ex J[6], Ex out[6])
{
    static const int product[3][2] = {{0, 1}, {0, 2}, {1, 2}}; /* of J[3 + k] */
    Ex across[3][3];                                           /* w x the columns of J */
    const Ex column[3][3] = {{J[0], J[3], J[4]}, {J[3], J[1], J[5]}, {J[4], J[5], J[2]}};
    for (int k = 0; k < 3; ++k)
        ex_cross(dag, w, column[k], across[k]);
    for (int k = 0; k < 3; ++k) {
        out[k] = ex_add(dag, across[k][k], across[k][k]);
        out[3 + k] = ex_add(dag, across[product[k][1]][product[k][0]], across[product[k][0]][product[k][1]]);
    }
}

void give_twist(const Formula *f, int b, const Ex twist[6], GivenSlopes *g)
{
    Dag *dag = f->dag;
    const Motion *m = &f->motion[b];
    const BodyInertia *body = &f->body[b];
    Ex A[9], arm[3], at[3], J[6], column[3], t[3];
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i)
            column[i] = m->A[3 * i + k];
        ex_cross(dag, twist, column, t);
        for (int i = 0; i < 3; ++i)
            A[3 * i + k] = t[i];
    }
    ex_cross(dag, twist, body->arm, arm);
    ex_add3(dag, twist + 3, arm, at);
    turn_inertia(dag, twist, body->J, J);
    give(dag, g, m->A, A, 9);
    give(dag, g, m->c, twist + 3, 3);
    give(dag, g, body->arm, arm, 3);
    give(dag, g, body->at, at, 3);
    give(dag, g, body->J, J, 6);
}

/* Bodies that the coordinates alone move, move by S dx. Directions that a closed form has of the same vectors turn with
 * them. */
static void give_moves(const Formula *formula, Seeds *seeds)
{
    Dag *dag = formula->dag;
    GivenSlopes g = {0};
    dag_section(dag, "derivatives of the poses: twists, of unit velocities");
    for (int b = 0; b < formula->layout.bodies; ++b) {
        const Motion *m = &formula->motion[b];
        Ex twist[6] = {0}, t[6];
        for (int j = 0; j < m->deps; ++j) {
            const Element dx = {.array = ARRAY_x, .index = j, .slope = true};
            for (int i = 0; i < 6; ++i)
                t[i] = ex_mul(dag, ex_input(dag, dx, NULL), m->S[6 * j + i]);
            ex_add3(dag, twist, t, twist);
            ex_add3(dag, twist + 3, t + 3, twist + 3);
        }
        give_twist(formula, b, twist, &g);
        for (int i = 0; i < m->images; ++i) {
            if (m->image[i].side)
                continue;
            ex_cross(dag, twist, m->image[i].v, t);
            give(dag, &g, m->image[i].v, t, 3);
        }
    }
    seeds->givens = g.count;
    seeds->given = g.node;
    seeds->slope = g.slope;
}

const Ex *subset_slopes(const Formula *formula, const Seeds *seeds, const Ex *root, int roots)
{
    Pool *pool = formula->dag->pool;
    Seeds own = *seeds;
    if (formula->implicit) {
        own.givens = 0;
        give_poses(formula, &own);
        const int poses = own.givens, all = poses + seeds->givens;
        Ex *node = pool_alloc(pool, (size_t)(all + 1) * sizeof *node);
        Ex *slope = pool_alloc(pool, (size_t)(all + 1) * sizeof *slope);
        for (int i = 0; i < all; ++i) {
            node[i] = i < poses ? own.given[i] : seeds->given[i - poses];
            slope[i] = i < poses ? own.slope[i] : seeds->slope[i - poses];
        }
        own.givens = all;
        own.given = node;
        own.slope = slope;
    }
    return dag_slopes(formula->dag, &formula->solve, root, roots, &own);
}

const Ex *subset_read_stored(const Formula *formula, const Ex *root, int roots)
{
    Dag *dag = formula->dag;
    const Block *solve = &formula->solve;
    Ex from[solve->stores + 1], to[solve->stores + 1];
    int stored = 0;
    for (int i = 0; i < solve->stores && formula->closed;
         ++i) { /* others are found at poses that differ by roundings */
        const Store *store = &solve->store[i];
        const Node *node = &dag->node[store->value];
        const bool kept = store->target.array == ARRAY_motion || store->target.array == ARRAY_inertia;
        if (!kept || node->level < LEVEL_VARIABLE || node->op == OP_INPUT)
            continue;
        from[stored] = store->value;
        to[stored++] = ex_input(dag, store->target, NULL);
    }
    return dag_replace(dag, root, roots, from, to, stored);
}

Seeds subset_seeds(const Formula *formula, const Along *along)
{
    Seeds seeds = {.moves = moves, .context = along};
    if (formula->implicit)
        give_poses(formula, &seeds);
    else if (along->alone && !along->still)
        give_moves(formula, &seeds);
    return seeds;
}

/* The stored factor that says which one of two reflections (factorize_block.c) `solve` took: 1 / -(+-|x|) where its
 * sign depends on `condition`, x[0]. 0: there is none. */
static Ex sign_of_reflection(const Formula *formula, Ex condition)
{
    Dag *dag = formula->dag;
    for (int i = 0; i < formula->solve.stores; ++i) {
        const Store *store = &formula->solve.store[i];
        const int slot = store->target.index - formula->layout.start_factors;
        const Node *node = &dag->node[store->value];
        if (store->target.array != ARRAY_start || slot < 0 || node->op != OP_DIV)
            continue;
        const bool minus = dag->node[node->arg[1]].op == OP_NEG;
        const Node *length = &dag->node[minus ? dag->node[node->arg[1]].arg[0] : node->arg[1]];
        if (length->op != OP_POSITIVE || length->arg[0] != condition)
            continue;
        const Ex stored = ex_input(dag, element_at(ARRAY_f, slot), NULL);
        return minus ? ex_neg(dag, stored) : stored;
    }
    return 0;
}

/* The roots with the reflections that `solve` took, which wrote its factors. Where x[0] is 0 but for roundings, as in
 * mechanisms that are drawn in a plane, another one would come as soon: derivatives of its factors are none of those.
 */
static void keep_reflections(const Formula *formula, Ex *root, int roots)
{
    Dag *dag = formula->dag;
    const bool *needed = dag_needed(dag, root, roots);
    const Ex nodes = (Ex)dag->nodes;
    Ex *choice = NULL;
    int choices = 0;
    for (Ex e = 0; e < nodes; ++e)
        if (needed[e] && dag->node[e].op == OP_POSITIVE && sign_of_reflection(formula, dag->node[e].arg[0]))
            *POOL_PUSH(dag->pool, choice, choices) = e;
    Ex *all = pool_alloc(dag->pool, (size_t)(roots + choices + 1) * sizeof *all);
    memcpy(all, root, (size_t)roots * sizeof *all);
    for (int i = 0; i < choices; ++i)
        all[roots + i] = choice[i];
    for (int i = 0; i < choices; ++i) { /* later ones depend on earlier ones */
        const Ex from = all[roots + i];
        const Ex to = ex_op(dag, OP_POSITIVE, sign_of_reflection(formula, dag->node[choice[i]].arg[0]),
                            dag->node[from].arg[1], dag->node[from].arg[2]);
        const Ex *image = dag_replace(dag, all, roots + choices, &from, &to, 1);
        for (int r = 0; r < roots + choices; ++r)
            all[r] = image[all[r]];
    }
    memcpy(root, all, (size_t)roots * sizeof *root);
}

/* Without the stores of a block that are not wanted. */
static void drop_stores(const Formula *formula, TangentStores stores, Block *block)
{
    const int factors = formula->react.stores ? formula->layout.start_factors : -1;
    int left = 0;
    for (int i = 0; i < block->stores; ++i) {
        const Element target = block->store[i].target;
        const bool factor = target.array == ARRAY_start && factors >= 0 && target.index >= factors;
        const bool inertia = target.array == ARRAY_inertia && !(stores == TANGENT_MOTIONS && target.slope);
        if (target.array == ARRAY_motion || factor || inertia)
            block->store[left++] = block->store[i];
    }
    block->stores = left;
}

const Block *subset_tangent(const Formula *balanced, const Along *along, TangentStores stores)
{
    const Formula *formula = formula_from_parts(balanced);
    Dag *dag = formula->dag;
    const Seeds seeds = subset_seeds(formula, along);
    Block *block = block_tangent(&formula->solve, &seeds, stores != TANGENT_AFTER, NULL);
    drop_stores(formula, stores, block);
    if (stores != TANGENT_AFTER)
        return block;
    Ex *root = pool_alloc(dag->pool, ((size_t)block->stores + 1) * sizeof *root);
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    if (formula->react.stores)
        keep_reflections(formula, root, block->stores);
    const Ex *image = subset_read_stored(formula, root, block->stores);
    for (int i = 0; i < block->stores; ++i)
        block->store[i].value = image[root[i]];
    return block;
}
