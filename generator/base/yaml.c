/* SPDX-License-Identifier: MIT
 * YAML into a tree of items with their places, and checked access to it. An alias shares the tree of its anchor, so
 * a document is never larger than its file; a walk over the tree visits at most a few values for each byte. */
#include "base/catch.h"
#include "base/file.h"
#include "base/yaml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { NESTING = 64, REMEDY = 1000, ANCHORS_MOST = 1000 /* each alias searches all anchors */ };

typedef struct Anchor {
    const char *name;
    Item *item;
    bool open;    /* still being read: an alias to it would be a cycle */
    int height;   /* levels of nesting below it */
    size_t items; /* items below this anchor; while it is open, the number of items before it */
} Anchor;

typedef struct Loader {
    Pool *pool;
    const Source *source;
    yaml_parser_t parser;
    Anchor *anchor;
    int anchors;
    size_t items;                       /* items so far, aliases counted as if written out */
    yaml_event_t live[2 * NESTING + 8]; /* events that are not yet dropped, for failures that are caught */
    int lives;
} Loader;

static Place place(const Loader *loader, yaml_mark_t mark)
{
    return (Place){loader->source, (int)mark.line + 1, (int)mark.column + 1};
}

static _Noreturn void syntax_fail(Loader *loader)
{
    const yaml_parser_t *parser = &loader->parser;
    if (parser->error == YAML_MEMORY_ERROR)
        out_of_memory();
    const char *problem = parser->problem ? parser->problem : "not readable";
    if (parser->error == YAML_READER_ERROR) {
        size_t offset = parser->problem_offset;
        if (strstr(problem, "trailing")) /* the parser reports the byte that announced the missing trailing one */
            do
                --offset;
            while (offset > 0 && ((unsigned char)loader->source->bytes[offset] & 0xc0) == 0x80);
        diag_fail(diag_place(loader->source, offset),
                  strstr(problem, "control") ? "take the character out" : "save the file as UTF-8 text",
                  "not a text file: %s", problem);
    }
    Place at = place(loader, parser->problem_mark);
    const char *remedy = "check indentation, colons, quotes and brackets here and just above";
    if (strstr(problem, "cannot start any token")) /* the character itself is the next one in the parser's buffer */
        remedy = *parser->buffer.pointer == '\t' ? "indent with spaces, not with tabs"
                                                 : "put quotes around a text that begins with a special character";
    if (parser->context)
        diag_fail(at, remedy, "not valid YAML: %s, %s", parser->context, problem);
    diag_fail(at, remedy, "not valid YAML: %s", problem);
}

static void next(Loader *loader, yaml_event_t *event)
{
    if (!yaml_parser_parse(&loader->parser, event))
        syntax_fail(loader);
    loader->live[loader->lives++] = *event;
}

/* Free the newest event. */
static void drop(Loader *loader, yaml_event_t *event)
{
    --loader->lives;
    yaml_event_delete(event);
}

static char *copy(Loader *loader, const void *bytes, size_t size)
{
    char *s = pool_alloc(loader->pool, size + 1);
    memcpy(s, bytes, size);
    return s;
}

/* Remember an item under its anchor; returns its index or -1. */
static int anchor_open(Loader *loader, const yaml_char_t *name, Item *item)
{
    if (!name)
        return -1;
    if (loader->anchors == ANCHORS_MOST)
        diag_fail(item->at, "write values out", "more than %d anchors in one file", ANCHORS_MOST);
    Anchor *anchor = POOL_PUSH(loader->pool, loader->anchor, loader->anchors);
    *anchor = (Anchor){copy(loader, name, strlen((const char *)name)), item, true, 0, loader->items};
    return loader->anchors - 1;
}

static void anchor_close(Loader *loader, int index, int height)
{
    if (index < 0)
        return;
    loader->anchor[index].open = false;
    loader->anchor[index].height = height;
    loader->anchor[index].items = loader->items - loader->anchor[index].items + 1;
}

static void check_tag(Place at, const yaml_char_t *tag)
{
    if (tag)
        diag_fail(at, "leave the tag away", "a YAML tag ('%s'); the format has none", (const char *)tag);
}

