/* SPDX-License-Identifier: MIT
 *
 * Engines: the ways in which host programs compute a model. All have the descriptor of gic_runtime.h, so that
 * scenes, fixed steps, outputs and evaluation of states are the same for all. */
#ifndef ENGINE_ENGINE_H
#define ENGINE_ENGINE_H

#include "base/pool.h"
#include "gic_runtime.h"
#include "subset/method.h"

#include <stdbool.h>
#include <time.h>

typedef struct Text Text; /* base/text.h */
typedef struct gic_batch_model gic_batch_model;
typedef struct Model Model;                 /* model/model.h */
typedef struct Sequence Sequence;           /* sequence/sequence.h */
typedef struct Facts Facts;                 /* vehicle/vehicle.h */
typedef struct Embedded Embedded;           /* emit/emit.h */
typedef struct Batch Batch;                 /* emit/emit.h */
typedef struct Splitting Splitting;         /* emit/emit.h */
typedef struct CodeMemory CodeMemory;       /* report/report.h */
typedef struct ContactPieces ContactPieces; /* compare/contact_pieces.h */

/* The time of a clock, s. */
double clock_seconds(clockid_t clock);
/* CPU time of this process and of those it has waited for, s. */
double cpu_seconds(void);

/* Where the time goes, s, in the rows of Serban and Haug 2000, Table 3 (row letters in parentheses), and counts. An
 * engine looks at the clock only while `on`; whoever sets it clears the rest. Generated code fills nothing. */
