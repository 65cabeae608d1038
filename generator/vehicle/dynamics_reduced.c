/* SPDX-License-Identifier: MIT
 * Equations of motion in the reduced form (Serban and Haug 2000, Proposition 2.1, in twists), and their solution.
 *
 * Unknowns: alpha and a of a free base (base frame; a is the acceleration of its origin less gravity), then the free
 * coordinates' accelerations. The subsets have already summed up their bodies: what is left is the composite inertia,
 * one row a coordinate, and an elimination that takes the suspension coordinates first, because they couple only to the
 * base. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/dynamics.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* A pivot of the mass matrix may be this many times smaller than its diagonal entry. It has then lost that many times
 * 2.2e-16 in accuracy; a dozen such roundings add up in accelerations, which are promised to 1e-8 (FORMAT.md section
 * 14). */
static const double most_loss = 1e6;

void dynamics_add(const Summation *now, Ex *sum, int subset, int offset, int count)
{
    const Plan *plan = now->whole->plan;
    Dag *dag = now->whole->dag;
    const int class = plan->sequence->subset[subset].class;
    const Formula *formula = plan->formula[class];
    for (int i = offset; i < offset + count; ++i) {
        Ex e = formula->inertia[i];
        if (formula_is_constant(formula, e) != now->settled)
            continue;
        if (now->settled && !now->whole->open)
            e = ex_literal(dag, formula_value(formula, e, class_place(&plan->sequence->class[class], subset)));
        else
            e = ex_input(dag, element_at(ARRAY_n, plan->inertia_offset[subset] + plan->stride[subset] * i), NULL);
        sum[i - offset] = ex_add(dag, sum[i - offset], e);
    }
}

