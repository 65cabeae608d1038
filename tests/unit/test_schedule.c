/* SPDX-License-Identifier: MIT
 * The order of statements: what it must keep, on random graphs, and what it is for, by a processor of the test's own.
 */
#include "base/pool.h"
#include "base/random.h"
#include "expression/expression.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { INPUTS = 6, NODES = 120, GRAPHS = 60, EVERY = 7 /* a check behind so many */ };

/* Every node a statement of its own, in the order in which they were made, with checks in between. */
static int plan(const Dag *dag, Ex first, Step *step)
{
    int steps = 0, checks = 0;
    for (Ex e = first; e < (Ex)dag->nodes; ++e) {
        if (dag->node[e].level < LEVEL_VARIABLE || dag->node[e].op == OP_INPUT)
            continue;
        step[steps++] = (Step){e, -1};
        if (e % EVERY == 0)
            step[steps++] = (Step){e, checks++};
    }
    return steps;
}

static int place_of(const Step *step, int steps, Step wanted)
{
    for (int i = 0; i < steps; ++i)
        if (step[i].value == wanted.value && step[i].check == wanted.check)
            return i;
    return -1;
}

static void test_order_is_kept(void **state)
{
    (void)state;
    static const Op op[] = {OP_ADD, OP_SUB, OP_MUL, OP_DIV, OP_SQRT, OP_ABS, OP_SIN};
    int moved = 0;
    for (uint64_t seed = 1; seed <= GRAPHS; ++seed) {
        Pool *pool = pool_new();
        Random random = {seed};
        Dag *dag = dag_new(pool, 1, 1);
        Ex node[INPUTS + NODES];
        for (int i = 0; i < INPUTS; ++i)
            node[i] = ex_input(dag, element_at(ARRAY_q, i), NULL);
        for (int i = INPUTS; i < INPUTS + NODES; ++i) {
            const Op kind = op[random_bits(&random) % (sizeof op / sizeof *op)];
            const Ex a = node[random_bits(&random) % (uint64_t)i], b = node[random_bits(&random) % (uint64_t)i];
            node[i] = ex_op(dag, kind, a, ex_arity(kind) > 1 ? b : 0, 0);
        }
        static Step before[2 * NODES + INPUTS], after[2 * NODES + INPUTS];
        const int steps = plan(dag, 0, before);
        memcpy(after, before, sizeof before);
        schedule_steps(pool, dag, after, steps, false);
        moved += memcmp(before, after, (size_t)steps * sizeof *before) != 0;
        int checks = 0;
        for (int i = 0; i < steps; ++i) {
            const Node *n = &dag->node[after[i].value];
            const int was = place_of(before, steps, after[i]);
            assert_true(was >= 0); /* and as many: nothing is lost, nothing twice */
            assert_int_equal(place_of(after, steps, after[i]), i);
            if (after[i].check >= 0) {
                assert_int_equal(after[i].check, checks++);
                assert_true(place_of(after, i, (Step){after[i].value, -1}) >= 0);
                continue;
            }
            for (int j = 0; j < ex_arity((Op)n->op); ++j)
                assert_true(dag->node[n->arg[j]].op == OP_INPUT || place_of(after, i, (Step){n->arg[j], -1}) >= 0);
            /* a root or a quotient may be what a check keeps from being taken */
            for (int j = 0; (n->op == OP_SQRT || n->op == OP_DIV) && j < was; ++j)
                assert_true(before[j].check < 0 || place_of(after, i, before[j]) >= 0);
        }
        pool_free(pool);
    }
    assert_true(moved > GRAPHS / 2);
}

/* A processor that begins operations in order, two a cycle, each when its operands are there: cycles to the end. */
static double time_of(const Dag *dag, const Step *step, int steps)
{
    double *there = calloc((size_t)dag->nodes, sizeof *there), now = 0, end = 0;
    for (int i = 0; i < steps; ++i) {
        const Node *n = &dag->node[step[i].value];
        now += 0.5;
        for (int j = 0; j < ex_arity((Op)n->op); ++j)
            now = there[n->arg[j]] > now ? there[n->arg[j]] : now;
        there[step[i].value] = now + (n->op == OP_SQRT ? 20 : n->op == OP_DIV ? 13 : 4);
        end = there[step[i].value] > end ? there[step[i].value] : end;
    }
    free(there);
    return end;
}

/* A chain of roots and quotients behind many short sums that nobody waits for: one fills the gaps of the other. */
static void test_gaps_are_filled(void **state)
{
    (void)state;
    enum { LINKS = 6, SUMS = 300 };
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    const Ex q = ex_input(dag, element_at(ARRAY_q, 0), NULL), one = ex_literal(dag, 1);
    const Ex first = (Ex)dag->nodes;
    for (int i = 0; i < SUMS; ++i)
        ex_add(dag, ex_input(dag, element_at(ARRAY_q, 1 + i), NULL), q);
    Ex chain = q;
    for (int i = 0; i < LINKS; ++i)
        chain = ex_sqrt(dag, ex_div(dag, one, chain));
    static Step before[SUMS + 2 * LINKS + SUMS], after[sizeof before / sizeof *before];
    int steps = 0;
    for (Ex e = first; e < (Ex)dag->nodes; ++e)
        if (dag->node[e].op != OP_INPUT && dag->node[e].level == LEVEL_VARIABLE)
            before[steps++] = (Step){e, -1};
    memcpy(after, before, sizeof before);
    schedule_steps(pool, dag, after, steps, false);
    const double alone = LINKS * (20 + 13), apart = (int)SUMS / 2.0;
    assert_true(time_of(dag, before, steps) >= alone + apart);
    /* at most a tenth above the chain alone */
    assert_true(time_of(dag, after, steps) < 1.1 * alone);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order_is_kept), cmocka_unit_test(test_gaps_are_filled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
