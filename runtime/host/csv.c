/* SPDX-License-Identifier: MIT
 * Tables as comma-separated text: results are written; states and roads are read. */
#define _DEFAULT_SOURCE /* on_exit */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "host/host.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- writing -------------------------------------------------------------------------------------------- */

/* A table that is being written by this process. */
struct Unfinished {
    FILE *file;
    pid_t process;
    bool kept;  /* this record, until the program ends */
    char *path; /* of its temporary file; NULL: none */
};

/* At exit of a program with an unfinished table, such as out of memory or an exit by a library: remove the temporary
 * file, and turn exit status 0 into a failure (the Fortran runtime exits with 0 if MUMPS gives up). */
static void remove_unfinished(int status, void *what)
{
    Unfinished *unfinished = what;
    const bool ours = unfinished->path && unfinished->process == getpid();
    if (ours && !unlink(unfinished->path) && status == 0) {
        fprintf(stderr, "%s: error: a library ended the program\n  remedy: is there memory enough?\n",
                program_place().source->path);
        _exit(1);
    }
    free(unfinished->path);
    free(unfinished);
}

/* What becomes of the file is settled. */
static void settle(Unfinished *unfinished)
{
    caught_disown(unfinished);
    free(unfinished->path);
    unfinished->path = NULL;
    if (!unfinished->kept)
        free(unfinished);
}

/* Where a failure ends a call and not the program. */
static void undo(void *what)
{
    const Unfinished *unfinished = what;
    fclose(unfinished->file);
    if (unfinished->path)
        unlink(unfinished->path);
    settle(what);
}

/* Allocate before the file is made. A program looks after it until its end, others until the end of the call. */
static Unfinished *watch(const char *path)
{
    enum { MORE = 32 }; /* of temporary_open() */
    Unfinished *unfinished = malloc(sizeof *unfinished);
    char *room = malloc(strlen(path) + MORE);
    if (!unfinished || !room) {
        free(unfinished);
        free(room);
        out_of_memory();
    }
    *unfinished = (Unfinished){.process = getpid()};
    unfinished->kept = (!catching() || caught_listener()) && !on_exit(remove_unfinished, unfinished);
    *room = 0;
    unfinished->path = room;
    return unfinished;
}

static _Noreturn void write_fail(const Csv *csv, const char *what)
{
    int reason = errno;
    if (csv->temporary)
        remove(csv->temporary);
    if (reason == EPIPE)
        interrupt_release(); /* the reader is gone: end as programs do then, without a message */
    diag_fail(program_place(), file_remedy(reason), "can't %s %s: %s", what,
              strcmp(csv->path, "-") ? csv->path : "to standard output", strerror(reason));
}

Csv csv_open(Pool *pool, const char *path)
{
    Csv csv = {.pool = pool, .file = stdout, .path = path};
    if (!strcmp(path, "-"))
        return csv;
    const bool special = file_is_special(path);
    struct stat is;
    if (!stat(path, &is) && S_ISDIR(is.st_mode))
        diag_fail(program_place(), "write a file's name behind it", "can't write %s: it is a folder", path);
    Unfinished *unfinished = watch(path);
    char *name = NULL;
    csv.file = special ? fopen(path, "w") : temporary_open(pool, path, &name);
    const int reason = errno;
    if (name && csv.file) {
        strcpy(unfinished->path, name);
        csv.temporary = name;
    } else {
        free(unfinished->path);
        unfinished->path = NULL;
    }
    if (!csv.file) {
        settle(unfinished);
        errno = reason;
        write_fail(&(Csv){.path = path}, special ? "open" : "create");
    }
    unfinished->file = csv.file;
    csv.unfinished = unfinished;
    caught_own(undo, unfinished);
    return csv;
}

