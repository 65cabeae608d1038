/* SPDX-License-Identifier: MIT
 * Compiled objects that are kept between runs: see object_cache.h. */
#include "base/file.h"
#include "engine/object_cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- hashes -------------------------------------------------------------------------------------------------------
 */

/* Two FNV-1a hashes of 64 bits from different beginnings: chance never makes two contents equal. */
typedef struct Hash {
    uint64_t half[2];
} Hash;

static const Hash hash_start = {{UINT64_C(0xcbf29ce484222325), UINT64_C(0x6c62272e07bb0142)}};

static void hash_add(Hash *hash, const char *bytes, size_t size)
{
    for (size_t i = 0; i < size; ++i) {
        hash->half[0] = (hash->half[0] ^ (unsigned char)bytes[i]) * UINT64_C(0x100000001b3);
        hash->half[1] = (hash->half[1] ^ (unsigned char)(bytes[i] + 1)) * UINT64_C(0x100000001b3);
    }
}

const char *cache_key(Pool *pool, const char *const *text)
{
    Hash hash = hash_start;
    for (; *text; ++text)
        hash_add(&hash, *text, strlen(*text) + 1); /* with the terminating 0, so that "ab", "c" differs from "a", "bc"
                                                    */
    return pool_print(pool, "%016llx%016llx", (unsigned long long)hash.half[0], (unsigned long long)hash.half[1]);
}

/* Appended to the bytes of an object; loaders ignore it. */
typedef struct Seal {
    char word[8];
    uint64_t size;
    Hash hash;
} Seal;

static Seal seal_of(const char *bytes, size_t size)
{
    Seal seal = {.word = "gicseal", .size = size, .hash = hash_start};
    hash_add(&seal.hash, bytes, size);
    return seal;
}

/* ---- files --------------------------------------------------------------------------------------------------------
 */

/* True if only this user or root may have written it. */
static bool is_own(const struct stat *is)
{
    return is->st_uid == geteuid() && !(is->st_mode & (S_IWGRP | S_IWOTH));
}

