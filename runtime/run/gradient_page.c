/* SPDX-License-Identifier: MIT
 * The page of --gradient: sensitivities as bars, the largest first. */
#include "base/file.h"
#include "base/text.h"
#include "emit/emit.h"
#include "run/gradient.h"

#include <math.h>
#include <stdlib.h>

enum { BAR = 400 };

typedef struct Page {
    Pool *pool;
    const Gradient *gradient;
    const char *number; /* what it is of, one line */
} Page;

/* A variable, and what the number changes by with it. */
typedef struct Sensitivity {
    const RunVariable *variable;
    double derivative, change;
} Sensitivity;

static int larger(const void *a, const void *b)
{
    const Sensitivity *x = a, *y = b;
    const double by = fabs(y->change) - fabs(x->change);
    return by > 0 ? 1 : by < 0 ? -1 : x->variable < y->variable ? -1 : 1;
}

static void cell(Text *out, const char *text, bool number)
{
    text_print(out, "<td%s>", number ? " class=\"n\"" : "");
    text_html(out, text);
    text_print(out, "</td>");
}

static void bar(Text *out, double share)
{
    const double half = BAR / 2.0, width = half * fabs(share);
    text_print(out, "<td><svg viewBox=\"0 0 %d 14\" width=\"%d\" height=\"14\">", BAR, BAR);
    text_print(out, "<rect x=\"%.1f\" width=\"%.1f\" height=\"14\" fill=\"%s\"/>", share < 0 ? half - width : half,
               width, share < 0 ? "#c03a1b" : "#1660a8");
    text_print(out, "<path d=\"M%.1f 0v14\" stroke=\"#333\"/></svg></td>", half);
}

static void write_bars(void *context, Text *out, int indent)
{
    const Page *page = context;
    const Gradient *gradient = page->gradient;
    Sensitivity *all = pool_alloc(page->pool, ((size_t)gradient->variables + 1) * sizeof *all);
    (void)indent;
    for (int k = 0; k < gradient->variables; ++k) {
        const RunVariable *v = &gradient->variable[k];
        const double derivative = gradient->derivative[k];
        all[k] = (Sensitivity){v, derivative, derivative * 0.01 * (v->value != 0 ? fabs(v->value) : 1)};
    }
    qsort(all, (size_t)gradient->variables, sizeof *all, larger);
    for (int k = 0; k < gradient->variables; ++k) {
        text_print(out, "<tr>");
        cell(out, all[k].variable->name, false);
        cell(out, pool_print(page->pool, "%.6g", all[k].variable->value), true);
        cell(out, all[k].variable->unit, false);
        cell(out, pool_print(page->pool, "%.6g", all[k].derivative), true);
        cell(out, pool_print(page->pool, "%.4g", all[k].change), true);
        bar(out, all[0].change != 0 ? all[k].change / fabs(all[0].change) : 0);
        text_print(out, "</tr>\n");
    }
}

static void write_number(void *context, Text *out, int indent)
{
    (void)indent;
    text_print(out, "<p>");
    text_html(out, ((const Page *)context)->number);
    text_print(out, "</p>\n");
}

static const Insertion points[] = {{"number", write_number}, {"bars", write_bars}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"gradient.html.in", NULL}, points, NULL};

void gradient_page(Pool *pool, const char *name, const Gradient *gradient, const char *number, const char *path)
{
    Page page = {pool, gradient, number};
    Text out = {.pool = pool};
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &out, NULL, "gradient.html.in", name, NULL, &page_points, &page);
    file_write(path, out.s, out.size);
}
