/* SPDX-License-Identifier: MIT
 * The function for all columns of the jacobian at once, with one for each class of subsets; columns that follow
 * geometric parameters are left to tangents, as all are where rate_columns() has none. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/columns.h"
#include "vehicle/vehicle.h"

const RateColumns *columns_of(Generation *g)
{
    const bool weighed = g->weighing;
    if (!g->columns_made[weighed]) {
        const int columns = jacobian_columns(g), wanted = weighed ? states(g) + g->model->inputs : columns;
        const bool *geometric = columns_apart(g);
        bool *apart = pool_alloc(g->pool, (size_t)columns + 1);
        const bool *kept = weighed && g->style->splitting ? g->style->splitting->implicit : NULL;
        for (int c = 0; c < columns; ++c)
            apart[c] = c >= wanted || geometric[c] || (kept && c < states(g) && !kept[c]);
        g->columns_made[weighed] = true;
        g->columns[weighed] = rate_columns(g->pool, g->formulation, apart, columns, weighed, kept);
    }
    return g->columns[weighed];
}

const RateColumns *weighed_columns(Generation *g)
{
    if (g->style->exact)
        return NULL;
    const bool before = g->weighing;
    g->weighing = true;
    const RateColumns *columns = columns_of(g);
    g->weighing = before;
    return columns;
}

const char *columns_name(const Generation *g)
{
    return g->weighing ? "forces" : "columns";
}

/* ---- classes of subsets -------------------------------------------------------------------------------------- */

typedef struct Expansion {
    Generation *g;
    Constants constants;
} Expansion;

static void write_knowns(void *context, Text *out, int indent)
{
    const Generation *g = ((Expansion *)context)->g;
    const Subset *first = &g->sequence->subset[g->sequence->class[g->class].member[0]];
    const Block *block = &g->columns[g->weighing]->motion[g->class]->block;
    for (int i = 0; i < first->knowns; ++i) {
        const char *name = g->model->body[first->known[i]].name;
        if (block_reads(block, ARRAY_known, i))
            line(out, indent, "const gic_real *const m%d = links->known[%d]; /* %s */", i, i, name);
        if (block_reads(block, ARRAY_column_known, i))
            line(out, indent, "const gic_real *const column%d = known[%d]; /* %s */", i, i, name);
    }
    if (block_reads(block, ARRAY_d, 0))
        line(out, indent, "const gic_real *const d = links->derived;");
}

static void write_motions(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_class_block(x->g, &x->g->columns[x->g->weighing]->motion[x->g->class]->block, &x->constants, out, indent);
}

static void write_class_columns(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    for (g->class = 0; g->class < g->sequence->classes; ++g->class) {
        const Class *class = &g->sequence->class[g->class];
        if (!g->columns[g->weighing]->motion[g->class]->size)
            continue;
        Expansion x = {.g = g};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->body[g->sequence->subset[class->member[i]].body[0]].name;
        const char *name = pool_print(g->pool, "%s_%s", columns_name(g), class->name);
        template_expand(g->pool, &body, g->templates, "columns_class.c.in", g->model->name, name, &columns_class_points,
                        &x);
        write_constants(g, out, pool_print(g->pool, "k_%s", name), g->plan->formula[g->class]->dag, &x.constants,
                        member);
        text_add(out, body.s, body.size);
    }
    g->class = 0;
}

void write_accelerations_of(const Generation *g, Text *out, int indent, const Subset *subset)
{
    for (int j = 0; j < subset->deps; ++j) {
        const Coordinate *c = &g->model->coordinate[subset->dep[j]];
        line(out, indent, "act[%d] = %s; /* %s */", 6 + j,
             c->driven ? pool_print(g->pool, "u[%s]", input_text(g->pool, g->style->naming, c->input + 2))
                       : pool_print(g->pool, "acc[%d]", g->plan->coordinate_unknown[subset->dep[j]]),
             c->name);
    }
}

/* Numbers of subset s that a function of columns is given: the address of the first `count` from `place` on of an
 * array. Where they stand in rows, and are read, of a copy without gaps, whose room is declared in `copies`. */
static const char *numbers_text(const Generation *g, Text *copies, const char *name, const char *array, int s,
                                const char *place, int count, bool read)
{
    const int stride = g->plan->stride[s];
    if (stride == 1 || !read)
        return pool_print(g->pool, "%s + %s", array, place);
    text_print(copies, "%s%s[%d]", copies->size ? ", " : "gic_real ", name, count);
    return pool_print(g->pool, "%s_without_gaps(%s, %s + %s, %d, %d)", g->model->name, name, array, place, stride,
                      count);
}