static void check_depth(Place at, int depth)
{
    if (depth > NESTING)
        diag_fail(at, "nothing in the format is nested more than a few levels", "nested deeper than %d levels",
                  NESTING);
}

static Item *alias(Loader *loader, const char *name, Place at, int depth, int *height)
{
    for (int i = loader->anchors - 1; i >= 0; --i) {
        const Anchor *anchor = loader->anchor + i;
        if (strcmp(anchor->name, name))
            continue;
        if (anchor->open)
            diag_fail(at, "write the value out", "alias '*%s' is inside the value it names", name);
        check_depth(at, depth + anchor->height);
        loader->items += anchor->items;
        if (loader->items > 1000 + 2 * loader->source->size)
            diag_fail(at, "use fewer aliases of large values", "with its aliases written out the file is too large");
        *height = anchor->height;
        return anchor->item;
    }
    const char **names = pool_alloc(loader->pool, sizeof *names * (size_t)(loader->anchors + 1));
    for (int i = 0; i < loader->anchors; ++i)
        names[i] = loader->anchor[i].name;
    const char *nearest = diag_nearest(name, names, loader->anchors);
    diag_fail(at,
              nearest ? pool_print(loader->pool, "did you mean '*%s'?", nearest)
                      : "put the anchor `&name` before the value, above this line",
              "alias '*%s' has no anchor", name);
}

static Item *scalar(Loader *loader, const yaml_event_t *event, Place at)
{
    Item *item = pool_alloc(loader->pool, sizeof *item);
    check_tag(at, event->data.scalar.tag);
    *item = (Item){.kind = ITEM_SCALAR, .at = at};
    item->text = copy(loader, event->data.scalar.value, event->data.scalar.length);
    item->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    if (memchr(item->text, 0, event->data.scalar.length))
        diag_fail(at, "leave \\0 away", "a text with a NUL character");
    anchor_close(loader, anchor_open(loader, event->data.scalar.anchor, item), 0);
    return item;
}

/* By text, then by place: equal keys become neighbours, in the order of the file. */
static int compare_keys(const void *a, const void *b)
{
    const Item *const *x = a, *const *y = b;
    int order = strcmp((*x)->text, (*y)->text);
    if (!order)
        order = ((*x)->at.line > (*y)->at.line) - ((*x)->at.line < (*y)->at.line);
    if (!order)
        order = ((*x)->at.column > (*y)->at.column) - ((*x)->at.column < (*y)->at.column);
    return order;
}

/* True if s is a group of three digits, maybe with decimals: the part after a separator of thousands. */
static bool is_group(const char *s)
{
    const size_t digits = strspn(s, "0123456789");
    return digits == 3 && (!s[3] || (s[3] == '.' && s[4 + strspn(s + 4, "0123456789")] == '\0'));
}

/* True if s is digits, maybe with an exponent: the part after a decimal comma. */
static bool is_fraction(const char *s)
{
    const size_t digits = strspn(s, "0123456789");
    const char *exponent = s + digits + (s[digits] == 'e' || s[digits] == 'E');
    exponent += exponent > s + digits && (*exponent == '-' || *exponent == '+');
    return digits && (!s[digits] || (*exponent && !exponent[strspn(exponent, "0123456789")]));
}

