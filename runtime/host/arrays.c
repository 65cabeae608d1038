/* SPDX-License-Identifier: MIT
 * NumPy's format .npy (numpy.lib.format, version 1.0), and MAT-files of level 4 (MathWorks, "MAT-File Format", chapter
 * 2): a header of 20 bytes before each matrix. Libraries for newer MAT-files write the date and bring HDF5. Numbers are
 * little-endian on every machine. */
#include "host/arrays.h"
#include "base/file.h"
#include "base/message.h"
#include "base/pool.h"
#include "base/text.h"
#include "host/archive.h"
#include "host/host.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>

static void add_whole(Text *out, uint64_t value, int bytes)
{
    char little[8];
    for (int i = 0; i < bytes; ++i)
        little[i] = (char)(unsigned char)(value >> 8 * i & 0xff);
    text_add(out, little, (size_t)bytes);
}

static void add_number(Text *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    add_whole(out, bits, 8);
}

/* The character at *s, of valid UTF-8; *s moves past it. */
static uint32_t next_character(const char **s)
{
    const unsigned char first = (unsigned char)*(*s)++;
    uint32_t character = first < 0x80   ? first
                         : first < 0xe0 ? first & 0x1fu
                         : first < 0xf0 ? first & 0x0fu
                                        : first & 7u;
    while (((unsigned char)**s & 0xc0) == 0x80)
        character = character << 6 | ((unsigned char)*(*s)++ & 0x3fu);
    return character;
}

/* The number of characters of the longest text. */
static int text_width(const NamedArray *array)
{
    int width = 0;
    for (int i = 0; i < array->rows; ++i) {
        int characters = 0;
        for (const char *s = array->text[i]; *s; ++characters)
            next_character(&s);
        width = characters > width ? characters : width;
    }
    return width;
}

static int array_rows(const NamedArray *array)
{
    return array->shape == ARRAY_SCALAR ? 1 : array->rows;
}

static int array_columns(const NamedArray *array)
{
    return array->shape == ARRAY_MATRIX ? array->columns : 1;
}

/* Characters of text number i, `width` of them: the rest is `fill`, and characters from `most` on become question
 * marks.
 */
static void add_characters(Text *out, const char *s, int width, uint32_t fill, uint32_t most, int bytes)
{
    for (int i = 0; i < width; ++i) {
        const uint32_t character = *s ? next_character(&s) : fill;
        add_whole(out, character < most ? character : '?', bytes);
    }
}

/* ---- NumPy ---------------------------------------------------------------------------------------------- */

static void npy_head(Pool *pool, Text *out, const NamedArray *array, const char *type)
{
    enum { ALIGNED = 64, BEFORE = 10 };
    const char *shape = array->shape == ARRAY_SCALAR   ? ""
                        : array->shape == ARRAY_VECTOR ? pool_print(pool, "%d,", array->rows)
                                                       : pool_print(pool, "%d, %d", array->rows, array->columns);
    Text head = {.pool = pool};
    text_print(&head, "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }", type, shape);
    while ((BEFORE + head.size + 1) % ALIGNED)
        text_print(&head, " ");
    text_print(&head, "\n");
    text_print(out, "\x93NUMPY\1");
    text_add(out, "", 1);
    add_whole(out, head.size, 2);
    text_add(out, head.s, head.size);
}

static const Text *npy(Pool *pool, const NamedArray *array)
{
    Text *out = pool_alloc(pool, sizeof *out);
    *out = (Text){.pool = pool};
    if (array->number) {
        npy_head(pool, out, array, "<f8");
        for (int i = 0; i < array_rows(array) * array_columns(array); ++i)
            add_number(out, array->number[i]);
        return out;
    }
    const int width = text_width(array) ? text_width(array) : 1;
    npy_head(pool, out, array, pool_print(pool, "<U%d", width));
    for (int i = 0; i < array->rows; ++i)
        add_characters(out, array->text[i], width, 0, UINT32_MAX, 4);
    return out;
}

void npz_write(Pool *pool, const char *path, const NamedArray *array, int count)
{
    Members members = {.pool = pool};
    size_t size;
    for (int i = 0; i < count; ++i) {
        const Text *bytes = npy(pool, &array[i]);
        member_add(&members, pool_print(pool, "%s.npy", array[i].name), bytes->s, bytes->size);
    }
    const char *bytes = archive_bytes(&members, &size);
    if (!bytes)
        diag_fail(program_place(), "set TMPDIR to a folder that can be written, with room",
                  "no archive for %s can be made in %s: %s", path, temporary_folder(), strerror(errno));
    file_write(path, bytes, size);
}

/* ---- MATLAB --------------------------------------------------------------------------------------------- */

static void mat_add(Text *out, const NamedArray *array)
{
    enum { DOUBLES = 0, CHARACTERS = 51 }; /* little-endian; numbers of 8 bytes, or text in bytes */
    const int rows = array_rows(array), columns = array->number ? array_columns(array) : text_width(array);
    const size_t name = strlen(array->name) + 1;
    add_whole(out, array->number ? DOUBLES : CHARACTERS, 4);
    add_whole(out, (uint64_t)rows, 4);
    add_whole(out, (uint64_t)columns, 4);
    add_whole(out, 0, 4); /* no imaginary part */
    add_whole(out, name, 4);
    text_add(out, array->name, name);
    if (array->number) {
        for (int j = 0; j < columns; ++j)
            for (int i = 0; i < rows; ++i)
                add_number(out, array->number[i * columns + j]);
        return;
    }
    Text lines = {.pool = out->pool};
    for (int i = 0; i < rows; ++i)
        add_characters(&lines, array->text[i], columns, ' ', 0x80, 1);
    for (int j = 0; j < columns; ++j)
        for (int i = 0; i < rows; ++i)
            text_add(out, &lines.s[i * columns + j], 1);
}

void mat_write(Pool *pool, const char *path, const NamedArray *array, int count)
{
    Text out = {.pool = pool};
    for (int i = 0; i < count; ++i)
        mat_add(&out, &array[i]);
    file_write(path, out.s, out.size);
}
