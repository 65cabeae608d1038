/* SPDX-License-Identifier: MIT
 *
 * gicgen: every type of the generator and, file by file in the order of the pipeline, every function
 * that one file offers to another. Dependencies run downwards only: a file uses what stands above it. It begins in
 * support.h (memory, text, messages, YAML), model.h (what a file says), sequence.h (which subsets there are) and
 * expressions.h (the expression graph and what is made of it), and goes on here.
 *
 *     .veh -> document -> model -> graph -> sequence -> formulation -> expressions -> emission -> .c/.h
 *
 * Conventions. Memory comes from a Pool that lives as long as the program's main context: nothing is
 * freed one by one. Bad input ends in diag_fail(), which prints one message and exits with status 1.
 * Vectors are double[3], matrices row-major, Euler parameters (e0, e1, e2, e3). SI units.
 */
#ifndef GICGEN_H
#define GICGEN_H

#include "expressions.h"

#define GICGEN_VERSION "0.1.0"

/* ---- subset.c, follow.c, inertia.c: recovery of one class of decoupled subsets ----------------------------- */

/* How accelerations are found: in the reduced form of Proposition 2.1 of Serban and Haug 2000; the same equations
 * eliminated along chains of bodies, from their tips; or in the augmented form of their eq. 16. Auto: of the first two
 * the one with fewer operations. A Plan has never auto. */
typedef enum Solve { SOLVE_AUTO, SOLVE_REDUCED, SOLVE_ARTICULATED, SOLVE_AUGMENTED, SOLVES } Solve;

extern const char *const solve_name[SOLVES]; /* as on the command line: "reduced" */
/* By that name; SOLVES: there is none of that name. */
Solve solve_of(const char *name);

/* How a subset's poses are found: in the way that takes fewer operations; by Newton's iteration everywhere; in closed
 * form wherever there is one. */
typedef enum Recovery { RECOVERY_AUTO, RECOVERY_NEWTON, RECOVERY_CLOSED, RECOVERIES } Recovery;

extern const char *const recovery_name[RECOVERIES]; /* as on the command line: "auto" */
/* By that name; RECOVERIES: there is none of that name. */
Recovery recovery_of(const char *name);

/* Where a subset keeps its numbers. start: what the next call begins from (pose 7 a body, S, factors); motion: one
 * Motion a body; inertia: what it adds to the equations of motion, see INERTIA_*. */
typedef struct Layout {
    int bodies, deps, factors;
    int start_size, start_S, start_factors;
    int motion_size; /* of one body */
    int inertia_size;
} Layout;

/* inertia: first and second moments about the base origin (the carrier's reference point) in the base frame, force and
 * moment of the quadratic-velocity terms, then 7 numbers a coordinate (force and moment of its unit acceleration,
 * quadratic-velocity force along it), then the upper triangle of the coordinates' mass matrix. */
enum { INERTIA_FIRST = 0, INERTIA_SECOND = 3, INERTIA_FORCE = 9, INERTIA_MOMENT = 12, INERTIA_COORDINATE = 15 };

int inertia_mass(int deps, int j, int k); /* place of M_jk, j <= k */

/* The formulas of a class. C names: k constants of the member, d those of them that tunable parameters change, m0, m1,
 * ... motions of the knowns, x, rate, change:
 * value, rate and change since the start of the deps, turn: angular velocity of the base, ahead: time that must be left
 * until the coordinates stop being independent, at the present velocities, q: pose, s and f: S and
 * factors of the start, motion: the poses that were found. */
typedef struct Formula {
    Dag *dag;
    Layout layout;
    double size;        /* largest distance between points of a subset, m */
    double distance;    /* largest of its reference points from the base's origin at the design, relative to size */
    bool closed;        /* poses in closed form, by `solve` alone: predict and chord are empty, nothing is remembered */
    Motion *motion;     /* [bodies] what `solve` finds */
    Ex *inertia;        /* [inertia_size] likewise */
    Ex (*across)[2][3]; /* [joints] directions, base frame, that multipliers belong to in place of those at the design
                           which are fixed in the first body; 0: those */
    Block predict;      /* q from the start and `change`; reach: squared relative size of that move */
    Block chord;        /* one correction of q with the start's factors; step: its squared relative size */
    Block solve;        /* factors, S, last correction, motion and inertia */
    Block residual;     /* worst[0]: sum of the constraint residuals of the motion, relative to size; worst[1]:
                           of their derivatives' residuals, relative to the magnitudes of their terms */
    Block react;        /* multipliers w from the wrenches w that the bodies need, f being those at their place; what
                           the joints put on the knowns is taken from theirs, w0, w1, ...; only what outputs need */
    int derived;        /* numbers d[] that follow tunable parameters */
    Ex *derived_of;     /* [derived][members] their formulas */
} Formula;

