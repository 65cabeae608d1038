/* SPDX-License-Identifier: MIT
 * For attacks on compilers, built with a model's code: -DMODEL=hmmwv -DHEADER='"hmmwv.h"'. Reads states as `gicrun
 * --eval` does, on standard input, and prints the columns of it that tests/tools/agree.c compares: accelerations and
 * poses. In either precision, and without anything of ours but the code on trial. */
#include HEADER

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PASTE(a, b) a##b
#define DESCRIPTOR(name) PASTE(name, _model)

enum { LINE = 1 << 16, COLUMNS = 2000 };

static gic_real *array(void *self, size_t offset)
{
    return (gic_real *)(void *)((char *)self + offset);
}

static void fail(const char *what, const char *name)
{
    fprintf(stderr, "%s: %s\n", what, name);
    exit(2);
}

static int position(const gic_signal *signal, int32_t count, const char *name)
{
    for (int32_t i = 0; i < count; ++i)
        if (!strcmp(signal[i].name, name))
            return (int)i;
    return -1;
}

/* Where a column's numbers go; gears are not numbers of their own kind: NULL, and *gear. */
static gic_real *place(const gic_model *model, void *self, gic_real *state, const char *name, int32_t **gear)
{
    int i = position(model->state, model->slow_count + model->fast_count, name);
    if (i >= 0)
        return &state[i];
    i = position(model->input, model->input_count, name);
    if (i >= 0)
        return &array(self, model->input_offset)[i];
    i = position(model->parameter, model->parameter_count, name);
    if (i >= 0)
        return &array(self, model->parameter_offset)[i];
    i = position(model->discrete, model->discrete_count, name);
    if (i < 0)
        fail("no such number", name);
    *gear = (int32_t *)(void *)((char *)self + model->discrete_offset) + i;
    return NULL;
}

static void print_head(const gic_model *model)
{
    static const char *const base[] = {"a.x", "a.y", "a.z", "alpha.x", "alpha.y", "alpha.z"};
    static const char *const pose[] = {"x", "y", "z", "e0", "e1", "e2", "e3"};
    for (int i = 0; i < 6 && model->free_base; ++i)
        printf("%s,", base[i]);
    for (int32_t c = 0; c < model->coordinate_count; ++c)
        if (model->coordinate_state[c] >= 0)
            printf("%s.acceleration,", model->coordinate[c].name);
    for (int32_t i = !model->free_base; i < model->body_count; ++i)
        for (int k = 0; k < 7; ++k)
            printf("%s.%s,", model->body_name[i], pose[k]);
    printf("status\n");
}

static void cell(int status, gic_real value)
{
    if (status == GIC_OK)
        printf("%.17g", (double)value);
    printf(",");
}

static void print_row(const gic_model *model, int status, const gic_real *rate, const gic_real *pose)
{
    const int32_t half = model->slow_count / 2;
    for (int32_t i = 0; i < 6 && model->free_base; ++i)
        cell(status, rate[half + 1 + i]);
    for (int32_t c = 0; c < model->coordinate_count; ++c)
        if (model->coordinate_state[c] >= 0)
            cell(status, rate[model->coordinate_state[c] + half]);
    for (int32_t i = 7 * !model->free_base; i < 7 * model->body_count; ++i)
        cell(status, pose[i]);
    printf("%d\n", status);
}

int main(void)
{
    static char line[LINE], head[LINE];
    static const char *name[COLUMNS];
    const gic_model *model = &DESCRIPTOR(MODEL);
    const size_t states = (size_t)(model->slow_count + model->fast_count) + 1;
    void *self = malloc(model->size);
    gic_real *state = malloc(states * sizeof *state), *rate = malloc(states * sizeof *rate);
    gic_real *pose = malloc(7 * (size_t)(model->body_count + 1) * sizeof *pose);
    int columns = 0;
    if (!self || !state || !rate || !pose || !fgets(head, sizeof head, stdin))
        fail("nothing to read", model->name);
    for (char *word = strtok(head, ",\n"); word && columns < COLUMNS; word = strtok(NULL, ",\n"))
        name[columns++] = word;
    print_head(model);
    while (fgets(line, sizeof line, stdin)) {
        int status = model->setup(self);
        char *at = line;
        memcpy(state, array(self, model->state_offset), (states - 1) * sizeof *state);
        for (int i = 0; i < columns; ++i, ++at) {
            const double value = strtod(at, &at);
            int32_t *gear = NULL;
            gic_real *number = place(model, self, state, name[i], &gear);
            if (number)
                *number = (gic_real)value;
            else
                *gear = (int32_t)value;
        }
        memcpy(array(self, model->state_offset), state, (states - 1) * sizeof *state);
        if (status == GIC_OK)
            status = model->rhs(self, 0, state, rate);
        if (status == GIC_OK)
            status = model->poses(self, pose);
        print_row(model, status, rate, pose);
    }
    free(self);
    free(state);
    free(rate);
    free(pose);
    return 0;
}
