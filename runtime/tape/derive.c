/* SPDX-License-Identifier: MIT
 * Set-up with geometric parameters: the template derive.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "tape/engine_tape.h"
#include "tape/journal.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Arrays of these blocks, as vehicle/set_up.c names them. */
enum { TUNED_PARAMETER, TUNED_REST, TUNED_DERIVED, TUNED_START, TUNED_STATE, TUNED_INPUT, TUNED_MOTION, TUNED_COUNT };

void tape_record_derived(Pool *pool, TapeEngine *engine)
{
    static const Element array[TUNED_COUNT] = {
        [TUNED_PARAMETER] = {.array = ARRAY_p},          [TUNED_REST] = {.array = ARRAY_rest},
        [TUNED_DERIVED] = {.array = ARRAY_self_derived}, [TUNED_START] = {.array = ARRAY_self_start},
        [TUNED_STATE] = {.array = ARRAY_self_state},     [TUNED_INPUT] = {.array = ARRAY_self_input},
        [TUNED_MOTION] = {.array = ARRAY_self_motion},
    };
    const Plan *plan = engine->formulation->plan;
    engine->derive = tape_record(pool, derive_block(pool, plan), array, TUNED_COUNT);
    engine->draw = tape_record(pool, draw_block(pool, plan), array, TUNED_COUNT);
    engine->design = tape_record(pool, design_block(pool, plan), array, TUNED_COUNT);
    engine->first_piece = design_first_piece(pool, plan);
}

/* The arrays that these blocks read and write, of an instance or of its derivatives; rest: one number. */
static void tuned_arrays(Instance *self, double *rest, double *array[TUNED_COUNT])
{
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    double *const all[TUNED_COUNT] = {
        [TUNED_PARAMETER] = tape_array(self, code->parameter_offset),
        [TUNED_REST] = rest,
        [TUNED_DERIVED] = tape_array(self, engine->derived_offset),
        [TUNED_START] = tape_array(self, engine->start_offset[0]),
        [TUNED_STATE] = tape_array(self, code->state_offset),
        [TUNED_INPUT] = tape_array(self, code->input_offset),
        [TUNED_MOTION] = tape_array(self, engine->motion_offset),
    };
    memcpy(array, all, sizeof all);
}

static int play(Instance *self, const Tape *tape, double rest)
{
    const TapeEngine *engine = tape_of(self);
    const TapeWorld world = {.table = engine->table, .head = &self->head};
    double *array[TUNED_COUNT];
    tuned_arrays(self, &rest, array);
    return tape_play(tape, 0, array, &world, engine->frame);
}

/* All numbers that follow geometric parameters. rest: share of the way from the drawing to given lengths still ahead.
 */
static int derive(Instance *self, double rest)
{
    const TapeEngine *engine = tape_of(self);
    tape_forget(self); /* it was of other numbers */
    int status = play(self, engine->derive, rest);
    if (status != GIC_OK)
        return status;
    return gic_finite(tape_array(self, engine->derived_offset), engine->formulation->plan->derived->count)
               ? GIC_OK
               : GIC_ERROR_GEOMETRY;
}

int tape_derive_dual(Instance *value, Instance *slope, TapeJournal *journal, double *slope_frame)
{
    const TapeEngine *engine = tape_of(value);
    const TapeWorld world = {.table = engine->table, .head = &value->head, .journal = journal};
    double rest[2] = {0}, *array[2][TUNED_COUNT];
    tuned_arrays(value, &rest[0], array[0]);
    tuned_arrays(slope, journal_numbers(&world, &rest[1], 1), array[1]);
    return tape_play_dual(engine->derive, 0, array[0], array[1], &world, engine->frame, slope_frame);
}

int tape_assemble(Instance *self, const double turn[3])
{
    const TapeEngine *engine = tape_of(self);
    const int pieces = engine->formulation->model->tuning->assembles ? ASSEMBLY_PIECES : 1;
    const int derived = engine->formulation->plan->derived->count;
    double *number = tape_array(self, engine->derived_offset);
    int status = play(self, engine->draw, 1);
    memcpy(tape_array(self, engine->x_offset), tape_array(self, engine->start_offset[0]),
           (size_t)engine->code.coordinate_count * sizeof(double));
    for (int piece = engine->first_piece; status == GIC_OK && piece <= pieces; ++piece) {
        status = derive(self, (double)(pieces - piece) / (double)pieces);
        if (status == GIC_OK)
            status = tape_recover(self, turn, true);
        if (status == GIC_OK && piece == engine->first_piece)
            status = play(self, engine->design, 0);
    }
    /* a geometry that does not fit must not run: make it look changed since set-up */
    for (int i = 0; status != GIC_OK && i < derived; ++i)
        number[i] = number[i] > 0 ? -1 : 1;
    return status;
}

bool tape_is_tuned(Instance *self)
{
    const TapeEngine *engine = tape_of(self);
    const Model *model = engine->formulation->model;
    const double *parameter = tape_array(self, engine->code.parameter_offset);
    const double *derived = tape_array(self, engine->derived_offset);
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].geometric && parameter[model->parameter[i].index] != *derived++)
            return false;
    return true;
}
