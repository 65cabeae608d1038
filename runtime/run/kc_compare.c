/* SPDX-License-Identifier: MIT
 * --kc --compare: what --kc prints at the position of set-up, and draws over travel and steering, of two vehicles side
 * by side. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"
#include "run/panel.h"
#include "run/sheet.h"

#include <math.h>
#include <string.h>

static void add_axle(Sheet *sheet, const KcStudy *study, int a)
{
    const Kc *kc = study->kc;
    const KcAxle *axle = &kc->axle[a];
    const KcRow *row = kc_zero(study, a, -1);
    const char *section = pool_print(sheet->pool, "Axle: %s", axle->name);
    for (int q = 0; q < KC_OF_WHEEL; ++q)
        for (int i = 0; i < axle->wheels && q != KC_TRAVEL; ++i)
            if (!isnan(row->wheel[i][q])) {
                sheet_add(sheet, section, pool_print(sheet->pool, "%s.%s", axle->wheel[i].name, kc_of_wheel[q].name),
                          pool_print(sheet->pool, "%s, %s", kc_of_wheel[q].title, axle->wheel[i].name),
                          kc_of_wheel[q].unit, row->wheel[i][q]);
                sheet_place(sheet, axle, i, 0, kc_of_wheel[q].name);
                section = NULL;
            }
    for (int e = 0; e < kc->elements; ++e)
        for (int i = 0; i < axle->wheels && kc_ratio_seen(kc, axle, row, e); ++i) {
            sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.ratio.%s", axle->wheel[i].name, kc->element[e].name),
                      pool_print(sheet->pool, "Motion ratio of %s, %s", kc->element[e].name, axle->wheel[i].name),
                      kc->element[e].angle ? "rad/m" : "1", row->ratio[i * kc->elements + e]);
            sheet_place(sheet, axle, i, 0, pool_print(sheet->pool, "ratio.%s", kc->element[e].name));
        }
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        const double value = kc_zero(study, a, q)->axle[q];
        if (!isnan(value))
            sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.%s", axle->name, kc_of_axle[q].name),
                      kc_of_axle[q].title, kc_unit(kc, axle, q), value);
    }
}

Sheet kc_sheet(Pool *pool, const Model *model, const KcStudy *study)
{
    Sheet sheet = {.pool = pool, .model = model};
    for (int a = 0; a < study->kc->axles; ++a)
        if (kc_first(study, a))
            add_axle(&sheet, study, a);
    return sheet;
}

/* ---- curves of both --------------------------------------------------------------------------------------------- */

typedef struct Both {
    const KcStudy *study[2];
    const char *name[2];
    const Sheet *sheet;
} Both;

/* What a diagram is of: a quantity of wheels (q below KC_OF_WHEEL), or of axles (q from there on). */
typedef struct Line {
    const char *title, *unit;
    double scale;
} Line;

/* The first left wheel, whose curves stand for both. */
static int left_of(const KcAxle *axle)
{
    for (int i = 0; i < axle->wheels; ++i)
        if (axle->wheel[i].side > 0)
            return i;
    return 0;
}

static double value_at(const KcRow *row, int wheel, int q)
{
    return q < KC_OF_WHEEL ? row->wheel[wheel][q] : row->axle[q - KC_OF_WHEEL];
}

static Line line_of(const Kc *kc, const KcAxle *axle, int q)
{
    Line line = {kc_of_wheel[q % KC_OF_WHEEL].title, kc_of_wheel[q % KC_OF_WHEEL].shown,
                 kc_of_wheel[q % KC_OF_WHEEL].scale};
    if (q >= KC_OF_WHEEL) {
        line.title = kc_of_axle[q - KC_OF_WHEEL].title;
        line.unit = kc_shown_unit(kc, axle, q - KC_OF_WHEEL, &line.scale);
    }
    return line;
}

