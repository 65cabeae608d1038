/* SPDX-License-Identifier: MIT
 * Steady driving on a level road, by Newton's method with exact derivatives.
 *
 * With the vertical n the motion is a turn about n with the rate r = curvature times speed: in the axes of the base
 * velocities, angular velocity R^T n r, coordinates and fast states stand still. Unknowns are the height, two small
 * rotations of the base, the free coordinates, the direction of the velocity v in the plane, the fast states, and two
 * inputs; equations their accelerations in the axes of the base, which small motions have (linearize.h), and the rates
 * of the fast states. Where the base turns by theta, v and n r stay, and change in its axes by -theta x R^T v and
 * -theta x R^T n r.
 *
 * A circle is reached from straight driving in steps of the lateral acceleration, each from the last solution. */
#include "run/trim.h"
#include "base/message.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "tape/engine_tape.h"
#include "vehicle/vehicle.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

enum { MOST_STEPS = 60, BASE = 6, DISPLACEMENT = 0, ROTATION = 3 };

static const double rank_limit = 1e-11;           /* relative to the largest singular value */
static const double longest = 1, shortest = 1e-3; /* m/s^2: steps of the lateral acceleration */
static const double first_brake = 0.01;

typedef enum UnknownKind { HEIGHT, LEAN, PLACE, COURSE, FAST, INPUT } UnknownKind;

/* An unknown; index: axis of the base, number among small motions, input. */
typedef struct Unknown {
    UnknownKind kind;
    int index;
    double unit; /* what may change at once */
} Unknown;

/* A solution under way. */
typedef struct Work {
    Pool *pool;
    const Linear *linear;
    const Model *model;
    Instance *self, *trial;
    Trim *trim;
    double turn; /* rate about the vertical, rad/s */
    int pedal;   /* the input that drives or brakes now; -1: none */
    int unknowns, equations;
    Unknown *unknown;
    int *row;                   /* [equations] among small motions */
    double *f, *A, *move, *way; /* [count], [count][count], [count] as linear_move() wants it, [count] */
    double *step;               /* [unknowns] */
    gsl_matrix *U, *V;          /* decomposed equations, in units; U: [equations][unknowns] */
    gsl_vector *S;
    int status, worst; /* of the last failure; row of the largest rate that was left */
    double left;
    bool exact; /* rounding leaves it: no unknown would move any more */
} Work;

/* ---- unknowns and equations ----------------------------------------------------------------------------- */

static double *input_of(const Work *w, int input)
{
    return tape_array(w->self, w->linear->engine->code.input_offset) + input;
}

static void add_unknown(Work *w, UnknownKind kind, int index, double unit)
{
    *POOL_PUSH(w->pool, w->unknown, w->unknowns) = (Unknown){kind, index, unit};
}

/* True for a state of the model itself that acts on nothing, such as a distance. */
static bool is_counter(const Work *w, int i)
{
    const Linear *linear = w->linear;
    const int own = 2 * linear->places + linear->of_wheels;
    if (i < own || i >= own + w->model->states)
        return false;
    for (int row = 0; row < linear->count; ++row)
        if (w->A[row * linear->count + i] != 0)
            return false;
    return true;
}

/* The range within which an input may change at once. */
static double input_unit(const Work *w, int input)
{
    for (int c = 0; c < w->model->coordinates; ++c)
        if (w->model->coordinate[c].driven && w->model->coordinate[c].input == input)
            return 0.1 * (w->model->coordinate[c].range[1] - w->model->coordinate[c].range[0]);
    return w->trim->goal.pedal && (input == w->trim->goal.drive || input == w->trim->goal.brake) ? 0.2 : INFINITY;
}

static void add_input(Work *w, int input)
{
    if (input >= 0)
        add_unknown(w, INPUT, input, input_unit(w, input));
}

