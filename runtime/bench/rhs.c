/* SPDX-License-Identifier: MIT
 * One right-hand side of every variant of the code, side by side: its operations, its time, its ratio to the
 * interpreted engines, and its share of the processor's peak. */
#include "base/message.h"
#include "base/text.h"
#include "bench/bench.h"
#include "bench/calls.h"
#include "engine/engine.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/engines.h"
#include "run/run.h"
#include "run/variable_step.h"
#include "scene/scene.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

/* A way to compile and call right-hand sides. */
typedef struct Variant {
    const char *engine, *compiler; /* compiler: NULL: that of the command line, or none at all */
    const char *flags;
    Solve solve;
    bool single;
    bool newton; /* Newton's iteration everywhere, independent of the command line */
    int lanes;   /* of alike parts of the vehicle; 0: one by one */
} Variant;

#define FASTEST "-O3 -march=native -ffp-contract=fast"
/* clang's own vectors of other operations cost 2 to 5 percent in lanes and gain nothing */
#define FASTEST_CLANG FASTEST " -fno-slp-vectorize"
#define NEAR(error) "-O2 -DGIC_RECOVERY_ERROR=" #error

/* The first one is compared with all others: double precision, reduced form. */
static const Variant every_variant[] = {
    {"cc", NULL, "-O2", SOLVE_REDUCED, false, false, 0},
    {"cc", NULL, "-O3", SOLVE_REDUCED, false, false, 0},
    {"cc", NULL, FASTEST, SOLVE_REDUCED, false, false, 0},
    {"cc", "clang", "-O2", SOLVE_REDUCED, false, false, 0},
    {"cc", "clang", FASTEST_CLANG, SOLVE_REDUCED, false, false, 0},
    {"cc", NULL, "-O2", SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, NEAR(1e-10), SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, NEAR(1e-8), SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, NEAR(1e-6), SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, NEAR(1e-4), SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, NEAR(1e-2), SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, FASTEST, SOLVE_REDUCED, false, true, 0},
    {"cc", "clang", FASTEST_CLANG, SOLVE_REDUCED, false, true, 0},
    {"cc", NULL, "-O2", SOLVE_AUGMENTED, false, false, 0},
    {"cc", NULL, FASTEST, SOLVE_AUGMENTED, false, false, 0},
    {"cc", NULL, "-O2 -DGIC_FLOAT", SOLVE_REDUCED, true, false, 0},
    {"cc", NULL, FASTEST " -DGIC_FLOAT", SOLVE_REDUCED, true, false, 0},
    {"tcc", NULL, "", SOLVE_REDUCED, false, false, 0},
    {"tape", NULL, "", SOLVE_REDUCED, false, false, 0},
    {"gic", NULL, "", SOLVE_REDUCED, false, false, 0},
    {"gcp1", NULL, "", SOLVE_REDUCED, false, false, 0},
    {"gcp2", NULL, "", SOLVE_REDUCED, false, false, 0},
    {"cc", NULL, FASTEST, SOLVE_REDUCED, false, false, 4},
    {"cc", "clang", FASTEST_CLANG, SOLVE_REDUCED, false, false, 4},
    {"cc", NULL, FASTEST, SOLVE_REDUCED, false, true, 4},
    {"cc", "clang", FASTEST_CLANG, SOLVE_REDUCED, false, true, 4},
};

enum {
    VARIANTS = sizeof every_variant / sizeof *every_variant,
    STRETCHES = 48, /* of the scene, or fewer */
    CALLS = 16,     /* of each, timed together */
    WARM = 4        /* before them */
};

/* A variant that is measured. */
typedef struct Subject {
    const char *name;
    const Variant *variant;
    const Engine *engine;
    const CallsType *calls;
    gic_head *self;
    double *state[2]; /* the engine's own, at both ends of a stretch */
    void *room;
    double *rhs, *fast;     /* [repetitions] s a call: median over the stretches */
    double *step, *outside; /* [repetitions] s of a step of AB3; share of it outside right-hand sides; with `rate` */
    bool unstable;          /* such a step fails */
    double corrections;     /* of one subset's solution, 0: not counted */
    double *rate;           /* [stretches][states] at the first end, of generated code in double precision; or NULL */
    int status;             /* that ended it */
} Subject;

