/* SPDX-License-Identifier: MIT
 * The page of a sweep: Pareto fronts, response surfaces and their errors. */
#include "base/file.h"
#include "base/message.h"
#include "base/version.h"
#include "emit/emit.h"
#include "host/host.h"
#include "sweep/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 4000 /* of a picture */, ROWS = 1000 /* of a table */, OVER = 4 /* numbers, each two in a picture */ };

/* A surface whose prediction of runs that are left out explains less of the metric than this is said not to fit. */
static const double good = 0.9;

typedef struct Page {
    Pool *pool;
    const SweepForm *form;
    const SweepReport *report;
    int64_t runs, failed;
    int varied, metrics;
    const SweepColumn **number, **metric; /* [varied], [metrics] */
    const char **name;                    /* [varied] */
    double *point, *value;                /* [runs][varied], [metrics][runs]; NAN: not there, or the run failed */
    Text notes;
} Page;

static const char *with_unit(Pool *pool, const SweepColumn *column)
{
    return column->unit ? pool_print(pool, "%s, %s", column->name, column->unit) : column->name;
}

static const char *unit_after(Pool *pool, const SweepColumn *column)
{
    return column->unit ? pool_print(pool, " %s", column->unit) : "";
}

static void read_rows(Page *page, const SweepForm *form, const char *const *row)
{
    page->number = pool_alloc(page->pool, sizeof *page->number * (size_t)form->columns);
    page->metric = pool_alloc(page->pool, sizeof *page->metric * (size_t)form->columns);
    page->name = pool_alloc(page->pool, sizeof *page->name * (size_t)form->columns);
    for (int c = 0; c < form->columns; ++c) {
        if (!strcmp(form->column[c].group, "parameters")) {
            page->name[page->varied] = form->column[c].name;
            page->number[page->varied++] = &form->column[c];
        }
        if (!strcmp(form->column[c].group, "metrics"))
            page->metric[page->metrics++] = &form->column[c];
    }
    page->point = pool_alloc(page->pool, sizeof *page->point * (size_t)(page->runs * page->varied + 1));
    page->value = pool_alloc(page->pool, sizeof *page->value * (size_t)(page->runs * page->metrics + 1));
    for (int64_t r = 0; r < page->runs; ++r) {
        const char *text = row[r];
        bool failed = false;
        char *end;
        for (int c = 0, v = 0, m = 0; c < form->columns; ++c, text = *end ? end + 1 : end) {
            const double value = strtod(text, &end);
            if (!strcmp(form->column[c].group, "parameters"))
                page->point[r * page->varied + v++] = value;
            failed = failed || (!strcmp(form->column[c].name, "status") && value != 0);
            if (!strcmp(form->column[c].group, "metrics"))
                page->value[m++ * page->runs + r] = failed ? (double)NAN : value;
        }
        page->failed += failed;
    }
}

static void range_of(const double *value, int64_t count, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int64_t i = 0; i < count; ++i)
        if (isfinite(value[i])) {
            range[0] = fmin(range[0], value[i]);
            range[1] = fmax(range[1], value[i]);
        }
}

/* So that no point lies on the edge. */
static void add_margin(double range[2])
{
    const double margin = (range[1] - range[0]) / 25;
    range[0] -= margin;
    range[1] += margin;
}

/* Said on the page, and to who called. */
static void stop(Page *page, Text *out, const char *text)
{
    text_print(out, "<p class=\"stop\">");
    text_html(out, text);
    text_print(out, "</p>\n");
    text_print(&page->notes, "%s\n", text);
}

/* A cell with a number; a program reads all of its digits. */
static void cell(Text *out, double value)
{
    if (isfinite(value))
        text_print(out, "<td class=\"n\"><data value=\"%.17g\">%.6g</data></td>", value, value);
    else
        text_print(out, "<td class=\"n\">nan</td>");
}

