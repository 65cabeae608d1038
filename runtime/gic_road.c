/* SPDX-License-Identifier: MIT
 *
 * gic_road: see gic_road.h. The same source is compiled for either number type, so constants go through GIC_R and
 * functions of <math.h> through MATH. */
#include "gic_road.h"

#include <math.h>

#ifdef GIC_FLOAT
#define MATH(name) name##f
#else
#define MATH(name) name
#endif

#define PI GIC_R(3.1415926535897932384626433832795)
#define TWO_PI GIC_R(6.283185307179586476925286766559)

/* ---- shapes --------------------------------------------------------------------------------------------- */

void gic_plane_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_plane *plane = (const gic_road_plane *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = plane->z0 + plane->sx * x + plane->sy * y;
    out[1] = plane->sx;
    out[2] = plane->sy;
}

void gic_plane_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road;
    (void)lane;
    (void)time;
    (void)x;
    (void)y;
    out[0] = out[1] = out[2] = GIC_R(0.0);
}

void gic_sine_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_sine *sine = (const gic_road_sine *)(const void *)road;
    (void)lane;
    (void)time;
    const gic_real wave = TWO_PI / sine->wavelength;
    const gic_real phase = wave * (x - sine->x0) + sine->phase_per_y * y;
    const gic_real slope = sine->amplitude * MATH(cos)(phase);
    out[0] = sine->amplitude * MATH(sin)(phase);
    out[1] = slope * wave;
    out[2] = slope * sine->phase_per_y;
}

void gic_sine_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_sine *sine = (const gic_road_sine *)(const void *)road;
    (void)lane;
    (void)time;
    const gic_real wave = TWO_PI / sine->wavelength, across = sine->phase_per_y;
    const gic_real bend = -sine->amplitude * MATH(sin)(wave * (x - sine->x0) + across * y);
    out[0] = bend * wave * wave;
    out[1] = bend * wave * across;
    out[2] = bend * across * across;
}

static int is_on_bump(const gic_bump *bump, gic_real x, gic_real y)
{
    return !(x - bump->x >= bump->length || y < bump->y_low - GIC_ROAD_EDGE || y > bump->y_high + GIC_ROAD_EDGE);
}

void gic_bumps_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_bumps *bumps = (const gic_road_bumps *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    for (int32_t i = gic_first_bump(bumps, x); i < bumps->count && !(bumps->bump[i].x >= x); ++i) {
        const gic_bump *bump = &bumps->bump[i];
        if (!is_on_bump(bump, x, y))
            continue;
        const gic_real along = x - bump->x, wave = TWO_PI / bump->length;
        out[0] += GIC_R(0.5) * bump->height * (GIC_R(1.0) - MATH(cos)(wave * along));
        out[1] += GIC_R(0.5) * bump->height * wave * MATH(sin)(wave * along);
    }
}

void gic_bumps_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_bumps *bumps = (const gic_road_bumps *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    /* of one that begins at x, too */
    for (int32_t i = gic_first_bump(bumps, x); i < bumps->count && !(bumps->bump[i].x > x); ++i) {
        const gic_bump *bump = &bumps->bump[i];
        const gic_real wave = TWO_PI / bump->length;
        if (is_on_bump(bump, x, y))
            out[0] += GIC_R(0.5) * bump->height * wave * wave * MATH(cos)(wave * (x - bump->x));
    }
}

int gic_road_bumps_setup(gic_road_bumps *road)
{
    road->longest = GIC_R(0.0);
    for (int32_t i = 0; i < road->count; ++i) {
        const gic_bump *bump = &road->bump[i];
        const gic_real number[] = {bump->x, bump->length, bump->height, bump->y_low, bump->y_high};
        if (!gic_finite(number, 5) || bump->length <= GIC_R(0.0) || (i && bump->x < road->bump[i - 1].x))
            return GIC_ERROR_ARGUMENT;
        if (bump->length > road->longest)
            road->longest = bump->length;
    }
    return GIC_OK;
}

/* ---- tables --------------------------------------------------------------------------------------------- */

/* The piece of a table that x is in, a cubic h0 + s (d0 + s (c + s b)) with s from 0 to 1; width 0: level outside. */
typedef struct piece {
    gic_real width, s, h0, d0, c, b;
} piece;

