/* SPDX-License-Identifier: MIT
 * A `.tir` file (TeimOrbit) into the numbers of a PAC2002 tire in SI units: TIRES.md sections 5 and 7. */
#include "base/file.h"
#include "base/yaml.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "read/reader.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

/* Keys that a tire uses: numbers, first those of PAC_LIST, then words, the units last. */
#define NUMBER_LIST(X) \
    X(UNLOADED_RADIUS) \
    X(WIDTH) \
    X(RIM_RADIUS) \
    X(VERTICAL_STIFFNESS) X(VERTICAL_DAMPING) X(BOTTOM_STIFF) X(BOTTOM_OFFST) X(LCZ) X(VXLOW) X(USE_MODE) X(FITTYP)
#define WORD_LIST(X) X(PROPERTY_FILE_FORMAT) X(TYRESIDE)
#define UNIT_LIST(X) X(LENGTH) X(FORCE) X(ANGLE) X(TIME) X(MASS) X(PRESSURE)

#define TIR_ENUM(name) TIR_##name,
enum { TIR_FIRST = PAC_COUNT - 1, NUMBER_LIST(TIR_ENUM) TIR_NUMBERS };
enum { TIR_WORD_FIRST = TIR_NUMBERS - 1, WORD_LIST(TIR_ENUM) TIR_UNITS };
enum { TIR_UNIT_FIRST = TIR_UNITS - 1, UNIT_LIST(TIR_ENUM) TIR_KEYS };

#define TIR_NAME(name) #name,
static const char *const key_name[TIR_KEYS] = {PAC_LIST(TIR_NAME) NUMBER_LIST(TIR_NAME) WORD_LIST(TIR_NAME)
                                                   UNIT_LIST(TIR_NAME)};

/* Other keys of PAC2002 and MF5.2 files, which this tire does not use. */
static const char *const other_name[] = {"FILE_TYPE",
                                         "FILE_VERSION",
                                         "FILE_FORMAT",
                                         "COMMENTS",
                                         "FUNCTION_NAME",
                                         "BELT_DYNAMICS",
                                         "CONTACT_MODEL",
                                         "MFSAFE1",
                                         "MFSAFE2",
                                         "MFSAFE3",
                                         "TYPE",
                                         "ASPECT_RATIO",
                                         "RIM_WIDTH",
                                         "IP",
                                         "IP_NOM",
                                         "INFLPRES",
                                         "NOMPRES",
                                         "FZMIN",
                                         "TIRE_MASS",
                                         "TYRE_MASS",
                                         "MASS",
                                         "IXX",
                                         "IYY",
                                         "IZZ",
                                         "LIP",
                                         "LGYR",
                                         "LMP",
                                         "LMUV",
                                         "LAMU",
                                         "LKYC",
                                         "LKZC",
                                         "LCY2",
                                         "QFZ1",
                                         "QFZ2",
                                         "QFZ3",
                                         "QFZ4",
                                         "QPFZ1",
                                         "QV1",
                                         "QV2",
                                         "QFCX1",
                                         "QFCY1",
                                         "QFCG1",
                                         "QREO",
                                         "PTX4",
                                         "PTY3",
                                         "PTY4",
                                         "QTZ1",
                                         "MBELT",
                                         "QSX4",
                                         "QSX5",
                                         "QSX6",
                                         "QSX7",
                                         "QSX8",
                                         "QSX9",
                                         "QSX10",
                                         "QSX11",
                                         "QSX12",
                                         "QSX13",
                                         "QSX14",
                                         "QSY5",
                                         "QSY6",
                                         "QSY7",
                                         "QSY8",
                                         "PPX1",
                                         "PPX2",
                                         "PPX3",
                                         "PPX4",
                                         "PPY1",
                                         "PPY2",
                                         "PPY3",
                                         "PPY4",
                                         "PPY5",
                                         "QPZ1",
                                         "QPZ2",
                                         "PPZ1",
                                         "PPZ2",
                                         "PPMX1",
                                         "PKY4",
                                         "PKY5",
                                         "PKY6",
                                         "PKY7",
                                         "PEY5",
                                         "QBZ6",
                                         "QBZ7",
                                         "QBZ8",
                                         "QDZ5",
                                         "QDZ10",
                                         "QDZ11",
                                         "LONGITUDINAL_STIFFNESS",
                                         "LATERAL_STIFFNESS",
                                         "YAW_STIFFNESS",
                                         "HMAX_INTEGRATOR",
                                         "N_TIRE_STATES",
                                         "PRESMIN",
                                         "PRESMAX"};

