/* SPDX-License-Identifier: MIT
 * modelDescription.xml: see description.h. */
#include "description.h"

#include <libxml/parser.h>
#include <libxml/tree.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static _Noreturn void fail(const char *what, const char *name)
{
    fprintf(stderr, "modelDescription.xml: %s: %s\n", what, name);
    exit(1);
}

static const char *attribute(xmlNode *node, const char *name)
{
    xmlChar *text = xmlGetProp(node, (const xmlChar *)name);
    return text ? (const char *)text : "";
}

static bool is(const xmlNode *node, const char *name)
{
    return node->type == XML_ELEMENT_NODE && !strcmp((const char *)node->name, name);
}

static xmlNode *child(xmlNode *node, const char *name)
{
    xmlNode *found = node->children;
    while (found && !is(found, name))
        found = found->next;
    return found;
}

static Type type_of(const char *name)
{
    static const char *const whole[] = {"Integer", "Enumeration", "Int32", "Int64"};
    if (!strcmp(name, "Real") || !strcmp(name, "Float64"))
        return REAL;
    for (size_t i = 0; i < sizeof whole / sizeof *whole; ++i)
        if (!strcmp(name, whole[i]))
            return WHOLE;
    return OTHER;
}

static void read_variable(Description *d, xmlNode *node)
{
    xmlNode *typed = d->version == 2 ? node->children : node;
    while (typed && typed->type != XML_ELEMENT_NODE)
        typed = typed->next;
    if (!typed)
        fail("a variable without type", attribute(node, "name"));
    d->variable = realloc(d->variable, sizeof *d->variable * (size_t)(d->variables + 1));
    Variable *v = &d->variable[d->variables++];
    *v = (Variable){attribute(node, "name"),
                    attribute(node, "causality"),
                    attribute(node, "variability"),
                    attribute(node, "initial"),
                    attribute(typed, "unit"),
                    (unsigned)strtoul(attribute(node, "valueReference"), NULL, 10),
                    type_of((const char *)typed->name),
                    attribute(typed, "start")[0] != 0,
                    strtod(attribute(typed, "start"), NULL),
                    true,
                    0,
                    NULL,
                    attribute(typed, "derivative")[0] ? strtol(attribute(typed, "derivative"), NULL, 10) : -1};
}

static void add_state(Description *d, int rate)
{
    const long of = d->variable[rate].derivative;
    int state = (int)of - 1;
    if (d->version == 3)
        for (state = d->variables - 1; state >= 0 && d->variable[state].reference != (unsigned)of; --state)
            ;
    if (of < 0 || state < 0 || state >= d->variables)
        fail("no state of this derivative", d->variable[rate].name);
    d->state = realloc(d->state, sizeof *d->state * (size_t)(d->states + 1));
    d->rate = realloc(d->rate, sizeof *d->rate * (size_t)(d->states + 1));
    d->state[d->states] = state;
    d->rate[d->states++] = rate;
}

static int by_reference(const Description *d, unsigned reference)
{
    for (int i = 0; i < d->variables; ++i)
        if (d->variable[i].reference == reference)
            return i;
    fail("no variable has a value reference of ModelStructure", "");
}

/* An unknown: its index, and what it depends on. */
static int read_unknown(Description *d, xmlNode *node)
{
    const char *which = attribute(node, d->version == 2 ? "index" : "valueReference"), *list;
    const int index = d->version == 2 ? atoi(which) - 1 : by_reference(d, (unsigned)strtoul(which, NULL, 10));
    if (index < 0 || index >= d->variables)
        fail("no variable", which);
    Variable *v = &d->variable[index];
    v->everything = !xmlHasProp(node, (const xmlChar *)"dependencies");
    list = attribute(node, "dependencies");
    for (char *end; *list; list = end) {
        const unsigned long number = strtoul(list, &end, 10);
        if (end == list)
            break;
        const int known = d->version == 2 ? (int)number - 1 : by_reference(d, (unsigned)number);
        if (known < 0 || known >= d->variables)
            fail("a dependency on no variable", v->name);
        v->dependency = realloc(v->dependency, sizeof(int) * (size_t)(v->dependencies + 1));
        v->dependency[v->dependencies++] = known;
    }
    return index;
}

static void read_structure(Description *d, xmlNode *structure)
{
    static const char *const list_name[] = {"Outputs", "Derivatives"}, *const element[] = {"Output",
                                                                                           "ContinuousStateDerivative"};
    for (int rates = 0; rates < 2; ++rates) {
        xmlNode *list = d->version == 2 ? child(structure, list_name[rates]) : structure;
        for (xmlNode *node = list ? list->children : NULL; node; node = node->next)
            if (is(node, d->version == 2 ? "Unknown" : element[rates])) {
                const int unknown = read_unknown(d, node);
                if (rates)
                    add_state(d, unknown);
            }
    }
    for (xmlNode *node = structure->children; node; node = node->next)
        d->indicators += is(node, "EventIndicator");
}

Description description_read(const char *path)
{
    Description d = {0};
    xmlDoc *document = xmlReadFile(path, NULL, 0);
    xmlNode *root = document ? xmlDocGetRootElement(document) : NULL;
    if (!root || !is(root, "fmiModelDescription"))
        fail("no description", path);
    d.version = attribute(root, "fmiVersion")[0] - '0';
    d.token = attribute(root, d.version == 2 ? "guid" : "instantiationToken");
    xmlNode *steps = child(root, "CoSimulation"), *variables = child(root, "ModelVariables");
    if (!steps || !variables || !child(root, "ModelStructure"))
        fail("an element is missing", path);
    d.identifier = attribute(steps, "modelIdentifier");
    for (xmlNode *node = variables->children; node; node = node->next)
        if (node->type == XML_ELEMENT_NODE)
            read_variable(&d, node);
    read_structure(&d, child(root, "ModelStructure"));
    if (d.version == 2)
        d.indicators = atoi(attribute(root, "numberOfEventIndicators"));
    return d; /* the document stays: names are in it */
}

int description_find(const Description *d, const char *name)
{
    for (int i = 0; i < d->variables; ++i)
        if (!strcmp(d->variable[i].name, name))
            return i;
    return -1;
}
