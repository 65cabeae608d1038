/* SPDX-License-Identifier: MIT
 * Motions of subsets of one coordinate, enclosed. Over an interval of the coordinate the pose of a subset is a power
 * series P, found by chords, and a radius, by Krawczyk's operator: let F be the equations of all joints and
 * coordinates, and p . p - 1 of each body's Euler parameters, G their derivatives anywhere in a tube of radius R about
 * P and anywhere in the interval, Y a matrix near the inverse of G. Then if |Y F(P)| <= z,  |1 - Y G| <= k < 1,  z + k
 * R < R in the largest norm, lengths divided by the subset's size, for each value of the coordinate one pose in the
 * tube fulfils F = 0, and it is within z / (1 - k) of P (Neumaier 1990, section 5). R is large against errors of what
 * is next to the interval, so that poses in the tubes of intervals that meet are the same one there. Motions follow by
 * evaluating the graph of `solve` at that pose. */
#include "subset/enclosure.h"

#include "expression/expression.h"
#include "sequence/sequence.h"

#include <math.h>
#include <string.h>

static const Quad tube = 1e-8;

typedef struct Enclosed {
    const bool *rows_needed; /* [nodes] NULL: closed form */
    TaylorModel *node;       /* [nodes] */
    int *place;              /* [nodes] of those among the slopes */
    bool *moves;             /* [nodes] the pose is among its arguments */
    TaylorModel *slope;      /* [rows' nodes][unknowns] */
    TaylorModel *G;          /* [unknowns][unknowns] */
    TaylorModel *q;          /* [unknowns] */
    TaylorModel *motion;     /* [bodies][motion_size] */
    Quad *met;               /* [unknowns] pose at the end of the last interval */
    Quad met_off;            /* share of the scales that it may be off by */
    int unknowns;            /* 7 a body */
} Enclosed;

struct Enclosure {
    Exact *exact;
    Enclosed *of; /* [subsets] */
    TaylorModel x;
    int near; /* the end of the interval, -1 or 1, at which it meets the last one */
};

/* Input of one subset's graph. */
typedef struct Inputs {
    const Enclosure *enclosure;
    int subset;
    bool flat; /* as numbers with a bound, without a polynomial */
    Quad off;  /* what poses may be off by more, as a share of the scales */
} Inputs;

static Quad scale_of(const Enclosure *e, int s, int unknown)
{
    return unknown % 7 < 3 ? (Quad)e->exact->solved[s].formula->size : 1;
}

static TaylorModel flattened(const TaylorModel *a)
{
    TaylorModel middle = taylor_constant(a->c[0]), rest = *a;
    rest.c[0] = 0;
    middle.off = taylor_most(&rest);
    return middle;
}

static TaylorModel input(const void *context, Element element)
{
    const Inputs *inputs = context;
    const Enclosure *e = inputs->enclosure;
    const Sequence *sequence = e->exact->w->sequence;
    TaylorModel found = taylor_constant(0);
    switch (element.array) {
    case ARRAY_x: found = e->x; break;
    case ARRAY_rate: found = taylor_constant(1); break;
    case ARRAY_turn:
    case ARRAY_ahead: break;
    case ARRAY_number: found = taylor_constant((Quad)element.number); break;
    case ARRAY_q:
        found = e->of[inputs->subset].q[element.index];
        found.off += inputs->off * scale_of(e, inputs->subset, element.index) * (1 + 4 * QUAD_EPSILON);
        break;
    case ARRAY_known: {
        const int body = sequence->subset[inputs->subset].known[element.which], owner = sequence->body_subset[body];
        const int size = e->exact->solved[owner].formula->layout.motion_size;
        found = e->of[owner].motion[subset_place(&sequence->subset[owner], body) * size + element.index];
        break;
    }
    default: found.off = NAN;
    }
    return inputs->flat ? flattened(&found) : found;
}

/* Householder's sign, +-|x|, which may be either one where x[0] is about 0: both reflections solve the same system, and
 * have the same determinant. Only factorize_block.c makes such a node. */
static bool is_reflection(const Dag *dag, const Node *node)
{
    const Node *norm = &dag->node[node->arg[1]], *other = &dag->node[node->arg[2]];
    return norm->op == OP_SQRT && other->op == OP_NEG && other->arg[0] == node->arg[1];
}