/* What is found, with the pedal of now. */
static void list_unknowns(Work *w)
{
    const Linear *linear = w->linear;
    const double lean = 0.1, aside = 0.1; /* rad */
    w->unknowns = w->equations = 0;
    add_unknown(w, HEIGHT, 0, 0.1);
    add_unknown(w, LEAN, 0, lean);
    add_unknown(w, LEAN, 1, lean);
    for (int i = BASE; i < linear->places; ++i)
        add_unknown(w, PLACE, i, linear->piece[i]);
    add_unknown(w, COURSE, 0, aside);
    for (int i = 2 * linear->places; i < linear->count; ++i)
        if (!is_counter(w, i))
            add_unknown(w, FAST, i, linear->slips[i] ? linear->reach[i] : INFINITY);
    add_input(w, w->trim->goal.steer);
    add_input(w, w->pedal);
    for (int i = linear->places; i < linear->count; ++i)
        if (!(w->trim->held && i == linear->places) && !is_counter(w, i))
            *POOL_PUSH(w->pool, w->row, w->equations) = i;
}

/* The small motion d [count] of an unknown. */
static void motion_of(const Work *w, const Unknown *u, double *d)
{
    static const double up[3] = {0, 0, 1};
    const Linear *linear = w->linear;
    const double *y = tape_array(w->self, linear->engine->code.state_offset), *v = y + linear->places + 1;
    double R[9], of_world[3], along[3], c[3];
    memset(d, 0, (size_t)linear->count * sizeof *d);
    mat_from_euler(y + 3, R);
    switch (u->kind) {
    case HEIGHT: apply3_transposed(R, up, d + DISPLACEMENT); break;
    case LEAN:
        d[ROTATION + u->index] = 1;
        apply3_transposed(R, v, along);
        cross3(along, d + ROTATION, d + linear->places);
        cross3(y + linear->places + 4, d + ROTATION, d + linear->places + 3);
        break;
    case COURSE:
        cross3(up, v, of_world);
        apply3_transposed(R, of_world, c);
        memcpy(d + linear->places, c, sizeof c);
        break;
    case PLACE:
    case FAST: d[u->index] = 1; break;
    case INPUT: break;
    }
}

/* ---- Newton's method ------------------------------------------------------------------------------------ */

static double scale_of(const Unknown *u)
{
    return isfinite(u->unit) ? u->unit : 1;
}

/* The largest rate that is left, of the equations; its row. */
static double residual(Work *w, const double *f)
{
    int worst = w->row[0];
    for (int i = 0; i < w->equations; ++i)
        if (!(fabs(f[w->row[i]]) <= fabs(f[worst])))
            worst = w->row[i];
    w->worst = worst;
    return fabs(f[worst]);
}

/* Derivatives at the present state, decomposed. */
static int decompose(Work *w)
{
    const int n = w->linear->count;
    int status = linearize(w->linear, w->self, w->f, w->A);
    for (int j = 0; j < w->unknowns && status == GIC_OK; ++j) {
        const Unknown *u = &w->unknown[j];
        double column[n + 1];
        bool jump;
        motion_of(w, u, w->way);
        for (int i = 0; i < n && u->kind != INPUT; ++i) {
            column[i] = 0;
            for (int k = 0; k < n; ++k)
                column[i] += w->A[i * n + k] * w->way[k];
        }
        if (u->kind == INPUT)
            status = linear_column(w->linear, w->self, LINEAR_INPUT, u->index, column, 0, NULL, &jump);
        for (int i = 0; i < w->equations; ++i)
            gsl_matrix_set(w->U, (size_t)i, (size_t)j, column[w->row[i]] * scale_of(u));
    }
    if (status == GIC_OK && gsl_linalg_SV_decomp_jacobi(w->U, w->V, w->S))
        status = GIC_ERROR_SINGULAR;
    return status;
}

/* step: Newton's of least norm for f. Returns its size in units. */
static double solve(const Work *w, const double *f, double *step)
{
    double size = 0;
    memset(step, 0, (size_t)w->unknowns * sizeof *step);
    for (size_t k = 0; k < (size_t)w->unknowns; ++k) {
        double part = 0;
        if (!(gsl_vector_get(w->S, k) > rank_limit * gsl_vector_get(w->S, 0)))
            continue;
        for (int i = 0; i < w->equations; ++i)
            part -= gsl_matrix_get(w->U, (size_t)i, k) * f[w->row[i]] / gsl_vector_get(w->S, k);
        for (int j = 0; j < w->unknowns; ++j)
            step[j] += part * gsl_matrix_get(w->V, (size_t)j, k);
        size += part * part;
    }
    return sqrt(size);
}

