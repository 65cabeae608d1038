/* SPDX-License-Identifier: MIT
 * What fills the insertion points of the templates. */
#include "base/table.h"
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <ctype.h>
#include <string.h>

/* The version of gic_runtime.h that emitted code is written for: GIC_ABI_VERSION. */
enum { ABI_VERSION = 10 };

/* ---- texts ------------------------------------------------------------------------------------------------ */

void line(Text *out, int indent, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *s = pool_vprint(out->pool, format, args);
    va_end(args);
    text_print(out, "%*s%s\n", indent, "", s);
}

const char *quoted(Pool *pool, const char *s)
{
    Text out = {.pool = pool};
    text_print(&out, "\"");
    for (char before = 0; *s; before = *s++) /* "??/" would be a backslash */
        text_print(&out, *s == '"' || *s == '\\' || (*s == '?' && before == '?') ? "\\%c" : "%c", *s);
    text_print(&out, "\"");
    return out.s;
}

const char *capital(Pool *pool, const char *s)
{
    char *out = pool_print(pool, "%s", s);
    for (char *c = out; *c; ++c)
        *c = (char)(isalnum((unsigned char)*c) ? toupper((unsigned char)*c) : '_');
    return out;
}

/* ---- header comment --------------------------------------------------------------------------------------------- */

void count_line(Text *out, const char *what, Count c)
{
    text_print(out, " *   %-52.52s %7d %9d %7d %6d %9d\n", what, c.add, c.multiply, c.divide, c.root, c.function);
}

static const char *members_text(const Generation *g, const Class *class, const Polynomial *p)
{
    Text out = {.pool = g->pool};
    for (int i = 0; i < class->members; ++i) {
        const Coordinate *c = &g->model->coordinate[g->sequence->subset[class->member[i]].dep[0]];
        text_print(&out, "%s%s in [%g, %g]", i ? ", " : "", c->name, p->low[i], p->high[i]);
    }
    return out.s;
}

/* Which subsets have polynomials, and what is known of them. */
static void write_polynomials(const Generation *g, Text *out)
{
    bool any = false;
    for (int c = 0; c < g->sequence->classes; ++c)
        any = any || g->plan->formula[c]->polynomial;
    if (!any)
        return;
    text_print(
        out,
        " *\n * Polynomials (--recovery polynomial) in place of Newton's iteration while a coordinate is within its\n"
        " * range, now and at the end of the step. Bound: of errors of places relative to the subset's size, of Euler\n"
        " * parameters, and of unit velocities and accelerations relative to the largest of their kind. Verified in\n"
        " * double precision against solutions in extended precision at the stated number of points of each range;\n"
        " * that series end below the bound is found from their coefficients, not proved between points.\n");
    for (int c = 0; c < g->sequence->classes; ++c) {
        const Class *class = &g->sequence->class[c];
        const Formula *f = g->plan->formula[c];
        const Polynomial *p = f->polynomial;
        if (p)
            text_print(
                out, " *   '%s': of %s;\n *       degree at most %d, bound %g, largest error found %.2g at %d points\n",
                class->name, members_text(g, class, p), p->degree, p->bound, p->worst, p->points);
        else if (f->exact_because)
            text_print(out, " *   '%s': none, for %s\n", class->name, f->exact_because);
    }
}

