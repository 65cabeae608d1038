/* SPDX-License-Identifier: MIT
 * Formulas: a text like `-k * deflection - 40e3 * max(0, strut - 0.3)` into a tree, by recursive descent. Precedence,
 * weakest first: or, and, not, comparison, + -, * /, sign, ^ (from the right). A condition is a number too: true where
 * it is positive. */
#include "base/table.h"
#include "base/text.h"
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DEPTH_MOST = 100,  /* nesting levels; the parser recurses as deep */
    SIZE_MOST = 10000, /* nodes of a formula with its parameters' formulas counted at each use; walks over the tree
                        * recurse as deep */
    NAME_ROOM = 64
};

typedef struct Parser {
    Pool *pool;
    const Item *item;
    const char *what;
    const LawNames *names;
    const char *s; /* next character */
    int depth;
} Parser;

/* Functions by name: the operation and the number of arguments. */
static const struct {
    const char *name;
    Op op;
    int arguments;
} function[] = {{"sqrt", OP_SQRT, 1}, {"abs", OP_ABS, 1},   {"sin", OP_SIN, 1},   {"cos", OP_COS, 1},
                {"tan", OP_TAN, 1},   {"asin", OP_ASIN, 1}, {"acos", OP_ACOS, 1}, {"atan", OP_ATAN, 1},
                {"exp", OP_EXP, 1},   {"log", OP_LOG, 1},   {"tanh", OP_TANH, 1}, {"atan2", OP_ATAN2, 2},
                {"pow", OP_POW, 2},   {"min", OP_MIN, 2},   {"max", OP_MAX, 2}};

enum { FUNCTIONS = sizeof function / sizeof *function };

