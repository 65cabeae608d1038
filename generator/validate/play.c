/* SPDX-License-Identifier: MIT
 * Blocks evaluated at several states side by side, node by node in the order of the graph. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "validate/play.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES_MOST = 16 };

/* One operation: result, arguments, number of lanes for vectors; steps: rows between the lanes of an argument, 0 for
 * one number for all lanes. */
typedef struct Operation {
    uint8_t op, lanes, step[3];
    int out, arg[3];
} Operation;

/* A copy between an array and rows of the frame. */
typedef struct Move {
    int array, index, row;
} Move;

/* A row of one number. */
typedef struct Number {
    int row;
    double value;
} Number;

typedef struct Test {
    int row, lanes;
    const Check *check;
} Test;

struct Program {
    int rows, members, constants, operations, loads, stores, tests, numbers;
    double *constant; /* [members][constants] for the first rows */
    Operation *operation;
    Move *load, *store;
    Test *test;
    Number *number;
};

typedef struct Recorder {
    Pool *pool;
    const Dag *dag;
    Program *program;
    int knowns;
    int *row; /* [nodes] first row, -1: not needed */
} Recorder;

int play_rows(const Program *program)
{
    return program->rows;
}

/* ---- recording ------------------------------------------------------------------------------------------------------
 */

static Move place_of(const Recorder *r, Element e)
{
    static const Array array[PLAY_KNOWN] = {
    /* clang-format off */
#define PLAY_ARRAY(name) [PLAY_##name] = ARRAY_##name,
        PLAY_ARRAYS(PLAY_ARRAY)
#undef PLAY_ARRAY
            /* clang-format on */
            [PLAY_DERIVED] = ARRAY_self_derived,
        [PLAY_GRIP] = ARRAY_self_grip,
        [PLAY_WATCH] = ARRAY_self_watch,
    };
    if (e.array == ARRAY_known || e.array == ARRAY_onto)
        return (Move){.array = PLAY_KNOWN + e.which + (e.array == ARRAY_onto ? r->knowns : 0), .index = e.index};
    for (int i = 0; i < PLAY_KNOWN; ++i)
        if (array[i] == e.array)
            return (Move){.array = i, .index = e.index};
    fprintf(stderr, "gicgen: error: the validation knows no array %d\n", (int)e.array);
    abort();
}

static void load_row(Recorder *r, Element e, int row)
{
    if (e.array == ARRAY_number) {
        *POOL_PUSH(r->pool, r->program->number, r->program->numbers) = (Number){row, e.number};
        return;
    }
    Move place = place_of(r, e);
    place.row = row;
    *POOL_PUSH(r->pool, r->program->load, r->program->loads) = place;
}

static int width_of(const Dag *dag, Ex e)
{
    return dag->node[e].wide ? dag->node[e].wide : 1;
}

/* Constants first; each lane of a vector is a row: members of a graph with lanes are its lanes. */
static void record_constants(Recorder *r, const bool *needed)
{
    const Dag *dag = r->dag;
    Program *program = r->program;
    const int each = dag->samples / dag->members;
    program->members = dag->lanes ? 1 : dag->members;
    for (int e = 0; e < dag->nodes; ++e)
        if (needed[e] && dag->node[e].level < LEVEL_VARIABLE) {
            r->row[e] = program->constants;
            program->constants += width_of(dag, (Ex)e);
        }
    program->constant = pool_alloc(r->pool, (size_t)(program->constants * program->members + 1) * sizeof(double));
    for (int e = 0; e < dag->nodes; ++e)
        for (int i = 0; r->row[e] >= 0 && i < (dag->lanes ? width_of(dag, (Ex)e) : dag->members); ++i) {
            const int place = dag->lanes ? r->row[e] + i : i * program->constants + r->row[e];
            program->constant[place] = ex_value(dag, (Ex)e, i * each);
        }
    program->rows = program->constants;
}

