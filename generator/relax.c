/* SPDX-License-Identifier: MIT
 * Redundant joints. A row of a joint is a screw: a force along a line or a couple between its two bodies. The rank of
 * all screws at several assembled configurations tells how many of a joint's equations are needed beside the others';
 * another type is offered where its screws give the same rank at each of them. */
#include "relax.h"

#include <math.h>
#include <string.h>

enum {
    BODY_TWIST = 6,
    ROWS_MOST = 6,    /* of one joint */
    WALK = 16,        /* configurations on each side of the design */
    STRIDES = 3,      /* steps from one to the next */
    CORRECTIONS = 20, /* of a step */
    DIRECTIONS = 16,  /* tried for the axis of a joint */
    BODIES_MOST = 24  /* larger parts would keep people waiting */
};

static const double stride = 0.1;        /* rad, or relative to the size */
static const double rank_zero = 1e-6;    /* relative size of a pivot that is rounding */
static const double clearly_better = 4;  /* times as far from singular as another joint */
static const double better = 1.05;       /* the same of a coordinate: the axis of the motion itself is best */

/* A joint or a coordinate as it is drawn, in the model frame. */
typedef struct Link {
    JointType type;
    bool coordinate;
    CoordinateType kind;
    int body[2]; /* places among the moving bodies, -1: stands still */
    int owner[2]; /* the same in the model */
    double point[2][3], axis[2][3], length, offset;
} Link;

/* Displacement from the drawing: x -> A x + t. */
typedef struct Place3 {
    double A[9], t[3];
} Place3;

typedef struct Relax {
    Pool *pool;
    const Model *model;
    int bodies, joints, coordinates, n; /* n: BODY_TWIST a body */
    int *index;                         /* [joints + coordinates] in the model */
    Link *link;                         /* the same; joints first */
    bool *gone;                         /* [joints] to be removed */
    bool *changed;                      /* [joints] */
    int counted;                        /* links whose rank counts: joints, or coordinates too where these must stay */
    double centre[3], size;
    int configurations;
    Place3 *place; /* [configurations][bodies] */
    double *A;     /* room for [rows][n] */
    double *N, *b; /* [n][n], [n] */
} Relax;

/* ---- rows ------------------------------------------------------------------------------------------------ */

static void across(const double axis[3], double n1[3], double n2[3])
{
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (fabs(axis[i]) < fabs(axis[least]) - 1e-9)
            least = i;
    double e[3] = {0};
    e[least] = 1;
    vec_cross(axis, e, n1);
    const double norm = vec_norm(n1);
    for (int i = 0; i < 3; ++i)
        n1[i] /= norm;
    vec_cross(axis, n1, n2);
}

static void turned(const Place3 *place, const double x[3], double out[3])
{
    if (place)
        mat_apply(place->A, x, out);
    else
        memcpy(out, x, 3 * sizeof *out);
}

static void moved(const Place3 *place, const double x[3], double out[3])
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
    vec_cross(arm, force, screw + 3);
    rows->residual[rows->count++] = residual / rows->relax->size;
}

static void add_couple(Rows *rows, const double a[3], const double b[3])
{
    double *screw = rows->screw[rows->count];
    memset(screw, 0, 3 * sizeof *screw);
    vec_cross(b, a, screw + 3); /* of a . b, by the turn of b */
    rows->residual[rows->count++] = vec_dot(a, b);
}

static bool has(JointType type, const char *types)
{
    return strchr(types, 'a' + (int)type) != NULL;
}

/* Types by letters: a revolute, b spherical, c prismatic, d cylindrical, e universal, f fixed, g distance, h
 * revolute_spherical, i point_on_line, j point_in_plane, k parallel, l perpendicular. */
