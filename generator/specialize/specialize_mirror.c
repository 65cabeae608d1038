/* SPDX-License-Identifier: MIT
 * A vehicle that moves straight ahead: numbers of one side are those of the other, with the signs that a mirror gives
 * them, and what is odd is 0. */
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "specialize/specialize_private.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

double wheel_fast_sign(int i)
{
    return i == FAST_SLIP_Y ? -1 : 1;
}

double wheel_grip_sign(int i)
{
    if (i >= GRIP_TORQUE && i < GRIP_TORQUE + 3)
        return mirror_turn(i - GRIP_TORQUE);
    const bool odd = i == GRIP_FORCE + 1 || i == GRIP_TIRE + 1 || i == GRIP_TIRE + 2 || i == GRIP_TIRE + 4 ||
                     i == GRIP_TANGENT || i == GRIP_CAMBER || i == GRIP_SPEED_Y;
    return odd ? -1 : 1;
}

/* ---- which is whose image -----------------------------------------------------------------------------------------
 */

/* The subset whose image a subset is, -1: none's. */
static int image_subset(const Narrower *n, int subset)
{
    const Subset *own = &n->plan->sequence->subset[subset];
    const int leader = own->bodies ? n->mirror->body[own->body[0]] : own->body[0];
    const int other = n->plan->sequence->body_subset[leader];
    return own->class >= 0 && leader < own->body[0] && other != subset ? other : -1;
}

void narrow_give(Givens *givens, Array array, int at, int of, double sign)
{
    const Element input = element_at(array, at);
    const Given *there = givens_find(givens, input);
    if (there && there->value)
        return;
    if (at != of)
        givens_other(givens, input, element_at(array, of), sign < 0);
    else if (sign < 0)
        givens_number(givens, 0, input);
}

/* Which dependence of the leading subset goes with dependence j of a subset; -1: this one leads itself. *sign: of its
 * unit velocity. */
static int leading_dep(const Narrower *n, const Subset *subset, const Subset *leader, int j, double *sign)
{
    const int w = subset->dep[j], image = n->mirror->coordinate[w];
    *sign = n->mirror->sign[w];
    if (subset == leader && image > w)
        return -1;
    int k = 0;
    while (leader->dep[k] != image)
        ++k;
    return k;
}

/* True if the other subset depends on the images of a subset's coordinates. */
static bool deps_fit(const Narrower *n, const Subset *subset, const Subset *other)
{
    int found = 0;
    for (int j = 0; j < subset->deps; ++j)
        for (int k = 0; k < other->deps; ++k)
            found += other->dep[k] == n->mirror->coordinate[subset->dep[j]];
    return found == subset->deps && found == other->deps;
}

const char *narrow_unpaired(const Narrower *n)
{
    const Sequence *sequence = n->plan->sequence;
    for (int b = 1; b < n->model->bodies; ++b) {
        const int image = n->mirror->body[b];
        const double *own = n->plan->origin[b], *other = n->plan->origin[image];
        const char *name = n->model->body[b].name;
        const Subset *subset = &sequence->subset[sequence->body_subset[b]];
        const int first = n->mirror->body[subset->body[0]];
        if (sequence->body_subset[first] != sequence->body_subset[image] ||
            !deps_fit(n, subset, &sequence->subset[sequence->body_subset[image]]))
            return pool_print(n->pool, "body '%s' and its mirror image are solved in different ways", name);
        for (int i = 0; i < 3; ++i)
            if (other[i] != mirror_vector(i) * own[i])
                return pool_print(n->pool, "body '%s' and its mirror image have different reference points", name);
    }
    return NULL;
}

static void give_motion(Narrower *n, int body, int leader)
{
    const Sequence *sequence = n->plan->sequence;
    const Subset *own = &sequence->subset[sequence->body_subset[body]];
    const Subset *other = &sequence->subset[sequence->body_subset[leader]];
    const int at = n->plan->motion_offset[body], of = n->plan->motion_offset[leader];
    static const int vector[] = {MOTION_C, MOTION_VELOCITY, MOTION_ACCELERATION}, turn[] = {MOTION_OMEGA, MOTION_ALPHA};
    for (int i = 0; i < 9; ++i) {
        narrow_give(n->whole, ARRAY_m, at + vector[i / 3] + i % 3, of + vector[i / 3] + i % 3, mirror_vector(i % 3));
        narrow_give(n->whole, ARRAY_m, at + MOTION_A + i, of + MOTION_A + i, mirror_matrix(i));
    }
    for (int i = 0; i < 6; ++i)
        narrow_give(n->whole, ARRAY_m, at + turn[i / 3] + i % 3, of + turn[i / 3] + i % 3, mirror_turn(i % 3));
    for (int j = 0; j < own->deps; ++j) {
        double sign;
        const int k = leading_dep(n, own, other, j, &sign);
        for (int i = 0; k >= 0 && i < 6; ++i)
            narrow_give(n->whole, ARRAY_m, at + MOTION_S + 6 * j + i, of + MOTION_S + 6 * k + i,
                        sign * (i < 3 ? mirror_turn(i) : mirror_vector(i - 3)));
    }
}

