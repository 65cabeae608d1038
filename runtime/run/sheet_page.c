/* SPDX-License-Identifier: MIT
 * The page of --sheet: tables, and a bar a mode that shows what moves in it. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/sheet.h"

#include <math.h>
#include <string.h>

static const char *const color[] = {"#1660a8", "#c03a1b", "#2a8a3c", "#8a5a00", "#7a3a9a", "#0a8a8a"};
enum { COLORS = sizeof color / sizeof *color, BAR = 420 };

static void cell(Text *out, const char *text, bool number)
{
    text_print(out, "<td%s>", number ? " class=\"n\"" : "");
    text_html(out, text);
    text_print(out, "</td>");
}

/* All sections but that of the modes, which have a table of their own. */
void sheet_tables(const Sheet *sheet, Text *out)
{
    bool open = false;
    for (int i = 0; i < sheet->rows; ++i) {
        const SheetRow *row = &sheet->row[i];
        if (!strncmp(row->name, "mode_", 5))
            continue;
        if (row->section) {
            text_print(out, "%s<table>\n<caption>", open ? "</table>\n" : "");
            text_html(out, row->section);
            text_print(out, "</caption>\n");
            if (sheet->other) {
                text_print(out, "<tr><th></th><th class=\"n\">");
                text_html(out, sheet->model->name);
                text_print(out, "</th><th class=\"n\">");
                text_html(out, sheet->other);
                text_print(out, "</th><th></th></tr>\n");
            }
            open = true;
        }
        text_print(out, sheet->other && sheet_differs(row) ? "<tr class=\"differs\">" : "<tr>");
        cell(out, row->title, false);
        cell(out, kc_shown(sheet->pool, row->value, row->scale), true);
        if (sheet->other)
            cell(out, kc_shown(sheet->pool, row->other, row->scale), true);
        cell(out, row->shown, false);
        text_print(out, "</tr>\n");
    }
    text_print(out, "%s", open ? "</table>\n" : "");
}

static void write_tables(void *context, Text *out, int indent)
{
    (void)indent;
    sheet_tables(context, out);
}

/* The name of number i of a mode's shares: a place, or a fast state. */
static const char *share_name(const Linear *linear, int i)
{
    return linear->name[i < linear->places ? i : i + linear->places];
}

/* Shares above 4 %, largest first, side by side. */
static void bar(Text *out, const Linear *linear, const Mode *mode)
{
    const int count = linear->count - linear->places;
    double before = INFINITY, x = 0;
    int last = -1;
    text_print(out, "<svg viewBox=\"0 0 %d 20\" width=\"%d\" height=\"20\">", BAR, BAR);
    for (int n = 0; n < COLORS; ++n) {
        int most = -1;
        for (int i = 0; i < count; ++i) {
            const bool comes = mode->share[i] < before || (mode->share[i] == before && i > last);
            if (comes && (most < 0 || mode->share[i] > mode->share[most]))
                most = i;
        }
        if (most < 0 || mode->share[most] < 0.04)
            break;
        before = mode->share[most];
        last = most;
        const double width = before * BAR;
        text_print(out, "<rect x=\"%.1f\" width=\"%.1f\" height=\"20\" fill=\"%s\"><title>", x, width, color[n]);
        text_html(out, share_name(linear, most));
        text_print(out, " %.0f %%</title></rect>", 100 * before);
        if (width > 7.0 * (double)strlen(share_name(linear, most))) {
            text_print(out, "<text x=\"%.1f\" y=\"14\" fill=\"#fff\" font-size=\"12\">", x + 3);
            text_html(out, share_name(linear, most));
            text_print(out, "</text>");
        }
        x += width;
    }
    text_print(out, "</svg>");
}

static void write_modes(void *context, Text *out, int indent)
{
    const Sheet *sheet = context;
    (void)indent;
    for (int k = 0; sheet->modes && k < sheet->modes->count; ++k) {
        const Mode *mode = &sheet->modes->mode[k];
        const double size = hypot(mode->real, mode->imaginary);
        text_print(out, "<tr>");
        if (mode->imaginary > 0)
            cell(out, pool_print(sheet->pool, "%.4f \u00b1 %.4fi", mode->real, mode->imaginary), true);
        else
            cell(out, pool_print(sheet->pool, "%.4f", mode->real), true);
        cell(out, mode->imaginary > 0 ? pool_print(sheet->pool, "%.3f", size / (2 * 3.141592653589793)) : "", true);
        cell(out, mode->imaginary > 0 ? pool_print(sheet->pool, "%.3f", -mode->real / size + 0.0) : "", true);
        text_print(out, "<td>");
        bar(out, sheet->found->linear, mode);
        text_print(out, "</td><td>");
        if (mode->imaginary > 0)
            sheet_shape(sheet, mode, out);
        text_print(out, "</td></tr>\n");
    }
    if (sheet->modes && sheet->modes->zeros)
        text_print(out, "<tr><td class=\"n\">0</td><td colspan=\"4\">%d times: nothing holds %s</td></tr>\n",
                   sheet->modes->zeros, sheet->modes->neutral ? sheet->modes->neutral : "something");
}

static void write_motion(void *context, Text *out, int indent)
{
    const Sheet *sheet = context;
    (void)indent;
    text_print(out, "<h2>Small motions at %g m/s</h2>\n", sheet->speed);
}

static void write_notes(void *context, Text *out, int indent)
{
    const Sheet *sheet = context;
    (void)indent;
    for (int i = 0; i < sheet->notes; ++i) {
        text_print(out, "<p>");
        text_html(out, sheet->note[i]);
        text_print(out, ".</p>\n");
    }
}

static void write_identity(void *context, Text *out, int indent)
{
    const Model *model = ((const Sheet *)context)->model;
    (void)indent;
    text_print(out, "<p>");
    text_html(out, model->description ? model->description : model->name);
    text_print(out, ". gicgen " GICGEN_VERSION "; models/SHEET.md defines the numbers.</p>\n");
}

static const Insertion points[] = {{"identity", write_identity}, {"tables", write_tables}, {"motion", write_motion},
                                   {"modes", write_modes},       {"notes", write_notes},   {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"sheet.html.in", NULL}, points, NULL};

void sheet_page(const Sheet *sheet, const char *path)
{
    Text out = {.pool = sheet->pool};
    templates_check(sheet->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(sheet->pool, &out, NULL, "sheet.html.in", sheet->model->name, NULL, &page_points, (void *)sheet);
    file_write(path, out.s, out.size);
}
