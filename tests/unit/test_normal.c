/* SPDX-License-Identifier: MIT
 * Normal forms of expressions: what they prove equal has equal values at numbers that people write, random graphs of
 * nice numbers among them; what differs at one place, however far away, has another form. */
#include "base/random.h"
#include "base/table.h"
#include "expression/expression.h"
#include "model/model.h"
#include "specialize/normal_form.h"
#include "specialize/specialize.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { INPUTS = 4, TERMS = 80, GRAPHS = 400, PLACES = 60 };

typedef struct Fixed {
    Pool *pool;
    Dag *dag;
    Normal *normal;
    Ex a, b, c, m, one, two; /* m: the middle of the road */
} Fixed;

static double far_x[] = {0, 1, 50}, far_y[] = {0, 0, 7}, near_y[] = {0, 0, 7}, else_y[] = {0, 0, 7.000000000000001};

static Fixed fixed_new(bool even)
{
    static double slope[3] = {0};
    static Table table[3] = {{.count = 3, .x = far_x, .y = far_y, .slope = slope},
                             {.count = 3, .x = far_x, .y = near_y, .slope = slope},
                             {.count = 3, .x = far_x, .y = else_y, .slope = slope}};
    static Model model = {.tables = 3, .table = table};
    Fixed f = {.pool = pool_new()};
    f.dag = dag_new(f.pool, 1, 1);
    f.normal = normal_new(f.pool, &model, even);
    f.a = ex_input(f.dag, element_at(ARRAY_y, 0), NULL);
    f.b = ex_input(f.dag, element_at(ARRAY_e, 0), NULL);
    f.c = ex_input(f.dag, element_at(ARRAY_u, 0), NULL);
    f.m = ex_input(f.dag, element_at(ARRAY_y, 1), NULL);
    f.one = ex_literal(f.dag, 1);
    f.two = ex_literal(f.dag, 2);
    return f;
}

static Form form_of(const Fixed *f, Ex e)
{
    Form form;
    normal_forms(f->normal, f->dag, 0, NULL, NULL, &e, 1, &form);
    return form;
}

static Ex op(const Fixed *f, Op kind, Ex a, Ex b, Ex c)
{
    return ex_op(f->dag, kind, a, b, c);
}

/* ---- what is proved ------------------------------------------------------------------------------------------------
 */

static void test_equal(void **state)
{
    (void)state;
    const Fixed f = fixed_new(true);
    Dag *d = f.dag;
    const Ex a = f.a, b = f.b, c = f.c, m = f.m, minus = ex_neg(d, a);
    const Ex clamped = op(&f, OP_MAX, op(&f, OP_MIN, a, f.one, 0), ex_neg(d, f.two), 0);
    const Ex other = op(&f, OP_MIN, op(&f, OP_MAX, minus, ex_neg(d, f.one), 0), f.two, 0);
    const Ex sign = op(&f, OP_POSITIVE, a, b, op(&f, OP_POSITIVE, minus, ex_neg(d, b), 0));
    const Ex opposite = op(&f, OP_POSITIVE, minus, b, op(&f, OP_POSITIVE, a, ex_neg(d, b), 0));
    const struct {
        Ex a, b;
        int sign;
    } same[] = {
        {ex_add(d, ex_add(d, a, b), c), ex_add(d, c, ex_add(d, b, a)), 1},
        {ex_sub(d, ex_add(d, a, b), ex_sub(d, a, b)), ex_add(d, b, b), 1},
        {ex_sub(d, a, ex_add(d, b, c)), ex_add(d, b, ex_sub(d, c, a)), -1},
        {ex_mul(d, ex_mul(d, a, b), c), ex_mul(d, ex_mul(d, c, a), b), 1},
        {ex_mul(d, ex_sub(d, a, b), c), ex_mul(d, c, ex_sub(d, b, a)), -1},
        {ex_div(d, ex_sub(d, a, b), c), ex_div(d, ex_sub(d, b, a), c), -1},
        {op(&f, OP_SIN, ex_sub(d, a, b), 0, 0), op(&f, OP_SIN, ex_sub(d, b, a), 0, 0), -1},
        {op(&f, OP_COS, ex_sub(d, a, b), 0, 0), op(&f, OP_COS, ex_sub(d, b, a), 0, 0), 1},
        {op(&f, OP_ABS, ex_sub(d, a, b), 0, 0), op(&f, OP_ABS, ex_sub(d, b, a), 0, 0), 1},
        {op(&f, OP_MIN, minus, ex_neg(d, b), 0), op(&f, OP_MAX, a, b, 0), -1},
        {op(&f, OP_MAX, minus, 0, 0), op(&f, OP_MIN, a, 0, 0), -1},
        {clamped, other, -1},
        {sign, opposite, -1},
        {op(&f, OP_TABLE, a, 0, 0), op(&f, OP_TABLE, a, 1, 0), 1},
        {op(&f, OP_ROAD, a, ex_add(d, m, b), 0), op(&f, OP_ROAD, a, ex_sub(d, m, b), 0), 1},
        {op(&f, OP_FRICTION, a, b, 0), op(&f, OP_FRICTION, a, ex_sub(d, ex_add(d, m, m), b), 0), 1},
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; ++i)
        assert_int_equal(form_of(&f, same[i].a), same[i].sign * form_of(&f, same[i].b));
    assert_int_equal(form_of(&f, ex_add(d, ex_sub(d, a, b), ex_add(d, ex_sub(d, b, c), ex_sub(d, c, a)))), 0);
    assert_int_equal(form_of(&f, op(&f, OP_TANH, ex_sub(d, ex_add(d, a, b), ex_add(d, b, a)), 0, 0)), 0);
    assert_int_not_equal(form_of(&f, op(&f, OP_ROAD, a, ex_add(d, m, b), 0)),
                         form_of(&f, op(&f, OP_ROAD, a, ex_sub(d, m, c), 0)));
    assert_int_not_equal(form_of(&f, op(&f, OP_ROAD, a, b, 0)), form_of(&f, op(&f, OP_ROAD, a, ex_neg(d, b), 0)));
    pool_free(f.pool);
}

