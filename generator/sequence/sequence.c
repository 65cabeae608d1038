/* SPDX-License-Identifier: MIT
 * The computational sequence: subsets in stages, their canonical order, isomorphism classes. */
#include "base/random.h"
#include "base/text.h"
#include "model/model.h"
#include "sequence/graph.h"
#include "sequence/sequence.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Work space of a search for a sequence. The maps are scratch: -1 (or 0) between uses. */
typedef struct Finder {
    Pool *pool;
    const Model *model;
    Sequence *sequence;
    int *place;    /* [bodies] of the current subset: vertex of a body */
    int *position; /* [coordinates] of the current subset: index in dep */
    int *sharing;  /* [coordinates] how many knowns of the current subset depend on it */
} Finder;

static int *ints(Pool *pool, int count, int value)
{
    int *block = pool_alloc(pool, (size_t)count * sizeof *block);
    for (int i = 0; i < count && value; ++i)
        block[i] = value;
    return block;
}

static const Subset *subset_of(const Finder *finder, int body)
{
    return &finder->sequence->subset[finder->sequence->body_subset[body]];
}

/* ---- subsets and stages ----------------------------------------------------------------------- */

/* A component while the order of the sequence is determined. */
typedef struct Slot {
    int stage, first_body, component;
} Slot;

static int compare_slots(const void *a, const void *b)
{
    const Slot *x = a, *y = b;
    return x->stage != y->stage ? (x->stage > y->stage) - (x->stage < y->stage)
                                : (x->first_body > y->first_body) - (x->first_body < y->first_body);
}

/* The component that an edge's equations belong to. */
static int edge_component(const Edge *edge, const int *component)
{
    return component[edge->end[edge->rows[0] > 0 ? 0 : 1]];
}

/* Stage of each component, and the components sorted by stage, then by their first body in the file. */
static Slot *slots_sort(const Graph *graph, const int *component, int count)
{
    Pool *pool = graph->pool;
    int bodies = graph->model->bodies;
    Slot *slot = pool_alloc(pool, (size_t)count * sizeof *slot);
    /* bodies by component: the components are in computational order */
    int *first = ints(pool, count + 1, 0), *member = ints(pool, bodies, 0);
    for (int i = 1; i < bodies; ++i)
        first[component[i] + 1]++;
    for (int i = 0; i < count; ++i) {
        first[i + 1] += first[i];
        slot[i] = (Slot){.stage = graph->model->free_base ? 2 : 1, .component = i};
    }
    int *next = ints(pool, count, 0);
    for (int i = 1; i < bodies; ++i)
        member[first[component[i]] + next[component[i]]++] = i;
    for (int c = 0; c < count; ++c) {
        slot[c].first_body = member[first[c]];
        for (int m = first[c]; m < first[c + 1]; ++m)
            for (int i = graph->first[member[m]]; i < graph->first[member[m] + 1]; ++i) {
                const Edge *edge = &graph->edge[graph->incident[i] / 2];
                int other = edge->end[1 - graph->incident[i] % 2];
                if (other >= 0 && component[other] != c && edge_component(edge, component) == c &&
                    slot[c].stage <= slot[component[other]].stage)
                    slot[c].stage = slot[component[other]].stage + 1;
            }
    }
    qsort(slot, (size_t)count, sizeof *slot, compare_slots);
    return slot;
}

