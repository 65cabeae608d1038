/* SPDX-License-Identifier: MIT
 * Pictures by gnuplot: curves over time, one panel a unit, and panels of one signal over another. */
#include "gicrun.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 900, PANEL_HEIGHT = 420 };

bool plot_known(const char *path)
{
    return path_ends(path, ".svg") || path_ends(path, ".png");
}

/* A character of a text in double quotes, where all but letters are octal: there are escapes in them, backquotes are
 * commands, and a digit behind an octal number would belong to it. */
static void plot_character(Text *text, char c)
{
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    text_print(text, letter ? "%c" : "\\%03o", (unsigned char)c);
}

/* In single quotes all is as it stands, but two of them at the beginning are a text of their own, and the end of a line
 * ends it. gnuplot writes a `>` into an SVG as it is, which behind `]]` is no XML. */
void plot_text(Text *text, const char *s)
{
    const char *c = s;
    while ((unsigned char)*c >= ' ' && *c != '\'' && *c != '>')
        ++c;
    if (!*c) {
        text_print(text, "'%s'", s);
        return;
    }
    text_print(text, "\"");
    for (c = s; *c; ++c) {
        if (*c == '>' && c - s >= 2 && c[-1] == ']' && c[-2] == ']')
            plot_character(text, ' ');
        plot_character(text, *c);
    }
    text_print(text, "\"");
}

/* Is curve i the first of its unit? */
static bool opens_panel(const Plot *plot, int i)
{
    for (int k = 0; k < i; ++k)
        if (!strcmp(plot->signal[k].unit, plot->signal[i].unit))
            return false;
    return true;
}

static void data_block(Text *script, const Plot *plot)
{
    const int signals = plot->curves + 2 * plot->panels;
    text_print(script, "$data << END\n");
    for (int row = 0; row < plot->rows; ++row)
        for (int k = 0; k <= signals; ++k)
            text_print(script, "%.9g%c", plot->sample[row * (signals + 1) + k], k < signals ? ' ' : '\n');
    text_print(script, "END\n");
}

static void panel(Text *script, const Plot *plot, int first, bool last)
{
    text_print(script, "set xlabel %s\nset ylabel ", last ? "'time [s]'" : "''");
    plot_text(script, plot->signal[first].unit);
    text_print(script, "\nplot ");
    for (int i = first, drawn = 0; i < plot->curves; ++i) {
        if (strcmp(plot->signal[i].unit, plot->signal[first].unit))
            continue;
        text_print(script, "%s$data using 1:%d with lines linewidth 1.5 title ", drawn++ ? ", " : "", i + 2);
        plot_text(script, plot->signal[i].name);
    }
    text_print(script, "\n");
}

static void axis_label(Text *script, char axis, const gic_signal *signal)
{
    text_print(script, "set %clabel ", axis);
    plot_text(script, pool_print(script->pool, "%s [%s]", signal->name, signal->unit));
    text_print(script, "\n");
}

/* From the least to the largest value of a signal. */
static double spread(const Plot *plot, int signal)
{
    const int row = plot->curves + 2 * plot->panels + 1;
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < plot->rows; ++i) {
        low = fmin(low, plot->sample[i * row + signal + 1]);
        high = fmax(high, plot->sample[i * row + signal + 1]);
    }
    return high - low;
}

/* Of lengths over lengths the shape is to be seen as it is, where both extend far enough to be seen at all. */
static bool equal_scales(const Plot *plot, int x, int y)
{
    const double most = 10, across = spread(plot, x), up = spread(plot, y);
    return !strcmp(plot->signal[x].unit, plot->signal[y].unit) && across <= most * up && up <= most * across;
}

static void panel_over(Text *script, const Plot *plot, int panel)
{
    const int x = plot->curves + 2 * panel, y = x + 1;
    axis_label(script, 'x', &plot->signal[x]);
    axis_label(script, 'y', &plot->signal[y]);
    /* numbers below a narrow panel stand upright */
    text_print(script, equal_scales(plot, x, y) ? "set size ratio -1\nset xtics rotate\n"
                                                : "set size noratio\nset xtics norotate\n");
    text_print(script, "plot $data using %d:%d with lines linewidth 1.5 notitle\n", x + 2, y + 2);
}

