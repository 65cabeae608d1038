/* SPDX-License-Identifier: MIT
 * Tapes against a plain evaluation of the graph, node by node in the order in which nodes were made: equal to the bit,
 * since a tape may change the order of operations but none of them. Checks, roads, tables, and what happens to memory.
 */
#include "base/pool.h"
#include "base/random.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "tape/record.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MEMBERS = 3, INPUTS = 8, NODES = 400, RESULTS = 40 };

static const Element name[] = {{.array = ARRAY_y}, {.array = ARRAY_e}, {.array = ARRAY_out}, {.array = ARRAY_time}};
enum { A, B, OUT, ALONE, ARRAYS };

static const double table_x[] = {-1, 0, 2}, table_y[] = {3, 1, 5}, table_slope[] = {-2, 0, 2};
static const gic_table table[] = {{table_x, table_y, table_slope, 3, 0, 0}, {table_x, table_y, table_slope, 3, 1, 1}};

/* h = x y + time */
static void saddle(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    (void)road;
    out[0] = lane == 4 ? x * y + time : NAN;
    out[1] = y;
    out[2] = x;
}

static const gic_road saddle_road = {saddle, NULL, NULL, NULL, GIC_ROAD_OWN};

/* Memory that tapes work on. */
typedef struct Memory {
    double a[INPUTS], b[INPUTS], out[RESULTS], alone;
} Memory;

static int play_about(Pool *pool, const Tape *tape, int member, Memory *m, const gic_road *road, gic_head *head)
{
    double *const array[ARRAYS] = {m->a, m->b, m->out, &m->alone};
    double *frame = pool_alloc(pool, (size_t)(tape->slots + 1) * sizeof *frame);
    const TapeWorld world = {table, road, 4, 0.5, head, 0, NULL, NULL};
    for (int i = 0; i < tape->slots; ++i)
        frame[i] = NAN; /* what was in it must not matter */
    return tape_play(tape, member, array, &world, frame);
}

static int play(Pool *pool, const Tape *tape, int member, Memory *m, const gic_road *road)
{
    return play_about(pool, tape, member, m, road, NULL);
}

/* ---- plain evaluation ---------------------------------------------------------------------------------------- */

static double input_value(const Memory *m, const Element *input)
{
    return input->array == ARRAY_time ? m->alone : input->array == ARRAY_y ? m->a[input->index] : m->b[input->index];
}

/* Values of all nodes for one member. */
static double *plain(Pool *pool, const Dag *dag, int member, const Memory *m)
{
    double *v = pool_alloc(pool, (size_t)dag->nodes * sizeof *v);
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        double x = v[node->arg[0]], y = v[node->arg[1]], z = v[node->arg[2]];
        switch (node->op) {
        case OP_LITERAL:
        case OP_CONSTANT: v[e] = ex_value(dag, (Ex)e, member * dag->samples / dag->members); break;
        case OP_INPUT: v[e] = input_value(m, node->element); break;
        case OP_NEG: v[e] = -x; break;
        case OP_ADD: v[e] = x + y; break;
        case OP_SUB: v[e] = x - y; break;
        case OP_MUL: v[e] = x * y; break;
        case OP_DIV: v[e] = x / y; break;
        case OP_SQRT: v[e] = sqrt(x); break;
        case OP_ABS: v[e] = fabs(x); break;
        case OP_SIN: v[e] = sin(x); break;
        case OP_COS: v[e] = cos(x); break;
        case OP_TAN: v[e] = tan(x); break;
        case OP_ASIN: v[e] = asin(x); break;
        case OP_ACOS: v[e] = acos(x); break;
        case OP_ATAN: v[e] = atan(x); break;
        case OP_EXP: v[e] = exp(x); break;
        case OP_LOG: v[e] = log(x); break;
        case OP_TANH: v[e] = tanh(x); break;
        case OP_POW: v[e] = pow(x, y); break;
        case OP_ATAN2: v[e] = atan2(x, y); break;
        case OP_MIN: v[e] = x < y ? x : y; break;
        case OP_MAX: v[e] = x > y ? x : y; break;
        case OP_POSITIVE: v[e] = x > 0 ? y : z; break;
        case OP_TABLE: v[e] = gic_table_value(&table[node->arg[1]], x); break;
        case OP_ROAD: v[e] = 0; break;
        case OP_ROAD_PART: {
            const Node *road = &dag->node[node->arg[0]];
            double rx = v[road->arg[0]], ry = v[road->arg[1]];
            v[e] = node->arg[1] == 0 ? rx * ry + 0.5 : node->arg[1] == 1 ? ry : rx;
            break;
        }
        }
    }
    return v;
}

