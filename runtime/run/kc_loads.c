/* SPDX-License-Identifier: MIT
 * Compliance of an axle: how its wheels give way to loads at contacts and hubs, as springs, stops, formulas and
 * bushings let them. The heights of the contacts are held, as by the pads of a rig, with forces F_i; coordinates w_a
 * that are free and move the wheels take their places. With the generalized forces Q_e and values x_e of elements,
 * heights z_i and loads L of places p sum_e Q_e dx_e/dw_a + sum_i F_i dz_i/dw_a + L dp/dw_a = 0    for all a,    z_i
 * held. Newton's method finds the place without loads, and the derivative by L follows from the same matrix (implicit
 * function theorem), which has the exact second derivatives of x_e and z_i in it. */
#include "base/text.h"
#include "base/vec3.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/kc.h"
#include "run/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST = KC_COLUMNS + KC_WHEELS, NEWTON_MOST = 30 };

const char *const kc_load_name[KC_LOADS] = {"lateral",          "longitudinal", "aligning",    "vertical",
                                            "hub_longitudinal", "hub_lateral",  "hub_vertical"};

typedef struct Rig {
    const Kc *kc;
    const KcAxle *axle;
    KcLook *look;
    double *w;
    int m, n;                /* coordinates that move, wheels */
    double force[KC_WHEELS]; /* at the contacts */
    double z[KC_WHEELS];     /* heights that are held */
    double A[MOST * MOST];   /* rows and columns: coordinates, then forces */
    double missing[MOST];
    KcPose pose[KC_WHEELS], by[KC_COLUMNS][KC_WHEELS];
} Rig;

/* The coordinates of the look: travel, then others that are free and move a wheel. */
static KcLook *columns_of(const Kc *kc, const KcAxle *axle)
{
    KcAxle all = {.steer = -1};
    KcLook *look = kc_look_new(kc, &all);
    for (int i = 0; i < axle->wheels; ++i)
        look->column[look->columns++] = axle->travel[i];
    for (int c = 0; c < kc->model->coordinates && look->columns < KC_COLUMNS; ++c) {
        bool moves = false, is_there = kc->model->coordinate[c].driven;
        for (int i = 0; i < axle->wheels; ++i)
            is_there = is_there || axle->travel[i] == c;
        if (is_there)
            continue;
        KcLook *one = kc_look_new(kc, &(KcAxle){.steer = c});
        if (kc_look(kc, kc->initial, one) != GIC_OK)
            continue;
        for (int i = 0; i < axle->wheels; ++i)
            moves =
                moves || norm3(one->slope + axle->wheel[i].velocity) + norm3(one->slope + axle->wheel[i].turn) > 1e-9;
        if (moves)
            look->column[look->columns++] = c;
    }
    look->slope = pool_alloc(kc->pool, ((size_t)kc->outputs * (size_t)look->columns + 1) * sizeof(double));
    return look;
}

