/* SPDX-License-Identifier: MIT
 * Equations of motion in the augmented form (Serban and Haug 2000, eq. 16, in twists): accelerations of all bodies and
 * multipliers of all constraints,
 *
 *     [ M   -J^T ] [ acceleration ]   [ applied less gyroscopic forces ]
 *     [ J    0   ] [ lambda       ] = [ -bias                          ]
 *
 * and w'' of the free coordinates behind them, each from its own equation: what acts along a free coordinate acts on
 * the bodies, so that its multiplier vanishes. The equation of a driven coordinate is a constraint like the joints'. A
 * joint that follows free coordinates by a formula has their equations added to its own, so that their accelerations
 * are gone from it: it concerns their bodies, too. Elimination goes in the order of the topology: first the bodies,
 * whose M is m I and J where the centre of mass is their point; then the equations of joints, which couple where they
 * share a body; last a free base, which all of them would couple by. What is left after the bodies is, with the index 0
 * for the base,
 *
 *     [ J M^-1 J^T   J_0  ] [ lambda         ]   [ -bias - J M^-1 (applied less gyroscopic forces) ]
 *     [ J_0^T       -M_0  ] [ acceleration_0 ] = [ -(applied less gyroscopic forces)_0             ]
 *
 * the upper block positive, what becomes of the lower one negative definite: every order has pivots.
 *
 * All accelerations are less gravity, components in the base frame. */
#include "base/message.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* What an equation has to do with a body. */
typedef struct Side {
    int body;
    Ex J[6], Z[6]; /* Z: M^-1 J^T, except for the base */
} Side;

/* One equation of a joint or a dual coordinate. */
typedef struct Equation {
    int sides;
    Side *side;
    Ex dual, bias;
    int coordinate; /* the coordinate it belongs to; -1: none */
    int multiplier; /* its place in lambda[] */
    bool wanted;    /* true if an output needs its multiplier */
    Ex held;        /* the part of its multiplier that holds the forces along a driven coordinate */
} Equation;

typedef struct System {
    Whole *whole;
    Dag *dag;
    const Loads *loads;
    Motion *motion;   /* [bodies] of the centres of mass, in the inertial frame that moves with the base's origin */
    Ex (*inverse)[7]; /* [bodies] inverse of m and J, except for the base */
    Ex base_inertia[6];
    Ex (*wrench)[6];                /* [bodies] applied less gyroscopic, moment about the centre of mass */
    Ex (*acceleration)[6], *lambda; /* the solution */
    int equations, frees;
    int unknowns;       /* multipliers, then the acceleration of a free base */
    Equation *equation; /* of joints and driven coordinates */
    Equation *free;     /* of free coordinates */
} System;

/* ---- bodies ---------------------------------------------------------------------------------------------- */

/* J^-1 of a body, in base axes. */
static void inverse_inertia(System *s, int body, Ex out[6])
{
    static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    Dag *dag = s->dag;
    Ex J[9], own[6], unit[3];
    for (int i = 0; i < 9; ++i)
        J[i] = whole_number(s->whole, &s->whole->model->body[body].inertia[place[i / 3][i % 3]]);
    const Factors *factors = linear_factor_symmetric(dag, 3, J, NULL, 0);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            unit[j] = ex_literal(dag, i == j);
        linear_solve(dag, factors, unit, unit);
        for (int j = i; j < 3; ++j)
            own[place[i][j]] = unit[j];
    }
    whole_rotate_inertia(s->whole, body, own, out);
}