static void head(Text *out, const char *text)
{
    text_print(out, "<th class=\"n\">");
    text_html(out, text);
    text_print(out, "</th>");
}

/* ---- fronts ---------------------------------------------------------------------------------------------- */

/* Steps between the runs of a front of two metrics: what is beyond them is beaten. x is sorted from its good end. */
static void draw_steps(const Page *page, const Picture *picture, const double *x, const double *y, int64_t front,
                       const int64_t *on)
{
    double *step[2];
    int points = 0;
    for (int k = 0; k < 2; ++k)
        step[k] = pool_alloc(page->pool, sizeof **step * 2 * (size_t)front);
    for (int64_t i = 0; i < front; ++i) {
        if (i) {
            step[0][points] = x[on[i]];
            step[1][points++] = y[on[i - 1]];
        }
        step[0][points] = x[on[i]];
        step[1][points++] = y[on[i]];
    }
    picture_line(picture, "front", points, step[0], step[1]);
}

static void draw_front(const Page *page, Text *out, const Front *f, int k, int64_t front, const int64_t *on)
{
    const double *x = page->value + f->metric[0] * page->runs, *y = page->value + f->metric[k] * page->runs;
    const SweepColumn *of[2] = {page->metric[f->metric[0]], page->metric[f->metric[k]]};
    const int64_t every = page->runs / POINTS + 1;
    const char *label[2];
    Picture picture = {.out = out};
    range_of(x, page->runs, picture.x);
    range_of(y, page->runs, picture.y);
    add_margin(picture.x);
    add_margin(picture.y);
    for (int i = 0; i < 2; ++i)
        label[i] = pool_print(page->pool, "%s (%s is better)", with_unit(page->pool, of[i]),
                              f->large[i ? k : 0] ? "more" : "less");
    picture_begin(&picture, pool_print(page->pool, "%s over %s", of[1]->name, of[0]->name), label[0], label[1]);
    for (int64_t r = 0; r < page->runs; r += every)
        if (isfinite(x[r]) && isfinite(y[r]))
            picture_point(&picture, "run", x[r], y[r]);
    if (f->numbers == 2)
        draw_steps(page, &picture, x, y, front, on);
    for (int64_t i = 0; i < front && i < POINTS; ++i)
        picture_point(&picture, "on", x[on[i]], y[on[i]]);
    picture_end(&picture);
}

static void front_table(const Page *page, Text *out, int64_t front, const int64_t *on)
{
    text_print(out, "<table class=\"front\">\n<thead><tr>");
    head(out, "run");
    for (int v = 0; v < page->varied; ++v)
        head(out, with_unit(page->pool, page->number[v]));
    for (int m = 0; m < page->metrics; ++m)
        head(out, with_unit(page->pool, page->metric[m]));
    text_print(out, "</tr></thead>\n<tbody>\n");
    for (int64_t i = 0; i < front && i < ROWS; ++i) {
        text_print(out, "<tr><td class=\"n\">%lld</td>", (long long)on[i]);
        for (int v = 0; v < page->varied; ++v)
            cell(out, page->point[on[i] * page->varied + v]);
        for (int m = 0; m < page->metrics; ++m)
            cell(out, page->value[m * page->runs + on[i]]);
        text_print(out, "</tr>\n");
    }
    text_print(out, "</tbody>\n</table>\n");
    if (front > ROWS)
        text_print(out, "<p>The table has the first %d of them.</p>\n", ROWS);
}

