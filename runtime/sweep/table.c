/* SPDX-License-Identifier: MIT
 * Results of a sweep as a file: CSV, or HDF5 by a plug-in. Rows come one after another and are written in blocks, so
 * that memory does not grow with the number of runs and the bytes do not depend on who made them. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "gic_runtime.h"
#include "host/hdf5.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 4096 /* of a block */, NUMBERS = 1 << 16 /* of a block of a series */ };

static const char series_time[] = "/series/time";

struct Table {
    Pool *pool;
    const SweepForm *form;
    Csv csv;                /* in HDF5 the name of the unfinished file */
    const Hdf5Plugin *hdf5; /* NULL: CSV */
    void *file;
    Sobol *sobol;       /* NULL: the runs are not made for that */
    int64_t runs, row;  /* row: the next one */
    int64_t rows, many; /* rows of a block, of a block of a series */
    double *block;      /* [columns][rows] */
    double *over_time;  /* [series][many][samples] */
};

bool table_is_hdf5(const char *path)
{
    return path_ends(path, ".h5") || path_ends(path, ".hdf5");
}

static const Hdf5Plugin *plugin(Pool *pool)
{
    const char *why;
    const Hdf5Plugin *found = plugin_load(pool, "hdf5.so", HDF5_SYMBOL, &why);
    if (!found)
        diag_fail(program_place(),
                  "on Debian: apt-get install " HDF5_PACKAGES ", then `make` (and `make install`); or -o FILE.csv",
                  "results in HDF5 need its library: %s", why);
    return found;
}

/* ---- HDF5 --------------------------------------------------------------------------------------------------- */

/* What can go wrong is looked for at the end of a block: calls after a failure do no harm. */
static void look(const Table *table)
{
    const char *why = table->hdf5->why(table->file);
    if (!why)
        return;
    why = pool_print(table->pool, "%s", why);
    const char *path = table->csv.path;
    table_abandon((Table *)table);
    diag_fail(program_place(), "is there room on the disk, and may the folder be written?", "can't write %s: %s", path,
              why);
}

/* The path of a column: what would be a path in its name is none. */
static const char *path_of(Pool *pool, const SweepColumn *column)
{
    char *path = pool_print(pool, "/%s/%s", column->group, column->name);
    for (char *c = path + strlen(column->group) + 2; *c; ++c)
        if (*c == '/')
            *c = '.';
    return path;
}

static void check_paths(Pool *pool, const SweepForm *form)
{
    const int count = form->columns + form->series;
    const char **path = pool_alloc(pool, sizeof *path * (size_t)count);
    for (int c = 0; c < count; ++c) {
        const char *name = form->column[c].name;
        path[c] = path_of(pool, &form->column[c]);
        if (!strcmp(name, ".") || !strcmp(path[c], series_time))
            diag_fail_call(program_place(), "give it another name", "nothing can be called '%s' in HDF5", name);
        for (int d = 0; d < c; ++d)
            if (!strcmp(path[c], path[d]))
                diag_fail_call(program_place(), "give one of them another name", "'%s' and '%s' have one name in HDF5",
                               form->column[d].name, name);
    }
}

static void describe(const Table *table, const char *path, const SweepColumn *column)
{
    const Hdf5Plugin *hdf5 = table->hdf5;
    hdf5->attribute(table->file, path, "name", column->name);
    if (column->unit)
        hdf5->attribute(table->file, path, "unit", column->unit);
    hdf5->attribute(table->file, path, "description", column->description);
}

