/* SPDX-License-Identifier: MIT
 * The computational sequence against sequences derived by hand, and against brute force on small random models. */
#include "base/pool.h"
#include "base/random.h"
#include "model/model.h"
#include "sequence/sequence.h"

#include "topology.h"

/* ---- what is asserted ------------------------------------------------------------------------------ */

static const Subset *subset_with(const Builder *b, const Sequence *sequence, const char *name)
{
    return &sequence->subset[sequence->body_subset[find_body(b, name)]];
}

static int class_with(const Builder *b, const Sequence *sequence, const char *name)
{
    return subset_with(b, sequence, name)->class;
}

static bool lists(const int *list, int count, int value)
{
    for (int i = 0; i < count; ++i)
        if (list[i] == value)
            return true;
    return false;
}

/* Unknowns minus equations as the paper counts: 7 a body, a normalization a body. */
static int weight_of(const Model *model, const Subset *subset)
{
    int weight = 6 * subset->bodies - subset->coordinates;
    for (int i = 0; i < subset->joints; ++i)
        weight -= joint_equations[model->joint[subset->joint[i]].type];
    return weight;
}

/* What must hold of any sequence: it yields every body and uses every equation once, subsets are square, refer only to
 * what is solved in an earlier stage, list their knowns and dependences, and are named by distinct identifiers. */
static void assert_consistent(const Model *model, const Sequence *sequence)
{
    int bodies = 0, joints = 0, coordinates = 0;
    for (int i = model->free_base; i < sequence->subsets; ++i) {
        const Subset *s = &sequence->subset[i];
        bodies += s->bodies;
        joints += s->joints;
        coordinates += s->coordinates;
        assert_int_equal(weight_of(model, s), 0);
        int latest = model->free_base ? 1 : 0, referred = 0;
        for (int k = 0; k < s->joints + s->coordinates; ++k) {
            const int *end =
                k < s->joints ? model->joint[s->joint[k]].body : model->coordinate[s->coordinate[k - s->joints]].body;
            assert_true(lists(s->body, s->bodies, end[0]) || lists(s->body, s->bodies, end[1]));
            for (int e = 0; e < 2; ++e)
                if (end[e] > 0 && !lists(s->body, s->bodies, end[e])) {
                    assert_true(lists(s->known, s->knowns, end[e]));
                    int stage = sequence->subset[sequence->body_subset[end[e]]].stage;
                    latest = stage > latest ? stage : latest;
                }
        }
        assert_int_equal(s->stage, latest + 1);
        for (int k = 0; k < s->knowns; ++k) {
            const Subset *known = &sequence->subset[sequence->body_subset[s->known[k]]];
            assert_true(known->stage < s->stage);
            for (int d = 0; d < known->deps; ++d)
                assert_true(lists(s->dep, s->deps, known->dep[d]));
            referred += known->deps;
        }
        assert_true(s->deps <= referred + s->coordinates);
        for (int d = 0; d < s->deps; ++d) {
            assert_false(lists(s->dep, d, s->dep[d]));
            if (d < s->coordinates)
                assert_int_equal(s->dep[d], s->coordinate[d]);
        }
        assert_true(lists(sequence->class[s->class].member, sequence->class[s->class].members, i));
        assert_true(i == 0 || sequence->subset[i - 1].stage <= s->stage);
    }
    assert_int_equal(bodies, model->bodies - 1);
    assert_int_equal(joints, model->joints);
    assert_int_equal(coordinates, model->coordinates);
    for (int i = 0; i < sequence->classes; ++i) {
        assert_true(strlen(sequence->class[i].name) <= 40);
        for (int k = 0; k < i; ++k)
            assert_string_not_equal(sequence->class[i].name, sequence->class[k].name);
    }
}

/* Position of a body among the bodies (from 0), knowns (from 100) or elsewhere (base: -1) of a subset. */
static int local_of(const Subset *s, int index)
{
    for (int i = 0; i < s->bodies; ++i)
        if (s->body[i] == index)
            return index == 0 ? -1 : i;
    for (int i = 0; i < s->knowns; ++i)
        if (s->known[i] == index)
            return 100 + i;
    return -1;
}

