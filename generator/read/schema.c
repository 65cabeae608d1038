/* SPDX-License-Identifier: MIT
 * The reader's tables of keys as a JSON Schema for editors and as a table for people, so that both agree with the
 * reader. */
#include "base/text.h"
#include "read/read.h"
#include "read/reader.h"

#include <string.h>

static const char name_pattern[] = "^[A-Za-z][A-Za-z0-9_]{0,39}$";

/* Definitions that kinds refer to. A number may be a formula of parameters, so any text is allowed for one. */
static const char definitions[] =
    "  \"$defs\": {\n"
    "    \"number\": {\"type\": [\"number\", \"string\"]},\n"
    "    \"name\": {\"type\": \"string\", \"pattern\": \"^[A-Za-z][A-Za-z0-9_]{0,39}$\"},\n"
    "    \"vector\": {\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/number\"}, \"minItems\": 3, \"maxItems\": "
    "3},\n"
    "    \"point\": {\"anyOf\": [{\"$ref\": \"#/$defs/vector\"}, {\"$ref\": \"#/$defs/name\"}]},\n"
    "    \"numbers\": {\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/number\"}, \"minItems\": 2},\n"
    "    \"stiffness\": {\"anyOf\": [{\"$ref\": \"#/$defs/number\"}, {\"type\": \"array\", \"minItems\": 6, "
    "\"maxItems\": 6, "
    "\"items\":\n"
    "      {\"anyOf\": [{\"$ref\": \"#/$defs/number\"}, {\"type\": \"array\", \"minItems\": 1, \"maxItems\": 6, "
    "\"items\": "
    "{\"$ref\": \"#/$defs/number\"}}]}}]}\n"
    "  },\n";

static void reference(Text *out, const char *name)
{
    text_print(out, "{\"$ref\": \"#/$defs/%s\"}", name);
}

static void pair(Text *out, const char *name)
{
    text_print(out, "{\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/%s\"}, \"minItems\": 2, \"maxItems\": 2}",
               name);
}

static void object(Text *out, const Section *section, int indent);
static void group(Text *out, const Section *section);

/* Begin a map of named entries, up to the schema of an entry. */
static void entries_begin(Text *out, int indent)
{
    text_print(out, "{\"type\": \"object\", \"propertyNames\": {\"pattern\": \"%s\"}, \"additionalProperties\":\n%*s",
               name_pattern, indent, "");
}

static void entries(Text *out, const Section *section, int indent)
{
    entries_begin(out, indent + 2);
    object(out, section, indent + 2);
    text_print(out, "}");
}

static void value(Text *out, const Key *key, int indent)
{
    switch (key->kind) {
    case KEY_NUMBER:
    case KEY_MEASURE:
    case KEY_ODD:
        if (key->bound == BOUND_NONE)
            reference(out, "number");
        else
            text_print(out, "{\"anyOf\": [{\"type\": \"number\", \"%s\": 0}, {\"type\": \"string\"}]}",
                       key->bound == BOUND_POSITIVE ? "exclusiveMinimum" : "minimum");
        break;
    case KEY_FORMULA: reference(out, "number"); break;
    case KEY_STIFFNESS: reference(out, "stiffness"); break;
    case KEY_FLAG: text_print(out, "{\"type\": \"boolean\"}"); break;
    case KEY_PAIR:
    case KEY_RANGE: pair(out, "number"); break;
    case KEY_VECTOR:
    case KEY_AXIS:
    case KEY_TURN:
    case KEY_DUAL_AXIS:
    case KEY_FORCE_VECTOR:
    case KEY_WORLD_VECTOR:
    case KEY_TORQUE_VECTOR: reference(out, "vector"); break;
    case KEY_AXES: pair(out, "vector"); break;
    case KEY_EULER:
        text_print(
            out, "{\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/number\"}, \"minItems\": 4, \"maxItems\": 4}");
        break;
    case KEY_POINT: reference(out, "point"); break;
    case KEY_POINTS: pair(out, "point"); break;
    case KEY_BODIES:
    case KEY_FORCE_BODIES: pair(out, "name"); break;
    case KEY_NAME:
    case KEY_BODY:
    case KEY_FRAME:
    case KEY_COORDINATE:
    case KEY_JOINT:
    case KEY_FORCE:
    case KEY_TIRE:
    case KEY_WHEEL:
    case KEY_TABLE:
    case KEY_SIGNAL: reference(out, "name"); break;
    case KEY_INERTIA:
        text_print(out, "{\"anyOf\": [{\"$ref\": \"#/$defs/vector\"}, ");
        object(out, &inertia_section, indent);
        text_print(out, "]}");
        break;
    case KEY_SHAPE:
        text_print(out, "{\"anyOf\": [{\"type\": \"string\", \"pattern\": \"^(box|cylinder|.*\\\\.obj)$\"}, ");
        object(out, &shape_section, indent);
        text_print(out, "]}");
        break;
    case KEY_PATH: text_print(out, "{\"type\": \"string\", \"pattern\": \"\\\\.obj$\"}"); break;
    case KEY_ORIENTATION: object(out, &orientation_section, indent); break;
    case KEY_ITEM: text_print(out, "{}"); break;
    case KEY_LIST: reference(out, "numbers"); break;
    case KEY_SERIES: text_print(out, "{\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/number\"}}"); break;
    case KEY_OUTPUTS:
        text_print(out,
                   "{\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/name\"}, \"minItems\": 1, \"maxItems\": 2}");
        break;
    case KEY_ENGINE: object(out, &engine_section, indent); break;
    case KEY_CONVERTER: object(out, &converter_section, indent); break;
    case KEY_TRANSMISSION: object(out, &transmission_section, indent); break;
    case KEY_DIFFERENTIALS: entries(out, &differential_section, indent); break;
    case KEY_POWERTRAIN: object(out, &powertrain_section, indent); break;
    case KEY_RULES: group(out, &rule_section); break;
    case KEY_INTERPOLATION:
    case KEY_BEYOND:
    case KEY_SIDE:
        text_print(out, "{\"enum\": [\"%s\", \"%s\"]}", kind_words[key->kind][0], kind_words[key->kind][1]);
        break;
    default: text_print(out, "{\"type\": \"string\"}");
    }
}

