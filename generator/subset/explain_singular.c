/* SPDX-License-Identifier: MIT
 * Explains why a subset with as many equations as unknowns does not determine them: which equations repeat each
 * other, which bodies can still move, and whether everywhere or at the design configuration only. */
#include "base/message.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/rank.h"
#include "sequence/redundant.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

/* Relative size of a pivot that counts as 0. */
static const double rank_zero = 1e-9;
/* A design with this condition is nearly singular: generated code would refuse most motions from it
 * (singularity_checks.c). */
static const double worst_design = 1000;

/* J at a sample, rows scaled to 1, angles in lengths. by_columns: its transpose. */
static void scaled_jacobian(const Work *w, int sample, bool transposed, double *A)
{
    int n = w->n;
    for (int i = 0; i < n; ++i) {
        double largest = 0;
        for (int j = 0; j < n; ++j)
            largest = fmax(largest, fabs(ex_value(w->dag, w->J[n * i + j], sample)) / (j % 6 < 3 ? w->size : 1));
        for (int j = 0; j < n; ++j)
            A[transposed ? n * j + i : n * i + j] =
                ex_value(w->dag, w->J[n * i + j], sample) / (j % 6 < 3 ? w->size : 1) / (largest > 0 ? largest : 1);
    }
}

static int rank_at(const Work *w, int sample)
{
    double A[w->n * w->n];
    scaled_jacobian(w, sample, false, A);
    return matrix_rank(w->n, w->n, rank_zero, A, NULL, NULL);
}

/* Unknowns that can move while all equations hold: the null space of J, summed up [n]. Returns the rank. */
static int free_motion(const Work *w, int sample, double *motion)
{
    int n = w->n;
    double A[n * n], combination[n * n];
    scaled_jacobian(w, sample, true, A);
    int rank = matrix_rank(n, n, rank_zero, A, combination, NULL);
    memset(motion, 0, (size_t)n * sizeof *motion);
    for (int i = rank; i < n; ++i)
        for (int j = 0; j < n; ++j)
            motion[j] += combination[n * i + j];
    return rank;
}

/* Marks the rows or unknowns that take part in the vanishing combinations. */
static void involved(const Work *w, int sample, bool transposed, bool *part)
{
    int n = w->n;
    double A[n * n], combination[n * n];
    scaled_jacobian(w, sample, transposed, A);
    int rank = matrix_rank(n, n, rank_zero, A, combination, NULL);
    memset(part, 0, (size_t)n * sizeof *part);
    for (int i = rank; i < n; ++i) {
        double largest = 0;
        for (int j = 0; j < n; ++j)
            largest = fmax(largest, fabs(combination[n * i + j]));
        for (int j = 0; j < n; ++j)
            part[j] = part[j] || fabs(combination[n * i + j]) > 1e-6 * largest;
    }
}

/* Correct poses and coordinates until all equations hold: damped least squares. */
static bool reassemble(Work *w, const Subset *member, int sample, double *q, double *x)
{
    enum { ITERATIONS = 60 };
    int n = w->n;
    double N[n * n], b[n], wide[n][n + member->deps + 1];
    for (int iteration = 0; iteration < ITERATIONS; ++iteration) {
        subset_set_poses(w, q, sample);
        for (int j = 0; j < member->deps; ++j)
            ex_set_sample(w->dag, w->x[j], sample, x[j]);
        dag_evaluate(w->dag, sample, 1);
        double worst = 0;
        for (int r = 0; r < n; ++r) {
            const Connection *tie = &w->connection[w->row_of[r]];
            double largest = 0;
            for (int j = 0; j < n; ++j)
                largest = fmax(
                    largest, fabs(wide[r][j] = ex_value(w->dag, w->J[n * r + j], sample) / (j % 6 < 3 ? w->size : 1)));
            for (int j = 0; j < member->deps; ++j)
                largest = fmax(largest, fabs(wide[r][n + j] = subset_dual_value(w, tie, r, j, sample)));
            b[r] = -ex_value(w->dag, w->row[r].value, sample) / largest;
            for (int j = 0; j < n + member->deps; ++j)
                wide[r][j] /= largest;
            worst = fmax(worst, fabs(b[r]));
        }
        if (worst < 1e-11 * w->size)
            return true;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                N[n * i + j] = i == j ? 1e-11 : 0; /* keeps N regular if equations repeat each other */
                for (int l = 0; l < n + member->deps; ++l)
                    N[n * i + j] += wide[i][l] * wide[j][l];
            }
        if (!linear_solve_numeric(n, N, b))
            return false;
        double step[n + member->deps];
        for (int l = 0; l < n + member->deps; ++l) {
            step[l] = 0;
            for (int i = 0; i < n; ++i)
                step[l] += wide[i][l] * b[i];
            step[l] /= l < n && l % 6 < 3 ? w->size : 1;
        }
        for (int body = 0; body < member->bodies; ++body)
            subset_move_pose(q + 7 * body, step + 6 * body);
        for (int j = 0; j < member->deps; ++j)
            x[j] += step[n + j];
    }
    return false;
}

