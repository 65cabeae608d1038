/* SPDX-License-Identifier: MIT
 * live_client PORT [SECONDS]: the pedals of a vehicle of `gicrun --live PORT` (models/LIVE.md), which keep 8 m/s for
 * some seconds and are given back then. */
#include "gic_live.h"

#include <arpa/inet.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

static unsigned char packet[GIC_LIVE_MOST + 1]; /* one more than a packet has: the end of a text */

/* The next packet of a kind within half a second, and its size; 0: none. */
static size_t receive(int to, int kind, gic_live_head *head)
{
    struct pollfd wait = {.fd = to, .events = POLLIN};
    while (poll(&wait, 1, 500) > 0) {
        const ssize_t size = recv(to, packet, GIC_LIVE_MOST, 0);
        if (size < 0)
            return 0;
        packet[size] = 0;
        if (gic_live_get_head(packet, (size_t)size, head) && head->kind == kind)
            return (size_t)size;
    }
    return 0;
}

/* Ask for the names until they come. */
static int ask(int to, gic_live_head *head)
{
    for (int i = 0; i < 120; ++i) {
        const gic_live_head question = {.kind = GIC_LIVE_ASK};
        gic_live_put_head(packet, &question);
        if (send(to, packet, GIC_LIVE_HEAD, 0) > 0 && receive(to, GIC_LIVE_NAMES, head))
            return 1;
        poll(NULL, 0, 100);
    }
    return 0;
}

/* The place of a line "input NAME ..." among the lines that begin with "input ", -1: there is none; name NULL: how many
 * such lines there are. */
static int place_of(const char *text, const char *kind, const char *name)
{
    int place = 0;
    for (const char *line = text; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL) {
        if (strncmp(line, kind, strlen(kind)) != 0)
            continue;
        const char *at = line + strlen(kind);
        if (name && !strncmp(at, name, strlen(name)) && at[strlen(name)] == ' ')
            return place;
        ++place;
    }
    return name ? -1 : place;
}

int main(int count, char **word)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(count > 1 ? word[1] : "0"))};
    const double seconds = count > 2 ? atof(word[2]) : 5;
    const int to = socket(AF_INET, SOCK_DGRAM, 0);
    gic_live_head head;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (to < 0 || connect(to, (const struct sockaddr *)&address, sizeof address) || !ask(to, &head)) {
        fputs("live_client: nobody answers there\n", stderr);
        return 1;
    }
    const char *text = (const char *)packet + GIC_LIVE_HEAD;
    const uint64_t hash = gic_live_hash(text, head.count);
    const int accelerator = place_of(text, "input ", "accelerator"), brake = place_of(text, "input ", "brake");
    const int x = place_of(text, "output ", "chassis.x"), y = place_of(text, "output ", "chassis.y");
    if (accelerator < 0 || brake < 0 || x < 0 || y < 0 || place_of(text, "input ", NULL) != 2) {
        fputs("live_client: run gicrun with --inputs accelerator,brake, and a scene with the output 'chassis'\n",
              stderr);
        return 1;
    }
    double begin = -1, before[3] = {-1}, speed = 0;
    gic_live_head inputs = {.kind = GIC_LIVE_INPUTS, .hash = hash, .count = 2};
    while (receive(to, GIC_LIVE_OUTPUTS, &head) && head.hash == hash && !(head.flags & GIC_LIVE_OVER)) {
        const double now[3] = {gic_live_get_number(packet, 0), gic_live_get_number(packet, (uint32_t)x),
                               gic_live_get_number(packet, (uint32_t)y)};
        if (begin < 0)
            begin = now[0];
        if (before[0] >= 0 && now[0] > before[0]) {
            speed = hypot(now[1] - before[1], now[2] - before[2]) / (now[0] - before[0]);
            ++inputs.number;
            inputs.flags = now[0] < begin + seconds ? 0 : GIC_LIVE_BACK;
            gic_live_put_head(packet, &inputs);
            gic_live_put_number(packet, (uint32_t)accelerator, fmin(fmax(0.3 * (8 - speed), 0), 1));
            gic_live_put_number(packet, (uint32_t)brake, fmin(fmax(0.1 * (speed - 8.5), 0), 1));
            send(to, packet, GIC_LIVE_HEAD + 8 * 2, 0);
            if (inputs.flags & GIC_LIVE_BACK)
                break;
        }
        memcpy(before, now, sizeof before);
    }
    close(to);
    printf("%.2f m/s at t = %.3f s\n", speed, before[0]);
    return 0;
}