static void write_counts(Generation *g, Text *out)
{
    const Figures *figures = figures_new(g->pool, g->formulation);
    text_print(
        out,
        g->plan->solve == SOLVE_AUGMENTED
            ? " * Equations of motion in the augmented form (Serban and Haug 2000, eq. 16), bodies eliminated first.\n"
        : g->plan->solve == SOLVE_ARTICULATED
            ? " * Equations of motion in the articulated form: coordinates eliminated along chains, from the tips.\n"
            : " * Equations of motion in the reduced form (Serban and Haug 2000, Proposition 2.1).\n");
    text_print(
        out,
        " * Operations of one right-hand side; Newton's iteration: one correction with old factors, one with new:\n");
    text_print(out, " *   %-52s %7s %9s %7s %6s %9s\n", "", "add", "multiply", "divide", "root", "function");
    for (int c = 0; c < g->sequence->classes; ++c) {
        const Class *class = &g->sequence->class[c];
        count_line(out,
                   pool_print(g->pool, "subset '%s' (%d times%s)", class->name, figures->times[c],
                              g->plan->formula[c]->closed ? ", closed form" : ""),
                   figures_subset(figures, c, 1, 1));
        if (g->plan->formula[c]->polynomial)
            count_line(out, "  the same by polynomials", block_count(&g->plan->formula[c]->polynomial->solve));
    }
    count_line(out, "forces and equations of motion", figures->dynamics);
    wheel_counts(g, out, figures);
    count_line(out, "all together", figures_rhs(figures, 1, 1));
    count_line(out, "outputs, when asked for", figures_outputs(figures));
    if (g->formulation->contacts) {
        count_line(out, "look at contacts, with head.locate", figures_look(figures));
        template_expand(g->pool, out, g->templates, "work.c.in", g->model->name, NULL, &code_points, g);
    }
}

static void write_banner(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    const Model *model = g->model;
    text_print(out, "/* SPDX-License-Identifier: MIT\n *\n * %s: %s\n *\n", model->name,
               model->description[0] ? model->description : "a multibody model");
    text_print(out, " * Generated by gicgen %s; model hash %s. Change the model, not this file.\n", GICGEN_VERSION,
               g->formulation->hash);
    text_print(out, " * Compile with gic_runtime.c; how to call it: see %s.h and gic_runtime.h.\n *\n", model->name);
    Text table = {.pool = g->pool};
    sequence_print(&table, model, g->sequence);
    for (char *s = table.s, *end; *s; s = end + (*end != 0)) {
        end = s + strcspn(s, "\n");
        text_print(out, " *%s%.*s\n", end > s ? " " : "", (int)(end - s), s);
    }
    text_print(out, " *\n");
    write_narrowing(g, out);
    write_curve_error(g, out);
    write_counts(g, out);
    write_polynomials(g, out);
    text_print(out, " */\n");
}

/* ---- header: sizes and places */

int room(int count)
{
    return count ? count : 1;
}

/* Slow and fast ones. */
int states(const Generation *g)
{
    return g->plan->states + g->model->fast_states;
}

/* Subsets that a recovery solves. */
static int solutions(const Sequence *sequence)
{
    int count = 0;
    for (int s = 0; s < sequence->subsets; ++s)
        count += sequence->subset[s].class >= 0;
    return count;
}

/* Bodies whose poses a Newton start has. */
int followed_bodies(const Plan *plan)
{
    int bodies = 0;
    for (int s = 0; s < plan->sequence->subsets; ++s)
        bodies += plan_follows(plan, s) ? plan->sequence->subset[s].bodies : 0;
    return bodies;
}

