/* SPDX-License-Identifier: MIT
 * The page of --kc: tables at the position of set-up, curves over travel and steering as SVG. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"
#include "run/panel.h"

#include <math.h>
#include <string.h>

typedef struct Page {
    Pool *pool;
    const KcStudy *study;
} Page;

const char *const kc_motion_title[KC_MOTIONS] = {"Parallel travel", "Opposite travel", "Steering"};

/* ---- what a motion shows -------------------------------------------------------------------------------- */

bool kc_is_drawn(int quantity, KcMotion motion)
{
    switch (quantity) {
    case KC_TRAVEL:
    case KC_CONTACT_X:
    case KC_CONTACT_Y:
    case KC_SIDE_ANGLE: return false;
    case KC_STEER_ANGLE: return motion == KC_STEER;
    case KC_TOE:
    case KC_TOE_RATE: return motion != KC_STEER;
    default: return true;
    }
}

const char *kc_abscissa(Pool *pool, const Kc *kc, const KcAxle *axle, KcMotion motion, double *scale)
{
    const bool steers = motion == KC_STEER;
    const bool turns = steers && kc->model->coordinate[axle->steer].type == COORDINATE_ANGLE;
    *scale = turns ? kc_of_wheel[KC_CAMBER].scale : 1e3;
    return steers ? pool_print(pool, "%s, %s", kc->model->coordinate[axle->steer].name, turns ? "deg" : "mm")
           : motion == KC_OPPOSITE ? "travel of the left, mm"
                                   : "travel, mm";
}

static void motion(Page *page, Text *out, int a, const KcCurve *of)
{
    const Kc *kc = page->study->kc;
    const KcAxle *axle = &kc->axle[a];
    double scale_of_x;
    const char *below = kc_abscissa(page->pool, kc, axle, of->motion, &scale_of_x);
    const size_t n = (size_t)(axle->wheels + 1) * (size_t)of->rows;
    double *x = pool_alloc(page->pool, (size_t)of->rows * sizeof *x), *y = pool_alloc(page->pool, n * sizeof *y);
    Panel panel = {.below = below, .rows = of->rows, .x = x, .y = y};
    for (int r = 0; r < of->rows; ++r)
        x[r] = of->row[r].at * scale_of_x;
    text_print(out, "<h3>%s", kc_motion_title[of->motion]);
    for (int i = 0; i < axle->wheels; ++i) {
        text_print(out, " <span style=\"color:%s\">%s", panel_color(i), i == 1 ? "&#9476;&#9476; " : "&#8212; ");
        text_html(out, axle->wheel[i].name);
        text_print(out, "</span>");
    }
    text_print(out, "</h3>\n<div class=\"curves\">\n");
    for (int q = 0; q < KC_OF_WHEEL; ++q) {
        panel.title = kc_of_wheel[q].title;
        panel.unit = kc_of_wheel[q].shown;
        panel.curves = axle->wheels;
        for (int i = 0; i < axle->wheels; ++i)
            for (int r = 0; r < of->rows; ++r)
                y[i * of->rows + r] = of->row[r].wheel[i][q] * kc_of_wheel[q].scale;
        if (kc_is_drawn(q, of->motion))
            panel_draw(out, &panel);
    }
    for (int e = 0; e < kc->elements; ++e) {
        if (!kc_ratio_seen(kc, axle, &of->row[of->zero], e))
            continue;
        panel.title = pool_print(page->pool, "Motion ratio of %s", kc->element[e].name);
        panel.unit = kc->element[e].angle ? "rad/m" : "1";
        for (int i = 0; i < axle->wheels; ++i)
            for (int r = 0; r < of->rows; ++r)
                y[i * of->rows + r] = of->row[r].ratio[i * kc->elements + e];
        panel_draw(out, &panel);
    }
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        double scale;
        panel.title = kc_of_axle[q].title;
        panel.unit = kc_shown_unit(kc, axle, q, &scale);
        panel.curves = 1;
        for (int r = 0; r < of->rows; ++r)
            y[r] = of->row[r].axle[q] * scale;
        panel_draw(out, &panel);
    }
    text_print(out, "</div>\n");
}

/* ---- the table at the position of set-up ---------------------------------------------------------------- */

static void cell(Text *out, const char *text, bool number)
{
    text_print(out, "<td%s>", number ? " class=\"n\"" : "");
    text_html(out, text);
    text_print(out, "</td>");
}

static void begin(Text *out, const char *name, const char *unit)
{
    text_print(out, "<tr>");
    cell(out, name, false);
    cell(out, unit, false);
}

