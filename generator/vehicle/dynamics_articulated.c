/* SPDX-License-Identifier: MIT
 * Equations of motion of a chained sequence, in work that grows as the number of its subsets (articulated bodies). They
 * are those of the reduced form, but every carried subset eliminates its own coordinates before its carrier's subset
 * does. With T = (alpha, a) at the carrier's reference point,
 *
 *     [ Phi  C^T ] [ T   ]   [ r ]          Phi' = Phi - C^T M^-1 C
 *     [ C    M   ] [ w'' ] = [ f ] ,        r'   = r - C^T M^-1 f ,        w'' = M^-1 f - M^-1 C T ,
 *
 * and Phi', r' join the carrier as inertia and load. Moments are about reference points nearby, components in the base
 * frame: no digits are lost to the length of a chain. The subsets that the base carries end in the equations of
 * dynamics_reduced.c.
 */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/dynamics.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Both triangles; angular before linear. */
typedef Ex Inertia[6][6];

/* The load on a body by the subsets that it carries. */
typedef struct Burden {
    bool any;
    Inertia I;    /* with their coordinates eliminated */
    Inertia held; /* with their own coordinates held fixed */
    Ex r[6];
} Burden;

/* A carried subset whose coordinates are eliminated. */
typedef struct Link {
    int frees, *coordinate;
    Ex *from_carrier; /* [frees][6] M^-1 C */
    Ex *own;          /* [frees] M^-1 f */
} Link;

typedef struct Articulation {
    Whole *whole;
    Dag *dag;
    Block *block;
    const Loads *loads;
    const Ex *driven;
    Burden *burden; /* [bodies] */
    Link *link;     /* [subsets] */
} Articulation;

/* Equations of a subset in T and its n coordinates. */
typedef struct Local {
    const Subset *subset;
    int n;
    Inertia Phi;
    Ex r[6];
    Ex (*C)[6], *M, *f; /* [n][6], [n][n] upper triangle, [n] */
    Ex *diagonal;       /* [n] diagonal of M with the coordinates of carried subsets held fixed */
} Local;

static Ex dot6(Dag *dag, const Ex *a, const Ex *b)
{
    return ex_add(dag, ex_dot(dag, a, b), ex_dot(dag, a + 3, b + 3));
}

static void apply6(Dag *dag, Inertia I, const Ex *x, Ex out[6])
{
    for (int i = 0; i < 6; ++i)
        out[i] = dot6(dag, I[i], x);
}

/* Add a wrench about a point that is at e from the point of `sum`. */
static void add_wrench(Dag *dag, const Ex wrench[6], const Ex e[3], Ex sum[6])
{
    Ex moment[3];
    ex_cross(dag, e, wrench + 3, moment);
    ex_add3(dag, sum, wrench, sum);
    ex_add3(dag, sum, moment, sum);
    ex_add3(dag, sum + 3, wrench + 3, sum + 3);
}

/* Add an inertia, shifted the same way: X^T I X, X T = (alpha, a + alpha x e). */
static void add_shifted(Dag *dag, Inertia I, const Ex e[3], Inertia sum)
{
    Inertia rows = {{0}}, all = {{0}};
    for (int c = 0; c < 6; ++c) {
        Ex column[6], out[6] = {0};
        for (int i = 0; i < 6; ++i)
            column[i] = I[i][c];
        add_wrench(dag, column, e, out);
        for (int i = 0; i < 6; ++i)
            rows[i][c] = out[i];
    }
    for (int i = 0; i < 6; ++i)
        add_wrench(dag, rows[i], e, all[i]);
    for (int i = 0; i < 6; ++i)
        for (int j = i; j < 6; ++j)
            sum[i][j] = sum[j][i] = ex_add(dag, sum[i][j], all[i][j]);
}

static Local local_new(const Articulation *a, const Subset *subset)
{
    Pool *pool = a->dag->pool;
    const size_t n = (size_t)subset->deps;
    return (Local){.subset = subset,
                   .n = subset->deps,
                   .C = pool_alloc(pool, (n + 1) * sizeof(Ex[6])),
                   .M = pool_alloc(pool, (n * n + 1) * sizeof(Ex)),
                   .f = pool_alloc(pool, (n + 1) * sizeof(Ex)),
                   .diagonal = pool_alloc(pool, (n + 1) * sizeof(Ex))};
}

