/* SPDX-License-Identifier: MIT
 * Memory, text, random numbers, small vectors, whole files. */
#include "gicgen.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 1 << 16, ALIGN = 16 };

typedef struct Chunk {
    struct Chunk *next;
    size_t used, room;
} Chunk;

struct Pool {
    Chunk *chunk;
};

_Noreturn void out_of_memory(void)
{
    fputs("gicgen: error: out of memory\n", stderr);
    exit(1);
}

Pool *pool_new(void)
{
    Pool *pool = calloc(1, sizeof *pool);
    if (!pool)
        out_of_memory();
    return pool;
}

void pool_free(Pool *pool)
{
    for (Chunk *chunk = pool->chunk; chunk;) {
        Chunk *next = chunk->next;
        free(chunk);
        chunk = next;
    }
    free(pool);
}

void *pool_alloc(Pool *pool, size_t size)
{
    const size_t head = (sizeof(Chunk) + ALIGN - 1) / ALIGN * ALIGN;
    if (size > SIZE_MAX / 2)
        out_of_memory();
    size = (size + ALIGN - 1) / ALIGN * ALIGN;
    Chunk *chunk = pool->chunk;
    if (!chunk || chunk->room - chunk->used < size) {
        size_t room = size > CHUNK ? size : CHUNK;
        chunk = calloc(1, head + room);
        if (!chunk)
            out_of_memory();
        chunk->room = room;
        /* a block of its own goes behind the chunk in use, whose rest stays usable */
        if (size > CHUNK && pool->chunk) {
            chunk->next = pool->chunk->next;
            pool->chunk->next = chunk;
        } else {
            chunk->next = pool->chunk;
            pool->chunk = chunk;
        }
    }
    void *block = (char *)chunk + head + chunk->used;
    chunk->used += size;
    return block;
}

void *pool_grow(Pool *pool, void *old, size_t old_size, size_t size)
{
    void *block = pool_alloc(pool, size);
    if (old_size)
        memcpy(block, old, old_size);
    return block;
}

char *pool_vprint(Pool *pool, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    int size = vsnprintf(NULL, 0, format, args);
    char *s = pool_alloc(pool, (size_t)size + 1);
    vsnprintf(s, (size_t)size + 1, format, again);
    va_end(again);
    return s;
}

char *pool_print(Pool *pool, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *s = pool_vprint(pool, format, args);
    va_end(args);
    return s;
}

static void text_reserve(Text *text, size_t more)
{
    if (text->size + more + 1 <= text->room)
        return;
    size_t room = text->room ? text->room : 256;
    while (room < text->size + more + 1)
        room *= 2;
    text->s = pool_grow(text->pool, text->s, text->size, room);
    text->room = room;
}

void text_add(Text *text, const char *s, size_t size)
{
    text_reserve(text, size);
    memcpy(text->s + text->size, s, size);
    text->size += size;
    text->s[text->size] = 0;
}

void text_html(Text *text, const char *s)
{
    for (; *s; ++s)
        switch (*s) {
        case '&': text_print(text, "&amp;"); break;
        case '<': text_print(text, "&lt;"); break;
        case '>': text_print(text, "&gt;"); break;
        case '"': text_print(text, "&quot;"); break;
        default: text_add(text, s, 1);
        }
}

uint64_t text_hash(const char *s, size_t size)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; ++i)
        hash = (hash ^ (unsigned char)s[i]) * 0x100000001b3u;
    return hash;
}

void text_print(Text *text, const char *format, ...)
{
    text_reserve(text, 120); /* most prints fit at once */
    for (bool again = false;; again = true) {
        va_list args;
        va_start(args, format);
        size_t size = (size_t)vsnprintf(text->s + text->size, text->room - text->size, format, args);
        va_end(args);
        if (again || text->size + size < text->room) {
            text->size += size;
            return;
        }
        text_reserve(text, size);
    }
}

uint64_t random_bits(Random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double random_uniform(Random *random, double low, double high)
{
    return low + (high - low) * ((double)(random_bits(random) >> 11) * 0x1p-53);
}

double vec_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void vec_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

double vec_norm(const double a[3])
{
    return sqrt(vec_dot(a, a));
}

void mat_from_euler(const double p[4], double A[9])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            A[3 * i + j] = 2 * p[1 + i] * p[1 + j] + (i == j ? 2 * p[0] * p[0] - 1 : 0);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        A[3 * j + k] -= 2 * p[0] * p[1 + i];
        A[3 * k + j] += 2 * p[0] * p[1 + i];
    }
}

void euler_relative(const double p0[4], const double p[4], double out[4])
{
    double cross[3];
    vec_cross(p0 + 1, p + 1, cross);
    out[0] = p0[0] * p[0] + vec_dot(p0 + 1, p + 1);
    for (int i = 0; i < 3; ++i)
        out[1 + i] = p0[0] * p[1 + i] - p[0] * p0[1 + i] - cross[i];
}

