/* SPDX-License-Identifier: MIT
 *
 * Recovery of one class of decoupled subsets: Newton's iteration in twists relative to the base, velocities and
 * accelerations from the same factorization, and the contribution of the bodies to the equations of motion.
 * Unknowns of a body are the six components of its twist at its reference point. That point is on a joint that
 * connects the body to something known: the joint's equations are then unit rows, which the factorization folds
 * away. */
#include "base/message.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

const Subset *subset_member(const Work *w, int i)
{
    return &w->sequence->subset[w->class->member[i]];
}

static int place_of(const int *list, int count, int what)
{
    for (int i = 0; i < count; ++i)
        if (list[i] == what)
            return i;
    return -1;
}

/* ---- the class's data --------------------------------------------------------------------------------------- */

Ex subset_number(Work *w, const double *value, const Ex *formula)
{
    int members = w->class->members, slot = 0;
    Ex own[members], opposite[members];
    bool any = false;
    for (int i = 0; i < members; ++i)
        any = any || formula[i];
    if (!any)
        return ex_constant(w->dag, value);
    Dag *derive = w->model->tuning->dag;
    for (int i = 0; i < members; ++i) {
        own[i] = formula[i] ? formula[i] : ex_literal(derive, value[i]);
        opposite[i] = ex_neg(derive, own[i]);
    }
    const Ex *known = w->derived_of;
    while (slot < w->derived && memcmp(known, own, sizeof own) && memcmp(known, opposite, sizeof opposite))
        ++slot, known += members;
    bool negative = slot < w->derived && memcmp(known, own, sizeof own);
    if (slot == w->derived) {
        size_t row = sizeof own, size = (size_t)w->derived++ * row;
        w->derived_of = pool_grow(w->pool, w->derived_of, size, size + row);
        memcpy(w->derived_of + (size_t)slot * (size_t)members, own, row);
    }
    double sample[w->dag->samples];
    for (int s = 0; s < w->dag->samples; ++s)
        sample[s] = negative ? -value[s / w->configurations] : value[s / w->configurations];
    Ex number = ex_input(w->dag, element_at(ARRAY_d, slot), sample);
    return negative ? ex_neg(w->dag, number) : number;
}

Ex subset_constant(Work *w, SubsetNumber *get, int a, int b)
{
    double value[w->class->members];
    Ex formula[w->class->members];
    for (int i = 0; i < w->class->members; ++i) {
        formula[i] = 0;
        value[i] = get(w, i, a, b, &formula[i]);
    }
    return subset_number(w, value, formula);
}

static void make_fixture(Work *w, Connection *tie, int position)
{
    int members = w->class->members;
    double number[members][FIXTURE_NUMBERS], value[members];
    Ex tuned_number[members][FIXTURE_NUMBERS], formula[members];
    for (int i = 0; i < members; ++i) {
        const Subset *subset = subset_member(w, i);
        if (tie->is_coordinate) {
            const Coordinate *coordinate = &w->model->coordinate[subset->coordinate[position]];
            fixture_of_coordinate(coordinate, w->origin, number[i]);
            fixture_tuned_coordinate(w->model, coordinate, w->origin, tuned_number[i]);
        } else {
            const Joint *joint = &w->model->joint[subset->joint[position]];
            fixture_of_joint(joint, w->origin, number[i]);
            fixture_tuned_joint(w->model, joint, w->origin, tuned_number[i]);
        }
    }
    Ex *out = (Ex *)&tie->fixture;
    for (int j = 0; j < FIXTURE_NUMBERS; ++j) {
        for (int i = 0; i < members; ++i) {
            value[i] = number[i][j];
            formula[i] = tuned_number[i][j];
        }
        out[j] = subset_number(w, value, formula);
        ex_describe(w->dag, out[j], "%s.%s", connection_name(w, tie), fixture_name(j));
    }
}

const char *connection_name(const Work *w, const Connection *tie)
{
    return tie->is_coordinate ? w->model->coordinate[tie->index].name : w->model->joint[tie->index].name;
}

static End end_of(const Work *w, int body)
{
    if (body == BODY_BASE)
        return (End){-1, -1};
    int unknown = place_of(w->first->body, w->first->bodies, body);
    return (End){unknown, unknown < 0 ? place_of(w->first->known, w->first->knowns, body) : -1};
}

