/* SPDX-License-Identifier: MIT
 * Sweeps: what gicsweep does, and its table in memory. */
#include "base/message.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "host/host.h"
#include "library/library_private.h"
#include "library/result_private.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

typedef struct Sweeping {
    OpenModel *open;
    const gicl_sweep *asked;
    bool plan; /* plan it, with what follows */
    double seconds;
    const char *const *command;
    int words;
    Pool *pool;
    SweepTable table;
    Result *result; /* NULL: not wanted */
} Sweeping;

static void make_pool(void *context)
{
    ((Sweeping *)context)->pool = pool_new();
}

static void sweep(void *context)
{
    Sweeping *s = context;
    const gicl_sweep *asked = s->asked;
    const OpenModel *open = s->open;
    const Model *model = model_once(s->open, s->pool);
    Metric *metric = pool_alloc(s->pool, sizeof *metric * (size_t)(asked->metrics + 1));
    for (int m = 0; m < asked->metrics; ++m) {
        model = metric_read(s->pool, model, asked->metric[m], &metric[m]);
        for (int k = 0; k < m; ++k)
            if (!strcmp(metric[k].name, metric[m].name))
                diag_fail_call(program_place(), "give it another name", "there are two metrics '%s'", metric[m].name);
    }
    const Scene *scene = scene_read(s->pool, asked->scene, model, open->integrator, open->tolerance);
    SweepRequest request = {.results = asked->results,
                            .engine = asked->alone ? open->engine_name : NULL,
                            .code = open->options,
                            .vary = asked->vary,
                            .varied = asked->varied,
                            .metrics = asked->metrics,
                            .metric = metric,
                            .latin = asked->latin,
                            .sobol = asked->sobol,
                            .seed = asked->seed,
                            .series = asked->series,
                            .page = {asked->report, asked->front, asked->fronts},
                            .part = asked->part,
                            .parts = asked->parts,
                            .quiet = asked->quiet};
    request.code.quiet = asked->quiet;
    if (s->plan)
        sweep_plan(s->pool, model, scene, &request, s->seconds, s->command, s->words, &s->table);
    else
        sweep_all(s->pool, model, scene, &request, &s->table);
}

/* The table in a pool of its own. */
static void keep(void *context)
{
    Sweeping *s = context;
    const SweepTable *table = &s->table;
    Pool *pool = pool_new();
    double *value = pool_alloc(pool, sizeof *value * (size_t)(table->runs * table->form.columns + 1)), *next = value;
    gic_signal *signal = pool_alloc(pool, sizeof *signal * (size_t)table->form.columns);
    for (int c = 0; c < table->form.columns; ++c)
        signal[c] = (gic_signal){pool_print(pool, "%s", table->form.column[c].name),
                                 pool_print(pool, "%s", table->form.column[c].unit ? table->form.column[c].unit : "1")};
    for (int64_t r = 0; r < table->runs; ++r) {
        const char *text = table->row[r];
        char *end;
        for (int c = 0; c < table->form.columns; ++c, text = *end ? end + 1 : end)
            *next++ = strtod(text, &end);
    }
    s->result = pool_alloc(pool, sizeof *s->result);
    s->result->pool = pool;
    result_add(s->result, "runs", table->runs, table->form.columns, value, NULL, signal);
}

static int check(const gicl_sweep *asked, gicl_messages *said)
{
    if (!asked || asked->size != sizeof *asked)
        return call_wrong(said, "set size to sizeof(gicl_sweep), and compile with the library's own gic.h",
                          "a sweep has %zu bytes, not %zu", sizeof *asked, asked ? asked->size : 0);
    if (!asked->scene || !asked->results || !asked->vary || asked->varied < 1)
        return call_wrong(said, NULL, "a sweep needs a scene, a file for results, and what varies");
    if (asked->latin < 0 || asked->latin > GICL_SWEEP_MOST)
        return call_wrong(said, NULL, "runs of a Latin hypercube are 1 to %d, or 0: a grid", GICL_SWEEP_MOST);
    if (asked->sobol < 0 || asked->sobol > GICL_SWEEP_MOST || (asked->sobol && asked->latin))
        return call_wrong(said, NULL,
                          "base points are 1 to %d, or 0: no Sobol' indices, and no Latin hypercube with them",
                          GICL_SWEEP_MOST);
    if (asked->sobol && !asked->metrics)
        return call_wrong(said, "give 'metric'", "Sobol' indices are those of metrics, and there is none");
    if (asked->parts < 0 || asked->parts > GICL_PARTS_MOST || asked->part < 0 || asked->part > asked->parts)
        return call_wrong(said, NULL, "parts are 1 to %d, or 0: no parts, and a part is one of them", GICL_PARTS_MOST);
    if (asked->metrics < 0 || (asked->metrics && !asked->metric))
        return call_wrong(said, NULL, "'metrics' is the number of words in 'metric'");
    if (asked->series && !asked->parts && !table_is_hdf5(asked->results))
        return call_wrong(said, "name a file that ends in .h5", "series over time go into HDF5, not into '%s'",
                          asked->results);
    if (asked->fronts < 0 || (asked->fronts && (!asked->front || !asked->report)))
        return call_wrong(said, NULL, "'fronts' is the number of words in 'front', which go onto the page 'report'");
    if (asked->report && (!asked->metrics || asked->parts))
        return call_wrong(said, "of a sweep in parts gicl_sweep_merge_report() writes one",
                          "a report is of metrics, and of a sweep that is not in parts");
    for (int f = 0; f < asked->fronts; ++f)
        if (!asked->front[f])
            return call_wrong(said, NULL, "number %d of the fronts is NULL", f);
    for (int m = 0; m < asked->metrics; ++m)
        if (!asked->metric[m])
            return call_wrong(said, NULL, "number %d of the metrics is NULL", m);
    for (int v = 0; v < asked->varied; ++v)
        if (!asked->vary[v])
            return call_wrong(said, NULL, "number %d of what varies is NULL", v);
    return GICL_OK;
}

