/* SPDX-License-Identifier: MIT
 * Follows the members of a class along their sample paths by numeric Newton iteration, so that every node of the
 * class's graph has values at admissible configurations, from which pivots are chosen. Subsets must be followed in
 * computational order. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <float.h>
#include <math.h>
#include <string.h>

void subset_set_known(Work *w, int known, int s, const double pose[12])
{
    for (int entry = 0; entry < 12; ++entry)
        ex_set_sample(w->dag, entry < 3 ? w->known[known].c[entry] : w->known[known].A[entry - 3], s, pose[entry]);
}

/* Coordinates and knowns of sample s at one step of its path; a sample that was lost stays at the design. */
static void place_sample(Work *w, const Sampling *sampling, int s, int step)
{
    int configuration = s % w->configurations;
    const Subset *member = subset_member(w, s / w->configurations);
    if (!w->alive[s])
        step = 0;
    for (int j = 0; j < w->first->deps; ++j)
        ex_set_sample(w->dag, w->x[j], s, sampling_coordinate(sampling, w->model, step, configuration, member->dep[j]));
    for (int i = 0; i < w->first->knowns; ++i)
        subset_set_known(w, i, s, sampling_pose(sampling, step, configuration, member->known[i]));
}

void subset_set_poses(Work *w, const double *q, int s)
{
    for (int i = 0; i < 7 * w->first->bodies; ++i)
        ex_set_sample(w->dag, w->q[i], s, q[i]);
}

void subset_move_pose(double q[7], const double twist[6])
{
    const double e0 = q[3], e[3] = {q[4], q[5], q[6]};
    double cross[3];
    for (int i = 0; i < 3; ++i)
        q[i] += twist[3 + i];
    cross3(twist, e, cross);
    q[3] = e0 - 0.5 * dot3(twist, e);
    for (int i = 0; i < 3; ++i)
        q[4 + i] = e[i] + 0.5 * (e0 * twist[i] + cross[i]);
    double norm = sqrt(q[3] * q[3] + dot3(q + 4, q + 4));
    for (int i = 3; i < 7; ++i)
        q[i] /= norm;
}

/* Solve J x = b at sample s; angles in x are multiplied by the subset's size, so that all of x are lengths. */
static bool solve_sample(const Work *w, int s, double *b)
{
    double A[w->n * w->n];
    for (int i = 0; i < w->n * w->n; ++i)
        A[i] = ex_value(w->dag, w->J[i], s) / (i % w->n % 6 < 3 ? w->size : 1);
    return linear_solve_numeric(w->n, A, b);
}

/* One Newton correction of q towards residuals `slack` [n] (NULL: 0); returns its relative size, infinity if the matrix
 * is singular. */
static double correct_sample(Work *w, double *q, int s, const double *slack)
{
    double b[w->n], step = 0;
    for (int r = 0; r < w->n; ++r)
        b[r] = (slack ? slack[r] : 0) - ex_value(w->dag, w->row[r].value, s);
    if (!solve_sample(w, s, b))
        return INFINITY;
    for (int j = 0; j < w->n; ++j) {
        step = fmax(step, fabs(b[j]) / w->size);
        if (j % 6 < 3)
            b[j] /= w->size;
    }
    for (int body = 0; body < w->first->bodies; ++body)
        subset_move_pose(q + 7 * body, b + 6 * body);
    return step;
}

/* True if no body turns between two poses [bodies], `to` being evaluated, and the derivatives of the equations are the
 * same at both. With the rotations fixed they change linearly with places, so they are the same between the two: there
 * the equations are linear, and one correction is the way itself, however long. */
static bool goes_straight(Work *w, const double *from, const double *to, int s)
{
    const double rounding = 1e-12;
    double J[w->n * w->n];
    for (int i = 0; i < w->connections; ++i)
        if (w->connection[i].slope) /* a formula: bodies may go a long way for a small one of its coordinates */
            return false;
    for (int i = 0; i < 7 * w->first->bodies; ++i)
        if (i % 7 >= 3 && !(fabs(to[i] - from[i]) <= rounding))
            return false;
    for (int end = 0; end < 2; ++end) {
        subset_set_poses(w, end ? to : from, s);
        dag_evaluate(w->dag, s, 1);
        for (int i = 0; i < w->n * w->n; ++i) {
            const double entry = ex_value(w->dag, w->J[i], s);
            if (end && !(fabs(entry - J[i]) <= rounding * fabs(J[i])))
                return false;
            J[i] = entry;
        }
    }
    return true;
}

/* Newton at one step of the path. */
bool subset_converge(Work *w, double *q, int s, const double *slack)
{
    const int iterations = 12;
    const double converged = 1e-12, leap = 0.5; /* a larger correction may end in another assembly mode */
    const double longest = 1e7;                 /* further away too few digits are left of places */
    double start[7 * w->first->bodies], far = 0;
    memcpy(start, q, sizeof start);
    for (int i = 0; i < iterations; ++i) {
        subset_set_poses(w, q, s);
        dag_evaluate(w->dag, s, 1);
        double step = correct_sample(w, q, s, slack);
        if (!(step < leap) && !(i == 0 && step < longest && goes_straight(w, start, q, s)))
            return false;
        for (int j = 0; j < 7 * w->first->bodies; ++j)
            far = fmax(far, fabs(q[j]) / w->size);
        if (step < fmax(converged, 8 * DBL_EPSILON * far)) /* places are rounded */
            return true;
    }
    return false;
}

/* Design poses of a member's bodies in the subset's frame, as in the model. */
static void design_poses(const Work *w, const Sampling *sampling, const Subset *member, double *q)
{
    const int anchor = w->anchored ? member->known[0] : BODY_BASE;
    for (int b = 0; b < member->bodies; ++b, q += 7)
        sampling_design(sampling, w->model, w->origin, anchor, member->body[b], q);
}

