/* SPDX-License-Identifier: MIT
 * Random steering: gain, phase and coherence of what follows, after Welch. The steering is a sum of many sines of the
 * same size with random phases. */
#include "host/host.h"
#include "run/manoeuvre.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_fft_real.h>
#include <gsl/gsl_rng.h>

static const double pi = 3.141592653589793;
static const double begin = 4, fade = 2; /* s straight ahead; in which it begins and ends */
static const double lowest = 0.1;        /* Hz */
static const double peak = 4;            /* largest values over the rms that are reckoned with */
enum { SEGMENT = 2048, LINES = SEGMENT / 2, BESIDE = 1, CHANNELS = 6 };

static const Channel followed[CHANNELS] = {TRIAL_YAW_RATE, TRIAL_AY,      TRIAL_ROLL,
                                           TRIAL_SIDESLIP, TRIAL_LAST_AY, TRIAL_LAST_YAW_RATE};

/* ---- the steering --------------------------------------------------------------------------------------- */

typedef struct Noise {
    int count;
    double *frequency, *phase, duration;
} Noise;

static Noise noise_of(Manoeuvre *m)
{
    const double to = m->value[2], duration = m->value[3], apart = 1 / duration;
    Noise noise = {.count = (int)floor((to - lowest) / apart) + 1, .duration = duration};
    const size_t size = (size_t)noise.count * sizeof(double);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!random)
        diag_fail(program_place(), NULL, "no memory for random numbers");
    gsl_rng_set(random, (unsigned long)m->value[4] + 1); /* 0 would stand for another seed */
    noise.frequency = pool_alloc(m->pool, size);
    noise.phase = pool_alloc(m->pool, size);
    for (int k = 0; k < noise.count; ++k) {
        noise.frequency[k] = lowest + k * apart;
        noise.phase[k] = 2 * pi * gsl_rng_uniform(random);
    }
    gsl_rng_free(random);
    return noise;
}

static double smooth(double s)
{
    s = fmin(fmax(s, 0), 1);
    return s * s * s * (10 - 15 * s + 6 * s * s);
}

/* Of rms 1. */
static double wave(const void *context, double time)
{
    const Noise *noise = context;
    const double t = time - begin;
    double sum = 0;
    for (int k = 0; k < noise->count; ++k)
        sum += cos(2 * pi * noise->frequency[k] * t + noise->phase[k]);
    return sum * sqrt(2.0 / noise->count) * smooth(t / fade) * smooth((noise->duration - t) / fade);
}

/* ---- spectra after Welch: segments half over each other, without their means, under a Hann window -------- */

typedef struct Spectra {
    double apart;           /* Hz between lines */
    double steering[LINES]; /* density of the steer angle */
    double power[CHANNELS][LINES], cross[CHANNELS][LINES][2];
} Spectra;

static void transform(const Trial *trial, Channel channel, int from, double x[SEGMENT])
{
    double mean = 0;
    for (int i = 0; i < SEGMENT; ++i)
        mean += trial->row[from + i][channel] / SEGMENT;
    for (int i = 0; i < SEGMENT; ++i)
        x[i] = (trial->row[from + i][channel] - mean) * pow(sin(pi * i / SEGMENT), 2);
    gsl_fft_real_radix2_transform(x, 1, SEGMENT);
}

/* From the time after the fade on. */
static Spectra *spectra_of(Manoeuvre *m, const Trial *trial)
{
    Spectra *s = pool_alloc(m->pool, sizeof *s);
    double x[SEGMENT], y[SEGMENT];
    int first = 0;
    memset(s, 0, sizeof *s);
    s->apart = 1 / (SEGMENT * m->car->output_step);
    while (first < trial->rows && trial->row[first][TRIAL_TIME] < begin + fade)
        ++first;
    for (int from = first; from + SEGMENT <= trial->rows; from += SEGMENT / 2) {
        transform(trial, TRIAL_ANGLE, from, x);
        for (int k = 1; k < LINES; ++k)
            s->steering[k] += x[k] * x[k] + x[SEGMENT - k] * x[SEGMENT - k];
        for (int c = 0; c < CHANNELS; ++c) {
            transform(trial, followed[c], from, y);
            for (int k = 1; k < LINES; ++k) {
                const double *re = &x[k], *im = &x[SEGMENT - k];
                s->power[c][k] += y[k] * y[k] + y[SEGMENT - k] * y[SEGMENT - k];
                s->cross[c][k][0] += *re * y[k] + *im * y[SEGMENT - k];
                s->cross[c][k][1] += *re * y[SEGMENT - k] - *im * y[k];
            }
        }
    }
    return s;
}

/* H = sum X* Y / sum X* X over the lines beside a frequency, each weighted by its nearness. */
static Response response_at(const void *context, Channel channel, double frequency)
{
    const Spectra *s = context;
    const int middle = (int)floor(frequency / s->apart);
    double xx = 0, yy = 0, xy[2] = {0};
    int c = 0;
    while (followed[c] != channel)
        ++c;
    for (int k = middle - BESIDE; k <= middle + BESIDE + 1; ++k) {
        const double weight = 1 - fabs(frequency / s->apart - k) / (BESIDE + 1);
        if (k < 1 || k >= LINES || weight <= 0)
            continue;
        xx += weight * s->steering[k];
        yy += weight * s->power[c][k];
        xy[0] += weight * s->cross[c][k][0];
        xy[1] += weight * s->cross[c][k][1];
    }
    const double size = hypot(xy[0], xy[1]);
    return (Response){size / xx, atan2(xy[1], xy[0]), size * size / (xx * yy)};
}

void manoeuvre_random(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double to = m->value[2], duration = m->value[3];
    manoeuvre_begin(m);
    const double wanted = manoeuvre_linear_angle(m);
    const double angle = fmin(wanted, 0.999 / peak * fmin(-car->range[0], car->range[1]));
    const Noise noise = noise_of(m);
    const char *more = manoeuvre_steering(m, begin, begin + duration, 1 / (16 * to), angle, wave, &noise);
    const Trial *trial =
        trial_run(car, "random", car_scene(car, begin + duration, m->value[0], true, more), NULL, NULL);
    manoeuvre_whole(m, trial, pool_print(m->pool, "ask for less: ay=%.2g", 0.5 * m->value[1]));
    manoeuvre_keep(m, trial);
    if (angle < wanted)
        sheet_note(m->result, pool_print(m->pool, "the range of the steering allows %.3g of the steering asked for",
                                         angle / wanted));
    sheet_add(m->result, "Steering", "steer_angle", "Steer angle, rms", "rad", angle);
    manoeuvre_responses(m, response_at, spectra_of(m, trial), to);
}
