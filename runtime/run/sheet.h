/* SPDX-License-Identifier: MIT
 *
 * sheet: a vehicle on one page (gicrun --sheet): masses, loads, attitude, axles, small motions, cornering, by the
 * definitions of models/SHEET.md. */
#ifndef RUN_SHEET_H
#define RUN_SHEET_H

#include "base/pool.h"
#include "base/text.h"
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
    const char *place;        /* what other vehicles call it: front.left.camber; NULL: as its name */
    int mode;                 /* of this small motion, from 1, in Sheet.modes; 0: of none */
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
    double wheelbase;    /* kc_wheelbase() of the axles' contacts at rest */
    int rows, notes;
    SheetRow *row;
    const char *other; /* the name of the vehicle to compare with; NULL: none */
    const int *number; /* [modes->count] that their rows have, from sheet_follow_modes() on; NULL: 1, 2 and so on */
    const char **note; /* what could not be found, and why; what is to be known of numbers */
} Sheet;

/* Add a number, in the unit in which it is shown; and a note. */
void sheet_add(Sheet *sheet, const char *section, const char *name, const char *title, const char *unit, double value);
/* A way in m, which nobody reads in mm. */
void sheet_add_way(Sheet *sheet, const char *section, const char *name, const char *title, double value);
/* What the number added last is called in any vehicle: of a wheel of an axle, and of one of dual wheels, from 0, what
 * follows. */
void sheet_place(Sheet *sheet, const KcAxle *axle, int wheel, int part, const char *what);
void sheet_note(Sheet *sheet, const char *note);
/* The same: what is not there, and why. */
void sheet_miss(Sheet *sheet, const char *what);

/* sheet_rest.c: masses, loads and attitude at rest; the axles there. */
void sheet_rest(Sheet *sheet);
/* The same file: the mean x of the contacts of an axle at rest, in the axes of the drawing; *aside: the largest
 * distance of one of them from the middle. NAN: there is no such position. */
double sheet_axle_place(const Sheet *sheet, const KcAxle *axle, double *aside);
/* sheet_report.c: a vehicle at rest, with the rows of sheet_rest(). Ends in diag_fail where the model is none. */
Sheet sheet_open(Pool *pool, const Model *model, const Scene *scene, Solve solve);
/* sheet_cornering.c: steady response to steering at several speeds, from the linear model. */
void sheet_cornering(Sheet *sheet);
/* The same file: the foremost axle that one driven coordinate steers, and by a unit of it at rest the steer angle, rad,
 * over the wheelbase the curvature without slip, positive to the left: the mean of the axle's wheels, of one behind
 * with the other sign; where this coordinate steers all axles, that of the first less that of the last. NULL: there is
 * none, or it makes no curve, *why and a *remedy. */
const KcAxle *sheet_steered(const Sheet *sheet, double *angle, const char **why, const char **remedy);
/* The same file: the steady change z [linear->count] of a unit of the steering coordinate; *falls: the acceleration of
 * the centre of mass downwards, m/s^2, in the motion about which it is taken, NULL: not asked for. Returns a status. */
int sheet_respond(const Sheet *sheet, int steer, double speed, double *z, double *falls);
/* Numbers of z: rate of the yaw angle. */
double sheet_yaw_rate(const Sheet *sheet, const double *z);
/* The same file: set an instance at rest in motion straight ahead, on rolling wheels. Returns a status. */
int sheet_set_in_motion(const Sheet *sheet, Instance *self, double speed);
/* sheet_frequency.c: small motions about straight motion at a speed, m/s, as the steering coordinate moves; NULL: there
 * are none. And: the change z = re + i im, [linear->count] each, of a unit of the steering coordinate that moves at
 * omega, rad/s. False: at its own frequency. */
typedef struct SheetMotion SheetMotion;
const SheetMotion *sheet_motion(const Sheet *sheet, int steer, double speed);
bool sheet_motion_at(const SheetMotion *motion, double omega, double *re, double *im);
/* The change of component `output` of the model's outputs, re and im, in the motion z of sheet_motion_at(). */
void sheet_motion_output(const SheetMotion *motion, int output, double omega, const double *re, const double *im,
                         double out[2]);