/* A step of a run: both its ends, states in the order of FORMAT.md section 10. */
typedef struct Stretch {
    CallsMoment end[2];
} Stretch;

typedef struct Course {
    const Bench *bench;
    int subjects, stretches;
    Subject subject[VARIANTS];
    Stretch *stretch;
    CallsRoad road;
    Limit *limit; /* [repetitions] */
} Course;

/* ---- where: stretches of the scene -------------------------------------------------------------------------- */

static double *copy_numbers(Pool *pool, const double *number, int count)
{
    double *copy = pool_alloc(pool, sizeof *copy * (size_t)(count + 1));
    memcpy(copy, number, sizeof *copy * (size_t)count);
    return copy;
}

/* The present state of generated code, with copies of all numbers it depends on. */
static CallsMoment moment_of(Pool *pool, const Engine *engine, gic_head *self)
{
    const gic_model *code = engine->code;
    return (CallsMoment){
        gic_time(self),
        copy_numbers(pool, instance_array(self, code->state_offset), code->slow_count + code->fast_count),
        copy_numbers(pool, instance_array(self, code->input_offset), code->input_count),
        copy_numbers(pool, instance_array(self, code->discrete_offset), code->discrete_count)};
}

/* Advance to `end`, following the scene if there is one, else without inputs. */
static int run_until(const Engine *engine, const Scene *scene, Variable *variable, gic_head *self, double end)
{
    int status = GIC_OK;
    while (status == GIC_OK && gic_time(self) < end)
        status =
            scene ? scene_step(engine, engine->code, scene, variable, self, end) : variable_step(variable, self, end);
    return status;
}

/* Run the scene with generated code, its constant step's stability apart, and keep stretches of it. */
static void find_stretches(Course *course)
{
    static const Setting fine = {METHOD_RKCK, 1e-6};
    const double usual_step = 0.005, alone = 1; /* s: for scenes of variable steps; without a scene */
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    const Scene *scene = NULL;
    double step = usual_step, duration = alone;
    if (bench->scene) {
        const Scene changed = bench_scene(bench->scene, fine);
        scene = memcpy(pool_alloc(pool, sizeof changed), &changed, sizeof changed);
        step = scene->step > 0 ? scene->step : usual_step;
        duration = scene->duration;
    }
    const Engine *engine = course->subject->engine;
    gic_head *self = course->subject->self;
    Variable *variable = variable_open(engine->code, fine.method, fine.value);
    const int wanted = (int)fmin(bench->quick ? STRETCHES / 4 : STRETCHES, fmax(1, duration / step / 2));
    int status = scene ? scene_start(engine, scene, self) : engine->code->setup(self);
    course->stretch = pool_alloc(pool, sizeof *course->stretch * (size_t)wanted);
    while (course->stretches < wanted && status == GIC_OK) {
        const double begin = (course->stretches + 0.5) / wanted * (duration - step);
        Stretch *stretch = &course->stretch[course->stretches++];
        for (int i = 0; i < 2 && status == GIC_OK; ++i) {
            status = run_until(engine, scene, variable, self, begin + i * step);
            stretch->end[i] = moment_of(pool, engine, self);
        }
    }
    variable_close(variable);
    if (status != GIC_OK)
        diag_fail(scene ? (Place){scene->source, 0, 0} : program_place(),
                  "right-hand sides are timed on a run that goes well", "the run ends at t = %.6g s: %s",
                  gic_time(self), instance_status(pool, engine->code, self, status));
}

static void road_height(const void *road, int32_t lane, double time, double x, double y, double out[3])
{
    ((const gic_road *)road)->height(road, lane, time, x, y, out);
}

static double road_friction(const void *road, int32_t lane, double time, double x, double y)
{
    return ((const gic_road *)road)->friction(road, lane, time, x, y);
}

/* ---- who: variants at work ---------------------------------------------------------------------------------- */

bool bench_installed(Pool *pool, const char *compiler)
{
    const char *said;
    char *argv[] = {pool_print(pool, "%s", compiler), "--version", NULL};
    interrupt_hold();
    const int status = process_run(pool, argv, "", &said);
    interrupt_release();
    return status == 0;
}