static _Noreturn void fail(Parser *p, const char *where, const char *remedy, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The place of a character of the formula. In a text with escapes or folded lines places are not exact: then it is the
 * formula's beginning. */
static Place place_of(const Parser *p, const char *where)
{
    Place at = p->item->at;
    const Source *source = at.source;
    size_t length = strlen(p->item->text);
    const char *start = diag_line(at) + at.column - 1 + p->item->quoted, *end = source->bytes + source->size;
    if (start <= end && length <= (size_t)(end - start) && !memcmp(start, p->item->text, length))
        at.column += p->item->quoted + (int)(where - p->item->text);
    return at;
}

static _Noreturn void fail(Parser *p, const char *where, const char *remedy, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const char *message = pool_vprint(p->pool, format, args);
    va_end(args);
    diag_fail(place_of(p, where), remedy, "%s: %s", p->what, message);
}

static void skip(Parser *p)
{
    while (isspace((unsigned char)*p->s))
        ++p->s;
}

static bool take(Parser *p, const char *token)
{
    skip(p);
    size_t length = strlen(token);
    if (strncmp(p->s, token, length))
        return false;
    if (isalpha((unsigned char)token[0]) && (isalnum((unsigned char)p->s[length]) || p->s[length] == '_'))
        return false;
    p->s += length;
    return true;
}

static void expect(Parser *p, const char *token)
{
    if (!take(p, token))
        fail(p, p->s, pool_print(p->pool, "write `%s` here", token), "`%s` is missing%s%s", token,
             *p->s ? " before " : " at the end", *p->s ? pool_print(p->pool, "'%.12s'", p->s) : "");
}

static const Law *node(Parser *p, Law node)
{
    Law *law = pool_alloc(p->pool, sizeof *law);
    ++node.size;
    for (int i = 0; i < 3 && node.arg[i]; ++i)
        node.size += node.arg[i]->size;
    if (node.size > SIZE_MOST)
        fail(p, p->s, "split it into several force elements, or leave out `tunable: true`",
             "the formula has more than %d operations and numbers, with those of its parameters", SIZE_MOST);
    *law = node;
    return law;
}

static const Law *number(Parser *p, double value)
{
    return node(p, (Law){.op = LAW_NUMBER, .number = value});
}

static const Law *call(Parser *p, Op op, const char *name, const Law *a, const Law *b, const Law *c)
{
    return node(p, (Law){.op = LAW_CALL, .call = (int)op, .arg = {a, b, c}, .name = name});
}

static const Law *parse_or(Parser *p);

static const Law *negative(Parser *p, const Law *a)
{
    if (a->op == LAW_NUMBER)
        return number(p, -a->number);
    return call(p, OP_NEG, "-", a, NULL, NULL);
}

static const Law *difference(Parser *p, const Law *a, const Law *b)
{
    return call(p, OP_SUB, "-", a, b, NULL);
}

/* yes: 1 if t is positive, else -1; no: the opposite. */
static const Law *truth(Parser *p, const Law *t, bool yes)
{
    return call(p, OP_POSITIVE, "if", t, number(p, yes ? 1 : -1), number(p, yes ? -1 : 1));
}

static const Law *reference(Parser *p, LawOp op, int index, const char *name)
{
    const Model *model = p->names->model;
    const Law *stands = op == LAW_PARAMETER ? model->parameter[index].law : NULL;
    if (op == LAW_PARAMETER)
        model->parameter[index].read = true;
    if (op == LAW_INPUT)
        model->input[index].read = true;
    if (op == LAW_STATE)
        model->state[index].read = true;
    return node(p, (Law){.op = op, .index = index, .name = name, .size = stands ? stands->size : 0});
}

static int coordinate_named(const Model *model, const char *name)
{
    for (int i = 0; i < model->coordinates; ++i)
        if (!strcmp(model->coordinate[i].name, name))
            return i;
    return -1;
}

static void only_constants(Parser *p, const char *where, const char *name)
{
    if (p->names->constant)
        fail(p, where, p->names->remedy, "'%s' changes with time, but only numbers and parameters can stand here",
             name);
}

_Noreturn void law_name_unknown(Pool *pool, const LawNames *names, const char *what, const char *name, Place at,
                                const char *const *more, int count)
{
    const Model *model = names->model;
    const char **known = NULL;
    int knowns = 0;
    for (int i = 0; i < names->locals; ++i)
        *POOL_PUSH(pool, known, knowns) = names->local[i];
    for (int i = 0; i < model->coordinates && !names->constant; ++i)
        *POOL_PUSH(pool, known, knowns) = model->coordinate[i].name;
    for (int i = 0; i < model->parameters; ++i)
        *POOL_PUSH(pool, known, knowns) = model->parameter[i].name;
    for (int i = 0; i < model->inputs && !names->constant; ++i)
        *POOL_PUSH(pool, known, knowns) = model->input[i].name;
    for (int i = 0; i < model->states && !names->constant; ++i)
        *POOL_PUSH(pool, known, knowns) = model->state[i].name;
    if (!names->constant)
        *POOL_PUSH(pool, known, knowns) = "time";
    *POOL_PUSH(pool, known, knowns) = "pi";
    for (int i = 0; i < count; ++i)
        *POOL_PUSH(pool, known, knowns) = more[i];
    const char *nearest = diag_nearest(name, known, knowns);
    Text list = {.pool = pool};
    for (int i = 0; i < knowns && list.size < 200; ++i)
        text_print(&list, "%s%s", i ? ", " : "", known[i]);
    const char *above = names->constant ? " (parameters stand above what uses them)" : "";
    diag_fail(at,
              nearest ? pool_print(pool, "did you mean '%s'?%s", nearest, above)
                      : pool_print(pool, "names known here: %s%s", list.s, above),
              "%s: there is no '%s'", what, name);
}

/* A name that only a signal can have. */
static const Law *signal_named(Parser *p, const char *where, const char *name)
{
    const LawNames *names = p->names;
    if (!names->reads)
        law_name_unknown(p->pool, names, p->what, name, place_of(p, where), NULL, 0);
    Law *law = pool_alloc(p->pool, sizeof *law);
    *law = (Law){.op = LAW_SIGNAL, .index = -1, .number = 1, .name = pool_print(p->pool, "%s", name), .size = 1};
    *POOL_PUSH(p->pool, names->reads->read, names->reads->count) = (SignalRead){.law = law,
                                                                                .name = law->name,
                                                                                .at = place_of(p, where),
                                                                                .what = p->what,
                                                                                .mirrored = p->item->mirrored,
                                                                                .names = *names};
    return law;
}

/* rate(name). There is no acceleration(name): accelerations depend on the forces. */
static const Law *parse_rate(Parser *p)
{
    skip(p);
    const char *where = p->s;
    char name[NAME_ROOM];
    size_t length = 0;
    while (length < sizeof name - 1 && (isalnum((unsigned char)*p->s) || *p->s == '_'))
        name[length++] = *p->s++;
    name[length] = 0;
    int index = coordinate_named(p->names->model, name);
    if (index < 0)
        fail(p, where, "write rate(name) with the name of a dual coordinate", "'%s' is not a coordinate", name);
    expect(p, ")");
    return reference(p, LAW_RATE, index, p->names->model->coordinate[index].name);
}

static const Law *parse_call(Parser *p, const char *where, const char *name)
{
    const Model *model = p->names->model;
    bool ours = !strcmp(name, "rate") || !strcmp(name, "if");
    for (int i = 0; i < FUNCTIONS; ++i)
        ours = ours || !strcmp(name, function[i].name);
    for (int i = 0; ours && i < model->tables; ++i)
        if (!strcmp(model->table[i].name, name))
            fail(p, where, "give the table another name", "'%s' is a function here, and the name of a table", name);
    if (!strcmp(name, "rate")) {
        only_constants(p, where, name);
        return parse_rate(p);
    }
    const Law *arg[3] = {NULL};
    int count = 0;
    do {
        if (count == 3)
            fail(p, p->s, "functions take one, two or three", "too many arguments for '%s'", name);
        arg[count++] = parse_or(p);
    } while (take(p, ","));
    expect(p, ")");
    if (!strcmp(name, "if")) {
        if (count != 3)
            fail(p, where, "write if(condition, value, other)", "'if' takes 3 arguments, not %d", count);
        return call(p, OP_POSITIVE, "if", arg[0], arg[1], arg[2]);
    }
    for (int i = 0; i < FUNCTIONS; ++i)
        if (!strcmp(function[i].name, name)) {
            /* min and max of three are two of two */
            bool three = count == 3 && (function[i].op == OP_MIN || function[i].op == OP_MAX);
            if (count != function[i].arguments && !three)
                fail(p, where,
                     pool_print(p->pool, "write %s(%s)", name, function[i].arguments > 1 ? "number, number" : "number"),
                     "'%s' takes %d argument%s, not %d", name, function[i].arguments,
                     function[i].arguments > 1 ? "s" : "", count);
            const Law *two = call(p, function[i].op, function[i].name, arg[0], arg[1], NULL);
            return three ? call(p, function[i].op, function[i].name, two, arg[2], NULL) : two;
        }
    for (int i = 0; i < model->tables; ++i)
        if (!strcmp(model->table[i].name, name)) {
            if (count != 1)
                fail(p, where, "a table is a function of one number", "table '%s' takes 1 argument, not %d", name,
                     count);
            model->table[i].read = true;
            return node(p, (Law){.op = LAW_TABLE, .index = i, .arg = {arg[0]}, .name = model->table[i].name});
        }
    const char **known = NULL;
    int names = 0;
    for (int i = 0; i < FUNCTIONS; ++i)
        *POOL_PUSH(p->pool, known, names) = function[i].name;
    for (int i = 0; i < model->tables; ++i)
        *POOL_PUSH(p->pool, known, names) = model->table[i].name;
    *POOL_PUSH(p->pool, known, names) = "if";
    *POOL_PUSH(p->pool, known, names) = "rate";
    const char *nearest = diag_nearest(name, known, names);
    fail(p, where,
         nearest ? pool_print(p->pool, "did you mean '%s'?", nearest)
                 : "functions: sqrt abs sin cos tan asin acos atan atan2 exp log pow tanh min max if rate, and the "
                   "model's tables",
         "there is no function or table '%s'", name);
}

/* Refuse a word of the formula language that is also the name of something in the model that could be meant. */
static void has_one_meaning(Parser *p, const char *where, const char *name, const char *meaning)
{
    const Model *model = p->names->model;
    const char *other = coordinate_named(model, name) >= 0 ? "coordinate" : NULL;
    for (int i = 0; i < model->inputs; ++i)
        other = strcmp(name, model->input[i].name) ? other : "input";
    for (int i = 0; i < model->parameters; ++i)
        other = strcmp(name, model->parameter[i].name) ? other : "parameter";
    for (int i = 0; i < model->states; ++i)
        other = strcmp(name, model->state[i].name) ? other : "state";
    if (other)
        fail(p, where, pool_print(p->pool, "give the %s another name", other),
             "'%s' is %s here, and the name of a%s %s", name, meaning, *other == 'i' ? "n" : "", other);
}

static const Law *parse_name(Parser *p)
{
    const char *where = p->s;
    char name[NAME_ROOM];
    size_t length = 0;
    while (isalnum((unsigned char)*p->s) || *p->s == '_' || *p->s == '.') {
        if (length == sizeof name - 1)
            fail(p, where, "names have at most 40 characters", "the name '%.20s...' is too long", where);
        name[length++] = *p->s++;
    }
    name[length] = 0;
    if (take(p, "("))
        return parse_call(p, where, name);
    const Model *model = p->names->model;
    for (int i = 0; i < p->names->locals; ++i)
        if (!strcmp(name, p->names->local[i])) {
            if (!p->names->hide)
                has_one_meaning(p, where, name, "a quantity of this element");
            for (int k = 0; k < model->signals && p->names->reads; ++k)
                if (model->signal[k].name && !strcmp(name, model->signal[k].name))
                    fail(p, where, "give the signal another name",
                         "'%s' is a quantity of this element here, and the name of a signal", name);
            const Law *law = reference(p, LAW_LOCAL, i, p->names->local[i]);
            return p->item->mirrored && (p->names->odd >> i & 1) ? negative(p, law) : law;
        }
    for (int i = 0; i < model->parameters; ++i)
        if (!strcmp(name, model->parameter[i].name))
            return reference(p, LAW_PARAMETER, i, model->parameter[i].name);
    if (!strcmp(name, "pi")) {
        has_one_meaning(p, where, name, "3.14159...");
        return number(p, 3.14159265358979323846);
    }
    int coordinate = coordinate_named(model, name);
    bool is_time = !strcmp(name, "time");
    if (coordinate >= 0 || is_time)
        only_constants(p, where, name);
    if (coordinate >= 0)
        return reference(p, LAW_VALUE, coordinate, model->coordinate[coordinate].name);
    if (is_time) {
        has_one_meaning(p, where, name, "the time of the simulation");
        return reference(p, LAW_TIME, 0, "time");
    }
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(name, model->input[i].name)) {
            only_constants(p, where, name);
            return reference(p, LAW_INPUT, i, model->input[i].name);
        }
    for (int i = 0; i < model->states; ++i)
        if (!strcmp(name, model->state[i].name)) {
            only_constants(p, where, name);
            return reference(p, LAW_STATE, i, model->state[i].name);
        }
    return signal_named(p, where, name);
}

