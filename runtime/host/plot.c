/* SPDX-License-Identifier: MIT
 * Pictures by gnuplot: curves over time, one panel a unit, and panels of one signal over another. */
#include "base/file.h"
#include "base/message.h"
#include "gic_runtime.h"
#include "host/axis.h"
#include "host/host.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Pixels: size of the picture; height of a panel over time, largest height of one with equal scales; margins. */
enum { WIDTH = 900, TALL = 230, TALLEST = 460, LEFT = 104, RIGHT = 28, HEAD = 30, FOOT = 62, TITLE = 46, ROW = 19 };

bool plot_known(const char *path)
{
    return path_ends(path, ".svg") || path_ends(path, ".png");
}

/* A character of a text in double quotes. All but letters are octal: backslashes and backquotes have a meaning there,
 * and a digit after an octal number would be part of it. */
static void plot_character(Text *text, char c)
{
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    text_print(text, letter ? "%c" : "\\%03o", (unsigned char)c);
}

/* In single quotes gnuplot takes all characters literally except quotes, which are doubled, and line ends. It writes
 * `>` into an SVG unchanged, which is not valid XML after `]]`. */
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

/* True if curve i is the first one of its unit. */
static bool opens_panel(const Plot *plot, int i)
{
    for (int k = 0; k < i; ++k)
        if (!strcmp(plot->signal[k].unit, plot->signal[i].unit))
            return false;
    return true;
}

int plot_column(Pool *pool, const CsvTable *table, const gic_signal *signal)
{
    for (int i = 1; i < table->columns; ++i)
        if (!strcmp(table->name[i], signal->name)) {
            csv_check_unit(pool, table, i, signal->unit);
            return i;
        }
    return -1;
}

/* Does the other run have a signal of the plot? */
static bool is_in_other(Pool *pool, const Plot *plot, int signal)
{
    return plot->other && plot_column(pool, plot->other, &plot->signal[signal]) > 0;
}

static const char *name_in_other(Pool *pool, const Plot *plot, int signal)
{
    return pool_print(pool, "%s (%s)", plot->signal[signal].name, plot->other_name);
}

/* The other run's rows, with the columns of the first block; a number that it lacks is NaN. */
static void other_block(Text *script, const Plot *plot)
{
    const CsvTable *table = plot->other;
    const int signals = plot->curves + 2 * plot->panels;
    int *column = pool_alloc(script->pool, sizeof *column * ((size_t)signals + 1));
    for (int k = 0; k < signals; ++k)
        column[k] = plot_column(script->pool, table, &plot->signal[k]);
    text_print(script, "$other << END\n");
    for (int row = 0; row < table->rows; ++row) {
        const double *value = table->value + row * table->columns;
        text_print(script, "%.9g", value[0]);
        for (int k = 0; k < signals; ++k)
            text_print(script, column[k] > 0 ? " %.9g" : " NaN",
                       column[k] > 0 ? value[column[k]] * plot->factor[k] : 0);
        text_print(script, "\n");
    }
    text_print(script, "END\n");
}

static void data_block(Text *script, const Plot *plot)
{
    const int signals = plot->curves + 2 * plot->panels;
    text_print(script, "$data << END\n");
    for (int row = 0; row < plot->rows; ++row)
        for (int k = 0; k <= signals; ++k)
            text_print(script, "%.15g%c", plot->sample[row * (signals + 1) + k], k < signals ? ' ' : '\n');
    text_print(script, "END\n");
}

/* ---- where panels are ---------------------------------------------------------------------------------------- */

/* Pixels from the picture's upper left corner. scale: pixels of a unit on both axes, 0: each axis has its own scale. */
typedef struct Frame {
    int left, right, top, bottom;
    double scale, low[2], high[2], tick;
    bool wide[2]; /* the range is wider than that of the numbers */
} Frame;

static void place(Text *script, const Frame *frame, int height)
{
    text_print(script, "set lmargin at screen %.6f\nset rmargin at screen %.6f\n", (double)frame->left / (double)WIDTH,
               (double)frame->right / (double)WIDTH);
    text_print(script, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1 - (double)frame->top / height,
               1 - (double)frame->bottom / height);
    text_print(script, "set key at screen %.6f, screen %.6f\n", (double)frame->left / (double)WIDTH,
               1 - (double)(frame->top - 5) / height);
}

