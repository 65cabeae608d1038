/* SPDX-License-Identifier: MIT
 * What joints carry when an axle stands still on the pads of a rig. The model's own equations say it: base held, all
 * coordinates driven and at rest, so that reactions R of joints and the forces that drive the coordinates are those of
 * statics, linear in what acts on the bodies: R = R_0(w) + B(w) u. u: forces of elements (inputs), force and torque at
 * each wheel's centre and of bushings at both their ends (ports); B is found by exact derivatives, and what is R_0,
 * gravity, tires and all else, does not enter. Where the axle balances (kc_balance.c) no coordinate that moves needs a
 * force. A load changes it by w' and u', and R by B u' + (dB/dw w') u, of which the last is the difference of the exact
 * derivatives of R by w with u and without. */
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
    for (int r = 0; r < 2 * k->kc->rubbers; ++r) {
        const Force *rubber = k->kc->rubber[r / 2].force;
        k->mount[r] = rubber->body[r % 2] == BODY_GROUND ? -1 : copy->ports;
        if (k->mount[r] < 0)
            continue;
        Port port = {.name = "kc", .body = rubber->body[r % 2], .in = BODY_GROUND};
        copy3(rubber->point[r % 2], port.point);
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
    *k = (KcJoints){.kc = kc, .joints = model->joints + kc->rubbers, .reactions = model->joints};
    k->rod = pool_alloc(pool, ((size_t)k->joints + 1) * sizeof *k->rod);
    k->name = pool_alloc(pool, ((size_t)k->joints + 1) * sizeof *k->name);
    k->mount = pool_alloc(pool, (2 * (size_t)kc->rubbers + 1) * sizeof *k->mount);
    k->balance = pool_alloc(pool, ((size_t)kc->axles + 1) * sizeof(KcBalance *));
    for (int a = 0; a < kc->axles; ++a)
        if (!kc->axle[a].refusal)
            k->balance[a] = kc_balance_new(kc, &kc->axle[a], kc->axle[a].preload != NULL, kc->axle[a].steer);
    for (int j = 0; j < model->joints; ++j)
        k->name[j] = model->joint[j].name;
    for (int r = 0; r < kc->rubbers; ++r) {
        k->name[model->joints + r] = kc->rubber[r].force->name;
        k->rod[model->joints + r] = -1;
    }
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
    k->by_mount = pool_alloc(pool, room * (2 * WRENCH * (size_t)kc->rubbers + 1));
    k->by_place = pool_alloc(pool, room * KC_COLUMNS);
    k->acting = pool_alloc(pool, ((size_t)kc->elements + 1 + 2 * WRENCH * (size_t)kc->rubbers) * sizeof *k->acting);
    return k;
}

/* ---- a place ---------------------------------------------------------------------------------------------- */

KcLoad kc_case_load(int by)
{
    return (KcLoad)((by - KC_BY_LOADS) / 2);
}

bool kc_case_opposed(int by)
{
    return (by - KC_BY_LOADS) % 2;
}

/* An axle where it balances. */
typedef struct Stand {
    const KcJoints *k;
    const KcAxle *axle;
    const KcBalance *balance;
    int outputs, port;        /* port: of the axle's first wheel */
    double arm[KC_WHEELS][3]; /* from the centre to the contact */
    double *element;          /* [elements][outputs] by a unit of what acts */
    double *wheel;            /* [wheels][WRENCH][outputs] */
    double *mount;            /* [bushings][2][WRENCH][outputs] */
    double *place;            /* [columns][outputs] by coordinates that move, of what acts alone */
} Stand;

/* What acts, u, or its change by a load. */
typedef struct Acting {
    double *element;                 /* [elements] N or N m */
    double wheel[KC_WHEELS][WRENCH]; /* force and torque at the centre */
    double (*mount)[WRENCH];         /* [bushings][2] on both bodies */
} Acting;

/* Does an element act, and move with the axle? What acts along the steering itself is part of what holds it. */
static bool acts(const Stand *stand, int e)
{
    const KcElement *element = &stand->k->kc->element[e];
    const KcLook *look = stand->balance->look;
    bool moves = false;
    if (stand->axle->steer >= 0 && element->coordinate == stand->axle->steer)
        return false;
    for (int c = 0; c < look->columns; ++c)
        moves = moves || fabs(kc_element_slope(element, look, c)) > 1e-9;
    return moves;
}