/* The same file: dz/dt = A z + B_0 u + B_1 u' + B_2 u'' about straight motion at a speed, m/s, of all small motions z
 * [n] as in run/linearize.h, with u the steering coordinate, and the speed held; A [n][n], B [SHEET_STEERING][n]. y,
 * yaw, yaw_rate: numbers of z. False: there is none. */
enum { SHEET_STEERING = 3 };
typedef struct SheetPath {
    int n, y, yaw, yaw_rate;
    double *A, *B;
} SheetPath;
bool sheet_path(const Sheet *sheet, int steer, double speed, SheetPath *path);
/* sheet_report.c: all rows of a sheet. */
Sheet sheet_study(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* sheet_report.c: --sheet: a table, or CSV or a page by the ending of the file. */
void sheet_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* sheet_compare.c: what is to stand beside a model: another one's file, or a scene, which has other values of its
 * parameters. *name: what it is called. */
const Model *sheet_other(Pool *pool, const Model *model, const char *file, const char **name);
/* The same file: the model with the values of its parameters that a scene gives; itself where they are its own. */
const Model *sheet_set(Pool *pool, const Model *model, const Scene *scene);
/* The same file: what a wheel of an axle, or one of dual wheels, is called in any vehicle: front.left_1. */
const char *sheet_place_of(Pool *pool, const KcAxle *axle, int wheel, int part);
/* The same file: what a wheel or one of dual wheels, or all of them, is called in names of numbers: NAME, or wheel.NAME
 * where an axle is called so. Names of wheels have no dots. */
const char *sheet_wheel(const Sheet *sheet, const char *name);
/* The same file: true if two numbers of two sheets belong beside each other; a name for another number after these
 * rows: itself, or behind `other.` as often as it is taken. */
bool sheet_is_same(const SheetRow *a, const SheetRow *b);
const char *sheet_free_name(Pool *pool, const SheetRow *row, int rows, const char *name);
/* The same file: numbers of another one, which is called `name`, beside those of the same places or names; then those
 * that only the other one has. */
void sheet_compare(Sheet *sheet, const Sheet *other, const char *name);
/* sheet_report.c: both, as CSV into the file `results`, NULL: as a table for people, after whose title `about` stands.
 */
void sheet_beside(Sheet *sheet, const Sheet *other, const char *name, const char *results, const char *about);
/* The numbers for people, the title after the names, and as CSV. */
void sheet_print(const Sheet *sheet, const char *title);
/* Its notes, after the numbers for people, or on standard error where these go to a file. */
void sheet_notes(const Sheet *sheet, const Request *request);
void sheet_csv(const Sheet *sheet, const char *path);
/* sheet_compare.c: true if a number is another one for the other vehicle, or not there: by more than rounding. */
bool sheet_differs(const SheetRow *row);
/* Points in the world: the corners of the base's box, centres of wheels; and how they move by the real and by the
 * imaginary part of a mode. */
enum { SHEET_CORNERS = 8 };
typedef struct SheetShape {
    int points;
    double (*rest)[3], (*move[2])[3];
} SheetShape;
/* sheet_shapes.c. False: it could not be found. */
bool sheet_shape_of(const Sheet *sheet, const Mode *mode, SheetShape *shape);
/* sheet_match.c: shapes of modes that several sheets have, none at first; and the rows of a sheet's modes get the
 * numbers of the known shapes that they have. Shapes not known yet come after these, with numbers of their own. */
typedef struct SheetShapes SheetShapes;
SheetShapes *sheet_shapes(Pool *pool);
void sheet_follow_modes(Sheet *sheet, SheetShapes *known);
/* The same file, after sheet_follow_modes() of the sheet itself: modes of the other one get the numbers of the sheet's
 * own modes of the same shape, and a note where that is another number than before; the other one's further modes get
 * numbers that no mode of the sheet has, by what is known. */
void sheet_match_modes(Sheet *sheet, Sheet *other, SheetShapes *known);
/* sheet_shapes.c: a mode's motion as seen from the side and from behind, as SVG; nothing where it can't be found. */
void sheet_shape(const Sheet *sheet, const Mode *mode, Text *out);
/* sheet_page.c: the sections but that of the modes as tables; the page. */
void sheet_tables(const Sheet *sheet, Text *out);
void sheet_page(const Sheet *sheet, const char *path);

#endif