/* The base body alone: a rigid body at rest in its own frame. */
static void add_base(Whole *whole, Composite *c)
{
    Dag *dag = whole->dag;
    const Body *base = &whole->model->body[BODY_BASE];
    Ex x[3], J[6], t[3], total = 0;
    for (int b = 0; b < whole->model->bodies; ++b)
        if (whole_carrier(whole, b) == BODY_BASE)
            total = ex_add(dag, total, whole_number(whole, &whole->model->body[b].mass));
    c->mass = total;
    Ex mass = whole_number(whole, &base->mass), square[3];
    for (int i = 0; i < 3; ++i) {
        x[i] = whole_number(whole, &base->com[i]);
        square[i] = ex_mul(dag, x[i], x[i]);
        c->first[i] = ex_add(dag, c->first[i], ex_mul(dag, mass, x[i]));
    }
    whole_inertia(whole, BODY_BASE, J);
    for (int i = 0; i < 3; ++i) {
        static const int product[3][2] = {{0, 1}, {0, 2}, {1, 2}};
        int j = product[i][0], k = product[i][1];
        J[i] = ex_add(dag, J[i], ex_mul(dag, mass, ex_add(dag, square[i == 0], square[i == 2 ? 1 : 2])));
        J[3 + i] = ex_add(dag, J[3 + i], ex_mul(dag, ex_mul(dag, ex_neg(dag, mass), x[j]), x[k]));
    }
    for (int i = 0; i < 6; ++i)
        c->second[i] = ex_add(dag, c->second[i], J[i]);
    /* m turn x (turn x com), and turn x (J turn) about the origin */
    ex_cross(dag, whole->turn, x, t);
    Ex force[3], moment[3];
    ex_cross(dag, whole->turn, t, force);
    ex_scale3(dag, mass, force, force);
    ex_add3(dag, c->force, force, c->force);
    ex_apply(dag, (Ex[]){J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, whole->turn, t);
    ex_cross(dag, whole->turn, t, moment);
    ex_add3(dag, c->moment, moment, c->moment);
}

static void add_subset(const Summation *now, Composite *c, int s)
{
    const Model *model = now->whole->model;
    const Subset *subset = &now->whole->plan->sequence->subset[s];
    if (model->free_base) {
        dynamics_add(now, c->first, s, INERTIA_FIRST, 3);
        dynamics_add(now, c->second, s, INERTIA_SECOND, 6);
        dynamics_add(now, c->force, s, INERTIA_FORCE, 3);
        dynamics_add(now, c->moment, s, INERTIA_MOMENT, 3);
    }
    for (int j = 0; j < subset->deps; ++j) {
        dynamics_add(now, c->coupling[subset->dep[j]], s, INERTIA_COORDINATE + 7 * j, 7);
        for (int k = j; k < subset->deps; ++k) {
            int row = subset->dep[j], column = subset->dep[k];
            if (row > column)
                row = subset->dep[k], column = subset->dep[j];
            dynamics_add(now, &c->M[row * model->coordinates + column], s, inertia_mass(subset->deps, j, k), 1);
        }
    }
}

Composite dynamics_compose(Whole *whole)
{
    const Sequence *sequence = whole->plan->sequence;
    Dag *dag = whole->dag;
    size_t p = (size_t)whole->model->coordinates;
    Composite c = {.coupling = pool_alloc(dag->pool, (p + 1) * sizeof *c.coupling),
                   .M = pool_alloc(dag->pool, (p * p + 1) * sizeof *c.M)};
    /* constants first, so that they fold */
    for (int settled = 1; settled >= 0; --settled)
        for (int s = 0; s < sequence->subsets; ++s)
            if (sequence->subset[s].class >= 0 && sequence->subset[s].carrier == BODY_BASE)
                add_subset(&(Summation){whole, settled}, &c, s);
    if (whole->model->free_base)
        add_base(whole, &c);
    return c;
}

static Ex mass_entry(const Whole *whole, const Composite *c, int i, int j)
{
    return c->M[i < j ? i * whole->model->coordinates + j : j * whole->model->coordinates + i];
}

/* Accelerations of the driven coordinates, which are inputs; 0 for the others. */
Ex *whole_driven_accelerations(Whole *whole)
{
    const Model *model = whole->model;
    Ex *w2 = pool_alloc(whole->dag->pool, (size_t)(model->coordinates + 1) * sizeof *w2);
    for (int i = 0; i < model->coordinates; ++i)
        if (model->coordinate[i].driven)
            w2[i] = ex_input(whole->dag, element_at(ARRAY_u, model->coordinate[i].input + 2), NULL);
    return w2;
}

void dynamics_matrix(Whole *whole, const Composite *c, Ex *M, int n)
{
    Dag *dag = whole->dag;
    if (whole->model->free_base) {
        static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
        for (int i = 0; i < 3; ++i) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            for (int l = i; l < 3; ++l)
                M[n * i + l] = c->second[place[i][l]];
            M[n * (3 + i) + 3 + i] = c->mass;
            /* moment of a linear acceleration: first x a */
            M[n * i + 3 + k] = c->first[j];
            M[n * i + 3 + j] = ex_neg(dag, c->first[k]);
        }
    }
    for (int w = 0; w < whole->model->coordinates; ++w) {
        int column = whole->plan->coordinate_unknown[w];
        if (column < 0)
            continue;
        for (int i = 0; whole->model->free_base && i < 3; ++i) {
            M[n * i + column] = c->coupling[w][3 + i];
            M[n * (3 + i) + column] = c->coupling[w][i];
        }
        for (int other = 0; other <= w; ++other)
            if (whole->plan->coordinate_unknown[other] >= 0)
                M[n * whole->plan->coordinate_unknown[other] + column] = mass_entry(whole, c, other, w);
    }
}

void dynamics_right(Whole *whole, const Composite *c, const Loads *loads, const Ex *driven, Ex *b)
{
    Dag *dag = whole->dag;
    const Model *model = whole->model;
    if (model->free_base) {
        ex_sub3(dag, loads->moment, c->moment, b);
        ex_sub3(dag, loads->force, c->force, b + 3);
    }
    Ex minus_gravity[3];
    ex_sub3(dag, (Ex[3]){0}, whole->gravity, minus_gravity);
    for (int w = 0; w < model->coordinates; ++w) {
        Ex t[3];
        if (model->coordinate[w].driven && model->free_base) {
            ex_scale3(dag, driven[w], c->coupling[w] + 3, t);
            ex_sub3(dag, b, t, b);
            ex_scale3(dag, driven[w], c->coupling[w], t);
            ex_sub3(dag, b + 3, t, b + 3);
        }
        int row = whole->plan->coordinate_unknown[w];
        if (row < 0)
            continue;
        b[row] = ex_sub(dag, loads->along[w], c->coupling[w][6]);
        if (!model->free_base) /* a fixed base accelerates against gravity, which is known */
            b[row] = ex_sub(dag, b[row], ex_dot(dag, c->coupling[w], minus_gravity));
        for (int d = 0; d < model->coordinates; ++d)
            if (model->coordinate[d].driven)
                b[row] = ex_sub(dag, b[row], ex_mul(dag, mass_entry(whole, c, w, d), driven[d]));
    }
}

