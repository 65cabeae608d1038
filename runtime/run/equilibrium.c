/* SPDX-License-Identifier: MIT
 * Static equilibrium: places at which all accelerations vanish at rest.
 *
 * Near it: Newton's method, with steps of least norm, so that directions in which nothing changes (x, y and yaw on a
 * plane) stay as they are. Far from it: the motion itself in steps of implicit Euler, with all velocities set to zero
 * before each, (1/h^2 - K) dx = a, which goes downhill like the real thing and turns into Newton's step as h grows. No
 * step is taken against the forces, for that would lead to where the mechanism balances on its tip. */
#include "base/message.h"
#include "base/text.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "model/model.h"
#include "model/tunable.h"
#include "run/engines.h"
#include "run/equilibrium_private.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"
#include "subset/subset.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

const double equilibrium_limit = 1e-9, equilibrium_rank = 1e-9;
const double equilibrium_tipped = 1.0471975511965976; /* 60 degrees, as for runs (outcome_look()) */
static const double slowest = 1e-9;                   /* m/s, rad/s: below this speed it stands still */

enum { MOST_STEPS = 500 };

static const double longest = 1e4, shortest = 1e-7, first = 0.02; /* h, s */
static const double near = 1e-3; /* size of a piece: the direction of so small a step need not be checked */

typedef struct Search {
    Pool *pool;
    Equilibrium *found;
    Instance *trial;
    int unknowns;
    double *step, *move; /* [unknowns], [count] as linear_move() wants it */
    double *f, *A;       /* at the trial */
    double h;
    bool settled;      /* near enough for tires to be stretched */
    const char *limit; /* why the trials since the last good step failed; NULL: none did */
} Search;

int equilibrium_column(const Linear *linear, int unknown)
{
    return unknown < linear->places ? unknown : unknown + linear->places;
}

static double square_sum(const Search *s, const double *f)
{
    double sum = 0;
    for (int i = 0; i < s->unknowns; ++i)
        sum += f[s->found->linear->places + i] * f[s->found->linear->places + i];
    return sum;
}

static int largest(const Search *s, const double *f)
{
    const int places = s->found->linear->places;
    int worst = places;
    for (int i = places; i < places + s->unknowns; ++i)
        if (!(fabs(f[i]) <= fabs(f[worst])))
            worst = i;
    return worst;
}

/* Largest of the first numbers of a step, in units of what may change at once: more than 1 is too far. */
static double step_size(const Search *s, const double *step, int count)
{
    const Linear *linear = s->found->linear;
    double size = 0;
    for (int i = 0; i < count; ++i)
        size = fmax(size, fabs(step[i]) /
                              (i < linear->places ? linear->piece[i] : linear->reach[equilibrium_column(linear, i)]));
    return size;
}

/* Singular values and directions of the equations in units of the reach. V: [unknowns][unknowns] by columns. */
static void decompose(const Search *s, gsl_matrix *U, gsl_matrix *V, gsl_vector *S)
{
    const Linear *linear = s->found->linear;
    const int n = s->unknowns;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int column = equilibrium_column(linear, j);
            gsl_matrix_set(U, (size_t)i, (size_t)j,
                           s->found->A[(linear->places + i) * linear->count + column] * linear->reach[column]);
        }
    gsl_linalg_SV_decomp_jacobi(U, V, S);
}

/* True for a direction in which nothing changes; steps have no component there. */
static bool is_flat(const gsl_vector *S, size_t k)
{
    return !(gsl_vector_get(S, k) > equilibrium_rank * gsl_vector_get(S, 0));
}

/* step: Newton's of least norm, from the decomposed equations, for f. */
static void solve_decomposed(const Search *s, const gsl_matrix *U, const gsl_matrix *V, const gsl_vector *S,
                             const double *f, double *step)
{
    const Linear *linear = s->found->linear;
    const size_t n = (size_t)s->unknowns;
    memset(step, 0, n * sizeof *step);
    for (size_t k = 0; k < n; ++k) {
        double part = 0;
        for (size_t i = 0; i < n && !is_flat(S, k); ++i)
            part -= gsl_matrix_get(U, i, k) * f[linear->places + (int)i] / gsl_vector_get(S, k);
        for (size_t j = 0; j < n; ++j)
            step[j] += part * gsl_matrix_get(V, j, k) * linear->reach[equilibrium_column(linear, (int)j)];
    }
}

