/* SPDX-License-Identifier: MIT
 * Handles: an index in a table and how often that place was used before, so that no handle comes twice. */
#define _GNU_SOURCE /* newlocale */
#include "base/catch.h"
#include "base/message.h"
#include "base/pool.h"
#include "base/version.h"
#include "engine/engine.h"
#include "host/gic.h"
#include "library/library_private.h"

#include <locale.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct Slot {
    uint32_t generation; /* 1 from the first use on */
    ThingKind kind;
    void *thing; /* NULL: free */
    int users;   /* calls at work */
} Slot;

struct gicl_library {
    pthread_mutex_t lock; /* of the table */
    locale_t plain;
    gicl_listener heard; /* as given; hear NULL: nobody */
    Source program;
    Listener listener;
    Slot *slot;
    uint32_t slots;
};

static const struct {
    const char *name, *article;
    void (*release)(void *thing);
    bool shared; /* calls may overlap */
} kind_of[THING_KINDS] = {
    [THING_MODEL] = {"model", "a", model_let, true},
    [THING_INSTANCE] = {"instance", "an", vehicles_free, false},
    [THING_BATCH] = {"batch", "a", vehicles_free, false},
    [THING_RESULT] = {"result", "a", result_free, true},
};

int gicl_version(void)
{
    return GICL_VERSION;
}

const char *gicl_release(void)
{
    return GICGEN_VERSION;
}

gicl_library *gicl_open(void)
{
    gicl_library *library = calloc(1, sizeof *library);
    if (!library)
        return NULL;
    library->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (library->plain == (locale_t)0 || pthread_mutex_init(&library->lock, NULL)) {
        if (library->plain != (locale_t)0)
            freelocale(library->plain);
        free(library);
        return NULL;
    }
    return library;
}

int gicl_close(gicl_library *library)
{
    if (!library)
        return GICL_WRONG;
    /* instances and batches before the models that they use */
    for (int round = 0; round < 2; ++round)
        for (uint32_t i = 0; i < library->slots; ++i) {
            Slot *slot = &library->slot[i];
            if (!slot->thing || (slot->kind == THING_MODEL) != (round == 1))
                continue;
            kind_of[slot->kind].release(slot->thing);
            slot->thing = NULL;
        }
    freelocale(library->plain);
    pthread_mutex_destroy(&library->lock);
    free(library->slot);
    free(library);
    return GICL_OK;
}

/* ---- who listens -------------------------------------------------------------------------------------------- */

static gicl_message seen(const Message *message)
{
    return (gicl_message){.kind = (int)message->kind,
                          .file = message->file,
                          .line = message->line,
                          .column = message->column,
                          .text = message->text,
                          .remedy = message->remedy,
                          .printed = message->printed};
}

static void hear(void *context, const Message *message)
{
    const gicl_listener *heard = context;
    const gicl_message shown = seen(message);
    heard->hear(heard->context, &shown);
}

int gicl_listen(gicl_library *library, const gicl_listener *listener, gicl_messages *said)
{
    call_begin(library, said);
    if (!library)
        return call_wrong(said, "gicl_open() makes a library", "the library is NULL");
    if (listener && (listener->size != sizeof *listener || !listener->hear))
        return call_wrong(said, "set size to sizeof(gicl_listener), and hear",
                          "a listener has %zu bytes and a function, not %zu bytes%s", sizeof *listener, listener->size,
                          listener->hear ? "" : " and none");
    library->heard = listener ? *listener : (gicl_listener){0};
    library->program = (Source){.path = library->heard.program};
    library->listener = (Listener){.program = library->heard.program ? &library->program : NULL,
                                   .signals = library->heard.signals,
                                   .hear = library->heard.hear ? hear : NULL,
                                   .context = &library->heard};
    call_begin(library, said);
    return GICL_OK;
}

void call_begin(const gicl_library *library, gicl_messages *said)
{
    if (!said)
        return;
    messages_clear(&said->list);
    said->list.listener = library && library->listener.hear ? &library->listener : NULL;
}

/* ---- handles ------------------------------------------------------------------------------------------------ */

static gicl_handle handle_of(const gicl_library *library, uint32_t i)
{
    return (gicl_handle)library->slot[i].generation << 32 | i;
}

gicl_handle handle_new(gicl_library *library, ThingKind kind, void *thing)
{
    gicl_handle handle = 0;
    pthread_mutex_lock(&library->lock);
    uint32_t i = 0;
    while (i < library->slots && (library->slot[i].thing || library->slot[i].generation == UINT32_MAX))
        ++i;
    if (i == library->slots) {
        const uint32_t slots = 2 * library->slots + 8;
        Slot *grown = realloc(library->slot, slots * sizeof *grown);
        if (grown) {
            for (uint32_t k = library->slots; k < slots; ++k)
                grown[k] = (Slot){0};
            library->slot = grown;
            library->slots = slots;
        }
    }
    if (i < library->slots) {
        Slot *slot = &library->slot[i];
        *slot = (Slot){.generation = slot->generation + 1, .kind = kind, .thing = thing};
        handle = handle_of(library, i);
    }
    pthread_mutex_unlock(&library->lock);
    return handle;
}

