/* SPDX-License-Identifier: MIT
 * Functions of classes of subsets for derivatives along a direction, with the recovery or after it, and their calls. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "emit/tangent.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/tangent.h"
#include "vehicle/vehicle.h"

/* Do coordinates alone move a subset's bodies, all of which its S has columns of? Not its carrier, nor the geometry. */
static bool moves_alone(const Generation *g, const Subset *subset)
{
    bool alone = subset->carrier == BODY_BASE && !(subset->class >= 0 && g->plan->formula[subset->class]->derived);
    for (int i = 0; i < subset->knowns && alone; ++i)
        alone = moves_alone(g, &g->sequence->subset[g->sequence->body_subset[subset->known[i]]]);
    return alone;
}

bool class_moves_alone(const Generation *g, int class)
{
    const Class *all = &g->sequence->class[class];
    bool alone = true;
    for (int i = 0; i < all->members; ++i)
        alone = alone && moves_alone(g, &g->sequence->subset[all->member[i]]);
    return alone;
}

/* What the blocks of a class are differentiated along. */
const Along *along_class(const Generation *g, int class, bool still)
{
    Along *along = pool_alloc(g->pool, sizeof *along);
    *along = (Along){.steady = !g->model->free_base,
                     .tuned = g->model->tuning,
                     .still = still,
                     .alone = class_moves_alone(g, class)};
    return along;
}

const Block *class_tangent(const Generation *g, int class, bool still)
{
    return subset_tangent(g->plan->formula[class], along_class(g, class, still), TANGENT_AFTER);
}

/* Is the recovery computed together with its derivatives? Where all of it is closed forms, which read nothing of
 * earlier recoveries; code in lanes recovers side by side. */
bool recovers_along(const Generation *g)
{
    return g->style->derivatives && !g->lanes && !g->formulation->single && g->sequence->classes > 0 &&
           followed_bodies(g->plan) == 0;
}

/* The derivatives of a class as they are written. */
static const Block *written_tangent(const Generation *g, bool still)
{
    const TangentStores stores = balances_bodies(g)  ? TANGENT_MOTIONS
                                 : recovers_along(g) ? TANGENT_WITH
                                                     : TANGENT_AFTER;
    int kept;
    const Ex *keep = tangent_kept(g, g->class, &kept);
    Block *block = pool_alloc(g->pool, sizeof *block);
    *block = *subset_tangent(g->plan->formula[g->class], along_class(g, g->class, still), stores);
    for (int i = 0; i < kept; ++i)
        block_store(block, keep[i], element_at(ARRAY_kept, i));
    return block;
}

/* Pointers to the numbers of known bodies and to what follows geometric parameters, and to their derivatives. */
static void write_knowns(const Generation *g, Text *out, int indent, bool wrenches)
{
    const Class *class = &g->sequence->class[g->class];
    const Subset *first = &g->sequence->subset[class->member[0]];
    for (int i = 0; i < first->knowns; ++i) {
        line(out, indent, "const gic_real *const m%d = links->known[%d], *const dm%d = dlinks->known[%d]; /* %s */", i,
             i, i, i, g->model->body[first->known[i]].name);
        line(out, indent, "(void)m%d, (void)dm%d;", i, i);
    }
    for (int i = 0; wrenches && i < first->knowns; ++i) {
        line(out, indent, "gic_real *const w%d = onto[%d], *const dw%d = donto[%d];", i, i, i, i);
        line(out, indent, "(void)w%d, (void)dw%d;", i, i);
    }
    if (!g->plan->formula[g->class]->derived)
        return;
    line(out, indent, "const gic_real *const d = links->derived, *const dd = dlinks->derived;");
    line(out, indent, "(void)d, (void)dd;");
}

void tangent_knowns(void *context, Text *out, int indent)
{
    const TangentExpansion *x = context;
    const Formula *formula = x->g->plan->formula[x->g->class];
    write_knowns(x->g, out, indent, false);
    if (block_reads(written_tangent(x->g, false), ARRAY_f, 0) || block_reads(written_tangent(x->g, true), ARRAY_f, 0))
        line(out, indent, "const gic_real *const f = q + %d; /* the factors */", formula->layout.start_factors);
}

void tangent_react_knowns(void *context, Text *out, int indent)
{
    const TangentExpansion *x = context;
    write_knowns(x->g, out, indent, true);
}

void tangent_class_block(TangentExpansion *x, const Block *block, Text *out, int indent)
{
    write_class_block(x->g, block, &x->constants, out, indent);
}

void tangent_kept_argument(void *context, Text *out, int indent)
{
    const TangentExpansion *x = context;
    line(out, indent,
         balances_bodies(x->g)
             ? "gic_real *GIC_RESTRICT dmotion, gic_real *GIC_RESTRICT dinertia, gic_real *GIC_RESTRICT kept)"
             : "gic_real *GIC_RESTRICT dmotion, gic_real *GIC_RESTRICT dinertia)");
}

