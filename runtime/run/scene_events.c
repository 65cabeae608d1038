/* SPDX-License-Identifier: MIT
 * Conditions of scenes. After each step their values are looked at. Where one has become positive, its time is found on
 * the cubic through state and rate at both ends of the step; then the step is made again up to there by RK4, in as many
 * parts as the step has fast ones, and from there to the step's end. */
#include "engine/engine.h"
#include "gic_road.h"
#include "run/run.h"
#include "run/scene_events.h"
#include "scene/action.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

enum { HALVINGS = 60 };

struct SceneEvents {
    Pool *pool;
    const Engine *engine;
    const Scene *scene;
    gic_head *before, *after, *look; /* instances: at a step's start and end; for looks */
    size_t states;                   /* of the engine's own state */
    double *rate[2];                 /* at both ends */
    double *jump;                    /* s: of what controllers hold, when it jumps; NAN: it does not */
};

static double *state_of(const SceneEvents *events, gic_head *self)
{
    return instance_array(self, events->engine->code->state_offset);
}

/* The value of a condition at an instance, which stays as it is. */
static int value_at(SceneEvents *events, const gic_model *model, const Action *action, const gic_head *self,
                    double *value)
{
    const Engine *engine = events->engine;
    double standard[engine->standard_count + 1];
    int status = GIC_OK;
    memcpy(events->look, self, model->size);
    events->look->grown = -1;
    if (events->scene->watches)
        status = model->outputs(events->look);
    if (status == GIC_OK && engine->leave)
        status = engine_look(engine, events->look, standard, NULL);
    if (status == GIC_OK)
        *value = action_value(action, events->scene, model, events->look,
                              engine->leave ? standard : state_of(events, events->look),
                              engine->standard_count - model->fast_count);
    return status;
}

static int note_held(SceneEvents *events, const gic_model *model, const gic_head *self)
{
    const Actions *actions = events->scene->actions;
    int status = GIC_OK;
    for (int i = 0; i < actions->count && status == GIC_OK; ++i) {
        double value = 0;
        if (!actions->action[i].done)
            status = value_at(events, model, &actions->action[i], self, &value);
        actions->action[i].held = value > 0;
    }
    return status;
}

SceneEvents *scene_events_new(Pool *pool, const Engine *engine, const Scene *scene, const gic_head *self, int *status)
{
    const gic_model *code = engine->code;
    *status = GIC_OK;
    if (!scene->actions)
        return NULL;
    SceneEvents *events = pool_alloc(pool, sizeof *events);
    *events = (SceneEvents){.pool = pool, .engine = engine, .scene = scene};
    events->before = instance_new(pool, engine);
    events->after = instance_new(pool, engine);
    events->look = instance_new(pool, engine);
    events->states = (size_t)(code->slow_count + code->fast_count);
    for (int i = 0; i < 2; ++i)
        events->rate[i] = pool_alloc(pool, sizeof(double) * (events->states + 1));
    events->jump = pool_alloc(pool, sizeof(double) * (events->states + 1));
    for (size_t i = 0; i < events->states; ++i)
        events->jump[i] = NAN;
    *status = note_held(events, code, self);
    return events;
}

/* Of what controllers hold: when it may jump first in the step from `before` on. */
static void note_jumps(SceneEvents *events, const gic_model *model)
{
    const double *y = state_of(events, events->before);
    for (int32_t c = 0; c < model->controller_count; ++c) {
        const gic_controller *controller = &model->controller[c];
        const double sample = controller->offset + y[controller->samples] * controller->period;
        events->jump[controller->samples] = sample;
        for (int32_t i = 0; i < controller->rule_count; ++i) {
            const gic_rule *rule = &controller->rule[i];
            for (int32_t k = 0; k <= rule->waiting; ++k)
                events->jump[rule->state + k] = sample;
            if (rule->effects >= 0)
                events->jump[rule->state] = events->jump[rule->effects] =
                    controller->offset + rule->late + y[rule->effects] * controller->period;
        }
    }
}

/* Rates at an instance, which stays as it is. */
static int rates_at(SceneEvents *events, const gic_model *model, const gic_head *self, double *rate)
{
    memcpy(events->look, self, model->size);
    return model->rhs(events->look, gic_time(self), state_of(events, events->look), rate);
}