/* True if the subset is regular somewhere near the design, on assembled configurations. */
static bool regular_nearby(Work *w, const Sampling *sampling, int subset, int sample)
{
    static const double reach[] = {0.05, -0.05, 0.15, -0.15};
    const Subset *member = &w->sequence->subset[subset];
    double q[7 * member->bodies], x[member->deps + 1], motion[w->n];
    for (size_t i = 0; i < sizeof reach / sizeof *reach; ++i) {
        subset_to_design(w, sampling, subset, q);
        free_motion(w, sample, motion);
        double largest = 0;
        for (int j = 0; j < w->n; ++j)
            largest = fmax(largest, fabs(motion[j]));
        for (int j = 0; j < w->n; ++j)
            motion[j] *= reach[i] / largest * (j % 6 < 3 ? 1 : w->size);
        for (int body = 0; body < member->bodies; ++body)
            subset_move_pose(q + 7 * body, motion + 6 * body);
        for (int j = 0; j < member->deps; ++j)
            x[j] = w->model->coordinate[member->dep[j]].design;
        if (reassemble(w, member, sample, q, x) && rank_at(w, sample) == w->n)
            return true;
    }
    return false;
}

static void name_equations(const Work *w, const Subset *member, const bool *row, Text *out, int *joints)
{
    *joints = 0;
    for (int i = 0; i < w->connections; ++i) {
        bool any = false;
        for (int r = 0; r < w->n; ++r)
            any = any || (row[r] && w->row_of[r] == i);
        if (!any)
            continue;
        const Connection *tie = &w->connection[i];
        int place = tie->is_coordinate ? i - member->joints : i;
        text_print(out, "%s%s '%s'", out->size ? ", " : "", tie->is_coordinate ? "coordinate" : "joint",
                   tie->is_coordinate ? w->model->coordinate[member->coordinate[place]].name
                                      : w->model->joint[member->joint[place]].name);
        *joints += !tie->is_coordinate;
    }
}

/* A remedy from the screws of the subset's joints; NULL: none is found. */
static const char *suggest(const Work *w, const Subset *member, bool joints_stay, Place *at)
{
    const Model *model = w->model;
    bool body[model->bodies + 1], edge[model->joints + model->coordinates + 1];
    memset(body, 0, sizeof body);
    memset(edge, 0, sizeof edge);
    for (int i = 0; i < member->bodies; ++i)
        body[member->body[i]] = true;
    for (int i = 0; i < member->joints; ++i)
        edge[member->joint[i]] = true;
    for (int i = 0; i < member->coordinates; ++i)
        edge[model->joints + member->coordinate[i]] = true;
    return relax_suggest(w->pool, model, body, edge, joints_stay, at);
}

/* The same where a screw, rack or gear among these rows ties motions together and all joints of the model are
 * independent: then a coordinate elsewhere is no motion that the joints allow. NULL: they are not, or none is found. */
static const char *suggest_coordinates(const Work *w, const Subset *member, const bool *row, Place *at)
{
    const Model *model = w->model;
    bool body[model->bodies + 1], edge[model->joints + model->coordinates + 1];
    Place place = {0};
    bool geared = false;
    for (int r = 0; r < w->n; ++r) {
        const Connection *tie = &w->connection[w->row_of[r]];
        geared = geared || (row[r] && !tie->is_coordinate && joint_is_geared(model->joint[tie->index].type));
    }
    if (!geared || member->deps == member->coordinates)
        return NULL;
    for (int i = 0; i < model->bodies; ++i)
        body[i] = i != BODY_BASE;
    for (int i = 0; i < model->joints + model->coordinates; ++i)
        edge[i] = true;
    const char *suggested = relax_suggest(w->pool, model, body, edge, true, &place);
    if (suggested)
        *at = place;
    return suggested;
}

/* The coordinate whose error moves the bodies most: by how much, relative to the subset's size. */
static int weakest_coordinate(const Work *w, int sample, double *moves)
{
    int weakest = 0;
    *moves = 0;
    for (int r = 0; r < w->n; ++r) {
        double A[w->n * w->n], b[w->n], largest = 0;
        if (!w->connection[w->row_of[r]].is_coordinate)
            continue;
        scaled_jacobian(w, sample, false, A);
        memset(b, 0, sizeof b);
        b[r] = 1;
        if (!linear_solve_numeric(w->n, A, b))
            continue;
        for (int i = 0; i < w->n; ++i)
            largest = fmax(largest, fabs(b[i]));
        if (largest > *moves)
            *moves = largest, weakest = w->row_of[r];
    }
    return weakest;
}

