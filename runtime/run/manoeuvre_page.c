/* SPDX-License-Identifier: MIT
 * The page of --manoeuvre: tables, diagrams of all trials, of two vehicles where two
 * are compared, and the scenes that were driven. */
#include "base/file.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/manoeuvre.h"
#include "run/panel.h"

#include <math.h>
#include <string.h>

enum { MOST_ROWS = 600 /* of a curve; more are below a pixel */, DRAWN = 8 /* trials in a diagram, of all vehicles */ };

typedef struct Page {
    const Manoeuvre *of[2]; /* second: with --compare */
    const char *name[2];
    int vehicles;
    const ManoeuvreKind *kind;
} Page;

const char *manoeuvre_shown(Channel channel, double *scale)
{
    const char *unit = trial_signal[channel].unit;
    const bool angle = !strncmp(unit, "rad", 3);
    *scale = angle ? 57.29577951308232 : 1;
    return angle ? (unit[3] ? "deg/s" : "deg") : unit;
}

/* ---- diagrams ---------------------------------------------------------------------------------------------- */

/* Curves, each with abscissae of its own: rows of others are left out. */
typedef struct Diagram {
    Panel panel;
    double *x;
    int room; /* rows */
} Diagram;

static Diagram diagram(Pool *pool, int curves, int room)
{
    Diagram d = {.room = room};
    d.x = pool_alloc(pool, ((size_t)room + 1) * sizeof *d.x);
    d.panel = (Panel){.curves = curves, .rows = room, .x = d.x};
    d.panel.y = pool_alloc(pool, ((size_t)(room * curves) + 1) * sizeof *d.panel.y);
    for (int i = 0; i < room * curves; ++i)
        d.panel.y[i] = NAN;
    return d;
}

/* The next row of a curve; used: rows so far. */
static void put(Diagram *d, int *used, int curve, double x, double y)
{
    d->x[*used] = x;
    d->panel.y[curve * d->room + (*used)++] = y;
}

static int at_most(int count, int most)
{
    return count < most ? count : most;
}

/* The trials of a vehicle that are drawn. */
static int drawn(const Page *page, int vehicle)
{
    return vehicle < page->vehicles ? at_most(page->of[vehicle]->trials, DRAWN / page->vehicles) : 0;
}

/* The same of two vehicles by one color, where each has several; else the colors are of the vehicles. */
static bool in_pairs(const Page *page)
{
    return page->vehicles > 1 && (drawn(page, 0) > 1 || drawn(page, 1) > 1);
}

/* The number of the curve of a vehicle's trial: 2 k and 2 k + 1 are a pair. */
static int curve_of(const Page *page, int vehicle, int trial)
{
    return page->vehicles * trial + vehicle;
}

static int curves_of(const Page *page)
{
    return page->vehicles * (drawn(page, 0) > drawn(page, 1) ? drawn(page, 0) : drawn(page, 1));
}

/* The first trials of all vehicles. */
static void curve(const Page *page, Text *out, const ManoeuvreCurve *of)
{
    int rows = 0, trials = 0, room = 0, used = 0;
    for (int v = 0; v < page->vehicles; ++v)
        for (int t = 0; t < drawn(page, v); ++t, ++trials)
            rows += page->of[v]->trial[t]->rows;
    const int every = trials ? rows / (MOST_ROWS * trials) + 1 : 1;
    for (int v = 0; v < page->vehicles; ++v)
        for (int t = 0; t < drawn(page, v); ++t)
            room += (page->of[v]->trial[t]->rows + every - 1) / every;
    Diagram d = diagram(out->pool, curves_of(page), room);
    double scale[2];
    d.panel.title = trial_signal[of->y].name;
    d.panel.unit = manoeuvre_shown(of->y, &scale[1]);
    const char *below = manoeuvre_shown(of->x, &scale[0]);
    d.panel.below = pool_print(out->pool, "%s, %s", trial_signal[of->x].name, below);
    d.panel.pairs = in_pairs(page);
    for (int v = 0; v < page->vehicles; ++v)
        for (int t = 0; t < drawn(page, v); ++t) {
            const Trial *trial = page->of[v]->trial[t];
            for (int i = 0; i < trial->rows; i += every)
                put(&d, &used, curve_of(page, v, t), trial->row[i][of->x] * scale[0], trial->row[i][of->y] * scale[1]);
        }
    panel_draw(out, &d.panel);
}

static bool is_table(const ManoeuvreTable *a, const ManoeuvreTable *b)
{
    return !strcmp(a->title, b->title) && !strcmp(a->unit, b->unit) && !strcmp(a->below, b->below);
}

/* The table of a vehicle that stands in the same diagram; NULL: it has none. */
static const ManoeuvreTable *table_of(const Manoeuvre *m, const ManoeuvreTable *like)
{
    for (int k = 0; k < m->tables; ++k)
        if (is_table(&m->table[k], like))
            return &m->table[k];
    return NULL;
}

static void table(const Page *page, Text *out, const ManoeuvreTable *like)
{
    int curves = 0, room = 0, used = 0;
    const ManoeuvreTable *of[2] = {NULL, NULL};
    for (int v = 0; v < page->vehicles; ++v) {
        of[v] = table_of(page->of[v], like);
        curves = of[v] && of[v]->curves > curves ? of[v]->curves : curves;
        room += of[v] ? of[v]->rows * of[v]->curves : 0;
    }
    Diagram d = diagram(out->pool, page->vehicles * curves, room);
    d.panel.title = like->title;
    d.panel.unit = like->unit;
    d.panel.below = like->below;
    d.panel.pairs = page->vehicles > 1 && curves > 1;
    for (int v = 0; v < page->vehicles; ++v)
        for (int c = 0; of[v] && c < of[v]->curves; ++c)
            for (int i = 0; i < of[v]->rows; ++i)
                put(&d, &used, curve_of(page, v, c), of[v]->x[i], of[v]->y[c * of[v]->rows + i]);
    panel_draw(out, &d.panel);
}

