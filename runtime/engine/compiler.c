/* SPDX-License-Identifier: MIT
 * The user's C compiler: its command, word by word, the folder that it works in, and what decides what it makes. */
#define _DEFAULT_SOURCE /* mkdtemp */
#include "base/file.h"
#include "base/text.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "host/host.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char build_flags[] = "-std=c99 -O2 -fPIC -shared -ffp-contract=off -fno-math-errno";

const char *compiler_default(void)
{
    const char *compiler = getenv("CC");
    return compiler && *compiler ? compiler : "cc";
}

static void add_words(Pool *pool, const char ***words, int *count, const char *text)
{
    char *rest;
    for (char *word = strtok_r(pool_print(pool, "%s", text), " \t", &rest); word; word = strtok_r(NULL, " \t", &rest))
        *POOL_PUSH(pool, *words, *count) = word;
}

const char **compiler_words(Pool *pool, const char *compiler, const char *ours, const char *flags, int *count)
{
    const char **words = NULL;
    *count = 0;
    add_words(pool, &words, count, compiler);
    add_words(pool, &words, count, ours);
    add_words(pool, &words, count, flags);
    return words;
}

char *folder_make(Pool *pool)
{
    return mkdtemp(pool_print(pool, "%s/gicrun-XXXXXX", temporary_folder()));
}

bool folder_put(Pool *pool, const char *folder, const char *name, const char *bytes, size_t size)
{
    FILE *file = fopen(pool_print(pool, "%s/%s", folder, name), "wb");
    if (!file)
        return false;
    bool written = fwrite(bytes, 1, size, file) == size;
    return !fclose(file) && written;
}

bool is_core(const Embedded *file)
{
    return !strncmp(file->name, "gic_", 4) && strcmp(file->name, "gic_road.c") != 0;
}

bool folder_put_core(Pool *pool, const char *folder)
{
    bool good = true;
    for (const Embedded *file = embedded; good && file->name; ++file)
        if (is_core(file))
            good = folder_put(pool, folder, file->name, file->bytes, file->size);
    return good;
}

void folder_remove(const char *folder)
{
    DIR *listing = opendir(folder);
    if (!listing)
        return;
    for (struct dirent *entry; (entry = readdir(listing));)
        if (entry->d_name[0] != '.')
            unlinkat(dirfd(listing), entry->d_name, 0);
    closedir(listing);
    rmdir(folder);
}

/* The file that a word names: a program on PATH, or a path that stands alone or follows @ or =. NULL: none. */
static const char *named_file(Pool *pool, const char *word, struct stat *is)
{
    const char *path = getenv("PATH"), *mark = strpbrk(word, "@=");
    if (!path)
        path = "/bin:/usr/bin";
    while (!strchr(word, '/') && *path) {
        const int length = (int)strcspn(path, ":");
        const char *file = pool_print(pool, "%.*s/%s", length, length ? path : ".", word);
        if (!access(file, X_OK) && !stat(file, is) && S_ISREG(is->st_mode))
            return file;
        path += length + (path[length] == ':');
    }
    const char *file = mark ? mark + 1 : word;
    return !stat(file, is) && S_ISREG(is->st_mode) ? file : NULL;
}

/* Lines of /proc/cpuinfo on what the first processor can do; its other lines vary from moment to moment. */
static void add_processor(Text *out)
{
    char line[4096];
    bool model = false, features = false;
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (!file)
        return;
    while (!(model && features) && fgets(line, sizeof line, file)) {
        const bool names = !strncmp(line, "model name", 10) || !strncmp(line, "CPU part", 8);
        const bool lists = !strncmp(line, "flags", 5) || !strncmp(line, "Features", 8);
        if ((names && !model) || (lists && !features))
            text_print(out, "%s", line);
        model |= names;
        features |= lists;
    }
    fclose(file);
}

/* Where GCC and clang look for headers, libraries and their own parts, and the processor. */
static void add_surroundings(Text *out)
{
    static const char *const variables[] = {"CPATH", "C_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH",
                                            "GCC_EXEC_PREFIX"};
    for (size_t i = 0; i < sizeof variables / sizeof *variables; ++i) {
        const char *value = getenv(variables[i]);
        if (value)
            text_print(out, "%s=%s\n", variables[i], value);
    }
    add_processor(out);
    text_add(out, "", 0);
}

const char *compiler_identity(Pool *pool, const char *const *words, int count)
{
    Text out = {.pool = pool};
    struct stat is;
    for (int i = 0; i < count; ++i) {
        const char *file = named_file(pool, words[i], &is);
        if (file)
            text_print(&out, "%s %lld %lld %lld.%09ld\n", file, (long long)is.st_ino, (long long)is.st_size,
                       (long long)is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
    }
    add_surroundings(&out);
    return out.s;
}

const char *compiler_contents(Pool *pool, const char *const *words, int count)
{
    Text out = {.pool = pool};
    struct stat is;
    for (int i = 0; i < count; ++i) {
        size_t size;
        const char *file = named_file(pool, words[i], &is);
        const char *bytes = file && !access(file, R_OK) ? file_read(pool, file, TABLE_MOST, &size) : NULL;
        if (bytes)
            text_print(&out, "%016llx\n", (unsigned long long)text_hash(bytes, size));
    }
    add_surroundings(&out);
    return out.s;
}
