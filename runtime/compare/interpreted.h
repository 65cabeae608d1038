/* SPDX-License-Identifier: MIT
 *
 * Engines that interpret a World: the functions of gic_model that are the same for all of them, and what an engine
 * adds. */
#ifndef COMPARE_INTERPRETED_H
#define COMPARE_INTERPRETED_H

#include "compare/contact_pieces.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "world/world.h"

/* The context of an engine's instances. */
typedef struct Interpreted {
    gic_model code; /* an engine may replace what differs */
    World *world;
    EngineProfile *profile;
    ContactPieces *pieces; /* sees all evaluations */
    int standard_count;    /* numbers in a state of FORMAT.md section 10, without fast states */
    size_t own_offset;     /* bytes; before it the tunable parameters as set-up was given them */
    size_t setup_offset;
    struct Geometry *geometry; /* NULL: no parameter acts on points, axes, masses and so on */
    /* design: find the design configuration after the World's numbers have changed, and the engine's numbers that
     * follow from it. On entry bodies are where they were drawn, or at the solution for similar numbers; on return the
     * World is at the design. NULL: the engine has only the geometry of the file. */
    int (*design)(const struct Interpreted *context, Instance *self);
    /* start: the engine's numbers at setup, where `state`, `input` and `parameter` of the instance have their initial
     * values. place: bodies and coordinates of the World, with their rates, at a slow state. evaluate: World and rate[]
     * of a slow state. For both the instance's inputs are loaded, for evaluate fast states too. All return a status and
     * may set head.subset. The engine stores only starts that are good at some configuration on the way. */
    int (*start)(const struct Interpreted *context, Instance *self);
    int (*place)(const struct Interpreted *context, Instance *self, const double *state);
    int (*evaluate)(const struct Interpreted *context, Instance *self, const double *state, double *rate);
    void *engine; /* the engine's own constants and scratch */
} Interpreted;

/* A context with descriptor for an assembled model. own: how many numbers of its own an instance has. */
Interpreted *interpreted_new(Pool *pool, const Model *model, const Sequence *sequence, size_t own);
Engine *interpreted_engine(Pool *pool, const char *name, const Interpreted *context);
/* State and rate of FORMAT.md section 10 from the World, without the fast states, which follow there; e of the base is
 * its p. */
void interpreted_standard(const Interpreted *context, double *standard, double *rate);
double *instance_own(const Instance *self);
/* For functions of gic_model. load: World's time, inputs and what else it starts from, after a look at whether all
 * numbers are finite, and the geometry of the instance's parameters. refresh: the right-hand side at the present state,
 * with the inputs of the present time. Both return a status. */
int interpreted_load(Instance *self, double time);
int interpreted_refresh(Instance *self);

/* For `evaluate`. orient: Euler parameters of the base with the dependent one recovered; 1, 0, 0, 0 of a fixed base. */
int interpreted_orient(const Instance *self, const double *state, double e[4]);
/* x, xd and, of driven coordinates, xdd from state and inputs. */
void interpreted_gather(const Interpreted *context, const double *state);
/* Base of the World from the state. */
void interpreted_place_base(const Interpreted *context, const double *state, const double e[4]);
/* Forces and accelerations at the World's configuration, for which J, dual and vectors of all ties are there; then
 * rate[]. Rows A to C of the profile. */
int interpreted_accelerate(const Interpreted *context, Instance *self, const double *state, double *rate);
/* After world_accelerate(): a status about masses names the subset, and no number of the state. */
void interpreted_name_lost(const Interpreted *context, Instance *self, int status);

/* ---- interpreted_fast.c ---------------------------------------------------------------------------------- */

/* Functions of gic_model for models with wheels that have tires. A row of links: WheelMotion of each of them, then
 * value and rate of each coordinate, which formulas may use. */
int interpreted_link_count(const Model *model);
int interpreted_link(void *instance, double time, const double *slow, double *link);
int interpreted_fast(void *instance, double time, const double *link, const double *fast, double *rate);
int interpreted_roll(void *instance);

/* ---- geometry.c ------------------------------------------------------------------------------------------ */

/* NULL where no tunable parameter is geometric. */
struct Geometry *geometry_new(Pool *pool, const Model *model);
/* The World's numbers and the engine's design for these values of the tunable parameters. GIC_ERROR_GEOMETRY, with
 * head.condition, where they are impossible. */
int geometry_adopt(const Interpreted *context, Instance *self, const double *parameter);
/* True if the World was built for these values. */
bool geometry_adopted(const Interpreted *context, const double *parameter);

#endif
