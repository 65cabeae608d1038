/* SPDX-License-Identifier: MIT
 * Emitted C against the graph it came from: random blocks are compiled by the system's compiler and must give the same
 * bits. And templates. */
#include "base/file.h"
#include "base/random.h"
#include "emit/emit.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "host/host.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char *new_folder(Pool *pool)
{
    char *folder = pool_print(pool, "%s/test-emit-XXXXXX", temporary_folder());
    assert_non_null(mkdtemp(folder));
    return folder;
}

/* ---- numbers --------------------------------------------------------------------------------------------- */

/* What stands between R( and ). */
static double read_back(const char *text)
{
    char *end;
    assert_memory_equal(text, "R(", 2);
    double value = strtod(text + 2, &end);
    assert_string_equal(end, ")");
    /* an integer without a point would be an int, and 1 / 2 zero */
    assert_non_null(strpbrk(text, ".e"));
    return value;
}

static void test_numbers(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    const double special[] = {0,
                              1,
                              -1,
                              3,
                              0.1,
                              -0.1,
                              0.5,
                              1.0 / 3,
                              9.81,
                              1e-5,
                              100000,
                              1e15,
                              1e16,
                              1e22,
                              1e23,
                              0x1p53,
                              123456789012345678.0,
                              1e308,
                              -1e308,
                              0x1.fffffffffffffp1023,
                              1e300 * 1.1,
                              5e-324,
                              -5e-324,
                              4.9e-310,
                              2e-308,
                              2.2250738585072014e-308};
    for (size_t i = 0; i < sizeof special / sizeof *special; ++i) {
        double back = read_back(emit_number(pool, special[i]));
        assert_memory_equal(&back, &special[i], sizeof back);
    }
    double negative_zero = read_back(emit_number(pool, -0.0));
    assert_true(negative_zero == 0 && signbit(negative_zero));
    Random random = {3};
    for (int i = 0; i < 20000; ++i) {
        uint64_t bits = random_bits(&random);
        double value, back;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        back = read_back(emit_number(pool, value));
        assert_memory_equal(&back, &value, sizeof back);
    }
    /* short where it may be */
    assert_string_equal(emit_number(pool, 0.5), "R(0.5)");
    assert_string_equal(emit_number(pool, 0.1), "R(0.1)");
    assert_string_equal(emit_number(pool, -3), "R(-3.0)");
    pool_free(pool);
}

/* ---- a program of blocks --------------------------------------------------------------------------------- */

enum { BLOCKS = 80, INPUTS = 6, STORES = 5, MEMBERS = 2, SAMPLES = 4, TERMS = 50 };

/* Functions emitted so far, and the numbers that running them must print, as bits in the order of the calls. */
typedef struct Program {
    Pool *pool;
    Text functions, calls;
    int blocks;
} Program;

static const char prologue[] =
    "#include <math.h>\n#include <stdint.h>\n#include <stdio.h>\n#include <string.h>\n"
    "typedef double gic_real;\n"
    "#define GIC_R(x) ((gic_real)(x))\n#define R(x) GIC_R(x)\n"
    "#define GIC_SQRT(x) sqrt(x)\n#define GIC_FABS(x) fabs(x)\n#define GIC_ATAN2(y, x) atan2(y, x)\n"
    "#define GIC_MIN(a, b) ((a) < (b) ? (a) : (b))\n#define GIC_MAX(a, b) ((a) > (b) ? (a) : (b))\n"
    "enum { GIC_OK = 0, GIC_ERROR_MASS = -1, GIC_ERROR_SINGULAR = -2, GIC_ERROR_ROAD = -9 };\n"
    "static void show(int status, const gic_real *x, int count)\n{\n    printf(\"%d\", status);\n"
    "    for (int i = 0; i < count; ++i) {\n        uint64_t bits;\n        memcpy(&bits, x + i, 8);\n"
    "        printf(\" %016llx\", (unsigned long long)bits);\n    }\n    printf(\"\\n\");\n}\n"
    "/* h = x + 2 y with a hole beyond x = 100 */\n"
    "int road_height(const void *self, gic_real time, gic_real x, gic_real y, gic_real out[3])\n"
    "{\n    (void)self, (void)time;\n    out[0] = x + 2 * y, out[1] = 1, out[2] = 2;\n    return x < 100;\n}\n";

