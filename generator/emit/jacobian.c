/* SPDX-License-Identifier: MIT
 * The derivatives by every state, input, parameter and port, of which it is known here which are 0: through the blocks
 * of tangents, in the order in which generated code runs them, go the sets of columns that each number may change with.
 */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

#include <string.h>

/* A set of columns: states, inputs, tunable parameters, numbers of ports. */
typedef bool *Set;

/* Sets of all numbers that generated code keeps between blocks, and where those of one subset or wheel begin. */
typedef struct Pattern {
    Generation *g;
    int columns;
    Set *of[ARRAY_COUNT]; /* [numbers] about the whole vehicle; NULL: these do not change */
    int count[ARRAY_COUNT];
    const Subset *subset; /* the one whose block runs; NULL: none */
    int number;           /* its number */
    int wheel;            /* the wheel whose block runs; -1: none */
} Pattern;

static void open_array(Pattern *p, Array array, int count)
{
    Pool *pool = p->g->pool;
    p->of[array] = pool_alloc(pool, ((size_t)count + 1) * sizeof(Set));
    p->count[array] = count;
    for (int i = 0; i < count; ++i)
        p->of[array][i] = pool_alloc(pool, (size_t)p->columns + 1);
}

static void join(const Pattern *p, Set to, const bool *from)
{
    for (int c = 0; c < p->columns; ++c)
        to[c] = to[c] || from[c];
}

/* ---- where a number of a block stands among all -------------------------------------------------------------- */

/* In blocks of a class of subsets. */
static Element place_in_subset(const Pattern *p, Element e)
{
    const Plan *plan = p->g->plan;
    const Subset *subset = p->subset;
    const int own = subset->body[0], start = plan->start_offset[p->number];
    switch (e.array) {
    case ARRAY_x: return element_at(ARRAY_x, subset->dep[e.index]);
    case ARRAY_rate: return element_at(ARRAY_xd, subset->dep[e.index]);
    case ARRAY_turn: return element_at(ARRAY_y, 10 + plan->free_coordinates + e.index);
    case ARRAY_known: return element_at(ARRAY_m, plan->motion_offset[subset->known[e.which]] + e.index);
    case ARRAY_d: return element_at(ARRAY_self_derived, plan->derived_offset[p->number] + e.index);
    case ARRAY_motion: return element_at(ARRAY_m, plan->motion_offset[own] + e.index);
    case ARRAY_inertia: return element_at(ARRAY_n, plan->inertia_offset[p->number] + e.index);
    case ARRAY_start: return element_at(ARRAY_start, start + e.index);
    case ARRAY_f: return element_at(ARRAY_start, start + plan->formula[subset->class]->layout.start_factors + e.index);
    case ARRAY_w: return element_at(ARRAY_lambda, plan->multiplier_offset[own] + e.index);
    case ARRAY_onto: return element_at(ARRAY_lambda, plan->multiplier_offset[subset->known[e.which]] + e.index);
    default: return e;
    }
}

/* In blocks of one wheel, and of all. */
static Element place_of_wheels(const Pattern *p, Element e)
{
    const Model *model = p->g->model;
    const int place = p->wheel < 0 ? 0 : wheel_rolling(model, p->wheel), slow = p->g->plan->states;
    const int fast = slow + (p->wheel < 0 ? 0 : model->wheel[p->wheel].fast);
    switch (e.array) {
    case ARRAY_link: return element_at(ARRAY_link, LINK_NUMBERS * place + e.index);
    case ARRAY_fast: return element_at(ARRAY_y, fast + e.index);
    case ARRAY_rate: return element_at(ARRAY_rate, fast + e.index);
    case ARRAY_torque: return element_at(ARRAY_torque, 2 * place + e.index);
    case ARRAY_grip:
    case ARRAY_self_grip: return element_at(ARRAY_grip, GRIP_NUMBERS * place + e.index);
    case ARRAY_self_watch: return element_at(ARRAY_watch, e.index);
    default: return e;
    }
}

