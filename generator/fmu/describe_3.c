/* SPDX-License-Identifier: MIT
 * The XML of FMI 3.0: modelDescription.xml, sources/buildDescription.xml, terminalsAndIcons/terminalsAndIcons.xml. */
#include "base/version.h"
#include "fmu/fmu_private.h"

#include <math.h>
#include <string.h>

static void describe_interfaces(Text *out, const Description *d)
{
    const char *derivatives =
        d->derivatives ? " providesDirectionalDerivatives=\"true\" providesAdjointDerivatives=\"true\"" : "";
    if (!d->f->model->controllers) { /* which sample in steps */
        text_print(out, "  <ModelExchange");
        xml_attribute(out, "modelIdentifier", d->f->model->name);
        text_print(
            out,
            " canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\" needsCompletedIntegratorStep=\"%s\"%s/>\n",
            d->f->model->powertrain ? "true" : "false", derivatives);
    }
    text_print(out, "  <CoSimulation");
    xml_attribute(out, "modelIdentifier", d->f->model->name);
    text_print(out,
               " canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\""
               " canHandleVariableCommunicationStepSize=\"true\" providesIntermediateUpdate=\"true\""
               " canReturnEarlyAfterIntermediateUpdate=\"true\" hasEventMode=\"false\"%s/>\n",
               derivatives);
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

static void describe_variable(Text *out, const Variables *all, const Variable *v)
{
    static const char *const type[] = {"Float64", "Int32", "Enumeration"};
    text_print(out, "    <%s", type[v->type]);
    xml_attribute(out, "name", v->name);
    text_print(out, " valueReference=\"%u\"", variable_reference(v));
    xml_attribute(out, "description", v->description);
    xml_attribute(out, "causality", v->causality);
    xml_attribute(out, "variability", v->variability);
    if (v->kind == KIND_OUTPUT)
        text_print(out, " intermediateUpdate=\"true\"");
    if (v->type == TYPE_METHOD)
        text_print(out, " declaredType=\"solver_method\"");
    if (v->initial)
        xml_attribute(out, "initial", v->initial);
    if (v->unit)
        xml_attribute(out, "unit", v->unit);
    describe_bound(out, v, "min", v->least);
    describe_bound(out, v, "max", v->most);
    if (v->nominal > 0)
        xml_number(out, "nominal", v->nominal);
    if (v->starts)
        describe_bound(out, v, "start", v->start);
    if (v->of >= 0)
        text_print(out, " derivative=\"%u\"", variable_reference(&all->variable[v->of]));
    if (v->reinit)
        text_print(out, " reinit=\"true\"");
    text_print(out, "/>\n");
}

static void describe_structure(Text *out, const Description *d)
{
    const Variables *all = d->variables;
    static const char *const element[] = {"Output", "ContinuousStateDerivative", "InitialUnknown", "EventIndicator"};
    for (int list = 0; list < 4; ++list)
        for (int i = 0; i < all->count; ++i) {
            const Variable *v = &all->variable[i];
            const bool member[] = {is_output(v), v->kind == KIND_DERIVATIVE, is_initial_unknown(v),
                                   v->kind == KIND_INDICATOR};
            if (!member[list])
                continue;
            text_print(out, "    <%s valueReference=\"%u\"", element[list], variable_reference(v));
            if (list < 2)
                describe_dependencies(out, d, v, true);
            text_print(out, "/>\n");
        }
}

void describe_3(Text *out, const Description *d)
{
    const Variables *all = d->variables;
    const Model *model = d->f->model;
    text_print(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\"");
    xml_attribute(out, "modelName", model->name);
    xml_attribute(out, "instantiationToken", d->token);
    if (model->description[0])
        xml_attribute(out, "description", model->description);
    xml_attribute(out, "generationTool", "gicgen " GICGEN_VERSION);
    text_print(out, " variableNamingConvention=\"structured\">\n");
    describe_interfaces(out, d);
    describe_units(out, all);
    text_print(out, "  <TypeDefinitions>\n    <EnumerationType name=\"solver_method\" description=\"integrator\">\n");
    describe_methods(out, 6, d->last_method);
    text_print(out, "    </EnumerationType>\n  </TypeDefinitions>\n");
    describe_log(out);
    describe_experiment(out, &d->experiment);
    text_print(out, "  <ModelVariables>\n");
    for (int i = 0; i < all->count; ++i)
        describe_variable(out, all, &all->variable[i]);
    text_print(out, "  </ModelVariables>\n  <ModelStructure>\n");
    describe_structure(out, d);
    text_print(out, "  </ModelStructure>\n</fmiModelDescription>\n");
}

void describe_build(Text *out, const Description *d)
{
    text_print(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n"
                    "  <BuildConfiguration");
    xml_attribute(out, "modelIdentifier", d->f->model->name);
    text_print(out, ">\n    <SourceFileSet language=\"C99\">\n");
    for (const char *const *source = d->source; *source; ++source)
        text_print(out, "      <SourceFile name=\"%s\"/>\n", *source);
    text_print(out, "    </SourceFileSet>\n  </BuildConfiguration>\n</fmiBuildDescription>\n");
}

/* ---- terminals: one a wheel, a port, the powertrain ---------------------------------------------------------- */

static bool same_terminal(const Variable *a, const Variable *b)
{
    return a->terminal && b->terminal && !strcmp(a->terminal, b->terminal);
}

/* Of a port what comes after its name. Else what comes after the last dot, or the whole name where another member of
 * the terminal ends so too. */
static const char *member_name(const Variables *all, const Variable *v)
{
    if (v->kind == KIND_PORT)
        return v->name + strlen("port.") + strlen(v->terminal) + 1;
    const char *dot = strrchr(v->name, '.'), *end = dot ? dot + 1 : v->name;
    for (int i = 0; i < all->count; ++i) {
        const Variable *other = &all->variable[i];
        const char *other_dot = strrchr(other->name, '.');
        if (other != v && same_terminal(v, other) && other_dot && !strcmp(other_dot + 1, end))
            return v->name;
    }
    return end;
}

static void describe_terminal(Text *out, const Variables *all, const Variable *first)
{
    text_print(out, "    <Terminal");
    xml_attribute(out, "name", first->terminal);
    text_print(out, " matchingRule=\"bus\">\n");
    for (const Variable *v = first; v < all->variable + all->count; ++v)
        if (same_terminal(first, v)) {
            text_print(out, "      <TerminalMemberVariable variableKind=\"signal\"");
            xml_attribute(out, "memberName", member_name(all, v));
            xml_attribute(out, "variableName", v->name);
            text_print(out, "/>\n");
        }
    text_print(out, "    </Terminal>\n");
}

/* The place of icon.png in its coordinate system, 20 mm wide: as large as fits, about the origin. */
static void describe_icon(Text *out, double height)
{
    const double x = 100 / fmax(1, height), y = x * height;
    text_print(out, "  <GraphicalRepresentation>\n"
                    "    <CoordinateSystem x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\""
                    " suggestedScalingFactorTo_mm=\"0.1\"/>\n    <Icon");
    xml_number(out, "x1", -x);
    xml_number(out, "y1", -y);
    xml_number(out, "x2", x);
    xml_number(out, "y2", y);
    text_print(out, "/>\n  </GraphicalRepresentation>\n");
}

void describe_terminals(Text *out, const Variables *all, double icon)
{
    bool any = false;
    text_print(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n");
    if (icon > 0)
        describe_icon(out, icon);
    for (int i = 0; i < all->count; ++i) {
        const Variable *v = &all->variable[i];
        bool first = v->terminal != NULL;
        for (int j = 0; j < i; ++j)
            first = first && !same_terminal(v, &all->variable[j]);
        if (first && !any)
            text_print(out, "  <Terminals>\n");
        any = any || first;
        if (first)
            describe_terminal(out, all, v);
    }
    text_print(out, "%s</fmiTerminalsAndIcons>\n", any ? "  </Terminals>\n" : "");
}
