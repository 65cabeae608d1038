/* SPDX-License-Identifier: MIT
 * What emitted C takes in memory, read from its own declarations: so nothing about it is written down twice. It knows
 * as much of C as the templates and the runtime use, and refuses what it does not know. */
#include "gicgen.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* What a frame holds besides parameters and locals: return address, saved registers, alignment, parts of an expression.
 * Compilers take up to about half of it. */
enum { FRAME_BYTES = 256, POINTER_BYTES = 8 };

typedef struct Size {
    size_t bytes, align;
} Size;

/* A type, an enumerator (its value is in `bytes`), or a constant object. */
typedef struct Named {
    const char *name;
    Size size;
} Named;

/* A macro of one or two arguments that may stand in a size. */
typedef struct Macro {
    const char *name, *argument[2], *text;
    int arguments;
} Macro;

typedef struct Function {
    const char *name;
    bool private; /* to its file */
    size_t frame;
    int calls;
    const char **call; /* names of what it calls, a name a place */
    int depth;         /* of calls, while stacks are added up */
} Function;

struct Measure {
    Pool *pool;
    const char *prefix; /* of the model's functions that the descriptor points to: "hmmwv_any_" */
    int types, enumerators, constants, functions, macros;
    Named *type, *enumerator, *constant;
    Macro *macro;
    Function *function;
    int tokens, next; /* of the text that is read, and where reading is */
    const char **token;
};

/* ---- tokens ------------------------------------------------------------------------------------------------------ */

static bool is_word(const char *s)
{
    return isalpha((unsigned char)*s) || *s == '_';
}

static const char *end_of_literal(const char *s)
{
    const char quote = *s++;
    while (*s && *s != quote)
        s += *s == '\\' && s[1] ? 2 : 1;
    return *s ? s + 1 : s;
}

/* The end of what is not for the compiler proper: blanks, comments, lines of the preprocessor; `s` where none is. A
 * line that defines a number counts as an enumerator. */
static const char *end_of_nothing(Measure *m, const char *s)
{
    if (isspace((unsigned char)*s))
        return s + 1;
    if (s[0] == '/' && s[1] == '*') {
        const char *end = strstr(s + 2, "*/");
        return end ? end + 2 : s + strlen(s);
    }
    if (*s != '#')
        return s;
    char name[64], number[16], argument[2][32], text[128];
    if (sscanf(s, "#define %63[A-Za-z0-9_] %15[0-9]", name, number) == 2)
        *POOL_PUSH(m->pool, m->enumerator, m->enumerators) =
            (Named){pool_print(m->pool, "%s", name), {strtoul(number, NULL, 10), 0}};
    int arguments = 0;
    if (sscanf(s, "#define %63[A-Za-z0-9_](%31[a-z_], %31[a-z_]) %127[^\n]", name, argument[0], argument[1], text) == 4)
        arguments = 2;
    else if (sscanf(s, "#define %63[A-Za-z0-9_](%31[a-z_]) %127[^\n]", name, argument[0], text) == 3)
        arguments = 1;
    if (arguments) {
        Macro *macro = POOL_PUSH(m->pool, m->macro, m->macros);
        *macro = (Macro){.name = pool_print(m->pool, "%s", name), .arguments = arguments};
        for (int i = 0; i < arguments; ++i)
            macro->argument[i] = pool_print(m->pool, "%s", argument[i]);
        macro->text = pool_print(m->pool, "%s", text);
    }
    while (*s && *s != '\n')
        s += *s == '\\' && s[1] ? 2 : 1;
    return s;
}

static void tokens_read(Measure *m, const char *s)
{
    m->tokens = m->next = 0;
    m->token = NULL;
    while (*s) {
        const char *end = end_of_nothing(m, s);
        if (end == s) {
            if (is_word(s) || isdigit((unsigned char)*s))
                while (isalnum((unsigned char)*end) || *end == '_')
                    ++end;
            else if (*s == '"' || *s == '\'')
                end = end_of_literal(s);
            else
                end += s[0] == '-' && s[1] == '>' ? 2 : 1;
            *POOL_PUSH(m->pool, m->token, m->tokens) = pool_print(m->pool, "%.*s", (int)(end - s), s);
        }
        s = end;
    }
}

