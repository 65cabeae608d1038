/* SPDX-License-Identifier: MIT
 * Lane packing: a block of numbers as one of vectors, as far as it does the same to the numbers of several tracks (the
 * corners of a vehicle, say). Nodes of different tracks that are the same operation on packs, on the same numbers, or
 * on literals are a pack; what depends on more than one track is one number. Sums over tracks first add up each track's
 * terms, which are packs, and then those: their order changes, and nothing else. */
#include "pack.h"

#include <stdlib.h>
#include <string.h>

/* What an operand is, the same in all tracks of a pack: a pack; a number; any literal or parameter; a node's index. */
typedef enum Kind { KIND_NONE, KIND_PACK, KIND_NUMBER, KIND_ANY, KIND_INDEX } Kind;

typedef struct Operand {
    Kind kind;
    uint32_t which;
} Operand;

/* Nodes of one shape, met again and again in one track: the first of every track are a group, the second, ... */
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

/* The sum of what stands in several lanes. */
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

static bool is_sum(const Node *node)
{
    return node->op == OP_ADD || node->op == OP_SUB || node->op == OP_NEG;
}

static bool is_arithmetic(const Node *node)
{
    return is_sum(node) || node->op == OP_MUL || node->op == OP_DIV;
}

static int compare_inputs(const void *a, const void *b)
{
    return strcmp(((const LaneInput *)a)->name, ((const LaneInput *)b)->name);
}

static const LaneInput *find_input(const Packing *p, const char *name)
{
    const LaneInput key = {.name = name};
    return p->inputs ? bsearch(&key, p->input, (size_t)p->inputs, sizeof key, compare_inputs) : NULL;
}

/* ---- tracks and sums of the given graph ---------------------------------------------------------------------------
 */

/* One track from those of operands: none yet, another than before. */
static int joined(int track, int more)
{
    return track == -1 ? more : more == -1 || more == track ? track : -2;
}

static void find_tracks(Packing *p)
{
    const Dag *dag = p->from;
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        p->from_track[e] = -1;
        if (!p->needed[e] || node->level < LEVEL_VARIABLE)
            continue;
        if (node->op == OP_INPUT) {
            const LaneInput *input = find_input(p, node->name);
            p->from_track[e] = input ? input->track : -1;
            continue;
        }
        int track = -1;
        bool over = false;
        for (int i = 0; i < ex_arity((Op)node->op); ++i) {
            over = over || (is_sum(node) && p->over[node->arg[i]]);
            track = track == -2 ? track : joined(track, p->from_track[node->arg[i]]);
            ++p->uses[node->arg[i]];
            p->summed[node->arg[i]] = p->summed[node->arg[i]] || is_sum(node);
        }
        p->over[e] = is_sum(node) && (over || track == -2);
        p->from_track[e] = p->over[e] || track == -2 ? -1 : track;
    }
}

/* ---- packs
 * ----------------------------------------------------------------------------------------------------------- */

/* The same number at all times? */
static bool is_fixed(const Packing *p, Ex e)
{
    return p->dag->node[e].level < LEVEL_VARIABLE || p->fixed[e];
}

static bool is_free(const Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    return is_fixed(p, e) ||
           (node->op == OP_INPUT && (!strncmp(node->name, "p[", 2) || !strncmp(node->name, "self->derived[", 14)));
}

static Operand operand_of(const Packing *p, Ex e)
{
    if (is_free(p, e))
        return (Operand){KIND_ANY, 0};
    return p->track[e] < 0 ? (Operand){KIND_NUMBER, e} : (Operand){KIND_PACK, (uint32_t)p->group[e]};
}

static bool goes_before(Operand a, Operand b)
{
    return a.kind != b.kind ? a.kind < b.kind : a.which < b.which;
}

