/* SPDX-License-Identifier: MIT
 * Steady response to steering: about straight motion at a speed, dz/dt = A z + b u with the speed held and x, y and yaw
 * left out, the steady z of a unit of the steering coordinate u. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/sheet.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

static const double speeds[] = {10, 20, 30}; /* m/s */

enum { X = 0, Y = 1, Z = 2, ROLL = 3, PITCH = 4, YAW = 5 };

/* From here on notes tell: a mean angle of wheels, rad, of an axle or by which the steering is off for the vehicle to
 * run straight ahead; a vertical acceleration, m/s^2. */
static const double oblique = 2e-3, lifting = 0.2;

/* Motions that are left out: places along which nothing changes, and the speed. */
static bool is_left_out(const Linear *linear, int i)
{
    return i == X || i == Y || i == YAW || i == linear->places + X;
}

/* A brake that drags on a rolling wheel is wound up and slips, with a torque that is constant: about a windup of 0 its
 * elastic pad would tie the wheel to its carrier. Brakes that are not applied keep theirs, which changes nothing. */
static int wind_brakes(const Sheet *sheet, Instance *self)
{
    const gic_model *code = sheet->found->engine->code;
    const Model *model = sheet->model;
    const int slow = code->slow_count;
    const size_t all = (size_t)(slow + code->fast_count);
    double *state = tape_array(self, code->state_offset), *fast = state + slow;
    double *rate[2] = {pool_alloc(sheet->pool, all * sizeof **rate), pool_alloc(sheet->pool, all * sizeof **rate)};
    int status = GIC_OK;
    for (int wound = 0; wound < 2 && status == GIC_OK; ++wound) {
        for (int i = 0; i < model->wheels; ++i)
            if (wheel_fast_states(&model->wheel[i]) > FAST_BRAKE)
                fast[model->wheel[i].fast + FAST_BRAKE] =
                    wound ? copysign(1, fast[model->wheel[i].fast + FAST_SPIN]) : 0;
        status = code->rhs(self, gic_time(&self->head), state, rate[wound]);
    }
    for (int i = 0; i < model->wheels && status == GIC_OK; ++i) {
        const int spin = slow + model->wheel[i].fast + FAST_SPIN;
        if (wheel_fast_states(&model->wheel[i]) > FAST_BRAKE && rate[0][spin] == rate[1][spin])
            fast[model->wheel[i].fast + FAST_BRAKE] = 0;
    }
    return status;
}

int sheet_set_in_motion(const Sheet *sheet, Instance *self, double speed)
{
    const gic_model *code = sheet->found->engine->code;
    double *state = tape_array(self, code->state_offset), A[9], drawn[9], ahead[3];
    if (sheet->model->powertrain) { /* in neutral, for in gear the converter drives or brakes wheels that roll freely */
        int32_t *discrete = (int32_t *)(void *)((char *)self + code->discrete_offset);
        discrete[code->free_base + POWERTRAIN_GEAR] = discrete[code->free_base + POWERTRAIN_BEFORE] = 0;
    }
    mat_from_euler(state + 3, A);
    mat_from_euler(sheet->model->body[BODY_BASE].euler, drawn);
    apply3(A, drawn, ahead); /* x of the drawing is the first row of `drawn` in the axes of the base */
    double *velocity = state + sheet->found->linear->places + 1;
    const double level = hypot(ahead[0], ahead[1]); /* the base may rest with a pitch, and the road is level */
    velocity[0] = speed * ahead[0] / level;
    velocity[1] = speed * ahead[1] / level;
    velocity[2] = 0;
    const int status = scene_set_fast(code, NULL, &self->head);
    return status == GIC_OK ? wind_brakes(sheet, self) : status;
}

/* False for a state that nothing changes, or that changes nothing, such as the windup of a brake that is not applied.
 */
static bool matters(int n, const double *A, const double *b, int i)
{
    bool changes = false, changed = b[i] != 0;
    for (int j = 0; j < n; ++j) {
        changes = changes || A[j * n + i] != 0;
        changed = changed || A[i * n + j] != 0;
    }
    return changes && changed;
}

/* sheet_respond(), and the steady motion [linear->count] into which the vehicle goes as it stands, with the steering
 * left alone: A z + f = 0; NULL: not asked for. */
