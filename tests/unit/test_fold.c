/* SPDX-License-Identifier: MIT
 * Sums over lanes that are made together: the steps of ex_fold, played by what their comment says on whole numbers, so
 * that sums are exact, and which sums share them. */
#include "base/pool.h"
#include "expression/expression.h"
#include "expression/vectorize.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { LANES_MOST = 16, SUMS = 40, OTHERS = 13 };

/* Lane l of a node: lane l of the input i is 1000 i + l^2. */
static double lane_of(const Dag *dag, Ex e, int l)
{
    const Node *node = &dag->node[e];
    if (node->op == OP_INPUT)
        return 1000 * node->element[l].index + l * l;
    assert_int_equal(node->op, OP_FOLD);
    const int bit = 1 << node->arg[2];
    const Ex from = node->arg[l & bit ? 1 : 0];
    return lane_of(dag, from, l) + lane_of(dag, from, l ^ bit);
}

static void test_fold(void **state)
{
    (void)state;
    for (int lanes = 2; lanes <= LANES_MOST; lanes *= 2)
        for (int count = 1; count <= lanes; ++count) {
            Pool *pool = pool_new();
            Dag *dag = dag_new(pool, lanes, lanes);
            dag->lanes = lanes;
            Ex vector[LANES_MOST];
            for (int i = 0; i < count; ++i) {
                Element lane[LANES_MOST];
                for (int l = 0; l < lanes; ++l)
                    lane[l] = element_of(ARRAY_known, l, i);
                vector[i] = ex_vector(dag, lane);
            }
            const Ex sums = fold(dag, vector, count);
            for (int l = 0; l < lanes; ++l) {
                const int i = l < count ? l : count - 1;
                double sum = 0;
                for (int k = 0; k < lanes; ++k)
                    sum += 1000 * i + k * k;
                assert_true(lane_of(dag, sums, l) == sum);
            }
            const Count whole = dag_count(dag, &sums, 1), wide = dag_count_wide(dag, &sums, 1);
            assert_int_equal(whole.add, wide.add);
            assert_true(wide.add <= lanes - 1 && (count < lanes || wide.add == lanes - 1));
            pool_free(pool);
        }
}

/* In every group sums of one depth, more than half as many as lanes and no more; in the order given; alone is only who
 * has too few of its depth left. */
static void test_groups(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    for (int lanes = 2; lanes <= LANES_MOST; lanes *= 2)
        for (int depths = 1; depths <= 4; ++depths) {
            int order[SUMS], depth[SUMS + OTHERS], members[SUMS] = {0}, of[SUMS], last = -1, alone[4] = {0};
            int newest[4] = {-1, -1, -1, -1}; /* group of each depth */
            for (int i = 0; i < SUMS; ++i) {
                order[i] = OTHERS + (7 * i + 3) % SUMS;
                depth[OTHERS + i] = i * i % depths;
            }
            const int *group = fold_groups(pool, OTHERS + SUMS, SUMS, order, depth, lanes);
            for (int i = 0; i < OTHERS; ++i)
                assert_int_equal(group[i], -1);
            for (int i = 0; i < SUMS; ++i) {
                const int own = group[order[i]];
                assert_in_range(own + 1, 0, SUMS);
                if (own < 0) {
                    ++alone[depth[order[i]]];
                    continue;
                }
                if (members[own]++)
                    assert_int_equal(of[own], depth[order[i]]);
                of[own] = depth[order[i]];
                assert_true(own >= newest[of[own]]);
                newest[of[own]] = own;
                last = own > last ? own : last;
            }
            for (int g = 0; g <= last; ++g)
                assert_true(members[g] == 0 || (2 * members[g] > lanes && members[g] <= lanes));
            for (int d = 0; d < depths; ++d)
                assert_true(2 * alone[d] <= lanes);
        }
    assert_non_null(fold_groups(pool, 0, 0, NULL, NULL, 4));
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fold), cmocka_unit_test(test_groups)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