/* Residual and matrix at the rig's place. Returns a status. */
static int evaluate_rig(Rig *rig)
{
    const Kc *kc = rig->kc;
    const int m = rig->m, n = rig->n, all = m + n;
    int status = kc_look(kc, rig->w, rig->look);
    memset(rig->A, 0, sizeof rig->A);
    memset(rig->missing, 0, sizeof rig->missing);
    for (int i = 0; i < n && status == GIC_OK; ++i) {
        kc_pose(&rig->axle->wheel[i], rig->look, &rig->pose[i]);
        rig->missing[m + i] = rig->z[i] - rig->pose[i].contact[2];
    }
    for (int a = 0; a < m && status == GIC_OK; ++a) {
        double unit[KC_COLUMNS] = {0};
        unit[a] = 1;
        for (int i = 0; i < n; ++i) {
            kc_rate(&rig->axle->wheel[i], rig->look, &rig->pose[i], unit, &rig->by[a][i]);
            rig->A[a * all + m + i] = rig->A[(m + i) * all + a] = rig->by[a][i].contact[2];
            rig->missing[a] -= rig->force[i] * rig->by[a][i].contact[2];
        }
        for (int e = 0; e < kc->elements; ++e)
            rig->missing[a] -= kc->element[e].sign * rig->look->value[kc->element[e].force] *
                               kc_element_slope(&kc->element[e], rig->look, a);
        rig->missing[a] -= kc_rubber_force(kc, rig->look, a);
    }
    double *second = pool_alloc(kc->pool, ((size_t)m * (size_t)kc->outputs + 1) * sizeof *second);
    for (int b = 0; b < m && status == GIC_OK; ++b) {
        double unit[KC_COLUMNS] = {0};
        unit[b] = 1;
        status = kc_look_second(kc, rig->w, rig->look, unit, second);
        for (int a = 0; a < m && status == GIC_OK; ++a) {
            const double *by_a = second + a * kc->outputs;
            for (int e = 0; e < kc->elements; ++e) {
                const KcElement *element = &kc->element[e];
                rig->A[a * all + b] +=
                    element->sign *
                    (rig->look->slope[b * kc->outputs + element->force] * kc_element_slope(element, rig->look, a) +
                     rig->look->value[element->force] * (element->coordinate >= 0 ? 0 : by_a[element->rate]));
            }
            rig->A[a * all + b] += kc_rubber_slope(kc, rig->look, a, b, by_a);
            for (int i = 0; i < n; ++i)
                rig->A[a * all + b] +=
                    rig->force[i] * kc_contact_bend(&rig->axle->wheel[i], &rig->pose[i], &rig->by[b][i], &rig->by[a][i],
                                                    by_a + rig->axle->wheel[i].velocity,
                                                    by_a + rig->axle->wheel[i].turn);
        }
    }
    return status;
}

/* Find the place without loads. NULL: it is there, else why not. */
static const char *settle(Rig *rig)
{
    const int all = rig->m + rig->n;
    double before = INFINITY;
    for (int step = 0; step < NEWTON_MOST; ++step) {
        double most = 0, A[MOST * MOST];
        const int status = evaluate_rig(rig);
        if (status != GIC_OK)
            return kc_status(rig->kc, status);
        double change[MOST];
        memcpy(A, rig->A, sizeof A);
        memcpy(change, rig->missing, sizeof change);
        if (!kc_solve(all, A, change))
            return "nothing holds a coordinate that moves its wheels";
        for (int a = 0; a < rig->m; ++a) {
            const Coordinate *c = &rig->kc->model->coordinate[rig->look->column[a]];
            most = fmax(most, fabs(change[a]) / (c->range[1] - c->range[0]));
        }
        if (step > 0 && (most < 1e-14 || (most < 1e-11 && most >= before))) /* forces are there after the first step */
            return NULL;
        before = most;
        for (int a = 0; a < rig->m; ++a)
            rig->w[rig->look->column[a]] += change[a];
        for (int i = 0; i < rig->n; ++i)
            rig->force[i] += change[rig->m + i];
    }
    return "its springs and the forces of the road do not balance near where it is set up";
}

/* The power of a unit load on wheel i while coordinate a moves with the rate 1. */
static double power(const Rig *rig, KcLoad load, int i, int a)
{
    const KcPose *by = &rig->by[a][i];
    switch (load) {
    case KC_LATERAL: return by->locked[1];
    case KC_LONGITUDINAL: return by->locked[0];
    case KC_ALIGNING: return by->turn[2];
    case KC_VERTICAL: return by->contact[2];
    case KC_HUB_LATERAL: return by->centre[1];
    case KC_HUB_VERTICAL: return by->centre[2];
    default: return by->centre[0];
    }
}

