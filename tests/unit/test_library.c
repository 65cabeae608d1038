/* SPDX-License-Identifier: MIT
 * The library: what it computes has the bits of generated code that is called directly, wrong calls are errors, failing
 * calls leave nothing behind, and threads do not disturb one another. tests/system/test_library.sh compares it with
 * gicrun. */
#include "host/gic.h"

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

static const char quarter[] = "models/quarter_car.veh", pendulum[] = "models/pendulum.veh",
                  scene[] = "models/scenes/quarter_car.scene", swing[] = "models/scenes/pendulum.scene";

typedef struct Lib {
    gicl_library *lib;
    gicl_messages *said;
} Lib;

static int open_lib(void **state)
{
    static Lib lib;
    lib = (Lib){gicl_open(), gicl_messages_new()};
    *state = &lib;
    return !lib.lib || !lib.said;
}

static int close_lib(void **state)
{
    Lib *lib = *state;
    gicl_messages_free(lib->said);
    return gicl_close(lib->lib);
}

/* The text of the last message of a call. */
static const char *last(const gicl_messages *said)
{
    gicl_message message;
    const int count = gicl_message_count(said);
    return gicl_message_get(said, count - 1, &message) ? message.text : "";
}

static gicl_handle model(const Lib *lib, const char *path, const char *engine)
{
    gicl_handle opened;
    const gicl_options options = {.size = sizeof options, .engine = engine};
    if (gicl_model_open(lib->lib, path, &options, &opened, lib->said))
        fail_msg("%s", last(lib->said));
    return opened;
}

static gicl_handle instance(const Lib *lib, gicl_handle of, const char *in)
{
    gicl_handle opened;
    if (gicl_instance_new(lib->lib, of, in, &opened, lib->said))
        fail_msg("%s", last(lib->said));
    return opened;
}

#define GOOD(call) \
    do { \
        if (call) \
            fail_msg("%s: %s", #call, last(lib->said)); \
    } while (0)

/* ---- numbers ------------------------------------------------------------------------------------------------- */

/* Engines share no more than the formulation, and agree bit for bit. */
static void test_engines_agree(void **state)
{
    const Lib *lib = *state;
    const char *const engine[] = {"tcc", "cc", "tape"};
    double *reference = NULL;
    int count = 0;
    for (int e = 0; e < 3; ++e) {
        const gicl_handle m = model(lib, quarter, engine[e]), car = instance(lib, m, scene);
        double *data;
        GOOD(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 300, lib->said));
        GOOD(gicl_view(lib->lib, car, GICL_STATE, &data, &count, lib->said));
        if (!reference) {
            reference = malloc(sizeof *reference * (size_t)count);
            memcpy(reference, data, sizeof *reference * (size_t)count);
        }
        assert_memory_equal(reference, data, sizeof *reference * (size_t)count);
    }
    free(reference);
}

static void test_snapshot(void **state)
{
    const Lib *lib = *state;
    const gicl_handle m = model(lib, quarter, "tcc"), car = instance(lib, m, scene);
    double *data, before[64], after[64], time;
    int count;
    size_t size;
    GOOD(gicl_view(lib->lib, car, GICL_STATE, &data, &count, lib->said));
    assert_true(count <= 64);
    GOOD(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 50, lib->said));
    GOOD(gicl_snapshot_size(lib->lib, car, &size, lib->said));
    char *bytes = malloc(size);
    GOOD(gicl_snapshot(lib->lib, car, bytes, size, lib->said));
    memcpy(before, data, sizeof *data * (size_t)count);
    GOOD(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 50, lib->said));
    memcpy(after, data, sizeof *data * (size_t)count);
    GOOD(gicl_restore(lib->lib, car, bytes, size, lib->said));
    assert_memory_equal(before, data, sizeof *data * (size_t)count);
    GOOD(gicl_time(lib->lib, car, &time, lib->said));
    assert_true(fabs(time - 0.05) < 1e-12);
    GOOD(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 50, lib->said));
    assert_memory_equal(after, data, sizeof *data * (size_t)count);
    /* every single changed byte is refused, and the instance is as it was */
    for (size_t i = 0; i < size; ++i) {
        bytes[i] = (char)(bytes[i] + 1);
        assert_int_equal(gicl_restore(lib->lib, car, bytes, size, lib->said), GICL_WRONG);
        bytes[i] = (char)(bytes[i] - 1);
    }
    assert_memory_equal(after, data, sizeof *data * (size_t)count);
    assert_int_equal(gicl_restore(lib->lib, car, bytes, size - 1, lib->said), GICL_WRONG);
    /* and by another model */
    const gicl_handle other = instance(lib, model(lib, pendulum, "tcc"), NULL);
    assert_int_equal(gicl_restore(lib->lib, other, bytes, size, lib->said), GICL_WRONG);
    free(bytes);
}

