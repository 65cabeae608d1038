/* SPDX-License-Identifier: MIT
 * Code in which members of a class are solved side by side, in the lanes of vectors: vehicle/lanes.c says where their
 * numbers stand. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* ---- types ---------------------------------------------------------------------------------------------------- */

/* One step of a sum over `lanes` lanes that transposes them. */
typedef struct FoldStep {
    int lanes, step;
} FoldStep;

/* The shuffle of two vectors x and y that puts at lane l what lane l or, with `other`, l ^ 2^step has: of x where that
 * bit of l is `other`, of y where not. */
static void write_shuffle(const FoldStep *fold, Text *out, bool other)
{
    const int bit = 1 << fold->step;
    text_print(out, "__builtin_shufflevector(x, y");
    for (int l = 0; l < fold->lanes; ++l)
        text_print(out, ", %d", (l & bit ? fold->lanes : 0) + (other ? l | bit : l & ~bit));
    text_print(out, ")");
}

static void write_shuffles(void *context, Text *out, int indent)
{
    const FoldStep *fold = context;
    text_print(out, "%*sreturn ", indent, "");
    write_shuffle(fold, out, false);
    text_print(out, " +\n%*s", indent + 4, "");
    write_shuffle(fold, out, true);
    text_print(out, ";\n");
}

static void write_sums(void *context, Text *out, int indent)
{
    const FoldStep *fold = context;
    const int bit = 1 << fold->step;
    for (int l = 0; l < fold->lanes; ++l)
        line(out, indent, "%c[%d] + %c[%d],", l & bit ? 'y' : 'x', l & ~bit, l & bit ? 'y' : 'x', l | bit);
}

static const Insertion fold_point[] = {{"shuffles", write_shuffles}, {"sums", write_sums}, {NULL, NULL}};

const Insertions lane_fold_points = {(const char *const[]){"lanes_fold.c.in", NULL}, fold_point, NULL};

