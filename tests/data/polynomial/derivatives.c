/* SPDX-License-Identifier: MIT
 * Derivatives of models/five_link.veh with and without polynomials, as models `exact` and `fitted`: all columns of
 * both at the same states, inside the range, at its ends and beyond; those of `fitted` also against central differences
 * of its rates. Prints the largest differences relative to the largest of a column, and how many states were compared.
 */
#include "exact.h"
#include "fitted.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    static exact one;
    static fitted other;
    static exact_direction left_work;
    static fitted_direction right_work;
    static double left[EXACT_STATES * EXACT_JACOBIAN_COLUMNS], right[EXACT_STATES * EXACT_JACOBIAN_COLUMNS];
    double worst = 0, by_difference = 0, state[EXACT_STATE_ROOM], rate[2][EXACT_STATE_ROOM];
    static const double place[] = {0.37, 0.34, 0.41, 0.3201, 0.4199, 0.315, 0.425, 0.36};
    int states = 0;
    if (exact_setup(&one) || fitted_setup(&other))
        return 1;
    memcpy(state, one.state, sizeof state);
    for (size_t n = 0; n < sizeof place / sizeof *place; ++n)
        for (int way = -1; way < 2; ++way) {
            state[EXACT_STATE_SPRING_R_L] = place[n];
            state[EXACT_STATE_SPRING_R_R] = way ? 0.74 - place[n] : 0.37;
            state[EXACT_STATE_SPRING_R_L_RATE] = 0.05 * way;
            state[EXACT_STATE_SPRING_R_R_RATE] = -0.04 * way;
            state[EXACT_STATE_OMEGA_X] = 0.3 * way;
            if (exact_jacobian(&one, 0, state, &left_work, left) ||
                fitted_jacobian(&other, 0, state, &right_work, right))
                return 1;
            for (int c = 0; c < EXACT_JACOBIAN_COLUMNS; ++c) {
                double largest = 1;
                for (int r = 0; r < EXACT_STATES; ++r)
                    largest = fmax(largest, fabs(left[EXACT_JACOBIAN_COLUMNS * r + c]));
                for (int r = 0; r < EXACT_STATES; ++r) {
                    const int at = EXACT_JACOBIAN_COLUMNS * r + c;
                    worst = fmax(worst, fabs(left[at] - right[at]) / largest);
                }
            }
            /* by a spring's length and by its rate */
            static const int of[] = {FITTED_STATE_SPRING_R_L, FITTED_STATE_SPRING_R_L_RATE};
            for (int i = 0; i < 2; ++i) {
                const double by = 1e-5, before = state[of[i]];
                double largest = 1;
                for (int end = 0; end < 2; ++end) {
                    state[of[i]] = before + (end ? by : -by);
                    if (fitted_rhs(&other, 0, state, rate[end]))
                        return 1;
                }
                state[of[i]] = before;
                for (int r = 0; r < EXACT_STATES; ++r)
                    largest = fmax(largest, fabs(right[EXACT_JACOBIAN_COLUMNS * r + of[i]]));
                for (int r = 0; r < EXACT_STATES; ++r) {
                    const double slope = (rate[1][r] - rate[0][r]) / (2 * by);
                    by_difference =
                        fmax(by_difference, fabs(slope - right[EXACT_JACOBIAN_COLUMNS * r + of[i]]) / largest);
                }
            }
            ++states;
        }
    /* 0.2 s by implicit steps from where the springs are not in balance */
    double apart = 0;
    memcpy(other.state, state, sizeof state);
    memcpy(one.state, state, sizeof state);
    for (int n = 0; n < 100; ++n)
        if (exact_step(&one, 0.002, GIC_ROS3) || fitted_step(&other, 0.002, GIC_ROS3))
            return 1;
    for (int i = 0; i < EXACT_STATES; ++i)
        apart = fmax(apart, fabs(one.state[i] - other.state[i]));
    printf("%.2g %.2g %d %.2g\n", worst, by_difference, states, apart);
    return 0;
}
