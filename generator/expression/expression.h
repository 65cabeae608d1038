/* SPDX-License-Identifier: MIT
 *
 * expression: the expression graph, straight-line blocks of code before they are text, and factorizations. */
#ifndef EXPRESSION_EXPRESSION_H
#define EXPRESSION_EXPRESSION_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct Table Table; /* base/table.h */

/* ---- graph.c: the expression graph */

/* Arrays of numbers that blocks read and store, and numbers that stand alone. X(name, its name in C, what it is) */
#define ARRAY_LIST(X) \
    X(none, "", "no array") \
    X(number, "", "a number that is written as it is: Element.number") \
    X(sum, "", "a sum over lanes, while a block is vectorized") \
    X(time, "time", "time, alone") \
    X(y, "y", "state") \
    X(e, "e", "Euler parameters of the base, normalized") \
    X(x, "x", "coordinates; of a class those that it depends on") \
    X(xd, "xd", "rates of the coordinates") \
    X(u, "u", "inputs") \
    X(m, "m", "motion of all bodies") \
    X(n, "n", "inertia of all subsets") \
    X(p, "p", "parameters") \
    X(port, "port", "forces and torques on ports") \
    X(rate, "rate", "rate of the state; of a class of the coordinates that it depends on") \
    X(acc, "acc", "accelerations") \
    X(out, "out", "outputs") \
    X(pose, "pose", "poses of the bodies") \
    X(tau, "tau", "residuals of the equations of motion") \
    X(size, "size", "what the residuals are compared with") \
    X(energy, "energy", "energy balance") \
    X(press, "press", "how near contacts are") \
    X(lambda, "lambda", "multipliers") \
    X(link, "link", "how the multibody system moves a wheel") \
    X(fast, "fast", "fast states") \
    X(torque, "torque", "drive and brake torque") \
    X(contact, "contact", "a wheel's contact with the road") \
    X(force, "force", "forces of a tire") \
    X(grip, "grip", "what a wheel does to its carrier") \
    X(gear, "gear", "gears in numbers") \
    X(watch, "watch", "outputs of the powertrain") \
    X(choice, "choice", "choice of gear") \
    X(left, "left", "what is left of the equations of the wheels' spins") \
    X(q, "q", "poses of a subset's bodies, followed by Newton's iteration") \
    X(change, "change", "change of the coordinates since the start") \
    X(turn, "turn", "angular velocity of the base") \
    X(ahead, "ahead", "time up to which a subset must stay regular") \
    X(s, "s", "unit velocities at the start") \
    X(f, "f", "factors at the start") \
    X(start, "start", "a subset's start for the next time") \
    X(motion, "motion", "motion of a subset's bodies") \
    X(inertia, "inertia", "a subset's inertia") \
    X(reach, "reach", "squared way of the bodies to the new coordinates, alone") \
    X(step, "step", "squared correction, alone") \
    X(worst, "worst", "largest residuals") \
    X(w, "w", "multipliers of a subset") \
    X(d, "d", "numbers of a subset that follow geometric parameters") \
    X(rest, "rest", "rest of the way to given lengths, alone") \
    X(known, "m", "motion of a body that was solved before: Element.which") \
    X(onto, "w", "wrench on a body that was solved before: Element.which") \
    X(self_derived, "self->derived", "numbers that follow geometric parameters") \
    X(self_grip, "self->grip", "grip of all wheels") \
    X(self_watch, "self->watch", "outputs of the powertrain at the last fast step") \
    X(self_motion, "self->motion", "motion of all bodies") \
    X(self_state, "self->state", "state of the instance") \
    X(self_input, "self->input", "inputs of the instance") \
    X(self_start, "self->start[0]", "first of the Newton starts") \
    X(column, "column", "derivatives of all motions by coordinates and their rates, column by column") \
    X(column_known, "column", "the same of the subset of a body that was solved before: Element.which") \
    X(jacobian, "jacobian", "derivatives of the rates") \
    X(share, "share", "share of the dependent Euler parameter's change in that of each other one") \
    X(which, "which", "1 for the dependent Euler parameter, 0 for the others") \
    X(right, "right", \
      "right-hand sides, or solutions, of Element.which, one column of several; of column c where it is -1") \
    X(part, "part", "derivatives of what moves wheels, and of fast rates, of one column as `right`") \
    X(local, "local", "derivatives of what wheels, own states and the powertrain do by what moves each of them") \
    X(half, "half", "derivatives of a wheel's contact and tire by what moves the wheel") \
    X(factor, "factor", "factors of the mass matrix") \
    X(lack, "lack", "what bodies lack in the equations of motion along a direction") \
    X(kept, "kept", "numbers of a subset's recovery that its derivatives read later") \
    X(cut, "cut", "what an element exerts, as its derivatives are asked for; in no code") \
    X(inside, "inside", "how far a coordinate is within the range of polynomials")