/* True if it is asked for, available, and not the same as the command line's compiler. */
static bool available(const Bench *bench, const Variant *variant)
{
    bool wanted = variant == every_variant;
    for (int i = 0; bench->starting[i]; ++i)
        wanted |= !strcmp(bench->starting[i], variant->engine);
    if (!wanted || !variant->compiler)
        return wanted;
    const size_t length = strcspn(bench->options.compiler, " ");
    return (strlen(variant->compiler) != length || strncmp(variant->compiler, bench->options.compiler, length)) &&
           bench_installed(bench->pool, variant->compiler);
}

static void open_subject(Course *course, const Variant *variant)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    EngineOptions options = bench->options;
    Subject *subject = &course->subject[course->subjects];
    *subject = (Subject){.variant = variant, .calls = variant->single ? &calls_float : &calls_double};
    subject->name = strcmp(variant->engine, "cc")
                        ? variant->engine
                        : pool_print(pool, "%s %s%s%s", variant->compiler ? variant->compiler : options.compiler,
                                     variant->flags, variant->solve == SOLVE_AUGMENTED ? " --solve augmented" : "",
                                     variant->newton ? " --recovery newton" : "");
    if (variant->lanes)
        subject->name = pool_print(pool, "%s --lanes %d", subject->name, variant->lanes);
    bench_progress(bench, "engine %s", subject->name);
    options.solve = variant->solve;
    options.single = variant->single;
    options.lanes = variant->lanes;
    if (variant->newton)
        options.recovery = RECOVERY_NEWTON;
    options.quiet = true;
    options.flags = pool_print(pool, "%s %s", variant->flags, options.flags);
    if (variant->compiler)
        options.compiler = variant->compiler;
    subject->engine = engine_open(pool, variant->engine, bench->model, &options);
    if (!strcmp(variant->engine, "tcc") && subject->engine->context) {
        engine_close(subject->engine); /* falls back to the tape without executable memory */
        return;
    }
    const gic_model *code = subject->engine->code;
    const size_t states = (size_t)(code->slow_count + code->fast_count);
    subject->self = instance_new(pool, subject->engine);
    subject->room = pool_alloc(pool, CALLS_ROOM(code) * sizeof(double));
    for (int i = 0; i < 2; ++i)
        subject->state[i] = pool_alloc(pool, (states + 1) * sizeof(double));
    subject->rhs = pool_alloc(pool, (size_t)bench->repetitions * sizeof(double));
    subject->fast = pool_alloc(pool, (size_t)bench->repetitions * sizeof(double));
    ++course->subjects;
}

/* All on the same road with the same parameters. */
static void begin(Course *course)
{
    const Bench *bench = course->bench;
    Subject *first = course->subject;
    const gic_road *road = bench->scene ? bench->scene->road : NULL;
    const double *parameter =
        copy_numbers(bench->pool, instance_array(first->self, first->engine->code->parameter_offset),
                     first->engine->code->parameter_count);
    if (road)
        course->road = (CallsRoad){road_height, road->friction ? road_friction : NULL, road};
    for (int s = 0; s < course->subjects; ++s) {
        Subject *subject = &course->subject[s];
        void *adapter = pool_alloc(bench->pool, subject->calls->adapter);
        subject->status = subject->calls->begin(subject->engine->code, subject->self, parameter,
                                                road ? &course->road : NULL, adapter, subject->room);
    }
}

/* ---- time ----------------------------------------------------------------------------------------------------- */

/* Enter a stretch: both its ends in the engine's own states. */
static void enter(Subject *subject, const Stretch *stretch, CallsMoment end[2])
{
    const Engine *engine = subject->engine;
    const gic_model *code = engine->code;
    for (int i = 0; i < 2; ++i) {
        end[i] = stretch->end[i];
        subject->calls->put(code, subject->self, &end[i]);
        if (!engine->enter || subject->status != GIC_OK)
            continue;
        subject->status = engine_enter(engine, subject->self, end[i].state);
        memcpy(subject->state[i], instance_array(subject->self, code->state_offset),
               sizeof(double) * (size_t)(code->slow_count + code->fast_count));
        end[i].state = subject->state[i];
    }
}

static int states_of(const Subject *subject)
{
    return subject->engine->code->slow_count + subject->engine->code->fast_count;
}

