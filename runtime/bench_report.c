/* SPDX-License-Identifier: MIT
 * The folder of results: one page, the same as text, a CSV file a table and a picture a chart. */
#include "bench.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *print_list(Pool *pool, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int size = vsnprintf(NULL, 0, format, again);
    va_end(again);
    char *text = pool_alloc(pool, (size_t)size + 1);
    vsnprintf(text, (size_t)size + 1, format, arguments);
    return text;
}

static Piece *piece_new(Report *report)
{
    Piece *piece = POOL_PUSH(report->pool, report->piece, report->pieces);
    *piece = (Piece){NULL, NULL, NULL, NULL};
    return piece;
}

void report_heading(Report *report, const char *text)
{
    piece_new(report)->heading = text;
}

void report_text(Report *report, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    piece_new(report)->text = print_list(report->pool, format, arguments);
    va_end(arguments);
}

Sheet *report_table(Report *report, const char *name, const char *title, const char *columns)
{
    Sheet *table = pool_alloc(report->pool, sizeof *table);
    *table = (Sheet){.name = name, .title = title};
    for (const char *from = columns; from;) {
        const char *bar = strchr(from, '|');
        table_cell(report->pool, table, "%.*s", bar ? (int)(bar - from) : (int)strlen(from), from);
        ++table->columns;
        from = bar ? bar + 1 : NULL;
    }
    piece_new(report)->table = table;
    return table;
}

void table_cell(Pool *pool, Sheet *table, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    *POOL_PUSH(pool, table->cell, table->cells) = print_list(pool, format, arguments);
    va_end(arguments);
}

void spread_cells(Pool *pool, Sheet *table, Spread spread, double scale)
{
    table_cell(pool, table, "%.4g", scale * spread.median);
    table_cell(pool, table, "%.4g", scale * spread.low);
    table_cell(pool, table, "%.4g", scale * spread.high);
}

Chart *report_chart(Report *report, const char *name, const char *title, const char *x, const char *y)
{
    Chart *chart = pool_alloc(report->pool, sizeof *chart);
    *chart = (Chart){.name = name, .title = title, .x = x, .y = y};
    piece_new(report)->chart = chart;
    return chart;
}

/* ---- text ------------------------------------------------------------------------------------------------- */

static void table_text(Text *out, const Sheet *table)
{
    text_print(out, "%s\n\n", table->title);
    for (int i = 0; i < table->cells; ++i) {
        const int column = i % table->columns;
        size_t width = 0;
        for (int k = column; k < table->cells; k += table->columns)
            width = width > strlen(table->cell[k]) ? width : strlen(table->cell[k]);
        text_print(out, column ? "  %*s" : "%-*s", (int)width, table->cell[i]);
        if (column == table->columns - 1)
            text_print(out, "\n");
    }
    if (table->note)
        text_print(out, "\n%s\n", table->note);
}

static void page_text(Text *out, const Report *report)
{
    for (int i = 0; i < report->pieces; ++i) {
        const Piece *piece = &report->piece[i];
        text_print(out, i ? "\n" : "");
        if (piece->heading)
            text_print(out, "== %s\n", piece->heading);
        if (piece->text)
            text_print(out, "%s\n", piece->text);
        if (piece->table)
            table_text(out, piece->table);
        if (piece->chart && piece->chart->count)
            text_print(out, "%s: see %s.svg\n", piece->chart->title, piece->chart->name);
    }
}

static void table_csv(Text *out, const Sheet *table)
{
    for (int i = 0; i < table->cells; ++i)
        text_print(out, "%s%s", csv_quoted(out->pool, table->cell[i]), (i + 1) % table->columns ? "," : "\n");
}

/* ---- HTML ------------------------------------------------------------------------------------------------- */

/* Lines stay lines. */
static void escaped(Text *out, const char *s)
{
    for (const char *end; (end = strchr(s, '\n')); s = end + 1) {
        text_html(out, pool_print(out->pool, "%.*s", (int)(end - s), s));
        text_print(out, "<br>\n");
    }
    text_html(out, s);
}

static void element(Text *out, const char *name, const char *content)
{
    text_print(out, "<%s>", name);
    escaped(out, content);
    text_print(out, "</%s>", name);
}

