/* SPDX-License-Identifier: MIT
 * Runs are shared out among processes: each takes the next runs by a counter in shared memory and sends back their
 * results. Processes rather than threads, since engines and the libraries that they use keep state of their own, and
 * no process waits for another. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

enum { LOOK_MS = 100 /* between looks at who wants to stop */ };

/* In front of the texts of a result, in a pipe. */
typedef struct Parcel {
    int64_t run;
    int status;
    uint32_t row, reason; /* sizes with the 0 at the end; reason 0: none */
} Parcel;

typedef struct Worker {
    pid_t process;
    int pipe;   /* -1: it is finished, */
    int status; /* as waitpid() says */
    int said;   /* its standard error: what ends all of them is told once */
    Text heard; /* bytes of a parcel that is not complete */
} Worker;

int share_processes(void)
{
    const char *wanted = getenv("OMP_NUM_THREADS");
    char *end;
    const long number = wanted ? strtol(wanted, &end, 10) : 0;
    const long most = number > 0 ? number : sysconf(_SC_NPROCESSORS_ONLN);
    return most < 1 ? 1 : most > SHARE_PROCESSES_MOST ? SHARE_PROCESSES_MOST : (int)most;
}

/* ---- the worker ------------------------------------------------------------------------------------------------- */

/* The other end is gone: so are we, by SIGPIPE or here. */
static void send_bytes(int pipe, const void *bytes, size_t size)
{
    for (const char *next = bytes; size;) {
        const ssize_t n = write(pipe, next, size);
        if (n < 0 && errno != EINTR)
            _exit(1);
        next += n < 0 ? 0 : n;
        size -= n < 0 ? 0 : (size_t)n;
    }
}

/* What a process works on. */
typedef struct Work {
    const Share *share;
    _Atomic int64_t *taken;
    int pipe;
} Work;

static int64_t next_run(void *context)
{
    const Work *work = context;
    const int64_t i = atomic_fetch_add(work->taken, 1);
    return i < work->share->count ? work->share->run[i] : -1;
}

static void send_result(void *context, const RunResult *result)
{
    const Work *work = context;
    const Parcel parcel = {result->run, result->status, (uint32_t)strlen(result->row) + 1,
                           result->reason ? (uint32_t)strlen(result->reason) + 1 : 0};
    send_bytes(work->pipe, &parcel, sizeof parcel);
    send_bytes(work->pipe, result->row, parcel.row);
    send_bytes(work->pipe, result->reason, parcel.reason);
}

static void make(void *context)
{
    const Work *work = context;
    (void)work->share->make(work->share->context, &(Supply){next_run, send_result, context});
}

/* A failure ends this process, whoever called, with its message. */
static _Noreturn void work(const Share *share, _Atomic int64_t *taken, int pipe)
{
    const Listener *listener = caught_listener();
    const Listener ours = {.program = program_place().source,
                           .signals = !catching() || (listener && listener->signals)};
    Messages said = {NULL, NULL, &ours};
    const bool good = caught(&said, make, &(Work){share, taken, pipe});
    for (const Message *message = said.first; message; message = message->next)
        fputs(message->printed, stderr);
    _exit(good ? 0 : 1);
}

/* ---- whom they work for -------------------------------------------------------------------------------------------
 */

/* Start one more process. False: the system starts no more. */
static bool start(Pool *pool, const Share *share, _Atomic int64_t *taken, Worker *all, size_t workers)
{
    Worker *worker = &all[workers];
    int ends[2];
    *worker = (Worker){.said = nameless_file(pool), .heard = {.pool = pool}};
    if (worker->said < 0 || pipe(ends))
        return false;
    fflush(NULL); /* or the child would write it too */
    const pid_t parent = getpid();
    worker->process = fork();
    if (worker->process == 0) {
        close(ends[0]);
        for (size_t w = 0; w < workers; ++w) /* each pipe has one reader: who writes learns of its end */
            close(all[w].pipe);
        close(share->lock); /* held by its parent alone, so that it ends with it */
        dup2(worker->said, STDERR_FILENO);
#ifdef __linux__
        prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
        if (getppid() != parent)
            _exit(1);
        work(share, taken, ends[1]);
    }
    close(ends[1]);
    worker->pipe = worker->process > 0 ? ends[0] : -1;
    if (worker->process < 0)
        close(ends[0]);
    return worker->process > 0;
}

/* Take the complete parcels from the bytes that a worker has sent; texts of results point into them. Returns their
 * number. */
