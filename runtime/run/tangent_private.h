/* SPDX-License-Identifier: MIT
 *
 * What tangent_run.c, forwards, and adjoint_run.c, backwards, share. */
#ifndef RUN_TANGENT_PRIVATE_H
#define RUN_TANGENT_PRIVATE_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/tangent_run.h"
#include "run/trail.h"
#include "scene/driver.h"
#include "scene/profile.h"

/* The instance of both: a head, then the arrays of the descriptor. */
typedef struct Both {
    gic_head head;
    const TangentRun *run;
} Both;

/* A piece of a step whose ends come later by some variable: evaluations in it come later by what lies between, and
 * rates act for the longer. After a change of gear it is the rest of the step, whose end stays. */
typedef struct Rest {
    bool going;
    double start, end;          /* s */
    const double *late, *later; /* [carried] derivatives of both by each variable; NULL: they stay */
    double *by_late, *by_later; /* backwards: derivatives of the run's number by both; NULL: they stay */
} Rest;

/* A profile that has begun when a condition became true. */
typedef struct Begun {
    bool has;
    int clock;           /* of its start; -1: the time stays */
    const Profile *unit; /* what it changes by where the value that it began from is more by 1; NULL: nothing */
    double *present;     /* [carried] derivatives of that value */
} Begun;

/* A change of an input, for the way back. */
typedef struct Happening {
    int profile; /* of the scene */
    double time; /* s */
    Profile before;
    Begun begun; /* as it was before */
    int clock;
} Happening;

/* What conditions and contacts do to a run (tangent_event.c). */
typedef struct Happened {
    int conditions; /* the first outputs after those that are looked at, and as many again: their guards */
    bool ended;     /* the run, by a condition */
    int end;        /* clock of its end; -1: its time stays */
    double **clock; /* [clocks][carried] times that come later, by each variable */
    int clocks;
    Begun *begun; /* [profiles] */
    Happening *happening;
    int happenings;
    const char *failed;          /* what of it has no derivative; NULL: all has */
    const struct Action *blamed; /* the condition that is part of it; NULL: none */
    struct Saved *start, *inner; /* work: where a step and a piece begin */
    struct Watch *watch;         /* of contacts; NULL: none are located */
    double *fixed, *longer;      /* work: [all of the state] */
} Happened;

/* How what a driver keeps changes by a variable. */
typedef struct DriveSlope {
    Movement movement[DRIVE_MOVEMENTS];
    double sum[DRIVE_SUMS];
} DriveSlope;

struct TangentRun {
    Pool *pool;
    const Model *model; /* of the vehicle */
    Solve solve;
    const Engine *engine; /* tape */
    const Scene *scene;
    const Linear *linear;
    const gic_model *code; /* of the vehicle */
    Instance *self, *copy; /* the vehicle at the state and time that were evaluated last; for looks */
    gic_model descriptor;  /* of both */
    Both *both;
    int variables, carried; /* carried: whose derivatives are in the state: all of them, or backwards none */
    RunVariable *variable;
    bool shifted; /* the run ended where a gear changes in a way that has no derivative */
    bool remade;  /* the last step, in pieces that end at contacts */
    bool plain;   /* without derivatives for now, to search for something */
    double *from; /* state of both where the step began */
    Rest rest;
    double *shift; /* [carried] derivatives of the time at which a gear changes */
    Happened happened;
    int states, inputs, outputs; /* of the vehicle */
    Trail *trail;                /* NULL: forwards */
    int64_t steps;               /* of the run, so far */
    bool *live;                  /* [states] of values of controllers: it changes with something though it may look the
                                  * same */
    DriveSlope *drive;           /* [carried] */
    const Equilibrium *rests;    /* that the scene starts in; NULL: where it says */
    double *begins;              /* [variables][states] derivatives of the state at time 0 */
};

/* How the inputs change by a variable at a time: up to three numbers from the input on; returns how many. */
int tangent_input(const RunVariable *variable, double time, double change[3]);
/* How the inputs change with time: rate[inputs], 0 where no profile sets them. */
void tangent_input_rates(const TangentRun *run, double time, double *rate);
/* The parts of the state of both: number k, 0: of the vehicle, to own[states] and back. */
void tangent_take(const TangentRun *run, const double *both, int k, double *own);
void tangent_put(const TangentRun *run, const double *own, int k, double *both);
/* linear->along by variable k with what the inputs of both are, but for the state. */
void tangent_point(const TangentRun *run, int k);
double *tangent_array(const TangentRun *run, size_t offset);
/* An event of the trail, if there is one: `first` and `second`, and behind them the inputs, but not of what is settled.
 */
void tangent_note(const TangentRun *run, TrailKind kind, double time, const double *first, int firsts,
                  const double *second, int seconds);
/* On to `time` by parts of RK4, without a past. next: of the trail, what was before the first one and the piece that
 * all are of; afterwards a step that begins with nothing. Returns a status. */
int tangent_parts_to(TangentRun *run, double time, int parts, TrailStep *next);
/* True if what comes at `at` is before the end, but for rounding. */
bool tangent_is_before(const TangentRun *run, double at, double end);
/* Inputs of both at a time. */
void tangent_set_inputs(TangentRun *run, double time);
/* linear->drate: derivatives along variable k of a vehicle that has just been evaluated, of the rate and behind it of
 * the first outputs; state: of both. Returns a status. */
int tangent_slope(const TangentRun *run, const double *state, int k, int outputs);

