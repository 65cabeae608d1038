/* SPDX-License-Identifier: MIT
 * The gains of a driver who steers along a path, from the linear model straight ahead at a speed. He looks each
 * `period` and moves the steering by a polynomial (models/SCENE.md section 5), so the map of small motions from one
 * look to the next is linear. Its eigenvalues tell how quickly errors die out. */
#include "host/gsl_errors.h"
#include "run/manoeuvre.h"
#include "scene/profile_form.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

#include <math.h>
#include <string.h>

/* Scenes of manoeuvres state both. */
const double driver_period = 0.02, driver_reach = 0.1;
/* Previews that are tried, s, by equal factors; the best of them is refined to this share of itself. */
static const double nearest = 0.05, farthest = 8, fine = 1e-5;
enum { TRIED = 60 };
/* Gains of which the best is taken where errors do not die out with that of the steady motion. */
static const double gains[] = {0.125, 0.25, 0.5, 1, 2, 4, 8};
/* An eigenvalue that the driver moves by no more belongs to a motion that is not his: he can not see or steer it. */
static const double same = 1e-9;
static const double shortest = 1.5; /* m that he looks ahead at least, where that is not more than at his speed */

enum { MOVE = DRIVER_MOVE, KEPT = DRIVER_KEPT };

/* Small motions from look to look: of the vehicle [n], the steering and its derivatives [KEPT], the curvature that the
 * driver has learnt. */
typedef struct Loop {
    double speed, adapt, steering_by_angle, gain, wheelbase;
    int n, y, yaw, yaw_rate;
    gsl_matrix *flow; /* [n + MOVE]: over a period, with the steering a polynomial */
    gsl_matrix *map;  /* [n + KEPT + 1]: work */
    gsl_matrix *look; /* [n + MOVE][n + KEPT + 1]: work */
    gsl_eigen_nonsymm_workspace *work;
    gsl_vector_complex *value, *without; /* eigenvalues; those without a driver */
} Loop;

/* Numbers that steering changes and that change where the driver looks, *n of them in their order. */
static int *numbers_of(Pool *pool, const SheetPath *path, int *n)
{
    const int all = path->n;
    bool *moved = pool_alloc(pool, (size_t)all * sizeof *moved), *seen = pool_alloc(pool, (size_t)all * sizeof *seen);
    int *kept = pool_alloc(pool, (size_t)all * sizeof *kept);
    for (int i = 0; i < all; ++i) {
        seen[i] = i == path->y || i == path->yaw || i == path->yaw_rate;
        for (int k = 0; k < SHEET_STEERING; ++k)
            moved[i] = moved[i] || path->B[k * all + i] != 0;
    }
    for (bool more = true; more;) {
        more = false;
        for (int i = 0; i < all; ++i)
            for (int j = 0; j < all; ++j) {
                const bool moves = moved[j] && !moved[i], sees = seen[i] && !seen[j];
                if (path->A[i * all + j] == 0 || (!moves && !sees))
                    continue;
                moved[i] = moved[i] || moved[j];
                seen[j] = seen[j] || seen[i];
                more = true;
            }
    }
    *n = 0;
    for (int i = 0; i < all; ++i)
        if (moved[i] && seen[i])
            kept[(*n)++] = i;
    return kept;
}

/* The place of a number among those kept. */
static int place_of(const int *kept, int n, int number)
{
    for (int i = 0; i < n; ++i)
        if (kept[i] == number)
            return i;
    return -1;
}

void driver_movement(const double now[KEPT], double end, double out[MOVE])
{
    Movement movement = movement_rest(0);
    double factorial = 1;
    movement_from(&movement, 0, now, end, driver_reach);
    for (int k = 0; k < MOVE; ++k) {
        factorial *= k > 1 ? k : 1;
        out[k] = factorial * movement.c[k];
    }
}

