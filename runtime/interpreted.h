/* SPDX-License-Identifier: MIT
 *
 * Interpreted engines as descriptors: the instance, the functions of gic_model that are the same for all of them, and
 * what an engine adds. */
#ifndef INTERPRETED_H
#define INTERPRETED_H

#include "world.h"

typedef struct Instance {
    gic_head head;
    const struct Interpreted *context;
    /* behind it: the descriptor's arrays, then `own` numbers of the engine */
} Instance;

/* The context of an engine's instances. */
typedef struct Interpreted {
    gic_model code; /* an engine may replace what differs */
    World *world;
    EngineProfile profile;
    size_t own_offset; /* bytes */
    /* start: `own` after setup, the instance's state, inputs and parameters being at their defaults. evaluate: the
     * World at a state (poses, twists, forces, accelerations, x, xd, xdd) and rate[] of the state; both return a status
     * and may set head.subset. On another status than GIC_OK what the engine remembers is what it was before, or a step
     * on the way to the new state. The World is loaded with the instance's inputs. */
    int (*start)(const struct Interpreted *context, Instance *self);
    int (*evaluate)(const struct Interpreted *context, Instance *self, double time, const double *state, double *rate);
    void *engine; /* the engine's own constants and scratch */
} Interpreted;

/* A context with descriptor for an assembled model; `own`: how many numbers of its own an instance has. */
Interpreted *interpreted_new(Pool *pool, const Model *model, const Sequence *sequence, size_t own);
const Engine *interpreted_engine(Pool *pool, const char *name, Interpreted *context);
double *instance_own(Instance *self);

/* For `evaluate`: Euler parameters of the base with the dependent one recovered; 1, 0, 0, 0 of a fixed base. */
int interpreted_orient(const Instance *self, const double *state, double e[4]);
/* x and xd of all coordinates (and xdd of driven ones) from state and inputs. */
void interpreted_gather(const Interpreted *context, const double *state);
/* Forces, equations and accelerations at the World's configuration, J and vectors of all ties being there; then rate[].
 * Fills rows A to C of the profile. */
int interpreted_accelerate(const Interpreted *context, const double *state, const double e[4], double *rate);

/* s, CPU-independent; 0 while the profile is off. */
double profile_clock(const EngineProfile *profile);

#endif
