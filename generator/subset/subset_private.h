/* SPDX-License-Identifier: MIT
 * One class of subsets while its formulas are made. Private to generator/subset. */
#ifndef SUBSET_SUBSET_PRIVATE_H
#define SUBSET_SUBSET_PRIVATE_H

#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"

/* An end of a joint: the body at it. */
typedef struct End {
    int unknown; /* local index of an unknown body, or -1 */
    int known;   /* index among the knowns, or -1; both -1: the base */
} End;

/* One joint or dual coordinate of the class. */
typedef struct Connection {
    bool is_coordinate;
    int index; /* joint or coordinate of the first member */
    End end[2];
    Fixture fixture;
    int dep;         /* index among the deps, of a coordinate */
    int measure;     /* a CoordinateType, of a coordinate or of a joint with a formula; -1: neither. Then: */
    Ex x, rate;      /* what is measured */
    Ex second;       /* what remains of its second derivative where those of the coordinates are 0 */
    const Ex *slope; /* [deps] derivatives of a formula by the coordinates; NULL: there is none */
    bool still;      /* the first end's axis never turns; then: */
    Ex across[2][3]; /* directions perpendicular to it in the base frame, used instead of `side` */
} Connection;

typedef struct Work {
    Pool *pool;
    const Model *model;
    const Sequence *sequence;
    const Class *class;
    const Subset *first; /* first member */
    const double (*origin)[3];
    Dag *dag;
    int n; /* 6 a body */
    int connections;
    Connection *connection;
    Ex *q;        /* [7 bodies] */
    Motion *pose; /* poses (c and A only) of the unknowns at q */
    Motion *known;
    Motion base;
    bool plain;    /* rows are made in the base's frame, without images of directions that the solution found */
    bool anchored; /* the subset is solved relative to known 0, its anchor: q, S, pose, row, J and factors are relative
                    * to it */
    Ex *x, *rate, *change;
    double size;    /* see Formula */
    int derived;    /* numbers that follow tunable parameters: d[] */
    Ex *derived_of; /* [derived][members] their formulas */
    Row *row;       /* [n] equations with the unknowns at q and at rest */
    int *row_of;    /* [n] connection that a row belongs to */
    Ex *J;          /* [n][n] Jacobian by the unknown twists */
    int configurations;
    bool *alive; /* [samples] the sample reached the end of its path */
} Work;

/* Balance the sums of a formula's `solve`: balance.c. */
void formula_balance(Work *w, Formula *formula);

/* The subset of the i-th member. */
const Subset *subset_member(const Work *w, int i);
/* A constant of the class from each member's number; *formula: its formula if it follows parameters. */
typedef double SubsetNumber(const Work *w, int member, int a, int b, Ex *formula);
Ex subset_constant(Work *w, SubsetNumber *get, int a, int b);
/* A number of every member [members]: a constant of the class, or an input d[] if it follows tunable parameters. */
Ex subset_number(Work *w, const double *value, const Ex *formula);

/* length_unit.c. Unit of length of a class, m: the largest distance of a connection's point from its body's reference
 * point; the extent of the bodies, at most 1 m, if that is a hundred times larger; 1 m if all points are reference
 * points. */
double subset_size(const Work *w);
/* Largest distance of the bodies' reference points from the base's origin at the design, m. */
double subset_distance(const Work *w);

/* at_drawing.c: the value of an expression for a member at the drawn configuration, at rest, as a formula of the
 * model's tuning. The model must have a tuning. */
Ex subset_at_drawing(const Work *w, int member, Ex e);

/* sample_paths.c: follow one member along its sample paths. Sets the graph's samples of that member to the ends of the
 * paths, w->alive, and the numbers in `sampling` that later subsets need. */
void subset_follow(Work *w, Sampling *sampling, int member);

/* sample_paths.c: move one member from the drawing to poses in which all equations hold, at the design values of its
 * coordinates. q [7 bodies]: these poses relative to the base; they go into step 0 of the sampling. False if it can't
 * be followed. */
bool subset_assemble(Work *w, Sampling *sampling, int member, double *q);

/* sample_paths.c, used by scan_ranges.c and explain_singular.c. s: a sample of the class's graph; q [7 bodies]; twists
 * [6 bodies]; slack [n]. */
void subset_set_known(Work *w, int known, int s, const double pose[12]);
void subset_set_poses(Work *w, const double *q, int s);
void subset_move_pose(double q[7], const double twist[6]);
/* Newton's iteration from q, which is updated, towards residuals `slack` (NULL: 0). False if a correction is too large
 * or it does not converge. */
bool subset_converge(Work *w, double *q, int s, const double *slack);
/* Set the sample of a subset to the design configuration; q: the poses there. */
void subset_to_design(Work *w, const Sampling *sampling, int subset, double *q);
void subset_get_poses(const Work *w, const Subset *member, int s, double (*pose)[12]);
double subset_determinant(const Work *w, int s);

/* singularity_checks.c: condition of the subset's equations at a sample: 1 at best, 3 to 10 at most designs; and the
 * share of the design's determinant below which the subset counts as singular. */
double subset_condition(const Work *w, int s);
double subset_singular_share(const Work *w, int s);

