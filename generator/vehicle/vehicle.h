/* SPDX-License-Identifier: MIT
 *
 * vehicle: the whole mechanism once all subsets are recovered: forces, wheels, powertrain, equations of motion,
 * outputs, and the formulation that holds all blocks of a model. */
#ifndef VEHICLE_VEHICLE_H
#define VEHICLE_VEHICLE_H

#include "expression/expression.h"
#include "model/tunable.h"
#include "subset/subset.h"

typedef struct Subset Subset; /* sequence/sequence.h */

extern const char *const solve_name[SOLVES]; /* as on the command line: "reduced" */
/* The form of that name; SOLVES: there is none. */
Solve solve_of(const char *name);

extern const char *const recovery_name[RECOVERIES]; /* as on the command line: "auto" */
/* The way of that name; RECOVERIES: there is none. */
Recovery recovery_of(const char *name);

/* ---- plan.c: the whole mechanism, once all subsets are recovered */

/* Unknowns of the equations of motion that are equal or opposite to each other: unknown i is sign[i] times unknown
 * of[i] of the smaller system, or 0 if of[i] is -1. */
typedef struct Reduction {
    int unknowns, *of;
    double *sign;
} Reduction;

/* Places of each subset's numbers in the work space, and of states in the state. */
typedef struct Plan {
    const Model *model;
    const Sequence *sequence;
    Solve solve;
    Formula **formula; /* [classes] */
    const double (*origin)[3];
    int lanes;                          /* largest number of lanes of a plan in lanes; 0: scalar code */
    int pack;                           /* lanes used in the equations of motion; 0: none */
    int *coordinate_track;              /* [coordinates] with `pack`: the index among parts that are alike; -1: none */
    int *class_lanes;                   /* [classes] lanes of classes that are solved side by side; 0: member by member
                                         */
    int *lane_members, **lane_member;   /* [classes] of these the members that have a lane, as places among the
                                         * class's; the others are images of some of them in the code for a scene */
    int *start_offset, *inertia_offset; /* [subsets] */
    int *motion_offset;                 /* [bodies] */
    int *stride;                        /* [subsets] distance between consecutive numbers of a subset, in all three
                                         * arrays */
    int multipliers;                    /* number of multipliers kept for outputs; 0: none */
    int *multiplier_offset;             /* [bodies] six places a body; those of a subset's bodies hold its equations'
                                         * multipliers */
    int *derived_offset;                /* [subsets] where d[] begins in derived[] */
    Derived *derived;                   /* grows while blocks are made */
    int start_size, inertia_size, motion_size;
    int free_coordinates;
    int *coordinate_state, *coordinate_rate; /* [coordinates] index in the state, -1: driven */
    int states;                              /* size of the slow state: r e w v omega w', or w w'; fast states come
                                              * after it */
    int unknowns;                            /* accelerations: alpha and a of a free base, then the free coordinates */
    int *coordinate_unknown;                 /* [coordinates] -1: driven */
    const Reduction *reduction;              /* NULL: all unknowns are independent */
} Plan;

Plan *plan_new(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Formula **formula,
               const double (*origin)[3]);

/* True if the Newton start holds poses of this subset's bodies: not for the base, nor for closed forms. */
bool plan_follows(const Plan *plan, int subset);
/* True if the solution of a subset depends only on its coordinates, their rates and the angular velocity of the base,
 * so that it may be reused for the same numbers. A solution by Newton's iteration also depends on its start, by
 * rounding. */
bool plan_keeps(const Plan *plan, int subset);
/* A number that identifies the form of the equations and the places of numbers: code for many vehicles reads an
 * instance and must be made for the same ones. */
int plan_layout(Pool *pool, const Plan *plan);

/* Inputs of every block of the whole vehicle, as C names: y state, e recovered Euler parameters of the base, x and xd
 * values and rates of all coordinates, u inputs, m motions, n inertias, lambda multipliers (Plan.multiplier_offset).
 * Fixed base: r, e and R are numbers, v and turn 0. */
