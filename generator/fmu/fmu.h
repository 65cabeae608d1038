/* SPDX-License-Identifier: MIT
 *
 * fmu: a vehicle as Functional Mock-up Unit for other simulators, models/FMI.md. */
#ifndef FMU_FMU_H
#define FMU_FMU_H

#include "scene/scene.h"
#include "vehicle/vehicle.h"

/* Write the FMU `path` for FMI `version`, 2 or 3. scene: start values, step and stop time; NULL: the model's design at
 * rest. derivatives: it provides directional ones. implicit: co-simulation has implicit steps too (models/STIFF.md).
 * templates: as for generate(). Ends in diag_fail for what an FMU can't have; says on stderr for which platforms it has
 * binaries. */
void fmu_write(Pool *pool, int version, const Formulation *f, const Scene *scene, bool derivatives, bool implicit,
               const char *templates, const char *path);

#endif