static void make_connections(Work *w)
{
    const Subset *first = w->first;
    w->connections = first->joints + first->coordinates;
    w->connection = pool_alloc(w->pool, (size_t)w->connections * sizeof *w->connection);
    for (int i = 0; i < w->connections; ++i) {
        Connection *tie = &w->connection[i];
        tie->is_coordinate = i >= first->joints;
        int position = tie->is_coordinate ? i - first->joints : i;
        tie->index = tie->is_coordinate ? first->coordinate[position] : first->joint[position];
        const int *body = tie->is_coordinate ? w->model->coordinate[tie->index].body : w->model->joint[tie->index].body;
        for (int end = 0; end < 2; ++end)
            tie->end[end] = end_of(w, body[end]);
        if (tie->is_coordinate)
            tie->dep = place_of(first->dep, first->deps, tie->index);
        tie->measure = tie->is_coordinate ? (int)w->model->coordinate[tie->index].type
                                          : joint_measure(w->model->joint[tie->index].type);
        make_fixture(w, tie, position);
    }
}

static Ex *make_inputs(Work *w, Array array, int count)
{
    Ex *e = pool_alloc(w->pool, (size_t)(count ? count : 1) * sizeof *e);
    for (int i = 0; i < count; ++i)
        e[i] = ex_input(w->dag, element_at(array, i), NULL);
    return e;
}

/* The number of a known's coordinates among those of the subset; 0 for a carrier. */
static int known_deps(const Work *w, int known)
{
    const int body = w->first->known[known];
    return body == w->first->carrier ? 0 : w->sequence->subset[w->sequence->body_subset[body]].deps;
}

/* S of a known is ordered by the coordinates of its own subset: reorder it. */
static void order_by_deps(Work *w, int known)
{
    Motion *m = &w->known[known];
    const Subset *own = &w->sequence->subset[w->sequence->body_subset[w->first->known[known]]];
    Ex *S = pool_alloc(w->pool, (size_t)(6 * w->first->deps) * sizeof *S);
    for (int j = 0; j < known_deps(w, known); ++j)
        memcpy(S + 6 * place_of(w->first->dep, w->first->deps, own->dep[j]), m->S + 6 * j, 6 * sizeof *S);
    m->S = S;
    m->deps = w->first->deps;
}

static void make_motions(Work *w)
{
    const Subset *first = w->first;
    motion_base(w->dag, &w->base);
    w->known = pool_alloc(w->pool, (size_t)(first->knowns + 1) * sizeof *w->known);
    for (int i = 0; i < first->knowns; ++i) {
        motion_input(w->dag, &w->known[i], ARRAY_known, i, 0, 1, known_deps(w, i));
        order_by_deps(w, i);
    }
    w->q = make_inputs(w, ARRAY_q, 7 * first->bodies);
    w->pose = pool_alloc(w->pool, (size_t)first->bodies * sizeof *w->pose);
    for (int b = 0; b < first->bodies; ++b) {
        memcpy(w->pose[b].c, w->q + 7 * b, sizeof w->pose[b].c);
        ex_rotation(w->dag, w->q + 7 * b + 3, w->pose[b].A);
    }
    w->x = make_inputs(w, ARRAY_x, first->deps);
    w->rate = make_inputs(w, ARRAY_rate, first->deps);
    w->change = make_inputs(w, ARRAY_change, first->deps);
}

/* ---- equations ------------------------------------------------------------------------------------------------ */

const Motion *subset_motion(const Work *w, const Motion *unknown, End end)
{
    return end.unknown >= 0                               ? &unknown[end.unknown]
           : end.known >= 0 && (w->plain || !w->anchored) ? &w->known[end.known]
                                                          : &w->base;
}

/* All rows of the subset for the given motions of the unknowns; row_of: the connection of each row. */
static void make_rows(Work *w, const Motion *unknown, Row *row, int *row_of)
{
    int rows = 0;
    for (int i = 0; i < w->connections; ++i) {
        const Connection *tie = &w->connection[i];
        const Motion *end[2] = {subset_motion(w, unknown, tie->end[0]), subset_motion(w, unknown, tie->end[1])};
        Motion turned;
        int made = 1;
        if (tie->still && !w->plain) {
            turned = *end[0];
            for (int j = 0; j < 2; ++j)
                motion_side(w->dag, &turned, tie->fixture.side[j][0], tie->across[j]);
            end[0] = &turned;
        }
        if (tie->measure >= 0) {
            row[rows] = coordinate_row(w->dag, (CoordinateType)tie->measure, &tie->fixture, end, tie->x, tie->rate);
            if (!w->plain)
                subset_hinge_row(w, tie, end, &row[rows]);
            if (tie->second)
                row[rows].bias = ex_add(w->dag, row[rows].bias, ex_mul(w->dag, row[rows].dual, tie->second));
        } else {
            made = joint_rows(w->dag, w->model->joint[tie->index].type, &tie->fixture, end,
                              tie->end[0].unknown >= 0 && tie->end[1].unknown < 0, row + rows);
        }
        for (int r = 0; r < made; ++r)
            row_of[rows++] = i;
    }
}

