/* SPDX-License-Identifier: MIT
 * Ride: straight ahead on a random road. Spectral densities after Welch, accelerations weighted for people, loads of
 * tires that change. */
#include "gic_runtime.h"
#include "run/manoeuvre.h"
#include "run/ride_filter.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_fft_real.h>

static const double pi = 3.141592653589793;
static const double band[] = {0.5, 80}; /* Hz, of weighted accelerations */
const double ride_run_in = 5, ride_sampling = 0.005;

/* ---- spectral density after Welch ------------------------------------------------------------------------ */

/* Segments of SEGMENT samples, half over each other, each without its mean and under a Hann window. */
enum { SEGMENT = 1024, LINES = SEGMENT / 2 };

/* One-sided density of `count` samples, `ride_sampling` apart, at k / (SEGMENT ride_sampling) Hz for k from 0 to LINES
 * - 1. */
static void welch(int count, const double *sample, double density[LINES])
{
    double power = 0;
    int segments = 0;
    memset(density, 0, LINES * sizeof *density);
    for (int i = 0; i < SEGMENT; ++i)
        power += pow(sin(pi * i / SEGMENT), 4);
    for (int from = 0; from + SEGMENT <= count; from += SEGMENT / 2, ++segments) {
        double x[SEGMENT], mean = 0;
        for (int i = 0; i < SEGMENT; ++i)
            mean += sample[from + i] / SEGMENT;
        for (int i = 0; i < SEGMENT; ++i)
            x[i] = (sample[from + i] - mean) * pow(sin(pi * i / SEGMENT), 2);
        gsl_fft_real_radix2_transform(x, 1, SEGMENT);
        density[0] += x[0] * x[0];
        for (int k = 1; k < LINES; ++k)
            density[k] += 2 * (x[k] * x[k] + x[SEGMENT - k] * x[SEGMENT - k]);
    }
    for (int k = 0; k < LINES; ++k)
        density[k] *= segments ? ride_sampling / power / segments : 0;
}

/* Root of the sum of a density, weighted or not, over the band. */
static double band_rms(const double density[LINES], const RideWeight *weight)
{
    const double apart = 1 / (SEGMENT * ride_sampling);
    double sum = 0;
    for (int k = 1; k < LINES; ++k) {
        const double f = k * apart, w = weight ? ride_weight(*weight, f) : 1;
        if (f >= band[0] && f <= band[1])
            sum += w * w * density[k] * apart;
    }
    return sqrt(sum);
}

/* ---- the results ------------------------------------------------------------------------------------------ */

/* A curve of a density up to a frequency, in the logarithm of ten where people expect one. */
static void add_curve(Manoeuvre *m, const double density[LINES], const char *title, const char *unit)
{
    const double most = 25, apart = 1 / (SEGMENT * ride_sampling);
    const int rows = (int)(most / apart);
    double *x = pool_alloc(m->pool, (size_t)rows * sizeof *x), *y = pool_alloc(m->pool, (size_t)rows * sizeof *y);
    for (int k = 1; k <= rows; ++k) {
        x[k - 1] = k * apart;
        y[k - 1] = log10(density[k]);
    }
    *POOL_PUSH(m->pool, m->table, m->tables) =
        (ManoeuvreTable){pool_print(m->pool, "%s, log10 of the density", title), unit, "frequency, Hz", rows, 1, x, y};
}

/* A channel from ride_run_in on. */
static int samples(const Trial *trial, Channel channel, double *out)
{
    int n = 0;
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] >= ride_run_in)
            out[n++] = trial->row[i][channel];
    return n;
}

static const struct {
    Channel channel;
    RideWeight weight;
    const char *title;
} of[] = {{TRIAL_AX, RIDE_D, "Longitudinal"}, {TRIAL_AY, RIDE_D, "Lateral"}, {TRIAL_AZ, RIDE_K, "Vertical"}};

/* The root of the sum of the squares of the weighted accelerations; of one of them by its channel. */
static double total_of(const Manoeuvre *m, const Trial *trial, double weighted[TRIAL_CHANNELS])
{
    double density[LINES], total = 0;
    double *x = pool_alloc(m->pool, (size_t)trial->rows * sizeof *x);
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        welch(samples(trial, of[i].channel, x), x, density);
        weighted[of[i].channel] = band_rms(density, &of[i].weight);
        total += weighted[of[i].channel] * weighted[of[i].channel];
    }
    return sqrt(total);
}