typedef struct Whole {
    const Plan *plan;
    const Model *model;
    Dag *dag;
    Motion *motion;            /* [bodies] relative to the base */
    Ex r[3], e[4], R[9], v[3]; /* base: position, Euler parameters, rotation to the world, world velocity */
    Ex turn[3];                /* angular velocity of the base, base frame */
    Ex gravity[3];             /* base frame */
    Ex *x, *xd;                /* [coordinates] */
    Ex *z;                     /* [states] the model's own */
    const Ex *linked;          /* [signals] where bodies are not known: components of outputs from link[], 0:
                                * not there; NULL: bodies are known */
    struct Loads *loads;       /* while forces are made and after; NULL: not yet */
    const struct Accelerated *accelerated; /* of outputs; NULL: formulas read nothing that follows accelerations */
    bool open;                             /* constant numbers stay inputs, for block_pack to compare */
    bool sized;                            /* loads also sum the magnitudes of their terms */
    bool parted;                           /* loads are told by their parts */
    const Ex *carried_by;  /* carrier.c: the accelerations of coordinates for which the two below were computed; NULL:
                            * not yet */
    Ex (*carried)[6];      /* [bodies] resulting accelerations: angular, of the reference point */
    Ex (*carried_size)[2]; /* [bodies] sums of magnitudes of the terms */
} Whole;

Whole *whole_new(Pool *pool, const Plan *plan);
Whole *whole_open(Pool *pool, const Plan *plan, bool open);
/* A number of the model. */
Ex whole_number(Whole *whole, const double *at);
/* A point of a body (or of ground) relative to the base, in the base frame; s in the body frame: numbers of the model.
 */
Vector whole_point(Whole *whole, int body, const double s[3]);
/* Fixtures of a joint or coordinate in this graph; origin: reference points. */
Fixture whole_joint_fixture(Whole *whole, const Joint *joint, const double (*origin)[3]);
Fixture whole_coordinate_fixture(Whole *whole, const Coordinate *coordinate, const double (*origin)[3]);
/* What a joint with a formula measures, by the coordinates. */
Coupling whole_coupling(Whole *whole, const Joint *joint);
/* World position and velocity of a point given relative to the base. */
void whole_position(Whole *whole, const Vector *point, Ex out[3]);
void whole_velocity(Whole *whole, const Vector *point, Ex out[3]);
/* Velocity in the base frame of a point moving with the base and relative to it. */
void whole_velocity_in_base(Whole *whole, const Vector *point, Ex out[3]);
/* A symmetric matrix from the axes of a body into base axes (xx yy zz xy xz yz). */
void whole_rotate_inertia(Whole *whole, int body, const Ex own[6], Ex out[6]);
/* A body's inertia matrix in base axes. */
void whole_inertia(Whole *whole, int body, Ex J[6]);
/* A fast state of a wheel (`array` is ARRAY_y) or its rate (ARRAY_rate). */
Ex whole_fast(Whole *whole, Array array, int wheel, int state);
/* A number of grip[], the results of a wheel with a tire. */
Ex whole_grip(Whole *whole, int wheel, int number);
/* A number of watch[], the results of the powertrain. */
Ex whole_watch(Whole *whole, int number);
/* The subset of a body; its motion relative to its carrier depends on the subset's deps. */
const Subset *whole_subset(const Whole *whole, int body);

/* ---- carrier.c: chained sequences */

/* The body that carries this one; BODY_BASE: the base does. */
int whole_carrier(const Whole *whole, int body);
/* Add the contribution of the accelerations w2 [coordinates] of coordinates that move the body's carrier: to the
 * angular acceleration of a body, and to the acceleration of a point of it at `at` relative to the base. None if the
 * base carries the body. */
void whole_carry(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex angular[3], Ex linear[3]);
/* The same for sums of magnitudes of their terms. */
void whole_carry_size(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex *angular, Ex *linear);
/* Add the wrenches [bodies] (moment about the reference point, force) of carried bodies to those of their carriers;
 * along [coordinates]: add their components along the coordinates that move the carriers. */
