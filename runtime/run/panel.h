/* SPDX-License-Identifier: MIT
 *
 * panel: a small diagram of curves as SVG, for pages of reports. */
#ifndef RUN_PANEL_H
#define RUN_PANEL_H

#include "base/text.h"

#include <stdbool.h>

/* Curves over one abscissa, in the units that are shown. */
typedef struct Panel {
    const char *title, *unit, *below;
    int rows, curves;
    bool pairs; /* curves 2 k and 2 k + 1 have one color, and the second one is dashed; else curve 1 is */
    const double *x;
    double *y; /* [curves][rows]; what is not finite is left out */
} Panel;

/* The color of a curve; they repeat. */
const char *panel_color(int curve);
/* A figure; nothing where no value is finite. */
void panel_draw(Text *out, const Panel *panel);

#endif
