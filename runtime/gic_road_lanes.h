/* SPDX-License-Identifier: MIT
 *
 * gic_road_lanes: the roads of gic_road.h under a point of each lane at once. Each lane may have a road of its own; its
 * result depends on its own road and place alone and has the operations of gic_road.c in their order, so that without
 * contraction it has the bits of `height`, where LANE_SIN and LANE_COS have those of libm's functions. Roads whose kind
 * is GIC_ROAD_OWN are asked one by one.
 *
 *     #include "gic_lanes.h"
 *     #include "gic_road_lanes.h"
 *
 *     const gic_road *road[GIC_LANES];
 *     int32_t lane[GIC_LANES];
 *     gic_lane time, x, y, out[3];
 *     LANE_HEIGHTS(road, lane, &time, &x, &y, out);
 *
 * sets out[0] = h, out[1] = dh/dx, out[2] = dh/dy, metres, world frame; 0 where the road is NULL.
 * LANE_FRICTIONS(road, lane, &time, &x, &y) is `friction`, 1 where there is none. Like gic_lanes.h it
 * may be included again for another GIC_LANES. It needs no gic_road.c. */
#ifndef GIC_LANES
#error "include gic_lanes.h first"
#endif

#ifndef GIC_ROAD_LANES_H
#define GIC_ROAD_LANES_H

#include "gic_road.h"

#include <stddef.h>

#define LANE_HEIGHTS GIC_LANES_NAME(lane_heights_, GIC_LANES)
#define LANE_FRICTIONS GIC_LANES_NAME(lane_frictions_, GIC_LANES)
#define LANE_ONE_KIND GIC_LANES_NAME(lane_one_kind_, GIC_LANES)
#define LANE_ROAD_NUMBER GIC_LANES_NAME(lane_road_number_, GIC_LANES)
#define LANE_SUPPORT GIC_LANES_NAME(lane_support_, GIC_LANES)
#define LANE_SUPPORT_AT GIC_LANES_NAME(lane_support_at_, GIC_LANES)
#define LANE_PLACE GIC_LANES_NAME(gic_place_, GIC_LANES)
#define LANE_FETCH(place) GIC_LANES_NAME(lane_fetch_, GIC_LANES)(place)
#define LANE_WHOLE(x) __builtin_convertvector(x, LANE_PLACE)
#define LANE_KEPT(m, x) ((gic_lane)((m) & (gic_mask)(x)))
/* The road of lane l as what it is. */
#define GIC_ROAD_AS(type, l) ((const type *)(const void *)road[l])
/* A number of each lane's road; `road` and `same` are the function's. */
#define GIC_OF_ROADS(type, member) LANE_ROAD_NUMBER(road, same, offsetof(type, member))
/* Where a number is in memory, and how far the next one is. */
#define GIC_PLACE_OF(number) ((int64_t)(uintptr_t)(number))
#define GIC_REAL_SIZE ((int64_t)sizeof(gic_real))
/* A number of each lane's patch; `patch` and `same` are the function's. */
#define GIC_OF_PATCHES(member) \
    do { \
        if (same) { \
            member = LANE(patch[0]->member); \
        } else { \
            FOR_LANES(l) \
            member[l] = patch[l]->member; \
        } \
    } while (0)
#define GIC_TWO_PI GIC_R(6.283185307179586476925286766559)

/* The piece of a table that x, inside of it or no number, is in, by its first point. */
static inline int32_t gic_lane_piece(const gic_road_table *table, gic_real x)
{
    int32_t low = 0, high = table->count - 1;
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (x < table->x[middle])
            high = middle;
        else
            low = middle;
    }
    return low;
}

#endif

#if GIC_LANES == 2 && !defined(GIC_ROAD_LANES_2)
#define GIC_ROAD_LANES_2
#define GIC_ROAD_LANES_NEW
#elif GIC_LANES == 4 && !defined(GIC_ROAD_LANES_4)
#define GIC_ROAD_LANES_4
#define GIC_ROAD_LANES_NEW
#elif GIC_LANES == 8 && !defined(GIC_ROAD_LANES_8)
#define GIC_ROAD_LANES_8
#define GIC_ROAD_LANES_NEW
#elif GIC_LANES == 16 && !defined(GIC_ROAD_LANES_16)
#define GIC_ROAD_LANES_16
#define GIC_ROAD_LANES_NEW
#elif GIC_LANES > 16 || GIC_LANES == 1
#define GIC_ROAD_LANES_NEW
#endif
#ifdef GIC_ROAD_LANES_NEW