/* All classes [classes]. Fills the sampling on the way. Members that need other pivots than their class's first one get
 * a class of their own: *sequence is replaced by one that says so. Singular subsets end in diag_fail. */
Formula **subsets_formulate(Pool *pool, const Model *model, const Sequence **sequence, const double (*origin)[3],
                            Sampling *sampling, Solve solve, Recovery recovery);
/* settled.c: is a number of the motions or inertias the same in every configuration, and which one for a member? Such
 * numbers are not in memory. */
bool formula_settled(const Formula *f, Ex e);
double formula_value(const Formula *f, Ex e, int member);
/* Reference points of all bodies [bodies][3], body frames: where a joint to something known sits. */
double (*reference_points(Pool *pool, const Model *model, const Sequence *sequence))[3];

/* ---- reaction.c: which reaction forces are wanted, and where they come from ----------------------------------- */

/* [subsets] whose multipliers some `reaction` output needs: of its joint's subset, and of those that put their weight
 * on it. */
const bool *reactions_needed(Pool *pool, const Model *model, const Sequence *sequence);
/* Does an output ask for the reaction of this joint; for the force that drives this coordinate? */
bool reaction_wanted(const Model *model, int joint);
bool drive_wanted(const Model *model, int coordinate);

/* ---- assemble.c: the design configuration that fits the given lengths ----------------------------------------- */

/* The model with its bodies' design poses moved to where every joint fits (FORMAT.md section 4); the same model where
 * nothing moves. Ends in diag_fail when there is no way there. */
const Model *model_assemble(Pool *pool, const Model *drawn, const Sequence *sequence);

/* ---- hold.c: models as on a rig; without a tuning ------------------------------------------------------------------
 */

/* The model with its base held where its body frame is at `position` and `euler`, world. */
const Model *model_hold(Pool *pool, const Model *model, const double position[3], const double euler[4]);
/* The model with these free coordinates driven, by inputs behind those that it has. */
const Model *model_drive(Pool *pool, const Model *model, const int *coordinate, int count);

/* ---- massless.c: light bodies without mass, an approximation; without a tuning ---------------------------------- */

/* The model in which bodies of less than `below` kg have neither mass nor inertia. *names: which, in a list for people;
 * NULL: none. */
const Model *model_lighten(Pool *pool, const Model *model, double below, const char **names);
/* The name of a body without mass, NULL: all have one. Ground does not count. */
const char *model_massless(const Model *model);
/* The largest part of its kinetic energy that a motion of the free coordinates loses by that, base and driven
 * coordinates held, at the design and some configurations in the coordinates' ranges. 1: a motion is left without
 * inertia, so that the equations of motion have no solution. */
double model_lost(Pool *pool, const Model *model, double below);

/* ---- whole.c: the whole mechanism, once all subsets are recovered ---------------------------------------------- */

/* Unknowns of the equations of motion that go with each other: unknown i is sign[i] times number of[i] of fewer ones,
 * or 0 where that is -1. */
typedef struct Reduction {
    int unknowns, *of;
    double *sign;
} Reduction;