void mat_apply(const double A[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = vec_dot(A + 3 * i, x);
}

void mat_apply_transposed(const double A[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = A[i] * x[0] + A[3 + i] * x[1] + A[6 + i] * x[2];
}

const char *file_remedy(int reason)
{
    switch (reason) {
    case EACCES:
    case EPERM: return "`ls -ld` on it and its folder shows who may: get the right (chmod, chown), or name another place";
    case ENOENT: return "check the path; folders on the way to a file must exist";
    case ENOTDIR: return "check the path: one of the folders on the way is a file";
    case EISDIR: return "that is a folder: name a file in it";
    case EROFS: return "that file system is read-only: name another place";
    case ENOSPC:
    case EDQUOT: return "make room on the disk, or name another place";
    default: return "name another place";
    }
}

static _Noreturn void file_fail(const char *path, const char *what)
{
    fprintf(stderr, "%s: error: %s: %s\n  remedy: %s\n", path, what, strerror(errno), file_remedy(errno));
    exit(1);
}

bool file_is_special(const char *path)
{
    struct stat is;
    return !stat(path, &is) && !S_ISREG(is.st_mode) && !S_ISDIR(is.st_mode);
}

bool path_ends(const char *path, const char *end)
{
    const size_t n = strlen(path), m = strlen(end);
    return n > m && !strcmp(path + n - m, end);
}

/* A file on its way to its place. While there is one, signals that would leave it behind wait; a signal for a write
 * that fails would come before the message. */
typedef struct Moving {
    const char *path;
    char *name;                 /* NULL: none yet, or renamed */
    const struct Moving *other; /* that belongs to it; NULL: none */
} Moving;

/* End with a message about a file that can't be written, without temporary ones. */
static _Noreturn void write_fail(const Moving *moving, const char *what)
{
    const int reason = errno;
    if (moving->name)
        remove(moving->name);
    if (moving->other && moving->other->name)
        remove(moving->other->name);
    errno = reason;
    file_fail(moving->path, what);
}

static void temporary_write(Pool *pool, Moving *moving, const char *bytes, size_t size)
{
    char *name;
    FILE *file = temporary_open(pool, moving->path, &name);
    if (!file)
        write_fail(moving, "can't create");
    moving->name = name;
    const bool written = fwrite(bytes, 1, size, file) == size;
    if (fclose(file) || !written)
        write_fail(moving, "can't write");
}

static void temporary_move(Moving *moving)
{
    if (rename(moving->name, moving->path))
        write_fail(moving, "can't write");
    moving->name = NULL;
}

/* Write a file, and where other_path is not NULL another one, and rename what is whole. */
static void move_in(Moving *first, const char *bytes, size_t size, const char *other_path, const Text *other)
{
    Pool *pool = pool_new(); /* before there is anything to leave behind */
    Moving second = {.path = other_path, .other = first};
    const sigset_t stop = stop_signals();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &stop, &before);
    temporary_write(pool, first, bytes, size);
    if (other_path)
        temporary_write(pool, &second, other->s, other->size);
    first->other = &second;
    temporary_move(first);
    if (other_path)
        temporary_move(&second);
    pool_free(pool);
    sigprocmask(SIG_SETMASK, &before, NULL);
}

void file_check(const char *path)
{
    struct stat is;
    if (!strcmp(path, "-"))
        return;
    if (file_is_special(path)) {
        if (access(path, W_OK))
            file_fail(path, "can't open");
        return;
    }
    if (!stat(path, &is) && S_ISDIR(is.st_mode)) {
        errno = EISDIR;
        file_fail(path, "can't create");
    }
    Pool *pool = pool_new();
    Moving moving = {.path = path};
    const sigset_t stop = stop_signals();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &stop, &before);
    temporary_write(pool, &moving, "", 0);
    remove(moving.name);
    sigprocmask(SIG_SETMASK, &before, NULL);
    pool_free(pool);
}

void file_write(const char *path, const char *bytes, size_t size)
{
    if (!strcmp(path, "-")) {
        if (fwrite(bytes, 1, size, stdout) != size || fflush(stdout))
            file_fail("standard output", "can't write");
        return;
    }
    if (file_is_special(path)) {
        FILE *device = fopen(path, "wb");
        if (!device)
            file_fail(path, "can't open");
        const bool all = fwrite(bytes, 1, size, device) == size;
        if (fclose(device) || !all)
            file_fail(path, "can't write");
        return;
    }
    move_in(&(Moving){.path = path}, bytes, size, NULL, NULL);
}

void file_write_both(const char *path, const Text *text, const char *other_path, const Text *other)
{
    if (file_is_special(path) || file_is_special(other_path)) {
        file_write(path, text->s, text->size);
        file_write(other_path, other->s, other->size);
        return;
    }
    move_in(&(Moving){.path = path}, text->s, text->size, other_path, other);
}

char *file_read(Pool *pool, const char *path, size_t most, size_t *size)
{
    bool standard = !strcmp(path, "-");
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (!file)
        file_fail(path, "can't open");
    Text text = {.pool = pool};
    char buffer[1 << 14];
    for (size_t n; text.size <= most && (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
        text_add(&text, buffer, n);
    if (ferror(file))
        file_fail(path, "can't read");
    if (text.size > most) {
        fprintf(stderr,
                "%s: error: larger than the %zu MB that are read of such a file\n"
                "  remedy: is it the file that was meant?\n",
                path, most >> 20);
        exit(1);
    }
    if (!standard)
        fclose(file);
    text_add(&text, "", 0);
    *size = text.size;
    return text.s;
}