static void write_sizes(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Model *model = g->model;
    const Plan *plan = g->plan;
    const struct {
        const char *name;
        int value;
    } size[] = {{"ABI", ABI_VERSION},
                {"FREE_BASE", model->free_base},
                {"STATES", states(g)},
                {"SLOW", plan->states},
                {"INPUTS", model->inputs},
                {"OUTPUTS", model->output_components},
                {"PARAMETERS", model->tunables},
                {"PORTS", 6 * model->ports},
                {"DISCRETES", model_discretes(model)},
                {"COORDINATES", model->coordinates},
                {"UNKNOWNS", plan->unknowns},
                {"SUBSETS", g->sequence->subsets},
                {"SOLUTIONS", solutions(g->sequence)},
                {"BODIES", model->bodies},
                {"FOLLOWED", followed_bodies(plan)},
                {"WHEELS", model->wheels},
                {"TWIST", model->free_base ? 7 + plan->free_coordinates : 0},
                {"STATE_ROOM", room(states(g))},
                {"INPUT_ROOM", room(model->inputs)},
                {"OUTPUT_ROOM", room(model->output_components)},
                {"PARAMETER_ROOM", room(model->tunables)},
                {"PORT_ROOM", room(6 * model->ports)},
                {"DISCRETE_ROOM", room(model_discretes(model))},
                {"COORDINATE_ROOM", room(model->coordinates)},
                {"UNKNOWN_ROOM", room(plan->unknowns)},
                {"START_ROOM", room(plan->start_size)},
                {"MOTION_ROOM", room(plan->motion_size)},
                {"INERTIA_ROOM", room(plan->inertia_size)},
                {"MULTIPLIER_ROOM", room(plan->multipliers)},
                {"LAYOUT", plan_layout(g->pool, plan)},
                {"CONDITIONS", conditions(g)},
                {"DERIVED", plan->derived->count},
                {"PIECES", model->tuning && model->tuning->assembles ? ASSEMBLY_PIECES : 1},
                {"KNOWN_ROOM", room(g->formulation->known_most)},
                {"DEPENDENCE_ROOM", room(g->formulation->dependence_most)}};
    size_t count = sizeof size / sizeof *size;
    write_wheel_sizes(g, out, indent);
    write_implicit_sizes(g, out, indent);
    if (g->formulation->contacts)
        line(out, indent, "%s_CONTACTS = %d,", g->upper, g->formulation->contacts->stores);
    for (size_t i = 0; i < count; ++i)
        line(out, indent, "%s_%s = %d%s", g->upper, size[i].name, size[i].value, i + 1 < count ? "," : "");
}

/* Places of states, inputs and outputs; the last line has no comma, for old C++ compilers. */
static void write_places(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Model *model = g->model;
    for (int i = 0; i < states(g); ++i) {
        const StateNumber number = state_number(g->pool, g->formulation, i);
        line(out, indent, "%s_STATE_%s = %d, /* %s */", g->upper, capital(g->pool, number.name), i, number.unit);
    }
    for (int i = 0; i < model->inputs; ++i)
        line(out, indent, "%s_INPUT_%s = %d, /* %s */", g->upper, capital(g->pool, model->input[i].name), i,
             model->input[i].unit);
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            line(out, indent, "%s_PARAMETER_%s = %d, /* %s */", g->upper, capital(g->pool, model->parameter[i].name),
                 model->parameter[i].index, model->parameter[i].unit);
    for (int i = 0; i < model->ports; ++i)
        line(out, indent, "%s_PORT_%s = %d, /* force x y z, N, torque x y z, N m */", g->upper,
             capital(g->pool, model->port[i].name), 6 * i);
    int index = 0;
    for (int i = 0; i < model->outputs; ++i)
        for (int c = 0; c < model->output[i].count; ++c, ++index)
            line(out, indent, "%s_OUTPUT_%s = %d, /* %s */", g->upper, capital(g->pool, model->output[i].component[c]),
                 index, model->output[i].unit[c]);
    line(out, indent, "%s_PLACES_END = 0", g->upper);
}

static void write_abi(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    text_print(out, "#if !defined(GIC_ABI_VERSION) || GIC_ABI_VERSION != %d\n", ABI_VERSION);
    text_print(
        out,
        "#error \"%s.h was generated for version %d of gic_runtime.h: use that one, or generate the model again\"\n",
        g->model->name, ABI_VERSION);
    text_print(out, "#endif\n");
}

void write_guard(void *context, Text *out, int indent)
{
    const Generation *g = context;
    (void)indent;
    text_print(out, "#define %s 0x%08x\n", g->guard, (unsigned)g->pair);
}

/* Two files are not replaced at once: where a kill comes between, code would read places of another header. */
static void write_include(void *context, Text *out, int indent)
{
    const Generation *g = context;
    (void)indent;
    if (!g->header)
        return;
    text_print(out, "#include %s\n\n", quoted(g->pool, g->header));
    text_print(out, "#if %s != 0x%08x\n", g->guard, (unsigned)g->pair);
    text_print(out, "#error \"this file and its header are not of the same run of gicgen: generate both again\"\n");
    text_print(out, "#endif\n\n");
}

