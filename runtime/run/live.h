/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of gicrun --live: a scene as fast as time passes, models/LIVE.md. */
#ifndef RUN_LIVE_H
#define RUN_LIVE_H

#include "gic_live.h"
#include "host/host.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/hold.h"
#include "scene/scene.h"

#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>

/* ---- live_port.c: packets --------------------------------------------------------------------------------------- */

/* What may be wrong with a packet. */
typedef enum LiveDrop {
    DROP_SIZE,
    DROP_KIND,
    DROP_MODEL,
    DROP_FLAGS,
    DROP_NOT_FINITE,
    DROP_RANGE,
    DROP_OLD,
    DROP_OTHER,
    LIVE_DROPS
} LiveDrop;

/* Programs that get outputs. */
enum { LIVE_PEERS = 8 };

typedef struct LivePeer {
    struct sockaddr_in address;
    int64_t heard; /* step */
} LivePeer;

struct LivePort {
    int socket; /* -1: closed */
    int port;
    const char *names; /* the text about model and scene, and its hash */
    size_t size;
    uint64_t hash;
    int inputs, outputs;
    const double *low, *high; /* [inputs] what values may be */
    const double *begin;      /* [inputs] the scene's at time 0 */
    int64_t patience;         /* steps without a good packet after which the inputs are the scene's again */
    unsigned char *packet;    /* [GIC_LIVE_MOST] */
    /* during the run */
    LivePeer peer[LIVE_PEERS];
    int peers;
    struct sockaddr_in holder; /* who has the inputs */
    bool held;
    uint64_t number; /* of the holder's last good packet */
    int64_t heard;   /* its step */
    int64_t good, asked, dropped[LIVE_DROPS], sent, unsent;
    int unsent_reason; /* errno of the last one */
};

void live_port_close(LivePort *port);
/* Take what has come before step number `step`: who has the inputs now, and value[inputs] of the last good packet; they
 * stay where none has come. */
void live_port_take(LivePort *port, int64_t step, HoldBy *by, double *value);
/* Who drives without packets has the inputs in step number `step`, and those of packets are dropped; or has them no
 * longer. */
void live_port_keep(LivePort *port, bool held, int64_t step);
/* Send outputs after a step, which have `outputs` numbers, to all who want them. */
void live_port_send(LivePort *port, int64_t step, unsigned flags, const double *value);
/* What was dropped and why, for people: "2 dropped: 2 of a wrong size". */
const char *live_port_dropped(Pool *pool, const LivePort *port);

/* ---- live_joystick.c: who drives by Linux's joystick device ------------------------------------------------------ */

typedef struct LiveJoystick LiveJoystick;

/* axes: words NAME=axisK:LOW:HIGH or NAME=buttonK:LOW:HIGH with commas between them: an input goes from LOW to HIGH, in
 * its unit, as the axis goes from end to end or as the button is pressed. Ends in diag_fail where they or the device
 * are wrong. */
LiveJoystick *live_joystick_open(Pool *pool, const LivePort *port, const Model *model, const Scene *scene,
                                 const char *device, const char *axes);
/* What it has said before the step at `time`, into value [inputs]; *by: who has the inputs now. Where the device is
 * gone a warning says so, and the scene has them again. */
void live_joystick_take(LiveJoystick *joystick, double time, HoldBy *by, double *value);
/* True while it has the inputs. NULL: there is none. */
bool live_joystick_has(const LiveJoystick *joystick);
void live_joystick_close(LiveJoystick *joystick);

/* ---- live_clock.c: deadlines --------------------------------------------------------------------------------------
 */

enum { SPREAD_BINS = 19 };

/* How often durations had which size. */
typedef struct Spread {
    int64_t count, bin[SPREAD_BINS];
    double sum, most; /* s */
} Spread;

void spread_add(Spread *spread, double seconds);
/* The largest duration in a bin, s; INFINITY: the last one. */
double spread_end(int bin);

/* Deadlines at equal distances. */
typedef struct LiveClock {
    int64_t first; /* ns of CLOCK_MONOTONIC */
    double step;   /* s */
} LiveClock;

int64_t live_now(clockid_t clock); /* ns */
int64_t live_due(const LiveClock *clock, int64_t number);
void live_wait(int64_t until);
/* The clock is set anew where it is more than a second behind, and so late is a deadline: true. */
bool live_behind(LiveClock *clock, int64_t late);

/* What has been done for the calling thread, to be taken back. */
typedef struct LiveRank {
    bool raised, locked;
    int policy, priority; /* before */
} LiveRank;

/* Lock the memory that there is and raise the scheduling of this thread where that is allowed, with warnings where not.
 */
LiveRank live_rank_raise(bool quiet);
void live_rank_restore(const LiveRank *rank);

/* A thread that keeps the same deadlines half a step later and does nothing else: how late it is the system is. */
typedef struct LiveBare {
    pthread_t thread;
    LiveClock clock;
    _Atomic double leaves; /* s, what a step of mean length leaves of its time; by the thread that makes steps */
    atomic_bool over;
    int64_t misses; /* times that it was later than that */
    Spread late;
} LiveBare;

/* false: there is no thread */
bool live_bare_start(LiveBare *bare, const LiveRank *rank);
void live_bare_stop(LiveBare *bare);
/* Start a thread that no signal interrupts, with a small stack. policy -1: as usual. */
bool live_thread(pthread_t *thread, int policy, int priority, void *(*work)(void *), void *context);

/* ---- live_record.c: tables that another thread writes -------------------------------------------------------------
 */

typedef struct LiveRecord LiveRecord;

/* Results into a file, and inputs as they are held into another one, with their columns; NULL: none. Fails if they
 * can't be made. */
LiveRecord *live_record_open(Pool *pool, const Model *model, const Scene *scene, const char *results,
                             const char *inputs);
/* A row: time, then the scene's columns. */
void live_record_results(LiveRecord *record, const double *value);
/* A row of the other table. */
void live_record_inputs(LiveRecord *record, double time, HoldBy by, const double *value);
/* Write what is left; exits with a message where not all could be written. */
void live_record_close(LiveRecord *record);

#endif