/* Where the numbers of every subset stand in the work space, and where states stand in the state. */
typedef struct Plan {
    const Model *model;
    const Sequence *sequence;
    Solve solve;
    Formula **formula; /* [classes] */
    const double (*origin)[3];
    int lanes;                          /* of vectors at most, of a plan in lanes; 0: numbers one by one */
    int pack;                           /* of these in the equations of motion; 0: none */
    int *coordinate_track;              /* [coordinates] with `pack`: which part of those alike it is of; -1: of none */
    int *class_lanes;                   /* [classes] of those that are solved side by side; 0: one by one */
    int *start_offset, *inertia_offset; /* [subsets] */
    int *motion_offset;                 /* [bodies] */
    int *stride;                        /* [subsets] from one of its numbers to the next, in all three */
    int multipliers;                    /* kept for outputs; 0: none needs them */
    int *multiplier_offset;             /* [bodies] six places a body; those of a subset's bodies are its equations' */
    int *derived_offset;                /* [subsets] where d[] begins in derived[] */
    Derived *derived;                   /* grows with the blocks that are made */
    int start_size, inertia_size, motion_size;
    int free_coordinates;
    int *coordinate_state, *coordinate_rate; /* [coordinates] index in the state, -1: driven */
    int states;                              /* r e w v omega w', or w w'; fast states behind them do not count */
    int unknowns;                            /* accelerations: alpha and a of a free base, then the free coordinates */
    int *coordinate_unknown;                 /* [coordinates] -1: driven */
    const Reduction *reduction;              /* NULL: every unknown is one of its own */
} Plan;

Plan *plan_new(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Formula **formula,
               const double (*origin)[3]);

/* Does the Newton start have poses of this subset's bodies? Not of the base, nor where poses have a closed form. */
bool plan_follows(const Plan *plan, int subset);
/* Is the solution of a subset a function of its coordinates, their rates and the angular velocity of the base alone, so
 * that one for the same numbers can be kept? One that Newton's iteration finds depends on its start, by rounding. */
bool plan_keeps(const Plan *plan, int subset);
/* A number that tells forms of the equations and places of numbers from others: code for many vehicles, which reads an
 * instance's, must be made for the same ones. */
int plan_layout(Pool *pool, const Plan *plan);

/* Inputs of every global block, as C names: y state, e recovered Euler parameters of the base, x and xd values and
 * rates of all coordinates, u inputs, m motions, n inertias, lambda multipliers (Plan.multiplier_offset). Fixed base:
 * r, e and R are numbers, v and turn 0. */
typedef struct Whole {
    const Plan *plan;
    const Model *model;
    Dag *dag;
    Motion *motion;            /* [bodies] relative to the base */
    Ex r[3], e[4], R[9], v[3]; /* base: position, Euler parameters, rotation to the world, world velocity */
    Ex turn[3];                /* angular velocity of the base, base frame */
    Ex gravity[3];             /* base frame */
    Ex *x, *xd;                /* [coordinates] */
    bool open;                 /* numbers that are known stay inputs, for block_pack to compare */
    bool sized;                /* loads know the magnitudes of their terms */
    const Ex *carried_by;  /* carry.c: the accelerations of coordinates that these belong to; NULL: there are none */
    Ex (*carried)[6];      /* [bodies] what they give: angular, that of the reference point */
    Ex (*carried_size)[2]; /* [bodies] sums of magnitudes of the terms */
} Whole;

Whole *whole_new(Pool *pool, const Plan *plan);
Whole *whole_open(Pool *pool, const Plan *plan, bool open);
/* A number of the model. */
Ex whole_number(Whole *whole, const double *at);
/* A point of a body (or of ground) relative to the base, in the base frame; s in the body frame: numbers of the model.
 */
Vector whole_point(Whole *whole, int body, const double s[3]);
/* Fixtures; origin: reference points. */
Fixture whole_joint_fixture(Whole *whole, const Joint *joint, const double (*origin)[3]);
Fixture whole_coordinate_fixture(Whole *whole, const Coordinate *coordinate, const double (*origin)[3]);
/* World position and velocity of a point given relative to the base. */
void whole_position(Whole *whole, const Vector *point, Ex out[3]);
void whole_velocity(Whole *whole, const Vector *point, Ex out[3]);
/* Velocity in the base frame of a point moving with the base and relative to it. */
void whole_velocity_in_base(Whole *whole, const Vector *point, Ex out[3]);
/* A symmetric matrix given in the axes of a body, in base axes (xx yy zz xy xz yz). */
void whole_rotate_inertia(Whole *whole, int body, const Ex own[6], Ex out[6]);
/* A body's inertia matrix in base axes. */
void whole_inertia(Whole *whole, int body, Ex J[6]);
/* A fast state of a wheel, `array` being "y", or its rate, "rate". */
Ex whole_fast(Whole *whole, const char *array, int wheel, int state);
/* What a wheel with a tire does: a number of its grip[]. */
Ex whole_grip(Whole *whole, int wheel, int number);
/* What the powertrain does: a number of its watch[]. */
Ex whole_watch(Whole *whole, int number);
/* Coordinates that a body's motion relative to its carrier depends on. */
const Subset *whole_subset(const Whole *whole, int body);