enum { UNKNOWN_MOST = 10 /* warnings about unknown keys; further ones would say nothing new */ };

/* Exponents of length, force, angle and time in a key's unit; keys that are not listed have no unit. */
static const struct {
    int key, exponent[4];
} dimension[] = {
    {TIR_UNLOADED_RADIUS, {1, 0, 0, 0}},
    {TIR_RIM_RADIUS, {1, 0, 0, 0}},
    {TIR_WIDTH, {1, 0, 0, 0}},
    {TIR_BOTTOM_OFFST, {1, 0, 0, 0}},
    {TIR_VERTICAL_STIFFNESS, {-1, 1, 0, 0}},
    {TIR_BOTTOM_STIFF, {-1, 1, 0, 0}},
    {TIR_VERTICAL_DAMPING, {-1, 1, 0, 1}},
    {TIR_VXLOW, {1, 0, 0, -1}},
    {PAC_LONGVL, {1, 0, 0, -1}},
    {PAC_FNOMIN, {0, 1, 0, 0}},
    {PAC_FZMAX, {0, 1, 0, 0}},
    {PAC_ALPMIN, {0, 0, 1, 0}},
    {PAC_ALPMAX, {0, 0, 1, 0}},
    {PAC_CAMMIN, {0, 0, 1, 0}},
    {PAC_CAMMAX, {0, 0, 1, 0}},
};

static const struct {
    const char *name;
    int unit;
    double size; /* in SI units */
} unit[] = {{"meter", TIR_LENGTH, 1},
            {"metre", TIR_LENGTH, 1},
            {"m", TIR_LENGTH, 1},
            {"millimeter", TIR_LENGTH, 1e-3},
            {"millimetre", TIR_LENGTH, 1e-3},
            {"mm", TIR_LENGTH, 1e-3},
            {"centimeter", TIR_LENGTH, 1e-2},
            {"centimetre", TIR_LENGTH, 1e-2},
            {"cm", TIR_LENGTH, 1e-2},
            {"kilometer", TIR_LENGTH, 1e3},
            {"km", TIR_LENGTH, 1e3},
            {"inch", TIR_LENGTH, 0.0254},
            {"in", TIR_LENGTH, 0.0254},
            {"foot", TIR_LENGTH, 0.3048},
            {"ft", TIR_LENGTH, 0.3048},
            {"newton", TIR_FORCE, 1},
            {"n", TIR_FORCE, 1},
            {"kilonewton", TIR_FORCE, 1e3},
            {"knewton", TIR_FORCE, 1e3},
            {"kn", TIR_FORCE, 1e3},
            {"kilogram_force", TIR_FORCE, 9.80665},
            {"kgf", TIR_FORCE, 9.80665},
            {"pound_force", TIR_FORCE, 4.4482216152605},
            {"lbf", TIR_FORCE, 4.4482216152605},
            {"radian", TIR_ANGLE, 1},
            {"radians", TIR_ANGLE, 1},
            {"rad", TIR_ANGLE, 1},
            {"degree", TIR_ANGLE, 3.14159265358979323846 / 180},
            {"degrees", TIR_ANGLE, 3.14159265358979323846 / 180},
            {"deg", TIR_ANGLE, 3.14159265358979323846 / 180},
            {"second", TIR_TIME, 1},
            {"sec", TIR_TIME, 1},
            {"s", TIR_TIME, 1},
            {"millisecond", TIR_TIME, 1e-3},
            {"ms", TIR_TIME, 1e-3},
            {"minute", TIR_TIME, 60},
            {"min", TIR_TIME, 60},
            {"hour", TIR_TIME, 3600},
            {"kg", TIR_MASS, 1},
            {"kilogram", TIR_MASS, 1},
            {"gram", TIR_MASS, 1e-3},
            {"g", TIR_MASS, 1e-3},
            {"tonne", TIR_MASS, 1e3},
            {"pound_mass", TIR_MASS, 0.45359237},
            {"lbm", TIR_MASS, 0.45359237},
            {"slug", TIR_MASS, 14.59390293720636},
            {"pascal", TIR_PRESSURE, 1},
            {"pa", TIR_PRESSURE, 1},
            {"kilopascal", TIR_PRESSURE, 1e3},
            {"kpascal", TIR_PRESSURE, 1e3},
            {"kpa", TIR_PRESSURE, 1e3},
            {"megapascal", TIR_PRESSURE, 1e6},
            {"mpa", TIR_PRESSURE, 1e6},
            {"bar", TIR_PRESSURE, 1e5},
            {"psi", TIR_PRESSURE, 6894.757293168362}};

