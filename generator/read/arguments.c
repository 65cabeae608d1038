/* SPDX-License-Identifier: MIT
 * Arguments (FORMAT.md section 12): numbers, points and bodies that an included file asks of the one that includes it.
 * What is given as a name stands for that name; anything else becomes an entry of the included file. */
#include "base/text.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <string.h>

enum { ARGUMENT_TYPE, ARGUMENT_DEFAULT, ARGUMENT_KEYS };

static const Key argument_key[ARGUMENT_KEYS] = {
    [ARGUMENT_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ARGUMENT_DEFAULT] = {"default", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
};

enum { ARGUMENT_NUMBER, ARGUMENT_POINT, ARGUMENT_BODY, ARGUMENT_TYPES };

static const char *const argument_type[ARGUMENT_TYPES] = {"number", "point", "body"};
static const char *const argument_group[ARGUMENT_TYPES] = {"parameters", "points", "bodies"};
static const char *const argument_example[ARGUMENT_TYPES] = {"a number, or the name of a parameter",
                                                             "[x, y, z], or the name of a point", "the name of a body"};

static const char *const argument_about[ARGUMENT_KEYS] = {
    [ARGUMENT_TYPE] = "number, point or body",
    [ARGUMENT_DEFAULT] = "value where the including file gives none; default: it must give one",
};

const Section argument_section = {argument_key,  ARGUMENT_KEYS, argument_type, ARGUMENT_TYPES,
                                  argument_type, NULL,          argument_about};

const Argument *argument_find(const Arguments *arguments, const char *group, const char *name)
{
    for (int i = 0; arguments && i < arguments->count; ++i)
        if (!strcmp(arguments->argument[i].group, group) && !strcmp(arguments->argument[i].name, name))
            return &arguments->argument[i];
    return NULL;
}

/* `map` with an entry in front of the others. */
static Item *with_first(Pool *pool, const Item *map, Item *key, Item *value)
{
    Item *out = pool_alloc(pool, sizeof *out);
    int keys = 0;
    *out = (Item){.kind = ITEM_MAP, .at = map ? map->at : key->at};
    *POOL_PUSH(pool, out->key, keys) = key;
    *POOL_PUSH(pool, out->value, out->count) = value;
    for (int i = 0; map && i < map->count; ++i) {
        *POOL_PUSH(pool, out->key, keys) = map->key[i];
        *POOL_PUSH(pool, out->value, out->count) = map->value[i];
    }
    return out;
}

/* The file with an entry more in a group. */
static const Item *file_with(Pool *pool, const Item *file, const char *group, Item *key, Item *value)
{
    const size_t size = sizeof *file->value * (size_t)file->count;
    Item *out = pool_alloc(pool, sizeof *out);
    *out = *file;
    out->value = pool_grow(pool, file->value, size, size);
    for (int i = 0; i < file->count; ++i)
        if (!strcmp(file->key[i]->text, group)) {
            if (file->value[i]->kind == ITEM_MAP)
                out->value[i] = with_first(pool, file->value[i], key, value);
            return out;
        }
    Item *name = pool_alloc(pool, sizeof *name);
    *name = (Item){.kind = ITEM_SCALAR, .text = group, .at = key->at};
    return with_first(pool, file, name, with_first(pool, NULL, key, value));
}

/* The value of an argument: given, or the default. */
static const Item *value_of(Reader *reader, const Entry *entry, int type, const Item *with, Place at)
{
    const Item *given = with ? doc_find(with, entry->name) : NULL;
    if (entry->item->kind == ITEM_MAP) {
        Value value[ARGUMENT_KEYS];
        section_read(reader, &argument_section, type, entry, value);
        given = given ? given : value[ARGUMENT_DEFAULT].item;
    }
    if (!given)
        diag_fail(at, pool_print(reader->pool, "add `with: {%s: ...}`: %s", entry->name, argument_example[type]),
                  "the included file asks for '%s', a %s", entry->name, argument_type[type]);
    const bool name = given->kind == ITEM_SCALAR && !doc_is_decimal(given);
    if (!(type == ARGUMENT_NUMBER  ? given->kind == ITEM_SCALAR
          : type == ARGUMENT_POINT ? name || given->kind == ITEM_LIST
                                   : name))
        diag_fail(given->at, pool_print(reader->pool, "write %s", argument_example[type]),
                  "'%s' is a %s of the included file", entry->name, argument_type[type]);
    if (name)
        name_check(given->text, argument_example[type], given->at);
    return given;
}

static int type_of(Reader *reader, const Entry *entry)
{
    const Item *word = entry->item->kind == ITEM_MAP ? NULL : entry->item;
    if (!word)
        return section_type(reader, &argument_section, entry);
    for (int i = 0; i < ARGUMENT_TYPES; ++i)
        if (!strcmp(doc_word(word, entry->what), argument_type[i]))
            return i;
    diag_fail(word->at, "one of: number, point, body", "%s: there is no type '%s'", entry->what, word->text);
}

const Item *arguments_bind(Reader *reader, const Item *file, const Item *with, Place at, Arguments *arguments)
{
    Pool *pool = reader->pool;
    int count;
    const Item *asked = doc_find(file, "arguments");
    Entry *entry = section_entries(reader, asked, "argument", &count);
    if (with && with->kind != ITEM_MAP)
        diag_fail(with->at, "write `with: {name: value}`", "`with` must be a map of arguments");
    for (int i = 0; with && i < with->count; ++i)
        if (!asked || !doc_find(asked, with->key[i]->text)) {
            Text list = {.pool = pool};
            for (int k = 0; k < count; ++k)
                text_print(&list, "%s%s", k ? ", " : "it has: ", entry[k].name);
            diag_fail(with->key[i]->at, count ? list.s : "add `arguments: {name: number}` there",
                      "the included file has no argument '%s'", with->key[i]->text);
        }
    *arguments = (Arguments){.count = 0};
    for (int i = 0; i < count; ++i) {
        const int type = type_of(reader, entry + i);
        const Item *value = value_of(reader, entry + i, type, with, at);
        const bool name = value->kind == ITEM_SCALAR && !doc_is_decimal(value);
        const Item *map = doc_find(file, argument_group[type]);
        if (map && map->kind == ITEM_MAP && doc_find(map, entry[i].name))
            diag_fail(entry[i].at, "give one of them another name", "%s has the name of an entry of `%s`",
                      entry[i].what, argument_group[type]);
        *POOL_PUSH(pool, arguments->argument, arguments->count) =
            (Argument){.group = argument_group[type],
                       .name = entry[i].name,
                       .to = name ? value->text : NULL,
                       .at = value->at,
                       .value = with && doc_find(with, entry[i].name) ? value : NULL};
        Item *key = pool_alloc(pool, sizeof *key), *copy = pool_alloc(pool, sizeof *copy);
        *key = (Item){.kind = ITEM_SCALAR, .text = entry[i].name, .at = value->at};
        *copy = *value;
        if (!name)
            file = file_with(pool, file, argument_group[type], key, copy);
    }
    return file;
}
