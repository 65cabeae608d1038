/* SPDX-License-Identifier: MIT
 *
 * gic_road: roads ready for use, for hosts and targets. As free of demands as gic_runtime, which it goes with: no
 * allocation, no globals, arrays belong to the caller. Generated code knows only the head, struct gic_road: whoever has
 * a road of his own needs neither of these two files.
 *
 *     static const gic_road_plane hill = {{gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE},
 *         0, GIC_R(0.05), 0};
 *     car.head.road = &hill.head;
 *
 * Heights in metres over positions in the world, slopes without unit. Slopes are continuous, but for bumps and tables
 * at the side edges of their tracks, where the data have a step. A position that is not finite gives a height that is
 * not, or a defined one; it never makes a road read beyond its arrays. models/SCENE.md, section 3, has all formulas.
 * `bend` functions are exact but for rounding.
 */
#ifndef GIC_ROAD_H
#define GIC_ROAD_H

#include "gic_runtime.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- shapes --------------------------------------------------------------------------------------------- */

/* h = z0 + sx x + sy y: flat and slope. */
typedef struct gic_road_plane {
    gic_road head;
    gic_real z0, sx, sy;
} gic_road_plane;

#define gic_plane_height GIC_NAME(gic_plane_height)
void gic_plane_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_plane_bend GIC_NAME(gic_plane_bend)
void gic_plane_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);

/* h = amplitude sin(2 pi (x - x0) / wavelength + phase_per_y y). */
typedef struct gic_road_sine {
    gic_road head;
    gic_real amplitude, wavelength, x0, phase_per_y;
} gic_road_sine;

#define gic_sine_height GIC_NAME(gic_sine_height)
void gic_sine_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_sine_bend GIC_NAME(gic_sine_bend)
void gic_sine_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);

/* Within this distance, m, a place counts as on the edge between tracks: a wheel at y = 0 but for rounding is on the
 * right. */
#ifdef GIC_FLOAT
#define GIC_ROAD_EDGE GIC_R(1e-5)
#else
#define GIC_ROAD_EDGE GIC_R(1e-9)
#endif

/* A bump of height `height` between x and x + length, h (1 - cos)/2, on tracks y in [y_low, y_high], with the edges. */
typedef struct gic_bump {
    gic_real x, length, height, y_low, y_high;
} gic_bump;

/* Bumps in order of increasing x; overlapping ones add up. The time of a call grows with the logarithm of `count` and
 * with the number of bumps within the longest one's length. longest: set by gic_road_bumps_setup. */
typedef struct gic_road_bumps {
    gic_road head;
    const gic_bump *bump;
    int32_t count;
    gic_real longest;
} gic_road_bumps;

#define gic_bumps_height GIC_NAME(gic_bumps_height)
void gic_bumps_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_bumps_bend GIC_NAME(gic_bumps_bend)
void gic_bumps_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
/* The first bump that may not have ended before x: the others begin more than the longest one's length before it. For
 * gic_road.c and gic_road_lanes.h. */
static inline int32_t gic_first_bump(const gic_road_bumps *bumps, gic_real x)
{
    int32_t first = 0, behind = bumps->count;
    while (first < behind) {
        const int32_t middle = first + (behind - first) / 2;
        if (bumps->bump[middle].x < x - bumps->longest)
            first = middle + 1;
        else
            behind = middle;
    }
    return first;
}

/* GIC_ERROR_ARGUMENT if x decreases, a length is not positive or a number is not finite. */
#define gic_road_bumps_setup GIC_NAME(gic_road_bumps_setup)
int gic_road_bumps_setup(gic_road_bumps *road);

/* ---- measured and random ones --------------------------------------------------------------------------- */

/* Heights left (y > GIC_ROAD_EDGE) and right of the middle at increasing x, monotone cubic (Fritsch-Carlson) between,
 * constant outside; level at both ends, so that the slope has no jump. slope_left, slope_right: `count` numbers, set by
 * gic_road_table_setup. */
typedef struct gic_road_table {
    gic_road head;
    const gic_real *x, *left, *right;
    gic_real *slope_left, *slope_right;
    int32_t count;
} gic_road_table;

