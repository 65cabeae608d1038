/* SPDX-License-Identifier: MIT
 * states DUMP --count N --seed S [--nice] [-o STATES]
 *
 * Random candidates for `gicrun --eval` and `reference`: coordinates uniform in their ranges; base anywhere within
 * 100 m, its height within 0.3 m of design so that tires touch in some rows and not in others; every orientation in
 * even rows, every yaw with small roll and pitch in odd ones. Of a model with wheels that roll, every second odd row
 * has its tires near the road, every fourth row is slow and every sixteenth stands still with nothing wound up; slips
 * are small in most rows and far beyond all ranges in others, wheels spin either way, inputs go up to 1 beside their
 * defaults.
 *
 * With --nice half of all numbers are such as people write: quarter and half turns of angles and of the base, 10 and
 * 1000 whole turns more, coordinates at the design or an end of their range, rates 0, 1 and -1, a base that stands
 * upside down, at the origin, or still. */
#include "reference/dump.h"
#include "reference/support.h"
#include "reference/wheel.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "usage: states DUMP --count N --seed S [--nice] [-o STATES]\n";

static const double full_turn = 6.283185307179586;

/* xorshift64*, not shared with the generator */
static double uniform(uint64_t *state, double low, double high)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return low + (high - low) * ((double)(*state * 0x2545f4914f6cdd1du >> 11) * 0x1p-53);
}

/* A vector of random direction and random length up to `longest`. */
static void direction(uint64_t *random, double longest, double out[3])
{
    double z = uniform(random, -1, 1), angle = uniform(random, 0, full_turn), length = uniform(random, 0, longest);
    out[0] = length * sqrt(1 - z * z) * cos(angle);
    out[1] = length * sqrt(1 - z * z) * sin(angle);
    out[2] = length * z;
}

/* p = p turned by `angle` about the world's axis x, y or z */
static void turn(double p[4], int axis, double angle)
{
    double c = cos(angle / 2), s = sin(angle / 2), out[4];
    int i = 1 + axis, j = 1 + (axis + 1) % 3, k = 1 + (axis + 2) % 3;
    out[0] = c * p[0] - s * p[i];
    out[i] = c * p[i] + s * p[0];
    out[j] = c * p[j] - s * p[k];
    out[k] = c * p[k] + s * p[j];
    memcpy(p, out, sizeof out);
}

/* Uniform over all orientations (Shoemake's three random numbers). */
static void any_orientation(uint64_t *random, double p[4])
{
    double share = uniform(random, 0, 1), a = uniform(random, 0, full_turn), b = uniform(random, 0, full_turn);
    p[0] = sqrt(1 - share) * cos(a);
    p[1] = sqrt(1 - share) * sin(a);
    p[2] = sqrt(share) * cos(b);
    p[3] = sqrt(share) * sin(b);
}

/* How a row of a model with wheels that roll moves. */
enum { FAST_ROW, SLOW_ROW, STILL_ROW };

static int motion_of(const Model *model, int row)
{
    return !model->tires || row % 4 != 3 ? FAST_ROW : row % 16 != 15 ? SLOW_ROW : STILL_ROW;
}

/* ---- numbers that people write ---- */

static double any_of(uint64_t *random, const double *x, int count)
{
    return x[(int)uniform(random, 0, count)];
}

/* A fourth of all rows is nice throughout, a fourth is not at all. */
static bool is_nice(uint64_t *random, int row)
{
    static const double share[] = {1, 0.5, 0.5, 0};
    return uniform(random, 0, 1) < share[row % 4];
}

/* -1, 0 or 1 times `size`, or what is given. */
static double nice_rate(uint64_t *random, int row, double size, double other)
{
    static const double nice[] = {0, 0, 1, -1};
    return is_nice(random, row) ? size * any_of(random, nice, 4) : other;
}

static void write_nice_base(FILE *out, const Model *model, uint64_t *random, int row)
{
    static const double axis[] = {0, 1, 2}, quarters[] = {1, 2, 3, -1};
    double p[4];
    memcpy(p, model->body[0].euler, sizeof p);
    if (!is_nice(random, row))
        any_orientation(random, p);
    for (int i = 0; i < 2; ++i)
        if (uniform(random, 0, 1) < 0.7) {
            int about = (int)any_of(random, axis, 3);
            turn(p, about, any_of(random, quarters, 4) * full_turn / 4);
        }
    for (int i = 0; i < 3; ++i)
        fprintf(out, "%.17g,", nice_rate(random, row, 1, uniform(random, -100, 100)));
    fprintf(out, "%.17g,%.17g,%.17g,%.17g,", p[0], p[1], p[2], p[3]);
    for (int i = 0; i < 6; ++i)
        fprintf(out, "%.17g,", nice_rate(random, row, 1, i < 3 ? uniform(random, -20, 20) : uniform(random, -2, 2)));
}

