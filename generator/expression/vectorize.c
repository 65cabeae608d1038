/* SPDX-License-Identifier: MIT
 * Lane packing: a block of numbers as one of vectors, as far as it does the same to the numbers of several tracks (the
 * corners of a vehicle, say). Nodes of different tracks that are the same operation on packs, on the same numbers, or
 * on literals are a pack; what depends on more than one track is one number. Sums over tracks first add up each track's
 * terms, which are packs, and then those: their order changes, and nothing else. */
#include "expression/expression.h"
#include "expression/vectorize.h"
#include "expression/vectorize_private.h"

#include <stdlib.h>
#include <string.h>

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
    return element_compare(((const LaneInput *)a)->element, ((const LaneInput *)b)->element);
}

const LaneInput *pack_input(const Packing *p, const Node *node)
{
    const LaneInput key = {.element = *node->element};
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
            const LaneInput *input = pack_input(p, node);
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

/* ---- packs */

/* The same number at all times? */
bool pack_is_fixed(const Packing *p, Ex e)
{
    return p->dag->node[e].level < LEVEL_VARIABLE || p->fixed[e];
}

static bool is_free(const Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    return pack_is_fixed(p, e) ||
           (node->op == OP_INPUT && (node->element->array == ARRAY_p || node->element->array == ARRAY_self_derived));
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
    const LaneInput *input = node->op == OP_INPUT ? pack_input(p, node) : NULL;
    Shape shape = {.op = (Op)node->op, .input = input ? input->colour : 0};
    int track = input ? input->track : -1;
    bool swapped = false, fixed = is_arithmetic(node);
    if (node->op == OP_INPUT)
        fixed = ex_is_number(p->dag, e) || (input && input->fixed && track < 0);
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        fixed = fixed && (node->level < LEVEL_VARIABLE || pack_is_fixed(p, node->arg[i]));
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

/* ---- sums over tracks */

/* True if an operand of a sum is a sum whose terms are added one by one. */
static bool is_open(const Packing *p, Ex e)
{
    return is_sum(&p->from->node[e]) && p->uses[e] == 1 && (p->over[e] || p->from_track[e] >= 0);
}

/* The terms of a sum over tracks, in order; a partial sum that is used elsewhere too contributes its own final
 * terms. */
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

/* A term of one track; sorting brings the terms of one pack together. */
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
        over->node = ex_input(p->dag, element_at(ARRAY_sum, p->sums - 1), NULL);
        noted(p, over->node);
        sum = add_term(p, sum, (Term){over->node, minus});
    }
    p->terms[e] = terms;
    p->same[e] = sum;
}

/* ---- from graph to graph */

Ex pack_apply(Dag *dag, const Node *node, Ex a, Ex b, Ex c)
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
    const Node *node = &p->from->node[e];
    const LaneInput *input = pack_input(p, node);
    if (ex_is_number(p->from, e))
        return ex_number(p->dag, ex_value(p->from, e, 0));
    return ex_input(p->dag, *node->element, input && input->fixed ? &input->value : NULL);
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
            p->same[e] = pack_apply(p->dag, node, arg[0], arg[1], arg[2]);
        }
        noted(p, 0);
    }
}

/* ---- vectors */

/* A vector pays for several members; with unused lanes only for operations that are quick and cannot fail in them. */
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

/* ---- the block */

static bool is_alike(const Check *a, const Check *b)
{
    return a->magnitude == b->magnitude && a->least == b->least && a->status == b->status &&
           a->condition == b->condition;
}

/* The checks of a pack's members that are like `wanted`, one in each lane, so that all lanes are checked at once. NULL
 * if a member has no such check. */
static const Check *const *checks_of_group(const Packing *p, const Group *group, const Check *wanted)
{
    const Check **check = pool_alloc(p->pool, (size_t)p->lanes * sizeof *check);
    for (int l = 0; l < p->lanes; ++l) {
        for (int i = 0; i < p->block->checks; ++i)
            if (p->same[p->block->check[i].value] == group->member[l] && is_alike(&p->block->check[i], wanted))
                check[l] = &p->block->check[i];
        if (!check[l])
            return NULL;
    }
    return check;
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
        ++p.uses[root[i]], ++p.uses[root[i]]; /* roots have values of their own */
    find_tracks(&p);
    make_dag(&p);
    find_usable(&p);
    pack_find_folds(&p);
    pack_begin(&p);
    Block *packed = pool_alloc(pool, sizeof *packed);
    packed->dag = p.out;
    packed->model = block->model;
    packed->scheduled = true;
    for (int i = 0; i < block->checks; ++i) {
        Check check = block->check[i];
        const Ex e = p.same[check.value];
        Ex value = pack_number(&p, check.value);
        if (p.out->node[value].op == OP_LANE && p.group_of[p.group[e]]->members == lanes)
            check.lane = checks_of_group(&p, p.group_of[p.group[e]], &block->check[i]);
        if (check.lane)
            value = p.out->node[value].arg[0];
        block_check_like(packed, value, &check);
    }
    for (int i = 0; i < block->stores; ++i)
        block_store(packed, pack_number(&p, block->store[i].value), block->store[i].target);
    return packed;
}
