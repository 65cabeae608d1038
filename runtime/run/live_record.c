/* SPDX-License-Identifier: MIT
 * Rows of a run that keeps the clock: steps put their numbers into a ring, and another thread writes them as text, so
 * that no step waits for a disk. */
#define _GNU_SOURCE /* uselocale */
#include "base/message.h"
#include "run/live.h"

#include <errno.h>
#include <locale.h>
#include <string.h>

enum {
    RING = 1 << 20,      /* numbers, at least */
    PAUSE = 5000 * 1000, /* ns between looks at an empty ring, or at a full one */
};

struct LiveRecord {
    Csv results, inputs; /* file NULL: not wanted */
    int columns;         /* of the results, after the time */
    int held;            /* inputs */
    double *ring;
    size_t size;
    /* numbers that were put in and taken out; each thread writes one of the two */
    _Atomic size_t head, tail;
    atomic_bool over;
    bool begun;
    pthread_t thread;
    locale_t numbers; /* of who called: those of C */
};

/* A row in the ring: its length, 0 or 1 for the table, its numbers. */
enum { ROW_HEAD = 2 };

static void pause_for_a_moment(void)
{
    nanosleep(&(struct timespec){.tv_nsec = PAUSE}, NULL);
}

/* ---- the thread ---------------------------------------------------------------------------------------------------
 */

static void write_row(LiveRecord *record, size_t at)
{
    const double *ring = record->ring;
    const int count = (int)ring[at % record->size];
    Csv *csv = ring[(at + 1) % record->size] != 0 ? &record->inputs : &record->results;
    for (int i = 0; i < count; ++i) {
        const double value = ring[(at + ROW_HEAD + (size_t)i) % record->size];
        if (i == 0 && csv == &record->results)
            csv_time(csv, value); /* as gicrun writes it */
        else
            csv_number(csv, value);
    }
    csv_end_row(csv);
    atomic_store_explicit(&record->tail, at + ROW_HEAD + (size_t)count, memory_order_release);
}

static void *write_rows(void *context)
{
    LiveRecord *record = context;
    uselocale(record->numbers);
    for (;;) {
        const bool over = atomic_load(&record->over); /* before the look: nothing is put in after it */
        const size_t tail = atomic_load_explicit(&record->tail, memory_order_relaxed);
        if (tail != atomic_load_explicit(&record->head, memory_order_acquire))
            write_row(record, tail);
        else if (over)
            return NULL;
        else
            pause_for_a_moment();
    }
}

/* ---- for steps ----------------------------------------------------------------------------------------------------
 */

/* Room for a row of `count` numbers; where writing is too slow for the run, that waits for it. */
static size_t row_begin(LiveRecord *record, int count, bool inputs)
{
    const size_t head = atomic_load_explicit(&record->head, memory_order_relaxed);
    while (head + ROW_HEAD + (size_t)count - atomic_load_explicit(&record->tail, memory_order_acquire) > record->size)
        pause_for_a_moment();
    record->ring[head % record->size] = count;
    record->ring[(head + 1) % record->size] = inputs;
    return head + ROW_HEAD;
}

static void put(LiveRecord *record, size_t *at, double value)
{
    record->ring[(*at)++ % record->size] = value;
}

static void row_end(LiveRecord *record, size_t at)
{
    atomic_store_explicit(&record->head, at, memory_order_release);
}

void live_record_results(LiveRecord *record, const double *value)
{
    if (!record->results.file)
        return;
    size_t at = row_begin(record, 1 + record->columns, false);
    for (int i = 0; i <= record->columns; ++i)
        put(record, &at, value[i]);
    row_end(record, at);
}

void live_record_inputs(LiveRecord *record, double time, HoldBy by, const double *value)
{
    if (!record->inputs.file)
        return;
    size_t at = row_begin(record, 2 + record->held, true);
    put(record, &at, time);
    put(record, &at, by);
    for (int i = 0; i < record->held; ++i)
        put(record, &at, value[i]);
    row_end(record, at);
}

/* ---- begin and end ------------------------------------------------------------------------------------------------
 */

LiveRecord *live_record_open(Pool *pool, const Model *model, const Scene *scene, const char *results,
                             const char *inputs)
{
    LiveRecord *record = pool_alloc(pool, sizeof *record);
    record->columns = scene->columns;
    record->held = scene->hold->inputs;
    const int longest = scene->columns > record->held ? scene->columns : record->held;
    record->size = (size_t)longest * 8 > RING ? (size_t)longest * 8 : RING;
    record->numbers = uselocale((locale_t)0);
    if (results) {
        record->results = csv_open(pool, results);
        csv_name(&record->results, "time", "s");
        for (int i = 0; i < scene->columns; ++i)
            csv_name(&record->results, scene->signal[scene->column[i]].name, scene->signal[scene->column[i]].unit);
        csv_end_row(&record->results);
    }
    if (inputs) {
        record->inputs = csv_open(pool, inputs);
        csv_name(&record->inputs, "time", "s");
        hold_names(&record->inputs, scene->hold, model);
        csv_end_row(&record->inputs);
    }
    if (!results && !inputs)
        return record;
    record->ring = pool_alloc(pool, sizeof *record->ring * record->size);
    record->begun = live_thread(&record->thread, SCHED_OTHER, 0, write_rows, record);
    if (!record->begun)
        diag_fail(program_place(), "let it have more threads: `ulimit -u`", "no thread for the recording: %s",
                  strerror(errno));
    return record;
}

void live_record_close(LiveRecord *record)
{
    if (!record->begun)
        return;
    atomic_store(&record->over, true);
    pthread_join(record->thread, NULL);
    if (record->results.file)
        csv_close(&record->results);
    if (record->inputs.file)
        csv_close(&record->inputs);
}
