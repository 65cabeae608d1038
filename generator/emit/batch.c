/* SPDX-License-Identifier: MIT
 * Code for many vehicles at once: the same blocks as for one, each number a vector with one vehicle a lane. */
#include "base/text.h"
#include "base/version.h"
#include "emit/batch_private.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

typedef struct BatchGeneration {
    Generation g; /* first: what model_file.c's insertions get */
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

/* Do the vehicles have fast states? Then elementary functions are vectors', and rare steps are made one by one. */
static bool is_fast(const BatchGeneration *b)
{
    return b->g.formulation->wheels;
}

static void write_spread(void *context, Text *out, int indent)
{
    write_vector(context, out, indent, "gic_lane");
}

static void write_spread_whole(void *context, Text *out, int indent)
{
    write_vector(context, out, indent, "gic_mask");
}

static void write_width(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    line(out, indent, "#define GIC_LANES %d", b->batch->lanes);
}

static void write_more_lanes(void *context, Text *out, int indent);

static const Insertion lanes_point[] = {{"spread", write_spread},
                                        {"spread whole", write_spread_whole},
                                        {"width", write_width},
                                        {"more", write_more_lanes},
                                        {NULL, NULL}};

static const Insertions lanes_points = {
    (const char *const[]){"batch_lanes.c.in", "batch_vectors.c.in", "batch_more_lanes.c.in", NULL}, lanes_point, NULL};

static void write_more_lanes(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    template_expand(b->g.pool, out, b->g.templates, "batch_more_lanes.c.in", b->g.model->name, NULL, &lanes_points, b);
}

static void write_kept(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    const char *class = b->g.sequence->class[b->g.class].name;
    const Layout *layout = &b->g.plan->formula[b->g.class]->layout;
    line(out, indent, "enum { %s_Q = %d, %s_START = %d, %s_MOTION = %d, %s_INERTIA = %d };", class, 7 * layout->bodies,
         class, layout->start_size, class, layout->bodies * layout->motion_size, class, room(layout->inertia_size));
    if (b->g.plan->formula[b->g.class]->polynomial)
        line(out, indent, "enum { %s_MADE = %d }; /* place in a start: 1 if polynomials made it */", class,
             b->g.plan->formula[b->g.class]->polynomial->flag);
    line(out, indent, "struct {");
    line(out, indent + 4, "gic_lane q[%s_Q], start[%s_START], motion[%s_MOTION], inertia[%s_INERTIA];", class, class,
         class, class);
    line(out, indent, "} kept;");
}

static void write_made(void *context, Text *out, int indent);
static void write_cold(void *context, Text *out, int indent);
static void write_polynomial(void *context, Text *out, int indent);

static const Insertion class_point[] = {{"kept", write_kept},
                                        {"batch made", write_made},
                                        {"batch cold", write_cold},
                                        {"batch polynomial", write_polynomial},
                                        {NULL, NULL}};

static const Insertions class_points = {(const char *const[]){"batch_subset.c.in", "batch_closed.c.in",
                                                              "batch_made.c.in", "batch_cold.c.in",
                                                              "batch_polynomial.c.in", NULL},
                                        class_point, &subset_points};

/* A part of the recovery that only classes with polynomials have. */
static void write_part(BatchGeneration *b, Text *out, const char *part)
{
    const Generation *g = &b->g;
    if (g->plan->formula[g->class]->polynomial)
        template_expand(g->pool, out, g->templates, part, g->model->name, g->sequence->class[g->class].name,
                        &class_points, b);
}

static void write_made(void *context, Text *out, int indent)
{
    (void)indent;
    write_part(context, out, "batch_made.c.in");
}

static void write_cold(void *context, Text *out, int indent)
{
    (void)indent;
    write_part(context, out, "batch_cold.c.in");
}

static void write_polynomial(void *context, Text *out, int indent)
{
    (void)indent;
    write_part(context, out, "batch_polynomial.c.in");
}

static void write_batch_classes(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    Generation *g = &b->g;
    for (g->class = 0; g->class < g->sequence->classes; ++g->class) {
        Text body = {.pool = g->pool};
        if (!class_is_called(g, g->class))
            continue;
        const char *way = g->plan->formula[g->class]->closed ? "batch_closed.c.in" : "batch_subset.c.in";
        template_expand(g->pool, &body, g->templates, way, g->model->name, g->sequence->class[g->class].name,
                        &class_points, b);
        write_class_constants(g, out); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
    g->class = 0;
}

static void write_batch_calls(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Sequence *sequence = g->sequence;
    const Plan *plan = g->plan;
    const char *model = g->model->name;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || narrowing_image(g->formulation->narrowing, s))
            continue;
        const Class *class = &sequence->class[subset->class];
        const bool closed = plan->formula[subset->class]->closed;
        const char *old = closed ? "" : pool_print(g->pool, "old + %d, ", plan->start_offset[s]);
        line(out, indent, "/* stage %d: %s */", subset->stage, subset_title(g->pool, g->model, subset));
        for (int i = 0; i < subset->knowns; ++i)
            line(out, indent, "links->known[%d] = work->motion + %s; /* %s */", i,
                 body_motion_text(g, subset->known[i]), g->model->body[subset->known[i]].name);
        for (int j = 0; j < subset->deps; ++j) {
            const char *index = coordinate_text(g->pool, g->style->naming, subset->dep[j]);
            line(out, indent, "links->x[%d] = start[%s]; /* %s */", j, index,
                 g->model->coordinate[subset->dep[j]].name);
            line(out, indent, "links->rate[%d] = xd[%s];", j, index);
            if (!closed)
                line(out, indent, "links->change[%d] = %s;", j,
                     change_text(g, "lane_unwound(%s, R(0.0))", subset->dep[j]));
        }
        if (plan->formula[subset->class]->derived)
            line(out, indent, "links->derived = self->derived + %d;", plan->derived_offset[s]);
        line(out, indent, "%s_solve_%s(work, %s_k_%s[%d], links, %sstart + %d,", model, class->name, model, class->name,
             class_place(class, s), old, plan->start_offset[s]);
        line(out, indent + 4, "work->motion + %s, work->inertia + %s);", body_motion_text(g, subset->body[0]),
             subset_inertia_text(g, s));
        line(out, indent, "%s_solved(work, &before, %d);", model, s);
    }
}

