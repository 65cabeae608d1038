/* SPDX-License-Identifier: MIT
 * Failures that end a call instead of the program. The one variable that is no constant is the innermost catcher of
 * each thread: a failure deep in the generator has no argument that leads to it. */
#include "base/catch.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct Owned {
    void (*release)(void *thing);
    void *thing;
    struct Owned *next;
} Owned;

typedef struct Catcher {
    sigjmp_buf back;
    Messages *messages;
    Owned *owned; /* newest first */
    struct Catcher *outer;
} Catcher;

static _Thread_local Catcher *innermost;

/* For when there is no memory for a message. */
static Message no_memory = {
    .kind = MESSAGE_ERROR, .text = "out of memory", .printed = "gicgen: error: out of memory\n"};

void messages_clear(Messages *messages)
{
    for (Message *message = messages->first; message && message != &no_memory;) {
        Message *next = message->next;
        free(message);
        message = next;
    }
    messages->first = messages->last = NULL;
}

/* Release what a catcher was told, or only forget it. */
static void let_go(Catcher *catcher, bool release)
{
    while (catcher->owned) {
        Owned *owned = catcher->owned;
        catcher->owned = owned->next;
        if (release)
            owned->release(owned->thing);
        free(owned);
    }
}

bool caught(Messages *messages, void (*work)(void *context), void *context)
{
    Catcher catcher = {.messages = messages, .outer = innermost};
    innermost = &catcher;
    /* with the mask of signals, which is changed while files are written; a program that ends with a failure is not to
     * be ended by the signal that came before */
    const Listener *listener = messages->listener;
    const bool good = !sigsetjmp(catcher.back, !(listener && listener->signals));
    if (good)
        work(context);
    innermost = catcher.outer;
    if (good)
        for (Owned *owned = catcher.owned; owned && catcher.outer; owned = owned->next)
            caught_own(owned->release, owned->thing);
    let_go(&catcher, !good);
    return good;
}

bool catching(void)
{
    return innermost;
}

const Listener *caught_listener(void)
{
    return innermost ? innermost->messages->listener : NULL;
}

void caught_fail(void)
{
    if (innermost)
        siglongjmp(innermost->back, 1);
}

void caught_own(void (*release)(void *thing), void *thing)
{
    if (!innermost)
        return;
    Owned *owned = malloc(sizeof *owned);
    if (!owned) {
        release(thing);
        caught_tell(&(Message){.text = NULL});
        caught_fail();
        return;
    }
    *owned = (Owned){release, thing, innermost->owned};
    innermost->owned = owned;
}

void caught_disown(const void *thing)
{
    for (Catcher *catcher = innermost; catcher; catcher = catcher->outer)
        for (Owned **owned = &catcher->owned; *owned; owned = &(*owned)->next)
            if ((*owned)->thing == thing) {
                Owned *gone = *owned;
                *owned = gone->next;
                free(gone);
                return;
            }
}

/* Copy a text to *end and move *end behind it; NULL stays NULL. */
static const char *copy(char **end, const char *text)
{
    if (!text)
        return NULL;
    char *begin = *end;
    const size_t size = strlen(text) + 1;
    memcpy(begin, text, size);
    *end += size;
    return begin;
}

static size_t size_of(const char *text)
{
    return text ? strlen(text) + 1 : 0;
}

void caught_tell(const Message *message)
{
    Messages *messages = innermost->messages;
    const Listener *listener = messages->listener;
    if (listener && listener->hear && (message->text || message->kind == MESSAGE_ERROR))
        listener->hear(listener->context, message->text ? message : &no_memory);
    if (message->kind == MESSAGE_PROGRESS)
        return;
    const size_t texts =
        size_of(message->file) + size_of(message->text) + size_of(message->remedy) + size_of(message->printed);
    Message *kept = message->text ? malloc(sizeof *kept + texts) : NULL;
    if (kept) {
        char *end = (char *)(kept + 1);
        *kept = *message;
        kept->file = copy(&end, message->file);
        kept->text = copy(&end, message->text);
        kept->remedy = copy(&end, message->remedy);
        kept->printed = copy(&end, message->printed);
        kept->next = NULL;
    }
    if (!kept) {
        if (message->kind != MESSAGE_ERROR || messages->last == &no_memory)
            return; /* a warning is lost */
        messages_clear(messages);
        kept = &no_memory;
    }
    if (messages->last)
        messages->last->next = kept;
    else
        messages->first = kept;
    messages->last = kept;
}