/* Inertia and quadratic-velocity forces of the subset's bodies, as their recovery stored them. */
static void add_bodies(const Articulation *a, Local *own, int s)
{
    static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    Dag *dag = a->dag;
    const int n = own->n;
    Ex first[3] = {0}, second[6] = {0}, quadratic[6] = {0}, mass = 0;
    for (int b = 0; b < own->subset->bodies; ++b)
        mass = ex_add(dag, mass, whole_number(a->whole, &a->whole->model->body[own->subset->body[b]].mass));
    for (int settled = 1; settled >= 0; --settled) {
        const Summation now = {a->whole, settled};
        dynamics_add(&now, first, s, INERTIA_FIRST, 3);
        dynamics_add(&now, second, s, INERTIA_SECOND, 6);
        dynamics_add(&now, quadratic, s, INERTIA_MOMENT, 3);
        dynamics_add(&now, quadratic + 3, s, INERTIA_FORCE, 3);
        for (int j = 0; j < n; ++j) {
            const int at = INERTIA_COORDINATE + 7 * j;
            dynamics_add(&now, own->C[j], s, at + 3, 3);
            dynamics_add(&now, own->C[j] + 3, s, at, 3);
            dynamics_add(&now, &own->f[j], s, at + 6, 1);
            for (int k = j; k < n; ++k)
                dynamics_add(&now, &own->M[n * j + k], s, inertia_mass(n, j, k), 1);
        }
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int l = 0; l < 3; ++l)
            own->Phi[i][l] = second[place[i][l]];
        own->Phi[3 + i][3 + i] = mass;
        /* moment of a linear acceleration: first x a */
        own->Phi[i][3 + k] = own->Phi[3 + k][i] = first[j];
        own->Phi[i][3 + j] = own->Phi[3 + j][i] = ex_neg(dag, first[k]);
    }
    for (int i = 0; i < 6; ++i)
        own->r[i] = ex_neg(dag, quadratic[i]);
    for (int j = 0; j < n; ++j) {
        own->f[j] = ex_neg(dag, own->f[j]);
        own->diagonal[j] = own->M[n * j + j];
    }
}

/* Inertia carried by one of the subset's bodies, which is at e from the carrier's reference point. */
static void add_burden(Dag *dag, Local *own, const Motion *motion, Burden *burden, const Ex e[3])
{
    add_shifted(dag, burden->I, e, own->Phi);
    for (int j = 0; j < own->n; ++j) {
        const Ex *S = motion->S + 6 * j;
        Ex U[6], held[6];
        apply6(dag, burden->I, S, U);
        add_wrench(dag, U, e, own->C[j]);
        for (int k = 0; k <= j; ++k) {
            Ex *M = &own->M[own->n * k + j];
            *M = ex_add(dag, *M, dot6(dag, motion->S + 6 * k, U));
        }
        apply6(dag, burden->held, S, held);
        own->diagonal[j] = ex_add(dag, own->diagonal[j], dot6(dag, S, held));
    }
}

/* Applied forces, and the load of carried subsets. at: reference point of the carrier. */
static void add_loads(const Articulation *a, Local *own, const Ex at[3])
{
    Dag *dag = a->dag;
    const Subset *subset = own->subset;
    for (int j = 0; j < own->n; ++j)
        for (int i = 0; i < subset->coordinates; ++i)
            if (subset->coordinate[i] == subset->dep[j])
                own->f[j] = ex_add(dag, own->f[j], a->loads->own[subset->dep[j]]);
    for (int i = 0; i < subset->bodies; ++i) {
        const int b = subset->body[i];
        const Motion *motion = &a->whole->motion[b];
        Ex e[3], total[6];
        ex_sub3(dag, motion->c, at, e);
        for (int k = 0; k < 6; ++k)
            total[k] = ex_add(dag, a->loads->wrench[b][k], a->burden[b].r[k]);
        add_wrench(dag, total, e, own->r);
        for (int j = 0; j < own->n; ++j)
            own->f[j] = ex_add(dag, own->f[j], dot6(dag, motion->S + 6 * j, total));
        if (a->burden[b].any)
            add_burden(dag, own, motion, &a->burden[b], e);
    }
}

/* Move given accelerations to the right-hand side. */
static void drive(const Articulation *a, Local *own)
{
    Dag *dag = a->dag;
    for (int d = 0; d < own->n; ++d) {
        const int w = own->subset->dep[d];
        if (!a->whole->model->coordinate[w].driven)
            continue;
        for (int i = 0; i < 6; ++i)
            own->r[i] = ex_sub(dag, own->r[i], ex_mul(dag, own->C[d][i], a->driven[w]));
        for (int j = 0; j < own->n; ++j) {
            const Ex M = own->M[j < d ? own->n * j + d : own->n * d + j];
            own->f[j] = ex_sub(dag, own->f[j], ex_mul(dag, M, a->driven[w]));
        }
    }
}

