/* SPDX-License-Identifier: MIT
 * agree DUMP ACCEL EVAL [--tolerance 1e-12] [--condition 1e4] [--reactions] [--wheels] [--refusals] [--regular 100]
 *     [--floor 0]
 *
 * Compares what `gicrun --eval` wrote (EVAL) with what `reference` wrote (ACCEL) for the same states. Accelerations by
 * group, relative to the sum of magnitudes of the contributing terms; places relative to the model's length scale;
 * Euler parameters up to their common sign. With --reactions EVAL has a `reaction` output for each joint, which bears
 * its name, and a `drive_force` output `drive_NAME` for each driven coordinate; with --wheels it has the outputs that
 * wheels.sh asks for, and rates of fast states. They are compared like accelerations. A row counts where the reference
 * reached it with a subset condition within the limit; at least half of the rows must. Exit status 1 unless every
 * counted row agrees. With --refusals rows may be refused and unreached: every row that EVAL has and the reference
 * reached counts, and if there is none that is fine. With --regular a refusal may have a cause: a subset whose
 * condition is above that on the way from the design (reference --brisk), or whose determinant is below a twentieth of
 * that at the design. Rows with one are not counted; those without are told as "refused without cause". Where nice
 * numbers cancel, the sum of magnitudes of a group's terms can be nothing but rounding, or zero: --floor is the least
 * part of the largest one in the row that counts as such. */
#include "reference/solve.h"
#include "reference/support.h"
#include "reference/table.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: agree DUMP ACCEL EVAL [--tolerance 1e-12] [--condition 1e4] [--reactions] [--wheels] [--refusals]\n"
    "             [--regular 100] [--floor 0]\n";

/* Numbers that are compared as one vector. */
typedef struct Group {
    char label[160];
    int size, reference[4], eval[4]; /* columns */
    int scale_column;                /* in the reference, or -1: `scale` */
    double scale;
    bool either_sign;
    double worst;
    int worst_row; /* -1: none compared */
} Group;

typedef struct Groups {
    int count;
    Group *group;
} Groups;

static Group *add_group(Groups *groups, const char *label, const char *kind)
{
    Group *group = &groups->group[groups->count++];
    snprintf(group->label, sizeof group->label, "%s%s", label, kind);
    group->scale_column = group->worst_row = -1;
    group->scale = 1;
    return group;
}

static void add_column(Group *group, const Table *reference, const Table *eval, const char *name, const char *suffix)
{
    char column[160];
    snprintf(column, sizeof column, "%s%s", name, suffix);
    group->reference[group->size] = table_want(reference, column);
    group->eval[group->size++] = table_want(eval, column);
}

static void add_output(Group *group, const Table *reference, const Table *eval, const char *name)
{
    char column[160];
    snprintf(column, sizeof column, "output.%s", name);
    group->reference[group->size] = table_want(reference, name);
    group->eval[group->size++] = table_want(eval, column);
}

static void add_scale(Group *group, const Table *reference, const char *name)
{
    char column[160];
    snprintf(column, sizeof column, "scale.%s", name);
    group->scale_column = table_want(reference, column);
}

static void find_reactions(Groups *groups, const Model *model, const Table *reference, const Table *eval)
{
    static const char *const kind[] = {"force", "torque"};
    char name[128];
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven) {
            snprintf(name, sizeof name, "drive_%s", model->coordinate[c].name);
            Group *group = add_group(groups, name, "");
            add_output(group, reference, eval, name);
            add_scale(group, reference, name);
        }
    for (int j = 0; j < model->joints; ++j)
        for (int part = 0; part < 2; ++part) {
            snprintf(name, sizeof name, "%s.%s", model->joint[j].name, kind[part]);
            Group *group = add_group(groups, name, "");
            add_scale(group, reference, name);
            for (int i = 0; i < 3; ++i) {
                snprintf(name, sizeof name, "%s.%s.%c", model->joint[j].name, kind[part], "xyz"[i]);
                add_output(group, reference, eval, name);
            }
        }
}

/* One number that is its own group. */
static void add_number(Groups *groups, const Table *reference, const Table *eval, const char *name, bool output)
{
    Group *group = add_group(groups, name, "");
    if (output)
        add_output(group, reference, eval, name);
    else
        add_column(group, reference, eval, name, "");
    add_scale(group, reference, name);
}

