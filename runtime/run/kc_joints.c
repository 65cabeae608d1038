/* SPDX-License-Identifier: MIT
 * What joints carry when an axle stands still on the pads of a rig. The model's own equations say it: base held, all
 * coordinates driven and at rest, so that reactions of joints and the forces that drive the coordinates are those of
 * statics, linear in what acts on the bodies. Their exact derivatives by the force of each force element (an input) and
 * by force and torque at each wheel's centre (a port) are what a unit of these makes; gravity, tires and all else do
 * not enter. The pads take what travel coordinates would need, by virtual work. */
#include "run/kc_joints.h"

#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/engines.h"
#include "specialize/specialize.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

enum { WRENCH = 6 };

/* ---- the model ------------------------------------------------------------------------------------------ */

/* An element of the same place, whose force is an input of its own. */
static void twin(Pool *pool, Model *model, const Force *element)
{
    static const ForceType type[2] = {FORCE_POINTS_LAW, FORCE_AXIS_LAW};
    Law *law = pool_alloc(pool, sizeof *law);
    Force force = *element;
    *law = (Law){.op = LAW_INPUT, .index = model->inputs, .name = "kc", .size = 1};
    force.type = force.coordinate >= 0 ? FORCE_COORDINATE_LAW : type[force_is_torque(element)];
    force.stiffness = force.damping = force.free = force.low = force.high = force.fade = NULL;
    force.table = -1;
    force.law[0] = law;
    *POOL_PUSH(pool, model->force, model->forces) = force;
    *POOL_PUSH(pool, model->input, model->inputs) = (Input){.name = "kc", .unit = "N", .read = true};
}

/* The model without its outputs, with inputs and ports for what acts, with outputs for what carries. */
static Model *prepare(KcJoints *k, Pool *pool, const Model *model)
{
    Model *copy = pool_alloc(pool, sizeof *copy);
    *copy = *model;
    copy->output = NULL;
    copy->force = NULL;
    copy->input = NULL;
    copy->port = NULL;
    copy->outputs = copy->output_components = copy->forces = copy->inputs = copy->ports = 0;
    for (int i = 0; i < model->forces; ++i)
        *POOL_PUSH(pool, copy->force, copy->forces) = model->force[i];
    for (int i = 0; i < model->inputs; ++i)
        *POOL_PUSH(pool, copy->input, copy->inputs) = model->input[i];
    for (int i = 0; i < model->ports; ++i)
        *POOL_PUSH(pool, copy->port, copy->ports) = model->port[i];
    k->element = copy->inputs;
    k->port = copy->ports;
    for (int i = 0; i < model->forces; ++i)
        if (!force_is_wrench(&model->force[i]))
            twin(pool, copy, &model->force[i]);
    for (int a = 0; a < k->kc->axles; ++a)
        for (int i = 0; i < k->kc->axle[a].wheels; ++i) {
            const Wheel *wheel = k->kc->axle[a].wheel[i].wheel;
            Port port = {.name = "kc", .body = wheel->body, .in = BODY_GROUND};
            copy3(wheel->center, port.point);
            *POOL_PUSH(pool, copy->port, copy->ports) = port;
        }
    for (int j = 0; j < model->joints; ++j)
        kc_watch(pool, copy, (Output){.type = OUTPUT_REACTION, .index = j, .in = BODY_GROUND, .count = 6});
    k->drive = copy->output_components;
    for (int c = 0; c < model->coordinates; ++c)
        kc_watch(pool, copy, (Output){.type = OUTPUT_DRIVE_FORCE, .index = c, .count = 1});
    for (int j = 0; j < model->joints; ++j) {
        const Joint *joint = &model->joint[j];
        k->rod[j] = joint->type == JOINT_DISTANCE ? copy->output_components : -1;
        for (int end = 0; end < 2 && k->rod[j] >= 0; ++end) {
            Output output = {.type = OUTPUT_POSITION, .body = joint->body[end], .in = BODY_GROUND, .count = 3};
            copy3(joint->point[end], output.point);
            kc_watch(pool, copy, output);
        }
    }
    return copy;
}

