/* SPDX-License-Identifier: MIT
 * reference DUMP STATES [-o ACCEL] [--near POSES] [--road flat|sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y]
 *     [--friction X_LOW,X_HIGH,Y_LOW,Y_HIGH,VALUE,FADE] [--brisk]
 *
 * Accelerations, poses, drive forces, reactions of joints, what wheels and powertrain do, energies, scales and the
 * condition of each subset, by its first body's name, of a dumped model (`gicgen --dump-model`) at the states of a CSV
 * file with the columns of `gicrun --eval`; columns of fast states and of inputs that are no coordinates may be
 * missing. The road's friction is 1 but on one patch. A row's status is 0, or 1 where the state can't be reached from
 * design or is singular; its other cells are empty then. With --near bodies are looked for near the poses in the
 * columns of POSES, as `gicrun --eval` writes them, instead: then the answer is about those, however they were reached.
 * With --brisk what can't be reached, and what lies close to a singular configuration, is given up early, and the
 * columns way.condition and way.determinant say how near to a singular configuration a row has come on its way. */
#include "row.h"

#include "support.h"

#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: reference DUMP STATES [-o ACCEL] [--near POSES] [--road flat|sine:AMPLITUDE,WAVELENGTH,X0,PHASE_PER_Y]\n"
    "                 [--friction X_LOW,X_HIGH,Y_LOW,Y_HIGH,VALUE,FADE] [--brisk]\n";

static void write_head(FILE *out, const Model *model)
{
    if (model->free_base)
        fputs("a.x,a.y,a.z,alpha.x,alpha.y,alpha.z,", out);
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven)
            fprintf(out, "%s.acceleration,", model->coordinate[c].name);
    if (model->free_base)
        fputs("scale.a,scale.alpha,", out);
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven)
            fprintf(out, "scale.%s,", model->coordinate[c].name);
    for (int k = model->free_base ? 0 : 1; k < model->bodies; ++k) {
        const char *body = model->body[k].name;
        fprintf(out, "%s.x,%s.y,%s.z,%s.e0,%s.e1,%s.e2,%s.e3,", body, body, body, body, body, body, body);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven)
            fprintf(out, "drive_%s,scale.drive_%s,", model->coordinate[c].name, model->coordinate[c].name);
    for (int j = 0; j < model->joints; ++j)
        for (int part = 0; part < 2; ++part) {
            const char *joint = model->joint[j].name, *kind = part == 0 ? "force" : "torque";
            fprintf(out, "%s.%s.x,%s.%s.y,%s.%s.z,scale.%s.%s,", joint, kind, joint, kind, joint, kind, joint, kind);
        }
    for (int w = 0; w < model->wheels; ++w)
        for (int i = 0; i < WHEEL_COLUMNS; ++i)
            if (wheel_shows(&model->wheel[w], i)) {
                const char *wheel = model->wheel[w].name, *name = wheel_column[i].name;
                fprintf(out, "%s%s,scale.%s%s,", wheel, name, wheel, name);
            }
    for (int i = 0; i < LINE_RESULTS && model->powertrain; ++i)
        fprintf(out, "%s,scale.%s,", line_column[i], line_column[i]);
    for (int i = 0; i < model->states; ++i)
        fprintf(out, "%s.rate,scale.%s.rate,", model->state_name[i], model->state_name[i]);
    for (int i = 0; i < 3; ++i)
        fprintf(out, "energies.%s,scale.energies.%s,", energy_name[i], energy_name[i]);
    for (int i = 0; i < model->subsets; ++i)
        if (!is_base(&model->subset[i]))
            fprintf(out, "condition.%s,", model->body[model->subset[i].body[0]].name);
    fputs("condition,way.condition,way.determinant,status\n", out);
}

static void write_numbers(FILE *out, const quad *x, int size)
{
    for (int i = 0; i < size; ++i)
        fprintf(out, "%.17g,", (double)x[i]);
}

static void write_row(FILE *out, Solver *solver)
{
    const Model *model = solver->model;
    if (model->free_base) {
        write_numbers(out, solver->a, 3);
        write_numbers(out, solver->alpha, 3);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven)
            write_numbers(out, &solver->w_second[c], 1);
    if (model->free_base) {
        write_numbers(out, &solver->a_scale, 1);
        write_numbers(out, &solver->alpha_scale, 1);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven)
            write_numbers(out, &solver->w_scale[c], 1);
    for (int k = solver->first; k < model->bodies; ++k) {
        quad r[3];
        body_origin(model, solver->configuration, k, r);
        write_numbers(out, r, 3);
        write_numbers(out, solver->configuration->q[k] + 3, 4);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven) {
            write_numbers(out, &solver->drive_force[c], 1);
            write_numbers(out, &solver->drive_scale[c], 1);
        }
    for (int j = 0; j < model->joints; ++j) {
        const Reaction *reaction = &solver->reaction[j];
        write_numbers(out, reaction->force, 3);
        write_numbers(out, &reaction->force_scale, 1);
        write_numbers(out, reaction->torque, 3);
        write_numbers(out, &reaction->torque_scale, 1);
    }
    for (int w = 0; w < model->wheels; ++w)
        for (int i = 0; i < WHEEL_COLUMNS; ++i)
            if (wheel_shows(&model->wheel[w], i)) {
                write_numbers(out, &solver->wheel[w].value[wheel_column[i].result], 1);
                write_numbers(out, &solver->wheel[w].scale[wheel_column[i].result], 1);
            }
    for (int i = 0; i < LINE_RESULTS && model->powertrain; ++i) {
        write_numbers(out, &solver->line.value[i], 1);
        write_numbers(out, &solver->line.scale[i], 1);
    }
    for (int i = 0; i < model->states; ++i) {
        const quad rate = law_value(model, solver->configuration, model->state_rate[i], (Locals){0}),
                   size = law_size(model, solver->configuration, model->state_rate[i], (Locals){0});
        write_numbers(out, &rate, 1);
        write_numbers(out, &size, 1);
    }
    for (int i = 0; i < 3; ++i) {
        write_numbers(out, &solver->energy[i], 1);
        write_numbers(out, &solver->energy_scale[i], 1);
    }
    for (int i = 0; i < model->subsets; ++i)
        if (!is_base(&model->subset[i]))
            fprintf(out, "%.6g,", subset_condition(solver, &model->subset[i]));
    fprintf(out, "%.6g,%.6g,%.6g,0\n", worst_condition(solver), solver->way_condition, solver->way_determinant);
}

