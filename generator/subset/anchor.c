/* SPDX-License-Identifier: MIT
 * The frame in which a subset is solved. If one body alone carries a subset, the subset is solved relative to that
 * carrier: there joints have constant axes, and only the subset's own coordinates move its bodies. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

/* Velocity or acceleration of a point of a carrying body: from that of its reference point, `linear`, its angular one,
 * and the arm to the point. */
static void carried(Dag *dag, const Ex angular[3], const Ex linear[3], const Ex arm[3], Ex out[3])
{
    ex_cross(dag, angular, arm, out);
    ex_add3(dag, linear, out, out);
}

void motion_compose(Dag *dag, const Motion *anchor, const Motion *relative, Motion *out)
{
    Ex arm[3], spin[3], glide[3], inner[3], more[3];
    out->images = 0;
    ex_apply(dag, anchor->A, relative->c, arm);
    ex_add3(dag, anchor->c, arm, out->c);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out->A[3 * i + j] =
                ex_dot(dag, anchor->A + 3 * i, (Ex[]){relative->A[j], relative->A[3 + j], relative->A[6 + j]});
    ex_apply(dag, anchor->A, relative->omega, spin);
    ex_add3(dag, anchor->omega, spin, out->omega);
    ex_apply(dag, anchor->A, relative->velocity, glide);
    carried(dag, anchor->omega, anchor->velocity, arm, out->velocity);
    ex_add3(dag, out->velocity, glide, out->velocity);
    /* alpha = alpha_a + omega_a x omega_r + alpha_r */
    ex_apply(dag, anchor->A, relative->alpha, out->alpha);
    ex_cross(dag, anchor->omega, spin, more);
    ex_add3(dag, out->alpha, more, out->alpha);
    ex_add3(dag, anchor->alpha, out->alpha, out->alpha);
    /* a = a_a + alpha_a x r + omega_a x (omega_a x r + 2 v_r) + a_r */
    ex_apply(dag, anchor->A, relative->acceleration, out->acceleration);
    ex_cross(dag, anchor->omega, arm, inner);
    ex_scale3(dag, ex_literal(dag, 2), glide, glide);
    ex_add3(dag, inner, glide, inner);
    ex_cross(dag, anchor->omega, inner, more);
    ex_add3(dag, out->acceleration, more, out->acceleration);
    carried(dag, anchor->alpha, anchor->acceleration, arm, more);
    ex_add3(dag, out->acceleration, more, out->acceleration);
    out->deps = relative->deps;
    out->S = pool_alloc(dag->pool, (size_t)(6 * out->deps + 1) * sizeof *out->S);
    for (int j = 0; j < out->deps; ++j) {
        Ex *S = out->S + 6 * j, *Sa = anchor->S + 6 * j;
        ex_apply(dag, anchor->A, relative->S + 6 * j, S);
        ex_add3(dag, Sa, S, S);
        ex_apply(dag, anchor->A, relative->S + 6 * j + 3, S + 3);
        carried(dag, Sa, Sa + 3, arm, more);
        ex_add3(dag, more, S + 3, S + 3);
    }
}

void subset_to_base(const Work *w, const Motion *relative, Motion *out)
{
    for (int b = 0; b < w->first->bodies; ++b)
        if (w->anchored)
            motion_compose(w->dag, &w->known[0], &relative[b], &out[b]);
        else
            out[b] = relative[b];
}

/* The anchor's pose (c, A) at a sample; false: the base. */
static bool anchor_pose(const Work *w, int s, double pose[12])
{
    for (int i = 0; w->anchored && i < 12; ++i)
        pose[i] = ex_value(w->dag, i < 3 ? w->known[0].c[i] : w->known[0].A[i - 3], s);
    return w->anchored;
}

void subset_pose_in_base(const Work *w, int b, int s, double pose[12])
{
    double own[12], anchor[12];
    for (int i = 0; i < 12; ++i)
        own[i] = ex_value(w->dag, i < 3 ? w->pose[b].c[i] : w->pose[b].A[i - 3], s);
    memcpy(pose, own, sizeof own);
    if (!anchor_pose(w, s, anchor))
        return;
    apply3(anchor + 3, own, pose);
    for (int i = 0; i < 3; ++i) {
        pose[i] += anchor[i];
        for (int j = 0; j < 3; ++j)
            pose[3 + 3 * i + j] = dot3(anchor + 3 + 3 * i, (double[]){own[3 + j], own[6 + j], own[9 + j]});
    }
}

void subset_twist_in_base(const Work *w, int b, int s, const double carrier[6], double twist[6])
{
    double anchor[12], own[3], arm[3], angular[3], linear[3];
    if (!anchor_pose(w, s, anchor))
        return;
    for (int i = 0; i < 3; ++i)
        own[i] = ex_value(w->dag, w->pose[b].c[i], s);
    apply3(anchor + 3, own, arm);
    apply3(anchor + 3, twist, angular);
    apply3(anchor + 3, twist + 3, linear);
    cross3(carrier, arm, twist + 3);
    for (int i = 0; i < 3; ++i) {
        twist[i] = carrier[i] + angular[i];
        twist[3 + i] += carrier[3 + i] + linear[i];
    }
}
