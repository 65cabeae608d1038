/* SPDX-License-Identifier: MIT
 *
 * kc: kinematics of the axles of a vehicle whose base is held (gicrun --kc), by the definitions of models/KC.md. First
 * and second derivatives of poses are exact: those of the expression graph, in dual numbers (linearize.h). */
#ifndef RUN_KC_H
#define RUN_KC_H

#include "base/pool.h"
#include "base/text.h"
#include "engine/engine.h"
#include "model/model.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"

/* ---- what moves, and how it is asked: kc_model.c */

/* A force element that a coordinate, two points or an axis has; its value x: coordinate, length or angle. */
typedef struct KcElement {
    const char *name;
    int coordinate;  /* or -1: */
    int value, rate; /* places among the outputs of x and x' */
    int force;       /* place of the element's Q or T */
    double sign;     /* of the generalized force: Q acts along x (1), T against it (-1) */
    bool angle;      /* x is in rad */
} KcElement;

/* The most of an axle. */
enum { KC_WHEELS = 8 };

typedef struct KcWheel {
    const Wheel *wheel; /* dual wheels: one in the middle of them, which the model does not have */
    const char *name;
    int parts; /* of dual wheels their number, else 1 */
    const Wheel *part[KC_WHEELS];
    double side; /* 1: left or in the middle, y >= 0; -1: right */
    double radius;
    bool shaft;   /* the torque of its drive is taken by another body than its carrier */
    int centre;   /* places among the outputs: position and velocity of the centre, of a point 1 m along the axis, */
    int velocity; /* angular velocity of the carrier; three each */
    int tip, turn;
} KcWheel;

/* A bushing: places among the outputs of both ends, of position, velocity, orientation and angular velocity. */
typedef struct KcRubber {
    const Force *force;
    int place[2], velocity[2], orientation[2], turn[2];
    double stiffness[BUSHING_AXES * BUSHING_AXES], preload[BUSHING_AXES];
} KcRubber;

/* The most coordinates that follow from rubber, of an axle, and of those that move its wheels. */
enum { KC_FOLLOWERS = 40, KC_COLUMNS = 2 * KC_WHEELS + KC_FOLLOWERS };

/* Wheels of nearly the same x. */
typedef struct KcAxle {
    const char *name; /* front, rear, axle_2; `axle` where it is the only one */
    int number;       /* from 1, the foremost */
    int wheels;
    KcWheel wheel[KC_WHEELS];
    double ahead;                          /* 1: ahead of the mean of the vehicle's axles, or there; -1: behind it */
    int travel[KC_WHEELS];                 /* [wheels] coordinates that move them up and down */
    int steer;                             /* coordinate, -1: none */
    int followers, follower[KC_FOLLOWERS]; /* coordinates that rubber moves along with those of travel: kc_rubber.c */
    double *preload;                       /* [wheels + followers] forces of rubber as set up; NULL: nothing follows */
    const char *unit; /* coordinate that turns the unit it belongs to, which is not that of the base; NULL: it is */
    bool rigid; /* no coordinate moves its wheels up and down, which is a refusal; it may be steered all the same */
    const char *loose;     /* coordinate that moves its wheels up and down and that nothing holds; NULL: none */
    const char *refusal;   /* why no wheel of it can be moved; NULL: they can */
    const char *unsteered; /* why it is not steered; NULL: it is */
} KcAxle;

typedef struct Kc {
    Pool *pool;
    const Model *model; /* the user's, with outputs and force elements that measure */
    const Engine *engine;
    const Linear *linear;
    Instance *self; /* as set up: the base at the design, coordinates at their initial values */
    Instance *work;
    int axles, elements, rubbers, outputs;
    KcAxle *axle;
    KcElement *element;
    KcRubber *rubber;
    double *initial;       /* [coordinates] */
    double wheelbase;      /* kc_wheelbase() at set-up; 0: there is one axle */
    const char *units;     /* what is to be said of axles of other units; NULL: there are none */
    double middle;         /* y of the drawing, m: midway between the wheels furthest to the left and to the right */
    double height;         /* of the centre of mass above the mean of all contacts, m; 0: the base is ground */
    double fixed_x;        /* of the mean contact of axles without steering; used if `turns` */
    bool turns;            /* the base's unit has an axle with steering, and one without */
    double *f, *df, *dout; /* work */
} Kc;

