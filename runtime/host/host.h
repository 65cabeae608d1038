/* SPDX-License-Identifier: MIT
 *
 * host: command lines, other programs, tables, pictures. */
#ifndef HOST_HOST_H
#define HOST_HOST_H

#include "base/message.h"
#include "gic_runtime.h"

#include <stdio.h>

typedef struct Text Text; /* base/text.h */

/* ---- usage.c: errors in the command line */

/* Print `program: error: message 'word'` and where to find help; exit status 2. word may be NULL. */
_Noreturn void usage_fail(const char *program, const char *message, const char *word);

/* The whole number that a word is, from least to most; any other word ends in usage_fail. */
int64_t usage_whole(const char *program, const char *message, const char *word, int64_t least, int64_t most);

/* ---- terminal.c: messages of the library (gic.h) */

struct gicl_message;
/* The function of a program's listener: tables go to standard output, how far the work is to a terminal, all others to
 * standard error. */
/* The exit status at the end: `status`, or where what was printed could not be written, GICL_FAILED after a message. */
int terminal_close(const char *program, int status);
void terminal_hear(void *context, const struct gicl_message *message);

/* ---- options.c */

/* An option of a command line, which sets `on`, or has an argument: `text` becomes that, or `read` gets it with the
 * context. letter: its short form; 0: none. */
typedef struct Option {
    const char *name;
    char letter;
    bool *on;
    const char **text;
    void (*read)(void *context, char *word);
} Option;

typedef void UsageFail(const char *message, const char *word);

/* Read the options of a program, in any order among its operands; -h and --help print the texts of `help`, which NULL
 * ends (C11 promises 4095 characters of one literal), and --version the version, and end it; mistakes end it with exit
 * status 2, after the C library's message, or by `fail`, NULL: none. Returns where the operands begin in word[], which
 * is put in order. */
int options_read(const char *program, const char *const *help, int count, char **word, const Option *option,
                 int options, void *context, UsageFail *fail);

/* ---- process.c: other programs, and signals that ask to stop */

/* The place of messages without an input file: `gicsweep: error: ...`, with the name by which the program was called.
 */
Place program_place(void);

/* Between hold and release all signals of stop_signals() are blocked, so that temporary files can be removed and
 * results kept. Release unblocks them: one that has arrived ends the program there. */
void interrupt_hold(void);
bool interrupt_arrived(void);
/* What has arrived is done with, for work that people end by a signal. */
void interrupt_take(void);
void interrupt_release(void);

enum { PROCESS_NOT_STARTED = -1, PROCESS_INTERRUPTED = -2 };

/* Run argv[0], searched in PATH, with `input` as its standard input; call between hold and release. Returns the exit
 * status (128 + signal if a signal killed it) or one of the above; *said: its output, or why it did not start. */
int process_run(Pool *pool, char *const argv[], const char *input, const char **said);
/* The same with its standard output into an open file; *said: its messages. */
int process_run_into(Pool *pool, char *const argv[], const char *input, int output, const char **said);

/* A file without a name for the input or output of a child: unlike a pipe it never blocks; -1: none, errno says why.
 * And: its contents, zero-terminated. */
int nameless_file(Pool *pool);
const char *nameless_bytes(Pool *pool, int file, size_t *size);
const char *nameless_text(Pool *pool, int file);

/* $TMPDIR or /tmp. */
const char *temporary_folder(void);

/* plugin.c: the data of a name in a plug-in, lib/gicgen/NAME beside the folder of the running program, of the library
 * that we are in, or in it. NULL: it is not there or can't be loaded, *why. */
const void *plugin_load(Pool *pool, const char *name, const char *symbol, const char **why);

/* ---- csv.c */

typedef struct Unfinished Unfinished;

