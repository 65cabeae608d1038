/* SPDX-License-Identifier: MIT
 * A vehicle that moves straight ahead: numbers of one side are those of the other, with the signs that a mirror gives
 * them, and what is odd is 0. */
#include "narrow_work.h"

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

/* Let number `at` of an array be sign times number `of`, of itself: 0 where that is negative. */
static void give(Narrower *n, Givens *givens, const char *array, int at, int of, double sign)
{
    const char *name = pool_print(n->pool, "%s[%d]", array, at);
    const Given *there = givens_find(givens, name);
    if (there && there->value)
        return;
    if (at != of)
        givens_other(givens, name, pool_print(n->pool, "%s[%d]", array, of), sign < 0);
    else if (sign < 0)
        givens_number(givens, 0, "%s", name);
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

static void give_motion(Narrower *n, int body, int leader)
{
    const Sequence *sequence = n->plan->sequence;
    const Subset *own = &sequence->subset[sequence->body_subset[body]];
    const Subset *other = &sequence->subset[sequence->body_subset[leader]];
    const int at = n->plan->motion_offset[body], of = n->plan->motion_offset[leader];
    static const int vector[] = {MOTION_C, MOTION_VELOCITY, MOTION_ACCELERATION}, turn[] = {MOTION_OMEGA, MOTION_ALPHA};
    for (int i = 0; i < 9; ++i) {
        give(n, n->whole, "m", at + vector[i / 3] + i % 3, of + vector[i / 3] + i % 3, mirror_vector(i % 3));
        give(n, n->whole, "m", at + MOTION_A + i, of + MOTION_A + i, mirror_matrix(i));
    }
    for (int i = 0; i < 6; ++i)
        give(n, n->whole, "m", at + turn[i / 3] + i % 3, of + turn[i / 3] + i % 3, mirror_turn(i % 3));
    for (int j = 0; j < own->deps; ++j) {
        double sign;
        const int k = leading_dep(n, own, other, j, &sign);
        for (int i = 0; k >= 0 && i < 6; ++i)
            give(n, n->whole, "m", at + MOTION_S + 6 * j + i, of + MOTION_S + 6 * k + i,
                 sign * (i < 3 ? mirror_turn(i) : mirror_vector(i - 3)));
    }
}

static void give_inertia(Narrower *n, int subset, int leader)
{
    const Subset *own = &n->plan->sequence->subset[subset], *other = &n->plan->sequence->subset[leader];
    const int at = n->plan->inertia_offset[subset], of = n->plan->inertia_offset[leader];
    for (int i = 0; i < 3; ++i) {
        give(n, n->whole, "n", at + INERTIA_FIRST + i, of + INERTIA_FIRST + i, mirror_vector(i));
        give(n, n->whole, "n", at + INERTIA_FORCE + i, of + INERTIA_FORCE + i, mirror_vector(i));
        give(n, n->whole, "n", at + INERTIA_MOMENT + i, of + INERTIA_MOMENT + i, mirror_turn(i));
    }
    for (int i = 0; i < 6; ++i)
        give(n, n->whole, "n", at + INERTIA_SECOND + i, of + INERTIA_SECOND + i, mirror_inertia(i));
    for (int j = 0; j < own->deps; ++j) {
        double sign, sign_l;
        const int k = leading_dep(n, own, other, j, &sign), row = at + INERTIA_COORDINATE + 7 * j;
        if (k < 0)
            continue;
        for (int i = 0; i < 7; ++i)
            give(n, n->whole, "n", row + i, of + INERTIA_COORDINATE + 7 * k + i,
                 sign * (i < 3   ? mirror_vector(i)
                         : i < 6 ? mirror_turn(i - 3)
                                 : 1));
        for (int l = j; l < own->deps; ++l) {
            const int m = leading_dep(n, own, other, l, &sign_l);
            if (m >= 0)
                give(n, n->whole, "n", at + inertia_mass(own->deps, j, l),
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
        givens_number(n->whole, 0, "y[%d]", odd[i].state);
        givens_number(n->whole, 0, "rate[%d]", odd[i].state);
        assume_zero(n, odd[i].state, odd[i].name);
    }
    givens_number(n->whole, 0, "e[1]");
    givens_number(n->whole, 0, "e[3]");
    givens_number(n->whole, 0, "rate[1]");
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
            givens_number(n->whole, 0, "rate[%d]", state);
            givens_number(n->whole, 0, "rate[%d]", rate);
            narrow_assume(
                n, ABOUT_STATE,
                pool_print(n->pool, "the vehicle moves straight ahead: '%s' keeps its design value", name),
                pool_print(n->pool, "y[%d] != %s || y[%d] != R(0.0)", state, emit_number(n->pool, n->at[w]), rate));
        }
        if (image >= w)
            continue;
        const double sign = n->mirror->sign[w];
        give(n, n->whole, "x", w, image, sign);
        give(n, n->whole, "xd", w, image, sign);
        if (state < 0)
            continue;
        give(n, n->whole, "rate", state, plan->coordinate_state[image], sign);
        give(n, n->whole, "rate", rate, plan->coordinate_rate[image], sign);
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
        give(n, n->whole, "y", slow + at + i, slow + of + i, wheel_fast_sign(i));
        give(n, n->whole, "rate", slow + at + i, slow + of + i, wheel_fast_sign(i));
        give(n, n->fast, "fast", at + i, of + i, wheel_fast_sign(i));
        give(n, n->fast, "rate", at + i, of + i, wheel_fast_sign(i));
        text_print(&broken, "%sfast[%d] != %s", i ? " || " : "", at + i,
                   signed_place(n, "fast", of + i, wheel_fast_sign(i)));
    }
    for (int i = 0; i < GRIP_NUMBERS; ++i) {
        if (i == GRIP_POINT + 1)
            continue;
        give(n, n->whole, "self->grip", grip + i, other + i, wheel_grip_sign(i));
        give(n, n->fast, "grip", grip + i, other + i, wheel_grip_sign(i));
    }
    narrow_assume(n, ABOUT_FAST,
                  pool_print(n->pool, "the vehicle moves straight ahead: wheel '%s' turns as '%s' does",
                             model->wheel[wheel].name, model->wheel[leader].name),
                  broken.s);
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

static Reduction *reduction_of(Narrower *n)
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
    plan.reduction = reduction_of(n);
    return dynamics_block(whole_new(n->pool, narrow_copy(n->pool, &plan, 1, sizeof plan)));
}

/* ---- proof by numbers ---------------------------------------------------------------------------------------------
 */

/* New random numbers for all that the graph does not compute. */
static void scatter(Dag *dag, Random *random)
{
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        const Op op = (Op)dag->node[e].op;
        if (op == OP_INPUT || op == OP_TABLE || op == OP_ROAD_PART)
            ex_set_sample(dag, e, 0, random_uniform(random, -1, 1));
    }
    dag_evaluate(dag, 0, 1);
}