/* Dual wheels are one wheel in the middle of them. axle: name or number of the one that is asked for, NULL: all.
 * scene: its parameters are those of set-up; NULL: the model's. Ends in diag_fail where the model has no wheels, or no
 * such axle. */
Kc *kc_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const char *axle);

/* The middle between the wheels furthest to the left and to the right, y of the drawing, m. */
double kc_middle_of(const Model *model);
/* 1: a y of the drawing, m, is to the left of that middle, -1: to the right, 0: within 1 mm of it. */
int kc_side(const Kc *kc, double y);

/* Add a hidden output to a model that is to be measured; returns the place of its first component among all. */
int kc_watch(Pool *pool, Model *model, Output output);
/* Warn once, where wheel rates are computed, of bushings that they leave out. */
void kc_warn(const Kc *kc);
/* Axles of the base's unit: the first and the last one. */
int kc_foremost(const Kc *kc);
int kc_last(const Kc *kc);
/* With axles at x [axles], m: from the last axle of the base's unit to its first; of three and more, from the first one
 * that is steered to the mean of those that are not. */
double kc_wheelbase(const Kc *kc, const double *x);

/* ---- kc_look.c: a position, with derivatives */

/* Of one axle, at values of all coordinates. Derivatives by the axle's `columns` coordinates: those of travel, with
 * what follows them, then that of steering. */
typedef struct KcLook KcLook;
struct KcLook {
    int columns, outputs;
    int column[KC_COLUMNS];
    double *value; /* [outputs] at rest */
    double *slope; /* [columns][outputs] derivative by a coordinate, of places; of the rates x' and v: by its rate */
    const KcAxle *axle; /* of rubber; NULL: nothing follows, and so with all of these: */
    KcLook *whole;      /* columns: travel, what follows, steering; each by itself */
    double *follow;     /* [wheels][followers] rates of what follows by those of travel */
    double *relax;      /* [wheels + followers] step to where the rubber's forces are balanced, heights held */
    double *bend;       /* [wheels][followers] change of `follow` along the motion of the last kc_look_second() */
};

KcLook *kc_look_new(const Kc *kc, const KcAxle *axle);
/* w: [coordinates]. Returns a status. */
int kc_look(const Kc *kc, const double *w, KcLook *look);
/* The derivative of an element's coordinate, length or angle by a column. */
double kc_element_slope(const KcElement *element, const KcLook *look, int column);
/* Its change along the motion of the last kc_look_second(), whose result is `second`. */
double kc_element_bend(const KcElement *element, const KcLook *look, const double *second, int column);
/* w += step times a motion with the rates `along` [columns], and what follows. */
void kc_move(const KcLook *look, const double *along, double step, double *w);
/* Derivatives by the columns of the outputs that are rates, while coordinates move with the rates `along` [columns]:
 * second derivatives. second: [columns][outputs]. Returns a status. */
int kc_look_second(const Kc *kc, const double *w, KcLook *look, const double *along, double *second);
/* The text of a status that a look has returned. */
const char *kc_status(const Kc *kc, int status);

/* ---- kc_bushing.c: bushings */

/* A bushing's displacements and rotation vector q, its axes in the world, and from its end in a to that in b. */
typedef struct KcBent {
    double q[BUSHING_AXES], axes[9], lever[3];
} KcBent;

/* Stiffness and preload of all bushings, with the parameters of set-up. */
void kc_stiffness(Kc *kc);
/* The first bushing with a formula, whose stiffness is not known here; NULL: none has one. */
const char *kc_rubber_formula(const Kc *kc);
KcBent kc_bend(const KcRubber *rubber, const KcLook *look);
/* q' by a column: theta' = (I - 1/2 [theta]x + c [theta]x^2) omega. */
void kc_bend_rate(const KcRubber *rubber, const KcBent *bent, const KcLook *look, int column, double out[6]);
/* q_,ab by column a and a motion b: rates_b [outputs] are the rates in this motion, second [outputs] these
 * differentiated by column a, as kc_look_second() gives them. */