static const Law *parse_atom(Parser *p)
{
    skip(p);
    if (take(p, "(")) {
        const Law *law = parse_or(p);
        expect(p, ")");
        return law;
    }
    if (isdigit((unsigned char)*p->s) || (*p->s == '.' && isdigit((unsigned char)p->s[1]))) {
        char *end;
        if (p->s[0] == '0' && (p->s[1] == 'x' || p->s[1] == 'X'))
            fail(p, p->s, "write decimal numbers", "'%.12s' is not a decimal number", p->s);
        double value = strtod(p->s, &end);
        if (!isfinite(value))
            fail(p, p->s, "numbers must be below 1.8e308 in magnitude", "the number is too large");
        if (isalpha((unsigned char)*end) || *end == '_')
            fail(p, end, "put an operator between them, and leave units away: everything is SI",
                 "a number runs into '%.12s'", end);
        p->s = end;
        return number(p, value);
    }
    if (isalpha((unsigned char)*p->s))
        return parse_name(p);
    fail(p, p->s, "a number, a name, a function or ( belongs here",
         *p->s ? "'%.12s' is unexpected" : "the formula ends too early%s", *p->s ? p->s : "");
}

static const Law *parse_sign(Parser *p);

static const Law *parse_power(Parser *p)
{
    const Law *base = parse_atom(p);
    skip(p);
    if (!strncmp(p->s, "**", 2))
        fail(p, p->s, "write a ^ b", "powers are written with ^");
    return take(p, "^") ? call(p, OP_POW, "pow", base, parse_sign(p), NULL) : base;
}