/* Columns and rows of a legend of `names` names. Characters are some 8 pixels wide. */
static int legend_columns(size_t longest)
{
    const int columns = (WIDTH - LEFT - RIGHT) / (int)(8 * longest + 56);
    return columns > 1 ? columns : 1;
}

static int legend_rows(Pool *pool, const Plot *plot, int first, int *columns)
{
    size_t longest = 0;
    int names = 0;
    for (int i = first; i < plot->curves; ++i)
        if (!strcmp(plot->signal[i].unit, plot->signal[first].unit)) {
            const size_t length = strlen(plot->signal[i].name);
            longest = length > longest ? length : longest;
            ++names;
            if (is_in_other(pool, plot, i)) {
                const size_t longer = strlen(name_in_other(pool, plot, i));
                longest = longer > longest ? longer : longest;
                ++names;
            }
        }
    *columns = legend_columns(longest);
    return (names + *columns - 1) / *columns;
}

/* ---- ticks --------------------------------------------------------------------------------------------------- */

/* The least and the largest value of a signal. */
static void limits(Pool *pool, const Plot *plot, int signal, double *low, double *high)
{
    const int row = plot->curves + 2 * plot->panels + 1;
    *low = INFINITY;
    *high = -INFINITY;
    for (int i = 0; i < plot->rows; ++i) {
        *low = fmin(*low, plot->sample[i * row + signal + 1]);
        *high = fmax(*high, plot->sample[i * row + signal + 1]);
    }
    const int column = plot->other ? plot_column(pool, plot->other, &plot->signal[signal]) : -1;
    for (int i = 0; column > 0 && i < plot->other->rows; ++i) {
        const double value = plot->other->value[i * plot->other->columns + column] * plot->factor[signal];
        *low = fmin(*low, value);
        *high = fmax(*high, value);
    }
}

/* Pixels from one tick of x to the next: room for such a number, whose characters are 8 pixels wide. */
static double tick_room(int digits)
{
    const int sign_point_and_space = 3;
    return 8.0 * (digits + sign_point_and_space);
}

/* gnuplot's own format has fewer digits for some numbers, such as 0.00011. */
static void tick_format(Text *script, char axis, int digits)
{
    text_print(script, "set format %c '%%.%dg'\n", axis, digits);
}

/* A range in which numbers differ in their ninth digit at most is widened, so that labels have room: true then. One
 * that is empty is a hundredth of its number to either side, or 1 of 0. */
static bool widen(double *low, double *high)
{
    const double most = fmax(fabs(*low), fabs(*high)), middle = (*low + *high) / 2;
    const double least = *high > *low ? 2e-8 * most : most > 0 ? 0.01 * most : 1;
    if (!(*high - *low < 2 * least))
        return false;
    *low = middle - least;
    *high = middle + least;
    return true;
}

/* Of an axis by itself. wide: its range is not that of the numbers. */
static void tick_range(Text *script, char axis, double low, double high, bool wide)
{
    if (wide)
        text_print(script, "set %crange [%.15g:%.15g]\n", axis, low, high);
    else
        text_print(script, "set %crange [*:*]\n", axis);
    tick_format(script, axis, axis_digits(low, high));
}

/* ---- panels -------------------------------------------------------------------------------------------------- */

static void panel(Text *script, const Plot *plot, int first, bool last)
{
    int columns;
    legend_rows(script->pool, plot, first, &columns);
    text_print(script, "set xlabel %s\nset ylabel ", last ? "'time [s]'" : "''");
    plot_text(script, quantity_text(script->pool, plot->signal[first].unit, plot->shown[first]));
    double low = INFINITY, high = -INFINITY;
    for (int i = first; i < plot->curves; ++i)
        if (!strcmp(plot->signal[i].unit, plot->signal[first].unit)) {
            double least, most;
            limits(script->pool, plot, i, &least, &most);
            low = fmin(low, least);
            high = fmax(high, most);
        }
    text_print(script, "\n");
    const bool wide = widen(&low, &high);
    tick_range(script, 'y', low, high, wide);
    text_print(script, "set key maxcols %d\nplot ", columns);
    for (int i = first, drawn = 0; i < plot->curves; ++i) {
        if (strcmp(plot->signal[i].unit, plot->signal[first].unit))
            continue;
        text_print(script, "%s$data using 1:%d with lines linewidth 1.5 linecolor rgb '%s' dashtype %d title ",
                   drawn ? ", " : "", i + 2, axis_ink(drawn), drawn / AXIS_INKS % 5 + 1);
        plot_text(script, plot->signal[i].name);
        if (is_in_other(script->pool, plot, i)) {
            text_print(script, ", $other using 1:%d with lines linewidth 2 linecolor rgb '%s' dashtype 3 title ", i + 2,
                       axis_ink(drawn));
            plot_text(script, name_in_other(script->pool, plot, i));
        }
        ++drawn;
    }
    text_print(script, "\n");
}

