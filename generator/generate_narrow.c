/* SPDX-License-Identifier: MIT
 * What generated files say about the one scene that they are for. */
#include "generate.h"

#include <string.h>

/* Conditions on geometric parameters stand in front of assumptions. */
static int first_assumption(const Generation *g)
{
    return g->model->tuning ? g->model->tuning->conditions : 0;
}

int conditions(const Generation *g)
{
    return first_assumption(g) + (g->formulation->narrowing ? g->formulation->narrowing->assumptions : 0);
}

void write_assumption_texts(Generation *g, Text *out)
{
    const Narrowing *narrowing = g->formulation->narrowing;
    for (int i = 0; narrowing && i < narrowing->assumptions; ++i)
        line(out, 4, "%s,", quoted(g->pool, narrowing->assumption[i].text));
}

void write_narrowing(Generation *g, Text *out)
{
    const Narrowing *narrowing = g->formulation->narrowing;
    if (!narrowing)
        return;
    text_print(out, " * For the scene %s alone. Other calls end with GIC_ERROR_ASSUMPTION; this is taken for granted:\n",
               narrowing->facts->scene);
    for (int i = 0; i < narrowing->assumptions; ++i)
        text_print(out, " *   %s\n", narrowing->assumption[i].text);
    text_print(out, " *\n");
}

static void insert_checks(void *context, const char *name, Text *out, int indent)
{
    const Generation *g = context;
    const Narrowing *narrowing = g->formulation->narrowing;
    (void)name;
    for (int i = 0; i < narrowing->assumptions; ++i) {
        line(out, indent, "if (%s)", narrowing->assumption[i].broken);
        line(out, indent + 4, "broken = %d;", first_assumption(g) + i);
    }
}

void write_assumptions(Generation *g, Text *out)
{
    if (g->formulation->narrowing)
        template_expand(g->pool, out, g->templates, "assume.c.in", g->model->name, NULL, insert_checks, g);
}

void write_assume(Generation *g, Text *out, int indent)
{
    if (!g->formulation->narrowing)
        return;
    line(out, indent, "if (%s_assume(self) != GIC_OK)", g->model->name);
    line(out, indent + 4, "return self->head.status;");
}

void write_condition(Generation *g, Text *out, int indent)
{
    const char *also = g->formulation->narrowing ? " || self->head.status == GIC_ERROR_ASSUMPTION" : "";
    line(out, indent, "const int32_t condition = self->head.status == GIC_ERROR_GEOMETRY%s ? self->head.condition : -1;",
         also);
}
