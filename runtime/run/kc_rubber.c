/* SPDX-License-Identifier: MIT
 * Axles on rubber. A body that bushings alone hold has six coordinates, and what of them, and of others that bend
 * bushings, does not serve for travel follows from the rubber: with the heights z of the wheels' centres given, the
 * energy of the bushings is least. So motions do not depend on which coordinates serve, and stiff bushings move as
 * hinges and balls do. With their stiffness K by coordinates, forces g and z_q = J, a step v of coordinates fulfils K v
 * + J^T lambda = g0 - g,    J v = dz, in which g0 are the forces as set up: preloads do not move the axle. Bushings are
 * linear here (FORMAT.md 7.5). */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/kc.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

enum { ROOM = KC_COLUMNS + KC_WHEELS };

static const double nothing = 1e-9;

bool kc_is_mount(const Model *model, int c)
{
    const Coordinate *one = &model->coordinate[c];
    int alike = 0;
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *other = &model->coordinate[i];
        alike += other->body[0] == one->body[0] && other->body[1] == one->body[1] && !other->driven;
    }
    return alike == 6;
}

/* ---- what follows --------------------------------------------------------------------------------------- */

/* K [n][n] and g [n] by the first n columns, of all bushings. */
static void stiffness_of(const Kc *kc, const KcLook *look, int n, double *K, double *g)
{
    memset(K, 0, (size_t)n * (size_t)n * sizeof *K);
    memset(g, 0, (size_t)n * sizeof *g);
    for (int r = 0; r < kc->rubbers; ++r) {
        const KcRubber *rubber = &kc->rubber[r];
        const KcBent bent = kc_bend(rubber, look);
        double rate[KC_COLUMNS][BUSHING_AXES];
        for (int a = 0; a < n; ++a)
            kc_bend_rate(rubber, &bent, look, a, rate[a]);
        for (int a = 0; a < n; ++a)
            for (int i = 0; i < BUSHING_AXES; ++i) {
                double along = 0; /* of row i of its stiffness */
                for (int k = 0; k < BUSHING_AXES; ++k)
                    along += rubber->stiffness[k * BUSHING_AXES + i] * rate[a][k];
                g[a] += along * bent.q[i];
                for (int b = 0; b < n; ++b)
                    K[a * n + b] += along * rate[b][i];
            }
    }
}

/* The equations above, in coordinates over their ranges and energies over the largest. */
typedef struct Given {
    int wheels, n; /* n: coordinates, travel first */
    double scale[KC_COLUMNS], most;
    double A[ROOM * ROOM];
} Given;

/* lambda [wheels]; NULL: it is not asked for. */
static bool solve(const Given *given, double soft, const double *right, double *out, double *lambda)
{
    const int all = given->n + given->wheels;
    double A[ROOM * ROOM], b[ROOM];
    memcpy(A, given->A, (size_t)all * (size_t)all * sizeof *A);
    for (int a = 0; a < all; ++a) {
        b[a] = a < given->n ? right[a] * given->scale[a] / given->most : right[a];
        if (a < given->n)
            A[a * all + a] += soft;
    }
    if (!kc_solve(all, A, b) || !gic_finite(b, all))
        return false;
    for (int a = 0; a < given->n; ++a)
        out[a] = b[a] * given->scale[a];
    for (int i = 0; lambda && i < given->wheels; ++i)
        lambda[i] = b[given->n + i] * given->most;
    return true;
}

static void prepare(const Kc *kc, const KcAxle *axle, const KcLook *whole, const double *K, Given *given)
{
    given->wheels = axle->wheels;
    given->n = axle->wheels + axle->followers;
    given->most = 0;
    const int n = given->n, all = n + given->wheels;
    for (int a = 0; a < n; ++a) {
        const Coordinate *c = &kc->model->coordinate[whole->column[a]];
        given->scale[a] = c->range[1] - c->range[0];
        given->most = fmax(given->most, K[a * n + a] * given->scale[a] * given->scale[a]);
    }
    memset(given->A, 0, (size_t)all * (size_t)all * sizeof *given->A);
    for (int a = 0; a < n; ++a) {
        for (int b = 0; b < n; ++b)
            given->A[a * all + b] = K[a * n + b] * given->scale[a] * given->scale[b] / given->most;
        for (int i = 0; i < given->wheels; ++i)
            given->A[a * all + n + i] = given->A[(n + i) * all + a] =
                whole->slope[a * whole->outputs + axle->wheel[i].centre + 2] * given->scale[a];
    }
}

