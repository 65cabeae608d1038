/* SPDX-License-Identifier: MIT
 *
 * Errors planted in the stores of blocks: base/plant.h. */
#ifndef VEHICLE_PLANT_STORES_H
#define VEHICLE_PLANT_STORES_H

#include "base/plant.h"
#include "vehicle/vehicle.h"

#ifdef GICGEN_PLANT
void plant_stores(const Formulation *f, const char *form);
#else
#define plant_stores(f, form) ((void)0)
#endif

#endif
