/* SPDX-License-Identifier: MIT
 * The shape of a body for the page of gicrun --animate: `shape` of FORMAT.md section 3, and Wavefront OBJ files. */
#include "base/file.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/read.h"
#include "read/reader.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *const shape_type_name[SHAPE_TYPES] = {
    [SHAPE_BOX] = "box", [SHAPE_CYLINDER] = "cylinder", [SHAPE_MESH] = "mesh"};

enum { LOOK_TYPE, LOOK_SIZE, LOOK_RADIUS, LOOK_LENGTH, LOOK_AXIS, LOOK_CENTER, LOOK_FILE, LOOK_SCALE, LOOK_KEYS };

#define SOLID (FORM(SHAPE_BOX) | FORM(SHAPE_CYLINDER))

static const Key shape_key[LOOK_KEYS] = {
    [LOOK_TYPE] = {"type", KEY_TYPE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [LOOK_SIZE] = {"size", KEY_VECTOR, FORM(SHAPE_BOX), 0, BOUND_NONE, 0},
    [LOOK_RADIUS] = {"radius", KEY_NUMBER, FORM(SHAPE_CYLINDER), 0, BOUND_POSITIVE, 0},
    [LOOK_LENGTH] = {"length", KEY_NUMBER, FORM(SHAPE_CYLINDER), 0, BOUND_POSITIVE, 0},
    [LOOK_AXIS] = {"axis", KEY_AXIS, FORM(SHAPE_CYLINDER), 0, BOUND_NONE, 0},
    [LOOK_CENTER] = {"center", KEY_POINT, SOLID, 0, BOUND_NONE, 0},
    [LOOK_FILE] = {"file", KEY_PATH, FORM(SHAPE_MESH), FORM(SHAPE_MESH), BOUND_NONE, 0},
    [LOOK_SCALE] = {"scale", KEY_NUMBER, FORM(SHAPE_MESH), 0, BOUND_POSITIVE, 1},
};

static const char *const shape_about[LOOK_KEYS] = {
    [LOOK_TYPE] = "box, cylinder, or mesh for an OBJ file",
    [LOOK_SIZE] = "edges along the axes of the body frame, m; default: those of a solid of the body's inertia",
    [LOOK_RADIUS] = "m; default: of a solid of the body's inertia",
    [LOOK_LENGTH] = "m; default: of a solid of the body's inertia",
    [LOOK_AXIS] = "direction of the cylinder at design, model frame; default: as the inertia suggests",
    [LOOK_CENTER] = "middle at design, m, model frame; default: com",
    [LOOK_FILE] = "path of an .obj file, from the folder of the file that it stands in; corners in the body frame",
    [LOOK_SCALE] = "m for a unit of the .obj file; default 1",
};

const Section shape_section = {shape_key, LOOK_KEYS, shape_type_name, SHAPE_TYPES, shape_type_name, NULL, shape_about};

/* ---- OBJ files ---------------------------------------------------------------------------------------------- */

static const size_t obj_most = 16 << 20; /* bytes */
enum { MOST_TRIANGLES = 100000 };        /* about 3 MB of the page */

typedef struct Obj {
    const Reader *reader;
    Place at; /* of the line that is read */
    BodyShape *shape;
    double scale[3];
} Obj;

/* The next word of a line, which blanks separate; NULL: none. */
static char *next_word(char **line)
{
    char *word = *line + strspn(*line, " \t\r");
    size_t length = strcspn(word, " \t\r");
    *line = word + length + (word[length] != 0);
    word[length] = 0;
    return length ? word : NULL;
}

static void read_corner(Obj *obj, char *line)
{
    BodyShape *shape = obj->shape;
    double(*corner)[3] = POOL_PUSH(obj->reader->pool, shape->corner, shape->corners);
    for (int i = 0; i < 3; ++i) {
        char *end, *word = next_word(&line);
        const double x = word ? strtod(word, &end) : 0;
        if (!word || *end || !isfinite(x))
            diag_fail(obj->at, "write `v x y z`", "a corner needs three finite numbers, not '%s'", word ? word : "");
        (*corner)[i] = x * obj->scale[i];
        if (!(fabs((*corner)[i]) <= 1e4))
            diag_fail(obj->at, "give `scale`, metres for a unit of the file, for example 0.001",
                      "a corner is more than 10 km from the body");
    }
}

/* The corner that a word of a face names: counted from 1, or backwards from -1; /texture/normal after it is skipped. */
static int face_corner(const Obj *obj, const char *word)
{
    char *end;
    const long index = strtol(word, &end, 10), count = obj->shape->corners;
    if (end == word || (*end && *end != '/') || strspn(end, "/-0123456789") != strlen(end))
        diag_fail(obj->at, "write `f 1 2 3`, or `f 1/1/1 2/2/2 3/3/3`", "'%s' names no corner of a face", word);
    if (index == 0 || index > count || index < -count)
        diag_fail(obj->at, "export the file again; corners must stand before the faces that they belong to",
                  "a face has corner %ld, and the file has %ld before it", index, count);
    return (int)(index > 0 ? index - 1 : count + index);
}

/* Split a face into a fan of triangles; for a mirror image their order is reversed. */
static void read_face(Obj *obj, char *line)
{
    BodyShape *shape = obj->shape;
    const bool turned = obj->scale[1] < 0;
    int corner[3] = {0}, count = 0;
    for (char *word; (word = next_word(&line)); ++count) {
        corner[count < 2 ? count : 2] = face_corner(obj, word);
        if (count < 2)
            continue;
        if (shape->triangles == MOST_TRIANGLES)
            diag_fail(obj->at, "reduce the mesh", "the file has more than %d triangles", MOST_TRIANGLES);
        int(*triangle)[3] = POOL_PUSH(obj->reader->pool, shape->triangle, shape->triangles);
        memcpy(*triangle, (int[]){corner[0], corner[turned ? 2 : 1], corner[turned ? 1 : 2]}, sizeof *triangle);
        corner[1] = corner[2];
    }
    if (count < 3)
        diag_fail(obj->at, "write `f 1 2 3`", "a face needs three corners at least");
}

static void read_line(Obj *obj, char *line)
{
    static const char *const skipped[] = {"vt", "vn", "vp", "o", "g", "s", "l", "p", "usemtl", "mtllib"};
    const char *word = next_word(&line);
    if (!word || word[0] == '#')
        return;
    for (size_t i = 0; i < sizeof skipped / sizeof *skipped; ++i)
        if (!strcmp(word, skipped[i]))
            return;
    if (!strcmp(word, "v"))
        read_corner(obj, line);
    else if (!strcmp(word, "f"))
        read_face(obj, line);
    else
        diag_fail(obj->at, "export a mesh of polygons as Wavefront OBJ: lines `v x y z` and `f 1 2 3`",
                  "'%.20s' begins no line of a mesh", word);
}

/* mirrored: the body is the mirror image of the one in the file. */
static void obj_read(const Reader *reader, const Item *item, double scale, bool mirrored, BodyShape *shape)
{
    Pool *pool = reader->pool;
    struct stat identity;
    const char *path = path_check(pool, item, item->at.source->path, item->text, "show", &identity);
    const Source *source = source_read(pool, path, obj_most, item->at.source);
    char *text = pool_print(pool, "%s", source->bytes);
    Obj obj = {reader, {source, 0, 1}, shape, {scale, mirrored ? -scale : scale, scale}};
    if (strlen(text) != source->size)
        diag_fail((Place){source, 0, 0}, "export it as Wavefront OBJ, which is text", "this is no text");
    for (char *line = text, *end; line; line = end) {
        ++obj.at.line;
        end = strchr(line, '\n');
        if (end)
            *end++ = 0;
        read_line(&obj, line);
    }
    if (!shape->triangles)
        diag_fail((Place){source, 0, 0}, "export a mesh of polygons", "the file has no face, a line `f 1 2 3`");
    shape->file = item->text;
}

/* ---- shapes ------------------------------------------------------------------------------------------------- */

/* `shape: box`, `cylinder` or `name.obj`. */
static void word_read(const Reader *reader, const Item *item, const Entry *body, BodyShape *shape)
{
    const char *word = doc_word(item, pool_print(reader->pool, "shape of %s", body->what));
    for (int i = 0; i < SHAPE_MESH; ++i)
        if (!strcmp(word, shape_type_name[i])) {
            shape->type = (ShapeType)i;
            return;
        }
    if (!path_ends(word, ".obj"))
        diag_fail(item->at, "write box, cylinder, the name of an .obj file, or {type: box, size: [x, y, z]}",
                  "shape of %s: there is no shape '%s'", body->what, word);
    shape->type = SHAPE_MESH;
    obj_read(reader, item, 1, item->negated, shape);
}

static void map_read(Reader *reader, const Item *item, const Entry *body, int index, BodyShape *shape)
{
    const Entry entry = {"shape", pool_print(reader->pool, "shape of %s", body->what), item->at, item};
    Value value[LOOK_KEYS];
    shape->type = (ShapeType)section_type(reader, &shape_section, &entry);
    reader->fixed = true;
    section_read(reader, &shape_section, (int)shape->type, &entry, value);
    reader->fixed = false;
    memcpy(shape->size, value[LOOK_SIZE].number, sizeof shape->size);
    for (int i = 0; i < 3 && value[LOOK_SIZE].item; ++i)
        if (!(shape->size[i] > 0))
            diag_fail(value[LOOK_SIZE].item->at, "write three numbers greater than zero",
                      "size of %s: edges must be positive", entry.what);
    shape->radius = value[LOOK_RADIUS].number[0];
    shape->length = value[LOOK_LENGTH].number[0];
    if (value[LOOK_AXIS].item) {
        shape->along = true;
        body_direction(reader, index, value[LOOK_AXIS].number, value[LOOK_AXIS].tuned, shape->axis);
    }
    if (value[LOOK_CENTER].item) {
        shape->placed = true;
        body_point(reader, index, value[LOOK_CENTER].number, value[LOOK_CENTER].tuned, value[LOOK_CENTER].item->at,
                   shape->center);
    }
    const Item *file = value[LOOK_FILE].item;
    if (file && !path_ends(value[LOOK_FILE].text, ".obj"))
        diag_fail(file->at, "export it as Wavefront OBJ, whose names end in .obj", "'%s' is no .obj file",
                  value[LOOK_FILE].text);
    if (file)
        obj_read(reader, file, value[LOOK_SCALE].number[0], file->negated, shape);
}

const BodyShape *shape_read(Reader *reader, const Item *item, const Entry *body, int index)
{
    if (!item)
        return NULL;
    BodyShape *shape = pool_alloc(reader->pool, sizeof *shape);
    *shape = (BodyShape){.at = item->at};
    if (item->kind == ITEM_MAP)
        map_read(reader, item, body, index, shape);
    else
        word_read(reader, item, body, shape);
    return shape;
}
