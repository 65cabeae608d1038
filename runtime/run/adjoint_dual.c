/* SPDX-License-Identifier: MIT
 * Backwards through steps of dual rate (gic_runtime.c): the first two are fast steps of everything, two by RK4 and the
 * others by AB3; those after them are AB3 of the slow states, and then of the fast ones at links that a cubic gives.
 * What is kept from one step to the next are two rates, of slow states at slow steps and of fast ones at fast steps,
 * and three rows of links. */
#include "run/adjoint_private.h"
#include "gic_runtime.h"

#include <string.h>

double *fast_moment(const Back *back, int k)
{
    return back->moment + (size_t)(k + 2) * (size_t)(back->run->states + 1);
}

static void clear(double *number, int count)
{
    memset(number, 0, (size_t)count * sizeof *number);
}

void clear_moments(Back *back)
{
    clear(back->moment, (back->run->scene->ratio + 2) * (back->run->states + 1));
}

/* From what is kept after the step, of links, to what the step has of them. */
static void links_back(Back *back)
{
    const size_t links = (size_t)back->run->code->link_count * sizeof(double);
    memcpy(back->link[3], back->link[0], links);
    memcpy(back->link[0], back->link[1], links);
    memcpy(back->link[1], back->link[2], links);
    memset(back->link[2], 0, links);
}

/* Back through links at a state, with derivatives by them, which are used up. */
static int link_back(Back *back, int event, double *by)
{
    const TangentRun *run = back->run;
    memcpy(run->linear->link[1], by, (size_t)run->code->link_count * sizeof *by);
    const int status = event_back(back, trail_event(run->trail, event), 0, NULL);
    adjoint_add(run->code->slow_count, 1, run->linear->along.y, back->state);
    clear(by, run->code->link_count);
    return status;
}

/* Back through a right-hand side with derivatives by its rate. */
static int call_back(Back *back, int event, const double *by, double weight)
{
    const TangentRun *run = back->run;
    const int status = rate_back(back, trail_event(run->trail, event), by, weight, NULL);
    adjoint_add(run->states, 1, run->linear->along.y, back->state);
    return status;
}

/* Fast step k of those after a start: rates at links between those of slow steps. */
static int fast_back(Back *back, int event, int k)
{
    const TangentRun *run = back->run;
    const int slow = run->code->slow_count, links = run->code->link_count;
    const double s = k / (double)run->scene->ratio, of_next = s / 6 * (s + 1) * (s + 2);
    const double of_before = s / 2 * (s - 1) * (s + 2), of_older = s / 6 * (1 - s) * (s + 1);
    const double *by = run->linear->link[1];
    clear(run->linear->drate, slow);
    memcpy(run->linear->drate + slow, fast_moment(back, k) + slow, (size_t)run->code->fast_count * sizeof *by);
    const int status = event_back(back, trail_event(run->trail, event), 0, NULL);
    adjoint_add(run->code->fast_count, 1, run->linear->along.y + slow, back->state + slow);
    adjoint_add(links, 1 - of_next - of_before - of_older, by, back->link[0]);
    adjoint_add(links, of_before, by, back->link[1]);
    adjoint_add(links, of_older, by, back->link[2]);
    adjoint_add(links, of_next, by, back->link[3]);
    return status;
}

/* Events: the rate at the start, the state that was settled, links at the end, and rates at fast steps from the second
 * on. */