/* The value of a condition between the ends of the step, at a share s of it. */
static int value_between(SceneEvents *events, const gic_model *model, const Action *action, gic_head *at, double s,
                         double *value)
{
    const double start = gic_time(events->before), width = gic_time(events->after) - start;
    const double *y0 = state_of(events, events->before), *y1 = state_of(events, events->after);
    const double *v0 = events->rate[0], *v1 = events->rate[1], u = 1 - s;
    memcpy(at, events->before, model->size);
    double *y = state_of(events, at);
    for (size_t i = 0; i < events->states; ++i)
        if (isnan(events->jump[i]))
            y[i] = y0[i] + s * s * (3 - 2 * s) * (y1[i] - y0[i]) + width * s * u * (u * v0[i] - s * v1[i]);
        else
            y[i] = start + s * width < events->jump[i] ? y0[i] : y1[i];
    gic_restart(at, start + s * width);
    if (at->input_function)
        at->input_function(at->user, at->lane, start + s * width, instance_array(at, model->input_offset));
    return value_at(events, model, action, at, value);
}

/* When an action's condition becomes true in the step, s. A discrete state that changes at the step's end does so only
 * there. */
static int locate(SceneEvents *events, const gic_model *model, const Action *action, gic_head *at, double *time)
{
    const double start = gic_time(events->before), width = gic_time(events->after) - start;
    double low = 0, high = 1, value = 0;
    int status = value_between(events, model, action, at, 1, &value);
    for (int i = 0; i < HALVINGS && status == GIC_OK && value > 0 && high - low > 1e-15; ++i) {
        const double middle = (low + high) / 2;
        double here = 0;
        status = value_between(events, model, action, at, middle, &here);
        *(here > 0 ? &high : &low) = middle;
    }
    *time = high == 1 ? gic_time(events->after) : start + high * width;
    return status;
}

/* The action that happens first between `before` and `after`; NULL: none does. */
static int first_action(SceneEvents *events, const gic_model *model, gic_head *at, Action **first)
{
    const Actions *actions = events->scene->actions;
    bool rated = false;
    int status = GIC_OK;
    *first = NULL;
    for (int i = 0; i < actions->count && status == GIC_OK; ++i) {
        Action *action = &actions->action[i];
        double value = 0;
        if (action->done || action->held)
            continue;
        status = value_at(events, model, action, events->after, &value);
        if (status != GIC_OK || !(value > 0))
            continue;
        for (int k = 0; k < 2 && !rated && status == GIC_OK; ++k)
            status = rates_at(events, model, k ? events->after : events->before, events->rate[k]);
        if (!rated)
            note_jumps(events, model);
        rated = true;
        if (status == GIC_OK)
            status = locate(events, model, action, at, &action->time);
        if (!*first || action->time < (*first)->time)
            *first = action;
    }
    return status;
}

/* From the instance's time to another one, without a past. */
static int move_to(SceneEvents *events, const gic_model *model, Variable *variable, gic_head *self, double time)
{
    const Scene *scene = events->scene;
    int status = GIC_OK;
    gic_restart(self, gic_time(self));
    if (variable)
        variable_restart(variable);
    for (; variable && status == GIC_OK && gic_time(self) < time;)
        status = scene_step_awake(events->engine, model, scene, variable, self, time);
    const double way = time - gic_time(self), part = way / scene->ratio;
    for (int i = 0; !variable && i < scene->ratio && status == GIC_OK && gic_time(self) + part > gic_time(self); ++i)
        status = gic_step(model, self, part, scene_method_of_parts(scene));
    if (status == GIC_OK)
        gic_restart(self, time);
    if (variable)
        variable_restart(variable);
    return status;
}

/* `self` is at the time of the action: profiles change, and inputs with them. */
static void happen(SceneEvents *events, const gic_model *model, Action *action, gic_head *self)
{
    double *input = instance_array(self, model->input_offset);
    const double time = gic_time(self);
    action->time = time;
    if (self->input_function)
        self->input_function(self->user, self->lane, time, input);
    action_start(events->pool, action, events->scene, input);
    if (self->input_function)
        self->input_function(self->user, self->lane, time, input);
}