/* Bit m: required in USE_MODE m. */
enum { MODES_ALL = 0x1f, MODES_X = 0x1a, MODES_Y = 0x1c };

/* Required keys, and the condition on their numbers. */
static const struct {
    int key;
    unsigned modes;
    bool positive; /* must be positive; else must not be 0 */
    const char *section;
} needed[] = {
    {TIR_UNLOADED_RADIUS, MODES_ALL, true, "DIMENSION"},
    {TIR_VERTICAL_STIFFNESS, MODES_ALL, true, "VERTICAL"},
    {PAC_FNOMIN, MODES_ALL, true, "VERTICAL"},
    {PAC_PCX1, MODES_X, false, "LONGITUDINAL_COEFFICIENTS"},
    {PAC_PDX1, MODES_X, false, "LONGITUDINAL_COEFFICIENTS"},
    {PAC_PKX1, MODES_X, false, "LONGITUDINAL_COEFFICIENTS"},
    {PAC_PCY1, MODES_Y, false, "LATERAL_COEFFICIENTS"},
    {PAC_PDY1, MODES_Y, false, "LATERAL_COEFFICIENTS"},
    {PAC_PKY1, MODES_Y, false, "LATERAL_COEFFICIENTS"},
    {PAC_PKY2, MODES_Y, false, "LATERAL_COEFFICIENTS"},
};

/* Scaling factors that the formulas divide by. */
static const int divisor[] = {PAC_LFZO, PAC_LCX, PAC_LMUX, PAC_LCY, PAC_LMUY, PAC_LKY, TIR_LCZ};

typedef struct Found {
    Item item;     /* place and text of the value; text NULL: the key is absent */
    double number; /* in SI units */
} Found;

typedef struct Tir {
    Pool *pool;
    const char *what; /* "tire 'front'" */
    const Source *source;
    const char *section; /* the current section; NULL: none yet */
    const char **sections;
    size_t *section_at;
    int section_count;
    bool table; /* inside a table or a block of comments */
    int unknown;
    Found found[TIR_KEYS];
} Tir;

static Place place(const Tir *tir, const char *s)
{
    return diag_place(tir->source, (size_t)(s - tir->source->bytes));
}

/* The text from s to end in capitals. */
static char *capitals(Pool *pool, const char *s, const char *end)
{
    char *text = pool_print(pool, "%.*s", (int)(end - s), s);
    for (char *c = text; *c; ++c)
        *c = (char)toupper((unsigned char)*c);
    return text;
}

static const char *skip(const char *s, const char *end)
{
    while (s < end && (*s == ' ' || *s == '\t' || *s == '\f'))
        ++s;
    return s;
}

/* True if only blanks or a comment follow. */
static bool is_rest(const char *s, const char *end)
{
    s = skip(s, end);
    return s == end || *s == '$' || *s == '!';
}

static void section_begin(Tir *tir, const char *s, const char *end)
{
    const char *name = skip(s + 1, end), *close = memchr(s, ']', (size_t)(end - s));
    if (!close)
        diag_fail(place(tir, s), "write [NAME] in one line", "the name of a section is not closed by ]");
    if (!is_rest(close + 1, end))
        diag_fail(place(tir, skip(close + 1, end)), "begin comments with $", "'%.*s' is unexpected after a section",
                  (int)(end - skip(close + 1, end)), skip(close + 1, end));
    const char *last = close;
    while (last > name && strchr(" \t\f", last[-1]))
        --last;
    int count = tir->section_count;
    tir->section = capitals(tir->pool, name, last > name ? last : name);
    tir->table = false;
    *POOL_PUSH(tir->pool, tir->sections, count) = tir->section;
    *POOL_PUSH(tir->pool, tir->section_at, tir->section_count) = (size_t)(s - tir->source->bytes);
}

/* The index of a key. Units count only in the section of units: other sections have a key MASS too. */
static int key_find(const Tir *tir, const char *name)
{
    bool units = !strcmp(tir->section, "UNITS");
    int first = units ? TIR_UNITS : 0, last = units ? TIR_KEYS : TIR_UNITS;
    for (int i = first; i < last; ++i)
        if (!strcmp(key_name[i], name))
            return i;
    return -1;
}