static uint64_t shape_hash(const Shape *s)
{
    uint64_t hash = s->input * 31 + (uint64_t)s->op + (uint64_t)s->group_of_tracks * 1000003u;
    for (int i = 0; i < 3; ++i)
        hash = (hash ^ ((uint64_t)s->operand[i].kind << 32) ^ s->operand[i].which) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 31);
}

static bool same_shape(const Shape *a, const Shape *b)
{
    bool same = a->input == b->input && a->op == b->op && a->group_of_tracks == b->group_of_tracks;
    for (int i = 0; i < 3; ++i)
        same = same && a->operand[i].kind == b->operand[i].kind && a->operand[i].which == b->operand[i].which;
    return same;
}

static void grow_shapes(Packing *p)
{
    p->shape_room = p->shape_room ? 2 * p->shape_room : 1024;
    p->shape_table = pool_alloc(p->pool, (size_t)p->shape_room * sizeof *p->shape_table);
    for (int i = 0; i < p->shapes; ++i) {
        uint64_t slot = shape_hash(p->shape[i]);
        while (p->shape_table[slot % (unsigned)p->shape_room])
            ++slot;
        p->shape_table[slot % (unsigned)p->shape_room] = i + 1;
    }
}

static Shape *find_shape(Packing *p, const Shape *wanted)
{
    if (2 * p->shapes >= p->shape_room)
        grow_shapes(p);
    uint64_t slot = shape_hash(wanted);
    for (int i; (i = p->shape_table[slot % (unsigned)p->shape_room]) != 0; ++slot)
        if (same_shape(p->shape[i - 1], wanted))
            return p->shape[i - 1];
    Shape *shape = pool_alloc(p->pool, sizeof *shape);
    *shape = *wanted;
    shape->met = pool_alloc(p->pool, (size_t)p->lanes * sizeof *shape->met);
    *POOL_PUSH(p->pool, p->shape, p->shapes) = shape;
    p->shape_table[slot % (unsigned)p->shape_room] = p->shapes;
    return shape;
}

static int find_group(Packing *p, Shape *shape, int lane)
{
    const int rank = shape->met[lane]++;
    if (rank == shape->groups) {
        Group *group = pool_alloc(p->pool, sizeof *group);
        *group = (Group){.shape = shape,
                         .member = pool_alloc(p->pool, (size_t)p->lanes * sizeof(Ex)),
                         .swapped = pool_alloc(p->pool, (size_t)p->lanes * sizeof(bool))};
        *POOL_PUSH(p->pool, shape->group, shape->groups) = p->groups;
        *POOL_PUSH(p->pool, p->group_of, p->groups) = group;
    }
    return shape->group[rank];
}

/* Track and group of a node whose operands have theirs. */
static void classify(Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    const LaneInput *input = node->op == OP_INPUT ? find_input(p, node->name) : NULL;
    Shape shape = {.op = (Op)node->op, .input = input ? input->colour : 0};
    int track = input ? input->track : -1;
    bool swapped = false, fixed = is_arithmetic(node);
    if (node->op == OP_INPUT)
        fixed = ex_is_number(p->dag, e) || (input && input->fixed && track < 0);
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        fixed = fixed && (node->level < LEVEL_VARIABLE || is_fixed(p, node->arg[i]));
    *POOL_PUSH(p->pool, p->fixed, p->infos) = fixed;
    --p->infos;
    for (int i = 0; node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i) {
        track = track == -2 ? track : joined(track, p->track[node->arg[i]]);
        shape.operand[i] = operand_of(p, node->arg[i]);
    }
    track = track < 0 ? -1 : track;
    *POOL_PUSH(p->pool, p->track, p->infos) = track;
    --p->infos;
    int group = 0;
    if (track >= 0) {
        if (node->op == OP_TABLE || node->op == OP_ROAD_PART)
            shape.operand[1] = (Operand){KIND_INDEX, node->arg[1]};
        if ((node->op == OP_ADD || node->op == OP_MUL) && goes_before(shape.operand[1], shape.operand[0])) {
            const Operand first = shape.operand[0];
            shape.operand[0] = shape.operand[1];
            shape.operand[1] = first;
            swapped = true;
        }
        shape.group_of_tracks = track / p->lanes;
        group = find_group(p, find_shape(p, &shape), track % p->lanes);
        p->group_of[group]->member[track % p->lanes] = e;
        p->group_of[group]->swapped[track % p->lanes] = swapped;
        ++p->group_of[group]->members;
    }
    *POOL_PUSH(p->pool, p->group, p->infos) = group;
}

