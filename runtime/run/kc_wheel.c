/* SPDX-License-Identifier: MIT
 * A wheel as geometry sees it: a rigid disc of its radius on the carrier. Its contact is the lowest point of the rim,
 * P = c - R e with e = (k - (k . s) s) / |...|, k upwards and s along the axis. */
#include "base/vec3.h"
#include "run/kc.h"

#include <math.h>

void kc_pose(const KcWheel *wheel, const KcLook *look, KcPose *pose)
{
    copy3(look->value + wheel->centre, pose->centre);
    sub3(look->value + wheel->tip, pose->centre, pose->axis);
    const double *s = pose->axis, q = hypot(s[0], s[1]);
    for (int i = 0; i < 3; ++i)
        pose->contact[i] = pose->centre[i] - wheel->radius * ((i == 2) - s[2] * s[i]) / q;
}

/* Of n = k - (k . s) s, of length q = sqrt(1 - s_z^2). */
static void contact_rate(const KcWheel *wheel, const KcPose *pose, KcPose *rate)
{
    const double *s = pose->axis, *ds = rate->axis, q = hypot(s[0], s[1]), dq = -s[2] * ds[2] / q;
    for (int i = 0; i < 3; ++i) {
        const double n = (i == 2) - s[2] * s[i], dn = -ds[2] * s[i] - s[2] * ds[i];
        rate->contact[i] = rate->centre[i] - wheel->radius * (dn - n * dq / q) / q;
    }
}

void kc_rate(const KcWheel *wheel, const KcLook *look, const KcPose *pose, const double *along, KcPose *rate)
{
    double arm[3];
    *rate = (KcPose){.centre = {0}};
    for (int k = 0; k < look->columns; ++k) {
        add_scaled3(along[k], look->slope + k * look->outputs + wheel->velocity, rate->centre);
        add_scaled3(along[k], look->slope + k * look->outputs + wheel->turn, rate->turn);
    }
    cross3(rate->turn, pose->axis, rate->axis);
    sub3(pose->contact, pose->centre, arm);
    cross3(rate->turn, arm, rate->locked);
    add3(rate->locked, rate->centre, rate->locked);
    contact_rate(wheel, pose, rate);
}

double kc_camber(const KcWheel *wheel, const KcPose *pose)
{
    return -wheel->side * atan2(pose->axis[2], hypot(pose->axis[0], pose->axis[1]));
}

double kc_camber_rate(const KcWheel *wheel, const KcPose *pose, const KcPose *rate)
{
    return -wheel->side * rate->axis[2] / hypot(pose->axis[0], pose->axis[1]);
}

double kc_steer(const KcPose *pose)
{
    return atan2(-pose->axis[0], pose->axis[1]);
}

double kc_steer_rate(const KcPose *pose, const KcPose *rate)
{
    const double *s = pose->axis, *ds = rate->axis;
    return (s[0] * ds[1] - s[1] * ds[0]) / (s[0] * s[0] + s[1] * s[1]);
}

/* P_z = c_z - R q: with q q_a = -s_z s_z,a the second derivative of q is -(s_z,a s_z,b + s_z s_z,ab + q_a q_b) / q. */
double kc_contact_bend(const KcWheel *wheel, const KcPose *pose, const KcPose *a, const KcPose *b,
                       const double centre[3], const double turn[3])
{
    const double *s = pose->axis, q = hypot(s[0], s[1]);
    double bend[3], carried[3];
    cross3(turn, s, bend);
    cross3(a->turn, b->axis, carried);
    const double sz = bend[2] + carried[2], qa = -s[2] * a->axis[2] / q, qb = -s[2] * b->axis[2] / q;
    return centre[2] + wheel->radius * (a->axis[2] * b->axis[2] + s[2] * sz + qa * qb) / q;
}
