/* SPDX-License-Identifier: MIT
 * Articulated vehicles: units, found by the joints that part the vehicle; how the last one follows the first. */
#include "base/vec3.h"
#include "run/manoeuvre.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;

/* ---- which they are -------------------------------------------------------------------------------------- */

/* Mark the bodies that joints connect with `body`, without joint `cut`. */
static void reach(const Model *model, int cut, int body, bool *there)
{
    bool more = true;
    memset(there, 0, (size_t)model->bodies * sizeof *there);
    there[body] = true;
    while (more) {
        more = false;
        for (int j = 0; j < model->joints; ++j) {
            const int a = model->joint[j].body[0], b = model->joint[j].body[1];
            if (j == cut || a == BODY_GROUND || b == BODY_GROUND || there[a] == there[b])
                continue;
            there[a] = there[b] = more = true;
        }
    }
}

/* True: it lets one body turn about the vertical on the other. */
static bool turns(const Model *model, const Joint *joint)
{
    double A[9], axis[3];
    if (joint->body[0] == BODY_GROUND || joint->body[1] == BODY_GROUND)
        return false;
    if (joint->type == JOINT_SPHERICAL || joint->type == JOINT_UNIVERSAL)
        return true;
    if (joint->type != JOINT_REVOLUTE && joint->type != JOINT_CYLINDRICAL)
        return false;
    mat_from_euler(model->body[joint->body[0]].euler, A);
    apply3(A, joint->axis[0], axis);
    return fabs(axis[2]) > 0.9;
}

/* Centre of mass of the bodies that are marked, in the axes of the drawing; returns their number. */
static int centre_of(const Model *model, const bool *there, double com[3])
{
    double mass = 0;
    int count = 0;
    memset(com, 0, 3 * sizeof *com);
    for (int b = 0; b < model->bodies; ++b) {
        const Body *body = &model->body[b];
        double A[9], at[3];
        if (!there[b])
            continue;
        mat_from_euler(body->euler, A);
        apply3(A, body->com, at);
        add_scaled3(1, body->position, at);
        add_scaled3(body->mass, at, com);
        mass += body->mass;
        ++count;
    }
    for (int i = 0; i < 3; ++i)
        com[i] /= mass;
    return count;
}

static bool carries(const KcAxle *axle, const bool *there)
{
    for (int k = 0; k < axle->wheels; ++k)
        if (!there[axle->wheel[k].wheel->body])
            return false;
    return true;
}

const Units *units_find(const Sheet *sheet)
{
    const Model *model = sheet->model;
    const KcAxle *axle = NULL;
    for (int a = 0; a < sheet->kc->axles; ++a)
        if (sheet->kc->axle[a].unit)
            axle = &sheet->kc->axle[a];
    if (!axle)
        return NULL;
    bool *there = pool_alloc(sheet->pool, (size_t)model->bodies * sizeof *there);
    Units *units = pool_alloc(sheet->pool, sizeof *units);
    int fewest = model->bodies, first = model->bodies;
    *units = (Units){.body = -1};
    double com[3] = {0};
    for (int j = 0; j < model->joints; ++j) {
        double at[3];
        if (!turns(model, &model->joint[j]))
            continue;
        reach(model, j, BODY_BASE, there);
        const int ahead = centre_of(model, there, at);
        if (ahead < first) { /* nearest to the base, if it parts the vehicle before the rearmost axle */
            bool *behind = pool_alloc(sheet->pool, (size_t)model->bodies * sizeof *behind);
            reach(model, j, axle->wheel[0].wheel->body, behind);
            if (!behind[BODY_BASE] && carries(axle, behind)) {
                first = ahead;
                sub3(at, model->body[BODY_BASE].position, units->first);
            }
        }
        reach(model, j, axle->wheel[0].wheel->body, there);
        if (there[BODY_BASE] || !carries(axle, there))
            continue;
        const int count = centre_of(model, there, at);
        if (count >= fewest)
            continue;
        int body = -1;
        for (int b = 0; b < model->bodies; ++b)
            if (there[b] && fabs(model->body[b].euler[0]) > 1 - 1e-12 &&
                (body < 0 || model->body[b].mass > model->body[body].mass))
                body = b;
        fewest = count;
        units->body = body;
        memcpy(com, at, sizeof com);
    }
    if (units->body < 0)
        return NULL;
    sub3(com, model->body[units->body].position, units->last);
    return units;
}

/* ---- what they do ---------------------------------------------------------------------------------------- */

