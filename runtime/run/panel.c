/* SPDX-License-Identifier: MIT
 * Diagrams as SVG: curves, a grid at round numbers. */
#include "run/panel.h"
#include "host/axis.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

const char *panel_color(int curve)
{
    return axis_ink(curve);
}

enum { WIDTH = 280, HEIGHT = 170, LEFT = 62, RIGHT = 14, TOP = 8, BOTTOM = 32 };

/* Range of what is finite, never empty. */
static void range_of(const double *value, int count, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int i = 0; i < count; ++i)
        if (isfinite(value[i])) {
            range[0] = fmin(range[0], value[i]);
            range[1] = fmax(range[1], value[i]);
        }
    const double middle = (range[0] + range[1]) / 2, least = fmax(1e-5 * fabs(middle), 1e-6);
    if (range[1] - range[0] < 2 * least) {
        range[0] = middle - least;
        range[1] = middle + least;
    }
}

enum { CHARACTER = 6 }; /* width of one in a number */

static void upright_tick(Text *out, const char *class, double at, const char *number)
{
    text_print(out, "<path class=\"%s\" d=\"M%d %.1fH%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>\n",
               class, LEFT, at, WIDTH - RIGHT, LEFT - 4, at + 3, number);
}

/* Below its line, or as far left of that as the picture's edge asks for. */
static void level_tick(Text *out, const char *class, double at, const char *number)
{
    const double reach = at + CHARACTER / 2.0 * (double)strlen(number), text = at - fmax(0, reach - WIDTH);
    text_print(out,
               "<path class=\"%s\" d=\"M%.1f %dV%d\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n",
               class, at, TOP, HEIGHT - BOTTOM, text, HEIGHT - BOTTOM + 12, number);
}

/* Ticks at round numbers, along x as many as have room side by side. */
static void ticks(Text *out, const double range[2], bool upright)
{
    const double width = range[1] - range[0], size = upright ? HEIGHT - TOP - BOTTOM : WIDTH - LEFT - RIGHT;
    const int digits = axis_digits(range[0], range[1]), sign_point_and_space = 4;
    const double room = CHARACTER * (digits + sign_point_and_space), most = upright ? 5 : fmin(6, size / room);
    const double step = axis_step(width / most), rounding = 1e-9;
    for (double k = ceil(range[0] / step - rounding); k * step <= range[1] + rounding * step; ++k) {
        const double share = (k * step - range[0]) / width;
        const char *number = pool_print(out->pool, "%.*g", digits, k * step + 0.0);
        if (upright)
            upright_tick(out, k == 0 ? "zero" : "grid", TOP + size * (1 - share), number);
        else
            level_tick(out, k == 0 ? "zero" : "grid", LEFT + size * share, number);
    }
}

/* A curve, in pieces where values are missing. */
static void curve(Text *out, const Panel *panel, int c, const double x[2], const double y[2])
{
    bool open = false;
    for (int i = 0; i < panel->rows; ++i) {
        const double value = panel->y[c * panel->rows + i];
        if (!isfinite(value)) {
            text_print(out, "%s", open ? "\"/>\n" : "");
            open = false;
            continue;
        }
        text_print(out, "%s", open ? " " : "");
        if (!open)
            text_print(out, "<polyline stroke=\"%s\"%s points=\"", panel_color(panel->pairs ? c / 2 : c),
                       (panel->pairs ? c % 2 : c == 1) ? " stroke-dasharray=\"6 3\"" : "");
        open = true;
        text_print(out, "%.1f,%.1f", LEFT + (WIDTH - LEFT - RIGHT) * (panel->x[i] - x[0]) / (x[1] - x[0]),
                   TOP + (HEIGHT - TOP - BOTTOM) * (y[1] - value) / (y[1] - y[0]));
    }
    text_print(out, "%s", open ? "\"/>\n" : "");
}

void panel_draw(Text *out, const Panel *panel)
{
    double x[2], y[2];
    bool any = false;
    for (int i = 0; i < panel->rows * panel->curves; ++i)
        any = any || isfinite(panel->y[i]);
    if (!any)
        return;
    range_of(panel->x, panel->rows, x);
    range_of(panel->y, panel->rows * panel->curves, y);
    text_print(out, "<figure><figcaption>%s, %s", panel->title, panel->unit);
    text_print(out, "</figcaption>\n<svg viewBox=\"0 0 %d %d\" role=\"img\">\n", WIDTH, HEIGHT);
    ticks(out, x, false);
    ticks(out, y, true);
    for (int c = 0; c < panel->curves; ++c)
        curve(out, panel, c, x, y);
    text_print(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6);
    text_html(out, panel->below);
    text_print(out, "</text></svg></figure>\n");
}