/* ---- carry.c: chained sequences ------------------------------------------------------------------------------ */

/* The body that carries this one, or BODY_BASE. */
int whole_carrier(const Whole *whole, int body);
/* Add to the angular acceleration of a body, and to the acceleration of a point of it at `at` relative to the base,
 * what the accelerations w2 [coordinates] of others than its own coordinates give them. Nothing where the base carries
 * it. */
void whole_carry(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex angular[3], Ex linear[3]);
/* The same for sums of magnitudes of their terms. */
void whole_carry_size(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex *angular, Ex *linear);
/* Wrenches [bodies], moment about the reference point and force, go from bodies to those that carry them; along
 * [coordinates] gets what they add there, those of the bodies themselves not counted. */
void whole_hand_on(Whole *whole, const Ex (*wrench)[6], Ex *along);
/* The same for sums of magnitudes of moments and of forces. */
void whole_hand_size_on(Whole *whole, const Ex (*size)[2], Ex *along);
Ex whole_magnitude3(Whole *whole, const Ex v[3]); /* |x| + |y| + |z| */

/* ---- table.c: tables of FORMAT.md section 7 ----------------------------------------------------------------- */

/* Slopes of the monotone cubic (Fritsch and Carlson), from x and y. */
void table_slopes(Table *table);
double table_value(const Table *table, double x);

/* ---- loads.c: applied forces -------------------------------------------------------------------------------- */

/* Applied forces body by body, and from them generalised forces: moment about the base origin and force on everything,
 * base frame; force along every coordinate. */
typedef struct Loads {
    Ex (*wrench)[6]; /* [bodies] moment about the reference point, force; base frame */
    Ex *own;         /* [coordinates] of the elements along a coordinate, not among the wrenches */
    Ex moment[3], force[3];
    Ex *along;                           /* [coordinates] of all */
    Ex *element;                         /* [forces] Q or T of FORMAT.md section 7 */
    Ex (*wheel)[4];                      /* [wheels] fz, deflection, deflection rate, road height */
    Ex potential, potential_rate, power; /* of springs; of dampers and tires, W */
    Ex terms;      /* of the element made last: the sum of its terms' magnitudes; only where sizes are asked for */
    Ex (*size)[2]; /* [bodies] sums of magnitudes of moments about the reference point, and of forces */
    Ex *own_size;  /* [coordinates] likewise along a coordinate */
} Loads;

Loads *loads_make(Whole *whole);
/* A formula as an expression; local: what its place offers. */
Ex whole_law(Whole *whole, const Law *law, const Ex *local);

/* ---- wheel.c, tire_*.c, powertrain.c: wheels with tires, models/TIRES.md, POWERTRAIN.md --------------------- */

/* How the multibody system moves a wheel: its link, world components. Behind those of all wheels a link has the
 * coordinates that formulas of wheels read. */
enum { LINK_C = 0, LINK_V = 3, LINK_S = 6, LINK_OMEGA = 9, LINK_NUMBERS = 12 };

/* What a wheel does: grip[]. */
enum {
    GRIP_FORCE = 0,  /* on the carrier at the wheel's centre, world */
    GRIP_TORQUE = 3, /* the same */
    GRIP_DRIVE = 6,  /* torques of drive and brake, N m */
    GRIP_BRAKE,
    GRIP_LOAD, /* Fz, rho, rho', h */
    GRIP_DEFLECTION,
    GRIP_DEFLECTION_RATE,
    GRIP_HEIGHT,
    GRIP_TIRE,                  /* Fx, Fy, Mx, My, Mz */
    GRIP_KAPPA = GRIP_TIRE + 5, /* slips and camber that the tire has */
    GRIP_TANGENT,
    GRIP_CAMBER,
    GRIP_POINT,                    /* P */
    GRIP_SPEED_X = GRIP_POINT + 3, /* V_x, V_y */
    GRIP_SPEED_Y,
    GRIP_RADIUS, /* R_e */
    GRIP_POWER,  /* of all that turns the wheel, W */
    GRIP_NUMBERS
};

