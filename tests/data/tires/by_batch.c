/* SPDX-License-Identifier: MIT
 * test_tire_tables.sh compiles it with rig.c and rig_batch.c, code for many vehicles with tires by short polynomials:
 * by_table.c for LANES vehicles at once.
 *
 *     by_batch FRICTION <states    the outputs at these states, of one vehicle after another; and each vehicle has the
 *                                  bits, after two steps too, that it has alone in the batch, in another lane
 */
#include "rig_batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = RIG_VEHICLES };

static gic_real friction;

static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = out[2] = 0;
}

static gic_real friction_there(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    return friction;
}

static const gic_road road = {height, friction_there};
static rig_batch together, apart;
static rig car[COUNT], found, alone;

/* Outputs of all, then states and rates after steps. */
static int alike(const rig *a, const rig *b)
{
    return a->head.status == b->head.status && !memcmp(a->output, b->output, sizeof a->output) &&
           !memcmp(a->state, b->state, sizeof a->state) && !memcmp(a->rate, b->rate, sizeof a->rate);
}

/* Print the outputs of `count` vehicles, and look at each of them alone. */
static int run(int count)
{
    int i, k, stage, good = 1;
    rig_batch_setup(&together);
    for (i = 0; i < count; ++i)
        rig_batch_load(&together, i, &car[i]);
    for (stage = 0; stage < 2; ++stage) {
        if (stage == 1)
            rig_batch_step_dual(&together, (gic_real)1e-3, 2, 0, 4);
        rig_batch_outputs(&together);
        for (i = 0; i < count; ++i) {
            const int lane = (i + 1) % COUNT;
            rig_batch_setup(&apart);
            rig_batch_load(&apart, lane, &car[i]);
            if (stage == 1)
                rig_batch_step_dual(&apart, (gic_real)1e-3, 2, 0, 4);
            rig_batch_outputs(&apart);
            rig_batch_store(&together, i, &found);
            rig_batch_store(&apart, lane, &alone);
            if (!alike(&found, &alone)) {
                fprintf(stderr, "FAIL vehicle %d of %d, stage %d: other bits than alone\n", i, count, stage);
                good = 0;
            }
            for (k = 0; stage == 0 && k < RIG_OUTPUTS; ++k)
                printf("%.17g,", (double)found.output[k]);
            if (stage == 0)
                printf("%d,%s\n", (int)found.head.status, gic_status_text(found.head.status));
        }
    }
    return good;
}

/* The states that the columns are; those of the header line that are none are refused. */
static int read_header(char *line, int *place)
{
    int columns = 0, i;
    char *word;
    for (word = strtok(line, ",\r\n"); word; word = strtok(NULL, ",\r\n")) {
        for (i = 0; i < RIG_STATES && strcmp(rig_model.state[i].name, word) != 0; ++i)
            ;
        if (i == RIG_STATES)
            return 0;
        place[columns++] = i;
    }
    return columns;
}

int main(int count, char **word)
{
    static char line[1 << 16];
    static int place[RIG_STATES];
    int columns, i, filled = 0, good = 1;
    if (count != 2 || !fgets(line, sizeof line, stdin) || !(columns = read_header(line, place)))
        return 1;
    friction = (gic_real)atof(word[1]);
    for (i = 0; i < RIG_OUTPUTS; ++i)
        printf("output.%s,", rig_model.output[i].name);
    printf("status,message\n");
    while (fgets(line, sizeof line, stdin)) {
        char *at = line;
        rig *one = &car[filled++];
        rig_setup(one);
        one->head.road = &road;
        for (i = 0; i < columns; ++i, ++at)
            one->state[place[i]] = (gic_real)strtod(at, &at);
        if (filled == COUNT) {
            good = run(filled) && good;
            filled = 0;
        }
    }
    return !((!filled || run(filled)) && good);
}
