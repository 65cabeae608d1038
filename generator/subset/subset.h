/* SPDX-License-Identifier: MIT
 *
 * subset: the recovery of one class of subsets: motions, constraints, sample configurations, blocks. */
#ifndef SUBSET_SUBSET_H
#define SUBSET_SUBSET_H

#include "expression/expression.h"
#include "model/model.h"
#include "subset/method.h"

typedef struct Sequence Sequence; /* sequence/sequence.h */
typedef struct Subset Subset;

/* ---- kinematics.c: how bodies move relative to the base */

/* A body-fixed vector whose components in the base frame need no A: v = A s. */
typedef struct Image {
    Ex s[3], v[3];
    bool side; /* v is not A s but another direction across the same axis, which serves wherever only the plane of
                * directions counts */
} Image;

/* Motion of a body relative to the base, components in the base frame. c: position of the reference point, a body-fixed
 * point that makes the equations of its subset sparse; velocity and acceleration are those of this point. alpha and
 * acceleration are for w'' = 0. S: [deps][6] angular and linear velocity at unit rate of each coordinate. */
typedef struct Motion {
    Ex c[3], A[9], omega[3], velocity[3], alpha[3], acceleration[3];
    Ex *S;
    int deps;
    int images;
    Image *image;
} Motion;

/* Place of a Motion in memory, as generated code keeps it: numbers per body before S, and offsets. */
enum {
    MOTION_C = 0,
    MOTION_A = 3,
    MOTION_OMEGA = 12,
    MOTION_VELOCITY = 15,
    MOTION_ALPHA = 18,
    MOTION_ACCELERATION = 21,
    MOTION_S = 24
};

/* The motion of the base: at rest at the origin. */
void motion_base(Dag *dag, Motion *motion);
/* A motion read from memory at the C expression `array` ("m0"), numbers `stride` apart, from `offset` on. */
void motion_input(Dag *dag, Motion *motion, Array array, int which, int offset, int stride, int deps);
/* The number of a motion by its place in memory. */
Ex *motion_number(Motion *motion, int place);
/* What the number at a place before S is called: A_XY. */
const char *motion_number_name(int place);
/* The same for a body at rest: position and rotation only. */
void motion_input_pose(Dag *dag, Motion *motion, Array array, int offset);

/* The motion of a body from that relative to another one, the anchor, whose S has the same coordinates. */
void motion_compose(Dag *dag, const Motion *anchor, const Motion *relative, Motion *out);

/* Set the known image v = A s of a body-fixed vector. */
void motion_image(Dag *dag, Motion *motion, const Ex s[3], const Ex v[3]);
/* For a direction s across an axis that never turns: use v, another direction across it, in place of A s. There s may
 * not be a point. */
void motion_side(Dag *dag, Motion *motion, const Ex s[3], const Ex v[3]);

/* A body-fixed vector: a point's position (`point`, arm from the reference point) or an axis (arm is the vector
 * itself). */
typedef struct Vector {
    Ex v[3], arm[3], rate[3], bias[3];
    bool point;
} Vector;

/* s: in the body frame, from the reference point (point) or as it is (axis). */
Vector vector_point(Dag *dag, const Motion *motion, const Ex s[3]);
Vector vector_axis(Dag *dag, const Motion *motion, const Ex u[3]);

/* ---- constraints.c: constraint equations */

/* One scalar equation Phi = 0 or Psi = 0 between the two ends of a joint or coordinate. Its derivative is
 * J[0] . twist_0 + J[1] . twist_1 + dual w' = 0, its second derivative the same with accelerations plus `bias` = 0. */
typedef struct Row {
    Ex value, J[2][6], dual, bias;
    Ex guard; /* positive on the right branch; 0: the equation has one branch only */
} Row;

/* Numbers of a joint or dual coordinate as expressions; frames as in Joint and Coordinate, points from reference
 * points. */
typedef struct Fixture {
    Ex point[2][3], axis[2][3];
    Ex side[2][2][3];  /* the two directions perpendicular to the axis at design, each in both bodies */
    Ex square, offset; /* length at design squared; offset */
} Fixture;

enum { ROWS_MAX = 6, FIXTURE_NUMBERS = sizeof(Fixture) / sizeof(Ex) };

/* The same as numbers, in the order of Fixture's members; origin: reference points [bodies][3], body frames. */
void fixture_of_joint(const Joint *joint, const double (*origin)[3], double number[FIXTURE_NUMBERS]);
void fixture_of_coordinate(const Coordinate *coordinate, const double (*origin)[3], double number[FIXTURE_NUMBERS]);
/* What the i-th of them is called: point_a_x of the first body. */
const char *fixture_name(int i);
/* The same as formulas of the model's tuning; 0 for a number that follows no parameter. */
void fixture_tuned_joint(const Model *model, const Joint *joint, const double (*origin)[3],
                         Ex formula[FIXTURE_NUMBERS]);
void fixture_tuned_coordinate(const Model *model, const Coordinate *coordinate, const double (*origin)[3],
                              Ex formula[FIXTURE_NUMBERS]);
