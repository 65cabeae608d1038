/* SPDX-License-Identifier: MIT
 * The road of a scene: models/SCENE.md section 3. */
#include "base/text.h"
#include "base/yaml.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double far = 1e30; /* m; larger than any place: states end at 2^30 */

static const gic_road *plane_read(Pool *pool, const Item *item)
{
    gic_road_plane *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_plane_height;
    road->head.kind = GIC_ROAD_PLANE;
    road->head.bend = gic_plane_bend;
    road->z0 = scene_number(item, "height", "height of the road", 0);
    road->sx = scene_number(item, "x", "slope of the road along x", 0);
    road->sy = scene_number(item, "y", "slope of the road along y", 0);
    return &road->head;
}

static const gic_road *flat_read(Pool *pool, const Item *item)
{
    CHECK_KEYS(item, "a flat road", "type", "friction", "height");
    return plane_read(pool, item);
}

static const gic_road *slope_read(Pool *pool, const Item *item)
{
    CHECK_KEYS(item, "a slope road", "type", "friction", "height", "x", "y");
    return plane_read(pool, item);
}

static const gic_road *sine_read(Pool *pool, const Item *item)
{
    gic_road_sine *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_sine_height;
    road->head.kind = GIC_ROAD_SINE;
    road->head.bend = gic_sine_bend;
    CHECK_KEYS(item, "a sine road", "type", "friction", "amplitude", "wavelength", "start", "phase_per_y");
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
        bump->y_low = nextafter(2 * GIC_ROAD_EDGE, far); /* ends where the right strip, which includes the edge, begins,
                                                          * as in a table */
    else if (!strcmp(word, "right"))
        bump->y_high = 0;
    else if (strcmp(word, "both"))
        diag_fail(tracks->at, "write left, right or both", "tracks of a bump can't be '%s'", word);
}

static int by_x(const void *a, const void *b)
{
    const gic_bump *p = a, *q = b;
    return (p->x > q->x) - (p->x < q->x);
}

static const gic_road *bumps_read(Pool *pool, const Item *item)
{
    gic_road_bumps *road = pool_alloc(pool, sizeof *road);
    gic_bump *bump = NULL;
    road->head.height = gic_bumps_height;
    road->head.kind = GIC_ROAD_BUMPS;
    road->head.bend = gic_bumps_bend;
    CHECK_KEYS(item, "a road of bumps", "type", "friction", "bumps");
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
    if (bump)
        qsort(bump, (size_t)road->count, sizeof *bump, by_x);
    road->bump = bump;
    gic_road_bumps_setup(road);
    return &road->head;
}

/* Heights at the table's points by one of two keys, or by the key for both tracks. */
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
    if (doc_find(item, "file")) {
        CHECK_KEYS(item, "a road table with a file", "type", "friction", "file");
        return table_file_read(pool, item);
    }
    gic_road_table *road = pool_alloc(pool, sizeof *road);
    road->head.height = gic_table_height;
    road->head.kind = GIC_ROAD_TABLE;
    road->head.bend = gic_table_bend;
    CHECK_KEYS(item, "a road table", "type", "friction", "x", "height", "left", "right");
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

static const gic_road *grid_read(Pool *pool, const Item *item)
{
    CHECK_KEYS(item, "a height field", "type", "friction", "file");
    return grid_file_read(pool, item);
}

/* Numbers above 2^53 may not be exact. */
static uint64_t seed_read(const Item *item)
{
    const double value = doc_number(item, "seed of a random road");
    if (value < 0 || value > 9007199254740992 || value != floor(value))
        diag_fail(item->at, "write 7, for example", "seed of a random road must be a whole number from 0 to 2^53");
    return (uint64_t)value;
}

static double positive_or(const Item *map, const char *key, const char *what, double absent)
{
    const Item *item = doc_find(map, key);
    return item ? scene_positive(item, what) : absent;
}

static const gic_road *iso8608_read(Pool *pool, const Item *item)
{
    const double most_points = 1e7;
    CHECK_KEYS(item, "a random road", "type", "friction", "class", "seed", "length", "start", "spacing", "track",
               "fade");
    const Item *class = scene_need(item, "class", "a random road"), *seed = doc_find(item, "seed");
    const Item *length = scene_need(item, "length", "a random road"), *track = doc_find(item, "track");
    const char *letter = doc_word(class, "class of a random road");
    if (!letter[0] || letter[1] || letter[0] < 'A' || letter[0] > 'H')
        diag_fail(class->at, "write one of A, B, C, D, E, F, G, H: A is the smoothest",
                  "ISO 8608 has no road class '%s'", letter);
    gic_iso8608 profile = {.road_class = letter[0],
                           .seed = seed ? seed_read(seed) : 1,
                           .start = scene_number(item, "start", "start of a random road", 0),
                           .length = scene_positive(length, "length of a random road"),
                           .track = track ? scene_positive(track, "track of a random road") : 1.5,
                           .fade = scene_number(item, "fade", "fade of a random road", 5)};
    const double spacing = positive_or(item, "spacing", "spacing of a random road", 0.05);
    if (profile.fade < 0)
        diag_fail(doc_find(item, "fade")->at, "write 0 or a length in metres",
                  "fade of a random road can't be negative");
    if (!(profile.length / spacing <= most_points))
        diag_fail(length->at, "shorten it, or write a larger spacing", "the random road would have more than %g points",
                  most_points);
    const int32_t count = (int32_t)fmax(round(profile.length / spacing), 1) + 1;
    gic_road_grid *road = pool_alloc(pool, sizeof *road);
    double *height = pool_alloc(pool, 2 * sizeof *height * (size_t)count);
    if (gic_road_iso8608_setup(road, &profile, height, count) != GIC_OK)
        diag_fail((track ? track : item)->at, "write a smaller spacing or a wider track",
                  "points of a random road must be less than a track apart");
    return &road->head;
}

