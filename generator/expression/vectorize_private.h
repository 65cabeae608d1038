/* SPDX-License-Identifier: MIT
 *
 * A block while it is packed: shared by the files that do that, and by no other. */
#ifndef EXPRESSION_VECTORIZE_PRIVATE_H
#define EXPRESSION_VECTORIZE_PRIVATE_H

#include "expression/expression.h"
#include "expression/vectorize.h"

/* Kind of an operand, the same in all tracks of a pack: a pack; a number; any literal or parameter; a node's index. */
typedef enum Kind { KIND_NONE, KIND_PACK, KIND_NUMBER, KIND_ANY, KIND_INDEX } Kind;

typedef struct Operand {
    Kind kind;
    uint32_t which;
} Operand;

/* Nodes of one shape. The first such node of every track make one group, the second ones the next group, and so on. */
typedef struct Shape {
    uint64_t input; /* colour of an input, else 0 */
    Op op;
    Operand operand[3];
    int group_of_tracks;
    int *met; /* [lanes] */
    int groups, *group;
} Shape;

typedef struct Group {
    const Shape *shape;
    Ex *member;    /* [lanes] 0: none */
    bool *swapped; /* [lanes] the operands of a sum or product stand the other way round */
    int members;
    bool usable;
} Group;

/* Terms of a sum. */
typedef struct Term {
    Ex e;
    bool minus;
} Term;

typedef struct Terms {
    int count;
    Term *term;
} Terms;

/* The sum of numbers in several lanes. */
typedef struct LaneSum {
    Ex node;  /* an input that stands for it */
    Ex *part; /* [lanes] 0: none */
} LaneSum;

typedef struct Packing {
    Pool *pool;
    const Block *block;
    const Dag *from; /* its graph */
    Dag *dag;        /* the same with sums in their new order */
    Dag *out;
    const LaneInput *input;
    int inputs, lanes;
    const bool *needed;        /* in `from` */
    int *from_track;           /* [from->nodes] -1: of none, or of several */
    int *uses;                 /* of the needed */
    bool *over;                /* sums over tracks */
    bool *summed;              /* used in a sum */
    Ex *same;                  /* [from->nodes] the node in dag */
    Terms *terms;              /* [from->nodes] of sums over tracks */
    int infos, *track, *group; /* [dag->nodes], filled as they come */
    bool *fixed;
    int shapes, shape_room, *shape_table;
    Shape **shape;
    int groups, sums;
    Group **group_of;
    LaneSum *sum;
    int wholes, *whole;  /* sums of all lanes of a vector, in the order in which they were made */
    int *fold;           /* [sums] those made together, -1: alone; NULL: not known yet */
    Ex *number, *vector; /* [dag->nodes], [groups] in out; 0: not yet (literal 0 is made anew each time) */
    bool *number_made, *vector_made;
} Packing;

/* The entry of an input that belongs to a track or is fixed; NULL: neither. */
const LaneInput *pack_input(const Packing *p, const Node *node);
/* True if a node of p->dag has the same value at all times. */
bool pack_is_fixed(const Packing *p, Ex e);
/* The operation of `node`, which may be of another graph, on these operands of `dag`. */
Ex pack_apply(Dag *dag, const Node *node, Ex a, Ex b, Ex c);

/* ---- vectorize_build.c, once all packs are known */

/* Set p->fold: the sums over lanes that are added together. */
void pack_find_folds(Packing *p);
/* Make the graph of the result, p->out, empty. */
void pack_begin(Packing *p);
/* Make the number in p->out that corresponds to a node of p->from, with all nodes that it needs. */
Ex pack_number(Packing *p, Ex from);

#endif