/* Rows of a joint. If it keeps axes parallel, the axis of the other end is perpendicular to two directions of end
 * `across`. Take the end that is known before: directions of a spinning wheel turn away from the design, where pivots
 * were chosen. */
int joint_rows(Dag *dag, JointType type, const Fixture *fixture, const Motion *const end[2], int across,
               Row row[ROWS_MAX]);
/* x, rate: value and rate of the coordinate. Of a joint with a formula (joint_measure()) the same row, x and rate being
 * those of the formula. */
Row coordinate_row(Dag *dag, CoordinateType type, const Fixture *fixture, const Motion *const end[2], Ex x, Ex rate);

/* ---- coupling.c: formulas of gears and couplers */

/* A formula f of coordinates x. */
typedef struct Coupling {
    Ex x, rate; /* f, its rate */
    Ex second;  /* what remains of its second derivative where those of all coordinates are 0 */
    Ex *slope;  /* [coordinates of the model] derivatives by them */
} Coupling;

/* A number that follows tunable parameters. */
typedef Ex CouplingNumber(void *context, Ex formula, double value);

/* x, rate: [coordinates of the model], those that the formula reads. */
Coupling coupling_make(Dag *dag, const Model *model, const Law *law, const Ex *x, const Ex *rate,
                       CouplingNumber *number, void *context);

/* ---- sampling.c: admissible configurations to choose pivots at */

/* Configurations reached by continuation along straight lines of the coordinates, in `steps` steps from the design.
 * Configuration 0 is the design. Poses are those of reference points, relative to the base. */
typedef struct Sampling {
    int configurations, steps, bodies, coordinates;
    double *target; /* [configurations][coordinates] */
    double *pose;   /* [steps + 1][configurations][bodies][12]: c, A */
    bool *usable;   /* [bodies][configurations]: the body could be followed all the way */
    double **S;     /* [bodies] -> [configurations][deps of its subset][6], at the ends of the paths */
    double *swing;  /* [coordinates] largest rotation of a body, or move relative to the subset's size, for a unit
                     * change */
} Sampling;

Sampling *sampling_new(Pool *pool, const Model *model, const Sequence *sequence, const double (*origin)[3]);
double sampling_coordinate(const Sampling *sampling, const Model *model, int step, int configuration, int coordinate);
/* Design pose of a body's reference point relative to another body's, or to the base: place and Euler parameters.
 * origin: reference points [bodies][3], body frames. */
void sampling_design(const Sampling *sampling, const Model *model, const double (*origin)[3], int anchor, int body,
                     double q[7]);
double *sampling_pose(const Sampling *sampling, int step, int configuration, int body);

/* ---- recovery.c, sample_paths.c, inertia.c: recovery of one class of decoupled subsets */

/* Places of a subset's numbers. start: the state of its iteration (pose 7 a body, S, factors); motion: one Motion a
 * body; inertia: its contribution to the equations of motion, see INERTIA_*. */
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

/* Newton's iteration at its end: equations of which `value` vanish, the factors of their derivative by the twists of
 * the bodies, and the poses q that it found. */
typedef struct Implicit {
    int n;                  /* 6 a body */
    const Ex *value;        /* [n] */
    const Ex *whole;        /* [n] all equations of joints and coordinates, also those that hold by how `found` and the
                             * motions are made */
    const Factors *factors; /* at the inputs q */
    const Ex *found;        /* [7 bodies] */
} Implicit;

/* One body in its subset's inertia: centre of mass from the reference point and relative to the base, J in base axes,
 * force and moment about the centre of mass of the quadratic-velocity terms. */
typedef struct BodyInertia {
    Ex mass, arm[3], at[3], J[6], force[3], moment[3];
} BodyInertia;

/* Motions of subsets of one coordinate by polynomials of it within its range: what replaces Newton's iteration there.
 */
typedef struct Polynomial {
    Block within;  /* four numbers in inside[]: none is negative where coordinate and rate leave the subset within the
                    * range for the time `ahead` */
    Block solve;   /* motion and inertia */
    Block edge;    /* q at the coordinate, or at the end of its range that it is beyond */
    int degree;    /* the largest one */
    int flag;      /* place in a start: 1 if polynomials made it, so that it has neither pose nor factors */
    double bound;  /* of errors of places relative to the subset's size, of Euler parameters, and of unit velocities and
                    * accelerations relative to the largest ones of their kind */
    double worst;  /* the largest one found, in double precision */
    int points;    /* at so many points of each range */
    double most;   /* what none exceeds, in double precision and anywhere in the ranges: proved */
    int intervals; /* of all ranges together, for the proof */
    const Motion *motion;     /* [bodies] */
    const double *low, *high; /* [members] */
} Polynomial;

/* The formulas of a class. C names: k constants of the member; d constants that tunable parameters change; m0, m1, ...
 * motions of the knowns; x, rate, change: value, rate and change since the start of the deps; turn: angular velocity of
 * the base; ahead: time for which coordinates must stay independent at the present velocities; q: pose; s and f: S and
 * factors of the start; motion: the poses that were found. */
