/* SPDX-License-Identifier: MIT
 * The design configuration of a model whose joints have other lengths than the drawing (FORMAT.md section 4). */
#include "base/message.h"
#include "base/vec3.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

static bool needs_assembly(const Model *model, const Subset *subset)
{
    for (int i = 0; i < subset->joints; ++i)
        if (!model->joint[subset->joint[i]].drawn)
            return true;
    return false;
}

static _Noreturn void assembly_fail(const Model *model, const Subset *subset)
{
    const Joint *joint = NULL;
    for (int i = subset->joints - 1; i >= 0; --i)
        if (!model->joint[subset->joint[i]].drawn)
            joint = &model->joint[subset->joint[i]];
    /* a subset without a given length fails only because earlier ones moved */
    const char *what = joint ? joint->name : model->body[subset->body[0]].name;
    diag_fail(joint ? joint->at : model->body[subset->body[0]].at,
              "give lengths nearer to the drawing's, or draw the mechanism nearer to where the lengths put it",
              "the mechanism can't be assembled: body '%s' can't follow from the drawing to the given lengths, '%s' "
              "among them",
              model->body[subset->body[0]].name, what);
}

/* World pose of a body frame from the pose of its reference point relative to that of another body, or to the base. */
static void move_body(Model *model, int from, int body, const double q[7], const double (*origin)[3])
{
    const Body *carrier = &model->body[from];
    Body *b = &model->body[body];
    double R[9], A[9], offset[3], local[3], cross[3];
    const double *p0 = carrier->euler, *p = q + 3;
    mat_from_euler(p0, R);
    mat_from_euler(p, A);
    apply3(A, origin[body], offset);
    for (int i = 0; i < 3; ++i)
        local[i] = q[i] - offset[i] + (from == BODY_BASE ? 0 : origin[from][i]);
    apply3(R, local, b->position);
    for (int i = 0; i < 3; ++i)
        b->position[i] += carrier->position[i];
    cross3(p0 + 1, p + 1, cross);
    b->euler[0] = p0[0] * p[0] - dot3(p0 + 1, p + 1);
    for (int i = 0; i < 3; ++i)
        b->euler[1 + i] = p0[0] * p[1 + i] + p[0] * p0[1 + i] + cross[i];
}

const Model *model_assemble(Pool *pool, const Model *drawn, const Sequence *sequence)
{
    bool any = false;
    for (int s = 0; s < sequence->subsets; ++s)
        any = any || (sequence->subset[s].class >= 0 && needs_assembly(drawn, &sequence->subset[s]));
    if (!any)
        return drawn;
    Model *model = pool_grow(pool, (void *)drawn, sizeof *drawn, sizeof *drawn);
    size_t size = (size_t)model->bodies * sizeof *model->body;
    model->body = pool_grow(pool, drawn->body, size, size);
    for (int b = 0; b < model->bodies; ++b) {
        const Body *from = &drawn->body[b];
        tuning_copy(model, &model->body[b].mass, &from->mass, 1);
        tuning_copy(model, model->body[b].com, from->com, 3);
        tuning_copy(model, model->body[b].inertia, from->inertia, 6);
    }
    double(*origin)[3] = reference_points(pool, drawn, sequence);
    const double(*fixed)[3] = (const double(*)[3])origin;
    Sampling *sampling = sampling_new(pool, drawn, sequence, fixed);
    Work **work = pool_alloc(pool, (size_t)(sequence->classes + 1) * sizeof *work);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        Work **w = &work[subset->class];
        if (!*w)
            *w = subset_open(pool, drawn, sequence, &sequence->class[subset->class], fixed, sampling);
        double q[7 * subset->bodies];
        if (!subset_assemble(*w, sampling, subset_index(*w, s), q)) {
            subset_explain_singular(*w, sampling, s);
            assembly_fail(drawn, subset);
        }
        for (int b = 0; b < subset->bodies; ++b)
            move_body(model, subset_anchor(model, sequence, s), subset->body[b], q + 7 * b, fixed);
    }
    return model;
}
