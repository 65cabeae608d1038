/* SPDX-License-Identifier: MIT
 * What people see of the graph: messages about over- and under-determined models, the table and the drawing. */
#include "base/text.h"
#include "model/model.h"
#include "sequence/sequence.h"

#include "topology.h"

/* ---- diagnosis ----------------------------------------------------------------------------------------- */

static void drop_coordinate(Builder *b, int index)
{
    Model *m = &b->model;
    --m->coordinates;
    for (int i = index; i < m->coordinates; ++i)
        m->coordinate[i] = m->coordinate[i + 1];
}

static void test_under_determined(void **state)
{
    (void)state;
    Builder b = hmmwv();
    drop_coordinate(&b, 1); /* spring_fl: the arm is free and takes its wheel along, the rack stays put */
    const char *message = message_of(&b);
    assert_says(message, "car.veh:3:1: error: bodies 'lca_fl', 'wheel_fl' have 1 degree of freedom more");
    assert_says(message, "add a dual coordinate");
    assert_says(message, "'hinge_fl'");
    assert_says(message, "'tie_fl'");
    assert_silent_about(message, "rack_guide");
    assert_silent_about(message, "_fr");
    drop_coordinate(&b, 1); /* spring_fr */
    message = message_of(&b);
    assert_says(message, "bodies 'lca_fl', 'wheel_fl' have 1 degree of freedom more");
    assert_says(message, "besides, bodies 'lca_fr', 'wheel_fr' are under-determined");
    pool_free(b.pool);
}

static void test_over_determined(void **state)
{
    (void)state;
    Builder b = hmmwv();
    /* a second coordinate on an arm: 5 + 1 + 1 equations for one body */
    coordinate(&b, "bar", COORDINATE_LENGTH, "chassis", "lca_rr");
    const char *message = message_of(&b);
    assert_says(message, "joint 'hinge_rr' and dual coordinates 'spring_rr', 'bar' impose 7 conditions");
    assert_says(message, "on body 'lca_rr', 1 more than the 6 degrees of freedom");
    assert_says(message, "car.veh:204:1: error");
    assert_says(message, "remove dual coordinate 'spring_rr'");
    assert_silent_about(message, "wheel");
    pool_free(b.pool);
    /* a rear wheel with an upper arm of two equations where one is right */
    b = hmmwv();
    b.model.joint[b.model.joints - 1].type = JOINT_REVOLUTE_SPHERICAL;
    message = message_of(&b);
    assert_says(message, "impose 13 conditions on bodies 'lca_rr', 'wheel_rr', 1 more than the 12");
    assert_says(message, "joint 'hinge_rr' (revolute, 5) to cylindrical (4)");
    pool_free(b.pool);
    /* a second hinge: no coordinate can make up for five equations too many, so the caret is at a joint */
    b = hmmwv();
    joint(&b, "hinge_more", JOINT_REVOLUTE, "chassis", "lca_rr");
    message = message_of(&b);
    assert_says(message, "impose 11 conditions on body 'lca_rr', 5 more than the 6");
    assert_says(message, "car.veh:112:1: error");
    assert_says(message, "remove joint 'hinge_rr' (revolute, 5)");
    pool_free(b.pool);
}

static void test_over_and_under_determined(void **state)
{
    (void)state;
    Builder b = hmmwv();
    drop_coordinate(&b, 1);
    coordinate(&b, "bar", COORDINATE_LENGTH, "chassis", "lca_rr");
    const char *message = message_of(&b);
    assert_says(message, "impose 7 conditions on body 'lca_rr'");
    assert_says(message, "besides, bodies 'lca_fl', 'wheel_fl' are under-determined");
    pool_free(b.pool);
}

static void test_disconnected(void **state)
{
    (void)state;
    Builder b = hmmwv();
    body(&b, "ballast");
    const char *message = message_of(&b);
    assert_says(message, "car.veh:11:1: error: body 'ballast' is connected to nothing");
    body(&b, "box");
    joint(&b, "lid", JOINT_REVOLUTE, "ballast", "box");
    message = message_of(&b);
    assert_says(message, "bodies 'ballast', 'box' are not connected to the base 'chassis'");
    pool_free(b.pool);
}

/* ---- what is shown to people --------------------------------------------------------------------------- */

static int occurrences(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)); at += strlen(part))
        ++count;
    return count;
}

static void test_table(void **state)
{
    (void)state;
    Builder b = hmmwv();
    Text text = {.pool = b.pool};
    sequence_print(&text, &b.model, sequence_find(b.pool, &b.model));
    assert_says(text.s, "10 bodies, 15 joints, 5 dual coordinates");
    assert_says(text.s, "70 coordinates, 59 equations (49 of joints, 10 normalizations), 11 degrees of freedom");
    assert_int_equal(occurrences(text.s, "stage "), 3);
    assert_int_equal(occurrences(text.s, " 7 x 7 "), 9);
    assert_int_equal(occurrences(text.s, " 1 x 1 "), 1);
    for (const char *line = text.s; *line; line = strchr(line, '\n') + 1)
        assert_true(strchr(line, '\n') - line <= 100);
    pool_free(b.pool);
}

static void test_drawing(void **state)
{
    (void)state;
    Builder b = hmmwv();
    b.model.name = "odd \"name\\";
    Text text = {.pool = b.pool};
    graph_draw(&text, &b.model, sequence_find(b.pool, &b.model));
    assert_says(text.s, "label=\"odd \\\"name\\\\: ");
    /* 15 joints, 5 coordinates, 10 normalizations */
    assert_int_equal(occurrences(text.s, " -- "), 30);
    assert_int_equal(occurrences(text.s, "style=dotted"), 5);
    assert_int_equal(occurrences(text.s, "\\n7\""), 9);
    pool_free(b.pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_under_determined),
        cmocka_unit_test(test_over_determined),
        cmocka_unit_test(test_over_and_under_determined),
        cmocka_unit_test(test_disconnected),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_drawing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
