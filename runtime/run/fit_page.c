/* SPDX-License-Identifier: MIT
 * The page of --identify and --optimize: curves over time, and the numbers. */
#include "run/fit_page.h"
#include "base/file.h"
#include "base/text.h"
#include "emit/emit.h"

static void cell(Text *out, const char *tag, const char *text, bool number)
{
    text_print(out, "<%s%s>", tag, number ? " class=\"n\"" : "");
    text_html(out, text);
    text_print(out, "</%s>", tag);
}

static void write_number(void *context, Text *out, int indent)
{
    (void)indent;
    text_print(out, "<p>");
    text_html(out, ((const FitPage *)context)->number);
    text_print(out, "</p>\n");
}

static void write_curves(void *context, Text *out, int indent)
{
    const FitPage *page = context;
    (void)indent;
    text_print(out, "<p><span style=\"color:%s\">&#8212; %s</span> <span style=\"color:%s\">- - %s</span></p>\n",
               panel_color(0), page->curve[0], panel_color(1), page->curve[1]);
    text_print(out, "<div class=\"curves\">\n");
    for (int i = 0; i < page->panels; ++i)
        panel_draw(out, &page->panel[i]);
    text_print(out, "</div>\n");
}

static void write_rows(void *context, Text *out, int indent)
{
    const FitPage *page = context;
    int columns = 0;
    (void)indent;
    text_print(out, "<tr>");
    cell(out, "th", "variable", false);
    for (; columns < FIT_COLUMNS && page->column[columns]; ++columns)
        cell(out, "th", page->column[columns], true);
    cell(out, "th", "unit", false);
    text_print(out, "</tr>\n");
    for (int k = 0; k < page->variables; ++k) {
        text_print(out, "<tr>");
        cell(out, "td", page->variable[k].name, false);
        for (int c = 0; c < columns; ++c)
            cell(out, "td", pool_print(out->pool, "%.6g", page->cell[k * columns + c]), true);
        cell(out, "td", page->variable[k].unit, false);
        text_print(out, "</tr>\n");
    }
}

static const Insertion points[] = {
    {"number", write_number}, {"curves", write_curves}, {"rows", write_rows}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"fit.html.in", NULL}, points, NULL};

void fit_page_write(Pool *pool, const FitPage *page, const char *path)
{
    Text out = {.pool = pool};
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &out, NULL, "fit.html.in", page->name, NULL, &page_points, (void *)(uintptr_t)page);
    file_write(path, out.s, out.size);
}