void write_columns_call(Generation *g, Text *out, int indent, int s)
{
    const Subset *subset = &g->sequence->subset[s];
    if (subset->class < 0 || !g->columns[g->weighing]->motion[subset->class]->size)
        return;
    const Class *class = &g->sequence->class[subset->class];
    const Block *block = &g->columns[g->weighing]->motion[subset->class]->block;
    const Generation *rows = reads_rows(g) ? g->lanes : g; /* whose places numbers have */
    const Layout *layout = &g->plan->formula[subset->class]->layout;
    const char *known[room(subset->knowns)], *q, *motion, *inertia;
    Text copies = {.pool = g->pool};
    for (int i = 0; i < subset->knowns; ++i) {
        const int body = subset->known[i], owner = g->sequence->body_subset[body];
        const int count = g->plan->formula[g->sequence->subset[owner].class]->layout.motion_size;
        known[i] = numbers_text(rows, &copies, pool_print(g->pool, "known%d", i), found_text(g, "motion"), owner,
                                body_motion_text(rows, body), count, block_reads(block, ARRAY_known, i));
    }
    q = numbers_text(rows, &copies, "q", "start", s, pool_print(g->pool, "%d", rows->plan->start_offset[s]),
                     7 * layout->bodies, block_reads(block, ARRAY_q, 0));
    motion = numbers_text(rows, &copies, "motion", found_text(g, "motion"), s, body_motion_text(rows, subset->body[0]),
                          layout->bodies * layout->motion_size, block_reads(block, ARRAY_motion, 0));
    inertia = numbers_text(rows, &copies, "inertia", found_text(g, "inertia"), s, subset_inertia_text(rows, s),
                           layout->inertia_size, block_reads(block, ARRAY_inertia, 0));
    line(out, indent, "/* stage %d: %s */", subset->stage, subset_title(g->pool, g->model, subset));
    if (copies.size) {
        line(out, indent, "{");
        indent += 4;
        line(out, indent, "%s;", copies.s);
    }
    for (int i = 0; i < subset->knowns; ++i) {
        line(out, indent, "links.known[%d] = %s;", i, known[i]);
        line(out, indent, "known[%d] = column + %d;", i,
             g->columns[g->weighing]->offset[g->sequence->body_subset[subset->known[i]]]);
    }
    for (int j = 0; j < subset->deps; ++j) {
        const char *index = coordinate_text(g->pool, g->style->naming, subset->dep[j]);
        line(out, indent, "links.x[%d] = self->x[%s], links.rate[%d] = self->xd[%s];", j, index, j, index);
    }
    if (g->plan->formula[subset->class]->derived)
        line(out, indent, "links.derived = self->derived + %d;", g->plan->derived_offset[s]);
    if (block_reads(block, ARRAY_acc, 0))
        write_accelerations_of(g, out, indent, subset);
    line(out, indent,
         "%s_%s_%s(%s_k_%s_%s[%d], &links, known, act, %s, %s, %s, "
         "column + %d);",
         g->model->name, columns_name(g), class->name, g->model->name, columns_name(g), class->name,
         class_place(class, s), q, motion, inertia, g->columns[g->weighing]->offset[s]);
    if (copies.size)
        line(out, indent - 4, "}");
}

static void write_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int s = 0; s < g->sequence->subsets; ++s)
        write_columns_call(g, out, indent, s);
}

/* ---- the whole vehicle --------------------------------------------------------------------------------------- */

/* acc[], and those of the base in act[]. */
static void write_accelerations(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    if (g->weighing) /* forces don't follow accelerations */
        return;
    block_emit(out, &columns_of(g)->accelerations, g->style, &none, indent);
    for (int i = 0; i < 6; ++i)
        if (g->model->free_base)
            line(out, indent, "act[%d] = acc[%d];", i, i);
        else if (i < 3)
            line(out, indent, "act[%d] = R(0.0), act[%d] = %s;", i, 3 + i, emit_number(g->pool, -g->model->gravity[i]));
}

void write_columns_turn(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < 3; ++i)
        if (g->model->free_base)
            line(out, indent, "links.turn[%d] = y[%s_TWIST + %d];", i, g->upper, 3 + i);
        else
            line(out, indent, "links.turn[%d] = R(0.0);", i);
}

static void write_residuals_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    block_emit(out, placed_block(g, &columns_of(g)->residuals), g->style, &none, indent);
}

static void write_solution(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    block_emit(out, placed_block(g, &columns_of(g)->solution), g->style, &none, indent);
}

static void write_rates(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    block_emit(out, placed_block(g, &columns_of(g)->block), g->style, &none, indent);
}

/* The columns that are left, by their numbers. */
static void write_apart(void *context, Text *out, int indent)
{
    Generation *g = context;
    const bool *apart = columns_apart(g);
    for (int c = 0; c < jacobian_columns(g); ++c)
        if (apart[c])
            line(out, indent, "%d,", c);
    line(out, indent, "-1 /* the end */");
}

static void write_work(void *context, Text *out, int indent)
{
    Generation *g = context;
    const RateColumns *columns = columns_of(g);
    line(out, indent, "gic_real acc[%s_UNKNOWN_ROOM], act[6 + %s_DEPENDENCE_ROOM] = {R(0.0)};", g->upper, g->upper);
    line(out, indent, "gic_real column[%d]%s, factor[%d], right[%s_UNKNOWN_ROOM][%s_COLUMN_LANES];",
         room(columns->size), columns->size ? "" : " = {R(0.0)}", room(columns->factors), g->upper, g->upper);
    if (columns->wheels)
        line(out, indent, "gic_real local[%d], part[%d][%s_COLUMN_LANES];", room(columns->wheels->locals),
             room(columns->wheels->parts), g->upper);
}

