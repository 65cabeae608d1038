/* SPDX-License-Identifier: MIT
 *
 * The plug-in that calls HDF5. Tables of sweeps alone need it, and only where they are asked for in this form: so
 * programs are built without it, and load plugin/hdf5_plugin.c as a shared object then. The plug-in uses nothing of
 * theirs. */
#ifndef HOST_HDF5_H
#define HOST_HDF5_H

#include "base/pool.h"

#include <stdint.h>

typedef enum Hdf5Type { HDF5_DOUBLE, HDF5_INT64, HDF5_INT32 } Hdf5Type;

/* Numbers in a file, compressed in chunks. */
typedef struct Hdf5Numbers {
    const char *path;                  /* "/group/name"; the group is there */
    Hdf5Type type;                     /* in the file; all are passed as double */
    int64_t rows, columns;             /* columns 0: an array of one dimension */
    int64_t chunk_rows, chunk_columns; /* of a chunk, at most rows and columns */
} Hdf5Numbers;

/* Files have no times in them: the same calls make the same bytes. Functions return 0, or -1 where it went wrong;
 * texts are UTF-8. */
typedef struct Hdf5Plugin {
    void *(*create)(const char *path); /* NULL: failed. A file that is there is emptied. */
    int (*group)(void *file, const char *path);
    int (*numbers)(void *file, const Hdf5Numbers *numbers); /* their number, from 0 on in the order of calls */
    /* value[rows][columns] from row `first` on; whole chunks at once, or the last rows */
    int (*write)(void *file, int numbers, int64_t first, int64_t rows, const double *value);
    int (*attribute)(void *file, const char *path, const char *name, const char *text); /* of what is at a path */
    const char *(*why)(void *file);                   /* why the first function failed that did; NULL: none did */
    int (*close)(void *file, char *why, size_t size); /* why: gets the reason of a failure; frees the file */
} Hdf5Plugin;

/* The one symbol of the plug-in that programs look for; another number where Hdf5Plugin changes. */
#define HDF5_SYMBOL "gicsweep_hdf5_1"
extern const Hdf5Plugin gicsweep_hdf5_1;

/* Debian's package. */
#define HDF5_PACKAGES "libhdf5-dev"

#endif