/* Subsets with their bodies, joints and coordinates in the order of the file. */
static void subsets_fill(Finder *finder, const Graph *graph, const int *component, const Slot *slot, int count)
{
    const Model *model = finder->model;
    Sequence *sequence = finder->sequence;
    int base = model->free_base, *subset_at = ints(finder->pool, count, 0);
    sequence->subsets = count + base;
    sequence->subset = pool_alloc(finder->pool, (size_t)sequence->subsets * sizeof *sequence->subset);
    sequence->body_subset = ints(finder->pool, model->bodies, -1);
    for (int i = 0; i < count; ++i)
        subset_at[slot[i].component] = i + base;
    for (int i = 0; i < count; ++i)
        sequence->subset[i + base].stage = slot[i].stage;
    if (base) {
        sequence->subset[0] = (Subset){.stage = 1, .class = -1};
        sequence->body_subset[BODY_BASE] = 0;
    }
    for (int i = 1; i < model->bodies; ++i)
        sequence->body_subset[i] = subset_at[component[i]];
    for (int i = 0; i < model->bodies; ++i)
        if (sequence->body_subset[i] >= 0) {
            Subset *subset = &sequence->subset[sequence->body_subset[i]];
            *POOL_PUSH(finder->pool, subset->body, subset->bodies) = i;
        }
    for (int i = 0; i < graph->edges; ++i) {
        Subset *subset = &sequence->subset[subset_at[edge_component(&graph->edge[i], component)]];
        if (i < model->joints)
            *POOL_PUSH(finder->pool, subset->joint, subset->joints) = i;
        else
            *POOL_PUSH(finder->pool, subset->coordinate, subset->coordinates) = i - model->joints;
    }
    for (int i = 0; i < sequence->subsets; ++i)
        if (sequence->subset[i].stage > sequence->stages)
            sequence->stages = sequence->subset[i].stage;
}

/* ---- canonical order -------------------------------------------------------------------------- */

/* The bodies, knowns, joints and coordinates of a subset are the vertices of a graph, which gets an order that does not
 * depend on the file: colour refinement. A vertex's colour is a hash of all that distinguishes it; each round mixes in
 * the colours of its neighbours. Colours decide the order only: members of a class are found by their signatures. */
typedef enum VertexKind { VERTEX_BODY, VERTEX_KNOWN, VERTEX_JOINT, VERTEX_COORDINATE } VertexKind;

typedef struct Vertex {
    VertexKind kind;
    int rank;   /* of its kind, the first criterion of the order, so that it is plain: smallest first */
    int index;  /* in the model */
    int id;     /* position before sorting; ends refer to it */
    int end[2]; /* joint, coordinate: vertices, or -1: the base */
    uint64_t colour, next;
} Vertex;

static uint64_t mix(uint64_t x)
{
    return random_bits(&(Random){x});
}

/* Ends of joints and coordinates never count as interchangeable, not even for a spherical joint or a distance: the code
 * of a class is written once, for the ends as the first member has them. */
static void refine_round(Vertex *vertex, int count)
{
    for (int i = 0; i < count; ++i)
        vertex[i].next = mix(vertex[i].colour);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < 2 && vertex[i].kind >= VERTEX_JOINT; ++k) {
            uint64_t side = (uint64_t)k + 1;
            if (vertex[i].end[k] >= 0)
                vertex[vertex[i].end[k]].next += mix(mix(vertex[i].colour) + side);
            vertex[i].next += mix((vertex[i].end[k] >= 0 ? mix(vertex[vertex[i].end[k]].colour) : 0) + 2 + side);
        }
    for (int i = 0; i < count; ++i)
        vertex[i].colour = vertex[i].next;
}

static int compare_vertices(const void *a, const void *b)
{
    const Vertex *x = a, *y = b;
    if (x->kind != y->kind)
        return x->kind > y->kind ? 1 : -1;
    if (x->rank != y->rank)
        return x->rank > y->rank ? 1 : -1;
    if (x->colour != y->colour)
        return x->colour > y->colour ? 1 : -1;
    return (x->index > y->index) - (x->index < y->index);
}

static bool same_colour(const Vertex *a, const Vertex *b)
{
    return a->kind == b->kind && a->rank == b->rank && a->colour == b->colour;
}

/* Fill `sorted` with the vertices in order; returns the number of colours, and in *tied the first vertex with a colour
 * that is not unique (an id, -1: all are). */
static int colours_sort(const Vertex *vertex, int count, Vertex *sorted, int *tied)
{
    int colours = count > 0;
    memcpy(sorted, vertex, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare_vertices);
    *tied = -1;
    for (int i = 1; i < count; ++i)
        if (!same_colour(&sorted[i - 1], &sorted[i]))
            ++colours;
        else if (*tied < 0)
            *tied = sorted[i - 1].id;
    return colours;
}

