/* SPDX-License-Identifier: MIT
 * Chained sequences: a subset that one body carries is described relative to that body, by its own coordinates.
 * Accelerations of its bodies get the contribution of the carrier, and their wrenches are added to the carrier's. */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "vehicle/vehicle.h"

static Ex magnitude(Dag *dag, Ex e)
{
    return ex_op(dag, OP_ABS, e, 0, 0);
}

Ex whole_magnitude3(Whole *whole, const Ex v[3])
{
    Dag *dag = whole->dag;
    return ex_add(dag, magnitude(dag, v[0]), ex_add(dag, magnitude(dag, v[1]), magnitude(dag, v[2])));
}

int whole_carrier(const Whole *whole, int body)
{
    return body <= BODY_BASE ? BODY_BASE : whole_subset(whole, body)->carrier;
}

/* Accelerations of a body by its own coordinates and by its carrier. */
static void carry_body(Whole *whole, int b, const Ex *w2)
{
    Dag *dag = whole->dag;
    const Subset *subset = whole_subset(whole, b);
    Ex *out = whole->carried[b], *size = whole->carried_size[b];
    for (int j = 0; j < subset->deps; ++j) {
        const Ex *S = whole->motion[b].S + 6 * j, rate = w2[subset->dep[j]];
        for (int i = 0; i < 6; ++i)
            out[i] = ex_add(dag, out[i], ex_mul(dag, rate, S[i]));
        for (int part = 0; whole->sized && part < 2; ++part)
            size[part] =
                ex_add(dag, size[part], ex_mul(dag, magnitude(dag, rate), whole_magnitude3(whole, S + 3 * part)));
    }
    whole_carry(whole, b, w2, whole->motion[b].c, out, out + 3);
    if (whole->sized)
        whole_carry_size(whole, b, w2, whole->motion[b].c, &size[0], &size[1]);
}

/* All bodies once; carriers come first in computational order. */
static void carry_all(Whole *whole, const Ex *w2)
{
    const Sequence *sequence = whole->plan->sequence;
    const size_t bodies = (size_t)whole->model->bodies;
    if (whole->carried_by == w2)
        return;
    whole->carried_by = w2;
    whole->carried = pool_alloc(whole->dag->pool, bodies * sizeof *whole->carried);
    whole->carried_size = pool_alloc(whole->dag->pool, bodies * sizeof *whole->carried_size);
    for (int s = 0; s < sequence->subsets; ++s)
        for (int b = 0; sequence->subset[s].class >= 0 && b < sequence->subset[s].bodies; ++b)
            carry_body(whole, sequence->subset[s].body[b], w2);
}

void whole_carry(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex angular[3], Ex linear[3])
{
    Dag *dag = whole->dag;
    const int carrier = whole_carrier(whole, body);
    Ex arm[3], t[3];
    if (carrier == BODY_BASE)
        return;
    carry_all(whole, w2);
    const Ex *own = whole->carried[carrier];
    ex_sub3(dag, at, whole->motion[carrier].c, arm);
    ex_cross(dag, own, arm, t);
    ex_add3(dag, linear, t, linear);
    ex_add3(dag, linear, own + 3, linear);
    ex_add3(dag, angular, own, angular);
}

void whole_carry_size(Whole *whole, int body, const Ex *w2, const Ex at[3], Ex *angular, Ex *linear)
{
    Dag *dag = whole->dag;
    const int carrier = whole_carrier(whole, body);
    Ex arm[3];
    if (carrier == BODY_BASE)
        return;
    carry_all(whole, w2);
    const Ex *own = whole->carried_size[carrier];
    ex_sub3(dag, at, whole->motion[carrier].c, arm);
    *linear = ex_add(dag, *linear, ex_add(dag, own[1], ex_mul(dag, own[0], whole_magnitude3(whole, arm))));
    *angular = ex_add(dag, *angular, own[0]);
}

void whole_hand_on(Whole *whole, const Ex (*wrench)[6], Ex *along)
{
    Dag *dag = whole->dag;
    const Sequence *sequence = whole->plan->sequence;
    Ex(*taken)[6] = pool_alloc(dag->pool, (size_t)whole->model->bodies * sizeof *taken);
    for (int s = sequence->subsets - 1; s >= 0 && sequence->chained; --s) {
        const Subset *subset = &sequence->subset[s];
        for (int i = 0; subset->class >= 0 && i < subset->bodies; ++i) {
            const int b = subset->body[i], carrier = subset->carrier;
            const Ex *own = taken[b];
            Ex arm[3], t[3];
            for (int j = 0; j < subset->deps; ++j) {
                const Ex *S = whole->motion[b].S + 6 * j;
                Ex *w = &along[subset->dep[j]];
                *w = ex_add(dag, *w, ex_add(dag, ex_dot(dag, own, S), ex_dot(dag, own + 3, S + 3)));
            }
            if (carrier == BODY_BASE)
                continue;
            ex_add3(dag, taken[b], wrench[b], taken[b]);
            ex_add3(dag, taken[b] + 3, wrench[b] + 3, taken[b] + 3);
            ex_sub3(dag, whole->motion[b].c, whole->motion[carrier].c, arm);
            ex_cross(dag, arm, own + 3, t);
            ex_add3(dag, taken[carrier], t, taken[carrier]);
            ex_add3(dag, taken[carrier], own, taken[carrier]);
            ex_add3(dag, taken[carrier] + 3, own + 3, taken[carrier] + 3);
        }
    }
}

void whole_hand_size_on(Whole *whole, const Ex (*size)[2], Ex *along)
{
    Dag *dag = whole->dag;
    const Sequence *sequence = whole->plan->sequence;
    Ex(*taken)[2] = pool_alloc(dag->pool, (size_t)whole->model->bodies * sizeof *taken);
    for (int s = sequence->subsets - 1; s >= 0 && sequence->chained; --s) {
        const Subset *subset = &sequence->subset[s];
        for (int i = 0; subset->class >= 0 && i < subset->bodies; ++i) {
            const int b = subset->body[i], carrier = subset->carrier;
            Ex arm[3], *onto = taken[carrier];
            for (int j = 0; j < subset->deps; ++j)
                for (int part = 0; part < 2; ++part) {
                    const Ex unit = whole_magnitude3(whole, whole->motion[b].S + 6 * j + 3 * part);
                    Ex *w = &along[subset->dep[j]];
                    *w = ex_add(dag, *w, ex_mul(dag, taken[b][part], unit));
                }
            if (carrier == BODY_BASE)
                continue;
            ex_sub3(dag, whole->motion[b].c, whole->motion[carrier].c, arm);
            const Ex moment = ex_add(dag, taken[b][0], size[b][0]), force = ex_add(dag, taken[b][1], size[b][1]);
            onto[0] = ex_add(dag, onto[0], ex_add(dag, moment, ex_mul(dag, force, whole_magnitude3(whole, arm))));
            onto[1] = ex_add(dag, onto[1], force);
        }
    }
}
