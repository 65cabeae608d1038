/* SPDX-License-Identifier: MIT
 * Deadlines, what keeps them, and how well they are kept. */
#define _GNU_SOURCE /* PR_SET_TIMERSLACK */
#include "base/message.h"
#include "run/live.h"

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>

enum {
    PRIORITY = 60,               /* of steps; the bare thread has one more, so that steps do not hold it up */
    STACK = 1 << 18,             /* bytes of a thread's stack */
    BEHIND = 1000 * 1000 * 1000, /* ns; deadlines further back are given up */
};

/* ---- durations ----------------------------------------------------------------------------------------------------
 */

double spread_end(int bin)
{
    static const double end[SPREAD_BINS] = {1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4,    1e-3,
                                            2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1,  0.2,  0.5,  INFINITY};
    return end[bin];
}

void spread_add(Spread *spread, double seconds)
{
    int bin = 0;
    while (seconds > spread_end(bin))
        ++bin;
    ++spread->bin[bin];
    ++spread->count;
    spread->sum += seconds;
    spread->most = fmax(spread->most, seconds);
}

/* ---- the clock ----------------------------------------------------------------------------------------------------
 */

int64_t live_now(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

int64_t live_due(const LiveClock *clock, int64_t number)
{
    return clock->first + (int64_t)llround((double)number * clock->step * 1e9);
}

void live_wait(int64_t until)
{
    const struct timespec time = {.tv_sec = (time_t)(until / 1000000000), .tv_nsec = (long)(until % 1000000000)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL) == EINTR)
        continue;
}

bool live_behind(LiveClock *clock, int64_t late)
{
    if (late <= BEHIND)
        return false;
    clock->first += late;
    return true;
}

/* ---- threads ------------------------------------------------------------------------------------------------------
 */

/* Touch the stack that steps will have, so that it is there when memory is locked. */
static void touch_stack(void)
{
    volatile char stack[STACK];
    for (size_t i = 0; i < sizeof stack; i += 1024)
        stack[i] = 0;
}

LiveRank live_rank_raise(bool quiet)
{
    LiveRank rank = {.policy = SCHED_OTHER};
    struct sched_param now = {0};
    touch_stack();
    rank.locked = !mlockall(MCL_CURRENT);
    if (!rank.locked && !quiet)
        diag_warn(program_place(),
                  "run it as root, or allow it: a line `USER - memlock unlimited` in "
                  "/etc/security/limits.conf",
                  "memory is not locked (%s): a page that has to be fetched delays a step", strerror(errno));
    rank.policy = sched_getscheduler(0);
    sched_getparam(0, &now);
    rank.priority = now.sched_priority;
    rank.raised = !sched_setscheduler(0, SCHED_FIFO, &(struct sched_param){.sched_priority = PRIORITY});
    if (!rank.raised && !quiet)
        diag_warn(program_place(),
                  "run it as root, or allow it: a line `USER - rtprio 99` in /etc/security/limits.conf",
                  "scheduling is not raised to SCHED_FIFO (%s): other programs delay steps", strerror(errno));
    prctl(PR_SET_TIMERSLACK, 1UL);
    return rank;
}

void live_rank_restore(const LiveRank *rank)
{
    if (rank->locked)
        munlockall();
    if (rank->raised)
        sched_setscheduler(0, rank->policy, &(struct sched_param){.sched_priority = rank->priority});
    prctl(PR_SET_TIMERSLACK, 0UL); /* as it was */
}

bool live_thread(pthread_t *thread, int policy, int priority, void *(*work)(void *), void *context)
{
    sigset_t all, before;
    pthread_attr_t attributes;
    const struct sched_param parameters = {.sched_priority = priority};
    if (pthread_attr_init(&attributes))
        return false;
    pthread_attr_setstacksize(&attributes, STACK);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, policy);
    pthread_attr_setschedparam(&attributes, &parameters);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before); /* the new thread has the mask of this one */
    const bool good = !pthread_create(thread, &attributes, work, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return good;
}

static void *keep_time(void *context)
{
    LiveBare *bare = context;
    prctl(PR_SET_TIMERSLACK, 1UL);
    for (int64_t i = 0; !atomic_load(&bare->over); ++i) {
        const int64_t due = live_due(&bare->clock, i);
        live_wait(due);
        const int64_t late = live_now(CLOCK_MONOTONIC) - due;
        spread_add(&bare->late, 1e-9 * (double)late);
        bare->misses += 1e-9 * (double)late > atomic_load(&bare->leaves);
        live_behind(&bare->clock, late);
    }
    return NULL;
}

bool live_bare_start(LiveBare *bare, const LiveRank *rank)
{
    bare->clock.first += (int64_t)(0.5e9 * bare->clock.step);
    return live_thread(&bare->thread, rank->raised ? SCHED_FIFO : SCHED_OTHER, rank->raised ? PRIORITY + 1 : 0,
                       keep_time, bare);
}

void live_bare_stop(LiveBare *bare)
{
    atomic_store(&bare->over, true);
    pthread_join(bare->thread, NULL);
}
