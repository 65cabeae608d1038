/* SPDX-License-Identifier: MIT
 * Motions of an axle: step by step from the position of set-up to both ends, by Newton's method for the travel of the
 * wheels' centres; and where it stops before, by name. */
#include "gic_runtime.h"
#include "run/kc.h"

#include <float.h>
#include <math.h>
#include <string.h>

const char *const kc_motion_name[KC_MOTIONS] = {"parallel", "opposite", "steer"};

/* What Newton's method is left with at most, as a share of the wheel's radius. */
static const double close_enough = 1e-12;
enum { NEWTON_MOST = 30, BISECTIONS = 48 };

typedef struct Way {
    const Kc *kc;
    const KcAxle *axle;
    KcMotion motion;
    KcLook *look;
    double zero[KC_WHEELS]; /* heights of the centres at set-up */
    double *w, *good;       /* [coordinates] */
    const char *why;        /* of the last failure */
} Way;

/* Velocity of a wheel along the motion. */
static double direction(const Way *way, int i)
{
    return way->motion == KC_STEER ? 0 : way->motion == KC_OPPOSITE ? way->axle->wheel[i].side : 1;
}

/* A coordinate that is beyond its range. */
static bool in_ranges(Way *way)
{
    const KcLook *look = way->look->whole ? way->look->whole : way->look;
    for (int k = 0; k < look->columns; ++k) {
        const Coordinate *c = &way->kc->model->coordinate[look->column[k]];
        const double w = way->w[look->column[k]], slack = 1e-12 * (c->range[1] - c->range[0]);
        if (w < c->range[0] - slack || w > c->range[1] + slack) {
            const bool low = w < c->range[0];
            way->why = pool_print(way->kc->pool, "coordinate '%s' is at the %s end of its range, %.6g", c->name,
                                  low ? "low" : "high", c->range[low ? 0 : 1]);
            return false;
        }
    }
    return true;
}

static bool look_at(Way *way)
{
    const int status = kc_look(way->kc, way->w, way->look);
    if (status != GIC_OK)
        way->why = kc_status(way->kc, status);
    return status == GIC_OK;
}

/* How far what hangs on rubber is from where its forces are balanced, as a share of the ranges. */
static double rest(const Way *way)
{
    double most = 0;
    for (int a = 0; a < way->axle->wheels + way->axle->followers; ++a) {
        const Coordinate *c = &way->kc->model->coordinate[way->look->whole->column[a]];
        most = fmax(most, fabs(way->look->relax[a]) / (c->range[1] - c->range[0]));
    }
    return most;
}

/* Bring the mechanism to a place `at` of the motion, from way->w. */
static bool reach(Way *way, double at)
{
    const KcAxle *axle = way->axle;
    double before = INFINITY;
    if (way->motion == KC_STEER)
        way->w[axle->steer] = at;
    for (int step = 0; step < NEWTON_MOST; ++step) {
        double missing[KC_WHEELS], along[KC_WHEELS + 1], most = 0;
        if (!look_at(way))
            return false;
        for (int i = 0; i < axle->wheels; ++i) {
            missing[i] = way->zero[i] + direction(way, i) * (way->motion == KC_STEER ? 0 : at) -
                         way->look->value[axle->wheel[i].centre + 2];
            most = fmax(most, fabs(missing[i]));
        }
        const double radius = axle->wheel[0].radius;
        if (way->look->axle)
            most = fmax(most, radius * rest(way));
        if (most <= 2 * DBL_EPSILON * radius || (most <= close_enough * radius && most >= before))
            return in_ranges(way);
        before = most;
        if (!kc_along(axle, way->look, false, missing, 0, along))
            break;
        along[axle->wheels] = 0;
        kc_move(way->look, along, 1, way->w);
        for (int a = 0; way->look->axle && a < axle->wheels + axle->followers; ++a)
            way->w[way->look->whole->column[a]] += way->look->relax[a];
    }
    way->why = "the mechanism does not reach further";
    return false;
}

static size_t bytes(const Way *way)
{
    return (size_t)way->kc->model->coordinates * sizeof *way->w;
}

