/* SPDX-License-Identifier: MIT
 * entry ENGINE|lanes|implicit MODEL: hostile numbers into every function of a model's descriptor: states, inputs,
 * parameters, ports, discrete states, times, steps, ratios, methods, links, roads, and inputs that go bad within a
 * step. Each call must end in a status that leaves state, rate, time, history and results as they were, bit for bit, or
 * in finite results; and with the number taken back the instance must go on as one that never saw it. Prints a row of
 * the table of attacks. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double poison[] = {NAN,   -NAN,   INFINITY, -INFINITY, 5e-324, -5e-324, DBL_MIN / 2,
                                0.0,   -0.0,   1e-300,   -1e-300,   -1,     1e3,     -1e3,
                                1e6,   -1e6,   1e9,      -1e9,      1e12,   -1e12,   1e16,
                                1e100, -1e100, 1e155,    1e300,     -1e300, DBL_MAX, -DBL_MAX};
static const int whole[] = {INT_MIN, -1000, -3, -1, 0, 1, 2, 3, 4, 5, 17, 1 << 20, INT_MAX};
enum { POISONS = sizeof poison / sizeof *poison, WHOLES = sizeof whole / sizeof *whole };

enum { WARM = 8, AFTER = 4 }; /* steps before, and after the number is taken back */
enum { PATIENCE = 60 };       /* seconds for a call: on a busy machine some of gcp2 take 20 */
static const double step = 1e-4;

typedef struct Trial {
    const Engine *engine;
    const gic_model *code;
    gic_head *good, *self, *before, *after; /* after: AFTER steps on from good */
    gic_real *state, *rate, *pose, *link, *fast;
    gic_self_test test;
    /* arguments of this call */
    double time, length;
    int32_t method, ratio;
    const char *what;   /* is hostile */
    const char *callee; /* and to whom */
    double value;
    int64_t tried, ok, refused, found;
    char first[200]; /* finding */
} Trial;

static char now[200]; /* what is being tried, for who reads of a crash */