/* In braces YAML reads `25,000` as the number 25 and a key `000` without a value, `40,5` as 40 and a key `5`. */
static void check_commas(const Item *map)
{
    for (int i = 1; i < map->count; ++i) {
        const Item *number = map->value[i - 1], *rest = map->value[i];
        const char *after = map->key[i]->text;
        if (number->kind != ITEM_SCALAR || number->quoted || rest->kind != ITEM_SCALAR || rest->quoted ||
            rest->text[0] || !(is_group(after) || is_fraction(after)))
            continue;
        const char *digits = number->text + (number->text[0] == '-' || number->text[0] == '+');
        const size_t length = strspn(digits, "0123456789");
        char whole[64], remedy[192];
        int n = snprintf(whole, sizeof whole, "%s", number->text);
        if (length < 1 || digits[length] || n >= (int)sizeof whole)
            continue;
        if (is_group(after) && length <= 3 && digits[0] != '0') {
            for (int k = i; k < map->count && is_group(map->key[k]->text) && n < (int)sizeof whole; ++k)
                n += snprintf(whole + n, sizeof whole - (size_t)n, "%s", map->key[k]->text);
            const bool alone = strlen(after) == 3 && !(i + 1 < map->count && is_group(map->key[i + 1]->text));
            n = snprintf(remedy, sizeof remedy, "write %s, without a separator of thousands", whole);
            if (alone)
                snprintf(remedy + n, sizeof remedy - (size_t)n, ", or %s.%s with a decimal point", number->text, after);
        } else if (is_fraction(after)) {
            snprintf(remedy, sizeof remedy, "write %s.%.60s, with a decimal point", whole, after);
        } else {
            continue;
        }
        diag_fail(number->at, remedy, "the number ends at the comma: %s is %s, and %s would be a key",
                  map->key[i - 1]->text, number->text, after);
    }
}

static void check_duplicates(Loader *loader, const Item *map)
{
    if (map->count < 2)
        return;
    size_t size = sizeof *map->key * (size_t)map->count;
    Item **sorted = pool_grow(loader->pool, map->key, size, size);
    qsort(sorted, (size_t)map->count, sizeof *sorted, compare_keys);
    const Item *first = NULL, *second = NULL;
    for (int i = 1; i < map->count; ++i)
        if (!strcmp(sorted[i]->text, sorted[i - 1]->text) && (!second || sorted[i]->at.line < second->at.line)) {
            first = sorted[i - 1];
            second = sorted[i];
        }
    if (second)
        diag_fail(second->at, "rename or remove one of them", "'%s' is here twice; the first is in line %d",
                  second->text, first->at.line);
}

static Item *node(Loader *loader, yaml_event_t *event, int depth, int *height);

static Item *list(Loader *loader, const yaml_event_t *start, Place at, int depth, int *height)
{
    Item *item = pool_alloc(loader->pool, sizeof *item);
    *item = (Item){.kind = ITEM_LIST, .at = at};
    check_tag(at, start->data.sequence_start.tag);
    int anchor = anchor_open(loader, start->data.sequence_start.anchor, item);
    for (;;) {
        yaml_event_t event;
        next(loader, &event);
        if (event.type == YAML_SEQUENCE_END_EVENT) {
            drop(loader, &event);
            break;
        }
        int below = 0;
        Item *element = node(loader, &event, depth + 1, &below);
        *POOL_PUSH(loader->pool, item->value, item->count) = element;
        if (below + 1 > *height)
            *height = below + 1;
    }
    anchor_close(loader, anchor, *height);
    return item;
}

static Item *map(Loader *loader, const yaml_event_t *start, Place at, int depth, int *height)
{
    Item *item = pool_alloc(loader->pool, sizeof *item);
    *item = (Item){.kind = ITEM_MAP, .at = at};
    check_tag(at, start->data.mapping_start.tag);
    int anchor = anchor_open(loader, start->data.mapping_start.anchor, item), keys = 0;
    for (;;) {
        yaml_event_t event;
        next(loader, &event);
        if (event.type == YAML_MAPPING_END_EVENT) {
            drop(loader, &event);
            break;
        }
        int below = 0;
        Item *key = node(loader, &event, depth + 1, &below);
        if (key->kind != ITEM_SCALAR)
            diag_fail(key->at, "write `key: value`", "a key must be a word");
        if (!key->quoted && !strcmp(key->text, "<<"))
            diag_fail(key->at, "write the keys out, or alias a whole value: `key: *name`",
                      "merging with `<<` is not part of the format");
        if (keys == KEYS_MOST)
            diag_fail(key->at, "take some away", "a map with more than %d keys", KEYS_MOST);
        next(loader, &event);
        Item *value = node(loader, &event, depth + 1, &below);
        *POOL_PUSH(loader->pool, item->key, keys) = key;
        *POOL_PUSH(loader->pool, item->value, item->count) = value;
        if (below + 1 > *height)
            *height = below + 1;
    }
    check_commas(item);
    check_duplicates(loader, item);
    anchor_close(loader, anchor, *height);
    return item;
}