/* Is b = sign a for random numbers in place of everything? Sums are of many terms, so that rounding is small against
 * scale, the largest value. */
typedef struct Equal {
    Ex a, b;
    double sign;
} Equal;

static bool are_equal(Narrower *n, const Block *block, const Givens *givens, const Equal *equal, int count)
{
    const int trials = 32;
    const double rounding = 1e-9;
    Random random = {1};
    Block roots = {.dag = block->dag};
    for (int i = 0; i < count; ++i) {
        block_store(&roots, equal[i].a, "a");
        block_store(&roots, equal[i].b, "b");
    }
    Partial p = partial_new(n->pool, block->dag, givens, n->facts->plane, n->facts->across, n->model);
    const Block out = partial_block(&p, &roots);
    for (int t = 0; t < trials; ++t) {
        double scale = 0;
        scatter(p.to, &random);
        for (int i = 0; i < out.stores; ++i)
            scale = fmax(scale, fabs(ex_value(p.to, out.store[i].value, 0)));
        for (int i = 0; i < count; ++i) {
            const double a = ex_value(p.to, out.store[2 * i].value, 0),
                         b = ex_value(p.to, out.store[2 * i + 1].value, 0);
            if (!(fabs(b - equal[i].sign * a) <= rounding * scale))
                return false;
        }
    }
    return true;
}

static Ex stored(const Block *block, const char *array, int index)
{
    int i = 0;
    while (narrow_target(block->store[i].target, array) != index)
        ++i;
    return block->store[i].value;
}

/* The residuals of inverse_block for accelerations that go with the mirror: those of odd unknowns are 0, those of the
 * other side's the same. */
static bool dynamics_even(Narrower *n)
{
    const Plan *plan = n->general->plan;
    const Reduction *r = reduction_of(n);
    const Block *block = n->general->inverse;
    Equal equal[plan->unknowns + 1];
    int first[plan->unknowns + 1], count = 0;
    for (int i = 0; i < r->unknowns; ++i)
        first[i] = -1;
    for (int i = 0; i < plan->unknowns; ++i) {
        const int of = r->of[i];
        if (of < 0) {
            givens_number(n->whole, 0, "acc[%d]", i);
            equal[count++] = (Equal){0, stored(block, "tau", i), 0};
        } else if (first[of] >= 0) {
            give(n, n->whole, "acc", i, first[of], r->sign[i]);
            equal[count++] = (Equal){stored(block, "tau", first[of]), stored(block, "tau", i), r->sign[i]};
        } else {
            first[of] = i;
        }
    }
    return are_equal(n, block, n->whole, equal, count);
}

/* Torques of drives and brakes, and what the powertrain makes of them. */
static bool torques_even(Narrower *n)
{
    const Model *model = n->model;
    const Wheels *wheels = n->general->wheels;
    Equal torque[2 * model->wheels + 1], drive[model->wheels + 1];
    int torques = 0, drives = 0;
    for (int i = 0; wheels && i < model->wheels; ++i) {
        const int leader = n->narrowing->wheel[i];
        if (leader < 0)
            continue;
        for (int k = 0; k < 2; ++k)
            torque[torques++] = (Equal){stored(&wheels->torque, "torque", 2 * wheel_rolling(model, leader) + k),
                                        stored(&wheels->torque, "torque", 2 * wheel_rolling(model, i) + k), 1};
        if (wheel_is_driven(model, i) != wheel_is_driven(model, leader))
            return false;
        if (model->powertrain && wheel_is_driven(model, i) && !model->wheel[i].drive)
            drive[drives++] = (Equal){stored(&wheels->drive, "rate", model->wheel[leader].fast + FAST_SPIN),
                                      stored(&wheels->drive, "rate", model->wheel[i].fast + FAST_SPIN), 1};
    }
    return (!torques || are_equal(n, &wheels->torque, n->fast, torque, torques)) &&
           (!drives || are_equal(n, &wheels->drive, n->fast, drive, drives));
}

bool narrow_is_even(Narrower *n)
{
    return dynamics_even(n) && torques_even(n);
}