/* Members of a class correspond position by position. */
static void assert_corresponding(const Model *model, const Sequence *sequence)
{
    for (int c = 0; c < sequence->classes; ++c)
        for (int m = 1; m < sequence->class[c].members; ++m) {
            const Subset *a = &sequence->subset[sequence->class[c].member[0]];
            const Subset *b = &sequence->subset[sequence->class[c].member[m]];
            assert_int_equal(a->bodies, b->bodies);
            assert_int_equal(a->knowns, b->knowns);
            assert_int_equal(a->joints, b->joints);
            assert_int_equal(a->coordinates, b->coordinates);
            assert_int_equal(a->deps, b->deps);
            for (int i = 0; i < a->joints; ++i) {
                const Joint *x = &model->joint[a->joint[i]], *y = &model->joint[b->joint[i]];
                assert_int_equal(x->type, y->type);
                for (int k = 0; k < 2; ++k)
                    assert_int_equal(local_of(a, x->body[k]), local_of(b, y->body[k]));
            }
            for (int i = 0; i < a->coordinates; ++i) {
                const Coordinate *x = &model->coordinate[a->coordinate[i]], *y = &model->coordinate[b->coordinate[i]];
                assert_int_equal(x->type, y->type);
                for (int k = 0; k < 2; ++k)
                    assert_int_equal(local_of(a, x->body[k]), local_of(b, y->body[k]));
            }
            for (int i = 0; i < a->knowns; ++i) {
                const Subset *x = &sequence->subset[sequence->body_subset[a->known[i]]];
                const Subset *y = &sequence->subset[sequence->body_subset[b->known[i]]];
                assert_int_equal(x->deps, y->deps);
                for (int d = 0; d < x->deps; ++d)
                    for (int at = 0; at < a->deps; ++at)
                        assert_int_equal(a->dep[at] == x->dep[d], b->dep[at] == y->dep[d]);
            }
        }
}

static const Sequence *solve(Builder *b)
{
    const Sequence *sequence = sequence_find(b->pool, &b->model);
    assert_consistent(&b->model, sequence);
    assert_corresponding(&b->model, sequence);
    return sequence;
}

/* ---- sequences derived by hand --------------------------------------------------------------------- */

static void test_hmmwv(void **state)
{
    (void)state;
    Builder b = hmmwv();
    const Sequence *s = solve(&b);
    assert_int_equal(s->unknowns, 70);
    assert_int_equal(s->equations, 59);
    assert_int_equal(s->dof, 11);
    assert_int_equal(s->stages, 3);
    assert_int_equal(s->subsets, 10);
    assert_int_equal(s->subset[0].stage, 1);
    assert_int_equal(s->subset[0].bodies, 1);
    assert_int_equal(s->subset[0].body[0], BODY_BASE);
    assert_int_equal(s->subset[0].class, -1);
    for (int i = 1; i < b.model.bodies; ++i) {
        const Subset *subset = &s->subset[s->body_subset[i]];
        assert_int_equal(subset->bodies, 1);
        assert_int_equal(subset->stage, i <= 5 ? 2 : 3);
    }
    const Subset *front = subset_with(&b, s, "wheel_fr");
    assert_int_equal(front->knowns, 2);
    assert_true(lists(front->known, 2, find_body(&b, "lca_fr")) && lists(front->known, 2, find_body(&b, "rack")));
    assert_int_equal(front->deps, 2);
    assert_int_equal(subset_with(&b, s, "wheel_rr")->knowns, 1);
    /* four arms, rack, two front wheels, two rear wheels */
    assert_int_equal(s->classes, 4);
    assert_int_equal(s->class[class_with(&b, s, "lca_fl")].members, 4);
    assert_int_equal(s->class[class_with(&b, s, "rack")].members, 1);
    assert_int_equal(s->class[class_with(&b, s, "wheel_fl")].members, 2);
    assert_int_equal(class_with(&b, s, "wheel_fl"), class_with(&b, s, "wheel_fr"));
    assert_int_equal(class_with(&b, s, "wheel_rl"), class_with(&b, s, "wheel_rr"));
    assert_string_equal(s->class[class_with(&b, s, "lca_rr")].name, "lca_fl");
    assert_string_equal(s->class[class_with(&b, s, "wheel_rr")].name, "wheel_rl");
    pool_free(b.pool);
}

