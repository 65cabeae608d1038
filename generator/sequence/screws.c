/* SPDX-License-Identifier: MIT
 * Screws of joints, their rank, and a walk along a motion that the joints allow. */
#include "base/random.h"
#include "base/vec3.h"
#include "model/model.h"
#include "sequence/rank.h"
#include "sequence/screws.h"

#include <math.h>
#include <string.h>

enum {
    STRIDES = 3,     /* steps from one configuration to the next */
    CORRECTIONS = 20 /* of one step */
};

static const double stride = 0.1;     /* rad, or relative to the size */
static const double rank_zero = 1e-6; /* relative size of a pivot that counts as 0 */

/* ---- rows ------------------------------------------------------------------------------------------------ */

static void across(const double axis[3], double n1[3], double n2[3])
{
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (fabs(axis[i]) < fabs(axis[least]) - 1e-9)
            least = i;
    double e[3] = {0};
    e[least] = 1;
    cross3(axis, e, n1);
    const double norm = norm3(n1);
    for (int i = 0; i < 3; ++i)
        n1[i] /= norm;
    cross3(axis, n1, n2);
}

static void turned(const Pose3 *place, const double x[3], double out[3])
{
    if (place)
        apply3(place->A, x, out);
    else
        memcpy(out, x, 3 * sizeof *out);
}

static void moved(const Pose3 *place, const double x[3], double out[3])
{
    turned(place, x, out);
    for (int i = 0; place && i < 3; ++i)
        out[i] += place->t[i];
}

/* Rows of one link as they grow: screws (force, moment about the centre / size) and residuals. */
typedef struct Rows {
    const Relax *relax;
    double screw[ROWS_MOST][6], residual[ROWS_MOST];
    int count;
} Rows;

static void add_force(Rows *rows, const double force[3], const double at[3], double residual)
{
    double arm[3], *screw = rows->screw[rows->count];
    for (int i = 0; i < 3; ++i) {
        screw[i] = force[i];
        arm[i] = (at[i] - rows->relax->centre[i]) / rows->relax->size;
    }
    cross3(arm, force, screw + 3);
    rows->residual[rows->count++] = residual / rows->relax->size;
}

static void add_couple(Rows *rows, const double a[3], const double b[3])
{
    double *screw = rows->screw[rows->count];
    memset(screw, 0, 3 * sizeof *screw);
    cross3(b, a, screw + 3); /* of a . b, for a rotation of b */
    rows->residual[rows->count++] = dot3(a, b);
}

bool screws_have(JointType type, const char *letters)
{
    return strchr(letters, 'a' + (int)type) != NULL;
}

/* Of a coordinate: u its axis, x the point in the second body, d the way there from the first. */
static void row_of_coordinate(Rows *rows, const Link *link, const double u[3], const double x[3], const double d[3])
{
    if (link->kind == COORDINATE_ANGLE) {
        memcpy(rows->screw[rows->count++] + 3, u, 3 * sizeof *u);
        return;
    }
    const double length = link->kind == COORDINATE_LENGTH ? norm3(d) : 1;
    const double *along = link->kind == COORDINATE_LENGTH ? d : u;
    const double force[3] = {along[0] / length, along[1] / length, along[2] / length};
    add_force(rows, force, x, 0);
}

