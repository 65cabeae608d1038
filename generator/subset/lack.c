/* SPDX-License-Identifier: MIT
 * What a subset's bodies lack in the equations of motion at accelerations that stand still, body by body: Newton's and
 * Euler's equations. Along a direction that is d(M z) - db of these bodies, without any derivative of M. */
#include "expression/expression.h"
#include "subset/subset.h"
#include "subset/tangent.h"

static void apply(Dag *dag, const Ex J[6], const Ex x[3], Ex out[3])
{
    ex_apply(dag, (Ex[]){J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, x, out);
}

/* Velocity of a body's centre of mass at unit rate of a coordinate. */
static void unit_velocity(Dag *dag, const Ex *S, const Ex arm[3], Ex out[3])
{
    Ex t[3];
    ex_cross(dag, S, arm, t);
    ex_add3(dag, S + 3, t, out);
}

/* What one body lacks: Newton's and Euler's equations at accelerations acc, projected on the coordinates. */
static void add_body(Dag *dag, const BodyInertia *body, const Motion *m, bool free_base, const Ex *acc, Ex *tau)
{
    Ex a[3], alpha[3], t[3], force[3], moment[3], v[3];
    ex_cross(dag, acc, body->at, a);
    ex_add3(dag, a, acc + 3, a);
    ex_add3(dag, acc, (Ex[3]){0}, alpha);
    for (int j = 0; j < m->deps; ++j) {
        unit_velocity(dag, m->S + 6 * j, body->arm, v);
        ex_scale3(dag, acc[6 + j], v, t);
        ex_add3(dag, a, t, a);
        ex_scale3(dag, acc[6 + j], m->S + 6 * j, t);
        ex_add3(dag, alpha, t, alpha);
    }
    ex_scale3(dag, body->mass, a, force);
    ex_add3(dag, body->force, force, force);
    apply(dag, body->J, alpha, moment);
    ex_add3(dag, body->moment, moment, moment);
    ex_cross(dag, body->at, force, t);
    ex_add3(dag, t, moment, t);
    if (free_base) {
        ex_add3(dag, tau, t, tau);
        ex_add3(dag, tau + 3, force, tau + 3);
    }
    for (int j = 0; j < m->deps; ++j) {
        unit_velocity(dag, m->S + 6 * j, body->arm, v);
        const Ex own = ex_add(dag, ex_dot(dag, v, force), ex_dot(dag, m->S + 6 * j, moment));
        tau[6 + j] = ex_add(dag, tau[6 + j], own);
    }
}

void subset_residuals(const Formula *f, bool free_base, int deps, Ex *tau)
{
    Ex acc[6 + deps];
    for (int i = 0; i < 6 + deps; ++i) {
        acc[i] = ex_input(f->dag, element_at(ARRAY_acc, i), NULL);
        tau[i] = 0;
    }
    for (int i = 0; i < 3 && !free_base; ++i)
        acc[i] = 0;
    for (int b = 0; b < f->layout.bodies; ++b)
        add_body(f->dag, &f->body[b], &f->motion[b], free_base, acc, tau);
}

/* Numbers that are read from memory where the functions of a class have stored them. */
typedef struct Stored {
    Ex *from, *to;
    int count;
} Stored;

static void read_back(Dag *dag, Stored *stored, Ex e, Element place)
{
    int places = stored->count;
    const bool minus = dag->node[e].op == OP_NEG;
    const Ex read = ex_input(dag, place, NULL), own = minus ? dag->node[e].arg[0] : e;
    if (dag->node[own].level < LEVEL_VARIABLE || dag->node[own].op == OP_INPUT)
        return;
    *POOL_PUSH(dag->pool, stored->from, stored->count) = own;
    *POOL_PUSH(dag->pool, stored->to, places) = minus ? ex_neg(dag, read) : read;
}

/* A body along a direction. Of each vector there is its derivative d, and as seen from the body, D v = d v - T x v: of
 * what is fixed in the body that is 0, so that its inertia has no derivative. */
typedef struct BodyAlong {
    Dag *dag;
    const Motion *m;
    const BodyInertia *body;
    const Ex *slope; /* [nodes] */
    const Ex *acc;   /* of the base, alpha and a, and of the deps */
    Ex turn[3], dturn[3];
    Ex T[6], own[6], down[6]; /* twist; acceleration S z, and its derivative */
} BodyAlong;

static void add_cross(Dag *dag, const Ex a[3], const Ex b[3], Ex sum[3])
{
    Ex t[3];
    ex_cross(dag, a, b, t);
    ex_add3(dag, sum, t, sum);
}

static void slopes3(const BodyAlong *z, const Ex v[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = z->slope[v[i]];
}

static void add_scaled6(Dag *dag, Ex by, const Ex *v, Ex sum[6])
{
    for (int i = 0; i < 6; ++i)
        sum[i] = ex_add(dag, sum[i], ex_mul(dag, by, v[i]));
}

/* D v from d v. */
static void from_body(const BodyAlong *z, const Ex v[3], const Ex dv[3], Ex out[3])
{
    Ex t[3];
    ex_cross(z->dag, z->T, v, t);
    ex_sub3(z->dag, dv, t, out);
}

/* Acceleration of the reference point, with that of the base, and its derivative. */
static void reference_along(const BodyAlong *z, Ex a[3], Ex da[3])
{
    Dag *dag = z->dag;
    const Motion *m = z->m;
    Ex w[3], dw[3], dc[3], dv[3];
    slopes3(z, m->c, dc);
    slopes3(z, m->velocity, dv);
    ex_scale3(dag, ex_literal(dag, 2), m->velocity, w);
    add_cross(dag, z->turn, m->c, w);
    ex_scale3(dag, ex_literal(dag, 2), dv, dw);
    add_cross(dag, z->dturn, m->c, dw);
    add_cross(dag, z->turn, dc, dw);
    ex_add3(dag, z->acc + 3, m->acceleration, a);
    ex_add3(dag, a, z->own + 3, a);
    add_cross(dag, z->acc, m->c, a);
    add_cross(dag, z->turn, w, a);
    slopes3(z, m->acceleration, da);
    ex_add3(dag, da, z->down + 3, da);
    add_cross(dag, z->acc, dc, da);
    add_cross(dag, z->dturn, w, da);
    add_cross(dag, z->turn, dw, da);
}

/* Force, and moment about the reference point, that the body needs, with their derivatives: dF = D F + T x F. */
static void wrench_along(const BodyAlong *z, Ex F[3], Ex dF[3], Ex N[3], Ex dN[3])
{
    Dag *dag = z->dag;
    const Motion *m = z->m;
    const Ex *r = z->body->arm, *J = z->body->J;
    Ex total[3], psi[3], q[3], h[3], t[3], Dtotal[3], Dpsi[3], domega[3];
    slopes3(z, m->omega, domega);
    ex_add3(dag, z->turn, m->omega, total);
    ex_add3(dag, z->dturn, domega, t);
    from_body(z, total, t, Dtotal);
    ex_add3(dag, z->acc, m->alpha, psi);
    ex_add3(dag, psi, z->own, psi);
    add_cross(dag, z->turn, m->omega, psi);
    slopes3(z, m->alpha, t);
    ex_add3(dag, t, z->down, t);
    add_cross(dag, z->dturn, m->omega, t);
    add_cross(dag, z->turn, domega, t);
    from_body(z, psi, t, Dpsi);
    ex_cross(dag, total, r, q);
    reference_along(z, F, t);
    from_body(z, F, t, dF);
    add_cross(dag, Dpsi, r, dF);
    add_cross(dag, Dtotal, q, dF);
    ex_cross(dag, Dtotal, r, t);
    add_cross(dag, total, t, dF);
    ex_scale3(dag, z->body->mass, dF, dF);
    add_cross(dag, psi, r, F);
    add_cross(dag, total, q, F);
    ex_scale3(dag, z->body->mass, F, F);
    apply(dag, J, psi, N);
    apply(dag, J, total, h);
    add_cross(dag, total, h, N);
    add_cross(dag, r, F, N);
    apply(dag, J, Dpsi, dN);
    add_cross(dag, Dtotal, h, dN);
    apply(dag, J, Dtotal, h);
    add_cross(dag, total, h, dN);
    add_cross(dag, r, dF, dN);
    add_cross(dag, z->T, F, dF);
    add_cross(dag, z->T, N, dN);
}

/* Add what a body lacks, along the direction. */
static void add_along(const BodyAlong *z, bool free_base, Ex *lack)
{
    Dag *dag = z->dag;
    const Motion *m = z->m;
    Ex F[3], dF[3], N[3], dN[3], dc[3];
    wrench_along(z, F, dF, N, dN);
    for (int j = 0; j < m->deps; ++j) {
        const Ex *S = m->S + 6 * j;
        Ex dS[6];
        slopes3(z, S, dS);
        slopes3(z, S + 3, dS + 3);
        const Ex turning = ex_add(dag, ex_dot(dag, dS, N), ex_dot(dag, S, dN));
        const Ex moving = ex_add(dag, ex_dot(dag, dS + 3, F), ex_dot(dag, S + 3, dF));
        lack[6 + j] = ex_add(dag, lack[6 + j], ex_add(dag, turning, moving));
    }
    if (!free_base)
        return;
    slopes3(z, m->c, dc);
    ex_add3(dag, lack, dN, lack);
    add_cross(dag, dc, F, lack);
    add_cross(dag, m->c, dF, lack);
    ex_add3(dag, lack + 3, dF, lack + 3);
}

static BodyAlong body_along(const Formula *formula, int b, const Along *along, const Ex *acc, const Ex *slope)
{
    Dag *dag = formula->dag;
    BodyAlong z = {.dag = dag, .m = &formula->motion[b], .body = &formula->body[b], .slope = slope, .acc = acc};
    for (int i = 0; i < 3 && !along->steady; ++i) {
        z.turn[i] = ex_input(dag, element_at(ARRAY_turn, i), NULL);
        z.dturn[i] = ex_input(dag, (Element){.array = ARRAY_turn, .index = i, .slope = true}, NULL);
    }
    for (int j = 0; j < z.m->deps; ++j) {
        const Ex *S = z.m->S + 6 * j;
        Ex dS[6];
        slopes3(&z, S, dS);
        slopes3(&z, S + 3, dS + 3);
        add_scaled6(dag, acc[6 + j], S, z.own);
        add_scaled6(dag, acc[6 + j], dS, z.down);
        if (!along->still)
            add_scaled6(dag, ex_input(dag, (Element){.array = ARRAY_x, .index = j, .slope = true}, NULL), S, z.T);
    }
    return z;
}

/* [6 + deps] what the bodies lack along a direction; stored: what the class's function stores of the numbers in it. */
static Ex *lacking(const Formula *balanced, const Along *along, int deps, Stored *stored)
{
    const Formula *formula = formula_from_parts(balanced);
    Dag *dag = formula->dag;
    const Block *solve = &formula->solve;
    const int rows = 6 + deps;
    Ex *root = pool_alloc(dag->pool, ((size_t)solve->stores + 1) * sizeof *root);
    Ex *acc = pool_alloc(dag->pool, (size_t)rows * sizeof *acc),
       *lack = pool_alloc(dag->pool, (size_t)rows * sizeof *lack);
    const Seeds seeds = subset_seeds(formula, along);
    for (int i = 0; i < solve->stores; ++i)
        root[i] = solve->store[i].value;
    const Ex *slope = dag_slopes(dag, solve, root, solve->stores, &seeds);
    dag_section(dag, "what the bodies lack");
    for (int i = along->steady ? 3 : 0; i < rows; ++i)
        acc[i] = ex_input(dag, element_at(ARRAY_acc, i), NULL);
    for (int b = 0; b < formula->layout.bodies; ++b) {
        const BodyAlong z = body_along(formula, b, along, acc, slope);
        add_along(&z, !along->steady, lack);
    }
    for (int i = 0; i < solve->stores; ++i) {
        Element place = solve->store[i].target;
        if (place.array != ARRAY_motion && place.array != ARRAY_inertia)
            continue;
        read_back(dag, stored, root[i], place);
        place.slope = true;
        if (place.array == ARRAY_motion)
            read_back(dag, stored, slope[root[i]], place);
    }
    return lack;
}

/* The search for what is kept of `solve`. */
typedef struct Keeping {
    const Dag *dag;
    const bool *solved; /* [nodes] `solve` computes it */
    char *seen;         /* [nodes] 1: yes; 2: it is read from memory anyway */
    Ex *kept;
    int count;
} Keeping;

static void keep(Keeping *k, Ex e)
{
    const Node *node = &k->dag->node[e];
    const int arity = ex_arity((Op)node->op);
    bool short_way = true; /* one operation on what is read */
    if (k->seen[e] || node->level < LEVEL_VARIABLE || node->op == OP_INPUT)
        return;
    k->seen[e] = 1;
    for (int i = 0; i < arity; ++i) {
        const Node *argument = &k->dag->node[node->arg[i]];
        short_way =
            short_way && (argument->level < LEVEL_VARIABLE || argument->op == OP_INPUT || k->seen[node->arg[i]] == 2);
    }
    if (k->solved[e] && !short_way && node->op != OP_NEG) {
        *POOL_PUSH(k->dag->pool, k->kept, k->count) = e;
        return;
    }
    for (int i = 0; i < arity; ++i)
        keep(k, node->arg[i]);
}

const Ex *subset_kept(const Formula *formula, const Along *along, int deps, int *count)
{
    Dag *dag = formula->dag;
    const Block *solve = &formula->solve;
    Along moving = *along;
    Stored stored = {0};
    Ex *root = pool_alloc(dag->pool, (size_t)(solve->stores + solve->checks + 1) * sizeof *root);
    moving.still = false;
    const Ex *lack = lacking(formula, &moving, deps, &stored);
    for (int i = 0; i < solve->stores + solve->checks; ++i)
        root[i] = i < solve->stores ? solve->store[i].value : solve->check[i - solve->stores].value;
    Keeping k = {.dag = dag,
                 .solved = dag_needed(dag, root, solve->stores + solve->checks),
                 .seen = pool_alloc(dag->pool, (size_t)dag->nodes)};
    for (int i = 0; i < stored.count; ++i)
        k.seen[stored.from[i]] = 2;
    for (int i = 0; i < 6 + deps; ++i)
        keep(&k, lack[i]);
    *count = k.count;
    return k.kept;
}

const Block *subset_lack(const Formula *formula, const Along *along, int deps)
{
    Dag *dag = formula->dag;
    int kept;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    Stored stored = {0};
    const Ex *keep = subset_kept(formula, along, deps, &kept), *lack = lacking(formula, along, deps, &stored);
    for (int i = 0; i < kept; ++i)
        read_back(dag, &stored, keep[i], element_at(ARRAY_kept, i));
    const Ex *image = dag_replace(dag, lack, 6 + deps, stored.from, stored.to, stored.count);
    *block = (Block){.dag = dag};
    for (int i = 0; i < 6 + deps; ++i)
        block_store(block, image[lack[i]], element_at(ARRAY_lack, i));
    return block;
}