static void unknown_key(Tir *tir, const char *name, const char *s)
{
    for (size_t i = 0; i < sizeof other_name / sizeof *other_name; ++i)
        if (!strcmp(other_name[i], name))
            return;
    if (++tir->unknown > UNKNOWN_MOST)
        return;
    const char *nearest = diag_nearest(name, key_name, TIR_UNITS);
    diag_warn(place(tir, s),
              nearest ? pool_print(tir->pool, "did you mean '%s'?", nearest) : "check the spelling, or leave it away",
              "%s: the key '%.40s' is not known and counts for nothing", tir->what, name);
}

/* The number, word or text after `=`. */
static Item value_read(Tir *tir, const char *name, const char *s, const char *end)
{
    const char *first = skip(s, end), *last = first;
    bool quoted = first < end && (*first == '\'' || *first == '"');
    if (is_rest(first, end))
        diag_fail(place(tir, first), pool_print(tir->pool, "write %s = value", name), "%s of %s has no value", name,
                  tir->what);
    if (quoted) {
        last = memchr(first + 1, *first, (size_t)(end - first - 1));
        if (!last)
            diag_fail(place(tir, first), "close it in the same line", "%s of %s: the quotes are not closed", name,
                      tir->what);
    } else
        while (last < end && !strchr(" \t\f$!", *last))
            ++last;
    const char *begin = first + quoted, *behind = last + quoted;
    if (!is_rest(behind, end))
        diag_fail(place(tir, skip(behind, end)), "begin comments with $", "%s of %s: '%.*s' is unexpected", name,
                  tir->what, (int)(end - skip(behind, end)), skip(behind, end));
    return (Item){.kind = ITEM_SCALAR,
                  .at = place(tir, first),
                  .quoted = quoted,
                  .text = pool_print(tir->pool, "%.*s", (int)(last - begin), begin)};
}

static void key_read(Tir *tir, const char *s, const char *end)
{
    const char *behind = s;
    while (behind < end && (isalnum((unsigned char)*behind) || *behind == '_'))
        ++behind;
    const char *equals = skip(behind, end);
    if (behind == s || equals == end || *equals != '=')
        diag_fail(place(tir, s), "write KEY = value, and begin comments with $ or !",
                  "%s: this line is neither a [SECTION] nor KEY = value", tir->what);
    const char *name = capitals(tir->pool, s, behind);
    if (!tir->section)
        diag_fail(place(tir, s), "begin with [MDI_HEADER] or [UNITS]", "%s: '%.40s' comes before the first [SECTION]",
                  tir->what, name);
    int key = key_find(tir, name);
    if (key < 0) {
        unknown_key(tir, name, s);
        return;
    }
    Item *item = &tir->found[key].item;
    if (item->text)
        diag_fail(place(tir, s), "take one of the two away", "%s: '%s' is in line %d already", tir->what, name,
                  item->at.line);
    *item = value_read(tir, name, equals + 1, end);
}

static void line_read(Tir *tir, const char *s, const char *end)
{
    s = skip(s, end);
    if (is_rest(s, end))
        return;
    if (*s == '[')
        section_begin(tir, s, end);
    else if (*s == '{' || *s == '(')
        tir->table = true;
    else if (!tir->table || isalpha((unsigned char)*s)) {
        tir->table = false;
        key_read(tir, s, end);
    }
}

static void lines_read(Tir *tir)
{
    const char *s = tir->source->bytes, *end = s + tir->source->size;
    for (const char *c = s; c < end; ++c)
        if ((unsigned char)*c < 0x20 && !memchr("\t\n\r\f", *c, 4))
            diag_fail(place(tir, c), "name a .tir file, which is text", "%s: this is no text: byte %d", tir->what,
                      (unsigned char)*c);
    if (end - s >= 3 && !memcmp(s, "\xef\xbb\xbf", 3)) /* byte order mark */
        s += 3;
    while (s < end) {
        const char *line = s;
        while (s < end && *s != '\n' && *s != '\r')
            ++s;
        line_read(tir, line, s++);
    }
    if (tir->unknown > UNKNOWN_MOST)
        diag_warn((Place){tir->source, 0, 0}, "name a PAC2002 or MF5.2 file", "%s: %d more keys are not known",
                  tir->what, tir->unknown - UNKNOWN_MOST);
}

