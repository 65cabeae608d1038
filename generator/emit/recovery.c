/* SPDX-License-Identifier: MIT
 * The text of the recovery of the whole vehicle: its subsets in computational sequence. */
#include "base/text.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

/* Copies of numbers that stand in rows: of knowns, then of the subset itself. */
static void write_rooms(Generation *g, Text *out, int indent)
{
    int most = 1;
    for (int c = 0; c < g->sequence->classes; ++c) {
        const Layout *layout = &g->plan->formula[c]->layout;
        const int size[] = {layout->bodies * layout->motion_size, layout->start_size};
        for (int i = 0; i < 2; ++i)
            most = size[i] > most ? size[i] : most;
    }
    if (!g->plan->lanes)
        return;
    line(out, indent, "gic_real room[%s_KNOWN_ROOM + 2][%d];", g->upper, most);
    line(out, indent, "(void)room;");
}

static const char *room_text(const Generation *g, int index, const char *from)
{
    return pool_print(g->pool, "room[%s%s%d]", from, *from ? " + " : "", index);
}

static const char *known_text(const Generation *g, const Subset *subset, int i)
{
    const int owner = g->sequence->body_subset[subset->known[i]];
    const Formula *formula = g->plan->formula[g->sequence->subset[owner].class];
    return alone_text(g, room_text(g, i, ""), "self->motion", body_motion_text(g, subset->known[i]),
                      g->plan->stride[owner], formula->layout.motion_size);
}

static void write_knowns(Generation *g, Text *out, int indent, const Subset *subset)
{
    for (int i = 0; i < subset->knowns; ++i)
        line(out, indent, "links.known[%d] = %s; /* %s */", i, known_text(g, subset, i),
             g->model->body[subset->known[i]].name);
}

/* Motion of a subset's bodies, and its start. */
static const char *motion_text(const Generation *g, int s)
{
    const Subset *subset = &g->sequence->subset[s];
    const Layout *layout = &g->plan->formula[subset->class]->layout;
    return alone_text(g, room_text(g, 0, pool_print(g->pool, "%s_KNOWN_ROOM", g->upper)), "self->motion",
                      body_motion_text(g, subset->body[0]), g->plan->stride[s], layout->bodies * layout->motion_size);
}

static const char *start_text(const Generation *g, int s)
{
    const Layout *layout = &g->plan->formula[g->sequence->subset[s].class]->layout;
    return alone_text(g, room_text(g, 1, pool_print(g->pool, "%s_KNOWN_ROOM", g->upper)), "start",
                      pool_print(g->pool, "%d", g->plan->start_offset[s]), g->plan->stride[s], layout->start_size);
}

/* A coordinate's name after a line that has its number. */
static const char *coordinate_comment(const Generation *g, int coordinate)
{
    const bool named = g->style->naming && g->style->naming->coordinate;
    return named ? "" : pool_print(g->pool, " /* %s */", g->model->coordinate[coordinate].name);
}

/* The condition that all numbers are the same as before: of the subset and of what carries it, which has a variable for
 * it unless it is solved in lanes. */
static void write_same(const Generation *g, Text *out, const Subset *subset)
{
    Text own = {.pool = g->pool};
    const char *all = "links->again";
    for (const Subset *at = subset;;) {
        for (int j = 0; j < at->deps; ++j)
            text_print(&own, " && links->same[%s]", coordinate_text(g->pool, g->style->naming, at->dep[j]));
        if (at->carrier == BODY_BASE)
            break;
        const int carrier = g->sequence->body_subset[at->carrier];
        at = &g->sequence->subset[carrier];
        if (!class_in_lanes(g, at->class)) {
            all = pool_print(g->pool, "kept_%d", carrier);
            break;
        }
    }
    text_print(out, "%s%s", all, own.size ? own.s : "");
}

/* Keep a subset's solution that was for the same numbers; its part of the start is copied to the next start. Returns
 * the indent of the other branch. */
static int open_kept(Generation *g, Text *out, int indent, const Subset *subset, int s)
{
    const int offset = g->plan->start_offset[s], numbers = g->plan->formula[subset->class]->layout.start_size;
    const bool carries = sequence_carries(g->sequence, s);
    text_print(out, "%*s%s", indent, "", carries ? pool_print(g->pool, "const int kept_%d = ", s) : "if (");
    write_same(g, out, subset);
    text_print(out, carries ? ";\n" : ") {\n");
    if (carries)
        line(out, indent, "if (kept_%d) {", s);
    line(out, indent + 4, "++self->head.kept_count;");
    if (numbers)
        line(out, indent + 4, "memcpy(start + %d, old + %d, %d * sizeof *start);", offset, offset, numbers);
    line(out, indent, "} else {");
    return indent + 4;
}

const char *change_text(const Generation *g, const char *unwinding, int coordinate)
{
    const char *index = coordinate_text(g->pool, g->style->naming, coordinate);
    const char *change = pool_print(g->pool, "start[%s] - old[%s]", index, index);
    return coordinate_unwinds(g->formulation, coordinate) ? pool_print(g->pool, unwinding, change) : change;
}