/* The set of a number; NULL: it has none. */
static Set set_of(const Pattern *p, Element e, bool fast)
{
    if (p->subset)
        e = place_in_subset(p, e);
    else if (fast)
        e = place_of_wheels(p, e);
    else if (e.array == ARRAY_self_grip)
        e.array = ARRAY_grip;
    else if (e.array == ARRAY_self_watch)
        e.array = ARRAY_watch;
    return p->of[e.array] && e.index < p->count[e.array] ? p->of[e.array][e.index] : NULL;
}

/* Run a block of tangents. fast: rate[] are those of fast states. */
static void run(const Pattern *p, const Block *block, bool fast)
{
    const Dag *dag = block->dag;
    Pool *pool = p->g->pool;
    Ex *root = pool_alloc(pool, ((size_t)block->stores + 1) * sizeof *root);
    Set *set = pool_alloc(pool, (size_t)dag->nodes * sizeof *set);
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    const bool *needed = dag_needed(dag, root, block->stores);
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        if (!needed[e] || node->level < LEVEL_VARIABLE)
            continue;
        if (node->op == OP_INPUT && node->element->slope) {
            set[e] = set_of(p, *node->element, fast);
            continue;
        }
        for (int i = 0; i < ex_arity((Op)node->op); ++i) {
            const bool *from = set[node->arg[i]];
            if (!from || from == set[e])
                continue;
            const bool *first = set[e];
            if (!first) { /* shared until there is a second one */
                set[e] = set[node->arg[i]];
                continue;
            }
            set[e] = pool_alloc(pool, (size_t)p->columns + 1);
            join(p, set[e], first);
            join(p, set[e], from);
        }
    }
    for (int i = 0; i < block->stores; ++i) { /* values come before all stores */
        const Store *store = &block->store[i];
        const bool *from = store->target.slope ? set[store->value] : NULL;
        bool *to = from ? set_of(p, store->target, fast) : NULL;
        if (to && to != from)
            join(p, to, from);
    }
}

/* ---- the order of generated code: emit/tangent.c ------------------------------------------------------------- */

static void open_columns(Pattern *p)
{
    const Generation *g = p->g;
    const Plan *plan = g->plan;
    const Model *model = g->model;
    const int number[][2] = {
        {ARRAY_y, states(g)}, {ARRAY_u, model->inputs}, {ARRAY_p, model->tunables}, {ARRAY_port, 6 * model->ports}};
    const int kept[][2] = {{ARRAY_e, model->free_base ? 4 : 0},
                           {ARRAY_x, model->coordinates},
                           {ARRAY_xd, model->coordinates},
                           {ARRAY_m, plan->motion_size},
                           {ARRAY_n, plan->inertia_size},
                           {ARRAY_start, plan->start_size},
                           {ARRAY_lambda, plan->multipliers},
                           {ARRAY_rate, states(g)},
                           {ARRAY_out, model->output_components},
                           {ARRAY_self_derived, model->tuning ? plan->derived->count : 0},
                           {ARRAY_contact, CONTACT_NUMBERS},
                           {ARRAY_force, TIRE_FORCES},
                           {ARRAY_link, g->formulation->wheels ? g->formulation->wheels->links : 0},
                           {ARRAY_torque, g->formulation->wheels ? 2 * g->formulation->wheels->count : 0},
                           {ARRAY_grip, g->formulation->wheels ? GRIP_NUMBERS * g->formulation->wheels->count : 0},
                           {ARRAY_watch, WATCH_NUMBERS}};
    p->columns = jacobian_columns(g);
    for (size_t i = 0; i < sizeof kept / sizeof *kept; ++i)
        open_array(p, (Array)kept[i][0], kept[i][1]);
    int column = 0;
    for (size_t k = 0; k < sizeof number / sizeof *number; ++k) {
        open_array(p, (Array)number[k][0], number[k][1]);
        for (int i = 0; i < number[k][1]; ++i)
            p->of[number[k][0]][i][column++] = true;
    }
    for (int i = 0; model->free_base && i < 4; ++i) /* the dependent one follows from the others */
        for (int k = 0; k < 4; ++k)
            join(p, p->of[ARRAY_e][i], p->of[ARRAY_y][3 + k]);
    for (int w = 0; w < model->coordinates; ++w) {
        const Coordinate *c = &model->coordinate[w];
        join(p, p->of[ARRAY_x][w], c->driven ? p->of[ARRAY_u][c->input] : p->of[ARRAY_y][plan->coordinate_state[w]]);
        join(p, p->of[ARRAY_xd][w],
             c->driven ? p->of[ARRAY_u][c->input + 1] : p->of[ARRAY_y][plan->coordinate_rate[w]]);
    }
}