static Program program_new(void)
{
    Program program = {.pool = pool_new()};
    program.functions.pool = program.calls.pool = program.pool;
    text_print(&program.functions, "%s", prologue);
    return program;
}

/* The block as int f<number>(q, x, k): q are inputs, x what it stores; k the constants of a member. */
static void program_function(Program *program, const Block *block, Constants *constants)
{
    text_print(&program->functions,
               "static int f%d(const void *self, gic_real time, gic_real *q, gic_real *x, const gic_real *k)\n{\n"
               "    (void)self, (void)time, (void)q, (void)x, (void)k;\n",
               program->blocks);
    block_emit(&program->functions, block, &style_readable, constants, 4);
    text_print(&program->functions, "    return GIC_OK;\n}\n");
    ++program->blocks;
}

static void list(Text *out, const char *name, const double *value, int count)
{
    text_print(out, "        gic_real %s[%d] = {", name, count + 1);
    for (int i = 0; i < count; ++i)
        text_print(out, "%a, ", value[i]);
    text_print(out, "0};\n");
}

/* Call the last function with these inputs and show `results` numbers of the array `shown`. */
static void program_call(Program *program, const double *q, int inputs, const double *k, int constants,
                         const char *shown, int results)
{
    text_print(&program->calls, "    {\n        gic_real x[%d] = {0};\n", results + 1);
    list(&program->calls, "q", q, inputs);
    list(&program->calls, "k", k, constants);
    text_print(&program->calls, "        int status = f%d(0, 0, q, x, k);\n        show(status, %s, %d);\n    }\n",
               program->blocks - 1, shown, results);
}

/* Compile and run; returns what it printed. */
static char *program_run(Program *program)
{
    char *folder = new_folder(program->pool);
    const char *source = pool_print(program->pool, "%s/p.c", folder), *compiler = getenv("CC");
    text_print(&program->functions, "int main(void)\n{\n%s    return 0;\n}\n", program->calls.s);
    file_write(source, program->functions.s, program->functions.size);
    const char *command = pool_print(program->pool,
                                     "cd %s && %s -std=c99 -O1 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror "
                                     "-ffp-contract=off p.c -lm -o p && "
                                     "./p >out",
                                     folder, compiler ? compiler : "cc");
    int status = system(command);
    size_t size;
    char *printed =
        status ? NULL : file_read(program->pool, pool_print(program->pool, "%s/out", folder), TEXT_MOST, &size);
    assert_int_equal(system(pool_print(program->pool, "rm -r %s", folder)), 0);
    assert_int_equal(status, 0);
    return printed;
}

/* The next line of *printed is `status`, then these numbers, bit for bit. */
static void assert_line(char **printed, int status, const double *value, int count)
{
    char *end = strchr(*printed, '\n'), *s = *printed;
    assert_non_null(end);
    assert_int_equal(strtol(s, &s, 10), status);
    for (int i = 0; i < count; ++i) {
        uint64_t bits = strtoull(s, &s, 16), own;
        memcpy(&own, &value[i], sizeof own);
        if (bits != own) {
            double found;
            memcpy(&found, &bits, sizeof found);
            fail_msg("number %d: compiled %.17g, in the graph %.17g", i, found, value[i]);
        }
    }
    assert_ptr_equal(s, end);
    *printed = end + 1;
}

/* ---- random blocks --------------------------------------------------------------------------------------- */

/* A random operation on earlier terms; raw nodes too, for their text must be right without simplification. */
static Ex grow(Dag *dag, Random *random, const Ex *term, int count)
{
    Ex a = term[random_bits(random) % (uint64_t)count], b = term[random_bits(random) % (uint64_t)count],
       c = term[random_bits(random) % (uint64_t)count];
    switch (random_bits(random) % 16) {
    case 0: return ex_neg(dag, a);
    case 1: return ex_add(dag, a, b);
    case 2: return ex_sub(dag, a, b);
    case 3: return ex_mul(dag, a, b);
    case 4: return ex_div(dag, a, ex_add(dag, ex_literal(dag, 1.5), ex_op(dag, OP_ABS, b, 0, 0)));
    case 5: return ex_sqrt(dag, ex_op(dag, OP_ABS, a, 0, 0));
    case 6: return ex_op(dag, OP_ATAN2, a, b, 0);
    case 7: return ex_op(dag, OP_MIN, a, b, 0);
    case 8: return ex_op(dag, OP_MAX, a, b, 0);
    case 9: return ex_op(dag, OP_POSITIVE, a, b, c);
    case 10: return ex_op(dag, OP_NEG, a, 0, 0);
    case 11: return ex_op(dag, OP_ADD, a, b, 0);
    case 12:
    case 13: return ex_op(dag, OP_SUB, a, b, 0);
    case 14: return ex_op(dag, OP_MUL, a, b, 0);
    default: return ex_op(dag, OP_DIV, a, ex_op(dag, OP_ADD, ex_op(dag, OP_ABS, b, 0, 0), ex_literal(dag, 0.75), 0), 0);
    }
}

