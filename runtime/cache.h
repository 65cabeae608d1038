/* SPDX-License-Identifier: MIT
 *
 * Compiled objects that are kept between runs, found again by a hash of everything that made them. An object is
 * complete or not there: it is written beside its place and renamed, and ends with a seal over its content, so that
 * neither a killed process nor a truncated or damaged file is ever taken for an object. Several processes may use one
 * folder. */
#ifndef CACHE_H
#define CACHE_H

#include "../generator/gicgen.h"

/* Bytes of all kept objects unless $GICGEN_CACHE_SIZE (MB) says otherwise; the least recently used ones go first. */
#define CACHE_MOST ((int64_t)64 << 20)

/* The folder: $GICGEN_CACHE, else gicgen in $XDG_CACHE_HOME or ~/.cache; made where it is missing. NULL where that
 * can't be done, or where $GICGEN_CACHE is set and empty: nothing is kept. */
const char *cache_folder(Pool *pool);
/* A key for the texts that determine an object; the list ends with NULL. */
const char *cache_key(Pool *pool, const char *const *text);
/* The path of a kept object, or NULL. */
const char *cache_find(Pool *pool, const char *folder, const char *key);
/* Keep a copy of the object at `path`, then drop what exceeds `most` bytes. False where it can't be written. */
bool cache_keep(Pool *pool, const char *folder, const char *key, const char *path, int64_t most);
/* The limit in bytes: see CACHE_MOST. */
int64_t cache_limit(void);

#endif
