/* SPDX-License-Identifier: MIT
 * Roads against formulas written here in long double, their slopes against central differences of these; random roads
 * against the spectrum they are to have. Made to be built three ways: plain, with -DGIC_FLOAT, and with -ffast-math. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <complex.h>
#include <float.h>
#include <math.h>

#include "gic_road.h"
#include "gic_runtime.h"

#ifdef GIC_FLOAT
#define EPSILON ((double)FLT_EPSILON)
#else
#define EPSILON DBL_EPSILON
#endif

/* ---- shapes --------------------------------------------------------------------------------------------- */

typedef long double Formula(const void *road, long double x, long double y);

static const long double pi = 3.14159265358979323846264338327950288L;

static long double plane_formula(const void *road, long double x, long double y)
{
    const gic_road_plane *plane = road;
    return (long double)plane->z0 + (long double)plane->sx * x + (long double)plane->sy * y;
}

static long double sine_formula(const void *road, long double x, long double y)
{
    const gic_road_sine *sine = road;
    const long double wave = 2 * pi / (long double)sine->wavelength;
    return (long double)sine->amplitude * sinl(wave * (x - (long double)sine->x0) + (long double)sine->phase_per_y * y);
}

static long double bumps_formula(const void *road, long double x, long double y)
{
    const gic_road_bumps *bumps = road;
    long double h = 0;
    for (int32_t i = 0; i < bumps->count; ++i) {
        const gic_bump *b = &bumps->bump[i];
        const long double s = (x - (long double)b->x) / (long double)b->length;
        if (s > 0 && s < 1 && y >= (long double)b->y_low && y <= (long double)b->y_high)
            h += (long double)b->height * powl(sinl(pi * s), 2);
    }
    return h;
}

static void check_road(const gic_road *road, Formula *formula)
{
    const long double d = 1e-7L, tolerance = 100 * (long double)EPSILON + 1e-10L;
    for (int i = -40; i < 140; ++i)
        for (int j = -3; j <= 3; ++j) {
            const gic_real x = (gic_real)(0.0937 * i + 0.011), y = (gic_real)(0.31 * j + 0.017);
            const long double X = (long double)x, Y = (long double)y;
            gic_real out[3];
            road->height(road, 0, 0, x, y, out);
            assert_true(fabsl((long double)out[0] - formula(road, X, Y)) < tolerance);
            const long double along = (formula(road, X + d, Y) - formula(road, X - d, Y)) / (2 * d);
            const long double across = (formula(road, X, Y + d) - formula(road, X, Y - d)) / (2 * d);
            assert_true(fabsl((long double)out[1] - along) < tolerance);
            assert_true(fabsl((long double)out[2] - across) < tolerance);
        }
}

static void test_roads(void **unused)
{
    (void)unused;
    const gic_road_plane plane = {
        {gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE}, GIC_R(0.25), GIC_R(0.05), GIC_R(-0.03)};
    const gic_road_sine sine = {
        {gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, GIC_R(0.04), GIC_R(3.0), GIC_R(0.7), GIC_R(0.9)};
    const gic_bump bump[] = {{GIC_R(1.0), GIC_R(2.0), GIC_R(0.1), GIC_R(0.0), GIC_R(50.0)},
                             {GIC_R(2.5), GIC_R(1.5), GIC_R(-0.05), GIC_R(-50.0), GIC_R(50.0)}};
    gic_road_bumps bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, bump, 2, 0};
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_OK);
    check_road(&plane.head, plane_formula);
    check_road(&sine.head, sine_formula);
    check_road(&bumps.head, bumps_formula);
}

/* Found by search: many bumps of different lengths, overlapping, against the sum of all; and what setup refuses. */
static void test_many_bumps(void **unused)
{
    (void)unused;
    enum { MANY = 40 };
    gic_bump bump[MANY];
    for (int i = 0; i < MANY; ++i) {
        const gic_bump one = {(gic_real)(-4.003 + 0.4 * i), (gic_real)(0.3 + 0.11 * (i * 7 % 23)),
                              (gic_real)(0.01 * (i % 5)), (gic_real)(i % 3 - 1.4), GIC_R(9.0)};
        bump[i] = one;
    }
    bump[8].x = bump[7].x; /* two may begin together */
    gic_road_bumps bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, bump, MANY, 0};
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_OK);
    check_road(&bumps.head, bumps_formula);

    bump[3].x = GIC_R(99.0);
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_ERROR_ARGUMENT);
    bump[3].x = bump[2].x;
    bump[5].length = GIC_R(0.0);
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_ERROR_ARGUMENT);
    bumps.count = 0;
    gic_real out[3];
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_OK);
    bumps.head.height(&bumps.head, 0, 0, GIC_R(1.0), GIC_R(0.0), out);
    assert_true(out[0] == GIC_R(0.0));
}

