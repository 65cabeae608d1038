/* SPDX-License-Identifier: MIT
 * modelDescription.xml of FMI 2.0. */
#include "base/version.h"
#include "fmu/fmu_private.h"

#include <math.h>
#include <string.h>

static void describe_interface(Text *out, const Description *d, bool exchange)
{
    text_print(out, "  <%s", exchange ? "ModelExchange" : "CoSimulation");
    xml_attribute(out, "modelIdentifier", d->f->model->name);
    if (!exchange)
        text_print(out, " canHandleVariableCommunicationStepSize=\"true\" canInterpolateInputs=\"true\"");
    text_print(out, " canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"%s>\n    <SourceFiles>\n",
               d->derivatives ? " providesDirectionalDerivative=\"true\"" : "");
    for (const char *const *source = d->source; *source; ++source)
        text_print(out, "      <File name=\"%s\"/>\n", *source);
    text_print(out, "    </SourceFiles>\n  </%s>\n", exchange ? "ModelExchange" : "CoSimulation");
}

static void describe_bound(Text *out, const Variable *v, const char *name, double value)
{
    if (isnan(value))
        return;
    if (v->type == TYPE_REAL)
        xml_number(out, name, value);
    else
        xml_whole(out, name, (long)value);
}

static void describe_variable(Text *out, const Variable *v)
{
    static const char *const type[] = {"Real", "Integer", "Enumeration"};
    text_print(out, "    <ScalarVariable");
    xml_attribute(out, "name", v->name);
    text_print(out, " valueReference=\"%u\"", variable_reference(v));
    xml_attribute(out, "description", v->description);
    xml_attribute(out, "causality", v->causality);
    xml_attribute(out, "variability", v->variability);
    if (v->initial)
        xml_attribute(out, "initial", v->initial);
    text_print(out, ">\n      <%s", type[v->type]);
    if (v->type == TYPE_METHOD)
        text_print(out, " declaredType=\"solver_method\"");
    if (v->unit)
        xml_attribute(out, "unit", v->unit);
    describe_bound(out, v, "min", v->least);
    describe_bound(out, v, "max", v->most);
    if (v->nominal > 0)
        xml_number(out, "nominal", v->nominal);
    if (v->starts)
        describe_bound(out, v, "start", v->start);
    if (v->of >= 0)
        xml_whole(out, "derivative", v->of + 1);
    if (v->reinit)
        text_print(out, " reinit=\"true\"");
    text_print(out, "/>\n    </ScalarVariable>\n");
}

/* Variables among the unknowns of a list: `kind` of it, or with `initial` those that initialization computes. */
static void describe_unknowns(Text *out, const Description *d, const char *list, int kind, bool initial)
{
    const Variables *all = d->variables;
    bool any = false;
    for (int i = 0; i < all->count; ++i) {
        const Variable *v = &all->variable[i];
        const bool member = initial ? is_initial_unknown(v) : kind == KIND_OUTPUT ? is_output(v) : v->kind == kind;
        if (!member)
            continue;
        if (!any)
            text_print(out, "    <%s>\n", list);
        any = true;
        text_print(out, "      <Unknown index=\"%d\"", i + 1);
        if (!initial)
            describe_dependencies(out, d, v, false);
        text_print(out, "/>\n");
    }
    if (any)
        text_print(out, "    </%s>\n", list);
}

void describe_2(Text *out, const Description *d)
{
    const Variables *all = d->variables;
    const Model *model = d->f->model;
    text_print(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\"");
    xml_attribute(out, "modelName", model->name);
    xml_attribute(out, "guid", d->token);
    if (model->description[0])
        xml_attribute(out, "description", model->description);
    xml_attribute(out, "generationTool", "gicgen " GICGEN_VERSION);
    text_print(out, " variableNamingConvention=\"structured\" numberOfEventIndicators=\"%d\">\n",
               event_indicators(d->variables));
    if (!d->f->model->controllers) /* which sample in steps */
        describe_interface(out, d, true);
    describe_interface(out, d, false);
    describe_units(out, all);
    text_print(out, "  <TypeDefinitions>\n    <SimpleType name=\"solver_method\" description=\"integrator\">\n"
                    "      <Enumeration>\n");
    describe_methods(out, 8, d->last_method);
    text_print(out, "      </Enumeration>\n    </SimpleType>\n  </TypeDefinitions>\n");
    describe_log(out);
    describe_experiment(out, &d->experiment);
    text_print(out, "  <ModelVariables>\n");
    for (int i = 0; i < all->count; ++i)
        describe_variable(out, &all->variable[i]);
    text_print(out, "  </ModelVariables>\n  <ModelStructure>\n");
    describe_unknowns(out, d, "Outputs", KIND_OUTPUT, false);
    describe_unknowns(out, d, "Derivatives", KIND_DERIVATIVE, false);
    describe_unknowns(out, d, "InitialUnknowns", 0, true);
    text_print(out, "  </ModelStructure>\n</fmiModelDescription>\n");
}