void write_unwinding(const Generation *g, Text *out, int indent, bool lanes)
{
    const char *model = g->model->name;
    for (int w = 0; w < g->model->coordinates; ++w) {
        if (!coordinate_unwinds(g->formulation, w))
            continue;
        const char *index = coordinate_text(g->pool, g->style->naming, w);
        if (lanes) {
            line(out, indent, "way[%s] = lane_unwound(way[%s], R(GIC_PIECES) * %s_piece[%s]); /* %s */", index, index,
                 model, index, g->model->coordinate[w].name);
            continue;
        }
        line(out, indent, "if (!(GIC_FABS(way[%s]) < R(GIC_PIECES) * %s_piece[%s])) /* %s */", index, model, index,
             g->model->coordinate[w].name);
        line(out, indent + 4, "way[%s] = gic_unwound(way[%s]);", index, index);
    }
}

/* Through a pointer in recover_piece, an object in residual: the same lines serve both. */
void write_recovery_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Sequence *sequence = g->sequence;
    write_rooms(g, out, indent);
    write_recovery_call_along(g, out, indent);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        if (class_in_lanes(g, subset->class)) {
            write_lane_call(g, out, indent, s);
            continue;
        }
        const Class *class = &sequence->class[subset->class];
        if (narrowing_image(g->formulation->narrowing, s))
            continue;
        const bool closed = g->plan->formula[subset->class]->closed;
        const bool steady = narrowing_steady(g->formulation->narrowing, s), keeps = !steady && plan_keeps(g->plan, s);
        if (steady)
            line(out, indent, "if (links->cold) { /* nothing about it changes later */");
        indent += steady ? 4 : 0;
        text_print(out, "%*s/* stage %d:", indent, "", subset->stage);
        for (int b = 0; b < subset->bodies; ++b)
            text_print(out, " %s", g->model->body[subset->body[b]].name);
        text_print(out, " */\n");
        if (keeps)
            indent = open_kept(g, out, indent, subset, s);
        for (int i = 0; i < subset->knowns; ++i)
            line(out, indent, "links->known[%d] = %s; /* %s */", i, known_text(g, subset, i),
                 g->model->body[subset->known[i]].name);
        for (int j = 0; j < subset->deps; ++j) {
            const char *index = coordinate_text(g->pool, g->style->naming, subset->dep[j]);
            line(out, indent, "links->x[%d] = start[%s];%s", j, index, coordinate_comment(g, subset->dep[j]));
            line(out, indent, "links->rate[%d] = xd[%s];", j, index);
            if (!closed)
                line(out, indent, "links->change[%d] = %s;", j, change_text(g, "gic_unwound(%s)", subset->dep[j]));
        }
        if (g->plan->formula[subset->class]->derived)
            line(out, indent, "links->derived = self->derived + %d;", g->plan->derived_offset[s]);
        const char *old = closed ? "" : pool_print(g->pool, "old + %d, ", g->plan->start_offset[s]);
        line(out, indent,
             "status = %s_solve_%s(self, %s_k_%s[%d], links, %sstart + %d, self->motion + %s, self->inertia + %s);",
             g->model->name, class->name, g->model->name, class->name, class_place(class, s), old,
             g->plan->start_offset[s], body_motion_text(g, subset->body[0]), subset_inertia_text(g, s));
        line(out, indent, "if (status != GIC_OK) {");
        line(out, indent + 4, "self->head.subset = %s;", subset_text(g->pool, g->style->naming, s));
        line(out, indent + 4, "return status;");
        line(out, indent, "}");
        if (steady || keeps)
            line(out, indent -= 4, "}");
    }
}

void write_residuals(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Sequence *sequence = g->sequence;
    write_rooms(g, out, indent);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || narrowing_image(g->formulation->narrowing, s))
            continue;
        const Class *class = &sequence->class[subset->class];
        const Formula *formula = g->plan->formula[subset->class];
        write_knowns(g, out, indent, subset);
        for (int j = 0; j < subset->deps; ++j) {
            const char *index = coordinate_text(g->pool, g->style->naming, subset->dep[j]);
            line(out, indent, "links.x[%d] = self->x[%s];", j, index);
            line(out, indent, "links.rate[%d] = self->xd[%s];", j, index);
        }
        if (formula->derived)
            line(out, indent, "links.derived = self->derived + %d;", g->plan->derived_offset[s]);
        line(out, indent, "%s_residual_%s(%s_k_%s[%d], &links, %s, one);", g->model->name, class->name, g->model->name,
             class->name, class_place(class, s), motion_text(g, s));
        line(out, indent, "if (bad < 0 && !(one[0] <= GIC_POSE_RESIDUAL(%s) && one[1] <= GIC_MOTION_RESIDUAL))",
             emit_number(g->pool, formula->distance));
        line(out, indent + 4, "bad = %s;", subset_text(g->pool, g->style->naming, s));
        for (int i = 0; i < 2; ++i)
            line(out, indent, "largest[%d] = GIC_MAX(largest[%d], one[%d]);", i, i, i);
    }
}

