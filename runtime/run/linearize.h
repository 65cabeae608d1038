/* SPDX-License-Identifier: MIT
 *
 * Small motions about a state, from exact derivatives of the expression graph: the tape of the engine `tape` played in
 * dual numbers. Static equilibrium and eigenvalues, which are made of them. */
#ifndef RUN_LINEARIZE_H
#define RUN_LINEARIZE_H

#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/scene.h"
#include "subset/subset.h"
#include "tape/engine_tape.h"
#include "tape/journal.h"

/* A direction in which the state of FORMAT.md section 10, inputs, ports, parameters and the time that formulas read
 * change. */
typedef struct Direction {
    double *y, *u, *port, *p, *time;
} Direction;

/* Small motions z of a model: `places` first, then their rates, then fast states. Places: of a free base displacements
 * x y z along the base's own axes (m) and small rotations roll pitch yaw about them (rad), then the free coordinates.
 * Rates: velocity of the base's origin in its own axes, angular velocity, rates of the coordinates. That is a minimal
 * set, in which the Euler parameters have no redundant direction, and steady turning on a plane is a steady state. */
typedef struct Linear {
    const TapeEngine *engine;
    int places, count;       /* count: 2 places and fast states */
    bool *slips;             /* [count] true for the slip of a tire */
    bool *jumps;             /* [count] set by linearize(): a rate jumps where this number passes its value */
    int of_wheels;           /* number of fast states that belong to wheels; they come first */
    int choices;             /* numbers of choice[]: what gears are chosen by (model/powertrain_numbers.h) */
    int clocks;              /* fast states after them that are held as they are: time since a shift, controllers */
    const char **name;       /* [count] */
    double *reach;           /* [count] units for comparison: 0.1 m, 0.1 rad, 0.1 m/s, 0.1 rad/s; 1 rad/s for spins, 0.1
                              * for slips. Equal on the left and right sides */
    double *piece;           /* [places] a small change: 0.1, or the change of a coordinate by which no body turns by
                              * more than 0.1 rad */
    Instance *value, *slope; /* work: an instance, and its derivatives in an instance's places */
    TapeLinks *links[2];     /* of both */
    Direction along;         /* work */
    TapeJournal *journal;
    double *frame, *q, *step[2], *euler[2], *link[2], *choice[2], *evaluated, *rate, *drate;
    int results; /* room in rate and drate */
} Linear;

/* linearize.c: `engine` is the engine tape. */
Linear *linear_open(Pool *pool, const Engine *engine);
/* Column by column, after linear_start(), which evaluates the state and sets f [count]: linear_column() sets the
 * derivatives df [count] of the motions' rates and dout [outputs] of the first outputs of the model by number j of a
 * kind. At kinks they are the mean of both sides; *jump: a rate or an output jumps there. Both return a status, which
 * the instance then has. Numbers of df and dout need not be finite. */
typedef enum LinearKind { LINEAR_MOTION, LINEAR_INPUT, LINEAR_PORT, LINEAR_PARAMETER } LinearKind;
int linear_start(const Linear *linear, Instance *self, double *f);
int linear_column(const Linear *linear, Instance *self, LinearKind kind, int j, double *df, int outputs, double *dout,
                  bool *jump);
/* Set linear->along to the direction of one number; of a small motion at the state of the instance. */
void linear_direction(const Linear *linear, Instance *self, LinearKind kind, int j);
/* What of the vehicle: the rate of its state and the first outputs; the links of wheels with tires (gic_runtime.h) at
 * its coordinates and the base; the rates of the fast states at given links; what gears are chosen by, of an instance
 * whose coordinates are gathered (tape_gather()) and whose gears are engaged; the numbers of contacts (gic_contacts).
 */
typedef enum LinearPart { LINEAR_RATE, LINEAR_LINKS, LINEAR_FAST, LINEAR_SHIFT, LINEAR_PRESS } LinearPart;
/* linear->drate: derivatives along linear->along, in Euler parameters, of the rate of the state at which the instance
 * has just been evaluated, and behind it of the first outputs (else 0 of them). LINEAR_LINKS: linear->link[1], of the
 * links. LINEAR_FAST: linear->drate, of the fast states, along linear->along and links that change by linear->link[1];
 * linear->link[0]: the links. LINEAR_SHIFT: linear->choice[1], and linear->choice[0] itself. LINEAR_PRESS:
 * those of contacts in linear->drate where else outputs are. At kinks those of the
 * branch that is taken. Returns a status. */