static void symmetric_apply(Dag *dag, const Ex J[6], const Ex x[3], Ex out[3])
{
    ex_apply(dag, (const Ex[]){J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, x, out);
}

/* x = M^-1 x of a body: angular, linear. */
static void solve_body(System *s, int body, Ex x[6])
{
    Ex angular[3];
    symmetric_apply(s->dag, s->inverse[body] + 1, x, angular);
    memcpy(x, angular, sizeof angular);
    ex_scale3(s->dag, s->inverse[body][0], x + 3, x + 3);
}

static void open_body(System *s, int b)
{
    Whole *whole = s->whole;
    Dag *dag = s->dag;
    const Body *body = &whole->model->body[b];
    const Motion *own = &whole->motion[b];
    Motion *m = &s->motion[b];
    Vector com = whole_point(whole, b, body->com);
    Ex J[6], t[3], gyroscopic[3];
    memcpy(m->A, own->A, sizeof m->A);
    memcpy(m->c, com.v, sizeof m->c);
    ex_add3(dag, whole->turn, own->omega, m->omega);
    ex_cross(dag, whole->turn, com.v, m->velocity);
    ex_add3(dag, m->velocity, com.rate, m->velocity);
    whole_inertia(whole, b, J);
    if (b == BODY_BASE) {
        memcpy(s->base_inertia, J, sizeof s->base_inertia);
    } else {
        s->inverse[b][0] = ex_div(dag, ex_literal(dag, 1), whole_number(whole, &body->mass));
        inverse_inertia(s, b, s->inverse[b] + 1);
    }
    symmetric_apply(dag, J, m->omega, t);
    ex_cross(dag, m->omega, t, gyroscopic);
    memcpy(s->wrench[b], s->loads->wrench[b], sizeof s->wrench[b]);
    ex_cross(dag, com.arm, s->wrench[b] + 3, t);
    ex_sub3(dag, s->wrench[b], t, s->wrench[b]);
    ex_sub3(dag, s->wrench[b], gyroscopic, s->wrench[b]);
}

/* ---- equations ------------------------------------------------------------------------------------------- */

/* Add `factor` times what a row has to do with its bodies. */
static void add_sides(System *s, Equation *equation, const Row *row, const int body[2], Ex factor)
{
    Dag *dag = s->dag;
    for (int end = 0; end < 2; ++end) {
        Side *side = equation->side;
        while (side < equation->side + equation->sides && side->body != body[end])
            ++side;
        if (side == equation->side + equation->sides) {
            side = POOL_PUSH(dag->pool, equation->side, equation->sides);
            *side = (Side){.body = body[end]};
        }
        for (int i = 0; i < 6; ++i)
            side->J[i] = ex_add(dag, side->J[i], ex_mul(dag, factor, row->J[end][i]));
    }
}

static void solve_sides(System *s, Equation *equation)
{
    for (Side *side = equation->side; side < equation->side + equation->sides; ++side) {
        memcpy(side->Z, side->J, sizeof side->Z);
        if (side->body != BODY_BASE)
            solve_body(s, side->body, side->Z);
    }
}

static void open_equation(System *s, Equation *equation, const Row *row, const int body[2], int coordinate,
                          int multiplier, bool wanted)
{
    *equation = (Equation){.dual = row->dual,
                           .bias = row->bias,
                           .coordinate = coordinate,
                           .multiplier = multiplier,
                           .wanted = wanted,
                           .held = ex_literal(s->dag, 0)};
    add_sides(s, equation, row, body, ex_literal(s->dag, 1));
}

static Row row_of_coordinate(const System *s, int index, const double (*origin)[3])
{
    const Coordinate *coordinate = &s->whole->model->coordinate[index];
    const Motion *const end[2] = {&s->motion[coordinate->body[0]], &s->motion[coordinate->body[1]]};
    Fixture fixture = whole_coordinate_fixture(s->whole, coordinate, origin);
    return coordinate_row(s->dag, coordinate->type, &fixture, end, s->whole->x[index], s->whole->xd[index]);
}

/* The row of a joint with a formula f: J q'' + dual f'' + bias = 0, f'' = sum slope w'' + second. Accelerations of free
 * coordinates come from their own rows, J_w q'' + dual_w w'' + bias_w = 0. */
static void open_coupler(System *s, int index, const double (*origin)[3], int multiplier)
{
    const Model *model = s->whole->model;
    Dag *dag = s->dag;
    const Joint *joint = &model->joint[index];
    const Motion *const end[2] = {&s->motion[joint->body[0]], &s->motion[joint->body[1]]};
    Fixture fixture = whole_joint_fixture(s->whole, joint, origin);
    const Coupling f = whole_coupling(s->whole, joint);
    const Row row = coordinate_row(dag, (CoordinateType)joint_measure(joint->type), &fixture, end, f.x, f.rate);
    const Ex *driven = whole_driven_accelerations(s->whole);
    Equation *equation = &s->equation[s->equations++];
    bool wanted = reaction_wanted(model, index);
    for (int w = 0; w < model->coordinates; ++w)
        wanted = wanted || (joint_follows(joint, w) && drive_wanted(model, w));
    open_equation(s, equation, &row, joint->body, -1, multiplier, wanted);
    equation->bias = ex_add(dag, equation->bias, ex_mul(dag, row.dual, f.second));
    for (int w = 0; w < model->coordinates; ++w) {
        const Ex share = ex_mul(dag, row.dual, f.slope[w]);
        if (model->coordinate[w].driven) {
            equation->bias = ex_add(dag, equation->bias, ex_mul(dag, share, driven[w]));
        } else if (!ex_is(dag, share, 0)) {
            const Row own = row_of_coordinate(s, w, origin);
            const Ex factor = ex_neg(dag, ex_div(dag, share, own.dual));
            add_sides(s, equation, &own, model->coordinate[w].body, factor);
            equation->bias = ex_add(dag, equation->bias, ex_mul(dag, factor, own.bias));
        }
    }
    solve_sides(s, equation);
}

static int open_joint(System *s, int index, const double (*origin)[3], int multiplier)
{
    const Joint *joint = &s->whole->model->joint[index];
    if (joint->value) {
        open_coupler(s, index, origin, multiplier);
        return 1;
    }
    const Motion *const end[2] = {&s->motion[joint->body[0]], &s->motion[joint->body[1]]};
    Fixture fixture = whole_joint_fixture(s->whole, joint, origin);
    Row row[ROWS_MAX];
    int rows = joint_rows(s->dag, joint->type, &fixture, end, sequence_known_end(s->whole->plan->sequence, joint), row);
    for (int r = 0; r < rows; ++r) {
        Equation *equation = &s->equation[s->equations++];
        open_equation(s, equation, &row[r], joint->body, -1, multiplier + r, reaction_wanted(s->whole->model, index));
        solve_sides(s, equation);
    }
    return rows;
}

/* A force Q along a coordinate, share = Q / dual, acts on the bodies as -J^T share. */
static void push_along(System *s, const Row *row, const int body[2], Ex share)
{
    Dag *dag = s->dag;
    Ex t[3];
    for (int end = 0; end < 2; ++end)
        for (int part = 0; part < 6; part += 3) {
            Ex *wrench = s->wrench[body[end]] + part;
            ex_scale3(dag, share, row->J[end] + part, t);
            ex_sub3(dag, wrench, t, wrench);
        }
}

static void open_coordinate(System *s, int index, const double (*origin)[3], int multiplier)
{
    Whole *whole = s->whole;
    const Coordinate *coordinate = &whole->model->coordinate[index];
    const Row row = row_of_coordinate(s, index, origin);
    Equation *equation = coordinate->driven ? &s->equation[s->equations++] : &s->free[s->frees++];
    open_equation(s, equation, &row, coordinate->body, index, multiplier, drive_wanted(whole->model, index));
    solve_sides(s, equation);
    const Ex share = ex_div(s->dag, s->loads->own[index], row.dual);
    /* a drive holds what acts along its coordinate, and nothing moves by it: among the wrenches it would leave rounding
     */
    if (coordinate->driven)
        equation->held = share;
    else
        push_along(s, &row, coordinate->body, share);
}

static System open_system(Whole *whole)
{
    const Model *model = whole->model;
    const Plan *plan = whole->plan;
    Pool *pool = whole->dag->pool;
    size_t bodies = (size_t)model->bodies;
    int most = ROWS_MAX * model->joints + model->coordinates + 1;
    System s = {.whole = whole,
                .dag = whole->dag,
                .loads = loads_make(whole),
                .motion = pool_alloc(pool, bodies * sizeof *s.motion),
                .inverse = pool_alloc(pool, bodies * sizeof *s.inverse),
                .wrench = pool_alloc(pool, bodies * sizeof *s.wrench),
                .acceleration = pool_alloc(pool, bodies * sizeof *s.acceleration),
                .equation = pool_alloc(pool, (size_t)most * sizeof *s.equation),
                .free = pool_alloc(pool, (size_t)(model->coordinates + 1) * sizeof *s.free)};
    double(*origin)[3] = pool_alloc(pool, bodies * sizeof *origin);
    for (int b = 0; b < model->bodies; ++b) {
        memcpy(origin[b], model->body[b].com, sizeof origin[b]);
        tuning_copy(model, origin[b], model->body[b].com, 3);
        open_body(&s, b);
    }
    for (int k = 0; k < plan->sequence->subsets; ++k) {
        const Subset *subset = &plan->sequence->subset[k];
        int place = plan->multiplier_offset[subset->body[0]];
        for (int i = 0; i < subset->joints; ++i)
            place += open_joint(&s, subset->joint[i], (const double(*)[3])origin, place);
        for (int i = 0; i < subset->coordinates; ++i)
            open_coordinate(&s, subset->coordinate[i], (const double(*)[3])origin, place++);
    }
    if (!model->free_base) /* a fixed base accelerates against gravity */
        ex_sub3(s.dag, s.acceleration[BODY_BASE] + 3, whole->gravity, s.acceleration[BODY_BASE] + 3);
    s.lambda = pool_alloc(pool, (size_t)(s.equations + 1) * sizeof *s.lambda);
    s.unknowns = s.equations + (model->free_base ? 6 : 0);
    return s;
}

/* ---- elimination ----------------------------------------------------------------------------------------- */

/* Order of elimination of the equations; the base comes last. Next is always the equation whose elimination fills in
 * the fewest zero entries of H, of equals the one with the fewest neighbours, of these the last one in the
 * computational sequence. So leaves of the topology come first. */
static int *topology_order(const System *s, const Ex *H)
{
    const int n = s->unknowns;
    bool *near = pool_alloc(s->dag->pool, ((size_t)n * (size_t)n + 1) * sizeof *near);
    int *order = pool_alloc(s->dag->pool, ((size_t)n + 1) * sizeof *order);
    int *left = pool_alloc(s->dag->pool, ((size_t)n + 1) * sizeof *left);
    for (int i = 0; i < n; ++i) {
        order[i] = i;
        for (int j = i + 1; j < n; ++j)
            near[n * i + j] = near[n * j + i] = !ex_is(s->dag, H[n * i + j], 0);
    }
    for (int step = 0; step < s->equations; ++step) {
        int best = 0, best_fill = 0, best_degree = 0;
        for (int at = s->equations - 1; at >= step; --at) {
            const bool *row = &near[(size_t)n * (size_t)order[at]];
            int degree = 0, fill = 0;
            for (int j = step; j < n; ++j)
                if (row[order[j]])
                    left[degree++] = order[j];
            for (int j = 0; j < degree; ++j)
                for (int k = j + 1; k < degree; ++k)
                    fill += !near[n * left[j] + left[k]];
            if (at == s->equations - 1 || fill < best_fill || (fill == best_fill && degree < best_degree)) {
                best = at;
                best_fill = fill;
                best_degree = degree;
            }
        }
        /* its neighbours become neighbours of each other */
        const int next = order[best];
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n && near[n * next + i]; ++j)
                near[n * i + j] |= near[n * next + j] && i != j;
        for (int i = 0; i < n; ++i)
            near[n * next + i] = near[n * i + next] = false;
        memmove(&order[step + 1], &order[step], (size_t)(best - step) * sizeof *order);
        order[step] = next;
    }
    return order;
}