static void store_base_rates(Whole *whole, Block *block, const Ex *z)
{
    Dag *dag = whole->dag;
    int twist = 7 + whole->plan->free_coordinates;
    Ex half = ex_literal(dag, 0.5), t[3], cross[3], a[3];
    for (int i = 0; i < 3; ++i)
        block_store(block, whole->v[i], element_at(ARRAY_rate, i));
    /* components in the base frame: e' = (e0 omega + e x omega) / 2 */
    ex_scale3(dag, half, whole->turn, t);
    block_store(block, ex_neg(dag, ex_dot(dag, t, whole->e + 1)), element_at(ARRAY_rate, 3));
    ex_cross(dag, whole->e + 1, t, cross);
    for (int i = 0; i < 3; ++i)
        block_store(block, ex_add(dag, ex_mul(dag, whole->e[0], t[i]), cross[i]), element_at(ARRAY_rate, 4 + i));
    ex_apply(dag, whole->R, z + 3, a);
    for (int i = 0; i < 3; ++i) {
        block_store(block, ex_add(dag, a[i], whole_number(whole, &whole->model->gravity[i])),
                    element_at(ARRAY_rate, twist + i));
        block_store(block, z[i], element_at(ARRAY_rate, twist + 3 + i));
    }
}

void whole_store_rates(Whole *whole, Block *block, const Ex *z)
{
    const Plan *plan = whole->plan;
    if (whole->model->free_base)
        store_base_rates(whole, block, z);
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_state[w] >= 0) {
            block_store(block, whole->xd[w], element_at(ARRAY_rate, plan->coordinate_state[w]));
            block_store(block, z[plan->coordinate_unknown[w]], element_at(ARRAY_rate, plan->coordinate_rate[w]));
        }
}

/* Coordinates of parts that are alike come first: they are eliminated side by side. NULL: cheapest first. *blocked:
 * number of pivots at the end that are eliminated in blocks, where single divisions would wait for each other. */
static const int *elimination_order(const Whole *whole, int n, int *blocked)
{
    const Plan *plan = whole->plan;
    int *order = NULL, count = 0;
    *blocked = n < 6 ? n : 6;
    for (int alike = 1; plan->pack && alike >= 0; --alike) {
        *blocked = n - count;
        for (int i = 0; !alike && whole->model->free_base && i < 6; ++i)
            *POOL_PUSH(whole->dag->pool, order, count) = i;
        for (int w = 0; w < whole->model->coordinates; ++w)
            if (plan->coordinate_unknown[w] >= 0 && (plan->coordinate_track[w] >= 0) == alike)
                *POOL_PUSH(whole->dag->pool, order, count) = plan->coordinate_unknown[w];
    }
    return order;
}

/* Add up equations and unknowns that belong together: P^T M P and P^T b for z = P u. */
static void reduce(Dag *dag, const Reduction *r, int n, Ex **M, Ex **b)
{
    const int m = r->unknowns;
    Ex *sum = pool_alloc(dag->pool, ((size_t)m * (size_t)m + 1) * sizeof *sum);
    Ex *right = pool_alloc(dag->pool, ((size_t)m + 1) * sizeof *right);
    for (int i = 0; i < n; ++i) {
        if (r->of[i] < 0)
            continue;
        Ex *own = &right[r->of[i]];
        *own = ex_add(dag, *own, ex_mul(dag, ex_literal(dag, r->sign[i]), (*b)[i]));
        for (int j = 0; j < n; ++j) {
            if (r->of[j] < r->of[i])
                continue;
            Ex *entry = &sum[m * r->of[i] + r->of[j]], part = (*M)[i < j ? n * i + j : n * j + i];
            *entry = ex_add(dag, *entry, ex_mul(dag, ex_literal(dag, r->sign[i] * r->sign[j]), part));
        }
    }
    *M = sum;
    *b = right;
}