static void axis_label(Text *script, const Plot *plot, char axis, int signal)
{
    text_print(script, "set %clabel ", axis);
    plot_text(script, pool_print(script->pool, "%s [%s]", plot->signal[signal].name, plot->shown[signal]));
    text_print(script, "\n");
}

/* If both axes are lengths and neither extent is too small, the plane has the shape of the curve, with equal scales and
 * ticks. */
static Frame frame_over(Pool *pool, const Plot *plot, int panel, int top)
{
    const int x = plot->curves + 2 * panel, y = x + 1, wide = WIDTH - LEFT - RIGHT;
    const double most = 10;
    Frame frame = {.left = LEFT, .right = WIDTH - RIGHT, .top = top + HEAD, .bottom = top + HEAD + TALL};
    limits(pool, plot, x, &frame.low[0], &frame.high[0]);
    limits(pool, plot, y, &frame.low[1], &frame.high[1]);
    for (int k = 0; k < 2; ++k)
        frame.wide[k] = widen(&frame.low[k], &frame.high[k]);
    const double across = frame.high[0] - frame.low[0], up = frame.high[1] - frame.low[1];
    if (strcmp(plot->signal[x].unit, plot->signal[y].unit) || !(across <= most * up && up <= most * across)) {
        const int digits = axis_digits(frame.low[0], frame.high[0]);
        if (digits > 6) /* a long number stands below the end of the axis */
            frame.right = WIDTH - (int)tick_room(digits) / 2;
        return frame;
    }
    for (int k = 0; k < 2; ++k) { /* keep lines off the edge */
        frame.low[k] -= 0.04 * fmax(across, up);
        frame.high[k] += 0.04 * fmax(across, up);
    }
    const double size[2] = {frame.high[0] - frame.low[0], frame.high[1] - frame.low[1]};
    frame.scale = fmin(wide / size[0], (double)TALLEST / size[1]);
    frame.tick = axis_step(tick_room(axis_digits(frame.low[0], frame.high[0])) / frame.scale);
    frame.right = LEFT + (int)(frame.scale * size[0]);
    frame.bottom = frame.top + (int)(frame.scale * size[1]);
    return frame;
}

/* Of axes with scales of their own. Long numbers of x need more room than gnuplot gives them. */
static void free_ticks(Text *script, const Frame *frame)
{
    const double low = frame->low[0], high = frame->high[0];
    const int digits = axis_digits(low, high);
    text_print(script, "set xtics autofreq\nset ytics autofreq\n");
    if (digits > 6)
        text_print(script, "set xtics %.9g\n",
                   axis_step((high - low) * tick_room(digits) / (frame->right - frame->left)));
}

static void panel_over(Text *script, const Plot *plot, int panel, const Frame *frame)
{
    const int x = plot->curves + 2 * panel, y = x + 1;
    axis_label(script, plot, 'x', x);
    axis_label(script, plot, 'y', y);
    for (int k = 0; k < 2 && frame->scale > 0; ++k)
        text_print(script, "set %crange [%.15g:%.15g]\nset %ctics %.9g\n", "xy"[k], frame -> low[k], frame -> high[k],
                   "xy"[k], frame -> tick);
    for (int k = 0; k < 2; ++k)
        if (frame->scale > 0)
            tick_format(script, "xy"[k], axis_digits(frame->low[k], frame->high[k]));
        else
            tick_range(script, "xy"[k], frame -> low[k], frame -> high[k], frame -> wide[k]);
    if (!(frame->scale > 0))
        free_ticks(script, frame);
    text_print(script, "set key maxcols 1\nplot $data using %d:%d with lines linewidth 1.5 linecolor rgb '%s' title ",
               x + 2, y + 2, axis_ink(0));
    plot_text(script, pool_print(script->pool, "%s over %s", plot->signal[y].name, plot->signal[x].name));
    if (is_in_other(script->pool, plot, x) && is_in_other(script->pool, plot, y)) {
        text_print(script, ", $other using %d:%d with lines linewidth 2 linecolor rgb '%s' dashtype 3 title ", x + 2,
                   y + 2, axis_ink(0));
        plot_text(script, plot->other_name);
    }
    text_print(script, "\n");
}

