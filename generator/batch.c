/* SPDX-License-Identifier: MIT
 * Code for many vehicles at once: the same blocks as for one, each number a vector with one vehicle a lane. */
#include "generate.h"

#include <string.h>

typedef struct BatchGeneration {
    Generation g; /* first: what generate.c's insertions get */
    const Batch *batch;
    const char *model_header;
} BatchGeneration;

static void write_vector(BatchGeneration *b, Text *out, int indent, const char *type)
{
    text_print(out, "%*sconst %s all = {", indent, "", type);
    for (int l = 0; l < b->batch->lanes; ++l)
        text_print(out, l ? ", x" : "x");
    text_print(out, "};\n");
    line(out, indent, "return all;");
}

static void insert_lanes(void *context, const char *name, Text *out, int indent)
{
    write_vector(context, out, indent, !strcmp(name, "spread") ? "gic_lane" : "gic_mask");
}

static void insert_batch_class(void *context, const char *name, Text *out, int indent)
{
    BatchGeneration *b = context;
    const char *class = b->g.sequence->class[b->g.class].name;
    const Layout *layout = &b->g.plan->formula[b->g.class]->layout;
    if (strcmp(name, "kept") != 0) {
        insert_subset(context, name, out, indent);
        return;
    }
    line(out, indent, "enum { %s_Q = %d, %s_START = %d, %s_MOTION = %d, %s_INERTIA = %d };", class, 7 * layout->bodies,
         class, layout->start_size, class, layout->bodies * layout->motion_size, class, room(layout->inertia_size));
    line(out, indent, "struct {");
    line(out, indent + 4, "gic_lane q[%s_Q], start[%s_START], motion[%s_MOTION], inertia[%s_INERTIA];", class, class,
         class, class);
    line(out, indent, "} kept;");
}

static void write_batch_classes(BatchGeneration *b, Text *out)
{
    Generation *g = &b->g;
    for (g->class = 0; g->class < g->sequence->classes; ++g->class) {
        Text body = {.pool = g->pool};
        const char *way = g->plan->formula[g->class]->closed ? "batch_closed.c.in" : "batch_subset.c.in";
        template_expand(g->pool, &body, g->templates, way, g->model->name, g->sequence->class[g->class].name,
                        insert_batch_class, b);
        write_class_constants(g, out); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
    g->class = 0;
}

static void write_batch_calls(const Generation *g, Text *out, int indent)
{
    const Sequence *sequence = g->sequence;
    const Plan *plan = g->plan;
    const char *model = g->model->name;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        const Class *class = &sequence->class[subset->class];
        const bool closed = plan->formula[subset->class]->closed;
        const char *old = closed ? "" : pool_print(g->pool, "old + %d, ", plan->start_offset[s]);
        line(out, indent, "/* stage %d: %s */", subset->stage, subset_title(g->pool, g->model, subset));
        for (int i = 0; i < subset->knowns; ++i)
            line(out, indent, "links->known[%d] = work->motion + %d; /* %s */", i,
                 plan->motion_offset[subset->known[i]], g->model->body[subset->known[i]].name);
        for (int j = 0; j < subset->deps; ++j) {
            line(out, indent, "links->x[%d] = start[%d]; /* %s */", j, subset->dep[j],
                 g->model->coordinate[subset->dep[j]].name);
            line(out, indent, "links->rate[%d] = xd[%d];", j, subset->dep[j]);
            if (!closed)
                line(out, indent, "links->change[%d] = %s;", j,
                     change_text(g, "lane_unwound(%s, R(0.0))", subset->dep[j]));
        }
        if (plan->formula[subset->class]->derived)
            line(out, indent, "links->derived = self->derived + %d;", plan->derived_offset[s]);
        line(out, indent, "%s_solve_%s(work, %s_k_%s[%d], links, %sstart + %d,", model, class->name, model, class->name,
             class_place(class, s), old, plan->start_offset[s]);
        line(out, indent + 4, "work->motion + %d, work->inertia + %d);", plan->motion_offset[subset->body[0]],
             plan->inertia_offset[s]);
        line(out, indent, "%s_solved(work, &before, %d);", model, s);
    }
}

