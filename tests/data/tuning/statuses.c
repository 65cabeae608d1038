/* SPDX-License-Identifier: MIT
 * What set-up says to parameters: good ones, ones that make the geometry impossible, ones that no mechanism fits, and
 * ones that change behind its back. Double or single precision. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "car.h"
#include "hand.h"

static int failures;

static void check(int good, const char *what)
{
    if (!good) {
        printf("FAIL %s\n", what);
        ++failures;
    }
}

/* Is `part` in `text`, which may be NULL? */
static int says(const char *text, const char *part)
{
    return text && strstr(text, part);
}

/* Set up the hand with one parameter changed. */
static int hand_with(hand *self, int parameter, double value)
{
    hand_setup(self);
    self->parameter[parameter] = (gic_real)value;
    return hand_setup_with(self, self->parameter);
}

static void check_hand(void)
{
    static const struct {
        int parameter;
        double value;
        const char *text;
    } impossible[] = {
        {HAND_PARAMETER_CAP, 0, "mass of body 'cap' must be greater than zero"},
        {HAND_PARAMETER_CAP, -1, "mass of body 'cap' must be greater than zero"},
        {HAND_PARAMETER_ROD, 0, "length of joint 'left' must be greater than zero"},
        {HAND_PARAMETER_TURN, 20, "inertia of body 'arm' must be positive definite"},
        {HAND_PARAMETER_REACH, 5, "inertia of body 'arm': no principal value"},
        {HAND_PARAMETER_TURN, -4, "axes of joint 'wrist' must be near perpendicular"},
    };
    static hand self;
    gic_real rate[HAND_STATES], rod;
    check(hand_setup(&self) == GIC_OK && !hand_status_condition(&self), "the file's values");
    for (size_t i = 0; i < sizeof impossible / sizeof *impossible; ++i) {
        int status = hand_with(&self, impossible[i].parameter, impossible[i].value);
        if (status != GIC_ERROR_GEOMETRY || !says(hand_status_condition(&self), impossible[i].text)) {
            printf("FAIL %s: status %d, %s\n", impossible[i].text, status,
                   hand_status_condition(&self) ? hand_status_condition(&self) : "no condition");
            ++failures;
        }
        check(hand_rhs(&self, 0, self.state, rate) == GIC_ERROR_TUNED, "what can't be set up does not run");
    }
    check(hand_with(&self, HAND_PARAMETER_ROD, 0.8) == GIC_ERROR_NEWTON, "a rod too long");
    check(says(hand_status_subset(&self), "hand") && !hand_status_condition(&self), "the rod's subset");
    check(hand_rhs(&self, 0, self.state, rate) == GIC_ERROR_TUNED, "what can't be assembled does not run");
    check(hand_with(&self, HAND_PARAMETER_ROD, (double)NAN) == GIC_ERROR_INPUT, "no number");

    check(hand_with(&self, HAND_PARAMETER_ROD, 0.55) == GIC_OK, "another rod");
    check(hand_rhs(&self, 0, self.state, rate) == GIC_OK, "which runs");
    rod = self.parameter[HAND_PARAMETER_ROD];
    self.parameter[HAND_PARAMETER_ROD] = (gic_real)0.56;
    check(hand_rhs(&self, 0, self.state, rate) == GIC_ERROR_TUNED, "changed after set-up");
    self.parameter[HAND_PARAMETER_ROD] = rod;
    check(hand_rhs(&self, 0, self.state, rate) == GIC_OK, "changed back");
}

static void check_car(void)
{
    static car plain, other;
    static gic_real pose[2][7 * CAR_BODIES], rate[2][CAR_STATES];
    int left = 0, right = 0, i;
    check(car_setup(&plain) == GIC_OK && car_setup(&other) == GIC_OK, "the car");
    other.parameter[CAR_PARAMETER_BALL_L] += (gic_real)0.01;
    check(car_setup_with(&other, other.parameter) == GIC_OK, "another ball joint on the left");
    check(car_poses(&plain, pose[0]) == GIC_OK && car_poses(&other, pose[1]) == GIC_OK, "poses");
    while (strcmp(car_model.body_name[left], "wheel_f_l"))
        ++left;
    while (strcmp(car_model.body_name[right], "wheel_f_r"))
        ++right;
    check(memcmp(pose[0] + 7 * right, pose[1] + 7 * right, 7 * sizeof(gic_real)) == 0, "the right stays");
    check(memcmp(pose[0] + 7 * left, pose[1] + 7 * left, 7 * sizeof(gic_real)) != 0, "the left moves");

    /* the tie rod's outer end on the steering axis; single precision sees it some micrometres beside that */
    other.parameter[CAR_PARAMETER_TRAIL_R] = 1;
    i = car_setup_with(&other, other.parameter);
    if (sizeof(gic_real) == sizeof(double)) {
        check(i == GIC_ERROR_SINGULAR, "no lever for the tie rod");
        check(says(car_status_subset(&other), "wheel_f_r"), "of the right wheel");
    }

    /* of force laws alone: at any time */
    check(!car_model.parameter_geometric[CAR_PARAMETER_ROLL] && car_model.parameter_geometric[CAR_PARAMETER_TIRE] &&
              car_model.parameter_geometric[CAR_PARAMETER_LENGTH],
          "which are geometric");
    plain.state[CAR_STATE_SPRING_F_L] += (gic_real)0.01;
    check(car_rhs(&plain, 0, plain.state, rate[0]) == GIC_OK, "before");
    plain.parameter[CAR_PARAMETER_ROLL] *= 2;
    check(car_rhs(&plain, 0, plain.state, rate[1]) == GIC_OK, "another roll stiffness");
    check(rate[0][CAR_STATE_SPRING_F_L_RATE] != rate[1][CAR_STATE_SPRING_F_L_RATE], "is felt");
    for (i = 0; i < 20; ++i)
        check(car_step(&plain, (gic_real)0.001, GIC_AB3) == GIC_OK, "a step");
}

int main(void)
{
    check_hand();
    check_car();
    return failures != 0;
}