static int respond(const Sheet *sheet, int steer, double speed, double *z, double *falls, double *left_alone)
{
    const Linear *linear = sheet->found->linear;
    const gic_model *code = sheet->found->engine->code;
    const int all = linear->count;
    Instance *self = (Instance *)(void *)instance_new(sheet->pool, sheet->found->engine);
    double *f = pool_alloc(sheet->pool, (size_t)all * sizeof *f), *b = pool_alloc(sheet->pool, (size_t)all * sizeof *b);
    double *A = pool_alloc(sheet->pool, (size_t)all * (size_t)all * sizeof *A);
    int *kept = pool_alloc(sheet->pool, (size_t)all * sizeof *kept), n = 0;
    bool jump;
    memcpy(self, sheet->found->self, code->size);
    int status = sheet_set_in_motion(sheet, self, speed);
    if (status == GIC_OK)
        status = linearize(linear, self, f, A);
    if (status == GIC_OK)
        status = linear_column(linear, self, LINEAR_INPUT, code->coordinate_input[steer], b, 0, NULL, &jump);
    if (status != GIC_OK)
        return status;
    if (falls) /* of the centre of mass, as the base carries it: a moment alone does not count */
        *falls = f[linear->places + PITCH] * (sheet->com[0] - sheet->model->body[BODY_BASE].position[0]) -
                 f[linear->places + Z];
    for (int i = 0; i < all; ++i)
        if (!is_left_out(linear, i) && matters(all, A, b, i))
            kept[n++] = i;
    for (int i = 0; i < n; ++i) { /* towards the front of A: row i comes from one at or after it */
        for (int j = 0; j < n; ++j)
            A[i * n + j] = A[kept[i] * all + kept[j]];
        b[i] = -b[kept[i]];
        f[i] = kept[i] < linear->places ? 0 : -f[kept[i]]; /* places: the way along the axes of a base with a pitch */
    }
    if (left_alone) {
        double *copy = pool_alloc(sheet->pool, ((size_t)n * (size_t)n + 1) * sizeof *copy);
        memcpy(copy, A, (size_t)n * (size_t)n * sizeof *copy);
        memset(left_alone, 0, (size_t)all * sizeof *left_alone);
        const bool solved = kc_solve(n, copy, f) && gic_finite(f, n);
        for (int i = 0; i < n && solved; ++i)
            left_alone[kept[i]] = f[i];
    }
    memset(z, 0, (size_t)all * sizeof *z);
    if (!kc_solve(n, A, b) || !gic_finite(b, n))
        return GIC_ERROR_SINGULAR;
    for (int i = 0; i < n; ++i)
        z[kept[i]] = b[i];
    return GIC_OK;
}

int sheet_respond(const Sheet *sheet, int steer, double speed, double *z, double *falls)
{
    return respond(sheet, steer, speed, z, falls, NULL);
}

/* The axle that is steered, by a driven coordinate; NULL: there is none, *why. */
static const KcAxle *steered(const Sheet *sheet, const char **why)
{
    const Model *model = sheet->model;
    const double *e = model->body[BODY_BASE].euler;
    *why = "no axle is steered by a driven coordinate";
    for (int w = 0; w < model->wheels; ++w)
        if (model->wheel[w].tire < 0)
            *why = "a wheel has no tire";
    if (fabs(e[0]) < 1 - 1e-12)
        *why = "the axes of the base are not those of the drawing";
    if (strncmp(*why, "no axle", 7) != 0)
        return NULL;
    for (int a = 0; a < sheet->kc->axles; ++a) {
        const KcAxle *axle = &sheet->kc->axle[a];
        if ((axle->refusal && !axle->rigid) || axle->steer < 0 || !model->coordinate[axle->steer].driven)
            continue;
        if (!axle->unit)
            return axle;
        *why =
            pool_print(sheet->pool, "axle %s, which is steered, belongs to a unit that turns by '%s' against the base",
                       axle->name, axle->unit);
    }
    return NULL;
}

static const double slight = 1e-6; /* of the largest angle of an axle's wheels */

/* Road-wheel angles of an axle by a unit of its steering at rest. */
typedef struct Turning {
    double mean, most;   /* of all its wheels, signed, to the left; the largest one's size */
    double standing;     /* the mean angle itself */
    const KcWheel *idle; /* a wheel that it does not turn; NULL: none */
} Turning;