static bool given(const Tir *tir, int key)
{
    return tir->found[key].item.text;
}

/* A required key is missing, which `section` should have. */
static _Noreturn void missing(const Tir *tir, int key, const char *section, const char *example)
{
    const char *remedy = pool_print(tir->pool, "add `%s = %s` to [%s]", key_name[key], example, section);
    for (int i = tir->section_count - 1; i >= 0; --i)
        if (!strcmp(tir->sections[i], section))
            diag_fail(diag_place(tir->source, tir->section_at[i]), remedy, "%s: [%s] lacks %s", tir->what, section,
                      key_name[key]);
    diag_fail(diag_place(tir->source, 0), remedy, "%s: the section [%s] with %s is missing", tir->what, section,
              key_name[key]);
}

static bool same_word(const char *a, const char *b)
{
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b))
        ++a, ++b;
    return !*a && !*b;
}

/* The SI size of a unit; every unit that a conversion needs must be given. */
static double unit_size(const Tir *tir, int key)
{
    const Item *item = &tir->found[key].item;
    Text list = {.pool = tir->pool};
    if (!item->text && key < TIR_MASS) {
        static const char *const example[] = {"'meter'", "'newton'", "'radian'", "'second'"};
        missing(tir, key, "UNITS", example[key - TIR_UNITS]);
    }
    for (size_t i = 0; i < sizeof unit / sizeof *unit; ++i)
        if (unit[i].unit == key) {
            if (!item->text || same_word(unit[i].name, item->text))
                return unit[i].size;
            text_print(&list, "%s%s", list.size ? ", " : "", unit[i].name);
        }
    diag_fail(item->at, pool_print(tir->pool, "one of: %s", list.s), "%s: '%.40s' is no unit of %s that is known",
              tir->what, item->text, key_name[key]);
}

/* Numbers in the units of the file. */
static void numbers_read(Tir *tir)
{
    for (int i = 0; i < TIR_NUMBERS; ++i)
        if (given(tir, i))
            tir->found[i].number =
                doc_number(&tir->found[i].item, pool_print(tir->pool, "%s of %s", key_name[i], tir->what));
}

static void numbers_convert(Tir *tir)
{
    double size[TIR_KEYS - TIR_UNITS];
    for (int i = 0; i < TIR_KEYS - TIR_UNITS; ++i)
        size[i] = unit_size(tir, TIR_UNITS + i);
    for (size_t i = 0; i < sizeof dimension / sizeof *dimension; ++i)
        for (int k = 0; k < 4; ++k) {
            double *number = &tir->found[dimension[i].key].number;
            *number *= dimension[i].exponent[k] > 0 ? size[k] : 1;
            *number /= dimension[i].exponent[k] < 0 ? size[k] : 1;
            if (!isfinite(*number))
                diag_fail(tir->found[dimension[i].key].item.at, "check the number, and its unit in [UNITS]",
                          "%s of %s is too large in SI units", key_name[dimension[i].key], tir->what);
        }
}

/* Refuse a format whose coefficients do not have the meaning of TIRES.md. */
static void format_check(const Tir *tir)
{
    static const char *const good[] = {"PAC2002", "MF_05", "MF-TYRE", "MF52"};
    const char *remedy = "PAC2002, MF_05, MF-TYRE and MF52 are read, and FITTYP 5, 6, 51 and 52";
    const Item *format = &tir->found[TIR_PROPERTY_FILE_FORMAT].item, *type = &tir->found[TIR_FITTYP].item;
    double number = tir->found[TIR_FITTYP].number;
    if (type->text && number != 5 && number != 6 && number != 51 && number != 52)
        diag_fail(type->at, remedy, "%s: FITTYP %s is another tire model", tir->what, type->text);
    if (type->text)
        return;
    if (!format->text)
        missing(tir, TIR_PROPERTY_FILE_FORMAT, "MODEL", "'PAC2002'");
    for (size_t i = 0; i < sizeof good / sizeof *good; ++i)
        if (same_word(good[i], format->text))
            return;
    diag_fail(format->at, remedy, "%s: PROPERTY_FILE_FORMAT '%.40s' is another tire model", tir->what, format->text);
}