/* The last rate: an even number of calls ends at the first of both ends. */
static void keep_rate(Subject *subject, int stretch)
{
    const int states = states_of(subject);
    memcpy(subject->rate + stretch * states, (const double *)subject->room + 2 * states,
           (size_t)states * sizeof *subject->rate);
}

/* All stretches once. */
static void time_subject(const Course *course, Subject *subject, int repetition)
{
    const gic_model *code = subject->engine->code;
    const CallsType *calls = subject->calls;
    Pool *pool = pool_new();
    double *rhs = pool_alloc(pool, sizeof *rhs * (size_t)course->stretches);
    double *fast = pool_alloc(pool, sizeof *fast * (size_t)course->stretches);
    double *step = pool_alloc(pool, sizeof *step * (size_t)course->stretches);
    double *outside = pool_alloc(pool, sizeof *outside * (size_t)course->stretches), part[2];
    int64_t before[2], after[2], solved = 0, corrected = 0;
    for (int i = 0; i < course->stretches && subject->status == GIC_OK; ++i) {
        CallsMoment end[2];
        double seconds;
        enter(subject, &course->stretch[i], end);
        if (subject->status == GIC_OK)
            subject->status = calls->rhs(code, subject->self, end, subject->room, WARM, &seconds);
        calls->counts(subject->self, before);
        if (subject->status == GIC_OK)
            subject->status = calls->rhs(code, subject->self, end, subject->room, CALLS, &seconds);
        calls->counts(subject->self, after);
        if (subject->rate && subject->status == GIC_OK) {
            keep_rate(subject, i);
            calls->put(code, subject->self, end);
            subject->unstable |=
                step_parts(pool, code, subject->self, end[0].state, end[1].time - end[0].time, part) != GIC_OK;
            step[i] = part[0];
            outside[i] = 1 - part[1] / part[0];
        }
        solved += after[0] - before[0];
        corrected += after[1] - before[1];
        rhs[i] = seconds / (int)CALLS;
        if (subject->status == GIC_OK && code->link_count)
            subject->status = calls->fast(code, subject->self, end, subject->room, CALLS, &seconds);
        fast[i] = seconds / (int)CALLS;
    }
    subject->rhs[repetition] = spread_of(pool, rhs, course->stretches).median;
    subject->fast[repetition] = spread_of(pool, fast, course->stretches).median;
    if (subject->rate) {
        subject->step[repetition] = spread_of(pool, step, course->stretches).median;
        subject->outside[repetition] = spread_of(pool, outside, course->stretches).median;
    }
    subject->corrections = solved ? (double)corrected / (double)solved : 0;
    pool_free(pool);
}

/* ---- tables ----------------------------------------------------------------------------------------------------- */

/* Operations of the code, by the way it was generated. */
typedef struct Kinds {
    const Figures *usual[SOLVES], *newton;
} Kinds;

static const Figures *figures_of(const Bench *bench, Solve solve, Recovery recovery)
{
    const Sequence *sequence = sequence_find(bench->pool, bench->model);
    return figures_new(bench->pool, formulate(bench->pool, model_assemble(bench->pool, bench->model, sequence),
                                              sequence, solve, recovery));
}

static const Figures *figures_for(const Kinds *kinds, const Variant *variant)
{
    return variant->newton ? kinds->newton : kinds->usual[variant->solve];
}

/* Average number of corrections with old factors of a subset without a closed form; the last correction is with new
 * ones. */
static double average_chords(const Subject *subject, const Figures *figures)
{
    int subsets = 0, followed = 0;
    for (int c = 0; c < figures->sequence->classes; ++c) {
        subsets += figures->sequence->class[c].members;
        followed += figures->class[c].closed ? 0 : figures->sequence->class[c].members;
    }
    return followed ? fmax(0, subject->corrections * subsets / followed - 1) : 0;
}

static void operations_row(Pool *pool, Sheet *table, const char *what, Count count)
{
    table_cell(pool, table, "%s", what);
    for (int i = 0; i < 5; ++i)
        table_cell(pool, table, "%d",
                   (const int[]){count.add, count.multiply, count.divide, count.root, count.function}[i]);
}

