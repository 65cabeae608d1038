/* SPDX-License-Identifier: MIT
 * Other programs, and signals that ask to stop. Signals are polled: there is no handler and no global variable. */
#define _GNU_SOURCE /* program_invocation_short_name */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "host/host.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

Place program_place(void)
{
    static Source program;
    static const Source library = {.path = "gicrun"}; /* whose messages the library's are */
    const Listener *listener = caught_listener();
    if (catching())
        return (Place){listener && listener->program ? listener->program : &library, 0, 0};
    program.path = program_invocation_short_name;
    return (Place){&program, 0, 0};
}

/* A library leaves signals to its program, unless that leaves them to it: else hold and release do nothing. */
static bool left_alone(void)
{
    const Listener *listener = caught_listener();
    return catching() && !(listener && listener->signals);
}

void interrupt_hold(void)
{
    if (left_alone())
        return;
    sigset_t set = stop_signals();
    sigaddset(&set, SIGCHLD);
    signal(SIGCHLD, SIG_DFL); /* if SIGCHLD is inherited as ignored, a child's exit status is lost */
    sigprocmask(SIG_BLOCK, &set, NULL);
}

bool interrupt_arrived(void)
{
    if (left_alone())
        return false;
    sigset_t set = stop_signals(), pending;
    sigpending(&pending);
    for (int signal_number = 1; signal_number <= SIGNAL_MOST; ++signal_number)
        if (sigismember(&set, signal_number) == 1 && sigismember(&pending, signal_number) == 1)
            return true;
    return false;
}

void interrupt_take(void)
{
    if (left_alone())
        return;
    const sigset_t set = stop_signals();
    while (sigtimedwait(&set, NULL, &(struct timespec){0}) > 0)
        continue;
}

void interrupt_release(void)
{
    if (left_alone())
        return;
    sigset_t set = stop_signals();
    sigaddset(&set, SIGCHLD);
    sigprocmask(SIG_UNBLOCK, &set, NULL);
}

const char *temporary_folder(void)
{
    const char *folder = getenv("TMPDIR");
    return folder && *folder ? folder : "/tmp";
}

int nameless_file(Pool *pool)
{
    char *path = pool_print(pool, "%s/gicrun-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    if (file >= 0)
        unlink(path);
    return file;
}

static bool write_all(int file, const char *bytes, size_t size)
{
    while (size) {
        ssize_t n = write(file, bytes, size);
        if (n < 0)
            return false;
        bytes += n;
        size -= (size_t)n;
    }
    return lseek(file, 0, SEEK_SET) == 0;
}

const char *nameless_bytes(Pool *pool, int file, size_t *size)
{
    Text text = {.pool = pool};
    char buffer[4096];
    lseek(file, 0, SEEK_SET);
    for (ssize_t n; (n = read(file, buffer, sizeof buffer)) > 0;)
        text_add(&text, buffer, (size_t)n);
    text_add(&text, "", 0);
    *size = text.size;
    return text.s;
}

const char *nameless_text(Pool *pool, int file)
{
    size_t size;
    return nameless_bytes(pool, file, &size);
}

/* Start a child in its own process group: the terminal's Ctrl-C reaches it through us, and its children end with it. */
static int spawn(pid_t *child, char *const argv[], int input, int output, int errors)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigemptyset(&none);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, 0);
    posix_spawn_file_actions_adddup2(&actions, output, 1);
    posix_spawn_file_actions_adddup2(&actions, errors, 2);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    int error = posix_spawnp(child, argv[0], &actions, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

/* Wait for the child or for a held signal, which ends the child and stays pending. */
static int await(pid_t child)
{
    sigset_t set = stop_signals();
    sigaddset(&set, SIGCHLD);
    int status;
    if (left_alone()) {
        pid_t ended;
        while ((ended = waitpid(child, &status, 0)) < 0 && errno == EINTR)
            continue;
        return ended < 0 ? PROCESS_NOT_STARTED : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    while (waitpid(child, &status, WNOHANG) != child) {
        int signal_number = sigwaitinfo(&set, NULL);
        if (signal_number < 0 || signal_number == SIGCHLD)
            continue;
        kill(-child, SIGTERM);
        waitpid(child, &status, 0);
        raise(signal_number);
        return PROCESS_INTERRUPTED;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int process_run_into(Pool *pool, char *const argv[], const char *input, int output, const char **said)
{
    int in = nameless_file(pool), out = nameless_file(pool), result = PROCESS_NOT_STARTED;
    pid_t child;
    if (in < 0 || out < 0 || !write_all(in, input, strlen(input))) {
        *said = pool_print(pool, "no temporary file in %s: %s", temporary_folder(), strerror(errno));
    } else {
        int error = spawn(&child, argv, in, output < 0 ? out : output, out);
        if (error)
            *said = strerror(error);
        else
            result = await(child);
        if (!error)
            *said = nameless_text(pool, out);
    }
    if (in >= 0)
        close(in);
    if (out >= 0)
        close(out);
    return result;
}

int process_run(Pool *pool, char *const argv[], const char *input, const char **said)
{
    return process_run_into(pool, argv, input, -1, said);
}