static Rows rows_of(const Relax *relax, const Link *link, const Pose3 *place)
{
    Rows rows = {.relax = relax};
    const Pose3 *pa = place && link->body[0] >= 0 ? place + link->body[0] : NULL;
    const Pose3 *pb = place && link->body[1] >= 0 ? place + link->body[1] : NULL;
    double x[2][3], d[3], u[2][3], n[2][3], na[2][3], nb[3];
    moved(pa, link->point[0], x[0]);
    moved(pb, link->point[1], x[1]);
    turned(pa, link->axis[0], u[0]);
    turned(pb, link->axis[1], u[1]);
    across(link->axis[0], n[0], n[1]);
    for (int i = 0; i < 2; ++i)
        turned(pa, n[i], na[i]);
    turned(pb, n[1], nb);
    for (int i = 0; i < 3; ++i)
        d[i] = x[1][i] - x[0][i];
    if (link->coordinate) {
        row_of_coordinate(&rows, link, u[0], x[1], d);
        return rows;
    }
    if (screws_have(link->type, "abef"))
        for (int i = 0; i < 3; ++i) {
            double e[3] = {0};
            e[i] = 1;
            add_force(&rows, e, x[1], d[i]);
        }
    if (screws_have(link->type, "acdfk"))
        for (int i = 0; i < 2; ++i)
            add_couple(&rows, na[i], u[1]);
    if (screws_have(link->type, "cf"))
        add_couple(&rows, na[0], nb);
    if (screws_have(link->type, "cdi"))
        for (int i = 0; i < 2; ++i)
            add_force(&rows, na[i], x[1], dot3(na[i], d));
    if (screws_have(link->type, "gh")) {
        const double length = norm3(d);
        double e[3] = {d[0] / length, d[1] / length, d[2] / length};
        add_force(&rows, e, x[1], length - link->length);
    }
    if (screws_have(link->type, "hj"))
        add_force(&rows, u[0], x[1], dot3(u[0], d) - (link->type == JOINT_REVOLUTE_SPHERICAL ? link->offset : 0));
    if (screws_have(link->type, "el"))
        add_couple(&rows, u[0], u[1]);
    if (joint_is_geared(link->type)) {
        double way[3]; /* along u, or along the rack, which the first body has */
        turned(pa, link->axis[1], way);
        turned(pb, n[0], n[0]);
        const double angle = atan2(dot3(na[1], n[0]), dot3(na[0], n[0]));
        add_force(&rows, way, x[1], dot3(way, d) - link->offset * angle);
        for (int i = 0; i < 3; ++i)
            rows.screw[rows.count - 1][3 + i] -= link->offset / relax->size * u[0][i];
    }
    return rows;
}

/* Rows over all unknowns into A from row `at` on, residuals into r (NULL: not wanted). Returns how many. */
static int put_rows(const Relax *relax, const Link *link, const Pose3 *place, double *A, double *r)
{
    const Rows rows = rows_of(relax, link, place);
    memset(A, 0, sizeof *A * (size_t)(rows.count * relax->n));
    for (int k = 0; k < rows.count; ++k)
        for (int end = 0; end < 2; ++end)
            for (int i = 0; link->body[end] >= 0 && i < BODY_TWIST; ++i)
                A[relax->n * k + BODY_TWIST * link->body[end] + i] += end ? rows.screw[k][i] : -rows.screw[k][i];
    if (r)
        memcpy(r, rows.residual, sizeof *r * (size_t)rows.count);
    return rows.count;
}

int screws_rank(const Relax *relax, int configuration, int count, int without, const Link *other, double *least)
{
    const Pose3 *place = relax->place + configuration * relax->bodies;
    int rows = 0;
    for (int i = 0; i < count; ++i)
        if (i != without && !(i < relax->joints && relax->gone[i]))
            rows += put_rows(relax, &relax->link[i], place, relax->A + relax->n * rows, NULL);
    if (other)
        rows += put_rows(relax, other, place, relax->A + relax->n * rows, NULL);
    return matrix_rank(rows, relax->n, rank_zero, relax->A, NULL, least);
}

/* ---- configurations -------------------------------------------------------------------------------------- */

/* Solve N x = b, N symmetric and positive definite; both are overwritten. */
static void solve_definite(int n, double *N, double *b)
{
    for (int k = 0; k < n; ++k)
        for (int i = k + 1; i < n; ++i) {
            const double factor = N[n * i + k] / N[n * k + k];
            for (int j = k; factor != 0 && j < n; ++j)
                N[n * i + j] -= factor * N[n * k + j];
            b[i] -= factor * b[k];
        }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j)
            b[k] -= N[n * k + j] * b[j];
        b[k] /= N[n * k + k];
    }
}