/* True if a geometric parameter has changed since set-up. */
static void write_batch_tuned(void *context, Text *out, int indent)
{
    const Generation *g = context;
    int place = 0;
    for (int i = 0; i < g->model->parameters; ++i) {
        const Parameter *parameter = &g->model->parameter[i];
        if (parameter->geometric)
            line(out, indent, "NEED(self->parameter[%d] == self->derived[%d], GIC_ERROR_TUNED); /* %s */",
                 parameter->index, place++, parameter->name);
    }
}

static void write_batch_banner(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    Generation *g = &b->g;
    text_print(out,
               "/* SPDX-License-Identifier: MIT\n *\n * %s: %d vehicles at once, %d in the lanes of a vector.\n *\n",
               g->model->name, b->batch->vehicles, b->batch->lanes);
    text_print(out, " * Generated by gicgen %s; model hash %s. Change the model, not this file.\n", GICGEN_VERSION,
               g->formulation->hash);
    write_narrowing(g, out);
    write_curve_error(g, out);
    text_print(out,
               " * Compile with %s.c, as `gicgen` writes it under this name, and gic_runtime.c, by gcc or clang: -O3\n"
               " * -march=native, for threads -fopenmp. ",
               g->model->name);
    if (g->formulation->wheels && g->formulation->wheels->curves)
        text_print(out,
                   "Every vehicle has the bits that it has alone in such a batch; those of\n"
                   " * %s.c differ, for it has no short polynomials. */\n",
                   g->model->name);
    else
        text_print(out, "With -ffp-contract=off%s every vehicle has the bits that\n * %s.c gives. */\n",
                   is_fast(b) ? " -DGIC_BATCH_LIBM" : "", g->model->name);
}

/* ---- insertion points ------------------------------------------------------------------------------------------ */

static const Insertions batch_points;