static void test_classes_tell_ends_but_not_drives(void **state)
{
    (void)state;
    Builder b = hmmwv();
    b.model.coordinate[2].driven = true; /* spring of lca_fr */
    const Sequence *s = solve(&b);
    assert_int_equal(s->class[class_with(&b, s, "lca_fl")].members, 4);
    b.model.joint[1].body[0] = find_body(&b, "lca_fl"); /* hinge_fl, written the other way round */
    b.model.joint[1].body[1] = BODY_BASE;
    s = solve(&b);
    assert_int_equal(s->class[class_with(&b, s, "lca_fl")].members, 1);
    assert_int_equal(s->class[class_with(&b, s, "lca_fr")].members, 3);
    assert_int_equal(class_with(&b, s, "wheel_fl"), class_with(&b, s, "wheel_fr"));
    pool_free(b.pool);
}

static void test_classes_tell_wiring(void **state)
{
    (void)state;
    /* a trailing arm hangs on an arm; wheels with a ball joint on one of the two and a rod to the other */
    Builder b = start("chassis");
    body(&b, "arm");
    body(&b, "trail");
    joint(&b, "hinge", JOINT_REVOLUTE, "chassis", "arm");
    coordinate(&b, "spring", COORDINATE_LENGTH, "chassis", "arm");
    joint(&b, "hinge_trail", JOINT_REVOLUTE, "arm", "trail");
    coordinate(&b, "spring_trail", COORDINATE_LENGTH, "chassis", "trail");
    static const char *const name[] = {"w0", "w1", "w2"};
    for (int i = 0; i < 3; ++i) {
        body(&b, name[i]);
        joint(&b, pool_print(b.pool, "ball%d", i), JOINT_SPHERICAL, i == 1 ? "trail" : "arm", name[i]);
        joint(&b, pool_print(b.pool, "link%d", i), JOINT_REVOLUTE_SPHERICAL, "chassis", name[i]);
        joint(&b, pool_print(b.pool, "rod%d", i), JOINT_DISTANCE, i == 1 ? "arm" : "trail", name[i]);
    }
    const Sequence *s = solve(&b);
    assert_int_equal(s->classes, 4);
    assert_int_equal(class_with(&b, s, "w0"), class_with(&b, s, "w2"));
    assert_int_not_equal(class_with(&b, s, "w0"), class_with(&b, s, "w1"));
    pool_free(b.pool);
}

enum { SIDES = 8 };

