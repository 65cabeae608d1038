/* SPDX-License-Identifier: MIT
 * The whole vehicle relative to the world, with all subsets recovered: shared by dynamics, outputs and checks. */
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Places for the d[] of a subset's class. */
static void add_derived(Plan *plan, Pool *pool, int subset)
{
    const Class *class = &plan->sequence->class[plan->sequence->subset[subset].class];
    const Formula *formula = plan->formula[plan->sequence->subset[subset].class];
    int member = 0;
    while (class->member[member] != subset)
        ++member;
    plan->derived_offset[subset] = plan->derived->count;
    for (int i = 0; i < formula->derived; ++i)
        *POOL_PUSH(pool, plan->derived->formula, plan->derived->count) =
            formula->derived_of[i * class->members + member];
}

int plan_layout(Pool *pool, const Plan *plan)
{
    Text text = {.pool = pool};
    static const int form[SOLVES] = {[SOLVE_AUGMENTED] = 1, [SOLVE_ARTICULATED] = 2};
    text_print(&text, "%d %d %d %d", form[plan->solve], plan->start_size, plan->motion_size, plan->inertia_size);
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const int class = plan->sequence->subset[s].class;
        text_print(&text, " %d %d", plan->start_offset[s], plan->stride[s]);
        if (class >= 0)
            text_print(&text, " %d", plan->formula[class]->closed);
    }
    return (int)(text_hash(text.s, text.size) & 0x7fffffff);
}

Plan *plan_new(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Formula **formula,
               const double (*origin)[3])
{
    Plan *plan = pool_alloc(pool, sizeof *plan);
    size_t bodies = (size_t)model->bodies, coordinates = (size_t)model->coordinates + 1,
           subsets = (size_t)sequence->subsets + 1;
    *plan = (Plan){.model = model,
                   .sequence = sequence,
                   .solve = solve,
                   .formula = formula,
                   .origin = origin,
                   .start_offset = pool_alloc(pool, subsets * sizeof(int)),
                   .inertia_offset = pool_alloc(pool, subsets * sizeof(int)),
                   .motion_offset = pool_alloc(pool, bodies * sizeof(int)),
                   .multiplier_offset = pool_alloc(pool, bodies * sizeof(int)),
                   .derived_offset = pool_alloc(pool, subsets * sizeof(int)),
                   .stride = pool_alloc(pool, subsets * sizeof(int)),
                   .derived = pool_alloc(pool, sizeof(Derived)),
                   .coordinate_state = pool_alloc(pool, coordinates * sizeof(int)),
                   .coordinate_rate = pool_alloc(pool, coordinates * sizeof(int)),
                   .coordinate_unknown = pool_alloc(pool, coordinates * sizeof(int))};
    for (int i = 0; model->tuning && i < model->parameters; ++i)
        if (model->parameter[i].geometric)
            *POOL_PUSH(pool, plan->derived->formula, plan->derived->count) =
                ex_input(model->tuning->dag, element_at(ARRAY_p, model->parameter[i].index), NULL);
    /* the coordinates of a start come first in it */
    plan->start_size = model->coordinates;
    int multipliers = 0;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Layout *layout = &formula[subset->class]->layout;
        plan->stride[s] = 1;
        plan->start_offset[s] = plan->start_size;
        plan->inertia_offset[s] = plan->inertia_size;
        plan->start_size += layout->start_size;
        plan->inertia_size += layout->inertia_size;
        add_derived(plan, pool, s);
        for (int b = 0; b < subset->bodies; ++b) {
            plan->motion_offset[subset->body[b]] = plan->motion_size;
            plan->motion_size += layout->motion_size;
            plan->multiplier_offset[subset->body[b]] = multipliers;
            multipliers += 6;
        }
    }
    for (int i = 0; i < model->outputs; ++i)
        if (output_reads(model, &model->output[i], OUTPUT_REACTION) ||
            (output_reads(model, &model->output[i], OUTPUT_DRIVE_FORCE) && solve == SOLVE_AUGMENTED))
            plan->multipliers = multipliers;
    for (int i = 0; i < model->coordinates; ++i)
        plan->free_coordinates += !model->coordinate[i].driven;
    int free_index = 0, base_pose = model->free_base ? 7 : 0, base_twist = model->free_base ? 6 : 0;
    for (int i = 0; i < model->coordinates; ++i) {
        bool driven = model->coordinate[i].driven;
        plan->coordinate_state[i] = driven ? -1 : base_pose + free_index;
        plan->coordinate_rate[i] = driven ? -1 : base_pose + plan->free_coordinates + base_twist + free_index;
        plan->coordinate_unknown[i] = driven ? -1 : base_twist + free_index;
        free_index += !driven;
    }
    plan->states = base_pose + base_twist + 2 * plan->free_coordinates;
    plan->unknowns = base_twist + plan->free_coordinates;
    return plan;
}