static Ex *expand(Dag *dag, const Reduction *r, int n, const Ex *u)
{
    Ex *z = pool_alloc(dag->pool, ((size_t)n + 1) * sizeof *z);
    for (int i = 0; i < n; ++i)
        z[i] = r->of[i] < 0 ? 0 : ex_mul(dag, ex_literal(dag, r->sign[i]), u[r->of[i]]);
    return z;
}

/* The first unknown with this index in the smaller system; without a reduction the index itself. */
static int first_unknown(const Plan *plan, int number)
{
    for (int i = 0; plan->reduction && i < plan->unknowns; ++i)
        if (plan->reduction->of[i] == number)
            return i;
    return number;
}

void dynamics_check(Whole *whole, Block *block, int unknown, Ex left, Ex whole_of_it)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    /* an inertia from which nothing was subtracted needs to be positive only */
    const Ex least = left == whole_of_it ? 0 : ex_mul(dag, ex_literal(dag, 1 / most_loss), whole_of_it);
    const Ex more = ex_sub(dag, left, least);
    int subset = -1, state = -1;
    if (dag->node[more].level < LEVEL_VARIABLE && ex_value(dag, more, 0) > 0)
        return;
    /* the state has linear before angular velocity */
    if (whole->model->free_base && unknown < 6)
        state = 7 + plan->free_coordinates + (unknown + 3) % 6;
    for (int s = 0; s < plan->sequence->subsets; ++s)
        for (int i = 0; i < plan->sequence->subset[s].coordinates; ++i) {
            const int w = plan->sequence->subset[s].coordinate[i];
            if (plan->coordinate_unknown[w] == unknown) {
                subset = s;
                state = plan->coordinate_state[w];
            }
        }
    block_check_about(block, more, GIC_ERROR_MASS, subset, state);
}

/* Checks the loss of digits. A pivot is the inertia that remains along its unknown if the earlier ones may move freely,
 * its diagonal entry the inertia if they may not: their ratio magnifies roundings. For a block B of pivots, 1 over an
 * entry of the diagonal of B^-1 = adj B / det B is the inertia that remains along that unknown if the others of the
 * block may move freely too; det B is a sum of products as large as that of B's diagonal, and has their roundings. */
static void check_pivots(Whole *whole, Block *block, int n, const Ex *M, const Factors *f)
{
    Dag *dag = whole->dag;
    for (int k = 0, end; k < n; k = end) {
        Ex product = f->pivot[k];
        for (end = k + 1; end < n && f->block[end] == k; ++end)
            product = ex_mul(dag, product, f->pivot[end]);
        for (int own = end - 1; own >= k; --own) { /* of two with the same loss the later one is reported, as without
                                                    * blocks */
            const Ex entry = M[n * f->row[own] + f->row[own]];
            dynamics_check(whole, block, first_unknown(whole->plan, f->row[own]), f->determinant[k],
                           end - k > 1 ? ex_mul(dag, entry, f->entry[n * own + own]) : entry);
        }
        if (end - k > 2)
            dynamics_check(whole, block, first_unknown(whole->plan, f->row[k]), f->determinant[k], product);
    }
}

