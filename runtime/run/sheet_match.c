/* SPDX-License-Identifier: MIT
 * Modes of two vehicles side by side, or of runs: those of one shape belong together, whatever their order. Shapes are
 * the motions of the base's corners and of the wheels' centres, complex ones; how alike two are is the modal assurance
 * criterion |a* b|^2 / (a* a b* b), 1 for one shape and 0 for shapes that are perpendicular. Modes that move no body,
 * such as slips of tires that balance each other, have shapes of rounding alone: they are as alike as their eigenvalues
 * a and b are near, 1 - |a - b| / max(|a|, |b|), where the same kind of states moves. */
#include "run/sheet.h"

#include <math.h>
#include <string.h>

static const double alike = 0.5;  /* below this two modes are different ones */
static const double still = 1e-9; /* Mode.moves of rounding: 1e-12 and less was seen */

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

/* A mode of a vehicle. */
typedef struct SheetMode {
    SheetShape shape; /* points 0: not known */
    bool swings, still;
    double real, imaginary;
    int wheels, states;
    const char **place; /* [wheels] */
    const char **state; /* [states] fast states that are none of wheels */
    double by_wheels;   /* share of the wheels' fast states */
    double *share;      /* [states] */
} SheetMode;

struct SheetShapes {
    Pool *pool;
    int count;
    SheetMode *motion;
};

SheetShapes *sheet_shapes(Pool *pool)
{
    SheetShapes *shapes = pool_alloc(pool, sizeof *shapes);
    *shapes = (SheetShapes){.pool = pool};
    return shapes;
}

/* Points of a shape, [points][3], that outlive it. */
static double (*kept(Pool *pool, int points, double (*of)[3]))[3]
{
    double(*copy)[3] = pool_alloc(pool, ((size_t)points + 1) * sizeof *copy);
    if (points)
        memcpy(copy, of, (size_t)points * sizeof *copy);
    return copy;
}

static const char **kept_names(Pool *pool, int count, const char **of)
{
    const char **copy = pool_alloc(pool, ((size_t)count + 1) * sizeof *copy);
    for (int i = 0; i < count; ++i)
        copy[i] = of[i] ? pool_print(pool, "%s", of[i]) : NULL;
    return copy;
}

/* A copy that outlives the sheet of the motion. */
static void add_motion(SheetShapes *shapes, const SheetMode *of)
{
    Pool *pool = shapes->pool;
    SheetMode motion = *of;
    motion.shape = (SheetShape){.points = of->shape.points};
    motion.shape.rest = kept(pool, of->shape.points, of->shape.rest);
    for (int part = 0; part < 2; ++part)
        motion.shape.move[part] = kept(pool, of->shape.points, of->shape.move[part]);
    motion.place = kept_names(pool, of->wheels, of->place);
    motion.state = kept_names(pool, of->states, of->state);
    motion.share = pool_alloc(pool, ((size_t)of->states + 1) * sizeof *motion.share);
    memcpy(motion.share, of->share, (size_t)of->states * sizeof *motion.share);
    *POOL_PUSH(pool, shapes->motion, shapes->count) = motion;
}

/* The modes of a sheet, in its pool; none where it has none. */
static const SheetShapes *motions_of(const Sheet *sheet)
{
    SheetShapes *shapes = sheet_shapes(sheet->pool);
    const Linear *linear = sheet->found->linear;
    const int before = 2 * linear->places + linear->of_wheels;
    SheetMode motion = {.wheels = sheet->model->wheels, .states = linear->count - before};
    motion.place = pool_alloc(sheet->pool, ((size_t)motion.wheels + 1) * sizeof *motion.place);
    for (int w = 0; w < motion.wheels; ++w)
        motion.place[w] = place_of_wheel(sheet, w);
    motion.state = linear->name + before;
    for (int k = 0; k < sheet->modes->count; ++k) {
        const Mode *mode = &sheet->modes->mode[k];
        if (!sheet_shape_of(sheet, mode, &motion.shape))
            motion.shape = (SheetShape){.points = 0};
        motion.still = !(mode->moves > still);
        motion.real = mode->real;
        motion.imaginary = mode->imaginary;
        motion.swings = mode->imaginary > 0;
        motion.by_wheels = 0;
        for (int i = 0; i < linear->of_wheels; ++i)
            motion.by_wheels += mode->share[linear->places + i];
        motion.share = mode->share + linear->places + linear->of_wheels;
        add_motion(shapes, &motion);
    }
    return shapes;
}

/* Points of both: the base's corners, then wheels of the same places. pair: [points][2]. Returns their number. */
static int pair_points(const SheetMode *a, const SheetMode *b, int (*pair)[2])
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