/* The item that begins with `event`; the event is consumed. *height: nesting levels in the item. */
static Item *node(Loader *loader, yaml_event_t *event, int depth, int *height)
{
    Place at = place(loader, event->start_mark);
    check_depth(at, depth);
    loader->items += event->type != YAML_ALIAS_EVENT;
    Item *item;
    switch (event->type) {
    case YAML_ALIAS_EVENT: item = alias(loader, (const char *)event->data.alias.anchor, at, depth, height); break;
    case YAML_SEQUENCE_START_EVENT: item = list(loader, event, at, depth, height); break;
    case YAML_MAPPING_START_EVENT: item = map(loader, event, at, depth, height); break;
    default: item = scalar(loader, event, at);
    }
    drop(loader, event);
    return item;
}

static const Item *read_tree(Pool *pool, Source *source);

const Item *doc_read(Pool *pool, const char *path)
{
    return read_tree(pool, source_read(pool, path, TEXT_MOST, NULL));
}

const Item *doc_read_text(Pool *pool, const char *path, const char *text, size_t size)
{
    return read_tree(pool, source_text(pool, path, text, size));
}

const Item *doc_read_again(Pool *pool, const Source *known)
{
    return read_tree(pool, source_again(pool, known));
}

const Item *doc_read_named(Pool *pool, const char *path, const Item *by, const char *const *key)
{
    Source *source = source_read(pool, path, TEXT_MOST, by->at.source);
    source->named_at = by->at;
    /* true if the document has only blanks and comments */
    bool empty = true;
    for (const char *s = source->bytes; *s && empty; s += strcspn(s, "\n"), s += *s == '\n')
        empty = strchr("#\n", s[strspn(s, " \t\r")]);
    bool known = empty;
    for (const char *const *k = key; *k && !known; ++k)
        known = strstr(source->bytes, *k);
    if (!known)
        diag_fail(by->at, pool_print(pool, "is it the file that was meant? Such a file has the key '%s'", key[0]),
                  "'%s' lacks the key '%s'", path, key[0]);
    return read_tree(pool, source);
}

static void release_loader(void *released)
{
    Loader *loader = released;
    while (loader->lives)
        yaml_event_delete(&loader->live[--loader->lives]);
    yaml_parser_delete(&loader->parser);
}

static const Item *read_tree(Pool *pool, Source *source)
{
    if (source->size >= 3 && !memcmp(source->bytes, "\xef\xbb\xbf", 3)) { /* byte order mark: not a column */
        source->bytes += 3;
        source->size -= 3;
    }
    Loader *loader = pool_alloc(pool, sizeof *loader);
    loader->pool = pool;
    loader->source = source;
    yaml_event_t event;
    if (!yaml_parser_initialize(&loader->parser))
        out_of_memory();
    caught_own(release_loader, loader);
    yaml_parser_set_encoding(&loader->parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&loader->parser, (const unsigned char *)source->bytes, source->size);
    do {
        next(loader, &event);
        if (event.type == YAML_STREAM_END_EVENT)
            diag_fail((Place){source, 1, 1},
                      "begin a model with `gicgen: 1` (models/FORMAT.md), a scene with `gicscene: 1` (models/SCENE.md)",
                      "the file is empty");
        yaml_event_type_t type = event.type;
        drop(loader, &event);
        if (type == YAML_DOCUMENT_START_EVENT)
            break;
    } while (true);
    int height = 0;
    next(loader, &event);
    const Item *item = node(loader, &event, 1, &height);
    next(loader, &event); /* the end of the document */
    drop(loader, &event);
    next(loader, &event);
    if (event.type != YAML_STREAM_END_EVENT)
        diag_fail(place(loader, event.start_mark),
                  "one file, one document: remove the line `---` or `...` between them",
                  "a second document in the file");
    drop(loader, &event);
    caught_disown(loader);
    yaml_parser_delete(&loader->parser);
    return item;
}