/* Terms that stay finite at every sample. */
static void grow_all(Dag *dag, Random *random, Ex *term)
{
    int count = 0;
    for (; count < INPUTS; ++count) {
        double sample[SAMPLES];
        for (int s = 0; s < SAMPLES; ++s)
            sample[s] = random_uniform(random, -2, 2);
        term[count] = ex_input(dag, element_at(ARRAY_q, count), sample);
    }
    for (int i = 0; i < 3; ++i)
        term[count++] = ex_constant(dag, (double[]){random_uniform(random, -2, 2), random_uniform(random, -2, 2)});
    term[count++] = ex_literal(dag, random_uniform(random, -2, 2));
    while (count < TERMS) {
        Ex e = grow(dag, random, term, count);
        bool good = true;
        for (int s = 0; s < SAMPLES; ++s)
            good = good && fabs(ex_value(dag, e, s)) < 1e9;
        if (good)
            term[count++] = e;
    }
}

/* Every other block is scheduled, and every other one of these stores to what it reads: no store may be before that is
 * read for the last time. */
static Array random_block_target(int block)
{
    return block % 4 == 3 ? ARRAY_q : ARRAY_x;
}

static void test_random_blocks(void **state)
{
    (void)state;
    static Dag *dag[BLOCKS];
    static Ex stored[BLOCKS][STORES];
    Program program = program_new();
    for (int i = 0; i < BLOCKS; ++i) {
        Random random = {100 + (uint64_t)i};
        Ex term[TERMS];
        dag[i] = dag_new(program.pool, MEMBERS, SAMPLES);
        grow_all(dag[i], &random, term);
        Block block = {.dag = dag[i], .scheduled = i % 2 == 1};
        Constants constants = {0};
        for (int j = 0; j < STORES; ++j) {
            /* results, but inputs and constants now and then */
            stored[i][j] = term[j ? TERMS - 8 + j : (int)(random_bits(&random) % TERMS)];
            block_store(&block, stored[i][j], element_at(random_block_target(i), j));
        }
        program_function(&program, &block, &constants);
        for (int s = 0; s < SAMPLES; ++s) {
            double q[INPUTS], k[TERMS];
            for (int j = 0; j < INPUTS; ++j)
                q[j] = ex_value(dag[i], term[j], s);
            assert_in_range(constants.count, 0, TERMS);
            for (int j = 0; j < constants.count; ++j)
                k[j] = ex_value(dag[i], constants.e[j], s);
            program_call(&program, q, INPUTS, k, constants.count, i % 4 == 3 ? "q" : "x", STORES);
        }
    }
    char *printed = program_run(&program);
    for (int i = 0; i < BLOCKS; ++i)
        for (int s = 0; s < SAMPLES; ++s) {
            double x[STORES];
            for (int j = 0; j < STORES; ++j)
                x[j] = ex_value(dag[i], stored[i][j], s);
            assert_line(&printed, 0, x, STORES);
        }
    assert_string_equal(printed, "");
    pool_free(program.pool);
}

/* ---- order of operations --------------------------------------------------------------------------------- */

