/* SPDX-License-Identifier: MIT
 * The page of --kc: tables at the position of set-up, curves over travel and steering as SVG. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"

#include <math.h>
#include <string.h>

typedef struct Page {
    Pool *pool;
    const KcStudy *study;
} Page;

static const char *const color[] = {"#1660a8", "#c03a1b", "#2a8a3c", "#8a5a00",
                                    "#7a3a9a", "#0a8a8a", "#555",    "#c03a8a"};
enum { COLORS = sizeof color / sizeof *color };

static const char *const title_of[KC_MOTIONS] = {"Parallel travel", "Opposite travel", "Steering"};

/* ---- one panel ------------------------------------------------------------------------------------------ */

/* Curves over one abscissa, in the units that are shown. */
typedef struct Panel {
    const char *title, *unit, *below;
    int rows, curves;
    const double *x;
    double *y; /* [curves][rows]; what is not finite is left out */
} Panel;

enum { WIDTH = 280, HEIGHT = 170, LEFT = 48, RIGHT = 8, TOP = 8, BOTTOM = 32 };

/* The step of ticks: 1, 2 or 5 times a power of ten, at most `most` steps. */
static double tick_step(double range, int most)
{
    const double raw = range / most, power = pow(10, floor(log10(raw)));
    const double share = raw / power;
    return power * (share <= 1 + 1e-9 ? 1 : share <= 2 + 1e-9 ? 2 : share <= 5 + 1e-9 ? 5 : 10);
}

/* Range of what is finite, never empty. */
static void range_of(const double *value, int count, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int i = 0; i < count; ++i)
        if (isfinite(value[i])) {
            range[0] = fmin(range[0], value[i]);
            range[1] = fmax(range[1], value[i]);
        }
    const double middle = (range[0] + range[1]) / 2, least = fmax(1e-6 * fabs(middle), 1e-6);
    if (range[1] - range[0] < 2 * least) {
        range[0] = middle - least;
        range[1] = middle + least;
    }
}

