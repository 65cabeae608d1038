/* SPDX-License-Identifier: MIT
 * Profiles of inputs over time: values, rates, accelerations, and where they are not smooth. */
#include "gic_runtime.h"
#include "scene/profile.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;
static const double formula_step = 0.01; /* s: the longest step over a formula */
static const double waves = 8;           /* least number of steps in a period */

/* ---- pieces ------------------------------------------------------------------------------------------------- */

/* The interval between points k and k + 1 that `time` is in, from 0 to count - 2; count >= 2. At a point: the one
 * before. */
static int interval(const Profile *profile, double time)
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
    const int k = interval(p, time);
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
    const int k = interval(p, time);
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

void profile_at(const Profile *profile, double time, double out[3])
{
    time -= profile->begin;
    switch (profile->form) {
    case PROFILE_KNOTS: knots_at(profile, time, out); return;
    case PROFILE_SINE: sine_at(profile, time, out); return;
    case PROFILE_CURVE: curve_at(profile, time, out); return;
    case PROFILE_CHIRP: chirp_at(profile, time, out); return;
    case PROFILE_FORMULA: formula_of_time(profile->law, profile->model, time, out); return;
    }
}

/* ---- where it changes --------------------------------------------------------------------------------------- */

static bool is_wave(const Profile *profile)
{
    return profile->form == PROFILE_SINE || profile->form == PROFILE_CHIRP;
}

bool profile_is_constant(const Profile *profile)
{
    if (is_wave(profile))
        return profile->amplitude == 0;
    for (int i = 1; i < profile->count; ++i)
        if (profile->value[i] != profile->value[0])
            return false;
    return profile->form != PROFILE_FORMULA;
}

/* The times at which a wave's fading begins and ends, as many as the result says. */
static int fading(const Profile *p, double time[4])
{
    time[0] = p->start;
    time[1] = p->start + 1 / p->frequency;
    if (p->form == PROFILE_SINE)
        return 2;
    time[2] = p->end - 1 / p->last;
    time[3] = p->end;
    return 4;
}

static double next_kink(const Profile *profile, double time)
{
    double next = INFINITY, ends[4];
    const int last = profile->count - 1;
    if (is_wave(profile)) {
        for (int k = fading(profile, ends); k--;)
            if (ends[k] > time)
                next = fmin(next, ends[k]);
        return next;
    }
    if (profile->form == PROFILE_FORMULA || time >= profile->time[last])
        return INFINITY;
    if (time < profile->time[0])
        return profile->time[0];
    if (profile->sampled)
        return profile->time[last];
    const int k = interval(profile, time);
    return profile->time[k + 1] > time ? profile->time[k + 1] : profile->time[k + 2];
}

double profile_next_kink(const Profile *profile, double time)
{
    double next = next_kink(profile, time - profile->begin);
    while (profile->begin + next <= time) /* the sum is rounded */
        next = next_kink(profile, next);
    return profile->begin + next;
}

double profile_longest_step(const Profile *profile, double time)
{
    time -= profile->begin;
    switch (profile->form) {
    case PROFILE_SINE: return profile->amplitude != 0 ? 1 / (waves * profile->frequency) : INFINITY;
    case PROFILE_CHIRP:
        return profile->amplitude != 0 && time < profile->end ? 1 / (waves * fmax(profile->frequency, profile->last))
                                                              : INFINITY;
    case PROFILE_FORMULA: return formula_step;
    case PROFILE_CURVE: {
        const int last = profile->count - 1;
        if (!profile->sampled || time < profile->time[0] || time >= profile->time[last])
            return INFINITY;
        /* past one sample at most; the ends are kinks */
        const int k = interval(profile, time);
        return profile->time[k + 2 < last ? k + 2 : last] - time;
    }
    default: return INFINITY;
    }
}

/* True if it is constant between points k and k + 1. */
static bool stays(const Profile *p, int k)
{
    bool at_rest = p->value[k + 1] == p->value[k];
    for (int i = k; i < k + 2 && p->form == PROFILE_CURVE; ++i)
        at_rest = at_rest && p->rate[i] == 0 && (!p->acceleration || p->acceleration[i] == 0);
    return at_rest;
}

static double quiet_until(const Profile *profile, double time)
{
    if (is_wave(profile)) {
        const bool over = profile->form == PROFILE_CHIRP && time >= profile->end;
        return profile->amplitude == 0 || over ? INFINITY : fmax(time, profile->start);
    }
    if (profile->form == PROFILE_FORMULA)
        return time;
    if (time < profile->time[0])
        return profile->time[0];
    int k = 0;
    while (k + 1 < profile->count && profile->time[k + 1] <= time)
        ++k;
    if (k + 1 == profile->count)
        return INFINITY;
    return stays(profile, k) ? profile->time[k + 1] : time;
}

double profile_quiet_until(const Profile *profile, double time)
{
    return profile->begin + quiet_until(profile, time - profile->begin);
}

/* ---- how far and how fast ----------------------------------------------------------------------------------- */

static void note(ProfilePeaks *peaks, const double at[3])
{
    peaks->low = fmin(peaks->low, at[0]);
    peaks->high = fmax(peaks->high, at[0]);
    peaks->rate = fmax(peaks->rate, fabs(at[1]));
    peaks->acceleration = fmax(peaks->acceleration, fabs(at[2]));
}

/* The largest rate and acceleration of s^3 (10 - 15 s + 6 s^2): at 1/2, and at 1/2 - sqrt(1/12). */
static const double steepest = 1.875, sharpest = 5.773502691896258;

static ProfilePeaks knots_peaks(const Profile *p, double duration)
{
    ProfilePeaks peaks = {INFINITY, -INFINITY, 0, 0};
    double at[3];
    knots_at(p, 0, at);
    note(&peaks, (double[3]){at[0]});
    knots_at(p, duration, at);
    note(&peaks, (double[3]){at[0]});
    for (int k = 0; k < p->count; ++k) {
        if (p->time[k] >= 0 && p->time[k] <= duration)
            note(&peaks, (double[3]){p->value[k]});
        if (k + 1 == p->count || p->time[k] >= duration || p->time[k + 1] <= 0)
            continue;
        const double way = fabs(p->value[k + 1] - p->value[k]), width = p->time[k + 1] - p->time[k];
        peaks.rate = fmax(peaks.rate, steepest * way / width);
        peaks.acceleration = fmax(peaks.acceleration, sharpest * way / (width * width));
    }
    return peaks;
}

ProfilePeaks profile_peaks(const Profile *profile, double duration)
{
    if (profile->form == PROFILE_KNOTS)
        return knots_peaks(profile, duration);
    enum { LOOKS = 4000, PARTS = 16, MOST = 4000000 };
    ProfilePeaks peaks = {INFINITY, -INFINITY, 0, 0};
    double at[3];
    const double fastest = is_wave(profile) ? fmax(profile->frequency, profile->last) : 0;
    const int looks = (int)fmin(fmax(LOOKS, 4 * PARTS * fastest * duration), MOST);
    for (int i = 0; i <= looks; ++i) {
        profile_at(profile, duration * i / looks, at);
        note(&peaks, at);
    }
    for (int k = 0; k + 1 < profile->count; ++k)
        for (int i = 0; i <= PARTS; ++i) {
            const double time = profile->time[k] + (profile->time[k + 1] - profile->time[k]) * i / (double)PARTS;
            if (time < 0 || time > duration)
                continue;
            profile_at(profile, time, at);
            note(&peaks, at);
        }
    return peaks;
}