static __attribute__((noinline, unused)) void LANE_HEIGHTS(const gic_road *const *road, const int32_t *lane,
                                                           const gic_lane *time, const gic_lane *x, const gic_lane *y,
                                                           gic_lane out[3]);

typedef int64_t LANE_PLACE __attribute__((vector_size(GIC_LANES * sizeof(int64_t))));

/* The numbers at places in memory. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_fetch_, GIC_LANES)(LANE_PLACE place)
{
    gic_lane number;
    int l = 0;
#if defined(__AVX512F__) && !defined(GIC_FLOAT)
    for (; l + 8 <= GIC_LANES; l += 8) {
        long long from __attribute__((vector_size(64)));
        double part __attribute__((vector_size(64))) = {0};
        memcpy(&from, (const char *)&place + l * 8, sizeof from);
        part = __builtin_ia32_gatherdiv8df(part, NULL, from, -1, 1);
        memcpy((char *)&number + l * 8, &part, sizeof part);
    }
#endif
    for (; l < GIC_LANES; ++l)
        number[l] = *(const gic_real *)(uintptr_t)place[l];
    return number;
}

/* The number at `place` of each lane's road; same: they are one road. */
LANE_FUNCTION gic_lane LANE_ROAD_NUMBER(const gic_road *const *road, int same, size_t place)
{
    gic_lane number;
    int l;
    if (same)
        return LANE(*(const gic_real *)(const void *)((const char *)road[0] + place));
    FOR_LANES(l)
    number[l] = *(const gic_real *)(const void *)((const char *)road[l] + place);
    return number;
}

static __attribute__((unused)) void GIC_LANES_NAME(lane_planes_, GIC_LANES)(const gic_road *const *road, int same,
                                                                            gic_lane x, gic_lane y, gic_lane out[3])
{
    const gic_lane sx = GIC_OF_ROADS(gic_road_plane, sx), sy = GIC_OF_ROADS(gic_road_plane, sy);
    out[0] = GIC_OF_ROADS(gic_road_plane, z0) + sx * x + sy * y;
    out[1] = sx;
    out[2] = sy;
}

static __attribute__((unused)) void GIC_LANES_NAME(lane_sines_, GIC_LANES)(const gic_road *const *road, int same,
                                                                           gic_lane x, gic_lane y, gic_lane out[3])
{
    const gic_lane amplitude = GIC_OF_ROADS(gic_road_sine, amplitude);
    const gic_lane across = GIC_OF_ROADS(gic_road_sine, phase_per_y);
    const gic_lane wave = GIC_TWO_PI / GIC_OF_ROADS(gic_road_sine, wavelength);
    const gic_lane phase = wave * (x - GIC_OF_ROADS(gic_road_sine, x0)) + across * y;
    const gic_lane slope = amplitude * LANE_COS(phase);
    out[0] = amplitude * LANE_SIN(phase);
    out[1] = slope * wave;
    out[2] = slope * across;
}

/* Add what bumps add to height and slope, where lanes are on them. One formula for lanes on one road and on several, so
 * that contraction does not tell them apart. */
LANE_FUNCTION void GIC_LANES_NAME(lane_on_bump_, GIC_LANES)(gic_mask on, gic_lane ahead, gic_lane length,
                                                            gic_lane height, gic_lane out[3])
{
    const gic_lane along = LANE_KEPT(on, ahead), wave = GIC_TWO_PI / length;
    out[0] += LANE_KEPT(on, GIC_R(0.5) * height * (GIC_R(1.0) - LANE_COS(wave * along)));
    out[1] += LANE_KEPT(on, GIC_R(0.5) * height * wave * LANE_SIN(wave * along));
}

