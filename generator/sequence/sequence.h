/* SPDX-License-Identifier: MIT
 *
 * sequence: from the model to the subsets that are solved one after another. */
#ifndef SEQUENCE_SEQUENCE_H
#define SEQUENCE_SEQUENCE_H

#include "model/model.h"

typedef struct Text Text; /* base/text.h */

/* ---- graph.c, sequence.c, print.c: which subsets can be solved, and in which order */

/* A decoupled subset (Serban and Haug 2000, section 4): as many equations as unknowns once the bodies before it are
 * known. */
typedef struct Subset {
    int stage;                    /* from 1 */
    int bodies, *body;            /* unknown bodies, canonical order; the base alone in stage 1 of a free base */
    int joints, *joint;           /* their joints, canonical order */
    int coordinates, *coordinate; /* dual coordinates whose definition is among the equations, canonical order */
    int knowns, *known;           /* bodies other than the base, of earlier subsets, that a joint or coordinate refers
                                   * to */
    int carrier;                  /* BODY_BASE, or in a chained sequence the one body that the subset is connected to */
    int deps, *dep; /* coordinates that its bodies' motion relative to the carrier depends on: own ones first */
    int class;      /* isomorphism class, index into Sequence.class; -1 for the base */
} Subset;

/* Subsets that are alike in topology and joint types: position i of every list of one member corresponds to
 * position i of every other member's. */
typedef struct Class {
    const char *name;     /* identifier, from the first member's bodies */
    int members, *member; /* indices into Sequence.subset */
} Class;

typedef struct Sequence {
    int stages, subsets, classes;
    Subset *subset; /* in computational order */
    Class *class;
    int *body_subset;             /* [bodies] subset that yields a body */
    int unknowns, equations, dof; /* of the whole model in Euler parameters: 7 a body, normalizations counted */
    bool chained;                 /* some subset has a carrier other than the base */
} Sequence;

/* Find the finest sequence over whole bodies and joints. Over- and under-determined models end in diag_fail
 * naming the bodies, joints and coordinates concerned and what to add or remove. */
const Sequence *sequence_find(Pool *pool, const Model *model);
/* subset/anchor.c: the body in whose frame a subset is solved, or BODY_BASE. */
int subset_anchor(const Model *model, const Sequence *sequence, int subset);
/* The same sequence with carriers: a subset that hangs on one body other than the base is described relative to that
 * body, unless a subset with several known bodies needs it relative to the base. NULL: nothing hangs so. */
const Sequence *sequence_chain(Pool *pool, const Model *model, const Sequence *sequence);
/* Does a body of the subset carry another subset? */
bool sequence_carries(const Sequence *sequence, int subset);
/* Stages, subsets, unknowns, equations, joints, classes as a table for people. */
void sequence_print(Text *out, const Model *model, const Sequence *sequence);
/* Which member of a class a subset is, which body of a subset a body. */
int class_place(const Class *class, int subset);
int subset_place(const Subset *subset, int body);
/* The end (0 or 1) of a joint whose body is known where the other's is found; 0 where they are found together. */
int sequence_known_end(const Sequence *sequence, const Joint *joint);
/* Graphviz source of the weighted graph with its stages (the paper's Figs. 2 and 3). */
void graph_draw(Text *out, const Model *model, const Sequence *sequence);

/* A subset's coordinates and equations in Euler parameters, normalizations counted. */
void subset_shape(const Model *model, const Subset *subset, int *unknowns, int *equations);

/* graphviz.c: a Graphviz source as an SVG file, by Graphviz's `dot`. Exits with a message when that is missing or
 * fails.
 */
void picture_write(Pool *pool, const char *path, const Text *dot);
/* The same as text; false: `dot` is not installed. `path`: what it is for, for messages. */
bool picture_make(const char *path, const Text *dot, Text *svg);

/* dump.c: FORMAT.md section 11. */
void model_dump(Text *out, const Model *model, const Sequence *sequence);

#endif