#define gic_table_height GIC_NAME(gic_table_height)
void gic_table_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_table_bend GIC_NAME(gic_table_bend)
void gic_table_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
/* Set the slopes; GIC_ERROR_ARGUMENT if count < 2, x does not increase or a number is not finite. */
#define gic_road_table_setup GIC_NAME(gic_road_table_setup)
int gic_road_table_setup(gic_road_table *road);

/* Heights at the nodes x0 + i dx, y0 + j dy, i < nx, j < ny: height[j * nx + i]. Catmull-Rom cubics in both directions
 * between the nodes, level across the edges and constant beyond them. All calls take the same time. */
typedef struct gic_road_grid {
    gic_road head;
    gic_real x0, y0, dx, dy;
    int32_t nx, ny;
    const gic_real *height;
} gic_road_grid;

#define gic_grid_height GIC_NAME(gic_grid_height)
void gic_grid_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_grid_bend GIC_NAME(gic_grid_bend)
void gic_grid_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
/* GIC_ERROR_ARGUMENT if there are fewer than 2 x 2 nodes, a spacing is not positive or a number is not finite. */
#define gic_road_grid_check GIC_NAME(gic_road_grid_check)
int gic_road_grid_check(const gic_road_grid *road);

/* A random road of a class of ISO 8608: along each of two tracks at y = track / 2 and -track / 2 the displacement's
 * spectral density is G(n) = Gd (0.1 / n)^2, n in cycles/m, Gd = 16, 64, 256 ... 1e-6 m^3 for classes A, B, C to H. It
 * holds from wavelengths of 100 m to seven spacings of the profile's points (within 10 percent at both). The tracks are
 * alike in wavelengths far above five times `track` and independent far below. Level and at height 0 up to `start`,
 * rising to full roughness over `fade`; constant beyond start + length. */
typedef struct gic_iso8608 {
    char road_class; /* 'A' to 'H' */
    uint64_t seed;
    gic_real start, length, track, fade; /* m; fade may be 0 */
} gic_iso8608;

/* Fill `height` with 2 x count heights at `count` points a track, length / (count - 1) apart, and set up `road`,
 * without friction. Uses sums, products, quotients and roots alone, so that every machine with IEEE arithmetic and
 * without contraction finds the same bits. GIC_ERROR_ARGUMENT when the class is unknown, count < 2, length or track not
 * positive, fade negative, or the spacing not below the track. */
#define gic_road_iso8608_setup GIC_NAME(gic_road_iso8608_setup)
int gic_road_iso8608_setup(gic_road_grid *road, const gic_iso8608 *profile, gic_real *height, int32_t count);

/* ---- roads made of roads -------------------------------------------------------------------------------- */

/* The sum of the heights of `count` roads; their friction is ignored. */
typedef struct gic_road_sum {
    gic_road head;
    const gic_road *const *part;
    int32_t count;
} gic_road_sum;

#define gic_sum_height GIC_NAME(gic_sum_height)
void gic_sum_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_sum_bend GIC_NAME(gic_sum_bend)
void gic_sum_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);

/* A rectangle of other friction, `value` inside. Its edges are `fade` wide, half of it on either side, and smooth.
 * 0 < fade <= the rectangle's sides. */
typedef struct gic_friction_patch {
    gic_real x_low, x_high, y_low, y_high, value, fade;
} gic_friction_patch;

/* Another road (`under`, NULL: flat at 0) with friction `value` and patches; where patches overlap the last one counts.
 * The time of a call of friction grows with `count`. */
typedef struct gic_road_patched {
    gic_road head;
    const gic_road *under;
    gic_real value;
    const gic_friction_patch *patch;
    int32_t count;
} gic_road_patched;

#define gic_patched_height GIC_NAME(gic_patched_height)
void gic_patched_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_patched_bend GIC_NAME(gic_patched_bend)
void gic_patched_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3]);
#define gic_patched_friction GIC_NAME(gic_patched_friction)
gic_real gic_patched_friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y);
#define gic_patched_friction_slope GIC_NAME(gic_patched_friction_slope)
void gic_patched_friction_slope(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y,
                                gic_real out[2]);

#ifdef __cplusplus
}
#endif
#endif
