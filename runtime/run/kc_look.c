/* SPDX-License-Identifier: MIT
 * A position of the mechanism, with derivatives by the coordinates of an axle, and what follows these. Poses are
 * differentiated by a coordinate; velocities, which are linear in the rates, by its rate; and velocities at given rates
 * by a coordinate: that is the second derivative of the poses. All in dual numbers. */
#include "gic_runtime.h"
#include "run/kc.h"
#include "tape/engine_tape.h"

#include <string.h>

KcLook *kc_look_new(const Kc *kc, const KcAxle *axle)
{
    KcLook *look = pool_alloc(kc->pool, sizeof *look);
    look->outputs = kc->outputs;
    for (int i = 0; i < axle->wheels; ++i)
        look->column[look->columns++] = axle->travel[i];
    if (axle->steer >= 0)
        look->column[look->columns++] = axle->steer;
    if (axle->preload) {
        look->axle = axle;
        look->whole = kc_look_new(kc, &(KcAxle){.steer = -1});
        for (int i = 0; i < axle->wheels; ++i)
            look->whole->column[look->whole->columns++] = axle->travel[i];
        for (int i = 0; i < axle->followers; ++i)
            look->whole->column[look->whole->columns++] = axle->follower[i];
        if (axle->steer >= 0)
            look->whole->column[look->whole->columns++] = axle->steer;
        const size_t room = (size_t)look->whole->columns * sizeof(double);
        look->whole->slope = pool_alloc(kc->pool, ((size_t)kc->outputs + 1) * room);
        look->follow = pool_alloc(kc->pool, (size_t)axle->wheels * room);
        look->relax = pool_alloc(kc->pool, room);
        look->bend = pool_alloc(kc->pool, (size_t)axle->wheels * room);
    }
    look->value = pool_alloc(kc->pool, ((size_t)kc->outputs + 1) * sizeof(double));
    look->slope = pool_alloc(kc->pool, ((size_t)kc->outputs * (size_t)look->columns + 1) * sizeof(double));
    return look;
}

/* Places and rates of the coordinates into the working instance; the last good position stays where it was found. */
static void put(const Kc *kc, const double *w, const KcLook *look, const double *along)
{
    const gic_model *code = kc->engine->code;
    double *state = tape_array(kc->work, code->state_offset), *input = tape_array(kc->work, code->input_offset);
    for (int c = 0; c < code->coordinate_count; ++c) {
        double *at =
            code->coordinate_state[c] >= 0 ? state + code->coordinate_state[c] : input + code->coordinate_input[c];
        double *rate = at + (code->coordinate_state[c] >= 0 ? code->slow_count / 2 : 1);
        *at = w[c];
        *rate = 0;
        if (code->coordinate_input[c] >= 0)
            rate[1] = 0;
        for (int k = 0; k < look->columns && along; ++k)
            if (look->column[k] == c)
                *rate = along[k];
    }
}

static int start(const Kc *kc)
{
    const int status = linear_start(kc->linear, kc->work, kc->f);
    return status == GIC_OK ? kc->engine->code->outputs(kc->work) : status;
}

/* The number of a coordinate's place, or rate, of its kind. */
static int number_of(const Kc *kc, int coordinate, bool rate, LinearKind *kind)
{
    const gic_model *code = kc->engine->code;
    if (code->coordinate_state[coordinate] < 0) {
        *kind = LINEAR_INPUT;
        return code->coordinate_input[coordinate] + rate;
    }
    *kind = LINEAR_MOTION;
    return code->coordinate_state[coordinate] - code->free_base + (rate ? kc->linear->places : 0);
}

/* kc->dout: derivatives of all outputs by a coordinate or its rate. */
static int differentiate(const Kc *kc, int coordinate, bool rate)
{
    LinearKind kind;
    bool jump;
    const int number = number_of(kc, coordinate, rate, &kind);
    return linear_column(kc->linear, kc->work, kind, number, kc->df, kc->outputs, kc->dout, &jump);
}

/* Is an output a velocity, an angular velocity, or the rate of a length or angle? */
static bool is_rate(const Kc *kc, int at)
{
    for (int i = 0; i < kc->elements; ++i)
        if (kc->element[i].rate == at)
            return true;
    for (int i = 0; i < kc->model->outputs; ++i) {
        const Output *output = &kc->model->output[i];
        if (at < output->count)
            return output->type == OUTPUT_VELOCITY || output->type == OUTPUT_ANGULAR_VELOCITY;
        at -= output->count;
    }
    return false;
}