const Subset *whole_subset(const Whole *whole, int body)
{
    return &whole->plan->sequence->subset[whole->plan->sequence->body_subset[body]];
}

static Ex indexed(Whole *whole, Array array, int i)
{
    return ex_input(whole->dag, element_at(array, i), NULL);
}

Ex whole_fast(Whole *whole, Array array, int wheel, int state)
{
    return indexed(whole, array, whole->plan->states + whole->model->wheel[wheel].fast + state);
}

Ex whole_grip(Whole *whole, int wheel, int number)
{
    return indexed(whole, ARRAY_self_grip, GRIP_NUMBERS * wheel_rolling(whole->model, wheel) + number);
}

Ex whole_watch(Whole *whole, int number)
{
    return indexed(whole, ARRAY_self_watch, number);
}

bool plan_follows(const Plan *plan, int subset)
{
    int class = plan->sequence->subset[subset].class;
    return class >= 0 && !plan->formula[class]->closed;
}

/* The motion of a body in memory; numbers that are the same in every configuration are constants. */
static void body_motion(Whole *whole, int body)
{
    const Plan *plan = whole->plan;
    const Subset *subset = whole_subset(whole, body);
    const Formula *formula = plan->formula[subset->class];
    const Class *class = &plan->sequence->class[subset->class];
    const int member = class_place(class, plan->sequence->body_subset[body]);
    Motion *motion = &whole->motion[body];
    motion_input(whole->dag, motion, ARRAY_m, 0, plan->motion_offset[body],
                 plan->stride[plan->sequence->body_subset[body]], subset->deps);
    for (int i = 0; i < formula->layout.motion_size; ++i) {
        const Ex found = *motion_number(&formula->motion[subset_place(subset, body)], i);
        if (formula_is_constant(formula, found) && !whole->open)
            *motion_number(motion, i) = ex_literal(whole->dag, formula_value(formula, found, member));
    }
}

bool plan_keeps(const Plan *plan, int subset)
{
    const Subset *own = &plan->sequence->subset[subset];
    if (own->class < 0 || plan_follows(plan, subset))
        return false;
    for (int i = 0; i < own->knowns; ++i)
        if (!plan_keeps(plan, plan->sequence->body_subset[own->known[i]]))
            return false;
    return true;
}

Whole *whole_open(Pool *pool, const Plan *plan, bool open)
{
    const Model *model = plan->model;
    Dag *dag = dag_new(pool, 1, 1);
    Whole *whole = pool_alloc(pool, sizeof *whole);
    *whole = (Whole){.plan = plan,
                     .model = model,
                     .dag = dag,
                     .open = open,
                     .motion = pool_alloc(pool, (size_t)model->bodies * sizeof(Motion)),
                     .x = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof(Ex)),
                     .xd = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof(Ex)),
                     .z = pool_alloc(pool, ((size_t)model->states + 1) * sizeof(Ex))};
    for (int i = 0; i < model->states; ++i)
        whole->z[i] = indexed(whole, ARRAY_y, plan->states + model->state[i].fast);
    motion_base(dag, &whole->motion[BODY_BASE]);
    for (int b = 1; b < model->bodies; ++b)
        body_motion(whole, b);
    for (int i = 0; i < model->coordinates; ++i) {
        whole->x[i] = indexed(whole, ARRAY_x, i);
        whole->xd[i] = indexed(whole, ARRAY_xd, i);
    }
    Ex gravity[3];
    for (int i = 0; i < 3; ++i)
        gravity[i] = whole_number(whole, &model->gravity[i]);
    if (model->free_base) {
        int twist = 7 + plan->free_coordinates;
        for (int i = 0; i < 3; ++i) {
            whole->r[i] = indexed(whole, ARRAY_y, i);
            whole->v[i] = indexed(whole, ARRAY_y, twist + i);
            whole->turn[i] = indexed(whole, ARRAY_y, twist + 3 + i);
        }
        for (int i = 0; i < 4; ++i)
            whole->e[i] = indexed(whole, ARRAY_e, i);
        ex_rotation(dag, whole->e, whole->R);
    } else {
        for (int i = 0; i < 3; ++i)
            whole->r[i] = ex_literal(dag, model->body[BODY_BASE].position[i]);
        for (int i = 0; i < 4; ++i)
            whole->e[i] = ex_literal(dag, model->body[BODY_BASE].euler[i]);
        ex_rotation(dag, whole->e, whole->R);
    }
    ex_apply_transposed(dag, whole->R, gravity, whole->gravity);
    return whole;
}

