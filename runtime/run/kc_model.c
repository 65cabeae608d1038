/* SPDX-License-Identifier: MIT
 * The axles of a model: which wheels, which coordinates move them, which one steers; and the outputs that measure them.
 * Nothing is known by name: wheels of nearly the same x are an axle, and the velocities that unit rates of the
 * coordinates give to the wheels say what a coordinate does. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/engines.h"
#include "run/kc.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Below this, relative to what the wheel's radius and the coordinate's range make of it, a coordinate does nothing. */
static const double nothing = 1e-9;

/* ---- outputs and force elements that measure ------------------------------------------------------------ */

int kc_watch(Pool *pool, Model *model, Output output)
{
    const int at = model->output_components;
    output.name = "kc";
    output.hidden = true;
    for (int i = 0; i < output.count; ++i)
        output.component[i] = output.unit[i] = "";
    *POOL_PUSH(pool, model->output, model->outputs) = output;
    model->output_components += output.count;
    return at;
}

static int watch_point(Pool *pool, Model *model, OutputType type, int body, const double point[3])
{
    Output output = {.type = type, .body = body, .in = BODY_GROUND, .count = 3};
    copy3(point, output.point);
    return kc_watch(pool, model, output);
}

static int watch_force(Pool *pool, Model *model, int force)
{
    return kc_watch(pool, model, (Output){.type = OUTPUT_FORCE, .index = force, .count = 1});
}

/* A force element whose tension is the length between two points or its rate, or the angle about an axis or its rate:
 * what it does to the accelerations is not looked at. */
static int probe(Pool *pool, Model *model, const Force *element, bool rate)
{
    Law *law = pool_alloc(pool, sizeof *law);
    *law = (Law){.op = LAW_LOCAL, .index = rate, .name = rate ? "speed" : "length", .size = 1};
    Force force = *element;
    force.type = force_is_torque(element) ? FORCE_AXIS_LAW : FORCE_POINTS_LAW;
    force.stiffness = force.damping = force.free = force.low = force.high = force.fade = NULL;
    force.table = -1;
    force.law[0] = law;
    *POOL_PUSH(pool, model->force, model->forces) = force;
    return watch_force(pool, model, model->forces - 1);
}

static void watch_rubber(Kc *kc, Model *model, const Force *force)
{
    KcRubber rubber = {.force = force};
    for (int end = 0; end < 2; ++end) {
        const int body = force->body[end];
        if (body == BODY_GROUND)
            continue;
        rubber.place[end] = watch_point(kc->pool, model, OUTPUT_POSITION, body, force->point[end]);
        rubber.velocity[end] = watch_point(kc->pool, model, OUTPUT_VELOCITY, body, force->point[end]);
        rubber.turn[end] = kc_watch(
            kc->pool, model, (Output){.type = OUTPUT_ANGULAR_VELOCITY, .body = body, .in = BODY_GROUND, .count = 3});
        rubber.orientation[end] = kc_watch(
            kc->pool, model, (Output){.type = OUTPUT_ORIENTATION, .body = body, .in = BODY_GROUND, .count = 4});
    }
    *POOL_PUSH(kc->pool, kc->rubber, kc->rubbers) = rubber;
}

static void add_element(Kc *kc, Model *model, const Force *force, int index)
{
    KcElement element = {.name = force->name, .coordinate = force->coordinate, .value = -1, .rate = -1, .sign = 1};
    if (force->type == FORCE_BUSHING)
        watch_rubber(kc, model, force);
    if (force_is_wrench(force))
        return;
    element.force = watch_force(kc->pool, model, index);
    if (force->coordinate < 0) {
        element.sign = -1;
        element.angle = force_is_torque(force);
        element.value = probe(kc->pool, model, force, false);
        element.rate = probe(kc->pool, model, force, true);
    } else {
        element.angle = model->coordinate[force->coordinate].type == COORDINATE_ANGLE;
    }
    *POOL_PUSH(kc->pool, kc->element, kc->elements) = element;
}

