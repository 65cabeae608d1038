/* SPDX-License-Identifier: MIT
 * Packets of gicrun --live over UDP on the loopback interface. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "run/live.h"
#include "scene/driver.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    TURN = 64, /* packets that are looked at before one step: a flood does not hold it up */
};

static const double silence = 1;   /* s without a good packet after which the scene has the inputs again */
static const double interest = 10; /* s that outputs are sent to who has said nothing */

/* ---- what both sides must know ------------------------------------------------------------------------------------
 */

/* All inputs at time 0, as the scene has them. */
static const double *begin_values(Pool *pool, const Model *model, const Scene *scene)
{
    double *value = pool_alloc(pool, sizeof *value * ((size_t)model->inputs + 1));
    for (int i = 0; i < model->inputs; ++i)
        value[i] = model->input[i].initial;
    if (scene->driver)
        driver_start(scene->driver);
    scene_inputs((void *)scene, 0, 0, value);
    return value;
}

/* Text that tells inputs and outputs, in their order. */
static void write_names(LivePort *port, Pool *pool, const Model *model, const Scene *scene)
{
    Text text = {.pool = pool};
    char step[CSV_DIGITS], output_step[CSV_DIGITS], digits[CSV_DIGITS];
    text_print(&text, "model %s\nstep %s\noutput_step %s\n", model->name, csv_digits(scene->step, step),
               csv_digits(scene->output_step, output_step));
    const double *value = begin_values(pool, model, scene);
    double *begin = pool_alloc(pool, sizeof *begin * ((size_t)port->inputs + 1));
    port->begin = begin;
    for (int i = 0; i < port->inputs; ++i) {
        const int at = scene->hold->input[i];
        begin[i] = value[at];
        text_print(&text, "input %s [%s] %s\n", model->input[at].name, model->input[at].unit,
                   csv_digits(value[at], digits));
    }
    text_print(&text, "output time [s]\n");
    for (int i = 0; i < scene->columns; ++i)
        text_print(&text, "output %s [%s]\n", scene->signal[scene->column[i]].name,
                   scene->signal[scene->column[i]].unit);
    port->names = text.s;
    port->size = text.size;
    port->hash = gic_live_hash(text.s, text.size);
    const size_t most = GIC_LIVE_MOST - GIC_LIVE_HEAD;
    if (port->size > most || (size_t)port->outputs * 8 > most || (size_t)port->inputs * 8 > most)
        diag_fail((Place){scene->source, 0, 0}, "list fewer `outputs` in the scene",
                  "%d inputs and %d outputs with their names do not fit into packets of %d bytes", port->inputs,
                  port->outputs, GIC_LIVE_MOST);
}

/* Values of driven coordinates stay in their ranges: beyond them the mechanism may have no assembly, and the run ends.
 */
static void find_ranges(LivePort *port, Pool *pool, const Model *model, const Hold *hold)
{
    double *low = pool_alloc(pool, sizeof *low * ((size_t)port->inputs + 1));
    double *high = pool_alloc(pool, sizeof *high * ((size_t)port->inputs + 1));
    for (int i = 0; i < port->inputs; ++i) {
        const Coordinate *driven = scene_driven_by(model, hold->input[i]);
        low[i] = driven ? driven->range[0] : -INFINITY;
        high[i] = driven ? driven->range[1] : INFINITY;
    }
    port->low = low;
    port->high = high;
}

/* ---- the socket ---------------------------------------------------------------------------------------------------
 */

static struct sockaddr_in loopback(int port)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

static void undo(void *port)
{
    close(((LivePort *)port)->socket);
}

static _Noreturn void fail(const LivePort *port, const char *remedy, const char *what)
{
    diag_fail(program_place(), remedy, "can't %s port %d of the loopback interface: %s", what, port->port,
              strerror(errno));
}

/* Packets can reach it: an interface that is down takes an address, but nothing else. */
static void check_route(const LivePort *port, const struct sockaddr_in *address)
{
    const int other = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const int status = other < 0 ? -1 : connect(other, (const struct sockaddr *)address, sizeof *address);
    const int reason = errno;
    if (other >= 0)
        close(other);
    errno = reason;
    if (status)
        fail(port, "bring the interface up: `ip link set lo up`", "reach");
}

