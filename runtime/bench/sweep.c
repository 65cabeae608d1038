/* SPDX-License-Identifier: MIT
 * Time against error: Tables 1 and 2 and Figs. 6 to 9 of Serban and Haug 2000, and all integrators in one diagram. */
#include "base/text.h"
#include "bench/bench.h"
#include "gic_runtime.h"
#include "scene/scene.h"

/* What is tried, coarse first. With --quick the first, the middle and the last. */
enum { SETTINGS = 7 };

static const double steps[SETTINGS] = {0.010, 0.008, 0.005, 0.004, 0.002, 0.001, 0.0005};
static const double tolerances[SETTINGS] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

/* One integrator, its settings by engines. */
typedef struct Sweep {
    int32_t method;
    int settings;
    Trial *trial; /* [settings][engines] */
} Sweep;

static const int32_t method[] = {METHOD_ADAMS, GIC_AB3, METHOD_RKCK, GIC_RK4};
enum { METHODS = sizeof method / sizeof *method };

/* Setting i of a method. */
static Setting setting_of(int32_t integrator, int i)
{
    Setting setting = {integrator, 0};
    setting.value = setting_constant(setting) ? steps[i] : tolerances[i];
    return setting;
}

static int setting_stride(const Bench *bench)
{
    return bench->quick ? 3 : 1;
}

double sweep_evaluations(const Bench *bench)
{
    double sum = 0;
    for (int m = 0; m < METHODS; ++m)
        for (int i = 0; i < SETTINGS; i += setting_stride(bench))
            sum += (double)trial_evaluations(bench, bench->scene, setting_of(method[m], i));
    return sum;
}

static Sweep sweep_run(const Bench *bench, int32_t integrator, const Trajectory *reference)
{
    Sweep sweep = {.method = integrator};
    sweep.trial = pool_alloc(bench->pool, sizeof(Trial) * (size_t)(SETTINGS * bench->engines));
    for (int i = 0; i < SETTINGS; i += setting_stride(bench))
        trials_run(bench, bench->scene, setting_of(integrator, i), reference,
                   sweep.trial + sweep.settings++ * bench->engines);
    return sweep;
}

/* A row: engine with setting. first: the trial of the engine that others are compared with. */
static void sweep_row(const Bench *bench, Sheet *table, const Trial *trial, const Trial *first)
{
    Pool *pool = bench->pool;
    const double simulated = (bench_samples(bench->scene) - 1) * bench_sample;
    table_cell(pool, table, "%s", setting_text(pool, trial->setting));
    table_cell(pool, table, "%s", trial->engine->name);
    if (trial->unstable) {
        for (int column = 2; column < table->columns; ++column)
            table_cell(pool, table, "unstable");
        return;
    }
    const Spread seconds = spread_of(pool, trial->second, bench->repetitions);
    table_cell(pool, table, "%.2e", trial->error);
    spread_cells(pool, table, seconds, 1e3);
    table_cell(pool, table, "%lld", (long long)trial->evaluations);
    table_cell(pool, table, "%.3g", 1e6 * seconds.median / (double)trial->evaluations);
    table_cell(pool, table, "%.4g", simulated / seconds.median);
    table_cell(pool, table, "%s", simulated > seconds.high ? "yes" : "no");
    if (first->unstable)
        for (int column = 0; column < 3; ++column)
            table_cell(pool, table, "unstable");
    else
        spread_cells(pool, table, spread_of_ratio(pool, trial->second, first->second, bench->repetitions), 1);
}

static void sweep_table(const Bench *bench, const Sweep *sweep, const char *name, const char *title, const char *first)
{
    const char *columns = pool_print(bench->pool,
                                     "%s|engine|error|CPU [ms]|low|high|evaluations|us each|times real time|"
                                     "faster than real time|%s is faster by|low|high",
                                     first, bench->engine[0]->name);
    Sheet *table = report_table(bench->report, name, title, columns);
    for (int i = 0; i < sweep->settings; ++i)
        for (int e = 0; e < bench->engines; ++e)
            sweep_row(bench, table, &sweep->trial[i * bench->engines + e], &sweep->trial[i * bench->engines]);
}

/* CPU time over the setting, and how much faster the first engine is than the others. */
static void sweep_charts(const Bench *bench, const Sweep *sweep, const char *x, const char *time_name,
                         const char *time_title, const char *ratio_name, const char *ratio_title)
{
    Pool *pool = bench->pool;
    Chart *time = report_chart(bench->report, time_name, time_title, x, "CPU time [s]");
    Chart *ratio = report_chart(bench->report, ratio_name, ratio_title, x,
                                pool_print(pool, "CPU time over that of %s", bench->engine[0]->name));
    for (int i = 0; i < sweep->settings * bench->engines; ++i) {
        const Trial *trial = &sweep->trial[i], *first = &sweep->trial[i - i % bench->engines];
        if (trial->unstable)
            continue;
        const double unit = setting_constant(trial->setting) ? 1e3 : 1;
        chart_point(pool, time, trial->engine->name, i % bench->engines, unit * trial->setting.value,
                    spread_of(pool, trial->second, bench->repetitions).median);
        if (trial != first && !first->unstable)
            chart_point(pool, ratio, trial->engine->name, i % bench->engines, unit * trial->setting.value,
                        spread_of_ratio(pool, trial->second, first->second, bench->repetitions).median);
    }
}