typedef struct Formula {
    Dag *dag;
    Layout layout;
    double size;        /* of a subset: largest distance between its points, m */
    double distance;    /* largest distance of its reference points from the base's origin at the design, relative to
                         * size */
    bool closed;        /* poses in closed form by `solve` alone: predict and chord are empty, no start is kept */
    Motion *motion;     /* [bodies] motions after `solve` */
    Ex *inertia;        /* [inertia_size] numbers of inertia after `solve` */
    BodyInertia *body;  /* [bodies] what these are sums of */
    const Ex *balanced; /* [unbalanced] what stands for a node of `solve` as it was before its sums were balanced; parts
                         * of sums have no images of their own; NULL: no node has */
    int unbalanced;
    Ex (*across)[2][3]; /* [joints] directions in the base frame that multipliers refer to instead of those fixed in the
                         * first body at the design; 0: the latter */
    Block predict;      /* q from the start and `change`; reach: squared relative size of that move */
    Block chord;        /* one correction of q with the start's factors; step: its squared relative size */
    Block solve;        /* factors, S, last correction, motion and inertia */
    Block residual;     /* worst[0]: sum of the constraint residuals of the motion, relative to size; worst[1]: sum of
                         * their derivatives' residuals, relative to the magnitudes of their terms */
    Block react;        /* multipliers from the wrenches w that the bodies need, both in w; f: stored factors. The load
                         * on knowns is subtracted from their wrenches w0, w1, .... Only what outputs need */
    const Implicit *implicit;      /* NULL: closed */
    struct Polynomial *polynomial; /* NULL: none */
    const char *exact_because;     /* why there is none although polynomials are asked for; NULL: other reasons */
    bool unproved;                 /* since a bound was not proved */
    int derived;                   /* numbers d[] that follow tunable parameters */
    Ex *derived_of;                /* [derived][members] their formulas */
} Formula;

/* Formulas of all classes [classes]; fills the sampling. Members that need other pivots than the first member of their
 * class get a class of their own: *sequence is replaced. Singular subsets end in diag_fail. */
Formula **subsets_formulate(Pool *pool, const Model *model, const Sequence **sequence, const double (*origin)[3],
                            Sampling *sampling, Solve solve, Recovery recovery);
/* constant_motion.c: true if a number of the motions or inertias is the same in every configuration; its value for a
 * member. Such numbers are not stored. */
bool formula_is_constant(const Formula *f, Ex e);
double formula_value(const Formula *f, Ex e, int member);
/* Reference points of all bodies [bodies][3], body frames: on a joint that connects the body to something known. */
double (*reference_points(Pool *pool, const Model *model, const Sequence *sequence))[3];

/* [subsets] true if some `reaction` output needs the multipliers: of its joint's subset and of later subsets that load
 * it. */
const bool *reactions_needed(Pool *pool, const Model *model, const Sequence *sequence);

/* columns.c: derivatives of a class's motions by each coordinate that they depend on, then by each rate of these, then
 * of residuals by these and by the base's angular velocity. Of each number `slope` has what it is: a literal, a
 * constant, a number of the same body's motion (ARRAY_motion), or what `block` stores at `place`. */
typedef struct MotionColumns {
    int columns, numbers; /* 2 deps and 3; numbers of the motions of all bodies */
    int rows;             /* of residuals: moment and force on the whole vehicle, forces along the deps */
    Ex *slope;            /* [2 deps][numbers], then [columns][rows], in the formula's graph */
    int *place;           /* the same, in column[]; -1: it is not stored, a residual is 0 */
    int size;             /* of column[] */
    Block block;          /* from the arguments of `solve`, what that stored, accelerations acc[] (alpha and a of the
                           * base, of the deps) and columns of the knowns */
} MotionColumns;

/* [classes]; NULL: a known stands for bodies of several classes. straight: only poses by coordinates and velocities by
 * rates, as if bodies went on in the directions S in which they move; everything else counts as 0, all residuals too.
 */
MotionColumns **subsets_columns(Pool *pool, const Sequence *sequence, Formula *const *formula, bool free_base,
                                bool straight);
/* Where the derivative of a residual is in column[]; -1: it is 0. */
int motion_columns_residual(const MotionColumns *m, int column, int row);
/* The local column of a coordinate, or of its rate, in a subset; -1: its motion does not depend on it. */
int subset_column(const Subset *subset, int coordinate, bool rate);
/* True for a number of a body's motion, by its place, that follows from poses alone. */
bool motion_is_pose(int place);

/* ---- assemble.c: the design configuration that fits the given lengths */

/* The model with its bodies moved to design poses in which every joint fits (FORMAT.md section 4); the same model if
 * nothing moves. Ends in diag_fail if there is no such pose. */
const Model *model_assemble(Pool *pool, const Model *drawn, const Sequence *sequence);

/* Pose of a body in the drawing relative to another one, or to the base: reference point, as formulas, and Euler
 * parameters. origin: reference points [bodies][3], body frames. */
void body_drawn(const Model *model, const double (*origin)[3], int anchor, int body, Ex c[3], double p[4]);

#endif
