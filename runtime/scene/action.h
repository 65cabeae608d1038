/* SPDX-License-Identifier: MIT
 *
 * action: what happens in a scene when a condition becomes true; models/SCENE.md section 13. */
#ifndef SCENE_ACTION_H
#define SCENE_ACTION_H

#include "base/message.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/profile.h"
#include "scene/scene.h"

/* An input's new profile: the item that describes it is read again when it starts, for it may begin from the value that
 * the input has then. */
typedef struct Change {
    int profile; /* of the scene; -1: the driver's target */
    const char *name;
    const Item *item;
} Change;

typedef struct Action {
    Place at;
    const char *text; /* of the condition */
    const Law *law;   /* positive where it holds */
    bool ends;        /* the run */
    const char *mark; /* name in the results; NULL: none */
    int changes;
    Change *change;
    /* as the run has it */
    bool held, done; /* did it hold at the last look; did it happen, at `time`? */
    double time;
} Action;

struct Actions {
    const Model *model;
    int count, marks;
    Action *action;
    /* Names that conditions may use beside those of the model: signals, then of a free base speed, roll, pitch, yaw. */
    const char **local;
    int locals, signals;
    int *watch; /* [signals] place among the scene's watched signals, -1: no condition uses it */
};

/* Read `until` and `when`; NULL: the scene has neither. */
Actions *actions_read(Pool *pool, const Item *root, const Model *model, Scene *scene);
/* The value of a condition, of an instance whose outputs are computed where the scene watches some. standard: its state
 * as in FORMAT.md section 10; slow: how many numbers of it come before the fast states. */
double action_value(const Action *action, const Scene *scene, const gic_model *code, gic_head *self,
                    const double *standard, int slow);
/* Execute the action at the instance's time, with its inputs up to date. */
void action_start(Pool *pool, Action *action, const Scene *scene, const double *input);
/* The profile that a change begins at `time` (s), in place of `before`, where the input is `present`. */
Profile action_profile(Pool *pool, const Change *change, const Profile *before, double time, double present);
/* Clear the marks of the inputs that actions change. */
void actions_move(const Scene *scene, bool *fixed);
/* May inputs still change by an action? */
bool actions_pending(const Actions *actions);

#endif