static void fall(int signal_number)
{
    static const char line[] = " was being tried\n";
    if (write(STDERR_FILENO, now, strlen(now)) < 0 || write(STDERR_FILENO, line, sizeof line - 1) < 0)
        _exit(3);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static double *array(gic_head *self, size_t offset)
{
    return instance_array(self, offset);
}

static int32_t *discrete(const Trial *t, gic_head *self)
{
    return (int32_t *)(void *)((char *)self + t->code->discrete_offset);
}

static size_t states(const Trial *t)
{
    return (size_t)(t->code->slow_count + t->code->fast_count);
}

static void find(Trial *t, const char *text)
{
    fprintf(stderr, "%s: %s: %s = %g into %s\n", t->code->name, text, t->what, t->value, t->callee);
    if (!t->found++)
        snprintf(t->first, sizeof t->first, "%s: %s = %g into %s", text, t->what, t->value, t->callee);
}

/* ---- the functions ---------------------------------------------------------------------------------------------- */

typedef int Call(Trial *t);

static int call_rhs(Trial *t)
{
    return t->code->rhs(t->self, t->time, array(t->self, t->code->state_offset), t->rate);
}

static int call_settle(Trial *t)
{
    memcpy(t->state, array(t->self, t->code->state_offset), states(t) * sizeof(double));
    return t->code->settle(t->self, t->state);
}

static int call_step(Trial *t)
{
    return gic_step(t->code, t->self, t->length, t->method);
}

static int call_rk4(Trial *t)
{
    return gic_step(t->code, t->self, t->length, GIC_RK4);
}

/* Where the code takes implicit steps. */
static int call_ros2(Trial *t)
{
    return t->code->implicit ? gic_step(t->code, t->self, t->length, GIC_ROS2) : GIC_OK;
}

static int call_ros3(Trial *t)
{
    return t->code->implicit ? gic_step(t->code, t->self, t->length, GIC_ROS3) : GIC_OK;
}

static int call_dual(Trial *t)
{
    return gic_step_dual(t->code, t->self, t->length, t->ratio);
}

static int call_outputs(Trial *t)
{
    return t->code->outputs(t->self);
}

static int call_poses(Trial *t)
{
    return t->code->poses(t->self, t->pose);
}

static int call_self_test(Trial *t)
{
    return t->code->self_test(t->self, &t->test);
}

static int call_link(Trial *t)
{
    return t->code->link ? t->code->link(t->self, t->time, array(t->self, t->code->state_offset), t->link) : GIC_OK;
}

static int call_fast(Trial *t)
{
    const double *fast = array(t->self, t->code->state_offset) + t->code->slow_count;
    return t->code->fast ? t->code->fast(t->self, t->time, t->link, fast, t->fast) : GIC_OK;
}

static int call_roll(Trial *t)
{
    return t->code->roll ? t->code->roll(t->self) : GIC_OK;
}

static int call_shift(Trial *t)
{
    if (t->code->shift)
        (void)t->code->shift(t->self);
    return GIC_OK;
}

static const struct {
    const char *name;
    Call *call;
} functions[] = {{"rhs", call_rhs},          {"settle", call_settle},       {"step", call_step},
                 {"step (rk4)", call_rk4},   {"step_dual", call_dual},      {"outputs", call_outputs},
                 {"poses", call_poses},      {"self_test", call_self_test}, {"link", call_link},
                 {"fast", call_fast},        {"roll", call_roll},           {"shift", call_shift},
                 {"step (ros2)", call_ros2}, {"step (ros3)", call_ros3}};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

/* ---- a call, and what it may do ------------------------------------------------------------------------------------
 */

static void begin(Trial *t)
{
    memcpy(t->self, t->good, t->code->size);
    t->time = gic_time(t->good);
    t->length = step;
    t->method = GIC_AB3;
    t->ratio = 3;
    memset(t->rate, 0x11, states(t) * sizeof(double));
    memset(t->pose, 0x11, 7 * (size_t)t->code->body_count * sizeof(double));
    memcpy(t->fast, t->rate, (size_t)t->code->fast_count * sizeof(double));
    if (t->code->link)
        (void)t->code->link(t->self, t->time, array(t->self, t->code->state_offset), t->link);
    memcpy(t->self, t->good, t->code->size);
}

/* Is a number's pattern still the one of `begin`? */
static bool blank(const double *x, size_t count)
{
    double pattern;
    memset(&pattern, 0x11, sizeof pattern);
    for (size_t i = 0; i < count; ++i)
        if (memcmp(&x[i], &pattern, sizeof pattern))
            return false;
    return true;
}

static bool same(const Trial *t, size_t offset, size_t bytes)
{
    return !memcmp((const char *)t->self + offset, (const char *)t->before + offset, bytes);
}

static bool steps(const Trial *t, Call *call)
{
    return call == call_step || call == call_rk4 || call == call_dual ||
           (t->code->implicit && (call == call_ros2 || call == call_ros3));
}

/* What a function of inputs filled in is the caller's; steps alone take it back. */
static bool keeps_inputs(const Trial *t, Call *call)
{
    return !t->self->input_function || steps(t, call);
}

/* Both begin with the rate of the present state, which is there then, and may fail over what follows from it. */
static bool leaves_rate(const Trial *t, Call *call)
{
    return (call == call_outputs || call == call_self_test) &&
           gic_finite(array(t->self, t->code->rate_offset), (int32_t)states(t));
}

static void check_untouched(Trial *t, Call *call)
{
    const gic_model *code = t->code;
    const gic_head *a = t->self, *b = t->before;
    const double times[2][2] = {{a->start_time, a->step}, {b->start_time, b->step}};
    if (!same(t, code->state_offset, states(t) * sizeof(double)))
        find(t, "state changed");
    if (!same(t, code->history_offset, GIC_HISTORY(states(t), (size_t)code->fast_count) * sizeof(double)) ||
        a->history != b->history)
        find(t, "history changed");
    if (!same(t, code->rate_offset, states(t) * sizeof(double)) && !leaves_rate(t, call))
        find(t, "rate changed");
    if (memcmp(times[0], times[1], sizeof *times) || a->steps != b->steps || a->method != b->method ||
        a->ratio != b->ratio)
        find(t, "time changed");
    if (keeps_inputs(t, call) && !same(t, code->input_offset, (size_t)code->input_count * sizeof(double)))
        find(t, "input changed");
    if (!same(t, code->output_offset, (size_t)code->output_count * sizeof(double)))
        find(t, "output changed");
    if (!same(t, code->discrete_offset, (size_t)code->discrete_count * sizeof(int32_t)))
        find(t, "discrete states changed");
    if (!blank(t->rate, states(t)) || !blank(t->pose, 7 * (size_t)code->body_count) ||
        !blank(t->fast, (size_t)code->fast_count))
        find(t, "a result was written");
}

static void check_result(Trial *t, Call *call)
{
    const gic_model *code = t->code;
    const int32_t count = (int32_t)states(t);
    if (steps(t, call) &&
        (!gic_finite(array(t->self, code->state_offset), count) || !(gic_time(t->self) > gic_time(t->before))))
        find(t, "no state after a step");
    if (call == call_rhs && !gic_finite(t->rate, count))
        find(t, "rate is not finite");
    if (call == call_settle && !gic_finite(t->state, count))
        find(t, "settled state is not finite");
    if (call == call_outputs && (!gic_finite(array(t->self, code->output_offset), code->output_count) ||
                                 !gic_finite(array(t->self, code->rate_offset), count)))
        find(t, "output is not finite");
    if (call == call_poses && !gic_finite(t->pose, 7 * code->body_count))
        find(t, "pose is not finite");
    if (call == call_self_test && !gic_finite(&t->test.constraint, 1))
        find(t, "self-test is not finite");
    if (call == call_fast && code->fast && !gic_finite(t->fast, code->fast_count))
        find(t, "fast rate is not finite");
    if (call == call_link && code->link && !gic_finite(t->link, code->link_count))
        find(t, "link is not finite");
}

/* Back to what the caller owns of the good instance: only the Newton start and the work space are what the call left
 * there. It must go on as the good one does, to what rounding makes of another start, be that thousands of turns away.
 *
 * An engine with coordinates of its own (`enter`) may have picked others after an accepted call, which is for a
 * snapshot to take back; what it keeps outside of the instance stays: factors of another place, with which its Newton
 * ends elsewhere within the 1e-14 that it allows. Tires make 1.2e-11 of that after a refused call, Andrews'
 * mechanism 1.3e-9 after an accepted one, of another assembly mode. What an accepted call took hundreds of metres away
 * may be out of reach from there (FORMAT.md section 14); then too a snapshot takes it back. */
static void check_recovery(Trial *t, int accepted)
{
    const gic_model *code = t->code;
    const double *expected = array(t->after, code->state_offset), *found = array(t->self, code->state_offset);
    const gic_head head = *t->good;
    const bool snapshot = accepted && t->engine->enter;
    const double tolerance = snapshot ? 3e-9 : t->engine->enter ? 3e-11 : 1e-11;
    if (snapshot)
        memcpy(t->self, t->good, code->size);
    const int32_t flip = t->self->flip;
    *t->self = head;
    t->self->flip = flip;
    const struct {
        size_t offset, bytes;
    } own[] = {{code->state_offset, states(t) * sizeof(double)},
               {code->rate_offset, states(t) * sizeof(double)},
               {code->history_offset, GIC_HISTORY(states(t), (size_t)code->fast_count) * sizeof(double)},
               {code->discrete_offset, (size_t)code->discrete_count * sizeof(int32_t)},
               {code->input_offset, (size_t)code->input_count * sizeof(double)},
               {code->parameter_offset, (size_t)code->parameter_count * sizeof(double)},
               {code->port_offset, (size_t)code->port_count * sizeof(double)},
               {code->link_offset, 3 * (size_t)code->link_count * sizeof(double)}};
    for (size_t i = 0; i < sizeof own / sizeof *own; ++i)
        memcpy((char *)t->self + own[i].offset, (const char *)t->good + own[i].offset, own[i].bytes);
    for (int i = 0; i < AFTER; ++i) {
        int status = gic_step(code, t->self, step, GIC_AB3);
        if (status == GIC_ERROR_REACH && accepted && i == 0) {
            memcpy(t->self, t->good, code->size);
            status = gic_step(code, t->self, step, GIC_AB3);
        }
        if (status != GIC_OK) {
            find(t, "it does not go on");
            return;
        }
    }
    for (size_t i = 0; i < states(t); ++i)
        if (!(fabs(found[i] - expected[i]) <= tolerance * (1 + fabs(expected[i])))) {
            find(t, "it goes on elsewhere");
            return;
        }
}

static void attack(Trial *t, int function)
{
    t->callee = functions[function].name;
    snprintf(now, sizeof now, "%s: %s = %g into %s", t->code->name, t->what, t->value, t->callee);
    memcpy(t->before, t->self, t->code->size);
    alarm(PATIENCE);
    const int status = functions[function].call(t);
    alarm(0);
    ++t->tried;
    if (status == GIC_OK) {
        ++t->ok;
        check_result(t, functions[function].call);
    } else {
        ++t->refused;
        if (status > 0 || status < GIC_STATUS_LAST)
            find(t, "an unknown status");
        check_untouched(t, functions[function].call);
    }
    check_recovery(t, status == GIC_OK);
}

/* ---- where hostile numbers go --------------------------------------------------------------------------------------
 */

static void attack_array(Trial *t, const char *what, size_t offset, int32_t count, const gic_signal *signal)
{
    for (int32_t i = 0; i < count; ++i)
        for (int k = 0; k < POISONS; ++k)
            for (int f = 0; f < FUNCTIONS; ++f) {
                char name[80];
                snprintf(name, sizeof name, "%s %s", what, signal[i].name);
                t->what = name;
                t->value = poison[k];
                begin(t);
                array(t->self, offset)[i] = poison[k];
                attack(t, f);
            }
}

static void attack_discrete(Trial *t)
{
    for (int32_t i = 0; i < t->code->discrete_count; ++i)
        for (int k = 0; k < WHOLES; ++k)
            for (int f = 0; f < FUNCTIONS; ++f) {
                t->what = t->code->discrete[i].name;
                t->value = whole[k];
                begin(t);
                discrete(t, t->self)[i] = whole[k];
                attack(t, f);
            }
}

/* Times, of the instance and of a call; lengths of steps, with and without history. */
static void attack_time(Trial *t)
{
    for (int k = 0; k < POISONS; ++k) {
        t->value = poison[k];
        for (int f = 0; f < FUNCTIONS; ++f) {
            t->what = "time";
            begin(t);
            t->time = poison[k];
            attack(t, f);
            t->what = "start time";
            begin(t);
            gic_restart(t->self, poison[k]);
            attack(t, f);
        }
        for (int f = 2; f < 5; ++f) {
            t->what = "step";
            begin(t);
            t->length = poison[k];
            attack(t, f);
        }
    }
    for (int k = 0; k < WHOLES; ++k) {
        t->value = whole[k];
        t->what = "method";
        begin(t);
        t->method = whole[k];
        attack(t, 2);
        t->what = "ratio";
        begin(t);
        t->ratio = whole[k];
        attack(t, 4);
    }
}

static void attack_links(Trial *t)
{
    for (int32_t i = 0; i < t->code->link_count; ++i)
        for (int k = 0; k < POISONS; ++k) {
            t->what = "link";
            t->value = poison[k];
            begin(t);
            t->link[i] = poison[k];
            attack(t, 9);
        }
}

/* ---- callbacks that go bad
 * ------------------------------------------------------------------------------------------- */

typedef struct Fickle {
    gic_road road;
    int calls, bad_from; /* which call is the first bad one */
    int part;            /* of a road: 0 height, 1 and 2 slopes, 3 friction */
    double value;
    int32_t input;
} Fickle;

static Fickle fickle;

static void fickle_input(void *user, int32_t lane, double time, double *input)
{
    (void)user;
    (void)lane;
    (void)time;
    if (fickle.calls++ >= fickle.bad_from)
        input[fickle.input] = fickle.value;
}

static void fickle_height(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = out[2] = 0;
    if (fickle.part < 3 && fickle.calls++ >= fickle.bad_from)
        out[fickle.part] = fickle.value;
}

static double fickle_friction(const gic_road *road, int32_t lane, double time, double x, double y)
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    return fickle.part == 3 && fickle.calls++ >= fickle.bad_from ? fickle.value : 1;
}