/* Groups in the order of the columns, and the times of the series. */
static void make_layout(Table *table)
{
    const SweepForm *form = table->form;
    const Hdf5Plugin *hdf5 = table->hdf5;
    for (int f = 0; f < form->facts; ++f)
        hdf5->attribute(table->file, "/", form->fact[f].name, form->fact[f].value);
    for (int c = 0; c < form->columns + form->series; ++c) {
        const SweepColumn *column = &form->column[c];
        bool there = false;
        for (int d = 0; d < c; ++d)
            there |= !strcmp(form->column[d].group, column->group);
        if (!there)
            hdf5->group(table->file, pool_print(table->pool, "/%s", column->group));
    }
    for (int c = 0; c < form->columns + form->series; ++c) {
        const SweepColumn *column = &form->column[c];
        const bool run = !strcmp(column->name, "run"), status = !strcmp(column->name, "status");
        const bool series = c >= form->columns, whole = !strcmp(column->group, "runs");
        const char *path = path_of(table->pool, column);
        hdf5->numbers(table->file, &(Hdf5Numbers){.path = path,
                                                  .type = whole && run      ? HDF5_INT64
                                                          : whole && status ? HDF5_INT32
                                                                            : HDF5_DOUBLE,
                                                  .rows = table->runs,
                                                  .columns = series ? form->samples : 0,
                                                  .chunk_rows = series ? table->many : table->rows,
                                                  .chunk_columns = form->samples < NUMBERS ? form->samples : NUMBERS});
        describe(table, path, column);
        look(table);
    }
    if (!form->samples)
        return;
    double *time = pool_alloc(table->pool, (size_t)form->samples * sizeof *time);
    for (int64_t i = 0; i < form->samples; ++i)
        time[i] = (double)i * form->apart;
    const int at =
        hdf5->numbers(table->file, &(Hdf5Numbers){.path = series_time,
                                                  .rows = form->samples,
                                                  .chunk_rows = form->samples < NUMBERS ? form->samples : NUMBERS});
    describe(table, series_time,
             &(SweepColumn){NULL, "time", "s", "output times, of the second index of the other arrays"});
    if (at >= 0)
        hdf5->write(table->file, at, 0, form->samples, time);
    look(table);
}

static Table *open_hdf5(Table *table)
{
    Pool *pool = table->pool;
    const SweepForm *form = table->form;
    table->csv = csv_open(pool, table->csv.path);
    table->rows = table->runs < ROWS ? table->runs : ROWS;
    table->block = pool_alloc(pool, (size_t)table->rows * (size_t)form->columns * sizeof *table->block);
    if (form->samples) {
        table->many = form->samples < NUMBERS ? NUMBERS / form->samples : 1;
        table->many = table->many < table->rows ? table->many : table->rows;
        table->over_time =
            pool_alloc(pool, (size_t)table->many * (size_t)(form->samples * form->series) * sizeof *table->over_time);
    }
    table->file = table->hdf5->create(table->csv.temporary);
    if (!table->file)
        out_of_memory();
    look(table);
    make_layout(table);
    return table;
}

/* The rows of a block that is full, or the last one. */
static void write_block(Table *table)
{
    const SweepForm *form = table->form;
    const int64_t first = (table->row - 1) / table->rows * table->rows;
    for (int c = 0; c < form->columns; ++c)
        table->hdf5->write(table->file, c, first, table->row - first, table->block + c * table->rows);
    look(table);
}

static void write_series(Table *table)
{
    const SweepForm *form = table->form;
    const int64_t first = (table->row - 1) / table->many * table->many;
    for (int s = 0; s < form->series; ++s)
        table->hdf5->write(table->file, form->columns + s, first, table->row - first,
                           table->over_time + s * table->many * form->samples);
    look(table);
}

static void add_row(Table *table, const char *row, const double *series)
{
    const SweepForm *form = table->form;
    const int64_t at = table->row % table->rows;
    char *end;
    for (int c = 0; c < form->columns; ++c, row = *end ? end + 1 : end)
        table->block[c * table->rows + at] = strtod(row, &end);
    for (int s = 0; s < form->series; ++s)
        memcpy(table->over_time + (s * table->many + table->row % table->many) * form->samples,
               series + s * form->samples, (size_t)form->samples * sizeof *series);
    ++table->row;
    if (table->row % table->rows == 0 || table->row == table->runs)
        write_block(table);
    if (form->series && (table->row % table->many == 0 || table->row == table->runs))
        write_series(table);
}

/* Names in their order, line by line. */
static const char *names_of(Pool *pool, const SweepForm *form, const char *group)
{
    Text names = {.pool = pool};
    for (int c = 0; c < form->columns; ++c)
        if (!strcmp(form->column[c].group, group))
            text_print(&names, "%s%s", names.size ? "\n" : "", form->column[c].name);
    return names.s;
}

