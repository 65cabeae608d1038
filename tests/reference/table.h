/* SPDX-License-Identifier: MIT
 * A CSV file with a head row. */
#ifndef REFERENCE_TABLE_H
#define REFERENCE_TABLE_H

typedef struct Table {
    const char *path;
    int columns, rows;
    char **name;  /* [columns], without a unit in brackets */
    char **cell;  /* [rows * columns] */
    char *buffer; /* what name and cell point into */
} Table;

/* Read a file ("-": standard input). Cells may stand in quotes. Rows of another width than the head row's fail. */
Table *table_read(const char *path);
void table_free(Table *table);
/* Index of a column, or -1. */
int table_find(const Table *table, const char *name);
/* The same, but a missing column fails. */
int table_want(const Table *table, const char *name);
/* A cell as a number; an empty one is NaN, any other text fails. */
double table_number(const Table *table, int row, int column);

#endif
