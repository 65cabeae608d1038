/* SPDX-License-Identifier: MIT
 * CSV: the text is cut in place, cells point into it. */
#include "table.h"

#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Cut one cell at *at: returns its terminated text and moves *at behind the separator, which goes to *separator. */
static char *cut(char **at, char *separator)
{
    char *s = *at, *out = s, *cell = s;
    bool quoted = false;
    for (; *s && (quoted || (*s != ',' && *s != '\n')); ++s) {
        if (*s == '"' && quoted && s[1] == '"')
            *out++ = *s++;
        else if (*s == '"')
            quoted = !quoted;
        else if (*s != '\r')
            *out++ = *s;
    }
    *separator = *s;
    *at = *s ? s + 1 : s;
    *out = 0;
    return cell;
}

static void drop_unit(char *name)
{
    char *bracket = strchr(name, '[');
    if (bracket)
        *bracket = 0;
    for (size_t size = strlen(name); size && name[size - 1] == ' ';)
        name[--size] = 0;
}

Table *table_read(const char *path)
{
    Table *table = grab(1, sizeof *table);
    table->path = path;
    table->buffer = slurp(path);
    char *at = table->buffer, separator;
    size_t room = 1, cells = 0;
    for (const char *s = at; *s; ++s)
        room += *s == ',' || *s == '\n';
    table->name = grab(room, sizeof *table->name);
    table->cell = grab(room, sizeof *table->cell);
    do {
        drop_unit(table->name[table->columns++] = cut(&at, &separator));
    } while (separator == ',');
    while (*at) {
        int width = 0;
        do {
            table->cell[cells++] = cut(&at, &separator);
            ++width;
        } while (separator == ',');
        ++table->rows;
        if (width != table->columns)
            fail("%s:%d: %d cells under a head row of %d", path, table->rows + 1, width, table->columns);
    }
    return table;
}

void table_free(Table *table)
{
    free(table->name);
    free(table->cell);
    free(table->buffer);
    free(table);
}

int table_find(const Table *table, const char *name)
{
    for (int i = 0; i < table->columns; ++i)
        if (!strcmp(table->name[i], name))
            return i;
    return -1;
}

int table_want(const Table *table, const char *name)
{
    int column = table_find(table, name);
    if (column < 0)
        fail("%s: column '%s' is missing", table->path, name);
    return column;
}

double table_number(const Table *table, int row, int column)
{
    const char *cell = table->cell[row * table->columns + column];
    char *end;
    double value = strtod(cell, &end);
    if (*end)
        fail("%s:%d: '%s' is not a number", table->path, row + 2, cell);
    return end == cell ? (double)NAN : value;
}
