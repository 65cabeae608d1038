/* SPDX-License-Identifier: MIT
 * An example program that calls the emitted code of one model (`gicgen --main`). */
#include "base/text.h"
#include "emit/emit.h"
#include "model/model.h"

#include <ctype.h>

typedef struct Example {
    const Model *model;
    const char *header;
} Example;

/* As names stand in the emitted header: capitals, and an underscore for everything that is neither a letter nor a
 * digit. */
static const char *constant_name(Pool *pool, const char *model, const char *kind, const char *name)
{
    char *out = pool_print(pool, "%s_%s_%s", model, kind, name);
    for (char *c = out; *c; ++c)
        *c = (char)(isalnum((unsigned char)*c) ? toupper((unsigned char)*c) : '_');
    return out;
}

static void write_include(void *context, Text *out, int indent)
{
    const Example *example = context;
    (void)indent;
    text_print(out, "#include \"%s\"\n", example->header);
}

static void write_inputs(void *context, Text *out, int indent)
{
    const Example *example = context;
    const Model *model = example->model;
    for (int i = 0; i < model->inputs; ++i)
        text_print(out, "%*sinput[%s] = GIC_R(%.9g); /* %s */\n", indent, "",
                   constant_name(out->pool, model->name, "INPUT", model->input[i].name), model->input[i].initial,
                   model->input[i].unit);
}

static void write_state(void *context, Text *out, int indent)
{
    const Example *example = context;
    if (example->model->free_base)
        text_print(out, "%*svehicle.state[%s] = GIC_R(5.0); /* m/s */\n", indent, "",
                   constant_name(out->pool, example->model->name, "STATE", "v_x"));
}

static const Insertion example_point[] = {
    {"include", write_include}, {"inputs", write_inputs}, {"state", write_state}, {NULL, NULL}};

static const Insertions example_points = {(const char *const[]){"main.c.in", NULL}, example_point, NULL};

void example_write(Pool *pool, const Model *model, const char *templates, const char *header, Text *out)
{
    Example example = {.model = model, .header = header};
    templates_check(pool, templates, (const Insertions *const[]){&example_points, NULL});
    template_expand(pool, out, templates, "main.c.in", model->name, NULL, &example_points, &example);
}