/* One road of bumps under all lanes, places finite: each bump that any of them may be on. */
static __attribute__((unused)) void GIC_LANES_NAME(lane_same_bumps_, GIC_LANES)(const gic_road_bumps *bumps, gic_lane x,
                                                                                gic_lane y, gic_lane out[3])
{
    gic_real least = x[0], most = x[0];
    int32_t i;
    int l;
    FOR_LANES(l)
    {
        least = x[l] < least ? x[l] : least;
        most = x[l] > most ? x[l] : most;
    }
    for (i = gic_first_bump(bumps, least); i < bumps->count && bumps->bump[i].x < most; ++i) {
        const gic_bump *const bump = &bumps->bump[i];
        const gic_lane ahead = x - bump->x;
        const gic_mask on = (gic_mask)(x > bump->x) & (gic_mask)(ahead < bump->length) &
                            (gic_mask)(y >= bump->y_low - GIC_ROAD_EDGE) &
                            (gic_mask)(y <= bump->y_high + GIC_ROAD_EDGE);
        if (LANE_ANY(on))
            GIC_LANES_NAME(lane_on_bump_, GIC_LANES)(on, ahead, LANE(bump->length), LANE(bump->height), out);
    }
}

/* The k-th bump that each lane may be on, for all k. */
static __attribute__((unused)) void GIC_LANES_NAME(lane_bumps_, GIC_LANES)(const gic_road *const *road, int same,
                                                                           gic_lane x, gic_lane y, gic_lane out[3])
{
    const gic_lane zero = {GIC_R(0.0)};
    int32_t next[GIC_LANES];
    int l, any = 1;
    out[0] = out[1] = out[2] = zero;
    if (same && !LANE_ANY(~(LANE_FINITE(x) & LANE_FINITE(y)))) {
        GIC_LANES_NAME(lane_same_bumps_, GIC_LANES)(GIC_ROAD_AS(gic_road_bumps, 0), x, y, out);
        return;
    }
    FOR_LANES(l)
    next[l] = gic_first_bump(GIC_ROAD_AS(gic_road_bumps, l), x[l]);
    while (any) {
        gic_mask on = (gic_mask)(zero > zero);
        gic_lane start = zero, length = LANE(GIC_R(1.0)), height = zero;
        int found = 0;
        any = 0;
        FOR_LANES(l)
        {
            const gic_road_bumps *const bumps = GIC_ROAD_AS(gic_road_bumps, l);
            const gic_bump *bump;
            if (next[l] >= bumps->count || bumps->bump[next[l]].x >= x[l])
                continue;
            bump = &bumps->bump[next[l]];
            any = 1;
            ++next[l];
            if (x[l] - bump->x >= bump->length || y[l] < bump->y_low - GIC_ROAD_EDGE ||
                y[l] > bump->y_high + GIC_ROAD_EDGE)
                continue;
            found = 1;
            on[l] = -1;
            start[l] = bump->x;
            length[l] = bump->length;
            height[l] = bump->height;
        }
        if (found)
            GIC_LANES_NAME(lane_on_bump_, GIC_LANES)(on, x - start, length, height, out);
    }
}