/* A results file that is being written: under a temporary name beside `path`, renamed when it is closed. */
typedef struct Csv {
    Pool *pool; /* for names */
    FILE *file;
    const char *path, *temporary; /* temporary: NULL for standard output, devices and pipes */
    bool inside;                  /* inside a row */
    Unfinished *unfinished;       /* NULL: standard output */
} Csv;

Csv csv_open(Pool *pool, const char *path);
/* `text` as a cell: in quotes if it has commas, quotes or line ends, which become blanks. */
const char *csv_quoted(Pool *pool, const char *text);
void csv_name(Csv *csv, const char *name, const char *unit); /* a cell `name [unit]`; unit may be NULL */
void csv_time(Csv *csv, double value);                       /* up to 15 digits: 0.28 */
void csv_number(Csv *csv, double value);                     /* reads back bit-exactly */
enum { CSV_DIGITS = 32 };                                    /* characters of a number as text */
const char *csv_digits(double value, char text[CSV_DIGITS]); /* the text of csv_number(), in `text` */
void csv_text(Csv *csv, const char *text);                   /* in quotes; NULL: an empty cell */
void csv_end_row(Csv *csv);
void csv_close(Csv *csv);   /* exits with a message if not all could be written */
void csv_abandon(Csv *csv); /* instead of csv_close: no results are left */

/* A table of numbers with named columns. */
typedef struct CsvTable {
    const Source *source;
    int columns, rows;
    const char **name, **unit; /* unit: in brackets after the name, NULL: none */
    size_t *at;                /* places of the names in the source */
    double *value;             /* [rows][columns] */
    size_t *line;              /* [rows] places of the lines in the source */
} CsvTable;

/* header: the first line that messages suggest; by: the file that names this one, NULL: the user does. If a file names
 * it and its first line has none of the columns, messages show nothing of it. */
const CsvTable *csv_read(Pool *pool, const char *path, const char *header, const Source *by);
Place csv_place(const CsvTable *table, int row);
Place csv_name_place(const CsvTable *table, int column);
/* End with a message if a column states another unit than the expected one. */
void csv_check_unit(Pool *pool, const CsvTable *table, int column, const char *unit);

/* ---- plot.c */

/* Curves over time, and panels of one signal over another; `sample` holds rows: time, values of `curves`, x and y of
 * each panel. */
typedef struct Plot {
    const char *title;
    int curves, panels, rows;
    const gic_signal *signal; /* [curves + 2 panels] the signals of a row, after the time */
    const char **shown;       /* [curves + 2 panels] the units of `sample`, */
    const double *factor;     /* and what numbers in the signals' units are multiplied by for these */
    double *sample;
    const CsvTable *other; /* results of another run, drawn in dots beside these where it has the signal; NULL: none */
    const char *other_name;
} Plot;

/* The column of a table of results that has a signal, -1: none. Fails if it states another unit. */
int plot_column(Pool *pool, const CsvTable *table, const gic_signal *signal);

/* Picture by gnuplot, SVG or PNG by the ending of `path`; curves of the same unit share a panel. */
void plot_write(Pool *pool, const Plot *plot, const char *path);
/* quantity.c: the quantity of a unit, "force"; "value" for an unknown unit. */
const char *unit_quantity(const char *unit);
/* "force [N]"; "no unit" for numbers without one */
const char *quantity_text(Pool *pool, const char *unit, const char *shown);
/* Exit with a message if gnuplot is missing; call before the run that the picture is of. */
void plot_check(Pool *pool);
/* For scripts of gnuplot: a text in quotes, with a blank between `]]` and a `>`. */
void plot_text(Text *text, const char *s);

enum { PLOT_NO_FILE = -3 /* beside the values of process_run */ };

/* Run a gnuplot script whose picture becomes the file `path`. Returns the value of process_run, PLOT_NO_FILE if the
 * file can't be made, 1 if it is incomplete or can't be renamed; *said: why. */
int gnuplot_run(Pool *pool, const char *script, const char *path, const char **said);
bool plot_known(const char *path); /* does `path` end in .svg or .png? */

#endif
