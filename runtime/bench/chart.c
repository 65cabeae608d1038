/* SPDX-License-Identifier: MIT
 * Charts with logarithmic axes, by gnuplot. */
#include "base/file.h"
#include "base/message.h"
#include "bench/bench.h"
#include "host/axis.h"
#include "host/host.h"

#include <math.h>
#include <string.h>

void chart_point(Pool *pool, Chart *chart, const char *series, int group, double x, double y)
{
    int i = 0;
    if (!(x > 0 && y > 0 && isfinite(x) && isfinite(y)))
        return;
    while (i < chart->count && strcmp(chart->series[i].name, series))
        ++i;
    if (i == chart->count)
        *POOL_PUSH(pool, chart->series, chart->count) = (Series){.name = series, .group = group};
    Series *s = &chart->series[i];
    int points = s->points;
    *POOL_PUSH(pool, s->x, points) = x;
    *POOL_PUSH(pool, s->y, s->points) = y;
}

enum { WIDE = 900, TALL = 560 /* pixels of a chart */ };

static void chart_data(Text *out, const Chart *chart, int number)
{
    for (int i = 0; i < chart->count; ++i) {
        const Series *s = &chart->series[i];
        text_print(out, "$data%d_%d << END\n", number, i);
        for (int k = 0; k < s->points; ++k)
            text_print(out, "%.9g %.9g\n", s->x[k], s->y[k]);
        text_print(out, "END\n");
    }
}

static void chart_curves(Text *out, const Chart *chart, int number)
{
    const char *const label[][2] = {{"title", chart->title}, {"xlabel", chart->x}, {"ylabel", chart->y}};
    for (int i = 0; i < 3; ++i) {
        text_print(out, "set %s ", label[i][0]);
        plot_text(out, label[i][1]);
        text_print(out, "\n");
    }
    text_print(out, "set key outside %s\n",
               chart->under ? "below center horizontal Left reverse maxcols 3 samplen 2" : "right");
    for (int i = 0; i < chart->count; ++i) {
        const Series *s = &chart->series[i];
        int member = 1;
        for (int k = 0; k < i; ++k)
            member += chart->series[k].group == s->group;
        text_print(out, "%s$data%d_%d with linespoints linecolor %d pointtype %d dashtype %d title ",
                   i ? ", " : "plot ", number, i, s->group + 1, 2 * member + 3, member);
        plot_text(out, s->name);
    }
    text_print(out, "\n");
}

/* One chart, or several in two columns. */
static const char *charts_script(Pool *pool, const Chart *const *chart, int count, const char *path)
{
    Text out = {.pool = pool};
    const int columns = count > 1 ? 2 : 1, rows = (count + columns - 1) / columns;
    text_print(&out, "set encoding utf8\nset terminal %s size %d,%d noenhanced background 'white'\n",
               path_ends(path, ".png") ? "pngcairo font 'sans,10'" : "svg", columns * WIDE, rows * TALL);
    text_print(&out, "set logscale xy\nset format xy '%%g'\nset pointsize 0.6\n"
                     "set grid back linetype 1 linewidth 0.5 linecolor rgb '#d5dce2'\n"
                     "set border 3 linewidth 0.8 linecolor rgb '#5c6873'\nset tics nomirror out scale 0.5\n");
    for (int i = 0; i < AXIS_INKS; ++i)
        text_print(&out, "set linetype %d linecolor rgb '%s'\n", i + 1, axis_ink(i));
    for (int i = 0; i < count; ++i)
        chart_data(&out, chart[i], i);
    if (count > 1)
        text_print(&out, "set multiplot layout %d,%d\n", rows, columns);
    for (int i = 0; i < count; ++i)
        chart_curves(&out, chart[i], i);
    text_print(&out, count > 1 ? "unset multiplot\n" : "");
    return out.s;
}

void charts_write(Pool *pool, const Chart *const *chart, int count, const char *path)
{
    const char *said = "";
    const int status = gnuplot_run(pool, charts_script(pool, chart, count, path), path, &said);
    if (status)
        diag_fail(program_place(), "gnuplot draws it (Debian: apt-get install gnuplot-nox)", "no picture %s: %s", path,
                  said);
}

void chart_write(Pool *pool, const Chart *chart, const char *path)
{
    charts_write(pool, &chart, 1, path);
}