/* Wheels with the same tire that have the same formulas or lack them. Inputs, as C names: link and fast (of the wheel),
 * torque (drive, brake), time, and between the blocks hub and force (wheel.h); k constants of the member. */
typedef struct WheelClass {
    const char *name; /* of the first member */
    int members, *member;
    Block contact; /* hub[]; rate[] of the slips; grip[] */
    Block tire;    /* force[], of a wheel that is loaded; else they are 0 */
    Block balance; /* rate[] of spin and brake; grip[] */
} WheelClass;

typedef struct Wheels {
    int count; /* wheels with tires */
    int classes;
    WheelClass *class;
    int links;    /* numbers of a link */
    Block link;   /* link[], from a Whole */
    Block torque; /* torque[2 i]: drive and brake of the i-th wheel with a tire, from link, fast, u, p, time */
    Block drive;  /* of a powertrain, after the wheels: what it changes in rate[] and grip[] of all, and watch[]; from
                   * these, link, fast, gear, u, p, time (powertrain.h) */
    Block spins;  /* the same of the driven wheels without solving their equations, for proofs: left[], what rates of
                   * their spins acc[] leave of these; left and acc by place among the fast states */
    Block shift;  /* choice[] after a step, from fast, gear, x, xd, u, p, time */
} Wheels;

const Wheels *wheels_formulate(Pool *pool, const Plan *plan);
/* wheel_merge.c: the same with classes whose formulas differ in numbers alone made one. */
const Wheels *wheels_merge(Pool *pool, const Wheels *wheels);
/* How many wheels with tires come before this one. */
int wheel_rolling(const Model *model, int wheel);

/* ---- dynamics.c, outputs.c: the blocks that end the pipeline ----------------------------------------------- */

/* rate[] of the whole state, reduced form; checks the pivots of the mass matrix. */
Block *dynamics_block(Whole *whole);
/* articulated.c: the same of a chained sequence, coordinates of carried subsets eliminated from the tips. */
Block *articulated_block(Whole *whole);
/* Why the articulated form is not for a model, NULL: it is. Masses may differ by this factor, tuned ones too. */
extern const double articulated_most_mass;
const char *articulated_missing(const Model *model);
/* Accelerations of the driven coordinates, as inputs give them; 0 for the others [coordinates]. */
Ex *whole_driven_accelerations(Whole *whole);
/* rate[] from the accelerations z [unknowns]. */
void whole_store_rates(Whole *whole, Block *block, const Ex *z);
/* augmented.c: the same in the augmented form, and lambda[] as far as outputs need them. Refuses models with bodies
 * that have more than augmented_most_mass times the mass of others. */
extern const double augmented_most_mass;
Block *augmented_block(Whole *whole);
/* out[] of all outputs, from a Whole and rate[]. */
Block *outputs_block(Whole *whole);
/* pose[7 i]: world poses of all body frames. s: the Newton start. */
Block *poses_block(Whole *whole);
/* reaction.c: lambda[] of the subsets whose multipliers are needed: the wrenches that the joints of their bodies must
 * add up to, moment about the reference point and force, base frame, at rate[]. */
Block *wrenches_block(Whole *whole);
/* reaction.c: force and torque of a joint on its second body at its point of that, base frame, from lambda[]. */
void whole_reaction(Whole *whole, int joint, Ex force[3], Ex torque[3]);
/* reaction.c: force that drives a driven coordinate, from lambda[] of the augmented form. */
Ex whole_drive_reaction(Whole *whole, int coordinate);
/* tau[]: residual of the equations of motion for accelerations acc[] (order of the unknowns), body by body. */
Block *inverse_block(Whole *whole);
/* tau[]: the same residual at rate[], and size[]: the sum of magnitudes of the terms that it is made of. */
Block *check_block(Whole *whole);
/* energy[3]: both sides of the energy balance at rate[] and the sum of magnitudes; acc[]: the unknowns at rate[]. */
Block *energy_block(Whole *whole);
/* Accelerations at rate[]: alpha, a (base frame, less gravity), w2 of all coordinates [coordinates]. */
void whole_accelerations(Whole *whole, Ex alpha[3], Ex a[3], Ex **w2);
/* Force that drives a driven coordinate, at rate[]. */
Ex whole_drive_force(Whole *whole, int coordinate);
/* Power of all that changes the sum of kinetic and potential energy, at rate[]: of the loads and of the drives of
 * driven coordinates. */