static void add_accelerations(Manoeuvre *m, const Trial *trial)
{
    Sheet *s = m->result;
    double density[LINES], weighted[TRIAL_CHANNELS];
    double *x = pool_alloc(m->pool, (size_t)trial->rows * sizeof *x);
    const double total = total_of(m, trial, weighted);
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        const char *name = trial_signal[of[i].channel].name;
        welch(samples(trial, of[i].channel, x), x, density);
        sheet_add(s, i ? NULL : "Accelerations at the centre of mass", pool_print(m->pool, "%s.rms", name),
                  pool_print(m->pool, "%s, rms", of[i].title), "m/s^2", band_rms(density, NULL));
        sheet_add(s, NULL, pool_print(m->pool, "%s.weighted", name),
                  pool_print(m->pool, "%s, weighted rms", of[i].title), "m/s^2", weighted[of[i].channel]);
        if (of[i].channel == TRIAL_AZ)
            add_curve(m, density, "Vertical acceleration", "(m/s^2)^2/Hz");
    }
    sheet_add(s, NULL, "total", "Vibration total value", "m/s^2", total);
    for (int k = 0; k < 2; ++k) {
        const Channel c = k ? TRIAL_PITCH : TRIAL_ROLL;
        const int n = samples(trial, c, x);
        double mean = 0, square = 0;
        for (int i = 0; i < n; ++i)
            mean += x[i] / n;
        for (int i = 0; i < n; ++i)
            square += (x[i] - mean) * (x[i] - mean) / n;
        sheet_add(s, NULL, pool_print(m->pool, "%s.rms", trial_signal[c].name), k ? "Pitch, rms" : "Roll, rms", "rad",
                  sqrt(square));
    }
}

static void add_loads(Manoeuvre *m, const Trial *trial)
{
    const Model *model = m->car->model;
    for (int w = 0; w < model->wheels; ++w) {
        double mean = 0, square = 0, road = 0, ground = 0, travel[2] = {INFINITY, -INFINITY};
        int n = 0, up = 0;
        for (int i = 0; i < trial->rows; ++i) {
            if (trial->row[i][TRIAL_TIME] < ride_run_in)
                continue;
            const double *at = trial->wheel + (i * model->wheels + w) * TRIAL_OF_WHEEL;
            mean += at[TRIAL_WHEEL_LOAD];
            square += at[TRIAL_WHEEL_LOAD] * at[TRIAL_WHEEL_LOAD];
            road += at[TRIAL_WHEEL_ROAD];
            ground += at[TRIAL_WHEEL_ROAD] * at[TRIAL_WHEEL_ROAD];
            up += at[TRIAL_WHEEL_LOAD] <= 0;
            travel[0] = fmin(travel[0], at[TRIAL_WHEEL_TRAVEL]);
            travel[1] = fmax(travel[1], at[TRIAL_WHEEL_TRAVEL]);
            ++n;
        }
        mean /= n;
        road /= n;
        const char *name = model->wheel[w].name;
        sheet_add(m->result, w ? NULL : "Tires", pool_print(m->pool, "%s.dynamic_load", name),
                  pool_print(m->pool, "Load of %s, rms of its change over its mean", name), "1",
                  sqrt(fmax(0, square / n - mean * mean)) / mean);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.lifted", name),
                  pool_print(m->pool, "Share of the time without load, %s", name), "1", (double)up / n);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.road", name),
                  pool_print(m->pool, "Road under %s, rms", name), "m", sqrt(fmax(0, ground / n - road * road)));
        if (m->car->travel[w] >= 0)
            sheet_add(m->result, NULL, pool_print(m->pool, "%s.working_space", name),
                      pool_print(m->pool, "Working space of %s, from end to end", name),
                      m->car->model->coordinate[m->car->travel[w]].type == COORDINATE_ANGLE ? "rad" : "m",
                      travel[1] - travel[0]);
    }
}

void manoeuvre_ride_numbers(Manoeuvre *m, const Trial *trial)
{
    add_accelerations(m, trial);
    add_loads(m, trial);
}

/* Distance of the road's tracks, m: that of the front wheels; of the widest axle where the front ones run midway
 * between the tracks, *between; a usual one for wheels in one line. */
static double track_of(const Sheet *sheet, bool *between)
{
    static const double usual = 1.5, in_line = 0.1; /* m */
    double track = 0;
    *between = false;
    for (int a = 0; a < sheet->kc->axles; ++a) {
        double aside;
        sheet_axle_place(sheet, &sheet->kc->axle[a], &aside);
        if (a == 0 && 2 * aside >= in_line)
            return 2 * aside;
        track = fmax(track, 2 * aside);
    }
    *between = true;
    return track >= in_line ? track : usual;
}

static void note_track(Manoeuvre *m)
{
    bool between;
    const double track = track_of(&m->car->sheet, &between);
    if (between)
        sheet_note(m->result, pool_print(m->pool,
                                         "the foremost wheel runs midway between the tracks of the road, which are "
                                         "%.3g m apart: there the road is the mean of both",
                                         track));
}