static void move(const Relax *relax, Pose3 *place, const double *twist)
{
    for (int body = 0; body < relax->bodies; ++body, twist += BODY_TWIST) {
        const double angle = norm3(twist + 3), half = angle / 2;
        const double s = angle > 1e-12 ? sin(half) / angle : 0.5;
        const double p[4] = {cos(half), s * twist[3], s * twist[4], s * twist[5]};
        double R[9], A[9], t[3];
        mat_from_euler(p, R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                A[3 * i + j] = 0;
                for (int k = 0; k < 3; ++k)
                    A[3 * i + j] += R[3 * i + k] * place[body].A[3 * k + j];
            }
        for (int i = 0; i < 3; ++i)
            place[body].t[i] -= relax->centre[i];
        apply3(R, place[body].t, t);
        for (int i = 0; i < 3; ++i)
            place[body].t[i] = t[i] + relax->centre[i] + twist[i] * relax->size;
        memcpy(place[body].A, A, sizeof A);
    }
}

/* The smallest twist x with J x = r of all joints, J at `place`; redundant joints are allowed. Returns the largest
 * residual. wanted NULL: r corrects the residuals, else r = J wanted. */
static double least_twist(Relax *relax, const Pose3 *place, const double *wanted, double *x)
{
    const int n = relax->n;
    double r[ROWS_MOST], worst = 0;
    memset(relax->N, 0, sizeof *relax->N * (size_t)(n * n));
    memset(x, 0, sizeof *x * (size_t)n);
    for (int i = 0; i < n; ++i)
        relax->N[n * i + i] = 1e-11;
    for (int l = 0; l < relax->joints; ++l) {
        const int rows = put_rows(relax, &relax->link[l], place, relax->A, r);
        for (int k = 0; k < rows; ++k) {
            const double *row = relax->A + n * k;
            double right = -r[k];
            worst = fmax(worst, fabs(r[k]));
            if (wanted) {
                right = 0;
                for (int j = 0; j < n; ++j)
                    right += row[j] * wanted[j];
            }
            for (int i = 0; i < n; ++i)
                for (int j = 0; row[i] != 0 && j < n; ++j)
                    relax->N[n * i + j] += row[i] * row[j];
            for (int i = 0; i < n; ++i)
                x[i] += row[i] * right;
        }
    }
    solve_definite(n, relax->N, x);
    return worst;
}

bool screws_step(Relax *relax, Pose3 *place, double *way)
{
    const int n = relax->n;
    for (int pass = 0; pass < 2; ++pass) {
        least_twist(relax, place, way, relax->b);
        for (int i = 0; i < n; ++i)
            way[i] -= relax->b[i];
    }
    double largest = 0;
    for (int i = 0; i < n; ++i)
        largest = fmax(largest, fabs(way[i]));
    if (!(largest > 1e-6))
        return false;
    double step[n + 1];
    for (int i = 0; i < n; ++i) {
        way[i] /= largest;
        step[i] = stride * way[i];
    }
    move(relax, place, step);
    for (int i = 0; i < CORRECTIONS; ++i) {
        const double worst = least_twist(relax, place, NULL, relax->b);
        if (worst < 1e-11)
            return true;
        if (!(worst < 1))
            return false;
        move(relax, place, relax->b);
    }
    return false;
}

void screws_walk(Relax *relax)
{
    const size_t size = (size_t)relax->bodies * sizeof *relax->place;
    Random random = {42};
    relax->place = pool_alloc(relax->pool, (2 * WALK + 1) * size);
    for (int b = 0; b < relax->bodies; ++b)
        relax->place[b] = (Pose3){.A = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    relax->configurations = 1;
    double first[relax->n + 1], way[relax->n + 1];
    for (int i = 0; i < relax->n; ++i)
        first[i] = random_uniform(&random, -1, 1);
    for (int side = 0; side < 2; ++side) {
        Pose3 *place = pool_grow(relax->pool, relax->place, size, size);
        bool good = true;
        for (int i = 0; i < relax->n; ++i)
            way[i] = side ? -first[i] : first[i];
        for (int k = 0; k < WALK && good; ++k) {
            for (int i = 0; i < STRIDES && good; ++i)
                good = screws_step(relax, place, way);
            if (good)
                memcpy(relax->place + relax->bodies * relax->configurations++, place, size);
        }
    }
}

double screws_speed(const Relax *relax, const Link *link, const Pose3 *place, const double *way)
{
    double sum = 0;
    put_rows(relax, link, place, relax->A, NULL);
    for (int i = 0; i < relax->n; ++i)
        sum += relax->A[i] * way[i];
    return sum;
}