const char *csv_quoted(Pool *pool, const char *text)
{
    Text out = {.pool = pool};
    const char *c = text;
    while ((unsigned char)*c >= ' ' && *c != ',' && *c != '"')
        ++c;
    if (!*c)
        return text;
    text_print(&out, "\"");
    for (; *text; ++text)
        text_print(&out, *text == '"' ? "\"\"" : "%c", (unsigned char)*text < ' ' ? ' ' : *text);
    text_print(&out, "\"");
    return out.s;
}

static void cell(Csv *csv)
{
    if (csv->inside)
        fputc(',', csv->file);
    csv->inside = true;
}

void csv_name(Csv *csv, const char *name, const char *unit)
{
    cell(csv);
    fputs(csv_quoted(csv->pool, unit ? pool_print(csv->pool, "%s [%s]", name, unit) : name), csv->file);
}

void csv_time(Csv *csv, double value)
{
    cell(csv);
    fprintf(csv->file, "%.15g", value);
}

const char *csv_digits(double value, char text[CSV_DIGITS])
{
    snprintf(text, CSV_DIGITS, "%.15g", value); /* 0.1, not 0.10000000000000001 */
    if (strtod(text, NULL) != value)
        snprintf(text, CSV_DIGITS, "%.17g", value);
    return text;
}

void csv_number(Csv *csv, double value)
{
    char text[CSV_DIGITS];
    cell(csv);
    fputs(csv_digits(value, text), csv->file);
}

void csv_text(Csv *csv, const char *text)
{
    cell(csv);
    if (!text)
        return;
    fputc('"', csv->file);
    for (; *text; ++text) {
        if (*text == '"')
            fputc('"', csv->file);
        fputc(*text, csv->file);
    }
    fputc('"', csv->file);
}

void csv_end_row(Csv *csv)
{
    fputc('\n', csv->file);
    csv->inside = false;
}

void csv_close(Csv *csv)
{
    bool written = !fflush(csv->file) && !ferror(csv->file);
    if (csv->unfinished)
        settle(csv->unfinished);
    if (!csv->temporary) {
        if ((csv->file != stdout && fclose(csv->file)) || !written)
            write_fail(csv, "write");
        return;
    }
    if (fclose(csv->file) || !written || rename(csv->temporary, csv->path))
        write_fail(csv, "write");
}

void csv_abandon(Csv *csv)
{
    if (csv->unfinished)
        settle(csv->unfinished);
    if (csv->file != stdout)
        fclose(csv->file);
    if (csv->temporary)
        remove(csv->temporary);
}

/* ---- reading -------------------------------------------------------------------------------------------- */

enum { COLUMNS_MOST = 10000 };

/* The text of a cell between separators, without blanks around it. */
typedef struct Cell {
    const char *from, *to;
} Cell;

