/* SPDX-License-Identifier: MIT
 * Values of profiles, and movements. Pages of gicrun --drive compile this file too: it needs the runtime core alone. */
#include "profile_form.h"

#include "gic_runtime.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;

/* ---- pieces ------------------------------------------------------------------------------------------------- */

int profile_interval(const Profile *profile, double time)
{
    int low = 0, high = profile->count - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (time > profile->time[middle])
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The polynomial of degree 5, or where a NULL of degree 3, with values y, rates v and accelerations a at both ends. */
static void hermite(double width, double s, const double *y, const double *v, const double *a, double out[3])
{
    const double way = y[1] - y[0], v0 = v[0] * width, v1 = v[1] * width;
    double c[6] = {y[0], v0, 0, 0, 0, 0};
    if (a) {
        const double a0 = a[0] * width * width, a1 = a[1] * width * width;
        c[2] = a0 / 2;
        c[3] = 10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
        c[4] = -15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
        c[5] = 6 * way - 3 * (v0 + v1) - 0.5 * (a0 - a1);
    } else {
        c[2] = 3 * way - 2 * v0 - v1;
        c[3] = v0 + v1 - 2 * way;
    }
    out[0] = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
    out[1] = (c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * 5 * c[5])))) / width;
    out[2] = (2 * c[2] + s * (6 * c[3] + s * (12 * c[4] + s * 20 * c[5]))) / (width * width);
}

static void curve_at(const Profile *p, double time, double out[3])
{
    const int last = p->count - 1;
    out[1] = out[2] = 0;
    if (time < p->time[0] || time > p->time[last]) {
        out[0] = p->value[time < p->time[0] ? 0 : last];
        return;
    }
    const int k = profile_interval(p, time);
    const double width = p->time[k + 1] - p->time[k];
    hermite(width, (time - p->time[k]) / width, p->value + k, p->rate + k, p->acceleration ? p->acceleration + k : NULL,
            out);
}

static void knots_at(const Profile *p, double time, double out[3])
{
    if (p->count == 1) {
        memcpy(out, (double[3]){p->value[0]}, 3 * sizeof *out);
        return;
    }
    const int k = profile_interval(p, time);
    gic_quintic(time, p->time[k], p->time[k + 1], p->value[k], p->value[k + 1], out);
}

/* ---- waves -------------------------------------------------------------------------------------------------- */

/* offset + fade * amplitude sin(phase), with the first two derivatives of fade and phase. */
static void wave(const Profile *p, const double phase[3], const double fade[3], double out[3])
{
    const double s = p->amplitude * sin(phase[0]), c = p->amplitude * cos(phase[0]), w = phase[1];
    const double rate = w * c, acceleration = phase[2] * c - w * w * s;
    out[0] = p->offset + fade[0] * s;
    out[1] = fade[1] * s + fade[0] * rate;
    out[2] = fade[2] * s + 2 * fade[1] * rate + fade[0] * acceleration;
}

static void sine_at(const Profile *p, double time, double out[3])
{
    const double w = 2 * pi * p->frequency;
    double fade[3];
    gic_quintic(time, p->start, p->start + 1 / p->frequency, 0, 1, fade);
    wave(p, (double[3]){w * (time - p->start), w, 0}, fade, out);
}

/* It fades in over the first period and out over the last one. */
static void chirp_at(const Profile *p, double time, double out[3])
{
    const double T = p->end - p->start, t = fmin(fmax(time - p->start, 0), T), f = p->frequency, g = p->last;
    double phase[3], begin[3], finish[3];
    if (p->logarithmic) {
        const double growth = log(g / f) / T, now = f * exp(growth * t);
        phase[0] = 2 * pi * f * expm1(growth * t) / growth;
        phase[1] = 2 * pi * now;
        phase[2] = 2 * pi * growth * now;
    } else {
        const double growth = (g - f) / T;
        phase[0] = 2 * pi * t * (f + growth * t / 2);
        phase[1] = 2 * pi * (f + growth * t);
        phase[2] = 2 * pi * growth;
    }
    gic_quintic(time, p->start, p->start + 1 / f, 0, 1, begin);
    gic_quintic(time, p->end - 1 / g, p->end, 1, 0, finish);
    /* one of the factors is 1, or begin and end overlap */
    const double fade[3] = {begin[0] * finish[0], begin[1] * finish[0] + begin[0] * finish[1],
                            begin[2] * finish[0] + 2 * begin[1] * finish[1] + begin[0] * finish[2]};
    wave(p, phase, fade, out);
}

void profile_form_at(const Profile *profile, double time, double out[3])
{
    time -= profile->begin;
    switch (profile->form) {
    case PROFILE_KNOTS: knots_at(profile, time, out); return;
    case PROFILE_SINE: sine_at(profile, time, out); return;
    case PROFILE_CURVE: curve_at(profile, time, out); return;
    case PROFILE_CHIRP: chirp_at(profile, time, out); return;
    case PROFILE_FORMULA: return;
    }
}

/* ---- movements --------------------------------------------------------------------------------------------- */

void movement_at(const Movement *m, double time, double out[4])
{
    const double s = fmax(0, time - m->start);
    memset(out, 0, 4 * sizeof *out);
    if (s >= m->duration) {
        out[0] = m->end;
        return;
    }
    /* Horner's rule for the polynomial and its derivatives over their factorials */
    for (int k = 7; k >= 0; --k) {
        for (int d = 3; d > 0; --d)
            out[d] = out[d] * s + out[d - 1];
        out[0] = out[0] * s + m->c[k];
    }
    out[2] *= 2;
    out[3] *= 6;
}

void movement_turn(Movement *m, double time, double end, double duration)
{
    double now[4];
    movement_at(m, time, now);
    movement_from(m, time, now, end, duration);
}

void movement_from(Movement *m, double time, const double now[4], double end, double duration)
{
    double T = 1;
    const double way = end - now[0], v = now[1] * duration, a = now[2] * duration * duration / 2;
    const double j = now[3] * duration * duration * duration / 6;
    const double c[8] = {now[0],
                         v,
                         a,
                         j,
                         35 * way - 20 * v - 10 * a - 4 * j,
                         -84 * way + 45 * v + 20 * a + 6 * j,
                         70 * way - 36 * v - 15 * a - 4 * j,
                         -20 * way + 10 * v + 4 * a + j};
    m->start = time;
    m->duration = duration;
    m->end = end;
    for (int k = 0; k < 8; ++k, T *= duration)
        m->c[k] = c[k] / T;
}

Movement movement_rest(double value)
{
    return (Movement){.end = value, .c = {value}};
}