void subset_rows(Work *w, const Motion *unknown, Row *row, int *row_of)
{
    make_rows(w, unknown, row, row_of);
}

/* Columns of the unknowns, [n][n]. */
static void make_jacobian(const Work *w, const Row *row, const int *row_of, Ex *J)
{
    for (int r = 0; r < w->n; ++r)
        for (int end = 0; end < 2; ++end) {
            int body = w->connection[row_of[r]].end[end].unknown;
            for (int j = 0; body >= 0 && j < 6; ++j)
                J[w->n * r + 6 * body + j] = row[r].J[end][j];
        }
}

/* ---- factorization ------------------------------------------------------------------------------------------ */

/* Pivots are chosen at all samples, or at the design only if others are singular, which scan_ranges.c has reported. */
static Factors *factor(Work *w)
{
    double unknown_scale[w->n];
    bool design[w->dag->samples];
    for (int j = 0; j < w->n; ++j)
        unknown_scale[j] = j % 6 < 3 ? w->size : 1;
    Factors *f = linear_factor(w->dag, w->n, w->J, unknown_scale, w->alive);
    if (f)
        return f;
    for (int s = 0; s < w->dag->samples; ++s)
        design[s] = s % w->configurations == 0;
    f = linear_factor(w->dag, w->n, w->J, unknown_scale, design);
    if (f)
        return f;
    Place at = w->model->body[w->first->body[0]].at;
    diag_fail(at, "move the points or axes of its joints a little",
              "the equations of body '%s' are too near to singular", w->model->body[w->first->body[0]].name);
}

/* ---- blocks */

/* q moved by a twist: linear in the step, normalized to second order, so that repeated corrections converge to unit
 * length. */
static void moved(Work *w, const Ex *q, const Ex twist[6], Ex out[7])
{
    Dag *dag = w->dag;
    Ex half = ex_literal(dag, 0.5), t[3], cross[3], p[4];
    ex_add3(dag, q, twist + 3, out);
    ex_scale3(dag, half, twist, t);
    ex_cross(dag, t, q + 4, cross);
    p[0] = ex_sub(dag, q[3], ex_dot(dag, t, q + 4));
    for (int i = 0; i < 3; ++i)
        p[1 + i] = ex_add(dag, q[4 + i], ex_add(dag, ex_mul(dag, q[3], t[i]), cross[i]));
    Ex square = ex_add(dag, ex_mul(dag, p[0], p[0]), ex_dot(dag, p + 1, p + 1));
    Ex scale = ex_sub(dag, ex_literal(dag, 1.5), ex_mul(dag, half, square));
    for (int i = 0; i < 4; ++i)
        out[3 + i] = ex_mul(dag, p[i], scale);
}

/* Squared size of twists relative to the subset's size. */
static Ex relative_square(Work *w, const Ex *twist)
{
    Dag *dag = w->dag;
    Ex angular = 0, linear = 0;
    for (int b = 0; b < w->first->bodies; ++b) {
        angular = ex_add(dag, angular, ex_dot(dag, twist + 6 * b, twist + 6 * b));
        linear = ex_add(dag, linear, ex_dot(dag, twist + 6 * b + 3, twist + 6 * b + 3));
    }
    return ex_add(dag, angular, ex_mul(dag, ex_literal(dag, 1 / (w->size * w->size)), linear));
}

static void store_moved(Work *w, Block *block, const Ex *twist, Ex *moved_q)
{
    static const Ex zero[3];
    for (int b = 0; b < w->first->bodies; ++b) {
        moved(w, w->q + 7 * b, twist + 6 * b, moved_q + 7 * b);
        if (!memcmp(twist + 6 * b, zero, sizeof zero))
            memcpy(moved_q + 7 * b + 3, w->q + 7 * b + 3, 4 * sizeof *moved_q);
        for (int i = 7 * b; i < 7 * b + 7; ++i)
            if (moved_q[i] != w->q[i])
                block_store(block, moved_q[i], element_at(ARRAY_q, i));
    }
}

