/* SPDX-License-Identifier: MIT
 *
 * Failures that end a call instead of the program: for the library. Programs catch nothing; their mistakes end in exit
 * status 1. */
#ifndef BASE_CATCH_H
#define BASE_CATCH_H

#include <stdbool.h>
#include <stddef.h>

/* The last two: a text that is a result, for standard output; how far the work is, for a terminal, instead of what it
 * said before. */
typedef enum MessageKind { MESSAGE_ERROR, MESSAGE_WARNING, MESSAGE_NOTE, MESSAGE_TEXT, MESSAGE_PROGRESS } MessageKind;

/* What a program prints, in parts and as a whole. */
typedef struct Message {
    MessageKind kind;
    bool call;                 /* an error of who calls, not in what is read: exit status 2 */
    const char *file;          /* as the user gave it; NULL: the message is about none */
    int line, column;          /* from 1; 0: the file as a whole */
    const char *text, *remedy; /* remedy: NULL: none */
    const char *printed;
    struct Message *next;
} Message;

/* Who hears messages when they come, such as a program. */
typedef struct Listener {
    const struct Source *program;                        /* the place of messages about no file; NULL: gicrun */
    bool signals;                                        /* signals that ask to stop are ours: host.h */
    void (*hear)(void *context, const Message *message); /* NULL: nobody */
    void *context;
} Listener;

/* The messages of a call, oldest first, without those of progress. */
typedef struct Messages {
    Message *first, *last;
    const Listener *listener; /* NULL: none */
} Messages;

/* Frees all of them; the listener stays. */
void messages_clear(Messages *messages);

/* Run work(context). Messages are added to `messages` instead of printed, and a failure ends `work`: false. Then all
 * that caught_own() was told since the begin is released, pools among it. Calls may be nested, and be in any number of
 * threads. */
bool caught(Messages *messages, void (*work)(void *context), void *context);

/* True inside of caught(), in this thread. */
bool catching(void);
/* Who hears the innermost messages; NULL: nobody. */
const Listener *caught_listener(void);

/* A failure is to call release(thing), which is done at once if memory for the note of that is out. Nothing happens
 * where nothing is caught, for there the program ends. */
void caught_own(void (*release)(void *thing), void *thing);
/* It is not to any more. */
void caught_disown(const void *thing);

/* For message.c: end the innermost caught(), if there is one; and add a message to it, whose parts are copied. `text`
 * NULL: memory is out. */
void caught_fail(void);
void caught_tell(const Message *message);

#endif