static void record_operation(Recorder *r, Ex e)
{
    const Node *node = &r->dag->node[e];
    Operation operation = {.op = node->op, .lanes = (uint8_t)width_of(r->dag, e), .out = r->row[e]};
    for (int i = 0; i < ex_arity((Op)node->op); ++i) {
        operation.arg[i] = r->row[node->arg[i]];
        operation.step[i] = r->dag->node[node->arg[i]].wide != 0;
    }
    if (node->op == OP_TABLE || node->op == OP_LANE)
        operation.arg[1] = (int)node->arg[1];
    if (node->op == OP_FOLD)
        operation.arg[2] = (int)node->arg[2];
    if (node->op == OP_LANE_SUM)
        operation.lanes = (uint8_t)width_of(r->dag, node->arg[0]);
    *POOL_PUSH(r->pool, r->program->operation, r->program->operations) = operation;
}

static void record_nodes(Recorder *r, const bool *needed)
{
    const Dag *dag = r->dag;
    Program *program = r->program;
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        if (!needed[e] || node->level < LEVEL_VARIABLE)
            continue;
        if (node->op == OP_ROAD_PART) {
            r->row[e] = r->row[node->arg[0]] + (int)node->arg[1] * width_of(dag, node->arg[0]);
            continue;
        }
        r->row[e] = program->rows;
        program->rows += (node->op == OP_ROAD ? 3 : 1) * width_of(dag, (Ex)e);
        if (node->op != OP_INPUT)
            record_operation(r, (Ex)e);
        for (int l = 0; node->op == OP_INPUT && l < width_of(dag, (Ex)e); ++l)
            load_row(r, node->element[l], r->row[e] + l);
    }
}

const Program *play_record(Pool *pool, const Block *block, int knowns)
{
    const Dag *dag = block->dag;
    Program *program = pool_alloc(pool, sizeof *program);
    if (!dag)
        return program;
    Ex *root = pool_alloc(pool, (size_t)(block->stores + block->checks + 1) * sizeof *root);
    int roots = 0;
    for (int i = 0; i < block->stores; ++i)
        root[roots++] = block->store[i].value;
    for (int i = 0; i < block->checks; ++i)
        root[roots++] = block->check[i].value;
    const bool *needed = dag_needed(dag, root, roots);
    Recorder r = {pool, dag, program, knowns, pool_alloc(pool, (size_t)dag->nodes * sizeof(int))};
    memset(r.row, -1, (size_t)dag->nodes * sizeof *r.row);
    record_constants(&r, needed);
    record_nodes(&r, needed);
    for (int i = 0; i < block->stores; ++i) {
        Move place = place_of(&r, block->store[i].target);
        place.row = r.row[block->store[i].value];
        *POOL_PUSH(pool, program->store, program->stores) = place;
    }
    for (int i = 0; i < block->checks; ++i)
        *POOL_PUSH(pool, program->test, program->tests) =
            (Test){r.row[block->check[i].value], width_of(dag, block->check[i].value), &block->check[i]};
    return program;
}

/* ---- playing --------------------------------------------------------------------------------------------------------
 */

#define EACH(value) \
    for (int s = 0; s < STATES; ++s) \
        out[s] = (value); \
    break

/* Height and slopes: three rows, `lanes` apart. */
static void play_road(const Scenery *scenery, const double *x, const double *y, Values *out, int lanes)
{
    for (int s = 0; s < STATES; ++s) {
        double road[3] = {0, 0, 0};
        if (scenery->road)
            scenery->road->height(scenery->road, 0, scenery->time[s], x[s], y[s], road);
        for (int i = 0; i < 3; ++i)
            out[i * lanes][s] = road[i];
    }
}

static double friction(const Scenery *scenery, int s, double x, double y)
{
    const gic_road *road = scenery->road;
    return road && road->friction ? road->friction(road, 0, scenery->time[s], x, y) : 1;
}

static void play_one(int op, const double *a, const double *b, const double *c, double *out)
{
    switch (op) {
    case OP_NEG: EACH(-a[s]);
    case OP_ADD: EACH(a[s] + b[s]);
    case OP_SUB: EACH(a[s] - b[s]);
    case OP_MUL: EACH(a[s] * b[s]);
    case OP_DIV: EACH(a[s] / b[s]);
    case OP_SQRT: EACH(sqrt(a[s]));
    case OP_ABS: EACH(fabs(a[s]));
    case OP_SIN: EACH(sin(a[s]));
    case OP_COS: EACH(cos(a[s]));
    case OP_TAN: EACH(tan(a[s]));
    case OP_ASIN: EACH(asin(a[s]));
    case OP_ACOS: EACH(acos(a[s]));
    case OP_ATAN: EACH(atan(a[s]));
    case OP_EXP: EACH(exp(a[s]));
    case OP_LOG: EACH(log(a[s]));
    case OP_TANH: EACH(tanh(a[s]));
    case OP_POW: EACH(pow(a[s], b[s]));
    case OP_ATAN2: EACH(atan2(a[s], b[s]));
    case OP_MIN: EACH(a[s] < b[s] ? a[s] : b[s]);
    case OP_MAX: EACH(a[s] > b[s] ? a[s] : b[s]);
    case OP_POSITIVE: EACH(a[s] > 0 ? b[s] : c[s]);
    default: break;
    }
}