void whole_hand_on(Whole *whole, const Ex (*wrench)[6], Ex *along);
/* The same for sums of magnitudes of moments and of forces. */
void whole_hand_size_on(Whole *whole, const Ex (*size)[2], Ex *along);
Ex whole_magnitude3(Whole *whole, const Ex v[3]); /* |x| + |y| + |z| */

/* ---- forces.c: applied forces */

/* Applied forces on each body, and the generalised forces: moment about the base origin and force on the whole vehicle,
 * base frame; force along every coordinate. */
/* A number that an element exerts along or about a line: a force, N, or a torque, N m. */
typedef struct LoadPart {
    Ex value;
    bool internal; /* bodies push each other with it: nothing is left of it for the whole vehicle */
} LoadPart;

typedef struct Loads {
    int parts;
    LoadPart *part;  /* [parts] with Whole.parted: cut[i] stands for the value of a part in all sums below */
    bool *made;      /* [forces] the element is among the sums */
    bool *pressed;   /* [wheels] the wheel is */
    Ex (*wrench)[6]; /* [bodies] moment about the reference point, force; base frame */
    Ex *own;         /* [coordinates] of elements along a coordinate, which are not among the wrenches */
    Ex moment[3], force[3];
    Ex *along;      /* [coordinates] of all elements */
    Ex *element;    /* [forces] Q or T of FORMAT.md section 7 */
    Ex (*wheel)[4]; /* [wheels] fz, deflection, deflection rate, road height */
    Ex *press;      /* [contacts] of all wheels, then of ends of stops: GRIP_PRESS */
    int presses;
    Ex potential, potential_rate, power; /* of springs; of dampers and tires, W */
    Ex terms;      /* sum of the magnitudes of the terms of the latest element; only if sizes are asked for */
    Ex (*size)[2]; /* [bodies] sums of magnitudes of moments about the reference point, and of forces */
    Ex *own_size;  /* [coordinates] likewise along a coordinate */
} Loads;

Loads *loads_make(Whole *whole);
/* A formula as an expression; local: the values of its local names. The force elements that it reads are among the
 * loads already. */
Ex whole_law(Whole *whole, const Law *law, const Ex *local);
/* The height of the post under a wheel, order 0, or its rate, 1; 0 where there is none. */
Ex whole_post(const Whole *whole, const Wheel *wheel, int order);

/* ---- wheel.c, tire_*.c, powertrain.c: wheels with tires, models/TIRES.md, POWERTRAIN.md */

/* link[]: the motion of each wheel by the multibody system, world components; after those of all wheels the coordinates
 * and rates that formulas of wheels read. */
enum { LINK_C = 0, LINK_V = 3, LINK_S = 6, LINK_OMEGA = 9, LINK_NUMBERS = 12 };

/* grip[]: results of a wheel. */
enum {
    GRIP_FORCE = 0,  /* on the carrier at the wheel's centre, world */
    GRIP_TORQUE = 3, /* on the carrier, world */
    GRIP_DRIVE = 6,  /* torques of drive and brake, N m */
    GRIP_BRAKE,
    GRIP_LOAD, /* Fz, rho, rho', h */
    GRIP_DEFLECTION,
    GRIP_DEFLECTION_RATE,
    GRIP_HEIGHT,
    GRIP_TIRE,                  /* Fx, Fy, Mx, My, Mz */
    GRIP_KAPPA = GRIP_TIRE + 5, /* slips and camber that the tire formulas use */
    GRIP_TANGENT,
    GRIP_CAMBER,
    GRIP_POINT,                    /* P */
    GRIP_SPEED_X = GRIP_POINT + 3, /* V_x, V_y */
    GRIP_SPEED_Y,
    GRIP_RADIUS, /* R_e */
    GRIP_POWER,  /* power of all that changes the energy of spin, W */
    GRIP_PRESS,  /* positive where there is a load, else negative or 0; continuous */
    GRIP_NUMBERS
};

