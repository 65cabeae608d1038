/* SPDX-License-Identifier: MIT
 * gicl_write() and who listens: files are whole or not there, also where memory ends; tables and messages are heard in
 * the order in which they are kept; wrong studies are errors. tests/system/test_gicrun.sh and others see what is
 * written. */
#include "host/gic.h"

#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char quarter[] = "models/quarter_car.veh", scene[] = "models/scenes/quarter_car.scene";

typedef struct Lib {
    gicl_library *lib;
    gicl_messages *said;
    gicl_handle model;
    char folder[64];
} Lib;

static const gicl_options by_tape = {.size = sizeof by_tape, .engine = "tape"};

static int open_lib(void **state)
{
    static Lib lib;
    lib = (Lib){.lib = gicl_open(), .said = gicl_messages_new()};
    snprintf(lib.folder, sizeof lib.folder, "/tmp/gic-studies-XXXXXX");
    *state = &lib;
    return !mkdtemp(lib.folder) || gicl_model_open(lib.lib, quarter, &by_tape, &lib.model, lib.said);
}

/* Files in the folder; 1 in clear: they are removed. */
static int files(const char *folder, bool clear)
{
    DIR *listing = opendir(folder);
    int count = 0;
    char path[1000];
    for (const struct dirent *entry; (entry = readdir(listing));)
        if (entry->d_name[0] != '.') {
            ++count;
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            if (clear)
                remove(path);
        }
    closedir(listing);
    return count;
}

static int close_lib(void **state)
{
    Lib *lib = *state;
    files(lib->folder, true);
    gicl_messages_free(lib->said);
    return rmdir(lib->folder) || gicl_close(lib->lib);
}

static const char *in(const Lib *lib, const char *name, char path[100])
{
    snprintf(path, 100, "%s/%s", lib->folder, name);
    return path;
}

/* The bytes of a file; the caller frees them. */
static char *bytes(const char *path)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    const size_t size = (size_t)ftell(file);
    char *text = calloc(1, size + 1);
    rewind(file);
    assert_int_equal(fread(text, 1, size, file), size);
    fclose(file);
    return text;
}

static gicl_message last(const gicl_messages *said)
{
    gicl_message message = {.text = ""};
    gicl_message_get(said, gicl_message_count(said) - 1, &message);
    return message;
}

static void test_files(void **state)
{
    const Lib *lib = *state;
    char table[100], page[100];
    gicl_study study = {.size = sizeof study, .kind = "run", .scene = scene, .quiet = 1};
    study.results = in(lib, "run.csv", table);
    study.page = in(lib, "run.html", page);
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_OK);
    assert_int_equal(gicl_message_count(lib->said), 0);
    assert_int_equal(files(lib->folder, false), 2);
    char *csv = bytes(table), *html = bytes(page);
    assert_int_equal(strncmp(csv, "time [s],", 9), 0);
    assert_non_null(strstr(html, "</html>"));
    /* the second call reads the model anew, and finds the same */
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_OK);
    char *again = bytes(table);
    assert_string_equal(csv, again);
    free(again);
    free(csv);
    free(html);
    /* a table for people is a message, and the file beside it */
    study = (gicl_study){.size = sizeof study, .kind = "equilibrium", .results = table};
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_OK);
    assert_int_equal(gicl_message_count(lib->said), 1);
    assert_int_equal(last(lib->said).kind, GICL_TEXT);
    assert_int_equal(strncmp(last(lib->said).text, "quarter_car: static equilibrium", 31), 0);
    /* an input is not overwritten, a folder that is not there is an error, and nothing is left of it */
    files(lib->folder, true);
    study = (gicl_study){.size = sizeof study, .kind = "modes", .results = quarter};
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_FAILED);
    assert_non_null(strstr(last(lib->said).text, "overwritten"));
    study.results = in(lib, "no/modes.csv", table);
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_FAILED);
    assert_string_equal(last(lib->said).file, table);
    assert_int_equal(files(lib->folder, false), 0);
}

/* A run that ends early has its rows. */
static void test_early_end(void **state)
{
    const Lib *lib = *state;
    char path[100], table[100];
    FILE *file = fopen(in(lib, "long.scene", path), "w");
    fputs("gicscene: 1\nduration: 5\nstep: 0.2\n", file);
    fclose(file);
    const gicl_study study = {
        .size = sizeof study, .kind = "run", .scene = path, .results = in(lib, "run.csv", table), .quiet = 1};
    assert_int_equal(gicl_write(lib->lib, lib->model, &study, lib->said), GICL_FAILED);
    assert_int_equal(last(lib->said).kind, GICL_ERROR);
    assert_non_null(strstr(last(lib->said).text, "the run ends at t ="));
    char *csv = bytes(table);
    assert_non_null(strchr(strchr(csv, '\n') + 1, '\n'));
    free(csv);
}

