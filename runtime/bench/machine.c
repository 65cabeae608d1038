/* SPDX-License-Identifier: MIT
 * The machine and the programs used for the measurements. */
#include "base/text.h"
#include "base/version.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "host/host.h"

#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

/* The processor's name as Linux has it, else its architecture. */
static const char *processor(Pool *pool, const char *architecture)
{
    char line[512];
    const char *name = architecture;
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && name == architecture && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (colon && !strncmp(line, "model name", strlen("model name")))
            name = pool_print(pool, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
    }
    if (file)
        fclose(file);
    return name;
}

/* First line of the output of `compiler --version`. */
static const char *compiler_version(Pool *pool, const char *compiler)
{
    const char *said = "";
    char *argv[] = {pool_print(pool, "%.*s", (int)strcspn(compiler, " "), compiler), "--version", NULL};
    interrupt_hold();
    const int status = process_run(pool, argv, "", &said);
    interrupt_release();
    return status ? compiler : pool_print(pool, "%.*s", (int)strcspn(said, "\n"), said);
}

void bench_machine(const Bench *bench)
{
    Pool *pool = bench->pool;
    struct utsname system;
    char date[32];
    const time_t now = time(NULL);
    uname(&system);
    strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", gmtime(&now));
    Text engines = {.pool = pool};
    for (int e = 0; e < bench->engines; ++e)
        text_print(&engines, "%s%s", e ? ", " : "\nEngines: ", bench->engine[e]->name);
    text_add(&engines, "", 0);
    report_heading(bench->report, "gicbench");
    report_text(bench->report,
                "%s%s%s%s%s\nProcessor: %s, %ld online\nSystem: %s %s %s\n"
                "Compiler of generated code: %s\nIts flags: %s %s\nHost program and interpreted engines: %s, flags %s\n"
                "gicgen %s, %s",
                bench->files ? "Models and scenes as in the tables" : "Model ", bench->files ? "" : bench->model_path,
                bench->files        ? ""
                : bench->scene_path ? pool_print(pool, ", scene %s", bench->scene_path)
                                    : ", scene none",
                bench->quick ? " (quick: few repetitions, few settings)" : "", engines.s,
                processor(pool, system.machine), sysconf(_SC_NPROCESSORS_ONLN), system.sysname, system.release,
                system.machine, compiler_version(pool, bench->options.compiler), build_flags, bench->options.flags,
                __VERSION__, GICBENCH_FLAGS, GICGEN_VERSION, date);
}