/* Each vehicle of a batch has the bits that it has alone; one that fails disturbs no other. */
static void test_batch(void **state)
{
    enum { VEHICLES = 5, BAD = 2 };
    const Lib *lib = *state;
    const gicl_handle m = model(lib, quarter, "tcc");
    gicl_handle batch;
    double *all, *one;
    int count;
    size_t stride;
    int32_t each[VEHICLES];
    GOOD(gicl_batch_new(lib->lib, m, scene, VEHICLES, 1, &batch, lib->said));
    GOOD(gicl_batch_view(lib->lib, batch, GICL_STATE, &all, &count, &stride, lib->said));
    for (int v = 0; v < VEHICLES; ++v)
        all[(size_t)v * stride + (size_t)count / 2] += 0.01 * v;
    all[BAD * stride] = NAN;
    GOOD(gicl_batch_restart(lib->lib, batch, NULL, lib->said));
    assert_int_equal(gicl_batch_step(lib->lib, batch, 0.001, GICL_RK4, 1, 100, each, lib->said), -2);
    assert_non_null(strstr(last(lib->said), "vehicle 2"));
    for (int v = 0; v < VEHICLES; ++v) {
        assert_int_equal(each[v], v == BAD ? -2 : 0);
        if (v == BAD)
            continue;
        const gicl_handle car = instance(lib, m, scene);
        GOOD(gicl_view(lib->lib, car, GICL_STATE, &one, &count, lib->said));
        one[count / 2] += 0.01 * v;
        GOOD(gicl_restart(lib->lib, car, 0, lib->said));
        GOOD(gicl_step(lib->lib, car, 0.001, GICL_RK4, 1, 100, lib->said));
        assert_memory_equal(one, all + (size_t)v * stride, sizeof *one * (size_t)count);
    }
    const uint8_t which[VEHICLES] = {[BAD] = 1};
    GOOD(gicl_batch_reset(lib->lib, batch, which, lib->said));
    GOOD(gicl_batch_step(lib->lib, batch, 0.001, GICL_RK4, 1, 100, each, lib->said));
    GOOD(gicl_batch_outputs(lib->lib, batch, each, lib->said));
}

/* ---- wrong calls ---------------------------------------------------------------------------------------------- */

