/* SPDX-License-Identifier: MIT
 * Pareto fronts of metrics. */
#include "base/message.h"
#include "host/host.h"
#include "sweep/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static _Noreturn void refuse(const char *why, const char *word)
{
    diag_fail_call(program_place(), "`gicsweep -h` shows how", "%s '%s'", why, word);
}

Front front_read(Pool *pool, const char *word, const SweepForm *form)
{
    const char **metric = pool_alloc(pool, sizeof *metric * (size_t)(form->columns + 1));
    int metrics = 0;
    for (int c = 0; c < form->columns; ++c)
        if (!strcmp(form->column[c].group, "metrics"))
            metric[metrics++] = form->column[c].name;
    Front front = {.metric = pool_alloc(pool, sizeof *front.metric * (size_t)(metrics + 1)),
                   .large = pool_alloc(pool, sizeof *front.large * (size_t)(metrics + 1))};
    for (const char *next = word, *end; next; next = *end ? end + 1 : NULL) {
        end = next + strcspn(next, ",");
        const bool large = !strncmp(next, "max:", 4);
        if (!large && strncmp(next, "min:", 4) != 0)
            refuse("--front takes min:NAME,max:NAME,... of metrics, not", word);
        const char *name = pool_print(pool, "%.*s", (int)(end - next - 4), next + 4);
        int m = 0;
        while (m < metrics && strcmp(metric[m], name) != 0)
            ++m;
        if (m == metrics)
            refuse("there is no --metric", name);
        for (int k = 0; k < front.numbers; ++k)
            if (front.metric[k] == m)
                refuse("--front has twice the metric", name);
        front.metric[front.numbers] = m;
        front.large[front.numbers++] = large;
    }
    if (front.numbers < 2)
        refuse("a front is of two metrics or more, not of", word);
    return front;
}

typedef struct Member {
    int64_t run;
    int numbers;
    const double *value; /* [numbers] */
} Member;

static int compare(const void *one, const void *other)
{
    const Member *a = one, *b = other;
    for (int k = 0; k < a->numbers; ++k)
        if (a->value[k] < b->value[k] || a->value[k] > b->value[k])
            return a->value[k] < b->value[k] ? -1 : 1;
    return a->run < b->run ? -1 : a->run > b->run;
}

/* Is the first one nowhere larger, and somewhere smaller? */
static bool beats(const Member *a, const Member *b)
{
    bool smaller = false;
    for (int k = 0; k < a->numbers; ++k) {
        if (a->value[k] > b->value[k])
            return false;
        smaller = smaller || a->value[k] < b->value[k];
    }
    return smaller;
}

int64_t front_find(Pool *pool, int64_t runs, int numbers, const double *value, int64_t *on)
{
    Member *member = pool_alloc(pool, sizeof *member * (size_t)(runs + 1));
    int64_t members = 0, front = 0;
    for (int64_t r = 0; r < runs; ++r) {
        bool finite = true;
        for (int k = 0; k < numbers; ++k)
            finite = finite && isfinite(value[r * numbers + k]);
        if (finite)
            member[members++] = (Member){r, numbers, value + r * numbers};
    }
    qsort(member, (size_t)members, sizeof *member, compare);
    for (int64_t i = 0; i < members;
         ++i) { /* what beats a run comes before it, and so does one of the front that does */
        bool beaten = false;
        for (int64_t k = front; k > 0 && !beaten; --k)
            beaten = beats(&member[k - 1], &member[i]);
        if (!beaten)
            member[front++] = member[i];
    }
    for (int64_t i = 0; i < front; ++i)
        on[i] = member[i].run;
    return front;
}