static int mode_read(const Tir *tir)
{
    const Item *item = &tir->found[TIR_USE_MODE].item;
    double mode = tir->found[TIR_USE_MODE].number;
    if (!item->text)
        return 4;
    if (mode < 0)
        diag_fail(item->at, "write it without the sign, and `side: left` or `side: right` at the wheel",
                  "%s: USE_MODE %s asks for a mirrored tire", tir->what, item->text);
    if (mode >= 10)
        mode -= 10;
    for (int i = 0; i <= 4; ++i)
        if (mode == i)
            return i;
    diag_fail(item->at, "write 4 for all forces and moments with combined slip",
              "%s: USE_MODE %s is not one of 0 to 4 and 10 to 14", tir->what, item->text);
}

static TireSide side_read(const Tir *tir)
{
    static const char *const word[] = {[SIDE_LEFT] = "LEFT", [SIDE_RIGHT] = "RIGHT", [SIDE_SYMMETRIC] = "SYMMETRIC"};
    const Item *item = &tir->found[TIR_TYRESIDE].item;
    if (!item->text)
        return SIDE_LEFT;
    for (int i = SIDE_LEFT; i <= SIDE_SYMMETRIC; ++i)
        if (same_word(word[i], item->text))
            return (TireSide)i;
    diag_fail(item->at, "write 'LEFT', 'RIGHT' or 'SYMMETRIC'", "%s: there is no TYRESIDE '%.40s'", tir->what,
              item->text);
}

static void positive_check(const Tir *tir, int key)
{
    if (given(tir, key) && !(tir->found[key].number > 0))
        diag_fail(tir->found[key].item.at, "write a positive number", "%s of %s must be greater than zero, not %s",
                  key_name[key], tir->what, tir->found[key].item.text);
}

/* Check divisors and limits of ranges. */
static void numbers_check(const Tir *tir, int mode)
{
    static const int range[][2] = {{PAC_KPUMIN, PAC_KPUMAX}, {PAC_ALPMIN, PAC_ALPMAX}, {PAC_CAMMIN, PAC_CAMMAX}};
    for (size_t i = 0; i < sizeof needed / sizeof *needed; ++i) {
        int key = needed[i].key;
        if (!(needed[i].modes >> mode & 1))
            continue;
        if (!given(tir, key))
            missing(tir, key, needed[i].section, "number");
        if (needed[i].positive)
            positive_check(tir, key);
        else if (tir->found[key].number == 0)
            diag_fail(tir->found[key].item.at, "give the coefficient, or a USE_MODE that does without it",
                      "%s of %s must not be zero", key_name[key], tir->what);
    }
    for (size_t i = 0; i < sizeof divisor / sizeof *divisor; ++i)
        positive_check(tir, divisor[i]);
    positive_check(tir, PAC_FZMAX);
    if (tir->found[TIR_VERTICAL_DAMPING].number < 0)
        diag_fail(tir->found[TIR_VERTICAL_DAMPING].item.at, "write zero or a positive number",
                  "VERTICAL_DAMPING of %s must not be negative", tir->what);
    for (int i = 0; i < 3; ++i) {
        const Found *low = &tir->found[range[i][0]], *high = &tir->found[range[i][1]];
        if (given(tir, range[i][0]) && !(low->number <= 0))
            diag_fail(low->item.at, "write zero or a negative number", "%s of %s must not be above zero",
                      key_name[range[i][0]], tir->what);
        if (given(tir, range[i][1]) && !(high->number >= 0))
            diag_fail(high->item.at, "write zero or a positive number", "%s of %s must not be below zero",
                      key_name[range[i][1]], tir->what);
    }
    if (tir->found[PAC_QSY3].number != 0 || tir->found[PAC_QSY4].number != 0) {
        if (!given(tir, PAC_LONGVL))
            missing(tir, PAC_LONGVL, "MODEL", "16.7");
        positive_check(tir, PAC_LONGVL);
    }
    if (tir->found[PAC_PTY1].number != 0 && tir->found[PAC_PTY2].number == 0)
        diag_fail(tir->found[PAC_PTY1].item.at, "give PTY2 too, or leave both away",
                  "PTY1 of %s is a relaxation length only with PTY2", tir->what);
}