static void operate(const Dag *dag, const Node *node, const TaylorModel *a, const TaylorModel *b, const TaylorModel *c,
                    TaylorModel *out)
{
    TaylorModel other;
    switch ((Op)node->op) {
    case OP_NEG: taylor_negative(a, out); return;
    case OP_ADD: taylor_sum(a, b, 1, out); return;
    case OP_SUB: taylor_sum(a, b, -1, out); return;
    case OP_MUL: taylor_product(a, b, out); return;
    case OP_DIV: taylor_quotient(a, b, out); return;
    case OP_SQRT: taylor_root(a, out); return;
    case OP_SIN: taylor_sine(a, false, out); return;
    case OP_COS: taylor_sine(a, true, out); return;
    case OP_TAN:
        taylor_sine(a, true, &other);
        taylor_sine(a, false, out);
        taylor_quotient(out, &other, out);
        return;
    case OP_ABS:
        taylor_negative(a, &other);
        taylor_choice(a, a, &other, out);
        return;
    case OP_MIN:
    case OP_MAX:
        taylor_sum(a, b, -1, &other);
        taylor_choice(&other, node->op == OP_MIN ? b : a, node->op == OP_MIN ? a : b, out);
        return;
    case OP_POSITIVE:
        taylor_choice(a, b, c, out);
        if (is_reflection(dag, node))
            *out = a->c[0] > 0 ? *b : *c;
        return;
    default: *out = taylor_constant(0); out->off = NAN;
    }
}

void enclosure_evaluate(const Dag *dag, int sample, const bool *needed, EnclosureInput *given, const void *context,
                        Quad unit, TaylorModel *node)
{
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        const Node *n = &dag->node[e];
        if (!needed[e])
            continue;
        if (n->level < LEVEL_VARIABLE) {
            node[e] = taylor_constant((Quad)ex_value(dag, e, sample));
        } else if (n->op == OP_INPUT) {
            node[e] = given(context, *n->element);
        } else {
            operate(dag, n, &node[n->arg[0]], &node[n->arg[1]], &node[n->arg[2]], &node[e]);
            if (unit > 0 && n->op != OP_NEG)
                node[e].off = node[e].off * (1 + 4 * QUAD_EPSILON) + unit * taylor_most(&node[e]);
        }
    }
}

static int sample_of(const Enclosure *e, int s)
{
    const Solved *solved = &e->exact->solved[s];
    return solved->member * (solved->formula->dag->samples / solved->formula->dag->members);
}

static void evaluate(Enclosure *e, int s, const bool *needed, bool flat, Quad off)
{
    const Inputs inputs = {.enclosure = e, .subset = s, .flat = flat, .off = off};
    enclosure_evaluate(e->exact->solved[s].formula->dag, sample_of(e, s), needed, input, &inputs, 0, e->of[s].node);
}

/* ---- derivatives by the pose ---------------------------------------------------------------------------------- */

/* a x + b y + ... added to a slope. */
static void add(TaylorModel *sum, const TaylorModel *factor, const TaylorModel *slope, int sign)
{
    TaylorModel product;
    taylor_product(factor, slope, &product);
    taylor_sum(sum, &product, sign, sum);
}

static TaylorModel *slope_at(const Enclosed *own, Ex e, int unknown)
{
    return &own->slope[(size_t)(own->place[e] * own->unknowns + unknown)];
}

/* The slope of one operation from those of its operands. */
static void slope_of(const Enclosed *own, const Node *n, Ex e, int unknown, TaylorModel *out)
{
    const TaylorModel *value = own->node, *a = &value[n->arg[0]], *b = &value[n->arg[1]];
    const TaylorModel *da = slope_at(own, n->arg[0], unknown), *db = slope_at(own, n->arg[1], unknown);
    TaylorModel sum = taylor_constant(0), part;
    switch ((Op)n->op) {
    case OP_NEG: taylor_negative(da, &sum); break;
    case OP_ADD: taylor_sum(da, db, 1, &sum); break;
    case OP_SUB: taylor_sum(da, db, -1, &sum); break;
    case OP_MUL:
        add(&sum, b, da, 1);
        add(&sum, a, db, 1);
        break;
    case OP_DIV:
        sum = *da;
        add(&sum, &value[e], db, -1);
        taylor_quotient(&sum, b, &sum);
        break;
    case OP_SQRT:
        taylor_sum(&value[e], &value[e], 1, &part);
        taylor_quotient(da, &part, &sum);
        break;
    case OP_SIN:
        taylor_sine(a, true, &part);
        add(&sum, &part, da, 1);
        break;
    case OP_COS:
        taylor_sine(a, false, &part);
        add(&sum, &part, da, -1);
        break;
    default: sum.off = NAN;
    }
    *out = sum;
}

