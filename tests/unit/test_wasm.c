/* SPDX-License-Identifier: MIT
 * The interpreter of WebAssembly: numeric instructions at the ends of their types, by values that follow from the
 * standard; blocks, branches, calls and memory of modules made here byte by byte; and modules that are cut off or
 * spoiled, which are refused. What whole vehicles compute in it and in a browser, test_drive.sh compares. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "wasm/wasm.h"

/* ---- modules ----------------------------------------------------------------------------------------------------- */

typedef struct Bytes {
    unsigned char byte[600];
    size_t size;
} Bytes;

static void add(Bytes *to, const void *bytes, size_t size)
{
    assert_true(to->size + size <= sizeof to->byte);
    memcpy(to->byte + to->size, bytes, size);
    to->size += size;
}

static void add_byte(Bytes *to, int byte)
{
    const unsigned char one = (unsigned char)byte;
    add(to, &one, 1);
}

/* A number of less than 14 bits. */
static void add_size(Bytes *to, size_t size)
{
    add_byte(to, (int)(size & 0x7f) | 0x80);
    add_byte(to, (int)(size >> 7));
}

static void add_section(Bytes *to, int kind, const void *bytes, size_t size)
{
    add_byte(to, kind);
    add_size(to, size);
    add(to, bytes, size);
}
#define SECTION(to, kind, ...) \
    add_section((to), (kind), (const unsigned char[]){__VA_ARGS__}, sizeof((const unsigned char[]){__VA_ARGS__}))

static int kind_of(char letter)
{
    return letter == 'i' ? 0x7f : letter == 'l' ? 0x7e : letter == 'f' ? 0x7d : 0x7c;
}

static const unsigned char head[] = {0, 'a', 's', 'm', 1, 0, 0, 0};

/* A module with one function `f` of a type such as "dd:i", and its body without the last `end`. */
static Bytes one_function(const char *type, const unsigned char *body, size_t size)
{
    Bytes out = {.size = 0}, types = {.size = 0}, code = {.size = 0};
    const size_t count = strcspn(type, ":");
    add(&types, (const unsigned char[]){1, 0x60, (unsigned char)count}, 3);
    for (size_t i = 0; i < count; ++i)
        add_byte(&types, kind_of(type[i]));
    add_byte(&types, type[count + 1] ? 1 : 0);
    if (type[count + 1])
        add_byte(&types, kind_of(type[count + 1]));
    add_byte(&code, 1);
    add_size(&code, size + 4);
    add(&code, (const unsigned char[]){1, 2, 0x7f}, 3); /* two variables more, of type i32 */
    add(&code, body, size);
    add_byte(&code, 0x0b);
    add(&out, head, sizeof head);
    add_section(&out, 1, types.byte, types.size);
    SECTION(&out, 3, 1, 0);
    SECTION(&out, 5, 1, 1, 1, 3); /* memory of a page, three at most */
    SECTION(&out, 7, 1, 1, 'f', 0, 0);
    add_section(&out, 10, code.byte, code.size);
    return out;
}

/* Call f of a module: NULL, and the result, or why not. */
static const char *call(const Bytes *module, int count, WasmCell *cell)
{
    const char *why;
    Pool *pool = pool_new();
    Wasm *wasm = wasm_open(pool, module->byte, module->size, &why);
    if (!wasm)
        fail_msg("%s", why);
    why = wasm_call(wasm, "f", cell, count);
    pool_free(pool);
    return why;
}
#define BODY(...) (const unsigned char[]){__VA_ARGS__}, sizeof((const unsigned char[]){__VA_ARGS__})

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

typedef struct Case {
    int op;           /* 0xfc00 + what follows the prefix */
    const char *type; /* "dd:i" */
    double a, b;      /* exact in all types */
    double result;    /* NAN: the call ends, or of type d and f a number that is none */
} Case;

static const double two31 = 2147483648.0, two32 = 4294967296.0, two63 = 9223372036854775808.0;

static WasmCell cell_of(char kind, double value)
{
    WasmCell out = {.u64 = 0};
    if (kind == 'i')
        out.u32 = (uint32_t)(int64_t)value;
    else if (kind == 'l')
        out.u64 = value >= two63 ? (uint64_t)value : (uint64_t)(int64_t)value;
    else if (kind == 'f')
        out.f32 = (float)value;
    else
        out.f64 = value;
    return out;
}

