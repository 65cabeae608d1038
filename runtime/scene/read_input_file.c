/* SPDX-License-Identifier: MIT
 * Inputs from tables of samples (CSV): models/SCENE.md section 4. */
#include "base/text.h"
#include "base/yaml.h"
#include "host/host.h"
#include "model/model.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char header[] = "time [s],steering [rad],brake";

/* Units that are converted, and their factors. */
static const struct {
    const char *from, *to;
    double factor;
} conversion[] = {{"ms", "s", 1e-3},
                  {"min", "s", 60},
                  {"deg", "rad", 0.017453292519943295},
                  {"deg/s", "rad/s", 0.017453292519943295},
                  {"rpm", "rad/s", 0.10471975511965977},
                  {"mm", "m", 1e-3},
                  {"cm", "m", 1e-2},
                  {"mm/s", "m/s", 1e-3},
                  {"km/h", "m/s", 1 / 3.6},
                  {"kN", "N", 1e3},
                  {"kN m", "N m", 1e3},
                  {"%", "1", 1e-2}};

/* The factor from the unit of a column to `unit`. */
static double factor_of(Pool *pool, const CsvTable *table, int column, const char *unit)
{
    for (size_t i = 0; table->unit[column] && i < sizeof conversion / sizeof *conversion; ++i)
        if (!strcmp(table->unit[column], conversion[i].from) && !strcmp(unit, conversion[i].to))
            return conversion[i].factor;
    csv_check_unit(pool, table, column, unit);
    return 1;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Samples are missing if an interval is many times as long as most; a spline would overshoot there. */
static void check_gaps(Pool *pool, const CsvTable *table, const double *time, int count)
{
    enum {
        RECORDING = 20,
        MISSING = 20
    }; /* least number of samples of a recording; ratio of intervals that is a gap
        */
    if (count < RECORDING)
        return;
    double *width = pool_alloc(pool, sizeof *width * (size_t)count);
    for (int i = 0; i + 1 < count; ++i)
        width[i] = time[i + 1] - time[i];
    qsort(width, (size_t)count - 1, sizeof *width, ascending);
    const double usual = width[(count - 1) / 2];
    for (int i = 0; i + 1 < count; ++i)
        if (time[i + 1] - time[i] > (double)MISSING * usual)
            diag_fail(csv_place(table, i + 1),
                      "add the samples that are missing, or write `fit: monotone`, which goes straight over gaps",
                      "there is no sample between %.9g s and %.9g s, and elsewhere one every %.3g s", time[i],
                      time[i + 1], usual);
}

int samples_read(Pool *pool, const CsvTable *table, int column, const char *unit, bool monotone, double **time,
                 double **value)
{
    const size_t size = sizeof(double) * ((size_t)table->rows + 1);
    double *t = *time = pool_alloc(pool, size), *v = *value = pool_alloc(pool, size);
    const double second = factor_of(pool, table, 0, "s"), factor = unit ? factor_of(pool, table, column, unit) : 1;
    for (int i = 0; i < table->rows; ++i) {
        t[i] = second * table->value[i * table->columns];
        v[i] = factor * table->value[i * table->columns + column];
        if (i && t[i] <= t[i - 1])
            diag_fail(csv_place(table, i), "sort the rows by time and keep one of equals",
                      "times must rise: after %.9g s comes %.9g s", t[i - 1], t[i]);
    }
    if (!table->rows)
        diag_fail((Place){table->source, 0, 0}, "add rows: one for each sample", "the table has no samples");
    if (!monotone)
        check_gaps(pool, table, t, table->rows);
    return table->rows;
}

/* The table that an item names; its first column is the time. */
static const CsvTable *table_of(Pool *pool, const Item *name)
{
    const CsvTable *table = scene_file(pool, name, "table of inputs", header);
    if (strcmp(table->name[0], "time") && strcmp(table->name[0], "t"))
        diag_fail(csv_name_place(table, 0), "put the column `time [s]` first",
                  "the first column of a table of inputs must be the time, not '%s'", table->name[0]);
    return table;
}

/* The column of a name; results of gicrun have `input.` before it. -1: there is none. */
static int column_named(const CsvTable *table, const char *name)
{
    static const char before[] = "input.";
    for (int i = 1; i < table->columns; ++i) {
        const char *column = table->name[i];
        if (!strcmp(column, name) ||
            (!strncmp(column, before, sizeof before - 1) && !strcmp(column + sizeof before - 1, name)))
            return i;
    }
    return -1;
}

void profile_read_file(Pool *pool, const Item *item, const char *input, Profile *profile)
{
    CHECK_KEYS(item, "a file input", "name", "column", "fit", "scale", "offset");
    const Item *column = doc_find(item, "column"), *scale = doc_find(item, "scale");
    const CsvTable *table = table_of(pool, scene_need(item, "name", "a file input"));
    const char *name = column ? doc_word(column, "column") : input;
    const int at = name ? column_named(table, name) : 1;
    if (at < 0 || at >= table->columns) {
        const char *nearest = name ? diag_nearest(name, table->name + 1, table->columns - 1) : NULL;
        Text all = {.pool = pool};
        for (int i = 1; i < table->columns && i <= 16; ++i)
            text_print(&all, "%s%s", i > 1 ? ", " : "write `column: ...` with one of: ", table->name[i]);
        diag_fail(column ? column->at : item->at,
                  nearest              ? pool_print(pool, "did you mean `column: %s`?", nearest)
                  : table->columns > 1 ? all.s
                                       : "add a column to it",
                  "the table %s has no column '%s'", table->source->path, name ? name : "behind the time");
    }
    const bool monotone = profile_fit_monotone(doc_find(item, "fit"), profile->driven);
    const double factor = scene_number(item, "scale", "scale", 1), offset = scene_number(item, "offset", "offset", 0);
    double *time, *value;
    const int count = samples_read(pool, table, at, scale ? NULL : profile->unit, monotone, &time, &value);
    for (int i = 0; i < count && (scale || offset != 0); ++i)
        value[i] = offset + factor * value[i];
    profile_through(pool, profile, count, time, value, monotone);
}

void scene_read_input_file(Pool *pool, const Item *item, const Model *model, const char *const *name, Scene *scene)
{
    const Item *file = item, *fit = NULL;
    if (item->kind == ITEM_MAP) {
        CHECK_KEYS(item, "input_file", "name", "fit");
        file = scene_need(item, "name", "input_file");
        fit = doc_find(item, "fit");
    }
    const CsvTable *table = table_of(pool, file);
    static const char before[] = "input.";
    for (int i = 1; i < table->columns; ++i) {
        const size_t skip = strncmp(table->name[i], before, sizeof before - 1) ? 0 : sizeof before - 1;
        const Item key = {.at = csv_name_place(table, i), .text = table->name[i] + skip};
        Profile *profile = scene_profile(pool, model, scene, &key, name);
        const bool monotone = profile_fit_monotone(fit, profile->driven);
        double *time, *value;
        const int count = samples_read(pool, table, i, profile->unit, monotone, &time, &value);
        profile_through(pool, profile, count, time, value, monotone);
        scene_check_profile(scene, model, profile, key.at);
    }
}