uint32_t header_number(const Generation *g, const char *name, const Insertions *points, void *context)
{
    Text text = {.pool = g->pool};
    template_expand(g->pool, &text, g->templates, name, g->model->name, NULL, points, context);
    return (uint32_t)text_hash(text.s, text.size) | 1; /* not 0, as which an undefined macro counts */
}

/* ---- tuning, tables of the model, insertion points ----------------------------------------------------------- */

/* True if a geometric parameter has changed since set-up. */
static void write_tuned(void *context, Text *out, int indent)
{
    Generation *g = context;
    int place = 0;
    for (int i = 0; i < g->model->parameters; ++i) {
        const Parameter *parameter = &g->model->parameter[i];
        if (parameter->geometric) {
            line(out, indent, "if (self->parameter[%d] != self->derived[%d])", parameter->index, place++);
            line(out, indent + 4, "return self->head.status = GIC_ERROR_TUNED; /* %s */", parameter->name);
        }
    }
}

/* Tables of the model as the runtime interpolates them. */
static void write_lookup(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    const Model *model = g->model;
    if (!model->tables || (g->formulation->narrowing && !g->formulation->narrowing->tables))
        return;
    text_print(
        out,
        "/* ---- tables "
        "-------------------------------------------------------------------------------------------------- */\n\n");
    for (int i = 0; i < model->tables; ++i) {
        const Table *table = &model->table[i];
        const struct {
            const char *name;
            const double *value;
        } column[] = {{"x", table->x}, {"y", table->y}, {"slope", table->slope}};
        for (int c = 0; c < 3; ++c) {
            text_print(out, "static const gic_real %s_%s_%s[%d] = {", model->name, table->name, column[c].name,
                       table->count);
            for (int k = 0; k < table->count; ++k)
                text_print(out, "%s%s,", k % 6 ? " " : "\n    ", emit_number(g->pool, column[c].value[k]));
            text_print(out, "\n};\n");
        }
    }
    line(out, 0, "static const gic_table %s_table[%d] = {", model->name, model->tables);
    for (int i = 0; i < model->tables; ++i) {
        const Table *table = &model->table[i];
        line(out, 4, "{%s_%s_x, %s_%s_y, %s_%s_slope, %d, %d, %d},", model->name, table->name, model->name, table->name,
             model->name, table->name, table->count, table->cubic, table->onward);
    }
    line(out, 0, "};\n");
}

/* ---- insertion points of the header ----------------------------------------------------------------------------- */

static void write_derived(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->model->tuning)
        line(out, indent, "gic_real derived[%s_DERIVED]; /* numbers that follow geometric parameters, those first */",
             g->upper);
}

/* Right behind scratch, of which the runtime takes it for a part. */
static void write_whole_member(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->model->controllers)
        line(out, indent,
             "gic_real whole[GIC_WHOLE(%s_STATE_ROOM, %s_INPUT_ROOM, %s_OUTPUT_ROOM)]; /* a step's start, to return to "
             "*/",
             g->upper, g->upper, g->upper);
}

static void write_contact_member(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->formulation->contacts)
        line(out, indent,
             "gic_real touch[2 * %s_CONTACTS]; /* how near contacts were at the ends of the last two steps */",
             g->upper);
}

static const Insertion header_point[] = {{"banner", write_banner},
                                         {"guard", write_guard},
                                         {"abi", write_abi},
                                         {"sizes", write_sizes},
                                         {"whole", write_whole_member},
                                         {"wheels", write_wheel_members},
                                         {"derived", write_derived},
                                         {"contacts", write_contact_member},
                                         {"implicit", write_implicit_members},
                                         {"places", write_places},
                                         {"tangent", write_tangent_header},
                                         {NULL, NULL}};