static void test_classes_are_found_in_any_order(void **state)
{
    (void)state;
    /* five links, two of them written from the wheel, which two differs from wheel to wheel */
    Builder b = start("chassis");
    for (int k = 0; k < SIDES; ++k) {
        const char *wheel = pool_print(b.pool, "wheel%d", k);
        body(&b, wheel);
        for (int i = 0; i < 5; ++i) {
            bool reversed = (i + k) % 5 < 2;
            joint(&b, pool_print(b.pool, "link%d_%d", i, k), JOINT_DISTANCE, reversed ? wheel : "chassis",
                  reversed ? "chassis" : wheel);
        }
        coordinate(&b, pool_print(b.pool, "spring%d", k), COORDINATE_LENGTH, "chassis", wheel);
    }
    assert_int_equal(solve(&b)->classes, 1);
    pool_free(b.pool);
    /* two arms alike. With the tie rod on the knuckle no colour tells them apart: choosing one must choose its joints
     * too. With a rod from one to the other only the ends of the rod tell them apart. */
    for (int rod_between_arms = 0; rod_between_arms < 2; ++rod_between_arms) {
        b = start("chassis");
        for (int k = 0; k < SIDES; ++k) {
            const char *knuckle = pool_print(b.pool, "knuckle%d", k);
            const char *arm[2] = {pool_print(b.pool, "upper%d", k), pool_print(b.pool, "lower%d", k)};
            body(&b, knuckle);
            for (int i = 0; i < 2; ++i)
                body(&b, arm[(i + k) % 2]);
            for (int i = 0; i < 2; ++i)
                joint(&b, pool_print(b.pool, "hinge%d_%d", i, k), JOINT_REVOLUTE, "chassis", arm[(i + k / 2) % 2]);
            for (int i = 0; i < 2; ++i)
                joint(&b, pool_print(b.pool, "ball%d_%d", i, k), JOINT_SPHERICAL, arm[(i + k / 4) % 2], knuckle);
            joint(&b, pool_print(b.pool, "rod%d", k), JOINT_DISTANCE, rod_between_arms ? arm[0] : "chassis",
                  rod_between_arms ? arm[1] : knuckle);
            coordinate(&b, pool_print(b.pool, "spring%d", k), COORDINATE_LENGTH, "chassis", knuckle);
        }
        const Sequence *s = solve(&b);
        assert_int_equal(s->subsets, 1 + SIDES);
        assert_int_equal(s->classes, 1);
        pool_free(b.pool);
    }
}

static void test_five_link_axle(void **state)
{
    (void)state;
    Builder b = start("chassis");
    static const char *const side[] = {"l", "r"};
    for (int k = 0; k < 2; ++k) {
        const char *wheel = corner_name(&b, "wheel", side[k]);
        body(&b, wheel);
        for (int i = 0; i < 5; ++i)
            joint(&b, pool_print(b.pool, "link%d_%s", i, side[k]), JOINT_DISTANCE, "chassis", wheel);
        coordinate(&b, corner_name(&b, "spring", side[k]), COORDINATE_LENGTH, "chassis", wheel);
    }
    const Sequence *s = solve(&b);
    assert_int_equal(s->subsets, 3);
    assert_int_equal(s->stages, 2);
    assert_int_equal(s->dof, 8);
    assert_int_equal(s->classes, 1);
    assert_int_equal(subset_with(&b, s, "wheel_l")->joints, 5);
    pool_free(b.pool);
}

static void test_double_wishbone(void **state)
{
    (void)state;
    /* spring on the lower arm: 5 + 1 equations determine it alone; then upper arm and knuckle, 5 + 3 + 3 + 1 */
    Builder b = double_wishbone("upper", "knuckle", "lower");
    const Sequence *s = solve(&b);
    assert_int_equal(s->stages, 3);
    assert_int_equal(s->subsets, 3);
    assert_int_equal(subset_with(&b, s, "lower")->stage, 2);
    const Subset *pair = subset_with(&b, s, "knuckle");
    assert_ptr_equal(pair, subset_with(&b, s, "upper"));
    assert_int_equal(pair->bodies, 2);
    assert_int_equal(pair->joints, 4);
    assert_int_equal(pair->coordinates, 0);
    assert_int_equal(pair->knowns, 1);
    assert_int_equal(pair->deps, 1);
    assert_string_equal(s->class[pair->class].name, "upper_knuckle"); /* 5 equations to the chassis, against 4 */
    pool_free(b.pool);
    /* spring on the knuckle: 5, 5 and 8 equations, nothing can be solved alone */
    b = double_wishbone("upper", "knuckle", "knuckle");
    s = solve(&b);
    assert_int_equal(s->stages, 2);
    assert_int_equal(s->subsets, 2);
    assert_int_equal(subset_with(&b, s, "lower")->bodies, 3);
    assert_int_equal(subset_with(&b, s, "lower")->deps, 1);
    pool_free(b.pool);
}