static void open_socket(LivePort *port)
{
    struct sockaddr_in address = loopback(port->port);
    socklen_t size = sizeof address;
    port->socket = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (port->socket < 0)
        fail(port, NULL, "open a socket for");
    caught_own(undo, port);
    if (bind(port->socket, (const struct sockaddr *)&address, size))
        fail(port,
             errno == EADDRINUSE
                 ? "another program has it, perhaps another run: end that, or choose another port, or 0 "
                   "for one that is free"
             : errno == EACCES ? "choose one from 1024 on: those below are the system's"
                               : "is there a loopback interface? `ip address` lists them",
             "take");
    getsockname(port->socket, (struct sockaddr *)&address, &size);
    port->port = ntohs(address.sin_port);
    check_route(port, &address);
}

LivePort *live_port_open(Pool *pool, int number, const Model *model, const Scene *scene)
{
    LivePort *port = pool_alloc(pool, sizeof *port);
    port->port = number;
    port->inputs = scene->hold->inputs;
    port->outputs = 1 + scene->columns;
    port->packet = pool_alloc(pool, GIC_LIVE_MOST + 1);
    port->patience = (int64_t)ceil(silence / scene->step);
    write_names(port, pool, model, scene);
    find_ranges(port, pool, model, scene->hold);
    open_socket(port);
    return port;
}

void live_port_close(LivePort *port)
{
    caught_disown(port);
    close(port->socket);
    port->socket = -1;
}

/* ---- who is there -------------------------------------------------------------------------------------------------
 */

static bool same(const struct sockaddr_in *a, const struct sockaddr_in *b)
{
    return a->sin_addr.s_addr == b->sin_addr.s_addr && a->sin_port == b->sin_port;
}

/* Outputs go to `from` from now on; where there are too many who want them, not to the one who was silent the longest.
 */
static void remember(LivePort *port, const struct sockaddr_in *from, int64_t step)
{
    int at = 0;
    for (int i = 0; i < port->peers; ++i) {
        if (same(&port->peer[i].address, from)) {
            port->peer[i].heard = step;
            return;
        }
        if (port->peer[i].heard < port->peer[at].heard)
            at = i;
    }
    if (port->peers < LIVE_PEERS)
        at = port->peers++;
    port->peer[at] = (LivePeer){*from, step};
}

static void send_to(LivePort *port, const struct sockaddr_in *to, size_t size)
{
    if (sendto(port->socket, port->packet, size, 0, (const struct sockaddr *)to, sizeof *to) == (ssize_t)size) {
        ++port->sent;
        return;
    }
    port->unsent_reason = errno;
    ++port->unsent;
}

static void answer(LivePort *port, const struct sockaddr_in *to)
{
    const gic_live_head head = {.kind = GIC_LIVE_NAMES, .hash = port->hash, .count = (uint32_t)port->size};
    gic_live_put_head(port->packet, &head);
    memcpy(port->packet + GIC_LIVE_HEAD, port->names, port->size);
    send_to(port, to, GIC_LIVE_HEAD + port->size);
}

/* ---- packets ------------------------------------------------------------------------------------------------------
 */

/* Is the packet of `size` bytes one with inputs that may be used? Else *why says what is wrong. */
static bool is_good(const LivePort *port, size_t size, const gic_live_head *head, const struct sockaddr_in *from,
                    LiveDrop *why)
{
    const size_t expected = GIC_LIVE_HEAD + 8 * (size_t)port->inputs;
    *why = DROP_SIZE;
    if (size != expected || head->count != (uint32_t)port->inputs)
        return false;
    *why = DROP_MODEL;
    if (head->hash != port->hash)
        return false;
    *why = DROP_FLAGS;
    if (head->flags & ~(unsigned)(GIC_LIVE_BACK | GIC_LIVE_EXACT))
        return false;
    for (int i = 0; i < port->inputs; ++i) {
        const double value = gic_live_get_number(port->packet, (uint32_t)i);
        *why = DROP_NOT_FINITE;
        if (!isfinite(value))
            return false;
        *why = DROP_RANGE;
        if (!(value >= port->low[i] && value <= port->high[i]))
            return false;
    }
    *why = DROP_OTHER;
    if (port->held && !same(from, &port->holder))
        return false;
    *why = DROP_OLD;
    return !port->held || head->number > port->number;
}