Ex whole_power(Whole *whole, const Loads *loads);
/* What moves a body as given: moment about its reference point, force; base frame. */
void whole_inertial_wrench(Whole *whole, int body, const Ex alpha[3], const Ex a[3], const Ex *w2, Ex wrench[6]);
/* Absolute acceleration less gravity, base frame, of a point; alpha, a: of the base (a less gravity), w2: of all
 * coordinates. */
void whole_acceleration(Whole *whole, int body, const Vector *point, const Ex alpha[3], const Ex a[3], const Ex *w2,
                        Ex out[3]);
void whole_angular_acceleration(Whole *whole, int body, const Ex alpha[3], const Ex *w2, Ex out[3]);

/* ---- derive.c: what follows geometric parameters, at set-up; models with a tuning only ------------------------- */

/* Steps from the drawing to given lengths at set-up, as many as assemble.c takes. */
enum { ASSEMBLY_PIECES = 64 };

/* derived[] from p[] and `rest`; checks what parameters must not violate. After all blocks that read derived[]. */
const Block *derive_block(Pool *pool, const Plan *plan);
/* What of state[], input[] and start[0] follows parameters, at the drawing. */
const Block *draw_block(Pool *pool, const Plan *plan);
/* Refuses parameters with which closed forms, whose branches are those of the file's design, recover other poses at the
 * drawing than it has: checks alone, of self->motion[] there. */
const Block *design_block(Pool *pool, const Plan *plan);
/* The first of the pieces in which set-up goes from the drawing (piece 0) to given lengths: 0 where design_block() has
 * something to check and the drawing's lengths are not the given ones, else 1. */
int design_first_piece(Pool *pool, const Plan *plan);
/* Where a body stands in the drawing relative to another one, or to the base: reference point, as formulas, and Euler
 * parameters. origin: reference points [bodies][3], body frames. */
void body_drawn(const Model *model, const double (*origin)[3], int anchor, int body, Ex c[3], double p[4]);

/* ---- formulation.c: all of the above for one model ----------------------------------------------------------- */

/* What is known beforehand, narrow.h. */
typedef struct Narrowing Narrowing;

typedef struct Formulation {
    const Model *model;
    const Sequence *sequence; /* its classes share pivots */
    const Sampling *sampling;
    const Plan *plan;
    const char *hash; /* of the model, in hexadecimal digits */
    const Block *dynamics, *outputs, *poses, *inverse, *energy, *check;
    const Block *wrenches;             /* of the reduced form */
    const Wheels *wheels;              /* NULL: none has a tire */
    int known_most, dependence_most;   /* knowns and deps of a subset, at most */
    const Narrowing *narrowing;        /* for one scene; NULL: for all */
    const struct Formulation *general; /* for one scene: the same model's for all; NULL: for all */
} Formulation;

/* From an assembled model. The sequence of the articulated form is chained. Models that can't be formulated end in
 * diag_fail. */
const Formulation *formulate(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Recovery recovery);

/* Is it a long chain, or is the articulated form asked for? Then the form is taken without counting, and code for one
 * scene is that for any. */
bool formulation_chains(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);
/* How many numbers its subsets' motions and inertias are, FORMAT.md section 14: what work and memory grow with. */
double formulation_numbers(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);

/* The blocks of a formulation, from its plan. */
void formulation_blocks(Pool *pool, Formulation *f);

/* lanes.c: the number of lanes, 2, 4, 8 or 16, that a word means; 0: none of these. */
int lanes_of(const char *word);
/* The same formulation for code that solves the members of a class side by side in vectors of up to `most` lanes, a
 * power of 2: their numbers stand in rows, one lane a column. */