/* ---- what is not ---------------------------------------------------------------------------------------------------
 */

static void test_different(void **state)
{
    (void)state;
    const Fixed f = fixed_new(false);
    Dag *d = f.dag;
    const Ex a = f.a, b = f.b, minus = ex_neg(d, a), late = ex_sub(d, a, ex_literal(d, 30));
    const Ex tenth = ex_literal(d, 0.1), next = ex_literal(d, 0.1 + 1e-17 + 2e-17);
    const struct {
        Ex a, b;
    } unlike[] = {
        {op(&f, OP_MAX, late, 0, 0), 0},
        {op(&f, OP_POSITIVE, late, f.one, 0), 0},
        {op(&f, OP_POSITIVE, late, b, a), a},
        {op(&f, OP_POSITIVE, a, b, 0), op(&f, OP_POSITIVE, minus, ex_neg(d, b), 0)},
        {op(&f, OP_POSITIVE, a, f.one, ex_neg(d, f.one)), op(&f, OP_POSITIVE, minus, ex_neg(d, f.one), f.one)},
        {op(&f, OP_POSITIVE, a, f.one, op(&f, OP_POSITIVE, minus, ex_neg(d, f.two), 0)),
         ex_neg(d, op(&f, OP_POSITIVE, minus, f.one, op(&f, OP_POSITIVE, a, ex_neg(d, f.two), 0)))},
        {op(&f, OP_MIN, a, b, 0), op(&f, OP_MAX, a, b, 0)},
        {op(&f, OP_MIN, op(&f, OP_MAX, a, f.two, 0), f.one, 0), op(&f, OP_MAX, op(&f, OP_MIN, a, f.one, 0), f.two, 0)},
        {op(&f, OP_ABS, a, 0, 0), a},
        {op(&f, OP_SQRT, ex_mul(d, a, a), 0, 0), a},
        {op(&f, OP_ATAN2, minus, b, 0), ex_neg(d, op(&f, OP_ATAN2, a, b, 0))},
        {op(&f, OP_EXP, minus, 0, 0), op(&f, OP_EXP, a, 0, 0)},
        {ex_mul(d, tenth, a), ex_mul(d, next, a)},
        {ex_add(d, ex_mul(d, ex_literal(d, 1e-300), b), a), a},
        {op(&f, OP_TABLE, a, 0, 0), op(&f, OP_TABLE, a, 2, 0)},
        {op(&f, OP_TABLE, minus, 0, 0), ex_neg(d, op(&f, OP_TABLE, a, 0, 0))},
        {op(&f, OP_ROAD, a, b, 0), op(&f, OP_ROAD, a, minus, 0)},
        {op(&f, OP_FRICTION, a, b, 0), op(&f, OP_FRICTION, a, ex_neg(d, b), 0)},
        {op(&f, OP_ROAD_PART, op(&f, OP_ROAD, a, b, 0), 1, 0), op(&f, OP_ROAD_PART, op(&f, OP_ROAD, a, b, 0), 2, 0)},
        {ex_div(d, a, b), ex_div(d, b, a)},
        {ex_sub(d, a, b), ex_sub(d, b, a)},
        /* constants that make no number are not cancelled */
        {ex_sub(d, ex_mul(d, op(&f, OP_SQRT, ex_literal(d, -1), 0, 0), a),
                ex_mul(d, a, op(&f, OP_SQRT, ex_literal(d, -1), 0, 0))),
         0},
    };
    assert_true(ex_value(d, next, 0) > ex_value(d, tenth, 0));
    for (size_t i = 0; i < sizeof unlike / sizeof *unlike; ++i)
        assert_int_not_equal(form_of(&f, unlike[i].a), form_of(&f, unlike[i].b));
    pool_free(f.pool);
}

