/* SPDX-License-Identifier: MIT
 * Reads a section entry by its table of keys: all kinds of values, and the checks of names. */
#include "base/table.h"
#include "base/text.h"
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NAME_LENGTH = 40, SOME_MOST = 1000 /* bodies, and parameters, which each formula searches linearly */ };

/* An example of each kind of value, for remedies. */
const char *const kind_example[KEY_KINDS] = {
    [KEY_TYPE] = "name",
    [KEY_ITEM] = "{...}",
    [KEY_FORMULA] = "formula",
    [KEY_STIFFNESS] = "number",
    [KEY_FORCE_VECTOR] = "[x, y, z]",
    [KEY_TORQUE_VECTOR] = "[x, y, z]",
    [KEY_WORLD_VECTOR] = "[x, y, z]",
    [KEY_INERTIA] = "[Ixx, Iyy, Izz]",
    [KEY_ORIENTATION] = "{...}",
    [KEY_LIST] = "[x, y, ...]",
    [KEY_TEXT] = "text",
    [KEY_INTERPOLATION] = "linear",
    [KEY_BEYOND] = "constant",
    [KEY_SIDE] = "left",
    [KEY_NAME] = "name",
    [KEY_NUMBER] = "number",
    [KEY_MEASURE] = "number",
    [KEY_ODD] = "number",
    [KEY_PAIR] = "[first, second]",
    [KEY_FLAG] = "true",
    [KEY_RANGE] = "[low, high]",
    [KEY_VECTOR] = "[x, y, z]",
    [KEY_AXIS] = "[x, y, z]",
    [KEY_TURN] = "[x, y, z]",
    [KEY_DUAL_AXIS] = "[x, y, z]",
    [KEY_AXES] = "[[x, y, z], [x, y, z]]",
    [KEY_EULER] = "[e0, e1, e2, e3]",
    [KEY_POINT] = "[x, y, z]",
    [KEY_POINTS] = "[[x, y, z], [x, y, z]]",
    [KEY_BODY] = "body",
    [KEY_BODIES] = "[a, b]",
    [KEY_FORCE_BODIES] = "[a, b]",
    [KEY_FRAME] = "body",
    [KEY_COORDINATE] = "coordinate",
    [KEY_JOINT] = "joint",
    [KEY_FORCE] = "force",
    [KEY_TIRE] = "tire",
    [KEY_WHEEL] = "wheel",
    [KEY_TABLE] = "table",
    [KEY_SIGNAL] = "signal",
    [KEY_SHAPE] = "box",
    [KEY_PATH] = "name.obj",
    [KEY_SERIES] = "[first, ...]",
    [KEY_OUTPUTS] = "[first, second]",
    [KEY_ENGINE] = "{...}",
    [KEY_CONVERTER] = "{...}",
    [KEY_TRANSMISSION] = "{...}",
    [KEY_DIFFERENTIALS] = "{name: {...}}",
    [KEY_POWERTRAIN] = "{...}",
    [KEY_RULES] = "{name: formula}",
};

const char *const kind_words[KEY_KINDS][2] = {
    [KEY_INTERPOLATION] = {"linear", "cubic"},
    [KEY_BEYOND] = {"constant", "linear"},
    [KEY_SIDE] = {"left", "right"},
};

void name_check(const char *name, const char *what, Place at)
{
    size_t length = strlen(name);
    bool good = length > 0 && !(name[0] >= '0' && name[0] <= '9') && name[0] != '_';
    for (size_t i = 0; i < length; ++i)
        good = good && (unsigned char)name[i] < 128 && (isalnum((unsigned char)name[i]) || name[i] == '_');
    if (!good)
        diag_fail(at, "use letters, digits and `_`, beginning with a letter", "'%s' is not a name for %s", name, what);
    if (length > NAME_LENGTH)
        diag_fail(at, "take a shorter name", "the name '%s' of %s is longer than %d characters", name, what,
                  NAME_LENGTH);
}

void model_name_check(const char *name, Place at)
{
    name_check(name, "the model", at);
    const char *reserved = name_reserved(name);
    if (reserved)
        diag_fail(at, "take another name, such as my_model", "the model name '%s' %s", name, reserved);
}

