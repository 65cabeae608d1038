/* SPDX-License-Identifier: MIT
 *
 * Engines that interpret a World: the functions of gic_model that are the same for all of them, and what an engine
 * adds. */
#ifndef INTERPRETED_H
#define INTERPRETED_H

#include "engine.h"
#include "world.h"

/* The context of an engine's instances. */
typedef struct Interpreted {
    gic_model code; /* an engine may replace what differs */
    World *world;
    EngineProfile *profile;
    size_t own_offset; /* bytes */
    /* start: the engine's numbers at setup, where `state`, `input` and `parameter` of the instance have their initial
     * values. evaluate: World and rate[] at a state, for which the instance's inputs are loaded. Both return a status
     * and may set head.subset. What the engine remembers changes only to what is good at some configuration on the way.
     */
    int (*start)(const struct Interpreted *context, Instance *self);
    int (*evaluate)(const struct Interpreted *context, Instance *self, const double *state, double *rate);
    void *engine; /* the engine's own constants and scratch */
} Interpreted;

/* A context with descriptor for an assembled model. own: how many numbers of its own an instance has. */
Interpreted *interpreted_new(Pool *pool, const Model *model, const Sequence *sequence, size_t own);
const Engine *interpreted_engine(Pool *pool, const char *name, const Interpreted *context);
double *instance_own(const Instance *self);

/* For `evaluate`. orient: Euler parameters of the base with the dependent one recovered; 1, 0, 0, 0 of a fixed base. */
int interpreted_orient(const Instance *self, const double *state, double e[4]);
/* x, xd and, of driven coordinates, xdd from state and inputs. */
void interpreted_gather(const Interpreted *context, const double *state);
/* Base of the World from the state. */
void interpreted_place_base(const Interpreted *context, const double *state, const double e[4]);
/* Forces and accelerations at the World's configuration, for which J, dual and vectors of all ties are there; then
 * rate[]. Rows A to C of the profile. */
int interpreted_accelerate(const Interpreted *context, const double *state, const double e[4], double *rate);

#endif
