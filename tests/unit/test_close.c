/* SPDX-License-Identifier: MIT
 * A program that opens engines and closes them again, thousands of times perhaps, keeps nothing of them: no executable
 * memory, no open file, no file in the folder for temporary ones. */
#include "base/pool.h"
#include "engine/engine.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

/* Bytes of memory that may be executed. */
static long executable(void)
{
    FILE *file = fopen("/proc/self/maps", "r");
    assert_non_null(file);
    long sum = 0;
    for (char line[4096]; fgets(line, sizeof line, file);) {
        char *end;
        const unsigned long from = strtoul(line, &end, 16), to = strtoul(end + 1, &end, 16);
        if (end[3] == 'x')
            sum += (long)(to - from);
    }
    fclose(file);
    return sum;
}

static int files_in(const char *path)
{
    DIR *folder = opendir(path);
    assert_non_null(folder);
    int files = 0;
    for (const struct dirent *entry; (entry = readdir(folder));)
        files += entry->d_name[0] != '.';
    closedir(folder);
    return files;
}

static void open_and_close(const char *name)
{
    Pool *pool = pool_new();
    engine_close(engine_open(pool, name, model_read(pool, "models/pendulum.veh"), &(EngineOptions){.quiet = true}));
    pool_free(pool);
}

/* The first time libraries may be loaded that stay. */
static void test_close(void **folder)
{
    static const char *const engine[] = {"tcc", "auto", "tape", "gic", "gcp1"};
    enum { TIMES = 10 };
    for (size_t e = 0; e < sizeof engine / sizeof *engine; ++e) {
        open_and_close(engine[e]);
        const long mapped = executable();
        const int files = files_in("/proc/self/fd"), left = files_in(*folder);
        for (int i = 0; i < TIMES; ++i)
            open_and_close(engine[e]);
        assert_int_equal(executable(), mapped);
        assert_int_equal(files_in("/proc/self/fd"), files);
        assert_int_equal(files_in(*folder), left);
    }
}

/* What the compiler worked in behind a run is gone as soon as its code is taken, not at the end of the run. */
static void test_auto(void **folder)
{
    Pool *pool = pool_new();
    const EngineOptions options = {.compiler = compiler_default(), .flags = "-O0", .quiet = true};
    const Engine *engine = engine_open(pool, "auto", model_read(pool, "models/pendulum.veh"), &options);
    gic_head *self = instance_new(pool, engine);
    assert_int_equal(engine->code->setup(self), GIC_OK);
    const gic_model *faster = engine_faster(engine, self);
    assert_null(faster);
    assert_true(files_in(*folder) > 0);
    for (int waits = 0; !faster && waits < 6000; ++waits) {
        nanosleep(&(struct timespec){0, 20000000}, NULL);
        faster = engine_faster(engine, self);
    }
    assert_non_null(faster);
    assert_int_equal(files_in(*folder), 0);
    engine_close(engine);
    pool_free(pool);
}

static int set_up(void **folder)
{
    static char path[32];
    strcpy(path, "/tmp/test_close_XXXXXX");
    *folder = mkdtemp(path);
    return *folder ? setenv("TMPDIR", path, 1) : -1;
}

static int tear_down(void **folder)
{
    return rmdir(*folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(test_close, set_up, tear_down),
                                       cmocka_unit_test_setup_teardown(test_auto, set_up, tear_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
