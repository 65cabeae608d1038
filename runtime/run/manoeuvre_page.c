/* SPDX-License-Identifier: MIT
 * The page of --manoeuvre: tables, diagrams of all trials, and the scenes that were driven. */
#include "base/file.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/manoeuvre.h"
#include "run/panel.h"

#include <math.h>
#include <string.h>

enum { MOST_ROWS = 600 /* of a curve; more are below a pixel */, DRAWN = 8 /* trials in a diagram */ };

typedef struct Page {
    const Manoeuvre *manoeuvre;
    const ManoeuvreKind *kind;
} Page;

const char *manoeuvre_shown(Channel channel, double *scale)
{
    const char *unit = trial_signal[channel].unit;
    const bool angle = !strncmp(unit, "rad", 3);
    *scale = angle ? 57.29577951308232 : 1;
    return angle ? (unit[3] ? "deg/s" : "deg") : unit;
}

/* A diagram of the first trials, each with its own rows: those of others are left out. */
static void curve(const Manoeuvre *m, Text *out, const ManoeuvreCurve *of)
{
    const int trials = m->trials < DRAWN ? m->trials : DRAWN;
    double scale[2];
    int rows = 0;
    const char *unit = manoeuvre_shown(of->y, &scale[1]), *below = manoeuvre_shown(of->x, &scale[0]);
    for (int t = 0; t < trials; ++t)
        rows += m->trial[t]->rows;
    const int every = rows / (MOST_ROWS * trials) + 1;
    double *x = pool_alloc(m->pool, (size_t)rows * sizeof *x);
    double *y = pool_alloc(m->pool, (size_t)(rows * trials) * sizeof *y);
    Panel panel = {.title = trial_signal[of->y].name,
                   .unit = unit,
                   .below = pool_print(m->pool, "%s, %s", trial_signal[of->x].name, below),
                   .curves = trials,
                   .x = x,
                   .y = y};
    for (int t = 0; t < trials; ++t)
        for (int i = 0; i < m->trial[t]->rows; i += every)
            x[panel.rows++] = m->trial[t]->row[i][of->x] * scale[0];
    for (int k = 0; k < panel.rows * trials; ++k)
        y[k] = NAN;
    for (int t = 0, n = 0; t < trials; ++t)
        for (int i = 0; i < m->trial[t]->rows; i += every, ++n)
            y[t * panel.rows + n] = m->trial[t]->row[i][of->y] * scale[1];
    panel_draw(out, &panel);
}

static void write_curves(void *context, Text *out, int indent)
{
    const Manoeuvre *m = ((const Page *)context)->manoeuvre;
    (void)indent;
    text_print(out, "<p>");
    for (int t = 0; t < m->trials && t < DRAWN; ++t) {
        text_print(out, "<span style=\"color:%s\">&#8212; ", panel_color(t));
        text_html(out, m->trial[t]->name);
        text_print(out, "</span> ");
    }
    text_print(out, "</p>\n<div class=\"curves\">\n");
    for (int k = 0; k < m->tables; ++k)
        panel_draw(out, &(Panel){.title = m->table[k].title,
                                 .unit = m->table[k].unit,
                                 .below = m->table[k].below,
                                 .rows = m->table[k].rows,
                                 .curves = m->table[k].curves,
                                 .x = m->table[k].x,
                                 .y = m->table[k].y});
    for (int k = 0; k < m->curves; ++k)
        curve(m, out, &m->curve[k]);
    text_print(out, "</div>\n");
}

static void write_tables(void *context, Text *out, int indent)
{
    (void)indent;
    sheet_tables(((const Page *)context)->manoeuvre->result, out);
}

static void write_notes(void *context, Text *out, int indent)
{
    const Sheet *result = ((const Page *)context)->manoeuvre->result;
    (void)indent;
    for (int i = 0; i < result->notes; ++i) {
        text_print(out, "<p>");
        text_html(out, result->note[i]);
        text_print(out, ".</p>\n");
    }
}

static void write_identity(void *context, Text *out, int indent)
{
    const Page *page = context;
    const Model *model = page->manoeuvre->car->model;
    (void)indent;
    text_print(out, "<p>%s. ", page->kind->title);
    text_html(out, model->description ? model->description : model->name);
    for (int k = 0; k < MANOEUVRE_KEYS && page->kind->key[k].name; ++k)
        text_print(out, "%s %s %.6g %s", k ? "," : ":", page->kind->key[k].name, page->manoeuvre->value[k],
                   page->kind->key[k].unit);
    text_print(out, ". gicgen " GICGEN_VERSION "; models/MANOEUVRES.md defines the numbers.</p>\n");
}

static void write_scenes(void *context, Text *out, int indent)
{
    const Manoeuvre *m = ((const Page *)context)->manoeuvre;
    (void)indent;
    for (int t = 0; t < m->trials; ++t) {
        text_print(out, "<details><summary>");
        text_html(out, m->trial[t]->name);
        text_print(out, "</summary><pre>");
        text_html(out, m->trial[t]->scene);
        text_print(out, "</pre></details>\n");
    }
}

static const Insertion points[] = {{"identity", write_identity}, {"tables", write_tables}, {"notes", write_notes},
                                   {"curves", write_curves},     {"scenes", write_scenes}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"manoeuvre.html.in", NULL}, points, NULL};

void manoeuvre_page(const Manoeuvre *manoeuvre, const ManoeuvreKind *kind, const char *path)
{
    Page page = {manoeuvre, kind};
    Text out = {.pool = manoeuvre->pool};
    templates_check(manoeuvre->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(manoeuvre->pool, &out, NULL, "manoeuvre.html.in", manoeuvre->car->model->name, NULL, &page_points,
                    &page);
    file_write(path, out.s, out.size);
}
