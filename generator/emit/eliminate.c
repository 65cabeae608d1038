/* SPDX-License-Identifier: MIT
 * The linear systems of implicit steps as straight-line code. Which entries of the matrix 1 - reach A are not 0 is
 * known here, and so is what elimination fills in; its order is chosen for that: corners of a vehicle come first, what
 * connects them last. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/columns.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Entries of the factors, by places in the order. */
typedef struct Elimination {
    int n;
    int *unknown, *position; /* [n] by places in the order; see emit_private.h */
    bool *entry;             /* [n][n] with what is filled in */
    int *slot;               /* [n][n] their places in f[] */
    const bool *pattern;     /* [states][states] */
    const int *mass;     /* [states][states] places of the entries of the mass matrix in J[], 0: none; see columns.h */
    const bool *weighed; /* [states] rows that this matrix has */
    int states;
} Elimination;

/* Is the entry of two unknowns anything but 0 before elimination? */
static bool is_entry(const Elimination *z, int row, int column)
{
    const bool *follows = z->pattern + z->states * z->unknown[row];
    return row == column || follows[z->unknown[column]] || (z->position[column] >= 0 && follows[z->position[column]]) ||
           z->mass[z->states * z->unknown[row] + z->unknown[column]];
}

/* The unknown, of those that are left, that fills in the least: by the product of entries that its row and column have
 * beside it. */
static int cheapest(const Elimination *z, const bool *done)
{
    const int n = z->n;
    int best = -1, least = 0;
    for (int k = 0; k < n; ++k) {
        int rows = 0, columns = 0;
        for (int i = 0; i < n; ++i) {
            rows += !done[i] && i != k && z->entry[n * i + k];
            columns += !done[i] && i != k && z->entry[n * k + i];
        }
        if (!done[k] && (best < 0 || rows * columns < least)) {
            best = k;
            least = rows * columns;
        }
    }
    return best;
}

/* Entries of the matrices of weighed columns. */
static void look_at_weighed(Generation *g, Elimination *z)
{
    const RateColumns *weighed = weighed_columns(g);
    const int rows = z->states, columns = jacobian_columns(g);
    int *mass = pool_alloc(g->pool, ((size_t)(rows * rows) + 1) * sizeof *mass);
    bool *has = pool_alloc(g->pool, (size_t)rows + 1), *pattern = pool_alloc(g->pool, (size_t)(rows * rows) + 1);
    z->mass = mass;
    z->weighed = has;
    if (!weighed)
        return;
    for (int i = 0; i < weighed->block.stores; ++i) {
        const int at = weighed->block.store[i].target.index, row = at / columns, column = at % columns;
        if (row < rows && column < rows)
            pattern[rows * row + column] = true;
    }
    for (int i = 0; i < weighed->masses; ++i) {
        mass[rows * weighed->mass_row[i] + weighed->mass_column[i]] = rows * columns + i;
        has[weighed->mass_row[i]] = true;
    }
    z->pattern = pattern;
}

static Elimination *eliminate(Generation *g, int n, const int *unknown, const int *position)
{
    Elimination *z = pool_alloc(g->pool, sizeof *z);
    const size_t count = (size_t)n + 1, square = count * count;
    *z = (Elimination){.n = n,
                       .unknown = pool_alloc(g->pool, count * sizeof *z->unknown),
                       .position = pool_alloc(g->pool, count * sizeof *z->position),
                       .entry = pool_alloc(g->pool, square),
                       .slot = pool_alloc(g->pool, square * sizeof *z->slot),
                       .pattern = jacobian_pattern(g),
                       .states = states(g)};
    bool *done = pool_alloc(g->pool, count), *filled = pool_alloc(g->pool, square);
    int *order = pool_alloc(g->pool, count * sizeof *order), slots = 0;
    look_at_weighed(g, z);
    memcpy(z->unknown, unknown, (size_t)n * sizeof *unknown);
    memcpy(z->position, position, (size_t)n * sizeof *position);
    for (int i = 0; i < n * n; ++i)
        z->entry[i] = is_entry(z, i / n, i % n);
    for (int k = 0; k < n; ++k) {
        const int pivot = order[k] = cheapest(z, done);
        done[pivot] = true;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n && !done[i] && z->entry[n * i + pivot]; ++j)
                if (!done[j] && z->entry[n * pivot + j])
                    z->entry[n * i + j] = true;
    }
    for (int i = 0; i < n; ++i) {
        z->unknown[i] = unknown[order[i]];
        z->position[i] = position[order[i]];
        for (int j = 0; j < n; ++j) {
            filled[n * i + j] = z->entry[n * order[i] + order[j]];
            z->slot[n * i + j] = filled[n * i + j] ? slots++ : -1;
        }
    }
    z->entry = filled;
    return z;
}

/* More products than that are left to the loops of the runtime: of a matrix that is nearly full, code would be longer
 * than caches. */
static const int most_products = 20000;

bool elimination_is_short(Generation *g, int unknowns, const int *unknown, const int *position)
{
    const Elimination *z = eliminate(g, unknowns, unknown, position);
    const int n = z->n;
    int products = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < i && k < j && z->entry[n * i + j]; ++k)
                products += z->entry[n * i + k] && z->entry[n * k + j];
    return products <= most_products;
}

/* "J[7]", the derivative of an unknown's rate by a state. */
static void add_slope(const Generation *g, const Elimination *z, Text *out, int row, int state)
{
    text_print(out, "J[%d]", jacobian_columns(g) * z->unknown[row] + state);
}

/* Products that one expression has at most: compilers nest as deep. */
enum { MOST_TERMS = 8 };