/* Solve for the free coordinates in terms of T; `link` gets the result. place [n]: index among all coordinates of the
 * subset. */
static void solve_free(const Articulation *a, const Local *own, Link *link, int *place)
{
    Dag *dag = a->dag;
    Pool *pool = dag->pool;
    const int *unknown = a->whole->plan->coordinate_unknown;
    const size_t n = (size_t)own->n;
    link->coordinate = pool_alloc(pool, (n + 1) * sizeof *link->coordinate);
    link->from_carrier = pool_alloc(pool, (6 * n + 1) * sizeof(Ex));
    link->own = pool_alloc(pool, (n + 1) * sizeof(Ex));
    for (int j = 0; j < own->n; ++j)
        if (unknown[own->subset->dep[j]] >= 0) {
            place[link->frees] = j;
            link->coordinate[link->frees++] = own->subset->dep[j];
        }
    const int p = link->frees;
    Ex *M = pool_alloc(pool, (n * n + 1) * sizeof *M), *x = pool_alloc(pool, (n + 1) * sizeof *x);
    for (int j = 0; j < p; ++j) {
        link->own[j] = own->f[place[j]];
        for (int k = j; k < p; ++k)
            M[p * j + k] = own->M[own->n * place[j] + place[k]];
    }
    if (!p)
        return;
    const Factors *factors = linear_factor_symmetric(dag, p, M, NULL, 0);
    for (int k = 0; k < p; ++k)
        dynamics_check(a->whole, a->block, unknown[link->coordinate[factors->row[k]]], factors->pivot[k],
                       own->diagonal[place[factors->row[k]]]);
    linear_solve(dag, factors, link->own, link->own);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < p; ++j)
            x[j] = own->C[place[j]][i];
        linear_solve(dag, factors, x, x);
        for (int j = 0; j < p; ++j)
            link->from_carrier[6 * j + i] = x[j];
    }
}

/* Add the subset's equations, free coordinates eliminated, to its carrier. */
static void hand_on(const Articulation *a, const Local *own, const Link *link, const int *place)
{
    Dag *dag = a->dag;
    Burden *burden = &a->burden[own->subset->carrier];
    burden->any = true;
    for (int i = 0; i < 6; ++i) {
        Ex r = own->r[i];
        for (int j = 0; j < link->frees; ++j)
            r = ex_sub(dag, r, ex_mul(dag, own->C[place[j]][i], link->own[j]));
        burden->r[i] = ex_add(dag, burden->r[i], r);
        for (int k = i; k < 6; ++k) {
            Ex left = own->Phi[i][k];
            burden->held[i][k] = burden->held[k][i] = ex_add(dag, burden->held[i][k], left);
            for (int j = 0; j < link->frees; ++j)
                left = ex_sub(dag, left, ex_mul(dag, own->C[place[j]][i], link->from_carrier[6 * j + k]));
            burden->I[i][k] = burden->I[k][i] = ex_add(dag, burden->I[i][k], left);
        }
    }
}

/* From the tips to the subsets that the base carries. */
static void gather(const Articulation *a)
{
    const Sequence *sequence = a->whole->plan->sequence;
    for (int s = sequence->subsets - 1; s >= 0; --s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || subset->carrier == BODY_BASE)
            continue;
        Local own = local_new(a, subset);
        int *place = pool_alloc(a->dag->pool, ((size_t)own.n + 1) * sizeof *place);
        add_bodies(a, &own, s);
        add_loads(a, &own, a->whole->motion[subset->carrier].c);
        drive(a, &own);
        solve_free(a, &own, &a->link[s], place);
        hand_on(a, &own, &a->link[s], place);
    }
}

/* Equations of all that the base carries, [n] of all unknowns. */
typedef struct Dense {
    int n;
    Ex *M, *z, *diagonal; /* diagonal: with the coordinates of carried subsets held fixed */
} Dense;

/* Add the loads of a subset of the base and of the subsets that it carries; its own inertia is in the equations
 * already. */