static piece piece_at(const gic_road_table *table, gic_real x, gic_real y)
{
    const gic_real *at = table->x;
    const gic_real *height = y > GIC_ROAD_EDGE ? table->left : table->right;
    const gic_real *slope = y > GIC_ROAD_EDGE ? table->slope_left : table->slope_right;
    int32_t low = 0, high = table->count - 1;
    piece p = {GIC_R(0.0), GIC_R(0.0), GIC_R(0.0), GIC_R(0.0), GIC_R(0.0), GIC_R(0.0)};
    if (x <= at[low] || x >= at[high]) {
        p.h0 = height[x <= at[low] ? low : high];
        return p;
    }
    /* the piece of x if points are evenly spaced; x may be no number */
    const gic_real place = (x - at[low]) / (at[high] - at[low]) * (gic_real)high;
    const int32_t guess = place >= GIC_R(0.0) && place < (gic_real)high ? (int32_t)place : low;
    if (x < at[guess]) {
        high = guess;
    } else if (x < at[guess + 1]) {
        low = guess;
        high = guess + 1;
    } else if (guess + 1 < high) {
        low = guess + 1;
    }
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (x < at[middle])
            high = middle;
        else
            low = middle;
    }
    const gic_real rise = height[high] - height[low];
    p.width = at[high] - at[low];
    p.s = (x - at[low]) / p.width;
    p.h0 = height[low];
    p.d0 = p.width * slope[low];
    const gic_real d1 = p.width * slope[high];
    p.c = GIC_R(3.0) * rise - GIC_R(2.0) * p.d0 - d1;
    p.b = p.d0 + d1 - GIC_R(2.0) * rise;
    return p;
}

void gic_table_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const piece p = piece_at((const gic_road_table *)(const void *)road, x, y);
    (void)lane;
    (void)time;
    out[0] = p.h0;
    out[1] = out[2] = GIC_R(0.0);
    if (p.width > GIC_R(0.0)) {
        out[0] = p.h0 + p.s * (p.d0 + p.s * (p.c + p.s * p.b));
        out[1] = (p.d0 + p.s * (GIC_R(2.0) * p.c + p.s * GIC_R(3.0) * p.b)) / p.width;
    }
}

void gic_table_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const piece p = piece_at((const gic_road_table *)(const void *)road, x, y);
    (void)lane;
    (void)time;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    if (p.width > GIC_R(0.0))
        out[0] = (GIC_R(2.0) * p.c + p.s * GIC_R(6.0) * p.b) / (p.width * p.width);
}

/* Slopes that keep every piece monotone: zero at extrema and plateaus, else the weighted harmonic mean of the chords
 * (Fritsch and Butland's form of Fritsch and Carlson's condition). */
static void table_slopes(const gic_real *x, const gic_real *h, gic_real *slope, int32_t count)
{
    slope[0] = slope[count - 1] = GIC_R(0.0);
    for (int32_t i = 1; i < count - 1; ++i) {
        const gic_real before = x[i] - x[i - 1], after = x[i + 1] - x[i];
        const gic_real chord_before = (h[i] - h[i - 1]) / before, chord_after = (h[i + 1] - h[i]) / after;
        const gic_real w_before = GIC_R(2.0) * after + before, w_after = after + GIC_R(2.0) * before;
        slope[i] = chord_before * chord_after > GIC_R(0.0)
                       ? (w_before + w_after) / (w_before / chord_before + w_after / chord_after)
                       : GIC_R(0.0);
    }
}

int gic_road_table_setup(gic_road_table *road)
{
    if (road->count < 2 || !gic_finite(road->x, road->count) || !gic_finite(road->left, road->count) ||
        !gic_finite(road->right, road->count))
        return GIC_ERROR_ARGUMENT;
    for (int32_t i = 1; i < road->count; ++i)
        if (road->x[i] <= road->x[i - 1])
            return GIC_ERROR_ARGUMENT;
    table_slopes(road->x, road->left, road->slope_left, road->count);
    table_slopes(road->x, road->right, road->slope_right, road->count);
    /* very steep pieces can overflow */
    if (!gic_finite(road->slope_left, road->count) || !gic_finite(road->slope_right, road->count))
        return GIC_ERROR_ARGUMENT;
    return GIC_OK;
}

/* ---- height fields -------------------------------------------------------------------------------------- */