static void make_predict(Work *w, Formula *formula)
{
    Ex *s = make_inputs(w, ARRAY_s, w->n * w->first->deps), twist[w->n], q[7 * w->first->bodies];
    for (int i = 0; i < w->n; ++i) {
        const bool stays = (i % 6 < 3 ? subset_presolves_rotation : subset_presolves_point)(w, i / 6);
        twist[i] = 0;
        for (int j = 0; j < w->first->deps && !stays; ++j)
            twist[i] =
                ex_add(w->dag, twist[i], ex_mul(w->dag, s[(i / 6 * w->first->deps + j) * 6 + i % 6], w->change[j]));
    }
    store_moved(w, &formula->predict, twist, q);
    block_store(&formula->predict, relative_square(w, twist), element_at(ARRAY_reach, 0));
}

/* A number of the factors as an input f[...] if it varies. Equal and opposite numbers are stored once. */
static Ex remembered(Work *w, Ex e, Ex *stored, int *count)
{
    if (w->dag->node[e].level < LEVEL_VARIABLE)
        return e;
    const Ex positive = w->dag->node[e].op == OP_NEG ? w->dag->node[e].arg[0] : e;
    int slot = 0;
    while (slot < *count && stored[slot] != positive)
        ++slot;
    if (slot == *count)
        stored[(*count)++] = positive;
    const Ex input = ex_input(w->dag, element_at(ARRAY_f, slot), NULL);
    return positive == e ? input : ex_neg(w->dag, input);
}

/* The factors as inputs f[...] if they vary. stored [n (n + 2)]: the numbers to write there. */
static Factors *factors_from_memory(Work *w, const Factors *factors, Ex *stored, int *count)
{
    Factors *f = pool_alloc(w->pool, sizeof *f);
    const size_t n = (size_t)w->n;
    *f = *factors;
    f->matrix = NULL;
    f->entry = pool_alloc(w->pool, n * n * sizeof *f->entry);
    f->reciprocal = pool_alloc(w->pool, n * sizeof *f->reciprocal);
    f->beta = pool_alloc(w->pool, n * sizeof *f->beta);
    *count = 0;
    for (size_t i = 0; i < n * n; ++i)
        f->entry[i] = remembered(w, factors->entry[i], stored, count);
    for (size_t k = 0; k < n; ++k)
        if (factors->beta[factors->block[k]]) {
            f->reciprocal[k] = remembered(w, factors->reciprocal[k], stored, count);
            f->beta[k] = remembered(w, factors->beta[k], stored, count);
        }
    return f;
}

static void make_step(Work *w, const Factors *factors, Block *block, Ex *moved_q)
{
    Ex b[w->n];
    for (int r = 0; r < w->n; ++r)
        b[r] = ex_neg(w->dag, w->row[r].value);
    linear_solve(w->dag, factors, b, b);
    store_moved(w, block, b, moved_q);
    block_store(block, relative_square(w, b), element_at(ARRAY_step, 0));
}

/* Right-hand side for the unit rate of coordinate j. */
static void unit_rate(Work *w, int j, Ex *b)
{
    for (int r = 0; r < w->n; ++r) {
        const Connection *tie = &w->connection[w->row_of[r]];
        Ex sum = subset_dual(w, tie, &w->row[r], j);
        for (int end = 0; end < 2; ++end)
            if (tie->end[end].known >= 0 && !w->anchored)
                for (int i = 0; i < 6; ++i)
                    sum = ex_add(w->dag, sum,
                                 ex_mul(w->dag, w->row[r].J[end][i], w->known[tie->end[end].known].S[6 * j + i]));
        b[r] = ex_neg(w->dag, sum);
    }
}