static void write_front(Page *page, Text *out, const Front *f)
{
    Pool *pool = page->pool;
    const int n = f->numbers;
    double *value = pool_alloc(pool, sizeof *value * (size_t)(page->runs * n + 1));
    int64_t *on = pool_alloc(pool, sizeof *on * (size_t)(page->runs + 1)), having = 0;
    const char *title = "";
    for (int k = 0; k < n; ++k)
        title = pool_print(pool, "%s%s%s %s", title, k ? ", " : "", f->large[k] ? "most" : "least",
                           page->metric[f->metric[k]]->name);
    for (int64_t r = 0; r < page->runs; ++r) {
        bool finite = true;
        for (int k = 0; k < n; ++k) {
            const double number = page->value[f->metric[k] * page->runs + r];
            value[r * n + k] = f->large[k] ? -number : number;
            finite = finite && isfinite(number);
        }
        having += finite;
    }
    const int64_t front = front_find(pool, page->runs, n, value, on);
    text_print(out, "<h2>Pareto front: ");
    text_html(out, title);
    text_print(out, "</h2>\n");
    if (!front) {
        stop(page, out, pool_print(pool, "no front of %s: no run has all of these numbers", title));
        return;
    }
    text_print(
        out,
        "<p>%lld of %lld runs that have these numbers are on the front: no other run is as good in all and better "
        "in one.</p>\n<div class=\"pictures\">\n",
        (long long)front, (long long)having);
    for (int k = 1; k < n; ++k)
        draw_front(page, out, f, k, front, on);
    text_print(out, "</div>\n");
    front_table(page, out, front, on);
}

static void write_fronts(void *context, Text *out, int indent)
{
    Page *page = context;
    (void)indent;
    for (int f = 0; f < page->report->fronts; ++f)
        write_front(page, out, &page->report->front[f]);
}

/* ---- surfaces -------------------------------------------------------------------------------------------- */

/* A surface over two numbers, the others in the middle of their ranges. */
typedef struct Cut {
    const Surface *surface;
    int i, j;
} Cut;

static double cut_at(const void *context, double x, double y)
{
    const Cut *cut = context;
    double at[SURFACE_VARIED_MOST];
    memcpy(at, cut->surface->middle, sizeof at);
    at[cut->i] = x;
    at[cut->j] = y;
    return surface_at(cut->surface, at);
}

static void draw_cut(const Page *page, Text *out, int m, const Cut *cut)
{
    const Surface *s = cut->surface;
    Picture picture = {.out = out,
                       .x = {s->middle[cut->i] - s->half[cut->i], s->middle[cut->i] + s->half[cut->i]},
                       .y = {s->middle[cut->j] - s->half[cut->j], s->middle[cut->j] + s->half[cut->j]}};
    picture_begin(&picture, with_unit(page->pool, page->metric[m]), with_unit(page->pool, page->number[cut->i]),
                  with_unit(page->pool, page->number[cut->j]));
    picture_shades(&picture, cut_at, cut);
    for (int64_t r = 0; r < page->runs; r += page->runs / POINTS + 1) {
        const double *at = page->point + r * page->varied;
        if (isfinite(page->value[m * page->runs + r]))
            picture_point(&picture, "run", at[cut->i], at[cut->j]);
    }
    picture_end(&picture);
}

/* Over the only number. */
static void draw_curve(const Page *page, Text *out, int m, const Surface *s)
{
    enum { ALONG = 101 };
    double x[ALONG], y[ALONG], range[2];
    const double *value = page->value + m * page->runs;
    Picture picture = {.out = out, .x = {s->middle[0] - s->half[0], s->middle[0] + s->half[0]}};
    range_of(value, page->runs, picture.y);
    for (int i = 0; i < ALONG; ++i) {
        x[i] = s->middle[0] + s->half[0] * (2.0 * i / (ALONG - 1) - 1);
        y[i] = surface_at(s, &x[i]);
    }
    range_of(y, ALONG, range);
    picture.y[0] = fmin(picture.y[0], range[0]);
    picture.y[1] = fmax(picture.y[1], range[1]);
    add_margin(picture.x);
    add_margin(picture.y);
    picture_begin(&picture, page->metric[m]->name, with_unit(page->pool, page->number[0]),
                  with_unit(page->pool, page->metric[m]));
    picture_line(&picture, "front", ALONG, x, y);
    for (int64_t r = 0; r < page->runs; r += page->runs / POINTS + 1)
        if (isfinite(value[r]))
            picture_point(&picture, "on", page->point[r], value[r]);
    picture_end(&picture);
}