/* True: the first vehicle has this diagram, too, so that it is drawn. */
static bool is_drawn(const Manoeuvre *first, const ManoeuvreCurve *curve)
{
    for (int k = 0; k < first->curves; ++k)
        if (first->curve[k].x == curve->x && first->curve[k].y == curve->y)
            return true;
    return false;
}

static void legend(const Page *page, Text *out, int vehicle)
{
    const bool colors_of_trials = page->vehicles == 1 || in_pairs(page);
    if (page->vehicles > 1) {
        text_html(out, page->name[vehicle]);
        text_print(out, ": ");
    }
    for (int t = 0; t < drawn(page, vehicle); ++t) {
        text_print(out, "<span style=\"color:%s\">%s", panel_color(colors_of_trials ? t : vehicle),
                   vehicle ? "&#9476;&#9476; " : "&#8212; ");
        text_html(out, page->of[vehicle]->trial[t]->name);
        text_print(out, "</span> ");
    }
}

static void write_curves(void *context, Text *out, int indent)
{
    const Page *page = context;
    (void)indent;
    for (int v = 0; v < page->vehicles; ++v) {
        text_print(out, "<p>");
        legend(page, out, v);
        text_print(out, "</p>\n");
    }
    text_print(out, "<div class=\"curves\">\n");
    for (int v = 0; v < page->vehicles; ++v)
        for (int k = 0; k < page->of[v]->tables; ++k)
            if (!v || !table_of(page->of[0], &page->of[v]->table[k]))
                table(page, out, &page->of[v]->table[k]);
    for (int v = 0; v < page->vehicles; ++v)
        for (int k = 0; k < page->of[v]->curves; ++k)
            if (!v || !is_drawn(page->of[0], &page->of[v]->curve[k]))
                curve(page, out, &page->of[v]->curve[k]);
    text_print(out, "</div>\n");
}

/* ---- the rest ---------------------------------------------------------------------------------------------- */

static void write_tables(void *context, Text *out, int indent)
{
    (void)indent;
    sheet_tables(((const Page *)context)->of[0]->result, out);
}

static void write_notes(void *context, Text *out, int indent)
{
    const Sheet *result = ((const Page *)context)->of[0]->result;
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
    const Model *model = page->of[0]->car->model;
    (void)indent;
    text_print(out, "<p>%s. ", page->kind->title);
    if (page->vehicles > 1) {
        text_html(out, page->name[0]);
        text_print(out, " and ");
        text_html(out, page->name[1]);
        text_print(out, " (dashed); what differs is marked");
    } else
        text_html(out, model->description && *model->description ? model->description : model->name);
    for (int k = 0; k < MANOEUVRE_KEYS && page->kind->key[k].name; ++k)
        text_print(out, "%s %s %.6g %s", k ? "," : ":", page->kind->key[k].name, page->of[0]->value[k],
                   page->kind->key[k].unit);
    text_print(out, ". gicgen " GICGEN_VERSION "; models/MANOEUVRES.md defines the numbers.</p>\n");
}

/* Parameters of the same file that the second vehicle has from a scene. */
static void write_parameters(const Page *page, Text *out, int vehicle)
{
    const Model *own = page->of[vehicle]->car->model, *first = page->of[0]->car->model;
    bool any = false;
    if (!vehicle || strcmp(own->source->path, first->source->path) != 0)
        return;
    for (int i = 0; i < own->parameters && i < first->parameters; ++i)
        if (own->parameter[i].tunable && own->parameter[i].value != first->parameter[i].value) {
            text_print(out, "%s", any ? ", " : "parameters: {");
            text_html(out, own->parameter[i].name);
            text_print(out, ": %.17g", own->parameter[i].value);
            any = true;
        }
    text_print(out, "%s", any ? "}\n" : "");
}

static void write_scenes(void *context, Text *out, int indent)
{
    const Page *page = context;
    (void)indent;
    for (int v = 0; v < page->vehicles; ++v)
        for (int t = 0; t < page->of[v]->trials; ++t) {
            text_print(out, "<details><summary>");
            if (page->vehicles > 1)
                text_html(out, pool_print(out->pool, "%s: ", page->name[v]));
            text_html(out, page->of[v]->trial[t]->name);
            text_print(out, "</summary><pre>");
            text_html(out, page->of[v]->trial[t]->scene);
            write_parameters(page, out, v);
            text_print(out, "</pre></details>\n");
        }
}

static const Insertion points[] = {{"identity", write_identity}, {"tables", write_tables}, {"notes", write_notes},
                                   {"curves", write_curves},     {"scenes", write_scenes}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"manoeuvre.html.in", NULL}, points, NULL};

void manoeuvre_page(const Manoeuvre *manoeuvre, const Manoeuvre *other, const char *name, const ManoeuvreKind *kind,
                    const char *path)
{
    Page page = {{manoeuvre, other}, {manoeuvre->car->model->name, name}, other ? 2 : 1, kind};
    Text out = {.pool = manoeuvre->pool};
    templates_check(manoeuvre->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(manoeuvre->pool, &out, NULL, "manoeuvre.html.in", manoeuvre->car->model->name, NULL, &page_points,
                    &page);
    file_write(path, out.s, out.size);
}