static int open_parcels(Pool *pool, Worker *worker, RunResult **result, int results)
{
    const Text heard = worker->heard;
    size_t at = 0;
    for (Parcel parcel; heard.size - at >= sizeof parcel;) {
        memcpy(&parcel, heard.s + at, sizeof parcel);
        if (heard.size - at - sizeof parcel < (size_t)parcel.row + parcel.reason)
            break;
        const char *row = heard.s + at + sizeof parcel;
        *POOL_PUSH(pool, *result, results) =
            (RunResult){parcel.run, parcel.status, row, parcel.reason ? row + parcel.row : NULL};
        at += sizeof parcel + parcel.row + parcel.reason;
    }
    if (at) {
        worker->heard = (Text){.pool = heard.pool};
        text_add(&worker->heard, heard.s + at, heard.size - at);
    }
    return results;
}

/* Read the bytes that have come from a worker, or notice its end. */
static void hear(Worker *worker)
{
    char bytes[65536];
    const ssize_t n = read(worker->pipe, bytes, sizeof bytes);
    if (n > 0)
        text_add(&worker->heard, bytes, (size_t)n);
    if (n > 0 || (n < 0 && errno == EINTR))
        return;
    close(worker->pipe);
    worker->pipe = -1;
    while (waitpid(worker->process, &worker->status, 0) < 0 && errno == EINTR)
        ;
}

/* The message of a worker that failed, or how it ended. */
static _Noreturn void fail_as(Pool *pool, const Worker *worker)
{
    if (WIFSIGNALED(worker->status))
        diag_fail(program_place(), "finished runs are kept: the same command goes on",
                  "a process that made runs was ended by signal %d", WTERMSIG(worker->status));
    diag_fail_as(nameless_text(pool, worker->said));
}

static void end_all(Worker *worker, size_t workers)
{
    for (size_t w = 0; w < workers; ++w)
        if (worker[w].pipe >= 0)
            kill(worker[w].process, SIGKILL);
}

/* All of them, where a failure ends a call and not the program. */
typedef struct Workers {
    _Atomic int64_t *taken;
    Worker *worker;
    size_t count;
} Workers;

static void let_go(void *context)
{
    const Workers *all = context;
    end_all(all->worker, all->count);
    for (size_t w = 0; w < all->count; ++w) {
        if (all->worker[w].pipe >= 0) {
            close(all->worker[w].pipe);
            waitpid(all->worker[w].process, NULL, 0);
        }
        close(all->worker[w].said);
    }
    munmap((void *)all->taken, sizeof *all->taken);
}

bool share_runs(Pool *pool, const Share *share, size_t processes)
{
    _Atomic int64_t *taken = mmap(NULL, sizeof *taken, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (taken == MAP_FAILED)
        diag_fail(program_place(), NULL, "no memory for the counter of runs: %s", strerror(errno));
    Worker *worker = pool_alloc(pool, processes * sizeof *worker);
    struct pollfd ready[processes];
    const Worker *broken = NULL;
    bool stopped = false;
    size_t workers = 0;
    Workers *all = pool_alloc(pool, sizeof *all);
    *all = (Workers){taken, worker, 0};
    caught_own(let_go, all);
    while (workers < processes && start(pool, share, taken, worker, workers))
        all->count = ++workers;
    if (!workers)
        diag_fail(program_place(), "try again when there are fewer of them", "can't start a process: %s",
                  strerror(errno));
    for (size_t open = workers; open;) {
        RunResult *result = NULL;
        int results = 0;
        for (size_t w = 0; w < workers; ++w) /* closed ones, which are negative, are passed over */
            ready[w] = (struct pollfd){.fd = worker[w].pipe, .events = POLLIN};
        const int some = poll(ready, workers, LOOK_MS);
        for (size_t w = 0; w < workers && some > 0; ++w) {
            if (!ready[w].revents)
                continue;
            hear(&worker[w]);
            open -= worker[w].pipe < 0;
            if (!broken && !stopped && worker[w].status) /* ending by end_all() is not a failure */
                broken = &worker[w];
            results = open_parcels(pool, &worker[w], &result, results);
        }
        const bool more = share->take(share->context, result, results);
        if (!stopped && (!more || broken)) {
            stopped = true;
            end_all(worker, workers);
        }
    }
    if (broken)
        fail_as(pool, broken);
    caught_disown(all);
    let_go(all);
    return !stopped;
}