static Place cell_place(const Source *source, const Cell *c)
{
    return diag_place(source, (size_t)(c->from - source->bytes));
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Read the cell at *s; *s moves past its separator. False after the last cell of the line. */
static bool next_cell(const char **s, const char *end, Cell *c)
{
    if (*s > end)
        return false;
    const char *stop = *s;
    for (bool inside = false; stop < end && (inside || *stop != ','); ++stop)
        inside ^= *stop == '"';
    *c = (Cell){*s, stop};
    while (c->from < c->to && is_blank(*c->from))
        ++c->from;
    while (c->to > c->from && is_blank(c->to[-1]))
        --c->to;
    *s = stop + 1;
    return true;
}

static char *cell_text(Pool *pool, const Cell *c)
{
    return pool_print(pool, "%.*s", (int)(c->to - c->from), c->from);
}

static double cell_number(Pool *pool, const Source *source, const Cell *c, const char *column)
{
    char *text = cell_text(pool, c), *stop;
    double value = strtod(text, &stop);
    const char *remedy = "write a decimal number such as 1.5 or -2e-3";
    if (stop == text || *stop || text[strspn(text, "0123456789+-.eE")])
        diag_fail(cell_place(source, c), remedy, "%s must be a number, not '%.40s'", column, text);
    if (!isfinite(value))
        diag_fail(cell_place(source, c), remedy, "%s: %.40s is too large", column, text);
    return value;
}

/* Refuse a header with another separator, or without one, before its numbers are read. */
static void check_header(Pool *pool, const CsvTable *table, const Cell *c, const char *name, const char *header)
{
    const char *other = strpbrk(name, ";\t");
    char *stop;
    if (other)
        diag_fail(cell_place(table->source, c), "separate columns by commas, and write the decimal point as a point",
                  *other == ';' ? "columns are separated by semicolons" : "columns are separated by tabs");
    (void)strtod(name, &stop);
    if (!*stop)
        diag_fail(cell_place(table->source, c), pool_print(pool, "the first line names the columns: %s", header),
                  "'%s' is no name of a column", name);
}

/* The text of a cell without the quotes around it; quotes in it are doubled, as csv_quoted() writes them. */
static char *unquoted(Pool *pool, const Cell *c)
{
    char *text = cell_text(pool, c);
    const size_t length = strlen(text);
    if (length < 2 || *text != '"' || text[length - 1] != '"')
        return text;
    char *to = text;
    for (const char *from = text + 1, *stop = text + length - 1; from < stop; ++from) {
        from += *from == '"' && from + 1 < stop && from[1] == '"';
        *to++ = *from;
    }
    *to = '\0';
    return text;
}

/* The bracket that opens the unit at the end of a column's text; NULL: no unit. A unit may have brackets itself, so it
 * is the first one after a blank, as csv_name() writes it; other programs may leave the blank out. */
static char *unit_bracket(char *text)
{
    const size_t length = strlen(text);
    if (!length || text[length - 1] != ']')
        return NULL;
    char *bracket = strstr(text, " [");
    return bracket ? bracket + 1 : strrchr(text, '[');
}

/* Name of a column without quotes; *unit: the unit in brackets after it, NULL: none. */
static const char *column_name(Pool *pool, const Source *source, Cell c, const char *header, const char **unit)
{
    char *text = unquoted(pool, &c), *bracket = unit_bracket(text);
    *unit = NULL;
    if (bracket && bracket > text) {
        bracket[strlen(bracket) - 1] = '\0';
        *unit = bracket + 1;
        *bracket = '\0';
    }
    for (char *end = text + strlen(text); end > text && is_blank(end[-1]);)
        *--end = '\0';
    if (!*text)
        diag_fail(cell_place(source, &c), pool_print(pool, "the first line names the columns: %s", header),
                  "a column without a name");
    return text;
}

static void read_header(Pool *pool, CsvTable *table, const char *header, const char *s, const char *end)
{
    int places = 0, units = 0;
    for (Cell c; next_cell(&s, end, &c);) {
        const char *unit, *name = column_name(pool, table->source, c, header, &unit);
        check_header(pool, table, &c, name, header);
        if (table->columns == COLUMNS_MOST)
            diag_fail(cell_place(table->source, &c), "remove some of them", "more than %d columns", COLUMNS_MOST);
        for (int i = 0; i < table->columns; ++i)
            if (!strcmp(table->name[i], name))
                diag_fail(cell_place(table->source, &c), "remove one of them", "column '%s' is here twice", name);
        *POOL_PUSH(pool, table->name, table->columns) = name;
        *POOL_PUSH(pool, table->unit, units) = unit;
        *POOL_PUSH(pool, table->at, places) = (size_t)(c.from - table->source->bytes);
    }
}

static void read_row(Pool *pool, CsvTable *table, int *values, const char *s, const char *end)
{
    const Source *source = table->source;
    Cell c = {s, s};
    int column = 0;
    *POOL_PUSH(pool, table->line, table->rows) = (size_t)(s - source->bytes);
    while (next_cell(&s, end, &c)) {
        if (column == table->columns)
            diag_fail(cell_place(source, &c), "one cell a column; the decimal point is a point",
                      "the row has more than the header's %d cells", table->columns);
        *POOL_PUSH(pool, table->value, *values) = cell_number(pool, source, &c, table->name[column++]);
    }
    if (column < table->columns)
        diag_fail(cell_place(source, &c), "one cell a column, separated by commas",
                  "the row has %d cells, the header has %d", column, table->columns);
}

/* True if a line contains one of the column names of `header`. */
static bool names_any(Pool *pool, const char *s, const char *end, const char *header)
{
    static const char between[] = " ,;\t\r\"[]";
    char *rest;
    for (char *word = strtok_r(pool_print(pool, "%.*s", (int)(end - s), s), between, &rest); word;
         word = strtok_r(NULL, between, &rest)) {
        const size_t length = strlen(word);
        for (const char *at = header; (at = strstr(at, word)); ++at)
            if ((at == header || strchr(between, at[-1])) && (!at[length] || strchr(between, at[length])))
                return true;
    }
    return false;
}

/* Read the line with the names of the columns. If another file names this one and it has no such line, the message
 * shows nothing of it. */
static void begin_table(Pool *pool, CsvTable *table, Source *source, bool named, const char *header, const char *s,
                        const char *end)
{
    source->hidden = named && !names_any(pool, s, end, header);
    if (source->hidden)
        diag_fail(diag_place(source, (size_t)(s - source->bytes)),
                  pool_print(pool, "is it the file that was meant? The first line names the columns: %s", header),
                  "this line names no column of such a table");
    const char *nought = memchr(source->bytes, 0, source->size);
    if (nought)
        diag_fail(diag_place(source, (size_t)(nought - source->bytes)), "save the table as plain text (UTF-8)",
                  "a NUL byte: this is no text");
    read_header(pool, table, header, s, end);
}

const CsvTable *csv_read(Pool *pool, const char *path, const char *header, const Source *by)
{
    Source *source = source_read(pool, path, TABLE_MOST, by);
    if (source->size >= 3 && !memcmp(source->bytes, "\xef\xbb\xbf", 3)) { /* byte order mark */
        source->bytes += 3;
        source->size -= 3;
    }
    CsvTable *table = pool_alloc(pool, sizeof *table);
    table->source = source;
    int values = 0;
    for (const char *s = source->bytes, *stop = s + source->size, *end; s < stop; s = end + 1) {
        end = memchr(s, '\n', (size_t)(stop - s));
        if (!end)
            end = stop;
        const char *first = s;
        while (first < end && is_blank(*first))
            ++first;
        if (first == end || *first == '#')
            continue;
        if (!table->columns)
            begin_table(pool, table, source, by, header, s, end);
        else
            read_row(pool, table, &values, s, end);
    }
    if (!table->columns)
        diag_fail((Place){source, 0, 0}, pool_print(pool, "the first line names the columns: %s", header),
                  "the file is empty");
    return table;
}

Place csv_place(const CsvTable *table, int row)
{
    return diag_place(table->source, table->line[row]);
}

Place csv_name_place(const CsvTable *table, int column)
{
    return diag_place(table->source, table->at[column]);
}

/* The next character of a unit, blanks and signs of products skipped: "N m" equals "N*m". */
static char unit_character(const char **s)
{
    *s += strspn(*s, " *");
    return **s ? *(*s)++ : '\0';
}

static bool same_unit(const char *a, const char *b)
{
    for (;;) {
        const char c = unit_character(&a), d = unit_character(&b);
        if (c != d)
            return false;
        if (!c)
            return true;
    }
}

void csv_check_unit(Pool *pool, const CsvTable *table, int column, const char *unit)
{
    const char *given = table->unit[column];
    const bool none = !strcmp(unit, "1") && given && (!*given || !strcmp(given, "-"));
    if (given && !none && !same_unit(given, unit))
        diag_fail(csv_name_place(table, column),
                  pool_print(pool, "convert the numbers, and write [%s] or no unit", unit),
                  "column '%s' is in %s, and its numbers would be taken for %s", table->name[column], given, unit);
}
