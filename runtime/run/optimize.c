/* SPDX-License-Identifier: MIT
 * Optimization: what is looked for, and what was found. */
#include "run/optimize.h"
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "host/host.h"
#include "run/condition_output.h"
#include "run/fit_page.h"
#include "run/formula_output.h"
#include "run/number_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_RUNS = 100, PEAK_RUNS = 8 /* of each order on the way to the last */, LAST_ORDER = 64 };

static const char *const option = "--optimize";

/* ---- what is looked for ----------------------------------------------------------------------------------- */

/* The formulas between semicolons as the only outputs of a model, and the scene's conditions; sets search->formula and
 * search->peak. */
static const Model *read_formulas(Search *s, const Model *from, const Scene *scene, const char *text)
{
    const char *inside = formula_inside(s->pool, text, "maximum"), **formula = NULL;
    s->peak = inside;
    s->text = inside ? inside : text;
    for (const char *at = s->text, *end; at; at = *end ? end + 1 : NULL) {
        end = at + strcspn(at, ";");
        *POOL_PUSH(s->pool, formula, s->formulas) = pool_print(s->pool, "%.*s", (int)(end - at), at);
    }
    Model *model = NULL;
    for (int i = 0; i < s->formulas; ++i)
        from = model = formula_output(s->pool, from, option, pool_print(s->pool, "formula %d", i + 1), formula[i]);
    model = condition_outputs(s->pool, model, scene);
    formula_alone(s->pool, model, s->formulas + 2 * condition_count(scene));
    s->formula = formula;
    return model;
}

/* A word NAME=LOW:HIGH. */
typedef struct Range {
    const char *name;
    double low, high;
} Range;

static Range read_range(Pool *pool, const char *word)
{
    const char *equals = strchr(word, '=');
    char *end = NULL;
    Range range = {.name = equals ? pool_print(pool, "%.*s", (int)(equals - word), word) : word};
    if (equals)
        range.low = strtod(equals + 1, &end);
    bool good = end && end > equals + 1 && *end == ':';
    if (good) {
        const char *second = end + 1;
        range.high = strtod(second, &end);
        good = end > second && !*end && isfinite(range.low) && isfinite(range.high) && range.low < range.high;
    }
    if (!good)
        diag_fail_call(program_place(), "write a name and its bounds: parameter/k=100:200",
                       "'%s' does not tell between which numbers it is", word);
    return range;
}

/* Variables, their bounds and their values. */
static void find_ranges(Search *s, const Scene *scene, const Request *request)
{
    const int count = request->keys;
    if (count == 0)
        diag_fail_call(program_place(), "parameter/NAME=LOW:HIGH, for one, after the scene",
                       "optimization needs names of what may change");
    Range *range = pool_alloc(s->pool, (size_t)count * sizeof *range);
    const char **name = pool_alloc(s->pool, (size_t)count * sizeof *name);
    for (int i = 0; i < count; ++i) {
        range[i] = read_range(s->pool, request->key[i]);
        name[i] = range[i].name;
    }
    s->run = tangent_open(s->pool, s->model, scene, request->solve, name, count);
    s->variables = tangent_variables(s->run, &s->variable);
    s->low = pool_alloc(s->pool, (size_t)s->variables * sizeof *s->low);
    s->high = pool_alloc(s->pool, (size_t)s->variables * sizeof *s->high);
    s->x = pool_alloc(s->pool, (size_t)s->variables * sizeof *s->x);
    for (int k = 0; k < s->variables; ++k) {
        const RunVariable *v = &s->variable[k];
        int found = 0;
        for (int i = 0; i < count; ++i)
            if (!strcmp(name[i], v->name)) {
                ++found;
                s->low[k] = range[i].low;
                s->high[k] = range[i].high;
            }
        if (found != 1 || s->variables != count)
            diag_fail_call(program_place(), "each number has a name and bounds of its own, once",
                           found > 1 ? "'%s' is there twice" : "'%s' has no bounds", v->name);
        if (!(v->value >= s->low[k] && v->value <= s->high[k]))
            diag_fail_call(program_place(), "change the bounds, or the number in the scene",
                           "%s begins with %.9g %s, which is not between its bounds", v->name, v->value, v->unit);
        s->x[k] = v->value;
    }
}

static Search open(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Search s = {.pool = pool};
    condition_no_end(scene, option);
    s.model = read_formulas(&s, model, scene, request->formula);
    scene = equilibrium_start(pool, model, scene, request->solve);
    s.scene = scene_with_numbers(pool, s.model, scene);
    s.running = scene_with_numbers(pool, s.model, scene);
    find_ranges(&s, s.scene, request);
    number_places_check(s.model, s.scene, s.variable, s.variables, "optimization");
    s.times = (int)scene->outputs + 1;
    const size_t rows = (size_t)(s.times * s.formulas);
    s.time = pool_alloc(pool, (size_t)s.times * sizeof *s.time);
    s.rest = pool_alloc(pool, rows * sizeof *s.rest);
    s.start = pool_alloc(pool, rows * sizeof *s.start);
    s.jacobian = pool_alloc(pool, rows * (size_t)s.variables * sizeof *s.jacobian);
    return s;
}

/* ---- the search ------------------------------------------------------------------------------------------- */

double optimize_size(const Search *s, const double *rest)
{
    double square = 0, largest = 0;
    const int count = s->times * s->formulas;
    for (int i = 0; i < count; ++i) {
        square += rest[i] * rest[i] / count;
        largest = fmax(largest, fabs(rest[i]));
    }
    return s->peak ? largest : sqrt(square);
}

