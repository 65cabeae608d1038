/* SPDX-License-Identifier: MIT
 * Variables of the C library for libtcc in the shared library, by other names (Makefile). They are set when it is
 * loaded, and never again. */
#include <stdio.h>

extern FILE *gicl_tcc_stdin, *gicl_tcc_stdout, *gicl_tcc_stderr;
extern char **gicl_tcc_environ; /* of programs that tcc would run: none */

FILE *gicl_tcc_stdin, *gicl_tcc_stdout, *gicl_tcc_stderr;
char **gicl_tcc_environ;

__attribute__((constructor)) static void set_streams(void)
{
    gicl_tcc_stdin = stdin;
    gicl_tcc_stdout = stdout;
    gicl_tcc_stderr = stderr;
}