static const double learns = 0.5; /* 1/s, how fast the driver does */

/* At a speed that it keeps, on a road of a class from a seed. driver: NULL, the vehicle is not steered. */
static const Trial *drive(Manoeuvre *m, const char *name, double speed, int class, double duration, double seed,
                          const PathDriver *driver)
{
    TestCar *car = m->car;
    bool between;
    duration += ride_run_in;
    Text more = {.pool = m->pool};
    text_print(&more, "road: {type: iso8608, class: %c, length: %.9g, seed: %.0f, start: %.9g, track: %.9g}\n",
               'A' + class - 1, ceil(speed * (duration + 2) + 20), seed, 10.0, track_of(&car->sheet, &between));
    const char *pedals = car_pedals(car, pool_print(m->pool, "%.17g", speed));
    if (driver) /* which keeps it between its tracks */
        text_print(&more, "%s",
                   manoeuvre_driver_text(
                       m, driver, pedals,
                       pool_print(m->pool, "{points: [[-20, 0], [%.9g, 0]]}", ceil(speed * (duration + 10) + 100))));
    else
        text_print(&more, "driver:\n%s", pedals);
    car->output_step = ride_sampling;
    const Trial *trial = trial_run(car, name, car_scene(car, duration, speed, false, more.s), NULL, NULL);
    manoeuvre_whole(m, trial, "a smoother road, class=1, or a lower speed");
    manoeuvre_keep(m, trial);
    return trial;
}

void manoeuvre_ride(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_AZ, TRIAL_ROLL, TRIAL_PITCH, TRIAL_LOAD, TRIAL_SPEED};
    car_need_drive(m->car);
    car_need_brake(m->car);
    car_settle(m->car, m->value[0]);
    note_track(m);
    const bool steered = m->car->axle;
    const PathDriver driver = steered ? manoeuvre_driver(m, m->value[0], learns) : (PathDriver){0};
    const Trial *trial =
        drive(m, "ride", m->value[0], (int)round(m->value[1]), m->value[2], m->value[3], steered ? &driver : NULL);
    manoeuvre_ride_numbers(m, trial);
    if (steered)
        manoeuvre_driver_rows(m, &driver, "");
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}

void manoeuvre_ride_speeds(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_AZ, TRIAL_PITCH, TRIAL_LOAD};
    enum { SPEEDS = 6, CURVES = 4 };
    TestCar *car = m->car;
    const double low = m->value[0], high = m->value[1];
    double *x = pool_alloc(m->pool, SPEEDS * sizeof *x), *y = pool_alloc(m->pool, CURVES * SPEEDS * sizeof *y);
    int n = 0;
    car_need_drive(car);
    car_need_brake(car);
    note_track(m);
    for (int k = 0; k < SPEEDS; ++k) {
        const double speed = low + (high - low) * k / (SPEEDS - 1);
        const char *why, *at = pool_print(m->pool, "at_%.4g", speed);
        PathDriver driver;
        if (!car_keeps(car, speed, &why) || (car->axle && !manoeuvre_find_driver(m, speed, learns, &driver, &why))) {
            if (k == 0)
                car_refuse(car, car->remedy, why);
            sheet_note(m->result, pool_print(m->pool, "from %.4g m/s on: %s", speed, why));
            break;
        }
        const Trial *trial =
            drive(m, at, speed, (int)round(m->value[2]), m->value[3], m->value[4], car->axle ? &driver : NULL);
        double weighted[TRIAL_CHANNELS];
        x[n] = speed;
        y[n] = total_of(m, trial, weighted);
        sheet_add(m->result, pool_print(m->pool, "At %.4g m/s", speed), pool_print(m->pool, "%s.total", at),
                  "Vibration total value", "m/s^2", y[n]);
        for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
            y[(i + 1) * SPEEDS + (size_t)n] = weighted[of[i].channel];
            sheet_add(m->result, NULL, pool_print(m->pool, "%s.%s.weighted", at, trial_signal[of[i].channel].name),
                      pool_print(m->pool, "%s, weighted rms", of[i].title), "m/s^2", weighted[of[i].channel]);
        }
        if (car->axle)
            manoeuvre_driver_rows(m, &driver, at);
        ++n;
    }
    for (int c = 1; c < CURVES; ++c) /* rows that were not driven close up */
        for (int i = 0; i < n; ++i)
            y[c * n + i] = y[c * SPEEDS + i];
    *POOL_PUSH(m->pool, m->table, m->tables) = (ManoeuvreTable){
        "Weighted acceleration: total, along, across, upwards", "m/s^2", "speed, m/s", n, CURVES, x, y};
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}
