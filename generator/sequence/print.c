/* SPDX-License-Identifier: MIT
 * The sequence for people: as a table, and as the weighted graph in Graphviz source, for dot and neato. */
#include "base/text.h"
#include "model/model.h"
#include "sequence/sequence.h"

#include <string.h>

/* ---- table for people ------------------------------------------------------------------------- */

enum { TABLE_WIDTH = 100, TABLE_INDENT = 8, TABLE_LABEL = 15 };

/* Print one item of a list under a subset, after its label or a comma, wrapped to the table's width. */
static void table_item(Text *out, int *column, const char *label, const char *item)
{
    int width = (int)strlen(item);
    if (!*column) {
        text_print(out, "%*s%-*s%s", TABLE_INDENT, "", TABLE_LABEL, label, item);
        *column = TABLE_INDENT + TABLE_LABEL + width;
    } else if (*column + 2 + width > TABLE_WIDTH) {
        text_print(out, ",\n%*s%s", TABLE_INDENT + TABLE_LABEL, "", item);
        *column = TABLE_INDENT + TABLE_LABEL + width;
    } else {
        text_print(out, ", %s", item);
        *column += 2 + width;
    }
}

static void table_end(Text *out, int column)
{
    if (column)
        text_print(out, "\n");
}

void subset_shape(const Model *model, const Subset *subset, int *unknowns, int *equations)
{
    *unknowns = subset->class < 0 ? 1 : 7 * subset->bodies;
    *equations = subset->bodies + subset->coordinates;
    for (int i = 0; i < subset->joints; ++i)
        *equations += joint_equations[model->joint[subset->joint[i]].type];
}

static void subset_print(Text *out, const Model *model, const Sequence *sequence, int index)
{
    const Subset *subset = &sequence->subset[index];
    bool base = subset->class < 0;
    int unknowns, equations, column = 0;
    subset_shape(model, subset, &unknowns, &equations);
    text_print(out, "  %4d  %d x %d  %s\n", index + 1, unknowns, equations,
               base ? "dependent Euler parameter of the base, by its normalization"
                    : pool_print(out->pool, "like %s", sequence->class[subset->class].name));
    for (int i = 0; i < subset->bodies; ++i)
        table_item(out, &column, "bodies", model->body[subset->body[i]].name);
    table_end(out, column);
    column = 0;
    for (int i = 0; i < subset->joints; ++i) {
        const Joint *joint = &model->joint[subset->joint[i]];
        table_item(out, &column, "joints",
                   pool_print(out->pool, "%s (%s %d)", joint->name, joint_type_name[joint->type],
                              joint_equations[joint->type]));
    }
    table_end(out, column);
    column = 0;
    for (int i = 0; i < subset->coordinates; ++i) {
        const Coordinate *coordinate = &model->coordinate[subset->coordinate[i]];
        table_item(out, &column, "coordinates",
                   pool_print(out->pool, "%s (%s%s)", coordinate->name, coordinate_type_name[coordinate->type],
                              coordinate->driven ? ", driven" : ""));
    }
    table_end(out, column);
    column = 0;
    for (int i = 0; i < subset->knowns; ++i)
        table_item(out, &column, "known before", model->body[subset->known[i]].name);
    table_end(out, column);
}

void sequence_print(Text *out, const Model *model, const Sequence *sequence)
{
    int bodies = sequence->unknowns / 7, driven = 0;
    for (int i = 0; i < model->coordinates; ++i)
        driven += model->coordinate[i].driven;
    text_print(out, "%s: %d %s, %d joint%s, %d dual coordinate%s (%d driven), %s base '%s'\n", model->name, bodies,
               bodies == 1 ? "body" : "bodies", model->joints, model->joints == 1 ? "" : "s", model->coordinates,
               model->coordinates == 1 ? "" : "s", driven, model->free_base ? "free" : "fixed",
               model->body[BODY_BASE].name);
    text_print(out, "%d coordinates, %d equations (%d of joints, %d normalizations), %d degrees of freedom\n",
               sequence->unknowns, sequence->equations, sequence->equations - bodies, bodies, sequence->dof);
    text_print(out, "%d subsets in %d stages, %d classes; a size is unknowns x equations\n", sequence->subsets,
               sequence->stages, sequence->classes);
    for (int i = 0, stage = 0; i < sequence->subsets; ++i) {
        if (sequence->subset[i].stage != stage) {
            stage = sequence->subset[i].stage;
            text_print(out, "\nstage %d\n", stage);
        }
        subset_print(out, model, sequence, i);
    }
    text_print(out, "\nclasses of isomorphic subsets\n");
    for (int i = 0; i < sequence->classes; ++i) {
        const Class *class = &sequence->class[i];
        int column = 0;
        text_print(out, "  %s\n", class->name);
        for (int k = 0; k < class->members; ++k)
            table_item(out, &column, "subsets", pool_print(out->pool, "%d", class->member[k] + 1));
        table_end(out, column);
    }
}

