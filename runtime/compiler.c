/* SPDX-License-Identifier: MIT
 * The user's C compiler: its command, word by word, and what decides what it makes. */
#include "gicrun.h"

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

const char **compiler_words(Pool *pool, const char *compiler, const char *flags, int *count)
{
    const char **words = NULL;
    *count = 0;
    add_words(pool, &words, count, compiler);
    add_words(pool, &words, count, build_flags);
    add_words(pool, &words, count, flags);
    return words;
}

/* The file that a word names: a program on PATH, or what stands alone or behind @ or =. NULL: none. */
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

const char *compiler_identity(Pool *pool, const char *const *words, int count)
{
    /* where GCC and clang look for headers, libraries and their own parts */
    static const char *const variables[] = {"CPATH", "C_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH",
                                            "GCC_EXEC_PREFIX"};
    Text out = {.pool = pool};
    struct stat is;
    for (int i = 0; i < count; ++i) {
        const char *file = named_file(pool, words[i], &is);
        if (file)
            text_print(&out, "%s %lld %lld %lld.%09ld\n", file, (long long)is.st_ino, (long long)is.st_size,
                       (long long)is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
    }
    for (size_t i = 0; i < sizeof variables / sizeof *variables; ++i) {
        const char *value = getenv(variables[i]);
        if (value)
            text_print(&out, "%s=%s\n", variables[i], value);
    }
    add_processor(&out);
    text_add(&out, "", 0);
    return out.s;
}