static void find_wheels(Groups *groups, const Model *model, const Table *reference, const Table *eval)
{
    char name[128];
    for (int w = 0; w < model->wheels; ++w)
        for (int i = 0; i < WHEEL_COLUMNS; ++i)
            if (wheel_shows(&model->wheel[w], i)) {
                snprintf(name, sizeof name, "%s%s", model->wheel[w].name, wheel_column[i].name);
                add_number(groups, reference, eval, name, !wheel_column[i].is_rate);
            }
    for (int i = 0; i < LINE_RESULTS && model->powertrain; ++i)
        add_number(groups, reference, eval, line_column[i], i >= ENGINE_SPEED);
    for (int i = 0; i < model->states; ++i) {
        snprintf(name, sizeof name, "%s.rate", model->state_name[i]);
        add_number(groups, reference, eval, name, false);
    }
    for (int i = 0; i < 3; ++i) {
        snprintf(name, sizeof name, "energies.%s", energy_name[i]);
        add_number(groups, reference, eval, name, true);
    }
}

static Groups groups_find(const Model *model, const Table *reference, const Table *eval, bool reactions, bool wheels)
{
    static const char *const xyz[] = {".x", ".y", ".z"}, *const e[] = {".e0", ".e1", ".e2", ".e3"};
    static const char *const base[] = {"a", "alpha"};
    Groups groups = {.group =
                         grab((size_t)(5 + LINE_RESULTS + 2 * (model->coordinates + model->bodies + model->joints) +
                                       WHEEL_COLUMNS * model->wheels + model->states),
                              sizeof *groups.group)};
    for (int i = 0; i < 2 && model->free_base; ++i) {
        Group *group = add_group(&groups, base[i], "");
        for (int j = 0; j < 3; ++j)
            add_column(group, reference, eval, base[i], xyz[j]);
        add_scale(group, reference, base[i]);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven) {
            Group *group = add_group(&groups, model->coordinate[c].name, " acceleration");
            add_column(group, reference, eval, model->coordinate[c].name, ".acceleration");
            add_scale(group, reference, model->coordinate[c].name);
        }
    for (int k = model->free_base ? 0 : 1; k < model->bodies; ++k) {
        Group *place = add_group(&groups, model->body[k].name, " place");
        for (int j = 0; j < 3; ++j)
            add_column(place, reference, eval, model->body[k].name, xyz[j]);
        place->scale = model->length;
        Group *orientation = add_group(&groups, model->body[k].name, " Euler parameters");
        for (int j = 0; j < 4; ++j)
            add_column(orientation, reference, eval, model->body[k].name, e[j]);
        orientation->either_sign = true;
    }
    if (reactions)
        find_reactions(&groups, model, reference, eval);
    if (wheels)
        find_wheels(&groups, model, reference, eval);
    return groups;
}

/* The largest sum of magnitudes of a row, accelerations, forces and all. */
static double largest_scale(const Groups *groups, const Table *reference, int row)
{
    double largest = 10; /* of the size of weights and forces of about 1 kg */
    for (int i = 0; i < groups->count; ++i)
        if (groups->group[i].scale_column >= 0)
            largest = fmax(largest, table_number(reference, row, groups->group[i].scale_column));
    return largest;
}

static double deviation(const Group *group, const Table *reference, const Table *eval, int row, double least)
{
    double minus = 0, plus = 0;
    for (int i = 0; i < group->size; ++i) {
        double x = table_number(reference, row, group->reference[i]), y = table_number(eval, row, group->eval[i]);
        minus += (x - y) * (x - y);
        plus += (x + y) * (x + y);
    }
    double scale = group->scale_column < 0 ? group->scale : table_number(reference, row, group->scale_column);
    if (group->scale_column >= 0)
        scale = fmax(scale, least);
    double size = sqrt(group->either_sign && plus < minus ? plus : minus);
    return size == 0 ? 0 : size / scale;
}