/* The axis of a wheel, to the left, in its body's frame: the tire's, or else y of the drawing. */
static void axis_of(const Model *model, const Wheel *wheel, double axis[3])
{
    static const double left[3] = {0, 1, 0};
    double A[9], world[3];
    mat_from_euler(model->body[wheel->body].euler, A);
    if (wheel->tire < 0) {
        apply3_transposed(A, left, axis);
        return;
    }
    apply3(A, wheel->axis, world);
    for (int i = 0; i < 3; ++i)
        axis[i] = world[1] < 0 ? -wheel->axis[i] : wheel->axis[i];
}

static double radius_of(const Model *model, const Wheel *wheel)
{
    return wheel->tire >= 0 ? model->tire[wheel->tire].radius : wheel->radius;
}

static KcWheel watch_wheel(Kc *kc, Model *model, const Wheel *wheel)
{
    double axis[3], tip[3];
    axis_of(model, wheel, axis);
    add3(wheel->center, axis, tip);
    return (KcWheel){
        .wheel = wheel,
        .name = wheel->name,
        .radius = radius_of(model, wheel),
        .shaft = wheel->tire < 0 || wheel->drive_body != wheel->body,
        .centre = watch_point(kc->pool, model, OUTPUT_POSITION, wheel->body, wheel->center),
        .velocity = watch_point(kc->pool, model, OUTPUT_VELOCITY, wheel->body, wheel->center),
        .tip = watch_point(kc->pool, model, OUTPUT_POSITION, wheel->body, tip),
        .turn =
            kc_watch(kc->pool, model,
                     (Output){.type = OUTPUT_ANGULAR_VELOCITY, .body = wheel->body, .in = BODY_GROUND, .count = 3})};
}

/* ---- axles ---------------------------------------------------------------------------------------------- */

typedef struct Placed {
    double x, y;
    int index;
    const Wheel *wheel; /* NULL: joined to another one */
    int parts;          /* of dual wheels */
    const Wheel *part[KC_WHEELS];
} Placed;

static int by_x(const void *a, const void *b)
{
    const Placed *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? 1 : -1;
    return p->index - q->index;
}

double kc_middle_of(const Model *model)
{
    double low = INFINITY, high = -INFINITY;
    for (int w = 0; w < model->wheels; ++w) {
        const Body *body = &model->body[model->wheel[w].body];
        double A[9], at[3];
        mat_from_euler(body->euler, A);
        apply3(A, model->wheel[w].center, at);
        low = fmin(low, at[1] + body->position[1]);
        high = fmax(high, at[1] + body->position[1]);
    }
    return (low + high) / 2;
}

int kc_side(const Kc *kc, double y)
{
    static const double midway = 1e-3; /* m */
    return fabs(y - kc->middle) < midway ? 0 : y > kc->middle ? 1 : -1;
}

/* Do two wheels turn about one line on one body, with one radius, on one side? */
static bool is_twin(const Kc *kc, const Model *model, const Placed *a, const Placed *b)
{
    const Wheel *one = &model->wheel[a->index], *other = &model->wheel[b->index];
    double first[3], second[3], line[3], across[3];
    if (one->body != other->body || kc_side(kc, a->y) != kc_side(kc, b->y) ||
        radius_of(model, one) != radius_of(model, other))
        return false;
    axis_of(model, one, first);
    axis_of(model, other, second);
    sub3(other->center, one->center, line);
    cross3(first, second, across);
    const double turned = norm3(across);
    cross3(first, line, across);
    return turned < nothing && norm3(across) < nothing * radius_of(model, one);
}