static Ex dot6(Dag *dag, const Ex *a, const Ex *b)
{
    return ex_add(dag, ex_dot(dag, a, b), ex_dot(dag, a + 3, b + 3));
}

/* Upper triangle of the matrix after the bodies are eliminated. */
static Ex *reduced_matrix(const System *s)
{
    static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    Dag *dag = s->dag;
    int n = s->unknowns, base = s->equations;
    Ex *H = pool_alloc(dag->pool, ((size_t)n * (size_t)n + 1) * sizeof *H);
    for (int i = 0; i < s->equations; ++i) {
        const Equation *a = &s->equation[i];
        for (int j = i; j < s->equations; ++j)
            for (int k = 0; k < a->sides * s->equation[j].sides; ++k) {
                const Side *own = &a->side[k / s->equation[j].sides];
                const Side *other = &s->equation[j].side[k % s->equation[j].sides];
                if (own->body == other->body && own->body != BODY_BASE)
                    H[n * i + j] = ex_add(dag, H[n * i + j], dot6(dag, own->J, other->Z));
            }
        for (const Side *side = a->side; side < a->side + a->sides; ++side)
            if (side->body == BODY_BASE)
                for (int j = base; j < n; ++j)
                    H[n * i + j] = side->J[j - base];
    }
    for (int i = base; i < n; ++i)
        for (int j = i; j < base + 3; ++j)
            H[n * i + j] = ex_neg(dag, s->base_inertia[place[i - base][j - base]]);
    for (int i = base + 3; i < n; ++i)
        H[n * i + i] = ex_neg(dag, whole_number(s->whole, &s->whole->model->body[BODY_BASE].mass));
    return H;
}