/* ---- inputs that stand for others, members of a class
 * ----------------------------------------------------------------
 */

/* b is the mirror image of a; c lies in the middle, a height above m. */
static Form mirrored(void *context, Normal *normal, Element input)
{
    const Form a = normal_input(normal, element_at(ARRAY_y, 0));
    (void)context;
    return input.array == ARRAY_e   ? -a
           : input.array == ARRAY_u ? normal_sum(normal, normal_input(normal, element_at(ARRAY_m, 0)), a)
                                    : normal_input(normal, input);
}

static void test_inputs(void **state)
{
    (void)state;
    const Fixed f = fixed_new(false);
    Dag *d = f.dag;
    Ex root[2] = {ex_add(d, f.c, f.b), ex_mul(d, ex_add(d, f.a, f.b), f.c)};
    Form form[2];
    normal_forms(f.normal, d, 0, mirrored, NULL, root, 2, form);
    assert_int_equal(form[0], normal_input(f.normal, element_at(ARRAY_m, 0)));
    assert_int_equal(form[1], 0);
    pool_free(f.pool);
}

static void test_members(void **state)
{
    (void)state;
    const Fixed f = fixed_new(false);
    Dag *d = dag_new(f.pool, 3, 6); /* two samples a member */
    const Ex x = ex_input(d, element_at(ARRAY_x, 0), NULL),
             scaled = ex_mul(d, ex_constant(d, (const double[]){2, -2, 1}), x);
    Form form[3];
    for (int member = 0; member < 3; ++member)
        normal_forms(f.normal, d, member, NULL, NULL, &scaled, 1, &form[member]);
    assert_int_equal(form[1], -form[0]);
    assert_int_equal(form[2], normal_input(f.normal, element_at(ARRAY_x, 0)));
    pool_free(f.pool);
}

/* One number that is given for an input is that of every member of the class. */
static void test_given_number(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *d = dag_new(pool, 3, 6);
    const Ex x = ex_input(d, element_at(ARRAY_turn, 0), NULL), factor = ex_constant(d, (const double[]){1, 2, 3});
    Block block = {.dag = d};
    block_store(&block, ex_add(d, ex_mul(d, factor, x), ex_input(d, element_at(ARRAY_rate, 0), NULL)),
                element_at(ARRAY_out, 0));
    Givens *givens = givens_new(pool);
    givens_number(givens, 5, element_at(ARRAY_turn, 0));
    givens_number(givens, 7, element_at(ARRAY_rate, 0));
    Partial partial = partial_new(pool, d, givens, NULL, false, NULL);
    const Block out = partial_block(&partial, &block);
    for (int member = 0; member < 3; ++member)
        assert_true(ex_value(out.dag, out.store[0].value, 2 * member) == 5 * (member + 1) + 7);
    pool_free(pool);
}

/* ---- random graphs of nice numbers
 * -----------------------------------------------------------------------------------
 */