static const Insertions header_points = {(const char *const[]){"model.h.in", NULL}, header_point, NULL};

/* ---- insertion points of tunable geometry ------------------------------------------------------------------------ */

static void write_plain_block(Generation *g, const Block *block, Text *out, int indent)
{
    Constants none = {0};
    block_emit(out, block, g->style, &none, indent);
}

static void write_derive(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, derive_block(g->pool, g->plan), out, indent);
}

static void write_draw(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, draw_block(g->pool, g->plan), out, indent);
}

static void write_assembled(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, design_block(g->pool, g->plan), out, indent);
}

static void write_first_piece(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "const int first = %d;", design_first_piece(g->pool, g->plan));
}

static const Insertion derive_point[] = {{"derive", write_derive},
                                         {"draw", write_draw},
                                         {"design", write_assembled},
                                         {"first piece", write_first_piece},
                                         {NULL, NULL}};

static const Insertions derive_points = {(const char *const[]){"derive.c.in", NULL}, derive_point, NULL};

static void write_tuning(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->tuning)
        template_expand(g->pool, out, g->templates, "derive.c.in", g->model->name, NULL, &derive_points, g);
}

/* ---- insertion points of the code: blocks ------------------------------------------------------------------------ */

static void write_dynamics(void *context, Text *out, int indent)
{
    Generation *g = context;
    block_emit(out, g->formulation->dynamics, g->style, &g->packed, indent);
    if (!states(g)) /* gcc 14 takes what is only passed on for read */
        line(out, indent, "rate[0] = 0; /* nothing moves */");
}

static void write_outputs(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->outputs, out, indent);
}

static void write_poses(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->poses, out, indent);
}

static void write_inverse(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->inverse, out, indent);
}

static void write_energy(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->energy, out, indent);
}

static void write_wrenches(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->wrenches, out, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->check, out, indent);
}

/* ---- insertion points of the code: other templates --------------------------------------------------------------- */

static void write_template(Generation *g, Text *out, const char *name)
{
    template_expand(g->pool, out, g->templates, name, g->model->name, NULL, &code_points, g);
}

static void write_bounds(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    write_template(g, out, "bounds.c.in");
    if (g->plan->lanes)
        write_lane_types(g, out);
}

static void write_base(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    write_template(g, out, g->model->free_base ? "base_free.c.in" : "base_fixed.c.in");
}

static void write_independent_equations(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->style->whole_self_test)
        write_template(g, out, "independent.c.in");
}

static void write_self_test(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    write_template(g, out, g->style->whole_self_test ? "self_test.c.in" : "self_test_constraints.c.in");
}

static void write_about(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (block_is_about(g->formulation->dynamics))
        write_template(g, out, "about.c.in");
}

static void write_reactions(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (formulation_reacts(g->formulation))
        write_template(g, out, "reactions.c.in");
}

static void write_road_lookup(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->wheels && (!g->formulation->narrowing || g->formulation->narrowing->road))
        write_road(g, out);
    if (g->model->wheels && g->plan->pack)
        write_lane_road(g, out);
}

/* ---- insertion points of the code: lines ------------------------------------------------------------------------- */

static void write_lane_constants(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->packed.count)
        line(out, indent, "const gic_row_%d *const k = ROW_%d(%s_lane_constant);", g->plan->pack, g->plan->pack,
             g->model->name);
}

static void write_design_stride(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->plan->lanes)
        line(out, indent, "int stride; /* from one number to the next */");
}

static void write_design_start(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "self->start[0][%s_design[body].place + i%s] = %s_design[body].q[i];", g->model->name,
         g->plan->lanes ? pool_print(g->pool, " * %s_design[body].stride", g->model->name) : "", g->model->name);
}

static void write_unwind(void *context, Text *out, int indent)
{
    write_unwinding(context, out, indent, false);
}

static void write_react(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!formulation_reacts(g->formulation))
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "status = %s_react(self, %s_time(self), self->state, e, self->rate);", g->model->name,
         g->model->name);
}

