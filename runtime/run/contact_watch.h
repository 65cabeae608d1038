/* SPDX-License-Identifier: MIT
 *
 * contact_watch: sees the beginnings and ends of contacts within variable steps, by the numbers of
 * gic_model.contacts, and says how long the next step towards one may be. */
#ifndef RUN_CONTACT_WATCH_H
#define RUN_CONTACT_WATCH_H

#include "gic_runtime.h"

#include <stdbool.h>

typedef struct ContactWatch ContactWatch;

/* NULL: no memory. */
ContactWatch *contact_watch_new(void);
void contact_watch_free(ContactWatch *watch);

/* A step begins at `self`, and nothing is known of the one before: find on which side each contact is. A number that
 * is 0 but for rounding is where its slope leads. Contacts on the other side than at the last start are counted in
 * contact_count, unless all has been forgotten since. Returns a status. */
void contact_watch_forget(ContactWatch *watch);
int contact_watch_start(ContactWatch *watch, const gic_model *model, gic_head *self);

/* A try of a step begins, or one at `state` and `time` evaluated its right-hand side. Returns a status. */
void contact_watch_try(ContactWatch *watch);
int contact_watch_look(ContactWatch *watch, const gic_model *model, gic_head *self, double time, const double *state);

/* What a step has met. */
typedef enum ContactFinding {
    CONTACTS_KEPT,    /* all contacts are as at its start, all the way */
    CONTACTS_REACHED, /* and one is at its beginning or end now, to rounding */
    CONTACTS_TURN,    /* a contact comes near to its beginning or end within the step: too long to tell */
    CONTACTS_CHANGE,  /* one has changed, be it for one evaluation alone */
} ContactFinding;

/* A step of `length` s: the state where it began; rates there and at its end. */
typedef struct ContactStep {
    double length;
    const double *from, *rate, *rate_there;
} ContactStep;

/* The step has ended at `self`. Returns a status. */
int contact_watch_end(ContactWatch *watch, const gic_model *model, gic_head *self, const ContactStep *step,
                      ContactFinding *finding);
/* The contact of the last finding but CONTACTS_KEPT; -1: none. */
int contact_watch_changed(const ContactWatch *watch);
/* Where in the step what it has met is at the earliest and the latest, s after its start. */
void contact_watch_place(const ContactWatch *watch, double *low, double *high);
/* The step is accepted: the next one begins where it has ended. */
void contact_watch_keep(ContactWatch *watch, double length);

/* The time (s) from the start of the step to the first change, by values, slopes and what these changed by in the step
 * before; INFINITY: none comes nearer. */
double contact_watch_ahead(const ContactWatch *watch);

#endif
