/* SPDX-License-Identifier: MIT
 * single --round STATES -o OUT
 * single OBJECT NAME STATES -o RESULTS
 *
 * Generated code in single precision at the states of a CSV file: what `gicrun --eval` writes, but for outputs, of the
 * model NAME in a shared object that was compiled with -DGIC_FLOAT. With --round the states as single precision has
 * them, for others to be compared at. */
#define GIC_FLOAT
#include "gic_runtime.h"
#include "reference/support.h"
#include "reference/table.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "usage: single --round STATES -o OUT\n       single OBJECT NAME STATES -o RESULTS\n";

static void round_states(const Table *table, FILE *out)
{
    for (int i = 0; i < table->columns; ++i)
        fprintf(out, "%s%s", i ? "," : "", table->name[i]);
    for (int row = 0; row < table->rows; ++row)
        for (int i = 0; i < table->columns; ++i)
            fprintf(out, "%s%.17g", i ? "," : "\n", (double)(float)table_number(table, row, i));
    fputc('\n', out);
}

static const gic_model *load(const char *path, const char *name)
{
    char symbol[80];
    void *object = dlopen(path, RTLD_NOW);
    if (!object)
        fail("%s", dlerror());
    snprintf(symbol, sizeof symbol, "%s_model", name);
    const gic_model *model = dlsym(object, symbol);
    if (!model || model->real_size != sizeof(float))
        fail("%s has no model '%s' in single precision", path, name);
    return model;
}

static void write_head(const gic_model *model, FILE *out)
{
    static const char *const part[] = {"x", "y", "z", "e0", "e1", "e2", "e3"};
    if (model->free_base)
        fputs("a.x,a.y,a.z,alpha.x,alpha.y,alpha.z,", out);
    for (int i = 0; i < model->coordinate_count; ++i)
        if (model->coordinate_state[i] >= 0)
            fprintf(out, "%s.acceleration,", model->coordinate[i].name);
    for (int i = model->free_base ? 0 : 1; i < model->body_count; ++i)
        for (int k = 0; k < 7; ++k)
            fprintf(out, "%s.%s,", model->body_name[i], part[k]);
    fputs("status\n", out);
}

static float *array(void *self, size_t offset)
{
    return (float *)(void *)((char *)self + offset);
}

static int evaluate(const gic_model *model, void *self, const Table *table, int row, float *rate, float *pose)
{
    float *state = array(self, model->state_offset), *input = array(self, model->input_offset);
    int status = model->setup(self);
    for (int i = 0; i < model->slow_count + model->fast_count && status == GIC_OK; ++i)
        state[i] = (float)table_number(table, row, table_want(table, model->state[i].name));
    for (int i = 0; i < model->input_count && status == GIC_OK; ++i)
        if (table_find(table, model->input[i].name) >= 0)
            input[i] = (float)table_number(table, row, table_find(table, model->input[i].name));
    if (status == GIC_OK)
        status = model->rhs(self, 0, state, rate);
    return status == GIC_OK ? model->poses(self, pose) : status;
}

static void write_row(const gic_model *model, int status, const float *rate, const float *pose, FILE *out)
{
    const int half = model->slow_count / 2;
    const int skipped = model->free_base ? 0 : 7;
    for (int i = 0; i < 6 && model->free_base; ++i)
        status == GIC_OK ? fprintf(out, "%.9g,", (double)rate[half + 1 + i]) : fputc(',', out);
    for (int i = 0; i < model->coordinate_count; ++i)
        if (model->coordinate_state[i] >= 0)
            status == GIC_OK ? fprintf(out, "%.9g,", (double)rate[model->coordinate_state[i] + half]) : fputc(',', out);
    for (int i = skipped; i < 7 * model->body_count; ++i)
        status == GIC_OK ? fprintf(out, "%.9g,", (double)pose[i]) : fputc(',', out);
    fprintf(out, "%d\n", status);
}

int main(int argc, char **argv)
{
    const bool rounds = argc == 5 && !strcmp(argv[1], "--round");
    if (!(rounds || argc == 6) || strcmp(argv[argc - 2], "-o") != 0) {
        fputs(usage, stderr);
        return 2;
    }
    Table *table = table_read(argv[argc - 3]);
    FILE *out = output_open(argv[argc - 1]);
    if (rounds) {
        round_states(table, out);
    } else {
        const gic_model *model = load(argv[1], argv[2]);
        void *self = grab(1, model->size);
        float *rate = grab((size_t)(model->slow_count + model->fast_count) + 1, sizeof *rate);
        float *pose = grab(7 * (size_t)model->body_count, sizeof *pose);
        write_head(model, out);
        for (int row = 0; row < table->rows; ++row)
            write_row(model, evaluate(model, self, table, row, rate, pose), rate, pose, out);
        free(self);
        free(rate);
        free(pose);
    }
    output_close(out, argv[argc - 1]);
    table_free(table);
    return 0;
}
