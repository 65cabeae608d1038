/* SPDX-License-Identifier: MIT
 *
 * fmu: a vehicle as Functional Mock-up Unit for other simulators, models/FMI.md. */
#ifndef FMU_FMU_H
#define FMU_FMU_H

#include "emit/emit.h"
#include "scene/scene.h"
#include "vehicle/vehicle.h"

/* Write the FMU `path` for FMI `version`, 2 or 3. scene: start values, step and stop time; NULL: the model's design at
 * rest. style: with `derivatives` it provides directional ones, with `implicit` co-simulation has implicit steps too,
 * with `spread` perhaps Jacobians by shares (models/STIFF.md). templates: as for generate(). Ends in diag_fail for what
 * an FMU can't have; says on stderr for which platforms it has binaries. */
void fmu_write(Pool *pool, int version, const Formulation *f, const Scene *scene, const Style *style,
               const char *templates, const char *path);

#endif