static void test_wrong_calls(void **state)
{
    const Lib *lib = *state;
    gicl_handle m = model(lib, quarter, "tcc"), car = instance(lib, m, NULL), other, result;
    double *data, time, number[200] = {0};
    int count, states;
    const char *name, *unit;
    GOOD(gicl_count(lib->lib, m, GICL_STATE, &states, lib->said));
    /* another kind of thing, numbers out of range */
    assert_int_equal(gicl_step(lib->lib, m, 0.001, GICL_AB3, 1, 1, lib->said), GICL_WRONG);
    assert_non_null(strstr(last(lib->said), "of a model, where an instance is wanted"));
    assert_int_equal(gicl_count(lib->lib, car, GICL_STATE, &count, lib->said), GICL_WRONG);
    assert_int_equal(gicl_view(lib->lib, car, 77, &data, &count, lib->said), GICL_WRONG);
    assert_int_equal(gicl_view(lib->lib, car, -1, &data, &count, lib->said), GICL_WRONG);
    assert_int_equal(gicl_signal(lib->lib, m, GICL_STATE, states, &name, &unit, lib->said), GICL_WRONG);
    assert_int_equal(gicl_signal(lib->lib, m, GICL_STATE, -1, &name, &unit, lib->said), GICL_WRONG);
    assert_int_equal(gicl_rhs(lib->lib, car, 0, number, number + 100, states + 1, lib->said), GICL_WRONG);
    assert_int_equal(gicl_rhs(lib->lib, car, 0, NULL, number, states, lib->said), GICL_WRONG);
    assert_int_equal(gicl_set_up(lib->lib, car, number, 199, lib->said), GICL_WRONG);
    assert_int_equal(gicl_batch_new(lib->lib, m, NULL, 0, 1, &other, lib->said), GICL_WRONG);
    assert_int_equal(gicl_batch_new(lib->lib, m, NULL, -5, 1, &other, lib->said), GICL_WRONG);
    assert_int_equal(gicl_run(lib->lib, m, NULL, &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_linearize(lib->lib, m, NULL, 1, &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_gradient(lib->lib, m, NULL, "time", NULL, 0, &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_gradient(lib->lib, m, quarter, NULL, NULL, 0, &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_gradient(lib->lib, m, quarter, "time", NULL, 1, &result, lib->said), GICL_WRONG);
    assert_int_equal(gicl_restart(lib->lib, car, NAN, lib->said), GICL_WRONG);
    assert_int_equal(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, -1, lib->said), GICL_WRONG);
    /* by generated code: a step, a method, a state that are no good */
    assert_int_equal(gicl_step(lib->lib, car, NAN, GICL_AB3, 1, 1, lib->said), -1);
    assert_int_equal(gicl_step(lib->lib, car, 0.001, 9, 1, 1, lib->said), -1);
    assert_true(strlen(last(lib->said)) > 10);
    number[0] = NAN;
    assert_int_equal(gicl_rhs(lib->lib, car, 0, number, number + 100, states, lib->said), -2);
    /* a name, with the nearest one */
    gicl_message message;
    assert_int_equal(gicl_find(lib->lib, m, GICL_STATE, "no such", &count, lib->said), GICL_WRONG);
    GOOD(gicl_signal(lib->lib, m, GICL_STATE, 0, &name, &unit, lib->said));
    char near[100];
    snprintf(near, sizeof near, "%sx", name);
    assert_int_equal(gicl_find(lib->lib, m, GICL_STATE, near, &count, lib->said), GICL_WRONG);
    assert_true(gicl_message_get(lib->said, 0, &message));
    assert_non_null(strstr(message.remedy, name));
    GOOD(gicl_find(lib->lib, m, GICL_STATE, name, &count, lib->said));
    assert_int_equal(count, 0);
    /* closed things: the model goes first, and its instance goes on */
    GOOD(gicl_free(lib->lib, m, lib->said));
    assert_int_equal(gicl_free(lib->lib, m, lib->said), GICL_WRONG);
    assert_int_equal(gicl_instance_new(lib->lib, m, NULL, &other, lib->said), GICL_WRONG);
    GOOD(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 5, lib->said));
    GOOD(gicl_free(lib->lib, car, lib->said));
    assert_int_equal(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 5, lib->said), GICL_WRONG);
    assert_int_equal(gicl_time(lib->lib, car, &time, lib->said), GICL_WRONG);
    /* the place in the table is used again, by another handle */
    m = model(lib, quarter, "tcc");
    const gicl_handle next = instance(lib, m, NULL);
    assert_int_not_equal(next, car);
    assert_int_equal(gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 5, lib->said), GICL_WRONG);
    for (gicl_handle i = 0; i < 100; ++i) {
        assert_int_equal(gicl_free(lib->lib, i, NULL), GICL_WRONG);
        assert_int_equal(gicl_free(lib->lib, (i + 50) << 32, NULL), GICL_WRONG);
        assert_int_equal(gicl_free(lib->lib, ~i, NULL), GICL_WRONG);
    }
    /* no library, no place for results, nobody who listens */
    assert_int_equal(gicl_step(NULL, next, 0.001, GICL_AB3, 1, 1, lib->said), GICL_WRONG);
    assert_int_equal(gicl_close(NULL), GICL_WRONG);
    assert_int_equal(gicl_model_open(lib->lib, quarter, NULL, NULL, lib->said), GICL_WRONG);
    assert_int_equal(gicl_model_open(lib->lib, NULL, NULL, &other, NULL), GICL_WRONG);
    assert_int_equal(gicl_time(lib->lib, next, NULL, NULL), GICL_WRONG);
    const gicl_options options[] = {{.size = 3},
                                    {.size = sizeof *options, .engine = "tccc"},
                                    {.size = sizeof *options, .lanes = 4},
                                    {.size = sizeof *options, .solve = "?"},
                                    {.size = sizeof *options, .recovery = "?"},
                                    {.size = sizeof *options, .integrator = "euler"},
                                    {.size = sizeof *options, .tolerance = NAN}};
    for (size_t i = 0; i < sizeof options / sizeof *options; ++i)
        assert_int_not_equal(gicl_model_open(lib->lib, quarter, &options[i], &other, lib->said), GICL_OK);
}

/* ---- failures ------------------------------------------------------------------------------------------------- */