static Rows rows_of(const Relax *relax, const Link *link, const Place3 *place)
{
    Rows rows = {.relax = relax};
    const Place3 *pa = place && link->body[0] >= 0 ? place + link->body[0] : NULL;
    const Place3 *pb = place && link->body[1] >= 0 ? place + link->body[1] : NULL;
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
        if (link->kind == COORDINATE_ANGLE)
            add_couple(&rows, na[0], nb);
        else if (link->kind == COORDINATE_TRANSLATION)
            add_force(&rows, u[0], x[1], 0);
        else {
            const double length = vec_norm(d);
            for (int i = 0; i < 3; ++i)
                d[i] /= length;
            add_force(&rows, d, x[1], 0);
        }
        return rows;
    }
    if (has(link->type, "abef"))
        for (int i = 0; i < 3; ++i) {
            double e[3] = {0};
            e[i] = 1;
            add_force(&rows, e, x[1], d[i]);
        }
    if (has(link->type, "acdfk"))
        for (int i = 0; i < 2; ++i)
            add_couple(&rows, na[i], u[1]);
    if (has(link->type, "cf"))
        add_couple(&rows, na[0], nb);
    if (has(link->type, "cdi"))
        for (int i = 0; i < 2; ++i)
            add_force(&rows, na[i], x[1], vec_dot(na[i], d));
    if (has(link->type, "gh")) {
        const double length = vec_norm(d);
        double e[3] = {d[0] / length, d[1] / length, d[2] / length};
        add_force(&rows, e, x[1], length - link->length);
    }
    if (has(link->type, "hj"))
        add_force(&rows, u[0], x[1], vec_dot(u[0], d) - (link->type == JOINT_REVOLUTE_SPHERICAL ? link->offset : 0));
    if (has(link->type, "el"))
        add_couple(&rows, u[0], u[1]);
    return rows;
}

/* Rows over all unknowns into A from row `at` on, residuals into r (NULL: not wanted). Returns how many. */
static int put_rows(const Relax *relax, const Link *link, const Place3 *place, double *A, double *r)
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

/* Rank of A [rows][n], which is spent; *least: smallest pivot of it. */
static int rank_of(int rows, int n, double *A, double *least)
{
    bool used[n + 1];
    memset(used, 0, sizeof used);
    *least = 1;
    for (int k = 0; k < rows && k < n; ++k) {
        int row = -1, column = -1;
        double largest = rank_zero;
        for (int i = k; i < rows; ++i)
            for (int j = 0; j < n; ++j)
                if (!used[j] && fabs(A[n * i + j]) > largest)
                    largest = fabs(A[n * i + j]), row = i, column = j;
        if (row < 0)
            return k;
        *least = fmin(*least, largest);
        used[column] = true;
        for (int j = 0; row != k && j < n; ++j) {
            const double swap = A[n * k + j];
            A[n * k + j] = A[n * row + j], A[n * row + j] = swap;
        }
        for (int i = k + 1; i < rows; ++i) {
            const double factor = A[n * i + column] / A[n * k + column];
            for (int j = 0; factor != 0 && j < n; ++j)
                A[n * i + j] -= factor * A[n * k + j];
        }
    }
    return rows < n ? rows : n;
}

/* Rank of the first `count` links but `without` (-1: none), with `other` (NULL: none), at a configuration. */
static int rank_at(const Relax *relax, int configuration, int count, int without, const Link *other, double *least)
{
    const Place3 *place = relax->place + configuration * relax->bodies;
    int rows = 0;
    for (int i = 0; i < count; ++i)
        if (i != without && !(i < relax->joints && relax->gone[i]))
            rows += put_rows(relax, &relax->link[i], place, relax->A + relax->n * rows, NULL);
    if (other)
        rows += put_rows(relax, other, place, relax->A + relax->n * rows, NULL);
    return rank_of(rows, relax->n, relax->A, least);
}

/* ---- configurations -------------------------------------------------------------------------------------- */

/* Solves N x = b, symmetric and positive definite, in place of both. */
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

static void move(const Relax *relax, Place3 *place, const double *twist)
{
    for (int body = 0; body < relax->bodies; ++body, twist += BODY_TWIST) {
        const double angle = vec_norm(twist + 3), half = angle / 2;
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
        mat_apply(R, place[body].t, t);
        for (int i = 0; i < 3; ++i)
            place[body].t[i] = t[i] + relax->centre[i] + twist[i] * relax->size;
        memcpy(place[body].A, A, sizeof A);
    }
}

