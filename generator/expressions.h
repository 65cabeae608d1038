/* SPDX-License-Identifier: MIT
 *
 * gicgen.h, its third part: the expression graph, and what the formulation makes of it. */
#ifndef EXPRESSIONS_H
#define EXPRESSIONS_H

#include "sequence.h"

/* ---- expr.c: the expression graph ------------------------------------------------------------------- */

/* A node of the graph. Equal nodes are one node, so comparing two Ex compares expressions. */
typedef uint32_t Ex;

/* X(name, arity, C text with %0 %1 %2 for the arguments, counted as) */
#define OP_LIST(X) \
    X(OP_LITERAL, 0, "", "") \
    X(OP_CONSTANT, 0, "", "") \
    X(OP_INPUT, 0, "", "") \
    X(OP_NEG, 1, "-%0", "") \
    X(OP_ADD, 2, "%0 + %1", "add") \
    X(OP_SUB, 2, "%0 - %1", "add") \
    X(OP_MUL, 2, "%0 * %1", "multiply") \
    X(OP_DIV, 2, "%0 / %1", "divide") \
    X(OP_SQRT, 1, "GIC_SQRT(%0)", "root") \
    X(OP_ABS, 1, "GIC_FABS(%0)", "") \
    X(OP_SIN, 1, "GIC_SIN(%0)", "function") \
    X(OP_COS, 1, "GIC_COS(%0)", "function") \
    X(OP_TAN, 1, "GIC_TAN(%0)", "function") \
    X(OP_ASIN, 1, "GIC_ASIN(%0)", "function") \
    X(OP_ACOS, 1, "GIC_ACOS(%0)", "function") \
    X(OP_ATAN, 1, "GIC_ATAN(%0)", "function") \
    X(OP_EXP, 1, "GIC_EXP(%0)", "function") \
    X(OP_LOG, 1, "GIC_LOG(%0)", "function") \
    X(OP_TANH, 1, "GIC_TANH(%0)", "function") \
    X(OP_POW, 2, "GIC_POW(%0, %1)", "function") \
    X(OP_ATAN2, 2, "GIC_ATAN2(%0, %1)", "function") \
    X(OP_MIN, 2, "GIC_MIN(%0, %1)", "") \
    X(OP_MAX, 2, "GIC_MAX(%0, %1)", "") \
    X(OP_POSITIVE, 3, "(%0 > GIC_R(0) ? %1 : %2)", "") \
    X(OP_TABLE, 1, "", "function") \
    X(OP_ROAD, 2, "", "function") \
    X(OP_ROAD_PART, 1, "", "") \
    X(OP_FRICTION, 2, "road_friction(self, time, %0, %1)", "function") \
    X(OP_LANE, 1, "", "") \
    X(OP_LANE_SUM, 1, "LANE_SUM(%0)", "") \
    X(OP_FOLD, 2, "FOLD(%0, %1)", "add")

typedef enum Op {
#define OP_ENUM(name, arity, text, counted) name,
    OP_LIST(OP_ENUM)
#undef OP_ENUM
        OP_COUNT
} Op;

/* When a node's value is known: always the same; the same for one member of a class; at run time only. */
typedef enum Level { LEVEL_LITERAL, LEVEL_CONSTANT, LEVEL_VARIABLE } Level;

typedef struct Node {
    uint8_t op, level;
    uint8_t wide;     /* lanes of a vector; 0: one number */
    uint8_t undefined; /* constants made a part of it that is no finite number: it is not folded, nor into anything, so
                          that it is computed at run time and ends in a status */
    Ex arg[3];        /* OP_ROAD_PART: arg[1] is 0, 1 or 2 for h, dh/dx, dh/dy; OP_TABLE: arg[1] is the table's index;
                         OP_LANE: arg[1] is the lane; OP_FOLD: arg[2] is the step */
    const char *name; /* OP_INPUT: the C expression that reads it */
} Node;

/* Every node carries `samples` numeric values: sample s is one admissible configuration of class member
 * s / (samples / members). Constants are folded, sums and products simplified as nodes are made. */
