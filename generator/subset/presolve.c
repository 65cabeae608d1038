/* SPDX-License-Identifier: MIT
 * Parts of the poses that joints to known bodies determine directly: reference points, axes of hinges, rotations of
 * bodies that do not turn. Newton's iteration starts from them: their residuals are zero, and derivatives are taken
 * there. Elements of J that become 0 or constant, and results of them, are not computed. */
#include "expression/expression.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

/* The end of a joint that is at an unknown body and whose other end is known; -1: none. */
static int held_end(const Connection *tie)
{
    if (tie->is_coordinate || (tie->end[0].unknown >= 0) == (tie->end[1].unknown >= 0))
        return -1;
    return tie->end[0].unknown >= 0 ? 0 : 1;
}

static int parts_of(const Work *w, const Connection *tie)
{
    return joint_parts[w->model->joint[tie->index].type];
}

static bool holds_point(const Work *w, const Connection *tie, int end)
{
    static const Ex zero[3];
    return parts_of(w, tie) & PART_POINT && !memcmp(tie->fixture.point[end], zero, sizeof zero);
}

static bool holds_rotation(const Work *w, const Connection *tie)
{
    return parts_of(w, tie) & PART_LOCK;
}

/* The component of a unit vector that is 1 or -1; -1: none. */
static int along_axis(const Dag *dag, const Ex u[3])
{
    for (int i = 0; i < 3; ++i)
        if ((ex_is(dag, u[i], 1) || ex_is(dag, u[i], -1)) && ex_is(dag, u[(i + 1) % 3], 0) &&
            ex_is(dag, u[(i + 2) % 3], 0))
            return i;
    return -1;
}

/* A body-fixed direction u is along v. If both are axes of their frames, a row and a column of A are known. */
static void hold_direction(Dag *dag, Motion *pose, const Ex u[3], const Ex v[3])
{
    const int column = along_axis(dag, u), row = along_axis(dag, v);
    motion_image(dag, pose, u, v);
    if (column < 0 || row < 0)
        return;
    for (int i = 0; i < 3; ++i)
        pose->A[3 * i + column] = pose->A[3 * row + i] = 0;
    pose->A[3 * row + column] = ex_mul(dag, u[column], v[row]);
}

static void hold_rotation(Dag *dag, Motion *pose, const Fixture *fixture, int end, const Motion *other)
{
    const Ex *own[3] = {fixture->axis[end], fixture->side[0][end], fixture->side[1][end]};
    const Ex *theirs[3] = {fixture->axis[1 - end], fixture->side[0][1 - end], fixture->side[1][1 - end]};
    Vector known[3];
    for (int i = 0; i < 3; ++i)
        known[i] = vector_axis(dag, other, theirs[i]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            pose->A[3 * i + j] = ex_dot(dag, (Ex[]){known[0].v[i], known[1].v[i], known[2].v[i]},
                                        (Ex[]){own[0][j], own[1][j], own[2][j]});
}

void subset_presolve(Work *w, Motion *pose, bool directions)
{
    for (int i = 0; i < w->connections; ++i) {
        const Connection *tie = &w->connection[i];
        const int end = held_end(tie);
        if (end < 0)
            continue;
        const int body = tie->end[end].unknown;
        const Motion *other = subset_motion(w, pose, tie->end[1 - end]);
        const Fixture *fixture = &tie->fixture;
        if (holds_point(w, tie, end)) {
            const Vector point = vector_point(w->dag, other, fixture->point[1 - end]);
            memcpy(pose[body].c, point.v, sizeof pose[body].c);
        }
        if (holds_rotation(w, tie)) {
            hold_rotation(w->dag, &pose[body], fixture, end, other);
        } else if (directions && parts_of(w, tie) & PART_PARALLEL) {
            const Vector axis = vector_axis(w->dag, other, fixture->axis[1 - end]);
            hold_direction(w->dag, &pose[body], fixture->axis[end], axis.v);
        }
    }
}

bool subset_presolves_point(const Work *w, int body)
{
    bool held = false;
    for (int i = 0; i < w->connections; ++i) {
        const int end = held_end(&w->connection[i]);
        held =
            held || (end >= 0 && w->connection[i].end[end].unknown == body && holds_point(w, &w->connection[i], end));
    }
    return held;
}

bool subset_presolves_rotation(const Work *w, int body)
{
    bool held = false;
    for (int i = 0; i < w->connections; ++i) {
        const int end = held_end(&w->connection[i]);
        held = held || (end >= 0 && w->connection[i].end[end].unknown == body && holds_rotation(w, &w->connection[i]));
    }
    return held;
}

void subset_drop_presolved(const Work *w, Row *row, const int *row_of)
{
    for (int r = 0, first = 0; r < w->n; ++r) {
        const Connection *tie = &w->connection[row_of[r]];
        const int end = held_end(tie);
        if (r && row_of[r] != row_of[r - 1])
            first = r;
        if (end < 0)
            continue;
        /* the order of joint_rows(): point, parallel, lock */
        const int point = parts_of(w, tie) & PART_POINT ? 3 : 0;
        const bool held = r - first < point                                 ? holds_point(w, tie, end)
                          : r - first < point + 3 && holds_rotation(w, tie) ? true
                                                                            : false;
        if (held)
            row[r].value = row[r].guard = 0;
    }
}
