/* SPDX-License-Identifier: MIT
 * Which states and inputs outputs and derivatives depend on, by the leaves of their formulas. What is not certain
 * counts as dependence on everything. */
#include "fmu/fmu_private.h"
#include "sequence/sequence.h"

#include <string.h>

static Dependence *dependence_new(Pool *pool, const Formulation *f, int count)
{
    const size_t states = (size_t)(f->plan->states + f->model->fast_states + 1);
    Dependence *all = pool_alloc(pool, sizeof *all * (size_t)(count + 1));
    for (int i = 0; i < count; ++i) {
        all[i].everything = true; /* until its formula is looked through */
        all[i].state = pool_alloc(pool, sizeof(bool) * states);
        all[i].input = pool_alloc(pool, sizeof(bool) * (size_t)(f->model->inputs + 1));
        all[i].port = pool_alloc(pool, sizeof(bool) * (size_t)(6 * f->model->ports + 1));
    }
    return all;
}

static void join(Dependence *to, const Dependence *from, const Formulation *f)
{
    to->everything = to->everything || from->everything;
    to->time = to->time || from->time;
    to->road = to->road || from->road;
    for (int i = 0; i < f->plan->states + f->model->fast_states; ++i)
        to->state[i] = to->state[i] || from->state[i];
    for (int i = 0; i < f->model->inputs; ++i)
        to->input[i] = to->input[i] || from->input[i];
    for (int i = 0; i < 6 * f->model->ports; ++i)
        to->port[i] = to->port[i] || from->port[i];
}

/* The value of a coordinate, or its rate. */
static void on_coordinate(Dependence *to, const Formulation *f, int w, bool rate)
{
    const Coordinate *c = &f->model->coordinate[w];
    if (c->driven)
        to->input[c->input + rate] = true;
    else
        to->state[rate ? f->plan->coordinate_rate[w] : f->plan->coordinate_state[w]] = true;
}

/* A number of the motion of a body relative to the base: place `number` of its row. Chains add what carries the body.
 */
static void on_motion(Dependence *to, const Formulation *f, int body, int number)
{
    const bool pose = number < MOTION_OMEGA || number >= MOTION_S;
    const Sequence *sequence = f->sequence;
    for (int steps = 0; body >= 0 && steps <= sequence->subsets; ++steps) {
        const Subset *subset = &sequence->subset[sequence->body_subset[body]];
        for (int i = 0; i < subset->deps; ++i) {
            on_coordinate(to, f, subset->dep[i], false);
            if (!pose)
                on_coordinate(to, f, subset->dep[i], true);
        }
        if (subset->carrier == BODY_BASE || subset->carrier == body)
            break;
        body = subset->carrier;
    }
    for (int i = 0; i < 3 && !pose && f->model->free_base; ++i)
        to->state[10 + f->plan->free_coordinates + i] = true; /* omega of the base */
}

static bool on_motion_place(Dependence *to, const Formulation *f, int place)
{
    const Plan *plan = f->plan;
    int found = -1;
    if (plan->lanes)
        return false;
    for (int b = 0; b < f->model->bodies; ++b)
        if (b != BODY_BASE && plan->motion_offset[b] <= place &&
            (found < 0 || plan->motion_offset[b] > plan->motion_offset[found]))
            found = b;
    if (found >= 0)
        on_motion(to, f, found, place - plan->motion_offset[found]);
    return found >= 0;
}

/* Elements of an array that formulas read; 0: of another array, which may depend on anything. */
static int known_elements(const Formulation *f, Array array, const Dependence *rate)
{
    const int states = f->plan->states + f->model->fast_states;
    switch (array) {
    case ARRAY_y: return states;
    case ARRAY_rate: return rate ? states : 0;
    case ARRAY_e: return 4;
    case ARRAY_x:
    case ARRAY_xd: return f->model->coordinates;
    case ARRAY_u: return f->model->inputs;
    case ARRAY_port: return 6 * f->model->ports;
    case ARRAY_m: return f->plan->motion_size;
    case ARRAY_p: return f->model->tunables;
    case ARRAY_self_derived: return f->plan->derived->count;
    case ARRAY_time:
    case ARRAY_number: return 1;
    default: return 0;
    }
}

/* A leaf of a formula. rate: dependences of the rates, NULL: not known yet. */
static void on_leaf(Dependence *to, const Formulation *f, Element leaf, const Dependence *rate)
{
    const int i = leaf.index;
    if (i < 0 || i >= known_elements(f, leaf.array, rate)) {
        to->everything = true;
        return;
    }
    switch (leaf.array) {
    case ARRAY_time: to->time = true; break;
    case ARRAY_y: to->state[i] = true; break;
    case ARRAY_e: memset(to->state + 3, true, 4); break; /* the dependent one follows from the others */
    case ARRAY_x: on_coordinate(to, f, i, false); break;
    case ARRAY_xd: on_coordinate(to, f, i, true); break;
    case ARRAY_u: to->input[i] = true; break;
    case ARRAY_port: to->port[i] = true; break;
    case ARRAY_m: to->everything = !on_motion_place(to, f, i) || to->everything; break;
    case ARRAY_rate: join(to, &rate[i], f); break;
    default: break; /* parameters are no knowns */
    }
}

static void on_node(Dependence *to, const Formulation *f, const Node *node, const Dependence *rate)
{
    for (int l = 0; node->op == OP_INPUT && l < (node->wide ? node->wide : 1); ++l)
        on_leaf(to, f, node->element[l], rate);
    to->road = to->road || node->op == OP_ROAD || node->op == OP_FRICTION;
}

/* Of all stores of a block in an array. */
static void of_block(const Formulation *f, const Block *block, Array target, const Dependence *rate, Dependence *out,
                     int count)
{
    const Dag *dag = block->dag;
    for (int s = 0; s < block->stores; ++s) {
        const Store *store = &block->store[s];
        const int place = element_index(store->target, target);
        if (place < 0 || place >= count)
            continue;
        out[place].everything = false;
        const bool *needed = dag_needed(dag, &store->value, 1);
        for (int n = 0; n < dag->nodes; ++n)
            if (needed[n])
                on_node(&out[place], f, &dag->node[n], rate);
    }
}

const Dependence *dependences_of_rates(Pool *pool, const Formulation *f)
{
    const int slow = f->plan->states, states = slow + f->model->fast_states;
    Dependence *rate = dependence_new(pool, f, states);
    of_block(f, f->dynamics, ARRAY_rate, NULL, rate, slow);
    return rate;
}

const Dependence *dependences_of_outputs(Pool *pool, const Formulation *f, const Dependence *rate)
{
    Dependence *out = dependence_new(pool, f, f->model->output_components);
    of_block(f, f->outputs, ARRAY_out, rate, out, f->model->output_components);
    return out;
}

const Dependence *dependences_of_places(Pool *pool, const Formulation *f)
{
    const Model *model = f->model;
    Dependence *place = dependence_new(pool, f, model->wheels);
    for (int i = 0; i < model->wheels; ++i) {
        place[i].everything = false;
        for (int s = 0; s < 7 && model->free_base; ++s)
            place[i].state[s] = true;
        on_motion(&place[i], f, model->wheel[i].body, MOTION_S);
    }
    return place;
}

bool depends(const Dependence *unknown, const Variable *known)
{
    switch (known->kind) {
    case KIND_TIME: return unknown->time;
    case KIND_STATE: return unknown->state[known->index];
    case KIND_INPUT: return unknown->input[known->index];
    case KIND_PORT: return unknown->port[known->index];
    case KIND_ROAD: return unknown->road;
    default: return false;
    }
}