/* A text that becomes part of a comment and of a string of the generated code must be one line. */
static void text_check(const char *text, const char *what, Place at)
{
    for (const char *c = text; *c; ++c)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            diag_fail(at, "write it in one line, without tabs", "%s must be one line of text", what);
    if (strstr(text, "/*") || strstr(text, "*/"))
        diag_fail(at, "leave comment marks away", "%s would begin or end a comment in the generated code", what);
}

bool vector_normalize(double *vector, int size)
{
    double largest = 0, sum = 0;
    for (int i = 0; i < size; ++i)
        largest = fmax(largest, fabs(vector[i]));
    if (largest == 0)
        return false;
    int exponent;
    frexp(largest, &exponent); /* a power of two scales without rounding */
    for (int i = 0; i < size; ++i) {
        vector[i] = ldexp(vector[i], -exponent);
        sum += vector[i] * vector[i];
    }
    double norm = sqrt(sum);
    for (int i = 0; i < size; ++i)
        vector[i] /= norm;
    return true;
}

Entry *section_entries(Reader *reader, const Item *map, const char *thing, int *count)
{
    *count = 0;
    if (!map)
        return NULL;
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write `name: {...}` for each one, or {} for none",
                  "a map is wanted here, with a name for each %s", thing);
    const int most = strcmp(thing, "body") && strcmp(thing, "parameter") ? map->count : SOME_MOST;
    if (map->count > most)
        diag_fail(map->key[most]->at, "take some away", "this %s is one more than the %d that a model may have", thing,
                  most);
    Entry *entry = pool_alloc(reader->pool, sizeof *entry * (size_t)(map->count + 1));
    for (int i = 0; i < map->count; ++i) {
        const Item *key = map->key[i];
        name_check(key->text, pool_print(reader->pool, "a %s", thing), key->at);
        entry[i] = (Entry){key->text, pool_print(reader->pool, "%s '%s'", thing, key->text), key->at, map->value[i]};
    }
    *count = map->count;
    return entry;
}

static const char *name_at(const void *first, size_t stride, int i)
{
    return *(const char *const *)(const void *)((const char *)first + (size_t)i * stride);
}

/* The index of `word` among the names of `count` structures, each of `stride` bytes and beginning with its name; any
 * other word ends in a message. */
static int find(Reader *reader, const Item *item, const char *what, const char *thing, const void *first, int count,
                size_t stride)
{
    const char *word = doc_word(item, what);
    for (int i = 0; i < count; ++i)
        if (!strcmp(name_at(first, stride, i), word))
            return i;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(count + 1));
    Text list = {.pool = reader->pool};
    for (int i = 0; i < count; ++i) {
        name[i] = name_at(first, stride, i);
        text_print(&list, "%s%s", i ? ", " : "", name[i]);
    }
    const char *nearest = diag_nearest(word, name, count);
    const char *remedy = nearest ? pool_print(reader->pool, "did you mean '%s'?", nearest)
                         : count ? pool_print(reader->pool, "one of: %s", list.s)
                                 : pool_print(reader->pool, "the model has no %s; define one first", thing);
    diag_fail(item->at, remedy, "%s: there is no %s '%s'", what, thing, word);
}

static int find_body(Reader *reader, const Item *item, const char *what, bool ground)
{
    const Model *model = reader->model;
    const char *word = doc_word(item, what);
    if (model->free_base && !strcmp(word, "ground")) {
        if (!ground)
            diag_fail(item->at,
                      pool_print(reader->pool, "name a body (the base is '%s'), or write `base: ground`",
                                 model->body[BODY_BASE].name),
                      "%s: with a free base only force elements may refer to ground", what);
        return BODY_GROUND;
    }
    return find(reader, item, what, "body", model->body, model->bodies, sizeof *model->body);
}

static void find_bodies(Reader *reader, const Item *item, const char *what, bool ground, int index[2])
{
    if (item->kind != ITEM_LIST || item->count != 2)
        diag_fail(item->at, "write [a, b]", "%s must be a list of two bodies", what);
    for (int i = 0; i < 2; ++i)
        index[i] = find_body(reader, item->value[i], what, ground);
    if (index[0] == index[1])
        diag_fail(item->value[1]->at, "name two different bodies", "%s: both are '%s'", what, item->value[1]->text);
}