static Ex noted(Packing *p, Ex e)
{
    while (p->infos < p->dag->nodes)
        classify(p, (Ex)p->infos);
    return e;
}

/* ---- sums over tracks
 * ------------------------------------------------------------------------------------------------ */

/* Is what is added here a sum that takes part with its terms? */
static bool is_open(const Packing *p, Ex e)
{
    return is_sum(&p->from->node[e]) && p->uses[e] == 1 && (p->over[e] || p->from_track[e] >= 0);
}

/* The terms of a sum over tracks, in order; of one that is used elsewhere too those that it came to. */
static Terms expand(Packing *p, Ex root)
{
    Terms terms = {0};
    int depth = 0;
    Term *stack = NULL;
    *POOL_PUSH(p->pool, stack, depth) = (Term){root, false};
    while (depth) {
        const Term top = stack[--depth];
        const Node *node = &p->from->node[top.e];
        if (top.e == root || is_open(p, top.e)) {
            bool two = node->op != OP_NEG;
            if (two)
                *POOL_PUSH(p->pool, stack, depth) = (Term){node->arg[1], top.minus != (node->op == OP_SUB)};
            *POOL_PUSH(p->pool, stack, depth) = (Term){node->arg[0], top.minus != (node->op == OP_NEG)};
        } else if (p->over[top.e]) {
            const Terms *own = &p->terms[top.e];
            for (int i = 0; i < own->count; ++i)
                *POOL_PUSH(p->pool, terms.term, terms.count) = (Term){own->term[i].e, own->term[i].minus != top.minus};
        } else {
            *POOL_PUSH(p->pool, terms.term, terms.count) = (Term){p->same[top.e], top.minus};
        }
    }
    return terms;
}

static Ex add_term(Packing *p, Ex sum, Term term)
{
    return noted(p, term.minus ? ex_sub(p->dag, sum, term.e) : ex_add(p->dag, sum, term.e));
}

/* A term of one track, as it is sorted: those of one pack together. */
typedef struct Lane {
    int group, track, place;
    Term term;
} Lane;

static int compare_lanes(const void *a, const void *b)
{
    const Lane *x = a, *y = b;
    if (x->group != y->group)
        return x->group < y->group ? -1 : 1;
    if (x->term.minus != y->term.minus)
        return x->term.minus ? 1 : -1;
    return x->track != y->track ? (x->track > y->track) - (x->track < y->track) : x->place - y->place;
}

/* Sums of each track's terms that are alike in the same tracks. */
typedef struct Share {
    int tracks, mask;
    Term *sum; /* [lanes] */
} Share;

static Share *find_share(Packing *p, Share **share, int *shares, int tracks, int mask)
{
    for (int i = 0; i < *shares; ++i)
        if ((*share)[i].tracks == tracks && (*share)[i].mask == mask)
            return &(*share)[i];
    Share *made = POOL_PUSH(p->pool, *share, *shares);
    *made = (Share){tracks, mask, pool_alloc(p->pool, (size_t)p->lanes * sizeof *made->sum)};
    return made;
}

