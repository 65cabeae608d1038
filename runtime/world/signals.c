/* SPDX-License-Identifier: MIT
 * Signals (FORMAT.md section 7.1): outputs that formulas read, and formulas with names. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/world.h"

#include <math.h>

double world_signal(const World *world, int index)
{
    const Signal *signal = &world->model->signal[index];
    if (signal->law)
        return world_law(world, signal->law, NULL);
    const bool spin = signal->output.type == OUTPUT_TIRE && signal->component == TIRE_SPIN;
    if (world->linked && !spin)
        return world->linked[index];
    double out[OUTPUT_MAX_COMPONENTS] = {0};
    world_output(world, &signal->output, out);
    return out[signal->component];
}

/* ---- order ---------------------------------------------------------------------------------------------------------
 */

/* True if all elements that the formula reads are among the first `count` of the order. */
static bool is_ready(const World *world, const Law *law, int count)
{
    if (!law)
        return true;
    if (law->op == LAW_SIGNAL) {
        const Signal *signal = &world->model->signal[law->index];
        if (signal->law)
            return is_ready(world, signal->law, count);
        bool found = signal->output.type != OUTPUT_FORCE;
        for (int i = 0; i < count; ++i)
            found = found || world->order[i] == signal->output.index;
        return found;
    }
    return is_ready(world, law->arg[0], count) && is_ready(world, law->arg[1], count) &&
           is_ready(world, law->arg[2], count);
}

void world_order(World *world)
{
    const Model *model = world->model;
    int count = 0;
    while (count < model->forces) {
        const int before = count;
        for (int f = 0; f < model->forces; ++f) {
            bool there = false, ready = true;
            for (int i = 0; i < count; ++i)
                there = there || world->order[i] == f;
            for (int k = 0; k < FORCE_MOST_LAWS; ++k)
                ready = ready && is_ready(world, model->force[f].law[k], count);
            if (!there && ready)
                world->order[count++] = f;
        }
        if (count == before) /* a circle, which no model has that was read */
            return;
    }
}

/* ---- places where roundings decide --------------------------------------------------------------------------------
 */

/* Such a share of an angle's cosine, or of a condition's terms, is far above rounding and met by few states. */
static const double near = 1e-7;

/* An attitude near the vertical, where roll and yaw are of no use, or near half a turn, where they jump; Euler
 * parameters near where their sign changes. */
static bool attitude_is_sure(const World *world, const Output *output)
{
    if (output->body == BODY_GROUND)
        return true;
    const double *A = world->A[output->body];
    if (output->type == OUTPUT_ORIENTATION)
        return output->body == BODY_BASE || fabs(world->q[output->body][3]) > near;
    if (output->type != OUTPUT_ROLL_PITCH_YAW)
        return true;
    return hypot(A[0], A[3]) > near && (A[8] > 0 || fabs(A[7]) > near) && (A[0] > 0 || fabs(A[3]) > near);
}

/* signals: the formula reads some. */
static bool law_is_sure(const World *world, const Law *law, bool *signals)
{
    if (!law)
        return true;
    bool within = false, sure = true;
    if (law->op == LAW_SIGNAL) {
        const Signal *signal = &world->model->signal[law->index];
        *signals = true;
        return signal->law ? law_is_sure(world, signal->law, signals) : attitude_is_sure(world, &signal->output);
    }
    for (int i = 0; i < 3 && sure; ++i) {
        bool here = false;
        sure = law_is_sure(world, law->arg[i], &here);
        within = within || (here && i == 0);
        *signals = *signals || here;
    }
    if (sure && within && law->op == LAW_CALL && law->call == OP_POSITIVE) {
        static const double nothing[FORCE_LOCALS] = {0};
        const double value = world_law(world, law->arg[0], nothing);
        sure = fabs(value) > near * (world_law_size(world, law->arg[0], nothing) + near);
    }
    return sure;
}

bool world_law_jumps(const World *world, const Law *law)
{
    static const double nothing[FORCE_LOCALS] = {0};
    if (!law)
        return false;
    if (law->op == LAW_SIGNAL)
        return world_law_jumps(world, world->model->signal[law->index].law);
    if (law->op == LAW_CALL && law->call == OP_ATAN2 && !(world_law(world, law->arg[1], nothing) > 0) &&
        !(fabs(world_law(world, law->arg[0], nothing)) > near * world_law_size(world, law->arg[0], nothing)))
        return true;
    return world_law_jumps(world, law->arg[0]) || world_law_jumps(world, law->arg[1]) ||
           world_law_jumps(world, law->arg[2]);
}

static bool law_reads(const Law *law, int local)
{
    return law && ((law->op == LAW_LOCAL && law->index == local) || law_reads(law->arg[0], local) ||
                   law_reads(law->arg[1], local) || law_reads(law->arg[2], local));
}

/* Air neither from straight behind nor along z, where the sideslip jumps, or no formula asks for it. */
static bool sideslip_is_sure(const World *world, const Force *force)
{
    double u[3];
    bool asked = false;
    for (int k = 0; k <= AERO_DRAG; ++k)
        asked = asked || law_reads(force->law[k], AERO_SIDESLIP);
    if (!asked)
        return true;
    world_airflow(world, force, u);
    const double level = hypot(u[0], u[1]), speed = hypot(level, u[2]);
    return speed <= near || (level > near * speed && (u[0] > 0 || fabs(u[1]) > near * level));
}

bool world_signals_are_sure(const World *world)
{
    const Model *model = world->model;
    bool sure = true, signals = false;
    for (int f = 0; f < model->forces; ++f)
        for (int k = 0; k < FORCE_MOST_LAWS; ++k)
            sure = sure && law_is_sure(world, model->force[f].law[k], &signals);
    for (int f = 0; f < model->forces; ++f)
        sure = sure && (model->force[f].type != FORCE_AERO || sideslip_is_sure(world, &model->force[f])) &&
               (!model->force[f].bushing || world_bushing_is_sure(world, &model->force[f]));
    for (int i = 0; i < model->states; ++i)
        sure = sure && law_is_sure(world, model->state[i].rate, &signals);
    for (int i = 0; i < model->wheels; ++i)
        sure = sure && law_is_sure(world, model->wheel[i].drive, &signals) &&
               law_is_sure(world, model->wheel[i].brake, &signals);
    for (int i = 0; i < model->outputs; ++i)
        if (model->output[i].type == OUTPUT_SIGNAL)
            sure = sure && law_is_sure(world, model->signal[model->output[i].index].law, &signals);
    return sure;
}