int linear_slope(const Linear *linear, const Instance *self, LinearPart part, int outputs);
/* The same backwards: linear->along becomes the derivative, by each number of state, inputs, ports, parameters and
 * by the time, of the sum of what linear_slope() finds with the weights in the arrays where that stores it, whose
 * contents are lost. LINEAR_FAST: linear->link[1] becomes that by the links.
 * linear->rate: rate and outputs. The instance's bodies have been recovered at its state. GIC_ERROR_RESULT where a
 * derivative is infinite. */
int linear_pull(const Linear *linear, const Instance *self, LinearPart part, int outputs);
/* linear_model.c: the unit of one of the small motions. */
const char *linear_unit(Pool *pool, const Linear *linear, int i);
/* dz/dt = f + A z about the state of an instance at its time, with its inputs, parameters and road. f: [count]; A:
 * [count][count]; where the state is at a kink but for 1e-9 of the reach, the mean of both sides. Returns a status,
 * which the instance then has. */
int linearize(const Linear *linear, Instance *self, double *f, double *A);
/* The instance's state moved by places and fast states of z [count], exactly also where they are not small; velocities
 * stay. */
void linear_move(const Linear *linear, Instance *self, const double *z);

/* ---- equilibrium.c: static equilibrium ------------------------------------------------------------------ */

/* Accelerations (m/s^2, rad/s^2) and rates of fast states below which nothing moves. */
extern const double equilibrium_limit;

typedef struct Equilibrium {
    const Model *model; /* the user's model with additional outputs of force elements and wheels after its own */
    const Engine *engine;
    const Linear *linear;
    Instance *self;  /* at rest, inputs as they are at time 0, driven coordinates standing still there */
    double *f, *A;   /* linearize() there */
    double residual; /* largest of the accelerations */
    int steps;
    bool locked;         /* wheels and engine are held, since the scene starts in motion */
    const char *neutral; /* places along which it may be moved and rests as well: "x, y, yaw"; NULL: none */
} Equilibrium;

/* The equilibrium that is reached from a scene's initial state, or without a scene from the model's, with inputs and
 * road of the scene at time 0. Wheels are locked where the scene starts in motion, since the forces that would hold
 * them at rest then do not matter. Ends in diag_fail if none is found. */
const Equilibrium *equilibrium_find(Pool *pool, const Model *model, const Scene *scene, Solve solve);
/* The same on locked wheels. */
const Equilibrium *equilibrium_find_locked(Pool *pool, const Model *model, const Scene *scene, Solve solve);
/* z [count]: how the places and fast states of the equilibrium change by number j of a kind, which is not
 * LINEAR_MOTION; along neutral directions they stay. Returns a status. */
int equilibrium_change(const Equilibrium *found, LinearKind kind, int j, double *z);
/* True if a scene starts at rest: all velocities at most 1e-9 m/s or rad/s. */
bool equilibrium_stands(const Model *model, const Scene *scene);
/* Output components of force elements (loads: -1) and of wheels (fz first) of Equilibrium.model. */
int equilibrium_force(const Equilibrium *found, int force);
int equilibrium_wheel(const Equilibrium *found, int wheel);
/* The angle, rad, between z of the drawing, as the base carries it, and the vertical; 0 for no vehicle with wheels and
 * a free base. From equilibrium_tipped on the vehicle does not rest on its wheels but has tipped over. */
double equilibrium_lean(const Equilibrium *found);
extern const double equilibrium_tipped;
/* Warn once of each coordinate that rests beyond its range. */
void equilibrium_warn_ranges(const Equilibrium *found, Place at);
/* What is to be said of a wheel that touches, but deflects less than its `fade` at these outputs; NULL: nothing. */
const char *equilibrium_faded(Pool *pool, const Equilibrium *found, const double *output, int wheel);
/* The scene with the places of the equilibrium; a `speed` is along the base there. */
const Scene *equilibrium_scene(Pool *pool, const Scene *scene, const Equilibrium *found);
/* Give the equilibrium's instance the velocities of the scene's initial state, and its spins. False: the scene has
 * none. Ends in diag_fail where the wheels can't roll. */
bool equilibrium_set_in_motion(Pool *pool, const Scene *scene, const Equilibrium *found);