typedef struct Term {
    Ex e;
    bool exact; /* computed without rounding from the inputs, so that conditions on it hold to the bit */
} Term;

static int below(Random *random, int count)
{
    return (int)(random_bits(random) % (uint64_t)count);
}

static Term random_term(Dag *d, Random *random, const Term *term, int terms)
{
    const Term *a = &term[below(random, terms)], *b = &term[below(random, terms)], *c = &term[below(random, terms)];
    const bool exact = a->exact && b->exact;
    switch (below(random, 13)) {
    case 0:
    case 1: return (Term){ex_add(d, a->e, b->e), exact};
    case 2:
    case 3: return (Term){ex_sub(d, a->e, b->e), exact};
    case 4: return (Term){ex_neg(d, a->e), a->exact};
    case 5: return (Term){ex_mul(d, a->e, b->e), false};
    case 6: return (Term){ex_div(d, a->e, b->e), false};
    case 7: return (Term){ex_op(d, OP_SIN, a->e, 0, 0), false};
    case 8: return (Term){ex_op(d, OP_COS, a->e, 0, 0), false};
    case 9: return (Term){ex_op(d, OP_ABS, a->e, 0, 0), a->exact};
    case 10: return (Term){ex_op(d, OP_MIN, a->e, b->e, 0), exact};
    case 11: return (Term){ex_op(d, OP_MAX, a->e, b->e, 0), exact};
    default:
        if (!a->exact)
            return *a;
        return (Term){ex_op(d, OP_POSITIVE, a->e, b->e, c->e), exact && c->exact};
    }
}

/* All pairs that are said to be equal or opposite, at many places. Returns how many pairs of different nodes. */
static int compare(Dag *d, const Ex *input, const Term *term, const Form *form, Random *random)
{
    static const double nice[] = {0, 1, -1, 0.5, -0.5, 2, -2, 3, 100, -1024, 0.25};
    int pairs = 0;
    for (int place = 0; place < PLACES; ++place) {
        for (int i = 0; i < INPUTS; ++i)
            ex_set_sample(d, input[i], 0, nice[below(random, sizeof nice / sizeof *nice)]);
        dag_evaluate(d, 0, 1);
        pairs = 0;
        for (int i = 0; i < TERMS; ++i)
            for (int j = 0; j < i; ++j) {
                const double x = ex_value(d, term[i].e, 0), y = ex_value(d, term[j].e, 0);
                if (abs(form[i]) != abs(form[j]) || term[i].e == term[j].e)
                    continue;
                ++pairs;
                if (isfinite(x) && isfinite(y) && fabs(x) < 1e6)
                    assert_true(fabs(x - (form[i] == form[j] ? y : -y)) <= 1e-7 * (1 + fabs(x)));
            }
    }
    return pairs;
}

static void test_random(void **state)
{
    (void)state;
    static const double constant[] = {1, 2, 0.5, -1, 3};
    Random random = {7};
    int pairs = 0;
    for (int graph = 0; graph < GRAPHS; ++graph) {
        const Fixed f = fixed_new(false);
        Ex input[INPUTS], root[TERMS];
        Term term[TERMS];
        Form form[TERMS];
        int terms = 0;
        for (int i = 0; i < INPUTS; ++i) {
            input[i] = ex_input(f.dag, element_at(ARRAY_x, i), NULL);
            term[terms++] = (Term){input[i], true};
        }
        for (size_t i = 0; i < sizeof constant / sizeof *constant; ++i)
            term[terms++] = (Term){ex_literal(f.dag, constant[i]), true};
        for (; terms < TERMS; ++terms)
            term[terms] = random_term(f.dag, &random, term, terms);
        for (int i = 0; i < TERMS; ++i)
            root[i] = term[i].e;
        normal_forms(f.normal, f.dag, 0, NULL, NULL, root, TERMS, form);
        pairs += compare(f.dag, input, term, form, &random);
        pool_free(f.pool);
    }
    assert_true(pairs > 10 * GRAPHS); /* there was something to compare */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal),   cmocka_unit_test(test_different),    cmocka_unit_test(test_inputs),
        cmocka_unit_test(test_members), cmocka_unit_test(test_given_number), cmocka_unit_test(test_random),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
