/* SPDX-License-Identifier: MIT
 *
 * Engines: the ways in which a host program can compute the same model. Each presents itself as the descriptor of
 * gic_runtime.h, so that scenes, fixed steps, outputs and evaluation of states know no difference. */
#ifndef ENGINE_H
#define ENGINE_H

#include "../generator/narrow.h"
#include "gic_batch.h"

#include <time.h>

/* The time of a clock, s. */
double clock_seconds(clockid_t clock);
/* CPU time of this process and of those it has waited for, s. */
double cpu_seconds(void);

/* Where the time goes, s, in the rows of Serban and Haug 2000, Table 3 (row letters in parentheses), and counts. An
 * engine looks at the clock only while `on`; whoever sets it clears the rest. Generated code fills nothing. */
typedef struct EngineProfile {
    bool on;
    double look;                   /* s, what a look at the clock costs: taken off all that follows */
    int64_t looks;                 /* at the clock */
    double acceleration;           /* (A) all of the acceleration analysis */
    double acceleration_functions; /* (B) forces, masses, right-hand sides */
    double acceleration_solver;    /* (C) linear solver */
    double recovery;               /* (D) all of the recovery of dependent coordinates and velocities */
    double recovery_functions;     /* (E) constraints and their derivatives */
    double recovery_solver;        /* (F) factorizations and solutions */
    int64_t evaluations, newton, factorizations, repartitions;
} EngineProfile;

/* The time, s; 0 while the profile is off. */
double profile_clock(EngineProfile *profile);

/* auto.c: code that is being compiled while another runs. */
typedef struct Background Background;

typedef struct Engine {
    const char *name;
    const gic_model *code;
    const void *context;    /* interpreted: what every instance points to; NULL: generated code */
    EngineProfile *profile; /* NULL: generated code */
    /* The state of FORMAT.md section 10, fast states last, in which people and scenes speak; most engines integrate
     * just that. */
    const gic_signal *standard;
    int standard_count;
    /* From it to the engine's own state, and back, with rates, after a right-hand side at the instance's state, slow
     * states only: fast ones are the same everywhere. NULL: it is the state. */
    int (*enter)(gic_head *self, const double *standard);
    void (*leave)(const gic_head *self, double *standard, double *rate);
    const Facts *facts;     /* that the code rests on; NULL: none */
    Background *background; /* NULL: `code` is all there will be */
    double compiling;       /* s of CPU time that a compiler took to make the code; 0: none had to */
    size_t bytes;           /* of memory that the code and its constants take; 0: interpreted, or not known */
    void *memory;           /* what `close` gives back */
    void (*close)(const struct Engine *engine); /* NULL: it has nothing but memory of the pool */
} Engine;

/* The engines' names, ended by NULL; the first is the default. */
extern const char *const engine_name[];
bool engine_known(const char *name);

/* Does it run generated code? The others interpret the model. */
bool engine_generates(const char *name);

/* The Debian packages without which it can't be opened here; NULL: nothing is missing. */
const char *engine_missing(Pool *pool, const char *name);

/* For those engines that generate or compile. */
typedef struct EngineOptions {
    Solve solve;
    Recovery recovery;
    int lanes;            /* of vectors at most, of the engine cc; 0: numbers one by one */
    const char *compiler; /* command, perhaps with options */
    const char *flags;    /* more options, behind ours */
    const char *object;   /* path where a compiled object is left too; NULL: nowhere */
    bool single;          /* the flags make the code single precision; its numbers are the caller's business */
    const Facts *facts;   /* generated code for one scene; NULL: for all. Interpreted engines know no facts */
    const struct Validation *validation; /* with facts: states of that scene, generator/validate.h; NULL: none */
    bool quiet;                          /* no notes */
} EngineOptions;

/* Open an engine, one of engine_name, for a model. Every failure ends in diag_fail. */
const Engine *engine_open(Pool *pool, const char *name, const Model *model, const EngineOptions *options);

/* Every instance of an interpreted engine begins so, with the descriptor's arrays and then the engine's own behind it.
 */
typedef struct Instance {
    gic_head head;
    const void *context;
} Instance;

