/* SPDX-License-Identifier: MIT
 * Sums added in the order in which their terms become ready: the same values as before, evaluated from the nodes alone
 * in extended precision, with no more operations and no longer a way. */
#include "base/pool.h"
#include "base/random.h"
#include "expression/expression.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { INPUTS = 8, NODES = 90, ROOTS = 4, GRAPHS = 200 };

/* The value of every node in extended precision, and the sum of the magnitudes that were added on the way to it. */
typedef struct Plain {
    long double value, size;
} Plain;

static Plain *evaluate(Pool *pool, const Dag *dag)
{
    Plain *plain = pool_alloc(pool, (size_t)dag->nodes * sizeof *plain);
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        const Plain *a = &plain[node->arg[0]], *b = &plain[node->arg[1]];
        const long double given = ex_value(dag, (Ex)e, 0);
        switch (node->op) {
        case OP_NEG: plain[e] = (Plain){-a->value, a->size}; break;
        case OP_ADD: plain[e] = (Plain){a->value + b->value, a->size + b->size}; break;
        case OP_SUB: plain[e] = (Plain){a->value - b->value, a->size + b->size}; break;
        case OP_MUL: plain[e] = (Plain){a->value * b->value, a->size * b->size}; break;
        case OP_SQRT: plain[e] = (Plain){sqrtl(a->value), a->size}; break; /* of more than 1 */
        case OP_ABS: plain[e] = (Plain){fabsl(a->value), a->size}; break;
        default: plain[e] = (Plain){given, fabsl(given)}; break;
        }
    }
    return plain;
}

/* The longest way to a node: additions and multiplications count 4, roots 20. */
static int way_to(const Dag *dag, Ex e)
{
    const Node *node = &dag->node[e];
    int way = 0;
    for (int i = 0; node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i) {
        const int one = way_to(dag, node->arg[i]);
        way = one > way ? one : way;
    }
    return node->level < LEVEL_VARIABLE || node->op == OP_INPUT ? 0
           : node->op == OP_NEG || node->op == OP_ABS           ? way + 1
                                                                : way + (node->op == OP_SQRT ? 20 : 4);
}

/* Mostly sums, of terms that are products, roots, constants and sums used more than once. */
static Ex grow(Dag *dag, Random *random, const Ex *node, int count)
{
    const Ex a = node[random_bits(random) % (uint64_t)count], b = node[random_bits(random) % (uint64_t)count];
    switch (random_bits(random) % 8) {
    case 0: return ex_mul(dag, a, b);
    case 1: return ex_sqrt(dag, ex_add(dag, ex_literal(dag, 1), ex_op(dag, OP_ABS, a, 0, 0)));
    case 2:
    case 3: return ex_sub(dag, a, b);
    case 4: return ex_add(dag, a, ex_literal(dag, random_uniform(random, -2, 2)));
    default: return ex_add(dag, a, b);
    }
}

static void test_random_graphs(void **state)
{
    (void)state;
    int shorter = 0;
    for (uint64_t seed = 1; seed <= GRAPHS; ++seed) {
        Pool *pool = pool_new();
        Random random = {seed};
        Dag *dag = dag_new(pool, 1, 1);
        Ex node[NODES], root[ROOTS], balanced[ROOTS];
        int count = 0;
        for (; count < INPUTS; ++count)
            node[count] = ex_input(dag, element_at(ARRAY_q, count), (double[]){random_uniform(&random, -2, 2)});
        while (count < NODES) {
            /* the newest ones mostly, so that sums are long */
            const int from = count > 12 && random_bits(&random) % 4 ? count - 12 : 0;
            const Ex e = grow(dag, &random, node + from, count - from);
            if (fabs(ex_value(dag, e, 0)) < 1e6)
                node[count++] = e;
        }
        for (int i = 0; i < ROOTS; ++i)
            root[i] = node[NODES - 1 - i];
        const Count before = dag_count(dag, root, ROOTS);
        const Ex *image = balance_sums(pool, dag, root, ROOTS);
        for (int i = 0; i < ROOTS; ++i)
            balanced[i] = image[root[i]];
        const Count after = dag_count(dag, balanced, ROOTS);
        assert_true(after.add <= before.add && after.multiply <= before.multiply && after.root <= before.root);
        const Plain *plain = evaluate(pool, dag);
        for (int i = 0; i < ROOTS; ++i) {
            /* roundings of the literals that were folded */
            const long double off = fabsl(plain[balanced[i]].value - plain[root[i]].value);
            assert_true(off <= 1e-15L * plain[root[i]].size);
            const int way = way_to(dag, root[i]), balanced_way = way_to(dag, balanced[i]);
            assert_true(balanced_way <= way);
            shorter += balanced_way < way;
        }
        pool_free(pool);
    }
    assert_true(shorter > GRAPHS);
}

/* What is late is added last, what is constant first, and equal terms in a tree. */
static void test_order(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Ex q[8], sum;
    for (int i = 0; i < 8; ++i)
        q[i] = ex_input(dag, element_at(ARRAY_q, i), (double[]){1 + i});
    /* root(q0) + 2 + q1 + 3 - q2: (5 + q1) - q2 while the root is on its way */
    const Ex late = ex_sqrt(dag, q[0]);
    sum = ex_add(dag, ex_add(dag, late, ex_literal(dag, 2)), q[1]);
    sum = ex_sub(dag, ex_add(dag, sum, ex_literal(dag, 3)), q[2]);
    const Ex *image = balance_sums(pool, dag, &sum, 1);
    assert_int_equal(way_to(dag, image[sum]), 24);
    assert_true(ex_value(dag, image[sum], 0) == ex_value(dag, sum, 0));
    assert_int_equal(dag_count(dag, &image[sum], 1).add, 3);
    sum = q[0];
    for (int i = 1; i < 8; ++i)
        sum = ex_add(dag, sum, q[i]);
    image = balance_sums(pool, dag, &sum, 1);
    assert_int_equal(way_to(dag, sum), 7 * 4);
    assert_int_equal(way_to(dag, image[sum]), 3 * 4);
    /* a part that something else needs as well stays as it is */
    const Ex shared = ex_add(dag, ex_add(dag, q[0], q[1]), q[2]);
    const Ex both[] = {shared, ex_add(dag, ex_add(dag, shared, q[3]), q[4])};
    image = balance_sums(pool, dag, both, 2);
    assert_int_equal(dag_count(dag, (Ex[]){image[both[0]], image[both[1]]}, 2).add, 4);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_graphs), cmocka_unit_test(test_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
