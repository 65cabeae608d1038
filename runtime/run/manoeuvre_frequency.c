/* SPDX-License-Identifier: MIT
 * Frequency response: steering by a sine whose frequency grows, gain, phase and coherence of what follows. The record
 * begins and ends in the same straight motion, so that ratios of its Fourier sums are the response, without windows. */
#include "run/manoeuvre.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double begin = 4, rest = 4; /* s straight ahead before it and after it */
static const double first = 0.1;         /* Hz, where it begins; it ends 15 % above the highest that is asked for */
static const double above = 1.15;
static const double table[] = {0.2, 0.5, 1, 1.5, 2, 2.5, 3}; /* Hz in the table */
enum { BESIDE = 3, CURVE = 60 };                             /* lines of the spectrum to each side; points of a curve */

/* Fourier sum of a channel at a frequency, from its value straight ahead. */
static void fourier(const Trial *trial, Channel channel, double frequency, double out[2])
{
    const double straight = trial_mean(trial, channel, begin - 1, begin);
    out[0] = out[1] = 0;
    for (int i = 0; i < trial->rows; ++i) {
        const double at = trial->row[i][TRIAL_TIME], turn = 2 * pi * frequency * at;
        if (at < begin)
            continue;
        out[0] += (trial->row[i][channel] - straight) * cos(turn);
        out[1] -= (trial->row[i][channel] - straight) * sin(turn);
    }
}

/* A record and its length from `begin` on, s. */
typedef struct Record {
    const Trial *trial;
    double duration;
} Record;

/* Of lines 1 / duration apart beside a frequency: H = sum X* Y / sum X* X. */
static Response response_at(const void *context, Channel channel, double frequency)
{
    const Record *record = context;
    const Trial *trial = record->trial;
    const double duration = record->duration;
    double xx = 0, yy = 0, xy[2] = {0};
    for (int k = -BESIDE; k <= BESIDE; ++k) {
        double x[2], y[2];
        fourier(trial, TRIAL_ANGLE, frequency + k / duration, x);
        fourier(trial, channel, frequency + k / duration, y);
        xx += x[0] * x[0] + x[1] * x[1];
        yy += y[0] * y[0] + y[1] * y[1];
        xy[0] += x[0] * y[0] + x[1] * y[1];
        xy[1] += x[0] * y[1] - x[1] * y[0];
    }
    const double size = hypot(xy[0], xy[1]);
    return (Response){size / xx, atan2(xy[1], xy[0]), size * size / (xx * yy)};
}

/* The responses of a run, and beside them those of the linear model, whose context may be NULL: there is none. */
typedef struct Responding {
    RespondAt *at, *linear_at;
    const void *context, *linear;
} Responding;

static Response by_linear(const Responding *of, Channel channel, double frequency)
{
    return of->linear ? of->linear_at(of->linear, channel, frequency) : (Response){NAN, NAN, NAN};
}

static void add_channel(Manoeuvre *m, const Responding *of, double to, Channel channel, const char *name,
                        const char *title, const char *unit)
{
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i) {
        const double f = table[i];
        if (f > to)
            break;
        const Response r = of->at(of->context, channel, f);
        const char *at = pool_print(m->pool, "%s.at_%g", name, f);
        sheet_add(m->result, i ? NULL : title, pool_print(m->pool, "%s.gain", at),
                  pool_print(m->pool, "Gain at %g Hz", f), unit, r.gain);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.phase", at), pool_print(m->pool, "Phase at %g Hz", f), "rad",
                  r.phase);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.coherence", at),
                  pool_print(m->pool, "Coherence at %g Hz", f), "1", r.coherence);
        const Response l = by_linear(of, channel, f);
        if (isnan(l.gain))
            continue;
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.linear.gain", at),
                  pool_print(m->pool, "Gain at %g Hz by the linear model", f), unit, l.gain);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.linear.phase", at),
                  pool_print(m->pool, "Phase at %g Hz by the linear model", f), "rad", l.phase);
    }
}

/* Gain and phase over frequency, unwrapped, and the frequencies of the largest gain and of a phase of -45 degrees. */
static void add_curves(Manoeuvre *m, const Responding *of, double to, Channel channel, const char *name,
                       const char *title, const char *unit)
{
    enum { CURVES = 2 };
    double *x = pool_alloc(m->pool, CURVE * sizeof *x), *gain = pool_alloc(m->pool, CURVES * CURVE * sizeof *gain);
    double *phase = pool_alloc(m->pool, CURVE * sizeof *phase);
    double *shown = pool_alloc(m->pool, CURVES * CURVE * sizeof *shown);
    int most = 0;
    double lag = NAN;
    for (int i = 0; i < CURVE; ++i) {
        x[i] = table[0] + (to - table[0]) * i / (CURVE - 1);
        const Response r = of->at(of->context, channel, x[i]);
        gain[i] = r.gain;
        phase[i] = i ? phase[i - 1] + remainder(r.phase - phase[i - 1], 2 * pi) : r.phase;
        shown[i] = phase[i] * 180 / pi;
        const Response l = by_linear(of, channel, x[i]);
        gain[CURVE + i] = l.gain; /* its phase is drawn beside that of the run, whatever whole turns are between */
        shown[CURVE + i] = shown[i] + remainder(l.phase - phase[i], 2 * pi) * 180 / pi;
        most = gain[i] > gain[most] ? i : most;
        if (isnan(lag) && i && phase[i] <= -pi / 4 && phase[i - 1] > -pi / 4)
            lag = x[i - 1] + (x[i] - x[i - 1]) * (-pi / 4 - phase[i - 1]) / (phase[i] - phase[i - 1]);
    }
    if (most > 0 && most < CURVE - 1)
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.peak_frequency", name), "Frequency of the largest gain",
                  "Hz", x[most]);
    if (!isnan(lag))
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.lag_frequency", name), "Frequency of a phase of -45 deg",
                  "Hz", lag);
    *POOL_PUSH(m->pool, m->table, m->tables) = (ManoeuvreTable){title, unit, "frequency, Hz", CURVE, CURVES, x, gain};
    *POOL_PUSH(m->pool, m->table, m->tables) =
        (ManoeuvreTable){pool_print(m->pool, "%s: phase", title), "deg", "frequency, Hz", CURVE, CURVES, x, shown};
}