/* Residual of an equation at the present accelerations, without that of its free coordinate. */
static Ex deviation(const System *s, const Equation *equation, const Ex *driven)
{
    Dag *dag = s->dag;
    Ex sum = equation->bias;
    for (const Side *side = equation->side; side < equation->side + equation->sides; ++side)
        sum = ex_add(dag, sum, dot6(dag, side->J, s->acceleration[side->body]));
    if (equation->coordinate >= 0)
        sum = ex_add(dag, sum, ex_mul(dag, equation->dual, driven[equation->coordinate]));
    return sum;
}

/* Residuals of all equations at the present multipliers and accelerations. */
static void shortfall(const System *s, const Ex *driven, Ex *out)
{
    Dag *dag = s->dag;
    for (int i = 0; i < s->equations; ++i)
        out[i] = ex_neg(dag, deviation(s, &s->equation[i], driven));
    if (s->unknowns == s->equations)
        return;
    Ex *base = out + s->equations, t[3];
    const Ex *acceleration = s->acceleration[BODY_BASE];
    symmetric_apply(dag, s->base_inertia, acceleration, base);
    ex_scale3(dag, whole_number(s->whole, &s->whole->model->body[BODY_BASE].mass), acceleration + 3, base + 3);
    for (int part = 0; part < 6; part += 3)
        ex_sub3(dag, base + part, s->wrench[BODY_BASE] + part, base + part);
    for (int i = 0; i < s->equations; ++i)
        for (int k = 0; k < s->equation[i].sides; ++k)
            for (int part = 0; part < 6 && s->equation[i].side[k].body == BODY_BASE; part += 3) {
                ex_scale3(dag, s->lambda[i], s->equation[i].side[k].J + part, t);
                ex_sub3(dag, base + part, t, base + part);
            }
}