/* Names of the places that are mostly such directions. */
static const char *name_flat(const Search *s, const gsl_matrix *V, const gsl_vector *S)
{
    const Linear *linear = s->found->linear;
    const double most = 0.51; /* not 0.5, so that rounding can't decide which of two places with equal shares is
                               * named */
    Text names = {.pool = s->pool};
    for (int j = 0; j < linear->places; ++j) {
        double weight = 0;
        for (size_t k = 0; k < V->size1; ++k)
            if (is_flat(S, k))
                weight += gsl_matrix_get(V, (size_t)j, k) * gsl_matrix_get(V, (size_t)j, k);
        if (weight > most)
            text_print(&names, "%s%s", names.size ? ", " : "", linear->name[j]);
    }
    return names.s;
}

/* Derivative of the i-th rate of the fast states by place j, which moves at the rate dx / h. */
static double followed(const Search *s, int i, int j)
{
    const Linear *linear = s->found->linear;
    const double *row = s->found->A + (linear->places + i) * linear->count;
    return row[j] + row[linear->places + j] / s->h;
}

/* A step of implicit Euler from rest over h. Tires keep their grip during the step and are released after it: their
 * stretch on the way down is not part of the equilibrium. */
static void relaxation_step(Search *s)
{
    const Linear *linear = s->found->linear;
    const int n = s->unknowns, places = linear->places;
    double M[n * n + 1];
    for (int i = 0; i < n; ++i) {
        const double *row = s->found->A + (places + i) * linear->count;
        s->step[i] = s->found->f[places + i];
        for (int j = 0; j < n; ++j)
            M[n * i + j] = i >= places && j < places ? -followed(s, i, j) : -row[equilibrium_column(linear, j)];
        M[n * i + i] += i < places ? 1 / (s->h * s->h) : 1 / s->h;
    }
    if (!linear_solve_numeric(n, M, s->step))
        s->step[0] = NAN;
    for (int i = 0; i < linear->of_wheels; ++i)
        s->step[places + i] = 0;
}

/* Acceleration number i at the present place, with the fast states of the step. */
static double pushed(const Search *s, int i)
{
    const Linear *linear = s->found->linear;
    const int row = linear->places + i;
    double a = s->found->f[row];
    for (int j = linear->places; j < s->unknowns; ++j)
        a += s->found->A[row * linear->count + equilibrium_column(linear, j)] * s->step[j];
    return a;
}

/* True if the forces at the present place do positive work along the step: M a . dx, M the mass matrix, for a step of
 * size 1, with M dx from a difference. */
static bool goes_with_forces(Search *s, double size)
{
    const TapeEngine *engine = s->found->linear->engine;
    Instance *self = s->found->self;
    const gic_model *code = &engine->code;
    const int n = engine->formulation->plan->unknowns, base = code->free_base ? 6 : 0;
    const double *y = tape_array(self, code->state_offset);
    double e[4], step[n + 1], acceleration[n + 1], tau[2][n + 1], work = 0;
    for (int i = 0; i < n; ++i) {
        const int from = i < base ? (i + 3) % 6 : i; /* the tape's order is rotation, displacement */
        step[i] = s->step[from] / size;
        acceleration[i] = pushed(s, from);
    }
    if (tape_refresh(self, e) != GIC_OK || tape_whole(self, engine->inverse, 0, y, e, NULL, step, tau[0]) != GIC_OK)
        return false;
    memset(step, 0, sizeof step);
    if (tape_whole(self, engine->inverse, 0, y, e, NULL, step, tau[1]) != GIC_OK)
        return false;
    for (int i = 0; i < n; ++i)
        work += acceleration[i] * (tau[0][i] - tau[1][i]);
    return work > 0;
}