/* All bytes of a file, or NULL. own: it must be one that is_own(), and no link. */
static char *read_bytes(Pool *pool, const char *path, bool own, size_t *size)
{
    struct stat is;
    const int handle = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | (own ? O_NOFOLLOW : 0));
    const bool good = handle >= 0 && !fstat(handle, &is) && S_ISREG(is.st_mode) && (!own || is_own(&is));
    FILE *file = good ? fdopen(handle, "rb") : NULL;
    if (!file) {
        if (handle >= 0)
            close(handle);
        return NULL;
    }
    Text text = {.pool = pool};
    char buffer[1 << 14];
    for (size_t n; (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
        text_add(&text, buffer, n);
    text_add(&text, "", 0); /* an empty file too has bytes */
    const bool bad = ferror(file);
    fclose(file);
    *size = text.size;
    return bad ? NULL : text.s;
}

static bool make_folders(Pool *pool, const char *path)
{
    char *part = pool_print(pool, "%s", path);
    for (char *c = part + 1;; ++c) {
        const char kept = *c;
        if (kept && kept != '/')
            continue;
        *c = 0;
        if (mkdir(part, 0700) && errno != EEXIST)
            return false;
        if (!(*c = kept))
            return true;
    }
}

static const char *folder_name(Pool *pool)
{
    const char *own = getenv("GICGEN_CACHE"), *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (own)
        return own;
    if (base && *base == '/')
        return pool_print(pool, "%s/gicgen", base);
    return home && *home == '/' ? pool_print(pool, "%s/.cache/gicgen", home) : NULL;
}

const char *cache_folder(Pool *pool, const char **why)
{
    struct stat is;
    const char *folder = folder_name(pool);
    *why = NULL;
    if (!folder)
        *why = "neither GICGEN_CACHE nor HOME names a folder";
    else if (*folder && (!make_folders(pool, folder) || stat(folder, &is)))
        *why = pool_print(pool, "can't make the folder %s: %s", folder, strerror(errno));
    else if (*folder && !is_own(&is))
        *why = pool_print(pool, "the folder %s belongs to somebody else, or others may write there", folder);
    return *why || !*folder ? NULL : folder;
}

int64_t cache_limit(void)
{
    const char *text = getenv("GICGEN_CACHE_SIZE");
    char *end = NULL;
    const long long size = text ? strtoll(text, &end, 10) : 0;
    return text && end != text && !*end && size >= 0 && size < 1 << 20 ? (int64_t)size << 20 : CACHE_MOST;
}

static const char *object_path(Pool *pool, const char *folder, const char *key)
{
    return pool_print(pool, "%s/%s.so", folder, key);
}

const char *cache_find(Pool *pool, const char *folder, const char *key)
{
    const char *path = object_path(pool, folder, key);
    size_t size;
    const char *bytes = read_bytes(pool, path, true, &size);
    Seal found;
    if (bytes && size > sizeof found) {
        memcpy(&found, bytes + size - sizeof found, sizeof found);
        const Seal right = seal_of(bytes, size - sizeof found);
        if (!memcmp(&found, &right, sizeof found)) {
            utimensat(AT_FDCWD, path, NULL, 0); /* mark as used; without permission it is removed a little earlier */
            return path;
        }
    }
    unlink(path);
    return NULL;
}

/* ---- the limit ----------------------------------------------------------------------------------------------------
 */

typedef struct Kept {
    const char *path;
    int64_t size;
    struct timespec used;
    bool unfinished;
} Kept;

static int older_first(const void *a, const void *b)
{
    const struct timespec *s = &((const Kept *)a)->used, *t = &((const Kept *)b)->used;
    if (s->tv_sec != t->tv_sec)
        return s->tv_sec < t->tv_sec ? -1 : 1;
    return (s->tv_nsec > t->tv_nsec) - (s->tv_nsec < t->tv_nsec);
}

/* Drop the least recently used objects beyond the limit, and what killed processes left an hour ago. */
static void trim(Pool *pool, const char *folder, int64_t most)
{
    DIR *listing = opendir(folder);
    if (!listing)
        return;
    Kept *kept = NULL;
    int count = 0;
    int64_t total = 0;
    for (struct dirent *entry; (entry = readdir(listing));) {
        struct stat is;
        Kept one = {.path = pool_print(pool, "%s/%s", folder, entry->d_name),
                    .unfinished = strstr(entry->d_name, ".so.") != NULL};
        if ((!one.unfinished && !path_ends(entry->d_name, ".so")) || stat(one.path, &is))
            continue;
        one.size = (int64_t)is.st_size;
        one.used = is.st_mtim;
        if (one.unfinished && time(NULL) - is.st_mtim.tv_sec > 3600)
            unlink(one.path);
        if (one.unfinished)
            continue;
        *POOL_PUSH(pool, kept, count) = one;
        total += one.size;
    }
    closedir(listing);
    if (count)
        qsort(kept, (size_t)count, sizeof *kept, older_first);
    for (int i = 0; i < count && total > most; ++i)
        if (!unlink(kept[i].path))
            total -= kept[i].size;
}

bool cache_keep(Pool *pool, const char *folder, const char *key, const char *path, int64_t most)
{
    size_t size;
    const char *bytes = read_bytes(pool, path, false, &size), *place = object_path(pool, folder, key);
    char *temporary = pool_print(pool, "%s.XXXXXX", place);
    if (!bytes)
        return false;
    const int handle = mkstemp(temporary);
    FILE *file = handle < 0 ? NULL : fdopen(handle, "wb");
    if (!file)
        return false;
    const Seal seal = seal_of(bytes, size);
    bool good = fwrite(bytes, 1, size, file) == size && fwrite(&seal, sizeof seal, 1, file) == 1;
    good = !fclose(file) && good && !rename(temporary, place);
    const int error = errno;
    if (!good)
        unlink(temporary);
    trim(pool, folder, most);
    errno = error;
    return good;
}