/* ---- who listens ---------------------------------------------------------------------------------------------- */

typedef struct Heard {
    char printed[100000];
    int count, progress;
} Heard;

static void hear(void *context, const gicl_message *message)
{
    Heard *heard = context;
    heard->progress += message->kind == GICL_PROGRESS;
    if (message->kind == GICL_PROGRESS)
        return;
    ++heard->count;
    strncat(heard->printed, message->printed, sizeof heard->printed - strlen(heard->printed) - 1);
}

static void test_listener(void **state)
{
    static Heard heard;
    Lib *lib = *state;
    char path[100], kept[sizeof heard.printed] = "";
    FILE *file = fopen(in(lib, "far.scene", path), "w");
    fputs("gicscene: 1\nduration: 2000\nstep: 0.002\noutput_step: 1\n", file);
    fclose(file);
    const gicl_listener listener = {.size = sizeof listener, .program = "mine", .hear = hear, .context = &heard};
    assert_int_equal(gicl_listen(lib->lib, &listener, lib->said), GICL_OK);
    const gicl_study studies[] = {{.size = sizeof *studies, .kind = "run", .scene = path},
                                  {.size = sizeof *studies, .kind = "equilibrium"},
                                  {.size = sizeof *studies, .kind = "modes"},
                                  {.size = sizeof *studies, .kind = "kc"},
                                  {.size = sizeof *studies, .kind = "nothing"},
                                  {.size = sizeof *studies, .kind = "manoeuvre", .manoeuvre = "nothing"}};
    for (size_t i = 0; i < sizeof studies / sizeof *studies; ++i) {
        heard.count = 0;
        heard.printed[0] = kept[0] = 0;
        gicl_write(lib->lib, lib->model, &studies[i], lib->said);
        gicl_message message;
        for (int k = 0; gicl_message_get(lib->said, k, &message); ++k)
            strncat(kept, message.printed, sizeof kept - strlen(kept) - 1);
        assert_true(heard.count > 0);
        assert_int_equal(heard.count, gicl_message_count(lib->said));
        assert_string_equal(heard.printed, kept);
    }
    assert_true(heard.progress > 1);
    assert_string_equal(last(lib->said).file, "mine");
    assert_non_null(strstr(last(lib->said).remedy, "one of steady-speed,"));
    /* who wants no list hears all the same; and nobody */
    heard.count = 0;
    assert_int_equal(gicl_write(lib->lib, lib->model, &studies[1], NULL), GICL_OK);
    assert_int_equal(heard.count, 1);
    assert_int_equal(gicl_listen(lib->lib, NULL, lib->said), GICL_OK);
    assert_int_equal(gicl_write(lib->lib, lib->model, &studies[1], lib->said), GICL_OK);
    assert_int_equal(heard.count, 1);
    assert_int_equal(gicl_listen(lib->lib, &(gicl_listener){.size = 3}, lib->said), GICL_WRONG);
    assert_int_equal(gicl_listen(lib->lib, &(gicl_listener){.size = sizeof listener}, lib->said), GICL_WRONG);
    assert_int_equal(gicl_listen(NULL, &listener, lib->said), GICL_WRONG);
}

/* ---- wrong studies ---------------------------------------------------------------------------------------------- */

