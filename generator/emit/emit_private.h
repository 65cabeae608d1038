/* SPDX-License-Identifier: MIT
 *
 * What the files that fill the templates share. */
#ifndef EMIT_EMIT_PRIVATE_H
#define EMIT_EMIT_PRIVATE_H

#include "base/text.h"
#include "emit/emit.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "vehicle/vehicle.h"

typedef struct Generation {
    Pool *pool;
    const Formulation *formulation;
    const Model *model; /* these three are the formulation's */
    const Sequence *sequence;
    const Plan *plan;
    const Style *style;
    const char *templates, *header, *upper;
    const char *guard;    /* macro of the header */
    uint32_t pair;        /* its value, which the C checks, so that no other run's header passes; 0: not known yet */
    int class;            /* the one whose template is being expanded */
    Constants *constants; /* [classes] */
    Constants packed;     /* of the equations of motion in lanes */
    bool weighing;        /* columns_of() are weighed */
    bool columns_made[2]; /* not weighed, weighed */
    const struct RateColumns *columns[2]; /* columns_of() */
    const struct Generation *lanes; /* flat.c: of derivatives beside code in lanes, that of the code; NULL: other */
    struct Generation *single;      /* the derivatives of code in lanes, once they are asked for */
    struct Spread *spread;          /* spread.c; NULL: not made yet */
} Generation;

/* model_file.c: a checksum of the whole header, for g->pair. */
uint32_t header_number(const Generation *g, const char *name, const Insertions *points, void *context);
void write_guard(void *context, Text *out, int indent);
/* element_text.c: names of numbers in arrays, for code that people read. */
typedef enum NamingScope {
    SCOPE_WHOLE, /* blocks of the whole vehicle */
    SCOPE_CLASS, /* of a class of subsets: indices within one subset */
    SCOPE_WHEEL, /* of one wheel */
    SCOPE_FAST   /* of all fast states: rate[] and acc[] are indexed by fast states */
} NamingScope;

typedef struct Naming {
    const Formulation *formulation;
    const char *upper;    /* enumerators begin so */
    const Formula *class; /* of a class's blocks */
    NamingScope scope;
    /* [bodies], [subsets], [coordinates], [wheels] names in capitals; NULL: two are equal, so indices stay numbers */
    const char **body, **subset, **coordinate, **wheel;
} Naming;

const Naming *naming_new(Pool *pool, const Formulation *formulation, const char *upper);
/* The enumerators that are not in the header: insertion point "layout". */
void write_layout(void *context, Text *out, int indent);
/* Enumerators of a coordinate, of the first number of a body's motion or of a subset's inertia, and of a wheel's first
 * number in an array ("LINK"). */
const char *coordinate_text(Pool *pool, const Naming *naming, int coordinate);
const char *body_motion_text(const Generation *g, int body);
const char *subset_inertia_text(const Generation *g, int subset);
const char *wheel_place_text(const Generation *g, const char *array, int wheel, int place);
/* Enumerators of an input, a state and a subset. */
const char *input_text(Pool *pool, const Naming *naming, int input);
const char *state_text(Pool *pool, const Naming *naming, int state);
const char *subset_text(Pool *pool, const Naming *naming, int subset);
/* An identifier made of the words of a text. */
const char *variable_name(Pool *pool, const char *s);
/* Name of a temporary whose value is stored in this element; NULL: it has no name of its own. */
const char *element_variable(Pool *pool, const Naming *naming, Element e);
/* An element of an array as C text, motion[7], with the index as an enumerator where there are names; its address,
 * motion + 7. */
const char *element_text(Pool *pool, const Naming *naming, Element e);
const char *element_row_text(Pool *pool, const Naming *naming, Element e, int step); /* its index times `step` */
const char *element_address(Pool *pool, const Naming *naming, Element e);

/* wrap.c: the same text with no line over 120 columns where blanks allow it. */
char *wrap_lines(Pool *pool, const char *text, size_t *size);

