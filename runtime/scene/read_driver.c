/* SPDX-License-Identifier: MIT
 * The driver of a scene: models/SCENE.md section 5. */
#include "base/yaml.h"
#include "host/host.h"
#include "model/model.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "scene/spline.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;
static const double spacing =
    0.1; /* m between points of a path: straight lines between them are 1e-4 m off at 10 m radius */
enum { MOST_POINTS = 1000000 };

/* ---- path -------------------------------------------------------------------------------------------------- */

static void path_room(Pool *pool, Path *path, double length, Place at)
{
    const double pieces = ceil(length / spacing);
    if (!(pieces + 1 <= (int)MOST_POINTS))
        diag_fail(at, "a shorter one", "the path is longer than %g m", (int)MOST_POINTS * spacing);
    path->count = (int)fmax(pieces, 1) + 1;
    path->step = length / (path->count - 1);
    path->point = pool_alloc(pool, sizeof *path->point * (size_t)path->count);
}

/* Points at equal distances along natural (closed: periodic) cubic splines through the given ones, over the sum of
 * chords. */
static void path_through(Pool *pool, Path *path, const double (*point)[2], int count, Place at)
{
    double *s = pool_alloc(pool, sizeof *s * (size_t)count), *x = pool_alloc(pool, sizeof *x * (size_t)count);
    double *y = pool_alloc(pool, sizeof *y * (size_t)count);
    for (int i = 0; i < count; ++i) {
        x[i] = point[i][0];
        y[i] = point[i][1];
        s[i] = i ? s[i - 1] + hypot(x[i] - x[i - 1], y[i] - y[i - 1]) : 0;
        if (i && s[i] - s[i - 1] < 1e-3)
            diag_fail(at, "keep one of the two", "points %d and %d of the path are the same", i, i + 1);
    }
    path_room(pool, path, s[count - 1], at); /* refuses infinite coordinates */
    const double *bend[2] = {spline_bend(pool, s, x, count, path->closed),
                             spline_bend(pool, s, y, count, path->closed)};
    int place[2] = {0};
    for (int i = 0; i < path->count; ++i) {
        const double along = fmin(i * path->step, s[count - 1]);
        path->point[i][0] = spline_value(s, x, bend[0], count, along, &place[0]);
        path->point[i][1] = spline_value(s, y, bend[1], count, along, &place[1]);
    }
}

static void read_points(Pool *pool, const Item *list, Path *path)
{
    if (list->kind != ITEM_LIST || list->count < 2)
        diag_fail(list->at, "write [[x, y], [x, y], ...]", "a path must be a list of at least two points");
    double(*point)[2] = pool_alloc(pool, sizeof *point * (size_t)(list->count + 1));
    for (int i = 0; i < list->count; ++i)
        doc_vector(list->value[i], "a point of the path", point[i], 2);
    memcpy(point[list->count], point[0], sizeof *point);
    path_through(pool, path, (const double(*)[2])point, list->count + path->closed, list->at);
}

static void read_file(Pool *pool, const Item *file, Path *path)
{
    const CsvTable *table = scene_file(pool, file, "path", "x,y");
    int column[2] = {-1, -1};
    for (int i = 0; i < table->columns; ++i)
        for (int k = 0; k < 2; ++k)
            if (!strcmp(table->name[i], k ? "y" : "x"))
                csv_check_unit(pool, table, column[k] = i, "m");
    if (column[0] < 0 || column[1] < 0 || table->rows < 2)
        diag_fail((Place){table->source, 1, 1}, "the first line is `x,y`, each other one a point",
                  "a path needs columns x and y and at least two rows");
    double(*point)[2] = pool_alloc(pool, sizeof *point * (size_t)(table->rows + 1));
    for (int i = 0; i < table->rows; ++i)
        for (int k = 0; k < 2; ++k)
            point[i][k] = table->value[i * table->columns + column[k]];
    memcpy(point[table->rows], point[0], sizeof *point);
    path_through(pool, path, (const double(*)[2])point, table->rows + path->closed, (Place){table->source, 0, 0});
}

