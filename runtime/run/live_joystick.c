/* SPDX-License-Identifier: MIT
 * A joystick, wheel or gamepad that drives a run of --live, by Linux's joystick device: events of eight bytes, a time
 * in ms, a value, a kind (1 a button, 2 an axis; 0x80 besides: not a move, but how things are when the device is
 * opened) and the number of the axis or button. */
#include "base/message.h"
#include "base/text.h"
#include "run/live.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    EVENT = 8,  /* bytes */
    BUTTON = 1, /* kinds of events */
    AXIS = 2,
    FIRST = 0x80,
    END = 32767,  /* of an axis, on either side */
    TURN = 64,    /* events that are read before one step */
    NUMBERS = 256 /* of axes and buttons */
};

/* An axis or button that moves an input. */
typedef struct Use {
    int kind, number, at; /* at: place among the numbers of packets */
    double low, high;     /* of the input */
} Use;

struct LiveJoystick {
    const char *device;
    int file; /* -1: closed */
    int uses;
    Use *use;
    unsigned char rest[EVENT]; /* the beginning of an event */
    size_t size;
    bool moves; /* has moved an input */
};

static _Noreturn void fail(const char *remedy, const char *word, const char *what)
{
    diag_fail(program_place(), remedy, "%s: '%s'", what, word);
}

/* A number up to `end`, which is left behind. */
static bool read_share(const char **s, char end, double *value)
{
    char *after;
    *value = strtod(*s, &after);
    const bool good = after != *s && *after == end && isfinite(*value);
    *s = after + (end != 0);
    return good;
}

/* NAME=axisK:LOW:HIGH or NAME=buttonK:LOW:HIGH. */
static Use read_use(Pool *pool, const LivePort *port, const Model *model, const Hold *hold, const char *word)
{
    static const char *const usual = "write NAME=axis0:LOW:HIGH or NAME=button0:LOW:HIGH, as in accelerator=axis5:0:1";
    const char *equals = strchr(word, '='), *s = equals ? equals + 1 : "";
    Use use = {.at = -1};
    double number = -1;
    use.kind = !strncmp(s, "axis", 4) ? AXIS : !strncmp(s, "button", 6) ? BUTTON : 0;
    s += use.kind == AXIS ? 4 : use.kind ? 6 : 0;
    if (!use.kind || *s < '0' || *s > '9' || !read_share(&s, ':', &number) || !read_share(&s, ':', &use.low) ||
        !read_share(&s, 0, &use.high) || !(number < NUMBERS) || number != floor(number))
        fail(usual, word, "no use of an axis or button");
    use.number = (int)number;
    const char *name = pool_print(pool, "%.*s", (int)(equals - word), word);
    for (int i = 0; i < hold->hands; ++i) {
        const int input = hold->input[hold->first[i]];
        if (!strcmp(name, model->input[input].name))
            use.at = hold->first[i];
    }
    if (use.at < 0)
        fail("name an input of the model, one of --inputs where that is given", name, "no such input to be moved");
    const double low = fmin(use.low, use.high), high = fmax(use.low, use.high);
    if (!(low >= port->low[use.at] && high <= port->high[use.at]))
        fail(pool_print(pool, "keep within its range, %g to %g", port->low[use.at], port->high[use.at]), word,
             "beyond the range of the coordinate");
    return use;
}

LiveJoystick *live_joystick_open(Pool *pool, const LivePort *port, const Model *model, const Scene *scene,
                                 const char *device, const char *axes)
{
    LiveJoystick *joystick = pool_alloc(pool, sizeof *joystick);
    *joystick = (LiveJoystick){.device = device, .file = -1};
    char *list = pool_print(pool, "%s", axes ? axes : ""), *left = NULL;
    for (char *word = strtok_r(list, ",", &left); word; word = strtok_r(NULL, ",", &left))
        *POOL_PUSH(pool, joystick->use, joystick->uses) = read_use(pool, port, model, scene->hold, word);
    if (!joystick->uses)
        diag_fail(program_place(), "for example --axes accelerator=axis5:0:1,brake=axis2:0:1",
                  "nothing says which axis of the joystick moves which input");
    joystick->file = open(device, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (joystick->file < 0)
        diag_fail(program_place(), "is it plugged in, and may you read it? Users of the group `input` may",
                  "can't open the joystick %s: %s", device, strerror(errno));
    return joystick;
}

static bool use_event(const LiveJoystick *joystick, double *value)
{
    const unsigned char *event = joystick->rest;
    const int kind = event[6] & ~FIRST, number = event[7];
    const int at = (int16_t)(uint16_t)(event[4] | event[5] << 8);
    const double share = kind == AXIS ? (fmax(at, -END) + END) / (2.0 * END) : at != 0;
    bool moved = false;
    for (int i = 0; i < joystick->uses; ++i) {
        const Use *use = &joystick->use[i];
        if (use->kind != kind || use->number != number)
            continue;
        value[use->at] = use->low + share * (use->high - use->low);
        moved = true;
    }
    return moved;
}

void live_joystick_take(LiveJoystick *joystick, double time, HoldBy *by, double *value)
{
    ssize_t size = 0;
    for (int i = 0; i < TURN && joystick->file >= 0; ++i) {
        size = read(joystick->file, joystick->rest + joystick->size, EVENT - joystick->size);
        if (size <= 0)
            break;
        joystick->size += (size_t)size;
        if (joystick->size < EVENT)
            continue;
        joystick->size = 0;
        joystick->moves = use_event(joystick, value) || joystick->moves;
    }
    const bool gone = joystick->file >= 0 && (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR));
    if (gone) {
        live_joystick_close(joystick);
        diag_warn(program_place(), "plug it in and start again; packets may drive now",
                  "the joystick %s is gone at t = %.6g s; the scene has the inputs again", joystick->device, time);
    }
    if (joystick->file < 0)
        *by = gone ? HOLD_SCENE : *by;
    else if (joystick->moves)
        *by = HOLD_TARGETS;
}

bool live_joystick_has(const LiveJoystick *joystick)
{
    return joystick && joystick->file >= 0 && joystick->moves;
}

void live_joystick_close(LiveJoystick *joystick)
{
    if (joystick && joystick->file >= 0)
        close(joystick->file);
    if (joystick)
        joystick->file = -1;
}