static const gic_road *kind_read(Pool *pool, const Item *item);

static const gic_road *sum_read(Pool *pool, const Item *item)
{
    CHECK_KEYS(item, "a sum of roads", "type", "friction", "roads");
    const Item *list = scene_need(item, "roads", "a sum of roads");
    if (list->kind != ITEM_LIST || !list->count)
        diag_fail(list->at, "write `- {type: ..}`, a line each", "roads must be a list of roads");
    gic_road_sum *road = pool_alloc(pool, sizeof *road);
    const gic_road **part = NULL;
    for (int i = 0; i < list->count; ++i) {
        const gic_road *one = kind_read(pool, list->value[i]);
        const Item *friction = doc_find(list->value[i], "friction");
        if (friction)
            diag_fail(friction->at, "write it beside `roads`", "friction belongs to the sum, not to one of its roads");
        *POOL_PUSH(pool, part, road->count) = one;
    }
    road->head.height = gic_sum_height;
    road->head.kind = GIC_ROAD_SUM;
    road->head.bend = gic_sum_bend;
    road->part = part;
    return &road->head;
}

/* A road without its friction. */
static const gic_road *kind_read(Pool *pool, const Item *item)
{
    static const struct {
        const char *name;
        const gic_road *(*read)(Pool *pool, const Item *item);
    } kind[] = {{"flat", flat_read},   {"slope", slope_read}, {"bumps", bumps_read},     {"sine", sine_read},
                {"table", table_read}, {"grid", grid_read},   {"iso8608", iso8608_read}, {"sum", sum_read}};
    enum { KINDS = sizeof kind / sizeof *kind };
    const char *name[KINDS];
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write `road: {type: flat}`", "the road must be a map");
    const Item *type = scene_need(item, "type", "the road");
    const char *word = doc_word(type, "type of the road");
    for (int i = 0; i < KINDS; ++i) {
        name[i] = kind[i].name;
        if (!strcmp(word, name[i]))
            return kind[i].read(pool, item);
    }
    const char *nearest = diag_nearest(word, name, KINDS);
    Text remedy = {.pool = pool};
    if (nearest)
        text_print(&remedy, "did you mean '%s'? ", nearest);
    for (int i = 0; i < KINDS; ++i)
        text_print(&remedy, "%s%s", i ? ", " : "the types are ", name[i]);
    diag_fail(type->at, remedy.s, "there is no road of type '%s'", word);
}

/* ---- friction ------------------------------------------------------------------------------------------- */

/* [low, high] of a patch along one axis. */
static void patch_edges(const Item *entry, const char *key, double edge[2])
{
    const Item *item = scene_need(entry, key, "a patch");
    doc_vector(item, "edges of a patch", edge, 2);
    if (edge[0] >= edge[1])
        diag_fail(item->at, "write [low, high]", "%s of a patch must rise", key);
}

static void patch_read(const Item *entry, gic_friction_patch *patch)
{
    double x[2], y[2];
    CHECK_KEYS(entry, "a patch", "x", "y", "value", "fade");
    patch_edges(entry, "x", x);
    patch_edges(entry, "y", y);
    const Item *fade = doc_find(entry, "fade");
    *patch = (gic_friction_patch){.x_low = x[0],
                                  .x_high = x[1],
                                  .y_low = y[0],
                                  .y_high = y[1],
                                  .value = scene_positive(scene_need(entry, "value", "a patch"), "friction of a patch"),
                                  .fade = positive_or(entry, "fade", "fade of a patch", 0.1)};
    const double narrow = fmin(x[1] - x[0], y[1] - y[0]);
    if (patch->fade > narrow)
        diag_fail((fade ? fade : entry)->at, "write a smaller fade or a larger patch",
                  "a patch %g m wide has no room for edges of %g m", narrow, patch->fade);
}

static const gic_road *friction_read(Pool *pool, const Item *item, const gic_road *under)
{
    gic_road_patched *road = pool_alloc(pool, sizeof *road);
    gic_friction_patch *patch = NULL;
    CHECK_KEYS(item, "friction", "value", "patches");
    const Item *list = doc_find(item, "patches");
    if (list && list->kind != ITEM_LIST)
        diag_fail(list->at, "write `- {x: [.., ..], y: [.., ..], value: ..}`, a line each", "patches must be a list");
    for (int i = 0; list && i < list->count; ++i)
        patch_read(list->value[i], POOL_PUSH(pool, patch, road->count));
    road->head.height = gic_patched_height;
    road->head.kind = GIC_ROAD_PATCHED;
    road->head.bend = gic_patched_bend;
    road->head.friction = gic_patched_friction;
    road->head.friction_slope = gic_patched_friction_slope;
    road->under = under;
    road->value = positive_or(item, "value", "friction of the road", 1);
    road->patch = patch;
    return &road->head;
}

const gic_road *road_read(Pool *pool, const Item *item)
{
    const gic_road *road = kind_read(pool, item);
    const Item *friction = doc_find(item, "friction");
    return friction ? friction_read(pool, friction, road) : road;
}