const Item *doc_find(const Item *map, const char *key)
{
    for (int i = 0; i < map->count; ++i)
        if (!strcmp(map->key[i]->text, key))
            return map->value[i];
    return NULL;
}

/* The kind of an item, for messages. */
static const char *found(const Item *item)
{
    if (item->kind != ITEM_SCALAR)
        return item->kind == ITEM_LIST ? "a list" : "a map";
    return item->text[0] || item->quoted ? item->text : "nothing";
}

/* Length of the decimal number at the start of s, 0: none. */
static size_t decimal(const char *s)
{
    static const char digits[] = "0123456789";
    size_t n = s[0] == '-' || s[0] == '+';
    size_t whole = strspn(s + n, digits), fraction = 0;
    n += whole;
    if (s[n] == '.') {
        fraction = strspn(s + n + 1, digits);
        n += 1 + fraction;
    }
    if (whole + fraction == 0)
        return 0;
    if (s[n] == 'e' || s[n] == 'E') {
        size_t sign = s[n + 1] == '-' || s[n + 1] == '+';
        size_t exponent = strspn(s + n + 1 + sign, digits);
        if (exponent)
            n += 1 + sign + exponent;
    }
    return n;
}

static bool is_decimal(const char *s)
{
    size_t n = decimal(s);
    return n > 0 && !s[n];
}

bool doc_is_decimal(const Item *item)
{
    return is_decimal(item->text);
}

/* True if s is a number with commas between groups of three digits. `0,300` is not: its comma is a decimal comma. */
static bool has_thousands(const char *s)
{
    const char *digits = s + (s[0] == '-' || s[0] == '+'), *comma = strchr(digits, ',');
    const size_t first = strspn(digits, "0123456789");
    if (!comma || comma != digits + first || first < 1 || first > 3 || digits[0] == '0')
        return false;
    for (; *comma == ','; comma += 4)
        if (strspn(comma + 1, "0123456789") != 3)
            return false;
    return !*comma || (*comma == '.' && !comma[1 + strspn(comma + 1, "0123456789")]);
}

static void without_commas(const char *s, char *out)
{
    for (; *s; ++s)
        if (*s != ',')
            *out++ = *s;
    *out = '\0';
}

/* What to write instead of `s`, which is not a number, at least not one of the format. */
static void number_remedy(const char *s, char remedy[REMEDY])
{
    char other[64];
    size_t length = strlen(s), n = decimal(s);
    if (has_thousands(s) && length < sizeof other) {
        without_commas(s, other);
        snprintf(remedy, REMEDY, "write %s, without a separator of thousands", other);
        return;
    }
    snprintf(other, sizeof other, "%.63s", s);
    for (char *c = other; *c; ++c)
        if (*c == ',')
            *c = '.';
        else if (*c == 'd' || *c == 'D')
            *c = 'e';
    bool fixed = length < sizeof other && is_decimal(other);
    const char *digits = s + (s[0] == '-' || s[0] == '+');
    if (fixed)
        snprintf(remedy, REMEDY, strchr(s, ',') ? "the decimal point is a point: write %s" : "write %s", other);
    else if (strpbrk(s, "iInN") && (strstr(s, "inf") || strstr(s, "Inf") || strstr(s, "INF") || strstr(s, "nan") ||
                                    strstr(s, "NaN") || strstr(s, "NAN")))
        snprintf(remedy, REMEDY, "numbers are finite: write a decimal number such as 1.5 or -2e-3");
    else if (digits[0] == '0' && digits[1] && strchr("xXoObB", digits[1]))
        snprintf(remedy, REMEDY, "write it in decimal, such as 1.5 or -2e-3");
    else if (n && s[n] == '_')
        snprintf(remedy, REMEDY, "write digits without `_`");
    else if (!strncmp(s, "\xe2\x88\x92", 3))
        snprintf(remedy, REMEDY, "write the minus sign as `-`");
    else if (n && (strchr(" %", s[n]) || s[n] & 0x80 || (s[n] >= 'A' && s[n] <= 'Z') || (s[n] >= 'a' && s[n] <= 'z')))
        snprintf(remedy, REMEDY, "write the number alone, in SI units (m, kg, s, N, rad)");
    else
        snprintf(remedy, REMEDY, "write a decimal number such as 1.5 or -2e-3");
}

