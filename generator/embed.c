/* SPDX-License-Identifier: MIT
 * A tool of the build: `embed FILE... > embedded.c` prints files as the C array `embedded` of emit/emit.h, so that
 * the programs need no data files. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a template what comes after `templates/`, of another file what comes after the last slash. */
static const char *short_name(const char *path)
{
    static const char folder[] = "templates/";
    const char *slash = strrchr(path, '/');
    if (!strncmp(path, folder, sizeof folder - 1))
        return path + sizeof folder - 1;
    return slash ? slash + 1 : path;
}

static _Noreturn void fail(const char *path)
{
    fprintf(stderr, "%s: error: %s\n", path, strerror(errno));
    exit(1);
}

/* Numbers instead of a string literal: C99 guarantees literals of 4095 characters only. */
static void print_bytes(const char *path, int index)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail(path);
    printf("\nstatic const char file_%d[] = {", index);
    int column = 0;
    for (int c; (c = getc(file)) != EOF; ++column)
        printf(c < 128 ? "%s%d," : "%s(char)%d,", column % 24 ? "" : "\n    ", c);
    if (ferror(file))
        fail(path);
    fclose(file);
    puts("\n    0};");
}

int main(int count, char **path)
{
    puts("/* SPDX-License-Identifier: MIT */\n#include \"emit/emit.h\"");
    for (int i = 1; i < count; ++i)
        print_bytes(path[i], i);
    puts("\nconst Embedded embedded[] = {");
    for (int i = 1; i < count; ++i)
        printf("    {\"%s\", file_%d, sizeof file_%d - 1},\n", short_name(path[i]), i, i);
    puts("    {NULL, NULL, 0},\n};");
    if (fflush(stdout) || ferror(stdout))
        fail("standard output");
    return 0;
}