static void test_wrong_studies(void **state)
{
    const Lib *lib = *state;
    const double never = -1, now = 0;
    const char *const key[] = {"speed=x"};
    const gicl_study wrong[] = {
        {.size = 3, .kind = "modes"},
        {.size = sizeof *wrong},
        {.size = sizeof *wrong, .kind = "mode"},
        {.size = sizeof *wrong, .kind = "run"},
        {.size = sizeof *wrong, .kind = "drive", .scene = scene},
        {.size = sizeof *wrong, .kind = "eval", .states = quarter},
        {.size = sizeof *wrong, .kind = "eval", .results = "-"},
        {.size = sizeof *wrong, .kind = "linearize"},
        {.size = sizeof *wrong, .kind = "linearize", .results = "x.txt"},
        {.size = sizeof *wrong, .kind = "linearize", .results = "-", .at = &now},
        {.size = sizeof *wrong, .kind = "linearize", .results = "-", .scene = scene, .at = &never},
        {.size = sizeof *wrong, .kind = "modes", .at = &now, .scene = scene},
        {.size = sizeof *wrong, .kind = "modes", .plot = "x.svg"},
        {.size = sizeof *wrong, .kind = "modes", .page = "x.html"},
        {.size = sizeof *wrong, .kind = "run", .scene = scene, .plot = "x.gif"},
        {.size = sizeof *wrong, .kind = "run", .scene = scene, .with = quarter},
        {.size = sizeof *wrong,
         .kind = "run",
         .scene = scene,
         .results = "/tmp/gic-one.svg",
         .plot = "/tmp/gic-one.svg"},
        {.size = sizeof *wrong, .kind = "run", .scene = scene, .axle = "front"},
        {.size = sizeof *wrong, .kind = "run", .scene = scene, .loads = 1},
        {.size = sizeof *wrong, .kind = "kc", .travel = NAN},
        {.size = sizeof *wrong, .kind = "kc", .travel = -1},
        {.size = sizeof *wrong, .kind = "kc", .keys = 1},
        {.size = sizeof *wrong, .kind = "kc", .trace = "x"},
        {.size = sizeof *wrong, .kind = "manoeuvre"},
        {.size = sizeof *wrong, .kind = "manoeuvre", .manoeuvre = "braking", .scene = scene},
        {.size = sizeof *wrong, .kind = "manoeuvre", .manoeuvre = "braking", .keys = -1},
        {.size = sizeof *wrong, .kind = "manoeuvre", .manoeuvre = "braking", .keys = 1},
        {.size = sizeof *wrong, .kind = "manoeuvre", .manoeuvre = "braking", .keys = 1, .key = key},
        {.size = sizeof *wrong, .kind = "manoeuvre", .manoeuvre = "brake"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        if (gicl_write(lib->lib, lib->model, &wrong[i], lib->said) != GICL_WRONG)
            fail_msg("study %zu is taken: %s", i, last(lib->said).text);
        assert_true(strlen(last(lib->said).text) > 10);
    }
    assert_int_equal(gicl_write(lib->lib, lib->model, NULL, lib->said), GICL_WRONG);
    assert_int_equal(gicl_write(lib->lib, 77, &wrong[1], lib->said), GICL_WRONG);
    /* words */
    assert_string_equal(gicl_word("engine", 0), "auto");
    assert_string_equal(gicl_word("solve", 1), "reduced");
    assert_string_equal(gicl_word("recovery", 0), "auto");
    assert_string_equal(gicl_word("integrator", 0), "ab3");
    for (int i = -3; i < 100; ++i) {
        assert_null(gicl_word(NULL, i));
        assert_null(gicl_word("tolerance", i));
        if (i < 0 || i > 20)
            assert_null(gicl_word("engine", i));
    }
    /* an engine for runs alone, and one that becomes another */
    gicl_handle other, car;
    gicl_options options = {.size = sizeof options, .engine = "gic"};
    assert_int_equal(gicl_model_open(lib->lib, quarter, &options, &other, lib->said), GICL_OK);
    assert_int_equal(gicl_instance_new(lib->lib, other, NULL, &car, lib->said), GICL_FAILED);
    options.engine = "auto";
    assert_int_equal(gicl_model_open(lib->lib, quarter, &options, &other, lib->said), GICL_OK);
    assert_int_equal(gicl_instance_new(lib->lib, other, NULL, &car, lib->said), GICL_OK);
    options.lanes = 4;
    assert_int_equal(gicl_model_open(lib->lib, quarter, &options, &other, lib->said), GICL_FAILED);
    options = (gicl_options){.size = sizeof options, .engine = "cc", .lanes = 3};
    assert_int_equal(gicl_model_open(lib->lib, quarter, &options, &other, lib->said), GICL_FAILED);
}

/* ---- memory that ends ---------------------------------------------------------------------------------------- */

/* Allocations of our code until one fails; 0: none does. Later ones succeed again. */
static _Thread_local long until;
static _Thread_local bool failed;

static bool fails(void)
{
    if (until == 0 || --until > 0)
        return false;
    failed = true;
    return true;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return fails() ? NULL : __real_realloc(old, size);
}

static void test_no_memory(void **state)
{
    Lib *lib = *state;
    char table[100], page[100];
    in(lib, "table.csv", table);
    in(lib, "page.html", page);
    const gicl_study studies[] = {
        {.size = sizeof *studies, .kind = "run", .scene = scene, .results = table, .page = page},
        {.size = sizeof *studies, .kind = "equilibrium", .results = table},
        {.size = sizeof *studies, .kind = "modes", .results = table},
        {.size = sizeof *studies, .kind = "linearize", .results = table}};
    for (size_t i = 0; i < sizeof studies / sizeof *studies; ++i) {
        int rounds = 0;
        gicl_write(lib->lib, lib->model, &studies[i], lib->said); /* the next ones read the model anew */
        char *whole = bytes(table);
        files(lib->folder, true);
        do {
            failed = false;
            until = ++rounds;
            const int status = gicl_write(lib->lib, lib->model, &studies[i], lib->said);
            until = 0;
            if (status != GICL_OK) {
                assert_true(failed);
                assert_int_equal(last(lib->said).kind, GICL_ERROR);
                assert_non_null(strstr(last(lib->said).text, "memory"));
            }
            /* a file is whole */
            if (access(table, F_OK) == 0) {
                char *found = bytes(table);
                assert_string_equal(whole, found);
                free(found);
            } else
                assert_int_not_equal(status, GICL_OK);
            assert_true(files(lib->folder, false) <= 1 + (access(page, F_OK) == 0));
            files(lib->folder, true);
        } while (failed);
        free(whole);
        assert_true(rounds > 20);
    }
}

/* A sweep: its table is its file, memory that ends leaves finished runs and no more, and wrong calls are errors. */
static void test_sweep(void **state)
{
    enum { RUNS = 3 };
    const Lib *lib = *state;
    char path[100], table[100];
    setenv("OMP_NUM_THREADS", "1", 1); /* a process that fails in the place of this one would be seen by nobody */
    FILE *file = fopen(in(lib, "short.scene", path), "w");
    fputs("gicscene: 1\nduration: 0.02\nstep: 0.002\n", file);
    fclose(file);
    const char *const vary[] = {"bounce=0:0.05:3"}, *const other[] = {"bounce=0:0.05"}, *const twice[] = {*vary, *vary};
    const gicl_sweep sweep = {.size = sizeof sweep,
                              .scene = path,
                              .results = in(lib, "sweep.csv", table),
                              .vary = vary,
                              .varied = 1,
                              .alone = 1,
                              .quiet = 1};
    gicl_handle result;
    gicl_array array;
    assert_int_equal(gicl_sweep_run(lib->lib, lib->model, &sweep, &result, lib->said), GICL_OK);
    assert_int_equal(gicl_message_count(lib->said), 0);
    assert_int_equal(gicl_array_get(lib->lib, result, 0, &array, sizeof array, lib->said), GICL_OK);
    assert_int_equal(array.rows, RUNS);
    char *whole = bytes(table);
    const char *text = strchr(whole, '\n');
    assert_int_equal(strncmp(whole, "run,bounce [m],status,time [s],", 31), 0);
    for (int64_t i = 0; i < array.rows * array.columns; ++i) {
        char *end;
        const double value = strtod(text + 1, &end);
        assert_memory_equal(&value, &array.data[i], sizeof value);
        assert_int_equal(*end, (i + 1) % array.columns ? ',' : '\n');
        text = end;
    }
    assert_int_equal(text[1], 0);
    /* memory that ends: what is finished is kept, and the same call goes on to the same table */
    int rounds = 0;
    do {
        remove(table);
        failed = false;
        until = ++rounds;
        const int status = gicl_sweep_run(lib->lib, lib->model, &sweep, &result, lib->said);
        until = 0;
        if (status != GICL_OK) {
            assert_true(failed);
            assert_int_equal(result, 0);
            assert_non_null(strstr(last(lib->said).text, "memory"));
            assert_int_equal(gicl_sweep_run(lib->lib, lib->model, &sweep, NULL, lib->said), GICL_OK);
        }
        char *found = bytes(table);
        assert_string_equal(whole, found);
        free(found);
        assert_int_equal(files(lib->folder, false), 2);
    } while (failed);
    assert_true(rounds > 20);
    free(whole);
    gicl_sweep wrong[] = {sweep, sweep, sweep, sweep, sweep, sweep, sweep, sweep, sweep, sweep};
    wrong[0].size = 3;
    wrong[1].scene = NULL;
    wrong[2].results = NULL;
    wrong[3].vary = NULL;
    wrong[4].varied = 0;
    wrong[5].latin = -1;
    wrong[6].vary = other;
    wrong[7].vary = twice;
    wrong[7].varied = 2;
    wrong[8].report = "page.html"; /* of no metric */
    wrong[9].front = other;        /* on no page */
    wrong[9].fronts = 1;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i)
        assert_int_equal(gicl_sweep_run(lib->lib, lib->model, &wrong[i], &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_sweep_run(lib->lib, lib->model, NULL, &result, lib->said), GICL_WRONG);
    wrong[1].scene = quarter;
    assert_int_equal(gicl_sweep_run(lib->lib, lib->model, &wrong[1], &result, lib->said), GICL_FAILED);
}

static void test_wrong_benchmarks(void **state)
{
    const Lib *lib = *state;
    const char *const file[] = {quarter, scene, scene, NULL}, *const engine[] = {"tcc", "nothing"};
    const gicl_bench wrong[] = {
        {.size = 3, .kind = "rhs", .file = file, .files = 1},
        {.size = sizeof *wrong, .file = file, .files = 1},
        {.size = sizeof *wrong, .kind = "speed", .file = file, .files = 1},
        {.size = sizeof *wrong, .kind = "rhs", .files = 1},
        {.size = sizeof *wrong, .kind = "rhs", .file = file},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 3},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = -1},
        {.size = sizeof *wrong, .kind = "scenes", .file = file, .files = 3},
        {.size = sizeof *wrong, .kind = "scenes", .file = file, .files = 4},
        {.size = sizeof *wrong, .kind = "compare", .file = file, .files = 2},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 1, .rows = "x.csv"},
        {.size = sizeof *wrong, .kind = "precision", .file = file, .files = 2, .picture = "x.gif"},
        {.size = sizeof *wrong, .kind = "batch", .file = file, .files = 2},
        {.size = sizeof *wrong, .kind = "batch", .file = file, .files = 2, .vehicles = GICL_BENCH_VEHICLES + 1},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 1, .vehicles = 3},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 1, .engines = 1},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 1, .engines = -1},
        {.size = sizeof *wrong, .kind = "rhs", .file = file, .files = 1, .engines = 2, .engine = engine}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        if (gicl_measure(lib->lib, &wrong[i], lib->said) != GICL_WRONG)
            fail_msg("benchmark %zu is taken: %s", i, last(lib->said).text);
        assert_true(strlen(last(lib->said).text) > 10);
    }
    assert_int_equal(gicl_measure(lib->lib, NULL, lib->said), GICL_WRONG);
    assert_int_equal(gicl_measure(NULL, &wrong[1], lib->said), GICL_WRONG);
    /* a file that is none is an error of it */
    const char *const none[] = {"no.veh", scene};
    const gicl_bench bench = {
        .size = sizeof bench, .kind = "drive", .file = none, .files = 2, .engine = engine, .engines = 1};
    assert_int_equal(gicl_measure(lib->lib, &bench, lib->said), GICL_FAILED);
    assert_string_equal(last(lib->said).file, "no.veh");
}