/* Does a bushing bend with the axle? */
static bool bends(const Stand *stand, int r)
{
    const KcRubber *rubber = &stand->k->kc->rubber[r];
    const KcLook *look = stand->balance->look;
    const KcBent bent = kc_bend(rubber, look);
    double rate[BUSHING_AXES];
    for (int c = 0; c < look->columns; ++c) {
        kc_bend_rate(rubber, &bent, look, c, rate);
        if (norm3(rate) + norm3(rate + 3) > 1e-9)
            return true;
    }
    return false;
}

/* The derivatives of all outputs, and of the first of them, by an input or a port. */
static int differentiate(const Stand *stand, LinearKind kind, int number, double *out)
{
    bool jump;
    return linear_column(stand->k->linear, stand->k->self, kind, number, stand->k->df, stand->outputs, out, &jump);
}

/* Six columns of a port. */
static int by_port(const Stand *stand, int port, double *out)
{
    int status = GIC_OK;
    for (int c = 0; c < WRENCH && status == GIC_OK; ++c)
        status = differentiate(stand, LINEAR_PORT, WRENCH * port + c, out + c * stand->outputs);
    return status;
}

/* stand->place += sign times the derivatives by coordinates. */
static int by_places(const Stand *stand, double sign)
{
    const KcLook *look = stand->balance->look;
    const gic_model *code = stand->k->engine->code;
    int status = GIC_OK;
    for (int c = 0; c < look->columns && status == GIC_OK; ++c) {
        status = differentiate(stand, LINEAR_INPUT, code->coordinate_input[look->column[c]], stand->k->out);
        for (int o = 0; o < stand->outputs; ++o)
            stand->place[c * stand->outputs + o] += sign * stand->k->out[o];
    }
    return status;
}

/* Forces and torques, of wheels and of bushings, into ports, those of elements into inputs. */
static void put(const Stand *stand, const Acting *u)
{
    const KcJoints *k = stand->k;
    double *input = tape_array(k->self, k->engine->code->input_offset);
    double *port = tape_array(k->self, k->engine->code->port_offset);
    for (int e = 0; e < k->kc->elements; ++e)
        input[k->element + e] = u ? u->element[e] : 0;
    for (int i = 0; i < stand->axle->wheels; ++i)
        for (int c = 0; c < WRENCH; ++c)
            port[WRENCH * (stand->port + i) + c] = u ? u->wheel[i][c] : 0;
    for (int r = 0; r < 2 * k->kc->rubbers; ++r)
        for (int c = 0; c < WRENCH && k->mount[r] >= 0; ++c)
            port[WRENCH * k->mount[r] + c] = u ? u->mount[r][c] : 0;
}

/* B, and derivatives by places. Returns a status. */
static int find_units(const Stand *stand, const Acting *u)
{
    const KcJoints *k = stand->k;
    const gic_model *code = k->engine->code;
    double *input = tape_array(k->self, code->input_offset);
    for (int c = 0; c < code->coordinate_count; ++c) {
        input[code->coordinate_input[c]] = stand->balance->w[c];
        input[code->coordinate_input[c] + 1] = input[code->coordinate_input[c] + 2] = 0;
    }
    memset(stand->place, 0, (size_t)(stand->balance->m * stand->outputs) * sizeof *stand->place);
    put(stand, u);
    int status = linear_start(k->linear, k->self, k->f);
    if (status == GIC_OK)
        status = by_places(stand, 1);
    put(stand, NULL);
    if (status == GIC_OK)
        status = linear_start(k->linear, k->self, k->f);
    if (status == GIC_OK)
        status = code->outputs(k->self);
    if (status == GIC_OK)
        status = by_places(stand, -1);
    memcpy(k->value, tape_array(k->self, code->output_offset), (size_t)stand->outputs * sizeof(double));
    for (int e = 0; e < k->kc->elements && status == GIC_OK; ++e)
        if (acts(stand, e))
            status = differentiate(stand, LINEAR_INPUT, k->element + e, stand->element + e * stand->outputs);
    for (int i = 0; i < stand->axle->wheels && status == GIC_OK; ++i)
        status = by_port(stand, stand->port + i, stand->wheel + WRENCH * i * stand->outputs);
    for (int r = 0; r < 2 * k->kc->rubbers && status == GIC_OK; ++r)
        if (k->mount[r] >= 0 && bends(stand, r / 2))
            status = by_port(stand, k->mount[r], stand->mount + WRENCH * r * stand->outputs);
    return status;
}

/* ---- what acts -------------------------------------------------------------------------------------------- */