int column_lanes(Generation *g)
{
    const bool before = g->weighing;
    const RateColumns *weighed = g->style->implicit ? weighed_columns(g) : NULL;
    g->weighing = false;
    const RateColumns *whole = has_tangents(g) ? columns_of(g) : NULL;
    g->weighing = before;
    const int lanes = whole && weighed ? (whole->lanes > weighed->lanes ? whole->lanes : weighed->lanes)
                                       : (whole ? whole : weighed)->lanes;
    return room((lanes + 7) / 8 * 8);
}

static void write_lanes(void *context, Text *out, int indent)
{
    Generation *g = context;
    line(out, indent,
         "enum { %s_COLUMN_LANES = %d }; /* columns that change accelerations or fast rates, and some more, for "
         "vectors of them "
         "*/",
         g->upper, column_lanes(g));
}

static void write_weighed_lanes(void *context, Text *out, int indent)
{
    if (!has_tangents(context))
        write_lanes(context, out, indent);
}

static void write_wheel_functions_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    write_wheel_columns(g, out);
}

static void write_call_wheels(void *context, Text *out, int indent)
{
    Generation *g = context;
    if (!columns_of(g)->wheels)
        return;
    line(out, indent, "memset(part, 0, sizeof part);");
    line(out, indent, "status = %s_%s_wheels(self, time, y, e, column, local, part);", g->model->name, columns_name(g));
    line(out, indent, "if (status != GIC_OK)");
    line(out, indent + 4, "return status;");
}

/* The function that puts all this together. */
static void write_whole(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    template_expand(g->pool, out, g->templates, "columns_whole.c.in", g->model->name, columns_name(g), &columns_points,
                    g);
}

void write_weighed_columns(Generation *g, Text *out)
{
    g->weighing = true;
    write_row_copies(g, out);
    template_expand(g->pool, out, g->templates, is_spread(g) ? "columns_spread.c.in" : "columns_weighed.c.in",
                    g->model->name, NULL, &columns_points, g);
    g->weighing = false;
}

static void write_masses(void *context, Text *out, int indent)
{
    Generation *g = context;
    line(out, indent, "enum { %s_MASSES = %d };", g->upper, columns_of(g)->masses);
}

/* Numbers of a table; of none a 0, for C has no empty tables. */
static void write_table(Text *out, int indent, const int *number, int count)
{
    for (int i = 0; i < count; ++i)
        line(out, indent, "%d,", number[i]);
    if (count == 0)
        line(out, indent, "0,");
}

static void write_mass_rows(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_table(out, indent, columns_of(g)->mass_row, columns_of(g)->masses);
}

static void write_mass_columns(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_table(out, indent, columns_of(g)->mass_column, columns_of(g)->masses);
}

static void write_euler(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->free_base)
        template_expand(g->pool, out, g->templates, "columns_free.c.in", g->model->name, NULL, &columns_points, g);
}

static const Insertion class_point[] = {
    {"columns knowns", write_knowns}, {"columns motions", write_motions}, {NULL, NULL}};

const Insertions columns_class_points = {(const char *const[]){"columns_class.c.in", NULL}, class_point, NULL};

static const Insertion point[] = {{"columns classes", write_class_columns},
                                  {"columns found motions", write_found_motions},
                                  {"columns found inertias", write_found_inertias},
                                  {"columns found start", write_found_start},
                                  {"columns flat", write_flat_call},
                                  {"columns calls", write_calls},
                                  {"columns lanes", write_lanes},
                                  {"columns weighed lanes", write_weighed_lanes},
                                  {"columns wheels", write_wheel_functions_along},
                                  {"columns wheels call", write_call_wheels},
                                  {"columns rates", write_rates},
                                  {"columns accelerations", write_accelerations},
                                  {"columns turn", write_columns_turn},
                                  {"columns residuals", write_residuals_along},
                                  {"columns solution", write_solution},
                                  {"columns apart", write_apart},
                                  {"columns work", write_work},
                                  {"columns euler", write_euler},
                                  {"columns whole", write_whole},
                                  {"columns masses", write_masses},
                                  {"columns mass rows", write_mass_rows},
                                  {"columns mass columns", write_mass_columns},
                                  {"columns wheel functions", write_wheel_column_classes},
                                  {"columns shares work", write_shares_work},
                                  {"columns shares", write_shares},
                                  {"columns side by side", write_side_by_side},
                                  {"columns shares table", write_shares_table},
                                  {NULL, NULL}};

const Insertions columns_points = {(const char *const[]){"columns.c.in", "columns_whole.c.in", "columns_weighed.c.in",
                                                         "columns_free.c.in", "columns_apart.c.in",
                                                         "columns_spread.c.in", NULL},
                                   point, NULL};

void write_jacobian_columns(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    template_expand(g->pool, out, g->templates, columns_of(g) ? "columns.c.in" : "columns_apart.c.in", g->model->name,
                    NULL, &columns_points, g);
}