Block *dynamics_block(Whole *whole)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    block->model = whole->model->name;
    int n = plan->unknowns;
    Ex *M = pool_alloc(dag->pool, ((size_t)n * (size_t)n + 1) * sizeof *M);
    Ex *z = pool_alloc(dag->pool, (size_t)(n + 1) * sizeof *z);
    dag_section(dag, "composite inertia: mass, first and second moments of all bodies, what each coordinate couples");
    Composite c = dynamics_compose(whole);
    dynamics_matrix(whole, &c, M, n);
    const Loads *loads = loads_make(whole);
    block_loads(block, loads->moment, 3);
    block_loads(block, loads->force, 3);
    block_loads(block, loads->along, whole->model->coordinates);
    dag_section(dag, "right-hand side: applied forces less the quadratic-velocity terms (Proposition 2.1)");
    dynamics_right(whole, &c, loads, whole_driven_accelerations(whole), z);
    if (plan->reduction) {
        reduce(dag, plan->reduction, n, &M, &z);
        n = plan->reduction->unknowns;
    }
    int blocked;
    const int *order = elimination_order(whole, n, &blocked);
    dag_section(dag, "mass matrix: elimination of the coordinates' accelerations, then the base equations");
    const Factors *factors = linear_factor_symmetric(dag, n, M, order, blocked);
    check_pivots(whole, block, n, M, factors);
    dag_section(dag, "accelerations");
    linear_solve(dag, factors, z, z);
    dag_section(dag, "rates of the state");
    whole_store_rates(whole, block, plan->reduction ? expand(dag, plan->reduction, plan->unknowns, z) : z);
    return block;
}

/* ---- the same equations a second time, body by body: what the emitted self-test compares with ------------------- */

/* Newton's and Euler's equations body by body, projected on the coordinates: shares nothing with dynamics_compose(). */
typedef struct Projection {
    Ex moment[3], force[3], *along;
} Projection;

void whole_inertial_wrench(Whole *whole, int b, const Ex alpha[3], const Ex a[3], const Ex *w2, Ex wrench[6])
{
    Dag *dag = whole->dag;
    const Body *body = &whole->model->body[b];
    Ex J[6], acceleration[3], angular[3], total[3], t[3], *moment = wrench, *force = wrench + 3;
    Vector com = whole_point(whole, b, body->com);
    whole_inertia(whole, b, J);
    const Ex matrix[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]};
    whole_acceleration(whole, b, &com, alpha, a, w2, acceleration);
    whole_angular_acceleration(whole, b, alpha, w2, angular);
    ex_scale3(dag, whole_number(whole, &body->mass), acceleration, force);
    ex_add3(dag, whole->turn, whole->motion[b].omega, total);
    ex_apply(dag, matrix, total, t);
    ex_cross(dag, total, t, moment);
    ex_apply(dag, matrix, angular, t);
    ex_add3(dag, moment, t, moment);
    ex_cross(dag, com.arm, force, t);
    ex_add3(dag, moment, t, moment);
}

static void project_body(Whole *whole, int b, const Ex alpha[3], const Ex a[3], const Ex *w2, Ex wrench[6],
                         Projection *out)
{
    Dag *dag = whole->dag;
    Ex t[3], *moment = wrench, *force = wrench + 3;
    dag_section(dag, pool_print(dag->pool, "inertia of %s", whole->model->body[b].name));
    whole_inertial_wrench(whole, b, alpha, a, w2, wrench);
    ex_cross(dag, whole->motion[b].c, force, t);
    ex_add3(dag, t, moment, t);
    ex_add3(dag, out->moment, t, out->moment);
    ex_add3(dag, out->force, force, out->force);
    for (int j = 0; b != BODY_BASE && j < whole_subset(whole, b)->deps; ++j) {
        const Ex *S = whole->motion[b].S + 6 * j;
        Ex *along = &out->along[whole_subset(whole, b)->dep[j]];
        *along = ex_add(dag, *along, ex_add(dag, ex_dot(dag, moment, S), ex_dot(dag, force, S + 3)));
    }
}

static Projection project(Whole *whole, const Loads *loads, const Ex alpha[3], const Ex a[3], const Ex *w2)
{
    Dag *dag = whole->dag;
    Projection p = {.along = pool_alloc(dag->pool, (size_t)(whole->model->coordinates + 1) * sizeof(Ex))};
    Ex(*wrench)[6] = pool_alloc(dag->pool, (size_t)whole->model->bodies * sizeof *wrench);
    for (int b = whole->model->free_base ? 0 : 1; b < whole->model->bodies; ++b)
        project_body(whole, b, alpha, a, w2, wrench[b], &p);
    whole_hand_on(whole, (const Ex(*)[6])wrench, p.along);
    ex_sub3(dag, p.moment, loads->moment, p.moment);
    ex_sub3(dag, p.force, loads->force, p.force);
    for (int w = 0; w < whole->model->coordinates; ++w)
        p.along[w] = ex_sub(dag, p.along[w], loads->along[w]);
    return p;
}