/* Dual wheels become one in the middle of them, where the first of them was. Returns the number that is left. */
static int join_twins(Kc *kc, const Model *model, Placed *placed)
{
    int left = 0;
    for (int i = 0; i < model->wheels; ++i) {
        Wheel *joined = pool_alloc(kc->pool, sizeof *joined);
        if (!placed[i].wheel)
            continue;
        *joined = *placed[i].wheel;
        for (int j = i + 1; j < model->wheels; ++j) {
            if (!placed[j].wheel || placed[i].parts == KC_WHEELS || !is_twin(kc, model, &placed[i], &placed[j]))
                continue;
            add3(joined->center, placed[j].wheel->center, joined->center);
            joined->name = pool_print(kc->pool, "%s+%s", joined->name, placed[j].wheel->name);
            placed[i].part[placed[i].parts++] = placed[j].wheel;
            placed[j].wheel = NULL;
        }
        for (int k = 0; k < 3; ++k)
            joined->center[k] /= placed[i].parts;
        placed[i].wheel = placed[i].parts > 1 ? joined : placed[i].wheel;
        placed[left++] = placed[i];
    }
    return left;
}

/* Wheels from the foremost back; one that is less than its radius behind the first of an axle belongs to it. */
static void find_axles(Kc *kc, Model *model)
{
    Placed *placed = pool_alloc(kc->pool, ((size_t)model->wheels + 1) * sizeof *placed);
    for (int i = 0; i < model->wheels; ++i) {
        const Body *body = &model->body[model->wheel[i].body];
        double A[9], at[3];
        mat_from_euler(body->euler, A);
        apply3(A, model->wheel[i].center, at);
        placed[i] =
            (Placed){at[0] + body->position[0], at[1] + body->position[1], i, &model->wheel[i], 1, {&model->wheel[i]}};
    }
    qsort(placed, (size_t)model->wheels, sizeof *placed, by_x);
    kc->middle = kc_middle_of(model);
    double first = 0;
    const int wheels = join_twins(kc, model, placed);
    for (int i = 0; i < wheels; ++i) {
        KcWheel wheel = watch_wheel(kc, model, placed[i].wheel);
        wheel.side = kc_side(kc, placed[i].y) < 0 ? -1 : 1;
        wheel.parts = placed[i].parts;
        memcpy(wheel.part, placed[i].part, sizeof wheel.part);
        KcAxle *axle = kc->axles ? &kc->axle[kc->axles - 1] : NULL;
        if (!axle || first - placed[i].x >= wheel.radius || axle->wheels == KC_WHEELS) {
            axle = POOL_PUSH(kc->pool, kc->axle, kc->axles);
            *axle = (KcAxle){.number = kc->axles, .steer = -1};
            first = placed[i].x;
        }
        axle->wheel[axle->wheels++] = wheel;
    }
    for (int i = 0; i < kc->axles; ++i)
        kc->axle[i].name = kc->axles == 1       ? "axle"
                           : i == 0             ? "front"
                           : i == kc->axles - 1 ? "rear"
                                                : pool_print(kc->pool, "axle_%d", i + 1);
}

/* ---- what coordinates do -------------------------------------------------------------------------------- */

/* What unit rates of all coordinates do to an axle's wheels: [wheels][coordinates], times the coordinates' ranges.
 * lift, aside: velocities of the centres along z and y; turn: angular velocities. */
typedef struct Effects {
    double *lift, *aside, (*turn)[3];
} Effects;

/* Coordinates that change nothing that a force element acts along, such as the heave of a body on a rig, are taken for
 * travel after all others. */
static const double unsprung = 1e-3;

static bool is_sprung(const Kc *kc, int coordinate, const double *slope)
{
    for (int e = 0; e < kc->elements; ++e)
        if (kc->element[e].coordinate >= 0 ? kc->element[e].coordinate == coordinate
                                           : fabs(slope[kc->element[e].rate]) > nothing)
            return true;
    return false;
}

static double width(const Coordinate *coordinate)
{
    return coordinate->range[1] - coordinate->range[0];
}

/* A coordinate that turns a whole unit, such as a trailer, turns all wheels of an axle alike about the vertical, by
 * more than this altogether, rad, about an axis that is further from the axle than this, in radii of its wheels: what
 * rubber gives turns less, and what steers an axle turns it near its middle. */
static const double unit_turns = 0.35, unit_apart = 2;