/* Slopes of all rows' nodes, whose values are there. */
static void differentiate(Enclosure *e, int s)
{
    Enclosed *own = &e->of[s];
    const Dag *dag = e->exact->solved[s].formula->dag;
    for (Ex i = 0; i < (Ex)dag->nodes; ++i) {
        const Node *n = &dag->node[i];
        if (!own->rows_needed[i])
            continue;
        const int at = n->op == OP_INPUT ? element_index(*n->element, ARRAY_q) : -1;
        own->moves[i] = at >= 0;
        for (int k = 0; n->level == LEVEL_VARIABLE && k < ex_arity((Op)n->op); ++k)
            own->moves[i] = own->moves[i] || own->moves[n->arg[k]];
        for (int j = 0; j < own->unknowns; ++j) {
            *slope_at(own, i, j) = taylor_constant(j == at);
            if (own->moves[i] && at < 0)
                slope_of(own, n, i, j, slope_at(own, i, j));
        }
    }
}

/* ---- poses ---------------------------------------------------------------------------------------------------- */

/* Row r of F: an equation, or p . p - 1 of a body. */
static void row_value(const Enclosure *e, int s, const TaylorModel *q, int r, TaylorModel *out)
{
    const Implicit *implicit = e->exact->solved[s].formula->implicit;
    if (r < implicit->n) {
        *out = e->of[s].node[implicit->whole[r]];
        return;
    }
    const TaylorModel *p = q + 7 * (r - implicit->n) + 3;
    *out = taylor_constant(-1);
    for (int i = 0; i < 4; ++i)
        add(out, &p[i], &p[i], 1);
}

/* Its derivative by an unknown, times the unknown's scale. */
static void row_slope(const Enclosure *e, int s, int r, int j, TaylorModel *out)
{
    const Implicit *implicit = e->exact->solved[s].formula->implicit;
    const Enclosed *own = &e->of[s];
    const TaylorModel scale = taylor_constant(scale_of(e, s, j));
    TaylorModel slope = taylor_constant(0);
    if (r < implicit->n) {
        slope = *slope_at(own, implicit->whole[r], j);
    } else if (j / 7 == r - implicit->n && j % 7 > 2) {
        const Inputs inputs = {.enclosure = e, .subset = s, .flat = true, .off = tube};
        const TaylorModel p = input(&inputs, element_at(ARRAY_q, j));
        taylor_sum(&p, &p, 1, &slope);
    }
    taylor_product(&slope, &scale, out);
}

/* Y [n][n], near the inverse of G's middle; false: there is none. */
static bool inverse_of(int n, const TaylorModel *G, Quad *Y)
{
    Quad A[n][2 * n];
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j)
            A[i][j] = j < n ? G[i * n + j].c[0] : j - n == i;
    for (int k = 0; k < n; ++k) {
        int most = k;
        for (int i = k + 1; i < n; ++i)
            most = quad_abs(A[i][k]) > quad_abs(A[most][k]) ? i : most;
        if (!(quad_abs(A[most][k]) > 0))
            return false;
        for (int j = 0; j < 2 * n; ++j) {
            const Quad from = A[most][j];
            A[most][j] = A[k][j];
            A[k][j] = from;
        }
        const Quad pivot = A[k][k];
        for (int j = 0; j < 2 * n; ++j)
            A[k][j] /= pivot;
        for (int i = 0; i < n; ++i) {
            const Quad factor = A[i][k];
            for (int j = 0; i != k && j < 2 * n; ++j)
                A[i][j] -= factor * A[k][j];
        }
    }
    for (int i = 0; i < n; ++i)
        memcpy(Y + i * n, &A[i][n], (size_t)n * sizeof *Y);
    return true;
}

/* G at the present pose, poses and coordinate being anywhere in the tube and the interval. */
static void make_slopes(Enclosure *e, int s, TaylorModel *G)
{
    const int n = e->of[s].unknowns;
    evaluate(e, s, e->of[s].rows_needed, true, tube);
    differentiate(e, s);
    for (int r = 0; r < n; ++r)
        for (int j = 0; j < n; ++j)
            row_slope(e, s, r, j, &G[r * n + j]);
}

/* Newton's iteration in the middle of the interval: `exact` leaves what joints to known bodies determine to how motions
 * are made of its poses. False: it doesn't converge. */