static void test_solid_axle(void **state)
{
    (void)state;
    /* four links and two springs: 4 + 2 equations, a 7 x 7 */
    Builder b = start("chassis");
    body(&b, "axle");
    static const char *const link[] = {"lower_l", "lower_r", "upper_l", "upper_r"};
    for (int i = 0; i < 4; ++i)
        joint(&b, link[i], JOINT_DISTANCE, "chassis", "axle");
    coordinate(&b, "spring_l", COORDINATE_LENGTH, "chassis", "axle");
    coordinate(&b, "spring_r", COORDINATE_LENGTH, "chassis", "axle");
    const Sequence *s = solve(&b);
    assert_int_equal(s->subsets, 2);
    assert_int_equal(s->dof, 8);
    assert_int_equal(subset_with(&b, s, "axle")->deps, 2);
    pool_free(b.pool);
}

static void test_pendulum(void **state)
{
    (void)state;
    Builder b = chain(1);
    const Sequence *s = solve(&b);
    assert_int_equal(s->unknowns, 7);
    assert_int_equal(s->equations, 6);
    assert_int_equal(s->dof, 1);
    assert_int_equal(s->stages, 1);
    assert_int_equal(s->subsets, 1);
    assert_int_equal(s->body_subset[BODY_BASE], -1);
    assert_int_equal(s->subset[0].knowns, 0);
    pool_free(b.pool);
}

static void test_chain(void **state)
{
    (void)state;
    Builder b = chain(3);
    const Sequence *s = solve(&b);
    assert_int_equal(s->stages, 3);
    assert_int_equal(s->dof, 3);
    assert_int_equal(s->classes, 3); /* the first has no known body, the third depends on more than the second */
    const Subset *last = subset_with(&b, s, "link3");
    assert_int_equal(last->stage, 3);
    assert_int_equal(last->knowns, 1);
    assert_int_equal(last->known[0], 2);
    assert_int_equal(last->deps, 3);
    for (int i = 0; i < 3; ++i)
        assert_int_equal(last->dep[i], 2 - i);
    pool_free(b.pool);
}

static void test_base_alone(void **state)
{
    (void)state;
    Builder b = start("chassis");
    const Sequence *s = solve(&b);
    assert_int_equal(s->subsets, 1);
    assert_int_equal(s->stages, 1);
    assert_int_equal(s->dof, 6);
    pool_free(b.pool);
}

static void test_long_chains(void **state)
{
    (void)state;
    enum { LINKS = 5000 };
    for (int shuffled = 0; shuffled < 2; ++shuffled) {
        Builder b = chain(LINKS);
        Random random = {7};
        for (int i = LINKS - 1; shuffled && i > 0; --i) {
            int k = (int)(random_bits(&random) % (uint64_t)(i + 1));
            Joint other = b.model.joint[k];
            b.model.joint[k] = b.model.joint[i];
            b.model.joint[i] = other;
        }
        const Sequence *s = sequence_find(b.pool, &b.model);
        assert_int_equal(s->stages, LINKS);
        assert_int_equal(s->subset[LINKS - 1].body[0], LINKS);
        assert_int_equal(s->subset[LINKS - 1].deps, LINKS);
        pool_free(b.pool);
    }
}

static void test_names_of_classes(void **state)
{
    (void)state;
    /* the pair {up, knuckle} and a body of that name; neither name may occur twice */
    Builder b = double_wishbone("up", "knuckle", "lower");
    body(&b, "up_knuckle");
    joint(&b, "slide", JOINT_PRISMATIC, "chassis", "up_knuckle");
    coordinate(&b, "way", COORDINATE_TRANSLATION, "chassis", "up_knuckle");
    const Sequence *s = solve(&b);
    assert_string_equal(s->class[class_with(&b, s, "up_knuckle")].name, "up_knuckle");
    assert_string_equal(s->class[class_with(&b, s, "up")].name, "up_knuckle_2");
    pool_free(b.pool);
    b = double_wishbone("upper_with_a_name_of_exactly_forty_lette", "knuckle", "lower");
    s = solve(&b);
    assert_string_equal(s->class[class_with(&b, s, "knuckle")].name, "upper_with_a_name_of_exactly_forty_lette");
    pool_free(b.pool);
}

/* ---- order of the file ------------------------------------------------------------------------------- */