static void run_subsets(Pattern *p)
{
    const Generation *g = p->g;
    for (p->number = 0; p->number < g->sequence->subsets; ++p->number) {
        p->subset = &g->sequence->subset[p->number];
        if (p->subset->class >= 0)
            run(p, class_tangent(g, p->subset->class, false), false);
    }
    p->subset = NULL;
}

/* In reverse computational sequence. */
static void run_reactions(Pattern *p)
{
    const Generation *g = p->g;
    if (!formulation_reacts(g->formulation))
        return;
    const bool *needed = reactions_needed(g->pool, g->model, g->sequence);
    run(p, whole_tangent(g, g->formulation->wrenches), false);
    for (p->number = g->sequence->subsets - 1; p->number >= 0; --p->number) {
        p->subset = &g->sequence->subset[p->number];
        if (p->subset->class >= 0 && needed[p->number])
            run(p, whole_tangent(g, &g->plan->formula[p->subset->class]->react), false);
    }
    p->subset = NULL;
}

static void run_wheels(Pattern *p)
{
    const Generation *g = p->g;
    const Wheels *wheels = g->formulation->wheels;
    if (!wheels)
        return;
    run(p, whole_tangent(g, &wheels->link), true);
    run(p, whole_tangent(g, &wheels->torque), true);
    for (int c = 0; c < wheels->classes; ++c)
        for (int i = 0; i < wheels->class[c].members; ++i) {
            p->wheel = wheels->class[c].member[i];
            open_array(p, ARRAY_contact, CONTACT_NUMBERS);
            open_array(p, ARRAY_force, TIRE_FORCES);
            run(p, whole_tangent(g, &wheels->class[c].contact), true);
            run(p, whole_tangent(g, &wheels->class[c].tire), true);
            run(p, whole_tangent(g, &wheels->class[c].balance), true);
        }
    p->wheel = -1;
    if (g->model->powertrain)
        run(p, whole_tangent(g, &wheels->drive), true);
}

static const Pattern *pattern_new(Generation *g)
{
    Pattern *p = pool_alloc(g->pool, sizeof *p);
    *p = (Pattern){.g = g, .wheel = -1};
    open_columns(p);
    if (g->model->tuning)
        run(p, whole_tangent(g, derive_block(g->pool, g->plan)), false);
    run_subsets(p);
    run_wheels(p);
    run(p, whole_tangent(g, g->formulation->dynamics), false);
    run_reactions(p);
    run(p, whole_tangent(g, g->formulation->outputs), false);
    return p;
}

const bool *columns_apart(Generation *g)
{
    const Model *model = g->model;
    const int first = states(g) + model->inputs;
    bool *apart = pool_alloc(g->pool, (size_t)jacobian_columns(g) + 1);
    Pattern p = {.g = g, .wheel = -1};
    open_columns(&p);
    if (model->tuning)
        run(&p, whole_tangent(g, derive_block(g->pool, g->plan)), false);
    for (int i = 0; model->tuning && i < p.count[ARRAY_self_derived]; ++i)
        for (int k = 0; k < model->tunables; ++k)
            apart[first + k] = apart[first + k] || p.of[ARRAY_self_derived][i][first + k];
    return apart;
}

