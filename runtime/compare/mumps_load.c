/* SPDX-License-Identifier: MIT
 * The plug-in with MUMPS. */
#include "compare/mumps.h"
#include "host/host.h"

const MumpsPlugin *mumps_load(Pool *pool, const char **why)
{
    return plugin_load(pool, "mumps.so", MUMPS_SYMBOL, why);
}
