/* SPDX-License-Identifier: MIT
 * Proof that a vehicle moves straight ahead: from a symmetric state, both sides' formulas give rates that are mirror
 * images. Bodies and joints are (mirror_model.c), so that what subsets recover is; here follow forces, wheels and
 * torques, by normal forms of what both sides compute. No numbers are tried out: a force law may have a threshold
 * anywhere. */
#include "expression/expression.h"
#include "model/model.h"
#include "specialize/normal_form.h"
#include "specialize/specialize.h"
#include "specialize/specialize_private.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

/* Expressions that must be b = sign a. */
typedef struct Equal {
    Ex a, b;
    double sign;
} Equal;

typedef struct Proof {
    Narrower *n;
    Normal *normal;
} Proof;

static Form times(double sign, Form f)
{
    return sign < 0 ? -f : sign > 0 ? f : 0;
}

/* A block with what is given in place. */
static Block given(const Proof *p, const Givens *givens, const Block *block)
{
    const Facts *facts = p->n->facts;
    Partial partial = partial_new(p->n->pool, block->dag, givens, facts->plane, facts->across, p->n->model);
    return partial_block(&partial, block);
}

/* Place of the first pair that is not proved to be equal, -1: all are. */
static int first_unequal(const Proof *p, const Block *block, const Givens *givens, const Equal *equal, int count)
{
    Block roots = {.dag = block->dag};
    Ex root[2 * count + 1];
    Form form[2 * count + 1];
    for (int i = 0; i < count; ++i) {
        block_store(&roots, equal[i].a, element_at(ARRAY_none, 2 * i));
        block_store(&roots, equal[i].b, element_at(ARRAY_none, 2 * i + 1));
    }
    const Block out = given(p, givens, &roots);
    for (int i = 0; i < 2 * count; ++i)
        root[i] = out.store[i].value;
    normal_forms(p->normal, out.dag, 0, NULL, NULL, root, 2 * count, form);
    for (int i = 0; i < count; ++i)
        if (form[2 * i + 1] != times(equal[i].sign, form[2 * i]))
            return i;
    return -1;
}

/* NULL: the block doesn't store it. */
static const Store *stored(const Block *block, Array array, int index)
{
    for (int i = 0; i < block->stores; ++i)
        if (element_index(block->store[i].target, array) == index)
            return &block->store[i];
    return NULL;
}

/* Two stores that must be equal, or both missing. */
static bool add_equal(Equal *equal, int *count, const Block *block, Array array, int at, int of)
{
    const Store *own = stored(block, array, at), *other = stored(block, array, of);
    if (own && other)
        equal[(*count)++] = (Equal){other->value, own->value, 1};
    return !own == !other;
}

/* ---- equations of motion ------------------------------------------------------------------------------------------
 */

static const char *unknown_name(const Narrower *n, int unknown)
{
    for (int w = 0; w < n->model->coordinates; ++w)
        if (n->plan->coordinate_unknown[w] == unknown)
            return pool_print(n->pool, "along coordinate '%s'", n->model->coordinate[w].name);
    return pool_print(n->pool, "on body '%s'", n->model->body[BODY_BASE].name);
}

/* The residuals of inverse_block for accelerations that go with the mirror: those of odd unknowns are 0, those of the
 * other side's the same. So accelerations that solve the equations of one side solve all, and are the only ones. */
static const char *dynamics_uneven(const Proof *p)
{
    Narrower *n = p->n;
    const Plan *plan = n->general->plan;
    const Reduction *r = narrow_reduction(n);
    const Block *block = n->general->inverse;
    Equal equal[plan->unknowns + 1];
    int first[plan->unknowns + 1], of_equal[plan->unknowns + 1], count = 0;
    for (int i = 0; i < r->unknowns; ++i)
        first[i] = -1;
    for (int i = 0; i < plan->unknowns; ++i) {
        const int of = r->of[i];
        const Ex own = stored(block, ARRAY_tau, i)->value;
        of_equal[count] = i;
        if (of < 0) {
            givens_number(n->whole, 0, element_at(ARRAY_acc, i));
            equal[count++] = (Equal){0, own, 0};
        } else if (first[of] >= 0) {
            narrow_give(n->whole, ARRAY_acc, i, first[of], r->sign[i]);
            equal[count++] = (Equal){stored(block, ARRAY_tau, first[of])->value, own, r->sign[i]};
        } else {
            first[of] = i;
        }
    }
    const int bad = first_unequal(p, block, n->whole, equal, count);
    return bad < 0 ? NULL
                   : pool_print(n->pool, "forces are not the same on both sides: %s", unknown_name(n, of_equal[bad]));
}

