/* SPDX-License-Identifier: MIT
 * The expression graph against an interpreter of its own: simplification must not change values, equal expressions must
 * be one node, operations must be counted, and depth must not cost stack. */
#include "base/random.h"
#include "base/text.h"
#include "emit/emit.h"
#include "expression/expression.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { MEMBERS = 3, SAMPLES = 6, TERMS = 60 };

/* An expression and what it should be: a value in extended precision at each sample, and how far rounding may have
 * taken a computation in double from it, whatever the order of its operations. */
typedef struct Term {
    Ex e;
    long double value[SAMPLES], error[SAMPLES];
} Term;

static const long double unit = DBL_EPSILON;

/* ---- the interpreter ------------------------------------------------------------------------------------- */

/* One operation at one sample; false where its value would say nothing (a division by almost zero, a branch that
 * rounding could turn). */
static bool interpret(Op op, const Term *a, const Term *b, const Term *c, int s, long double *value, long double *error)
{
    long double x = a->value[s], y = b->value[s], z = c->value[s];
    long double ex = a->error[s], ey = b->error[s], ez = c->error[s];
    switch (op) {
    case OP_NEG: *value = -x, *error = ex; break;
    case OP_ADD: *value = x + y, *error = ex + ey; break;
    case OP_SUB: *value = x - y, *error = ex + ey; break;
    case OP_MUL: *value = x * y, *error = ex * fabsl(y) + ey * fabsl(x) + ex * ey; break;
    case OP_DIV:
        if (fabsl(y) < 0.01L)
            return false;
        *value = x / y, *error = (ex + fabsl(x / y) * ey) / (fabsl(y) - ey);
        break;
    case OP_SQRT:
        if (x < 0.01L)
            return false;
        *value = sqrtl(x), *error = ex / sqrtl(x);
        break;
    case OP_ABS: *value = fabsl(x), *error = ex; break;
    case OP_SIN: *value = sinl(x), *error = ex + unit; break;
    case OP_COS: *value = cosl(x), *error = ex + unit; break;
    case OP_ATAN2:
        if (x * x + y * y < 0.01L || fabsl(x) < 0.001L)
            return false;
        *value = atan2l(x, y), *error = 2 * (ex * fabsl(y) + ey * fabsl(x)) / (x * x + y * y) + unit;
        break;
    case OP_MIN: *value = fminl(x, y), *error = fmaxl(ex, ey); break;
    case OP_MAX: *value = fmaxl(x, y), *error = fmaxl(ex, ey); break;
    case OP_POSITIVE:
        if (fabsl(x) <= 2 * ex)
            return false;
        *value = x > 0 ? y : z, *error = x > 0 ? ey : ez;
        break;
    default: return false;
    }
    *error += 4 * unit * fabsl(*value);
    return fabsl(*value) < 1e6L && *error < 1e-6L;
}

/* The same operation in the graph, through the functions that simplify where there is one. */
static Ex build(Dag *dag, Op op, Ex a, Ex b, Ex c)
{
    switch (op) {
    case OP_NEG: return ex_neg(dag, a);
    case OP_ADD: return ex_add(dag, a, b);
    case OP_SUB: return ex_sub(dag, a, b);
    case OP_MUL: return ex_mul(dag, a, b);
    case OP_DIV: return ex_div(dag, a, b);
    case OP_SQRT: return ex_sqrt(dag, a);
    case OP_ABS:
    case OP_SIN:
    case OP_COS: return ex_op(dag, op, a, 0, 0);
    case OP_POSITIVE: return ex_op(dag, op, a, b, c);
    default: return ex_op(dag, op, a, b, 0);
    }
}

/* ---- random expressions ---------------------------------------------------------------------------------- */

enum { INPUTS = 5 };

