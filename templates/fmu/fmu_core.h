/* SPDX-License-Identifier: MIT
 *
 * fmu_core: one instance of the model as an importer sees it, whichever version of FMI it speaks: variables by value
 * reference, initialization, fixed steps, model exchange, copies of the state. fmu_model.h, which gicgen writes, names
 * the model. C99, no library but libm. */
#ifndef FMU_CORE_H
#define FMU_CORE_H

#include "fmu_model.h"

#include <stddef.h>
#include <stdint.h>

/* A value reference is a kind and an index: kind * FMU_KIND + index. Indices are those of the model's arrays. */
#define FMU_KIND 0x100000u
enum {
    FMU_TIME = 0,
    FMU_STATE = 1,
    FMU_DERIVATIVE = 2,
    FMU_INPUT = 3,
    FMU_OUTPUT = 4,
    FMU_PARAMETER = 5,
    FMU_PORT = 6,
    FMU_SOLVER = 7,   /* step; method, ratio, keep_jacobian, spread_jacobian, locate, most_work */
    FMU_DISCRETE = 8, /* whole numbers */
    FMU_INDICATOR = 9,
    FMU_ROAD = 10, /* FMU_PLANE numbers a wheel */
    FMU_PLACE = 11 /* x and y of each wheel's centre */
};
enum { FMU_HEIGHT, FMU_NORMAL_X, FMU_NORMAL_Y, FMU_NORMAL_Z, FMU_FRICTION, FMU_PLANE };
enum {
    FMU_SOLVER_STEP,
    FMU_SOLVER_METHOD,
    FMU_SOLVER_RATIO,
    FMU_SOLVER_KEEP,
    FMU_SOLVER_SPREAD,
    FMU_SOLVER_LOCATE,
    FMU_SOLVER_MOST
};

/* Modes; masks of several say where a call is legal. */
enum {
    FMU_INSTANTIATED = 1,
    FMU_INITIALIZATION = 2,
    FMU_EVENT = 4,
    FMU_CONTINUOUS = 8,
    FMU_STEP = 16,   /* co-simulation, between steps */
    FMU_FAILED = 32, /* co-simulation, after a step that failed */
    FMU_TERMINATED = 64
};

/* What a call ends with. */
typedef enum fmu_result { FMU_OK, FMU_WARNING, FMU_DISCARD, FMU_ERROR } fmu_result;

/* The road under the wheels, planes that the importer gives: through the given height under a wheel's centre, with the
 * given normal. Under any other place the plane of the wheel that is nearest to it holds. */
typedef struct fmu_ground {
    gic_road head;
    gic_real plane[FMU_WHEELS_ROOM][FMU_PLANE];
    gic_real place[FMU_WHEELS_ROOM][2]; /* of wheels' centres, m, at `time` */
    gic_real velocity[2];               /* of the vehicle then: within a communication step the wheels move on so */
    gic_real time;
    int32_t given; /* did the importer give anything? Else the road is flat, and nobody asks */
} fmu_ground;

/* All that a copy of an instance's state has to have. The only pointers are those in heads and in `ground`, which are
 * set anew in the copy. */
typedef struct fmu_data {
    FMU_TYPE self, shown;            /* shown: a copy on which outputs are computed, so that looking leaves no trace */
    gic_real start[FMU_STATES_ROOM]; /* values that states begin with, where set[] */
    /* inputs, then ports, at `point`, and their time derivatives in co-simulation */
    gic_real held[FMU_INPUTS_ROOM + FMU_PORTS_ROOM], slope[FMU_INPUTS_ROOM + FMU_PORTS_ROOM][2];
    fmu_ground ground;
    gic_real place[FMU_WHEELS_ROOM][2]; /* of wheels' centres at the present state, where located */
    gic_real parameter[FMU_PARAMETERS_ROOM];
    gic_real rate[FMU_STATES_ROOM];
    gic_real point; /* s, time that held[] is for */
    gic_real start_time, stop_time, step;
    int32_t gear, method, ratio, keep, spread, locate, most;
    int32_t mode, exchange;       /* exchange: model exchange, else co-simulation */
    int32_t stops;                /* is there a stop_time? */
    int32_t ready;                /* self is set up with the present start values */
    int32_t rated, seen, located; /* rate[], shown and place[] are those of the present state */
    int32_t moving;               /* within a communication step: the road stays as it was at its start */
    unsigned char set[FMU_STATES_ROOM];
} fmu_data;

typedef struct fmu_instance fmu_instance;

/* How the layer of a version passes a message on. */
typedef void fmu_log(fmu_instance *instance, fmu_result result, const char *category, const char *text);