/* To the left for a positive radius; the path begins where it is parallel to x. */
static void read_circle(Pool *pool, const Item *item, Path *path)
{
    CHECK_KEYS(item, "a circle", "center", "radius");
    double center[2];
    doc_vector(scene_need(item, "center", "a circle"), "center of the circle", center, 2);
    const Item *size = scene_need(item, "radius", "a circle");
    const double radius = doc_number(size, "radius of the circle");
    if (fabs(radius) < 1)
        diag_fail(size->at, "to the left it is positive, to the right negative",
                  "a circle's radius must be 1 m at least");
    path->closed = true;
    path_room(pool, path, 2 * pi * fabs(radius), item->at);
    for (int i = 0; i < path->count; ++i) {
        const double angle = 2 * pi * i / (path->count - 1) * copysign(1, radius) - copysign(pi / 2, radius);
        path->point[i][0] = center[0] + fabs(radius) * cos(angle);
        path->point[i][1] = center[1] + fabs(radius) * sin(angle);
    }
}

static void read_path(Pool *pool, const Item *item, Path *path)
{
    const char *remedy = "write {points: [[x, y], ...]}, {file: name.csv} or {circle: {center: [x, y], radius: r}}";
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, remedy, "the path must be a map");
    CHECK_KEYS(item, "the path", "points", "file", "circle", "closed");
    const Item *points = doc_find(item, "points"), *file = doc_find(item, "file"), *circle = doc_find(item, "circle");
    const Item *closed = doc_find(item, "closed");
    if (!!points + !!file + !!circle != 1)
        diag_fail(item->at, remedy, "the path must be described in one way");
    path->closed = closed && doc_bool(closed, "closed");
    if (points)
        read_points(pool, points, path);
    else if (file)
        read_file(pool, file, path);
    else
        read_circle(pool, circle, path);
}

/* ---- what it moves ------------------------------------------------------------------------------------------ */

static int find_input(Pool *pool, const Model *model, const Item *map, const char *key, const char *absent)
{
    const Item *item = doc_find(map, key);
    const char *name = item ? doc_word(item, key) : absent;
    const char **known = pool_alloc(pool, sizeof *known * (size_t)(model->inputs + 1));
    int count = 0;
    for (int i = 0; i < model->inputs; ++i)
        if (!strchr(model->input[i].name, '.')) {
            known[count++] = model->input[i].name;
            if (!strcmp(model->input[i].name, name))
                return i;
        }
    if (item)
        scene_name_index(pool, item, name, "input", known, count);
    diag_fail(map->at, pool_print(pool, "add `%s: NAME`, one of the model's inputs", key),
              "the model has no input '%s' for the driver", name);
}

/* An input that a pedal's position, 0 to 1, can be. */
static int find_pedal(Pool *pool, const Model *model, const Item *map, const char *key)
{
    const int index = find_input(pool, model, map, key, key);
    const char *unit = model->input[index].unit;
    const Item *item = doc_find(map, key);
    if (strcmp(unit, "1") != 0)
        diag_fail(
            item ? item->at : map->at,
            pool_print(pool, "give the model an input of unit 1 for it, and multiply it by %s in the formula", unit),
            "the driver moves '%s' from 0 to 1, but the model has it in %s", model->input[index].name, unit);
    return index;
}

static double positive(const Item *map, const char *key, double absent)
{
    const Item *item = doc_find(map, key);
    return item ? scene_positive(item, key) : absent;
}

static double not_negative(const Item *map, const char *key, double absent)
{
    const Item *item = doc_find(map, key);
    const double value = scene_number(map, key, key, absent);
    if (value < 0)
        diag_fail(item->at, "write a number from 0 on", "%s must not be negative", key);
    return value;
}

