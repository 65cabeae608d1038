/* SPDX-License-Identifier: MIT
 * The functions of a class of subsets: recovery, residuals, reactions, with the constants of the members. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

static bool any_reads(const Block *const *block, int blocks, Array array, int which)
{
    bool any = false;
    for (int i = 0; i < blocks; ++i)
        any = any || block_reads(block[i], array, which);
    return any;
}

/* The coordinates that a subset depends on. */
static const char *coordinates_comment(const Generation *g, const Subset *subset)
{
    Text out = {.pool = g->pool};
    for (int j = 0; j < subset->deps; ++j)
        text_print(&out, "%s%s", j ? ", " : " /* ", g->model->coordinate[subset->dep[j]].name);
    text_print(&out, out.size ? " */" : "");
    return out.s;
}

/* Local names for the links that the blocks read. */
static void write_arguments(Generation *g, Text *out, int indent, const Block *const *block, int blocks)
{
    static const struct {
        Array array;
        const char *name;
    } part[] = {
        {ARRAY_x, "x"}, {ARRAY_rate, "rate"}, {ARRAY_change, "change"}, {ARRAY_turn, "turn"}, {ARRAY_ahead, "ahead"}};
    const char *real = style_real(g->style);
    const size_t before = out->size;
    if (any_reads(block, blocks, ARRAY_d, 0))
        line(out, indent, "const %s *const d = links->derived;", real);
    const Subset *first = &g->sequence->subset[g->sequence->class[g->class].member[0]];
    for (int i = 0; i < first->knowns; ++i)
        if (any_reads(block, blocks, ARRAY_known, i))
            line(out, indent, "const %s *const m%d = links->known[%d]; /* %s */", real, i, i,
                 g->model->body[first->known[i]].name);
    for (int i = 0; i < 5; ++i)
        if (any_reads(block, blocks, part[i].array, 0))
            line(out, indent, "const %s *const %s = links->%s;%s", real, part[i].name, part[i].name,
                 part[i].array == ARRAY_x ? coordinates_comment(g, first) : "");
    if (out->size == before)
        line(out, indent, "(void)links;");
}

/* The comment in front of a class's function. */
static void write_comment(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Formula *f = g->plan->formula[g->class];
    const Class *class = &g->sequence->class[g->class];
    const Subset *first = &g->sequence->subset[class->member[0]];
    (void)indent;
    text_print(out, "/* Class '%s': %d unknown%s of ", class->name, 6 * first->bodies,
               first->bodies * 6 == 1 ? "" : "s");
    for (int i = 0; i < class->members; ++i) {
        const Subset *subset = &g->sequence->subset[class->member[i]];
        for (int b = 0; b < subset->bodies; ++b)
            text_print(out, "%s%s", b ? " + " : i ? ", " : "", g->model->body[subset->body[b]].name);
    }
    text_print(out, ".\n * start: ");
    if (f->closed)
        text_print(out, "%s", f->layout.factors ? "factors" : "nothing");
    else
        text_print(out, "pose 7 numbers a body, S from %d, factors from %d", f->layout.start_S,
                   f->layout.start_factors);
    text_print(out, ". motion: c 0, A 3, omega 12, velocity 15, alpha 18,\n * acceleration 21, S 24. inertia: "
                    "first and second moments 0 3, force and moment 9 12, coordinates from 15. */\n");
}

static const Formula *formula_of(const Generation *g)
{
    return g->plan->formula[g->class];
}

static void write_solve_arguments(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Formula *f = formula_of(g);
    const char *real = style_real(g->style);
    const Block *const block[] = {&f->predict, &f->chord, &f->solve, f->polynomial ? &f->polynomial->solve : NULL,
                                  f->polynomial ? &f->polynomial->within : NULL};
    write_arguments(g, out, indent, block, f->polynomial ? 5 : 3);
    if (any_reads(block, 3, ARRAY_s, 0))
        line(out, indent, "const %s *const s = old + %d; /* unit velocities at the start */", real, f->layout.start_S);
    if (any_reads(block, 3, ARRAY_f, 0))
        line(out, indent, "const %s *const f = old + %d; /* factors at the start */", real, f->layout.start_factors);
    if (!f->closed)
        line(out, indent, "%s q[%d];", real, 7 * f->layout.bodies);
}