static __attribute__((unused)) void GIC_LANES_NAME(lane_tables_, GIC_LANES)(const gic_road *const *road, gic_lane x,
                                                                            gic_lane y, gic_lane out[3])
{
    const gic_lane zero = {GIC_R(0.0)};
    gic_lane start, end, last, first_height, last_height;
    LANE_PLACE at, height, slope, low;
    gic_mask off;
    int l;
    FOR_LANES(l)
    {
        const gic_road_table *const table = GIC_ROAD_AS(gic_road_table, l);
        const int left = y[l] > GIC_ROAD_EDGE;
        const gic_real *const heights = left ? table->left : table->right;
        start[l] = table->x[0];
        end[l] = table->x[table->count - 1];
        last[l] = (gic_real)(table->count - 1);
        at[l] = GIC_PLACE_OF(table->x);
        height[l] = GIC_PLACE_OF(heights);
        slope[l] = GIC_PLACE_OF(left ? table->slope_left : table->slope_right);
        first_height[l] = heights[0];
        last_height[l] = heights[table->count - 1];
    }
    const gic_mask before = (gic_mask)(x <= start), beyond = (gic_mask)(x >= end), outside = before | beyond;
    /* the piece of x if points are evenly spaced; x may be no number */
    low = LANE_WHOLE(LANE_MIN(LANE_MAX((x - start) / (end - start) * last, zero), last - GIC_R(1.0)));
    gic_lane x0 = LANE_FETCH(at + low * GIC_REAL_SIZE), x1 = LANE_FETCH(at + (low + 1) * GIC_REAL_SIZE);
    off = ~outside & ~((gic_mask)(x >= x0) & (gic_mask)(x < x1));
    if (LANE_ANY(off)) {
        FOR_LANES(l)
        if (off[l])
            low[l] = gic_lane_piece(GIC_ROAD_AS(gic_road_table, l), x[l]);
        x0 = LANE_FETCH(at + low * GIC_REAL_SIZE);
        x1 = LANE_FETCH(at + (low + 1) * GIC_REAL_SIZE);
    }
    const gic_lane h0 = LANE_FETCH(height + low * GIC_REAL_SIZE);
    const gic_lane width = x1 - x0, s = (x - x0) / width, rise = LANE_FETCH(height + (low + 1) * GIC_REAL_SIZE) - h0;
    const gic_lane d0 = width * LANE_FETCH(slope + low * GIC_REAL_SIZE);
    const gic_lane d1 = width * LANE_FETCH(slope + (low + 1) * GIC_REAL_SIZE);
    const gic_lane c = GIC_R(3.0) * rise - GIC_R(2.0) * d0 - d1, b = d0 + d1 - GIC_R(2.0) * rise;
    const gic_lane inside = h0 + s * (d0 + s * (c + s * b));
    const gic_lane inner_slope = (d0 + s * (GIC_R(2.0) * c + s * GIC_R(3.0) * b)) / width;
    out[0] = LANE_SELECT(before, first_height, LANE_SELECT(beyond, last_height, inside));
    out[1] = LANE_KEPT(~outside, inner_slope);
    out[2] = zero;
}

/* What gic_road.c calls the support of a place on an axis, of each lane; in whole numbers and numbers. before, after:
 * -1 where the first and the last of its nodes count. */
typedef struct LANE_SUPPORT {
    LANE_PLACE cell, before, after;
    gic_lane weight[4], rate[4];
} LANE_SUPPORT;

LANE_FUNCTION LANE_SUPPORT LANE_SUPPORT_AT(gic_lane place, gic_lane first, gic_lane spacing, gic_lane last)
{
    const gic_lane zero = {GIC_R(0.0)};
    const gic_lane along = LANE_MIN(LANE_MAX((place - first) / spacing, zero), last);
    LANE_SUPPORT s;
    s.cell = LANE_WHOLE(LANE_MIN(along, last - GIC_R(1.0)));
    const gic_lane number = __builtin_convertvector(s.cell, gic_lane);
    const gic_lane t = along - number, u = GIC_R(1.0) - t, by = GIC_R(1.0) / spacing;
    const gic_mask before = (gic_mask)(number > zero), after = (gic_mask)(number + GIC_R(1.0) < last);
    s.before = __builtin_convertvector(before, LANE_PLACE);
    s.after = __builtin_convertvector(after, LANE_PLACE);
    /* the contribution of the slopes at the cell's two ends, 0 if an end is level */
    const gic_lane slope0 = LANE_KEPT(before, GIC_R(0.5) * t * u * u);
    const gic_lane slope1 = LANE_KEPT(after, GIC_R(-0.5) * t * t * u);
    const gic_lane slope0_rate = LANE_KEPT(before, GIC_R(0.5) * u * (u - GIC_R(2.0) * t) * by);
    const gic_lane slope1_rate = LANE_KEPT(after, GIC_R(0.5) * t * (t - GIC_R(2.0) * u) * by);
    const gic_lane rise = t * t * (GIC_R(3.0) - GIC_R(2.0) * t), rise_rate = GIC_R(6.0) * t * u * by;
    s.weight[0] = -slope0;
    s.weight[1] = GIC_R(1.0) - rise - slope1;
    s.weight[2] = rise + slope0;
    s.weight[3] = slope1;
    s.rate[0] = -slope0_rate;
    s.rate[1] = -rise_rate - slope1_rate;
    s.rate[2] = rise_rate + slope0_rate;
    s.rate[3] = slope1_rate;
    return s;
}