static bool settle(Enclosure *e, int s, TaylorModel *G, Quad *Y)
{
    const int most = 12;
    Enclosed *own = &e->of[s];
    const int n = own->unknowns;
    Quad step = 1;
    for (int i = 0; i < most && step > 1e-25; ++i) {
        TaylorModel F[n];
        make_slopes(e, s, G);
        if (!inverse_of(n, G, Y))
            return false;
        for (int r = 0; r < n; ++r)
            row_value(e, s, own->q, r, &F[r]);
        step = 0;
        for (int j = 0; j < n; ++j) {
            Quad change = 0;
            for (int r = 0; r < n; ++r)
                change += Y[j * n + r] * F[r].c[0];
            own->q[j].c[0] -= change * scale_of(e, s, j);
            step = quad_max(step, quad_abs(change));
        }
    }
    return step <= 1e-25;
}

/* Chords from P: the change of each unknown, a polynomial, less Y F. Each one makes one more coefficient right. */
static void follow(Enclosure *e, int s, const Quad *Y)
{
    Enclosed *own = &e->of[s];
    const int n = own->unknowns;
    TaylorModel F[n], part, sum;
    for (int i = 0; i < TAYLOR_ORDER + 4; ++i) {
        evaluate(e, s, own->rows_needed, false, 0);
        for (int r = 0; r < n; ++r)
            row_value(e, s, own->q, r, &F[r]);
        for (int j = 0; j < n; ++j) {
            sum = own->q[j];
            for (int r = 0; r < n; ++r) {
                const TaylorModel factor = taylor_constant(Y[j * n + r] * scale_of(e, s, j));
                taylor_product(&factor, &F[r], &part);
                taylor_sum(&sum, &part, -1, &sum);
            }
            own->q[j] = sum;
            own->q[j].off = 0; /* any polynomial will do: what it is off by is found afterwards */
        }
    }
}

/* Bounds of |Y F| and |1 - Y G|. */
static void krawczyk(Enclosure *e, int s, const Quad *Y, const TaylorModel *G, Quad *z, Quad *k)
{
    const Enclosed *own = &e->of[s];
    const int n = own->unknowns;
    TaylorModel F[n];
    evaluate(e, s, own->rows_needed, false, 0);
    for (int r = 0; r < n; ++r)
        row_value(e, s, own->q, r, &F[r]);
    *z = *k = 0;
    for (int i = 0; i < n; ++i) {
        TaylorModel change = taylor_constant(0);
        Quad row = 0;
        for (int r = 0; r < n; ++r) {
            const TaylorModel factor = taylor_constant(Y[i * n + r]);
            add(&change, &factor, &F[r], 1);
        }
        for (int j = 0; j < n; ++j) {
            TaylorModel rest = taylor_constant(i == j);
            for (int r = 0; r < n; ++r) {
                const TaylorModel factor = taylor_constant(Y[i * n + r]);
                add(&rest, &factor, &G[r * n + j], -1);
            }
            row += taylor_most(&rest);
        }
        *z = quad_max(*z, taylor_most(&change));
        *k = quad_max(*k, row * (1 + 64 * QUAD_EPSILON));
    }
}

/* The tube about the poses of one subset, from the solution in the middle of the interval. */
static bool enclose_pose(Enclosure *e, int s)
{
    Enclosed *own = &e->of[s];
    const int n = own->unknowns;
    TaylorModel *G = own->G;
    Quad Y[n * n], z, k;
    for (int j = 0; j < n; ++j)
        own->q[j] = taylor_constant((Quad)e->exact->solved[s].q[j]);
    if (!settle(e, s, G, Y))
        return false;
    follow(e, s, Y);
    make_slopes(e, s, G);
    krawczyk(e, s, Y, G, &z, &k);
    if (!(k < 0.5 && (z + k * tube) * (1 + 8 * QUAD_EPSILON) < tube))
        return false;
    const Quad radius = z / (1 - k) * (1 + 16 * QUAD_EPSILON);
    for (int j = 0; j < n; ++j) {
        const Quad gap = quad_abs(taylor_end(&own->q[j], e->near) - own->met[j]) / scale_of(e, s, j);
        if (!(gap + own->met_off + 1e-12 < tube)) /* 1e-12 is more than rounding of this check */
            return false;
    }
    for (int j = 0; j < n; ++j)
        own->q[j].off = radius * scale_of(e, s, j) * (1 + 4 * QUAD_EPSILON);
    return true;
}

