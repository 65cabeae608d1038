/* SPDX-License-Identifier: MIT
 * --sheet: all of it in order; a table for people, CSV or a page. */
#include "base/file.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/manoeuvre.h"
#include "run/sheet.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Units and those in which people read them. */
static const struct {
    const char *unit, *shown;
    double scale;
} of_unit[] = {{"rad", "deg", 57.29577951308232},
               {"rad/m", "deg/m", 57.29577951308232},
               {"rad s^2/m", "deg/g", 57.29577951308232 * 9.80665},
               {"m", "mm", 1e3},
               {"1/m", "1/km", 1e3},
               {"N/m", "N/mm", 1e-3},
               {"N m/rad", "N m/deg", 0.017453292519943295},
               {"rad/N", "deg/kN", 57295.77951308232},
               {"m/N", "mm/kN", 1e6},
               {"rad/(N m)", "deg/kN m", 57295.77951308232},
               {"m/(N m)", "mm/kN m", 1e6}};

void sheet_add(Sheet *sheet, const char *section, const char *name, const char *title, const char *unit, double value)
{
    SheetRow row = {section, name, title, unit, unit, 1, value + 0.0, NAN, NULL, 0};
    for (size_t i = 0; i < sizeof of_unit / sizeof *of_unit; ++i)
        if (!strcmp(unit, of_unit[i].unit)) {
            row.shown = of_unit[i].shown;
            row.scale = of_unit[i].scale;
        }
    *POOL_PUSH(sheet->pool, sheet->row, sheet->rows) = row;
}

void sheet_add_way(Sheet *sheet, const char *section, const char *name, const char *title, double value)
{
    *POOL_PUSH(sheet->pool, sheet->row, sheet->rows) =
        (SheetRow){section, name, title, "m", "m", 1, value + 0.0, NAN, NULL, 0};
}

void sheet_note(Sheet *sheet, const char *note)
{
    *POOL_PUSH(sheet->pool, sheet->note, sheet->notes) = note;
}

void sheet_miss(Sheet *sheet, const char *what)
{
    sheet_note(sheet, pool_print(sheet->pool, "not there: %s", what));
}

/* In motion where wheels have tires, whose grip at rest is another one. */
static const double of_modes = 20; /* m/s */

static void find_modes(Sheet *sheet)
{
    const Equilibrium *found = sheet->found;
    const size_t count = (size_t)found->linear->count;
    Instance *self = (Instance *)(void *)instance_new(sheet->pool, found->engine);
    double *f = pool_alloc(sheet->pool, count * sizeof *f), *A = pool_alloc(sheet->pool, count * count * sizeof *A);
    sheet->speed = found->linear->of_wheels ? of_modes : 0;
    memcpy(self, found->self, found->engine->code->size);
    int status = sheet->speed > 0 ? sheet_set_in_motion(sheet, self, sheet->speed) : GIC_OK;
    if (status == GIC_OK)
        status = linearize(found->linear, self, f, A);
    if (status == GIC_OK)
        sheet->modes = modes_try(sheet->pool, found->linear, A);
    if (!sheet->modes)
        sheet_miss(sheet, "small motions: no eigenvalues were found");
}

/* Eigenvalues, as numbers with names. */
static void add_modes(Sheet *sheet)
{
    for (int k = 0; sheet->modes && k < sheet->modes->count; ++k) {
        const Mode *mode = &sheet->modes->mode[k];
        const double size = hypot(mode->real, mode->imaginary);
        const char *name = pool_print(sheet->pool, "mode_%d", k + 1);
        const char *section = k ? NULL : pool_print(sheet->pool, "Small motions at %g m/s", sheet->speed);
        if (mode->imaginary > 0) {
            sheet_add(sheet, section, pool_print(sheet->pool, "%s.frequency", name),
                      pool_print(sheet->pool, "Frequency %d", k + 1), "Hz", size / (2 * 3.141592653589793));
            sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.damping", name),
                      pool_print(sheet->pool, "Damping %d", k + 1), "1", -mode->real / size);
        } else {
            sheet_add(sheet, section, pool_print(sheet->pool, "%s.eigenvalue", name),
                      pool_print(sheet->pool, "Eigenvalue %d", k + 1), "1/s", mode->real);
        }
        for (int i = mode->imaginary > 0 ? 2 : 1; i > 0; --i)
            sheet->row[sheet->rows - i].mode = k + 1;
    }
}