/* The map from look to look with a preview, m; 0: the driver steers straight. */
static void set_map(Loop *loop, double ahead)
{
    const size_t n = (size_t)loop->n, learnt = n + KEPT;
    double out[MOVE];
    gsl_matrix_set_zero(loop->look);
    for (size_t i = 0; i < n; ++i)
        gsl_matrix_set(loop->look, i, i, 1);
    for (size_t k = 0; k < KEPT; ++k) {
        double now[KEPT] = {0};
        now[k] = 1;
        driver_movement(now, 0, out);
        for (size_t i = 0; i < MOVE; ++i)
            gsl_matrix_set(loop->look, n + i, n + k, out[i]);
    }
    /* the curvature of the circle through the point ahead, by the place aside and the heading */
    const double by_y = ahead > 0 ? -2 / fmax(ahead * ahead, 1) : 0, by_yaw = by_y * ahead;
    const double by_curvature = loop->gain * loop->steering_by_angle * loop->wheelbase;
    driver_movement((double[KEPT]){0}, by_curvature, out);
    for (size_t i = 0; i < MOVE; ++i) {
        gsl_matrix_set(loop->look, n + i, (size_t)loop->y, out[i] * by_y);
        gsl_matrix_set(loop->look, n + i, (size_t)loop->yaw, out[i] * by_yaw);
        if (ahead > 0)
            gsl_matrix_set(loop->look, n + i, learnt, out[i]);
    }
    gsl_matrix_view top = gsl_matrix_submatrix(loop->map, 0, 0, learnt, learnt + 1);
    const gsl_matrix_const_view flow = gsl_matrix_const_submatrix(loop->flow, 0, 0, learnt, n + MOVE);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, &flow.matrix, loop->look, 0, &top.matrix);
    for (size_t j = 0; j <= learnt; ++j)
        gsl_matrix_set(loop->map, learnt, j, 0);
    const double learns = ahead > 0 ? loop->adapt * driver_period : 0;
    gsl_matrix_set(loop->map, learnt, learnt, learns > 0 ? 1 : 0);
    gsl_matrix_set(loop->map, learnt, (size_t)loop->y, learns * by_y);
    gsl_matrix_set(loop->map, learnt, (size_t)loop->yaw, learns * by_yaw);
    gsl_matrix_set(loop->map, learnt, (size_t)loop->yaw_rate, -learns / loop->speed);
}

static bool eigenvalues(Loop *loop, gsl_vector_complex *value)
{
    return gsl_eigen_nonsymm(loop->map, value, loop->work) == GSL_SUCCESS;
}

/* Is an eigenvalue one of those without a driver? */
static bool is_not_his(const Loop *loop, gsl_complex value)
{
    for (size_t i = 0; i < loop->without->size; ++i)
        if (gsl_complex_abs(gsl_complex_sub(value, gsl_vector_complex_get(loop->without, i))) < same)
            return true;
    return false;
}

/* 1/s with which the slowest motion that the driver moves dies out, with a preview, s. */
static double decay_of(Loop *loop, double preview)
{
    double largest = 0;
    set_map(loop, preview * loop->speed);
    if (!eigenvalues(loop, loop->value))
        return -INFINITY;
    for (size_t i = 0; i < loop->value->size; ++i) {
        const gsl_complex value = gsl_vector_complex_get(loop->value, i);
        if (!is_not_his(loop, value))
            largest = fmax(largest, gsl_complex_abs(value));
    }
    return -log(largest) / driver_period;
}