/* S, then velocities and accelerations of the unknowns at q. */
static void make_motion(Work *w, const Factors *factors, Motion *motion)
{
    Dag *dag = w->dag;
    const Subset *first = w->first;
    Ex b[w->n];
    for (int body = 0; body < first->bodies; ++body) {
        motion[body] = w->pose[body];
        motion[body].deps = first->deps;
        motion[body].S = pool_alloc(w->pool, (size_t)(6 * first->deps + 1) * sizeof *motion[body].S);
    }
    dag_section(dag,
                "velocities: of the bodies, with a unit rate of each coordinate and with the rates that there are");
    for (int j = 0; j < first->deps; ++j) {
        unit_rate(w, j, b);
        linear_solve(dag, factors, b, b);
        for (int i = 0; i < w->n; ++i) {
            Motion *m = &motion[i / 6];
            Ex *rate = i % 6 < 3 ? &m->omega[i % 3] : &m->velocity[i % 3];
            m->S[6 * j + i % 6] = b[i];
            *rate = ex_add(dag, *rate, ex_mul(dag, b[i], w->rate[j]));
        }
    }
    /* again with rates, for the quadratic-velocity terms */
    dag_section(dag, "quadratic-velocity terms: accelerations of the bodies while those of the coordinates are 0");
    Row *row = pool_alloc(w->pool, (size_t)w->n * sizeof *row);
    make_rows(w, motion, row, w->row_of);
    for (int r = 0; r < w->n; ++r)
        b[r] = ex_neg(dag, row[r].bias);
    linear_solve(dag, factors, b, b);
    for (int i = 0; i < w->n; ++i)
        *(i % 6 < 3 ? &motion[i / 6].alpha[i % 3] : &motion[i / 6].acceleration[i % 3]) = b[i];
}

static void store_motion(Block *block, const Motion *m, int offset)
{
    const struct {
        const Ex *e;
        int offset, count;
    } part[] = {{m->c, MOTION_C, 3},          {m->A, MOTION_A, 9},
                {m->omega, MOTION_OMEGA, 3},  {m->velocity, MOTION_VELOCITY, 3},
                {m->alpha, MOTION_ALPHA, 3},  {m->acceleration, MOTION_ACCELERATION, 3},
                {m->S, MOTION_S, 6 * m->deps}};
    for (size_t p = 0; p < sizeof part / sizeof *part; ++p)
        for (int i = 0; i < part[p].count; ++i)
            block_store(block, part[p].e[i], element_at(ARRAY_motion, offset + part[p].offset + i));
}

Work *subset_open(Pool *pool, const Model *model, const Sequence *sequence, const Class *class,
                  const double (*origin)[3], const Sampling *sampling)
{
    Work *w = pool_alloc(pool, sizeof *w);
    const Subset *first = &sequence->subset[class->member[0]];
    *w = (Work){.pool = pool,
                .model = model,
                .sequence = sequence,
                .class = class,
                .first = first,
                .origin = origin,
                .dag = dag_new(pool, class->members, class->members * sampling->configurations),
                .n = 6 * first->bodies,
                .anchored = subset_anchor(model, sequence, class->member[0]) != BODY_BASE,
                .configurations = sampling->configurations};
    size_t n = (size_t)w->n;
    w->row = pool_alloc(pool, n * sizeof *w->row);
    w->row_of = pool_alloc(pool, n * sizeof *w->row_of);
    w->J = pool_alloc(pool, n * n * sizeof *w->J);
    w->alive = pool_alloc(pool, (size_t)w->dag->samples * sizeof *w->alive);
    make_connections(w);
    make_motions(w);
    subset_measures(w);
    w->size = subset_size(w);
    make_rows(w, w->pose, w->row, w->row_of);
    make_jacobian(w, w->row, w->row_of, w->J);
    return w;
}

int subset_index(const Work *w, int subset)
{
    return place_of(w->class->member, w->class->members, subset);
}

/* closed: only factors that reactions need are stored. */
static Layout make_layout(const Work *w, int factors, Solve solve, bool closed)
{
    int bodies = w->first->bodies, deps = w->first->deps;
    int start_S = closed ? 0 : 7 * bodies, start_factors = closed ? 0 : start_S + w->n * deps;
    return (Layout){.bodies = bodies,
                    .deps = deps,
                    .factors = factors,
                    .start_S = start_S,
                    .start_factors = start_factors,
                    .start_size = start_factors + factors,
                    .motion_size = MOTION_S + 6 * deps,
                    .inertia_size = solve != SOLVE_AUGMENTED ? inertia_mass(deps, deps, deps) : 0};
}

static Formula *formula_new(Work *w, bool closed)
{
    Formula *formula = pool_alloc(w->pool, sizeof *formula);
    formula->dag = formula->predict.dag = formula->chord.dag = formula->solve.dag = formula->residual.dag =
        formula->react.dag = w->dag;
    formula->closed = closed;
    formula->size = w->size;
    formula->distance = subset_distance(w) / w->size;
    return formula;
}