static bool enclose_motion(Enclosure *e, int s)
{
    Enclosed *own = &e->of[s];
    const Solved *solved = &e->exact->solved[s];
    const Formula *f = solved->formula;
    const int size = f->layout.motion_size;
    evaluate(e, s, solved->motion_needed, false, 0);
    for (int i = 0; i < f->layout.bodies * size; ++i) {
        own->motion[i] = own->node[*motion_number(&f->motion[i / size], i % size)];
        if (!quad_is_finite(taylor_most(&own->motion[i])))
            return false;
    }
    for (int i = 0; i < f->solve.checks; ++i) {
        const Check *check = &f->solve.check[i];
        Quad least, most;
        taylor_range(&own->node[check->value], &least, &most);
        if (!(least > (Quad)check->least || (check->magnitude && -most > (Quad)check->least)))
            return false;
    }
    return true;
}

bool enclosure_extend(Enclosure *e, int subset, Quad from, Quad to)
{
    const Quad middle = (from + to) / 2, half = quad_abs(to - from) / 2;
    e->near = from < to ? -1 : 1;
    Exact *exact = e->exact;
    e->x = taylor_line(middle, half * (1 + 4 * QUAD_EPSILON) + 4 * QUAD_EPSILON * quad_abs(middle));
    if (exact_solve(exact, subset, (Quad)middle))
        return false;
    for (int i = 0; i < exact->subsets; ++i) {
        const int s = exact->order[i];
        if (exact_concerns(exact, subset, s) && ((e->of[s].unknowns && !enclose_pose(e, s)) || !enclose_motion(e, s)))
            return false;
    }
    return true;
}

void enclosure_accept(Enclosure *e, int subset)
{
    const Exact *exact = e->exact;
    for (int i = 0; i < exact->subsets; ++i) {
        const int s = exact->order[i];
        Enclosed *own = &e->of[s];
        if (!exact_concerns(exact, subset, s))
            continue;
        own->met_off = 0;
        for (int j = 0; j < own->unknowns; ++j) {
            own->met[j] = taylor_end(&own->q[j], -e->near);
            own->met_off = quad_max(own->met_off, own->q[j].off / scale_of(e, s, j));
        }
    }
}

const TaylorModel *enclosure_motion(const Enclosure *enclosure, int subset)
{
    return enclosure->of[subset].motion;
}

const TaylorModel *enclosure_coordinate(const Enclosure *enclosure)
{
    return &enclosure->x;
}

Enclosure *enclosure_new(Exact *exact)
{
    Pool *pool = exact->w->pool;
    Enclosure *e = pool_alloc(pool, sizeof *e);
    *e = (Enclosure){.exact = exact, .of = pool_alloc(pool, (size_t)exact->w->sequence->subsets * sizeof *e->of)};
    for (int i = 0; i < exact->subsets; ++i) {
        Enclosed *own = &e->of[exact->order[i]];
        const Formula *f = exact->solved[exact->order[i]].formula;
        const size_t nodes = (size_t)f->dag->nodes, unknowns = f->implicit ? (size_t)(7 * f->layout.bodies) : 0;
        own->unknowns = (int)unknowns;
        own->node = pool_alloc(pool, nodes * sizeof *own->node);
        own->motion = pool_alloc(pool, (size_t)(f->layout.bodies * f->layout.motion_size) * sizeof *own->motion);
        own->q = pool_alloc(pool, (unknowns + 1) * sizeof *own->q);
        own->met = pool_alloc(pool, (unknowns + 1) * sizeof *own->met);
        if (f->implicit) {
            own->rows_needed = dag_needed(f->dag, f->implicit->whole, f->implicit->n);
            own->place = pool_alloc(pool, nodes * sizeof *own->place);
            own->moves = pool_alloc(pool, nodes);
            size_t count = 0;
            for (size_t j = 0; j < nodes; ++j)
                own->place[j] = own->rows_needed[j] ? (int)count++ : 0;
            own->slope = pool_alloc(pool, count * unknowns * sizeof *own->slope);
            own->G = pool_alloc(pool, unknowns * unknowns * sizeof *own->G);
        }
    }
    enclosure_reset(e);
    return e;
}

void enclosure_reset(Enclosure *e)
{
    exact_reset(e->exact);
    for (int i = 0; i < e->exact->subsets; ++i) {
        const int s = e->exact->order[i];
        Enclosed *own = &e->of[s];
        own->met_off = 0;
        for (int j = 0; j < own->unknowns; ++j)
            own->met[j] = (Quad)e->exact->solved[s].q[j];
    }
}
