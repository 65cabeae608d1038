/* SPDX-License-Identifier: MIT
 * Finds and loads plug-ins: shared objects with what few need and what brings libraries of its own. */
#define _GNU_SOURCE /* readlink, dladdr */
#include "base/text.h"
#include "host/host.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The folder of the shared library that we are in, else that of the running program; NULL: the system does not say. */
static const char *own_folder(Pool *pool)
{
    static const char here = 0;
    char path[PATH_MAX];
    Dl_info is;
    if (dladdr(&here, &is) && is.dli_fname && strstr(is.dli_fname, ".so")) {
        char *of_library = realpath(is.dli_fname, path);
        if (of_library) {
            *strrchr(path, '/') = '\0';
            return pool_print(pool, "%s", path);
        }
    }
    const ssize_t length = readlink("/proc/self/exe", path, sizeof path);
    if (length <= 0 || length >= (ssize_t)sizeof path)
        return NULL;
    path[length] = '\0';
    *strrchr(path, '/') = '\0';
    return pool_print(pool, "%s", path);
}

const void *plugin_load(Pool *pool, const char *name, const char *symbol, const char **why)
{
    /* of a program or a library in the build folder; of a program in its folder of tests, and of an installed one; of
     * an installed library */
    static const char *const beside[] = {"/lib/gicgen", "/../lib/gicgen", "/gicgen"};
    const char *folder = own_folder(pool);
    *why = "it was not there when this program was built";
    for (size_t i = 0; folder && i < sizeof beside / sizeof *beside; ++i) {
        const char *path = pool_print(pool, "%s%s/%s", folder, beside[i], name);
        if (access(path, F_OK))
            continue;
        /* it stays: handlers of the libraries that it brings are in it */
        void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        const void *plugin = library ? dlsym(library, symbol) : NULL;
        if (plugin)
            return plugin;
        *why = pool_print(pool, "%s", dlerror());
    }
    return NULL;
}