const Ex *dynamics_system(Whole *whole, Ex *b)
{
    Dag *dag = whole->dag;
    const int n = whole->plan->unknowns;
    Ex *M = pool_alloc(dag->pool, ((size_t)n * (size_t)n + 1) * sizeof *M);
    const Composite c = dynamics_compose(whole);
    dynamics_matrix(whole, &c, M, n);
    dynamics_right(whole, &c, loads_make(whole), whole_driven_accelerations(whole), b);
    return M;
}

const Factors *dynamics_factors(Whole *whole, const Ex *M)
{
    const int n = whole->plan->unknowns;
    int blocked;
    const int *order = elimination_order(whole, n, &blocked);
    return linear_factor_symmetric(whole->dag, n, M, order, blocked);
}

Block *inverse_block(Whole *whole)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    Ex alpha[3] = {0}, a[3], *w2 = whole_driven_accelerations(whole);
    ex_sub3(dag, (Ex[3]){0}, whole->gravity, a);
    for (int i = 0; whole->model->free_base && i < 3; ++i) {
        alpha[i] = ex_input(dag, element_at(ARRAY_acc, i), NULL);
        a[i] = ex_input(dag, element_at(ARRAY_acc, 3 + i), NULL);
    }
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_unknown[w] >= 0)
            w2[w] = ex_input(dag, element_at(ARRAY_acc, plan->coordinate_unknown[w]), NULL);
    Projection p = project(whole, loads_make(whole), alpha, a, w2);
    for (int i = 0; whole->model->free_base && i < 3; ++i) {
        block_store(block, p.moment[i], element_at(ARRAY_tau, i));
        block_store(block, p.force[i], element_at(ARRAY_tau, 3 + i));
    }
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_unknown[w] >= 0)
            block_store(block, p.along[w], element_at(ARRAY_tau, plan->coordinate_unknown[w]));
    return block;
}

/* Accelerations at rate[]: alpha, a less gravity (base frame), those of all coordinates. */
void whole_accelerations(Whole *whole, Ex alpha[3], Ex a[3], Ex **w2)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    int twist = 7 + plan->free_coordinates;
    Ex world[3];
    ex_zero3(dag, alpha);
    ex_sub3(dag, (Ex[3]){0}, whole->gravity, a);
    if (whole->model->free_base) {
        for (int i = 0; i < 3; ++i) {
            alpha[i] = ex_input(dag, element_at(ARRAY_rate, twist + 3 + i), NULL);
            Ex total = ex_input(dag, element_at(ARRAY_rate, twist + i), NULL);
            world[i] = ex_sub(dag, total, whole_number(whole, &whole->model->gravity[i]));
        }
        ex_apply_transposed(dag, whole->R, world, a);
    }
    *w2 = whole_driven_accelerations(whole);
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (plan->coordinate_rate[w] >= 0)
            (*w2)[w] = ex_input(dag, element_at(ARRAY_rate, plan->coordinate_rate[w]), NULL);
}

Ex whole_drive_force(Whole *whole, int coordinate)
{
    Ex alpha[3], a[3], *w2;
    whole_accelerations(whole, alpha, a, &w2);
    return project(whole, loads_make(whole), alpha, a, w2).along[coordinate];
}

Ex whole_power(Whole *whole, const Loads *loads)
{
    Dag *dag = whole->dag;
    Ex power = loads->power;
    for (int w = 0; w < whole->model->coordinates; ++w)
        if (whole->model->coordinate[w].driven)
            power = ex_add(dag, power, ex_mul(dag, whole_drive_force(whole, w), whole->xd[w]));
    return power;
}

static Ex magnitude(Dag *dag, Ex e)
{
    return ex_op(dag, OP_ABS, e, 0, 0);
}

