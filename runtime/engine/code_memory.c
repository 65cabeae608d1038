/* SPDX-License-Identifier: MIT
 * What generated code takes in memory, as the user's C compiler says: it compiles the code to assembly text in which
 * sizes stand as strings, and gcc also writes its graph of calls with the stack that each function takes. Nothing is
 * run, so that a compiler for another machine can be asked too. */
#include "base/file.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "host/host.h"
#include "report/report.h"

#include <stdlib.h>
#include <string.h>

static const char mark[] = "gicgen-size";

typedef struct Function {
    const char *name;
    size_t frame;
    bool above; /* on the way from the function that is asked about */
} Function;

typedef struct Call {
    const char *from, *to;
} Call;

typedef struct Graph {
    Pool *pool;
    Function *function;
    Call *call;
    int functions, calls;
    const char *any;     /* "hmmwv_any_": so begin functions of the descriptor */
    const char *runtime; /* its text */
} Graph;

/* The name in the quoted text after `key`: `name` for "model.c:name.part.0". NULL: the key is not there. */
static const char *quoted_name(Pool *pool, const char *line, const char *key)
{
    const char *at = strstr(line, key);
    if (!at)
        return NULL;
    at += strlen(key);
    const char *end = at + strcspn(at, "\"\n"), *colon = memchr(at, ':', (size_t)(end - at));
    at = colon ? colon + 1 : at;
    return pool_print(pool, "%.*s", (int)strcspn(at, ".\"\n"), at);
}

static Graph graph_read(Pool *pool, const char *text, const char *any)
{
    Graph g = {.pool = pool, .any = any, .runtime = ""};
    for (const Embedded *file = embedded; file->name; ++file)
        if (!strcmp(file->name, "gic_runtime.c"))
            g.runtime = file->bytes;
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL) {
        const char *one = pool_print(pool, "%.*s", (int)strcspn(line, "\n"), line);
        const char *name = quoted_name(pool, one, "node: { title: \""), *from, *bytes;
        if (name && (bytes = strstr(one, " bytes (")) != NULL) {
            while (bytes > one && strchr("0123456789", bytes[-1]))
                --bytes;
            *POOL_PUSH(pool, g.function, g.functions) = (Function){name, strtoul(bytes, NULL, 10), false};
        } else if ((from = quoted_name(pool, one, "sourcename: \"")) != NULL) {
            *POOL_PUSH(pool, g.call, g.calls) = (Call){from, quoted_name(pool, one, "targetname: \"")};
        }
    }
    return g;
}

/* True if the runtime calls the function through the descriptor. */
static bool is_pointed(const Graph *g, const char *name)
{
    const size_t length = strlen(g->any);
    return !strncmp(name, g->any, length) && strstr(g->runtime, pool_print(g->pool, "model->%s(", name + length));
}

/* Stack of a function and below. Calls through pointers in the runtime are of the descriptor's functions; in the model
 * they are of inputs and roads, which are the user's. */
static size_t graph_stack(Graph *g, const char *name, bool by_runtime)
{
    const bool indirect = !strcmp(name, "__indirect_call");
    size_t most = 0;
    for (int i = 0; i < g->functions; ++i) {
        Function *f = &g->function[i];
        if (f->above || !(indirect ? by_runtime && is_pointed(g, f->name) : !strcmp(f->name, name)))
            continue;
        const bool of_model = !strncmp(f->name, g->any, strlen(g->any) - strlen("any_"));
        size_t below = 0;
        f->above = true;
        for (int k = 0; k < g->calls; ++k) {
            const size_t callee = strcmp(g->call[k].from, f->name) ? 0 : graph_stack(g, g->call[k].to, !of_model);
            below = callee > below ? callee : below;
        }
        f->above = false;
        most = f->frame + below > most ? f->frame + below : most;
    }
    return most;
}

static void ask(Text *probe, const char *what, const char *name)
{
    text_print(probe, "    __asm__ volatile(\".ascii \\\"%s %s %%c0\\\"\" : : \"i\"(sizeof(%s)));\n", mark, what, name);
}

/* All constant objects of the code: lines at the margin that set something. */
static void ask_constants(Text *probe, const char *code, const char *numbers)
{
    for (const char *line = code; line; line = strchr(line, '\n'), line += line != NULL) {
        const char *end = line + strcspn(line, "\n"), *set = strstr(line, " = ");
        if (strchr(" \n#/", *line) || !set || set > end)
            continue;
        const char *behind = memchr(line, '[', (size_t)(set - line)), *name = behind = behind ? behind : set;
        while (name > line && !strchr(" *", name[-1]))
            --name;
        const char *word = pool_print(probe->pool, "%.*s", (int)(behind - name), name);
        ask(probe, strncmp(word, numbers, strlen(numbers)) ? "constant" : "number", word);
    }
}