/* All 0 where it can not be found. */
static Turning turning_of(const Sheet *sheet, const KcAxle *axle)
{
    const KcAxle steering = {.steer = axle->steer};
    KcLook *look = kc_look_new(sheet->kc, axle->rigid ? &steering : axle);
    Turning turning = {0, 0, 0, NULL};
    double angle[KC_WHEELS], still[KC_WHEELS] = {0}, along[KC_WHEELS + 1] = {1};
    if (kc_look(sheet->kc, sheet->w, look) != GIC_OK || (!axle->rigid && !kc_along(axle, look, false, still, 1, along)))
        return turning;
    for (int i = 0; i < axle->wheels; ++i) {
        KcPose pose, rate;
        kc_pose(&axle->wheel[i], look, &pose);
        kc_rate(&axle->wheel[i], look, &pose, along, &rate);
        angle[i] = kc_steer_rate(&pose, &rate);
        turning.most = fmax(turning.most, fabs(angle[i]));
        turning.mean += angle[i] / axle->wheels;
        turning.standing += kc_steer(&pose) / axle->wheels;
    }
    for (int i = 0; i < axle->wheels; ++i)
        if (fabs(angle[i]) <= slight * turning.most)
            turning.idle = &axle->wheel[i];
    return turning;
}

/* The last axle of the base's unit, where all of its axles are steered by one coordinate; NULL: another one stays. */
static const KcAxle *steered_too(const Sheet *sheet, const KcAxle *axle)
{
    const KcAxle *last = NULL;
    for (int a = 0; a < sheet->kc->axles; ++a) {
        const KcAxle *other = &sheet->kc->axle[a];
        if (other->unit || other == axle)
            continue;
        if (other->steer != axle->steer)
            return NULL;
        last = other;
    }
    return last;
}

const KcAxle *sheet_steered(const Sheet *sheet, double *angle, const char **why, const char **remedy)
{
    Pool *pool = sheet->pool;
    const KcAxle *axle = steered(sheet, why);
    *angle = 0;
    *remedy = "drive the rack or the steering wheel: `driven: true` in its coordinate";
    if (!axle)
        return NULL;
    const char *name = sheet->model->coordinate[axle->steer].name;
    const Turning turning = turning_of(sheet, axle);
    const KcAxle *last = steered_too(sheet, axle);
    *angle = last ? turning.mean - turning_of(sheet, last).mean : axle->ahead * turning.mean;
    if (turning.idle) {
        *why = pool_print(pool, "the wheels of axle %s are steered separately, %s not by %s", axle->name,
                          turning.idle->name, name);
        *remedy = "join them, as by a rack, or drive them by one coordinate";
    } else if (fabs(turning.mean) <= slight * turning.most) {
        *why = pool_print(pool, "%s steers the wheels of axle %s against each other: their mean angle does not change",
                          name, axle->name);
        *remedy = "join them so that they turn the same way";
    } else if (!(sheet->wheelbase > 0)) {
        *why = "there is one axle";
        *remedy = "name a vehicle with axles in front and behind; --kc looks at a single axle";
    } else if (fabs(*angle) <= slight * turning.most) {
        *why = pool_print(pool, "%s steers axles %s and %s alike, by which the vehicle goes aside and does not turn",
                          name, axle->name, last->name);
        *remedy = pool_print(pool, "let %s turn the wheels of axle %s less, or the other way", name, last->name);
    } else
        return axle;
    return NULL;
}

double sheet_yaw_rate(const Sheet *sheet, const double *z)
{
    return z[sheet->found->linear->places + YAW];
}

/* The mean steer angle, rad, to the left, at which the wheels of an axle stand at rest. */
static double standing_of(const Sheet *sheet, const KcAxle *axle)
{
    const KcAxle none = {.steer = -1};
    KcLook *look = kc_look_new(sheet->kc, &none);
    double mean = 0;
    if (kc_look(sheet->kc, sheet->w, look) != GIC_OK)
        return 0;
    for (int i = 0; i < axle->wheels; ++i) {
        KcPose pose;
        kc_pose(&axle->wheel[i], look, &pose);
        mean += kc_steer(&pose) / axle->wheels;
    }
    return mean;
}

/* "wheels of axle rear stand at 2.86 deg": of all that do not stand straight; NULL: there are none. */
static const char *askew(const Sheet *sheet, const KcAxle *but)
{
    const char *names = NULL;
    for (int a = 0; a < sheet->kc->axles; ++a) {
        const KcAxle *axle = &sheet->kc->axle[a];
        const double angle = axle == but || axle->unit ? 0 : standing_of(sheet, axle);
        if (fabs(angle) > oblique)
            names = pool_print(sheet->pool, "%s%swheels of axle %s stand at %.3g deg on the mean", names ? names : "",
                               names ? ", " : "", axle->name, 57.29577951308232 * angle);
    }
    return names;
}

