/* SPDX-License-Identifier: MIT
 * Derivatives of code in lanes. The recovery leaves the numbers of alike subsets in rows, which their blocks would have
 * to be written anew for; so derivatives are those of the formulation without lanes, and an instance has copies of
 * these numbers, in the order of that formulation. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

Generation *one_by_one(Generation *g)
{
    if (!g->formulation->single || g->lanes)
        return g;
    if (!g->single) {
        Pool *pool = g->pool;
        Style *style = pool_alloc(pool, sizeof *style);
        *style = *g->style;
        if (style->naming) {
            /* the file has no enumerators for places of bodies and subsets */
            Naming *naming = pool_alloc(pool, sizeof *naming);
            *naming = *style->naming;
            naming->formulation = g->formulation->single;
            naming->body = naming->subset = NULL;
            style->naming = naming;
        }
        Generation *single = pool_alloc(pool, sizeof *single);
        *single = *g;
        single->formulation = g->formulation->single;
        single->plan = g->formulation->single->plan;
        single->style = style;
        single->lanes = g;
        g->single = single;
    }
    return g->single;
}

bool reads_rows(const Generation *g)
{
    return g->lanes && g->weighing;
}

const Block *placed_block(const Generation *g, const Block *block)
{
    return reads_rows(g) ? block_in_rows(g->pool, g->lanes->formulation, block) : block;
}

const char *found_text(const Generation *g, const char *array)
{
    if (g->lanes && !g->weighing)
        return pool_print(g->pool, "self->flat_%s", array);
    return strcmp(array, "start") ? pool_print(g->pool, "self->%s", array) : "self->start[self->head.flip]";
}

static void write_found(const Generation *g, Text *out, int indent, const char *name, const char *array)
{
    line(out, indent, "const gic_real *const %s = %s;", name, found_text(g, array));
}

void write_found_motions(void *context, Text *out, int indent)
{
    write_found(context, out, indent, "m", "motion");
}

void write_found_inertias(void *context, Text *out, int indent)
{
    write_found(context, out, indent, "n", "inertia");
}

void write_found_start(void *context, Text *out, int indent)
{
    write_found(context, out, indent, "start", "start");
}

void write_flat_members(void *context, Text *out, int indent)
{
    Generation *g = context;
    if (!g->formulation->single || !has_tangents(one_by_one(g)))
        return;
    line(out, indent,
         "/* for derivatives, which are computed one by one: copies of motion, inertia and start without lanes */");
    line(out, indent, "gic_real flat_motion[%s_MOTION_ROOM], flat_inertia[%s_INERTIA_ROOM], flat_start[%s_START_ROOM];",
         g->upper, g->upper, g->upper);
}

/* ---- the function that copies ------------------------------------------------------------------------------------ */

/* One entry of its tables. */
static void write_entry(Text *out, int indent, int from, int stride, int to, int count, const char *name)
{
    if (count > 0)
        line(out, indent, "{%d, %d, %d, %d}, /* %s */", from, stride, to, count, name);
}

/* C has no empty tables. */
static void write_end(Text *out, int indent)
{
    line(out, indent, "{0, 0, 0, 0},");
}

static void write_motions(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Plan *rows = g->lanes->plan;
    for (int b = 1; b < g->model->bodies; ++b) {
        const int s = g->sequence->body_subset[b], class = g->sequence->subset[s].class;
        if (class >= 0)
            write_entry(out, indent, rows->motion_offset[b], rows->stride[s], g->plan->motion_offset[b],
                        g->plan->formula[class]->layout.motion_size, g->model->body[b].name);
    }
    write_end(out, indent);
}

static void write_inertias(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Plan *rows = g->lanes->plan;
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const Subset *subset = &g->sequence->subset[s];
        if (subset->class >= 0)
            write_entry(out, indent, rows->inertia_offset[s], rows->stride[s], g->plan->inertia_offset[s],
                        g->plan->formula[subset->class]->layout.inertia_size, subset_title(g->pool, g->model, subset));
    }
    write_end(out, indent);
}

static void write_starts(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Plan *rows = g->lanes->plan;
    write_entry(out, indent, 0, 1, 0, g->model->coordinates, "coordinates");
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const Subset *subset = &g->sequence->subset[s];
        if (subset->class >= 0)
            write_entry(out, indent, rows->start_offset[s], rows->stride[s], g->plan->start_offset[s],
                        g->plan->formula[subset->class]->layout.start_size, subset_title(g->pool, g->model, subset));
    }
    write_end(out, indent);
}

static const Insertion point[] = {
    {"flat motions", write_motions}, {"flat inertias", write_inertias}, {"flat starts", write_starts}, {NULL, NULL}};

const Insertions flat_points = {(const char *const[]){"flat.c.in", "rows.c.in", NULL}, point, NULL};

void write_flat(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->lanes)
        template_expand(g->pool, out, g->templates, "flat.c.in", g->model->name, NULL, &flat_points, g);
}

void write_row_copies(Generation *g, Text *out)
{
    if (g->lanes && g->lanes->plan->lanes)
        template_expand(g->pool, out, g->templates, "rows.c.in", g->model->name, NULL, &flat_points, g);
}

void write_flat_call(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!g->lanes)
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "%s_flatten(self);", g->model->name);
}