static const Law *parse_sign(Parser *p)
{
    if (++p->depth > DEPTH_MOST)
        fail(p, p->s, "split the law into several force elements", "the formula is nested too deeply");
    const Law *law = take(p, "-") ? negative(p, parse_sign(p)) : take(p, "+") ? parse_sign(p) : parse_power(p);
    --p->depth;
    return law;
}

static const Law *parse_product(Parser *p)
{
    const Law *law = parse_sign(p);
    for (;;) {
        if (take(p, "*"))
            law = call(p, OP_MUL, "*", law, parse_sign(p), NULL);
        else if (take(p, "/"))
            law = call(p, OP_DIV, "/", law, parse_sign(p), NULL);
        else
            return law;
    }
}

static const Law *parse_sum(Parser *p)
{
    const Law *law = parse_product(p);
    for (;;) {
        if (take(p, "+"))
            law = call(p, OP_ADD, "+", law, parse_product(p), NULL);
        else if (take(p, "-"))
            law = difference(p, law, parse_product(p));
        else
            return law;
    }
}

static const Law *parse_comparison(Parser *p)
{
    const Law *a = parse_sum(p);
    if (take(p, "<="))
        return truth(p, difference(p, a, parse_sum(p)), false);
    if (take(p, ">="))
        return truth(p, difference(p, parse_sum(p), a), false);
    if (take(p, "<"))
        return difference(p, parse_sum(p), a);
    if (take(p, ">"))
        return difference(p, a, parse_sum(p));
    skip(p);
    if (*p->s == '=')
        fail(p, p->s, "compare with < <= > >=; equal numbers are a matter of rounding", "'=' compares nothing");
    return a;
}