static void read_speed(Pool *pool, const Model *model, const Item *item, Driver *driver)
{
    CHECK_KEYS(item, "the driver's speed", "target", "accelerator", "brake", "gain", "integral", "full");
    driver->speed = (Profile){.unit = "m/s", .model = model};
    profile_read(pool, scene_need(item, "target", "the driver's speed"), "speed", &driver->speed);
    driver->accelerator = find_pedal(pool, model, item, "accelerator");
    driver->brake = find_pedal(pool, model, item, "brake");
    driver->gain = positive(item, "gain", 1);
    driver->integral = not_negative(item, "integral", 0.1);
    driver->full[0] = 3;
    driver->full[1] = 8;
    const Item *full = doc_find(item, "full");
    if (full)
        doc_vector(full, "full", driver->full, 2);
    if (driver->full[0] <= 0 || driver->full[1] <= 0)
        diag_fail(full->at, "write [acceleration, deceleration] at full pedals, m/s^2", "full must be positive");
}

static void read_steering(Pool *pool, const Model *model, const Item *item, Driver *driver)
{
    CHECK_KEYS(item, "the driver's steering", "path", "input", "wheelbase", "per_angle", "preview", "shortest", "limit",
               "adapt", "straight");
    read_path(pool, scene_need(item, "path", "the driver's steering"), &driver->path);
    driver->steering = find_input(pool, model, item, "input", "steering");
    driver->driven = scene_driven_by(model, driver->steering);
    driver->straight = model->input[driver->steering].initial;
    driver->wheelbase = scene_positive(scene_need(item, "wheelbase", "the driver's steering"), "wheelbase");
    const Item *per_angle = scene_need(item, "per_angle", "the driver's steering");
    driver->per_angle = doc_number(per_angle, "per_angle");
    if (driver->per_angle == 0)
        diag_fail(per_angle->at, "write its value for 1 rad of the front wheels to the left, negative ones are fine",
                  "the driver's steering does nothing");
    driver->preview = positive(item, "preview", 0.6);
    driver->shortest = positive(item, "shortest", 4);
    driver->limit = positive(item, "limit", INFINITY);
    driver->adapt = not_negative(item, "adapt", 0.5);
    const Item *straight = doc_find(item, "straight");
    driver->middle = straight ? doc_number(straight, "straight") : 0;
}

Driver *driver_read(Pool *pool, const Item *item, const Model *model, double step)
{
    Driver *driver = pool_alloc(pool, sizeof *driver);
    if (!model->free_base)
        diag_fail(item->at, "remove it", "a driver, but the base of '%s' is fixed", model->name);
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write {speed: {..}, steering: {..}}", "the driver must be a map");
    CHECK_KEYS(item, "the driver", "speed", "steering", "period", "reach");
    driver->accelerator = driver->brake = driver->steering = -1;
    const Item *speed = doc_find(item, "speed"), *steering = doc_find(item, "steering");
    if (!speed && !steering)
        diag_fail(item->at, "add `speed: {target: 20}` or `steering: {path: ..}`", "the driver has nothing to do");
    if (speed)
        read_speed(pool, model, speed, driver);
    if (steering)
        read_steering(pool, model, steering, driver);
    /* looks coincide with ends of steps, so that all engines look at the same times */
    const Item *period = doc_find(item, "period");
    const double shortest = 0.02;
    driver->period = period     ? scene_positive(period, "period")
                     : step > 0 ? step * ceil(shortest / step - 1e-9)
                                : shortest;
    const double steps = step > 0 ? round(driver->period / step) : 1;
    if (step > 0 && (steps < 1 || fabs(steps * step - driver->period) > 1e-9 * driver->period))
        diag_fail(period->at, pool_print(pool, "write %.15g", fmax(steps, 1) * step),
                  "the driver's period must be a multiple of step (%.15g s)", step);
    driver->reach = positive(item, "reach", 0.1);
    driver_start(driver);
    return driver;
}
