/* SPDX-License-Identifier: MIT
 * A zip archive by minizip, written to a temporary file, because minizip writes to files alone. */
#include "base/archive.h"
#include "base/file.h"
#include "base/pool.h"

#include <minizip/zip.h>
#include <stdlib.h>
#include <string.h>
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

const char *archive_bytes(Members *members, const char *folder, size_t *size, const char **why)
{
    const char *path = pool_print(members->pool, "%s/archive", folder), *bytes = NULL;
    zipFile zip = zipOpen(path, APPEND_STATUS_CREATE);
    bool good = zip != NULL;
    qsort(members->member, (size_t)members->count, sizeof *members->member, by_name);
    for (int i = 0; good && i < members->count; ++i)
        good = add(zip, &members->member[i]);
    if (zip)
        good = zipClose(zip, NULL) == ZIP_OK && good;
    if (good)
        bytes = file_read(members->pool, path, TABLE_MOST, size);
    else
        *why = pool_print(members->pool, "the archive can't be written in %s", folder);
    unlink(path);
    return bytes;
}
