/* SPDX-License-Identifier: MIT
 * The contribution of a subset's bodies to the equations of motion: moments of mass, forces of the
 * quadratic-velocity terms, and columns and rows of the coordinates that move the bodies. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

static const char *body_name(const Work *w, int b)
{
    return w->model->body[w->first->body[b]].name;
}

static double get_origin(const Work *w, int i, int b, int axis, Ex *formula)
{
    int body = subset_member(w, i)->body[b];
    const double *com = &w->model->body[body].com[axis], *origin = &w->origin[body][axis];
    *formula = tuned_difference(w->model, com, origin);
    return *com - *origin;
}

static double get_mass(const Work *w, int i, int b, int unused, Ex *formula)
{
    const double *mass = &w->model->body[subset_member(w, i)->body[b]].mass;
    (void)unused;
    *formula = tuned_number(w->model, mass);
    return *mass;
}

static double get_inertia(const Work *w, int i, int b, int entry, Ex *formula)
{
    const double *inertia = &w->model->body[subset_member(w, i)->body[b]].inertia[entry];
    *formula = tuned_number(w->model, inertia);
    return *inertia;
}

int inertia_mass(int deps, int j, int k)
{
    return INERTIA_COORDINATE + 7 * deps + j * deps - j * (j - 1) / 2 + (k - j);
}

/* A J A^T in base axes, upper triangle xx yy zz xy xz yz. One diagonal entry J0 is split off as J0 I, which no rotation
 * changes; if two entries are equal (a wheel), it is theirs, so that one more column vanishes. */
static void rotated_inertia(Work *w, int b, const Ex A[9], Ex out[6])
{
    static const char *const entry_name[6] = {"xx", "yy", "zz", "xy", "xz", "yz"};
    Dag *dag = w->dag;
    Ex J[6];
    for (int i = 0; i < 6; ++i)
        ex_describe(dag, J[i] = subset_constant(w, get_inertia, b, i), "%s.J_%s", body_name(w, b), entry_name[i]);
    int spare = J[0] == J[1] ? 0 : J[1] == J[2] ? 1 : 2;
    Ex matrix[3][3] = {{J[0], J[3], J[4]}, {J[3], J[1], J[5]}, {J[4], J[5], J[2]}}, AJ[3][3], common = J[spare];
    for (int i = 0; i < 3; ++i)
        matrix[i][i] = ex_sub(dag, matrix[i][i], common);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            AJ[i][j] = ex_dot(dag, A + 3 * i, matrix[j]);
    static const int entry[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int k = 0; k < 6; ++k) {
        out[k] = ex_dot(dag, AJ[entry[k][0]], A + 3 * entry[k][1]);
        if (k < 3)
            out[k] = ex_add(dag, out[k], common);
    }
}

static void symmetric_apply(Dag *dag, const Ex J[6], const Ex x[3], Ex out[3])
{
    const Ex matrix[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]};
    ex_apply(dag, matrix, x, out);
}

static void accumulate(Dag *dag, Ex *sum, const Ex *more, int count)
{
    for (int i = 0; i < count; ++i)
        sum[i] = ex_add(dag, sum[i], more[i]);
}

/* Add one body to the subset's inertia numbers. Velocities are relative to the inertial frame that moves with the
 * base's origin, and the base's acceleration enters as a = acceleration - gravity: both appear in the equations of the
 * whole vehicle only. Moments are about the base's origin, or about the carrier's reference point. */
