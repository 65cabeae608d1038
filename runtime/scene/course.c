/* SPDX-License-Identifier: MIT
 * Cones and lanes of a scene for the page of --animate: models/SCENE.md section 12. */
#include "base/yaml.h"
#include "scene/scene.h"

#include <math.h>

enum { MOST_CONES = 10000 };

static void read_points(Pool *pool, const Item *list, const char *what, int least, Mark *mark)
{
    if (list->kind != ITEM_LIST || list->count < least)
        diag_fail(list->at, "write [[x, y], [x, y], ...]", "%s must be a list of at least %d point%s", what, least,
                  least == 1 ? "" : "s");
    mark->count = list->count;
    mark->point = pool_alloc(pool, sizeof *mark->point * (size_t)list->count);
    for (int i = 0; i < list->count; ++i)
        doc_vector(list->value[i], what, mark->point[i], 2);
}

static void add_cone(Pool *pool, RoadCourse *course, const double at[2], Place place)
{
    if (course->cones.count == MOST_CONES)
        diag_fail(place, "fewer cones", "the course has more than %d cones", MOST_CONES);
    double(*cone)[2] = POOL_PUSH(pool, course->cones.point, course->cones.count);
    (*cone)[0] = at[0];
    (*cone)[1] = at[1];
}

/* The line parallel to another at a distance to its left; corners are on the bisector. */
static Mark beside(Pool *pool, const Mark *line, double distance, Place at)
{
    Mark out = {line->count, pool_alloc(pool, sizeof *out.point * (size_t)line->count)};
    double before[2] = {0}, ahead[2] = {0};
    for (int i = 0; i < line->count; ++i) {
        const double *p = line->point[i], *q = line->point[i + 1 < line->count ? i + 1 : i];
        const double length = hypot(q[0] - p[0], q[1] - p[1]);
        if (i + 1 < line->count && !(length > 1e-3))
            diag_fail(at, "keep one of the two", "points %d and %d of the lane are the same", i + 1, i + 2);
        for (int k = 0; k < 2 && i + 1 < line->count; ++k)
            ahead[k] = (q[k] - p[k]) / length;
        const double *first = i ? before : ahead;
        const double shared = 1 + first[0] * ahead[0] + first[1] * ahead[1];
        if (!(shared > 0.1))
            diag_fail(at, "more points along the bend", "the lane turns back at point %d", i + 1);
        out.point[i][0] = p[0] - distance * (first[1] + ahead[1]) / shared;
        out.point[i][1] = p[1] + distance * (first[0] + ahead[0]) / shared;
        before[0] = ahead[0];
        before[1] = ahead[1];
    }
    return out;
}

/* Cones at equal distances from a line's first point to its last. */
static void add_cones(Pool *pool, RoadCourse *course, const Mark *line, int cones, Place at)
{
    double length = 0, done = 0;
    for (int i = 1; i < line->count; ++i)
        length += hypot(line->point[i][0] - line->point[i - 1][0], line->point[i][1] - line->point[i - 1][1]);
    for (int i = 1, next = 0; i < line->count; ++i) {
        const double *p = line->point[i - 1], *q = line->point[i];
        const double piece = hypot(q[0] - p[0], q[1] - p[1]);
        for (; next < cones; ++next) {
            const double along = (cones > 1 ? length * next / (cones - 1) : 0) - done,
                         share = piece > 0 ? along / piece : 0;
            if (along > piece && i + 1 < line->count)
                break;
            add_cone(pool, course, (double[]){p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])}, at);
        }
        done += piece;
    }
}

static void read_lane(Pool *pool, const Item *item, RoadCourse *course)
{
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write {points: [[x, y], ...], width: w}", "a lane must be a map");
    CHECK_KEYS(item, "a lane", "points", "width", "cones");
    Mark middle;
    read_points(pool, scene_need(item, "points", "a lane"), "points of a lane", 2, &middle);
    const double width = scene_positive(scene_need(item, "width", "a lane"), "width of a lane");
    const Item *cones = doc_find(item, "cones");
    const double count = cones ? doc_number(cones, "cones of a lane") : 0;
    if (count != floor(count) || count < 0 || count > (double)MOST_CONES)
        diag_fail(cones->at, "write how many stand along each edge", "cones of a lane must be a whole number up to %d",
                  MOST_CONES);
    for (int side = -1; side <= 1; side += 2) {
        Mark *edge = POOL_PUSH(pool, course->edge, course->edges);
        *edge = beside(pool, &middle, side * width / 2, item->at);
        add_cones(pool, course, edge, (int)count, item->at);
    }
}

RoadCourse *course_read(Pool *pool, const Item *item)
{
    RoadCourse *course = pool_alloc(pool, sizeof *course);
    *course = (RoadCourse){.edge = NULL};
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write {cones: [[x, y], ...], lanes: [{points: [[x, y], ...], width: w}]}",
                  "the course must be a map");
    CHECK_KEYS(item, "the course", "cones", "lanes");
    const Item *cones = doc_find(item, "cones"), *lanes = doc_find(item, "lanes");
    if (lanes && (lanes->kind != ITEM_LIST || !lanes->count))
        diag_fail(lanes->at, "write [{points: [[x, y], ...], width: w}]", "lanes must be a list");
    for (int i = 0; lanes && i < lanes->count; ++i)
        read_lane(pool, lanes->value[i], course);
    Mark single = {0, NULL};
    if (cones)
        read_points(pool, cones, "cones", 1, &single);
    for (int i = 0; i < single.count; ++i)
        add_cone(pool, course, single.point[i], cones->at);
    return course;
}
