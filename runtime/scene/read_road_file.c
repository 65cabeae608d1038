/* SPDX-License-Identifier: MIT
 * Roads from files: models/SCENE.md section 3. */
#include "base/file.h"
#include "base/yaml.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const CsvTable *scene_file(Pool *pool, const Item *item, const char *what, const char *header)
{
    const char *name = doc_word(item, pool_print(pool, "file of a %s", what)), *scene = item->at.source->path,
               *slash = strrchr(scene, '/');
    const char *path = name;
    struct stat about;
    if (name[0] != '/' && slash)
        path = pool_print(pool, "%.*s%s", (int)(slash + 1 - scene), scene, name);
    if (!name[0] || !strcmp(name, "-"))
        diag_fail(item->at, "name a file; paths start in the folder of the scene", "'%s' is no file of a %s", name,
                  what);
    if (stat(path, &about) || access(path, R_OK))
        diag_fail(item->at, errno == EACCES ? file_remedy(errno) : "paths start in the folder of the scene",
                  "can't read the %s '%s': %s", what, path, strerror(errno));
    if (S_ISDIR(about.st_mode))
        diag_fail(item->at, "name a file in it", "can't read the %s '%s': it is a folder", what, path);
    if (!S_ISREG(about.st_mode))
        diag_fail(item->at, "name a file", "can't read the %s '%s': it is a device or a pipe", what, path);
    return csv_read(pool, path, header, item->at.source);
}

/* Refuse columns other than the `count` known ones. */
static void check_columns(Pool *pool, const CsvTable *table, const char *const *known, int count, const char *header)
{
    for (int i = 0; i < table->columns; ++i) {
        int k = 0;
        while (k < count && strcmp(known[k], table->name[i]))
            ++k;
        if (k == count)
            diag_fail(csv_name_place(table, i), pool_print(pool, "the columns are %s", header),
                      "a road knows no column '%s'", table->name[i]);
        csv_check_unit(pool, table, i, "m");
    }
}

/* Index of a column; -1: none. */
static int column_find(const CsvTable *table, const char *name)
{
    for (int i = 0; i < table->columns; ++i)
        if (!strcmp(table->name[i], name))
            return i;
    return -1;
}

/* The numbers of a required column. */
static double *column_need(Pool *pool, const CsvTable *table, const char *name, const char *header)
{
    const int column = column_find(table, name);
    if (column < 0)
        diag_fail(csv_name_place(table, 0), pool_print(pool, "the columns are %s", header),
                  "the column '%s' is missing", name);
    double *out = pool_alloc(pool, sizeof *out * (size_t)(table->rows + 1));
    for (int i = 0; i < table->rows; ++i)
        out[i] = table->value[i * table->columns + column];
    return out;
}

const gic_road *table_file_read(Pool *pool, const Item *item)
{
    static const char *const columns[] = {"x", "left", "right", "height"};
    const char *header = "x,left,right or x,height";
    const CsvTable *table = scene_file(pool, doc_find(item, "file"), "road", header);
    gic_road_table *road = pool_alloc(pool, sizeof *road);
    check_columns(pool, table, columns, 4, header);
    const int shared = column_find(table, "height");
    if (shared >= 0 && table->columns > 2)
        diag_fail(csv_name_place(table, shared), "give height for both tracks, or left and right",
                  "the file has height beside left or right");
    const double *x = column_need(pool, table, "x", header);
    road->left = column_need(pool, table, shared >= 0 ? "height" : "left", header);
    road->right = shared >= 0 ? road->left : column_need(pool, table, "right", header);
    if (table->rows < 2)
        diag_fail((Place){table->source, 0, 0}, "add rows: one for each point", "a road table needs two points");
    for (int i = 1; i < table->rows; ++i)
        if (x[i] <= x[i - 1])
            diag_fail(csv_place(table, i), "sort the points by x and keep one of equals",
                      "x of a road table must rise: after %g comes %g", x[i - 1], x[i]);
    road->head.height = gic_table_height;
    road->head.kind = GIC_ROAD_TABLE;
    road->head.bend = gic_table_bend;
    road->x = x;
    road->count = table->rows;
    road->slope_left = pool_alloc(pool, sizeof(double) * (size_t)table->rows);
    road->slope_right = pool_alloc(pool, sizeof(double) * (size_t)table->rows);
    gic_road_table_setup(road);
    return &road->head;
}