/* Add a correction to the multipliers and to the acceleration of a free base, and the resulting one to the bodies'
 * accelerations. */
static void add_solution(System *s, const Ex *x)
{
    Dag *dag = s->dag;
    Ex t[3];
    for (int i = 0; i < s->equations; ++i) {
        s->lambda[i] = ex_add(dag, s->lambda[i], x[i]);
        for (int k = 0; k < s->equation[i].sides; ++k) {
            const Side *side = &s->equation[i].side[k];
            Ex *acceleration = s->acceleration[side->body];
            for (int part = 0; part < 6 && side->body != BODY_BASE; part += 3) {
                ex_scale3(dag, x[i], side->Z + part, t);
                ex_add3(dag, acceleration + part, t, acceleration + part);
            }
        }
    }
    for (int i = s->equations; i < s->unknowns; ++i) {
        Ex *acceleration = &s->acceleration[BODY_BASE][i - s->equations];
        *acceleration = ex_add(dag, *acceleration, x[i]);
    }
}

/* The unknowns of the reduced form from the accelerations of the centres of mass. */
static void store_rates(System *s, Block *block, const Ex *driven)
{
    Whole *whole = s->whole;
    Dag *dag = s->dag;
    const Plan *plan = whole->plan;
    Ex *z = pool_alloc(dag->pool, (size_t)(plan->unknowns + 1) * sizeof *z), t[3];
    if (whole->model->free_base) {
        /* a of the base's origin: that of the centre of mass less alpha x arm + turn x (turn x arm) */
        const Motion *base = &s->motion[BODY_BASE];
        const Ex *acceleration = s->acceleration[BODY_BASE];
        memcpy(z, acceleration, 3 * sizeof *z);
        ex_cross(dag, acceleration, base->c, t);
        ex_sub3(dag, acceleration + 3, t, z + 3);
        ex_cross(dag, base->omega, base->velocity, t);
        ex_sub3(dag, z + 3, t, z + 3);
    }
    for (int i = 0; i < s->frees; ++i) {
        const Equation *equation = &s->free[i];
        z[plan->coordinate_unknown[equation->coordinate]] =
            ex_neg(dag, ex_div(dag, deviation(s, equation, driven), equation->dual));
    }
    whole_store_rates(whole, block, z);
}