static void ticks(Text *out, const double range[2], bool upright)
{
    const double step = tick_step(range[1] - range[0], upright ? 5 : 6),
                 size = upright ? HEIGHT - TOP - BOTTOM : WIDTH - LEFT - RIGHT;
    for (double k = ceil(range[0] / step - 1e-9); k * step <= range[1] + 1e-9 * step; ++k) {
        const double share = (k * step - range[0]) / (range[1] - range[0]);
        const char *class = k == 0 ? "zero" : "grid";
        if (upright)
            text_print(
                out, "<path class=\"%s\" d=\"M%d %.1fH%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n",
                class, LEFT, TOP + size * (1 - share), WIDTH - RIGHT, LEFT - 4, TOP + size * (1 - share) + 3, k * step);
        else
            text_print(
                out,
                "<path class=\"%s\" d=\"M%.1f %dV%d\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                class, LEFT + size * share, TOP, HEIGHT - BOTTOM, LEFT + size * share, HEIGHT - BOTTOM + 12, k * step);
    }
}

/* A curve, in pieces where values are missing. */
static void curve(Text *out, const Panel *panel, int c, const double x[2], const double y[2])
{
    bool open = false;
    for (int i = 0; i < panel->rows; ++i) {
        const double value = panel->y[c * panel->rows + i];
        if (!isfinite(value)) {
            text_print(out, "%s", open ? "\"/>\n" : "");
            open = false;
            continue;
        }
        text_print(out, "%s", open ? " " : "");
        if (!open)
            text_print(out, "<polyline stroke=\"%s\"%s points=\"", color[c % COLORS],
                       c == 1 ? " stroke-dasharray=\"6 3\"" : "");
        open = true;
        text_print(out, "%.1f,%.1f", LEFT + (WIDTH - LEFT - RIGHT) * (panel->x[i] - x[0]) / (x[1] - x[0]),
                   TOP + (HEIGHT - TOP - BOTTOM) * (y[1] - value) / (y[1] - y[0]));
    }
    text_print(out, "%s", open ? "\"/>\n" : "");
}

static void draw(Text *out, const Panel *panel)
{
    double x[2], y[2];
    bool any = false;
    for (int i = 0; i < panel->rows * panel->curves; ++i)
        any = any || isfinite(panel->y[i]);
    if (!any)
        return;
    range_of(panel->x, panel->rows, x);
    range_of(panel->y, panel->rows * panel->curves, y);
    text_print(out, "<figure><figcaption>%s, %s", panel->title, panel->unit);
    text_print(out, "</figcaption>\n<svg viewBox=\"0 0 %d %d\" role=\"img\">\n", WIDTH, HEIGHT);
    ticks(out, x, false);
    ticks(out, y, true);
    for (int c = 0; c < panel->curves; ++c)
        curve(out, panel, c, x, y);
    text_print(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6);
    text_html(out, panel->below);
    text_print(out, "</text></svg></figure>\n");
}

/* ---- what a motion shows -------------------------------------------------------------------------------- */

/* Left out: what is the abscissa, what another curve shows as well, and places, of which there are changes. */
static bool is_drawn(int quantity, KcMotion motion)
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

static void motion(Page *page, Text *out, int a, const KcCurve *of)
{
    const Kc *kc = page->study->kc;
    const KcAxle *axle = &kc->axle[a];
    const bool steers = of->motion == KC_STEER;
    const bool turns = steers && kc->model->coordinate[axle->steer].type == COORDINATE_ANGLE;
    const size_t n = (size_t)(axle->wheels + 1) * (size_t)of->rows;
    double *x = pool_alloc(page->pool, (size_t)of->rows * sizeof *x), *y = pool_alloc(page->pool, n * sizeof *y);
    Panel panel = {.rows = of->rows, .x = x, .y = y};
    for (int r = 0; r < of->rows; ++r)
        x[r] = of->row[r].at * (turns ? kc_of_wheel[KC_CAMBER].scale : 1e3);
    panel.below = steers
                      ? pool_print(page->pool, "%s, %s", kc->model->coordinate[axle->steer].name, turns ? "deg" : "mm")
                  : of->motion == KC_OPPOSITE ? "travel of the left, mm"
                                              : "travel, mm";
    text_print(out, "<h3>%s", title_of[of->motion]);
    for (int i = 0; i < axle->wheels; ++i) {
        text_print(out, " <span style=\"color:%s\">%s", color[i % COLORS], i == 1 ? "&#9476;&#9476; " : "&#8212; ");
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
        if (is_drawn(q, of->motion))
            draw(out, &panel);
    }
    for (int e = 0; e < kc->elements; ++e) {
        if (!kc_ratio_seen(kc, axle, &of->row[of->zero], e))
            continue;
        panel.title = pool_print(page->pool, "Motion ratio of %s", kc->element[e].name);
        panel.unit = kc->element[e].angle ? "rad/m" : "1";
        for (int i = 0; i < axle->wheels; ++i)
            for (int r = 0; r < of->rows; ++r)
                y[i * of->rows + r] = of->row[r].ratio[i * kc->elements + e];
        draw(out, &panel);
    }
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        double scale;
        panel.title = kc_of_axle[q].title;
        panel.unit = kc_shown_unit(kc, axle, q, &scale);
        panel.curves = 1;
        for (int r = 0; r < of->rows; ++r)
            y[r] = of->row[r].axle[q] * scale;
        draw(out, &panel);
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

static void write_axles(void *context, Text *out, int indent)
{
    Page *page = context;
    (void)indent;
    for (int a = 0; a < page->study->kc->axles; ++a) {
        const KcAxle *axle = &page->study->kc->axle[a];
        text_print(out, "<h2>%s</h2>\n",
                   strcmp(axle->name, "axle") ? pool_print(page->pool, "Axle: %s", axle->name) : "Axle");
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            for (int end = 0; end < 2; ++end) {
                const char *text = kc_stop(page->pool, page->study, a, m, end);
                if (!text)
                    continue;
                text_print(out, "<p class=\"stop\">");
                text_html(out, text);
                text_print(out, "</p>\n");
            }
        if (kc_first(page->study, a))
            table(page, out, a);
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            if (page->study->curve[a][m])
                motion(page, out, a, page->study->curve[a][m]);
    }
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