/* What nothing holds is not determined: a little stiffness of all coordinates would change it. */
static bool is_determined(const Given *given, const double *right, const double *v)
{
    double other[KC_COLUMNS], most = 0, apart = 0;
    if (!solve(given, 1e-9, right, other, NULL))
        return false;
    for (int a = 0; a < given->n; ++a) {
        most = fmax(most, fabs(v[a]) / given->scale[a]);
        apart = fmax(apart, fabs(other[a] - v[a]) / given->scale[a]);
    }
    return apart <= 1e-3 * most;
}

int kc_follow(const Kc *kc, KcLook *look)
{
    const KcAxle *axle = look->axle;
    const KcLook *whole = look->whole;
    const int wheels = axle->wheels, n = wheels + axle->followers;
    double K[KC_COLUMNS * KC_COLUMNS], g[KC_COLUMNS], V[KC_WHEELS][KC_COLUMNS], right[ROOM] = {0};
    Given given;
    stiffness_of(kc, whole, n, K, g);
    prepare(kc, axle, whole, K, &given);
    for (int a = 0; a < n; ++a)
        right[a] = axle->preload[a] - g[a];
    if (!solve(&given, 0, right, look->relax, NULL))
        return GIC_ERROR_SINGULAR;
    memset(right, 0, sizeof right);
    for (int i = 0; i < wheels; ++i) {
        right[n + i] = 1;
        if (!solve(&given, 0, right, V[i], NULL) || !is_determined(&given, right, V[i]))
            return GIC_ERROR_SINGULAR;
        right[n + i] = 0;
    }
    for (int k = 0; k < wheels; ++k) { /* the motion in which coordinate k of travel alone moves with the rate 1 */
        double A[KC_WHEELS * KC_WHEELS], share[KC_WHEELS] = {0};
        for (int i = 0; i < wheels; ++i)
            for (int j = 0; j < wheels; ++j)
                A[j * wheels + i] = V[i][j];
        share[k] = 1;
        if (!kc_solve(wheels, A, share))
            return GIC_ERROR_SINGULAR;
        for (int j = 0; j < axle->followers; ++j) {
            double sum = 0;
            for (int i = 0; i < wheels; ++i)
                sum += share[i] * V[i][wheels + j];
            look->follow[k * axle->followers + j] = sum;
        }
    }
    return GIC_OK;
}

/* The change of K [n][n] along a motion; second [columns][outputs]: of the look along it. */
static void stiffness_rate(const Kc *kc, const KcLook *look, int n, const double *along, const double *second,
                           double *rate)
{
    double *moved = pool_alloc(kc->pool, ((size_t)kc->outputs + 1) * sizeof *moved); /* rates in the motion */
    for (int k = 0; k < look->columns; ++k)
        for (int i = 0; i < kc->outputs; ++i)
            moved[i] += along[k] * look->slope[k * kc->outputs + i];
    memset(rate, 0, (size_t)n * (size_t)n * sizeof *rate);
    for (int r = 0; r < kc->rubbers; ++r) {
        const KcRubber *rubber = &kc->rubber[r];
        const KcBent bent = kc_bend(rubber, look);
        double by[KC_COLUMNS][BUSHING_AXES], change[KC_COLUMNS][BUSHING_AXES];
        for (int a = 0; a < n; ++a) {
            kc_bend_rate(rubber, &bent, look, a, by[a]);
            kc_bend_second(rubber, &bent, look, a, moved, second + a * kc->outputs, change[a]);
        }
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b)
                for (int i = 0; i < BUSHING_AXES; ++i)
                    for (int k = 0; k < BUSHING_AXES; ++k)
                        rate[a * n + b] += rubber->stiffness[i * BUSHING_AXES + k] *
                                           (change[a][i] * by[b][k] + by[a][i] * change[b][k]);
    }
}

/* A column W of the motions, K W + J^T lambda = 0 with 1 at its own coordinate of travel and 0 at the others, changes
 * by W': K W' + J^T lambda' = -(K' W + J'^T lambda), with 0 at those of travel. J W' is what it becomes. */