const char *kc_compliance(const Kc *kc, const KcAxle *axle, KcLoad load, bool opposed, KcGive *give)
{
    Rig *rig = pool_alloc(kc->pool, sizeof *rig);
    if (axle->refusal)
        return axle->refusal;
    if (kc_rubber_formula(kc))
        return pool_print(kc->pool, "bushing '%s' has a formula, of which no stiffness is known",
                          kc_rubber_formula(kc));
    *rig = (Rig){.kc = kc, .axle = axle, .look = columns_of(kc, axle), .n = axle->wheels};
    rig->m = rig->look->columns;
    rig->w = pool_alloc(kc->pool, (size_t)kc->model->coordinates * sizeof *rig->w);
    memcpy(rig->w, kc->initial, (size_t)kc->model->coordinates * sizeof *rig->w);
    const int status = kc_look(kc, rig->w, rig->look);
    if (status != GIC_OK)
        return kc_status(kc, status);
    for (int i = 0; i < rig->n; ++i) {
        kc_pose(&axle->wheel[i], rig->look, &rig->pose[i]);
        rig->z[i] = rig->pose[i].contact[2];
    }
    const char *why = settle(rig);
    if (why)
        return why;
    const bool floats = load == KC_VERTICAL || load == KC_HUB_VERTICAL; /* pads: their forces are given, not heights */
    double change[MOST] = {0}, along[KC_COLUMNS] = {0};
    for (int a = 0; a < rig->m; ++a)
        for (int i = 0; i < rig->n; ++i) {
            change[a] -= (opposed ? axle->wheel[i].side : 1) * power(rig, load, i, a);
            if (floats)
                rig->A[a * (rig->m + rig->n) + rig->m + i] = 0;
        }
    for (int i = 0; i < rig->n && floats; ++i) {
        double *row = rig->A + (rig->m + i) * (rig->m + rig->n);
        memset(row, 0, (size_t)rig->m * sizeof *row);
        row[rig->m + i] = 1;
        change[rig->m + i] = load == KC_HUB_VERTICAL ? 0 : opposed ? axle->wheel[i].side : 1;
    }
    if (!kc_solve(rig->m + rig->n, rig->A, change))
        return "nothing holds a coordinate that moves its wheels";
    memcpy(along, change, (size_t)rig->m * sizeof *along);
    for (int i = 0; i < rig->n; ++i) {
        KcPose rate;
        kc_rate(&axle->wheel[i], rig->look, &rig->pose[i], along, &rate);
        give[i] = (KcGive){.steer = kc_steer_rate(&rig->pose[i], &rate),
                           .camber = kc_camber_rate(&axle->wheel[i], &rig->pose[i], &rate),
                           .turn = rate.turn[2],
                           .force = change[rig->m + i]};
        give[i].toe = -axle->wheel[i].side * give[i].steer;
        memcpy(give[i].contact, rate.locked, sizeof give[i].contact);
        memcpy(give[i].centre, rate.centre, sizeof give[i].centre);
    }
    return NULL;
}

/* ---- CSV and table -------------------------------------------------------------------------------------- */

static const char *unit_of(KcLoad load)
{
    return load == KC_ALIGNING ? "N m" : "N";
}

void kc_loads_csv(Pool *pool, const Kc *kc, const char *path)
{
    static const char *const column[] = {"axle",     "load",     "opposed",  "wheel",     "unit",      "steer",
                                         "toe",      "camber",   "turn",     "contact_x", "contact_y", "contact_z",
                                         "centre_x", "centre_y", "centre_z", "force"};
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    for (size_t i = 0; i < sizeof column / sizeof *column; ++i)
        csv_name(&csv, column[i], NULL);
    csv_end_row(&csv);
    for (int a = 0; a < kc->axles; ++a)
        for (int k = 0; k < 2 * KC_LOADS; ++k) {
            KcGive give[KC_WHEELS];
            if (kc_compliance(kc, &kc->axle[a], (KcLoad)(k / 2), k % 2, give))
                continue;
            for (int i = 0; i < kc->axle[a].wheels; ++i) {
                const double number[] = {give[i].steer,      give[i].toe,        give[i].camber,     give[i].turn,
                                         give[i].contact[0], give[i].contact[1], give[i].contact[2], give[i].centre[0],
                                         give[i].centre[1],  give[i].centre[2],  give[i].force};
                csv_name(&csv, kc->axle[a].name, NULL);
                csv_name(&csv, kc_load_name[k / 2], NULL);
                csv_number(&csv, k % 2);
                csv_name(&csv, kc->axle[a].wheel[i].name, NULL);
                csv_name(&csv, unit_of((KcLoad)(k / 2)), NULL);
                for (size_t c = 0; c < sizeof number / sizeof *number; ++c)
                    csv_number(&csv, number[c] + 0.0);
                csv_end_row(&csv);
            }
        }
    csv_close(&csv);
    interrupt_release();
}

