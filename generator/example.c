/* SPDX-License-Identifier: MIT
 * An example program that calls the emitted code of one model (`gicgen --main`). */
#include "gicgen.h"

#include <ctype.h>
#include <string.h>

typedef struct Example {
    const Model *model;
    const char *header;
} Example;

/* As names stand in the emitted header: capitals, and everything that is no letter or digit an underscore. */
static const char *constant_name(Pool *pool, const char *model, const char *kind, const char *name)
{
    char *out = pool_print(pool, "%s_%s_%s", model, kind, name);
    for (char *c = out; *c; ++c)
        *c = (char)(isalnum((unsigned char)*c) ? toupper((unsigned char)*c) : '_');
    return out;
}

static void insert(void *context, const char *name, Text *out, int indent)
{
    const Example *example = context;
    const Model *model = example->model;
    if (!strcmp(name, "include"))
        text_print(out, "#include \"%s\"\n", example->header);
    else if (!strcmp(name, "inputs"))
        for (int i = 0; i < model->inputs; ++i)
            text_print(out, "%*sinput[%s] = GIC_R(%.9g); /* %s */\n", indent, "",
                       constant_name(out->pool, model->name, "INPUT", model->input[i].name), model->input[i].initial,
                       model->input[i].unit);
    else if (!strcmp(name, "state") && model->free_base)
        text_print(out, "%*svehicle.state[%s] = GIC_R(5.0); /* m/s */\n", indent, "",
                   constant_name(out->pool, model->name, "STATE", "v_x"));
}

void example_write(Pool *pool, const Model *model, const char *templates, const char *header, Text *out)
{
    Example example = {.model = model, .header = header};
    template_expand(pool, out, templates, "main.c.in", model->name, NULL, insert, &example);
}
