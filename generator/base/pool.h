/* SPDX-License-Identifier: MIT
 *
 * Memory comes from a Pool that lives as long as the program's main context: nothing is freed one by one. A pool made
 * in a call that fails is freed with it: catch.h. */
#ifndef BASE_POOL_H
#define BASE_POOL_H

#include <stdarg.h>
#include <stddef.h>

typedef struct Pool Pool;

Pool *pool_new(void);                      /* an empty pool; exits with a message when memory is out */
void pool_free(Pool *pool);                /* frees the pool and all that came from it */
void *pool_alloc(Pool *pool, size_t size); /* zeroed, aligned for any type */
void *pool_grow(Pool *pool, void *old, size_t old_size, size_t size); /* copy into a larger block */
char *pool_print(Pool *pool, const char *format, ...) __attribute__((format(printf, 2, 3)));
char *pool_vprint(Pool *pool, const char *format, va_list args);

/* Say that memory is out and exit with status 1, or end what catches that; every allocation of a Pool ends here if it
 * fails. */
_Noreturn void out_of_memory(void);

/* Make room for one more element after the first `count` of `array`; the capacity doubles. */
#define POOL_PUSH(pool, array, count) \
    ((((count) & (-1 + (count))) == 0 \
          ? (void)((array) = pool_grow((pool), (array), (size_t)(count) * sizeof *(array), \
                                       (size_t)((count) ? 2 * (count) : 1) * sizeof *(array))) \
          : (void)0), \
     &(array)[(count)++])

#endif