/* Refine until each vertex has a colour of its own. If refinement can't distinguish vertices, the first one in the file
 * is chosen: they are usually interchangeable, and then any choice gives the same order. */
static void vertices_order(Vertex *vertex, int count, Vertex *sorted)
{
    int tied, colours = 0;
    for (;;) {
        int refined = colours_sort(vertex, count, sorted, &tied);
        if (tied < 0)
            return;
        if (refined == colours)
            vertex[tied].colour = mix(vertex[tied].colour + 1);
        colours = refined;
        refine_round(vertex, count);
    }
}

static const int *edge_bodies(const Model *model, VertexKind kind, int index)
{
    return kind == VERTEX_JOINT ? model->joint[index].body : model->coordinate[index].body;
}

/* Enter a vertex; for a joint or coordinate also the known bodies that it refers to. */
static void vertex_add(Finder *finder, Vertex **vertex, int *count, VertexKind kind, int index)
{
    Vertex new = {.kind = kind, .index = index, .id = *count};
    if (kind <= VERTEX_KNOWN)
        finder->place[index] = new.id;
    *POOL_PUSH(finder->pool, *vertex, *count) = new;
    if (kind <= VERTEX_KNOWN)
        return;
    const int *body = edge_bodies(finder->model, kind, index);
    for (int k = 0; k < 2; ++k)
        if (body[k] > BODY_BASE && finder->place[body[k]] < 0)
            vertex_add(finder, vertex, count, VERTEX_KNOWN, body[k]);
}

/* Count (step 1) or remove (step -1) the knowns that share each coordinate. */
static void knowns_share(Finder *finder, const Vertex *vertex, int count, int step)
{
    for (int i = 0; i < count; ++i)
        if (vertex[i].kind == VERTEX_KNOWN) {
            const Subset *subset = subset_of(finder, vertex[i].index);
            for (int d = 0; d < subset->deps; ++d)
                finder->sharing[subset->dep[d]] += step;
        }
}

/* Rank and ends of a joint or coordinate; a body's rank is the number of equations between it and known bodies. */
static void edge_rank(const Finder *finder, Vertex *vertex, Vertex *edge)
{
    const int *body = edge_bodies(finder->model, edge->kind, edge->index);
    bool joint = edge->kind == VERTEX_JOINT;
    edge->rank = joint ? (int)finder->model->joint[edge->index].type : (int)finder->model->coordinate[edge->index].type;
    bool inner = true;
    for (int k = 0; k < 2; ++k) {
        edge->end[k] = body[k] > BODY_BASE ? finder->place[body[k]] : -1;
        inner &= edge->end[k] >= 0 && vertex[edge->end[k]].kind == VERTEX_BODY;
    }
    for (int k = 0; k < 2 && !inner; ++k)
        if (edge->end[k] >= 0 && vertex[edge->end[k]].kind == VERTEX_BODY)
            vertex[edge->end[k]].rank -= joint ? joint_equations[edge->rank] : 1;
}

/* Ranks, ends and first colours. The rank of a known is the number of its coordinates; its first colour includes how
 * many of them it shares with other knowns. The carrier's motion does not count. */
static void vertices_paint(Finder *finder, Vertex *vertex, int count, int carrier)
{
    knowns_share(finder, vertex, count, 1);
    for (int i = 0; i < count; ++i)
        if (vertex[i].kind >= VERTEX_JOINT)
            edge_rank(finder, vertex, &vertex[i]);
        else if (vertex[i].kind == VERTEX_KNOWN && vertex[i].index != carrier)
            vertex[i].rank = subset_of(finder, vertex[i].index)->deps;
    for (int i = 0; i < count; ++i) {
        uint64_t shared = 0;
        if (vertex[i].kind == VERTEX_KNOWN) {
            const Subset *subset = subset_of(finder, vertex[i].index);
            for (int d = 0; d < subset->deps; ++d)
                shared += finder->sharing[subset->dep[d]] > 1;
        }
        vertex[i].colour = mix(mix(mix((uint64_t)vertex[i].kind) + (uint64_t)vertex[i].rank) + shared);
    }
    knowns_share(finder, vertex, count, -1);
}