/* Add up the terms that stand in packs; the others stay. Returns how many shares, in *share. */
static int collect(Packing *p, Terms *terms, Share **share)
{
    int lanes = 0, shares = 0, rest = 0;
    Lane *lane = pool_alloc(p->pool, (size_t)(terms->count + 1) * sizeof *lane);
    for (int i = 0; i < terms->count; ++i) {
        const Term term = terms->term[i];
        if (p->track[term.e] >= 0)
            lane[lanes++] = (Lane){p->group[term.e], p->track[term.e], i, term};
        else
            terms->term[rest++] = term;
    }
    qsort(lane, (size_t)lanes, sizeof *lane, compare_lanes);
    for (int i = 0, end; i < lanes; i = end) {
        int mask = 0;
        bool twice = false;
        for (end = i; end < lanes && lane[end].group == lane[i].group && lane[end].term.minus == lane[i].term.minus;
             ++end) {
            const int bit = 1 << lane[end].track % p->lanes;
            twice = twice || (mask & bit);
            mask |= bit;
        }
        if (twice || end - i == 1) {
            for (int k = i; k < end; ++k)
                terms->term[rest++] = lane[k].term;
            continue;
        }
        const Share *own = find_share(p, share, &shares, lane[i].track / p->lanes, mask);
        for (int k = i; k < end; ++k) {
            Term *sum = &own->sum[lane[k].track % p->lanes];
            if (!sum->e)
                *sum = lane[k].term;
            else if (sum->minus == lane[k].term.minus)
                sum->e = noted(p, ex_add(p->dag, sum->e, lane[k].term.e));
            else if (sum->minus)
                *sum = (Term){noted(p, ex_sub(p->dag, lane[k].term.e, sum->e)), false};
            else
                sum->e = noted(p, ex_sub(p->dag, sum->e, lane[k].term.e));
        }
    }
    terms->count = rest;
    return shares;
}

/* A sum over tracks: its terms, and the node that it is. */
static void make_sum(Packing *p, Ex e)
{
    Terms terms = expand(p, e);
    Share *share = NULL;
    const int shares = collect(p, &terms, &share);
    Ex sum = 0;
    for (int i = 0; i < terms.count; ++i)
        sum = add_term(p, sum, terms.term[i]);
    for (int i = 0; i < shares; ++i) {
        LaneSum *over = POOL_PUSH(p->pool, p->sum, p->sums);
        over->part = pool_alloc(p->pool, (size_t)p->lanes * sizeof *over->part);
        bool minus = false;
        for (int l = 0; l < p->lanes; ++l)
            if (share[i].mask >> l & 1) {
                const Term term = share[i].sum[l];
                over->part[l] = term.e;
                minus = term.minus;
                *POOL_PUSH(p->pool, terms.term, terms.count) = term;
            }
        over->node = ex_input(p->dag, pool_print(p->pool, "sum %d", p->sums), NULL);
        noted(p, over->node);
        sum = add_term(p, sum, (Term){over->node, minus});
    }
    p->terms[e] = terms;
    p->same[e] = sum;
}

/* ---- from graph to graph
 * ------------------------------------------------------------------------------------------------ */

static Ex apply(Dag *dag, const Node *node, Ex a, Ex b, Ex c)
{
    switch (node->op) {
    case OP_ADD: return ex_add(dag, a, b);
    case OP_SUB: return ex_sub(dag, a, b);
    case OP_MUL: return ex_mul(dag, a, b);
    case OP_DIV: return ex_div(dag, a, b);
    case OP_NEG: return ex_neg(dag, a);
    case OP_TABLE:
    case OP_ROAD_PART: return ex_op(dag, (Op)node->op, a, node->arg[1], 0);
    default: return ex_op(dag, (Op)node->op, a, b, c);
    }
}

static Ex copy_input(Packing *p, Ex e)
{
    const char *name = p->from->node[e].name;
    const LaneInput *input = find_input(p, name);
    if (ex_is_number(p->from, e))
        return ex_number(p->dag, ex_value(p->from, e, 0));
    return ex_input(p->dag, name, input && input->fixed ? &input->value : NULL);
}

