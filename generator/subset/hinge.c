/* SPDX-License-Identifier: MIT
 * Angles about the axis of a hinge. The derivative of such an angle is the relative angular velocity along the
 * axis, at any angle: constant coefficients in the frame of a body in which the axis is constant. */
#include "expression/expression.h"
#include "model/model.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

/* A joint that keeps the axis of an angle parallel in both of its bodies. */
typedef struct Hinge {
    const Connection *tie; /* NULL: there is none */
    int first;             /* end of the joint that is at the angle's first body */
    Ex sign;               /* 1 or -1 for each member: the joint's axis times this is the angle's axis */
} Hinge;

static bool same_bodies(const Connection *a, const Connection *b, int first)
{
    return !memcmp(&a->end[0], &b->end[first], sizeof a->end[0]) &&
           !memcmp(&a->end[1], &b->end[1 - first], sizeof a->end[1]);
}

/* 1 or -1 if b is a or -a, 0 otherwise; a number for each member if axes are constants of members, as of mirrored ones.
 */
static Ex common_sign(const Work *w, const Ex a[3], const Ex b[3])
{
    Dag *dag = w->dag;
    double sign[w->class->members];
    Ex opposite[3];
    ex_scale3(dag, ex_literal(dag, -1), a, opposite);
    if (!memcmp(a, b, sizeof opposite))
        return ex_literal(dag, 1);
    if (!memcmp(opposite, b, sizeof opposite))
        return ex_literal(dag, -1);
    for (int m = 0; m < w->class->members; ++m) {
        bool same = true, other = true;
        for (int i = 0; i < 3; ++i) {
            const double x = ex_value(dag, a[i], m * w->configurations), y = ex_value(dag, b[i], m * w->configurations);
            const bool constant = dag->node[a[i]].level < LEVEL_VARIABLE && dag->node[b[i]].level < LEVEL_VARIABLE;
            same = same && constant && x == y;
            other = other && constant && x == -y;
        }
        if (!same && !other)
            return 0;
        sign[m] = same ? 1 : -1;
    }
    const Ex e = ex_constant(dag, sign);
    ex_describe(w->dag, e, "sign");
    return e;
}

static Hinge hinge_of(const Work *w, const Connection *angle)
{
    if (angle->measure != COORDINATE_ANGLE)
        return (Hinge){.tie = NULL};
    for (int i = 0; i < w->connections; ++i) {
        const Connection *tie = &w->connection[i];
        if (tie->is_coordinate || !(joint_parts[w->model->joint[tie->index].type] & PART_PARALLEL))
            continue;
        for (int first = 0; first < 2; ++first) {
            const Ex sign =
                same_bodies(angle, tie, first) ? common_sign(w, tie->fixture.axis[first], angle->fixture.axis[0]) : 0;
            if (sign)
                return (Hinge){tie, first, sign};
        }
    }
    return (Hinge){.tie = NULL};
}

bool subset_hinge_axis(const Work *w, const Connection *angle, int end, Ex axis[3])
{
    const Hinge hinge = hinge_of(w, angle);
    if (hinge.tie)
        ex_scale3(w->dag, hinge.sign, hinge.tie->fixture.axis[end ? 1 - hinge.first : hinge.first], axis);
    return hinge.tie != NULL;
}

bool subset_is_hinged(const Work *w, const Connection *angle)
{
    Ex axis[3];
    return subset_hinge_axis(w, angle, 0, axis);
}

void subset_hinge_row(const Work *w, const Connection *angle, const Motion *const end[2], Row *row)
{
    /* in the frame of the body solved before, where the axis may be constant */
    const int at = angle->end[0].unknown < 0 ? 0 : 1;
    Ex axis[3];
    if (!subset_hinge_axis(w, angle, at, axis))
        return;
    const Vector n = vector_axis(w->dag, end[at], axis);
    Row turn = {.value = row->value, .guard = row->guard, .dual = ex_literal(w->dag, -1)};
    memcpy(turn.J[1], n.v, sizeof n.v);
    ex_scale3(w->dag, ex_literal(w->dag, -1), n.v, turn.J[0]);
    /* the axis turns across itself: only the acceleration of bodies solved before remains */
    Ex alpha[3];
    ex_sub3(w->dag, end[1]->alpha, end[0]->alpha, alpha);
    turn.bias = ex_dot(w->dag, n.v, alpha);
    *row = turn;
}