static const Law *parse_not(Parser *p)
{
    if (++p->depth > DEPTH_MOST)
        fail(p, p->s, "split the law into several force elements", "the formula is nested too deeply");
    skip(p);
    const char *where = p->s;
    const bool negated = take(p, "not");
    if (negated)
        has_one_meaning(p, where, "not", "an operator");
    const Law *law = negated ? truth(p, parse_not(p), false) : parse_comparison(p);
    --p->depth;
    return law;
}

static const Law *parse_and(Parser *p)
{
    const Law *law = parse_not(p);
    while (take(p, "and"))
        law = call(p, OP_MIN, "min", law, parse_not(p), NULL);
    return law;
}

static const Law *parse_or(Parser *p)
{
    const Law *law = parse_and(p);
    while (take(p, "or"))
        law = call(p, OP_MAX, "max", law, parse_and(p), NULL);
    return law;
}

static const char finite_remedy[] = "look for a division by zero or a root of a negative number";

/* True if the value does not depend on the state; *value is it. Fails if such a part is not a finite number and the
 * rest of the formula uses it: the code would never run. */
static bool is_known(Parser *p, const Law *law, double *value)
{
    const Model *model = p->names->model;
    const bool call = law->op == LAW_CALL;
    if (law->op == LAW_NUMBER ||
        (law->op == LAW_PARAMETER && !model->parameter[law->index].tunable && !model->parameter[law->index].law)) {
        *value = law_number(law, model);
        return true;
    }
    if (!law->arg[0])
        return false;
    double x[3] = {0};
    bool known[3] = {is_known(p, law->arg[0], &x[0])}, all = known[0];
    if (call && law->call == OP_POSITIVE && known[0])
        return is_known(p, law->arg[x[0] > 0 ? 1 : 2], value);
    for (int i = 1; i < 3 && law->arg[i]; ++i) {
        known[i] = is_known(p, law->arg[i], &x[i]);
        all = all && known[i];
    }
    if (all) {
        *value = call ? op_value((Op)law->call, x[0], x[1], x[2]) : table_value(&model->table[law->index], x[0]);
        return true;
    }
    for (int i = 0; i < 3; ++i)
        if (known[i] && !isfinite(x[i]))
            fail(p, p->item->text, finite_remedy, "a part of it is not a finite number, whatever the state");
    if (call && law->call == OP_DIV && known[1] && !isfinite(1 / x[1]))
        fail(p, p->item->text, finite_remedy, "it divides by %g, whatever the state", x[1]);
    return false;
}