static __attribute__((unused)) void GIC_LANES_NAME(lane_grids_, GIC_LANES)(const gic_road *const *road, int same,
                                                                           gic_lane x, gic_lane y, gic_lane out[3])
{
    const gic_lane zero = {GIC_R(0.0)};
    const gic_mask finite = LANE_FINITE(x) & LANE_FINITE(y);
    gic_lane last_x, last_y;
    LANE_PLACE height, row;
    int i, j, l;
    FOR_LANES(l)
    {
        const gic_road_grid *const grid = GIC_ROAD_AS(gic_road_grid, l);
        last_x[l] = (gic_real)(grid->nx - 1);
        last_y[l] = (gic_real)(grid->ny - 1);
        row[l] = grid->nx;
        height[l] = GIC_PLACE_OF(grid->height);
    }
    const LANE_SUPPORT along =
        LANE_SUPPORT_AT(LANE_KEPT(finite, x), GIC_OF_ROADS(gic_road_grid, x0), GIC_OF_ROADS(gic_road_grid, dx), last_x);
    const LANE_SUPPORT across =
        LANE_SUPPORT_AT(LANE_KEPT(finite, y), GIC_OF_ROADS(gic_road_grid, y0), GIC_OF_ROADS(gic_road_grid, dy), last_y);
    const LANE_PLACE node[4] = {along.before, along.cell - along.cell, along.cell - along.cell + 1, 1 - along.after};
    const LANE_PLACE step[4] = {across.before, node[1], node[2], 1 - across.after};
    int needed[4] = {0, 1, 1, 0}; /* rows that none of the lanes needs are left out: they have weight 0 */
    FOR_LANES(l)
    {
        needed[0] |= across.before[l] != 0;
        needed[3] |= across.after[l] != 0;
    }
    out[0] = out[1] = out[2] = zero;
    for (j = 0; j < 4; ++j) {
        const LANE_PLACE at = height + ((across.cell + step[j]) * row + along.cell) * GIC_REAL_SIZE;
        gic_lane of_row = zero, slope = zero;
        if (!needed[j])
            continue;
        for (i = 0; i < 4; ++i) {
            const gic_lane one = LANE_FETCH(at + node[i] * GIC_REAL_SIZE);
            of_row += along.weight[i] * one;
            slope += along.rate[i] * one;
        }
        out[0] += across.weight[j] * of_row;
        out[1] += across.weight[j] * slope;
        out[2] += across.rate[j] * of_row;
    }
    out[0] = LANE_SELECT(finite, out[0], x + y);
    for (i = 1; i < 3; ++i)
        out[i] = LANE_KEPT(finite, out[i]);
}

static __attribute__((unused)) void GIC_LANES_NAME(lane_sums_, GIC_LANES)(const gic_road *const *road,
                                                                          const int32_t *lane, const gic_lane *time,
                                                                          gic_mask on, gic_lane x, gic_lane y,
                                                                          gic_lane out[3])
{
    const gic_lane zero = {GIC_R(0.0)};
    int32_t most = 0, i;
    int k, l;
    FOR_LANES(l)
    if (GIC_ROAD_AS(gic_road_sum, l)->count > most)
        most = GIC_ROAD_AS(gic_road_sum, l)->count;
    out[0] = out[1] = out[2] = zero;
    for (i = 0; i < most; ++i) {
        const gic_road *one[GIC_LANES];
        gic_lane part[3];
        FOR_LANES(l)
        {
            const gic_road_sum *const sum = GIC_ROAD_AS(gic_road_sum, l);
            one[l] = on[l] && i < sum->count ? sum->part[i] : NULL;
        }
        LANE_HEIGHTS(one, lane, time, &x, &y, part);
        for (k = 0; k < 3; ++k)
            out[k] += part[k];
    }
}