/* ---- equilibrium_report.c ------------------------------------------------------------------------------- */

/* Make places that are 0 but for rounding exactly so, compute the outputs there, check the residual by `engine` too,
 * which must respect the limit, and unless `quiet` warn of ranges and instability. Returns that residual; ends in
 * diag_fail. */
double equilibrium_settle(Pool *pool, const Engine *engine, const Scene *scene, bool quiet, const Equilibrium *found);
/* Base, coordinates, forces, loads and fast states of a state whose outputs are computed, and equilibrium_initial(). */
void equilibrium_tables(Text *out, const Equilibrium *found);
/* The `initial` of a scene that starts there. */
void equilibrium_initial(Text *out, const Equilibrium *found);
/* A row for --eval, which gives the numbers found here. */
void equilibrium_row(Pool *pool, const Equilibrium *found, const char *path);
/* --equilibrium: tables, and with -o the state as a row that --eval reads. */
void equilibrium_report(Pool *pool, const Engine *engine, const Scene *scene, const Request *request,
                        const Equilibrium *found);

/* ---- modes.c: eigenvalues ------------------------------------------------------------------------------- */

/* A pair of complex eigenvalues (imaginary > 0), or a real one; 1/s. */
typedef struct Mode {
    double real, imaginary;
    double *share; /* [places + fast states] of a place together with its rate, or of a fast state; sum 1 */
    double *shape; /* [2][places] real and imaginary part of its eigenvector */
    double moves;  /* the largest of the places in that vector over the largest of all numbers, by Linear.reach */
} Mode;

typedef struct Modes {
    int count, zeros;    /* zeros: number of rigid-body eigenvalues (no stiffness, no drive), not among the modes */
    Mode *mode;          /* slowest first */
    const char *neutral; /* places (and their rates) that they belong to; NULL: none */
} Modes;

/* Of dz/dt = A z; NULL: the eigenvalues could not be found. */
const Modes *modes_try(Pool *pool, const Linear *linear, const double *A);
/* The same, which ends in diag_fail then. */
const Modes *modes_find(Pool *pool, const Linear *linear, const double *A);
/* Warns where a rate jumps as a number passes its value: the modes are not those of either side then. */
void modes_warn_jumps(const Linear *linear, Place at);
/* The modes about the equilibrium, with the scene's velocity; *moves: it has one. Ends in diag_fail. */
const Modes *modes_about(Pool *pool, const Scene *scene, bool quiet, const Equilibrium *found, bool *moves);
/* Column k of a table of modes, with its unit (NULL: none), NULL: there is no such column; and a number in it, NAN: it
 * does not apply. Modes from -zeros to count - 1; negative ones are the zeros. */
const char *modes_column(Pool *pool, const Linear *linear, int k, const char **unit);
double modes_value(const Linear *linear, const Modes *modes, int mode, int k);
/* Print names and parts of the three largest shares above a tenth, and the end of the line. */
void modes_print_shares(Text *out, const Linear *linear, const Mode *mode);
/* --modes: a table; or CSV with -o. About the equilibrium, with the scene's velocity. */
void modes_report(Pool *pool, const Scene *scene, const Request *request, const Equilibrium *found);

/* ---- mode_steps.c: constant steps for modes -------------------------------------------------------------- */

/* True if the mode is mostly of fast states, which have their own steps with a `ratio`. */
bool mode_is_fast(const Linear *linear, const Mode *mode);

/* Steps of one gic_method, s; INFINITY: any. */
typedef struct StepLimit {
    double stable;      /* longest one with which no mode grows that decays by itself */
    const Mode *limits; /* the mode that sets it; NULL: none */
    double accurate;    /* longest one with which all modes keep their eigenvalues to mode_accuracy */
} StepLimit;

extern const double mode_accuracy; /* of |eigenvalue| */
/* ratio: fast steps of AB3 in a step; a mode of fast states and a `ratio` are taken to move apart from others. */
StepLimit modes_step(const Linear *linear, const Modes *modes, int32_t method, int32_t ratio);
/* Column k of a table of steps for single modes, s, as modes_column() and modes_value(). */
const char *mode_steps_column(int k);
double mode_steps_value(const Mode *mode, int k);
/* A table of modes_step() for people, with the ratio of a scene, or NULL. */
void modes_print_steps(Text *out, const Linear *linear, const Modes *modes, const Scene *scene);

#endif