/* One line of text. */
void line(Text *out, int indent, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Length of an array with `count` elements: at least 1. */
int room(int count);
/* Numbers in the state, slow and fast. */
int states(const Generation *g);
/* A string as a C literal; every second question mark is escaped, so that no trigraph arises. */
const char *quoted(Pool *pool, const char *s);
/* In capitals, with an underscore for everything but letters and digits. */
const char *capital(Pool *pool, const char *s);
/* The table `name` of a class's constants, one row for each member. */
void write_constants(Generation *g, Text *out, const char *name, const Dag *dag, const Constants *k,
                     const char *const *member);
/* A line of the table of operations. */
void count_line(Text *out, const char *what, Count c);
/* The insertion points of model.c.in and of templates in it; context: the Generation. */
extern const Insertions code_points;

/* classes.c: the insertion points of subset.c.in for the class g->class, context: the Generation; all classes. */
extern const Insertions subset_points;
void write_classes(void *context, Text *out, int indent);
/* A block of g->class, in the names of its members. */
void write_class_block(const Generation *g, const Block *block, Constants *constants, Text *out, int indent);
/* The constants of g->class that the text refers to so far. */
void write_class_constants(Generation *g, Text *out);
/* True if the class has a member that is not the image of another one. */
bool class_is_called(const Generation *g, int class);
/* True if the members of a class are solved side by side in lanes. */
bool class_in_lanes(const Generation *g, int class);
/* Number of bodies that Newton's iteration recovers. */
int followed_bodies(const Plan *plan);

/* recovery.c: calls of the subsets' functions, in recover_piece and residual; of those that find reactions;
 * coordinates and rates from state and inputs; changes followed in one piece; design poses of followed bodies; the
 * initial state. */
void write_recovery_calls(void *context, Text *out, int indent);
/* C for the change of a coordinate in one piece, m or rad: the difference, or where an angle may have whole turns in it
 * the text `unwinding` with the difference for its %s. */
const char *change_text(const Generation *g, const char *unwinding, int coordinate);
/* Lines that remove whole turns from way[], the changes since the start, if a change is too large; lanes: for many
 * vehicles. */
void write_unwinding(const Generation *g, Text *out, int indent, bool lanes);
void write_residuals(void *context, Text *out, int indent);
void write_react_calls(void *context, Text *out, int indent);
void write_gathered(void *context, Text *out, int indent);
void write_pieces(void *context, Text *out, int indent);
void write_design(void *context, Text *out, int indent);
void write_initial(void *context, Text *out, int indent);

/* curves.c: insertion point of curves.c.in, context: the Generation; lines about tires by table for the banner. */
extern const Insertions curve_points;
void write_curve_error(const Generation *g, Text *out);
/* True if functions of tires are tables: not if all are short polynomials, which gic_lanes.h has. */
bool has_table_curves(const Generation *g);
/* polynomials.c: lines of the banner: which subsets have polynomials, with bound, degree and largest error found, and
 * why others have none; nothing where no subset has any. */
void write_polynomials(const Generation *g, Text *out);

/* lanes.c: insertion points of templates of lanes. */
extern const Insertions lane_class_points, lane_width_points, lane_fold_points;
/* For a plan in lanes: vector types; links of subsets side by side; the function of class g->class; its call, at the
 * first subset of a row. */
void write_lane_types(Generation *g, Text *out);
void write_lane_road(Generation *g, Text *out);
void write_lane_links(Generation *g, Text *out);
void write_lane_class(Generation *g, Text *out);
void write_lane_call(const Generation *g, Text *out, int indent, int subset);
/* Definitions that the equations of motion in lanes need. */
void write_packed(Generation *g, Text *out);
/* Numbers of one subset as an array without gaps: in place, or copied to `room`. */
const char *alone_text(const Generation *g, const char *room, const char *array, const char *offset, int stride,
                       int count);

/* tangent.c: insertion points of its templates; functions for derivatives and what the header says about them, with
 * Style.derivatives. */
extern const Insertions tangent_points, tangent_class_points, tangent_header_points;
/* Are there functions along directions? With Style.derivatives, and for implicit steps without weighed_columns(). */
bool has_tangents(Generation *g);
/* Functions for derivatives along directions and for implicit steps, and what both call. */
void write_derivative_code(void *context, Text *out, int indent);
/* Where derivatives are computed with the recovery: the prototype of a function for it, before the recovery; its call,
 * in the place of the recovery's own ones; a member of the instance. */
void write_recovery_along(void *context, Text *out, int indent);
void write_recovery_call_along(Generation *g, Text *out, int indent);
void write_along_member(void *context, Text *out, int indent);
/* The blocks of tangents: of a class of subsets; of any other block. */
const Block *class_tangent(const Generation *g, int class, bool still);
const Block *whole_tangent(const Generation *g, const Block *block);
/* flat.c: derivatives of code in lanes are computed one by one, from copies of what its recovery leaves in rows. The
 * generation that writes them: of the formulation without lanes; other code's own. */
Generation *one_by_one(Generation *g);
/* For weighed columns of code in lanes, which read rows: is this so; a block of the whole vehicle that does, for other
 * columns the block itself. */
bool reads_rows(const Generation *g);
const Block *placed_block(const Generation *g, const Block *block);
void write_row_copies(Generation *g, Text *out); /* the function that copies numbers of one subset from them */
/* Where derivatives find "motion", "inertia" or "start" of an instance: self->motion, or the copy. */
const char *found_text(const Generation *g, const char *array);
/* Insertion points: pointers to them; members of the instance, function and call that copy; nothing without lanes. */
void write_found_motions(void *context, Text *out, int indent);
void write_found_inertias(void *context, Text *out, int indent);
void write_found_start(void *context, Text *out, int indent);
void write_flat_members(void *context, Text *out, int indent);
void write_flat(void *context, Text *out, int indent);
void write_flat_call(void *context, Text *out, int indent);
extern const Insertions flat_points;
/* jacobian.c: the number of columns; sizes, a picture and tables of what may be other than 0. */
int jacobian_columns(const Generation *g);
/* [columns] those of parameters that change the geometry. */
const bool *columns_apart(Generation *g);
/* [states][states] rates that may follow a state. */
const bool *jacobian_pattern(Generation *g);
void write_jacobian_sizes(void *context, Text *out, int indent);
void write_jacobian_picture(void *context, Text *out, int indent);
void write_jacobian_rows(void *context, Text *out, int indent);
void write_jacobian_starts(void *context, Text *out, int indent);
void write_tangent_header(void *context, Text *out, int indent);

/* columns.c: insertion points of its templates; all columns that are computed at once, NULL: one by one; the function.
 */
extern const Insertions columns_points, columns_class_points;
const struct RateColumns *columns_of(Generation *g);
/* Length of rows of columns that are solved at once: one for columns of both kinds, whole vectors. */
int column_lanes(Generation *g);
/* "columns", or "forces" while weighed ones are written. */
const char *columns_name(const Generation *g);
void write_jacobian_columns(void *context, Text *out, int indent);
/* Those of implicit steps: forces, not accelerations; NULL: the model has none. The function for them. */
const struct RateColumns *weighed_columns(Generation *g);
void write_weighed_columns(Generation *g, Text *out);
/* wheel_columns.c: the same through wheels; nothing for models without fast states. */
extern const Insertions columns_wheels_points, columns_wheel_points;
void write_wheel_columns(Generation *g, Text *out);
/* For spread.c: the call of the function of a subset; functions of the classes of wheels; the call for a member of one;
 * what moves wheels, with its derivatives; the powertrain. */
/* act[] from 6 on: accelerations of the coordinates that a subset depends on, from acc[] and u[]. */
void write_accelerations_of(const Generation *g, Text *out, int indent, const Subset *subset);
void write_columns_turn(void *context, Text *out, int indent);
void write_columns_call(Generation *g, Text *out, int indent, int subset);
void write_wheel_column_classes(void *context, Text *out, int indent);
void write_wheel_columns_call(Generation *g, Text *out, int indent, int class, int member);
Block wheel_columns_link(Generation *g);
void write_drive_columns(void *context, Text *out, int indent);

/* spread.c: weighed columns and factors in pieces for many steps, with Style.spread: numbers of the instance beside
 * those of other implicit steps, as text; work space, functions and table of the pieces of the columns; the same of
 * the factors; the end of the table for the runtime. */
extern const Insertions share_points, side_points;
bool is_spread(Generation *g);
const char *spread_numbers(Generation *g);
void write_shares_work(void *context, Text *out, int indent);
void write_side_by_side(void *context, Text *out, int indent);
void write_shares(void *context, Text *out, int indent);
void write_shares_table(void *context, Text *out, int indent);
void write_factor_shares(void *context, Text *out, int indent);
void write_factor_table(void *context, Text *out, int indent);
void write_share_work_table(void *context, Text *out, int indent);

/* eliminate.c: factors and solutions of the linear systems of implicit steps. unknown: [unknowns] states; position:
 * [unknowns] the state whose rate each is, -1: none. */
bool elimination_is_short(Generation *g, int unknowns, const int *unknown, const int *position);
void write_elimination_factors(Generation *g, Text *out, int indent, int unknowns, const int *unknown,
                               const int *position);
/* Rows `first` to end - 1 of the factors alone; the products that a row takes. */
void write_elimination_rows(Generation *g, Text *out, int indent, int unknowns, const int *unknown, const int *position,
                            int first, int end);
int elimination_work(Generation *g, int unknowns, const int *unknown, const int *position, int row);
void write_elimination_solution(Generation *g, Text *out, int indent, int unknowns, const int *unknown,
                                const int *position);

/* implicit.c: what Style.implicit adds: sizes, members of the instance, functions and tables, the descriptor's end. */
extern const Insertions implicit_points;
/* The unknowns in the order of the state, and the states whose rates they are; returns how many. */
int implicit_unknowns(const Generation *g, int **unknown, int **position);
/* Are the factors straight-line code? */
bool implicit_is_short(Generation *g);
void write_implicit_sizes(Generation *g, Text *out, int indent);
void write_implicit_members(void *context, Text *out, int indent);
void write_exponential_member(void *context, Text *out, int indent);
void write_implicit_code(Generation *g, Text *out);
void write_implicit(void *context, Text *out, int indent);

/* tables.c: the tables that the descriptor points to. */
void write_tables(void *context, Text *out, int indent);
/* Of the descriptor: how many controllers, and where they are. */
void write_controllers(void *context, Text *out, int indent);
/* The same of contacts. */
void write_contacts(void *context, Text *out, int indent);

/* specialized.c: insertion points of checks of assumptions, and of the road. */
extern const Insertions assumption_points, road_points;
/* For the code of one scene; for other code only write_condition writes text. */
int conditions(const Generation *g);                   /* texts of conditions and assumptions */
void write_assumption_texts(Generation *g, Text *out); /* they follow the texts of conditions */
void write_narrowing(Generation *g, Text *out);        /* for the comment at the head of the file */
void write_road(Generation *g, Text *out);             /* the function that looks it up */
/* Insertions: the place among the texts of the assumption that both sides have the same road; the same in a lane. */
void write_across(void *context, Text *out, int indent);
void write_across_lane(void *context, Text *out, int indent);
const char *friction_template(const Generation *g);           /* of the function that looks friction up */
const char *vectors_road_template(const Generation *g);       /* of the one that looks roads up under wheels in lanes */
void write_assumptions(void *context, Text *out, int indent); /* the functions that check them */
void write_assume(Generation *g, Text *out, int indent, AssumptionAbout about); /* the call of this function */
void write_images(void *context, Text *out, int indent);    /* copies the numbers of wheels from their mirror images */
void write_condition(void *context, Text *out, int indent); /* the text that the last status is about */
/* The same of code for many vehicles. */
extern const Insertions lane_assumption_points, lane_road_points;
void write_batch_assumptions(void *context, Text *out, int indent);
void write_batch_assume(Generation *g, Text *out, int indent, AssumptionAbout about);
void write_batch_road(Generation *g, Text *out);
const char *batch_friction_template(const Generation *g);
void write_batch_images(void *context, Text *out, int indent);
void write_batch_assumed(void *context, Text *out,
                         int indent); /* at set-up: the code for one takes the same for granted */

/* wheels.c, wheel_lanes.c, powertrain.c: insertion points of their templates. */
extern const Insertions wheels_points, wheel_points, dual_rate_points, states_points, states_rate_points;
extern const Insertions wheel_lanes_points, wheel_vector_points;
extern const Insertions powertrain_points;

/* wheels.c: these write nothing if no wheel has a tire, except the end of the descriptor. */
void write_wheels(void *context, Text *out, int indent); /* functions of the wheels, before the equations of motion */
/* True for a model that has wheels with tires; else, if it has fast states, the model's own are all of them. */
bool wheels_roll(const Generation *g);
void write_wheel_functions(void *context, Text *out, int indent); /* functions for the descriptor */
void write_dual_rate(void *context, Text *out, int indent);
void write_wheel_sizes(Generation *g, Text *out, int indent);
void write_wheel_members(void *context, Text *out, int indent); /* of the instance */
void wheel_counts(Generation *g, Text *out, const Figures *figures);

/* A line that names the inputs `u` if wheels stand on posts, whose heights are inputs. */
void write_posts_input(const Generation *g, Text *out, int indent, const char *real);

/* The statements of a block in which rate[] are rates of fast states, of one wheel or of all. */
void write_fast_block(const Generation *g, Text *out, const Block *block, NamingScope scope, Constants *constants,
                      int indent);

/* wheel_lanes.c: number of lanes in which the wheels of a class are computed; 1: one after another. */
int wheel_lanes(const Generation *g, const WheelClass *class);
/* The types and functions of all widths, before the classes; a class's function with its constants; the calls of it. */
void write_wheel_vectors(Generation *g, Text *out);
void write_wheel_class_lanes(Generation *g, Text *out, const WheelClass *class);
void write_wheel_lane_calls(Generation *g, Text *out, int indent, const WheelClass *class);
/* The comment that describes the numbers of a class's arrays. */
void write_wheel_comment(const Generation *g, Text *out, const WheelClass *class);
/* contact[] of a wheel's function. */
void write_contact_array(Text *out, int indent, const char *real);

/* powertrain.c: these write nothing if the model has no powertrain. */
void write_powertrain(void *context, Text *out, int indent);  /* its functions, after those of each wheel */
void write_drive(void *context, Text *out, int indent);       /* their call after all wheels */
void write_shift(Generation *g, Text *out);                   /* functions for the descriptor */
void write_start_gears(void *context, Text *out, int indent); /* discrete states at set-up */
void write_powertrain_sizes(Generation *g, Text *out, int indent);
/* Lines of its functions: ratios of the gears, duration and latency of a change, statements. */
void write_ratios(void *context, Text *out, int indent);
void write_shift_times(void *context, Text *out, int indent);
void write_drive_lines(void *context, Text *out, int indent);
void write_drive_unused(void *context, Text *out, int indent); /* of what a scene may not need */
void write_shift_lines(void *context, Text *out, int indent);
void write_powertrain_members(Generation *g, Text *out, int indent); /* of the instance */

#endif