/* True when all groups of a row agree; NaN never does. */
static bool row_agrees(Groups *groups, const Table *reference, const Table *eval, int row, double tolerance,
                       double floor)
{
    bool agrees = true;
    const double least = floor > 0 ? floor * largest_scale(groups, reference, row) : 0;
    for (int i = 0; i < groups->count; ++i) {
        Group *group = &groups->group[i];
        double size = deviation(group, reference, eval, row, least);
        if (group->worst_row < 0 || (!isnan(group->worst) && !(size <= group->worst))) {
            group->worst = size;
            group->worst_row = row;
        }
        agrees = agrees && size <= tolerance;
    }
    return agrees;
}

int main(int argc, char **argv)
{
    const char *path[3] = {NULL};
    double tolerance = 1e-12, limit = 1e4, regular = HUGE_VAL, least = 0;
    int paths = 0;
    bool reactions = false, wheels = false, refusals = false;
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--tolerance") && i + 1 < argc) {
            tolerance = number_of(argv[++i], "--tolerance");
        } else if (!strcmp(argv[i], "--condition") && i + 1 < argc) {
            limit = number_of(argv[++i], "--condition");
        } else if (!strcmp(argv[i], "--regular") && i + 1 < argc) {
            regular = number_of(argv[++i], "--regular");
        } else if (!strcmp(argv[i], "--floor") && i + 1 < argc) {
            least = number_of(argv[++i], "--floor");
        } else if (!strcmp(argv[i], "--reactions")) {
            reactions = true;
        } else if (!strcmp(argv[i], "--wheels")) {
            wheels = true;
        } else if (!strcmp(argv[i], "--refusals")) {
            refusals = true;
        } else if (argv[i][0] != '-' && paths < 3) {
            path[paths++] = argv[i];
        } else {
            fputs(usage, stderr);
            return 2;
        }
    }
    if (paths != 3) {
        fputs(usage, stderr);
        return 2;
    }
    Model *model = model_read(path[0]);
    Table *reference = table_read(path[1]), *eval = table_read(path[2]);
    if (reference->rows != eval->rows)
        fail("%s has %d rows, %s has %d", path[1], reference->rows, path[2], eval->rows);
    int status = table_want(reference, "status"), eval_status = table_want(eval, "status"),
        condition = table_want(reference, "condition"),
        way = regular < HUGE_VAL ? table_want(reference, "way.condition") : 0,
        determinant = regular < HUGE_VAL ? table_want(reference, "way.determinant") : 0;
    int unreached = 0, ill = 0, refused = 0, baseless = 0, passed = 0, failed = 0;
    Groups groups = groups_find(model, reference, eval, reactions, wheels);
    for (int row = 0; row < reference->rows; ++row) {
        const bool is_refused = table_number(eval, row, eval_status) != 0;
        if (table_number(reference, row, status) != 0) {
            ++unreached;
        } else if (!(table_number(reference, row, condition) <= limit)) {
            ++ill;
        } else if (is_refused && regular < HUGE_VAL &&
                   !(table_number(reference, row, way) <= regular &&
                     table_number(reference, row, determinant) >= 0.05)) {
            ++ill;
        } else if (is_refused && refusals) {
            ++refused;
            ++baseless;
        } else if (is_refused) {
            ++baseless;
            if (!refused++)
                printf("row %d: refused with status %s\n", row + 1, eval->cell[row * eval->columns + eval_status]);
            ++failed;
        } else if (row_agrees(&groups, reference, eval, row, tolerance, least)) {
            ++passed;
        } else {
            ++failed;
        }
    }
    int counted = passed + failed;
    printf("%d rows: %d not reached by the reference, %d above condition %g, %d compared, %d of them refused\n",
           reference->rows, unreached, ill, limit, counted, refused);
    for (int i = 0; i < groups.count; ++i)
        if (groups.group[i].worst_row >= 0)
            printf("%-40s worst %.2e in row %d%s\n", groups.group[i].label, groups.group[i].worst,
                   groups.group[i].worst_row + 1, groups.group[i].worst <= tolerance ? "" : "  FAILED");
    if (baseless && regular < HUGE_VAL)
        printf("%d refused without cause\n", baseless);
    bool enough = refusals || (counted > 0 && 2 * counted >= reference->rows);
    if (!enough)
        printf("only %d of %d rows were admissible: that proves nothing\n", counted, reference->rows);
    printf("%d passed, %d failed\n", passed, failed);
    free(groups.group);
    table_free(reference);
    table_free(eval);
    model_free(model);
    return failed || !enough;
}