static void attack_callbacks(Trial *t)
{
    static const char *const parts[] = {"road height", "road slope x", "road slope y", "road friction"};
    for (int k = 0; k < POISONS; ++k)
        for (int from = 0; from < 7; from += 3)
            for (int f = 0; f < FUNCTIONS; ++f) {
                t->value = poison[k];
                for (int32_t i = 0; i < t->code->input_count; ++i) {
                    t->what = "input within a step";
                    begin(t);
                    fickle = (Fickle){.bad_from = from, .value = poison[k], .input = i};
                    t->self->input_function = fickle_input;
                    attack(t, f);
                }
                for (int part = 0; part < 4 && t->code->wheel_count; ++part) {
                    t->what = parts[part];
                    begin(t);
                    fickle = (Fickle){
                        {fickle_height, fickle_friction, NULL, NULL, GIC_ROAD_OWN}, 0, from, part, poison[k], 0};
                    t->self->road = &fickle.road;
                    attack(t, f);
                }
            }
}

/* A set-up that fails leaves an instance that no call makes numbers of; one that follows makes everything good. */
static void attack_setup(Trial *t)
{
    const gic_model *code = t->code;
    const int32_t count = code->parameter_count;
    double *wanted = array(t->good, code->parameter_offset), given[count + 1];
    memcpy(given, wanted, (size_t)count * sizeof *given);
    for (int32_t i = 0; i < count; ++i)
        for (int k = 0; k < POISONS; ++k) {
            begin(t);
            t->what = code->parameter[i].name;
            t->value = poison[k];
            t->callee = "setup_with";
            snprintf(now, sizeof now, "%s: %s = %g into setup_with", code->name, t->what, t->value);
            given[i] = poison[k];
            alarm(PATIENCE);
            const int status = code->setup_with(t->self, given);
            alarm(0);
            given[i] = wanted[i];
            ++t->tried;
            t->ok += status == GIC_OK;
            t->refused += status != GIC_OK;
            if (status == GIC_OK && code->outputs(t->self) == GIC_OK &&
                !gic_finite(array(t->self, code->output_offset), code->output_count))
                find(t, "output is not finite");
            for (int f = 0; f < FUNCTIONS && status != GIC_OK; ++f) {
                t->callee = functions[f].name;
                t->time = gic_time(t->self);
                if (f != 1 && f != 9 && f != 10 && f != 11 && (f != 8 || code->link) && (f < 12 || code->implicit) &&
                    functions[f].call(t) == GIC_OK)
                    find(t, "works after a set-up that failed");
            }
            if (code->setup_with(t->self, given) != GIC_OK)
                find(t, "no set-up afterwards");
            check_recovery(t, 0);
        }
}