void kc_loads_print(Text *out, const Kc *kc, int a)
{
    Pool *pool = out->pool;
    const KcAxle *axle = &kc->axle[a];
    const double degrees = kc_of_wheel[KC_CAMBER].scale;
    KcGive give[KC_WHEELS];
    const char *why = kc_compliance(kc, axle, KC_LATERAL, false, give);
    if (why) {
        text_print(out, "  compliance: not there: %s\n", why);
        return;
    }
    text_print(out, "\n  %-34s%-16s %12s %12s %12s %12s %12s\n", "compliance by 1 kN or 100 N m", "wheel", "toe, deg",
               "camber, deg", "contact x mm", "contact y mm", "contact z mm");
    for (int k = 0; k < 2 * KC_LOADS; ++k) {
        const double unit = k / 2 == KC_ALIGNING ? 100 : 1000;
        const char *name = pool_print(pool, "%s%s", kc_load_name[k / 2], k % 2 ? ", opposed" : "");
        const char *not_there = kc_compliance(kc, axle, (KcLoad)(k / 2), k % 2, give);
        if (not_there)
            text_print(out, "  %s: %s\n", name, not_there);
        for (int i = 0; i < axle->wheels && !not_there; ++i)
            text_print(out, "  %-34s%-16s %12s %12s %12s %12s %12s\n", i ? "" : name, axle->wheel[i].name,
                       kc_shown(pool, give[i].toe, degrees * unit), kc_shown(pool, give[i].camber, degrees * unit),
                       kc_shown(pool, give[i].contact[0], 1e3 * unit), kc_shown(pool, give[i].contact[1], 1e3 * unit),
                       kc_shown(pool, give[i].contact[2], 1e3 * unit));
    }
}

Sheet kc_loads_sheet(Pool *pool, const Model *model, const Kc *kc)
{
    static const char *const column[] = {"toe", "camber", "contact_x", "contact_y", "contact_z"};
    static const char *const title[] = {"toe", "camber", "contact x", "contact y", "contact z"};
    enum { COLUMNS = sizeof column / sizeof *column, ANGLES = 2 };
    Sheet sheet = {.pool = pool, .model = model};
    for (int a = 0; a < kc->axles; ++a)
        for (int k = 0; k < 2 * KC_LOADS; ++k) {
            const KcAxle *axle = &kc->axle[a];
            const char *by = pool_print(pool, "%s%s", kc_load_name[k / 2], k % 2 ? ".opposed" : "");
            const char *unit = unit_of((KcLoad)(k / 2)), *section = k ? NULL : pool_print(pool, "Axle: %s", axle->name);
            KcGive give[KC_WHEELS];
            if (kc_compliance(kc, axle, (KcLoad)(k / 2), k % 2, give))
                continue;
            for (int i = 0; i < axle->wheels; ++i) {
                const double number[COLUMNS] = {give[i].toe, give[i].camber, give[i].contact[0], give[i].contact[1],
                                                give[i].contact[2]};
                for (int c = 0; c < COLUMNS; ++c) {
                    sheet_add(&sheet, section, pool_print(pool, "%s.%s.%s", axle->wheel[i].name, by, column[c]),
                              pool_print(pool, "%s%s: %s, %s", kc_load_name[k / 2], k % 2 ? ", opposed" : "", title[c],
                                         axle->wheel[i].name),
                              pool_print(pool, strcmp(unit, "N") ? "%s/(%s)" : "%s/%s", c < ANGLES ? "rad" : "m", unit),
                              number[c]);
                    sheet_place(&sheet, axle, i, pool_print(pool, "%s.%s", by, column[c]));
                    section = NULL;
                }
            }
        }
    return sheet;
}