/* The same model with bodies (but the base), joints and coordinates in another order. */
static Builder shuffle(const Builder *from, Random *random)
{
    Builder b = {.pool = pool_new(), .model = from->model};
    Model *m = &b.model;
    m->body = pool_grow(b.pool, m->body, (size_t)m->bodies * sizeof *m->body, (size_t)m->bodies * sizeof *m->body);
    m->joint = pool_grow(b.pool, m->joint, (size_t)m->joints * sizeof *m->joint, (size_t)m->joints * sizeof *m->joint);
    m->coordinate = pool_grow(b.pool, m->coordinate, (size_t)m->coordinates * sizeof *m->coordinate,
                              (size_t)m->coordinates * sizeof *m->coordinate);
    for (int i = m->bodies - 1; i > 1; --i) {
        int k = 1 + (int)(random_bits(random) % (uint64_t)i);
        Body other = m->body[k];
        m->body[k] = m->body[i];
        m->body[i] = other;
    }
    for (int i = m->joints - 1; i > 0; --i) {
        int k = (int)(random_bits(random) % (uint64_t)(i + 1));
        Joint other = m->joint[k];
        m->joint[k] = m->joint[i];
        m->joint[i] = other;
    }
    for (int i = m->coordinates - 1; i > 0; --i) {
        int k = (int)(random_bits(random) % (uint64_t)(i + 1));
        Coordinate other = m->coordinate[k];
        m->coordinate[k] = m->coordinate[i];
        m->coordinate[i] = other;
    }
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < m->joints; ++i)
            m->joint[i].body[k] = find_body(&b, from->model.body[m->joint[i].body[k]].name);
        for (int i = 0; i < m->coordinates; ++i)
            m->coordinate[i].body[k] = find_body(&b, from->model.body[m->coordinate[i].body[k]].name);
    }
    return b;
}

/* All lists of all subsets, by name: in their order, and again whatever the order of the file. */
static void assert_same_subsets(const Builder *a, const Sequence *s, const Builder *b, const Sequence *t)
{
    assert_int_equal(s->subsets, t->subsets);
    assert_int_equal(s->classes, t->classes);
    for (int i = 0; i < s->subsets; ++i) {
        const Subset *x = &s->subset[i], *y = subset_with(b, t, a->model.body[x->body[0]].name);
        assert_int_equal(x->stage, y->stage);
        assert_int_equal(x->bodies, y->bodies);
        assert_int_equal(x->knowns, y->knowns);
        assert_int_equal(x->joints, y->joints);
        assert_int_equal(x->coordinates, y->coordinates);
        assert_int_equal(x->deps, y->deps);
        for (int k = 0; k < x->bodies; ++k)
            assert_string_equal(a->model.body[x->body[k]].name, b->model.body[y->body[k]].name);
        for (int k = 0; k < x->knowns; ++k)
            assert_string_equal(a->model.body[x->known[k]].name, b->model.body[y->known[k]].name);
        for (int k = 0; k < x->joints; ++k)
            assert_string_equal(a->model.joint[x->joint[k]].name, b->model.joint[y->joint[k]].name);
        for (int k = 0; k < x->coordinates; ++k)
            assert_string_equal(a->model.coordinate[x->coordinate[k]].name, b->model.coordinate[y->coordinate[k]].name);
        for (int k = 0; k < x->deps; ++k)
            assert_string_equal(a->model.coordinate[x->dep[k]].name, b->model.coordinate[y->dep[k]].name);
    }
}

static void test_order_of_file_is_indifferent(void **state)
{
    (void)state;
    Random random = {1};
    for (int which = 0; which < 3; ++which) {
        Builder a = which == 0 ? hmmwv() : double_wishbone("upper", "knuckle", which == 1 ? "lower" : "knuckle");
        if (which == 2) /* else the two arms are alike, and no order can tell them */
            a.model.joint[0].type = JOINT_PRISMATIC;
        const Sequence *s = solve(&a);
        for (int i = 0; i < 20; ++i) {
            Builder b = shuffle(&a, &random);
            assert_same_subsets(&a, s, &b, solve(&b));
            pool_free(b.pool);
        }
        pool_free(a.pool);
    }
}

