/* SPDX-License-Identifier: MIT
 * Numbers from the rows of a trial: slopes, means, crossings, peaks. */
#include "run/manoeuvre.h"

#include <math.h>

double fit_slope(int count, const double *x, const double *y)
{
    double mean[2] = {0}, xx = 0, xy = 0;
    for (int i = 0; i < count; ++i) {
        mean[0] += x[i] / count;
        mean[1] += y[i] / count;
    }
    for (int i = 0; i < count; ++i) {
        xx += (x[i] - mean[0]) * (x[i] - mean[0]);
        xy += (x[i] - mean[0]) * (y[i] - mean[1]);
    }
    return xx > 0 ? xy / xx : NAN;
}

double trial_mean(const Trial *trial, Channel channel, double from, double to)
{
    double sum = 0;
    int count = 0;
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] >= from && trial->row[i][TRIAL_TIME] <= to) {
            sum += trial->row[i][channel];
            ++count;
        }
    return count ? sum / count : NAN;
}

/* The share of the way from row i to the next one at which a channel has a value. */
static double share_at(const Trial *trial, Channel channel, int i, double value)
{
    const double a = trial->row[i][channel], b = trial->row[i + 1][channel];
    return a != b ? (value - a) / (b - a) : 0;
}

double trial_at(const Trial *trial, Channel channel, double time)
{
    for (int i = 0; i + 1 < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] <= time && time <= trial->row[i + 1][TRIAL_TIME]) {
            const double share = share_at(trial, TRIAL_TIME, i, time);
            return trial->row[i][channel] + share * (trial->row[i + 1][channel] - trial->row[i][channel]);
        }
    return NAN;
}

double trial_passes(const Trial *trial, Channel channel, double from, double value, double sign)
{
    for (int i = 0; i + 1 < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] >= from && sign * (trial->row[i][channel] - value) < 0 &&
            sign * (trial->row[i + 1][channel] - value) >= 0) {
            const double share = share_at(trial, channel, i, value), *at = trial->row[i];
            return at[TRIAL_TIME] + share * (trial->row[i + 1][TRIAL_TIME] - at[TRIAL_TIME]);
        }
    return NAN;
}

int trial_peak(const Trial *trial, Channel channel, double from, double to, double sign)
{
    int most = -1;
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] >= from && trial->row[i][TRIAL_TIME] <= to &&
            (most < 0 || sign * trial->row[i][channel] > sign * trial->row[most][channel]))
            most = i;
    return most;
}

bool trial_spins(const Trial *trial)
{
    const double *row = trial->row[trial->rows - 1], along = 1, across = 0.7853981633974483; /* m/s, 45 degrees */
    return fabs(row[TRIAL_SIDESLIP]) > across &&
           hypot(row[TRIAL_SPEED], row[TRIAL_SPEED] * tan(row[TRIAL_SIDESLIP])) > along;
}