static Term leaf(Dag *dag, Random *random, int index)
{
    static const double special[] = {0, 1, -1, 2, -0.5};
    enum { SPECIAL = sizeof special / sizeof *special };
    Term term = {0};
    double value[SAMPLES];
    if (index < INPUTS) {
        for (int s = 0; s < SAMPLES; ++s)
            value[s] = random_uniform(random, -3, 3);
        term.e = ex_input(dag, element_at(ARRAY_q, index), value);
    } else if (index < INPUTS + SPECIAL) {
        for (int s = 0; s < SAMPLES; ++s)
            value[s] = special[index - INPUTS];
        term.e = ex_literal(dag, value[0]);
    } else {
        double member[MEMBERS];
        for (int m = 0; m < MEMBERS; ++m)
            member[m] = random_uniform(random, -3, 3);
        for (int s = 0; s < SAMPLES; ++s)
            value[s] = member[s / (SAMPLES / MEMBERS)];
        term.e = ex_constant(dag, member);
    }
    for (int s = 0; s < SAMPLES; ++s)
        term.value[s] = value[s];
    return term;
}

/* TERMS random expressions, each of earlier ones; the same for the same seed. Returns how many operations took part. */
static int grow(Dag *dag, uint64_t seed, Term term[TERMS])
{
    static const Op choice[] = {OP_NEG, OP_NEG,  OP_ADD, OP_ADD, OP_SUB, OP_SUB,   OP_MUL, OP_MUL, OP_MUL,
                                OP_DIV, OP_SQRT, OP_ABS, OP_SIN, OP_COS, OP_ATAN2, OP_MIN, OP_MAX, OP_POSITIVE};
    Random random = {seed};
    int count = 0, operations = 0;
    while (count < INPUTS + 8) {
        term[count] = leaf(dag, &random, count);
        ++count;
    }
    while (count < TERMS) {
        Op op = choice[random_bits(&random) % (sizeof choice / sizeof *choice)];
        const Term *a = &term[random_bits(&random) % (uint64_t)count],
                   *b = &term[random_bits(&random) % (uint64_t)count],
                   *c = &term[random_bits(&random) % (uint64_t)count];
        Term *out = &term[count];
        bool good = true;
        for (int s = 0; s < SAMPLES; ++s)
            good = good && interpret(op, a, b, c, s, &out->value[s], &out->error[s]);
        if (!good)
            continue;
        out->e = build(dag, op, a->e, b->e, c->e);
        ++count;
        ++operations;
    }
    return operations;
}

static void assert_terms(const Dag *dag, const Term term[TERMS])
{
    for (int i = 0; i < TERMS; ++i)
        for (int s = 0; s < SAMPLES; ++s)
            if (!(fabsl(ex_value(dag, term[i].e, s) - term[i].value[s]) <= term[i].error[s]))
                fail_msg("term %d, sample %d: %.17g instead of %.21Lg", i, s, ex_value(dag, term[i].e, s),
                         term[i].value[s]);
}

static void test_random_values(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 300; ++seed) {
        Pool *pool = pool_new();
        Dag *dag = dag_new(pool, MEMBERS, SAMPLES);
        Term term[TERMS];
        int operations = grow(dag, seed, term);
        assert_true(operations > 40);
        assert_terms(dag, term);
        pool_free(pool);
    }
}

/* Built again, the same expressions are the same nodes, and none is new. */
static void test_sharing(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 50; ++seed) {
        Pool *pool = pool_new();
        Dag *dag = dag_new(pool, MEMBERS, SAMPLES);
        Term first[TERMS], second[TERMS];
        grow(dag, seed, first);
        int nodes = dag->nodes;
        grow(dag, seed, second);
        assert_int_equal(dag->nodes, nodes);
        for (int i = 0; i < TERMS; ++i)
            assert_int_equal(first[i].e, second[i].e);
        pool_free(pool);
    }
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    /* 0 is one number whatever its sign */
    Ex x = ex_input(dag, element_at(ARRAY_q, 0), NULL), y = ex_input(dag, element_at(ARRAY_q, 1), NULL);
    assert_int_equal(ex_input(dag, element_at(ARRAY_q, 0), NULL), x);
    assert_int_not_equal(x, y);
    assert_int_equal(ex_literal(dag, -0.0), ex_literal(dag, 0.0));
    assert_int_equal(ex_literal(dag, 0), 0);
    assert_int_not_equal(ex_literal(dag, 0.1), ex_literal(dag, nextafter(0.1, 1)));
    assert_int_equal(ex_add(dag, x, y), ex_add(dag, y, x));
    assert_int_equal(ex_mul(dag, x, y), ex_mul(dag, y, x));
    assert_int_not_equal(ex_sub(dag, x, y), ex_sub(dag, y, x));
    assert_int_not_equal(ex_op(dag, OP_ROAD_PART, ex_op(dag, OP_ROAD, x, y, 0), 1, 0),
                         ex_op(dag, OP_ROAD_PART, ex_op(dag, OP_ROAD, x, y, 0), 2, 0));
    pool_free(pool);
}