/* An angular velocity about the vertical, of a base that has been moved. */
static void turn_steadily(const Work *w, Instance *self)
{
    double *y = tape_array(self, w->linear->engine->code.state_offset), R[9];
    mat_from_euler(y + 3, R);
    for (int i = 0; i < 3; ++i)
        y[w->linear->places + 4 + i] = R[6 + i] * w->turn;
}

/* The trial: the present state moved by a part of the step. */
static int try_step(Work *w, double part)
{
    const Linear *linear = w->linear;
    const gic_model *code = &linear->engine->code;
    memcpy(w->trial, w->self, code->size);
    double *y = tape_array(w->trial, code->state_offset), *v = y + linear->places + 1;
    memset(w->move, 0, (size_t)linear->count * sizeof *w->move);
    for (int j = 0; j < w->unknowns; ++j) {
        const Unknown *u = &w->unknown[j];
        const bool pedal = w->trim->goal.pedal && u->kind == INPUT && u->index == w->pedal;
        double by = part * w->step[j] * scale_of(u);
        if (pedal) /* it stays above 0, below which it changes nothing; all else goes on, and may need it again */
            by = fmax(by, -0.9 * *input_of(w, w->pedal));
        motion_of(w, u, w->way);
        for (int i = 0; i < linear->count; ++i)
            w->move[i] += by * w->way[i];
        if (u->kind == INPUT)
            tape_array(w->trial, code->input_offset)[u->index] += by;
        if (u->kind == COURSE) {
            const double x = v[0];
            v[0] = cos(by) * x - sin(by) * v[1];
            v[1] = sin(by) * x + cos(by) * v[1];
        }
    }
    linear_move(linear, w->trial, w->move);
    turn_steadily(w, w->trial);
    return linear_start(linear, w->trial, w->move);
}

/* The part of the step that is not too far. */
static double fair_part(const Work *w)
{
    double most = 1;
    for (int j = 0; j < w->unknowns; ++j)
        most = fmax(most, isfinite(w->unknown[j].unit) ? fabs(w->step[j]) : 0);
    return 1 / most;
}

/* A step that brings the state nearer, as the same derivatives tell: what is left of the step has to shrink. Beyond the
 * limit of rounding nothing does. */
static bool advance(Work *w, double size)
{
    const double least = 1e-3;
    double next[w->unknowns + 1];
    for (double part = fair_part(w); part > least; part /= 2) {
        const int status = try_step(w, part);
        if (status != GIC_OK) {
            w->status = status;
            continue;
        }
        if (!(solve(w, w->move, next) <= (1 - part / 4) * size))
            continue;
        memcpy(w->self, w->trial, w->linear->engine->code.size);
        return true;
    }
    return false;
}

/* What rounding of places, velocities and speeds, of sizes about 1, may leave of the worst rate, and more. */
static double rounding_of(const Work *w)
{
    double sum = 0;
    for (int j = 0; j < w->linear->count; ++j)
        sum += fabs(w->A[w->worst * w->linear->count + j]);
    return 1000 * DBL_EPSILON * sum;
}

static bool iterate(Work *w)
{
    const double small = 1e-12, exact = 1e-9; /* of units: what rounding leaves, at best and of a stiff model */
    for (int k = 0; k < MOST_STEPS; ++k) {
        const int status = decompose(w);
        if (status != GIC_OK) {
            w->status = status;
            return false;
        }
        w->left = residual(w, w->f);
        const double size = solve(w, w->f, w->step);
        w->exact = size <= exact && w->left <= rounding_of(w);
        ++w->trim->steps;
        if (!(size > small) || !advance(w, size))
            return w->left < equilibrium_limit;
    }
    return false;
}

