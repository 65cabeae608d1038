/* SPDX-License-Identifier: MIT
 *
 * A journal of tapes that were played, for derivatives backwards: with the derivatives of one number by all results of
 * the tapes, those by all that they read are found at once, from the last tape to the first. */
#ifndef TAPE_JOURNAL_H
#define TAPE_JOURNAL_H

#include "base/pool.h"
#include "tape/record.h"

typedef struct TapeJournal TapeJournal;

TapeJournal *journal_new(Pool *pool);
/* A new journal in the same memory: of one evaluation. */
void journal_begin(TapeJournal *journal);
/* `count` numbers, 0, that are there up to the next journal_begin(). */
double *journal_room(TapeJournal *journal, int count);
/* Numbers for derivatives: `local`, which lives as long as the call, or where a journal is kept as long as that. */
double *journal_numbers(const TapeWorld *world, double *local, int count);
/* Play a tape like tape_play() and note it. bar: arrays in which derivatives by each number of array[] are added up,
 * which stay there up to journal_back(). Derivatives are those of the branch that is taken. */
int journal_play(TapeJournal *journal, const Tape *tape, int member, double *const *array, double *const *bar,
                 const TapeWorld *world);
/* Note that numbers were copied: `to` and `from` are their derivatives. from: NULL: to numbers that follow nothing. */
void journal_copy(TapeJournal *journal, double *from, double *to, int count);
/* From derivatives by results to derivatives by what was read, which are added there; those of what a tape wrote become
 * 0. Returns the number of factors that were infinite (of a root at 0), for which 0 was taken: that is right where what
 * is under them does not change. */
int journal_back(TapeJournal *journal);

#endif
