/* SPDX-License-Identifier: MIT
 * The interpreter's loop once more, with the derivative of every number along one direction beside it. */
#include "gic_runtime.h"
#include "tape/journal.h"
#include "tape/play_private.h"
#include "tape/record.h"

#include <math.h>
#include <string.h>

/* A factor that is not finite where nothing changes (sqrt at 0) must not spoil the result. */
static double chain(double factor, double change)
{
    return change == 0 ? 0 : factor * change;
}

/* True if x, which changes by dx, is 0 within rounding and the accuracy of an equilibrium. */
static bool meets(const TapeWorld *world, double x, double dx)
{
    const bool met = dx != 0 && fabs(x) <= world->near * fabs(dx);
    if (met && world->kinks)
        ++*world->kinks;
    return met;
}

static double abs_change(const TapeWorld *world, double a, double da)
{
    if (meets(world, a, da))
        return fabs(da);
    return a > 0 ? da : a < 0 ? -da : 0;
}

/* The root of a square is an absolute value. */
static double sqrt_change(const TapeWorld *world, double root, double da)
{
    const double change = chain(0.5 / root, da);
    return isfinite(change) && meets(world, root, change) ? fabs(change) : change;
}

static double min_change(const TapeWorld *world, double a, double b, double da, double db)
{
    if (meets(world, a - b, da - db))
        return fmin(da, db);
    return a < b ? da : db;
}

/* True if x is positive; at 0, if its change dx is positive. */
static bool is_positive(const TapeWorld *world, double x, double dx)
{
    return meets(world, x, dx) ? dx > 0 : x > 0;
}

/* Slope of the piece of a table at x; at a point of it, that of the piece towards which x changes. */
double tape_table_slope(const TapeWorld *world, const gic_table *table, double x, double dx)
{
    const double *at = table->x, *y = table->y;
    int low = 0, high = table->count - 1;
    const bool after = is_positive(world, x - at[0], dx), before = is_positive(world, at[high] - x, -dx);
    if (!after || !before)
        return table->onward ? table->slope[after ? high : 0] : 0;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (is_positive(world, at[middle] - x, -dx))
            high = middle;
        else
            low = middle;
    }
    const double h = at[high] - at[low], t = (x - at[low]) / h, u = 1 - t;
    if (!table->cubic)
        return (y[high] - y[low]) / h;
    return 6 * t * u * (y[high] - y[low]) / h + u * (1 - 3 * t) * table->slope[low] +
           t * (3 * t - 2) * table->slope[high];
}

/* How slopes change by 1 m along a direction where kinks are met, the mean of both sides: a central difference of
 * fourth order with a step of 1 mm. False where the road has no finite height. */
static bool slopes_beside(const TapeWorld *world, double x, double y, double dx, double dy, double out[3])
{
    const double step = 1e-3;
    double side[4][3];
    bool good = true;
    for (int i = 0; i < 4; ++i) {
        const double reach = (i < 2 ? i - 2 : i - 1) * step;
        good = tape_road(world, x + reach * dx, y + reach * dy, side[i]) && good;
    }
    for (int k = 1; k < 3; ++k)
        out[k] = (side[0][k] - side[3][k] + 8 * (side[2][k] - side[1][k])) / (12 * step);
    return good;
}

bool tape_road_change(const TapeWorld *world, double x, double y, double dx, double dy, const double road[3],
                      double out[3])
{
    const double length = hypot(dx, dy);
    double bend[3];
    out[0] = chain(road[1], dx) + chain(road[2], dy);
    out[1] = out[2] = 0;
    if (!world->road || length == 0)
        return true;
    if (!(world->near > 0)) {
        gic_road_bend(world->road, world->lane, world->time, x, y, bend);
        out[1] = bend[0] * dx + bend[1] * dy;
        out[2] = bend[1] * dx + bend[2] * dy;
        return gic_finite(bend, 3);
    }
    const bool good = slopes_beside(world, x, y, dx / length, dy / length, out);
    out[1] *= length;
    out[2] *= length;
    return good;
}

/* In the same way. */
double tape_friction_change(const TapeWorld *world, double x, double y, double dx, double dy)
{
    const double step = 1e-3, length = hypot(dx, dy);
    double side[4], slope[2];
    if (!world->road || length == 0)
        return 0;
    if (!(world->near > 0)) {
        gic_road_friction_slope(world->road, world->lane, world->time, x, y, slope);
        return slope[0] * dx + slope[1] * dy;
    }
    for (int i = 0; i < 4; ++i) {
        const double reach = (i < 2 ? i - 2 : i - 1) * step / length;
        side[i] = tape_friction(world, x + reach * dx, y + reach * dy);
    }
    return length / (12 * step) * (side[0] - side[3] + 8 * (side[2] - side[1]));
}

static double power_change(double a, double b, double da, double db)
{
    return chain(b * pow(a, b - 1), da) + (db == 0 ? 0 : pow(a, b) * log(a) * db);
}

/* At a = b = 0 there is no angle, and 0 stands for its change. */
static double atan2_change(double a, double b, double da, double db)
{
    const double square = a * a + b * b;
    return square > 0 ? (b * da - a * db) / square : 0;
}

/* The angle jumps from pi to -pi where a passes 0 at negative b: on the way that changes there, that of its side. */
static double atan2_side(const TapeWorld *world, double a, double b, double da)
{
    return b < 0 && meets(world, a, da) ? atan2(copysign(a, da), b) : atan2(a, b);
}