void kc_bend_second(const KcRubber *rubber, const KcBent *bent, const KcLook *look, int a, const double *rates_b,
                    const double *second, double out[6]);
/* The generalized force of all bushings along column a, and its derivative by column b. second: [outputs] of column a,
 * as kc_look_second() gives it for a motion along b alone. */
double kc_rubber_force(const Kc *kc, const KcLook *look, int a);
double kc_rubber_slope(const Kc *kc, const KcLook *look, int a, int b, const double *second);
/* What a bushing exerts on both its bodies, at their own ends: force and torque in the axes of the world; and the rates
 * of these along a motion. */
typedef struct KcWrench {
    double on[2][6], rate[2][6];
} KcWrench;
/* along: rates of the look's columns. */
void kc_rubber_wrench(const KcRubber *rubber, const KcLook *look, const double *along, KcWrench *wrench);

/* ---- kc_rubber.c: bodies that bushings alone hold */

/* True for one of the six coordinates of a body that force elements alone hold: it gives way, and does not steer. */
bool kc_is_mount(const Model *model, int coordinate);
/* Followers of an axle whose travel and steering are known; its refusal where rubber does not hold them. */
void kc_find_followers(Kc *kc, KcAxle *axle);
/* look->follow and look->relax from look->whole. Returns a status. */
int kc_follow(const Kc *kc, KcLook *look);
/* look->bend along a motion of the columns of look->whole with the rates `along`; second [columns][outputs]: of
 * look->whole along it. Returns a status. */
int kc_follow_second(const Kc *kc, KcLook *look, const double *along, const double *second);

/* ---- kc_wheel.c: a wheel as geometry sees it */

/* Its pose, or a rate of it along a motion. */
typedef struct KcPose {
    double centre[3], axis[3]; /* axis: unit vector, to the left */
    double contact[3];         /* lowest point of the rim of its radius */
    double locked[3];          /* rates: velocity of the point of the carrier at the contact */
    double turn[3];            /* rates: angular velocity */
} KcPose;

void kc_pose(const KcWheel *wheel, const KcLook *look, KcPose *pose);
/* along: rates of the columns. */
void kc_rate(const KcWheel *wheel, const KcLook *look, const KcPose *pose, const double *along, KcPose *rate);
double kc_camber(const KcWheel *wheel, const KcPose *pose);
double kc_camber_rate(const KcWheel *wheel, const KcPose *pose, const KcPose *rate);
/* Steer angle, positive to the left. */
double kc_steer(const KcPose *pose);
double kc_steer_rate(const KcPose *pose, const KcPose *rate);
/* z of the contact along two motions: its second derivative. second: of the rates along the first, by the second. */
double kc_contact_bend(const KcWheel *wheel, const KcPose *pose, const KcPose *a, const KcPose *b,
                       const double centre[3], const double turn[3]);

/* ---- kc_sweep.c: motions */

typedef enum KcMotion { KC_PARALLEL, KC_OPPOSITE, KC_STEER, KC_MOTIONS } KcMotion;
extern const char *const kc_motion_name[KC_MOTIONS];

/* Quantities of a wheel and of an axle: kc_table.c */
enum { KC_WHEEL_ROOM = 32, KC_AXLE_ROOM = 24 };

typedef struct KcRow {
    double at;                      /* travel, m, of the left wheels; in steering the coordinate */
    double *w;                      /* [coordinates] */
    double (*wheel)[KC_WHEEL_ROOM]; /* [wheels]; NAN: has no value here */
    double(*ratio);                 /* [wheels][elements] dx/dz */
    double axle[KC_AXLE_ROOM];
} KcRow;

typedef struct KcCurve {
    KcMotion motion;
    int rows, zero; /* zero: the row at the position of set-up */
    KcRow *row;
    const char *stop[2]; /* why it ends at the low and the high end before what was asked for; NULL: it does not */
} KcCurve;

enum { KC_STEPS = 20 /* to each side */ };

/* Move an axle to `travel`, m, up and down, or its steering through its range. NULL: it can not do that at all, *why.
 */
