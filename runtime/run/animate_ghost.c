/* SPDX-License-Identifier: MIT
 * Another run on the page of --animate, as a second vehicle: where its results put the base, the coordinates and the
 * inputs that drive some, the recovery of the model puts all bodies. What they do not tell is as at the scene's start.
 */
#include "base/message.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "host/host.h"
#include "model/model.h"
#include "run/animate.h"
#include "run/run.h"

#include <math.h>
#include <string.h>

/* A number of the state, or of input[], that a column of the table tells. */
typedef struct Told {
    int column, index;
    bool input;
} Told;

struct Ghost {
    const Model *model;
    const Engine *engine;
    const CsvTable *table;
    gic_head *self;
    double *state, *start; /* FORMAT.md section 10; what is told is replaced in the first */
    double *kept;          /* [bodies][7] the last poses that were found */
    const double *point;   /* of the base, whose position is told; NULL: the base is fixed */
    int position, turn;    /* columns of x, and of roll, pitch, yaw or e0 to e3; all of them one after another */
    bool euler;            /* of the turn: e0 to e3 */
    Told *told;
    int count;
    const char **untold; /* names of coordinates */
    int untolds;
};

/* The column of the first component of an output, if all of them follow; -1: the table does not have it. */
static int column_of(Pool *pool, const CsvTable *table, const Output *output)
{
    int first = -1;
    for (int k = 0; k < output->count; ++k) {
        const int column = plot_column(pool, table, &(gic_signal){output->component[k], output->unit[k]});
        first = k ? first : column;
        if (column < 0 || column != first + k)
            return -1;
    }
    return first;
}

/* Position and turn of the base; false if the table does not tell both. */
static bool find_base(Pool *pool, Ghost *ghost)
{
    const Model *model = ghost->model;
    ghost->position = ghost->turn = -1;
    for (int i = 0; i < model->outputs; ++i) {
        const Output *output = &model->output[i];
        const bool turns = output->type == OUTPUT_ROLL_PITCH_YAW || output->type == OUTPUT_ORIENTATION;
        if (output->body != BODY_BASE || (!turns && output->type != OUTPUT_POSITION) || output->in != BODY_GROUND)
            continue;
        const int column = column_of(pool, ghost->table, output);
        if (column > 0 && turns && ghost->turn < 0) {
            ghost->turn = column;
            ghost->euler = output->type == OUTPUT_ORIENTATION;
        }
        if (column > 0 && !turns && ghost->position < 0) {
            ghost->position = column;
            ghost->point = output->point;
        }
    }
    return ghost->position > 0 && ghost->turn > 0;
}

/* The column that tells the value of a coordinate: of an output, or of the input that drives it. */
static int coordinate_column(Pool *pool, const Ghost *ghost, int coordinate)
{
    const Model *model = ghost->model;
    const gic_model *code = ghost->engine->code;
    int column = -1;
    for (int i = 0; i < model->outputs && column < 0; ++i) {
        const Output *output = &model->output[i];
        if (output->type == OUTPUT_COORDINATE && output->index == coordinate && output->count)
            column = plot_column(pool, ghost->table, &(gic_signal){output->component[0], output->unit[0]});
    }
    const int input = code->coordinate_input[coordinate];
    if (column < 0 && input >= 0)
        column = plot_column(
            pool, ghost->table,
            &(gic_signal){pool_print(pool, "input.%s", model->input[input].name), model->input[input].unit});
    return column;
}

static void find_coordinates(Pool *pool, Ghost *ghost)
{
    const gic_model *code = ghost->engine->code;
    for (int c = 0; c < code->coordinate_count; ++c) {
        const int column = coordinate_column(pool, ghost, c);
        const bool driven = code->coordinate_state[c] < 0;
        if (column > 0)
            *POOL_PUSH(pool, ghost->told, ghost->count) =
                (Told){column, driven ? code->coordinate_input[c] : code->coordinate_state[c], driven};
        else
            *POOL_PUSH(pool, ghost->untold, ghost->untolds) = code->coordinate[c].name;
    }
}

/* Euler parameters are numbers of a file: between rows they are normalised, which hides what is none. 1 % is more than
 * digits that are left out. A row without an orientation is told. */
static bool has_turns(const Ghost *ghost)
{
    for (int row = 0; ghost->point && ghost->euler && row < ghost->table->rows; ++row) {
        const double *e = ghost->table->value + row * ghost->table->columns + ghost->turn;
        const double length = hypot(hypot(e[0], e[1]), hypot(e[2], e[3]));
        if (!(fabs(length - 1) < 0.01)) {
            diag_warn(csv_place(ghost->table, row),
                      "write four numbers whose squares add up to 1; 1, 0, 0, 0 is no turn",
                      "the Euler parameters '%s' and on are no orientation: their length is %.4g",
                      ghost->table->name[ghost->turn], length);
            return false;
        }
    }
    return true;
}

