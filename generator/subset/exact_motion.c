/* SPDX-License-Identifier: MIT
 * Motions of subsets of one coordinate in quad precision. The graph of a class is evaluated node by node; Newton's
 * iteration goes on until corrections are rounding. */
#include "subset/exact_motion.h"

#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"

#include <math.h>
#include <string.h>

static Quad sine(Quad a, bool cosine)
{
    Quad s, c;
    quad_sincos(a, &s, &c);
    return cosine ? c : s;
}

static Quad operate(const Node *node, Quad a, Quad b, Quad c)
{
    switch ((Op)node->op) {
    case OP_NEG: return -a;
    case OP_ADD: return a + b;
    case OP_SUB: return a - b;
    case OP_MUL: return a * b;
    case OP_DIV: return a / b;
    case OP_SQRT: return quad_sqrt(a);
    case OP_ABS: return quad_abs(a);
    case OP_SIN: return sine(a, false);
    case OP_COS: return sine(a, true);
    case OP_TAN: return sine(a, false) / sine(a, true);
    case OP_ASIN: return quad_atan2(a, quad_sqrt(1 - a * a));
    case OP_ACOS: return quad_atan2(quad_sqrt(1 - a * a), a);
    case OP_ATAN: return quad_atan2(a, 1);
    case OP_EXP: return quad_exp(a);
    case OP_LOG: return quad_log(a);
    case OP_TANH: return 1 - 2 / (quad_exp(2 * a) + 1);
    case OP_POW: return quad_exp(b * quad_log(a));
    case OP_ATAN2: return quad_atan2(a, b);
    case OP_MIN: return a < b ? a : b;
    case OP_MAX: return a > b ? a : b;
    case OP_POSITIVE: return a > 0 ? b : c;
    default: return NAN; /* a table: no polynomial */
    }
}

static Quad input(const Exact *exact, int s, Element e, Quad x)
{
    const Subset *subset = &exact->w->sequence->subset[s];
    switch (e.array) {
    case ARRAY_x: return x;
    case ARRAY_rate: return 1;
    case ARRAY_turn: return 0;
    case ARRAY_ahead: return 0;
    case ARRAY_q: return exact->solved[s].q[e.index];
    case ARRAY_known: {
        const int body = subset->known[e.which], owner = exact->w->sequence->body_subset[body];
        const Solved *from = &exact->solved[owner];
        const int size = from->formula->layout.motion_size;
        return from->motion[subset_place(&exact->w->sequence->subset[owner], body) * size + e.index];
    }
    default: return NAN;
    }
}

static void evaluate(const Exact *exact, int s, const bool *needed, Quad x)
{
    Solved *own = &exact->solved[s];
    const Dag *dag = own->formula->dag;
    const int each = dag->samples / dag->members;
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        if (!needed[e])
            continue;
        if (node->level < LEVEL_VARIABLE)
            own->node[e] = ex_value(dag, e, own->member * each);
        else if (node->op == OP_INPUT)
            own->node[e] = ex_is_number(dag, e) ? (Quad)node->element->number : input(exact, s, *node->element, x);
        else
            own->node[e] = operate(node, own->node[node->arg[0]], own->node[node->arg[1]], own->node[node->arg[2]]);
    }
}

/* Roots: all numbers of the motion, and the checks of `solve`. */
static const bool *motion_nodes(const Exact *exact, const Formula *f, int bodies)
{
    const int size = f->layout.motion_size, count = bodies * size + f->solve.checks;
    Ex root[count + 1];
    for (int i = 0; i < bodies * size; ++i)
        root[i] = *motion_number(&f->motion[i / size], i % size);
    for (int i = 0; i < f->solve.checks; ++i)
        root[bodies * size + i] = f->solve.check[i].value;
    (void)exact;
    return dag_needed(f->dag, root, count);
}

/* A subset and those that it refers to, these first. */
static void add_subset(Exact *exact, Formula *const *made, const Formula *own, int s)
{
    Work *w = exact->w;
    const Subset *subset = &w->sequence->subset[s];
    Solved *solved = &exact->solved[s];
    if (solved->formula || subset->class < 0)
        return;
    const Class *class = &w->sequence->class[subset->class];
    const Formula *f = class == w->class ? own : made[subset->class];
    const size_t nodes = (size_t)f->dag->nodes;
    *solved = (Solved){
        .formula = f,
        .member = class_place(class, s),
        .motion_needed = motion_nodes(exact, f, subset->bodies),
        .node = pool_alloc(w->pool, nodes * sizeof *solved->node),
        .motion = pool_alloc(w->pool, (size_t)(subset->bodies * f->layout.motion_size) * sizeof *solved->motion)};
    if (f->implicit) {
        solved->pose_needed = dag_needed(f->dag, f->implicit->found, 7 * subset->bodies);
        solved->q = pool_alloc(w->pool, (size_t)(7 * subset->bodies) * sizeof *solved->q);
    }
    for (int i = 0; i < subset->knowns; ++i)
        add_subset(exact, made, own, w->sequence->body_subset[subset->known[i]]);
    exact->order[exact->subsets++] = s;
}

