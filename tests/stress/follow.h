/* SPDX-License-Identifier: MIT
 * Following poses through the coordinates in pieces so small that none can leap to another assembly mode. */
#ifndef FOLLOW_H
#define FOLLOW_H

#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"

#include "attack.h"

/* An engine's model with the instances that follow. */
typedef struct Follower {
    const gic_model *code;
    gic_head *slow, *trial; /* where it stands; one piece on */
    double little;          /* change of poses in a piece, as pose_difference has it */
    double *x, *next;       /* [coordinates], [poses] work space */
} Follower;

static inline Follower follower_new(Pool *pool, const Subject *subject, double little)
{
    const gic_model *code = subject->code;
    return (Follower){.code = code,
                      .slow = instance_new(pool, subject->engine),
                      .trial = instance_new(pool, subject->engine),
                      .little = little,
                      .x = pool_alloc(pool, sizeof(double) * (size_t)(code->coordinate_count + 1)),
                      .next = pool_alloc(pool, sizeof(double) * (size_t)(7 * code->body_count))};
}

/* Poses with the coordinates at x; base and all rates as they are. A status. */
static inline int place_at(const gic_model *code, gic_head *self, const double *x, double *pose)
{
    for (int c = 0; c < code->coordinate_count; ++c) {
        int rate;
        *coordinate_place(code, c, instance_array(self, code->state_offset), instance_array(self, code->input_offset),
                          &rate) = x[c];
    }
    return code->poses(self, pose);
}

/* Largest difference of two poses: metres, or components of Euler parameters whatever their sign. */
static inline double pose_difference(const gic_model *code, const double *a, const double *b)
{
    double largest = 0;
    for (int body = 0; body < 7 * code->body_count; body += 7) {
        double same = 0, opposite = 0;
        for (int i = 0; i < 3; ++i)
            largest = fmax(largest, fabs(a[body + i] - b[body + i]));
        for (int i = 3; i < 7; ++i) {
            same = fmax(same, fabs(a[body + i] - b[body + i]));
            opposite = fmax(opposite, fabs(a[body + i] + b[body + i]));
        }
        largest = fmax(largest, fmin(same, opposite));
    }
    return largest;
}

/* From x, where `slow` stands, straight to `end`; false where that is blocked. Leaves the poses there. */
static inline bool follow_straight(const Follower *follower, const double *from, const double *end, double *pose)
{
    const gic_model *code = follower->code;
    double share = 0, step = 1;
    if (place_at(code, follower->slow, from, pose) != GIC_OK)
        return false;
    while (share < 1) {
        const double to = fmin(share + step, 1);
        for (int c = 0; c < code->coordinate_count; ++c)
            follower->x[c] = to == 1 ? end[c] : from[c] + to * (end[c] - from[c]);
        memcpy(follower->trial, follower->slow, code->size);
        const int status = place_at(code, follower->trial, follower->x, follower->next);
        if (status == GIC_OK && pose_difference(code, pose, follower->next) < follower->little) {
            memcpy(follower->slow, follower->trial, code->size);
            memcpy(pose, follower->next, sizeof *pose * (size_t)(7 * code->body_count));
            share = to;
            step *= 2;
        } else if ((step /= 2) < 1e-6) {
            return false;
        }
    }
    return true;
}

#endif