/* A largest magnitude by powers of higher and higher order. False: it still moves. */
static bool search(Search *s)
{
    bool there = optimize_least(s, 2, s->peak ? PEAK_RUNS : MOST_RUNS);
    for (int order = 4; s->peak && order <= LAST_ORDER; order *= 4)
        there = optimize_least(s, order, order < LAST_ORDER ? PEAK_RUNS : MOST_RUNS);
    return there;
}

/* ---- results ------------------------------------------------------------------------------------------------ */

static void write_csv(const Search *s, const char *path)
{
    static const char *const column[] = {"variable", "unit", "start", "value", "low", "high"};
    interrupt_hold();
    Csv csv = csv_open(s->pool, path);
    for (size_t i = 0; i < sizeof column / sizeof *column; ++i)
        csv_name(&csv, column[i], NULL);
    csv_end_row(&csv);
    csv_name(&csv, "", NULL);
    csv_text(&csv, NULL);
    csv_number(&csv, optimize_size(s, s->start));
    csv_number(&csv, optimize_size(s, s->rest));
    csv_text(&csv, NULL);
    csv_text(&csv, NULL);
    csv_end_row(&csv);
    for (int k = 0; k < s->variables; ++k) {
        csv_name(&csv, s->variable[k].name, NULL);
        csv_name(&csv, s->variable[k].unit, NULL);
        csv_number(&csv, s->variable[k].value);
        csv_number(&csv, s->x[k]);
        csv_number(&csv, s->low[k]);
        csv_number(&csv, s->high[k]);
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

static void write_page(const Search *s, const char *number, const char *path)
{
    Pool *pool = s->pool;
    const int times = s->times;
    FitPage page = {.name = s->model->name,
                    .number = number,
                    .curve = {"found", "start"},
                    .panels = s->formulas,
                    .column = {"start", "value", "low", "high"},
                    .variables = s->variables,
                    .variable = s->variable};
    Panel *panel = pool_alloc(pool, (size_t)s->formulas * sizeof *panel);
    double *cell = pool_alloc(pool, 4 * (size_t)s->variables * sizeof *cell);
    page.panel = panel;
    page.cell = cell;
    for (int f = 0; f < s->formulas; ++f) {
        double *y = pool_alloc(pool, 2 * (size_t)times * sizeof *y);
        for (int t = 0; t < times; ++t) {
            y[t] = s->rest[t * s->formulas + f];
            y[times + t] = s->start[t * s->formulas + f];
        }
        Text title = {.pool = pool};
        text_html(&title, s->formula[f]);
        panel[f] = (Panel){
            .title = title.s, .unit = "1", .below = "time, s", .rows = times, .curves = 2, .x = s->time, .y = y};
    }
    for (int k = 0; k < s->variables; ++k) {
        const double number_of[] = {s->variable[k].value, s->x[k], s->low[k], s->high[k]};
        memcpy(cell + 4 * k, number_of, sizeof number_of);
    }
    fit_page_write(pool, &page, path);
}

static void print(const Search *s, const char *number)
{
    Text text = {.pool = s->pool}, *out = &text;
    text_print(out, "%s: %s\n\n", s->model->name, number);
    text_print(out, "%-32s  %14s  %14s  %14s  %14s\n", "variable", "start", "value", "low", "high");
    for (int k = 0; k < s->variables; ++k)
        text_print(out, "%-32s  %14.9g  %14.9g  %14.9g  %14.9g %s%s\n", s->variable[k].name, s->variable[k].value,
                   s->x[k], s->low[k], s->high[k], s->variable[k].unit,
                   s->x[k] <= s->low[k] || s->x[k] >= s->high[k] ? ", at a bound" : "");
    diag_text(text.s);
}

/* Where something is left that a number does not move at first, the search has had nothing to go by. */
static void warn_flat(const Search *s, Place at)
{
    const int rows = s->times * s->formulas;
    for (int k = 0; k < s->variables && optimize_size(s, s->rest) > 0; ++k) {
        double most = 0;
        for (int i = 0; i < rows; ++i)
            most = fmax(most, fabs(s->jacobian[i * s->variables + k]));
        if (most * (s->high[k] - s->low[k]) <= 0)
            diag_warn(at, "give it another value in the scene to begin with, or leave it out",
                      "%s does not move the formulas at %.9g: it has no influence, or a largest value is there",
                      s->variable[k].name, s->x[k]);
    }
}

void optimize_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Search s = open(pool, model, scene, request);
    if (optimize_run(&s, s.x, s.rest, s.jacobian) != GIC_OK)
        tangent_fail(s.run, s.status);
    memcpy(s.start, s.rest, (size_t)(s.times * s.formulas) * sizeof *s.start);
    gsl_errors_return();
    if (!search(&s))
        diag_warn((Place){scene->source, 0, 0}, "begin with the numbers that it found, or with narrower bounds",
                  "after %d runs the numbers still move", s.runs);
    warn_flat(&s, (Place){scene->source, 0, 0});
    const char *number =
        pool_print(pool, "%s of %s from %.6g to %.6g, in %d runs", s.peak ? "largest magnitude" : "root mean square",
                   s.text, optimize_size(&s, s.start), optimize_size(&s, s.rest), s.runs);
    if (request->results && path_ends(request->results, ".html"))
        write_page(&s, number, request->results);
    else if (request->results)
        write_csv(&s, request->results);
    if (!request->results || strcmp(request->results, "-") != 0)
        print(&s, number);
}
