/* SPDX-License-Identifier: MIT
 * Classes whose members need different pivots come apart. */
#include "subset.h"

#include <string.h>

/* Is there one pivot order for these members of a class, at the design? */
static bool share_pivots(Work *w, const bool *with)
{
    double column_scale[w->n];
    bool row_left[w->n], usable[w->dag->samples];
    int rank;
    for (int j = 0; j < w->n; ++j)
        column_scale[j] = j % 6 < 3 ? w->size : 1;
    for (int s = 0; s < w->dag->samples; ++s)
        usable[s] = s % w->configurations == 0 && with[s / w->configurations];
    return linear_factor(w->dag, w->n, w->J, column_scale, usable, &rank, row_left);
}

static const char *split_name(Pool *pool, const Sequence *sequence, const char *name)
{
    for (int number = 2;; ++number) {
        const char *candidate = pool_print(pool, "%.36s_%d", name, number);
        bool taken = false;
        for (int c = 0; c < sequence->classes; ++c)
            taken = taken || !strcmp(sequence->class[c].name, candidate);
        if (!taken)
            return candidate;
    }
}

bool class_split(Pool *pool, Sequence *sequence, int c, Work *w)
{
    Class *class = &sequence->class[c];
    bool with[class->members];
    for (int i = 0; i < class->members; ++i)
        with[i] = true;
    if (class->members == 1 || share_pivots(w, with))
        return false;
    memset(with, 0, sizeof with);
    for (int i = 0; i < class->members; ++i) {
        with[i] = true;
        with[i] = i == 0 || share_pivots(w, with);
    }
    Class *other = &sequence->class[sequence->classes];
    *other = (Class){.name = split_name(pool, sequence, class->name),
                     .member = pool_alloc(pool, (size_t) class->members * sizeof(int))};
    int kept = 0, *member = pool_alloc(pool, (size_t) class->members * sizeof *member);
    for (int i = 0; i < class->members; ++i) {
        if (with[i]) {
            member[kept++] = class->member[i];
        } else {
            other->member[other->members++] = class->member[i];
            sequence->subset[class->member[i]].class = sequence->classes;
        }
    }
    class->member = member;
    class->members = kept;
    ++sequence->classes;
    return true;
}