/* Values computed again are those of construction, at new inputs too, and other samples stay. */
static void test_evaluate(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 50; ++seed) {
        Pool *pool = pool_new();
        Dag *dag = dag_new(pool, MEMBERS, SAMPLES);
        Term term[TERMS];
        grow(dag, seed, term);
        size_t numbers = (size_t)dag->nodes * SAMPLES;
        double *built = pool_alloc(pool, numbers * sizeof *built);
        memcpy(built, dag->value, numbers * sizeof *built);
        /* nonsense into two samples, then back */
        double old[INPUTS][2];
        for (int i = 0; i < INPUTS; ++i)
            for (int s = 2; s < 4; ++s) {
                old[i][s - 2] = ex_value(dag, term[i].e, s);
                ex_set_sample(dag, term[i].e, s, 1.25 * i - s);
            }
        dag_evaluate(dag, 2, 2);
        int changed = 0;
        for (size_t i = 0; i < numbers; ++i) {
            bool inside = i % SAMPLES == 2 || i % SAMPLES == 3;
            if (inside)
                changed += memcmp(&dag->value[i], &built[i], sizeof built[i]) != 0;
            else
                assert_memory_equal(&dag->value[i], &built[i], sizeof built[i]);
        }
        assert_true(changed >= 2 * INPUTS);
        for (int i = 0; i < INPUTS; ++i)
            for (int s = 2; s < 4; ++s)
                ex_set_sample(dag, term[i].e, s, old[i][s - 2]);
        dag_evaluate(dag, 2, 2);
        assert_memory_equal(dag->value, built, numbers * sizeof *built);
        pool_free(pool);
    }
}

/* ---- simplification -------------------------------------------------------------------------------------- */

static void test_identities(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 2, 2);
    Ex x = ex_input(dag, element_at(ARRAY_x, 0), (double[]){1.5, -2.5}),
       y = ex_input(dag, element_at(ARRAY_y, 0), (double[]){0.75, 3});
    Ex zero = ex_literal(dag, 0), one = ex_literal(dag, 1), minus = ex_literal(dag, -1);
    int nodes = dag->nodes;
    assert_int_equal(ex_add(dag, x, zero), x);
    assert_int_equal(ex_add(dag, zero, x), x);
    assert_int_equal(ex_sub(dag, x, zero), x);
    assert_int_equal(ex_mul(dag, x, one), x);
    assert_int_equal(ex_mul(dag, one, x), x);
    assert_int_equal(ex_mul(dag, x, zero), zero);
    assert_int_equal(ex_mul(dag, zero, x), zero);
    assert_int_equal(ex_div(dag, x, one), x);
    assert_int_equal(ex_div(dag, zero, x), zero);
    assert_int_equal(ex_sub(dag, x, x), zero);
    assert_int_equal(dag->nodes, nodes); /* none of these needed a node */
    Ex negative = ex_neg(dag, x);
    assert_int_equal(ex_neg(dag, negative), x);
    assert_int_equal(ex_sub(dag, zero, x), negative);
    assert_int_equal(ex_mul(dag, minus, x), negative);
    assert_int_equal(ex_mul(dag, x, minus), negative);
    assert_int_equal(ex_div(dag, x, minus), negative);
    assert_int_equal(ex_sub(dag, y, negative), ex_add(dag, x, y));
    assert_int_equal(ex_add(dag, y, negative), ex_sub(dag, y, x));
    assert_int_equal(ex_add(dag, negative, y), ex_sub(dag, y, x));
    assert_int_equal(ex_sub(dag, negative, y), ex_neg(dag, ex_add(dag, x, y)));
    assert_int_equal(ex_add(dag, negative, ex_neg(dag, y)), ex_neg(dag, ex_add(dag, x, y)));
    assert_int_equal(ex_neg(dag, ex_sub(dag, x, y)), ex_sub(dag, y, x));
    assert_int_equal(ex_mul(dag, negative, ex_neg(dag, y)), ex_mul(dag, x, y));
    assert_int_equal(ex_mul(dag, negative, y), ex_neg(dag, ex_mul(dag, x, y)));
    assert_int_equal(ex_mul(dag, y, negative), ex_neg(dag, ex_mul(dag, x, y)));
    assert_int_equal(ex_div(dag, negative, y), ex_neg(dag, ex_div(dag, x, y)));
    /* constant factors gather: 2 ((x 3) 0.25) = 1.5 x, one product */
    Ex gathered =
        ex_mul(dag, ex_literal(dag, 2), ex_mul(dag, ex_mul(dag, x, ex_literal(dag, 3)), ex_literal(dag, 0.25)));
    assert_int_equal(gathered, ex_mul(dag, ex_literal(dag, 1.5), x));
    assert_int_equal(ex_div(dag, ex_mul(dag, ex_literal(dag, 4), x), ex_literal(dag, 4)), x);
    pool_free(pool);
}