static void table_html(Text *out, const Sheet *table)
{
    text_print(out, "<table>\n");
    element(out, "caption", table->title);
    for (int i = 0; i < table->cells; ++i) {
        text_print(out, i % table->columns ? "" : "<tr>");
        element(out, i < table->columns ? "th" : "td", table->cell[i]);
        text_print(out, (i + 1) % table->columns ? "" : "</tr>\n");
    }
    text_print(out, "</table>\n<p><a href=\"%s.csv\">as CSV</a></p>\n", table->name);
    if (table->note)
        element(out, "p", table->note);
}

static void page_html(Text *out, const Report *report)
{
    text_print(out,
               "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>gicbench</title>\n<style>\n"
               "body {font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; line-height: 1.4}\n"
               "table {border-collapse: collapse; margin: 1em 0}\ncaption {text-align: left; font-weight: bold}\n"
               "th, td {padding: 0.1em 0.6em; text-align: right; border-bottom: 1px solid #ccc}\n"
               "th:first-child, td:first-child {text-align: left}\nimg {max-width: 100%%}\n</style>\n");
    for (int i = 0; i < report->pieces; ++i) {
        const Piece *piece = &report->piece[i];
        if (piece->heading)
            element(out, i ? "h2" : "h1", piece->heading);
        if (piece->text)
            element(out, "p", piece->text);
        if (piece->table)
            table_html(out, piece->table);
        if (piece->chart && piece->chart->count) {
            text_print(out, "<p><img src=\"%s.svg\" alt=\"", piece->chart->name);
            escaped(out, piece->chart->title);
            text_print(out, "\"></p>");
            if (piece->chart->note)
                element(out, "p", piece->chart->note);
        }
        text_print(out, "\n");
    }
    text_print(out, "</html>\n");
}

/* ---- files -------------------------------------------------------------------------------------------------- */

static void write_file(Pool *pool, const char *folder, const char *name, const Text *text)
{
    const char *path = pool_print(pool, "%s/%s", folder, name);
    char *temporary;
    interrupt_hold();
    FILE *file = temporary_open(pool, path, &temporary);
    bool good = file && fwrite(text->s, 1, text->size, file) == text->size;
    good = file && !fclose(file) && good;
    good = good && !rename(temporary, path);
    const int error = errno;
    if (file && !good)
        unlink(temporary);
    interrupt_release();
    if (good)
        return;
    diag_fail(program_place(), file_remedy(error), "can't write %s: %s", path, strerror(error));
}

void report_tell(const Report *report, FILE *file)
{
    Text text = {.pool = report->pool};
    page_text(&text, report);
    fwrite(text.s, 1, text.size, file);
}

/* What an earlier report left: it would pass for part of this one. Files that our index doesn't show are not ours.
 * Without an index a folder is not finished. */
static void remove_earlier(Pool *pool, const char *folder)
{
    static const char title[] = "<title>gicbench</title>", *const mark[] = {"<img src=\"", "<a href=\""};
    const char *index = pool_print(pool, "%s/index.html", folder);
    FILE *file = fopen(index, "r");
    if (file) {
        fclose(file);
        size_t size;
        const char *page = file_read(pool, index, SIZE_MAX, &size);
        for (int i = 0; i < 2 && strstr(page, title); ++i)
            for (const char *at = page; (at = strstr(at, mark[i]));) {
                at += strlen(mark[i]);
                const int length = (int)strspn(at, "abcdefghijklmnopqrstuvwxyz0123456789_.");
                const char *name = pool_print(pool, "%.*s", length, at);
                if (at[length] == '"' && (path_ends(name, ".csv") || path_ends(name, ".svg")))
                    unlink(pool_print(pool, "%s/%s", folder, name));
            }
    }
    unlink(index);
    unlink(pool_print(pool, "%s/bench.txt", folder));
}

void report_write(const Report *report, const char *folder)
{
    Pool *pool = report->pool;
    Text text = {.pool = pool}, html = {.pool = pool};
    page_text(&text, report);
    page_html(&html, report);
    remove_earlier(pool, folder);
    for (int i = 0; i < report->pieces; ++i) {
        const Piece *piece = &report->piece[i];
        Text csv = {.pool = pool};
        if (piece->table) {
            table_csv(&csv, piece->table);
            write_file(pool, folder, pool_print(pool, "%s.csv", piece->table->name), &csv);
        }
        if (piece->chart && piece->chart->count)
            chart_write(pool, piece->chart, pool_print(pool, "%s/%s.svg", folder, piece->chart->name));
    }
    write_file(pool, folder, "bench.txt", &text);
    write_file(pool, folder, "index.html", &html);
}