typedef struct Dag {
    Pool *pool;
    int members, samples;
    int lanes; /* of vectors, one a member: constants are such; 0: there are none */
    int nodes, room;
    Node *node;
    double *value;       /* [nodes][samples] */
    Ex *table;           /* hash table */
    const Table *tables; /* what OP_TABLE looks up in, as far as samples go; NULL: they are 0 */
    uint32_t mask;
} Dag;

Dag *dag_new(Pool *pool, int members, int samples);
int ex_arity(Op op); /* arguments of its nodes */
Ex ex_literal(Dag *dag, double value);
Ex ex_constant(Dag *dag, const double *value); /* [members] */
Ex ex_number(Dag *dag, double value);          /* a literal that is never folded: an input R(value) */
bool ex_is_number(const Dag *dag, Ex e);
Ex ex_input(Dag *dag, const char *name, const double *sample); /* [samples], or NULL: not needed */
Ex ex_op(Dag *dag, Op op, Ex a, Ex b, Ex c);                   /* unused arguments: 0 */
Ex ex_neg(Dag *dag, Ex a);
Ex ex_add(Dag *dag, Ex a, Ex b);
Ex ex_sub(Dag *dag, Ex a, Ex b);
Ex ex_mul(Dag *dag, Ex a, Ex b);
Ex ex_div(Dag *dag, Ex a, Ex b);
Ex ex_sqrt(Dag *dag, Ex a);
Ex ex_dot(Dag *dag, const Ex a[3], const Ex b[3]);
void ex_cross(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3]);
void ex_add3(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3]); /* out may alias in these three */
void ex_sub3(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3]);
void ex_scale3(Dag *dag, Ex s, const Ex a[3], Ex out[3]);
void ex_zero3(Dag *dag, Ex out[3]);
void ex_apply(Dag *dag, const Ex A[9], const Ex x[3], Ex out[3]);            /* A x; out may not alias x */
void ex_apply_transposed(Dag *dag, const Ex A[9], const Ex x[3], Ex out[3]); /* A^T x */
void ex_rotation(Dag *dag, const Ex p[4], Ex A[9]);                          /* A(p), p normalized */
Ex ex_pow(Dag *dag, Ex a, Ex b);                                             /* small whole exponents by products */
bool ex_is(const Dag *dag, Ex e, double value);                              /* the literal `value`? */
double ex_value(const Dag *dag, Ex e, int sample);
void ex_set_sample(Dag *dag, Ex input, int sample, double value);
/* Recompute samples first .. first + count - 1 of every node after inputs changed. */
void dag_evaluate(Dag *dag, int first, int count);
/* A vector read from memory by a C expression, of a graph with lanes; one lane of a vector; the sum of all. What is no
 * vector is the same in all lanes. */
Ex ex_vector(Dag *dag, const char *text);
Ex ex_lane(Dag *dag, Ex vector, int lane);
Ex ex_lane_sum(Dag *dag, Ex vector);
/* A step of adding while transposing: lane l becomes the sum of lanes l and l ^ 2^step of `a` where that bit of l is 0,
 * of `b` where it is 1. What is no vector becomes one. */
Ex ex_fold(Dag *dag, Ex a, Ex b, int step);
/* What an operation does to numbers. */
double op_value(Op op, double a, double b, double c);
/* sin and cos without libm: the same digits on every machine. */
void portable_sincos(double x, double *sine, double *cosine);

/* What a law is in a graph that reads tunable parameters as p[i]: one of numbers, parameters and tables; the top of one
 * (not an input, a coordinate, time or local) with these arguments. */
Ex law_expression(Dag *dag, const Model *model, const Law *law);
Ex law_top(Dag *dag, const Model *model, const Law *law, const Ex arg[3]);

/* Operations needed at run time for some roots, by kind. */
typedef struct Count {
    int add, multiply, divide, root, function;
} Count;

Count dag_count(const Dag *dag, const Ex *root, int roots);
/* Of these the ones on vectors. */
Count dag_count_wide(const Dag *dag, const Ex *root, int roots);
/* The same where some nodes are given. */
Count dag_count_above(const Dag *dag, const Ex *root, int roots, const Ex *given, int givens);
/* [nodes] which nodes are needed for some roots. */
const bool *dag_needed(const Dag *dag, const Ex *root, int roots);