static void make_dag(Packing *p)
{
    noted(p, 0);
    for (int e = 0; e < p->from->nodes; ++e) {
        const Node *node = &p->from->node[e];
        if (!p->needed[e])
            continue;
        if (p->over[e]) {
            if (!(p->uses[e] == 1 && p->summed[e]))
                make_sum(p, (Ex)e);
        } else if (node->level < LEVEL_VARIABLE) {
            p->same[e] = ex_literal(p->dag, ex_value(p->from, (Ex)e, 0));
        } else if (node->op == OP_INPUT) {
            p->same[e] = copy_input(p, (Ex)e);
        } else {
            Ex arg[3] = {0};
            for (int i = 0; i < ex_arity((Op)node->op); ++i)
                arg[i] = p->same[node->arg[i]];
            p->same[e] = apply(p->dag, node, arg[0], arg[1], arg[2]);
        }
        noted(p, 0);
    }
}

/* ---- vectors
 * ---------------------------------------------------------------------------------------------------------- */

/* Worth a vector: several members, and where lanes are left over nothing that takes long or may fail there. */
static void find_usable(Packing *p)
{
    static const bool harmless[OP_COUNT] = {[OP_INPUT] = true, [OP_NEG] = true, [OP_ADD] = true, [OP_SUB] = true,
                                            [OP_MUL] = true,   [OP_ABS] = true, [OP_MIN] = true, [OP_MAX] = true};
    for (int g = 0; g < p->groups; ++g) {
        Group *group = p->group_of[g];
        group->usable = group->members > 1 && (group->members == p->lanes || harmless[group->shape->op]) &&
                        group->shape->op != OP_FRICTION;
        for (int i = 0; i < 3; ++i)
            if (group->shape->operand[i].kind == KIND_PACK)
                group->usable = group->usable && p->group_of[group->shape->operand[i].which]->usable;
    }
}

/* The same number at all times, be it of one track? */
static bool is_known(const Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    const LaneInput *input = node->op == OP_INPUT ? find_input(p, node->name) : NULL;
    return is_fixed(p, e) || (input && input->fixed);
}

static const char *free_text(const Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    return is_known(p, e) ? emit_number(p->pool, ex_value(p->dag, e, 0)) : node->name;
}

/* Numbers, one a lane; lanes without one get another's. */
static Ex vector_of(Packing *p, const Ex *e)
{
    const int half = p->lanes / 2;
    bool same = true, literal = true, lower = true, upper = true;
    double value[p->lanes];
    Ex any = 0;
    int index[p->lanes];
    char array[64] = "", other[64];
    for (int l = 0; l < p->lanes; ++l)
        any = any ? any : e[l];
    for (int l = 0; l < p->lanes; ++l) {
        const Ex own = e[l] ? e[l] : any;
        const Node *node = &p->dag->node[own];
        same = same && own == any;
        literal = literal && is_known(p, own);
        value[l] = ex_value(p->dag, own, 0);
        bool part = e[l] && node->op == OP_INPUT && !is_known(p, own) &&
                    sscanf(node->name, "%63[^[][%d]", other, &index[l]) == 2 && (!l || !strcmp(array, other));
        memcpy(array, other, sizeof array);
        part = part && (l % half == 0 || index[l] == index[l - 1] + 1);
        if (l < half)
            lower = lower && part;
        else
            upper = upper && part;
    }
    if (literal)
        return ex_constant(p->out, value);
    if (same)
        return ex_input(p->out, free_text(p, any), NULL);
    if (lower && upper && index[half] == index[half - 1] + 1)
        return ex_vector(p->out, pool_print(p->pool, "lane_%d_at(%s + %d)", p->lanes, array, index[0]));
    if (lower && upper && half > 1)
        return ex_vector(p->out, pool_print(p->pool, "lane_%d_halves(%s + %d, %s + %d)", p->lanes, array, index[0],
                                            array, index[half]));
    Text text = {.pool = p->pool};
    text_print(&text, "lane_%d_set(", p->lanes);
    for (int l = 0; l < p->lanes; ++l)
        text_print(&text, "%s%s", l ? ", " : "", free_text(p, e[l] ? e[l] : any));
    text_print(&text, ")");
    return ex_vector(p->out, text.s);
}

