/* SPDX-License-Identifier: MIT
 * The page of a study with --vary: numbers over what is varied, curves of all runs as families, a table. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"
#include "run/manoeuvre.h"
#include "run/panel.h"
#include "sweep/study.h"

#include <math.h>
#include <string.h>

enum { DRAWN = 8 /* curves of a diagram, as many as there are colors */ };

/* Curves of a vehicle: with another one beside it, both have half of the room. */
static int drawn(const StudySweep *sweep, int64_t count)
{
    const int most = sweep->beside ? DRAWN / 2 : DRAWN;
    return count < most ? (int)count : most;
}

/* The k-th of those that are drawn, evenly chosen of `count`. */
static int64_t chosen(const StudySweep *sweep, int64_t count, int k)
{
    const int curves = drawn(sweep, count);
    return count <= curves ? k : k * (count - 1) / (curves - 1);
}

static int vehicles(const StudySweep *sweep)
{
    return sweep->beside ? 2 : 1;
}

/* A line as panel_draw() draws that curve. */
static void legend(const StudySweep *sweep, Text *out, int curve, const char *label)
{
    text_print(out, "<span style=\"color:%s\">%s ", panel_color(curve),
               curve == 1 && !sweep->beside ? "&#9476;&#9476;" : "&#8212;");
    text_html(out, label);
    text_print(out, "</span> ");
}

/* ---- numbers over what is varied ------------------------------------------------------------------------ */

/* The title of a number; where another one has the same, after the section that it stands in. */
static const char *title_of(const StudySweep *sweep, int column)
{
    const SheetRow *own = &sweep->column[column];
    for (int c = 0; c < sweep->columns; ++c)
        if (c != column && !strcmp(sweep->column[c].title, own->title) && own->section)
            return pool_print(sweep->pool, "%s: %s", own->section, own->title);
    return own->title;
}

static void draw_number(const StudySweep *sweep, Text *out, int c, const double *x, double *y)
{
    const int last = sweep->plan.varied - 1, beside = vehicles(sweep);
    const int64_t rows = sweep->plan.vary[last].count, sets = sweep->plan.runs / rows;
    const int curves = drawn(sweep, sets);
    const SheetRow *column = &sweep->column[c];
    for (int k = 0; k < curves * beside; ++k)
        for (int64_t r = 0; r < rows; ++r) {
            const int64_t run = chosen(sweep, sets, k / beside) * rows + r;
            y[k * rows + r] = sweep->value[k % beside][run * sweep->columns + c] * column->scale;
        }
    panel_draw(out, &(Panel){.title = title_of(sweep, c),
                             .unit = column->shown,
                             .below = pool_print(sweep->pool, "%s, %s", sweep->plan.vary[last].name, sweep->unit[last]),
                             .rows = (int)rows,
                             .curves = curves * beside,
                             .pairs = sweep->beside,
                             .x = x,
                             .y = y});
}

/* Over the number that is varied last; a curve for values of the others. */
static void write_numbers(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    const int last = sweep->plan.varied - 1;
    const int64_t rows = sweep->plan.vary[last].count, sets = sweep->plan.runs / rows;
    const int curves = drawn(sweep, sets);
    const size_t room = (size_t)rows * (size_t)curves * (size_t)vehicles(sweep);
    double *x = pool_alloc(sweep->pool, (size_t)rows * sizeof *x), *y = pool_alloc(sweep->pool, room * sizeof *y);
    (void)indent;
    for (int k = 0; k < curves && sets > 1; ++k) {
        const char *label = "";
        for (int v = 0; v < last; ++v)
            label = pool_print(sweep->pool, "%s%s%s = %.6g", label, v ? ", " : "", sweep->plan.vary[v].name,
                               plan_value(&sweep->plan, v, chosen(sweep, sets, k) * rows));
        legend(sweep, out, k, label);
    }
    text_print(out, "<div class=\"curves\">\n");
    for (int64_t r = 0; r < rows; ++r)
        x[r] = plan_value(&sweep->plan, last, r);
    for (int c = 0; c < sweep->columns && rows > 1; ++c)
        if (study_changes(sweep, c))
            draw_number(sweep, out, c, x, y);
    text_print(out, "</div>\n");
}