/* Heights of roads of one kind; same: they are one road. In lanes that are not `on` any of these roads stands in. */
static __attribute__((unused)) void LANE_ONE_KIND(const gic_road *const *road, int same, const int32_t *lane,
                                                  const gic_lane *time, gic_mask on, gic_lane x, gic_lane y,
                                                  gic_lane out[3])
{
    int i, l;
    switch (road[0]->kind) {
    case GIC_ROAD_PLANE: GIC_LANES_NAME(lane_planes_, GIC_LANES)(road, same, x, y, out); return;
    case GIC_ROAD_SINE: GIC_LANES_NAME(lane_sines_, GIC_LANES)(road, same, x, y, out); return;
    case GIC_ROAD_BUMPS: GIC_LANES_NAME(lane_bumps_, GIC_LANES)(road, same, x, y, out); return;
    case GIC_ROAD_TABLE: GIC_LANES_NAME(lane_tables_, GIC_LANES)(road, x, y, out); return;
    case GIC_ROAD_GRID: GIC_LANES_NAME(lane_grids_, GIC_LANES)(road, same, x, y, out); return;
    case GIC_ROAD_SUM: GIC_LANES_NAME(lane_sums_, GIC_LANES)(road, lane, time, on, x, y, out); return;
    case GIC_ROAD_PATCHED: {
        const gic_road *under[GIC_LANES];
        FOR_LANES(l)
        under[l] = on[l] ? GIC_ROAD_AS(gic_road_patched, l)->under : NULL;
        LANE_HEIGHTS(under, lane, time, &x, &y, out);
        return;
    }
    default: break;
    }
    FOR_LANES(l)
    {
        gic_real one[3];
        if (!on[l])
            continue;
        road[l]->height(road[l], lane[l], (*time)[l], x[l], y[l], one);
        for (i = 0; i < 3; ++i)
            out[i][l] = one[i];
    }
}

static __attribute__((noinline, unused)) void LANE_HEIGHTS(const gic_road *const *road, const int32_t *lane,
                                                           const gic_lane *time, const gic_lane *x, const gic_lane *y,
                                                           gic_lane out[3])
{
    const gic_lane zero = {GIC_R(0.0)};
    int left[GIC_LANES], i, l, any = 0, same = 1, first;
    FOR_LANES(l)
    {
        same &= road[l] == road[0];
        any += left[l] = road[l] != NULL;
    }
    if (same && any) {
        LANE_ONE_KIND(road, 1, lane, time, (gic_mask)(zero <= zero), *x, *y, out);
        return;
    }
    out[0] = out[1] = out[2] = zero;
    for (first = 0; any; ++first) {
        /* those of the kind of the first one, which stands in for the others */
        const gic_road *alike[GIC_LANES];
        gic_mask of_kind = (gic_mask)(zero > zero);
        gic_lane found[3];
        if (!left[first])
            continue;
        FOR_LANES(l)
        {
            const int own = left[l] && road[l]->kind == road[first]->kind;
            alike[l] = own ? road[l] : road[first];
            of_kind[l] = -own;
            left[l] -= own;
            any -= own;
        }
        LANE_ONE_KIND(alike, 0, lane, time, of_kind, LANE_KEPT(of_kind, *x), LANE_KEPT(of_kind, *y), found);
        for (i = 0; i < 3; ++i)
            out[i] = LANE_SELECT(of_kind, found[i], out[i]);
    }
}

/* 0 below 0, 1 from 1 on, smooth between. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_smooth_, GIC_LANES)(gic_lane t)
{
    const gic_lane zero = {GIC_R(0.0)}, one = LANE(GIC_R(1.0));
    const gic_lane between = LANE_SELECT((gic_mask)(t < one), t * t * (GIC_R(3.0) - GIC_R(2.0) * t), one);
    return LANE_SELECT((gic_mask)(t <= zero), zero, between);
}

/* 1 inside [low, high], 0 outside, smooth over `fade` around the ends. */
LANE_FUNCTION gic_lane GIC_LANES_NAME(lane_inside_, GIC_LANES)(gic_lane place, gic_lane low, gic_lane high,
                                                               gic_lane fade)
{
    return GIC_LANES_NAME(lane_smooth_, GIC_LANES)((place - low) / fade + GIC_R(0.5)) *
           GIC_LANES_NAME(lane_smooth_, GIC_LANES)((high - place) / fade + GIC_R(0.5));
}

