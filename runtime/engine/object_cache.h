/* SPDX-License-Identifier: MIT
 *
 * Compiled objects that are kept between runs, found again by a hash of everything that made them. An object is
 * complete or not there: it is written beside its place and renamed, and ends with a seal over its content, so that
 * neither a killed process nor a truncated or damaged file is ever taken for an object. Several processes may use one
 * folder. */
#ifndef ENGINE_OBJECT_CACHE_H
#define ENGINE_OBJECT_CACHE_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* Bytes of all kept objects unless $GICGEN_CACHE_SIZE (MB) says otherwise; the least recently used ones go first. */
#define CACHE_MOST ((int64_t)64 << 20)

/* The folder: $GICGEN_CACHE, else gicgen in $XDG_CACHE_HOME or ~/.cache; made where it is missing. NULL: nothing is
 * kept, *why says why not, or is NULL where that is wanted ($GICGEN_CACHE is set and empty). A folder that
 * is not this user's, or that his group or others may write, is refused: objects are code, and are run. */
const char *cache_folder(Pool *pool, const char **why);
/* A key for the texts that determine an object; the list ends with NULL. */
const char *cache_key(Pool *pool, const char *const *text);
/* The path of a kept object, or NULL. The seal tells damage, not forgery: an object that another user owns or may
 * write, or a link, is not used; like a damaged one it is removed. */
const char *cache_find(Pool *pool, const char *folder, const char *key);
/* Keep a copy of the object at `path`, then drop what exceeds `most` bytes. False, with errno, where that can't be. */
bool cache_keep(Pool *pool, const char *folder, const char *key, const char *path, int64_t most);
/* The limit in bytes: see CACHE_MOST. */
int64_t cache_limit(void);

#endif