static void dep_add(Finder *finder, Subset *subset, int coordinate)
{
    if (finder->position[coordinate] >= 0)
        return;
    finder->position[coordinate] = subset->deps;
    subset->dep[subset->deps++] = coordinate;
}

/* Own coordinates, then those of the knowns but for a carrier, then those that joints follow, each once. Leaves their
 * positions in finder->position. */
static void deps_fill(Finder *finder, Subset *subset)
{
    int most = subset->coordinates + finder->model->coordinates;
    for (int i = 0; i < subset->knowns; ++i)
        most += subset_of(finder, subset->known[i])->deps;
    subset->dep = ints(finder->pool, most, 0);
    for (int i = 0; i < subset->coordinates; ++i)
        dep_add(finder, subset, subset->coordinate[i]);
    for (int i = 0; i < subset->knowns; ++i) {
        const Subset *known = subset_of(finder, subset->known[i]);
        for (int d = 0; d < known->deps && subset->known[i] != subset->carrier; ++d)
            dep_add(finder, subset, known->dep[d]);
    }
    for (int i = 0; i < subset->joints; ++i)
        for (int c = 0; c < finder->model->coordinates; ++c)
            if (joint_follows(&finder->model->joint[subset->joint[i]], c))
                dep_add(finder, subset, c);
}

/* Find the knowns and dependences of a subset and bring its lists into canonical order. */
static void subset_order(Finder *finder, Subset *subset)
{
    Vertex *vertex = NULL;
    int count = 0;
    for (int i = 0; i < subset->bodies; ++i)
        vertex_add(finder, &vertex, &count, VERTEX_BODY, subset->body[i]);
    for (int i = 0; i < subset->joints; ++i)
        vertex_add(finder, &vertex, &count, VERTEX_JOINT, subset->joint[i]);
    for (int i = 0; i < subset->coordinates; ++i)
        vertex_add(finder, &vertex, &count, VERTEX_COORDINATE, subset->coordinate[i]);
    vertices_paint(finder, vertex, count, subset->carrier);
    Vertex *sorted = pool_alloc(finder->pool, (size_t)count * sizeof *sorted);
    vertices_order(vertex, count, sorted);
    subset->knowns = count - subset->bodies - subset->joints - subset->coordinates;
    subset->known = ints(finder->pool, subset->knowns, 0);
    int *list[] = {subset->body, subset->known, subset->joint, subset->coordinate};
    for (int i = 0; i < count; ++i) {
        *list[sorted[i].kind]++ = sorted[i].index;
        if (sorted[i].kind <= VERTEX_KNOWN)
            finder->place[sorted[i].index] = i;
    }
}

/* ---- isomorphism classes ---------------------------------------------------------------------- */

/* The numbers that the code of a subset depends on; subsets of one class have the same. */
typedef struct Signature {
    int subset, size, *number;
} Signature;

static void signature_add(Finder *finder, Signature *signature, int number)
{
    *POOL_PUSH(finder->pool, signature->number, signature->size) = number;
}

static void signature_add_edge(Finder *finder, Signature *signature, int type, const int body[2])
{
    signature_add(finder, signature, type);
    for (int k = 0; k < 2; ++k)
        signature_add(finder, signature, body[k] > BODY_BASE ? finder->place[body[k]] : -1);
}

/* Positions of a known's coordinates among the subset's: runs of consecutive ones, since there may be many. */
static void signature_add_known(Finder *finder, Signature *signature, const Subset *known)
{
    signature_add(finder, signature, known->deps);
    for (int i = 0, run; i < known->deps; i += run) {
        int at = finder->position[known->dep[i]];
        for (run = 1; i + run < known->deps && finder->position[known->dep[i + run]] == at + run; ++run)
            continue;
        signature_add(finder, signature, at);
        signature_add(finder, signature, run);
    }
}

