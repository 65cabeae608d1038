/* SPDX-License-Identifier: MIT
 *
 * read: from a `.veh` file to its model. */
#ifndef READ_READ_H
#define READ_READ_H

#include "base/text.h"
#include "model/model.h"

extern const char *const shape_type_name[SHAPE_TYPES];

/* schema.c: a JSON Schema of `.veh` files for editors, and all keys as a table for people; both are made from the
 * reader's tables. */
void schema_print(Text *out);
void keys_print(Text *out);

/* Read and resolve a `.veh` file. Any mistake ends in diag_fail. */
const Model *model_read(Pool *pool, const char *path);
/* The same from a text in memory, zero-terminated after `size` bytes; path: of the file that it is in place of. */
const Model *model_read_text(Pool *pool, const char *path, const char *text, size_t size);
/* A model of its own from the bytes that an earlier one was read from; files that it names must still be there. */
const Model *model_read_again(Pool *pool, const Model *earlier);
/* A number of a model's file: a parameter by its name, or a coordinate of a named point, POINT.x, .y or .z. */
typedef struct FileNumber {
    const char *name;
    double value;
} FileNumber;

/* The same with other numbers in place of those of the file, whose mirror images follow. A name that it does not have
 * ends in diag_fail. */
const Model *model_read_set(Pool *pool, const Model *earlier, const FileNumber *setting, int count);
/* The same, and then with values of the tunable parameters, mirror images among them: parameter [parameters of the
 * earlier model, by their index], SI. Geometric ones become numbers: a model without a tuning. */
const Model *model_read_fixed(Pool *pool, const Model *earlier, const FileNumber *setting, int count,
                              const double *parameter);
/* True: the model's file has a number of this name. */
bool model_has_number(Pool *pool, const Model *model, const char *name);
/* A copy of the model with hidden outputs of each wheel: of type wheel, and with a tire also tire and contact, unless
 * it has them. */
const Model *model_watch_wheels(Pool *pool, const Model *model);
/* The same with hidden outputs of a body, the last ones: place of a point in its frame, m, acceleration of that, roll,
 * pitch and yaw, angular velocity; three each, in the world. */
const Model *model_watch_body(Pool *pool, const Model *model, int body, const double point[3]);

#endif