static const char *token(const Measure *m, int ahead)
{
    return m->next + ahead < m->tokens ? m->token[m->next + ahead] : "";
}

static bool is(const Measure *m, const char *word)
{
    return !strcmp(token(m, 0), word);
}

static bool accept(Measure *m, const char *word)
{
    bool here = is(m, word);
    m->next += here;
    return here;
}

static _Noreturn void refuse(const Measure *m, const char *what)
{
    fprintf(stderr, "gicgen: error: %s in the emitted code, before `%s %s %s %s`\n  remedy: %s\n", what, token(m, 0),
            token(m, 1), token(m, 2), token(m, 3), "declare in templates what generator/measure.c can read");
    exit(1);
}

/* Past the bracket that closes the one that comes next; returns how many brackets stand directly inside. */
static int skip_brackets(Measure *m)
{
    int depth = 0, inside = 0;
    do {
        const char *t = token(m, 0);
        if (strchr("([{", *t)) {
            inside += depth == 1;
            ++depth;
        } else if (strchr(")]}", *t)) {
            --depth;
        }
        if (m->next++ >= m->tokens)
            refuse(m, "a bracket that nothing closes");
    } while (depth);
    return inside;
}

/* ---- types and declarators --------------------------------------------------------------------------------------- */

static const Named *find(const Named *named, int count, const char *name)
{
    for (int i = 0; i < count; ++i)
        if (!strcmp(named[i].name, name))
            return &named[i];
    return NULL;
}

/* Where the same name is declared for either number type, the larger one counts. */
static void add_type(Measure *m, const char *name, Size size)
{
    Named *known = (Named *)find(m->type, m->types, name);
    if (!known)
        *POOL_PUSH(m->pool, m->type, m->types) = (Named){name, size};
    else if (strcmp(name, "gic_real") && size.bytes > known->size.bytes)
        known->size = size;
}

static size_t sum_read(Measure *m);

/* A macro's text with the sizes that its arguments are. */
static size_t macro_read(Measure *m, const Macro *macro)
{
    Named argument[2];
    for (int i = 0; i < macro->arguments; ++i) {
        if (!accept(m, i ? "," : "("))
            refuse(m, "a size that can't be read");
        argument[i] = (Named){macro->argument[i], {sum_read(m), 0}};
    }
    if (!accept(m, ")"))
        refuse(m, "a size that can't be read");
    Measure inside = {
        .pool = m->pool, .enumerators = macro->arguments, .enumerator = argument, .types = m->types, .type = m->type};
    tokens_read(&inside, macro->text);
    return sum_read(&inside);
}

static size_t factor_read(Measure *m)
{
    for (int i = 0; i < m->macros; ++i)
        if (!strcmp(m->macro[i].name, token(m, 0))) {
            ++m->next;
            return macro_read(m, &m->macro[i]);
        }
    if (accept(m, "(")) {
        size_t sum = sum_read(m);
        if (!accept(m, ")"))
            refuse(m, "a size that can't be read");
        return sum;
    }
    if (accept(m, "sizeof")) {
        const Named *type = accept(m, "(") ? find(m->type, m->types, token(m, 0)) : NULL;
        ++m->next;
        if (!type || !accept(m, ")"))
            refuse(m, "a size that can't be read");
        return type->size.bytes;
    }
    const char *t = token(m, 0);
    const Named *enumerator = find(m->enumerator, m->enumerators, t);
    if (!enumerator && !isdigit((unsigned char)*t))
        refuse(m, "a size that can't be read");
    ++m->next;
    return enumerator ? enumerator->size.bytes : strtoul(t, NULL, 10);
}

static size_t product_read(Measure *m)
{
    size_t product = factor_read(m);
    while (is(m, "*") || is(m, "/") || is(m, "%")) {
        const char operation = *m->token[m->next++];
        const size_t factor = factor_read(m);
        if (operation != '*' && factor == 0)
            refuse(m, "a division by zero");
        product = operation == '*' ? product * factor : operation == '/' ? product / factor : product % factor;
    }
    return product;
}

