/* SPDX-License-Identifier: MIT
 * Ranges over which numbers move in the run's steps and in small ones. Steps of implicit methods may damp what they do
 * not resolve; none may keep it moving. */
#include "run/step_replay.h"

#include <math.h>
#include <string.h>

enum {
    BEFORE = 30,  /* steps in which small ones come to rest, if they do */
    MEASURED = 20 /* steps after them, of which ranges are taken */
};

static const double resolved = 0.3;  /* angular frequency times step: implicit methods show it to a tenth */
static const double times = 3;       /* more is no error of a method that is stable: those are tenths */
static const double visible = 0.01;  /* relative to the longest way */
static const double rounding = 1e-6; /* relative to 1 and to the number */

static void widen(const double *state, int count, double (*range)[2])
{
    for (int i = 0; i < count; ++i) {
        range[i][0] = fmin(range[i][0], state[i]);
        range[i][1] = fmax(range[i][1], state[i]);
    }
}

/* From an instance's state by steps of a method, by which each of the run's is made in `parts`. A status. */
static int go(const gic_model *code, gic_head *self, const Scene *scene, int32_t method, int parts, double (*range)[2])
{
    const int count = code->slow_count + code->fast_count;
    const double *state = instance_array(self, code->state_offset);
    const bool own = method == scene->method;
    int status = GIC_OK;
    self->input_function = NULL;
    for (int k = 0; k < (BEFORE + MEASURED) * parts && status == GIC_OK; ++k) {
        status =
            gic_step_dual_by(code, self, scene->step / parts, method, own ? scene->ratio : 1, own ? scene->steady : 0);
        if (k == BEFORE * parts)
            for (int i = 0; i < count; ++i)
                range[i][0] = range[i][1] = state[i];
        if (k >= BEFORE * parts)
            widen(state, count, range);
    }
    return status;
}

/* The state that is the rate of a place, -1: state i is none. */
static int rate_of(const gic_model *code, int i)
{
    const int half = (code->slow_count - code->free_base) / 2;
    if (code->free_base && i < 3)
        return half + code->free_base + i;
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] == i)
            return i + half;
    return -1;
}

/* More than `times` the other, and visible: by how much; else 0. */
static double excess(const double range[2], const double other[2], double longest)
{
    const double way = range[1] - range[0], less = other[1] - other[0];
    if (!(way > fmax(visible * longest, rounding * (1 + fabs(range[0]))) && way > times * less))
        return 0;
    return less > 0 ? way / less : INFINITY;
}

Replay step_replay(Pool *pool, const Engine *engine, const Scene *scene, const gic_head *from, int parts,
                   const double *longest)
{
    const gic_model *code = engine->code;
    const int count = code->slow_count + code->fast_count;
    double(*own)[2] = pool_alloc(pool, sizeof *own * (size_t)(2 * count + 1)), (*small)[2] = own + count;
    Replay replay = {-1, -1};
    gic_head *self = instance_new(pool, engine);
    memcpy(self, from, code->size);
    if (go(code, self, scene, scene->method, 1, own) != GIC_OK)
        return replay;
    memcpy(self, from, code->size);
    gic_restart(self, gic_time(self));
    self->most = 0;
    if (go(code, self, scene, GIC_RK4, parts, small) != GIC_OK)
        return replay;
    double most[2] = {0, 0};
    for (int i = 0; i < count; ++i) {
        const double moves = excess(own[i], small[i], longest[i]);
        const int rate = rate_of(code, i);
        /* angular frequency, at least, of what small steps show: motions that are not resolved may die out */
        const double fastest = rate < 0 ? INFINITY : (small[rate][1] - small[rate][0]) / (small[i][1] - small[i][0]);
        const double stays = fastest * scene->step < resolved ? excess(small[i], own[i], longest[i]) : 0;
        if (moves > most[0]) {
            most[0] = moves;
            replay.moves = i;
        }
        if (stays > most[1]) {
            most[1] = stays;
            replay.stays = i;
        }
    }
    return replay;
}