void tangent_kept_unused(void *context, Text *out, int indent)
{
    const TangentExpansion *x = context;
    if (balances_bodies(x->g))
        line(out, indent, "(void)kept;");
}

void tangent_solve(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    tangent_class_block(x, written_tangent(x->g, false), out, indent);
}

void tangent_still(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    tangent_class_block(x, written_tangent(x->g, true), out, indent);
}

void tangent_react_block(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    tangent_class_block(x, whole_tangent(x->g, &x->g->plan->formula[x->g->class]->react), out, indent);
}

/* The functions of all classes of subsets. */
void tangent_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    for (g->class = 0; g->class < g->sequence->classes; ++g->class) {
        const Class *class = &g->sequence->class[g->class];
        TangentExpansion x = {.g = g};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->body[g->sequence->subset[class->member[i]].body[0]].name;
        template_expand(g->pool, &body, g->templates, recovers_along(g) ? "tangent_found.c.in" : "tangent_class.c.in",
                        g->model->name, class->name, &tangent_class_points, &x);
        if (balances_bodies(g))
            template_expand(g->pool, &body, g->templates, "tangent_lack.c.in", g->model->name, class->name,
                            &tangent_class_points, &x);
        if (g->plan->formula[g->class]->react.stores)
            template_expand(g->pool, &body, g->templates, "tangent_react.c.in", g->model->name, class->name,
                            &tangent_class_points, &x);
        write_constants(g, out, pool_print(g->pool, "k_tangent_%s", class->name), g->plan->formula[g->class]->dag,
                        &x.constants, member);
        text_add(out, body.s, body.size);
    }
    g->class = 0;
}

/* What a subset's functions read: motions of the bodies solved before, coordinates, derived numbers. links: with . or
 * ->; x: where the coordinates are. */
void tangent_links(Generation *g, Text *out, int indent, int s, const char *links, const char *x)
{
    const Subset *subset = &g->sequence->subset[s];
    for (int i = 0; i < subset->knowns; ++i) {
        const char *place = body_motion_text(g, subset->known[i]);
        line(out, indent, "%sknown[%d] = %s + %s;", links, i, found_text(g, "motion"), place);
        line(out, indent, "dlinks.known[%d] = along->motion + %s;", i, place);
    }
    for (int j = 0; j < subset->deps; ++j) {
        const char *index = coordinate_text(g->pool, g->style->naming, subset->dep[j]);
        line(out, indent, "%sx[%d] = %s[%s], dlinks.x[%d] = along->x[%s];", links, j, x, index, j, index);
        line(out, indent, "%srate[%d] = self->xd[%s], dlinks.rate[%d] = along->xd[%s];", links, j, index, j, index);
    }
    if (!g->plan->formula[subset->class]->derived)
        return;
    line(out, indent, "%sderived = self->derived + %d;", links, g->plan->derived_offset[s]);
    line(out, indent, "dlinks.derived = along->derived + %d;", g->plan->derived_offset[s]);
}

/* Do a subset's bodies follow its own coordinates alone, relative to the base, as those do that it knows? */
static bool follows_own(const Generation *g, const Subset *subset)
{
    bool own = !g->model->tuning;
    for (int i = 0; i < subset->knowns; ++i) {
        const Subset *known = &g->sequence->subset[g->sequence->body_subset[subset->known[i]]];
        own = own && (known->class < 0 || follows_own(g, known));
        for (int j = 0; j < known->deps; ++j)
            own = own && subset_column(subset, known->dep[j], false) >= 0;
    }
    return own;
}

/* still: none of its coordinates changes; idle: nothing does that its motion follows. False: it is not known which
 * coordinates it follows, and there is only the former. */
bool tangent_stillness(const Generation *g, Text *out, int indent, int s)
{
    const Subset *subset = &g->sequence->subset[s];
    if (!follows_own(g, subset)) {
        line(out, indent, "still = along->still;");
        return false;
    }
    for (int k = 0; k < 2; ++k) {
        text_print(out, "%*s%s", indent, "", k ? "idle = still && !turns" : "still = 1");
        for (int j = 0; j < subset->deps; ++j)
            text_print(out, " && GIC_FABS(dlinks.%s[%d]) <= R(0.0)", k ? "rate" : "x", j); /* not so of a NaN */
        text_print(out, ";\n");
    }
    return true;
}

void tangent_zeros(Text *out, int indent, const char *array, const char *place, int count)
{
    /* &array[0], not the array: gcc warns (-Wmemset-elt-size) if the array has as many numbers as the subset has bytes,
     * as it has of 8 alike subsets */
    if (count)
        line(out, indent, "memset(&along->%s[%s], 0, %d * sizeof(gic_real));", array, place, count);
}