/* Wheels with the same tire and the same formulas. Inputs, as C names: link and fast (of the wheel), torque (drive,
 * brake), time, and between the blocks contact and force (wheel.h); k constants of the member. */
typedef struct WheelClass {
    const char *name; /* of the first member */
    int members, *member;
    Block contact;      /* contact[]; rate[] of the slips; grip[] */
    Block tire;         /* force[] of a wheel with load; without load force[] is 0 */
    Block balance;      /* rate[] of spin and brake; grip[] */
    Block by_table;     /* `tire` with curves; without stores: it has none */
    bool short_curves;  /* these are short polynomials, for code in lanes */
    double table_error; /* of it, relative to load and radius, as measured */
    double table_bound; /* what the largest errors of all its curves add up to, to first order */
} WheelClass;

typedef struct Wheels {
    int count; /* wheels with tires */
    int classes;
    WheelClass *class;
    const struct Curves *curves; /* of blocks by table; NULL: there are none */
    int links;                   /* numbers of link[] */
    Block link;                  /* link[] from a Whole */
    Block torque; /* torque[2 i]: drive and brake of the i-th wheel with a tire; rate[] of the model's own states; from
                   * link, fast, u, p, time */
    Block drive;  /* of a powertrain, after the wheels: corrections of rate[] and grip[] of all wheels, and watch[];
                   * from these, link, fast, gear, u, p, time (model/powertrain_numbers.h) */
    Block spins;  /* for proofs: the equations of the driven wheels' spins without solving them: left[], their residual
                   * at the rates acc[]; both by index among the fast states */
    Block shift;  /* choice[] after a step, from fast, gear, x, xd, u, p, time */
} Wheels;

const Wheels *wheels_formulate(Pool *pool, const Plan *plan);
/* wheel_classes.c: merge classes whose formulas differ in numbers only. */
const Wheels *wheels_merge(Pool *pool, const Wheels *wheels);

/* ---- dynamics_reduced.c, outputs.c: the blocks that end the pipeline */

/* rate[] of the whole state, reduced form; checks the pivots of the mass matrix. */
Block *dynamics_block(Whole *whole);
/* dynamics_articulated.c: the same for a chained sequence; coordinates of carried subsets are eliminated from the tips.
 */
Block *articulated_block(Whole *whole);
/* Why the articulated form can't be used for a model: "would lose digits: ..."; NULL: it can. articulated_most_mass:
 * largest ratio of masses, tuned ones included. */
extern const double articulated_most_mass;
const char *articulated_missing(const Model *model);
/* Accelerations of the driven coordinates, which are inputs; 0 for the others [coordinates]. */
Ex *whole_driven_accelerations(Whole *whole);
/* rate[] from the accelerations z [unknowns]. */
void whole_store_rates(Whole *whole, Block *block, const Ex *z);
/* dynamics_augmented.c: the same in the augmented form, with lambda[] for the outputs that need it. Refuses models in
 * which a body has more than augmented_most_mass times the mass of another. */
extern const double augmented_most_mass;
Block *augmented_block(Whole *whole);
/* Accelerations at rate[], as whole_accelerations() has them. */
typedef struct Accelerated {
    Ex alpha[3], a[3], *w2;
} Accelerated;

/* out[] of all outputs from a Whole and rate[]. */
Block *outputs_block(Whole *whole);
/* press[] of all contacts, at most GIC_CONTACTS; NULL: there are none. */
Block *contacts_block(Whole *whole);
/* outputs.c: the value of a signal, without the sign that a formula has for it. */
Ex whole_signal(Whole *whole, int signal);
/* pose[7 i]: world poses of all body frames. */
Block *poses_block(Whole *whole);
/* reactions.c: lambda[] of the subsets whose multipliers outputs need: the wrenches that the joints must exert on their
 * bodies, moment about the reference point and force, base frame, at rate[]. */