/* ---- families of curves --------------------------------------------------------------------------------- */

static bool is_alike(const StudyCurve *a, const StudyCurve *b)
{
    return !strcmp(a->group, b->group) && !strcmp(a->key, b->key) && !strcmp(a->unit, b->unit);
}

/* A vehicle's curve of a run that belongs to another one; NULL: it has none. */
static const StudyCurve *alike(const StudyRun *run, int who, const StudyCurve *curve)
{
    for (int k = 0; k < run->curves; ++k)
        if (run->curve[k].who == who && is_alike(&run->curve[k], curve))
            return &run->curve[k];
    return NULL;
}

/* The curves of all runs in one diagram, each with its own abscissae. */
static void family(const StudySweep *sweep, Text *out, const StudyCurve *first)
{
    const int beside = vehicles(sweep), curves = drawn(sweep, sweep->plan.runs) * beside;
    const StudyCurve *of[DRAWN];
    const char *below = first->below;
    int rows = 0;
    for (int k = 0; k < curves; ++k) {
        of[k] = alike(&sweep->run[chosen(sweep, sweep->plan.runs, k / beside)], k % beside, first);
        rows += of[k] ? of[k]->rows : 0;
        if (of[k] && !strstr(below, of[k]->below))
            below = pool_print(sweep->pool, "%s; %s", below, of[k]->below);
    }
    double *x = pool_alloc(sweep->pool, ((size_t)rows + 1) * sizeof *x);
    double *y = pool_alloc(sweep->pool, ((size_t)rows * (size_t)curves + 1) * sizeof *y);
    for (int i = 0; i < rows * curves; ++i)
        y[i] = NAN;
    for (int k = 0, at = 0; k < curves; ++k)
        for (int r = 0; of[k] && r < of[k]->rows; ++r, ++at) {
            x[at] = of[k]->x[r];
            y[k * rows + at] = of[k]->y[r];
        }
    panel_draw(out, &(Panel){.title = first->title,
                             .unit = first->unit,
                             .below = below,
                             .rows = rows,
                             .curves = curves,
                             .pairs = sweep->beside,
                             .x = x,
                             .y = y});
}

/* True: a run before, or an earlier curve of this one, has it as well. */
static bool shown_before(const StudySweep *sweep, int k, const StudyCurve *curve)
{
    for (int i = 0; i < k; ++i)
        for (int who = 0; who < vehicles(sweep); ++who)
            if (alike(&sweep->run[chosen(sweep, sweep->plan.runs, i)], who, curve))
                return true;
    const StudyRun *run = &sweep->run[chosen(sweep, sweep->plan.runs, k)];
    for (const StudyCurve *before = run->curve; before < curve; ++before)
        if (is_alike(before, curve))
            return true;
    return false;
}

/* All diagrams of a group, which a run before or an earlier curve of this one does not have. */
static void write_group(const StudySweep *sweep, Text *out, const char *group)
{
    const int curves = drawn(sweep, sweep->plan.runs);
    text_print(out, "<h2>");
    text_html(out, group);
    text_print(out, "</h2>\n<p>");
    for (int c = 0; c < curves; ++c)
        legend(sweep, out, c, study_label(sweep, chosen(sweep, sweep->plan.runs, c)));
    text_print(out, "</p>\n<div class=\"curves\">\n");
    for (int k = 0; k < curves; ++k) {
        const StudyRun *run = &sweep->run[chosen(sweep, sweep->plan.runs, k)];
        for (const StudyCurve *curve = run->curve; curve < run->curve + run->curves; ++curve)
            if (!strcmp(curve->group, group) && !shown_before(sweep, k, curve))
                family(sweep, out, curve);
    }
    text_print(out, "</div>\n");
}

static void write_families(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    const char **group = NULL;
    int groups = 0;
    (void)indent;
    for (int k = 0; k < drawn(sweep, sweep->plan.runs); ++k) {
        const StudyRun *run = &sweep->run[chosen(sweep, sweep->plan.runs, k)];
        for (const StudyCurve *curve = run->curve; curve < run->curve + run->curves; ++curve) {
            int g = groups - 1; /* usually that of the curve before */
            while (g >= 0 && strcmp(group[g], curve->group) != 0)
                --g;
            if (g < 0)
                *POOL_PUSH(sweep->pool, group, groups) = curve->group;
        }
    }
    for (int g = 0; g < groups; ++g)
        write_group(sweep, out, group[g]);
}