/* With a = 1, b = 1e16, c = -1e16, d = 3 every grouping has its own value. */
static void test_grouping(void **state)
{
    (void)state;
    const double q[] = {1, 1e16, -1e16, 3};
    Program program = program_new();
    Dag *dag = dag_new(program.pool, 1, 1);
    Ex v[4];
    for (int i = 0; i < 4; ++i)
        v[i] = ex_input(dag, element_at(ARRAY_q, i), &q[i]);
#define OP2(op, a, b) ex_op(dag, OP_##op, a, b, 0)
    const Ex e[] = {
        OP2(ADD, OP2(ADD, v[0], v[1]), v[2]), /* (1 + 1e16) - 1e16 = 0 */
        OP2(ADD, v[0], OP2(ADD, v[1], v[2])), /* 1 + 0 = 1 */
        OP2(SUB, v[0], OP2(SUB, v[1], v[3])), /* 1 - (1e16 - 3), where 1e16 - 3 = 9999999999999996 to even */
        OP2(SUB, OP2(SUB, v[0], v[1]), v[3]),
        OP2(DIV, v[0], OP2(DIV, v[3], v[3])), /* 1, not (1/3)/3 */
        OP2(DIV, OP2(DIV, v[0], v[3]), v[3]),
        OP2(MUL, v[3], OP2(DIV, v[0], v[3])),
        OP2(DIV, v[0], OP2(MUL, v[3], v[3])),
        OP2(MUL, OP2(SUB, v[0], v[3]), OP2(ADD, v[0], v[3])), /* -8 */
        OP2(SUB, v[0], OP2(NEG, v[3], 0)),                    /* 4; no decrement */
        OP2(NEG, OP2(NEG, v[3], 0), 0),
        OP2(NEG, OP2(SUB, v[0], v[3]), 0), /* 2 */
        OP2(MUL, OP2(NEG, v[3], 0), OP2(NEG, OP2(ADD, v[0], v[3]), 0)),
        OP2(SUB, v[0], ex_op(dag, OP_POSITIVE, v[2], v[0], OP2(SUB, v[0], v[3]))), /* 1 - (1 - 3) = 3 */
        OP2(SUB, v[3], ex_literal(dag, -2)),                                       /* 5 */
        OP2(MIN, OP2(SUB, v[0], v[3]), OP2(MAX, v[0], v[3])),
    };
#undef OP2
    enum { COUNT = sizeof e / sizeof *e };
    const double expected[COUNT] = {
        0, 1, -9999999999999995.0, -1e16 - 3 + 1, 1, 1.0 / 3 / 3, 3 * (1.0 / 3), 1.0 / 9, -8, 4, 3, 2, 12, 3, 5, -2};
    Block block = {.dag = dag};
    Constants constants = {0};
    for (int i = 0; i < COUNT; ++i)
        block_store(&block, e[i], element_at(ARRAY_x, i));
    program_function(&program, &block, &constants);
    program_call(&program, q, 4, NULL, 0, "x", COUNT);
    char *printed = program_run(&program);
    double value[COUNT];
    for (int i = 0; i < COUNT; ++i)
        value[i] = ex_value(dag, e[i], 0);
    for (int i = 0; i < COUNT; ++i)
        if (i != 2 && i != 3) /* the sums of these two are not whole numbers of a double */
            assert_true(value[i] == expected[i]);
    assert_line(&printed, 0, value, COUNT);
    assert_int_equal(constants.count, 0);
    pool_free(program.pool);
}

/* Functions whose digits are the library's: their text. */
static void test_function_text(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    Dag *dag = dag_new(pool, 1, 1);
    Ex x = ex_input(dag, element_at(ARRAY_q, 0), NULL), y = ex_input(dag, element_at(ARRAY_q, 1), NULL),
       sum = ex_add(dag, x, y);
    Block block = {.dag = dag};
    block_store(&block, ex_op(dag, OP_SIN, sum, 0, 0), element_at(ARRAY_x, 0));
    block_store(&block, ex_op(dag, OP_COS, ex_neg(dag, x), 0, 0), element_at(ARRAY_x, 1));
    block_store(&block, ex_op(dag, OP_ASIN, y, 0, 0), element_at(ARRAY_x, 2));
    block_store(&block, ex_op(dag, OP_ATAN2, y, x, 0), element_at(ARRAY_x, 3));
    Text out = {.pool = pool};
    Constants constants = {0};
    block_emit(&out, &block, &style_readable, &constants, 2);
    assert_string_equal(out.s, "  const gic_real t1 = GIC_SIN(q[0] + q[1]);\n  const gic_real t2 = GIC_COS(-q[0]);\n"
                               "  const gic_real t3 = GIC_ASIN(q[1]);\n  const gic_real t4 = GIC_ATAN2(q[1], q[0]);\n"
                               "  x[0] = t1;\n  x[1] = t2;\n  x[2] = t3;\n  x[3] = t4;\n");
    pool_free(pool);
}