static void assert_same(double got, double wanted, Op op)
{
    if (isnan(got) && isnan(wanted))
        return;
    if (memcmp(&got, &wanted, sizeof got))
        fail_msg("%.17g instead of %.17g, op %d", got, wanted, (int)op);
}

/* ---- random graphs --------------------------------------------------------------------------------------------- */

static Ex pick(Random *random, const Ex *e, int count)
{
    return e[random_bits(random) % (uint64_t)count];
}

/* Any operation of nodes made before; sums and products more often than the rest, as in formulas. */
static Ex random_node(Dag *dag, Random *random, const Ex *e, int count)
{
    static const Op often[] = {OP_ADD, OP_SUB, OP_MUL, OP_MUL};
    Ex x = pick(random, e, count), y = pick(random, e, count), z = pick(random, e, count);
    if (random_bits(random) % 4)
        return ex_op(dag, often[random_bits(random) % 4], x, y, 0);
    Op op = (Op)(OP_NEG + random_bits(random) % (OP_COUNT - OP_NEG));
    if (op == OP_TABLE)
        return ex_op(dag, OP_TABLE, x, (Ex)(random_bits(random) % 2), 0);
    if (op >= OP_ROAD)
        return ex_op(dag, OP_ROAD_PART, ex_op(dag, OP_ROAD, x, y, 0), (Ex)(random_bits(random) % 3), 0);
    return ex_op(dag, op, x, y, z);
}

static Block random_block(Pool *pool, Random *random)
{
    Dag *dag = dag_new(pool, MEMBERS, 2 * MEMBERS);
    Block block = {.dag = dag};
    Ex e[NODES + 2 * INPUTS + 3];
    int count = 0;
    for (int i = 0; i < INPUTS; ++i) {
        e[count++] = ex_input(dag, element_at(ARRAY_y, i), NULL);
        e[count++] = ex_input(dag, element_at(ARRAY_e, i), NULL);
    }
    e[count++] = ex_input(dag, element_at(ARRAY_time, 0), NULL);
    e[count++] = ex_literal(dag, 0.75);
    e[count++] = ex_constant(dag, (double[MEMBERS]){1.5, -0.3, 0.8});
    for (int i = 0; i < NODES; ++i, ++count)
        e[count] = random_node(dag, random, e, count);
    for (int i = 0; i < RESULTS; ++i)
        block_store(&block, pick(random, e, count), element_at(ARRAY_out, i));
    return block;
}

static Memory random_memory(Random *random)
{
    Memory m = {.alone = random_uniform(random, -2, 2)};
    for (int i = 0; i < INPUTS; ++i) {
        m.a[i] = random_uniform(random, -2, 2);
        m.b[i] = random_uniform(random, -2, 2);
    }
    return m;
}

static void test_random_graphs(void **state)
{
    (void)state;
    Random random = {.state = 7};
    int finite = 0;
    for (int trial = 0; trial < 200; ++trial) {
        Pool *pool = pool_new();
        Block block = random_block(pool, &random);
        const Tape *tape = tape_record(pool, &block, name, ARRAYS);
        for (int member = 0; member < MEMBERS; ++member) {
            Memory m = random_memory(&random);
            double *wanted = plain(pool, block.dag, member, &m);
            int status = play(pool, tape, member, &m, &saddle_road);
            if (status == GIC_ERROR_ROAD) /* an argument of it was not finite */
                continue;
            assert_int_equal(status, GIC_OK);
            for (int i = 0; i < RESULTS; ++i) {
                assert_same(m.out[i], wanted[block.store[i].value], block.dag->node[block.store[i].value].op);
                finite += isfinite(m.out[i]) && m.out[i] != 0;
            }
        }
        pool_free(pool);
    }
    assert_true(finite > 5000); /* it was about numbers */
}