static Acting nothing_acts(const KcJoints *k)
{
    Acting u = {.element = k->acting};
    u.mount = (double(*)[WRENCH])(k->acting + k->kc->elements + 1);
    memset(k->acting, 0, ((size_t)k->kc->elements + 1 + 2 * WRENCH * (size_t)k->kc->rubbers) * sizeof *k->acting);
    return u;
}

/* A force on wheel i at the contact, on the carrier. */
static void push(const Stand *stand, int i, const double force[3], Acting *u)
{
    double torque[3];
    cross3(stand->arm[i], force, torque);
    add3(u->wheel[i], force, u->wheel[i]);
    add3(u->wheel[i] + 3, torque, u->wheel[i] + 3);
}

/* Elements, bushings and pads where the axle balances. */
static Acting all_that_acts(const Stand *stand)
{
    const KcJoints *k = stand->k;
    const KcLook *look = stand->balance->look;
    const double still[KC_COLUMNS] = {0};
    Acting u = nothing_acts(k);
    for (int e = 0; e < k->kc->elements; ++e)
        if (acts(stand, e))
            u.element[e] = look->value[k->kc->element[e].force];
    for (int i = 0; i < stand->axle->wheels; ++i)
        push(stand, i, (double[3]){0, 0, stand->balance->force[i]}, &u);
    for (int r = 0; r < k->kc->rubbers; ++r) {
        KcWrench wrench;
        if (!bends(stand, r))
            continue;
        kc_rubber_wrench(&k->kc->rubber[r], look, still, &wrench);
        memcpy(u.mount[2 * r], wrench.on, sizeof wrench.on);
    }
    return u;
}

static void load_wheel(const Stand *stand, int i, KcLoad of, double size, Acting *u)
{
    double *force = u->wheel[i];
    switch (of) {
    case KC_LATERAL: push(stand, i, (double[3]){0, size, 0}, u); break;
    case KC_LONGITUDINAL: push(stand, i, (double[3]){size, 0, 0}, u); break;
    case KC_VERTICAL: break; /* the pads', which grow by it */
    case KC_ALIGNING: force[5] += size; break;
    case KC_HUB_LATERAL: force[1] += size; break;
    case KC_HUB_VERTICAL: force[2] += size; break;
    default: force[0] += size; break;
    }
}

/* What a load changes: itself, the pads' forces, and what elements, bushings and the places of the pads change while
 * the axle gives way. change: of kc_balance_give(). */
static Acting all_that_changes(const Stand *stand, KcLoad load, bool opposed, const double *change)
{
    const KcJoints *k = stand->k;
    const KcBalance *balance = stand->balance;
    const KcLook *look = balance->look;
    double along[KC_COLUMNS] = {0};
    Acting u = nothing_acts(k);
    memcpy(along, change, (size_t)balance->m * sizeof *along);
    for (int e = 0; e < k->kc->elements; ++e)
        for (int c = 0; c < look->columns && acts(stand, e); ++c)
            u.element[e] += along[c] * look->slope[c * look->outputs + k->kc->element[e].force];
    for (int i = 0; i < stand->axle->wheels; ++i) {
        KcPose rate;
        double arm[3], torque[3];
        load_wheel(stand, i, load, opposed ? stand->axle->wheel[i].side : 1, &u);
        push(stand, i, (double[3]){0, 0, change[balance->m + i]}, &u);
        kc_rate(&stand->axle->wheel[i], look, &balance->pose[i], along, &rate);
        sub3(rate.contact, rate.centre, arm);
        cross3(arm, (double[3]){0, 0, balance->force[i]}, torque);
        add3(u.wheel[i] + 3, torque, u.wheel[i] + 3);
    }
    for (int r = 0; r < k->kc->rubbers; ++r) {
        KcWrench wrench;
        if (!bends(stand, r))
            continue;
        kc_rubber_wrench(&k->kc->rubber[r], look, along, &wrench);
        memcpy(u.mount[2 * r], wrench.rate, sizeof wrench.rate);
    }
    return u;
}

/* out = B u */
static void respond(const Stand *stand, const Acting *u, double *out)
{
    const int outputs = stand->outputs;
    memset(out, 0, (size_t)outputs * sizeof *out);
    for (int o = 0; o < outputs; ++o) {
        for (int e = 0; e < stand->k->kc->elements; ++e)
            if (u->element[e] != 0)
                out[o] += u->element[e] * stand->element[e * outputs + o];
        for (int i = 0; i < stand->axle->wheels; ++i)
            for (int c = 0; c < WRENCH; ++c)
                out[o] += u->wheel[i][c] * stand->wheel[(WRENCH * i + c) * outputs + o];
        for (int r = 0; r < 2 * stand->k->kc->rubbers; ++r)
            for (int c = 0; c < WRENCH && stand->k->mount[r] >= 0; ++c)
                if (u->mount[r][c] != 0)
                    out[o] += u->mount[r][c] * stand->mount[(WRENCH * r + c) * outputs + o];
    }
}