static const char *plot_script(Pool *pool, const Plot *plot, const char *path)
{
    Text script = {.pool = pool};
    int over_time = 0, done = 0;
    for (int i = 0; i < plot->curves; ++i)
        over_time += opens_panel(plot, i);
    const int panels = over_time + plot->panels;
    data_block(&script, plot);
    text_print(&script, "set terminal %s size %d,%d noenhanced\n",
               path_ends(path, ".svg") ? "svg background 'white'" : "pngcairo", WIDTH, PANEL_HEIGHT * panels + 40);
    text_print(&script,
               "set grid\nset key outside center top horizontal\nset lmargin 10\nset tmargin 4\n"
               "set multiplot layout %d,1 title ",
               panels);
    plot_text(&script, plot->title);
    text_print(&script, "\n");
    for (int i = 0; i < plot->curves; ++i)
        if (opens_panel(plot, i))
            panel(&script, plot, i, ++done == over_time);
    for (int i = 0; i < plot->panels; ++i)
        panel_over(&script, plot, i);
    text_print(&script, "unset multiplot\n");
    return script.s;
}

/* gnuplot notices no full disk. Does the file end as a picture does: in </svg>, or in the chunk IEND of a PNG? */
static bool is_whole(const char *path)
{
    enum { END = 12 }; /* bytes of an IEND: length, name, sum */
    char end[END + 1] = "";
    FILE *file = fopen(path, "rb");
    const bool read = file && !fseek(file, -END, SEEK_END) && fread(end, 1, END, file) == END;
    if (file)
        fclose(file);
    return read && (strstr(end, "</svg>") || !memcmp(end + 4, "IEND", 4));
}

int gnuplot_run(Pool *pool, const char *script, const char *path, const char **said)
{
    char *const argv[] = {"gnuplot", "-", NULL};
    char *temporary;
    interrupt_hold();
    FILE *file = temporary_open(pool, path, &temporary);
    if (!file) {
        *said = strerror(errno);
        interrupt_release();
        return PLOT_NO_FILE;
    }
    /* gnuplot opens no file itself: a name may have become a link since */
    int status = process_run_into(pool, argv, script, fileno(file), said);
    fclose(file);
    if (!status && !is_whole(temporary)) {
        *said = pool_print(pool, "%sgnuplot left half a picture\n", *said);
        status = 1;
    }
    if (!status && rename(temporary, path)) {
        *said = pool_print(pool, "%s\n", strerror(errno));
        status = 1;
    }
    if (status)
        unlink(temporary);
    interrupt_release();
    return status;
}

static _Noreturn void gnuplot_missing(const char *said)
{
    diag_fail(program_place(), "install it (Debian: apt-get install gnuplot-nox), or run without --plot",
              "no picture: gnuplot can't be started: %s", said);
}

void plot_check(Pool *pool)
{
    char *const argv[] = {"gnuplot", "--version", NULL};
    const char *said = "";
    interrupt_hold();
    const int status = process_run(pool, argv, "", &said);
    interrupt_release();
    if (status == PROCESS_NOT_STARTED)
        gnuplot_missing(said);
}

void plot_write(Pool *pool, const Plot *plot, const char *path)
{
    const char *said = "";
    const int status = gnuplot_run(pool, plot_script(pool, plot, path), path, &said);
    if (status == PLOT_NO_FILE)
        diag_fail(program_place(), "is the folder still there?", "can't create %s: %s", path, said);
    if (status == PROCESS_NOT_STARTED)
        gnuplot_missing(said);
    if (status) {
        fputs(said, stderr);
        diag_fail(program_place(), "gnuplot's messages are above; is there room on the disk?",
                  "no picture: %s could not be drawn", path);
    }
}
