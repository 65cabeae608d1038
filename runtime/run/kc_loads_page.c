/* SPDX-License-Identifier: MIT
 * The page of --kc --loads: what a wheel does for each load, as numbers and bars. Quantities are side by side and loads
 * below each other, so that what stands out in a column is seen. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"
#include "run/panel.h"
#include "run/sheet.h"

#include <math.h>
#include <string.h>

typedef struct Page {
    const Sheet *sheet;
    const Kc *const *kc;
} Page;

enum { BAR = 90, THICK = 6, QUANTITIES = 5 };

/* As rows of kc_loads_sheet() end. */
static const struct {
    const char *name, *title;
} of_column[QUANTITIES] = {{"toe", "toe, deg"},
                           {"camber", "camber, deg"},
                           {"contact_x", "contact x, mm"},
                           {"contact_y", "contact y, mm"},
                           {"contact_z", "contact z, mm"}};

static int column_of(const SheetRow *row)
{
    const char *end = strrchr(row->name, '.');
    for (int c = 0; end && c < QUANTITIES; ++c)
        if (!strcmp(end + 1, of_column[c].name))
            return c;
    return -1;
}

/* To what is shown: for 1 kN, and for 100 N m. */
static double scale_of(const SheetRow *row)
{
    return row->scale * (strstr(row->unit, "N m") ? 0.1 : 1);
}

/* True: both are of one load and one wheel. */
static bool is_of_line(const SheetRow *a, const SheetRow *b)
{
    const size_t size = (size_t)(strrchr(a->name, '.') - a->name);
    return size == (size_t)(strrchr(b->name, '.') - b->name) && !strncmp(a->name, b->name, size);
}

static void bars(Text *out, const double value[2], int count, double most)
{
    const double half = BAR / 2.0;
    text_print(out, "<td><svg style=\"width:%dpx;height:%dpx\" viewBox=\"0 0 %d %d\">", BAR, (THICK + 1) * count, BAR,
               (THICK + 1) * count);
    for (int k = 0; k < count; ++k) {
        const double share = most > 0 && isfinite(value[k]) ? value[k] / most : 0, width = half * fabs(share);
        text_print(out, "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>",
                   share < 0 ? half - width : half, k * (THICK + 1), width, THICK, panel_color(k));
    }
    text_print(out, "<path d=\"M%.1f 0V%d\" stroke=\"#333\"/></svg></td>", half, (THICK + 1) * count);
}

/* "lateral, opposed" of "lateral, opposed: toe, front_left", and the wheel's name. */
static void write_labels(Text *out, const SheetRow *row)
{
    const char *colon = strchr(row->title, ':'), *comma = strrchr(row->title, ',');
    text_print(out, "<td>");
    text_html(out, pool_print(out->pool, "%.*s", (int)(colon - row->title), row->title));
    text_print(out, "</td><td>");
    text_html(out, comma + 2);
    text_print(out, "</td>");
}

/* The rows of a load and a wheel, from row i on, as one line. Returns the first row of the next line. */
static int write_line(const Sheet *sheet, Text *out, int i, const double *most)
{
    const int first = i, vehicles = sheet->other ? 2 : 1;
    const SheetRow *of[QUANTITIES] = {NULL};
    bool differs = false;
    for (; i < sheet->rows && is_of_line(&sheet->row[first], &sheet->row[i]); ++i) {
        of[column_of(&sheet->row[i])] = &sheet->row[i];
        differs = differs || (vehicles > 1 && sheet_differs(&sheet->row[i]));
    }
    text_print(out, differs ? "<tr class=\"differs\">" : "<tr>");
    write_labels(out, &sheet->row[first]);
    for (int c = 0; c < QUANTITIES; ++c) {
        double value[2] = {NAN, NAN};
        if (of[c]) {
            value[0] = of[c]->value * scale_of(of[c]);
            value[1] = of[c]->other * scale_of(of[c]);
        }
        text_print(out, "<td class=\"n\">");
        for (int k = 0; k < vehicles; ++k)
            text_print(out, "%s%s", k ? "<br>" : "", kc_shown(sheet->pool, value[k], 1));
        text_print(out, "</td>");
        bars(out, value, vehicles, most[c]);
    }
    text_print(out, "</tr>\n");
    return i;
}

static void open_table(Text *out, const char *section)
{
    text_print(out, "<table>\n<caption>");
    text_html(out, section);
    text_print(out, "</caption>\n<thead><tr><th>load</th><th>wheel</th>");
    for (int c = 0; c < QUANTITIES; ++c)
        text_print(out, "<th class=\"n\" colspan=\"2\">%s</th>", of_column[c].title);
    text_print(out, "</tr></thead>\n");
}

static void write_tables(void *context, Text *out, int indent)
{
    const Page *page = context;
    const Sheet *sheet = page->sheet;
    double most[QUANTITIES] = {0};
    bool open = false;
    (void)indent;
    for (int k = 0; k < 2 && page->kc[k]; ++k)
        for (int a = 0; a < page->kc[k]->axles; ++a) {
            KcGive give[KC_WHEELS];
            const char *why = kc_compliance(page->kc[k], &page->kc[k]->axle[a], KC_LATERAL, false, give);
            if (!why)
                continue;
            text_print(out, "<p class=\"stop\">");
            text_html(out, pool_print(out->pool, "%s, %s: no compliance: %s", page->kc[k]->model->name,
                                      page->kc[k]->axle[a].name, why));
            text_print(out, "</p>\n");
        }
    for (int i = 0; i < sheet->rows; ++i) {
        const double scale = scale_of(&sheet->row[i]), *value[2] = {&sheet->row[i].value, &sheet->row[i].other};
        double *of = &most[column_of(&sheet->row[i])];
        for (int k = 0; k < 2; ++k)
            *of = isfinite(*value[k]) ? fmax(*of, fabs(*value[k] * scale)) : *of;
    }
    for (int i = 0; i < sheet->rows;) {
        if (sheet->row[i].section) {
            text_print(out, "%s", open ? "</table>\n" : "");
            open_table(out, sheet->row[i].section);
            open = true;
        }
        i = write_line(sheet, out, i, most);
    }
    text_print(out, "%s", open ? "</table>\n" : "");
}

static void write_identity(void *context, Text *out, int indent)
{
    const Sheet *sheet = ((const Page *)context)->sheet;
    (void)indent;
    text_print(out, "<p>");
    if (sheet->other) {
        text_print(out, "<span style=\"color:%s\">&#9632; ", panel_color(0));
        text_html(out, sheet->model->name);
        text_print(out, "</span> and <span style=\"color:%s\">&#9632; ", panel_color(1));
        text_html(out, sheet->other);
        text_print(out, "</span>; what differs is marked");
    } else
        text_html(out, sheet->model->description ? sheet->model->description : sheet->model->name);
    text_print(out, ". gicgen " GICGEN_VERSION ".</p>\n");
}

static const Insertion points[] = {{"identity", write_identity}, {"tables", write_tables}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"kc_loads.html.in", NULL}, points, NULL};

void kc_loads_page(const Sheet *sheet, const Kc *const kc[2], const char *path)
{
    const Page page = {sheet, kc};
    Text out = {.pool = sheet->pool};
    templates_check(sheet->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(sheet->pool, &out, NULL, "kc_loads.html.in", sheet->model->name, NULL, &page_points, (void *)&page);
    file_write(path, out.s, out.size);
}