/* Both calls with a model. */
static int call_sweep(gicl_library *library, gicl_handle model, Sweeping *s, gicl_handle *result, gicl_messages *said)
{
    const Use use = use_begin(library, model, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use.status;
    s->open = use.thing;
    int status = check(s->asked, said);
    if (status == GICL_OK && !s->plan && !s->asked->part && s->asked->parts)
        status = call_wrong(said, NULL, "which of the %d parts is to be made?", s->asked->parts);
    if (status == GICL_OK && s->plan && (s->asked->part || (!s->asked->parts && !(s->seconds > 0)) || !s->command))
        status =
            call_wrong(said, NULL, "a plan is of all parts, and needs their number or seconds above 0, and a command");
    if (status == GICL_OK)
        status = call_work(library, said, make_pool, s);
    if (status != GICL_OK)
        return use_end(&use, status);
    status = call_work(library, said, sweep, s);
    const bool made = status == GICL_OK;
    if (made && result) /* names of signals are the engine's */
        status = call_work(library, said, keep, s);
    if (made)
        engine_close(s->table.engine);
    if (status == GICL_OK && result && !(*result = handle_new(library, THING_RESULT, s->result))) {
        result_free(s->result);
        status = call_wrong(said, NULL, "no memory for another handle");
    }
    if (s->table.engine && s->table.engine->library)
        dlclose(s->table.engine->library);
    pool_free(s->pool);
    return use_end(&use, status);
}

int gicl_sweep_run(gicl_library *library, gicl_handle model, const gicl_sweep *asked, gicl_handle *result,
                   gicl_messages *said)
{
    if (result)
        *result = 0;
    return call_sweep(library, model, &(Sweeping){.asked = asked}, result, said);
}

int gicl_sweep_plan(gicl_library *library, gicl_handle model, const gicl_sweep *asked, double seconds,
                    const char *const *command, int words, gicl_messages *said)
{
    Sweeping s = {.asked = asked, .plan = true, .seconds = seconds, .command = command, .words = words};
    return call_sweep(library, model, &s, NULL, said);
}

/* ---- one table ------------------------------------------------------------------------------------------------- */

typedef struct Merging {
    const char *folder, *results;
    ReportRequest page;
    bool quiet;
} Merging;

static void merge(void *context)
{
    const Merging *m = context;
    Pool *pool = pool_new();
    folder_merge(pool, m->folder, m->results, &m->page, m->quiet);
    pool_free(pool);
}

int gicl_sweep_merge(gicl_library *library, const char *folder, const char *results, int quiet, gicl_messages *said)
{
    call_begin(library, said);
    if (!folder || !results)
        return call_wrong(said, NULL, "merging needs a folder and a file for results");
    return call_work(library, said, merge, &(Merging){folder, results, {NULL, NULL, 0}, quiet});
}

int gicl_sweep_merge_report(gicl_library *library, const char *folder, const char *results, const char *report,
                            const char *const *front, int fronts, int quiet, gicl_messages *said)
{
    call_begin(library, said);
    if (!folder || !results || !report)
        return call_wrong(said, NULL, "merging needs a folder, a file for results and one for the page");
    if (fronts < 0 || (fronts && !front))
        return call_wrong(said, NULL, "'fronts' is the number of words in 'front'");
    for (int f = 0; f < fronts; ++f)
        if (!front[f])
            return call_wrong(said, NULL, "number %d of the fronts is NULL", f);
    return call_work(library, said, merge, &(Merging){folder, results, {report, front, fronts}, quiet});
}