/* What depends on constants alone is folded member by member, into a literal where all members agree. */
static void test_constants(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 2, 6);
    Ex a = ex_constant(dag, (double[]){1, 2}), b = ex_constant(dag, (double[]){5, 4}),
       x = ex_input(dag, element_at(ARRAY_x, 0), NULL);
    assert_int_equal(dag->node[a].level, LEVEL_CONSTANT);
    for (int s = 0; s < 6; ++s)
        assert_true(ex_value(dag, a, s) == (s < 3 ? 1 : 2));
    assert_int_equal(ex_constant(dag, (double[]){1, 2}), a);
    assert_int_equal(ex_constant(dag, (double[]){7, 7}), ex_literal(dag, 7));
    assert_int_equal(ex_constant(dag, (double[]){0.0, -0.0}), ex_literal(dag, 0));
    Ex product = ex_mul(dag, a, b);
    assert_int_equal(product, ex_constant(dag, (double[]){5, 8}));
    assert_int_equal(ex_add(dag, a, b), ex_literal(dag, 6));
    assert_true(ex_is(dag, ex_add(dag, a, b), 6));
    assert_false(ex_is(dag, a, 1)); /* one member's value is not the class's */
    assert_int_equal(ex_op(dag, OP_POSITIVE, ex_sub(dag, a, b), a, b), b);
    assert_int_equal(ex_op(dag, OP_MAX, a, ex_literal(dag, 1.5), 0), ex_constant(dag, (double[]){1.5, 2}));
    assert_int_equal(ex_sqrt(dag, ex_mul(dag, b, b)), b);
    assert_int_equal(ex_mul(dag, a, ex_mul(dag, x, b)), ex_mul(dag, product, x));
    assert_int_equal(ex_div(dag, x, a), ex_mul(dag, x, ex_constant(dag, (double[]){1, 0.5})));
    assert_int_equal(dag->node[ex_add(dag, a, x)].level, LEVEL_VARIABLE);
    /* the road is known at run time only, wherever it is asked */
    assert_int_equal(dag->node[ex_op(dag, OP_ROAD, a, b, 0)].level, LEVEL_VARIABLE);
    pool_free(pool);
}

static void test_branches(void **state)
{
    (void)state;
    static const double x[6] = {-2, -0.0, 0, 1e-300, 3, 5}, y[6] = {1, 1, -1, 2, 3, 4}, z[6] = {9, 8, 7, 6, 5, 4};
    static const double positive[6] = {9, 8, 7, 2, 3, 4}, least[6] = {-2, 0, -1, 1e-300, 3, 4},
                        most[6] = {1, 1, 0, 2, 3, 5};
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 6);
    Ex a = ex_input(dag, element_at(ARRAY_x, 0), x), b = ex_input(dag, element_at(ARRAY_y, 0), y),
       c = ex_input(dag, element_at(ARRAY_e, 0), z);
    Ex p = ex_op(dag, OP_POSITIVE, a, b, c), low = ex_op(dag, OP_MIN, a, b, 0), high = ex_op(dag, OP_MAX, a, b, 0);
    for (int s = 0; s < 6; ++s) {
        assert_true(ex_value(dag, p, s) == positive[s]);
        assert_true(ex_value(dag, low, s) == least[s]);
        assert_true(ex_value(dag, high, s) == most[s]);
    }
    pool_free(pool);
}