/* Pages of this process in memory. */
static long resident(void)
{
    long size = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &size, &pages) != 2)
        pages = 0;
    if (file)
        fclose(file);
    return pages;
}

static void test_failures_leave_nothing(void **state)
{
    static const char *const bad[] = {"tests/data/mistakes/body_key_unknown.veh",
                                      "tests/data/mistakes/bytes_nul.veh",
                                      "tests/data/mistakes/coordinate_range.veh",
                                      "tests/data/mistakes/empty.veh",
                                      "no/such/file.veh",
                                      "models"};
    const Lib *lib = *state;
    gicl_handle handle;
    const gicl_handle m = model(lib, quarter, "tcc");
    long before = 0;
    for (int round = 0; round < 400; ++round) {
        if (round == 100)
            before = resident();
        for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
            assert_int_equal(gicl_model_open(lib->lib, bad[i], NULL, &handle, lib->said), GICL_FAILED);
            assert_int_equal(handle, 0);
            assert_true(strlen(last(lib->said)) > 5);
        }
        /* a scene that is none, and one of another model */
        assert_int_equal(gicl_run(lib->lib, m, quarter, &handle, lib->said), GICL_FAILED);
        assert_int_equal(gicl_instance_new(lib->lib, m, quarter, &handle, lib->said), GICL_FAILED);
    }
    /* 300 rounds of 8 failures: less than 1 kB each. The sanitizer keeps freed memory, and finds leaks itself */
#ifdef __SANITIZE_ADDRESS__
    (void)before;
#else
    assert_true((resident() - before) * sysconf(_SC_PAGESIZE) < 300 * 8 * 1024L);
#endif
}

/* ---- memory that ends ---------------------------------------------------------------------------------------- */

/* Allocations of our code until one fails, in this thread; 0: none does. Later ones succeed again. */
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

/* All kinds of calls, by the engine that needs no libtcc. The status of the first that fails. */
static int many_calls(gicl_library *lib, gicl_messages *said)
{
    const gicl_options options = {.size = sizeof options, .engine = "tape"};
    gicl_handle m, car, batch, result;
    const char *c, *h;
    int status = gicl_model_open(lib, quarter, &options, &m, said);
    if (!status)
        status = gicl_generate(lib, m, &c, &h, said);
    if (!status)
        status = gicl_instance_new(lib, m, scene, &car, said);
    if (!status)
        status = gicl_step(lib, car, 0.001, GICL_AB3, 1, 3, said);
    if (!status)
        status = gicl_batch_new(lib, m, NULL, 3, 1, &batch, said);
    if (!status)
        status = gicl_run(lib, m, scene, &result, said);
    return status;
}

static void test_no_memory(void **state)
{
    const Lib *lib = *state;
    int rounds = 0;
    do {
        gicl_library *own = gicl_open();
        failed = false;
        until = ++rounds;
        const int status = many_calls(own, lib->said);
        until = 0;
        /* a warning may be lost without a failure, nothing else */
        if (status != GICL_OK) {
            assert_true(failed);
            assert_non_null(strstr(last(lib->said), "memory"));
        }
        assert_int_equal(gicl_close(own), GICL_OK);
    } while (failed);
    assert_true(rounds > 30);
}

static void test_text(void **state)
{
    const Lib *lib = *state;
    static char text[1 << 16];
    FILE *file = fopen(quarter, "rb");
    assert_non_null(file);
    const size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    gicl_handle of_text, other;
    const char *c, *h, *of_file_c, *of_file_h;
    GOOD(gicl_model_text(lib->lib, "models/x.veh", text, size, NULL, &of_text, lib->said));
    GOOD(gicl_generate(lib->lib, of_text, &c, &h, lib->said));
    GOOD(gicl_generate(lib->lib, model(lib, quarter, "tcc"), &of_file_c, &of_file_h, lib->said));
    assert_string_equal(c, of_file_c);
    assert_string_equal(h, of_file_h);
    /* messages name the text, with line and column */
    gicl_message message;
    assert_int_equal(gicl_model_text(lib->lib, "mine.veh", "gicgen: 1\nmodel: a b\n", 21, NULL, &other, lib->said),
                     GICL_FAILED);
    assert_true(gicl_message_get(lib->said, 0, &message));
    assert_string_equal(message.file, "mine.veh");
    assert_true(message.line > 0 && message.column > 0);
    assert_non_null(message.remedy);
}

