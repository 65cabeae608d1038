/* SPDX-License-Identifier: MIT
 * A file and the files that it includes, merged into one tree (FORMAT.md section 12). Every value keeps the place
 * where it was written. */
#include "base/file.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FORMAT_VERSION = 1, DEPTH = 16 /* nesting */, PARTS_MOST = 1000 /* files of one model */ };

enum { PART_FILE, PART_AT, PART_PREFIX, PART_WITH, PART_KEYS };

static const Key part_key[PART_KEYS] = {
    [PART_FILE] = {"file", KEY_TEXT, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [PART_AT] = {"at", KEY_VECTOR, ALL_FORMS, 0, BOUND_NONE, 0},
    [PART_PREFIX] = {"prefix", KEY_NAME, ALL_FORMS, 0, BOUND_NONE, 0},
    [PART_WITH] = {"with", KEY_ITEM, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const part_about[PART_KEYS] = {
    [PART_FILE] = "path, from the folder of the file that it stands in",
    [PART_AT] = "m, added to every point that is written in the file",
    [PART_PREFIX] = "goes in front of every name that the file defines",
    [PART_WITH] = "values of the arguments of the file, by their names",
};

const Section part_section = {part_key, PART_KEYS, NULL, 0, NULL, NULL, part_about};

/* The amount read so far: files that include one file twice double it with each level. */
typedef struct Taken {
    int parts;
    size_t bytes;
} Taken;

/* A file being read, and the one that includes it. */
typedef struct Open {
    const struct Open *from;
    Taken *taken;
    const char *path;
    const char *text; /* in place of the file, [size]; NULL: the file has it */
    size_t size;
    const Source *known;  /* an earlier reading of it; NULL: there is none */
    struct stat identity; /* the same file may have many paths */
    int depth;
} Open;

/* Checked first: a file of another version may have keys that this reader does not know. */
static void version_check(const Item *file)
{
    if (file->kind != ITEM_MAP)
        diag_fail(file->at, "begin with `gicgen: 1`; models/FORMAT.md describes the rest",
                  "a model is a map of keys and values");
    const Item *item = doc_find(file, "gicgen"), *scene = doc_find(file, "gicscene");
    if (!item && scene)
        diag_fail(scene->at, "name the model first, then the scene", "this is a scene, where a model is wanted");
    if (!item)
        diag_fail(file->at, "begin the file with `gicgen: 1`", "the model lacks the key 'gicgen'");
    double version = doc_number(item, "the format version");
    if (version > (int)FORMAT_VERSION)
        diag_fail(item->at, "get a newer gicgen, or write `gicgen: 1` and what models/FORMAT.md describes",
                  "format version %s is too new: this gicgen reads version %d", item->text, FORMAT_VERSION);
    if (version != (int)FORMAT_VERSION)
        diag_fail(item->at, "write `gicgen: 1`", "there is no format version %s", item->text);
}

static Item *map_new(Pool *pool, Place at)
{
    Item *map = pool_alloc(pool, sizeof *map);
    *map = (Item){.kind = ITEM_MAP, .at = at};
    return map;
}

static void add(Pool *pool, Item *map, Item *key, Item *value)
{
    int keys = map->count;
    if (keys == KEYS_MOST)
        diag_fail(key->at, "take some away", "with included files this is a map with more than %d keys", KEYS_MOST);
    *POOL_PUSH(pool, map->key, keys) = key;
    *POOL_PUSH(pool, map->value, map->count) = value;
}

/* The place for the value of a key, which is added if missing. `before`: the key that was there, NULL: none. */
static Item **value_of(Pool *pool, Item *map, Item *key, const Item **before)
{
    for (int i = 0; i < map->count; ++i)
        if (!strcmp(map->key[i]->text, key->text)) {
            *before = map->key[i];
            map->key[i] = key;
            return &map->value[i];
        }
    *before = NULL;
    add(pool, map, key, NULL);
    return &map->value[map->count - 1];
}

static bool is_named_group(const Item *key, const Item *value)
{
    return is_group(key->text) && value->kind == ITEM_MAP;
}

/* Put the keys and entries of a file over those of `out`, whose maps are copies. `part`: an included file, whose
 * entries may not have names that another one has; NULL: the including file, whose entries replace. */
static void put_over(Pool *pool, Item *out, const Item *file, const Item *part)
{
    for (int i = 0; i < file->count; ++i) {
        const Item *before;
        Item *key = file->key[i], *value = file->value[i], **place = value_of(pool, out, key, &before);
        if (before && is_group(key->text) && (*place)->kind != ITEM_MAP)
            continue; /* not a map of entries: the reader refuses it */
        if (!is_named_group(key, value)) {
            *place = value;
            continue;
        }
        Item *map = before ? *place : map_new(pool, value->at);
        *place = map;
        for (int k = 0; k < value->count; ++k) {
            const Item *name = value->key[k];
            Item **entry = value_of(pool, map, value->key[k], &before);
            if (before && part)
                diag_fail(part->at, "write `{file: ..., prefix: ...}` to give its entries other names",
                          "'%s' of %s comes from two included files: %s:%d and %s:%d", name->text, key->text,
                          before->at.source->path, before->at.line, name->at.source->path, name->at.line);
            *entry = value->value[k];
        }
    }
}

/* The part of an included file that the including one takes over: the moved and renamed maps, `base` and `gravity`, and
 * keys that are unknown. */
static const Item *part_placed(Pool *pool, const Item *file, const Arguments *arguments, const Value *value)
{
    static const char *const own[] = {"gicgen", "include", "model", "description", "arguments"};
    Rewrite rewrite = {.pool = pool, .file = file, .prefix = value[PART_PREFIX].item ? value[PART_PREFIX].text : ""};
    memcpy(rewrite.shift, value[PART_AT].number, sizeof rewrite.shift);
    rewrite.arguments = arguments;
    Item *out = map_new(pool, file->at);
    for (int i = 0; i < file->count; ++i) {
        Item *key = file->key[i], *from = file->value[i];
        bool kept = true;
        for (size_t k = 0; k < sizeof own / sizeof *own; ++k)
            kept = kept && strcmp(key->text, own[k]) != 0;
        if (!kept)
            continue;
        Item *to = from;
        if (!strcmp(key->text, "base"))
            to = name_rewrite(&rewrite, "bodies", from);
        else if (!strcmp(key->text, "powertrain") && from->kind == ITEM_MAP)
            to = map_rewrite(&rewrite, &powertrain_section, from);
        else if (is_named_group(key, from)) {
            to = map_new(pool, from->at);
            for (int k = 0; k < from->count; ++k) {
                const Argument *given = argument_find(arguments, key->text, from->key[k]->text);
                Item *entry = entry_rewrite(&rewrite, key->text, from->value[k]);
                if (given && given->value) /* it belongs to the including file */
                    entry = from->value[k];
                add(pool, to, name_rewrite(&rewrite, key->text, from->key[k]), entry);
            }
        }
        add(pool, out, key, to);
    }
    return out;
}

const char *path_check(Pool *pool, const Item *item, const char *file, const char *name, const char *use,
                       struct stat *identity)
{
    const char *slash = strrchr(file, '/'), *path = name;
    if (!name[0] || !strcmp(name, "-"))
        diag_fail(item->at, "name a file; paths start in the folder of this file", "'%s' is no file to %s", name, use);
    if (name[0] != '/' && slash)
        path = pool_print(pool, "%.*s%s", (int)(slash + 1 - file), file, name);
    if (stat(path, identity) || access(path, R_OK))
        diag_fail(item->at,
                  errno == EACCES ? file_remedy(errno) : "paths start in the folder of the file that they stand in",
                  "can't %s '%s': %s", use, path, strerror(errno));
    if (S_ISDIR(identity->st_mode))
        diag_fail(item->at, "name a file in it", "can't %s '%s': it is a folder", use, path);
    if (!S_ISREG(identity->st_mode)) /* reading a pipe may never begin, reading a device may never end */
        diag_fail(item->at, "name a file", "can't %s '%s': it is a device or a pipe", use, path);
    return path;
}

/* Refuse a path that can't be read, and a file that is being read already. */
static Open part_open(Pool *pool, const Item *item, const char *name, const Open *from)
{
    Open open = {.from = from, .taken = from->taken, .depth = from->depth + 1};
    open.path = path_check(pool, item, from->path, name, "include", &open.identity);
    Text chain = {.pool = pool};
    text_print(&chain, "%s", open.path);
    for (const Open *above = from; above; above = above->from) {
        const char *chained = pool_print(pool, "%s includes %s", above->path, chain.s);
        chain.size = 0;
        text_print(&chain, "%s", chained);
        if (above->identity.st_dev == open.identity.st_dev && above->identity.st_ino == open.identity.st_ino)
            diag_fail(item->at, "take one of the inclusions away", "the file would include itself: %s", chain.s);
    }
    if (open.depth > DEPTH)
        diag_fail(item->at, "include the files from one place", "files include files more than %d levels deep", DEPTH);
    if (++open.taken->parts > PARTS_MOST)
        diag_fail(item->at, "write some of them as one file", "the model includes files more than %d times",
                  PARTS_MOST);
    return open;
}

/* by: the item that names the file; NULL: the user does. */
static const Item *file_read_whole(Pool *pool, const Open *open, const Item *by);

/* One element of `include`: a path, or a map with the offset and the prefix too. */
static const Item *part_read(Pool *pool, const Item *item, const Open *from)
{
    Value value[PART_KEYS] = {{.text = NULL}};
    Reader reader = {.pool = pool, .model = &(Model){0}}; /* parameters are not known yet */
    const Item *file = item;
    if (item->kind == ITEM_MAP) {
        section_read(&reader, &part_section, 0, &(Entry){"include", "include", item->at, item}, value);
        file = value[PART_FILE].item;
    }
    if (item->kind == ITEM_LIST)
        diag_fail(item->at, "write file.veh or {file: file.veh, at: [x, y, z], prefix: front_}",
                  "include: a list in a list");
    if (value[PART_PREFIX].item)
        name_check(value[PART_PREFIX].text, "a prefix", value[PART_PREFIX].item->at);
    Open open = part_open(pool, file, doc_word(file, "include"), from);
    Arguments arguments;
    const Item *whole = file_read_whole(pool, &open, file);
    whole = arguments_bind(&reader, whole, value[PART_WITH].item, item->at, &arguments);
    return part_placed(pool, whole, &arguments, value);
}

static const Item *file_read_whole(Pool *pool, const Open *open, const Item *by)
{
    static const char *const key[] = {"gicgen", "bodies:", "joints:", "coordinates:", "forces:", "outputs:", NULL};
    const Item *file = by            ? doc_read_named(pool, open->path, by, key)
                       : open->known ? doc_read_again(pool, open->known)
                       : open->text  ? doc_read_text(pool, open->path, open->text, open->size)
                                     : doc_read(pool, open->path);
    open->taken->bytes += file->at.source->size;
    if (open->taken->bytes > TEXT_MOST)
        diag_fail((Place){file->at.source, 0, 0}, "include less",
                  "the model has more than %d MB with all files that it includes", TEXT_MOST >> 20);
    version_check(file);
    const Item *include = doc_find(file, "include");
    if (!include)
        return file;
    Item *out = map_new(pool, file->at);
    bool several = include->kind == ITEM_LIST;
    for (int i = 0; i < (several ? include->count : 1); ++i) {
        const Item *part = several ? include->value[i] : include;
        put_over(pool, out, part_read(pool, part, open), part);
    }
    put_over(pool, out, file, NULL);
    return out;
}

const Item *text_included(Pool *pool, const char *path, const char *text, size_t size)
{
    const Open open = {.path = path, .text = text, .size = size, .taken = &(Taken){0}};
    return file_read_whole(pool, &open, NULL);
}

const Item *known_included(Pool *pool, const Source *known)
{
    const Open open = {.path = known->path, .known = known, .taken = &(Taken){0}};
    return file_read_whole(pool, &open, NULL);
}

const Item *file_included(Pool *pool, const char *path)
{
    Open open = {.path = path, .taken = &(Taken){0}};
    if (strcmp(path, "-"))
        stat(path, &open.identity); /* if the path can't be read, doc_read reports it */
    const Item *file = file_read_whole(pool, &open, NULL), *asked = doc_find(file, "arguments");
    if (asked)
        diag_fail(asked->at, "include the file from another one",
                  "a file with arguments has no values for them by itself");
    return file;
}