/* ---- wheels with tires ---------------------------------------------------------------------------------------------
 */

static double link_sign(int i)
{
    return i < LINK_S ? mirror_vector(i % 3) : mirror_turn(i % 3);
}

static double contact_sign(int i)
{
    if (i >= CONTACT_X)
        return i >= CONTACT_Y && i < CONTACT_N ? mirror_turn((i - CONTACT_X) % 3) : mirror_vector((i - CONTACT_X) % 3);
    return i == CONTACT_TANGENT || i == CONTACT_CAMBER ? -1 : 1;
}

static double force_sign(int i)
{
    return i == TIRE_FX || i == TIRE_MY ? 1 : -1;
}

static double same_sign(int i)
{
    (void)i;
    return 1;
}

/* What a mirror makes of the numbers that the functions of wheels read and store. */
static const struct {
    Array array;
    double (*sign)(int i);
} wheel_array[] = {{ARRAY_link, link_sign},       {ARRAY_fast, wheel_fast_sign}, {ARRAY_rate, wheel_fast_sign},
                   {ARRAY_contact, contact_sign}, {ARRAY_force, force_sign},     {ARRAY_torque, same_sign},
                   {ARRAY_grip, wheel_grip_sign}};

enum { WHEEL_ARRAYS = sizeof wheel_array / sizeof *wheel_array };

/* Place among the arrays, -1: of none. */
static int array_of(Element e)
{
    for (int i = 0; i < WHEEL_ARRAYS; ++i)
        if (e.array == wheel_array[i].array)
            return i;
    return -1;
}

/* World y of something at a wheel: as far from the plane that the vehicle stays in on one side as on the other. */
static bool is_place(Element e)
{
    return element_same(e, element_at(ARRAY_link, LINK_C + 1)) ||
           element_same(e, element_at(ARRAY_grip, GRIP_POINT + 1));
}

/* *(bool *)context: of the image. */
static Form wheel_input(void *context, Normal *normal, Element e)
{
    const int array = *(const bool *)context ? array_of(e) : -1;
    const Form own = normal_input(normal, e), f = array < 0 ? own : times(wheel_array[array].sign(e.index), own);
    return is_place(e) ? normal_sum(normal, normal_middle(normal), f) : f;
}

typedef struct Member {
    const WheelClass *class;
    int place;
} Member;

static Member member_of(const Wheels *wheels, int wheel)
{
    for (int c = 0; c < wheels->classes; ++c)
        for (int i = 0; i < wheels->class[c].members; ++i)
            if (wheels->class[c].member[i] == wheel)
                return (Member){&wheels->class[c], i};
    return (Member){NULL, 0};
}

static void block_forms(const Proof *p, const Block *block, int place, bool image, Form *form)
{
    const Block out = given(p, givens_new(p->n->pool), block);
    Ex root[out.stores + 1];
    for (int i = 0; i < out.stores; ++i)
        root[i] = out.store[i].value;
    normal_forms(p->normal, out.dag, place, wheel_input, &image, root, out.stores, form);
}

/* True if a function of the leading wheel, `a`, gives the mirror image of what that of the other wheel, `b`, gives. */
static bool blocks_mirror(const Proof *p, const Block *a, int a_place, const Block *b, int b_place)
{
    Form own[a->stores + 1], other[b->stores + 1];
    if (a->stores != b->stores)
        return false;
    block_forms(p, a, a_place, false, own);
    block_forms(p, b, b_place, true, other);
    for (int i = 0; i < a->stores; ++i) {
        const Element target = a->store[i].target;
        const Form from = is_place(target) ? -normal_middle(p->normal) : 0;
        const int array = array_of(target);
        if (array < 0 || !element_same(target, b->store[i].target))
            return false;
        const double sign = is_place(target) ? -1 : wheel_array[array].sign(target.index);
        if (normal_sum(p->normal, other[i], from) != times(sign, normal_sum(p->normal, own[i], from)))
            return false;
    }
    return true;
}