/* Refuse a design that is nearly singular: positions and accelerations would have few valid digits. */
static void refuse_nearly_singular(const Work *w, const Subset *member, int sample)
{
    double moves;
    const double condition = subset_condition(w, sample);
    if (condition < worst_design)
        return;
    const int weakest = weakest_coordinate(w, sample, &moves);
    const Coordinate *coordinate =
        moves > 0 ? &w->model->coordinate[member->coordinate[weakest - member->joints]] : NULL;
    Text bodies = {.pool = w->pool};
    for (int b = 0; b < member->bodies; ++b)
        text_print(&bodies, "%s'%s'", b ? ", " : "", w->model->body[member->body[b]].name);
    diag_fail(coordinate ? coordinate->at : w->model->body[member->body[0]].at,
              "draw the mechanism in another position, or choose another coordinate",
              "the design configuration is next to a singular one: %s determines the pose of %s too poorly (condition "
              "%.0f, up to %.0f is accepted)",
              coordinate ? pool_print(w->pool, "coordinate '%s'", coordinate->name) : "what holds it", bodies.s,
              condition, worst_design);
}

void subset_explain_singular(Work *w, const Sampling *sampling, int subset)
{
    const Subset *member = &w->sequence->subset[subset];
    int sample = subset_index(w, subset) * w->configurations, joints;
    bool row[w->n], unknown[w->n];
    double q[7 * member->bodies];
    subset_to_design(w, sampling, subset, q);
    int rank = rank_at(w, sample);
    if (rank == w->n) {
        refuse_nearly_singular(w, member, sample);
        return;
    }
    involved(w, sample, false, row);
    involved(w, sample, true, unknown);
    bool design_only = regular_nearby(w, sampling, subset, sample);
    Text equations = {.pool = w->pool}, bodies = {.pool = w->pool};
    name_equations(w, member, row, &equations, &joints);
    for (int b = 0; b < member->bodies; ++b) {
        bool any = false;
        for (int j = 0; j < 6; ++j)
            any = any || unknown[6 * b + j];
        if (any)
            text_print(&bodies, "%s'%s'", bodies.size ? ", " : "", w->model->body[member->body[b]].name);
    }
    /* the joint with the fewest equations is the likeliest to be misplaced */
    int worst = -1, fewest = 0;
    for (int i = 0; i < w->connections; ++i) {
        int equations_of =
            w->connection[i].is_coordinate ? 1 : joint_equations[w->model->joint[w->connection[i].index].type];
        bool any = false;
        for (int r = 0; r < w->n; ++r)
            any = any || (row[r] && w->row_of[r] == i);
        if (any && (worst < 0 || equations_of < fewest))
            worst = i, fewest = equations_of;
    }
    const Connection *tie = &w->connection[worst];
    int place = tie->is_coordinate ? worst - member->joints : worst;
    Place at = tie->is_coordinate ? w->model->coordinate[member->coordinate[place]].at
                                  : w->model->joint[member->joint[place]].at;
    const char *suggested = suggest(w, member, design_only, &at);
    if (design_only)
        diag_fail(at,
                  suggested ? pool_print(w->pool, "%s; or draw the mechanism in another position", suggested)
                            : "draw the mechanism in another position, or move one of the points",
                  "the design configuration is singular: there, and only there, %s fix the same motion (%d of %d "
                  "equations are "
                  "independent), and the pose of %s is not determined",
                  equations.s, rank, w->n, bodies.s);
    const char *others = suggest_coordinates(w, member, row, &at);
    if (others)
        diag_fail(
            at, others,
            "with the coordinates that are chosen, %s fix the same motion twice in every configuration, while the "
            "pose of %s is not determined",
            equations.s, bodies.s);
    /* a link of one equation is more likely to be misplaced than to be of the wrong type */
    const char *place_it =
        fewest == 1 && !tie->is_coordinate ? "move its points or axes so that it acts on a free motion; or " : "";
    diag_fail(at,
              suggested ? pool_print(w->pool, "%s%s", place_it, suggested)
              : joints > 1
                  ? "move its points or axes out of line with the others; or, where these joints close a loop that "
                    "fixes a motion "
                    "twice by its kind, take one with fewer equations (spherical, cylindrical, point_on_line, distance)"
                  : "move its points or axes so that it acts on a free motion, or choose another joint or coordinate",
              "%s fix the same motion twice in every configuration (%d of %d equations are independent), while the "
              "pose of %s is not "
              "determined",
              equations.s, rank, w->n, bodies.s);
}
