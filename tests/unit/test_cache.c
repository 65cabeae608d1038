/* SPDX-License-Identifier: MIT
 * The cache of compiled objects: what is kept is found again whole, damaged objects are not, limits hold, and several
 * processes may write at once. */
#include "base/file.h"
#include "engine/engine.h"
#include "engine/object_cache.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

typedef struct Shelf {
    Pool *pool;
    const char *root, *folder, *object;
} Shelf;

static int set_up(void **state)
{
    static Shelf f;
    umask(022);
    f.pool = pool_new();
    char *folder = pool_print(f.pool, "%s/gicgen-cache-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    if (!mkdtemp(folder))
        return -1;
    f.root = folder;
    f.object = pool_print(f.pool, "%s/object", folder);
    f.folder = pool_print(f.pool, "%s/a/b", folder);
    setenv("GICGEN_CACHE", f.folder, 1);
    *state = &f;
    return 0;
}

static int tear_down(void **state)
{
    Shelf *f = *state;
    const int status = system(pool_print(f->pool, "rm -rf '%s'", f->root));
    pool_free(f->pool);
    return status;
}

static void put(Shelf *f, size_t size, char fill)
{
    char *bytes = pool_alloc(f->pool, size);
    memset(bytes, fill, size);
    file_write(f->object, bytes, size);
}

static int64_t size_of(const char *path)
{
    struct stat is;
    return stat(path, &is) ? -1 : (int64_t)is.st_size;
}

static void test_keys(void **state)
{
    Shelf *f = *state;
    const char *a = cache_key(f->pool, (const char *[]){"ab", "c", NULL});
    assert_int_equal(strlen(a), 32);
    assert_string_equal(a, cache_key(f->pool, (const char *[]){"ab", "c", NULL}));
    assert_string_not_equal(a, cache_key(f->pool, (const char *[]){"a", "bc", NULL}));
    assert_string_not_equal(a, cache_key(f->pool, (const char *[]){"ab", "d", NULL}));
}

static void test_kept_is_found(void **state)
{
    Shelf *f = *state;
    const char *why, *folder = cache_folder(f->pool, &why);
    assert_string_equal(folder, f->folder);
    put(f, 1000, 'x');
    assert_null(cache_find(f->pool, folder, "one"));
    assert_true(cache_keep(f->pool, folder, "one", f->object, CACHE_MOST));
    const char *path = cache_find(f->pool, folder, "one");
    assert_non_null(path);
    size_t size;
    const char *bytes = file_read(f->pool, path, TEXT_MOST, &size);
    assert_true(size > 1000 && bytes[0] == 'x' && bytes[999] == 'x');
    assert_null(cache_find(f->pool, folder, "two"));
    assert_false(cache_keep(f->pool, folder, "two", "/nonexistent/object", CACHE_MOST));
}

/* Every truncation and every changed byte is noticed; a damaged object is gone afterwards. */
static void test_damage(void **state)
{
    Shelf *f = *state;
    const char *why, *folder = cache_folder(f->pool, &why);
    put(f, 64, 'x');
    assert_true(cache_keep(f->pool, folder, "one", f->object, CACHE_MOST));
    const char *path = cache_find(f->pool, folder, "one");
    size_t size;
    char *bytes = file_read(f->pool, path, TEXT_MOST, &size);
    for (size_t kept = 0; kept < size; ++kept) {
        file_write(path, bytes, kept);
        assert_null(cache_find(f->pool, folder, "one"));
        assert_int_equal(size_of(path), -1);
    }
    for (size_t i = 0; i < size; ++i) {
        bytes[i] ^= 1;
        file_write(path, bytes, size);
        assert_null(cache_find(f->pool, folder, "one"));
        bytes[i] ^= 1;
    }
    file_write(path, bytes, size);
    assert_non_null(cache_find(f->pool, folder, "one"));
}

static void test_limit(void **state)
{
    Shelf *f = *state;
    const char *why, *folder = cache_folder(f->pool, &why);
    const struct timespec moment = {0, 20000000};
    put(f, 1000, 'x');
    for (int i = 0; i < 5; ++i) {
        assert_true(cache_keep(f->pool, folder, pool_print(f->pool, "key%d", i), f->object, 3500));
        nanosleep(&moment, NULL);
        /* the first is used all along and so stays */
        assert_non_null(cache_find(f->pool, folder, "key0"));
        nanosleep(&moment, NULL);
    }
    assert_null(cache_find(f->pool, folder, "key1"));
    assert_null(cache_find(f->pool, folder, "key2"));
    assert_non_null(cache_find(f->pool, folder, "key3"));
    assert_non_null(cache_find(f->pool, folder, "key4"));
    setenv("GICGEN_CACHE_SIZE", "7", 1);
    assert_int_equal(cache_limit(), 7 << 20);
    setenv("GICGEN_CACHE_SIZE", "much", 1);
    assert_int_equal(cache_limit(), CACHE_MOST);
    unsetenv("GICGEN_CACHE_SIZE");
}

/* Processes that keep the same and other objects at once, some of them killed on the way: nothing half is ever found.
 */
static void test_processes(void **state)
{
    enum { PROCESSES = 8, ROUNDS = 40 };
    Shelf *f = *state;
    const char *why, *folder = cache_folder(f->pool, &why);
    pid_t child[PROCESSES];
    put(f, 200000, 'x');
    for (int p = 0; p < PROCESSES; ++p)
        if (!(child[p] = fork())) {
            static char bytes[200100];
            for (int i = 0; i < ROUNDS; ++i) {
                const char *key = pool_print(f->pool, "key%d", i % 4);
                cache_keep(f->pool, folder, key, f->object, 500000);
                const char *path = cache_find(f->pool, folder, key);
                FILE *file = path ? fopen(path, "rb") : NULL; /* another process may have dropped it */
                if (!file)
                    continue;
                const size_t size = fread(bytes, 1, sizeof bytes, file);
                fclose(file);
                if (size <= 200000 || bytes[0] != 'x' || bytes[199999] != 'x')
                    _exit(1);
            }
            _exit(0);
        }
    const struct timespec moment = {0, 30000000};
    nanosleep(&moment, NULL);
    kill(child[0], SIGKILL);
    kill(child[1], SIGKILL);
    for (int p = 0; p < PROCESSES; ++p) {
        int status;
        waitpid(child[p], &status, 0);
        assert_true(p < 2 || (WIFEXITED(status) && WEXITSTATUS(status) == 0));
    }
    assert_true(cache_keep(f->pool, folder, "key0", f->object, 500000));
    assert_non_null(cache_find(f->pool, folder, "key0"));
}

static void test_folders(void **state)
{
    Shelf *f = *state;
    const char *why;
    setenv("GICGEN_CACHE", "", 1);
    assert_null(cache_folder(f->pool, &why));
    assert_null(why);
    setenv("GICGEN_CACHE", "/proc/nowhere", 1);
    assert_null(cache_folder(f->pool, &why));
    assert_non_null(strstr(why, "/proc/nowhere"));
    put(f, 100, 'x');
    assert_false(cache_keep(f->pool, "/proc/nowhere", "one", f->object, CACHE_MOST));
    /* where anybody could put an object */
    setenv("GICGEN_CACHE", f->folder, 1);
    assert_non_null(cache_folder(f->pool, &why));
    const mode_t open_to[] = {0777, 0770, 0702};
    for (size_t i = 0; i < sizeof open_to / sizeof *open_to; ++i) {
        assert_int_equal(chmod(f->folder, open_to[i]), 0);
        assert_null(cache_folder(f->pool, &why));
        assert_non_null(strstr(why, "others may write"));
    }
    assert_int_equal(chmod(f->folder, 0700), 0);
    /* without a name of its own */
    unsetenv("GICGEN_CACHE");
    setenv("XDG_CACHE_HOME", f->folder, 1);
    assert_string_equal(cache_folder(f->pool, &why), pool_print(f->pool, "%s/gicgen", f->folder));
    unsetenv("XDG_CACHE_HOME");
    setenv("HOME", f->root, 1);
    assert_string_equal(cache_folder(f->pool, &why), pool_print(f->pool, "%s/.cache/gicgen", f->root));
    unsetenv("HOME");
    assert_null(cache_folder(f->pool, &why));
    assert_non_null(why);
}

/* An object that somebody else may have written is none, whatever its seal says. */
static void test_foreign_objects(void **state)
{
    Shelf *f = *state;
    const char *why, *folder = cache_folder(f->pool, &why);
    const char *aside = pool_print(f->pool, "%s/aside", f->root);
    put(f, 100, 'x');
    for (int way = 0; way < 4; ++way) {
        assert_true(cache_keep(f->pool, folder, "one", f->object, CACHE_MOST));
        const char *path = cache_find(f->pool, folder, "one");
        assert_non_null(path);
        if (way < 2) {
            assert_int_equal(chmod(path, way ? 0602 : 0660), 0);
        } else if (way == 2) { /* a link to a good one */
            assert_int_equal(rename(path, aside), 0);
            assert_int_equal(symlink(aside, path), 0);
        } else if (chown(path, 65534, (gid_t)-1)) {
            break; /* only root can give a file away */
        }
        assert_null(cache_find(f->pool, folder, "one"));
        assert_int_equal(size_of(path), -1);
    }
}

/* Code for the processor at hand is another one's code elsewhere: what the first processor is and can do is part of
 * what an object is kept under, where the system says it. */
static void test_processor(void **state)
{
    Shelf *f = *state;
    static const char *const says[] = {"model name", "CPU part", "flags", "Features"};
    const char *identity = compiler_identity(f->pool, (const char *const[]){"cc"}, 1);
    FILE *file = fopen("/proc/cpuinfo", "r");
    bool found[4] = {false};
    char line[4096];
    while (file && fgets(line, sizeof line, file))
        for (int i = 0; i < 4; ++i)
            if (!strncmp(line, says[i], strlen(says[i])) && !found[i]) {
                found[i] = true;
                assert_non_null(strstr(identity, line));
            }
    if (file)
        fclose(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_keys, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_kept_is_found, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_damage, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_limit, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_processes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_folders, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_foreign_objects, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_processor, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
