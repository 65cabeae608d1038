/* SPDX-License-Identifier: MIT
 *
 * What the topology-based solver of equations.h has decided about a mechanism, for tests and reports. */
#ifndef GIC_TOPOLOGY_H
#define GIC_TOPOLOGY_H

#include "equations.h"

/* `solver` comes from topology_solver.open. order: [constraints] place of each constraint in the elimination. factor:
 * [constraints][constraints] whether the factor holds a block in row a and column b, both in the order of
 * elimination; only b <= a can. */
void topology_pattern(const void *solver, int *order, bool *factor);

#endif