/* The equations in the base's frame at the poses found, as multipliers need them: [n]. */
static Row *rows_from_memory(const Work *w, const Formula *formula)
{
    Work in_base = *w;
    in_base.anchored = false;
    Row *row = pool_alloc(w->pool, (size_t)w->n * sizeof *row);
    Motion *found = pool_alloc(w->pool, (size_t)w->first->bodies * sizeof *found);
    for (int b = 0; b < w->first->bodies; ++b) {
        motion_input_pose(w->dag, &found[b], ARRAY_motion, b * formula->layout.motion_size);
        for (int i = 0; i < MOTION_OMEGA; ++i) {
            const Ex e = *motion_number(&formula->motion[b], i);
            if (formula_is_constant(formula, e))
                *motion_number(&found[b], i) = e;
        }
    }
    make_rows(&in_base, found, row, w->row_of);
    return row;
}

static Motion *copy_motions(const Work *w, const Motion *motion)
{
    size_t bodies = (size_t)w->first->bodies;
    return memcpy(pool_alloc(w->pool, bodies * sizeof *motion), motion, bodies * sizeof *motion);
}

/* The last steps of both ways of recovery: motions, inertia, stored factors, residual, multipliers. */
static void finish(Work *w, Formula *formula, Solve solve, const Factors *factors, const Motion *relative)
{
    Motion *motion = pool_alloc(w->pool, (size_t)w->first->bodies * sizeof *motion);
    subset_to_base(w, relative, motion);
    Ex *stored = pool_alloc(w->pool, (size_t)(w->n * (w->n + 2)) * sizeof *stored);
    int count;
    Factors *remembered = factors_from_memory(w, factors, stored, &count);
    Layout *layout = &formula->layout;
    *layout = make_layout(w, count, solve, formula->closed);
    formula->motion = copy_motions(w, motion);
    formula->across = pool_alloc(w->pool, (size_t)(w->connections + 1) * sizeof *formula->across);
    for (int i = 0; i < w->connections; ++i)
        memcpy(formula->across[i], w->connection[i].across, sizeof formula->across[i]);
    const Row *row = rows_from_memory(w, formula);
    subset_residual(w, formula);
    if (solve != SOLVE_AUGMENTED)
        subset_react(w, remembered, row, &formula->react);
    if (formula->closed && !formula->react.stores)
        *layout = make_layout(w, count = 0, solve, true);
    for (int b = 0; b < layout->bodies; ++b) {
        store_motion(&formula->solve, &motion[b], b * layout->motion_size);
        for (int i = 0; !formula->closed && i < 6 * layout->deps; ++i)
            block_store(&formula->solve, relative[b].S[i],
                        element_at(ARRAY_start, layout->start_S + 6 * layout->deps * b + i));
    }
    for (int i = 0; i < count; ++i)
        block_store(&formula->solve, stored[i], element_at(ARRAY_start, layout->start_factors + i));
    dag_section(w->dag, "what the bodies add to the inertia and to the equations of motion");
    formula->body = pool_alloc(w->pool, (size_t)layout->bodies * sizeof *formula->body);
    if (solve != SOLVE_AUGMENTED)
        formula->inertia = subset_inertia(w, layout, motion, formula->body);
    /* a fixed base has no equations of its own */
    for (int i = w->model->free_base || w->first->carrier != BODY_BASE ? 0 : INERTIA_COORDINATE;
         i < layout->inertia_size; ++i)
        block_store(&formula->solve, formula->inertia[i], element_at(ARRAY_inertia, i));
    if (!formula->closed)
        make_step(w, remembered, &formula->chord, pool_alloc(w->pool, (size_t)(7 * layout->bodies) * sizeof(Ex)));
    formula->derived = w->derived;
    formula->derived_of = w->derived_of;
}

/* The same class with the unknowns at other poses [bodies]; its equations are not made yet. */
static Work elsewhere(const Work *w, Motion *pose)
{
    size_t n = (size_t)w->n;
    Work found = *w;
    found.pose = pose;
    found.row = pool_alloc(w->pool, n * sizeof *found.row);
    found.J = pool_alloc(w->pool, n * n * sizeof *found.J);
    return found;
}

