/* SPDX-License-Identifier: MIT
 * The page of a study with --vary: numbers over what is varied, curves of all runs as families, a table. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "run/kc.h"
#include "run/panel.h"
#include "sweep/study.h"

#include <math.h>
#include <string.h>

enum { DRAWN = 8 /* curves of a diagram, as many as there are colors */ };

/* The k-th of at most DRAWN runs, evenly chosen of `count`. */
static int64_t chosen(int64_t count, int k)
{
    return count <= DRAWN ? k : k * (count - 1) / (DRAWN - 1);
}

static int drawn(int64_t count)
{
    return count < DRAWN ? (int)count : DRAWN;
}

static void legend(Text *out, int curve, const char *label)
{
    text_print(out, "<span style=\"color:%s\">&#8212; ", panel_color(curve));
    text_html(out, label);
    text_print(out, "</span> ");
}

/* ---- numbers over what is varied ------------------------------------------------------------------------ */

/* Over the number that is varied last; a curve for values of the others. */
static void write_numbers(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    const int last = sweep->plan.varied - 1;
    const int64_t rows = sweep->plan.vary[last].count, sets = sweep->plan.runs / rows;
    const int curves = drawn(sets);
    double *x = pool_alloc(sweep->pool, (size_t)rows * sizeof *x);
    double *y = pool_alloc(sweep->pool, (size_t)rows * (size_t)curves * sizeof *y);
    (void)indent;
    for (int k = 0; k < curves && sets > 1; ++k) {
        const char *label = "";
        for (int v = 0; v < last; ++v)
            label = pool_print(sweep->pool, "%s%s%s = %.6g", label, v ? ", " : "", sweep->plan.vary[v].name,
                               plan_value(&sweep->plan, v, chosen(sets, k) * rows));
        legend(out, k, label);
    }
    text_print(out, "<div class=\"curves\">\n");
    for (int64_t r = 0; r < rows; ++r)
        x[r] = plan_value(&sweep->plan, last, r);
    for (int c = 0; c < sweep->columns && rows > 1; ++c) {
        const SheetRow *column = &sweep->column[c];
        if (!study_changes(sweep, c))
            continue;
        for (int k = 0; k < curves; ++k)
            for (int64_t r = 0; r < rows; ++r)
                y[k * rows + r] = sweep->value[(chosen(sets, k) * rows + r) * sweep->columns + c] * column->scale;
        panel_draw(out,
                   &(Panel){.title = column->title,
                            .unit = column->shown,
                            .below = pool_print(sweep->pool, "%s, %s", sweep->plan.vary[last].name, sweep->unit[last]),
                            .rows = (int)rows,
                            .curves = curves,
                            .x = x,
                            .y = y});
    }
    text_print(out, "</div>\n");
}

/* ---- families of curves --------------------------------------------------------------------------------- */

/* The curve of a run with the group and title of another one; NULL: it has none. */
static const StudyCurve *alike(const StudyRun *run, const StudyCurve *curve)
{
    for (int k = 0; k < run->curves; ++k)
        if (!strcmp(run->curve[k].group, curve->group) && !strcmp(run->curve[k].title, curve->title))
            return &run->curve[k];
    return NULL;
}

/* The curves of all runs in one diagram, each with its own abscissae. */
static void family(const StudySweep *sweep, Text *out, const StudyCurve *first)
{
    const int curves = drawn(sweep->plan.runs);
    const StudyCurve *of[DRAWN];
    int rows = 0;
    for (int k = 0; k < curves; ++k) {
        of[k] = alike(&sweep->run[chosen(sweep->plan.runs, k)], first);
        rows += of[k] ? of[k]->rows : 0;
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
                             .below = first->below,
                             .rows = rows,
                             .curves = curves,
                             .x = x,
                             .y = y});
}

/* True: a run before has it as well. */
static bool shown_before(const StudySweep *sweep, int k, const StudyCurve *curve)
{
    for (int i = 0; i < k; ++i)
        if (alike(&sweep->run[chosen(sweep->plan.runs, i)], curve))
            return true;
    return false;
}

static void write_families(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    const int curves = drawn(sweep->plan.runs);
    const char *group = NULL;
    (void)indent;
    for (int k = 0; k < curves; ++k) {
        const StudyRun *run = &sweep->run[chosen(sweep->plan.runs, k)];
        for (int i = 0; i < run->curves; ++i) {
            const StudyCurve *curve = &run->curve[i];
            if (shown_before(sweep, k, curve))
                continue;
            if (!group || strcmp(group, curve->group) != 0) {
                text_print(out, "%s<h2>", group ? "</div>\n" : "");
                text_html(out, curve->group);
                text_print(out, "</h2>\n<p>");
                for (int c = 0; c < curves; ++c)
                    legend(out, c, study_label(sweep, chosen(sweep->plan.runs, c)));
                text_print(out, "</p>\n<div class=\"curves\">\n");
                group = curve->group;
            }
            family(sweep, out, curve);
        }
    }
    text_print(out, "%s", group ? "</div>\n" : "");
}

/* ---- the table ------------------------------------------------------------------------------------------ */

static void cell(Text *out, const char *text, bool number)
{
    text_print(out, "<td%s>", number ? " class=\"n\"" : "");
    text_html(out, text);
    text_print(out, "</td>");
}

static void write_table(void *context, Text *out, int indent)
{
    const StudySweep *sweep = context;
    (void)indent;
    for (int v = 0; v < sweep->plan.varied; ++v) {
        text_print(out, "<tr class=\"varied\">");
        cell(out, sweep->plan.vary[v].name, false);
        cell(out, sweep->unit[v], false);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            cell(out, pool_print(sweep->pool, "%.6g", plan_value(&sweep->plan, v, r)), true);
        text_print(out, "</tr>\n");
    }
    for (int c = 0; c < sweep->columns; ++c) {
        const SheetRow *column = &sweep->column[c];
        if (!study_changes(sweep, c))
            continue;
        text_print(out, "<tr>");
        cell(out, column->title, false);
        cell(out, column->shown, false);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            cell(out, kc_shown(sweep->pool, sweep->value[r * sweep->columns + c], column->scale), true);
        text_print(out, "</tr>\n");
    }
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
    text_html(out, model->description ? model->description : model->name);
    text_print(out, ". gicgen " GICGEN_VERSION ". %lld runs; %d other numbers do not change.</p>\n",
               (long long)sweep->plan.runs, same);
    if (sweep->plan.runs > DRAWN)
        text_print(out, "<p>Families show %d runs, evenly chosen; the table has all.</p>\n", DRAWN);
    for (int64_t r = 0; r < sweep->plan.runs; ++r)
        if (sweep->run[r].reason) {
            text_print(out, "<p class=\"stop\">No results with ");
            text_html(out, study_label(sweep, r));
            text_print(out, ": ");
            text_html(out, sweep->run[r].reason);
            text_print(out, "</p>\n");
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
