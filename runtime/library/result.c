/* SPDX-License-Identifier: MIT
 * Results of the library: named arrays whose rows and columns may have names and units. */
#include "base/pool.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "library/library_private.h"
#include "library/result_private.h"

void result_free(void *freed)
{
    const Result *result = freed;
    pool_free(result->pool);
}

/* Names or units of signals; NULL for none. */
static const char *const *texts(Pool *pool, const gic_signal *signal, int64_t count, bool units)
{
    if (!signal)
        return NULL;
    const char **text = pool_alloc(pool, ((size_t)count + 1) * sizeof *text);
    for (int64_t i = 0; i < count; ++i) {
        const char *found = units ? signal[i].unit : signal[i].name;
        text[i] = found ? found : "";
    }
    return text;
}

void result_add(Result *result, const char *name, int64_t rows, int columns, const double *data, const gic_signal *row,
                const gic_signal *column)
{
    Pool *pool = result->pool;
    static const double nothing;
    *POOL_PUSH(pool, result->array, result->count) = (gicl_array){.name = name,
                                                                  .rows = rows,
                                                                  .columns = columns,
                                                                  .data = data ? data : &nothing,
                                                                  .row_name = texts(pool, row, rows, false),
                                                                  .row_unit = texts(pool, row, rows, true),
                                                                  .column_name = texts(pool, column, columns, false),
                                                                  .column_unit = texts(pool, column, columns, true)};
}

int gicl_array_count(gicl_library *library, gicl_handle handle, int *count, gicl_messages *said)
{
    const Use use = use_begin(library, handle, THING_RESULT, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!count)
        return use_end(&use, call_wrong(said, NULL, "the place for the number must not be NULL"));
    *count = ((const Result *)use.thing)->count;
    return use_end(&use, GICL_OK);
}

int gicl_array_get(gicl_library *library, gicl_handle handle, int index, gicl_array *array, size_t size,
                   gicl_messages *said)
{
    const Use use = use_begin(library, handle, THING_RESULT, said);
    if (use.status != GICL_OK)
        return use.status;
    const Result *result = use.thing;
    if (!array || size != sizeof *array)
        return use_end(&use, call_wrong(said, "compile with the library's own gic.h", "an array has %zu bytes, not %zu",
                                        sizeof *array, array ? size : 0));
    if (index < 0 || index >= result->count)
        return use_end(&use, call_wrong(said, NULL, "there is no array %d among %d", index, result->count));
    *array = result->array[index];
    return use_end(&use, GICL_OK);
}
