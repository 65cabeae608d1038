/* SPDX-License-Identifier: MIT
 * --kc: all axles in all motions; a table for people at the position of set-up, or a CSV, or a page; and what can not
 * be moved, or stops before it is where it was to go. */
#include "base/file.h"
#include "base/text.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/kc.h"
#include "run/kc_joints.h"
#include "run/sheet.h"

#include <math.h>
#include <string.h>

KcStudy kc_study(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Kc *kc = kc_open(pool, model, scene, request->solve, request->axle);
    KcStudy study = {.kc = kc, .travel = request->travel > 0 ? request->travel : kc_usual_travel};
    if (!request->joints)
        kc_warn(kc);
    study.curve = pool_alloc(pool, (size_t)kc->axles * sizeof *study.curve);
    study.refusal = pool_alloc(pool, (size_t)kc->axles * sizeof *study.refusal);
    for (int a = 0; a < kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            study.curve[a][m] = kc_sweep(kc, &kc->axle[a], m, study.travel, &study.refusal[a][m]);
    return study;
}

const double kc_usual_travel = 0.08;

const KcCurve *kc_first(const KcStudy *study, int axle)
{
    for (KcMotion m = 0; m < KC_MOTIONS; ++m)
        if (study->curve[axle][m])
            return study->curve[axle][m];
    return NULL;
}

/* ---- what stops ----------------------------------------------------------------------------------------- */

const char *kc_stop(Pool *pool, const KcStudy *study, int axle, KcMotion motion, int end)
{
    const KcAxle *of = &study->kc->axle[axle];
    const KcCurve *curve = study->curve[axle][motion];
    const char *how = kc_motion_name[motion];
    if (!curve)
        return end ? NULL : pool_print(pool, "%s, %s: not possible: %s", of->name, how, study->refusal[axle][motion]);
    if (!curve->stop[end])
        return NULL;
    const double at = curve->row[end ? curve->rows - 1 : 0].at;
    const char *names = "";
    for (int i = 0; i < of->wheels; ++i)
        names = pool_print(pool, "%s%s%s", names, i ? ", " : "", of->wheel[i].name);
    if (motion == KC_STEER)
        return pool_print(pool, "%s, %s: %s stop at %s = %.6g: %s", of->name, how, names,
                          study->kc->model->coordinate[of->steer].name, at, curve->stop[end]);
    return pool_print(pool, "%s, %s: %s stop at a travel of %+.2f mm%s: %s", of->name, how, names, 1e3 * at,
                      motion == KC_OPPOSITE ? " on the left" : "", curve->stop[end]);
}

void kc_tell_stops(Text *out, const KcStudy *study, const char *before)
{
    if (study->kc->units)
        text_print(out, "%s%s\n", before, study->kc->units);
    for (int a = 0; a < study->kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            for (int end = 0; end < 2; ++end) {
                const char *text = kc_stop(out->pool, study, a, m, end);
                if (text)
                    text_print(out, "%s%s\n", before, text);
            }
}

/* ---- a table for people --------------------------------------------------------------------------------- */

const char *kc_shown(Pool *pool, double value, double scale)
{
    if (isnan(value))
        return "-";
    if (isinf(value))
        return "parallel";
    const char *text = pool_print(pool, "%.4f", value * scale);
    return strcmp(text, "-0.0000") ? text : "0.0000";
}

/* The row of a quantity: of travel, or of steering where only that has a value. */
const KcRow *kc_zero(const KcStudy *study, int axle, int of_axle)
{
    const KcCurve *first = kc_first(study, axle), *steer = study->curve[axle][KC_STEER];
    const bool other = of_axle >= 0 && steer && isnan(first->row[first->zero].axle[of_axle]);
    return other ? &steer->row[steer->zero] : &first->row[first->zero];
}

const char *kc_shown_unit(const Kc *kc, const KcAxle *axle, int of_axle, double *scale)
{
    *scale = kc_of_axle[of_axle].scale;
    if (of_axle != KC_RATIO || strcmp(kc_unit(kc, axle, of_axle), "m/rad") != 0)
        return kc_of_axle[of_axle].shown;
    *scale = 1e3 / kc_of_wheel[KC_CAMBER].scale;
    return "mm/deg";
}

static void print_axle(Text *out, const KcStudy *study, int a)
{
    Pool *pool = out->pool;
    const Kc *kc = study->kc;
    const KcAxle *axle = &kc->axle[a];
    text_print(out, "\n%s\n", axle->name);
    if (!kc_first(study, a))
        return;
    const KcRow *row = kc_zero(study, a, -1);
    text_print(out, "  %-50s%-9s", "travel 0", "");
    for (int i = 0; i < axle->wheels; ++i)
        text_print(out, " %14s", axle->wheel[i].name);
    for (int q = 0; q < KC_OF_WHEEL; ++q) {
        if (isnan(row->wheel[0][q]))
            continue;
        text_print(out, "\n  %-50s%-9s", kc_of_wheel[q].title, kc_of_wheel[q].shown);
        for (int i = 0; i < axle->wheels; ++i)
            text_print(out, " %14s", kc_shown(pool, row->wheel[i][q], kc_of_wheel[q].scale));
    }
    for (int e = 0; e < kc->elements; ++e)
        if (kc_ratio_seen(kc, axle, row, e)) {
            text_print(out, "\n  %-50s%-9s", pool_print(pool, "Motion ratio of %s", kc->element[e].name),
                       kc->element[e].angle ? "rad/m" : "1");
            for (int i = 0; i < axle->wheels; ++i)
                text_print(out, " %14s", kc_shown(pool, row->ratio[i * kc->elements + e], 1));
        }
    text_print(out, "\n");
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        double scale;
        const char *unit = kc_shown_unit(kc, axle, q, &scale);
        const double value = kc_zero(study, a, q)->axle[q];
        if (!isnan(value))
            text_print(out, "  %-50s%-9s %14s\n", kc_of_axle[q].title, unit, kc_shown(pool, value, scale));
    }
}

/* ---- CSV ------------------------------------------------------------------------------------------------ */

bool kc_ratio_seen(const Kc *kc, const KcAxle *axle, const KcRow *row, int e)
{
    for (int i = 0; i < axle->wheels; ++i)
        if (fabs(row->ratio[i * kc->elements + e]) > 1e-9)
            return true;
    return false;
}

/* Is the steering coordinate of an axle the same as that of one before? */
static bool steer_again(const Kc *kc, int axle)
{
    for (int a = 0; a < axle; ++a)
        if (kc->axle[a].steer == kc->axle[axle].steer)
            return true;
    return kc->axle[axle].steer < 0;
}

static void cell(Csv *csv, double value)
{
    if (isnan(value))
        csv_text(csv, NULL);
    else
        csv_number(csv, value + 0.0);
}

static void write_names(Pool *pool, Csv *csv, const Kc *kc)
{
    csv_name(csv, "axle", NULL);
    csv_name(csv, "motion", NULL);
    csv_name(csv, "travel", "m");
    const KcAxle *steered = &kc->axle[0];
    for (int a = 0; a < kc->axles; ++a) {
        if (steered->steer < 0)
            steered = &kc->axle[a];
        if (!steer_again(kc, a)) {
            const Coordinate *c = &kc->model->coordinate[kc->axle[a].steer];
            csv_name(csv, c->name, c->type == COORDINATE_ANGLE ? "rad" : "m");
        }
    }
    for (int q = 0; q < KC_OF_AXLE; ++q)
        csv_name(csv, kc_of_axle[q].name, kc_unit(kc, steered, q));
    for (int a = 0; a < kc->axles; ++a)
        for (int i = 0; i < kc->axle[a].wheels; ++i) {
            const char *name = kc->axle[a].wheel[i].name;
            for (int q = 0; q < KC_OF_WHEEL; ++q)
                csv_name(csv, pool_print(pool, "%s.%s", name, kc_of_wheel[q].name), kc_of_wheel[q].unit);
            for (int e = 0; e < kc->elements; ++e)
                csv_name(csv, pool_print(pool, "%s.ratio.%s", name, kc->element[e].name),
                         kc->element[e].angle ? "rad/m" : "1");
        }
    csv_end_row(csv);
}

static void write_row(Csv *csv, const Kc *kc, int axle, KcMotion motion, const KcRow *row)
{
    csv_name(csv, kc->axle[axle].name, NULL);
    csv_name(csv, kc_motion_name[motion], NULL);
    cell(csv, motion == KC_STEER ? 0 : row->at);
    for (int a = 0; a < kc->axles; ++a)
        if (!steer_again(kc, a)) {
            const int steer = kc->axle[a].steer;
            cell(csv, steer != kc->axle[axle].steer ? NAN : motion == KC_STEER ? row->at : kc->initial[steer]);
        }
    for (int q = 0; q < KC_OF_AXLE; ++q)
        cell(csv, row->axle[q]);
    for (int a = 0; a < kc->axles; ++a)
        for (int i = 0; i < kc->axle[a].wheels; ++i) {
            for (int q = 0; q < KC_OF_WHEEL; ++q)
                cell(csv, a == axle ? row->wheel[i][q] : NAN);
            for (int e = 0; e < kc->elements; ++e)
                cell(csv, a == axle ? row->ratio[i * kc->elements + e] : NAN);
        }
    csv_end_row(csv);
}

static void write_csv(Pool *pool, const KcStudy *study, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    write_names(pool, &csv, study->kc);
    for (int a = 0; a < study->kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            for (int i = 0; study->curve[a][m] && i < study->curve[a][m]->rows; ++i)
                write_row(&csv, study->kc, a, m, &study->curve[a][m]->row[i]);
    csv_close(&csv);
    interrupt_release();
}

static void note_units(Pool *pool, const KcStudy *study, const Request *request)
{
    if (study->kc->units && !request->quiet)
        diag_note(pool_print(pool, "%s: note: %s: %s\n", program_place().source->path, study->kc->model->name,
                             study->kc->units));
}

const Kc *kc_loads_open(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Kc *kc = kc_open(pool, model, scene, request->solve, request->axle);
    const char *why = NULL, *first = NULL;
    bool gives = false;
    for (int a = 0; a < kc->axles; ++a) {
        KcGive give[KC_WHEELS];
        why = kc_compliance(kc, &kc->axle[a], KC_LATERAL, false, give);
        first = first ? first : why;
        gives = gives || !why;
    }
    if (!gives)
        diag_fail((Place){model->source, 0, 0}, "write what holds it as springs between points or along coordinates",
                  "no axle of model '%s' has a compliance: %s: %s", model->name, kc->axle[0].name, first);
    return kc;
}

/* --loads: compliance alone. */
static void report_loads(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Kc *kc = kc_loads_open(pool, model, scene, request);
    Sheet sheet = kc_loads_sheet(pool, model, kc);
    const Kc *kc_of_other = NULL;
    if (request->compare) {
        const char *name;
        const Model *model_of_other = sheet_other(pool, model, request->compare, &name);
        kc_of_other = kc_open(pool, model_of_other, NULL, request->solve, request->axle);
        const Sheet other = kc_loads_sheet(pool, model_of_other, kc_of_other);
        sheet_compare(&sheet, &other, name);
    }
    if (request->report)
        kc_loads_page(&sheet, (const Kc *const[2]){kc, kc_of_other}, request->report);
    if (request->results && request->compare)
        sheet_csv(&sheet, request->results);
    else if (request->results)
        kc_loads_csv(pool, kc, request->results);
    if (request->compare && !request->results && !request->report)
        sheet_print(&sheet, ": compliance, models/KC.md defines it");
    if (request->compare || request->results || request->report) {
        sheet_notes(&sheet, request);
        return;
    }
    Text table = {.pool = pool}, *out = &table;
    text_print(out, "compliance of %s, models/KC.md defines it\n", model->name);
    for (int a = 0; a < kc->axles; ++a) {
        text_print(out, "\n%s\n", kc->axle[a].name);
        kc_loads_print(out, kc, a);
    }
    diag_text(table.s);
}

void kc_must_move(const Model *model, const KcStudy *study)
{
    bool moves = false;
    for (int a = 0; a < study->kc->axles; ++a)
        moves = moves || kc_first(study, a);
    if (!moves)
        diag_fail((Place){model->source, 0, 0}, "give its wheels suspensions with coordinates",
                  "no axle of model '%s' can be moved: %s: %s", model->name, study->kc->axle[0].name,
                  study->refusal[0][KC_PARALLEL]);
}

void kc_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    if (request->loads) {
        report_loads(pool, model, scene, request);
        return;
    }
    if (request->joints) {
        kc_joints_report(pool, model, scene, request);
        return;
    }
    const KcStudy study = kc_study(pool, model, scene, request);
    kc_must_move(model, &study);
    if (request->compare) {
        const char *name;
        const Model *model_of_other = sheet_other(pool, model, request->compare, &name);
        const KcStudy other = kc_study(pool, model_of_other, NULL, request);
        note_units(pool, &study, request);
        note_units(pool, &other, request);
        kc_compare(pool, model, &study, &other, name, request);
        return;
    }
    if (request->results)
        write_csv(pool, &study, request->results);
    if (request->report)
        kc_page(pool, &study, request->report);
    Text text = {.pool = pool}, *out = &text;
    if (request->results || request->report) {
        kc_tell_stops(out, &study, pool_print(pool, "%s: note: ", program_place().source->path));
        if (text.s && !request->quiet)
            diag_note(text.s);
        return;
    }
    text_print(out, "kinematics of %s, models/KC.md defines them\n", model->name);
    for (int a = 0; a < study.kc->axles; ++a)
        print_axle(out, &study, a);
    text_print(out, "\n");
    kc_tell_stops(out, &study, "");
    diag_text(text.s);
}