Whole *whole_new(Pool *pool, const Plan *plan)
{
    return whole_open(pool, plan, false);
}

/* The number of derived[] with that formula, added if missing; 0: the formula is a literal. */
static Ex derived_number(Whole *whole, Ex formula, double value)
{
    Derived *derived = whole->plan->derived;
    int i = 0;
    if (!formula)
        return whole->open ? ex_number(whole->dag, value) : ex_literal(whole->dag, value);
    while (i < derived->count && derived->formula[i] != formula)
        ++i;
    if (i == derived->count)
        *POOL_PUSH(whole->dag->pool, derived->formula, derived->count) = formula;
    return ex_input(whole->dag, element_at(ARRAY_self_derived, i), &value);
}

Ex whole_number(Whole *whole, const double *at)
{
    return derived_number(whole, tuned_number(whole->model, at), *at);
}

static Ex whole_difference(Whole *whole, const double *a, const double *b)
{
    return derived_number(whole, tuned_difference(whole->model, a, b), *a - *b);
}

Vector whole_point(Whole *whole, int body, const double s[3])
{
    Dag *dag = whole->dag;
    Ex local[3];
    if (body == BODY_GROUND) {
        /* fixed in the world: relative to the base it moves opposite to the base */
        Vector vector = {.point = true};
        Ex world[3], velocity[3];
        for (int i = 0; i < 3; ++i)
            local[i] = whole_number(whole, &s[i]);
        ex_sub3(dag, local, whole->r, world);
        ex_apply_transposed(dag, whole->R, world, vector.v);
        ex_apply_transposed(dag, whole->R, whole->v, velocity);
        ex_cross(dag, whole->turn, vector.v, vector.rate);
        ex_add3(dag, vector.rate, velocity, vector.rate);
        ex_sub3(dag, (Ex[3]){0}, vector.rate, vector.rate);
        return vector;
    }
    for (int i = 0; i < 3; ++i)
        local[i] = whole_difference(whole, &s[i], &whole->plan->origin[body][i]);
    return vector_point(dag, &whole->motion[body], local);
}

static Fixture whole_fixture(Whole *whole, const double number[FIXTURE_NUMBERS], const Ex formula[FIXTURE_NUMBERS])
{
    Fixture fixture;
    for (int i = 0; i < FIXTURE_NUMBERS; ++i)
        ((Ex *)&fixture)[i] = derived_number(whole, formula[i], number[i]);
    return fixture;
}

Fixture whole_joint_fixture(Whole *whole, const Joint *joint, const double (*origin)[3])
{
    double number[FIXTURE_NUMBERS];
    Ex formula[FIXTURE_NUMBERS];
    fixture_of_joint(joint, origin, number);
    fixture_tuned_joint(whole->model, joint, origin, formula);
    return whole_fixture(whole, number, formula);
}

Fixture whole_coordinate_fixture(Whole *whole, const Coordinate *coordinate, const double (*origin)[3])
{
    double number[FIXTURE_NUMBERS];
    Ex formula[FIXTURE_NUMBERS];
    fixture_of_coordinate(coordinate, origin, number);
    fixture_tuned_coordinate(whole->model, coordinate, origin, formula);
    return whole_fixture(whole, number, formula);
}