/* ---- stores and checks ----------------------------------------------------------------------------------- */

/* Results go where inputs were read: all of them as they were before. */
static void test_stores_in_place(void **state)
{
    (void)state;
    const double q[] = {2, 3, 5};
    Program program = program_new();
    Dag *dag = dag_new(program.pool, 1, 1);
    Ex a = ex_input(dag, element_at(ARRAY_q, 0), &q[0]), b = ex_input(dag, element_at(ARRAY_q, 1), &q[1]),
       c = ex_input(dag, element_at(ARRAY_q, 2), &q[2]);
    Block block = {.dag = dag};
    Constants constants = {0};
    block_store(&block, b, element_at(ARRAY_q, 0));
    block_store(&block, a, element_at(ARRAY_q, 1));
    block_store(&block, ex_sub(dag, ex_mul(dag, a, c), b), element_at(ARRAY_q, 2));
    program_function(&program, &block, &constants);
    program_call(&program, q, 3, NULL, 0, "q", 3);
    /* the same value to two places, and constants */
    block = (Block){.dag = dag};
    block_store(&block, ex_add(dag, a, b), element_at(ARRAY_q, 1));
    block_store(&block, ex_add(dag, b, a), element_at(ARRAY_q, 0));
    block_store(&block, ex_literal(dag, 0.1), element_at(ARRAY_q, 2));
    program_function(&program, &block, &constants);
    program_call(&program, q, 3, NULL, 0, "q", 3);
    char *printed = program_run(&program);
    assert_line(&printed, 0, (double[]){3, 2, 7}, 3);
    assert_line(&printed, 0, (double[]){5, 5, 0.1}, 3);
    pool_free(program.pool);
}

static void test_checks(void **state)
{
    (void)state;
    static const struct {
        double q[2];
        int status;
    } call[] = {{{1, 1}, 0},     {{-1, 1}, -1},    {{0.5, 1}, -1},  {{0.51, -1}, 0},
                {{1, 0.25}, -2}, {{1, -0.25}, -2}, {{1, -0.26}, 0}, {{0, 0}, -1}};
    enum { CALLS = sizeof call / sizeof *call };
    Program program = program_new();
    Dag *dag = dag_new(program.pool, 1, 1);
    Ex a = ex_input(dag, element_at(ARRAY_q, 0), NULL), b = ex_input(dag, element_at(ARRAY_q, 1), NULL);
    Block block = {.dag = dag};
    Constants constants = {0};
    block_check(&block, a, false, 0.5, GIC_ERROR_MASS);
    block_check(&block, b, true, 0.25, GIC_ERROR_SINGULAR);
    block_check(&block, b, true, 0.125, GIC_ERROR_NEWTON);            /* says less than the one before */
    block_check(&block, ex_neg(dag, b), true, 0.25, GIC_ERROR_REACH); /* says the same */
    block_store(&block, ex_mul(dag, a, b), element_at(ARRAY_x, 0));
    assert_int_equal(block.checks, 2);
    program_function(&program, &block, &constants);
    for (int i = 0; i < CALLS; ++i)
        program_call(&program, call[i].q, 2, NULL, 0, "x", 1);
    /* not a number is not above anything */
    text_print(&program.calls,
               "    {\n        gic_real x[1] = {0}, q[2] = {1, NAN};\n        show(f0(0, 0, q, x, q), x, 1);\n"
               "        q[0] = NAN, q[1] = 1;\n        show(f0(0, 0, q, x, q), x, 1);\n    }\n");
    char *printed = program_run(&program);
    for (int i = 0; i < CALLS; ++i)
        assert_line(&printed, call[i].status, (double[]){call[i].status ? 0 : call[i].q[0] * call[i].q[1]}, 1);
    assert_line(&printed, -2, (double[]){0}, 1);
    assert_line(&printed, -1, (double[]){0}, 1);
    pool_free(program.pool);
}