/* Solve for the present turn, from the present state. False: it was not found, and the state is another one. */
static bool newton(Work *w)
{
    const size_t unknowns = (size_t)w->unknowns;
    w->status = GIC_OK;
    w->exact = false;
    w->U = gsl_matrix_alloc((size_t)w->equations, unknowns);
    w->V = gsl_matrix_alloc(unknowns, unknowns);
    w->S = gsl_vector_alloc(unknowns);
    const bool found = iterate(w);
    gsl_vector_free(w->S);
    gsl_matrix_free(w->V);
    gsl_matrix_free(w->U);
    return found;
}

/* ---- pedals and gears ----------------------------------------------------------------------------------- */

static void take_pedal(Work *w, int pedal, double value)
{
    const TrimGoal *goal = &w->trim->goal;
    w->pedal = pedal;
    if (goal->pedal && goal->drive >= 0)
        *input_of(w, goal->drive) = 0;
    if (goal->pedal && goal->brake >= 0)
        *input_of(w, goal->brake) = 0;
    if (pedal >= 0)
        *input_of(w, pedal) = value;
    list_unknowns(w);
}

/* newton(), with the pedal that it takes. */
static bool settle(Work *w)
{
    const TrimGoal *goal = &w->trim->goal;
    const bool both = goal->pedal && goal->brake >= 0;
    Instance *start = (Instance *)(void *)instance_new(w->pool, w->trim->found->engine);
    memcpy(start, w->self, w->linear->engine->code.size);
    const bool found = newton(w);
    if (!both || ((found || w->exact) && *input_of(w, w->pedal) >= 0)) /* rounding is no reason for the other one */
        return found;
    memcpy(w->self, start, w->linear->engine->code.size);
    const bool braked = w->pedal == goal->brake;
    take_pedal(w, braked ? goal->drive : goal->brake, braked ? 0 : first_brake);
    return newton(w) && *input_of(w, w->pedal) >= 0;
}

static int32_t *gears(const Work *w, Instance *self)
{
    const gic_model *code = &w->linear->engine->code;
    return (int32_t *)(void *)tape_array(self, code->discrete_offset) + code->free_base;
}

/* True if the transmission would leave its gear. */
static bool is_left(Work *w)
{
    const gic_model *code = &w->linear->engine->code;
    memcpy(w->trial, w->self, code->size);
    return code->shift && code->shift(w->trial) && w->model->powertrain &&
           gears(w, w->trial)[POWERTRAIN_GEAR] != gears(w, w->self)[POWERTRAIN_GEAR];
}

/* Brakes of wheels that roll forwards are wound up: there they slip. */
static void wind_brakes(const Work *w)
{
    const gic_model *code = &w->linear->engine->code;
    double *fast = tape_array(w->self, code->state_offset) + code->slow_count;
    for (int i = 0; i < w->model->wheels; ++i)
        if (w->model->wheel[i].tire >= 0 && wheel_fast_states(&w->model->wheel[i]) > FAST_BRAKE)
            fast[w->model->wheel[i].fast + FAST_BRAKE] = 1;
}

/* Straight ahead from rest, at the speed. */
static int set_in_motion(const Work *w, int gear)
{
    const gic_model *code = &w->linear->engine->code;
    double *y = tape_array(w->self, code->state_offset), R[9];
    mat_from_euler(y + 3, R);
    const double length = hypot(R[0], R[3]), speed = w->trim->goal.speed;
    y[w->linear->places + 1] = speed * R[0] / length;
    y[w->linear->places + 2] = speed * R[3] / length;
    y[w->linear->places + 3] = 0;
    if (w->model->powertrain)
        gears(w, w->self)[POWERTRAIN_GEAR] = gears(w, w->self)[POWERTRAIN_BEFORE] = gear;
    const int status = scene_set_fast(code, NULL, &w->self->head);
    wind_brakes(w);
    return status;
}

