/* SPDX-License-Identifier: MIT
 * Diagrams of points, lines and shades as SVG. Colours are the page's, so that they follow a dark or a light one. */
#include "host/axis.h"
#include "sweep/report.h"

#include <math.h>

enum {
    WIDTH = 460,
    HEIGHT = 320,
    LEFT = 84,
    RIGHT = 92,
    TOP = 10,
    BOTTOM = 46,
    ACROSS = WIDTH - LEFT - RIGHT,
    UP = HEIGHT - TOP - BOTTOM,
    CHARACTER = 6
};

static void widen(double range[2])
{
    const double middle = range[0] / 2 + range[1] / 2, least = fmax(1e-5 * fabs(middle), 1e-9);
    if (range[1] - range[0] < least) {
        range[0] = middle - least;
        range[1] = middle + least;
    }
}

static double at_x(const Picture *p, double x)
{
    return LEFT + ACROSS * (x - p->x[0]) / (p->x[1] - p->x[0]);
}

static double at_y(const Picture *p, double y)
{
    return TOP + UP * (p->y[1] - y) / (p->y[1] - p->y[0]);
}

static void ticks(const Picture *p, const double range[2], bool upright)
{
    const double width = range[1] - range[0];
    const int digits = axis_digits(range[0], range[1]);
    const double step = axis_step(width / (upright ? 6 : fmin(6, ACROSS / (double)(CHARACTER * (digits + 4)))));
    for (double k = ceil(range[0] / step - 1e-9); k * step <= range[1] + 1e-9 * step; ++k) {
        const double place = upright ? at_y(p, k * step) : at_x(p, k * step);
        if (upright)
            text_print(p->out, "<path class=\"grid\" d=\"M%d %.1fh%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">",
                       LEFT, place, ACROSS, LEFT - 5, place + 3);
        else
            text_print(p->out,
                       "<path class=\"grid\" d=\"M%.1f %dv%d\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">",
                       place, TOP, UP, place, TOP + UP + 14);
        text_print(p->out, "%.*g</text>\n", digits, k * step + 0.0);
    }
}

void picture_begin(Picture *p, const char *title, const char *below, const char *beside)
{
    widen(p->x);
    widen(p->x);
    widen(p->y);
    text_print(p->out, "<figure><figcaption>");
    text_html(p->out, title);
    text_print(p->out, "</figcaption>\n<svg viewBox=\"0 0 %d %d\" role=\"img\">\n", WIDTH, HEIGHT);
    ticks(p, p->x, false);
    ticks(p, p->y, true);
    text_print(p->out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", LEFT + ACROSS / 2, HEIGHT - 10);
    text_html(p->out, below);
    text_print(p->out, "</text>\n<text transform=\"translate(12 %d) rotate(-90)\" text-anchor=\"middle\">",
               TOP + UP / 2);
    text_html(p->out, beside);
    text_print(p->out, "</text>\n");
}

void picture_point(const Picture *p, const char *class, double x, double y)
{
    text_print(p->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"/>\n", class, at_x(p, x), at_y(p, y));
}

void picture_line(const Picture *p, const char *class, int points, const double *x, const double *y)
{
    text_print(p->out, "<polyline class=\"%s\" points=\"", class);
    for (int i = 0; i < points; ++i)
        text_print(p->out, "%s%.1f,%.1f", i ? " " : "", at_x(p, x[i]), at_y(p, y[i]));
    text_print(p->out, "\"/>\n");
}

enum { COLUMNS = 92, ROWS = 66, BANDS = 8 /* about so many shades */ };

typedef struct Shades {
    double step, first;
    int count; /* shade k: from (first + k) step on */
} Shades;

static double opacity(const Shades *shades, int k)
{
    return 0.04 + 0.86 * k / (shades->count > 1 ? shades->count - 1 : 1);
}

/* A scale on the right. */
static void scale(const Picture *p, const Shades *shades)
{
    const double each = UP / (double)shades->count;
    const double from = shades->first * shades->step, to = from + shades->count * shades->step;
    const int digits = axis_digits(from, to);
    for (int k = 0; k <= shades->count; ++k) {
        const double y = TOP + UP - k * each;
        if (k < shades->count)
            text_print(p->out,
                       "<rect class=\"shade\" x=\"%d\" y=\"%.1f\" width=\"12\" height=\"%.1f\" fill-opacity=\"%.2f\"/>",
                       LEFT + ACROSS + 12, y - each, each, opacity(shades, k));
        text_print(p->out, "<text x=\"%d\" y=\"%.1f\">%.*g</text>\n", LEFT + ACROSS + 28, y + 3, digits,
                   from + k * shades->step + 0.0);
    }
}

void picture_shades(const Picture *p, double (*value)(const void *context, double x, double y), const void *context)
{
    double *cell = pool_alloc(p->out->pool, sizeof *cell * COLUMNS * ROWS), low = INFINITY, high = -INFINITY;
    for (int i = 0; i < ROWS * COLUMNS; ++i) {
        const double across = (i % COLUMNS + 0.5) / COLUMNS, up = (i / COLUMNS + 0.5) / ROWS;
        cell[i] = value(context, p->x[0] + across * (p->x[1] - p->x[0]), p->y[0] + up * (p->y[1] - p->y[0]));
        low = fmin(low, cell[i]);
        high = fmax(high, cell[i]);
    }
    const double step = axis_step(fmax(high - low, 1e-9 * fmax(fabs(low), 1e-9)) / BANDS);
    const double first = floor(low / step);
    const Shades shades = {step, first, (int)(floor(high / step) - first) + 1};
    for (int r = 0; r < ROWS; ++r)
        for (int c = 0, end; c < COLUMNS; c = end) {
            const int band = (int)(floor(cell[r * COLUMNS + c] / step) - first);
            for (end = c; end < COLUMNS && (int)(floor(cell[r * COLUMNS + end] / step) - first) == band; ++end)
                ;
            text_print(p->out,
                       "<rect class=\"shade\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" "
                       "fill-opacity=\"%.2f\"/>\n",
                       LEFT + ACROSS * c / (double)COLUMNS, TOP + UP * (ROWS - 1 - r) / (double)ROWS,
                       ACROSS * (end - c) / (double)COLUMNS, UP / (double)ROWS, opacity(&shades, band));
        }
    scale(p, &shades);
}

void picture_end(const Picture *p)
{
    text_print(p->out, "</svg></figure>\n");
}
