/* SPDX-License-Identifier: MIT
 *
 * trail: what a run did, evaluation by evaluation, for the way back through it. */
#ifndef RUN_TRAIL_H
#define RUN_TRAIL_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* A right-hand side, or a state that was settled. */
typedef struct TrailEvent {
    double time, *number; /* number: state and inputs; of a state that was settled its Euler parameters after that */
    int32_t dependent;    /* Euler parameter: before a right-hand side, after settling */
    int64_t step;         /* in which it was */
    bool settled;
} TrailEvent;

typedef struct Trail Trail;

Trail *trail_new(Pool *pool);
/* A new trail in the same memory. */
void trail_begin(Trail *trail);
/* One more event with room for so many numbers, for the caller to fill; it stays where it is. */
TrailEvent *trail_add(Trail *trail, int numbers);
int trail_events(const Trail *trail);
const TrailEvent *trail_event(const Trail *trail, int i);

#endif