void units_motion(const double *output, double *row)
{
    const double *place = output + UNIT_POSITION, *a = output + UNIT_ACCELERATION, *attitude = output + UNIT_ATTITUDE;
    const double yaw = attitude[2];
    row[TRIAL_LAST_X] = place[0];
    row[TRIAL_LAST_Y] = place[1];
    row[TRIAL_LAST_YAW_RATE] = output[UNIT_TURN + 2];
    row[TRIAL_LAST_AY] = cos(yaw) * a[1] - sin(yaw) * a[0];
    row[TRIAL_LAST_ROLL] = attitude[0];
    row[TRIAL_ARTICULATION] = remainder(yaw - row[TRIAL_YAW], 2 * pi);
}

/* The largest size of a channel from a time on. */
static double largest(const Trial *trial, Channel channel, double from)
{
    return fmax(fabs(trial->row[trial_peak(trial, channel, from, INFINITY, 1)][channel]),
                fabs(trial->row[trial_peak(trial, channel, from, INFINITY, -1)][channel]));
}

/* Extreme values of a channel from a time on, as parabolas through three rows have them, and when they are. */
typedef struct Extremes {
    int count;
    double *value, *time;
} Extremes;

static Extremes extremes_of(Pool *pool, const Trial *trial, Channel channel, double from)
{
    const size_t room = (size_t)trial->rows * sizeof(double);
    Extremes e = {0, pool_alloc(pool, room), pool_alloc(pool, room)};
    for (int i = 1; i + 1 < trial->rows; ++i) {
        const double *before = trial->row[i - 1], *at = trial->row[i], *next = trial->row[i + 1];
        const double up = at[channel] - before[channel], on = next[channel] - at[channel];
        if (before[TRIAL_TIME] < from || !(up * on < 0))
            continue;
        const double share = 0.5 * (up + on) / (up - on); /* of a step, after row i */
        e.value[e.count] = at[channel] + 0.25 * share * (up + on);
        e.time[e.count++] = at[TRIAL_TIME] + share * (next[TRIAL_TIME] - at[TRIAL_TIME]);
    }
    return e;
}

/* Damping of what swings: of each swing, from an extreme value to the next, by the one after it; until they are small.
 */
static void add_damping(Manoeuvre *m, const Trial *trial, double from)
{
    static const double small = 0.02; /* of the first swing */
    const Extremes e = extremes_of(m->pool, trial, TRIAL_ARTICULATION, from);
    double ratio = 0;
    int swings = 0; /* that have one after them */
    for (int k = 0; k + 2 < e.count; ++k) {
        const double now = fabs(e.value[k + 1] - e.value[k]), then = fabs(e.value[k + 2] - e.value[k + 1]);
        if (then < small * fabs(e.value[1] - e.value[0]))
            break;
        ratio += now / then;
        ++swings;
    }
    if (!swings) {
        sheet_miss(m->result, pool_print(m->pool,
                                         "%s.articulation.damping: the units do not swing against each other three "
                                         "times after the steering",
                                         trial->name));
        return;
    }
    const double decrement = log(ratio / swings);
    sheet_add(m->result, NULL, pool_print(m->pool, "%s.articulation.damping", trial->name),
              "Damping ratio of the articulation angle", "1", decrement / hypot(pi, decrement));
    sheet_add(m->result, NULL, pool_print(m->pool, "%s.articulation.frequency", trial->name),
              "Frequency at which it swings", "Hz", 0.5 * (swings + 1) / (e.time[swings + 1] - e.time[0]));
}

bool manoeuvre_has_units(Manoeuvre *m)
{
    if (!m->car->units && m->car->sheet.kc->units)
        sheet_miss(m->result,
                   "rearward amplification: no joint about the vertical, and no ball joint, parts the vehicle ahead of "
                   "its rearmost axle, or none of the bodies behind it has the axes of the drawing");
    return m->car->units;
}

void manoeuvre_rearward(Manoeuvre *m, const Trial *trial, double from, double to)
{
    sheet_add(m->result, NULL, pool_print(m->pool, "%s.rearward.ay", trial->name),
              "Rearward amplification, lateral acceleration", "1",
              largest(trial, TRIAL_LAST_AY, from) / largest(trial, TRIAL_AY, from));
    sheet_add(m->result, NULL, pool_print(m->pool, "%s.rearward.yaw_rate", trial->name),
              "Rearward amplification, yaw rate", "1",
              largest(trial, TRIAL_LAST_YAW_RATE, from) / largest(trial, TRIAL_YAW_RATE, from));
    sheet_add(m->result, NULL, pool_print(m->pool, "%s.articulation", trial->name), "Largest articulation angle", "rad",
              largest(trial, TRIAL_ARTICULATION, from));
    add_damping(m, trial, to);
}