/* ---- vectors --------------------------------------------------------------------------------------------- */

/* The rotation is A(p) = (2 e0^2 - 1) I + 2 (e e^T + e0 [e]x) for normalized p, and the vector operations are their
 * own. */
static void test_vectors(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Random random = {5};
    double p[4], x[3], y[3], norm = 0;
    for (int i = 0; i < 4; ++i) {
        p[i] = random_uniform(&random, -1, 1);
        norm += p[i] * p[i];
    }
    for (int i = 0; i < 4; ++i)
        p[i] /= sqrt(norm);
    Ex pe[4], xe[3], ye[3], A[9], out[3];
    for (int i = 0; i < 4; ++i)
        pe[i] = ex_input(dag, element_at(ARRAY_p, i), &p[i]);
    for (int i = 0; i < 3; ++i) {
        x[i] = random_uniform(&random, -1, 1);
        y[i] = random_uniform(&random, -1, 1);
        xe[i] = ex_input(dag, element_at(ARRAY_x, i), &x[i]);
        ye[i] = ex_input(dag, element_at(ARRAY_y, i), &y[i]);
    }
    const double *e = p + 1, skew[9] = {0, -e[2], e[1], e[2], 0, -e[0], -e[1], e[0], 0};
    double expected[9];
    ex_rotation(dag, pe, A);
    for (int i = 0; i < 9; ++i) {
        expected[i] = 2 * (e[i / 3] * e[i % 3] + p[0] * skew[i]) + (i % 4 ? 0 : 2 * p[0] * p[0] - 1);
        assert_true(fabs(ex_value(dag, A[i], 0) - expected[i]) < 1e-15);
    }
    ex_apply(dag, A, xe, out);
    for (int i = 0; i < 3; ++i)
        assert_true(fabs(ex_value(dag, out[i], 0) -
                         (expected[3 * i] * x[0] + expected[3 * i + 1] * x[1] + expected[3 * i + 2] * x[2])) < 1e-15);
    ex_apply_transposed(dag, A, xe, out);
    for (int i = 0; i < 3; ++i)
        assert_true(fabs(ex_value(dag, out[i], 0) -
                         (expected[i] * x[0] + expected[3 + i] * x[1] + expected[6 + i] * x[2])) < 1e-15);
    ex_cross(dag, xe, ye, out);
    assert_true(fabs(ex_value(dag, out[0], 0) - (x[1] * y[2] - x[2] * y[1])) < 1e-15);
    assert_true(fabs(ex_value(dag, out[1], 0) - (x[2] * y[0] - x[0] * y[2])) < 1e-15);
    assert_true(fabs(ex_value(dag, out[2], 0) - (x[0] * y[1] - x[1] * y[0])) < 1e-15);
    assert_true(fabs(ex_value(dag, ex_dot(dag, xe, ye), 0) - (x[0] * y[0] + x[1] * y[1] + x[2] * y[2])) < 1e-15);
    pool_free(pool);
}

/* ---- counting -------------------------------------------------------------------------------------------- */

static void assert_count(const Dag *dag, const Ex *root, int roots, int add, int multiply, int divide, int root_count,
                         int function)
{
    Count count = dag_count(dag, root, roots);
    assert_int_equal(count.add, add);
    assert_int_equal(count.multiply, multiply);
    assert_int_equal(count.divide, divide);
    assert_int_equal(count.root, root_count);
    assert_int_equal(count.function, function);
}