/* At the longest step that all engines can take: how much longer the others need than the first. */
static void sweep_headline(const Bench *bench, const Sweep *sweep)
{
    Pool *pool = bench->pool;
    const Trial *best = NULL;
    for (int i = 0; i < sweep->settings; ++i) {
        const Trial *trial = &sweep->trial[i * bench->engines];
        bool stable = true;
        for (int e = 0; e < bench->engines; ++e)
            stable = stable && !trial[e].unstable;
        if (stable && (!best || trial->setting.value > best->setting.value))
            best = trial;
    }
    if (!best || bench->engines < 2)
        return;
    Text ratios = {.pool = pool};
    for (int e = 1; e < bench->engines; ++e)
        text_print(&ratios, "%s%.3g times as fast as %s", e > 1 ? ", " : "",
                   spread_of_ratio(pool, best[e].second, best->second, bench->repetitions).median,
                   best[e].engine->name);
    report_headline(bench->report, "%s with steps of %s: %s is %s.", integrator_name(sweep->method),
                    setting_text(pool, best->setting), best->engine->name, ratios.s);
}

static void work_precision(const Bench *bench, const Sweep *sweep, int sweeps, double uncertainty)
{
    Pool *pool = bench->pool;
    report_heading(bench->report, "Work and precision");
    Chart *chart = report_chart(bench->report, "work_precision", "CPU time against error, all engines and integrators",
                                "error [m or rad]", "CPU time [s]");
    chart->note = pool_print(pool, "The reference is uncertain by %.1e: errors near that mean little.", uncertainty);
    Sheet *table = report_table(bench->report, "work_precision", "All engines and integrators",
                                "engine|integrator|step or tolerance|error|CPU [ms]|low|high|evaluations");
    for (int s = 0; s < sweeps; ++s)
        for (int i = 0; i < sweep[s].settings * bench->engines; ++i) {
            const Trial *trial = &sweep[s].trial[i];
            const char *integrator = integrator_name(sweep[s].method);
            table_cell(pool, table, "%s", trial->engine->name);
            table_cell(pool, table, "%s", integrator);
            table_cell(pool, table, "%s", setting_text(pool, trial->setting));
            if (trial->unstable) {
                for (int column = 3; column < table->columns; ++column)
                    table_cell(pool, table, "unstable");
                continue;
            }
            const Spread seconds = spread_of(pool, trial->second, bench->repetitions);
            table_cell(pool, table, "%.2e", trial->error);
            spread_cells(pool, table, seconds, 1e3);
            table_cell(pool, table, "%lld", (long long)trial->evaluations);
            chart_point(pool, chart, pool_print(pool, "%s %s", trial->engine->name, integrator), i % bench->engines,
                        trial->error, seconds.median);
        }
}

void bench_sweep(const Bench *bench)
{
    Sweep sweep[METHODS];
    double uncertainty;
    const Trajectory reference = reference_run(bench, bench->scene, &uncertainty);
    for (int i = 0; i < METHODS; ++i)
        sweep[i] = sweep_run(bench, method[i], &reference);

    report_heading(bench->report, "Against the paper: Tables 1 and 2, Figs. 6 to 9");
    report_text(bench->report,
                "Each run simulates %g s and stops every %g s, where its trajectory is compared with the reference. "
                "Error: the largest deviation of any body at any of these times, of its frame's origin in m or of its "
                "orientation in rad, whichever is larger, as if on a lever of 1 m. Reference: rkck with a tolerance "
                "of 1e-12, 1000 times below the tightest one here; adams with the same tolerance deviates from it by "
                "%.1e. A row is unstable where the run fails or its error exceeds %g.",
                (bench_samples(bench->scene) - 1) * bench_sample, bench_sample, uncertainty, bench_unstable);
    report_text(bench->report,
                "CPU time is that of the integration alone: median, lowest and highest of %d repetitions. All runs "
                "take place in one process, engines alternating within each repetition, and ratios are formed within "
                "repetitions before their median is taken.",
                bench->repetitions);
    sweep_table(bench, &sweep[0], "table1", "Table 1. Adams, variable step and order (paper: DDABM)", "tolerance");
    sweep_charts(bench, &sweep[0], "tolerance", "fig6", "Fig. 6. Adams: CPU time", "fig7", "Fig. 7. Adams: speed-up");
    sweep_table(bench, &sweep[1], "table2", "Table 2. AB3, constant steps", "step");
    sweep_headline(bench, &sweep[1]);
    sweep_charts(bench, &sweep[1], "step [ms]", "fig8", "Fig. 8. AB3: CPU time", "fig9", "Fig. 9. AB3: speed-up");
    work_precision(bench, sweep, METHODS, uncertainty);
}