/* ---- the table ------------------------------------------------------------------------------------------ */

static void cell(Text *out, const char *text, const char *class)
{
    if (class)
        text_print(out, "<td class=\"%s\">", class);
    else
        text_print(out, "<td>");
    text_html(out, text);
    text_print(out, "</td>");
}

static void write_table(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    (void)indent;
    for (int v = 0; v < sweep->plan.varied; ++v) {
        text_print(out, "<tr class=\"varied\">");
        cell(out, sweep->plan.vary[v].name, NULL);
        cell(out, sweep->unit[v], NULL);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            cell(out, pool_print(sweep->pool, "%.6g", plan_value(&sweep->plan, v, r)), "n");
        text_print(out, "</tr>\n");
    }
    for (int c = 0; c < sweep->columns; ++c) {
        const SheetRow *column = &sweep->column[c];
        if (!study_changes(sweep, c))
            continue;
        for (int who = 0; who < vehicles(sweep); ++who) {
            text_print(out, who ? "<tr class=\"other\">" : "<tr>");
            cell(out, who ? pool_print(sweep->pool, "of %s", sweep->name[1]) : column->title, NULL);
            cell(out, who ? "" : column->shown, NULL);
            for (int64_t r = 0; r < sweep->plan.runs; ++r)
                cell(out, study_shown(sweep, who, c, r), study_differs(sweep, c, r) ? "n differs" : "n");
            text_print(out, "</tr>\n");
        }
    }
}

static void write_manoeuvre(const StudySweep *sweep, Text *out)
{
    const Request *request = sweep->request;
    for (const ManoeuvreKind *kind = manoeuvre_kind; request->manoeuvre && kind->name; ++kind)
        if (!strcmp(kind->name, request->manoeuvre))
            text_print(out, "%s", kind->title);
    for (int k = 0; request->manoeuvre && k < request->keys; ++k) {
        text_print(out, "%s ", k ? "," : ":");
        text_html(out, request->key[k]);
    }
    text_print(out, "%s", request->manoeuvre ? ". " : "");
}

static void write_identity(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    const Model *model = sweep->model;
    int same = 0;
    (void)indent;
    for (int c = 0; c < sweep->columns; ++c)
        same += !study_changes(sweep, c);
    text_print(out, "<p>");
    write_manoeuvre(sweep, out);
    text_html(out, model->description && *model->description ? model->description : model->name);
    text_print(out, ". gicgen " GICGEN_VERSION ". %lld runs; %d other numbers do not change.</p>\n",
               (long long)sweep->plan.runs, same);
    if (sweep->beside) {
        text_print(out, "<p>Drawn through: ");
        text_html(out, sweep->name[0]);
        text_print(out, ". Dashed, and second in the table: ");
        text_html(out, sweep->name[1]);
        text_print(out, ", with the same numbers where it has them. What differs is marked.</p>\n");
    }
    if (sweep->plan.runs > drawn(sweep, sweep->plan.runs))
        text_print(out, "<p>Families show %d runs, evenly chosen; the table has all.</p>\n",
                   drawn(sweep, sweep->plan.runs));
    for (int64_t k = -1; (k = study_next_failed(sweep, k + 1)) >= 0;) {
        text_print(out, "<p class=\"stop\">No results: ");
        text_html(out, study_failure(sweep, k));
        text_print(out, "</p>\n");
    }
    for (int i = 0; i < sweep->notes; ++i) {
        text_print(out, "<p>");
        text_html(out, study_note(sweep, &sweep->note[i]));
        text_print(out, ".</p>\n");
    }
}

static const Insertion points[] = {{"identity", write_identity},
                                   {"numbers", write_numbers},
                                   {"families", write_families},
                                   {"table", write_table},
                                   {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"study.html.in", NULL}, points, NULL};

void study_page(const StudySweep *sweep, const char *path)
{
    Text out = {.pool = sweep->pool};
    templates_check(sweep->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(sweep->pool, &out, NULL, "study.html.in", sweep->model->name, NULL, &page_points, (void *)sweep);
    file_write(path, out.s, out.size);
}
