/* SPDX-License-Identifier: MIT
 *
 * emit: blocks and templates become C. */
#ifndef EMIT_EMIT_H
#define EMIT_EMIT_H

#include "base/text.h"
#include "expression/expression.h"

typedef struct Source Source;           /* base/message.h */
typedef struct Model Model;             /* model/model.h */
typedef struct Formulation Formulation; /* vehicle/vehicle.h */

/* ---- block_text.c: blocks as C text */

/* Constants of a class in the order of their slots in k[]. */
typedef struct Constants {
    int count;
    Ex *e;
} Constants;

/* Which states implicit steps treat implicitly; the others go on explicitly. A coordinate and its rate are so together,
 * and so are the base's place and velocity, its Euler parameters and angular velocity. */
typedef struct Splitting {
    const bool *implicit; /* [states] */
    const char *told;     /* lines for people: which these are, and why */
    const char *summary;  /* one of them: how many, and the fastest motion that is left explicit */
} Splitting;

/* How the text looks. No style changes the order of operations: results are the same to the last bit. */
typedef struct Style {
    int leaves;           /* in one expression at most, a function's name counted as one: also bounds its nesting */
    bool doubles;         /* literals are doubles: 0.5; else of either number type: R(0.5) */
    bool whole_self_test; /* false: the self-test measures constraints alone */
    bool derivatives;     /* the file has functions for derivatives too; not for one scene */
    bool implicit;        /* what implicit steps need; the same */
    bool spread;          /* with `implicit`: a Jacobian may be evaluated in shares, one a step */
    const Splitting *splitting; /* with `implicit`: NULL: all states are implicit */
    bool exponential;           /* with `implicit`: room for exponential steps, too */
    bool exact;              /* with `implicit`: for integrators of a host, which want the Jacobian of accelerations */
    bool lanes;              /* numbers are vectors; a check that fails closes its lanes, and the function goes on */
    int width;               /* with `lanes`: lanes of a vector, with one subset a lane; 0: one vehicle a lane */
    const int *known_stride; /* [knowns] with a width: from one number of a known to its next, each a row of lanes;
                              * negative: one body is the known of all lanes */
    bool lane_constants;     /* with `lanes`: constants of members are vectors; false: one number for all lanes */
    const struct Naming *naming; /* enumerators for indices, names of temporaries; NULL: plain numbers */
    const char *prefix;          /* prefix of the functions and tables in the file; NULL: none */
} Style;

extern const Style style_readable, style_direct, style_lanes;

/* The type of a number. */
const char *style_real(const Style *style);

/* The statements of a block, each line led by `indent` spaces: temporaries in depth-first order from the results, or as
 * expression/schedule.c orders them, checks as soon as their values are there, stores at the end (a target may be read
 * before). Constants met on the way get slots. */
void block_emit(Text *out, const Block *block, const Style *style, Constants *constants, int indent);
/* Initializers of the checks that name a subset or a number of the state, in order: {status, subset, number of the
 * state}, */
void emit_abouts(Text *out, const Block *block, int indent);

/* ---- template.c: fixed text with insertion points */

/* Files built into the program: templates and the freestanding runtime. Ends with name NULL. */
typedef struct Embedded {
    const char *name, *bytes;
    size_t size;
} Embedded;

extern const Embedded embedded[];

/* The template `name` from the folder `templates`, or built in where that is NULL: a source, so that messages can show
 * its lines. */
const Source *template_source(Pool *pool, const char *templates, const char *name);

/* Where a template's line is nothing but `@name@` in a comment (of C or of HTML), `write` prints what belongs there,
 * with that line's indent. */
typedef struct Insertion {
    const char *name;
    void (*write)(void *context, Text *out, int indent);
} Insertion;

/* The insertion points of some templates. */
typedef struct Insertions {
    const char *const *template;      /* their names; ends with NULL */
    const Insertion *point;           /* ends with name NULL */
    const struct Insertions *general; /* serves the names that `point` does not have; NULL: an error */
} Insertions;

/* Expand the template `name` (from the folder `templates`, or built in where that is NULL): every word PREFIX becomes
 * `prefix`, UPPER the same in capitals, CLASS becomes `class`. Ends with a message at the line of an unknown point. */
void template_expand(Pool *pool, Text *out, const char *templates, const char *name, const char *prefix,
                     const char *class, const Insertions *points, void *context);
/* Check all templates of some tables, the list of which ends with NULL: every point of a template is known, and every
 * point of a table stands in one of its templates. Ends with a message otherwise. */
void templates_check(Pool *pool, const char *templates, const Insertions *const *points);

/* ---- model_file.c: all of it */

/* The generated C and its header. `header`: the name by which the C includes it, NULL: it doesn't. `templates` as
 * above. True: with style->spread, Jacobians can be made by shares. */
bool generate(Pool *pool, const Formulation *f, const Style *style, const char *templates, const char *header, Text *c,
              Text *h);

/* ---- batch.c: many vehicles at once */

/* Number of vehicles, of which `lanes` share a vector. */
typedef struct Batch {
    int vehicles, lanes;
} Batch;

/* The feature of the model that batches do not support, as text; NULL: all are supported. */
const char *batch_missing(const Formulation *formulation);
/* The C for many vehicles, and its header, which includes `model_header`, the header for one vehicle. */
void generate_batch(Pool *pool, const Formulation *formulation, const Batch *batch, const char *templates,
                    const char *model_header, const char *header, Text *c, Text *h);

/* ---- example.c: a program to start from */

/* A C program of less than 60 lines that includes `header` and runs the model for two seconds. */
void example_write(Pool *pool, const Model *model, const char *templates, const char *header, Text *out);

#endif