bool mentions_parameter(const Reader *reader, const Item *item)
{
    if (item->kind != ITEM_SCALAR || doc_is_decimal(item))
        return false;
    for (int i = 0; i < reader->model->parameters; ++i) {
        const char *name = reader->model->parameter[i].name;
        size_t length = strlen(name);
        for (const char *s = item->text; (s = strstr(s, name)); s += length) {
            bool begins = s == item->text || !(isalnum((unsigned char)s[-1]) || s[-1] == '_');
            if (begins && !isalnum((unsigned char)s[length]) && s[length] != '_')
                return true;
        }
    }
    return false;
}

/* True if the item looks like a formula with a name in it: a word at its beginning or after an operator. */
static bool looks_like_formula(const Reader *reader, const Item *item)
{
    static const char *const word[] = {"nan", "inf", "infinity", "null", "true", "false", "yes", "no", "on", "off"};
    if (item->kind != ITEM_SCALAR || (!reader->model->parameters && !strpbrk(item->text, "*/^(")))
        return false;
    char before = '+';
    for (const char *s = item->text; *s; ++s) {
        size_t length = 0;
        while (isalpha((unsigned char)s[length]) || s[length] == '_')
            ++length;
        bool named = length && strchr("+-*/^(", before);
        for (size_t i = 0; named && i < sizeof word / sizeof *word; ++i)
            named = strlen(word[i]) != length || strncasecmp(word[i], s, length) != 0;
        if (named)
            return true;
        before = *s == ' ' ? before : *s;
    }
    return false;
}

/* An item that mentions no parameter and does not look like a formula gets doc_number's message if it is not a number.
 */
double number_read(Reader *reader, const Item *item, const char *what, Ex *tuned)
{
    if (tuned)
        *tuned = 0;
    if (!mentions_parameter(reader, item) && !looks_like_formula(reader, item))
        return doc_number(item, what);
    LawNames names = {
        .model = reader->model, .constant = true, .remedy = "put what changes with time into a force element"};
    const Law *law = law_parse(reader->pool, item, what, &names);
    bool tunable = law_is_tunable(law, reader->model);
    if (tunable && (!tuned || reader->fixed))
        diag_fail(item->at, "leave out `tunable: true` of that parameter, or use it elsewhere",
                  "%s is fixed when the code is generated, but '%s' has a tunable parameter", what, item->text);
    double number = law_number(law, reader->model); /* law_parse has applied the sign of a negated item */
    double shift = item->negated ? 0 - item->shift : item->shift;
    if (!isfinite(number))
        diag_fail(item->at, "look for a division by zero or a root of a negative number", "%s is not a finite number",
                  what);
    if (tunable) {
        Dag *dag = reader->model->tuning->dag;
        *tuned = ex_add(dag, law_expression(dag, reader->model, law), ex_literal(dag, shift));
        tuned_reduce(reader, tuned, 1);
    }
    return number + shift;
}

void vector_read(Reader *reader, const Item *item, const char *what, double *out, int size, Ex *tuned)
{
    bool any = false;
    for (int i = 0; item->kind == ITEM_LIST && item->count == size && i < size; ++i)
        any = any || mentions_parameter(reader, item->value[i]);
    if (!any)
        doc_vector(item, what, out, size);
    for (int i = 0; i < size; ++i) {
        if (any)
            out[i] = number_read(reader, item->value[i], what, tuned ? tuned + i : NULL);
        else if (tuned)
            tuned[i] = 0;
    }
}

/* FORMAT.md section 14: generated code has the stated accuracy for sizes between these. */
static const double largest_number = 1e15, smallest_number = 1e-15, farthest_point = 1e6;

void point_check(const Item *item, const char *what, const double x[3])
{
    for (int i = 0; i < 3; ++i)
        if (fabs(x[i]) > farthest_point)
            diag_fail(item->at, "write it in metres, with the design near the origin",
                      "%s: that is more than %g m from the origin", what, farthest_point);
}

static void read_point(Reader *reader, const Item *item, const char *what, double x[3], Ex tuned[3])
{
    if (item->kind == ITEM_SCALAR) {
        if (!isalpha((unsigned char)item->text[0]))
            diag_fail(item->at, "write [x, y, z] or the name of a point", "%s must be a point", what);
        int i = find(reader, item, what, "point", reader->point, reader->points, sizeof *reader->point);
        memcpy(x, reader->point[i].x, sizeof reader->point[i].x);
        memcpy(tuned, reader->point[i].tuned, sizeof reader->point[i].tuned);
    } else
        vector_read(reader, item, what, x, 3, tuned);
    point_check(item, what, x);
}