/* With the lock: the place of an open thing, NULL: none. */
static Slot *slot_of(const gicl_library *library, gicl_handle handle)
{
    const uint32_t i = (uint32_t)handle;
    return i < library->slots && library->slot[i].thing && handle_of(library, i) == handle ? &library->slot[i] : NULL;
}

Use use_begin(gicl_library *library, gicl_handle handle, ThingKind kind, gicl_messages *said)
{
    Use use = {library, handle, NULL, GICL_WRONG};
    call_begin(library, said);
    if (!library) {
        call_wrong(said, "gicl_open() makes a library", "the library is NULL");
        return use;
    }
    pthread_mutex_lock(&library->lock);
    Slot *slot = slot_of(library, handle);
    const ThingKind found = slot ? slot->kind : kind;
    const bool busy = slot && slot->users && !kind_of[found].shared;
    if (slot && found == kind && !busy) {
        ++slot->users;
        use.thing = slot->thing;
        use.status = GICL_OK;
    }
    pthread_mutex_unlock(&library->lock);
    if (!slot)
        call_wrong(said, "use a handle from when it is given to when it is closed",
                   "there is no open %s with this handle", kind_of[kind].name);
    else if (found != kind)
        call_wrong(said, NULL, "the handle is that of %s %s, where %s %s is wanted", kind_of[found].article,
                   kind_of[found].name, kind_of[kind].article, kind_of[kind].name);
    else if (busy)
        call_wrong(said, "give each thread its own", "another call is using this %s", kind_of[kind].name);
    return use;
}

int use_end(const Use *use, int status)
{
    pthread_mutex_lock(&use->library->lock);
    --slot_of(use->library, use->handle)->users;
    pthread_mutex_unlock(&use->library->lock);
    return status;
}

int gicl_free(gicl_library *library, gicl_handle handle, gicl_messages *said)
{
    call_begin(library, said);
    if (!library)
        return call_wrong(said, "gicl_open() makes a library", "the library is NULL");
    pthread_mutex_lock(&library->lock);
    Slot *slot = slot_of(library, handle);
    const bool there = slot, busy = slot && slot->users;
    void *thing = slot && !busy ? slot->thing : NULL;
    const ThingKind kind = slot ? slot->kind : THING_MODEL;
    if (thing)
        slot->thing = NULL;
    pthread_mutex_unlock(&library->lock);
    if (!there)
        return call_wrong(said, "close each thing once", "nothing open has this handle");
    if (busy)
        return call_wrong(said, "wait for it", "another call is using this %s", kind_of[kind].name);
    kind_of[kind].release(thing);
    return GICL_OK;
}

/* ---- calls -------------------------------------------------------------------------------------------------- */

int call_work(const gicl_library *library, gicl_messages *said, void (*work)(void *context), void *context)
{
    gicl_messages unread = {{NULL, NULL, NULL}};
    call_begin(library, &unread);
    Messages *messages = said ? &said->list : &unread.list;
    const locale_t before = uselocale(library->plain);
    const bool good = caught(messages, work, context);
    uselocale(before);
    const int status = good ? GICL_OK : messages->last && messages->last->call ? GICL_WRONG : GICL_FAILED;
    messages_clear(&unread.list);
    return status;
}

typedef struct Said {
    const char *remedy, *text;
} Said;

static void fail(void *context)
{
    static const Source library = {.path = "libgic"};
    const Said *said = context;
    diag_fail((Place){&library, 0, 0}, said->remedy, "%s", said->text);
}

int call_wrong(gicl_messages *said, const char *remedy, const char *format, ...)
{
    char text[1000];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (said)
        caught(&said->list, fail, &(Said){remedy, text});
    return GICL_WRONG;
}

typedef struct StatusText {
    const gic_model *code;
    const gic_head *self;
    int status;
    const char *what;
} StatusText;

static void tell_status(void *context)
{
    const StatusText *text = context;
    Pool *pool = pool_new();
    const char *said = pool_print(pool, "%s at t = %.9g s: %s", text->what, gic_time(text->self),
                                  instance_status(pool, text->code, text->self, text->status));
    static const Source library = {.path = "libgic"};
    diag_fail((Place){&library, 0, 0}, NULL, "%s", said);
}

int call_status(gicl_messages *said, const gic_model *code, const gic_head *self, int status, const char *what)
{
    if (said && status != GIC_OK)
        caught(&said->list, tell_status, &(StatusText){code, self, status, what});
    return status;
}

/* ---- messages ----------------------------------------------------------------------------------------------- */

gicl_messages *gicl_messages_new(void)
{
    return calloc(1, sizeof(gicl_messages));
}

void gicl_messages_free(gicl_messages *said)
{
    if (said)
        messages_clear(&said->list);
    free(said);
}

int gicl_message_count(const gicl_messages *said)
{
    int count = 0;
    for (const Message *message = said ? said->list.first : NULL; message; message = message->next)
        ++count;
    return count;
}

int gicl_message_get(const gicl_messages *said, int index, gicl_message *message)
{
    const Message *found = said && index >= 0 ? said->list.first : NULL;
    while (found && index-- > 0)
        found = found->next;
    if (!found || !message)
        return 0;
    *message = seen(found);
    return 1;
}
