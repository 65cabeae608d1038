/* SPDX-License-Identifier: MIT
 * Mirror symmetry (FORMAT.md section 13): each entry `*_l` gets an image `*_r`, unless the file has that. */
#include "base/yaml.h"
#include "read/reader.h"

#include <string.h>

/* Add the image of the entry `name` if the model has none of its name. */
static void add_image(const Rewrite *rewrite, const char *group, const Item *map, int index, Item *out, int *keys)
{
    const char *name = map->key[index]->text, *other = name_mirrored(rewrite->pool, name);
    if (!other || strcmp(other, name) < 0 || doc_find(map, other))
        return;
    Rewrite here = *rewrite;
    Source *source = pool_alloc(here.pool, sizeof *source);
    *source = *map->key[index]->at.source;
    source->mirrored = name;
    here.source = source;
    *POOL_PUSH(here.pool, out->key, *keys) = name_rewrite(&here, group, map->key[index]);
    *POOL_PUSH(here.pool, out->value, out->count) = entry_rewrite(&here, group, map->value[index]);
}

static Item *map_mirrored(const Rewrite *rewrite, const char *group, const Item *map)
{
    Item *out = pool_alloc(rewrite->pool, sizeof *out);
    *out = (Item){.kind = ITEM_MAP, .at = map->at};
    int keys = 0;
    for (int i = 0; i < map->count; ++i) {
        *POOL_PUSH(rewrite->pool, out->key, keys) = map->key[i];
        *POOL_PUSH(rewrite->pool, out->value, out->count) = map->value[i];
        add_image(rewrite, group, map, i, out, &keys);
    }
    return out;
}

const Item *file_mirrored(Pool *pool, const Item *file)
{
    const Rewrite rewrite = {.pool = pool, .file = file, .mirror = true};
    Item *out = pool_alloc(pool, sizeof *out);
    *out = *file;
    size_t size = sizeof *file->value * (size_t)file->count;
    out->value = pool_grow(pool, file->value, size, size);
    for (int i = 0; i < file->count; ++i)
        if (is_group(file->key[i]->text) && file->value[i]->kind == ITEM_MAP)
            out->value[i] = map_mirrored(&rewrite, file->key[i]->text, file->value[i]);
    return out;
}