bool equilibrium_is_held(const Equilibrium *found, int i)
{
    const int own = 2 * found->linear->places + found->linear->of_wheels;
    return i < own || i >= own + found->model->states;
}

/* linearize(); slips of locked wheels can change, and the rates of their spins are ignored. */
static int look(const Search *s, Instance *self, double *f, double *A)
{
    const Linear *linear = s->found->linear;
    const int count = linear->count;
    const int status = linearize(linear, self, f, A);
    for (int i = 2 * linear->places; i < count && s->found->locked; ++i) {
        if (!equilibrium_is_held(s->found, i))
            continue;
        f[i] = 0;
        memset(A + i * count, 0, (size_t)count * sizeof *A);
        for (int row = 0; row < count && !linear->slips[i]; ++row)
            A[row * count + i] = 0;
    }
    return status;
}

/* Evaluate the place that the step leads to. */
static bool try_step(Search *s)
{
    const Linear *linear = s->found->linear;
    memset(s->move, 0, (size_t)linear->count * sizeof *s->move);
    for (int i = 0; i < s->unknowns; ++i)
        s->move[equilibrium_column(linear, i)] = s->step[i];
    memcpy(s->trial, s->found->self, linear->engine->code.size);
    linear_move(linear, s->trial, s->move);
    const int status = look(s, s->trial, s->f, s->A);
    if (status != GIC_OK)
        s->limit = instance_status(s->pool, s->found->engine->code, &s->trial->head, status);
    return status == GIC_OK;
}

static void accept(Search *s)
{
    const size_t count = (size_t)s->found->linear->count;
    memcpy(s->found->self, s->trial, s->found->linear->engine->code.size);
    memcpy(s->found->f, s->f, count * sizeof *s->f);
    memcpy(s->found->A, s->A, count * count * sizeof *s->A);
    ++s->found->steps;
    s->limit = NULL;
}

/* True if the vehicle has sunk so far that only its tires move it, slowly or steadily. Newton's method would stop it
 * before that with tires pulling against each other. */
static bool has_settled(const Search *s)
{
    const double slow = 16, change = 1e-3; /* h, s; of a step */
    const double before = square_sum(s, s->found->f), now = square_sum(s, s->f);
    return !s->found->linear->of_wheels || s->h >= slow || fabs(now - before) <= change * before;
}

/* True if the step may be taken. */
static bool is_fair(Search *s)
{
    const double places = step_size(s, s->step, s->found->linear->places);
    return step_size(s, s->step, s->unknowns) <= 1 && (places <= near || goes_with_forces(s, places));
}

/* A Newton step is accepted if it is near enough to be trusted and halves the accelerations, or the remaining step
 * length: with freely rolling wheels the accelerations of stiff directions rise before they vanish. */
static bool newton(Search *s)
{
    Equilibrium *found = s->found;
    const size_t n = (size_t)s->unknowns;
    gsl_matrix *U = gsl_matrix_alloc(n, n), *V = gsl_matrix_alloc(n, n);
    gsl_vector *S = gsl_vector_alloc(n);
    decompose(s, U, V, S);
    solve_decomposed(s, U, V, S, found->f, s->step);
    bool good = found->residual > 0 && s->settled && is_fair(s) && try_step(s);
    if (good && square_sum(s, s->f) > square_sum(s, found->f) / 4) {
        solve_decomposed(s, U, V, S, s->f, s->move);
        good = found->linear->of_wheels && found->residual >= equilibrium_limit && found->steps < MOST_STEPS &&
               step_size(s, s->move, s->unknowns) <= step_size(s, s->step, s->unknowns) / 2;
    }
    if (good)
        accept(s);
    else if (found->residual < equilibrium_limit)
        found->neutral = name_flat(s, V, S);
    gsl_vector_free(S);
    gsl_matrix_free(V);
    gsl_matrix_free(U);
    return good;
}

