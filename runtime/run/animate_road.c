/* SPDX-License-Identifier: MIT
 * The road along a path: square tiles of heights, each with the resolution that it needs. */
#include "base/text.h"
#include "gic_runtime.h"
#include "run/animate.h"

#include <math.h>
#include <stdlib.h>

/* CELLS: on each side of a tile that is not flat. MOST: number of tiles; for longer paths tiles become larger and the
 * road coarser. About 3 MB. */
enum { CELLS = 16, MOST = 3000, CORNERS = (CELLS + 1) * (CELLS + 1) };

typedef struct Tile {
    long i, j; /* its corner is at (i, j) times its size */
} Tile;

static int compare(const void *a, const void *b)
{
    const Tile *p = a, *q = b;
    if (p->j != q->j)
        return p->j < q->j ? -1 : 1;
    return (p->i > q->i) - (p->i < q->i);
}

/* All tiles of a size within `reach` of the path, each once; NULL: more than MOST. */
static Tile *find_tiles(Pool *pool, double size, double reach, const double *way, int count, int *tiles)
{
    Tile *tile = NULL;
    int all = 0;
    const double *last = NULL;
    for (int k = 0; k < count; ++k) {
        const double *at = way + 2 * k;
        if (last && k < count - 1 && hypot(at[0] - last[0], at[1] - last[1]) < size / 4)
            continue;
        last = at;
        for (double j = floor((at[1] - reach) / size); j <= floor((at[1] + reach) / size); ++j)
            for (double i = floor((at[0] - reach) / size); i <= floor((at[0] + reach) / size); ++i) {
                const double dx = fmax(fmax(i * size - at[0], at[0] - (i + 1) * size), 0);
                const double dy = fmax(fmax(j * size - at[1], at[1] - (j + 1) * size), 0);
                if (hypot(dx, dy) < reach)
                    *POOL_PUSH(pool, tile, all) = (Tile){(long)i, (long)j};
            }
    }
    qsort(tile, (size_t)all, sizeof *tile, compare);
    *tiles = 0;
    for (int k = 0; k < all; ++k)
        if (!k || compare(&tile[k], &tile[k - 1]))
            tile[(*tiles)++] = tile[k];
    return *tiles <= MOST ? tile : NULL;
}

/* Heights in `unit` at a tile's corners; false: some height is not finite. */
static bool sample(const gic_road *road, Tile tile, double size, double unit, double z[CORNERS])
{
    for (int b = 0, k = 0; b <= CELLS; ++b)
        for (int a = 0; a <= CELLS; ++a, ++k) {
            double h[3];
            road->height(road, 0, 0, ((double)tile.i + (double)a / (int)CELLS) * size,
                         ((double)tile.j + (double)b / (int)CELLS) * size, h);
            if (!gic_finite(h, 1))
                return false;
            z[k] = round(h[0] / unit);
        }
    return true;
}

/* True if the tile's four corners determine all heights. */
static bool is_plain(const double z[CORNERS])
{
    const double *far = z + CORNERS - 1 - CELLS;
    for (int k = 0; k < CORNERS; ++k) {
        const double u = (double)(k % (CELLS + 1)) / (int)CELLS, v = (double)(k / (CELLS + 1)) / (int)CELLS;
        const double plain = (1 - v) * ((1 - u) * z[0] + u * z[CELLS]) + v * ((1 - u) * far[0] + u * far[CELLS]);
        if (fabs(plain - z[k]) > 1)
            return false;
    }
    return true;
}

/* Friction in hundredths at a tile's corners; returns true if it is the same at all. */
static bool sample_friction(const gic_road *road, Tile tile, double size, double f[CORNERS])
{
    bool same = true;
    for (int k = 0; k < CORNERS; ++k) {
        f[k] = 100;
        if (road->friction)
            f[k] =
                round(100 * road->friction(road, 0, 0, ((double)tile.i + (double)(k % (CELLS + 1)) / (int)CELLS) * size,
                                           ((double)tile.j + (double)(k / (CELLS + 1)) / (int)CELLS) * size));
        same = same && f[k] == f[0];
    }
    return same;
}

/* At all corners, or one number if all are the same. */
static void print_friction(Text *out, Tile tile, const double f[CORNERS], bool same)
{
    text_print(out, "%s[%ld,%ld", out->size ? ",\n" : "", tile.i, tile.j);
    for (int k = 0; k < (same ? 1 : CORNERS); ++k)
        text_print(out, ",%.0f", f[k]);
    text_print(out, "]");
}

/* Row by row as differences, the first of a row to that of the row before; every `step`-th corner. */
static void print_tile(Text *out, Tile tile, const double z[CORNERS], int step)
{
    text_print(out, "[%ld,%ld", tile.i, tile.j);
    for (int b = 0; b <= CELLS; b += step)
        for (int a = 0; a <= CELLS; a += step) {
            const double *at = z + b * (CELLS + 1) + a, before = a ? at[-step] : b ? at[-step * (CELLS + 1)] : 0;
            text_print(out, ",%.0f", *at - before + 0.0); /* no -0 */
        }
    text_print(out, "]");
}

void road_tiles(Text *out, const gic_road *road, double size, const double *way, int count)
{
    const double reach = 4 * size, unit = pow(10, floor(log10(size)) - 4);
    double side = pow(2, round(log2(size)) - 1), z[CORNERS], f[CORNERS];
    Text friction = {.pool = out->pool};
    Tile *tile;
    int tiles, printed = 0;
    while (!(tile = find_tiles(out->pool, side, reach, way, count, &tiles)))
        side *= 2;
    text_print(out, "{\"tile\":%.15g,\"cells\":%d,\"unit\":%.9g,\"reach\":%.6g,\"tiles\":[", side, CELLS, unit, reach);
    for (int k = 0; k < tiles; ++k)
        if (sample(road, tile[k], side, unit, z)) {
            text_print(out, printed++ ? ",\n" : "\n");
            const bool same = sample_friction(road, tile[k], side, f);
            const int step = same && is_plain(z) ? CELLS : 1;
            print_tile(out, tile[k], z, step);
            if (!same || f[0] != 100)
                print_friction(&friction, tile[k], f, same);
        }
    text_print(out, "],\"friction\":[%s]}", friction.size ? friction.s : "");
}
