/* SPDX-License-Identifier: MIT
 * Numbers of a subset that are the same in every configuration, such as the place and axis of an arm's hinge. Later
 * blocks use them as constants; they are not stored. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>

bool formula_is_constant(const Formula *f, Ex e)
{
    return f->dag->node[e].level < LEVEL_VARIABLE;
}

double formula_value(const Formula *f, Ex e, int member)
{
    return ex_value(f->dag, e, member * (f->dag->samples / f->dag->members));
}

/* The number of a class's motion that a known of a member stands for. */
typedef struct ConstantMotion {
    const Formula *formula; /* NULL: not made yet */
    int member;
    Ex e;
} ConstantMotion;

static ConstantMotion constant_of(const Sequence *sequence, Formula *const *formula, int body, int number)
{
    const int s = sequence->body_subset[body];
    const Subset *subset = &sequence->subset[s];
    const Formula *f = formula[subset->class];
    if (!f)
        return (ConstantMotion){.formula = NULL};
    return (ConstantMotion){f, class_place(&sequence->class[subset->class], s),
                            *motion_number(&f->motion[subset_place(subset, body)], number)};
}

/* A constant number of a known body's motion. */
static void describe_motion(Work *w, int known, int number, Ex e)
{
    const char *body = w->model->body[w->first->known[known]].name;
    if (number < MOTION_S)
        ex_describe(w->dag, e, "%s.%s", body, motion_number_name(number));
    else
        ex_describe(w->dag, e, "%s.S[%d]", body, number - MOTION_S);
}

void subset_use_constants(Work *w, Formula *const *formula, int known, Motion *m)
{
    double value[w->class->members];
    for (int number = 0; number < MOTION_S + 6 * m->deps; ++number) {
        bool settled = true;
        for (int i = 0; settled && i < w->class->members; ++i) {
            const ConstantMotion found = constant_of(w->sequence, formula, subset_member(w, i)->known[known], number);
            settled = found.formula && formula_is_constant(found.formula, found.e);
            if (settled)
                value[i] = formula_value(found.formula, found.e, found.member);
        }
        if (settled)
            describe_motion(w, known, number, *motion_number(m, number) = ex_constant(w->dag, value));
    }
}

/* A direction perpendicular to a unit vector; the same in all configurations if that is an axis of the frame. */
static void across(const double u[3], double out[3])
{
    const double *const least = fabs(u[0]) <= fabs(u[1]) && fabs(u[0]) <= fabs(u[2]) ? u
                                : fabs(u[1]) <= fabs(u[2])                           ? u + 1
                                                                                     : u + 2;
    double axis[3] = {0};
    axis[least - u] = 1;
    cross3(u, axis, out);
    const double norm = norm3(out);
    for (int i = 0; i < 3; ++i)
        out[i] /= norm;
}

static void find_across(Work *w, Connection *tie, const Ex axis[3])
{
    const int members = w->class->members;
    double side[members][2][3], value[members];
    for (int i = 0; i < members; ++i) {
        double u[3];
        for (int j = 0; j < 3; ++j)
            u[j] = ex_value(w->dag, axis[j], i * w->configurations);
        across(u, side[i][0]);
        cross3(u, side[i][0], side[i][1]);
    }
    for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < members; ++i)
            value[i] = side[i][j / 3][j % 3];
        tie->across[j / 3][j % 3] = ex_constant(w->dag, value);
        ex_describe(w->dag, tie->across[j / 3][j % 3], "%s.across_%d_%c", w->model->joint[tie->index].name, j / 3 + 1,
                    "xyz"[j % 3]);
    }
}

void subset_find_still(Work *w)
{
    for (int i = 0; i < w->connections; ++i) {
        Connection *tie = &w->connection[i];
        if (tie->is_coordinate || tie->end[0].known < 0 || w->anchored)
            continue;
        const int parts = joint_parts[w->model->joint[tie->index].type];
        const Vector axis = vector_axis(w->dag, &w->known[tie->end[0].known], tie->fixture.axis[0]);
        tie->still = parts & PART_PARALLEL && !(parts & (PART_LOCK | PART_LINE));
        for (int j = 0; j < 3; ++j)
            tie->still = tie->still && w->dag->node[axis.v[j]].level < LEVEL_VARIABLE;
        if (tie->still)
            find_across(w, tie, axis.v);
    }
}

/* Marks the numbers of its own and of earlier bodies that a class reads from memory: of its own those that became
 * constants when sums were balanced, after the check of residuals was made. */
typedef struct Readers {
    const Sequence *sequence;
    const Class *class; /* the reading class */
    int motion_size;    /* of its bodies */
    bool **read;        /* [bodies][motion numbers] */
} Readers;

static void mark_read(void *context, Element element)
{
    const Readers *readers = context;
    for (int i = 0; i < readers->class->members; ++i) {
        const Subset *subset = &readers->sequence->subset[readers->class->member[i]];
        if (element.array == ARRAY_known)
            readers->read[subset->known[element.which]][element.index] = true;
        else if (element.array == ARRAY_motion)
            readers->read[subset->body[element.index / readers->motion_size]][element.index % readers->motion_size] =
                true;
    }
}

/* True if a member of the class reads a number of the body. */
static bool is_read(const Readers *readers, const Class *class, int body, int number)
{
    bool any = false;
    for (int i = 0; i < class->members; ++i)
        any = any || readers->read[readers->sequence->subset[class->member[i]].body[body]][number];
    return any;
}

/* Polynomials store what `solve` stores. */
static void drop_others(const Formula *f)
{
    if (!f->polynomial)
        return;
    Block *block = &f->polynomial->solve;
    const int stores = block->stores;
    block->stores = 0;
    for (int i = 0; i < stores; ++i)
        for (int j = 0; j < f->solve.stores; ++j)
            if (element_same(f->solve.store[j].target, block->store[i].target)) {
                block->store[block->stores++] = block->store[i];
                break;
            }
}

void subsets_drop_constants(Pool *pool, const Model *model, const Sequence *sequence, Formula *const *formula)
{
    Readers readers = {.sequence = sequence, .read = pool_alloc(pool, (size_t)model->bodies * sizeof *readers.read)};
    for (int b = 0; b < model->bodies; ++b)
        readers.read[b] = pool_alloc(pool, (size_t)(MOTION_S + 6 * model->coordinates) * sizeof **readers.read);
    for (int c = 0; c < sequence->classes; ++c) {
        const Formula *f = formula[c];
        const Block *const block[] = {&f->predict, &f->chord, &f->solve, &f->residual, &f->react};
        readers.class = &sequence->class[c];
        readers.motion_size = f->layout.motion_size;
        for (size_t b = 0; b < sizeof block / sizeof *block; ++b)
            block_inputs(block[b], mark_read, &readers);
    }
    for (int c = 0; c < sequence->classes; ++c) {
        Block *block = &formula[c]->solve;
        int stores = block->stores;
        block->stores = 0;
        for (int i = 0; i < stores; ++i) {
            const Store store = block->store[i];
            const int size = formula[c]->layout.motion_size;
            const bool settled = formula_is_constant(formula[c], store.value);
            if (settled && store.target.array == ARRAY_inertia)
                continue;
            const int number = store.target.index;
            if (settled && store.target.array == ARRAY_motion &&
                !is_read(&readers, &sequence->class[c], number / size, number % size))
                continue;
            block->store[block->stores++] = store;
        }
        drop_others(formula[c]);
    }
}