/* Texts that depend on the number of lanes, which is the context. */
static void write_spread(void *context, Text *out, int indent)
{
    const int lanes = *(const int *)context;
    text_print(out, "%*sconst gic_lane_%d all = {", indent, "", lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(out, l ? ", x" : "x");
    text_print(out, "};\n");
    line(out, indent, "return all;");
}

static void write_set(void *context, Text *out, int indent)
{
    const int lanes = *(const int *)context;
    (void)indent;
    text_print(out, "LANE_FUNCTION gic_lane_%d lane_%d_set(", lanes, lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(out, "%sgic_real x%d", l ? ", " : "", l);
    text_print(out, ")\n{\n    const gic_lane_%d all = {", lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(out, "%sx%d", l ? ", " : "", l);
    text_print(out, "};\n    return all;\n}\n\n");
}

static void write_halves(void *context, Text *out, int indent)
{
    const int lanes = *(const int *)context;
    (void)indent;
    if (lanes <= 2)
        return;
    text_print(out, "/* From half as many here and half as many there. */\n");
    text_print(out, "LANE_FUNCTION gic_lane_%d lane_%d_halves(const gic_real *x, const gic_real *y)\n{\n", lanes,
               lanes);
    line(out, 0, "#if defined(__clang__) || __GNUC__ >= 12");
    line(out, 4,
         "typedef gic_real half __attribute__((vector_size(%d * sizeof(gic_real)), "
         "aligned(sizeof(gic_real)), may_alias));",
         lanes / 2);
    text_print(out,
               "    return __builtin_shufflevector(*(const half *)(const void *)x, *(const half *)(const void *)y");
    for (int l = 0; l < lanes; ++l)
        text_print(out, ", %d", l);
    text_print(out, ");\n#else\n    return lane_%d_set(", lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(out, "%s%s[%d]", l ? ", " : "", l < lanes / 2 ? "x" : "y", l % (lanes / 2));
    text_print(out, ");\n#endif\n}\n\n");
}

static void write_found(void *context, Text *out, int indent)
{
    const int lanes = *(const int *)context;
    text_print(out, "%*s", indent, "");
    for (int l = 0; l < lanes; ++l)
        text_print(out, "%sfound[i][%d]", l ? ", " : "", l);
    text_print(out, ");\n");
}

static void write_sum(void *context, Text *out, int indent)
{
    const int lanes = *(const int *)context;
    text_print(out, "%*sreturn ", indent, "");
    for (int l = 0; l < lanes / 2; ++l)
        text_print(out, "%s(x[%d] + x[%d])", l ? " + " : "", l, l + lanes / 2);
    text_print(out, ";\n");
}

static const Insertion width_point[] = {{"spread", write_spread}, {"set", write_set}, {"halves", write_halves},
                                        {"found", write_found},   {"sum", write_sum}, {NULL, NULL}};

const Insertions lane_width_points = {(const char *const[]){"lanes.c.in", "lanes_width.c.in", "lanes_road.c.in", NULL},
                                      width_point, NULL};

static bool has_width(const Plan *plan, int lanes)
{
    bool has = lanes == plan->pack;
    for (int c = 0; c < plan->sequence->classes; ++c)
        has = has || plan->class_lanes[c] == lanes;
    return has;
}

void write_lane_types(Generation *g, Text *out)
{
    template_expand(g->pool, out, g->templates, "lanes.c.in", g->model->name, NULL, &lane_width_points, NULL);
    for (int lanes = 2; lanes <= g->plan->lanes; lanes *= 2) {
        const char *const width = pool_print(g->pool, "%d", lanes);
        if (!has_width(g->plan, lanes))
            continue;
        line(out, 0, "#ifndef GIC_LANE_%d /* as above */", lanes);
        line(out, 0, "#define GIC_LANE_%d", lanes);
        template_expand(g->pool, out, g->templates, "lanes_width.c.in", g->model->name, width, &lane_width_points,
                        &lanes);
        for (FoldStep fold = {lanes, 0}; 1 << fold.step < lanes; ++fold.step)
            template_expand(g->pool, out, g->templates, "lanes_fold.c.in", pool_print(g->pool, "%d", fold.step), width,
                            &lane_fold_points, &fold);
        line(out, 0, "#endif");
        text_print(out, "\n");
    }
}

void write_lane_road(Generation *g, Text *out)
{
    int lanes = g->plan->pack;
    template_expand(g->pool, out, g->templates, "lanes_road.c.in", g->model->name, pool_print(g->pool, "%d", lanes),
                    &lane_width_points, &lanes);
}

void write_lane_links(Generation *g, Text *out)
{
    for (int lanes = 2; lanes <= g->plan->lanes; lanes *= 2) {
        if (!has_width(g->plan, lanes))
            continue;
        line(out, 0, "/* The same of %d subsets side by side. */", lanes);
        line(out, 0, "typedef struct %s_links_%d {", g->model->name, lanes);
        line(out, 4, "const gic_real *known[%s_KNOWN_ROOM];", g->upper);
        line(out, 4,
             "gic_lane_%d x[%s_DEPENDENCE_ROOM], rate[%s_DEPENDENCE_ROOM], change[%s_DEPENDENCE_ROOM], turn[3], "
             "ahead[1];",
             lanes, g->upper, g->upper, g->upper);
        if (g->model->tuning)
            line(out, 4, "const gic_lane_%d *derived;", lanes);
        line(out, 4, "int cold;");
        line(out, 0, "} %s_links_%d;\n", g->model->name, lanes);
    }
}

/* ---- where the lanes of a row find what they are connected to ---------------------------------------------------- */

typedef struct LaneRow {
    const Generation *g;
    const Class *class;
    int number; /* of the class */
    int index, first, lanes;
} LaneRow;

/* Place in the class of the member that has lane `at` of all; lanes after the last one repeat it. */
static int lane_place(const Plan *plan, int class, int at)
{
    const int last = plan->lane_members[class] - 1;
    return plan->lane_member[class][at < last ? at : last];
}

/* Subset of a lane. */
static const Subset *row_subset(const LaneRow *row, int lane)
{
    const int member = lane_place(row->g->plan, row->number, row->first + lane);
    return &row->g->sequence->subset[row->class->member[member]];
}

static int known_offset(const LaneRow *row, int lane, int known)
{
    return row->g->plan->motion_offset[row_subset(row, lane)->known[known]];
}

static int known_stride(const LaneRow *row, int lane, int known)
{
    int subset = row->g->sequence->body_subset[row_subset(row, lane)->known[known]];
    return row->g->plan->stride[subset];
}

/* Distance between two numbers of a known, as in Style; 0: the row copies them. */
static int known_reading(const LaneRow *row, int known)
{
    int stride = known_stride(row, 0, known), offset = known_offset(row, 0, known);
    bool same = true, beside = stride % row->lanes == 0;
    for (int l = 1; l < row->lanes; ++l) {
        if (known_stride(row, l, known) != stride)
            return 0;
        same = same && known_offset(row, l, known) == offset;
        beside = beside && known_offset(row, l, known) == offset + l;
    }
    return same ? -stride : beside ? stride : 0;
}

static LaneRow row_of(const Generation *g, int class, int index)
{
    int lanes = g->plan->class_lanes[class];
    return (LaneRow){g, &g->sequence->class[class], class, index, lanes * index, lanes};
}

/* The same for all rows of a class. */
static int class_reading(const Generation *g, int class, int known)
{
    int reading = 0;
    for (int r = 0; r < class_rows(g->plan, class); ++r) {
        const LaneRow row = row_of(g, class, r);
        int one = known_reading(&row, known);
        if (r && one != reading)
            return 0;
        reading = one;
    }
    return reading;
}

/* ---- functions of classes ------------------------------------------------------------------------------------------
 */

static bool solve_reads(const Formula *f, Array array, int which)
{
    return block_reads(&f->predict, array, which) || block_reads(&f->chord, array, which) ||
           block_reads(&f->solve, array, which) ||
           (f->polynomial &&
            (block_reads(&f->polynomial->within, array, which) || block_reads(&f->polynomial->solve, array, which)));
}

static void write_arguments(void *context, Text *out, int indent)
{
    const Generation *g = context;
    static const struct {
        Array array;
        const char *name;
    } part[] = {{ARRAY_x, "x"}, {ARRAY_rate, "rate"}, {ARRAY_change, "change"}};
    const Formula *f = g->plan->formula[g->class];
    const Subset *first = &g->sequence->subset[g->sequence->class[g->class].member[0]];
    const int lanes = g->style->width;
    if (solve_reads(f, ARRAY_d, 0))
        line(out, indent, "const gic_lane_%d *const d = links->derived;", lanes);
    for (int i = 0; i < first->knowns; ++i) {
        const char *name = g->model->body[first->known[i]].name;
        if (!solve_reads(f, ARRAY_known, i))
            continue;
        if (g->style->known_stride[i] < 0)
            line(out, indent, "const gic_real *const m%d = links->known[%d]; /* %s */", i, i, name);
        else
            line(out, indent, "const gic_row_%d *const m%d = ROW_%d(links->known[%d]); /* %s */", lanes, i, lanes, i,
                 name);
    }
    for (int i = 0; i < 3; ++i)
        if (solve_reads(f, part[i].array, 0))
            line(out, indent, "const gic_lane_%d *const %s = links->%s;", lanes, part[i].name, part[i].name);
    line(out, indent, "const gic_lane_%d *const turn = links->turn, *const ahead = links->ahead;", lanes);
    if (solve_reads(f, ARRAY_s, 0))
        line(out, indent, "const gic_row_%d *const s = old + %d; /* unit velocities at the start */", lanes,
             f->layout.start_S);
    if (solve_reads(f, ARRAY_f, 0))
        line(out, indent, "const gic_row_%d *const f = old + %d; /* factors at the start */", lanes,
             f->layout.start_factors);
    if (!f->closed)
        line(out, indent, "gic_row_%d q[%d];", lanes, 7 * f->layout.bodies);
}

static void write_kept_start(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Layout *layout = &g->plan->formula[g->class]->layout;
    const char *class = g->sequence->class[g->class].name;
    line(out, indent, "enum { %s_Q = %d, %s_START = %d, %s_MOTION = %d, %s_INERTIA = %d };", class, 7 * layout->bodies,
         class, layout->start_size, class, layout->bodies * layout->motion_size, class, room(layout->inertia_size));
    if (g->plan->formula[g->class]->polynomial)
        line(out, indent, "enum { %s_MADE = %d }; /* place in a start: 1 if polynomials made it */", class,
             g->plan->formula[g->class]->polynomial->flag);
    line(out, indent, "struct {");
    line(out, indent + 4, "gic_row_%d q[%s_Q], start[%s_START], motion[%s_MOTION], inertia[%s_INERTIA];",
         g->style->width, class, class, class, class);
    line(out, indent, "} kept;");
}

static void write_polynomial(void *context, Text *out, int indent);

static const Insertion lane_class_point[] = {{"solve arguments", write_arguments},
                                             {"kept", write_kept_start},
                                             {"polynomial lanes", write_polynomial},
                                             {NULL, NULL}};

const Insertions lane_class_points = {
    (const char *const[]){"lanes_subset.c.in", "lanes_polynomial.c.in", "lanes_closed.c.in", NULL}, lane_class_point,
    &subset_points};

static void write_polynomial(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->plan->formula[g->class]->polynomial)
        template_expand(g->pool, out, g->templates, "lanes_polynomial.c.in", g->model->name,
                        g->sequence->class[g->class].name, &lane_class_points, g);
}

/* Copy a text with the number of lanes for LANEWIDTH. */
static void write_with_width(Text *out, const char *s, int lanes)
{
    static const char word[] = "LANEWIDTH";
    for (const char *at; (at = strstr(s, word)) != NULL; s = at + sizeof word - 1)
        text_print(out, "%.*s%d", (int)(at - s), s, lanes);
    text_print(out, "%s", s);
}

/* Constants of the members of a class, row by row: the same of all lanes one after another. */
static void write_row_constants(const Generation *g, Text *out, const Constants *k)
{
    const Dag *dag = g->plan->formula[g->class]->dag;
    const Class *class = &g->sequence->class[g->class];
    const int rows = class_rows(g->plan, g->class), lanes = g->style->width, each = dag->samples / dag->members;
    line(out, 0, "static const gic_real %s_row_%s[%d][%d][%d] = {", g->model->name, class->name, rows, room(k->count),
         lanes);
    for (int r = 0; r < rows; ++r) {
        line(out, 4, "{");
        for (int i = 0; i < room(k->count); ++i) {
            text_print(out, "        {");
            for (int l = 0; l < lanes; ++l) {
                const int member = lane_place(g->plan, g->class, r * lanes + l);
                double value = k->count ? ex_value(dag, k->e[i], member * each) : 0;
                text_print(out, "%s%s", l ? ", " : "", emit_number(g->pool, value));
            }
            text_print(out, "},\n");
        }
        line(out, 4, "},");
    }
    line(out, 0, "};\n");
}

void write_lane_class(Generation *g, Text *out)
{
    const Class *class = &g->sequence->class[g->class];
    const Subset *first = &g->sequence->subset[class->member[0]];
    const bool closed = g->plan->formula[g->class]->closed;
    const Style *const usual = g->style;
    const Constants alone = g->constants[g->class];
    int stride[room(first->knowns)];
    for (int i = 0; i < first->knowns; ++i) {
        int reading = class_reading(g, g->class, i);
        stride[i] = reading ? reading : g->plan->class_lanes[g->class];
    }
    Style style = style_lanes;
    style.width = g->plan->class_lanes[g->class];
    style.known_stride = stride;
    style.prefix = usual->prefix;
    style.naming = usual->naming;
    style.derivatives = usual->derivatives;
    style.implicit = usual->implicit;
    Text body = {.pool = g->pool};
    g->style = &style;
    g->constants[g->class] = (Constants){0};
    template_expand(g->pool, &body, g->templates, closed ? "lanes_closed.c.in" : "lanes_subset.c.in", g->model->name,
                    class->name, &lane_class_points, g);
    write_row_constants(g, out, &g->constants[g->class]); /* known now that all blocks are text */
    write_with_width(out, body.s, style.width);
    g->constants[g->class] = alone;
    g->style = usual;
}

/* ---- calls */

/* A number a lane, of an array. */
static const char *numbers_text(const LaneRow *row, const char *array, const int *place)
{
    Pool *pool = row->g->pool;
    bool beside = true;
    for (int l = 1; l < row->lanes; ++l)
        beside = beside && place[l] == place[0] + l;
    if (beside)
        return pool_print(pool, "lane_%d_at(%s + %d)", row->lanes, array, place[0]);
    Text text = {.pool = pool};
    text_print(&text, "lane_%d_set(", row->lanes);
    for (int l = 0; l < row->lanes; ++l)
        text_print(&text, "%s%s[%d]", l ? ", " : "", array, place[l]);
    text_print(&text, ")");
    return text.s;
}

static void write_known(const LaneRow *row, Text *out, int indent, int known)
{
    const Generation *g = row->g;
    const Subset *first = row_subset(row, 0);
    const char *name = g->model->body[first->known[known]].name;
    if (class_reading(g, (int)(row->class - g->sequence->class), known)) {
        line(out, indent, "row.known[%d] = self->motion + %d; /* %s */", known, known_offset(row, 0, known), name);
        return;
    }
    int class = g->sequence->subset[g->sequence->body_subset[first->known[known]]].class;
    int count = g->plan->formula[class]->layout.motion_size;
    line(out, indent, "gic_lane_%d known%d[%d]; /* %s */", row->lanes, known, count, name);
    line(out, indent, "for (i = 0; i < %d; ++i) {", count);
    for (int l = 0; l < row->lanes; ++l)
        line(out, indent + 4, "known%d[i][%d] = self->motion[%d + %d * i];", known, l, known_offset(row, l, known),
             known_stride(row, l, known));
    line(out, indent, "}");
    line(out, indent, "row.known[%d] = (const gic_real *)known%d;", known, known);
}

static void write_change(const LaneRow *row, Text *out, int indent, int j, const int *place)
{
    bool unwinds = false;
    for (int l = 0; l < row->lanes; ++l)
        unwinds = unwinds || coordinate_unwinds(row->g->formulation, place[l]);
    if (!unwinds) {
        line(out, indent, "row.change[%d] = row.x[%d] - %s;", j, j, numbers_text(row, "old", place));
        return;
    }
    text_print(out, "%*srow.change[%d] = lane_%d_set(", indent, "", j, row->lanes);
    for (int l = 0; l < row->lanes; ++l)
        text_print(out, "%s%s", l ? ", " : "", change_text(row->g, "gic_unwound(%s)", place[l]));
    text_print(out, ");\n");
}

static void write_coordinates(const LaneRow *row, Text *out, int indent, bool closed)
{
    for (int j = 0; j < row_subset(row, 0)->deps; ++j) {
        int place[row->lanes];
        for (int l = 0; l < row->lanes; ++l)
            place[l] = row_subset(row, l)->dep[j];
        line(out, indent, "row.x[%d] = %s;", j, numbers_text(row, "start", place));
        line(out, indent, "row.rate[%d] = %s;", j, numbers_text(row, "xd", place));
        if (!closed)
            write_change(row, out, indent, j, place);
    }
}

static void write_derived(const LaneRow *row, Text *out, int indent, int count)
{
    line(out, indent, "gic_lane_%d derived[%d];", row->lanes, count);
    line(out, indent, "for (i = 0; i < %d; ++i) {", count);
    for (int l = 0; l < row->lanes; ++l) {
        int subset = (int)(row_subset(row, l) - row->g->sequence->subset);
        line(out, indent + 4, "derived[i][%d] = self->derived[%d + i];", l, row->g->plan->derived_offset[subset]);
    }
    line(out, indent, "}");
    line(out, indent, "row.derived = derived;");
}

/* Keep a solution that was for the same numbers; its part of the start is copied to the next start. */
static void write_kept(const LaneRow *row, Text *out, int indent, int members)
{
    const Plan *plan = row->g->plan;
    const Subset *first = row_subset(row, 0);
    const int subset = (int)(first - row->g->sequence->subset), offset = plan->start_offset[subset];
    text_print(out, "%*sconst int kept = links->again", indent, "");
    for (int j = 0; j < first->deps; ++j)
        for (int l = 0; l < members; ++l)
            if (!l || row_subset(row, l)->dep[j] != first->dep[j])
                text_print(out, " && links->same[%d]", row_subset(row, l)->dep[j]);
    for (int l = 0; l < members; ++l) {
        /* and of all that carries it */
        for (const Subset *at = row_subset(row, l); at->carrier != BODY_BASE;) {
            at = &row->g->sequence->subset[row->g->sequence->body_subset[at->carrier]];
            for (int j = 0; j < at->deps; ++j)
                text_print(out, " && links->same[%d]", at->dep[j]);
        }
    }
    text_print(out, ";\n");
    line(out, indent, "self->head.kept_count += kept ? %d : 0;", members);
    if (plan->formula[first->class]->layout.start_size)
        line(out, indent, "if (kept)\n%*smemcpy(start + %d, old + %d, %d * sizeof *start);", indent + 4, "", offset,
             offset, row->lanes * plan->formula[first->class]->layout.start_size);
}

void write_lane_call(const Generation *g, Text *out, int indent, int subset)
{
    const Plan *plan = g->plan;
    const int c = g->sequence->subset[subset].class, place = class_place(&g->sequence->class[c], subset);
    int at = 0;
    while (at < plan->lane_members[c] && plan->lane_member[c][at] != place)
        ++at;
    if (at % plan->class_lanes[c] || at == plan->lane_members[c]) /* not the first of a row; no lane: an image */
        return;
    const LaneRow row = row_of(g, c, at / plan->class_lanes[c]);
    const Formula *formula = plan->formula[c];
    const char *model = g->model->name, *class = row.class->name;
    const int members = plan->lane_members[c] - row.first, lanes = row.lanes;
    text_print(out, "%*s/* stage %d:", indent, "", g->sequence->subset[subset].stage);
    for (int l = 0; l < lanes && l < members; ++l)
        text_print(out, "%s %s", l ? "," : "", subset_title(g->pool, g->model, row_subset(&row, l)));
    text_print(out, " */\n%*s{\n", indent, "");
    indent += 4;
    line(out, indent, "%s_links_%d row;", model, lanes);
    line(out, indent, "int i, lane;");
    if (plan_keeps(plan, subset))
        write_kept(&row, out, indent, members < lanes ? members : lanes);
    line(out, indent, "for (i = 0; i < 3; ++i)");
    line(out, indent + 4, "row.turn[i] = LANE_%d(links->turn[i]);", lanes);
    line(out, indent, "row.ahead[0] = LANE_%d(links->ahead[0]);", lanes);
    line(out, indent, "row.cold = links->cold;");
    for (int i = 0; i < row_subset(&row, 0)->knowns; ++i)
        write_known(&row, out, indent, i);
    write_coordinates(&row, out, indent, formula->closed);
    if (formula->derived)
        write_derived(&row, out, indent, formula->derived);
    line(out, indent, "status = %s%s_solve_%s(self, ROW_%d(%s_row_%s[%d]), &row,",
         plan_keeps(plan, subset) ? "kept ? GIC_OK : " : "", model, class, lanes, model, class, row.index);
    if (!formula->closed)
        line(out, indent + 4, "ROW_%d(old + %d),", lanes, plan->start_offset[subset]);
    line(out, indent + 4, "ROW_%d(start + %d), ROW_%d(self->motion + %d), ROW_%d(self->inertia + %d), %d, &lane);",
         lanes, plan->start_offset[subset], lanes, plan->motion_offset[row_subset(&row, 0)->body[0]], lanes,
         plan->inertia_offset[subset], members < lanes ? members : lanes);
    line(out, indent, "if (status != GIC_OK) {");
    text_print(out, "%*sstatic const int32_t solved[%d] = {", indent + 4, "", lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(out, "%s%d", l ? ", " : "", (int)(row_subset(&row, l) - g->sequence->subset));
    text_print(out, "};\n");
    line(out, indent + 4, "self->head.subset = solved[lane];");
    line(out, indent + 4, "return status;");
    line(out, indent, "}");
    line(out, indent - 4, "}");
}

const char *alone_text(const Generation *g, const char *room, const char *array, const char *offset, int stride,
                       int count)
{
    if (stride == 1)
        return pool_print(g->pool, "%s + %s", array, offset);
    return pool_print(g->pool, "%s_alone(%s, %s + %s, %d, %d)", g->model->name, room, array, offset, stride, count);
}

/* ---- equations of motion */

void write_packed(Generation *g, Text *out)
{
    const Dag *dag = g->formulation->dynamics->dag;
    const int lanes = g->plan->pack;
    Text unused = {.pool = g->pool};
    block_emit(&unused, g->formulation->dynamics, g->style, &g->packed, 0); /* which constants it has */
    if (!g->packed.count)
        return;
    line(out, 0, "static const gic_real %s_lane_constant[%d][%d] = {", g->model->name, g->packed.count, lanes);
    for (int i = 0; i < g->packed.count; ++i) {
        text_print(out, "    {");
        for (int l = 0; l < lanes; ++l)
            text_print(out, "%s%s", l ? ", " : "", emit_number(g->pool, ex_value(dag, g->packed.e[i], l)));
        text_print(out, "},\n");
    }
    line(out, 0, "};\n");
}