/* Sizes of arrays are sums and differences of products, quotients and remainders of numbers, enumerators, sizes of
 * types and macros of those. */
static size_t sum_read(Measure *m)
{
    size_t sum = 0;
    bool minus = false;
    do {
        const size_t product = product_read(m);
        sum = minus ? sum - product : sum + product;
        minus = is(m, "-");
    } while (accept(m, "+") || accept(m, "-"));
    return sum;
}

static bool is_qualifier(const char *t)
{
    static const char *const word[] = {"static",   "const",        "extern",   "inline",
                                       "unsigned", "GIC_RESTRICT", "GIC_COLD", "GIC_APART"};
    for (size_t i = 0; i < sizeof word / sizeof *word; ++i)
        if (!strcmp(t, word[i]))
            return true;
    return false;
}

static void skip_qualifiers(Measure *m)
{
    while (is_qualifier(token(m, 0)))
        ++m->next;
}

static Size structure_read(Measure *m);

/* A type without its declarators. */
static Size type_read(Measure *m)
{
    skip_qualifiers(m);
    if (accept(m, "struct")) {
        if (strcmp(token(m, 0), "{"))
            ++m->next;
        if (is(m, "{"))
            return structure_read(m);
        return (Size){0, 1}; /* named only, so pointers to it follow */
    }
    const Named *type = find(m->type, m->types, token(m, 0));
    if (!type)
        refuse(m, "an unknown type");
    ++m->next;
    skip_qualifiers(m);
    return type->size;
}

/* One declarator of a type; its name. An array without a size gets that of its initializer. */
static const char *declarator_read(Measure *m, Size type, Size *size)
{
    const char *name;
    *size = type;
    while (is(m, "*") || is_qualifier(token(m, 0)))
        if (!strcmp(m->token[m->next++], "*"))
            *size = (Size){POINTER_BYTES, POINTER_BYTES};
    if (is(m, "(")) { /* (*name)(arguments) */
        *size = (Size){POINTER_BYTES, POINTER_BYTES};
        name = token(m, 2);
        skip_brackets(m);
        skip_brackets(m);
        return name;
    }
    name = token(m, 0);
    if (!is_word(name))
        refuse(m, "a declaration that can't be read");
    ++m->next;
    bool open = false;
    while (accept(m, "[")) {
        if (is(m, "]"))
            open = true;
        else
            size->bytes *= sum_read(m);
        if (!accept(m, "]"))
            refuse(m, "a size that can't be read");
    }
    if (accept(m, "=")) {
        if (is(m, "{"))
            size->bytes *= (size_t)(open ? skip_brackets(m) : (skip_brackets(m), 1));
        while (m->next < m->tokens && !is(m, ",") && !is(m, ";")) {
            if (strchr("([{", *token(m, 0)))
                skip_brackets(m);
            else
                ++m->next;
        }
    }
    return name;
}

/* Members between braces, laid out as every C compiler of 64 bits does. */
static Size structure_read(Measure *m)
{
    Size all = {0, 1};
    accept(m, "{");
    while (!accept(m, "}")) {
        const Size type = type_read(m);
        do {
            Size size;
            declarator_read(m, type, &size);
            all.bytes = (all.bytes + size.align - 1) / size.align * size.align + size.bytes;
            all.align = size.align > all.align ? size.align : all.align;
        } while (accept(m, ","));
        if (!accept(m, ";"))
            refuse(m, "a structure that can't be read");
    }
    all.bytes = (all.bytes + all.align - 1) / all.align * all.align;
    return all;
}

/* ---- functions --------------------------------------------------------------------------------------------------- */

static bool is_statement_word(const char *t)
{
    static const char *const word[] = {"return", "else", "case", "goto", "do", "sizeof"};
    for (size_t i = 0; i < sizeof word / sizeof *word; ++i)
        if (!strcmp(t, word[i]))
            return true;
    return false;
}