/* The subset that a joint or coordinate belongs to: of the subsets it connects the one solved last; -1: none. */
static int equation_subset(const Whole *whole, const Equation *equation)
{
    int last = -1;
    for (int k = 0; k < equation->sides; ++k) {
        const int own = whole->plan->sequence->body_subset[equation->side[k].body];
        last = own > last ? own : last;
    }
    return last;
}

/* Multipliers between heavy bodies are large, and their rounding disturbs light ones: beyond this ratio of masses by
 * more than the 1e-8 of FORMAT.md section 14, and no pivot shows it. */
const double augmented_most_mass = 1e9;

static void refuse_unequal_masses(const Model *model)
{
    const double most = augmented_most_mass;
    const Body *light = NULL, *heavy = NULL;
    for (int b = model->free_base ? 0 : 1; b < model->bodies; ++b) {
        const Body *body = &model->body[b];
        light = !light || body->mass < light->mass ? body : light;
        heavy = !heavy || body->mass > heavy->mass ? body : heavy;
    }
    if (heavy && heavy->mass > most * light->mass)
        diag_fail(heavy->at, "use the reduced form, which looks at what is left of every inertia",
                  "body '%s' has more than %g times the mass of '%s': the augmented form of the equations of motion "
                  "would lose digits that accelerations are promised to have",
                  heavy->name, most, light->name);
}

Block *augmented_block(Whole *whole)
{
    /* smallest pivot relative to its diagonal entry; below it the equation is nearly dependent, and too few digits are
     * left for the second pass */
    const double independent = 1e-11;
    /* the second pass restores the digits that J M^-1 J^T loses, whose condition is the square of J's */
    const int passes = 2;
    Dag *dag = whole->dag;
    if (model_massless(whole->model))
        diag_fail((Place){whole->model->source, 0, 0}, "use the reduced form",
                  "the augmented form of the equations of motion needs the mass of '%s'", model_massless(whole->model));
    refuse_unequal_masses(whole->model);
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    block->model = whole->model->name;
    System s = open_system(whole);
    for (int b = 0; b < whole->model->bodies; ++b)
        block_loads(block, s.loads->wrench[b], 6);
    block_loads(block, s.loads->own, whole->model->coordinates);
    const Ex *driven = whole_driven_accelerations(whole), *H = reduced_matrix(&s);
    Ex *x = pool_alloc(dag->pool, (size_t)(s.unknowns + 1) * sizeof *x);
    const Factors *factors = linear_factor_symmetric(dag, s.unknowns, H, topology_order(&s, H), 0);
    for (int k = 0; k < s.equations; ++k) {
        Ex diagonal = H[s.unknowns * factors->row[k] + factors->row[k]];
        const Ex left = ex_sub(dag, factors->pivot[k], ex_mul(dag, ex_literal(dag, independent), diagonal));
        if (dag->node[factors->pivot[k]].level == LEVEL_VARIABLE)
            block_check_about(block, left, GIC_ERROR_SINGULAR, equation_subset(whole, &s.equation[factors->row[k]]),
                              -1);
    }
    for (int b = 1; b < whole->model->bodies; ++b) {
        memcpy(s.acceleration[b], s.wrench[b], sizeof s.acceleration[b]);
        solve_body(&s, b, s.acceleration[b]);
    }
    for (int pass = 0; pass < passes; ++pass) {
        shortfall(&s, driven, x);
        linear_solve(dag, factors, x, x);
        add_solution(&s, x);
    }
    store_rates(&s, block, driven);
    for (int i = 0; i < s.equations; ++i)
        if (s.equation[i].wanted)
            block_store(block, ex_add(dag, s.lambda[i], s.equation[i].held),
                        element_at(ARRAY_lambda, s.equation[i].multiplier));
    return block;
}