/* Friction of patched roads; same: they are one road. */
static __attribute__((unused)) gic_lane GIC_LANES_NAME(lane_patches_, GIC_LANES)(const gic_road *const *road, int same,
                                                                                 gic_lane x, gic_lane y)
{
    static const gic_friction_patch none = {0, 0, 0, 0, 0, 1};
    const gic_lane zero = {GIC_R(0.0)};
    const gic_mask all_lanes = (gic_mask)(zero <= zero);
    gic_lane all = GIC_OF_ROADS(gic_road_patched, value);
    int32_t most = 0, k;
    int l;
    FOR_LANES(l)
    if (GIC_ROAD_AS(gic_road_patched, l)->count > most)
        most = GIC_ROAD_AS(gic_road_patched, l)->count;
    for (k = 0; k < most; ++k) {
        const gic_friction_patch *patch[GIC_LANES];
        gic_lane x_low, x_high, y_low, y_high, value, fade, in;
        gic_mask has = all_lanes;
        if (same) {
            patch[0] = &GIC_ROAD_AS(gic_road_patched, 0)->patch[k];
        } else {
            FOR_LANES(l)
            {
                const gic_road_patched *const patched = GIC_ROAD_AS(gic_road_patched, l);
                has[l] = -(k < patched->count);
                patch[l] = k < patched->count ? &patched->patch[k] : &none;
            }
        }
        GIC_OF_PATCHES(x_low);
        GIC_OF_PATCHES(x_high);
        GIC_OF_PATCHES(y_low);
        GIC_OF_PATCHES(y_high);
        GIC_OF_PATCHES(fade);
        in = GIC_LANES_NAME(lane_inside_, GIC_LANES)(x, x_low, x_high, fade);
        if (!LANE_ANY(has & ~(gic_mask)(in == GIC_R(0.0))))
            continue; /* 0 times what is finite */
        in = in * GIC_LANES_NAME(lane_inside_, GIC_LANES)(y, y_low, y_high, fade);
        GIC_OF_PATCHES(value);
        all = LANE_SELECT(has, all + in * (value - all), all);
    }
    return all;
}

static __attribute__((noinline, unused)) gic_lane LANE_FRICTIONS(const gic_road *const *road, const int32_t *lane,
                                                                 const gic_lane *time, const gic_lane *x,
                                                                 const gic_lane *y)
{
    const gic_lane zero = {GIC_R(0.0)};
    const gic_road *alike[GIC_LANES], *first = NULL;
    gic_mask on = (gic_mask)(zero > zero);
    gic_lane out = LANE(GIC_R(1.0));
    int l, same = 1;
    FOR_LANES(l)
    same &= road[l] == road[0];
    if (same && road[0] && road[0]->friction && road[0]->kind == GIC_ROAD_PATCHED)
        return GIC_LANES_NAME(lane_patches_, GIC_LANES)(road, 1, *x, *y);
    FOR_LANES(l)
    {
        alike[l] = NULL;
        if (!road[l] || !road[l]->friction)
            continue;
        if (road[l]->kind == GIC_ROAD_PATCHED) {
            on[l] = -1;
            first = alike[l] = road[l];
        } else {
            out[l] = road[l]->friction(road[l], lane[l], (*time)[l], (*x)[l], (*y)[l]);
        }
    }
    if (!first)
        return out;
    FOR_LANES(l)
    alike[l] = alike[l] ? alike[l] : first;
    return LANE_SELECT(on, GIC_LANES_NAME(lane_patches_, GIC_LANES)(alike, 0, *x, *y), out);
}

#undef GIC_ROAD_LANES_NEW
#endif
