/* SPDX-License-Identifier: MIT
 * The formulas of a model whose classes are solved in lanes. The numbers of such a class are stored in rows: the
 * same number of all members, one lane a column. */
#include "expression/expression.h"
#include "expression/vectorize.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/plant_stores.h"
#include "vehicle/vehicle.h"

#include <stdlib.h>
#include <string.h>

int lanes_of(const char *word)
{
    char *end;
    const long lanes = strtol(word, &end, 10);
    return *end || (lanes != 2 && lanes != 4 && lanes != 8 && lanes != 16) ? 0 : (int)lanes;
}

/* Lanes of a vector for `members` members, which may need several vectors; 0: a single member. */
static int lanes_for(int members, int most)
{
    int lanes = 2;
    while (lanes < members && lanes < most)
        lanes *= 2;
    return members > 1 ? lanes : 0;
}

/* Members are solved together at the place of the first one: the knowns of all must be solved before. */
static bool in_one_stage(const Sequence *sequence, const Class *class)
{
    for (int i = 1; i < class->members; ++i)
        if (sequence->subset[class->member[i]].stage != sequence->subset[class->member[0]].stage)
            return false;
    return true;
}

/* Members that a right-hand side solves: neither images of others nor solved at set-up alone. Returns how many. */
static int find_solved(const Class *class, const Narrowing *narrowing, int *member)
{
    int count = 0;
    for (int i = 0; i < class->members; ++i)
        if (!narrowing_image(narrowing, class->member[i]) && !narrowing_steady(narrowing, class->member[i]))
            member[count++] = i;
    return count;
}

int class_rows(const Plan *plan, int class)
{
    int lanes = plan->class_lanes[class];
    return lanes ? (plan->lane_members[class] + lanes - 1) / lanes : plan->sequence->class[class].members;
}

/* Rows begin at multiples of their length, so that no row crosses a cache line: such a row takes twice as long to read,
 * and longer to forward from a store. */
static int row_begin(int size, int lanes)
{
    return lanes ? (size + lanes - 1) / lanes * lanes : size;
}

/* Set the places of one row of `count` members, or of a single member; member: places in the class. */
static void place_row(Plan *plan, const Class *class, const int *member, int count, int lanes)
{
    const Layout *layout = &plan->formula[plan->sequence->subset[class->member[*member]].class]->layout;
    plan->start_size = row_begin(plan->start_size, lanes);
    plan->inertia_size = row_begin(plan->inertia_size, lanes);
    plan->motion_size = row_begin(plan->motion_size, lanes);
    for (int l = 0; l < count; ++l) {
        int s = class->member[member[l]];
        const Subset *subset = &plan->sequence->subset[s];
        plan->stride[s] = lanes ? lanes : 1;
        plan->start_offset[s] = plan->start_size + l;
        plan->inertia_offset[s] = plan->inertia_size + l;
        for (int b = 0; b < subset->bodies; ++b)
            plan->motion_offset[subset->body[b]] = plan->motion_size + b * layout->motion_size * plan->stride[s] + l;
    }
    lanes = lanes ? lanes : 1;
    plan->start_size += layout->start_size * lanes;
    plan->inertia_size += layout->inertia_size * lanes;
    plan->motion_size += layout->bodies * layout->motion_size * lanes;
}

/* Set the places of a class: rows of those that have a lane, then the others one by one. */
static void place_class(Plan *plan, int c)
{
    const Class *class = &plan->sequence->class[c];
    const int lanes = plan->class_lanes[c], solved = plan->lane_members[c], *member = plan->lane_member[c];
    for (int first = 0; first < solved; first += lanes) {
        const int rest = solved - first;
        place_row(plan, class, member + first, rest < lanes ? rest : lanes, lanes);
    }
    for (int i = 0, next = 0; i < class->members; ++i)
        if (next < solved && member[next] == i)
            ++next;
        else
            place_row(plan, class, &i, 1, 0);
}