static void test_count(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 2, 2);
    Ex x[3], y[3], p[4], out[3], A[9];
    for (int i = 0; i < 4; ++i)
        p[i] = ex_input(dag, element_at(ARRAY_p, i), NULL);
    for (int i = 0; i < 3; ++i) {
        x[i] = ex_input(dag, element_at(ARRAY_x, i), NULL);
        y[i] = ex_input(dag, element_at(ARRAY_y, i), NULL);
    }
    assert_count(dag, x, 3, 0, 0, 0, 0, 0);
    ex_cross(dag, x, y, out);
    assert_count(dag, out, 3, 3, 6, 0, 0, 0);
    assert_count(dag, out, 1, 1, 2, 0, 0, 0);
    out[0] = out[1] = ex_dot(dag, x, x); /* asked for twice, computed once */
    assert_count(dag, out, 2, 2, 3, 0, 0, 0);
    /* twice e (3 additions), its squares, products and turns (9), six sums of two and three more from 1 */
    ex_rotation(dag, p, A);
    assert_count(dag, A, 9, 15, 9, 0, 0, 0);
    /* (x + y)^2 / sqrt(x + y) + sin x cos x + atan2: the sum is shared */
    Ex sum = ex_add(dag, x[0], y[0]);
    Ex part = ex_div(dag, ex_mul(dag, sum, sum), ex_sqrt(dag, sum));
    Ex wave = ex_mul(dag, ex_op(dag, OP_SIN, x[0], 0, 0), ex_op(dag, OP_COS, x[0], 0, 0));
    out[0] = ex_add(dag, ex_add(dag, part, wave), ex_op(dag, OP_ATAN2, x[0], y[0], 0));
    assert_count(dag, out, 1, 3, 2, 1, 1, 3);
    /* signs and constants cost nothing: -(k m x) is one product, y / k another */
    Ex k = ex_constant(dag, (double[]){2, 3}), m = ex_constant(dag, (double[]){5, 7});
    out[0] = ex_neg(dag, ex_mul(dag, k, ex_mul(dag, m, x[0])));
    out[1] = ex_mul(dag, k, m);
    out[2] = ex_div(dag, y[0], k);
    assert_count(dag, out, 2, 0, 1, 0, 0, 0);
    assert_count(dag, out, 3, 0, 2, 0, 0, 0);
    pool_free(pool);
}

/* ---- trigonometry ---------------------------------------------------------------------------------------- */

/* (x y + x z) / sqrt(x y), where x y, or the negative of x z, is there already */
static void test_count_above(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    const double sample[] = {2, 3, 5};
    const Ex x = ex_input(dag, element_at(ARRAY_x, 0), sample), y = ex_input(dag, element_at(ARRAY_y, 0), sample + 1),
             z = ex_input(dag, element_at(ARRAY_e, 0), sample + 2);
    const Ex xy = ex_mul(dag, x, y), xz = ex_mul(dag, x, z), minus = ex_neg(dag, xz);
    const Ex root = ex_div(dag, ex_add(dag, xy, xz), ex_op(dag, OP_SQRT, xy, 0, 0));
    assert_count(dag, &root, 1, 1, 2, 1, 1, 0);
    const Count one = dag_count_above(dag, &root, 1, &xy, 1), other = dag_count_above(dag, &root, 1, &minus, 1);
    const Count both = dag_count_above(dag, &root, 1, (const Ex[]){xy, xz}, 2);
    const Count all = dag_count_above(dag, &root, 1, &root, 1);
    assert_int_equal(one.multiply, 1);
    assert_int_equal(other.multiply, 1);
    assert_int_equal(both.multiply, 0);
    assert_int_equal(both.add, 1);
    assert_int_equal(both.divide, 1);
    assert_int_equal(both.root, 1);
    assert_int_equal(all.divide, 0);
    pool_free(pool);
}

static void test_sincos(void **state)
{
    (void)state;
    /* two units in the last place of 1; the reference is extended precision */
    const long double tolerance = 2.3e-16L;
    Random random = {11};
    long double worst = 0;
    for (int i = 0; i < 200000; ++i) {
        double x;
        switch (i % 5) {
        case 0: x = random_uniform(&random, -1e6, 1e6); break;
        case 4: x = ldexp(random_uniform(&random, -1, 1), i / 5 % 70); break; /* many turns */
        case 1: x = random_uniform(&random, -10, 10); break;
        case 2: x = (double)(i % 1000 - 500) * 1.5707963267948966; break; /* where one of them vanishes */
        default: x = nextafter((double)(i % 400000 - 200000) * 0.78539816339744831, 0); break; /* where octants meet */
        }
        double sine, cosine;
        portable_sincos(x, &sine, &cosine);
        worst = fmaxl(worst, fmaxl(fabsl(sine - sinl(x)), fabsl(cosine - cosl(x))));
    }
    if (!(worst <= tolerance))
        fail_msg("error %.3Lg", worst);
    double sine, cosine;
    portable_sincos(0, &sine, &cosine);
    assert_true(sine == 0 && cosine == 1);
    portable_sincos(1e-300, &sine, &cosine);
    assert_true(sine == 1e-300 && cosine == 1);
}