/* The road is asked once for all that is wanted of it, and its refusal is a status. */
static void test_road(void **state)
{
    (void)state;
    Program program = program_new();
    Dag *dag = dag_new(program.pool, 1, 1);
    Ex x = ex_input(dag, element_at(ARRAY_q, 0), NULL), y = ex_input(dag, element_at(ARRAY_q, 1), NULL);
    Ex road = ex_op(dag, OP_ROAD, ex_add(dag, x, y), y, 0), part[3];
    for (int i = 0; i < 3; ++i)
        part[i] = ex_op(dag, OP_ROAD_PART, road, (Ex)i, 0);
    Block block = {.dag = dag};
    Constants constants = {0};
    block_store(&block, part[0], element_at(ARRAY_x, 0));
    block_store(&block, ex_sub(dag, part[0], ex_mul(dag, part[2], part[1])), element_at(ARRAY_x, 1));
    assert_int_equal(block_count(&block).function, 1);
    size_t before = program.functions.size;
    program_function(&program, &block, &constants);
    const char *first = strstr(program.functions.s + before, "road_height(");
    assert_non_null(first);
    assert_null(strstr(first + 1, "road_height("));
    program_call(&program, (double[]){3, 4}, 2, NULL, 0, "x", 2);
    program_call(&program, (double[]){99, 1}, 2, NULL, 0, "x", 2);
    char *printed = program_run(&program);
    assert_line(&printed, 0, (double[]){15, 13}, 2);
    assert_line(&printed, -9, (double[]){0, 0}, 2);
    pool_free(program.pool);
}

/* ---- templates ------------------------------------------------------------------------------------------- */

static void write_states(void *context, Text *out, int indent)
{
    text_print(out, "%*s<states in %s at %d>\n", indent, "", (const char *)context, indent);
}

static void write_two_words(void *context, Text *out, int indent)
{
    text_print(out, "%*s<two words in %s at %d>\n", indent, "", (const char *)context, indent);
}

static const Insertion general_point[] = {{"two words", write_two_words}, {NULL, NULL}};
static const Insertions general_points = {(const char *const[]){NULL}, general_point, NULL};
static const Insertion own_point[] = {{"states", write_states}, {NULL, NULL}};
static const Insertions own_points = {(const char *const[]){"t.in", NULL}, own_point, &general_points};

/* `text` as a template with prefix car and class arm. */
static char *expanded(Pool *pool, const char *text, const char *class)
{
    char *folder = new_folder(pool);
    const char *path = pool_print(pool, "%s/t.in", folder);
    file_write(path, text, strlen(text));
    Text out = {.pool = pool};
    static char context[] = "here";
    template_expand(pool, &out, folder, "t.in", "car", class, &own_points, context);
    unlink(path);
    rmdir(folder);
    return out.s;
}

static void test_template(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    assert_string_equal(expanded(pool, "int PREFIX_setup(PREFIX *self);\n", NULL), "int car_setup(car *self);\n");
    assert_string_equal(expanded(pool, "enum { UPPER_SIZE = sizeof(PREFIX_CLASS_t) }; /* UPPER */\n", "arm"),
                        "enum { CAR_SIZE = sizeof(car_arm_t) }; /* CAR */\n");
    assert_string_equal(expanded(pool, "CLASS x = PREFIX_x; y(&PREFIX, -PREFIX)\n", "arm"),
                        "arm x = car_x; y(&car, -car)\n");
    /* without a class that word is one like others; within a word nothing is replaced */
    assert_string_equal(expanded(pool, "CLASS MYPREFIX 2UPPER\n", NULL), "CLASS MYPREFIX 2UPPER\n");
    assert_string_equal(expanded(pool, "a\n/* @states@ */\n    /* @two words@ */\n\nb\n", NULL),
                        "a\n<states in here at 0>\n    <two words in here at 4>\n\nb\n");
    /* only a line of its own is an insertion point */
    assert_string_equal(expanded(pool, "x; /* @states@ */\n/* @states@ */ y;\n/* states */\n", NULL),
                        "x; /* @states@ */\n/* @states@ */ y;\n/* states */\n");
    /* remarks are not copied, comments are */
    assert_string_equal(expanded(pool, "/*- for the reader of the template: PREFIX */\n/* copied */\na\n", NULL),
                        "/* copied */\na\n");
    assert_string_equal(expanded(pool, "the last line has no end", NULL), "the last line has no end\n");
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),       cmocka_unit_test(test_random_blocks),   cmocka_unit_test(test_grouping),
        cmocka_unit_test(test_function_text), cmocka_unit_test(test_stores_in_place), cmocka_unit_test(test_checks),
        cmocka_unit_test(test_road),          cmocka_unit_test(test_template),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
