/* SPDX-License-Identifier: MIT
 * Copies of a model's entries: mirrored, moved or renamed (FORMAT.md sections 12 and 13). One table says for each
 * kind of value how it changes. */
#include "base/text.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <ctype.h>
#include <string.h>

enum { X = 1 << 0, Y = 1 << 1, Z = 1 << 2, LONGEST = 6 /* bits of components of a list of numbers */ };

/* Formulas contain names of coordinates, inputs, parameters and tables. */
typedef enum Words { WORDS_NONE, WORDS_FORMULA, WORDS_NAME, WORDS_SIDE, WORDS_PATH } Words;

typedef struct Rule {
    unsigned odd;           /* bit i: component i changes its sign in the mirror y -> -y */
    bool place;             /* components are those of a point, which can be moved */
    bool pair;              /* a list of two such values */
    bool triangle;          /* a list that has lists is a triangle of a matrix of such components */
    bool series;            /* a list of any length, of components like the first */
    Words words;            /* the meaning of a scalar that is not a number */
    const char *group;      /* WORDS_NAME: a name of this group */
    const char *other;      /* or of this group */
    const Section *section; /* a map of keys of this section */
    bool entries;           /* the map has named entries of that section, which belong to `group` */
} Rule;

/* Named entries within the powertrain. */
static const char differentials[] = "differentials";

static const Rule rule[KEY_KINDS] = {
    [KEY_ITEM] = {.words = WORDS_FORMULA},
    [KEY_LIST] = {.series = true, .words = WORDS_FORMULA},
    [KEY_SERIES] = {.series = true, .words = WORDS_FORMULA},
    [KEY_FORMULA] = {.words = WORDS_FORMULA},
    /* along x, y, z and about them */
    [KEY_STIFFNESS] = {.odd = Y | X << 3 | Z << 3, .triangle = true, .words = WORDS_FORMULA},
    [KEY_FORCE_VECTOR] = {.odd = Y, .words = WORDS_FORMULA},
    [KEY_TORQUE_VECTOR] = {.odd = X | Z, .words = WORDS_FORMULA},
    [KEY_WORLD_VECTOR] = {.words = WORDS_FORMULA},
    [KEY_NUMBER] = {.words = WORDS_FORMULA},
    [KEY_MEASURE] = {.words = WORDS_FORMULA},
    [KEY_INERTIA] = {.words = WORDS_FORMULA, .section = &inertia_section},
    [KEY_PAIR] = {.words = WORDS_FORMULA},
    [KEY_RANGE] = {.words = WORDS_FORMULA},
    [KEY_ORIENTATION] = {.section = &orientation_section},
    [KEY_ODD] = {.odd = X},
    [KEY_AXIS] = {.odd = Y},
    [KEY_TURN] = {.odd = X | Z},
    [KEY_AXES] = {.odd = Y, .pair = true},
    [KEY_EULER] = {.odd = X << 1 | Z << 1}, /* e0, then the direction of an axis of rotation */
    [KEY_POINT] = {.odd = Y, .place = true, .words = WORDS_NAME, .group = "points"},
    [KEY_POINTS] = {.odd = Y, .place = true, .pair = true, .words = WORDS_NAME, .group = "points"},
    [KEY_BODY] = {.words = WORDS_NAME, .group = "bodies"},
    [KEY_BODIES] = {.pair = true, .words = WORDS_NAME, .group = "bodies"},
    [KEY_FORCE_BODIES] = {.pair = true, .words = WORDS_NAME, .group = "bodies"},
    [KEY_FRAME] = {.words = WORDS_NAME, .group = "bodies"},
    [KEY_COORDINATE] = {.words = WORDS_NAME, .group = "coordinates"},
    [KEY_JOINT] = {.words = WORDS_NAME, .group = "joints"},
    [KEY_FORCE] = {.words = WORDS_NAME, .group = "forces"},
    /* a file of a mesh can not be mirrored: its item is marked instead */
    [KEY_SHAPE] = {.odd = X, .words = WORDS_PATH, .section = &shape_section},
    [KEY_PATH] = {.odd = X, .words = WORDS_PATH},
    [KEY_TIRE] = {.words = WORDS_NAME, .group = "tires"},
    [KEY_SIDE] = {.words = WORDS_SIDE},
    [KEY_WHEEL] = {.words = WORDS_NAME, .group = "wheels"},
    [KEY_TABLE] = {.words = WORDS_NAME, .group = "tables"},
    [KEY_SIGNAL] = {.words = WORDS_NAME, .group = "signals"},
    [KEY_OUTPUTS] = {.pair = true, .words = WORDS_NAME, .group = "wheels", .other = differentials},
    [KEY_ENGINE] = {.section = &engine_section},
    [KEY_CONVERTER] = {.section = &converter_section},
    [KEY_TRANSMISSION] = {.section = &transmission_section},
    [KEY_DIFFERENTIALS] = {.section = &differential_section, .entries = true, .group = differentials},
    [KEY_RULES] = {.section = &rule_section, .entries = true}, /* their names are of the controller, and stay */
};