/* The same, rounded, of the first measured variant of this kind. */
static int usual_chords(const Course *course, const Kinds *kinds, bool newton)
{
    for (int s = 0; s < course->subjects; ++s) {
        const Subject *subject = &course->subject[s];
        if (!strcmp(subject->variant->engine, "cc") && subject->variant->newton == newton)
            return (int)round(average_chords(subject, figures_for(kinds, subject->variant)));
    }
    return 0;
}

static void operations_table(const Course *course, const Kinds *kinds)
{
    Pool *pool = course->bench->pool;
    Sheet *table = report_table(course->bench->report, "rhs_operations", "Operations of generated code",
                                "part|add|multiply|divide|root|other functions");
    const Figures *const reduced = kinds->usual[SOLVE_REDUCED];
    const int chords = usual_chords(course, kinds, false), newton_chords = usual_chords(course, kinds, true);
    operations_row(pool, table, "recovery", figures_recovery(reduced, chords, 1));
    operations_row(pool, table, "recovery (newton)", figures_recovery(kinds->newton, newton_chords, 1));
    for (int solve = 0; solve < SOLVES; ++solve) {
        if (!kinds->usual[solve])
            continue;
        Count equations = kinds->usual[solve]->dynamics;
        count_add(&equations, kinds->usual[solve]->loads, -1);
        operations_row(pool, table, pool_print(pool, "equations of motion (%s)", solve_name[solve]), equations);
    }
    Count laws = reduced->loads;
    count_add(&laws, reduced->link, 1);
    count_add(&laws, reduced->fast, 1);
    operations_row(pool, table, "force laws", laws);
    if (course->subject->engine->code->link_count)
        operations_row(pool, table, "of these in a fast step", reduced->fast);
    for (int newton = 0; newton < 2; ++newton) {
        const Figures *figures = newton ? kinds->newton : reduced;
        Count all = figures_rhs(figures, newton ? newton_chords : chords, 1);
        operations_row(pool, table, newton ? "all (newton)" : "all (reduced)", all);
        count_add(&all, figures->loads, -1);
        count_add(&all, figures->link, -1);
        count_add(&all, figures->fast, -1);
        operations_row(pool, table, newton ? "all but force laws (newton)" : "all but force laws", all);
    }
    table->note =
        pool_print(pool,
                   "Recovery with %d correction%s by the last call's factors, of Newton's method everywhere with %d, "
                   "and one by new ones, which is what these states take, where there is no closed form. Force laws "
                   "give the applied forces and what they do along the coordinates, from the motion of the bodies.",
                   chords, chords == 1 ? "" : "s", newton_chords);
}

/* Additions and multiplications. */
static double work_of(Count count)
{
    return count.add + count.multiply;
}

/* Of one right-hand side with the average number of corrections of a subject's subsets. */
static double rhs_work(const Subject *subject, const Figures *figures)
{
    const double one = work_of(figures_rhs(figures, 0, 1)), two = work_of(figures_rhs(figures, 1, 1));
    return one + average_chords(subject, figures) * (two - one);
}

/* Time of this work at the processor's peak, s: one number at a time; in lanes. */
static void limit_cells(const Course *course, Sheet *table, const double *seconds, double work, bool single)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    double *limit = pool_alloc(pool, sizeof *limit * (size_t)bench->repetitions);
    for (int lanes = 0; lanes < 2; ++lanes) {
        for (int r = 0; r < bench->repetitions; ++r) {
            const Limit *rate = &course->limit[r];
            /* twice as many of half the size fit in a register */
            limit[r] = work / (2 * (lanes ? rate->vector * (single ? 2 : 1) : rate->scalar));
        }
        table_cell(pool, table, "%.4g", 1e9 * spread_of(pool, limit, bench->repetitions).median);
        table_cell(pool, table, "%.3g", spread_of_ratio(pool, limit, seconds, bench->repetitions).median);
    }
}