static void test_table(void **unused)
{
    (void)unused;
    enum { COUNT = 7 };
    const gic_real x[COUNT] = {GIC_R(0.0), GIC_R(1.0), GIC_R(1.5), GIC_R(3.0), GIC_R(4.0), GIC_R(6.0), GIC_R(7.0)};
    const gic_real left[COUNT] = {GIC_R(0.0),  GIC_R(0.125), GIC_R(0.5), GIC_R(0.5),
                                  GIC_R(0.25), GIC_R(-0.25), GIC_R(1.0)};
    const gic_real right[COUNT] = {GIC_R(-1.0), GIC_R(0.0), GIC_R(0.5), GIC_R(2.0), GIC_R(3.0), GIC_R(5.0), GIC_R(6.0)};
    gic_real slope_left[COUNT], slope_right[COUNT], out[3], beside[3];
    gic_road_table road = {
        {gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE}, x, left, right, slope_left, slope_right, COUNT};
    assert_int_equal(gic_road_table_setup(&road), GIC_OK);

    for (int side = 0; side < 2; ++side) {
        const gic_real y = side ? GIC_R(-0.5) : GIC_R(0.5), *h = side ? right : left;
        for (int i = 0; i < COUNT; ++i) { /* through the points */
            gic_table_height(&road.head, 0, 0, x[i], y, out);
            assert_true(fabs((double)out[0] - (double)h[i]) < 4 * EPSILON);
            assert_true(out[2] == GIC_R(0.0));
        }
        for (int i = 0; i < COUNT - 1; ++i) {
            gic_real last = h[i];
            for (int k = 1; k < 100; ++k) { /* monotone between, slope by central differences, no jump of the slope */
                const double width = (double)(x[i + 1] - x[i]), d = 1e-3 * width;
                const gic_real at = (gic_real)((double)x[i] + width * k / 100);
                gic_table_height(&road.head, 0, 0, at, y, out);
                assert_true((out[0] - last) * (h[i + 1] - h[i]) >= GIC_R(0.0));
                last = out[0];
                gic_table_height(&road.head, 0, 0, (gic_real)((double)at + d), y, beside);
                const double up = (double)beside[0];
                gic_table_height(&road.head, 0, 0, (gic_real)((double)at - d), y, beside);
                assert_true(fabs((double)out[1] - (up - (double)beside[0]) / (2 * d)) < 1e-5 + 2e4 * EPSILON);
            }
            gic_table_height(&road.head, 0, 0, (gic_real)((double)x[i] + 1e-5), y, out);
            gic_table_height(&road.head, 0, 0, (gic_real)((double)x[i] - 1e-5), y, beside);
            assert_true(fabs((double)out[1] - (double)beside[1]) < 1e-3);
        }
        for (int i = 0; i < 2; ++i) { /* constant and level outside */
            gic_table_height(&road.head, 0, 0, i ? GIC_R(99.0) : GIC_R(-9.0), y, out);
            assert_true(out[0] == h[i ? COUNT - 1 : 0] && out[1] == GIC_R(0.0));
        }
    }
    /* a straight stretch stays straight */
    gic_table_height(&road.head, 0, 0, GIC_R(3.3), GIC_R(-1.0), out);
    assert_true(fabs((double)out[1] - 1) < 100 * EPSILON);
    assert_true(fabs((double)out[0] - 2.3) < 100 * EPSILON);

    const gic_real falling[COUNT] = {0, 1, 2, 2, 3, 4, 5};
    gic_road_table bad = road;
    bad.x = falling;
    assert_int_equal(gic_road_table_setup(&bad), GIC_ERROR_ARGUMENT);
    bad = road;
    bad.count = 1;
    assert_int_equal(gic_road_table_setup(&bad), GIC_ERROR_ARGUMENT);
    /* a rise whose slope is no number */
    static const gic_real close[] = {0, GIC_R(1e-30), GIC_R(2e-30)}, steep[] = {0, GIC_R(1e30), GIC_R(2e30)};
    bad.x = close;
    bad.left = bad.right = steep;
    bad.count = 3;
    assert_int_equal(gic_road_table_setup(&bad), sizeof(gic_real) == 4 ? GIC_ERROR_ARGUMENT : GIC_OK);
}

