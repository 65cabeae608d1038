/* SPDX-License-Identifier: MIT
 * The engine `auto`: starts at once with code that tcc made, and goes on with a compiler's faster code where a run
 * lasts long enough. The two do the same operations in the same order, so instances, flat memory of equal layout, can
 * change hands between any two steps; whether the compiler has kept every bit is tried before. */
#include "base/catch.h"
#include "base/random.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/engines.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

struct Background {
    Pool *pool;
    const Model *model;
    EngineOptions options;
    const gic_model *own; /* tcc's */
    const char *folder;   /* folder of the object; NULL: not begun */
    pid_t child;          /* the compiling process; 0: none */
    bool done;
    const char *remark; /* the outcome for people; NULL: none */
};

/* ---- the child ----------------------------------------------------------------------------------------------------
 */

static void compile_here(void *context)
{
    const Background *background = context;
    interrupt_release();
    engine_cc(background->pool, background->model, &background->options);
}

/* Compile and leave the object. If the parent is gone by then, remove the folder here. */
static _Noreturn void compile(Background *background, pid_t parent)
{
    const Listener nobody = {.signals = true}; /* they are ours here, whoever called */
    Messages unheard = {NULL, NULL, &nobody};
    const int nothing = open("/dev/null", O_RDWR);
    for (int file = 0; file < 3 && nothing >= 0; ++file)
        dup2(nothing, file);
    setpgid(0, 0); /* the terminal's Ctrl-C is for the parent, which asks us to stop */
    signal(SIGTERM, SIG_DFL);
    const bool good = caught(&unheard, compile_here, background);
    if (getppid() != parent)
        folder_remove(background->folder);
    _exit(good ? 0 : 1);
}

static void stop(void *stopped)
{
    Background *background = stopped;
    if (background->child) {
        kill(background->child, SIGTERM);
        waitpid(background->child, NULL, 0);
    }
    if (background->folder)
        folder_remove(background->folder);
    background->child = 0;
    background->folder = NULL;
    background->done = true;
    caught_disown(background);
}

static void begin(Background *background)
{
    const pid_t parent = getpid();
    char *folder = folder_make(background->pool);
    background->done = true; /* unless the object gets finished */
    if (!folder)
        return;
    background->folder = folder;
    caught_own(stop, background);
    background->options.object = pool_print(background->pool, "%s/model.so", folder);
    fflush(NULL); /* else the child would flush it too */
    const pid_t child = fork();
    if (child == 0)
        compile(background, parent);
    background->child = child > 0 ? child : 0;
    background->done = child < 0;
}

/* ---- the trial ------------------------------------------------------------------------------------------------------
 */

static bool same_layout(const gic_model *a, const gic_model *b)
{
    return a->size == b->size && a->state_offset == b->state_offset && a->rate_offset == b->rate_offset &&
           a->history_offset == b->history_offset && a->scratch_offset == b->scratch_offset &&
           a->discrete_offset == b->discrete_offset && a->input_offset == b->input_offset &&
           a->parameter_offset == b->parameter_offset && a->output_offset == b->output_offset &&
           a->port_offset == b->port_offset && a->link_offset == b->link_offset && !strcmp(a->hash, b->hash);
}

/* Run code on an instance: some steps, with outputs and constraints after each. All results stay in the instance except
 * the last one, which is returned. */
static double exercise(const gic_model *code, gic_head *self)
{
    enum { STEPS = 8 };
    double constraint = 0;
    for (int i = 0; i < STEPS; ++i) {
        gic_self_test test = {.constraint = 0};
        /* dual rate starts with two steps, so four steps cover it */
        if (code->fast_count && i >= STEPS / 2)
            gic_step_dual(code, self, 0.001, 2);
        else
            gic_step(code, self, 0.001, code->implicit && i % 2 ? GIC_ROS3 : GIC_RK4);
        code->outputs(self);
        code->self_test(self, &test);
        constraint += test.constraint;
    }
    return constraint;
}

/* True if both give the same bits on copies of an instance. */
static bool same_from(Pool *pool, const gic_model *a, const gic_model *b, const gic_head *from)
{
    gic_head *one = pool_alloc(pool, a->size), *other = pool_alloc(pool, a->size);
    memcpy(one, from, a->size);
    memcpy(other, from, a->size);
    const double constraint[2] = {exercise(a, one), exercise(b, other)};
    return !memcmp(one, other, a->size) && !memcmp(&constraint[0], &constraint[1], sizeof(double));
}

/* At the present state, and at random ones around it. */
static bool same_bits(Pool *pool, const gic_model *a, const gic_model *b, const gic_head *present)
{
    enum { STATES = 16 };
    Random random = {1};
    gic_head *from = pool_alloc(pool, a->size);
    bool same = same_layout(a, b) && same_from(pool, a, b, present);
    for (int i = 0; i < STATES && same; ++i) {
        memcpy(from, present, a->size);
        double *state = instance_array(from, a->state_offset);
        for (int s = 0; s < a->slow_count + a->fast_count; ++s)
            state[s] += random_uniform(&random, -0.01, 0.01) * (s < a->slow_count / 2 ? 0.1 : 10);
        same = same_from(pool, a, b, from);
    }
    return same;
}

/* The compiled code; NULL if it can't be loaded or gives other bits. */
static const gic_model *load(const Background *background, const gic_head *present)
{
    void *library = dlopen(background->options.object, RTLD_NOW | RTLD_LOCAL);
    const gic_model *code =
        library ? dlsym(library, pool_print(background->pool, "%s_model", background->model->name)) : NULL;
    return code && same_bits(background->pool, background->own, code, present) ? code : NULL;
}

/* ---- the engine -------------------------------------------------------------------------------------------------- */

const gic_model *engine_faster(const Engine *engine, const gic_head *present)
{
    Background *background = engine->background;
    int status;
    if (!background || background->done)
        return NULL;
    if (!background->folder) {
        begin(background);
        return NULL;
    }
    if (waitpid(background->child, &status, WNOHANG) != background->child)
        return NULL;
    background->child = 0;
    const bool compiled = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    const gic_model *code = compiled ? load(background, present) : NULL;
    stop(background);
    background->remark = code
                             ? pool_print(background->pool, "from t = %.6g s on, with the same bits", gic_time(present))
                         : compiled ? "not used: its bits differ from those that the run began with"
                                    : pool_print(background->pool, "none: '%s' failed", background->options.compiler);
    return code;
}

const gic_model *engine_settle(const Engine *engine, const gic_head *present)
{
    const Background *background = engine->background;
    const gic_model *faster = NULL;
    while (background && !background->done && !faster && !interrupt_arrived()) {
        faster = engine_faster(engine, present);
        nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
    }
    return faster;
}

const char *engine_remark(const Engine *engine)
{
    return engine->background ? engine->background->remark : NULL;
}

void engine_rest(const Engine *engine)
{
    if (engine->background)
        stop(engine->background);
}

const Engine *engine_auto(Pool *pool, const Model *model, const EngineOptions *options)
{
    const Engine *tcc = engine_tcc(pool, model, options);
    if (tcc->context) /* the tape runs instead: its instances have another layout */
        return tcc;
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = *tcc;
    engine->name = "auto";
    engine->background = pool_alloc(pool, sizeof *engine->background);
    *engine->background = (Background){.pool = pool, .model = model, .options = *options, .own = tcc->code};
    return engine;
}
