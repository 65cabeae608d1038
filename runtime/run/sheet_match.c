/* SPDX-License-Identifier: MIT
 * Modes of two vehicles side by side, or of runs: those of one shape belong together, whatever their order. Shapes are
 * the motions of the base's corners and of the wheels' centres, complex ones; how alike two are is the modal assurance
 * criterion |a* b|^2 / (a* a b* b), 1 for one shape and 0 for shapes that are perpendicular. */
#include "run/sheet.h"

#include <math.h>
#include <string.h>

static const double alike = 0.5; /* below this two modes are different ones */

/* What a wheel of the model is called in any vehicle; NULL: it has no axle. */
static const char *place_of_wheel(const Sheet *sheet, int wheel)
{
    for (int a = 0; a < sheet->kc->axles; ++a)
        for (int i = 0; i < sheet->kc->axle[a].wheels; ++i)
            for (int k = 0; k < sheet->kc->axle[a].wheel[i].parts; ++k)
                if (sheet->kc->axle[a].wheel[i].part[k] == &sheet->model->wheel[wheel])
                    return sheet_place_of(sheet->pool, &sheet->kc->axle[a], i, k);
    return NULL;
}

struct SheetShapes {
    Pool *pool;
    int count, wheels;
    SheetShape *shape; /* points 0: not known */
    bool *swings;
    const char **place; /* [wheels] */
};

SheetShapes *sheet_shapes(Pool *pool)
{
    SheetShapes *shapes = pool_alloc(pool, sizeof *shapes);
    *shapes = (SheetShapes){.pool = pool};
    return shapes;
}

static void name_wheels(SheetShapes *shapes, const Sheet *sheet)
{
    shapes->wheels = sheet->model->wheels;
    shapes->place = pool_alloc(shapes->pool, ((size_t)shapes->wheels + 1) * sizeof *shapes->place);
    for (int w = 0; w < shapes->wheels; ++w) {
        const char *place = place_of_wheel(sheet, w);
        shapes->place[w] = place ? pool_print(shapes->pool, "%s", place) : NULL;
    }
}

/* Points of a shape, [points][3], that outlive it. */
static double (*kept(Pool *pool, int points, double (*of)[3]))[3]
{
    double(*copy)[3] = pool_alloc(pool, ((size_t)points + 1) * sizeof *copy);
    if (points)
        memcpy(copy, of, (size_t)points * sizeof *copy);
    return copy;
}

static void add_shape(SheetShapes *shapes, const SheetShape *shape, bool swings)
{
    int swinging = shapes->count;
    *POOL_PUSH(shapes->pool, shapes->swings, swinging) = swings;
    *POOL_PUSH(shapes->pool, shapes->shape, shapes->count) = (SheetShape){
        shape->points,
        kept(shapes->pool, shape->points, shape->rest),
        {kept(shapes->pool, shape->points, shape->move[0]), kept(shapes->pool, shape->points, shape->move[1])}};
}

static const SheetShapes *shapes_of(const Sheet *sheet)
{
    SheetShapes *shapes = sheet_shapes(sheet->pool);
    name_wheels(shapes, sheet);
    for (int k = 0; k < sheet->modes->count; ++k) {
        SheetShape shape;
        if (!sheet_shape_of(sheet, &sheet->modes->mode[k], &shape))
            shape = (SheetShape){.points = 0};
        add_shape(shapes, &shape, sheet->modes->mode[k].imaginary > 0);
    }
    return shapes;
}

/* Points of both: the base's corners, then wheels of the same places. pair: [points][2]. Returns their number. */
static int pair_points(const SheetShapes *a, const SheetShapes *b, int (*pair)[2])
{
    int points = 0;
    for (int k = 0; k < SHEET_CORNERS; ++k, ++points)
        pair[points][0] = pair[points][1] = k;
    for (int w = 0; w < a->wheels; ++w)
        for (int other = 0; other < b->wheels; ++other)
            if (a->place[w] && b->place[other] && !strcmp(a->place[w], b->place[other])) {
                pair[points][0] = SHEET_CORNERS + w;
                pair[points++][1] = SHEET_CORNERS + other;
                break;
            }
    return points;
}

/* Of two shapes at paired points. */
static double likeness(const SheetShape *a, const SheetShape *b, int (*pair)[2], int points)
{
    double aa = 0, bb = 0, re = 0, im = 0;
    for (int k = 0; k < points; ++k)
        for (int i = 0; i < 3; ++i) {
            const double ar = a->move[0][pair[k][0]][i], ai = a->move[1][pair[k][0]][i];
            const double br = b->move[0][pair[k][1]][i], bi = b->move[1][pair[k][1]][i];
            aa += ar * ar + ai * ai;
            bb += br * br + bi * bi;
            re += ar * br + ai * bi;
            im += ar * bi - ai * br;
        }
    return aa > 0 && bb > 0 ? (re * re + im * im) / (aa * bb) : 0;
}

/* Modes of the same shape, the two most alike first; of equals those of the lowest numbers. partner: [b->count] the
 * one of a, -1: it has none; by: how alike they are. */