/* balance.c: what stands for each node [nodes] that the roots need where sums are added in the order in which their
 * terms become ready; the same values but for rounding. Without lanes. */
const Ex *balance_sums(Pool *pool, Dag *dag, const Ex *root, int roots);

/* ---- tune.c: numbers that follow tunable parameters --------------------------------------------------------- */

/* Something that must be greater than 0 (`zero`: or 0), whatever the parameters are. */
typedef struct Condition {
    Ex value;
    bool zero;
    const char *text; /* "mass of body 'arm' must be greater than zero" */
} Condition;

/* A Model has its numbers at the parameters' values in the file. What set-up computes anew for others are these
 * formulas, in a graph of their own, by the address of the number in the Model. Its inputs are p[i], the tunable
 * parameters, and `rest`, the share of the way from the drawing to given lengths that is still ahead. */
typedef struct Tuning {
    Dag *dag;
    int numbers, conditions;
    int late; /* the first of the conditions that blocks of emitted code check: on masses, on the assembly mode */
    struct TunedNumber {
        const double *at;
        Ex formula;
    } * number;
    Condition *condition;
    bool assembles; /* lengths other than the drawing's: formulas depend on `rest` */
} Tuning;

/* Conditions from Tuning.late on. Their values are the literal 1: formulas of numbers alone do not tell. */
enum { LATE_MASSES, LATE_MODE, LATE_CONDITIONS };

Tuning *tuning_new(Pool *pool);
/* The formula of a number of the model, 0: it follows no parameter; and the same with a literal instead of 0. */
Ex tuned_number(const Model *model, const double *at);
Ex tuned_or_fixed(const Model *model, const double *at);
/* Differences of the numbers at a and b likewise, 0: follows no parameter. */
Ex tuned_difference(const Model *model, const double *a, const double *b);
/* Let numbers follow formulas [count], in place of those that they followed before; 0 and literals: as before. */
void tuning_set(Tuning *tuning, const double *at, const Ex *formula, int count);
/* Numbers [count] that are copies of others follow the same formulas. */
void tuning_copy(const Model *model, const double *to, const double *from, int count);
void tuning_require(Tuning *tuning, Ex value, bool zero, const char *text);
/* All is read: which parameters are geometric. Without any the model has no tuning. */
void tuning_close(Model *model);

/* The numbers that emitted code keeps in derived[], as formulas of a Tuning: geometric parameters first. */
typedef struct Derived {
    int count;
    Ex *formula;
} Derived;

/* ---- linear.c: straight-line factorizations ------------------------------------------------------------ */

/* P A Q = L U of a small matrix of expressions, n x n, in blocks of pivots, 1 x 1 as a rule. entry[n k + j], in pivot
 * order: left of the diagonal blocks the multipliers of L, right of them U.
 * Not symmetric: the first `constants` pivots are constants, with their reciprocals on the diagonal, and only they have
 * multipliers. A block of two or three has its inverse in `entry`; a larger one, its rows times row_scale, Householder's
 * reflections 1 - beta v v^T (v on and left of the diagonal) and R (right of it, 1 over its diagonal in `reciprocal`).
 * Symmetric: L D L^T, entry right of the diagonal is the transposed multiplier. Pivots may come in blocks B of two or
 * three: then there is adj(B) on the diagonal, beside it multipliers less the division by det(B), and `pivot` are the
 * diagonal of B. */
typedef struct Factors {
    int n;
    bool symmetric;
    int constants;
    int *row, *column;            /* [n] row and column of the k-th pivot */
    Ex *entry;                    /* [n][n] */
    Ex *pivot;                    /* [n] symmetric: the k-th diagonal element when it is reached */
    int *block;                   /* [n] first pivot of its block; itself */
    Ex *determinant, *reciprocal; /* [n] of the block that begins there, and 1 over that */
    Ex *row_scale, *beta;         /* [n] of blocks of more than three */
} Factors;