/* One step of relaxation, shortened until it is good. */
static bool relax(Search *s)
{
    for (; s->h > shortest; s->h /= 2) {
        relaxation_step(s);
        if (!is_fair(s) || !try_step(s) || !(square_sum(s, s->f) <= 100 * square_sum(s, s->found->f)))
            continue;
        s->settled = has_settled(s);
        accept(s);
        s->h = fmin(2 * s->h, longest);
        return true;
    }
    return false;
}

/* ---- the start, and failure ----------------------------------------------------------------------------- */

/* The user's model with additional outputs for the tables. */
static const Model *watched(Pool *pool, const Model *model)
{
    Model *copy = pool_alloc(pool, sizeof *copy);
    *copy = *model;
    copy->output =
        pool_alloc(pool, (size_t)(model->outputs + model->forces + model->wheels + 1) * sizeof *copy->output);
    for (int i = 0; i < model->outputs; ++i)
        output_copy(model, &copy->output[i], &model->output[i]);
    for (int i = 0; i < model->forces; ++i)
        if (!force_is_wrench(&model->force[i])) {
            copy->output[copy->outputs++] = (Output){.name = model->force[i].name,
                                                     .type = OUTPUT_FORCE,
                                                     .index = i,
                                                     .count = 1,
                                                     .component = {""},
                                                     .unit = {""}};
            ++copy->output_components;
        }
    for (int i = 0; i < model->wheels; ++i) {
        copy->output[copy->outputs++] = (Output){.name = model->wheel[i].name,
                                                 .type = OUTPUT_WHEEL,
                                                 .index = i,
                                                 .count = 4,
                                                 .component = {"", "", "", ""},
                                                 .unit = {"", "", "", ""}};
        copy->output_components += 4;
    }
    return copy;
}

const char *equilibrium_faded(Pool *pool, const Equilibrium *found, const double *output, int index)
{
    const Wheel *wheel = &found->model->wheel[index];
    const double deflection = output[equilibrium_wheel(found, index) + 1], share = deflection / wheel->fade;
    if (wheel->tire < 0 || !(deflection > 0 && share < 1))
        return NULL;
    return pool_print(
        pool,
        "wheel '%s' deflects by %.3g mm, less than its fade of %.3g mm: the stiffnesses by slip are %.2g of "
        "the tire's; choose a smaller `fade`",
        wheel->name, 1e3 * deflection, 1e3 * wheel->fade, share * share * (3 - 2 * share));
}

int equilibrium_wheel(const Equilibrium *found, int wheel)
{
    return found->model->output_components - 4 * (found->model->wheels - wheel);
}

int equilibrium_force(const Equilibrium *found, int force)
{
    int at = equilibrium_wheel(found, 0);
    if (force_is_wrench(&found->model->force[force]))
        return -1;
    for (int i = force; i < found->model->forces; ++i)
        at -= !force_is_wrench(&found->model->force[i]);
    return at;
}

double equilibrium_lean(const Equilibrium *found)
{
    const double *state = tape_array(found->self, found->engine->code->state_offset);
    double now[9], drawn[9];
    if (!found->model->free_base || !found->model->wheels)
        return 0;
    mat_from_euler(state + 3, now);
    mat_from_euler(found->model->body[BODY_BASE].euler, drawn);
    return acos(fmax(-1, fmin(1, dot3(now + 6, drawn + 6))));
}

static bool is_motion(double velocity)
{
    return fabs(velocity) > slowest;
}

bool equilibrium_stands(const Model *model, const Scene *scene)
{
    bool moves = scene->along && is_motion(scene->speed);
    for (int i = 0; i < 3 && model->free_base; ++i)
        moves = moves || is_motion(scene->angular_velocity[i]) || (!scene->along && is_motion(scene->velocity[i]));
    for (int c = 0; c < model->coordinates; ++c)
        moves = moves || (!model->coordinate[c].driven && is_motion(scene->rate[c]));
    return !moves;
}

/* The gear; 0: neutral, or there is no powertrain. */
static int gear_of(const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    const int32_t *discrete = (const int32_t *)(const void *)((const char *)found->self + code->discrete_offset);
    return found->model->powertrain ? discrete[code->free_base + POWERTRAIN_GEAR] : 0;
}