Exact *exact_new(Work *w, Formula *const *made, const Formula *own, const Sampling *sampling)
{
    Exact *exact = pool_alloc(w->pool, sizeof *exact);
    const size_t subsets = (size_t)w->sequence->subsets;
    *exact = (Exact){.w = w,
                     .sampling = sampling,
                     .solved = pool_alloc(w->pool, subsets * sizeof *exact->solved),
                     .order = pool_alloc(w->pool, subsets * sizeof *exact->order)};
    for (int m = 0; m < w->class->members; ++m)
        add_subset(exact, made, own, w->class->member[m]);
    exact_reset(exact);
    return exact;
}

bool exact_is_tuned(const Exact *exact)
{
    for (int i = 0; i < exact->subsets; ++i) {
        const Solved *own = &exact->solved[exact->order[i]];
        for (Ex e = 0; e < (Ex)own->formula->dag->nodes; ++e) {
            const Node *node = &own->formula->dag->node[e];
            if ((own->motion_needed[e] || (own->pose_needed && own->pose_needed[e])) && node->op == OP_INPUT &&
                node->element->array == ARRAY_d)
                return true;
        }
    }
    return false;
}

void exact_reset(Exact *exact)
{
    const Work *w = exact->w;
    for (int i = 0; i < exact->subsets; ++i) {
        const Subset *subset = &w->sequence->subset[exact->order[i]];
        const Solved *own = &exact->solved[exact->order[i]];
        for (int b = 0; own->q && b < subset->bodies; ++b) {
            double q[7];
            sampling_design(exact->sampling, w->model, w->origin, subset_anchor(w->model, w->sequence, exact->order[i]),
                            subset->body[b], q);
            for (int j = 0; j < 7; ++j)
                own->q[7 * b + j] = q[j];
        }
    }
}

/* Newton's iteration of one subset. */
static const char *iterate(Exact *exact, int s, Quad x)
{
    const int most = 40;
    const Quad leap = 0.3, done = 1e-31, good = 1e-24;
    Solved *own = &exact->solved[s];
    const Formula *f = own->formula;
    const int count = 7 * exact->w->sequence->subset[s].bodies;
    Quad size = f->size, before = HUGE_VAL;
    for (int j = 0; j < count; ++j)
        if (j % 7 < 3)
            size = quad_max(size, quad_abs(own->q[j]));
    for (int i = 0; i < most; ++i) {
        Quad step = 0;
        evaluate(exact, s, own->pose_needed, x);
        for (int j = 0; j < count; ++j) {
            const Quad to = own->node[f->implicit->found[j]];
            const Quad change = quad_abs(to - own->q[j]) / (j % 7 < 3 ? size : 1);
            step = change <= step ? step : change; /* NaN is kept */
            own->q[j] = to;
        }
        if (!(step < leap))
            return "the bodies move too far";
        if (step <= done || (step <= good && step >= before / 2))
            return NULL;
        before = step;
    }
    return "Newton's iteration does not converge";
}

static const char *solve_one(Exact *exact, int s, Quad x)
{
    Solved *own = &exact->solved[s];
    const Formula *f = own->formula;
    const int bodies = exact->w->sequence->subset[s].bodies, size = f->layout.motion_size;
    const char *lost = f->implicit ? iterate(exact, s, x) : NULL;
    if (lost)
        return lost;
    evaluate(exact, s, own->motion_needed, x);
    for (int i = 0; i < bodies * size; ++i) {
        own->motion[i] = own->node[*motion_number(&f->motion[i / size], i % size)];
        if (!quad_is_finite(own->motion[i]))
            return "the motion is not finite";
    }
    for (int i = 0; i < f->solve.checks; ++i) {
        const Check *check = &f->solve.check[i];
        const Quad value = own->node[check->value];
        if (!((check->magnitude ? quad_abs(value) : value) > check->least))
            return "the coordinate stops being independent";
    }
    return NULL;
}

bool exact_concerns(const Exact *exact, int subset, int other)
{
    /* members of a class have coordinates of their own: subsets that others refer to are left alone */
    const Subset *own = &exact->w->sequence->subset[subset], *it = &exact->w->sequence->subset[other];
    return other == subset || it->deps == 0 || (it->dep[0] == own->dep[0] && other < subset);
}

const char *exact_solve(Exact *exact, int subset, Quad x)
{
    for (int i = 0; i < exact->subsets; ++i) {
        const int s = exact->order[i];
        const char *lost = exact_concerns(exact, subset, s) ? solve_one(exact, s, x) : NULL;
        if (lost)
            return lost;
    }
    return NULL;
}

const Quad *exact_numbers(const Exact *exact, int subset)
{
    return exact->solved[subset].motion;
}

const Quad *exact_pose(const Exact *exact, int subset)
{
    return exact->solved[subset].q;
}