/* Does a declaration of locals begin here? Types stand in casts and after sizeof too, and then no name follows. */
static bool declaration_begins(const Measure *m)
{
    int i = 0;
    while (is_qualifier(token(m, i)))
        ++i;
    if (!is_word(token(m, i)) || is_statement_word(token(m, i)))
        return false;
    bool type = find(m->type, m->types, token(m, i)), word = is_word(token(m, i + 1));
    for (++i; !strcmp(token(m, i), "*") || is_qualifier(token(m, i)); ++i)
        continue;
    return (type || word) && is_word(token(m, i));
}

/* Arguments of a call or parameters of a function, at the bracket that opens them. */
static size_t parameters_count(const Measure *m)
{
    size_t count = strcmp(token(m, 1), "void") || strcmp(token(m, 2), ")");
    int depth = 0;
    for (int i = 0; m->next + i < m->tokens; ++i) {
        depth += *token(m, i) == '(' ? 1 : *token(m, i) == ')' ? -1 : 0;
        if (!depth)
            break;
        count += depth == 1 && *token(m, i) == ',';
    }
    return count;
}

/* What a function calls; through the descriptor, that is a member, it calls the model's own. Macros and key words are
 * among the names and mean no function. */
static void calls_read(Measure *m, Function *f, int from, int to)
{
    for (int i = from; i + 1 < to; ++i)
        if (is_word(m->token[i]) && *m->token[i + 1] == '(')
            *POOL_PUSH(m->pool, f->call, f->calls) =
                strcmp(m->token[i - 1], "->") ? m->token[i] : pool_print(m->pool, "%s%s", m->prefix, m->token[i]);
}

static void body_read(Measure *m, Function *f)
{
    const int from = m->next;
    skip_brackets(m);
    const int to = m->next;
    calls_read(m, f, from, to);
    for (m->next = from; m->next < to;) {
        if (!accept(m, "typedef") && !declaration_begins(m)) {
            ++m->next;
            continue;
        }
        const bool type_only = !strcmp(m->token[m->next - 1], "typedef");
        const Size type = type_read(m);
        do {
            Size size;
            const char *name = declarator_read(m, type, &size);
            if (type_only)
                add_type(m, name, size);
            else
                f->frame += size.bytes;
        } while (accept(m, ","));
    }
}

static void function_read(Measure *m, const char *name, bool private)
{
    Function f = {.name = name, .private = private, .frame = FRAME_BYTES + POINTER_BYTES * parameters_count(m)};
    skip_brackets(m);
    if (accept(m, ";"))
        return;
    body_read(m, &f);
    *POOL_PUSH(m->pool, m->function, m->functions) = f;
}

/* ---- a whole text ------------------------------------------------------------------------------------------------ */

static void enumeration_read(Measure *m)
{
    const int from = m->next;
    skip_brackets(m);
    for (int i = from; i + 2 < m->next; ++i)
        if (is_word(m->token[i]) && !strcmp(m->token[i + 1], "=") && isdigit((unsigned char)*m->token[i + 2]))
            *POOL_PUSH(m->pool, m->enumerator, m->enumerators) =
                (Named){m->token[i], {strtoul(m->token[i + 2], NULL, 10), 0}};
}

static void typedef_read(Measure *m)
{
    const Size word = {4, 4};
    if (accept(m, "enum")) {
        m->next += !is(m, "{");
        enumeration_read(m);
        add_type(m, token(m, 0), word);
    } else {
        Size size = type_read(m);
        if (*token(m, 1) == '(')
            size = (Size){0, 1}; /* a function, only ever pointed to */
        else
            while (accept(m, "*"))
                size = (Size){POINTER_BYTES, POINTER_BYTES};
        add_type(m, token(m, 0), size);
    }
    while (!accept(m, ";"))
        ++m->next;
}

