/* SPDX-License-Identifier: MIT
 * Checks of a packed block: in all lanes at once where those of its numbers are alike, else one by one, none lost. */
#include "base/pool.h"
#include "expression/expression.h"
#include "expression/vectorize.h"
#include "gic_runtime.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { LANES = 4 };

/* A block with the product x[l] y[l] of each lane, checked with least[l] and status[l], the first ones by magnitude;
 * packed. */
static const Block *packed(Pool *pool, const double *least, const int *status, int magnitudes)
{
    Block *block = pool_alloc(pool, sizeof *block);
    LaneInput input[2 * LANES];
    block->dag = dag_new(pool, 1, 1);
    for (int l = 0; l < LANES; ++l) {
        Ex factor[2];
        for (int k = 0; k < 2; ++k) {
            const Element name = element_at(k ? ARRAY_y : ARRAY_x, l);
            factor[k] = ex_input(block->dag, name, NULL);
            input[2 * l + k] = (LaneInput){.element = name, .colour = 1 + (uint64_t)k, .track = l};
        }
        const Ex product = ex_mul(block->dag, factor[0], factor[1]);
        block_check(block, product, l < magnitudes, least[l], status[l]);
        block_store(block, product, element_at(ARRAY_out, l));
    }
    return block_pack(pool, block, input, 2 * LANES, LANES);
}

static bool is_vector(const Block *block, const Check *check)
{
    return block->dag->node[check->value].wide == LANES;
}

static void test_alike(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    static const double least[LANES] = {0.5, 0.5, 0.5, 0.5};
    static const int status[LANES] = {GIC_ERROR_MASS, GIC_ERROR_MASS, GIC_ERROR_MASS, GIC_ERROR_MASS};
    const Block *block = packed(pool, least, status, 0);
    assert_int_equal(block->checks, 1);
    assert_true(is_vector(block, block->check) && block->check->least == 0.5 && !block->check->magnitude);
    for (int l = 0; l < LANES; ++l)
        assert_true(block->check->lane[l]->least == 0.5);
    pool_free(pool);
}

/* Of lane l, which each check of one number must be about, exactly one. */
static void check_each(const Block *block, const double *least, const int *status, int magnitudes)
{
    bool seen[LANES] = {false};
    assert_int_equal(block->checks, LANES);
    for (int i = 0; i < block->checks; ++i) {
        const Check *check = &block->check[i];
        const Node *node = &block->dag->node[check->value];
        assert_int_equal(node->op, OP_LANE);
        const int l = (int)node->arg[1];
        assert_false(seen[l]);
        seen[l] = true;
        assert_true(check->least == least[l] && check->magnitude == (l < magnitudes) && !check->lane);
        assert_int_equal(check->status, status[l]);
    }
}

static void test_different(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    static const double same[LANES] = {0, 0, 0, 0}, least[LANES] = {0.5, 0.5, 0.25, 0.5};
    static const int one[LANES] = {GIC_ERROR_MASS, GIC_ERROR_MASS, GIC_ERROR_MASS, GIC_ERROR_MASS},
                     two[LANES] = {GIC_ERROR_MASS, GIC_ERROR_SINGULAR, GIC_ERROR_MASS, GIC_ERROR_SINGULAR};
    check_each(packed(pool, least, one, 0), least, one, 0);
    check_each(packed(pool, same, two, 0), same, two, 0);
    check_each(packed(pool, same, one, 3), same, one, 3);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_alike), cmocka_unit_test(test_different)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
