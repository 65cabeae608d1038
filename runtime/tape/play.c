/* SPDX-License-Identifier: MIT
 * The interpreter's loop. Operations of one kind come in runs, so that a choice of kind is paid once a run. */
#include "gic_runtime.h"
#include "tape/record.h"

#include <math.h>
#include <string.h>

static double minimum(double a, double b)
{
    return a < b ? a : b;
}

static double maximum(double a, double b)
{
    return a > b ? a : b;
}

bool tape_road(const TapeWorld *world, double x, double y, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    if (world->road)
        world->road->height(world->road, world->lane, world->time, x, y, out);
    return gic_finite(out, 3);
}

double tape_friction(const TapeWorld *world, double x, double y)
{
    const gic_road *road = world->road;
    return road && road->friction ? road->friction(road, world->lane, world->time, x, y) : 1;
}

#define RUN(operands, result) \
    for (; left; --left, at += (operands)) \
        f[at[0]] = (result); \
    break

/* All runs; false when a road has no finite height. */
static bool play_runs(const Tape *tape, const TapeWorld *world, double *f)
{
    const uint32_t *at = tape->operand;
    bool on_road = true;
    for (const TapeRun *run = tape->run, *end = run + tape->runs; run < end; ++run) {
        int left = run->count;
        switch (run->kind) {
        case TAPE_MUL_ADD: RUN(4, f[at[1]] * f[at[2]] + f[at[3]]);
        case TAPE_MUL_SUB: RUN(4, f[at[1]] * f[at[2]] - f[at[3]]);
        case TAPE_SUB_MUL: RUN(4, f[at[3]] - f[at[1]] * f[at[2]]);
        case OP_NEG: RUN(2, -f[at[1]]);
        case OP_ADD: RUN(3, f[at[1]] + f[at[2]]);
        case OP_SUB: RUN(3, f[at[1]] - f[at[2]]);
        case OP_MUL: RUN(3, f[at[1]] * f[at[2]]);
        case OP_DIV: RUN(3, f[at[1]] / f[at[2]]);
        case OP_SQRT: RUN(2, sqrt(f[at[1]]));
        case OP_ABS: RUN(2, fabs(f[at[1]]));
        case OP_SIN: RUN(2, sin(f[at[1]]));
        case OP_COS: RUN(2, cos(f[at[1]]));
        case OP_TAN: RUN(2, tan(f[at[1]]));
        case OP_ASIN: RUN(2, asin(f[at[1]]));
        case OP_ACOS: RUN(2, acos(f[at[1]]));
        case OP_ATAN: RUN(2, atan(f[at[1]]));
        case OP_EXP: RUN(2, exp(f[at[1]]));
        case OP_LOG: RUN(2, log(f[at[1]]));
        case OP_TANH: RUN(2, tanh(f[at[1]]));
        case OP_POW: RUN(3, pow(f[at[1]], f[at[2]]));
        case OP_ATAN2: RUN(3, atan2(f[at[1]], f[at[2]]));
        case OP_MIN: RUN(3, minimum(f[at[1]], f[at[2]]));
        case OP_MAX: RUN(3, maximum(f[at[1]], f[at[2]]));
        case OP_POSITIVE: RUN(4, f[at[1]] > 0 ? f[at[2]] : f[at[3]]);
        case OP_FRICTION: RUN(3, tape_friction(world, f[at[1]], f[at[2]]));
        case OP_TABLE: RUN(3, gic_table_value(&world->table[at[2]], f[at[1]]));
        case OP_ROAD:
            for (; left; --left, at += 3)
                on_road = tape_road(world, f[at[1]], f[at[2]], f + at[0]) && on_road;
            break;
        default: break;
        }
    }
    return on_road;
}

int tape_checked(const Tape *tape, const TapeWorld *world, const double *frame)
{
    for (int i = 0; i < tape->checks; ++i) {
        const TapeCheck *check = &tape->check[i];
        const double value = frame[check->slot];
        if (!((check->magnitude ? fabs(value) : value) > check->least)) {
            if (check->condition >= 0)
                world->head->condition = check->condition;
            if (check->subset >= 0 || check->state >= 0) {
                world->head->subset = check->subset;
                world->head->grown = check->state;
            }
            return check->status;
        }
    }
    return GIC_OK;
}

void tape_load(const Tape *tape, double *const *array, double *frame)
{
    for (int i = 0; i < tape->loads; ++i) {
        const TapeMove *load = &tape->load[i];
        for (int j = 0; j < load->count; ++j)
            frame[load->slot + j] = array[load->array][load->offset + j];
    }
}

void tape_store(const Tape *tape, double *const *array, const double *frame)
{
    for (int i = 0; i < tape->stores; ++i) {
        const TapeMove *store = &tape->store[i];
        array[store->array][store->offset] = frame[store->slot];
    }
}

int tape_play(const Tape *tape, int member, double *const *array, const TapeWorld *world, double *frame)
{
    memcpy(frame, tape->constant + member * tape->constants, (size_t)tape->constants * sizeof *frame);
    tape_load(tape, array, frame);
    const bool on_road = play_runs(tape, world, frame);
    const int status = tape_checked(tape, world, frame);
    if (status != GIC_OK)
        return status;
    if (!on_road)
        return GIC_ERROR_ROAD;
    tape_store(tape, array, frame);
    return GIC_OK;
}