static void write_react_arguments(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Formula *f = formula_of(g);
    const char *real = style_real(g->style);
    const Block *const block = &f->react;
    const Subset *first = &g->sequence->subset[g->sequence->class[g->class].member[0]];
    write_arguments(g, out, indent, &block, 1);
    for (int i = 0; i < first->knowns; ++i)
        if (block_reads(block, ARRAY_onto, i))
            line(out, indent, "%s *const w%d = onto[%d];", real, i, i);
    if (block_reads(block, ARRAY_f, 0))
        line(out, indent, "const %s *const f = start + %d;", real, f->layout.start_factors);
}

static void write_residual_arguments(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_arguments(g, out, indent, (const Block *const[]){&formula_of(g)->residual}, 1);
}

static void write_enough(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const double distance = formula_of(g)->distance;
    line(out, indent, "const gic_real enough = GIC_ENOUGH(%s);", emit_number(g->pool, distance * distance));
}

static void write_pose(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "for (i = 0; i < %d; ++i)", 7 * formula_of(g)->layout.bodies);
    line(out, indent + 4, "q[i] = old[i];");
}

static void write_keep(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "for (i = 0; i < %d; ++i)", 7 * formula_of(g)->layout.bodies);
    line(out, indent + 4, "start[i] = q[i];");
}

void write_class_block(const Generation *g, const Block *block, Constants *constants, Text *out, int indent)
{
    Style style = *g->style;
    Naming naming;
    if (style.naming) {
        naming = *style.naming;
        naming.class = formula_of(g);
        naming.scope = SCOPE_CLASS;
        style.naming = &naming;
    }
    block_emit(out, block, &style, constants, indent);
}

static void write_block(const Generation *g, const Block *block, Text *out, int indent)
{
    write_class_block(g, block, &g->constants[g->class], out, indent);
}

static void write_predict(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->predict, out, indent);
}

static void write_chord(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->chord, out, indent);
}

static void write_solve(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->solve, out, indent);
}

static void write_react(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->react, out, indent);
}

static void write_residual(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->residual, out, indent);
}

static void write_within(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->polynomial->within, out, indent);
}

static void write_polynomial_solve(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->polynomial->solve, out, indent);
}

static void write_edge(void *context, Text *out, int indent)
{
    write_block(context, &formula_of(context)->polynomial->edge, out, indent);
}

static void write_made(void *context, Text *out, int indent)
{
    line(out, indent, "start[%d] = R(1.0);", formula_of(context)->polynomial->flag);
}

/* Derivatives are taken at the pose that was found. */
static void write_pose_made(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!g->style->derivatives && !g->style->implicit)
        return;
    line(out, indent, "{");
    write_edge(context, out, indent + 4);
    line(out, indent, "}");
    write_keep(context, out, indent);
}

static void write_not_made(void *context, Text *out, int indent)
{
    const int flag = formula_of(context)->polynomial->flag;
    line(out, indent, "start[%d] = R(0.0);", flag);
    line(out, indent, "if (old[%d] > R(0.0)) {", flag);
}

static void write_polynomial(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (formula_of(g)->polynomial)
        template_expand(g->pool, out, g->templates, "polynomial.c.in", g->model->name,
                        g->sequence->class[g->class].name, &subset_points, g);
}

static void write_recovery_loop(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    template_expand(g->pool, out, g->templates, "recovery_loop.c.in", g->model->name, g->sequence->class[g->class].name,
                    &subset_points, g);
}

