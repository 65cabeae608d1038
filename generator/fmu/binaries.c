/* SPDX-License-Identifier: MIT
 * Shared libraries for the platforms that there are compilers for. */
#include "base/file.h"
#include "engine/engine.h"
#include "fmu/fmu_private.h"
#include "host/host.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* name: of the platform in FMI 2.0 and 3.0; compiler NULL: that of this machine. */
typedef struct Platform {
    const char *name[2], *compiler, *flags, *ending;
} Platform;

#if defined __x86_64__
#define HERE_2 "linux64"
#define HERE_3 "x86_64-linux"
#elif defined __aarch64__
#define HERE_2 "aarch64-linux"
#define HERE_3 "aarch64-linux"
#elif defined __i386__
#define HERE_2 "linux32"
#define HERE_3 "x86-linux"
#else
#define HERE_2 "linux"
#define HERE_3 "linux"
#endif

/* Stripped and without an identity of its own, so that the same source gives the same bytes. */
static const Platform platform[] = {
    {{HERE_2, HERE_3}, NULL, "-Wl,--build-id=none", "so"},
#ifndef __aarch64__
    {{"aarch64-linux", "aarch64-linux"}, "aarch64-linux-gnu-gcc", "-Wl,--build-id=none", "so"},
#endif
    {{"win64", "x86_64-windows"},
     "x86_64-w64-mingw32-gcc",
     "-static-libgcc -Wl,--no-insert-timestamp,--disable-auto-image-base",
     "dll"},
};

enum { PLATFORMS = sizeof platform / sizeof *platform };

static bool is_source(const Member *member, const char *ending)
{
    return !strncmp(member->name, "sources/", 8) && path_ends(member->name, ending);
}

static bool put(const char *path, const Member *member)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return false;
    const bool written = fwrite(member->bytes, 1, member->size, file) == member->size;
    return !fclose(file) && written;
}

static const char *source_path(Pool *pool, const char *folder, const Member *member)
{
    return pool_print(pool, "%s/%s", folder, member->name + 8);
}

/* The exit status of the compiler, and what it made. */
static int compile(Pool *pool, const Members *members, const Platform *p, const char *folder, const char *output,
                   const char **said)
{
    int count;
    const char **word = compiler_words(pool, p->compiler ? p->compiler : compiler_default(), build_flags,
                                       pool_print(pool, "-fvisibility=hidden -s %s -o", p->flags), &count);
    *POOL_PUSH(pool, word, count) = output;
    for (int i = 0; i < members->count; ++i)
        if (is_source(&members->member[i], ".c"))
            *POOL_PUSH(pool, word, count) = source_path(pool, folder, &members->member[i]);
    *POOL_PUSH(pool, word, count) = "-lm";
    *POOL_PUSH(pool, word, count) = NULL;
    return process_run(pool, (char *const *)word, "", said);
}

const char *binaries_add(Members *members, int version, const char *model, const char *folder, const char *path)
{
    Pool *pool = members->pool;
    const int sources = members->count;
    Text there = {.pool = pool}, missing = {.pool = pool};
    const char *failure = NULL;
    bool stopped = false; /* by a signal, which ends the program once it is released */
    for (int i = 0; i < sources; ++i)
        if (is_source(&members->member[i], ".c") || is_source(&members->member[i], ".h"))
            if (!put(source_path(pool, folder, &members->member[i]), &members->member[i]))
                failure = pool_print(pool, "no room for sources in %s", folder);
    for (int i = 0; i < PLATFORMS && !failure && !stopped; ++i) {
        const Platform *p = &platform[i];
        const char *name = p->name[version == 3], *said = "";
        const char *output = pool_print(pool, "%s/%s.%s", folder, model, p->ending);
        const Members all = {pool, sources, members->member};
        const int status = compile(pool, &all, p, folder, output, &said);
        stopped = status == PROCESS_INTERRUPTED || interrupt_arrived();
        if (status == 0) {
            size_t size;
            const char *bytes = file_read(pool, output, TABLE_MOST, &size);
            member_add(members, pool_print(pool, "binaries/%s/%s.%s", name, model, p->ending), bytes, size);
            text_print(&there, "%s %s", there.size ? "," : "", name);
        } else if (status != PROCESS_NOT_STARTED && !p->compiler) {
            failure = pool_print(pool, "the C compiler `%s` failed: %s", compiler_default(), said);
        } else {
            text_print(&missing, "%s %s (%s %s)", missing.size ? "," : "", name,
                       p->compiler ? p->compiler : compiler_default(),
                       status == PROCESS_NOT_STARTED ? "is not there" : "failed");
        }
        unlink(output);
    }
    for (int i = 0; i < sources; ++i)
        if (is_source(&members->member[i], ".c") || is_source(&members->member[i], ".h"))
            unlink(source_path(pool, folder, &members->member[i]));
    if (!failure && !stopped)
        fprintf(stderr, "%s: FMI %d.0, binaries for%s%s%s\n", path, version, there.size ? there.s : " no platform",
                missing.size ? "; none for" : "", missing.size ? missing.s : "");
    return failure;
}
