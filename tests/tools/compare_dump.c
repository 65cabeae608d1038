/* SPDX-License-Identifier: MIT
 * compare_dump EXPECTED ACTUAL [LEAST]: compare two dumped models (FORMAT.md section 11), whatever their layout and
 * order of keys; the sequence is another test's. A number by itself, which may be a difference of large ones too, is
 * taken to be LEAST in size (default 0) where it is less. Prints the first difference; exit status 0: equal, 1:
 * different, 2: usage. */
#include "base/yaml.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Relative to the largest number of a vector, because small components are differences of large ones. */
static const double tolerance = 1e-14;

static _Noreturn void differ(const Item *expected, const Item *actual, const char *what)
{
    diag_fail(actual->at, NULL, "%s; expected in line %d: %s", what, expected->at.line,
              expected->kind == ITEM_SCALAR ? expected->text : "(see there)");
}

static bool is_number(const Item *item)
{
    return item->kind == ITEM_SCALAR && !item->quoted && item->text[0] && strchr("+-.0123456789", item->text[0]);
}

static void compare(const Item *expected, const Item *actual, double scale, double least)
{
    if (expected->kind != actual->kind)
        differ(expected, actual, "another kind of value");
    if (is_number(expected)) {
        double x = doc_number(expected, "expected"), y = doc_number(actual, "actual");
        if (!(fabs(x - y) <= tolerance * fmax(scale, fabs(x))))
            differ(expected, actual, "another number");
    } else if (expected->kind == ITEM_SCALAR) {
        if (strcmp(expected->text, actual->text) || expected->quoted != actual->quoted)
            differ(expected, actual, "another text");
    } else if (expected->count != actual->count) {
        differ(expected, actual, "another number of elements");
    } else if (expected->kind == ITEM_LIST) {
        scale = least;
        for (int i = 0; i < expected->count; ++i)
            if (is_number(expected->value[i]))
                scale = fmax(scale, fabs(doc_number(expected->value[i], "expected")));
        for (int i = 0; i < expected->count; ++i)
            compare(expected->value[i], actual->value[i], scale, least);
    } else {
        for (int i = 0; i < expected->count; ++i) {
            const char *key = expected->key[i]->text;
            const Item *value = doc_find(actual, key);
            if (!value)
                differ(expected->key[i], actual, "a key is missing");
            if (strcmp(key, "sequence"))
                compare(expected->value[i], value, least, least);
        }
    }
}

int main(int count, char **argument)
{
    if (count != 3 && count != 4) {
        fputs("usage: compare_dump EXPECTED ACTUAL [LEAST]\n", stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const double least = count == 4 ? strtod(argument[3], NULL) : 0;
    compare(doc_read(pool, argument[1]), doc_read(pool, argument[2]), least, least);
    pool_free(pool);
    return 0;
}