/* Add the line about a key to the schema of its value. */
static void described(Text *out, const char *about, const Text *schema)
{
    text_print(out, "{\"description\": \"%s\"%s%s", about, schema->s[1] == '}' ? "" : ", ", schema->s + 1);
}

/* One form of a section: `type` is its word for the key of that name, or NULL. */
static void form(Text *out, const Section *section, int which, const char *type, int indent)
{
    text_print(out, "{\"type\": \"object\", \"additionalProperties\": false, \"properties\": {");
    const char *separator = "";
    for (int k = 0; k < section->keys; ++k) {
        const Key *key = &section->key[k];
        if (!(key->allowed & FORM(which)))
            continue;
        text_print(out, "%s\n%*s\"%s\": ", separator, indent + 2, "", key->name);
        separator = ",";
        Text schema = {.pool = out->pool};
        if (key->kind == KEY_TYPE)
            text_print(&schema, "{\"const\": \"%s\"}", type);
        else
            value(&schema, key, indent + 2);
        described(out, section->about[k], &schema);
    }
    text_print(out, "},\n%*s\"required\": [", indent, "");
    separator = "";
    for (int k = 0; k < section->keys; ++k)
        if (section->key[k].required & section->key[k].allowed & FORM(which)) {
            text_print(out, "%s\"%s\"", separator, section->key[k].name);
            separator = ", ";
        }
    text_print(out, "]}");
}

static unsigned type_forms(const Section *section, int type)
{
    return section->type_forms ? section->type_forms[type] : FORM(type);
}

/* The forms that no type selects: the presence of some keys selects them. */
static unsigned forms_by_keys(const Section *section)
{
    unsigned forms = 0;
    for (int k = 0; k < section->keys; ++k)
        forms |= section->key[k].allowed == ALL_FORMS ? 0 : section->key[k].allowed;
    for (int t = 0; t < section->types; ++t)
        forms &= ~type_forms(section, t);
    return forms;
}

static void object(Text *out, const Section *section, int indent)
{
    const int forms_most = 32;
    const char *separator = "";
    if (!section->types && !section->form) {
        form(out, section, 0, NULL, indent);
        return;
    }
    text_print(out, "{\"anyOf\": [");
    for (int t = 0; t <= section->types; ++t) {
        unsigned forms = t < section->types ? type_forms(section, t) : forms_by_keys(section);
        for (int f = 0; f < forms_most; ++f)
            if (forms & FORM(f)) {
                text_print(out, "%s\n%*s", separator, indent, "");
                separator = ",";
                form(out, section, f, t < section->types ? section->type[t] : NULL, indent);
            }
    }
    text_print(out, "]}");
}

/* A file to include or a list of them, each a path or a map. */
static void inclusion(Text *out)
{
    Text part = {.pool = out->pool};
    text_print(&part, "{\"type\": \"string\"}, ");
    object(&part, &part_section, 6);
    text_print(out, "{\"anyOf\": [%s,\n      {\"type\": \"array\", \"items\": {\"anyOf\": [%s]}}]}", part.s, part.s);
}

