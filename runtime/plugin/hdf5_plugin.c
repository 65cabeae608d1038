/* SPDX-License-Identifier: MIT
 *
 * HDF5 as a shared object that programs load: host/hdf5.h. */
#include "host/hdf5.h"

#if __has_include(<hdf5.h>)
#include <hdf5.h>
#else /* Debian has the library in variants */
#include <hdf5/serial/hdf5.h>
#endif

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVEL = 4 /* of compression */, WHY = 200 };

typedef struct Numbers {
    hid_t set;
    int64_t columns; /* 0: one dimension */
} Numbers;

typedef struct File {
    hid_t file;
    int count;
    Numbers *numbers; /* [count] */
    char why[WHY];    /* "": nothing failed */
} File;

/* Of the stack of errors: what the system said, else the deepest description. */
static herr_t look(unsigned n, const H5E_error2_t *error, void *context)
{
    static const char system_said[] = "error message = '";
    char *why = context;
    const char *said = error->desc ? strstr(error->desc, system_said) : NULL;
    if (said)
        snprintf(why, WHY, "%.*s", (int)strcspn(said + strlen(system_said), "'"), said + strlen(system_said));
    else if (!n)
        snprintf(why, WHY, "%s", error->desc ? error->desc : "HDF5 does not say why");
    return said ? 1 : 0;
}

/* The value for a caller; what is below 0 is a failure of HDF5. */
static int done(File *f, int64_t result)
{
    if (result >= 0)
        return 0;
    if (!*f->why)
        H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look, f->why);
    if (!*f->why)
        snprintf(f->why, WHY, "HDF5 does not say why");
    return -1;
}

static void *create_file(const char *path)
{
    File *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    H5dont_atexit(); /* a file that could not be written is not tried again at the program's end */
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t root = H5Pcreate(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_link_creation_order(root, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(root, false);
    H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST);
    f->file = H5Fcreate(path, H5F_ACC_TRUNC, root, access);
    H5Pclose(root);
    H5Pclose(access);
    done(f, f->file);
    return f;
}

/* Members of a group are in the order in which they were made. */
static int make_group(void *file, const char *path)
{
    File *f = file;
    const hid_t how = H5Pcreate(H5P_GROUP_CREATE);
    H5Pset_link_creation_order(how, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(how, false);
    const hid_t group = H5Gcreate2(f->file, path, H5P_DEFAULT, how, H5P_DEFAULT);
    const int status = done(f, group);
    H5Pclose(how);
    if (group >= 0)
        H5Gclose(group);
    return status;
}

static int make_numbers(void *file, const Hdf5Numbers *n)
{
    File *f = file;
    const hid_t type[] = {H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_I32LE};
    const hsize_t size[] = {(hsize_t)n->rows, (hsize_t)n->columns};
    const hsize_t chunk[] = {(hsize_t)n->chunk_rows, (hsize_t)n->chunk_columns};
    const int dimensions = n->columns ? 2 : 1;
    Numbers *more = realloc(f->numbers, sizeof *more * ((size_t)f->count + 1));
    if (!more) {
        snprintf(f->why, WHY, "no memory");
        return -1;
    }
    f->numbers = more;
    const hid_t space = H5Screate_simple(dimensions, size, NULL), how = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(how, dimensions, chunk);
    H5Pset_shuffle(how);
    H5Pset_deflate(how, LEVEL);
    H5Pset_obj_track_times(how, false);
    const hid_t set = H5Dcreate2(f->file, n->path, type[n->type], space, H5P_DEFAULT, how, H5P_DEFAULT);
    const int status = done(f, set);
    H5Pclose(how);
    H5Sclose(space);
    if (status)
        return status;
    f->numbers[f->count] = (Numbers){set, n->columns};
    return f->count++;
}

static int write_numbers(void *file, int numbers, int64_t first, int64_t rows, const double *value)
{
    File *f = file;
    const Numbers *n = &f->numbers[numbers];
    const int dimensions = n->columns ? 2 : 1;
    const hsize_t from[] = {(hsize_t)first, 0}, size[] = {(hsize_t)rows, (hsize_t)n->columns};
    const hid_t in_file = H5Dget_space(n->set), in_memory = H5Screate_simple(dimensions, size, NULL);
    int status = done(f, H5Sselect_hyperslab(in_file, H5S_SELECT_SET, from, NULL, size, NULL));
    if (!status)
        status = done(f, H5Dwrite(n->set, H5T_NATIVE_DOUBLE, in_memory, in_file, H5P_DEFAULT, value));
    H5Sclose(in_memory);
    H5Sclose(in_file);
    return status;
}

static int add_attribute(void *file, const char *path, const char *name, const char *text)
{
    File *f = file;
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    const hid_t attribute = H5Acreate_by_name(f->file, path, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    int status = done(f, attribute);
    if (!status)
        status = done(f, H5Awrite(attribute, type, &text));
    if (attribute >= 0)
        H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    return status;
}

static const char *say_why(void *file)
{
    const File *f = file;
    return *f->why ? f->why : NULL;
}

static int close_file(void *file, char *why, size_t size)
{
    File *f = file;
    for (int i = 0; i < f->count; ++i)
        done(f, H5Dclose(f->numbers[i].set));
    if (f->file >= 0)
        done(f, H5Fclose(f->file));
    const int status = *f->why ? -1 : 0;
    snprintf(why, size, "%s", f->why);
    free(f->numbers);
    free(f);
    return status;
}

const Hdf5Plugin gicsweep_hdf5_1 = {.create = create_file,
                                    .group = make_group,
                                    .numbers = make_numbers,
                                    .write = write_numbers,
                                    .attribute = add_attribute,
                                    .why = say_why,
                                    .close = close_file};