/* The signature of a subset whose order, places and positions are in the finder. */
static Signature signature_make(Finder *finder, int index)
{
    const Model *model = finder->model;
    const Subset *subset = &finder->sequence->subset[index];
    Signature signature = {.subset = index};
    const int counts[] = {subset->bodies, subset->knowns, subset->joints, subset->coordinates};
    for (int i = 0; i < 4; ++i)
        signature_add(finder, &signature, counts[i]);
    for (int i = 0; i < subset->joints; ++i) {
        const Joint *joint = &model->joint[subset->joint[i]];
        signature_add_edge(finder, &signature, (int)joint->type, joint->body);
        if (joint->value) /* its formula is its own */
            signature_add(finder, &signature, subset->joint[i]);
    }
    for (int i = 0; i < subset->coordinates; ++i) {
        const Coordinate *coordinate = &model->coordinate[subset->coordinate[i]];
        signature_add_edge(finder, &signature, (int)coordinate->type, coordinate->body);
    }
    for (int i = 0; i < subset->knowns; ++i)
        if (subset->known[i] == subset->carrier)
            signature_add(finder, &signature, -1);
        else
            signature_add_known(finder, &signature, subset_of(finder, subset->known[i]));
    return signature;
}

/* Equal signatures next to each other, members in computational order. */
static int compare_signatures(const void *a, const void *b)
{
    const Signature *x = a, *y = b;
    if (x->size != y->size)
        return x->size > y->size ? 1 : -1;
    int order = memcmp(x->number, y->number, (size_t)x->size * sizeof *x->number);
    return order ? order : (x->subset > y->subset) - (x->subset < y->subset);
}

/* Forget places and positions of a subset. */
static void finder_clear(Finder *finder, const Subset *subset)
{
    for (int i = 0; i < subset->bodies; ++i)
        finder->place[subset->body[i]] = -1;
    for (int i = 0; i < subset->knowns; ++i)
        finder->place[subset->known[i]] = -1;
    for (int i = 0; i < subset->deps; ++i)
        finder->position[subset->dep[i]] = -1;
}

enum { NAME_SIZE = 40 };

static bool name_taken(const Sequence *sequence, int classes, const char *name)
{
    for (int i = 0; i < classes; ++i)
        if (!strcmp(sequence->class[i].name, name))
            return true;
    return false;
}

/* The name of a class: the bodies of its first member, with a number if that is not unique. */
static const char *class_name(Finder *finder, int class)
{
    const Sequence *sequence = finder->sequence;
    const Subset *subset = &sequence->subset[sequence->class[class].member[0]];
    Text text = {.pool = finder->pool};
    for (int i = 0; i < subset->bodies && text.size < NAME_SIZE; ++i)
        text_print(&text, "%s%s", i ? "_" : "", finder->model->body[subset->body[i]].name);
    const char *name = pool_print(finder->pool, "%.*s", NAME_SIZE, text.s);
    for (int number = 2; name_taken(sequence, class, name); ++number) {
        char suffix[16];
        int size = snprintf(suffix, sizeof suffix, "_%d", number);
        name = pool_print(finder->pool, "%.*s%s", NAME_SIZE - size, text.s, suffix);
    }
    return name;
}

/* Collect subsets of the same signature; classes in the order of their first members. */
static void classes_fill(Finder *finder, Signature *signature, int count)
{
    Sequence *sequence = finder->sequence;
    int *leader = ints(finder->pool, sequence->subsets, -1);
    qsort(signature, (size_t)count, sizeof *signature, compare_signatures);
    for (int i = 0, first = 0; i < count; ++i) {
        if (signature[i].size != signature[first].size ||
            memcmp(signature[i].number, signature[first].number, (size_t)signature[i].size * sizeof(int)))
            first = i;
        leader[signature[i].subset] = signature[first].subset;
    }
    for (int i = 0; i < sequence->subsets; ++i) {
        if (leader[i] < 0)
            continue;
        if (leader[i] == i) {
            sequence->subset[i].class = sequence->classes;
            *POOL_PUSH(finder->pool, sequence->class, sequence->classes) = (Class){0};
        }
        int class = sequence->subset[i].class = sequence->subset[leader[i]].class;
        *POOL_PUSH(finder->pool, sequence->class[class].member, sequence->class[class].members) = i;
    }
    for (int i = 0; i < sequence->classes; ++i)
        sequence->class[i].name = class_name(finder, i);
}