/* Continue "f[3] = ..." or "x3 = ..." by another product. */
static void begin_term(Text *out, int indent, const char *target, int *terms)
{
    if (++*terms > MOST_TERMS) {
        text_print(out, ";\n%*s%s = %s", indent, "", target, target);
        *terms = 1;
    }
    text_print(out, " - ");
}

/* What an entry is without the Jacobian: of the mass matrix, or 1, or nothing. */
static const char *still_entry(const Generation *g, const Elimination *z, int row, int column)
{
    const int mass = z->mass[z->states * z->unknown[row] + z->unknown[column]];
    if (z->weighed[z->unknown[row]])
        return mass ? pool_print(g->pool, "J[%d]", mass) : "";
    return row == column ? "R(1.0)" : "";
}

/* "1 - reach (J + reach J)", as far as there is anything. */
static void add_entry(const Generation *g, const Elimination *z, Text *out, int row, int column)
{
    const bool *follows = z->pattern + z->states * z->unknown[row];
    const int state = z->unknown[column], position = z->position[column];
    const bool fast = follows[state], far = position >= 0 && follows[position];
    const char *still = still_entry(g, z, row, column);
    text_print(out, "%s", *still ? still : fast || far ? "" : "R(0.0)");
    if (!fast && !far)
        return;
    text_print(out, "%sr * ", *still ? " + " : "");
    if (far)
        text_print(out, "(");
    if (fast)
        add_slope(g, z, out, row, state);
    if (far) {
        text_print(out, fast ? " + reach * " : "reach * ");
        add_slope(g, z, out, row, position);
        text_print(out, ")");
    }
}

void write_elimination_factors(Generation *g, Text *out, int indent, int unknowns, const int *unknown,
                               const int *position)
{
    write_elimination_rows(g, out, indent, unknowns, unknown, position, 0, unknowns);
}

int elimination_work(Generation *g, int unknowns, const int *unknown, const int *position, int row)
{
    const Elimination *z = eliminate(g, unknowns, unknown, position);
    const int n = z->n;
    int products = 4;
    for (int j = 0; j < n; ++j)
        for (int k = 0; k < row && k < j && z->entry[n * row + j]; ++k)
            products += 2 * (z->entry[n * row + k] && z->entry[n * k + j]);
    return products;
}

void write_elimination_rows(Generation *g, Text *out, int indent, int unknowns, const int *unknown, const int *position,
                            int first, int end)
{
    const Elimination *z = eliminate(g, unknowns, unknown, position);
    const int n = z->n;
    for (int i = first; i < end; ++i)
        for (int j = 0; j < n; ++j) {
            if (!z->entry[n * i + j])
                continue;
            const char *target = pool_print(g->pool, "f[%d]", z->slot[n * i + j]);
            int terms = 0;
            text_print(out, "%*s%s = ", indent, "", target);
            add_entry(g, z, out, i, j);
            for (int k = 0; k < i && k < j; ++k)
                if (z->entry[n * i + k] && z->entry[n * k + j]) {
                    begin_term(out, indent, target, &terms);
                    text_print(out, "f[%d] * f[%d]", z->slot[n * i + k], z->slot[n * k + j]);
                }
            text_print(out, ";");
            if (i == j)
                text_print(out, " /* %s */", state_number(g->pool, g->formulation, z->unknown[i]).name);
            text_print(out, "\n");
            if (j < i)
                line(out, indent, "%s *= f[%d];", target, z->slot[n * j + j]);
            if (i != j)
                continue;
            if (z->weighed[z->unknown[i]])
                line(out, indent, "if (!(GIC_FABS(%s) > lightest * %s))", target, still_entry(g, z, i, i));
            else
                line(out, indent, "if (!(GIC_FABS(%s) > least))", target);
            line(out, indent + 4, "return 0;");
            line(out, indent, "%s = R(1.0) / %s;", target, target);
        }
}

void write_elimination_solution(Generation *g, Text *out, int indent, int unknowns, const int *unknown,
                                const int *position)
{
    const Elimination *z = eliminate(g, unknowns, unknown, position);
    const int n = z->n;
    for (int i = 0; i < n; ++i) {
        const char *target = pool_print(g->pool, "x%d", i);
        const bool *follows = z->pattern + z->states * z->unknown[i];
        int terms = 0;
        text_print(out, "%*sgic_real x%d = b[%d]", indent, "", i, z->unknown[i]);
        for (int k = 0; k < n; ++k)
            if (z->position[k] >= 0 && follows[z->position[k]]) {
                text_print(out, terms++ ? " + " : " + reach * (");
                add_slope(g, z, out, i, z->position[k]);
                text_print(out, " * b[%d]", z->position[k]);
            }
        text_print(out, terms ? ")" : "");
        for (int k = 0; k < i; ++k)
            if (z->entry[n * i + k]) {
                begin_term(out, indent, target, &terms);
                text_print(out, "f[%d] * x%d", z->slot[n * i + k], k);
            }
        text_print(out, ";\n");
    }
    for (int i = n - 1; i >= 0; --i) {
        const char *target = pool_print(g->pool, "x%d", i);
        int terms = 0, products = 0;
        for (int j = i + 1; j < n; ++j)
            if (z->entry[n * i + j]) {
                if (!products++)
                    text_print(out, "%*s%s = %s", indent, "", target, target);
                begin_term(out, indent, target, &terms);
                text_print(out, "f[%d] * x%d", z->slot[n * i + j], j);
            }
        text_print(out, products ? ";\n" : "");
        line(out, indent, "u[%d] = %s *= f[%d]; /* %s */", z->unknown[i], target, z->slot[n * i + i],
             state_number(g->pool, g->formulation, z->unknown[i]).name);
        if (z->position[i] >= 0)
            line(out, indent, "u[%d] = b[%d] + reach * %s;", z->position[i], z->position[i], target);
    }
}