int kc_follow_second(const Kc *kc, KcLook *look, const double *along, const double *second)
{
    const KcAxle *axle = look->axle;
    const KcLook *whole = look->whole;
    const int wheels = axle->wheels, followers = axle->followers, n = wheels + followers;
    double K[KC_COLUMNS * KC_COLUMNS], turned[KC_COLUMNS * KC_COLUMNS], g[KC_COLUMNS];
    Given given;
    stiffness_of(kc, whole, n, K, g);
    stiffness_rate(kc, whole, n, along, second, turned);
    prepare(kc, axle, whole, K, &given);
    for (int k = 0; k < wheels; ++k) {
        double W[KC_COLUMNS] = {0}, same[KC_COLUMNS], lambda[KC_WHEELS], right[ROOM] = {0};
        W[k] = 1;
        memcpy(W + wheels, look->follow + k * followers, (size_t)followers * sizeof *W);
        for (int i = 0; i < wheels; ++i)
            for (int a = 0; a < n; ++a)
                right[n + i] += whole->slope[a * whole->outputs + axle->wheel[i].centre + 2] * W[a];
        if (!solve(&given, 0, right, same, lambda))
            return GIC_ERROR_SINGULAR;
        memset(right, 0, sizeof right);
        for (int a = 0; a < n; ++a) {
            for (int b = 0; b < n; ++b)
                right[a] -= turned[a * n + b] * W[b];
            for (int i = 0; i < wheels; ++i)
                right[a] -= second[a * whole->outputs + axle->wheel[i].velocity + 2] * lambda[i];
        }
        if (!solve(&given, 0, right, W, NULL))
            return GIC_ERROR_SINGULAR;
        for (int j = 0; j < followers; ++j) {
            look->bend[k * followers + j] = W[wheels + j];
            for (int m = 0; m < wheels; ++m)
                look->bend[k * followers + j] -= W[m] * look->follow[m * followers + j];
        }
    }
    return GIC_OK;
}

/* Does a coordinate move a wheel of the axle, and bend a bushing? */
static bool is_follower(const Kc *kc, const KcAxle *axle, int c)
{
    bool moves = false, bends = false;
    KcLook *one = kc_look_new(kc, &(KcAxle){.steer = c});
    if (kc_look(kc, kc->initial, one) != GIC_OK)
        return false;
    for (int i = 0; i < axle->wheels; ++i)
        moves =
            moves || norm3(one->slope + axle->wheel[i].velocity) + norm3(one->slope + axle->wheel[i].turn) > nothing;
    for (int r = 0; r < kc->rubbers && moves; ++r) {
        double rate[BUSHING_AXES];
        const KcBent bent = kc_bend(&kc->rubber[r], one);
        kc_bend_rate(&kc->rubber[r], &bent, one, 0, rate);
        bends = bends || norm3(rate) + norm3(rate + 3) > nothing;
    }
    return moves && bends;
}

void kc_find_followers(Kc *kc, KcAxle *axle)
{
    const char *names = "";
    bool on_rubber = false; /* else nothing follows: rubber beside joints */
    for (int c = 0; c < kc->model->coordinates && kc->rubbers && !axle->refusal; ++c) {
        bool is_free = !kc->model->coordinate[c].driven && c != axle->steer;
        for (int k = 0; k < axle->wheels; ++k)
            is_free = is_free && axle->travel[k] != c;
        if (!is_free || !is_follower(kc, axle, c))
            continue;
        if (axle->followers == KC_FOLLOWERS) {
            axle->refusal = "more coordinates of bodies on rubber move its wheels than can be followed";
            return;
        }
        names = pool_print(kc->pool, "%s%s%s", names, axle->followers ? ", " : "", kc->model->coordinate[c].name);
        axle->follower[axle->followers++] = c;
        on_rubber = on_rubber || kc_is_mount(kc->model, c);
    }
    axle->followers = on_rubber ? axle->followers : 0;
    if (!on_rubber)
        return;
    if (kc_rubber_formula(kc)) {
        axle->refusal =
            pool_print(kc->pool,
                       "its wheels hang on rubber, and bushing '%s' has a formula, of which no stiffness is "
                       "known; give it `stiffness`",
                       kc_rubber_formula(kc));
        return;
    }
    axle->preload = pool_alloc(kc->pool, KC_COLUMNS * sizeof *axle->preload);
    KcLook *look = kc_look_new(kc, axle);
    double *K = pool_alloc(kc->pool, KC_COLUMNS * KC_COLUMNS * sizeof *K);
    int status = kc_look(kc, kc->initial, look->whole);
    if (status == GIC_OK)
        stiffness_of(kc, look->whole, axle->wheels + axle->followers, K, axle->preload);
    if (status == GIC_OK)
        status = kc_look(kc, kc->initial, look);
    if (status == GIC_ERROR_SINGULAR)
        axle->refusal = pool_print(
            kc->pool, "its wheels hang on rubber, and the stiffness of bushings does not hold all of %s", names);
}