/* The same plan with its numbers in rows. */
static Plan *plan_lanes(Pool *pool, const Plan *plan, const Narrowing *narrowing, int most)
{
    const Sequence *sequence = plan->sequence;
    size_t subsets = (size_t)sequence->subsets + 1, bodies = (size_t)plan->model->bodies;
    Plan *rows = pool_alloc(pool, sizeof *rows);
    *rows = *plan;
    rows->lanes = most;
    rows->class_lanes = pool_alloc(pool, ((size_t)sequence->classes + 1) * sizeof(int));
    rows->lane_members = pool_alloc(pool, ((size_t)sequence->classes + 1) * sizeof(int));
    rows->lane_member = pool_alloc(pool, ((size_t)sequence->classes + 1) * sizeof(int *));
    rows->start_offset = pool_alloc(pool, subsets * sizeof(int));
    rows->inertia_offset = pool_alloc(pool, subsets * sizeof(int));
    rows->motion_offset = pool_alloc(pool, bodies * sizeof(int));
    rows->stride = pool_alloc(pool, subsets * sizeof(int));
    rows->start_size = plan->model->coordinates;
    rows->inertia_size = rows->motion_size = 0;
    for (int c = 0; c < sequence->classes; ++c) {
        const Class *class = &sequence->class[c];
        int *member = pool_alloc(pool, ((size_t) class->members + 1) * sizeof *member);
        const int solved = find_solved(class, narrowing, member);
        const int lanes = in_one_stage(sequence, class) ? lanes_for(solved, most) : 0;
        rows->class_lanes[c] = lanes;
        rows->lane_member[c] = member;
        rows->lane_members[c] = lanes ? solved : 0;
        place_class(rows, c);
    }
    /* these arrays follow each other in an instance */
    rows->start_size = row_begin(rows->start_size, most);
    rows->inertia_size = row_begin(rows->inertia_size, most);
    rows->motion_size = row_begin(rows->motion_size, most);
    return rows;
}

/* ---- tracks: what hangs together from the members of a class on ---------------------------------------------------
 */

/* Tracks of the subsets: each member of the largest class begins one; a subset connected to one track only belongs to
 * it. */
typedef struct Tracks {
    int count, lanes;
    int *of;   /* [subsets] -1: none */
    int *slot; /* [subsets] index within the track */
} Tracks;

static int track_of_knowns(const Sequence *sequence, const Subset *subset, const int *of)
{
    int track = -1;
    for (int i = 0; i < subset->knowns; ++i) {
        int own = of[sequence->body_subset[subset->known[i]]];
        if (own >= 0 && track >= 0 && own != track)
            return -1;
        track = own >= 0 ? own : track;
    }
    return track;
}

static Tracks find_tracks(Pool *pool, const Plan *plan)
{
    const Sequence *sequence = plan->sequence;
    const Class *largest = NULL;
    Tracks tracks = {.of = pool_alloc(pool, ((size_t)sequence->subsets + 1) * sizeof(int)),
                     .slot = pool_alloc(pool, ((size_t)sequence->subsets + 1) * sizeof(int))};
    for (int s = 0; s < sequence->subsets; ++s)
        tracks.of[s] = -1;
    for (int c = 0; c < sequence->classes; ++c)
        if (sequence->class[c].members > (largest ? largest->members : 1))
            largest = &sequence->class[c];
    if (!largest)
        return tracks;
    tracks.count = largest->members;
    tracks.lanes = lanes_for(tracks.count, plan->lanes);
    int *length = pool_alloc(pool, (size_t)tracks.count * sizeof *length);
    for (int i = 0; i < largest->members; ++i)
        tracks.of[largest->member[i]] = i;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Class *class = &sequence->class[subset->class];
        if (tracks.of[s] < 0)
            tracks.of[s] = track_of_knowns(sequence, subset, tracks.of);
        if (tracks.of[s] < 0 && !subset->knowns && class->members > 1 && class->members <= tracks.count)
            for (int i = 0; i < class->members; ++i)
                tracks.of[s] = class->member[i] == s ? i : tracks.of[s];
        if (tracks.of[s] >= 0)
            tracks.slot[s] = length[tracks.of[s]]++;
    }
    return tracks;
}

/* Kinds of inputs, and the numbers that identify an input in its track. */
enum { INPUT_MOTION = 1, INPUT_INERTIA, INPUT_VALUE, INPUT_RATE, INPUT_GRIP };

typedef struct Inputs {
    Pool *pool;
    const Tracks *tracks;
    int count;
    LaneInput *input;
} Inputs;

