/* SPDX-License-Identifier: MIT
 * Modes of two vehicles side by side: those of one shape belong together, whatever their numbers. Shapes are the
 * motions of the base's corners and of the wheels' centres, complex ones; how alike two are is the modal assurance
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

/* The wheel of the other sheet at the same place of the axle of the same name; -1: there is none. */
static int wheel_of(const Sheet *sheet, const Sheet *other, int wheel)
{
    const char *place = place_of_wheel(sheet, wheel);
    for (int w = 0; place && w < other->model->wheels; ++w) {
        const char *there = place_of_wheel(other, w);
        if (there && !strcmp(place, there))
            return w;
    }
    return -1;
}

/* Points of both: the base's corners, then wheels of the same places. pair: [points][2]. Returns their number. */
static int pair_points(const Sheet *sheet, const Sheet *other, int (*pair)[2])
{
    int points = 0;
    for (int k = 0; k < SHEET_CORNERS; ++k, ++points)
        pair[points][0] = pair[points][1] = k;
    for (int w = 0; w < sheet->model->wheels; ++w) {
        const int same = wheel_of(sheet, other, w);
        if (same < 0)
            continue;
        pair[points][0] = SHEET_CORNERS + w;
        pair[points++][1] = SHEET_CORNERS + same;
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

static const char *place_of(Pool *pool, const char *name, int mode)
{
    const char *dot = strchr(name, '.');
    return pool_print(pool, "mode %d%s", mode + 1, dot ? dot : "");
}

/* Rows of modes get places: of a mode of the other sheet that of its partner, or one of its own. */
static void put_places(Sheet *sheet, const int *partner, int apart)
{
    for (int i = 0; i < sheet->rows; ++i) {
        int mode = 0, end = 0;
        for (int k = 0; k < sheet->modes->count && !end; ++k) {
            const char *start = pool_print(sheet->pool, "mode_%d.", k + 1);
            if (!strncmp(sheet->row[i].name, start, strlen(start))) {
                mode = k;
                end = 1;
            }
        }
        if (!end)
            continue;
        sheet->row[i].place = place_of(sheet->pool, sheet->row[i].name,
                                       !partner             ? mode
                                       : partner[mode] >= 0 ? partner[mode]
                                                            : apart + mode);
    }
}

void sheet_match_modes(Sheet *sheet, Sheet *other)
{
    if (!sheet->modes || !other->modes)
        return;
    const int own = sheet->modes->count, theirs = other->modes->count;
    Pool *pool = sheet->pool;
    SheetShape *shape[2] = {pool_alloc(pool, ((size_t)own + 1) * sizeof *shape[0]),
                            pool_alloc(pool, ((size_t)theirs + 1) * sizeof *shape[1])};
    int(*pair)[2] = pool_alloc(pool, (size_t)(SHEET_CORNERS + sheet->model->wheels) * sizeof *pair);
    int *partner = pool_alloc(pool, ((size_t)theirs + 1) * sizeof *partner);
    double *alike_of = pool_alloc(pool, ((size_t)own * (size_t)theirs + 1) * sizeof *alike_of);
    const int points = pair_points(sheet, other, pair);
    bool taken[own + 1];
    memset(taken, 0, sizeof taken);
    for (int k = 0; k < theirs; ++k)
        partner[k] = -1;
    for (int i = 0; i < own; ++i)
        for (int k = 0; k < theirs; ++k) {
            const bool swings = sheet->modes->mode[i].imaginary > 0;
            if (!k && !sheet_shape_of(sheet, &sheet->modes->mode[i], &shape[0][i]))
                shape[0][i].points = 0;
            if (!i && !sheet_shape_of(other, &other->modes->mode[k], &shape[1][k]))
                shape[1][k].points = 0;
            if (swings == (other->modes->mode[k].imaginary > 0) && shape[0][i].points && shape[1][k].points)
                alike_of[i * theirs + k] = likeness(&shape[0][i], &shape[1][k], pair, points);
        }
    for (;;) { /* the two most alike first; of equals those of the lowest numbers */
        int best[2] = {-1, -1};
        for (int i = 0; i < own; ++i)
            for (int k = 0; k < theirs; ++k)
                if (!taken[i] && partner[k] < 0 && alike_of[i * theirs + k] > alike &&
                    (best[0] < 0 || alike_of[i * theirs + k] > alike_of[best[0] * theirs + best[1]] * (1 + 1e-9))) {
                    best[0] = i;
                    best[1] = k;
                }
        if (best[0] < 0)
            break;
        taken[best[0]] = true;
        partner[best[1]] = best[0];
        if (best[0] != best[1])
            sheet_note(sheet, pool_print(pool, "mode %d has the shape of the other's mode %d, by %.2f", best[0] + 1,
                                         best[1] + 1, alike_of[best[0] * theirs + best[1]]));
    }
    put_places(sheet, NULL, 0);
    put_places(other, partner, own);
}