/* Sobol' indices: for each kind an array of metrics and numbers. */
static void write_sobol(const Table *table)
{
    static const char *const description[SOBOL_NUMBERS] = {
        "Sobol' index of first order", "its 2.5th percentile over resampled base points",
        "its 97.5th percentile",       "total Sobol' index",
        "its 2.5th percentile",        "its 97.5th percentile"};
    static const char group[] = "/sobol", points[] = "/sobol/points";
    const SobolIndices *found = sobol_indices(table->sobol);
    const Hdf5Plugin *hdf5 = table->hdf5;
    Pool *pool = table->pool;
    const int count = found->metrics * found->varied;
    double *value = pool_alloc(pool, sizeof *value * (size_t)(count + 1));
    hdf5->group(table->file, group);
    hdf5->attribute(table->file, group, "metrics", names_of(pool, table->form, "metrics"));
    hdf5->attribute(table->file, group, "numbers", names_of(pool, table->form, "parameters"));
    for (int k = 0; k <= SOBOL_NUMBERS; ++k) {
        const bool last = k == SOBOL_NUMBERS;
        const char *path = last ? points : pool_print(pool, "%s/%s", group, sobol_name[k]);
        for (int i = 0; i < count && !last; ++i)
            value[i] = found->number[i * SOBOL_NUMBERS + k];
        const int at = hdf5->numbers(table->file, &(Hdf5Numbers){.path = path,
                                                                 .type = last ? HDF5_INT64 : HDF5_DOUBLE,
                                                                 .rows = found->metrics,
                                                                 .columns = last ? 0 : found->varied,
                                                                 .chunk_rows = found->metrics,
                                                                 .chunk_columns = found->varied});
        hdf5->attribute(table->file, path, "description",
                        last ? "base points whose runs all have a finite number" : description[k]);
        if (at >= 0)
            hdf5->write(table->file, at, 0, found->metrics, last ? found->points : value);
    }
    look(table);
}

/* ---- either of them ----------------------------------------------------------------------------------------- */

void table_check(Pool *pool, const char *path, const SweepForm *form)
{
    if (!table_is_hdf5(path))
        return;
    if (file_is_special(path))
        diag_fail(program_place(), "name a file", "HDF5 can't go to %s, which is a device or a pipe", path);
    plugin(pool);
    check_paths(pool, form);
}

Table *table_open(Pool *pool, const char *path, const SweepForm *form, int64_t runs)
{
    Table *table = pool_alloc(pool, sizeof *table);
    *table = (Table){.pool = pool, .form = form, .csv = {.path = path}, .runs = runs};
    table->sobol = form->bases ? sobol_open(pool, form) : NULL;
    if (table_is_hdf5(path)) {
        table->hdf5 = plugin(pool);
        return open_hdf5(table);
    }
    table->csv = csv_open(pool, path);
    for (int c = 0; c < form->columns; ++c)
        csv_name(&table->csv, form->column[c].name, form->column[c].unit);
    csv_end_row(&table->csv);
    return table;
}

void table_row(Table *table, const char *row, const double *series)
{
    if (table->sobol)
        sobol_row(table->sobol, row);
    if (table->hdf5) {
        add_row(table, row, series);
        return;
    }
    fputs(row, table->csv.file);
    csv_end_row(&table->csv);
}

void table_close(Table *table)
{
    char why[200];
    if (table->hdf5 && table->sobol)
        write_sobol(table);
    if (table->hdf5 && table->hdf5->close(table->file, why, sizeof why)) {
        csv_abandon(&table->csv);
        diag_fail(program_place(), "is there room on the disk, and may the folder be written?", "can't write %s: %s",
                  table->csv.path, why);
    }
    csv_close(&table->csv);
    if (table->sobol)
        diag_text(sobol_text(table->sobol));
}

void table_abandon(Table *table)
{
    char why[200];
    if (table->hdf5)
        table->hdf5->close(table->file, why, sizeof why);
    csv_abandon(&table->csv);
}
