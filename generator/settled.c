/* SPDX-License-Identifier: MIT
 * Numbers of a subset that are the same in every configuration: an arm's hinge stays where it is, and so does its axis.
 * Whoever goes on from there takes them as constants and not from memory. */
#include "rows.h"
#include "subset.h"

#include <math.h>
#include <stdio.h>

bool formula_settled(const Formula *f, Ex e)
{
    return f->dag->node[e].level < LEVEL_VARIABLE;
}

double formula_value(const Formula *f, Ex e, int member)
{
    return ex_value(f->dag, e, member * (f->dag->samples / f->dag->members));
}

/* Which number of which class a known of a member is. */
typedef struct Settled {
    const Formula *formula; /* NULL: not made yet */
    int member;
    Ex e;
} Settled;

static Settled settled_of(const Sequence *sequence, Formula *const *formula, int body, int number)
{
    const int s = sequence->body_subset[body];
    const Subset *subset = &sequence->subset[s];
    const Formula *f = formula[subset->class];
    if (!f)
        return (Settled){.formula = NULL};
    return (Settled){f, class_place(&sequence->class[subset->class], s),
                     *motion_number(&f->motion[subset_place(subset, body)], number)};
}

void subset_settle(Work *w, Formula *const *formula, int known, Motion *m)
{
    double value[w->class->members];
    for (int number = 0; number < MOTION_S + 6 * m->deps; ++number) {
        bool settled = true;
        for (int i = 0; settled && i < w->class->members; ++i) {
            const Settled found = settled_of(w->sequence, formula, subset_member(w, i)->known[known], number);
            settled = found.formula && formula_settled(found.formula, found.e);
            if (settled)
                value[i] = formula_value(found.formula, found.e, found.member);
        }
        if (settled)
            *motion_number(m, number) = ex_constant(w->dag, value);
    }
}

/* A direction perpendicular to a unit vector, for good if that is an axis of the frame. */
static void across(const double u[3], double out[3])
{
    const double *const least = fabs(u[0]) <= fabs(u[1]) && fabs(u[0]) <= fabs(u[2]) ? u
                                : fabs(u[1]) <= fabs(u[2])                           ? u + 1
                                                                                     : u + 2;
    double axis[3] = {0};
    axis[least - u] = 1;
    vec_cross(u, axis, out);
    const double norm = vec_norm(out);
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
        vec_cross(u, side[i][0], side[i][1]);
    }
    for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < members; ++i)
            value[i] = side[i][j / 3][j % 3];
        tie->across[j / 3][j % 3] = ex_constant(w->dag, value);
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

/* Marks what a class reads from memory of bodies that were solved before. */
typedef struct Readers {
    const Sequence *sequence;
    const Class *class; /* that reads */
    bool **read;        /* [bodies][motion numbers] */
} Readers;

static void mark_read(void *context, const char *name)
{
    const Readers *readers = context;
    int known, number;
    if (sscanf(name, "m%d[%d]", &known, &number) != 2)
        return;
    for (int i = 0; i < readers->class->members; ++i)
        readers->read[readers->sequence->subset[readers->class->member[i]].known[known]][number] = true;
}

/* Is a body's number read of some member of the class? */
static bool is_read(const Readers *readers, const Class *class, int body, int number)
{
    bool any = false;
    for (int i = 0; i < class->members; ++i)
        any = any || readers->read[readers->sequence->subset[class->member[i]].body[body]][number];
    return any;
}

void subsets_forget(Pool *pool, const Model *model, const Sequence *sequence, Formula *const *formula)
{
    Readers readers = {.sequence = sequence, .read = pool_alloc(pool, (size_t)model->bodies * sizeof *readers.read)};
    for (int b = 0; b < model->bodies; ++b)
        readers.read[b] = pool_alloc(pool, (size_t)(MOTION_S + 6 * model->coordinates) * sizeof **readers.read);
    for (int c = 0; c < sequence->classes; ++c) {
        const Formula *f = formula[c];
        const Block *const block[] = {&f->predict, &f->chord, &f->solve, &f->residual, &f->react};
        readers.class = &sequence->class[c];
        for (size_t b = 0; b < sizeof block / sizeof *block; ++b)
            block_inputs(block[b], mark_read, &readers);
    }
    for (int c = 0; c < sequence->classes; ++c) {
        Block *block = &formula[c]->solve;
        int stores = block->stores, number;
        block->stores = 0;
        for (int i = 0; i < stores; ++i) {
            const Store store = block->store[i];
            const int size = formula[c]->layout.motion_size;
            const bool settled = formula_settled(formula[c], store.value);
            if (settled && sscanf(store.target, "inertia[%d]", &number) == 1)
                continue;
            if (settled && sscanf(store.target, "motion[%d]", &number) == 1 &&
                !is_read(&readers, &sequence->class[c], number / size, number % size))
                continue;
            block->store[block->stores++] = store;
        }
    }
}