/* ---- height fields -------------------------------------------------------------------------------------- */

enum { NX = 6, NY = 5 };

static const gic_real field[NX * NY] = {GIC_R(0.0),  GIC_R(0.1),  GIC_R(-0.2), GIC_R(0.3), GIC_R(0.0),  GIC_R(0.2),
                                        GIC_R(0.5),  GIC_R(-0.1), GIC_R(0.0),  GIC_R(0.4), GIC_R(0.25), GIC_R(0.0),
                                        GIC_R(-0.3), GIC_R(0.15), GIC_R(0.35), GIC_R(0.1), GIC_R(0.0),  GIC_R(-0.2),
                                        GIC_R(0.2),  GIC_R(0.6),  GIC_R(-0.4), GIC_R(0.1), GIC_R(0.3),  GIC_R(0.05),
                                        GIC_R(0.0),  GIC_R(-0.1), GIC_R(0.7),  GIC_R(0.2), GIC_R(-0.5), GIC_R(0.45)};

static const gic_road_grid grid = {{gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID},
                                   GIC_R(1.0),
                                   GIC_R(-1.0),
                                   GIC_R(0.5),
                                   GIC_R(0.25),
                                   NX,
                                   NY,
                                   field};

/* Catmull and Rom's cubic by its basis matrix, in cells of width 1; level at both ends by mirrored neighbours. */
static long double spline(const long double *h, int count, long double at)
{
    at = at < 0 ? 0 : at > count - 1 ? count - 1 : at;
    const int i = at >= count - 1 ? count - 2 : (int)at;
    const long double p1 = h[i], p2 = h[i + 1], p0 = i ? h[i - 1] : p2, p3 = i + 2 < count ? h[i + 2] : p1, t = at - i;
    return (2 * p1 + t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * p1 - p0 - 3 * p2 + p3)))) / 2;
}

static long double grid_formula(const void *road, long double x, long double y)
{
    const gic_road_grid *g = road;
    long double across[64], along[64];
    for (int j = 0; j < g->ny; ++j) {
        for (int i = 0; i < g->nx; ++i)
            along[i] = (long double)g->height[j * g->nx + i];
        across[j] = spline(along, g->nx, (x - (long double)g->x0) / (long double)g->dx);
    }
    return spline(across, g->ny, (y - (long double)g->y0) / (long double)g->dy);
}

static void test_grid(void **unused)
{
    (void)unused;
    gic_real out[3], beside[3];
    assert_int_equal(gic_road_grid_check(&grid), GIC_OK);
    check_road(&grid.head, grid_formula); /* within, at the edges and beyond all of them */
    for (int j = 0; j < NY; ++j)
        for (int i = 0; i < NX; ++i) { /* through the nodes, and no jump of height or slope at them */
            const double x = 1 + 0.5 * i, y = -1 + 0.25 * j, d = 1e-5;
            grid.head.height(&grid.head, 0, 0, (gic_real)x, (gic_real)y, out);
            assert_true(fabs((double)(out[0] - field[j * NX + i])) < 4 * EPSILON);
            for (int k = 0; k < 8; ++k) {
                const double side = d * (k & 4 ? 1 : -1);
                grid.head.height(&grid.head, 0, 0, (gic_real)(x + (k & 1 ? side : 0)),
                                 (gic_real)(y + (k & 2 ? side : 0)), beside);
                for (int m = 0; m < 3; ++m) /* second derivatives stay below 100 here */
                    assert_true(fabs((double)(out[m] - beside[m])) < 200 * d + 200 * EPSILON);
            }
        }
    /* two nodes are a smooth step */
    const gic_real step[] = {GIC_R(0.0), GIC_R(1.0), GIC_R(0.0), GIC_R(1.0)};
    const gic_road_grid smallest = {
        {gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID}, 0, 0, 1, 1, 2, 2, step};
    smallest.head.height(&smallest.head, 0, 0, GIC_R(0.25), GIC_R(77.0), out);
    assert_true(fabs((double)out[0] - 0.15625) < EPSILON && fabs((double)out[1] - 1.125) < 4 * EPSILON);

    gic_road_grid bad = grid;
    bad.nx = 1;
    assert_int_equal(gic_road_grid_check(&bad), GIC_ERROR_ARGUMENT);
    bad = grid;
    bad.dy = GIC_R(0.0);
    assert_int_equal(gic_road_grid_check(&bad), GIC_ERROR_ARGUMENT);
    gic_real holed[NX * NY];
    memcpy(holed, field, sizeof holed);
    memset(&holed[NX * NY - 1], 0xff, sizeof *holed);
    bad = grid;
    bad.height = holed;
    assert_int_equal(gic_road_grid_check(&bad), GIC_ERROR_ARGUMENT);
}