static void give_inertia(Narrower *n, int subset, int leader)
{
    const Subset *own = &n->plan->sequence->subset[subset], *other = &n->plan->sequence->subset[leader];
    const int at = n->plan->inertia_offset[subset], of = n->plan->inertia_offset[leader];
    for (int i = 0; i < 3; ++i) {
        narrow_give(n->whole, ARRAY_n, at + INERTIA_FIRST + i, of + INERTIA_FIRST + i, mirror_vector(i));
        narrow_give(n->whole, ARRAY_n, at + INERTIA_FORCE + i, of + INERTIA_FORCE + i, mirror_vector(i));
        narrow_give(n->whole, ARRAY_n, at + INERTIA_MOMENT + i, of + INERTIA_MOMENT + i, mirror_turn(i));
    }
    for (int i = 0; i < 6; ++i)
        narrow_give(n->whole, ARRAY_n, at + INERTIA_SECOND + i, of + INERTIA_SECOND + i, mirror_inertia(i));
    for (int j = 0; j < own->deps; ++j) {
        double sign, sign_l;
        const int k = leading_dep(n, own, other, j, &sign), row = at + INERTIA_COORDINATE + 7 * j;
        if (k < 0)
            continue;
        for (int i = 0; i < 7; ++i)
            narrow_give(n->whole, ARRAY_n, row + i, of + INERTIA_COORDINATE + 7 * k + i,
                        sign * (i < 3   ? mirror_vector(i)
                                : i < 6 ? mirror_turn(i - 3)
                                        : 1));
        for (int l = j; l < own->deps; ++l) {
            const int m = leading_dep(n, own, other, l, &sign_l);
            if (m >= 0)
                narrow_give(n->whole, ARRAY_n, at + inertia_mass(own->deps, j, l),
                            of + inertia_mass(own->deps, k < m ? k : m, k < m ? m : k), sign * sign_l);
        }
    }
}

/* ---- states -------------------------------------------------------------------------------------------------------
 */

static void assume_zero(Narrower *n, int state, const char *what)
{
    narrow_assume(n, ABOUT_STATE, pool_print(n->pool, "the vehicle moves straight ahead: %s is 0", what),
                  pool_print(n->pool, "y[%d] != R(0.0)", state));
}

static void give_base(Narrower *n)
{
    const int twist = 7 + n->plan->free_coordinates;
    const struct {
        int state;
        const char *name;
    } odd[] = {{4, "e1"}, {6, "e3"}, {twist + 1, "v.y"}, {twist + 3, "omega.x"}, {twist + 5, "omega.z"}};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; ++i) {
        givens_number(n->whole, 0, element_at(ARRAY_y, odd[i].state));
        givens_number(n->whole, 0, element_at(ARRAY_rate, odd[i].state));
        assume_zero(n, odd[i].state, odd[i].name);
    }
    givens_number(n->whole, 0, element_at(ARRAY_e, 1));
    givens_number(n->whole, 0, element_at(ARRAY_e, 3));
    givens_number(n->whole, 0, element_at(ARRAY_rate, 1));
}

static const char *signed_place(Narrower *n, const char *array, int at, double sign)
{
    return pool_print(n->pool, "%s%s[%d]", sign < 0 ? "-" : "", array, at);
}

static void give_coordinates(Narrower *n)
{
    const Plan *plan = n->plan;
    for (int w = 0; w < n->model->coordinates; ++w) {
        const int image = n->mirror->coordinate[w], state = plan->coordinate_state[w], rate = plan->coordinate_rate[w];
        const char *name = n->model->coordinate[w].name;
        if (image == w && n->mirror->sign[w] < 0 && state >= 0) {
            givens_number(n->whole, 0, element_at(ARRAY_rate, state));
            givens_number(n->whole, 0, element_at(ARRAY_rate, rate));
            narrow_assume(
                n, ABOUT_STATE,
                pool_print(n->pool, "the vehicle moves straight ahead: '%s' keeps its design value", name),
                pool_print(n->pool, "y[%d] != %s || y[%d] != R(0.0)", state, emit_number(n->pool, n->at[w]), rate));
        }
        if (image >= w)
            continue;
        const double sign = n->mirror->sign[w];
        narrow_give(n->whole, ARRAY_x, w, image, sign);
        narrow_give(n->whole, ARRAY_xd, w, image, sign);
        if (state < 0)
            continue;
        narrow_give(n->whole, ARRAY_rate, state, plan->coordinate_state[image], sign);
        narrow_give(n->whole, ARRAY_rate, rate, plan->coordinate_rate[image], sign);
        narrow_assume(n, ABOUT_STATE,
                      pool_print(n->pool, "the vehicle moves straight ahead: '%s' is the mirror image of '%s'", name,
                                 n->model->coordinate[image].name),
                      pool_print(n->pool, "y[%d] != %s || y[%d] != %s", state,
                                 signed_place(n, "y", plan->coordinate_state[image], sign), rate,
                                 signed_place(n, "y", plan->coordinate_rate[image], sign)));
    }
}

