/* SPDX-License-Identifier: MIT
 *
 * gic_gradient: derivatives of a scalar of a whole run in constant steps of AB3 or RK4, forwards along one direction or
 * backwards by everything at once, for models with code of gicgen --derivatives. Without allocation, as gic_runtime:
 * the caller owns the memory, and says how many checkpoints it has. */
#ifndef GIC_GRADIENT_H
#define GIC_GRADIENT_H

#include "gic_runtime.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The scalar is a sum of what this returns. It is called at the state before each step, number 0, 1, ..., and at the
 * end of the run, number `steps`; backwards in falling order. self: the instance with this state and time, its inputs
 * and, with gic_gradient.looks, its outputs. Add to by_state[] and by_output[] (NULL without looks), which are 0, how
 * the returned number changes with each of them. */
typedef gic_real gic_weigh_function(void *user, int64_t number, const void *self, gic_real *by_state,
                                    gic_real *by_output);

/* Of inputs that an input function gives, at the time of an evaluation. Forwards: add to input[] how inputs change
 * along the direction. Backwards: input[] has the derivatives of the scalar by them, to be added to those by what they
 * follow from. */
typedef void gic_follow_function(void *user, gic_real time, gic_real *input);

typedef struct gic_gradient {
    /* the caller sets: */
    const gic_derivatives *code;
    const void *start; /* instance from which the run begins, with a new history; it is not changed. Its input
                        * function, if any, must give the same inputs whenever it is asked for the same time */
    gic_real step;     /* s */
    int32_t method;    /* GIC_AB3 or GIC_RK4 */
    int32_t looks;     /* 1: the scalar has outputs in it */
    int64_t steps;     /* 1 or more */
    gic_weigh_function *weigh;
    gic_follow_function *follow; /* NULL: inputs change by the direction's alone */
    void *user;
    int64_t checkpoints; /* backwards: instances that are kept, 1 or more; with `steps` of them no step is repeated,
                          * with fewer the least possible number of steps */
    void *memory;        /* aligned as double is; free before and after */
    size_t size;         /* of it, bytes */
    /* results: */
    size_t needed;  /* bytes of memory that this run needs, whatever the status */
    int64_t made;   /* steps that were made, repeated ones among them */
    gic_real value; /* the scalar */
} gic_gradient;

/* `along` is a direction of the model, NAME_direction.
 *
 * Forwards: the caller sets how initial state, inputs (of the whole run), parameters and ports change. *slope: the
 * derivative of the scalar. along->state is then the derivative of the state at the end.
 *
 * Backwards: along->state, input, parameter and port become the derivatives of the scalar by initial state, inputs (of
 * the whole run), parameters and ports. The dependent Euler parameter of the start follows from the others, and has 0.
 *
 * They are derivatives of the steps as gic_step makes them, exact but for rounding. GIC_ERROR_ARGUMENT: memory is too
 * small (`needed` says how large it must be), or method, step or numbers are out of range, or the run has contacts
 * located (head.locate) or controllers, of which it knows no derivatives; GIC_ERROR_EVENTS: a gear changes; else as
 * gic_step and the model's functions. Without GIC_OK there is no result but `needed`. */
#define gic_run_tangent GIC_NAME(gic_run_tangent)
int gic_run_tangent(gic_gradient *run, void *along, gic_real *slope);
#define gic_run_adjoint GIC_NAME(gic_run_adjoint)
int gic_run_adjoint(gic_gradient *run, void *along);

/* Of `left` steps before which the instance is kept, with `free` more instances to be kept: after how many the next one
 * is, so that the fewest steps are repeated. left: 2 or more, free: 1 or more. */
#define gic_next_checkpoint GIC_NAME(gic_next_checkpoint)
int64_t gic_next_checkpoint(int64_t left, int64_t free);

#ifdef __cplusplus
}
#endif
#endif