static void table(Page *page, Text *out, int a)
{
    const Kc *kc = page->study->kc;
    const KcAxle *axle = &kc->axle[a];
    const KcRow *row = kc_zero(page->study, a, -1);
    text_print(out, "<table>\n<caption>As set up</caption>\n<thead><tr><th></th><th></th>");
    for (int i = 0; i < axle->wheels; ++i) {
        text_print(out, "<th class=\"n\">");
        text_html(out, axle->wheel[i].name);
        text_print(out, "</th>");
    }
    text_print(out, "</tr></thead>\n<tbody>\n");
    for (int q = 0; q < KC_OF_WHEEL; ++q) {
        if (isnan(row->wheel[0][q]) || q == KC_TRAVEL)
            continue;
        begin(out, kc_of_wheel[q].title, kc_of_wheel[q].shown);
        for (int i = 0; i < axle->wheels; ++i)
            cell(out, kc_shown(page->pool, row->wheel[i][q], kc_of_wheel[q].scale), true);
        text_print(out, "</tr>\n");
    }
    for (int e = 0; e < kc->elements; ++e)
        if (kc_ratio_seen(kc, axle, row, e)) {
            begin(out, pool_print(page->pool, "Motion ratio of %s", kc->element[e].name),
                  kc->element[e].angle ? "rad/m" : "1");
            for (int i = 0; i < axle->wheels; ++i)
                cell(out, kc_shown(page->pool, row->ratio[i * kc->elements + e], 1), true);
            text_print(out, "</tr>\n");
        }
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        double scale;
        const char *unit = kc_shown_unit(kc, axle, q, &scale);
        const double value = kc_zero(page->study, a, q)->axle[q];
        if (isnan(value))
            continue;
        begin(out, kc_of_axle[q].title, unit);
        text_print(out, "<td class=\"n\" colspan=\"%d\">%s</td></tr>\n", axle->wheels,
                   kc_shown(page->pool, value, scale));
    }
    text_print(out, "</tbody>\n</table>\n");
}

/* ---- the page ------------------------------------------------------------------------------------------- */

static void stop(Text *out, const char *who, const char *text)
{
    if (!text)
        return;
    text_print(out, "<p class=\"stop\">");
    text_html(out, who ? pool_print(out->pool, "%s: %s", who, text) : text);
    text_print(out, "</p>\n");
}

static void axle_stops(Text *out, const KcStudy *study, int a, const char *who)
{
    for (KcMotion m = 0; m < KC_MOTIONS; ++m)
        for (int end = 0; end < 2; ++end)
            stop(out, who, kc_stop(out->pool, study, a, m, end));
}

void kc_stops_html(Text *out, const KcStudy *study, const char *who)
{
    stop(out, who, study->kc->units);
    for (int a = 0; a < study->kc->axles; ++a)
        axle_stops(out, study, a, who);
}

static const Insertion none[] = {{NULL, NULL}};
static const Insertions figure_points = {(const char *const[]){"kc_figures.html.in", NULL}, none, NULL};

/* A figure for each column of the files, drawn by tests/tools/kc_figures.py. */
static void write_figures(Pool *pool, Text *out, const char *name)
{
    templates_check(pool, NULL, (const Insertions *const[]){&figure_points, NULL});
    template_expand(pool, out, NULL, "kc_figures.html.in", name, NULL, &figure_points, NULL);
}

static void write_axles(void *context, Text *out, int indent)
{
    Page *page = context;
    (void)indent;
    stop(out, NULL, page->study->kc->units);
    for (int a = 0; a < page->study->kc->axles; ++a) {
        const KcAxle *axle = &page->study->kc->axle[a];
        text_print(out, "<h2>%s</h2>\n",
                   strcmp(axle->name, "axle") ? pool_print(page->pool, "Axle: %s", axle->name) : "Axle");
        axle_stops(out, page->study, a, NULL);
        if (kc_first(page->study, a))
            table(page, out, a);
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            if (page->study->curve[a][m])
                motion(page, out, a, page->study->curve[a][m]);
    }
    write_figures(page->pool, out, page->study->kc->model->name);
}

static void write_identity(void *context, Text *out, int indent)
{
    const Page *page = context;
    const Model *model = page->study->kc->model;
    (void)indent;
    text_print(out, "<p>");
    text_html(out, model->description ? model->description : model->name);
    text_print(out, ". gicgen " GICGEN_VERSION ".</p>\n");
}

static const Insertion points[] = {{"identity", write_identity}, {"axles", write_axles}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"kc.html.in", NULL}, points, NULL};
void kc_page(Pool *pool, const KcStudy *study, const char *path)
{
    Page page = {pool, study};
    Text out = {.pool = pool};
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &out, NULL, "kc.html.in", study->kc->model->name, NULL, &page_points, &page);
    file_write(path, out.s, out.size);
}
