/* SPDX-License-Identifier: MIT
 * Compliance of an axle: how its wheels give way to loads at contacts and hubs, as springs, stops, formulas and
 * bushings let them (kc_balance.c). */
#include "base/text.h"
#include "host/host.h"
#include "run/kc_balance.h"
#include "run/sheet.h"

#include <string.h>

const char *const kc_load_name[KC_LOADS] = {"lateral",          "longitudinal", "aligning",    "vertical",
                                            "hub_longitudinal", "hub_lateral",  "hub_vertical"};

const char *kc_compliance(const Kc *kc, const KcAxle *axle, KcLoad load, bool opposed, KcGive *give)
{
    if (axle->refusal)
        return axle->refusal;
    if (kc_rubber_formula(kc))
        return pool_print(kc->pool, "bushing '%s' has a formula, of which no stiffness is known",
                          kc_rubber_formula(kc));
    KcBalance *rig = kc_balance_new(kc, axle, true, -1);
    double change[KC_BALANCE], along[KC_COLUMNS] = {0};
    const char *why = kc_balance_at(rig, kc->initial);
    if (!why)
        why = kc_balance_give(rig, load, opposed, load == KC_VERTICAL || load == KC_HUB_VERTICAL, change);
    if (why)
        return why;
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
            const char *why = kc_compliance(kc, axle, (KcLoad)(k / 2), k % 2, give);
            if (why && !k)
                sheet_miss(&sheet, pool_print(pool, "compliance of axle %s: %s", axle->name, why));
            if (why)
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
                    sheet_place(&sheet, axle, i, 0, pool_print(pool, "%s.%s", by, column[c]));
                    section = NULL;
                }
            }
        }
    return sheet;
}