/* Places that are no numbers: an answer that is none either, and none from beyond the arrays (run with the sanitizers).
 */
static void test_nowhere(void **unused)
{
    (void)unused;
    gic_real bad[3] = {GIC_R(0.0), (gic_real)HUGE_VAL, -(gic_real)HUGE_VAL}, out[3];
    memset(&bad[0], 0xff, sizeof *bad);
    for (int i = 0; i < 3; ++i) {
        grid.head.height(&grid.head, 0, 0, bad[i], GIC_R(0.0), out);
        assert_false(gic_finite(out, 3));
        grid.head.height(&grid.head, 0, 0, GIC_R(0.0), bad[i], out);
        assert_false(gic_finite(out, 3));
    }
    gic_real at[] = {GIC_R(0.0), GIC_R(1.0), GIC_R(2.0)}, left[3], right[3];
    gic_bump bump[] = {{GIC_R(0.0), GIC_R(1.0), GIC_R(0.1), GIC_R(-1.0), GIC_R(1.0)}};
    gic_road_table table = {{gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE}, at, at, at, left, right, 3};
    gic_road_bumps bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, bump, 1, 0};
    assert_int_equal(gic_road_table_setup(&table), GIC_OK);
    assert_int_equal(gic_road_bumps_setup(&bumps), GIC_OK);
    for (int i = 0; i < 3; ++i) {
        table.head.height(&table.head, 0, 0, bad[i], bad[i], out);
        bumps.head.height(&bumps.head, 0, 0, bad[i], bad[i], out);
    }
    const gic_real far = GIC_R(1e30); /* more cells away than an int counts */
    grid.head.height(&grid.head, 0, 0, far, -far, out);
    assert_true(out[0] == field[NX - 1] && out[1] == GIC_R(0.0) && out[2] == GIC_R(0.0));
}

/* ---- random roads --------------------------------------------------------------------------------------- */

/* Of the profile below: as a scene's by default, long enough for a spectrum. */
enum { POINTS = 60001 };
static const gic_iso8608 class_c = {'C', 1, GIC_R(2.0), GIC_R(3000.0), GIC_R(1.5), GIC_R(5.0)};

static gic_road_grid random_road(const gic_iso8608 *profile, int32_t points)
{
    gic_road_grid road;
    gic_real *height = malloc(2 * (size_t)points * sizeof *height);
    assert_non_null(height);
    assert_int_equal(gic_road_iso8608_setup(&road, profile, height, points), GIC_OK);
    return road;
}