/* Where a subset is idle, its derivatives are 0; otherwise: a line for that case. What follows is for the others. */
static void write_idle(const Generation *g, Text *out, int indent, int s, const char *otherwise)
{
    const Subset *subset = &g->sequence->subset[s];
    const Layout *layout = &g->plan->formula[subset->class]->layout;
    line(out, indent, "if (idle) {");
    tangent_zeros(out, indent + 4, "motion", body_motion_text(g, subset->body[0]),
                  layout->bodies * layout->motion_size);
    if (!balances_bodies(g))
        tangent_zeros(out, indent + 4, "inertia", subset_inertia_text(g, s), layout->inertia_size);
    tangent_zeros(out, indent + 4, "start", pool_print(g->pool, "%d", g->plan->start_offset[s]), layout->start_size);
    if (otherwise)
        line(out, indent + 4, "%s", otherwise);
    line(out, indent, "} else");
}

/* Of a subset's recovery with its derivatives; without them where they are 0. */
static void write_found_call(Generation *g, Text *out, int indent, int s)
{
    const Subset *subset = &g->sequence->subset[s];
    const char *name = g->model->name, *class = g->sequence->class[subset->class].name;
    const char *motion = body_motion_text(g, subset->body[0]), *inertia = subset_inertia_text(g, s);
    const int offset = g->plan->start_offset[s], place = class_place(&g->sequence->class[subset->class], s);
    tangent_links(g, out, indent, s, "links->", "start");
    const char *alone = pool_print(
        g->pool, "status = %s_solve_%s(self, %s_k_%s[%d], links, start + %d, self->motion + %s, self->inertia + %s);",
        name, class, name, class, place, offset, motion, inertia);
    const bool own = tangent_stillness(g, out, indent, s);
    if (own)
        write_idle(g, out, indent, s, alone);
    line(
        out, own ? indent + 4 : indent,
        "status = %s_tangent_solve_%s(self, still, %s_k_tangent_%s[%d], links, &dlinks, start + %d, along->start + %d, "
        "self->motion + %s, self->inertia + %s, along->motion + %s, along->inertia + %s%s);",
        name, class, name, class, place, offset, offset, motion, inertia, motion, inertia, tangent_kept_text(g, s));
    line(out, indent, "if (status != GIC_OK) {");
    line(out, indent + 4, "self->head.subset = %s;", subset_text(g->pool, g->style->naming, s));
    line(out, indent + 4, "return status;");
    line(out, indent, "}");
}

void tangent_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const Subset *subset = &g->sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Class *class = &g->sequence->class[subset->class];
        const int offset = g->plan->start_offset[s];
        line(out, indent, "/* stage %d: %s */", subset->stage, subset_title(g->pool, g->model, subset));
        if (recovers_along(g)) {
            write_found_call(g, out, indent, s);
            continue;
        }
        tangent_links(g, out, indent, s, "links.", "self->x");
        const bool own = tangent_stillness(g, out, indent, s);
        if (own)
            write_idle(g, out, indent, s, NULL);
        line(out, own ? indent + 4 : indent,
             "%s_tangent_solve_%s(still, %s_k_tangent_%s[%d], &links, &dlinks, start + %d, along->start + %d, "
             "%s + %s, %s + %s, along->motion + %s, along->inertia + %s);",
             g->model->name, class->name, g->model->name, class->name, class_place(class, s), offset, offset,
             found_text(g, "motion"), body_motion_text(g, subset->body[0]), found_text(g, "inertia"),
             subset_inertia_text(g, s), body_motion_text(g, subset->body[0]), subset_inertia_text(g, s));
    }
}

/* In reverse computational sequence, as the multipliers themselves. */
void tangent_react_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Plan *plan = g->plan;
    const bool *needed = reactions_needed(g->pool, g->model, g->sequence);
    for (int s = g->sequence->subsets - 1; s >= 0; --s) {
        const Subset *subset = &g->sequence->subset[s];
        if (subset->class < 0 || !needed[s])
            continue;
        const Class *class = &g->sequence->class[subset->class];
        const int factors = plan->start_offset[s] + plan->formula[subset->class]->layout.start_factors;
        const char *motion = body_motion_text(g, subset->body[0]);
        const int own = plan->multiplier_offset[subset->body[0]];
        line(out, indent, "/* %s */", subset_title(g->pool, g->model, subset));
        tangent_links(g, out, indent, s, "links.", "self->x");
        for (int i = 0; i < subset->knowns; ++i) {
            const int place = plan->multiplier_offset[subset->known[i]];
            if (needed[g->sequence->body_subset[subset->known[i]]])
                line(out, indent, "onto[%d] = lambda + %d, donto[%d] = dlambda + %d;", i, place, i, place);
            else
                line(out, indent, "onto[%d] = spare, donto[%d] = dspare;", i, i);
        }
        line(out, indent,
             "%s_tangent_react_%s(%s_k_tangent_%s[%d], &links, &dlinks, start + %d, along->start + %d, %s + %s, "
             "along->motion + %s, lambda + %d, dlambda + %d, onto, donto);",
             g->model->name, class->name, g->model->name, class->name, class_place(class, s), factors, factors,
             found_text(g, "motion"), motion, motion, own, own);
    }
}