/* The four nodes that a place on an axis depends on: indices, weights, their first and second derivatives by the place.
 */
typedef struct support {
    int32_t node[4];
    gic_real weight[4], rate[4], bend[4];
} support;

/* Cubic Hermite between two nodes, whose slopes are half the difference of their neighbours; level at the ends. */
static support support_at(gic_real place, gic_real first, gic_real spacing, int32_t count)
{
    support s;
    const int32_t last = count - 1;
    gic_real along = (place - first) / spacing;
    along = along > GIC_R(0.0) ? (along < (gic_real)last ? along : (gic_real)last) : GIC_R(0.0);
    const int32_t cell = (int32_t)along < last ? (int32_t)along : last - 1;
    const gic_real t = along - (gic_real)cell, u = GIC_R(1.0) - t, by = GIC_R(1.0) / spacing;
    const int before = cell > 0, after = cell + 1 < last;
    /* the contribution of the slopes at the cell's two ends, 0 if an end is level */
    const gic_real slope0 = before ? GIC_R(0.5) * t * u * u : GIC_R(0.0);
    const gic_real slope1 = after ? GIC_R(-0.5) * t * t * u : GIC_R(0.0);
    const gic_real slope0_rate = before ? GIC_R(0.5) * u * (u - GIC_R(2.0) * t) * by : GIC_R(0.0);
    const gic_real slope1_rate = after ? GIC_R(0.5) * t * (t - GIC_R(2.0) * u) * by : GIC_R(0.0);
    const gic_real rise = t * t * (GIC_R(3.0) - GIC_R(2.0) * t), rise_rate = GIC_R(6.0) * t * u * by;
    /* none beyond the edges */
    const gic_real twice = place >= first && along < (gic_real)last ? by * by : GIC_R(0.0);
    const gic_real slope0_bend = before ? (GIC_R(3.0) * t - GIC_R(2.0)) * twice : GIC_R(0.0);
    const gic_real slope1_bend = after ? (GIC_R(3.0) * t - GIC_R(1.0)) * twice : GIC_R(0.0);
    const gic_real rise_bend = GIC_R(6.0) * (u - t) * twice;
    s.node[0] = before ? cell - 1 : cell;
    s.node[1] = cell;
    s.node[2] = cell + 1;
    s.node[3] = after ? cell + 2 : cell + 1;
    s.weight[0] = -slope0;
    s.weight[1] = GIC_R(1.0) - rise - slope1;
    s.weight[2] = rise + slope0;
    s.weight[3] = slope1;
    s.rate[0] = -slope0_rate;
    s.rate[1] = -rise_rate - slope1_rate;
    s.rate[2] = rise_rate + slope0_rate;
    s.rate[3] = slope1_rate;
    s.bend[0] = -slope0_bend;
    s.bend[1] = -rise_bend - slope1_bend;
    s.bend[2] = rise_bend + slope0_bend;
    s.bend[3] = slope1_bend;
    return s;
}

void gic_grid_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_grid *grid = (const gic_road_grid *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = x + y;
    out[1] = out[2] = GIC_R(0.0);
    if (!gic_finite(&x, 1) || !gic_finite(&y, 1))
        return; /* the index would overflow */
    const support along = support_at(x, grid->x0, grid->dx, grid->nx);
    const support across = support_at(y, grid->y0, grid->dy, grid->ny);
    out[0] = GIC_R(0.0);
    for (int j = 0; j < 4; ++j) {
        const gic_real *row = grid->height + (size_t)across.node[j] * (size_t)grid->nx;
        gic_real height = GIC_R(0.0), slope = GIC_R(0.0);
        for (int i = 0; i < 4; ++i) {
            height += along.weight[i] * row[along.node[i]];
            slope += along.rate[i] * row[along.node[i]];
        }
        out[0] += across.weight[j] * height;
        out[1] += across.weight[j] * slope;
        out[2] += across.rate[j] * height;
    }
}