static void read_axis(Reader *reader, const Item *item, const char *what, double u[3], Ex tuned[3])
{
    vector_read(reader, item, what, u, 3, tuned);
    axis_tune(reader, u, tuned, what);
    if (!vector_normalize(u, 3))
        diag_fail(item->at, "write a direction, such as [0, 0, 1]", "%s has no direction: it is zero", what);
}

void bound_check(const Key *key, const Item *item, const char *what, double number)
{
    if (key->bound == BOUND_POSITIVE && !(number > 0))
        diag_fail(item->at, "write a positive number", "%s must be greater than zero, not %s", what, item->text);
    if (key->bound == BOUND_NOT_NEGATIVE && number < 0)
        diag_fail(item->at, "write zero or a positive number", "%s must not be negative (%s)", what, item->text);
    if (fabs(number) > largest_number || (number != 0 && fabs(number) < smallest_number))
        diag_fail(item->at, "use SI units: m, kg, s, N, rad", "%s is %s, which is not zero or from %g to %g in size",
                  what, item->text, smallest_number, largest_number);
}

const char *bound_text(Pool *pool, const Key *key, const char *what)
{
    return pool_print(pool, "%s must %s", what,
                      key->bound == BOUND_POSITIVE ? "be greater than zero" : "not be negative");
}

static void read_number(Reader *reader, const Key *key, const Item *item, const char *what, Value *value)
{
    value->number[0] = number_read(reader, item, what, key->kind == KEY_NUMBER ? NULL : value->tuned);
    bound_check(key, item, what, value->number[0]);
    if (value->tuned[0] && key->bound != BOUND_NONE)
        tuning_require(reader->model->tuning, value->tuned[0], key->bound == BOUND_NOT_NEGATIVE,
                       bound_text(reader->pool, key, what));
}

/* One of two words; true for the second. */
static bool second_word(const Item *item, const char *what, const char *const word[2])
{
    const char *text = doc_word(item, what);
    if (!strcmp(text, word[0]))
        return false;
    if (strcmp(text, word[1]))
        diag_fail(item->at, "choose one of the two", "%s is `%s` or `%s`, not '%s'", what, word[0], word[1], text);
    return true;
}