Block *wrenches_block(Whole *whole);
/* reactions.c: force and torque of a joint on its second body, at its point of that body, base frame, from lambda[]. */
void whole_reaction(Whole *whole, int joint, Ex force[3], Ex torque[3]);
/* reactions.c: force along a driven coordinate, from lambda[] of the augmented form. */
Ex whole_drive_reaction(Whole *whole, int coordinate);
/* tau[]: residual of the equations of motion for accelerations acc[] (in the order of the unknowns), computed body by
 * body. */
Block *inverse_block(Whole *whole);
/* tau[]: the same residual at rate[]; size[]: the sum of the magnitudes of its terms. */
Block *check_block(Whole *whole);
/* energy[3]: both sides of the energy balance at rate[] and the sum of magnitudes; acc[]: the unknowns at rate[]. */
Block *energy_block(Whole *whole);
/* Accelerations at rate[]: alpha, a (base frame, less gravity), w2 of all coordinates [coordinates]. */
void whole_accelerations(Whole *whole, Ex alpha[3], Ex a[3], Ex **w2);
/* Force along a driven coordinate, at rate[]. */
Ex whole_drive_force(Whole *whole, int coordinate);
/* Power of all that changes the sum of kinetic and potential energy, at rate[]: loads and drives of driven coordinates.
 */
Ex whole_power(Whole *whole, const Loads *loads);
/* The wrench that gives a body its accelerations: moment about its reference point, force; base frame. */
void whole_inertial_wrench(Whole *whole, int body, const Ex alpha[3], const Ex a[3], const Ex *w2, Ex wrench[6]);
/* Absolute acceleration of a point less gravity, base frame; alpha, a: of the base (a less gravity), w2: of all
 * coordinates. */
void whole_acceleration(Whole *whole, int body, const Vector *point, const Ex alpha[3], const Ex a[3], const Ex *w2,
                        Ex out[3]);
void whole_angular_acceleration(Whole *whole, int body, const Ex alpha[3], const Ex *w2, Ex out[3]);

/* ---- set_up.c: what follows geometric parameters, at set-up; models with a tuning only */

/* Steps from the drawing to given lengths at set-up; subset/assemble.c takes the same number. */
enum { ASSEMBLY_PIECES = 64 };

/* derived[] from p[] and `rest`, with checks of the conditions on parameters. Make it after all blocks that read
 * derived[]. */
const Block *derive_block(Pool *pool, const Plan *plan);
/* Numbers of state[], input[] and start[0] that follow parameters, at the drawing. */
const Block *draw_block(Pool *pool, const Plan *plan);
/* Checks at set-up, of self->motion[] at the drawing: closed forms, whose branches are those of the file's design, must
 * reproduce the drawn poses. */
const Block *design_block(Pool *pool, const Plan *plan);
/* The first piece of the way from the drawing (piece 0) to given lengths at set-up: 0 if design_block() has something
 * to check and the drawing's lengths differ from the given ones, else 1. */
int design_first_piece(Pool *pool, const Plan *plan);

/* ---- formulation.c: all of the above for one model */

/* Assumptions of code for one scene, specialize/specialize.h. */
typedef struct Narrowing Narrowing;

typedef struct Formulation {
    const Model *model;
    const Sequence *sequence; /* members of its classes share pivots */
    const Sampling *sampling;
    const Plan *plan;
    const char *hash; /* of the dumped model, hexadecimal */
    const Block *dynamics, *outputs, *poses, *inverse, *energy, *check;
    const Block *contacts;             /* press[] of all wheels, then of both ends of stops; NULL: there are none */
    const Block *wrenches;             /* of the reduced form; NULL: no output needs them */
    const Wheels *wheels;              /* NULL: no wheel has a tire */
    int known_most, dependence_most;   /* largest numbers of knowns and of deps of a subset */
    const Narrowing *narrowing;        /* code for one scene; NULL: for any scene */
    const struct Formulation *general; /* code for one scene: the formulation for any scene; NULL: this is it */
    const struct Formulation *single;  /* code in lanes: the formulation without them; NULL: this has none */
} Formulation;