const Formulation *formulation_lanes(Pool *pool, const Formulation *formulation, int most);
/* How many rows of members a class has; where it has no lanes, how many members. */
int class_rows(const Plan *plan, int class);

/* Are there reactions to find after the accelerations? The augmented form has them already. */
bool formulation_reacts(const Formulation *f);

/* One number of the state, fast ones last: FORMAT.md section 10. */
typedef struct StateNumber {
    const char *name, *unit;
    double initial;
} StateNumber;

StateNumber state_number(Pool *pool, const Formulation *f, int index);
/* Change of a coordinate that is followed in one piece: no body turns by more than about a tenth of a radian. */
double coordinate_piece(const Formulation *f, int coordinate);
/* Is it an angle whose pieces are less than half a turn, so that a change by whole turns is none of poses? */
bool coordinate_unwinds(const Formulation *f, int coordinate);
/* Design pose of a body relative to the base, as a Newton start has it: reference point, Euler parameters. Of a model
 * with a tuning that in the drawing, from where set-up goes on. */
void body_design(const Formulation *f, int anchor, int body, double q[7]);
/* "body" or "body + body". */
const char *subset_title(Pool *pool, const Model *model, const Subset *subset);

/* ---- emit.c: blocks as C text ------------------------------------------------------------------------------ */

/* Constants of a class in the order of their slots in k[]. */
typedef struct Constants {
    int count;
    Ex *e;
} Constants;

/* How the text looks. No style changes the order of operations: results are the same to the last bit. */
typedef struct Style {
    int leaves;           /* in one expression at most, a function's name counted as one: also bounds its nesting */
    bool doubles;         /* numbers are plain: 0.5; else of either type: R(0.5) */
    bool whole_self_test; /* else it measures constraints alone */
    bool lanes; /* numbers are vectors with one vehicle a lane: a check that fails concerns its lanes, and goes on */
    int width;  /* with `lanes`: they are vectors of so many, with one subset a lane; 0: with one vehicle a lane */
    const int *known_stride; /* [knowns] with a width: numbers from one number of a known to the next, each a row of it;
                              * negative: one body is the known of all lanes */
    bool lane_constants;     /* with `lanes`: constants of members are vectors too, not only numbers of all lanes */
    const char *prefix;      /* of the names of functions and tables that the file defines; NULL: none */
} Style;

extern const Style style_readable, style_direct, style_lanes;

/* The type of a number. */
const char *style_real(const Style *style);

/* The statements of a block, each line led by `indent` spaces: temporaries in depth-first order from the results, or as
 * schedule.c orders them, checks as soon as their values are there, stores at the end (a target may be read before).
 * Constants met on the way get slots. */
void block_emit(Text *out, const Block *block, const Style *style, Constants *constants, int indent);
/* What its checks are about, as far as they are, in order: {status, subset, number of the state}, */
void emit_abouts(Text *out, const Block *block, int indent);

/* schedule.c: a statement that computes a node, or a check of one. */
typedef struct Step {
    Ex value;
    int check; /* of the block; -1: a statement */
} Step;

/* Put steps [steps], which come with operands before what needs them, into the order in which a processor is the least
 * time without work. Checks keep theirs, and what may not be computed before a check, roots and quotients, comes after
 * the checks that it came after. */
void schedule_steps(Pool *pool, const Dag *dag, Step *step, int steps);

/* A number as C source that reads back bit-exactly: R(0.5). */
const char *emit_number(Pool *pool, double value);

/* ---- template.c: fixed text with insertion points ---------------------------------------------------------- */

/* Files built into the program: templates and the freestanding runtime. Ends with name NULL. */
typedef struct Embedded {
    const char *name, *bytes;
    size_t size;
} Embedded;

extern const Embedded embedded[];

/* Where a template's line is nothing but `@name@` in a comment (of C or of HTML), `insert` prints what belongs there,
 * with that line's indent. */
typedef void Insert(void *context, const char *name, Text *out, int indent);

/* Expand the template `name` (from the folder `templates`, or built in where that is NULL): every word PREFIX becomes
 * `prefix`, UPPER the same in capitals, CLASS becomes `class`. */
