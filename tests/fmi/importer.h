/* SPDX-License-Identifier: MIT
 *
 * What the files of the importer share. */
#ifndef FMI_IMPORTER_H
#define FMI_IMPORTER_H

#include "unit.h"

enum { EXCHANGE, STEPS };

/* End the program with a message; where a status is not OK; where a condition does not hold. */
_Noreturn void fail(const char *what);
void need(Status status, const char *what);
void expect(bool good, const char *what);

Unit unit_load(const char *library_path, const char *description);
Component instantiate(const Unit *unit, const char *name, int kind);
/* plane: the road of the master's, NULL: none. word: NAME=VALUE. */
void initialize_on(const Unit *unit, Component c, const double *plane, double stop, int count, char **word);
/* The plane z = plane[0] x + plane[1] y with friction plane[2], under each wheel where it is. Returns how many there
 * are. */
int give_road(const Unit *unit, Component c, const double plane[3]);
/* A real variable by its name. */
double get_named(const Unit *unit, Component c, const char *name);
void set_named(const Unit *unit, Component c, const char *name, double value);

/* All outputs as CSV. */
void header(const Unit *unit);
void row(const Unit *unit, Component c, double time);

/* Event mode until nothing changes; 1: states did. */
int event(const Unit *unit, Component c);
/* A run under CVODE with all outputs. */
void cvode(const Unit *unit, double tolerance, const double *plane, double step, double stop, int count, char **word);

/* Two units at a time, couple.c. */
void couple(const Unit *one, const Unit *other, double step, double stop);
void both(const Unit *one, const Unit *other, double step, double stop);
/* derivatives.c: directional and adjoint derivatives; words: NAME=VALUE at the start. */
void check_derivatives(const Unit *unit, int count, char **word);
void control(const Unit *unit, double step, double stop);

#endif