/* ---- size ------------------------------------------------------------------------------------------------ */

enum { LINKS = 500000, SMALL_STACK = 64 << 10 };

/* e = e a + b, half a million times: a million nodes, each the argument of the next. Returns the argument when all is
 * well. */
static void *long_sum(void *argument)
{
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Ex a = ex_input(dag, element_at(ARRAY_y, 0), (double[]){0.5}),
       b = ex_input(dag, element_at(ARRAY_e, 0), (double[]){1}),
       e = ex_input(dag, element_at(ARRAY_e, 0), (double[]){0});
    for (int i = 0; i < LINKS; ++i)
        e = ex_add(dag, ex_mul(dag, e, a), b);
    Count count = dag_count(dag, &e, 1);
    ex_set_sample(dag, b, 0, 3);
    dag_evaluate(dag, 0, 1);
    Block block = {.dag = dag};
    block_store(&block, e, element_at(ARRAY_x, 0));
    Text out = {.pool = pool};
    Constants constants = {0};
    block_emit(&out, &block, &style_readable, &constants, 0);
    int products = 0;
    for (const char *s = out.s; (s = strchr(s, '*')) != NULL; ++s)
        ++products;
    bool good =
        count.add == LINKS && count.multiply == LINKS && fabs(ex_value(dag, e, 0) - 6) < 1e-12 && products == LINKS;
    pool_free(pool);
    return good ? argument : NULL;
}

/* e = |sin e|: no operation here has a second argument. */
static void *long_nest(void *argument)
{
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Ex e = ex_input(dag, element_at(ARRAY_e, 0), (double[]){0.5});
    for (int i = 0; i < LINKS; ++i)
        e = ex_op(dag, OP_ABS, ex_op(dag, OP_SIN, e, 0, 0), 0, 0);
    Count count = dag_count(dag, &e, 1);
    Block block = {.dag = dag};
    block_store(&block, e, element_at(ARRAY_x, 0));
    Text out = {.pool = pool};
    Constants constants = {0};
    block_emit(&out, &block, &style_readable, &constants, 0);
    int sines = 0;
    for (const char *s = out.s; (s = strchr(s, 'N')) != NULL; ++s) /* the N of GIC_SIN; there is no other */
        ++sines;
    bool good = count.function == LINKS && sines == LINKS;
    pool_free(pool);
    return good ? argument : NULL;
}

/* In a process of its own, for an overflow ends the process, and in a thread, for its stack can be small. */
static void assert_on_small_stack(void *work(void *))
{
    int status = 0;
    pid_t child = fork();
    assert_true(child >= 0);
    if (!child) {
        pthread_attr_t attributes;
        pthread_t thread;
        void *good = NULL;
        signal(SIGSEGV, SIG_DFL);
        signal(SIGBUS, SIG_DFL);
        if (pthread_attr_init(&attributes) || pthread_attr_setstacksize(&attributes, SMALL_STACK) ||
            pthread_create(&thread, &attributes, work, &status) || pthread_join(thread, &good))
            _exit(3);
        _exit(good ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFSIGNALED(status))
        fail_msg("ended by signal %d", WTERMSIG(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void test_million_sums(void **state)
{
    (void)state;
    assert_on_small_stack(long_sum);
}

static void test_million_nested(void **state)
{
    (void)state;
    assert_on_small_stack(long_nest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_values), cmocka_unit_test(test_sharing),
        cmocka_unit_test(test_evaluate),      cmocka_unit_test(test_identities),
        cmocka_unit_test(test_constants),     cmocka_unit_test(test_branches),
        cmocka_unit_test(test_vectors),       cmocka_unit_test(test_count),
        cmocka_unit_test(test_sincos),        cmocka_unit_test(test_count_above),
        cmocka_unit_test(test_million_sums),  cmocka_unit_test(test_million_nested),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