/* Rows of one of the numbers of all subjects; ratios to those that interpret. */
static void time_table(const Course *course, const char *name, const char *title, const Kinds *kinds, bool fast)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    Text columns = {.pool = pool};
    text_print(&columns, "variant|time [ns]|low|high");
    for (int s = 0; s < course->subjects; ++s)
        if (course->subject[s].engine->context)
            text_print(&columns, "|%s over it", course->subject[s].name);
    text_print(&columns, "|%slimit [ns]|part of it|limit in lanes [ns]|part of it", fast ? "" : "corrections|");
    Sheet *table = report_table(bench->report, name, title, columns.s);
    for (int i = 0; i < course->subjects; ++i) {
        const Subject *subject = &course->subject[i];
        const double *seconds = fast ? subject->fast : subject->rhs;
        table_cell(pool, table, "%s", subject->name);
        if (subject->status != GIC_OK) {
            while (table->cells % table->columns)
                table_cell(pool, table, "failed");
            continue;
        }
        spread_cells(pool, table, spread_of(pool, seconds, bench->repetitions), 1e9);
        for (int s = 0; s < course->subjects; ++s) {
            const Subject *other = &course->subject[s];
            if (other->engine->context && other->status != GIC_OK)
                table_cell(pool, table, "failed");
            else if (other->engine->context)
                table_cell(pool, table, "%.3g",
                           spread_of_ratio(pool, fast ? other->fast : other->rhs, seconds, bench->repetitions).median);
        }
        if (!fast)
            table_cell(pool, table, subject->corrections > 0 ? "%.3g" : "-", subject->corrections);
        if (strcmp(subject->variant->engine, "cc") && strcmp(subject->variant->engine, "tcc")) {
            while (table->cells % table->columns)
                table_cell(pool, table, "-");
            continue;
        }
        const Figures *own = figures_for(kinds, subject->variant);
        limit_cells(course, table, seconds, fast ? work_of(own->fast) : rhs_work(subject, own),
                    subject->variant->single);
    }
}

/* Largest difference of a rate from the first subject's, relative to the largest rate. */
static double deviation(const Course *course, const Subject *subject)
{
    const Subject *first = course->subject;
    double largest = 0, difference = 0;
    for (int i = 0; i < course->stretches * states_of(first); ++i) {
        largest = fmax(largest, fabs(first->rate[i]));
        difference = fmax(difference, fabs(subject->rate[i] - first->rate[i]));
    }
    return difference / largest;
}

/* Recovery as a choice between time and error. */
static void precision_chart(const Course *course)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    Sheet *table = report_table(bench->report, "rhs_precision", "Time and error of a right-hand side",
                                "variant|time [ns]|corrections|largest deviation of a rate");
    Chart *chart = report_chart(bench->report, "rhs_precision", "Time and error of a right-hand side",
                                "time of a right-hand side [ns]", "deviation of a rate, relative to the largest");
    for (int s = 1; s < course->subjects; ++s) {
        const Subject *subject = &course->subject[s];
        if (!subject->rate || subject->status != GIC_OK)
            continue;
        const double time = 1e9 * spread_of(pool, subject->rhs, bench->repetitions).median;
        const double error = deviation(course, subject);
        table_cell(pool, table, "%s", subject->name);
        table_cell(pool, table, "%.4g", time);
        table_cell(pool, table, subject->corrections > 0 ? "%.3g" : "-", subject->corrections);
        table_cell(pool, table, "%.2g", error);
        const bool newton = subject->variant->newton || bench->options.recovery == RECOVERY_NEWTON;
        chart_point(pool, chart, newton ? "newton" : "closed forms where there are any", newton, time, error);
    }
    table->note = pool_print(
        pool,
        "From '%s', on the same states, relative to the largest rate of them all. GIC_RECOVERY_ERROR: how far "
        "poses may be off, relative to the size of a subset, by what Newton's iteration leaves; "
        "by default as near as numbers are.",
        course->subject->name);
}

/* Time of the integrator, for generated code in double precision. */
static void step_table(const Course *course)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    Sheet *table = report_table(bench->report, "rhs_step", "A step of AB3 outside the right-hand side",
                                "variant|step [ns]|low|high|outside [%]|low|high");
    for (int s = 0; s < course->subjects; ++s) {
        const Subject *subject = &course->subject[s];
        if (!subject->rate)
            continue;
        table_cell(pool, table, "%s", subject->name);
        if (subject->status == GIC_OK && !subject->unstable) {
            spread_cells(pool, table, spread_of(pool, subject->step, bench->repetitions), 1e9);
            spread_cells(pool, table, spread_of(pool, subject->outside, bench->repetitions), 100);
        }
        while (table->cells % table->columns)
            table_cell(pool, table, subject->unstable ? "unstable" : "failed");
    }
    table->note = "Steps in a row, and right-hand sides at the states from which they begin, by turns; inputs stay. "
                  "The step is the generated code's own function, what is around it this program's, with its flags.";
}

