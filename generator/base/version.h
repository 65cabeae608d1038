/* SPDX-License-Identifier: MIT
 *
 * The version, in one place: programs, manual pages, generated code and the package take it from here. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define GICGEN_VERSION "0.1.0"

#endif
