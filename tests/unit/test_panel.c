/* SPDX-License-Identifier: MIT
 * Small diagrams as SVG: numbers along their axes are different ones and do not overlap, in ranges nice and nasty. */
#include "base/pool.h"
#include "run/panel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 40 };

typedef struct Label {
    double x, y;
    char anchor[8], text[40];
} Label;

/* The labels of a diagram; the name of the abscissa, which is no number, is left out. */
static int labels_of(const char *svg, Label label[MOST])
{
    int count = 0;
    for (const char *at = strstr(svg, "<text "); at; at = strstr(at + 1, "<text ")) {
        Label *now = &label[count];
        double number;
        if (sscanf(at, "<text x=\"%lf\" y=\"%lf\" text-anchor=\"%7[a-z]\">%39[^<]", &now->x, &now->y, now->anchor,
                   now->text) == 4 &&
            sscanf(now->text, "%lf", &number) == 1)
            assert_true(++count < MOST);
    }
    return count;
}

/* As wide as its characters, of 10 pixels, which are 8 high above their base and 6 wide. */
static void box_of(const Label *label, double box[4])
{
    const double width = 6.0 * (double)strlen(label->text);
    box[0] = label->x - (strcmp(label->anchor, "end") ? width / 2 : width);
    box[1] = box[0] + width;
    box[2] = label->y - 8;
    box[3] = label->y;
}

static void check_range(const double x[2], const double y[2])
{
    Pool *pool = pool_new();
    Text out = {.pool = pool};
    double values[2] = {y[0], y[1]};
    Label label[MOST];
    const Panel panel = {.title = "t", .unit = "m", .below = "time", .rows = 2, .curves = 1, .x = x, .y = values};
    panel_draw(&out, &panel);
    const int count = labels_of(out.s, label);
    assert_true(count >= 4);
    for (int i = 0; i < count; ++i) {
        double a[4], b[4];
        box_of(&label[i], a);
        if (!(a[0] >= 0 && a[1] <= 280))
            print_message("%s at %g\n", label[i].text, label[i].x);
        assert_true(a[0] >= 0 && a[1] <= 280); /* the picture is 280 wide */
        for (int j = 0; j < i; ++j) {
            box_of(&label[j], b);
            if (a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3])
                print_message("%s over %s at %g\n", label[i].text, label[j].text, label[i].x);
            assert_false(a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3]);
            assert_false(!strcmp(label[i].anchor, label[j].anchor) && !strcmp(label[i].text, label[j].text));
        }
    }
    pool_free(pool);
}

static void test_ranges(void **unused)
{
    (void)unused;
    static const double range[][2] = {
        {0, 1},         {-1, 1},       {0, 0},          {5, 5},           {1e5, 1.2e5},   {0, 1e12},
        {0, 1e-12},     {-1e12, 1e12}, {1e6, 1e6 + 1},  {-1e5 - 2, -1e5}, {1000, 1000.1}, {123456, 123457},
        {-3e-5, 7e-5},  {0.1, 0.3},    {-250, -249.99}, {1e-4, 1.1e-4},   {0, 99999},     {-99999, 100001},
        {1.5, 1.50001}, {-0.01, 0.02}, {7, 7 + 1e-9},   {-1e300, 1e300},  {0, 1e-300},    {0.5, 2}};
    enum { RANGES = sizeof range / sizeof *range };
    for (int i = 0; i < RANGES; ++i)
        for (int j = 0; j < RANGES; ++j)
            check_range(range[i], range[j]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ranges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