void sheet_csv(const Sheet *sheet, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(sheet->pool, path);
    csv_name(&csv, "quantity", NULL);
    csv_name(&csv, "value", NULL);
    csv_name(&csv, "unit", NULL);
    if (sheet->other) {
        csv_name(&csv, "other", NULL);
        csv_name(&csv, "difference", NULL);
    }
    csv_end_row(&csv);
    for (int i = 0; i < sheet->rows; ++i) {
        csv_name(&csv, sheet->row[i].name, NULL);
        if (isnan(sheet->row[i].value)) /* only the other one has it */
            csv_text(&csv, NULL);
        else
            csv_number(&csv, sheet->row[i].value);
        csv_name(&csv, sheet->row[i].unit, NULL);
        if (sheet->other && isnan(sheet->row[i].other)) {
            csv_text(&csv, NULL);
            csv_text(&csv, NULL);
        } else if (sheet->other) {
            csv_number(&csv, sheet->row[i].other);
            if (isfinite(sheet->row[i].other - sheet->row[i].value))
                csv_number(&csv, sheet->row[i].other - sheet->row[i].value);
            else
                csv_text(&csv, NULL);
        }
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

void sheet_print(const Sheet *sheet, const char *title)
{
    Text text = {.pool = sheet->pool}, *out = &text;
    text_print(out, "%s%s%s%s\n", sheet->model->name, sheet->other ? " and " : "", sheet->other ? sheet->other : "",
               title);
    for (int i = 0; i < sheet->rows; ++i) {
        const SheetRow *row = &sheet->row[i];
        if (row->section)
            text_print(out, "\n%s\n", row->section);
        text_print(out, "  %-60s%-9s %14s", row->title, row->shown, kc_shown(sheet->pool, row->value, row->scale));
        if (sheet->other)
            text_print(out, " %14s%s", kc_shown(sheet->pool, row->other, row->scale), sheet_differs(row) ? " *" : "");
        text_print(out, "\n");
    }
    diag_text(text.s);
}

Sheet sheet_open(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    if (!model->free_base || !model->wheels)
        diag_fail((Place){model->source, 0, 0}, "name a vehicle: a model with a free base and wheels",
                  "model '%s' has no %s", model->name, model->wheels ? "free base" : "wheels");
    Sheet sheet = {.pool = pool, .model = model, .kc = kc_open(pool, model, scene, solve, NULL)};
    sheet.found = equilibrium_find_locked(pool, model, scene, solve);
    const double lean = equilibrium_lean(sheet.found);
    if (lean > equilibrium_tipped)
        diag_fail((Place){scene ? scene->source : model->source, 0, 0},
                  "bring the centre of mass between the wheels (`com`, `center`), or start the vehicle nearer to where "
                  "it stands; --equilibrium shows how it lies there",
                  "the vehicle does not rest on its wheels: it tips over and lies there leaning by %.0f degrees",
                  57.29577951308232 * lean);
    const gic_model *code = sheet.found->engine->code;
    sheet.w = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof *sheet.w);
    for (int c = 0; c < model->coordinates; ++c)
        sheet.w[c] = code->coordinate_state[c] >= 0
                         ? tape_array(sheet.found->self, code->state_offset)[code->coordinate_state[c]]
                         : tape_array(sheet.found->self, code->input_offset)[code->coordinate_input[c]];
    sheet_rest(&sheet);
    return sheet;
}

void sheet_notes(const Sheet *sheet, const Request *request)
{
    Pool *pool = sheet->pool;
    for (int i = 0; i < sheet->notes; ++i)
        if (!request->results)
            diag_text(pool_print(pool, "%s%s\n", i ? "" : "\n", sheet->note[i]));
        else if (!request->quiet)
            diag_note(pool_print(pool, "%s: note: %s\n", program_place().source->path, sheet->note[i]));
}

/* On a level road, as the model is set up. */
static void add_top_speed(Sheet *sheet, const Model *model, const Request *request)
{
    const char *why = NULL;
    double speed = NAN;
    for (int w = 0; w < model->wheels && !why; ++w)
        if (model->wheel[w].tire < 0)
            why = "a wheel has no tire";
    if (!why) {
        TestCar *car = car_open(sheet->pool, model, request);
        speed = manoeuvre_top_speed(car, &why);
        engine_rest(car->engine);
        engine_close(car->engine);
    }
    if (why)
        sheet_miss(sheet, pool_print(sheet->pool, "top speed: %s", why));
    else
        sheet_add(sheet, "Straight ahead", "top_speed", "Top speed, whole accelerator", "m/s", speed);
}

Sheet sheet_study(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Sheet sheet = sheet_open(pool, model, scene, request->solve);
    kc_warn(sheet.kc);
    if (!request->quiet)
        equilibrium_warn_ranges(sheet.found, (Place){scene ? scene->source : model->source, 0, 0});
    find_modes(&sheet);
    add_modes(&sheet);
    sheet_cornering(&sheet);
    if (fabs(fabs(model->body[BODY_BASE].euler[0]) - 1) <= equilibrium_limit)
        add_top_speed(&sheet, scene ? sheet_set(pool, model, scene) : model, request);
    else
        sheet_miss(&sheet, "top speed: the axes of the base are not those of the drawing");
    return sheet;
}

void sheet_beside(Sheet *sheet, const Sheet *other, const char *name, const char *results, const char *about)
{
    sheet_compare(sheet, other, name);
    if (results)
        sheet_csv(sheet, results);
    else
        sheet_print(sheet, about);
}

void sheet_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Sheet sheet = sheet_study(pool, model, scene, request);
    if (request->compare) {
        const char *name;
        SheetShapes *known = sheet_shapes(pool);
        Sheet other = sheet_study(pool, sheet_other(pool, model, request->compare, &name), NULL, request);
        sheet_follow_modes(&sheet, known);
        sheet_match_modes(&sheet, &other, known);
        sheet_compare(&sheet, &other, name);
    }
    if (request->results && path_ends(request->results, ".html"))
        sheet_page(&sheet, request->results);
    else if (request->results)
        sheet_csv(&sheet, request->results);
    else
        sheet_print(&sheet, ", models/SHEET.md defines these");
    sheet_notes(&sheet, request);
}