/* The least twist x with J x = r of all joints, J at `place`; joints that repeat others don't matter. Returns the largest
 * residual. wanted NULL: r corrects the residuals, else r = J wanted. */
static double least_twist(Relax *relax, const Place3 *place, const double *wanted, double *x)
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

/* One step along the motion nearest to `way`, which becomes that motion. */
static bool walk(Relax *relax, Place3 *place, double *way)
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

static void find_configurations(Relax *relax)
{
    const size_t size = (size_t)relax->bodies * sizeof *relax->place;
    Random random = {42};
    relax->place = pool_alloc(relax->pool, (2 * WALK + 1) * size);
    for (int b = 0; b < relax->bodies; ++b)
        relax->place[b] = (Place3){.A = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    relax->configurations = 1;
    double first[relax->n + 1], way[relax->n + 1];
    for (int i = 0; i < relax->n; ++i)
        first[i] = random_uniform(&random, -1, 1);
    for (int side = 0; side < 2; ++side) {
        Place3 *place = pool_grow(relax->pool, relax->place, size, size);
        bool good = true;
        for (int i = 0; i < relax->n; ++i)
            way[i] = side ? -first[i] : first[i];
        for (int k = 0; k < WALK && good; ++k) {
            for (int i = 0; i < STRIDES && good; ++i)
                good = walk(relax, place, way);
            if (good)
                memcpy(relax->place + relax->bodies * relax->configurations++, place, size);
        }
    }
}

/* ---- the mechanism --------------------------------------------------------------------------------------- */

static void to_model(const Model *model, int body, const double x[3], bool point, double out[3])
{
    memcpy(out, x, 3 * sizeof *out);
    if (body == BODY_GROUND)
        return;
    double A[9];
    mat_from_euler(model->body[body].euler, A);
    mat_apply(A, x, out);
    for (int i = 0; point && i < 3; ++i)
        out[i] += model->body[body].position[i];
}

static Link link_new(const Model *model, const int *local, const int body[2], const double point[2][3],
                     const double axis0[3], const double axis1[3])
{
    Link link = {.body = {0}};
    for (int end = 0; end < 2; ++end) {
        link.owner[end] = body[end];
        link.body[end] = body[end] == BODY_GROUND ? -1 : local[body[end]];
        to_model(model, body[end], point[end], true, link.point[end]);
    }
    to_model(model, body[0], axis0, false, link.axis[0]);
    to_model(model, axis1 == axis0 ? body[0] : body[1], axis1, false, link.axis[1]);
    return link;
}

static Link link_of(const Model *model, const int *local, int edge)
{
    static const double z[3] = {0, 0, 1};
    if (edge < model->joints) {
        const Joint *j = &model->joint[edge];
        const bool plain = vec_norm(j->axis[0]) < 0.5;
        Link link = link_new(model, local, j->body, j->point, plain ? z : j->axis[0],
                             plain || vec_norm(j->axis[1]) < 0.5 ? (plain ? z : j->axis[0]) : j->axis[1]);
        link.type = j->type;
        link.length = j->length;
        link.offset = j->offset;
        return link;
    }
    const Coordinate *c = &model->coordinate[edge - model->joints];
    const double *axis = vec_norm(c->axis) < 0.5 ? z : c->axis;
    Link link = link_new(model, local, c->body, c->point, axis, axis);
    link.coordinate = true;
    link.kind = c->type;
    return link;
}

static bool make_links(Relax *relax, const bool *body, const bool *edge)
{
    const Model *model = relax->model;
    int local[model->bodies + 1], count = 0;
    for (int i = 0; i < model->bodies; ++i)
        local[i] = body[i] ? relax->bodies++ : -1;
    for (int i = 0; i < model->joints + model->coordinates; ++i)
        count += edge[i];
    relax->n = BODY_TWIST * relax->bodies;
    relax->index = pool_alloc(relax->pool, (size_t)(count + 1) * sizeof *relax->index);
    relax->link = pool_alloc(relax->pool, (size_t)(count + 8) * sizeof *relax->link);
    for (int i = 0, k = 0; i < model->joints + model->coordinates; ++i)
        if (edge[i]) {
            if (i < model->joints && !model->joint[i].drawn)
                return false;
            relax->index[k] = i;
            relax->link[k++] = link_of(model, local, i);
            ++*(i < model->joints ? &relax->joints : &relax->coordinates);
        }
    for (int i = 0; i < relax->joints; ++i)
        for (int k = 0; k < 3; ++k)
            relax->centre[k] += relax->link[i].point[1][k] / relax->joints;
    for (int i = 0; i < relax->joints; ++i)
        for (int k = 0; k < 3; ++k)
            relax->size = fmax(relax->size, fabs(relax->link[i].point[1][k] - relax->centre[k]));
    if (!(relax->size > 1e-9))
        relax->size = 1;
    const size_t rows = (size_t)(ROWS_MOST * (count + 2)), n = (size_t)relax->n;
    relax->gone = pool_alloc(relax->pool, (size_t)relax->joints + 1);
    relax->changed = pool_alloc(relax->pool, (size_t)relax->joints + 1);
    relax->A = pool_alloc(relax->pool, rows * n * sizeof(double));
    relax->N = pool_alloc(relax->pool, n * n * sizeof(double));
    relax->b = pool_alloc(relax->pool, n * sizeof(double));
    return relax->joints > 0;
}

/* ---- candidates ------------------------------------------------------------------------------------------ */

static void add_direction(double (*direction)[3], int *count, const double way[3])
{
    const double norm = vec_norm(way);
    if (!(norm > 1e-9) || *count == DIRECTIONS)
        return;
    for (int i = 0; i < *count; ++i) {
        double cross[3];
        vec_cross(direction[i], way, cross);
        if (vec_norm(cross) < 1e-6 * norm)
            return;
    }
    int first = 0;
    while (fabs(way[first]) < 1e-6 * norm)
        ++first;
    for (int i = 0; i < 3; ++i)
        direction[*count][i] = way[i] / (way[first] < 0 ? -norm : norm);
    ++*count;
}

/* Directions that an axis at a joint may have: its own, along the model's axes, to other joints, along theirs. */
static int directions(const Relax *relax, const Link *link, double (*direction)[3])
{
    int count = 0;
    if (!link->coordinate && has(link->type, "acdehijkl"))
        for (int end = 0; end < 2; ++end)
            add_direction(direction, &count, link->axis[end]);
    for (int i = 0; i < relax->joints; ++i) { /* the line from one ball joint to the other that hold the same body */
        const Link *other = &relax->link[i];
        if (other == link || other->type != JOINT_SPHERICAL || link->type != JOINT_SPHERICAL)
            continue;
        const double way[3] = {link->point[0][0] - other->point[0][0], link->point[0][1] - other->point[0][1],
                               link->point[0][2] - other->point[0][2]};
        add_direction(direction, &count, way);
    }
    for (int i = 0; i < relax->joints; ++i)
        if (has(relax->link[i].type, "acd"))
            add_direction(direction, &count, relax->link[i].axis[0]);
    for (int i = 0; i < 3; ++i) {
        double e[3] = {0};
        e[i] = 1;
        add_direction(direction, &count, e);
    }
    return count;
}

/* Do the rows of `other` say only what the joints say already? Then it holds nothing that they don't; where motions are
 * to be freed, whatever it says is good. */
static bool implied(const Relax *relax, const Link *other, const int *rank)
{
    double least;
    for (int c = 0; c < relax->configurations && relax->counted == relax->joints; ++c)
        if (rank_at(relax, c, relax->joints, -1, other, &least) != rank[c])
            return false;
    return true;
}

/* How far from singular the rows stay with `other` in place of link `without`, where they must have rank[]; 0: not
 * everywhere. */
static double quality(const Relax *relax, int count, int without, const Link *other, const int *rank)
{
    double worst = 1, least;
    for (int c = 0; c < relax->configurations; ++c) {
        if (rank_at(relax, c, count, without, other, &least) != rank[c])
            return 0;
        worst = fmin(worst, least);
    }
    return worst;
}

static void take_better(Link *best, double *best_quality, const Link *candidate, double its_quality, double factor)
{
    if (its_quality > factor * *best_quality) {
        *best = *candidate;
        *best_quality = its_quality;
    }
}

/* The best type with `needed` equations in place of joint k; false: there is none. */
static bool replace(Relax *relax, int k, int needed, const int *rank)
{
    static const JointType order[] = {JOINT_POINT_ON_LINE, JOINT_SPHERICAL,      JOINT_CYLINDRICAL, JOINT_UNIVERSAL,
                                      JOINT_REVOLUTE,      JOINT_POINT_IN_PLANE, JOINT_PARALLEL,    JOINT_PERPENDICULAR,
                                      JOINT_PRISMATIC};
    const Link *own = &relax->link[k];
    double direction[DIRECTIONS][3], best_quality = 0;
    const int count = directions(relax, own, direction);
    const bool placed = has(own->type, "abcdefij");
    Link best = *own;
    for (size_t t = 0; t < sizeof order / sizeof *order; ++t) {
        if (joint_equations[order[t]] != needed || (!placed && !has(order[t], "kl")))
            continue;
        const bool two = has(order[t], "el"), any = order[t] != JOINT_SPHERICAL;
        for (int i = 0; i < (any ? count : 1); ++i)
            for (int j = 0; j < (two ? count : 1); ++j) {
                Link candidate = *own;
                candidate.type = order[t];
                memcpy(candidate.axis[0], direction[i], sizeof direction[i]);
                memcpy(candidate.axis[1], direction[two ? j : i], sizeof direction[i]);
                if ((two && fabs(vec_dot(direction[i], direction[j])) > 1e-9) || !implied(relax, &candidate, rank))
                    continue;
                take_better(&best, &best_quality, &candidate, quality(relax, relax->counted, k, &candidate, rank),
                            clearly_better);
            }
    }
    if (!(best_quality > 0))
        return false;
    relax->link[k] = best;
    return true;
}

static int equations_left(const Relax *relax)
{
    int rows = 0;
    for (int i = 0; i < relax->joints; ++i)
        rows += relax->gone[i] ? 0 : joint_equations[relax->link[i].type];
    return rows;
}

/* Equations of joint k that the others don't say already, the most over all configurations. */
static int needed_of(const Relax *relax, int k, const int *rank)
{
    int needed = 0;
    double least;
    for (int c = 0; c < relax->configurations; ++c) {
        const int missing = rank[c] - rank_at(relax, c, relax->counted, k, NULL, &least);
        needed = missing > needed ? missing : needed;
    }
    return needed;
}

/* Is joint k rather the one to change than the best so far, which gives up as much? One of a single equation is likely to
 * be misplaced; else one that stays is better than one that goes. */
static bool preferred(const Relax *relax, int k, int needed, int best, int best_needed)
{
    if (joint_equations[relax->link[best].type] == 1 || relax->counted > relax->joints)
        return false;
    return joint_equations[relax->link[k].type] == 1 || (!best_needed && needed);
}

/* The joint that can give up most, the last of those. */
static bool relax_once(Relax *relax, const int *rank)
{
    bool tried[relax->joints + 1];
    memset(tried, 0, sizeof tried);
    for (;;) {
        int best = -1, best_drop = 0, best_needed = 0;
        for (int k = relax->joints - 1; k >= 0; --k) {
            if (tried[k] || relax->gone[k])
                continue;
            const int needed = needed_of(relax, k, rank), drop = joint_equations[relax->link[k].type] - needed;
            if (drop > best_drop || (drop && drop == best_drop && preferred(relax, k, needed, best, best_needed)))
                best = k, best_drop = drop, best_needed = needed;
        }
        if (best < 0)
            return false;
        relax->gone[best] = !best_needed;
        if (!best_needed || replace(relax, best, best_needed, rank))
            return relax->changed[best] = true;
        tried[best] = true;
    }
}

/* ---- coordinates ----------------------------------------------------------------------------------------- */

/* A coordinate that determines one motion more than the rows before it do; false: none is found. */
static bool find_coordinate(const Relax *relax, int count, const int *rank, Link *found)
{
    int wanted[relax->configurations];
    double best_quality = 0;
    for (int c = 0; c < relax->configurations; ++c)
        wanted[c] = rank[c] + 1;
    for (int k = 0; k < relax->joints; ++k) {
        const Link *joint = &relax->link[k];
        double direction[DIRECTIONS][3];
        const int ways = directions(relax, joint, direction);
        for (int kind = 0; kind < 2; ++kind)
            for (int i = 0; i < ways; ++i) {
                Link candidate = *joint;
                candidate.coordinate = true;
                candidate.kind = kind ? COORDINATE_TRANSLATION : COORDINATE_ANGLE;
                memcpy(candidate.axis[0], direction[i], sizeof direction[i]);
                memcpy(candidate.axis[1], direction[i], sizeof direction[i]);
                /* an angle is meant for bodies whose joint keeps its axis */
                const bool fits = kind ? has(joint->type, "cd") && i == 0 : !has(joint->type, "ad") || i == 0;
                if (fits)
                    take_better(found, &best_quality, &candidate, quality(relax, count, -1, &candidate, wanted), better);
            }
    }
    return best_quality > 0;
}

/* ---- text ------------------------------------------------------------------------------------------------ */

static double tidy(double x)
{
    return fabs(x) < 1e-9 ? 0 : x;
}

static void print_vector(Text *text, const char *key, const double x[3])
{
    text_print(text, "%s[%.9g, %.9g, %.9g]", key, tidy(x[0]), tidy(x[1]), tidy(x[2]));
}

/* Axes of the model frame are written as they are drawn, others with whole components where these are small. */
static void print_axis(Text *text, const char *key, const double axis[3])
{
    double least = 1, whole[3];
    for (int i = 0; i < 3; ++i)
        if (fabs(axis[i]) > 1e-6)
            least = fmin(least, fabs(axis[i]));
    for (int i = 0; i < 3; ++i) {
        whole[i] = axis[i] / least;
        if (fabs(whole[i] - nearbyint(whole[i])) > 1e-9 || fabs(whole[i]) > 9) {
            print_vector(text, key, axis);
            return;
        }
        whole[i] = nearbyint(whole[i]);
    }
    print_vector(text, key, whole);
}

static const char *body_name(const Model *model, int body)
{
    return body == BODY_GROUND ? "ground" : model->body[body].name;
}

static void print_entry(const Relax *relax, const Link *link, const char *name, Text *text)
{
    const char *type = !link->coordinate                  ? joint_type_name[link->type]
                       : link->kind == COORDINATE_ANGLE ? "angle"
                                                        : "translation";
    text_print(text, "`%s: {type: %s, bodies: [%s, %s]", name, type, body_name(relax->model, link->owner[0]),
               body_name(relax->model, link->owner[1]));
    if (!link->coordinate && has(link->type, "abdefij"))
        print_vector(text, ", point: ", link->point[1]);
    if (link->coordinate || has(link->type, "acdijk"))
        print_axis(text, ", axis: ", link->axis[0]);
    if (!link->coordinate && has(link->type, "el")) {
        print_axis(text, ", axes: [", link->axis[0]);
        print_axis(text, ", ", link->axis[1]);
        text_print(text, "]");
    }
    text_print(text, "}`");
}

static void print_joint(const Relax *relax, int k, Text *text)
{
    const Joint *joint = &relax->model->joint[relax->index[k]];
    text_print(text, "%s", text->size                          ? ", "
                           : relax->counted == relax->joints ? ""
                                                             : "the joints leave no motion for a coordinate: ");
    if (relax->gone[k]) {
        text_print(text, "remove joint '%s' (%s, %d)%s", joint->name, joint_type_name[joint->type],
                   joint_equations[joint->type],
                   relax->counted == relax->joints ? ": the others say all that it says" : "");
        return;
    }
    text_print(text, "make joint '%s' (%s, %d) a %s (%d): ", joint->name, joint_type_name[joint->type],
               joint_equations[joint->type], joint_type_name[relax->link[k].type],
               joint_equations[relax->link[k].type]);
    print_entry(relax, &relax->link[k], joint->name, text);
}

/* Coordinates that determine nothing new go, or change; motions that none determines get one. */
static bool settle_coordinates(Relax *relax, int *rank, Text *text, Place *at)
{
    const Model *model = relax->model;
    int count = relax->joints, spare[relax->coordinates + 1], spares = 0, added = 0;
    for (int k = 0; k < relax->coordinates; ++k) {
        relax->link[count] = relax->link[relax->joints + k];
        int grown[relax->configurations];
        double least;
        bool good = true;
        for (int c = 0; c < relax->configurations; ++c) {
            grown[c] = rank_at(relax, c, count + 1, -1, NULL, &least);
            good = good && (c || grown[c] > rank[c]); /* further on it may well end */
        }
        if (!good) {
            spare[spares++] = relax->index[relax->joints + k] - model->joints;
            continue;
        }
        for (int c = 0; c < relax->configurations; ++c)
            rank[c] = rank[c] + 1;
        ++count;
        if (grown[relax->configurations - 1] != rank[relax->configurations - 1])
            relax->configurations = 1; /* singular somewhere on the way: only the design is compared */
    }
    for (; rank[0] < relax->n; ++added) {
        Link found;
        if (!find_coordinate(relax, count, rank, &found))
            return false;
        relax->link[count++] = found;
        for (int c = 0; c < relax->configurations; ++c)
            ++rank[c];
        const char *name = added < spares ? model->coordinate[spare[added]].name : pool_print(relax->pool, "added%d", added + 1);
        text_print(text, "%s%s coordinate '%s': ", text->size ? ", " : "", added < spares ? "change" : "add", name);
        print_entry(relax, &found, name, text);
        if (!at->source && added < spares)
            *at = model->coordinate[spare[added]].at;
    }
    for (int i = added; i < spares; ++i) {
        text_print(text, "%sremove dual coordinate '%s'%s", text->size ? ", " : "", model->coordinate[spare[i]].name,
                   count == relax->joints ? ": the joints leave no motion for it" : "");
        if (!at->source)
            *at = model->coordinate[spare[i]].at;
    }
    return true;
}

const char *relax_suggest(Pool *pool, const Model *model, const bool *body, const bool *edge, bool joints_stay,
                          Place *at)
{
    Relax relax = {.pool = pool, .model = model};
    Text text = {.pool = pool};
    int bodies = 0;
    double least;
    for (int i = 0; i < model->bodies; ++i)
        bodies += body[i];
    if (bodies > BODIES_MOST || !make_links(&relax, body, edge))
        return NULL;
    find_configurations(&relax);
    int rank[2 * WALK + 1];
    for (int c = 0; c < relax.configurations; ++c)
        rank[c] = rank_at(&relax, c, relax.joints, -1, NULL, &least);
    relax.counted = relax.joints;
    if (rank[0] == relax.n && relax.coordinates) { /* the joints leave no motion: one of them is stronger than was meant */
        relax.counted += relax.coordinates;
        relax.configurations = 1;
    }
    while (equations_left(&relax) + relax.counted - relax.joints > rank[0])
        if (joints_stay || !relax_once(&relax, rank))
            return NULL;
    Place place = {0};
    for (int k = 0; k < relax.joints; ++k)
        if (relax.changed[k]) {
            if (!place.source)
                place = model->joint[relax.index[k]].at;
            print_joint(&relax, k, &text);
        }
    if ((relax.counted == relax.joints && !settle_coordinates(&relax, rank, &text, &place)) || !text.size)
        return NULL;
    *at = place;
    return text.s;
}
