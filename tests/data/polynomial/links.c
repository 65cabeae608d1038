/* SPDX-License-Identifier: MIT
 * Code of models/five_link.veh with and without polynomials, as models `exact` and `fitted`, side by side: rates at the
 * same states, and what five links and the spring of a rear wheel measure at the poses of `fitted`, by the points of
 * the model file. Prints the largest differences: of rates relative to the largest rate or 10, of lengths in m; and how
 * many states were compared. */
#include "exact.h"
#include "fitted.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* on the chassis, on the wheel assembly; the last one is the spring */
static const double point[6][2][3] = {{{-1.3398547, 0.4622571, 0.7015942}, {-1.623405, 0.715518, 0.6899}},
                                      {{-1.6118633, 0.4620489, 0.6977638}, {-1.683405, 0.715518, 0.6899}},
                                      {{-1.465699, 0.307086, 0.474}, {-1.623405, 0.786511, 0.35589}},
                                      {{-1.912231, 0.307086, 0.474}, {-1.683405, 0.786511, 0.35589}},
                                      {{-1.465699, 0.416052, 0.532674}, {-1.5186834, 0.8211058, 0.464729}},
                                      {{-1.792851, 0.716026, 0.797088}, {-1.792851, 0.786384, 0.435646}}};
static double own[6][2][3]; /* the same in the frames of the bodies */

static void rotation(const double p[4], double A[3][3])
{
    const double a = p[0], b = p[1], c = p[2], d = p[3];
    const double found[3][3] = {{1 - 2 * (c * c + d * d), 2 * (b * c - a * d), 2 * (b * d + a * c)},
                                {2 * (b * c + a * d), 1 - 2 * (b * b + d * d), 2 * (c * d - a * b)},
                                {2 * (b * d - a * c), 2 * (c * d + a * b), 1 - 2 * (b * b + c * c)}};
    memcpy(A, found, sizeof found);
}

static int body_of(const char *name)
{
    int i = 0;
    while (strcmp(fitted_model.body_name[i], name))
        ++i;
    return i;
}

int main(void)
{
    static exact one;
    static fitted other;
    static double pose[7 * 64];
    double worst = 0, length = 0, left[EXACT_STATE_ROOM], right[EXACT_STATE_ROOM], state[EXACT_STATE_ROOM], A[3][3];
    /* inside, both ends, next to them, beyond them and back; in small steps, and with leaps */
    static const double place[] = {0.37, 0.32, 0.42,       0.3200001,  0.4199999, 0.3199999, 0.318,  0.315,
                                   0.32, 0.37, 0.42,       0.42001,    0.425,     0.43,      0.42,   0.41,
                                   0.43, 0.35, 0.32000001, 0.31999999, 0.31,      0.41999,   0.42001};
    const int body[2] = {body_of("chassis"), body_of("wheel_r_l")};
    int states = 0;
    if (exact_setup(&one) || fitted_setup(&other) || exact_poses(&one, pose))
        return 1;
    for (int i = 0; i < 6; ++i)
        for (int end = 0; end < 2; ++end) {
            const double *q = pose + 7 * body[end];
            rotation(q + 3, A);
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j)
                    own[i][end][k] += A[j][k] * (point[i][end][j] - q[j]);
        }
    memcpy(state, one.state, sizeof state);
    for (size_t n = 0; n < sizeof place / sizeof *place; ++n)
        for (int way = -1; way < 2; ++way) {
            state[EXACT_STATE_SPRING_R_L] = place[n];
            state[EXACT_STATE_SPRING_R_R] = way ? 0.74 - place[n] : 0.37; /* both beyond the range, or one */
            state[EXACT_STATE_SPRING_R_L_RATE] = 0.7 * way;
            state[EXACT_STATE_SPRING_R_R_RATE] = -0.4 * way;
            state[EXACT_STATE_OMEGA_X] = 0.3 * way;
#ifdef STRAIGHT /* right as left, for a scene in which the vehicle moves straight ahead */
            state[EXACT_STATE_SPRING_R_R] = place[n];
            state[EXACT_STATE_SPRING_R_R_RATE] = 0.7 * way;
            state[EXACT_STATE_OMEGA_X] = 0;
#endif
            if (exact_rhs(&one, 0, state, left) || fitted_rhs(&other, 0, state, right))
                return 1;
            double largest = 10;
            for (int i = 0; i < EXACT_STATES; ++i)
                largest = fmax(largest, fabs(left[i]));
            for (int i = 0; i < EXACT_STATES; ++i)
                worst = fmax(worst, fabs(left[i] - right[i]) / largest);
            memcpy(other.state, state, sizeof state);
            if (fitted_poses(&other, pose))
                return 1;
            for (int i = 0; i < 6; ++i) {
                double at[2][3], square = 0, given = 0;
                for (int end = 0; end < 2; ++end) {
                    rotation(pose + 7 * body[end] + 3, A);
                    for (int j = 0; j < 3; ++j)
                        at[end][j] = pose[7 * body[end] + j] + A[j][0] * own[i][end][0] + A[j][1] * own[i][end][1] +
                                     A[j][2] * own[i][end][2];
                }
                for (int j = 0; j < 3; ++j) {
                    square += (at[1][j] - at[0][j]) * (at[1][j] - at[0][j]);
                    given += (point[i][1][j] - point[i][0][j]) * (point[i][1][j] - point[i][0][j]);
                }
                length = fmax(length, fabs(sqrt(square) - (i == 5 ? place[n] : sqrt(given))));
            }
            ++states;
        }
    printf("%.2g %.2g %d\n", worst, length, states);
    return 0;
}