const KcCurve *kc_sweep(const Kc *kc, const KcAxle *axle, KcMotion motion, double travel, const char **why);

/* ---- kc_row.c: the quantities of one position */

/* along: rates of the look's columns along the motion, of which `at` moves with the rate 1. Returns a status. */
int kc_row(const Kc *kc, const KcAxle *axle, KcMotion motion, const double *w, KcLook *look, const double *along,
           KcRow *row);
/* The row of a position, in parallel travel, of an axle that can be moved. w: [coordinates]. Returns a status. */
int kc_position(const Kc *kc, const KcAxle *axle, const double *w, KcRow *row);
/* Rates of travel coordinates that move the wheels' centres, or else their contacts, with the velocities vz [wheels]
 * and the steering with the rate `steer`. along: [columns]. False: they can not. */
bool kc_along(const KcAxle *axle, const KcLook *look, bool contacts, const double *vz, double steer, double *along);
/* Solve A x = b of n equations in place; false: singular. */
bool kc_solve(int n, double *A, double *b);

/* ---- kc_force.c: forces of the axle's elements at the contacts */

/* Vertical forces [wheels] of the ground that hold the force elements, and their rates along a motion. Returns a
 * status.
 */
int kc_forces(const Kc *kc, const KcAxle *axle, const double *w, KcLook *look, const double *along, double *force,
              double *rate);

/* ---- kc_table.c: names and units */

typedef struct KcQuantity {
    const char *name, *title; /* "camber", "Camber" */
    const char *unit, *shown; /* "rad", "deg" */
    double scale;             /* from unit to shown */
    bool of_steering;         /* has a value only where the axle is steered */
} KcQuantity;

typedef enum KcOfWheel {
    KC_TRAVEL,
    KC_CAMBER,
    KC_TOE,
    KC_STEER_ANGLE,
    KC_CAMBER_RATE,
    KC_TOE_RATE,
    KC_CENTRE_X,
    KC_CENTRE_Y,
    KC_CONTACT_X,
    KC_CONTACT_Y,
    KC_CONTACT_Z,
    KC_FRONT_ARM,
    KC_FRONT_ANGLE,
    KC_SIDE_ARM,
    KC_SIDE_ANGLE,
    KC_BRAKE_ANGLE,
    KC_DRIVE_ANGLE,
    KC_FORCE,
    KC_RATE,
    KC_INCLINATION,
    KC_CASTER,
    KC_SCRUB,
    KC_TRAIL,
    KC_OFFSET,
    KC_OFFSET_X,
    KC_OF_WHEEL
} KcOfWheel;

typedef enum KcOfAxle {
    KC_TRACK,
    KC_TRACK_RATE,
    KC_CENTRE_HEIGHT,
    KC_CENTRE_SIDE,
    KC_FORCE_HEIGHT,
    KC_ROLL_RATE,
    KC_ANTI_BRAKE,
    KC_ANTI_DRIVE,
    KC_MEAN_STEER,
    KC_RATIO,
    KC_ACKERMANN_ERROR,
    KC_ACKERMANN,
    KC_RADIUS,
    KC_OF_AXLE
} KcOfAxle;

extern const KcQuantity kc_of_wheel[KC_OF_WHEEL], kc_of_axle[KC_OF_AXLE];
/* The unit of the steering ratio and of the steering coordinate, whose type differs. */
const char *kc_unit(const Kc *kc, const KcAxle *axle, int of_axle);

/* ---- kc_loads.c: compliance */

/* Loads of 1 N or 1 N m on each wheel: at the contact of the locked wheel along y and along x, about z, up at the
 * contact; and at the wheel's centre along x, y and z. */
typedef enum KcLoad {
    KC_LATERAL,
    KC_LONGITUDINAL,
    KC_ALIGNING,
    KC_VERTICAL,
    KC_HUB_LONGITUDINAL,
    KC_HUB_LATERAL,
    KC_HUB_VERTICAL,
    KC_LOADS
} KcLoad;
extern const char *const kc_load_name[KC_LOADS];

