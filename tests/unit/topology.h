/* SPDX-License-Identifier: MIT
 *
 * Models built by hand for the tests of graph, sequence and drawing: only topology matters, and no reader is needed.
 */
#ifndef TOPOLOGY_H
#define TOPOLOGY_H

#include "base/message.h"
#include "base/text.h"
#include "model/model.h"
#include "sequence/sequence.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- models by hand ------------------------------------------------------------------------------ */

/* Lines where entries of a model stand in its imaginary file. */
enum { BODY_LINE = 1, JOINT_LINE = 100, COORDINATE_LINE = 200, LINES = 300 };

typedef struct Builder {
    Pool *pool;
    Model model;
} Builder;

static inline Place place(Builder *b, int line)
{
    return (Place){b->model.source, line < LINES ? line : 0, 1};
}

static inline int body(Builder *b, const char *name)
{
    int index = b->model.bodies;
    *POOL_PUSH(b->pool, b->model.body, b->model.bodies) = (Body){.name = name, .at = place(b, BODY_LINE + index)};
    return index;
}

static inline Builder start(const char *base)
{
    Builder b = {.pool = pool_new()};
    char *lines = pool_alloc(b.pool, LINES);
    memset(lines, '\n', LINES - 1);
    Source *source = pool_alloc(b.pool, sizeof *source);
    *source = (Source){.path = "car.veh", .bytes = lines, .size = LINES - 1};
    b.model.source = source;
    b.model.name = "car";
    b.model.free_base = strcmp(base, "ground") != 0;
    body(&b, base);
    return b;
}

static inline int find_body(const Builder *b, const char *name)
{
    for (int i = 0; i < b->model.bodies; ++i)
        if (!strcmp(b->model.body[i].name, name))
            return i;
    fail_msg("no body '%s'", name);
    return -1;
}

static inline void joint(Builder *b, const char *name, JointType type, const char *a, const char *c)
{
    int line = JOINT_LINE + b->model.joints;
    Joint new = {.name = name, .at = place(b, line), .type = type, .body = {find_body(b, a), find_body(b, c)}};
    *POOL_PUSH(b->pool, b->model.joint, b->model.joints) = new;
}

static inline void coordinate(Builder *b, const char *name, CoordinateType type, const char *a, const char *c)
{
    int line = COORDINATE_LINE + b->model.coordinates;
    Coordinate new = {.name = name, .at = place(b, line), .type = type, .body = {find_body(b, a), find_body(b, c)}};
    *POOL_PUSH(b->pool, b->model.coordinate, b->model.coordinates) = new;
}

static inline const char *corner_name(Builder *b, const char *part, const char *corner)
{
    return pool_print(b->pool, "%s_%s", part, corner);
}

/* The HMMWV of the paper (Serban and Haug 2000, section 4). */
static inline Builder hmmwv(void)
{
    static const char *const corner[] = {"fl", "fr", "rl", "rr"};
    Builder b = start("chassis");
    body(&b, "rack");
    for (int i = 0; i < 4; ++i)
        body(&b, corner_name(&b, "lca", corner[i]));
    for (int i = 0; i < 4; ++i)
        body(&b, corner_name(&b, "wheel", corner[i]));
    joint(&b, "rack_guide", JOINT_PRISMATIC, "chassis", "rack");
    coordinate(&b, "steer", COORDINATE_TRANSLATION, "chassis", "rack");
    for (int i = 0; i < 4; ++i) {
        const char *arm = corner_name(&b, "lca", corner[i]), *wheel = corner_name(&b, "wheel", corner[i]);
        joint(&b, corner_name(&b, "hinge", corner[i]), JOINT_REVOLUTE, "chassis", arm);
        coordinate(&b, corner_name(&b, "spring", corner[i]), COORDINATE_LENGTH, "chassis", arm);
        if (i < 2) {
            joint(&b, corner_name(&b, "ball", corner[i]), JOINT_SPHERICAL, arm, wheel);
            joint(&b, corner_name(&b, "upper", corner[i]), JOINT_REVOLUTE_SPHERICAL, "chassis", wheel);
            joint(&b, corner_name(&b, "tie", corner[i]), JOINT_DISTANCE, "rack", wheel);
        } else {
            joint(&b, corner_name(&b, "ball", corner[i]), JOINT_REVOLUTE, arm, wheel);
            joint(&b, corner_name(&b, "upper", corner[i]), JOINT_DISTANCE, "chassis", wheel);
        }
    }
    return b;
}

/* One corner with both arms as bodies; the spring stands on `spring_foot`. */
static inline Builder double_wishbone(const char *upper, const char *knuckle, const char *spring_foot)
{
    Builder b = start("chassis");
    body(&b, knuckle);
    body(&b, "lower");
    body(&b, upper);
    joint(&b, "lower_hinge", JOINT_REVOLUTE, "chassis", "lower");
    joint(&b, "upper_hinge", JOINT_REVOLUTE, "chassis", upper);
    joint(&b, "lower_ball", JOINT_SPHERICAL, "lower", knuckle);
    joint(&b, "upper_ball", JOINT_SPHERICAL, upper, knuckle);
    joint(&b, "tie", JOINT_DISTANCE, "chassis", knuckle);
    coordinate(&b, "spring", COORDINATE_LENGTH, "chassis", spring_foot);
    return b;
}

/* Links on revolutes with an angle each, hung on ground one below the other. */
static inline Builder chain(int links)
{
    Builder b = start("ground");
    for (int i = 1; i <= links; ++i) {
        body(&b, pool_print(b.pool, "link%d", i));
        int line = JOINT_LINE + LINES; /* nobody asks for these places */
        Joint hinge = {.name = pool_print(b.pool, "hinge%d", i),
                       .at = place(&b, line),
                       .type = JOINT_REVOLUTE,
                       .body = {i - 1, i}};
        *POOL_PUSH(b.pool, b.model.joint, b.model.joints) = hinge;
        Coordinate angle = {.name = pool_print(b.pool, "angle%d", i),
                            .at = place(&b, line),
                            .type = COORDINATE_ANGLE,
                            .body = {i - 1, i}};
        *POOL_PUSH(b.pool, b.model.coordinate, b.model.coordinates) = angle;
    }
    return b;
}

/* ---- messages ------------------------------------------------------------------------------ */

/* Run the search in a child, which must fail with exit status 1; its message, in memory of the pool. */
static inline const char *message_of(Builder *b)
{
    int ends[2], status;
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (!child) {
        dup2(ends[1], STDERR_FILENO);
        close(ends[0]);
        sequence_find(b->pool, &b->model);
        _exit(0);
    }
    close(ends[1]);
    Text text = {.pool = b->pool};
    text_add(&text, "", 0);
    char buffer[512];
    for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
        text_add(&text, buffer, (size_t)n);
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 1)
        fail_msg("expected exit status 1; message: %s", text.s);
    return text.s;
}

static inline void assert_says(const char *message, const char *part)
{
    if (!strstr(message, part))
        fail_msg("'%s' is not in: %s", part, message);
}

static inline void assert_silent_about(const char *message, const char *part)
{
    if (strstr(message, part))
        fail_msg("'%s' is in: %s", part, message);
}

#endif