/* The same vehicle without force elements: packed force laws can't be counted apart from the equations of motion. */
static const Model *without_forces(Pool *pool, const Model *model)
{
    Model *bare = pool_alloc(pool, sizeof *bare);
    *bare = *model;
    bare->forces = bare->wheels = bare->fast_states = bare->ports = bare->outputs = bare->output_components = 0;
    bare->powertrain = NULL;
    return bare;
}

/* Additions and multiplications of a right-hand side of a model in lanes: of vectors; of single numbers. */
static void lane_work(const Course *course, const Subject *subject, const Model *model, double *vector, double *scalar)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    const Sequence *sequence = sequence_find(pool, model);
    const Recovery recovery = subject->variant->newton ? RECOVERY_NEWTON : bench->options.recovery;
    const Formulation *f =
        formulate(pool, model_assemble(pool, model, sequence), sequence, subject->variant->solve, recovery);
    f = formulation_lanes(pool, f, subject->variant->lanes);
    const Figures *figures = figures_new(pool, f);
    const double chords = average_chords(subject, figures);
    *vector = work_of(block_count_wide(f->dynamics));
    *scalar = work_of(figures->dynamics) - *vector;
    for (int c = 0; c < f->sequence->classes; ++c) {
        const double one = work_of(figures_subset(figures, c, 0, 1)), two = work_of(figures_subset(figures, c, 1, 1));
        *(f->plan->class_lanes[c] ? vector : scalar) += class_rows(f->plan, c) * (one + chords * (two - one));
    }
}

/* NULL: the default one. */
static bool same_compiler(const char *a, const char *b)
{
    return a && b ? !strcmp(a, b) : a == b;
}

/* The same code by the same compiler with the same flags, one by one. */
static const Subject *without_lanes(const Course *course, const Variant *variant)
{
    for (int s = 0; s < course->subjects; ++s) {
        const Variant *other = course->subject[s].variant;
        if (!other->lanes && same_compiler(other->compiler, variant->compiler) &&
            !strcmp(other->flags, variant->flags) && other->solve == variant->solve && other->newton == variant->newton)
            return &course->subject[s];
    }
    return NULL;
}

/* Variants in lanes beside the same without. */
static void lanes_table(const Course *course)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    double *limit = pool_alloc(pool, sizeof *limit * (size_t)bench->repetitions);
    Sheet *table =
        report_table(bench->report, "rhs_lanes", "Alike parts side by side",
                     "variant|operations on vectors|on single numbers|on vectors without forces|"
                     "on single numbers without them|times as fast as one by one|low|high|limit [ns]|times the limit");
    const Model *bare = without_forces(pool, bench->model);
    for (int s = 0; s < course->subjects; ++s) {
        const Subject *subject = &course->subject[s], *alone = without_lanes(course, subject->variant);
        double vector, scalar, bare_vector, bare_scalar;
        if (!subject->variant->lanes || !alone || subject->status != GIC_OK || alone->status != GIC_OK)
            continue;
        lane_work(course, subject, bench->model, &vector, &scalar);
        lane_work(course, subject, bare, &bare_vector, &bare_scalar);
        table_cell(pool, table, "%s", subject->name);
        table_cell(pool, table, "%.0f", vector);
        table_cell(pool, table, "%.0f", scalar);
        table_cell(pool, table, "%.0f", bare_vector);
        table_cell(pool, table, "%.0f", bare_scalar);
        spread_cells(pool, table, spread_of_ratio(pool, alone->rhs, subject->rhs, bench->repetitions), 1);
        for (int r = 0; r < bench->repetitions; ++r)
            limit[r] = (vector + scalar) / (2 * course->limit[r].scalar);
        table_cell(pool, table, "%.4g", 1e9 * spread_of(pool, limit, bench->repetitions).median);
        table_cell(pool, table, "%.3g", spread_of_ratio(pool, subject->rhs, limit, bench->repetitions).median);
    }
    table->note =
        "Additions and multiplications, those of a whole vector counted once, with force laws and, of the same vehicle "
        "without anything that makes forces, without; the limit is what the former would take, two in each "
        "multiply-add, at the rate of multiply-adds one after another. "
        "One by one: by the same compiler with the same flags.";
}