/* At rest at time 0, inputs fixed. */
static int start(const Equilibrium *found, const Scene *scene)
{
    const gic_model *code = found->engine->code;
    gic_head *self = &found->self->head;
    double *state = instance_array(self, code->state_offset), *input = instance_array(self, code->input_offset);
    const int status = scene ? scene_start(found->engine, scene, self) : code->setup(self);
    self->input_function = NULL;
    for (int i = found->linear->places; i < 2 * found->linear->places; ++i)
        state[i + code->free_base] = 0;
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_input[c] >= 0)
            input[code->coordinate_input[c] + 1] = input[code->coordinate_input[c] + 2] = 0;
    return status == GIC_OK ? scene_set_fast(code, scene, self) : status;
}

/* A vehicle that is drawn with wheels deep in the road, as with z = 0 at their centres, begins above it instead: tires
 * that are pressed flat throw it off, and out of the reach of the search. Returns a status. */
static int lift_out(const Equilibrium *found)
{
    static const double deep = 0.1; /* of a wheel's radius */
    const gic_model *code = found->engine->code;
    gic_head *self = &found->self->head;
    const double *output = instance_array(self, code->output_offset);
    double most = 0;
    bool lifts = false;
    const int status = found->model->free_base && found->model->wheels ? code->outputs(self) : GIC_OK;
    for (int i = 0; i < found->model->wheels && found->model->free_base && status == GIC_OK; ++i) {
        const double deflection = output[equilibrium_wheel(found, i) + 1];
        most = fmax(most, deflection);
        lifts = lifts || deflection > deep * found->model->wheel[i].radius;
    }
    if (lifts)
        instance_array(self, code->state_offset)[2] += most;
    return status;
}

static bool is_carried(const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    gic_head *self = &found->self->head;
    const double *output = instance_array(self, code->output_offset);
    bool carried = code->outputs(self) != GIC_OK;
    for (int i = 0; i < found->model->wheels; ++i)
        carried = carried || output[equilibrium_wheel(found, i)] > 0;
    return carried;
}

static _Noreturn void fail(const Search *s, Place at)
{
    const Equilibrium *found = s->found;
    const Linear *linear = found->linear;
    const int worst = largest(s, found->f);
    const bool may_roll = linear->of_wheels > 0, of_base = worst - linear->places < 6 && found->model->free_base;
    const char *remedy = "what pushes there at time 0? see force elements, loads, inputs and the road, or start nearer "
                         "to where it can rest";
    if (of_base && !found->model->wheels)
        remedy = "nothing carries the base: give the model wheels, or forces that hold it";
    else if (of_base && equilibrium_lean(found) > equilibrium_tipped)
        remedy = "the vehicle tips over: bring the centre of mass between the wheels (`com`, `center`), or start the "
                 "vehicle nearer to where it stands";
    else if (of_base && !is_carried(found))
        remedy = "no wheel touches the road: start the vehicle upright and just above it (`initial: position`)";
    else if (may_roll && (of_base || worst >= 2 * linear->places))
        remedy = gear_of(found)
                     ? "the vehicle rolls or slides away, for it is in gear: a scene has `gear: 0` in `initial`, "
                       "or lets brakes hold it by `inputs`"
                     : "the vehicle rolls or slides away: let brakes hold it, or start where the road is level";
    else if (of_base)
        remedy = "nothing holds the vehicle against that: check loads, the direction of gravity and the road";
    if (s->limit)
        diag_fail(at,
                  "forces push the mechanism beyond its limits: check springs, free lengths and loads, or add stops",
                  "no static equilibrium found: the largest acceleration left is %.3g, of %s, and further on: %s",
                  found->f[worst], linear->name[worst], s->limit);
    diag_fail(at, remedy, "no static equilibrium found: after %d steps the largest acceleration left is %.3g, of %s",
              found->steps, found->f[worst], linear->name[worst]);
}

