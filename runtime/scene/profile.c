/* SPDX-License-Identifier: MIT
 * Profiles of inputs over time: where they are not smooth, how far and how fast they go. */
#include "scene/profile.h"

#include <math.h>

static const double formula_step = 0.01; /* s: the longest step over a formula */
static const double waves = 8;           /* least number of steps in a period */

void profile_at(const Profile *profile, double time, double out[3])
{
    if (profile->form == PROFILE_FORMULA)
        formula_of_time(profile->law, profile->model, time - profile->begin, out);
    else
        profile_form_at(profile, time, out);
}

int profile_orders(const Profile *profile)
{
    return profile->driven ? 3 : profile->post ? 2 : 1;
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
    const int k = profile_interval(profile, time);
    return profile->time[k + 1] > time ? profile->time[k + 1] : profile->time[k + 2];
}

double profile_next_kink(const Profile *profile, double time)
{
    double next = next_kink(profile, time - profile->begin);
    while (profile->begin + next <= time) /* the sum is rounded */
        next = next_kink(profile, next);
    return profile->begin + next;
}

/* True if a piece of `width` s, in which the profile moves or rests, is long enough for steps. Of one that moves within
 * some steps the jump of its jerk says nothing: made up for, knots every second step are worse than gone over, those
 * every third are better. One that rests has to be wider than differences at its ends. */
static bool is_resolved(double width, bool moves, double step)
{
    return width >= (moves ? 4 : 0.25) * step;
}

/* The same of the piece between points k and k + 1; beyond the points it rests. */
static bool piece_is_resolved(const Profile *p, int k, double step)
{
    if (k < 0 || k + 1 >= p->count)
        return true;
    const bool rests =
        p->value[k] == p->value[k + 1] && (p->form == PROFILE_KNOTS || (p->rate[k] == 0 && p->rate[k + 1] == 0));
    return is_resolved(p->time[k + 1] - p->time[k], !rests, step);
}

/* True if value, rate and acceleration of a curve are continuous at its point k: it has accelerations, and at an end
 * it comes to rest. */
static bool is_continuous(const Profile *p, int k)
{
    const bool end = k == 0 || k == p->count - 1;
    return p->form == PROFILE_KNOTS || (p->acceleration && (!end || (p->rate[k] == 0 && p->acceleration[k] == 0)));
}

double profile_next_knot(const Profile *profile, double time, double step)
{
    const bool wave = is_wave(profile);
    if (profile_is_constant(profile) || profile->form == PROFILE_FORMULA)
        return INFINITY;
    if (wave && !(is_resolved(1 / profile->frequency, true, step) &&
                  (profile->form == PROFILE_SINE || is_resolved(1 / profile->last, true, step))))
        return INFINITY;
    for (double next = profile_next_kink(profile, time); next < INFINITY; next = profile_next_kink(profile, next)) {
        if (wave)
            return next;
        int k = profile_interval(profile, next - profile->begin); /* the time is a point's but for rounding */
        k += next - profile->begin - profile->time[k] > profile->time[k + 1] - (next - profile->begin);
        if (is_continuous(profile, k) && piece_is_resolved(profile, k - 1, step) && piece_is_resolved(profile, k, step))
            return next;
    }
    return INFINITY;
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
        const int k = profile_interval(profile, time);
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
    Profile here = *p;
    here.begin = 0;
    profile_form_at(&here, 0, at);
    note(&peaks, (double[3]){at[0]});
    profile_form_at(&here, duration, at);
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
