/* SPDX-License-Identifier: MIT
 *
 * arrays: matrices, vectors and lists of texts with names, as files that NumPy, MATLAB and others load. The same arrays
 * give the same bytes: no date is written. */
#ifndef HOST_ARRAYS_H
#define HOST_ARRAYS_H

#include "base/pool.h"

enum { ARRAY_SCALAR, ARRAY_VECTOR, ARRAY_MATRIX };

/* Numbers [rows][columns], of a vector [rows], of a scalar one; or a vector of texts in UTF-8. */
typedef struct NamedArray {
    const char *name; /* a name of NumPy and MATLAB, of at most 19 characters */
    int shape, rows, columns;
    const double *number;    /* NULL: texts */
    const char *const *text; /* [rows] */
} NamedArray;

/* A zip archive of .npy files of version 1.0, for numpy.load(); texts as unicode. Ends in diag_fail where it can't be
 * written. */
void npz_write(Pool *pool, const char *path, const NamedArray *array, int count);
/* A MAT-file of level 4, for MATLAB's load(), Octave, SciPy: vectors are columns, texts the rows of a matrix of
 * characters, filled with blanks. */
void mat_write(Pool *pool, const char *path, const NamedArray *array, int count);

#endif