/* Does it? Of coordinate c, that nothing drives. */
static bool turns_unit(const KcAxle *axle, const Effects *effects, int all, int c)
{
    const double *first = effects->turn[c];
    double aside = 0;
    for (int i = 0; i < axle->wheels; ++i) {
        double apart[3];
        sub3(effects->turn[i * all + c], first, apart);
        if (norm3(apart) > nothing * norm3(first))
            return false;
        aside += effects->aside[i * all + c] / axle->wheels;
    }
    return fabs(first[2]) > unit_turns && fabs(first[2]) > 0.9 * norm3(first) &&
           fabs(aside / first[2]) > unit_apart * axle->wheel[0].radius;
}

static void find_unit(const Kc *kc, KcAxle *axle, const Effects *effects)
{
    const int all = kc->model->coordinates;
    for (int c = 0; c < all && !axle->unit; ++c)
        if (!kc->model->coordinate[c].driven && turns_unit(axle, effects, all, c))
            axle->unit = kc->model->coordinate[c].name;
}

/* The largest number that is left, of rows and columns not yet taken, becomes the next pivot; its row is eliminated
 * from the others. Returns the number of pivots. */
static int choose(const KcAxle *axle, int coordinates, double *lift, int *travel)
{
    bool row_taken[KC_WHEELS] = {false};
    int rank = 0;
    for (; rank < axle->wheels; ++rank) {
        int row = -1, column = -1;
        double most = 0;
        for (int i = 0; i < axle->wheels; ++i)
            for (int c = 0; c < coordinates && !row_taken[i]; ++c)
                if (fabs(lift[i * coordinates + c]) > most) {
                    most = fabs(lift[i * coordinates + c]);
                    row = i;
                    column = c;
                }
        if (most < nothing * axle->wheel[0].radius)
            break;
        row_taken[row] = true;
        travel[rank] = column;
        for (int i = 0; i < axle->wheels; ++i) {
            const double share = lift[i * coordinates + column] / lift[row * coordinates + column];
            for (int c = 0; c < coordinates && !row_taken[i]; ++c)
                lift[i * coordinates + c] =
                    c == column ? 0 : lift[i * coordinates + c] - share * lift[row * coordinates + c];
        }
    }
    return rank;
}

static bool is_travel(const KcAxle *axle, int rank, int c)
{
    for (int k = 0; k < rank; ++k)
        if (axle->travel[k] == c)
            return true;
    return false;
}

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* How much a coordinate steers while the heights of the wheels are held: the sum of the wheels' turning about z; 0
 * where a wheel's axis of turning is more than 60 degrees from the vertical. */
static double steering_of(const KcAxle *axle, const Effects *effects, int all, int c)
{
    const int n = axle->rigid ? 0 : axle->wheels;
    double A[KC_WHEELS * KC_WHEELS], b[KC_WHEELS], sum = 0;
    for (int i = 0; i < n; ++i) {
        b[i] = -effects->lift[i * all + c];
        for (int k = 0; k < n; ++k)
            A[i * n + k] = effects->lift[i * all + axle->travel[k]];
    }
    if (is_travel(axle, n, c) || !kc_solve(n, A, b))
        return 0;
    for (int i = 0; i < axle->wheels; ++i) {
        double turn[3];
        copy3(effects->turn[i * all + c], turn);
        for (int k = 0; k < n; ++k)
            add_scaled3(b[k], effects->turn[i * all + axle->travel[k]], turn);
        if (fabs(turn[2]) < norm3(turn) / 2)
            return 0;
        sum += fabs(turn[2]);
    }
    return sum > nothing ? sum : 0;
}

static bool is_unit(const Kc *kc, const KcAxle *axle, int c)
{
    return axle->unit && !strcmp(axle->unit, kc->model->coordinate[c].name);
}