/* Lane by lane between a vehicle of its own, `one`, and the block. */
static void write_exchange(const Generation *g, Text *out, int indent, bool load)
{
    static const struct {
        const char *member, *count;
    } array[] = {{"state", "STATES"}, {"input", "INPUTS"}, {"output", "OUTPUTS"},  {"parameter", "PARAMETERS"},
                 {"port", "PORTS"},   {"rate", "STATES"},  {"history", "HISTORY"}, {"derived", "DERIVED"}};
    for (size_t a = 0; a < sizeof array / sizeof *array; ++a) {
        const char *member = array[a].member;
        if (!strcmp(member, "derived") && !g->model->tuning)
            continue;
        if (!strcmp(member, "history"))
            line(out, indent, "for (i = 0; i < 2 * %s_STATES; ++i)", g->upper);
        else
            line(out, indent, "for (i = 0; i < %s_%s; ++i)", g->upper, array[a].count);
        if (load)
            line(out, indent + 4, "block->%s[i][l] = one->%s[i];", member, member);
        else
            line(out, indent + 4, "one->%s[i] = block->%s[i][l];", member, member);
    }
    line(out, indent, "for (i = 0; i < %s_DISCRETES; ++i)", g->upper);
    if (load)
        line(out, indent + 4, "block->discrete[i][l] = one->discrete[i];");
    else
        line(out, indent + 4, "one->discrete[i] = (int32_t)block->discrete[i][l];");
}

/* Has a geometric parameter changed since set-up? */
static void write_batch_tuned(const Generation *g, Text *out, int indent)
{
    int place = 0;
    for (int i = 0; i < g->model->parameters; ++i) {
        const Parameter *parameter = &g->model->parameter[i];
        if (parameter->geometric)
            line(out, indent, "NEED(self->parameter[%d] == self->derived[%d], GIC_ERROR_TUNED); /* %s */",
                 parameter->index, place++, parameter->name);
    }
}

static void write_batch_banner(const BatchGeneration *b, Text *out)
{
    const Generation *g = &b->g;
    text_print(out,
               "/* SPDX-License-Identifier: MIT\n *\n * %s: %d vehicles at once, %d in the lanes of a vector.\n *\n",
               g->model->name, b->batch->vehicles, b->batch->lanes);
    text_print(out, " * Generated by gicgen %s; model hash %s. Change the model, not this file.\n", GICGEN_VERSION,
               g->formulation->hash);
    text_print(
        out,
        " * Compile with %s.c, as `gicgen` writes it, and gic_runtime.c, by gcc or clang: -O3 -march=native, for\n"
        " * threads -fopenmp. With -ffp-contract=off every vehicle has the bits that %s.c gives. */\n",
        g->model->name, g->model->name);
}

static void insert_batch(void *context, const char *name, Text *out, int indent);

static void insert_file(BatchGeneration *b, Text *out, const char *name, Insert *insert)
{
    template_expand(b->g.pool, out, b->g.templates, name, b->g.model->name, NULL, insert, b);
}

