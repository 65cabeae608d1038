/* SPDX-License-Identifier: MIT
 * A reader for JSON, so that the reference has the dumped model from no code of the generator. */
#ifndef REFERENCE_JSON_H
#define REFERENCE_JSON_H

typedef enum JsonKind { JSON_NULL, JSON_BOOL, JSON_NUMBER, JSON_TEXT, JSON_LIST, JSON_OBJECT } JsonKind;

typedef struct Json {
    JsonKind kind;
    double number;      /* number; bool: 0 or 1 */
    char *text;         /* text */
    int count;          /* list: elements; object: members */
    struct Json **item; /* list: elements; object: values */
    char **key;         /* object: keys */
} Json;

/* Parse one terminated text; `name` is its file in messages. Bad JSON fails with the line. */
Json *json_parse(const char *text, const char *name);
void json_free(Json *json);
/* Value of a key; fails when `object` is no object or has no such key. */
const Json *json_get(const Json *object, const char *key);
/* A number; null is 0 (keys that don't apply to a type). */
double json_number(const Json *object, const char *key);
/* `size` numbers; null is all zero. */
void json_numbers(const Json *object, const char *key, double *out, int size);
/* A text, owned by the tree. */
const char *json_text(const Json *object, const char *key);

#endif
