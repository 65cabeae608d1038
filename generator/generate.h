/* SPDX-License-Identifier: MIT
 *
 * What the files that fill the templates share. */
#ifndef GENERATE_H
#define GENERATE_H

#include "narrow.h"

typedef struct Generation {
    Pool *pool;
    const Formulation *formulation;
    const Model *model; /* these three are the formulation's */
    const Sequence *sequence;
    const Plan *plan;
    const Style *style;
    const char *templates, *header, *upper;
    const char *guard;    /* macro of the header */
    uint32_t pair;        /* its value, which the C asks for: no half of another pair passes; 0: not known yet */
    int class;            /* the one whose template is being expanded */
    Constants *constants; /* [classes] */
    Constants packed;     /* of the equations of motion in lanes */
} Generation;

/* generate.c: what g->pair becomes: a number that all of the header gives, by its template and what that needs. */
uint32_t header_number(const Generation *g, const char *name, Insert *insert, void *context);
void write_guard(const Generation *g, Text *out);
/* One line of text. */
void line(Text *out, int indent, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Elements of an array that would be empty: one. */
int room(int count);
/* Numbers in the state, fast ones too. */
int states(const Generation *g);
/* A string as a C literal; every second question mark is escaped, so that no trigraph arises. */
const char *quoted(Pool *pool, const char *s);
/* Capitals, and everything that is no letter or digit an underscore. */
const char *capital(Pool *pool, const char *s);
/* The table `name` of a class's constants, a row a member. */
void write_constants(Generation *g, Text *out, const char *name, const Dag *dag, const Constants *k,
                     const char *const *member);
/* A line of the table of operations. */
void count_line(Text *out, const char *what, Count c);
/* What the insertion points of model.c.in, and of subset.c.in for the class g->class, get; context: the Generation. */
void insert_code(void *context, const char *name, Text *out, int indent);
void insert_subset(void *context, const char *name, Text *out, int indent);
/* The constants of that class that text so far refers to. */
void write_class_constants(Generation *g, Text *out);
/* Are the members of a class solved side by side? */
bool class_in_lanes(const Generation *g, int class);
/* How many bodies are followed by Newton's iteration. */
int followed_bodies(const Plan *plan);

/* generate_recovery.c: calls of the subsets' functions, in recover_piece and residual; of those that find reactions;
 * coordinates and rates from state and inputs; changes followed in one piece; design poses of followed bodies; the
 * initial state. */
void write_recovery_calls(Generation *g, Text *out, int indent);
/* C for the change of a coordinate in one piece, m or rad: the difference, or where an angle may have whole turns in it
 * the text `unwinding` with the difference for its %s. */
const char *change_text(const Generation *g, const char *unwinding, int coordinate);
/* Lines that take whole turns out of way[], the changes since the start, where one is out of reach with them; lanes: of
 * many vehicles. */
void write_unwinding(const Generation *g, Text *out, int indent, bool lanes);
void write_residuals(Generation *g, Text *out, int indent);
void write_react_calls(Generation *g, Text *out, int indent);
void write_gathered(Generation *g, Text *out, int indent);
void write_pieces(Generation *g, Text *out, int indent);
void write_design(Generation *g, Text *out, int indent);
void write_initial(Generation *g, Text *out, int indent);

/* generate_lanes.c: of a plan in lanes. Vectors; links of subsets side by side; the function of class g->class; its
 * call, where a subset is the first of its row. */
void write_lane_types(Generation *g, Text *out);
void write_lane_road(Generation *g, Text *out);
void write_lane_links(Generation *g, Text *out);
void write_lane_class(Generation *g, Text *out);
void write_lane_call(const Generation *g, Text *out, int indent, int subset);
/* What the equations of motion in lanes need in front of them. */
void write_packed(Generation *g, Text *out);
/* Numbers of one subset as an array without gaps: where they stand, or copied to `room`. */
const char *alone_text(const Generation *g, const char *room, const char *array, int offset, int stride, int count);

/* generate_tables.c: what the descriptor points to. */
void write_tables(Generation *g, Text *out);

/* generate_narrow.c: of code for one scene, nothing of other code but for `condition`. */
int conditions(const Generation *g);                   /* texts of conditions and assumptions */
void write_assumption_texts(Generation *g, Text *out); /* behind those of conditions */
void write_narrowing(Generation *g, Text *out);        /* for the comment in front */
void write_road(Generation *g, Text *out);             /* the function that looks it up */
const char *friction_template(const Generation *g);    /* of the function that looks friction up */
void write_assumptions(Generation *g, Text *out);      /* the functions that check them */
void write_assume(Generation *g, Text *out, int indent, AssumptionAbout about); /* the call of it */
void write_images(Generation *g, Text *out, int indent);    /* what wheels do whose images are computed */
void write_condition(Generation *g, Text *out, int indent); /* which text the last status is about */

/* generate_wheels.c: nothing where no wheel has a tire, but for the end of the descriptor. */
void write_wheels(Generation *g, Text *out);          /* functions of the wheels, before the equations of motion */
void write_wheel_functions(Generation *g, Text *out); /* what the descriptor calls */
void write_dual_rate(Generation *g, Text *out, int indent);
void write_wheel_sizes(Generation *g, Text *out, int indent);
void write_wheel_members(Generation *g, Text *out, int indent); /* of the instance */
void wheel_counts(Generation *g, Text *out, const Figures *figures);

/* generate_wheel_lanes.c: in how many lanes the wheels of a class are computed, 1: one after another. */
int wheel_lanes(const Generation *g, const WheelClass *class);
/* The types and functions of all widths, before the classes; a class's function with its constants; the calls of it. */
void write_wheel_vectors(Generation *g, Text *out);
void write_wheel_class_lanes(Generation *g, Text *out, const WheelClass *class);
void write_wheel_lane_calls(Generation *g, Text *out, int indent, const WheelClass *class);
/* What the numbers of a class's arrays are, as a comment. */
void write_wheel_comment(const Generation *g, Text *out, const WheelClass *class);

/* generate_powertrain.c: nothing where there is none. */
void write_powertrain(Generation *g, Text *out);              /* its functions, after those of each wheel */
void write_drive(Generation *g, Text *out, int indent);       /* the call of them after all wheels */
void write_shift(Generation *g, Text *out);                   /* what the descriptor calls */
void write_start_gears(Generation *g, Text *out, int indent); /* discrete states at set-up */
void write_powertrain_sizes(Generation *g, Text *out, int indent);
void write_powertrain_members(Generation *g, Text *out, int indent); /* of the instance */

#endif