double doc_number(const Item *item, const char *what)
{
    char remedy[REMEDY];
    if (item->kind != ITEM_SCALAR)
        diag_fail(item->at, "write one decimal number", "%s must be a number, not %s", what, found(item));
    const char *s = item->text;
    bool number = is_decimal(s);
    if (number && item->quoted)
        diag_fail(item->at, "remove the quotes", "%s must be a number, not a text", what);
    if (!number) {
        number_remedy(s, remedy);
        diag_fail(item->at, remedy, "%s must be a number, not %s%s%s", what, s[0] ? "'" : "", found(item),
                  s[0] ? "'" : "");
    }
    const char *digits = s + (s[0] == '-' || s[0] == '+');
    if (digits[0] == '0' && digits[1] >= '0' && digits[1] <= '9')
        diag_fail(item->at, "write it without leading zeros", "%s: is '%s' octal or decimal?", what, s);
    double value = strtod(s, NULL);
    if (!isfinite(value))
        diag_fail(item->at, "numbers must be below 1.8e308 in magnitude", "%s: %s is too large", what, s);
    value += item->shift;
    return item->negated ? 0 - value : value; /* zero stays positive */
}

bool doc_bool(const Item *item, const char *what)
{
    if (item->kind == ITEM_SCALAR && !item->quoted && !strcmp(item->text, "true"))
        return true;
    if (item->kind == ITEM_SCALAR && !item->quoted && !strcmp(item->text, "false"))
        return false;
    diag_fail(item->at, "write true or false, without quotes", "%s must be true or false, not '%s'", what, found(item));
}

const char *doc_word(const Item *item, const char *what)
{
    if (item->kind != ITEM_SCALAR || (!item->text[0] && !item->quoted))
        diag_fail(item->at, "write one word or text", "%s must be a text, not %s", what, found(item));
    return item->text;
}

void doc_vector(const Item *item, const char *what, double *out, int size)
{
    const char *remedy = size == 2   ? "write [x, y]"
                         : size == 3 ? "write [x, y, z]"
                                     : "write the numbers in brackets, separated by commas";
    if (item->kind != ITEM_LIST)
        diag_fail(item->at, remedy, "%s must be a list of %d numbers, not %s", what, size, found(item));
    if (item->count != size)
        diag_fail(item->at, remedy, "%s must have %d numbers, not %d", what, size, item->count);
    for (int i = 0; i < size; ++i)
        out[i] = doc_number(item->value[i], what);
}

void doc_check_keys(const Item *map, const char *what, const char *const *allowed, int count)
{
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write `key: value` pairs", "%s must be a map, not %s", what, found(map));
    for (int i = 0; i < map->count; ++i) {
        const char *key = map->key[i]->text;
        int k = 0;
        while (k < count && strcmp(allowed[k], key))
            ++k;
        if (k < count)
            continue;
        char remedy[REMEDY];
        const char *left[count + 1]; /* a key that is there already is not what was meant */
        int lefts = 0;
        memset(left, 0, sizeof left);
        for (k = 0; k < count; ++k)
            if (!doc_find(map, allowed[k]))
                left[lefts++] = allowed[k];
        const char *nearest = lefts ? diag_nearest(key, left, lefts) : NULL;
        int n = nearest ? snprintf(remedy, sizeof remedy, "did you mean '%s'? ", nearest) : 0;
        for (k = 0; k < count && n < REMEDY; ++k)
            n += snprintf(remedy + n, sizeof remedy - (size_t)n, "%s%s", k ? ", " : "the keys here are: ", allowed[k]);
        diag_fail(map->key[i]->at, remedy, "unknown key '%s' in %s", key, what);
    }
}