/* True for models in which whole turns move something: not many are gone at once. */
static bool is_geared(const Model *model)
{
    bool geared = false;
    for (int j = 0; j < model->joints; ++j)
        geared = geared || (model->joint[j].type >= SCREW && model->joint[j].type <= COUPLED);
    return geared;
}

static double nice_value(uint64_t *random, const Coordinate *coordinate, int row, bool geared)
{
    static const double quarters[] = {0, 1, 2, 3, -1, -2}, far[] = {0, 0, 0, 0, 10, -10, 1000, -1000};
    const double at[] = {coordinate->design, coordinate->range[0], coordinate->range[1]};
    double w = uniform(random, coordinate->range[0], coordinate->range[1]);
    if (coordinate->type != ANGLE)
        return is_nice(random, row) ? any_of(random, at, 3) : w;
    double width = coordinate->range[1] - coordinate->range[0];
    /* only of what may turn at all */
    if (!(width > full_turn))
        return is_nice(random, row) ? any_of(random, at, 3) : w;
    if (is_nice(random, row))
        w = coordinate->design + any_of(random, quarters, 6) * full_turn / 4;
    return geared ? w : w + full_turn * any_of(random, far, row % 2 ? 8 : 4);
}

static void write_base(FILE *out, const Model *model, uint64_t *random, int row)
{
    static const double speed[] = {30, 0.5, 0}, turning[] = {2, 0.1, 0};
    double v[3], omega[3], p[4], high = model->tires && row % 4 == 1 ? 0.05 : 0.3;
    int motion = motion_of(model, row);
    memcpy(p, model->body[0].euler, sizeof p);
    if (row % 2 == 0) {
        any_orientation(random, p);
    } else {
        for (int axis = 0; axis < 3; ++axis)
            turn(p, axis, axis == 2 ? uniform(random, 0, full_turn) : uniform(random, -0.1, 0.1));
    }
    fprintf(out, "%.17g,", uniform(random, -100, 100));
    fprintf(out, "%.17g,", uniform(random, -100, 100));
    fprintf(out, "%.17g,", model->body[0].position[2] + uniform(random, -high, high));
    direction(random, speed[motion], v);
    direction(random, turning[motion], omega);
    fprintf(out, "%.17g,%.17g,%.17g,%.17g,", p[0], p[1], p[2], p[3]);
    fprintf(out, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,", v[0], v[1], v[2], omega[0], omega[1], omega[2]);
}

/* Small mostly, up to `most` at times. */
static double skewed(uint64_t *random, double most)
{
    double x = uniform(random, -1, 1);
    return most * x * x * x * x * x;
}

/* Returns the spin. */
static double write_wheel(FILE *out, const Wheel *wheel, uint64_t *random, int motion)
{
    double state[FAST_STATES] = {uniform(random, -80, 80), skewed(random, 6), skewed(random, 60),
                                 uniform(random, -1.3, 1.3)};
    for (int k = 0; k < FAST_STATES && motion == STILL_ROW; ++k)
        state[k] = 0;
    if (motion == SLOW_ROW)
        state[0] /= 60;
    for (int k = 0; k < FAST_STATES; ++k)
        if (wheel_has(wheel, k))
            fprintf(out, ",%.17g", state[k]);
    return state[0];
}

/* Turbine speed in the middle of a shift from one of the gears to the other, or behind it. */
static double turbine_speed(const Powertrain *p, const double *spin, const int gear[2], double share)
{
    double speed[p->differentials], ratio = 0;
    for (int k = 0; k < p->differentials; ++k) {
        const Differential *d = &p->differential[k];
        speed[k] = 0;
        for (int j = 0; j < d->outputs; ++j) {
            double part = d->outputs == 1 ? 1 : j == 0 ? d->split : 1 - d->split;
            speed[k] += d->ratio * part * (d->wheel[j] < 0 ? speed[d->differential[j]] : spin[d->wheel[j]]);
        }
    }
    for (int i = 0; i < 2; ++i)
        ratio += (i == 0 ? share : 1 - share) * p->gear[p->reverse + gear[i]];
    return ratio * speed[p->differentials - 1];
}

/* Gears, and a shift between them that has just begun, is under way, or is long over; the engine near the turbine's
 * speed, near idling, where it stalls, or anywhere up to beyond its limit. */
static void write_powertrain(FILE *out, const Powertrain *p, const double *spin, uint64_t *random, int row)
{
    double top = p->limit > 0 ? 1.1 * p->limit : 300, slow = p->idle > 0 ? 1.1 * p->idle : 30, speed;
    double age = uniform(random, 0, 1.3), share = fmin(age, 1);
    int gear[2];
    for (int i = 0; i < 2; ++i)
        gear[i] = (int)floor(uniform(random, 0, p->gears)) - p->reverse;
    if (row % 3 == 0)
        speed = uniform(random, 0.9, 1.1) * turbine_speed(p, spin, gear, share * share * (3 - 2 * share));
    else
        speed = row % 3 == 1 ? uniform(random, -0.1 * slow, slow) : uniform(random, 0, top);
    fprintf(out, ",%.17g,%.17g,%d,%d", speed, age * p->duration, gear[0], gear[1]);
}

/* Fast states, and inputs that are not those of driven coordinates. */
static void write_wheels(FILE *out, const Model *model, uint64_t *random, int row)
{
    double spin[model->wheels + 1];
    for (int i = 0; i < model->wheels; ++i)
        spin[i] = write_wheel(out, &model->wheel[i], random, motion_of(model, row));
    for (int i = model->driven_inputs; i < model->inputs && model->tires; ++i)
        fprintf(out, ",%.17g", model->input[i] + uniform(random, 0, 1));
    for (int i = 0; i < model->states; ++i)
        fprintf(out, ",%.17g", model->state[i] + uniform(random, -1, 1));
    if (model->powertrain)
        write_powertrain(out, model->powertrain, spin, random, row);
}

static void write_wheel_names(FILE *out, const Model *model)
{
    for (int i = 0; i < model->wheels; ++i)
        for (int k = 0; k < FAST_STATES; ++k)
            if (wheel_has(&model->wheel[i], k))
                fprintf(out, ",%s.%s", model->wheel[i].name, fast_name[k]);
    for (int i = model->driven_inputs; i < model->inputs && model->tires; ++i)
        fprintf(out, ",%s", model->input_name[i]);
    for (int i = 0; i < model->states; ++i)
        fprintf(out, ",%s", model->state_name[i]);
    if (model->powertrain)
        fputs(",engine.speed,transmission.age,transmission.gear,transmission.before", out);
}

static void write_states(FILE *out, const Model *model, int count, bool nice, uint64_t *random)
{
    if (model->free_base)
        fputs("r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z,", out);
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *coordinate = &model->coordinate[c];
        fprintf(out, "%s%s,%s.rate", c ? "," : "", coordinate->name, coordinate->name);
        if (coordinate->driven)
            fprintf(out, ",%s.acceleration", coordinate->name);
    }
    write_wheel_names(out, model);
    fputc('\n', out);
    for (int row = 0; row < count; ++row) {
        if (model->free_base)
            (nice ? write_nice_base : write_base)(out, model, random, row);
        for (int c = 0; c < model->coordinates; ++c) {
            const Coordinate *coordinate = &model->coordinate[c];
            double w = uniform(random, coordinate->range[0], coordinate->range[1]);
            double rate = motion_of(model, row) == STILL_ROW ? 0 : uniform(random, -1, 1);
            if (nice) {
                w = nice_value(random, coordinate, row, is_geared(model));
                rate = nice_rate(random, row, 1, rate);
            }
            fprintf(out, "%s%.17g,%.17g", c ? "," : "", w, rate);
            if (coordinate->driven)
                fprintf(out, ",%.17g", uniform(random, -5, 5));
        }
        write_wheels(out, model, random, row);
        fputc('\n', out);
    }
}

int main(int argc, char **argv)
{
    const char *path = NULL, *out_path = NULL;
    double count = 0, seed = -1;
    bool nice = false;
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--count") && i + 1 < argc) {
            count = number_of(argv[++i], "--count");
        } else if (!strcmp(argv[i], "--seed") && i + 1 < argc) {
            seed = number_of(argv[++i], "--seed");
        } else if (!strcmp(argv[i], "--nice")) {
            nice = true;
        } else if (!strcmp(argv[i], "-o") && i + 1 < argc) {
            out_path = argv[++i];
        } else if (argv[i][0] != '-' && !path) {
            path = argv[i];
        } else {
            fputs(usage, stderr);
            return 2;
        }
    }
    if (!path || !(count >= 1 && count <= 1e6) || !(seed >= 0 && seed < 0x1p53)) {
        fputs(usage, stderr);
        return 2;
    }
    /* any seed, zero too, becomes a state that is not zero */
    uint64_t random = ((uint64_t)seed + 1) * 0x9e3779b97f4a7c15u | 1;
    Model *model = model_read(path);
    FILE *out = output_open(out_path);
    write_states(out, model, (int)count, nice, &random);
    output_close(out, out_path);
    model_free(model);
    return 0;
}