/* A function, its prototype, or constants. */
static void object_read(Measure *m)
{
    const bool declared_only = is(m, "extern"), private = is(m, "static");
    const Size type = type_read(m);
    int ahead = 0;
    while (!strcmp(token(m, ahead), "*") || is_qualifier(token(m, ahead)))
        ++ahead;
    if (*token(m, ahead + 1) == '(') {
        m->next += ahead + 1;
        function_read(m, m->token[m->next - 1], private);
        return;
    }
    Size size;
    const char *name = declarator_read(m, type, &size);
    if (!accept(m, ";"))
        refuse(m, "a declaration that can't be read");
    if (!declared_only)
        *POOL_PUSH(m->pool, m->constant, m->constants) = (Named){name, size};
}

void measure_read(Measure *m, const char *text)
{
    tokens_read(m, text);
    while (m->next < m->tokens) {
        if (accept(m, "typedef"))
            typedef_read(m);
        else if (accept(m, "enum"))
            enumeration_read(m);
        else if (is(m, "extern") && *token(m, 1) == '"')
            m->next += 3; /* extern "C" and its brace */
        else if (!accept(m, ";") && !accept(m, "}"))
            object_read(m);
    }
}

Measure *measure_new(Pool *pool, const char *model, size_t real)
{
    static const Named type[] = {
        {"void", {0, 1}},   {"char", {1, 1}},     {"int", {4, 4}},      {"int32_t", {4, 4}}, {"int64_t", {8, 8}},
        {"size_t", {8, 8}}, {"uint32_t", {4, 4}}, {"uint64_t", {8, 8}}, {"float", {4, 4}},   {"double", {8, 8}},
    };
    Measure *m = pool_alloc(pool, sizeof *m);
    *m = (Measure){.pool = pool, .prefix = pool_print(pool, "%s_any_", model)};
    add_type(m, "gic_real", (Size){real, real});
    for (size_t i = 0; i < sizeof type / sizeof *type; ++i)
        add_type(m, type[i].name, type[i].size);
    return m;
}

size_t measure_type(const Measure *m, const char *name)
{
    const Named *type = find(m->type, m->types, name);
    return type ? type->size.bytes : 0;
}

int measure_number(const Measure *m, const char *name)
{
    const Named *number = find(m->enumerator, m->enumerators, name);
    return number ? (int)number->size.bytes : 0;
}

size_t measure_constants(const Measure *m, const char *start)
{
    size_t sum = 0;
    for (int i = 0; i < m->constants; ++i)
        if (!strncmp(m->constant[i].name, start, strlen(start)))
            sum += m->constant[i].size.bytes;
    return sum;
}

static Function *function_find(const Measure *m, const char *name)
{
    for (int i = 0; i < m->functions; ++i)
        if (!strcmp(m->function[i].name, name))
            return &m->function[i];
    return NULL;
}

/* Compilers make a private function that is called in one place only a part of its caller, and then its locals lie
 * beside those of whatever else the caller calls. */
static bool is_part(const Measure *m, const Function *f)
{
    int places = 0;
    for (int i = 0; i < m->functions; ++i)
        for (int k = 0; k < m->function[i].calls; ++k)
            places += !strcmp(m->function[i].call[k], f->name);
    return f->private && places == 1;
}

/* Bytes of a function with its parts, and below it: of the deepest of the other functions that it calls. */
static void stack_add(const Measure *m, Function *f, size_t *own, size_t *below)
{
    const int depth_most = 100;
    if (f->depth++ > depth_most) {
        fprintf(stderr, "gicgen: error: %s in the emitted code calls itself\n", f->name);
        exit(1);
    }
    *own = f->frame;
    *below = 0;
    for (int i = 0; i < f->calls; ++i) {
        Function *callee = function_find(m, f->call[i]);
        if (!callee)
            continue;
        size_t frame, deeper;
        stack_add(m, callee, &frame, &deeper);
        const bool part = is_part(m, callee);
        *own += part ? frame : 0;
        deeper += part ? 0 : frame;
        *below = deeper > *below ? deeper : *below;
    }
    --f->depth;
}

size_t measure_stack(const Measure *m, const char *name)
{
    Function *f = function_find(m, name);
    size_t own = 0, below = 0;
    if (f)
        stack_add(m, f, &own, &below);
    return own + below;
}