static Loop *loop_open(const TestCar *car, const PathDriver *driver)
{
    SheetPath path;
    Pool *pool = car->pool;
    int count;
    if (!sheet_path(&car->sheet, car->axle->steer, driver->speed, &path))
        return NULL;
    const int *kept = numbers_of(pool, &path, &count);
    Loop *loop = pool_alloc(pool, sizeof *loop);
    *loop = (Loop){.speed = driver->speed,
                   .steering_by_angle = 1 / car->angle,
                   .gain = driver->gain,
                   .wheelbase = car->sheet.wheelbase,
                   .n = count,
                   .y = place_of(kept, count, path.y),
                   .yaw = place_of(kept, count, path.yaw),
                   .yaw_rate = place_of(kept, count, path.yaw_rate)};
    if (loop->y < 0 || loop->yaw < 0 || loop->yaw_rate < 0)
        return NULL;
    gsl_errors_return();
    const size_t n = (size_t)count, size = n + KEPT + 1;
    gsl_matrix *A = gsl_matrix_calloc(n + MOVE, n + MOVE);
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < n; ++j)
            gsl_matrix_set(A, i, j, driver_period * path.A[kept[i] * path.n + kept[j]]);
        for (size_t k = 0; k < SHEET_STEERING; ++k)
            gsl_matrix_set(A, i, n + k, driver_period * path.B[(int)k * path.n + kept[i]]);
    }
    for (size_t k = 0; k + 1 < MOVE; ++k)
        gsl_matrix_set(A, n + k, n + k + 1, driver_period);
    loop->flow = gsl_matrix_alloc(n + MOVE, n + MOVE);
    gsl_linalg_exponential_ss(A, loop->flow, GSL_PREC_DOUBLE);
    gsl_matrix_free(A);
    loop->map = gsl_matrix_calloc(size, size);
    loop->look = gsl_matrix_calloc(n + MOVE, size);
    loop->work = gsl_eigen_nonsymm_alloc(size);
    gsl_eigen_nonsymm_params(0, 1, loop->work);
    loop->value = gsl_vector_complex_alloc(size);
    loop->without = gsl_vector_complex_alloc(size);
    return loop;
}

static void loop_close(Loop *loop)
{
    gsl_matrix_free(loop->flow);
    gsl_matrix_free(loop->map);
    gsl_matrix_free(loop->look);
    gsl_eigen_nonsymm_free(loop->work);
    gsl_vector_complex_free(loop->value);
    gsl_vector_complex_free(loop->without);
}

static double tried(int k)
{
    return nearest * pow(farthest / nearest, (double)k / (TRIED - 1));
}

/* The preview of the quickest decay: the best of those tried, refined by golden sections between those beside it. */
static void find_preview(Loop *loop, PathDriver *driver)
{
    double decay[TRIED];
    int best = 0;
    for (int k = 0; k < TRIED; ++k) {
        decay[k] = decay_of(loop, tried(k));
        best = decay[k] > decay[best] ? k : best;
    }
    int first = best, last = best;
    while (first > 0 && decay[first - 1] > 0)
        --first;
    while (last + 1 < TRIED && decay[last + 1] > 0)
        ++last;
    driver->stable[0] = tried(first);
    driver->stable[1] = tried(last);
    const double golden = (sqrt(5) - 1) / 2;
    double low = tried(best > 0 ? best - 1 : 0), high = tried(best + 1 < TRIED ? best + 1 : best);
    double at[2] = {high - golden * (high - low), low + golden * (high - low)};
    double of[2] = {decay_of(loop, at[0]), decay_of(loop, at[1])};
    while (high - low > fine * high) {
        const int worse = of[0] > of[1];
        if (worse) {
            high = at[1];
            at[1] = at[0];
            of[1] = of[0];
            at[0] = high - golden * (high - low);
            of[0] = decay_of(loop, at[0]);
        } else {
            low = at[0];
            at[0] = at[1];
            of[0] = of[1];
            at[1] = low + golden * (high - low);
            of[1] = decay_of(loop, at[1]);
        }
    }
    driver->preview = of[0] > of[1] ? at[0] : at[1];
    driver->decay = fmax(of[0], of[1]);
    if (!(driver->decay >= decay[best])) { /* several peaks between */
        driver->preview = tried(best);
        driver->decay = decay[best];
    }
}

