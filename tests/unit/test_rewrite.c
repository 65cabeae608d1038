/* SPDX-License-Identifier: MIT
 * Names inside formulas follow the mirror and a prefix (FORMAT.md sections 12 and 13). */
#include "base/file.h"
#include "base/yaml.h"
#include "host/host.h"
#include "read/reader.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char model[] =
    "gicgen: 1\n"
    "coordinates:\n"
    "  spring_l: {type: length}\n"
    "  bar_r: {type: angle}\n"
    "  rack: {type: translation}\n"
    "inputs:\n"
    "  brake_l: {}\n"
    "forces:\n"
    "  law_l: {type: force, coordinate: spring_l, value: FORMULA}\n"
    "tires:\n"
    "  soft_l: {file: soft_l.tir}\n"
    "  hard: {file: hard.tir}\n"
    "wheels:\n"
    "  front_l: {tire: soft_l, side: right, center: [1, 2, 3], axis: [0.1, 0.9, -0.2]}\n"
    "  rear_l: {tire: hard, side: left, drive: brake_l * spin, axis: [0, 1, 0], drive_body: hub_l}\n";

/* The tree of `model` with this formula in it. */
static const Item *file_with(Pool *pool, const char *formula)
{
    char *path = pool_print(pool, "%s/test-rewrite-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    const char *hole = strstr(model, "FORMULA");
    char *text = pool_print(pool, "%.*s\"%s\"%s", (int)(hole - model), model, formula, hole + strlen("FORMULA"));
    file_write(path, text, strlen(text));
    const Item *tree = file_included(pool, path);
    remove(path);
    return tree;
}

static const Item *at(const Item *map, const char *group, const char *name, const char *key)
{
    const Item *item = doc_find(doc_find(map, group), name);
    assert_non_null(item);
    return doc_find(item, key);
}

static void test_mirror(void **unused)
{
    (void)unused;
    static const char *const pair[][2] = {
        {"-3e4 * (spring_l - spring_r)", "-3e4 * (spring_r - spring_l)"},
        {"rate(spring_l) + brake_l * 2", "rate(spring_r) + brake_r * 2"},
        {"rack + rack.rate", "rack + rack.rate"},
        {"bar_r + other_l + 1e3", "bar_r + other_l + 1e3"},     /* no bar_l, no other_l */
        {"spring_left + spring_l2", "spring_left + spring_l2"}, /* whole names only */
        {"min(spring_l,-.5)", "min(spring_r,-.5)"},
        {"rack.brake_l + brake_l", "rack.brake_l + brake_r"}, /* what follows a dot is no name */
    };
    for (size_t i = 0; i < sizeof pair / sizeof *pair; ++i) {
        Pool *pool = pool_new();
        const Item *file = file_mirrored(pool, file_with(pool, pair[i][0]));
        assert_string_equal(at(file, "forces", "law_l", "value")->text, pair[i][0]);
        assert_string_equal(at(file, "forces", "law_r", "value")->text, pair[i][1]);
        assert_string_equal(at(file, "forces", "law_r", "coordinate")->text, "spring_r");
        pool_free(pool);
    }
}

static void test_prefix(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Item *file = file_with(pool, "2*spring_l + rack.rate - time + brake_l - spring_r");
    Rewrite rewrite = {.pool = pool, .file = file, .prefix = "front_"};
    Item *law = doc_find(file, "forces")->value[0];
    const Item *renamed = entry_rewrite(&rewrite, "forces", law);
    /* spring_r is not there before the mirror, but will be */
    assert_string_equal(doc_find(renamed, "value")->text,
                        "2*front_spring_l + front_rack.rate - time + front_brake_l - front_spring_r");
    assert_string_equal(doc_find(renamed, "coordinate")->text, "front_spring_l");
    pool_free(pool);
}

/* The number that an item stands for, in the mirror too. */
static double component(const Item *list, int i)
{
    return doc_number(list->value[i], "component");
}

/* An axis of spin is one of turning; what the file of a tire is called is no name of the model. */
static void test_wheels(void **unused)
{
    (void)unused;
    static const double axis[3] = {-0.1, 0.9, 0.2}, center[3] = {1, -2, 3};
    Pool *pool = pool_new();
    const Item *file = file_mirrored(pool, file_with(pool, "0"));
    assert_string_equal(at(file, "wheels", "front_r", "side")->text, "left");
    assert_string_equal(at(file, "wheels", "rear_r", "side")->text, "right");
    assert_string_equal(at(file, "wheels", "front_r", "tire")->text, "soft_r");
    assert_string_equal(at(file, "wheels", "rear_r", "tire")->text, "hard");
    assert_string_equal(at(file, "wheels", "rear_r", "drive")->text, "brake_r * spin");
    assert_string_equal(at(file, "tires", "soft_r", "file")->text, "soft_l.tir");
    for (int i = 0; i < 3; ++i) {
        assert_true(component(at(file, "wheels", "front_r", "axis"), i) == axis[i]);
        assert_true(component(at(file, "wheels", "front_r", "center"), i) == center[i]);
    }
    Rewrite rewrite = {.pool = pool, .file = file, .prefix = "front_"};
    Item *wheel = doc_find(file, "wheels")->value[2];
    const Item *renamed = entry_rewrite(&rewrite, "wheels", wheel);
    assert_string_equal(doc_find(renamed, "tire")->text, "front_hard");
    assert_string_equal(doc_find(renamed, "side")->text, "left");
    assert_string_equal(doc_find(renamed, "drive")->text, "front_brake_l * spin");
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mirror), cmocka_unit_test(test_prefix),
                                       cmocka_unit_test(test_wheels)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
