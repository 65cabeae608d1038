/* SPDX-License-Identifier: MIT
 * Derivatives of the rates along a direction by what the bodies lack, M dz = db - d(M z): forces, functions of classes
 * of subsets, the solution. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "emit/tangent.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/tangent.h"
#include "vehicle/tangent_rates.h"
#include "vehicle/vehicle.h"

/* Are changes of accelerations solved for by what bodies lack, M dz = db - d(M z), with no derivative of M? In the
 * reduced form where coordinates alone move all bodies. */
bool balances_bodies(const Generation *g)
{
    bool alone = recovers_along(g) && g->plan->solve == SOLVE_REDUCED && !g->plan->reduction && !g->model->tuning &&
                 !g->sequence->chained;
    for (int c = 0; c < g->sequence->classes; ++c)
        alone = alone && class_moves_alone(g, c);
    return alone && rates_are_solved(g->plan, g->formulation->dynamics);
}

/* [count] what the derivatives of a class keep for what its bodies lack. */
const Ex *tangent_kept(const Generation *g, int class, int *count)
{
    const Subset *first = &g->sequence->subset[g->sequence->class[class].member[0]];
    *count = 0;
    return balances_bodies(g) ? subset_kept(g->plan->formula[class], along_class(g, class, false), first->deps, count)
                              : NULL;
}

/* Where a subset's begin in along->kept; of all subsets: how many there are. */
int tangent_kept_offset(const Generation *g, int subset)
{
    int offset = 0, count;
    for (int s = 0; s < subset; ++s)
        if (g->sequence->subset[s].class >= 0) {
            tangent_kept(g, g->sequence->subset[s].class, &count);
            offset += count;
        }
    return offset;
}

/* The argument of functions that keep numbers, or read them. */
const char *tangent_kept_text(const Generation *g, int subset)
{
    return balances_bodies(g) ? pool_print(g->pool, ", along->kept + %d", tangent_kept_offset(g, subset)) : "";
}

static const Block *lack_of(const Generation *g, int class, bool still)
{
    const Subset *first = &g->sequence->subset[g->sequence->class[class].member[0]];
    return subset_lack(g->plan->formula[class], along_class(g, class, still), first->deps);
}

void tangent_lack(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    tangent_class_block(x, lack_of(x->g, x->g->class, false), out, indent);
}

void tangent_still_lack(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    tangent_class_block(x, lack_of(x->g, x->g->class, true), out, indent);
}

/* acc[] of the base, which has no equations where it is fixed: act[0] to act[5]. */
void tangent_base(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < 6; ++i)
        if (g->model->free_base)
            line(out, indent, "act[%d] = acc[%d];", i, i);
        else if (i >= 3)
            line(out, indent, "act[%d] = %s;", i, emit_number(g->pool, -g->model->gravity[i - 3]));
    write_columns_turn(context, out, indent);
}

void tangent_lacks(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const Subset *subset = &g->sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Class *class = &g->sequence->class[subset->class];
        const char *motion = body_motion_text(g, subset->body[0]), *inertia = subset_inertia_text(g, s);
        line(out, indent, "/* stage %d: %s */", subset->stage, subset_title(g->pool, g->model, subset));
        tangent_links(g, out, indent, s, "links.", "self->x");
        write_accelerations_of(g, out, indent, subset);
        const bool own = tangent_stillness(g, out, indent, s);
        if (own) {
            line(out, indent, "if (idle)");
            tangent_zeros(out, indent + 4, "inertia", inertia, 6 + subset->deps);
            line(out, indent, "else");
        }
        line(out, own ? indent + 4 : indent,
             "%s_tangent_lack_%s(still, %s_k_tangent_%s[%d], &links, &dlinks, act, self->motion + %s, self->inertia + "
             "%s, along->motion + %s, along->inertia + %s%s);",
             g->model->name, class->name, g->model->name, class->name, class_place(class, s), motion, inertia, motion,
             inertia, tangent_kept_text(g, s));
    }
}

/* [Plan.inertia_size] what subsets lack that may be other than 0. */
static const bool *lacks_of(const Generation *g)
{
    bool *lacks = pool_alloc(g->pool, (size_t)g->plan->inertia_size + 1);
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const int class = g->sequence->subset[s].class;
        if (class < 0)
            continue;
        const Block *block = lack_of(g, class, false);
        for (int i = 0; i < block->stores; ++i)
            lacks[g->plan->inertia_offset[s] + i] = !ex_is(block->dag, block->store[i].value, 0);
    }
    return lacks;
}

/* The inertia of subsets stands still. */
static bool moves_forces(const void *context, Element element)
{
    return element.array != ARRAY_n && tangent_moves(context, element);
}

static bool moves_still_forces(const void *context, Element element)
{
    return element.array != ARRAY_n && tangent_moves_still(context, element);
}

static const TangentRates *rates_along(const Generation *g, bool still)
{
    const Seeds seeds = {.moves = still ? moves_still_forces : moves_forces, .context = g};
    return tangent_rates(g->plan, g->formulation->dynamics, &seeds, lacks_of(g));
}

static void write_rates_block(Generation *g, Text *out, const Block *block, int indent)
{
    Constants none = {0};
    write_fast_block(g, out, block, SCOPE_WHOLE, &none, indent);
}

void tangent_forces(void *context, Text *out, int indent)
{
    write_rates_block(context, out, &rates_along(context, false)->first, indent);
}

void tangent_still_forces(void *context, Text *out, int indent)
{
    write_rates_block(context, out, &rates_along(context, true)->first, indent);
}

void tangent_solution(void *context, Text *out, int indent)
{
    write_rates_block(context, out, &rates_along(context, false)->second, indent);
}

void tangent_still_solution(void *context, Text *out, int indent)
{
    write_rates_block(context, out, &rates_along(context, true)->second, indent);
}

void tangent_factors(void *context, Text *out, int indent)
{
    Generation *g = context;
    const int factors[2] = {rates_along(g, false)->factors, rates_along(g, true)->factors};
    line(out, indent, "gic_real acc[%s_UNKNOWN_ROOM], factor[%d];", g->upper,
         room(factors[0] > factors[1] ? factors[0] : factors[1]));
}