/* The coordinate that steers most, a driven one before others; -1: none does. */
static int find_steer(const Kc *kc, const KcAxle *axle, const Effects *effects)
{
    int best = -1;
    double most = 0;
    for (int c = 0; c < kc->model->coordinates; ++c) {
        const bool is_none = kc_is_mount(kc->model, c) || is_unit(kc, axle, c);
        const double much = is_none ? 0 : steering_of(axle, effects, kc->model->coordinates, c);
        const double worth = much > 0 && kc->model->coordinate[c].driven ? much + 1e6 : much;
        if (worth > most) {
            most = worth;
            best = c;
        }
    }
    return best;
}

/* A coordinate that moves the wheels of an axle up and down, which no force element holds: it stays where it is. */
static void find_loose(const Kc *kc, KcAxle *axle, int rank, const Effects *effects, const bool *sprung)
{
    const int all = kc->model->coordinates;
    for (int c = 0; c < all && rank && !axle->loose; ++c)
        for (int i = 0; i < axle->wheels; ++i)
            if (fabs(effects->lift[i * all + c]) > nothing * axle->wheel[0].radius && !sprung[c] && c != axle->steer &&
                !kc->model->coordinate[c].driven && !kc_is_mount(kc->model, c) && !is_unit(kc, axle, c) &&
                !is_travel(axle, rank, c))
                axle->loose = kc->model->coordinate[c].name;
}

static void classify(const Kc *kc, KcAxle *axle)
{
    const int n = axle->wheels, all = kc->model->coordinates;
    const size_t room = ((size_t)n * (size_t)all + 1) * sizeof(double);
    Effects effects = {pool_alloc(kc->pool, room), pool_alloc(kc->pool, room), pool_alloc(kc->pool, 3 * room)};
    double *left = pool_alloc(kc->pool, room);
    bool *sprung = pool_alloc(kc->pool, (size_t)all + 1);
    for (int c = 0; c < all; ++c) {
        KcAxle one = {.steer = c};
        KcLook *look = kc_look_new(kc, &one);
        const int status = kc_look(kc, kc->initial, look);
        if (status != GIC_OK)
            diag_fail((Place){kc->model->source, 0, 0}, NULL, "the model can't be evaluated as it is set up: %s",
                      kc_status(kc, status));
        sprung[c] = is_sprung(kc, c, look->slope);
        for (int i = 0; i < n; ++i) {
            const double scale = width(&kc->model->coordinate[c]);
            effects.lift[i * all + c] = scale * look->slope[axle->wheel[i].centre + 2];
            effects.aside[i * all + c] = scale * look->slope[axle->wheel[i].velocity + 1];
            left[i * all + c] = effects.lift[i * all + c] * (sprung[c] ? 1 : unsprung);
            add_scaled3(scale, look->slope + axle->wheel[i].turn, effects.turn[i * all + c]);
        }
    }
    find_unit(kc, axle, &effects);
    const int rank = choose(axle, all, left, axle->travel);
    qsort(axle->travel, (size_t)rank, sizeof *axle->travel, ascending);
    axle->rigid = rank == 0;
    if (axle->rigid)
        axle->refusal = "no coordinate moves its wheels up and down";
    else if (rank < n)
        axle->refusal = pool_print(
            kc->pool, "its %d wheels can't travel each by itself: coordinates move them in %d ways", n, rank);
    if (rank == 0 || rank == n)
        axle->steer = find_steer(kc, axle, &effects);
    find_loose(kc, axle, rank, &effects, sprung);
    if (axle->steer < 0)
        axle->unsteered = "no coordinate turns its wheels while their travel is held";
}

/* ---- the vehicle ---------------------------------------------------------------------------------------- */

/* Height of the centre of mass above `ground`. */
static double mass_height(const Model *model, double ground)
{
    double mass = 0, moment = 0;
    for (int i = 0; i < model->bodies; ++i) {
        const Body *body = &model->body[i];
        double A[9], com[3];
        mat_from_euler(body->euler, A);
        apply3(A, body->com, com);
        mass += body->mass;
        moment += body->mass * (body->position[2] + com[2]);
    }
    return mass > 0 ? moment / mass - ground : 0;
}

