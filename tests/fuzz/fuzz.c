/* SPDX-License-Identifier: MIT
 * READER=veh|scene|tir|road|formula fuzz [libFuzzer's options] [FOLDER...]
 *
 * Feeds one of the readers with what clang's libFuzzer makes of the seeds in the folders. Whatever the bytes are, a
 * reader refuses them with exit(1), or takes them and then all that it made of them is checked. A crash, a sanitizer's
 * complaint, another exit status or a number that is not finite is a finding, which libFuzzer writes to a file. */
#include "blocks.h"
#include "targets.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerInitialize(int *count, char ***word);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
_Noreturn void __real_exit(int status);
_Noreturn void __wrap_exit(int status);

/* libFuzzer calls functions without an argument of ours. */
static struct {
    const Target *target;
    int file; /* without a name, with what is to be read */
    char path[40];
    bool reading;
    jmp_buf refused;
} fuzz;

_Noreturn void __wrap_exit(int status)
{
    if (!fuzz.reading)
        __real_exit(status);
    if (status != 1)
        abort();
    longjmp(fuzz.refused, 1);
}

int LLVMFuzzerInitialize(int *count, char ***word)
{
    const char *name = getenv("READER");
    (void)count;
    (void)word;
    for (const Target *target = targets; target->name; ++target)
        if (name && !strcmp(target->name, name))
            fuzz.target = target;
    FILE *file = tmpfile();
    if (!fuzz.target || !file) {
        fprintf(stderr, "fuzz: error: %s\n", fuzz.target ? "no temporary file" : "READER names no reader");
        __real_exit(2);
    }
    fuzz.file = fileno(file);
    snprintf(fuzz.path, sizeof fuzz.path, "/proc/self/fd/%d", fuzz.file);
    if (fuzz.target->prepare)
        fuzz.target->prepare();
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        abort();
    memcpy(text, bytes, size);
    text[size] = 0;
    Bytes input = {.path = fuzz.path, .file = fuzz.file, .bytes = text, .size = size};
    blocks_begin();
    fuzz.reading = true;
    if (!setjmp(fuzz.refused))
        fuzz.target->read(&input);
    fuzz.reading = false;
    blocks_end();
    free(text);
    return 0;
}
