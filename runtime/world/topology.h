/* SPDX-License-Identifier: MIT
 *
 * What the topology-based solver of equations.h has decided about a mechanism, for tests and reports. */
#ifndef WORLD_TOPOLOGY_H
#define WORLD_TOPOLOGY_H

#include <stdbool.h>

/* `solver` comes from topology_solver.open. order: [constraints] place of each constraint in the elimination. stored:
 * [constraints][constraints] whether the columns of b have numbers in the rows of a, both in that order; there is no
 * other storage. */
void topology_pattern(const void *solver, int *order, bool *stored);

#endif