/* found: the formula's number, NULL: none. */
static void add_input(Inputs *all, const Plan *plan, int subset, const Ex *found, int kind, int number, Array array,
                      int index)
{
    const Tracks *tracks = all->tracks;
    const Formula *formula = plan->formula[plan->sequence->subset[subset].class];
    const uint64_t slot = (uint64_t)tracks->slot[subset] * 512 + (uint64_t)kind;
    LaneInput input = {.element = element_at(array, index),
                       .colour = (slot << 32) + (uint64_t)number + 1,
                       .track = tracks->of[subset],
                       .fixed = found && formula_is_constant(formula, *found)};
    if (input.fixed)
        input.value = formula_value(formula, *found,
                                    class_place(&plan->sequence->class[plan->sequence->subset[subset].class], subset));
    *POOL_PUSH(all->pool, all->input, all->count) = input;
}

/* Index of the j-th dependence of a subset among its track's coordinates, or among all. */
static int dependence(const Inputs *all, const Plan *plan, int s, int j)
{
    const Sequence *sequence = plan->sequence;
    const Tracks *tracks = all->tracks;
    const int coordinate = sequence->subset[s].dep[j];
    for (int o = 0; o < sequence->subsets; ++o)
        for (int i = 0; tracks->of[o] == tracks->of[s] && i < sequence->subset[o].coordinates; ++i)
            if (sequence->subset[o].coordinate[i] == coordinate)
                return 2 * (8 * tracks->slot[o] + i);
    return 2 * coordinate + 1;
}

/* An identifier of a number that belongs to one dependence or to two. */
static int dependent(int first, int second, int number)
{
    return ((first + 1) * 256 + second + 1) * 1024 + number;
}

static void add_inertia(Inputs *all, const Plan *plan, int s)
{
    const int deps = plan->sequence->subset[s].deps, offset = plan->inertia_offset[s], stride = plan->stride[s];
    const Ex *found = plan->formula[plan->sequence->subset[s].class]->inertia;
    for (int i = 0; i < INERTIA_COORDINATE; ++i)
        add_input(all, plan, s, &found[i], INPUT_INERTIA, i, ARRAY_n, offset + stride * i);
    for (int j = 0; j < deps; ++j) {
        const int own = dependence(all, plan, s, j);
        for (int i = 0; i < 7; ++i) {
            const int place = INERTIA_COORDINATE + 7 * j + i;
            add_input(all, plan, s, &found[place], INPUT_INERTIA, dependent(own, 0, i), ARRAY_n,
                      offset + stride * place);
        }
        for (int k = j; k < deps; ++k) {
            const int other = dependence(all, plan, s, k), place = inertia_mass(deps, j, k);
            const int low = own < other ? own : other, high = own < other ? other : own;
            add_input(all, plan, s, &found[place], INPUT_INERTIA, dependent(low, 1 + high, 0), ARRAY_n,
                      offset + stride * place);
        }
    }
}

static void add_motion(Inputs *all, const Plan *plan, int s, int b)
{
    const Subset *subset = &plan->sequence->subset[s];
    const int offset = plan->motion_offset[subset->body[b]], stride = plan->stride[s];
    for (int i = 0; i < MOTION_S + 6 * subset->deps; ++i) {
        const int number = i < MOTION_S ? i : dependent(dependence(all, plan, s, (i - MOTION_S) / 6), 0, i % 6);
        add_input(all, plan, s, motion_number(&plan->formula[subset->class]->motion[b], i), INPUT_MOTION + 8 * b,
                  number, ARRAY_m, offset + stride * i);
    }
}

static void add_subset(Inputs *all, const Plan *plan, int s)
{
    const Subset *subset = &plan->sequence->subset[s];
    for (int b = 0; b < subset->bodies; ++b)
        add_motion(all, plan, s, b);
    if (plan->formula[subset->class]->layout.inertia_size)
        add_inertia(all, plan, s);
    for (int i = 0; i < subset->coordinates; ++i) {
        add_input(all, plan, s, NULL, INPUT_VALUE, i, ARRAY_x, subset->coordinate[i]);
        add_input(all, plan, s, NULL, INPUT_RATE, i, ARRAY_xd, subset->coordinate[i]);
    }
    for (int w = 0; w < plan->model->wheels; ++w) {
        const Wheel *wheel = &plan->model->wheel[w];
        if (wheel->tire >= 0 && plan->sequence->body_subset[wheel->body] == s)
            for (int i = 0; i < GRIP_NUMBERS; ++i)
                add_input(all, plan, s, NULL, INPUT_GRIP, i, ARRAY_self_grip,
                          GRIP_NUMBERS * wheel_rolling(plan->model, w) + i);
    }
}

/* ---- code for one scene --------------------------------------------------------------------------------------------
 */

/* Where numbers of m[] and n[] stand that stood elsewhere: by their old places. */
typedef struct Moves {
    int *motion, *inertia;
} Moves;