static void term(Text *out, const char *name, const char *other, double factor)
{
    text_print(out, "<tr><td>");
    text_html(out, name);
    if (other) {
        text_print(out, " &middot; ");
        text_html(out, other);
    }
    text_print(out, "</td>");
    cell(out, factor);
    text_print(out, "</tr>\n");
}

static void factor_table(const Page *page, Text *out, int m, const Surface *s)
{
    const double *next = s->factor;
    text_print(out, "<details><summary>Its factors</summary>\n<p>");
    text_html(out, page->metric[m]->name);
    text_print(out, " is the sum of these factors times");
    for (int v = 0; v < s->varied; ++v) {
        text_print(out, "%s ", v ? "," : "");
        text_html(out,
                  pool_print(page->pool, "u%d = (%s - %.15g)/%.15g", v + 1, page->name[v], s->middle[v], s->half[v]));
    }
    text_print(out, ", or products of them.</p>\n<table class=\"factors\"><tbody>\n");
    term(out, "1", NULL, *next++);
    for (int i = 0; i < s->varied; ++i)
        term(out, pool_print(page->pool, "u%d", i + 1), NULL, *next++);
    for (int i = 0; i < s->varied; ++i)
        for (int j = i; j < s->varied; ++j)
            term(out, pool_print(page->pool, "u%d", i + 1), pool_print(page->pool, "u%d", j + 1), *next++);
    text_print(out, "</tbody></table>\n</details>\n");
}

/* Errors of a surface, and whether it fits. */
static void write_errors(Page *page, Text *out, int m, const Surface *s)
{
    const char *unit = unit_after(page->pool, page->metric[m]);
    const struct {
        const char *title, *unit;
        double value;
    } row[] = {{"R&sup2;", "", s->r2},
               {"residual, root of the mean square", unit, s->residual},
               {"R&sup2; where each run is left out of the surface that predicts it", "", s->left_r2},
               {"residual of runs that are left out, root of the mean square", unit, s->left},
               {pool_print(page->pool, "the largest of these, run %lld", (long long)s->worst_run), unit, s->worst}};
    text_print(out, "<table class=\"errors\"><caption>%lld runs, %d factors</caption><tbody>\n", (long long)s->runs,
               s->terms);
    for (size_t k = 0; k < sizeof row / sizeof *row; ++k) {
        text_print(out, "<tr><td>%s</td>", row[k].title);
        cell(out, row[k].value);
        text_print(out, "<td>");
        text_html(out, row[k].unit);
        text_print(out, "</td></tr>\n");
    }
    text_print(out, "</tbody></table>\n");
    if (s->left_r2 < good)
        stop(page, out,
             pool_print(
                 page->pool,
                 "the surface of %s does not fit: R^2 of runs that are left out is %.3g, below %.3g; take narrower "
                 "ranges, or read the runs themselves",
                 page->metric[m]->name, s->left_r2, good));
}

static void write_surfaces(void *context, Text *out, int indent)
{
    Page *page = context;
    (void)indent;
    for (int m = 0; m < page->metrics; ++m) {
        Pool *pool = pool_new();
        const Surface s =
            surface_fit(pool, page->name, page->varied, page->runs, page->point, page->value + m * page->runs);
        text_print(out, "<section>\n<h2>Response surface: ");
        text_html(out, with_unit(page->pool, page->metric[m]));
        text_print(out, "</h2>\n");
        if (s.why) {
            stop(page, out, pool_print(page->pool, "no surface of %s: %s", page->metric[m]->name, s.why));
        } else {
            write_errors(page, out, m, &s);
            text_print(out, "<div class=\"pictures\">\n");
            if (s.varied == 1)
                draw_curve(page, out, m, &s);
            for (int i = 0; i < s.varied && i < OVER; ++i)
                for (int j = i + 1; j < s.varied && j < OVER; ++j)
                    draw_cut(page, out, m, &(Cut){&s, i, j});
            text_print(out, "</div>\n");
            factor_table(page, out, m, &s);
        }
        text_print(out, "</section>\n");
        pool_free(pool);
    }
}