static void stop(double *speed)
{
    if (fabs(*speed) <= slowest)
        *speed = 0;
}

/* Spins that Newton's method leaves at 1e-25 rad/s are those of wheels and an engine at rest. */
static void stop_wheels(const Search *s)
{
    const Equilibrium *found = s->found;
    const gic_model *code = &found->linear->engine->code;
    double *fast = tape_array(found->self, code->state_offset) + code->slow_count;
    for (int i = 0; i < found->model->wheels; ++i)
        if (found->model->wheel[i].tire >= 0)
            stop(fast + found->model->wheel[i].fast + FAST_SPIN);
    if (found->model->powertrain)
        stop(fast + found->model->powertrain->fast + POWERTRAIN_SPEED);
}

void equilibrium_exchange_gears(const Equilibrium *found, int32_t other[POWERTRAIN_DISCRETE])
{
    const gic_model *code = &found->linear->engine->code;
    int32_t *gear = (int32_t *)(void *)((char *)found->self + code->discrete_offset) + code->free_base;
    for (int i = 0; i < POWERTRAIN_DISCRETE && found->model->powertrain; ++i) {
        const int32_t kept = gear[i];
        gear[i] = other[i];
        other[i] = kept;
    }
}

static const Equilibrium *find(Pool *pool, const Model *model, const Scene *scene, Solve solve, bool locked)
{
    Equilibrium *found = pool_alloc(pool, sizeof *found);
    found->model = watched(pool, model);
    found->engine = engine_open(pool, "tape", found->model, &(EngineOptions){.solve = solve, .quiet = true});
    found->linear = linear_open(pool, found->engine);
    found->self = (Instance *)(void *)instance_new(pool, found->engine);
    const size_t count = (size_t)found->linear->count, square = (count * count + 1) * sizeof(double);
    const Place at = {scene ? scene->source : model->source, 0, 0};
    Search s = {.pool = pool, .found = found, .unknowns = (int)count - found->linear->places, .h = first};
    found->locked = locked;
    s.settled = !found->linear->of_wheels;
    s.trial = (Instance *)(void *)instance_new(pool, found->engine);
    found->f = pool_alloc(pool, (count + 1) * sizeof(double));
    found->A = pool_alloc(pool, square);
    s.f = pool_alloc(pool, (count + 1) * sizeof(double));
    s.A = pool_alloc(pool, square);
    s.step = pool_alloc(pool, (count + 1) * sizeof(double));
    s.move = pool_alloc(pool, (count + 1) * sizeof(double));
    if (!s.unknowns)
        diag_fail(at, "free a coordinate, or the base", "model '%s' has no freedom: there is no equilibrium to find",
                  model->name);
    int32_t gears[POWERTRAIN_DISCRETE] = {0};
    int status = start(found, scene);
    if (status == GIC_OK)
        status = lift_out(found);
    if (status == GIC_OK && locked)
        equilibrium_exchange_gears(found, gears);
    if (status == GIC_OK)
        status = look(&s, found->self, found->f, found->A);
    if (status != GIC_OK)
        diag_fail(at, "is the initial state one that the mechanism can reach from its design?",
                  "the search for equilibrium can't start: %s",
                  instance_status(pool, found->engine->code, &found->self->head, status));
    gsl_errors_return();
    for (;;) {
        found->residual = fabs(found->f[largest(&s, found->f)]);
        if (newton(&s))
            continue;
        if (found->residual < equilibrium_limit)
            break;
        if (found->steps >= MOST_STEPS || !relax(&s))
            fail(&s, at);
    }
    stop_wheels(&s);
    status = look(&s, found->self, found->f, found->A);
    if (status != GIC_OK)
        diag_fail(at, NULL, "the equilibrium can't be evaluated: %s",
                  instance_status(pool, found->engine->code, &found->self->head, status));
    found->residual = fabs(found->f[largest(&s, found->f)]);
    if (locked)
        equilibrium_exchange_gears(found, gears);
    return found;
}

const Equilibrium *equilibrium_find(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    return find(pool, model, scene, solve, scene && !equilibrium_stands(model, scene));
}

