/* SPDX-License-Identifier: MIT
 * Objects on the road of the page: cones, edges of lanes, the driver's path. */
#include "base/text.h"
#include "run/animate.h"
#include "scene/driver.h"
#include "scene/scene.h"

#include <math.h>

/* A path with more points loses those that change its shape least; about 50 kB. */
enum { MOST_POINTS = 3000 };

static void json_points(Text *out, const char *key, const double (*point)[2], int count, int every)
{
    text_print(out, "\"%s\":[", key);
    for (int i = 0; i < count; i += i + every < count || i == count - 1 ? every : count - 1 - i)
        text_print(out, "%s[%.6g,%.6g]", i ? "," : "", point[i][0], point[i][1]);
    text_print(out, "]");
}

void json_course(Text *out, const Scene *scene)
{
    const RoadCourse none = {.edge = NULL}, *course = scene->course ? scene->course : &none;
    const Path *path = scene->driver && scene->driver->steering >= 0 ? &scene->driver->path : NULL;
    text_print(out, "\"course\":{");
    json_points(out, "cones", (const double(*)[2])course->cones.point, course->cones.count, 1);
    text_print(out, ",\"edges\":[");
    for (int i = 0; i < course->edges; ++i) {
        text_print(out, i ? ",{" : "{");
        json_points(out, "points", (const double(*)[2])course->edge[i].point, course->edge[i].count, 1);
        text_print(out, "}");
    }
    text_print(out, "],");
    /* points of a path are 0.1 m apart: every third follows all bends that a vehicle can */
    const int every = path ? (int)fmax(3, ceil((double)path->count / (double)MOST_POINTS)) : 1;
    json_points(out, "path", path ? (const double(*)[2])path->point : NULL, path ? path->count : 0, every);
    text_print(out, "}");
}