/* Sums of the sizes in the assembly. */
static void answers_read(const char *assembly, CodeMemory *memory, int real)
{
    for (const char *at = assembly; (at = strstr(at, mark)) != NULL;) {
        char what[16];
        unsigned long bytes;
        at += strlen(mark);
        if (sscanf(at, " %15s %lu", what, &bytes) != 2)
            continue;
        if (!strcmp(what, "instance"))
            memory->instance[real] = bytes;
        else
            memory->constants[real] += bytes;
        if (!strcmp(what, "number"))
            memory->numbers[real] += bytes;
    }
}

/* Compile in the folder. False: that failed, and memory->why says how. */
static bool compile(Pool *pool, const char *folder, const char *compiler, const char *graph, CodeMemory *memory,
                    int real)
{
    int count;
    const char **words = compiler_words(pool, compiler, "", "", &count), *said;
    const char *const ours[] = {"-std=gnu99",
                                "-O0",
                                "-w",
                                real ? "-DGIC_FLOAT" : "-UGIC_FLOAT",
                                "-S",
                                "-o",
                                pool_print(pool, "%s/probe.s", folder),
                                pool_print(pool, "%s/probe.c", folder),
                                graph};
    char **argv = NULL;
    int all = 0;
    for (int i = 0; i < count; ++i)
        *POOL_PUSH(pool, argv, all) = pool_print(pool, "%s", words[i]);
    for (size_t i = 0; i < sizeof ours / sizeof *ours; ++i)
        if (ours[i])
            *POOL_PUSH(pool, argv, all) = pool_print(pool, "%s", ours[i]);
    *POOL_PUSH(pool, argv, all) = NULL;
    const int status = process_run(pool, argv, "", &said);
    if (status == PROCESS_NOT_STARTED)
        memory->why = pool_print(pool, "the C compiler '%s' can't be started: %s", compiler, said);
    else if (status)
        memory->why = pool_print(pool, "the C compiler '%s' can't compile it to assembly", compiler);
    return status == 0;
}

static bool measure(Pool *pool, const char *folder, const char *model, CodeMemory *memory, int real)
{
    size_t size;
    const char *compiler = memory->compiler;
    const char *assembly = pool_print(pool, "%s/probe.s", folder), *graph = pool_print(pool, "%s/probe.ci", folder);
    const bool told = compile(pool, folder, compiler, "-fcallgraph-info=su", memory, real);
    if (!told && !compile(pool, folder, compiler, NULL, memory, real))
        return false;
    answers_read(file_read(pool, assembly, TABLE_MOST, &size), memory, real);
    memory->stacks = told;
    if (!told)
        return true;
    Graph g = graph_read(pool, file_read(pool, graph, TABLE_MOST, &size), pool_print(pool, "%s_any_", model));
    /* a quarter more: optimization puts functions into each other and may take a tenth more than none */
    for (int i = 0; i < CODE_FUNCTIONS; ++i)
        memory->stack[real][i] = graph_stack(&g, pool_print(pool, "%s_%s", model, code_function[i]), false) / 4 * 5;
    return true;
}

CodeMemory code_memory(Pool *pool, const char *model, const Text *c, const Text *h)
{
    CodeMemory memory = {.compiler = compiler_default()};
    Text probe = {.pool = pool};
    text_print(&probe, "#include \"gic_runtime.c\"\n");
    text_add(&probe, h->s, h->size);
    text_add(&probe, c->s, c->size);
    text_print(&probe, "void gicgen_sizes(void);\nvoid gicgen_sizes(void)\n{\n");
    ask(&probe, "instance", model);
    ask_constants(&probe, c->s, pool_print(pool, "%s_k_", model));
    text_print(&probe, "}\n");
    interrupt_hold();
    const char *folder = folder_make(pool);
    bool good = folder && folder_put_core(pool, folder) && folder_put(pool, folder, "probe.c", probe.s, probe.size) &&
                folder_put(pool, folder, pool_print(pool, "%s.h", model), h->s, h->size);
    if (!good)
        memory.why = pool_print(pool, "no file can be written in %s", temporary_folder());
    for (int real = 0; good && real < 2; ++real)
        good = measure(pool, folder, model, &memory, real);
    if (folder)
        folder_remove(folder);
    interrupt_release();
    if (good)
        memory.why = NULL;
    return memory;
}