/* NULL: there is no fact of that name. */
static const char *fact_of(const SweepForm *form, const char *name)
{
    for (int f = 0; f < form->facts; ++f)
        if (!strcmp(form->fact[f].name, name))
            return form->fact[f].value;
    return NULL;
}

static void write_identity(void *context, Text *out, int indent)
{
    const Page *page = context;
    const char *description = fact_of(page->form, "description");
    (void)indent;
    text_print(out, "<p>");
    text_html(out, description ? description : fact_of(page->form, "model"));
    text_print(out, ". gicgen " GICGEN_VERSION ". %lld runs; %lld failed and are left out.</p>\n",
               (long long)page->runs, (long long)page->failed);
    if (page->runs > POINTS)
        text_print(out, "<p>Pictures show %d of them at most, evenly chosen, and those on a front.</p>\n", POINTS);
    if (page->varied > 2)
        text_print(out,
                   "<p>Pictures of surfaces are over each two of the numbers that vary%s, the others in the middle of "
                   "their ranges.</p>\n",
                   page->varied > OVER ? ", the first four" : "");
}

static const Insertion points[] = {
    {"identity", write_identity}, {"fronts", write_fronts}, {"surfaces", write_surfaces}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"sweep.html.in", NULL}, points, NULL};

const char *sweep_report_page(Pool *pool, const SweepForm *form, int64_t runs, const char *const *row,
                              const SweepReport *report)
{
    Page page = {.pool = pool, .form = form, .report = report, .runs = runs, .notes = {.pool = pool}};
    Text out = {.pool = pool};
    read_rows(&page, form, row);
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &out, NULL, "sweep.html.in", fact_of(form, "model"), NULL, &page_points, &page);
    file_write(report->path, out.s, out.size);
    return page.notes.s ? page.notes.s : "";
}

SweepReport sweep_report_open(Pool *pool, const ReportRequest *request, const SweepForm *form, int64_t runs,
                              const char *const *others)
{
    Front *front = pool_alloc(pool, sizeof *front * (size_t)(request->fronts + 1));
    int varied = 0, metrics = 0;
    for (int c = 0; c < form->columns; ++c) {
        varied += !strcmp(form->column[c].group, "parameters");
        metrics += !strcmp(form->column[c].group, "metrics");
    }
    if (!metrics)
        diag_fail_call(program_place(), "make the sweep with --metric NAME=FUNCTION(FORMULA)",
                       "a report is of metrics, and the sweep has none");
    if (varied > SURFACE_VARIED_MOST || runs > REPORT_RUNS_MOST)
        diag_fail_call(program_place(), "leave out --report, or vary less",
                       "a report has %d runs and %d numbers at most, "
                       "not %lld and %d",
                       REPORT_RUNS_MOST, SURFACE_VARIED_MOST, (long long)runs, varied);
    for (; *others; ++others)
        if (files_are_one(request->path, *others))
            diag_fail_call(program_place(), "choose another file", "--report is not to write over %s", *others);
    file_check(request->path);
    for (int f = 0; f < request->fronts; ++f)
        front[f] = front_read(pool, request->front[f], form);
    return (SweepReport){request->path, request->fronts, front};
}

void sweep_report_write(Pool *pool, const SweepForm *form, int64_t runs, const char *const *row,
                        const SweepReport *report, bool quiet)
{
    const char *notes = sweep_report_page(pool, form, runs, row, report);
    if (*notes && !quiet)
        diag_note(pool_print(pool, "%s: note: %s:\n%s", program_place().source->path, report->path, notes));
}
