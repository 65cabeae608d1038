/* SPDX-License-Identifier: MIT
 * Diagrams as SVG: curves, a grid at round numbers. */
#include "run/panel.h"

#include <math.h>
#include <stdbool.h>

static const char *const color[] = {"#1660a8", "#c03a1b", "#2a8a3c", "#8a5a00",
                                    "#7a3a9a", "#0a8a8a", "#555",    "#c03a8a"};
enum { COLORS = sizeof color / sizeof *color };

const char *panel_color(int curve)
{
    return color[curve % COLORS];
}

enum { WIDTH = 280, HEIGHT = 170, LEFT = 48, RIGHT = 8, TOP = 8, BOTTOM = 32 };

/* The step of ticks: 1, 2 or 5 times a power of ten, at most `most` steps. */
static double tick_step(double range, int most)
{
    const double raw = range / most, power = pow(10, floor(log10(raw)));
    const double share = raw / power;
    return power * (share <= 1 + 1e-9 ? 1 : share <= 2 + 1e-9 ? 2 : share <= 5 + 1e-9 ? 5 : 10);
}

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
    const double middle = (range[0] + range[1]) / 2, least = fmax(1e-6 * fabs(middle), 1e-6);
    if (range[1] - range[0] < 2 * least) {
        range[0] = middle - least;
        range[1] = middle + least;
    }
}

static void ticks(Text *out, const double range[2], bool upright)
{
    const double step = tick_step(range[1] - range[0], upright ? 5 : 6),
                 size = upright ? HEIGHT - TOP - BOTTOM : WIDTH - LEFT - RIGHT;
    for (double k = ceil(range[0] / step - 1e-9); k * step <= range[1] + 1e-9 * step; ++k) {
        const double share = (k * step - range[0]) / (range[1] - range[0]);
        const char *class = k == 0 ? "zero" : "grid";
        if (upright)
            text_print(
                out, "<path class=\"%s\" d=\"M%d %.1fH%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n",
                class, LEFT, TOP + size * (1 - share), WIDTH - RIGHT, LEFT - 4, TOP + size * (1 - share) + 3,
                k * step + 0.0);
        else
            text_print(
                out,
                "<path class=\"%s\" d=\"M%.1f %dV%d\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                class, LEFT + size * share, TOP, HEIGHT - BOTTOM, LEFT + size * share, HEIGHT - BOTTOM + 12,
                k * step + 0.0);
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
            text_print(out, "<polyline stroke=\"%s\"%s points=\"", panel_color(c),
                       c == 1 ? " stroke-dasharray=\"6 3\"" : "");
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