/* ---- graph ------------------------------------------------------------------------------------ */

/* Fill colours by stage, readable under black text and for the colour-blind; stage 0: a fixed base. */
static const char *const stage_color[] = {"#ffffff", "#f0d9a8", "#a8d5f0", "#b5e3b5", "#f2b8c6",
                                          "#d6c7ee", "#e8e29a", "#a9e0dc", "#f5c9a0"};

enum { STAGE_COLORS = sizeof stage_color / sizeof *stage_color };

static const char *color_of(int stage)
{
    return stage_color[stage < STAGE_COLORS ? stage : 1 + (stage - 1) % (STAGE_COLORS - 1)];
}

/* Text of a quoted Graphviz string. */
static void quoted_add(Text *out, const char *s)
{
    for (; *s; ++s)
        text_print(out, *s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
}

/* A body: its weight is the number of its dependent coordinates. */
static void body_draw(Text *out, const Model *model, const Sequence *sequence, int body)
{
    int subset = sequence->body_subset[body];
    int weight = subset < 0 ? 0 : body == BODY_BASE ? 1 : 7;
    text_print(out, "    b%d [label=\"", body);
    quoted_add(out, model->body[body].name);
    text_print(out, "\\n%d\", fillcolor=\"%s\"];\n", weight, color_of(subset < 0 ? 0 : sequence->subset[subset].stage));
    if (weight)
        text_print(out, "    b%d -- b%d [label=\"1\", color=gray50, fontcolor=gray50];\n", body, body);
}

static void edge_draw(Text *out, const int body[2], const char *name, int weight, const char *style)
{
    text_print(out, "    b%d -- b%d [label=\"", body[0], body[1]);
    quoted_add(out, name);
    text_print(out, " %d\", style=%s];\n", weight, style);
}

/* Bodies that are solved together stand in one frame (dot draws it; neato ignores it, the thick border remains). */
static void subset_draw(Text *out, const Model *model, const Sequence *sequence, int index)
{
    const Subset *subset = &sequence->subset[index];
    if (subset->bodies > 1)
        text_print(out,
                   "    subgraph cluster_%d {\n    label=\"one subset: %d x %d\"; style=\"rounded,dashed\"; node "
                   "[penwidth=2];\n",
                   index, 7 * subset->bodies, 7 * subset->bodies);
    for (int i = 0; i < subset->bodies; ++i)
        body_draw(out, model, sequence, subset->body[i]);
    if (subset->bodies > 1)
        text_print(out, "    }\n");
}

static void legend_draw(Text *out, const Sequence *sequence)
{
    text_print(out, "    legend [shape=plaintext, style=\"\", label=<<table border=\"0\" cellborder=\"1\" "
                    "cellspacing=\"0\">\n");
    for (int stage = 1; stage <= sequence->stages && stage < STAGE_COLORS; ++stage)
        text_print(out, "        <tr><td bgcolor=\"%s\">stage %d</td></tr>\n", color_of(stage), stage);
    if (sequence->stages >= STAGE_COLORS)
        text_print(out, "        <tr><td>%d stages, colours repeat</td></tr>\n", sequence->stages);
    text_print(out, "        <tr><td align=\"left\">vertex: body, dependent coordinates</td></tr>\n"
                    "        <tr><td align=\"left\">line: joint, equations</td></tr>\n"
                    "        <tr><td align=\"left\">dotted: dual coordinate</td></tr>\n"
                    "        <tr><td align=\"left\">loop: normalization</td></tr>\n"
                    "    </table>>];\n");
}

void graph_draw(Text *out, const Model *model, const Sequence *sequence)
{
    text_print(out, "graph gicgen {\n    label=\"");
    quoted_add(out, model->name);
    text_print(out, ": %d coordinates, %d equations, %d degrees of freedom\";\n", sequence->unknowns,
               sequence->equations, sequence->dof);
    text_print(out, "    labelloc=t; overlap=false; splines=true; ranksep=0.9; fontname=Helvetica;\n"
                    "    node [shape=ellipse, style=filled, fontname=Helvetica];\n"
                    "    edge [fontname=Helvetica, fontsize=10];\n");
    if (sequence->body_subset[BODY_BASE] < 0)
        body_draw(out, model, sequence, BODY_BASE);
    for (int i = 0; i < sequence->subsets; ++i)
        subset_draw(out, model, sequence, i);
    for (int i = 0; i < model->joints; ++i)
        edge_draw(out, model->joint[i].body, model->joint[i].name, joint_equations[model->joint[i].type], "solid");
    for (int i = 0; i < model->coordinates; ++i)
        edge_draw(out, model->coordinate[i].body, model->coordinate[i].name, 1, "dotted");
    legend_draw(out, sequence);
    text_print(out, "}\n");
}