/* Of the shapes of two modes. */
static double shapes_alike(Pool *pool, const SheetMode *one, const SheetMode *other)
{
    const SheetShape *a = &one->shape, *b = &other->shape;
    double aa = 0, bb = 0, re = 0, im = 0;
    int(*pair)[2] = pool_alloc(pool, (size_t)(SHEET_CORNERS + one->wheels) * sizeof *pair);
    const int points = pair_points(one, other, pair);
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

/* How much of two modes is in the same states: those of wheels count as one, for those of equal tires make a multiple
 * eigenvalue, whose eigenvectors are any of their sums; others go by their names. */
static double states_shared(const SheetMode *a, const SheetMode *b)
{
    double shared = fmin(a->by_wheels, b->by_wheels);
    for (int i = 0; i < a->states; ++i)
        for (int k = 0; k < b->states; ++k)
            if (!strcmp(a->state[i], b->state[k]))
                shared += fmin(a->share[i], b->share[k]);
    return shared;
}

/* From 0 to 1. */
static double likeness(Pool *pool, const SheetMode *a, const SheetMode *b)
{
    if (a->swings != b->swings || a->still != b->still)
        return 0;
    if (!a->still)
        return a->shape.points && b->shape.points ? shapes_alike(pool, a, b) : 0;
    const double size = fmax(hypot(a->real, a->imaginary), hypot(b->real, b->imaginary));
    return states_shared(a, b) > alike ? 1 - hypot(a->real - b->real, a->imaginary - b->imaginary) / size : 0;
}

/* Modes that belong together, the two most alike first; of equals those of the lowest numbers. taken: [a->count] those
 * of a that have a partner already; partner: [b->count] the one of a, or one from before, -1: it has none; by: how
 * alike they are. */
static void match(Pool *pool, const SheetShapes *a, const SheetShapes *b, bool *taken, int *partner, double *by)
{
    double *alike_of = pool_alloc(pool, ((size_t)a->count * (size_t)b->count + 1) * sizeof *alike_of);
    for (int i = 0; i < a->count; ++i)
        for (int k = 0; k < b->count; ++k)
            alike_of[i * b->count + k] = likeness(pool, &a->motion[i], &b->motion[k]);
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

/* Which modes of b have which of a. */
typedef struct Match {
    bool *taken;
    int *partner;
    double *by;
} Match;

static Match no_match(Pool *pool, int of_a, int of_b)
{
    Match m = {.taken = pool_alloc(pool, ((size_t)of_a + 1) * sizeof *m.taken),
               .partner = pool_alloc(pool, ((size_t)of_b + 1) * sizeof *m.partner),
               .by = pool_alloc(pool, ((size_t)of_b + 1) * sizeof *m.by)};
    for (int k = 0; k < of_b; ++k)
        m.partner[k] = -1;
    return m;
}

/* The number, from 1, that a mode's rows have. */
static int number_of(const Sheet *sheet, int mode)
{
    return sheet->number ? sheet->number[mode] : mode + 1;
}

/* Give the rows of the modes their numbers. */
static void renumber(Sheet *sheet, const int *number)
{
    for (int i = 0; i < sheet->rows; ++i) {
        SheetRow *row = &sheet->row[i];
        if (!row->mode)
            continue;
        const int n = number[row->mode - 1];
        row->name = pool_print(sheet->pool, "mode_%d%s", n, strchr(row->name, '.'));
        row->title = pool_print(sheet->pool, "%.*s%d", (int)(strrchr(row->title, ' ') + 1 - row->title), row->title, n);
    }
    sheet->number = number;
}

/* Numbers of modes that have none yet, 0: those of known motions that are not taken; others become known. */
static void follow(Pool *pool, const SheetShapes *own, SheetShapes *known, bool *taken, int *number)
{
    const Match m = no_match(pool, 0, own->count);
    for (int k = 0; k < own->count; ++k)
        if (number[k])
            m.partner[k] = number[k] - 1;
    match(pool, known, own, taken, m.partner, m.by);
    for (int k = 0; k < own->count; ++k) {
        if (m.partner[k] < 0)
            add_motion(known, &own->motion[k]);
        number[k] = m.partner[k] < 0 ? known->count : m.partner[k] + 1;
    }
}

void sheet_follow_modes(Sheet *sheet, SheetShapes *known)
{
    if (!sheet->modes)
        return;
    const SheetShapes *own = motions_of(sheet);
    int *number = pool_alloc(sheet->pool, ((size_t)own->count + 1) * sizeof *number);
    bool *taken = pool_alloc(sheet->pool, ((size_t)known->count + 1) * sizeof *taken);
    follow(sheet->pool, own, known, taken, number);
    renumber(sheet, number);
}

void sheet_match_modes(Sheet *sheet, Sheet *other, SheetShapes *known)
{
    Pool *pool = sheet->pool;
    if (!other->modes)
        return;
    const SheetShapes *own = sheet->modes ? motions_of(sheet) : sheet_shapes(pool), *theirs = motions_of(other);
    const Match m = no_match(pool, own->count, theirs->count);
    int *number = pool_alloc(pool, ((size_t)theirs->count + 1) * sizeof *number);
    bool *taken = pool_alloc(pool, ((size_t)known->count + 1) * sizeof *taken);
    match(pool, own, theirs, m.taken, m.partner, m.by);
    for (int i = 0; i < own->count; ++i) {
        taken[number_of(sheet, i) - 1] = true;
        for (int k = 0; k < theirs->count; ++k)
            if (m.partner[k] == i && number_of(sheet, i) != k + 1)
                sheet_note(sheet, pool_print(pool, "mode %d has the shape of the other's mode %d, by %.2f",
                                             number_of(sheet, i), k + 1, m.by[k]));
    }
    for (int k = 0; k < theirs->count; ++k)
        number[k] = m.partner[k] < 0 ? 0 : number_of(sheet, m.partner[k]);
    follow(pool, theirs, known, taken, number);
    for (int k = 0; k < theirs->count; ++k)
        if (m.partner[k] < 0 && number[k] != k + 1)
            sheet_note(sheet, pool_print(pool, "mode %d, which only the other has, is its mode %d", number[k], k + 1));
    renumber(other, number);
}
