/* SPDX-License-Identifier: MIT
 *
 * archive: zip archives in memory, with the same bytes for the same files: names sorted and one date for all. For
 * programs that link minizip. */
#ifndef HOST_ARCHIVE_H
#define HOST_ARCHIVE_H

#include "base/pool.h"

#include <stddef.h>

typedef struct Member {
    const char *name, *bytes;
    size_t size;
} Member;

/* Files of an archive, by name once sorted. */
typedef struct Members {
    Pool *pool;
    int count;
    Member *member;
} Members;

void member_add(Members *members, const char *name, const char *bytes, size_t size);
/* All of them as bytes of a zip archive. NULL: it can't be written into the temporary folder, errno says why. */
const char *archive_bytes(Members *members, size_t *size);

#endif