static bool is_value(WasmCell cell, char kind, double value)
{
    const WasmCell wanted = cell_of(kind, value);
    if ((kind == 'd' || kind == 'f') && isnan(value))
        return isnan(kind == 'd' ? cell.f64 : (double)cell.f32);
    return kind == 'i' || kind == 'f' ? cell.u32 == wanted.u32 : cell.u64 == wanted.u64;
}

static void test_numbers(void **state)
{
    const Case cases[] = {
        {0x45, "i:i", 0, 0, 1},
        {0x48, "ii:i", -1, 0, 1},
        {0x49, "ii:i", -1, 0, 0},
        {0x4e, "ii:i", 0, -1, 1},
        {0x4f, "ii:i", 0, -1, 0},
        {0x53, "ll:i", -1, 0, 1},
        {0x54, "ll:i", -1, 0, 0},
        {0x61, "dd:i", -0.0, 0, 1},
        {0x61, "dd:i", NAN, NAN, 0},
        {0x62, "dd:i", NAN, NAN, 1},
        {0x65, "dd:i", 1, NAN, 0},
        {0x66, "dd:i", INFINITY, 1, 1},
        {0x67, "i:i", 1, 0, 31},
        {0x67, "i:i", 0, 0, 32},
        {0x68, "i:i", 8, 0, 3},
        {0x68, "i:i", 0, 0, 32},
        {0x69, "i:i", -1, 0, 32},
        {0x79, "l:l", 1, 0, 63},
        {0x7a, "l:l", 0, 0, 64},
        {0x7b, "l:l", -1, 0, 64},
        {0x6a, "ii:i", two31 - 1, 1, -two31},
        {0x6b, "ii:i", -two31, 1, two31 - 1},
        {0x6c, "ii:i", 65536, 65536, 0},
        {0x6d, "ii:i", -7, 2, -3},
        {0x6d, "ii:i", -two31, -1, NAN},
        {0x6d, "ii:i", 1, 0, NAN},
        {0x6e, "ii:i", -2, 2, two31 - 1},
        {0x6f, "ii:i", -7, 2, -1},
        {0x6f, "ii:i", -two31, -1, 0},
        {0x70, "ii:i", -1, 10, 5},
        {0x70, "ii:i", 1, 0, NAN},
        {0x71, "ii:i", 12, 10, 8},
        {0x72, "ii:i", 12, 10, 14},
        {0x73, "ii:i", 12, 10, 6},
        {0x74, "ii:i", 1, 33, 2},
        {0x75, "ii:i", -8, 1, -4},
        {0x76, "ii:i", -8, 29, 7},
        {0x77, "ii:i", -two31, 1, 1},
        {0x77, "ii:i", 5, 32, 5},
        {0x78, "ii:i", 1, 1, -two31},
        {0x78, "ii:i", 5, 0, 5},
        {0x7f, "ll:l", -7, 2, -3},
        {0x7f, "ll:l", -two63, -1, NAN},
        {0x80, "ll:l", -2, two32, two32 - 1},
        {0x81, "ll:l", -two63, -1, 0},
        {0x82, "ll:l", 7, 0, NAN},
        {0x86, "ll:l", 1, 64, 1},
        {0x87, "ll:l", -8, 1, -4},
        {0x88, "ll:l", -1, 63, 1},
        {0x89, "ll:l", -two63, 1, 1},
        {0x8a, "ll:l", 1, 1, -two63},
        {0x90, "f:f", 2.5, 0, 2},
        {0x92, "ff:f", 16777216, 1, 16777216}, /* rounded to even */
        {0x96, "ff:f", 0, -0.0, -0.0},
        {0x98, "ff:f", 1, -0.0, -1},
        {0x99, "d:d", -0.0, 0, 0},
        {0x9a, "d:d", 0, 0, -0.0},
        {0x9b, "d:d", -0.5, 0, -0.0},
        {0x9c, "d:d", -0.5, 0, -1},
        {0x9d, "d:d", -1.5, 0, -1},
        {0x9e, "d:d", 0.5, 0, 0},
        {0x9e, "d:d", 1.5, 0, 2},
        {0x9e, "d:d", -2.5, 0, -2},
        {0x9f, "d:d", 2, 0, 1.4142135623730951},
        {0x9f, "d:d", -1, 0, NAN},
        {0xa0, "dd:d", 9007199254740992.0, 1, 9007199254740992.0},
        {0xa1, "dd:d", INFINITY, INFINITY, NAN},
        {0xa2, "dd:d", 0x1p-1074, 0.5, 0}, /* half of the least number, to even */
        {0xa3, "dd:d", 1, -0.0, -INFINITY},
        {0xa4, "dd:d", 0, -0.0, -0.0},
        {0xa4, "dd:d", 1, NAN, NAN},
        {0xa5, "dd:d", -0.0, 0, 0},
        {0xa5, "dd:d", NAN, 1, NAN},
        {0xa6, "dd:d", 3, -0.0, -3},
        {0xa7, "l:i", two32 + 5, 0, 5},
        {0xa8, "f:i", -1.5, 0, -1},
        {0xaa, "d:i", two31 - 0.5, 0, two31 - 1},
        {0xaa, "d:i", two31, 0, NAN},
        {0xaa, "d:i", -two31 - 0.5, 0, -two31},
        {0xaa, "d:i", NAN, 0, NAN},
        {0xab, "d:i", -0.5, 0, 0},
        {0xab, "d:i", -1, 0, NAN},
        {0xab, "d:i", two32 - 1, 0, -1},
        {0xab, "d:i", two32, 0, NAN},
        {0xac, "i:l", -1, 0, -1},
        {0xad, "i:l", -1, 0, two32 - 1},
        {0xb0, "d:l", -two63, 0, -two63},
        {0xb0, "d:l", two63, 0, NAN},
        {0xb1, "d:l", two63, 0, two63},
        {0xb1, "d:l", 2 * two63, 0, NAN},
        {0xb6, "d:f", 1 + 0x1p-24, 0, 1},
        {0xb7, "i:d", -1, 0, -1},
        {0xb8, "i:d", -1, 0, two32 - 1},
        {0xb9, "l:d", -1, 0, -1},
        {0xba, "l:d", two63, 0, two63},
        {0xbb, "f:d", 0.5, 0, 0.5},
        {0xbd, "d:l", -0.0, 0, -two63},
        {0xbf, "l:d", -two63, 0, -0.0},
        {0xc0, "i:i", 0x180, 0, -128},
        {0xc1, "i:i", 0x18000, 0, -32768},
        {0xc2, "l:l", 0xff, 0, -1},
        {0xc4, "l:l", two31, 0, -two31},
        {0xfc02, "d:i", NAN, 0, 0},
        {0xfc02, "d:i", 1e300, 0, two31 - 1},
        {0xfc03, "d:i", -5, 0, 0},
        {0xfc03, "d:i", 1e300, 0, -1},
        {0xfc06, "d:l", -INFINITY, 0, -two63},
        {0xfc07, "d:l", 1e300, 0, -1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const Case *c = &cases[i];
        const int count = (int)strcspn(c->type, ":");
        const char to = c->type[count + 1];
        Bytes body = {.size = 0};
        for (int k = 0; k < count; ++k) {
            add_byte(&body, 0x20);
            add_byte(&body, k);
        }
        if (c->op >= 0xfc00)
            add_byte(&body, 0xfc);
        add_byte(&body, c->op & 0xff);
        const Bytes module = one_function(c->type, body.byte, body.size);
        WasmCell cell[2] = {cell_of(c->type[0], c->a), cell_of(count > 1 ? c->type[1] : 'i', c->b)};
        const char *why = call(&module, count, cell);
        const bool ends = isnan(c->result) && (to == 'i' || to == 'l');
        if (ends ? !why : why || !is_value(cell[0], to, c->result))
            fail_msg("%x of %g, %g: %s, %g %lld instead of %g", (unsigned)c->op, c->a, c->b, why ? why : "good",
                     cell[0].f64, (long long)cell[0].i64, c->result);
    }
}

/* ---- control ----------------------------------------------------------------------------------------------------- */

static int run(const Bytes *module, int argument)
{
    WasmCell cell[1] = {{.i32 = argument}};
    const char *why = call(module, 1, cell);
    if (why)
        fail_msg("%s", why);
    return cell[0].i32;
}

static void test_blocks(void **state)
{
    (void)state;
    /* 1 + 2 + ... + n: a loop in a block, left by br_if, with a value below it that the branch back drops */
    const Bytes sum =
        one_function("i:i", BODY(0x02, 0x40, 0x03, 0x40, 0x20, 0, 0x45, 0x0d, 1, 0x20, 1, 0x20, 0, 0x6a, 0x21, 1, 0x20,
                                 0, 0x41, 1, 0x6b, 0x22, 0, 0x20, 0, 0x0c, 0, 0x0b, 0x0b, 0x20, 1));
    assert_int_equal(run(&sum, 10), 55);
    assert_int_equal(run(&sum, 0), 0);
    /* a table of branches that carry a value over another one: 7, then 8, else 9 */
    const Bytes choose =
        one_function("i:i", BODY(0x02, 0x7f, 0x02, 0x7f, 0x02, 0x7f, 0x41, 5, 0x41, 7, 0x20, 0, 0x0e, 2, 0, 1, 2, 0x0b,
                                 0x0f, 0x0b, 0x41, 1, 0x6a, 0x0f, 0x0b, 0x41, 2, 0x6a));
    assert_int_equal(run(&choose, 0), 7);
    assert_int_equal(run(&choose, 1), 8);
    assert_int_equal(run(&choose, 2), 9);
    assert_int_equal(run(&choose, -1), 9);
    /* if and else with a result; what follows a branch is not looked at, nested blocks of it neither */
    const Bytes either = one_function("i:i", BODY(0x20, 0, 0x04, 0x7f, 0x41, 3, 0x0c, 0, 0x02, 0x40, 0x04, 0x40, 0x05,
                                                  0x0b, 0x0b, 0x6a, 0x05, 0x41, 4, 0x0b));
    assert_int_equal(run(&either, 1), 3);
    assert_int_equal(run(&either, 0), 4);
    /* if without else; select; tee; a variable that nobody sets is 0 */
    const Bytes alone = one_function(
        "i:i", BODY(0x20, 0, 0x04, 0x40, 0x41, 9, 0x21, 1, 0x0b, 0x20, 1, 0x20, 2, 0x20, 0, 0x22, 2, 0x1b));
    assert_int_equal(run(&alone, 1), 9);
    assert_int_equal(run(&alone, 0), 0);
}

/* Three functions, a table, a global and data. */
static Bytes whole_module(void)
{
    Bytes out = {.size = 0};
    add(&out, head, sizeof head);
    SECTION(&out, 1, 3, 0x60, 1, 0x7f, 1, 0x7f, 0x60, 0, 0, 0x60, 1, 0x7f, 1, 0x7f);
    SECTION(&out, 3, 4, 0, 2, 1, 0);
    SECTION(&out, 4, 1, 0x70, 0, 3);
    SECTION(&out, 5, 1, 0, 1);
    SECTION(&out, 6, 1, 0x7f, 1, 0x41, 10, 0x0b);
    SECTION(&out, 7, 2, 1, 'f', 0, 0, 1, 'g', 0, 3);
    SECTION(&out, 8, 2); /* start: the global grows by one */
    SECTION(&out, 9, 1, 0, 0x41, 0, 0x0b, 2, 1, 2);
    SECTION(&out, 10, 4,
            /* f: table[x](x), by a type that is equal to the function's, but another one */
            9, 0, 0x20, 0, 0x20, 0, 0x11, 0, 0, 0x0b,
            /* twice x, the global, and the byte at x + 2 */
            16, 0, 0x20, 0, 0x41, 1, 0x74, 0x23, 0, 0x6a, 0x20, 0, 0x2d, 0, 2, 0x6a, 0x0b,
            /* start */
            9, 0, 0x23, 0, 0x41, 1, 0x6a, 0x24, 0, 0x0b,
            /* g: itself without end */
            6, 0, 0x20, 0, 0x10, 3, 0x0b);
    SECTION(&out, 11, 1, 0, 0x41, 2, 0x0b, 2, 100, 200);
    return out;
}

static void test_calls(void **state)
{
    const Bytes module = whole_module();
    WasmCell cell[1] = {{.i32 = 0}};
    const char *why;
    (void)state;
    assert_int_equal(run(&module, 0), 111); /* 0 + 11 + 100 */
    cell[0].i32 = 1;
    assert_string_equal(call(&module, 1, cell), "it calls what is no such function"); /* of another type */
    cell[0].i32 = 2;
    assert_string_equal(call(&module, 1, cell), "it calls what is no such function"); /* none */
    cell[0].i32 = -1;
    assert_string_equal(call(&module, 1, cell), "it calls what is no such function"); /* beyond */
    Pool *pool = pool_new();
    Wasm *wasm = wasm_open(pool, module.byte, module.size, &why);
    assert_non_null(wasm);
    assert_string_equal(wasm_call(wasm, "g", cell, 1), "its calls go too deep");
    assert_string_equal(wasm_call(wasm, "g", cell, 0), "there is no such function");
    assert_string_equal(wasm_call(wasm, "", cell, 0), "there is no such function"); /* start */
    assert_non_null(wasm_memory(wasm, 65535, 1));
    assert_non_null(wasm_memory(wasm, 65536, 0));
    assert_null(wasm_memory(wasm, 65535, 2));
    assert_null(wasm_memory(wasm, 0xffffffff, 8));
    assert_int_equal(wasm_load(wasm_memory(wasm, 2, 2), 2), 100 + 256 * 200);
    pool_free(pool);
}

static void test_memory(void **state)
{
    (void)state;
    /* the bytes of a number from the least one on: stored whole, loaded as 16 bits with a sign */
    const Bytes parts = one_function("i:i", BODY(0x41, 8, 0x20, 0, 0x36, 2, 4, 0x41, 8, 0x2e, 1, 5));
    assert_int_equal(run(&parts, 0x00ff8012), (int16_t)0xff80);
    /* growth: sizes before, until there is no more; what is new is 0 */
    const Bytes more = one_function(
        "i:i", BODY(0x20, 0, 0x40, 0, 0x3f, 0, 0x41, 0xe4, 0, 0x6c, 0x6a, 0x41, 0xfc, 0xff, 7, 0x28, 2, 0, 0x6a));
    assert_int_equal(run(&more, 2), 1 + 300);
    assert_int_equal(run(&more, 1), 1 + 200);
    WasmCell cell[1] = {{.i32 = 3}}; /* four pages are one too many; the load beyond the first page is outside then */
    assert_string_equal(call(&more, 1, cell), "it reads outside of its memory");
    /* a store at the end */
    const Bytes last = one_function("i:i", BODY(0x20, 0, 0x41, 1, 0x36, 2, 0, 0x41, 1));
    assert_int_equal(run(&last, 65532), 1);
    cell[0].i32 = 65533;
    assert_string_equal(call(&last, 1, cell), "it writes outside of its memory");
    cell[0].i32 = -1;
    assert_string_equal(call(&last, 1, cell), "it writes outside of its memory");
    /* ten bytes of 7 from 0, then copied by one place onto themselves; the eleventh is 7 too, the twelfth is not */
    const Bytes moved = one_function("i:i", BODY(0x41, 0, 0x41, 7, 0x41, 10, 0xfc, 11, 0, 0x41, 1, 0x41, 0, 0x20, 0,
                                                 0xfc, 10, 0, 0, 0x41, 10, 0x2f, 0, 0));
    assert_int_equal(run(&moved, 10), 7);
    cell[0].i32 = 65536;
    assert_string_equal(call(&moved, 1, cell), "it moves what is outside of its memory");
}

/* ---- modules that are none --------------------------------------------------------------------------------------- */

static void test_spoiled(void **state)
{
    const Bytes good = whole_module();
    uint32_t seed = 1;
    int refused = 0;
    (void)state;
    for (size_t size = 0; size < good.size; ++size) { /* whole but for sections at its end, it may be one */
        const char *why = NULL;
        Pool *pool = pool_new();
        unsigned char *part = malloc(size + 1); /* so that a look beyond the end is seen */
        memcpy(part, good.byte, size);
        if (!wasm_open(pool, part, size, &why)) {
            assert_non_null(why);
            ++refused;
        }
        free(part);
        pool_free(pool);
    }
    assert_true(refused > (int)good.size - 12);
    for (int i = 0; i < 1000; ++i) {
        const char *why;
        Bytes spoiled = good;
        Pool *pool = pool_new();
        for (int k = 0; k < 1 + i % 3; ++k) {
            seed = seed * 1664525 + 1013904223;
            spoiled.byte[8 + (seed >> 8) % (good.size - 8)] = (unsigned char)(seed >> 24);
        }
        Wasm *wasm = wasm_open(pool, spoiled.byte, spoiled.size, &why);
        WasmCell cell[1] = {{.i32 = i % 5}};
        if (wasm)
            wasm_call(wasm, "f", cell, 1);
        pool_free(pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_blocks),  cmocka_unit_test(test_calls),
        cmocka_unit_test(test_memory),  cmocka_unit_test(test_spoiled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
