/* SPDX-License-Identifier: MIT
 *
 * contact_pieces: steps of interpreted engines that go over no beginning and no end of a contact. Generated code has
 * run/contact_watch.h and gic_model.contacts for that; nothing here comes from there, on purpose, so that one judges
 * the other: a step is made as if there were no contacts, and made again, in halves of halves, where any of its
 * evaluations has seen another set of contacts than its start. */
#ifndef COMPARE_CONTACT_PIECES_H
#define COMPARE_CONTACT_PIECES_H

#include "base/pool.h"
#include "gic_runtime.h"
#include "world/world.h"

typedef struct ContactPieces ContactPieces;

/* How the caller integrates. `whole` makes a step as it would be without contacts; `piece` goes exactly to the time
 * `end` (s), which is within that step; both leave inputs as they belong to the instance's time, and return a status.
 * `restart`: what has been integrated so far is no past of what follows, or the instance has been put back. */
typedef struct ContactWays {
    int (*whole)(void *caller, gic_head *self);
    int (*piece)(void *caller, gic_head *self, double end);
    void (*restart)(void *caller);
    void *caller;
} ContactWays;

/* For a World whose evaluations are noted. */
ContactPieces *contact_pieces_new(Pool *pool, const World *world);
/* An evaluation has filled World.touch: all of it, or of wheels alone. */
void contact_pieces_note(ContactPieces *pieces, bool wheels_alone);
/* A step of the engine whose right-hand side is code->rhs. Contacts made or lost are counted in head.contact_count.
 * Returns a status; GIC_ERROR_EVENTS: contacts change more often than 32 times each. On a failure the instance is as
 * before but for counts. */
int contact_pieces_step(ContactPieces *pieces, const gic_model *code, gic_head *self, const ContactWays *ways);

#endif