/* An order that is valid wherever A is not singular: constants first, cheapest at run time (Markowitz count), then the
 * irreducible diagonal blocks of the rest. unknown_scale [n] makes the unknowns comparable: the larger, the smaller an
 * unknown counts. usable [samples]. Returns NULL where A is singular (a pivot below 1e-9 of its row with full pivoting)
 * at a usable sample. */
Factors *linear_factor(Dag *dag, int n, const Ex *A, const double *unknown_scale, const bool *usable);
/* Symmetric and positive definite, or quasidefinite (a positive and a negative definite block on the diagonal), so that
 * every order of pivots on the diagonal is good: in this one [n], or cheapest first where it is NULL. Uses the upper
 * triangle of A. The last `blocked` pivots come three at a time: one division instead of three that wait for each
 * other, for some operations more. */
Factors *linear_factor_symmetric(Dag *dag, int n, const Ex *A, const int *order, int blocked);
/* x = A^-1 b; x may alias b. */
void linear_solve(Dag *dag, const Factors *factors, const Ex *b, Ex *x);
/* x = A^-T b of factors that are not symmetric; x may alias b. */
void linear_solve_transposed(Dag *dag, const Factors *factors, const Ex *b, Ex *x);
/* Dense numeric solve with row-scaled partial pivoting, in place: b [n] becomes x. False when singular. A is destroyed.
 */
bool linear_solve_numeric(int n, double *A, double *b);
/* Smallest pivot of A with its rows scaled to largest entries of 1, by elimination with full pivoting. A is destroyed. */
double linear_least_pivot(int n, double *A);
/* How far A is from having perpendicular rows, these scaled to norm 1: norm of the inverse (Frobenius) over sqrt(n), 1 at
 * best; HUGE_VAL when singular. */
double linear_condition(int n, const double *A);
/* Determinant of A with its rows scaled to largest entries of 1; 0 when singular. A is destroyed. */
double linear_determinant(int n, double *A);

/* ---- motion.c: how bodies move relative to the base ------------------------------------------------------ */

/* Motion of a body relative to the base, components in the base frame. c: position of the body's reference point, a
 * body-fixed point that makes the equations of its subset sparse; velocity and acceleration are that point's. alpha and
 * acceleration are those at w'' = 0. S: [deps][6] angular and linear velocity of unit rates of the coordinates. */
