/* SPDX-License-Identifier: MIT
 * A model again with other numbers in its file: of parameters, and of coordinates of named points. They are put in
 * before mirror images are made, so that a hard point takes its image along. */
#include "base/yaml.h"
#include "read/read.h"
#include "read/reader.h"

#include <string.h>

static Item *copy(Pool *pool, const Item *item)
{
    Item *out = pool_alloc(pool, sizeof *out);
    *out = *item;
    if (item->kind != ITEM_SCALAR) {
        out->value = pool_alloc(pool, ((size_t)item->count + 1) * sizeof *out->value);
        memcpy(out->value, item->value, (size_t)item->count * sizeof *out->value);
    }
    return out;
}

/* The place of the value of a key in a map; NULL: it has no such key. */
static Item **place_of(const Item *map, const char *key)
{
    for (int i = 0; map && map->kind == ITEM_MAP && i < map->count; ++i)
        if (!strcmp(map->key[i]->text, key))
            return &map->value[i];
    return NULL;
}

/* The map of a section, copied so that its values may be replaced; NULL: the file has none. */
static Item *open_section(Pool *pool, Item *file, const char *section)
{
    Item **place = place_of(file, section);
    return place ? *place = copy(pool, *place) : NULL;
}

static Item *number(Pool *pool, Place at, double value)
{
    Item *item = pool_alloc(pool, sizeof *item);
    *item = (Item){.kind = ITEM_SCALAR, .at = at, .text = pool_print(pool, "%.17g", value)};
    return item;
}

static bool set_parameter(Pool *pool, Item *file, const FileNumber *setting)
{
    Item **place = place_of(open_section(pool, file, "parameters"), setting->name);
    if (!place)
        return false;
    if ((*place)->kind == ITEM_MAP) {
        *place = copy(pool, *place);
        place = place_of(*place, "value");
    }
    if (place)
        *place = number(pool, (*place)->at, setting->value);
    return place;
}

/* POINT.x, POINT.y, POINT.z */
static bool set_point(Pool *pool, Item *file, const FileNumber *setting)
{
    const char *dot = strrchr(setting->name, '.');
    const char *axis = dot && dot[1] && !dot[2] ? strchr("xyz", dot[1]) : NULL;
    if (!axis)
        return false;
    const int along = (int)strlen("xyz") - (int)strlen(axis);
    const char *point = pool_print(pool, "%.*s", (int)(dot - setting->name), setting->name);
    Item **place = place_of(open_section(pool, file, "points"), point);
    if (!place || (*place)->kind != ITEM_LIST || (*place)->count != 3)
        return false;
    *place = copy(pool, *place);
    (*place)->value[along] = number(pool, (*place)->at, setting->value);
    return true;
}

static _Noreturn void refuse(Pool *pool, const Item *file, const FileNumber *setting)
{
    const Item *const section[] = {doc_find(file, "parameters"), doc_find(file, "points")};
    int names = 0;
    for (int s = 0; s < 2; ++s)
        names += section[s] && section[s]->kind == ITEM_MAP ? (s ? 3 : 1) * section[s]->count : 0;
    const char **name = pool_alloc(pool, ((size_t)names + 1) * sizeof *name);
    int count = 0;
    for (int s = 0; s < 2; ++s)
        for (int i = 0; section[s] && section[s]->kind == ITEM_MAP && i < section[s]->count; ++i)
            for (int k = 0; k < (s ? 3 : 1); ++k)
                name[count++] =
                    s ? pool_print(pool, "%s.%c", section[s]->key[i]->text, "xyz"[k]) : section[s]->key[i]->text;
    const char *nearest = diag_nearest(setting->name, name, count);
    diag_fail((Place){file->at.source, 0, 0},
              nearest ? pool_print(pool, "did you mean '%s'?", nearest)
                      : "name one of its `parameters`, or POINT.x, .y or .z of its `points`; a mirror image follows "
                        "the point that it is made of",
              "the model's file has no parameter and no coordinate of a point '%s'", setting->name);
}

bool setting_known(Pool *pool, const Item *file, const char *name)
{
    Item *own = copy(pool, file);
    const FileNumber setting = {name, 0};
    return set_parameter(pool, own, &setting) || set_point(pool, own, &setting);
}

const Item *settings_put(Pool *pool, const Item *file, const FileNumber *setting, int count)
{
    Item *own = copy(pool, file);
    for (int i = 0; i < count; ++i)
        if (!set_parameter(pool, own, &setting[i]) && !set_point(pool, own, &setting[i]))
            refuse(pool, file, &setting[i]);
    return own;
}

const Item *parameters_put(Pool *pool, const Item *file, const Model *model, const double *value)
{
    Item *own = copy(pool, file_mirrored(pool, file));
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *parameter = &model->parameter[i];
        if (parameter->tunable)
            set_parameter(pool, own, &(FileNumber){parameter->name, value[parameter->index]});
    }
    return own;
}