static void read_value(Reader *reader, const Key *key, const Item *item, const char *what, Value *value)
{
    const Model *model = reader->model;
    switch (key->kind) {
    case KEY_TEXT:
    case KEY_PATH:
    case KEY_NAME:
        value->text = doc_word(item, what);
        text_check(value->text, what, item->at);
        break;
    case KEY_NUMBER:
    case KEY_MEASURE:
    case KEY_ODD: read_number(reader, key, item, what, value); break;
    case KEY_INTERPOLATION:
    case KEY_BEYOND:
    case KEY_SIDE: value->flag = second_word(item, what, kind_words[key->kind]); break;
    case KEY_PAIR:
        vector_read(reader, item, what, value->number, 2, NULL);
        for (int i = 0; i < 2; ++i)
            bound_check(key, item->value[i], what, value->number[i]);
        break;
    case KEY_FLAG: value->flag = doc_bool(item, what); break;
    case KEY_RANGE:
        vector_read(reader, item, what, value->number, 2, NULL);
        if (!(value->number[0] < value->number[1]))
            diag_fail(item->at, "write [low, high]", "%s: the low end must be below the high end", what);
        break;
    case KEY_VECTOR: vector_read(reader, item, what, value->number, 3, value->tuned); break;
    case KEY_AXIS:
    case KEY_TURN:
    case KEY_DUAL_AXIS: read_axis(reader, item, what, value->number, value->tuned); break;
    case KEY_AXES:
        if (item->kind != ITEM_LIST || item->count != 2)
            diag_fail(item->at, "write [u_a, u_b]; each is a direction [x, y, z]",
                      "%s must be a list of two directions", what);
        for (int i = 0; i < 2; ++i)
            read_axis(reader, item->value[i], pool_print(reader->pool, "the %s of %s", i ? "second" : "first", what),
                      value->number + 3 * i, value->tuned + 3 * i);
        break;
    case KEY_EULER: vector_read(reader, item, what, value->number, 4, NULL); break;
    case KEY_POINT: read_point(reader, item, what, value->number, value->tuned); break;
    case KEY_POINTS:
        if (item->kind != ITEM_LIST || item->count != 2)
            diag_fail(item->at, "write [p_a, p_b]; each is [x, y, z] or the name of a point",
                      "%s must be a list of two points", what);
        read_point(reader, item->value[0], what, value->number, value->tuned);
        read_point(reader, item->value[1], what, value->number + 3, value->tuned + 3);
        break;
    case KEY_BODY: value->index[0] = find_body(reader, item, what, false); break;
    case KEY_BODIES: find_bodies(reader, item, what, false, value->index); break;
    case KEY_FORCE_BODIES: find_bodies(reader, item, what, true, value->index); break;
    case KEY_FRAME:
        if (!strcmp(doc_word(item, what), "world") || !strcmp(item->text, "ground"))
            value->index[0] = BODY_GROUND;
        else
            value->index[0] = find_body(reader, item, what, false);
        break;
    case KEY_COORDINATE:
        value->index[0] =
            find(reader, item, what, "coordinate", model->coordinate, model->coordinates, sizeof *model->coordinate);
        break;
    case KEY_JOINT:
        value->index[0] = find(reader, item, what, "joint", model->joint, model->joints, sizeof *model->joint);
        break;
    case KEY_FORCE:
        value->index[0] = find(reader, item, what, "force element", model->force, model->forces, sizeof *model->force);
        break;
    case KEY_TIRE:
        value->index[0] = find(reader, item, what, "tire", model->tire, model->tires, sizeof *model->tire);
        break;
    case KEY_WHEEL:
        value->index[0] = find(reader, item, what, "wheel", model->wheel, model->wheels, sizeof *model->wheel);
        break;
    case KEY_TABLE:
        value->index[0] = find(reader, item, what, "table", model->table, model->tables, sizeof *model->table);
        model->table[value->index[0]].read = true;
        break;
    case KEY_SIGNAL:
        value->index[0] = find(reader, item, what, "signal", model->signal, model->signals, sizeof *model->signal);
        break;
    case KEY_TYPE:
    case KEY_ITEM:
    case KEY_LIST:
    case KEY_FORMULA:
    case KEY_STIFFNESS:
    case KEY_FORCE_VECTOR:
    case KEY_TORQUE_VECTOR:
    case KEY_WORLD_VECTOR:
    case KEY_INERTIA:
    case KEY_ORIENTATION:
    case KEY_SHAPE:
    case KEY_SERIES:
    case KEY_OUTPUTS:
    case KEY_ENGINE:
    case KEY_CONVERTER:
    case KEY_TRANSMISSION:
    case KEY_DIFFERENTIALS:
    case KEY_POWERTRAIN:
    case KEY_RULES:
    case KEY_KINDS: break;
    }
}

/* Names of the keys that `forms` know, as a list and, for remedies, as one text. */
static const char **key_names(Reader *reader, const Section *section, unsigned forms, int *count, const char **list)
{
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(section->keys + 1));
    Text text = {.pool = reader->pool};
    *count = 0;
    for (int k = 0; k < section->keys; ++k)
        if (section->key[k].allowed & forms) {
            text_print(&text, "%s%s", *count ? ", " : "", section->key[k].name);
            name[(*count)++] = section->key[k].name;
        }
    *list = text.s;
    return name;
}

static void check_known_keys(Reader *reader, const Section *section, const Entry *entry)
{
    int count;
    const char *list, **name = key_names(reader, section, ALL_FORMS, &count, &list);
    doc_check_keys(entry->item, entry->what, name, count);
}

int section_type(Reader *reader, const Section *section, const Entry *entry)
{
    check_known_keys(reader, section, entry);
    const Item *item = doc_find(entry->item, "type");
    Text list = {.pool = reader->pool};
    for (int i = 0; i < section->types; ++i)
        text_print(&list, "%s%s", i ? ", " : "", section->type[i]);
    if (!item)
        diag_fail(entry->at, pool_print(reader->pool, "add `type:` with one of: %s", list.s), "%s lacks the key 'type'",
                  entry->what);
    const char *word = doc_word(item, pool_print(reader->pool, "type of %s", entry->what));
    for (int i = 0; i < section->types; ++i)
        if (!strcmp(section->type[i], word))
            return i;
    const char *nearest = diag_nearest(word, section->type, section->types);
    const char *remedy = nearest ? pool_print(reader->pool, "did you mean '%s'?", nearest)
                                 : pool_print(reader->pool, "one of: %s", list.s);
    diag_fail(item->at, remedy, "%s: there is no type '%s'", entry->what, word);
}

