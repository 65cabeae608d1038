/* SPDX-License-Identifier: MIT
 * Sums over the lanes of vectors, as many at a time as there are lanes: adding while transposing, W vectors become one
 * with a sum a lane after W - 1 additions, where one by one each takes log2 W additions of its own and as many moves.
 */
#include "expression/expression.h"
#include "expression/vectorize.h"

int *fold_groups(Pool *pool, int sums, int wanted, const int *order, const int *depth, int lanes)
{
    int *group = pool_alloc(pool, ((size_t)sums + 1) * sizeof *group), groups = 0, most = 0;
    for (int i = 0; i < sums; ++i)
        group[i] = -1;
    for (int i = 0; i < wanted; ++i)
        most = depth[order[i]] > most ? depth[order[i]] : most;
    /* results of one group enter only sums of greater depth */
    for (int d = 0; d <= most; ++d)
        for (int i = 0; i < wanted;) {
            int member[lanes], count = 0;
            for (; i < wanted && count < lanes; ++i)
                if (depth[order[i]] == d)
                    member[count++] = order[i];
            for (int k = 0; k < count && 2 * count > lanes; ++k)
                group[member[k]] = groups;
            groups += count > 0;
        }
    return group;
}

Ex fold(Dag *dag, const Ex *vector, int count)
{
    Ex sum[dag->lanes];
    for (int i = 0; i < dag->lanes; ++i)
        sum[i] = vector[i < count ? i : count - 1];
    for (int left = dag->lanes / 2, step = 0; left >= 1; left /= 2, ++step)
        for (int i = 0; i < left; ++i)
            sum[i] = ex_fold(dag, sum[2 * i], sum[2 * i + 1], step);
    return sum[0];
}
