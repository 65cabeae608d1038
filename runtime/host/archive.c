/* SPDX-License-Identifier: MIT
 * A zip archive by minizip. It writes files alone, and where memory ends it falls over a null pointer; so a child
 * writes a file without a name. */
#include "host/archive.h"
#include "base/pool.h"
#include "host/host.h"

#include <errno.h>
#include <minizip/zip.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

void member_add(Members *members, const char *name, const char *bytes, size_t size)
{
    *POOL_PUSH(members->pool, members->member, members->count) = (Member){name, bytes, size};
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const Member *)a)->name, ((const Member *)b)->name);
}

static bool add(zipFile zip, const Member *member)
{
    /* 1 January 1980, the first day that archives know */
    const zip_fileinfo info = {.dosDate = 1u << 21 | 1u << 16};
    return zipOpenNewFileInZip(zip, member->name, &info, NULL, 0, NULL, 0, NULL, Z_DEFLATED, 9) == ZIP_OK &&
           zipWriteInFileInZip(zip, member->bytes, (unsigned)member->size) == ZIP_OK &&
           zipCloseFileInZip(zip) == ZIP_OK;
}

/* The open file that `file` points to; the name is ignored. */
static voidpf open_given(voidpf file, const char *name, int mode)
{
    (void)name;
    (void)mode;
    return fdopen(*(int *)file, "wb+");
}

static bool write_members(const Members *members, int file)
{
    zlib_filefunc_def functions;
    fill_fopen_filefunc(&functions);
    functions.zopen_file = open_given;
    functions.opaque = &file;
    zipFile zip = zipOpen2("", APPEND_STATUS_CREATE, NULL, &functions);
    bool good = zip != NULL;
    for (int i = 0; good && i < members->count; ++i)
        good = add(zip, &members->member[i]);
    return good && zipClose(zip, NULL) == ZIP_OK;
}

/* True if a child wrote the file whole; else errno is set. */
static bool write_apart(const Members *members, int file)
{
    int status;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        _exit(write_members(members, file) ? 0 : errno == ENOSPC || errno == EDQUOT ? errno : EIO);
    if (child < 0)
        return false;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return false;
    errno = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status) == SIGXFSZ ? EFBIG : ENOMEM;
    return errno == 0;
}

const char *archive_bytes(Members *members, size_t *size)
{
    const int file = nameless_file(members->pool);
    if (file < 0)
        return NULL;
    qsort(members->member, (size_t)members->count, sizeof *members->member, by_name);
    const bool good = write_apart(members, file);
    const int reason = errno;
    const char *bytes = good ? nameless_bytes(members->pool, file, size) : NULL;
    close(file);
    errno = reason;
    return bytes;
}
