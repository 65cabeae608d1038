/* SPDX-License-Identifier: MIT
 *
 * trail: what a run did, evaluation by evaluation, for the way back through it. */
#ifndef RUN_TRAIL_H
#define RUN_TRAIL_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* What was evaluated, and the numbers of it; or a state that was settled, with its Euler parameters after that. */
typedef enum TrailKind {
    TRAIL_RATE,    /* state, inputs */
    TRAIL_LINKS,   /* state, inputs */
    TRAIL_FAST,    /* fast states, links, inputs */
    TRAIL_SETTLED, /* Euler parameters */
    TRAIL_SAMPLE,  /* samples of controllers (tangent_sample.c): state that they see, what each rule does, inputs */
    TRAIL_DRIVE,   /* a look of the driver (tangent_drive.c): state, its derivatives, movements before it */
    TRAIL_SHIFT,   /* a change of gear (tangent_gear.h): state and inputs there, how the state moves on, guard */
} TrailKind;

typedef struct TrailEvent {
    double time, *number;
    int between;       /* numbers between state and inputs */
    int32_t dependent; /* Euler parameter: before a right-hand side, after settling */
    int32_t gear[2];   /* before a right-hand side: the present and the previous one */
    TrailKind kind;
} TrailEvent;

/* A step, or a part of one: which events are its own, then those of a change of gear, if one changes, and those of
 * knots. Parts of a piece (tangent_event.c) have its ends, and the clocks of these. */
typedef struct TrailStep {
    double start, length; /* s */
    bool dual;            /* fast states took steps of their own */
    int64_t number;       /* of the step of the run that begins here; -1: none, for it is a later part of one */
    int look, sample;     /* event before it: of the driver; the first of two of controllers; -1: none */
    int32_t history;      /* past rates with which it began */
    double share;         /* of the step, where a gear changes */
    int first, gear, knots, end;
    double piece_start, piece_end; /* s */
    int late, later;               /* clocks of the start and the end of the piece; -1: their times stay */
    int64_t piece;                 /* the first step of the trail in the piece */
    int guard, condition;          /* event and number of what decides on the piece's end; -1: its time stays */
    int happens, happened;         /* changes of inputs at its start: the first one and the one after the last */
} TrailStep;

/* The step that begins with nothing. */
extern const TrailStep trail_part;

typedef struct Trail Trail;

Trail *trail_new(Pool *pool);
/* A place in a trail, to which it can be taken back. */
typedef struct TrailMark {
    int events, part, used;
    int64_t steps;
} TrailMark;

TrailMark trail_mark(const Trail *trail);
void trail_rewind(Trail *trail, const TrailMark *mark);
/* A new trail in the same memory. */
void trail_begin(Trail *trail);
/* One more event with room for so many numbers, for the caller to fill; it stays where it is. */
TrailEvent *trail_add(Trail *trail, int numbers);
int trail_events(const Trail *trail);
/* One more step, which stays where it is up to the next one. */
TrailStep *trail_add_step(Trail *trail);
int64_t trail_steps(const Trail *trail);
TrailStep *trail_last(const Trail *trail);
const TrailStep *trail_step(const Trail *trail, int64_t i);
const TrailEvent *trail_event(const Trail *trail, int i);

#endif
