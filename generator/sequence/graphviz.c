/* SPDX-License-Identifier: MIT
 * Pictures through Graphviz. */
#include "base/file.h"
#include "sequence/sequence.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static _Noreturn void picture_fail(const char *path, const char *what, const char *remedy)
{
    fprintf(stderr, "%s: error: %s\n  remedy: %s\n", path, what, remedy);
    exit(1);
}

/* Run `dot -Tsvg` between two open files; its exit status, 127 when it is not there. */
static int run_dot(FILE *input, FILE *output)
{
    pid_t child = fork();
    if (child < 0)
        return -1;
    if (child == 0) {
        if (dup2(fileno(input), STDIN_FILENO) >= 0 && dup2(fileno(output), STDOUT_FILENO) >= 0)
            execlp("dot", "dot", "-Tsvg", (char *)NULL);
        _exit(127);
    }
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool picture_make(const char *path, const Text *dot, Text *svg)
{
    FILE *input = tmpfile(), *output = tmpfile();
    if (!input || !output || fwrite(dot->s, 1, dot->size, input) != dot->size || fflush(input))
        picture_fail(path, "can't make a temporary file", "free some space in the temporary folder");
    rewind(input);
    int status = run_dot(input, output);
    if (status && status != 127)
        picture_fail(path, "Graphviz's program `dot` failed", "ask for a .dot file and see what `dot` says of it");
    char buffer[1 << 14];
    rewind(output);
    for (size_t n; (n = fread(buffer, 1, sizeof buffer, output)) > 0;)
        text_add(svg, buffer, n);
    fclose(input);
    fclose(output);
    /* `dot` doesn't notice a full disk */
    if (!status && (!svg->size || !strstr(svg->s, "</svg>")))
        picture_fail(path, "Graphviz's program `dot` left half a picture", "free some space in the temporary folder");
    return !status;
}

void picture_write(Pool *pool, const char *path, const Text *dot)
{
    Text svg = {.pool = pool};
    if (!picture_make(path, dot, &svg))
        picture_fail(path, "Graphviz's program `dot` is not installed",
                     "install it (Debian: apt-get install graphviz), or ask for a .dot file");
    file_write(path, svg.s, svg.size);
}