/* The links of both wheels are images, world components, of the vehicle's plane through y[1]. */
static bool links_mirror(const Proof *p, int wheel, int leader)
{
    const Narrower *n = p->n;
    const Block *link = &n->general->wheels->link;
    const int at = LINK_NUMBERS * wheel_rolling(n->model, wheel), of = LINK_NUMBERS * wheel_rolling(n->model, leader);
    const Form down = -normal_middle(p->normal);
    Block roots = {.dag = link->dag};
    Ex root[2 * LINK_NUMBERS];
    Form form[2 * LINK_NUMBERS];
    for (int i = 0; i < 2 * LINK_NUMBERS; ++i)
        block_store(&roots, stored(link, ARRAY_link, (i < LINK_NUMBERS ? of : at) + i % LINK_NUMBERS)->value,
                    element_at(ARRAY_link, i));
    const Block out = given(p, n->whole, &roots);
    for (int i = 0; i < 2 * LINK_NUMBERS; ++i)
        root[i] = out.store[i].value;
    normal_forms(p->normal, out.dag, 0, NULL, NULL, root, 2 * LINK_NUMBERS, form);
    for (int i = 0; i < LINK_NUMBERS; ++i) {
        const Form from = i == LINK_C + 1 ? down : 0, own = normal_sum(p->normal, form[i], from);
        if (normal_sum(p->normal, form[LINK_NUMBERS + i], from) != times(link_sign(i), own))
            return false;
    }
    return true;
}

static bool wheels_mirror(const Proof *p, int wheel, int leader)
{
    const Wheels *wheels = p->n->general->wheels;
    const Member a = member_of(wheels, leader), b = member_of(wheels, wheel);
    return links_mirror(p, wheel, leader) && blocks_mirror(p, &a.class->contact, a.place, &b.class->contact, b.place) &&
           blocks_mirror(p, &a.class->tire, a.place, &b.class->tire, b.place) &&
           blocks_mirror(p, &a.class->balance, a.place, &b.class->balance, b.place);
}

static const char *wheels_uneven(const Proof *p)
{
    const Model *model = p->n->model;
    for (int i = 0; p->n->general->wheels && i < model->wheels; ++i) {
        const int leader = p->n->narrowing->wheel[i];
        if (leader >= 0 && !wheels_mirror(p, i, leader))
            return pool_print(p->n->pool, "tires '%s' and '%s' are not mirror images", model->wheel[leader].name,
                              model->wheel[i].name);
    }
    return NULL;
}

/* ---- torques -------------------------------------------------------------------------------------------------------
 */

/* Torques of drives and brakes. */
static bool torques_equal(const Proof *p, int wheel, int leader)
{
    const Narrower *n = p->n;
    const Block *torque = &n->general->wheels->torque;
    Equal equal[2];
    int count = 0;
    for (int k = 0; k < 2; ++k)
        if (!add_equal(equal, &count, torque, ARRAY_torque, 2 * wheel_rolling(n->model, wheel) + k,
                       2 * wheel_rolling(n->model, leader) + k))
            return false;
    return first_unequal(p, torque, n->fast, equal, count) < 0;
}

/* The equations that the powertrain solves for the spins, and what follows from these. */
static bool spins_equal(const Proof *p, int wheel, int leader)
{
    static const int number[] = {GRIP_DRIVE, GRIP_POWER};
    const Narrower *n = p->n;
    const Block *spins = &n->general->wheels->spins;
    const int at = n->model->wheel[wheel].fast + FAST_SPIN, of = n->model->wheel[leader].fast + FAST_SPIN;
    const int grip = GRIP_NUMBERS * wheel_rolling(n->model, wheel),
              other = GRIP_NUMBERS * wheel_rolling(n->model, leader);
    Equal equal[3];
    int count = 0;
    if (!add_equal(equal, &count, spins, ARRAY_left, at, of))
        return false;
    for (int k = 0; k < 2; ++k)
        if (!add_equal(equal, &count, spins, ARRAY_grip, grip + number[k], other + number[k]))
            return false;
    return first_unequal(p, spins, n->fast, equal, count) < 0;
}

static const char *torques_uneven(const Proof *p)
{
    Narrower *n = p->n;
    const Model *model = n->model;
    for (int i = 0; n->general->wheels && i < model->wheels; ++i) /* spins that go with the mirror */
        if (n->narrowing->wheel[i] >= 0)
            narrow_give(n->fast, ARRAY_acc, model->wheel[i].fast + FAST_SPIN,
                        model->wheel[n->narrowing->wheel[i]].fast + FAST_SPIN, 1);
    for (int i = 0; n->general->wheels && i < model->wheels; ++i) {
        const int leader = n->narrowing->wheel[i];
        if (leader >= 0 && (wheel_is_driven(model, i) != wheel_is_driven(model, leader) ||
                            !torques_equal(p, i, leader) || (model->powertrain && !spins_equal(p, i, leader))))
            return pool_print(n->pool, "torques on wheels '%s' and '%s' are not the same", model->wheel[leader].name,
                              model->wheel[i].name);
    }
    return NULL;
}

const char *narrow_uneven(Narrower *n)
{
    const Proof p = {n, normal_new(n->pool, n->model, n->facts->across)};
    const char *why = dynamics_uneven(&p);
    if (!why)
        why = wheels_uneven(&p);
    return why ? why : torques_uneven(&p);
}