static const Insertion subset_point[] = {{"comment", write_comment},
                                         {"solve arguments", write_solve_arguments},
                                         {"react arguments", write_react_arguments},
                                         {"residual arguments", write_residual_arguments},
                                         {"enough", write_enough},
                                         {"pose", write_pose},
                                         {"keep", write_keep},
                                         {"predict", write_predict},
                                         {"chord", write_chord},
                                         {"solve", write_solve},
                                         {"react", write_react},
                                         {"residual", write_residual},
                                         {"recovery loop", write_recovery_loop},
                                         {"polynomial", write_polynomial},
                                         {"within", write_within},
                                         {"polynomial solve", write_polynomial_solve},
                                         {"made", write_made},
                                         {"pose made", write_pose_made},
                                         {"not made", write_not_made},
                                         {"edge", write_edge},
                                         {NULL, NULL}};

const Insertions subset_points = {(const char *const[]){"subset.c.in", "recovery_loop.c.in", "polynomial.c.in",
                                                        "closed.c.in", "residual.c.in", "react.c.in", NULL},
                                  subset_point, NULL};

/* What the columns of a table of constants are. */
static void write_columns(Text *out, const Dag *dag, const Constants *k, const char *const *member)
{
    if (!k->count)
        return;
    text_print(out, "/* Columns%s%s:\n", dag->members > 1 ? ", with the names of " : "",
               dag->members > 1 ? member[0] : "");
    for (int j = 0; j < k->count; ++j) {
        const char *what = ex_origin(dag, k->e[j]);
        text_print(out, " * %4d  %s\n", j, what ? what : "a number that is computed from several of the model");
    }
    text_print(out, " */\n");
}

void write_constants(Generation *g, Text *out, const char *name, const Dag *dag, const Constants *k,
                     const char *const *member)
{
    int each = dag->samples / dag->members;
    write_columns(out, dag, k, member);
    line(out, 0, "static const gic_real %s_%s[%d][%d] = {", g->model->name, name, dag->members, room(k->count));
    for (int i = 0; i < dag->members; ++i) {
        line(out, 4, "{ /* %s */", member[i]);
        for (int j = 0; j < room(k->count); j += 4) {
            text_print(out, "       ");
            for (int l = j; l < j + 4 && l < room(k->count); ++l)
                text_print(out, " %s,", emit_number(g->pool, k->count ? ex_value(dag, k->e[l], i * each) : 0));
            text_print(out, "\n");
        }
        line(out, 4, "},");
    }
    line(out, 0, "};\n");
}

void write_class_constants(Generation *g, Text *out)
{
    const Class *class = &g->sequence->class[g->class];
    const char *member[class->members];
    for (int i = 0; i < class->members; ++i)
        member[i] = g->model->body[g->sequence->subset[class->member[i]].body[0]].name;
    write_constants(g, out, pool_print(g->pool, "k_%s", class->name), g->plan->formula[g->class]->dag,
                    &g->constants[g->class], member);
}

bool class_in_lanes(const Generation *g, int class)
{
    return g->plan->lanes && g->plan->class_lanes[class];
}

bool class_is_called(const Generation *g, int c)
{
    const Class *class = &g->sequence->class[c];
    for (int i = 0; i < class->members; ++i)
        if (!narrowing_image(g->formulation->narrowing, class->member[i]))
            return true;
    return false;
}

void write_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->plan->lanes)
        write_lane_links(g, out);
    for (g->class = 0; g->class < g->sequence->classes; ++g->class) {
        Text body = {.pool = g->pool};
        if (!class_is_called(g, g->class))
            continue;
        const char *way = g->plan->formula[g->class]->closed ? "closed.c.in" : "subset.c.in";
        if (class_in_lanes(g, g->class))
            write_lane_class(g, out);
        else
            template_expand(g->pool, &body, g->templates, way, g->model->name, g->sequence->class[g->class].name,
                            &subset_points, g);
        template_expand(g->pool, &body, g->templates, "residual.c.in", g->model->name,
                        g->sequence->class[g->class].name, &subset_points, g);
        if (g->plan->formula[g->class]->react.stores)
            template_expand(g->pool, &body, g->templates, "react.c.in", g->model->name,
                            g->sequence->class[g->class].name, &subset_points, g);
        write_class_constants(g, out); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
    g->class = 0;
}