/* The formulas of an assembled model. The articulated form uses a chained sequence. Models that can't be formulated end
 * in diag_fail. */
const Formulation *formulate(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Recovery recovery);

/* True for a long chain, and if the articulated form is asked for: then operations are not counted, and code for one
 * scene is that for any. */
bool formulation_chains(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);
/* The number of numbers of its subsets' motions and inertias (FORMAT.md section 14), which work and memory depend on.
 */
double formulation_numbers(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);

/* Make the blocks of a formulation from its plan. */
void formulation_blocks(Pool *pool, Formulation *f);

/* tire_tables.c: the formulation whose slip forces of Magic Formulas are found by tables, with TIRE_TABLE_BOUND as the
 * largest error of forces relative to the load, and of moments to load times radius; measured at TIRE_TABLE_PLACES,
 * and a message where half of the bound is exceeded, or the bound by what errors of curves add up to, or no tire has
 * such formulas. Wheels that are computed in lanes, all of them with `batch`, get short polynomials in place of tables.
 * Derivatives are those of the formulas. */
#define TIRE_TABLE_BOUND 1e-6
enum { TIRE_TABLE_PLACES = 40000, TIRE_TABLE_BOUND_PLACES = 1000 };
const Formulation *formulation_tire_tables(Pool *pool, const Formulation *formulation, bool batch);
/* lanes.c: the number of lanes that a word names: 2, 4, 8 or 16; 0: any other word. */
int lanes_of(const char *word);
/* The formulation for code that solves members of a class side by side in vectors of up to `most` lanes, a power of 2:
 * the same number of all members is one row, one lane a column. */
const Formulation *formulation_lanes(Pool *pool, const Formulation *formulation, int most);
/* A block of the whole vehicle of rows->single, with m[] and n[] where the code in lanes `rows` has them. */
const Block *block_in_rows(Pool *pool, const Formulation *rows, const Block *block);
/* The number of rows of members of a class; without lanes, the number of members. */
int class_rows(const Plan *plan, int class);

/* True if reactions must be computed after the accelerations; the augmented form yields them directly. */
bool formulation_reacts(const Formulation *f);

/* One number of the state; fast states are last: FORMAT.md section 10. */
typedef struct StateNumber {
    const char *name, *unit;
    double initial;
} StateNumber;

StateNumber state_number(Pool *pool, const Formulation *f, int index);
/* The largest change of a coordinate that is followed in one piece: no body turns by more than about a tenth of a
 * radian. */
double coordinate_piece(const Formulation *f, int coordinate);
/* True for an angle whose pieces are less than half a turn, in a model without joints that count turns: adding 2 pi
 * changes no pose. */
bool coordinate_unwinds(const Formulation *f, int coordinate);
/* Design pose of a body relative to the base, as in a Newton start: reference point, Euler parameters; for a model with
 * a tuning the drawn pose, where set-up begins. */
void body_design(const Formulation *f, int anchor, int body, double q[7]);
/* "body" or "body + body". */
const char *subset_title(Pool *pool, const Model *model, const Subset *subset);

/* ---- operation_counts.c: what the emitted code costs in operations */

/* Operations of one subset's recovery, each block once. */
typedef struct ClassFigures {
    bool closed; /* closed form: `solve` runs once, the others never */
    Count predict, chord, solve;
} ClassFigures;

typedef struct Figures {
    const Sequence *sequence;
    ClassFigures *class; /* [classes] */
    int *times;          /* [classes] number of subsets that a right-hand side recovers */
    Count dynamics;
    Count loads;        /* part of `dynamics` for applied forces */
    Count link, torque; /* of wheels with tires: their motion; drive and brake torques */
    Count drive;        /* of the powertrain */
    Count *wheel;       /* [classes of wheels] one wheel on the road; number of wheels computed: */
    int *wheel_times;
    Count fast;     /* a fast step: torque, all wheels, powertrain */
    Count outputs;  /* of outputs; if they need multipliers that the dynamics do not give: */
    Count wrenches; /* right-hand sides of these multipliers */
    Count *react;   /* [classes] multipliers of one subset */
    int *reacting;  /* [classes] number of members */
    Count contacts; /* of how near contacts are */
} Figures;