KcJoints *kc_joints_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const Kc *kc)
{
    KcJoints *k = pool_alloc(pool, sizeof *k);
    int *coordinate = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof *coordinate), free = 0;
    *k = (KcJoints){.kc = kc, .joints = model->joints};
    k->rod = pool_alloc(pool, ((size_t)model->joints + 1) * sizeof *k->rod);
    k->name = pool_alloc(pool, ((size_t)model->joints + 1) * sizeof *k->name);
    for (int j = 0; j < model->joints; ++j)
        k->name[j] = model->joint[j].name;
    const Model *held = prepare(k, pool, model);
    if (held->free_base)
        held = model_hold(pool, held, held->body[BODY_BASE].position, held->body[BODY_BASE].euler);
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven)
            coordinate[free++] = c;
    k->model = model_drive(pool, held, coordinate, free);
    k->engine = engine_open(pool, "tape", k->model, &(EngineOptions){.solve = solve, .quiet = true});
    k->linear = linear_open(pool, k->engine);
    k->self = (Instance *)(void *)instance_new(pool, k->engine);
    const gic_model *code = k->engine->code;
    const int status = scene ? code->setup_with(k->self, scene->parameter) : code->setup(k->self);
    if (status != GIC_OK)
        diag_fail((Place){scene ? scene->source : model->source, 0, 0}, NULL, "the model can't be held on a rig: %s",
                  instance_status(pool, code, &k->self->head, status));
    const size_t room = ((size_t)k->linear->count + (size_t)k->model->output_components + 1) * sizeof(double);
    k->f = pool_alloc(pool, room);
    k->df = pool_alloc(pool, room);
    k->value = pool_alloc(pool, room);
    k->out = pool_alloc(pool, room);
    k->by_element = pool_alloc(pool, room * ((size_t)kc->elements + 1));
    k->by_wheel = pool_alloc(pool, room * WRENCH * KC_WHEELS);
    return k;
}

/* ---- a position ----------------------------------------------------------------------------------------- */

/* What units of all that acts on an axle make. */
typedef struct Unit {
    int outputs;
    double *element;          /* [elements][outputs] */
    double *wheel;            /* [wheels][WRENCH][outputs] of force and torque at the centre */
    double arm[KC_WHEELS][3]; /* from the centre to the contact */
} Unit;

KcLoad kc_case_load(int by)
{
    return (KcLoad)((by - KC_BY_LOADS) / 2);
}

bool kc_case_opposed(int by)
{
    return (by - KC_BY_LOADS) % 2;
}

/* Does an element act, and move with the axle? What acts along the steering itself is part of what holds it. */
static bool acts(const KcJoints *k, const KcAxle *axle, const KcLook *look, int e)
{
    bool moves = false;
    if (axle->steer >= 0 && k->kc->element[e].coordinate == axle->steer)
        return false;
    for (int c = 0; c < look->columns; ++c)
        moves = moves || fabs(kc_element_slope(&k->kc->element[e], look, c)) > 1e-9;
    return moves && look->value[k->kc->element[e].force] != 0;
}

static int find_units(const KcJoints *k, const KcAxle *axle, const double *w, const KcLook *look, Unit *unit)
{
    const gic_model *code = k->engine->code;
    double *input = tape_array(k->self, code->input_offset);
    bool jump;
    int port = k->port;
    for (int c = 0; c < code->coordinate_count; ++c) {
        input[code->coordinate_input[c]] = w[c];
        input[code->coordinate_input[c] + 1] = input[code->coordinate_input[c] + 2] = 0;
    }
    int status = linear_start(k->linear, k->self, k->f);
    if (status == GIC_OK)
        status = code->outputs(k->self);
    if (status == GIC_OK)
        memcpy(k->value, tape_array(k->self, code->output_offset), (size_t)unit->outputs * sizeof(double));
    for (int e = 0; e < k->kc->elements && status == GIC_OK; ++e)
        if (acts(k, axle, look, e))
            status = linear_column(k->linear, k->self, LINEAR_INPUT, k->element + e, k->df, unit->outputs,
                                   unit->element + e * unit->outputs, &jump);
    for (int a = 0; &k->kc->axle[a] != axle; ++a)
        port += k->kc->axle[a].wheels;
    for (int i = 0; i < axle->wheels; ++i) {
        KcPose pose;
        kc_pose(&axle->wheel[i], look, &pose);
        sub3(pose.contact, pose.centre, unit->arm[i]);
        for (int c = 0; c < WRENCH && status == GIC_OK; ++c)
            status = linear_column(k->linear, k->self, LINEAR_PORT, WRENCH * (port + i) + c, k->df, unit->outputs,
                                   unit->wheel + (WRENCH * i + c) * unit->outputs, &jump);
    }
    return status;
}