static int index_of(const int *list, int what)
{
    int i = 0;
    while (list[i] != what)
        ++i;
    return i;
}

int class_place(const Class *class, int subset)
{
    return index_of(class->member, subset);
}

int subset_place(const Subset *subset, int body)
{
    return index_of(subset->body, body);
}

int sequence_known_end(const Sequence *sequence, const Joint *joint)
{
    return sequence->body_subset[joint->body[0]] > sequence->body_subset[joint->body[1]];
}

/* carrier [subsets]; NULL: the base carries all. */
static const Sequence *find(Pool *pool, const Model *model, const int *carrier)
{
    Graph *graph = graph_new(pool, model);
    int *component = ints(pool, model->bodies, 0);
    Sequence *sequence = pool_alloc(pool, sizeof *sequence);
    Finder finder = {pool,
                     model,
                     sequence,
                     ints(pool, model->bodies, -1),
                     ints(pool, model->coordinates, -1),
                     ints(pool, model->coordinates, 0)};
    graph_match(graph);
    int count = graph_components(graph, component);
    subsets_fill(&finder, graph, component, slots_sort(graph, component, count), count);
    Signature *signature = pool_alloc(pool, (size_t)count * sizeof *signature);
    for (int i = 0; i < count; ++i) {
        Subset *subset = &sequence->subset[i + model->free_base];
        subset->carrier = carrier ? carrier[i + model->free_base] : BODY_BASE;
        subset_order(&finder, subset);
        deps_fill(&finder, subset);
        signature[i] = signature_make(&finder, i + model->free_base);
        finder_clear(&finder, subset);
    }
    classes_fill(&finder, signature, count);
    int bodies = model->bodies - !model->free_base; /* ground has neither unknowns nor a normalization */
    sequence->unknowns = 7 * bodies;
    sequence->equations = bodies;
    for (int i = 0; i < model->joints; ++i)
        sequence->equations += joint_equations[model->joint[i].type];
    sequence->dof = sequence->unknowns - sequence->equations;
    return sequence;
}

const Sequence *sequence_find(Pool *pool, const Model *model)
{
    return find(pool, model, NULL);
}

const Sequence *sequence_chain(Pool *pool, const Model *model, const Sequence *sequence)
{
    int *carrier = ints(pool, sequence->subsets, 0);
    bool any = false;
    for (int s = 0; s < sequence->subsets; ++s)
        carrier[s] = sequence->subset[s].class < 0 ? BODY_BASE : subset_anchor(model, sequence, s);
    /* knowns come before subsets that need their motion relative to the base */
    for (int s = sequence->subsets - 1; s >= 0; --s) {
        const Subset *subset = &sequence->subset[s];
        any = any || carrier[s] != BODY_BASE;
        for (int i = 0; carrier[s] == BODY_BASE && i < subset->knowns; ++i)
            carrier[sequence->body_subset[subset->known[i]]] = BODY_BASE;
    }
    if (!any)
        return NULL;
    Sequence *chained = (Sequence *)find(pool, model, carrier);
    chained->chained = true;
    return chained;
}

bool sequence_carries(const Sequence *sequence, int subset)
{
    for (int s = subset + 1; s < sequence->subsets; ++s)
        if (sequence->subset[s].carrier != BODY_BASE && sequence->body_subset[sequence->subset[s].carrier] == subset)
            return true;
    return false;
}

int subset_anchor(const Model *model, const Sequence *sequence, int subset)
{
    const Subset *own = &sequence->subset[subset];
    bool base = own->knowns != 1;
    for (int i = 0; i < own->joints; ++i)
        for (int end = 0; end < 2; ++end)
            base = base || model->joint[own->joint[i]].body[end] == BODY_BASE;
    for (int i = 0; i < own->coordinates; ++i)
        for (int end = 0; end < 2; ++end)
            base = base || model->coordinate[own->coordinate[i]].body[end] == BODY_BASE;
    return base ? BODY_BASE : own->known[0];
}