/* What is still to be made: the vector of a group or the number of a node. */
typedef struct Wanted {
    bool vector;
    uint32_t which;
} Wanted;

typedef struct Stack {
    int depth;
    Wanted *wanted;
} Stack;

static bool have(Packing *p, Stack *stack, bool vector, uint32_t which)
{
    if ((vector ? p->vector_made : p->number_made)[which])
        return true;
    *POOL_PUSH(p->pool, stack->wanted, stack->depth) = (Wanted){vector, which};
    return false;
}

static void set_vector(Packing *p, int group, Ex e)
{
    p->vector[group] = e;
    p->vector_made[group] = true;
}

static void set_number(Packing *p, Ex node, Ex e)
{
    p->number[node] = e;
    p->number_made[node] = true;
}

static void make_vector(Packing *p, Stack *stack, int g)
{
    const Group *group = p->group_of[g];
    Ex operand[3] = {0};
    const Node *node = NULL;
    bool all = true;
    if (group->shape->op == OP_INPUT) {
        set_vector(p, g, vector_of(p, group->member));
        return;
    }
    for (int i = 0; i < 3; ++i) {
        const Operand *own = &group->shape->operand[i];
        if (own->kind == KIND_PACK || own->kind == KIND_NUMBER)
            all = have(p, stack, own->kind == KIND_PACK, own->which) && all;
    }
    if (!all)
        return;
    for (int i = 0; i < 3; ++i) {
        const Operand *own = &group->shape->operand[i];
        Ex free[p->lanes];
        for (int l = 0; l < p->lanes; ++l) {
            free[l] = 0;
            if (!group->member[l])
                continue;
            node = &p->dag->node[group->member[l]];
            if (own->kind == KIND_ANY)
                free[l] = node->arg[group->swapped[l] ? 1 - i : i];
        }
        operand[i] = own->kind == KIND_PACK     ? p->vector[own->which]
                     : own->kind == KIND_NUMBER ? p->number[own->which]
                     : own->kind == KIND_ANY    ? vector_of(p, free)
                                                : 0;
    }
    set_vector(p, g, apply(p->out, node, operand[0], operand[1], operand[2]));
}

static const LaneSum *find_sum(const Packing *p, Ex e)
{
    int number;
    return sscanf(p->dag->node[e].name, "sum %d", &number) == 1 ? &p->sum[number - 1] : NULL;
}

/* The group whose members are exactly these, one in each lane, or -1. */
static int whole_group(const Packing *p, const Ex *part)
{
    const int group = p->group[part[0]];
    bool whole = part[0] && p->track[part[0]] >= 0 && p->group_of[group]->usable;
    for (int l = 0; l < p->lanes; ++l)
        whole = whole && part[l] && p->track[part[l]] >= 0 && p->group_of[group]->member[l] == part[l];
    return whole ? group : -1;
}

/* All sums of a group, a lane each, once their vectors are there. */
static void make_fold(Packing *p, Stack *stack, int group)
{
    Ex vector[p->lanes];
    int member[p->lanes], count = 0;
    bool all = true;
    for (int s = 0; s < p->sums; ++s)
        if (p->fold[s] == group) {
            const int whole = whole_group(p, p->sum[s].part);
            all = have(p, stack, true, (uint32_t)whole) && all;
            member[count] = s;
            vector[count++] = p->vector[whole];
        }
    if (!all)
        return;
    const Ex sums = fold(p->out, vector, count);
    for (int i = 0; i < count; ++i)
        set_number(p, p->sum[member[i]].node, ex_lane(p->out, sums, i));
}

