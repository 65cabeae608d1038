/* SPDX-License-Identifier: MIT
 * The road of a scene: models/SCENE.md section 3. */
#include "gicrun.h"

#include <string.h>

static const double far = 1e9; /* m; beyond any road */

static const gic_road *plane_read(Pool *pool, const Item *item, bool slope)
{
    gic_road_plane *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_plane_height;
    if (slope)
        CHECK_KEYS(item, "a slope road", "type", "height", "x", "y");
    else
        CHECK_KEYS(item, "a flat road", "type", "height");
    road->z0 = scene_number(item, "height", "height of the road", 0);
    road->sx = scene_number(item, "x", "slope of the road along x", 0);
    road->sy = scene_number(item, "y", "slope of the road along y", 0);
    return &road->head;
}

static const gic_road *sine_read(Pool *pool, const Item *item)
{
    gic_road_sine *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_sine_height;
    CHECK_KEYS(item, "a sine road", "type", "amplitude", "wavelength", "start", "phase_per_y");
    road->amplitude = doc_number(scene_need(item, "amplitude", "a sine road"), "amplitude of the road");
    road->wavelength = scene_positive(scene_need(item, "wavelength", "a sine road"), "wavelength of the road");
    road->x0 = scene_number(item, "start", "start of the road's sine", 0);
    road->phase_per_y = scene_number(item, "phase_per_y", "phase per metre of y", 0);
    return &road->head;
}

/* The strip of y that a bump covers: by `tracks`, or by its edges. */
static void bump_tracks(const Item *item, gic_bump *bump)
{
    const Item *tracks = doc_find(item, "tracks"), *edges = doc_find(item, "y");
    if (tracks && edges)
        diag_fail(tracks->at, "keep one of the two", "a bump has both tracks and y");
    bump->y_low = -far;
    bump->y_high = far;
    if (edges) {
        double y[2];
        doc_vector(edges, "y of a bump", y, 2);
        if (y[0] >= y[1])
            diag_fail(edges->at, "write [low, high]", "y of a bump must rise");
        bump->y_low = y[0];
        bump->y_high = y[1];
    }
    if (!tracks)
        return;
    const char *word = doc_word(tracks, "tracks of a bump");
    if (!strcmp(word, "left"))
        bump->y_low = 1e-12; /* y = 0 itself belongs to the right, as in a table */
    else if (!strcmp(word, "right"))
        bump->y_high = 0;
    else if (strcmp(word, "both"))
        diag_fail(tracks->at, "write left, right or both", "tracks of a bump can't be '%s'", word);
}

static const gic_road *bumps_read(Pool *pool, const Item *item)
{
    gic_road_bumps *road = pool_alloc(pool, sizeof *road);
    gic_bump *bump = NULL;
    road->head.height = gic_bumps_height;
    CHECK_KEYS(item, "a road of bumps", "type", "bumps");
    const Item *list = scene_need(item, "bumps", "a road of bumps");
    if (list->kind != ITEM_LIST)
        diag_fail(list->at, "write `- {x: .., length: .., height: ..}`, a line each", "bumps must be a list");
    for (int i = 0; i < list->count; ++i) {
        const Item *entry = list->value[i];
        CHECK_KEYS(entry, "a bump", "x", "length", "height", "tracks", "y");
        gic_bump *one = POOL_PUSH(pool, bump, road->count);
        one->x = doc_number(scene_need(entry, "x", "a bump"), "x of a bump");
        one->length = scene_positive(scene_need(entry, "length", "a bump"), "length of a bump");
        one->height = doc_number(scene_need(entry, "height", "a bump"), "height of a bump");
        bump_tracks(entry, one);
    }
    road->bump = bump;
    return &road->head;
}

/* Heights at the table's points under one of two keys, or those both tracks share. */
static const double *table_column(Pool *pool, const Item *item, const char *key, const double *shared, int count)
{
    const Item *list = doc_find(item, key);
    if (!list && shared)
        return shared;
    list = scene_need(item, key, "a road table without height");
    if (shared)
        diag_fail(list->at, "give height for both tracks, or left and right", "a road table has both height and %s",
                  key);
    if (list->kind == ITEM_LIST && list->count != count)
        diag_fail(list->at, "one height for each x", "%s has %d numbers, x has %d", key, list->count, count);
    return scene_numbers(pool, list, "heights of a road table", 2);
}

static const gic_road *table_read(Pool *pool, const Item *item)
{
    gic_road_table *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_table_height;
    CHECK_KEYS(item, "a road table", "type", "x", "height", "left", "right");
    const Item *x = scene_need(item, "x", "a road table");
    road->x = scene_numbers(pool, x, "x of a road table", 2);
    road->count = x->count;
    const double *shared = doc_find(item, "height") ? table_column(pool, item, "height", NULL, x->count) : NULL;
    road->left = table_column(pool, item, "left", shared, x->count);
    road->right = table_column(pool, item, "right", shared, x->count);
    road->slope_left = pool_alloc(pool, sizeof(double) * (size_t)x->count);
    road->slope_right = pool_alloc(pool, sizeof(double) * (size_t)x->count);
    for (int i = 1; i < x->count; ++i)
        if (road->x[i] <= road->x[i - 1])
            diag_fail(x->value[i]->at, "sort the points by x and keep one of equals", "x of a road table must rise");
    gic_road_table_setup(road);
    return &road->head;
}

const gic_road *road_read(Pool *pool, const Item *item)
{
    static const char *const types[] = {"flat", "slope", "bumps", "sine", "table"};
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write `road: {type: flat}`", "the road must be a map");
    const Item *type = scene_need(item, "type", "the road");
    const char *word = doc_word(type, "type of the road");
    if (!strcmp(word, "flat") || !strcmp(word, "slope"))
        return plane_read(pool, item, word[0] == 's');
    if (!strcmp(word, "bumps"))
        return bumps_read(pool, item);
    if (!strcmp(word, "sine"))
        return sine_read(pool, item);
    if (!strcmp(word, "table"))
        return table_read(pool, item);
    const char *nearest = diag_nearest(word, types, sizeof types / sizeof *types);
    diag_fail(type->at, pool_print(pool, "%s%s%sthe types are flat, slope, bumps, sine and table",
                                   nearest ? "did you mean '" : "", nearest ? nearest : "", nearest ? "'? " : ""),
              "there is no road of type '%s'", word);
}