static void store_poses(Work *w, Sampling *sampling, const Subset *member, int s, int step)
{
    for (int b = 0; b < member->bodies; ++b) {
        double *pose = sampling_pose(sampling, step, s % w->configurations, member->body[b]);
        subset_pose_in_base(w, b, s, pose);
    }
}

/* The unit velocity of a known for a coordinate of the member: from `sampling`, or zeros. */
static const double *unit_velocity(const Work *w, const Sampling *sampling, const Subset *member, int known, int j,
                                   int s)
{
    static const double zero[6];
    const int body = member->known[known];
    const Subset *own = &w->sequence->subset[w->sequence->body_subset[body]];
    for (int k = 0; k < own->deps; ++k)
        if (own->dep[k] == member->dep[j])
            return sampling->S[body] + (s % w->configurations * own->deps + k) * 6;
    return zero;
}

/* S of sample s, and the largest swing of the bodies by each coordinate. */
static void store_unit_velocities(Work *w, Sampling *sampling, const Subset *member, int s)
{
    double b[w->n];
    for (int j = 0; j < member->deps; ++j) {
        for (int r = 0; r < w->n; ++r) {
            const Connection *tie = &w->connection[w->row_of[r]];
            b[r] = -subset_dual_value(w, tie, r, j, s);
            for (int end = 0; end < 2 && !w->anchored; ++end) {
                if (tie->end[end].known < 0)
                    continue;
                const double *S = unit_velocity(w, sampling, member, tie->end[end].known, j, s);
                for (int i = 0; i < 6; ++i)
                    b[r] -= ex_value(w->dag, w->row[r].J[end][i], s) * S[i];
            }
        }
        if (!solve_sample(w, s, b))
            continue;
        double *swing = &sampling->swing[member->dep[j]];
        for (int i = 0; i < w->n; ++i) {
            *swing = fmax(*swing, fabs(b[i]) / w->size);
            b[i] /= i % 6 < 3 ? w->size : 1;
        }
        for (int body = 0; body < member->bodies; ++body) {
            if (w->anchored)
                subset_twist_in_base(w, body, s, unit_velocity(w, sampling, member, 0, j, s), b + 6 * body);
            memcpy(sampling->S[member->body[body]] + (s % w->configurations * member->deps + j) * 6, b + 6 * body,
                   6 * sizeof *b);
        }
    }
}

void subset_to_design(Work *w, const Sampling *sampling, int subset, double *q)
{
    int s = subset_index(w, subset) * w->configurations;
    design_poses(w, sampling, &w->sequence->subset[subset], q);
    place_sample(w, sampling, s, 0);
    subset_set_poses(w, q, s);
    dag_evaluate(w->dag, s, 1);
}

void subset_get_poses(const Work *w, const Subset *member, int s, double (*pose)[12])
{
    for (int b = 0; b < member->bodies; ++b)
        subset_pose_in_base(w, b, s, pose[member->body[b]]);
}

double subset_determinant(const Work *w, int s)
{
    double A[w->n * w->n];
    for (int i = 0; i < w->n * w->n; ++i)
        A[i] = ex_value(w->dag, w->J[i], s) / (i % w->n % 6 < 3 ? w->size : 1);
    return linear_determinant(w->n, A);
}

void subset_follow(Work *w, Sampling *sampling, int index)
{
    const Subset *member = subset_member(w, index);
    int numbers = 7 * member->bodies;
    double design[numbers], q[numbers];
    design_poses(w, sampling, member, design);
    for (int b = 0; b < member->bodies; ++b)
        sampling->S[member->body[b]] =
            pool_alloc(w->pool, (size_t)(w->configurations * member->deps * 6 + 1) * sizeof(double));
    for (int c = 0; c < w->configurations; ++c) {
        int s = index * w->configurations + c;
        w->alive[s] = true;
        for (int i = 0; i < member->knowns; ++i)
            w->alive[s] = w->alive[s] && sampling->usable[member->known[i] * w->configurations + c];
        memcpy(q, design, sizeof q);
        for (int step = 0; step <= sampling->steps; ++step) {
            place_sample(w, sampling, s, step);
            if (step && w->alive[s] && !subset_converge(w, q, s, NULL)) {
                w->alive[s] = false;
                place_sample(w, sampling, s, step);
            }
            subset_set_poses(w, w->alive[s] ? q : design, s);
            dag_evaluate(w->dag, s, 1);
            store_poses(w, sampling, member, s, step);
        }
        store_unit_velocities(w, sampling, member, s);
        for (int b = 0; b < member->bodies; ++b)
            sampling->usable[member->body[b] * w->configurations + c] = w->alive[s];
    }
}

bool subset_assemble(Work *w, Sampling *sampling, int index, double *q)
{
    const int steps = 64;
    const Subset *member = subset_member(w, index);
    int s = index * w->configurations;
    double drawn[w->n], slack[w->n];
    design_poses(w, sampling, member, q);
    w->alive[s] = true;
    place_sample(w, sampling, s, 0);
    subset_set_poses(w, q, s);
    dag_evaluate(w->dag, s, 1);
    for (int r = 0; r < w->n; ++r)
        drawn[r] = ex_value(w->dag, w->row[r].value, s);
    for (int step = 1; step <= steps; ++step) {
        for (int r = 0; r < w->n; ++r)
            slack[r] = drawn[r] * (steps - step) / steps;
        if (!subset_converge(w, q, s, slack))
            return false;
    }
    subset_set_poses(w, q, s);
    dag_evaluate(w->dag, s, 1);
    store_poses(w, sampling, member, s, 0);
    return true;
}