static void add_to_base(const Articulation *a, const Subset *subset, Dense *d)
{
    static const Ex origin[3];
    Dag *dag = a->dag;
    const bool free = a->whole->model->free_base;
    Local own = local_new(a, subset);
    Ex still[6] = {0}; /* a fixed base accelerates against gravity */
    ex_sub3(dag, still + 3, a->whole->gravity, still + 3);
    add_loads(a, &own, origin);
    drive(a, &own);
    for (int i = 0; free && i < 6; ++i) {
        d->z[i] = ex_add(dag, d->z[i], own.r[i]);
        d->diagonal[i] = ex_add(dag, d->diagonal[i], own.Phi[i][i]);
        for (int k = i; k < 6; ++k)
            d->M[d->n * i + k] = ex_add(dag, d->M[d->n * i + k], own.Phi[i][k]);
    }
    for (int j = 0; j < own.n; ++j) {
        const int row = a->whole->plan->coordinate_unknown[subset->dep[j]];
        if (row < 0)
            continue;
        d->z[row] = ex_add(dag, d->z[row], own.f[j]);
        d->diagonal[row] = ex_add(dag, d->diagonal[row], own.diagonal[j]);
        if (!free)
            d->z[row] = ex_sub(dag, d->z[row], dot6(dag, own.C[j], still));
        for (int i = 0; free && i < 6; ++i)
            d->M[d->n * i + row] = ex_add(dag, d->M[d->n * i + row], own.C[j][i]);
        for (int k = 0; k < own.n; ++k) {
            const int column = a->whole->plan->coordinate_unknown[subset->dep[k]];
            Ex *M = &d->M[d->n * row + column];
            if (column >= row)
                *M = ex_add(dag, *M, own.M[j < k ? own.n * j + k : own.n * k + j]);
        }
    }
}

/* The unknowns of the base and of the subsets that it carries; returns their number. */
static int dense_unknowns(const Whole *whole, int *unknown)
{
    const Sequence *sequence = whole->plan->sequence;
    int count = 0;
    while (whole->model->free_base && count < 6) {
        unknown[count] = count;
        ++count;
    }
    for (int w = 0; w < whole->model->coordinates; ++w)
        for (int s = 0; s < sequence->subsets && whole->plan->coordinate_unknown[w] >= 0; ++s)
            for (int i = 0; sequence->subset[s].carrier == BODY_BASE && i < sequence->subset[s].coordinates; ++i)
                if (sequence->subset[s].coordinate[i] == w)
                    unknown[count++] = whole->plan->coordinate_unknown[w];
    return count;
}

/* z [unknowns]: accelerations of the base and of its own subsets. */
static void solve_dense(const Articulation *a, const Dense *d, Ex *z)
{
    Dag *dag = a->dag;
    Pool *pool = dag->pool;
    int *unknown = pool_alloc(pool, ((size_t)d->n + 1) * sizeof *unknown);
    const int m = dense_unknowns(a->whole, unknown);
    Ex *M = pool_alloc(pool, ((size_t)m * (size_t)m + 1) * sizeof *M),
       *x = pool_alloc(pool, ((size_t)m + 1) * sizeof *x);
    for (int i = 0; i < m; ++i) {
        x[i] = d->z[unknown[i]];
        for (int j = i; j < m; ++j) {
            const int low = unknown[i] < unknown[j] ? i : j;
            M[m * i + j] = d->M[d->n * unknown[low] + unknown[i + j - low]];
        }
    }
    const Factors *factors = linear_factor_symmetric(dag, m, M, NULL, 0);
    for (int k = 0; k < m; ++k) {
        const int row = unknown[factors->row[k]];
        dynamics_check(a->whole, a->block, row, factors->pivot[k], d->diagonal[row]);
    }
    linear_solve(dag, factors, x, x);
    for (int i = 0; i < m; ++i)
        z[unknown[i]] = x[i];
}

/* Accelerations of carried subsets, from the base to the tips. On entry w2 [coordinates] has those of the base's
 * subsets. */
static void spread(const Articulation *a, const Ex base[6], Ex *w2)
{
    Whole *whole = a->whole;
    Dag *dag = a->dag;
    const Sequence *sequence = whole->plan->sequence;
    Ex(*given)[6] = pool_alloc(dag->pool, (size_t)whole->model->bodies * sizeof *given);
    memcpy(given[BODY_BASE], base, sizeof given[BODY_BASE]);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Ex *T = given[subset->carrier];
        for (int j = 0; j < a->link[s].frees; ++j) {
            const Link *link = &a->link[s];
            w2[link->coordinate[j]] = ex_sub(dag, link->own[j], dot6(dag, link->from_carrier + 6 * j, T));
        }
        for (int i = 0; i < subset->bodies; ++i) {
            const Motion *motion = &whole->motion[subset->body[i]];
            Ex *out = given[subset->body[i]], e[3];
            ex_sub3(dag, motion->c, whole->motion[subset->carrier].c, e);
            ex_cross(dag, T, e, out + 3);
            ex_add3(dag, out + 3, T + 3, out + 3);
            memcpy(out, T, 3 * sizeof *out);
            for (int j = 0; a->burden[subset->body[i]].any && j < subset->deps; ++j)
                for (int k = 0; k < 6; ++k)
                    out[k] = ex_add(dag, out[k], ex_mul(dag, w2[subset->dep[j]], motion->S[6 * j + k]));
        }
    }
}