/* ---- the model
 * --------------------------------------------------------------------------------------------------------- */

static gic_head *instance(Pool *pool, const Engine *engine)
{
    return instance_new(pool, engine);
}

int main(int argc, char **argv)
{
    const bool lanes = argc == 3 && !strcmp(argv[1], "lanes");
    const bool implicit = argc == 3 && !strcmp(argv[1], "implicit");
    if (argc != 3 || (!lanes && !implicit && !engine_known(argv[1]))) {
        fputs("usage: entry ENGINE|lanes|implicit MODEL\n", stderr);
        return 2;
    }
    signal(SIGSEGV, fall);
    signal(SIGFPE, fall);
    signal(SIGABRT, fall);
    signal(SIGALRM, fall);
    Pool *pool = pool_new();
    const Model *model = model_read(pool, argv[2]);
    const EngineOptions options = {
        .compiler = compiler_default(), .flags = "", .lanes = lanes ? 4 : 0, .implicit = implicit, .quiet = true};
    const Engine *engine = engine_open(pool, lanes ? "cc" : implicit ? "tcc" : argv[1], model, &options);
    const gic_model *code = engine->code;
    Trial t = {.engine = engine,
               .code = code,
               .good = instance(pool, engine),
               .self = instance(pool, engine),
               .before = instance(pool, engine),
               .after = instance(pool, engine)};
    t.state = pool_alloc(pool, states(&t) * sizeof(double) + 8);
    t.rate = pool_alloc(pool, states(&t) * sizeof(double) + 8);
    t.fast = pool_alloc(pool, states(&t) * sizeof(double) + 8);
    t.pose = pool_alloc(pool, 7 * (size_t)code->body_count * sizeof(double) + 8);
    t.link = pool_alloc(pool, (size_t)code->link_count * sizeof(double) + 8);
    if (code->setup(t.good) != GIC_OK) {
        fprintf(stderr, "%s: no set-up\n", argv[2]);
        return 1;
    }
    for (int i = 0; i < WARM + AFTER; ++i) {
        if (i == WARM)
            memcpy(t.after, t.good, code->size);
        if (gic_step(code, i < WARM ? t.good : t.after, step, GIC_AB3) != GIC_OK) {
            fprintf(stderr, "%s: no steps\n", argv[2]);
            return 1;
        }
    }
    attack_array(&t, "state", code->state_offset, (int32_t)states(&t), code->state);
    attack_array(&t, "input", code->input_offset, code->input_count, code->input);
    attack_array(&t, "parameter", code->parameter_offset, code->parameter_count, code->parameter);
    attack_array(&t, "port", code->port_offset, code->port_count, code->port);
    attack_discrete(&t);
    attack_time(&t);
    attack_links(&t);
    attack_callbacks(&t);
    attack_setup(&t);
    printf("entry points | %s, %s | %lld | %lld | %lld | %lld | %s\n", code->name, argv[1], (long long)t.tried,
           (long long)t.ok, (long long)t.refused, (long long)t.found, t.found ? t.first : "ok");
    engine_close(engine);
    pool_free(pool);
    return t.found != 0;
}