/* Both curves in one diagram, each with its own abscissae. axle: its number in each, -1: it has none. */
static void draw(Text *out, const Both *both, const int axle[2], KcMotion motion, int q)
{
    const KcCurve *of[2] = {NULL, NULL};
    Panel panel = {.curves = 2};
    Line line = {NULL, NULL, 1};
    for (int k = 0; k < 2; ++k)
        if (axle[k] >= 0)
            of[k] = both->study[k]->curve[axle[k]][motion];
    const int rows[2] = {of[0] ? of[0]->rows : 0, of[1] ? of[1]->rows : 0};
    panel.rows = rows[0] + rows[1];
    double *x = pool_alloc(out->pool, ((size_t)panel.rows + 1) * sizeof *x);
    panel.y = pool_alloc(out->pool, (2 * (size_t)panel.rows + 1) * sizeof *panel.y);
    panel.x = x;
    for (int k = 0, at = 0; k < 2; ++k) {
        const Kc *kc = both->study[k]->kc;
        double by = 1;
        if (of[k]) {
            const Line own = line_of(kc, &kc->axle[axle[k]], q);
            const char *below = kc_abscissa(out->pool, kc, &kc->axle[axle[k]], motion, &by);
            if (line.unit && strcmp(line.unit, own.unit) != 0)
                return;
            line = own;
            panel.below = panel.below && strcmp(panel.below, below) != 0
                              ? pool_print(out->pool, "%s; %s", panel.below, below)
                              : below;
        }
        for (int r = 0; r < rows[k]; ++r, ++at) {
            x[at] = of[k]->row[r].at * by;
            panel.y[k * panel.rows + at] = value_at(&of[k]->row[r], left_of(&kc->axle[axle[k]]), q) * line.scale;
            panel.y[(1 - k) * panel.rows + at] = NAN;
        }
    }
    panel.title = line.title;
    panel.unit = line.unit;
    panel_draw(out, &panel);
}

/* The axle of the same name. */
static int axle_of(const KcStudy *study, const char *name)
{
    for (int a = 0; a < study->kc->axles; ++a)
        if (!strcmp(study->kc->axle[a].name, name))
            return a;
    return -1;
}

static void curves(Text *out, const Both *both, const char *name)
{
    const int axle[2] = {axle_of(both->study[0], name), axle_of(both->study[1], name)};
    for (KcMotion m = 0; m < KC_MOTIONS; ++m) {
        bool any = false;
        for (int k = 0; k < 2; ++k)
            any = any || (axle[k] >= 0 && both->study[k]->curve[axle[k]][m]);
        if (!any)
            continue;
        text_print(out, "<h3>%s: %s, left wheels", name, kc_motion_title[m]);
        for (int k = 0; k < 2; ++k) {
            text_print(out, " <span style=\"color:%s\">%s", panel_color(k), k ? "&#9476;&#9476; " : "&#8212; ");
            text_html(out, both->name[k]);
            text_print(out, "</span>");
        }
        text_print(out, "</h3>\n<div class=\"curves\">\n");
        for (int q = 0; q < KC_OF_WHEEL + KC_OF_AXLE; ++q)
            if (q >= KC_OF_WHEEL || kc_is_drawn(q, m))
                draw(out, both, axle, m, q);
        text_print(out, "</div>\n");
    }
}

static void write_both(void *context, Text *out, int indent)
{
    const Both *both = context;
    (void)indent;
    for (int k = 0; k < 2; ++k)
        kc_stops_html(out, both->study[k], both->name[k]);
    sheet_tables(both->sheet, out);
    for (int k = 0; k < 2; ++k)
        for (int a = 0; a < both->study[k]->kc->axles; ++a) {
            const char *name = both->study[k]->kc->axle[a].name;
            if (!k || axle_of(both->study[0], name) < 0)
                curves(out, both, name);
        }
}

static void write_identity(void *context, Text *out, int indent)
{
    const Both *both = context;
    (void)indent;
    text_print(out, "<p>");
    text_html(out, both->name[0]);
    text_print(out, " and ");
    text_html(out, both->name[1]);
    text_print(out, ". What differs is marked. gicgen " GICGEN_VERSION ".</p>\n");
}

static const Insertion points[] = {{"identity", write_identity}, {"axles", write_both}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"kc.html.in", NULL}, points, NULL};

static void write_page(Pool *pool, Both *both, const char *path)
{
    Text out = {.pool = pool};
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &out, NULL, "kc.html.in", both->name[0], NULL, &page_points, both);
    file_write(path, out.s, out.size);
}

void kc_compare(Pool *pool, const Model *model, const KcStudy *study, const KcStudy *of_other, const char *name,
                const Request *request)
{
    Sheet sheet = kc_sheet(pool, model, study);
    const Sheet other = kc_sheet(pool, of_other->kc->model, of_other);
    sheet_compare(&sheet, &other, name);
    Both both = {{study, of_other}, {model->name, name}, &sheet};
    if (request->results)
        sheet_csv(&sheet, request->results);
    if (request->report)
        write_page(pool, &both, request->report);
    if (!request->results && !request->report)
        sheet_print(&sheet, ", models/KC.md defines these");
}