/* Sum of the magnitudes of the terms of a point's acceleration; *angular: the same of the angular acceleration. */
static Ex acceleration_size(Whole *whole, int b, const Vector *point, const Ex alpha[3], const Ex a[3], const Ex *w2,
                            Ex *angular)
{
    Dag *dag = whole->dag;
    const Motion *motion = &whole->motion[b];
    Ex turn = whole_magnitude3(whole, whole->turn), own = whole_magnitude3(whole, motion->omega),
       all = ex_add(dag, turn, own);
    Ex linear = ex_add(dag, whole_magnitude3(whole, a), whole_magnitude3(whole, whole->gravity));
    *angular = ex_add(dag, whole_magnitude3(whole, alpha), ex_mul(dag, all, all));
    linear = ex_add(dag, linear, ex_mul(dag, *angular, whole_magnitude3(whole, point->v)));
    linear = ex_add(dag, linear, ex_mul(dag, turn, whole_magnitude3(whole, point->rate)));
    linear = ex_add(dag, linear, whole_magnitude3(whole, point->bias));
    *angular = ex_add(dag, *angular, whole_magnitude3(whole, motion->alpha));
    for (int j = 0; b != BODY_BASE && j < whole_subset(whole, b)->deps; ++j) {
        const Ex *S = motion->S + 6 * j;
        Ex rate = magnitude(dag, w2[whole_subset(whole, b)->dep[j]]),
           turning = ex_mul(dag, rate, whole_magnitude3(whole, S));
        *angular = ex_add(dag, *angular, turning);
        linear = ex_add(dag, linear, ex_mul(dag, turning, whole_magnitude3(whole, point->arm)));
        linear = ex_add(dag, linear, ex_mul(dag, rate, whole_magnitude3(whole, S + 3)));
    }
    whole_carry_size(whole, b, w2, point->v, angular, &linear);
    return linear;
}

/* Sums of the magnitudes of applied and inertial wrenches: moment about the reference point, and force. */
static void wrench_size(Whole *whole, const Loads *loads, int b, const Ex alpha[3], const Ex a[3], const Ex *w2,
                        Ex size[2])
{
    Dag *dag = whole->dag;
    const Body *body = &whole->model->body[b];
    Vector com = whole_point(whole, b, body->com);
    Ex angular, linear = acceleration_size(whole, b, &com, alpha, a, w2, &angular), inertia = 0;
    for (int i = 0; i < 3; ++i)
        inertia = ex_add(dag, inertia, whole_number(whole, &body->inertia[i]));
    Ex force = ex_mul(dag, whole_number(whole, &body->mass), linear);
    Ex moment = ex_add(dag, ex_mul(dag, inertia, angular), ex_mul(dag, whole_magnitude3(whole, com.arm), force));
    size[0] = ex_add(dag, loads->size[b][0], moment);
    size[1] = ex_add(dag, loads->size[b][1], force);
    /* if all moments or all forces cancel, as moments about a hinge through the centre of mass, multipliers bring in
     * rounding of the other kind: a ten-thousandth of it counts */
    const Ex mass = whole_number(whole, &body->mass), little = ex_literal(dag, 1e-4);
    if (ex_is(dag, mass, 0) || ex_is(dag, inertia, 0))
        return;
    const Ex radius = ex_sqrt(dag, ex_div(dag, inertia, mass)), most[2] = {size[0], size[1]};
    size[0] = ex_add(dag, size[0], ex_mul(dag, ex_mul(dag, little, radius), most[1]));
    size[1] = ex_add(dag, size[1], ex_mul(dag, ex_div(dag, little, radius), most[0]));
}

/* tau[] and size[] of one unknown. */
static void store_balance(Block *block, int unknown, Ex tau, Ex size)
{
    if (unknown < 0)
        return;
    block_store(block, tau, element_at(ARRAY_tau, unknown));
    block_store(block, size, element_at(ARRAY_size, unknown));
}