/* What a wheel does for it: rad, m, and N of the vertical force on its contact. turn: of its carrier about z. */
typedef struct KcGive {
    double steer, toe, camber, turn, contact[3], centre[3], force;
} KcGive;

/* give: [wheels]. opposed: the other way on the right. Returns NULL, or why there is none. */
const char *kc_compliance(const Kc *kc, const KcAxle *axle, KcLoad load, bool opposed, KcGive *give);
/* kc_report.c: the axles; ends in diag_fail where none of them has a compliance. */
const Kc *kc_loads_open(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* All loads of all axles as CSV; those of an axle for people. */
void kc_loads_csv(Pool *pool, const Kc *kc, const char *path);
void kc_loads_print(Text *out, const Kc *kc, int axle);
/* Those of all axles that have one, as numbers with names. */
struct Sheet kc_loads_sheet(Pool *pool, const Model *model, const Kc *kc);
/* kc_loads_page.c: numbers of that sheet, perhaps with another vehicle's beside (sheet_compare()), as a page with
 * bars. kc: whose axles without a compliance are told; [1]: of the other one, NULL: none. */
void kc_loads_page(const struct Sheet *sheet, const Kc *const kc[2], const char *path);

/* ---- kc_report.c: --kc */

/* Results of all axles. */
typedef struct KcStudy {
    const Kc *kc;
    double travel;
    const KcCurve *(*curve)[KC_MOTIONS]; /* [axles]; NULL: can not be moved so */
    const char *(*refusal)[KC_MOTIONS];
} KcStudy;

/* All axles in all motions. */
KcStudy kc_study(Pool *pool, const Model *model, const Scene *scene, const Request *request);
void kc_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);
/* Of the wheels' centres, m, unless the user says another. */
extern const double kc_usual_travel;
/* The first motion of an axle that is possible; NULL: none. */
const KcCurve *kc_first(const KcStudy *study, int axle);
/* Why a motion is not possible (end 0), or ends before the low or the high end; NULL: it does not. */
const char *kc_stop(Pool *pool, const KcStudy *study, int axle, KcMotion motion, int end);
/* Ends in diag_fail where no axle can be moved. */
void kc_must_move(const Model *model, const KcStudy *study);
/* Lines for people: what stops, what is not possible, each after `before`. */
void kc_tell_stops(Text *out, const KcStudy *study, const char *before);
/* A number as tables show it; "-" where it has no value, "parallel" where it is infinite. */
const char *kc_shown(Pool *pool, double value, double scale);
/* The row at set-up that has an axle's quantity; -1: those of its wheels. */
const KcRow *kc_zero(const KcStudy *study, int axle, int of_axle);
/* The unit in which a quantity of an axle is shown, and the factor from SI. */
const char *kc_shown_unit(const Kc *kc, const KcAxle *axle, int of_axle, double *scale);
/* Does an element move with a wheel of the axle? */
bool kc_ratio_seen(const Kc *kc, const KcAxle *axle, const KcRow *row, int e);
/* kc_compare.c: the numbers at the position of set-up. */
struct Sheet kc_sheet(Pool *pool, const Model *model, const KcStudy *study);
/* kc_compare.c: two vehicles side by side, at set-up as a table or as CSV, with their curves as a page. name: what the
 * other one is called. */
void kc_compare(Pool *pool, const Model *model, const KcStudy *study, const KcStudy *of_other, const char *name,
                const Request *request);
/* kc_page.c: what pages call a motion; the name of its abscissa and the factor to its unit. */
extern const char *const kc_motion_title[KC_MOTIONS];
const char *kc_abscissa(Pool *pool, const Kc *kc, const KcAxle *axle, KcMotion motion, double *scale);
/* True: a page draws a quantity of wheels in a motion. Left out are the abscissa, what another curve shows as well, and
 * places, of which there are changes. */
bool kc_is_drawn(int quantity, KcMotion motion);
/* What stops each axle, for pages; who: of which vehicle, NULL: there is one. */
void kc_stops_html(Text *out, const KcStudy *study, const char *who);
/* The page `path`. */
void kc_page(Pool *pool, const KcStudy *study, const char *path);

#endif