/* ---- what carries ----------------------------------------------------------------------------------------- */

static void carry(const Stand *stand, const Acting *u, const double *out, KcCarried *carried)
{
    const KcJoints *k = stand->k;
    for (int j = 0; j < k->joints; ++j) {
        KcCarried *at = &carried[j];
        const double *on = j < k->reactions ? out + 6 * j : u->mount[2 * (j - k->reactions) + 1];
        copy3(on, at->force);
        copy3(on + 3, at->torque);
        at->along = NAN;
        if (k->rod[j] >= 0) { /* the second body is drawn to the first one, along the line, also while that turns */
            double line[3];
            sub3(k->value + k->rod[j], k->value + k->rod[j] + 3, line);
            at->along = dot3(at->force, line) / norm3(line);
        }
    }
    carried[k->joints] = (KcCarried){.force = {NAN, NAN, NAN},
                                     .torque = {NAN, NAN, NAN},
                                     .along = stand->axle->steer >= 0 ? out[k->drive + stand->axle->steer] : NAN};
}

/* What is known of no joint. */
static KcCarried nothing_known(void)
{
    return (KcCarried){.force = {NAN, NAN, NAN}, .torque = {NAN, NAN, NAN}, .along = NAN};
}

/* Of one load. Returns NULL, or why nothing is known. */
static const char *by_load(const Stand *stand, KcLoad load, bool opposed, KcCarried *carried)
{
    const KcJoints *k = stand->k;
    double change[KC_BALANCE];
    const char *why = kc_balance_give(stand->balance, load, opposed, load == KC_VERTICAL, change);
    for (int j = 0; j <= k->joints && why && load == KC_VERTICAL; ++j)
        carried[j] = nothing_known();
    if (why)
        return load == KC_VERTICAL ? NULL : why;
    const Acting u = all_that_changes(stand, load, opposed, change);
    respond(stand, &u, k->out);
    for (int c = 0; c < stand->balance->m; ++c)
        for (int o = 0; o < stand->outputs; ++o)
            k->out[o] += change[c] * stand->place[c * stand->outputs + o];
    carry(stand, &u, k->out, carried);
    return NULL;
}

const char *kc_joints_refusal(const KcJoints *k, const KcAxle *axle)
{
    (void)axle;
    return kc_rubber_formula(k->kc) ? pool_print(k->kc->pool,
                                                 "bushing '%s' has a formula, of which no stiffness is "
                                                 "known; give it `stiffness`",
                                                 kc_rubber_formula(k->kc))
                                    : NULL;
}

const char *kc_joints_at(const KcJoints *k, const KcAxle *axle, const double *w, KcCarried *carried)
{
    KcBalance *balance = k->balance[axle - k->kc->axle];
    Stand stand = {.k = k,
                   .axle = axle,
                   .balance = balance,
                   .outputs = k->model->output_components,
                   .port = k->port,
                   .element = k->by_element,
                   .wheel = k->by_wheel,
                   .mount = k->by_mount,
                   .place = k->by_place};
    const char *why = kc_balance_at(balance, w);
    if (why)
        return why;
    for (const KcAxle *before = k->kc->axle; before != axle; ++before)
        stand.port += before->wheels;
    for (int i = 0; i < axle->wheels; ++i)
        sub3(balance->pose[i].contact, balance->pose[i].centre, stand.arm[i]);
    const Acting u = all_that_acts(&stand);
    const int status = find_units(&stand, &u);
    if (status != GIC_OK)
        return instance_status(k->kc->pool, k->engine->code, &k->self->head, status);
    respond(&stand, &u, k->out);
    carry(&stand, &u, k->out, carried);
    for (int by = KC_BY_LOADS; by < KC_CASES && !why; ++by)
        why = by_load(&stand, kc_case_load(by), kc_case_opposed(by), carried + by * (k->joints + 1));
    return why;
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
    if (j < k->joints || axle->steer < 0)
        return j < k->joints ? k->name[j] : "";
    const char *name = k->model->coordinate[axle->steer].name;
    for (int i = 0; i < k->joints; ++i)
        if (!strcmp(k->name[i], name))
            return pool_print(k->kc->pool, "%s (steering)", name);
    return name;
}