const Figures *figures_new(Pool *pool, const Formulation *f);
void count_add(Count *sum, Count more, int times);
/* Sum of all operations, each counted as one. */
int count_sum(Count c);
/* Operations with `chords` corrections with old factors and `passes` with new ones: of one subset of a class; of all
 * subsets, each followed in one piece; of a right-hand side. */
Count figures_subset(const Figures *figures, int class, int chords, int passes);
Count figures_recovery(const Figures *figures, int chords, int passes);
Count figures_rhs(const Figures *figures, int chords, int passes);
/* Operations of all outputs, in addition to a right-hand side. */
Count figures_outputs(const Figures *figures);
/* Of a look at contacts, where the model has any: recovery included. */
Count figures_look(const Figures *figures);

/* A road that is a plane of constant friction. */
typedef struct Plane {
    double height, slope[2], friction; /* height at x = y = 0 */
} Plane;

/* Facts about a run in one scene. Generated code checks at run time those that inputs, parameters, ports, road or state
 * could violate, and ends a call with GIC_ERROR_ASSUMPTION. */
typedef struct Facts {
    const char *scene;     /* name of the scene */
    double massless, lost; /* bodies below this mass, kg, lose it, see model_lost(); 0: none */
    const char *massless_names;
    const bool *wanted;      /* [outputs] NULL: all */
    const bool *fixed;       /* [inputs] those that keep the value input[] */
    const double *input;     /* [inputs] */
    const double *parameter; /* [tunables] their values; NULL: they may change */
    bool idle;               /* ports are not used */
    bool neutral;            /* the transmission stays in neutral */
    const Plane *plane;      /* the road is this plane; NULL: it is not known to be one */
    bool across;             /* height and friction of the road do not depend on y */
    const char *asymmetry;   /* why the vehicle does not stay symmetric; NULL: motion of the base and road are symmetric
                              */
    const double *value, *rate, *state; /* [coordinates], [fast states] at the start; state NAN: as rolling wheels have
                                         * it */
} Facts;

/* The numbers that the condition of an assumption reads: those of the caller, the slow state `y`, the fast state
 * `fast`, the road where it is evaluated. */
typedef enum AssumptionAbout { ABOUT_CALLER, ABOUT_STATE, ABOUT_FAST, ABOUT_ROAD } AssumptionAbout;

/* An assumption that generated code checks: text for people, and a C condition that is true if it is broken. */
typedef struct Assumption {
    AssumptionAbout about;
    const char *text, *broken;
} Assumption;

/* One step of specialization: its name, why it was done or refused, and the operations that remain after it and all
 * earlier ones. */
typedef struct AccountRow {
    const char *what, *why;
    Count rhs, outputs;
} AccountRow;

typedef struct Account {
    int rows;
    AccountRow *row;
} Account;

struct Narrowing {
    const Facts *facts;
    int assumptions;
    Assumption *assumption;
    const int *image;            /* [subsets] the subset of which it is the mirror image, -1: none; NULL: both sides are
                                  * computed */
    const int *wheel;            /* [wheels] likewise */
    const char *asymmetry;       /* why both sides are computed; NULL: they are not */
    bool *steady;                /* [subsets] it never changes: recovered at set-up */
    bool road, friction, tables; /* true if they are still evaluated */
    const Account *account;      /* NULL: not asked for */
};

/* True if a subset is recovered at set-up only; if a subset or a wheel is the mirror image of another one. narrowing
 * may be NULL. */
bool narrowing_steady(const Narrowing *narrowing, int subset);
bool narrowing_image(const Narrowing *narrowing, int subset);
bool narrowing_wheel_image(const Narrowing *narrowing, int wheel);
/* The number of lanes in which the wheels of a class are computed; 1: one after another. */
int wheel_class_lanes(const Formulation *formulation, const WheelClass *class);

#endif
