/* SPDX-License-Identifier: MIT
 * Runs of a sweep side by side, a vehicle in each lane. All begin, and look at outputs, at the same steps of the batch,
 * but not at the same of theirs: where a run has ended the next one begins while its neighbours go on. */
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/knot.h"
#include "run/last_good.h"
#include "run/run.h"
#include "run/stability_watch.h"
#include "scene/driver.h"
#include "scene/scene.h"
#include "sweep/run_private.h"
#include "sweep/sweep.h"

#include <math.h>
#include <string.h>

const char *lanes_unfit(const Scene *scene, const Model *model)
{
    if (scene_implicit(scene))
        return "implicit steps are made run by run";
    if (scene->method > GIC_RK4)
        return "steps of a scene with variable ones are each run's own";
    if (scene->locate)
        return "contacts within steps are looked for run by run";
    if (scene->most_work)
        return "the work of a step is bounded run by run";
    if (model->fast_states && scene->method != GIC_AB3)
        return "with tires, powertrains or states of a model's own lanes make steps of ab3";
    if (model->controllers)
        return "steps of models with controllers are made run by run";
    return NULL;
}

/* The head of a vehicle, in place. */
static gic_head *head_of(const Runner *r, int place)
{
    const gic_batch_model *many = r->sweep->many;
    char *block = (char *)r->batch + many->block_size * (size_t)(place / many->lanes);
    return (gic_head *)(void *)block + place % many->lanes;
}

/* Does a vehicle in lanes go on? */
static bool goes_on(const Runner *r, int place)
{
    return r->slot[place].run >= 0 && r->slot[place].status == GIC_OK && head_of(r, place)->status == GIC_OK;
}

/* Steps of the vehicles of a batch, without what belongs between them. */
static void make_steps(const Runner *r, void *batch, int32_t steps)
{
    const gic_batch_model *many = r->sweep->many;
    const Scene *scene = r->sweep->scene;
    if (scene->method == GIC_AB3 && many->step_dual)
        many->step_dual(batch, scene->step, scene->ratio, scene->steady, steps);
    else
        many->step(batch, scene->step, scene->method, steps);
}

/* ---- outputs ------------------------------------------------------------ */

/* A vehicle in lanes. */
typedef struct InLanes {
    const Runner *r;
    int place;
} InLanes;

/* Of a vehicle in lanes: instances don't take outputs with them, but inputs. */
static double value_in_lanes(const void *of, int signal)
{
    const InLanes *in = of;
    const Sweep *sweep = in->r->sweep;
    const bool input = signal >= sweep->engine->code->output_count;
    return input ? scene_value(sweep->engine->code, in->r->one, signal)
                 : sweep->many->output(in->r->batch, in->place, signal);
}

/* A vehicle in lanes, now in r->one, failed after its last output time: it goes from there once more, in a batch of its
 * own, which makes the same numbers, to its last good state. */
static void end_failed(Runner *r, Slot *slot)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    const gic_head failed = *r->one;
    int status = GIC_OK;
    memcpy(r->one, slot->before, code->size);
    if (slot->driver)
        *slot->scene.driver = *slot->driver;
    last_good_forget(r->good);
    sweep->many->setup(r->spare);
    for (int64_t left = sweep->scene->per_output; left > 0 && status == GIC_OK; --left) {
        const double start = gic_time(r->one);
        const int32_t history = r->one->history;
        last_good_keep(r->good, code, r->one);
        (void)scene_look(sweep->engine, &slot->scene, r->one);
        sweep->many->load(r->spare, 0, r->one);
        make_steps(r, r->spare, 1);
        sweep->many->store(r->spare, 0, r->one);
        status = r->one->status;
        if (status == GIC_OK)
            status = knots_cross(code, &slot->scene, r->one, start, history);
    }
    run_end_failed(r, slot, &failed);
}

/* The outputs of a slot, computed at the present time. */
static void look_at(Runner *r, int place)
{
    const Sweep *sweep = r->sweep;
    Slot *slot = &r->slot[place];
    slot->due = false;
    if (slot->status != GIC_OK)
        return;
    sweep->many->store(r->batch, place, r->one);
    run_set_status(r, slot, sweep->many->status(r->batch, place), r->one);
    if (slot->status == GIC_OK) {
        run_sample(sweep, slot, gic_time(r->one), value_in_lanes, &(InLanes){r, place});
        memcpy(slot->before, r->one, sweep->engine->code->size);
        if (slot->driver)
            *slot->driver = *slot->scene.driver;
    } else if (slot->sample) {
        end_failed(r, slot);
    }
}

/* ---- runs come and go ------------------------------------------------------------ */

/* The next run for a place, or an empty one. */
static void fill(Runner *r, int place, const Supply *supply)
{
    Slot *slot = &r->slot[place];
    slot->due = run_begin(r, slot, supply);
    if (slot->due && slot->status == GIC_OK)
        r->sweep->many->load(r->batch, place, r->one);
    else
        head_of(r, place)->status = GIC_BATCH_EMPTY;
}

/* Look at outputs that are due; ends of runs make room for others, whose first outputs are due. Returns the number of
 * runs that go on. */
