/* SPDX-License-Identifier: MIT
 * Two vehicles, or two settings of one, side by side (--compare): numbers of wheels stand beside those of the same
 * place, all others beside those of the same name. */
#include "base/file.h"
#include "base/text.h"
#include "read/read.h"
#include "run/sheet.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* The file's name without folders. */
static const char *last_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

const Model *sheet_set(Pool *pool, const Model *model, const Scene *scene)
{
    bool differs = false;
    for (int i = 0; i < model->parameters; ++i)
        differs = differs || (model->parameter[i].tunable &&
                              scene->parameter[model->parameter[i].index] != model->parameter[i].value);
    return differs ? model_read_fixed(pool, model, NULL, 0, scene->parameter) : model;
}

const Model *sheet_other(Pool *pool, const Model *model, const char *file, const char **name)
{
    const Model *other;
    if (!path_ends(file, ".scene")) {
        other = model_read(pool, file);
        *name = other->name;
        return other;
    }
    other = model_read_again(pool, model); /* not as another scene has set it */
    const Scene *scene = scene_read(pool, file, other, NULL, 0);
    *name = pool_print(pool, "%s with %s", other->name, last_of(file));
    return sheet_set(pool, other, scene);
}

const char *sheet_place_of(Pool *pool, const KcAxle *axle, int wheel, int part)
{
    int number = 1 + part;
    for (int i = 0; i < wheel; ++i)
        number += axle->wheel[i].side == axle->wheel[wheel].side ? axle->wheel[i].parts : 0;
    return pool_print(pool, "%s.%s_%d", axle->name, axle->wheel[wheel].side > 0 ? "left" : "right", number);
}

const char *sheet_wheel(const Sheet *sheet, const char *name)
{
    for (int a = 0; a < sheet->kc->axles; ++a)
        if (!strcmp(sheet->kc->axle[a].name, name))
            return pool_print(sheet->pool, "wheel.%s", name);
    return name;
}

void sheet_place(Sheet *sheet, const KcAxle *axle, int wheel, int part, const char *what)
{
    sheet->row[sheet->rows - 1].place =
        pool_print(sheet->pool, "%s.%s", sheet_place_of(sheet->pool, axle, wheel, part), what);
}

bool sheet_differs(const SheetRow *row)
{
    return row->other != row->value &&
           !(fabs(row->other - row->value) <= 1e-9 * fmax(1 / row->scale, fabs(row->value)));
}

bool sheet_is_same(const SheetRow *a, const SheetRow *b)
{
    if (strcmp(a->unit, b->unit) != 0 || !a->place != !b->place)
        return false;
    return a->place ? !strcmp(a->place, b->place) : !strcmp(a->name, b->name);
}

const char *sheet_free_name(Pool *pool, const SheetRow *row, int rows, const char *name)
{
    for (int i = 0; i < rows; ++i)
        if (!strcmp(row[i].name, name)) {
            name = pool_print(pool, "other.%s", name);
            i = -1;
        }
    return name;
}

static const SheetRow *beside(const Sheet *sheet, int rows, const SheetRow *row)
{
    for (int i = 0; i < rows; ++i)
        if (sheet_is_same(&sheet->row[i], row))
            return &sheet->row[i];
    return NULL;
}

void sheet_compare(Sheet *sheet, const Sheet *other, const char *name)
{
    const int own = sheet->rows;
    const char *begun = NULL, *section = NULL; /* where the last such row stands, and this one */
    sheet->other = name;
    for (int i = 0; i < own; ++i) {
        const SheetRow *row = beside(other, other->rows, &sheet->row[i]);
        sheet->row[i].other = row ? row->value : NAN;
    }
    for (int k = 0; k < other->rows; ++k) {
        SheetRow row = other->row[k];
        section = row.section ? row.section : section;
        if (beside(sheet, own, &row))
            continue;
        row.section = section != begun ? pool_print(sheet->pool, "Only %s has: %s", name, section) : NULL;
        begun = section;
        row.other = row.value;
        row.value = NAN;
        row.name = sheet_free_name(sheet->pool, sheet->row, sheet->rows, row.name);
        *POOL_PUSH(sheet->pool, sheet->row, sheet->rows) = row;
    }
    for (int i = 0; i < other->notes; ++i)
        sheet_note(sheet, pool_print(sheet->pool, "%s: %s", name, other->note[i]));
}
