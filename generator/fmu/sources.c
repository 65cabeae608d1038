/* SPDX-License-Identifier: MIT
 * The headers of an FMU that name its model: fmu_model.h, which its fixed C files include, and gic_runtime.h. */
#include "emit/emit.h"
#include "fmu/fmu_private.h"

#include <string.h>

enum { NUMBER_START, NUMBER_GIVEN, NUMBER_NOMINAL };

/* Numbers of all variables of a kind, one a line with its name. */
static void write_numbers(Text *out, int indent, const Variables *all, int kind, int what)
{
    bool any = false;
    for (int i = 0; i < all->count; ++i) {
        const Variable *v = &all->variable[i];
        if (v->kind != kind)
            continue;
        any = true;
        if (what == NUMBER_GIVEN)
            text_print(out, "%*s%d, /* %s */\n", indent, "", v->given, v->name);
        else
            text_print(out, "%*s%s, /* %s */\n", indent, "",
                       emit_number_within(out->pool, "GIC_R(", what == NUMBER_START ? v->start : v->nominal, ")"),
                       v->name);
    }
    if (!any)
        text_print(out, "%*s0\n", indent, "");
}

static void write_token(void *context, Text *out, int indent)
{
    const Description *d = context;
    (void)indent;
    text_print(out, "#define FMU_TOKEN \"%s\"\n", d->token);
}

static void write_derivatives(void *context, Text *out, int indent)
{
    const Description *d = context;
    (void)indent;
    text_print(out, "#define FMU_DERIVATIVES %d\n", d->derivatives);
}

static void write_enumerators(void *context, Text *out, int indent)
{
    const Description *d = context;
    const Variables *all = d->variables;
    const Experiment *e = &d->experiment;
    const Variable *gear = NULL;
    const int wheels = d->f->model->wheels;
    for (int i = 0; i < all->count; ++i)
        if (all->variable[i].kind == KIND_DISCRETE)
            gear = &all->variable[i];
    text_print(out,
               "%*sFMU_START_METHOD = %d,\n%*sFMU_START_RATIO = %d,\n%*sFMU_START_KEEP = %d,\n%*sFMU_MOST_KEEP = "
               "%d,\n%*sFMU_START_SPREAD = %d,\n%*sFMU_START_LOCATE = %d,\n%*sFMU_START_MOST = %d,\n%*sFMU_MOST_WORK = "
               "%d,\n%*sFMU_START_GEAR = %d,\n"
               "%*sFMU_LEAST_GEAR = %d,\n%*sFMU_MOST_GEAR = %d,\n%*sFMU_INDICATORS = %d,\n"
               "%*sFMU_CONTACTS = %d,\n%*sFMU_WHEELS = %d,\n%*sFMU_WHEELS_ROOM = %d\n",
               indent, "", e->method + 1, indent, "", e->ratio, indent, "", e->keep, indent, "", KEEP_MOST, indent, "",
               e->spread, indent, "", e->locate, indent, "", e->most_work, indent, "", SCENE_MOST_WORK, indent, "",
               gear ? (int)gear->start : 0, indent, "", gear ? (int)gear->least : 0, indent, "",
               gear ? (int)gear->most : 0, indent, "", event_indicators(all), indent, "",
               d->f->contacts ? d->f->contacts->stores : 0, indent, "", wheels, indent, "", wheels ? wheels : 1);
}

static void write_experiment(void *context, Text *out, int indent)
{
    const Description *d = context;
    const Experiment *e = &d->experiment;
    (void)indent;
    text_print(out, "#define FMU_START_STEP %s\n#define FMU_STEADY %s\n",
               emit_number_within(out->pool, "GIC_R(", e->step, ")"),
               emit_number_within(out->pool, "GIC_R(", e->steady, ")"));
}

static void write_state(void *context, Text *out, int indent)
{
    const Description *d = context;
    write_numbers(out, indent, d->variables, KIND_STATE, NUMBER_START);
}

static void write_given(void *context, Text *out, int indent)
{
    const Description *d = context;
    write_numbers(out, indent, d->variables, KIND_STATE, NUMBER_GIVEN);
}

static void write_nominal(void *context, Text *out, int indent)
{
    const Description *d = context;
    write_numbers(out, indent, d->variables, KIND_STATE, NUMBER_NOMINAL);
}

static void write_input(void *context, Text *out, int indent)
{
    const Description *d = context;
    write_numbers(out, indent, d->variables, KIND_INPUT, NUMBER_START);
}

static void write_parameter(void *context, Text *out, int indent)
{
    const Description *d = context;
    write_numbers(out, indent, d->variables, KIND_PARAMETER, NUMBER_START);
}

static void write_wheel_body(void *context, Text *out, int indent)
{
    const Description *d = context;
    const Model *model = d->f->model;
    for (int i = 0; i < model->wheels; ++i)
        text_print(out, "%*s%d, /* %s */\n", indent, "", model->wheel[i].body, model->wheel[i].name);
    if (!model->wheels)
        text_print(out, "%*s0\n", indent, "");
}

static void write_wheel_center(void *context, Text *out, int indent)
{
    const Description *d = context;
    const Model *model = d->f->model;
    for (int i = 0; i < model->wheels; ++i) {
        text_print(out, "%*s{", indent, "");
        for (int k = 0; k < 3; ++k)
            text_print(out, "%s%s", k ? ", " : "",
                       emit_number_within(out->pool, "GIC_R(", model->wheel[i].center[k], ")"));
        text_print(out, "}, /* %s */\n", model->wheel[i].name);
    }
    if (!model->wheels)
        text_print(out, "%*s{0}\n", indent, "");
}

static const Insertion header_point[] = {{"token", write_token},
                                         {"derivatives", write_derivatives},
                                         {"numbers", write_enumerators},
                                         {"experiment", write_experiment},
                                         {"state", write_state},
                                         {"given", write_given},
                                         {"nominal", write_nominal},
                                         {"input", write_input},
                                         {"parameter", write_parameter},
                                         {"wheel body", write_wheel_body},
                                         {"wheel center", write_wheel_center},
                                         {NULL, NULL}};

static const Insertions header_points = {(const char *const[]){"fmu/fmu_model.h.in", NULL}, header_point, NULL};

static void expand(Text *out, const char *templates, const Insertions *points, const Description *d,
                   const void *context)
{
    const char *model = d->f->model->name, *name = *points->template;
    templates_check(out->pool, templates, (const Insertions *const[]){points, NULL});
    template_expand(out->pool, out, templates, name, model, NULL, points, (void *)context);
}

void write_model_header(Text *out, const char *templates, const Description *d)
{
    expand(out, templates, &header_points, d, d);
}

static void write_runtime(void *context, Text *out, int indent)
{
    const Text *runtime = context;
    (void)indent;
    text_add(out, runtime->s, runtime->size);
}

static const Insertion runtime_point[] = {{"runtime", write_runtime}, {NULL, NULL}};

static const Insertions runtime_points = {(const char *const[]){"fmu/gic_runtime.h.in", NULL}, runtime_point, NULL};

void write_runtime_header(Text *out, const char *templates, const Description *d, const Text *runtime)
{
    expand(out, templates, &runtime_points, d, runtime);
}
