/* SPDX-License-Identifier: MIT
 * The folder of results: one page, the same as text, a CSV file for each table and a picture for each chart. */
#include "base/file.h"
#include "base/message.h"
#include "bench/bench.h"
#include "host/host.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The title by which our own pages are recognized. */
static const char own_title[] = "<title>gicbench</title>";
/* The beginning of the table of contents; the link from a report in a folder within another report's folder. */
static const char contents[] = "<nav><ul>\n";
static const char back[] = "<li><a href=\"../index.html\">back to all results</a></li>\n";

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

void report_headline(Report *report, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    *POOL_PUSH(report->pool, report->headline, report->headlines) = print_list(report->pool, format, arguments);
    va_end(arguments);
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
        for (int k = 0; !i && k < report->headlines; ++k)
            text_print(out, "%s* %s\n", k ? "" : "\n", report->headline[k]);
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

/* Keep line breaks. */
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

/* Numbers and their units are not broken; words may be broken at blanks, file names at `_` and `.`. */
static bool is_words(const char *cell)
{
    return isalpha((unsigned char)cell[0]);
}

static void words(Text *out, const char *cell)
{
    for (size_t length; (length = strcspn(cell, "_.")), cell[length]; cell += length + 1) {
        escaped(out, pool_print(out->pool, "%.*s", (int)length, cell));
        text_print(out, cell[length] == '_' ? "_<wbr>" : "<wbr>.");
    }
    escaped(out, cell);
}

static void table_html(Text *out, const Sheet *table)
{
    text_print(out, "<div class=\"wide\"><table>\n");
    element(out, "caption", table->title);
    for (int i = 0; i < table->cells; ++i) {
        const char *const kind = i < table->columns ? "th" : "td";
        text_print(out, i % table->columns ? "" : "<tr>");
        text_print(out, is_words(table->cell[i]) ? "<%s class=\"text\">" : "<%s>", kind);
        (is_words(table->cell[i]) ? words : escaped)(out, table->cell[i]);
        text_print(out, "</%s>%s", kind, (i + 1) % table->columns ? "" : "</tr>\n");
    }
    text_print(out, "</table></div>\n<p><a href=\"%s.csv\">as CSV</a></p>\n", table->name);
    if (table->note)
        element(out, "p", table->note);
}

static const char style[] =
    "body {font: 15px/1.45 system-ui, sans-serif; color: #1f2933; max-width: 1200px; margin: 2em auto; padding: 0 "
    "1em}\n"
    "h2 {margin: 2em 0 .4em; border-bottom: 1px solid #aab4bd}\np {max-width: 62em}\n"
    ".headline {padding: .7em 1.2em .7em 2.2em; background: #eef4fa; border-left: 4px solid #0072b2; font-size: 16px}\n"
    "nav ul {columns: 3 16em; padding-left: 1.2em}\n.wide {overflow-x: auto}\n"
    "table {border-collapse: collapse; margin: 1em 0; font-size: 13px; font-variant-numeric: tabular-nums}\n"
    "caption {text-align: left; font-weight: bold; font-size: 15px}\n"
    "th, td {padding: .15em .45em; text-align: right; border-bottom: 1px solid #d5dce2; vertical-align: bottom}\n"
    "td {white-space: nowrap}\ntd.text {white-space: normal}\n"
    "th:first-child, td:first-child {text-align: left}\nimg {max-width: 100%; height: auto}\n";

/* True if the folder holds a report of ours. */
static bool is_report(Pool *pool, const char *folder)
{
    const char *index = pool_print(pool, "%s/index.html", folder);
    FILE *file = fopen(index, "r");
    if (!file)
        return false;
    fclose(file);
    size_t size;
    return strstr(file_read(pool, index, SIZE_MAX, &size), own_title) != NULL;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Names of folders within this one that hold a report, sorted. */
static const char **sub_reports(Pool *pool, const char *folder, int *names)
{
    const char **name = NULL;
    *names = 0;
    DIR *in = opendir(folder);
    for (struct dirent *entry; in && (entry = readdir(in));)
        if (entry->d_name[0] != '.' && is_report(pool, pool_print(pool, "%s/%s", folder, entry->d_name)))
            *POOL_PUSH(pool, name, *names) = pool_print(pool, "%s", entry->d_name);
    if (in)
        closedir(in);
    if (*names)
        qsort(name, (size_t)*names, sizeof *name, by_name);
    return name;
}

static void sub_pages(Text *out, const char *folder)
{
    Pool *pool = out->pool;
    int names;
    const char **name = sub_reports(pool, folder, &names);
    for (int i = 0; i < names; ++i) {
        text_print(out, "<li>page <a href=\"");
        escaped(out, name[i]);
        text_print(out, "/index.html\">");
        escaped(out, name[i]);
        text_print(out, "</a></li>\n");
    }
}

/* Results in one sentence each, and the table of contents. */
static void page_top(Text *out, const Report *report, const char *folder)
{
    for (int i = 0; i < report->headlines; ++i) {
        text_print(out, i ? "" : "<ul class=\"headline\">\n");
        element(out, "li", report->headline[i]);
        text_print(out, i + 1 < report->headlines ? "\n" : "\n</ul>\n");
    }
    text_print(out, "%s", contents);
    if (is_report(out->pool, pool_print(out->pool, "%s/..", folder)))
        text_print(out, "%s", back);
    for (int i = 1; i < report->pieces; ++i)
        if (report->piece[i].heading) {
            text_print(out, "<li><a href=\"#part%d\">", i);
            escaped(out, report->piece[i].heading);
            text_print(out, "</a></li>\n");
        }
    sub_pages(out, folder);
    text_print(out, "<li>all of this as <a href=\"bench.txt\">text</a></li>\n</ul></nav>\n");
}

static void page_html(Text *out, const Report *report, const char *folder)
{
    text_print(out,
               "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
               "<meta name=\"viewport\" content=\"width=device-width\">\n%s\n<style>\n%s</style>\n",
               own_title, style);
    for (int i = 0; i < report->pieces; ++i) {
        const Piece *piece = &report->piece[i];
        if (piece->heading) {
            text_print(out, i ? "<h2 id=\"part%d\">" : "<h1 id=\"part%d\">", i);
            escaped(out, piece->heading);
            text_print(out, i ? "</h2>" : "</h1>\n");
        }
        if (!i)
            page_top(out, report, folder);
        if (piece->text)
            element(out, "p", piece->text);
        if (piece->table)
            table_html(out, piece->table);
        if (piece->chart && piece->chart->count) {
            text_print(out, "<p><img src=\"%s.svg\" width=\"900\" height=\"560\" alt=\"", piece->chart->name);
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

/* Add a link back to the reports in folders within this one, if they were written before it. */
static void link_back(Pool *pool, const char *folder)
{
    int names;
    const char **name = sub_reports(pool, folder, &names);
    for (int i = 0; i < names; ++i) {
        const char *within = pool_print(pool, "%s/%s", folder, name[i]);
        size_t size;
        const char *page = file_read(pool, pool_print(pool, "%s/index.html", within), SIZE_MAX, &size);
        const char *at = strstr(page, contents);
        if (!at || strstr(page, back))
            continue;
        at += strlen(contents);
        Text text = {.pool = pool};
        text_add(&text, page, (size_t)(at - page));
        text_print(&text, "%s%s", back, at);
        write_file(pool, within, "index.html", &text);
    }
}

void report_tell(const Report *report)
{
    Text text = {.pool = report->pool};
    page_text(&text, report);
    diag_text(text.s);
}

/* Remove the files of an earlier report, which would seem part of this one. Files that its index does not name are not
 * ours. A folder without an index is not finished. */
static void remove_earlier(Pool *pool, const char *folder)
{
    static const char *const mark[] = {"<img src=\"", "<a href=\""};
    const char *index = pool_print(pool, "%s/index.html", folder);
    FILE *file = fopen(index, "r");
    if (file) {
        fclose(file);
        size_t size;
        const char *page = file_read(pool, index, SIZE_MAX, &size);
        for (int i = 0; i < 2 && strstr(page, own_title); ++i)
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
    page_html(&html, report, folder);
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
    link_back(pool, folder);
}