static void insert_batch(void *context, const char *name, Text *out, int indent)
{
    BatchGeneration *b = context;
    Generation *g = &b->g;
    if (!strcmp(name, "banner")) {
        write_batch_banner(b, out);
    } else if (!strcmp(name, "lanes")) {
        insert_file(b, out, "batch_lanes.c.in", insert_lanes);
    } else if (!strcmp(name, "classes")) {
        write_batch_classes(b, out);
    } else if (!strcmp(name, "links") || !strcmp(name, "derived")) {
        if (g->model->tuning && *name == 'l')
            line(out, indent, "const gic_lane *derived; /* numbers of the subset that follow geometric parameters */");
        else if (g->model->tuning)
            line(out, indent, "%s_lane derived[%s_DERIVED];", g->model->name, g->upper);
    } else if (!strcmp(name, "calls")) {
        write_batch_calls(g, out, indent);
    } else if (!strcmp(name, "unwind")) {
        write_unwinding(g, out, indent, true);
    } else if (!strcmp(name, "base")) {
        insert_file(b, out, g->model->free_base ? "batch_free.c.in" : "batch_fixed.c.in", insert_batch);
    } else if (!strcmp(name, "road")) {
        if (g->model->wheels)
            insert_file(b, out, "batch_road.c.in", insert_batch);
    } else if (!strcmp(name, "integrate")) {
        insert_file(b, out, "batch_integrate.c.in", insert_batch);
    } else if (!strcmp(name, "about")) {
        if (block_is_about(g->formulation->dynamics))
            insert_file(b, out, "batch_about.c.in", insert_batch);
    } else if (!strcmp(name, "abouts")) {
        emit_abouts(out, g->formulation->dynamics, indent);
    } else if (!strcmp(name, "blame")) {
        if (block_is_about(g->formulation->dynamics))
            line(out, indent, "%s_about(head);", g->model->name);
    } else if (!strcmp(name, "tuned")) {
        write_batch_tuned(g, out, indent);
    } else if (!strcmp(name, "load") || !strcmp(name, "store")) {
        write_exchange(g, out, indent, *name == 'l');
    } else if (!strcmp(name, "hash")) {
        line(out, indent, "const char *const hash = \"%s\"; /* of the model that this file is of */",
             g->formulation->hash);
        line(out, indent, "const int layout = %d; /* of its instances */", plan_layout(g->pool, g->plan));
    } else {
        insert_code(context, name, out, indent);
    }
}

static void insert_batch_header(void *context, const char *name, Text *out, int indent)
{
    BatchGeneration *b = context;
    const Generation *g = &b->g;
    if (!strcmp(name, "guard")) {
        write_guard(g, out);
    } else if (!strcmp(name, "include")) {
        line(out, indent, "#include %s", quoted(g->pool, b->model_header));
    } else if (!strcmp(name, "sizes")) {
        line(out, indent, "%s_VEHICLES = %d,", g->upper, b->batch->vehicles);
        line(out, indent, "%s_LANES = %d,", g->upper, b->batch->lanes);
        line(out, indent, "%s_BLOCKS = %d", g->upper, (b->batch->vehicles + b->batch->lanes - 1) / b->batch->lanes);
    } else {
        insert_batch(context, name, out, indent);
    }
}

const char *batch_missing(const Formulation *formulation)
{
    if (formulation->wheels)
        return "wheels with tires";
    if (formulation_reacts(formulation))
        return "outputs of reactions, which the reduced form finds afterwards";
    return NULL;
}

void generate_batch(Pool *pool, const Formulation *formulation, const Batch *batch, const char *templates,
                    const char *model_header, const char *header, Text *c, Text *h)
{
    const char *name = formulation->model->name;
    Style own = style_lanes;
    own.prefix = pool_print(pool, "%s_", name);
    BatchGeneration b = {
        .g = {.pool = pool,
              .formulation = formulation,
              .model = formulation->model,
              .sequence = formulation->sequence,
              .plan = formulation->plan,
              .style = &own,
              .templates = templates,
              .header = header,
              .upper = capital(pool, name),
              .guard = pool_print(pool, "%s_BATCH_H", capital(pool, name)),
              .constants = pool_alloc(pool, (size_t)(formulation->sequence->classes + 1) * sizeof(Constants))},
        .batch = batch,
        .model_header = model_header};
    b.g.pair = header_number(&b.g, "batch.h.in", insert_batch_header, &b);
    template_expand(pool, c, templates, "batch.c.in", name, NULL, insert_batch, &b);
    template_expand(pool, h, templates, "batch.h.in", name, NULL, insert_batch_header, &b);
}