const Equilibrium *equilibrium_find_locked(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    return find(pool, model, scene, solve, true);
}

/* How much the road under the wheels rises a metre along the base's heading: the line of least squares through the
 * heights of the road under their centres. 0: flat, or there are no two wheels one behind the other. */
static double road_climb(const Scene *scene, const Equilibrium *found)
{
    static const double apart = 1e-3; /* m of a wheelbase */
    const Model *model = found->model;
    double A[9], C[9], at[3], road[3], pose[7 * model->bodies], way[model->wheels + 1], height[model->wheels + 1];
    double mean[2] = {0}, rise = 0, run = 0;
    if (!scene->road || found->engine->code->poses(found->self, pose) != GIC_OK)
        return 0;
    mat_from_euler(pose + 3, A);
    for (int w = 0; w < model->wheels; ++w) {
        const double *body = pose + 7 * model->wheel[w].body;
        mat_from_euler(body + 3, C);
        apply3(C, model->wheel[w].center, at);
        add_scaled3(1, body, at);
        scene->road->height(scene->road, 0, 0, at[0], at[1], road);
        way[w] = (A[0] * at[0] + A[3] * at[1]) / hypot(A[0], A[3]);
        height[w] = road[0];
        mean[0] += way[w] / model->wheels;
        mean[1] += height[w] / model->wheels;
    }
    for (int w = 0; w < model->wheels; ++w) {
        rise += (way[w] - mean[0]) * (height[w] - mean[1]);
        run += (way[w] - mean[0]) * (way[w] - mean[0]);
    }
    return run > apart * apart && isfinite(rise / run) ? rise / run : 0;
}

const Scene *equilibrium_scene(Pool *pool, const Scene *scene, const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    const double *state = tape_array(found->self, code->state_offset);
    const size_t coordinates = (size_t)code->coordinate_count + 1;
    Scene *out = pool_alloc(pool, sizeof *out);
    *out = *scene;
    out->value = pool_alloc(pool, coordinates * sizeof *out->value);
    out->given = pool_alloc(pool, coordinates * sizeof *out->given);
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0) {
            out->value[c] = state[code->coordinate_state[c]];
            out->given[c] = true;
        }
    if (!found->locked) { /* else wheels roll, unless the scene gives their spins */
        out->fast = pool_alloc(pool, ((size_t)code->fast_count + 1) * sizeof *out->fast);
        memcpy(out->fast, state + code->slow_count, (size_t)code->fast_count * sizeof *out->fast);
    }
    if (!code->free_base)
        return out;
    memcpy(out->position, state, sizeof out->position);
    memcpy(out->euler, state + 3, sizeof out->euler);
    out->placed = out->rested = true;
    out->climb = road_climb(scene, found);
    scene_along(out);
    return out;
}

bool equilibrium_set_in_motion(Pool *pool, const Scene *scene, const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    const Linear *linear = found->linear;
    const Scene *moving = equilibrium_scene(pool, scene, found);
    double *state = tape_array(found->self, code->state_offset);
    if (!found->locked)
        return false;
    if (code->free_base) {
        memcpy(state + linear->places + 1, moving->velocity, sizeof moving->velocity);
        memcpy(state + linear->places + 4, moving->angular_velocity, sizeof moving->angular_velocity);
    }
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            state[code->coordinate_state[c] + code->slow_count / 2] = moving->rate[c];
    const int status = scene_set_fast(code, moving, &found->self->head);
    if (status != GIC_OK)
        diag_fail((Place){scene->source, 0, 0}, "check the velocities of `initial`",
                  "the equilibrium can't be set in motion: %s",
                  instance_status(pool, code, &found->self->head, status));
    return true;
}

const Scene *equilibrium_start(Pool *pool, const Model *model, const Scene *scene, Solve solve)
{
    if (!scene->equilibrium)
        return scene;
    return scene_even(pool, model, equilibrium_scene(pool, scene, equilibrium_find(pool, model, scene, solve)));
}
