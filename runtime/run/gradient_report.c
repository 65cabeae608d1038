/* SPDX-License-Identifier: MIT
 * Gradients for people and programs. */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "run/gradient.h"

#include <string.h>

static void write_csv(Pool *pool, const Gradient *gradient, const char *path)
{
    static const char *const column[] = {"variable", "value", "unit", "derivative"};
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    for (size_t i = 0; i < sizeof column / sizeof *column; ++i)
        csv_name(&csv, column[i], NULL);
    csv_end_row(&csv);
    csv_name(&csv, "", NULL);
    csv_number(&csv, gradient->value);
    csv_text(&csv, NULL);
    csv_text(&csv, NULL);
    csv_end_row(&csv);
    for (int k = 0; k < gradient->variables; ++k) {
        const RunVariable *v = &gradient->variable[k];
        csv_name(&csv, v->name, NULL);
        csv_number(&csv, v->value);
        csv_name(&csv, v->unit, NULL);
        csv_number(&csv, gradient->derivative[k]);
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

void gradient_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Scalar scalar = scalar_read(pool, model, scene, request->formula);
    const Gradient *gradient = gradient_find(pool, &scalar, scene, request->solve, request->key, request->keys);
    static const char *const at[] = {
        [SCALAR_END] = "at the end,", [SCALAR_INTEGRAL] = "up to", [SCALAR_MAXIMUM] = "at its maximum,"};
    const char *number =
        pool_print(pool, "%s = %.12g %s %.9g s", request->formula, gradient->value, at[scalar.kind], gradient->time);
    if (request->results && path_ends(request->results, ".html"))
        gradient_page(pool, model->name, gradient, number, request->results);
    else if (request->results)
        write_csv(pool, gradient, request->results);
    if (request->results && !strcmp(request->results, "-"))
        return;
    Text out = {.pool = pool};
    text_print(&out, "%s: %s\n\n", model->name, number);
    text_print(&out, "%-40s  %16s  %-8s  %16s\n", "variable", "value", "unit", "derivative");
    for (int k = 0; k < gradient->variables; ++k) {
        const RunVariable *v = &gradient->variable[k];
        text_print(&out, "%-40s  %16.9g  %-8s  %16.9g\n", v->name, v->value, v->unit, gradient->derivative[k]);
    }
    diag_text(out.s);
}
