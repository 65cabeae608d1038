/* SPDX-License-Identifier: MIT
 *
 * sheet: a vehicle on one page (gicrun --sheet): masses, loads, attitude, axles, small motions, cornering, by the
 * definitions of models/SHEET.md. */
#ifndef RUN_SHEET_H
#define RUN_SHEET_H

#include "base/pool.h"
#include "model/model.h"
#include "run/kc.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"

/* A number with its name; a section begins where `section` is not NULL. */
typedef struct SheetRow {
    const char *section, *name, *title;
    const char *unit, *shown; /* "rad", "deg" */
    double scale, value;      /* scale: from unit to shown */
    double other;             /* of the vehicle to compare with; NAN: it has no such number */
} SheetRow;

typedef struct Sheet {
    Pool *pool;
    const Model *model;
    const Equilibrium *found;
    const Kc *kc;
    const Modes *modes;  /* NULL: could not be found */
    double speed;        /* m/s at which they are taken */
    double *w;           /* [coordinates] at rest */
    double com[3], mass; /* of the vehicle at rest, in the axes of the drawing carried along by the base */
    double wheelbase;    /* distance of the first axle's contacts from the last one's, at rest */
    int rows, notes;
    SheetRow *row;
    const char *other; /* the name of the vehicle to compare with; NULL: none */
    const char **note; /* what could not be found, and why */
} Sheet;

/* Add a number, in the unit in which it is shown; and what could not be found. */
void sheet_add(Sheet *sheet, const char *section, const char *name, const char *title, const char *unit, double value);
void sheet_note(Sheet *sheet, const char *note);

/* sheet_rest.c: masses, loads and attitude at rest; the axles there. */
void sheet_rest(Sheet *sheet);
/* sheet_cornering.c: steady response to steering at several speeds, from the linear model. */
void sheet_cornering(Sheet *sheet);
/* The same file: set an instance at rest in motion straight ahead, on rolling wheels. Returns a status. */
int sheet_set_in_motion(const Sheet *sheet, Instance *self, double speed);
/* sheet_report.c: --sheet: a table, or CSV or a page by the ending of the file. */
void sheet_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* True if a number is another one for the other vehicle, or not there: by more than rounding. */
bool sheet_differs(const SheetRow *row);
/* sheet_page.c */
void sheet_page(const Sheet *sheet, const char *path);

#endif