/* The deflection at which the rim touches the road. */
static void bottom_read(const Tir *tir, Tire *tire)
{
    const Found *stiffness = &tir->found[TIR_BOTTOM_STIFF];
    if (stiffness->number == 0)
        return;
    positive_check(tir, TIR_BOTTOM_STIFF);
    if (!given(tir, TIR_RIM_RADIUS))
        missing(tir, TIR_RIM_RADIUS, "DIMENSION", "number");
    tire->bottom_stiffness = stiffness->number;
    tire->bottom = tire->radius - tir->found[TIR_RIM_RADIUS].number - tir->found[TIR_BOTTOM_OFFST].number;
    if (!(tire->bottom > 0))
        diag_fail(stiffness->item.at, "check UNLOADED_RADIUS, RIM_RADIUS and BOTTOM_OFFST",
                  "%s: the rim touches the road before the tire does", tir->what);
}

static double fallback(int key)
{
    if (key >= PAC_LFZO && key <= PAC_LMY)
        return 1;
    if (key == PAC_KPUMIN || key == PAC_ALPMIN || key == PAC_CAMMIN)
        return -PAC_UNLIMITED;
    return key == PAC_KPUMAX || key == PAC_ALPMAX || key == PAC_CAMMAX || key == PAC_FZMAX ? PAC_UNLIMITED : 0;
}

static void tire_fill(const Tir *tir, Tire *tire)
{
    double *number = pool_alloc(tir->pool, sizeof *number * PAC_COUNT);
    for (int i = 0; i < PAC_COUNT; ++i)
        number[i] = given(tir, i) ? tir->found[i].number : fallback(i);
    positive_check(tir, TIR_VXLOW);
    positive_check(tir, TIR_WIDTH);
    tire->number = number;
    tire->radius = tir->found[TIR_UNLOADED_RADIUS].number;
    tire->width = tir->found[TIR_WIDTH].number;
    tire->stiffness =
        tir->found[TIR_VERTICAL_STIFFNESS].number * (given(tir, TIR_LCZ) ? tir->found[TIR_LCZ].number : 1);
    if (!(tire->stiffness > 0) || !isfinite(tire->stiffness))
        diag_fail(tir->found[TIR_VERTICAL_STIFFNESS].item.at, "check it, and LCZ of [SCALING_COEFFICIENTS]",
                  "VERTICAL_STIFFNESS of %s is %g N/m with LCZ", tir->what, tire->stiffness);
    tire->damping = tir->found[TIR_VERTICAL_DAMPING].number;
    tire->low_speed = given(tir, TIR_VXLOW) ? tir->found[TIR_VXLOW].number : 1;
    tire->relaxation[0] = number[PAC_PTX1] == 0 ? 0.5 * tire->radius : 0;
    tire->relaxation[1] = number[PAC_PTY1] == 0 ? tire->radius : 0;
    bottom_read(tir, tire);
}

/* True if a text in capitals has one of these sections. */
static bool has_section(const char *text, const char *const *name, int names)
{
    for (const char *s = text; (s = strchr(s, '[')); ++s) {
        const char *word = s + 1 + strspn(s + 1, " \t\f");
        for (int i = 0; i < names; ++i)
            if (!strncmp(word, name[i], strlen(name[i])))
                return true;
    }
    return false;
}

/* Open the file. A file without any section of a tire is refused without showing its contents. */
static const Source *tire_file(Pool *pool, const char *path, const char *what, const Source *by)
{
    static const char *const section[] = {"MDI_HEADER", "UNITS", "MODEL"};
    Source *source = source_read(pool, path, TEXT_MOST, by);
    const bool empty = !source->bytes[strspn(source->bytes, " \t\r\n\f")];
    source->hidden = !empty && !has_section(capitals(pool, source->bytes, source->bytes + source->size), section, 3);
    if (source->hidden)
        diag_fail((Place){source, 1, 1}, "name a .tir file, which has sections such as [UNITS] and [MODEL]",
                  "%s: this is no tire property file", what);
    return source;
}

void tir_read(const Reader *reader, const Item *item, const char *what, Tire *tire)
{
    Tir *tir = pool_alloc(reader->pool, sizeof *tir);
    struct stat identity;
    *tir = (Tir){.pool = reader->pool, .what = what};
    const char *path = path_check(reader->pool, item, item->at.source->path, doc_word(item, what), "read", &identity);
    tir->source = tire_file(reader->pool, path, what, item->at.source);
    lines_read(tir);
    numbers_read(tir);
    format_check(tir);
    numbers_convert(tir);
    tire->mode = mode_read(tir);
    tire->side = side_read(tir);
    numbers_check(tir, tire->mode);
    tire_fill(tir, tire);
}