static Ex coupling_number(void *context, Ex formula, double value)
{
    return derived_number(context, formula, value);
}

Coupling whole_coupling(Whole *whole, const Joint *joint)
{
    return coupling_make(whole->dag, whole->model, joint->value, whole->x, whole->xd, coupling_number, whole);
}

void whole_position(Whole *whole, const Vector *point, Ex out[3])
{
    ex_apply(whole->dag, whole->R, point->v, out);
    ex_add3(whole->dag, whole->r, out, out);
}

void whole_velocity_in_base(Whole *whole, const Vector *point, Ex out[3])
{
    Ex own[3];
    ex_apply_transposed(whole->dag, whole->R, whole->v, own);
    ex_cross(whole->dag, whole->turn, point->v, out);
    ex_add3(whole->dag, out, point->rate, out);
    ex_add3(whole->dag, out, own, out);
}

void whole_velocity(Whole *whole, const Vector *point, Ex out[3])
{
    Ex relative[3];
    ex_cross(whole->dag, whole->turn, point->v, relative);
    ex_add3(whole->dag, relative, point->rate, relative);
    ex_apply(whole->dag, whole->R, relative, out);
    ex_add3(whole->dag, whole->v, out, out);
}

void whole_rotate_inertia(Whole *whole, int body, const Ex own[6], Ex J[6])
{
    Dag *dag = whole->dag;
    const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    const Ex *A = whole->motion[body].A;
    Ex AI[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            Ex column[3];
            for (int k = 0; k < 3; ++k)
                column[k] = own[place[k][j]];
            AI[i][j] = ex_dot(dag, A + 3 * i, column);
        }
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            J[place[i][j]] = ex_dot(dag, AI[i], A + 3 * j);
}

void whole_inertia(Whole *whole, int body, Ex J[6])
{
    Ex own[6];
    for (int i = 0; i < 6; ++i)
        own[i] = whole_number(whole, &whole->model->body[body].inertia[i]);
    whole_rotate_inertia(whole, body, own, J);
}

void whole_acceleration(Whole *whole, int body, const Vector *point, const Ex alpha[3], const Ex a[3], const Ex *w2,
                        Ex out[3])
{
    Dag *dag = whole->dag;
    Ex t[3];
    ex_cross(dag, whole->turn, point->v, t);
    ex_add3(dag, t, point->rate, t);
    ex_add3(dag, t, point->rate, t);
    ex_cross(dag, whole->turn, t, out);
    ex_cross(dag, alpha, point->v, t);
    ex_add3(dag, out, t, out);
    ex_add3(dag, out, a, out);
    ex_add3(dag, out, point->bias, out);
    if (body <= BODY_BASE)
        return;
    const Subset *subset = whole_subset(whole, body);
    for (int j = 0; j < subset->deps; ++j) {
        const Ex *S = whole->motion[body].S + 6 * j;
        ex_cross(dag, S, point->arm, t);
        ex_add3(dag, S + 3, t, t);
        ex_scale3(dag, w2[subset->dep[j]], t, t);
        ex_add3(dag, out, t, out);
    }
    whole_carry(whole, body, w2, point->v, t, out);
}

void whole_angular_acceleration(Whole *whole, int body, const Ex alpha[3], const Ex *w2, Ex out[3])
{
    Dag *dag = whole->dag;
    const Motion *m = &whole->motion[body];
    Ex t[3];
    ex_cross(dag, whole->turn, m->omega, out);
    ex_add3(dag, out, alpha, out);
    ex_add3(dag, out, m->alpha, out);
    if (body == BODY_BASE)
        return;
    const Subset *subset = whole_subset(whole, body);
    for (int j = 0; j < subset->deps; ++j) {
        ex_scale3(dag, w2[subset->dep[j]], m->S + 6 * j, t);
        ex_add3(dag, out, t, out);
    }
    ex_zero3(dag, t); /* the point's acceleration is not needed */
    whole_carry(whole, body, w2, m->c, out, t);
}