/* What is said of axles that belong to other units; NULL: there are none. */
static const char *units_of(const Kc *kc)
{
    const char *names = "", *by = "";
    int count = 0;
    for (int a = 0; a < kc->axles; ++a) {
        const KcAxle *axle = &kc->axle[a];
        if (!axle->unit)
            continue;
        names = pool_print(kc->pool, "%s%s%s", names, count++ ? ", " : "", axle->name);
        if (!strstr(by, pool_print(kc->pool, "'%s'", axle->unit)))
            by = pool_print(kc->pool, "%s%s'%s'", by, *by ? ", " : "", axle->unit);
    }
    if (!count)
        return NULL;
    return pool_print(kc->pool,
                      "%s %s belong%s to a unit that turns by %s: not counted for wheelbase, turning circle, Ackermann "
                      "and understeer; no anti-dive, which is that of one rigid vehicle",
                      count > 1 ? "axles" : "axle", names, count > 1 ? "" : "s", by);
}

int kc_last(const Kc *kc)
{
    int last = 0;
    for (int a = 0; a < kc->axles; ++a)
        if (!kc->axle[a].unit)
            last = a;
    return last;
}

int kc_foremost(const Kc *kc)
{
    for (int a = 0; a < kc->axles; ++a)
        if (!kc->axle[a].unit)
            return a;
    return 0;
}

double kc_wheelbase(const Kc *kc, const double *x)
{
    double fixed = 0, steered = NAN;
    int axles = 0, unsteered = 0;
    for (int a = 0; a < kc->axles; ++a) {
        const KcAxle *axle = &kc->axle[a];
        if (axle->unit)
            continue;
        ++axles;
        if (axle->steer < 0) {
            fixed += x[a];
            ++unsteered;
        } else if (isnan(steered)) {
            steered = x[a];
        }
    }
    if (axles > 2 && unsteered > 0 && unsteered < axles)
        return fabs(steered - fixed / unsteered);
    return x[kc_foremost(kc)] - x[kc_last(kc)];
}

/* Where the axles are. */
static void measure(Kc *kc)
{
    double ground = 0, sum = 0, fixed = 0;
    double *x = pool_alloc(kc->pool, (size_t)kc->axles * sizeof *x);
    int wheels = 0, unsteered = 0, own = 0;
    const KcAxle none = {.steer = -1};
    KcLook *look = kc_look_new(kc, &none);
    if (kc_look(kc, kc->initial, look) != GIC_OK)
        return;
    for (int a = 0; a < kc->axles; ++a) {
        const KcAxle *axle = &kc->axle[a];
        for (int i = 0; i < axle->wheels; ++i, ++wheels) {
            KcPose pose;
            kc_pose(&axle->wheel[i], look, &pose);
            x[a] += pose.contact[0] / axle->wheels;
            ground += pose.contact[2];
        }
        if (axle->unit)
            continue;
        sum += x[a];
        ++own;
        if (axle->steer < 0) {
            fixed += x[a];
            ++unsteered;
        }
    }
    for (int a = 0; a < kc->axles; ++a)
        kc->axle[a].ahead = x[a] >= sum / own ? 1 : -1;
    kc->wheelbase = own ? kc_wheelbase(kc, x) : 0;
    kc->turns = unsteered > 0 && unsteered < own;
    kc->fixed_x = unsteered ? fixed / unsteered : 0;
    kc->height = kc->model->free_base ? mass_height(kc->model, ground / wheels) : 0;
    kc->units = units_of(kc);
}

/* Leave the axle that is asked for. A single one is the foremost and the rearmost one, and takes the name. */
static void keep(Kc *kc, const char *name)
{
    const char *names = "";
    if (kc->axles == 1 && (!strcmp(name, "front") || !strcmp(name, "rear")))
        kc->axle->name = name;
    for (int i = 0; i < kc->axles; ++i) {
        if (!strcmp(name, kc->axle[i].name) || !strcmp(name, pool_print(kc->pool, "%d", i + 1))) {
            kc->axle += i;
            kc->axles = 1;
            return;
        }
        names = pool_print(kc->pool, "%s%s%s", names, i ? ", " : "", kc->axle[i].name);
    }
    diag_fail((Place){kc->model->source, 0, 0}, pool_print(kc->pool, "its axles are: %s", names),
              "model '%s' has no axle '%s'", kc->model->name, name);
}