static Moves find_moves(Pool *pool, const Plan *from, const Plan *to)
{
    const Sequence *sequence = to->sequence;
    Moves moves = {pool_alloc(pool, ((size_t)from->motion_size + 1) * sizeof(int)),
                   pool_alloc(pool, ((size_t)from->inertia_size + 1) * sizeof(int))};
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Layout *layout = &to->formula[subset->class]->layout;
        for (int b = 0; b < subset->bodies; ++b)
            for (int i = 0; i < layout->motion_size; ++i)
                moves.motion[from->motion_offset[subset->body[b]] + i] =
                    to->motion_offset[subset->body[b]] + to->stride[s] * i;
        for (int i = 0; i < layout->inertia_size; ++i)
            moves.inertia[from->inertia_offset[s] + i] = to->inertia_offset[s] + to->stride[s] * i;
    }
    return moves;
}

static Element move_input(const void *context, Element input)
{
    const Moves *moves = context;
    if (input.array == ARRAY_m)
        input.index = moves->motion[input.index];
    if (input.array == ARRAY_n)
        input.index = moves->inertia[input.index];
    return input;
}

static Block *move_block(Pool *pool, const Moves *moves, const Block *block)
{
    Block *moved = pool_alloc(pool, sizeof *moved);
    if (!block)
        return NULL;
    *moved = *block;
    if (block->dag)
        moved->dag = dag_renamed(pool, block->dag, move_input, moves);
    return moved;
}

const Block *block_in_rows(Pool *pool, const Formulation *rows, const Block *block)
{
    const Moves moves = find_moves(pool, rows->single->plan, rows->plan);
    return move_block(pool, &moves, block);
}

/* The blocks as the scene left them, reading numbers from rows. They are not made anew, and the equations of motion are
 * not packed: so they keep what the scene saves, and every operation, so that results keep their bits. */
static void move_blocks(Pool *pool, Formulation *f, const Plan *from)
{
    const Moves moves = find_moves(pool, from, f->plan);
    f->dynamics = move_block(pool, &moves, f->dynamics);
    f->outputs = move_block(pool, &moves, f->outputs);
    f->contacts = move_block(pool, &moves, f->contacts);
    f->poses = move_block(pool, &moves, f->poses);
    f->inverse = move_block(pool, &moves, f->inverse);
    f->energy = move_block(pool, &moves, f->energy);
    f->check = move_block(pool, &moves, f->check);
    f->wrenches = move_block(pool, &moves, f->wrenches);
    if (!f->wheels)
        return;
    Wheels *wheels = pool_alloc(pool, sizeof *wheels);
    *wheels = *f->wheels;
    wheels->link = *move_block(pool, &moves, &wheels->link);
    f->wheels = wheels_merge(pool, wheels);
}

const Formulation *formulation_lanes(Pool *pool, const Formulation *formulation, int most)
{
    Formulation *f = pool_alloc(pool, sizeof *f);
    Plan *plan = plan_lanes(pool, formulation->plan, formulation->narrowing, most);
    *f = *formulation;
    f->plan = plan;
    f->single = formulation;
    if (formulation->narrowing) {
        move_blocks(pool, f, formulation->plan);
        plant_stores(f, "lanes");
        return f;
    }
    const Tracks tracks = find_tracks(pool, plan);
    Inputs inputs = {.pool = pool, .tracks = &tracks};
    plan->pack = tracks.lanes;
    plan->coordinate_track = pool_alloc(pool, ((size_t)plan->model->coordinates + 1) * sizeof(int));
    for (int w = 0; w < plan->model->coordinates; ++w)
        plan->coordinate_track[w] = -1;
    for (int s = 0; s < plan->sequence->subsets; ++s)
        for (int i = 0; i < plan->sequence->subset[s].coordinates; ++i)
            plan->coordinate_track[plan->sequence->subset[s].coordinate[i]] = tracks.of[s];
    formulation_blocks(pool, f);
    if (f->wheels)
        f->wheels = wheels_merge(pool, f->wheels);
    for (int s = 0; s < plan->sequence->subsets; ++s)
        if (plan->pack && plan->sequence->subset[s].class >= 0)
            add_subset(&inputs, plan, s);
    if (plan->pack)
        f->dynamics = block_pack(pool, f->dynamics, inputs.input, inputs.count, plan->pack);
    plant_stores(f, "lanes");
    return f;
}