/* ---- threads -------------------------------------------------------------------------------------------------- */

enum { THREADS = 8 };

typedef struct Thread {
    const Lib *lib;
    int number;
} Thread;

static void *write_one(void *given)
{
    const Thread *t = given;
    gicl_messages *said = gicl_messages_new();
    char name[20], path[100];
    const char *c, *h;
    snprintf(name, sizeof name, "%d.csv", t->number);
    const gicl_study study = {.size = sizeof study,
                              .kind = t->number % 2 ? "equilibrium" : "run",
                              .scene = t->number % 2 ? NULL : scene,
                              .results = in(t->lib, name, path)};
    const int status = gicl_write(t->lib->lib, t->lib->model, &study, said);
    const int made = gicl_generate(t->lib->lib, t->lib->model, &c, &h, said);
    gicl_messages_free(said);
    return status == GICL_OK && made == GICL_OK ? given : NULL;
}

static void test_threads(void **state)
{
    const Lib *lib = *state;
    Thread thread[THREADS];
    pthread_t id[THREADS];
    char path[100], *found[THREADS];
    for (int i = 0; i < THREADS; ++i) {
        thread[i] = (Thread){lib, i};
        assert_int_equal(pthread_create(&id[i], NULL, write_one, &thread[i]), 0);
    }
    for (int i = 0; i < THREADS; ++i) {
        void *done;
        assert_int_equal(pthread_join(id[i], &done), 0);
        assert_non_null(done);
        char name[20];
        snprintf(name, sizeof name, "%d.csv", i);
        found[i] = bytes(in(lib, name, path));
        assert_string_equal(found[i % 2], found[i]);
    }
    for (int i = 0; i < THREADS; ++i)
        free(found[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_files, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_early_end, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_listener, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_wrong_studies, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_no_memory, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_sweep, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_wrong_benchmarks, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_threads, open_lib, close_lib),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