/* Tell that straight ahead is a motion that does not last: at a speed the vehicle turns by `turns`, m/s^2 to the left,
 * as it stands, which the steering, turned by `needed`, rad of its wheels to the left, would balance. */
static void tell_oblique(Sheet *sheet, const KcAxle *axle, double speed, double turns, double needed)
{
    const Coordinate *c = &sheet->model->coordinate[axle->steer];
    const Turning turning = turning_of(sheet, axle);
    const double standing = turning.standing, by_unit = turning.mean, at = sheet->w[axle->steer];
    const double grain = 1e-3 * (c->range[1] - c->range[0]);
    const char *others = askew(sheet, axle), *all = askew(sheet, NULL);
    if (fabs(standing) > oblique && !others)
        sheet_note(sheet,
                   pool_print(sheet->pool,
                              "cornering: the wheels of axle %s do not stand straight but turned by %.3g deg on the "
                              "mean, with %s at %.4g %s: numbers are those of a motion that does not last; centre the "
                              "steering, `initial: %.4g` or near it",
                              axle->name, 57.29577951308232 * standing, c->name, at, sheet->model->input[c->input].unit,
                              grain * round((at - standing / by_unit) / grain) + 0.0));
    else
        sheet_note(sheet,
                   pool_print(sheet->pool,
                              "cornering: the vehicle does not run straight ahead: at %g m/s it turns to the %s by "
                              "%.3g m/s^2, as if the wheels of axle %s were turned by %.3g deg%s%s: numbers are those "
                              "of a motion that does not last; %s",
                              speed, turns > 0 ? "left" : "right", fabs(turns), axle->name, 57.29577951308232 * -needed,
                              all ? "; " : "", all ? all : "",
                              all ? "straighten these axles" : "what pushes it aside? see loads, brakes and tires"));
}

void sheet_cornering(Sheet *sheet)
{
    const char *why, *remedy;
    double angle;
    const Linear *linear = sheet->found->linear;
    const KcAxle *axle = sheet_steered(sheet, &angle, &why, &remedy);
    double *z = pool_alloc(sheet->pool, (size_t)linear->count * sizeof *z);
    double *left_alone = pool_alloc(sheet->pool, (size_t)linear->count * sizeof *left_alone);
    bool told = false;
    if (!axle) {
        sheet_miss(sheet, pool_print(sheet->pool, "cornering: %s", why));
        return;
    }
    for (size_t k = 0; k < sizeof speeds / sizeof *speeds; ++k) {
        const double v = speeds[k];
        const char *section = pool_print(sheet->pool, "Cornering at %g m/s", v);
        const char *name = pool_print(sheet->pool, "at_%g", v);
        double falls;
        const int status = respond(sheet, axle->steer, v, z, &falls, left_alone);
        if (status != GIC_OK) {
            sheet_miss(sheet, pool_print(sheet->pool, "cornering at %g m/s: no steady response", v));
            continue;
        }
        const double yaw = sheet_yaw_rate(sheet, z), lateral = v * yaw;
        const double turns = v * sheet_yaw_rate(sheet, left_alone), needed = -turns / lateral * angle;
        if (fabs(needed) > oblique && !told)
            tell_oblique(sheet, axle, v, turns, axle->ahead * needed);
        told = told || fabs(needed) > oblique;
        const double lever = sheet->com[0] - sheet->model->body[BODY_BASE].position[0];
        const double slip = (z[linear->places + Y] + yaw * lever) / v;
        sheet_add(sheet, section, pool_print(sheet->pool, "%s.yaw_gain", name), "Yaw rate by the steer angle", "1/s",
                  yaw / angle);
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.understeer", name), "Understeer gradient", "rad s^2/m",
                  angle / lateral - sheet->wheelbase / (v * v));
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.roll_gradient", name), "Roll gradient", "rad s^2/m",
                  z[ROLL] / lateral);
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.sideslip_gradient", name), "Side-slip gradient", "rad s^2/m",
                  slip / lateral);
        if (fabs(falls) > lifting)
            sheet_note(sheet, pool_print(sheet->pool,
                                         "cornering at %g m/s: there the vehicle is not in equilibrium but pushed %s "
                                         "with %.3g m/s^2, as by air forces; loads and heights are those at rest",
                                         v, falls > 0 ? "down" : "up", fabs(falls)));
    }
}
