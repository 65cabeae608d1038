/* SPDX-License-Identifier: MIT
 * Command lines from a table of options. */
#include "base/text.h"
#include "base/version.h"
#include "host/host.h"

#include <getopt.h>
#include <stdlib.h>

enum { VERSION = 256, FIRST_LONG };

int options_read(const char *program, const char *const *help, int count, char **word, const Option *option,
                 int options, void *context, UsageFail *fail)
{
    Pool *pool = pool_new();
    struct option *known = pool_alloc(pool, (size_t)(options + 3) * sizeof *known);
    Text letters = {.pool = pool};
    if (fail)
        text_print(&letters, ":"); /* getopt tells what is missing from what is not known */
    for (int i = 0; i < options; ++i) {
        known[i] = (struct option){option[i].name ? option[i].name : "", option[i].on ? no_argument : required_argument,
                                   NULL, option[i].letter ? option[i].letter : FIRST_LONG + i};
        if (option[i].letter)
            text_print(&letters, "%c%s", option[i].letter, option[i].on ? "" : ":");
    }
    known[options] = (struct option){"help", no_argument, NULL, 'h'};
    known[options + 1] = (struct option){"version", no_argument, NULL, VERSION};
    text_print(&letters, "h");
    opterr = !fail;
    for (int found; (found = getopt_long(count, word, letters.s, known, NULL)) != -1;) {
        const Option *one = NULL;
        for (int i = 0; i < options; ++i)
            if (found == known[i].val)
                one = &option[i];
        if (found == 'h' || found == VERSION) {
            for (int i = 0; found == 'h' && help[i]; ++i)
                fputs(help[i], stdout);
            if (found == VERSION)
                printf("%s %s\n", program, GICGEN_VERSION);
            exit(0);
        } else if (!one && fail) {
            fail(found == ':' ? "an argument is missing after" : "unknown option", word[optind - 1]);
        } else if (!one) {
            fprintf(stderr, "  remedy: `%s -h` shows how\n", program);
            exit(2);
        } else if (one->on) {
            *one->on = true;
        } else if (one->text) {
            *one->text = optarg;
        } else {
            one->read(context, optarg);
        }
    }
    pool_free(pool);
    return optind;
}