static void use(LivePort *port, const gic_live_head *head, const struct sockaddr_in *from, int64_t step, HoldBy *by,
                double *value)
{
    ++port->good;
    port->holder = *from;
    port->held = !(head->flags & GIC_LIVE_BACK);
    port->number = head->number;
    port->heard = step;
    *by = !port->held ? HOLD_SCENE : head->flags & GIC_LIVE_EXACT ? HOLD_EXACT : HOLD_TARGETS;
    for (int i = 0; i < port->inputs; ++i)
        value[i] = gic_live_get_number(port->packet, (uint32_t)i);
    remember(port, from, step);
}

void live_port_take(LivePort *port, int64_t step, HoldBy *by, double *value)
{
    for (int i = 0; i < TURN; ++i) {
        struct sockaddr_in from = {0};
        socklen_t length = sizeof from;
        gic_live_head head;
        LiveDrop why = DROP_KIND;
        const ssize_t size = recvfrom(port->socket, port->packet, GIC_LIVE_MOST, 0, (struct sockaddr *)&from, &length);
        if (size < 0)
            break;
        const bool known = gic_live_get_head(port->packet, (size_t)size, &head);
        if (known && head.kind == GIC_LIVE_ASK && size == GIC_LIVE_HEAD) {
            ++port->asked;
            remember(port, &from, step);
            answer(port, &from);
        } else if (known && head.kind == GIC_LIVE_INPUTS && is_good(port, (size_t)size, &head, &from, &why)) {
            use(port, &head, &from, step, by, value);
        } else {
            ++port->dropped[size < GIC_LIVE_HEAD || (known && head.kind == GIC_LIVE_ASK) ? DROP_SIZE : why];
        }
    }
    if (port->held && step - port->heard >= port->patience) {
        port->held = false;
        *by = HOLD_SCENE;
    }
}

void live_port_keep(LivePort *port, bool held, int64_t step)
{
    port->holder = (struct sockaddr_in){0};
    port->held = held;
    port->heard = step;
}

static int64_t dropped(const LivePort *port)
{
    int64_t sum = 0;
    for (int i = 0; i < LIVE_DROPS; ++i)
        sum += port->dropped[i];
    return sum;
}

void live_port_send(LivePort *port, int64_t step, unsigned flags, const double *value)
{
    const gic_live_head head = {.kind = GIC_LIVE_OUTPUTS,
                                .flags = flags | (port->held ? GIC_LIVE_HELD : 0),
                                .number = (uint64_t)step,
                                .hash = port->hash,
                                .echo = port->number,
                                .count = (uint32_t)port->outputs,
                                .dropped = (uint32_t)dropped(port)};
    const int64_t longest = (int64_t)(interest / silence) * port->patience;
    bool written = false;
    for (int i = 0; i < port->peers; ++i) {
        if (step - port->peer[i].heard > longest) {
            port->peer[i--] = port->peer[--port->peers];
            continue;
        }
        if (!written) {
            gic_live_put_head(port->packet, &head);
            for (int k = 0; k < port->outputs; ++k)
                gic_live_put_number(port->packet, (uint32_t)k, value[k]);
        }
        written = true;
        send_to(port, &port->peer[i].address, GIC_LIVE_HEAD + 8 * (size_t)port->outputs);
    }
}

const char *live_port_dropped(Pool *pool, const LivePort *port)
{
    static const char *const reason[LIVE_DROPS] = {
        "of a wrong size",    "of another kind or version",        "for another model or scene", "with unknown flags",
        "not finite numbers", "outside of a coordinate's `range`", "old or repeated numbers",    "of another sender"};
    Text text = {.pool = pool};
    text_print(&text, "%lld dropped", (long long)dropped(port));
    for (int i = 0, any = 0; i < LIVE_DROPS; ++i)
        if (port->dropped[i])
            text_print(&text, "%s%lld %s", any++ ? ", " : ": ", (long long)port->dropped[i], reason[i]);
    return text.s;
}
