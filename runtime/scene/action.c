/* SPDX-License-Identifier: MIT
 * Conditions over signals, and what happens when they become true: values of conditions, changes of inputs. */
#include "base/table.h"
#include "base/vec3.h"
#include "base/yaml.h"
#include "engine/engine.h"
#include "expression/expression.h"
#include "scene/action.h"
#include "scene/driver.h"
#include "scene/profile.h"

#include <math.h>
#include <string.h>

/* What a condition sees. */
typedef struct View {
    const Scene *scene;
    const gic_model *code;
    gic_head *self;
    const double *standard;
    int slow; /* numbers of the multibody system in it, before the fast states */
    int half; /* from a position in it to its rate */
} View;

enum { SPEED, ROLL, PITCH, YAW }; /* outputs of the base, after the signals */

static double of_base(const View *view, int which)
{
    const double *y = view->standard, *velocity;
    double e[4], A[9];
    const double norm = sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6]);
    for (int i = 0; i < 4; ++i)
        e[i] = y[3 + i] / norm;
    mat_from_euler(e, A);
    velocity = y + view->half + 1; /* past three coordinates and four Euler parameters */
    switch (which) {
    case SPEED: return velocity[0] * A[0] + velocity[1] * A[3] + velocity[2] * A[6];
    case ROLL: return atan2(A[7], A[8]);
    case PITCH: return -asin(fmin(fmax(A[6], -1), 1));
    default: return atan2(A[3], A[0]);
    }
}

static double coordinate_at(const View *view, int coordinate, bool rate)
{
    const gic_model *code = view->code;
    const int at = code->coordinate_state[coordinate];
    if (at < 0)
        return instance_array(view->self, code->input_offset)[code->coordinate_input[coordinate] + rate];
    return view->standard[at + (rate ? view->half : 0)];
}

static double value_of(const View *view, const Law *law)
{
    const Scene *scene = view->scene;
    const Actions *actions = scene->actions;
    const Model *model = actions->model;
    double x[3] = {0};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        x[i] = value_of(view, law->arg[i]);
    switch (law->op) {
    case LAW_TIME: return gic_time(view->self);
    case LAW_INPUT: return instance_array(view->self, view->code->input_offset)[law->index];
    case LAW_VALUE: return coordinate_at(view, law->index, false);
    case LAW_RATE: return coordinate_at(view, law->index, true);
    case LAW_STATE: return view->standard[view->slow + model->state[law->index].fast];
    case LAW_PARAMETER:
        return model->parameter[law->index].tunable ? scene->parameter[model->parameter[law->index].index]
                                                    : law_number(law, model);
    case LAW_LOCAL: {
        if (law->index >= actions->signals)
            return of_base(view, law->index - actions->signals);
        const int i = scene->watched[actions->watch[law->index]], outputs = view->code->output_count;
        const bool input = i >= outputs;
        return instance_array(view->self,
                              input ? view->code->input_offset : view->code->output_offset)[input ? i - outputs : i];
    }
    case LAW_TABLE: return table_value(&model->table[law->index], x[0]);
    case LAW_CALL: return op_value((Op)law->call, x[0], x[1], x[2]);
    default: return law->number;
    }
}

double action_value(const Action *action, const Scene *scene, const gic_model *code, gic_head *self,
                    const double *standard, int slow)
{
    return value_of(&(View){scene, code, self, standard, slow, slow / 2}, action->law);
}

Profile action_profile(Pool *pool, const Change *change, const Profile *before, double time, double present)
{
    Profile now = {.input = before->input,
                   .driven = before->driven,
                   .unit = before->unit,
                   .offset = present,
                   .end = before->until - time,
                   .until = before->until,
                   .model = before->model};
    profile_read(pool, change->item, change->name, &now);
    now.begin = time;
    return now;
}

/* A profile that takes over from `before` at `time`, where the input is `present`: value and, if driven, rate. */
static void change_profile(Pool *pool, const Change *change, Profile *before, double time, const double *present)
{
    const double roundings = 1e-9;
    const Profile now = action_profile(pool, change, before, time, present[0]);
    double first[3];
    profile_at(&now, time, first);
    for (int k = 0; k < 2 && before->driven; ++k)
        if (!(fabs(first[k] - present[k]) <= roundings * (1 + fabs(present[k]))))
            diag_fail(change->item->at,
                      k ? "let it start when the coordinate stands still, or let it begin at this rate"
                        : "leave out `from` and `offset`, which are the present value then",
                      "the %s of '%s' would jump from %.9g to %.9g when its new profile starts, at t = %.9g s",
                      k ? "rate" : "value", change->name, present[k], first[k], time);
    *before = now;
}

void action_start(Pool *pool, Action *action, const Scene *scene, const double *input)
{
    for (int i = 0; i < action->changes; ++i) {
        const Change *change = &action->change[i];
        double target[3];
        if (change->profile >= 0) {
            Profile *profile = &scene->profile[change->profile];
            change_profile(pool, change, profile, action->time, input + profile->input);
            continue;
        }
        profile_at(&scene->driver->speed, action->time, target);
        change_profile(pool, change, &scene->driver->speed, action->time, target);
    }
    action->done = true;
}

void actions_move(const Scene *scene, bool *fixed)
{
    for (int i = 0; scene->actions && i < scene->actions->count; ++i)
        for (int k = 0; k < scene->actions->action[i].changes; ++k) {
            const int at = scene->actions->action[i].change[k].profile;
            for (int j = 0; at >= 0 && j < (scene->profile[at].driven ? 3 : 1); ++j)
                fixed[scene->profile[at].input + j] = false;
        }
}

bool actions_pending(const Actions *actions)
{
    bool pending = false;
    for (int i = 0; actions && i < actions->count; ++i)
        pending = pending || (actions->action[i].changes && !actions->action[i].done);
    return pending;
}