/* ---- single properties ------------------------------------------------------------------------------------------ */

static Ex input(Dag *dag, Element what)
{
    return ex_input(dag, what, NULL);
}

/* 1 + 2^-30 squared, less 1 + 2^-29: 0 where the product is rounded, 2^-60 where it is not. */
static void test_two_roundings(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Block block = {.dag = dag};
    Ex square = ex_op(dag, OP_MUL, input(dag, element_at(ARRAY_y, 0)), input(dag, element_at(ARRAY_y, 0)), 0),
       other = input(dag, element_at(ARRAY_y, 1));
    block_store(&block, ex_op(dag, OP_SUB, square, other, 0), element_at(ARRAY_out, 0));
    Memory m = {.a = {1 + 0x1p-30, 1 + 0x1p-29}};
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    assert_int_equal(tape->run[0].kind, TAPE_MUL_SUB);
    assert_int_equal(play(pool, tape, 0, &m, NULL), GIC_OK);
    assert_true(m.out[0] == 0);
    pool_free(pool);
}

/* Targets may be inputs of other stores. */
static void test_exchange(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Block block = {.dag = dag_new(pool, 1, 1)};
    block_store(&block, input(block.dag, element_at(ARRAY_y, 1)), element_at(ARRAY_y, 0));
    block_store(&block, input(block.dag, element_at(ARRAY_y, 0)), element_at(ARRAY_y, 1));
    block_store(&block, ex_literal(block.dag, 2.5), element_at(ARRAY_time, 0));
    Memory m = {.a = {3, 4}};
    assert_int_equal(play(pool, tape_record(pool, &block, name, ARRAYS), 0, &m, NULL), GIC_OK);
    assert_true(m.a[0] == 4 && m.a[1] == 3 && m.alone == 2.5);
    pool_free(pool);
}

static void test_checks(void **state)
{
    (void)state;
    static const struct {
        double a0, a1;
        int status;
    } row[] = {{0.2, 0.2, GIC_OK},           {0.1, 0.2, GIC_ERROR_SINGULAR}, /* not above */
               {-0.2, 0.2, GIC_OK},                                          /* of its magnitude */
               {0.2, -0.2, GIC_ERROR_MASS},  {0, 0, GIC_ERROR_SINGULAR},     /* the first one */
               {NAN, 1, GIC_ERROR_SINGULAR}, {1, NAN, GIC_ERROR_MASS}};
    Pool *pool = pool_new();
    Block block = {.dag = dag_new(pool, 1, 1)};
    Ex sum = ex_add(block.dag, input(block.dag, element_at(ARRAY_y, 0)), ex_literal(block.dag, 0));
    block_check(&block, sum, true, 0.1, GIC_ERROR_SINGULAR);
    block_check(&block, input(block.dag, element_at(ARRAY_y, 1)), false, 0, GIC_ERROR_MASS);
    block_store(&block, sum, element_at(ARRAY_out, 0));
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i) {
        Memory m = {.a = {row[i].a0, row[i].a1}, .out = {77}};
        assert_int_equal(play(pool, tape, 0, &m, NULL), row[i].status);
        assert_true(m.out[0] == (row[i].status == GIC_OK ? row[i].a0 : 77));
    }
    pool_free(pool);
}

static void test_conditions(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Block block = {.dag = dag_new(pool, 1, 1)};
    block_require(&block, input(block.dag, element_at(ARRAY_y, 0)), 0, 3);
    block_require(&block, input(block.dag, element_at(ARRAY_y, 1)), 0, 14);
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    Memory m = {.a = {1, -1}};
    gic_head head = {.condition = -1};
    assert_int_equal(play_about(pool, tape, 0, &m, NULL, &head), GIC_ERROR_GEOMETRY);
    assert_int_equal(head.condition, 14);
    m.a[0] = -1;
    assert_int_equal(play_about(pool, tape, 0, &m, NULL, &head), GIC_ERROR_GEOMETRY);
    assert_int_equal(head.condition, 3);
    pool_free(pool);
}