/* ---- the picture --------------------------------------------------------------------------------------------- */

/* Place the panels, those over time first; returns the picture's height. */
static int arrange(Pool *pool, const Plot *plot, Frame *frame)
{
    int top = TITLE, panels = 0;
    for (int i = 0; i < plot->curves; ++i) {
        if (!opens_panel(plot, i))
            continue;
        int columns;
        const int plane = top + HEAD + ROW * (legend_rows(pool, plot, i, &columns) - 1);
        frame[panels++] = (Frame){.left = LEFT, .right = WIDTH - RIGHT, .top = plane, .bottom = plane + TALL};
        top = plane + TALL + FOOT;
    }
    for (int i = 0; i < plot->panels; ++i) {
        frame[panels] = frame_over(pool, plot, i, top);
        top = frame[panels++].bottom + FOOT;
    }
    return top;
}

static void style(Text *script, const Plot *plot, const char *path, int height)
{
    text_print(script, "set encoding utf8\nset terminal %s size %d,%d noenhanced\n",
               path_ends(path, ".svg") ? "svg background 'white' font 'sans-serif,13'" : "pngcairo font 'sans,10'",
               WIDTH, height);
    text_print(script, "set grid back linetype 1 linewidth 0.5 linecolor rgb '#d5dce2'\n"
                       "set border 3 linewidth 0.8 linecolor rgb '#5c6873'\n"
                       "set tics nomirror out scale 0.5 textcolor rgb '#1f2933'\n"
                       "set offsets graph 0, graph 0, graph 0.05, graph 0.05\n"
                       "set key left bottom Left reverse horizontal samplen 2 spacing 1.1\n"
                       "set multiplot\nset label 1 ");
    plot_text(script, plot->title);
    text_print(script, " at screen %.6f, screen %.6f left font ',%d'\n", (double)LEFT / (double)WIDTH,
               1 - 24.0 / height, path_ends(path, ".svg") ? 17 : 13);
}

static const char *plot_script(Pool *pool, const Plot *plot, const char *path)
{
    Text script = {.pool = pool};
    Frame *frame = pool_alloc(pool, sizeof *frame * (size_t)(plot->curves + plot->panels + 1));
    int over_time = 0, done = 0;
    for (int i = 0; i < plot->curves; ++i)
        over_time += opens_panel(plot, i);
    const int height = arrange(pool, plot, frame);
    data_block(&script, plot);
    if (plot->other)
        other_block(&script, plot);
    style(&script, plot, path, height);
    for (int i = 0; i < plot->curves; ++i)
        if (opens_panel(plot, i)) {
            place(&script, &frame[done], height);
            panel(&script, plot, i, done == over_time - 1);
            text_print(&script, done++ ? "" : "unset label 1\n");
        }
    for (int i = 0; i < plot->panels; ++i, ++done) {
        place(&script, &frame[done], height);
        panel_over(&script, plot, i, &frame[done]);
        text_print(&script, done ? "" : "unset label 1\n");
    }
    text_print(&script, "unset multiplot\n");
    return script.s;
}

/* gnuplot does not report a full disk: check that the file ends as a picture does, in </svg> or in the chunk IEND of a
 * PNG. */
static bool is_whole(const char *path)
{
    enum { END = 12 }; /* bytes of an IEND: length, name, checksum */
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
    /* gnuplot does not open the file itself: its name may have become a link */
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
        diag_note(said);
        diag_fail(program_place(), "gnuplot's messages are above; is there room on the disk?",
                  "no picture: %s could not be drawn", path);
    }
}