static void write_dynamics_comment(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->plan->pack)
        write_packed(g, out);
    if (g->plan->solve == SOLVE_AUGMENTED)
        text_print(out, "/* Applied forces, multipliers of all constraints once the bodies are eliminated, "
                        "accelerations.\n * rate = d state / dt; lambda: the multipliers that outputs need. */\n");
    else if (g->plan->solve == SOLVE_ARTICULATED)
        text_print(out, "/* Applied forces; coordinates of what is carried eliminated from the tips to the base, "
                        "accelerations from the base\n * to the tips. rate = d state / dt. */\n");
    else
        text_print(out,
                   "/* Applied forces, composite inertia, and elimination of %d accelerations: alpha and a of a "
                   "free base, then the\n"
                   " * free coordinates'. rate = d state / dt. */\n",
                   g->plan->unknowns);
}

static void write_defaults(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < g->model->inputs; ++i)
        line(out, indent, "%s, /* %s */", emit_number(g->pool, g->model->input[i].initial), g->model->input[i].name);
    if (!g->model->inputs)
        line(out, indent, "R(0.0)");
}

static void write_parameters(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < g->model->parameters; ++i)
        if (g->model->parameter[i].tunable)
            line(out, indent, "%s, /* %s */", emit_number(g->pool, g->model->parameter[i].value),
                 g->model->parameter[i].name);
    if (!g->model->tunables)
        line(out, indent, "R(0.0)");
}

static void write_links(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->model->tuning)
        line(out, indent, "const gic_real *derived; /* numbers of the subset that follow geometric parameters */");
}

static void write_begin(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "status = %s_%s;", g->model->name,
         g->model->tuning ? "assemble(self, turn)" : "recover(self, turn, 1)");
}

static void write_assume_caller(void *context, Text *out, int indent)
{
    write_assume(context, out, indent, ABOUT_CALLER);
}

static void write_assume_state(void *context, Text *out, int indent)
{
    write_assume(context, out, indent, ABOUT_STATE);
}

static void write_recover(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "status = %s_recover%s;", g->model->name,
         g->formulation->wheels ? "_once(self, turn)" : "(self, turn, 0)");
}

static void write_turn_wheels(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!g->formulation->wheels)
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "status = %s_turn_%s(self, time, y, e, rate + %s_SLOW);", g->model->name,
         g->formulation->wheels->count > 0 ? "wheels" : "states", g->upper);
}

static void write_press(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_plain_block(g, g->formulation->contacts, out, indent);
}

static void write_contact_function(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->formulation->contacts)
        template_expand(g->pool, out, g->templates, "contacts.c.in", g->model->name, NULL, &code_points, g);
}

static void write_identity(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "%s,", quoted(g->pool, g->model->name));
    line(out, indent, "%s,", quoted(g->pool, g->model->description));
    line(out, indent, "\"%s\",\n%*s\"gicgen %s\",", g->formulation->hash, indent, "", GICGEN_VERSION);
}