/* The next action whose condition is true at `self`, but was not when it was last noted; NULL: there is none. */
static int follows(SceneEvents *events, const gic_model *model, const gic_head *self, Action **next)
{
    const Actions *actions = events->scene->actions;
    int status = GIC_OK;
    *next = NULL;
    for (int i = 0; i < actions->count && status == GIC_OK && !*next; ++i) {
        Action *action = &actions->action[i];
        double value = 0;
        if (action->done || action->held)
            continue;
        status = value_at(events, model, action, self, &value);
        if (value > 0)
            *next = action;
    }
    return status;
}

/* At the time of an action it happens, with all that follow from it there: by an input that jumps, or at the same
 * instant. Controllers sample before, as nothing has changed yet. */
static int happen_all(SceneEvents *events, const gic_model *model, Action *action, gic_head *self, bool *ended)
{
    double next;
    int status = gic_sample(model, self, &next);
    while (status == GIC_OK && action && !*ended) {
        happen(events, model, action, self);
        *ended = action->ends;
        if (!*ended)
            status = follows(events, model, self, &action);
    }
    return status;
}

int scene_events_step(SceneEvents *events, const gic_model *model, Variable *variable, gic_head *self, double end,
                      bool *ended)
{
    Action *action;
    memcpy(events->before, self, model->size);
    int status = scene_step(events->engine, model, events->scene, variable, self, end);
    if (status != GIC_OK)
        return status;
    const double target = gic_time(self);
    for (;;) {
        memcpy(events->after, self, model->size);
        /* input and other arguments of the step's functions are those of the step */
        status = first_action(events, model, self, &action);
        memcpy(self, events->after, model->size);
        if (status != GIC_OK || !action)
            break;
        if (action->time < target) {
            memcpy(self, events->before, model->size);
            self->rhs_count = events->after->rhs_count;
            status = move_to(events, model, variable, self, action->time);
        }
        if (status == GIC_OK)
            status = happen_all(events, model, action, self, ended);
        if (status != GIC_OK || *ended)
            return status;
        memcpy(events->before, self, model->size);
        status = note_held(events, model, self);
        if (status == GIC_OK)
            status = move_to(events, model, variable, self, target);
        if (status != GIC_OK)
            return status;
    }
    return status == GIC_OK ? note_held(events, model, self) : status;
}

/* ---- what became of the vehicle ----------------------------------------------------------------------------- */

Outcome outcome_new(void)
{
    return (Outcome){.tipped = NAN, .left = NAN, .rest = NAN};
}

/* Are there data of the road at a place? */
static bool has_data(const gic_road *road, double x, double y)
{
    const void *const any = road;
    if (!road)
        return true;
    if (road->height == gic_table_height) {
        const gic_road_table *table = any;
        return x >= table->x[0] && x <= table->x[table->count - 1];
    }
    if (road->height == gic_grid_height) {
        const gic_road_grid *grid = any;
        return x >= grid->x0 && x <= grid->x0 + (grid->nx - 1) * grid->dx && y >= grid->y0 &&
               y <= grid->y0 + (grid->ny - 1) * grid->dy;
    }
    if (road->height == gic_patched_height)
        return has_data(((const gic_road_patched *)any)->under, x, y);
    bool has = true;
    if (road->height == gic_sum_height)
        for (int32_t i = 0; i < ((const gic_road_sum *)any)->count; ++i)
            has = has && has_data(((const gic_road_sum *)any)->part[i], x, y);
    return has;
}

static double length_of(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void outcome_look(Outcome *outcome, const gic_model *code, const gic_road *road, double time, const double *standard)
{
    const double still = 0.01, tilt = 0.5; /* m/s and rad/s; cosine of 60 degrees */
    const double *e = standard + 3, *velocity = standard + (code->slow_count - 1) / 2 + 1;
    const double norm = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
    const double upright = (e[0] * e[0] - e[1] * e[1] - e[2] * e[2] + e[3] * e[3]) / norm;
    const bool moves = length_of(velocity) > still || length_of(velocity + 3) > still;
    const bool on = has_data(road, standard[0], standard[1]);
    if (isnan(outcome->tipped) && upright < tilt)
        outcome->tipped = time;
    outcome->moved = outcome->moved || moves;
    if (moves)
        outcome->rest = NAN;
    else if (isnan(outcome->rest))
        outcome->rest = time;
    if (on) {
        outcome->inside = true;
        outcome->left = NAN;
    } else if (outcome->inside && isnan(outcome->left)) {
        outcome->left = time;
    }
}
