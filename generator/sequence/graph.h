/* SPDX-License-Identifier: MIT
 *
 * The weighted graph of a model (Serban and Haug 2000, section 4), private to graph.c and sequence.c. Vertices are
 * the bodies that move relative to the base; edges are first the joints, then the dual coordinates.
 *
 * A body counts 6 unknowns here: its normalization equation touches nothing else, so it always determines one
 * of the body's 7 Euler-parameter coordinates and never decides how bodies hang together. The same holds for the one
 * dependent parameter of a free base: the base is known to every edge.
 */
#ifndef SEQUENCE_GRAPH_H
#define SEQUENCE_GRAPH_H

#include "model/model.h"

enum { BODY_UNKNOWNS = 6 };

typedef struct Edge {
    int end[2];  /* body, or -1: the base or ground */
    int weight;  /* equations */
    int rows[2]; /* how many of them determine which end; graph_match decides */
} Edge;

typedef struct Graph {
    Pool *pool;
    const Model *model;
    int edges;
    Edge *edge;
    int *first;    /* [bodies + 1] where the ends of a body begin in `incident` */
    int *incident; /* 2 * edge + side for every moving end */
} Graph;

/* Unmatched graph: every edge's equations are given to one of its ends. */
Graph *graph_new(Pool *pool, const Model *model);
/* Distribute the equations so that every body gets as many as it has unknowns. Where that is impossible, diag_fail. */
void graph_match(Graph *graph);
/* Strongly connected components of "is determined by equations that refer to". Fills component[bodies] with numbers
 * from 0 in computational order (base: -1) and returns how many there are. Needs a matched graph. */
int graph_components(const Graph *graph, int *component);

#endif
