/* SPDX-License-Identifier: MIT
 * Files written under a temporary name and renamed, and the signals that are held back meanwhile. */
#define _DEFAULT_SOURCE /* mkstemps */
#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char letters[] = "XXXXXX", end[] = ".tmp";

FILE *temporary_open(Pool *pool, const char *path, char **name)
{
    *name = pool_print(pool, "%s.%s%s", path, letters, end);
    const int file = mkstemps(*name, sizeof end - 1);
    if (file < 0)
        return NULL;
    /* the permissions that fopen() would give, by the user's mask */
    const mode_t mask = umask(0);
    umask(mask);
    FILE *stream = fchmod(file, 0666 & ~mask) ? NULL : fdopen(file, "wb");
    if (!stream) {
        const int reason = errno;
        close(file);
        unlink(*name);
        errno = reason;
    }
    return stream;
}

/* True if the name is that of a temporary file of `of`. */
static bool is_temporary(const char *name, const char *of)
{
    const size_t head = strlen(of), size = head + 1 + strlen(letters) + strlen(end);
    return strlen(name) == size && !strncmp(name, of, head) && name[head] == '.' &&
           !strcmp(name + size - strlen(end), end);
}

void temporary_clear(Pool *pool, const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const char *folder = slash ? pool_print(pool, "%.*s", (int)(slash + 1 - path), path) : ".";
    DIR *all = opendir(folder);
    for (const struct dirent *entry; all && (entry = readdir(all));)
        if (is_temporary(entry->d_name, name))
            unlink(pool_print(pool, "%s/%s", folder, entry->d_name));
    if (all)
        closedir(all);
}

/* True if a signal ends the program by default and can come at any time. */
static bool can_stop(int number)
{
    static const int others[] = {SIGKILL, SIGSTOP, SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT, SIGCHLD, SIGURG, SIGWINCH,
                                 /* signals of errors in the program itself */
                                 SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};
    for (size_t i = 0; i < sizeof others / sizeof *others; ++i)
        if (number == others[i])
            return false;
    return true;
}

sigset_t stop_signals(void)
{
    sigset_t set;
    sigemptyset(&set);
    for (int number = 1; number <= SIGNAL_MOST; ++number) {
        struct sigaction action;
        if (can_stop(number) && !sigaction(number, NULL, &action) && !(action.sa_flags & SA_SIGINFO) &&
            action.sa_handler == SIG_DFL)
            sigaddset(&set, number);
    }
    return set;
}