/* The equations at q; derivatives with the rows of joints to known bodies fulfilled. */
static Work held(Work *w)
{
    Row *row = pool_alloc(w->pool, (size_t)w->n * sizeof *row);
    Motion *exact = copy_motions(w, w->pose), *toward = copy_motions(w, w->pose);
    Work found = elsewhere(w, toward);
    subset_presolve(w, exact, false);
    make_rows(w, exact, row, found.row_of);
    subset_drop_presolved(w, row, found.row_of);
    subset_presolve(w, toward, true);
    make_rows(w, toward, found.row, found.row_of);
    make_jacobian(&found, found.row, found.row_of, found.J);
    for (int r = 0; r < w->n; ++r) {
        found.row[r].value = row[r].value;
        found.row[r].guard = row[r].guard;
    }
    return found;
}

/* What is needed to differentiate the poses that Newton's iteration finds. */
static const Implicit *implicit_new(const Work *w, const Row *row, const Factors *factors, const Ex *found)
{
    Implicit *implicit = pool_alloc(w->pool, sizeof *implicit);
    Ex *value = pool_alloc(w->pool, (size_t)w->n * sizeof *value),
       *whole = pool_alloc(w->pool, (size_t)w->n * sizeof *whole);
    for (int r = 0; r < w->n; ++r) {
        value[r] = row[r].value;
        whole[r] = w->row[r].value;
    }
    *implicit = (Implicit){.n = w->n, .value = value, .whole = whole, .factors = factors, .found = found};
    return implicit;
}

static Formula *formulate_newton(Work *w, Solve solve)
{
    int bodies = w->first->bodies;
    Formula *formula = formula_new(w, false);
    dag_section(w->dag, "constraint equations at the poses, and their derivative");
    formula->solve.scheduled = formula->chord.scheduled = true;
    Work found = held(w);
    Factors *factors = factor(&found);
    Ex *q = pool_alloc(w->pool, (size_t)(7 * bodies) * sizeof *q);
    make_predict(&found, formula);
    Ex determinant = determinant_check(&found, formula, factors, false);
    dag_section(w->dag, "pose: the last correction");
    make_step(&found, factors, &formula->solve, q);
    formula->implicit = implicit_new(w, found.row, factors, q);
    Motion *motion = pool_alloc(w->pool, (size_t)bodies * sizeof *motion);
    make_motion(&found, factors, motion);
    determinant_check_ahead(&found, formula, determinant, motion);
    for (int b = 0; b < bodies; ++b) {
        /* S and the rates belong to q; the last correction changes them by less than rounding */
        memcpy(motion[b].c, q + 7 * b, sizeof motion[b].c);
        ex_rotation(w->dag, q + 7 * b + 3, motion[b].A);
    }
    subset_presolve(w, motion, true);
    finish(&found, formula, solve, factors, motion);
    return formula;
}

/* NULL if the geometry has no closed form. */
static Formula *formulate_closed(Work *w, Solve solve)
{
    Formula *formula = formula_new(w, true);
    formula->solve.scheduled = true;
    size_t bodies = (size_t)w->first->bodies;
    Work found = elsewhere(w, pool_alloc(w->pool, bodies * sizeof *found.pose));
    dag_section(w->dag, "pose, in closed form");
    if (!subset_closed(w, found.pose, &formula->solve))
        return NULL;
    found.derived = w->derived;
    found.derived_of = w->derived_of;
    dag_section(w->dag, "derivative of the constraint equations, and its factors");
    make_rows(&found, found.pose, found.row, found.row_of);
    make_jacobian(&found, found.row, found.row_of, found.J);
    Factors *factors = factor(&found);
    Ex determinant = determinant_check(&found, formula, factors, true);
    Motion *motion = pool_alloc(w->pool, bodies * sizeof *motion);
    make_motion(&found, factors, motion);
    determinant_check_ahead(&found, formula, determinant, motion);
    finish(&found, formula, solve, factors, motion);
    formula_balance(w, formula);
    w->derived = found.derived;
    w->derived_of = found.derived_of;
    return formula;
}

/* Operations of a subset's recovery as time: a division or a root counts as several products. */
static int recovery_cost(const Formula *formula)
{
    const Block *const block[] = {&formula->predict, &formula->chord, &formula->solve};
    int cost = 0;
    for (int i = 0; i < 3; ++i) {
        Count count = block_count(block[i]);
        cost += count.add + count.multiply + 8 * (count.divide + count.root) + 20 * count.function;
    }
    return cost;
}