static void give_wheel(Narrower *n, int wheel, int leader)
{
    const Model *model = n->model;
    const int at = model->wheel[wheel].fast, of = model->wheel[leader].fast, slow = n->plan->states;
    const int grip = GRIP_NUMBERS * wheel_rolling(model, wheel), other = GRIP_NUMBERS * wheel_rolling(model, leader);
    Text broken = {.pool = n->pool};
    for (int i = 0; i < wheel_fast_states(&model->wheel[wheel]); ++i) {
        narrow_give(n->whole, ARRAY_y, slow + at + i, slow + of + i, wheel_fast_sign(i));
        narrow_give(n->whole, ARRAY_rate, slow + at + i, slow + of + i, wheel_fast_sign(i));
        narrow_give(n->fast, ARRAY_fast, at + i, of + i, wheel_fast_sign(i));
        narrow_give(n->fast, ARRAY_rate, at + i, of + i, wheel_fast_sign(i));
        text_print(&broken, "%sfast[%d] != %s", i ? " || " : "", at + i,
                   signed_place(n, "fast", of + i, wheel_fast_sign(i)));
    }
    for (int i = 0; i < GRIP_NUMBERS; ++i) {
        if (i == GRIP_POINT + 1)
            continue;
        narrow_give(n->whole, ARRAY_self_grip, grip + i, other + i, wheel_grip_sign(i));
        narrow_give(n->fast, ARRAY_grip, grip + i, other + i, wheel_grip_sign(i));
    }
    narrow_assume(n, ABOUT_FAST,
                  pool_print(n->pool, "the vehicle moves straight ahead: wheel '%s' turns as '%s' does",
                             model->wheel[wheel].name, model->wheel[leader].name),
                  broken.s);
}

/* What a subset that is solved reads of others is solved too: their motions are in memory. */
static void keep_knowns(const Narrower *n, int *image)
{
    const Sequence *sequence = n->plan->sequence;
    for (int s = sequence->subsets - 1; s >= 0; --s) /* knowns come before */
        for (int i = 0; image[s] < 0 && i < sequence->subset[s].knowns; ++i)
            image[sequence->body_subset[sequence->subset[s].known[i]]] = -1;
}

void narrow_mirror(Narrower *n)
{
    const Model *model = n->model;
    const Sequence *sequence = n->plan->sequence;
    int *image = pool_alloc(n->pool, ((size_t)sequence->subsets + 1) * sizeof *image);
    int *wheel = pool_alloc(n->pool, ((size_t)model->wheels + 1) * sizeof *wheel);
    give_base(n);
    give_coordinates(n);
    for (int b = 1; b < model->bodies; ++b)
        if (n->mirror->body[b] <= b)
            give_motion(n, b, n->mirror->body[b]);
    for (int s = 0; s < sequence->subsets; ++s) {
        image[s] = image_subset(n, s);
        if (sequence->subset[s].class < 0)
            continue;
        const int other = sequence->body_subset[n->mirror->body[sequence->subset[s].body[0]]];
        if (image[s] >= 0 || other == s)
            give_inertia(n, s, other);
    }
    keep_knowns(n, image);
    for (int i = 0; i < model->wheels; ++i) {
        wheel[i] = model->wheel[i].tire >= 0 && n->mirror->wheel[i] < i ? n->mirror->wheel[i] : -1;
        if (wheel[i] >= 0)
            give_wheel(n, i, wheel[i]);
    }
    if (n->facts->across && model->wheels)
        narrow_assume(n, ABOUT_ROAD, "the road is the same on both sides, and level from one to the other", "0");
    n->narrowing->image = image;
    n->narrowing->wheel = wheel;
}

/* ---- equations of motion ------------------------------------------------------------------------------------------
 */

Reduction *narrow_reduction(Narrower *n)
{
    const Plan *plan = n->plan;
    Reduction *r = pool_alloc(n->pool, sizeof *r);
    r->of = pool_alloc(n->pool, ((size_t)plan->unknowns + 1) * sizeof *r->of);
    r->sign = pool_alloc(n->pool, ((size_t)plan->unknowns + 1) * sizeof *r->sign);
    for (int i = 0; i < 6; ++i) {
        r->sign[i] = 1;
        r->of[i] = (i < 3 ? mirror_turn(i) : mirror_vector(i - 3)) > 0 ? r->unknowns++ : -1;
    }
    for (int w = 0; w < n->model->coordinates; ++w) {
        const int unknown = plan->coordinate_unknown[w], image = n->mirror->coordinate[w];
        if (unknown < 0)
            continue;
        r->sign[unknown] = image < w ? n->mirror->sign[w] : 1;
        r->of[unknown] = image < w                              ? r->of[plan->coordinate_unknown[image]]
                         : image == w && n->mirror->sign[w] < 0 ? -1
                                                                : r->unknowns++;
    }
    return r;
}

const Block *narrow_dynamics(Narrower *n)
{
    Plan plan = *n->general->plan;
    plan.reduction = narrow_reduction(n);
    return dynamics_block(whole_new(n->pool, narrow_copy(n->pool, &plan, 1, sizeof plan)));
}