static void test_abouts(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Block block = {.dag = dag_new(pool, 1, 1)};
    block_check_about(&block, input(block.dag, element_at(ARRAY_y, 0)), GIC_ERROR_MASS, -1, 12);
    block_check_about(&block, input(block.dag, element_at(ARRAY_y, 1)), GIC_ERROR_SINGULAR, 3, -1);
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    gic_head head = {.condition = 5, .subset = 6, .grown = 7};
    Memory m = {.a = {1, 1}};
    assert_int_equal(play_about(pool, tape, 0, &m, NULL, &head), GIC_OK);
    assert_true(head.condition == 5 && head.subset == 6 && head.grown == 7);
    m.a[1] = NAN;
    assert_int_equal(play_about(pool, tape, 0, &m, NULL, &head), GIC_ERROR_SINGULAR);
    assert_true(head.condition == 5 && head.subset == 3 && head.grown == -1);
    m.a[0] = 0;
    assert_int_equal(play_about(pool, tape, 0, &m, NULL, &head), GIC_ERROR_MASS);
    assert_true(head.condition == 5 && head.subset == -1 && head.grown == 12);
    pool_free(pool);
}

static void test_road(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Block block = {.dag = dag};
    Ex road = ex_op(dag, OP_ROAD, input(dag, element_at(ARRAY_y, 0)), input(dag, element_at(ARRAY_y, 1)), 0);
    for (Ex part = 0; part < 3; ++part)
        block_store(&block, ex_op(dag, OP_ROAD_PART, road, part, 0), element_at(ARRAY_out, (int)part));
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    Memory m = {.a = {3, 4}};
    assert_int_equal(play(pool, tape, 0, &m, &saddle_road), GIC_OK);
    assert_true(m.out[0] == 12.5 && m.out[1] == 4 && m.out[2] == 3);
    assert_int_equal(play(pool, tape, 0, &m, NULL), GIC_OK);
    assert_true(m.out[0] == 0 && m.out[1] == 0 && m.out[2] == 0);
    m = (Memory){.a = {INFINITY, 4}, .out = {77}};
    assert_int_equal(play(pool, tape, 0, &m, &saddle_road), GIC_ERROR_ROAD);
    assert_true(m.out[0] == 77);
    pool_free(pool);
}

/* x -> x^2 - x, a hundred thousand times: what is no longer needed gives its place to what comes. */
static void test_places_are_used_again(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Block block = {.dag = dag};
    Ex x = input(dag, element_at(ARRAY_y, 0));
    double wanted = 0.3;
    for (int i = 0; i < 100000; ++i) {
        x = ex_op(dag, OP_SUB, ex_op(dag, OP_MUL, x, x, 0), x, 0);
        wanted = wanted * wanted - wanted;
    }
    block_store(&block, x, element_at(ARRAY_out, 0));
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    Memory m = {.a = {0.3}};
    assert_int_equal(play(pool, tape, 0, &m, NULL), GIC_OK);
    assert_true(m.out[0] == wanted);
    assert_true(tape->slots <= 3);
    assert_int_equal(tape->runs, 1);
    pool_free(pool);
}

/* Neighbours in memory are loaded together. */
static void test_loads(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Block block = {.dag = dag_new(pool, 1, 1)};
    Ex sum = 0;
    for (int i = 0; i < 6; ++i)
        if (i != 3)
            sum = ex_add(block.dag, sum, input(block.dag, element_at(ARRAY_e, 5 - i)));
    block_store(&block, sum, element_at(ARRAY_out, 0));
    const Tape *tape = tape_record(pool, &block, name, ARRAYS);
    Memory m = {.b = {1, 2, 4, 8, 16, 32}};
    assert_int_equal(play(pool, tape, 0, &m, NULL), GIC_OK);
    assert_true(m.out[0] == 59);
    assert_int_equal(tape->loads, 2);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_graphs), cmocka_unit_test(test_two_roundings),
        cmocka_unit_test(test_exchange),      cmocka_unit_test(test_checks),
        cmocka_unit_test(test_conditions),    cmocka_unit_test(test_abouts),
        cmocka_unit_test(test_road),          cmocka_unit_test(test_places_are_used_again),
        cmocka_unit_test(test_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
