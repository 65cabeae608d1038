/* SPDX-License-Identifier: MIT
 * Input files and those that they name. */
#include "base/file.h"
#include "base/message.h"

#include <string.h>
#include <sys/stat.h>

struct Named {
    int count;
    const Source **source;
};

/* The earlier reading of a file that `by` names; NULL: there is none. */
static const Source *find_known(const Source *by, const char *path)
{
    const struct Named *named = by && by->known ? by->known->named : NULL;
    for (int i = 0; named && i < named->count; ++i)
        if (!strcmp(named->source[i]->path, path))
            return named->source[i];
    return NULL;
}

Source *source_again(Pool *pool, const Source *known)
{
    Source *source = pool_alloc(pool, sizeof *source);
    *source = (Source){.path = known->path, .bytes = known->bytes, .size = known->size, .known = known};
    source->named = pool_alloc(pool, sizeof *source->named);
    return source;
}

Source *source_read(Pool *pool, const char *path, size_t most, const Source *by)
{
    const Source *known = find_known(by, path);
    Source *source = known ? source_again(pool, known) : pool_alloc(pool, sizeof *source);
    if (!known) {
        source->path = path;
        source->bytes = file_read(pool, path, most, &source->size);
        source->named = pool_alloc(pool, sizeof *source->named);
    }
    if (by && by->named)
        *POOL_PUSH(pool, by->named->source, by->named->count) = source;
    return source;
}

Source *source_text(Pool *pool, const char *path, const char *text, size_t size)
{
    Source *source = pool_alloc(pool, sizeof *source);
    if (size > TEXT_MOST)
        diag_fail((Place){&(Source){.path = path}, 0, 0}, "is it the text that was meant?",
                  "larger than the %d MB that are read of such a text", TEXT_MOST >> 20);
    *source = (Source){.path = path, .bytes = text, .size = size};
    source->named = pool_alloc(pool, sizeof *source->named);
    return source;
}

/* True if `path` names the same file as `source`. */
static bool is_same(const Source *source, const struct stat *is)
{
    struct stat own;
    return strcmp(source->path, "-") != 0 && !stat(source->path, &own) && own.st_dev == is->st_dev &&
           own.st_ino == is->st_ino;
}

static const Source *find_same(const Source *source, const struct stat *is)
{
    if (is_same(source, is))
        return source;
    for (int i = 0; source->named && i < source->named->count; ++i) {
        const Source *found = find_same(source->named->source[i], is);
        if (found)
            return found;
    }
    return NULL;
}

void source_keep(const Source *source, const char *output)
{
    struct stat is;
    if (!strcmp(output, "-") || stat(output, &is) || !S_ISREG(is.st_mode))
        return;
    const Source *found = find_same(source, &is);
    if (found)
        diag_fail((Place){found, 0, 0}, "name another file to write",
                  "this input would be overwritten by the output %s", output);
}

uint64_t source_hash(const Source *source)
{
    uint64_t hash = text_hash(source->bytes, source->size);
    for (int i = 0; source->named && i < source->named->count; ++i)
        hash = hash * 0x100000001b3u + source_hash(source->named->source[i]);
    return hash;
}