/* splitmix64 as its authors publish it. */
static uint64_t splitmix(uint64_t *x)
{
    uint64_t z = (*x += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static long double gauss(uint64_t *x)
{
    const uint64_t bits = splitmix(x);
    const long double sum =
        (long double)((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
    return (sum - 131070) * sqrtl(3) / 65536;
}

/* The recurrence of SCENE.md in long double. The slower integrator keeps 1 - 8e-4 of what it holds at each point;
 * rounding that by half an epsilon changes its sum by 600 epsilon. */
static void test_recurrence(void **unused)
{
    (void)unused;
    uint64_t x = 1234567;
    assert_true(splitmix(&x) == 6457827717110365317u);
    assert_true(splitmix(&x) == 3203168211198807973u);
    const gic_road_grid road = random_road(&class_c, POINTS);
    const long double d = 3000.0L / (POINTS - 1), a = pi * d / 400, k = pi * d / (5 * 1.5L);
    const long double sigma = pi * 0.1L * sqrtl(2 * 256e-6L * d);
    long double u = 0, c = 0, left = 0, right = 0, largest = 0, worst = 0;
    uint64_t state = 1;
    for (int i = 0; i < POINTS; ++i) {
        const long double s = fminl(i * d / 5, 1), f = s * s * (3 - 2 * s);
        worst = fmaxl(worst, fabsl((long double)road.height[i] - f * (c + right)));
        worst = fmaxl(worst, fabsl((long double)road.height[POINTS + i] - f * (c + left)));
        largest = fmaxl(largest, fabsl(c + left));
        u = ((1 - k) * u + sigma * gauss(&state)) / (1 + k);
        left = ((1 - k) * left + sigma * gauss(&state)) / (1 + k);
        right = ((1 - k) * right + sigma * gauss(&state)) / (1 + k);
        c = ((1 - a) * c + 2 * k * u) / (1 + a);
    }
    assert_true(largest > 0.02L);
    assert_true(worst < 1000 * (long double)EPSILON * largest);
    free((void *)road.height);
}

/* In place: x[k] = sum of x[m] exp(-2 pi i k m / n); n is a power of two. */
static void transform(double complex *x, int n)
{
    for (int i = 1, j = 0; i < n; ++i) {
        int bit = n >> 1;
        for (; j & bit; bit >>= 1)
            j ^= bit;
        j ^= bit;
        if (i < j) {
            const double complex swap = x[i];
            x[i] = x[j];
            x[j] = swap;
        }
    }
    for (int size = 2; size <= n; size *= 2)
        for (int k = 0; k < size / 2; ++k) {
            const double complex turn = cexp(-2 * (double)pi * k / size * I);
            for (int i = k; i < n; i += size) {
                const double complex odd = turn * x[i + size / 2];
                x[i + size / 2] = x[i] - odd;
                x[i] += odd;
            }
        }
}

/* Octaves of spatial frequency, those of ISO 8608: from 0.011 to 2.83 cycles/m, wavelengths of 91 to 0.35 m. */
enum { OCTAVES = 8, SAMPLES = 32768, SEEDS = 16 };

/* Add what periodograms (Hann's window) under both tracks say: the density over that of the class's line, and the
 * tracks' cross-spectrum over that line less 1 / (1 + (5 n track)^2), frequency by frequency to its octave. The heights
 * are sampled between the profile's points too, so that interpolation counts. */
static void measure_spectrum(const gic_road_grid *road, double gd, double track, double density[OCTAVES],
                             double common[OCTAVES], int bins[OCTAVES])
{
    const double spacing = 0.07; /* no multiple of the profile's */
    static double complex left[SAMPLES], right[SAMPLES];
    for (int m = 0; m < SAMPLES; ++m) {
        /* 400 m on: the common part starts at 0, and this is where it begins to forget that */
        const gic_real x = (gic_real)(400 + spacing * m);
        const double window = 1 - cos(2 * (double)pi * m / (int)SAMPLES);
        gic_real l[3], r[3];
        road->head.height(&road->head, 0, 0, x, (gic_real)(0.6 * track), l);
        road->head.height(&road->head, 0, 0, x, (gic_real)(-0.6 * track), r);
        left[m] = window * (double)l[0];
        right[m] = window * (double)r[0];
    }
    transform(left, SAMPLES);
    transform(right, SAMPLES);
    for (int k = 1; k < SAMPLES / 2; ++k) {
        const double n = k / (spacing * (int)SAMPLES),
                     scale = 2 * spacing / (int)SAMPLES / 1.5; /* 1.5: mean of window^2 */
        const int octave = (int)floor(log2(n / 2.83)) + OCTAVES;
        if (n > 2.83 || octave < 0)
            continue;
        const double line = gd * 0.01 / (n * n), alike = 1 / (1 + pow(5 * n * track, 2));
        const double of_both = scale * (pow(cabs(left[k]), 2) + pow(cabs(right[k]), 2)) / 2;
        density[octave] += of_both / line;
        common[octave] += scale * creal(left[k] * conj(right[k])) / line - alike;
        ++bins[octave];
    }
}

/* Means over an octave and 16 seeds. The lowest octave has 24 frequencies; the window leaves some 12 of them
 * independent, so that 200 samples of relative deviation 1 (of one track: the other is nearly the same there) leave 7
 * percent. A quarter is three of these and what the leaking integrators take, 6 percent at 100 m. The other octaves
 * have less of both. */
static void test_spectrum(void **unused)
{
    (void)unused;
    const double within = 0.25;
    double density[OCTAVES] = {0}, common[OCTAVES] = {0};
    int bins[OCTAVES] = {0};
    gic_iso8608 profile = class_c;
    for (profile.seed = 1; profile.seed <= SEEDS; ++profile.seed) {
        const gic_road_grid road = random_road(&profile, POINTS);
        measure_spectrum(&road, 256e-6, 1.5, density, common, bins);
        free((void *)road.height);
    }
    for (int i = 0; i < OCTAVES; ++i) {
        const double middle = 2.83 * pow(2, i - OCTAVES + 0.5);
        density[i] /= bins[i];
        common[i] /= bins[i];
        if (fabs(density[i] - 1) > within || fabs(common[i]) > within / 2)
            fail_msg("about %g cycles/m: %g of the class's density, common part off by %g", middle, density[i],
                     common[i]);
    }
}

/* x K1(x), K1 the modified Bessel function, by its integral of exp(-x cosh t) cosh t. */
static double isotropic(double x)
{
    double sum = 0;
    for (double t = 0.005; t < 12; t += 0.01)
        sum += 0.01 * exp(-x * cosh(t)) * cosh(t);
    return x * sum;
}

/* SCENE.md says how near the tracks' common part is to that of an isotropic surface. */
static void test_isotropic(void **unused)
{
    (void)unused;
    assert_true(fabs(isotropic(1) - 0.6019072302) < 1e-6); /* a published value: K1(1) */
    for (double n = 0.001; n < 10; n *= 1.1)
        assert_true(fabs(isotropic(2 * (double)pi * n * 1.5) - 1 / (1 + pow(5 * n * 1.5, 2))) < 0.05);
}

static void test_random_road(void **unused)
{
    (void)unused;
    enum { FEW = 401 };
    gic_iso8608 profile = {'A', 7, GIC_R(2.0), GIC_R(20.0), GIC_R(1.5), GIC_R(5.0)};
    const gic_road_grid road = random_road(&profile, FEW), again = random_road(&profile, FEW);
    const size_t size = 2 * FEW * sizeof *road.height;
    assert_memory_equal(road.height, again.height, size); /* the same seed, the same bits */
    assert_int_equal(gic_road_grid_check(&road), GIC_OK);
    /* each class has four times the density of the one before, twice the height */
    for (int class = 1; class < 8; ++class) {
        gic_iso8608 rougher = profile;
        rougher.road_class = (char)('A' + class);
        const gic_road_grid other = random_road(&rougher, FEW);
        for (int i = 0; i < 2 * FEW; ++i)
            assert_true(fabs((double)other.height[i] - (1 << class) * (double)road.height[i]) <=
                        (1 << class) * 4 * EPSILON * fabs((double)road.height[i]));
        free((void *)other.height);
    }
    profile.seed = 8;
    const gic_road_grid foreign = random_road(&profile, FEW);
    assert_memory_not_equal(road.height, foreign.height, size);
    free((void *)foreign.height);

    /* level up to its start and behind its end, without a step; the tracks' heights beside the tracks */
    gic_real out[3];
    for (int side = -1; side <= 1; ++side) {
        road.head.height(&road.head, 0, 0, GIC_R(2.0), (gic_real)side, out);
        assert_true(out[0] == GIC_R(0.0) && out[1] == GIC_R(0.0) && out[2] == GIC_R(0.0));
        road.head.height(&road.head, 0, 0, GIC_R(23.0), (gic_real)side, out);
        assert_true(out[1] == GIC_R(0.0));
    }
    road.head.height(&road.head, 0, 0, GIC_R(12.0), GIC_R(0.9), out);
    assert_true(fabs((double)out[0] - (double)road.height[FEW + 200]) <= 400 * EPSILON && out[2] == GIC_R(0.0));
    road.head.height(&road.head, 0, 0, GIC_R(12.0), GIC_R(-0.75), out);
    assert_true(fabs((double)out[0] - (double)road.height[200]) <= 400 * EPSILON);

    const gic_iso8608 good = profile;
    gic_road_grid never;
    gic_real height[2 * FEW];
    for (int fault = 0; fault < 8; ++fault) {
        int32_t count = FEW;
        profile = good;
        switch (fault) {
        case 0: profile.road_class = 'I'; break;
        case 1: profile.road_class = 'a'; break;
        case 2: profile.length = GIC_R(0.0); break;
        case 3: profile.track = GIC_R(-1.0); break;
        case 4: profile.fade = GIC_R(-1.0); break;
        case 5: memset(&profile.start, 0xff, sizeof profile.start); break;
        case 6: count = 1; break;
        default: count = 10; /* points 2.2 m apart: more than the track */
        }
        assert_int_equal(gic_road_iso8608_setup(&never, &profile, height, count), GIC_ERROR_ARGUMENT);
    }
    free((void *)road.height);
    free((void *)again.height);
}

/* ---- roads made of roads -------------------------------------------------------------------------------- */

static void test_sum(void **unused)
{
    (void)unused;
    const gic_road_plane plane = {
        {gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE}, GIC_R(0.25), GIC_R(0.05), GIC_R(-0.03)};
    const gic_road *const part[] = {&plane.head, &grid.head};
    const gic_road_sum sum = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, part, 2};
    gic_real out[3], a[3], b[3];
    for (double x = -1; x < 5; x += 0.37) {
        sum.head.height(&sum.head, 0, 0, (gic_real)x, GIC_R(0.2), out);
        plane.head.height(&plane.head, 0, 0, (gic_real)x, GIC_R(0.2), a);
        grid.head.height(&grid.head, 0, 0, (gic_real)x, GIC_R(0.2), b);
        for (int k = 0; k < 3; ++k)
            assert_true(fabs((double)out[k] - (double)a[k] - (double)b[k]) <= 2 * EPSILON);
    }
}

static void test_friction(void **unused)
{
    (void)unused;
    const gic_road_plane plane = {
        {gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE}, GIC_R(0.25), GIC_R(0.05), GIC_R(-0.03)};
    const gic_friction_patch patch[] = {{GIC_R(2.0), GIC_R(6.0), GIC_R(-1.0), GIC_R(1.0), GIC_R(0.25), GIC_R(1.0)},
                                        {GIC_R(4.0), GIC_R(8.0), GIC_R(0.0), GIC_R(3.0), GIC_R(0.5), GIC_R(0.5)}};
    gic_road_patched road = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &plane.head,
        GIC_R(0.75),
        patch,
        2};
    const struct {
        double x, y, value;
    } expected[] = {{-9, 0, 0.75},
                    {1.5, -0.4, 0.75},
                    {2.5, -0.5, 0.25},
                    {2, -0.5, 0.5},                     /* an edge has the mean */
                    {2, -1, 0.625},                     /* a corner: a quarter of the way */
                    {2.25, -0.5, 0.75 - 0.5 * 0.84375}, /* smooth: s^2 (3 - 2 s) at s = 3/4 */
                    {5, 0.4, 0.5},
                    {5, 1.9, 0.5}, /* the last patch lies on top */
                    {5, 0, 0.375}, /* its edge, on the first patch */
                    {8.25, 1.5, 0.75},
                    {6, 3.5, 0.75}};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; ++i) {
        const gic_real value = road.head.friction(&road.head, 0, 0, (gic_real)expected[i].x, (gic_real)expected[i].y);
        if (fabs((double)value - expected[i].value) > 4 * EPSILON)
            fail_msg("friction at %g, %g is %g", expected[i].x, expected[i].y, (double)value);
    }
    double before = 0.75, slope_before = 0; /* neither steps nor kinks along a line across both */
    for (double x = 1, d = 1e-3; x < 9; x += d) {
        const double value = (double)road.head.friction(&road.head, 0, 0, (gic_real)x, GIC_R(0.5));
        const double slope = (value - before) / d;
        assert_true(fabs(slope - slope_before) < 6 / 0.25 * d + 8 * EPSILON / d); /* second derivative 6 / fade^2 */
        before = value;
        slope_before = slope;
    }
    gic_real out[3], under[3];
    for (int bare = 0; bare < 2; ++bare) {
        road.head.height(&road.head, 0, 0, GIC_R(3.0), GIC_R(2.0), out);
        plane.head.height(&plane.head, 0, 0, GIC_R(3.0), GIC_R(2.0), under);
        for (int k = 0; k < 3; ++k)
            assert_true(out[k] == (bare ? GIC_R(0.0) : under[k]));
        road.under = NULL;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_roads),    cmocka_unit_test(test_many_bumps), cmocka_unit_test(test_table),
        cmocka_unit_test(test_grid),     cmocka_unit_test(test_nowhere),    cmocka_unit_test(test_recurrence),
        cmocka_unit_test(test_spectrum), cmocka_unit_test(test_isotropic),  cmocka_unit_test(test_random_road),
        cmocka_unit_test(test_sum),      cmocka_unit_test(test_friction),
    };
    return cmocka_run_group_tests_name("road", tests, NULL, NULL);
}