typedef enum Array {
#define ARRAY_ENUM(name, text, what) ARRAY_##name,
    ARRAY_LIST(ARRAY_ENUM)
#undef ARRAY_ENUM
        ARRAY_COUNT
} Array;

/* One number of an array, or its derivative along a direction. */
typedef struct Element {
    Array array;
    int which;  /* of several arrays of one kind: ARRAY_known, ARRAY_onto */
    int index;  /* 0: of a number that stands alone */
    bool slope; /* the derivative */
    double number;
} Element;

static inline Element element_at(Array array, int index)
{
    return (Element){.array = array, .index = index};
}

static inline Element element_of(Array array, int which, int index)
{
    return (Element){.array = array, .which = which, .index = index};
}

/* By array, which, index and number; equal elements give 0. */
int element_compare(Element a, Element b);
static inline bool element_same(Element a, Element b)
{
    return element_compare(a, b) == 0;
}

/* Its index where it is a number of that array, else -1. */
static inline int element_index(Element e, Array array)
{
    return e.array == array && !e.slope ? e.index : -1;
}

uint64_t element_hash(Element e);

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
    X(OP_FOLD, 2, "FOLD(%0, %1)", "add") \
    X(OP_TABLE_SLOPE, 1, "", "function") \
    X(OP_ROAD_CHANGE, 3, "", "function") \
    X(OP_FRICTION_CHANGE, 3, "", "function") \
    X(OP_CURVE, 1, "", "function")

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
    uint8_t wide;      /* lanes of a vector; 0: one number */
    uint8_t undefined; /* constants made a part of it that is no finite number: it is not folded, nor into anything, so
                          that it is computed at run time and ends in a status */
    Ex arg[3]; /* OP_ROAD_PART: arg[1] is 0, 1 or 2 for h, dh/dx, dh/dy; OP_TABLE, OP_TABLE_SLOPE, OP_CURVE: arg[1] is
                  the index of the table or curve; OP_LANE: arg[1] is the lane; OP_FOLD: arg[2] is the step;
                  OP_ROAD_CHANGE, OP_FRICTION_CHANGE: arg[0] is the OP_ROAD or OP_FRICTION, then the changes of x and y
                */
    const Element *element; /* OP_INPUT: what it reads; of a vector that of each lane */
} Node;

/* Nodes made one after another for the same purpose, from `first` on: a title for who reads the code. */
typedef struct DagSection {
    Ex first;
    const char *title;
} DagSection;

/* What a node is, as an identifier. */
typedef struct DagLabel {
    Ex e;
    const char *name;
} DagLabel;

/* Where a constant comes from: origin.c. */
typedef struct DagOrigin DagOrigin;

/* A system A x = b that linear_solve() has solved, with the matrix of its factors. */
typedef struct DagSystem {
    const struct Factors *factors;
    Ex *b, *x;   /* [n] */
    bool *found; /* [n] x is a node that the solution made: no part of A or b depends on it */
} DagSystem;

/* Every node carries `samples` numeric values: sample s is one admissible configuration of class member
 * s / (samples / members). Constants are folded, sums and products simplified as nodes are made. */
typedef struct Dag {
    Pool *pool;
    int members, samples;
    int lanes; /* elements of each vector: the constants are vectors; 0: they are scalars */
    int nodes, room;
    int own; /* nodes before derivatives were made, which are behind them; 0: there are none */
    Node *node;
    double *value; /* [nodes][samples] */
    Ex *table;     /* hash table */
    int sections, labels, origins, systems;
    struct DagSection *section;
    struct DagLabel *label;
    DagOrigin *origin;
    DagSystem *system;
    const Table *tables;         /* what OP_TABLE looks up in, as far as samples go; NULL: they are 0 */
    const struct Curves *curves; /* of OP_CURVE: curve.h */
    Ex moved;                    /* a variable whose value dag_evaluate() makes larger by `moves`; 0: none */
    double moves;
    uint32_t mask;
} Dag;