bool manoeuvre_find_driver(Manoeuvre *m, double speed, double adapt, PathDriver *driver, const char **why)
{
    const TestCar *car = m->car;
    car_need_origin(car);
    const double by_ay = car_angle_by_acceleration(car, speed);
    *driver = (PathDriver){.speed = speed, .gain = 1};
    if (by_ay > 0)
        driver->gain = by_ay * speed * speed / car->sheet.wheelbase;
    Loop *loop = loop_open(car, driver);
    if (!loop) {
        *why = pool_print(m->pool, "there are no small motions straight ahead at %.4g m/s that steering moves", speed);
        return false;
    }
    set_map(loop, 0);
    bool found = eigenvalues(loop, loop->without);
    PathDriver best = *driver;
    if (found)
        find_preview(loop, &best);
    const bool steady = found && best.decay > 0;
    for (size_t i = 0; i < sizeof gains / sizeof *gains && found && !steady; ++i) {
        PathDriver other = *driver;
        loop->gain = other.gain = gains[i];
        find_preview(loop, &other);
        best = other.decay > best.decay ? other : best;
    }
    found = found && best.decay > 0;
    if (found) { /* he learns more slowly than errors die out, or not at all */
        *driver = best;
        loop->gain = best.gain;
        loop->adapt = adapt;
        driver->adapt = decay_of(loop, driver->preview) > 0 ? adapt : 0;
    }
    loop_close(loop);
    if (!found)
        *why = pool_print(m->pool,
                          "no driver keeps it on a path at %.4g m/s: errors die out with no preview from %g to %g s, "
                          "however much he steers",
                          speed, nearest, farthest);
    return found;
}

PathDriver manoeuvre_driver(Manoeuvre *m, double speed, double adapt)
{
    PathDriver driver;
    const char *why;
    if (!manoeuvre_find_driver(m, speed, adapt, &driver, &why))
        car_refuse(m->car, "choose a lower speed; `gicrun --modes` tells what is not stable there", why);
    return driver;
}

const char *manoeuvre_driver_text(const Manoeuvre *m, const PathDriver *driver, const char *pedals, const char *path)
{
    const TestCar *car = m->car;
    return pool_print(
        m->pool,
        "driver:\n  period: %g\n  reach: %g\n%s  steering:\n    path: %s\n    input: %s\n"
        "    straight: %.17g\n    per_angle: %.17g\n    wheelbase: %.17g\n    limit: %.17g\n    preview: %.9g\n"
        "    shortest: %.9g\n    adapt: %g\n",
        driver_period, driver_reach, pedals, path, car->model->input[car->steering].name, car->straight,
        driver->gain / car->angle, car->sheet.wheelbase, 0.999 * fmin(-car->range[0], car->range[1]) / fabs(car->angle),
        driver->preview, driver->nearest > 0 ? driver->nearest : fmin(shortest, driver->preview * driver->speed),
        driver->adapt);
}

void manoeuvre_driver_rows(Manoeuvre *m, const PathDriver *driver, const char *prefix)
{
    const struct {
        const char *name, *title, *unit;
        double value;
    } row[] = {{"speed", "Speed for which he was found", "m/s", driver->speed},
               {"preview", "He looks ahead", "s", driver->preview},
               {"gain", "He steers, by the angle of a vehicle without slip", "1", driver->gain},
               {"decay", "Errors die out by the linear model", "1/s", driver->decay},
               {"adapt", "He learns how much the vehicle turns", "1/s", driver->adapt},
               {"shortest", "Shortest preview with which they do", "s", driver->stable[0]},
               {"longest", "Longest one", "s", driver->stable[1]}};
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i)
        sheet_add(m->result, i ? NULL : pool_print(m->pool, "Driver%s%s", *prefix ? ", " : "", prefix),
                  pool_print(m->pool, "%s%sdriver.%s", prefix, *prefix ? "." : "", row[i].name), row[i].title,
                  row[i].unit, row[i].value);
}