typedef struct EngineProfile {
    bool on;
    double look;                   /* s, time of one look at the clock, which is subtracted */
    int64_t looks;                 /* number of looks at the clock */
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

/* run/engine_auto.c: code that is being compiled while another runs. */
typedef struct Background Background;

typedef struct Engine {
    const char *name;
    const gic_model *code;
    const void *context;    /* interpreted: what every instance points to; NULL: generated code */
    EngineProfile *profile; /* NULL: generated code */
    ContactPieces *pieces;  /* with them the engine finds contacts in its steps; NULL: gic_model.contacts does */
    /* The state of FORMAT.md section 10, fast states last, in which people and scenes speak; most engines integrate
     * just that. */
    const gic_signal *standard;
    int standard_count;
    /* From it to the engine's own state, and back, with rates, after a right-hand side at the instance's state, slow
     * states only: fast ones are the same everywhere. NULL: it is the state. */
    int (*enter)(gic_head *self, const double *standard);
    void (*leave)(const gic_head *self, double *standard, double *rate);
    const Facts *facts;                         /* that the code rests on; NULL: none */
    Background *background;                     /* NULL: `code` will not be replaced */
    double compiling;                           /* s of CPU time for compiling the code; 0: not compiled now */
    size_t bytes;                               /* bytes of code and constants; 0: interpreted, or unknown */
    void *library;                              /* the loaded object, for dlclose(), which programs leave to their
                                                 * end; NULL: none */
    void *memory;                               /* freed by `close` */
    void (*close)(const struct Engine *engine); /* NULL: it has nothing but memory of the pool */
} Engine;

/* Options of engines that generate or compile code. */
typedef struct EngineOptions {
    Solve solve;
    Recovery recovery;
    int lanes;                  /* largest number of lanes of the engine cc; 0: scalar code */
    const char *compiler;       /* command, perhaps with options */
    const char *flags;          /* more options, after the default ones */
    const char *object;         /* a copy of the compiled object goes there; NULL: nowhere */
    bool implicit;              /* code that takes implicit steps too; not with facts and lanes */
    bool exponential;           /* with it: exponential steps, too */
    bool spread;                /* with it: a Jacobian may be made by shares */
    const Splitting *splitting; /* with it: which states are implicit; NULL: all */
    bool exact;                 /* with it: gic_implicit.jacobian has all derivatives of the rates, for `bdf` */
    bool single;                /* the flags make the code single precision; the caller handles its numbers */
    const Facts *facts;         /* generated code for one scene; NULL: for all. Interpreted engines know no facts */
    const struct Validation
        *validation; /* with facts: states of that scene, generator/validate/validate.h; NULL: none */
    bool quiet;      /* print no notes */
} EngineOptions;

/* Begin of every instance of an interpreted engine; the descriptor's arrays follow, then the engine's own numbers. */
typedef struct Instance {
    gic_head head;
    const void *context;
} Instance;

/* descriptor.c: the descriptor of an interpreted model, without its functions, from an assembled model; and room for
 * `count` more numbers in its instances, at the returned offset, bytes. */
gic_model descriptor_new(Pool *pool, const Model *model, const Sequence *sequence);
size_t descriptor_place(gic_model *code, size_t count);
/* Numbers of the scratch array of a model with so many states. */
size_t descriptor_scratch(const gic_model *code, size_t states);
/* Contacts of a descriptor whose contact_count is set, with room in its instances; numbers as gic_contacts.press. */
typedef int DescriptorPress(void *self, double time, const double *state, double *press);
const gic_contacts *descriptor_contacts(Pool *pool, const Model *model, gic_model *code, DescriptorPress *press);
/* The controllers, once more where `slow_count` changes. */
void descriptor_controllers(Pool *pool, const Model *model, gic_model *code);
/* Names and units of a model's fast states, [fast_states]: TIRES.md section 2. */
const gic_signal *descriptor_fast_states(Pool *pool, const Model *model);

/* Memory for one instance, not set up. It may be copied byte by byte. Instances of one interpreted engine share
 * scratch: one call at a time. */
gic_head *instance_new(Pool *pool, const Engine *engine);
/* Put a set-up instance into a state of FORMAT.md section 10; its inputs, ports and road are there. Returns a status.
 */
int engine_enter(const Engine *engine, gic_head *self, const double *standard);
/* The present state as in FORMAT.md section 10 and its rate (may be NULL), by one right-hand side. Returns a status. */
int engine_look(const Engine *engine, gic_head *self, double *standard, double *rate);
/* Free memory that is not the pool's. */
void engine_close(const Engine *engine);
/* "status text", "status text: subset 'name'", or which state grew, of the last call. */
const char *instance_status(Pool *pool, const gic_model *model, const gic_head *self, int status);
/* An array of the instance at one of the descriptor's offsets. */
double *instance_array(gic_head *self, size_t offset);

/* ---- compiler.c: the user's C compiler */

/* The default command: $CC or cc. */
const char *compiler_default(void);
/* Compiler options that the programs add, after those in the command and before the user's. */
extern const char build_flags[];
/* The words of command, our options (build_flags for code that is loaded) and the user's, split at blanks. */
const char **compiler_words(Pool *pool, const char *compiler, const char *ours, const char *flags, int *count);
/* A new folder for the compiler; NULL with errno: can't be made. */
char *folder_make(Pool *pool);
/* Write a file, or the files of the runtime core, into such a folder; false with errno: can't be written. */
bool folder_put(Pool *pool, const char *folder, const char *name, const char *bytes, size_t size);
bool folder_put_core(Pool *pool, const char *folder);
/* Remove such a folder and its files, except those whose names begin with a dot. */
void folder_remove(const char *folder);
/* True for a file of the runtime core. */
bool is_core(const Embedded *file);
/* An identification of the compiler: programs and files that the words name (path, inode, size, time of change), the
 * environment, and the processor, which -march=native depends on. */
const char *compiler_identity(Pool *pool, const char *const *words, int count);
/* The same by the contents of these files, which are equal on all nodes of a cluster. */
const char *compiler_contents(Pool *pool, const char *const *words, int count);

/* engine_cc.c: generated code, compiled or taken from the cache, and loaded. */
const Engine *engine_cc(Pool *pool, const Model *model, const EngineOptions *options);
/* Flags for vehicles in lanes: with the elementary functions of lanes; with those of libm, one by one, so that each has
 * the bits that the code for one vehicle gives. Without tires, powertrains and states of a model's own both are libm's.
 * Where sums and differences of products alternate, gcc 12 fuses them in vectors despite -ffp-contract=off.
 */
#define IN_LANES "-O3 -march=native"
#define IN_LANES_AS_ALONE IN_LANES " -DGIC_BATCH_LIBM -fno-tree-slp-vectorize"

/* The same for `batch->vehicles` at once, and their descriptor; flags: of the compiler, after build_flags. NULL: not
 * available, *why says the reason. */
const Engine *engine_batch(Pool *pool, const Model *model, const EngineOptions *options, const Batch *batch,
                           const char *flags, const gic_batch_model **many, const char **why);
/* code_memory.c: what emitted code of a model, its header called <model>.h if it has a name, takes in memory. Asks
 * the default compiler, a second or so. */
CodeMemory code_memory(Pool *pool, const char *model, const Text *c, const Text *h);

#endif