/* Maps of named entries in a file; without a section the entries are points. */
static const struct {
    const char *name;
    const Section *section;
    bool formulas; /* formulas may contain its names */
} groups[] = {
    {"points", NULL, false},
    {"bodies", &body_section, false},
    {"joints", &joint_section, false},
    {"coordinates", &coordinate_section, true},
    {"inputs", &input_section, true},
    {"parameters", &parameter_section, true},
    {"tables", &table_section, true},
    {"ports", &port_section, false},
    {"forces", &force_section, false},
    {"tires", &tire_section, false},
    {"wheels", &wheel_section, false},
    {"states", &state_section, true},
    {"signals", &signal_section, true},
    {"controllers", &controller_section, true},
    {"outputs", &output_section, false},
};

enum { GROUPS = sizeof groups / sizeof *groups };

static int group_index(const char *name)
{
    int i = 0;
    while (i < GROUPS && strcmp(groups[i].name, name))
        ++i;
    return i;
}

const Section *group_section(const char *group)
{
    int i = group_index(group);
    return i < GROUPS ? groups[i].section : NULL;
}

bool is_group(const char *group)
{
    return group_index(group) < GROUPS;
}

const char *name_mirrored(Pool *pool, const char *name)
{
    size_t length = strlen(name);
    if (length < 3 || name[length - 2] != '_' || (name[length - 1] != 'l' && name[length - 1] != 'r'))
        return NULL;
    char *other = pool_print(pool, "%s", name);
    other[length - 1] = name[length - 1] == 'l' ? 'r' : 'l';
    return other;
}

static bool has(const Rewrite *rewrite, const char *group, const char *name)
{
    const Item *map = rewrite->file;
    if (group == differentials)
        map = doc_find(map, "powertrain");
    map = map && map->kind == ITEM_MAP ? doc_find(map, group) : NULL;
    return map && map->kind == ITEM_MAP && doc_find(map, name);
}

/* The new name of an entry. Every entry `*_l` has an image by then, so that the name on the other side exists. */
static const char *renamed(const Rewrite *rewrite, const char *group, const char *name)
{
    const Argument *argument = argument_find(rewrite->arguments, group, name);
    if (argument && argument->to)
        return argument->to;
    const char *other = name_mirrored(rewrite->pool, name);
    bool both = other && has(rewrite, group, strcmp(name, other) < 0 ? name : other);
    if (rewrite->mirror)
        return both ? other : name;
    return both || has(rewrite, group, name) ? pool_print(rewrite->pool, "%s%s", rewrite->prefix, name) : name;
}

/* True if a formula reads an output at text that follows the name. An output has components after a dot; a force
 * element has none and is a name by itself. */
static bool is_output(const Rewrite *rewrite, const char *name, const char *next)
{
    const Item *map = rewrite->file && rewrite->file->kind == ITEM_MAP ? doc_find(rewrite->file, "outputs") : NULL;
    const char *other = name_mirrored(rewrite->pool, name);
    if (!map || map->kind != ITEM_MAP)
        return false;
    const Item *entry = doc_find(map, name);
    if (!entry && other)
        entry = doc_find(map, other);
    const Item *type = entry && entry->kind == ITEM_MAP ? doc_find(entry, "type") : NULL;
    const char *const word = type && type->kind == ITEM_SCALAR ? type->text : "";
    const bool single = !strcmp(word, output_type_name[OUTPUT_FORCE]) ||
                        !strcmp(word, output_type_name[OUTPUT_DRIVE_FORCE]) ||
                        !strcmp(word, output_type_name[OUTPUT_SIGNAL]);
    return entry && single != (*next == '.');
}