/* Columns of travel with what follows, from those by themselves. */
static int look_with_followers(const Kc *kc, const double *w, KcLook *look)
{
    const KcLook *whole = look->whole;
    const int wheels = look->axle->wheels, followers = look->axle->followers;
    int status = kc_look(kc, w, look->whole);
    if (status == GIC_OK)
        status = kc_follow(kc, look);
    memcpy(look->value, whole->value, (size_t)kc->outputs * sizeof(double));
    for (int k = 0; k < look->columns && status == GIC_OK; ++k)
        for (int i = 0; i < kc->outputs; ++i) {
            double sum = whole->slope[(k < wheels ? k : k + followers) * kc->outputs + i];
            for (int j = 0; j < followers && k < wheels; ++j)
                sum += look->follow[k * followers + j] * whole->slope[(wheels + j) * kc->outputs + i];
            look->slope[k * kc->outputs + i] = sum;
        }
    return status;
}

double kc_element_slope(const KcElement *element, const KcLook *look, int column)
{
    if (element->coordinate < 0)
        return look->slope[column * look->outputs + element->rate];
    for (int j = 0; look->axle && j < look->axle->followers && column < look->axle->wheels; ++j)
        if (element->coordinate == look->axle->follower[j])
            return look->follow[column * look->axle->followers + j];
    return element->coordinate == look->column[column];
}

double kc_element_bend(const KcElement *element, const KcLook *look, const double *second, int column)
{
    if (element->coordinate < 0)
        return second[column * look->outputs + element->rate];
    for (int j = 0; look->axle && j < look->axle->followers && column < look->axle->wheels; ++j)
        if (element->coordinate == look->axle->follower[j])
            return look->bend[column * look->axle->followers + j];
    return 0;
}

void kc_move(const KcLook *look, const double *along, double step, double *w)
{
    for (int k = 0; k < look->columns; ++k) {
        w[look->column[k]] += step * along[k];
        for (int j = 0; look->axle && j < look->axle->followers && k < look->axle->wheels; ++j)
            w[look->axle->follower[j]] += step * along[k] * look->follow[k * look->axle->followers + j];
    }
}

int kc_look(const Kc *kc, const double *w, KcLook *look)
{
    if (look->axle)
        return look_with_followers(kc, w, look);
    const gic_model *code = kc->engine->code;
    memcpy(kc->work, kc->self, code->size);
    put(kc, w, look, NULL);
    int status = start(kc);
    if (status == GIC_OK)
        memcpy(look->value, tape_array(kc->work, code->output_offset), (size_t)kc->outputs * sizeof(double));
    for (int k = 0; k < look->columns && status == GIC_OK; ++k)
        for (int rate = 0; rate < 2 && status == GIC_OK; ++rate) {
            status = differentiate(kc, look->column[k], rate);
            for (int i = 0; i < kc->outputs; ++i)
                if (is_rate(kc, i) == rate)
                    look->slope[k * kc->outputs + i] = kc->dout[i];
        }
    return status;
}

/* A column moves with the coordinates that follow it, whose rates change along the motion. */
static int second_with_followers(const Kc *kc, const double *w, KcLook *look, const double *along, double *second)
{
    KcLook *whole = look->whole;
    const int wheels = look->axle->wheels, followers = look->axle->followers, outputs = kc->outputs;
    double *each = pool_alloc(kc->pool, (size_t)whole->columns * (size_t)outputs * sizeof *each),
           rate[KC_COLUMNS] = {0};
    for (int k = 0; k < look->columns; ++k) {
        rate[k < wheels ? k : k + followers] = along[k];
        for (int j = 0; j < followers && k < wheels; ++j)
            rate[wheels + j] += along[k] * look->follow[k * followers + j];
    }
    int status = kc_look_second(kc, w, whole, rate, each);
    if (status == GIC_OK)
        status = kc_follow_second(kc, look, rate, each);
    for (int k = 0; k < look->columns && status == GIC_OK; ++k)
        for (int i = 0; i < outputs; ++i) {
            double sum = each[(k < wheels ? k : k + followers) * outputs + i];
            for (int j = 0; j < followers && k < wheels; ++j)
                sum += look->follow[k * followers + j] * each[(wheels + j) * outputs + i] +
                       look->bend[k * followers + j] * whole->slope[(wheels + j) * outputs + i];
            second[k * outputs + i] = sum;
        }
    return status;
}

int kc_look_second(const Kc *kc, const double *w, KcLook *look, const double *along, double *second)
{
    if (look->axle)
        return second_with_followers(kc, w, look, along, second);
    memcpy(kc->work, kc->self, kc->engine->code->size);
    put(kc, w, look, along);
    int status = start(kc);
    for (int k = 0; k < look->columns && status == GIC_OK; ++k) {
        status = differentiate(kc, look->column[k], false);
        memcpy(second + k * kc->outputs, kc->dout, (size_t)kc->outputs * sizeof(double));
    }
    return status;
}

const char *kc_status(const Kc *kc, int status)
{
    return instance_status(kc->pool, kc->engine->code, &kc->work->head, status);
}