static const Insertion code_point[] = {{"banner", write_banner},
                                       {"include", write_include},
                                       {"bounds", write_bounds},
                                       {"links", write_links},
                                       {"layout", write_layout},
                                       {"classes", write_classes},
                                       {"pieces", write_pieces},
                                       {"calls", write_recovery_calls},
                                       {"unwind", write_unwind},
                                       {"gather", write_gathered},
                                       {"lookup", write_lookup},
                                       {"base", write_base},
                                       {"assumptions", write_assumptions},
                                       {"road", write_road_lookup},
                                       {"wheels", write_wheels},
                                       {"about", write_about},
                                       {"dynamics comment", write_dynamics_comment},
                                       {"lane constants", write_lane_constants},
                                       {"dynamics", write_dynamics},
                                       {"reactions", write_reactions},
                                       {"wrenches", write_wrenches},
                                       {"react calls", write_react_calls},
                                       {"outputs", write_outputs},
                                       {"poses", write_poses},
                                       {"residuals", write_residuals},
                                       {"balance", write_balance},
                                       {"tuned", write_tuned},
                                       {"assume", write_assume_caller},
                                       {"assume state", write_assume_state},
                                       {"recover", write_recover},
                                       {"turn wheels", write_turn_wheels},
                                       {"react", write_react},
                                       {"tables", write_tables},
                                       {"design stride", write_design_stride},
                                       {"design", write_design},
                                       {"initial", write_initial},
                                       {"defaults", write_defaults},
                                       {"parameters", write_parameters},
                                       {"tuning", write_tuning},
                                       {"gears", write_start_gears},
                                       {"design start", write_design_start},
                                       {"begin", write_begin},
                                       {"condition", write_condition},
                                       {"independent equations", write_independent_equations},
                                       {"inverse", write_inverse},
                                       {"energy", write_energy},
                                       {"self-test", write_self_test},
                                       {"wheel functions", write_wheel_functions},
                                       {"identity", write_identity},
                                       {"dual rate", write_dual_rate},
                                       {"press", write_press},
                                       {"contact function", write_contact_function},
                                       {"contacts", write_contacts},
                                       {"controllers", write_controllers},
                                       {"tangent", write_tangent_code},
                                       {"implicit code", write_implicit_code},
                                       {"implicit", write_implicit},
                                       {NULL, NULL}};

const Insertions code_points = {(const char *const[]){"model.c.in", "independent.c.in", "reactions.c.in", "bounds.c.in",
                                                      "base_free.c.in", "base_fixed.c.in", "contacts.c.in", "work.c.in",
                                                      "self_test.c.in", "self_test_constraints.c.in", "about.c.in",
                                                      NULL},
                                code_point, NULL};

/* ---- both files -------------------------------------------------------------------------------------------------- */

/* All templates of the code are checked, those too that this model does not need. */
static void check_templates(Pool *pool, const char *templates)
{
    const Insertions *const points[] = {&code_points,          &header_points,         &derive_points,
                                        &subset_points,        &lane_class_points,     &lane_width_points,
                                        &lane_fold_points,     &assumption_points,     &road_points,
                                        &wheels_points,        &wheel_points,          &wheel_lanes_points,
                                        &wheel_vector_points,  &dual_rate_points,      &powertrain_points,
                                        &states_points,        &states_rate_points,    &tangent_points,
                                        &tangent_class_points, &tangent_header_points, &columns_points,
                                        &columns_class_points, &columns_wheels_points, &columns_wheel_points,
                                        &implicit_points,      &curve_points,          NULL};
    templates_check(pool, templates, points);
}

void generate(Pool *pool, const Formulation *formulation, const Style *style, const char *templates, const char *header,
              Text *c, Text *h)
{
    const char *name = formulation->model->name;
    Style own = *style;
    own.prefix = pool_print(pool, "%s_", name);
    Naming naming = {0};
    if (!own.doubles) {
        naming = *naming_new(pool, formulation, capital(pool, name));
        own.naming = &naming;
    }
    Generation g = {.pool = pool,
                    .formulation = formulation,
                    .model = formulation->model,
                    .sequence = formulation->sequence,
                    .plan = formulation->plan,
                    .style = &own,
                    .templates = templates,
                    .header = header,
                    .upper = capital(pool, name),
                    .guard = pool_print(pool, "%s_H", capital(pool, name)),
                    .constants = pool_alloc(pool, (size_t)(formulation->sequence->classes + 1) * sizeof(Constants))};
    check_templates(pool, templates);
    g.pair = header_number(&g, "model.h.in", &header_points, &g);
    template_expand(pool, c, templates, "model.c.in", name, NULL, &code_points, &g);
    template_expand(pool, h, templates, "model.h.in", name, NULL, &header_points, &g);
    c->s = wrap_lines(pool, c->s, &c->size);
    h->s = wrap_lines(pool, h->s, &h->size);
}