/* The rate at which the engine or, in all, wheels gain speed, with the engine at a speed and a pedal. */
static double gain(Work *w, bool engine, double speed, double pedal)
{
    const gic_model *code = &w->linear->engine->code;
    const int fast = 2 * w->linear->places, number = w->model->powertrain->fast + POWERTRAIN_SPEED;
    double sum = 0;
    tape_array(w->self, code->state_offset)[code->slow_count + number] = speed;
    if (w->trim->goal.pedal)
        *input_of(w, w->trim->goal.drive) = pedal;
    w->status = linear_start(w->linear, w->self, w->f);
    for (int i = 0; i < w->model->wheels && !engine; ++i)
        if (w->model->wheel[i].tire >= 0)
            sum += w->f[fast + w->model->wheel[i].fast + FAST_SPIN];
    return w->status != GIC_OK ? NAN : engine ? w->f[fast + number] : sum;
}

/* What start_engine() looks for: the engine's speed at which wheels keep theirs, that at which it idles, and the pedal
 * that keeps a speed. */
typedef enum Aim { ROLLING, IDLING, PEDAL } Aim;

/* By halving; all of these gains change their sign once. */
static double aim_at(Work *w, Aim aim, double low, double high, double speed)
{
    enum { HALVINGS = 50 };
    for (int k = 0; k < HALVINGS; ++k) {
        const double middle = (low + high) / 2, by = aim == PEDAL ? middle : 0;
        const double found = gain(w, aim != ROLLING, aim == PEDAL ? speed : middle, by);
        if (aim == IDLING ? found > 0 : found < 0)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* Begin with an engine that just turns the wheels, and the pedal that keeps it there; or where it turns faster by
 * itself, with one that idles. Converters are far from linear. */
static void start_engine(Work *w)
{
    const double fastest = 1e4; /* rad/s */
    double high = 10, pedal = 0;
    while (high < fastest && gain(w, false, high, 0) < 0)
        high *= 2;
    double speed = aim_at(w, ROLLING, 0, high, 0);
    if (gain(w, true, speed, 0) > 0)
        speed = aim_at(w, IDLING, speed, fastest, 0);
    else if (w->trim->goal.pedal)
        pedal = aim_at(w, PEDAL, 0, 1, speed);
    gain(w, true, speed, pedal);
}

/* Straight ahead in a gear. */
static bool go_straight(Work *w, const Instance *rest, int gear)
{
    const TrimGoal *goal = &w->trim->goal;
    memcpy(w->self, rest, w->linear->engine->code.size);
    w->turn = 0;
    w->trim->gear = gear;
    w->status = set_in_motion(w, gear);
    if (w->status == GIC_OK && w->model->powertrain)
        start_engine(w);
    if (w->status == GIC_OK)
        w->status = linearize(w->linear, w->self, w->f, w->A);
    if (w->status != GIC_OK)
        return false;
    take_pedal(w, goal->drive, goal->drive < 0 ? 0 : *input_of(w, goal->drive));
    return settle(w);
}

/* ---- what can not be ------------------------------------------------------------------------------------ */

static Place place_of(const Work *w, const Scene *scene)
{
    return (Place){scene ? scene->source : w->model->source, 0, 0};
}

/* Why Newton's method did not get there. */
static const char *reason(const Work *w)
{
    if (w->status != GIC_OK)
        return instance_status(w->pool, &w->linear->engine->code, &w->trial->head, w->status);
    const bool is_rate = w->worst < 2 * w->linear->places;
    const char *rate = pool_print(w->pool, "%s%s", w->linear->name[w->worst], is_rate ? ".rate" : "");
    if (w->exact)
        return pool_print(w->pool,
                          "the motion is found to nine digits, but rounding leaves a rate of %.3g of %s, above 1e-9",
                          w->left, rate);
    return pool_print(w->pool, "a rate of %.3g is left, of %s", w->left, rate);
}

/* What to do about it; else: where more than rounding is left. */
static const char *remedy(const Work *w, const char *otherwise)
{
    return w->status == GIC_OK && w->exact
               ? "light bodies on stiff springs multiply rounding: more mass or less stiffness there"
               : otherwise;
}

/* why: in the first gear that was tried. */
static _Noreturn void fail_straight(const Work *w, const Scene *scene, const char *why)
{
    const Powertrain *powertrain = w->model->powertrain;
    const bool any = w->trim->goal.gear == TRIM_ANY_GEAR;
    const char *gear = !powertrain ? ""
                       : any       ? pool_print(w->pool, " in a forward gear; in gear %d", powertrain->forward)
                                   : pool_print(w->pool, " in gear %d", w->trim->goal.gear);
    diag_fail(place_of(w, scene),
              fabs(w->model->body[BODY_BASE].euler[0]) < 1 - 1e-12
                  ? "it drives along x of the base's own frame, which `orientation` turns from that of the drawing"
                  : remedy(w, powertrain ? "take another speed or gear; --manoeuvre acceleration tells what it can do"
                                         : "take another speed; an input that drives is `accelerator`, or drive=NAME"),
              "no steady driving at %.6g m/s straight ahead%s: %s", w->trim->goal.speed, gear, why);
}

/* Refuse inputs that can't have their values. */
static void check_inputs(const Work *w, const Scene *scene)
{
    const TrimGoal *goal = &w->trim->goal;
    const char *at =
        pool_print(w->pool, "at %.6g m/s and a lateral acceleration of %.4g m/s^2", goal->speed, w->turn * goal->speed);
    for (int c = 0; c < w->model->coordinates && goal->steer >= 0; ++c) {
        const Coordinate *steer = &w->model->coordinate[c];
        if (!steer->driven || steer->input != goal->steer)
            continue;
        const double value = *input_of(w, goal->steer);
        if (!(value >= steer->range[0] && value <= steer->range[1]))
            diag_fail(place_of(w, scene), "take less curvature",
                      "%s it takes '%s' at %.6g, beyond its range of %.6g to %.6g", at, steer->name, value,
                      steer->range[0], steer->range[1]);
    }
    if (goal->pedal && w->pedal >= 0 && *input_of(w, w->pedal) > 1 + 1e-9)
        diag_fail(place_of(w, scene), "take another speed or gear", "%s it takes '%s' at %.4g, and its end is 1", at,
                  w->model->input[w->pedal].name, *input_of(w, w->pedal));
}

/* ---- the search ----------------------------------------------------------------------------------------- */

/* From straight driving into the circle. */
static void go_round(Work *w, const Scene *scene)
{
    const double speed = w->trim->goal.speed, all = speed * speed * w->trim->goal.curvature;
    const gic_model *code = &w->linear->engine->code;
    Instance *good = (Instance *)(void *)instance_new(w->pool, w->trim->found->engine);
    double done = 0, step = longest;
    while (fabs(done) < fabs(all)) {
        const double next = fabs(all - done) <= step * (1 + 1e-9) ? all : done + copysign(step, all);
        const int pedal = w->pedal;
        memcpy(good, w->self, code->size);
        w->turn = next / speed;
        turn_steadily(w, w->self);
        if (settle(w)) {
            done = next;
            step = fmin(longest, 2 * step);
            check_inputs(w, scene);
            continue;
        }
        const double value = pedal >= 0 ? tape_array(good, code->input_offset)[pedal] : 0;
        memcpy(w->self, good, code->size);
        take_pedal(w, pedal, value);
        step /= 2;
        if (step < shortest)
            diag_fail(place_of(w, scene),
                      w->trim->goal.steer < 0 ? "give it a driven coordinate that steers, or name the input: steer=NAME"
                                              : remedy(w, "take less speed or curvature: tires and drive have no more"),
                      "no steady cornering at %.6g m/s beyond a lateral acceleration of %.4g m/s^2 found: %s", speed,
                      done, reason(w));
    }
}

/* The vehicle turned about the vertical at its place, so that it heads where it did at rest. What is rounding becomes
 * 0.
 */
static void head_on(const Work *w, const Instance *rest)
{
    const double rounding = 1e-14;
    const gic_model *code = &w->linear->engine->code;
    double *y = tape_array(w->self, code->state_offset), R[9], was[9], p[4];
    const double *from = instance_array((gic_head *)(uintptr_t)&rest->head, code->state_offset);
    mat_from_euler(y + 3, R);
    mat_from_euler(from + 3, was);
    const double angle = atan2(was[3], was[0]) - atan2(R[3], R[0]), c = cos(angle / 2), s = sin(angle / 2);
    memcpy(p, y + 3, sizeof p);
    y[3] = c * p[0] - s * p[3];
    y[4] = c * p[1] - s * p[2];
    y[5] = c * p[2] + s * p[1];
    y[6] = c * p[3] + s * p[0];
    double *v = y + w->linear->places + 1, x = v[0];
    v[0] = cos(angle) * x - sin(angle) * v[1];
    v[1] = sin(angle) * x + cos(angle) * v[1];
    for (int i = 0; i < 2; ++i)
        v[i] = fabs(v[i]) > rounding * w->trim->goal.speed ? v[i] : 0;
    code->settle(w->self, y);
    if (w->trim->goal.steer >= 0) {
        double *steer = input_of(w, w->trim->goal.steer);
        *steer = fabs(*steer) > rounding ? *steer : 0;
    }
}

static void check_model(Pool *pool, const Model *model, const Scene *scene)
{
    const Place at = {scene ? scene->source : model->source, 0, 0};
    const Plane *plane = scene_plane(pool, scene ? scene->road : NULL);
    const char *restless = scene_restless(pool, model);
    if (!model->free_base)
        diag_fail(at, "free it", "the base of model '%s' is fixed: it can't drive", model->name);
    if (!plane || plane->slope[0] != 0 || plane->slope[1] != 0)
        diag_fail(at, "leave `road` out, or `road: {type: flat}`",
                  "steady driving is on a level road with one friction");
    if (model->gravity[0] != 0 || model->gravity[1] != 0)
        diag_fail(at, "let it act along -z", "steady driving needs gravity that acts downwards");
    if (restless)
        diag_fail(at, "leave it out", "%s changes by itself: there is no steady driving", restless);
}

const Trim *trim_find(Pool *pool, const Model *model, const Scene *scene, Solve solve, const TrimGoal *goal)
{
    check_model(pool, model, scene);
    Trim *trim = pool_alloc(pool, sizeof *trim);
    Equilibrium *found = pool_alloc(pool, sizeof *found);
    *found = *equilibrium_find_locked(pool, model, scene, solve);
    *trim = (Trim){.goal = *goal, .found = found, .held = goal->drive < 0};
    const size_t count = (size_t)found->linear->count + 1;
    const Instance *rest = found->self;
    Work w = {.pool = pool,
              .linear = found->linear,
              .model = model,
              .self = (Instance *)(void *)instance_new(pool, found->engine),
              .trial = (Instance *)(void *)instance_new(pool, found->engine),
              .trim = trim,
              .f = pool_alloc(pool, count * sizeof(double)),
              .A = pool_alloc(pool, count * count * sizeof(double)),
              .move = pool_alloc(pool, count * sizeof(double)),
              .way = pool_alloc(pool, count * sizeof(double)),
              .step = pool_alloc(pool, (count + BASE) * sizeof(double))};
    gsl_errors_return();
    const bool any = goal->gear == TRIM_ANY_GEAR && model->powertrain;
    const char *why = NULL;
    for (int gear = any ? model->powertrain->forward : goal->gear;; --gear) {
        const bool goes = go_straight(&w, rest, gear);
        if (goes && !(any && is_left(&w)))
            break;
        why = why ? why : goes ? "the transmission leaves it" : reason(&w);
        if (!any || gear <= 1)
            fail_straight(&w, scene, why);
    }
    check_inputs(&w, scene);
    go_round(&w, scene);
    head_on(&w, rest);
    found->self = w.self;
    found->locked = false;
    found->neutral = NULL;
    trim->shifts = is_left(&w);
    int status = linearize(w.linear, w.self, w.f, w.A);
    if (status == GIC_OK)
        status = found->engine->code->outputs(w.self);
    if (status != GIC_OK)
        diag_fail(place_of(&w, scene), NULL, "no outputs: %s",
                  instance_status(pool, found->engine->code, &w.self->head, status));
    found->f = w.f;
    found->A = w.A;
    found->residual = residual(&w, w.f);
    trim->slowing = trim->held ? w.f[w.linear->places] : 0;
    return trim;
}