/* The index of a key; check_known_keys has verified that it exists. */
static int key_index(const Section *section, const char *name)
{
    int k = 0;
    while (strcmp(section->key[k].name, name))
        ++k;
    return k;
}

/* A required key is missing. If the entry has a key of nearly that name (`axis` for `axes`), the message is about that
 * key. */
static _Noreturn void missing_key(Reader *reader, const Section *section, int form, const Entry *entry, const Key *key,
                                  const char *what)
{
    const bool named = key->kind == KEY_BODY || key->kind == KEY_FRAME || key->kind == KEY_COORDINATE ||
                       key->kind == KEY_JOINT || key->kind == KEY_FORCE || key->kind == KEY_TIRE ||
                       key->kind == KEY_WHEEL || key->kind == KEY_TABLE || key->kind == KEY_SIGNAL;
    const char *example = kind_example[key->kind];
    const char *wanted = named ? pool_print(reader->pool, "`%s: name` with the name of a %s", key->name, example)
                               : pool_print(reader->pool, "`%s: %s`", key->name, example);
    for (int i = 0; i < entry->item->count; ++i) {
        const Item *name = entry->item->key[i];
        if (!(section->key[key_index(section, name->text)].allowed & FORM(form)) &&
            diag_nearest(name->text, &key->name, 1))
            diag_fail(name->at, pool_print(reader->pool, "write %s", wanted), "the key '%s' does not apply to %s",
                      name->text, what);
    }
    diag_fail(entry->at, pool_print(reader->pool, "add %s", wanted), "%s lacks the key '%s'", what, key->name);
}

void section_read(Reader *reader, const Section *section, int form, const Entry *entry, Value *value)
{
    check_known_keys(reader, section, entry);
    const char *what = entry->what;
    if (section->form)
        what = pool_print(reader->pool, "%s (%s)", what, section->form[form]);
    int count;
    const char *list;
    key_names(reader, section, FORM(form), &count, &list);
    for (int k = 0; k < section->keys; ++k) {
        const Key *key = section->key + k;
        const Item *item = doc_find(entry->item, key->name);
        value[k] = (Value){.item = item, .number = {key->fallback}};
        if (!item && key->required & FORM(form))
            missing_key(reader, section, form, entry, key, what);
    }
    for (int i = 0; i < entry->item->count; ++i) {
        const Item *name = entry->item->key[i];
        int k = key_index(section, name->text);
        const Key *key = section->key + k;
        if (!(key->allowed & FORM(form)))
            diag_fail(name->at, pool_print(reader->pool, "its keys are: %s", list), "the key '%s' does not apply to %s",
                      name->text, what);
        read_value(reader, key, value[k].item, pool_print(reader->pool, "%s of %s", key->name, entry->what), value + k);
    }
}

typedef struct Folded {
    const char *name, *folded;
    Place at;
    int index;
} Folded;

static int compare_folded(const void *a, const void *b)
{
    const Folded *x = a, *y = b;
    int order = strcmp(x->folded, y->folded);
    return order ? order : x->index - y->index;
}

void generated_names_check(Reader *reader, const char *thing, const char *const *name, const Place *at, int count)
{
    Folded *sorted = pool_alloc(reader->pool, sizeof *sorted * (size_t)(count + 1));
    for (int i = 0; i < count; ++i) {
        char *folded = pool_print(reader->pool, "%s", name[i]);
        for (char *c = folded; *c; ++c)
            *c = (char)(*c == '.' ? '_' : toupper((unsigned char)*c));
        if (!strcmp(folded, "ROOM"))
            diag_fail(at[i], "rename it", "the %s '%s' would have the name of an array's size in generated code", thing,
                      name[i]);
        sorted[i] = (Folded){name[i], folded, at[i], i};
    }
    qsort(sorted, (size_t)count, sizeof *sorted, compare_folded);
    for (int i = 1; i < count; ++i)
        if (!strcmp(sorted[i].folded, sorted[i - 1].folded))
            diag_fail(sorted[i].at, "rename one of them; case, and `.` against `_`, make no difference there",
                      "the %ss '%s' and '%s' have the same name in generated code", thing, sorted[i - 1].name,
                      sorted[i].name);
}