int jacobian_columns(const Generation *g)
{
    return states(g) + g->model->inputs + g->model->tunables + 6 * g->model->ports;
}

/* Can the derivative of a row, a rate or an output, by a column be anything but 0? */
static bool may_change(const Pattern *p, int row, int column)
{
    const int rates = p->count[ARRAY_rate];
    return row < rates ? p->of[ARRAY_rate][row][column] : p->of[ARRAY_out][row - rates][column];
}

const bool *jacobian_pattern(Generation *g)
{
    const Pattern *p = pattern_new(g);
    const int n = states(g);
    bool *pattern = pool_alloc(g->pool, (size_t)(n * n) + 1);
    for (int r = 0; r < n; ++r)
        for (int c = 0; c < n; ++c)
            pattern[n * r + c] = may_change(p, r, c);
    return pattern;
}

static int rows_of(const Generation *g)
{
    return states(g) + g->model->output_components;
}

/* ---- text ---------------------------------------------------------------------------------------------------- */

void write_jacobian_sizes(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Pattern *p = pattern_new(g);
    int count = 0;
    for (int r = 0; r < rows_of(g); ++r)
        for (int c = 0; c < p->columns; ++c)
            count += may_change(p, r, c);
    line(out, indent, "%s_JACOBIAN_ROWS = %d, /* rates, outputs */", g->upper, rows_of(g));
    line(out, indent, "%s_JACOBIAN_COLUMNS = %d, /* states, inputs, parameters, ports */", g->upper, p->columns);
    line(out, indent, "%s_JACOBIAN_NONZEROS = %d", g->upper, count);
}

/* What may be other than 0, drawn: a line a rate or an output, a sign a column. */
void write_jacobian_picture(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Pattern *p = pattern_new(g);
    const int widest = 80, ends[] = {states(g), states(g) + g->model->inputs,
                                     states(g) + g->model->inputs + g->model->tunables, p->columns};
    const char **name = pool_alloc(g->pool, ((size_t)rows_of(g) + 1) * sizeof *name);
    int rows = 0;
    for (int i = 0; i < states(g); ++i)
        name[rows++] = pool_print(g->pool, "rate of %s", state_number(g->pool, g->formulation, i).name);
    for (int i = 0; i < g->model->outputs; ++i)
        for (int c = 0; c < g->model->output[i].count; ++c)
            name[rows++] = g->model->output[i].component[c];
    if (p->columns > widest)
        return;
    line(out, indent, "/* What may be other than 0 (x); columns: states, inputs, parameters, ports.");
    line(out, indent, " *");
    for (int r = 0; r < rows; ++r) {
        text_print(out, "%*s * %-30.30s ", indent, "", name[r]);
        for (int c = 0; c < p->columns; ++c) {
            for (int k = 0; k < 3; ++k)
                if (c && c == ends[k] && c != (k ? ends[k - 1] : 0))
                    text_print(out, "|");
            text_print(out, "%s", may_change(p, r, c) ? "x" : ".");
        }
        text_print(out, "\n");
    }
    line(out, indent, " */");
}

void write_jacobian_rows(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Pattern *p = pattern_new(g);
    for (int c = 0; c < p->columns; ++c) {
        text_print(out, "%*s", indent, "");
        for (int r = 0; r < rows_of(g); ++r)
            if (may_change(p, r, c))
                text_print(out, "%d, ", r);
        text_print(out, "/* column %d */\n", c);
    }
    line(out, indent, "0 /* the end */");
}

void write_jacobian_starts(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Pattern *p = pattern_new(g);
    int count = 0;
    for (int c = 0; c <= p->columns; ++c) {
        if (c % 12)
            text_print(out, " ");
        else
            text_print(out, "%*s", indent, "");
        text_print(out, "%d%s", count, c < p->columns ? "," : "");
        text_print(out, c % 12 == 11 || c == p->columns ? "\n" : "");
        for (int r = 0; c < p->columns && r < rows_of(g); ++r)
            count += may_change(p, r, c);
    }
}