/* The result's slot may be an argument's: the derivative first, from arguments that are still there. */
#define RUN_1(value, change) \
    for (; left; --left, at += 2) { \
        const double a = f[at[1]], da = d[at[1]], r = (value); \
        d[at[0]] = (change); \
        f[at[0]] = r; \
    } \
    break
#define RUN_2(value, change) \
    for (; left; --left, at += 3) { \
        const double a = f[at[1]], da = d[at[1]], b = f[at[2]], db = d[at[2]], r = (value); \
        d[at[0]] = (change); \
        f[at[0]] = r; \
    } \
    break
#define RUN_3(value, change) \
    for (; left; --left, at += 4) { \
        const double a = f[at[1]], da = d[at[1]], b = f[at[2]], db = d[at[2]], c = f[at[3]], dc = d[at[3]]; \
        const double r = (value); \
        d[at[0]] = (change); \
        f[at[0]] = r; \
    } \
    break

/* All runs; false when a road has no finite height. */
static bool play_runs(const Tape *tape, const TapeWorld *world, double *f, double *d)
{
    const uint32_t *at = tape->operand;
    bool on_road = true;
    for (const TapeRun *run = tape->run, *end = run + tape->runs; run < end; ++run) {
        int left = run->count;
        switch (run->kind) {
        case TAPE_MUL_ADD: RUN_3(a * b + c, a * db + da * b + dc);
        case TAPE_MUL_SUB: RUN_3(a * b - c, a * db + da * b - dc);
        case TAPE_SUB_MUL: RUN_3(c - a * b, dc - (a * db + da * b));
        case OP_NEG: RUN_1(-a, -da);
        case OP_ADD: RUN_2(a + b, da + db);
        case OP_SUB: RUN_2(a - b, da - db);
        case OP_MUL: RUN_2(a * b, a * db + da * b);
        case OP_DIV: RUN_2(a / b, (da - r * db) / b);
        case OP_SQRT: RUN_1(sqrt(a), sqrt_change(world, r, da));
        case OP_ABS: RUN_1(fabs(a), abs_change(world, a, da));
        case OP_SIN: RUN_1(sin(a), cos(a) * da);
        case OP_COS: RUN_1(cos(a), -sin(a) * da);
        case OP_TAN: RUN_1(tan(a), (1 + r * r) * da);
        case OP_ASIN: RUN_1(asin(a), chain(1 / sqrt(1 - a * a), da));
        case OP_ACOS: RUN_1(acos(a), chain(-1 / sqrt(1 - a * a), da));
        case OP_ATAN: RUN_1(atan(a), da / (1 + a * a));
        case OP_EXP: RUN_1(exp(a), r * da);
        case OP_LOG: RUN_1(log(a), chain(1 / a, da));
        case OP_TANH: RUN_1(tanh(a), (1 - r * r) * da);
        case OP_POW: RUN_2(pow(a, b), power_change(a, b, da, db));
        case OP_ATAN2: RUN_2(atan2_side(world, a, b, da), atan2_change(a, b, da, db));
        case OP_MIN: RUN_2(a < b ? a : b, min_change(world, a, b, da, db));
        case OP_MAX: RUN_2(a > b ? a : b, -min_change(world, -a, -b, -da, -db));
        case OP_POSITIVE:
            for (; left; --left, at += 4) {
                const uint32_t taken = is_positive(world, f[at[1]], d[at[1]]) ? at[2] : at[3];
                d[at[0]] = d[taken];
                f[at[0]] = f[taken];
            }
            break;
        case OP_FRICTION: RUN_2(tape_friction(world, a, b), tape_friction_change(world, a, b, da, db));
        case OP_TABLE:
            for (; left; --left, at += 3) {
                const gic_table *table = &world->table[at[2]];
                const double a = f[at[1]];
                d[at[0]] = chain(tape_table_slope(world, table, a, d[at[1]]), d[at[1]]);
                f[at[0]] = gic_table_value(table, a);
            }
            break;
        case OP_ROAD:
            for (; left; --left, at += 3) {
                const double x = f[at[1]], y = f[at[2]], dx = d[at[1]], dy = d[at[2]];
                on_road = tape_road(world, x, y, f + at[0]) && on_road;
                on_road = tape_road_change(world, x, y, dx, dy, f + at[0], d + at[0]) && on_road;
            }
            break;
        default: break;
        }
    }
    return on_road;
}

int tape_play_dual(const Tape *tape, int member, double *const *array, double *const *slope, const TapeWorld *world,
                   double *frame, double *rate)
{
    if (world->journal)
        return journal_play(world->journal, tape, member, array, slope, world);
    memcpy(frame, tape->constant + member * tape->constants, (size_t)tape->constants * sizeof *frame);
    memset(rate, 0, (size_t)tape->constants * sizeof *rate);
    tape_load(tape, array, frame);
    tape_load(tape, slope, rate);
    const bool on_road = play_runs(tape, world, frame, rate);
    const int status = tape_checked(tape, world, frame);
    if (status != GIC_OK)
        return status;
    if (!on_road)
        return GIC_ERROR_ROAD;
    tape_store(tape, array, frame);
    tape_store(tape, slope, rate);
    return GIC_OK;
}