typedef struct Motion {
    Ex c[3], A[9], omega[3], velocity[3], alpha[3], acceleration[3];
    Ex *S;
    int deps;
    int images;
    struct Image {
        Ex s[3], v[3];
        bool side; /* another direction stands for A s, across the same axis: what is true of directions alone */
    } * image; /* body-fixed vectors whose components in the base frame need no A: v = A s */
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

/* The base itself: at rest at the origin. */
void motion_base(Dag *dag, Motion *motion);
/* A motion read from memory at the C expression `array` ("m0"), one number every `stride` from `offset` on. */
void motion_input(Dag *dag, Motion *motion, const char *array, int offset, int stride, int deps);
/* The number at a place in memory. */
Ex *motion_number(Motion *motion, int place);
/* The same at rest: position and rotation alone. */
void motion_input_pose(Dag *dag, Motion *motion, const char *array, int offset);

/* The motion of a body known relative to another one, the anchor, whose S has the same coordinates. */
void motion_compose(Dag *dag, const Motion *anchor, const Motion *relative, Motion *out);

/* A vector that turns with a body: v = A s. */
void motion_image(Dag *dag, Motion *motion, const Ex s[3], const Ex v[3]);
/* In place of A s, for a direction s across an axis that never turns, another one across it. No point is there. */
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

/* ---- rows.c: constraint equations ------------------------------------------------------------------------ */

/* One scalar equation Phi = 0 or Psi = 0 between the two ends of a joint or coordinate. Its derivative is
 * J[0] . twist_0 + J[1] . twist_1 + dual w' = 0, its second derivative the same with accelerations plus `bias` = 0. */
typedef struct Row {
    Ex value, J[2][6], dual, bias;
    Ex guard; /* positive on the right branch, or 0: needs none */
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
/* And as formulas of the model's tuning, 0 where a number follows no parameter. */
void fixture_tuned_joint(const Model *model, const Joint *joint, const double (*origin)[3],
                         Ex formula[FIXTURE_NUMBERS]);
void fixture_tuned_coordinate(const Model *model, const Coordinate *coordinate, const double (*origin)[3],
                              Ex formula[FIXTURE_NUMBERS]);
/* Where axes are parallel, that of the other end is perpendicular to two directions of end `across`. That had better be
 * the one that is known before: directions of a wheel that spins turn away from where pivots were chosen. */
int joint_rows(Dag *dag, JointType type, const Fixture *fixture, const Motion *const end[2], int across,
               Row row[ROWS_MAX]);
/* x, rate: value and rate of the coordinate. */
Row coordinate_row(Dag *dag, CoordinateType type, const Fixture *fixture, const Motion *const end[2], Ex x, Ex rate);

/* ---- sample.c: admissible configurations to choose pivots at ---------------------------------------------- */

/* Configurations reached by continuation along straight lines of the coordinates, in `steps` steps from the design.
 * Configuration 0 is the design. Poses are relative to the base and of reference points. */
typedef struct Sampling {
    int configurations, steps, bodies, coordinates;
    double *target; /* [configurations][coordinates] */
    double *pose;   /* [steps + 1][configurations][bodies][12]: c, A */
    bool *usable;   /* [bodies][configurations]: the body could be followed all the way */
    double **S;     /* [bodies] -> [configurations][deps of its subset][6], at the ends of the paths */
    double *swing;  /* [coordinates] largest rotation, or move relative to the subset's size, of a unit change */
} Sampling;

Sampling *sampling_new(Pool *pool, const Model *model, const Sequence *sequence, const double (*origin)[3]);
double sampling_coordinate(const Sampling *sampling, const Model *model, int step, int configuration, int coordinate);
/* Design pose of a body's reference point relative to another body's, or to the base: place and Euler parameters. origin:
 * reference points [bodies][3], body frames. */
void sampling_design(const Sampling *sampling, const Model *model, const double (*origin)[3], int anchor, int body,
                     double q[7]);
double *sampling_pose(const Sampling *sampling, int step, int configuration, int body);

/* ---- block.c: straight-line code before it is text ------------------------------------------------------------ */

/* `target` = value once everything is computed; or a status returned where value is not above `least` (of |value| with
 * `magnitude`), and where it is about a subset or a number of the state, which. */
typedef struct Store {
    const char *target;
    Ex value;
} Store;

typedef struct Check {
    Ex value;
    double least;
    bool magnitude;
    const char *status;
    int subset, state;               /* what it is about, -1: nothing of the kind */
    const struct Check *const *lane; /* [lanes] of a vector: the checks that it stands for; NULL: they are alike */
} Check;

typedef struct Block {
    Dag *dag;
    const char *model; /* its name, of a block with checks that are about something */
    int stores, checks, loads;
    Store *store;
    Check *check;
    Ex *load;       /* applied forces among its values, for those who count */
    bool scheduled; /* its statements stand as schedule.c orders them, with stores to what it doesn't read where values
                     * are found; else depth-first from the results, with all stores at the end */
    bool across;    /* the road must be the same on both sides, and is looked up on one: narrow.h */
} Block;

void block_store(Block *block, Ex value, const char *format, ...) __attribute__((format(printf, 3, 4)));
void block_check(Block *block, Ex value, bool magnitude, double least, const char *status);
/* `status` where value is not above 0, about a subset and a number of the state; -1: about none. */
void block_check_about(Block *block, Ex value, const char *status, int subset, int state);
/* Has it such checks? */
bool block_is_about(const Block *block);
/* The check of another block for a value of this one. */
void block_check_like(Block *block, Ex value, const Check *check);
void block_loads(Block *block, const Ex *load, int count);
Count block_count(const Block *block);
/* Of these the operations on vectors. */
Count block_count_wide(const Block *block);
/* Of these operations those that are left where its loads are given. */
Count block_count_above_loads(const Block *block);
/* All inputs that it reads, by name. */
void block_inputs(const Block *block, void (*visit)(void *context, const char *name), void *context);
/* Does it read an input `array[...]`? */
bool block_reads(const Block *block, const char *array);

#endif