void gic_grid_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_grid *grid = (const gic_road_grid *)(const void *)road;
    (void)lane;
    (void)time;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    if (!gic_finite(&x, 1) || !gic_finite(&y, 1))
        return;
    const support along = support_at(x, grid->x0, grid->dx, grid->nx);
    const support across = support_at(y, grid->y0, grid->dy, grid->ny);
    for (int j = 0; j < 4; ++j) {
        const gic_real *row = grid->height + (size_t)across.node[j] * (size_t)grid->nx;
        gic_real height = GIC_R(0.0), slope = GIC_R(0.0), bend = GIC_R(0.0);
        for (int i = 0; i < 4; ++i) {
            height += along.weight[i] * row[along.node[i]];
            slope += along.rate[i] * row[along.node[i]];
            bend += along.bend[i] * row[along.node[i]];
        }
        out[0] += across.weight[j] * bend;
        out[1] += across.rate[j] * slope;
        out[2] += across.bend[j] * height;
    }
}

int gic_road_grid_check(const gic_road_grid *road)
{
    const gic_real place[] = {road->x0, road->y0, road->dx, road->dy};
    if (road->nx < 2 || road->ny < 2 || !gic_finite(place, 4) || road->dx <= GIC_R(0.0) || road->dy <= GIC_R(0.0))
        return GIC_ERROR_ARGUMENT;
    for (int32_t j = 0; j < road->ny; ++j)
        if (!gic_finite(road->height + (size_t)j * (size_t)road->nx, road->nx))
            return GIC_ERROR_ARGUMENT;
    return GIC_OK;
}

/* ---- random roads --------------------------------------------------------------------------------------- */

/* A smooth rise from 0 at t = 0 to 1 at t = 1, constant outside. */
static gic_real smooth(gic_real t)
{
    if (t <= GIC_R(0.0))
        return GIC_R(0.0);
    return t < GIC_R(1.0) ? t * t * (GIC_R(3.0) - GIC_R(2.0) * t) : GIC_R(1.0);
}

/* The next of a sequence of independent numbers with mean 0 and variance 1, nearly normal: the sum of the four quarters
 * of a number of splitmix64. */
static gic_real noise(uint64_t *state)
{
    uint64_t bits = *state += UINT64_C(0x9e3779b97f4a7c15);
    int32_t sum = -2 * 65535;
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
    bits ^= bits >> 31;
    for (int k = 0; k < 4; ++k, bits >>= 16)
        sum += (int32_t)(bits & 65535);
    return (gic_real)sum * GIC_R(0.00002642899791822627706); /* sqrt(3) / 65536 */
}

int gic_road_iso8608_setup(gic_road_grid *road, const gic_iso8608 *profile, gic_real *height, int32_t count)
{
    const gic_real number[] = {profile->start, profile->length, profile->track, profile->fade};
    if (profile->road_class < 'A' || profile->road_class > 'H' || count < 2 || !gic_finite(number, 4) ||
        profile->length <= GIC_R(0.0) || profile->track <= GIC_R(0.0) || profile->fade < GIC_R(0.0))
        return GIC_ERROR_ARGUMENT;
    const gic_real spacing = profile->length / (gic_real)(count - 1);
    if (spacing <= GIC_R(0.0) || spacing >= profile->track)
        return GIC_ERROR_ARGUMENT;

    /* White noise integrated once has a density that falls with the square of n. Integrators leak, at wavelengths
     * above 400 m, or heights would grow with the length of the road. Each track sums two parts: noise of its own,
     * whose integrator leaks above five track widths already, and the part of the common noise that such an
     * integrator loses. */
    const gic_real n0 = GIC_R(0.1), density = GIC_R(16e-6) * (gic_real)(1 << 2 * (profile->road_class - 'A'));
    const gic_real slow = PI * spacing / GIC_R(400.0), fast = PI * spacing / (GIC_R(5.0) * profile->track);
    const gic_real slow_kept = (GIC_R(1.0) - slow) / (GIC_R(1.0) + slow);
    const gic_real fast_kept = (GIC_R(1.0) - fast) / (GIC_R(1.0) + fast);
    const gic_real step = PI * n0 * MATH(sqrt)(GIC_R(2.0) * density * spacing) / (GIC_R(1.0) + fast);
    const gic_real passed_on = GIC_R(2.0) * fast / (GIC_R(1.0) + slow);
    uint64_t state = profile->seed;
    gic_real lost = GIC_R(0.0), common = GIC_R(0.0), left = GIC_R(0.0), right = GIC_R(0.0);
    for (int32_t i = 0; i < count; ++i) {
        const gic_real x = (gic_real)i * spacing;
        const gic_real share = x < profile->fade ? smooth(x / profile->fade) : GIC_R(1.0);
        height[i] = share * (common + right); /* the row of y = -track / 2 */
        height[count + i] = share * (common + left);
        lost = fast_kept * lost + step * noise(&state);
        left = fast_kept * left + step * noise(&state);
        right = fast_kept * right + step * noise(&state);
        common = slow_kept * common + passed_on * lost;
    }
    road->head.height = gic_grid_height;
    road->head.friction = NULL;
    road->head.bend = gic_grid_bend;
    road->head.friction_slope = NULL;
    road->head.kind = GIC_ROAD_GRID;
    road->x0 = profile->start;
    road->dx = spacing;
    road->nx = count;
    road->y0 = GIC_R(-0.5) * profile->track;
    road->dy = profile->track;
    road->ny = 2;
    road->height = height;
    return GIC_OK;
}