/* out += a force and a torque at the centre of wheel i. */
static void act(const Unit *unit, int i, const double force[3], const double torque[3], double *out)
{
    for (int c = 0; c < WRENCH; ++c)
        for (int o = 0; o < unit->outputs; ++o)
            out[o] += (c < 3 ? force[c] : torque[c - 3]) * unit->wheel[(WRENCH * i + c) * unit->outputs + o];
}

/* The same of a force at the contact, on the carrier. */
static void act_below(const Unit *unit, int i, const double force[3], double *out)
{
    double torque[3];
    cross3(unit->arm[i], force, torque);
    act(unit, i, force, torque, out);
}

/* out with forces of the pads, so that no travel coordinate needs one. pads: [wheels]. */
static bool put_pads(const KcJoints *k, const KcAxle *axle, const Unit *unit, double *out, double *pads)
{
    static const double up[3] = {0, 0, 1};
    const int n = axle->wheels;
    double A[KC_WHEELS * KC_WHEELS], one[unit->outputs + 1];
    for (int i = 0; i < n; ++i) {
        memset(one, 0, sizeof one);
        act_below(unit, i, up, one);
        for (int a = 0; a < n; ++a)
            A[a * n + i] = one[k->drive + axle->travel[a]];
        pads[i] = -out[k->drive + axle->travel[i]];
    }
    if (!kc_solve(n, A, pads))
        return false;
    for (int i = 0; i < n; ++i) {
        const double force[3] = {0, 0, pads[i]};
        act_below(unit, i, force, out);
    }
    return true;
}

static void load(const KcAxle *axle, const Unit *unit, KcLoad of, bool opposed, double *out)
{
    static const double none[3] = {0};
    for (int i = 0; i < axle->wheels; ++i) {
        const double size = opposed ? axle->wheel[i].side : 1;
        const double aside[3] = {0, size, 0}, forward[3] = {size, 0, 0}, up[3] = {0, 0, size};
        switch (of) {
        case KC_LATERAL: act_below(unit, i, aside, out); break;
        case KC_LONGITUDINAL: act_below(unit, i, forward, out); break;
        case KC_ALIGNING: act(unit, i, none, up, out); break;
        case KC_HUB_LATERAL: act(unit, i, aside, none, out); break;
        case KC_HUB_VERTICAL: act(unit, i, up, none, out); break;
        default: act(unit, i, forward, none, out); break;
        }
    }
}

static void carry(const KcJoints *k, const KcAxle *axle, const double *out, KcCarried *carried)
{
    for (int j = 0; j < k->joints; ++j) {
        KcCarried *at = &carried[j];
        copy3(out + 6 * j, at->force);
        copy3(out + 6 * j + 3, at->torque);
        at->along = NAN;
        if (k->rod[j] >= 0) { /* the second body is drawn to the first one */
            double line[3];
            sub3(k->value + k->rod[j], k->value + k->rod[j] + 3, line);
            at->along = dot3(at->force, line) / norm3(line);
        }
    }
    carried[k->joints] = (KcCarried){.force = {NAN, NAN, NAN},
                                     .torque = {NAN, NAN, NAN},
                                     .along = axle->steer >= 0 ? out[k->drive + axle->steer] : NAN};
}

/* What springs make, with the pads. springs: [outputs]. Returns a status. */
static int by_springs(const KcJoints *k, const KcAxle *axle, const double *w, KcLook *look, Unit *unit, double *springs,
                      double *pads)
{
    int status = kc_look(k->kc, w, look);
    if (status == GIC_OK)
        status = find_units(k, axle, w, look, unit);
    memset(springs, 0, (size_t)unit->outputs * sizeof *springs);
    for (int e = 0; e < k->kc->elements && status == GIC_OK; ++e)
        for (int o = 0; o < unit->outputs && acts(k, axle, look, e); ++o)
            springs[o] += look->value[k->kc->element[e].force] * unit->element[e * unit->outputs + o];
    if (status == GIC_OK && !put_pads(k, axle, unit, springs, pads))
        status = GIC_ERROR_SINGULAR;
    return status;
}

static KcCarried nothing_known(void)
{
    return (KcCarried){.force = {NAN, NAN, NAN}, .torque = {NAN, NAN, NAN}, .along = NAN};
}

static void add(const KcCarried *a, double scale, KcCarried *sum)
{
    add_scaled3(scale, a->force, sum->force);
    add_scaled3(scale, a->torque, sum->torque);
    sum->along += scale * a->along;
}