/* The equations of the base and its own subsets, with the load of all carried subsets. */
static Dense dense_make(const Articulation *a)
{
    Whole *whole = a->whole;
    Pool *pool = a->dag->pool;
    const Sequence *sequence = whole->plan->sequence;
    const size_t n = (size_t)whole->plan->unknowns;
    Dense d = {.n = whole->plan->unknowns,
               .M = pool_alloc(pool, (n * n + 1) * sizeof(Ex)),
               .z = pool_alloc(pool, (n + 1) * sizeof(Ex)),
               .diagonal = pool_alloc(pool, (n + 1) * sizeof(Ex))};
    const Composite c = dynamics_compose(whole);
    const Loads none = {.along = pool_alloc(pool, ((size_t)whole->model->coordinates + 1) * sizeof(Ex))};
    dynamics_matrix(whole, &c, d.M, d.n);
    dynamics_right(whole, &c, &none, a->driven, d.z);
    for (int i = 0; i < d.n; ++i)
        d.diagonal[i] = d.M[d.n * i + i];
    for (int i = 0; whole->model->free_base && i < 6; ++i)
        d.z[i] = ex_add(a->dag, d.z[i], a->loads->wrench[BODY_BASE][i]);
    for (int s = 0; s < sequence->subsets; ++s)
        if (sequence->subset[s].class >= 0 && sequence->subset[s].carrier == BODY_BASE)
            add_to_base(a, &sequence->subset[s], &d);
    return d;
}

/* Each pivot is compared with the inertia before the coordinates of the next carried subset were free. No pivot shows a
 * joint loss of several light bodies in a row: hence a bound on the ratio of masses. */
const double articulated_most_mass = 1e4;

const char *articulated_missing(const Model *model)
{
    const int first = model->free_base ? BODY_BASE : BODY_BASE + 1;
    for (int j = 0; j < model->joints; ++j)
        if (joint_is_coupled(model->joint[j].type))
            return "does not know joints that follow coordinates of other bodies (gear, coupler)";
    double light = 0, heavy = 0;
    for (int b = first; b < model->bodies; ++b) {
        const double mass = model->body[b].mass;
        light = b == first || mass < light ? mass : light;
        heavy = b == first || mass > heavy ? mass : heavy;
    }
    return heavy > articulated_most_mass * light
               ? "would lose digits: a body has more than 10000 times the mass of another"
               : NULL;
}

Block *articulated_block(Whole *whole)
{
    Dag *dag = whole->dag;
    Pool *pool = dag->pool;
    const Model *model = whole->model;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = dag;
    block->model = model->name;
    const Articulation a = {.whole = whole,
                            .dag = dag,
                            .block = block,
                            .loads = loads_make(whole),
                            .driven = whole_driven_accelerations(whole),
                            .burden = pool_alloc(pool, (size_t)model->bodies * sizeof *a.burden),
                            .link = pool_alloc(pool, ((size_t)whole->plan->sequence->subsets + 1) * sizeof *a.link)};
    for (int b = 0; b < model->bodies; ++b)
        block_loads(block, a.loads->wrench[b], 6);
    block_loads(block, a.loads->own, model->coordinates);
    gather(&a);
    const Dense d = dense_make(&a);
    Ex *z = pool_alloc(pool, ((size_t)d.n + 1) * sizeof *z), *w2 = whole_driven_accelerations(whole), base[6] = {0};
    solve_dense(&a, &d, z);
    if (model->free_base)
        memcpy(base, z, sizeof base);
    else
        ex_sub3(dag, base + 3, whole->gravity, base + 3);
    for (int w = 0; w < model->coordinates; ++w)
        if (whole->plan->coordinate_unknown[w] >= 0)
            w2[w] = z[whole->plan->coordinate_unknown[w]];
    spread(&a, base, w2);
    for (int w = 0; w < model->coordinates; ++w)
        if (whole->plan->coordinate_unknown[w] >= 0)
            z[whole->plan->coordinate_unknown[w]] = w2[w];
    whole_store_rates(whole, block, z);
    return block;
}