void template_expand(Pool *pool, Text *out, const char *templates, const char *name, const char *prefix,
                     const char *class, Insert *insert, void *context);

/* ---- figures.c: what the emitted code costs in operations ------------------------------------------------------ */

/* Operations of one subset's recovery, once each. */
typedef struct ClassFigures {
    bool closed; /* `solve` is all, once */
    Count predict, chord, solve;
} ClassFigures;

typedef struct Figures {
    const Sequence *sequence;
    ClassFigures *class; /* [classes] */
    int *times;          /* [classes] subsets that a right-hand side recovers */
    Count dynamics;
    Count loads;        /* of these, for applied forces alone */
    Count link, torque; /* of wheels with tires: their motion; what drives and brakes them */
    Count drive;        /* of the powertrain */
    Count *wheel;       /* [classes of wheels] one wheel on the road; so many are computed: */
    int *wheel_times;
    Count fast;     /* a fast step: torque, all wheels, powertrain */
    Count outputs;  /* of what outputs are made of; where they need multipliers that the dynamics don't give: */
    Count wrenches; /* what they follow from */
    Count *react;   /* [classes] multipliers of one subset */
    int *reacting;  /* [classes] of so many members */
} Figures;

const Figures *figures_new(Pool *pool, const Formulation *f);
void count_add(Count *sum, Count more, int times);
/* All of them, each as one. */
int count_sum(Count c);
/* With so many corrections with old factors and with new ones: of one subset of a class; of all subsets, which is one
 * piece; of a right-hand side in one piece. */
Count figures_subset(const Figures *figures, int class, int chords, int passes);
Count figures_recovery(const Figures *figures, int chords, int passes);
Count figures_rhs(const Figures *figures, int chords, int passes);
/* Of all outputs, on top of a right-hand side. */
Count figures_outputs(const Figures *figures);

/* ---- generate.c: all of it --------------------------------------------------------------------------------- */

/* The generated C and its header. `header`: the name by which the C includes it, NULL: it doesn't. `templates` as
 * above. */
void generate(Pool *pool, const Formulation *f, const Style *style, const char *templates, const char *header, Text *c,
              Text *h);

/* ---- batch.c: many vehicles at once ----------------------------------------------------------------------------- */

/* So many vehicles, `lanes` of them in each vector. */
typedef struct Batch {
    int vehicles, lanes;
} Batch;

/* What the model has that can't be done in lanes, NULL: nothing. */
const char *batch_missing(const Formulation *formulation);
/* The C for many vehicles, and its header, which includes `model_header`, that of one vehicle. */
void generate_batch(Pool *pool, const Formulation *formulation, const Batch *batch, const char *templates,
                    const char *model_header, const char *header, Text *c, Text *h);

/* ---- measure.c, report.c: the page about it ---------------------------------------------------------------------- */

typedef struct Measure Measure;

/* What C text declares, and takes in memory where pointers have 64 bits and gic_real has `real` bytes; `model` is the
 * prefix of its functions. Texts are read in the order in which a compiler sees them. */
Measure *measure_new(Pool *pool, const char *model, size_t real);
void measure_read(Measure *measure, const char *text);
/* Bytes: of a type (exact); of the constant objects whose names start so (exact); of the stack below a call of a
 * function (a bound, what the C library and the user's own functions take not counted). 0: there is none such. */
size_t measure_type(const Measure *measure, const char *name);
size_t measure_constants(const Measure *measure, const char *start);
size_t measure_stack(const Measure *measure, const char *function);
/* The value of an enumerator or of a macro that is a number; 0: there is none such. */
int measure_number(const Measure *measure, const char *name);

/* One HTML page: what the model is, its sequence, and what the code (c and h, as generate made them) costs. `path`:
 * where it goes, for messages. */
void report_print(Text *out, const char *path, const char *templates, const Formulation *f, const Text *c,
                  const Text *h);

/* ---- example.c: a program to start from -------------------------------------------------------------------- */

/* A C program of less than 60 lines that includes `header` and runs the model for two seconds. */
void example_write(Pool *pool, const Model *model, const char *templates, const char *header, Text *out);

#endif
