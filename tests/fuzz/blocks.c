/* SPDX-License-Identifier: MIT
 * Memory of one reading, for the fuzzer: see blocks.h. Linked with --wrap for every function here. */
#include "blocks.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);
char *__wrap_strdup(const char *s);
char *__real_file_read(struct Pool *pool, const char *path, size_t most, size_t *size);
char *__wrap_file_read(struct Pool *pool, const char *path, size_t most, size_t *size);
void *__wrap_pool_alloc(struct Pool *pool, size_t size);
void *__wrap_pool_grow(struct Pool *pool, void *old, size_t old_size, size_t size);

/* What is alive: a hash table with open addressing. The wrapped functions have no argument for it. */
static struct {
    bool on;
    void **slot;
    size_t room, used; /* room: a power of 2; used: slots that are not NULL, TAKEN included */
} live;

static char taken; /* its address marks a slot that was given free */
#define TAKEN ((void *)&taken)

static size_t slot_of(const void *block)
{
    return ((uintptr_t)block >> 4) * 0x9e3779b97f4a7c15u >> 20;
}

static void put(void *block)
{
    size_t i = slot_of(block) & (live.room - 1);
    while (live.slot[i])
        i = (i + 1) & (live.room - 1);
    live.slot[i] = block;
    ++live.used;
}

static void grow(void)
{
    void **old = live.slot;
    const size_t room = live.room;
    live.room = room ? 2 * room : 1 << 12;
    live.slot = __real_calloc(live.room, sizeof *live.slot);
    if (!live.slot)
        abort();
    live.used = 0;
    for (size_t i = 0; i < room; ++i)
        if (old[i] && old[i] != TAKEN)
            put(old[i]);
    __real_free(old);
}

static void *keep(void *block)
{
    if (!live.on || !block)
        return block;
    if (2 * (live.used + 1) > live.room)
        grow();
    put(block);
    return block;
}

static void forget(const void *block)
{
    if (!live.on || !block)
        return;
    for (size_t i = slot_of(block) & (live.room - 1); live.slot[i]; i = (i + 1) & (live.room - 1))
        if (live.slot[i] == block) {
            live.slot[i] = TAKEN;
            return;
        }
}

void blocks_begin(void)
{
    if (!live.room)
        grow();
    live.on = true;
}

void blocks_end(void)
{
    live.on = false;
    for (size_t i = 0; i < live.room; ++i)
        if (live.slot[i]) {
            if (live.slot[i] != TAKEN)
                __real_free(live.slot[i]);
            live.slot[i] = NULL;
        }
    live.used = 0;
}

void *__wrap_malloc(size_t size)
{
    return keep(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return keep(__real_calloc(count, size));
}

void *__wrap_realloc(void *block, size_t size)
{
    forget(block);
    return keep(__real_realloc(block, size));
}

void __wrap_free(void *block)
{
    forget(block);
    __real_free(block);
}

char *__wrap_strdup(const char *s)
{
    const size_t size = strlen(s) + 1;
    char *copy = __wrap_malloc(size);
    return copy ? memcpy(copy, s, size) : NULL;
}

/* Each block by itself, so that the sanitizer sees its ends. */
void *__wrap_pool_alloc(struct Pool *pool, size_t size)
{
    (void)pool;
    void *block = __wrap_calloc(1, size);
    if (!block)
        abort();
    return block;
}

void *__wrap_pool_grow(struct Pool *pool, void *old, size_t old_size, size_t size)
{
    void *block = __wrap_pool_alloc(pool, size);
    return old_size ? memcpy(block, old, old_size) : block;
}

char *__wrap_file_read(struct Pool *pool, const char *path, size_t most, size_t *size)
{
    const char *bytes = __real_file_read(pool, path, most, size);
    return memcpy(__wrap_pool_alloc(pool, *size + 1), bytes, *size + 1);
}