static int look_and_fill(Runner *r, const Supply *supply)
{
    int going, begun;
    do {
        r->sweep->many->outputs(r->batch);
        going = begun = 0;
        for (int i = 0; i < r->slots && !r->stopped; ++i) {
            Slot *slot = &r->slot[i];
            if (slot->run >= 0 && slot->due)
                look_at(r, i);
            if (slot->run >= 0 && (slot->status != GIC_OK || slot->sample > r->sweep->scene->outputs)) {
                run_end(r, slot, supply);
                fill(r, i, supply);
                begun += slot->due;
            }
            going += slot->run >= 0;
        }
    } while (begun);
    return going;
}

/* ---- steps ------------------------------------------------------------ */

/* Before a step of one vehicle: a look of its driver, if it is due. */
static void drive(Runner *r, int place)
{
    Slot *slot = &r->slot[place];
    if (!slot->scene.driver || !driver_is_due(slot->scene.driver, gic_time(head_of(r, place))))
        return;
    r->sweep->many->store(r->batch, place, r->one);
    (void)scene_look(r->sweep->engine, &slot->scene, r->one); /* can't fail: the engine's state is the standard one */
}

/* One step of all slots, before which drivers may look and in which knots may be. */
static void step_over_events(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    double start[r->slots];
    int32_t history[r->slots];
    for (int i = 0; i < r->slots; ++i) {
        start[i] = gic_time(head_of(r, i));
        history[i] = head_of(r, i)->history;
        if (goes_on(r, i))
            drive(r, i);
    }
    make_steps(r, r->batch, 1);
    for (int i = 0; i < r->slots; ++i) {
        Slot *slot = &r->slot[i];
        if (!goes_on(r, i) || scene_next_knot(&slot->scene, start[i]) > gic_time(head_of(r, i)))
            continue;
        sweep->many->store(r->batch, i, r->one);
        run_set_status(r, slot, knots_cross(code, &slot->scene, r->one, start[i], history[i]), r->one);
        sweep->many->load(r->batch, i, r->one);
    }
}

/* Steps of all slots before the next one with a knot or a look of a driver, rather less than more, but at most `most`.
 */
static int64_t steps_to_event(const Runner *r, int64_t most)
{
    double steps = (double)most;
    for (int i = 0; i < r->slots; ++i) {
        const Scene *scene = &r->slot[i].scene;
        if (!goes_on(r, i))
            continue;
        const double now = gic_time(head_of(r, i));
        double event = scene_next_knot(scene, now);
        if (scene->driver)
            event = fmin(event, scene->driver->next - 1e-9 * scene->driver->period); /* as driver_is_due() */
        steps = fmin(steps, (event - now) / scene->step - 1e-6);
    }
    return steps > 0 ? (int64_t)steps : 0;
}

/* Steps up to the next one that a watch looks at, that one included, at most `most`. */
static int64_t steps_to_sample(const Runner *r, int64_t most)
{
    for (int i = 0; i < r->slots; ++i) {
        const Slot *slot = &r->slot[i];
        if (slot->run >= 0 && slot->watch && step_watch_idle(slot->watch) < most)
            most = step_watch_idle(slot->watch) + 1;
        if (slot->run >= 0 && slot->bounces && bounce_watch_idle(slot->bounces) < most)
            most = bounce_watch_idle(slot->bounces) + 1;
    }
    return most;
}

/* Steps of all slots, at most `most`, up to the next sample of a watch. */
static int64_t step_all(Runner *r, int64_t most)
{
    const Sweep *sweep = r->sweep;
    const int64_t steps = steps_to_sample(r, most);
    for (int64_t left = steps; left > 0;) {
        const int64_t smooth = steps_to_event(r, left);
        if (smooth > 0)
            make_steps(r, r->batch, (int32_t)smooth);
        else
            step_over_events(r);
        left -= smooth > 0 ? smooth : 1;
    }
    for (int i = 0; i < r->slots; ++i) {
        const Slot *slot = &r->slot[i];
        if (slot->run < 0)
            continue;
        const bool look = slot->watch && step_watch_idle(slot->watch) < steps;
        const bool bounce = slot->bounces && bounce_watch_idle(slot->bounces) < steps;
        if (slot->watch)
            step_watch_pass(slot->watch, steps - look);
        if (slot->bounces)
            bounce_watch_pass(slot->bounces, steps - bounce);
        if (look || bounce)
            sweep->many->store(r->batch, i, r->one);
        if (look)
            step_watch_step(slot->watch, sweep->engine->code, r->one, r->copy);
        if (bounce)
            bounce_watch_step(slot->bounces, sweep->engine->code, r->one);
    }
    return steps;
}

void lanes_run(Runner *r, const Supply *supply)
{
    const Scene *scene = r->sweep->scene;
    r->sweep->many->setup(r->batch);
    for (int i = 0; i < r->slots; ++i)
        fill(r, i, supply);
    while (look_and_fill(r, supply) && !r->stopped) {
        for (int64_t left = scene->per_output; left > 0 && !r->stopped;) {
            left -= step_all(r, left < CHUNK ? left : CHUNK);
            run_look_around(r);
        }
        for (int i = 0; i < r->slots; ++i)
            r->slot[i].due = r->slot[i].run >= 0;
    }
    for (int i = 0; i < r->slots; ++i)
        if (r->slot[i].run >= 0)
            run_end(r, &r->slot[i], supply);
}
