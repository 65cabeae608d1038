/* SPDX-License-Identifier: MIT
 *
 * What the files of this folder share. */
#ifndef FMU_FMU_PRIVATE_H
#define FMU_FMU_PRIVATE_H

#include "base/text.h"
#include "fmu/fmu.h"
#include "host/archive.h"
#include "model/model.h"

/* ---- variables.c */

/* Kinds of value references, as fmu_core.h has them. */
enum {
    KIND_TIME,
    KIND_STATE,
    KIND_DERIVATIVE,
    KIND_INPUT,
    KIND_OUTPUT,
    KIND_PARAMETER,
    KIND_PORT,
    KIND_SOLVER,
    KIND_DISCRETE,
    KIND_INDICATOR,
    KIND_ROAD,
    KIND_PLACE
};
enum { KIND_SIZE = 0x100000 };

typedef enum VariableType { TYPE_REAL, TYPE_WHOLE, TYPE_METHOD } VariableType; /* TYPE_METHOD: an enumeration */

typedef struct Variable {
    const char *name, *description, *unit; /* unit NULL: a whole number */
    const char *causality, *variability;   /* as in modelDescription.xml */
    const char *initial;                   /* NULL: follows from the two */
    int kind, index;                       /* of the value reference */
    VariableType type;
    bool starts, reinit;                /* has a start value; is a state that events set */
    bool given;                         /* a state that the scene gives a value to start with */
    double start, nominal, least, most; /* nominal 0: none; least, most: NAN: none */
    int of;                             /* index among the variables of the state that it is the derivative of; -1 */
    const char *terminal;               /* the wheel, port or powertrain that it belongs to; NULL: none */
} Variable;

typedef struct Variables {
    int count;
    Variable *variable;
    int first[KIND_PLACE + 1]; /* index of the first of each kind */
} Variables;

/* The simulation that an FMU starts with. */
typedef struct Experiment {
    double step, stop;               /* s */
    int method, ratio, keep, spread; /* method: gic_method; of implicit ones: steps with one Jacobian; 1: by shares */
    int locate, most_work;           /* gic_head.locate, .most */
    double steady;
} Experiment;

Experiment experiment_of(const Scene *scene);
const Variables *variables_make(Pool *pool, const Formulation *f, const Scene *scene, bool implicit, bool shares);
/* The value reference. */
unsigned variable_reference(const Variable *variable);
bool is_output(const Variable *variable);
/* An output, state or derivative that initialization computes. */
bool is_initial_unknown(const Variable *variable);
int event_indicators(const Variables *all);

/* ---- dependencies.c */

/* What an unknown depends on in continuous time: states, inputs, ports, by index. */
typedef struct Dependence {
    bool everything, time, road;
    bool *state, *input, *port;
} Dependence;

const Dependence *dependences_of_rates(Pool *pool, const Formulation *f);
/* Of the places of wheels' centres. */
const Dependence *dependences_of_places(Pool *pool, const Formulation *f);
const Dependence *dependences_of_outputs(Pool *pool, const Formulation *f, const Dependence *rate);
bool depends(const Dependence *unknown, const Variable *known);

/* ---- unit.c: exponents of SI base units */

enum { UNIT_KG, UNIT_M, UNIT_S, UNIT_A, UNIT_K, UNIT_MOL, UNIT_CD, UNIT_RAD, UNIT_BASES };
extern const char *const unit_base_name[UNIT_BASES];

/* Of "N m/rad" and the like; false: not a unit that we know. factor: what one of it is in base units. */
bool unit_parse(const char *unit, int exponent[UNIT_BASES], double *factor);

/* ---- describe.c, describe_2.c, describe_3.c: XML */

typedef struct Description {
    Pool *pool;
    const Formulation *f;
    const Variables *variables;
    Experiment experiment;
    const char *token;
    const char *const *source; /* names of the C files, NULL at the end */
    const Dependence *rate, *out, *place;
    bool derivatives;    /* directional ones are provided */
    int32_t last_method; /* the last gic_method that solver.method may be */
} Description;

/* ` name="text"`, escaped. */
void xml_attribute(Text *out, const char *name, const char *text);
void xml_number(Text *out, const char *name, double value);
void xml_whole(Text *out, const char *name, long value);

/* Elements that both versions have; and the attribute of an output or a derivative, none where it depends on
 * everything: indices of variables from 1, or value references. */
void describe_dependencies(Text *out, const Description *d, const Variable *unknown, bool references);
void describe_units(Text *out, const Variables *all);
/* Items of the enumeration of solver.method. */
void describe_methods(Text *out, int indent, int32_t last);
void describe_log(Text *out);
void describe_experiment(Text *out, const Experiment *experiment);

void describe_2(Text *out, const Description *d);
void describe_3(Text *out, const Description *d);
/* buildDescription.xml and terminalsAndIcons.xml of FMI 3.0. icon: height of the icon relative to its width; 0: there
 * is no icon. */
void describe_build(Text *out, const Description *d);
void describe_terminals(Text *out, const Variables *all, double icon);

/* ---- sources.c: what the C layer of an FMU includes */

/* fmu_model.h and gic_runtime.h. `templates`: folder of the templates, NULL: built in. */
void write_model_header(Text *out, const char *templates, const Description *d);
void write_runtime_header(Text *out, const char *templates, const Description *d, const Text *runtime);

/* ---- binaries.c */

/* Compile the C files of `sources` for each platform that there is a compiler for and add the results. folder: an empty
 * one. Returns a failure of the compiler for this machine, NULL: none; says what there is on stderr. */
const char *binaries_add(Members *members, int version, const char *model, const char *folder, const char *path);

#endif