static void fold(const Operation *o, Values *frame)
{
    const int bit = 1 << o->arg[2];
    for (int l = 0; l < o->lanes; ++l) {
        const int from = o->arg[(l & bit) != 0], step = o->step[(l & bit) != 0];
        for (int s = 0; s < STATES; ++s)
            frame[o->out + l][s] = frame[from + step * l][s] + frame[from + step * (l ^ bit)][s];
    }
}

/* Operations that read more than their arguments. */
static void play_asking(const Operation *o, int lane, const Scenery *scenery, Values *frame)
{
    double *out = frame[o->out + lane];
    const double *a = frame[o->arg[0] + lane * o->step[0]];
    const double *b = o->op == OP_TABLE ? a : frame[o->arg[1] + lane * o->step[1]];
    switch (o->op) {
    case OP_TABLE: EACH(gic_table_value(&scenery->table[o->arg[1]], a[s]));
    case OP_ROAD: play_road(scenery, a, b, &frame[o->out + lane], o->lanes); break;
    case OP_FRICTION: EACH(friction(scenery, s, a[s], b[s]));
    default: break;
    }
}

/* Operations between lanes. */
static void play_lanes(const Operation *o, Values *frame)
{
    double *out = frame[o->out];
    switch (o->op) {
    case OP_LANE: EACH(frame[o->arg[0] + o->arg[1]][s]);
    case OP_LANE_SUM:
        memset(out, 0, sizeof(Values));
        for (int l = 0; l < o->lanes; ++l)
            for (int s = 0; s < STATES; ++s)
                out[s] += frame[o->arg[0] + l][s];
        break;
    case OP_FOLD: fold(o, frame); break;
    default: break;
    }
}

static void play_tests(const Program *program, const Values *frame, Scenery *scenery)
{
    for (int i = 0; i < program->tests; ++i) {
        const Test *test = &program->test[i];
        for (int l = 0; l < test->lanes; ++l)
            for (int s = 0; s < STATES; ++s) {
                const double value = frame[test->row + l][s];
                if (!((test->check->magnitude ? fabs(value) : value) > test->check->least) && !scenery->refused[s])
                    scenery->refused[s] = status_name(test->check->status);
            }
    }
}

void play(const Program *program, int member, const Binding *array, Scenery *scenery, Values *frame)
{
    const double *constant = program->constant + member * program->constants;
    for (int i = 0; i < program->constants; ++i)
        for (int s = 0; s < STATES; ++s)
            frame[i][s] = constant[i];
    for (int i = 0; i < program->numbers; ++i)
        for (int s = 0; s < STATES; ++s)
            frame[program->number[i].row][s] = program->number[i].value;
    for (int i = 0; i < program->loads; ++i) {
        const Move *load = &program->load[i];
        memcpy(frame[load->row], array[load->array].row[array[load->array].stride * load->index], sizeof(Values));
    }
    for (const Operation *o = program->operation, *end = o + program->operations; o < end; ++o) {
        if (o->op >= OP_LANE) {
            play_lanes(o, frame);
            continue;
        }
        for (int l = 0; l < o->lanes; ++l)
            if (o->op > OP_POSITIVE)
                play_asking(o, l, scenery, frame);
            else
                play_one(o->op, frame[o->arg[0] + l * o->step[0]], frame[o->arg[1] + l * o->step[1]],
                         frame[o->arg[2] + l * o->step[2]], frame[o->out + l]);
    }
    play_tests(program, (const Values *)frame, scenery);
    for (int i = 0; i < program->stores; ++i) {
        const Move *store = &program->store[i];
        memcpy(array[store->array].row[array[store->array].stride * store->index], frame[store->row], sizeof(Values));
    }
}