/* One newton more on the pads, which the springs take: central differences over a small travel of each wheel. Returns a
 * status. */
static int vertical(const KcJoints *k, const KcAxle *axle, const double *w, const KcLook *here, Unit *unit,
                    KcCarried *carried)
{
    static const double step = 1e-5; /* m */
    const int n = axle->wheels, all = k->joints + 1;
    const size_t size = (size_t)k->kc->model->coordinates * sizeof *w;
    double A[KC_WHEELS * KC_WHEELS] = {0}, *there = pool_alloc(k->kc->pool, size), out[unit->outputs + 1];
    KcCarried *slope = pool_alloc(k->kc->pool, ((size_t)(n * all) + 1) * sizeof *slope), end[all];
    KcLook *look = kc_look_new(k->kc, axle);
    for (int a = 0; a < n; ++a) {
        double vz[KC_WHEELS] = {0}, along[KC_WHEELS + 1], pads[KC_WHEELS];
        vz[a] = 1;
        if (!kc_along(axle, here, false, vz, 0, along))
            return GIC_ERROR_SINGULAR;
        for (int side = -1; side <= 1; side += 2) {
            memcpy(there, w, size);
            kc_move(here, along, side * step, there);
            const int status = by_springs(k, axle, there, look, unit, out, pads);
            if (status != GIC_OK)
                return status;
            carry(k, axle, out, end);
            for (int i = 0; i < n; ++i)
                A[i * n + a] += side * pads[i] / (2 * step);
            for (int j = 0; j < all; ++j)
                add(&end[j], side / (2 * step), &slope[a * all + j]);
        }
    }
    for (int opposed = 0; opposed < 2; ++opposed) {
        KcCarried *to = carried + (KC_BY_LOADS + 2 * KC_VERTICAL + opposed) * all;
        double travel[KC_WHEELS], again[KC_WHEELS * KC_WHEELS];
        memcpy(again, A, sizeof A);
        for (int i = 0; i < n; ++i)
            travel[i] = opposed ? axle->wheel[i].side : 1;
        const bool held = kc_solve(n, again, travel) && gic_finite(travel, n);
        for (int j = 0; j < all; ++j) {
            to[j] = held ? (KcCarried){.along = 0} : nothing_known();
            for (int a = 0; a < n && held; ++a)
                add(&slope[a * all + j], travel[a], &to[j]);
        }
    }
    return GIC_OK;
}

const char *kc_joints_refusal(const KcAxle *axle)
{
    return axle->preload
               ? "its wheels hang on rubber, which shares loads among joints by its stiffness; outputs of type "
                 "`reaction` tell what these carry in a scene"
               : NULL;
}

int kc_joints_at(const KcJoints *k, const KcAxle *axle, const double *w, KcCarried *carried, double *pads)
{
    const int all = k->joints + 1;
    Unit unit = {.outputs = k->model->output_components, .element = k->by_element, .wheel = k->by_wheel};
    double force[KC_WHEELS], *out = k->out;
    KcLook *look = kc_look_new(k->kc, axle);
    int status = by_springs(k, axle, w, look, &unit, out, pads ? pads : force);
    if (status != GIC_OK)
        return status;
    carry(k, axle, out, carried);
    for (int by = KC_BY_LOADS; by < KC_CASES; ++by) {
        if (kc_case_load(by) == KC_VERTICAL)
            continue;
        memset(out, 0, (size_t)unit.outputs * sizeof *out);
        load(axle, &unit, kc_case_load(by), kc_case_opposed(by), out);
        if (!put_pads(k, axle, &unit, out, force))
            return GIC_ERROR_SINGULAR;
        carry(k, axle, out, carried + by * all);
    }
    return vertical(k, axle, w, look, &unit, carried);
}

/* ---- names ---------------------------------------------------------------------------------------------- */

bool kc_joint_seen(const KcJoints *k, const KcCarried *carried, int j)
{
    static const double least = 1e-9; /* N by a unit of a load, or by springs */
    const int all = k->joints + 1;
    for (int by = 0; by < KC_CASES; ++by) {
        const KcCarried *at = &carried[by * all + j];
        if (j == k->joints ? !isnan(at->along) : norm3(at->force) > least || norm3(at->torque) > least)
            return true;
    }
    return false;
}

const char *kc_joint_name(const KcJoints *k, const KcAxle *axle, int j)
{
    return j < k->joints ? k->name[j] : axle->steer >= 0 ? k->model->coordinate[axle->steer].name : "";
}