static void write_template(BatchGeneration *b, Text *out, const char *name)
{
    template_expand(b->g.pool, out, b->g.templates, name, b->g.model->name, NULL, &batch_points, b);
}

static void write_lanes(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    template_expand(b->g.pool, out, b->g.templates, is_fast(b) ? "batch_vectors.c.in" : "batch_lanes.c.in",
                    b->g.model->name, NULL, &lanes_points, b);
}

static void write_links(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (b->g.model->tuning)
        line(out, indent, "const gic_lane *derived; /* numbers of the subset that follow geometric parameters */");
}

static void write_unwind(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    write_unwinding(&b->g, out, indent, true);
}

static void write_base(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    write_template(b, out, b->g.model->free_base ? "batch_free.c.in" : "batch_fixed.c.in");
}

static void write_road_lookup(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    if (b->g.model->wheels && (!b->g.formulation->narrowing || b->g.formulation->narrowing->road))
        write_batch_road(&b->g, out);
}

static void write_integrate(void *context, Text *out, int indent)
{
    (void)indent;
    write_template(context, out, "batch_integrate.c.in");
}

static void write_fast(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    if (is_fast(b))
        write_batch_fast(&b->g, out);
}

static void write_assume_caller(void *context, Text *out, int indent)
{
    write_batch_assume(context, out, indent, ABOUT_CALLER);
}

static void write_assume_state(void *context, Text *out, int indent)
{
    write_batch_assume(context, out, indent, ABOUT_STATE);
}

static void write_recover(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    line(out, indent, "%s_recover%s(self, work, turn);", b->g.model->name, is_fast(b) ? "_once" : "");
}

static void write_turn_wheels(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (is_fast(b))
        line(out, indent, "%s_turn_fast(self, work, y, e, rate + %s_SLOW);", b->g.model->name, b->g.upper);
}

static void write_steps(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    write_template(b, out, is_fast(b) ? "batch_fast_steps.c.in" : "batch_steps.c.in");
}

static void write_shift_lanes(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (!b->g.model->powertrain)
        return;
    line(out, indent, "if (lane_any(good))");
    line(out, indent + 4, "good &= ~%s_shifts(self, work);", b->g.model->name);
}

static void write_runs(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    write_template(b, out, is_fast(b) ? "batch_fast_runs.c.in" : "batch_runs.c.in");
}

static void write_dual(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (is_fast(b))
        line(out, indent, "%s_any_step_dual,", b->g.model->name);
    else
        line(out, indent, "NULL, /* there are no fast states */");
}

static void write_about(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    if (!block_is_about(b->g.formulation->dynamics))
        return;
    if (is_fast(b)) /* the code for one vehicle finds out what it is about */
        line(out, indent, "#define ABOUT(i) (-1000 - (i))\n");
    else
        write_template(b, out, "batch_about.c.in");
}

static void write_abouts(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    emit_abouts(out, b->g.formulation->dynamics, indent);
}

static void write_blame(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (block_is_about(b->g.formulation->dynamics))
        line(out, indent, "%s_about(head);", b->g.model->name);
}

static void write_load(void *context, Text *out, int indent)
{
    write_batch_exchange(context, out, indent, true);
}

/* Where a recovery follows the one before it, as Newton's iteration does, it might end elsewhere if it began again;
 * others give the same bits again. */
static void write_kept_work(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, followed_bodies(g->plan) ? "before->work = self->work;" : "before->recovered = lane_whole(0);");
}

static void write_store(void *context, Text *out, int indent)
{
    write_batch_exchange(context, out, indent, false);
}

static void write_hash(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    line(out, indent, "const char *const hash = \"%s\"; /* of the model that this file is of */",
         b->g.formulation->hash);
    line(out, indent, "const int layout = %d; /* of its instances */", plan_layout(b->g.pool, b->g.plan));
}