Block *check_block(Whole *whole)
{
    Dag *dag = whole->dag;
    const Model *model = whole->model;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    whole->sized = true;
    Ex alpha[3], a[3], *w2, moment = 0, force = 0;
    Ex *along = pool_alloc(dag->pool, (size_t)(model->coordinates + 1) * sizeof *along);
    whole_accelerations(whole, alpha, a, &w2);
    const Loads *loads = loads_make(whole);
    const Projection p = project(whole, loads, alpha, a, w2);
    Ex(*sizes)[2] = pool_alloc(dag->pool, (size_t)model->bodies * sizeof *sizes);
    memcpy(along, loads->own_size, (size_t)model->coordinates * sizeof *along);
    for (int b = model->free_base ? 0 : 1; b < model->bodies; ++b) {
        Ex *size = sizes[b];
        wrench_size(whole, loads, b, alpha, a, w2, size);
        moment = ex_add(dag, moment,
                        ex_add(dag, size[0], ex_mul(dag, size[1], whole_magnitude3(whole, whole->motion[b].c))));
        force = ex_add(dag, force, size[1]);
        for (int j = 0; b != BODY_BASE && j < whole_subset(whole, b)->deps; ++j) {
            const Ex *S = whole->motion[b].S + 6 * j;
            Ex *w = &along[whole_subset(whole, b)->dep[j]];
            *w = ex_add(dag, *w, ex_mul(dag, size[0], whole_magnitude3(whole, S)));
            *w = ex_add(dag, *w, ex_mul(dag, size[1], whole_magnitude3(whole, S + 3)));
        }
    }
    whole_hand_size_on(whole, (const Ex(*)[2])sizes, along);
    for (int i = 0; model->free_base && i < 3; ++i) {
        store_balance(block, i, p.moment[i], moment);
        store_balance(block, 3 + i, p.force[i], force);
    }
    for (int w = 0; w < model->coordinates; ++w)
        store_balance(block, whole->plan->coordinate_unknown[w], p.along[w], along[w]);
    return block;
}

Block *energy_block(Whole *whole)
{
    Dag *dag = whole->dag;
    const Model *model = whole->model;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    const Loads *loads = loads_make(whole);
    Ex alpha[3], a[3], *w2, rate = 0, scale = 0, power = whole_power(whole, loads);
    whole_accelerations(whole, alpha, a, &w2);
    for (int b = model->free_base ? 0 : 1; b < model->bodies; ++b) {
        Ex acceleration[3], angular[3], velocity[3], total[3], J[6], t[3];
        Vector com = whole_point(whole, b, model->body[b].com);
        whole_inertia(whole, b, J);
        whole_acceleration(whole, b, &com, alpha, a, w2,
                           acceleration); /* less gravity: the potential's rate is in it */
        whole_velocity_in_base(whole, &com, velocity);
        whole_angular_acceleration(whole, b, alpha, w2, angular);
        ex_add3(dag, whole->turn, whole->motion[b].omega, total);
        ex_apply(dag, (Ex[]){J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, angular, t);
        Ex linear = ex_mul(dag, whole_number(whole, &model->body[b].mass), ex_dot(dag, acceleration, velocity));
        Ex turning = ex_dot(dag, total, t);
        rate = ex_add(dag, rate, ex_add(dag, linear, turning));
        scale = ex_add(dag, scale, ex_add(dag, magnitude(dag, linear), magnitude(dag, turning)));
    }
    for (int i = 0; i < model->wheels; ++i) {
        if (model->wheel[i].tire < 0)
            continue;
        Ex turning = ex_mul(dag, whole_fast(whole, ARRAY_y, i, FAST_SPIN), whole_fast(whole, ARRAY_rate, i, FAST_SPIN));
        turning = ex_mul(dag, ex_literal(dag, model->wheel[i].spin_inertia), turning);
        rate = ex_add(dag, rate, turning);
        scale = ex_add(dag, scale, magnitude(dag, turning));
    }
    rate = ex_add(dag, rate, loads->potential_rate);
    block_store(block, rate, element_at(ARRAY_energy, 0));
    block_store(block, power, element_at(ARRAY_energy, 1));
    scale = ex_add(dag, scale, ex_add(dag, magnitude(dag, loads->potential_rate), magnitude(dag, power)));
    block_store(block, scale, element_at(ARRAY_energy, 2));
    for (int i = 0; model->free_base && i < 3; ++i) {
        block_store(block, alpha[i], element_at(ARRAY_acc, i));
        block_store(block, a[i], element_at(ARRAY_acc, 3 + i));
    }
    for (int w = 0; w < model->coordinates; ++w)
        if (whole->plan->coordinate_unknown[w] >= 0)
            block_store(block, w2[w], element_at(ARRAY_acc, whole->plan->coordinate_unknown[w]));
    return block;
}
