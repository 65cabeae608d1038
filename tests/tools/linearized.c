/* SPDX-License-Identifier: MIT
 * linearized MODEL.veh STATES [SCENE]
 *
 * Prints for each row of STATES (columns of `gicrun --eval`) the matrix A of dz/dt = f + A z (runtime/run/linearize.h)
 * on the road of SCENE: a line a row of A, entries to 17 digits, with the row of STATES, from 1, in front. A state that
 * can not be evaluated has no lines. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/linearize.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Numbers of one kind of a row of states. */
static void take(const CsvTable *table, int row, const gic_signal *signal, int count, double *out)
{
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < table->columns; ++k)
            if (!strcmp(table->name[k], signal[i].name))
                out[i] = table->value[row * table->columns + k];
}

/* A powertrain's gears. */
static void take_gears(const CsvTable *table, int row, const gic_model *code, gic_head *self)
{
    int32_t *gear = (int32_t *)(void *)instance_array(self, code->discrete_offset);
    for (int i = code->free_base; i < code->discrete_count; ++i) {
        double value = gear[i];
        take(table, row, &code->discrete[i], 1, &value);
        gear[i] = (int32_t)value;
    }
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc > 4) {
        fputs("usage: linearized MODEL.veh STATES [SCENE]\n", stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const Model *model = model_read(pool, argv[1]);
    const CsvTable *table = csv_read(pool, argv[2], "r.x,r.y,...", NULL);
    const Scene *scene = argc > 3 ? scene_read(pool, argv[3], model, NULL, 0) : NULL;
    const Engine *engine = engine_open(pool, "tape", model, &(EngineOptions){.quiet = true});
    const Linear *linear = linear_open(pool, engine);
    const gic_model *code = engine->code;
    gic_head *self = instance_new(pool, engine);
    const int count = linear->count;
    double f[count + 1], A[count * count + 1];
    printf("row");
    for (int i = 0; i < count; ++i)
        printf(",%s%s", linear->name[i], i < linear->places || i >= 2 * linear->places ? "" : ".rate");
    printf("\n");
    for (int row = 0; row < table->rows; ++row) {
        code->setup(self);
        self->road = scene ? scene->road : NULL;
        take(table, row, code->state, code->slow_count + code->fast_count, instance_array(self, code->state_offset));
        take(table, row, code->input, code->input_count, instance_array(self, code->input_offset));
        take_gears(table, row, code, self);
        if (linearize(linear, (Instance *)(void *)self, f, A) != GIC_OK)
            continue;
        for (int i = 0; i < count; ++i) {
            printf("%d", row + 1);
            for (int j = 0; j < count; ++j)
                printf(",%.17g", A[i * count + j]);
            printf("\n");
        }
    }
    pool_free(pool);
    return 0;
}