/* scan_ranges.c: warn of coordinates that lose independence inside their ranges. */
void subsets_scan(Pool *pool, const Model *model, const Sequence *sequence, Work **work, const Sampling *sampling);

/* explain_singular.c: end with a message if a subset is singular at the design configuration. */
void subset_explain_singular(Work *w, const Sampling *sampling, int subset);

/* split_classes.c: keep in class c the members that share pivots with its first one, and put the others into a new
 * class. False if all of them share pivots. */
bool class_split(Pool *pool, Sequence *sequence, int c, Work *w);

/* A class with its connections, inputs and equations, ready to be followed. */
Work *subset_open(Pool *pool, const Model *model, const Sequence *sequence, const Class *class,
                  const double (*origin)[3], const Sampling *sampling);
/* The member of the class that a subset is. */
int subset_index(const Work *w, int subset);

/* The joint or coordinate of the first member by name. */
const char *connection_name(const Work *w, const Connection *tie);

/* hinge.c: true if this angle is measured about the axis of a hinge between its bodies. */
bool subset_is_hinged(const Work *w, const Connection *angle);
/* That axis in the frame of the angle's first or second body; false if there is no such hinge. */
bool subset_hinge_axis(const Work *w, const Connection *angle, int end, Ex axis[3]);
/* Set the derivatives of the angle's row to those of the angle between the bodies, for given motions of the ends. */
void subset_hinge_row(const Work *w, const Connection *angle, const Motion *const end[2], Row *row);

/* anchor.c: unknowns [bodies] from the subset's frame into the base's. */
void subset_to_base(const Work *w, const Motion *relative, Motion *out);
/* The same for the numbers of sample s: pose of unknown b; twist of its reference point for a unit rate of a
 * coordinate, `carrier` being the anchor's (not read: the base). */
void subset_pose_in_base(const Work *w, int b, int s, double pose[12]);
void subset_twist_in_base(const Work *w, int b, int s, const double carrier[6], double twist[6]);

/* measures.c: set what connections measure, once their deps are there. */
void subset_measures(Work *w);
/* The derivative of a connection's row by dep j; 0 if it measures nothing. */
Ex subset_dual(const Work *w, const Connection *tie, const Row *row, int j);

/* The same of row r as a number, at sample s. */
double subset_dual_value(const Work *w, const Connection *tie, int r, int j, int s);

/* The motion of an end of a connection in the subset's frame, for given motions of the unknowns. */
const Motion *subset_motion(const Work *w, const Motion *unknown, End end);

/* All rows [n] of the class for given motions of the unknowns; row_of [n]: the connection of each. */
void subset_rows(Work *w, const Motion *unknown, Row *row, int *row_of);

/* residual.c: make the block `residual` of a formula that has motion and layout. */
void subset_residual(Work *w, Formula *formula);

/* presolve.c: put what joints to known bodies determine into poses [bodies]: c and A, with `directions` also the axes
 * of hinges; true if the reference point, the rotation is so determined; set to 0 the rows [n] of joints that c and A
 * fulfil. */
void subset_presolve(Work *w, Motion *pose, bool directions);
bool subset_presolves_point(const Work *w, int body);
bool subset_presolves_rotation(const Work *w, int body);
void subset_drop_presolved(const Work *w, Row *row, const int *row_of);

/* polynomial.c: give a formula polynomials of its one coordinate, with errors below a bound, where that is possible;
 * says why not in it. made: [classes] formulas of those before. Ends in a message where its range has a singular
 * configuration or its geometry is tunable. */
void subset_polynomial(Work *w, Formula *formula, Formula *const *made, const Sampling *sampling, double bound);

/* constant_motion.c: replace numbers of a known's motion, in the order of its own deps, that are the same in every
 * configuration by constants of the class. formula: [classes] those made so far, or NULL. */
void subset_use_constants(Work *w, Formula *const *formula, int known, Motion *motion);
/* Find joints whose axis in a known body never turns. */
void subset_find_still(Work *w);
/* Remove stores of numbers that are constant and so not read. formula: [classes] all. */
void subsets_drop_constants(Pool *pool, const Model *model, const Sequence *sequence, Formula *const *formula);

/* closed_form.c: fill the poses (c and A) of the unknowns if geometry determines them step by step, with images of
 * vectors, and checks that each step is within reach. False: no closed form. */
bool subset_closed(Work *w, Motion *pose, Block *block);

/* singularity_checks.c: checks in `solve` of the guards of w->row if poses may be on a wrong branch. Returns the
 * determinant of J relative to that at the design, times the share that is relied on; 0: it does not vary. */
Ex determinant_check(Work *w, Formula *formula, const Factors *factors, bool closed);
/* Check that this determinant (0: none) stays large enough for the time `ahead`, for given motions [bodies]. */
void determinant_check_ahead(Work *w, Formula *formula, Ex determinant, const Motion *motion);

/* inertia.c: the contribution of the bodies to the equations of motion, for given motions: [inertia_size]. */
Ex *subset_inertia(Work *w, const Layout *layout, const Motion *motion, BodyInertia *body); /* body [bodies] */

/* multipliers.c: make the class's block `react`. factors, row [n]: those that the last solution stored. */
void subset_react(Work *w, const Factors *factors, const Row *row, Block *block);

#endif
