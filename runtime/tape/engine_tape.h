/* SPDX-License-Identifier: MIT
 *
 * Engine `tape`: the control flow of the generated code over tapes instead of emitted blocks. Functions are called as
 * in the templates, and do the same in the same order. */
#ifndef TAPE_ENGINE_TAPE_H
#define TAPE_ENGINE_TAPE_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

/* One class of subsets. */
typedef struct TapeClass {
    const Tape *predict, *chord, *solve, *residual, *react;
    const Layout *layout;
    bool closed;   /* `solve` needs no start */
    double enough; /* square of a correction that is rounding, relative to the subset's size */
} TapeClass;

/* One class of wheels with tires. */
typedef struct TapeWheel {
    const Tape *contact, *tire, *balance;
} TapeWheel;

/* Numbers that a subset reads, as in model.c.in, and addresses of all arrays of its class's blocks. */
typedef struct TapeLinks {
    double **array, *x, *rate, *change, turn[3], ahead[1];
    bool cold, again, *same; /* the last: [coordinates] */
} TapeLinks;

/* Shared by all instances of a model: tapes, tables, offsets in an instance (bytes), and scratch whose contents no
 * later call uses. So only one thread at a time may compute. */
typedef struct TapeEngine {
    gic_model code;
    EngineProfile *profile; /* rows A and D: within blocks, functions and solver are one */
    const Formulation *formulation;
    TapeClass *class;
    int *member;  /* [subsets] */
    bool *keeps;  /* [subsets] plan_keeps() */
    bool follows; /* are there subsets whose poses Newton's iteration finds? */
    const Tape *dynamics, *outputs, *poses, *inverse, *energy, *check;
    const Tape *contacts;               /* NULL: there are none */
    const Tape *wrenches;               /* NULL: no reactions to find after the accelerations */
    const Tape *derive, *draw, *design; /* NULL: no parameter is geometric */
    int first_piece;                    /* of set-up with those */
    const bool *reacts;                 /* [subsets] whose multipliers outputs need */
    const Tape *link, *torque;          /* NULL: no wheel has a tire */
    const Tape *drive, *shift;          /* NULL: no powertrain */
    TapeWheel *wheel;                   /* [classes of wheels] */
    gic_table *table;
    double *piece, *initial; /* [coordinates], [states] */
    size_t x_offset, xd_offset, start_offset[GIC_STARTS], motion_offset, inertia_offset, multiplier_offset,
        derived_offset;
    size_t grip_offset, recovered_offset; /* the latter: x, xd, angular velocity and ahead of the last recovery, 1 + the
                                             start that it left */
    size_t gear_offset, watch_offset;
    double *link_row, *torques; /* a link; what drives and brakes [wheels with tires][2] */
    double *choice;             /* model/powertrain_numbers.h */
    double *frame, *q, *result, *out;
    int slots;                                     /* of the largest tape: room in `frame` */
    double *standard, *wanted;                     /* [tunables] values in the file, and while one is set up */
    double *acc, *unit, *tau0, *tau, *size, *mass; /* [unknowns], and squared */
    TapeLinks links;
} TapeEngine;

static inline const TapeEngine *tape_of(const Instance *self)
{
    return self->context;
}

static inline double *tape_array(Instance *self, size_t offset)
{
    return instance_array(&self->head, offset);
}

/* The Newton start of the last good configuration. */
static inline double *tape_start(Instance *self)
{
    return tape_array(self, tape_of(self)->start_offset[self->head.flip]);
}

/* Arrays of a class's blocks, followed by m0, m1, ... and as many w0, w1, ..., and arrays of the blocks about the whole
 * mechanism; names as in ARRAY_LIST of expression/expression.h. */
/* versions of clang-format break such lists in different ways */
/* clang-format off */
#define CLASS_ARRAYS(X) \
    X(q) X(x) X(rate) X(change) X(turn) X(ahead) X(s) X(f) X(start) X(motion) X(inertia) X(reach) X(step) X(worst) X(w) \
    X(d)
#define WHOLE_ARRAYS(X) \
    X(time) X(y) X(e) X(x) X(xd) X(u) X(m) X(n) X(p) X(port) X(rate) X(acc) X(out) X(pose) X(tau) X(size) X(energy) X(press) \
    X(lambda) X(link) X(fast) X(torque) X(contact) X(force) X(grip) X(gear) X(watch) X(choice)
/* clang-format on */
#define CLASS_ENUM(name) CLASS_##name,
#define WHOLE_ENUM(name) WHOLE_##name,
enum { CLASS_ARRAYS(CLASS_ENUM) CLASS_KNOWN };
enum { WHOLE_ARRAYS(WHOLE_ENUM) WHOLE_DERIVED, WHOLE_GRIP, WHOLE_WATCH, WHOLE_COUNT };
#undef CLASS_ENUM
#undef WHOLE_ENUM