/* A formula with its names replaced. */
static const char *formula_renamed(const Rewrite *rewrite, const char *s)
{
    Text text = {.pool = rewrite->pool};
    while (*s) {
        size_t length = 0;
        bool word = isalpha((unsigned char)*s);
        bool number = isdigit((unsigned char)*s) || *s == '.'; /* also skips text that belongs to a number or a name:
                                                                * 1e3, .rate */
        while (isalnum((unsigned char)s[length]) || s[length] == '_' || (number && s[length] == '.'))
            ++length;
        length += length == 0;
        const char *name = pool_print(rewrite->pool, "%.*s", (int)length, s), *other = name;
        for (int i = 0; word && i < GROUPS && other == name; ++i)
            if (groups[i].formulas && !(groups[i].section == &signal_section && is_formula_word(name)))
                other = renamed(rewrite, groups[i].name, name);
        if (word && other == name && !is_formula_word(name) && is_output(rewrite, name, s + length))
            other = renamed(rewrite, "outputs", name);
        text_add(&text, other, strlen(other));
        s += length;
    }
    return text.s;
}

/* A copy that may be changed; messages place it as the Rewrite says. */
static Item *copy(const Rewrite *rewrite, const Item *item)
{
    Item *other = pool_alloc(rewrite->pool, sizeof *other);
    *other = *item;
    if (rewrite->source)
        other->at.source = rewrite->source;
    return other;
}

static Item **copies(const Rewrite *rewrite, Item **item, int count)
{
    size_t size = sizeof *item * (size_t)count;
    return pool_grow(rewrite->pool, item, size, size);
}

/* `left` for `right` and the reverse; the reader refuses other words. */
static const char *side_mirrored(const char *word)
{
    const char *const *side = kind_words[KEY_SIDE];
    return !strcmp(word, side[0]) ? side[1] : !strcmp(word, side[1]) ? side[0] : word;
}

static Item *number_rewrite(const Rewrite *rewrite, const Rule *how, int component, Item *item)
{
    if (item->kind != ITEM_SCALAR)
        return item;
    Item *other = copy(rewrite, item);
    other->mirrored = item->mirrored != rewrite->mirror;
    other->negated = item->negated != (rewrite->mirror && (how->odd >> component & 1));
    if (how->place)
        other->shift += rewrite->shift[component];
    /* any component may be a formula */
    bool formula = how->words == WORDS_FORMULA || ((how->place || how->odd) && how->words != WORDS_PATH);
    if (formula && item->text[0])
        other->text = formula_renamed(rewrite, item->text);
    if (how->words == WORDS_SIDE && rewrite->mirror)
        other->text = side_mirrored(item->text);
    return other;
}

static Item *entries_rewrite(const Rewrite *rewrite, const Rule *how, Item *map);

/* A number, the diagonal of a matrix or its lower triangle: an element changes its sign where one of its row and column
 * does. */
static Item *triangle_rewrite(const Rewrite *rewrite, const Rule *how, Item *item)
{
    const Rule even = {.words = how->words};
    if (item->kind != ITEM_LIST || item->count > LONGEST)
        return number_rewrite(rewrite, &even, 0, item);
    Item *other = copy(rewrite, item);
    other->value = copies(rewrite, item->value, item->count);
    for (int i = 0; i < item->count; ++i) {
        Item *row = item->value[i];
        if (row->kind != ITEM_LIST || row->count > LONGEST) {
            other->value[i] = number_rewrite(rewrite, &even, i, row);
            continue;
        }
        const Rule of_row = {.odd = how->odd >> i & 1 ? ~how->odd : how->odd, .words = how->words};
        other->value[i] = copy(rewrite, row);
        other->value[i]->value = copies(rewrite, row->value, row->count);
        for (int j = 0; j < row->count; ++j)
            other->value[i]->value[j] = number_rewrite(rewrite, &of_row, j, row->value[j]);
    }
    return other;
}