static void make_lane_sum(Packing *p, Stack *stack, const LaneSum *over)
{
    const int group = whole_group(p, over->part), own = (int)(over - p->sum);
    bool all = true;
    Ex sum = 0;
    if (group >= 0 && p->fold && p->fold[own] >= 0) {
        make_fold(p, stack, p->fold[own]);
        return;
    }
    if (group >= 0) {
        if (have(p, stack, true, (uint32_t)group)) {
            set_number(p, over->node, ex_lane_sum(p->out, p->vector[group]));
            *POOL_PUSH(p->pool, p->whole, p->wholes) = own;
        }
        return;
    }
    for (int l = 0; l < p->lanes; ++l)
        all = (!over->part[l] || have(p, stack, false, over->part[l])) && all;
    for (int l = 0; all && l < p->lanes; ++l)
        if (over->part[l])
            sum = ex_add(p->out, sum, p->number[over->part[l]]);
    if (all)
        set_number(p, over->node, sum);
}

static void make_number(Packing *p, Stack *stack, Ex e)
{
    const Node *node = &p->dag->node[e];
    const int track = p->track[e];
    bool all = true;
    if (is_known(p, e)) {
        set_number(p, e, ex_literal(p->out, ex_value(p->dag, e, 0)));
    } else if (node->op == OP_INPUT) {
        const LaneSum *over = find_sum(p, e);
        if (over)
            make_lane_sum(p, stack, over);
        else
            set_number(p, e, ex_input(p->out, node->name, NULL));
    } else if (track >= 0 && p->group_of[p->group[e]]->usable) {
        if (have(p, stack, true, (uint32_t)p->group[e]))
            set_number(p, e, ex_lane(p->out, p->vector[p->group[e]], track % p->lanes));
    } else {
        Ex arg[3] = {0};
        for (int i = 0; i < ex_arity((Op)node->op); ++i)
            all = have(p, stack, false, node->arg[i]) && all;
        for (int i = 0; all && i < ex_arity((Op)node->op); ++i)
            arg[i] = p->number[node->arg[i]];
        if (all)
            set_number(p, e, apply(p->out, node, arg[0], arg[1], arg[2]));
    }
}

static Ex number_of(Packing *p, Ex from)
{
    const Ex e = p->same[from];
    Stack stack = {0};
    have(p, &stack, false, e);
    while (stack.depth) {
        const Wanted top = stack.wanted[stack.depth - 1];
        const int depth = stack.depth;
        if ((top.vector ? p->vector_made : p->number_made)[top.which]) {
            --stack.depth;
            continue;
        }
        if (top.vector)
            make_vector(p, &stack, (int)top.which);
        else
            make_number(p, &stack, top.which);
        if (stack.depth == depth)
            --stack.depth;
    }
    return p->number[e];
}

/* ---- the block
 * ------------------------------------------------------------------------------------------------------------ */

/* A pack is checked in all lanes at once: the checks of its members. NULL where one of them has none. */
static const Check *const *checks_of_group(const Packing *p, const Group *group)
{
    const Check **check = pool_alloc(p->pool, (size_t)p->lanes * sizeof *check);
    for (int l = 0; l < p->lanes; ++l) {
        for (int i = 0; i < p->block->checks; ++i)
            if (p->same[p->block->check[i].value] == group->member[l])
                check[l] = &p->block->check[i];
        if (!check[l])
            return NULL;
    }
    return check;
}

/* A graph for the result, in which nothing is yet. */
static void begin_result(Packing *p)
{
    p->out = dag_new(p->pool, p->lanes, p->lanes);
    p->out->lanes = p->lanes;
    p->number = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *p->number);
    p->number_made = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *p->number_made);
    p->vector = pool_alloc(p->pool, ((size_t)p->groups + 1) * sizeof *p->vector);
    p->vector_made = pool_alloc(p->pool, ((size_t)p->groups + 1) * sizeof *p->vector_made);
}

