/* SPDX-License-Identifier: MIT
 * Memory pools. */
#include "base/pool.h"
#include "base/catch.h"
#include "base/message.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1 << 16, ALIGN = 16 };

typedef struct Chunk {
    struct Chunk *next;
    size_t used, room;
} Chunk;

struct Pool {
    Chunk *chunk;
};

_Noreturn void out_of_memory(void)
{
    diag_fail((Place){NULL, 0, 0}, NULL, "out of memory");
}

static void release(void *pool)
{
    pool_free(pool);
}

Pool *pool_new(void)
{
    Pool *pool = calloc(1, sizeof *pool);
    if (!pool)
        out_of_memory();
    caught_own(release, pool);
    return pool;
}

void pool_free(Pool *pool)
{
    caught_disown(pool);
    for (Chunk *chunk = pool->chunk; chunk;) {
        Chunk *next = chunk->next;
        free(chunk);
        chunk = next;
    }
    free(pool);
}

void *pool_alloc(Pool *pool, size_t size)
{
    const size_t head = (sizeof(Chunk) + ALIGN - 1) / ALIGN * ALIGN;
    if (size > SIZE_MAX / 2)
        out_of_memory();
    size = (size + ALIGN - 1) / ALIGN * ALIGN;
    Chunk *chunk = pool->chunk;
    if (!chunk || chunk->room - chunk->used < size) {
        size_t room = size > CHUNK ? size : CHUNK;
        chunk = calloc(1, head + room);
        if (!chunk)
            out_of_memory();
        chunk->room = room;
        /* a large block gets a chunk of its own, put after the current chunk in the list, whose free part stays usable
         */
        if (size > CHUNK && pool->chunk) {
            chunk->next = pool->chunk->next;
            pool->chunk->next = chunk;
        } else {
            chunk->next = pool->chunk;
            pool->chunk = chunk;
        }
    }
    void *block = (char *)chunk + head + chunk->used;
    chunk->used += size;
    return block;
}

void *pool_grow(Pool *pool, void *old, size_t old_size, size_t size)
{
    void *block = pool_alloc(pool, size);
    if (old_size)
        memcpy(block, old, old_size);
    return block;
}

char *pool_vprint(Pool *pool, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    int size = vsnprintf(NULL, 0, format, args);
    char *s = pool_alloc(pool, (size_t)size + 1);
    vsnprintf(s, (size_t)size + 1, format, again);
    va_end(again);
    return s;
}

char *pool_print(Pool *pool, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *s = pool_vprint(pool, format, args);
    va_end(args);
    return s;
}
