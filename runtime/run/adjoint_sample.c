/* SPDX-License-Identifier: MIT
 * Backwards through what happens between steps: samples of controllers (tangent_sample.c) and looks of the driver
 * (tangent_drive.c). */
#include "gic_runtime.h"
#include "run/adjoint_private.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <string.h>

int sample_back(Back *back, int event, double weight)
{
    const TangentRun *run = back->run;
    const gic_model *code = run->code;
    const TrailEvent *seen = trail_event(run->trail, event), *sample = trail_event(run->trail, event + 1);
    const double *doing = sample->number + run->states;
    double *by = back->state, fresh[code->output_count + 1];
    memset(fresh, 0, sizeof fresh);
    for (int c = 0, r = 0; c < code->controller_count; ++c)
        for (int i = 0; i < code->controller[c].rule_count; ++i, ++r) {
            const gic_rule *rule = &code->controller[c].rule[i];
            double *held = by + rule->state;
            if (!((int)doing[r] & SAMPLE_NEW))
                continue;
            const double by_fresh = rule->quantum > 0 ? 0 : held[rule->waiting > 0];
            for (int d = 1; d < rule->waiting; ++d)
                held[d] = held[d + 1];
            held[rule->waiting] = 0;
            if (rule->output < 0)
                held[0] += by_fresh;
            else
                fresh[rule->output] += by_fresh;
        }
    memset(back->sum, 0, (size_t)run->states * sizeof *back->sum);
    int status = outputs_back(back, sample, fresh);
    adjoint_add(run->states, 1, run->linear->along.y, by);
    for (int c = 0, r = 0; c < code->controller_count; ++c)
        for (int i = 0; i < code->controller[c].rule_count; ++i, ++r) {
            const gic_rule *rule = &code->controller[c].rule[i];
            if (!((int)doing[r] & SAMPLE_EFFECT))
                continue;
            by[rule->state + rule->waiting] += by[rule->state];
            by[rule->state] = 0;
        }
    if (status == GIC_OK && weight != 0) {
        status = rate_back(back, seen, back->sum, weight, NULL);
        adjoint_add(run->states, 1, run->linear->along.y, by);
    }
    return status;
}

/* Number j of a movement: its coefficients, then its end. */
enum { MOVEMENT_NUMBERS = 9 };

static double *movement_number(Movement *m, int j)
{
    return j < MOVEMENT_NUMBERS - 1 ? &m->c[j] : &m->end;
}

void drive_inputs_back(Back *back, double time, const double *by, const Knot *knot)
{
    Movement *present[DRIVE_MOVEMENTS];
    int input[DRIVE_MOVEMENTS];
    tangent_drive(back->run, present, input);
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m)
        for (int j = 0; input[m] >= 0 && j < MOVEMENT_NUMBERS; ++j) {
            Movement unit = {.start = present[m]->start, .duration = present[m]->duration};
            double out[4], bent[3][4];
            *movement_number(&unit, j) = 1;
            movement_at(&unit, time, out);
            const double near = knot ? knot->step / 16 : 0;
            for (int i = 0; knot && i < 3; ++i)
                movement_at(&unit, knot->time + (i - 1) * near, bent[i]);
            for (int i = 0; i < tangent_drive_orders(back->run, m); ++i) {
                const double bend = knot ? knot->step / near * (bent[0][i] - 2 * bent[1][i] + bent[2][i]) : 0;
                *movement_number(&back->drive.movement[m], j) += (out[i] + bend) * by[input[m] + i];
            }
        }
}

void drive_look_back(Back *back, const TrailEvent *look)
{
    const TangentRun *run = back->run;
    const int half = run->code->slow_count / 2, seen = DRIVE_SEEN + DRIVE_SUMS;
    const double *slope = look->number + run->states;
    double by_result[DRIVE_RESULTS], by_seen[DRIVE_SEEN + DRIVE_SUMS] = {0};
    Movement *present[DRIVE_MOVEMENTS], old[DRIVE_MOVEMENTS];
    int input[DRIVE_MOVEMENTS];
    memcpy(old, slope + DRIVE_RESULTS * seen, sizeof old);
    tangent_drive(run, present, input);
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m) {
        Movement *by_after = &back->drive.movement[m], by_before = {0};
        by_result[m] = 0;
        for (int j = 0; input[m] >= 0 && j <= MOVEMENT_NUMBERS; ++j) { /* the last one: where it is to go */
            Movement unit = {.start = old[m].start, .duration = old[m].duration};
            double sum = 0;
            if (j < MOVEMENT_NUMBERS)
                *movement_number(&unit, j) = 1;
            movement_turn(&unit, look->time, j == MOVEMENT_NUMBERS, present[m]->duration);
            for (int i = 0; i < MOVEMENT_NUMBERS; ++i)
                sum += *movement_number(&unit, i) * *movement_number(by_after, i);
            if (j < MOVEMENT_NUMBERS)
                *movement_number(&by_before, j) = sum;
            else
                by_result[m] = sum;
        }
        *by_after = by_before;
        *present[m] = old[m];
    }
    memcpy(by_result + DRIVE_MOVEMENTS, back->drive.sum, sizeof back->drive.sum);
    for (int r = 0; r < DRIVE_RESULTS; ++r)
        for (int i = 0; i < seen; ++i)
            by_seen[i] += by_result[r] * slope[r * seen + i];
    adjoint_add(7, 1, by_seen, back->state);
    adjoint_add(DRIVE_SEEN - 7, 1, by_seen + 7, back->state + half + 1);
    memcpy(back->drive.sum, by_seen + DRIVE_SEEN, sizeof back->drive.sum);
}