static int march_back(Back *back, int first, double weight)
{
    const TangentRun *run = back->run;
    const int slow = run->code->slow_count, fast = run->code->fast_count, ratio = run->scene->ratio;
    const double h = run->scene->step, part = h / ratio / 12;
    double *state = back->state, *const *rate = back->rate;
    int status = GIC_OK;
    adjoint_add(fast, 1, rate[0] + slow, fast_moment(back, ratio - 1) + slow);
    adjoint_add(fast, 1, rate[1] + slow, fast_moment(back, ratio - 2) + slow);
    for (int k = ratio - 1; k >= 0 && status == GIC_OK; --k) {
        adjoint_add(fast, 23 * part, state + slow, fast_moment(back, k) + slow);
        adjoint_add(fast, -16 * part, state + slow, fast_moment(back, k - 1) + slow);
        adjoint_add(fast, 5 * part, state + slow, fast_moment(back, k - 2) + slow);
        if (k > 0)
            status = fast_back(back, first + 2 + k, k);
    }
    if (status == GIC_OK)
        status = link_back(back, first + 2, back->link[3]);
    if (status != GIC_OK)
        return status;
    settle_back(back, trail_event(run->trail, first + 1));
    double *now = fast_moment(back, 0);
    adjoint_add(slow, 1, rate[0], now);
    memcpy(rate[0], rate[1], (size_t)slow * sizeof *now);
    clear(rate[1], slow);
    adjoint_add(slow, h * 23 / 12, state, now);
    adjoint_add(slow, -h * 16 / 12, state, rate[0]);
    adjoint_add(slow, h * 5 / 12, state, rate[1]);
    memcpy(rate[0] + slow, fast_moment(back, -1) + slow, (size_t)fast * sizeof *now);
    memcpy(rate[1] + slow, fast_moment(back, -2) + slow, (size_t)fast * sizeof *now);
    return call_back(back, first, now, weight);
}

/* Derivatives by the older rate that balance_start() made up, which are used up. at_end: by the rate at the end. */
static void balance_back(Back *back, double *at_end)
{
    const int slow = back->run->code->slow_count, ratio = back->run->scene->ratio;
    double *older = back->rate[1];
    adjoint_add(slow, 11.0 / 5, older, back->rate[0]);
    adjoint_set(slow, (1.5 * ratio - 6) / 5, older, at_end);
    adjoint_add(slow, -2.0 * ratio / 5, older, fast_moment(back, ratio - 1));
    adjoint_add(slow, 0.5 * ratio / 5, older, fast_moment(back, ratio - 2));
    clear(older, slow);
}

/* The first event of a part. */
static int part_event(int k)
{
    return k < 2 ? k * (RK4_STAGES + 1) : 2 * (RK4_STAGES + 1) + 2 * (k - 2);
}

int parts_back(Back *back, int first, int parts, double h, double weight)
{
    const TangentRun *run = back->run;
    int status = GIC_OK;
    for (int k = parts - 1; k >= 0 && status == GIC_OK; --k) {
        const int event = first + part_event(k);
        settle_back(back, trail_event(run->trail, first + part_event(k + 1) - 1));
        if (k > 1) {
            adjoint_add(run->states, h * 23 / 12, back->state, fast_moment(back, k));
            adjoint_add(run->states, -h * 16 / 12, back->state, fast_moment(back, k - 1));
            adjoint_add(run->states, h * 5 / 12, back->state, fast_moment(back, k - 2));
            status = call_back(back, event, fast_moment(back, k), 0);
        } else {
            status = rk4_back(back, event, h, fast_moment(back, k), k == 0 ? weight : 0);
        }
    }
    return status;
}

/* Events: of the first step links at the start; those of each fast step; of the second step the rate at the end; links
 * at the end. */
static int start_back(Back *back, int first, int known, double weight)
{
    const TangentRun *run = back->run;
    const int slow = run->code->slow_count, fast = run->code->fast_count, ratio = run->scene->ratio;
    const int calls = first + (known == 0), end = calls + part_event(ratio);
    double *const *rate = back->rate;
    clear(back->sum, run->states);
    if (known == 1)
        balance_back(back, back->sum);
    adjoint_add(slow, 1, rate[0], fast_moment(back, 0));
    adjoint_add(fast, 1, rate[0] + slow, fast_moment(back, ratio - 1) + slow);
    adjoint_add(fast, 1, rate[1] + slow, fast_moment(back, ratio - 2) + slow);
    clear(rate[0], run->states);
    clear(rate[1], run->states);
    int status = link_back(back, end + known, back->link[3]);
    if (status == GIC_OK && known == 1)
        status = call_back(back, end, back->sum, 0);
    if (status == GIC_OK)
        status = parts_back(back, calls, ratio, run->scene->step / ratio, weight);
    return status == GIC_OK && known == 0 ? link_back(back, first, back->link[0]) : status;
}

int dual_back(Back *back, const TrailStep *step, double weight)
{
    links_back(back);
    clear_moments(back);
    memcpy(fast_moment(back, 0), back->start_rate, (size_t)back->run->states * sizeof *back->start_rate);
    return step->history == 2 ? march_back(back, step->first, weight)
                              : start_back(back, step->first, step->history, weight);
}