/* Replace numbers of the knowns that are constant in their classes. */
static void use_constants_of_knowns(Work *w, Formula *const *formula)
{
    for (int i = 0; i < w->first->knowns; ++i) {
        motion_input(w->dag, &w->known[i], ARRAY_known, i, 0, 1, known_deps(w, i));
        subset_use_constants(w, formula, i, &w->known[i]);
        order_by_deps(w, i);
    }
    subset_find_still(w);
    make_rows(w, w->pose, w->row, w->row_of);
    memset(w->J, 0, (size_t)(w->n * w->n) * sizeof *w->J);
    make_jacobian(w, w->row, w->row_of, w->J);
}

/* True if the block ends with a status at the design of a member. Closed forms do so near the meeting of two solutions,
 * where Newton's iteration still has enough digits. */
static bool refuses_design(const Work *w, const Block *block)
{
    for (int m = 0; m < w->class->members; ++m)
        for (int i = 0; i < block->checks; ++i) {
            const Check *check = &block->check[i];
            const double value = ex_value(w->dag, check->value, m * w->configurations);
            if (!((check->magnitude ? fabs(value) : value) > check->least))
                return true;
        }
    return false;
}

static Formula *formulate_class(Work *w, Formula *const *made, const Sampling *sampling, Solve solve, Recovery recovery)
{
    const double bound = 1e-13; /* of polynomials */
    use_constants_of_knowns(w, made);
    Formula *closed = recovery == RECOVERY_NEWTON ? NULL : formulate_closed(w, solve);
    if (closed && recovery == RECOVERY_CLOSED)
        return closed;
    if (closed && refuses_design(w, &closed->solve))
        closed = NULL;
    Formula *newton = formulate_newton(w, solve);
    if (closed && recovery_cost(closed) < recovery_cost(newton))
        return closed;
    if (recovery == RECOVERY_POLYNOMIAL)
        subset_polynomial(w, newton, made, sampling, bound);
    return newton;
}

/* ---- all classes -------------------------------------------------------------------------------------------- */

/* A copy whose classes can be split; there are never more classes than subsets. */
static Sequence *copy_sequence(Pool *pool, const Sequence *sequence)
{
    size_t subsets = (size_t)sequence->subsets, classes = (size_t)sequence->classes;
    Sequence *copy = pool_grow(pool, (void *)sequence, sizeof *copy, sizeof *copy);
    copy->subset = pool_grow(pool, sequence->subset, subsets * sizeof *copy->subset, subsets * sizeof *copy->subset);
    copy->class = pool_grow(pool, sequence->class, classes * sizeof *copy->class, (subsets + 1) * sizeof *copy->class);
    return copy;
}

/* Follow the samples of all subsets in computational order. */
static void follow_all(const Sequence *sequence, Work **work, Sampling *sampling)
{
    for (int s = 0; s < sequence->subsets; ++s) {
        int c = sequence->subset[s].class;
        if (c < 0)
            continue;
        subset_explain_singular(work[c], sampling, s);
        subset_follow(work[c], sampling, subset_index(work[c], s));
    }
}

Formula **subsets_formulate(Pool *pool, const Model *model, const Sequence **sequence, const double (*origin)[3],
                            Sampling *sampling, Solve solve, Recovery recovery)
{
    Sequence *split = copy_sequence(pool, *sequence);
    Formula **formula = pool_alloc(pool, (size_t)(split->subsets + 1) * sizeof *formula);
    Work **work = pool_alloc(pool, (size_t)(split->subsets + 1) * sizeof *work);
    for (int c = 0; c < split->classes; ++c)
        work[c] = subset_open(pool, model, split, &split->class[c], origin, sampling);
    follow_all(split, work, sampling);
    bool any = false;
    for (int c = 0; c < split->classes; ++c)
        if (class_split(pool, split, c, work[c])) {
            int last = split->classes - 1;
            any = true;
            work[c] = subset_open(pool, model, split, &split->class[c], origin, sampling);
            work[last] = subset_open(pool, model, split, &split->class[last], origin, sampling);
            for (int i = 0; i < split->class[last].members; ++i) /* so that the class can be split again */
                subset_follow(work[last], sampling, i);
        }
    if (any)
        follow_all(split, work, sampling);
    subsets_scan(pool, model, split, work, sampling);
    for (int s = 0; s < split->subsets; ++s) {
        int c = split->subset[s].class;
        if (c >= 0 && !formula[c])
            formula[c] = formulate_class(work[c], formula, sampling, solve, recovery);
    }
    subsets_drop_constants(pool, model, split, formula);
    *sequence = split;
    return formula;
}