/* ---- brute force ------------------------------------------------------------------------------------- */

/* Equations that touch no moving bodies but those of `set` (bit i: body i), at least one of them. */
static int equations_within(const Model *model, unsigned set)
{
    int equations = 0;
    for (int i = 0; i < model->joints + model->coordinates; ++i) {
        const int *end = i < model->joints ? model->joint[i].body : model->coordinate[i - model->joints].body;
        unsigned ends = (1u << end[0] | 1u << end[1]) & ~1u;
        if (!(ends & ~set))
            equations += i < model->joints ? joint_equations[model->joint[i].type] : 1;
    }
    return equations;
}

static int bits(unsigned set)
{
    int count = 0;
    for (; set; set &= set - 1)
        ++count;
    return count;
}

/* Hall's condition says whether a sequence exists; a body belongs to the least closed set that holds it and has as many
 * equations as unknowns, and two bodies to one subset when these least sets are the same. */
static void test_random_models_against_brute_force(void **state)
{
    (void)state;
    Random random = {3};
    int sound = 0, over = 0;
    for (int trial = 0; trial < 400; ++trial) {
        Builder b = start(trial % 2 ? "ground" : "chassis");
        int moving = 2 + (int)(random_bits(&random) % 4), left = 6 * moving;
        for (int i = 1; i <= moving; ++i)
            body(&b, pool_print(b.pool, "b%d", i));
        for (int edge = 0; left > 0; ++edge) {
            JointType type = (JointType)(random_bits(&random) % JOINT_TYPES);
            /* the first edges reach every body, so that most models hang together */
            int to = edge < moving ? edge + 1 : 1 + (int)(random_bits(&random) % (uint64_t)moving);
            int from = (int)(random_bits(&random) % (uint64_t)(edge < moving ? to : moving + 1));
            if (from == to)
                from = 0;
            const char *a = b.model.body[from].name, *c = b.model.body[to].name;
            const char *name = pool_print(b.pool, "e%d", edge);
            if (joint_equations[type] <= left && random_bits(&random) % 4) {
                joint(&b, name, type, a, c);
                left -= joint_equations[type];
            } else {
                coordinate(&b, name, COORDINATE_LENGTH, a, c);
                left -= 1;
            }
        }
        unsigned all = (1u << (moving + 1)) - 2, least[8];
        bool solvable = true;
        for (unsigned set = 2; set <= all; set += 2)
            solvable &= equations_within(&b.model, set) <= 6 * bits(set);
        if (!solvable) {
            ++over;
            const char *message = message_of(&b);
            assert_says(message, strstr(message, "connected to") ? "connected to" : " conditions on bod");
            pool_free(b.pool);
            continue;
        }
        ++sound;
        const Sequence *s = solve(&b);
        for (int i = 1; i <= moving; ++i) {
            least[i] = all;
            for (unsigned set = 2; set <= all; set += 2)
                if ((set >> i & 1) && equations_within(&b.model, set) == 6 * bits(set))
                    least[i] &= set;
        }
        for (int i = 1; i <= moving; ++i)
            for (int k = 1; k <= moving; ++k)
                assert_int_equal(s->body_subset[i] == s->body_subset[k], least[i] == least[k]);
        pool_free(b.pool);
    }
    assert_true(sound > 50 && over > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hmmwv),
        cmocka_unit_test(test_classes_tell_ends_but_not_drives),
        cmocka_unit_test(test_classes_tell_wiring),
        cmocka_unit_test(test_classes_are_found_in_any_order),
        cmocka_unit_test(test_five_link_axle),
        cmocka_unit_test(test_double_wishbone),
        cmocka_unit_test(test_solid_axle),
        cmocka_unit_test(test_pendulum),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_base_alone),
        cmocka_unit_test(test_long_chains),
        cmocka_unit_test(test_names_of_classes),
        cmocka_unit_test(test_order_of_file_is_indifferent),
        cmocka_unit_test(test_random_models_against_brute_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