Dag *dag_new(Pool *pool, int members, int samples);
/* Nodes made from now on belong to a section with that title; NULL: to none. */
void dag_section(Dag *dag, const char *title);
/* The section of a node by its number, in the order in which they began, so that a node's arguments are in its own or
 * in earlier ones; -1: before all. */
int dag_section_of(const Dag *dag, Ex e);
/* A node is that quantity, in words with underscores between them. */
void ex_label(Dag *dag, Ex e, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* origin.c: a constant is that quantity of the first member; it is folded from the arguments of a node; what it is in
 * words, an expression of such quantities or a list of them, NULL: not known. */
void ex_describe(Dag *dag, Ex e, const char *format, ...) __attribute__((format(printf, 3, 4)));
void ex_describe_folded(Dag *dag, Ex e, const Node *folded);
const char *ex_origin(const Dag *dag, Ex e);
int ex_arity(Op op); /* arguments of its nodes */
Ex ex_literal(Dag *dag, double value);
Ex ex_constant(Dag *dag, const double *value); /* [members] */
Ex ex_number(Dag *dag, double value);          /* a literal that is never folded: an input R(value) */
bool ex_is_number(const Dag *dag, Ex e);
Ex ex_input(Dag *dag, Element element, const double *sample); /* [samples], or NULL: not needed */
Ex ex_op(Dag *dag, Op op, Ex a, Ex b, Ex c);                  /* unused arguments: 0 */
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
/* A vector read from memory, of a graph with lanes, the element of each lane; one lane of a vector; the sum of all.
 * What is no vector is the same in all lanes. */
Ex ex_vector(Dag *dag, const Element *lane);
Ex ex_lane(Dag *dag, Ex vector, int lane);
Ex ex_lane_sum(Dag *dag, Ex vector);
/* A step of adding while transposing: lane l becomes the sum of lanes l and l ^ 2^step of `a` where that bit of l is 0,
 * of `b` where it is 1. What is no vector becomes one. */
Ex ex_fold(Dag *dag, Ex a, Ex b, int step);
/* What an operation does to numbers. */
double op_value(Op op, double a, double b, double c);
/* sin and cos without libm: the same digits on every machine. */
void portable_sincos(double x, double *sine, double *cosine);

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

/* balance_sums.c: what stands for each node [nodes] that the roots need where sums are added in the order in which
 * their terms become ready; the same values but for rounding. Without lanes. */
const Ex *balance_sums(Pool *pool, Dag *dag, const Ex *root, int roots);

/* ---- factorize.c: straight-line factorizations */

/* P A Q = L U of a small matrix of expressions, n x n, in blocks of pivots, 1 x 1 as a rule. entry[n k + j], in pivot
 * order: left of the diagonal blocks the multipliers of L, right of them U.
 * Not symmetric: the first `constants` pivots are constants, with their reciprocals on the diagonal, and only they have
 * multipliers. A block of two or three has its inverse in `entry`; a larger one, its rows times row_scale,
 * Householder's reflections 1 - beta v v^T (v on and left of the diagonal) and R (right of it, 1 over its diagonal in
 * `reciprocal`). Symmetric: L D L^T, entry right of the diagonal is the transposed multiplier. Pivots may come in
 * blocks B of two or three: then there is adj(B) on the diagonal, beside it multipliers less the division by det(B),
 * and `pivot` are the diagonal of B. */
typedef struct Factors {
    int n;
    bool symmetric;
    int constants;
    const Ex *matrix;             /* [n][n] A, both triangles; NULL: the factors are those of another pose */
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
/* Smallest pivot of A with its rows scaled to largest entries of 1, by elimination with full pivoting. A is destroyed.
 */
double linear_least_pivot(int n, double *A);
/* How far A is from having perpendicular rows, these scaled to norm 1: norm of the inverse (Frobenius) over sqrt(n), 1
 * at best; HUGE_VAL when singular. */
double linear_condition(int n, const double *A);
/* The same with the units of rows and columns that are best for it: spectral radius of |A^-1| |A| (Bauer 1963). */
double linear_condition_in_best_units(int n, const double *A);
/* Determinant of A with its rows scaled to largest entries of 1; 0 when singular. A is destroyed. */
double linear_determinant(int n, double *A);

/* ---- block.c: straight-line code before it is text */

/* `target` = value once everything is computed; or a status of gic_runtime.h returned where value is not above `least`
 * (of |value| with `magnitude`), and where it is about a subset or a number of the state, which. */
typedef struct Store {
    Element target;
    Ex value;
} Store;

typedef struct Check {
    Ex value;
    double least;
    bool magnitude;
    int status;                      /* gic_status */
    int condition;                   /* of the parameters that is not fulfilled, -1: none */
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
    bool eager;     /* stores to what it doesn't read stand where values are found, in the order of the stores */
    bool across;    /* the road must be the same on both sides, and is looked up on one: specialize/specialize.h */
} Block;

void block_store(Block *block, Ex value, Element target);
void block_check(Block *block, Ex value, bool magnitude, double least, int status);
/* A condition of the parameters that value > least stands for: else GIC_ERROR_GEOMETRY. */
void block_require(Block *block, Ex value, double least, int condition);
/* `status` where value is not above 0, about a subset and a number of the state; -1: about none. */
void block_check_about(Block *block, Ex value, int status, int subset, int state);
/* A status by the name of its enumerator. */
const char *status_name(int status);
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
/* All elements that it reads. */
void block_inputs(const Block *block, void (*visit)(void *context, Element element), void *context);
/* Does it read an element of that array, of several the one with that number? slope: the derivative of one. */
bool block_reads(const Block *block, Array array, int which);
bool block_reads_slope(const Block *block, Array array, int which);

/* ---- tangent.c: forward differentiation along one direction */

/* Where derivatives begin. */
typedef struct Seeds {
    bool (*moves)(const void *context, Element element);        /* has an input a derivative? That is its `slope` */
    Ex (*seed)(const void *context, Dag *dag, Element element); /* the derivative itself; NULL: as `moves` says */
    const void *context;
    int givens; /* nodes whose derivatives are given, [givens] */
    const Ex *given, *slope;
    bool
        smooth; /* roots, powers and arcs have slopes, which are differentiated again: no 0 in place of 0 times infinity
                 */
} Seeds;

/* The derivative of each node [nodes] that the roots need; of others 0. block: its checks hold; NULL: none do. At a
 * kink it is that of the branch taken; of |x| at x = 0 the mean of both, 0; of a root at 0 that stays there, and of
 * atan2(0, 0), 0. Without lanes. */
const Ex *dag_slopes(Dag *dag, const Block *block, const Ex *root, int roots, const Seeds *seeds);
/* The block that stores derivatives of what `block` stores; both: and what it stores itself, with its checks. wanted:
 * which stores; NULL: all. */
Block *block_tangent(const Block *block, const Seeds *seeds, bool both,
                     bool (*wanted)(const void *context, Element target));

/* graph.c: the same graph with its inputs named by `rename`, which gives different inputs different names; nodes keep
 * their numbers. */
Dag *dag_renamed(Pool *pool, const Dag *from, Element (*rename)(const void *context, Element input),
                 const void *context);

/* replace.c: what stands for each node [nodes] that the roots need where to[i] stands for from[i]. Without lanes. */
const Ex *dag_replace(Dag *dag, const Ex *root, int roots, const Ex *from, const Ex *to, int count);
/* The same operation on other arguments. */
Ex ex_again(Dag *dag, Op op, Ex a, Ex b, Ex c);

/* schedule.c: a statement that computes a node, or a check of one. */
typedef struct Step {
    Ex value;
    int check; /* of the block; -1: a statement */
} Step;

/* Put steps [steps], which come with operands before what needs them, into the order in which a processor is the least
 * time without work. Checks keep theirs, and what may not be computed before a check, roots and quotients, comes after
 * the checks that it came after. chains: elementary functions are operations in place, not calls. */
void schedule_steps(Pool *pool, const Dag *dag, Step *step, int steps, bool chains);

#endif