void kc_warn(const Kc *kc)
{
    const char *names = "";
    for (int r = 0; r < kc->rubbers; ++r)
        names = pool_print(kc->pool, "%s%s'%s'", names, r ? ", " : "", kc->rubber[r].force->name);
    if (kc->rubbers)
        diag_warn(kc->rubber[0].force->at,
                  "write what matters of their forces as springs between points, along coordinates or about axes",
                  "%s %s left out of forces, wheel and roll rates",
                  kc->rubbers > 1 ? pool_print(kc->pool, "%d bushings, %s,", kc->rubbers, names)
                                  : pool_print(kc->pool, "bushing %s", names),
                  kc->rubbers > 1 ? "are" : "is");
    /* with bushings it may be these that hold it, which the warning above covers */
    for (int a = 0; a < kc->axles && !kc->rubbers; ++a)
        if (kc->axle[a].loose)
            diag_warn((Place){kc->model->source, 0, 0},
                      "what its wheels share with those of other axles is counted by each: `--sheet` has the loads",
                      "axle %s: no force element holds coordinate '%s', which moves its wheels up and down: it stays "
                      "where it is set up in forces, wheel and roll rates",
                      kc->axle[a].name, kc->axle[a].loose);
}

Kc *kc_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const char *axle)
{
    Kc *kc = pool_alloc(pool, sizeof *kc);
    Model *copy = pool_alloc(pool, sizeof *copy);
    *kc = (Kc){.pool = pool, .model = copy};
    *copy = *model;
    copy->output = NULL;
    copy->force = NULL;
    copy->outputs = copy->forces = copy->output_components = 0;
    for (int i = 0; i < model->forces; ++i)
        *POOL_PUSH(pool, copy->force, copy->forces) = model->force[i];
    if (!model->wheels)
        diag_fail((Place){model->source, 0, 0}, "give it `wheels`", "model '%s' has no wheels, and so no axles",
                  model->name);
    find_axles(kc, copy);
    for (int i = 0; i < model->forces; ++i)
        add_element(kc, copy, &model->force[i], i);
    kc->outputs = copy->output_components;
    kc->engine = engine_open(pool, "tape", copy, &(EngineOptions){.solve = solve, .quiet = true});
    kc->linear = linear_open(pool, kc->engine);
    kc->self = (Instance *)(void *)instance_new(pool, kc->engine);
    kc->work = (Instance *)(void *)instance_new(pool, kc->engine);
    const gic_model *code = kc->engine->code;
    const int status = scene ? code->setup_with(kc->self, scene->parameter) : code->setup(kc->self);
    if (status != GIC_OK)
        diag_fail((Place){scene ? scene->source : model->source, 0, 0}, NULL, "the model can't be set up: %s",
                  instance_status(pool, code, &kc->self->head, status));
    const size_t room = ((size_t)kc->linear->count + (size_t)kc->outputs + 1) * sizeof(double);
    kc->f = pool_alloc(pool, room);
    kc->df = pool_alloc(pool, room);
    kc->dout = pool_alloc(pool, room);
    kc->initial = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof(double));
    for (int c = 0; c < model->coordinates; ++c)
        kc->initial[c] = code->coordinate_state[c] >= 0
                             ? tape_array(kc->self, code->state_offset)[code->coordinate_state[c]]
                             : tape_array(kc->self, code->input_offset)[code->coordinate_input[c]];
    kc_stiffness(kc);
    for (int i = 0; i < kc->axles; ++i) {
        classify(kc, &kc->axle[i]);
        kc_find_followers(kc, &kc->axle[i]);
    }
    measure(kc);
    if (axle)
        keep(kc, axle);
    return kc;
}