static void match(Pool *pool, const SheetShapes *a, const SheetShapes *b, int *partner, double *by)
{
    double *alike_of = pool_alloc(pool, ((size_t)a->count * (size_t)b->count + 1) * sizeof *alike_of);
    int(*pair)[2] = pool_alloc(pool, (size_t)(SHEET_CORNERS + a->wheels) * sizeof *pair);
    bool *taken = pool_alloc(pool, ((size_t)a->count + 1) * sizeof *taken);
    const int points = pair_points(a, b, pair);
    for (int k = 0; k < b->count; ++k)
        partner[k] = -1;
    for (int i = 0; i < a->count; ++i)
        for (int k = 0; k < b->count; ++k)
            if (a->swings[i] == b->swings[k] && a->shape[i].points && b->shape[k].points)
                alike_of[i * b->count + k] = likeness(&a->shape[i], &b->shape[k], pair, points);
    for (;;) {
        int best[2] = {-1, -1};
        for (int i = 0; i < a->count; ++i)
            for (int k = 0; k < b->count; ++k)
                if (!taken[i] && partner[k] < 0 && alike_of[i * b->count + k] > alike &&
                    (best[0] < 0 || alike_of[i * b->count + k] > alike_of[best[0] * b->count + best[1]] * (1 + 1e-9))) {
                    best[0] = i;
                    best[1] = k;
                }
        if (best[0] < 0)
            return;
        taken[best[0]] = true;
        partner[best[1]] = best[0];
        by[best[1]] = alike_of[best[0] * b->count + best[1]];
    }
}

/* The number, from 1, that a mode's rows have. */
static int number_of(const Sheet *sheet, int mode)
{
    return sheet->number ? sheet->number[mode] : mode + 1;
}

/* The mode of a row; -1: it is of none. *of: what follows its number. */
static int mode_of(const Sheet *sheet, const SheetRow *row, const char **of)
{
    for (int k = 0; k < sheet->modes->count; ++k) {
        const char *start = pool_print(sheet->pool, "mode_%d.", number_of(sheet, k));
        *of = row->name + strlen(start);
        if (!strncmp(row->name, start, strlen(start)))
            return k;
    }
    return -1;
}

void sheet_match_modes(Sheet *sheet, Sheet *other)
{
    if (!sheet->modes || !other->modes)
        return;
    Pool *pool = sheet->pool;
    const SheetShapes *own = shapes_of(sheet), *theirs = shapes_of(other);
    int *partner = pool_alloc(pool, ((size_t)theirs->count + 1) * sizeof *partner);
    double *by = pool_alloc(pool, ((size_t)theirs->count + 1) * sizeof *by);
    const char *of;
    match(pool, own, theirs, partner, by);
    for (int i = 0; i < own->count; ++i)
        for (int k = 0; k < theirs->count; ++k)
            if (partner[k] == i && number_of(sheet, i) != number_of(other, k))
                sheet_note(sheet, pool_print(pool, "mode %d has the shape of the other's mode %d, by %.2f",
                                             number_of(sheet, i), number_of(other, k), by[k]));
    for (int i = 0; i < sheet->rows; ++i) {
        const int mode = mode_of(sheet, &sheet->row[i], &of);
        if (mode >= 0)
            sheet->row[i].place = pool_print(pool, "mode %d.%s", number_of(sheet, mode), of);
    }
    for (int i = 0; i < other->rows; ++i) {
        const int mode = mode_of(other, &other->row[i], &of);
        if (mode >= 0 && partner[mode] >= 0)
            other->row[i].place = pool_print(pool, "mode %d.%s", number_of(sheet, partner[mode]), of);
        else if (mode >= 0)
            other->row[i].place = pool_print(pool, "the other's mode %d.%s", number_of(other, mode), of);
    }
}

void sheet_follow_modes(Sheet *sheet, SheetShapes *known)
{
    if (!sheet->modes)
        return;
    Pool *pool = sheet->pool;
    const SheetShapes *own = shapes_of(sheet);
    int *partner = pool_alloc(pool, ((size_t)own->count + 1) * sizeof *partner);
    int *number = pool_alloc(pool, ((size_t)own->count + 1) * sizeof *number);
    double *by = pool_alloc(pool, ((size_t)own->count + 1) * sizeof *by);
    if (!known->place)
        name_wheels(known, sheet);
    match(pool, known, own, partner, by);
    for (int k = 0; k < own->count; ++k) {
        if (partner[k] < 0)
            add_shape(known, &own->shape[k], own->swings[k]);
        number[k] = partner[k] < 0 ? known->count : partner[k] + 1;
    }
    for (int i = 0; i < sheet->rows; ++i) {
        SheetRow *row = &sheet->row[i];
        const char *of;
        const int mode = mode_of(sheet, row, &of);
        if (mode < 0)
            continue;
        row->name = pool_print(pool, "mode_%d.%s", number[mode], of);
        row->title =
            pool_print(pool, "%.*s%d", (int)(strrchr(row->title, ' ') + 1 - row->title), row->title, number[mode]);
    }
    sheet->number = number;
}
