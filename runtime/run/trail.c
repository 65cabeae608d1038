/* SPDX-License-Identifier: MIT
 * Events and their numbers in chunks, so that nothing is copied as the trail grows. */
#include "run/trail.h"

#include <stddef.h>

const TrailStep trail_part = {
    .number = -1, .look = -1, .sample = -1, .late = -1, .later = -1, .guard = -1, .condition = -1};

enum { CHUNK_EVENTS = 1 << 10, CHUNK_NUMBERS = 1 << 16 };

struct Trail {
    Pool *pool;
    TrailEvent **event;
    double **number;
    int chunks, parts; /* of both */
    int events, part, used;
    TrailStep *step;
    int steps, step_room;
};

Trail *trail_new(Pool *pool)
{
    Trail *trail = pool_alloc(pool, sizeof *trail);
    trail->pool = pool;
    return trail;
}

void trail_begin(Trail *trail)
{
    trail->events = trail->part = trail->used = trail->steps = 0;
}

TrailMark trail_mark(const Trail *trail)
{
    return (TrailMark){trail->events, trail->part, trail->used, trail->steps};
}

void trail_rewind(Trail *trail, const TrailMark *mark)
{
    trail->events = mark->events;
    trail->part = mark->part;
    trail->used = mark->used;
    trail->steps = (int)mark->steps;
}

static double *numbers(Trail *trail, int count)
{
    if (trail->used + count > CHUNK_NUMBERS) {
        ++trail->part;
        trail->used = 0;
    }
    if (trail->part == trail->parts) {
        const size_t room = (size_t)(count > CHUNK_NUMBERS ? count : CHUNK_NUMBERS);
        *POOL_PUSH(trail->pool, trail->number, trail->parts) = pool_alloc(trail->pool, room * sizeof(double));
    }
    trail->used += count;
    return trail->number[trail->part] + trail->used - count;
}

TrailEvent *trail_add(Trail *trail, int count)
{
    if (trail->events == trail->chunks * CHUNK_EVENTS)
        *POOL_PUSH(trail->pool, trail->event, trail->chunks) =
            pool_alloc(trail->pool, CHUNK_EVENTS * sizeof **trail->event);
    TrailEvent *event = &trail->event[trail->events / CHUNK_EVENTS][trail->events % CHUNK_EVENTS];
    event->number = numbers(trail, count);
    ++trail->events;
    return event;
}

int trail_events(const Trail *trail)
{
    return trail->events;
}

const TrailEvent *trail_event(const Trail *trail, int i)
{
    return &trail->event[i / CHUNK_EVENTS][i % CHUNK_EVENTS];
}

TrailStep *trail_add_step(Trail *trail)
{
    if (trail->steps == trail->step_room)
        (void)POOL_PUSH(trail->pool, trail->step, trail->step_room);
    return &trail->step[trail->steps++];
}

int64_t trail_steps(const Trail *trail)
{
    return trail->steps;
}

TrailStep *trail_last(const Trail *trail)
{
    return &trail->step[trail->steps - 1];
}

const TrailStep *trail_step(const Trail *trail, int64_t i)
{
    return &trail->step[i];
}