/* tangent_event.c: before and after a step of the run, whose trail begins with `next`: what happens as conditions
 * become true in it. Both return a status, GIC_ERROR_EVENTS or GIC_ERROR_RESULT with happened.failed where that has no
 * derivative. */
int tangent_events_begin(TangentRun *run);
void tangent_events_before(TangentRun *run, const TrailStep *next);
int tangent_events_after(TangentRun *run);
/* Where a step begins or ends, and what happens from there on. */
typedef struct Saved {
    Both *both;
    Instance *self;
    bool *live;
    TrailMark mark;
    TrailStep next;
} Saved;

Saved *tangent_saved_new(const TangentRun *run);
void tangent_save(const TangentRun *run, Saved *saved, const TrailStep *next);
void tangent_restore(const TangentRun *run, const Saved *saved, TrailStep *next);
/* To a time in `parts` parts; late, later: clocks of the present time and of that one, -1: it stays. guard: what ends
 * the piece, and *later becomes its clock: a condition, or from the number of conditions on a contact; -1: nothing
 * does. */
int tangent_piece(TangentRun *run, double time, int parts, int late, int guard, TrailStep *next, int *later);
/* The value of a guard at the present state, after which guard_slope() is that along a change of the state and of the
 * time; k: and of variable k, -1: of none. Both return a status. */
int tangent_guard(const TangentRun *run, int guard, double *value);
/* The output of the model that is the guard of a condition; that of its value is as many before it as there are
 * conditions. */
int tangent_guard_output(const TangentRun *run, int condition);
int tangent_guard_slope(const TangentRun *run, int guard, const double *along, double late, int k, double *slope);

/* tangent_contact.c: `descriptor` of both gets the contacts of the vehicle, if the scene locates them; *at: room in the
 * instance, bytes. */
void tangent_contacts_make(TangentRun *run, gic_model *descriptor, size_t *at);
/* When a run begins. */
void tangent_contacts_begin(TangentRun *run);
/* An evaluation of the rates at a time. */
void tangent_contacts_see(const TangentRun *run, double time);
/* Before and after a step: where contacts change in it, it is made again in pieces that end there. *again: it was.
 * Returns a status. */
void tangent_contacts_before(TangentRun *run, const TrailStep *next);
int tangent_contacts_after(TangentRun *run, bool *again);
/* Once, before the first run of it. conditions: how many outputs of the model are conditions of the scene. */
void tangent_events_open(TangentRun *run, int conditions);
/* How inputs change by variable k as profiles have begun later, or from other values. */
void tangent_begun_inputs(const TangentRun *run, int k, double time, double *change);
/* True if the input follows a profile that a condition has begun. */
bool tangent_has_begun(const TangentRun *run, int input);
/* True if knots of driven coordinates are at times that move: steps go over them. */
bool tangent_knots_move(const TangentRun *run);
/* Derivatives of a clock; NULL: of one that stays. */
const double *tangent_clock(const TangentRun *run, int clock);
/* Of what follows a profile (value, rate, acceleration) the derivatives by time. */
void tangent_profile_rates(const Profile *profile, double time, double rate[3]);

/* State and inputs of the vehicle now: own[states + inputs]. */
void tangent_state(const TangentRun *run, double *own);
/* Dependent Euler parameter and gears of an event, as the vehicle has them. */
void tangent_discrete(const TangentRun *run, TrailEvent *event);
/* The vehicle gets those of an event. */
void tangent_go(const TangentRun *run, const TrailEvent *event);
/* Time since the last change of gear, in a state or its derivatives. */
double *tangent_age(const TangentRun *run, double *state);
/* True if fast states take steps of their own. */
bool tangent_dual(const TangentRun *run);
/* Parts in which the rest of a step is made after a change of gear; dual: it is one of dual rate. */
int tangent_parts(const TangentRun *run, bool dual);
/* The vehicle at a time, with the inputs of both. */
void tangent_inputs_of(const TangentRun *run, double time);

/* tangent_gear.c: after a step that began at `start` (s): if a gear changes within it, go on from there. step: of the
 * trail, or NULL. Returns a status, GIC_ERROR_EVENTS with run->shifted where that has no derivative. */
int tangent_shift(TangentRun *run, double start, bool dual, TrailStep *step);

/* What a rule does at a sample, in the trail. */
enum { SAMPLE_EFFECT = 1 /* the oldest value on its way takes effect */, SAMPLE_NEW = 2 /* its formula's is taken */ };
/* tangent_sample.c: what controllers do now. *event: the first of two of the trail, -1: nothing, or no trail; *next: s,
 * when they do something next. Returns a status. */
int tangent_sample(TangentRun *run, int *event, double *next);

/* tangent_drive.c: the driver's look, if one is due now; returns the event of the trail or -1. */
int tangent_drive_look(TangentRun *run);
/* The inputs that the driver moves: the present movements, and the input of each, -1: it does not move. */
void tangent_drive(const TangentRun *run, Movement *movement[DRIVE_MOVEMENTS], int input[DRIVE_MOVEMENTS]);
/* Orders of the input that movement m sets: 1, or 3 where rate and acceleration follow. */
int tangent_drive_orders(const TangentRun *run, int m);
/* How the inputs change by variable k as the driver does. */
void tangent_drive_inputs(const TangentRun *run, int k, double time, double *change);

/* Weights of the ends of a step in the state between them, a cubic, and how they change with the share. */
typedef struct Cubic {
    double from, to, rate, rate_there;
} Cubic;
Cubic tangent_between(double share, double step);
Cubic tangent_between_slope(double share, double step);

#endif