static const Insertion batch_point[] = {{"banner", write_batch_banner},
                                        {"lanes", write_lanes},
                                        {"classes", write_batch_classes},
                                        {"links", write_links},
                                        {"calls", write_batch_calls},
                                        {"unwind", write_unwind},
                                        {"base", write_base},
                                        {"road", write_road_lookup},
                                        {"fast", write_fast},
                                        {"assumptions", write_batch_assumptions},
                                        {"assume", write_assume_caller},
                                        {"assume state", write_assume_state},
                                        {"assumed", write_batch_assumed},
                                        {"recover", write_recover},
                                        {"turn wheels", write_turn_wheels},
                                        {"steps", write_steps},
                                        {"shift", write_shift_lanes},
                                        {"runs", write_runs},
                                        {"dual", write_dual},
                                        {"integrate", write_integrate},
                                        {"about", write_about},
                                        {"abouts", write_abouts},
                                        {"blame", write_blame},
                                        {"tuned", write_batch_tuned},
                                        {"kept work", write_kept_work},
                                        {"load", write_load},
                                        {"store", write_store},
                                        {"hash", write_hash},
                                        {NULL, NULL}};

static const Insertions batch_points = {(const char *const[]){"batch.c.in", "batch_integrate.c.in", "batch_free.c.in",
                                                              "batch_fixed.c.in", "batch_about.c.in",
                                                              "batch_steps.c.in", "batch_runs.c.in",
                                                              "batch_fast_steps.c.in", "batch_fast_runs.c.in", NULL},
                                        batch_point, &code_points};

static void write_derived(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    if (b->g.model->tuning)
        line(out, indent, "%s_lane derived[%s_DERIVED];", b->g.model->name, b->g.upper);
}

static void write_include(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    line(out, indent, "#include %s", quoted(b->g.pool, b->model_header));
}

static void write_sizes(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    const Batch *batch = b->batch;
    line(out, indent, "%s_VEHICLES = %d,", b->g.upper, batch->vehicles);
    line(out, indent, "%s_LANES = %d,", b->g.upper, batch->lanes);
    line(out, indent, "%s_BLOCKS = %d", b->g.upper, (batch->vehicles + batch->lanes - 1) / batch->lanes);
}

static void write_work_type(void *context, Text *out, int indent);
static void write_dual_step(void *context, Text *out, int indent);

static void write_members(void *context, Text *out, int indent)
{
    const BatchGeneration *b = context;
    write_batch_members(&b->g, out, indent);
}

static const Insertion header_point[] = {
    {"banner", write_batch_banner}, {"guard", write_guard},     {"include", write_include},
    {"sizes", write_sizes},         {"derived", write_derived}, {"work", write_work_type},
    {"members", write_members},     {"dual", write_dual_step},  {NULL, NULL}};

static const Insertions header_points = {
    (const char *const[]){"batch.h.in", "batch_work.h.in", "batch_dual.h.in", NULL}, header_point, NULL};

static void write_header_template(BatchGeneration *b, Text *out, const char *name)
{
    template_expand(b->g.pool, out, b->g.templates, name, b->g.model->name, NULL, &header_points, b);
}

static void write_work_type(void *context, Text *out, int indent)
{
    (void)indent;
    write_header_template(context, out, "batch_work.h.in");
}

static void write_dual_step(void *context, Text *out, int indent)
{
    BatchGeneration *b = context;
    (void)indent;
    if (is_fast(b))
        write_header_template(b, out, "batch_dual.h.in");
}

static void check_templates(Pool *pool, const char *templates)
{
    const Insertions *const points[] = {
        &batch_points,       &class_points,       &lanes_points,           &header_points,    &batch_fast_points,
        &batch_wheel_points, &batch_drive_points, &lane_assumption_points, &lane_road_points, NULL};
    templates_check(pool, templates, points);
}

const char *batch_missing(const Formulation *formulation)
{
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
    own.naming = naming_new(pool, formulation, capital(pool, name));
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
    check_templates(pool, templates);
    b.g.pair = header_number(&b.g, "batch.h.in", &header_points, &b);
    template_expand(pool, c, templates, "batch.c.in", name, NULL, &batch_points, &b);
    template_expand(pool, h, templates, "batch.h.in", name, NULL, &header_points, &b);
    c->s = wrap_lines(pool, c->s, &c->size);
    h->s = wrap_lines(pool, h->s, &h->size);
}