static void limit_table(const Course *course)
{
    const Bench *bench = course->bench;
    Pool *pool = bench->pool;
    double *rate = pool_alloc(pool, sizeof *rate * (size_t)bench->repetitions);
    Sheet *table =
        report_table(bench->report, "limit", "Multiply-adds of the processor", "numbers at a time|1e9 / s|low|high");
    for (int vector = 0; vector < 2; ++vector) {
        for (int r = 0; r < bench->repetitions; ++r)
            rate[r] = vector ? course->limit[r].vector : course->limit[r].scalar;
        table_cell(pool, table, "%d", vector ? course->limit->lanes : 1);
        spread_cells(pool, table, spread_of(pool, rate, bench->repetitions), 1e-9);
    }
}

void bench_rhs(const Bench *bench)
{
    Course course = {.bench = bench};
    course.limit = pool_alloc(bench->pool, sizeof *course.limit * (size_t)bench->repetitions);
    for (int v = 0; v < VARIANTS; ++v)
        if (available(bench, &every_variant[v]))
            open_subject(&course, &every_variant[v]);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    find_stretches(&course);
    for (int s = 0; s < course.subjects; ++s) {
        Subject *subject = &course.subject[s];
        if (subject->variant->single || strcmp(subject->variant->engine, "cc"))
            continue;
        subject->rate = pool_alloc(bench->pool, (size_t)(course.stretches * states_of(subject) + 1) * sizeof(double));
        subject->step = pool_alloc(bench->pool, (size_t)bench->repetitions * sizeof(double));
        subject->outside = pool_alloc(bench->pool, (size_t)bench->repetitions * sizeof(double));
    }
    begin(&course);
    for (int r = 0; r < bench->repetitions; ++r) {
        bench_progress(bench, "right-hand sides: repetition %d of %d", r + 1, bench->repetitions);
        course.limit[r] = limit_measure();
        for (int s = 0; s < course.subjects; ++s)
            time_subject(&course, &course.subject[s], r);
        if (bench->rhs && !r)
            bench_expect(bench, (clock_seconds(CLOCK_MONOTONIC) - before) * (bench->repetitions - 1));
    }
    const bool tires = course.subject->engine->code->link_count > 0;
    const Recovery usual = bench->options.recovery;
    const Kinds kinds = {{[SOLVE_REDUCED] = figures_of(bench, SOLVE_REDUCED, usual),
                          [SOLVE_AUGMENTED] = figures_of(bench, SOLVE_AUGMENTED, usual)},
                         figures_of(bench, SOLVE_REDUCED, RECOVERY_NEWTON)};
    report_heading(bench->report, "One right-hand side");
    report_text(bench->report,
                "Recovery of the dependent coordinates, forces, equations of motion: on %d stretches of the %s, each "
                "one step long, %d right-hand sides back and forth between its two ends, so that Newton's method "
                "starts as far away as in a run. Times are medians over the stretches, of which the median, lowest "
                "and highest of %d repetitions, variants alternating; ratios are formed within a repetition. Double "
                "precision but with -DGIC_FLOAT, reduced form but where it says augmented, no contraction but where "
                "flags say so; flags stand behind %s. The limit is what the additions and multiplications would take, "
                "two in each multiply-add, if the processor did nothing else; the rate of these is measured by a small "
                "loop in each repetition, with one number at a time and with as many as it takes.",
                course.stretches, bench->scene ? "scene" : "run that follows setting up", CALLS, bench->repetitions,
                build_flags);
    operations_table(&course, &kinds);
    time_table(&course, "rhs", "Time of a right-hand side", &kinds, false);
    precision_chart(&course);
    step_table(&course);
    if (tires)
        time_table(&course, "rhs_fast", "Time of a fast step's rates", &kinds, true);
    if (!tires)
        lanes_table(&course);
    limit_table(&course);
    for (int s = 0; s < course.subjects; ++s)
        engine_close(course.subject[s].engine);
}