/* ---- roads made of roads -------------------------------------------------------------------------------- */

void gic_sum_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_sum *sum = (const gic_road_sum *)(const void *)road;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    for (int32_t i = 0; i < sum->count; ++i) {
        gic_real part[3];
        sum->part[i]->height(sum->part[i], lane, time, x, y, part);
        for (int k = 0; k < 3; ++k)
            out[k] += part[k];
    }
}

void gic_sum_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road_sum *sum = (const gic_road_sum *)(const void *)road;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    for (int32_t i = 0; i < sum->count; ++i) {
        gic_real part[3];
        gic_road_bend(sum->part[i], lane, time, x, y, part);
        for (int k = 0; k < 3; ++k)
            out[k] += part[k];
    }
}

void gic_patched_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    const gic_road *under = ((const gic_road_patched *)(const void *)road)->under;
    out[0] = out[1] = out[2] = GIC_R(0.0);
    if (under)
        under->height(under, lane, time, x, y, out);
}

void gic_patched_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    gic_road_bend(((const gic_road_patched *)(const void *)road)->under, lane, time, x, y, out);
}

/* 1 inside [low, high], 0 outside, smooth over `fade` around the ends. */
static gic_real inside(gic_real place, gic_real low, gic_real high, gic_real fade)
{
    return smooth((place - low) / fade + GIC_R(0.5)) * smooth((high - place) / fade + GIC_R(0.5));
}

gic_real gic_patched_friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    const gic_road_patched *patched = (const gic_road_patched *)(const void *)road;
    gic_real value = patched->value;
    (void)lane;
    (void)time;
    for (int32_t i = 0; i < patched->count; ++i) {
        const gic_friction_patch *patch = &patched->patch[i];
        value += inside(x, patch->x_low, patch->x_high, patch->fade) *
                 inside(y, patch->y_low, patch->y_high, patch->fade) * (patch->value - value);
    }
    return value;
}

/* Derivatives of smooth() and inside(). */
static gic_real smooth_slope(gic_real t)
{
    return t > GIC_R(0.0) && t < GIC_R(1.0) ? GIC_R(6.0) * t * (GIC_R(1.0) - t) : GIC_R(0.0);
}

static gic_real inside_slope(gic_real place, gic_real low, gic_real high, gic_real fade)
{
    const gic_real in = (place - low) / fade + GIC_R(0.5), off = (high - place) / fade + GIC_R(0.5);
    return (smooth_slope(in) * smooth(off) - smooth(in) * smooth_slope(off)) / fade;
}

void gic_patched_friction_slope(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y,
                                gic_real out[2])
{
    const gic_road_patched *patched = (const gic_road_patched *)(const void *)road;
    gic_real value = patched->value;
    (void)lane;
    (void)time;
    out[0] = out[1] = GIC_R(0.0);
    for (int32_t i = 0; i < patched->count; ++i) {
        const gic_friction_patch *patch = &patched->patch[i];
        const gic_real along = inside(x, patch->x_low, patch->x_high, patch->fade);
        const gic_real across = inside(y, patch->y_low, patch->y_high, patch->fade);
        const gic_real left = patch->value - value;
        out[0] += inside_slope(x, patch->x_low, patch->x_high, patch->fade) * across * left - along * across * out[0];
        out[1] += along * inside_slope(y, patch->y_low, patch->y_high, patch->fade) * left - along * across * out[1];
        value += along * across * left;
    }
}