/* open.c: room for the arrays of the largest class. */
TapeLinks tape_links_new(Pool *pool, const Formulation *f);
/* The same file: all but the functions of the descriptor. */
TapeEngine *tape_open(Pool *pool, const Model *model, Solve solve, Recovery recovery);

/* recover.c: tape_recover: all bodies at the coordinates of the instance, from the last good configuration.
 * tape_residual: the largest residuals of all subsets there, of the constraints and of their derivatives; returns a
 * subset whose residuals are above their tolerances, -1: none. */
int tape_recover(Instance *self, const double turn[3], bool cold);
/* The geometry has changed: the next recovery uses nothing of the last one. */
void tape_forget(Instance *self);
int tape_residual(Instance *self, double largest[2]);

/* Also recover.c: set the entries of links->array for the numbers that a subset reads. */
void tape_link(Instance *self, TapeLinks *links, const Subset *subset);

/* derive.c: the design configuration and the derived numbers with the instance's parameters; true if these are still
 * those of set-up. */
int tape_assemble(Instance *self, const double turn[3]);
bool tape_is_tuned(Instance *self);
/* The derived numbers in dual numbers, from the parameters of `value` and their derivatives in `slope`. slope_frame: as
 * many numbers as the engine's frame. journal: as in a TapeWorld. */
int tape_derive_dual(Instance *value, Instance *slope, struct TapeJournal *journal, double *slope_frame);
/* Record the tapes for that, after all others. */
void tape_record_derived(Pool *pool, TapeEngine *engine);

/* react.c: multipliers of the subsets that outputs need, at the present rate; e: Euler parameters of the base. */
int tape_react(Instance *self, const double e[4]);
/* The same in dual numbers, for an instance at the state and one for its derivatives, after tape_play_dual() of the
 * dynamics. links: of either; array, slope: arrays of tape_arrays(), with the rate. */
int tape_react_dual(Instance *const self[2], TapeLinks *const links[2], const TapeWorld *world, double *const *array,
                    double *const *slope, double *slope_frame);

/* engine_tape.c: coordinates of the instance and their rates, at a state. */
void tape_gather(Instance *self, const double *y);

/* engine_tape.c: play a tape about the whole mechanism, with the instance's arrays but for `rate`, `acc` and `out`
 * (which is also pose, tau and energy); NULL: not used. */
int tape_whole(Instance *self, const Tape *tape, double time, const double *y, const double *e, double *rate,
               double *acc, double *out);
/* tape_locate: recover a state. tape_present: set the inputs of the present time, and return the time. */
int tape_locate(Instance *self, double time, const double *y, double e[4]);
double tape_present(Instance *self);
/* The arrays that such a tape reads and writes. */
void tape_arrays(Instance *self, const double *time, const double *y, const double *e, double *rate, double *acc,
                 double *out, double *array[WHOLE_COUNT]);
/* Recover the present state, and store its rate in the instance. */
int tape_refresh(Instance *self, double e[4]);

/* wheels.c: the templates wheels.c.in and dual_rate.c.in, over tapes. */
void tape_record_wheels(Pool *pool, TapeEngine *engine, const Element *array);
int tape_turn_wheels(Instance *self, double time, const double *y, const double *e, double *rate);
/* The same in dual numbers, at links that tape_link_wheels_dual() has found or others. array, slope: arrays of
 * tape_arrays() for an instance at the state and for its derivatives; the rates of the fast states and the grip are
 * written there. link: of both. slope_frame: as many numbers as the engine's frame. */
int tape_link_wheels_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                          double *const link[2], double *slope_frame);
int tape_turn_wheels_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                          double *const link[2], double *slope_frame);
/* Recover the bodies, unless the last recovery was for the same coordinates and velocities. */
int tape_recover_once(Instance *self, const double turn[3]);
/* For the descriptor. */
int tape_link_wheels(void *self, double time, const double *slow, double *link);
int tape_fast(void *self, double time, const double *link, const double *fast, double *rate);
int tape_roll(void *self);

/* powertrain.c: the gears as numbers, into the instance; changes of gear as in shift.c.in; gears at set-up. */
int tape_engage(Instance *self);
int tape_shift(void *self);
void tape_start_gears(Instance *self);
/* The same file: what gears are chosen by, in dual numbers; array, slope: as of tape_turn_wheels_dual(). choice: of
 * both. */
int tape_choose_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                     double *const choice[2], double *slope_frame);

/* self_test.c: as the generated code tests itself. */
int tape_self_test(void *self, gic_self_test *result);

#endif