static void add_body_inertia(Work *w, int b, const Motion *m, const Ex turn[3], Ex *sum, BodyInertia *body)
{
    Dag *dag = w->dag;
    int deps = m->deps;
    Ex mass = subset_constant(w, get_mass, b, 0), J[6], s[3], arm[3], x[3], at[3], mx[3], t[3], u[3];
    ex_describe(dag, mass, "%s.mass", body_name(w, b));
    rotated_inertia(w, b, m->A, J);
    for (int i = 0; i < 3; ++i)
        ex_describe(dag, s[i] = subset_constant(w, get_origin, b, i), "%s.com_%c", body_name(w, b), "xyz"[i]);
    ex_apply(dag, m->A, s, arm);
    ex_add3(dag, m->c, arm, x);
    memcpy(at, x, sizeof at);
    if (w->first->carrier != BODY_BASE)
        ex_sub3(dag, x, w->known[0].c, x);
    ex_scale3(dag, mass, x, mx);
    accumulate(dag, sum + INERTIA_FIRST, mx, 3);
    Ex xx = ex_mul(dag, mx[0], x[0]), yy = ex_mul(dag, mx[1], x[1]), zz = ex_mul(dag, mx[2], x[2]);
    const Ex second[6] = {ex_add(dag, J[0], ex_add(dag, yy, zz)),      ex_add(dag, J[1], ex_add(dag, xx, zz)),
                          ex_add(dag, J[2], ex_add(dag, xx, yy)),      ex_sub(dag, J[3], ex_mul(dag, mx[0], x[1])),
                          ex_sub(dag, J[4], ex_mul(dag, mx[0], x[2])), ex_sub(dag, J[5], ex_mul(dag, mx[1], x[2]))};
    accumulate(dag, sum + INERTIA_SECOND, second, 6);

    /* acceleration of the centre of mass at zero base and coordinate accelerations:
     * acc + alpha x arm + omega x (omega x arm) + turn x (turn x x + 2 velocity) */
    Ex velocity[3], force[3], whirl[3];
    ex_cross(dag, m->omega, arm, whirl);
    ex_add3(dag, m->velocity, whirl, velocity);
    ex_cross(dag, turn, at, t);
    ex_add3(dag, t, velocity, t);
    ex_add3(dag, t, velocity, t);
    ex_cross(dag, turn, t, force);
    ex_cross(dag, m->omega, whirl, t);
    ex_add3(dag, force, t, force);
    ex_cross(dag, m->alpha, arm, t);
    ex_add3(dag, force, t, force);
    ex_add3(dag, force, m->acceleration, force);
    ex_scale3(dag, mass, force, force);
    /* moment about the centre of mass: J (alpha + turn x omega) + total x (J total) */
    Ex moment[3], total[3];
    ex_cross(dag, turn, m->omega, t);
    ex_add3(dag, m->alpha, t, t);
    symmetric_apply(dag, J, t, moment);
    ex_add3(dag, turn, m->omega, total);
    symmetric_apply(dag, J, total, t);
    ex_cross(dag, total, t, u);
    ex_add3(dag, moment, u, moment);

    body->mass = mass;
    memcpy(body->arm, arm, sizeof arm);
    memcpy(body->at, at, sizeof at);
    memcpy(body->J, J, sizeof J);
    memcpy(body->force, force, sizeof force);
    memcpy(body->moment, moment, sizeof moment);
    accumulate(dag, sum + INERTIA_FORCE, force, 3);
    ex_cross(dag, x, force, t);
    ex_add3(dag, t, moment, t);
    accumulate(dag, sum + INERTIA_MOMENT, t, 3);
    Ex *linear = pool_alloc(w->pool, (size_t)(6 * deps + 1) * sizeof *linear), *angular = linear + 3 * deps;
    for (int j = 0; j < deps; ++j) {
        Ex v[3], mv[3], Jw[3], *own = sum + INERTIA_COORDINATE + 7 * j;
        const Ex *S = m->S + 6 * j;
        ex_cross(dag, S, arm, t);
        ex_add3(dag, S + 3, t, v);
        ex_scale3(dag, mass, v, mv);
        symmetric_apply(dag, J, S, Jw);
        ex_cross(dag, x, mv, t);
        ex_add3(dag, t, Jw, t);
        accumulate(dag, own, mv, 3);
        accumulate(dag, own + 3, t, 3);
        own[6] = ex_add(dag, own[6], ex_add(dag, ex_dot(dag, v, force), ex_dot(dag, S, moment)));
        memcpy(linear + 3 * j, v, sizeof v);
        memcpy(angular + 3 * j, S, 3 * sizeof *S);
        for (int i = 0; i <= j; ++i) {
            Ex *M = &sum[inertia_mass(deps, i, j)];
            *M = ex_add(dag, *M, ex_add(dag, ex_dot(dag, linear + 3 * i, mv), ex_dot(dag, angular + 3 * i, Jw)));
        }
    }
}

Ex *subset_inertia(Work *w, const Layout *layout, const Motion *motion, BodyInertia *body)
{
    Dag *dag = w->dag;
    bool free_base = w->model->free_base;
    Ex turn[3] = {0}, *sum = pool_alloc(w->pool, (size_t)(layout->inertia_size + 1) * sizeof *sum);
    for (int i = 0; free_base && i < 3; ++i)
        turn[i] = ex_input(dag, element_at(ARRAY_turn, i), NULL);
    for (int b = 0; b < w->first->bodies; ++b)
        add_body_inertia(w, b, &motion[b], turn, sum, &body[b]);
    return sum;
}
