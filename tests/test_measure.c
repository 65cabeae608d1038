/* SPDX-License-Identifier: MIT
 * What measure.c reads in C text, against what the compiler makes of the same text: it stands here once, as code and as
 * a string. */
#include "gicgen.h"

#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

typedef double gic_real;

#define CODE_AND_TEXT(...) \
    static const char text[] = #__VA_ARGS__; \
    __VA_ARGS__

/* every gap that alignment can make, and every declarator that structures of emitted code have */
CODE_AND_TEXT(
    enum {ROOM = 3, STATES = 5}; typedef struct odd {
        char c;
        gic_real x;
        int32_t i;
    } odd;
    typedef void callback(void *user, int32_t lane); typedef enum kind{FIRST = 1, SECOND = 2} kind;
    typedef struct instance {
        char first;
        odd one, two[2];
        int32_t n, *at, list[ROOM];
        int64_t count;
        char more[ROOM * 3];
        const char *const *name;
        callback *call;
        int (*function)(const struct instance *self, gic_real x[4]);
        gic_real state[2 * STATES + ROOM], matrix[ROOM][STATES], fill[(64 - sizeof(odd) % 64) / sizeof(gic_real)];
        kind what;
        char last;
    } instance;
    static const gic_real numbers_a[2][ROOM] = {{1, 2, 3}, {4, 5, 6}}; static const struct {
        int place;
        gic_real q[7];
    } numbers_b[] = {{1, {0}}, {2, {0}}, {3, {0}}};
    static const char *const words[STATES] = {"a", "b;", "}"};)

static void sizes_are_the_compilers(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Measure *m = measure_new(pool, "model", sizeof(gic_real));
    measure_read(m, text);
    assert_int_equal(measure_type(m, "odd"), sizeof(odd));
    assert_int_equal(measure_type(m, "instance"), sizeof(instance));
    assert_int_equal(measure_type(m, "kind"), sizeof(kind));
    assert_int_equal(measure_type(m, "another"), 0);
    assert_int_equal(measure_constants(m, "numbers_a"), sizeof numbers_a);
    assert_int_equal(measure_constants(m, "numbers_b"), sizeof numbers_b);
    assert_int_equal(measure_constants(m, "words"), sizeof words);
    assert_int_equal(measure_constants(m, ""), sizeof numbers_a + sizeof numbers_b + sizeof words);
    assert_int_equal(measure_number(m, "STATES"), STATES);
    /* the arrays have the numbers that the text gives them */
    assert_true(numbers_a[1][2] > 5 && numbers_b[2].place == 3 && words[0][0] == 'a');
    pool_free(pool);
}

/* By hand: in single precision a number and what surrounds it shrinks. */
static void other_reals(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Measure *m = measure_new(pool, "model", sizeof(float));
    measure_read(m, "#define MOST 12 /* of them */\n#define F(x) \\\n  broken {\n"
                    "#define FILL(bytes) ((64 - (bytes) % 64) / sizeof(gic_real))\n"
                    "typedef struct s { gic_real a; void *p; gic_real b; } s; /* 4 + 4, 8, 4 + 4 */"
                    "typedef struct t { s head; gic_real fill[FILL(sizeof(s))]; } t; /* 24, 40 */");
    assert_int_equal(measure_type(m, "s"), 24);
    assert_int_equal(measure_type(m, "t"), 64);
    assert_int_equal(measure_number(m, "MOST"), 12);
    pool_free(pool);
}

/* Two functions differ by their locals, and a call adds what is called. */
static void stacks(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Measure *m = measure_new(pool, "model", sizeof(double));
    measure_read(m, "int leaf(int a) { return a; }\n"
                    "int wide(int a) { gic_real x[10] = {0}, y = (gic_real)a; int i; "
                    "for (int32_t k = 0; k < sizeof x; ++k) { const gic_real *const p = x; } return y; }\n"
                    "static int part(int a) { gic_real z[100]; return leaf(a); }\n"
                    "static int model_any_rhs(void *self) { return wide(0); }\n"
                    "int root(int a) { return leaf(a) + wide(a); }\n"
                    "int with_part(int a) { int b = wide(a); return part(b); }\n"
                    "int through(const gic_model *model) { return model->rhs(0) + model->foreign(0); }\n");
    const size_t leaf = measure_stack(m, "leaf"), wide = measure_stack(m, "wide");
    assert_true(leaf >= sizeof(int));
    assert_int_equal(wide - leaf, 11 * sizeof(double) + sizeof(int) + sizeof(int32_t) + sizeof(void *));
    assert_int_equal(measure_stack(m, "root"), leaf + wide);
    /* a part's locals lie beside those of the deepest other callee */
    assert_int_equal(measure_stack(m, "with_part"), leaf + sizeof(int) + leaf + 100 * sizeof(double) + wide);
    assert_int_equal(measure_stack(m, "through"), leaf + leaf + wide);
    assert_int_equal(measure_stack(m, "nobody"), 0);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_the_compilers),
        cmocka_unit_test(other_reals),
        cmocka_unit_test(stacks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