/* pair: item is the list of two values, not one of them. */
static Item *value_rewrite(const Rewrite *rewrite, const Rule *how, bool pair, Item *item)
{
    if (how->triangle)
        return triangle_rewrite(rewrite, how, item);
    if (item->kind == ITEM_MAP && how->entries)
        return entries_rewrite(rewrite, how, item);
    if (item->kind == ITEM_MAP)
        return how->section ? map_rewrite(rewrite, how->section, item) : item;
    if (item->kind == ITEM_SCALAR && how->words == WORDS_NAME && !pair) {
        bool other = how->other && has(rewrite, how->other, item->text);
        return name_rewrite(rewrite, other ? how->other : how->group, item);
    }
    if (item->kind == ITEM_SCALAR)
        return number_rewrite(rewrite, how, 0, item);
    if (!how->series && item->count > (pair ? 2 : how->place ? 3 : LONGEST))
        return item;
    Item *other = copy(rewrite, item);
    other->value = copies(rewrite, item->value, item->count);
    for (int i = 0; i < item->count; ++i)
        other->value[i] = pair ? value_rewrite(rewrite, how, false, item->value[i])
                               : number_rewrite(rewrite, how, how->series ? 0 : i, item->value[i]);
    return other;
}

/* The kind of a key of a section; KEY_TEXT, which never changes, for an unknown key. */
static KeyKind kind_of(const Section *section, const Item *map, const char *name)
{
    KeyKind kind = KEY_TEXT;
    for (int k = 0; k < section->keys; ++k)
        if (!strcmp(section->key[k].name, name))
            kind = section->key[k].kind;
    if (kind != KEY_DUAL_AXIS)
        return kind;
    const Item *type = doc_find(map, "type");
    const char *word = type && type->kind == ITEM_SCALAR ? type->text : "";
    bool angle = !strcmp(word, coordinate_type_name[COORDINATE_ANGLE]) || !strcmp(word, joint_type_name[JOINT_GEAR]);
    return angle ? KEY_TURN : KEY_AXIS;
}

static Item *entries_rewrite(const Rewrite *rewrite, const Rule *how, Item *map)
{
    Item *other = copy(rewrite, map);
    other->value = copies(rewrite, map->value, map->count);
    other->key = copies(rewrite, map->key, map->count);
    for (int i = 0; i < map->count; ++i) {
        other->key[i] = how->group ? name_rewrite(rewrite, how->group, map->key[i]) : copy(rewrite, map->key[i]);
        if (map->value[i]->kind == ITEM_MAP)
            other->value[i] = map_rewrite(rewrite, how->section, map->value[i]);
        else if (how->section == &rule_section)
            other->value[i] = value_rewrite(rewrite, &rule[KEY_FORMULA], false, map->value[i]);
    }
    return other;
}

Item *map_rewrite(const Rewrite *rewrite, const Section *section, Item *map)
{
    Item *other = copy(rewrite, map);
    other->value = copies(rewrite, map->value, map->count);
    other->key = copies(rewrite, map->key, map->count);
    for (int i = 0; i < map->count; ++i) {
        const Rule *how = &rule[kind_of(section, map, map->key[i]->text)];
        other->key[i] = copy(rewrite, map->key[i]);
        other->value[i] = value_rewrite(rewrite, how, how->pair, map->value[i]);
    }
    return other;
}

Item *entry_rewrite(const Rewrite *rewrite, const char *group, Item *entry)
{
    const Section *section = groups[group_index(group)].section;
    if (!section)
        return value_rewrite(rewrite, &rule[KEY_POINT], false, entry);
    if (entry->kind == ITEM_SCALAR && section == &parameter_section)
        return value_rewrite(rewrite, &rule[KEY_MEASURE], false, entry);
    if (entry->kind == ITEM_SCALAR && section == &signal_section)
        return value_rewrite(rewrite, &rule[KEY_FORMULA], false, entry);
    return entry->kind == ITEM_MAP ? map_rewrite(rewrite, section, entry) : entry;
}

Item *name_rewrite(const Rewrite *rewrite, const char *group, Item *item)
{
    if (item->kind != ITEM_SCALAR)
        return item;
    Item *other = copy(rewrite, item);
    other->text = renamed(rewrite, group, item->text);
    const Argument *argument = argument_find(rewrite->arguments, group, item->text);
    if (argument && argument->to)
        other->at = argument->at; /* a name that is unknown was written there */
    return other;
}