/* ---- the last unit by the first one ---------------------------------------------------------------------- */

/* The response of a channel of the last unit by that of the first one, from those of both by steering. */
static Response over_first(RespondAt *at, const void *context, Channel channel, double frequency)
{
    const Channel of_first = channel == TRIAL_LAST_AY ? TRIAL_AY : TRIAL_YAW_RATE;
    const Response behind = at(context, channel, frequency), ahead = at(context, of_first, frequency);
    return (Response){behind.gain / ahead.gain, remainder(behind.phase - ahead.phase, 2 * pi),
                      fmin(behind.coherence, ahead.coherence)};
}

static Response rearward_at(const void *context, Channel channel, double frequency)
{
    const Responding *by_steering = context;
    return over_first(by_steering->at, by_steering->context, channel, frequency);
}

static Response linear_rearward_at(const void *context, Channel channel, double frequency)
{
    const Responding *by_steering = context;
    return over_first(by_steering->linear_at, by_steering->linear, channel, frequency);
}

static void add_rearward(Manoeuvre *m, const Responding *by_steering, double to)
{
    static const struct {
        Channel channel;
        const char *name, *title;
    } of[] = {{TRIAL_LAST_AY, "rearward.ay", "Lateral acceleration, last unit by the first"},
              {TRIAL_LAST_YAW_RATE, "rearward.yaw_rate", "Yaw rate, last unit by the first"}};
    const Responding ratio = {rearward_at, linear_rearward_at, by_steering, by_steering->linear ? by_steering : NULL};
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        add_channel(m, &ratio, to, of[i].channel, of[i].name, of[i].title, "1");
        add_curves(m, &ratio, to, of[i].channel, of[i].name, of[i].title, "1");
        const double *gain = m->table[m->tables - 2].y;
        double most = 0;
        for (int k = 0; k < CURVE; ++k)
            most = fmax(most, gain[k]);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.peak", of[i].name), "Largest gain", "1", most);
    }
}

void manoeuvre_responses(Manoeuvre *m, RespondAt *at, const void *context, double to)
{
    static const struct {
        Channel channel;
        const char *title, *unit;
    } of[] = {{TRIAL_YAW_RATE, "Yaw rate by the steer angle", "1/s"},
              {TRIAL_AY, "Lateral acceleration by the steer angle", "m/(s^2 rad)"},
              {TRIAL_ROLL, "Roll angle by the steer angle", "1"},
              {TRIAL_SIDESLIP, "Side slip by the steer angle", "1"}};
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_AY, TRIAL_SPEED};
    const Responding by_steering = {at, linear_response_at, context, linear_response(m->car, m->value[0])};
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        const char *name = trial_signal[of[i].channel].name;
        add_channel(m, &by_steering, to, of[i].channel, name, of[i].title, of[i].unit);
        add_curves(m, &by_steering, to, of[i].channel, name, of[i].title, of[i].unit);
    }
    if (manoeuvre_has_units(m))
        add_rearward(m, &by_steering, to);
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}

double manoeuvre_angle_by_acceleration(Manoeuvre *m)
{
    const TestCar *car = m->car;
    const double by_ay = car_angle_by_acceleration(car, m->value[0]);
    if (isnan(by_ay))
        car_refuse(car, "choose a lower speed",
                   pool_print(m->pool,
                              "there is no steady response to steering at %.4g m/s: "
                              "the vehicle is not stable straight ahead",
                              m->value[0]));
    return by_ay;
}

double manoeuvre_linear_angle(Manoeuvre *m)
{
    return m->value[1] * manoeuvre_angle_by_acceleration(m);
}

void manoeuvre_frequency(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double speed = m->value[0], duration = m->value[3];
    manoeuvre_begin(m);
    const double angle = fmin(manoeuvre_linear_angle(m), 0.999 * fmin(-car->range[0], car->range[1]));
    const char *more = pool_print(
        m->pool,
        "inputs:\n  %s: {chirp: {amplitude: %.17g, from: %g, to: %.9g, duration: %.9g, growth: logarithmic, "
        "start: %g}}\n",
        car->model->input[car->steering].name, angle / car->angle, first, above * m->value[2], duration, begin);
    const Trial *trial =
        trial_run(car, "chirp", car_scene(car, begin + duration + rest, speed, true, more), NULL, NULL);
    manoeuvre_whole(m, trial, pool_print(m->pool, "ask for less: ay=%.2g", 0.5 * m->value[1]));
    manoeuvre_keep(m, trial);
    manoeuvre_responses(m, response_at, &(Record){trial, duration + rest}, m->value[2]);
}