Ghost *ghost_new(Pool *pool, const Model *model, const Engine *engine, const Scene *scene, const CsvTable *table)
{
    Ghost *ghost = pool_alloc(pool, sizeof *ghost);
    *ghost = (Ghost){.model = model, .engine = engine, .table = table};
    const bool placed = !model->free_base || find_base(pool, ghost);
    find_coordinates(pool, ghost);
    if (!placed || !has_turns(ghost) || (!model->free_base && !ghost->count))
        return NULL;
    const size_t numbers = (size_t)engine->standard_count + 1;
    ghost->self = instance_new(pool, engine);
    ghost->state = pool_alloc(pool, sizeof *ghost->state * numbers);
    ghost->start = pool_alloc(pool, sizeof *ghost->start * numbers);
    ghost->kept = pool_alloc(pool, sizeof *ghost->kept * 7 * ((size_t)model->bodies + 1));
    int status = scene_start(engine, scene, ghost->self);
    ghost->self->input_function = NULL; /* the table tells inputs */
    if (status == GIC_OK)
        status = engine_look(engine, ghost->self, ghost->start, NULL);
    if (status == GIC_OK)
        status = engine->code->poses(ghost->self, ghost->kept);
    return status == GIC_OK ? ghost : NULL;
}

double ghost_end(const Ghost *ghost)
{
    return ghost->table->value[(ghost->table->rows - 1) * ghost->table->columns];
}

int ghost_untold(const Ghost *ghost, const char *const **name)
{
    *name = ghost->untold;
    return ghost->untolds;
}

/* Euler parameters of the base in a row. */
static void turn_of(const Ghost *ghost, const double *row, double e[4])
{
    const double *told = row + ghost->turn;
    if (ghost->euler) {
        memcpy(e, told, 4 * sizeof *e);
        return;
    }
    const double r[2] = {cos(told[0] / 2), sin(told[0] / 2)}, p[2] = {cos(told[1] / 2), sin(told[1] / 2)};
    const double y[2] = {cos(told[2] / 2), sin(told[2] / 2)};
    e[0] = r[0] * p[0] * y[0] + r[1] * p[1] * y[1];
    e[1] = r[1] * p[0] * y[0] - r[0] * p[1] * y[1];
    e[2] = r[0] * p[1] * y[0] + r[1] * p[0] * y[1];
    e[3] = r[0] * p[0] * y[1] - r[1] * p[1] * y[0];
}

/* Between two rows; straight, and what turns is normalised. */
static void place_base(Ghost *ghost, const double *before, const double *after, double share)
{
    double p[4], q[4], length = 0, A[9], arm[3];
    turn_of(ghost, before, p);
    turn_of(ghost, after, q);
    const double same = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    double *r = ghost->state, *e = r + 3;
    for (int i = 0; i < 4; ++i) {
        e[i] = p[i] + share * ((same < 0 ? -q[i] : q[i]) - p[i]);
        length += e[i] * e[i];
    }
    for (int i = 0; i < 4; ++i)
        e[i] /= length > 0 ? sqrt(length) : 1;
    mat_from_euler(e, A);
    apply3(A, ghost->point, arm);
    for (int i = 0; i < 3; ++i) {
        const int c = ghost->position + i;
        r[i] = before[c] + share * (after[c] - before[c]) - arm[i];
    }
}

void ghost_poses(Ghost *ghost, double time, double *pose)
{
    const CsvTable *t = ghost->table;
    const size_t size = sizeof *pose * 7 * (size_t)ghost->model->bodies;
    int low = 0, high = t->rows - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (t->value[middle * t->columns] <= time)
            low = middle;
        else
            high = middle;
    }
    const double *before = t->value + low * t->columns, *after = t->value + high * t->columns;
    const double share = high > low ? fmin(fmax((time - before[0]) / (after[0] - before[0]), 0), 1) : 0;
    double *input = instance_array(ghost->self, ghost->engine->code->input_offset);
    memcpy(ghost->state, ghost->start, sizeof *ghost->state * (size_t)ghost->engine->standard_count);
    if (ghost->point)
        place_base(ghost, before, after, share);
    for (int i = 0; i < ghost->count; ++i) {
        const Told *told = &ghost->told[i];
        *(told->input ? input + told->index : ghost->state + told->index) =
            before[told->column] + share * (after[told->column] - before[told->column]);
    }
    const int status = engine_enter(ghost->engine, ghost->self, ghost->state);
    if (status != GIC_OK || ghost->engine->code->poses(ghost->self, pose) != GIC_OK)
        memcpy(pose, ghost->kept, size); /* where the model can not stand so: as it stood */
    memcpy(ghost->kept, pose, size);
}