const Law *law_parse(Pool *pool, const Item *item, const char *what, const LawNames *names)
{
    Parser p = {.pool = pool, .item = item, .what = what, .names = names, .s = item->text};
    if (item->kind != ITEM_SCALAR)
        diag_fail(item->at, "write a number or a formula in quotes", "%s must be a number or a formula", what);
    const Law *law = parse_or(&p);
    skip(&p);
    if (*p.s)
        fail(&p, p.s, "an operator is missing, or one parenthesis is too many", "'%.12s' is unexpected", p.s);
    double value;
    if (is_known(&p, law, &value) && !isfinite(value) && !names->constant)
        fail(&p, item->text, finite_remedy, "it is not a finite number, whatever the state");
    return item->negated ? negative(&p, law) : law;
}

bool law_is_tunable(const Law *law, const Model *model)
{
    if (law->op == LAW_PARAMETER)
        return model->parameter[law->index].tunable || model->parameter[law->index].law;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (law_is_tunable(law->arg[i], model))
            return true;
    return false;
}

double law_number(const Law *law, const Model *model)
{
    switch (law->op) {
    case LAW_NUMBER: return law->number;
    case LAW_PARAMETER: return model->parameter[law->index].value;
    case LAW_TABLE: return table_value(&model->table[law->index], law_number(law->arg[0], model));
    case LAW_CALL: {
        double x[3] = {0};
        for (int i = 0; i < 3 && law->arg[i]; ++i)
            x[i] = law_number(law->arg[i], model);
        return op_value((Op)law->call, x[0], x[1], x[2]);
    }
    case LAW_INPUT: return model->input[law->index].initial;
    case LAW_VALUE: return model->coordinate[law->index].initial;
    case LAW_STATE: return model->state[law->index].initial;
    default: return 0;
    }
}

Ex law_expression(Dag *dag, const Model *model, const Law *law)
{
    Ex arg[3] = {0};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = law_expression(dag, model, law->arg[i]);
    return law_top(dag, model, law, arg);
}

Ex law_top(Dag *dag, const Model *model, const Law *law, const Ex arg[3])
{
    const Parameter *parameter = law->op == LAW_PARAMETER ? &model->parameter[law->index] : NULL;
    if (parameter && parameter->tunable)
        return ex_input(dag, element_at(ARRAY_p, parameter->index), NULL);
    if (parameter)
        return parameter->law ? law_expression(dag, model, parameter->law) : ex_literal(dag, parameter->value);
    if (law->op == LAW_NUMBER)
        return ex_literal(dag, law->number);
    if (law->op == LAW_TABLE && dag->node[arg[0]].op == OP_LITERAL)
        return ex_literal(dag, table_value(&model->table[law->index], ex_value(dag, arg[0], 0)));
    if (law->op == LAW_TABLE)
        return ex_op(dag, OP_TABLE, arg[0], (Ex)law->index, 0);
    switch ((Op)law->call) {
    case OP_NEG: return ex_neg(dag, arg[0]);
    case OP_ADD: return ex_add(dag, arg[0], arg[1]);
    case OP_SUB: return ex_sub(dag, arg[0], arg[1]);
    case OP_MUL: return ex_mul(dag, arg[0], arg[1]);
    case OP_DIV: return ex_div(dag, arg[0], arg[1]);
    case OP_POW: return ex_pow(dag, arg[0], arg[1]);
    default: return ex_op(dag, (Op)law->call, arg[0], arg[1], arg[2]);
    }
}
