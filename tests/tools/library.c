/* SPDX-License-Identifier: MIT
 * library run|equilibrium|modes|linearize MODEL [SCENE [TIME]]: by the library, the arrays of a result as text, numbers
 * as gicrun writes them; messages go to stderr as the library has them. library open MODEL...: opens them one after
 * another, writes to stderr what is said about each after its name, and goes on. Exit status: 1 if anything failed. */
#include "host/gic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void show(const gicl_messages *said)
{
    gicl_message message;
    for (int i = 0; gicl_message_get(said, i, &message); ++i)
        fputs(message.printed, stderr);
}

static void print_array(const gicl_array *a)
{
    printf("%s %lld %d\n", a->name, (long long)a->rows, a->columns);
    for (int k = 0; a->column_name && k < a->columns; ++k)
        printf("%s%s [%s]", k ? "," : "", a->column_name[k], a->column_unit[k]);
    if (a->column_name)
        printf("\n");
    for (int64_t i = 0; i < a->rows; ++i) {
        if (a->row_name)
            printf("%s [%s]: ", a->row_name[i], a->row_unit[i]);
        for (int k = 0; k < a->columns; ++k) {
            const double value = a->data[i * a->columns + k];
            printf(k ? "," : "");
            if (!isnan(value))
                printf("%.17g", value);
        }
        printf("\n");
    }
}

int main(int count, char **word)
{
    gicl_library *lib = gicl_open();
    gicl_messages *said = gicl_messages_new();
    gicl_handle model = 0, result = 0;
    int status = GICL_OK;
    if (count < 3)
        return 2;
    if (!strcmp(word[1], "open")) {
        for (int i = 2; i < count; ++i) {
            fprintf(stderr, "== %s\n", word[i]);
            const int each = gicl_model_open(lib, word[i], NULL, &model, said);
            const char *c, *h;
            const int made = each ? each : gicl_generate(lib, model, &c, &h, said);
            show(said);
            status = made ? made : status;
        }
    } else {
        const char *scene = count > 3 ? word[3] : NULL;
        const double at = count > 4 ? strtod(word[4], NULL) : NAN;
        const gicl_options options = {.size = sizeof options, .engine = getenv("LIBRARY_ENGINE")};
        status = gicl_model_open(lib, word[2], &options, &model, said);
        show(said);
        if (!status) {
            status = !strcmp(word[1], "run")           ? gicl_run(lib, model, scene, &result, said)
                     : !strcmp(word[1], "equilibrium") ? gicl_equilibrium(lib, model, scene, &result, said)
                     : !strcmp(word[1], "modes")       ? gicl_modes(lib, model, scene, &result, said)
                                                       : gicl_linearize(lib, model, scene, at, &result, said);
            show(said);
        }
        int arrays = 0;
        gicl_array array;
        if (result && !gicl_array_count(lib, result, &arrays, said))
            for (int i = 0; i < arrays; ++i)
                if (!gicl_array_get(lib, result, i, &array, sizeof array, said))
                    print_array(&array);
    }
    gicl_messages_free(said);
    gicl_close(lib);
    return status != GICL_OK;
}