/* descriptor.c: the descriptor of an interpreted model but for its functions, from an assembled model; and room for
 * `count` more numbers in its instances: their offset, bytes. */
gic_model descriptor_new(Pool *pool, const Model *model, const Sequence *sequence);
size_t descriptor_place(gic_model *code, size_t count);
/* Names and units of a model's fast states, [fast_states]: TIRES.md section 2. */
const gic_signal *descriptor_fast_states(Pool *pool, const Model *model);

/* Memory for one instance, not set up. It may be copied byte by byte. Instances of one interpreted engine share
 * scratch: one call at a time. */
gic_head *instance_new(Pool *pool, const Engine *engine);
/* Put a set-up instance into a state of FORMAT.md section 10; its inputs, ports and road are there. Returns a status.
 */
int engine_enter(const Engine *engine, gic_head *self, const double *standard);
/* The present state as in FORMAT.md section 10, and its rate, by one right-hand side; rate may be NULL. Returns a
 * status. */
int engine_look(const Engine *engine, gic_head *self, double *standard, double *rate);
/* Give back what doesn't come from the pool. */
void engine_close(const Engine *engine);
/* "status text", "status text: subset 'name'", or which state grew, of the last call. */
const char *instance_status(Pool *pool, const gic_model *model, const gic_head *self, int status);
/* An array of the instance at one of the descriptor's offsets. */
double *instance_array(gic_head *self, size_t offset);

/* ---- compiler.c: the user's C compiler -------------------------------------------------------------------- */

/* The command where none is given: $CC or cc. */
const char *compiler_default(void);
/* Our options of the compiler, behind the command's and before the user's. */
extern const char build_flags[];
/* Words of command, our options and the user's; blanks separate them. */
const char **compiler_words(Pool *pool, const char *compiler, const char *flags, int *count);
/* What decides what a command makes, other than its words and what it reads: the programs and files that the words name
 * (path, inode, size, time of change), the environment, and the processor, for -march=native means it. */
const char *compiler_identity(Pool *pool, const char *const *words, int count);

/* ---- one function for each engine that is not in a file of its own name ---------------------------------- */

/* build.c: generated code, compiled, or kept from an earlier run, and loaded. */
const Engine *engine_cc(Pool *pool, const Model *model, const EngineOptions *options);
/* The same for `batch->vehicles` at once, and their descriptor; flags: of the compiler, behind build_flags. NULL: can't
 * be had, *why. */
const Engine *engine_batch(Pool *pool, const Model *model, const EngineOptions *options, const Batch *batch,
                           const char *flags, const gic_batch_model **many, const char **why);
/* A folder with the files in it, but for those that begin with a dot. */
void folder_remove(Pool *pool, const char *folder);
/* auto.c: the engine `tcc`, and while it runs the compiler for faster code. */
const Engine *engine_auto(Pool *pool, const Model *model, const EngineOptions *options);
/* Between two steps: faster code to go on with, which gives the same bits from the state of `present` on, or NULL: not
 * yet, or never. The first call sets the compiler to work, so it is for runs that last. */
const gic_model *engine_faster(const Engine *engine, const gic_head *present);
/* How that went, for people; NULL: not begun, or not finished. */
const char *engine_remark(const Engine *engine);
/* No more steps: what was begun for engine_faster ends. */
void engine_rest(const Engine *engine);
/* jit.c: generated code, compiled into memory; where the system refuses to execute that, the engine `tape`. */
const Engine *engine_tcc(Pool *pool, const Model *model, const EngineOptions *options);
/* engine_gic.c: the method of Serban and Haug 2000, interpreted. */
const Engine *engine_gic(Pool *pool, const Model *model, const EngineOptions *options);
/* engine_gcp.c: generalized coordinate partitioning, with the topology-based solver and with MUMPS. */
const Engine *engine_gcp1(Pool *pool, const Model *model, const EngineOptions *options);
const Engine *engine_gcp2(Pool *pool, const Model *model, const EngineOptions *options);
/* tape_engine.c: the expression graph of the generated code, interpreted. */
const Engine *engine_tape(Pool *pool, const Model *model, const EngineOptions *options);

#endif