/* A point of a height field, and where it stands. */
typedef struct Point {
    double x, y, z;
    int row;
} Point;

static int by_place(const void *a, const void *b)
{
    const Point *p = a, *q = b;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->row - q->row;
}

/* Points in the order of the nodes, x fastest. */
static Point *points_sorted(Pool *pool, const CsvTable *table)
{
    const char *header = "x,y,z";
    const double *x = column_need(pool, table, "x", header), *y = column_need(pool, table, "y", header);
    const double *z = column_need(pool, table, "z", header);
    Point *point = pool_alloc(pool, sizeof *point * (size_t)(table->rows + 1));
    for (int i = 0; i < table->rows; ++i)
        point[i] = (Point){x[i], y[i], z[i], i};
    qsort(point, (size_t)table->rows, sizeof *point, by_place);
    for (int i = 1; i < table->rows; ++i)
        if (point[i].x == point[i - 1].x && point[i].y == point[i - 1].y)
            diag_fail(csv_place(table, point[i].row), "keep one of them",
                      "the point at x = %g, y = %g is on line %d already", point[i].x, point[i].y,
                      csv_place(table, point[i - 1].row).line);
    return point;
}

const gic_road *grid_file_read(Pool *pool, const Item *item)
{
    static const char *const columns[] = {"x", "y", "z"};
    const CsvTable *table = scene_file(pool, scene_need(item, "file", "a height field"), "road", "x,y,z");
    check_columns(pool, table, columns, 3, "x,y,z");
    const Point *point = points_sorted(pool, table);
    const Place whole = {table->source, 0, 0};
    int nx = 0, ny = 0;
    while (nx < table->rows && point[nx].y == point[0].y)
        ++nx;
    for (int i = 0; i < table->rows; ++i)
        ny += !i || point[i].y != point[i - 1].y;
    if (nx < 2 || ny < 2)
        diag_fail(whole, "one row x,y,z for each node of a grid", "a height field needs two nodes along x and along y");
    gic_road_grid *road = pool_alloc(pool, sizeof *road);
    double *height = pool_alloc(pool, sizeof *height * (size_t)table->rows);
    *road = (gic_road_grid){.head = {gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID},
                            .x0 = point[0].x,
                            .y0 = point[0].y,
                            .dx = (point[nx - 1].x - point[0].x) / (nx - 1),
                            .dy = (point[table->rows - 1].y - point[0].y) / (ny - 1),
                            .nx = nx,
                            .ny = ny,
                            .height = height};
    const double least = 1e-9, most = 1e9; /* m; spacings that numbers can resolve */
    if (!(road->dx >= least && road->dy >= least && road->dx <= most && road->dy <= most))
        diag_fail(whole, "give x and y in metres", "nodes of the height field are %g m apart along x, %g m along y",
                  road->dx, road->dy);
    for (int i = 0; i < table->rows; ++i) {
        /* coordinates may be rounded to some digits */
        const double x = road->x0 + i % nx * road->dx, y = road->y0 + i / nx * road->dy, share = 1e-3;
        if (fabs(point[i].x - x) > share * road->dx || fabs(point[i].y - y) > share * road->dy)
            diag_fail(csv_place(table, point[i].row),
                      "nodes are evenly spaced along x and along y, and none is missing",
                      "the height field has the point x = %g, y = %g where x = %g, y = %g should be", point[i].x,
                      point[i].y, x, y);
        height[i] = point[i].z;
    }
    if (table->rows % nx)
        diag_fail(csv_place(table, point[table->rows - 1].row),
                  "nodes are evenly spaced along x and along y, and none is missing",
                  "the height field ends at x = %g, y = %g, not at x = %g", point[table->rows - 1].x,
                  point[table->rows - 1].y, point[nx - 1].x);
    return &road->head;
}
