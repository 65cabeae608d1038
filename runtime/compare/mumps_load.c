/* SPDX-License-Identifier: MIT
 * Finds and loads the plug-in with MUMPS. */
#define _DEFAULT_SOURCE /* readlink */
#include "compare/mumps.h"

#include <dlfcn.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>

/* The folder of the running program; NULL: the system does not say. */
static const char *program_folder(Pool *pool)
{
    char path[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", path, sizeof path);
    if (length <= 0 || length >= (ssize_t)sizeof path)
        return NULL;
    path[length] = '\0';
    *strrchr(path, '/') = '\0';
    return pool_print(pool, "%s", path);
}

const MumpsPlugin *mumps_load(Pool *pool, const char **why)
{
    /* of a program in the build folder; of one in its folder of tests, and of an installed one */
    static const char *const beside[] = {"", "/.."};
    const char *folder = program_folder(pool);
    *why = "it was not there when this program was built";
    for (size_t i = 0; folder && i < sizeof beside / sizeof *beside; ++i) {
        const char *path = pool_print(pool, "%s%s/lib/gicgen/mumps.so", folder, beside[i]);
        if (access(path, F_OK))
            continue;
        /* it stays: a handler of signals is in it */
        void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        const MumpsPlugin *plugin = library ? dlsym(library, MUMPS_SYMBOL) : NULL;
        if (plugin)
            return plugin;
        *why = pool_print(pool, "%s", dlerror());
    }
    return NULL;
}
