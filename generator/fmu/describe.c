/* SPDX-License-Identifier: MIT
 * XML of an FMU: what both versions share. */
#include "fmu/fmu_private.h"
#include "host/host.h"

#include <string.h>

void xml_attribute(Text *out, const char *name, const char *text)
{
    text_print(out, " %s=\"", name);
    text_html(out, text);
    text_print(out, "\"");
}

void xml_number(Text *out, const char *name, double value)
{
    char digits[CSV_DIGITS];
    text_print(out, " %s=\"%s\"", name, csv_digits(value, digits));
}

void xml_whole(Text *out, const char *name, long value)
{
    text_print(out, " %s=\"%ld\"", name, value);
}

/* Units that variables have, each once, in the order of first use. */
static bool is_new_unit(const Variables *all, int index)
{
    for (int i = 0; i < index; ++i)
        if (all->variable[i].unit && !strcmp(all->variable[i].unit, all->variable[index].unit))
            return false;
    return true;
}

static void describe_unit(Text *out, const char *unit)
{
    int exponent[UNIT_BASES];
    double factor;
    text_print(out, "    <Unit");
    xml_attribute(out, "name", unit);
    if (!unit_parse(unit, exponent, &factor)) {
        text_print(out, "/>\n"); /* a name of the model's own */
        return;
    }
    text_print(out, ">\n      <BaseUnit");
    for (int b = 0; b < UNIT_BASES; ++b)
        if (exponent[b])
            xml_whole(out, unit_base_name[b], exponent[b]);
    if (factor != 1)
        xml_number(out, "factor", factor);
    text_print(out, "/>\n");
    if (!strcmp(unit, "rad") || !strcmp(unit, "rad/s"))
        text_print(out, "      <DisplayUnit name=\"%s\" factor=\"57.29577951308232\"/>\n", unit[3] ? "deg/s" : "deg");
    if (!strcmp(unit, "m/s"))
        text_print(out, "      <DisplayUnit name=\"km/h\" factor=\"3.6\"/>\n");
    text_print(out, "    </Unit>\n");
}

void describe_units(Text *out, const Variables *all)
{
    text_print(out, "  <UnitDefinitions>\n");
    for (int i = 0; i < all->count; ++i)
        if (all->variable[i].unit && is_new_unit(all, i))
            describe_unit(out, all->variable[i].unit);
    text_print(out, "  </UnitDefinitions>\n");
}

void describe_methods(Text *out, int indent, int32_t last)
{
    static const struct {
        const char *name, *description;
    } item[] = {{"AB3", "Adams-Bashforth of order 3"},
                {"RK4", "Runge-Kutta of order 4"},
                {"ROS2", "implicit: Rosenbrock-W of order 2"},
                {"ROS3", "implicit: Rosenbrock-W of order 3"},
                {"IMEX", "implicit: backward differentiation of order 2, in the forces alone"},
                {"EXP3", "exponential, of order 3"}};
    for (int i = 0; i <= last; ++i)
        text_print(out, "%*s<Item name=\"%s\" value=\"%d\" description=\"%s\"/>\n", indent, "", item[i].name, i + 1,
                   item[i].description);
}

void describe_log(Text *out)
{
    static const char *const category[][2] = {{"logAll", "all messages"},
                                              {"logStatusWarning", "warnings"},
                                              {"logStatusDiscard", "values that are refused, steps that fail"},
                                              {"logStatusError", "errors"}};
    text_print(out, "  <LogCategories>\n");
    for (size_t i = 0; i < sizeof category / sizeof *category; ++i)
        text_print(out, "    <Category name=\"%s\" description=\"%s\"/>\n", category[i][0], category[i][1]);
    text_print(out, "  </LogCategories>\n");
}

void describe_experiment(Text *out, const Experiment *experiment)
{
    text_print(out, "  <DefaultExperiment startTime=\"0\"");
    xml_number(out, "stopTime", experiment->stop);
    xml_number(out, "tolerance", 1e-6);
    xml_number(out, "stepSize", experiment->step);
    text_print(out, "/>\n");
}

void describe_dependencies(Text *out, const Description *d, const Variable *unknown, bool references)
{
    const Dependence *of = unknown->kind == KIND_OUTPUT       ? &d->out[unknown->index]
                           : unknown->kind == KIND_DERIVATIVE ? &d->rate[unknown->index]
                           : unknown->kind == KIND_PLACE      ? &d->place[unknown->index / 2]
                                                              : NULL;
    const char *blank = "";
    if (!of || of->everything)
        return;
    text_print(out, " dependencies=\"");
    for (int i = 0; i < d->variables->count; ++i) {
        const Variable *known = &d->variables->variable[i];
        if (!depends(of, known))
            continue;
        text_print(out, "%s%u", blank, references ? variable_reference(known) : (unsigned)i + 1);
        blank = " ";
    }
    text_print(out, "\"");
}