/* Vehicles in lanes have the bits of those that go one after another, whatever happens to some of them. */
static void test_lanes(void **state)
{
    enum { VEHICLES = 11, BAD = 5, STEPS = 60 };
    const Lib *lib = *state;
    const gicl_handle m = model(lib, quarter, "tcc");
    const int lanes[] = {1, 4, 8};
    double kept[3][STEPS][VEHICLES][16];
    memset(kept, 0, sizeof kept);
    for (int way = 0; way < 3; ++way) {
        gicl_handle batch;
        double *data, *input;
        int count, inputs;
        size_t stride, input_stride;
        int32_t each[VEHICLES];
        const int w = lanes[way];
        GOOD(gicl_batch_new(lib->lib, m, scene, VEHICLES, w, &batch, lib->said));
        GOOD(gicl_batch_view(lib->lib, batch, GICL_STATE, &data, &count, &stride, lib->said));
        GOOD(gicl_batch_view(lib->lib, batch, GICL_INPUT, &input, &inputs, &input_stride, lib->said));
        assert_true(count <= 8);
#define AT(v, i) data[(size_t)((v) / w) * stride + (size_t)((i)*w + (v) % w)]
        for (int v = 0; v < VEHICLES; ++v)
            AT(v, 0) += 0.002 * v;
        GOOD(gicl_batch_restart(lib->lib, batch, NULL, lib->said));
        for (int k = 0; k < STEPS; ++k) {
            uint8_t which[VEHICLES] = {0};
            if (k == 20)
                AT(BAD, 1) = NAN;
            const int status =
                gicl_batch_step(lib->lib, batch, 0.002, k < 40 ? GICL_AB3 : GICL_RK4, 1, 3, each, lib->said);
            assert_int_equal(status != 0, k >= 20 && k < 30);
            for (int v = 0; v < VEHICLES; ++v)
                assert_int_equal(each[v], v == BAD ? status : 0);
            if (k == 25)
                assert_int_equal(gicl_batch_outputs(lib->lib, batch, each, lib->said) != 0, 1);
            which[BAD] = which[2] = 1;
            if (k == 29)
                GOOD(gicl_batch_reset(lib->lib, batch, which, lib->said));
            if (k == 50)
                GOOD(gicl_batch_outputs(lib->lib, batch, NULL, lib->said));
            for (int v = 0; v < VEHICLES; ++v)
                for (int i = 0; i < count; ++i)
                    kept[way][k][v][i] = AT(v, i);
        }
#undef AT
        GOOD(gicl_batch_view(lib->lib, batch, GICL_OUTPUT, &data, &count, &stride, lib->said));
        for (int v = 0; v < VEHICLES; ++v)
            for (int i = 0; i < count && i < 8; ++i)
                kept[way][0][v][8 + i] = data[(size_t)(v / w) * stride + (size_t)(i * w + v % w)];
        assert_memory_equal(kept[0], kept[way], sizeof kept[0]);
        assert_int_equal(gicl_batch_step(lib->lib, batch, 0.002, 7, 1, 1, each, lib->said), -1);
        assert_int_equal(gicl_batch_step(lib->lib, batch, 0.002, GICL_AB3, 0, 1, each, lib->said), -1);
        GOOD(gicl_free(lib->lib, batch, lib->said));
    }
    gicl_handle other;
    for (int w = -1; w < 40; ++w)
        if (w != 1 && w != 2 && w != 4 && w != 8 && w != 16)
            assert_int_equal(gicl_batch_new(lib->lib, m, scene, 3, w, &other, lib->said), GICL_WRONG);
    const gicl_handle tires = model(lib, "models/hmmwv_tires.veh", "tape");
    double last_state[2][3][60];
    double *data;
    size_t stride;
    int states;
    for (int way = 0; way < 2; ++way) {
        const int w = way ? 4 : 1;
        GOOD(gicl_batch_new(lib->lib, tires, "models/scenes/tires_coast.scene", 3, w, &other, lib->said));
        GOOD(gicl_batch_view(lib->lib, other, GICL_STATE, &data, &states, &stride, lib->said));
        assert_true(states <= 60);
        for (int v = 0; v < 3; ++v)
            data[(size_t)(v / w) * stride + (size_t)(2 * w + v % w)] += 0.01 * v;
        GOOD(gicl_batch_step(lib->lib, other, 0.004, GICL_AB3, 4, 20, NULL, lib->said));
        for (int v = 0; v < 3; ++v)
            for (int i = 0; i < states; ++i)
                last_state[way][v][i] = data[(size_t)(v / w) * stride + (size_t)(i * w + v % w)];
    }
    /* tires, interpreted and in lanes that are compiled: the same bits */
    for (int v = 0; v < 3; ++v)
        assert_memory_equal(last_state[0][v], last_state[1][v], sizeof(double) * (size_t)states);
}