/* In reverse computational sequence: the wrenches on a subset are known before it is solved. */
void write_react_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Sequence *sequence = g->sequence;
    const Plan *plan = g->plan;
    const bool *needed = reactions_needed(g->pool, g->model, sequence);
    write_rooms(g, out, indent);
    for (int s = sequence->subsets - 1; s >= 0; --s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || !needed[s])
            continue;
        const Class *class = &sequence->class[subset->class];
        line(out, indent, "/* %s */", subset_title(g->pool, g->model, subset));
        write_knowns(g, out, indent, subset);
        for (int i = 0; i < subset->knowns; ++i)
            if (needed[sequence->body_subset[subset->known[i]]])
                line(out, indent, "onto[%d] = lambda + %d;", i, plan->multiplier_offset[subset->known[i]]);
            else
                line(out, indent, "onto[%d] = spare;", i);
        for (int j = 0; j < subset->deps; ++j)
            line(out, indent, "links.x[%d] = start[%s];", j,
                 coordinate_text(g->pool, g->style->naming, subset->dep[j]));
        if (plan->formula[subset->class]->derived)
            line(out, indent, "links.derived = self->derived + %d;", plan->derived_offset[s]);
        line(out, indent, "%s_react_%s(%s_k_%s[%d], &links, %s, %s, lambda + %d, onto);", g->model->name, class->name,
             g->model->name, class->name, class_place(class, s), start_text(g, s), motion_text(g, s),
             plan->multiplier_offset[subset->body[0]]);
    }
}

/* Number of coordinates from this one on that are consecutive in the state too, with their rates. */
static int gathered_together(const Generation *g, int first)
{
    const Plan *plan = g->plan;
    int count = 1;
    if (g->model->coordinate[first].driven)
        return count;
    for (int w = first + 1; w < g->model->coordinates && !g->model->coordinate[w].driven; ++w, ++count)
        if (plan->coordinate_state[w] != plan->coordinate_state[first] + count ||
            plan->coordinate_rate[w] != plan->coordinate_rate[first] + count)
            break;
    return count;
}

/* Several at a time where they stand together: what reads them as a vector would wait for numbers written singly. */
void write_gathered(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int w = 0; w < g->model->coordinates;) {
        const Coordinate *c = &g->model->coordinate[w];
        const int count = gathered_together(g, w);
        const Naming *naming = g->style->naming;
        const char *index = coordinate_text(g->pool, naming, w);
        const char *from[2] = {c->driven ? input_text(g->pool, naming, c->input)
                                         : state_text(g->pool, naming, g->plan->coordinate_state[w]),
                               c->driven ? input_text(g->pool, naming, c->input + 1)
                                         : state_text(g->pool, naming, g->plan->coordinate_rate[w])};
        if (count > 1) {
            line(out, indent, "memcpy(x + %s, y + %s, %d * sizeof *x); /* %s to %s */", index, from[0], count, c->name,
                 g->model->coordinate[w + count - 1].name);
            line(out, indent, "memcpy(xd + %s, y + %s, %d * sizeof *xd);", index, from[1], count);
        } else {
            line(out, indent, "x[%s] = %s[%s]; /* %s */", index, c->driven ? "u" : "y", from[0], c->name);
            line(out, indent, "xd[%s] = %s[%s];", index, c->driven ? "u" : "y", from[1]);
        }
        w += count;
    }
}

void write_pieces(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int w = 0; w < g->model->coordinates; ++w)
        line(out, indent, "%s, /* %s */", emit_number(g->pool, coordinate_piece(g->formulation, w)),
             g->model->coordinate[w].name);
    if (!g->model->coordinates)
        line(out, indent, "R(0.0)");
}

void write_design(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const Subset *subset = &g->sequence->subset[s];
        for (int b = 0; plan_follows(g->plan, s) && b < subset->bodies; ++b) {
            double q[7];
            body_design(g->formulation, subset_anchor(g->model, g->sequence, s), subset->body[b], q);
            text_print(out, "%*s{%d, ", indent, "", g->plan->start_offset[s] + 7 * b * g->plan->stride[s]);
            if (g->plan->lanes)
                text_print(out, "%d, ", g->plan->stride[s]);
            text_print(out, "{");
            for (int i = 0; i < 7; ++i)
                text_print(out, "%s%s", i ? ", " : "", emit_number(g->pool, q[i]));
            text_print(out, "}}, /* %s */\n", g->model->body[subset->body[b]].name);
        }
    }
    if (!followed_bodies(g->plan))
        line(out, indent,
             g->plan->lanes ? "{0, 1, {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)}}"
                            : "{0, {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)}}");
}

void write_initial(void *context, Text *out, int indent)
{
    Generation *g = context;
    for (int i = 0; i < states(g); ++i) {
        const StateNumber number = state_number(g->pool, g->formulation, i);
        line(out, indent, "%s, /* %s */", emit_number(g->pool, number.initial), number.name);
    }
    if (!states(g))
        line(out, indent, "R(0.0)");
}