/* A map of named entries; of points where `section` is NULL. */
static void group(Text *out, const Section *section)
{
    /* `name: value` will do */
    const bool bare = section == &parameter_section || section == &signal_section || section == &rule_section ||
                      section == &argument_section;
    entries_begin(out, 6);
    if (bare)
        text_print(out, "{\"anyOf\": [{\"$ref\": \"#/$defs/number\"}, ");
    if (section)
        object(out, section, 6);
    else
        reference(out, "vector");
    text_print(out, "%s}", bare ? "]}" : "");
}

void schema_print(Text *out)
{
    text_print(out,
               "{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n  \"title\": \"gicgen model "
               "(.veh)\",\n%s",
               definitions);
    text_print(
        out,
        "  \"type\": \"object\", \"required\": [\"gicgen\"], \"additionalProperties\": false,\n  \"properties\": {");
    for (int k = 0; k < file_section.keys; ++k) {
        const Key *key = &file_section.key[k];
        const Section *section = group_section(key->name);
        Text schema = {.pool = out->pool};
        text_print(out, "%s\n    \"%s\": ", k ? "," : "", key->name);
        if (!strcmp(key->name, "gicgen"))
            text_print(&schema, "{\"const\": 1}");
        else if (!strcmp(key->name, "include"))
            inclusion(&schema);
        else if (!strcmp(key->name, "arguments"))
            group(&schema, &argument_section);
        else if (!section && strcmp(key->name, "points"))
            value(&schema, key, 4);
        else
            group(&schema, section);
        described(out, file_section.about[k], &schema);
    }
    text_print(out, "\n  }\n}\n");
}

/* ---- for people ------------------------------------------------------------------------------------------ */

/* Words of the types that allow a key; all types: an empty text. */
static void types_of(Text *out, const Section *section, unsigned forms)
{
    const char *separator = " for ";
    unsigned all = 0;
    for (int t = 0; t < section->types; ++t)
        all |= type_forms(section, t);
    if (!section->types || (forms & all) == all)
        return;
    for (int t = 0; t < section->types; ++t)
        if (forms & (type_forms(section, t))) {
            text_print(out, "%s%s", separator, section->type[t]);
            separator = ", ";
        }
}

/* True if a key is required only together with another key, which selects one of the forms of its type. */
static bool by_choice(const Section *section, const Key *key)
{
    for (int t = 0; t < section->types && section->type_forms; ++t)
        if (key->required & section->type_forms[t] && section->type_forms[t] & ~key->required)
            return true;
    return forms_by_keys(section) & key->required && forms_by_keys(section) & ~key->required;
}

static void section_keys(Text *out, const char *name, const Section *section)
{
    text_print(out, "\n%s\n", name);
    for (int k = 0; k < section->keys; ++k) {
        const Key *key = &section->key[k];
        text_print(out, "  %-15s %-22s", key->name, kind_example[key->kind]);
        if (key->kind == KEY_TYPE) {
            for (int t = 0; t < section->types; ++t)
                text_print(out, "%s%s", t ? ", " : " one of: ", section->type[t]);
        } else {
            text_print(out, " %s", !key->required ? "optional" : by_choice(section, key) ? "one way" : "required");
            types_of(out, section, key->required ? key->required : key->allowed);
            if (key->required && key->required != key->allowed)
                text_print(out, "; optional otherwise"), types_of(out, section, key->allowed & ~key->required);
        }
        text_print(out, "\n      %s\n", section->about[k]);
    }
}

void keys_print(Text *out)
{
    text_print(out, "Keys of a .veh file; models/FORMAT.md, TIRES.md and POWERTRAIN.md say more of each.\n");
    section_keys(out, "the file", &file_section);
    for (int k = 0; k < file_section.keys; ++k)
        if (group_section(file_section.key[k].name))
            section_keys(out, file_section.key[k].name, group_section(file_section.key[k].name));
    section_keys(out, "an entry of rules", &rule_section);
    section_keys(out, "powertrain", &powertrain_section);
    section_keys(out, "engine", &engine_section);
    section_keys(out, "converter", &converter_section);
    section_keys(out, "transmission", &transmission_section);
    section_keys(out, "an entry of differentials", &differential_section);
    section_keys(out, "an entry of include", &part_section);
    section_keys(out, "an entry of arguments", &argument_section);
    section_keys(out, "inertia as a map", &inertia_section);
    section_keys(out, "orientation (one of the three ways)", &orientation_section);
    section_keys(out, "shape as a map", &shape_section);
}