/* A step in which a controller would sample without end. */
static void test_endless_step(void **state)
{
    const Lib *lib = *state;
    const double step[] = {1e308, 1e4};
    const char *const engine[] = {"tcc", "tape"};
    for (int e = 0; e < 2; ++e) {
        const gicl_handle m = model(lib, "models/controllers/skyhook.veh", engine[e]), car = instance(lib, m, NULL);
        double *data, before[64];
        int count;
        GOOD(gicl_view(lib->lib, car, GICL_STATE, &data, &count, lib->said));
        memcpy(before, data, sizeof *data * (size_t)count);
        for (size_t i = 0; i < sizeof step / sizeof *step; ++i) {
            assert_int_equal(gicl_step(lib->lib, car, step[i], GICL_RK4, 1, 1, lib->said), -16);
            assert_non_null(strstr(last(lib->said), "controllers sample"));
            assert_memory_equal(before, data, sizeof *data * (size_t)count);
        }
        GOOD(gicl_step(lib->lib, car, 0.5, GICL_RK4, 1, 1, lib->said));
    }
}

/* ---- threads -------------------------------------------------------------------------------------------------- */

enum { THREADS = 8 };

typedef struct Thread {
    const Lib *lib;
    gicl_handle model[2]; /* shared by all */
    int number;
    double sum;
} Thread;

/* Everything at once: models of its own, instances of shared ones, runs, failures. */
static void *work(void *given)
{
    Thread *t = given;
    Lib own = {t->lib->lib, gicl_messages_new()}, *lib = &own;
    const char *const path[] = {quarter, pendulum}, *const scenes[] = {scene, swing};
    t->sum = 0;
    for (int round = 0; round < 2; ++round)
        for (int k = 0; k < 2; ++k) {
            const int which = (k + t->number) % 2;
            gicl_handle mine, car, result, none;
            gicl_array array;
            double *data;
            int count;
            if (gicl_model_open(lib->lib, path[which], NULL, &mine, lib->said) ||
                gicl_instance_new(lib->lib, round ? mine : t->model[which], scenes[which], &car, lib->said) ||
                gicl_step(lib->lib, car, 0.001, GICL_AB3, 1, 200, lib->said) ||
                gicl_view(lib->lib, car, GICL_STATE, &data, &count, lib->said) ||
                gicl_run(lib->lib, t->model[which], scenes[which], &result, lib->said) ||
                gicl_array_get(lib->lib, result, 0, &array, sizeof array, lib->said))
                return NULL;
            for (int i = 0; i < count; ++i)
                t->sum += data[i] * (which + 1);
            for (int64_t i = 0; i < array.rows * array.columns; ++i)
                t->sum += array.data[i];
            if (gicl_model_open(lib->lib, "no.veh", NULL, &none, lib->said) != GICL_FAILED)
                return NULL;
            gicl_free(lib->lib, car, NULL);
            gicl_free(lib->lib, result, NULL);
            gicl_free(lib->lib, mine, NULL);
        }
    gicl_messages_free(own.said);
    return t;
}

static void test_threads(void **state)
{
    const Lib *lib = *state;
    const gicl_handle shared[] = {model(lib, quarter, "tcc"), model(lib, pendulum, "tape")};
    Thread thread[THREADS], alone[THREADS];
    pthread_t id[THREADS];
    for (int i = 0; i < THREADS; ++i) {
        thread[i] = alone[i] = (Thread){lib, {shared[0], shared[1]}, i, 0};
        assert_non_null(work(&alone[i]));
    }
    for (int i = 0; i < THREADS; ++i)
        assert_int_equal(pthread_create(&id[i], NULL, work, &thread[i]), 0);
    for (int i = 0; i < THREADS; ++i) {
        void *done;
        assert_int_equal(pthread_join(id[i], &done), 0);
        assert_non_null(done);
        assert_memory_equal(&thread[i].sum, &alone[i].sum, sizeof(double));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_engines_agree, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_snapshot, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_batch, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_wrong_calls, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_failures_leave_nothing, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_no_memory, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_text, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_lanes, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_endless_step, open_lib, close_lib),
        cmocka_unit_test_setup_teardown(test_threads, open_lib, close_lib),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