static bool add_row(Way *way, double at, KcCurve *curve)
{
    const int n = way->axle->wheels;
    double vz[KC_WHEELS], along[KC_WHEELS + 1];
    KcRow row = {.at = at,
                 .wheel = pool_alloc(way->kc->pool, (size_t)n * sizeof *row.wheel),
                 .ratio = pool_alloc(way->kc->pool, ((size_t)n * (size_t)way->kc->elements + 1) * sizeof *row.ratio)};
    row.w = pool_alloc(way->kc->pool, bytes(way) + 1);
    memcpy(row.w, way->w, bytes(way));
    for (int i = 0; i < n; ++i)
        vz[i] = direction(way, i);
    int status = GIC_ERROR_SINGULAR;
    if (kc_along(way->axle, way->look, false, vz, way->motion == KC_STEER, along))
        status = kc_row(way->kc, way->axle, way->motion, way->w, way->look, along, &row);
    if (status != GIC_OK) {
        way->why = kc_status(way->kc, status);
        return false;
    }
    *POOL_PUSH(way->kc->pool, curve->row, curve->rows) = row;
    return true;
}

/* From the position of set-up to one end: rows are added after it. */
static void go(Way *way, double from, double to, KcCurve *curve, const char **stop)
{
    memcpy(way->w, way->kc->initial, bytes(way));
    for (int step = 1; step <= KC_STEPS; ++step) {
        const double at = from + (to - from) * step / KC_STEPS;
        memcpy(way->good, way->w, bytes(way));
        if (reach(way, at) && add_row(way, at, curve))
            continue;
        double good = from + (to - from) * (step - 1) / KC_STEPS, bad = at;
        for (int i = 0; i < BISECTIONS; ++i) {
            const double middle = good + (bad - good) / 2;
            memcpy(way->w, way->good, bytes(way));
            if (reach(way, middle))
                good = middle;
            else
                bad = middle;
        }
        *stop = way->why;
        memcpy(way->w, way->good, bytes(way));
        const double last = curve->rows ? curve->row[curve->rows - 1].at : from;
        if (fabs(good - last) > 1e-9 && reach(way, good))
            add_row(way, good, curve);
        return;
    }
}

static void turn_round(KcCurve *curve)
{
    for (int i = 0, j = curve->rows - 1; i < j; ++i, --j) {
        const KcRow kept = curve->row[i];
        curve->row[i] = curve->row[j];
        curve->row[j] = kept;
    }
}

static bool has_sides(const KcAxle *axle)
{
    bool left = false, right = false;
    for (int i = 0; i < axle->wheels; ++i) {
        left = left || axle->wheel[i].side > 0;
        right = right || axle->wheel[i].side < 0;
    }
    return left && right;
}

const KcCurve *kc_sweep(const Kc *kc, const KcAxle *axle, KcMotion motion, double travel, const char **why)
{
    Way way = {.kc = kc, .axle = axle, .motion = motion, .look = kc_look_new(kc, axle)};
    KcCurve *curve = pool_alloc(kc->pool, sizeof *curve), up = {.motion = motion};
    *curve = up;
    *why = axle->refusal                               ? axle->refusal
           : motion == KC_STEER                        ? axle->unsteered
           : motion == KC_OPPOSITE && !has_sides(axle) ? "it has wheels on one side only"
                                                       : NULL;
    if (*why)
        return NULL;
    way.w = pool_alloc(kc->pool, bytes(&way) + 1);
    way.good = pool_alloc(kc->pool, bytes(&way) + 1);
    memcpy(way.w, kc->initial, bytes(&way));
    const Coordinate *steer = axle->steer >= 0 ? &kc->model->coordinate[axle->steer] : NULL;
    const double from = motion == KC_STEER ? kc->initial[axle->steer] : 0;
    if (look_at(&way))
        for (int i = 0; i < axle->wheels; ++i)
            way.zero[i] = way.look->value[axle->wheel[i].centre + 2];
    if (!reach(&way, from) || !add_row(&way, from, &up)) {
        *why = way.why;
        return NULL;
    }
    up.rows = 1;
    go(&way, from, motion == KC_STEER ? steer->range[0] : -travel, curve, &curve->stop[0]);
    turn_round(curve);
    curve->zero = curve->rows;
    go(&way, from, motion == KC_STEER ? steer->range[1] : travel, &up, &curve->stop[1]);
    for (int i = 0; i < up.rows; ++i)
        *POOL_PUSH(kc->pool, curve->row, curve->rows) = up.row[i];
    return curve;
}