static void write_unreached(FILE *out, const Model *model)
{
    int cells = (model->free_base ? 8 : 0) + 7 * (model->bodies - (model->free_base ? 0 : 1)) + 3;
    cells +=
        2 * model->coordinates + 8 * model->joints + (model->powertrain ? 2 * LINE_RESULTS : 0) + 6 + 2 * model->states;
    for (int w = 0; w < model->wheels; ++w)
        for (int i = 0; i < WHEEL_COLUMNS; ++i)
            cells += 2 * wheel_shows(&model->wheel[w], i);
    for (int i = 0; i < model->subsets; ++i)
        cells += !is_base(&model->subset[i]);
    while (cells--)
        fputc(',', out);
    fputs("1\n", out);
}

/* The columns of all poses but the base's: [bodies][7]. */
static int (*pose_columns(const Model *model, const Table *table))[BODY_COORDINATES]
{
    static const char *const part[BODY_COORDINATES] = {"x", "y", "z", "e0", "e1", "e2", "e3"};
    int(*column)[BODY_COORDINATES] = grab((size_t)model->bodies, sizeof *column);
    for (int k = 1; k < model->bodies; ++k)
        for (int i = 0; i < BODY_COORDINATES; ++i) {
            char name[128];
            snprintf(name, sizeof name, "%s.%s", model->body[k].name, part[i]);
            column[k][i] = table_want(table, name);
        }
    return column;
}

static bool positions(Solver *solver, const State *state, const Table *near, int row, int (*column)[BODY_COORDINATES],
                      quad (*pose)[BODY_COORDINATES])
{
    if (!near)
        return solve_positions(solver, state);
    for (int k = 1; k < solver->model->bodies; ++k)
        for (int i = 0; i < BODY_COORDINATES; ++i)
            pose[k][i] = table_number(near, row, column[k][i]);
    return solve_near(solver, state, pose);
}

int main(int argc, char **argv)
{
    const char *path[2] = {NULL, NULL}, *out_path = NULL, *near_path = NULL;
    int paths = 0, unreached = 0;
    bool brisk = false;
    Road road = {0};
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "-o") && i + 1 < argc) {
            out_path = argv[++i];
        } else if (!strcmp(argv[i], "--brisk")) {
            brisk = true;
        } else if (!strcmp(argv[i], "--near") && i + 1 < argc) {
            near_path = argv[++i];
        } else if (!strcmp(argv[i], "--road") && i + 1 < argc) {
            road_parse(argv[++i], &road);
        } else if (!strcmp(argv[i], "--friction") && i + 1 < argc) {
            friction_parse(argv[++i], &road);
        } else if (argv[i][0] != '-' && paths < 2) {
            path[paths++] = argv[i];
        } else {
            fputs(usage, stderr);
            return 2;
        }
    }
    if (paths != 2) {
        fputs(usage, stderr);
        return 2;
    }
    Model *model = model_read(path[0]);
    Table *table = table_read(path[1]), *near = near_path ? table_read(near_path) : NULL;
    if (near && near->rows != table->rows)
        fail("%s has %d rows, %s has %d", path[1], table->rows, near_path, near->rows);
    int(*column)[BODY_COORDINATES] = near ? pose_columns(model, near) : NULL;
    quad(*pose)[BODY_COORDINATES] = grab((size_t)model->bodies, sizeof *pose);
    Solver *solver = solver_new(model);
    solver->brisk = brisk;
    State *state = state_new(model);
    FILE *out = output_open(out_path);
    write_head(out, model);
    for (int row = 0; row < table->rows; ++row) {
        state_read(model, table, row, state);
        bool reached =
            (!model->free_base || recover_largest(state->e)) && positions(solver, state, near, row, column, pose);
        if (reached) {
            solve_velocities(solver, state);
            reached = solve_accelerations(solver, state, &road);
        }
        if (reached)
            write_row(out, solver);
        else
            write_unreached(out, model);
        unreached += !reached;
    }
    output_close(out, out_path);
    fprintf(stderr, "reference: %d rows, %d not reached\n", table->rows, unreached);
    state_free(state);
    solver_free(solver);
    table_free(table);
    if (near)
        table_free(near);
    free(column);
    free(pose);
    model_free(model);
    return 0;
}