/* [sums] how many sums over lanes a sum comes after, one behind the other. */
static int *sum_depths(const Packing *p)
{
    int *depth = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *depth);
    int *of = pool_alloc(p->pool, ((size_t)p->sums + 1) * sizeof *of);
    for (int e = 0; e < p->dag->nodes; ++e) {
        const Node *node = &p->dag->node[e];
        const LaneSum *over = node->op == OP_INPUT ? find_sum(p, (Ex)e) : NULL;
        for (int i = 0; i < ex_arity((Op)node->op); ++i)
            depth[e] = depth[node->arg[i]] > depth[e] ? depth[node->arg[i]] : depth[e];
        for (int l = 0; over && l < p->lanes; ++l)
            of[over - p->sum] = depth[over->part[l]] > of[over - p->sum] ? depth[over->part[l]] : of[over - p->sum];
        if (over)
            depth[e] = of[over - p->sum] + 1;
    }
    return of;
}

/* Sums are made together in the order in which they are needed, which is known once all is made without that. */
static void find_folds(Packing *p)
{
    begin_result(p);
    for (int i = 0; i < p->block->checks; ++i)
        number_of(p, p->block->check[i].value);
    for (int i = 0; i < p->block->stores; ++i)
        number_of(p, p->block->store[i].value);
    p->fold = fold_groups(p->pool, p->sums, p->wholes, p->whole, sum_depths(p), p->lanes);
}

Block *block_pack(Pool *pool, const Block *block, const LaneInput *input, int inputs, int lanes)
{
    const size_t nodes = (size_t)block->dag->nodes + 1;
    const int roots = block->stores + block->checks;
    Ex *root = pool_alloc(pool, (size_t)(roots + 1) * sizeof *root);
    for (int i = 0; i < roots; ++i)
        root[i] = i < block->stores ? block->store[i].value : block->check[i - block->stores].value;
    LaneInput *sorted = pool_alloc(pool, (size_t)(inputs + 1) * sizeof *sorted);
    memcpy(sorted, input, (size_t)inputs * sizeof *sorted);
    qsort(sorted, (size_t)inputs, sizeof *sorted, compare_inputs);
    Packing p = {.pool = pool,
                 .block = block,
                 .from = block->dag,
                 .dag = dag_new(pool, 1, 1),
                 .input = sorted,
                 .inputs = inputs,
                 .lanes = lanes,
                 .needed = dag_needed(block->dag, root, roots),
                 .from_track = pool_alloc(pool, nodes * sizeof(int)),
                 .uses = pool_alloc(pool, nodes * sizeof(int)),
                 .over = pool_alloc(pool, nodes * sizeof(bool)),
                 .summed = pool_alloc(pool, nodes * sizeof(bool)),
                 .same = pool_alloc(pool, nodes * sizeof(Ex)),
                 .terms = pool_alloc(pool, nodes * sizeof(Terms))};
    for (int i = 0; i < roots; ++i)
        ++p.uses[root[i]], ++p.uses[root[i]]; /* what is asked for is there by itself */
    find_tracks(&p);
    make_dag(&p);
    find_usable(&p);
    find_folds(&p);
    begin_result(&p);
    Block *packed = pool_alloc(pool, sizeof *packed);
    packed->dag = p.out;
    packed->model = block->model;
    for (int i = 0; i < block->checks; ++i) {
        Check check = block->check[i];
        const Ex e = p.same[check.value];
        Ex value = number_of(&p, check.value);
        if (p.out->node[value].op == OP_LANE && p.group_of[p.group[e]]->members == lanes)
            check.lane = checks_of_group(&p, p.group_of[p.group[e]]);
        if (check.lane)
            value = p.out->node[value].arg[0];
        block_check_like(packed, value, &check);
    }
    for (int i = 0; i < block->stores; ++i)
        block_store(packed, number_of(&p, block->store[i].value), "%s", block->store[i].target);
    return packed;
}
