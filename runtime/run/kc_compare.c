/* SPDX-License-Identifier: MIT
 * --kc --compare: what --kc prints at the position of set-up, of two vehicles side by side. */
#include "read/read.h"
#include "run/kc.h"
#include "run/sheet.h"

#include <math.h>

static void add_axle(Sheet *sheet, const KcStudy *study, int a)
{
    const Kc *kc = study->kc;
    const KcAxle *axle = &kc->axle[a];
    const KcRow *row = kc_zero(study, a, -1);
    const char *section = pool_print(sheet->pool, "Axle: %s", axle->name);
    for (int q = 0; q < KC_OF_WHEEL; ++q)
        for (int i = 0; i < axle->wheels && q != KC_TRAVEL; ++i)
            if (!isnan(row->wheel[i][q])) {
                sheet_add(sheet, section, pool_print(sheet->pool, "%s.%s", axle->wheel[i].name, kc_of_wheel[q].name),
                          pool_print(sheet->pool, "%s, %s", kc_of_wheel[q].title, axle->wheel[i].name),
                          kc_of_wheel[q].unit, row->wheel[i][q]);
                section = NULL;
            }
    for (int e = 0; e < kc->elements; ++e)
        for (int i = 0; i < axle->wheels && kc_ratio_seen(kc, axle, row, e); ++i)
            sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.ratio.%s", axle->wheel[i].name, kc->element[e].name),
                      pool_print(sheet->pool, "Motion ratio of %s, %s", kc->element[e].name, axle->wheel[i].name),
                      kc->element[e].angle ? "rad/m" : "1", row->ratio[i * kc->elements + e]);
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        const double value = kc_zero(study, a, q)->axle[q];
        if (!isnan(value))
            sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.%s", axle->name, kc_of_axle[q].name),
                      kc_of_axle[q].title, kc_unit(kc, axle, q), value);
    }
}

Sheet kc_sheet(Pool *pool, const Model *model, const KcStudy *study)
{
    Sheet sheet = {.pool = pool, .model = model};
    for (int a = 0; a < study->kc->axles; ++a)
        if (kc_first(study, a))
            add_axle(&sheet, study, a);
    return sheet;
}

void kc_compare(Pool *pool, const Model *model, const KcStudy *study, const Model *model_of_other,
                const KcStudy *of_other, const Request *request)
{
    Sheet sheet = kc_sheet(pool, model, study);
    const Sheet other = kc_sheet(pool, model_of_other, of_other);
    sheet_compare(&sheet, &other);
    if (request->results)
        sheet_csv(&sheet, request->results);
    else
        sheet_print(&sheet, ", models/KC.md defines these");
}