/* After each step within a communication step but the last: 1 to end it there. */
typedef int fmu_between(fmu_instance *instance);

struct fmu_instance {
    fmu_data data;
#if FMU_DERIVATIVES
    FMU_DIRECTION along; /* work space of fmu_derivative.c */
    fmu_data kept;
#endif
    fmu_log *log;
    fmu_between *between; /* NULL: nobody looks */
};

/* Bring an instance to FMU_INSTANTIATED with start values of modelDescription.xml; callbacks stay. */
void fmu_reset(fmu_instance *instance);
/* Say something and return `result`. */
fmu_result fmu_say(fmu_instance *instance, fmu_result result, const char *format, ...);
/* FMU_OK where the present mode is among `modes`; else an error that names the call. */
fmu_result fmu_legal(fmu_instance *instance, const char *call, int32_t modes);

fmu_result fmu_get_real(fmu_instance *instance, uint32_t reference, double *value);
fmu_result fmu_set_real(fmu_instance *instance, uint32_t reference, double value);
fmu_result fmu_get_integer(fmu_instance *instance, uint32_t reference, int32_t *value);
fmu_result fmu_set_integer(fmu_instance *instance, uint32_t reference, int32_t value);
/* A derivative of an input for the next communication step: order 1 or 2. */
fmu_result fmu_set_slope(fmu_instance *instance, uint32_t reference, int32_t order, double value);

fmu_result fmu_experiment(fmu_instance *instance, double start, int stops, double stop);
/* Initial state from start values. */
fmu_result fmu_initialize(fmu_instance *instance);

/* Why there is no model exchange; NULL: there is. */
const char *fmu_no_exchange(void);
/* Model exchange. */
fmu_result fmu_set_time(fmu_instance *instance, double time);
fmu_result fmu_set_states(fmu_instance *instance, const double *x, size_t count);
fmu_result fmu_get_states(fmu_instance *instance, double *x, size_t count);
fmu_result fmu_get_rates(fmu_instance *instance, double *rate, size_t count);
fmu_result fmu_get_nominals(fmu_instance *instance, double *x, size_t count);
/* FMU_INDICATORS numbers: of a powertrain 1, or -1 where the gear would change in the present state; then those of
 * contacts, positive where there is a load. */
fmu_result fmu_get_indicators(fmu_instance *instance, double *value, size_t count);
/* The same after an integrator step, for importers that don't look for indicators: 1 where it would. */
int fmu_event_due(fmu_instance *instance);
/* Change it where it is due; 1 where states changed with it. */
int fmu_event(fmu_instance *instance);

/* fmu_road.c. Flat, not given. */
void fmu_ground_reset(fmu_ground *ground);
/* The road for a head, NULL: none is given. */
const gic_road *fmu_ground_adopt(fmu_ground *ground);
/* Places of wheels' centres at the state of `work`, a copy, for this moves Newton's starts. Returns a status. */
int fmu_places(FMU_TYPE *work, gic_real place[FMU_WHEELS_ROOM][2]);
/* Planes hold under these places, at the time and state of `at`. */
void fmu_ground_stand(fmu_ground *ground, const FMU_TYPE *at, gic_real place[FMU_WHEELS_ROOM][2]);
/* Heights become those under these places. */
void fmu_ground_move(fmu_ground *ground, gic_real place[FMU_WHEELS_ROOM][2]);

/* From `point` on by `length`, in steps of equal length not longer than `step`. */
fmu_result fmu_do_step(fmu_instance *instance, double point, double length);
double fmu_time(const fmu_instance *instance);

#if FMU_DERIVATIVES
/* fmu_derivative.c: out [unknowns]: derivatives of unknowns (derivatives, outputs; in initialization mode also states)
 * along seeds [knowns] of knowns (states, inputs, parameters). Everything else stays as it was. */
fmu_result fmu_directional(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                           size_t knowns, const double *seed, double *out);
/* out [knowns]: the sums of seeds [unknowns] times the derivatives of unknowns by each known. */
fmu_result fmu_adjoint(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                       size_t knowns, const double *seed, double *out);
#endif

/* Copies: as bytes without addresses. `size` is that of fmu_data; a copy of another model or version is refused. */
size_t fmu_copy_size(void);
void fmu_copy_out(const fmu_instance *instance, char *bytes);
fmu_result fmu_copy_check(fmu_instance *instance, const char *bytes, size_t size);
fmu_result fmu_copy_in(fmu_instance *instance, const char *bytes, size_t size);

#endif
